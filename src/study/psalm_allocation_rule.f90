!> How far tolerances let an output go: the worst case, the root-sum-square, or the width that holds a share of the linkages.
!>
!> Each is a norm of the tolerances: it grows in proportion with them, and is convex. Of the width that is so because the deviations
!> have symmetric and log-concave densities. So the plane that touches it at any tolerances lies below it everywhere: no tolerances
!> within a band go beyond the linear band of that plane. Source: Lagoa, Li and Sznaier (2005), Probabilistically constrained linear
!> programs and risk-adjusted controller design, SIAM Journal on Optimization 15.
!>
!> A clearance is the radius of a disc in which the pin lies, uniformly; by root-sum-square it counts as the uniform deviation of
!> its variance. Under a load the pin lies on one side, as far as the gap goes, which is anything from 0 to the clearance: its mean,
!> half of it, shifts the output, and what it deviates from there adds to the other deviations. A sum of shift and width is convex,
!> too. It holds at least the share that is asked for. Source: Greenwood and Chase (1987), A new tolerance analysis method for
!> designers and manufacturers, Journal of Engineering for Industry 109.
module psalm_allocation_rule
   use psalm_allocation_group, only: rule_square, rule_worst, rule_yield
   use psalm_kinds, only: wp
   use psalm_sum_law, only: half_width, law_normal, share_within
   implicit none (type, external)
   private
   public :: allocated_band_t, band_rule_t

   real(wp), parameter :: half = 0.5_wp
   !> Half the root of 3: the uniform deviation that has the variance of a disc, by its radius.
   real(wp), parameter :: uniform_of_disc = 0.86602540378443864676372317075293618_wp

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
      logical, allocatable :: disc(:)                 !! shape (dimensions): clearance, its pin anywhere within; not allocated: none
      logical, allocatable :: leaning(:)              !! shape (dimensions): clearance whose pin lies on the side of its load
   contains
      procedure :: reach
      procedure :: share
      procedure :: is_separable
      procedure :: is_grouped
      procedure :: is_leaning
      procedure :: is_round
      procedure :: counted
      procedure, private :: shift
      procedure :: leans
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
      real(wp) :: effect(size(change)), amount(size(change))

      if (self%is_grouped()) then
         call reach_of_groups(self, change, tolerance, far, slope)
         return
      else if (self%is_round()) then
         amount = abs(self%counted(change))
         effect = amount*tolerance
         select case (self%rule)
         case (rule_worst)
            far = sum(effect)
            slope = amount
         case (rule_square)
            far = sqrt(sum(effect**2))
            slope = 0.0_wp
            if (far > 0.0_wp) slope = effect*amount/far
         case default
            call half_width(self%law, effect, self%yield, far, slope, self%disc)
            slope = slope*amount
         end select
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
      real(wp) :: own(size(change)), shared(size(change)), amount(size(change)), shift, side
      real(wp), dimension(size(change) + size(self%correlation)) :: effect, of_effect
      integer :: n, i

      n = size(change)
      amount = self%counted(change)
      call self%parts(self%rule == rule_square .or. (self%rule == rule_yield .and. self%law == law_normal), own, shared)
      effect = effects_of(self, amount*tolerance, own, shared)
      select case (self%rule)
      case (rule_worst)
         far = sum(abs(effect))
         of_effect = 1.0_wp
      case (rule_square)
         far = sqrt(sum(effect**2))
         of_effect = 0.0_wp
         if (far > 0.0_wp) of_effect = abs(effect)/far
      case default
         if (self%is_round()) then
            call half_width(self%law, effect, self%yield, far, of_effect, [self%disc, [(.false., i=1, size(self%correlation))]])
         else
            call half_width(self%law, effect, self%yield, far, of_effect)
         end if
      end select
      shift = self%shift(change, tolerance)
      side = sign(half, shift)
      far = far + abs(shift)
      do i = 1, n
         slope(i) = of_effect(i)*own(i)*abs(amount(i))
         if (self%leans(i)) slope(i) = slope(i) + side*change(i)
         associate (g => abs(self%group(i)))
            if (g > 0) slope(i) = slope(i) + sign(of_effect(n + g), effect(n + g))*shared(i)*amount(i)
         end associate
      end do
   end subroutine reach_of_groups

   !> Change of the output by a tolerance of 1 as the rule counts it: of a clearance with a load what it deviates from its mean,
   !> half of it; of one without, by root-sum-square, that of the uniform deviation of its variance.
   pure function counted(self, change)
      class(band_rule_t), intent(in) :: self
      real(wp), intent(in) :: change(:)               !! shape (dimensions)
      real(wp) :: counted(size(change))

      counted = change
      if (allocated(self%disc) .and. self%rule == rule_square) then
         where (self%disc) counted = uniform_of_disc*change
      end if
      if (allocated(self%leaning)) then
         where (self%leaning) counted = half*change
      end if
   end function counted

   !> Mean of the output's deviation: of clearances with a load.
   pure real(wp) function shift(self, change, tolerance)
      class(band_rule_t), intent(in) :: self
      real(wp), intent(in) :: change(:), tolerance(:) !! shape (dimensions), see `reach`

      shift = 0.0_wp
      if (allocated(self%leaning)) shift = half*sum(change*tolerance, mask=self%leaning)
   end function shift

   !> True for a clearance with a load.
   pure logical function leans(self, i)
      class(band_rule_t), intent(in) :: self
      integer, intent(in) :: i                        !! dimension

      leans = .false.
      if (allocated(self%leaning)) leans = self%leaning(i)
   end function leans

   !> True if there are clearances with a load.
   pure logical function is_leaning(self)
      class(band_rule_t), intent(in) :: self

      is_leaning = .false.
      if (allocated(self%leaning)) is_leaning = any(self%leaning)
   end function is_leaning

   !> True if there are clearances without a load.
   pure logical function is_round(self)
      class(band_rule_t), intent(in) :: self

      is_round = .false.
      if (allocated(self%disc)) is_round = any(self%disc)
   end function is_round

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
      real(wp) :: own(size(change)), shared(size(change)), effect(size(change)), sides(2)
      logical :: round(size(change) + size(self%correlation))
      integer :: k

      if (self%is_leaning() .or. self%is_round()) then
         effect = change
         if (allocated(self%leaning)) effect = merge(half*change, change, self%leaning)
         call self%parts(self%law == law_normal, own, shared)
         round = .false.
         if (allocated(self%disc)) round(:size(change)) = self%disc
         ! the deviations are even about their mean
         sides = width + [1.0_wp, -1.0_wp]*self%shift(change, tolerance)
         do k = 1, merge(2, 1, self%is_leaning())
            sides(k) = sign(share_within(self%law, effects_of(self, effect*tolerance, own, shared), abs(sides(k)), round), sides(k))
         end do
         share = sides(1)
         if (self%is_leaning()) share = max(0.0_wp, half*sum(sides))
      else if (self%is_grouped()) then
         call self%parts(self%law == law_normal, own, shared)
         share = share_within(self%law, effects_of(self, change*tolerance, own, shared), width)
      else
         share = share_within(self%law, change*tolerance, width)
      end if
   end function share

   !> True if there are correlated groups, or clearances with a load: deviations that do not add up by their amounts.
   pure logical function is_grouped(self)
      class(band_rule_t), intent(in) :: self

      is_grouped = self%is_leaning()
      if (allocated(self%group)) is_grouped = is_grouped .or. any(self%group /= 0)
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
      real(wp) :: weights(size(change)), widest, far, slope(1)

      weights = abs(self%counted(change))**self%order()
      if (self%rule /= rule_yield) return
      call half_width(self%law, [1.0_wp], self%yield, widest, slope)
      weights = widest**2*weights
      if (.not. self%is_round()) return
      call half_width(self%law, [1.0_wp], self%yield, far, slope, [.true.])
      where (self%disc) weights = (far/widest)**2*weights
   end function weights
end module psalm_allocation_rule
