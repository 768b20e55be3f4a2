!> The table for other programs of a case that has loops of dyads: its output, and with rates their derivatives by time.
!>
!> A sketch has its own table (`psalm_chain_report`), with all its outputs and joints by name.
module psalm_case_table
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp
   use psalm_rate_study, only: rate_study_t
   implicit none (type, external)
   private
   public :: report_case_table

   character(*), parameter :: of_rate(2) = ['.v', '.a']               !! by time
   character(*), parameter :: of_input(2) = ['.first ', '.second']    !! by the input, where they are wanted

contains

   !> Input, closed, output, desired values if there are any.
   subroutine report_case_table(set, problem, motion, devices, rates)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion                   !! at the prescribed positions
      type(devices_t), intent(inout) :: devices
      type(rate_study_t), intent(in), optional :: rates      !! `kalm`: `.v` and `.a` of the output, angles in radians
      character(:), allocatable :: name
      integer :: c, o

      call devices%new_table(set%title)
      associate (table => devices%tables(size(devices%tables)), kind => problem%output%kind)
         call table%add('input', motion%input)
         call table%add_flag('closed', motion%closed)
         do c = 1, kind%components
            name = 'output'//component(c)
            call table%add(name, motion%actual(:, c), motion%closed)
            if (.not. present(rates)) cycle
            do o = 1, size(of_rate)
               call table%add(name//of_rate(o), rates%by_time(o, c, :), motion%closed .and. rates%dead == 0)
            end do
         end do
         if (.not. problem%desired) return
         do c = 1, kind%components
            call table%add('desired'//component(c), problem%wanted(:size(motion%input), c))
         end do
         if (.not. allocated(motion%rates)) return
         do c = 1, kind%components
            do o = 1, size(of_input)
               if (.not. any(problem%rate_weight(:, c, o) > 0.0_wp)) cycle
               call table%add('output'//component(c)//trim(of_input(o)), motion%rates(:, c, o), motion%has_rates)
               call table%add('desired'//component(c)//trim(of_input(o)), problem%rate_wanted(:, c, o), &
                              problem%rate_weight(:, c, o) > 0.0_wp)
            end do
         end do
      end associate

   contains

      !> Ending of a column's name: `.x`, `.y`, `.angle`; of an output of one number none.
      pure function component(c) result(ending)
         integer, intent(in) :: c
         character(:), allocatable :: ending

         ending = trim(problem%output%kind%suffix(c))
         if (len(ending) > 0) ending(1:1) = '.'
      end function component
   end subroutine report_case_table
end module psalm_case_table
