!> Random linkages: what is proven of them against an independent solver in quadruple precision.
!>
!> The solver works with angles, arc cosines and arc sines; no formula of it is one of the proof's. It looks at both ends of every
!> part, at random points of it and, by golden section, at the place where the least margin of a part that closes is least and
!> that of an open one greatest.
module linkage_campaign
   use psalm_dyad_kind, only: assur_prp, assur_ppr, assur_rpp, assur_rpr, assur_rpr_guide_first, assur_rrp, assur_prr, assur_rrr
   use psalm_kinds, only: wp, full_turn
   use psalm_plan, only: root_crank, root_frame, origin
   use psalm_proof, only: proof_t, limit_t, proof_linkage_t, ready_proof, prove_closure, touch_exact, piece_closes, piece_undecided
   use psalm_proof_plan, only: proof_plan_t, proof_step_t, complete_plan
   use psalm_proof_rates, only: rate_models_t, prepare_rates, evaluate_rates
   use psalm_quad, only: qp, unit_vector_quad
   use psalm_taylor, only: lanes
   use psalm_xoshiro, only: xoshiro_t
   implicit none (type, external)
   private
   public :: campaign, check_models, tally_t, draw_plain, draw_near_toggle, draw_round

   integer, parameter :: kinds(8) = [assur_rrr, assur_rpr, assur_rpr_guide_first, assur_rrp, assur_prr, assur_rpp, assur_ppr, &
                                     assur_prp]
   integer, parameter :: most_dyads = 6, capacity = 64
   integer, parameter :: draw_plain = 1, draw_near_toggle = 2, draw_round = 3  !! how dimensions are drawn
   real(wp), parameter :: narrow = 1.0e-15_wp            !! of the range: what a bracket may be wide
   real(qp), parameter :: slack = 1.0e-28_qp             !! of the solver itself
   real(qp), parameter :: least_sine = real(1.0e-6_wp, qp)  ! as the proof has it
   integer, parameter :: golden_steps = 40
   real(qp), parameter :: golden = 0.6180339887498948482_qp
   real(qp), parameter :: radians = 0.017453292519943295769236907684886127134_qp

   !> What came of a campaign.
   type :: tally_t
      integer :: linkages = 0, everywhere = 0  !! drawn; proven to close over the whole range
      integer :: ends = 0, touches = 0         !! brackets between closing and open; exact touches
      integer :: undecided = 0, fine = 0       !! linkages with another bracket; that needed quadruple precision
      integer :: untrue = 0                    !! parts of which something else is true
      real(wp) :: checks = 0.0_wp              !! positions looked at
   end type tally_t

   !> A linkage drawn at random: the plan, and its dimensions by arc.
   type :: drawn_t
      type(proof_plan_t) :: plan
      real(wp) :: length(capacity) = 0.0_wp, angle(capacity) = 0.0_wp  !! degrees from the root
      integer :: arcs = 0, points = 0
   end type drawn_t

