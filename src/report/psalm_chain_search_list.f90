!> What the search over a sketch in poses has to report: how it went, the linkages found, their variables by name.
module psalm_chain_search_list
   use psalm_chain_problem, only: unknown_name
   use psalm_chain_synthesis, only: chain_synthesis_t
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_kinds, only: wp
   use psalm_text, only: general, to_text
   implicit none (type, external)
   private
   public :: report_chain_search

   integer, parameter :: name_room = 40   !! characters of a variable's name in the listing

contains

   !> Append to the listing, to device 1 and to the remarks.
   subroutine report_chain_search(set, search, devices)
      type(data_set_t), intent(in) :: set
      type(chain_synthesis_t), intent(in) :: search
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: line
      character(name_room) :: name
      integer :: k, v

      line = to_text(search%starts)//' starts, '//to_text(search%feasible)//' led to a linkage, '//to_text(search%evaluations)// &
             ' evaluations'
      if (size(search%best) == 0) then
         line = 'no linkage that obeys the constraints was found: '//line
         call devices%note_violation()
      else
         line = line//'; best objective '//number(search%best(1)%objective)
      end if
      if (search%refused) line = trim(set%search%solver%name)//' does not work on this problem: '//line
      if (search%stopped) then
         line = 'stopped before all starts were made: '//line
         call devices%note_violation()
      end if
      call devices%one%add(' '//set%title)
      call devices%one%add(' '//line)
      call devices%remark(set, line)
      if (size(search%best) == 0) return
      call devices%six%add(' '//set%title)
      call devices%six%add()
      if (search%first_feasible) call devices%six%add(' SUM OF SQUARES OF THE DRAWING '//number(search%first_objective))
      do k = 1, size(search%best)
         call devices%six%add(' LINKAGE '//to_text(k)//', START '//to_text(search%best(k)%start)//': SUM OF SQUARES '// &
                              number(search%best(k)%objective))
         call devices%six%add('  VARIABLE                                        DRAWING          FOUND')
         do v = 1, size(search%best(k)%x)
            name = unknown_name(set%sketch, v)
            call devices%six%add('  '//name//general(search%problem%first(v), 'E')//general(search%best(k)%x(v), 'E'))
         end do
      end do
      call devices%six%add()
   end subroutine report_chain_search

   pure function number(value) result(text)
      real(wp), intent(in) :: value
      character(:), allocatable :: text

      text = trim(adjustl(general(value, 'E')))
   end function number
end module psalm_chain_search_list
