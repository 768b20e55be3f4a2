!> The group CAM: the law of motion of a cam, its follower, and what is asked of its shape.
module psalm_cam_group
   use psalm_cam_kind, only: law_kind, law_dwell, law_modtrap, law_trig, law_names, has_zones, zones_of, zone_count
   use psalm_case_group, only: case_group_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, check_range, out_of, read_flag, required
   use psalm_kinds, only: wp, full_turn
   use psalm_sketch, only: sketch_t
   use psalm_sketch_names, only: common_link, find_joints
   use psalm_link_place, only: refuse_unless
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text, upper_case
   implicit none (type, external)
   private
   public :: cam_variation_t, vary_item, goal_base, goal_outer, goal_alpha, goal_rho, goal_accel, goal_stress, goal_names
   public :: cam_group_t, roller_t, cams_of, follower_roller, follower_flat, fit_spline, fit_least_squares, most_pieces

   integer, parameter :: most_segments = 200, most_in_table = 2000, most_points = 100000, fewest_points = 12
   integer, parameter :: fewest_in_table = 6
   integer, parameter :: most_numbers = 1000   !! above this KAXIS is taken for a slip of the pen
   real(wp), parameter :: steel_modulus = 206.0e9_wp, steel_poisson = 0.3_wp
   integer, parameter :: follower_roller = 1, follower_flat = 2  !! KFOL
   integer, parameter :: fit_spline = 1              !! TABFIT: a knot at every point
   integer, parameter :: fit_least_squares = 2       !! equal pieces, by least squares
   integer, parameter :: most_pieces = 200           !! of such a fit
   character(*), parameter :: fit_names(2) = [character(6) :: 'SPLINE', 'LSQ']
   real(wp), parameter :: half_turn = 0.5_wp*full_turn
   character(4), parameter :: first_cam = 'CAM', second_cam = 'CAM2' !! groups

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

   type, extends(case_group_t) :: cam_group_t
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
      integer :: axis = 1                      !! KAXIS: component of the output
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
      real(wp) :: clearance = 0.0_wp           !! CLEAR: of the roller in the track
      ! forces
      real(wp) :: speed = 0.0_wp               !! CAMRPM: of the cam, rev/min; 0: no forces
      real(wp) :: width = 0.0_wp               !! CAMWID: of the line of contact; 0: no stress
      real(wp) :: modulus(2) = steel_modulus, poisson(2) = steel_poisson !! CAMMOD (Pa), CAMNU: of cam and follower
      real(wp) :: stress = 0.0_wp              !! PHERTZ, Pa; 0: not limited
      real(wp) :: friction = 0.0_wp            !! CAMMU: between cam and follower
      ! flexible drive
      real(wp) :: frequency = 0.0_wp           !! CAMFRQ: of what the cam drives, over the cam's speed; 0: rigid
      real(wp) :: damping = 0.0_wp             !! CAMZET: part of the critical one
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
   contains
      procedure :: read => read_cam
   end type cam_group_t

