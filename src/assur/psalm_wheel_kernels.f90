!> Kernels of wheels: directions that turn `ratio` times as far as another one, at the positions of a block.
!>
!> Whole ratios are products of unit vectors. For others the positions are taken in pieces: in the middle of each the angle is
!> known, and from there a direction that has turned by an angle whose sine is s goes on by
!>   sin(r asin s) = r s + r (1 - r**2)/3! s**3 + r (1 - r**2)(9 - r**2)/5! s**5 + ...
!>   cos(r asin s) = 1 - r**2/2! s**2 - r**2 (4 - r**2)/4! s**4 - ...
!> without an angle. Source of the series: Abramowitz and Stegun (1964), 15.1.15 and 15.1.17. All arrays have the shape (n) if not
!> said otherwise.
module psalm_wheel_kernels
   use psalm_kinds, only: wp, i8
   implicit none (type, external)
   private
   public :: ratio_series_t, make_series, turn_from_middle, turn_by_power, fill_pieces
   public :: piece, reach_short, reach_long, highest_at_once

   integer, parameter :: piece = 16              !! positions that go on from the angle of one in the middle
   integer, parameter :: reach_short = 1, reach_long = 2 !! which series
   integer, parameter :: terms(2) = [4, 9]       !! of each series, the first included
   integer, parameter :: looked_at = 3           !! further terms, after the first one left out, that must not count
   integer, parameter :: highest_at_once = 3     !! power that one loop forms
   real(wp), parameter :: farthest_sine = 0.24_wp !! series are not gone further
   real(wp), parameter :: nothing = epsilon(1.0_wp)/16.0_wp !! what is left out
   real(wp), parameter :: shorter = 0.9375_wp    !! a limit is made so much less until nothing is left out

   !> Series of one ratio.
   type :: ratio_series_t
      real(wp) :: sine(0:terms(2) - 1) = 0.0_wp, cosine(0:terms(2) - 1) = 0.0_wp !! factors of odd, of even powers
      real(wp) :: least_cosine(2) = 1.0_wp       !! of the angle turned: to there the short, the long one is good
      real(wp) :: farthest(2) = 0.0_wp           !! the sine there
   end type ratio_series_t

