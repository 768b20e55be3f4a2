!> What one adjustable member leaves of the deviations, in the listing and on device 9.
module psalm_adjustment_list
   use psalm_adjustment, only: adjustment_t
   use psalm_block, only: begin_block
   use psalm_parameters, only: name_of
   use psalm_text, only: text_t, full_precision, general, to_text
   use psalm_tolerance, only: tolerance_t
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: list_adjustments, write_adjustment_block

contains

   !> Append the table, and whether the output is within its own tolerance.
   subroutine list_adjustments(linear, list, allowed, text)
      type(tolerance_t), intent(in) :: linear
      type(adjustment_t), intent(in) :: list(:)
      real(wp), intent(in) :: allowed            !! tolerance of the output to either side; 0: none is given
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      real(wp) :: square, worst
      integer :: k

      square = sqrt(maxval(sum(linear%square**2, dim=2)))
      worst = sqrt(maxval(sum(linear%worst**2, dim=2)))
      call text%add()
      call text%add(' ONE MEMBER ADJUSTED AFTER ASSEMBLY: WHAT IS LEFT OF THE DEVIATIONS OF ALL OTHERS')
      if (allowed > 0.0_wp) call text%add(' TOLERANCE OF THE OUTPUT'//general(allowed))
      call text%add('                                 TRAVEL (+-)                    LARGEST DEVIATION (+-)')
      line = ' DIMENSION                     ROOT SUM SQ.     WORST CASE   ROOT SUM SQ.     WORST CASE  POSITION'
      if (allowed > 0.0_wp) line = line//'  RESTORES'
      call text%add(line)
      line = ' NONE'//repeat(' ', 55)//general(square)//general(worst)
      if (allowed > 0.0_wp) line = line//repeat(' ', 12)//verdict(square, worst)
      call text%add(line)
      do k = 1, size(list)
         associate (one => list(k))
            line = ' '//name_of(linear%variables(one%variable))
            line = line//repeat(' ', max(1, 30 - len(line)))//general(one%travel)//general(one%most_travel)//general(one%left)// &
                   general(one%most_left)//repeat(' ', max(1, 10 - len(to_text(one%at))))//to_text(one%at)
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

   !> A block of device 9.
   subroutine write_adjustment_block(linear, list, text)
      type(tolerance_t), intent(in) :: linear
      type(adjustment_t), intent(in) :: list(:)
      type(text_t), intent(inout) :: text
      integer :: k

      call begin_block('adjustment', &
                       'loop arc kind travel_root_sum_square travel_worst_case left_root_sum_square left_worst_case position', text)
      do k = 1, size(list)
         associate (one => list(k), variable => linear%variables(list(k)%variable))
            call text%add(to_text(variable%loop)//' '//to_text(variable%arc)//' '//to_text(variable%kind)//' '// &
                          full_precision(one%travel)//' '//full_precision(one%most_travel)//' '//full_precision(one%left)//' '// &
                          full_precision(one%most_left)//' '//to_text(one%at))
         end associate
      end do
   end subroutine write_adjustment_block
end module psalm_adjustment_list
