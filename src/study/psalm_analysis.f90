!> What a linkage does at the prescribed positions, between them, and how far it is inside its constraints.
!>
!> Data in, results out: nothing is printed or worded here, no file is touched.
module psalm_analysis
   use psalm_angles, only: degrees_of, nearest_difference, within_turn
   use psalm_condition, only: condition_t, prepare_condition, condition_at
   use psalm_data_set, only: data_set_t
   use psalm_dyad_kind, only: assur_rpr, assur_rpr_guide_first
   use psalm_error, only: problem_t, motion_t, reach_t
   use psalm_kinds, only: wp, full_turn
   use psalm_margins, only: margin_t, inspector_t, prepare_inspector, inspect, is_violated
   use psalm_stop, only: stop_t, is_to_end
   use psalm_summary, only: summary_t, summarise
   use psalm_sweep, only: sweep_inputs
   use psalm_output_targets, only: output_targets_t, compare_with_targets, sum_of_desired_errors
   use psalm_desired_rates, only: add_rates_to_motion
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t, arc_crank, arc_link
   implicit none (type, external)
   private
   public :: analysis_t, wanted_t, arc_table_t, warnings_t, analyse, wanted_by

   real(wp), parameter :: least_ratio = 1.0e-3_wp  !! of a link to the longest arc, below which it is practically none
   real(wp), parameter :: at_rest = 1.0e-9_wp      !! of the size: an output that moves less does not move

   !> What is wanted besides the motion at the prescribed positions.
   type :: wanted_t
      logical :: conditions = .false.  !! condition number of every position
      logical :: sweep = .false.       !! the motion at every degree of a turn, or evenly over the range of a sliding input
      logical :: arcs = .false.        !! length and angle of every arc at every position (needs KTHETA=1)
      logical :: margins = .false.     !! margins of every constraint
      logical :: warnings = .false.      !! what makes the result doubtful, and joints at the reference input
      logical :: summary = .false.     !! what the linkage does over the whole range of its input
   end type wanted_t

   !> Every arc at every position.
   type :: arc_table_t
      real(wp), allocatable :: length(:, :)  !! shape (arcs by sequential number, positions)
      real(wp), allocatable :: angle(:, :)   !! the same shape: degrees, 0 to 360
      integer, allocatable :: open(:)        !! shape (positions): first loop that does not close; the arcs of it and of
                                             !! later ones are not determined; 0: none
   end type arc_table_t

   !> What is no violation and yet makes a result doubtful.
   type :: warnings_t
      integer, allocatable :: short(:)       !! sequential numbers of moving links of practically no length
      logical :: at_rest = .false.           !! the output stays where it is while the input moves
      real(wp), allocatable :: joint(:, :)   !! shape (2, loops): joint of the undetermined arcs at the reference input
      logical, allocatable :: closes(:)      !! by loop: closes there; `joint` is determined up to the first that does not
   end type warnings_t

   !> Results. What was not wanted is not allocated.
   type :: analysis_t
      type(dimensions_t) :: dimensions               !! the linkage
      type(motion_t) :: motion                       !! at the prescribed positions
      real(wp), allocatable :: condition(:)          !! shape (positions)
      type(arc_table_t), allocatable :: arcs
      type(margin_t), allocatable :: margins(:)
      type(motion_t), allocatable :: sweep           !! between and beyond the prescribed positions
      real(wp), allocatable :: sweep_condition(:)
      type(warnings_t), allocatable :: warnings
      type(summary_t), allocatable :: summary
      class(output_targets_t), allocatable :: targets !! desired values of further outputs, where there are any
   contains
      procedure :: is_violating
   end type analysis_t

