!> Which member is to be adjustable: what setting a single dimension after assembly leaves of the deviations of all others.
!>
!> Every other dimension deviates within its tolerance; the adjustable one is set so that the squares of the output's deviations
!> over the positions become least. Linear, like the bands of `psalm_tolerance`. Source: Oldham (1977), section 1.2, assembly with
!> a compensating member or an adjustable link.
module psalm_adjustment
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: adjustment_t, find_adjustments

   !> One dimension as the adjustable one.
   type :: adjustment_t
      integer :: variable = 0            !! of the dimensions with a tolerance
      real(wp) :: travel = 0.0_wp        !! setting needed to either side: root-sum-square
      real(wp) :: most_travel = 0.0_wp   !! worst case
      real(wp) :: left = 0.0_wp          !! largest deviation left: root-sum-square, of all components together
      integer :: at = 0                  !! the position of it
      real(wp) :: most_left = 0.0_wp     !! the same in the worst case
   end type adjustment_t

contains

   !> All dimensions as the adjustable one, those that leave least first. Those without an effect are left out.
   pure function find_adjustments(effect, tolerance) result(list)
      real(wp), intent(in) :: effect(:, :, :)  !! shape (positions, dimensions, components): change of the output with each
      real(wp), intent(in) :: tolerance(:)     !! shape (dimensions): above 0
      type(adjustment_t), allocatable :: list(:)
      type(adjustment_t) :: one
      integer :: v, k, n

      allocate (list(size(tolerance)))
      n = 0
      do v = 1, size(tolerance)
         if (sum(effect(:, v, :)**2) <= 0.0_wp) cycle
         one = adjustment_of(effect, tolerance, v)
         ! by insertion: there are few
         k = n
         do while (k >= 1)
            if (list(k)%left <= one%left) exit
            list(k + 1) = list(k)
            k = k - 1
         end do
         list(k + 1) = one
         n = n + 1
      end do
      list = list(:n)
   end function find_adjustments

   pure type(adjustment_t) function adjustment_of(effect, tolerance, v) result(one)
      real(wp), intent(in) :: effect(:, :, :), tolerance(:)
      integer, intent(in) :: v                 !! the adjustable dimension
      real(wp) :: unit(size(effect, 1), size(effect, 3)), rest(size(effect, 1), size(effect, 3))
      real(wp) :: squares(size(effect, 1)), worst(size(effect, 1), size(effect, 3)), norm, setting
      integer :: i

      unit = effect(:, v, :)/tolerance(v)
      norm = sum(unit**2)
      squares = 0.0_wp
      worst = 0.0_wp
      one%variable = v
      one%travel = tolerance(v)**2
      one%most_travel = tolerance(v)           ! its own deviation is set right
      do i = 1, size(tolerance)
         if (i == v) cycle
         setting = sum(unit*effect(:, i, :))/norm
         rest = effect(:, i, :) - setting*unit
         squares = squares + sum(rest**2, dim=2)
         worst = worst + abs(rest)
         one%travel = one%travel + setting**2
         one%most_travel = one%most_travel + abs(setting)
      end do
      one%travel = sqrt(one%travel)
      one%at = maxloc(squares, dim=1)
      one%left = sqrt(squares(one%at))
      one%most_left = sqrt(maxval(sum(worst**2, dim=2)))
   end function adjustment_of
end module psalm_adjustment