contains

   !> Prove and check some linkages of one sort.
   subroutine campaign(mode, first, linkages, points, tally)
      integer, intent(in) :: mode                  !! one of `draw_...`
      integer, intent(in) :: first, linkages       !! number of the first one, how many
      integer, intent(in) :: points                !! looked at in each part, besides its ends and its narrowest place
      type(tally_t), intent(out) :: tally
      type(xoshiro_t) :: stream
      type(drawn_t) :: drawn
      type(proof_linkage_t) :: linkage
      type(proof_t) :: proof
      integer :: n, i
      real(qp) :: worst
      logical :: undecided

      tally%linkages = linkages
      do n = first, first + linkages - 1
         call stream%seed(n, mode)
         call draw(stream, mode, drawn)
         call ready_proof(drawn%plan, drawn%length(:drawn%arcs), drawn%angle(:drawn%arcs), linkage)
         call prove_closure(linkage, merge(0.5_wp, 0.0_wp, drawn%plan%sliding_input), &
                            merge(4.0_wp, full_turn, drawn%plan%sliding_input), proof)
         if (proof%closes_everywhere()) tally%everywhere = tally%everywhere + 1
         if (proof%fine_boxes > 0) tally%fine = tally%fine + 1
         undecided = .false.
         do i = 1, size(proof%limits)
            associate (limit => proof%limits(i))
               if (limit%kind /= piece_undecided) then
                  call check_part(stream, drawn, limit, points, tally%checks, worst)
                  if (worst >= -slack) cycle
                  tally%untrue = tally%untrue + 1
                  print '(a,i0,a,i0,3(1x,es24.16))', 'UNTRUE: sort ', mode, ', linkage ', n, limit%from, limit%to, worst
               else if (i == 1 .or. i == size(proof%limits)) then
                  undecided = .true.
               else if (limit%touch == touch_exact .and. proof%limits(i - 1)%kind == proof%limits(i + 1)%kind) then
                  tally%touches = tally%touches + 1
               else if (same(proof%limits(i - 1), proof%limits(i + 1))) then
                  undecided = .true.
               else if (limit%to - limit%from > narrow*(proof%to - proof%from)) then
                  undecided = .true.
               else
                  tally%ends = tally%ends + 1
               end if
            end associate
         end do
         if (undecided) tally%undecided = tally%undecided + 1
      end do
   end subroutine campaign

   !> True for parts of which the same is claimed: what lies between them is no end.
   pure logical function same(before, after)
      type(limit_t), intent(in) :: before, after

      same = before%kind == after%kind .and. before%loop == after%loop .and. before%cause == after%cause
   end function same

   !> Count directions and slides, and the rates of both, that lie outside their models over random boxes.
   !>
   !> The rates by differences of the solver's angles and lengths.
   subroutine check_models(mode, first, linkages, outside, inside)
      integer, intent(in) :: mode, first, linkages
      integer, intent(out) :: outside, inside
      integer, parameter :: samples = 3
      real(qp), parameter :: step = 1.0e-9_qp      !! degrees or length
      real(wp), parameter :: coarse = 1.0e-11_wp   !! error of a difference, relative to the rate or 1
      type(rate_models_t) :: rates
      type(xoshiro_t) :: stream
      type(drawn_t) :: drawn
      type(proof_linkage_t) :: linkage
      real(wp) :: m(lanes), r(lanes)
      real(qp), dimension(capacity) :: directions, lengths, before, before_length, after, after_length
      real(qp) :: s, x, y, at, rate, unit
      integer :: n, i, j, k

      outside = 0
      inside = 0
      do n = first, first + linkages - 1
         call stream%seed(n, mode)
         call draw(stream, mode, drawn)
         call ready_proof(drawn%plan, drawn%length(:drawn%arcs), drawn%angle(:drawn%arcs), linkage)
         do i = 1, lanes
            m(i) = uniform(stream, 0.0_wp, merge(4.0_wp, full_turn, drawn%plan%sliding_input))
            r(i) = merge(0.2_wp, 22.5_wp, drawn%plan%sliding_input)*10.0_wp**uniform(stream, -8.0_wp, 0.0_wp)
         end do
         call prepare_rates(linkage%plan, linkage%numbers, rates)
         call evaluate_rates(linkage%plan, linkage%numbers, m, r, rates)
         unit = merge(1.0_qp, radians, drawn%plan%sliding_input)
         do i = 1, lanes
            do j = 1, samples
               s = real(uniform(stream, -1.0_wp, 1.0_wp), qp)
               at = real(m(i), qp) + s*real(r(i), qp)
               if (least_margin(drawn, at, directions, lengths) <= 0.0_qp) cycle
               do k = root_crank + 1, drawn%plan%nroots
                  call unit_vector_quad(directions(k), x, y)
                  associate (models => rates%base)
                     call assess(abs(cmplx(value_at(models%root(i, :, 1, k)) - x, value_at(models%root(i, :, 2, k)) - y, qp)), &
                                models%root_e(i, k))
                  end associate
               end do
               do k = 1, drawn%plan%nlengths
                  call assess(abs(value_at(rates%base%slide(i, :, k)) - lengths(k)*real(linkage%numbers%scale, qp)), &
                             rates%base%slide_e(i, k))
               end do
               if (least_margin(drawn, at - step, before, before_length) <= 1.0e-4_qp) cycle
               if (least_margin(drawn, at + step, after, after_length) <= 1.0e-4_qp) cycle
               do k = root_crank + 1, drawn%plan%nroots
                  rate = after(k) - before(k)
                  rate = (rate - 360.0_qp*anint(rate/360.0_qp))*radians/(2.0_qp*step*unit)
                  call assess(abs(value_at(rates%turn(i, :, k)) - rate), &
                             rates%turn_e(i, k) + coarse*(1.0_wp + real(abs(rate), wp)))
               end do
               do k = 1, drawn%plan%nlengths
                  rate = (after_length(k) - before_length(k))*real(linkage%numbers%scale, qp)/(2.0_qp*step*unit)
                  call assess(abs(value_at(rates%slide(i, :, k)) - rate), &
                             rates%slide_e(i, k) + coarse*(1.0_wp + real(abs(rate), wp)))
               end do
            end do
         end do
      end do

   contains

      subroutine assess(miss, radius)
         real(qp), intent(in) :: miss
         real(wp), intent(in) :: radius

         if (miss > real(radius, qp) + slack) then
            outside = outside + 1
         else
            inside = inside + 1
         end if
      end subroutine assess

      real(qp) function value_at(p)
         real(wp), intent(in) :: p(0:)
         integer :: d

         value_at = 0.0_qp
         do d = ubound(p, 1), 0, -1
            value_at = value_at*s + real(p(d), qp)
         end do
      end function value_at
   end subroutine check_models

   !> A random number between two others.
   real(wp) function uniform(stream, low, high)
      type(xoshiro_t), intent(inout) :: stream
      real(wp), intent(in) :: low, high

      call stream%next(uniform)
      uniform = low + (high - low)*uniform
   end function uniform

   !> A random number of 1 to n.
   integer function choice(stream, n)
      type(xoshiro_t), intent(inout) :: stream
      integer, intent(in) :: n

      choice = min(n, 1 + int(uniform(stream, 0.0_wp, real(n, wp))))
   end function choice

   ! ---- drawing -----------------------------------------------------------------------------------------------------

   real(wp) function some_length(stream, mode)
      type(xoshiro_t), intent(inout) :: stream
      integer, intent(in) :: mode

      some_length = uniform(stream, 0.3_wp, 4.0_wp)
      if (mode == draw_round) some_length = 0.5_wp*real(choice(stream, 8), wp)
   end function some_length

   real(wp) function some_angle(stream, mode)
      type(xoshiro_t), intent(inout) :: stream
      integer, intent(in) :: mode

      some_angle = uniform(stream, -180.0_wp, 180.0_wp)
      if (mode == draw_round) some_angle = 15.0_wp*real(choice(stream, 24), wp)
   end function some_angle

   !> A linkage of one to six dyads.
   subroutine draw(stream, mode, drawn)
      type(xoshiro_t), intent(inout) :: stream
      integer, intent(in) :: mode
      type(drawn_t), intent(out) :: drawn
      integer :: dyads, k, from, to, kind
      real(wp) :: miss

      drawn%plan%nroots = 2
      drawn%plan%sliding_input = mode == draw_plain .and. uniform(stream, 0.0_wp, 1.0_wp) < 0.15_wp
      allocate (drawn%plan%steps(0), drawn%plan%root(capacity), drawn%plan%slot(capacity))
      drawn%plan%root = root_frame
      drawn%plan%slot = 0
      call add_arc(stream, drawn, mode, origin, merge(root_frame, root_crank, drawn%plan%sliding_input))
      if (drawn%plan%sliding_input) then
         drawn%plan%nlengths = 1
         drawn%plan%input_slot = 1
         drawn%plan%slot(1) = 1
      else
         drawn%angle(1) = 0.0_wp
         drawn%length(1) = 0.5_wp*drawn%length(1)
         if (mode == draw_round) drawn%length(1) = 0.5_wp*real(choice(stream, 4), wp)
      end if
      dyads = choice(stream, most_dyads)
      do k = 1, dyads
         from = choice(stream, drawn%points)
         kind = kinds(choice(stream, size(kinds)))
         if (uniform(stream, 0.0_wp, 1.0_wp) < 0.5_wp) kind = assur_rrr
         if (mode == draw_near_toggle .and. k == 1) kind = assur_rrr
         if (drawn%points > 1 .and. uniform(stream, 0.0_wp, 1.0_wp) < 0.3_wp) then
            do
               to = choice(stream, drawn%points)
               if (to /= from) exit
            end do
         else
            call add_arc(stream, drawn, mode, origin, root_frame)
            to = drawn%points
         end if
         call add_dyad(stream, drawn, mode, kind, k, from, to)
         if (mode == draw_near_toggle .and. k == 1) then
            ! crank 1, frame 2, links 3 and 4: they miss being in one line by little
            miss = 10.0_wp**(-uniform(stream, 2.0_wp, 17.0_wp))*sign(1.0_wp, uniform(stream, -1.0_wp, 1.0_wp))
            drawn%length(2) = drawn%length(1) + uniform(stream, 0.5_wp, 3.0_wp)
            if (uniform(stream, 0.0_wp, 1.0_wp) < 0.5_wp) then
               drawn%length(3) = uniform(stream, 0.6_wp, 1.2_wp)*drawn%length(2)
               drawn%length(4) = (drawn%length(1) + drawn%length(2) - drawn%length(3))*(1.0_wp + miss)
            else
               drawn%length(3) = uniform(stream, 1.0_wp, 2.0_wp)*drawn%length(2)
               drawn%length(4) = (drawn%length(3) + (drawn%length(2) - drawn%length(1)))*(1.0_wp + miss)
            end if
         end if
      end do
      call complete_plan(drawn%plan)
   end subroutine draw

   !> An arc from a point, fixed to a root, and the point at its end.
   subroutine add_arc(stream, drawn, mode, from, root)
      type(xoshiro_t), intent(inout) :: stream
      type(drawn_t), intent(inout) :: drawn
      integer, intent(in) :: mode, from, root
      type(proof_step_t) :: step

      drawn%arcs = drawn%arcs + 1
      drawn%points = drawn%points + 1
      drawn%length(drawn%arcs) = some_length(stream, mode)
      drawn%angle(drawn%arcs) = some_angle(stream, mode)
      drawn%plan%root(drawn%arcs) = root
      step%from = from
      step%to = drawn%points
      step%arc = drawn%arcs
      step%sense = 1
      step%fixed = root == root_frame .and. from == origin
      if (drawn%arcs == 1) step%fixed = .false.
      drawn%plan%steps = [drawn%plan%steps, step]
   end subroutine add_arc

   !> A dyad between two points, its middle joint and a point on its link.
   subroutine add_dyad(stream, drawn, mode, kind, loop, from, to)
      type(xoshiro_t), intent(inout) :: stream
      type(drawn_t), intent(inout) :: drawn
      integer, intent(in) :: mode, kind, loop, from, to
      type(proof_step_t) :: step, middle
      integer :: arc, found(2), known

      step%dyad = .true.
      step%kind = kind
      step%loop = loop
      step%sign = 2*choice(stream, 2) - 3
      step%from = from
      step%to = to
      step%p = drawn%arcs + 1
      step%q = drawn%arcs + 2
      step%wants = .true.
      drawn%arcs = drawn%arcs + 2
      do arc = step%p, step%q
         drawn%length(arc) = some_length(stream, mode)
         drawn%angle(arc) = 0.0_wp
      end do
      known = root_frame
      if (uniform(stream, 0.0_wp, 1.0_wp) < 0.3_wp) known = choice(stream, drawn%plan%nroots)
      if (drawn%plan%sliding_input) known = merge(root_frame, known, known == root_crank)
      found = 0
      associate (root => drawn%plan%root, slot => drawn%plan%slot, angle => drawn%angle)
         select case (kind)
         case (assur_rrr)
            found = [1, 1]
         case (assur_rpr)
            found(1) = 1
            call slides(1)
            angle(step%q) = 90.0_wp*real(step%sign, wp)
            drawn%length(step%q) = 0.5_wp*drawn%length(step%q)
         case (assur_rpr_guide_first)
            found(1) = 1
            call slides(2)
            angle(step%q) = 90.0_wp*real(step%sign, wp)
            drawn%length(step%p) = 0.5_wp*drawn%length(step%p)
         case (assur_rrp)
            found(1) = 1
            call slides(2)
            root(step%q) = known
            angle(step%q) = some_angle(stream, mode)
         case (assur_prr)
            found(2) = 1
            call slides(1)
            root(step%p) = known
            angle(step%p) = some_angle(stream, mode)
         case (assur_rpp, assur_ppr)
            call slides(1)
            call slides(2)
            root([step%p, step%q]) = known
            angle(step%p) = some_angle(stream, mode)
            angle(step%q) = angle(step%p) + 90.0_wp
         case default
            call slides(1)
            call slides(2)
            root([step%p, step%q]) = [known, root_frame]
            angle(step%p) = some_angle(stream, mode)
            angle(step%q) = some_angle(stream, mode)
         end select
         if (found(1) > 0) then
            drawn%plan%nroots = drawn%plan%nroots + 1
            root(step%p) = drawn%plan%nroots
            if (kind == assur_rpr .or. kind == assur_rpr_guide_first) root(step%q) = root(step%p)
         end if
         if (found(2) > 0) then
            drawn%plan%nroots = drawn%plan%nroots + 1
            root(step%q) = drawn%plan%nroots
         end if
      end associate
      drawn%plan%steps = [drawn%plan%steps, step]
      ! the middle joint, by way of p
      drawn%points = drawn%points + 1
      middle%from = from
      middle%to = drawn%points
      middle%arc = step%p
      drawn%plan%steps = [drawn%plan%steps, middle]
      if (found(1) > 0) then
         call add_arc(stream, drawn, mode, from, drawn%plan%root(step%p))
      else if (found(2) > 0) then
         call add_arc(stream, drawn, mode, to, drawn%plan%root(step%q))
      end if

   contains

      subroutine slides(which)
         integer, intent(in) :: which

         drawn%plan%nlengths = drawn%plan%nlengths + 1
         drawn%plan%slot(merge(step%p, step%q, which == 1)) = drawn%plan%nlengths
      end subroutine slides
   end subroutine add_dyad

   ! ---- checking ----------------------------------------------------------------------------------------------------

   !> Look at a part of the range.
   subroutine check_part(stream, drawn, limit, points, checks, worst)
      type(xoshiro_t), intent(inout) :: stream
      type(drawn_t), intent(in) :: drawn
      type(limit_t), intent(in) :: limit
      integer, intent(in) :: points
      real(wp), intent(inout) :: checks
      real(qp), intent(out) :: worst               !! least of what ought not to be negative
      real(qp) :: from, to, at, value, worst_at, low, high, a, b, fa, fb
      integer :: i

      from = real(limit%from, qp)
      to = real(limit%to, qp)
      worst = huge(worst)
      worst_at = from
      do i = -1, points
         at = from
         if (i == 0) at = to
         if (i > 0) at = from + (to - from)*real(uniform(stream, 0.0_wp, 1.0_wp), qp)
         value = towards(at)
         if (value < worst) then
            worst = value
            worst_at = at
         end if
      end do
      low = max(from, worst_at - (to - from)/real(max(points, 1), qp))
      high = min(to, worst_at + (to - from)/real(max(points, 1), qp))
      a = high - golden*(high - low)
      b = low + golden*(high - low)
      fa = towards(a)
      fb = towards(b)
      do i = 1, golden_steps
         if (fa < fb) then
            high = b
            b = a
            fb = fa
            a = high - golden*(high - low)
            fa = towards(a)
         else
            low = a
            a = b
            fa = fb
            b = low + golden*(high - low)
            fb = towards(b)
         end if
         worst = min(worst, fa, fb)
      end do

   contains

      !> What ought not to be negative.
      real(qp) function towards(at)
         real(qp), intent(in) :: at

         checks = checks + 1.0_wp
         towards = merge(1.0_qp, -1.0_qp, limit%kind == piece_closes)*least_margin(drawn, at)
      end function towards
   end subroutine check_part

   !> Least margin of closure of the dyads up to the first that is open, by angles.
   real(qp) function least_margin(drawn, input, directions, lengths)
      type(drawn_t), intent(in) :: drawn
      real(qp), intent(in) :: input          !! degrees, or length
      real(qp), intent(out), optional :: directions(capacity), lengths(capacity) !! of roots, degrees; of slides
      complex(qp) :: point(0:capacity), h
      real(qp) :: direction(capacity), length(capacity), scale_of, phi, d, p, q, u, v, c, s, margin
      integer :: i

      direction = 0.0_qp                     ! of roots, degrees
      if (.not. drawn%plan%sliding_input) direction(root_crank) = input
      length = 0.0_qp
      if (drawn%plan%sliding_input) length(1) = input
      point = 0.0_qp
      least_margin = huge(least_margin)
      scale_of = 4.0_qp
      do i = 1, size(drawn%plan%steps)
         associate (step => drawn%plan%steps(i))
            if (.not. step%dyad) then
               d = real(drawn%length(step%arc), qp)
               if (drawn%plan%slot(step%arc) > 0) d = length(drawn%plan%slot(step%arc))
               point(step%to) = point(step%from) + polar(d, angle_of(step%arc))
               cycle
            end if
            h = point(step%to) - point(step%from)
            d = abs(h)
            phi = atan2(aimag(h), real(h, qp))/radians
            p = real(drawn%length(step%p), qp)
            q = real(drawn%length(step%q), qp)
            s = real(step%sign, qp)
            margin = 1.0_qp
            select case (step%kind)
            case (assur_rrr)
               margin = min(p + q - d, d - abs(p - q))/scale_of
               if (margin > 0.0_qp) then
                  u = phi - s*degrees_acos((p*p + d*d - q*q)/(2.0_qp*p*d))
                  h = h - polar(p, u)
                  direction(drawn%plan%root(step%p)) = u
                  direction(drawn%plan%root(step%q)) = atan2(aimag(h), real(h, qp))/radians
               end if
            case (assur_rpr)
               margin = (d - q)/scale_of
               if (margin > 0.0_qp) then
                  direction(drawn%plan%root(step%p)) = phi - s*(90.0_qp - degrees_acos(q/d))
                  length(drawn%plan%slot(step%p)) = d*sin(acos(q/d))
               end if
            case (assur_rpr_guide_first)
               margin = (d - p)/scale_of
               if (margin > 0.0_qp) then
                  direction(drawn%plan%root(step%p)) = phi - s*degrees_acos(p/d)
                  length(drawn%plan%slot(step%q)) = d*sin(acos(p/d))
               end if
            case (assur_rrp)
               call link_on_slide(angle_of(step%q), p, s, direction(drawn%plan%root(step%p)), length(drawn%plan%slot(step%q)))
            case (assur_prr)
               call link_on_slide(angle_of(step%p), q, -s, direction(drawn%plan%root(step%q)), length(drawn%plan%slot(step%p)))
            case (assur_rpp, assur_ppr)
               length(drawn%plan%slot(step%p)) = d*cos((phi - angle_of(step%p))*radians)
               length(drawn%plan%slot(step%q)) = d*cos((phi - angle_of(step%q))*radians)
            case default
               u = angle_of(step%p)
               v = angle_of(step%q)
               c = sin((v - u)*radians)
               margin = abs(c) - least_sine
               if (margin > 0.0_qp) then
                  length(drawn%plan%slot(step%p)) = d*sin((v - phi)*radians)/c
                  length(drawn%plan%slot(step%q)) = d*sin((phi - u)*radians)/c
               end if
            end select
            least_margin = min(least_margin, margin)
            if (margin <= 0.0_qp) return
         end associate
      end do
      if (present(directions)) directions = direction
      if (present(lengths)) lengths = length

   contains

      real(qp) function angle_of(arc)
         integer, intent(in) :: arc

         angle_of = direction(drawn%plan%root(arc)) + real(drawn%angle(arc), qp)
      end function angle_of

      complex(qp) function polar(size, angle)
         real(qp), intent(in) :: size, angle
         real(qp) :: x, y

         call unit_vector_quad(angle, x, y)
         polar = cmplx(size*x, size*y, qp)
      end function polar

      real(qp) function degrees_acos(cosine)
         real(qp), intent(in) :: cosine

         degrees_acos = acos(max(-1.0_qp, min(1.0_qp, cosine)))/radians
      end function degrees_acos

      !> A link of a given length and the slide it reaches, along the direction `along`.
      subroutine link_on_slide(along, link, sense, found, slide)
         real(qp), intent(in) :: along, link, sense
         real(qp), intent(inout) :: found, slide
         real(qp) :: offset, turn

         offset = d*sin((phi - along)*radians)
         margin = (link - abs(offset))/scale_of
         if (margin <= 0.0_qp) return
         turn = asin(offset/link)/radians
         if (sense < 0.0_qp) turn = 180.0_qp - turn
         found = along + turn
         slide = d*cos((phi - along)*radians) - link*cos(turn*radians)
      end subroutine link_on_slide
   end function least_margin
end module linkage_campaign
