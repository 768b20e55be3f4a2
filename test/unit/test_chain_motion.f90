!> Motion of sketches with larger Assur groups and several drives: published and reference numbers, rates against differences.
program test_chain_motion
   use check, only: checks_t
   use psalm_cases, only: read_case_text
   use psalm_chain_study, only: chain_study_t, study_chain
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   type(checks_t) :: t

   call triad()
   call scissors()
   call five_bar()
   call end_of_range()
   call rates_by_differences()
   call planetary()
   call special_dimensions()
   call envelope()
   call t%report()

contains

   !> Study a sketch given as a text.
   subroutine study(text, result, speed)
      character(*), intent(in) :: text
      type(chain_study_t), intent(out) :: result
      real(wp), intent(in), optional :: speed
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      real(wp) :: rate
      integer :: i

      rate = 1.0_wp
      if (present(speed)) rate = speed
      call read_case_text(text, 'test', sets, findings, 'psalm')
      do i = 1, findings%count
         call t%is_true(.false., 'the sketch is sound', findings%list(i)%render())
      end do
      if (findings%failed()) error stop 'a sketch of the test cannot be read'
      call study_chain(sets(1), rate, 0.0_wp, result)
   end subroutine study

   !> Stephenson's chain on the frame DCG, driven at FG: rates and a position of the group of four.
   subroutine triad()
      class(chain_study_t), allocatable :: s
      real(wp), parameter :: tight = 1.0e-9_wp

      allocate (s)
      call study('STEPHENSON'//nl//" &CHAIN JNT='A','B','C','D','E','F','G', JX=0.0,1.0,5.0,6.0,2.0,6.0,8.0,"//nl// &
                 " JY=0.0,3.0,4.0,-0.5,5.0,8.0,4.5, LNK='DCG','AD','ABE','BC','EF','FG' &END"//nl// &
                 " &DRIVES DRIVE='G' &END &OUTPUTS OUTPUT='angle A D','angle A B','angle B C','angle E F','point E','point B'"// &
                 ' &END &METHOD NDES=2, DELT=0.0,5.729577951308232 &END'//nl, s)
      call t%close_to(s%values(1, 1, 1), 2.0370370370_wp, tight, 'speed of AD')
      call t%close_to(s%values(2, 1, 1), -1.4814814815_wp, tight, 'speed of ABE')
      call t%close_to(s%values(3, 1, 1), 3.4259259259_wp, tight, 'speed of BC')
      call t%close_to(s%values(4, 1, 1), 3.2962962963_wp, tight, 'speed of EF')
      call t%close_to(s%values(1, 2, 1), -7.8288053142_wp, tight, 'acceleration of AD')
      call t%close_to(s%values(2, 2, 1), -4.9770741249_wp, tight, 'acceleration of ABE')
      call t%close_to(s%values(3, 2, 1), -5.3999168064_wp, tight, 'acceleration of BC')
      call t%close_to(s%values(4, 2, 1), 1.2816802571_wp, tight, 'acceleration of EF')
      call t%close_to(s%values(5, 0, 2), 2.758913844242_wp, tight, 'E, x, after a turn of 0.1')
      call t%close_to(s%values(6, 0, 2), 3.710948407858_wp, tight, 'E, y')
      call t%close_to(s%values(7, 0, 2), 1.455130470365_wp, tight, 'B, x')
      call t%close_to(s%values(8, 0, 2), 1.894317208632_wp, tight, 'B, y')
   end subroutine triad

   !> A cylinder between the two arms of a scissors lift.
   subroutine scissors()
      class(chain_study_t), allocatable :: s

      allocate (s)
      call study('LIFT'//nl//" &CHAIN JNT='A','M','B','C','D','P','Q',"//nl// &
                 ' JX=0.0,0.8660254037844386,2*1.7320508075688772,0.0,0.34641016151377546,0.4330127018922193,'//nl// &
                 ' JY=0.0,0.5,0.0,1.0,1.0,0.2,0.75,'//nl// &
                 " LNK='A','AMCP','BMDQ','B','D','C', NSLIDE=2, SLNK='1','5', SLNK2='4','6', SLX=2*1.7320508075688772,"//nl// &
                 " SLY=0.0,1.0, SLANG=0.0,0.0 &END &DRIVES DRIVE='PQ' &END &OUTPUTS"//nl// &
                 " OUTPUT='y D','distance P Q','ratio h c', ONAME='h','c','leverage' &END"//nl// &
                 ' &METHOD NDES=2, DELT=0.0,0.05 &END'//nl, s)
      call t%close_to(s%values(2, 0, 1), 0.556776436283_wp, 1.0e-11_wp, 'length of the cylinder')
      call t%close_to(s%values(1, 1, 1), 1.855921454277_wp, 1.0e-11_wp, 'leverage, 2 cos phi D/(2 r1 r2 sin 2 phi)')
      call t%close_to(s%values(3, 0, 1), 1.855921454277_wp, 1.0e-11_wp, 'leverage as an output')
      call t%close_to(s%values(1, 0, 2), 1.092668970348_wp, 1.0e-11_wp, 'height of the deck')
      call t%close_to(s%values(1, 1, 2), 1.851052950007_wp, 1.0e-11_wp, 'leverage after the stroke')
   end subroutine scissors

   !> Two cranks, driven apart and geared.
   subroutine five_bar()
      class(chain_study_t), allocatable :: s
      character(*), parameter :: chain = 'FIVE-BAR'//nl//" &CHAIN JNT='A','B','C','G','E', JX=0.0,3.0,40.0,85.0,80.0,"//nl// &
         " JY=0.0,50.0,90.0,49.0,0.0, LNK='A E','A B','B C','C G','G E' &END &OUTPUTS OUTPUT='point C' &END"//nl
      real(wp), parameter :: tight = 1.0e-11_wp

      allocate (s)
      call study(chain//" &DRIVES DRIVE='A','E', DELT2=-5.729577951308232 &END &METHOD NDES=1, DELT=11.459155902616465 &END"//nl, s)
      call t%close_to(s%values(1, 0, 1), 38.066540338718_wp, tight, 'C, x, of two drives')
      call t%close_to(s%values(2, 0, 1), 80.236141222696_wp, tight, 'C, y')
      call study(chain//" &DRIVES DRIVE='A','E', RATIO=0.0,0.5 &END &METHOD NDES=3, "// &
                 'DELT=17.188733853924695,34.37746770784939,57.29577951308232 &END'//nl, s)
      call t%close_to(s%values(1, 0, 1), 28.519676879_wp, 1.0e-9_wp, 'C, x, geared')
      call t%close_to(s%values(2, 0, 1), 85.183388601_wp, 1.0e-9_wp, 'C, y, geared')
      call t%close_to(s%values(1, 0, 3), 2.600402329_wp, 1.0e-9_wp, 'C, x, geared, after one radian')
      call t%close_to(s%values(2, 0, 3), 62.937662120_wp, 1.0e-9_wp, 'C, y, geared, after one radian')
   end subroutine five_bar

   !> A four-bar that cannot turn fully stops at its dead point, and is found again on the near side of it.
   subroutine end_of_range()
      class(chain_study_t), allocatable :: s
      logical :: expected(4)

      allocate (s)
      ! crank 60, coupler 50, rocker 40, frame 100: the crank's angle is at most acos((3600+10000-8100)/12000)
      call study('DOUBLE ROCKER'//nl//" &CHAIN JNT='A','B','C','D', JX=0.0,60.0,84.0,100.0, JY=0.0,0.0,36.0,0.0,"//nl// &
                 " LNK='AD','AB','BC','CD', LENP='AB','BC','CD','AD', LENV=60.0,50.0,40.0,100.0 &END"//nl// &
                 " &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='point C' &END &METHOD NDES=4, DELT=62.7,62.8,-62.7,30.0 &END"//nl, s)
      expected = [.true., .false., .true., .true.]
      call t%is_true(all(s%motion%closed .eqv. expected), 'the range ends at 62.72 degrees')
   end subroutine end_of_range

   !> Velocity, acceleration and jerk of everything against differences of positions: an excavator's cylinders.
   subroutine rates_by_differences()
      class(chain_study_t), allocatable :: s
      integer :: n
      real(wp), parameter :: h = 1.0e-3_wp

      allocate (s)
      call study('EXCAVATOR'//nl//" &CHAIN JNT='A','B','C','D','E','F','G','H','I','J','K','T',"//nl// &
                 ' JX=0.0,0.5,2.6,2.9,5.2,4.6,5.0,6.0,6.6,6.3,5.9,7.0, JY=1.5,1.0,3.4,3.9,3.2,3.9,3.7,1.9,1.6,2.3,2.4,0.5,'//nl// &
                 " LNK='AB','ACDE','EFGHK','HJ','JI','KIT' &END"//nl// &
                 " &DRIVES DRIVE='BC','DF','GJ', RATIO=0.0,0.7,-0.5 &END"//nl// &
                 " &OUTPUTS OUTPUT='point T','angle K T','distance G I','between A C K T' &END"//nl// &
                 ' &METHOD NDES=5, DELT=-0.002,-0.001,0.0,0.001,0.002 &END'//nl, s)
      call t%is_true(all(s%motion%closed), 'the arm closes')
      do n = 1, size(s%names)
         call t%close_to(s%by_drive(n, 1, 3) + 0.7_wp*s%by_drive(n, 2, 3) - 0.5_wp*s%by_drive(n, 3, 3), s%values(n, 1, 3), &
                         1.0e-12_wp, 'the changes with each drive make up the whole: '//trim(s%names(n)))
      end do
      do n = 1, size(s%names)
         associate (v => s%values(n, 0, :), unit => merge(radians_per_degree, 1.0_wp, n == 3 .or. n == 5))
            call t%close_to(s%values(n, 1, 3), unit*(8.0_wp*(v(4) - v(2)) - (v(5) - v(1)))/(12.0_wp*h), 1.0e-8_wp, &
                            'velocity of '//trim(s%names(n)))
            call t%close_to(s%values(n, 2, 3), unit*(16.0_wp*(v(4) + v(2)) - (v(5) + v(1)) - 30.0_wp*v(3))/(12.0_wp*h**2), &
                            1.0e-6_wp, 'acceleration of '//trim(s%names(n)))
         end associate
         associate (a => s%values(n, 2, :))
            call t%close_to(s%values(n, 3, 3), (8.0_wp*(a(4) - a(2)) - (a(5) - a(1)))/(12.0_wp*h), 1.0e-6_wp, &
                            'jerk of '//trim(s%names(n)))
         end associate
      end do
   end subroutine rates_by_differences

   !> Willis: with the sun held a planet of half its teeth turns three times as fast as the carrier.
   subroutine planetary()
      class(chain_study_t), allocatable :: s

      allocate (s)
      call study('PLANET'//nl//" &CHAIN JNT='A','B','P', JX=0.0,30.0,40.0, JY=0.0,0.0,0.0,"//nl// &
                 " LNAME='sun','carrier','planet', LNK='A','AB','BP', GEARA='sun', GEARB='planet', GCARR='carrier',"//nl// &
                 " GTA=40, GTB=20 &END &DRIVES DRIVE='A' &END &OUTPUTS OUTPUT='angle B P' &END"//nl// &
                 ' &METHOD NDES=2, DELT=0.0,30.0 &END'//nl, s)
      call t%close_to(s%values(1, 0, 2), 90.0_wp, 1.0e-12_wp, 'the planet turns three times as far')
      call t%close_to(s%values(1, 1, 1), 3.0_wp, 1.0e-12_wp, 'and as fast')
   end subroutine planetary
   !> A parallelogram with a third link (KOVER=1): every point goes round a circle like the cranks' ends.
   subroutine special_dimensions()
      class(chain_study_t), allocatable :: s
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings, reported
      character(*), parameter :: chain = 'PARALLELOGRAM'//nl//" &CHAIN JNT='A','B','C','D','E','F','P',"//nl// &
         ' JX=0.0,18.0,58.0,40.0,70.0,88.0,40.0, JY=0.0,24.0,24.0,0.0,10.0,34.0,60.0,'//nl// &
         " LNK='A D E','A B','D C','E F','B C F P', KOVER=1", rest = " &END &DRIVES DRIVE='A' &END"//nl// &
         " &OUTPUTS OUTPUT='point P','angle B C' &END &METHOD NDES=5, DELT=0.0,20.0,50.0,80.0,-40.0 &END"//nl
      real(wp), parameter :: turns(5) = [0.0_wp, 20.0_wp, 50.0_wp, 80.0_wp, -40.0_wp]
      complex(wp) :: p
      integer :: k

      allocate (s)
      call study(chain//rest, s)
      call t%is_true(all(s%motion%closed), 'the parallelogram closes')
      do k = 1, 5
         p = cmplx(22.0_wp, 36.0_wp, wp) + cmplx(18.0_wp, 24.0_wp, wp)*exp(cmplx(0.0_wp, turns(k)*radians_per_degree, wp))
         call t%close_to(s%values(1, 0, k), p%re, 1.0e-12_wp, 'P of the parallelogram, x')
         call t%close_to(s%values(2, 0, k), p%im, 1.0e-12_wp, 'P of the parallelogram, y')
         call t%close_to(s%values(3, 0, k), 0.0_wp, 1.0e-12_wp, 'its coupler does not turn')
         call t%close_to(s%values(1, 1, k), -(p%im - 36.0_wp), 1.0e-11_wp, 'and has the speed of the crank')
      end do
      ! a third link a little too long: it fits the drawing and nothing else
      call study(chain//", LENP='E F', LENV=30.0"//rest, s)
      call t%is_true(all(s%motion%closed), 'the length that it has may be said')
      call read_case_text(chain//", LENP='E F', LENV=30.1"//rest, 'test', sets, findings, 'psalm')
      call t%is_true(findings%failed(), 'a third link of another length is refused')
      call read_case_text(chain(:len(chain) - 9)//rest, 'test', sets, reported, 'psalm')
      call t%equal_integer(reported%count, 1, 'one message without KOVER')
      call t%finds(reported, 'moves nothing', 'without KOVER')
      call t%finds(reported, 'KOVER=1', 'and what to do')
   end subroutine special_dimensions

   !> An excavator over a grid of its three strokes: lengths of all links and strokes of all cylinders are kept everywhere.
   subroutine envelope()
      class(chain_study_t), allocatable :: s
      character(4000) :: first, second, third
      integer, parameter :: steps = 4
      integer :: a, b, c, k
      real(wp) :: wrong

      allocate (s)
      first = ''
      second = ''
      third = ''
      do a = 0, steps - 1
         do b = 0, steps - 1
            do c = 0, steps - 1
               write (first, '(a,f0.3,",")') trim(first), -0.2_wp + 0.15_wp*a
               write (second, '(a,f0.3,",")') trim(second), -0.2_wp + 0.15_wp*b
               write (third, '(a,f0.3,",")') trim(third), -0.1_wp + 0.05_wp*c
            end do
         end do
      end do
      call study('EXCAVATOR'//nl//" &CHAIN JNT='A','B','C','D','E','F','G','H','I','J','K','T',"//nl// &
                 ' JX=0.0,0.5,2.6,2.9,5.2,4.6,5.0,6.0,6.6,6.3,5.9,7.0, JY=1.5,1.0,3.4,3.9,3.2,3.9,3.7,1.9,1.6,2.3,2.4,0.5,'//nl// &
                 " LNK='AB','ACDE','EFGHK','HJ','JI','KIT' &END"//nl//" &DRIVES DRIVE='BC','DF','GJ',"//nl// &
                 ' DELT2='//trim(second)//nl//' DELT3='//trim(third)//" &END &OUTPUTS OUTPUT='point T' &END"//nl// &
                 ' &METHOD NDES=64, DELT='//trim(first)//' &END'//nl, s)
      call t%is_true(all(s%motion%closed), 'the arm reaches every point of the grid of its strokes')
      wrong = 0.0_wp
      do k = 1, size(s%motion%closed)
         associate (z => s%motion%states(k)%joint(:, 0))
            wrong = max(wrong, abs(abs(z(3) - z(2)) - (abs(cmplx(2.1_wp, 2.4_wp, wp)) + s%inputs(1, k))), &
                        abs(abs(z(6) - z(4)) - (1.7_wp + s%inputs(2, k))), &
                        abs(abs(z(10) - z(7)) - (abs(cmplx(1.3_wp, 1.4_wp, wp)) + s%inputs(3, k))), &
                        abs(abs(z(12) - z(11)) - abs(cmplx(1.1_wp, 1.9_wp, wp))), &
                        abs(abs(z(10) - z(8)) - 0.5_wp), abs(abs(z(10) - z(9)) - abs(cmplx(0.3_wp, 0.7_wp, wp))))
         end associate
      end do
      call t%close_to(wrong, 0.0_wp, 1.0e-12_wp, 'strokes and lengths are kept')
   end subroutine envelope
end program test_chain_motion
