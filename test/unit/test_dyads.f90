!> Every dyad: the two arcs close the gap, keep their lengths, and lie on the side that the sign says.
program test_dyads
   use check, only: checks_t
   use psalm_assur, only: solve_dyad
   use psalm_dyad, only: dyad_t
   use psalm_dyad_kind, only: assur_rrr, assur_rpr, assur_rpr_guide_first, assur_rrp, assur_prr, assur_rpp, assur_ppr, assur_prp
   use psalm_kinds, only: wp
   use psalm_prp, only: solve_two_slides
   use psalm_random, only: random_t
   use psalm_rpp, only: project_on_slides
   use psalm_rows, only: rows_t, make_rows
   use psalm_rpr, only: solve_slide_on_q, solve_slide_on_p
   use psalm_rrp, only: solve_link_slide
   use psalm_rrr, only: solve_two_links, solve_one_link
   implicit none (type, external)
   integer, parameter :: n = 1003
   real(wp), parameter :: tolerance = 1.0e-13_wp
   type(checks_t) :: t
   type(random_t) :: random
   real(wp) :: sx(n), sy(n), ex(n), ey(n), hx(n), hy(n), ux(n), uy(n), vx(n), vy(n)
   real(wp) :: px(n), py(n), qx(n), qy(n), lp(n), lq(n), reach(n), root_x(n), root_y(n)
   real(wp), parameter :: c = 0.6_wp, s = 0.8_wp
   integer :: sense

   call points()
   do sense = -1, 1, 2
      call links(real(sense, wp))
      call slide_with_guide(real(sense, wp))
      call link_and_slide(real(sense, wp))
   end do
   call slides()
   call open_dyads()
   call nasty()
   do sense = -1, 1, 2
      call in_store(real(sense, wp))
   end do
   call t%report()

