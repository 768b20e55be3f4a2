!> From a sketch: what is refused and how, freedom, Assur groups, closure.
program test_sketch
   use check, only: checks_t
   use psalm_assur_order, only: assur_order_t
   use psalm_closure, only: closure_t, state_t, make_closure, start_state, solve_group, place_points
   use psalm_data_set, only: data_set_t, read_data_sets
   use psalm_dense, only: factors_t
   use psalm_kinds, only: wp
   use psalm_sketch_check, only: check_sketch
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a'), file = 'build/test_sketch.nml'
   character(*), parameter :: chain = " &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,33.0,70.0,20.0,"//nl// &
      "  JY=0.0,41.0,82.0,5.0,95.0, LNAME='frame','crank','coupler','rocker',"//nl// &
      "  LNK='A D','A B','B C P','C D' &END"//nl
   character(*), parameter :: drives = " &DRIVES NDRIVE=1, DRIVE='A', DBASE='frame', DLINK='crank' &END"//nl
   character(*), parameter :: outputs = " &OUTPUTS OUTPUT='point P' &END"//nl
   character(*), parameter :: method = ' &METHOD NDES=3, DELT=0.0,30.0,60.0 &END'//nl
   character(*), parameter :: whole = 'A FOUR-BAR'//nl//chain//drives//outputs//method
   type(checks_t) :: t
   type(data_set_t), allocatable :: sets(:)
   type(diagnostics_t) :: findings
   type(assur_order_t) :: order

   call plain()
   call wrong_sketches()
   call t%report()

contains

   subroutine read_text(text)
      character(*), intent(in) :: text
      type(diagnostics_t) :: fresh
      integer :: unit

      open (newunit=unit, file=file, access='stream', form='unformatted', status='replace')
      write (unit) text
      close (unit)
      findings = fresh
      if (allocated(sets)) deallocate (sets)
      call read_data_sets(file, sets, findings)
      if (findings%failed()) return
      call check_sketch(sets(1), order, findings)
   end subroutine read_text

   function altered(from, to) result(text)
      character(*), intent(in) :: from, to
      character(:), allocatable :: text
      integer :: at

      at = index(whole, from)
      text = whole(:at - 1)//to//whole(at + len(from):)
      call t%is_true(at > 0, 'the text to be altered is there: '//from)
   end function altered

   subroutine wrong(from, to, words)
      character(*), intent(in) :: from, to, words

      call read_text(altered(from, to))
      call t%equal_integer(findings%exit_code(), 2, 'exit status 2: '//words)
      call t%finds(findings, words, 'message')
      call t%equal_integer(findings%count, 1, 'one message: '//words)
   end subroutine wrong

   !> The groups of a four-bar, and Newton's method against the intersection of circles.
   subroutine plain()
      type(closure_t) :: closure
      type(state_t) :: state
      type(factors_t) :: factors
      logical :: closed
      logical, allocatable :: needed(:)
      integer :: g, dyads
      complex(wp) :: b, c
      real(wp), parameter :: turn = 0.5_wp

      call read_text(whole)
      call t%equal_integer(findings%count, 0, 'a four-bar is no mistake')
      dyads = count(order%groups%order == 2)
      call t%equal_integer(dyads, 1, 'a four-bar has one dyad')
      g = order%of_link(3)
      call t%is_true(g == order%of_link(4) .and. g == order%of_joint(3), 'coupler, rocker and their joint are one group')
      needed = order%needed_for([2], [integer ::])
      call t%is_true(needed(order%of_link(2)) .and. .not. needed(g), 'the crank alone needs no dyad')
      needed = order%needed_for([integer ::], [5])
      call t%is_true(needed(order%of_link(2)) .and. needed(g), 'a point of the coupler needs both')
      call make_closure(sets(1)%sketch, order, closure)
      call start_state(closure, state)
      state%input(1, 0) = turn
      do g = 1, size(order%groups)
         call solve_group(closure, g, state, closed, factors)
         call t%is_true(closed, 'the group closes')
      end do
      call place_points(closure, state, 0)
      b = cmplx(-4.0_wp, 41.0_wp, wp)*cmplx(cos(turn), sin(turn), wp)
      c = meeting(b, abs(cmplx(37.0_wp, 41.0_wp, wp)), (70.0_wp, 5.0_wp), abs(cmplx(37.0_wp, -77.0_wp, wp)))
      call t%close_to(abs(state%joint(2, 0) - b), 0.0_wp, 1.0e-13_wp, 'B on its circle')
      call t%close_to(abs(state%joint(3, 0) - c), 0.0_wp, 1.0e-12_wp, 'C where the circles meet')
   end subroutine plain

   !> The left one of the two places where circles meet.
   pure complex(wp) function meeting(a, ra, b, rb)
      complex(wp), intent(in) :: a, b
      real(wp), intent(in) :: ra, rb
      real(wp) :: d, along

      d = abs(b - a)
      along = (ra**2 - rb**2 + d**2)/(2.0_wp*d)
      meeting = a + (b - a)/d*cmplx(along, sqrt(ra**2 - along**2), wp)
   end function meeting

   subroutine wrong_sketches()
      call wrong("'C D' &END", "'C X' &END", "no joint is called 'X'")
      call wrong("LNAME='frame','crank'", "LNAME='crank','frame'", 'put it first')
      call wrong("'coupler','rocker'", "'rocker','rocker'", 'link rocker is named twice (as number 3 and 4)')
      call wrong("'A D','A B'", "'A','A B'", 'put it into the first link of LNK')
      call wrong("'coupler','rocker',"//nl//"  LNK='A D','A B','B C P','C D' &END", &
                 "'coupler','rocker','strut', LNK='A D','A B','B C P','C D','A C' &END", 'drive at A moves nothing')
      call wrong("'A D','A B'", "'A D P','A B'", 'braced twice')
      call wrong("DRIVE='A', DBASE='frame', DLINK='crank'", "DRIVE='P'", 'belongs to one link only')
      call wrong("DLINK='crank'", "DLINK='rocker'", 'has no part in A')
      call wrong("DLINK='crank'", "DLINK='cranck'", "did you mean 'crank'?")
      call wrong("'point P'", "'pint P'", 'is no output')
      call wrong("'point P'", "'point Q'", "no joint is called 'Q'")
      call wrong("'point P'", "'angle rockr'", "did you mean 'rocker'?")
      call wrong('JX=0.0,-4.0,33.0,70.0,20.0,'//nl//'  JY=0.0,41.0', 'JX=0.0,0.0,33.0,70.0,20.0,'//nl//'  JY=0.0,0.0', &
                 'joints A and B of link crank are at the same place')
      call wrong("'C D' &END", "'C D', NSLIDE=1, SLNK='crank', SLNK2='coupler', SLX=0.,SLY=0.,SLANG=0. &END", &
         'pins together already')
      call wrong("'C','D','P'", "'C','D','D'", 'is named twice')
      call wrong("JNT='A','B','C','D','P',", "JNT='A','B','C','D','P','Q',", 'places 5 of 6 joints')
      call wrong(drives, '', 'needs the group &DRIVES')
      call wrong("NDRIVE=1, DRIVE='A', DBASE='frame', DLINK='crank'", "DRIVE='A','D', DELT2=3*0.0", 'moves nothing')
      call wrong("NDRIVE=1, DRIVE='A', DBASE='frame', DLINK='crank'", "DRIVE='A','D', DELT2=2*0.0", 'only 2 values given')
      call wrong("NDES=3", "NDES=3, IVA=1,0", 'VARY')
   end subroutine wrong_sketches
end program test_sketch
