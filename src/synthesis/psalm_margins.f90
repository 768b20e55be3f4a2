!> How far a linkage is inside each of its constraints, at the prescribed positions and over the range asked for.
!>
!> A range is looked at in steps of half a degree; in every valley that may be the deepest the look is sharpened until a
!> thousandth of that.
module psalm_margins
   use psalm_angles, only: arc_sine
   use psalm_constraint_group, only: region_t, range_positions, range_turn, region_box
   use psalm_data_set, only: data_set_t, motion_point
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, degrees_per_radian, right_angle
   use psalm_merit, only: watch_inputs
   use psalm_regions, only: trespass, beyond_edge, box_edges, region_joints, joint_of_region
   use psalm_station, only: station_t, prepare_station, look
   use psalm_topology, only: dimensions_t, variable_length, variable_outlk
   implicit none (type, external)
   private
   public :: margin_t, inspector_t, prepare_inspector, inspect, is_violated
   public :: margin_angle, margin_guide, margin_offset, margin_region, margin_bound, margin_length

   integer, parameter :: margin_angle = 1    !! transmission angle of a link pair inside its limits, degrees
   integer, parameter :: margin_guide = 2    !! distance over guide and TOGGLE, length
   integer, parameter :: margin_offset = 3   !! link over offset and TOGGLE, length
   integer, parameter :: margin_region = 4   !! distance from a forbidden region, length
   integer, parameter :: margin_bound = 5    !! variable inside its bounds, its own unit
   integer, parameter :: margin_length = 6   !! a variable length, length
   integer, parameter :: steps_of_range = 720, steps_of_lens = 16, lenses = 3
   real(wp), parameter :: rounding = 1.0e-9_wp !! a negative margin smaller than this, relative to the linkage, is rounding

   !> The least margin of one constraint.
   type :: margin_t
      integer :: kind = 0
      integer :: which = 0                   !! loop, region or variable
      real(wp) :: margin = huge(1.0_wp)      !! negative: violated
      real(wp) :: delt = 0.0_wp              !! input increment where it is least
      real(wp) :: unit = 1.0_wp              !! what counts as much, for rounding
      integer :: edge = 0                    !! of a box to stay inside of: each edge has its own valleys
   end type margin_t

   type :: inspector_t
      type(station_t) :: fine                !! prescribed positions, then the range
      type(station_t) :: lens
      integer :: irange = range_positions
      integer :: prescribed = 0              !! positions
      logical :: turns = .false.             !! the input turns
      logical :: everywhere = .false.        !! the range is a full turn
      real(wp) :: tangle = right_angle
      real(wp) :: size = 1.0_wp              !! longest given arc: what rounding is measured by
      type(region_t), allocatable :: regions(:)
      integer, allocatable :: joint(:)       !! by region
      logical :: bounded = .false.
      real(wp), allocatable :: low(:), high(:)
   end type inspector_t

