!> The summary of a run in words, for standard error: a title and at most fourteen lines a case.
module psalm_summary_text
   use psalm_column_names, only: output_unit
   use psalm_group_words, only: group_words, the_group
   use psalm_kinds, only: wp, dp
   use psalm_mechanism, only: mechanism_t
   use psalm_output_kind, only: motion_point, motion_angle, motion_distance, most_rates
   use psalm_summary, only: summary_t, range_t, loop_kind_t, kind_crank_rocker, kind_double_crank, kind_double_rocker, &
                            kind_rocker_crank, kind_triple_rocker, kind_change_point, kind_slider_turning
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: write_summary, write_desired_errors, plain_number, name_of_kind, add_line

   integer, parameter :: most_listed = 4     !! of ranges, kinds or inputs on one line
   integer, parameter :: label_columns = 20
   integer, parameter :: digits = 5          !! significant digits
   real(dp), parameter :: least_plain = 1.0e-3_dp, most_plain = 1.0e6_dp !! numbers outside are written with an exponent

contains

   !> Append the summary of a case.
   subroutine write_summary(title, mechanism, summary, text, zero, reached, positions, coincident, no_output)
      character(*), intent(in) :: title
      type(mechanism_t), intent(in) :: mechanism
      type(summary_t), intent(in) :: summary
      type(text_t), intent(inout) :: text
      character(*), intent(in), optional :: zero           !! from where the inputs count; empty: as always
      character(*), intent(in), optional :: coincident     !! the joints that coincide where the linkage is undetermined
      logical, intent(in), optional :: no_output           !! leave the output and its dead points out: it is only a stand-in
      integer, intent(in), optional :: reached, positions  !! of a sketch: positions that are reached from the drawing, of so many
      character(*), parameter :: labels(most_rates) = [character(label_columns) :: 'First derivative', 'Second derivative']
      character(:), allocatable :: words
      logical :: outputs
      integer :: order

      call text%add(trim(adjustl(title)))
      words = ''
      if (.not. summary%at_positions) words = closing_words(summary)
      if (summary%at_positions .and. present(reached) .and. present(positions)) then
         words = 'at '//to_text(reached)//' of '//to_text(positions)//' positions'
      else if (present(reached) .and. present(positions)) then
         if (reached < positions .and. summary%everywhere) words = ''
         if (reached < positions) words = words//trim(merge('; ', '  ', len(words) > 0))//' '//to_text(reached)//' of '// &
                                          to_text(positions)//' positions are reached from the drawing'
      end if
      call add_line('Closes', trim(adjustl(words)), text)
      if (present(zero)) then
         if (len(zero) > 0) call add_line('Inputs', zero, text)
      end if
      if (summary%undetermined_loop > 0 .and. present(coincident)) call add_line('Undetermined', 'from input '// &
         plain_number(summary%undetermined%low)//' to '//plain_number(summary%undetermined%high)//': '//coincident//' coincide', &
                                                                                 text)
      if (size(summary%kinds) > 0) call add_line('Kind', kind_words(mechanism, summary%kinds), text)
      if (summary%partial) call add_line('Prescribed', 'from input '//range_words(summary%prescribed)// &
                                         '; what follows is over this range', text)
      if (size(summary%closing) > 0 .or. summary%at_positions) then
         if (summary%angle_loop > 0) call add_line('Transmission angle', 'at least '//plain_number(summary%angle)// &
            ' degrees, '//in_group(summary%angle_loop)//place(summary%angle_input)//asked(), text)
         if (summary%group_loop > 0) call add_line('Larger group', in_group(summary%group_loop)//' at least '// &
            plain_number(summary%group_measure)//' from a dead point (1 is best),'//place(summary%group_input), text)
         outputs = .true.
         if (present(no_output)) outputs = .not. no_output
         if (summary%at_positions) outputs = .false.
         if (outputs) call add_output(summary, text)
         if (outputs .and. size(summary%reverses) > 0) call add_line('Dead points', 'the output reverses at '// &
                                                       listed(summary%reverses), text)
      end if
      if (summary%compared > 0 .and. .not. summary%of_targets) &
         call add_line('Error', 'RMS '//plain_number(summary%rms)//', largest '// &
         plain_number(summary%largest)//' '//unit_words(summary)//' at position '//to_text(summary%worst)//' (input '// &
         plain_number(summary%worst_input)//')', text)
      do order = 1, size(summary%rates)
         associate (errors => summary%rates(order))
            if (errors%compared > 0) call add_line(labels(order), 'RMS error '//plain_number(errors%rms)//', largest '// &
                                                   plain_number(errors%largest)//' '//unit_of_rate(summary, order)// &
                                                   ' at position '//to_text(errors%worst), text)
         end associate
      end do

   contains

      !> In which group.
      function in_group(loop) result(words)
         integer, intent(in) :: loop
         character(:), allocatable :: words

         words = 'in '//the_group(mechanism, loop)
      end function in_group

      !> Where something was found.
      function place(input) result(words)
         real(wp), intent(in) :: input
         character(:), allocatable :: words

         words = ' at input '//plain_number(input)
         if (summary%at_positions) words = ' at position '//to_text(nint(input))
      end function place

      !> The least transmission angle that the data set asks for.
      function asked() result(words)
         character(:), allocatable :: words

         words = ''
         if (summary%least_asked > 0.0_wp) words = ' (TRMIN: '//plain_number(summary%least_asked)//')'
      end function asked
   end subroutine write_summary

   !> Append the errors of the outputs of a sketch that have desired values of their own.
   subroutine write_desired_errors(summary, text)
      type(summary_t), intent(in) :: summary
      type(text_t), intent(inout) :: text
      character(:), allocatable :: unit
      integer :: k

      if (.not. allocated(summary%targets)) return
      do k = 1, size(summary%targets)
         associate (errors => summary%targets(k))
            unit = trim(errors%unit)
            if (unit == output_unit(.false.)) unit = 'length units'
            if (unit == output_unit(.true.)) unit = 'degrees'
            if (errors%compared == 0) then
               call add_line('Error', trim(errors%name)//' has no value where one is desired', text)
            else
               call add_line('Error', trim(errors%name)//' RMS '//plain_number(errors%rms)//', largest '// &
                             trim(plain_number(errors%largest)//' '//unit)//' at position '//to_text(errors%worst)//' (input '// &
                             plain_number(errors%worst_input)//')', text)
            end if
         end associate
      end do
      if (.not. allocated(summary%equals)) return
      do k = 1, size(summary%equals)
         associate (errors => summary%equals(k))
            if (errors%known) then
               call add_line('To be equal', errors%words//': off by at most '//plain_number(errors%largest), text)
            else
               call add_line('To be equal', errors%words//': one of them does not exist', text)
            end if
         end associate
      end do
   end subroutine write_desired_errors

   !> What a derivative by the input is measured in.
   pure function unit_of_rate(summary, order) result(words)
      type(summary_t), intent(in) :: summary
      integer, intent(in) :: order
      character(:), allocatable :: words

      words = 'length units per '
      if (summary%motion == motion_angle .or. summary%rates(order)%of_angle) words = 'radians per '
      words = words//trim(merge('length unit', 'radian     ', summary%sliding_input))
      if (order > 1) words = words//' squared'
   end function unit_of_rate

   !> A line of the summary: what it is about, and words.
   subroutine add_line(label, words, text)
      character(*), intent(in) :: label, words
      type(text_t), intent(inout) :: text
      character(label_columns) :: column

      column = label
      call text%add('  '//column//words)
   end subroutine add_line

   function closing_words(summary) result(words)
      type(summary_t), intent(in) :: summary
      character(:), allocatable :: words
      integer :: i

      if (size(summary%closing) == 0) then
         words = 'nowhere'
      else if (summary%everywhere .and. .not. summary%sliding_input) then
         words = 'over the full turn of the crank'
      else
         words = 'from input '
         if (summary%everywhere) words = 'over the whole range, from input '
         do i = 1, min(most_listed, size(summary%closing))
            if (i > 1) words = words//', from '
            words = words//plain_number(summary%closing(i)%low)//' to '//plain_number(summary%closing(i)%high)
         end do
         words = words//and_more(size(summary%closing))
         if (.not. summary%everywhere) words = words//' only'
      end if
      if (summary%others_open .and. summary%output_everywhere) then
         words = words//'; the loops of the output alone close everywhere'
      else if (summary%others_open) then
         words = words//'; the loops of the output alone close farther'
      end if
   end function closing_words

   function kind_words(mechanism, kinds) result(words)
      type(mechanism_t), intent(in) :: mechanism
      type(loop_kind_t), intent(in) :: kinds(:)
      character(:), allocatable :: words
      integer :: i

      words = ''
      do i = 1, min(most_listed, size(kinds))
         if (i > 1) words = words//', '
         if (mechanism%has_joint_names()) then
            words = words//name_of_kind(kinds(i)%kind)//' ('//group_words(mechanism, kinds(i)%loop)//')'
         else
            words = words//'loop '//to_text(kinds(i)%loop)//' '//name_of_kind(kinds(i)%kind)
         end if
      end do
      words = words//and_more(size(kinds))
   end function kind_words

   !> What a loop is, in words.
   pure function name_of_kind(kind) result(name)
      integer, intent(in) :: kind
      character(:), allocatable :: name

      select case (kind)
      case (kind_crank_rocker)
         name = 'crank-rocker'
      case (kind_double_crank)
         name = 'double-crank'
      case (kind_double_rocker)
         name = 'double-rocker (the coupler turns)'
      case (kind_rocker_crank)
         name = 'crank-rocker driven at its rocker'
      case (kind_triple_rocker)
         name = 'triple-rocker'
      case (kind_change_point)
         name = 'four-bar with a change point'
      case (kind_slider_turning)
         name = 'slider-crank that turns fully'
      case default
         name = 'slider-crank that does not turn fully'
      end select
   end function name_of_kind

   subroutine add_output(summary, text)
      type(summary_t), intent(in) :: summary
      type(text_t), intent(inout) :: text

      if (summary%unbounded) then
         call add_line('Output', 'runs to infinity', text)
         return
      end if
      select case (summary%motion)
      case (motion_point)
         call add_line('Output point', 'x '//range_words(summary%output)//', y '//range_words(summary%output_y)// &
                       ' length units', text)
      case (motion_angle)
         if (summary%turns) then
            call add_line('Output angle', 'turns fully', text)
         else
            call add_line('Output angle', range_words(summary%output)//' degrees (swing '// &
                          plain_number(summary%output%high - summary%output%low)//')', text)
         end if
      case default
         call add_line(merge('Output distance', 'Output length  ', summary%motion == motion_distance), &
                       range_words(summary%output)//' length units (stroke '// &
                       plain_number(summary%output%high - summary%output%low)//')', text)
      end select
   end subroutine add_output

   function range_words(span) result(words)
      type(range_t), intent(in) :: span
      character(:), allocatable :: words

      words = plain_number(span%low)//' to '//plain_number(span%high)
   end function range_words

   pure function unit_words(summary) result(words)
      type(summary_t), intent(in) :: summary
      character(:), allocatable :: words

      words = 'length units'
      if (summary%motion == motion_angle) words = 'degrees'
   end function unit_words

   function listed(values) result(words)
      real(wp), intent(in) :: values(:)
      character(:), allocatable :: words
      integer :: i

      words = trim(merge('input  ', 'inputs ', size(values) == 1))//' '//plain_number(values(1))
      do i = 2, min(most_listed, size(values))
         words = words//', '//plain_number(values(i))
      end do
      words = words//and_more(size(values))
   end function listed

   function and_more(count) result(words)
      integer, intent(in) :: count
      character(:), allocatable :: words

      words = ''
      if (count > most_listed) words = ' and '//to_text(count - most_listed)//' more'
   end function and_more

   !> A number as one would say it: five significant digits, no zeros behind.
   pure function plain_number(value) result(words)
      real(wp), intent(in) :: value
      character(:), allocatable :: words
      character(32) :: buffer, layout
      real(dp) :: size_of
      integer :: before, last

      size_of = abs(real(value, dp))
      if (size_of <= 0.0_dp) then
         words = '0'
         return
      end if
      if (.not. (size_of >= least_plain .and. size_of < most_plain)) then
         write (buffer, '(es12.4e3)') real(value, dp)
         words = trim(adjustl(buffer))
         ! two digits of exponent where they do
         if (words(len(words) - 2:len(words) - 2) == '0') words = words(:len(words) - 3)//words(len(words) - 1:)
         return
      end if
      before = 0
      do while (10.0_dp**before <= size_of)
         before = before + 1
      end do
      write (layout, '("(f32.",i0,")")') max(0, digits - before)
      write (buffer, layout) real(value, dp)
      last = len(buffer)
      if (index(buffer, '.') > 0) then
         last = verify(buffer, '0', back=.true.)
         if (buffer(last:last) == '.') last = last - 1
      end if
      words = trim(adjustl(buffer(:last)))
   end function plain_number
end module psalm_summary_text
