!> The group SEARCH: which search, from how many starts, for how long.
module psalm_search_group
   use psalm_group, only: group_t, check_range, out_of
   use psalm_kinds, only: wp
   use psalm_solver_kind, only: solver_kind_t, find_solver, solver_names, default_solver, plain_name, &
                                family_simplex, family_least_squares, family_unknown
   use psalm_status, only: diagnostics_t
   use psalm_text, only: edit_distance, nearest_name, shortened, to_text, upper_case
   implicit none (type, external)
   private
   public :: search_group_t, read_search_group, most_search_threads
   public :: order_free, order_given, order_either
   public :: ranking_none, ranking_common, ranking_shared
   public :: pareto_none, pareto_largest, pareto_angle, pareto_ratio, pareto_room, pareto_band

   integer, parameter :: most_starts = 1000000      !! above this a number is taken for a slip of the pen
   integer, parameter :: most_search_threads = 1024

   ! ORDER: how points without prescribed timing are visited
   integer, parameter :: order_free = 0             !! in any order
   integer, parameter :: order_given = 1            !! in their order, the input going the way of DELT
   integer, parameter :: order_either = 2           !! in their order, the input going either way

   ! RANKING: cases of a file that are ranked together
   integer, parameter :: ranking_none = 0           !! the case is not
   integer, parameter :: ranking_common = 1         !! each is searched from all of its starts
   integer, parameter :: ranking_shared = 2         !! the starts go to those that promise most

   ! PARETO: what is weighed against the objective
   integer, parameter :: pareto_none = 0
   integer, parameter :: pareto_largest = 1         !! largest error
   integer, parameter :: pareto_angle = 2           !! least transmission angle
   integer, parameter :: pareto_ratio = 3           !! longest to shortest link
   integer, parameter :: pareto_room = 4            !! longer side of the box round all joints
   integer, parameter :: pareto_band = 5            !! tolerance band
   character(*), parameter :: pareto_names(0:5) = [character(7) :: 'NONE', 'LARGEST', 'ANGLE', 'RATIO', 'ROOM', 'BAND']

   !> How to search.
   type :: search_group_t
      logical :: given = .false.           !! the group was given
      type(solver_kind_t) :: solver = solver_kind_t(name=default_solver, family=family_simplex, many_starts=.false.)
      integer :: nstart = 1                !! starts
      integer :: first = 1                 !! number of the first one; a restart continues with it
      integer :: nbest = 1                 !! linkages kept
      real(wp) :: differ = 0.05_wp         !! by how much a length, of itself, or an angle, in radians, makes a linkage another
      integer :: ranking = ranking_none    !! linkages of all cases of the file that ask for it are ranked together
      integer :: pareto = pareto_none      !! linkages kept are those unbeaten in the objective and this
      integer :: maxeval = 0               !! evaluations of each start; 0: as many as it takes
      real(wp) :: maxtime = 0.0_wp         !! seconds; 0: no limit
      integer :: threads = 0               !! 0: as the command line says
      integer :: order = order_given       !! free timing: how the points are visited
      integer :: few = 0                   !! positions that the search begins with; 0: all
      logical :: by_dyads = .false.        !! a start draws and improves one dyad's dimensions first
   end type search_group_t

