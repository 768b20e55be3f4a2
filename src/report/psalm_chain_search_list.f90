!> What the search over a sketch in poses has to report: how it went, the linkages found, their variables by name.
module psalm_chain_search_list
   use psalm_chain_problem, only: unknown_name
   use psalm_chain_synthesis, only: chain_synthesis_t
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_kinds, only: wp
   use psalm_sketch, only: columns_of, most_wished
   use psalm_sketch_outputs, only: names_of_numbers, name_of_output => name_room
   use psalm_text, only: general, to_text, upper_case
   implicit none (type, external)
   private
   public :: report_chain_search

   integer, parameter :: number_room = 30 !! of the name of an output
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
      if (allocated(search%actual)) call list_wished(set, search, devices)
      call devices%six%add()
   end subroutine report_chain_search

   !> Values and derivatives of the best linkage beside those desired.
   subroutine list_wished(set, search, devices)
      type(data_set_t), intent(in) :: set
      type(chain_synthesis_t), intent(in) :: search
      type(devices_t), intent(inout) :: devices
      character(*), parameter :: orders(0:most_wished) = [character(18) :: 'VALUE', 'FIRST DERIVATIVE', 'SECOND DERIVATIVE']
      character(name_of_output), allocatable :: names(:)
      logical, allocatable :: turning(:)
      character(number_room) :: name
      character(9) :: position
      integer :: k, c, n, order, i

      call devices%six%add()
      call devices%six%add(' LINKAGE 1, VALUES AND DERIVATIVES BY THE FIRST DRIVE (DERIVATIVES OF ANGLES IN RADIANS)')
      call devices%six%add('  OUTPUT                                           POSITION        DESIRED         ACTUAL'// &
                           '          ERROR')
      call names_of_numbers(set%sketch%outputs, names, turning)
      n = 0
      do k = 1, size(set%sketch%outputs)
         do c = 1, columns_of(set%sketch%outputs(k))
            n = n + 1
            name = upper_case(trim(names(n)))
            do order = 0, most_wished
               do i = 1, size(search%actual, 3)
                  if (search%problem%weight(n, order, i) <= 0.0_wp) cycle
                  write (position, '(i9)') i
                  associate (wanted => search%problem%wanted(n, order, i), actual => search%actual(n, order, i))
                     call devices%six%add('  '//name//orders(order)//position//general(wanted, 'E')//general(actual, 'E')// &
                                          general(wanted - actual, 'E'))
                  end associate
               end do
            end do
         end do
      end do
   end subroutine list_wished

   pure function number(value) result(text)
      real(wp), intent(in) :: value
      character(:), allocatable :: text

      text = trim(adjustl(general(value, 'E')))
   end function number
end module psalm_chain_search_list
