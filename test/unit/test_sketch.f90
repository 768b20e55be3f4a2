!> From a sketch: what is refused and how, freedom, Assur groups, closure.
program test_sketch
   use check, only: checks_t
   use psalm_assur_order, only: assur_order_t, find_assur_groups
   use psalm_cases, only: read_case_text
   use psalm_closure, only: closure_t, state_t, make_closure, start_state, solve_group, place_points
   use psalm_data_set, only: data_set_t, read_data_sets
   use psalm_dense, only: factors_t
   use psalm_kinds, only: wp
   use psalm_loop_check, only: check_loops
   use psalm_sketch, only: sketch_t, drive_turns
   use psalm_sketch_check, only: check_sketch
   use psalm_sketch_text, only: write_sketch
   use psalm_status, only: diagnostics_t
   use psalm_text, only: text_t
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
   call six_bars()
   call written_again()
   call checked_loops()
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

   !> Written and read again, a sketch is the same; so is what is asked of it.
   subroutine written_again()
      type(data_set_t) :: first
      type(text_t) :: text
      integer :: condition

      do condition = 0, 1
         call read_text(whole//' &LIMITS TANGLE=50., ICOND='//merge('1', '0', condition == 1)//' &END'//nl)
         first = sets(1)
         text = text_t()
         call write_sketch(first, text)
         call read_text(text%content())
         call t%is_true(.not. findings%failed(), 'a sketch written and read')
         if (findings%failed()) return
         call t%equal_integer(sets(1)%limits%icond, condition, 'ICOND of a sketch written and read')
         call t%close_to(sets(1)%limits%tangle, 50.0_wp, 0.0_wp, 'TANGLE of a sketch written and read')
         call t%is_true(all(abs(sets(1)%sketch%x - first%sketch%x) + &
                            abs(sets(1)%sketch%y - first%sketch%y) <= 0.0_wp), 'joints written and read: the same bits')
         call t%is_true(all(abs(sets(1)%method%delt - first%method%delt) <= 0.0_wp), 'inputs written and read: the same bits')
      end do
   end subroutine written_again

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
      integer :: g, dyads
      complex(wp) :: b, c
      real(wp), parameter :: turn = 0.5_wp

      call read_text(whole)
      call t%equal_integer(findings%count, 0, 'a four-bar is no mistake')
      dyads = count(order%groups%order == 2)
      call t%equal_integer(dyads, 1, 'a four-bar has one dyad')
      g = order%of_link(3)
      call t%is_true(g == order%of_link(4) .and. g == order%of_joint(3), 'coupler, rocker and their joint are one group')
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

   !> Loops that are not the sketch are noticed: an arc of another length, a link mirrored.
   subroutine checked_loops()
      type(data_set_t), allocatable :: read(:)
      type(diagnostics_t) :: own
      character(:), allocatable :: why

      call read_case_text(whole, 'memory', read, own, 'psalm')
      call t%equal_integer(own%count, 0, 'a four-bar is resolved')
      call check_loops(read(1), why)
      call t%is_true(why == '', 'its loops are the sketch')
      read(1)%traced%arcs(2)%arcl = 1.001_wp*read(1)%traced%arcs(2)%arcl
      call check_loops(read(1), why)
      call t%is_true(why == 'links whose loops do not give the drawing', 'a link that is longer')
      call read_case_text(whole, 'memory', read, own, 'psalm')
      read(1)%traced%arcs(2:3)%sign = -read(1)%traced%arcs(2:3)%sign
      call check_loops(read(1), why)
      call t%is_true(why == 'links whose loops do not give the drawing', 'the other assembly')
   end subroutine checked_loops

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
      call wrong("'A D','A B'", "'A D P','A B'", 'overconstrained')
      call wrong("DRIVE='A', DBASE='frame', DLINK='crank'", "DRIVE='P'", 'belongs to one link only')
      call wrong("DLINK='crank'", "DLINK='rocker'", 'link rocker is not at joint A; the links there are frame and crank')
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
   !> The published counts of six-bars: pairs of frame and driven pair that differ, and what Assur groups they have.
   !> Source: Oldham (1977), 3.2, table 3.2.
   subroutine six_bars()
      ! joints of the six links of the two chains
      integer, parameter :: watt(3, 6) = reshape([1, 2, 3, 1, 4, 5, 2, 6, 0, 6, 4, 0, 3, 7, 0, 7, 5, 0], [3, 6])
      integer, parameter :: stephenson(3, 6) = reshape([1, 2, 3, 4, 5, 6, 1, 4, 0, 2, 5, 0, 3, 7, 0, 7, 6, 0], [3, 6])
      integer :: dyads, larger, dyads_on_frame, larger_on_frame, pairs

      dyads = 0
      larger = 0
      dyads_on_frame = 0
      larger_on_frame = 0
      call count_classes(watt, pairs, dyads, larger, dyads_on_frame, larger_on_frame)
      call t%equal_integer(pairs, 11, 'frames and driven pairs of Watt''s chain')
      call count_classes(stephenson, pairs, dyads, larger, dyads_on_frame, larger_on_frame)
      call t%equal_integer(pairs, 14, 'frames and driven pairs of Stephenson''s chain')
      call t%equal_integer(dyads, 12, 'six-bars of dyads, any pair driven')
      call t%equal_integer(larger, 13, 'six-bars with a group of four, any pair driven')
      call t%equal_integer(dyads_on_frame, 6, 'six-bars of dyads, driven at the frame')
      call t%equal_integer(larger_on_frame, 3, 'six-bars with a group of four, driven at the frame')
   end subroutine six_bars

   !> Pairs of frame and driven pair of a chain that no renumbering of its links makes equal, by their groups.
   subroutine count_classes(chain, classes, dyads, larger, dyads_on_frame, larger_on_frame)
      integer, intent(in) :: chain(3, 6)
      integer, intent(out) :: classes
      integer, intent(inout) :: dyads, larger, dyads_on_frame, larger_on_frame
      type(assur_order_t) :: found
      integer :: orders(6, 720), seen(3, 1000), kinds, f, a, b, k, m, largest
      logical :: new

      call automorphisms(chain, orders, kinds)
      classes = 0
      do f = 1, 6
         do a = 1, 5
            do b = a + 1, 6
               if (common(chain, a, b) == 0) cycle
               new = .true.
               do k = 1, classes
                  do m = 1, kinds
                     if (orders(f, m) == seen(1, k) .and. min(orders(a, m), orders(b, m)) == seen(2, k) .and. &
                         max(orders(a, m), orders(b, m)) == seen(3, k)) new = .false.
                  end do
               end do
               if (.not. new) cycle
               classes = classes + 1
               seen(:, classes) = [f, a, b]
               found = find_assur_groups(drawn(chain, f, a, b))
               call t%is_true(found%valid, 'a six-bar with one drive is determined')
               largest = maxval(found%groups%order)
               if (largest == 2) dyads = dyads + 1
               if (largest == 4) larger = larger + 1
               if (f /= a .and. f /= b) cycle
               if (largest == 2) dyads_on_frame = dyads_on_frame + 1
               if (largest == 4) larger_on_frame = larger_on_frame + 1
            end do
         end do
      end do
   end subroutine count_classes

   !> The joint of two links; 0: none.
   pure integer function common(chain, a, b)
      integer, intent(in) :: chain(3, 6), a, b
      integer :: k

      common = 0
      do k = 1, 3
         if (chain(k, a) > 0 .and. any(chain(:, b) == chain(k, a))) common = chain(k, a)
      end do
   end function common

   !> Renumberings of the links that keep what is joined to what.
   subroutine automorphisms(chain, orders, kinds)
      integer, intent(in) :: chain(3, 6)
      integer, intent(out) :: orders(6, 720), kinds
      integer :: order(6)

      kinds = 0
      order = 0
      call extend(chain, 1, order, orders, kinds)
   end subroutine automorphisms

   recursive subroutine extend(chain, n, order, orders, kinds)
      integer, intent(in) :: chain(3, 6), n
      integer, intent(inout) :: order(6), orders(6, 720), kinds
      integer :: image, k
      logical :: keeps

      if (n > 6) then
         kinds = kinds + 1
         orders(:, kinds) = order
         return
      end if
      do image = 1, 6
         if (any(order(:n - 1) == image)) cycle
         keeps = .true.
         do k = 1, n - 1
            keeps = keeps .and. ((common(chain, n, k) > 0) .eqv. (common(chain, image, order(k)) > 0))
         end do
         if (.not. keeps) cycle
         order(n) = image
         call extend(chain, n + 1, order, orders, kinds)
      end do
      order(n) = 0
   end subroutine extend

   !> The chain with link `f` as its frame, driven where links `a` and `b` meet.
   function drawn(chain, f, a, b) result(sketch)
      integer, intent(in) :: chain(3, 6), f, a, b
      type(sketch_t) :: sketch
      integer :: order(6), k

      order = [f, pack([(k, k=1, 6)], [(k /= f, k=1, 6)])]
      allocate (sketch%joint_name(7), sketch%links(6), sketch%slides(0), sketch%gears(0), sketch%drives(1))
      sketch%joint_name = [(achar(iachar('A') + k), k=0, 6)]
      do k = 1, 6
         sketch%links(k)%joints = pack(chain(:, order(k)), chain(:, order(k)) > 0)
      end do
      sketch%drives(1)%kind = drive_turns
      sketch%drives(1)%joint = common(chain, a, b)
      sketch%drives(1)%base = findloc(order, a, dim=1)
      sketch%drives(1)%link = findloc(order, b, dim=1)
   end function drawn
end program test_sketch