contains

   !> Factors of the series of a ratio, and how far they may be used.
   pure function make_series(ratio) result(series)
      real(wp), intent(in) :: ratio
      type(ratio_series_t) :: series
      real(wp) :: odd(0:terms(2) + looked_at), even(0:terms(2) + looked_at), sine, left
      integer :: m, reach

      odd(0) = ratio
      even(0) = 1.0_wp
      do m = 0, size(odd) - 2
         odd(m + 1) = odd(m)*(real((2*m + 1)**2, wp) - ratio**2)/real((2*m + 2)*(2*m + 3), wp)
         even(m + 1) = even(m)*(real((2*m)**2, wp) - ratio**2)/real((2*m + 1)*(2*m + 2), wp)
      end do
      series%sine = odd(:terms(2) - 1)
      series%cosine = even(:terms(2) - 1)
      do reach = reach_short, reach_long
         sine = farthest_sine
         do
            left = 0.0_wp
            do m = terms(reach), terms(reach) + looked_at
               left = max(left, abs(odd(m))*sine**(2*m + 1), abs(even(m))*sine**(2*m))
            end do
            if (left <= nothing) exit
            sine = shorter*sine
            if (sine < epsilon(1.0_wp)) exit
         end do
         series%farthest(reach) = sine
         series%least_cosine(reach) = sqrt((1.0_wp - sine)*(1.0_wp + sine))
         if (sine < epsilon(1.0_wp)) series%least_cosine(reach) = 2.0_wp   ! a ratio that no series is for: nothing is near
      end do
   end function make_series

   !> Directions (tx, ty) that turn with (x, y) from the middle of each piece on. `near` is false where one is too far from there,
   !> and the result of no use.
   pure subroutine turn_from_middle(pieces, x, y, series, reach, mx, my, wx, wy, tx, ty, near)
      integer, intent(in) :: pieces
      real(wp), dimension(piece, pieces), intent(in) :: x, y
      type(ratio_series_t), intent(in) :: series
      integer, intent(in) :: reach                 !! the series that is asked for
      real(wp), dimension(pieces), intent(in) :: mx, my !! x, y in the middles
      real(wp), dimension(pieces), intent(in) :: wx, wy !! tx, ty there
      real(wp), dimension(piece, pieces), intent(out) :: tx, ty
      logical, intent(out) :: near
      integer(i8) :: beyond
      real(wp) :: s, c, z, z2, z4, sine, cosine
      integer :: p, i

      beyond = 0
      associate (a => series%sine, b => series%cosine, least => series%least_cosine(reach))
         if (reach == reach_short) then
            do p = 1, pieces
               do i = 1, piece
                  s = y(i, p)*mx(p) - x(i, p)*my(p)
                  c = x(i, p)*mx(p) + y(i, p)*my(p)
                  beyond = beyond + merge(0_i8, 1_i8, c >= least)
                  z = s*s
                  z2 = z*z
                  sine = s*((a(0) + a(1)*z) + (a(2) + a(3)*z)*z2)
                  cosine = (b(0) + b(1)*z) + (b(2) + b(3)*z)*z2
                  tx(i, p) = wx(p)*cosine - wy(p)*sine
                  ty(i, p) = wy(p)*cosine + wx(p)*sine
               end do
            end do
         else
            do p = 1, pieces
               do i = 1, piece
                  s = y(i, p)*mx(p) - x(i, p)*my(p)
                  c = x(i, p)*mx(p) + y(i, p)*my(p)
                  beyond = beyond + merge(0_i8, 1_i8, c >= least)
                  z = s*s
                  z2 = z*z
                  z4 = z2*z2
                  sine = s*(((a(0) + a(1)*z) + (a(2) + a(3)*z)*z2) &
                            + (((a(4) + a(5)*z) + (a(6) + a(7)*z)*z2) + a(8)*z4)*z4)
                  cosine = ((b(0) + b(1)*z) + (b(2) + b(3)*z)*z2) &
                           + (((b(4) + b(5)*z) + (b(6) + b(7)*z)*z2) + b(8)*z4)*z4
                  tx(i, p) = wx(p)*cosine - wy(p)*sine
                  ty(i, p) = wy(p)*cosine + wx(p)*sine
               end do
            end do
         end if
      end associate
      near = beyond == 0
   end subroutine turn_from_middle

   !> Every position of a piece gets its value.
   pure subroutine fill_pieces(pieces, values, row)
      integer, intent(in) :: pieces
      real(wp), intent(in) :: values(pieces)
      real(wp), intent(out) :: row(piece, pieces)
      integer :: p, i

      do p = 1, pieces
         do i = 1, piece
            row(i, p) = values(p)
         end do
      end do
   end subroutine fill_pieces

   !> A direction that turns a whole number of times as far as another one, at most `highest_at_once` times, from where both stand
   !> in the drawing.
   pure subroutine turn_by_power(n, x, y, drawn, power, start, tx, ty)
      integer, intent(in) :: n
      real(wp), intent(in) :: x(n), y(n)
      real(wp), intent(in) :: drawn(2)             !! (x, y) in the drawing
      integer, intent(in) :: power
      real(wp), intent(in) :: start(2)             !! (tx, ty) in the drawing
      real(wp), intent(out) :: tx(n), ty(n)
      real(wp) :: ux, uy, a, b, t, sense
      logical :: odd, squared
      integer :: i

      odd = modulo(power, 2) == 1
      squared = abs(power) > 1
      sense = real(sign(1, power), wp)
      do i = 1, n
         ux = x(i)*drawn(1) + y(i)*drawn(2)
         uy = sense*(y(i)*drawn(1) - x(i)*drawn(2))
         a = start(1)
         b = start(2)
         ! the same in every passage: the compiler takes it out of the loop
         if (odd) then
            t = a*ux - b*uy
            b = b*ux + a*uy
            a = t
         end if
         if (squared) then
            t = (ux - uy)*(ux + uy)
            uy = 2.0_wp*ux*uy
            ux = t
            t = a*ux - b*uy
            b = b*ux + a*uy
            a = t
         end if
         ! what is left of the length of a direction grows with the power
         t = 1.5_wp - 0.5_wp*(a**2 + b**2)
         tx(i) = a*t
         ty(i) = b*t
      end do
   end subroutine turn_by_power
end module psalm_wheel_kernels
