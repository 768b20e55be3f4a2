!> What everything else uses: marks of runs, rows of the store, kinds of dyads, kernels of arcs, orders.
program test_foundation
   use, intrinsic :: iso_c_binding, only: c_intptr_t, c_loc
   use check, only: checks_t
   use psalm_arc_kernels, only: add_arc_rate, arc_vector, invert_columns, solve_columns
   use psalm_dyad_kind, only: assur_none, assur_ppr, assur_prp, assur_prr, assur_rpp, assur_rpr, assur_rpr_guide_first, assur_rrp, &
                              assur_rrr, direction_found, form_of, form_t, kind_of_dyad, sign_of_dyad
   use psalm_kinds, only: wp
   use psalm_mark, only: mark_t, mark_width
   use psalm_rows, only: rows_t, make_rows
   use psalm_sort, only: ascending, pool_rising
   use psalm_status, only: diagnostics_t, exit_bad_input, exit_file_error
   use psalm_text, only: to_text
   implicit none (type, external)
   type(checks_t) :: t

   call marks()
   call findings()
   call rows()
   call kinds_of_dyads()
   call arcs()
   call matrices()
   call orders()
   call pools()
   call t%report()

contains

   subroutine marks()
      type(mark_t) :: none, one, same, split

      call one%add('LINKS')
      call same%add('LINKS')
      call split%add('LIN')
      call split%add('KS')
      ! FNV-1a of nothing is its offset
      call t%equal_text(none%name(), 'CBF29CE484222325', 'the mark of nothing')
      call t%is_true(one%name() == same%name() .and. verify(one%name(), '0123456789ABCDEF') == 0, 'equal input, equal mark')
      call t%is_true(one%name() /= split%name(), 'where a text ends counts')
      call t%equal_integer(len(one%name()), mark_width, 'width of a mark')
   end subroutine marks

   !> Findings in words, with and without their place; more of them than are reported.
   subroutine findings()
      type(diagnostics_t) :: some, many, fresh
      integer :: i
      integer, parameter :: reported = 200, more = 57

      call some%error('no place')
      call t%equal_text(some%list(1)%render(), 'error: no place', 'a finding without a file')
      some%file = 'a.nml'
      call some%warning('a place', line=3, group='LINKS', item='ILINK')
      call t%equal_text(some%list(2)%render(), 'a.nml:3: warning: &LINKS ILINK: a place', 'a finding with its place')
      call some%warning('a group', group='LINKS')
      call t%equal_text(some%list(3)%render(), 'a.nml: warning: &LINKS: a group', 'a finding of a group')
      call t%equal_integer(some%exit_code(), exit_bad_input, 'an error, no trouble with files')
      ! each of another kind, so that none stands for others
      do i = 1, reported + more
         call many%warning('odd', item='I'//to_text(i))
      end do
      call t%equal_integer(many%count, reported, 'findings that are told')
      ! the last that is reported gives its place up
      call t%equal_text(many%list(reported)%render(), 'warning: and '//to_text(more + 1)//' more', 'how many are not')
      call t%is_true(.not. many%failed(), 'warnings only')
      call many%failure('no room')
      call t%equal_integer(many%exit_code(), exit_file_error, 'an error among those that are not told counts')
      many = fresh
      do i = 1, reported + more
         if (i == reported) call many%error('wrong')
         call many%warning('odd', item='I'//to_text(i))
      end do
      call t%is_true(many%failed(), 'an error that gives its place up counts')
   end subroutine findings

   subroutine rows()
      type(rows_t), target :: store
      integer(c_intptr_t) :: address
      integer, parameter :: capacity = 21, count = 5
      integer :: row
      logical :: aligned

      call make_rows(capacity, count, store)
      call t%is_true(lbound(store%v, 1) <= 1 .and. ubound(store%v, 1) >= capacity .and. size(store%v, 2) == count, &
                     'room for all positions')
      call t%is_true(all(abs(store%v) <= 0.0_wp), 'rows begin with zeros')
      aligned = .true.
      do row = 1, count
         address = transfer(c_loc(store%v(1, row)), address)
         aligned = aligned .and. modulo(address, 64_c_intptr_t) == modulo(transfer(c_loc(store%v(1, 1)), address), 64_c_intptr_t)
      end do
      call t%is_true(aligned, 'if one row begins on a cache line, all do')
   end subroutine rows

   !> What slides and what guides what decides the kind; a kind finds two unknowns.
   subroutine kinds_of_dyads()
      type(form_t) :: form
      integer :: kind, unknowns

      call t%equal_integer(kind_of_dyad([.false., .false.], [.false., .false.]), assur_rrr, 'two links')
      call t%equal_integer(kind_of_dyad([.true., .false.], [.true., .false.]), assur_rpr, 'a slide guided by the link after it')
      call t%equal_integer(kind_of_dyad([.false., .true.], [.false., .true.]), assur_rpr_guide_first, &
                           'a slide guided by the link before it')
      call t%equal_integer(kind_of_dyad([.false., .true.], [.false., .false.]), assur_rrp, 'link and slide')
      call t%equal_integer(kind_of_dyad([.true., .false.], [.false., .false.]), assur_prr, 'slide and link')
      call t%equal_integer(kind_of_dyad([.true., .true.], [.true., .false.]), assur_rpp, 'a slide guided by a slide')
      call t%equal_integer(kind_of_dyad([.true., .true.], [.false., .true.]), assur_ppr, 'the same, the other way round')
      call t%equal_integer(kind_of_dyad([.true., .true.], [.false., .false.]), assur_prp, 'two slides of known directions')
      call t%equal_integer(kind_of_dyad([.true., .true.], [.true., .true.]), assur_none, 'two slides that guide each other')
      do kind = assur_rrr, assur_prp
         form = form_of(kind)
         unknowns = count(form%slides) + count(form%direction == direction_found)
         call t%equal_integer(unknowns, 2, 'a dyad finds two unknowns')
      end do
      call t%equal_integer(sign_of_dyad(assur_rrr, -1, -1, 1, 1), -1, 'the sign of ILINK is the assembly of two links')
      call t%equal_integer(sign_of_dyad(assur_prr, -1, 1, 1, 1), 1, 'slide and link: the sign of the link')
      call t%equal_integer(sign_of_dyad(assur_rpr, 1, 1, 1, -1), -1, 'a slide before its guide')
      call t%equal_integer(sign_of_dyad(assur_rpr_guide_first, 1, 1, -1, 1), 1, 'a slide behind its guide')
      call t%equal_integer(sign_of_dyad(assur_prp, -1, -1, -1, -1), 1, 'two slides have one assembly')
   end subroutine kinds_of_dyads

   !> Derivatives of an arc L(t) e(t) against those of its Taylor series, multiplied out.
   subroutine arcs()
      integer, parameter :: n = 3
      real(wp) :: w(n, 3), l(n, 0:3), ex(n), ey(n), ax(n), ay(n), zero(n), tx(n), ty(n), c, s
      complex(wp) :: unit, series(0:3), z(0:3), arc(0:3)
      integer :: i, j, k, order
      real(wp), parameter :: factorial(0:3) = [1.0_wp, 1.0_wp, 2.0_wp, 6.0_wp]

      zero = 0.0_wp
      w = reshape([0.7_wp, -1.1_wp, 0.2_wp, 0.3_wp, 0.9_wp, -2.0_wp, -0.5_wp, 0.4_wp, 1.3_wp], [n, 3])
      l = reshape([2.0_wp, 1.0_wp, 0.5_wp, 0.6_wp, -0.4_wp, 0.0_wp, 1.5_wp, 0.1_wp, -0.8_wp, 0.9_wp, -1.2_wp, 0.3_wp], [n, 4])
      c = cos(0.4_wp)
      s = sin(0.4_wp)
      call arc_vector(n, [1.0_wp, 0.0_wp, 0.6_wp], [0.0_wp, 1.0_wp, 0.8_wp], c, s, l(:, 0), ex, ey, ax, ay)
      call t%close_to(ex(2), -s, 4.0_wp*epsilon(1.0_wp), 'a root turned by a fixed angle, x')
      call t%close_to(ey(2), c, 4.0_wp*epsilon(1.0_wp), 'a root turned by a fixed angle, y')
      call t%is_true(all(abs(ax - l(:, 0)*ex) + abs(ay - l(:, 0)*ey) <= 0.0_wp), 'vector is length times unit vector')
      do i = 1, n
         unit = cmplx(ex(i), ey(i), wp)
         ! exp(i (w1 t + w2 t^2/2 + w3 t^3/6)) by powers of its exponent
         z = [(0.0_wp, 0.0_wp), (cmplx(0.0_wp, w(i, j)/factorial(j), wp), j=1, 3)]
         series = [cmplx(1.0_wp, 0.0_wp, wp), z(1), z(2) + z(1)**2/2.0_wp, z(3) + z(1)*z(2) + z(1)**3/6.0_wp]
         arc = (0.0_wp, 0.0_wp)
         do j = 0, 3
            do k = 0, 3 - j
               arc(j + k) = arc(j + k) + l(i, j)/factorial(j)*series(k)*unit
            end do
         end do
         do order = 1, 3
            call add_arc_rate(n, order, -2.0_wp, zero, zero, ex, ey, l(:, 0), w(:, 1), w(:, 2), w(:, 3), l(:, 1), &
                              l(:, 2), l(:, 3), tx, ty)
            call t%close_to(tx(i), -2.0_wp*factorial(order)*real(arc(order), wp), 1.0e3_wp*epsilon(1.0_wp), 'an arc, x')
            call t%close_to(ty(i), -2.0_wp*factorial(order)*aimag(arc(order)), 1.0e3_wp*epsilon(1.0_wp), 'an arc, y')
         end do
      end do
   end subroutine arcs

   !> The inverse of two columns undoes them; parallel columns have none.
   subroutine matrices()
      integer, parameter :: n = 3
      real(wp), dimension(n) :: c1x, c1y, c2x, c2y, m11, m12, m21, m22, sine2, x1, x2
      integer :: i

      c1x = [2.0_wp, 1.0e100_wp, 1.0_wp]
      c1y = [0.5_wp, 0.0_wp, 2.0_wp]
      c2x = [-1.0_wp, 1.0_wp, 2.0_wp]
      c2y = [3.0_wp, 1.0_wp, 4.0_wp]
      call invert_columns(n, 1.0e-10_wp, c1x, c1y, c2x, c2y, m11, m12, m21, m22, sine2)
      call solve_columns(n, m11, m12, m21, m22, 3.0_wp*c1x - 2.0_wp*c2x, 3.0_wp*c1y - 2.0_wp*c2y, x1, x2)
      call t%close_to(x1(1), 3.0_wp, 1.0e-14_wp, 'coefficient of the first column')
      call t%close_to(x2(1), -2.0_wp, 1.0e-14_wp, 'coefficient of the second column')
      call t%close_to(x1(2), 3.0_wp, 1.0e-14_wp, 'columns of very different lengths')
      call t%close_to(sine2(1), 42.25_wp/(4.25_wp*10.0_wp), 1.0e-14_wp, 'square of the sine between the columns')
      call t%close_to(sine2(2), 0.5_wp, 1.0e-14_wp, 'the sine does not depend on the lengths')
      i = 3
      call t%is_true(abs(m11(i)) + abs(m12(i)) + abs(m21(i)) + abs(m22(i)) <= 0.0_wp .and. sine2(i) <= 1.0e-10_wp, &
                     'parallel columns: no inverse')
   end subroutine matrices

   !> Rising, each place once, equal ones as they stood; numbers and names.
   subroutine orders()
      integer, parameter :: most = 40
      real(wp) :: x(most)
      integer :: order(most), n, i
      logical :: rises, once

      do n = 0, most
         x(:n) = [(real(modulo(7*i*i, 11), wp), i=1, n)]
         order(:n) = ascending(x(:n))
         rises = all([(x(order(i - 1)) < x(order(i)) .or. (x(order(i - 1)) <= x(order(i)) .and. order(i - 1) < order(i)), i=2, n)])
         once = all([(count(order(:n) == i) == 1, i=1, n)])
         call t%is_true(rises .and. once, 'order of '//to_text(n)//' numbers')
      end do
      call t%is_true(all(ascending([character(3) :: 'b', 'abc', 'b', 'a']) == [4, 2, 1, 3]), 'order of names')
   end subroutine orders

   !> The nearest rising numbers: means of neighbours, and no nearer ones beside them.
   subroutine pools()
      real(wp), parameter :: x(7) = [1.0_wp, 4.0_wp, 2.0_wp, 3.0_wp, 3.0_wp, 9.0_wp, 6.0_wp]
      real(wp) :: level(7)
      integer :: last(7), n

      level = x
      call pool_rising(level, last, n)
      call t%is_true(n == 5, 'five pools: equal numbers stay apart')
      call t%is_true(all(last(:n) == [1, 3, 4, 5, 7]), 'where each ends')
      call t%is_true(all(abs(level(:n) - [1.0_wp, 3.0_wp, 3.0_wp, 3.0_wp, 7.5_wp]) <= epsilon(1.0_wp)*8.0_wp), 'the means')
      level(:3) = [3.0_wp, 2.0_wp, 1.0_wp]
      call pool_rising(level(:3), last(:3), n)
      call t%is_true(n == 1 .and. last(1) == 3 .and. abs(level(1) - 2.0_wp) <= epsilon(1.0_wp)*2.0_wp, 'all of them one')
   end subroutine pools
end program test_foundation
