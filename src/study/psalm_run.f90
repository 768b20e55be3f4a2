!> One case from data set to listings and devices: SETUP, START, SIMPLX, FINALE in their order.
!>
!> Nothing is printed here and no file is written; the caller gets texts, messages and an exit status.
module psalm_run
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_check_list, only: list_input, list_setup, list_arcs
   use psalm_condition, only: condition_t, prepare_condition, condition_at
   use psalm_constr, only: constraints_t, make_constraints
   use psalm_data_set, only: data_set_t, title_columns, default_niter
   use psalm_data_set_text, only: write_vertices, write_data_set
   use psalm_doubts, only: find_doubts, list_reference_joints
   use psalm_error, only: problem_t, motion_t, make_problem
   use psalm_finale, only: list_results, describe_violation, describe_crossing
   use psalm_kinds, only: wp, right_angle
   use psalm_margin_list, only: list_margins, describe_margin
   use psalm_margins, only: margin_t, inspector_t, prepare_inspector, inspect, is_violated, margin_slides, margin_guide, &
                            margin_bound
   use psalm_mark, only: mark_width
   use psalm_plot_data, only: write_block
   use psalm_regions, only: check_regions
   use psalm_search, only: result_t, search_many
   use psalm_setup, only: set_up
   use psalm_topology, only: topology_t, dimensions_t
   use psalm_simplx, only: search_monitor_t, search_state_t, search_simplex, stop_iterations, stop_converged, stop_interrupted
   use psalm_source, only: line_t
   use psalm_start, only: simplex_t, start_simplex, read_vertices
   use psalm_status, only: diagnostics_t, exit_done, exit_violation
   use psalm_stop, only: stop_t
   use psalm_summary, only: summary_t, summarise
   use psalm_summary_text, only: write_summary
   use psalm_sweep, only: sweep_inputs
   use psalm_system, only: memory_to_be_had, threads_to_be_had
   use psalm_text, only: text_t, general, to_text
   use psalm_tolerance, only: tolerance_t, sample_t, find_tolerances, draw_sample, list_tolerances, plot_tolerances
   implicit none (type, external)
   private
   public :: devices_t, demand_t, version, check_case, run_case, sum_up, header_of

   character(*), parameter :: version = '0.1.0' !! of the suite, as in fpm.toml

   integer(int64), parameter :: megabyte = 1000000_int64
   integer, parameter :: most_told = 5 !! violations on standard error; the listing has all
   integer, parameter :: most_summarised = 10 !! cases of a file whose summary is written

   !> Bytes that a program needs for each position: measured for psalm, estimated for kalm's
   !> arcs and for balm; texts take most of them.
   type :: demand_t
      integer :: position = 400        !! always
      integer :: arc = 100             !! more for each arc
      logical :: ktheta_only = .true.  !! arcs count with KTHETA=1 only
   end type demand_t

   !> What the devices receive. Cases of one file follow each other.
   type :: devices_t
      type(text_t) :: one     !! progress, random integers, violations
      type(text_t) :: two     !! limits of the initial simplex, generated coordinates
      type(text_t) :: six     !! results
      type(text_t) :: seven   !! vertices and data set
      type(text_t) :: eight   !! annotated input, intermediate arrays, all arcs
      type(text_t) :: nine    !! plotting data
      type(text_t) :: notes   !! remarks for standard error
      type(text_t) :: summary !! what the linkage does, for standard error
      logical :: wants_summary = .false. !! asked for by the caller
      integer :: summarised = 0          !! cases met by the summary
      integer :: code = exit_done !! exit status so far
      character(mark_width) :: mark = '' !! of the run; blank: none
   end type devices_t

