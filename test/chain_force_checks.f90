!> Forces of sketches: Newton and Euler for every link, power of all drives, momentum, virtual work, gears, cylinders; and
!> sketches of dyads both ways, in the poses of their links and dyad by dyad.
module chain_force_checks
   use check, only: checks_t
   use psalm_cases, only: read_case_text
   use psalm_chain_force_model, only: chain_model_t, make_chain_model, pair_pin, pair_slide, pair_gears
   use psalm_chain_force_study, only: find_chain_forces, judge_chain_forces
   use psalm_chain_study, only: chain_study_t, study_chain
   use psalm_closure, only: state_t
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, make_problem
   use psalm_force_analysis, only: column_of_joint, column_fx, column_fy, column_moment
   use psalm_force_study, only: force_study_t, find_forces
   use psalm_kinds, only: wp, pi
   use psalm_place, only: place_t
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
   use psalm_setup, only: set_up
   use psalm_sketch, only: drive_slides, drive_stretches, drive_turns
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: laws, both_ways, rods, names_and_messages, text_of, chain_of, gears
   character(*), parameter :: nl = new_line('a')
   complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
   character(*), parameter :: gears = 'CRANKS THAT ARE WHEELS'//nl// &
      " &CHAIN JNT='A','B','C','G','E', JX=0.,3.,40.,85.,80., JY=0.,50.,90.,49.,0., "// &
      "LNAME='frame','crank1','rod1','rod2','crank2', LNK='A E','A B','B C','C G','G E', "// &
      "GEARA='crank1', GEARB='crank2', GCARR='frame', GTA=20., GTB=40. &END"//nl// &
      " &DRIVES DRIVE='A' &END"//nl//" &OUTPUTS OUTPUT='point C' &END"//nl// &
      ' &METHOD NDES=7, DELT=-30.,-20.,-10.,0.,10.,20.,30. &END'//nl
   type(checks_t), public :: t

