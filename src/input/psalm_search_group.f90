!> The group SEARCH: which search, from how many starts, for how long.
module psalm_search_group
   use psalm_group, only: group_t, check_range, out_of, read_flag
   use psalm_kinds, only: wp
   use psalm_solver_kind, only: solver_kind_t, find_solver, solver_names, default_solver, plain_name, &
                                family_simplex, family_unknown
   use psalm_status, only: diagnostics_t
   use psalm_text, only: nearest_name
   implicit none (type, external)
   private
   public :: search_group_t, read_search_group, most_search_threads

   integer, parameter :: most_starts = 1000000      !! above this a number is taken for a slip of the pen
   integer, parameter :: most_search_threads = 1024

   !> How to search.
   type :: search_group_t
      logical :: given = .false.           !! the group was given
      type(solver_kind_t) :: solver = solver_kind_t(name=default_solver, family=family_simplex, many_starts=.false.)
      integer :: nstart = 1                !! starts
      integer :: first = 1                 !! number of the first one; a restart continues with it
      integer :: nbest = 1                 !! linkages kept
      integer :: maxeval = 0               !! evaluations of each start; 0: as many as it takes
      real(wp) :: maxtime = 0.0_wp         !! seconds; 0: no limit
      integer :: threads = 0               !! 0: as the command line says
      integer :: order = 1                 !! free timing: the points are visited in their order
   end type search_group_t

contains

   !> Read the group. Errors: unknown solvers, numbers out of range, several starts of the simplex.
   subroutine read_search_group(group, search, findings)
      type(group_t), intent(inout) :: group
      type(search_group_t), intent(inout) :: search
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: name

      search%given = group%line > 0
      name = default_solver
      call group%get_word('SOLVER', name, findings)
      call group%get_integer('NSTART', search%nstart, findings)
      call group%get_integer('FIRST', search%first, findings)
      call group%get_integer('NBEST', search%nbest, findings)
      call group%get_integer('MAXEVAL', search%maxeval, findings)
      call group%get_real('MAXTIME', search%maxtime, findings)
      call group%get_integer('THREADS', search%threads, findings)
      call read_flag(group, 'ORDER', search%order, findings)
      call check_range(group, 'NSTART', search%nstart, 1, most_starts, findings)
      call check_range(group, 'FIRST', search%first, 1, most_starts, findings)
      call check_range(group, 'NBEST', search%nbest, 1, most_starts, findings)
      call check_range(group, 'MAXEVAL', search%maxeval, 0, huge(1), findings)
      call check_range(group, 'THREADS', search%threads, 0, most_search_threads, findings)
      if (search%maxtime < 0.0_wp) call out_of(group, 'MAXTIME', 'must not be negative', findings)
      search%solver = find_solver(name)
      if (search%solver%family == family_unknown) then
         call unknown_solver()
      else if (.not. search%solver%many_starts) then
         if (search%nstart > 1) call other_solver('NSTART')
         if (search%nbest > 1) call other_solver('NBEST')
         if (search%first > 1) call other_solver('FIRST')
         if (search%maxeval > 0) call other_solver('MAXEVAL')
      end if

   contains

      subroutine unknown_solver()
         character(:), allocatable :: near, all_names
         integer :: i

         associate (names => solver_names())
            all_names = trim(names(1))
            do i = 2, size(names)
               all_names = all_names//', '//trim(names(i))
            end do
            near = nearest_name(plain_name(name), names)
         end associate
         if (len(near) > 0) near = "did you mean '"//near//"'? "
         call out_of(group, 'SOLVER', "no solver is called '"//plain_name(name)//"'; "//near//'There are '//all_names, findings)
      end subroutine unknown_solver

      subroutine other_solver(item)
         character(*), intent(in) :: item

         call out_of(group, item, "the simplex makes one search to NITER; this needs another SOLVER, as 'LSQ'", findings)
      end subroutine other_solver
   end subroutine read_search_group
end module psalm_search_group
