!> From file to data set: the notation, the defaults, capacities, and every mistake with its words.
program test_input
   use check, only: checks_t
   use psalm_data_set, only: data_set_t, read_data_sets
   use psalm_group_table, only: known_groups
   use psalm_kinds, only: wp
   use psalm_number, only: parse_real
   use psalm_setup, only: set_up
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
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
   call subscripts()
   call groups()
   call counts()
   call places()
   call many()
   call numbers()
   call wrong_topology()
   call wrong_references()
   call wrong_regions()
   call wrong_segments()
   call wrong_notation()
   call warnings()
   call t%report()

contains

   !> Read a text as a file would be, and SETUP every case.
   subroutine read_text(text)
      character(*), intent(in) :: text
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
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
         call set_up(sets(i), mechanism, dimensions, parameters, findings)
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
         call t%is_true(abs(s%method%bounce - 3.0_wp) + abs(s%method%expand - 2.0_wp) + abs(s%method%snake - 0.5_wp) + &
                        abs(s%method%reduce - 0.25_wp) &
                        + abs(s%method%shrink - 0.5_wp) <= 0.0_wp, 'coefficients 3, 2, 0.5, 0.25, 0.5')
         call t%is_true(s%method%niter == 2 .and. s%method%ncheck == 1 .and. s%method%istart == 19 .and. s%method%nguess == 0, &
                        'NITER, NCHECK, ISTART, NGUESS')
         call t%is_true(s%limits%nviol == 30 .and. s%limits%nprint == 100 .and. s%limits%nprt == 20 .and. s%limits%last == &
                        1 .and. s%limits%iplot == 0, 'LIMITS')
         call t%is_true(abs(s%limits%tangle - 50.0_wp) + abs(s%limits%toggle - 0.1_wp) + abs(s%limits%stepin - 0.001_wp) + &
                        abs(s%method%var - 0.1_wp) + &
                        abs(s%method%small - 0.001_wp) + abs(s%method%fmin) <= 0.0_wp, 'TANGLE, TOGGLE, STEPIN, VAR, SMALL, FMIN')
         call t%is_true(.not. s%method%desired .and. .not. s%wants_search(), 'NDES and DELT alone make an analysis')
      end associate
   end subroutine defaults

   subroutine notation()
      call read_text(whole(:len(whole) - 1))
      call t%equal_integer(findings%exit_code(), 0, 'no line end after the last terminator')
      call read_text('A FOUR-BAR'//achar(13)//nl//' $links nloop=1 maxarc=4 ilink=1 2 3 4 iloop=1,0,0,1'//achar(13)//nl// &
                     ' arcl = 40., 1.2d2 80 ,130. ! a comment with '' in it'//nl// &
                     ' gama(1,4)=180. noutlk=3 noutlp=1 $end'//nl//method)
      call t%equal_integer(findings%exit_code(), 0, 'small letters, $, blanks, CRLF, comments, two subscripts')
      call t%is_true(abs(sets(1)%links%gama(4, 1) - 180.0_wp) + abs(sets(1)%links%arcl(2, 1) - 120.0_wp) <= 0.0_wp, &
                     'the values of it')
      call read_text('T'//nl//method//' &RATES SPEED=3 &END'//nl//links)
      call t%equal_integer(findings%exit_code(), 0, 'groups in any order, groups of other programs skipped')
      call read_text(whole//' &LIMITS LAST=0 /'//nl//nl//'SECOND'//nl//links//method)
      call t%equal_integer(size(sets), 2, 'LAST=0: another case follows')
      call t%equal_text(sets(2)%title, 'SECOND', 'title of the second case')
      call read_text(whole//'NOT A CASE, LAST IS 1'//nl//'rubbish')
      call t%equal_integer(size(sets), 1, 'LAST=1: what follows is not read')
      call read_text(altered('ARCL=40.,120.', 'ARCL=,120.'))
      call t%is_true(findings%count == 0 .and. sets(1)%links%arcl(1, 1) <= 0.0_wp, 'null values leave the default')
      call read_text(altered('MAXARC=4', 'MAXARC=+4.00'))
      call t%is_true(findings%count == 0 .and. sets(1)%links%maxarc == 4, 'an integer with a decimal point and zeros')
      call read_text(altered('MAXARC=4', 'MAXARC=4.'))
      call t%is_true(findings%count == 0 .and. sets(1)%links%maxarc == 4, 'an integer with a decimal point')
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
      call t%equal_integer(size(sets(1)%method%delt), 100000, '100000 increments')
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
      call wrong('T'//nl//' &LINK NLOOP=1 &END'//nl//method, 'did you mean &LINKS, or &CHAIN of a sketch?')
      call wrong('T'//nl//links(:len(links) - 6)//nl//method, 'is not closed')
      call wrong(whole//links, 'the group is given twice')
      call wrong(whole//' &LIMITS LAST=0 &END'//nl, 'LAST=0 declares another case')
   end subroutine wrong_text

   subroutine wrong_items()
      call wrong(altered('MAXARC=4', 'MAXRAC=4'), 'did you mean MAXARC?')
      call wrong(altered('NLOOP=1,', ''), '&LINKS NLOOP: missing; this item is required')
      call wrong(altered('NLOOP=1', 'NLOOP=0'), 'must be from 1 to')
      call wrong(altered('NLOOP=1', 'NLOOP=2000000000'), 'must be from 1 to')
      call wrong(altered('MAXARC=4', 'MAXARC=4.5'), 'an integer is expected, not a real')
      call wrong(altered('MAXARC=4', 'MAXARC=4.0E0'), 'an integer is expected, not a real')
      call wrong(altered('MAXARC=4', 'MAXARC=4..'), 'an integer is expected')
      call wrong(altered('MAXARC=4', 'MAXARC=four'), 'an integer is expected')
      call wrong(altered('NOUTLK=3', 'NOUTLK=-2147483648'), 'the integer is too large')
      call wrong(altered('NDES=3', 'IVA=0,1, DESANG=3*9., NDES=3')//' &LIMITS LIMVAL=1, OPLOW=-9., OPHIGH=-1. &END'//nl, &
                 'a length needs an upper limit above zero')
      call wrong(altered('NLOOP=1', 'NLOOP=1,2'), 'too many values')
      call wrong(altered('NLOOP=1', 'NLOOP=1,0'), 'too many values')
      call wrong(altered('120.,80.', '0*120.,80.'), 'no valid repeat count; write 4*0.0')
      call wrong(altered('120.,80.', '-2*120.,80.'), 'no valid repeat count')
      call wrong(altered('120.,80.', 'two*120.,80.'), 'no valid repeat count')
      call wrong(altered('120.,80.', '1.0*120.,80.'), 'no valid repeat count')
      call wrong(altered('120.,80.', '120.,abc'), 'a number is expected')
      call wrong(altered('120.,80.', '120.,NaN'), 'a finite number is expected')
      call wrong(altered('120.,80.', '120.,Infinity'), 'a finite number is expected')
      call wrong(altered('120.,80.', '120.,1e400'), 'the number is too large')
      call wrong(altered('80.,130.', '80.,130.,5.'), 'too many values')
      call wrong(altered('80.,130.', '-80.,130.'), 'is negative')
      call wrong(altered('NOUTLK=3,', ''), '&LINKS NOUTLK: missing; this item is required')
      call wrong(altered('NOUTLK=3', 'NOUTLK=7'), 'must name an arc from 1 to 4')
      call wrong(altered('NOUTLP=1', 'NOUTLP=2'), 'must name a loop from 1 to 1')
      call wrong('T'//nl//links//' &METHOD CRNKI=1. &END'//nl, 'the number of prescribed positions is required')
      call read_text(altered('NDES=3, ', ''))
      call t%is_true(.not. findings%failed(), 'it is that of DELT')
      call t%equal_integer(sets(1)%method%ndes, 3, 'which has three values')
      call wrong(altered('NDES=3', 'NDES=5'), 'only 3 values given')
      call wrong(altered('NDES=3', 'NDES=-1'), 'must be from 1 to')
      call wrong(altered('MOTION=1', 'MOTION=5'), 'must be from 0 to 4')
      call wrong(altered('MOTION=1', 'MOTION=3'), 'does not slide')
      call wrong(altered('NDES=3', 'ISTART=0, NDES=3'), 'must be from 1 to')
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

   !> An item with a subscript, beside the case: what is said, and that no element is set.
   subroutine subscripts()
      integer :: i
      character(*), parameter :: malformed(*) = [character(14) :: '()', '( )', '(,2)', '(1,)', '(-1)', '(0,1)', '(2.0)', '(x)', &
                                                 '(1,1,1)', '(1 2)', '(1:2)', '(1,2:3)', '(9999999999)']
      character(*), parameter :: words(*) = [character(44) :: 'lacks a subscript', 'lacks a subscript', 'lacks a subscript', &
         'lacks a subscript', 'counted from 1', 'counted from 1', 'not a real', 'an integer is expected', &
         'more than two subscripts', '(loop,arc) with a comma', 'is a section', 'is a section', 'the integer is too large']

      do i = 1, size(malformed)
         call wrong(altered('NOUTLK=3', 'ARCL'//trim(malformed(i))//'=41.0, NOUTLK=3'), trim(words(i)))
         call t%equal_integer(findings%count, 1, 'one message for ARCL'//trim(malformed(i)))
      end do
      ! products that come out right in 32 bits only
      call wrong(altered('NOUTLK=3', 'ARCL(1073741825,1)=41.0, NOUTLK=3'), 'subscript out of range; there are loops 1 to 1')
      call wrong(altered('NOUTLK=3', 'ARCL(1,1073741825)=41.0, NOUTLK=3'), 'and arcs 1 to 4')
      call wrong(altered('NOUTLK=3', 'ARCL(2,1)=41.0, NOUTLK=3'), 'there are loops 1 to 1 and arcs 1 to 4')
      call wrong(altered('NOUTLK=3', 'ARCL(5)=41.0, NOUTLK=3'), 'there are elements 1 to 4')
      call wrong(altered('NOUTLK=3', 'NOUTLK(2)=3'), 'there is one value only')
      call wrong(altered('DELT=0.', 'DELT(1,1)=0.'), 'takes one subscript, not two')
      call read_text(altered('NOUTLK=3', 'ARCL ( 1 , 2 ) = 121.0, GAMA(4)=179., NOUTLK=3'))
      call t%equal_integer(findings%exit_code(), 0, 'blanks in subscripts')
      call t%is_true(abs(sets(1)%links%arcl(2, 1) - 121.0_wp) + abs(sets(1)%links%gama(4, 1) - 179.0_wp) <= 0.0_wp, &
                     'the values of it')
   end subroutine subscripts

   !> Groups by name; items in the wrong group. What the table says is known is read by a program.
   subroutine groups()
      integer :: i

      call wrong(whole//' &CONST IRANGE=2 &END'//nl, 'unknown group &CONST; did you mean &CONSTR?')
      call wrong(whole//' &SERCH SOLVER=''LSQ'' &END'//nl, 'did you mean &SEARCH?')
      call wrong(whole//' &RATE SPEED=3 &END'//nl, 'did you mean &RATES?')
      call wrong(whole//' &TOLERANCE TOLLEN=3 &END'//nl, 'did you mean &TOLER?')
      call wrong(whole//' &WEATHER WIND=3 &END'//nl, 'a group of your own begins with &USER')
      call wrong(altered('&LINKS', '&LINK'), 'did you mean &LINKS, or &CHAIN of a sketch?')
      call t%equal_integer(findings%count, 1, 'a misspelt group is not missing too')
      call read_text(whole//' &RATES SPEED=3 &END &USERNOTES A=1 &END'//nl)
      call t%equal_integer(findings%exit_code(), 0, 'groups of a sister program and of the user')
      call t%equal_text(sets(1)%skipped, '&RATES (kalm balm ssics muscle calm bridge), &USERNOTES', 'skipped groups are named')
      call t%is_true(index(sets(1)%others, 'SPEED=3') > 0 .and. index(sets(1)%others, 'USERNOTES') > 0, 'and kept')
      do i = 1, size(known_groups)
         if (index(known_groups(i)%programs, 'psalm') == 0) cycle
         call wrong(altered(' &END', ' &END &'//trim(known_groups(i)%name)//' NOTHING=1 &END'), &
                    trim(merge('the group is given twice', 'NOTHING: no such item   ', i <= 2)))
      end do
      call wrong(altered('NOUTLK=3', 'IKIN=3, NOUTLK=3'), '&LINKS IKIN: no such item; it belongs to &METHOD')
      call wrong(altered('NDES=3', "SOLVER='LSQ', NDES=3"), '&METHOD SOLVER: no such item; it belongs to &SEARCH')
      call wrong(whole//' &LIMITS SPEED=3 &END'//nl, '&LIMITS SPEED: no such item; it belongs to &RATES')
      call wrong(whole//' &LIMITS NTRIAL=3 &END'//nl, 'it belongs to &TOLER')
      call wrong(whole//' &LIMITS RPLACE=3 &END'//nl, 'it belongs to &CONSTR')
      call wrong(whole//' &LIMITS MAXTIMES=3 &END'//nl, 'did you mean MAXTIME of &SEARCH?')
      call wrong(whole//' &SEARCH SOLVER=''LN_COBILA'' &END'//nl, "did you mean 'LN_COBYLA'?")
      call t%finds(findings, 'LD_SLSQP', 'the solvers are listed')
   end subroutine groups

   !> More or fewer values than announced.
   subroutine counts()
      call wrong(altered('DELT=0.,30.,60.', 'DELT=0.,30.,60.,90.'), &
                 'NDES=3 positions are declared, but 4 values given; set NDES=4')
      call wrong(altered('DELT=0.,30.,60.', 'DELT=0.,30.,60.,0.'), '4 values given')
      call wrong(altered('NDES=3', 'DESANG=5*1., NDES=3'), '&METHOD DESANG: NDES=3 positions are declared, but 5 values given')
      call wrong(altered('NDES=3', 'ANMULT=1.,1.,1.,1., NDES=3'), '&METHOD ANMULT: NDES=3 positions are declared, but 4')
      call wrong(altered('NLOOP=1', 'NLOOP=2'), 'NLOOP=2 loops are declared, but ILINK has values for 1 only')
      call t%equal_integer(findings%count, 1, 'a loop too many is told once')
      call wrong('T'//nl//' &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4,1,2,3,4, ILOOP=1,0,0,1,1,0,0,1, ARCL=8*10., GAMA=8*5., '// &
                 'NOUTLK=3, NOUTLP=1 &END'//nl//method, 'NLOOP=1 rows of MAXARC=4 are declared, found 2 rows (8 values)')
      call t%equal_integer(findings%count, 1, 'a loop too few is told once')
      call wrong(altered('ARCL=40.,120.,80.,130.', 'ARCL=40,5, 120,5, 80,0, 130,0'), 'the decimal sign is a point, not a comma')
      call read_text(altered('NDES=3', 'DESANG=3*1.,161*0.0, ANMULT=181*1.0, NDES=3'))
      call t%equal_integer(findings%exit_code(), 0, 'repeated values may fill the arrays of positions')
      call read_text(altered('ARCL=40.,120.,80.,130.', 'ARCL=40.,120.,80.,130.,96*0.'))
      call t%equal_integer(findings%exit_code(), 0, 'zeros may fill the arrays of arcs')
      call wrong(altered('NDES=3', 'IVA=0,1,1, DESANG=3*9., NDES=3')//' &LIMITS LIMVAL=1, OPLOW=1., OPHIGH=2*9. &END'//nl, &
                 'each of the 2 variables; found 1. The variables are length of arc 2 in loop 1, length of arc 3 in loop 1')
      call read_text(altered('NDES=3', 'IVA=0,1,1, DESANG=3*9., NDES=3')// &
                     ' &LIMITS LIMVAL=1, OPLOW=120.,1., OPHIGH=120.,90. &END'//nl)
      call t%equal_integer(findings%exit_code(), 0, 'limits that are equal')
      call wrong(altered('NDES=3', 'IVA=0,1,1, DESANG=3*9., NDES=3')//' &LIMITS LIMVAL=1, OPLOW=3*1., OPHIGH=9. &END'//nl, &
                 'OPHIGH: OPLOW and OPHIGH must give a value for each of the 2 variables; found 1.')
      call t%equal_integer(findings%count, 1, 'lower limits enough, upper limits too few: one message')
      call wrong(altered('NDES=3', 'IVA=0,1,1, INGOUT=1, DESANG=3*9., NDES=3')// &
                 ' &LIMITS LIMVAL=1, OPLOW=1., OPHIGH=9. &END'//nl, 'length of arc 3 in loop 1, output angle')
      call wrong(altered('NDES=3', 'IVA=0,1,1, DESANG=3*9., NDES=3')//' &LIMITS LIMVAL=1, OPLOW=1.,7., OPHIGH=9.,5. &END'//nl, &
                 'of the length of arc 3 in loop 1 is above its upper limit')
      call read_text(altered('NDES=3', 'IVA=0,1, DESANG=3*9., NDES=3')//' &LIMITS LIMVAL=1, OPLOW=3*1., OPHIGH=2*9. &END'//nl)
      call t%finds(findings, '3 limits are given, but there are only 1 variables', 'more limits than variables')
      call t%equal_integer(findings%exit_code(), 0, 'more limits than variables: a warning')
   end subroutine counts

   !> The line of a message is that of the value; the first message is that of the mistake.
   subroutine places()
      character(*), parameter :: rows = 'T'//nl//' &LINKS NLOOP=2, MAXARC=4,'//nl//'ILINK=1,2,3,4,'//nl//'1,2,-3,4,'//nl// &
                                 'ILOOP=1,0,0,1,'//nl//'1,0,0,1,'//nl//'ARCL=40.,120.,80.,130.,'//nl//'40.,120.,80.,130.,'//nl// &
                                 ' GAMA=3*0.,180., NOUTLK=3,'//nl//' NOUTLP=2 &END'//nl//method
      character(:), allocatable :: text
      integer :: at

      call wrong(rows, 'of opposite sign')
      call t%equal_integer(findings%list(1)%line, 4, 'opposite signs: the line of the row')
      at = index(rows, '-3,4')
      text = rows(:at - 1)//'7,4'//rows(at + 4:)
      call wrong(text, 'arc 3 of loop 2 must be')
      call t%equal_integer(findings%list(1)%line, 4, 'a wrong number: the line of the row')
      at = index(rows, ' NOUTLP=2')
      text = rows(:at - 1)//' NOUTLP=9'//rows(at + 9:)
      at = index(text, '-3,4')
      text = text(:at - 1)//'3,4'//text(at + 4:)
      call wrong(text, 'must name a loop from 1 to 2')
      call t%equal_integer(findings%list(1)%line, 10, 'NOUTLP: its line')
      call wrong(altered('120.,80.', '120.,'//nl//'-80.'), 'is negative')
      call t%equal_integer(findings%list(1)%line, 4, 'a negative length: its line')
      call wrong(altered('DELT=0.,30.,60.', 'DELT=0.,30.,60.,'//nl//'90.'), '4 values given')
      call t%equal_integer(findings%list(1)%line, 5, 'a value too many: its line')
      call wrong(altered('ILINK=1,2,3,4, ILOOP=1,0,0,1', 'ILINK=1,2,3,4, ILOOP=1,1,0,0'), 'the frame arc must come last')
      call t%equal_integer(findings%count, 1, 'the frame arc second: one message')
      call wrong('T'//nl//' &LINKS NLOOP=1, MAXARC=3, ILINK=1,2,3, ILOOP=1,0,0, ARCL=3*10., NOUTLK=3, NOUTLP=1 &END'//nl//method, &
                 'the frame arc seems to be missing')
      call read_text(altered('DELT=0.,30.,60.', 'DELT=0.,30.,'//nl//'0.'))
      call t%finds(findings, 'positions 1 and 3 have the same input', 'a position given twice')
      call t%equal_integer(findings%list(1)%line, 5, 'a position given twice: its line')
   end subroutine places

   !> Of one kind a few findings are reported, the others counted.
   subroutine many()
      call wrong(altered('NOUTLK=3', repeat('Q=1 ', 100)//'NOUTLK=3'), 'and 95 more unknown items')
      call t%equal_integer(findings%count, 6, 'of 100 unknown items five are told')
      call wrong(altered('NOUTLK=3', repeat('ARCL(7)=1. ', 100)//'NOUTLK=3'), 'and 95 more')
      call t%equal_integer(findings%count, 6, 'of 100 errors of one item five are told')
      call wrong(altered('NLOOP=1', 'NLOOP=100000'), 'NLOOP=100000 loops are declared')
      call t%equal_integer(findings%count, 1, 'one error for 100000 loops')
   end subroutine many

   !> The short way to a number gives the bits of the long one.
   subroutine numbers()
      character(*), parameter :: written(*) = [character(24) :: '0', '-0.0', '1', '+7.25', '.5', '5.', '-123456789.012345', '0.1', &
         '1e22', '1D-22', '123456789012345e-22', '4.35', '0.000001', '9007199254740993', '1.7976931348623157e300', &
         '5E-324', '1+2']
      character(*), parameter :: no_numbers(*) = [character(8) :: '', '.', '+', 'e5', '1e', '1e+', '1.2.3', '1-', '--1', '1x', &
         '0x10', '1e:', '1eA', '1e1A']
      character(:), allocatable :: reason
      character(24) :: number
      real(wp) :: short, long
      logical :: valid
      integer :: i

      do i = 1, size(written)
         call parse_real(trim(written(i)), short, valid, reason)
         number = written(i)
         read (number, *) long
         call t%is_true(valid .and. abs(short - long) <= 0.0_wp .and. sign(1.0_wp, short) == sign(1.0_wp, long), &
                        'the number '//trim(written(i)))
      end do
      do i = 1, size(no_numbers)
         call parse_real(trim(no_numbers(i)), short, valid, reason)
         call t%is_true(.not. valid, 'no number: '//trim(no_numbers(i)))
      end do
      call parse_real('1.'//repeat('3', 2000), short, valid, reason)
      call t%is_true(.not. valid .and. index(reason, 'at most 1000 characters') > 0, 'a number of 2000 digits')
   end subroutine numbers

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
      call wrong(altered(iloop, 'ILOOP=0,0,0,1'), 'ILOOP: arc 1 of loop 1 must be 1 for a turning input link')
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
                 ' NOUTLP=1 &END'//nl//' &METHOD MOTION=1, IKIN=30 &END'//nl, 'with a sliding input give NDES and DELT')
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
                 'of the length of arc 2 in loop 1 is above its upper limit')
      call wrong(altered('NDES=3', 'IVA=0,1, DESANG=3*9., NGUESS=3, NDES=3'), '1 variables has 2 vertices; found 3')
      call read_text('T'//nl//second//'41.,120.,80.,130., GAMA=4*0.,5.,'//row//'1,2,3,4 &END'//nl//method)
      call t%finds(findings, 'is not used: ILINK is positive, the arc has the length of arc', 'a length that is not used')
      call t%finds(findings, 'is not used: ILINK is positive, the arc has the direction of arc', 'an angle that is not used')
      call read_text('T'//nl//second//'40.,120.,80.,130.,'//row//'1,2,3,4 &END'//nl//method)
      call t%equal_integer(findings%count, 0, 'the same length given again is no fault')
   end subroutine wrong_references

   !> Regions that cannot be meant.
   subroutine wrong_regions()
      call wrong_constr('NREGN=0, RKIND=1, RPLACE=0.,0.,1.,1.', 'is 0, but regions are given')
      call read_text(whole//' &CONSTR RKIND=1,3, RPLACE=0.,0.,1.,1.,0.,0.,1. &END'//nl)
      call t%is_true(.not. findings%failed(), 'regions need no number')
      call t%equal_integer(size(sets(1)%constr%regions), 2, 'they are counted')
      call wrong_constr('NREGN=2, RKIND=1,2, RPLACE=0.,0.,1.,1.', 'four numbers are expected for each of 2 regions; found 4')
      call wrong_constr('NREGN=1, RKIND=1, RPLACE=0.,1.,0.,2.', 'the box has no extent')
      call wrong_constr('NREGN=1, RKIND=1, RPLACE=0.,1.,2.,1.', 'the box has no extent')
      call wrong_constr('NREGN=1, RKIND=-3, RPLACE=0.,1.,0.,0.', 'the radius must be above 0')
      call wrong_constr('NREGN=1, RKIND=4, RPLACE=0.,1.,2.,0.', 'negative: outside forbidden; found 4')
      call wrong_constr('NREGN=1, RKIND=3, RPLACE=0.,1.,2.,0., RLINK=2', 'arc 2 is named, but not its loop')
      call wrong_constr('NREGN=1, RKIND=3, RPLACE=0.,1.,2.,0., RLINK=2, RLOOP=2', 'there is no loop 2')
      call wrong_constr('NREGN=1, RKIND=3, RPLACE=0.,1.,2.,0., RLINK=2, RLOOP=-1', 'there is no loop -1')
      call wrong_constr('NREGN=1, RKIND=3, RPLACE=0.,1.,2.,0., RLINK=5, RLOOP=1', 'negative for the joint at its start); found 5')
      call wrong_constr('NREGN=1, RKIND=3, RPLACE=0.,1.,2.,0., RLOOP=1', 'the number of an arc is expected')
      call wrong_constr('IRANGE=3', 'must be from 0 to 2')
      call wrong_constr('NREGN=1, RKIND=3, RPLACE=0.,1.,2.,0., RCLEAR=-1.', 'a least distance is at least 0')
      call wrong_constr('NREGN=1, RKIND=3, RPLACE=0.,1.,2.,0., RSEG=1', 'the number of a segment is expected')
      call wrong_constr('NREGN=1, RKIND=3, RPLACE=0.,1.,2.,0., RSEG=-1', 'there are no segments; give NSEG')
      call wrong_constr('NSEG=1, SLINK=-1,1, SLOOP=2*1, NREGN=1, RKIND=3, RPLACE=0.,1.,2.,0., RSEG=1, RLINK=1, RLOOP=1', &
                        'cannot be for a joint too')
   end subroutine wrong_regions

   !> Links with a width that cannot be meant.
   subroutine wrong_segments()
      call read_text(whole//' &CONSTR SLINK=-1,1, SLOOP=1,1 &END'//nl)
      call t%is_true(.not. findings%failed(), 'segments need no number')
      call t%equal_integer(size(sets(1)%constr%segments), 1, 'they are counted, two points each')
      call wrong_constr('NSEG=101', 'NSEG')
      call wrong_constr('NSEG=1, SLINK=1,1, SLOOP=1,1', 'its two points are one')
      call wrong_constr('NSEG=1, SLINK=1,2, SLOOP=0,1', 'arc 1 is named, but not its loop')
      call wrong_constr('NSEG=1, SLINK=-1,1, SLOOP=1,2', 'there is no loop 2')
      call wrong_constr('NSEG=1, SLINK=-1,5, SLOOP=1,1', 'negative for the joint at its start); found 5')
      call wrong_constr('NSEG=1, SLINK=-1,1, SLOOP=1,1, SWIDTH=-2.', 'a width is at least 0')
      call wrong_constr('NSEG=1, SLINK=-1,1, SLOOP=1,1, SCLEAR=-2.', 'a least distance is at least 0')
      call wrong_constr("NSEG=1, SLINK=-1,1, SLOOP=1,1, SJNT='A B'", 'joints have names in a sketch (&CHAIN) only')
   end subroutine wrong_segments

   subroutine wrong_constr(items, words)
      character(*), intent(in) :: items, words

      call wrong(whole//' &CONSTR '//items//' &END'//nl, words)
      call t%equal_integer(findings%count, 1, 'one message: '//words)
   end subroutine wrong_constr

   !> Groups, words and values where they cannot stand.
   subroutine wrong_notation()
      character(:), allocatable :: text
      integer :: i

      call wrong(altered('NDES=3', 'IFREE=1, DESANG=3*9., NDES=3')//" &SEARCH SOLVER='LSQ' &END"//nl, &
                 'free timing is a part of a search, but no dimension may vary')
      call wrong(whole//' &TOLER TOLGAM=4*200. &END'//nl, 'the tolerance of an angle is more than 180 degrees')
      call wrong(whole//" &SEARCH SOLVER='LSQ','SIMPLEX' &END"//nl, 'expects one word')
      call wrong(whole//" &SEARCH NSTART='7' &END"//nl, "an integer is expected; found '7'")
      call wrong(altered('ARCL=40.,', "ARCL='40.',"), "a number is expected; found '40.'")
      call wrong(altered('ARCL=40.,', 'ARCL=2000000000*40.,'), 'too many values')
      call wrong(altered('NLOOP=1', '5, NLOOP=1'), "expected NAME = value, found '5'")
      call t%equal_integer(findings%count, 1, 'a value before any name is told once')
      call wrong(altered('NOUTLK=3', 'ARCL(1=5, NOUTLK=3'), 'ARCL(1')
      call read_text(altered('&LINKS ', '&LINKS , '))
      call t%equal_integer(findings%count, 0, 'a comma before any name is nothing')
      call read_text(altered('NOUTLP=1 &END', 'NOUTLP=1 &END and so on'))
      call t%finds(findings, "'and so on' after the end of the group is ignored", 'words after a group')
      call t%equal_integer(findings%exit_code(), 0, 'words after a group: a warning')
      text = whole
      do i = 1, 1000
         text = text//' &USER'//to_text(i)//' A=1 &END'//nl
      end do
      call wrong(text, 'more than 1000 groups in one case')
   end subroutine wrong_notation

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
      ! loop 2 traced along arcs 1 and 2 of loop 1: the crank by -1, a coupler whose second side begins at the crank pin
      call read_text(two_loops('-1', '-2'))
      call t%finds(findings, 'arc 1 of loop 2 is identical with arc 1 of loop 1 and is taken for it', 'the crank under a minus')
      call t%equal_integer(findings%count, 1, 'and nothing else is wrong')
      call read_text(two_loops('1', '-2'))
      call t%equal_integer(findings%count, 0, 'a second side that begins at its link''s joint')
      call read_text('LEG OF JANSEN'//nl//' &LINKS NLOOP=3, MAXARC=6,'//nl// &
                     ' ILINK=1,2,3,4,0,0, 1,-2,-3,4,0,0, 1,2,-3,-4,-3,4,'//nl// &
                     ' ILOOP=1,0,0,1,0,0, 1,0,0,1,0,0, 1,2,0,0,1,1,'//nl// &
                     ' ARCL=15.,50.,41.5,38.7923,2*0., 0.,61.9,39.3,3*0., 2*0.,36.7,39.4,40.1,0.,'//nl// &
                     ' GAMA=3*0.,11.6,2*0., 6*0., 4*0.,86.27,0., NOUTLK=-3, NOUTLP=3 &END'//nl//method)
      call t%equal_integer(findings%count, 0, 'a second side that ends at a joint of the frame and its link')
      call read_text(two_loops('1', '-3'))
      call t%finds(findings, 'arc 2 of loop 2 belongs to the link of arc 3 of loop 1, but it begins and ends at no joint', &
                   'an arc that hangs in the air')
      call t%equal_integer(findings%exit_code(), 0, 'it is a warning')
   end subroutine warnings

   !> A six-bar: loop 2 leads over arcs `first` and `second` of loop 1.
   function two_loops(first, second) result(text)
      character(*), intent(in) :: first, second
      character(:), allocatable :: text

      text = 'T'//nl//' &LINKS NLOOP=2, MAXARC=5, ILINK=1,2,3,4,0,'//first//','//second//',3,4,-4,'//nl// &
             ' ILOOP=1,0,0,1,0,1,1,0,0,1,'//nl// &
             ' ARCL=40.,120.,80.,130.,0.,40.,70.,90.,90.,150., GAMA=3*0.,180.,0.,0.,20.,0.,0.,10., NOUTLK=3, NOUTLP=2 &END'// &
             nl//method
   end function two_loops
end program test_input
