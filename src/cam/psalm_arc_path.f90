!> A smooth curve as a chain of circular arcs within a tolerance of it: biarcs, two arcs a step that meet with one tangent.
!>
!> Each step goes as far as the tolerance allows. What it keeps is measured on samples, and at the end again between them on
!> the curve itself; where that shows more, the chain is made anew with less. Source of the biarc: Bolton,
!> Computer-Aided Design 7 (1975) 29-35.
module psalm_arc_path
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: circle_arc_t, sampled_curve_t, fit_arcs, deviation_of, chords_needed

   real(wp), parameter :: widest = 0.25_wp    !! bulge of an arc, at most: 56 degrees, two of them a step
   real(wp), parameter :: straight = 1.0e-13_wp !! part of its chord by which an arc may rise and be a line

   !> A circular arc, or a line with bulge 0.
   type :: circle_arc_t
      complex(wp) :: start = (0.0_wp, 0.0_wp), finish = (0.0_wp, 0.0_wp)
      complex(wp) :: tangent = (1.0_wp, 0.0_wp)  !! unit vector at the start
      real(wp) :: bulge = 0.0_wp                 !! tangent of a quarter of its angle, above 0 anticlockwise
      real(wp) :: bend = 0.0_wp                  !! curvature, the same sense
   end type circle_arc_t

   !> Samples of a closed curve: points and unit tangents; an arc may not run over a point that is a break.
   type :: sampled_curve_t
      complex(wp), allocatable :: point(:), tangent(:)
      logical, allocatable :: break(:)
   end type sampled_curve_t

