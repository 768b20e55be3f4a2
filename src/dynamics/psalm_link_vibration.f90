!> Bending vibration of a uniform link with a pin at each end that moves in a linkage: Oldham, chapter 13, equation (13.24).
!>
!> Deflection v = length * sum Q_j sin(j pi x/length); all as functions of the input angle at constant speed, lengths in lengths
!> of the link, times in radians of the input. Mode j obeys Q_j'' + (j**4 W + f_j) Q_j = p_j, W the squared ratio of the link's
!> first frequency to the speed. The modes are not orthogonal under the end load and the link's own acceleration; the thesis
!> drops what couples them, here it can be had.
module psalm_link_vibration
   use psalm_kinds, only: wp, pi
   use psalm_periodic, only: periodic_t
   implicit none (type, external)
   private
   public :: moving_link_t, mode_stiffness, coupling, mode_force, first_frequency, timoshenko_factor

   !> What the linkage does to the link, in one turn of the input at constant speed w.
   type :: moving_link_t
      type(periodic_t) :: tension      !! pull at the finish along the link / (mass length w**2)
      type(periodic_t) :: along        !! acceleration of the start along the link / (length w**2)
      type(periodic_t) :: across       !! and across it
      type(periodic_t) :: turning      !! angular acceleration / w**2
      type(periodic_t) :: turning_squared !! (angular velocity/w)**2
   end type moving_link_t

contains

   !> f_j of mode j: (13.24) divided by w**2.
   pure function mode_stiffness(link, j) result(f)
      type(moving_link_t), intent(in) :: link
      integer, intent(in) :: j !! 1, 2 ...
      type(periodic_t) :: f

      f = coupling(link, j, j)
   end function mode_stiffness

   !> What mode j adds to the equation of mode i besides the link's own stiffness: K_ij, derived by Lagrange's equation with
   !> the axial force T - mu (x0'' (L - x) - th'**2 (L**2 - x**2)/2) along the link.
   pure function coupling(link, i, j) result(k)
      type(moving_link_t), intent(in) :: link
      integer, intent(in) :: i, j
      type(periodic_t) :: k
      real(wp) :: same, both

      same = merge(1.0_wp, 0.0_wp, i == j)
      both = 2.0_wp*real(i*j, wp)*pi**2
      k = link%tension%scaled(0.5_wp*both*same)
      k = k%plus(link%along%scaled(-0.5_wp*both*(first_moment(i - j) + first_moment(i + j))))
      k = k%plus(link%turning_squared%scaled(0.25_wp*both*(second_moment(i - j) + second_moment(i + j)) - same))
   end function coupling

   !> integral (1 - x) cos(k pi x) dx over 0..1
   pure real(wp) function first_moment(k)
      integer, intent(in) :: k

      if (k == 0) then
         first_moment = 0.5_wp
      else
         first_moment = real(1 - sign_of_mode(k), wp)/(real(k, wp)*pi)**2
      end if
   end function first_moment

   !> integral (1 - x**2) cos(k pi x) dx over 0..1
   pure real(wp) function second_moment(k)
      integer, intent(in) :: k

      if (k == 0) then
         second_moment = 2.0_wp/3.0_wp
      else
         second_moment = -2.0_wp*real(sign_of_mode(k), wp)/(real(k, wp)*pi)**2
      end if
   end function second_moment

   !> p_j of mode j, in lengths of the link.
   pure function mode_force(link, j) result(p)
      type(moving_link_t), intent(in) :: link
      integer, intent(in) :: j
      type(periodic_t) :: p
      real(wp) :: weight

      weight = 2.0_wp/(real(j, wp)*pi)
      p = link%across%scaled(-weight*real(1 - sign_of_mode(j), wp))
      p = p%plus(link%turning%scaled(weight*real(sign_of_mode(j), wp)))
   end function mode_force

   pure integer function sign_of_mode(j)
      integer, intent(in) :: j

      sign_of_mode = 1 - 2*modulo(j, 2)
   end function sign_of_mode

   !> First frequency of the link at rest, rad/s: (pi/L)**2 k sqrt(E/rho), a slender (Euler's) beam.
   elemental real(wp) function first_frequency(length, gyration, modulus, density)
      real(wp), intent(in) :: length   !! m
      real(wp), intent(in) :: gyration !! radius of gyration of the section, m
      real(wp), intent(in) :: modulus  !! Young's modulus, Pa
      real(wp), intent(in) :: density  !! kg/m3

      first_frequency = (pi/length)**2*gyration*sqrt(modulus/density)
   end function first_frequency

   !> Squared frequency of mode j of Timoshenko's beam against Euler's: the lower root of Oldham's (13.17) for pinned ends,
   !> z**2 S - z (1 + a (1 + G)) + 1 = 0, where z is the ratio, a = (j pi k/L)**2, G = E/(shear modulus * section factor) and
   !> S = a**2 G.
   elemental real(wp) function timoshenko_factor(j, slenderness, shear_ratio) result(z)
      integer, intent(in) :: j
      real(wp), intent(in) :: slenderness !! length/radius of gyration
      real(wp), intent(in) :: shear_ratio !! G above; 0 without shear
      real(wp) :: a, b, s

      a = (real(j, wp)*pi/slenderness)**2
      b = 1.0_wp + a*(1.0_wp + shear_ratio)
      s = a*a*shear_ratio
      z = 2.0_wp/(b + sqrt(b*b - 4.0_wp*s)) ! the lower root without cancellation
   end function timoshenko_factor
end module psalm_link_vibration
