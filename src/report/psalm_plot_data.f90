!> Device 9: the motion as a table any program reads.
!>
!> Comment lines begin with `#`, the first of them names the columns; one row for each input position, 17 significant digits,
!> a closed column of 0 or 1. Blocks are two blank lines apart (gnuplot's `index`).
module psalm_plot_data
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp
   use psalm_output_kind, only: output_kind_t, motion_pose, most_rates
   use psalm_text, only: text_t, full_precision, general
   implicit none (type, external)
   private
   public :: write_block, write_rate_block

contains

   !> Append a block. With `desired_columns` they are there in every block; motions without desired values hold `NaN`.
   subroutine write_block(title, name, desired_columns, with_desired, problem, motion, text, condition)
      character(*), intent(in) :: title     !! of the case
      character(*), intent(in) :: name      !! of the block
      logical, intent(in) :: desired_columns !! the case has desired values
      logical, intent(in) :: with_desired    !! the motion is that at the positions with desired values
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(text_t), intent(inout) :: text
      real(wp), intent(in), optional :: condition(:) !! shape (positions): adds a column
      type(output_kind_t) :: kind
      character(:), allocatable :: line
      integer :: i, c

      kind = problem%output%kind

      if (text%length > 0) then
         call text%add()
         call text%add()
      end if
      line = '# input closed'
      do c = 1, kind%components
         line = line//' actual'//trim(kind%suffix(c))
      end do
      if (desired_columns) then
         do c = 1, kind%components
            line = line//' desired'//trim(kind%suffix(c))
         end do
      end if
      if (present(condition)) line = line//' condition'
      call text%add(line)
      call text%add('# '//title)
      call text%add('# '//name//'; input in '//trim(merge('length ', 'degrees', problem%mechanism%sliding_input))// &
                    ', output in '//unit_of_output())
      do i = 1, size(motion%input)
         call text%add_text(full_precision(motion%input(i)))
         call text%add_text(merge(' 1', ' 0', motion%closed(i)))
         do c = 1, kind%components
            if (motion%closed(i)) then
               call add_number(motion%actual(i, c))
            else
               call text%add_text(' NaN')
            end if
         end do
         if (desired_columns) then
            do c = 1, kind%components
               if (with_desired) then
                  call add_number(problem%wanted(i, c))
               else
                  call text%add_text(' NaN')
               end if
            end do
         end if
         if (present(condition)) call text%add_text(' '//trim(adjustl(general(condition(i), 'E'))))
         call text%add()
      end do

   contains

      subroutine add_number(value)
         real(wp), intent(in) :: value

         call text%add_text(' ')
         call text%add_text(full_precision(value))
      end subroutine add_number

      pure function unit_of_output() result(unit)
         character(:), allocatable :: unit

         unit = trim(merge('degrees', 'length ', kind%angle > 0))
         if (problem%motion == motion_pose) unit = 'length and degrees'
      end function unit_of_output
   end subroutine write_block

   !> Append a block of the derivatives by the input that are wanted; `NaN` where there is none or none is wanted.
   subroutine write_rate_block(title, problem, motion, text)
      character(*), intent(in) :: title     !! of the case
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion  !! with derivatives
      type(text_t), intent(inout) :: text
      character(*), parameter :: powers(most_rates) = [character(1) :: '', '2']
      character(:), allocatable :: line, name
      integer :: i, c, order

      call text%add()
      call text%add()
      line = '# input closed'
      do order = 1, most_rates
         do c = 1, size(motion%rates, 2)
            name = trim(problem%output%kind%suffix(c))//'_per_'//trim(merge('length', 'rad   ', problem%mechanism%sliding_input)) &
                   //trim(powers(order))
            line = line//' actual'//name//' desired'//name
         end do
      end do
      call text%add(line)
      call text%add('# '//title)
      line = '# derivatives; by the input in '//trim(merge('length ', 'radians', problem%mechanism%sliding_input))
      if (problem%output%kind%angle > 0) line = line//', of angles in radians'
      call text%add(line)
      do i = 1, size(motion%input)
         call text%add_text(full_precision(motion%input(i))//merge(' 1', ' 0', motion%closed(i)))
         do order = 1, most_rates
            do c = 1, size(motion%rates, 2)
               call add_number(motion%rates(i, c, order), motion%has_rates(i))
               call add_number(problem%rate_wanted(i, c, order), problem%rate_weight(i, c, order) > 0.0_wp)
            end do
         end do
         call text%add()
      end do

   contains

      subroutine add_number(value, there)
         real(wp), intent(in) :: value
         logical, intent(in) :: there

         if (there) then
            call text%add_text(' '//full_precision(value))
         else
            call text%add_text(' NaN')
         end if
      end subroutine add_number
   end subroutine write_rate_block
end module psalm_plot_data
