!> The group SEARCH: which search, from how many starts, for how long.
module psalm_search_group
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_rule, only: rule_t, a_flag, a_number, a_whole, a_word
   use psalm_solver_kind, only: solver_kind_t, find_solver, solver_names, default_solver, plain_name, &
                                family_simplex, family_least_squares, family_unknown
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_text, only: edit_distance, nearest_name, shortened, to_text
   implicit none (type, external)
   private
   public :: search_items
   public :: search_group_t, read_search_group, most_search_threads
   public :: order_free, order_given, order_either
   public :: ranking_none, ranking_common, ranking_shared
   public :: pareto_none, pareto_largest, pareto_angle, pareto_ratio, pareto_room, pareto_band

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
      real(wp) :: nearly = 1.0_wp          !! linkages up to this many times the best objective: the least sensitive first
      integer :: maxeval = 0               !! evaluations of each start; 0: as many as it takes
      real(wp) :: maxtime = 0.0_wp         !! seconds; 0: no limit
      integer :: threads = 0               !! 0: as the command line says
      integer :: order = order_given       !! free timing: how the points are visited
      integer :: few = 0                   !! positions that the search begins with; 0: all
      logical :: by_dyads = .false.        !! a start draws and improves one dyad's dimensions first
   end type search_group_t

   !> The items of the group.
   type(rule_t), parameter :: search_items(*) = [ &
      rule_t('SOLVER', a_word, '', '', 'SIMPLEX', '', &
             '''SIMPLEX'', the search of the thesis; ''LSQ'', least squares (Levenberg-Marquardt) with the '// &
             'exact Jacobian; or an algorithm of NLopt by its name, with or without NLOPT_'), &
      rule_t('NSTART', a_whole, '', '', '1', '[1,1000000]', &
             'starts: the first is your linkage, the others are drawn (VAR, or OPLOW to OPHIGH with VAR=0; '// &
             'ISTART); of the simplex: initial simplexes, the first from ISTART, the others from random integers of their own'), &
      rule_t('NBEST', a_whole, '', '', '1', '[1,1000000]', &
             'linkages that differ to keep; they are ranked in the listing, and device 7 holds them all as '// &
             'cases one after another, their rank in the title; of the simplex: of the ends of all simplexes and their best '// &
             'vertices every NPRINT iterations'), &
      rule_t('DIFFER', a_number, '', '', '0.05', '[0,1]', &
             'two linkages differ if a variable length differs by more than this part of the larger one, or a '// &
             'variable angle by more than this many radians; where the objectives are the same, a length must '// &
             'differ by ten times as much', &
             'must be within 0 and 1'), &
      rule_t('RANKING', a_whole, '', '', '0', '[0,2]', &
             '1: after the last case of the file (LAST=0 in the others) the linkages of all cases with '// &
             'RANKING=1 are ranked together, by the objective; 2: the same, and these cases share their starts '// &
             'by what they promise, see below'), &
      rule_t('PARETO', a_word, '', '', 'NONE', 'NONE LARGEST ANGLE RATIO ROOM BAND', &
             '''LARGEST'', ''ANGLE'', ''RATIO'', ''ROOM'' or ''BAND'': the NBEST linkages are those of which '// &
             'none other is better both in the objective and in this', &
             'must be one of ''LARGEST'', ''ANGLE'', ''RATIO'', ''ROOM'', ''BAND'''), &
      rule_t('NEARLY', a_number, '', '', '1', '[1,)', &
             'factor: of the NBEST linkages those whose objective is at most this many times the best come first, the least '// &
             'sensitive one before the others: by the cost of their tolerances with &ALLOC, else by the band of &TOLER'), &
      rule_t('MAXEVAL', a_whole, '', '', '0', '[0,)', &
             'evaluations of each start, with NFEW in each of its stages; 0: no limit'), &
      rule_t('MAXTIME', a_number, '', 's', '0', '[0,)', &
             'seconds; the best so far is written then (exit status 1); 0: no limit'), &
      rule_t('THREADS', a_whole, '', '', '0', '[0,1024]', &
             'threads that share the starts; `--threads` overrides it. The result does not depend on it (unless '// &
             'time runs out); 0: one'), &
      rule_t('FIRST', a_whole, '', '', '1', '[1,1000000]', &
             'number of the first start: a resumed search continues with it'), &
      rule_t('NFEW', a_whole, '', '', '0', '[0,)', &
             'few positions first: the search begins with so many of the prescribed positions, see below; 0: '// &
             'with all'), &
      rule_t('IDYAD', a_flag, '', '', '0', '', &
             '1: dyad by dyad, see below'), &
      rule_t('ORDER', a_whole, '', '', '1', '[0,2]', &
             'free timing: 1, the points are visited in their order, in the direction of DELT and within one '// &
             'turn; 2, the same in either direction; 0, in any order')]

