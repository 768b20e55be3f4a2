!> How far tolerances let an output go: the worst case, the root-sum-square, or the width that holds a share of the linkages.
!>
!> Each is a norm of the tolerances: it grows in proportion with them, and is convex. Of the width that is so because the deviations
!> have symmetric and log-concave densities. So the plane that touches it at any tolerances lies below it everywhere: no tolerances
!> within a band go beyond the linear band of that plane. Source: Lagoa, Li and Sznaier (2005), Probabilistically constrained linear
!> programs and risk-adjusted controller design, SIAM Journal on Optimization 15.
module psalm_allocation_rule
   use psalm_allocation_group, only: rule_square, rule_worst, rule_yield
   use psalm_kinds, only: wp
   use psalm_sum_law, only: half_width, law_normal, share_within
   implicit none (type, external)
   private
   public :: allocated_band_t, band_rule_t

   !> A band at a position.
   type :: allocated_band_t
      integer :: position = 0, number = 0             !! number: of the outputs
      real(wp) :: width = 0.0_wp                      !! to either side
      real(wp) :: used = 0.0_wp                       !! deviation by the rule
      real(wp) :: price = 0.0_wp                      !! cost saved by a wider band, to first order, for its whole width
      real(wp) :: share = 0.0_wp                      !! of the linkages within it, by the law of the deviations
   end type allocated_band_t

   !> The rule, and what the dimensions have in common.
   type :: band_rule_t
      integer :: rule = rule_worst                    !! one of `rule_...`
      integer :: law = 1                              !! one of `law_...`
      real(wp) :: yield = 0.0_wp                      !! share of the linkages
      integer, allocatable :: group(:)                !! shape (dimensions): correlated group with its sign; 0: in none
      real(wp), allocatable :: correlation(:)         !! by group
   contains
      procedure :: reach
      procedure :: share
      procedure :: is_separable
      procedure :: is_grouped
      procedure :: order
      procedure :: weights
      procedure :: parts
   end type band_rule_t

