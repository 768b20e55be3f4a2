!> A cam as a whole: motion, follower and shape at any cam angles, and the extremes of everything over a turn.
module psalm_cam_shape
   use psalm_angles, only: unit_vector
   use psalm_cam_data, only: cam_group_t, follower_flat
   use psalm_cam_motion, only: cam_motion_t
   use psalm_cam_profile, only: cam_axes_t, cam_points_t, roller_profile, flat_profile, side_of_centre, mark_standstill
   use psalm_cam_trace, only: cam_trace_t, fault_none
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp, full_turn, radians_per_degree
   implicit none (type, external)
   private
   public :: cam_shape_t, cam_extreme_t, samples_t, measure, sample_turn, find_extreme, greatest_of
   public :: measure_pressure, measure_convex, measure_concave, measure_base, measure_outer, measure_excursion_low, &
             measure_excursion_high, measure_face_low, measure_face_high, measure_output, measure_input, measures, upward, &
             table_angles

   integer, parameter :: samples_of_turn = 7200, fewest_of_piece = 16
   integer, parameter :: samples_of_chain = 1800     !! of a sketch solved in the poses of its links, which takes longer
   integer, parameter :: golden_steps = 60
   real(wp), parameter :: equal = 1.0e-13_wp         !! relative difference of values that is rounding
   real(wp), parameter :: golden = 0.61803398874989484820458683436563812_wp

   !> What may be extreme: the largest of each is looked for.
   integer, parameter :: measure_pressure = 1        !! |alpha|
   integer, parameter :: measure_convex = 2          !! curvature of the pitch curve where convex
   integer, parameter :: measure_concave = 3         !! where concave
   integer, parameter :: measure_base = 4            !! minus the distance of profile (pitch curve less roller) from the centre
   integer, parameter :: measure_outer = 5           !! that distance
   integer, parameter :: measure_excursion_low = 6, measure_excursion_high = 7
   integer, parameter :: measure_face_low = 8, measure_face_high = 9
   integer, parameter :: measure_output = 10         !! and the next two: |y'|, |y''|, |y'''|
   integer, parameter :: measure_input = 13          !! and the next two: |q'|, |q''|, |q'''|
   integer, parameter :: measures = 15

   type :: cam_shape_t
      type(cam_motion_t) :: motion
      type(cam_axes_t) :: axes
      logical :: flat = .false.
      real(wp) :: side = 1.0_wp                      !! eps of a roller
      real(wp) :: roller = 0.0_wp, cutter = 0.0_wp   !! radii
      real(wp) :: face = 0.0_wp                      !! degrees
   end type cam_shape_t

   !> A turn, piece by piece of the law, both ends of each.
   type :: samples_t
      real(wp), allocatable :: angle(:)
      integer, allocatable :: piece(:)
      type(cam_trace_t) :: states
      type(cam_points_t) :: points
      logical, allocatable :: possible(:)            !! false where a flat face turns with the cam
   end type samples_t

   type :: cam_extreme_t
      real(wp) :: value = 0.0_wp
      real(wp) :: angle = 0.0_wp                     !! of the cam, degrees
      logical :: found = .false.
   end type cam_extreme_t

