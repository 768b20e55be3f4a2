!> The groups of forces: defaults, and every mistake with its words.
program test_force_groups
   use check, only: checks_t
   use psalm_data_set, only: data_set_t, read_data_sets
   use psalm_dimensions, only: dimensions_t
   use psalm_force_model, only: force_model_t, make_force_model, parameter_mass, parameter_mx, parameter_my, parameter_inertia
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t
   use psalm_motor_group, only: motor_group_t, motor_of
   use psalm_parameters, only: parameters_t
   use psalm_setup, only: set_up
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a'), file = 'build/test_force_groups.nml'
   character(*), parameter :: four_bar = 'A FOUR-BAR'//nl// &
                              ' &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1,'//nl// &
                              '  ARCL=40.,120.,80.,130., GAMA=3*0.,180., NOUTLK=3, NOUTLP=1 &END'//nl// &
                              ' &METHOD MOTION=1, NDES=3, DELT=0.,30.,60. &END'//nl// &
                              ' &RATES SPEED=10. &END'//nl
   character(*), parameter :: slider = 'A SLIDER-CRANK'//nl// &
                              ' &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1,'//nl// &
                              '  ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0, NOUTLK=3, NOUTLP=1 &END'//nl// &
                              ' &METHOD MOTION=3, NDES=3, DELT=0.,30.,60. &END'//nl// &
                              ' &RATES SPEED=10. &END'//nl
   character(*), parameter :: astray = 'A SIX-BAR WITH AN ARC THAT IS ONLY PARALLEL TO ITS LINK'//nl// &
                              ' &LINKS NLOOP=2, MAXARC=5, ILINK=1,2,3,4,0, 1,-3,3,4,-4, ILOOP=1,0,0,1,0, 1,1,0,0,1,'//nl// &
                              '  ARCL=40.,120.,80.,130.,0., 40.,30.,100.,90.,150., GAMA=3*0.,180.,0., 0.,10.,0.,0.,20.,'//nl// &
                              '  NOUTLK=3, NOUTLP=2 &END'//nl// &
                              ' &METHOD MOTION=1, NDES=3, DELT=0.,30.,60. &END'//nl// &
                              ' &RATES SPEED=10. &END'//nl
   character(*), parameter :: actuator = 'A SLIDING INPUT'//nl// &
                              ' &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,-3,4, ILOOP=-4,0,0,1,'//nl// &
                              '  ARCL=0.,50.,60.,30., GAMA=3*0.,180., NOUTLK=3, NOUTLP=1 &END'//nl// &
                              ' &METHOD MOTION=1, CRNKI=20., NDES=2, DELT=0.,5. &END'//nl// &
                              ' &RATES SPEED=10. &END'//nl
   type(checks_t) :: t
   type(diagnostics_t) :: findings
   type(data_set_t), allocatable :: sets(:)
   type(force_model_t) :: model

   call defaults()
   call entries_add_up()
   call wrong_numbers()
   call wrong_places()
   call wrong_masses()
   call others()
   call t%report()

