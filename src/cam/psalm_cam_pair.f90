!> Two rollers that hold the follower between them: the play of conjugate cams whose profiles have errors, and the gap under a
!> second roller that runs on the same profile.
!>
!> Both rollers of conjugate cams touch at every cam angle; what is missing on the profiles, e1 and e2 along the normal, lets the
!> first roller move by e1/cos a1 + e2 l1/(l2 cos a2), l = |dc/dq|. One profile for two rollers (Jackowski and Dubil) fits if its
!> breadth goes with the rollers' distance; a yoke with two equal rollers through the centre needs y(th) + y(th + 180) to stay the
!> same. Source: Oldham (1977), 1.1 and 9.3.2; derivation in doc/theory/cams.md.
module psalm_cam_pair
   use psalm_cam_profile, only: cam_points_t
   use psalm_cam_shape, only: cam_shape_t, samples_t, cam_extreme_t, measure
   use psalm_cam_trace, only: cam_trace_t
   use psalm_angles, only: unit_vector
   use psalm_kinds, only: wp, full_turn
   implicit none (type, external)
   private
   public :: play_of, gap_t, find_gap, greatest_in, least_in

   integer, parameter :: rounds = 40             !! bisections of the interval between samples

   !> The second roller at a row of cam angles.
   type :: gap_t
      real(wp), allocatable :: gap(:)            !! between roller and profile, below 0: it does not fit
      real(wp), allocatable :: lag(:)            !! degrees of cam from here to where the first roller touches the same point
   end type gap_t

contains

   !> Way of the first roller along its line of travel that the errors of both profiles allow; below 0: both press.
   elemental real(wp) function play_of(errors_1, errors_2, pressure_1, pressure_2, lever_1, lever_2) result(play)
      real(wp), intent(in) :: errors_1, errors_2     !! missing on the profiles along the normal
      real(wp), intent(in) :: pressure_1, pressure_2 !! pressure angles, degrees
      real(wp), intent(in) :: lever_1, lever_2       !! |dc/dq|
      real(wp) :: cosine(2), unused

      call unit_vector(pressure_1, cosine(1), unused)
      call unit_vector(pressure_2, cosine(2), unused)
      play = errors_1/max(cosine(1), tiny(1.0_wp)) + errors_2*lever_1/max(lever_2*cosine(2), tiny(1.0_wp))
   end function play_of

   !> The gap under the second roller: from the nearest sample of the profile to where the line to the roller's centre is square
   !> to it.
   subroutine find_gap(shape, samples, states, points, second, radius, found)
      type(cam_shape_t), intent(inout) :: shape
      type(samples_t), intent(in) :: samples
      type(cam_trace_t), intent(in) :: states        !! of the first roller at the angles
      type(cam_points_t), intent(in) :: points
      type(cam_trace_t), intent(in) :: second        !! of the second
      real(wp), intent(in) :: radius                 !! of the second
      type(gap_t), intent(out) :: found
      type(cam_trace_t) :: there
      type(cam_points_t) :: touched
      logical, allocatable :: possible(:)
      complex(wp) :: w(size(states%angle))
      real(wp) :: low(size(w)), high(size(w)), middle(size(w)), step
      integer :: i, k, n, round

      ! the second roller in axes of the cam
      w = (second%c(0, :) - shape%axes%centre)*conjg(points%machine)
      n = size(samples%angle)
      step = full_turn/real(n, wp)
      do i = 1, size(w)
         k = minloc(real((samples%points%profile - w(i))*conjg(samples%points%profile - w(i)), wp), dim=1)
         low(i) = samples%angle(k) - 2.0_wp*step
         high(i) = samples%angle(k) + 2.0_wp*step
      end do
      do round = 0, rounds
         middle = modulo(0.5_wp*(low + high), full_turn)
         call measure(shape, middle, shape%motion%law%piece_at(middle), there, touched, possible)
         if (round == rounds) exit
         ! ahead of the foot the roller lies behind
         where (real((w - touched%profile)*conjg(touched%tangent), wp) > 0.0_wp)
            low = 0.5_wp*(low + high)
         else where
            high = 0.5_wp*(low + high)
         end where
      end do
      found%gap = real((w - touched%profile)*conjg(touched%normal), wp) - radius
      found%lag = modulo(middle - states%angle, full_turn)
   end subroutine find_gap

   !> The greatest of values at even angles of a turn, by a parabola through its neighbours.
   pure type(cam_extreme_t) function greatest_in(values, angle) result(greatest)
      real(wp), intent(in) :: values(:), angle(:)
      real(wp) :: before, after, bend, share
      integer :: i, n

      n = size(values)
      i = maxloc(values, dim=1)
      greatest = cam_extreme_t(values(i), angle(i), .true.)
      before = values(1 + modulo(i - 2, n))
      after = values(1 + modulo(i, n))
      bend = before - 2.0_wp*values(i) + after
      if (.not. bend < 0.0_wp) return
      share = 0.5_wp*(before - after)/bend
      greatest%value = values(i) - 0.125_wp*(after - before)**2/bend
      greatest%angle = modulo(angle(i) + share*full_turn/real(n, wp), full_turn)
   end function greatest_in

   pure type(cam_extreme_t) function least_in(values, angle) result(least)
      real(wp), intent(in) :: values(:), angle(:)

      least = greatest_in(-values, angle)
      least%value = -least%value
   end function least_in
end module psalm_cam_pair
