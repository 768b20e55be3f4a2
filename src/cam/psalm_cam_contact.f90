!> The force between cam and roller or face, the speed at which contact is lost, and the stress there.
!>
!> The linkage is reduced to its input: inertia J(q), and the forces of weight, loads, springs and dampers on it. The cam gives
!> what is missing: N (nu . dc/dq) = J q'' w**2 + J' q'**2 w**2/2 - Q(q) + D q' w, nu the direction of its push.
!> N below 0: contact is lost. With friction N mu acts on the follower against its way along the profile, at the place of
!> contact: a roller that turns freely has mu near 0. Where both together cannot move the follower it jams.
!> Stress on a line: Hertz (1882).
module psalm_cam_contact
   use psalm_cam_data, only: cam_group_t
   use psalm_cam_trace, only: cam_trace_t
   use psalm_cam_profile, only: cam_axes_t, cam_points_t
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t
   use psalm_kinds, only: wp, pi
   use psalm_reduced, only: reduced_t, reduce_machine
   implicit none (type, external)
   private
   public :: cam_contact_t, find_contact, line_stress

   real(wp), parameter :: per_minute = 2.0_wp*pi/60.0_wp   !! rad/s of one revolution a minute

   !> At a row of cam angles.
   type :: cam_contact_t
      logical :: known = .false.                 !! there is a speed, and the linkage has masses, loads or springs
      real(wp), allocatable :: force(:)          !! N: of the cam on the follower at the given speed
      real(wp), allocatable :: stress(:)         !! Pa; 0 where there is no contact or no width is given
      real(wp) :: lost_at = 0.0_wp               !! cam angle at which contact is first lost as the speed grows, degrees
      real(wp) :: lost_speed = 0.0_wp            !! and the speed, rev/min; 0: it is never lost
      logical :: jams = .false.                  !! friction keeps the cam from moving the follower
   end type cam_contact_t

contains

   !> Force and stress at the states of a trace. `problem` is left at their inputs.
   subroutine find_contact(cam, model, problem, delt, states, points, roller, axes, contact)
      type(cam_group_t), intent(in) :: cam
      type(force_model_t), intent(in) :: model
      type(problem_t), intent(inout) :: problem
      real(wp), intent(in) :: delt(:)            !! their inputs from CRNKI, degrees or length
      type(cam_trace_t), intent(in) :: states
      type(cam_points_t), intent(in) :: points
      real(wp), intent(in) :: roller             !! radius; 0: flat or a knife edge
      type(cam_axes_t), intent(in) :: axes
      type(cam_contact_t), intent(out) :: contact
      type(reduced_t) :: reduced
      complex(wp) :: push, force, by_input
      real(wp), allocatable :: square(:), linear(:), rest(:), lost(:)
      real(wp) :: arm, w, curvature, left, middle, right
      integer :: i, n

      n = size(states%angle)
      call reduce_machine(problem, model, delt, reduced)
      contact%known = reduced%failure == 0
      allocate (contact%force(n), contact%stress(n), square(n), linear(n), rest(n), lost(n), source=0.0_wp)
      if (.not. contact%known) return
      w = cam%speed*per_minute
      do i = 1, n
         push = points%normal(i)*points%machine(i)
         ! what is touched: of a face beside its point, of a roller below its centre
         by_input = states%by_input(i) + cmplx(0.0_wp, states%turning_by_input(i), wp)*place_of(i)
         force = push - cam%friction*sign(1.0_wp, slip_of(i))*points%tangent(i)*points%machine(i)
         ! the cam's push moves the input in this sense; friction may turn it round
         arm = real(conjg(force)*by_input, wp)*model%metre
         contact%jams = contact%jams .or. arm*real(conjg(push)*by_input, wp) <= 0.0_wp
         square(i) = (reduced%inertia(i)*states%q(2, i) + 0.5_wp*reduced%slope(i)*states%q(1, i)**2)/arm
         linear(i) = reduced%damping(i)*states%q(1, i)/arm
         rest(i) = -reduced%torque(i)/arm
         contact%force(i) = (square(i)*w + linear(i))*w + rest(i)
         lost(i) = first_root(square(i), linear(i), rest(i))
         curvature = 1.0_wp/points%radius(i)
         if (roller > 0.0_wp) curvature = curvature + 1.0_wp/roller
         if (cam%width > 0.0_wp) contact%stress(i) = line_stress(contact%force(i)/(cam%width*model%metre), &
                                                                 curvature/model%metre, cam%modulus, cam%poisson)
      end do
      i = minloc(lost, dim=1)
      if (.not. lost(i) < huge(1.0_wp)) return
      contact%lost_at = states%angle(i)
      contact%lost_speed = lost(i)/per_minute
      if (i == 1 .or. i == n) return
      left = lost(i - 1)
      middle = lost(i)
      right = lost(i + 1)
      if (.not. max(left, right) < huge(1.0_wp)) return
      if (.not. left - 2.0_wp*middle + right > 0.0_wp) return
      ! through even samples: the parabola's least value
      if (abs((states%angle(i + 1) - states%angle(i)) - (states%angle(i) - states%angle(i - 1))) &
          > 1.0e-6_wp*(states%angle(i + 1) - states%angle(i))) return
      contact%lost_at = states%angle(i) + 0.5_wp*(left - right)/(left - 2.0_wp*middle + right)* &
                        (states%angle(i + 1) - states%angle(i))
      contact%lost_speed = (middle - 0.125_wp*(left - right)**2/(left - 2.0_wp*middle + right))/per_minute

   contains

      !> What is touched, from the roller's centre or the point of the face.
      pure complex(wp) function place_of(i)
         integer, intent(in) :: i

         place_of = (points%normal(i)*points%machine(i))*cmplx(-roller, points%on_face(i), wp)
      end function place_of

      !> Velocity of what is touched of the follower along the profile against the cam.
      pure real(wp) function slip_of(i)
         integer, intent(in) :: i

         slip_of = real(conjg(points%tangent(i)*points%machine(i))* &
                        (states%c(1, i) + cmplx(0.0_wp, states%turning(1, i), wp)*place_of(i) &
                         - axes%velocity(points%profile(i)*points%machine(i))), wp)
      end function slip_of
   end subroutine find_contact

   !> The least speed above 0 at which a w**2 + b w + c falls through 0; the largest number if it does not.
   pure real(wp) function first_root(a, b, c) result(w)
      real(wp), intent(in) :: a, b, c
      real(wp) :: root

      w = huge(1.0_wp)
      if (c <= 0.0_wp) then
         w = 0.0_wp
         return
      end if
      root = b*b - 4.0_wp*a*c
      if (root < 0.0_wp) return
      if (a < 0.0_wp .or. b < 0.0_wp) w = 2.0_wp*c/(sqrt(root) - b)
   end function first_root

   !> Greatest pressure of two cylinders along a line, Pa; 0 without a force, or where the cylinders fit.
   pure real(wp) function line_stress(load, curvature, modulus, poisson) result(stress)
      real(wp), intent(in) :: load               !! N/m
      real(wp), intent(in) :: curvature          !! sum of both, 1/m
      real(wp), intent(in) :: modulus(2), poisson(2) !! Pa; of cam and follower

      stress = sqrt(max(load*curvature, 0.0_wp)/(pi*sum((1.0_wp - poisson**2)/modulus)))
   end function line_stress
end module psalm_cam_contact