contains

   !> How far tolerances let the output go, and its change with each.
   pure subroutine reach(self, change, tolerance, far, slope)
      class(band_rule_t), intent(in) :: self
      real(wp), intent(in) :: change(:)               !! of the output, by a tolerance of 1
      real(wp), intent(in) :: tolerance(:)            !! the same shape
      real(wp), intent(out) :: far
      real(wp), intent(out) :: slope(:)               !! the same shape
      real(wp) :: effect(size(change))

      if (self%is_grouped()) then
         call reach_of_groups(self, change, tolerance, far, slope)
         return
      end if
      effect = abs(change)*tolerance
      select case (self%rule)
      case (rule_worst)
         far = sum(effect)
         slope = abs(change)
      case (rule_square)
         far = sqrt(sum(effect**2))
         slope = 0.0_wp
         if (far > 0.0_wp) slope = effect*abs(change)/far
      case default
         call half_width(self%law, effect, self%yield, far, slope)
         slope = slope*abs(change)
      end select
   end subroutine reach

   !> The same with correlated groups: a deviation is a part of its own and a part that its group has in common.
   pure subroutine reach_of_groups(self, change, tolerance, far, slope)
      class(band_rule_t), intent(in) :: self
      real(wp), intent(in) :: change(:), tolerance(:)
      real(wp), intent(out) :: far, slope(:)
      real(wp) :: own(size(change)), shared(size(change))
      real(wp), dimension(size(change) + size(self%correlation)) :: effect, of_effect
      integer :: n, i

      n = size(change)
      call self%parts(self%rule == rule_square .or. (self%rule == rule_yield .and. self%law == law_normal), own, shared)
      effect = effects_of(self, change*tolerance, own, shared)
      select case (self%rule)
      case (rule_worst)
         far = sum(abs(effect))
         of_effect = 1.0_wp
      case (rule_square)
         far = sqrt(sum(effect**2))
         of_effect = 0.0_wp
         if (far > 0.0_wp) of_effect = abs(effect)/far
      case default
         call half_width(self%law, effect, self%yield, far, of_effect)
      end select
      do i = 1, n
         slope(i) = of_effect(i)*own(i)*abs(change(i))
         associate (g => abs(self%group(i)))
            if (g > 0) slope(i) = slope(i) + sign(of_effect(n + g), effect(n + g))*shared(i)*change(i)
         end associate
      end do
   end subroutine reach_of_groups

   !> Effects of the independent deviations: each dimension's own, then each group's.
   pure function effects_of(self, effect, own, shared) result(effects)
      class(band_rule_t), intent(in) :: self
      real(wp), intent(in) :: effect(:)               !! of the whole deviations, with signs
      real(wp), intent(in) :: own(:), shared(:)       !! the same shape: see `parts`
      real(wp) :: effects(size(effect) + size(self%correlation))
      integer :: i

      effects = 0.0_wp
      effects(:size(effect)) = own*effect
      do i = 1, size(effect)
         associate (at => size(effect) + abs(self%group(i)))
            if (self%group(i) /= 0) effects(at) = effects(at) + shared(i)*effect(i)
         end associate
      end do
   end function effects_of

   !> Parts of the tolerances within which dimensions deviate by themselves and with their group, there with its sign. Squares that
   !> add up keep a variance, as normal deviations do; parts that add up keep the tolerance as the largest deviation.
   pure subroutine parts(self, squares, own, shared)
      class(band_rule_t), intent(in) :: self
      logical, intent(in) :: squares                  !! the squares of both parts add up to 1, else the parts
      real(wp), intent(out) :: own(:), shared(:)      !! shape (dimensions)
      real(wp) :: both
      integer :: i

      own = 1.0_wp
      shared = 0.0_wp
      do i = 1, size(own)
         if (self%group(i) == 0) cycle
         associate (correlation => self%correlation(abs(self%group(i))))
            both = 1.0_wp
            if (.not. squares) both = sqrt(correlation) + sqrt(1.0_wp - correlation)
            own(i) = sqrt(1.0_wp - correlation)/both
            shared(i) = real(sign(1, self%group(i)), wp)*sqrt(correlation)/both
         end associate
      end do
   end subroutine parts

   !> The share of the linkages within a band, by the law of the deviations.
   pure real(wp) function share(self, change, tolerance, width)
      class(band_rule_t), intent(in) :: self
      real(wp), intent(in) :: change(:), tolerance(:) !! see `reach`
      real(wp), intent(in) :: width                   !! of the band, to either side
      real(wp) :: own(size(change)), shared(size(change))

      if (self%is_grouped()) then
         call self%parts(self%law == law_normal, own, shared)
         share = share_within(self%law, effects_of(self, change*tolerance, own, shared), width)
      else
         share = share_within(self%law, change*tolerance, width)
      end if
   end function share

   !> True if there are correlated groups.
   pure logical function is_grouped(self)
      class(band_rule_t), intent(in) :: self

      is_grouped = .false.
      if (allocated(self%group)) is_grouped = any(self%group /= 0)
   end function is_grouped

   !> True if the power `order` of how far they go is a sum of terms of one tolerance each.
   pure logical function is_separable(self)
      class(band_rule_t), intent(in) :: self

      is_separable = (self%rule /= rule_yield .or. self%law == law_normal) .and. .not. self%is_grouped()
   end function is_separable

   !> That power.
   pure integer function order(self)
      class(band_rule_t), intent(in) :: self

      order = 2
      if (self%rule == rule_worst) order = 1
   end function order

   !> What these terms are of tolerances of 1.
   pure function weights(self, change)
      class(band_rule_t), intent(in) :: self
      real(wp), intent(in) :: change(:)
      real(wp) :: weights(size(change)), widest, slope(1)

      weights = abs(change)**self%order()
      if (self%rule /= rule_yield) return
      call half_width(self%law, [1.0_wp], self%yield, widest, slope)
      weights = widest**2*weights
   end function weights
end module psalm_allocation_rule
