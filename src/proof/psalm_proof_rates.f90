!> Models of the rates of a linkage by its input: of directions, of slides, of points.
!>
!> They are models of the closed forms, not derivatives of a model, whose radius has none. Each dyad's unknown rates obey two
!> linear equations (`doc/theory/rates.md`). Numerators are kept beside the rates: where a denominator may vanish, near an end of
!> closing, they may still tell the sign. Unit of the input: radian, or length.
module psalm_proof_rates
   use psalm_dyad_kind, only: assur_prp, assur_ppr, assur_rpp, assur_rpr, assur_rpr_guide_first, assur_rrp, assur_prr, assur_rrr
   use psalm_plan, only: root_crank, root_frame
   use psalm_proof_groups, only: numbers_t, models_t, evaluate_positions => evaluate, prepare_models, direct
   use psalm_proof_plan, only: proof_plan_t, proof_step_t
   use psalm_taylor, only: rk, lanes, degree, eps, up, smallest, rounding, pair_rounding, norm_of, pair_norm_of, multiply, &
                           multiply_twice, range_of, reciprocal, square_root
   implicit none (type, external)
   private
   public :: rate_models_t, signal_t, prepare_rates, choose_signals, evaluate_rates
   public :: signal_turn, signal_slide, signal_away, signal_turn_sign, signal_slide_sign, signal_square, signal_depart
   public :: signal_turned_by, signal_turned_less, signal_longer, signal_farther, unbounded

   ! what may be asked for
   integer, parameter :: signal_turn = 1       !! rate of a root's direction
   integer, parameter :: signal_slide = 2      !! rate of a varying length
   integer, parameter :: signal_away = 3       !! half the rate of a squared distance from the origin
   integer, parameter :: signal_turn_sign = 4  !! a quantity of the sign of the rate of a root, up to one sign throughout
   integer, parameter :: signal_slide_sign = 5 !! the same of a varying length
   integer, parameter :: signal_square = 6     !! squared distance of a point from the origin
   integer, parameter :: signal_depart = 7     !! rate of its distance
   ! how much more than a reference value something is, times `sense`, less than `amount`
   integer, parameter :: signal_turned_by = 8  !! of a root: sine of the angle
   integer, parameter :: signal_turned_less = 9 !! of a root: cosine of the angle; positive within a right angle
   integer, parameter :: signal_longer = 10    !! of a varying length
   integer, parameter :: signal_farther = 11   !! of a point's distance

   real(rk), parameter :: unknown = 1.0e15_rk  !! radius of what is not bounded
   real(rk), parameter :: unbounded = 1.0e12_rk !! a value beyond is not bounded

   type :: signal_t
      integer :: kind = 0                      !! one of `signal_...`
      integer :: which = 0                     !! root or varying length
      integer, allocatable :: path(:)          !! steps to the point
      real(rk) :: sense = 1.0_rk, amount = 0.0_rk
      real(rk) :: reference(2) = 0.0_rk        !! unit vector, or length in the first
      real(rk) :: doubt = 0.0_rk               !! radius of the reference
   end type signal_t

   !> Rates over a row of boxes; names as in `models_t`, where they are those of the positions.
   type :: rate_models_t
      type(models_t) :: base                   !! positions
      real(rk), allocatable :: turn(:, :, :)   !! shape (lanes, 0:degree, roots): rate of the direction
      real(rk), allocatable :: turn_e(:, :)
      real(rk), allocatable :: slide(:, :, :)  !! shape (lanes, 0:degree, lengths)
      real(rk), allocatable :: slide_e(:, :)
      real(rk), allocatable :: arc(:, :, :, :) !! shape (lanes, 0:degree, 2, steps)
      real(rk), allocatable :: arc_e(:, :)
      real(rk), allocatable :: turn_top(:, :, :), turn_top_e(:, :)   !! numerators
      real(rk), allocatable :: slide_top(:, :, :), slide_top_e(:, :)
      type(signal_t), allocatable :: signals(:)
      real(rk), allocatable :: g(:, :, :)      !! shape (lanes, 0:degree, signals)
      real(rk), allocatable :: g_e(:, :)
      real(rk), allocatable :: low(:, :), high(:, :)
   end type rate_models_t