contains

   !> Make ready for a problem with its inputs.
   subroutine prepare_inspector(set, problem, toggle, inspector)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      logical, intent(in) :: toggle                !! TOGGLE is a constraint, not only a distance of repair
      type(inspector_t), intent(out) :: inspector
      type(problem_t) :: plain
      integer, allocatable :: joints(:, :)
      real(wp), allocatable :: inputs(:)
      integer :: r, marble

      marble = size(problem%topology%variables)
      inspector%irange = set%constr%irange
      inspector%prescribed = problem%positions
      inspector%turns = .not. problem%topology%sliding_input
      inspector%everywhere = inspector%turns .and. inspector%irange == range_turn
      inspector%tangle = set%tangle
      inspector%size = maxval(problem%given%arcl)
      inspector%regions = set%constr%regions
      joints = region_joints(inspector%regions)
      allocate (inspector%joint(size(inspector%regions)), source=0)
      do r = 1, size(inspector%regions)
         inspector%joint(r) = joint_of_region(inspector%regions(r), joints)
      end do
      plain = problem
      plain%tangle = right_angle
      if (.not. toggle) plain%toggle = 0.0_wp
      if (size(inspector%regions) > 0) plain%motion = motion_point
      inputs = problem%delt
      if (inspector%irange /= range_positions) then
         inputs = [inputs, watch_inputs(inspector%irange, problem, problem%delt, steps_of_range, 0)]
         call prepare_station(plain, inputs(:steps_of_lens + 1), .false., joints, .false., inspector%lens)
      end if
      call prepare_station(plain, inputs, .false., joints, .false., inspector%fine)
      inspector%bounded = set%limval == 1 .and. marble > 0
      if (inspector%bounded) then
         inspector%low = set%oplow(:marble)
         inspector%high = set%ophigh(:marble)
      end if
   end subroutine prepare_inspector

   !> All margins of a linkage, with the input increments `delt`.
   subroutine inspect(inspector, dimensions, delt, margins)
      type(inspector_t), intent(inout) :: inspector
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: delt(:)              !! shape (positions)
      type(margin_t), allocatable, intent(out) :: margins(:)
      type(margin_t) :: margin
      integer :: loop, r, edge

      allocate (margins(0))
      associate (fine => inspector%fine)
         if (inspector%irange == range_positions) then
            call fine%problem%move_inputs(delt)
         else
            call fine%problem%move_inputs([delt, watch_inputs(inspector%irange, fine%problem, delt, steps_of_range, 0)])
         end if
         call look(fine, dimensions)
         do loop = 1, fine%problem%topology%nloop
            if (fine%problem%linkage%step_of_loop(loop) == 0) cycle
            select case (fine%problem%topology%joint(loop))
            case (1)
               call add(margin_angle, loop)
            case (2, 3)
               ! without a guide a slide always closes
               if (guide(fine, loop) > 0.0_wp) call add(margin_guide, loop)
            case (4, 5)
               call add(margin_offset, loop)
            end select
         end do
         do r = 1, size(inspector%regions)
            if (inspector%regions(r)%kind == region_box .and. inspector%regions(r)%stay_inside) then
               do edge = 1, box_edges
                  call add(margin_region, r, edge)
               end do
               ! the nearest edge stands for the box
               associate (from => size(margins) - box_edges)
                  margins(from + 1) = margins(from + minloc(margins(from + 1:)%margin, dim=1))
                  margins = margins(:from + 1)
               end associate
            else
               call add(margin_region, r)
            end if
         end do
         call add_values(inspector, dimensions, margins)
      end associate

   contains

      subroutine add(kind, which, one_edge)
         integer, intent(in) :: kind, which
         integer, intent(in), optional :: one_edge

         margin%edge = 0
         if (present(one_edge)) margin%edge = one_edge
         margin%kind = kind
         margin%which = which
         margin%unit = merge(1.0_wp, min(inspector%size, maxval(dimensions%arcl)), kind == margin_angle)
         call find_least(inspector, dimensions, margin)
         margins = [margins, margin]
      end subroutine add
   end subroutine inspect

   !> Margins of the variables: the nearest bound, the shortest length.
   subroutine add_values(inspector, dimensions, margins)
      type(inspector_t), intent(in) :: inspector
      type(dimensions_t), intent(in) :: dimensions
      type(margin_t), allocatable, intent(inout) :: margins(:)
      type(margin_t) :: margin
      real(wp), allocatable :: values(:), room(:)
      logical, allocatable :: is_length(:)

      associate (topology => inspector%fine%problem%topology)
         values = topology%first_values(dimensions)
         is_length = topology%variables%kind == variable_length .or. topology%variables%kind == variable_outlk
      end associate
      if (size(values) == 0) return
      margin%unit = min(inspector%size, maxval(dimensions%arcl))
      if (inspector%bounded) then
         room = min(values - inspector%low, inspector%high - values)
         margin%kind = margin_bound
         margin%which = minloc(room, dim=1)
         margin%margin = room(margin%which)
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
      ! at the ends of a full turn the neighbour lies at the other end; the lens sees it all the same
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
      real(wp) :: at, reach, from, to, value, least
      integer :: i, round

      at = delt
      reach = half
      do round = 1, lenses
         from = at - reach
         to = at + reach
         if (.not. inspector%everywhere) then
            from = max(from, inspector%fine%problem%delt(inspector%prescribed + 1))
            to = min(to, inspector%fine%problem%delt(inspector%fine%problem%positions))
         end if
         call inspector%lens%problem%move_inputs([(from + (to - from)*(real(i, wp)/real(steps_of_lens, wp)), i=0, steps_of_lens)])
         call look(inspector%lens, dimensions)
         least = huge(least)
         do i = 1, steps_of_lens + 1
            value = margin_at(inspector, inspector%lens, i, margin)
            if (value >= least) cycle
            least = value
            at = inspector%lens%problem%delt(i)
         end do
         if (least < margin%margin) then
            margin%margin = least
            margin%delt = at
         end if
         reach = reach*2.0_wp/real(steps_of_lens, wp)
      end do
   end subroutine look_sharper

   !> Margin of a constraint at position i of a station.
   pure real(wp) function margin_at(inspector, station, i, margin) result(value)
      type(inspector_t), intent(in) :: inspector
      type(station_t), intent(in) :: station
      integer, intent(in) :: i
      type(margin_t), intent(in) :: margin
      real(wp) :: x, y, gx, gy

      select case (margin%kind)
      case (margin_region)
         associate (r => margin%which, j => inspector%joint(margin%which))
            if (j == 0) then
               x = station%out(i, 1)
               y = station%out(i, 2)
            else
               x = station%joints(i, 1, j)
               y = station%joints(i, 2, j)
            end if
            if (margin%edge > 0) then
               value = beyond_edge(inspector%regions(r), margin%edge, x, y)
            else
               call trespass(inspector%regions(r), x, y, value, gx, gy)
            end if
         end associate
         value = -value
      case (margin_angle)
         ! past closing the sine stands for more than a right angle
         value = abs(station%k(i, margin%which))
         value = inspector%tangle - (arc_sine(min(value, 1.0_wp)) + max(value - 1.0_wp, 0.0_wp)*degrees_per_radian)
      case (margin_guide)
         value = guide(station, margin%which)*(1.0_wp/max(station%k(i, margin%which), tiny(1.0_wp)**0.25_wp) - 1.0_wp)
      case default
         associate (dyad => station%problem%linkage%steps(station%problem%linkage%step_of_loop(margin%which)))
            value = merge(dyad%p, dyad%q, dyad%joint == 4)/station%problem%linkage%scale &
                    *(1.0_wp - abs(station%k(i, margin%which)))
         end associate
      end select
   end function margin_at

   !> Guide of a dyad of type 2 or 3 and TOGGLE, user's unit.
   pure real(wp) function guide(station, loop)
      type(station_t), intent(in) :: station
      integer, intent(in) :: loop

      associate (link => station%problem%linkage)
         associate (dyad => link%steps(link%step_of_loop(loop)))
            guide = merge(dyad%q, dyad%p, dyad%joint == 2)/link%scale + station%problem%toggle
         end associate
      end associate
   end function guide

   !> True for a margin that is negative beyond rounding.
   elemental logical function is_violated(margin)
      type(margin_t), intent(in) :: margin

      is_violated = margin%margin < -rounding*margin%unit
   end function is_violated
end module psalm_margins
