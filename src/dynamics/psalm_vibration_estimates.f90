!> Does a link's bending matter? Estimates before any equation is solved: Haines, chapter 2. SI units.
module psalm_vibration_estimates
   use psalm_kinds, only: wp, pi
   implicit none (type, external)
   private
   public :: euler_load, frequency_ratio, static_deflection, magnification, dynamic_error, impulse_magnifier, step_error, &
             straightening, foreshortening_sine, foreshortening_uniform, frequency_fall, strength_ratio, overhung_ratio, &
             tie_rod_ratio, impact_time, impact_speed, impact_level, post_support, post_support_of_slenderness

   real(wp), parameter :: foreshortening_sine = pi**2/4.0_wp                !! of y_mid**2/L, a half sine
   real(wp), parameter :: foreshortening_uniform = 2176.0_wp/875.0_wp       !! the same under a uniform load

contains

   !> Euler's load of a pinned link, N.
   elemental real(wp) function euler_load(stiffness, length)
      real(wp), intent(in) :: stiffness !! E I, N m2
      real(wp), intent(in) :: length    !! m

      euler_load = pi**2*stiffness/length**2
   end function euler_load

   !> First frequency over the speed of the crank.
   elemental real(wp) function frequency_ratio(stiffness, length, mass, speed)
      real(wp), intent(in) :: stiffness, length !! E I, N m2; m
      real(wp), intent(in) :: mass              !! kg
      real(wp), intent(in) :: speed             !! rad/s

      frequency_ratio = pi**2*sqrt(stiffness/(mass*length**3))/speed
   end function frequency_ratio

   !> Quasi-static deflection of mode k, m: -4 A/(pi k**5 w**2 W**2 H), H = 1 - load/(k**2 Euler's load).
   elemental real(wp) function static_deflection(k, acceleration, speed, ratio, relief)
      integer, intent(in) :: k
      real(wp), intent(in) :: acceleration !! transverse, of the middle (k odd) or of the ends about it (k even), m/s2
      real(wp), intent(in) :: speed        !! rad/s
      real(wp), intent(in) :: ratio        !! W
      real(wp), intent(in) :: relief       !! H, not 0

      static_deflection = -4.0_wp*acceleration/(pi*real(k, wp)**5*speed**2*ratio**2*relief)
   end function static_deflection

   !> Dynamic magnifier 1/sqrt((1 - r**2)**2 + (2 c r)**2).
   elemental real(wp) function magnification(r, damping)
      real(wp), intent(in) :: r       !! frequency ratio j/(W k**2)
      real(wp), intent(in) :: damping !! c

      magnification = 1.0_wp/hypot((1.0_wp - r)*(1.0_wp + r), 2.0_wp*damping*r)
   end function magnification

   !> Dynamic error of harmonic j of mode k against the quasi-static deflection; `whole` if the damper acts on the whole motion.
   elemental real(wp) function dynamic_error(j, k, ratio, damping, whole)
      integer, intent(in) :: j, k
      real(wp), intent(in) :: ratio, damping
      logical, intent(in) :: whole
      real(wp) :: r

      r = real(j, wp)/(ratio*real(k, wp)**2)
      dynamic_error = r*merge(hypot(r, 2.0_wp*damping), r, whole)*magnification(r, damping)
   end function dynamic_error

   !> What a blow that comes once a cycle leaves of the blows before: D_I = a/(1 - exp(-a)), a = 2 pi c W; 1 without damping.
   elemental real(wp) function impulse_magnifier(damping, ratio)
      real(wp), intent(in) :: damping, ratio
      real(wp) :: a

      a = 2.0_wp*pi*damping*ratio
      if (a < 1.0e-4_wp) then
         impulse_magnifier = 1.0_wp + a*(0.5_wp + a/12.0_wp) ! the next term is a**4/720
      else
         impulse_magnifier = a/(1.0_wp - exp(-a))
      end if
   end function impulse_magnifier

   !> Error from a step of the end load once a cycle, with harmonic j of amplitude `share` in H:
   !> (pi j share/least)/(1 - exp(-2 pi W c)).
   elemental real(wp) function step_error(j, share, least, ratio, damping)
      integer, intent(in) :: j
      real(wp), intent(in) :: share, least !! amplitude in H, least H
      real(wp), intent(in) :: ratio, damping !! W; c, positive

      step_error = pi*real(j, wp)*share/least/(1.0_wp - exp(-2.0_wp*pi*ratio*damping))
   end function step_error

   !> Part by which turning straightens a bowed link: (11 pi**4/1920) (turning/(w W))**2.
   elemental real(wp) function straightening(turning, speed, ratio)
      real(wp), intent(in) :: turning, speed !! rad/s, of the link and of the crank
      real(wp), intent(in) :: ratio          !! W

      straightening = 11.0_wp*pi**4/1920.0_wp*(turning/(speed*ratio))**2
   end function straightening

   !> Relative fall of the first frequency by shear and rotary inertia, pi**2 (1 + E/(kappa G))/(2 s**2).
   elemental real(wp) function frequency_fall(slenderness, shear_ratio)
      real(wp), intent(in) :: slenderness !! length/radius of gyration
      real(wp), intent(in) :: shear_ratio !! E/(kappa G)

      frequency_fall = pi**2*(1.0_wp + shear_ratio)/(2.0_wp*slenderness**2)
   end function frequency_fall

   !> Least W of a link that is as slender as its strength allows.
   elemental real(wp) function strength_ratio(half_depth, gyration, modulus, density, acceleration, speed, strain)
      real(wp), intent(in) :: half_depth, gyration !! m
      real(wp), intent(in) :: modulus, density     !! Pa, kg/m3
      real(wp), intent(in) :: acceleration         !! peak/speed**2, m
      real(wp), intent(in) :: speed                !! rad/s
      real(wp), intent(in) :: strain               !! limit

      strength_ratio = pi**2/8.0_wp*half_depth/gyration*sqrt(density/modulus)*acceleration*speed/strain
   end function strength_ratio

   !> The same of an arm that carries an overhung mass.
   elemental real(wp) function overhung_ratio(mass, offset, gyration, section, modulus, strain, acceleration, speed, length)
      real(wp), intent(in) :: mass, offset, gyration !! kg; of the mass: offset and radius of gyration, m
      real(wp), intent(in) :: section                !! I/half depth**4
      real(wp), intent(in) :: modulus, strain        !! Pa, limit
      real(wp), intent(in) :: acceleration           !! C1 + B K**2/q: peak/speed**2, m
      real(wp), intent(in) :: speed, length          !! rad/s, m

      overhung_ratio = sqrt(3.0_wp)*mass**(1.0_wp/6.0_wp)*offset**(2.0_wp/3.0_wp)*section**(-1.0_wp/6.0_wp) &
                       *modulus**(-1.0_wp/6.0_wp)*strain**(-2.0_wp/3.0_wp)*acceleration**(2.0_wp/3.0_wp)*speed**(1.0_wp/3.0_wp) &
                       /(sqrt(length)*(offset**2 + gyration**2))
   end function overhung_ratio

   !> The same of a tie rod: sqrt(C/(L strain)).
   elemental real(wp) function tie_rod_ratio(acceleration, length, strain)
      real(wp), intent(in) :: acceleration, length, strain !! peak/speed**2, m; m; limit

      tie_rod_ratio = sqrt(acceleration/(length*strain))
   end function tie_rod_ratio

   !> Impact across a diametral clearance under a relative jerk: duration, s.
   elemental real(wp) function impact_time(clearance, jerk)
      real(wp), intent(in) :: clearance, jerk !! m, m/s3

      impact_time = (6.0_wp*clearance/jerk)**(1.0_wp/3.0_wp)
   end function impact_time

   !> Its speed, m/s: jerk*time**2/2, (9/2)**(1/3) = 1.651.
   elemental real(wp) function impact_speed(clearance, jerk)
      real(wp), intent(in) :: clearance, jerk

      impact_speed = 0.5_wp*jerk*impact_time(clearance, jerk)**2
   end function impact_speed

   !> Flat level of its harmonics at crank speed w: w/pi times the speed.
   elemental real(wp) function impact_level(clearance, jerk, speed)
      real(wp), intent(in) :: clearance, jerk, speed !! m, m/s3, rad/s

      impact_level = speed/pi*impact_speed(clearance, jerk)
   end function impact_level

   !> Link on two posts of its own section and length: slenderness and frequency ratio from the end displacement.
   elemental subroutine post_support(delta, slenderness, ratio)
      real(wp), intent(in) :: delta        !! displacement of the ends over the amplitude, positive
      real(wp), intent(out) :: slenderness !! length/radius of gyration
      real(wp), intent(out) :: ratio       !! frequency over that with rigid ends
      real(wp) :: a, c

      c = 3.0_wp + 24.0_wp*delta/pi + 10.0_wp*delta**2
      a = 2.0_wp*delta*c/(6.0_wp/pi + 5.0_wp*delta) - 4.0_wp*delta**2
      slenderness = pi**2/sqrt(a)
      ratio = sqrt(3.0_wp*(1.0_wp + 4.0_wp*delta**2/a)/c)
   end subroutine post_support

   !> The inverse, from the lowest eigenpair of Ritz's two-by-two problem.
   elemental subroutine post_support_of_slenderness(slenderness, delta, ratio)
      real(wp), intent(in) :: slenderness
      real(wp), intent(out) :: delta, ratio
      real(wp) :: a, b, c, k1, k2, root, value

      ! K v = value M v, M = [[a, b], [b, c]], K = diag(k1, k2)
      a = 0.25_wp
      b = 1.0_wp/pi
      c = 10.0_wp/12.0_wp
      k1 = pi**4/(4.0_wp*slenderness**2)
      k2 = 1.0_wp
      root = sqrt((a*k2 - c*k1)**2 + 4.0_wp*b*b*k1*k2)
      value = 2.0_wp*k1*k2/(a*k2 + c*k1 + root) ! the lower root without cancellation
      ratio = sqrt(value*slenderness**2/pi**4)
      delta = value*b/(k2 - value*c)
   end subroutine post_support_of_slenderness
end module psalm_vibration_estimates