contains

   !> Arcs along the samples, from the first to the last. Errors: `found` is false where the tolerance is finer than samples, or the
   !> curve turns back.
   pure subroutine fit_arcs(curve, tolerance, arcs, last_sample, found)
      type(sampled_curve_t), intent(in) :: curve
      real(wp), intent(in) :: tolerance
      type(circle_arc_t), allocatable, intent(out) :: arcs(:)      !! shape (2*steps)
      integer, allocatable, intent(out) :: last_sample(:)   !! shape (steps): where each step ends
      logical, intent(out) :: found
      type(circle_arc_t) :: two(2)
      type(circle_arc_t), allocatable :: longer(:)
      integer, allocatable :: ends(:)
      integer :: n, steps, here, there, next_break, step, reach

      n = size(curve%point)
      allocate (longer(2*n), ends(n))
      steps = 0
      here = 1
      step = 8
      found = .true.
      do while (here < n)
         next_break = here + 1
         do while (next_break < n .and. .not. curve%break(next_break))
            next_break = next_break + 1
         end do
         ! the longest step: doubled or halved, then bisected
         reach = here
         there = min(here + step, next_break)
         do while (fits(here, there))
            reach = there
            if (there == next_break) exit
            there = min(here + 2*(there - here), next_break)
         end do
         do while (there - reach > 1)
            step = (reach + there)/2
            if (fits(here, step)) then
               reach = step
            else
               there = step
            end if
         end do
         if (reach == here) then
            found = .false.
            allocate (arcs(0), last_sample(0))
            return
         end if
         two = biarc(curve%point(here), curve%tangent(here), curve%point(reach), curve%tangent(reach))
         steps = steps + 1
         longer(2*steps - 1:2*steps) = two
         ends(steps) = reach
         step = reach - here
         here = reach
      end do
      arcs = longer(:2*steps)
      last_sample = ends(:steps)

   contains

      pure logical function fits(from, to)
         integer, intent(in) :: from, to
         type(circle_arc_t) :: trial(2)
         integer :: i

         fits = .false.
         if (to <= from) return
         trial = biarc(curve%point(from), curve%tangent(from), curve%point(to), curve%tangent(to))
         if (.not. (abs(trial(1)%bulge) <= widest .and. abs(trial(2)%bulge) <= widest)) return
         ! of neighbours too, that no step turns back
         do i = from + 1, to - 1
            if (abs(deviation_of(trial, curve%point(i))) > tolerance) return
         end do
         fits = .true.
      end function fits
   end subroutine fit_arcs

   !> Two arcs between two points with tangents (unit vectors).
   pure function biarc(p0, t0, p1, t1) result(arcs)
      complex(wp), intent(in) :: p0, t0, p1, t1
      type(circle_arc_t) :: arcs(2)
      complex(wp) :: v, t, joint, turned
      real(wp) :: along, length, open

      v = p1 - p0
      t = t0 + t1
      along = real(conjg(v)*t, wp)
      length = real(conjg(v)*v, wp)
      ! 1 - cosine of the turning, without cancellation
      open = 0.5_wp*real(conjg(t1 - t0)*(t1 - t0), wp)
      joint = 0.5_wp*(p0 + p1)
      if (along > 0.0_wp) then
         joint = joint + 0.5_wp*(length/(along + sqrt(along**2 + 2.0_wp*open*length)))*(t0 - t1)
      end if
      arcs(1) = arc_between(p0, joint, t0)
      v = joint - p0
      turned = v*v*conjg(t0)
      arcs(2) = arc_between(joint, p1, turned/max(hypotenuse(real(turned, wp), aimag(turned)), tiny(1.0_wp)))
   end function biarc

   !> The arc that leaves a point with a tangent and ends at another.
   pure type(circle_arc_t) function arc_between(start, finish, tangent) result(arc)
      complex(wp), intent(in) :: start, finish, tangent
      complex(wp) :: w
      real(wp) :: chord

      w = (finish - start)*conjg(tangent)
      chord = hypotenuse(real(w, wp), aimag(w))
      arc%start = start
      arc%finish = finish
      arc%tangent = tangent
      if (abs(aimag(w)) <= straight*chord .and. real(w, wp) > 0.0_wp) return
      ! past a half turn the bulge exceeds 1: such arcs are refused
      arc%bulge = sign(2.0_wp, aimag(w))
      if (chord + real(w, wp) > 0.0_wp) arc%bulge = aimag(w)/(chord + real(w, wp))
      arc%bend = 2.0_wp*aimag(w)/chord**2
   end function arc_between

   !> Signed distance of a point from two arcs, to the left: from the one beside which it lies.
   pure real(wp) function deviation_of(arcs, point) result(distance)
      type(circle_arc_t), intent(in) :: arcs(2)
      complex(wp), intent(in) :: point
      complex(wp) :: w
      real(wp) :: f
      integer :: k

      k = merge(2, 1, real((point - arcs(2)%start)*conjg(arcs(2)%tangent), wp) > 0.0_wp)
      w = (point - arcs(k)%start)*conjg(arcs(k)%tangent)
      f = 2.0_wp*aimag(w) - arcs(k)%bend*real(conjg(w)*w, wp)
      distance = f/(1.0_wp + sqrt(max(1.0_wp - arcs(k)%bend*f, 0.0_wp)))
   end function deviation_of

   !> Chords that a polyline of the tolerance needs: the integral of sqrt(curvature/(8 tolerance)) over the length.
   pure real(wp) function chords_needed(point, bend, tolerance) result(chords)
      complex(wp), intent(in) :: point(:)
      real(wp), intent(in) :: bend(:)            !! curvature of the curve there
      real(wp), intent(in) :: tolerance
      complex(wp) :: w
      integer :: i

      chords = 0.0_wp
      do i = 2, size(point)
         w = point(i) - point(i - 1)
         chords = chords + 0.5_wp*(sqrt(abs(bend(i))/(8.0_wp*tolerance)) + sqrt(abs(bend(i - 1))/(8.0_wp*tolerance))) &
                  *hypotenuse(real(w, wp), aimag(w))
      end do
   end function chords_needed
end module psalm_arc_path
