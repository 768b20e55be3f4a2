!> How far a linkage is inside each of its constraints, at the prescribed positions and over the range asked for.
!>
!> A range is looked at in steps of half a degree; in every valley that may be the deepest the look is sharpened until a
!> thousandth of that. Near a dead point all that hangs on the dyad may swing round within a small part of a step: there
!> everything is looked at again, in steps that shrink towards the dead point by the same ratio as far as numbers go.
module psalm_margins
   use psalm_angles, only: arc_sine
   use psalm_clearances, only: clearance_t, list_clearances, find_depth, points_of_clearance
   use psalm_constraint_group, only: range_positions, range_turn, region_box
   use psalm_data_set, only: data_set_t
   use psalm_dyad_kind, only: assur_higher, assur_prp, assur_prr, assur_rpr, assur_rpr_guide_first, assur_rrp, assur_rrr
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, degrees_per_radian, right_angle
   use psalm_output_kind, only: motion_point
   use psalm_place, only: beside_t
   use psalm_regions, only: edge_distance, box_edges
   use psalm_rpr, only: guide_of
   use psalm_rrp, only: link_of
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples
   use psalm_dimensions, only: dimensions_t
   use psalm_parameters, only: variable_aside, variable_length, variable_outlk
   implicit none (type, external)
   private
   public :: margin_t, inspector_t, prepare_inspector, inspect, is_violated
   public :: margin_angle, margin_slides, margin_guide, margin_offset, margin_clearance, margin_bound, margin_length, &
             margin_group
   public :: rounding, parallel

   integer, parameter :: margin_angle = 1    !! transmission angle of a link pair inside its limits, degrees
   integer, parameter :: margin_slides = 2   !! angle between two slides inside its limits, degrees
   integer, parameter :: margin_guide = 3    !! distance over guide and TOGGLE, length
   integer, parameter :: margin_offset = 4   !! link over offset and TOGGLE, length
   integer, parameter :: margin_clearance = 5 !! distance of joints and links, over what is asked, length
   integer, parameter :: margin_bound = 6    !! variable inside its bounds, its own unit
   integer, parameter :: margin_length = 7   !! a variable length, length
   integer, parameter :: margin_group = 8    !! measure of a larger group: 1 at best, 0 at a dead point
   integer, parameter :: steps_of_range = 720, steps_of_refinement = 16, refinements = 3
   real(wp), parameter :: rounding = 1.0e-9_wp !! a negative margin smaller than this, relative to the linkage, is rounding
   real(wp), parameter :: parallel = 1.0e-6_wp !! degrees between two slides that are parallel for every purpose
   ! narrow places
   real(wp), parameter :: narrow = 0.05_wp   !! `narrowness` below which a step of the range may hide something
   integer, parameter :: steps_of_zoom = 120 !! to each side
   integer, parameter :: steps_per_half = 3  !! so many halve the distance: 0.5/2**40 degrees in the end
   real(wp), parameter :: part_of_half(0:steps_per_half - 1) = [1.0_wp, 0.5_wp**(1.0_wp/3.0_wp), 0.5_wp**(2.0_wp/3.0_wp)]
   integer, parameter :: deepest_refinement = 13   !! refinements until the bottom of a narrow place is found: a step over 8**13
   integer, parameter :: most_places = 32    !! narrow places looked into
   integer, parameter :: most_levels = 3     !! a narrow place inside a narrow place inside a narrow place

   !> The least margin of one constraint.
   type :: margin_t
      integer :: kind = 0
      integer :: which = 0                   !! loop, clearance or variable
      real(wp) :: margin = huge(1.0_wp)      !! negative: violated
      real(wp) :: delt = 0.0_wp              !! input increment where it is least
      real(wp) :: unit = 1.0_wp              !! what counts as much, for rounding
      real(wp) :: least_allowed = 0.0_wp     !! violated below
      integer :: edge = 0                    !! of a box to stay inside of: each edge has its own valleys
   end type margin_t

   type :: inspector_t
      ! in memory of their own, for objects this large fill a small stack
      class(sample_set_t), allocatable :: fine   !! prescribed positions, then the range
      class(sample_set_t), allocatable :: refinement
      class(sample_set_t), allocatable :: zoom   !! round a narrow place
      integer :: places = 0                  !! narrow places looked into
      integer :: irange = range_positions
      integer :: prescribed = 0              !! positions
      logical :: turns = .false.             !! the input turns
      logical :: everywhere = .false.        !! the range is a full turn
      real(wp) :: tangle = right_angle, slide_angle = right_angle
      real(wp) :: size = 1.0_wp              !! longest given arc: what rounding is measured by
      type(clearance_t), allocatable :: clearances(:)
      logical :: bounded = .false.
      real(wp), allocatable :: low(:), high(:)
   end type inspector_t

