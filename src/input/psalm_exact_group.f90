!> The group EXACT: points, poses, timed points or a function that a four-bar or slider-crank is to meet exactly.
module psalm_exact_group
   use psalm_case_group, only: case_group_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of, required
   use psalm_kinds, only: wp, full_turn
   use psalm_rule, only: rule_t, a_flag, a_number, a_whole, a_word
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: exact_items
   public :: exact_group_t, exact_of, is_missing, kind_path, kind_motion, kind_function, exact_kinds, &
             six_bar_none, six_bar_stephenson, six_bar_watt, six_bar_stephenson_2

   integer, parameter :: kind_path = 1, kind_motion = 2, kind_function = 3
   character(*), parameter :: exact_kinds(3) = [character(8) :: 'PATH', 'MOTION', 'FUNCTION']
   !> Items that only KIND='FUNCTION' has.
   character(*), parameter :: for_functions = "is for linkages that generate a function: KIND='FUNCTION'"
   character(*), parameter :: of_functions(*) = [character(6) :: 'FUNC', 'FXLOW', 'FXHIGH', 'FPOWER', 'DPHI', 'DPSI', 'PSI', &
                                                 'PHI0', 'PSI0', 'SLOPE', 'CURV', 'SIXBAR', 'NPOINT', 'CRANK', 'OUTPIN', &
                                                 'ARMLEN', 'START']
   !> Of these, those of a function that has a name.
   character(*), parameter :: of_named(*) = [character(6) :: 'FXLOW', 'FXHIGH', 'FPOWER', 'DPHI', 'DPSI']
   character(*), parameter :: functions(*) = [character(7) :: 'LOG10', 'LN', 'EXP', 'SIN', 'COS', 'TAN', 'POWER']
   integer, parameter :: most_points = 60, most_exact_points = 9, most_in_table = 200, fewest_in_table = 3
   integer, parameter :: exact_in_table = 5          !! entries of a table that a linkage can meet exactly
   real(wp), parameter :: most_turned = 36000.0_wp   !! degrees of the crank, as of DPHI: the motion is followed turn by turn
   real(wp), parameter :: of_frame = 1.0e-6_wp       !! difference of lengths that are the same
   integer, parameter :: six_bar_none = 1, six_bar_stephenson = 2, six_bar_watt = 3, six_bar_stephenson_2 = 4
   !> Points that a six-bar of each kind is determined by if nothing of it is given, and those whose start set is made without
   !> being asked for.
   integer, parameter :: free_points(4) = [0, 11, 9, 11], kept_at_once(4) = [0, 7, 9, 8]
   integer, parameter :: with_pivot = 9, with_pivot_and_crank = 7 !! of Stephenson III
   real(wp), parameter :: not_given = -huge(1.0_wp)

   type, extends(case_group_t) :: exact_group_t
      integer :: kind = kind_path                    !! KIND
      real(wp), allocatable :: x(:), y(:)            !! XP, YP
      real(wp), allocatable :: angle(:), time(:)     !! ANGP, TIMP, degrees; see `is_missing`
      logical :: crank_pivot = .false., follower_pivot = .false. !! PIVOTS: the first two, the last two numbers were given
      real(wp) :: pivots(4) = not_given
      logical :: slider = .false.                    !! SLIDER=1: a pin on a fixed line in place of the follower
      logical :: block = .false.                     !! SLIDER=2: a line of the coupler through a fixed pivot
      logical :: closed = .false.                    !! CLOSED: the last point is followed by the first
      character(:), allocatable :: function_name     !! FUNC; not allocated: PHI and PSI, or no function
      real(wp) :: low = 1.0_wp, high = 2.0_wp        !! FXLOW, FXHIGH
      real(wp) :: power = 2.0_wp                     !! FPOWER
      real(wp) :: swing_in = 90.0_wp                 !! DPHI, degrees
      real(wp) :: swing_out = 90.0_wp                !! DPSI, degrees; of a slider its travel
      real(wp), allocatable :: phi(:), psi(:)        !! PHI, PSI, degrees; of a slider PSI is its travel
      real(wp), allocatable :: slope(:), curvature(:) !! SLOPE, CURV, shape (entries): derivatives of PSI by PHI
      real(wp), allocatable :: tangent(:), bend(:)   !! TANP, degrees, CURVP, shape (points): of the path at the points
      real(wp), allocatable :: pole_x(:), pole_y(:)  !! XPOLE, YPOLE, shape (points): about what the body turns in a pose
      real(wp) :: zero_in = not_given, zero_out = not_given !! PHI0, PSI0, degrees
      real(wp) :: frame = 1.0_wp                     !! FRAME: length of a four-bar's frame
      real(wp) :: longest = 100.0_wp                 !! RLONG: longest link over the frame, of a slider over the travel
      integer :: six_bar = six_bar_none              !! SIXBAR
      integer :: precision_points = 5                !! NPOINT: of a six-bar that generates FUNC
      real(wp) :: crank(2) = not_given               !! CRANK: pin of a six-bar's crank at input 0
      real(wp) :: output_pin(2) = not_given          !! OUTPIN: pin of Stephenson II's output link at output 0, from B
      real(wp) :: arm_length = not_given             !! ARMLEN
      logical :: start = .false.                     !! START: a start set that takes long is wanted
      integer :: grid = 6                            !! NGRID: values of each dimension of a six-bar's driver
      logical :: has_arm = .false.                   !! ARM was given
      real(wp) :: arm(6) = not_given                 !! ARM: joints of a chain in the first pose
      real(wp) :: least_transmission = 20.0_wp       !! TRMIN, degrees
      logical :: has_least_transmission = .false.    !! TRMIN was given: other linkages than six-bars obey it too
      integer :: subsets = 3                         !! NSUB: sets of nine of more points
      logical :: minimax = .false.                   !! MINIMAX
      logical :: certify = .false.                   !! CERTIFY
      integer :: listed = 10                         !! NBEST
      real(wp) :: longest_time = 0.0_wp              !! MAXTIME, seconds; 0: not given, no limit
   contains
      procedure :: read => read_exact
      procedure :: wants_every_six_bar
      procedure :: points_determined
      procedure :: has_tangents
   end type exact_group_t

   !> The items of the group.
   type(rule_t), parameter :: exact_items(*) = [ &
      rule_t('KIND', a_word, '', '', 'PATH', 'PATH MOTION FUNCTION', &
             '''PATH'': points of the coupler; ''MOTION'': poses; ''FUNCTION'': output against input'), &
      rule_t('XP', a_number, 'n', 'length', 'required, but for FUNCTION', '', &
             'x of the points, 2 to 9 to be met; 10 to 60 to be passed near by'), &
      rule_t('YP', a_number, 'n', 'length', 'required, but for FUNCTION', '', &
             'their y'), &
      rule_t('ANGP', a_number, 'n', 'degrees', '', '', &
             'orientation of the coupler at each point, whole turns do not count; with ''PATH'' a point without '// &
             'one (`,,`) is a point only'), &
      rule_t('XPOLE', a_number, 'n', 'length', '', '', &
             '''MOTION'': x of the point about which the body is to turn while it passes a pose (instant centre); it '// &
             'counts as a pose. Poses without one are left out (`,,`)'), &
      rule_t('YPOLE', a_number, 'n', 'length', '', '', &
             'its y'), &
      rule_t('TIMP', a_number, 'n', 'degrees', '', '', &
             'angle of the crank at each point; a point without one is untimed'), &
      rule_t('TANP', a_number, 'n', 'degrees', '', '', &
             '''PATH'': direction of the path at a point, in either sense, met exactly too; it counts as a point. Points '// &
             'without one are left out (`,,`)'), &
      rule_t('CURVP', a_number, 'n', '1/length', '', '', &
             '''PATH'': curvature of the path there, at a point with TANP; it counts as one more. Above 0: to the left of '// &
             'that direction'), &
      rule_t('PIVOTS', a_number, '4', 'length', 'free', '', &
             'x, y of the crank''s fixed pivot, x, y of the follower''s; `PIVOTS=0.0,0.0` gives the first alone. Of a '// &
             'six-bar the third fixed pivot, from A on the line to B: of Stephenson III it counts as given, of Watt II '// &
             'it is only drawn there'), &
      rule_t('SLIDER', a_whole, '', '', '0', '[0,2]', &
             '1: a slider on a straight line in place of the follower; 2: a line of the coupler goes through a '// &
             'block at a fixed pivot (''MOTION'' only)'), &
      rule_t('CLOSED', a_flag, '', '', 'of points only 1, else 0', '', &
             '1: the path is closed, the last point is followed by the first'), &
      rule_t('FUNC', a_word, '', '', '', 'LOG10 LN EXP SIN COS TAN POWER', &
             'the function; SIN, COS and TAN of x in degrees'), &
      rule_t('FXLOW', a_number, '', '', '1', '', &
             'range of x: its lower end'), &
      rule_t('FXHIGH', a_number, '', '', '2', '', &
             'its upper end'), &
      rule_t('FPOWER', a_number, '', '', '2', '', &
             'exponent of POWER'), &
      rule_t('DPHI', a_number, '', 'degrees', '90', '[-36000,36000]', &
             'turn of the crank over the range'), &
      rule_t('DPSI', a_number, '', 'degrees, length', '90', '[-1e6,1e6]', &
             'turn of the follower over the range; of a slider its travel'), &
      rule_t('PHI', a_number, 'n', 'degrees', '', '', &
             'a table in place of FUNC: angles of the crank, from a free zero line; five points (four with one '// &
             'of PHI0 and PSI0, three with both) to be met, seven to eleven by a six-bar (SIXBAR), more with MINIMAX=1'), &
      rule_t('PSI', a_number, 'n', 'degrees, length', '', '', &
             'the angles of the follower, or the travel of the slider'), &
      rule_t('SLOPE', a_number, 'n', '', '', '', &
             'derivative of PSI by PHI at a point of the table, met exactly too; it counts as a point. Of a slider '// &
             'length per radian; points without one are left out (`,,`)'), &
      rule_t('CURV', a_number, 'n', '1/rad', '', '', &
             'second derivative there, of a point with SLOPE; it counts as one more. Of a slider '// &
             'length per squared radian'), &
      rule_t('PHI0', a_number, '', 'degrees', '', '', &
             'zero line of PHI of three or four points, from the frame'), &
      rule_t('PSI0', a_number, '', 'degrees, length', '', '', &
             'zero line of PSI'), &
      rule_t('FRAME', a_number, '', 'length', '1', '(0,)', &
             'length of a four-bar''s frame'), &
      rule_t('MINIMAX', a_flag, '', '', '0', '', &
             '1: make the largest error least, of six-bars from all exact ones; 0: meet points (of FUNC those of Chebyshev)'), &
      rule_t('SIXBAR', a_word, '', '', 'NONE', 'NONE STEPHENSON WATT STEPHENSON2', &
             'a six-bar that generates a function: ''WATT'' (II), ''STEPHENSON'' (III) and ''STEPHENSON2''; through five '// &
             'points a sample of the first two, through the points in NPOINT all there are', &
             'must be ''STEPHENSON'', ''WATT'' or ''STEPHENSON2'''), &
      rule_t('NPOINT', a_whole, '', '', '5', '[5,11]', &
             'six-bars: points of FUNC, those of Chebyshev, that are met: 5 (not ''STEPHENSON2''); ''WATT'' 9, with ARMLEN 8; '// &
             '''STEPHENSON'' 7 with PIVOTS and CRANK, 9 with PIVOTS, 11; ''STEPHENSON2'' 8 with OUTPIN and ARMLEN, 11 '// &
             '(with MINIMAX it need not be given)'), &
      rule_t('CRANK', a_number, '2', 'length', 'free', '', &
             'of ''STEPHENSON'' through seven points: x, y from A of the crank''s pin at input 0'), &
      rule_t('OUTPIN', a_number, '2', 'length', 'free', '', &
             'of ''STEPHENSON2'' through eight points: x, y from B of the output link''s pin at output 0'), &
      rule_t('ARMLEN', a_number, '', 'length', 'free', '(0,)', &
             'of ''WATT'' through eight points the arm B D of the middle link; of ''STEPHENSON2'' the arm E G of the '// &
             'floating link'), &
      rule_t('START', a_flag, '', '', '0', '', &
             'six-bars through 9 (''STEPHENSON'') or 11 points: 1: their start set is made once, which takes from eight '// &
             'minutes to hours (the message without it says how long)'), &
      rule_t('NGRID', a_whole, '', '', '6', '[2,12]', &
             'six-bars: values of each dimension that is sampled'), &
      rule_t('TRMIN', a_number, '', 'degrees', 'six-bars: 20, else none', '[0,90)', &
             'least transmission angle: linkages below it are left out and counted (over the turn; of a rocking '// &
             'crank at the points, with IPROOF as proven between them; of a six-bar over the range). Without '// &
             'effect, which is reported, on four-bars and slider-cranks that generate functions and with ARM', &
             'must be from 0 to less than 90 degrees'), &
      rule_t('NSUB', a_whole, '', '', '3', '[1,100]', &
             'sets of nine points that are drawn of more'), &
      rule_t('RLONG', a_number, '', '', '100', '(1,)', &
             'linkages with a link longer than this, over the frame, the travel or the size of the path, are '// &
             'left out (MINIMAX, SIXBAR, NSUB)'), &
      rule_t('ARM', a_number, '6', 'length', '', '', &
             'five poses by a six-bar: x, y in the first pose of the fixed pivot, the elbow and the joint with '// &
             'the body of a chain of three joints'), &
      rule_t('CERTIFY', a_flag, '', '', '0', '', &
             '1: prove by Krawczyk''s test in discs how many of the ends exist, differ from all others, and are '// &
             'real (complete lists: not four poses, three with SLIDER, ARM, MINIMAX, NSUB, three or four points of a '// &
             'function, six-bars through five; of other six-bars the real ones)'), &
      rule_t('NBEST', a_whole, '', '', '10', '[1,100000]', &
             'linkages that are listed'), &
      rule_t('MAXTIME', a_number, '', 's', 'no limit', '(0,)', &
             'what was found so far is listed then, with the verdict `not complete: stopped after MAXTIME` and '// &
             'no certificate (exit status 1)', &
             'must be above 0 seconds; leave it out for no limit')]

contains

   !> True for a number that was not given.
   elemental logical function is_missing(value)
      real(wp), intent(in) :: value

      is_missing = value <= 0.5_wp*not_given
   end function is_missing

   !> True if directions of the path are given.
   pure logical function has_tangents(self)
      class(exact_group_t), intent(in) :: self

      has_tangents = allocated(self%tangent)
      if (has_tangents) has_tangents = any(.not. is_missing(self%tangent))
   end function has_tangents

   !> Read the group EXACT. Errors: a kind that is not there, too few values, numbers out of range.
   subroutine read_exact_group(group, exact, findings)
      type(group_t), intent(inout) :: group
      type(exact_group_t), intent(inout) :: exact
      type(diagnostics_t), intent(inout) :: findings
      integer :: code, last

      exact%given = group%line > 0
      call group%follow(exact_items)
      call take(group, 'KIND', exact%kind, findings)
      call read_points(group, exact, findings)
      call take(group, 'PIVOTS', exact%pivots, findings, last=last)
      exact%crank_pivot = .not. any(is_missing(exact%pivots(:2)))
      exact%follower_pivot = .not. any(is_missing(exact%pivots(3:)))
      if (any(is_missing(exact%pivots(:2))) .neqv. all(is_missing(exact%pivots(:2))) .or. &
          (any(is_missing(exact%pivots(3:))) .neqv. all(is_missing(exact%pivots(3:))))) call out_of(group, 'PIVOTS', &
         "is x and y of the crank's fixed pivot, then of the follower's; one that is free is left out: PIVOTS=,,3.0,4.0", findings)
      call take(group, 'SLIDER', code, findings)
      exact%slider = code == 1
      exact%block = code == 2
      if (exact%block .and. exact%kind /= kind_motion) call out_of(group, 'SLIDER', &
         "SLIDER=2, a line of the coupler through a fixed pivot, is for poses (KIND='MOTION')", findings)
      code = merge(1, 0, exact%kind == kind_path .and. count(is_missing(exact%time)) == size(exact%time))
      call take(group, 'CLOSED', code, findings)
      exact%closed = code == 1
      call read_arm(group, exact, findings)
      call take(group, 'MINIMAX', exact%minimax, findings)
      if (exact%minimax .and. exact%kind /= kind_function) call out_of(group, 'MINIMAX', for_functions, findings)
      call read_function(group, exact, findings)
      call take(group, 'CERTIFY', exact%certify, findings)
      call take(group, 'NSUB', exact%subsets, findings)
      if (group%given('NSUB') .and. size(exact%x) <= most_exact_points) call findings%warning( &
         'has no effect: it is for more than 9 points of a path', line=group%line, group=trim(group%name), item='NSUB')
      call take(group, 'NBEST', exact%listed, findings)
      call take(group, 'MAXTIME', exact%longest_time, findings)
   end subroutine read_exact_group

   subroutine read_points(group, exact, findings)
      type(group_t), intent(inout) :: group
      type(exact_group_t), intent(inout) :: exact
      type(diagnostics_t), intent(inout) :: findings
      real(wp) :: x(most_points), y(most_points), angle(most_points), time(most_points)
      real(wp) :: pole_x(most_points), pole_y(most_points), tangent(most_points), bend(most_points)
      integer :: n, last(4), of_poles(2), of_path(2), i

      x = not_given
      y = not_given
      angle = not_given
      time = not_given
      call take(group, 'XP', x, findings, last=last(1))
      call take(group, 'YP', y, findings, last=last(2))
      call take(group, 'ANGP', angle, findings, last=last(3))
      call take(group, 'TIMP', time, findings, last=last(4))
      pole_x = not_given
      pole_y = not_given
      call take(group, 'XPOLE', pole_x, findings, last=of_poles(1))
      call take(group, 'YPOLE', pole_y, findings, last=of_poles(2))
      tangent = not_given
      bend = not_given
      call take(group, 'TANP', tangent, findings, last=of_path(1))
      call take(group, 'CURVP', bend, findings, last=of_path(2))
      n = last(1)
      exact%tangent = tangent(:n)
      exact%bend = bend(:n)
      exact%pole_x = pole_x(:n)
      exact%pole_y = pole_y(:n)
      exact%x = x(:n)
      exact%y = y(:n)
      exact%angle = angle(:n)
      exact%time = time(:n)
      if (.not. exact%given) return
      if (maxval(of_poles) > 0 .and. exact%kind /= kind_motion) call out_of(group, trim(merge('XPOLE', 'YPOLE', &
         of_poles(1) > 0)), "is for poses of a body: KIND='MOTION'", findings)
      if (maxval(of_path) > 0 .and. exact%kind /= kind_path) call out_of(group, trim(merge('TANP ', 'CURVP', of_path(1) > 0)), &
         "is for points of a path: KIND='PATH', where points may have orientations (ANGP) too", findings)
      if (exact%kind == kind_function) return
      if (.not. group%given('XP')) then
         call required(group, 'XP')
         return
      end if
      if (last(2) /= n) call out_of(group, 'YP', 'XP has '//to_text(n)//' values, but YP has '//to_text(last(2)), findings)
      if (max(last(3), last(4)) > n) call out_of(group, merge('ANGP', 'TIMP', last(3) > n), 'XP has '//to_text(n)// &
                                                 ' values only', findings, n + 1)
      i = findloc(is_missing(exact%x) .or. is_missing(exact%y), .true., dim=1)
      if (i > 0 .and. last(2) == n) call out_of(group, merge('XP', 'YP', is_missing(exact%x(i))), 'point '//to_text(i)// &
                                                ' has no value', findings)
      if (exact%kind == kind_motion) then
         i = findloc(is_missing(exact%angle), .true., dim=1)
         if (i > 0) call out_of(group, 'ANGP', "KIND='MOTION' needs an orientation for every point; point "//to_text(i)// &
                                " has none (KIND='PATH' has points with and without)", findings)
      end if
      if (maxval(of_path) > n) call out_of(group, trim(merge('TANP ', 'CURVP', of_path(1) > n)), 'XP has '//to_text(n)// &
                                           ' values only', findings, n + 1)
      i = findloc(is_missing(exact%tangent) .and. .not. is_missing(exact%bend), .true., dim=1)
      if (i > 0) call out_of(group, 'CURVP', 'point '//to_text(i)//' has a curvature, but no direction (TANP)', findings, i)
      if (maxval(of_path) > 0 .and. any(.not. is_missing(exact%angle(2:))) .and. any(.not. is_missing(exact%time(2:)))) &
         call out_of(group, 'TANP', 'directions are met with orientations (ANGP) or with crank angles (TIMP), not with both', &
                     findings)
      if (maxval(of_poles) > n) call out_of(group, merge('XPOLE', 'YPOLE', of_poles(1) > n), 'XP has '//to_text(n)// &
                                            ' values only', findings, n + 1)
      i = findloc(is_missing(exact%pole_x) .neqv. is_missing(exact%pole_y), .true., dim=1)
      if (i > 0) call out_of(group, merge('XPOLE', 'YPOLE', is_missing(exact%pole_x(i))), 'the pole of pose '//to_text(i)// &
                             ' needs x and y', findings, i)
      ! the first point has the zero of both
      i = 1 + findloc(.not. (is_missing(exact%angle(2:)) .or. is_missing(exact%time(2:))), .true., dim=1)
      if (i > 1) call out_of(group, 'TIMP', 'point '//to_text(i)//' has an orientation and a crank angle; one of both is '// &
                             'possible', findings)
      if (n > most_exact_points .and. (exact%kind /= kind_path .or. max(last(3), last(4)) > 0 .or. maxval(of_path) > 0 .or. &
                                       group%given('PIVOTS') .or. group%given('SLIDER'))) call out_of(group, 'XP', &
         'more than 9 points are possible for a four-bar with points only (its linkages pass nine of them exactly)', findings, n)
      if (n < 2) return
      if (any(.not. is_missing(exact%angle(2:))) .and. is_missing(exact%angle(1))) call out_of(group, 'ANGP', &
         'orientations are counted from that of the first point, which is missing', findings)
      if (any(.not. is_missing(exact%time(2:))) .and. is_missing(exact%time(1))) call out_of(group, 'TIMP', &
         'crank angles are counted from that of the first point, which is missing', findings)
   end subroutine read_points

   !> The joints of the chain of a six-bar that leads a body.
   subroutine read_arm(group, exact, findings)
      type(group_t), intent(inout) :: group
      type(exact_group_t), intent(inout) :: exact
      type(diagnostics_t), intent(inout) :: findings
      integer :: last

      call take(group, 'ARM', exact%arm, findings, last=last)
      exact%has_arm = last > 0
      if (.not. exact%has_arm) return
      if (last < size(exact%arm) .or. any(is_missing(exact%arm))) call out_of(group, 'ARM', &
         'is x and y of three joints in the first pose: fixed pivot, elbow, joint with the body', findings)
      if (exact%kind /= kind_motion .or. size(exact%x) /= exact_in_table .or. exact%slider .or. exact%block .or. &
          exact%crank_pivot .or. exact%follower_pivot .or. any(.not. is_missing(exact%pole_x))) call out_of(group, 'ARM', &
         "carries a body through five poses: KIND='MOTION', no SLIDER, no PIVOTS", findings)
   end subroutine read_arm

   subroutine read_function(group, exact, findings)
      type(group_t), intent(inout) :: group
      type(exact_group_t), intent(inout) :: exact
      type(diagnostics_t), intent(inout) :: findings
      real(wp) :: phi(most_in_table), psi(most_in_table), slope(most_in_table), curvature(most_in_table)
      integer :: n, last, i, of_rates(2), conditions

      call group%get_word('FUNC', exact%function_name, findings)
      call take(group, 'FXLOW', exact%low, findings)
      call take(group, 'FXHIGH', exact%high, findings)
      call take(group, 'FPOWER', exact%power, findings)
      call take(group, 'DPHI', exact%swing_in, findings)
      call take(group, 'DPSI', exact%swing_out, findings)
      call take(group, 'PHI0', exact%zero_in, findings)
      call take(group, 'PSI0', exact%zero_out, findings)
      call take(group, 'FRAME', exact%frame, findings)
      call take(group, 'RLONG', exact%longest, findings)
      call take(group, 'SIXBAR', exact%six_bar, findings)
      call take(group, 'NPOINT', exact%precision_points, findings)
      call take(group, 'CRANK', exact%crank, findings)
      call take(group, 'OUTPIN', exact%output_pin, findings)
      call take(group, 'ARMLEN', exact%arm_length, findings)
      call take(group, 'START', exact%start, findings)
      call take(group, 'NGRID', exact%grid, findings)
      call take(group, 'TRMIN', exact%least_transmission, findings)
      exact%has_least_transmission = group%given('TRMIN')
      phi = not_given
      psi = not_given
      call take(group, 'PHI', phi, findings, last=n)
      call take(group, 'PSI', psi, findings, last=last)
      exact%phi = phi(:n)
      exact%psi = psi(:n)
      slope = not_given
      curvature = not_given
      call take(group, 'SLOPE', slope, findings, last=of_rates(1))
      call take(group, 'CURV', curvature, findings, last=of_rates(2))
      exact%slope = slope(:n)
      exact%curvature = curvature(:n)
      if (.not. exact%given) return
      if (exact%kind /= kind_function) then
         do i = 1, size(of_functions)
            if (group%given(trim(of_functions(i)))) call out_of(group, trim(of_functions(i)), for_functions, findings)
         end do
         return
      end if
      if (exact%six_bar /= six_bar_none .and. exact%slider) call out_of(group, 'SIXBAR', 'a six-bar here has no slider', findings)
      if (allocated(exact%function_name) .eqv. n > 0) then
         call out_of(group, 'FUNC', "KIND='FUNCTION' needs either FUNC, a name, or PHI and PSI, a table", findings)
         return
      end if
      call check_six_bar(group, exact, n, findings)
      if (allocated(exact%function_name)) then
         if (maxval(of_rates) > 0) call out_of(group, trim(merge('SLOPE', 'CURV ', of_rates(1) > 0)), &
            'is for a table, PHI and PSI; of FUNC points are met', findings)
         if (.not. any(functions == exact%function_name)) call out_of(group, 'FUNC', "there is no function '"// &
            exact%function_name//"'; there are LOG10, LN, EXP, SIN, COS, TAN, POWER", findings)
         if (.not. exact%high > exact%low) call out_of(group, 'FXHIGH', 'the range of x is empty: FXHIGH must be above FXLOW', &
                                                       findings)
         if (any(exact%function_name == ['LOG10', 'LN   ']) .and. .not. exact%low > 0.0_wp) call out_of(group, 'FXLOW', &
            'a logarithm needs x above 0', findings)
         if (exact%function_name == 'POWER' .and. (exact%low < 0.0_wp .or. (.not. exact%low > 0.0_wp .and. exact%power < 0.0_wp))) &
            call out_of(group, 'FXLOW', 'this power needs x above 0', findings)
         if (.not. abs(exact%swing_in) > 0.0_wp .or. .not. abs(exact%swing_out) > 0.0_wp) call out_of(group, &
            merge('DPSI', 'DPHI', abs(exact%swing_in) > 0.0_wp), 'must not be 0', findings)
         return
      end if
      do i = 1, size(of_named)
         if (.not. group%given(trim(of_named(i)))) cycle
         call findings%warning('has no effect: it is the range of FUNC, and a table, PHI and PSI, has its own', line=group%line, &
                               group=trim(group%name), item=trim(of_named(i)))
      end do
      if (last /= n) call out_of(group, 'PSI', 'PHI has '//to_text(n)//' values, but PSI has '//to_text(last), findings)
      if (any(is_missing(exact%phi)) .or. (last == n .and. any(is_missing(exact%psi)))) call out_of(group, &
         merge('PHI', 'PSI', any(is_missing(exact%phi))), 'a value of the table is missing', findings)
      call check_rates(of_rates)
      conditions = n + count(.not. is_missing(exact%slope)) + count(.not. is_missing(exact%curvature))
      if (conditions > n) then
         if (conditions < fewest_in_table .or. conditions > exact_in_table .or. n < 2) call out_of(group, 'SLOPE', to_text(n)// &
            ' points and '//to_text(conditions - n)//' derivatives are '//to_text(conditions)//' conditions; with at least two '// &
            'points five can be met, four with one of PHI0 and PSI0, three with both', findings)
      else
         if (n < fewest_in_table) call out_of(group, 'PHI', 'a function is given by at least 3 points', findings)
         if (n > exact_in_table .and. .not. exact%minimax .and. exact%six_bar == six_bar_none) call out_of(group, 'PHI', &
            to_text(n)//' points cannot be met exactly; give 3 or 5, or MINIMAX=1, or a six-bar (SIXBAR)', findings, n)
      end if
      if (exact%phi(n) - exact%phi(1) > most_turned) call out_of(group, 'PHI', 'the crank turns '// &
         to_text(nint(most_turned/full_turn))//' times at most over the range; give angles of one turn, for whole turns do not '// &
         'change where it is', findings, n)
      do i = 2, n
         if (exact%phi(i) > exact%phi(i - 1)) cycle
         call out_of(group, 'PHI', 'entry '//to_text(i)//': the inputs must rise', findings, i)
         return
      end do
      if (conditions < exact_in_table .and. exact%minimax) call out_of(group, 'MINIMAX', &
         'needs FUNC or a table of more than 5 points', findings)
      if (conditions == 3 .and. (is_missing(exact%zero_in) .or. is_missing(exact%zero_out))) call out_of(group, 'PHI', &
         'three points need both zero lines, PHI0 and PSI0', findings)
      if (exact%six_bar /= six_bar_none) return
      if (conditions == 4) then
         if (is_missing(exact%zero_in) .eqv. is_missing(exact%zero_out)) call out_of(group, 'PHI', &
            'four points leave infinitely many linkages; give one of both zero lines, PHI0 or PSI0, or 5 points', findings, n)
         if (exact%slider .and. .not. is_missing(exact%zero_out)) call out_of(group, 'PSI0', &
            'four points of a slider-crank need the zero line of the crank, PHI0', findings)
      end if
      if (conditions == 3 .and. exact%slider) call out_of(group, 'PHI', &
         'three points with zero lines are for four-bars; give 5', findings, n)

   contains

      !> Derivatives of a table: as many as its entries at most, second ones with first ones.
      subroutine check_rates(last)
         integer, intent(in) :: last(2)

         if (maxval(last) == 0) return
         if (maxval(last) > n) call out_of(group, trim(merge('SLOPE', 'CURV ', last(1) > n)), 'PHI has '//to_text(n)// &
                                           ' values only', findings, n + 1)
         i = findloc(is_missing(exact%slope) .and. .not. is_missing(exact%curvature), .true., dim=1)
         if (i > 0) call out_of(group, 'CURV', 'point '//to_text(i)//' has a second derivative, but no first one (SLOPE)', &
                                findings, i)
         if (exact%minimax .or. exact%six_bar /= six_bar_none) call out_of(group, 'SLOPE', &
            'derivatives are met by four-bars and slider-cranks, without SIXBAR and MINIMAX', findings)
      end subroutine check_rates
   end subroutine read_function

   !> A six-bar: how many points it meets and what is given with them.
   subroutine check_six_bar(group, exact, entries, findings)
      type(group_t), intent(inout) :: group
      type(exact_group_t), intent(inout) :: exact    !! its NPOINT may be determined by what is given
      integer, intent(in) :: entries                 !! of the table, 0: a function
      type(diagnostics_t), intent(inout) :: findings
      character(*), parameter :: of_six_bars(*) = [character(6) :: 'NPOINT', 'CRANK', 'OUTPIN', 'ARMLEN']
      character(*), parameter :: chosen(*) = [character(6) :: 'PIVOTS', 'CRANK', 'OUTPIN', 'ARMLEN']
      character(:), allocatable :: item
      integer :: points, i

      if (exact%six_bar == six_bar_none) then
         do i = 1, size(of_six_bars)
            if (.not. group%given(trim(of_six_bars(i)))) cycle
            call out_of(group, trim(of_six_bars(i)), "is for six-bars: SIXBAR='WATT', 'STEPHENSON' or 'STEPHENSON2'", findings)
            return
         end do
         return
      end if
      if (group%given('PHI0') .or. group%given('PSI0')) call out_of(group, merge('PHI0', 'PSI0', group%given('PHI0')), &
         'is for four-bars and slider-cranks through three or four points; of a six-bar the zero lines are free', findings)
      if (entries > 0 .and. group%given('NPOINT')) call out_of(group, 'NPOINT', 'is for FUNC; a table has its own points', findings)
      if (exact%minimax .and. .not. group%given('NPOINT')) exact%precision_points = exact%points_determined()
      points = merge(entries, exact%precision_points, entries > 0)
      item = trim(merge('PHI   ', 'NPOINT', entries > 0))
      if (exact%minimax .and. entries > 0) then
         if (entries <= exact%points_determined()) call out_of(group, item, to_text(entries)//' entries are met, for there are '// &
            'six-bars through '//to_text(exact%points_determined())//': leave MINIMAX out, or give more', findings)
         points = exact%points_determined()
      end if
      if (points == exact_in_table .and. exact%six_bar /= six_bar_stephenson_2 .and. .not. exact%minimax) then
         do i = 1, size(chosen)
            if (group%given(trim(chosen(i)))) call out_of(group, trim(chosen(i)), 'of a six-bar through five points is sampled '// &
                                                          '(NGRID)', findings)
         end do
         return
      end if
      if (group%given('NGRID')) call out_of(group, 'NGRID', 'is for six-bars through five points; through more all are found', &
                                            findings)
      select case (exact%six_bar)
      case (six_bar_watt)
         if (points /= exact%points_determined()) call out_of(group, item, &
            'a six-bar of Watt II is made for 5 points (a sample), 8 with ARMLEN or 9 without (all there are); '// &
            'more are approximated by MINIMAX=1', findings)
         if (group%given('CRANK') .or. group%given('OUTPIN')) call out_of(group, trim(merge('CRANK ', 'OUTPIN', &
            group%given('CRANK'))), 'is not to be chosen in a six-bar of Watt II; ARMLEN is, with 8 points', findings)
      case (six_bar_stephenson)
         if (group%given('OUTPIN') .or. group%given('ARMLEN')) call out_of(group, merge('OUTPIN', 'ARMLEN', &
            group%given('OUTPIN')), "is not to be chosen in a six-bar of Stephenson III, but PIVOTS and CRANK", findings)
         if (points == with_pivot_and_crank .and. (exact%points_determined() /= points .or. exact%follower_pivot)) then
            call out_of(group, trim(merge('CRANK ', 'PIVOTS', exact%crank_pivot .and. .not. exact%follower_pivot)), &
               'seven points of a six-bar of Stephenson III need the third fixed pivot, PIVOTS=x,y, and the crank, CRANK=x,y', &
               findings)
            return
         end if
         if (points /= exact%points_determined() .or. (points == with_pivot .and. .not. exact%crank_pivot)) then
            call out_of(group, item, 'a six-bar of Stephenson III is made for 5 points (a sample) or, with PIVOTS and CRANK, '// &
                        '7 (all there are), and with START=1 for 9 with PIVOTS alone and 11; more are approximated by MINIMAX=1', &
                        findings)
            return
         end if
      case default
         if (group%given('CRANK') .or. group%given('PIVOTS')) call out_of(group, trim(merge('CRANK ', 'PIVOTS', &
            group%given('CRANK'))), 'is not to be chosen in a six-bar of Stephenson II, but OUTPIN and ARMLEN', findings)
         if (points /= exact%points_determined() .or. (group%given('OUTPIN') .neqv. group%given('ARMLEN'))) call out_of( &
            group, item, 'a six-bar of Stephenson II is made for 8 points with OUTPIN and ARMLEN (all there are), and with '// &
            'START=1 for 11; more are approximated by MINIMAX=1', findings)
      end select
      if (exact%points_determined() > kept_at_once(exact%six_bar) .and. .not. exact%start) call out_of(group, 'START', &
         hours_of(exact%six_bar, exact%points_determined())//' START=1 asks for them', findings)
      if (exact%points_determined() <= kept_at_once(exact%six_bar) .and. group%given('START')) call out_of(group, 'START', &
         'is for six-bars of Stephenson through 9 or 11 points; the start set of others is made without it', findings)
      if (exact%frame > 0.0_wp) call check_given_lengths(group, exact, findings)
   end subroutine check_six_bar

   !> How long the start set of a problem takes that is made on request only: measured (doc/measured/six_bars.md).
   pure function hours_of(six_bar, points) result(text)
      integer, intent(in) :: six_bar, points
      character(:), allocatable :: text

      if (six_bar == six_bar_stephenson .and. points == with_pivot) then
         text = 'nine points of Stephenson III have about 117 000 solutions; to make their start set took eight '// &
                'minutes of one thread, once:'
      else if (six_bar == six_bar_stephenson) then
         text = 'eleven points of Stephenson III have about 830 000 solutions; to make their start set takes 0.6 GB and an '// &
                'hour of one thread, once, and every problem a quarter of an hour:'
      else
         text = 'eleven points of Stephenson II have about 760 000 solutions; to make their start set takes 0.6 GB and an hour '// &
                'of one thread, once, and every problem, by an estimate, half an hour:'
      end if
   end function hours_of

   !> Given numbers of a six-bar that leave infinitely many.
   subroutine check_given_lengths(group, exact, findings)
      type(group_t), intent(inout) :: group
      type(exact_group_t), intent(in) :: exact
      type(diagnostics_t), intent(inout) :: findings

      if (exact%crank_pivot) then
         if (hypot(exact%pivots(1), exact%pivots(2)) < of_frame*exact%frame) call out_of(group, 'PIVOTS', &
            'the third fixed pivot is at A, where the crank has its own; move it away', findings)
         if (hypot(exact%pivots(1) - exact%frame, exact%pivots(2)) < of_frame*exact%frame) call out_of(group, 'PIVOTS', &
            'the third fixed pivot is at B, FRAME from A, where the rocker has its own; move it away', findings)
      end if
      if (.not. any(is_missing(exact%crank))) then
         if (hypot(exact%crank(1), exact%crank(2)) < of_frame*exact%frame) call out_of(group, 'CRANK', &
            'has no length: its pin is at A', findings)
         if (abs(hypot(exact%crank(1), exact%crank(2)) - exact%frame) < of_frame*exact%frame) call out_of(group, 'CRANK', &
            'is as long as the frame: kites and parallelograms, infinitely many, pass the points; change it a little', findings)
      end if
      if (.not. any(is_missing(exact%output_pin))) then
         if (hypot(exact%output_pin(1), exact%output_pin(2)) < of_frame*exact%frame) call out_of(group, 'OUTPIN', &
            'has no length: the pin is at B', findings)
         if (abs(hypot(exact%output_pin(1), exact%output_pin(2)) - exact%frame) < of_frame*exact%frame) call out_of(group, &
            'OUTPIN', 'is as long as the frame: the pin may come to A, where infinitely many linkages fold up; change it a '// &
            'little', findings)
      end if
      if (exact%six_bar == six_bar_watt .and. abs(exact%arm_length - exact%frame) < of_frame*exact%frame) call out_of(group, &
         'ARMLEN', 'is the length of the frame: kites and parallelograms, infinitely many, pass the points; change it a little', &
         findings)
   end subroutine check_given_lengths

   !> How many points a six-bar of this kind is determined by, with what is given of it.
   pure integer function points_determined(self)
      class(exact_group_t), intent(in) :: self

      points_determined = free_points(self%six_bar)
      if (self%six_bar == six_bar_stephenson) then
         if (self%crank_pivot) points_determined = points_determined - 2
         if (.not. any(is_missing(self%crank))) points_determined = points_determined - 2
      end if
      if (self%six_bar == six_bar_stephenson_2) then
         if (.not. any(is_missing(self%output_pin))) points_determined = points_determined - 2
      end if
      if (self%six_bar /= six_bar_stephenson .and. .not. is_missing(self%arm_length)) points_determined = points_determined - 1
   end function points_determined

   !> True if all six-bars through more than five points are wanted.
   pure logical function wants_every_six_bar(self)
      class(exact_group_t), intent(in) :: self

      wants_every_six_bar = self%kind == kind_function .and. self%six_bar /= six_bar_none
      if (.not. wants_every_six_bar .or. self%minimax) return
      if (allocated(self%function_name)) then
         wants_every_six_bar = self%precision_points > exact_in_table
      else
         wants_every_six_bar = size(self%phi) > exact_in_table
      end if
   end function wants_every_six_bar

   !> The group as the case has it.
   subroutine read_exact(self, group, about, findings)
      class(exact_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      associate (unused => about)
      end associate
      call read_exact_group(group, self, findings)
   end subroutine read_exact

   !> The group EXACT of a case; as it is by default where the case does not have it.
   pure function exact_of(set) result(exact)
      class(data_set_t), intent(in) :: set
      type(exact_group_t) :: exact
      integer :: k

      k = set%place_of('EXACT')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (exact_group_t)
         exact = group
      end select
   end function exact_of
end module psalm_exact_group
