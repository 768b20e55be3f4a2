!> Assur groups: the one place that knows which kind of group is which.
!>
!> Each verb - bind, solve, form, differentiate, react, closure, its change, error bounds, violation, repair - goes to the file of
!> the dyad's kind. A new kind is a new file and a line in each verb here.
module psalm_assur
   use psalm_arc_kernels, only: arc_vector
   use psalm_dyad, only: dyad_t, dyad_violation_t, violation_group, violation_none
   use psalm_dyad_kind, only: assur_ppr, assur_prp, assur_prr, assur_rpp, assur_rpr, assur_rpr_guide_first, assur_rrp, assur_rrr, &
                              assur_higher, direction_known, form_of, form_t
   use psalm_dyad_lanes, only: dyad_lanes_t
   use psalm_elementary, only: hypotenuse
   use psalm_frames, only: frames_t, form_arc, dyad_rate, rows_of_arc, sine_row
   use psalm_higher_group, only: closure_of_higher, dead_measure, is_dead_higher
   use psalm_kinds, only: wp
   use psalm_prp, only: bind_prp, solve_prp, form_prp, measure_prp, change_of_measure_prp, bounds_prp, violation_prp, react_prp, &
                        bind_prp_lanes, solve_prp_lanes
   use psalm_rows, only: rows_t
   use psalm_rpp, only: bind_rpp, solve_rpp, form_rpp, rates_twice_rpp, bounds_rpp, react_rpp, bind_rpp_lanes, solve_rpp_lanes
   use psalm_rpr, only: bind_rpr, solve_rpr, form_rpr, measure_rpr, change_of_measure_rpr, bounds_rpr, violation_rpr, repair_rpr, &
                        coincidence_rpr, react_rpr, bind_rpr_lanes, solve_rpr_lanes
   use psalm_rrp, only: bind_rrp, solve_rrp, form_rrp, measure_rrp, change_of_measure_rrp, bounds_rrp, violation_rrp, repair_rrp, &
                        react_rrp, bind_rrp_lanes, solve_rrp_lanes
   use psalm_rrr, only: bind_rrr, solve_rrr, form_rrr, rates_rrr, measure_rrr, change_of_measure_rrr, bounds_rrr, violation_rrr, &
                        repair_rrr, coincidence_rrr, react_rrr, bind_rrr_lanes, solve_rrr_lanes
   use psalm_wrench_kernels, only: moment_about, force_along, pass_force, pass_across, opposite_force, opposite_across
   implicit none (type, external)
   private
   public :: rows_to_react
   public :: mark_unknowns, bind_dyad, solve_dyad, form_dyad, differentiate_dyad, react_dyad, is_dead_dyad
   public :: closure_of, change_of_closure, bounds_of_dyad, violation_of, coincidence_of, repair_dyad, is_orthogonal, is_signed
   public :: makes_tip
   public :: bind_dyad_lanes, solve_dyad_lanes

   integer, parameter :: rows_to_react = 2*rows_of_arc + 2 !! scratch of `react_dyad`: both arcs, two free components

   real(wp), parameter :: dead_by_root = 64.0_wp*epsilon(1.0_wp) !! square of the sine below which a triangle is flat
   real(wp), parameter :: dead_by_angle = dead_by_root**2        !! the same where the sine itself is computed