contains

   !> Read the group CAM. Errors: segments or tables that are too short or do not rise, laws that are not there, arcs that are
   !> not there, numbers out of range.
   subroutine read_cam_group(group, ilink, sketch, cam, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)       !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      integer :: code

      cam%given = group%line > 0
      call read_segments(group, cam, findings)
      call read_table(group, cam, findings)
      call read_follower(group, ilink, cam, findings)
      call read_pair(group, ilink, cam, findings)
      call read_slide(group, cam, findings)
      call read_joints(group, sketch, cam, findings)
      call read_variations(group, cam, findings)
      call group%get_real('ALFMAX', cam%pressure_angle, findings)
      if (cam%pressure_angle <= 0.0_wp .or. cam%pressure_angle >= 90.0_wp) call out_of(group, 'ALFMAX', &
         'must lie between 0 and 90 degrees', findings)
      code = 0
      call read_flag(group, 'KALF', code, findings)
      cam%rise_only = code == 1
      call group%get_real('RHOMIN', cam%least_radius, findings)
      if (cam%least_radius < 0.0_wp) call out_of(group, 'RHOMIN', 'must not be negative', findings)
      call group%get_real('WFACE', cam%half_face, findings)
      if (cam%half_face < 0.0_wp) call out_of(group, 'WFACE', 'must not be negative', findings)
      call group%get_real('TOLCUT', cam%tolerance, findings)
      if (.not. cam%tolerance > 0.0_wp) call out_of(group, 'TOLCUT', 'must be above 0', findings)
      code = 0
      call read_flag(group, 'KGCODE', code, findings)
      cam%code = code == 1
      if (cam%code .and. .not. cam%cutter > 0.0_wp) call out_of(group, 'KGCODE', 'a program needs a cutter: give RCUT', findings)
      call group%get_integer('NPOINT', cam%points, findings)
      call check_range(group, 'NPOINT', cam%points, fewest_points, most_points, findings)
   end subroutine read_cam_group

   subroutine read_segments(group, cam, findings)
      type(group_t), intent(inout) :: group
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:)
      real(wp), allocatable :: zones(:)
      integer :: n, k, last(2), zones_given, half, slides
      real(wp) :: whole

      n = 0
      half = 0
      slides = 1
      call read_flag(group, 'KHALF', half, findings)
      cam%half = half == 1
      whole = merge(half_turn, full_turn, cam%half)
      call group%get_integer('KCAM', slides, findings)
      call check_range(group, 'KCAM', slides, 1, 2, findings)
      cam%slides = slides == 2
      if (cam%slides .and. cam%half) call out_of(group, 'KHALF', 'a cam that slides has no other half of its turn', findings)
      call group%get_integer('NSEG', n, findings)
      group%count_missing = .not. group%given('NSEG')
      call check_range(group, 'NSEG', n, 0, most_segments, findings)
      n = min(max(n, 0), most_segments)
      if (cam%given .and. n == 0 .and. .not. group%given('NTAB')) call required(group, 'NSEG', &
         'missing; the number of segments of the law (or NTAB, a table over one turn)')
      allocate (cam%finish(n), cam%output(n), cam%velocity(n), cam%acceleration(n), cam%jerk(n), source=0.0_wp)
      allocate (cam%law(n), source=law_modtrap)
      allocate (zones(zone_count*n), source=0.0_wp)
      call group%get_reals('SEGEND', cam%finish, findings, last=last(1))
      call group%get_reals('SEGOUT', cam%output, findings, last=last(2))
      call group%get_real('OUT0', cam%start, findings)
      call group%get_reals('SEGVEL', cam%velocity, findings)
      call group%get_reals('SEGACC', cam%acceleration, findings)
      call group%get_reals('SEGJRK', cam%jerk, findings)
      cam%jerks = group%given('SEGJRK')
      call group%get_texts('LAW', names, findings)
      call group%get_reals('TZONE', zones, findings, last=zones_given)
      allocate (cam%zones(zone_count, n), source=0.0_wp)
      if (n == 0) return
      if (.not. group%given('SEGEND')) call required(group, 'SEGEND')
      if (.not. group%given('SEGOUT')) call required(group, 'SEGOUT')
      if (group%given('SEGEND') .and. last(1) < n) call short('SEGEND', last(1))
      if (group%given('SEGOUT') .and. last(2) < n) call short('SEGOUT', last(2))
      if (size(names) > n) call out_of(group, 'LAW', to_text(n)//' segments are announced by NSEG, but '//to_text(size(names))// &
                                       ' laws given', findings, n + 1)
      do k = 1, min(n, size(names))
         if (len_trim(names(k)) == 0) cycle
         cam%law(k) = law_kind(upper_case(trim(names(k))))
         if (cam%law(k) > 0) cycle
         call out_of(group, 'LAW', 'entry '//to_text(k)//": there is no law '"//trim(names(k))//"'; the laws are "//all_laws(), &
                     findings, k)
         cam%law(k) = law_modtrap
      end do
      do k = 1, n
         if (has_zones(cam%law(k))) cam%zones(:, k) = zones_of(cam%law(k))
         associate (own => zones(zone_count*(k - 1) + 1:zone_count*k))
            if (zones_given <= zone_count*(k - 1) .or. .not. any(abs(own) > 0.0_wp)) cycle
            if (any(own < 0.0_wp)) then
               call out_of(group, 'TZONE', 'segment '//to_text(k)//': a zone has no negative width', findings, &
                           zone_count*(k - 1) + findloc(own < 0.0_wp, .true., dim=1))
            else if (cam%law(k) == law_trig) then
               cam%zones(:, k) = own/sum(own)
               if (.not. (any(own(:3) > 0.0_wp) .and. any(own(5:) > 0.0_wp))) call out_of(group, 'TZONE', 'segment '// &
                  to_text(k)//': zones 1 to 3 accelerate and 5 to 7 retard; one side has no width', findings, &
                  zone_count*(k - 1) + 1)
            else
               call out_of(group, 'TZONE', 'segment '//to_text(k)//" is of the law "//trim(law_names(cam%law(k)))// &
                           "; only 'TRIG' has zones of the user's", findings, zone_count*(k - 1) + 1)
            end if
         end associate
      end do
      if (group%given('SEGOUT')) call refuse_unless(cam%law /= law_dwell .or. &
                                                    .not. abs(cam%output - [cam%start, cam%output(:n - 1)]) > 0.0_wp, &
                                                    group, 'SEGOUT', 'a dwell ends where it begins', findings)
      if (.not. group%given('SEGEND')) return
      do k = 1, n
         if (k > 1) then
            if (.not. cam%finish(k) > cam%finish(k - 1)) then
               call out_of(group, 'SEGEND', 'entry '//to_text(k)//': the cam angles must rise', findings, k)
               return
            end if
         else if (.not. cam%finish(1) > 0.0_wp) then
            call out_of(group, 'SEGEND', 'entry 1: the first segment begins at 0; it must end above', findings)
            return
         end if
      end do
      if (abs(cam%finish(n) - whole) > 0.0_wp) call out_of(group, 'SEGEND', 'the last segment must end at '// &
                                                          trim(merge('180, for KHALF=1', '360             ', cam%half)), &
                                                          findings, n)
      if (cam%half) then
         call add_complement(cam)
      else if (group%given('SEGOUT') .and. abs(cam%output(n) - cam%start) > 0.0_wp .and. .not. cam%slides) then
         call out_of(group, 'SEGOUT', 'the last segment must end where the first begins, at OUT0', findings, n)
      end if

   contains

      subroutine short(item, last)
         character(*), intent(in) :: item
         integer, intent(in) :: last

         call out_of(group, item, to_text(n)//' segments are announced by NSEG, but only '//to_text(last)//' values given', &
                     findings)
      end subroutine short

      pure function all_laws() result(text)
         character(:), allocatable :: text
         integer :: i

         text = trim(law_names(1))
         do i = 2, size(law_names)
            text = text//', '//trim(law_names(i))
         end do
      end function all_laws
   end subroutine read_segments

   !> The other half of the turn: the sum of the outputs half a turn apart stays the same.
   pure subroutine add_complement(cam)
      type(cam_group_t), intent(inout) :: cam
      real(wp) :: zones(zone_count, 2*size(cam%finish))
      integer :: n

      n = size(cam%finish)
      zones(:, :n) = cam%zones
      zones(:, n + 1:) = cam%zones
      cam%zones = zones
      cam%output = [cam%output, cam%start + cam%output(n) - cam%output]
      cam%finish = [cam%finish, half_turn + cam%finish]
      cam%law = [cam%law, cam%law]
      cam%velocity = [cam%velocity, -cam%velocity]
      cam%acceleration = [cam%acceleration, -cam%acceleration]
      cam%jerk = [cam%jerk, -cam%jerk]
   end subroutine add_complement

   !> How the curve of a table of n points is to be found.
   subroutine read_fit(group, n, cam, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: n
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: name

      name = trim(fit_names(fit_spline))
      call group%get_word('TABFIT', name, findings)
      cam%fit = findloc(fit_names == upper_case(name), .true., dim=1)
      if (cam%fit == 0) then
         call out_of(group, 'TABFIT', "there is no fit '"//name//"'; it is SPLINE or LSQ", findings)
         cam%fit = fit_spline
      end if
      call group%get_integer('NPIECE', cam%pieces, findings)
      call group%get_reals('TABWT', cam%weight, findings)
      call refuse_unless(cam%weight >= 0.0_wp, group, 'TABWT', 'a weight must not be negative', findings)
      if (n > 0 .and. .not. any(cam%weight > 0.0_wp)) call out_of(group, 'TABWT', 'no point has a weight', findings)
      call group%get_real('VELMAX', cam%most_velocity, findings)
      call refuse_unless([cam%most_velocity >= 0.0_wp], group, 'VELMAX', 'must not be negative', findings)
      call group%get_real('ACCMAX', cam%most_acceleration, findings)
      call refuse_unless([cam%most_acceleration >= 0.0_wp], group, 'ACCMAX', 'must not be negative', findings)
      if (cam%fit == fit_spline) then
         call only_of_fit('NPIECE')
         call only_of_fit('TABWT')
         call only_of_fit('VELMAX')
         call only_of_fit('ACCMAX')
         return
      end if
      if (group%given('NPIECE')) then
         call check_range(group, 'NPIECE', cam%pieces, cam%degree + 1, min(n, most_pieces), findings)
      else if (.not. cam%table_tolerance > 0.0_wp) then
         call required(group, 'NPIECE', 'missing; TABFIT=''LSQ'' needs the number of pieces, or the tolerance TABTOL')
      end if

   contains

      subroutine only_of_fit(item)
         character(*), intent(in) :: item

         if (group%given(item)) call out_of(group, item, 'is of TABFIT=''LSQ'' only', findings)
      end subroutine only_of_fit
   end subroutine read_fit

   subroutine read_table(group, cam, findings)
      type(group_t), intent(inout) :: group
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      integer :: n, k, last(2)

      n = 0
      call group%get_integer('NTAB', n, findings)
      if (group%given('NTAB')) call check_range(group, 'NTAB', n, fewest_in_table, most_in_table, findings)
      n = min(max(n, 0), most_in_table)
      allocate (cam%table_at(n), cam%table(n), source=0.0_wp)
      allocate (cam%weight(n), source=1.0_wp)
      call group%get_reals('TABANG', cam%table_at, findings, last=last(1))
      call group%get_reals('TABOUT', cam%table, findings, last=last(2))
      call group%get_integer('KTAB', cam%degree, findings)
      if (cam%degree /= 3 .and. cam%degree /= 5) call out_of(group, 'KTAB', 'the degree of the spline is 5 or 3', findings)
      call group%get_real('TABTOL', cam%table_tolerance, findings)
      if (cam%table_tolerance < 0.0_wp) call out_of(group, 'TABTOL', 'must not be negative', findings)
      call read_fit(group, n, cam, findings)
      if (n == 0) return
      if (cam%slides) call out_of(group, 'NTAB', 'a table is of a cam that turns', findings)
      if (size(cam%finish) > 0) then
         call out_of(group, 'NTAB', 'a table is the law of the whole turn: leave NSEG out, or NTAB', findings)
         return
      end if
      if (last(2) < n) call out_of(group, 'TABOUT', to_text(n)//' values are announced by NTAB, but only '//to_text(last(2))// &
                                   ' given', findings)
      if (.not. group%given('TABANG')) then
         cam%table_at = [(full_turn*real(k - 1, wp)/real(n, wp), k=1, n)]
         return
      end if
      if (last(1) < n) then
         call out_of(group, 'TABANG', to_text(n)//' values are announced by NTAB, but only '//to_text(last(1))//' given', findings)
         return
      end if
      if (abs(cam%table_at(1)) > 0.0_wp) call out_of(group, 'TABANG', 'the table begins at 0', findings)
      do k = 2, n
         if (cam%table_at(k) > cam%table_at(k - 1)) cycle
         call out_of(group, 'TABANG', 'entry '//to_text(k)//': the cam angles must rise', findings, k)
         return
      end do
      if (cam%table_at(n) >= full_turn) call out_of(group, 'TABANG', 'the table ends before 360, where it begins again', &
                                                  findings, n)
   end subroutine read_table

   !> Name of an item that may vary.
   pure function vary_item(item) result(name)
      integer, intent(in) :: item
      character(:), allocatable :: name

      name = trim(vary_names(item))
   end function vary_item

   !> What a search may change, and what it is to make least.
   subroutine read_variations(group, cam, findings)
      type(group_t), intent(inout) :: group
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:), goal
      real(wp), allocatable :: low(:), high(:)
      integer :: k, n, given(2), numbers(2), first, state
      character(:), allocatable :: word

      call group%get_texts('VARY', names, findings)
      n = size(names)
      allocate (cam%variations(n))
      allocate (low(max(1, n)), high(max(1, n)), source=0.0_wp)
      call group%get_reals('VARLOW', low, findings, last=given(1))
      call group%get_reals('VARHI', high, findings, last=given(2))
      goal = trim(goal_names(goal_base))
      call group%get_word('GOAL', goal, findings)
      cam%goal = findloc(goal_names == upper_case(goal), .true., dim=1)
      if (cam%goal == 0) then
         call out_of(group, 'GOAL', "there is no goal '"//goal//"'; it is BASE, OUTER, ALPHA, RHO, ACCEL or STRESS", findings)
         cam%goal = goal_base
      end if
      if (cam%goal == goal_stress .and. .not. (cam%speed > 0.0_wp .and. cam%width > 0.0_wp)) call out_of(group, 'GOAL', &
         'stress needs CAMRPM and CAMWID', findings)
      if (n > 0 .and. cam%slides .and. (cam%goal == goal_base .or. cam%goal == goal_outer)) call out_of(group, 'GOAL', &
         'a cam that slides has no base circle: make something else least', findings)
      if (n > 0 .and. any(given < n)) call out_of(group, 'VARY', 'each number that varies needs bounds, VARLOW and VARHI', findings)
      do k = 1, n
         associate (one => cam%variations(k))
            names(k) = adjustl(names(k))
            first = index(trim(names(k))//' ', ' ')
            word = upper_case(names(k) (:first - 1))
            one%item = findloc(vary_names == word, .true., dim=1)
            numbers = 0
            state = 0
            if (one%item >= first_of_segments) then
               read (names(k) (first:), *, iostat=state) numbers(:merge(2, 1, one%item == of_zones))
            else if (len_trim(names(k) (first:)) > 0) then
               state = 1
            end if
            one%segment = numbers(1)
            one%zone = numbers(2)
            one%low = low(k)
            one%high = high(k)
            if (one%item == 0) then
               call out_of(group, 'VARY', "'"//trim(names(k))//"' cannot vary; it is XCAM, YCAM, FOLLK, FOLANG, FACANG, RROLL, "// &
                           "ORIGLK, ORIGNG, 'SEGEND 1', 'SEGVEL 1', 'SEGACC 1' or 'TZONE 1 2' (segment, zone)", findings, k)
               one%item = 1
               cycle
            end if
            if (one%item >= first_of_segments .and. state == 0) then
               if (one%segment < 1 .or. one%segment > size(cam%finish)) state = 1
               if (one%item == of_zones .and. (one%zone < 1 .or. one%zone > zone_count)) state = 1
               if (word == 'SEGEND' .and. one%segment == size(cam%finish)) state = 1
            end if
            if (cam%half .and. one%item >= first_of_segments) call out_of(group, 'VARY', "'"//trim(names(k))// &
               "': a segment of half a turn (KHALF) cannot vary", findings, k)
            if (state /= 0) then
               call out_of(group, 'VARY', "'"//trim(names(k))//"': there is no such segment or zone to vary", findings, k)
            else if (word == 'TZONE') then
               if (cam%law(one%segment) /= law_trig) call out_of(group, 'VARY', "'"//trim(names(k))// &
                                                                 "': only 'TRIG' has zones of the user's", findings, k)
            end if
            if (n > 0 .and. all(given >= n) .and. .not. one%high > one%low) call out_of(group, 'VARHI', 'entry '//to_text(k)// &
               ': must be above VARLOW', findings, k)
         end associate
      end do
   end subroutine read_variations

   !> What of a sketch carries the follower.
   subroutine read_joints(group, sketch, cam, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(in) :: sketch
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:)
      integer, allocatable :: joints(:)
      logical :: valid

      call group%get_texts('FOLJNT', names, findings)
      if (size(names) == 0) return
      if (.not. sketch%given) then
         call out_of(group, 'FOLJNT', 'joints have names in a sketch (&CHAIN) only; NFOLLK is the arc of &LINKS', findings)
         return
      end if
      if (group%given('NFOLLK')) call out_of(group, 'NFOLLK', 'the follower is on an arc or on joints (FOLJNT), not both', findings)
      if (.not. sketch%sound) return
      call find_joints(group, 'FOLJNT', 1, trim(names(1)), 'the follower', sketch, findings, joints, valid)
      if (.not. valid) return
      if (size(names) > 1 .or. size(joints) < 1 .or. size(joints) > 2) then
         call out_of(group, 'FOLJNT', "one text with one joint or two, as 'B' or 'A B'", findings)
         return
      end if
      cam%joints = [joints(1), joints(size(joints))]
      cam%link = common_link(sketch, cam%joints)
      if (cam%link == 0) call out_of(group, 'FOLJNT', 'the two joints are of no common link', findings)
      if (size(joints) == 1 .and. (cam%kind == follower_flat .or. cam%roller%distance > 0.0_wp)) &
         call out_of(group, 'FOLJNT', 'FOLLK and the direction of a face are counted from a line: name two joints', findings)
   end subroutine read_joints

   !> A second roller on the same profile, on an arc of its own; errors of the profiles of conjugate cams.
   subroutine read_pair(group, ilink, cam, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      integer :: pair
      logical :: there

      pair = 0
      call read_flag(group, 'KPAIR', pair, findings)
      cam%pair = pair == 1
      cam%second_arc = merge(-cam%arc, cam%arc, cam%from_start)
      cam%second_loop = cam%loop
      call group%get_integer('NFOL2K', cam%second_arc, findings)
      call group%get_integer('NFOL2P', cam%second_loop, findings)
      cam%second_from_start = cam%second_arc < 0
      cam%second_arc = abs(cam%second_arc)
      call group%get_reals('CAMERR', cam%errors, findings)
      if (group%given('CAMERR') .and. .not. cam%conjugate) call out_of(group, 'CAMERR', 'is of conjugate cams (KCONJ=1)', findings)
      if (.not. cam%pair) then
         if (group%given('NFOL2K')) call out_of(group, 'NFOL2K', 'is of two rollers on one profile (KPAIR=1)', findings)
         if (group%given('NFOL2P')) call out_of(group, 'NFOL2P', 'is of two rollers on one profile (KPAIR=1)', findings)
         return
      end if
      if (cam%conjugate .or. cam%track) call out_of(group, 'KPAIR', &
         'the second roller runs on the same profile, on a conjugate cam (KCONJ), or there is a track (KTRACK)', findings)
      if (cam%kind == follower_flat) call out_of(group, 'KPAIR', 'two rollers on one profile: KFOL=1', findings)
      if (size(ilink) == 0) return
      there = cam%second_loop >= 1 .and. cam%second_loop <= size(ilink, 2) .and. cam%second_arc >= 1 &
              .and. cam%second_arc <= size(ilink, 1)
      if (there) there = ilink(cam%second_arc, cam%second_loop) /= 0
      if (.not. there) call out_of(group, 'NFOL2K', 'there is no arc '//to_text(cam%second_arc)//' in loop '// &
                                   to_text(cam%second_loop), findings)
   end subroutine read_pair

   !> The way of a cam that slides.
   subroutine read_slide(group, cam, findings)
      type(group_t), intent(inout) :: group
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings

      call group%get_real('CAMDIR', cam%direction, findings)
      call group%get_real('CAMLEN', cam%travel, findings)
      if (.not. cam%slides) then
         if (group%given('CAMDIR')) call out_of(group, 'CAMDIR', 'is of a cam that slides (KCAM=2)', findings)
         if (group%given('CAMLEN')) call out_of(group, 'CAMLEN', 'is of a cam that slides (KCAM=2)', findings)
         return
      end if
      if (.not. group%given('CAMLEN')) then
         call required(group, 'CAMLEN', 'missing; the way of the cam while the law goes from 0 to 360')
      else if (.not. cam%travel > 0.0_wp) then
         call out_of(group, 'CAMLEN', 'must be above 0; turn CAMDIR by 180 instead', findings)
      end if
      if (cam%kind == follower_flat) call out_of(group, 'KFOL', 'a cam that slides needs a roller or a knife edge', findings)
      if (cam%pair) call out_of(group, 'KPAIR', 'a cam that slides has one roller, or a track or a conjugate', findings)
      if (group%given('KTURN')) call out_of(group, 'KTURN', 'a cam that slides does not turn', findings)
   end subroutine read_slide

   subroutine read_follower(group, ilink, cam, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)
      type(cam_group_t), intent(inout) :: cam
      type(diagnostics_t), intent(inout) :: findings
      integer :: of_output, conjugate, track

      of_output = 1
      call read_flag(group, 'KOUT', of_output, findings)
      cam%of_output = of_output == 1
      of_output = 0
      call read_flag(group, 'KDEAD', of_output, findings)
      cam%through = of_output == 1
      call group%get_integer('KAXIS', cam%axis, findings)
      call check_range(group, 'KAXIS', cam%axis, 1, most_numbers, findings)
      call group%get_integer('NFOLLK', cam%arc, findings)
      call group%get_integer('NFOLLP', cam%loop, findings)
      cam%from_start = cam%arc < 0
      cam%arc = abs(cam%arc)
      if (cam%given .and. size(ilink) > 0) then
         if (cam%loop < 1 .or. cam%loop > size(ilink, 2)) then
            call out_of(group, 'NFOLLP', 'there is no loop '//to_text(cam%loop), findings)
         else if (cam%arc < 1 .or. cam%arc > size(ilink, 1)) then
            call out_of(group, 'NFOLLK', 'there is no arc '//to_text(cam%arc)//' in loop '//to_text(cam%loop), findings)
         else if (ilink(cam%arc, cam%loop) == 0) then
            call out_of(group, 'NFOLLK', 'there is no arc '//to_text(cam%arc)//' in loop '//to_text(cam%loop), findings)
         end if
      end if
      call group%get_real('FOLLK', cam%roller%distance, findings)
      call group%get_real('FOLANG', cam%roller%angle, findings)
      call group%get_real('RROLL', cam%roller%radius, findings)
      call refuse_unless([cam%roller%distance >= 0.0_wp], group, 'FOLLK', 'the length is negative; turn FOLANG by 180 instead', &
                         findings)
      call refuse_unless([cam%roller%radius >= 0.0_wp], group, 'RROLL', 'must not be negative', findings)
      call group%get_integer('KFOL', cam%kind, findings)
      call check_range(group, 'KFOL', cam%kind, follower_roller, follower_flat, findings)
      call group%get_real('FACANG', cam%face_angle, findings)
      cam%cutter = cam%roller%radius
      call group%get_real('RCUT', cam%cutter, findings)
      cam%cutter_given = group%given('RCUT')
      if (cam%cutter_given .and. .not. cam%cutter > 0.0_wp) call out_of(group, 'RCUT', 'the cutter needs a radius above 0', &
                                                                       findings)
      call group%get_real('XCAM', cam%x, findings)
      call group%get_real('YCAM', cam%y, findings)
      call group%get_integer('KTURN', cam%turn, findings)
      if (abs(cam%turn) /= 1) call out_of(group, 'KTURN', 'must be 1 (anticlockwise) or -1', findings)
      call group%get_integer('KSIDE', cam%side, findings)
      call check_range(group, 'KSIDE', cam%side, -1, 1, findings)
      conjugate = 0
      track = 0
      call read_flag(group, 'KCONJ', conjugate, findings)
      call read_flag(group, 'KTRACK', track, findings)
      cam%conjugate = conjugate == 1
      cam%track = track == 1
      cam%second = roller_t(0.0_wp, 0.0_wp, cam%roller%radius)
      call group%get_real('FOLLK2', cam%second%distance, findings)
      call group%get_real('FOLAN2', cam%second%angle, findings)
      call group%get_real('RROLL2', cam%second%radius, findings)
      call refuse_unless([cam%second%distance >= 0.0_wp], group, 'FOLLK2', 'the length is negative; turn FOLAN2 by 180 instead', &
                         findings)
      call refuse_unless([cam%second%radius >= 0.0_wp], group, 'RROLL2', 'must not be negative', findings)
      call group%get_real('CLEAR', cam%clearance, findings)
      call refuse_unless([cam%clearance >= 0.0_wp], group, 'CLEAR', 'must not be negative', findings)
      if (cam%conjugate .and. cam%track) call out_of(group, 'KTRACK', &
         'a cam has a conjugate (KCONJ) or runs in a track, not both', findings)
      if (cam%track .and. .not. cam%roller%radius > 0.0_wp) call out_of(group, 'KTRACK', 'a track needs a roller', findings)
      if ((cam%track .or. cam%conjugate) .and. cam%kind == follower_flat) call out_of(group, 'KFOL', &
         'conjugate cams and tracks need rollers', findings)
      call group%get_real('CAMRPM', cam%speed, findings)
      call refuse_unless([cam%speed >= 0.0_wp], group, 'CAMRPM', 'must not be negative; KTURN says which way', findings)
      call group%get_real('CAMWID', cam%width, findings)
      call refuse_unless([cam%width >= 0.0_wp], group, 'CAMWID', 'must not be negative', findings)
      call group%get_reals('CAMMOD', cam%modulus, findings)
      call refuse_unless(cam%modulus > 0.0_wp, group, 'CAMMOD', 'must be above 0', findings)
      call group%get_reals('CAMNU', cam%poisson, findings)
      call refuse_unless(cam%poisson >= 0.0_wp .and. cam%poisson <= 0.5_wp, group, 'CAMNU', 'must lie between 0 and 0.5', findings)
      call group%get_real('CAMMU', cam%friction, findings)
      call refuse_unless([cam%friction >= 0.0_wp], group, 'CAMMU', 'must not be negative', findings)
      call group%get_real('PHERTZ', cam%stress, findings)
      call refuse_unless([cam%stress >= 0.0_wp], group, 'PHERTZ', 'must not be negative', findings)
      call group%get_real('CAMFRQ', cam%frequency, findings)
      call refuse_unless([cam%frequency >= 0.0_wp], group, 'CAMFRQ', 'must not be negative', findings)
      call group%get_real('CAMZET', cam%damping, findings)
      call refuse_unless([cam%damping >= 0.0_wp], group, 'CAMZET', 'must not be negative', findings)
   end subroutine read_follower

   !> The group as the case has it.
   subroutine read_cam(self, group, about, findings)
      class(cam_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      if (group%name == second_cam) self%axis = 2
      call read_cam_group(group, about%ilink, about%sketch, self, findings)
      if (self%given .and. group%name == second_cam .and. .not. about%sketch%given) call out_of(group, 'NSEG', &
         'a second cam needs a second drive, which a sketch can have (&CHAIN, &DRIVES)', findings)
   end subroutine read_cam

   !> The groups CAM and CAM2 of a case; as they are by default where the case does not have them.
   pure function cams_of(set) result(cams)
      class(data_set_t), intent(in) :: set
      type(cam_group_t) :: cams(2)
      integer :: which, k

      do which = 1, size(cams)
         k = set%place_of(trim(merge(first_cam, second_cam, which == 1)))
         if (k == 0) cycle
         select type (group => set%sections(k)%group)
         type is (cam_group_t)
            cams(which) = group
         end select
      end do
   end function cams_of
end module psalm_cam_group