contains

   !> A file, and a line feed.
   function text_of(name) result(text)
      character(*), intent(in) :: name
      character(:), allocatable :: text
      integer :: unit, length

      open (newunit=unit, file=name, access='stream', form='unformatted', status='old', action='read')
      inquire (unit=unit, size=length)
      allocate (character(length) :: text)
      read (unit) text
      close (unit)
      text = text//nl
   end function text_of

   !> A row of rockers on the frame, each pulled by the one before it: as many dyads.
   function chain_of(dyads) result(text)
      integer, intent(in) :: dyads
      character(:), allocatable :: text, names, x, y, links
      integer :: k

      names = ''
      x = ''
      y = ''
      links = "'"
      do k = 0, dyads
         names = names//"'P"//to_text(k)//"','Q"//to_text(k)//"',"//nl
         x = x//to_text(40*k)//','//to_text(40*k + 3)//','//nl
         y = y//'0,'//to_text(30 + modulo(7*k, 5))//','//nl
         links = links//'P'//to_text(k)//' '
      end do
      links = links//"',"//nl//"'P0 Q0',"
      do k = 1, dyads
         links = links//"'Q"//to_text(k - 1)//' Q'//to_text(k)//"','P"//to_text(k)//' Q'//to_text(k)//"',"//nl
      end do
      text = 'ROCKERS IN A ROW'//nl//' &CHAIN JNT='//names//' JX='//x//' JY='//y//' LNK='//links//' &END'//nl// &
             " &DRIVES DRIVE='P0' &END"//nl//' &METHOD NDES=3, DELT=-10.,0.,10. &END'//nl
   end function chain_of

   !> Read one case.
   subroutine read_one(text, set, findings)
      character(*), intent(in) :: text
      type(data_set_t), intent(out) :: set
      type(diagnostics_t), intent(out) :: findings
      type(data_set_t), allocatable :: sets(:)

      call read_case_text(text, 'case', sets, findings, 'kalm')
      if (size(sets) > 0) set = sets(1)
   end subroutine read_one

   !> Groups with a mass on every link, a load, a spring with a damper and a torsional one, in thousandths of the drawing's size.
   function groups_for(set, size_of) result(text)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: size_of
      character(:), allocatable :: text, names, last
      integer :: n, l

      names = ''
      n = size(set%sketch%links)
      do l = 2, n
         names = names//"'"//trim(set%sketch%links(l)%name)//"',"
      end do
      last = trim(set%sketch%links(n)%name)
      text = ' &MASSES NMASS='//to_text(n - 1)//', MNAME='//names//' MASS='
      do l = 2, n
         text = text//number(0.1_wp*real(l, wp))//','
      end do
      text = text//' MDIST='
      do l = 2, n
         text = text//number(0.03_wp*size_of*real(l, wp))//','
      end do
      text = text//' MANG='
      do l = 2, n
         text = text//number(10.0_wp*real(l, wp))//','
      end do
      text = text//' MINERT='
      do l = 2, n
         text = text//number(1.0e-3_wp*real(l, wp))//','
      end do
      text = text//' UNITL='//number(0.5_wp/size_of)//', GRAVX=0.7, GRAVY=-9.81 &END'//nl// &
             " &LOADS NLOAD=2, LNAME='"//last//"','"//trim(set%sketch%links(2)%name)//"', LDIST=2*"// &
             number(0.05_wp*size_of)//', LANG=30.,-50., LFX=30.,5., LFY=-20.,11., LMOM=0.2,-0.7, LTURN=0,1 &END'//nl// &
             " &SPRING NSPRNG=2, ANAME='"//last//"','"//trim(set%sketch%links(2)%name)//"', BNAME='"// &
             trim(set%sketch%links(1)%name)//"','"//last//"', ADIST=2*"//number(0.07_wp*size_of)//', BDIST=2*'// &
             number(0.4_wp*size_of)//', BANG=2*70., STORS=0,1, STIFF=200.,0.3, SFREE='//number(0.1_wp*size_of)// &
             ',40., SPRE=2.,0.1, SDAMP=5.,0.02 &END'//nl
   end function groups_for

   pure function number(value) result(text)
      real(wp), intent(in) :: value
      character(:), allocatable :: text
      character(24) :: room

      write (room, '(es24.16)') value
      text = trim(adjustl(room))
   end function number

   !> Case, study and forces of a sketch with masses on every link. The first drive moves at 3 rad/s or 0.3 of the size a second.
   subroutine load_up(text, set, chain, study, model)
      character(*), intent(in) :: text
      type(data_set_t), intent(out) :: set
      type(chain_study_t), intent(out) :: chain
      type(force_study_t), intent(out) :: study
      type(chain_model_t), intent(out) :: model
      type(diagnostics_t) :: findings
      type(data_set_t) :: drawn            ! its places not yet counted from the arcs of its loops
      real(wp) :: size_of

      call read_one(text, set, findings)
      size_of = max(maxval(set%sketch%x) - minval(set%sketch%x), maxval(set%sketch%y) - minval(set%sketch%y))
      call read_one(text//' &RATES SPEED=3., ACCEL=2. &END'//nl//groups_for(set, size_of), set, findings)
      call t%is_true(.not. findings%failed(), 'a sketch with masses is read')
      if (findings%failed()) return
      if (set%sketch%drives(1)%kind /= drive_turns) then
         set%rates%speed = 0.3_wp*size_of
         set%rates%accel = 0.2_wp*size_of
      end if
      ! drives that are not geared have speeds of their own
      set%sketch%drives(2:)%speed = merge(0.0_wp, 0.2_wp*size_of, set%sketch%drives(2:)%geared)
      set%sketch%drives(2:)%accel = -set%sketch%drives(2:)%speed
      call study_chain(set, set%rates%speed, set%rates%accel, chain)
      drawn = set
      if (.not. allocated(set%no_loops)) then
         call as_written(drawn%masses%places)
         call as_written(drawn%loads%places)
         call as_written(drawn%springs%first)
         call as_written(drawn%springs%second)
      end if
      call make_chain_model(drawn, chain%closure, model, findings)
      call t%is_true(.not. findings%failed(), 'no fault is found with its forces')
      call find_chain_forces(drawn, chain, study)
   end subroutine load_up

   pure subroutine as_written(places)
      type(place_t), intent(inout) :: places(:)

      places%distance = places%written(1)
      places%angle = places%written(2)
   end subroutine as_written

   subroutine laws(name, text, one_drive)
      character(*), intent(in) :: name, text
      logical, intent(in) :: one_drive    !! or others that follow it
      type(data_set_t) :: set
      type(chain_study_t) :: chain
      type(force_study_t) :: study
      type(chain_model_t) :: model
      real(wp) :: largest, worst, gap, peak
      integer :: n

      call load_up(text, set, chain, study, model)
      if (.not. allocated(study%input)) return
      worst = 0.0_wp
      gap = 0.0_wp
      peak = 0.0_wp
      call t%is_true(any([(study%table%known(n), n=1, size(study%input))]), name//': forces are known')
      do n = 1, size(study%input)
         if (.not. study%table%known(n)) cycle
         largest = maxval(abs(study%table%value(n, :)))
         worst = max(worst, rest_of_links(chain, study, model, set, n)/largest)
         gap = max(gap, abs(study%drive_power(n) + study%table%power(n) - study%table%growth(n)))
         peak = max(peak, abs(study%drive_power(n)), abs(study%table%power(n)), abs(study%table%growth(n)))
      end do
      call t%is_true(worst <= 1.0e-13_wp, name//': each link is in equilibrium', number(worst))
      call t%is_true(gap <= 1.0e-12_wp*peak, name//': power balance of all drives', number(gap/peak))
      call virtual_work(name, set, chain, model)
      call unit_masses(name, set, chain, model)
      if (one_drive) call momentum(name, set, model)
   end subroutine laws

   pure real(wp) function cross(a, b)
      complex(wp), intent(in) :: a, b

      cross = a%re*b%im - a%im*b%re
   end function cross

   pure complex(wp) function axis(state, link)
      type(state_t), intent(in) :: state
      integer, intent(in) :: link

      axis = cmplx(cos(state%phi(link, 0)), sin(state%phi(link, 0)), wp)
   end function axis

   !> Newton and Euler: largest force, or moment on the arm of the drawing, that is left on any link at a position. Nothing of the
   !> solution is used but the columns.
   real(wp) function rest_of_links(chain, study, model, set, n) result(rest)
      type(chain_study_t), intent(in) :: chain
      type(force_study_t), intent(in) :: study
      type(chain_model_t), intent(in) :: model
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: n
      complex(wp) :: force(size(chain%closure%origin)), z, a, v, f, u, ends(2), speeds(2)
      real(wp) :: moment(size(chain%closure%origin)), pull
      integer :: k, e, l, c

      force = (0.0_wp, 0.0_wp)
      moment = 0.0_wp
      associate (state => chain%motion%states(n), sketch => chain%closure%sketch, m => model%metre)
         do k = 1, size(model%mass)
            call move(model%centres(k)%link, model%centres(k)%at, z, v, a)
            l = model%centres(k)%link
            call add(l, z, model%mass(k)*(model%gravity - a*m), -model%inertia(k)*state%phi(l, 2))
         end do
         do k = 1, size(model%loads)
            associate (load => model%loads(k))
               call move(load%spot%link, load%spot%at, z, v, a)
               f = load%force
               if (load%turns) f = f*axis(state, load%spot%link)*load%spot%along
               call add(load%spot%link, z, f, load%moment)
            end associate
         end do
         do k = 1, size(model%springs)
            associate (spring => model%springs(k))
               do e = 1, 2
                  call move(spring%ends(e)%link, spring%ends(e)%at, ends(e), speeds(e), a)
               end do
               associate (b => spring%ends%link)
                  if (spring%torsional) then
                     u = axis(state, b(2))*spring%ends(2)%along/(axis(state, b(1))*spring%ends(1)%along)
                     pull = atan2(u%im, u%re) - spring%free*pi/180.0_wp
                     pull = spring%preload + spring%stiffness*atan2(sin(pull), cos(pull)) + &
                            spring%damping*(state%phi(b(2), 1) - state%phi(b(1), 1))
                     moment(b(1)) = moment(b(1)) + pull
                     moment(b(2)) = moment(b(2)) - pull
                  else
                     u = (ends(2) - ends(1))/abs(ends(2) - ends(1))
                     v = (speeds(2) - speeds(1))*conjg(u)
                     pull = spring%preload + m*(spring%stiffness*(abs(ends(2) - ends(1)) - spring%free) + spring%damping*v%re)
                     call add(b(1), ends(1), pull*u, 0.0_wp)
                     call add(b(2), ends(2), -pull*u, 0.0_wp)
                  end if
               end associate
            end associate
         end do
         do k = 1, size(model%pairs)
            c = column_of_joint(k)
            associate (pair => model%pairs(k), value => study%table%value(n, c:c + 1))
               select case (pair%kind)
               case (pair_pin)
                  call exchange(pair%links, state%joint(pair%which, 0), cmplx(value(1), value(2), wp), 0.0_wp)
               case (pair_slide)
                  call move(pair%links(2), chain%closure%slide_point(2, pair%which), z, v, a)
                  u = axis(state, pair%links(1))*chain%closure%line(pair%which)
                  call exchange(pair%links, z, i*u*value(1), value(2))
               case (pair_gears)
                  associate (gear => sketch%gears(pair%which))
                     ! cranks on A and E whose radii are as their teeth
                     z = state%joint(1, 0) + (state%joint(5, 0) - state%joint(1, 0))*(-gear%ratio)/(1.0_wp - gear%ratio)
                     call exchange(pair%links, z, cmplx(value(1), value(2), wp), 0.0_wp)
                  end associate
               end select
            end associate
         end do
         do k = 1, size(sketch%drives)
            associate (drive => sketch%drives(k))
               c = 1
               if (k > 1) c = size(study%table%value, 2) - size(sketch%drives) + k
               if (drive%kind == drive_turns) then
                  call exchange([drive%base, drive%link], (0.0_wp, 0.0_wp), (0.0_wp, 0.0_wp), study%table%value(n, c))
               else if (drive%kind == drive_slides) then
                  u = axis(state, sketch%slides(drive%slide)%links(1))*chain%closure%line(drive%slide)
                  call move(sketch%slides(drive%slide)%links(2), chain%closure%slide_point(2, drive%slide), z, v, a)
                  call exchange([drive%base, drive%link], z, u*study%table%value(n, c), 0.0_wp)
               end if
            end associate
         end do
         ! the frame holds what it is given
         call add(1, (0.0_wp, 0.0_wp), -cmplx(study%table%value(n, column_fx), study%table%value(n, column_fy), wp), &
                  -study%table%value(n, column_moment))
      end associate
      rest = max(maxval(abs(force)), maxval(abs(moment))/max(1.0_wp, chain%closure%size*set%masses%metre))

   contains

      subroutine add(link, z, f, couple)
         integer, intent(in) :: link
         complex(wp), intent(in) :: z, f
         real(wp), intent(in) :: couple

         force(link) = force(link) + f
         moment(link) = moment(link) + cross(z, f)*model%metre + couple
      end subroutine add

      subroutine exchange(links, z, f, couple)
         integer, intent(in) :: links(2)
         complex(wp), intent(in) :: z, f
         real(wp), intent(in) :: couple

         call add(links(2), z, f, couple)
         call add(links(1), z, -f, -couple)
      end subroutine exchange

      !> Place, velocity and acceleration of a point fixed in a link.
      subroutine move(link, p, z, v, a)
         integer, intent(in) :: link
         complex(wp), intent(in) :: p
         complex(wp), intent(out) :: z, v, a
         complex(wp) :: r

         associate (state => chain%motion%states(n))
            r = axis(state, link)*p
            z = state%t(link, 0) + r
            v = state%t(link, 1) + i*state%phi(link, 1)*r
            a = state%t(link, 2) + (i*state%phi(link, 2) - state%phi(link, 1)**2)*r
         end associate
      end subroutine move
   end function rest_of_links

   !> No masses, one load: the force of each drive is minus the load's component along the motion that this drive alone makes.
   subroutine virtual_work(name, set, chain, model)
      character(*), intent(in) :: name
      type(data_set_t), intent(in) :: set
      type(chain_study_t), intent(in) :: chain
      type(chain_model_t), intent(in) :: model
      type(data_set_t) :: bare
      type(chain_study_t) :: alone
      type(force_study_t) :: study
      complex(wp) :: v
      real(wp) :: want, got
      integer :: d, n, c

      if (any(set%sketch%drives%geared)) return
      bare = set
      bare%masses%mass = 0.0_wp*bare%masses%mass
      bare%masses%inertia = 0.0_wp*bare%masses%inertia
      bare%masses%gravity = 0.0_wp
      bare%springs%first = bare%springs%first(:0)
      bare%springs%second = bare%springs%second(:0)
      bare%loads%places = bare%loads%places(:1)
      bare%loads%moment(1) = 0.0_wp
      call find_chain_forces(bare, chain, study)
      do d = 1, size(set%sketch%drives)
         bare%sketch%drives%speed = 0.0_wp
         if (d > 1) bare%sketch%drives(d)%speed = 1.0_wp
         call study_chain(bare, merge(1.0_wp, 0.0_wp, d == 1), 0.0_wp, alone)
         c = 1
         if (d > 1) c = size(study%table%value, 2) - size(set%sketch%drives) + d
         do n = 1, size(study%input)
            if (.not. study%table%known(n)) cycle
            associate (spot => model%loads(1)%spot, state => alone%motion%states(n))
               v = state%t(spot%link, 1) + i*state%phi(spot%link, 1)*axis(state, spot%link)*spot%at
            end associate
            if (set%sketch%drives(d)%kind == drive_turns) v = v*model%metre
            want = -(v%re*30.0_wp - v%im*20.0_wp)
            got = study%table%value(n, c)
            call t%is_true(abs(got - want) <= 1.0e-11_wp*max(1.0_wp, abs(want)), name//': virtual work of drive '//to_text(d), &
                           number(got - want))
         end do
      end do
   end subroutine virtual_work

   !> Unit columns times the masses of the links are the loads of inertia; cylinders have no mass on their rods here.
   subroutine unit_masses(name, set, chain, model)
      character(*), intent(in) :: name
      type(data_set_t), intent(in) :: set
      type(chain_study_t), intent(in) :: chain
      type(chain_model_t), intent(in) :: model
      type(data_set_t) :: bare
      type(force_study_t) :: study
      real(wp), allocatable :: columns(:, :, :, :), total(:)
      real(wp) :: of(4), worst
      integer :: k, n

      bare = set
      bare%masses%gravity = 0.0_wp
      bare%springs%first = bare%springs%first(:0)
      bare%springs%second = bare%springs%second(:0)
      bare%loads%places = bare%loads%places(:0)
      call find_chain_forces(bare, chain, study, columns)
      worst = 0.0_wp
      do n = 1, size(study%input)
         if (.not. study%table%known(n)) cycle
         total = 0.0_wp*study%table%value(n, :)
         do k = 1, size(model%mass)
            associate (r => model%centres(k)%at*model%metre)
               of = [model%mass(k), model%mass(k)*r%re, model%mass(k)*r%im, model%inertia(k) + model%mass(k)*abs(r)**2]
            end associate
            total = total + matmul(columns(n, :, :, model%centres(k)%link), of)
         end do
         worst = max(worst, maxval(abs(total - study%table%value(n, :)))/maxval(abs(study%table%value(n, :))))
      end do
      call t%is_true(worst <= 1.0e-11_wp, name//': unit columns times masses are the loads', number(worst))
   end subroutine unit_masses

   !> Force and moment on the frame are what loads and weight do less the growth of momentum and angular momentum, these differenced
   !> over the input at a constant speed with nine points.
   subroutine momentum(name, given, model)
      character(*), intent(in) :: name
      type(data_set_t), intent(in) :: given
      type(chain_model_t), intent(in) :: model
      real(wp), parameter :: weight(4) = [0.8_wp, -0.2_wp, 4.0_wp/105.0_wp, -1.0_wp/280.0_wp]
      type(data_set_t) :: set
      type(chain_study_t) :: chain
      type(force_study_t) :: study
      complex(wp) :: p(-4:4), want_force, z, v, f
      real(wp) :: l(-4:4), want_moment, step, got(3)
      integer :: k, s, n

      set = given
      set%springs%first = set%springs%first(:0)
      set%springs%second = set%springs%second(:0)
      set%rates%accel = 0.0_wp
      set%method%ikin = 0
      set%method%ndes = 9
      step = 0.25_wp
      if (set%sketch%drives(1)%kind /= drive_turns) step = 1.0e-3_wp*(set%rates%speed/0.3_wp)
      set%method%delt = [(real(s, wp)*step, s=-4, 4)]
      set%method%crnki = 0.0_wp
      call study_chain(set, set%rates%speed, set%rates%accel, chain)
      if (.not. all(chain%motion%closed)) return
      call find_chain_forces(set, chain, study)
      do s = -4, 4
         p(s) = (0.0_wp, 0.0_wp)
         l(s) = 0.0_wp
         associate (state => chain%motion%states(s + 5), m => model%metre)
            do k = 1, size(model%mass)
               n = model%centres(k)%link
               z = axis(state, n)*model%centres(k)%at
               v = (state%t(n, 1) + i*state%phi(n, 1)*z)*m
               z = (state%t(n, 0) + z)*m
               p(s) = p(s) + model%mass(k)*v
               l(s) = l(s) + model%mass(k)*cross(z, v) + model%inertia(k)*state%phi(n, 1)
            end do
         end associate
      end do
      if (set%sketch%drives(1)%kind == drive_turns) step = step*pi/180.0_wp
      want_force = (0.0_wp, 0.0_wp)
      want_moment = 0.0_wp
      do s = 1, 4
         want_force = want_force - weight(s)*(p(s) - p(-s))*set%rates%speed/step
         want_moment = want_moment - weight(s)*(l(s) - l(-s))*set%rates%speed/step
      end do
      associate (state => chain%motion%states(5), m => model%metre)
         do k = 1, size(model%mass)
            n = model%centres(k)%link
            z = (state%t(n, 0) + axis(state, n)*model%centres(k)%at)*m
            want_force = want_force + model%mass(k)*model%gravity
            want_moment = want_moment + model%mass(k)*cross(z, model%gravity)
         end do
         do k = 1, size(model%loads)
            n = model%loads(k)%spot%link
            z = (state%t(n, 0) + axis(state, n)*model%loads(k)%spot%at)*m
            f = model%loads(k)%force
            if (model%loads(k)%turns) f = f*axis(state, n)*model%loads(k)%spot%along
            want_force = want_force + f
            want_moment = want_moment + cross(z, f) + model%loads(k)%moment
         end do
      end associate
      got = study%table%value(5, [column_fx, column_fy, column_moment])
      call t%is_true(abs(cmplx(got(1), got(2), wp) - want_force) <= 1.0e-9_wp*abs(want_force), name//': momentum', &
                     number(abs(cmplx(got(1), got(2), wp) - want_force)/abs(want_force)))
      call t%is_true(abs(got(3) - want_moment) <= 1.0e-9_wp*max(abs(want_moment), abs(want_force)), name//': angular momentum', &
                     number(got(3) - want_moment))
   end subroutine momentum

   !> Dyad by dyad and in the poses of the links: drive, frame and every joint, by name.
   subroutine both_ways(name, text)
      character(*), intent(in) :: name, text
      type(data_set_t) :: set
      type(chain_study_t) :: chain
      type(force_study_t) :: posed_study, study
      type(chain_model_t) :: model
      type(problem_t), allocatable :: problem
      type(mechanism_t) :: mechanism
      type(dimensions_t) :: dimensions
      type(parameters_t) :: parameters
      type(diagnostics_t) :: findings
      real(wp) :: largest, worst
      integer :: n, j, k, found

      call load_up(text, set, chain, posed_study, model)
      if (.not. allocated(posed_study%input)) return
      call t%is_true(.not. allocated(set%no_loops), name//' has loops')
      call set_up(set, mechanism, dimensions, parameters, findings)
      allocate (problem)
      call make_problem(set, mechanism, dimensions, parameters, problem)
      call find_forces(set, problem, dimensions, study)
      call t%equal_integer(size(study%joints), size(posed_study%joints), name//': as many joints')
      found = 0
      worst = 0.0_wp
      do n = 1, size(study%input)
         if (.not. (study%table%known(n) .and. posed_study%table%known(n))) cycle
         found = found + 1
         largest = maxval(abs(study%table%value(n, :)))
         worst = max(worst, maxval(abs(study%table%value(n, :4) - posed_study%table%value(n, :4)))/largest)
         worst = max(worst, abs(study%table%kinetic(n)/posed_study%table%kinetic(n) - 1.0_wp))
         do j = 1, size(study%joints)
            do k = 1, size(posed_study%joints)
               if (posed_study%joints(k)%name == study%joints(j)%name) exit
            end do
            if (k > size(posed_study%joints)) then
               call compare_last(j)
               cycle
            end if
            associate (a => study%table%value(n, column_of_joint(j):column_of_joint(j) + 1), &
                       b => posed_study%table%value(n, column_of_joint(k):column_of_joint(k) + 1))
               worst = max(worst, maxval(abs(a - b))/largest)
            end associate
         end do
      end do
      call t%is_true(found > 0, name//': forces are known both ways')
      call t%is_true(worst <= 1.0e-11_wp, name//': the same forces both ways', number(worst))

   contains

      !> The one link of a pin that the other list leaves out: what the pin does to all its links adds up to nothing.
      subroutine compare_last(joint)
         integer, intent(in) :: joint
         real(wp) :: total(2)
         integer :: dot, c

         dot = index(study%joints(joint)%name, '.')
         call t%is_true(dot > 1, name//': joint '//study%joints(joint)%name//' has one name')
         total = study%table%value(n, column_of_joint(joint):column_of_joint(joint) + 1)
         do k = 1, size(posed_study%joints)
            if (index(posed_study%joints(k)%name, study%joints(joint)%name(:dot)) /= 1) cycle
            c = column_of_joint(k)
            total = total + posed_study%table%value(n, c:c + 1)
         end do
         worst = max(worst, maxval(abs(total))/largest)
      end subroutine compare_last
   end subroutine both_ways

   !> A mass on the rod of a cylinder: the force of the drive is that of a point on a turning ray, from polar co-ordinates.
   subroutine rods()
      character(*), parameter :: text = 'A CYLINDER THAT TURNS'//nl// &
         " &CHAIN JNT='A','B','C','D', JX=0.,3.,1.,4., JY=0.,0.,2.,2., "// &
         "LNAME='frame','arm','lid', LNK='A D','A C','C B' &END"//nl// &
         " &DRIVES DRIVE='A','D B', DELT2=0.,.1,.2, DSPEED=0.,.7, DACCEL=0.,.3 &END"//nl// &
         " &OUTPUTS OUTPUT='point B' &END"//nl//' &METHOD NDES=3, DELT=0.,5.,10. &END'//nl// &
         ' &RATES SPEED=1.5, ACCEL=0.4 &END'//nl// &
         " &MASSES NMASS=1, MNAME='D-B B', MASS=2., GRAVY=-9.81 &END"//nl
      type(data_set_t) :: set
      type(chain_study_t) :: chain
      type(force_study_t) :: study
      type(diagnostics_t) :: findings
      complex(wp) :: a, u
      real(wp) :: growth
      integer :: n

      call read_one(text, set, findings)
      call t%is_true(.not. findings%failed(), 'a mass on the rod of a cylinder')
      if (findings%failed()) return
      call study_chain(set, set%rates%speed, set%rates%accel, chain)
      call find_chain_forces(set, chain, study)
      do n = 1, 3
         associate (state => chain%motion%states(n))
            ! nothing else has a mass: whatever moves B is felt by both drives as its weight and inertia
            a = state%joint(2, 2) + (0.0_wp, 9.81_wp)
            growth = 2.0_wp*real(conjg(a)*state%joint(2, 1), wp)
            call t%close_to(study%drive_power(n), growth, 1.0e-12_wp*abs(growth), 'power of two drives on a mass at a rod')
            u = 2.0_wp*a + 0.0_wp
            call t%is_true(abs(cmplx(study%table%value(n, column_fx), study%table%value(n, column_fy), wp) + u) <= &
                           1.0e-12_wp*abs(u), 'the frame bears the mass')
         end associate
      end do
   end subroutine rods

   subroutine names_and_messages()
      character(:), allocatable :: four, bars
      type(data_set_t) :: set
      type(diagnostics_t) :: findings

      four = text_of('data/sketch_four_bar.nml')//' &RATES SPEED=1. &END'//nl
      bars = text_of('data/stephenson2_six_bar.nml')//' &RATES SPEED=1. &END'//nl
      call wrong(four//" &MASSES NMASS=1, MNAME='couple', MASS=1. &END"//nl, "no link is called 'couple'; did you mean 'coupler'?")
      call wrong(four//" &MASSES NMASS=1, MNAME='coupler X', MASS=1. &END"//nl, "no joint is called 'X'")
      call wrong(four//" &MASSES NMASS=1, MNAME='coupler D', MASS=1. &END"//nl, 'link coupler does not have joint D; it has B C P')
      call wrong(four//" &MASSES NMASS=1, MNAME='coupler B C P', MASS=1. &END"//nl, 'names more than a link and two joints of it')
      call wrong(four//" &MASSES NMASS=1, MNAME='coupler B B', MASS=1. &END"//nl, 'joint B stands twice: no line')
      call wrong(four//" &MASSES NMASS=2, MNAME='coupler', MASS=1. &END"//nl, 'has 1 names; there are 2 entries')
      call wrong(four//' &MASSES NMASS=1, MASS=1. &END'//nl, 'names the link of each entry')
      call wrong(four//' &MASSES NMASS=1, MLINK=2, MLOOP=1, MASS=1. &END'//nl, 'counts arcs of &LINKS; a sketch has names, MNAME')
      call wrong(four//" &FRICTN NFRIC=1, FNAME='Q', FMU=.1 &END"//nl, "no joint or slide is called 'Q'")
      call wrong(four//" &FRICTN NFRIC=1, FNAME='P', FMU=.1 &END"//nl, 'joint P is a point of one link; nothing turns in it')
      call wrong(four//" &FRICTN NFRIC=2, FNAME='B','B', FMU=.1 &END"//nl, "'B' is entry 1 already")
      call wrong(four//" &SPRING NSPRNG=1, ANAME='frame D', BNAME='rocket', STIFF=1. &END"//nl, "did you mean 'rocker'?")
      call wrong(text_of('data/dyad1_crank_rocker.nml')//" &MASSES NMASS=1, MNAME='rod', MASS=1. &END"//nl, &
                 'names parts of a sketch (&CHAIN), but this linkage is described by &LINKS')
      call wrong(bars//" &MASSES NMASS=1, MNAME='tie', MASS=-1. &END"//nl, 'add up to a negative mass')
      call wrong(text_of('data/geared_five_bar.nml')//" &MASSES NMASS=1, MNAME='frame', MASS=1. &END"//nl, &
                 'is a mass on the frame: it has no effect')

   contains

      !> The reader or the judge of forces tells it.
      subroutine wrong(text, message)
         character(*), intent(in) :: text, message

         call read_one(text, set, findings)
         if (.not. findings%failed()) call judge_chain_forces(set, findings)
         call t%finds(findings, message, message)
      end subroutine wrong
   end subroutine names_and_messages
end module chain_force_checks
