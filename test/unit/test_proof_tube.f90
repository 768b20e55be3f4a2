!> The motion of sketches proven by tubes: ends against closed forms, extremes against the proof by dyads and against samples.
program test_proof_tube
   use check, only: checks_t
   use psalm_cases, only: read_case_text
   use psalm_chain_proof_study, only: chain_proof_t, study_chain_proof, place_on
   use psalm_chain_study, only: chain_study_t, study_chain
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, degrees_per_radian, radians_per_degree
   use psalm_proof_motion, only: proven_dead_point_t, quantity_output, quantity_turning
   use psalm_proof_study, only: proof_of_inputs, proof_of_turn
   use psalm_proof_tube, only: tube_t, turning_point
   use psalm_status, only: diagnostics_t
   use psalm_text, only: full_precision, to_text
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   type(checks_t) :: t

   call turning_points()
   call rocker()
   call crank()
   call dead_points()
   call double_points()
   call geared()
   call change_point()
   call triads()
   call cylinders()
   call lines_of_positions()
   call braced()
   call t%report()

contains

   !> Study a sketch given as a text and prove its motion.
   subroutine prove(text, range, s, proof)
      character(*), intent(in) :: text
      integer, intent(in) :: range
      type(chain_study_t), intent(out) :: s
      type(chain_proof_t), intent(out) :: proof
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      integer :: i

      call read_case_text(text, 'test', sets, findings, 'psalm')
      do i = 1, findings%count
         call t%is_true(.false., 'the sketch is sound', findings%list(i)%render())
      end do
      if (findings%failed()) error stop 'a sketch of the test cannot be read'
      call study_chain(sets(1), 1.0_wp, 0.0_wp, s)
      call study_chain_proof(sets(1), s, range, proof)
   end subroutine prove

   !> The way turns back within a tube if it is farther at the middle than at both ends, where a parabola has it.
   subroutine turning_points()
      real(wp), parameter :: slopes(4) = [0.0_wp, 0.4_wp, -0.4_wp, -0.6_wp]
      type(tube_t) :: tube
      real(wp) :: low, high
      logical :: turns
      integer :: i

      tube%r = 1.0_wp
      tube%holds = .true.
      do i = 1, size(slopes)
         tube%way = [3.0_wp, slopes(i), -1.0_wp, 0.0_wp]
         call turning_point(tube, turns, low, high)
         call t%is_true(turns .eqv. abs(slopes(i)) < 0.5_wp, 'a parabola turns back within the tube', to_text(i))
         call holds(low, high, 3.0_wp + 0.5_wp*min(abs(slopes(i)), 0.5_wp)**2, 0.2_wp, 'how far a parabola goes')
      end do
   end subroutine turning_points

   !> A bracket holds a value and is narrow.
   subroutine holds(low, high, value, width, law)
      real(wp), intent(in) :: low, high, value, width
      character(*), intent(in) :: law

      call t%is_true(low <= value .and. value <= high .and. high - low <= width, law, &
                     full_precision(low)//' to '//full_precision(high)//', '//full_precision(value))
   end subroutine holds

   !> A four-bar whose crank cannot turn: its dead points, by the law of cosines, both ways from the drawing.
   subroutine rocker()
      class(chain_study_t), allocatable :: s
      type(chain_proof_t) :: proof
      real(wp), parameter :: a = 4.0_wp, d = 6.0_wp, reach = 7.0_wp !! crank, frame, coupler 3 and rocker 4 in one line
      real(wp) :: crank, end_of_crank, far(2), drawn

      allocate (s)
      call prove('DOUBLE ROCKER'//nl//" &CHAIN JNT='A','B','C','D', JX=0.0,2.4,5.0,6.0, JY=0.0,3.2,3.9,0.0, "// &
                 "LNK='A D','A B','B C','C D', LENP='A B','B C','C D','A D', LENV=4.0,3.0,4.0,6.0 &END"//nl// &
                 " &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='angle D C' &END &METHOD NDES=2, DELT=0.0,5.0 &END"//nl, &
                 proof_of_turn, s, proof)
      drawn = acos(0.6_wp)*degrees_per_radian
      end_of_crank = acos((a**2 + d**2 - reach**2)/(2.0_wp*a*d))*degrees_per_radian
      call t%is_true(.not. proof%complete .and. size(proof%segments) == 2, 'double rocker: does not turn')
      call t%is_true(all(proof%segments%turns_back), 'double rocker: both ends are dead points')
      if (size(proof%segments) /= 2) return
      far(1) = place_on(proof, 1, proof%segments(1)%dead_high, .true.)
      crank = place_on(proof, 1, proof%segments(1)%reached, .true.)
      call holds(crank, far(1), end_of_crank - drawn, 1.0e-8_wp, 'double rocker: where the links stretch')
      ! the other way the coupler and the rocker stretch below the frame
      far(2) = place_on(proof, 2, proof%segments(2)%dead_high, .true.)
      crank = place_on(proof, 2, proof%segments(2)%reached, .true.)
      call holds(far(2), crank, -end_of_crank - drawn, 1.0e-8_wp, 'double rocker: where they stretch below')
   end subroutine rocker

   !> A crank-rocker: extremes of the rocker at the crank's dead points, closed forms.
   subroutine crank()
      class(chain_study_t), allocatable :: s
      type(chain_proof_t) :: proof
      real(wp) :: value, at

      allocate (s)
      call prove('CRANK-ROCKER'//nl//" &CHAIN JNT='A','B','C','D', JX=0.0,0.0,5.0,6.0, JY=0.0,2.0,4.9,0.0, "// &
                 "LNK='A D','A B','B C','C D', LENP='A B','B C','C D','A D', LENV=2.0,6.0,5.0,6.0 &END"//nl// &
                 " &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='angle D C','distance A C' &END &METHOD NDES=2, DELT=0.0,5.0 &END"//nl, &
                 proof_of_turn, s, proof)
      call t%is_true(proof%complete .and. proof%returns, 'crank-rocker: turns fully and stands as drawn')
      if (.not. all(proof%ranges%bounded)) return
      value = 180.0_wp - acos((36.0_wp + 25.0_wp - 64.0_wp)/60.0_wp)*degrees_per_radian
      call holds(proof%ranges(1)%low(1), proof%ranges(1)%high(1), value, 1.0e-8_wp, 'crank-rocker: least angle of the rocker')
      value = 180.0_wp - acos((36.0_wp + 25.0_wp - 16.0_wp)/60.0_wp)*degrees_per_radian
      call holds(proof%ranges(1)%low(2), proof%ranges(1)%high(2), value, 1.0e-8_wp, 'crank-rocker: greatest angle')
      call holds(proof%ranges(2)%low(1), proof%ranges(2)%high(1), 4.0_wp, 1.0e-9_wp, 'crank-rocker: A C least, q - crank')
      call holds(proof%ranges(2)%low(2), proof%ranges(2)%high(2), 8.0_wp, 1.0e-9_wp, 'crank-rocker: A C greatest, q + crank')
      at = place_on(proof, proof%ranges(1)%segment(2), proof%ranges(1)%way(2), .true.)
      ! crank against the coupler, rocker and frame: 90 at the drawing
      value = 180.0_wp + acos((16.0_wp + 36.0_wp - 25.0_wp)/48.0_wp)*degrees_per_radian - 90.0_wp
      call t%close_to(at, value, 1.0e-3_wp, 'crank-rocker: where it is greatest')
      call holds_samples(s, proof, 'crank-rocker')
   end subroutine crank

   !> Dead points of one quantity.
   function dead_of(proof, kind, place) result(dead)
      type(chain_proof_t), intent(in) :: proof
      integer, intent(in) :: kind, place
      type(proven_dead_point_t), allocatable :: dead(:)

      dead = pack(proof%movement%dead, proof%movement%dead%kind == kind .and. proof%movement%dead%place == place)
   end function dead_of

   !> A crank-rocker drawn with its crank at an angle, in exact lengths: the rocker stands still with crank and coupler in line.
   function crank_rocker(angle, method) result(text)
      real(wp), intent(in) :: angle            !! degrees
      character(*), intent(in) :: method
      character(:), allocatable :: text
      complex(wp) :: b, c
      real(wp) :: d, along

      b = 2.0_wp*cmplx(cos(angle*radians_per_degree), sin(angle*radians_per_degree), wp)
      d = abs(6.0_wp - b)
      along = (d*d + 36.0_wp - 25.0_wp)/(2.0_wp*d)
      c = b + (6.0_wp - b)/d*cmplx(along, sqrt(36.0_wp - along**2), wp)
      text = 'CRANK-ROCKER'//nl//" &CHAIN JNT='A','B','C','D', JX=0.0,"//full_precision(b%re)//','//full_precision(c%re)// &
             ',6.0, JY=0.0,'//full_precision(b%im)//','//full_precision(c%im)//",0.0,"//nl// &
             " LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C','C D', LENP='A B','B C','C D','A D', "// &
             "LENV=2.0,6.0,5.0,6.0 &END"//nl//" &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='angle D C',"// &
             "'angle A C','distance A C' &END"//nl//' '//method//nl
   end function crank_rocker

   !> Dead points, strokes, velocity ratio and dwells of a crank-rocker, closed forms; at the drawing and at the end of a range.
   subroutine dead_points()
      class(chain_study_t), allocatable :: s
      type(chain_proof_t) :: proof
      type(proven_dead_point_t), allocatable :: dead(:)
      real(wp) :: at(2), ratio, low, high
      integer :: k, n

      allocate (s)
      ! the line of crank and coupler, 4 and 8 long, against the frame
      at(1) = acos((64.0_wp + 36.0_wp - 25.0_wp)/96.0_wp)*degrees_per_radian
      at(2) = 180.0_wp + acos((16.0_wp + 36.0_wp - 25.0_wp)/48.0_wp)*degrees_per_radian
      call prove(crank_rocker(20.0_wp, '&METHOD NDES=2, DELT=0.0,5.0 &END &LIMITS DWELL=0.5 &END'), proof_of_turn, s, &
                 proof)
      dead = dead_of(proof, quantity_output, 1)
      call t%is_true(size(dead) == 2, 'crank-rocker: two dead points', to_text(size(dead)))
      if (size(dead) /= 2) return
      do k = 1, 2
         call holds(dead(k)%low, dead(k)%high, at(k) - 20.0_wp, 1.0e-9_wp, 'crank-rocker: dead point '//to_text(k))
         call t%is_true(dead(k)%reverses, 'crank-rocker: it turns back')
      end do
      ! the end of the rocker stands still with it, seen from the crank's pivot, too; A C and C D are never square
      do n = 2, 3
         dead = dead_of(proof, quantity_output, n)
         call t%is_true(size(dead) == 2, 'crank-rocker: so many has the line from A to C', to_text(n)//': '//to_text(size(dead)))
         if (size(dead) /= 2) cycle
         do k = 1, 2
            call holds(dead(k)%low, dead(k)%high, at(k) - 20.0_wp, 1.0e-8_wp, 'crank-rocker: number '//to_text(n)//' stands still')
         end do
      end do
      call t%is_true(size(dead_of(proof, quantity_turning, 4)) == 2, 'crank-rocker: so many has the rocker')
      ratio = (360.0_wp - (at(2) - at(1)))/(at(2) - at(1))
      call t%is_true(proof%movement%time_ratio(1) <= max(ratio, 1.0_wp/ratio), 'crank-rocker: time ratio at least')
      call t%close_to(proof%movement%time_ratio(1), max(ratio, 1.0_wp/ratio), 1.0e-9_wp, 'crank-rocker: time ratio')
      call t%is_true(count(proof%movement%dwells%number == 1) == 2, 'crank-rocker: two dwells')
      do k = 1, size(proof%movement%dwells)
         associate (dwell => proof%movement%dwells(k))
            if (dwell%number /= 1) cycle
            call holds(abs(rocker_angle(20.0_wp + dwell%from) - rocker_angle(20.0_wp + dwell%at)), 0.5_wp + 1.0e-9_wp, 0.5_wp, &
                       1.0e-7_wp, 'crank-rocker: a dwell begins where it is half a degree off')
            call holds(abs(rocker_angle(20.0_wp + dwell%to) - rocker_angle(20.0_wp + dwell%at)), 0.5_wp + 1.0e-9_wp, 0.5_wp, &
                       1.0e-7_wp, 'crank-rocker: it ends where it is half a degree off')
         end associate
      end do
      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      do k = 1, 7200
         ratio = (rocker_angle(0.05_wp*real(k, wp) + 1.0e-4_wp) - rocker_angle(0.05_wp*real(k, wp) - 1.0e-4_wp))/2.0e-4_wp
         low = min(low, ratio)
         high = max(high, ratio)
      end do
      associate (own => proof%ratios(1))
         call t%is_true(own%bounded .and. own%low(1) <= low + 1.0e-8_wp .and. own%high(2) >= high - 1.0e-8_wp, &
                        'crank-rocker: velocity ratios of samples lie in the bracket')
         call t%close_to(own%low(1), low, 1.0e-6_wp, 'crank-rocker: least velocity ratio')
         call t%close_to(own%high(2), high, 1.0e-6_wp, 'crank-rocker: greatest velocity ratio')
      end associate
      ! drawn at a dead point: it is met from both sides
      call prove(crank_rocker(at(1), '&METHOD NDES=3, DELT=0.0,-5.0,5.0 &END'), proof_of_inputs, s, proof)
      dead = dead_of(proof, quantity_output, 1)
      call t%is_true(size(dead) == 1, 'drawn at a dead point: one', to_text(size(dead)))
      if (size(dead) == 1) call t%is_true(dead(1)%reverses .and. dead(1)%low <= 0.0_wp .and. dead(1)%high >= 0.0_wp, &
                                          'drawn at a dead point: at 0')
      call prove(crank_rocker(at(1), '&METHOD NDES=2, DELT=0.0,5.0 &END'), proof_of_turn, s, proof)
      dead = dead_of(proof, quantity_output, 1)
      call t%is_true(size(dead) == 2 .and. all(dead%reverses), 'drawn at a dead point: a turn meets it once', to_text(size(dead)))
      ! the range ends at it
      call prove(crank_rocker(20.0_wp, '&METHOD NDES=2, DELT=0.0,'//full_precision(at(1) - 20.0_wp)//' &END'), &
                 proof_of_inputs, s, proof)
      dead = dead_of(proof, quantity_output, 1)
      call t%is_true(size(dead) <= 1, 'range up to a dead point: one at most')
      if (size(dead) == 1) call t%is_true(dead(1)%at_end .and. .not. dead(1)%reverses, 'range up to a dead point: it is at the end')
   end subroutine dead_points

   !> Angle of the rocker of the crank-rocker, degrees; closed form.
   real(wp) function rocker_angle(crank)
      real(wp), intent(in) :: crank            !! degrees
      complex(wp) :: b, c
      real(wp) :: d, along

      b = 2.0_wp*cmplx(cos(crank*radians_per_degree), sin(crank*radians_per_degree), wp)
      d = abs(6.0_wp - b)
      along = (d*d + 36.0_wp - 25.0_wp)/(2.0_wp*d)
      c = b + (6.0_wp - b)/d*cmplx(along, sqrt(36.0_wp - along**2), wp) - 6.0_wp
      rocker_angle = atan2(c%im, c%re)*degrees_per_radian
   end function rocker_angle

   !> Two arms, the second geared to the first, whose end has a coordinate with a double dead point, or two or none near it: every
   !> root of the closed form lies in a bracket, and a bracket that is narrow says how the sign changes.
   subroutine double_points()
      class(chain_study_t), allocatable :: s
      type(chain_proof_t) :: proof
      type(proven_dead_point_t), allocatable :: dead(:)
      real(wp), parameter :: off(9) = [0.0_wp, 1.0e-4_wp, -1.0e-4_wp, 1.0e-9_wp, -1.0e-9_wp, 1.0e-13_wp, -1.0e-13_wp, &
                                       1.0e-15_wp, -1.0e-15_wp]
      real(wp), parameter :: double = 50.0_wp  !! degrees
      real(wp) :: b, phase, before, here, low, high, middle
      complex(wp) :: p
      integer :: n, k, roots, i

      allocate (s)
      middle = double*radians_per_degree
      phase = atan2(-0.5_wp*sin(middle), -0.25_wp*cos(middle)) - 2.0_wp*middle
      do n = 1, size(off)
         b = hypot(0.5_wp*sin(double*radians_per_degree), 0.25_wp*cos(double*radians_per_degree))*(1.0_wp + off(n))
         p = 1.0_wp + b*cmplx(cos(phase), sin(phase), wp)
         call prove('TWO ARMS'//nl//" &CHAIN JNT='A','E','B','P', JX=0.0,-1.0,1.0,"//full_precision(p%re)//', JY=0.0,0.0,0.0,'// &
                    full_precision(p%im)//','//nl//" LNAME='frame','first','second', LNK='A E','A B','B P' &END"//nl// &
                    " &DRIVES DRIVE='A','B', RATIO=0.0,1.0 &END &OUTPUTS OUTPUT='x P' &END &METHOD NDES=2, DELT=0.0,5.0 &END"//nl, &
                    proof_of_turn, s, proof)
         call t%is_true(proof%complete .and. proof%returns, 'two arms: turn')
         dead = dead_of(proof, quantity_output, 1)
         roots = 0
         before = speed_of_arms(b, phase, 0.01_wp)
         do k = 1, 36000
            here = speed_of_arms(b, phase, 0.01_wp + 0.01_wp*real(k, wp))
            if (before*here > 0.0_wp) cycle
            low = 0.01_wp*real(k, wp)
            high = low + 0.01_wp
            do i = 1, 50
               middle = 0.5_wp*(low + high)
               if (speed_of_arms(b, phase, middle)*before > 0.0_wp) low = middle
               if (.not. speed_of_arms(b, phase, middle)*before > 0.0_wp) high = middle
            end do
            roots = roots + 1
            call t%is_true(any(dead%low <= high + 1.0e-9_wp .and. dead%high >= low - 1.0e-9_wp), 'two arms: a root is bracketed', &
                           full_precision(off(n))//' at '//full_precision(low))
            before = here
         end do
         call t%is_true(mod(count(dead%reverses), 2) == mod(roots, 2), 'two arms: as many changes of sign, but for pairs', &
                        full_precision(off(n))//': '//to_text(count(dead%reverses))//' of '//to_text(roots))
         if (abs(off(n)) >= 1.0e-9_wp) then
            call t%is_true(size(dead) == count(dead%reverses), 'two arms: near a double dead point all is decided', &
                           full_precision(off(n)))
            call t%is_true(size(dead) == merge(4, 2, off(n) > 0.0_wp), 'two arms: two near it, or none', &
                           full_precision(off(n))//': '//to_text(size(dead)))
         else
            call t%is_true(any(dead%low <= double + 1.0e-5_wp .and. dead%high >= double - 1.0e-5_wp), &
                           'two arms: at a double dead point nothing is excluded', full_precision(off(n)))
         end if
      end do

   end subroutine double_points

   !> Rate of the coordinate of two arms, the second `b` long.
   real(wp) function speed_of_arms(b, phase, degrees)
      real(wp), intent(in) :: b, phase, degrees

      speed_of_arms = -sin(degrees*radians_per_degree) - 2.0_wp*b*sin(2.0_wp*degrees*radians_per_degree + phase)
   end function speed_of_arms

   !> Two geared cranks: the rods stretch where their ends are as far apart as both are long.
   subroutine geared()
      class(chain_study_t), allocatable :: s
      type(chain_proof_t) :: proof
      real(wp) :: low, high, middle
      integer :: i

      allocate (s)
      call prove(five_bar('0.5', 'NDES=3, DELT=0.0,20.0,340.0'), proof_of_turn, s, proof)
      low = 340.0_wp
      high = 358.0_wp
      do i = 1, 80
         middle = 0.5_wp*(low + high)
         if (gap(middle) > 0.0_wp) low = middle
         if (gap(middle) <= 0.0_wp) high = middle
      end do
      call t%is_true(size(proof%segments) == 1 .and. proof%segments(1)%turns_back, 'geared five-bar: one end, forwards')
      call holds(place_on(proof, 1, proof%segments(1)%reached, .true.), place_on(proof, 1, proof%segments(1)%dead_high, &
                                                                                    .true.), low, &
                 1.0e-8_wp, 'geared five-bar: where the rods stretch')
      call t%is_true(proof%misplaced == 0, 'geared five-bar: all positions are on this motion')
      ! wheels of one size: every turn is like the first
      call prove(five_bar('1.0', 'NDES=2, DELT=0.0,20.0'), proof_of_turn, s, proof)
      call t%is_true(proof%complete .and. proof%returns, 'five-bar, ratio 1: stands as drawn after a turn')
      call prove(five_bar('0.25', 'NDES=3, DELT=0.0,50.0,-100.0'), proof_of_inputs, s, proof)
      call t%is_true(proof%complete .and. .not. proof%full_turn, 'five-bar, ratio 1/4: closes over the range asked for')
   end subroutine geared

   !> How much longer the rods are than the distance of their ends.
   real(wp) function gap(turn)
      real(wp), intent(in) :: turn             !! degrees of the first crank
      complex(wp) :: b, g

      b = cmplx(3.0_wp, 50.0_wp, wp)*cmplx(cos(turn*radians_per_degree), sin(turn*radians_per_degree), wp)
      g = cmplx(5.0_wp, 49.0_wp, wp)*cmplx(cos(0.5_wp*turn*radians_per_degree), sin(0.5_wp*turn*radians_per_degree), wp) + 80.0_wp
      gap = hypot(37.0_wp, 40.0_wp) + hypot(45.0_wp, 41.0_wp) - abs(b - g)
   end function gap

   function five_bar(ratio, method) result(text)
      character(*), intent(in) :: ratio, method
      character(:), allocatable :: text

      text = 'GEARED FIVE-BAR'//nl//" &CHAIN JNT='A','B','C','G','E', JX=0.0,3.0,40.0,85.0,80.0, JY=0.0,50.0,90.0,49.0,0.0,"// &
             " LNAME='frame','crank1','rod1','rod2','crank2', LNK='A E','A B','B C','C G','G E' &END"//nl// &
             " &DRIVES DRIVE='A','E', RATIO=0.0,"//ratio//" &END &OUTPUTS OUTPUT='point C' &END &METHOD "//method//' &END'//nl
   end function five_bar

   !> A parallelogram: at 0 all links lie in one line, and nothing tells how it goes on.
   subroutine change_point()
      class(chain_study_t), allocatable :: s
      type(chain_proof_t) :: proof

      allocate (s)
      call prove('PARALLELOGRAM'//nl//" &CHAIN JNT='A','B','C','D', JX=0.0,0.0,4.0,4.0, JY=0.0,2.0,2.0,0.0, "// &
                 "LNK='A D','A B','B C','C D' &END &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point C' &END"//nl// &
                 ' &METHOD NDES=2, DELT=0.0,5.0 &END'//nl, proof_of_turn, s, proof)
      call t%is_true(.not. proof%complete .and. .not. any(proof%segments%turns_back), &
                     'parallelogram: neither closes nor turns back')
      call holds(place_on(proof, 1, proof%segments(1)%reached, .true.), 90.0_wp, 90.0_wp, 1.0e-3_wp, &
                 'parallelogram: up to one line')
      call holds(-90.0_wp, place_on(proof, 2, proof%segments(2)%reached, .true.), -90.0_wp, 1.0e-3_wp, 'parallelogram: and back')
   end subroutine change_point

   !> Random groups of four: brackets hold all samples, and no sample is found beyond a dead point.
   subroutine triads()
      class(chain_study_t), allocatable :: s
      type(chain_proof_t) :: proof
      character(:), allocatable :: text
      real(wp) :: x(7), y(7)
      integer :: n, i, closing, turning, sampled
      integer, parameter :: linkages = 12

      allocate (s)
      closing = 0
      turning = 0
      sampled = 0
      call seed_reals()
      do n = 1, linkages
         call random_number(x)
         call random_number(y)
         x = 0.1_wp*x + [0.0_wp, 0.0_wp, 1.15_wp, 0.98_wp, 1.0_wp, 1.2_wp, 1.06_wp]
         y = 0.1_wp*y + [-0.3_wp, 0.0_wp, 0.0_wp, 0.3_wp, 0.9_wp, 1.0_wp, 1.4_wp]
         text = 'TRIAD '//to_text(n)//nl//" &CHAIN JNT='O','A','B','C','P','Q','R', JX="
         do i = 1, 7
            text = text//full_precision(x(i))//','
         end do
         text = text//nl//' JY='
         do i = 1, 7
            text = text//full_precision(y(i))//','
         end do
         text = text//nl//" LNK='O B C','O A','A P','B Q','C R','P Q R' &END &DRIVES DRIVE='O' &END"//nl// &
                " &OUTPUTS OUTPUT='pose P P Q','distance P C','between P Q O A' &END &METHOD IKIN=3 &END"//nl
         call prove(text, proof_of_turn, s, proof)
         if (proof%complete) closing = closing + 1
         turning = turning + count(proof%segments%turns_back)
         call holds_samples(s, proof, 'triad '//to_text(n))
         call turn_at_dead_points(s, proof, 'triad '//to_text(n))
         sampled = sampled + count(s%motion%closed)
         call t%is_true(proof%misplaced == 0, 'triad '//to_text(n)//': no position elsewhere', to_text(proof%misplaced))
         call t%is_true(all(s%motion%closed .eqv. within(s, proof)), 'triad '//to_text(n)//': positions close where proven')
      end do
      call t%is_true(turning >= linkages, 'triads: most stop at dead points', to_text(turning)//' of '//to_text(linkages))
      call t%is_true(sampled >= 20*linkages, 'triads: there are samples', to_text(sampled))
   end subroutine triads

   !> Positions that are proven to be reached, forwards or backwards from the drawing.
   function within(s, proof) result(inside)
      type(chain_study_t), intent(in) :: s
      type(chain_proof_t), intent(in) :: proof
      logical :: inside(size(s%motion%closed))

      inside = s%inputs(1, :) <= place_on(proof, 1, proof%segments(1)%reached, .true.)
      if (size(proof%segments) < 2) return
      inside = inside .or. s%inputs(1, :) >= 360.0_wp + place_on(proof, 2, proof%segments(2)%reached, .true.)
   end function within

   !> Three cylinders, from position to position; a line on which one cannot go on.
   subroutine cylinders()
      class(chain_study_t), allocatable :: s
      type(chain_proof_t) :: proof

      allocate (s)
      call prove(arm('0.1,0.2,-0.1', '0.0,0.1,0.1', '0.1,0.0,-0.1'), proof_of_inputs, s, proof)
      call t%is_true(proof%complete .and. .not. proof%one_drive .and. size(proof%segments) == 3, 'three cylinders: proven')
      call t%is_true(proof%misplaced == 0, 'three cylinders: the positions are on it')
      call holds_samples(s, proof, 'three cylinders')
      call prove(arm('0.1,0.2,2.6', '0.0,0.1,0.1', '0.1,0.0,-0.1'), proof_of_inputs, s, proof)
      call t%is_true(.not. proof%complete .and. count(proof%segments%complete) == 2, 'three cylinders: one line is not proven')
      call t%is_true(proof%segments(3)%turns_back, 'three cylinders: a dead point on it')

   end subroutine cylinders

   !> Two arms turned from position to position: the farthest place is met early on the first of two lines.
   subroutine lines_of_positions()
      class(chain_study_t), allocatable :: s
      type(chain_proof_t) :: proof
      type(proven_dead_point_t), allocatable :: dead(:)
      real(wp), parameter :: drawn = -0.6_wp*radians_per_degree

      allocate (s)
      call prove('TWO ARMS'//nl//" &CHAIN JNT='A','E','B','P', JX=0.0,-1.0,"//full_precision(cos(drawn))//','// &
                 full_precision(2.0_wp*cos(drawn))//', JY=0.0,0.0,'//full_precision(sin(drawn))//','// &
                 full_precision(2.0_wp*sin(drawn))//','//nl//" LNAME='frame','first','second', LNK='A E','A B','B P' &END"//nl// &
                 " &DRIVES DRIVE='A','B', DELT2=0.0,40.0 &END &OUTPUTS OUTPUT='x P' &END &METHOD NDES=2, DELT=60.0,70.0 &END "// &
                 "&LIMITS DWELL=0.1 &END"//nl, proof_of_inputs, s, proof)
      dead = dead_of(proof, quantity_output, 1)
      call t%is_true(size(proof%segments) == 2 .and. size(dead) == 1, 'two lines: one dead point', to_text(size(dead)))
      if (size(dead) /= 1) return
      call holds(dead(1)%low, dead(1)%high, 0.01_wp, 1.0e-9_wp, 'two lines: where both arms lie along the axis')
      call t%is_true(dead(1)%reverses .and. .not. dead(1)%at_end, 'two lines: it turns back there')
      call t%is_true(size(proof%movement%dwells) == 1, 'two lines: one dwell', to_text(size(proof%movement%dwells)))
      if (size(proof%movement%dwells) /= 1) return
      call t%close_to(proof%movement%dwells(1)%from, 0.0_wp, 1.0e-9_wp, 'two lines: the dwell begins at the drawing')
      call t%close_to(proof%movement%dwells(1)%to, 0.01_wp + acos(0.95_wp)*degrees_per_radian/60.0_wp, 1.0e-9_wp, &
                      'two lines: where the dwell ends')
   end subroutine lines_of_positions

   function arm(first, second, third) result(text)
      character(*), intent(in) :: first, second, third
      character(:), allocatable :: text

      text = 'EXCAVATOR ARM'//nl//" &CHAIN JNT='A','B','C','D','E','F','G','H','I','J','K','T',"//nl// &
             ' JX=0.0,0.5,2.6,2.9,5.2,4.6,5.0,6.0,6.6,6.3,5.9,7.0, JY=1.5,1.0,3.4,3.9,3.2,3.9,3.7,1.9,1.6,2.3,2.4,0.5,'//nl// &
             " LNK='A B','A C D E','E F G H K','H J','J I','K I T' &END"//nl// &
             " &DRIVES DRIVE='B C','D F','G J', DELT2="//second//', DELT3='//third//' &END'//nl// &
             " &OUTPUTS OUTPUT='point T','angle K T' &END &METHOD NDES=3, DELT="//first//' &END'//nl
   end function arm

   !> More constraints than are needed prove nothing.
   subroutine braced()
      class(chain_study_t), allocatable :: s
      type(chain_proof_t) :: proof

      allocate (s)
      call prove('THREE PARALLEL CRANKS'//nl//" &CHAIN JNT='A','B','C','D','E','F', JX=0.0,0.0,4.0,4.0,2.0,2.0, "// &
                 "JY=0.0,2.0,2.0,0.0,0.0,2.0, KOVER=1, LNK='A D E','A B','B C F','C D','E F' &END"//nl// &
                 " &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point C' &END &METHOD NDES=2, DELT=0.0,5.0 &END"//nl, &
                 proof_of_turn, s, proof)
      call t%is_true(proof%braced > 0, 'three parallel cranks: superfluous constraints are told')
   end subroutine braced

   !> Every position found that is on the proven motion lies within the brackets, and they are not much wider than the samples.
   subroutine holds_samples(s, proof, what)
      type(chain_study_t), intent(in) :: s
      type(chain_proof_t), intent(in) :: proof
      character(*), intent(in) :: what
      real(wp) :: least, greatest, slack, row(size(s%motion%closed))
      logical :: inside(size(s%motion%closed))
      integer :: n

      inside = s%motion%closed
      if (proof%full_turn) inside = inside .and. within(s, proof)
      do n = 1, size(proof%ranges)
         if (.not. proof%ranges(n)%bounded) cycle
         row = s%values(n, 0, :)
         if (what(:2) == 'tr' .and. (n == 3 .or. n == 5)) then
            ! angles, as far from the drawing's as less than half a turn
            row = row - 360.0_wp*anint((row - 0.5_wp*(proof%ranges(n)%low(1) + proof%ranges(n)%high(2)))/360.0_wp)
         end if
         least = minval(row, mask=inside)
         greatest = maxval(row, mask=inside)
         slack = 1.0e-12_wp*max(1.0_wp, abs(least), abs(greatest))
         call t%is_true(proof%ranges(n)%low(1) <= least + slack .and. proof%ranges(n)%high(2) >= greatest - slack, &
                        what//': number '//to_text(n)//' stays in its brackets', &
                        full_precision(least)//' '//full_precision(greatest)//' in '//full_precision(proof%ranges(n)%low(1))// &
                        ' '//full_precision(proof%ranges(n)%high(2)))
      end do
   end subroutine holds_samples

   !> Between two dead points of a number its samples go one way.
   subroutine turn_at_dead_points(s, proof, what)
      type(chain_study_t), intent(in) :: s
      type(chain_proof_t), intent(in) :: proof
      character(*), intent(in) :: what
      type(proven_dead_point_t), allocatable :: dead(:)
      integer :: k

      dead = dead_of(proof, quantity_output, 4)
      do k = 2, size(s%motion%closed) - 1
         if (s%inputs(1, k + 1) > place_on(proof, 1, proof%segments(1)%reached, .true.)) exit
         associate (v => s%values(4, 0, k - 1:k + 1), x => s%inputs(1, k - 1:k + 1))
            if ((v(2) - v(1))*(v(3) - v(2)) >= 0.0_wp) cycle
            call t%is_true(any(dead%low <= x(3) .and. dead%high >= x(1)), what//': a distance turns back at a dead point alone')
         end associate
      end do
   end subroutine turn_at_dead_points

   !> The same numbers in every run.
   subroutine seed_reals()
      integer, allocatable :: seed(:)
      integer :: n, i

      call random_seed(size=n)
      seed = [(41*i + 7, i=1, n)]
      call random_seed(put=seed)
   end subroutine seed_reals
end program test_proof_tube
