!> Tolerances in the listing and on device 9: effects of the dimensions, bands over the motion, the sample.
module psalm_tolerance_list
   use psalm_column_names, only: closed_name, input_name, input_unit, number_unit, output_name, output_unit, per_time, &
                                 plotted_output, position_name
   use psalm_columns, only: left_column
   use psalm_elementary, only: hypotenuse
   use psalm_input_text, only: angle_text
   use psalm_group_words, only: group_heading
   use psalm_kinds, only: wp
   use psalm_number_format, only: figures_of, format_of, in_sentence
   use psalm_output_kind, only: output_kind_t
   use psalm_sketch, only: sketch_t
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_mechanism, only: mechanism_t
   use psalm_text, only: text_t, to_text
   use psalm_tolerance, only: tolerance_t, sample_t, names_of_tolerances
   use psalm_parameters, only: name_of, words_of
   implicit none (type, external)
   private
   public :: list_tolerances, list_sample, put_tolerances, list_output_bands, put_output_bands

   integer, parameter :: name_length = 120   !! characters of a name in a table
   integer, parameter :: band_columns = 6    !! two bands, what the sample deviated in four numbers
   character(*), parameter :: dead_words = '   DEAD POINT: THE EFFECTS ARE INFINITE'

contains

   !> Append the table of dimensions and the bands over the motion.
   subroutine list_tolerances(mechanism, linear, sample, text)
      type(mechanism_t), intent(in) :: mechanism
      type(tolerance_t), intent(in) :: linear
      type(sample_t), intent(in) :: sample
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      character(15) :: input(size(linear%dead))
      character(15), allocatable :: tolerance(:), effect(:), bands(:, :, :)
      real(wp), allocatable :: size_of(:), amount(:)
      integer, allocatable :: worst(:)
      type(output_kind_t) :: kind
      integer :: v, i, k

      kind = linear%kind
      allocate (amount(size(linear%tolerance)), worst(size(linear%tolerance)))
      do v = 1, size(linear%tolerance)
         size_of = abs(linear%effect(:, v, 1))
         if (kind%components > 1) size_of = hypotenuse(linear%effect(:, v, 1), linear%effect(:, v, 2))
         worst(v) = maxloc(size_of, dim=1)
         amount(v) = size_of(worst(v))
         if (kind%components == 1) amount(v) = linear%effect(worst(v), v, 1)
      end do
      tolerance = figures_of(mechanism%has_joint_names(), linear%tolerance)
      effect = figures_of(mechanism%has_joint_names(), amount)
      call text%add()
      call text%add(' EFFECT OF TOLERANCES ON THE OUTPUT')
      call text%add(' DIMENSION                          TOLERANCE  LARGEST EFFECT  AT POSITION')
      do v = 1, size(linear%tolerance)
         line = left_column(' '//name_of(linear%variables(v)), 30)//tolerance(v)//' '//effect(v)
         call text%add(line//'    '//to_text(worst(v)))
      end do
      call text%add()
      if (kind%components == 2) then
         call text%add(' BANDS OF X, THEN OF Y (+-), AND WHAT THE SAMPLE DEVIATED')
      else if (kind%components == 3) then
         call text%add(' BANDS OF X, Y AND ANGLE (+-), AND WHAT THE SAMPLE DEVIATED')
      else
         call text%add(' BANDS OF THE OUTPUT (+-), AND WHAT THE SAMPLE DEVIATED')
      end if
      call text%add(head_of_bands(sample))
      input = inputs_of(mechanism%has_joint_names(), linear)
      allocate (bands(size(linear%dead), band_columns, kind%components))
      do k = 1, kind%components
         bands(:, :, k) = bands_of(mechanism%has_joint_names(), linear%worst(:, k), linear%square(:, k), linear%dead, sample, k)
      end do
      do i = 1, size(linear%dead)
         line = input(i)
         if (linear%dead(i)) then
            call text%add(line//dead_words)
            cycle
         end if
         do k = 1, kind%components
            if (k > 1) line = repeat(' ', 15)
            call text%add(line//band_line(bands(i, :, k), sample))
         end do
      end do
      call list_sample(mechanism, sample, text)
   end subroutine list_tolerances

   !> Append how many linkages the sample has, and which of them do not close.
   subroutine list_sample(mechanism, sample, text)
      type(mechanism_t), intent(in) :: mechanism
      type(sample_t), intent(in) :: sample
      type(text_t), intent(inout) :: text
      integer :: i

      if (sample%trials == 0) return
      call text%add(' LINKAGES OF THE SAMPLE '//to_text(sample%trials)//', OF WHICH DO NOT CLOSE '//to_text(sample%open))
      do i = 1, min(sample%open, size(sample%named))
         call text%add('   LINKAGE '//to_text(sample%named(i))//', '// &
                       group_heading(mechanism, sample%loop(i), .false.))
      end do
      if (sample%open > size(sample%named)) call text%add('   AND '//to_text(sample%open - size(sample%named))//' MORE')
   end subroutine list_sample

   pure function head_of_bands(sample) result(line)
      type(sample_t), intent(in) :: sample
      character(:), allocatable :: line

      line = '          INPUT     WORST CASE ROOT SUM SQUARE'
      if (sample%any_closed) line = line//'         LOWEST        HIGHEST           MEAN   STD.DEVIATION'
   end function head_of_bands

   !> The numbers of the columns of `head_of_bands` behind the input.
   pure function bands_of(named, worst, square, dead, sample, k) result(texts)
      logical, intent(in) :: named                  !! joints have names: a sketch
      real(wp), intent(in) :: worst(:), square(:)   !! shape (positions)
      logical, intent(in) :: dead(:)                !! shape (positions)
      type(sample_t), intent(in) :: sample
      integer, intent(in) :: k                      !! component of the sample
      character(15) :: texts(size(dead), band_columns)

      texts = ''
      texts(:, 1) = figures_of(named, worst, .not. dead)
      texts(:, 2) = figures_of(named, square, .not. dead)
      if (.not. sample%any_closed) return
      texts(:, 3) = figures_of(named, sample%low(:, k), .not. dead)
      texts(:, 4) = figures_of(named, sample%high(:, k), .not. dead)
      texts(:, 5) = figures_of(named, sample%mean(:, k), .not. dead)
      texts(:, 6) = figures_of(named, sample%deviation(:, k), .not. dead)
   end function bands_of

   !> A row of them.
   pure function band_line(texts, sample) result(line)
      character(*), intent(in) :: texts(:)          !! shape (columns)
      type(sample_t), intent(in) :: sample
      character(:), allocatable :: line

      line = texts(1)//' '//texts(2)
      if (sample%any_closed) line = line//texts(3)//texts(4)//texts(5)//' '//texts(6)
   end function band_line

   !> Inputs in their column; of a crank that is drawn they count from the drawing, over as many turns as are asked for.
   pure function inputs_of(named, linear) result(texts)
      logical, intent(in) :: named                  !! joints have names: a sketch
      type(tolerance_t), intent(in) :: linear
      character(15) :: texts(size(linear%dead))
      integer :: i

      associate (input => linear%nominal%input(:size(linear%dead)))
         texts = figures_of(named, input)
         if (.not. allocated(linear%nominal%crank)) &
            texts = [(angle_text(input(i), format_of(named, input)), i=1, size(input))]
      end associate
   end function inputs_of

   !> Bands of all outputs of a sketch, and the dimension that has the largest effect on each.
   subroutine list_output_bands(sketch, linear, sample, text)
      type(sketch_t), intent(in) :: sketch
      type(tolerance_t), intent(in) :: linear
      type(sample_t), intent(in) :: sample
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      character(name_length), allocatable :: dimensions(:)
      character(15) :: input(size(linear%dead)), columns(size(linear%dead), band_columns)
      integer :: n, i

      input = inputs_of(.true., linear)
      dimensions = names_of_tolerances(sketch, linear%variables, linear%bands%apart)
      call text%add()
      if (sample%any_closed) then
         call text%add(' BANDS OF ALL OUTPUTS (+-), AND WHAT THE SAMPLE DEVIATED')
      else
         call text%add(' BANDS OF ALL OUTPUTS (+-)')
      end if
      associate (bands => linear%bands)
         do n = 1, size(bands%names)
            if (.not. bands%known(n)) then
               call text%add(' '//trim(bands%names(n))//' IS A RATIO OF RATES, FOR WHICH NO BANDS ARE FOUND')
               cycle
            end if
            line = ' '//trim(bands%names(n))//': THE LARGEST EFFECT,'//in_sentence(.true., maxval(bands%effect(:, n)))
            call text%add(line//', IS THAT OF '//trim(dimensions(maxloc(bands%effect(:, n), dim=1))))
            call text%add(head_of_bands(sample))
            columns = bands_of(.true., bands%worst(:, n), bands%square(:, n), linear%dead, sample, linear%kind%components + n)
            do i = 1, size(linear%dead)
               if (linear%dead(i)) then
                  call text%add(input(i)//dead_words)
               else
                  call text%add(input(i)//band_line(columns(i, :), sample))
               end if
            end do
         end do
      end associate
   end subroutine list_output_bands

   !> The table `output_tolerances` of a sketch: the same bands, and what the sample deviated.
   pure subroutine put_output_bands(sketch, linear, sample, tables)
      type(sketch_t), intent(in) :: sketch
      type(tolerance_t), intent(in) :: linear
      type(sample_t), intent(in) :: sample
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(:), allocatable :: name, unit
      logical :: known(size(linear%dead)), drawn(size(linear%dead))
      integer :: n, i, k

      table = table_of('output_tolerances', 'a row for each position: bands of the outputs (+-)')
      associate (bands => linear%bands)
         call table%add(position_name, [(i, i=1, size(bands%worst, 1))])
         do n = 1, size(bands%names)
            name = trim(bands%names(n))
            unit = number_unit(sketch%outputs, n, per_time(), 0)
            known = bands%known(n) .and. .not. linear%dead
            call table%add(name//'.worst_case', bands%worst(:, n), unit, known)
            call table%add(name//'.root_sum_square', bands%square(:, n), unit, known)
            if (.not. sample%any_closed) cycle
            drawn = bands%known(n)
            k = linear%kind%components + n
            call table%add(name//'.lowest', sample%low(:, k), unit, drawn)
            call table%add(name//'.highest', sample%high(:, k), unit, drawn)
            call table%add(name//'.mean', sample%mean(:, k), unit, drawn)
            call table%add(name//'.std_deviation', sample%deviation(:, k), unit, drawn)
         end do
      end associate
      call tables%put(table)
   end subroutine put_output_bands

   !> The table `tolerances`: bands and sample at every position.
   subroutine put_tolerances(title, slides, linear, sample, tables)
      character(*), intent(in) :: title
      logical, intent(in) :: slides                !! the input is a length
      type(tolerance_t), intent(in) :: linear
      type(sample_t), intent(in) :: sample
      type(tables_t), intent(inout) :: tables
      character(*), parameter :: about = 'tolerances: linear bands (+-), and deviations of a sample of '
      type(table_t) :: table
      integer :: k

      table = table_of('tolerances', about//to_text(sample%trials)//' linkages', named=.false., &
                       notes=title//new_line('a')//about//to_text(sample%trials)//' linkages')
      associate (n => size(linear%worst, 1), kind => linear%kind)
         call table%add(input_name(), linear%nominal%input(:n), input_unit(slides))
         call table%add(closed_name, spread(.true., 1, n))
         do k = 1, kind%components
            call table%add(output_name(kind, k), linear%nominal%actual(:n, k), output_unit(k == kind%angle), &
                           plotted=plotted_output(kind, k))
            call add('worst_case', linear%worst(:, k), .not. linear%dead)
            call add('root_sum_square', linear%square(:, k), .not. linear%dead)
            if (.not. sample%any_closed) cycle
            call add('lowest', sample%low(:, k))
            call add('highest', sample%high(:, k))
            call add('mean', sample%mean(:, k))
            call add('std_deviation', sample%deviation(:, k))
         end do
      end associate
      call tables%put(table)
      call put_effects(linear, tables)

   contains

      subroutine add(what, values, known)
         character(*), intent(in) :: what
         real(wp), intent(in) :: values(:)
         logical, intent(in), optional :: known(:)

         call table%add(output_name(linear%kind, k)//'.'//what, values, output_unit(k == linear%kind%angle), known, &
                        what//trim(linear%kind%suffix(k)))
      end subroutine add
   end subroutine put_tolerances

   !> The table `dimension_effects` for other programs: the largest effect of each tolerance.
   subroutine put_effects(linear, tables)
      type(tolerance_t), intent(in) :: linear
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length), allocatable :: names(:)
      integer, allocatable :: worst(:)
      real(wp), allocatable :: effect(:)
      integer :: v

      associate (n => size(linear%tolerance))
         allocate (names(n), worst(n), effect(n))
         do v = 1, n
            names(v) = words_of(linear%variables(v))
            associate (amount => sqrt(sum(linear%effect(:, v, :min(2, linear%kind%components))**2, dim=2)))
               worst(v) = maxloc(amount, dim=1)
               effect(v) = amount(worst(v))
            end associate
         end do
      end associate
      table = table_of('dimension_effects', 'a row for each dimension with a tolerance: its largest effect on the output', &
                       audience=for_programs)
      call table%add('dimension', names)
      call table%add('tolerance', linear%tolerance)
      call table%add('effect', effect, output_unit(linear%kind%angle == 1))
      call table%add(position_name, worst)
      call tables%put(table)
   end subroutine put_effects
end module psalm_tolerance_list