contains

   !> The cam at angles on pieces of the law.
   subroutine measure(shape, angle, piece, states, points, possible)
      type(cam_shape_t), intent(inout) :: shape
      real(wp), intent(in) :: angle(:)
      integer, intent(in) :: piece(:)
      type(cam_trace_t), intent(out) :: states
      type(cam_points_t), intent(out) :: points
      logical, allocatable, intent(out) :: possible(:)

      call shape%motion%trace(angle, piece, states)
      call shape_of(shape, states, points, possible)
   end subroutine measure

   subroutine shape_of(shape, states, points, possible)
      type(cam_shape_t), intent(in) :: shape
      type(cam_trace_t), intent(in) :: states
      type(cam_points_t), intent(out) :: points
      logical, allocatable, intent(out) :: possible(:)

      allocate (possible(size(states%angle)), source=.true.)
      if (shape%flat) then
         call flat_profile(states, shape%axes, shape%face, shape%cutter, points, possible)
      else
         call roller_profile(states, shape%axes, shape%side, shape%roller, shape%cutter, points)
      end if
   end subroutine shape_of

   !> Sample a turn. The side of a roller's cam follows from it unless it is forced. Where the motion has a fault the shape is of no
   !> meaning.
   subroutine sample_turn(shape, cam, samples, of_turn)
      type(cam_shape_t), intent(inout) :: shape
      type(cam_group_t), intent(in) :: cam
      type(samples_t), intent(out) :: samples
      integer, intent(in), optional :: of_turn       !! about so many; as many as is usual if absent
      integer :: k, i, n, of_piece, wanted

      wanted = merge(samples_of_chain, samples_of_turn, allocated(shape%motion%chain))
      if (present(of_turn)) wanted = min(wanted, of_turn)
      n = 0
      associate (pieces => shape%motion%law%pieces)
         do k = 1, size(pieces)
            n = n + samples_in(wanted, pieces(k)%width) + 1
         end do
         allocate (samples%angle(n), samples%piece(n))
         n = 0
         do k = 1, size(pieces)
            of_piece = samples_in(wanted, pieces(k)%width)
            do i = 0, of_piece
               n = n + 1
               samples%angle(n) = pieces(k)%start + pieces(k)%width*(real(i, wp)/real(of_piece, wp))
               samples%piece(n) = k
            end do
         end do
      end associate
      call shape%motion%trace(samples%angle, samples%piece, samples%states)
      call settle_side(shape, cam, samples%states)
      if (any(samples%states%fault /= fault_none)) return
      if (.not. shape%flat) call mark_standstill(shape%axes, samples%states)
      if (any(samples%states%fault /= fault_none)) return
      call shape_of(shape, samples%states, samples%points, samples%possible)
   end subroutine sample_turn

   pure integer function samples_in(of_turn, width)
      integer, intent(in) :: of_turn
      real(wp), intent(in) :: width    !! degrees

      samples_in = max(fewest_of_piece, nint(real(of_turn, wp)*width/full_turn))
   end function samples_in

   pure subroutine settle_side(shape, cam, states)
      type(cam_shape_t), intent(inout) :: shape
      type(cam_group_t), intent(in) :: cam
      type(cam_trace_t), intent(in) :: states
      real(wp) :: c, s

      shape%axes = cam_axes_t(cmplx(cam%x, cam%y, wp), real(cam%turn, wp))
      if (cam%slides) then
         call unit_vector(cam%direction, c, s)
         shape%axes%slides = .true.
         shape%axes%way = (cam%travel/(full_turn*radians_per_degree))*cmplx(c, s, wp)
      end if
      shape%flat = cam%kind == follower_flat
      shape%side = side_of_centre(states, shape%axes)
      if (cam%side /= 0) shape%side = real(cam%side, wp)
   end subroutine settle_side

   !> A measure at every point.
   pure function values_of(shape, what, states, points) result(value)
      type(cam_shape_t), intent(in) :: shape
      integer, intent(in) :: what
      type(cam_trace_t), intent(in) :: states
      type(cam_points_t), intent(in) :: points
      real(wp) :: value(size(states%angle))

      select case (what)
      case (measure_pressure)
         value = abs(points%pressure)
      case (measure_convex)
         value = points%bend
      case (measure_concave)
         value = -points%bend
      case (measure_base)
         value = -distance(points, shape)
      case (measure_outer)
         value = distance(points, shape)
      case (measure_excursion_low)
         value = -points%excursion
      case (measure_excursion_high)
         value = points%excursion
      case (measure_face_low)
         value = -points%on_face
      case (measure_face_high)
         value = points%on_face
      case (measure_output:measure_output + 2)
         value = abs(states%y(what - measure_output + 1, :))
      case default
         value = abs(states%q(what - measure_input + 1, :))
      end select
   end function values_of

   !> Unit vector out of the body of a cam that slides, square to its way.
   pure complex(wp) function upward(shape) result(up)
      type(cam_shape_t), intent(in) :: shape

      up = cmplx(0.0_wp, shape%side, wp)*shape%axes%way/hypotenuse(real(shape%axes%way, wp), aimag(shape%axes%way))
   end function upward

   !> Even cam angles: n of a turn; of a cam that slides from one end to the other.
   pure function table_angles(shape, n) result(angle)
      type(cam_shape_t), intent(in) :: shape
      integer, intent(in) :: n
      real(wp) :: angle(n)
      integer :: k

      angle = [(full_turn*real(k - 1, wp)/real(n - merge(1, 0, shape%axes%slides), wp), k=1, n)]
   end function table_angles

   !> Of the profile from the centre; of a roller's cam along the line to the roller; of a cam that slides its height.
   pure function distance(points, shape) result(r)
      type(cam_points_t), intent(in) :: points
      type(cam_shape_t), intent(in) :: shape
      real(wp) :: r(size(points%pitch))

      if (shape%axes%slides) then
         r = real(conjg(upward(shape))*points%pitch, wp) - shape%roller
      else if (shape%flat) then
         ! of the face: h
         r = real(conjg(points%normal)*points%profile, wp)
      else
         r = hypotenuse(real(points%pitch, wp), aimag(points%pitch)) - shape%roller
      end if
   end function distance

   !> The largest value of a measure over a segment of the law: the best sample, refined by a parabola through its neighbours.
   function greatest_of(shape, samples, what, segment) result(greatest)
      type(cam_shape_t), intent(in) :: shape
      type(samples_t), intent(in) :: samples
      integer, intent(in) :: what
      integer, intent(in) :: segment
      real(wp) :: greatest
      real(wp) :: value(size(samples%angle)), bend
      integer :: i

      value = values_of(shape, what, samples%states, samples%points)
      i = maxloc(value, dim=1, mask=shape%motion%law%pieces(samples%piece)%segment == segment)
      greatest = value(i)
      if (i == 1 .or. i == size(value)) return
      if (samples%piece(i - 1) /= samples%piece(i) .or. samples%piece(i + 1) /= samples%piece(i)) return
      bend = value(i - 1) - 2.0_wp*value(i) + value(i + 1)
      if (bend < 0.0_wp) greatest = value(i) - 0.125_wp*(value(i + 1) - value(i - 1))**2/bend
   end function greatest_of

   !> The largest value of a measure over some segments of the law: the best sample, refined by golden sections on the closed forms
   !> within its piece.
   subroutine find_extreme(shape, samples, what, wanted, extreme)
      type(cam_shape_t), intent(inout) :: shape
      type(samples_t), intent(in) :: samples
      integer, intent(in) :: what
      logical, intent(in) :: wanted(:)               !! by segment
      type(cam_extreme_t), intent(out) :: extreme
      type(cam_trace_t) :: states
      type(cam_points_t) :: points
      logical, allocatable :: possible(:)
      real(wp) :: value(size(samples%angle)), low, high, inner(2), two(2)
      logical :: mask(size(samples%angle))
      integer :: best, k

      value = values_of(shape, what, samples%states, samples%points)
      mask = wanted(shape%motion%law%pieces(samples%piece)%segment)
      if (.not. any(mask)) return
      ! of those that differ by rounding, as in a dwell, the first
      low = maxval(value, mask)
      best = findloc(mask .and. value >= low - equal*max(1.0_wp, abs(low)), .true., dim=1)
      extreme = cam_extreme_t(value(best), samples%angle(best), .true.)
      low = samples%angle(best)
      high = low
      if (best > 1) then
         if (samples%piece(best - 1) == samples%piece(best)) low = samples%angle(best - 1)
      end if
      if (best < size(value)) then
         if (samples%piece(best + 1) == samples%piece(best)) high = samples%angle(best + 1)
      end if
      inner = [high - golden*(high - low), low + golden*(high - low)]
      do k = 1, golden_steps
         call measure(shape, inner, [samples%piece(best), samples%piece(best)], states, points, possible)
         two = values_of(shape, what, states, points)
         if (maxval(two) > extreme%value + equal*max(1.0_wp, abs(extreme%value))) &
            extreme = cam_extreme_t(maxval(two), inner(maxloc(two, 1)), .true.)
         if (two(1) >= two(2)) then
            high = inner(2)
         else
            low = inner(1)
         end if
         inner = [high - golden*(high - low), low + golden*(high - low)]
      end do
      if (extreme%angle >= full_turn .and. .not. shape%axes%slides) extreme%angle = extreme%angle - full_turn
   end subroutine find_extreme
end module psalm_cam_shape