contains

   !> Read a text as kalm does, and put its groups on the bodies.
   subroutine read_text(text)
      character(*), intent(in) :: text
      type(mechanism_t) :: mechanism
      type(dimensions_t) :: dimensions
      type(parameters_t) :: parameters
      type(diagnostics_t) :: fresh
      type(force_model_t) :: empty
      integer :: unit

      open (newunit=unit, file=file, access='stream', form='unformatted', status='replace')
      write (unit) text
      close (unit)
      findings = fresh
      model = empty
      if (allocated(sets)) deallocate (sets)
      call read_data_sets(file, sets, findings, program='kalm')
      if (findings%failed()) return
      call set_up(sets(1), mechanism, dimensions, parameters, findings)
      if (findings%failed()) return
      call make_force_model(sets(1), mechanism, dimensions, model, findings)
   end subroutine read_text

   subroutine wrong(text, words)
      character(*), intent(in) :: text, words

      call read_text(text)
      call t%is_true(findings%failed(), 'refused: '//words)
      call t%finds(findings, words, 'message')
   end subroutine wrong

   subroutine defaults()
      call read_text(four_bar//' &MASSES NMASS=1, MLINK=2, MLOOP=1, MASS=3. &END'//nl)
      call t%is_true(.not. findings%failed(), 'a mass is accepted')
      call t%close_to(sets(1)%masses%metre, 1.0_wp, 0.0_wp, 'UNITL')
      call t%close_to(maxval(abs(sets(1)%masses%gravity)), 0.0_wp, 0.0_wp, 'gravity')
      call t%is_true(sets(1)%masses%motor_on_frame, 'IMOTOR')
      call t%equal_integer(sets(1)%masses%harmonics, 6, 'NHARM')
      call t%equal_integer(size(sets(1)%loads%places), 0, 'no loads')
      call read_text(four_bar//' &MASSES MLINK=2,4, MLOOP=2*1, MASS=3. &END'//nl)
      call t%is_true(.not. findings%failed(), 'a number of masses that is not given is counted')
      call t%equal_integer(size(sets(1)%masses%places), 2, 'by the longest item')
      call read_text(four_bar)
      call t%is_true(.not. sets(1)%masses%given, 'no masses')
   end subroutine defaults

   !> Mass, first moments and inertia about the reference, by hand: coupler of 120, 2 kg at 30 from its start at +90 degrees, and a
   !> hole of 0.5 kg at its finish.
   subroutine entries_add_up()
      call read_text(four_bar//' &MASSES NMASS=2, MLINK=-2,2, MLOOP=2*1, MASS=2.,-0.5, MDIST=30.,0., MANG=90.,0., '// &
                     'MINERT=0.1,0., UNITL=0.01 &END'//nl)
      associate (coupler => model%inertia(:, 3))
         call t%close_to(coupler(parameter_mass), 1.5_wp, 1.0e-15_wp, 'masses add up')
         call t%close_to(coupler(parameter_mx), -0.6_wp, 1.0e-15_wp, 'first moment along the arc')
         call t%close_to(coupler(parameter_my), 0.6_wp, 1.0e-15_wp, 'first moment across it')
         call t%close_to(coupler(parameter_inertia), 0.1_wp + 2.0_wp*0.09_wp - 0.5_wp*1.44_wp, 1.0e-15_wp, &
                         'moment of inertia about the reference')
      end associate
      call t%is_true(findings%failed(), 'which is negative about the centre')
   end subroutine entries_add_up

   subroutine wrong_numbers()
      call wrong(four_bar//' &MASSES MASS=1. &END'//nl, '&MASSES MLINK: missing; this item is required')
      call wrong(four_bar//' &MASSES NMASS=1, MASS=1. &END'//nl, '&MASSES MLINK: missing; this item is required')
      call wrong(four_bar//' &MASSES NMASS=-1 &END'//nl, 'must be from 0 to')
      call wrong(four_bar//' &MASSES NMASS=1, MLINK=2, MLOOP=1, MASS=NaN &END'//nl, '&MASSES MASS: ')
      call wrong(four_bar//' &MASSES NMASS=1, MLINK=2, MLOOP=1, MASS=1.,2. &END'//nl, 'too many values')
      call wrong(four_bar//' &MASSES NMASS=1, MLINK=2, MLOOP=1, UNITL=0. &END'//nl, 'metres in one unit of length: must be above 0')
      call wrong(four_bar//' &MASSES NMASS=1, MLINK=2, MLOOP=1, MAS=1. &END'//nl, 'no such item; did you mean MASS?')
      call read_text(four_bar(:index(four_bar, ' &RATES') - 1)//' &MASSES NMASS=1, MLINK=2, MLOOP=1, MASS=1. &END'//nl)
      call t%finds(findings, 'there is no group &RATES: the input is taken to move at 1 radian a second', 'masses without rates')
      call t%is_true(.not. findings%failed(), 'which is no error')
   end subroutine wrong_numbers

   subroutine wrong_places()
      call wrong(four_bar//' &MASSES NMASS=1, MLINK=5, MLOOP=1, MASS=1. &END'//nl, 'there is no arc 5 in loop 1')
      call wrong(four_bar//' &MASSES NMASS=1, MLINK=2, MLOOP=2, MASS=1. &END'//nl, 'there is no loop 2')
      call wrong(four_bar//' &MASSES NMASS=1, MLINK=0, MLOOP=1, MASS=1. &END'//nl, 'there is no arc 0 in loop 1')
      call wrong(slider//' &MASSES NMASS=1, MLINK=3, MLOOP=1, MASS=1. &END'//nl, 'is counted from the foot of a slide')
      call read_text(slider//' &MASSES NMASS=1, MLINK=-3, MLOOP=1, MASS=1. &END'//nl)
      call t%is_true(.not. findings%failed(), 'the other end of a slide is accepted')
      call wrong(astray//' &MASSES NMASS=1, MLINK=2, MLOOP=1, MASS=1. &END'//nl, 'is no point of both links that it joins')
      call wrong(astray//' &MASSES NMASS=1, MLINK=2, MLOOP=2, MASS=1. &END'//nl, 'is on an arc that is only parallel to its link')
      call read_text(four_bar//' &MASSES NMASS=1, MLINK=4, MLOOP=1, MASS=1. &END'//nl)
      call t%finds(findings, 'is a mass on the frame: it has no effect', 'a mass on the frame')
      call t%is_true(.not. findings%failed(), 'which is no error')
   end subroutine wrong_places

   subroutine wrong_masses()
      call wrong(four_bar//' &MASSES NMASS=2, MLINK=2,2, MLOOP=1,1, MASS=1.,-2. &END'//nl, 'add up to a negative mass')
      call wrong(four_bar//' &MASSES NMASS=1, MLINK=2, MLOOP=1, MASS=1., MINERT=-1. &END'//nl, &
                 'add up to a negative moment of inertia')
      call read_text(four_bar//' &MASSES NMASS=1, MLINK=1, MLOOP=1, MINERT=1. &END'//nl)
      call t%is_true(.not. findings%failed(), 'a flywheel has inertia without mass')
      call read_text(four_bar//' &MASSES NMASS=2, MLINK=2,2, MLOOP=1,1, MASS=1.,-1. &END'//nl)
      call t%is_true(.not. findings%failed(), 'entries may cancel')
   end subroutine wrong_masses

   subroutine others()
      type(motor_group_t) :: motor

      call wrong(four_bar//' &LOADS NLOAD=1, LLINK=2, LLOOP=1, LTURN=2 &END'//nl, '0 (machine axes) or 1 (turning with the arc)')
      call wrong(four_bar//' &LOADS NLOAD=1, LLINK=2, LLOOP=1, LTABLE=1 &END'//nl, 'there are tables 1 to 0')
      call wrong(four_bar//' &LOADS NLOAD=1, LLINK=2, LLOOP=1, LTABLE=1, NTABLE=1, NTABIN=2, TABIN=1.,1., TABVAL=1.,2. &END'//nl, &
                 'inputs of the tables must ascend')
      call wrong(four_bar//' &LOADS NLOAD=1, LLINK=2, LLOOP=1, LTABLE=1, NTABLE=1, NTABIN=3, TABIN=1.,2., '// &
                 'TABVAL=1.,2.,3. &END'//nl, &
                 'NTABIN=3 inputs are announced, but only 2 values given')
      call wrong(four_bar//' &LOADS NLOAD=1, LLINK=2, LLOOP=1, LTABLE=1, NTABLE=1, NTABIN=2, TABIN=1.,2., TABVAL=1. &END'//nl, &
                 '1 tables of 2 values are announced, but only 1 values given')
      call wrong(four_bar//' &SPRING NSPRNG=1, ALINK=2, ALOOP=1, STIFF=1. &END'//nl, &
                 '&SPRING BLINK: missing; this item is required')
      call wrong(four_bar//' &SPRING NSPRNG=1, ALINK=2, ALOOP=1, BLINK=4, BLOOP=1, SFREE=-1. &END'//nl, &
                 'a free length is not negative')
      call wrong(four_bar//' &SPRING NSPRNG=1, ALINK=2, ALOOP=1, BLINK=4, BLOOP=1, SDAMP=-1. &END'//nl, 'damping is not negative')
      call read_text(four_bar//' &SPRING NSPRNG=1, ALINK=2, ALOOP=1, BLINK=-2, BLOOP=1 &END'//nl)
      call t%finds(findings, 'has both its ends on the same link', 'a spring within a link')
      call wrong(four_bar//' &MASSES NMASS=0 &END &FRICTN NFRIC=1, FLINK=2, FLOOP=1, FMU=-0.1 &END'//nl, &
                 'a coefficient of friction is not negative')
      call wrong(four_bar//' &MASSES NMASS=0 &END &FRICTN NFRIC=1, FLINK=2, FLOOP=1, FDIST=1. &END'//nl, 'no such item')
      call wrong(four_bar//' &MOTOR FLUCT=2. &END'//nl, 'must lie between 0 and 2')
      call wrong(actuator//' &MOTOR FLUCT=1. &END'//nl, 'motion from torque needs a crank that turns')
      call wrong(four_bar//' &MOTOR NMTAB=2, MTABW=1.,2., MTABT=1. &END'//nl, &
                 '2 speeds and torques are announced, but only 1 given')
      call wrong(four_bar//' &MOTOR NMTAB=2, MTABW=2.,1., MTABT=1.,1. &END'//nl, 'speeds must ascend')
      call read_text(four_bar//' &MASSES NMASS=0 &END &MOTOR NMTAB=3, MTABW=1.,2.,3., MTABT=9.,5.,0. &END'//nl)
      call t%equal_integer(findings%count, 0, 'a motor by its table')
      motor = motor_of(sets(1))
      call t%is_true(all(abs(motor%speed - [1.0_wp, 2.0_wp, 3.0_wp]) + &
                         abs(motor%table - [9.0_wp, 5.0_wp, 0.0_wp]) <= 0.0_wp), 'its speeds and torques')
   end subroutine others
end program test_force_groups
