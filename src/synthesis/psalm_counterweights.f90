!> Counterweights that make a composite of loads least: shaking force and moment, drive torque, joints, added mass, each over its
!> tolerance.
!>
!> What is added to a link is (m, px, py, I) about its anchor, and every load is linear in it. Of a body within a reach R of the
!> anchor these are a convex set - m I >= |p|**2, I <= R**2 m - so that the least sum of squares, or the least of the greatest
!> values, is a convex problem: its global optimum comes with a lower bound that proves it. Of one point I is |p|**2/m, of a disc
!> of thickness t and density rho |p|**2/m + m**2/(2 pi rho t): no convex sets, but those with >= in place of = are, and give a
!> bound. There the search goes by tangents: I is replaced by its tangent at the last centre and radius, which leaves a
!> convex problem for masses, moments and thicknesses, with centres near the last ones; from many starts. Source of the loads
!> and of discs: Haines (about 1982), chapter 8; the convex form is derived in `doc/theory/forces.md`, Counterweights.
module psalm_counterweights
   use psalm_balance_group, only: form_point, form_body, form_disc
   use psalm_conic, only: conic_t, conic_solution_t, solve_conic
   use psalm_force_balance, only: force_balance_t, solve_moments, heaviest
   use psalm_kinds, only: wp, pi
   use psalm_linear, only: product_of, triangle_of, along_columns
   use psalm_linear_loads, only: channel_t, values_of, parameters_of_weight, weight_mass, weight_px, weight_py, weight_inertia
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: weight_region_t, criterion_t, design_t, least_composite, composite_of

   real(wp), parameter :: preference = 1.0e-10_wp  !! of the bare composite that a mass of the linkage counts: of equals the
                                                   !! lightest are found
   real(wp), parameter :: least_move = 1.0e-6_wp   !! part of the reach: the search by tangents ends with such moves of the centres
   real(wp), parameter :: first_move = 1.0e-4_wp, usual_move = 0.1_wp
   real(wp), parameter :: least_gain = 1.0e-12_wp  !! relative gain of a step that is one of the last
   real(wp), parameter :: proven = 1.0e-6_wp       !! relative distance from the lower bound at which a local optimum is global
   real(wp), parameter :: breadth = 1.0e-6_wp      !! part of a limit by which limits are moved apart that leave no region
   real(wp), parameter :: kept = 1.0e-6_wp         !! part of the limit of a load by which it may be passed
   real(wp), parameter :: price = 1.0e3_wp         !! of passing a limit by its whole amount on the way to an optimum, in composites
   integer, parameter :: most_draws = 1000         !! of a centre within its limits; then the nearest one to the anchor is taken
   integer, parameter :: most_steps = 60           !! of the search by tangents from one start
   integer, parameter :: mode_convex = 1, mode_tangent = 2

   !> Region for a weight on a link.
   type :: weight_region_t
      integer :: link = 0
      real(wp) :: reach = 0.0_wp                   !! of its centre from the anchor, m; above 0
      real(wp) :: most = 0.0_wp                    !! kg; 0: no limit
      real(wp) :: radius(2) = 0.0_wp, thickness(2) = 0.0_wp !! of a disc, least and greatest, m
      logical :: boxed = .false.                   !! the centre has limits of its own:
      real(wp) :: axis(2) = [1.0_wp, 0.0_wp]       !! direction of the link's line in the axes of the link
      real(wp) :: low(2) = 0.0_wp, high(2) = 0.0_wp !! along it and across it, m
      real(wp) :: start(3) = 0.0_wp                !! where a search begins, if it is given: centre along and across, radius, m
   end type weight_region_t

   !> Desired values of a load.
   type :: desired_load_t
      real(wp), allocatable :: value(:, :)         !! shape (positions, components), as the load; not allocated: 0
   end type desired_load_t

   !> What is wanted.
   type :: criterion_t
      integer :: form = form_body
      real(wp) :: density = 0.0_wp                 !! of discs, kg/m3
      integer, allocatable :: channels(:)          !! that count
      real(wp), allocatable :: tolerance(:)        !! of these: N, N m
      type(desired_load_t), allocatable :: wanted(:)     !! of these; not allocated: all 0
      integer, allocatable :: capped(:)            !! channels with a greatest amount at every position
      real(wp), allocatable :: cap(:)              !! this: N, N m
      real(wp) :: mass_tolerance = 0.0_wp          !! kg; 0: mass does not count
      logical :: peaks = .false.                   !! the greatest value over its tolerance; else the sum of squares over positions
      logical :: exact = .false.                   !! force balance stays complete
      real(wp) :: budget = -1.0_wp                 !! of added mass, kg; negative: none
      integer, allocatable :: limited(:)           !! channels of which the RMS is limited
      real(wp), allocatable :: limit(:)            !! RMS, components pooled
      integer :: starts = 1, seed = 1
      logical :: begun = .false.                   !! the first start is that of the regions
   end type criterion_t

   !> Weights found.
   type :: design_t
      real(wp), allocatable :: added(:, :)         !! shape (4, links): about the anchors
      real(wp), allocatable :: radius(:), thickness(:) !! of discs, by region, m
      real(wp) :: value = huge(1.0_wp)             !! sum of squares, or the greatest value over its tolerance
      real(wp) :: bound = 0.0_wp                   !! no weights of this form, or mass, have less
      real(wp) :: gap = 0.0_wp, residual = 0.0_wp  !! of the convex problem's optimality conditions
      real(wp) :: total = 0.0_wp                   !! kg
      integer :: starts = 0, ended_here = 0        !! of the search by tangents: made, and those that ended as low
      logical :: convex = .false.                  !! the global optimum of a convex problem, proven by the gap
      logical :: proven = .false.                  !! a global optimum, proven by the bound
      logical :: found = .false.
   end type design_t

