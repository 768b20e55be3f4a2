!> START, CONSTR and SIMPLX: repairs obey the rules of the thesis, searches reach what it publishes.
program test_search
   use cases, only: load_case
   use check, only: checks_t
   use psalm_angles, only: unit_vector
   use psalm_rrr, only: repair_link_pair
   use psalm_constr, only: constraints_t, vertex_problem_t, make_constraints, make_vertex_problem, constrain
   use psalm_data_set, only: data_set_t
   use psalm_data_set_text, only: write_data_set
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_devices, only: devices_t
   use psalm_nlp, only: repair_count_t
   use psalm_report, only: report_search
   use psalm_search_log, only: search_log_t
   use psalm_dimensions, only: dimensions_t
   use psalm_simplx, only: simplex_t, search_simplex
   use psalm_solver, only: search_state_t, stop_converged, stop_iterations, stop_small_objective
   use psalm_source, only: line_t
   use psalm_start, only: beginning_t, rules_of, start_simplex, read_vertices
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_synthesis, only: synthesis_t, synthesise
   use psalm_text, only: text_t
   implicit none (type, external)
   type(checks_t) :: t

   call link_pairs()
   call one_variable()
   call bounds()
   call slide_repairs()
   call conflict()
   call vertices()
   call what_was_variable()
   call published_search('needle_search', 2.0_wp)
   call published_search('needle_nelder_mead', 1.49_wp)
   call published_search('chain_short', 0.5_wp)
   call published_search('chain_long', 0.5_wp)
   call published_search('brake_reaction', 28.66_wp)
   call suspension()
   call stops()
   call supplied_vertices()
   call repeats()
   call t%report()

