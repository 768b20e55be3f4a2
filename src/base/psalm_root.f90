!> A root of a function between two places at which its signs differ: the caller gives the values that are asked for.
!>
!> Bisection and inverse quadratic interpolation. Source: Chandrupatla (1997), A new hybrid quadratic/bisection algorithm for
!> finding the zero of a nonlinear function without using derivatives, Advances in Engineering Software 28, 145-149.
module psalm_root
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: root_search_t, begin_search

   !> The root lies between a and b; of the places before c was the last that is neither.
   type :: root_search_t
      real(wp) :: a = 0.0_wp, b = 0.0_wp, c = 0.0_wp
      real(wp) :: fa = 0.0_wp, fb = 0.0_wp, fc = 0.0_wp
      real(wp) :: part = 0.5_wp              !! of the way from a to b: the next place
      real(wp) :: tolerance = 0.0_wp         !! of the root
   contains
      procedure :: root
      procedure :: done
      procedure :: next
      procedure :: put
   end type root_search_t

contains

   !> Begin with two places and their values, whose signs differ.
   pure function begin_search(first, value_first, second, value_second, tolerance) result(search)
      real(wp), intent(in) :: first, value_first, second, value_second, tolerance
      type(root_search_t) :: search

      search = root_search_t(a=second, b=first, c=second, fa=value_second, fb=value_first, fc=value_second, tolerance=tolerance)
   end function begin_search

   !> The best place so far.
   pure real(wp) function root(self)
      class(root_search_t), intent(in) :: self

      root = merge(self%b, self%a, abs(self%fb) < abs(self%fa))
   end function root

   !> True where it is as near as is wanted.
   pure logical function done(self)
      class(root_search_t), intent(in) :: self

      done = least_part(self) > 0.5_wp .or. min(abs(self%fa), abs(self%fb)) <= 0.0_wp
   end function done

   !> The part of the way that is not worth to go.
   pure real(wp) function least_part(self)
      class(root_search_t), intent(in) :: self

      least_part = (2.0_wp*epsilon(1.0_wp)*abs(self%root()) + self%tolerance)/max(abs(self%b - self%a), tiny(1.0_wp))
   end function least_part

   !> The place whose value is wanted next.
   pure real(wp) function next(self)
      class(root_search_t), intent(in) :: self

      associate (least => least_part(self))
         next = self%a + max(least, min(1.0_wp - least, self%part))*(self%b - self%a)
      end associate
   end function next

   !> Take the value there.
   pure subroutine put(self, x, fx)
      class(root_search_t), intent(inout) :: self
      real(wp), intent(in) :: x, fx
      real(wp) :: xi, phi

      if (sign(1.0_wp, fx)*sign(1.0_wp, self%fa) > 0.0_wp) then
         self%c = self%a
         self%fc = self%fa
      else
         self%c = self%b
         self%fc = self%fb
         self%b = self%a
         self%fb = self%fa
      end if
      self%a = x
      self%fa = fx
      self%part = 0.5_wp
      associate (a => self%a, b => self%b, c => self%c, fa => self%fa, fb => self%fb, fc => self%fc)
         if (abs(b - c) <= 0.0_wp .or. abs(fb - fc) <= 0.0_wp) return
         xi = (a - b)/(c - b)
         phi = (fa - fb)/(fc - fb)
         if (phi**2 < xi .and. (1.0_wp - phi)**2 < 1.0_wp - xi) &
            self%part = fa/(fb - fa)*(fc/(fb - fc)) + (c - a)/(b - a)*(fa/(fc - fa))*(fb/(fc - fb))
      end associate
   end subroutine put
end module psalm_root