contains

   !> The composite of some weights, from the loads themselves.
   pure real(wp) function composite_of(channels, criterion, added) result(value)
      type(channel_t), intent(in) :: channels(:)
      type(criterion_t), intent(in) :: criterion
      real(wp), intent(in) :: added(:, :)          !! shape (4, links)
      real(wp), allocatable :: values(:, :)
      real(wp) :: mass
      integer :: k

      value = 0.0_wp
      mass = sum(added(weight_mass, :))
      do k = 1, size(criterion%channels)
         values = (values_of(channels(criterion%channels(k)), added) - wanted_of(channels, criterion, k))/criterion%tolerance(k)
         if (criterion%peaks) then
            value = max(value, sqrt(maxval(sum(values**2, dim=2))))
         else
            value = value + sum(values**2)
         end if
      end do
      if (.not. criterion%mass_tolerance > 0.0_wp) return
      if (criterion%peaks) then
         value = max(value, mass/criterion%mass_tolerance)
      else
         value = value + real(size(channels(1)%bare, 1), wp)*(mass/criterion%mass_tolerance)**2
      end if
   end function composite_of

   !> What is desired of the load that counts in k-th place. Shape: that of the load.
   pure function wanted_of(channels, criterion, k) result(value)
      type(channel_t), intent(in) :: channels(:)
      type(criterion_t), intent(in) :: criterion
      integer, intent(in) :: k
      real(wp), allocatable :: value(:, :)

      if (allocated(criterion%wanted)) then
         if (allocated(criterion%wanted(k)%value)) value = criterion%wanted(k)%value
      end if
      if (.not. allocated(value)) value = 0.0_wp*channels(criterion%channels(k))%bare
   end function wanted_of

   !> How far some weights pass limits of loads: the greatest part of a limit; 0 or less if all are kept.
   pure real(wp) function excess_of(channels, criterion, added) result(excess)
      type(channel_t), intent(in) :: channels(:)
      type(criterion_t), intent(in) :: criterion
      real(wp), intent(in) :: added(:, :)          !! shape (4, links)
      real(wp), allocatable :: values(:, :)
      integer :: k

      excess = -1.0_wp
      do k = 1, size(criterion%capped)
         values = values_of(channels(criterion%capped(k)), added)/criterion%cap(k)
         excess = max(excess, sqrt(maxval(sum(values**2, dim=2))) - 1.0_wp)
      end do
   end function excess_of

   !> The weights with the least composite. Not found: the limits leave none, as when force balance must stay complete and cannot.
   subroutine least_composite(channels, given, criterion, balance, design)
      type(channel_t), intent(in) :: channels(:)
      type(weight_region_t), intent(in) :: given(:)
      type(criterion_t), intent(in) :: criterion
      type(force_balance_t), intent(in) :: balance
      type(design_t), intent(out) :: design
      type(design_t) :: tried
      type(xoshiro_t) :: random
      type(weight_region_t) :: regions(size(given))
      real(wp) :: centre(2, size(given)), radius(size(given)), bound
      real(wp) :: values(max(criterion%starts, 1))
      logical :: valid
      integer :: start, ended, k

      tried%added = 0.0_wp*channels(1)%slope(1, 1, :, :)
      if (.not. (criterion%exact .or. composite_of(channels, criterion, tried%added) > 0.0_wp .or. &
                 excess_of(channels, criterion, tried%added) > 0.0_wp)) then
         ! there is nothing to be made less
         design%added = tried%added
         allocate (design%radius(size(given)), design%thickness(size(given)), source=0.0_wp)
         design%value = 0.0_wp
         design%convex = .true.
         design%found = .true.
         return
      end if
      regions = given
      do start = 1, size(regions)
         regions(start)%radius = regions(start)%radius*[1.0_wp - breadth, 1.0_wp + breadth]
         regions(start)%thickness = regions(start)%thickness*[1.0_wp - breadth, 1.0_wp + breadth]
         regions(start)%low = regions(start)%low - breadth*regions(start)%reach
         regions(start)%high = regions(start)%high + breadth*regions(start)%reach
      end do
      call solve_step(channels, regions, criterion, balance, mode_convex, 0.0_wp, tried)
      if (.not. tried%found) return
      call solve_step(channels, regions, criterion, balance, mode_convex, preference, design)
      if (.not. design%found) design = tried
      ! the bound is that of the composite alone
      design%bound = tried%bound
      design%gap = max(design%gap, tried%gap)
      design%residual = max(design%residual, tried%residual)
      design%convex = criterion%form == form_body .or. only_force_counts(channels, criterion)
      if (criterion%form == form_body) return
      if (criterion%form == form_point .and. design%convex) then
         ! the moment of inertia is without effect: each may be one point
         where (design%added(weight_mass, :) > 0.0_wp) design%added(weight_inertia, :) = &
            (design%added(weight_px, :)**2 + design%added(weight_py, :)**2)/max(design%added(weight_mass, :), tiny(1.0_wp))
         return
      end if
      design%convex = .false.
      bound = design%bound
      ! the first start is where the convex problem has its centres
      tried = design
      design%value = huge(1.0_wp)
      design%found = .false.
      ended = 0
      call random%seed(criterion%seed, purpose_starts)
      do start = 1, criterion%starts
         if (start == 1 .and. criterion%begun) then
            do k = 1, size(regions)
               centre(:, k) = in_link(regions(k), regions(k)%start(:2))
               radius(k) = min(max(regions(k)%start(3), regions(k)%radius(1)), regions(k)%radius(2))
            end do
         else if (start == 1) then
            call centres_of(tried, regions, criterion, centre, radius)
         else
            call random%use_stream(start)
            call draw_centres(random, regions, centre, radius)
         end if
         call go_by_tangents(channels, regions, criterion, balance, centre, radius, tried, valid)
         if (.not. valid) cycle
         ended = ended + 1
         values(ended) = tried%value
         if (tried%value < design%value) design = tried
         if (design%value - bound <= proven*design%value) exit
      end do
      design%starts = min(start, criterion%starts)
      design%ended_here = count(values(:ended) <= design%value*(1.0_wp + proven))
      design%bound = bound
      design%proven = design%found .and. design%value - bound <= proven*design%value
   end subroutine least_composite

   !> True if no load that counts depends on moments of inertia.
   pure logical function only_force_counts(channels, criterion) result(only)
      type(channel_t), intent(in) :: channels(:)
      type(criterion_t), intent(in) :: criterion
      integer :: k

      only = .true.
      do k = 1, size(criterion%channels)
         only = only .and. all(abs(channels(criterion%channels(k))%slope(:, :, weight_inertia, :)) <= 0.0_wp)
      end do
      do k = 1, size(criterion%limited)
         only = only .and. all(abs(channels(criterion%limited(k))%slope(:, :, weight_inertia, :)) <= 0.0_wp)
      end do
      do k = 1, size(criterion%capped)
         only = only .and. all(abs(channels(criterion%capped(k))%slope(:, :, weight_inertia, :)) <= 0.0_wp)
      end do
   end function only_force_counts

   !> Centres of a design, and radii that its masses have as discs of the greatest thickness.
   pure subroutine centres_of(design, regions, criterion, centre, radius)
      type(design_t), intent(in) :: design
      type(weight_region_t), intent(in) :: regions(:)
      type(criterion_t), intent(in) :: criterion
      real(wp), intent(out) :: centre(:, :), radius(:)
      integer :: k

      radius = 0.0_wp
      do k = 1, size(regions)
         associate (added => design%added(:, regions(k)%link))
            centre(:, k) = 0.0_wp
            if (added(weight_mass) > 0.0_wp) centre(:, k) = added(weight_px:weight_py)/added(weight_mass)
            if (criterion%form /= form_disc) cycle
            radius(k) = sqrt(added(weight_mass)/(pi*criterion%density*regions(k)%thickness(2)))
            radius(k) = min(max(radius(k), regions(k)%radius(1)), regions(k)%radius(2))
         end associate
      end do
   end subroutine centres_of

   !> Centres anywhere within the reach, radii anywhere between their limits.
   subroutine draw_centres(random, regions, centre, radius)
      type(xoshiro_t), intent(inout) :: random
      type(weight_region_t), intent(in) :: regions(:)
      real(wp), intent(out) :: centre(:, :), radius(:)
      real(wp) :: draw, low(2), high(2), at(2)
      integer :: k, c, draws

      do k = 1, size(regions)
         low = -regions(k)%reach
         high = regions(k)%reach
         if (regions(k)%boxed) then
            low = max(low, regions(k)%low)
            high = min(high, regions(k)%high)
         end if
         do draws = 1, most_draws
            do c = 1, 2
               call random%next(draw)
               at(c) = low(c) + (high(c) - low(c))*draw
            end do
            if (norm2(at) <= regions(k)%reach) exit
         end do
         if (draws > most_draws) at = min(max(0.0_wp, low), high)
         centre(:, k) = in_link(regions(k), at)
         call random%next(draw)
         radius(k) = regions(k)%radius(1) + draw*(regions(k)%radius(2) - regions(k)%radius(1))
      end do
   end subroutine draw_centres

   !> A place along and across the line of a link in the axes of the link.
   pure function in_link(region, at) result(place)
      type(weight_region_t), intent(in) :: region
      real(wp), intent(in) :: at(2)
      real(wp) :: place(2)

      place = [region%axis(1)*at(1) - region%axis(2)*at(2), region%axis(2)*at(1) + region%axis(1)*at(2)]
   end function in_link

   !> A local optimum from a start, for points and discs.
   subroutine go_by_tangents(channels, regions, criterion, balance, centre, radius, best, valid)
      type(channel_t), intent(in) :: channels(:)
      type(weight_region_t), intent(in) :: regions(:)
      type(criterion_t), intent(in) :: criterion
      type(force_balance_t), intent(in) :: balance
      real(wp), intent(inout) :: centre(:, :), radius(:) !! shapes (2, regions), (regions)
      type(design_t), intent(out) :: best
      logical, intent(out) :: valid
      type(design_t) :: tried
      real(wp) :: move, gain, merit, least, bare
      integer :: step
      logical :: keeps

      least = huge(1.0_wp)
      bare = composite_of(channels, criterion, 0.0_wp*channels(1)%slope(1, 1, :, :))
      ! first the best masses for these centres: there the tangents are true
      move = first_move
      valid = .false.
      do step = 1, most_steps
         call solve_step(channels, regions, criterion, balance, mode_tangent, preference, tried, centre, radius, move)
         if (tried%found) then
            call realise(regions, criterion, tried)
            tried%value = composite_of(channels, criterion, tried%added)
            ! tangents lie below what they touch: on the way a limit of a load may be passed
            merit = tried%value + price*max(bare, tried%value)*max(0.0_wp, excess_of(channels, criterion, tried%added) - kept)
            keeps = excess_of(channels, criterion, tried%added) <= 2.0_wp*kept
         else
            merit = huge(1.0_wp)
            keeps = .false.
         end if
         if (merit < least .and. (keeps .or. .not. valid)) then
            gain = (least - merit)/max(least, tiny(1.0_wp))
            least = merit
            best = tried
            valid = keeps
            call take_centres(regions, criterion, best, centre, radius)
            if (step > 2 .and. gain <= least_gain) exit
            move = min(1.0_wp, max(2.0_wp*move, usual_move))
         else
            if (step == 1) move = 1.0_wp
            move = 0.25_wp*move
            if (move < least_move) exit
         end if
      end do
   end subroutine go_by_tangents

   !> Centres and radii of what was found; a weight without mass keeps those it had.
   pure subroutine take_centres(regions, criterion, design, centre, radius)
      type(weight_region_t), intent(in) :: regions(:)
      type(criterion_t), intent(in) :: criterion
      type(design_t), intent(in) :: design
      real(wp), intent(inout) :: centre(:, :), radius(:)
      integer :: k

      do k = 1, size(regions)
         associate (added => design%added(:, regions(k)%link))
            if (.not. added(weight_mass) > 0.0_wp) cycle
            centre(:, k) = added(weight_px:weight_py)/added(weight_mass)
            if (criterion%form == form_disc) radius(k) = design%radius(k)
         end associate
      end do
   end subroutine take_centres

   !> The moments of inertia that points and discs of these masses and places really have.
   pure subroutine realise(regions, criterion, design)
      type(weight_region_t), intent(in) :: regions(:)
      type(criterion_t), intent(in) :: criterion
      type(design_t), intent(inout) :: design
      integer :: k

      do k = 1, size(regions)
         associate (added => design%added(:, regions(k)%link))
            added(weight_inertia) = 0.0_wp
            if (.not. added(weight_mass) > 0.0_wp) cycle
            added(weight_inertia) = sum(added(weight_px:weight_py)**2)/added(weight_mass)
            if (criterion%form == form_disc) &
               added(weight_inertia) = added(weight_inertia) + 0.5_wp*added(weight_mass)*design%radius(k)**2
         end associate
      end do
   end subroutine realise

   ! ---- the convex problem ------------------------------------------------------------------------------------------

   !> Solve the convex problem: with a moment of inertia of its own for each weight, or with tangents at centres and radii.
   subroutine solve_step(channels, regions, criterion, balance, mode, lightness, design, centre, radius, move)
      type(channel_t), intent(in) :: channels(:)
      type(weight_region_t), intent(in) :: regions(:)
      type(criterion_t), intent(in) :: criterion
      type(force_balance_t), intent(in) :: balance
      integer, intent(in) :: mode
      real(wp), intent(in) :: lightness            !! what a mass of the linkage counts, in bare composites
      type(design_t), intent(out) :: design
      real(wp), intent(in), optional :: centre(:, :), radius(:) !! of the tangents
      real(wp), intent(in), optional :: move       !! greatest move of a centre, in reaches
      type(conic_t) :: problem
      type(conic_solution_t) :: solution
      real(wp), allocatable :: to_added(:, :), rows(:, :), x(:), origin(:), span(:, :)
      real(wp) :: unit, bare, none(parameters_of_weight, size(channels(1)%slope, 4)), scale
      integer, allocatable :: first(:)
      integer :: each, n, k, row, cone, tau, i, comps, positions
      logical :: disc, valid, counts_mass

      allocate (design%added(parameters_of_weight, size(channels(1)%slope, 4)), source=0.0_wp)
      allocate (design%radius(size(regions)), design%thickness(size(regions)), source=0.0_wp)
      disc = criterion%form == form_disc
      positions = size(channels(1)%bare, 1)
      unit = max(balance%mass, tiny(1.0_wp))
      none = 0.0_wp
      bare = composite_of(channels, criterion, none)
      if (.not. criterion%peaks) bare = sqrt(bare)
      counts_mass = .not. bare > 0.0_wp        ! only the mass of the weights does, if anything
      if (counts_mass) then
         bare = 1.0_wp
         if (criterion%mass_tolerance > 0.0_wp) bare = unit/criterion%mass_tolerance
      end if
      ! unknowns of a weight: m, px, py, then of a body I, of a disc the parts of I or in tangents its thickness
      each = 3
      if (mode == mode_convex) each = merge(5, 4, disc)
      if (mode == mode_tangent .and. disc) each = 4
      first = [(each*(k - 1) + 1, k=1, size(regions))]
      tau = each*size(regions) + 1
      n = tau
      call fill_map()
      call allow_exact(valid)
      if (.not. valid) return
      call count_rows()
      call fill_limits()
      call fill_objective()
      call eliminate()
      call solve_conic(problem, solution)
      design%found = solution%solved
      if (.not. solution%solved) return
      x = origin
      do k = 1, size(solution%x)
         x = x + span(:, k)*solution%x(k)
      end do
      do k = 1, size(regions)
         associate (part => x(first(k):first(k) + each - 1), added => design%added(:, regions(k)%link))
            do i = 1, each
               added = added + to_added(:, first(k) + i - 1)*part(i)
            end do
            added(weight_mass) = max(added(weight_mass), 0.0_wp)
            if (.not. disc) cycle
            design%thickness(k) = regions(k)%thickness(2)
            if (mode == mode_tangent) design%thickness(k) = min(max(part(4)*regions(k)%thickness(2), regions(k)%thickness(1), &
                                                                    tiny(1.0_wp)), regions(k)%thickness(2))
            design%radius(k) = sqrt(added(weight_mass)/(pi*criterion%density*design%thickness(k)))
         end associate
      end do
      design%total = sum(design%added(weight_mass, :))
      design%gap = solution%gap
      design%residual = solution%residual
      design%value = composite_of(channels, criterion, design%added)
      design%bound = max(0.0_wp, solution%bound*bare)
      if (.not. criterion%peaks) design%bound = design%bound**2

   contains

      !> What unknowns add to the links: masses are in masses of the linkage, lengths in reaches, thicknesses in the greatest.
      subroutine fill_map()
         real(wp) :: r2

         allocate (to_added(parameters_of_weight, n), source=0.0_wp)
         do k = 1, size(regions)
            associate (at => first(k), l => regions(k)%reach)
               to_added(weight_mass, at) = unit
               to_added(weight_px, at + 1) = unit*l
               to_added(weight_py, at + 2) = unit*l
               if (mode == mode_convex) then
                  to_added(weight_inertia, at + 3:at + each - 1) = unit*l**2
               else
                  r2 = 0.0_wp
                  if (disc) r2 = radius(k)**2
                  to_added(weight_inertia, at) = unit*(r2 - sum(centre(:, k)**2))
                  to_added(weight_inertia, at + 1) = 2.0_wp*unit*l*centre(1, k)
                  to_added(weight_inertia, at + 2) = 2.0_wp*unit*l*centre(2, k)
                  if (disc) to_added(weight_inertia, at + 3) = -0.5_wp*pi*criterion%density*regions(k)%thickness(2)*r2**2
               end if
            end associate
         end do
      end subroutine fill_map

      !> Complete force balance leaves the moments of an independent choice of links no freedom: x = origin + span*y.
      subroutine allow_exact(valid)
         logical, intent(out) :: valid
         integer, allocatable :: basis(:), free(:)
         complex(wp), allocatable :: right(:, :)
         complex(wp) :: value
         integer :: j, at, column, kept(n), count_kept, place

         allocate (origin(n), source=0.0_wp)
         valid = .true.
         if (.not. criterion%exact) then
            allocate (span(n, n), source=0.0_wp)
            do j = 1, n
               span(j, j) = 1.0_wp
            end do
            return
         end if
         call solve_moments(balance, regions%link, basis, free, right, valid)
         if (.not. valid) return
         count_kept = 0
         do j = 1, n
            place = (j - 1)/each + 1
            if (j < tau .and. (j == first(min(place, size(regions))) + 1 .or. j == first(min(place, size(regions))) + 2)) then
               if (any(basis == regions(place)%link)) cycle
            end if
            count_kept = count_kept + 1
            kept(count_kept) = j
         end do
         allocate (span(n, count_kept), source=0.0_wp)
         do j = 1, count_kept
            span(kept(j), j) = 1.0_wp
         end do
         do k = 1, size(basis)
            at = first(findloc(regions%link, basis(k), dim=1))
            scale = unit*regions((at - 1)/each + 1)%reach
            origin(at + 1:at + 2) = [real(right(k, 1), wp), aimag(right(k, 1))]/scale
            do j = 1, count_kept
               if (kept(j) == tau) cycle
               place = (kept(j) - 1)/each + 1
               column = kept(j) - first(place)
               if (column == 0) then
                  value = right(k, 1 + place)*unit
               else if (column <= 2 .and. all(basis /= regions(place)%link)) then
                  value = right(k, 1 + size(regions) + findloc(free, regions(place)%link, dim=1))*unit*regions(place)%reach
                  if (column == 2) value = value*(0.0_wp, 1.0_wp)
               else
                  cycle
               end if
               span(at + 1:at + 2, j) = [real(value, wp), aimag(value)]/scale
            end do
         end do
      end subroutine allow_exact

      subroutine count_rows()
         integer :: lines
         integer, allocatable :: sizes(:)

         lines = 2*size(regions)                    ! greatest mass, greatest inertia or least mass
         if (disc) lines = lines + 4*size(regions)
         if (criterion%budget >= 0.0_wp) lines = lines + 1
         lines = lines + 1
         lines = lines + 4*count(regions%boxed)
         if (criterion%peaks .and. criterion%mass_tolerance > 0.0_wp) lines = lines + 1
         if (mode == mode_convex) then
            sizes = spread(4, 1, size(regions))
            if (disc) sizes = [([4, 3, 3], i=1, size(regions))]
         else
            sizes = spread(3, 1, 2*size(regions))
         end if
         do i = 1, size(criterion%limited)
            sizes = [sizes, n + 2]
         end do
         do i = 1, size(criterion%capped)
            sizes = [sizes, spread(size(channels(criterion%capped(i))%bare, 2) + 1, 1, positions)]
         end do
         if (criterion%peaks) then
            do i = 1, size(criterion%channels)
               sizes = [sizes, spread(size(channels(criterion%channels(i))%bare, 2) + 1, 1, positions)]
            end do
         else
            sizes = [sizes, n + 2]
         end if
         problem%lines = lines
         problem%cones = sizes
         allocate (problem%q(n), problem%g(lines + sum(sizes), n), problem%h(lines + sum(sizes)), source=0.0_wp)
         problem%q(tau) = 1.0_wp
         do k = 1, size(regions)
            problem%q(first(k)) = lightness
         end do
      end subroutine count_rows

      !> Rows of the limits: s = h - Gx.
      subroutine fill_limits()
         real(wp) :: cap, disc_mass, inner
         integer :: at

         row = 0
         cone = problem%lines
         do k = 1, size(regions)
            associate (region => regions(k), g => problem%g, h => problem%h)
               at = first(k)
               cap = heaviest
               if (region%most > 0.0_wp) cap = region%most/unit
               row = row + 1
               g(row, at) = 1.0_wp
               h(row) = cap
               row = row + 1
               if (mode == mode_convex) then
                  ! I <= (reach**2 + half of a disc's radius squared) m
                  g(row, at + 3:at + each - 1) = 1.0_wp
                  g(row, at) = -1.0_wp
                  if (disc) g(row, at) = -(1.0_wp + 0.5_wp*(region%radius(2)/region%reach)**2)
               else
                  g(row, at) = -1.0_wp
               end if
               if (disc) then
                  disc_mass = pi*criterion%density*region%thickness(2)/unit
                  row = row + 1
                  if (mode == mode_convex) then
                     g(row, at) = -1.0_wp
                     h(row) = -disc_mass*region%radius(1)**2*region%thickness(1)/region%thickness(2)
                     row = row + 1
                     g(row, at) = 1.0_wp
                     h(row) = disc_mass*region%radius(2)**2
                     ! half the radius squared lies between its limits
                     row = row + 1
                     g(row, at + 4) = 1.0_wp
                     g(row, at) = -0.5_wp*(region%radius(2)/region%reach)**2
                     row = row + 1
                     g(row, at + 4) = -1.0_wp
                     g(row, at) = 0.5_wp*(region%radius(1)/region%reach)**2
                  else
                     ! pi rho r**2 t between the limits of the radius, and near the last one
                     g(row, at) = -1.0_wp
                     g(row, at + 3) = disc_mass*max(region%radius(1), radius(k) - move*(region%radius(2) - region%radius(1)))**2
                     row = row + 1
                     g(row, at) = 1.0_wp
                     g(row, at + 3) = -disc_mass*min(region%radius(2), radius(k) + move*(region%radius(2) - region%radius(1)))**2
                     row = row + 1
                     g(row, at + 3) = 1.0_wp
                     h(row) = 1.0_wp
                     row = row + 1
                     g(row, at + 3) = -1.0_wp
                     h(row) = -region%thickness(1)/region%thickness(2)
                  end if
               end if
            end associate
         end do
         if (criterion%budget >= 0.0_wp) then
            row = row + 1
            problem%g(row, first) = 1.0_wp
            problem%h(row) = criterion%budget/unit
         end if
         do k = 1, size(regions)
            if (regions(k)%boxed) call keep_in_box(regions(k), first(k))
         end do
         row = row + 1
         problem%g(row, tau) = 1.0_wp
         ! none is worse than a thousand times the bare linkage, if that is not nothing
         problem%h(row) = merge(1.0e6_wp, 1.0e3_wp, counts_mass)
         do k = 1, size(regions)
            associate (region => regions(k), g => problem%g, h => problem%h)
               at = first(k)
               if (mode == mode_convex) then
                  ! m I >= |p|**2
                  g(cone + 1, [at, at + 3]) = -1.0_wp
                  g(cone + 2, at + 1) = -2.0_wp
                  g(cone + 3, at + 2) = -2.0_wp
                  g(cone + 4, at + 3) = -1.0_wp
                  g(cone + 4, at) = 1.0_wp
                  cone = cone + 4
                  if (.not. disc) cycle
               end if
               g(cone + 1, at) = -1.0_wp
               g(cone + 2, at + 1) = -1.0_wp
               g(cone + 3, at + 2) = -1.0_wp
               cone = cone + 3
               if (mode == mode_convex) then
                  ! own inertia b >= m**2/(2 pi rho t)
                  inner = 2.0_wp*pi*criterion%density*region%thickness(2)*region%reach**2/unit
                  g(cone + 1, at + 4) = -1.0_wp
                  h(cone + 1) = 0.25_wp/inner
                  g(cone + 2, at) = -1.0_wp/inner
                  g(cone + 3, at + 4) = -1.0_wp
                  h(cone + 3) = -0.25_wp/inner
               else
                  g(cone + 1, at) = -move
                  g(cone + 2, at + 1) = -1.0_wp
                  g(cone + 2, at) = centre(1, k)/region%reach
                  g(cone + 3, at + 2) = -1.0_wp
                  g(cone + 3, at) = centre(2, k)/region%reach
               end if
               cone = cone + 3
            end associate
         end do
      end subroutine fill_limits

      !> Low m <= p <= high m, along the link's line and across it.
      subroutine keep_in_box(region, at)
         type(weight_region_t), intent(in) :: region
         integer, intent(in) :: at                 !! of its mass among the unknowns
         real(wp) :: along(2)
         integer :: axis

         along = region%axis
         do axis = 1, 2
            problem%g(row + 1, at + 1:at + 2) = along
            problem%g(row + 1, at) = -region%high(axis)/region%reach
            problem%g(row + 2, at + 1:at + 2) = -along
            problem%g(row + 2, at) = region%low(axis)/region%reach
            row = row + 2
            along = [-region%axis(2), region%axis(1)]
         end do
      end subroutine keep_in_box

      !> Loads over their tolerances by the unknowns, and the bare ones in the last column; all in bare composites.
      subroutine fill_objective()
         real(wp) :: mass_row(n + 1)
         integer :: m, next

         do i = 1, size(criterion%limited)
            associate (channel => channels(criterion%limited(i)))
               comps = size(channel%bare, 2)
               ! the limit is the unit
               rows = loads_of(channel, 1.0_wp/(sqrt(real(positions*comps, wp))*criterion%limit(i)))
               problem%h(cone + 1) = 1.0_wp
               call put_triangle(triangle_of(rows))
            end associate
         end do
         do i = 1, size(criterion%capped)
            associate (channel => channels(criterion%capped(i)))
               rows = loads_of(channel, 1.0_wp/criterion%cap(i))
               call put_positions(rows, size(channel%bare, 2))
               problem%h(cone_starts(size(channel%bare, 2))) = 1.0_wp
            end associate
         end do
         mass_row = 0.0_wp
         if (criterion%mass_tolerance > 0.0_wp) mass_row(first) = unit/(criterion%mass_tolerance*bare)
         if (criterion%peaks) then
            if (criterion%mass_tolerance > 0.0_wp) then
               row = row + 1
               problem%g(row, :) = mass_row(:n)
               problem%g(row, tau) = -1.0_wp
            end if
            do i = 1, size(criterion%channels)
               associate (channel => channels(criterion%channels(i)))
                  comps = size(channel%bare, 2)
                  rows = loads_of(channel, 1.0_wp/(criterion%tolerance(i)*bare), &
                                                         wanted_of(channels, criterion, i))
                  call put_positions(rows, comps)
                  problem%g(cone_starts(comps), tau) = -1.0_wp
               end associate
            end do
            return
         end if
         m = 1
         do i = 1, size(criterion%channels)
            m = m + positions*size(channels(criterion%channels(i))%bare, 2)
         end do
         if (allocated(rows)) deallocate (rows)
         allocate (rows(m, n + 1))
         next = 0
         do i = 1, size(criterion%channels)
            associate (channel => channels(criterion%channels(i)), more => positions*size(channels(criterion%channels(i))%bare, 2))
               rows(next + 1:next + more, :) = loads_of(channel, 1.0_wp/(criterion%tolerance(i)*bare), &
                                                         wanted_of(channels, criterion, i))
               next = next + more
            end associate
         end do
         rows(m, :) = sqrt(real(positions, wp))*mass_row
         problem%g(cone + 1, tau) = -1.0_wp
         call put_triangle(triangle_of(rows))
      end subroutine fill_objective

      !> Cones of a load, one for each position, below their first rows.
      subroutine put_positions(loads, components)
         real(wp), intent(in) :: loads(:, :)       !! shape (components*positions, n + 1)
         integer, intent(in) :: components
         integer :: at, part

         do at = 1, positions
            do part = 1, components
               problem%g(cone + 1 + part, :) = -loads((part - 1)*positions + at, :n)
               problem%h(cone + 1 + part) = loads((part - 1)*positions + at, n + 1)
            end do
            cone = cone + 1 + components
         end do
      end subroutine put_positions

      !> The first rows of the cones put last, one for each position.
      pure function cone_starts(components) result(starts)
         integer, intent(in) :: components
         integer :: starts(positions), at

         starts = [(cone - (positions - at + 1)*(components + 1) + 1, at=1, positions)]
      end function cone_starts

      !> Rows of a cone below its first one, of which the norm is that of all loads.
      subroutine put_triangle(triangle)
         real(wp), intent(in) :: triangle(:, :)    !! shape (n + 1, n + 1)

         problem%g(cone + 2:cone + n + 2, :) = -triangle(:, :n)
         problem%h(cone + 2:cone + n + 2) = triangle(:, n + 1)
         cone = cone + n + 2
      end subroutine put_triangle

      !> A load by the unknowns, and bare, less what is desired, in the last column. Shape: (components*positions, n + 1).
      function loads_of(channel, factor, wanted) result(loads)
         type(channel_t), intent(in) :: channel
         real(wp), intent(in) :: factor
         real(wp), intent(in), optional :: wanted(:, :) !! shape of the load
         real(wp) :: loads(size(channel%bare), n + 1)
         integer :: j, r, at, place

         loads = 0.0_wp
         do at = 1, size(channel%bare, 2)
            place = (at - 1)*positions
            loads(place + 1:place + positions, n + 1) = factor*channel%bare(:, at)
            if (present(wanted)) loads(place + 1:place + positions, n + 1) = factor*(channel%bare(:, at) - wanted(:, at))
            do j = 1, tau - 1
               do r = 1, parameters_of_weight
                  if (.not. abs(to_added(r, j)) > 0.0_wp) cycle
                  loads(place + 1:place + positions, j) = loads(place + 1:place + positions, j) + &
                                                         factor*to_added(r, j)* &
                                                         channel%slope(:, at, r, regions((j - 1)/each + 1)%link)
               end do
            end do
         end do
      end function loads_of

      !> The problem in the unknowns that complete balance leaves.
      subroutine eliminate()
         integer :: j

         if (.not. criterion%exact) return
         do j = 1, n
            if (abs(origin(j)) > 0.0_wp) problem%h = problem%h - origin(j)*problem%g(:, j)
         end do
         problem%g = product_of(problem%g, span)
         problem%q = along_columns(span, problem%q)
      end subroutine eliminate
   end subroutine solve_step
end module psalm_counterweights
