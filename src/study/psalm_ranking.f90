!> What the linkages found by a search are like, in the numbers by which a designer chooses between them; and those that are not
!> beaten in two of them at once.
!>
!> Errors, transmission angle and turning are those of `psalm_summary`. The box is sampled every degree (a sliding input: in 360
!> steps), over the full turn if the linkage closes there, else over the prescribed inputs.
module psalm_ranking
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp, full_turn, right_angle
   use psalm_margins, only: margin_t, inspector_t, inspect, margin_slides, margin_guide, margin_bound
   use psalm_mechanism, only: arc_crank, arc_determined, arc_link
   use psalm_output_kind, only: motion_point, motion_pose
   use psalm_search, only: found_t, place_desired
   use psalm_search_group, only: pareto_largest, pareto_angle, pareto_ratio, pareto_room, pareto_band
   use psalm_sketch, only: columns_of
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples
   use psalm_sort, only: ascending
   use psalm_stop, only: stop_t
   use psalm_summary, only: summary_t, summarise, unit_width
   implicit none (type, external)
   private
   public :: ranked_t, rate_linkage, figure_of, unbeaten, least_sensitive_first

   integer, parameter :: box_steps = 360          !! of the sweep by which the box is found

   !> What a linkage found is like.
   type :: ranked_t
      real(wp) :: angle_margin = right_angle       !! least margin of an angle, degrees
      real(wp) :: length_margin = 0.0_wp           !! least margin of a length; the longest arc if there is none
      real(wp) :: longest_arc = 0.0_wp
      logical :: compared = .false.                !! there are desired values, the linkage closes there
      real(wp) :: rms = 0.0_wp, largest = 0.0_wp   !! errors
      character(unit_width) :: error_unit = ''      !! of these
      logical :: has_angle = .false.
      real(wp) :: angle = right_angle              !! least transmission angle, degrees
      real(wp) :: ratio = 1.0_wp                   !! longest to shortest link
      real(wp) :: width = 0.0_wp, height = 0.0_wp  !! of the box of all joints and the output point
      logical :: sliding_input = .false.
      logical :: turns = .false.                   !! the input crank turns fully
      logical :: has_band = .false.                !! the data set has tolerances
      real(wp) :: band = 0.0_wp                    !! largest root-sum-square deviation at a position, unit of the output;
                                                   !! huge: the linkage is at a dead point
      logical :: has_cost = .false.                !! tolerances are to be allotted
      real(wp) :: cost = 0.0_wp                    !! of the cheapest; huge: there are none, or there is a dead point
   end type ranked_t