contains

   !> Enter the rows of what the dyad finds, in the order of p and q, a direction before a length.
   pure subroutine mark_unknowns(dyad)
      type(dyad_t), intent(inout) :: dyad

      select case (dyad%kind)
      case (assur_rrr)
         dyad%unknown = [dyad%p_x, dyad%q_x]
      case (assur_rpr)
         dyad%unknown = [dyad%p_x, dyad%slide_p]
      case (assur_rpr_guide_first, assur_rrp)
         dyad%unknown = [dyad%p_x, dyad%slide_q]
      case (assur_prr)
         dyad%unknown = [dyad%slide_p, dyad%q_x]
      case (assur_higher)
         dyad%unknown = 0
      case default
         dyad%unknown = [dyad%slide_p, dyad%slide_q]
      end select
   end subroutine mark_unknowns

   !> Limits of the closure measure for the dyad's present lengths.
   pure subroutine bind_dyad(dyad, cosine_lowest, sine_lowest, toggle)
      type(dyad_t), intent(inout) :: dyad
      real(wp), intent(in) :: cosine_lowest        !! cosine of the smallest transmission angle allowed
      real(wp), intent(in) :: sine_lowest          !! sine of the smallest angle between two slides allowed
      real(wp), intent(in) :: toggle               !! length to spare of a link or guide with a slide, scaled as the dyad's

      select case (dyad%kind)
      case (assur_rrr)
         call bind_rrr(dyad, cosine_lowest)
      case (assur_rpr, assur_rpr_guide_first)
         call bind_rpr(dyad, toggle)
      case (assur_rrp, assur_prr)
         call bind_rrp(dyad, toggle)
      case (assur_rpp, assur_ppr)
         call bind_rpp(dyad)
         dyad%accepts_low = dyad%closes_low
         dyad%accepts_high = dyad%closes_high
      case (assur_higher)
         dyad%closes_low = dead_measure
         dyad%closes_high = huge(1.0_wp)
         dyad%accepts_low = dyad%closes_low
         dyad%accepts_high = dyad%closes_high
      case default
         call bind_prp(dyad, sine_lowest)
      end select
   end subroutine bind_dyad

   !> Unknowns and closure measure at `n` positions.
   pure subroutine solve_dyad(n, dyad, store)
      integer, intent(in) :: n                     !! positions, padded
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(inout) :: store

      select case (dyad%kind)
      case (assur_rrr)
         call solve_rrr(n, dyad, store)
      case (assur_rpr, assur_rpr_guide_first)
         call solve_rpr(n, dyad, store)
      case (assur_rrp, assur_prr)
         call solve_rrp(n, dyad, store)
      case (assur_rpp, assur_ppr)
         call solve_rpp(n, dyad, store)
      case default
         call solve_prp(n, dyad, store)
      end select
   end subroutine solve_dyad

   !> Limits of what is accepted, for the lengths of linkages side by side; not of larger groups.
   pure subroutine bind_dyad_lanes(dyad, cosine_lowest, sine_lowest, toggle, numbers)
      type(dyad_t), intent(in) :: dyad             !! of any of them
      real(wp), intent(in) :: cosine_lowest, sine_lowest, toggle !! as `bind_dyad` has them; of unscaled lengths
      type(dyad_lanes_t), intent(inout) :: numbers

      select case (dyad%kind)
      case (assur_rrr)
         call bind_rrr_lanes(numbers, cosine_lowest)
      case (assur_rpr, assur_rpr_guide_first)
         call bind_rpr_lanes(dyad%kind, numbers, toggle)
      case (assur_rrp, assur_prr)
         call bind_rrp_lanes(dyad%kind, numbers, toggle)
      case (assur_rpp, assur_ppr)
         call bind_rpp_lanes(numbers)
      case default
         call bind_prp_lanes(numbers, sine_lowest)
      end select
   end subroutine bind_dyad_lanes

   !> Unknowns and closure measure at `n` positions of linkages side by side: the bits of `solve_dyad`. The rows of the store have
   !> the shape (lanes, positions).
   pure subroutine solve_dyad_lanes(n, dyad, numbers, store)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad             !! of any of them: kind, rows, assembly
      type(dyad_lanes_t), intent(in) :: numbers
      type(rows_t), intent(inout) :: store

      select case (dyad%kind)
      case (assur_rrr)
         call solve_rrr_lanes(n, dyad, numbers, store)
      case (assur_rpr, assur_rpr_guide_first)
         call solve_rpr_lanes(n, dyad, numbers, store)
      case (assur_rrp, assur_prr)
         call solve_rrp_lanes(n, dyad, numbers, store)
      case (assur_rpp, assur_ppr)
         call solve_rpp_lanes(n, dyad, numbers, store)
      case default
         call solve_prp_lanes(n, dyad, numbers, store)
      end select
   end subroutine solve_dyad_lanes

   !> Vectors of both arcs and the inverse matrix, into `rows_of_dyad` rows from `at` on.
   subroutine form_dyad(n, dyad, angle_x, angle_y, store, at, frames)
      integer, intent(in) :: n, at
      type(dyad_t), intent(in) :: dyad
      real(wp), intent(in) :: angle_x(:), angle_y(:) !! by arc: cosine, sine of its fixed angle
      type(rows_t), intent(in) :: store
      type(frames_t), intent(inout) :: frames
      real(wp) :: limit

      call form_arc(n, store, dyad%p_x, dyad%p_y, angle_x(dyad%arc_p), angle_y(dyad%arc_p), dyad%p, dyad%slide_p, frames, at)
      call form_arc(n, store, dyad%q_x, dyad%q_y, angle_x(dyad%arc_q), angle_y(dyad%arc_q), dyad%q, dyad%slide_q, frames, &
                    at + rows_of_arc)
      limit = dead_limit(dyad%kind)
      select case (dyad%kind)
      case (assur_rrr)
         call form_rrr(n, limit, at, frames)
      case (assur_rpr, assur_rpr_guide_first)
         call form_rpr(n, limit, dyad, at, frames)
      case (assur_rrp, assur_prr)
         call form_rrp(n, limit, dyad, at, frames)
      case (assur_rpp, assur_ppr)
         call form_rpp(n, limit, at, frames)
      case default
         call form_prp(n, limit, at, frames)
      end select
   end subroutine form_dyad

   !> Derivatives of the unknowns by the input, orders 1 to `orders` (2 or 3).
   subroutine differentiate_dyad(n, orders, dyad, angle_x, angle_y, store, at, frames, d)
      integer, intent(in) :: n, orders, at
      type(dyad_t), intent(in) :: dyad
      real(wp), intent(in) :: angle_x(:), angle_y(:)
      type(rows_t), intent(in) :: store
      type(frames_t), intent(inout) :: frames
      type(rows_t), intent(inout) :: d(:)          !! by order
      integer :: order

      if (dyad%kind == assur_rrr) then
         call rates_rrr(n, orders, dead_by_root, dyad, store, at, frames, d)
      else if (orders == 2 .and. is_orthogonal(dyad%kind)) then
         call rates_twice_rpp(n, dyad, store, d)
      else
         call form_dyad(n, dyad, angle_x, angle_y, store, at, frames)
         do order = 1, orders
            call dyad_rate(n, order, dyad, frames, at, d)
         end do
      end if
   end subroutine differentiate_dyad

   !> Forces in the joints of a dyad from the wrenches on its bodies, which become the wrenches that it passes on.
   !>
   !> `w` holds of every body the rows force x, force y, moment about the origin; of every joint two rows: force x and y of a
   !> revolute joint; of a prismatic one the force across the slide (along i u, with u the direction of the slide's arc) at its
   !> foot, and the couple about the foot. They are those of what comes before on what comes after: on p, of p on q, on q.
   !> At a dead point they are finite and mean nothing. Source of the closed forms: Oldham (1977), 15.1, worked out in
   !> `doc/theory/forces.md`.
   subroutine react_dyad(n, dyad, store, on_p, on_q, at_s, at_m, at_e, scratch, w)
      integer, intent(in) :: n                     !! positions, padded
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store
      integer, intent(in) :: on_p, on_q            !! first rows of the wrenches on p and q
      integer, intent(in) :: at_s, at_m, at_e      !! first rows of the joints S, M, E
      integer, intent(in) :: scratch               !! first of `rows_to_react` rows
      type(rows_t), intent(inout) :: w
      type(form_t) :: form
      integer :: p, q, alpha, beta
      logical :: slides_at_s, slides_at_e

      form = form_of(dyad%kind)
      slides_at_s = form%slides(1) .and. form%direction(1) == direction_known
      slides_at_e = form%slides(2) .and. form%direction(2) == direction_known
      p = scratch               ! direction and vector of p, its length
      q = scratch + rows_of_arc
      alpha = q + rows_of_arc   ! free components at S and E
      beta = alpha + 1
      call vector_of(dyad%p_x, dyad%p_y, dyad%px, dyad%py, dyad%p, dyad%slide_p, p)
      call vector_of(dyad%q_x, dyad%q_y, dyad%qx, dyad%qy, dyad%q, dyad%slide_q, q)
      call free_component(slides_at_s, dyad%s_x, dyad%s_y, p, on_p, alpha)
      call free_component(slides_at_e, dyad%e_x, dyad%e_y, q, on_q, beta)
      associate (f => w%v)
         select case (dyad%kind)
         case (assur_rrr)
            call react_rrr(n, f(1, p + 2), f(1, p + 3), f(1, q + 2), f(1, q + 3), f(1, alpha), f(1, beta), f(1, at_m), &
                           f(1, at_m + 1))
            call pass()
         case (assur_rpr)
            call react_rpr(n, .true., f(1, p + 4), f(1, alpha), f(1, beta), f(1, at_m), f(1, at_m + 1))
            call pass_on_slide(p)
         case (assur_rpr_guide_first)
            call react_rpr(n, .false., f(1, q + 4), f(1, alpha), f(1, beta), f(1, at_m), f(1, at_m + 1))
            call pass_on_slide(q)
         case (assur_rrp)
            call react_rrp(n, 1.0_wp, f(1, p + 2), f(1, p + 3), f(1, q), f(1, q + 1), f(1, alpha), f(1, beta), f(1, at_m), &
                           f(1, at_m + 1))
            call pass()
         case (assur_prr)
            call react_rrp(n, -1.0_wp, f(1, q + 2), f(1, q + 3), f(1, p), f(1, p + 1), f(1, beta), f(1, alpha), f(1, at_m), &
                           f(1, at_m + 1))
            call pass()
         case (assur_rpp)
            call react_rpp(n, 1.0_wp, f(1, p), f(1, p + 1), f(1, q), f(1, q + 1), f(1, p + 4), f(1, alpha), f(1, beta), &
                           f(1, at_m), f(1, at_m + 1))
            call pass_on_slide(p)
         case (assur_ppr)
            call react_rpp(n, -1.0_wp, f(1, q), f(1, q + 1), f(1, p), f(1, p + 1), f(1, q + 4), f(1, beta), f(1, alpha), &
                           f(1, at_m), f(1, at_m + 1))
            call pass_on_slide(q)
         case default
            call react_prp(n, f(1, p), f(1, p + 1), f(1, q), f(1, q + 1), f(1, alpha), f(1, beta), f(1, at_m), f(1, at_m + 1))
            call pass()
         end select
      end associate
      call hold(slides_at_s, dyad%s_x, dyad%s_y, p, on_p, at_s)
      call hold(slides_at_e, dyad%e_x, dyad%e_y, q, on_q, at_e)

   contains

      !> Direction, vector and length of an arc, into five rows from `at` on.
      subroutine vector_of(root_x, root_y, c, s, length, slide, at)
         integer, intent(in) :: root_x, root_y, slide, at
         real(wp), intent(in) :: c, s, length

         associate (f => w%v, v => store%v)
            if (slide > 0) then
               f(1:n, at + 4) = v(1:n, slide)
            else
               f(1:n, at + 4) = length
            end if
            call arc_vector(n, v(1, root_x), v(1, root_y), c, s, f(1, at + 4), f(1, at), f(1, at + 1), f(1, at + 2), f(1, at + 3))
         end associate
      end subroutine vector_of

      !> Free component of the wrench at an outer joint.
      subroutine free_component(slides, x, y, arc, wrench, to)
         logical, intent(in) :: slides
         integer, intent(in) :: x, y, arc, wrench, to

         associate (f => w%v, v => store%v)
            if (slides) then
               call force_along(n, f(1, arc), f(1, arc + 1), f(1, wrench), f(1, wrench + 1), f(1, to))
            else
               call moment_about(n, v(1, x), v(1, y), f(1, wrench), f(1, wrench + 1), f(1, wrench + 2), f(1, to))
            end if
         end associate
      end subroutine free_component

      !> Force of an outer joint, against the wrench that is passed on.
      subroutine hold(slides, x, y, arc, wrench, to)
         logical, intent(in) :: slides
         integer, intent(in) :: x, y, arc, wrench, to

         associate (f => w%v, v => store%v)
            if (slides) then
               call opposite_across(n, v(1, x), v(1, y), f(1, arc), f(1, arc + 1), f(1, wrench), f(1, wrench + 1), &
                                    f(1, wrench + 2), f(1, to), f(1, to + 1))
            else
               call opposite_force(n, f(1, wrench), f(1, wrench + 1), f(1, to), f(1, to + 1))
            end if
         end associate
      end subroutine hold

      !> A force in the common pin.
      subroutine pass()
         associate (f => w%v, v => store%v)
            call pass_force(n, v(1, dyad%s_x), v(1, dyad%s_y), f(1, p + 2), f(1, p + 3), f(1, at_m), f(1, at_m + 1), &
                            f(1, on_p), f(1, on_p + 1), f(1, on_p + 2), f(1, on_q), f(1, on_q + 1), f(1, on_q + 2))
         end associate
      end subroutine pass

      !> A force across the common slide, along the arc at `slide`, and a couple.
      subroutine pass_on_slide(slide)
         integer, intent(in) :: slide

         associate (f => w%v, v => store%v)
            call pass_across(n, v(1, dyad%s_x), v(1, dyad%s_y), f(1, p + 2), f(1, p + 3), f(1, slide), f(1, slide + 1), &
                             f(1, at_m), f(1, at_m + 1), f(1, on_p), f(1, on_p + 1), f(1, on_p + 2), f(1, on_q), &
                             f(1, on_q + 1), f(1, on_q + 2))
         end associate
      end subroutine pass_on_slide
   end subroutine react_dyad

   !> True for two slides that are always at right angles: their matrix always has an inverse, and need not be formed.
   pure logical function is_orthogonal(kind)
      integer, intent(in) :: kind

      is_orthogonal = kind == assur_rpp .or. kind == assur_ppr
   end function is_orthogonal

   !> True where the matrix of a dyad has no inverse at position i: a dead point, rates are infinite.
   pure logical function is_dead_dyad(dyad, frames, at, i)
      type(dyad_t), intent(in) :: dyad
      integer, intent(in) :: at, i
      type(frames_t), intent(in) :: frames

      if (dyad%kind == assur_higher) then
         is_dead_dyad = is_dead_higher(dyad%higher, frames, at, i)
      else
         is_dead_dyad = frames%work%v(i, at + sine_row) <= dead_limit(dyad%kind)
      end if
   end function is_dead_dyad

   !> Square of the sine at and below which a dyad of this kind is at a dead point.
   pure real(wp) function dead_limit(kind)
      integer, intent(in) :: kind
      type(form_t) :: form

      form = form_of(kind)
      dead_limit = merge(dead_by_root, dead_by_angle, form%by_root)
   end function dead_limit

   !> How near a dyad is to its limit: it closes, with `clearance` to spare, while abs(k) <= 1. Dimensionless and smooth across
   !> closing: RRR the cosine of the transmission angle; RPR guide and clearance over distance; RRP offset and clearance over
   !> link; PRP 1 less the sine between the slides; larger groups 1 less their measure; others 0.
   pure subroutine closure_of(n, dyad, store, clearance, side, k)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store
      real(wp), intent(in) :: clearance            !! TOGGLE, scaled as lengths are
      real(wp), intent(in) :: side                 !! of PRP, +1 or -1, sign of the sine between the slides that is wanted
      real(wp), intent(out) :: k(:)                !! shape (n)

      select case (dyad%kind)
      case (assur_rrr)
         call measure_rrr(n, dyad, store, k)
      case (assur_rpr, assur_rpr_guide_first)
         call measure_rpr(n, dyad, store, clearance, k)
      case (assur_rrp, assur_prr)
         call measure_rrp(n, dyad, store, clearance, k)
      case (assur_prp)
         call measure_prp(n, dyad, store, side, k)
      case (assur_higher)
         call closure_of_higher(n, dyad%higher, store, dyad%measure, k)
      case default
         k = 0.0_wp
      end select
   end subroutine closure_of

   !> Change of `closure_of` of a dyad with a variable.
   pure subroutine change_of_closure(n, dyad, store, d, clearance, side, unit, dp, dq, turn_p, turn_q, dk)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store
      type(rows_t), intent(in) :: d                !! changes of all rows
      real(wp), intent(in) :: clearance, side      !! as `closure_of` has them
      real(wp), intent(in) :: unit                 !! radians a unit of the variable is worth, or 1
      real(wp), intent(in) :: dp, dq               !! changes of the lengths
      real(wp), intent(in) :: turn_p, turn_q       !! turns of the fixed angles
      real(wp), intent(out) :: dk(:)               !! shape (n)

      select case (dyad%kind)
      case (assur_rrr)
         call change_of_measure_rrr(n, dyad, store, d, unit, dp, dq, dk)
      case (assur_rpr, assur_rpr_guide_first)
         call change_of_measure_rpr(n, dyad, store, d, clearance, unit, dp, dq, dk)
      case (assur_rrp, assur_prr)
         call change_of_measure_rrp(n, dyad, store, d, clearance, unit, dp, dq, turn_p, turn_q, dk)
      case (assur_prp)
         call change_of_measure_prp(n, dyad, store, d, side, unit, turn_p, turn_q, dk)
      case default
         dk = 0.0_wp
      end select
   end subroutine change_of_closure

   !> First-order bounds of the errors of the unknowns at position i, in units of epsilon, in the order of `dyad%unknown`.
   pure subroutine bounds_of_dyad(dyad, store, i, s, e, direction, worst, bound)
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(in) :: store
      integer, intent(in) :: i
      real(wp), intent(in) :: s, e                 !! bounds of the outer joints, length
      real(wp), intent(in) :: direction(2)         !! bounds of the directions of p and q, radians, where they are known
      real(wp), intent(in) :: worst                !! larger factors say nothing more
      real(wp), intent(out) :: bound(2)
      real(wp) :: h, gap

      associate (v => store%v)
         h = hypotenuse(v(i, dyad%e_x) - v(i, dyad%s_x), v(i, dyad%e_y) - v(i, dyad%s_y))
         gap = s + e + h
         select case (dyad%kind)
         case (assur_rrr)
            call bounds_rrr(dyad, v(i, dyad%measure), s, e, worst, bound)
         case (assur_rpr, assur_rpr_guide_first)
            call bounds_rpr(dyad, v(i, dyad%unknown(2)), h, gap, worst, bound)
         case (assur_rrp, assur_prr)
            call bounds_rrp(dyad, v(i, dyad%measure), h, gap, direction, bound)
         case (assur_rpp, assur_ppr)
            call bounds_rpp(h, gap, direction, bound)
         case default
            call bounds_prp(v(i, dyad%measure), [v(i, dyad%slide_p), v(i, dyad%slide_q)], h, gap, direction, bound)
         end select
      end associate
   end subroutine bounds_of_dyad

   !> Distance of the outer joints at and below which they coincide and no direction is determined; negative: they cannot.
   pure real(wp) function coincidence_of(dyad, size) result(distance)
      type(dyad_t), intent(in) :: dyad
      real(wp), intent(in) :: size                 !! longest arc of the linkage, scaled as lengths are

      select case (dyad%kind)
      case (assur_rrr)
         distance = coincidence_rrr(dyad)
      case (assur_rpr, assur_rpr_guide_first)
         distance = coincidence_rpr(dyad, size)
      case default
         distance = -1.0_wp
      end select
   end function coincidence_of

   !> True if the limits of a kind's measure are those of its amount: a measure that changes its sign where the dyad is open.
   pure logical function is_signed(kind)
      integer, intent(in) :: kind

      is_signed = kind == assur_prp
   end function is_signed

   !> True if `solve_dyad` makes the point `tip` too.
   pure logical function makes_tip(dyad)
      type(dyad_t), intent(in) :: dyad

      makes_tip = dyad%kind == assur_rrr .and. .not. (dyad%wants_p .and. dyad%wants_q)
   end function makes_tip

   !> What is wrong at a position whose closure measure is not accepted; lengths scaled as those of the dyad.
   pure type(dyad_violation_t) function violation_of(dyad, measure, closes) result(violation)
      type(dyad_t), intent(in) :: dyad
      real(wp), intent(in) :: measure
      logical, intent(in) :: closes                !! only TANGLE or TOGGLE is violated

      select case (dyad%kind)
      case (assur_higher)
         violation = dyad_violation_t(merge(violation_none, violation_group, closes))
      case (assur_rrr)
         violation = violation_rrr(dyad, measure, closes)
      case (assur_rpr, assur_rpr_guide_first)
         violation = violation_rpr(dyad, measure, closes)
      case (assur_rrp, assur_prr)
         violation = violation_rrp(dyad, measure, closes)
      case default
         violation = violation_prp(measure, closes)
      end select
   end function violation_of

   !> Lengths with which the dyad is accepted at every position. Source: Oldham (1977), section 6.3.
   pure subroutine repair_dyad(kind, measure, tangle, toggle, vary, length, repaired)
      integer, intent(in) :: kind
      real(wp), intent(in) :: measure(:)           !! shape (positions), user's unit
      real(wp), intent(in) :: tangle, toggle       !! TANGLE, TOGGLE
      logical, intent(in) :: vary(2)               !! p, q: the length may change
      real(wp), intent(inout) :: length(2)         !! p, q
      logical, intent(out) :: repaired             !! false if nothing helps

      select case (kind)
      case (assur_rrr)
         call repair_rrr(measure, tangle, vary, length, repaired)
      case (assur_rpr, assur_rpr_guide_first)
         call repair_rpr(kind, measure, toggle, vary, length, repaired)
      case (assur_rrp, assur_prr)
         call repair_rrp(kind, measure, toggle, vary, length, repaired)
      case default
         repaired = .false.
      end select
   end subroutine repair_dyad
end module psalm_assur