contains

   !> Allocate the models of a linkage. Every direction of `plan` must be wanted.
   subroutine prepare_rates(plan, numbers, models)
      type(proof_plan_t), intent(in) :: plan
      type(numbers_t), intent(in) :: numbers
      type(rate_models_t), intent(out) :: models

      call prepare_models(plan, numbers, models%base)
      associate (roots => plan%nroots, steps => size(plan%steps), lengths => plan%nlengths)
         allocate (models%turn(lanes, 0:degree, roots), models%turn_top(lanes, 0:degree, roots), source=0.0_rk)
         allocate (models%turn_e(lanes, roots), models%turn_top_e(lanes, roots), source=0.0_rk)
         allocate (models%slide(lanes, 0:degree, lengths), models%slide_top(lanes, 0:degree, lengths), source=0.0_rk)
         allocate (models%slide_e(lanes, lengths), models%slide_top_e(lanes, lengths), source=0.0_rk)
         allocate (models%arc(lanes, 0:degree, 2, steps), models%arc_e(lanes, steps), source=0.0_rk)
      end associate
      if (plan%sliding_input) then
         models%slide(:, 0, plan%input_slot) = numbers%scale
      else
         models%turn(:, 0, root_crank) = 1.0_rk
      end if
      call choose_signals([signal_t ::], models)
   end subroutine prepare_rates

   !> What is to be formed of the rates.
   subroutine choose_signals(signals, models)
      type(signal_t), intent(in) :: signals(:)
      type(rate_models_t), intent(inout) :: models

      models%signals = signals
      if (allocated(models%g)) deallocate (models%g, models%g_e, models%low, models%high)
      allocate (models%g(lanes, 0:degree, size(signals)), models%g_e(lanes, size(signals)), source=0.0_rk)
      allocate (models%low(lanes, size(signals)), models%high(lanes, size(signals)), source=0.0_rk)
   end subroutine choose_signals

   !> All models over boxes of the input.
   subroutine evaluate_rates(plan, numbers, m, r, models)
      type(proof_plan_t), intent(in) :: plan
      type(numbers_t), intent(in) :: numbers
      real(rk), intent(in) :: m(lanes), r(lanes) !! middle and half width, degrees or the user's length
      type(rate_models_t), intent(inout) :: models
      integer :: k

      call evaluate_positions(plan, numbers, m, r, models%base)
      do k = 1, size(plan%steps)
         if (plan%steps(k)%dyad) then
            call add_dyad(plan, numbers, plan%steps(k), models)
         else if (.not. plan%steps(k)%fixed) then
            call add_arc(plan, numbers, k, models)
         end if
      end do
      do k = 1, size(models%signals)
         call add_signal(models, k)
      end do
   end subroutine evaluate_rates

   ! ---- models ------------------------------------------------------------------------------------------------------

   !> A model that has grown beyond measure says nothing.
   pure subroutine limit(c, e)
      real(rk), intent(inout) :: c(lanes, 0:degree), e(lanes)
      logical :: lost(lanes)
      integer :: k

      lost = .not. e < unbounded
      do k = 0, degree
         lost = lost .or. .not. abs(c(:, k)) < unbounded
      end do
      do k = 0, degree
         c(:, k) = merge(0.0_rk, c(:, k), lost)
      end do
      e = merge(unknown, e, lost)
   end subroutine limit

   pure subroutine product_of(a, ea, b, eb, c, ec)
      real(rk), intent(in) :: a(lanes, 0:degree), ea(lanes), b(lanes, 0:degree), eb(lanes)
      real(rk), intent(out) :: c(lanes, 0:degree), ec(lanes)
      real(rk) :: na(lanes), nb(lanes), tail(lanes)

      call multiply(a, b, c, tail)
      call norm_of(a, na)
      call norm_of(b, nb)
      ec = (tail + rounding*na*nb + na*eb + nb*ea + ea*eb)*up + smallest
      call limit(c, ec)
   end subroutine product_of

   !> Scalar product of two vectors, or the component of their cross product.
   pure subroutine pair_product(ax, ay, ea, bx, by, eb, cross, c, ec)
      real(rk), intent(in), dimension(lanes, 0:degree) :: ax, ay, bx, by
      real(rk), intent(in) :: ea(lanes), eb(lanes)
      logical, intent(in) :: cross
      real(rk), intent(out) :: c(lanes, 0:degree), ec(lanes)
      real(rk) :: na(lanes), nb(lanes), tail(lanes)

      if (cross) then
         call multiply_twice(ax, by, -1.0_rk, ay, bx, c, tail)
      else
         call multiply_twice(ax, bx, 1.0_rk, ay, by, c, tail)
      end if
      call pair_norm_of(ax, ay, na)
      call pair_norm_of(bx, by, nb)
      ec = (tail + pair_rounding*na*nb + na*eb + nb*ea + ea*eb)*up + smallest
      call limit(c, ec)
   end subroutine pair_product

   !> Sum a + factor b.
   pure subroutine add(a, ea, factor, b, eb)
      real(rk), intent(inout) :: a(lanes, 0:degree), ea(lanes)
      real(rk), intent(in) :: factor, b(lanes, 0:degree), eb(lanes)
      real(rk) :: na(lanes), nb(lanes)

      call norm_of(b, nb)
      a = a + factor*b
      call norm_of(a, na)
      ea = (ea + abs(factor)*eb + 2.0_rk*eps*(na + abs(factor)*nb))*up + smallest
      call limit(a, ea)
   end subroutine add

   !> Quotient; not bounded where the denominator may vanish.
   pure subroutine divide(top, et, bottom, eb, c, ec)
      real(rk), intent(in) :: top(lanes, 0:degree), et(lanes), bottom(lanes, 0:degree), eb(lanes)
      real(rk), intent(out) :: c(lanes, 0:degree), ec(lanes)
      real(rk) :: low(lanes), high(lanes), safe(lanes, 0:degree), z(lanes, 0:degree), es(lanes), ez(lanes), side(lanes)
      logical :: known(lanes)
      integer :: k

      call range_of(bottom, eb, low, high)
      known = low > 0.0_rk .or. high < 0.0_rk
      side = merge(-1.0_rk, 1.0_rk, high < 0.0_rk)
      do k = 0, degree
         safe(:, k) = merge(side*bottom(:, k), merge(1.0_rk, 0.0_rk, k == 0), known)
      end do
      es = merge(eb, 0.0_rk, known)
      low = merge(merge(low, -high, low > 0.0_rk), 1.0_rk, known)
      call reciprocal(safe, es, low, z, ez)
      do k = 0, degree
         z(:, k) = side*z(:, k)
      end do
      call limit(z, ez)
      call product_of(top, et, z, ez, c, ec)
      ec = merge(ec, unknown, known)
      call limit(c, ec)
   end subroutine divide

   ! ---- steps -------------------------------------------------------------------------------------------------------

   !> Rate of an arc's vector in the sense of its step.
   subroutine add_arc(plan, numbers, k, models)
      type(proof_plan_t), intent(in) :: plan
      type(numbers_t), intent(in) :: numbers
      integer, intent(in) :: k
      type(rate_models_t), intent(inout) :: models
      real(rk) :: x(lanes, 0:degree), y(lanes, 0:degree), e(lanes), ex(lanes), ey(lanes), sense

      associate (arc => plan%steps(k)%arc, vx => models%arc(:, :, 1, k), vy => models%arc(:, :, 2, k), base => models%base)
         associate (root => plan%root(arc), slot => plan%slot(arc))
            if (root == root_frame) then
               vx = 0.0_rk
               vy = 0.0_rk
               models%arc_e(:, k) = 0.0_rk
            else if (root == root_crank) then
               vx = -base%arc(:, :, 2, k)
               vy = base%arc(:, :, 1, k)
               models%arc_e(:, k) = base%arc_e(:, k)
            else
               call product_of(models%turn(:, :, root), models%turn_e(:, root), base%arc(:, :, 2, k), base%arc_e(:, k), vx, ex)
               vx = -vx
               call product_of(models%turn(:, :, root), models%turn_e(:, root), base%arc(:, :, 1, k), base%arc_e(:, k), vy, ey)
               models%arc_e(:, k) = ex + ey
            end if
            if (slot == 0) return
            sense = real(plan%steps(k)%sense, rk)
            call direct(plan, numbers, base, arc, x, y, e)
            ex = models%arc_e(:, k)
            ey = ex
            call add_product(models%slide(:, :, slot), models%slide_e(:, slot), x, e, sense, vx, ex)
            call add_product(models%slide(:, :, slot), models%slide_e(:, slot), y, e, sense, vy, ey)
            models%arc_e(:, k) = ex + ey
         end associate
      end associate
   end subroutine add_arc

   !> c + sense a b.
   pure subroutine add_product(a, ea, b, eb, sense, c, ec)
      real(rk), intent(in) :: a(lanes, 0:degree), ea(lanes), b(lanes, 0:degree), eb(lanes), sense
      real(rk), intent(inout) :: c(lanes, 0:degree), ec(lanes)
      real(rk) :: p(lanes, 0:degree), ep(lanes)

      call product_of(a, ea, b, eb, p, ep)
      call add(c, ec, sense, p, ep)
   end subroutine add_product

   !> Sum of the vectors of some steps; the radius bounds both components together.
   pure subroutine add_up(arc, arc_e, step, x, y, e)
      real(rk), intent(in) :: arc(:, 0:, :, :), arc_e(:, :)
      type(proof_step_t), intent(in) :: step
      real(rk), intent(out) :: x(lanes, 0:degree), y(lanes, 0:degree), e(lanes)
      real(rk) :: norm(lanes)
      integer :: i

      x = 0.0_rk
      y = 0.0_rk
      e = 0.0_rk
      do i = 1, size(step%terms)
         x = x + step%senses(i)*arc(:, :, 1, step%terms(i))
         y = y + step%senses(i)*arc(:, :, 2, step%terms(i))
         call pair_norm_of(x, y, norm)
         e = (e + arc_e(:, step%terms(i)) + eps*norm)*up
      end do
      call limit(x, e)
      call limit(y, e)
   end subroutine add_up

   !> Rates that a dyad finds.
   subroutine add_dyad(plan, numbers, step, models)
      type(proof_plan_t), intent(in) :: plan
      type(numbers_t), intent(in) :: numbers
      type(proof_step_t), intent(in) :: step
      type(rate_models_t), intent(inout) :: models
      real(rk), dimension(lanes, 0:degree) :: hx, hy, kx, ky, ux, uy, vx, vy, top, bottom, c
      real(rk), dimension(lanes) :: eh, ek, eu, ev, et, eb, ec

      call add_up(models%base%arc, models%base%arc_e, step, hx, hy, eh)
      call add_up(models%arc, models%arc_e, step, kx, ky, ek)
      select case (step%kind)
      case (assur_rrr)
         ! h' = P wp i u + Q wq i v
         call direct(plan, numbers, models%base, step%p, ux, uy, eu)
         call direct(plan, numbers, models%base, step%q, vx, vy, ev)
         call pair_product(ux, uy, eu, vx, vy, ev, .true., bottom, eb)
         call pair_product(kx, ky, ek, vx, vy, ev, .false., top, et)
         call put_turn(step%p, 1.0_rk/numbers%length(step%p))
         call pair_product(kx, ky, ek, ux, uy, eu, .false., top, et)
         call put_turn(step%q, -1.0_rk/numbers%length(step%q))
      case (assur_rpr)
         call slide_on_pivot(step%p)
      case (assur_rpr_guide_first)
         call slide_on_pivot(step%q)
      case (assur_rrp)
         call link_on_slide(step%p, step%q)
      case (assur_prr)
         call link_on_slide(step%q, step%p)
      case (assur_rpp, assur_ppr)
         call project(step%p)
         call project(step%q)
      case (assur_prp)
         ! h' less what the directions do = L' u + R' v
         call direct(plan, numbers, models%base, step%p, ux, uy, eu)
         call direct(plan, numbers, models%base, step%q, vx, vy, ev)
         call turn_away(step%p, ux, uy, eu)
         call turn_away(step%q, vx, vy, ev)
         call pair_product(ux, uy, eu, vx, vy, ev, .true., bottom, eb)
         call pair_product(kx, ky, ek, vx, vy, ev, .true., top, et)
         call put_slide(step%p)
         call pair_product(ux, uy, eu, kx, ky, ek, .true., top, et)
         call put_slide(step%q)
      end select

   contains

      !> Rate of the root of an arc: factor top/bottom.
      subroutine put_turn(arc, factor)
         integer, intent(in) :: arc
         real(rk), intent(in) :: factor
         real(rk) :: whole(lanes, 0:degree), e(lanes)

         associate (root => plan%root(arc))
            models%turn_top(:, :, root) = top
            models%turn_top_e(:, root) = et
            call divide(top, et, bottom, eb, whole, e)
            models%turn(:, :, root) = 0.0_rk
            models%turn_e(:, root) = 0.0_rk
            call add(models%turn(:, :, root), models%turn_e(:, root), factor, whole, e)
         end associate
      end subroutine put_turn

      subroutine put_slide(arc)
         integer, intent(in) :: arc

         associate (slot => plan%slot(arc))
            models%slide_top(:, :, slot) = top
            models%slide_top_e(:, slot) = et
            call divide(top, et, bottom, eb, models%slide(:, :, slot), models%slide_e(:, slot))
         end associate
      end subroutine put_slide

      !> Two links of which one slides, the other is a guide at right angles: w = cross(u, h')/S, S' = h.h'/S.
      subroutine slide_on_pivot(slide)
         integer, intent(in) :: slide

         bottom = models%base%slide(:, :, plan%slot(slide))
         eb = models%base%slide_e(:, plan%slot(slide))
         call direct(plan, numbers, models%base, slide, ux, uy, eu)
         call pair_product(ux, uy, eu, kx, ky, ek, .true., top, et)
         call put_turn(slide, 1.0_rk)
         call pair_product(hx, hy, eh, kx, ky, ek, .false., top, et)
         call put_slide(slide)
      end subroutine slide_on_pivot

      !> A link v and a slide along the known direction u: P wv u.v = cross(u, h') - L wu, L' = h'.u - P wv cross(v, u).
      subroutine link_on_slide(link, slide)
         integer, intent(in) :: link, slide
         real(rk) :: along(lanes, 0:degree), ea(lanes), across(lanes, 0:degree), ex(lanes)

         call direct(plan, numbers, models%base, link, vx, vy, ev)
         call direct(plan, numbers, models%base, slide, ux, uy, eu)
         call pair_product(ux, uy, eu, vx, vy, ev, .false., bottom, eb)
         call pair_product(ux, uy, eu, kx, ky, ek, .true., top, et)
         associate (slot => plan%slot(slide), root => plan%root(slide))
            if (root /= root_frame) call add_product(models%base%slide(:, :, slot), models%base%slide_e(:, slot), &
                                                     models%turn(:, :, root), models%turn_e(:, root), -1.0_rk, top, et)
         end associate
         call put_turn(link, 1.0_rk/numbers%length(link))
         c = top
         ec = et
         call pair_product(kx, ky, ek, ux, uy, eu, .false., along, ea)
         call product_of(along, ea, bottom, eb, top, et)
         call pair_product(vx, vy, ev, ux, uy, eu, .true., across, ex)
         call add_product(c, ec, across, ex, -1.0_rk, top, et)
         call put_slide(slide)
      end subroutine link_on_slide

      !> A slide of two at right angles: L' = h'.u + w cross(u, h).
      subroutine project(slide)
         integer, intent(in) :: slide

         call direct(plan, numbers, models%base, slide, ux, uy, eu)
         call pair_product(kx, ky, ek, ux, uy, eu, .false., top, et)
         associate (slot => plan%slot(slide), root => plan%root(slide))
            if (root /= root_frame) then
               call pair_product(ux, uy, eu, hx, hy, eh, .true., c, ec)
               call add_product(models%turn(:, :, root), models%turn_e(:, root), c, ec, 1.0_rk, top, et)
            end if
            models%slide_top(:, :, slot) = top
            models%slide_top_e(:, slot) = et
            models%slide(:, :, slot) = top
            models%slide_e(:, slot) = et
         end associate
      end subroutine project

      !> Take away from h' what the turning of a slide's direction does.
      subroutine turn_away(slide, x, y, e)
         integer, intent(in) :: slide
         real(rk), intent(in) :: x(lanes, 0:degree), y(lanes, 0:degree), e(lanes)
         real(rk) :: first(lanes), second(lanes)

         associate (slot => plan%slot(slide), root => plan%root(slide))
            if (root == root_frame) return
            call product_of(models%base%slide(:, :, slot), models%base%slide_e(:, slot), models%turn(:, :, root), &
                            models%turn_e(:, root), c, ec)
            first = ek
            second = ek
            call add_product(c, ec, y, e, 1.0_rk, kx, first)
            call add_product(c, ec, x, e, -1.0_rk, ky, second)
            ek = first + second
         end associate
      end subroutine turn_away
   end subroutine add_dyad

   !> What is asked for, with its bounds.
   subroutine add_signal(models, k)
      type(rate_models_t), intent(inout) :: models
      integer, intent(in) :: k
      real(rk), dimension(lanes, 0:degree) :: x, y, vx, vy, top
      real(rk), dimension(lanes) :: e, ev, et

      associate (signal => models%signals(k), g => models%g(:, :, k), g_e => models%g_e(:, k))
         select case (signal%kind)
         case (signal_turn)
            g = models%turn(:, :, signal%which)
            g_e = models%turn_e(:, signal%which)
         case (signal_slide)
            g = models%slide(:, :, signal%which)
            g_e = models%slide_e(:, signal%which)
         case (signal_turn_sign)
            g = models%turn_top(:, :, signal%which)
            g_e = models%turn_top_e(:, signal%which)
         case (signal_slide_sign)
            g = models%slide_top(:, :, signal%which)
            g_e = models%slide_top_e(:, signal%which)
         case (signal_turned_by, signal_turned_less)
            x = 0.0_rk
            y = 0.0_rk
            x(:, 0) = signal%reference(1)
            y(:, 0) = signal%reference(2)
            e = signal%doubt
            call pair_product(x, y, e, models%base%root(:, :, 1, signal%which), models%base%root(:, :, 2, signal%which), &
                              models%base%root_e(:, signal%which), signal%kind == signal_turned_by, g, g_e)
            if (signal%kind == signal_turned_by) call leave()
         case (signal_longer)
            g = models%base%slide(:, :, signal%which)
            g_e = models%base%slide_e(:, signal%which)
            call leave()
         case default
            call follow_point()
            select case (signal%kind)
            case (signal_away)
               call pair_product(x, y, e, vx, vy, ev, .false., g, g_e)
            case (signal_square)
               call pair_product(x, y, e, x, y, e, .false., g, g_e)
            case (signal_farther)
               call find_distance(g, g_e)
               call leave()
            case default
               call find_distance(g, g_e)
               call pair_product(x, y, e, vx, vy, ev, .false., top, et)
               x = g
               ev = g_e
               call divide(top, et, x, ev, g, g_e)
            end select
         end select
         call range_of(g, g_e, models%low(:, k), models%high(:, k))
      end associate

   contains

      !> amount - sense (g - reference)
      subroutine leave()
         real(rk) :: c(lanes, 0:degree), ec(lanes)

         associate (signal => models%signals(k))
            c = 0.0_rk
            c(:, 0) = signal%amount
            ec = 2.0_rk*eps*signal%amount
            if (signal%kind /= signal_turned_by) then
               c(:, 0) = signal%amount + signal%sense*signal%reference(1)
               ec = signal%doubt + 4.0_rk*eps*(signal%amount + abs(signal%reference(1)))
            end if
            call add(c, ec, -signal%sense, models%g(:, :, k), models%g_e(:, k))
            models%g(:, :, k) = c
            models%g_e(:, k) = ec
         end associate
      end subroutine leave

      !> A point and its rate.
      subroutine follow_point()
         integer :: i

         x = 0.0_rk
         y = 0.0_rk
         vx = 0.0_rk
         vy = 0.0_rk
         e = 0.0_rk
         ev = 0.0_rk
         do i = 1, size(models%signals(k)%path)
            associate (step => models%signals(k)%path(i))
               call add(x, e, 1.0_rk, models%base%arc(:, :, 1, step), models%base%arc_e(:, step))
               call add(y, e, 1.0_rk, models%base%arc(:, :, 2, step), 0.0_rk*e)
               call add(vx, ev, 1.0_rk, models%arc(:, :, 1, step), models%arc_e(:, step))
               call add(vy, ev, 1.0_rk, models%arc(:, :, 2, step), 0.0_rk*ev)
            end associate
         end do
      end subroutine follow_point

      !> Distance of the point from the origin; not bounded where it may be zero.
      pure subroutine find_distance(c, ec)
         real(rk), intent(out) :: c(lanes, 0:degree), ec(lanes)
         real(rk) :: square(lanes, 0:degree), es(lanes), low(lanes), high(lanes)
         logical :: known(lanes)
         integer :: j

         call pair_product(x, y, e, x, y, e, .false., square, es)
         call range_of(square, es, low, high)
         known = low > 0.0_rk
         do j = 0, degree
            square(:, j) = merge(square(:, j), merge(1.0_rk, 0.0_rk, j == 0), known)
         end do
         es = merge(es, 0.0_rk, known)
         call square_root(square, es, merge(low, 1.0_rk, known), c, ec)
         ec = merge(ec, unknown, known)
         call limit(c, ec)
      end subroutine find_distance
   end subroutine add_signal
end module psalm_proof_rates