contains

   !> Numbers of one linkage. `problem` has the desired values; its inputs are moved.
   subroutine rate_linkage(set, problem, inspector, found, ranked)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      type(inspector_t), intent(inout) :: inspector
      type(found_t), intent(in) :: found
      type(ranked_t), intent(out) :: ranked
      type(dimensions_t) :: dimensions
      type(margin_t), allocatable :: margins(:)
      type(motion_t) :: motion
      type(summary_t) :: summary

      dimensions = problem%given
      call problem%parameters%apply(found%values, dimensions)
      call problem%move_inputs(found%delt)
      call place_desired(found, problem)
      call inspect(inspector, dimensions, found%delt, margins)
      ranked%longest_arc = maxval(dimensions%arcl)
      ranked%length_margin = ranked%longest_arc
      if (any(margins%kind <= margin_slides)) ranked%angle_margin = minval(margins%margin, mask=margins%kind <= margin_slides)
      if (any(margins%kind >= margin_guide .and. margins%kind < margin_bound)) ranked%length_margin = &
         minval(margins%margin, mask=margins%kind >= margin_guide .and. margins%kind < margin_bound)
      call problem%analyse(dimensions, motion)
      call summarise(set, problem, dimensions, motion, summary)
      ranked%compared = summary%compared > 0
      ranked%rms = summary%rms
      ranked%largest = summary%largest
      ranked%error_unit = summary%error_unit
      ranked%has_angle = summary%angle_loop > 0
      ranked%angle = summary%angle
      ranked%turns = summary%everywhere .and. .not. summary%sliding_input
      ranked%sliding_input = summary%sliding_input
      ranked%ratio = ratio_of_links(problem, dimensions)
      call find_box(problem, dimensions, summary%everywhere, ranked%width, ranked%height)
      if (set%toler%given) call find_band(set, problem, dimensions, found%delt, ranked)
      if (set%gives('ALLOC')) call find_cost(set, problem, dimensions, found%delt, ranked)
   end subroutine rate_linkage

   !> Longest to shortest arc of a fixed length, the frame's included; those of no length do not count.
   pure real(wp) function ratio_of_links(problem, dimensions) result(ratio)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      logical :: counts(size(dimensions%arcl))
      integer :: n

      ratio = 1.0_wp
      do n = 1, size(counts)
         counts(n) = any(problem%mechanism%arcs(n)%kind == [arc_crank, arc_determined, arc_link]) .and. dimensions%arcl(n) > 0.0_wp
      end do
      if (any(counts)) ratio = maxval(dimensions%arcl, mask=counts)/minval(dimensions%arcl, mask=counts)
   end function ratio_of_links

   !> Width and height of the box, in machine axes, of every joint and, where it is a point, the output.
   subroutine find_box(problem, dimensions, turn, width, height)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in) :: turn                  !! over the full turn of a crank
      real(wp), intent(out) :: width, height
      class(sample_set_t), allocatable :: samples
      integer, allocatable :: joints(:, :)
      real(wp) :: from, to, low(2), high(2)
      integer :: i, c, loop, a

      from = minval(problem%delt)
      to = maxval(problem%delt)
      if (turn .and. .not. problem%mechanism%sliding_input) to = from + full_turn
      associate (loops => problem%mechanism%loops)
         joints = reshape([((loop, a, a=1, loops(loop)%arcs), loop=1, size(loops))], [2, sum(loops%arcs)])
      end associate
      allocate (samples)
      call prepare_samples(problem, [(from + (to - from)*(real(i, wp)/real(box_steps, wp)), i=0, box_steps)], .false., &
                              joints, &
                           .false., samples)
      call evaluate_samples(samples, dimensions)
      width = 0.0_wp
      height = 0.0_wp
      if (.not. any(samples%closed)) return
      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      do c = 1, 2
         do i = 1, size(samples%closed)
            if (.not. samples%closed(i)) cycle
            low(c) = min(low(c), minval(samples%joints(i, c, :)))
            high(c) = max(high(c), maxval(samples%joints(i, c, :)))
            if (.not. any(problem%motion == [motion_point, motion_pose])) cycle
            low(c) = min(low(c), samples%out(i, c))
            high(c) = max(high(c), samples%out(i, c))
         end do
      end do
      width = high(1) - low(1)
      height = high(2) - low(2)
   end subroutine find_box

   !> Root-sum-square band of the tolerances at the position where it is widest.
   subroutine find_band(set, problem, dimensions, delt, ranked)
      use psalm_tolerance, only: deviating_t, tolerance_t, find_tolerances
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: delt(:)              !! shape (positions)
      type(ranked_t), intent(inout) :: ranked
      type(deviating_t), allocatable :: deviating
      type(tolerance_t) :: linear

      allocate (deviating)
      call find_tolerances(set, problem%mechanism, dimensions, deviating, linear, ranked%has_band, delt)
      if (.not. ranked%has_band) return
      ranked%band = huge(1.0_wp)
      if (any(linear%dead)) return
      if (problem%mechanism%outputs(1)%stands_in) then
         associate (bands => linear%bands, components => columns_of(set%sketch%outputs(1)))
            ranked%has_band = bands%known(1)
            ranked%band = maxval(bands%square(:, 1))
            if (components > 1) ranked%band = maxval(hypotenuse(bands%square(:, 1), bands%square(:, 2)))
         end associate
      else if (size(linear%square, 2) == 1) then
         ranked%band = maxval(linear%square)
      else
         ranked%band = maxval(hypotenuse(linear%square(:, 1), linear%square(:, 2)))
      end if
   end subroutine find_band

   !> What the cheapest tolerances within the bands cost.
   subroutine find_cost(set, problem, dimensions, delt, ranked)
      use psalm_allocation, only: allocation_t, study_allocation
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: delt(:)              !! shape (positions)
      type(ranked_t), intent(inout) :: ranked
      type(allocation_t), allocatable :: allocation

      allocate (allocation)
      call study_allocation(set, problem%mechanism, dimensions, 1, stop_t(), allocation, delt, unchecked=.true.)
      ranked%has_cost = .true.
      ranked%cost = huge(1.0_wp)
      if (allocation%solved .and. .not. any(allocation%dead)) ranked%cost = allocation%value
   end subroutine find_cost

   !> The order in which linkages whose objective is at most `nearly` times the best come first, the least sensitive before the
   !> others; the rest stays as it is.
   pure function least_sensitive_first(objective, ranked, nearly) result(order)
      real(wp), intent(in) :: objective(:)         !! shape (linkages), rising
      type(ranked_t), intent(in) :: ranked(:)
      real(wp), intent(in) :: nearly
      integer, allocatable :: order(:)
      real(wp) :: figure(size(ranked))
      integer :: i, n

      order = [(i, i=1, size(ranked))]
      n = count(objective <= nearly*objective(1))
      figure = ranked%band
      if (all(ranked%has_cost)) figure = ranked%cost
      order(:n) = order(ascending(figure(:n)))
   end function least_sensitive_first

   !> What a list of PARETO compares beside the objective, so that less is better.
   pure real(wp) function figure_of(ranked, pareto) result(figure)
      type(ranked_t), intent(in) :: ranked
      integer, intent(in) :: pareto                !! one of `pareto_...`

      select case (pareto)
      case (pareto_largest)
         figure = ranked%largest
      case (pareto_angle)
         figure = -ranked%angle
      case (pareto_ratio)
         figure = ranked%ratio
      case (pareto_room)
         figure = max(ranked%width, ranked%height)
      case (pareto_band)
         figure = ranked%band
      case default
         figure = 0.0_wp
      end select
   end function figure_of

   !> Linkages, given with the best objective first, of which none with a lower objective has as low a figure; at most so many,
   !> spread evenly between both ends.
   pure function unbeaten(figure, most) result(chosen)
      real(wp), intent(in) :: figure(:)            !! shape (linkages)
      integer, intent(in) :: most
      integer, allocatable :: chosen(:)
      integer, allocatable :: front(:)
      real(wp) :: least
      integer :: i

      allocate (front(0))
      least = huge(1.0_wp)
      do i = 1, size(figure)
         if (figure(i) >= least) cycle
         least = figure(i)
         front = [front, i]
      end do
      if (size(front) == 0 .and. size(figure) > 0) front = [1]
      if (size(front) <= most) then
         chosen = front
      else if (most == 1) then
         chosen = front(:1)
      else
         chosen = front([(1 + nint(real(size(front) - 1, wp)*real(i - 1, wp)/real(most - 1, wp)), i=1, most)])
      end if
   end function unbeaten
end module psalm_ranking