contains

   subroutine points()
      integer :: i
      real(wp) :: a

      do i = 1, n
         call random%next(sx(i))
         call random%next(sy(i))
         call random%next(hx(i))
         call random%next(hy(i))
         call random%next(a)
         root_x(i) = cos(6.0_wp*a)
         root_y(i) = sin(6.0_wp*a)
      end do
      hx = 0.5_wp + hx
      hy = hy - 0.5_wp
      ex = sx + hx
      ey = sy + hy
      hx = ex - sx
      hy = ey - sy
      ! a fixed angle from the root
      ux = c*root_x - s*root_y
      uy = c*root_y + s*root_x
   end subroutine points

   subroutine closes(ax, ay, a, bx, by, b, name)
      real(wp), intent(in) :: ax(n), ay(n), a(n), bx(n), by(n), b(n)
      character(*), intent(in) :: name

      call t%close_to(maxval(abs(a*ax + b*bx - hx)), 0.0_wp, tolerance, name//': p + q = h in x')
      call t%close_to(maxval(abs(a*ay + b*by - hy)), 0.0_wp, tolerance, name//': p + q = h in y')
   end subroutine closes

   subroutine unit(x, y, name)
      real(wp), intent(in) :: x(n), y(n)
      character(*), intent(in) :: name

      call t%close_to(maxval(abs(hypot(x, y) - 1.0_wp)), 0.0_wp, tolerance, name//': direction is a unit vector')
   end subroutine unit

   subroutine links(sign)
      real(wp), intent(in) :: sign
      real(wp), parameter :: p = 1.3_wp, q = 0.9_wp
      real(wp) :: side(n)

      call solve_two_links(n, sx, sy, ex, ey, p, q, sign, px, py, qx, qy, reach)
      call closes(px, py, spread(p, 1, n), qx, qy, spread(q, 1, n), 'type 1')
      call unit(px, py, 'type 1, p')
      call unit(qx, qy, 'type 1, q')
      side = px*hy - py*hx   ! positive: h lies left of p, the joint right of S -> E
      call t%is_true(all(side*sign > 0.0_wp), 'type 1: joint to the right of S -> E with a positive sign')
      call t%is_true(all(abs(reach - (hx**2 + hy**2)) < tolerance), 'type 1: reach is h**2')
   end subroutine links

   subroutine slide_with_guide(sign)
      real(wp), intent(in) :: sign
      real(wp), parameter :: guide = 0.3_wp

      call solve_slide_on_q(n, sx, sy, ex, ey, guide, sign, px, py, lp, reach)
      ! the guide's direction is the slide's turned by sign * 90
      call closes(px, py, lp, -sign*py, sign*px, spread(guide, 1, n), 'type 2')
      call unit(px, py, 'type 2')
      call t%is_true(all(lp >= 0.0_wp), 'type 2: the slide is positive')
      call t%is_true(all((px*hy - py*hx)*sign > 0.0_wp), 'type 2: side of the joint')
      call solve_slide_on_p(n, sx, sy, ex, ey, guide, sign, px, py, lq, reach)
      call closes(px, py, spread(guide, 1, n), -sign*py, sign*px, lq, 'type 3')
      call unit(px, py, 'type 3')
      call t%is_true(all(lq >= 0.0_wp), 'type 3: the slide is positive')
      call solve_slide_on_q(n, sx, sy, ex, ey, 0.0_wp, sign, px, py, lp, reach)
      call closes(px, py, lp, px, py, spread(0.0_wp, 1, n), 'type 2 with a guide of no length')
   end subroutine slide_with_guide

   subroutine link_and_slide(sign)
      real(wp), intent(in) :: sign
      real(wp), parameter :: link = 2.0_wp
      real(wp) :: along(n)

      call solve_link_slide(n, sx, sy, ex, ey, link, sign, root_x, root_y, c, s, px, py, lq, reach)
      call closes(px, py, spread(link, 1, n), ux, uy, lq, 'type 4')
      call unit(px, py, 'type 4')
      along = px*ux + py*uy
      call t%is_true(all(along*sign > 0.0_wp), 'type 4: the joint lies beyond the foot, along u, with a positive sign')
      call solve_link_slide(n, sx, sy, ex, ey, link, -sign, root_x, root_y, c, s, qx, qy, lp, reach)
      call closes(ux, uy, lp, qx, qy, spread(link, 1, n), 'type 5')
      call unit(qx, qy, 'type 5')
      along = -(qx*ux + qy*uy)
      call t%is_true(all(along*sign > 0.0_wp), 'type 5: the joint lies beyond the foot, along u, with a positive sign')
   end subroutine link_and_slide

   subroutine slides()
      call project_on_slides(n, sx, sy, ex, ey, root_x, root_y, c, s, -s, c, lp, lq, reach)
      call closes(ux, uy, lp, -uy, ux, lq, 'types 6 and 7')
      vx = root_y
      vy = -root_x
      call solve_two_slides(n, sx, sy, ex, ey, root_x, root_y, c, s, root_x, root_y, 0.0_wp, -1.0_wp, lp, lq, reach)
      call closes(ux, uy, lp, vx, vy, lq, 'type 8')
      call t%close_to(maxval(abs(reach - (ux*vy - uy*vx))), 0.0_wp, tolerance, 'type 8: reach is the sine from p to q')
   end subroutine slides

   !> What cannot close gives finite numbers and a reach that tells.
   subroutine open_dyads()
      call solve_two_links(n, sx, sy, ex, ey, 0.1_wp, 0.2_wp, 1.0_wp, px, py, qx, qy, reach)
      call t%is_true(all(reach > 0.3_wp**2), 'type 1: an open dyad is told by its reach')
      call t%is_true(all(abs(px) < 1.0e3_wp), 'type 1: an open dyad gives finite numbers')
      call solve_two_links(n, sx, sy, sx, sy, 1.0_wp, 1.0_wp, 1.0_wp, px, py, qx, qy, reach)
      call t%is_true(all(reach == 0.0_wp), 'type 1: S = E is told by a reach of zero')
      call t%is_true(all(abs(px) < huge(1.0_wp)), 'type 1: S = E gives finite numbers')
      call solve_slide_on_q(n, sx, sy, ex, ey, 9.0_wp, 1.0_wp, px, py, lp, reach)
      call t%is_true(all(reach < 81.0_wp) .and. all(lp == 0.0_wp), 'type 2: an open dyad has a slide of zero')
      call solve_two_slides(n, sx, sy, ex, ey, root_x, root_y, 1.0_wp, 0.0_wp, root_x, root_y, 1.0_wp, 0.0_wp, lp, lq, reach)
      call t%is_true(all(reach == 0.0_wp) .and. all(abs(lp) < huge(1.0_wp)), 'type 8: parallel slides are told')
   end subroutine open_dyads

   !> Any finite lengths and places, meeting joints, parallel slides: finite numbers.
   subroutine nasty()
      real(wp), parameter :: big = 2.0_wp**(maxexponent(1.0_wp)/8) !! the greatest length a linkage has inside
      integer, parameter :: many = 9
      real(wp) :: lengths(many), places(many), turn(many)
      integer :: i, a, b

      lengths = [tiny(1.0_wp)*epsilon(1.0_wp), tiny(1.0_wp), tiny(1.0_wp)**0.5_wp, tiny(1.0_wp)**0.25_wp, epsilon(1.0_wp)**2, &
                 1.0e-3_wp, 1.0_wp, 257.0_wp, big]
      places = lengths
      places(many) = 0.0_wp
      turn = [1.0_wp, 1.0_wp, 1.0_wp, epsilon(1.0_wp), 0.0_wp, 0.6_wp, 0.8_wp, -1.0_wp, -epsilon(1.0_wp)]
      do i = 1, n
         sx(i) = places(one_of(many))
         sy(i) = places(one_of(many))
         ex(i) = merge(sx(i), places(one_of(many)), modulo(i, 5) == 0)
         ey(i) = merge(sy(i), places(one_of(many)), modulo(i, 5) == 0)
         root_x(i) = merge(1.0_wp, 0.6_wp, modulo(i, 3) == 0)
         root_y(i) = merge(0.0_wp, 0.8_wp, modulo(i, 3) == 0)
         hx(i) = merge(root_x(i), turn(1 + modulo(i, many)), modulo(i, 2) == 0)
         hy(i) = merge(root_y(i), turn(1 + modulo(i + 3, many)), modulo(i, 2) == 0)
      end do
      do a = 1, many
         do b = 1, many
            call solve_two_links(n, sx, sy, ex, ey, lengths(a), lengths(b), 1.0_wp, px, py, qx, qy, reach)
            call finite(px, py, qx, qy, 'type 1')
            call solve_one_link(n, sx, sy, ex, ey, lengths(a), lengths(b), 1.0_wp, px, py, reach)
            call finite(px, py, reach, reach, 'type 1, one link')
         end do
         call solve_slide_on_q(n, sx, sy, ex, ey, lengths(a), -1.0_wp, px, py, lp, reach)
         call finite(px, py, lp, reach, 'type 2')
         call solve_slide_on_p(n, sx, sy, ex, ey, lengths(a), -1.0_wp, px, py, lq, reach)
         call finite(px, py, lq, reach, 'type 3')
         call solve_link_slide(n, sx, sy, ex, ey, lengths(a), 1.0_wp, root_x, root_y, 1.0_wp, 0.0_wp, px, py, lq, reach)
         call finite(px, py, lq, reach, 'types 4 and 5')
      end do
      call project_on_slides(n, sx, sy, ex, ey, root_x, root_y, 1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, lp, lq, reach)
      call finite(lp, lq, reach, reach, 'types 6 and 7')
      call solve_two_slides(n, sx, sy, ex, ey, root_x, root_y, 1.0_wp, 0.0_wp, hx, hy, 1.0_wp, 0.0_wp, lp, lq, reach)
      call finite(lp, lq, reach, reach, 'type 8')
   end subroutine nasty

   !> Rows of a store, both outer joints moving: whatever the kind, both arcs together lead from one to the other.
   subroutine in_store(sign)
      real(wp), intent(in) :: sign
      integer, parameter :: kinds(8) = [assur_rrr, assur_rpr, assur_rpr_guide_first, assur_rrp, assur_prr, assur_rpp, assur_ppr, &
                                        assur_prp]
      type(dyad_t) :: dyad
      type(rows_t) :: store
      integer :: k, i

      call points()
      do k = 1, size(kinds)
         call make_rows(n, 11, store)
         store%v(1:n, 1) = sx
         store%v(1:n, 2) = sy
         store%v(1:n, 3) = ex
         store%v(1:n, 4) = ey
         do i = 5, 7, 2      ! known directions: those of p and of q differ
            store%v(1:n, i) = merge(root_x, root_y, i == 5)
            store%v(1:n, i + 1) = merge(root_y, -root_x, i == 5)
         end do
         dyad = dyad_t(kind=kinds(k), s_x=1, s_y=2, e_x=3, e_y=4, p_x=5, p_y=6, q_x=7, q_y=8, measure=9, p=2.0_wp, q=1.9_wp, &
                       sign=sign)
         select case (kinds(k))
         case (assur_rpr)
            dyad%slide_p = 10
            dyad%q = 0.3_wp
            call at_right_angles(dyad)
         case (assur_rpr_guide_first)
            dyad%slide_q = 10
            dyad%p = 0.3_wp
            call at_right_angles(dyad)
         case (assur_rrp)
            dyad%slide_q = 10
            dyad%qx = c
            dyad%qy = s
         case (assur_prr)
            dyad%slide_p = 10
            dyad%px = c
            dyad%py = s
         case (assur_rpp, assur_ppr)
            dyad%slide_p = 10
            dyad%slide_q = 11
            call at_right_angles(dyad)
         case (assur_prp)
            dyad%slide_p = 10
            dyad%slide_q = 11
            dyad%px = c
            dyad%py = s
         end select
         call solve_dyad(n, dyad, store)
         px = dyad%px*store%v(1:n, dyad%p_x) - dyad%py*store%v(1:n, dyad%p_y)
         py = dyad%px*store%v(1:n, dyad%p_y) + dyad%py*store%v(1:n, dyad%p_x)
         qx = dyad%qx*store%v(1:n, dyad%q_x) - dyad%qy*store%v(1:n, dyad%q_y)
         qy = dyad%qx*store%v(1:n, dyad%q_y) + dyad%qy*store%v(1:n, dyad%q_x)
         lp = dyad%p
         if (dyad%slide_p > 0) lp = store%v(1:n, dyad%slide_p)
         lq = dyad%q
         if (dyad%slide_q > 0) lq = store%v(1:n, dyad%slide_q)
         call closes(px, py, lp, qx, qy, lq, 'kind '//achar(iachar('0') + kinds(k))//' in a store')
         if (dyad%kind == assur_rrr) call one_wanted(dyad, store)
      end do
   end subroutine in_store

   !> q is fixed to p, turned by the sign's right angle.
   subroutine at_right_angles(dyad)
      type(dyad_t), intent(inout) :: dyad

      dyad%q_x = dyad%p_x
      dyad%q_y = dyad%p_y
      dyad%qx = 0.0_wp
      dyad%qy = dyad%sign
   end subroutine at_right_angles

   !> Two links of which the direction of only one is wanted: the same as with both.
   subroutine one_wanted(dyad, store)
      type(dyad_t), intent(inout) :: dyad
      type(rows_t), intent(inout) :: store
      real(wp) :: both(n, 4)

      both = store%v(1:n, 5:8)
      store%v(1:n, 5:8) = 0.0_wp
      dyad%wants_q = .false.
      call solve_dyad(n, dyad, store)
      call t%close_to(maxval(abs(both(:, 1:2) - store%v(1:n, 5:6))), 0.0_wp, tolerance, 'type 1: p alone')
      dyad%wants_q = .true.
      dyad%wants_p = .false.
      call solve_dyad(n, dyad, store)
      call t%close_to(maxval(abs(both(:, 3:4) - store%v(1:n, 7:8))), 0.0_wp, tolerance, 'type 1: q alone')
   end subroutine one_wanted

   !> A number from 1 to `many`, drawn.
   integer function one_of(many)
      integer, intent(in) :: many
      real(wp) :: deviate

      call random%next(deviate)
      one_of = min(1 + int(deviate*real(many, wp)), many)
   end function one_of

   subroutine finite(a, b, c, d, name)
      real(wp), intent(in) :: a(n), b(n), c(n), d(n)
      character(*), intent(in) :: name

      call t%is_true(all(abs(a) <= huge(a)) .and. all(abs(b) <= huge(b)) .and. all(abs(c) <= huge(c)) .and. &
                     all(abs(d) <= huge(d)), name//': finite numbers for any lengths and places')
   end subroutine finite
end program test_dyads
