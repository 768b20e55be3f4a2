!> What one adjustable member leaves of the deviations, in the listing and on device 9.
module psalm_adjustment_list
   use psalm_adjustment, only: adjustment_t
   use psalm_column_names, only: position_name
   use psalm_columns, only: left_column, right_column
   use psalm_markup, only: strings_t
   use psalm_number_format, only: figures_of, in_sentence
   use psalm_parameters, only: name_of, words_of
   use psalm_part_columns, only: add_words
   use psalm_tables, only: table_t, tables_t, table_of
   use psalm_text, only: text_t
   use psalm_tolerance, only: tolerance_t
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: list_adjustments, put_adjustments

contains

   !> Append the table, and whether the output is within its own tolerance.
   subroutine list_adjustments(named, linear, list, allowed, text)
      logical, intent(in) :: named               !! joints have names: a sketch
      type(tolerance_t), intent(in) :: linear
      type(adjustment_t), intent(in) :: list(:)
      real(wp), intent(in) :: allowed            !! tolerance of the output to either side; 0: none is given
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      character(15), dimension(size(list)) :: travel, most_travel
      character(15), dimension(0:size(list)) :: left, most_left    ! the first is of no member adjusted
      real(wp) :: square, worst
      integer :: k

      square = sqrt(maxval(sum(linear%square**2, dim=2)))
      worst = sqrt(maxval(sum(linear%worst**2, dim=2)))
      travel = figures_of(named, list%travel)
      most_travel = figures_of(named, list%most_travel)
      left = figures_of(named, [square, list%left])
      most_left = figures_of(named, [worst, list%most_left])
      call text%add()
      call text%add(' ONE MEMBER ADJUSTED AFTER ASSEMBLY: WHAT IS LEFT OF THE DEVIATIONS OF ALL OTHERS')
      if (allowed > 0.0_wp) call text%add(' TOLERANCE OF THE OUTPUT'//in_sentence(named, allowed))
      call text%add('                                 TRAVEL (+-)                    LARGEST DEVIATION (+-)')
      line = ' DIMENSION                     ROOT SUM SQ.     WORST CASE   ROOT SUM SQ.     WORST CASE  POSITION'
      if (allowed > 0.0_wp) line = line//'  RESTORES'
      call text%add(line)
      line = ' NONE'//repeat(' ', 55)//left(0)//most_left(0)
      if (allowed > 0.0_wp) line = line//repeat(' ', 12)//verdict(square, worst)
      call text%add(line)
      do k = 1, size(list)
         associate (one => list(k))
            line = left_column(' '//name_of(linear%variables(one%variable)), 30)//travel(k)//most_travel(k)//left(k)// &
                   most_left(k)//right_column(one%at, 10, 1)
            if (allowed > 0.0_wp) line = line//'  '//verdict(one%left, one%most_left)
         end associate
         call text%add(line)
      end do

   contains

      !> ALWAYS: in the worst case too.
      function verdict(square, worst) result(word)
         real(wp), intent(in) :: square, worst
         character(:), allocatable :: word

         word = 'NO'
         if (square <= allowed) word = 'RSS'
         if (worst <= allowed) word = 'ALWAYS'
      end function verdict
   end subroutine list_adjustments

   !> The table `adjustment`.
   pure subroutine put_adjustments(linear, list, tables)
      type(tolerance_t), intent(in) :: linear
      type(adjustment_t), intent(in) :: list(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      type(strings_t), allocatable :: names(:)
      integer :: k

      table = table_of('adjustment', 'a row for each dimension as the adjustable one, those that leave least first')
      associate (variables => linear%variables(list%variable))
         call table%add('loop', variables%loop)
         call table%add('arc', variables%arc)
         call table%add('kind', variables%kind)
         allocate (names(size(list)))
         do k = 1, size(list)
            names(k)%text = words_of(variables(k))
         end do
      end associate
      call table%add('travel_root_sum_square', list%travel)
      call table%add('travel_worst_case', list%most_travel)
      call table%add('left_root_sum_square', list%left)
      call table%add('left_worst_case', list%most_left)
      call table%add(position_name, list%at)
      call add_words('dimension', names, table)
      call tables%put(table)
   end subroutine put_adjustments
end module psalm_adjustment_list
