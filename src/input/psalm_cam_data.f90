!> What the groups CAM and CAM2 say: the law of motion of a cam, its follower, what is asked of its shape.
module psalm_cam_data
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: cam_variation_t, vary_item, vary_names, first_of_segments, of_zones
   public :: goal_base, goal_outer, goal_alpha, goal_rho, goal_accel, goal_stress, goal_names
   public :: cam_group_t, roller_t, follower_roller, follower_flat, fit_spline, fit_least_squares, most_pieces

   real(wp), parameter :: steel_modulus = 206.0e9_wp, steel_poisson = 0.3_wp
   integer, parameter :: follower_roller = 1, follower_flat = 2  !! KFOL
   integer, parameter :: fit_spline = 1              !! TABFIT: a knot at every point
   integer, parameter :: fit_least_squares = 2       !! equal pieces, by least squares
   integer, parameter :: most_pieces = 200           !! of such a fit

   !> A roller, or a point of a flat face, on the arc that carries the follower.
   type :: roller_t
      real(wp) :: distance = 0.0_wp            !! from the arc's end
      real(wp) :: angle = 0.0_wp               !! of that line from the arc's direction, degrees
      real(wp) :: radius = 0.0_wp
   end type roller_t

   ! GOAL: what is to be least
   integer, parameter :: goal_base = 1    !! base radius
   integer, parameter :: goal_outer = 2   !! outer radius
   integer, parameter :: goal_alpha = 3   !! largest pressure angle
   integer, parameter :: goal_rho = 4     !! greatest convex curvature: the least radius is to be large
   integer, parameter :: goal_accel = 5   !! largest second derivative of the input
   integer, parameter :: goal_stress = 6  !! contact stress
   character(*), parameter :: goal_names(6) = [character(6) :: 'BASE', 'OUTER', 'ALPHA', 'RHO', 'ACCEL', 'STRESS']
   !> Numbers that may vary: those of a segment from the ninth on, TZONE with the number of its zone.
   character(*), parameter :: vary_names(12) = [character(6) :: 'XCAM', 'YCAM', 'FOLLK', 'FOLANG', 'FACANG', 'RROLL', 'ORIGLK', &
                                                'ORIGNG', 'SEGEND', 'SEGVEL', 'SEGACC', 'TZONE']
   integer, parameter :: first_of_segments = 9, of_zones = 12

   !> A number that a search may change.
   type :: cam_variation_t
      integer :: item = 0                      !! in `vary_names`
      integer :: segment = 0, zone = 0
      real(wp) :: low = 0.0_wp, high = 0.0_wp
   end type cam_variation_t

   !> Lengths in the user's unit, angles in degrees.
   type :: cam_group_t
      logical :: given = .false.
      ! law
      real(wp), allocatable :: finish(:)       !! SEGEND: cam angle at the end of each segment, degrees
      real(wp), allocatable :: output(:)       !! SEGOUT: there
      integer, allocatable :: law(:)           !! LAW
      real(wp), allocatable :: velocity(:), acceleration(:), jerk(:) !! SEGVEL, SEGACC, SEGJRK at the end, by radians of cam
      logical :: jerks = .false.               !! SEGJRK was given
      real(wp), allocatable :: zones(:, :)     !! shape (7, segments): TZONE, or those of the law
      real(wp) :: start = 0.0_wp               !! OUT0
      real(wp), allocatable :: table_at(:), table(:) !! TABANG, TABOUT
      integer :: degree = 5                    !! KTAB
      real(wp) :: table_tolerance = 0.0_wp     !! TABTOL
      integer :: fit = fit_spline              !! TABFIT
      integer :: pieces = 0                    !! NPIECE: of a fit by least squares; 0: the fewest within TABTOL
      real(wp), allocatable :: weight(:)       !! TABWT
      real(wp) :: most_velocity = 0.0_wp, most_acceleration = 0.0_wp !! VELMAX, ACCMAX by radians of cam; 0: not limited
      logical :: of_output = .true.            !! KOUT=1
      logical :: half = .false.                !! KHALF=1: SEGEND and the rest were given for half a turn
      logical :: through = .false.             !! KDEAD=1: a dead point at which the law has no acceleration is passed too
      integer :: axis = 1                      !! item KAXIS: component of the output
      ! follower
      integer :: arc = 1, loop = 1             !! NFOLLK, NFOLLP
      logical :: from_start = .false.          !! NFOLLK < 0
      integer :: joints(2) = 0                 !! FOLJNT: of a sketch, the line that carries the follower; one joint twice: there
      integer :: link = 0                      !! of the sketch, that has them
      type(roller_t) :: roller                 !! FOLLK, FOLANG, RROLL
      integer :: kind = follower_roller        !! KFOL
      real(wp) :: face_angle = 90.0_wp         !! FACANG, degrees
      real(wp) :: cutter = 0.0_wp              !! RCUT
      logical :: cutter_given = .false.
      real(wp) :: x = 0.0_wp, y = 0.0_wp       !! XCAM, YCAM
      integer :: turn = 1                      !! KTURN
      logical :: slides = .false.              !! KCAM=2: the cam slides
      real(wp) :: direction = 0.0_wp           !! CAMDIR: of its way, degrees
      real(wp) :: travel = 0.0_wp              !! CAMLEN: that way while the cam angle goes from 0 to 360
      integer :: side = 0                      !! KSIDE
      logical :: conjugate = .false.           !! KCONJ
      type(roller_t) :: second                 !! FOLLK2, FOLAN2, RROLL2: roller of the conjugate cam, or second roller
      real(wp) :: errors(2) = 0.0_wp           !! CAMERR: what is missing on the profiles of cam and conjugate
      logical :: pair = .false.                !! KPAIR: the second roller runs on the same profile
      integer :: second_arc = 1, second_loop = 1 !! NFOL2K, NFOL2P
      logical :: second_from_start = .false.   !! NFOL2K < 0
      logical :: track = .false.               !! KTRACK
      real(wp) :: clearance = 0.0_wp           !! item CLEAR: of the roller in the track
      ! forces
      real(wp) :: speed = 0.0_wp               !! CAMRPM: of the cam, rev/min; 0: no forces
      real(wp) :: width = 0.0_wp               !! CAMWID: of the line of contact; 0: no stress
      real(wp) :: modulus(2) = steel_modulus, poisson(2) = steel_poisson !! CAMMOD (Pa), CAMNU: of cam and follower
      real(wp) :: stress = 0.0_wp              !! PHERTZ, Pa; 0: not limited
      real(wp) :: friction = 0.0_wp            !! item CAMMU: between cam and follower
      ! flexible drive
      real(wp) :: frequency = 0.0_wp           !! CAMFRQ: of what the cam drives, over the cam's speed; 0: rigid
      real(wp) :: damping = 0.0_wp             !! item CAMZET: part of the critical one
      ! limits
      real(wp) :: pressure_angle = 30.0_wp     !! ALFMAX
      logical :: rise_only = .false.           !! KALF=1: ALFMAX holds while the follower leaves the centre
      real(wp) :: least_radius = 0.0_wp        !! RHOMIN
      real(wp) :: half_face = 0.0_wp           !! WFACE; 0: not limited
      ! search
      type(cam_variation_t), allocatable :: variations(:) !! VARY, VARLOW, VARHI
      integer :: goal = goal_base              !! GOAL
      ! tables
      integer :: points = 360                  !! NPOINT
      real(wp) :: tolerance = 0.01_wp          !! TOLCUT
      logical :: code = .false.                !! KGCODE
   end type cam_group_t

contains

   !> Name of an item that may vary.
   pure function vary_item(item) result(name)
      integer, intent(in) :: item
      character(:), allocatable :: name

      name = trim(vary_names(item))
   end function vary_item
end module psalm_cam_data
