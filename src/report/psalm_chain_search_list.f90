!> What the search over a sketch in poses has to report: how it went, the linkages found, their variables by name.
module psalm_chain_search_list
   use psalm_chain_problem, only: unknown_name
   use psalm_chain_synthesis, only: chain_synthesis_t
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_equal_items, only: equality_words
   use psalm_kinds, only: wp
   use psalm_number_format, only: figures_of, in_sentence
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: report_chain_search

   integer, parameter :: name_length = 40   !! characters of a variable's name in the listing

contains

   !> Append to the listing, to device 1 and to the remarks.
   subroutine report_chain_search(set, search, devices)
      type(data_set_t), intent(in) :: set
      type(chain_synthesis_t), intent(in) :: search
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: line
      character(name_length) :: name
      character(15), allocatable :: values(:, :)
      integer :: k, v

      line = to_text(search%starts)//' starts, '//to_text(search%feasible)//' led to a linkage, '//to_text(search%evaluations)// &
             ' evaluations'
      if (size(search%best) == 0) then
         line = 'no linkage that obeys the constraints was found; what is listed is the one given: '//line
         call devices%note_violation()
      else
         line = line//'; best objective'//in_sentence(.true., search%best(1)%objective)
      end if
      if (search%refused) line = trim(set%search%solver%name)//' does not work on this problem: '//line
      if (search%stopped) then
         line = 'stopped before all starts were made: '//line
         call devices%note_violation()
      end if
      call put_run(search, devices%cases(devices%last_case()))
      call devices%one%add(' '//set%title)
      call devices%one%add(' '//line)
      call devices%remark(set, line)
      if (size(search%best) == 0) return
      call devices%six%add(' '//set%title)
      call devices%six%add()
      if (search%first_feasible) call devices%six%add(' SUM OF SQUARES OF THE DRAWING'// &
                                                        in_sentence(.true., search%first_objective))
      do k = 1, size(search%best)
         call devices%six%add(' LINKAGE '//to_text(k)//', START '//to_text(search%best(k)%start)//': SUM OF SQUARES'// &
                              in_sentence(.true., search%best(k)%objective))
         call devices%six%add('  VARIABLE                                        DRAWING          FOUND')
         associate (n => search%problem%variables)
            values = reshape(figures_of(.true., [search%problem%first(:n), search%best(k)%x(:n)]), [n, 2])
         end associate
         do v = 1, size(values, 1)
            name = unknown_name(set%sketch, v)
            call devices%six%add('  '//name//values(v, 1)//values(v, 2))
         end do
         call list_equals(set, search, k, devices)
      end do
      call devices%six%add()
      call put_found(set, search, devices%cases(devices%last_case()))
   end subroutine report_chain_search

   !> Outputs that are to be equal of the linkage of rank k.
   subroutine list_equals(set, search, k, devices)
      type(data_set_t), intent(in) :: set
      type(chain_synthesis_t), intent(in) :: search
      integer, intent(in) :: k
      type(devices_t), intent(inout) :: devices
      real(wp), allocatable :: compared(:, :)     !! shape (2, relations)
      character(15) :: figures(2)
      character(name_length) :: name
      integer :: q

      if (.not. allocated(set%sketch%equalities)) return
      call search%problem%find_equals(search%best(k)%x, compared)
      if (size(compared) == 0) return             ! a position is not reached
      call devices%six%add('  OUTPUTS THAT ARE TO BE EQUAL                     FIRST         SECOND')
      do q = 1, size(compared, 2)
         associate (of => search%problem%relations(q))
            name = equality_words(set%sketch, of%equality)
            if (any(set%sketch%equalities(of%equality)%positions == 0)) name = trim(name)//', POSITION '//to_text(of%positions(1))
            figures = figures_of(.true., compared(:, q))
            call devices%six%add('  '//name//figures(1)//figures(2))
         end associate
      end do
   end subroutine list_equals

   !> Table search: how it went. The objective of a drawing that does not obey the constraints is not known.
   pure subroutine put_run(search, tables)
      type(chain_synthesis_t), intent(in) :: search
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      real(wp) :: best

      best = huge(1.0_wp)            ! not known
      if (size(search%best) > 0) best = search%best(1)%objective
      table = table_of('search', 'one row: how the search in the poses of the sketch went', audience=for_programs)
      call table%add('objective', [best])
      call table%add('objective_of_drawing', [search%first_objective], known=[search%first_feasible])
      call table%add('starts', [search%starts])
      call table%add('feasible', [search%feasible])
      call table%add('evaluations', [search%evaluations])
      call table%add('stopped', [search%stopped])
      call table%add('refused', [search%refused])
      call tables%put(table)
   end subroutine put_run

   !> Tables for other programs: ranking, and the dimensions of each linkage.
   subroutine put_found(set, search, tables)
      type(data_set_t), intent(in) :: set
      type(chain_synthesis_t), intent(in) :: search
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length), allocatable :: names(:)
      integer :: k, v

      associate (best => search%best, n => search%problem%variables)
         table = table_of('ranking', 'a row for each linkage found, the best first', audience=for_programs)
         call table%add('rank', [(k, k=1, size(best))])
         call table%add('objective', best%objective)
         call table%add('start', best%start)
         call tables%put(table)
         allocate (names(n*size(best)))
         do k = 1, size(names)
            names(k) = unknown_name(set%sketch, modulo(k - 1, n) + 1)
         end do
         table = table_of('ranked_dimensions', 'a row for each linkage found and dimension that varies: length or degrees', &
                          audience=for_programs)
         call table%add('rank', [((k, v=1, n), k=1, size(best))])
         call table%add('dimension', names)
         call table%add('value', [(best(k)%x(:n), k=1, size(best))])
         call table%add('drawing', [(search%problem%first(:n), k=1, size(best))])
      end associate
      call tables%put(table)
   end subroutine put_found
end module psalm_chain_search_list
