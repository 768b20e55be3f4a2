!> Bending vibration of a uniform link with a pin at each end that moves in a linkage: Oldham, chapter 13, equation (13.24).
!>
!> Deflection v = length * sum Q_j sin(j pi x/length); all as functions of the input angle at constant speed, lengths in lengths
!> of the link, times in radians of the input. Mode j obeys Q_j'' + (j**4 W + f_j) Q_j = p_j, W the squared ratio of the link's
!> first frequency to the speed. The modes are not orthogonal under the end load and the link's own acceleration; the thesis
!> drops what couples them, here it can be had. Weight, loads and springs between the pins enter by Lagrange's equation: the work
!> of a force at height a above the line of the pins, on a rigid bracket, is f_n (v - a v'**2/2) - f_t (integral v'**2/2 + a v').
module psalm_link_vibration
   use psalm_kinds, only: wp, pi
   use psalm_periodic, only: periodic_t, periodic_constant
   implicit none (type, external)
   private
   public :: moving_link_t, mode_stiffness, coupling, mode_force, first_frequency, timoshenko_factor

   !> A load, or the end of a spring, on the link between its pins.
   type :: acting_t
      real(wp) :: place = 0.0_wp       !! of its foot on the line of the pins, from the start / length
      real(wp) :: height = 0.0_wp      !! of its point above that line / length
      type(periodic_t) :: along        !! force along the link / (mass length w**2)
      type(periodic_t) :: across       !! and across it
      type(periodic_t) :: moment       !! couple / (mass length**2 w**2)
      type(periodic_t) :: spring(3)    !! stiffness of a spring against its point: along, mixed, across / (mass w**2)
      real(wp) :: torsion = 0.0_wp     !! and against turning / (mass length**2 w**2)
   end type acting_t

   !> What the linkage does to the link, in one turn of the input at constant speed w.
   type :: moving_link_t
      type(periodic_t) :: tension      !! pull at the finish along the link / (mass length w**2)
      type(periodic_t) :: along        !! acceleration of the start less gravity, along the link / (length w**2)
      type(periodic_t) :: across       !! and across it
      type(periodic_t) :: turning      !! angular acceleration / w**2
      type(periodic_t) :: turning_squared !! (angular velocity/w)**2
      type(acting_t), allocatable :: acting(:) !! on the link besides its pins; not allocated: nothing
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
   !> the axial force T - mu (x0'' (L - x) - th'**2 (L**2 - x**2)/2) along the link, and the forces along it from there to the
   !> finish.
   pure function coupling(link, i, j) result(k)
      type(moving_link_t), intent(in) :: link
      integer, intent(in) :: i, j
      type(periodic_t) :: k
      real(wp) :: same, both, slopes
      integer :: n

      same = merge(1.0_wp, 0.0_wp, i == j)
      both = 2.0_wp*real(i*j, wp)*pi**2
      k = link%tension%scaled(0.5_wp*both*same)
      k = k%plus(link%along%scaled(-0.5_wp*both*(first_moment(i - j) + first_moment(i + j))))
      k = k%plus(link%turning_squared%scaled(0.25_wp*both*(second_moment(i - j) + second_moment(i + j)) - same))
      if (.not. allocated(link%acting)) return
      do n = 1, size(link%acting)
         associate (a => link%acting(n))
            k = k%plus(a%along%scaled(0.5_wp*both*(part_before(a%place, i - j) + part_before(a%place, i + j))))
            slopes = slope(i, a%place)*slope(j, a%place)
            k = k%plus(a%across%scaled(2.0_wp*a%height*slopes))
            k = k%plus(a%spring(1)%scaled(2.0_wp*a%height**2*slopes))
            k = k%plus(a%spring(2)%scaled(-2.0_wp*a%height*(slope(i, a%place)*shape_at(j, a%place) &
                                                            + slope(j, a%place)*shape_at(i, a%place))))
            k = k%plus(a%spring(3)%scaled(2.0_wp*shape_at(i, a%place)*shape_at(j, a%place)))
            k = k%plus(periodic_constant(2.0_wp*a%torsion*slopes))
         end associate
      end do
   end function coupling

   !> sin(j pi x) and its derivative by x
   pure real(wp) function shape_at(j, x)
      integer, intent(in) :: j
      real(wp), intent(in) :: x

      shape_at = sin(real(j, wp)*pi*x)
   end function shape_at

   pure real(wp) function slope(j, x)
      integer, intent(in) :: j
      real(wp), intent(in) :: x

      slope = real(j, wp)*pi*cos(real(j, wp)*pi*x)
   end function slope

   !> integral cos(k pi x) dx over 0..to
   pure real(wp) function part_before(to, k)
      real(wp), intent(in) :: to
      integer, intent(in) :: k

      part_before = to
      if (k /= 0) part_before = sin(real(k, wp)*pi*to)/(real(k, wp)*pi)
   end function part_before

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
      integer :: n

      weight = 2.0_wp/(real(j, wp)*pi)
      p = link%across%scaled(-weight*real(1 - sign_of_mode(j), wp))
      p = p%plus(link%turning%scaled(weight*real(sign_of_mode(j), wp)))
      if (.not. allocated(link%acting)) return
      do n = 1, size(link%acting)
         associate (a => link%acting(n))
            p = p%plus(a%across%scaled(2.0_wp*shape_at(j, a%place)))
            p = p%plus(a%moment%scaled(2.0_wp*slope(j, a%place)))
            p = p%plus(a%along%scaled(-2.0_wp*a%height*slope(j, a%place)))
         end associate
      end do
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
