!> From file to data set: the notation, the defaults, capacities, and every mistake with its words.
program test_input
   use check, only: checks_t
   use psalm_data_set, only: data_set_t, read_data_sets
   use psalm_kinds, only: wp
   use psalm_setup, only: set_up
   use psalm_topology, only: topology_t, dimensions_t
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a'), file = 'build/test_input.nml'
   character(*), parameter :: links = ' &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1,'//nl// &
                              '  ARCL=40.,120.,80.,130., GAMA=3*0.,180., NOUTLK=3, NOUTLP=1 &END'//nl
   character(*), parameter :: method = ' &METHOD MOTION=1, NDES=3, DELT=0.,30.,60. &END'//nl
   character(*), parameter :: whole = 'A FOUR-BAR'//nl//links//method
   type(checks_t) :: t
   type(data_set_t), allocatable :: sets(:)
   type(diagnostics_t) :: findings

   call defaults()
   call notation()
   call capacities()
   call wrong_text()
   call wrong_items()
   call wrong_topology()
   call wrong_references()
   call warnings()
   call t%report()

contains

   !> Read a text as a file would be, and SETUP every case.
   subroutine read_text(text)
      character(*), intent(in) :: text
      type(topology_t) :: topology
      type(dimensions_t) :: dimensions
      type(diagnostics_t) :: fresh
      integer :: unit, i

      open (newunit=unit, file=file, access='stream', form='unformatted', status='replace')
      write (unit) text
      close (unit)
      findings = fresh
      if (allocated(sets)) deallocate (sets)
      call read_data_sets(file, sets, findings)
      if (findings%failed()) return
      do i = 1, size(sets)
         call set_up(sets(i), topology, dimensions, findings)
      end do
   end subroutine read_text

   subroutine wrong(text, words)
      character(*), intent(in) :: text, words

      call read_text(text)
      call t%equal_integer(findings%exit_code(), 2, 'exit status 2: '//words)
      call t%finds(findings, words, 'message')
   end subroutine wrong

   !> `whole` with one piece of text replaced.
   function altered(from, to) result(text)
      character(*), intent(in) :: from, to
      character(:), allocatable :: text
      integer :: at

      at = index(whole, from)
      text = whole(:at - 1)//to//whole(at + len(from):)
      call t%is_true(at > 0, 'the text to be altered is there: '//from)
   end function altered

   subroutine defaults()
      call read_text(whole)
      call t%equal_integer(findings%exit_code(), 0, 'a sound case has no errors')
      associate (s => sets(1))
         call t%equal_text(s%title, 'A FOUR-BAR', 'title')
         call t%is_true(abs(s%bounce - 3.0_wp) + abs(s%expand - 2.0_wp) + abs(s%snake - 0.5_wp) + abs(s%reduce - 0.25_wp) &
                        + abs(s%shrink - 0.5_wp) <= 0.0_wp, 'coefficients 3, 2, 0.5, 0.25, 0.5')
         call t%is_true(s%niter == 2 .and. s%ncheck == 1 .and. s%istart == 19 .and. s%nguess == 0, 'NITER, NCHECK, ISTART, NGUESS')
         call t%is_true(s%nviol == 30 .and. s%nprint == 100 .and. s%nprt == 20 .and. s%last == 1 .and. s%iplot == 0, 'LIMITS')
         call t%is_true(abs(s%tangle - 50.0_wp) + abs(s%toggle - 0.1_wp) + abs(s%stepin - 0.001_wp) + abs(s%var - 0.1_wp) + &
                        abs(s%small - 0.001_wp) + abs(s%fmin) <= 0.0_wp, 'TANGLE, TOGGLE, STEPIN, VAR, SMALL, FMIN')
         call t%is_true(.not. s%desired .and. .not. s%wants_search(), 'NDES and DELT alone make an analysis')
      end associate
   end subroutine defaults

   subroutine notation()
      call read_text(whole(:len(whole) - 1))
      call t%equal_integer(findings%exit_code(), 0, 'no line end after the last terminator')
      call read_text('A FOUR-BAR'//achar(13)//nl//' $links nloop=1 maxarc=4 ilink=1 2 3 4 iloop=1,0,0,1'//achar(13)//nl// &
                     ' arcl = 40., 1.2d2 80 ,130. ! a comment with '' in it'//nl// &
                     ' gama(1,4)=180. noutlk=3 noutlp=1 $end'//nl//method)
      call t%equal_integer(findings%exit_code(), 0, 'small letters, $, blanks, CRLF, comments, two subscripts')
      call t%is_true(abs(sets(1)%gama(4, 1) - 180.0_wp) + abs(sets(1)%arcl(2, 1) - 120.0_wp) <= 0.0_wp, 'the values of it')
      call read_text('T'//nl//method//' &RATES SPEED=3 &END'//nl//links)
      call t%equal_integer(findings%exit_code(), 0, 'groups in any order, groups of other programs skipped')
      call read_text(whole//' &LIMITS LAST=0 /'//nl//nl//'SECOND'//nl//links//method)
      call t%equal_integer(size(sets), 2, 'LAST=0: another case follows')
      call t%equal_text(sets(2)%title, 'SECOND', 'title of the second case')
      call read_text(whole//'NOT A CASE, LAST IS 1'//nl//'rubbish')
      call t%equal_integer(size(sets), 1, 'LAST=1: what follows is not read')
      call read_text(altered('ARCL=40.,120.', 'ARCL=,120.'))
      call t%is_true(findings%count == 0 .and. sets(1)%arcl(1, 1) <= 0.0_wp, 'null values leave the default')
   end subroutine notation

   subroutine capacities()
      character(:), allocatable :: text
      integer, parameter :: loops = 64
      integer :: i

      ! every loop a four-bar on the crank, its frame arc that of loop 1
      text = 'LARGE'//nl//' &LINKS NLOOP=64, MAXARC=64,'//nl//'ILINK='
      do i = 1, loops
         text = text//'1,2,3,4,60*0,'//nl
      end do
      text = text//'ILOOP='
      do i = 1, loops
         text = text//'1,0,0,1,60*0,'//nl
      end do
      text = text//'ARCL='
      do i = 1, loops
         text = text//'40.,120.,80.,130.,60*0.,'//nl
      end do
      text = text//' GAMA=3*0.,180., NOUTLK=3, NOUTLP=64 &END'//nl//' &METHOD MOTION=1, NDES=100000, DELT=100000*1., '// &
             'DESANG=100000*90., IVA=4096*0 &END'//nl
      call read_text(text)
      call t%equal_integer(findings%exit_code(), 0, '64 loops, 4096 arcs, 100000 positions')
      call t%equal_integer(size(sets(1)%delt), 100000, '100000 increments')
      text = 'MANY VARIABLES'//nl//' &LINKS NLOOP=250, MAXARC=4, ILINK='//repeat('1,2,3,4,', 250)//nl//' ILOOP='// &
             repeat('1,0,0,1,', 250)//nl//' ARCL='//repeat('40.,120.,80.,130.,', 250)//' GAMA=3*0.,180., NOUTLK=3, NOUTLP=250'// &
             ' &END'//nl//' &METHOD MOTION=1, NDES=1, DELT=0., DESANG=90., IVA='//repeat('0,1,1,0,', 250)//' &END'//nl
      call read_text(text)
      call t%equal_integer(findings%exit_code(), 0, '500 variables')
   end subroutine capacities

   subroutine wrong_text()
      call wrong('', 'the file is empty')
      call wrong(nl//'   '//nl, 'the file is empty')
      call wrong(links//method, 'title')
      call wrong('T'//nl//method, '&LINKS: the group is missing')
      call wrong('T'//nl//links, '&METHOD: the group is missing')
      call wrong('T'//nl//' &LINK NLOOP=1 &END'//nl//method, 'did you mean &LINKS?')
      call wrong('T'//nl//links(:len(links) - 6)//nl//method, 'is not closed')
      call wrong(whole//links, 'the group is given twice')
      call wrong(whole//' &LIMITS LAST=0 &END'//nl, 'LAST=0 announces another case')
   end subroutine wrong_text

   subroutine wrong_items()
      call wrong(altered('MAXARC=4', 'MAXRAC=4'), 'did you mean MAXARC?')
      call wrong(altered('NLOOP=1,', ''), '&LINKS NLOOP: is required')
      call wrong(altered('NLOOP=1', 'NLOOP=0'), 'must lie in 1 to')
      call wrong(altered('NLOOP=1', 'NLOOP=2000000000'), 'must lie in 1 to')
      call wrong(altered('MAXARC=4', 'MAXARC=4.0'), 'an integer is expected, not a real')
      call wrong(altered('MAXARC=4', 'MAXARC=four'), 'an integer is expected')
      call wrong(altered('NOUTLK=3', 'NOUTLK=-2147483648'), 'the integer is too large')
      call wrong(altered('NDES=3', 'IVA=0,1, DESANG=3*9., NDES=3')//' &LIMITS LIMVAL=1, OPLOW=-9., OPHIGH=-1. &END'//nl, &
                 'a length needs an upper limit above zero')
      call wrong(altered('NLOOP=1', 'NLOOP=1,2'), 'too many values')
      call wrong(altered('120.,80.', '120.,abc'), 'a number is expected')
      call wrong(altered('120.,80.', '120.,NaN'), 'a finite number is expected')
      call wrong(altered('120.,80.', '120.,Infinity'), 'a finite number is expected')
      call wrong(altered('120.,80.', '120.,1e400'), 'the number is too large')
      call wrong(altered('80.,130.', '80.,130.,5.'), 'too many values')
      call wrong(altered('80.,130.', '-80.,130.'), 'is negative')
      call wrong(altered('NOUTLK=3,', ''), '&LINKS NOUTLK: is required')
      call wrong(altered('NOUTLK=3', 'NOUTLK=7'), 'must name an arc from 1 to 4')
      call wrong(altered('NOUTLP=1', 'NOUTLP=2'), 'must name a loop from 1 to 1')
      call wrong(altered('NDES=3, ', ''), 'the number of prescribed positions is required')
      call wrong(altered('NDES=3', 'NDES=5'), 'only 3 values given')
      call wrong(altered('NDES=3', 'NDES=-1'), 'must lie in 1 to')
      call wrong(altered('MOTION=1', 'MOTION=4'), 'must lie in 0 to 3')
      call wrong(altered('MOTION=1', 'MOTION=3'), 'does not slide')
      call wrong(altered('NDES=3', 'ISTART=0, NDES=3'), 'must lie in 1 to')
      call wrong(altered('NDES=3', 'REDUCE=1.5, NDES=3'), 'must lie between 0 and 1')
      call wrong(altered('NDES=3', 'BOUNCE=1., NDES=3'), 'must be above 1')
      call wrong(altered('NDES=3', 'IVA=0,2, NDES=3'), 'entries are 0 (fixed) or 1 (may vary)')
      call wrong(altered('NDES=3', 'IVA=0,1, NDES=3'), 'a search needs desired values')
      call wrong(altered('NDES=3', 'IVA=0,1, DESANG=3*9., VAR=0., NDES=3'), 'must give a value for each of the 1 variables')
      call wrong(whole//' &LIMITS TANGLE=95. &END'//nl, 'must lie between 0 and 90 degrees')
      call wrong(altered('NDES=3', 'FOO=1, BAR=2, NDES=3'), '&METHOD BAR')
      call t%is_true(findings%count >= 2, 'all mistakes are told in one run')
      call t%is_true(findings%list(1)%line == 4, 'a message names its line')
   end subroutine wrong_items

   !> ILINK and ILOOP inconsistent, each way.
   subroutine wrong_topology()
      character(*), parameter :: ilink = 'ILINK=1,2,3,4', iloop = 'ILOOP=1,0,0,1'

      call wrong(altered(iloop, 'ILOOP=1,0,1,1'), 'must have two')
      call wrong(altered(iloop, 'ILOOP=1,0,0,0'), 'has 3 undetermined arcs')
      call wrong('T'//nl//' &LINKS NLOOP=1, MAXARC=5, ILINK=1,2,-5,4,5, ILOOP=1,0,1,0,1,'// &
                 ' ARCL=5*10., NOUTLK=3, NOUTLP=1 &END'//nl// &
                 method, 'they must be adjacent')
      call wrong(altered(ilink, 'ILINK=1,2,7,4'), 'its own number')
      call wrong(altered(ilink, 'ILINK=2,2,3,4'), 'must be 1 (the input link)')
      call wrong(altered(iloop, 'ILOOP=0,0,0,1'), 'must be 1 for a turning input link')
      call wrong(altered(iloop, 'ILOOP=1,-9,0,1'), 'names guide 9')
      call wrong(altered(iloop, 'ILOOP=1,-2,0,1'), 'names the slide itself')
      call wrong(altered(iloop, 'ILOOP=1,-3,-2,1'), 'two slides that guide each other')
      call wrong(altered(ilink, 'ILINK=1,2,-3,4'), 'opposite sign')
      call wrong(altered(ilink, 'ILINK=1,2,0,4'), 'but arcs follow')
      call wrong(altered(iloop, 'ILOOP=1,0,0,2'), 'not yet determined')
      call wrong('T'//nl//' &LINKS NLOOP=1, MAXARC=5, ILINK=-1,2,3,-5,4, ILOOP=-4,0,-2,1,1, '//nl// &
                 ' ARCL=0,0,0,150,33, GAMA=3*0,90,0, NOUTLK=3, NOUTLP=1 &END'//nl//method, &
                 'the frame: ILINK=5 and ILOOP=1 are expected')
      call wrong(altered(ilink, 'ILINK=1,2,3,1'), 'the frame: ILINK=4 and ILOOP=1 are expected')
      call wrong('T'//nl//' &LINKS NLOOP=1, MAXARC=5, ILINK=1,-1,3,4,5, ILOOP=1,1,0,0,1,'// &
                 ' ARCL=5*10., NOUTLK=3, NOUTLP=1 &END'//nl// &
                 method, 'common with arc 1 of the same loop')
      call wrong(altered('120.,80.', '0.,80.'), 'needs a positive length')
      call wrong('T'//nl//' &LINKS NLOOP=1, MAXARC=4, ILINK=-1,2,3,4, ILOOP=-4,0,-2,1, ARCL=3*0.,9., GAMA=3*0.,90., NOUTLK=3,'// &
                 ' NOUTLP=1 &END'//nl//' &METHOD MOTION=1, IKIN=30 &END'//nl, 'the input slides')
   end subroutine wrong_topology

   !> References between arcs and limits of variables that cannot be meant.
   subroutine wrong_references()
      character(*), parameter :: arrays = 'MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1'
      character(*), parameter :: second = ' &LINKS NLOOP=2, MAXARC=4, ILOOP=1,0,0,1,1,0,0,1, NOUTLK=3, NOUTLP=2,'// &
                                 ' ARCL=40.,120.,80.,130.,', row = ' ILINK=1,2,3,4,'

      call wrong(altered(arrays, 'MAXARC=4, ILINK=1,2,3,0, ILOOP=1,0,0,1'), 'must be 0, because ILINK says there is no such arc')
      call wrong(altered(arrays, 'MAXARC=4, ILINK=1,2,0,0, ILOOP=1,0,0,0'), 'has fewer than three arcs')
      call wrong('T'//nl//second//'40.,120.,80.,130.,'//row//'-7,2,3,4 &END'//nl//method, &
                 'refers to arc 7 of loop 1, which does not exist')
      call wrong('T'//nl//' &LINKS NLOOP=1, MAXARC=4, ILINK=-1,2,3,4, ILOOP=-3,0,-2,1, ARCL=3*0.,9., NOUTLK=3, NOUTLP=1 &END'// &
                 nl//method, 'as the guide of the sliding input, but that is not a frame arc')
      call wrong(altered('NDES=3', 'IVA=0,1, DESANG=3*9., NDES=3')//' &LIMITS LIMVAL=1, OPLOW=9., OPHIGH=1. &END'//nl, &
                 'variable 1 has a lower limit above its upper limit')
      call wrong(altered('NDES=3', 'IVA=0,1, DESANG=3*9., NGUESS=3, NDES=3'), '1 variables has 2 vertices; found 3')
      call read_text('T'//nl//second//'41.,120.,80.,130., GAMA=4*0.,5.,'//row//'1,2,3,4 &END'//nl//method)
      call t%finds(findings, 'is not used: ILINK is positive, the arc has the length of arc', 'a length that is not used')
      call t%finds(findings, 'is not used: ILINK is positive, the arc has the direction of arc', 'an angle that is not used')
      call read_text('T'//nl//second//'40.,120.,80.,130.,'//row//'1,2,3,4 &END'//nl//method)
      call t%equal_integer(findings%count, 0, 'the same length given again is no fault')
   end subroutine wrong_references

   subroutine warnings()
      call read_text(altered('NDES=3', 'IVA=4*1, IVG=0,1,0,0, DESANG=3*9., NDES=3'))
      call t%finds(findings, 'its direction is a result and cannot vary', 'a variable angle of an undetermined link')
      call t%equal_integer(findings%exit_code(), 0, 'warnings do not stop')
      call read_text('T'//nl//' &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1, ARCL=40.,140.,5.,10., GAMA=3*0.,270.,'// &
                     'NOUTLK=3, NOUTLP=1 &END'//nl//' &METHOD MOTION=3, NDES=1, DELT=0., DESANG=1., IVA=0,1,1,0 &END'//nl)
      call t%finds(findings, 'slides: its length is a result and cannot vary', 'a variable that is a slide')
      call t%finds(findings, 'slides: the length given is not used', 'a length given for a slide')
      call read_text(altered('MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1', 'MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1')// &
                     ' &LIMITS FOO=1 &END')
      call t%equal_integer(findings%exit_code(), 2, 'an unknown item of LIMITS is an error')
      call read_text(repeat('X', 90)//nl//links//method)
      call t%finds(findings, 'cut to its first 72 columns', 'a long title')
      call read_text(altered('NDES=3', 'ISTART=20, NDES=3'))
      call t%finds(findings, 'must be odd; 21 is used', 'an even random integer')
   end subroutine warnings
end program test_input