contains

   !> Make ready for a problem with its inputs.
   subroutine prepare_inspector(set, problem, toggle, inspector)
      use psalm_merit, only: constraint_inputs
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      logical, intent(in) :: toggle                !! TOGGLE is a constraint, not only a distance of repair
      type(inspector_t), intent(out) :: inspector
      class(problem_t), allocatable :: plain
      integer, allocatable :: joints(:, :)
      type(beside_t), allocatable :: beside(:)
      real(wp), allocatable :: inputs(:)
      integer :: nvar

      nvar = size(problem%parameters%variables)
      inspector%irange = set%constr%irange
      inspector%prescribed = problem%positions
      inspector%turns = .not. problem%mechanism%sliding_input
      inspector%everywhere = inspector%turns .and. inspector%irange == range_turn
      inspector%tangle = set%limits%tangle
      inspector%slide_angle = problem%slide_angle
      inspector%size = maxval(problem%given%arcl)
      call list_clearances(set%constr, problem%mechanism, problem%given%outlk <= 0.0_wp, inspector%clearances, joints, &
                           beside)
      allocate (plain, source=problem)
      allocate (inspector%fine, inspector%refinement, inspector%zoom)
      plain%tangle = right_angle
      plain%spare = 0.0_wp
      plain%slide_angle = right_angle
      if (.not. toggle) plain%toggle = 0.0_wp
      if (size(inspector%clearances) > 0) plain%motion = motion_point
      inputs = problem%delt
      if (inspector%irange /= range_positions) then
         inputs = [inputs, constraint_inputs(inspector%irange, problem, problem%delt, steps_of_range, 0)]
         call prepare_samples(plain, inputs(:steps_of_refinement + 1), .false., joints, .false., inspector%refinement, beside)
         call prepare_samples(plain, inputs(:2*steps_of_zoom + 1), .false., joints, .false., inspector%zoom, beside)
         allocate (inspector%refinement%measure(steps_of_refinement + 1, plain%mechanism%nloop), source=0.0_wp)
         allocate (inspector%zoom%measure(2*steps_of_zoom + 1, plain%mechanism%nloop), source=0.0_wp)
      end if
      call prepare_samples(plain, inputs, .false., joints, .false., inspector%fine, beside)
      inspector%fine%leading = problem%positions
      allocate (inspector%fine%measure(size(inputs), plain%mechanism%nloop), source=0.0_wp)
      inspector%bounded = set%limits%limval == 1 .and. nvar > 0
      if (inspector%bounded) then
         inspector%low = set%limits%oplow(:nvar)
         inspector%high = set%limits%ophigh(:nvar)
      end if
   end subroutine prepare_inspector

   !> All margins of a linkage, with the input increments `delt`.
   !>
   !> With `hasty` narrow places are left out where something is violated anyway.
   subroutine inspect(inspector, dimensions, delt, margins, hasty)
      use psalm_merit, only: constraint_inputs
      type(inspector_t), intent(inout) :: inspector
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: delt(:)              !! shape (positions)
      type(margin_t), allocatable, intent(out) :: margins(:)
      logical, intent(in), optional :: hasty
      type(margin_t), allocatable :: all_edges(:)
      integer :: loop, r, edge, i
      logical :: thorough

      allocate (all_edges(0), margins(0))
      associate (fine => inspector%fine)
         if (inspector%irange == range_positions) then
            call fine%problem%move_inputs(delt)
         else
            call fine%problem%move_inputs([delt, constraint_inputs(inspector%irange, fine%problem, delt, steps_of_range, 0)])
         end if
         fine%problem%side = 1.0_wp ! not what the linkage before had
         call evaluate_samples(fine, dimensions)
         do loop = 1, fine%problem%mechanism%nloop
            if (fine%problem%linkage%step_of_loop(loop) == 0) cycle
            select case (fine%problem%mechanism%groups(loop)%kind)
            case (assur_rrr)
               call add(margin_angle, loop, 0)
            case (assur_rpr, assur_rpr_guide_first)
               ! without a guide a slide always closes
               if (guide(fine, loop) > 0.0_wp) call add(margin_guide, loop, 0)
            case (assur_rrp, assur_prr)
               call add(margin_offset, loop, 0)
            case (assur_prp)
               call add(margin_slides, loop, 0)
            case (assur_higher)
               call add(margin_group, loop, 0)
            end select
         end do
         do r = 1, size(inspector%clearances)
            associate (clearance => inspector%clearances(r))
               if (clearance%region > 0 .and. clearance%shape%kind == region_box .and. clearance%shape%stay_inside) then
                  do edge = 1, box_edges
                     call add(margin_clearance, r, edge)
                  end do
               else
                  call add(margin_clearance, r, 0)
               end if
            end associate
         end do
         if (inspector%irange /= range_positions) then
            inspector%refinement%problem%side = fine%problem%side
            inspector%zoom%problem%side = fine%problem%side
         end if
         do i = 1, size(all_edges)
            call find_least(inspector, dimensions, all_edges(i))
         end do
         thorough = inspector%irange /= range_positions
         if (present(hasty)) thorough = thorough .and. .not. (hasty .and. any(is_violated(all_edges)))
         if (thorough) then
            inspector%places = 0
            call look_into_narrow_places(inspector, dimensions, (fine%problem%delt(inspector%prescribed + 1:)), &
                                         narrowness(inspector, fine, inspector%prescribed + 1), 0, all_edges)
         end if
         do i = 1, size(all_edges)
            ! the nearest edge stands for the box
            if (all_edges(i)%edge > 1) then
               if (all_edges(i)%margin < margins(size(margins))%margin) margins(size(margins)) = all_edges(i)
            else
               margins = [margins, all_edges(i)]
            end if
         end do
         call add_values(inspector, dimensions, margins)
      end associate

   contains

      subroutine add(kind, which, edge)
         integer, intent(in) :: kind, which, edge
         type(margin_t) :: margin

         margin%edge = edge
         margin%kind = kind
         margin%which = which
         margin%unit = merge(1.0_wp, min(inspector%size, maxval(dimensions%arcl)), kind <= margin_slides .or. kind == margin_group)
         margin%least_allowed = -rounding*margin%unit
         if (kind == margin_slides .and. inspector%slide_angle >= right_angle) margin%least_allowed = parallel
         all_edges = [all_edges, margin]
      end subroutine add
   end subroutine inspect

   !> Margins of the variables: the nearest bound, the shortest length.
   subroutine add_values(inspector, dimensions, margins)
      type(inspector_t), intent(in) :: inspector
      type(dimensions_t), intent(in) :: dimensions
      type(margin_t), allocatable, intent(inout) :: margins(:)
      type(margin_t) :: margin
      real(wp), allocatable :: values(:), slack(:)
      logical, allocatable :: is_length(:)

      associate (parameters => inspector%fine%problem%parameters)
         values = parameters%first_values(dimensions)
         is_length = parameters%variables%kind == variable_length .or. parameters%variables%kind == variable_outlk .or. &
                     parameters%variables%kind == variable_aside
      end associate
      if (size(values) == 0) return
      margin%unit = min(inspector%size, maxval(dimensions%arcl))
      margin%least_allowed = -rounding*margin%unit
      if (inspector%bounded) then
         slack = min(values - inspector%low, inspector%high - values)
         margin%kind = margin_bound
         margin%which = minloc(slack, dim=1)
         margin%margin = slack(margin%which)
         margins = [margins, margin]
      end if
      if (.not. any(is_length)) return
      margin%kind = margin_length
      margin%which = minloc(values, dim=1, mask=is_length)
      margin%margin = values(margin%which)
      margins = [margins, margin]
   end subroutine add_values

   !> Margin and place where it is least: over the positions, then, with a range, in every valley between its steps that may
   !> go lower.
   subroutine find_least(inspector, dimensions, margin)
      type(inspector_t), intent(inout) :: inspector
      type(dimensions_t), intent(in) :: dimensions
      type(margin_t), intent(inout) :: margin
      real(wp) :: values(inspector%fine%problem%positions)
      real(wp) :: half, bottom, bend
      integer :: i, n

      n = size(values)
      do i = 1, n
         values(i) = margin_at(inspector, inspector%fine, i, margin)
      end do
      i = minloc(values, dim=1)
      margin%margin = values(i)
      margin%delt = inspector%fine%problem%delt(i)
      if (inspector%irange == range_positions) return
      half = (inspector%fine%problem%delt(n) - inspector%fine%problem%delt(inspector%prescribed + 1))/real(steps_of_range, wp)
      ! at the ends of a full turn the neighbour lies at the other end; the refinement sees it all the same
      do i = inspector%prescribed + 1, n
         associate (before => values(max(i - 1, inspector%prescribed + 1)), after => values(min(i + 1, n)))
            if (values(i) > min(before, after)) cycle
            bend = before + after - 2.0_wp*values(i)
            bottom = values(i)
            if (bend > 0.0_wp) bottom = values(i) - (before - after)**2/(8.0_wp*bend)
            ! a parabola is not all: as much again
            if (2.0_wp*bottom - values(i) - abs(bend) >= margin%margin - 0.01_wp*rounding*margin%unit) cycle
         end associate
         call look_sharper(inspector, dimensions, inspector%fine%problem%delt(i), half, margin)
      end do
   end subroutine find_least

   !> Look for a lesser margin within `half` of an input.
   subroutine look_sharper(inspector, dimensions, delt, half, margin)
      type(inspector_t), intent(inout) :: inspector
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: delt, half
      type(margin_t), intent(inout) :: margin
      real(wp) :: at, reach, value, least
      integer :: i, round

      at = delt
      reach = half
      do round = 1, refinements
         call move_refinement(inspector, dimensions, at, reach)
         least = huge(least)
         do i = 1, steps_of_refinement + 1
            value = margin_at(inspector, inspector%refinement, i, margin)
            if (value >= least) cycle
            least = value
            at = inspector%refinement%problem%delt(i)
         end do
         if (least < margin%margin) then
            margin%margin = least
            margin%delt = at
         end if
         reach = reach*2.0_wp/real(steps_of_refinement, wp)
      end do
   end subroutine look_sharper

   !> Look again at everything where a dyad comes near a dead point: in the valleys of `narrowness` along a row of inputs.
   recursive subroutine look_into_narrow_places(inspector, dimensions, inputs, values, level, margins)
      type(inspector_t), intent(inout) :: inspector
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: inputs(:)            !! shape (n)
      real(wp), intent(in) :: values(:, :)         !! shape (n, nloop): narrowness there
      integer, intent(in) :: level                 !! 0: the range; else the inputs are those round a narrow place
      type(margin_t), intent(inout) :: margins(:)
      real(wp) :: half, at, value
      integer :: loop, i, n

      n = size(inputs)
      do loop = 1, size(values, 2)
         do i = 1, n
            if (level > 0 .and. abs(i - (steps_of_zoom + 1)) <= 1) cycle
            associate (here => values(i, loop), before => values(max(i - 1, 1), loop), after => values(min(i + 1, n), loop))
               if (here > min(before, after) .or. (here >= before .and. i > 1)) cycle
               ! the bottom may be as sharp as the corner of a V
               if (2.0_wp*here - max(before, after) > narrow) cycle
            end associate
            half = max(abs(inputs(i) - inputs(max(i - 1, 1))), abs(inputs(min(i + 1, n)) - inputs(i)))
            at = inputs(i)
            call find_bottom(inspector, dimensions, loop, half, at, value)
            if (value > narrow) cycle
            if (inspector%places >= most_places) return
            inspector%places = inspector%places + 1
            call zoom_in(inspector, dimensions, at, half, margins)
            if (level + 1 < most_levels) call look_into_narrow_places(inspector, dimensions, (inspector%zoom%problem%delt), &
                                                                      narrowness(inspector, inspector%zoom, 1), level + 1, margins)
         end do
      end do
   end subroutine look_into_narrow_places

   !> How near each dyad is to a dead point, from position `first` of a set of samples on: 0 at it. Shape (positions, nloop).
   !>
   !> Two links or a slide with its guide: the distance between the outer joints, for they swing round where these meet. Two
   !> slides: the sine between them, for they run far out. Link pairs, and link and slide: what is left of closing too.
   pure function narrowness(inspector, samples, first) result(near)
      type(inspector_t), intent(in) :: inspector
      type(sample_set_t), intent(in) :: samples
      integer, intent(in) :: first
      real(wp), allocatable :: near(:, :)
      integer :: loop

      associate (link => samples%problem%linkage)
         allocate (near(size(samples%k, 1) - first + 1, size(samples%k, 2)), source=1.0_wp)
         do loop = 1, size(near, 2)
            if (link%step_of_loop(loop) == 0) cycle
            associate (k => samples%k(first:, loop), measure => samples%measure(first:, loop), &
                       dyad => link%steps(link%step_of_loop(loop))%dyad)
               select case (dyad%kind)
               case (assur_rrr)
                  near(:, loop) = sqrt(measure)/(dyad%p + dyad%q)
                  where (abs(k) < 1.0_wp) near(:, loop) = min(near(:, loop), sqrt(1.0_wp - abs(k)))
               case (assur_rpr, assur_rpr_guide_first)
                  near(:, loop) = sqrt(measure)/(inspector%size*link%scale)
               case (assur_rrp, assur_prr)
                  where (abs(k) < 1.0_wp) near(:, loop) = sqrt(1.0_wp - abs(k))
               case (assur_prp)
                  near(:, loop) = abs(measure)
               case (assur_higher)
                  near(:, loop) = max(1.0_wp - k, 0.0_wp)
               end select
            end associate
         end do
      end associate
   end function narrowness

   !> The input within `half` of the given one where a dyad is nearest to a dead point.
   subroutine find_bottom(inspector, dimensions, loop, half, at, least)
      type(inspector_t), intent(inout) :: inspector
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: loop
      real(wp), intent(in) :: half
      real(wp), intent(inout) :: at
      real(wp), intent(out) :: least
      real(wp) :: near(steps_of_refinement + 1, inspector%refinement%problem%mechanism%nloop), reach
      integer :: round, i

      reach = half
      do round = 1, deepest_refinement
         call move_refinement(inspector, dimensions, at, reach)
         near = narrowness(inspector, inspector%refinement, 1)
         i = minloc(near(:, loop), dim=1)
         at = inspector%refinement%problem%delt(i)
         least = near(i, loop)
         reach = reach*2.0_wp/real(steps_of_refinement, wp)
      end do
   end subroutine find_bottom

   !> Look at every constraint within `half` of a narrow place, in steps that shrink towards it.
   subroutine zoom_in(inspector, dimensions, at, half, margins)
      type(inspector_t), intent(inout) :: inspector
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: at, half
      type(margin_t), intent(inout) :: margins(:)
      real(wp) :: inputs(2*steps_of_zoom + 1), values(2*steps_of_zoom + 1)
      integer :: m, i, n

      n = size(inputs)
      do i = 1, steps_of_zoom
         associate (offset => scale(half*part_of_half(mod(i - 1, steps_per_half)), -((i - 1)/steps_per_half)))
            inputs(i) = at - offset
            inputs(n + 1 - i) = at + offset
         end associate
      end do
      inputs(steps_of_zoom + 1) = at
      call clip(inspector, inputs)
      call inspector%zoom%problem%move_inputs(inputs)
      call evaluate_samples(inspector%zoom, dimensions)
      do m = 1, size(margins)
         do i = 1, n
            values(i) = margin_at(inspector, inspector%zoom, i, margins(m))
         end do
         do i = 1, n
            associate (here => values(i), before => values(max(i - 1, 1)), after => values(min(i + 1, n)))
               if (here > min(before, after)) cycle
               if (here < margins(m)%margin) then
                  margins(m)%margin = here
                  margins(m)%delt = inputs(i)
               end if
               if (2.0_wp*here - max(before, after) >= margins(m)%margin - 0.01_wp*rounding*margins(m)%unit) cycle
               call look_sharper(inspector, dimensions, inputs(i), max(inputs(i) - inputs(max(i - 1, 1)), &
                                                                       inputs(min(i + 1, n)) - inputs(i)), margins(m))
            end associate
         end do
      end do
   end subroutine zoom_in

   !> Inputs beyond the range are put on its ends; a full turn has none.
   pure subroutine clip(inspector, inputs)
      type(inspector_t), intent(in) :: inspector
      real(wp), intent(inout) :: inputs(:)

      if (inspector%everywhere) return
      associate (delt => inspector%fine%problem%delt)
         inputs = min(max(inputs, delt(inspector%prescribed + 1)), delt(size(delt)))
      end associate
   end subroutine clip

   !> Lay the refinement on the inputs within `reach` of one, and look.
   subroutine move_refinement(inspector, dimensions, at, reach)
      type(inspector_t), intent(inout) :: inspector
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: at, reach
      real(wp) :: ends(2)
      integer :: i

      ends = [at - reach, at + reach]
      call clip(inspector, ends)
      call inspector%refinement%problem%move_inputs([(ends(1) + (ends(2) - ends(1))*(real(i, wp)/real(steps_of_refinement, wp)), &
                                                i=0, steps_of_refinement)])
      call evaluate_samples(inspector%refinement, dimensions)
   end subroutine move_refinement

   !> Margin of a constraint at position i of a set of samples.
   pure real(wp) function margin_at(inspector, samples, i, margin) result(value)
      type(inspector_t), intent(in) :: inspector
      type(sample_set_t), intent(in) :: samples
      integer, intent(in) :: i
      type(margin_t), intent(in) :: margin
      real(wp) :: at(2, points_of_clearance), unused(2, points_of_clearance)
      integer :: k

      select case (margin%kind)
      case (margin_clearance)
         associate (clearance => inspector%clearances(margin%which))
            do k = 1, points_of_clearance
               if (clearance%points(k) == 0) then
                  at(:, k) = samples%out(i, 1:2)
               else
                  at(:, k) = samples%joints(i, :, clearance%points(k))
               end if
            end do
            if (margin%edge > 0) then
               value = max(edge_distance(clearance%shape, margin%edge, at(1, 1), at(2, 1)), &
                           edge_distance(clearance%shape, margin%edge, at(1, 2), at(2, 2))) + clearance%reach + clearance%asked
            else
               call find_depth(clearance, at, value, unused)
            end if
         end associate
         value = -value
      case (margin_angle)
         ! past closing the sine stands for more than a right angle
         value = abs(samples%k(i, margin%which))
         value = inspector%tangle - (arc_sine(min(value, 1.0_wp)) + max(value - 1.0_wp, 0.0_wp)*degrees_per_radian)
      case (margin_slides)
         ! the angle between them, negative past parallel, less what is to remain of it
         value = inspector%slide_angle - right_angle + arc_sine(max(-1.0_wp, min(1.0_wp - samples%k(i, margin%which), 1.0_wp)))
      case (margin_group)
         value = 1.0_wp - samples%k(i, margin%which)
      case (margin_guide)
         value = guide(samples, margin%which)*(1.0_wp/max(samples%k(i, margin%which), tiny(1.0_wp)**0.25_wp) - 1.0_wp)
      case default
         associate (dyad => samples%problem%linkage%steps(samples%problem%linkage%step_of_loop(margin%which))%dyad)
            value = link_of(dyad)/samples%problem%linkage%scale &
                    *(1.0_wp - abs(samples%k(i, margin%which)))
         end associate
      end select
   end function margin_at

   !> Guide of a dyad of type 2 or 3 and TOGGLE, user's unit.
   pure real(wp) function guide(samples, loop)
      type(sample_set_t), intent(in) :: samples
      integer, intent(in) :: loop

      associate (link => samples%problem%linkage)
         associate (dyad => link%steps(link%step_of_loop(loop))%dyad)
            guide = guide_of(dyad)/link%scale + samples%problem%toggle
         end associate
      end associate
   end function guide

   !> True for a margin that is negative beyond rounding.
   elemental logical function is_violated(margin)
      type(margin_t), intent(in) :: margin

      is_violated = margin%margin < margin%least_allowed
   end function is_violated
end module psalm_margins
