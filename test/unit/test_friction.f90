!> Friction that grows with itself, in closed form: one joint, two that press each other, and where there is none.
program test_friction
   use check, only: checks_t
   use psalm_friction_forces, only: find_friction
   use psalm_kinds, only: wp
   implicit none (type, external)
   type(checks_t) :: t

   call one_slide()
   call one_pin()
   call two_slides()
   call t%report()

contains

   !> The load n + b f of a slide: f = c |n + b f|.
   subroutine one_slide()
      real(wp) :: force(1)
      logical :: found

      call find_friction(reshape([5.0_wp, 0.0_wp], [2, 1]), reshape([2.0_wp, 0.0_wp], [2, 1, 1]), [.true.], [-0.4_wp], [0.0_wp], &
                         force, found)
      call t%is_true(found .and. abs(force(1) + 2.0_wp/1.8_wp) <= 4.0_wp*epsilon(1.0_wp), 'friction that takes load off')
      ! by turns it would swing farther and farther
      call find_friction(reshape([5.0_wp, 0.0_wp], [2, 1]), reshape([4.0_wp, 0.0_wp], [2, 1, 1]), [.true.], [-0.4_wp], [0.0_wp], &
                         force, found)
      call t%is_true(found .and. abs(force(1) + 2.0_wp/2.6_wp) <= 4.0_wp*epsilon(1.0_wp), 'much of it')
      call find_friction(reshape([5.0_wp, 0.0_wp], [2, 1]), reshape([2.0_wp, 0.0_wp], [2, 1, 1]), [.true.], [0.4_wp], [0.0_wp], &
                         force, found)
      call t%is_true(found .and. abs(force(1) - 10.0_wp) <= 100.0_wp*epsilon(1.0_wp), 'friction that presses, to five times')
      call find_friction(reshape([5.0_wp, 0.0_wp], [2, 1]), reshape([4.0_wp, 0.0_wp], [2, 1, 1]), [.true.], [0.4_wp], [0.0_wp], &
                         force, found)
      call t%is_true(.not. found, 'friction that presses itself fast')
   end subroutine one_slide

   !> A pin with the load (3 + f, 4): f = c sqrt((3 + f)^2 + 16), a quadratic equation.
   subroutine one_pin()
      real(wp), parameter :: c = 0.5_wp
      real(wp) :: force(1), want
      logical :: found

      call find_friction(reshape([3.0_wp, 4.0_wp], [2, 1]), reshape([1.0_wp, 0.0_wp], [2, 1, 1]), [.false.], [c], [0.0_wp], &
                         force, found)
      want = (3.0_wp*c**2 + sqrt(9.0_wp*c**4 + 25.0_wp*c**2*(1.0_wp - c**2)))/(1.0_wp - c**2)
      call t%is_true(found .and. abs(force(1) - want) <= 8.0_wp*epsilon(1.0_wp)*want, 'a pin')
   end subroutine one_pin

   !> Two slides, each with the friction of the other as a part of its load.
   subroutine two_slides()
      real(wp), parameter :: fixed(2, 2) = reshape([2.0_wp, 0.0_wp, 1.0_wp, 0.0_wp], [2, 2]), c(2) = [0.5_wp, -0.3_wp]
      real(wp), parameter :: by(2, 2, 2) = reshape([0.0_wp, 0.0_wp, 3.0_wp, 0.0_wp, 1.5_wp, 0.0_wp, 0.0_wp, 0.0_wp], [2, 2, 2])
      real(wp) :: force(2), want(2)
      logical :: found

      call find_friction(fixed, by, [.true., .true.], c, [0.0_wp, 0.0_wp], force, found)
      ! f1 = c1 (2 + 1.5 f2), f2 = c2 (1 + 3 f1), both loads positive
      want(1) = c(1)*(2.0_wp + 1.5_wp*c(2))/(1.0_wp - 4.5_wp*c(1)*c(2))
      want(2) = c(2)*(1.0_wp + 3.0_wp*want(1))
      call t%is_true(found .and. all(abs(force - want) <= 8.0_wp*epsilon(1.0_wp)), 'two slides')
   end subroutine two_slides
end program test_friction