contains

   !> Read the group. Errors: unknown solvers, numbers out of range, several starts of the simplex.
   subroutine read_search_group(group, search, findings)
      type(group_t), intent(inout) :: group
      type(search_group_t), intent(inout) :: search
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: name, other
      integer :: idyad

      search%given = group%line > 0
      name = default_solver
      call group%get_word('SOLVER', name, findings)
      call group%get_integer('NSTART', search%nstart, findings)
      call group%get_integer('FIRST', search%first, findings)
      call group%get_integer('NBEST', search%nbest, findings)
      call group%get_real('DIFFER', search%differ, findings)
      other = trim(pareto_names(pareto_none))
      call group%get_word('PARETO', other, findings)
      search%pareto = findloc(pareto_names, upper_case(trim(adjustl(other))), dim=1) - 1
      call group%get_integer('RANKING', search%ranking, findings)
      call check_range(group, 'RANKING', search%ranking, ranking_none, ranking_shared, findings)
      call group%get_integer('MAXEVAL', search%maxeval, findings)
      call group%get_real('MAXTIME', search%maxtime, findings)
      call group%get_integer('THREADS', search%threads, findings)
      call group%get_integer('ORDER', search%order, findings)
      call check_range(group, 'ORDER', search%order, order_free, order_either, findings)
      call group%get_integer('NFEW', search%few, findings)
      call check_range(group, 'NFEW', search%few, 0, huge(1), findings)
      idyad = 0
      call group%get_integer('IDYAD', idyad, findings)
      call check_range(group, 'IDYAD', idyad, 0, 1, findings)
      search%by_dyads = idyad == 1
      call check_range(group, 'NSTART', search%nstart, 1, most_starts, findings)
      call check_range(group, 'FIRST', search%first, 1, most_starts, findings)
      call check_range(group, 'NBEST', search%nbest, 1, most_starts, findings)
      call check_range(group, 'MAXEVAL', search%maxeval, 0, huge(1), findings)
      call check_range(group, 'THREADS', search%threads, 0, most_search_threads, findings)
      if (.not. (search%differ >= 0.0_wp .and. search%differ <= 1.0_wp)) call out_of(group, 'DIFFER', &
                                                                               'must be within 0 and 1', findings)
      if (search%pareto < 0) call out_of(group, 'PARETO', "must be one of 'LARGEST', 'ANGLE', 'RATIO', 'ROOM', 'BAND'", findings)
      if (search%maxtime < 0.0_wp) call out_of(group, 'MAXTIME', 'must not be negative', findings)
      search%solver = find_solver(name)
      if (search%solver%family == family_unknown) then
         call unknown_solver()
      else if (.not. search%solver%many_starts) then
         if (search%nstart > 1) call other_solver('NSTART')
         if (search%nbest > 1) call other_solver('NBEST')
         if (search%pareto > pareto_none) call other_solver('PARETO')
         if (search%ranking > ranking_none) call other_solver('RANKING')
         if (search%first > 1) call other_solver('FIRST')
         if (search%maxeval > 0) call other_solver('MAXEVAL')
         if (search%by_dyads) call other_solver('IDYAD')
      else if (search%few > 0 .and. search%solver%family /= family_least_squares) then
         call out_of(group, 'NFEW', "few positions first is for SOLVER='SIMPLEX' and 'LSQ'", findings)
      else if (search%by_dyads .and. search%solver%family /= family_least_squares) then
         call out_of(group, 'IDYAD', "dyad by dyad is for SOLVER='LSQ'", findings)
      end if

   contains

      subroutine unknown_solver()
         integer, parameter :: most_told = 6 ! of more than forty
         character(:), allocatable :: near, others, written
         integer, allocatable :: distance(:)
         integer :: i, next

         written = plain_name(name)
         associate (names => solver_names())
            near = nearest_name(written, names)
            distance = [(edit_distance(written, trim(names(i))), i=1, size(names))]
            others = ''
            do i = 1, most_told
               next = minloc(distance, dim=1)
               distance(next) = huge(1)
               if (names(next) == near) cycle
               others = others//', '//trim(names(next))
            end do
            if (len(near) > 0) then
               near = "did you mean '"//near//"'? Near it are "
            else
               near = 'the nearest names are '
            end if
            call out_of(group, 'SOLVER', "no solver is called '"//shortened(written)//"'; "//near// &
                        others(3:)//'; usual ones are LSQ, SIMPLEX, LD_SLSQP and LN_COBYLA; the manual lists all '// &
                        to_text(size(names)), findings)
         end associate
      end subroutine unknown_solver

      subroutine other_solver(item)
         character(*), intent(in) :: item

         call out_of(group, item, "the simplex makes one search to NITER; this needs another SOLVER, as 'LSQ'", findings)
      end subroutine other_solver
   end subroutine read_search_group
end module psalm_search_group
