!> Steady state of a flexible drive (group DRIVEL), and of a Hill equation given by tables (group HILL). Data in, results out.
!> Source: Haines, chapter 7.
module psalm_drive_study
   use psalm_coupled_hill, only: coupled_t
   use psalm_crank_motion, only: crank_motion_t
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t
   use psalm_hill, only: hill_t
   use psalm_kinds, only: wp
   use psalm_link_cycle, only: link_cycle_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: drive_study_t, hill_study_t, inertia_t, find_drive, find_hill, matters
   public :: least_drive_ratio, small_swing

   real(wp), parameter :: least_drive_ratio = 20.0_wp !! of a drive that need not be looked at: Haines, 2M
   real(wp), parameter :: small_swing = 0.1_wp        !! rad; a larger swing makes the linear equation rough

   type :: drive_row_t
      real(wp) :: speed = 0.0_wp                 !! rad/s
      real(wp) :: amplitude = 0.0_wp             !! greatest swing of the crank, rad
      logical :: known = .false., stable = .false., grows = .false.
   end type drive_row_t

   !> The inertia that the crank feels.
   type :: inertia_t
      real(wp) :: mean = 0.0_wp                  !! J0, kg m2
      real(wp) :: half_range = 0.0_wp            !! of J over J0
      real(wp) :: steepest = 0.0_wp              !! greatest |J'|/(2 J0)
   end type inertia_t

   type :: drive_study_t
      type(link_cycle_t) :: turn                 !! where the crank cannot turn
      type(inertia_t) :: of_crank
      type(inertia_t) :: with_offsets            !! DOFFS=0: with the centres of mass where they are
      real(wp) :: stiffness = 0.0_wp             !! S, N m/rad
      real(wp) :: d = 0.0_wp                     !! sqrt(S/J0)/speed
      real(wp) :: ratio = 0.0_wp                 !! mean of frequency/speed
      real(wp) :: least = 0.0_wp                 !! least of it over the turn
      logical :: ratio_real = .false.            !! it is real all over the turn
      integer :: waves = 1                       !! periods of the inertia in a turn
      type(hill_t) :: hill                       !! y, waves times the swing of the crank, by x, waves times its angle
      real(wp), allocatable :: inertia(:)        !! at equal steps of the time of a period, kg m2
      logical :: loaded = .false.                !! weight, loads, springs or dampers act
      real(wp), allocatable :: torque(:)         !! of weight, loads and springs at the same places, in the sense of turning, N m
      real(wp), allocatable :: viscous(:)        !! torque of dampers against the turning at 1 rad/s, N m s
      real(wp) :: resolution = 0.0_wp            !! what the positions leave open of inertia and torques
      real(wp) :: greatest = 0.0_wp              !! swing of the crank, rad
      real(wp), allocatable :: swing(:), acceleration(:) !! shape (0:harmonics): of the crank, rad, and over the squared speed
      real(wp), allocatable :: output(:, :)      !! shape (0:harmonics, components): of the output's acceleration/speed**2
      real(wp), allocatable :: rigid(:, :)       !! the same of a rigid drive
      type(drive_row_t), allocatable :: speeds(:)
      logical :: massless = .false.              !! there is no inertia somewhere
      logical :: found = .false.
   end type drive_study_t

   type :: hill_study_t
      type(hill_t) :: hill
      real(wp), allocatable :: amplitude(:)      !! shape (0:harmonics)
      real(wp) :: resolution = 0.0_wp            !! what the tables leave open
      real(wp) :: greatest = 0.0_wp              !! of |y|
      ! in place of these, of several equations
      type(coupled_t), allocatable :: coupled
      real(wp), allocatable :: amplitudes(:, :)  !! shape (0:harmonics, equations)
      real(wp), allocatable :: peaks(:)          !! shape (equations): greatest |y|
   end type hill_study_t

   interface
      !> Does a harmonic of the crank's acceleration matter for what the crank drives?
      module pure logical function matters(n, amplitude)
         implicit none (type, external)
         integer, intent(in) :: n
         real(wp), intent(in) :: amplitude !! over the squared speed
      end function matters

      !> Steady state of the drive at the speed of RATES.
      module subroutine find_drive(set, given, dimensions, model, crank, study, stop)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         type(problem_t), intent(in) :: given
         type(dimensions_t), intent(in) :: dimensions
         type(force_model_t), intent(in) :: model
         type(crank_motion_t), intent(in) :: crank  !! of the far end of the shaft, known
         type(drive_study_t), intent(out) :: study
         type(stop_t), intent(in), optional :: stop !! asked now and then; the speeds so far are there
      end subroutine find_drive

      !> Steady state of the Hill equation of the tables.
      module subroutine find_hill(set, study)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         type(hill_study_t), intent(out) :: study
      end subroutine find_hill
   end interface
end module psalm_drive_study
