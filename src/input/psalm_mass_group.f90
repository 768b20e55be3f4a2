!> The group MASSES: masses of the links, the metre, gravity, and what of the forces is listed.
module psalm_mass_group
   use psalm_group, only: group_t, check_range, out_of, read_flag
   use psalm_kinds, only: wp
   use psalm_link_place, only: place_t, read_places, read_count
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: mass_group_t, read_mass_group, most_harmonics

   integer, parameter :: most_harmonics = 1000    !! above this NHARM is taken for a slip of the pen
   integer, parameter :: default_harmonics = 6    !! of drive and shaking force that are listed

   type :: mass_group_t
      logical :: given = .false.                  !! the group was given
      type(place_t), allocatable :: places(:)     !! shape (entries): centres of mass
      real(wp), allocatable :: mass(:)            !! shape (entries): kg
      real(wp), allocatable :: inertia(:)         !! shape (entries): about the entry's own centre of mass, kg m2
      real(wp) :: metre = 1.0_wp                  !! UNITL: metres in one unit of length
      real(wp) :: gravity(2) = 0.0_wp             !! m/s2, machine axes
      real(wp) :: about(2) = 0.0_wp               !! the frame moment is listed about this point too, user's length
      logical :: about_given = .false.
      logical :: motor_on_frame = .true.          !! the frame moment contains the drive's reaction
      integer :: shares = 0                       !! 1: list the share of every source
      integer :: harmonics = default_harmonics    !! harmonics listed
      integer :: added = 0                        !! MADDED: so many of the last entries are counterweights
   end type mass_group_t

contains

   !> Read the group. Errors: arcs that are not there, numbers out of range.
   subroutine read_mass_group(group, ilink, sketch, masses, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)          !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch        !! its names stand in place of arcs and loops
      type(mass_group_t), intent(inout) :: masses
      type(diagnostics_t), intent(inout) :: findings
      integer :: n, motor

      masses%given = group%line > 0
      call read_count(group, 'NMASS', n, findings)
      allocate (masses%places(n))
      allocate (masses%mass(n), masses%inertia(n), source=0.0_wp)
      call read_places(group, 'M', ilink, masses%places, findings, sketch=sketch)
      call group%get_reals('MASS', masses%mass, findings)
      call group%get_reals('MINERT', masses%inertia, findings)
      call group%get_real('UNITL', masses%metre, findings)
      if (.not. masses%metre > 0.0_wp) call out_of(group, 'UNITL', 'metres in one unit of length: must be above 0', findings)
      call group%get_real('GRAVX', masses%gravity(1), findings)
      call group%get_real('GRAVY', masses%gravity(2), findings)
      call group%get_real('MOMX', masses%about(1), findings)
      call group%get_real('MOMY', masses%about(2), findings)
      masses%about_given = group%given('MOMX') .or. group%given('MOMY')
      motor = 1
      call read_flag(group, 'IMOTOR', motor, findings)
      masses%motor_on_frame = motor == 1
      call read_flag(group, 'ISHARE', masses%shares, findings)
      call group%get_integer('NHARM', masses%harmonics, findings)
      call check_range(group, 'NHARM', masses%harmonics, 0, most_harmonics, findings)
      call group%get_integer('MADDED', masses%added, findings)
      call check_range(group, 'MADDED', masses%added, 0, n, findings)
   end subroutine read_mass_group
end module psalm_mass_group