contains

   !> What the items of a data set ask for.
   pure type(wanted_t) function wanted_by(set) result(wanted)
      type(data_set_t), intent(in) :: set

      wanted%arcs = set%limits%ktheta /= 0
      wanted%conditions = set%limits%ktheta /= 0 .or. set%limits%icond /= 0
      wanted%sweep = set%limits%iplot /= 0
      wanted%margins = set%search%given .or. set%constr%given .or. set%limits%trmin_given
      wanted%warnings = .true.
   end function wanted_by

   !> Analyse a linkage. `problem` is bound to it afterwards. What the host ends is of no use.
   subroutine analyse(set, problem, dimensions, wanted, analysis, stop)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem        !! made from `set`; its inputs may have been moved
      type(dimensions_t), intent(in) :: dimensions
      type(wanted_t), intent(in) :: wanted
      type(analysis_t), intent(out) :: analysis
      type(stop_t), intent(in), optional :: stop       !! asked before each block of positions
      class(inspector_t), allocatable :: inspector
      class(problem_t), allocatable :: fine    ! large: it would fill a small stack
      type(reach_t) :: reach

      analysis%dimensions = dimensions
      call problem%analyse(dimensions, analysis%motion, reach, stop)
      if (is_to_end(stop)) return
      if (allocated(problem%rate_desired)) call add_rates_to_motion(problem, dimensions, analysis%motion)
      if (allocated(problem%target_values)) then
         allocate (analysis%targets)
         call compare_with_targets(set, problem, dimensions, analysis%motion%closed, analysis%targets)
         analysis%motion%total = analysis%motion%total + sum_of_desired_errors(analysis%targets)
      end if
      if (wanted%conditions) analysis%condition = conditions(problem)
      if (wanted%arcs) then
         allocate (analysis%arcs)
         call follow_arcs(problem, analysis%arcs)
      end if
      if (wanted%margins) then
         allocate (inspector)
         call prepare_inspector(set, problem, set%search%solver%many_starts, inspector)
         call inspect(inspector, dimensions, problem%delt, analysis%margins)
      end if
      if (wanted%sweep) then
         allocate (analysis%sweep)
         allocate (fine, source=problem)
         call fine%set_inputs(sweep_inputs(problem))
         call fine%analyse(dimensions, analysis%sweep, reach)
         if (wanted%conditions) analysis%sweep_condition = conditions(fine)
      end if
      if (wanted%warnings) then
         allocate (analysis%warnings)
         analysis%warnings%short = short_links(problem%mechanism, dimensions)
         analysis%warnings%at_rest = stays_at_rest(problem, dimensions, analysis%motion)
         call find_reference_joints(problem, dimensions, analysis%warnings)
      end if
      if (wanted%summary) then
         allocate (analysis%summary)
         ! `desired_values` are absent where they are not allocated
         call summarise(set, problem, dimensions, analysis%motion, analysis%summary, analysis%targets)
      end if
   end subroutine analyse

   !> True if the linkage violates closure, transmission limits or any other constraint that was looked at.
   pure logical function is_violating(self)
      class(analysis_t), intent(in) :: self

      is_violating = size(self%motion%violations) > 0
      if (allocated(self%motion%beyond)) is_violating = is_violating .or. any(self%motion%beyond)
      if (allocated(self%margins)) is_violating = is_violating .or. any(is_violated(self%margins))
   end function is_violating

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

   !> Every arc at every position. `problem` is bound to the linkage and solves every loop.
   subroutine follow_arcs(problem, table)
      type(problem_t), intent(inout) :: problem
      type(arc_table_t), intent(out) :: table
      real(wp) :: x, y
      integer :: block, offset, m, i, k, loop, a, n

      associate (arcs => size(problem%mechanism%arcs), positions => problem%positions)
         allocate (table%length(arcs, positions), table%angle(arcs, positions), source=0.0_wp)
         allocate (table%open(positions), source=0)
      end associate
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, m)
         do i = 1, m
            k = offset + i
            do loop = 1, problem%mechanism%nloop
               if (.not. problem%linkage%closes(i, loop)) then
                  table%open(k) = loop
                  exit
               end if
               do a = 1, problem%mechanism%loops(loop)%arcs
                  n = problem%mechanism%seq(loop, a)
                  call problem%linkage%arc_at(problem%plan, n, i, x, y, table%length(n, k))
                  table%angle(n, k) = within_turn(degrees_of(x, y))
               end do
            end do
         end do
      end do
   end subroutine follow_arcs

   !> Moving links of practically no length. A guide may have none.
   pure function short_links(mechanism, dimensions) result(short)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      integer, allocatable :: short(:)         !! sequential numbers
      real(wp) :: longest
      integer :: loop, a, n, guide

      longest = maxval(dimensions%arcl)
      allocate (short(0))
      do loop = 1, mechanism%nloop
         guide = 0
         if (mechanism%groups(loop)%kind == assur_rpr) guide = mechanism%place(2, loop)
         if (mechanism%groups(loop)%kind == assur_rpr_guide_first) guide = mechanism%place(1, loop)
         do a = 1, mechanism%loops(loop)%arcs
            n = mechanism%seq(loop, a)
            if (mechanism%arcs(n)%kind /= arc_link .and. mechanism%arcs(n)%kind /= arc_crank) cycle
            if (a == guide .or. dimensions%arcl(n) >= least_ratio*longest) cycle
            ! a crank without length may carry a guide
            if (dimensions%arcl(n) <= 0.0_wp .and. mechanism%arcs(n)%kind == arc_crank) cycle
            short = [short, n]
         end do
      end do
   end function short_links

   !> True for an output that stays where it is while the input moves.
   pure logical function stays_at_rest(problem, dimensions, motion)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(in) :: motion
      real(wp) :: away, extent
      integer :: i, c, first

      stays_at_rest = .false.
      if (problem%mechanism%outputs(1)%stands_in) return
      first = findloc(motion%closed, .true., dim=1)
      if (first == 0) return
      extent = maxval(dimensions%arcl)
      if (.not. extent > 0.0_wp) extent = 1.0_wp   ! all of its arcs slide
      do i = first + 1, size(motion%closed)
         if (.not. motion%closed(i)) cycle
         if (motion%input(i) /= motion%input(first)) stays_at_rest = .true.
         do c = 1, size(motion%actual, 2)
            away = abs(motion%actual(i, c) - motion%actual(first, c))/extent
            if (c == problem%output%kind%angle) &
               away = abs(nearest_difference(motion%actual(i, c), motion%actual(first, c)))/full_turn
            if (away > at_rest) then
               stays_at_rest = .false.
               return
            end if
         end do
      end do
   end function stays_at_rest

   !> Joint of the two undetermined arcs of every loop at the reference input, by which a wrong assembly is seen.
   subroutine find_reference_joints(problem, dimensions, warnings)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(warnings_t), intent(inout) :: warnings
      class(problem_t), allocatable :: at_reference
      integer, allocatable :: joints(:, :)
      integer :: loop, block, n

      allocate (at_reference)
      associate (mechanism => problem%mechanism)
         allocate (joints(2, mechanism%nloop))
         allocate (warnings%joint(2, mechanism%nloop), source=0.0_wp)
         allocate (warnings%closes(mechanism%nloop), source=.false.)
         do loop = 1, mechanism%nloop
            joints(:, loop) = [loop, mechanism%place(1, loop)]
         end do
         at_reference%mechanism = mechanism
         at_reference%given = dimensions
         at_reference%motion = problem%motion
         at_reference%tangle = problem%tangle
         at_reference%delt = [0.0_wp]
         call at_reference%want_derivatives(everything=.true., joints=joints)
         call at_reference%set_inputs([0.0_wp])
         call at_reference%bind(dimensions)
         call at_reference%solve_block(1, block, n)
         do loop = 1, mechanism%nloop
            warnings%closes(loop) = at_reference%linkage%closes(1, loop)
            if (.not. warnings%closes(loop)) return
            associate (link => at_reference%linkage, point => at_reference%plan%joint_points(loop))
               warnings%joint(1, loop) = link%store%v(1, link%point_x(point))/link%scale + at_reference%output%origin_x
               warnings%joint(2, loop) = link%store%v(1, link%point_y(point))/link%scale + at_reference%output%origin_y
            end associate
         end do
      end associate
   end subroutine find_reference_joints
end module psalm_analysis
