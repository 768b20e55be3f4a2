!> The group MASSES: masses of the links, the metre, gravity, and what of the forces is listed.
module psalm_mass_group
   use psalm_group, only: group_t, check_range
   use psalm_kinds, only: wp
   use psalm_link_place, only: read_places
   use psalm_place, only: place_t
   use psalm_rule, only: rule_t, a_flag, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   implicit none (type, external)
   private
   public :: mass_items
   public :: mass_group_t, read_mass_group

   type :: mass_group_t
      logical :: given = .false.                  !! the group was given
      type(place_t), allocatable :: places(:)     !! shape (entries): centres of mass
      real(wp), allocatable :: mass(:)            !! shape (entries): kg
      real(wp), allocatable :: inertia(:)         !! shape (entries): about the entry's own centre of mass, kg m2
      real(wp), allocatable :: height(:)          !! shape (entries): of the centre above the plane of the linkage, user's length
      logical :: has_heights = .false.            !! MZ was given: moments out of the plane are wanted
      real(wp) :: metre = 1.0_wp                  !! UNITL: metres in one unit of length
      real(wp) :: gravity(2) = 0.0_wp             !! m/s2, machine axes
      real(wp) :: about(2) = 0.0_wp               !! the frame moment is listed about this point too, user's length
      logical :: about_given = .false.
      logical :: motor_on_frame = .true.          !! the frame moment contains the drive's reaction
      integer :: shares = 0                       !! 1: list the share of every source
      logical :: link_loads = .false.             !! what acts on each link is wanted
      integer :: harmonics = 6    !! harmonics listed
      integer :: added = 0                        !! MADDED: so many of the last entries are counterweights
   end type mass_group_t

   !> The items of the group.
   type(rule_t), parameter :: mass_items(*) = [ &
      rule_t('NMASS', a_whole, '', '', 'as many as the longest item has', '[0,100000]', &
             'number of entries; entries on one link add up (a counterweight is an entry, a hole a negative one)'), &
      rule_t('MLINK', a_whole, 'NMASS', '', 'required', '', &
             'an arc of the link; negative: the place is counted from the arc''s start, positive: from its '// &
             'finish'), &
      rule_t('MLOOP', a_whole, 'NMASS', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('MNAME', a_text, 'NMASS', '', '', '', &
             'of a sketch, in place of both: the link, and the joint the place is counted from: `''rod''`, '// &
             '`''rod B''`'), &
      rule_t('MASS', a_number, 'NMASS', 'kg', '0', '', &
             'mass'), &
      rule_t('MDIST', a_number, 'NMASS', 'length', '0', '', &
             'centre of mass: distance from that end'), &
      rule_t('MANG', a_number, 'NMASS', 'degrees', '0', '', &
             'centre of mass: angle from the arc''s direction'), &
      rule_t('MZ', a_number, 'NMASS', 'length', '0', '', &
             'centre of mass: height above the plane of the linkage; where it is given the moments out of the plane on the '// &
             'frame are found'), &
      rule_t('MINERT', a_number, 'NMASS', 'kg m2', '0', '', &
             'moment of inertia about the entry''s own centre of mass; without a mass it is a flywheel'), &
      rule_t('UNITL', a_number, '', 'm', '1', '[1e-30,1e30]', &
             'metres in one unit of length: 0.001 if lengths are millimetres; a warning where it is missing and '// &
             'the linkage more than 20 units large', &
             'metres in one unit of length: must be above 0, from 1e-30 to 1e30'), &
      rule_t('GRAVX', a_number, '', 'm/s2', '0', '', &
             'gravity along the machine''s x axis'), &
      rule_t('GRAVY', a_number, '', 'm/s2', '0', '', &
             'gravity along the machine''s y axis'), &
      rule_t('MOMX', a_number, '', 'length', '0', '', &
             'the moment on the frame is listed about this point too: its x'), &
      rule_t('MOMY', a_number, '', 'length', '0', '', &
             'its y'), &
      rule_t('IMOTOR', a_flag, '', '', '1', '', &
             '1: the motor is mounted on the frame, whose moment contains its reaction; 0: a flywheel elsewhere '// &
             'holds the speed'), &
      rule_t('ISHARE', a_flag, '', '', '0', '', &
             '1: device 8 lists the share of every source in drive and frame force'), &
      rule_t('ILOADS', a_flag, '', '', '0', '', &
             '1: what acts on each link, point by point in axes of the link, and how it moves, for stress analysis: device 8, '// &
             'tables `link_loads` and `link_motion`'), &
      rule_t('NHARM', a_whole, '', '', '6', '[0,1000]', &
             'harmonics listed of drive and frame force, if the positions divide a turn of the crank evenly '// &
             '(IKIN)'), &
      rule_t('MADDED', a_whole, '', '', '0', '[0,NMASS]', &
             'so many of the last entries are counterweights, as `muscle` writes them: `balm` draws each as the '// &
             'disc that has its mass and MINERT (without MINERT: a disc of steel, 10 mm thick), and beside '// &
             'drive and frame force what they are without them')]

contains

   !> Read the group. Errors: arcs that are not there, numbers out of range.
   subroutine read_mass_group(group, ilink, sketch, masses, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)          !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch        !! its names stand in place of arcs and loops
      type(mass_group_t), intent(inout) :: masses
      type(diagnostics_t), intent(inout) :: findings
      integer :: n

      masses%given = group%line > 0
      call group%follow(mass_items)
      call take_count(group, 'NMASS', n, findings)
      allocate (masses%places(n), masses%mass(n), masses%inertia(n), masses%height(n))
      call read_places(group, 'M', ilink, masses%places, findings, sketch=sketch)
      call take(group, 'MASS', masses%mass, findings)
      call take(group, 'MINERT', masses%inertia, findings)
      call take(group, 'MZ', masses%height, findings)
      masses%has_heights = group%given('MZ')
      call take(group, 'UNITL', masses%metre, findings)
      call take(group, 'GRAVX', masses%gravity(1), findings)
      call take(group, 'GRAVY', masses%gravity(2), findings)
      call take(group, 'MOMX', masses%about(1), findings)
      call take(group, 'MOMY', masses%about(2), findings)
      masses%about_given = group%given('MOMX') .or. group%given('MOMY')
      call take(group, 'IMOTOR', masses%motor_on_frame, findings)
      call take(group, 'ISHARE', masses%shares, findings)
      call take(group, 'ILOADS', masses%link_loads, findings)
      call take(group, 'NHARM', masses%harmonics, findings)
      call take(group, 'MADDED', masses%added, findings)
      call check_range(group, 'MADDED', masses%added, 0, n, findings)
   end subroutine read_mass_group
end module psalm_mass_group