contains

   !> A vertex as a problem of its own: the objective of an evaluation; violated where the linkage does not close.
   subroutine vertices()
      type(problem_t), target :: problem
      class(data_set_t), allocatable :: set
      type(vertex_problem_t) :: search
      real(wp), allocatable :: x(:)
      real(wp) :: objective, violation, evaluated
      integer :: loop

      allocate (set)
      call load_case('needle', problem, set)
      call make_vertex_problem(set, problem, search)
      x = problem%parameters%first_values(problem%given)
      call search%measure(x, objective, violation)
      call problem%evaluate(problem%given, evaluated, loop)
      call t%equal_integer(loop, 0, 'the needle linkage closes')
      call t%is_true(abs(objective - evaluated) <= 0.0_wp .and. violation <= 0.0_wp, 'a vertex that closes violates nothing')
      call search%measure(0.1_wp*x, objective, violation)
      call t%is_true(violation > 0.0_wp, 'one that does not is told')
   end subroutine vertices

   !> Device 7 tells in comments which dimensions were variable: those of the data set.
   subroutine what_was_variable()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(text_t), save :: text
      character, parameter :: nl = new_line('a')
      character(:), allocatable :: content

      call load_case('needle', problem, set)
      call write_data_set(set, problem, problem%given, text)
      content = text%content()
      call t%is_true(index(content, nl//'! IVA  0 1 1 1 0 0'//nl//'! IVA  0 1 1 1 0 0'//nl) > 0, 'variable lengths in comments')
      call t%is_true(index(content, nl//'! IVG  0 0 0 1 0 0'//nl//'! IVG  0 0 0 1 0 0'//nl) > 0, 'variable angles in comments')
      call t%is_true(index(content, nl//'! ILKOUT=0 INGOUT=1 IORIG=0 ICRK=1 ') > 0, 'other variables in comments')
   end subroutine what_was_variable

   !> Transmission angle of a dyad, degrees.
   pure real(wp) function angle_of(p, q, d)
      real(wp), intent(in) :: p, q, d

      angle_of = acos((p*p + q*q - d)/(2.0_wp*p*q))/radians_per_degree
   end function angle_of

   !> Both lengths variable: k added to both, or the shorter lengthened, or both made equal (spec, section 4).
   subroutine link_pairs()
      real(wp) :: p, q, k, c, s
      logical :: repaired

      call unit_vector(140.0_wp, c, s)
      p = 4.0_wp
      q = 3.0_wp
      call repair_link_pair([49.0_wp], 50.0_wp, .true., .true., p, q, repaired)
      k = -3.5_wp + 0.5_wp*sqrt((2.0_wp*49.0_wp - (1.0_wp + c))/(1.0_wp - c))
      call t%close_to(p, 4.0_wp + k, 1.0e-5_wp, 'both too short: k is added to p')
      call t%close_to(q, 3.0_wp + k, 1.0e-5_wp, 'both too short: k is added to q')
      call t%close_to(angle_of(p, q, 49.0_wp), 140.0_wp, 1.0e-6_wp, 'the largest angle is reached')
      p = 1.0_wp
      q = 5.0_wp
      call repair_link_pair([16.0_wp], 50.0_wp, .true., .true., p, q, repaired)
      call unit_vector(40.0_wp, c, s)
      call t%close_to(p, 5.0_wp*c - sqrt(16.0_wp - 25.0_wp*s*s), 1.0e-5_wp, 'difference too great: the shorter is lengthened')
      call t%close_to(q, 5.0_wp, 0.0_wp, 'and the longer stays')
      p = 1.0_wp
      q = 5.0_wp
      call repair_link_pair([4.0_wp], 50.0_wp, .true., .true., p, q, repaired)
      call t%close_to(p, 1.0_wp/sin(20.0_wp*radians_per_degree), 1.0e-5_wp, 'q sin(mu) > h: both become h/(2 sin(mu/2))')
      call t%close_to(q, p, 1.0e-15_wp, 'both')
      call repair_link_pair([4.0_wp, 400.0_wp], 50.0_wp, .true., .true., p, q, repaired)
      p = 1.0_wp
      q = 5.0_wp
      call repair_link_pair([4.0_wp, 400.0_wp], 50.0_wp, .true., .true., p, q, repaired)
      call t%is_true(.not. repaired, 'links made equal may not be lengthened again at another position')
      p = 4.0_wp
      q = 3.0_wp
      call repair_link_pair([49.0_wp], 90.0_wp, .true., .true., p, q, repaired)
      call t%close_to(p + q, 7.0_wp, 1.0e-6_wp, 'closure only: k = (h-p-q)/2')
      call t%is_true(repaired, 'closure only: repaired')
   end subroutine link_pairs

   !> One length variable: the other stays, the angle is in limits.
   subroutine one_variable()
      real(wp) :: p, q, want
      real(wp), parameter :: squares(4) = [81.0_wp, 49.0_wp, 30.0_wp, 4.0_wp]
      integer :: i, which
      logical :: repaired

      do i = 1, size(squares)
         do which = 1, 2
            p = 4.0_wp
            q = 3.0_wp
            if (i == 4) p = 6.0_wp
            want = merge(q, p, which == 1)
            call repair_link_pair(squares(i:i), 50.0_wp, which == 1, which == 2, p, q, repaired)
            if (repaired) then
               call t%close_to(merge(q, p, which == 1), want, 0.0_wp, 'one variable: the other length stays')
               call t%is_true(angle_of(p, q, squares(i)) < 140.0_wp .and. angle_of(p, q, squares(i)) > 40.0_wp, &
                              'one variable: the transmission angle is in limits')
            else
               call t%is_true(i == 4, 'one variable: only the fourth cannot be repaired')
            end if
         end do
      end do
   end subroutine one_variable

   subroutine bounds()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(constraints_t) :: constraints
      type(repair_count_t) :: counts
      real(wp), allocatable :: v(:)
      real(wp) :: f
      integer :: evaluations
      logical :: feasible

      allocate (problem, set)
      call load_case('chain_short', problem, set)
      set%limits%limval = 1
      set%limits%oplow(:2) = [320.0_wp, 70.0_wp]
      set%limits%ophigh(:2) = [330.0_wp, 72.0_wp]
      call make_constraints(set, problem, constraints)
      v = [400.0_wp, 60.0_wp]
      evaluations = 0
      call constrain(problem, constraints, v, f, feasible, evaluations, counts)
      call t%close_to(v(1), 329.999_wp, 1.0e-15_wp, 'a value above its bound is put STEPIN inside')
      call t%close_to(v(2), 70.001_wp, 1.0e-15_wp, 'a value below its bound is put STEPIN inside')
      call t%equal_integer(evaluations, 1, 'evaluations are counted')
      set%limits%limval = 0
      call make_constraints(set, problem, constraints)
      v = [-1.0_wp, 71.0_wp]
      call constrain(problem, constraints, v, f, feasible, evaluations, counts)
      call t%is_true(v(1) > 0.0_wp, 'a length stays positive without bounds')
   end subroutine bounds

   !> Guides are shortened to h - TOGGLE, links lengthened to abs(d) + TOGGLE.
   subroutine slide_repairs()
      type(problem_t), save :: problem
      type(data_set_t), save :: set

      call load_case('dyad2_oscillating_cylinder', problem, set)
      call repaired(problem, set, 'type 2', 3, 100.0_wp, 90.0_wp - 0.1_wp)
      call load_case('dyad3_quick_return', problem, set)
      call repaired(problem, set, 'type 3', 2, 150.0_wp, 100.0_wp - 0.1_wp)
      call load_case('dyad4_slider_crank', problem, set)
      call repaired(problem, set, 'type 4', 2, 20.0_wp, 50.0_wp + 0.1_wp)
      call load_case('dyad5_turning_block', problem, set)
      call repaired(problem, set, 'type 5', 3, 20.0_wp, 35.0_wp + 0.1_wp)
   end subroutine slide_repairs

   subroutine repaired(problem, set, name, arc, length, want)
      type(problem_t), intent(in) :: problem
      type(data_set_t), intent(in) :: set
      character(*), intent(in) :: name
      integer, intent(in) :: arc
      real(wp), intent(in) :: length, want
      type(problem_t) :: searched
      type(constraints_t) :: constraints
      type(repair_count_t) :: counts
      type(dimensions_t) :: dimensions
      real(wp) :: v(1), f
      integer :: evaluations
      logical :: feasible

      ! make the arc the one variable and give desired values, as a user would
      searched = problem
      call searched%set_desired(spread(spread(1.0_wp, 1, problem%positions), 2, problem%output%kind%components))
      searched%parameters%length_variable(arc) = 1
      deallocate (searched%parameters%variables)
      allocate (searched%parameters%variables(1))
      searched%parameters%variables(1)%kind = 1
      searched%parameters%variables(1)%loop = 1
      searched%parameters%variables(1)%arc = arc
      searched%parameters%variables(1)%n = arc
      dimensions = problem%given
      call make_constraints(set, searched, constraints)
      v = length
      evaluations = 0
      call constrain(searched, constraints, v, f, feasible, evaluations, counts)
      call t%is_true(feasible, name//': repaired')
      call t%close_to(v(1), want, 1.0e-14_wp, name//': length after repair')
      call t%equal_integer(counts%repairs, 1, name//': one repair')
   end subroutine repaired

   !> Demands that conflict: the vertex moves a quarter of the way towards a feasible one, until it is feasible.
   subroutine conflict()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(constraints_t), save :: constraints
      type(repair_count_t), save :: counts
      real(wp) :: v(2), f
      integer :: evaluations, k
      logical :: feasible
      real(wp), parameter :: home(2) = [325.7_wp, 71.4_wp], far(2) = [500.0_wp, 20.0_wp]

      call load_case('chain_short', problem, set)
      call make_constraints(set, problem, constraints)
      v = far
      evaluations = 0
      call constrain(problem, constraints, v, f, feasible, evaluations, counts)
      call t%is_true(.not. feasible, 'nothing to repair, nowhere to go: not feasible')
      v = far
      call constrain(problem, constraints, v, f, feasible, evaluations, counts, towards=home)
      call t%is_true(feasible .and. counts%moves > 0, 'moved until feasible')
      k = counts%moves
      call t%close_to(v(1), home(1) + 0.75_wp**k*(far(1) - home(1)), 1.0e-14_wp, 'a quarter of the way at each move')
   end subroutine conflict

   subroutine run_search(name, problem, set, simplex, state, motion)
      character(*), intent(in) :: name
      type(problem_t), intent(out) :: problem
      type(data_set_t), intent(out) :: set
      type(simplex_t), intent(out) :: simplex
      type(search_state_t), intent(out) :: state
      type(motion_t), intent(out) :: motion

      call load_case(name, problem, set)
      call search_from(problem, set, simplex, state, motion)
   end subroutine run_search

   subroutine search_from(problem, set, simplex, state, motion)
      type(problem_t), intent(inout), target :: problem
      type(data_set_t), intent(in) :: set
      type(simplex_t), intent(out) :: simplex
      type(search_state_t), intent(out) :: state
      type(motion_t), intent(out) :: motion
      type(vertex_problem_t) :: vertices
      type(dimensions_t) :: dimensions
      type(beginning_t) :: beginning
      type(stop_t) :: never
      real(wp) :: none(size(problem%parameters%variables), 0)
      logical :: feasible

      call make_vertex_problem(set, problem, vertices)
      call start_simplex(set, vertices, none, set%method%istart, simplex, feasible, beginning)
      call t%is_true(feasible, 'the published start is feasible')
      call search_simplex(rules_of(set), vertices, simplex, never, state)
      dimensions = problem%given
      call problem%parameters%apply(simplex%v(:, simplex%best), dimensions)
      call problem%analyse(dimensions, motion)
   end subroutine search_from

   !> The search ends at or below the published objective with every constraint kept.
   subroutine published_search(name, published)
      character(*), intent(in) :: name
      real(wp), intent(in) :: published
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(simplex_t) :: simplex
      type(search_state_t) :: state
      type(motion_t) :: motion

      allocate (problem, set)
      call run_search(name, problem, set, simplex, state, motion)
      call t%is_true(motion%total <= published, name//': as good as published')
      call t%equal_integer(size(motion%violations), 0, name//': no constraint is violated')
      call t%equal_integer(state%reason, stop_converged, name//': converged')
      call t%close_to(motion%total, state%best, 1.0e-13_wp, name//': analysis and search agree')
   end subroutine published_search

   !> Within 0.3 mm of 600 over at least 227 mm of vertical travel.
   subroutine suspension()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(simplex_t) :: simplex
      type(search_state_t) :: state
      type(motion_t) :: motion
      type(dimensions_t) :: dimensions

      allocate (problem, set)
      call run_search('suspension', problem, set, simplex, state, motion)
      call t%is_true(all(abs(motion%error(:, 1)) <= 0.3_wp), 'suspension: within 0.3 mm of 600')
      dimensions = problem%given
      call problem%parameters%apply(simplex%v(:, simplex%best), dimensions)
      problem%desired = .false.
      problem%motion = 0
      call problem%want_derivatives(.false.)
      call problem%analyse(dimensions, motion)
      call t%is_true(maxval(motion%actual(:, 2)) - minval(motion%actual(:, 2)) >= 227.0_wp, &
                     'suspension: 227 mm of vertical travel')
   end subroutine suspension

   subroutine stops()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(simplex_t) :: simplex
      type(search_state_t) :: state
      type(motion_t) :: motion

      allocate (problem, set)
      call run_search('needle', problem, set, simplex, state, motion)
      call t%equal_integer(state%reason, stop_iterations, 'NITER stops the search')
      call t%equal_integer(state%iteration, 2, 'after NITER iterations')
      set%method%niter = 2000
      set%method%fmin = 5.0_wp
      call search_from(problem, set, simplex, state, motion)
      call t%equal_integer(state%reason, stop_small_objective, 'FMIN stops the search')
      call t%is_true(state%best < 5.0_wp, 'below FMIN')
   end subroutine stops

   !> Device 7 read as device 4 gives the same vertices to the printed digits, final ones first.
   subroutine supplied_vertices()
      type(problem_t), save :: problem
      type(data_set_t), save :: set
      type(devices_t), save :: devices
      type(synthesis_t), save :: search
      type(dimensions_t), save :: dimensions
      type(stop_t), save :: stop
      type(search_log_t), save :: log
      type(diagnostics_t), save :: findings
      type(line_t), allocatable, save :: lines(:)
      real(wp), allocatable :: v(:, :), none(:, :)
      character(:), allocatable :: text
      integer :: at

      call load_case('chain_short', problem, set)
      allocate (none(2, 0))
      dimensions = problem%given
      call synthesise(set, none, problem, 1, stop, dimensions, search)
      call devices%begin_case(set%title, .false.)
      call report_search(set, search, log, devices)
      text = devices%seven%content()
      allocate (lines(0))
      do while (len(text) > 0)
         at = index(text, new_line('a'))
         lines = [lines, line_t(text(:at - 1))]
         text = text(at + 1:)
      end do
      call read_vertices(lines, 2, 6, v, findings)
      call t%equal_integer(findings%exit_code(), 0, 'six vertices are found in device 7')
      call t%close_to(v(1, 1), 331.67_wp, 1.0e-3_wp, 'final vertices come first')
      call t%close_to(v(1, 4), 325.7_wp, 1.0e-6_wp, 'then the initial ones')
      call read_vertices(lines, 2, 7, v, findings)
      call t%finds(findings, '7 vertices are declared, but device 4 holds 6', 'too few vertices')
      call read_vertices([line_t('     1.0            2.0'), line_t('     3.0            x4.0')], 2, 2, v, findings)
      call t%finds(findings, 'device 4, line 2: coordinate 2', 'a vertex that is not a number')
   end subroutine supplied_vertices

   !> The same input gives the same bits.
   subroutine repeats()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(simplex_t) :: first, second
      type(search_state_t) :: state
      type(motion_t) :: motion

      allocate (problem, set)
      call run_search('needle_search', problem, set, first, state, motion)
      call run_search('needle_search', problem, set, second, state, motion)
      call t%is_true(all(abs(first%v - second%v) <= 0.0_wp), 'a search repeats to the last bit')
   end subroutine repeats
end program test_search