contains

   !> First line of device 8.
   pure function header_of(program, mark) result(line)
      character(*), intent(in) :: program      !! its name in capitals
      character(*), intent(in) :: mark         !! of the run; blank: none
      character(:), allocatable :: line

      line = ' *** '//program//', VERSION '//version//' ***'
      if (len_trim(mark) > 0) line = line//' RUN '//mark
   end function header_of

   !> Find every mistake of a case without running it.
   subroutine check_case(set, supplied, vertices, findings, demand)
      type(data_set_t), intent(in) :: set
      type(line_t), intent(in) :: supplied(:)            !! device 4, empty if none
      real(wp), allocatable, intent(out) :: vertices(:, :) !! shape (marble, nguess)
      type(diagnostics_t), intent(inout) :: findings
      type(demand_t), intent(in), optional :: demand     !! for memory; that of psalm if absent
      type(topology_t) :: topology
      type(dimensions_t) :: dimensions
      type(demand_t) :: each
      integer(int64) :: bytes

      call set_up(set, topology, dimensions, findings)
      if (findings%failed()) return
      if (present(demand)) each = demand
      bytes = each%position
      if (set%ktheta /= 0 .or. .not. each%ktheta_only) bytes = bytes + int(each%arc, int64)*sum(topology%loopl)
      bytes = bytes*set%ndes
      if (.not. memory_to_be_had(bytes)) then
         call findings%trouble('the memory for NDES='//to_text(set%ndes)//' positions, about '// &
                               to_text(int(bytes/megabyte) + 1)//' MB, is not to be had')
         return
      end if
      call check_regions(set%constr, topology, findings)
      if (topology%has_search() .and. set%nguess > 0) then
         call read_vertices(supplied, size(topology%variables), set%nguess, vertices, findings)
      else
         allocate (vertices(size(topology%variables), 0))
      end if
   end subroutine check_case

   !> Run a case that `check_case` found no fault with.
   subroutine run_case(set, vertices, asked, stop, devices, monitor)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: vertices(:, :)   !! shape (marble, nguess)
      integer, intent(in) :: asked             !! threads that share the work; 0: as THREADS says
      type(stop_t), intent(in) :: stop         !! asked now and then by searches and samples
      type(devices_t), intent(inout) :: devices
      class(search_monitor_t), intent(inout), optional :: monitor
      type(diagnostics_t) :: repeated
      type(topology_t) :: topology
      type(dimensions_t) :: dimensions
      type(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(motion_t) :: motion
      type(result_t) :: others
      type(data_set_t), allocatable :: final
      type(stop_t) :: interrupt
      integer :: i, threads

      i = merge(asked, max(1, set%search%threads), asked > 0)
      threads = threads_to_be_had(i)
      if (threads < i) call devices%notes%add(set%file//': '//trim(set%title)//': '//to_text(i)// &
         ' threads are not to be had; '//to_text(threads)//' do the work (the results are the same)')
      allocate (others%best(0))
      call set_up(set, topology, dimensions, repeated)
      allocate (problem)
      call make_problem(set, topology, dimensions, problem)
      call problem%set_threads(threads)
      call list_input(header_of('PSALM', devices%mark), set, topology, dimensions, devices%eight)
      interrupt = stop
      if (topology%has_search()) then
         if (set%search%solver == 'SIMPLEX') then
            call synthesize(set, vertices, problem, interrupt, dimensions, devices, monitor)
         else
            call synthesize_from_starts(set, vertices, problem, threads, interrupt, dimensions, others, devices, monitor)
         end if
      end if
      call problem%analyse(dimensions, motion)
      call list_results(set, problem, dimensions, motion, devices%six)
      call list_setup(set, problem, devices%eight)
      if (len(set%skipped) > 0) call devices%eight%add(' GROUPS THAT PSALM DOES NOT READ: '//set%skipped)
      call list_reference_joints(set, problem, dimensions, devices%eight)
      do i = 1, repeated%count
         call devices%eight%add(' '//repeated%list(i)%render())
      end do
      if (set%ktheta /= 0) call list_arcs(problem, motion, conditions(problem), devices%eight)
      if (set%search%given .or. set%constr%given) call judge(set, problem, dimensions, devices)
      if (size(others%best) > 1) call list_found(set, problem, others, devices%six)
      call write_found(set, topology, dimensions, others, devices%seven)
      call write_plot_data(set, problem, dimensions, motion, devices%nine)
      if (set%tolerances) then
         allocate (final, source=set)
         if (set%ifree /= 0 .and. size(others%best) > 0) final%delt = others%best(1)%delt
         call interrupt%limit_time(set%search%maxtime)
         call tolerances(final, dimensions, threads, interrupt, devices)
      end if
      call note_violations(set, problem, motion, devices)
      call find_doubts(set%file//': '//trim(set%title)//': ', topology, problem, dimensions, motion, devices%notes)
      if (devices%wants_summary) call sum_up(set, problem, dimensions, motion, devices)
   end subroutine run_case

   !> What the linkage does over the range of its input, in words.
   subroutine sum_up(set, problem, dimensions, motion, devices)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(in) :: motion
      type(devices_t), intent(inout) :: devices
      type(summary_t) :: summary

      devices%summarised = devices%summarised + 1
      if (devices%summarised > most_summarised) return
      call summarise(problem, dimensions, motion, summary)
      call write_summary(set%title, summary, devices%summary)
      if (devices%summarised == most_summarised .and. set%last == 0) &
         call devices%summary%add('Further cases of the file are not summarised')
   end subroutine sum_up

   !> Margins of every constraint; a linkage that violates one is no success.
   subroutine judge(set, problem, dimensions, devices)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(devices_t), intent(inout) :: devices
      type(inspector_t), allocatable :: inspector
      type(margin_t), allocatable :: margins(:)
      integer :: i

      allocate (inspector)
      call prepare_inspector(set, problem, set%search%solver /= 'SIMPLEX', inspector)
      call inspect(inspector, dimensions, problem%delt, margins)
      call list_margins(set, problem%topology, dimensions, margins, devices%six)
      do i = 1, size(margins)
         if (.not. is_violated(margins(i))) cycle
         devices%code = max(devices%code, exit_violation)
         call devices%notes%add(set%file//': '//trim(set%title)//': violated: '// &
                                describe_margin(set, problem%topology, dimensions, margins(i)))
      end do
   end subroutine judge

   !> Search from many starts; `dimensions` becomes the best linkage found.
   subroutine synthesize_from_starts(set, vertices, problem, threads, interrupt, dimensions, found, devices, monitor)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: vertices(:, :)
      type(problem_t), intent(inout) :: problem
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: interrupt
      type(dimensions_t), intent(inout) :: dimensions
      type(result_t), intent(out) :: found
      type(devices_t), intent(inout) :: devices
      class(search_monitor_t), intent(inout), optional :: monitor
      character(:), allocatable :: line, resume
      real(wp), allocatable :: vertices_found(:, :)
      integer :: i

      call devices%one%add(' '//set%title)
      call search_many(set, problem, problem%topology%first_values(dimensions), vertices, threads, interrupt, found, devices%one, &
                       monitor)
      line = to_text(found%starts)//' starts, '//to_text(found%feasible)//' led to a linkage, '//to_text(found%evaluations)// &
             ' evaluations, '//to_text(found%jacobians)//' Jacobians'
      if (size(found%best) == 0) then
         devices%code = max(devices%code, exit_violation)
         line = 'no linkage that obeys the constraints was found: '//line
      else
         call problem%topology%apply(found%best(1)%values, dimensions)
         if (set%ifree /= 0) call problem%move_inputs(found%best(1)%delt)
         line = line//'; best objective '//trim(adjustl(general(found%best(1)%objective)))
      end if
      if (found%out_of_time) line = 'MAXTIME passed before the search was done: '//line
      if (found%out_of_time .or. found%interrupted) devices%code = max(devices%code, exit_violation)
      if (found%refused) then
         devices%code = max(devices%code, exit_violation)
         line = 'NLopt refuses '//set%search%solver//' for this problem: '//line
      end if
      if (found%interrupted) line = 'interrupted: '//line
      if (found%next > 0) then
         devices%code = max(devices%code, exit_violation)
         resume = 'to go on, give this device 7 as device 4 with NGUESS='//to_text(size(found%best))//', FIRST='// &
                    to_text(found%next)//', NSTART='//to_text(max(1, set%search%first + set%search%nstart - found%next))
         call devices%notes%add(set%file//': '//trim(set%title)//': '//resume)
         call devices%seven%add('! '//resume)
      end if
      allocate (vertices_found(size(problem%topology%variables), size(found%best)))
      do i = 1, size(found%best)
         vertices_found(:, i) = found%best(i)%values
      end do
      call write_vertices('F', vertices_found, found%best%objective, devices%seven)
      call devices%one%add(' '//line)
      call devices%notes%add(set%file//': '//trim(set%title)//': '//line)
   end subroutine synthesize_from_starts

   !> The linkages found, ranked.
   subroutine list_found(set, problem, found, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      type(result_t), intent(in) :: found
      type(text_t), intent(inout) :: text
      type(dimensions_t) :: dimensions
      type(inspector_t), allocatable :: inspector
      type(margin_t), allocatable :: margins(:)
      character(:), allocatable :: rank, start
      real(wp) :: angle, length
      integer :: i

      call text%add()
      call text%add(' LINKAGES FOUND (DEVICE 7 HAS THEM ALL)')
      call text%add('  RANK      OBJECTIVE  ANGLE MARGIN LENGTH MARGIN    LONGEST ARC LARGEST CHANGE   START')
      dimensions = problem%given
      allocate (inspector)
      call prepare_inspector(set, problem, .true., inspector)
      do i = 1, size(found%best)
         call problem%topology%apply(found%best(i)%values, dimensions)
         call inspect(inspector, dimensions, found%best(i)%delt, margins)
         angle = right_angle
         length = maxval(dimensions%arcl)
         if (any(margins%kind <= margin_slides)) angle = minval(margins%margin, mask=margins%kind <= margin_slides)
         if (any(margins%kind >= margin_guide .and. margins%kind < margin_bound)) length = &
            minval(margins%margin, mask=margins%kind >= margin_guide .and. margins%kind < margin_bound)
         rank = to_text(i)
         start = to_text(found%best(i)%start)
         if (found%best(i)%start < 0) start = 'SUPPLIED '//to_text(-found%best(i)%start)
         call text%add(repeat(' ', 6 - min(5, len(rank)))//rank//general(found%best(i)%objective)//general(angle)// &
                       general(length)//general(maxval(dimensions%arcl))//general(found%best(i)%distance)//'   '//start)
      end do
      call problem%topology%apply(found%best(1)%values, dimensions)
      call problem%bind(dimensions)
   end subroutine list_found

   !> Data sets of all linkages found, one case after another; without a search from many starts that of the linkage.
   subroutine write_found(set, topology, dimensions, found, text)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(in) :: topology
      type(dimensions_t), intent(in) :: dimensions
      type(result_t), intent(in) :: found
      type(text_t), intent(inout) :: text
      type(data_set_t) :: one
      type(dimensions_t) :: each
      character(:), allocatable :: rank
      integer :: i

      one = set
      if (size(found%best) <= 1) then
         if (size(found%best) == 1) one%delt = found%best(1)%delt
         call write_data_set(one, topology, dimensions, text)
         return
      end if
      each = dimensions
      do i = 1, size(found%best)
         call topology%apply(found%best(i)%values, each)
         one%delt = found%best(i)%delt
         one%last = merge(set%last, 0, i == size(found%best))
         rank = ', RANK '//to_text(i)
         one%title = trim(set%title(:min(len(set%title), title_columns - len(rank))))//rank
         call text%add('! rank '//to_text(i)//', objective '//trim(adjustl(general(found%best(i)%objective, 'E'))))
         call write_data_set(one, topology, each, text)
      end do
   end subroutine write_found

   !> Bands of the output within the tolerances of the dimensions.
   subroutine tolerances(set, dimensions, threads, interrupt, devices)
      type(data_set_t), intent(in) :: set
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: interrupt !! asked now and then by the sample
      type(devices_t), intent(inout) :: devices
      type(tolerance_t), allocatable :: linear
      type(sample_t) :: sample
      logical :: closes

      allocate (linear)
      call find_tolerances(set, dimensions, linear, closes)
      if (.not. closes) then
         call devices%notes%add(set%file//': '//trim(set%title)//': no tolerances, because the linkage does not close everywhere')
         return
      end if
      if (set%ntrial > 0) call draw_sample(linear, set%ntrial, set%istart, threads, sample, interrupt)
      call list_tolerances(linear, sample, devices%six)
      call plot_tolerances(set%title, linear, sample, devices%nine)
      if (any(linear%dead)) then
         devices%code = max(devices%code, exit_violation)
         call devices%notes%add(set%file//': '//trim(set%title)//': dead point at position '// &
                                to_text(findloc(linear%dead, .true., dim=1))//': effects of tolerances are infinite there')
      end if
      if (sample%trials < set%ntrial) then
         devices%code = max(devices%code, exit_violation)
         call devices%notes%add(set%file//': '//trim(set%title)//': '// &
                                trim(merge('MAXTIME passed', 'interrupted   ', interrupt%late()))//': the sample has '// &
                                to_text(sample%trials)//' of '//to_text(set%ntrial)//' linkages')
      end if
      if (sample%open == 0) return
      devices%code = max(devices%code, exit_violation)
      call devices%notes%add(set%file//': '//trim(set%title)//': '//to_text(sample%open)//' of '//to_text(sample%trials)// &
                             ' linkages within the tolerances do not close')
   end subroutine tolerances

   !> Search from the given linkage; `dimensions` becomes the best one found.
   subroutine synthesize(set, vertices, problem, interrupt, dimensions, devices, monitor)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: vertices(:, :)
      type(problem_t), intent(inout) :: problem
      type(stop_t), intent(in) :: interrupt
      type(dimensions_t), intent(inout) :: dimensions
      type(devices_t), intent(inout) :: devices
      class(search_monitor_t), intent(inout), optional :: monitor
      type(constraints_t) :: constraints
      type(simplex_t) :: simplex
      type(search_state_t) :: state
      type(stop_t) :: ending
      logical :: feasible

      call make_constraints(set, problem, constraints)
      call devices%one%add(' '//set%title)
      call devices%two%add(' '//set%title)
      call start_simplex(set, problem, constraints, vertices, simplex, feasible, devices%one, devices%two)
      if (.not. feasible) then
         call devices%notes%add(set%file//': '//trim(set%title)//': the given linkage violates closure or transmission limits '// &
                                'and cannot be repaired; no search was made')
         devices%code = max(devices%code, exit_violation)
         return
      end if
      call write_vertices('I', simplex%v, simplex%f, devices%seven)
      ending = interrupt
      call ending%limit_time(set%search%maxtime)
      call search_simplex(set, problem, constraints, simplex, ending, state, devices%one, monitor)
      call write_vertices('F', simplex%v, simplex%f, devices%seven)
      call problem%topology%apply(simplex%v(:, simplex%best), dimensions)
      call tell_search(set, simplex, state, ending, devices)
   end subroutine synthesize

   subroutine tell_search(set, simplex, state, ending, devices)
      type(data_set_t), intent(in) :: set
      type(simplex_t), intent(in) :: simplex
      type(search_state_t), intent(in) :: state
      type(stop_t), intent(in) :: ending
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: line, reason

      select case (state%reason)
      case (stop_iterations)
         reason = 'stopped at NITER before converging'
         devices%code = max(devices%code, exit_violation)
      case (stop_interrupted)
         reason = trim(merge('MAXTIME passed', 'interrupted   ', ending%late()))// &
                  ' (to go on, give this device 7 as device 4 with NGUESS='//to_text(size(simplex%f))//')'
         devices%code = max(devices%code, exit_violation)
      case (stop_converged)
         reason = 'the simplex has converged'
      case default
         reason = 'the objective is below FMIN'
      end select
      line = to_text(state%iteration)//' iterations, '//to_text(state%evaluations)//' evaluations, '// &
             to_text(simplex%repairs%calls)//' violations met, '//to_text(simplex%repairs%repairs)//' repairs, '// &
             to_text(simplex%repairs%moves)//' moves; best objective '//trim(adjustl(general(state%best)))
      call devices%one%add(' '//line//'; '//reason)
      call devices%notes%add(set%file//': '//trim(set%title)//': '//reason//' after '//line)
      if (state%reason == stop_iterations .and. set%niter == default_niter) then
         call devices%notes%add(set%file//': '//trim(set%title)//': NITER='//to_text(set%niter)// &
                                ' is for looking at the start; set NITER in &METHOD to some thousands')
      end if
   end subroutine tell_search

   !> Device 9: the prescribed positions, and with IPLOT every degree in the direction of the first two.
   subroutine write_plot_data(set, problem, dimensions, motion, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(in) :: motion
      type(text_t), intent(inout) :: text
      type(problem_t), allocatable :: fine
      type(motion_t) :: every_degree

      call add_block('prescribed positions', problem, motion)
      if (set%iplot == 0) return
      allocate (fine, source=problem)
      call fine%set_inputs(sweep_inputs(problem))
      call fine%analyse(dimensions, every_degree)
      call add_block(trim(merge('every degree ', 'evenly spaced', .not. problem%topology%sliding_input)), fine, every_degree)

   contains

      subroutine add_block(name, which, its_motion)
         character(*), intent(in) :: name
         type(problem_t), intent(inout) :: which
         type(motion_t), intent(in) :: its_motion

         if (set%icond == 0) then
            call write_block(set%title, name, problem%desired, which, its_motion, text)
         else
            call write_block(set%title, name, problem%desired, which, its_motion, text, conditions(which))
         end if
      end subroutine add_block
   end subroutine write_plot_data

   !> Condition numbers of all positions. `problem` is bound to the linkage.
   function conditions(problem) result(numbers)
      type(problem_t), intent(inout) :: problem
      real(wp), allocatable :: numbers(:)      !! shape (positions)
      type(condition_t) :: condition
      integer :: block, offset, n, i

      allocate (numbers(problem%positions))
      call prepare_condition(problem%linkage, condition)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call problem%output_of(n)
         do i = 1, n
            call condition_at(problem, i, offset + i, condition, numbers(offset + i))
         end do
      end do
   end function conditions

   !> Exit status 1 and a remark where limits are violated.
   subroutine note_violations(set, problem, motion, devices)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(motion_t), intent(in) :: motion
      type(devices_t), intent(inout) :: devices
      integer :: i

      do i = 1, min(size(motion%crossings), most_told)
         call devices%notes%add(set%file//': '//trim(set%title)//': warning: '//describe_crossing(motion, motion%crossings(i)))
      end do
      if (size(motion%violations) == 0) return
      devices%code = max(devices%code, exit_violation)
      if (.not. all(motion%closed)) then
         call devices%notes%add(set%file//': '//trim(set%title)//': the linkage does not close at '// &
                                to_text(count(.not. motion%closed))//' of '//to_text(size(motion%closed))//' positions')
      end if
      do i = 1, min(size(motion%violations), most_told)
         call devices%notes%add(set%file//':   '//describe_violation(problem, motion, motion%violations(i)))
      end do
      if (size(motion%violations) > most_told) call devices%notes%add(set%file//':   and '// &
         to_text(size(motion%violations) - most_told)//' more in the listing')
   end subroutine note_violations
end module psalm_run