contains

   !> Read the group. Errors: unknown solvers, numbers out of range, items that a solver does not have.
   subroutine read_search_group(group, search, findings)
      type(group_t), intent(inout) :: group
      type(search_group_t), intent(inout) :: search
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: name
      integer :: pareto

      search%given = group%line > 0
      call group%follow(search_items)
      name = default_solver
      call group%get_word('SOLVER', name, findings)
      call take(group, 'NSTART', search%nstart, findings)
      call take(group, 'FIRST', search%first, findings)
      call take(group, 'NBEST', search%nbest, findings)
      call take(group, 'DIFFER', search%differ, findings)
      call take(group, 'PARETO', pareto, findings)
      search%pareto = pareto - 1   ! NONE is 0
      call take(group, 'NEARLY', search%nearly, findings)
      if (search%nearly > 1.0_wp .and. search%pareto > pareto_none) &
         call out_of(group, 'NEARLY', 'PARETO ranks by the objective; give one of them', findings)
      if (search%nearly > 1.0_wp .and. search%nbest == 1) &
         call out_of(group, 'NEARLY', 'linkages to choose from are wanted; give NBEST', findings)
      call take(group, 'RANKING', search%ranking, findings)
      call take(group, 'MAXEVAL', search%maxeval, findings)
      call take(group, 'MAXTIME', search%maxtime, findings)
      call take(group, 'THREADS', search%threads, findings)
      call take(group, 'ORDER', search%order, findings)
      call take(group, 'NFEW', search%few, findings)
      call take(group, 'IDYAD', search%by_dyads, findings)
      search%solver = find_solver(name)
      if (search%solver%family == family_unknown) then
         call unknown_solver()
      else if (.not. search%solver%many_starts) then
         if (search%ranking > ranking_none) call other_solver('RANKING')
         if (search%maxeval > 0) call other_solver('MAXEVAL')
         if (search%by_dyads) call other_solver('IDYAD')
      else if (search%few > 0 .and. search%solver%family /= family_least_squares) then
         call out_of(group, 'NFEW', "few positions first is for SOLVER='SIMPLEX' and 'LSQ'", findings)
      else if (search%by_dyads .and. search%solver%family /= family_least_squares) then
         call out_of(group, 'IDYAD', "dyad by dyad is for SOLVER='LSQ'", findings)
      end if

   contains

      subroutine unknown_solver()
         integer, parameter :: most_reported = 6 ! of more than forty
         character(:), allocatable :: near, others, written
         integer, allocatable :: distance(:)
         integer :: i, next

         written = plain_name(name)
         associate (names => solver_names())
            near = nearest_name(written, names)
            distance = [(edit_distance(written, trim(names(i))), i=1, size(names))]
            others = ''
            do i = 1, most_reported
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

         call out_of(group, item, "a simplex is searched to NITER; this needs another SOLVER, as 'LSQ'", findings)
      end subroutine other_solver
   end subroutine read_search_group
end module psalm_search_group
