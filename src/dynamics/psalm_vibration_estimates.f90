!> Does a link's bending matter? Estimates before any equation is solved: Haines, chapter 2. SI units.
module psalm_vibration_estimates
   use psalm_kinds, only: wp, pi
   implicit none (type, external)
   private
   public :: euler_load, frequency_ratio, magnification, dynamic_error, impulse_magnifier, straightening, foreshortening_sine, &
             frequency_fall, strength_ratio, tie_rod_ratio, post_support_of_slenderness, repeated_magnifier, step_error, &
             impact_time, impact_speed, impact_level, impact_error

   real(wp), parameter :: third = 1.0_wp/3.0_wp
   real(wp), parameter :: foreshortening_sine = pi**2/4.0_wp                !! of y_mid**2/L, a half sine

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

   !> What a step that comes once a cycle leaves of the steps before: the free vibration z exp((i - c) W x), which a step d joins
   !> each turn, has the amplitude d/|1 - exp(-2 pi W (c - i))|. At resonance, of a whole W, this is
   !> Haines's 1/(1 - exp(-2 pi c W)).
   elemental real(wp) function repeated_magnifier(damping, ratio)
      real(wp), intent(in) :: damping, ratio !! c, W
      real(wp) :: left

      left = exp(-2.0_wp*pi*damping*ratio)
      repeated_magnifier = 1.0_wp/sqrt((1.0_wp - left)**2 + 4.0_wp*left*sin(pi*ratio)**2)
   end function repeated_magnifier

   !> Dynamic error of mode 1, over its quasi-static deflection, by the harmonic of the end load that is nearest resonance, as if
   !> it were that of a step once a cycle: (10E), a step dP/P_c has the harmonics dP/(pi j P_c).
   elemental real(wp) function step_error(j, harmonic, least, damping, ratio)
      integer, intent(in) :: j               !! number of the harmonic
      real(wp), intent(in) :: harmonic       !! its amplitude over Euler's load
      real(wp), intent(in) :: least          !! least 1 + pull/Euler's load in the turn, above 0
      real(wp), intent(in) :: damping, ratio !! c, W

      step_error = pi*real(j, wp)*harmonic/least*repeated_magnifier(damping, ratio)
   end function step_error

   !> Time that a pin takes across its clearance with an acceleration that grows evenly from 0, s: jerk*time**3/6 = clearance.
   elemental real(wp) function impact_time(clearance, jerk)
      real(wp), intent(in) :: clearance !! diametral, m
      real(wp), intent(in) :: jerk      !! m/s3

      impact_time = (6.0_wp*clearance/jerk)**third
   end function impact_time

   !> Speed at which it meets the other side, m/s: jerk*time**2/2, 1.651 clearance**(2/3) jerk**(1/3).
   elemental real(wp) function impact_speed(clearance, jerk)
      real(wp), intent(in) :: clearance, jerk !! as above

      impact_speed = 0.5_wp*jerk*impact_time(clearance, jerk)**2
   end function impact_speed

   !> Amplitude of every harmonic of the acceleration by a step of the speed once a turn, m/s2: an impulse of it each 2 pi/w.
   elemental real(wp) function impact_level(step, speed)
      real(wp), intent(in) :: step           !! m/s
      real(wp), intent(in) :: speed          !! w, rad/s

      impact_level = step*speed/pi
   end function impact_level

   !> Amplitude of mode 1 by that step of the speed, once a turn, m: (25b) with the harmonic nearest resonance, and (26c).
   elemental real(wp) function impact_error(step, speed, damping, ratio)
      real(wp), intent(in) :: step           !! m/s
      real(wp), intent(in) :: speed          !! w, rad/s
      real(wp), intent(in) :: damping, ratio !! c, W

      impact_error = 4.0_wp/pi*step/(speed*ratio)*repeated_magnifier(damping, ratio)
   end function impact_error

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

   !> The same of a tie rod: sqrt(C/(L strain)).
   elemental real(wp) function tie_rod_ratio(acceleration, length, strain)
      real(wp), intent(in) :: acceleration, length, strain !! peak/speed**2, m; m; limit

      tie_rod_ratio = sqrt(acceleration/(length*strain))
   end function tie_rod_ratio

   !> Link on two posts of its own section and length: displacement of the ends over the amplitude, and frequency over that with
   !> rigid ends, from the lowest eigenpair of Ritz's two-by-two problem.
   elemental subroutine post_support_of_slenderness(slenderness, delta, ratio)
      real(wp), intent(in) :: slenderness  !! length/radius of gyration
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
