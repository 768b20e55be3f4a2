!> All assemblies: bilinear equations, triads against an elimination, published numbers of assemblies, sketches.
!>
!> With a number as its argument it compares so many random triads and prints what one takes: fpm test test_assemblies -- 1000.
program test_assemblies
   use check, only: checks_t
   use psalm_assemblies, only: assemblies_t, group_assemblies_t, find_assemblies, find_group_assemblies
   use psalm_assur_order, only: assur_order_t, find_assur_groups
   use psalm_cases, only: read_case_text
   use psalm_closure, only: closure_t, state_t, make_closure, start_state
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, degrees_per_radian, pi
   use psalm_lapack, only: general_eigenvalues
   use psalm_sketch, only: sketch_t, link_t
   use psalm_sketch_assembly, only: assemble_sketch
   use psalm_status, only: diagnostics_t
   use psalm_xoshiro, only: xoshiro_t, purpose_sample
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   integer, parameter :: usual = 60            !! random triads of a plain run
   type(checks_t) :: t

   call reference_triad()
   call random_triads(wanted_triads())
   call trusses()
   call sketches()
   call t%report()

contains

   integer function wanted_triads()
      character(16) :: word

      wanted_triads = usual
      if (command_argument_count() == 0) return
      call get_command_argument(1, word)
      read (word, *) wanted_triads
   end function wanted_triads

   !> The group of most links.
   pure integer function largest(closure) result(group)
      type(closure_t), intent(in) :: closure
      integer :: g

      group = 1
      do g = 2, size(closure%groups)
         if (size(closure%groups(g)%links) > size(closure%groups(group)%links)) group = g
      end do
   end function largest

   !> A platform on three links with fixed pivots, standing anyhow.
   function triad(a, l, b) result(sketch)
      complex(wp), intent(in) :: a(3), b(3)      !! pivots; points of the platform, the first 0
      real(wp), intent(in) :: l(3)               !! lengths of the links
      type(sketch_t) :: sketch
      integer :: k

      allocate (sketch%joint_name(6), sketch%links(5), sketch%slides(0), sketch%gears(0), sketch%drives(0), sketch%outputs(0))
      allocate (sketch%length_of(2, 0), sketch%length(0), sketch%variations(0))
      sketch%joint_name = [(achar(iachar('A') + k), k=0, 5)]
      sketch%links(1)%joints = [1, 2, 3]
      sketch%links(2)%joints = [1, 4]
      sketch%links(3)%joints = [2, 5]
      sketch%links(4)%joints = [3, 6]
      sketch%links(5)%joints = [4, 5, 6]
      sketch%x = [a%re, l(1) + a(1)%re, a(2)%re + l(2), a(3)%re + l(3)]
      sketch%y = [a%im, a%im]
      associate (unused => b)
      end associate
   end function triad

   !> Its closure: every link in axes of its own, drawn apart, for the drawing itself is not asked for.
   subroutine take_apart(a, l, b, closure, state)
      complex(wp), intent(in) :: a(3), b(3)
      real(wp), intent(in) :: l(3)
      type(closure_t), intent(out) :: closure
      type(state_t), intent(out) :: state
      type(sketch_t) :: sketch
      type(assur_order_t) :: order
      integer :: k

      sketch = triad(a, l, b)
      order = find_assur_groups(sketch)
      call make_closure(sketch, order, closure)
      do k = 1, 3
         closure%point(k, k + 1) = (0.0_wp, 0.0_wp)
         closure%point(k + 3, k + 1) = cmplx(l(k), 0.0_wp, wp)
         closure%point(k + 3, 5) = b(k)
         closure%origin(k + 1) = a(k)
      end do
      closure%origin(5) = a(1) + l(1)
      call start_state(closure, state)
   end subroutine take_apart

   !> The six assemblies of the reference: angle of the platform and place of its first point.
   subroutine reference_triad()
      type(closure_t) :: closure
      type(state_t) :: state
      type(group_assemblies_t) :: found
      real(wp), parameter :: angle(6) = [-123.435554459716_wp, -71.083809300044_wp, -12.977147003393_wp, 32.084939323721_wp, &
                                         71.696174416466_wp, 117.903957232702_wp]
      complex(wp), parameter :: place(6) = [(9.914088385883_wp, 3.751113364977_wp), (9.371658189870_wp, 4.952981200473_wp), &
                                            (10.198821942491_wp, -2.888603639367_wp), (10.348805299499_wp, 2.293954854189_wp), &
                                            (9.372940008620_wp, -4.950555079464_wp), (10.546922158765_wp, 1.059449374416_wp)]
      integer :: k, at
      real(wp) :: turn

      call take_apart([(0.0_wp, 0.0_wp), (11.5_wp, 0.0_wp), (9.8_wp, 3.0_wp)], [10.6_wp, 3.4_wp, 5.1_wp], &
                      [(0.0_wp, 0.0_wp), (2.0_wp, 0.0_wp), (3.3_wp, 4.7_wp)], closure, state)
      call t%equal_integer(size(closure%groups(largest(closure))%links), 4, 'a platform on three links is one group of four')
      call find_group_assemblies(closure, largest(closure), state, found)
      call t%is_true(found%known .and. found%complete, 'all paths end in simple roots')
      call t%equal_integer(size(found%states), 6, 'six real assemblies')
      call t%equal_integer(found%finite, 6, 'of six')
      do k = 1, 6
         at = 0
         do at = 1, size(found%states)
            turn = found%states(at)%phi(5, 0)*degrees_per_radian
            turn = turn - 360.0_wp*anint(turn/360.0_wp)
            if (abs(turn - angle(k)) < 1.0e-9_wp .and. abs(found%states(at)%t(5, 0) - place(k)) < 1.0e-10_wp) exit
         end do
         call t%is_true(at <= size(found%states), 'an assembly of the reference')
      end do
   end subroutine reference_triad

   !> Random triads against an elimination: all real assemblies, and no other.
   subroutine random_triads(count)
      integer, intent(in) :: count
      type(xoshiro_t) :: random
      type(closure_t) :: closure
      type(state_t) :: state
      type(group_assemblies_t) :: found
      complex(wp) :: a(3), b(3), at
      complex(wp), allocatable :: places(:)
      real(wp), allocatable :: turns(:)
      real(wp) :: l(3), turn
      integer :: k, i, m, equal, complete, real_ones
      real(wp) :: from, to, slowest, total          ! seconds of the processor
      logical :: same

      call random%seed(7, purpose_sample)
      equal = 0
      complete = 0
      real_ones = 0
      slowest = 0.0_wp
      total = 0.0_wp
      do i = 1, count
         do k = 1, 3
            call pair(random, 10.0_wp, a(k))
            call pair(random, 5.0_wp, b(k))
         end do
         b = b - b(1)
         call pair(random, 10.0_wp, at)
         call random%next(turn)
         turn = 2.0_wp*pi*turn
         ! it can be put together, at least so
         l = abs(at + b*cmplx(cos(turn), sin(turn), wp) - a)
         call take_apart(a, l, b, closure, state)
         call cpu_time(from)
         call find_group_assemblies(closure, largest(closure), state, found)
         call cpu_time(to)
         total = total + to - from
         slowest = max(slowest, to - from)
         call eliminate(a, l, b, turns, places)
         same = size(found%states) == size(turns)
         do k = 1, size(turns)
            same = same .and. any([(abs(found%states(m)%t(5, 0) - places(k)) < 1.0e-6_wp .and. &
                                    abs(cos(found%states(m)%phi(5, 0) - turns(k)) - 1.0_wp) < 1.0e-10_wp, m=1, size(found%states))])
         end do
         if (same) equal = equal + 1
         if (found%complete) complete = complete + 1
         real_ones = real_ones + size(found%states)
      end do
      call t%equal_integer(equal, count, 'random triads: all real assemblies, as by elimination')
      call t%equal_integer(complete, count, 'random triads: no path lost')
      call t%is_true(real_ones >= 2*count, 'real assemblies come in pairs, and one was given')
      if (count > usual) print '(i0,a,i0,a,f7.4,a,f7.4,a)', equal, ' of ', count, ' random triads with all assemblies, ', &
         1.0e3_wp*total/count, ' ms each, the slowest ', 1.0e3_wp*slowest, ' ms'
   end subroutine random_triads

   subroutine pair(random, half_width, z)
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(in) :: half_width
      complex(wp), intent(out) :: z
      real(wp) :: x, y

      call random%next(x)
      call random%next(y)
      z = half_width*cmplx(2.0_wp*x - 1.0_wp, 2.0_wp*y - 1.0_wp, wp)
   end subroutine pair

   !> The elimination: with the platform turned by phi three circles meet in one point where |W|**2 = l**2 D**2, of degree 3 in
   !> cos phi and sin phi; in tan(phi/2) a polynomial of degree 6, whose roots are eigenvalues.
   subroutine eliminate(a, l, b, turns, places)
      complex(wp), intent(in) :: a(3), b(3)
      real(wp), intent(in) :: l(3)
      real(wp), allocatable, intent(out) :: turns(:)
      complex(wp), allocatable, intent(out) :: places(:)
      integer, parameter :: degree = 3, samples = 16
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
      complex(wp) :: c(-degree:degree), p(0:2*degree), roots(2*degree), at
      real(wp) :: matrix(2*degree, 2*degree), e, step, phi, h, size_of
      integer :: k, n
      logical :: valid

      c = (0.0_wp, 0.0_wp)
      size_of = 0.0_wp
      do k = 0, samples - 1
         phi = 2.0_wp*pi*k/samples
         call circles(a, l, b, phi, e, at)
         size_of = max(size_of, abs(e))
         do n = -degree, degree
            c(n) = c(n) + e*exp(-i*n*phi)/samples
         end do
      end do
      ! u = (1 + i s)/(1 - i s), s = tan(phi/2)
      p = (0.0_wp, 0.0_wp)
      do n = -degree, degree
         p = p + c(n)*product_of(degree + n, degree - n, 2*degree)
      end do
      matrix = 0.0_wp
      do k = 1, 2*degree
         matrix(k, 2*degree) = -p(k - 1)%re/p(2*degree)%re
      end do
      do k = 2, 2*degree
         matrix(k, k - 1) = 1.0_wp
      end do
      call general_eigenvalues(matrix, roots, valid)
      call t%is_true(valid, 'the eigenvalues of the elimination are found')
      allocate (turns(0), places(0))
      do k = 1, 2*degree
         if (abs(roots(k)%im) > 1.0e-5_wp*(1.0_wp + abs(roots(k)))) cycle
         phi = 2.0_wp*atan(roots(k)%re)
         h = 1.0e-6_wp
         do n = 1, 20
            call circles(a, l, b, phi + h, step, at)
            call circles(a, l, b, phi - h, e, at)
            step = (step - e)/(2.0_wp*h)
            call circles(a, l, b, phi, e, at)
            if (abs(step) < tiny(1.0_wp)) exit
            phi = phi - e/step
            if (abs(e/step) < 1.0e-14_wp) exit
         end do
         call circles(a, l, b, phi, e, at)
         if (abs(e) > 1.0e-9_wp*size_of) cycle
         if (any(abs(cos(turns - phi) - 1.0_wp) < 1.0e-13_wp)) cycle
         turns = [turns, phi]
         places = [places, at]
      end do
   end subroutine eliminate

   !> |W|**2 - l**2 D**2 for a platform turned by an angle, and where its first point then is.
   subroutine circles(a, l, b, turn, value, place)
      complex(wp), intent(in) :: a(3), b(3)
      real(wp), intent(in) :: l(3), turn
      real(wp), intent(out) :: value
      complex(wp), intent(out) :: place
      complex(wp) :: m(2:3), w
      real(wp) :: r(2:3), d

      m = b(2:3)*cmplx(cos(turn), sin(turn), wp) - (a(2:3) - a(1))
      r = 0.5_wp*(l(2:3)**2 - l(1)**2 - abs(m)**2)
      d = aimag(conjg(m(2))*m(3))
      w = (0.0_wp, 1.0_wp)*(r(3)*m(2) - r(2)*m(3))
      value = abs(w)**2 - l(1)**2*d**2
      place = a(1)
      if (abs(d) > 0.0_wp) place = a(1) + w/d
   end subroutine circles

   !> (1 + i s)**n (1 - i s)**m by powers of s.
   pure function product_of(n, m, degree) result(q)
      integer, intent(in) :: n, m, degree
      complex(wp) :: q(0:degree)
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
      integer :: j

      q = (0.0_wp, 0.0_wp)
      q(0) = (1.0_wp, 0.0_wp)
      do j = 1, n
         q(1:) = q(1:) + i*q(:degree - 1)
      end do
      do j = 1, m
         q(1:) = q(1:) - i*q(:degree - 1)
      end do
   end function product_of

   !> Assemblies of larger groups, complex ones too: published are 2, 6 and for seven links 18, 16 and 14.
   subroutine trusses()
      ! joints of each link, the first being fixed
      call count_of('AB,AC,BC', 2, 'three links')
      call count_of('ABC,AD,BE,CF,DEF', 6, 'five links, a platform')
   end subroutine trusses

   !> Number of finite roots of a group whose links are given by their joints, with places drawn at random.
   subroutine count_of(links, wanted, law)
      character(*), intent(in) :: links, law
      integer, intent(in) :: wanted
      type(sketch_t) :: sketch
      type(closure_t) :: closure
      type(state_t) :: state
      type(group_assemblies_t) :: found
      type(xoshiro_t) :: random
      complex(wp) :: z
      integer :: k, n, from, to

      n = 0
      do k = 1, len(links)
         if (links(k:k) /= ',') n = max(n, iachar(links(k:k)) - iachar('A') + 1)
      end do
      allocate (sketch%joint_name(n), sketch%x(n), sketch%y(n), sketch%links(0), sketch%slides(0), sketch%gears(0))
      allocate (sketch%drives(0), sketch%outputs(0), sketch%length_of(2, 0), sketch%length(0), sketch%variations(0))
      call random%seed(11, purpose_sample)
      do k = 1, n
         sketch%joint_name(k) = achar(iachar('A') + k - 1)
         call pair(random, 1.0_wp, z)
         sketch%x(k) = z%re
         sketch%y(k) = z%im
      end do
      from = 1
      do while (from <= len(links))
         to = index(links(from:)//',', ',') + from - 2
         sketch%links = [sketch%links, link_of(links(from:to))]
         from = to + 2
      end do
      call make_closure(sketch, find_assur_groups(sketch), closure)
      call t%equal_integer(size(closure%groups(largest(closure))%links), size(sketch%links) - 1, law//': one group')
      call start_state(closure, state)
      call find_group_assemblies(closure, largest(closure), state, found)
      call t%equal_integer(found%finite, wanted, law//': number of assemblies')
   end subroutine count_of

   !> A link of the joints whose letters run together.
   pure type(link_t) function link_of(word) result(link)
      character(*), intent(in) :: word
      integer :: c

      link%joints = [(iachar(word(c:c)) - iachar('A') + 1, c=1, len(word))]
   end function link_of

   !> Whole sketches: a four-bar has two assemblies, a chain of dyads the product; slides and cylinders too.
   subroutine sketches()
      call whole('FOUR-BAR'//nl//" &CHAIN JNT='A','B','C','D', JX=0.0,-4.0,33.0,70.0, JY=0.0,41.0,82.0,5.0,"//nl// &
                 " LNK='A D','A B','B C','C D' &END &DRIVES DRIVE='A' &END &METHOD NDES=1, DELT=0.0 &END"//nl, 2)
      call whole('SLIDER-CRANK'//nl//" &CHAIN JNT='A','B','C',"//nl// &
                 " JX=0.0,20.0,150.0, JY=0.0,35.0,10.0, LNK='A','A B','B C','C',"//nl// &
                 " SLNK='1', SLNK2='4', SLX=0.0, SLY=10.0, SLANG=0.0 &END &DRIVES DRIVE='A' &END"//nl// &
                 ' &METHOD NDES=1, DELT=0.0 &END'//nl, 2)
      call whole('EXCAVATOR'//nl//" &CHAIN JNT='A','B','C','D','E','F','G','H','I','J','K','T',"//nl// &
                 ' JX=0.0,0.5,2.6,2.9,5.2,4.6,5.0,6.0,6.6,6.3,5.9,7.0, JY=1.5,1.0,3.4,3.9,3.2,3.9,3.7,1.9,1.6,2.3,2.4,0.5,'//nl// &
                 " LNK='AB','ACDE','EFGHK','HJ','JI','KIT' &END &DRIVES DRIVE='BC','DF','GJ', RATIO=0.0,0.7,-0.5 &END"//nl// &
                 ' &METHOD NDES=1, DELT=0.0 &END'//nl, 16)
   end subroutine sketches

   subroutine whole(text, wanted)
      character(*), intent(in) :: text
      integer, intent(in) :: wanted
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(closure_t) :: closure
      type(state_t) :: state
      type(assemblies_t) :: found
      logical :: valid
      character(:), allocatable :: law

      law = text(:index(text, nl) - 1)
      call read_case_text(text, 'test', sets, findings, 'psalm')
      call t%is_true(.not. findings%failed(), law//' is read')
      if (findings%failed()) return
      call assemble_sketch(sets(1), closure, state, valid, findings)
      call find_assemblies(closure, state, 100, found)
      call t%equal_integer(size(found%states), wanted, law//': assemblies')
      call t%is_true(found%complete .and. found%unknown == 0 .and. .not. found%more, law//': none is missing')
      if (size(found%states) == 0) return
      call t%is_true(maxval(abs(found%states(1)%joint(:, 0) - state%joint(:, 0))) < 1.0e-9_wp*closure%size, &
                     law//': the drawing comes first')
   end subroutine whole
end program test_assemblies
