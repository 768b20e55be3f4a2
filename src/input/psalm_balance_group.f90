!> The group BALANC: counterweights - on which links, within which limits, for what.
module psalm_balance_group
   use psalm_case_group, only: case_group_t, surroundings_t, place_visitor_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_link_place, only: read_places
   use psalm_place, only: place_t
   use psalm_rule, only: rule_t, a_flag, a_number, a_text, a_whole, a_word
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: balance_items
   public :: balance_group_t, balance_of
   public :: form_point, form_body, form_disc, order_mass, order_moment, order_torque, order_contact
   public :: filter_none, filter_passage, filter_any
   public :: measure_force, measure_moment, measure_torque, measure_mass, measure_names

   integer, parameter :: form_point = 1     !! point masses
   integer, parameter :: form_body = 2      !! any body within the reach: mass spread as is best
   integer, parameter :: form_disc = 3      !! discs of a thickness and density
   integer, parameter :: order_mass = 1, order_moment = 2, order_torque = 3, order_contact = 4 !! by which designs are ranked
   integer, parameter :: filter_none = 1, filter_passage = 2, filter_any = 3 !! designs left out: none, those that lose contact
   integer, parameter :: measure_force = 1, measure_moment = 2, measure_torque = 3, measure_mass = 4
   character(6), parameter :: measure_names(*) = [character(6) :: 'FORCE', 'MOMENT', 'TORQUE', 'MASS']

   !> Counterweights. Arrays of the links have the shape (NWEIGH), or (1) for all moving links where that is 0.
   type, extends(case_group_t) :: balance_group_t
      integer :: links = 0                     !! NWEIGH; 0: every moving link may carry a weight
      type(place_t), allocatable :: places(:)  !! WLINK, WLOOP, WDIST, WANG: the anchor
      real(wp), allocatable :: reach(:)        !! WREACH: greatest distance of a centre from the anchor, user's length
      real(wp), allocatable :: most(:)         !! WMOST: greatest mass, kg; 0: no limit
      real(wp), allocatable :: height(:)       !! WZ: of the weights' plane above that of the linkage, user's length
      logical :: raised = .false.              !! it was given
      real(wp) :: tilt_tolerance = 0.0_wp      !! TOLQ; 0: it does not count
      real(wp) :: most_tilt = 0.0_wp           !! MAXQ; 0: no limit
      logical :: boxed = .false.               !! the centres have limits of their own:
      real(wp), allocatable :: centre_low(:, :), centre_high(:, :) !! WXLOW, WYLOW; WXHIGH, WYHIGH, shape (2, links): from the
                                               !! anchor, along the link's line and across it, user's length
      logical :: started = .false.             !! the first start of the search is given:
      real(wp), allocatable :: start_centre(:, :) !! WXSTRT, WYSTRT, shape (2, links), as the limits
      real(wp), allocatable :: start_radius(:) !! WRSTRT, user's length
      integer :: form = form_point             !! WFORM
      real(wp) :: density = 7850.0_wp           !! WDENS, kg/m3
      real(wp), allocatable :: radius_low(:), radius_high(:)       !! WRLOW, WRHIGH: of discs, user's length
      real(wp), allocatable :: thickness_low(:), thickness_high(:) !! WTLOW, WTHIGH: of discs, user's length
      real(wp) :: tolerance(4) = 0.0_wp        !! TOLF, TOLM, TOLT, TOLW; 0: it does not count
      type(place_t), allocatable :: joints(:)  !! BLINK, BLOOP: joints whose loads count
      real(wp), allocatable :: joint_tolerance(:) !! BTOL, N; 0: it does not count
      real(wp), allocatable :: joint_most(:)   !! BMAX: greatest load at any position, N; 0: no limit
      real(wp), allocatable :: joint_wanted(:, :) !! BDESX, BDESY, shape (2, joints): desired load, N
      real(wp) :: most_load(3) = 0.0_wp        !! MAXF, MAXM, MAXT: greatest at any position; 0: no limit
      logical :: desired = .false.             !! values other than 0 are desired:
      real(wp), allocatable :: wanted(:, :)    !! DESFX, DESFY, DESMOM, DESDRV, shape (positions, 4)
      logical :: peaks = .false.               !! WCRIT: 'PEAK', else 'RMS'
      integer :: exact = 0                     !! IEXACT: force balance stays complete
      integer :: order = order_mass            !! WRANK
      integer :: filter = filter_none          !! WCLEAR: designs left out for what the joint of &CLEAR does
      integer :: listed = 10                   !! NLIST: designs listed at most
      integer :: explained = 0                 !! NCOND: designs whose conditions are listed
      logical :: dynamic = .false.             !! IDYNAM: can force and moment be balanced together?
      real(wp), allocatable :: budgets(:)      !! WBUDGT, shape (NBUDGT): kg
      integer :: front = 0                     !! NFRONT: points of a Pareto front
      integer :: front_of(2) = [measure_force, measure_mass] !! FRONT1, FRONT2
      integer :: starts = 32                   !! NWSTRT: of searches for discs and point masses
      integer :: seed = 1                      !! IWSEED
   contains
      procedure :: read => read_balance
      procedure :: visit_places => visit_balance
      procedure :: wants_optimum
      procedure :: counts_loads
   end type balance_group_t

   !> The items of the group.
   type(rule_t), parameter :: balance_items(*) = [ &
      rule_t('NWEIGH', a_whole, '', '', 'as many as WLINK or WNAME has', '[0,10000]', &
             'links that may carry a weight; 0: every moving link'), &
      rule_t('WLINK', a_whole, 'NWEIGH', '', '', '', &
             'the anchor of each link, from which weights are measured, a place as in &MASSES: an arc; with '// &
             'NWEIGH=0 the anchor is the pin nearest the frame'), &
      rule_t('WLOOP', a_whole, 'NWEIGH', '', '', '', &
             'the loop of that arc'), &
      rule_t('WNAME', a_text, 'NWEIGH', '', '', '', &
             'of a sketch, in place of both: the link, and the joint the place is counted from'), &
      rule_t('WDIST', a_number, 'NWEIGH', 'length', '0', '', &
             'distance from that end of the arc'), &
      rule_t('WANG', a_number, 'NWEIGH', 'degrees', '0', '', &
             'angle from the arc''s direction'), &
      rule_t('WREACH', a_number, '1 to NWEIGH', 'length', 'required', '[0,)', &
             'greatest distance of a weight''s centre from its anchor; 0: no weight on this link'), &
      rule_t('WZ', a_number, '1 to NWEIGH', 'length', '0', '', &
             'height of a weight''s centre above the plane of the linkage, as MZ of &MASSES'), &
      rule_t('WMOST', a_number, '1 to NWEIGH', 'kg', '0', '[0,)', &
             'greatest mass; 0: a hundred times the linkage''s mass'), &
      rule_t('WXLOW', a_number, '1 to NWEIGH', 'length', '-WREACH', '', &
             'least coordinate of a weight''s centre from its anchor along the link''s line, the arc of WLINK''s link or '// &
             'of a sketch the line between its first two joints; where it equals the greatest it is fixed'), &
      rule_t('WXHIGH', a_number, '1 to NWEIGH', 'length', 'WREACH', '', &
             'greatest coordinate along it'), &
      rule_t('WYLOW', a_number, '1 to NWEIGH', 'length', '-WREACH', '', &
             'least coordinate across it, a quarter turn anticlockwise from it'), &
      rule_t('WYHIGH', a_number, '1 to NWEIGH', 'length', 'WREACH', '', &
             'greatest coordinate across it'), &
      rule_t('WXSTRT', a_number, '1 to NWEIGH', 'length', '0', '', &
             'the first start of the search: the centre along the link''s line'), &
      rule_t('WYSTRT', a_number, '1 to NWEIGH', 'length', '0', '', &
             'the first start: the centre across it'), &
      rule_t('WRSTRT', a_number, '1 to NWEIGH', 'length', 'WRLOW', '[0,)', &
             'the first start: radius of a disc'), &
      rule_t('WFORM', a_word, '', '', 'POINT', 'POINT BODY DISC', &
             '''POINT'': point masses; ''BODY'': a body of any shape within the reach; ''DISC'': discs'), &
      rule_t('WDENS', a_number, '', 'kg/m3', '7850', '(0,)', &
             'density of discs'), &
      rule_t('WRLOW', a_number, '1 to NWEIGH', 'length', '0', '[0,)', &
             'least radius of discs; where it equals the greatest it is fixed'), &
      rule_t('WRHIGH', a_number, '1 to NWEIGH', 'length', '0', '[0,)', &
             'greatest radius of discs'), &
      rule_t('WTLOW', a_number, '1 to NWEIGH', 'length', '0', '[0,)', &
             'least thickness of discs'), &
      rule_t('WTHIGH', a_number, '1 to NWEIGH', 'length', '0', '[0,)', &
             'greatest thickness of discs'), &
      rule_t('TOLF', a_number, '', 'N', '0', '[0,)', &
             'tolerance of the shaking force; 0: it does not count'), &
      rule_t('TOLM', a_number, '', 'N m', '0', '[0,)', &
             'tolerance of the shaking moment'), &
      rule_t('TOLT', a_number, '', 'N m, N', '0', '[0,)', &
             'tolerance of drive torque or force'), &
      rule_t('TOLQ', a_number, '', 'N m', '0', '[0,)', &
             'tolerance of the moment out of the plane (MZ of &MASSES, WZ)'), &
      rule_t('TOLW', a_number, '', 'kg', '0', '[0,)', &
             'tolerance of the added mass; With WCRIT=''RMS'' the square of the added mass over TOLW is added '// &
             'once for each position, as those of forces are: an added mass of TOLW weighs as much as a force '// &
             'of TOLF at every position'), &
      rule_t('NBJNT', a_whole, '', '', 'as many as the longest item has', '[0,10000]', &
             'joints whose loads count'), &
      rule_t('BLINK', a_whole, 'NBJNT', '', '', '', &
             'the joint at the finish of this arc; negative: at its start'), &
      rule_t('BLOOP', a_whole, 'NBJNT', '', '', '', &
             'the loop of that arc'), &
      rule_t('BNAME', a_text, 'NBJNT', '', '', '', &
             'of a sketch, in place of both: the joint'), &
      rule_t('BTOL', a_number, 'NBJNT', 'N', '0', '[0,)', &
             'tolerance of the joint''s load; 0: it does not count, but has a limit BMAX', &
             'a tolerance in newtons is expected'), &
      rule_t('BMAX', a_number, 'NBJNT', 'N', '0', '[0,)', &
             'greatest load of the joint at any position; 0: no limit'), &
      rule_t('BDESX', a_number, 'NBJNT', 'N', '0', '', &
             'desired load of the joint, x as kalm lists it; of a slide the force across it'), &
      rule_t('BDESY', a_number, 'NBJNT', 'N', '0', '', &
             'desired load of the joint, y'), &
      rule_t('MAXF', a_number, '', 'N', '0', '[0,)', &
             'greatest shaking force at any position; 0: no limit'), &
      rule_t('MAXM', a_number, '', 'N m', '0', '[0,)', &
             'greatest shaking moment at any position; 0: no limit'), &
      rule_t('MAXT', a_number, '', 'N m, N', '0', '[0,)', &
             'greatest drive torque or force at any position; 0: no limit'), &
      rule_t('MAXQ', a_number, '', 'N m', '0', '[0,)', &
             'greatest moment out of the plane at any position; 0: no limit'), &
      rule_t('DESFX', a_number, 'n', 'N', '0', '', &
             'desired shaking force, x: one value, or one for each position; the composite is of the differences from it'), &
      rule_t('DESFY', a_number, 'n', 'N', '0', '', &
             'desired shaking force, y'), &
      rule_t('DESMOM', a_number, 'n', 'N m', '0', '', &
             'desired shaking moment'), &
      rule_t('DESDRV', a_number, 'n', 'N m, N', '0', '', &
             'desired drive torque or force'), &
      rule_t('WCRIT', a_word, '', '', 'RMS', 'RMS PEAK', &
             '''RMS'': the sum of the squares of all values over their tolerances is made least; ''PEAK'': the '// &
             'greatest of them'), &
      rule_t('IEXACT', a_flag, '', '', '0', '', &
             '1: the shaking force stays completely balanced'), &
      rule_t('WRANK', a_word, '', '', 'MASS', 'MASS MOMENT TORQUE CONTACT', &
             'what designs are ranked by; ''CONTACT'': how far the joint of &CLEAR is from a loss in the passage'), &
      rule_t('WCLEAR', a_word, '', '', 'LIST', 'LIST PASSAGE ANY', &
             'with &CLEAR: ''LIST'' lists what becomes of contact in that joint; ''PASSAGE'' leaves out designs that '// &
             'lose it in the passage, ''ANY'' those that lose it at all'), &
      rule_t('NLIST', a_whole, '', '', '10', '[1,10000]', &
             'designs that are listed'), &
      rule_t('NCOND', a_whole, '', '', '0', '[0,10000]', &
             'so many of the designs are listed with the conditions that their weights satisfy: mass times distance and angle, '// &
             'term by term'), &
      rule_t('IDYNAM', a_flag, '', '', '0', '', &
             '1: can shaking force and moment be balanced together: the least moment that is left when the force is balanced '// &
             'by bodies within the limits'), &
      rule_t('NBUDGT', a_whole, '', '', 'as many as WBUDGT has', '[0,1000]', &
             'number of added masses for each of which the least shaking force is found'), &
      rule_t('WBUDGT', a_number, 'NBUDGT', 'kg', '', '[0,)', &
             'these masses', &
             'a mass is not negative'), &
      rule_t('NFRONT', a_whole, '', '', '0', '[0,1000]', &
             'points of a front of two criteria'), &
      rule_t('FRONT1', a_word, '', '', 'FORCE', 'FORCE MOMENT TORQUE MASS', &
             'the first criterion of the front'), &
      rule_t('FRONT2', a_word, '', '', 'MASS', 'FORCE MOMENT TORQUE MASS', &
             'the second criterion of the front'), &
      rule_t('NWSTRT', a_whole, '', '', '32', '[1,10000]', &
             'starts of the search for discs, and for points where their inertia counts'), &
      rule_t('IWSEED', a_whole, '', '', '1', '[1,)', &
             'seed of the starts')]

contains

   !> True if a composite, or the added mass within limits of loads, is to be made least.
   pure logical function wants_optimum(self)
      class(balance_group_t), intent(in) :: self

      wants_optimum = any(self%tolerance > 0.0_wp) .or. size(self%joints) > 0 .or. any(self%most_load > 0.0_wp) .or. &
                      self%tilt_tolerance > 0.0_wp .or. self%most_tilt > 0.0_wp
   end function wants_optimum

   !> True if something counts in the composite; otherwise loads have limits only, and the added mass is made least.
   pure logical function counts_loads(self)
      class(balance_group_t), intent(in) :: self

      counts_loads = any(self%tolerance > 0.0_wp) .or. any(self%joint_tolerance > 0.0_wp) .or. self%tilt_tolerance > 0.0_wp
   end function counts_loads

   !> Read the group. Errors: arcs that are not there, numbers out of range, limits that leave no room.
   subroutine read_balance_group(group, ilink, positions, sketch, balance, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)          !! ILINK, shape (maxarc, nloop)
      integer, intent(in) :: positions            !! of the case
      type(sketch_t), intent(in) :: sketch        !! its names stand in place of arcs and loops
      type(balance_group_t), intent(inout) :: balance
      type(diagnostics_t), intent(inout) :: findings
      integer, parameter :: criterion_peak = 2   !! among the words of WCRIT
      integer :: n, joints, budgets, criterion

      balance%given = group%line > 0
      call group%follow(balance_items)
      call take_count(group, 'NWEIGH', n, findings)
      balance%links = n
      allocate (balance%places(n))
      call read_places(group, 'W', ilink, balance%places, findings, sketch=sketch)
      n = max(n, 1)
      allocate (balance%reach(n), balance%most(n), balance%radius_low(n), balance%radius_high(n), balance%thickness_low(n), &
                balance%thickness_high(n), source=0.0_wp)
      call take(group, 'WREACH', balance%reach, findings, repeated=.true.)
      call take(group, 'WMOST', balance%most, findings, repeated=.true.)
      allocate (balance%height(n), source=0.0_wp)
      call take(group, 'WZ', balance%height, findings, repeated=.true.)
      balance%raised = group%given('WZ')
      call take(group, 'TOLQ', balance%tilt_tolerance, findings)
      call take(group, 'MAXQ', balance%most_tilt, findings)
      call take(group, 'WRLOW', balance%radius_low, findings, repeated=.true.)
      call take(group, 'WRHIGH', balance%radius_high, findings, repeated=.true.)
      call take(group, 'WTLOW', balance%thickness_low, findings, repeated=.true.)
      call take(group, 'WTHIGH', balance%thickness_high, findings, repeated=.true.)
      call read_centres(n)
      call take(group, 'WFORM', balance%form, findings)
      call take(group, 'WDENS', balance%density, findings)
      call take(group, 'TOLF', balance%tolerance(measure_force), findings)
      call take(group, 'TOLM', balance%tolerance(measure_moment), findings)
      call take(group, 'TOLT', balance%tolerance(measure_torque), findings)
      call take(group, 'TOLW', balance%tolerance(measure_mass), findings)
      call take_count(group, 'NBJNT', joints, findings)
      allocate (balance%joints(joints))
      allocate (balance%joint_tolerance(joints), balance%joint_most(joints), balance%joint_wanted(2, joints), source=0.0_wp)
      call read_places(group, 'B', ilink, balance%joints, findings, ends_only=.true., sketch=sketch)
      call take(group, 'BTOL', balance%joint_tolerance, findings)
      call take(group, 'BMAX', balance%joint_most, findings)
      call take(group, 'BDESX', balance%joint_wanted(1, :), findings)
      call take(group, 'BDESY', balance%joint_wanted(2, :), findings)
      call take(group, 'MAXF', balance%most_load(measure_force), findings)
      call take(group, 'MAXM', balance%most_load(measure_moment), findings)
      call take(group, 'MAXT', balance%most_load(measure_torque), findings)
      call read_desired()
      call take(group, 'WCRIT', criterion, findings)
      balance%peaks = criterion == criterion_peak
      call take(group, 'IEXACT', balance%exact, findings)
      call take(group, 'WRANK', balance%order, findings)
      call take(group, 'WCLEAR', balance%filter, findings)
      call take(group, 'NLIST', balance%listed, findings)
      call take(group, 'NCOND', balance%explained, findings)
      call take(group, 'IDYNAM', balance%dynamic, findings)
      call take_count(group, 'NBUDGT', budgets, findings)
      allocate (balance%budgets(budgets), source=0.0_wp)
      call take(group, 'WBUDGT', balance%budgets, findings)
      call take(group, 'NFRONT', balance%front, findings)
      call take(group, 'FRONT1', balance%front_of(1), findings)
      call take(group, 'FRONT2', balance%front_of(2), findings)
      if (balance%front_of(1) == balance%front_of(2)) then
         call out_of(group, 'FRONT2', 'the two criteria of a front must differ', findings)
      end if
      call take(group, 'NWSTRT', balance%starts, findings)
      call take(group, 'IWSEED', balance%seed, findings)
      if (balance%given) call assess_limits()

   contains

      !> Limits of the centres, and where the search begins.
      subroutine read_centres(n)
         integer, intent(in) :: n                 !! entries
         character(*), parameter :: limits(*) = [character(6) :: 'WXLOW', 'WXHIGH', 'WYLOW', 'WYHIGH'], &
                                    starts(*) = [character(6) :: 'WXSTRT', 'WYSTRT', 'WRSTRT']
         integer :: k

         allocate (balance%centre_low(2, n), balance%centre_high(2, n), balance%start_centre(2, n), balance%start_radius(n), &
                   source=0.0_wp)
         balance%boxed = any([(group%given(limits(k)), k=1, size(limits))])
         do k = 1, 2
            balance%centre_low(k, :) = -balance%reach
            balance%centre_high(k, :) = balance%reach
         end do
         call take(group, 'WXLOW', balance%centre_low(1, :), findings, repeated=.true.)
         call take(group, 'WXHIGH', balance%centre_high(1, :), findings, repeated=.true.)
         call take(group, 'WYLOW', balance%centre_low(2, :), findings, repeated=.true.)
         call take(group, 'WYHIGH', balance%centre_high(2, :), findings, repeated=.true.)
         balance%started = any([(group%given(starts(k)), k=1, size(starts))])
         balance%start_radius = balance%radius_low
         call take(group, 'WXSTRT', balance%start_centre(1, :), findings, repeated=.true.)
         call take(group, 'WYSTRT', balance%start_centre(2, :), findings, repeated=.true.)
         call take(group, 'WRSTRT', balance%start_radius, findings, repeated=.true.)
      end subroutine read_centres

      !> Desired loads. Errors: numbers for other than one position or all of them; a load that does not count.
      subroutine read_desired()
         character(*), parameter :: items(*) = [character(6) :: 'DESFX', 'DESFY', 'DESMOM', 'DESDRV'], &
                                    tolerances(*) = ['TOLF', 'TOLF', 'TOLM', 'TOLT']
         integer, parameter :: of(*) = [measure_force, measure_force, measure_moment, measure_torque]
         integer :: k, last

         balance%desired = any([(group%given(trim(items(k))), k=1, size(items))])
         allocate (balance%wanted(merge(positions, 0, balance%desired), size(items)), source=0.0_wp)
         do k = 1, size(items)
            if (.not. group%given(trim(items(k)))) cycle
            call take(group, trim(items(k)), balance%wanted(:, k), findings, last=last, repeated=.true.)
            if (last /= 1 .and. last /= positions) then
               call out_of(group, trim(items(k)), 'one number, or one for each of the '//to_text(positions)// &
                           ' positions, is expected; found '//to_text(last), findings)
            else if (.not. balance%tolerance(of(k)) > 0.0_wp) then
               call out_of(group, trim(items(k)), 'what is desired of a load that does not count has no effect: give '// &
                           tolerances(k), findings)
            end if
         end do
         do k = 1, joints
            if (.not. (balance%joint_tolerance(k) > 0.0_wp .or. balance%joint_most(k) > 0.0_wp)) then
               call out_of(group, 'BTOL', 'entry '//to_text(k)//': the joint has neither a tolerance nor a greatest load BMAX', &
                           findings, k)
            else if (any(abs(balance%joint_wanted(:, k)) > 0.0_wp) .and. .not. balance%joint_tolerance(k) > 0.0_wp) then
               call out_of(group, trim(merge('BDESX', 'BDESY', abs(balance%joint_wanted(1, k)) > 0.0_wp)), 'entry '//to_text(k)// &
                           ': what is desired of a load that does not count has no effect: give BTOL', findings, k)
            end if
         end do
         balance%desired = balance%desired .or. any(abs(balance%joint_wanted) > 0.0_wp)
      end subroutine read_desired

      !> Limits that leave no room for a weight.
      subroutine assess_limits()
         integer :: k

         if (.not. group%given('WREACH')) return
         do k = 1, size(balance%reach)
            if (.not. balance%reach(k) > 0.0_wp) cycle       ! no weight on this link
            call assess_box(k, 1, 'WXLOW')
            call assess_box(k, 2, 'WYLOW')
            associate (low => balance%centre_low(:, k), high => balance%centre_high(:, k), reach => balance%reach(k))
               if (any(low > high)) cycle
               if (norm2(max(low, -high, 0.0_wp)) > reach) call out_of(group, 'WREACH', 'entry '//to_text(k)// &
                                       ': no point between WXLOW, WXHIGH, WYLOW and WYHIGH is within WREACH', findings, k)
               if (balance%started .and. norm2(balance%start_centre(:, k)) > reach) call out_of(group, &
                                  started_item(), 'entry '//to_text(k)// &
                                  ': the start is not within WREACH', findings, k)
               if (balance%started .and. any(balance%start_centre(:, k) < low .or. balance%start_centre(:, k) > high)) &
                  call out_of(group, started_item(), 'entry '//to_text(k)// &
                              ': the start is not between WXLOW, WXHIGH, WYLOW and WYHIGH', findings, k)
            end associate
         end do
         if (balance%started .and. .not. balance%wants_optimum()) &
            call out_of(group, started_item(), 'a start is for the least composite: give tolerances or limits of loads', findings)
         if (balance%started .and. balance%form == form_body) then
            call out_of(group, started_item(), 'bodies need no start: their problem is convex', findings)
         end if
         if (group%given('WRSTRT') .and. balance%form == form_point) then
            call out_of(group, 'WRSTRT', 'a point has no radius', findings)
         end if
         if (balance%form /= form_disc) return
         do k = 1, size(balance%reach)
            if (.not. balance%thickness_high(k) > 0.0_wp) then
               call out_of(group, 'WTHIGH', 'entry '//to_text(k)//': a disc needs a greatest thickness above 0', findings, k)
            else if (balance%thickness_low(k) > balance%thickness_high(k)) then
               call out_of(group, 'WTLOW', 'entry '//to_text(k)//': the least thickness is above the greatest', findings, k)
            end if
            if (.not. balance%radius_high(k) > 0.0_wp) then
               call out_of(group, 'WRHIGH', 'entry '//to_text(k)//': a disc needs a greatest radius above 0', findings, k)
            else if (balance%radius_low(k) > balance%radius_high(k)) then
               call out_of(group, 'WRLOW', 'entry '//to_text(k)//': the least radius is above the greatest', findings, k)
            else if (balance%start_radius(k) < balance%radius_low(k) .or. balance%start_radius(k) > balance%radius_high(k)) then
               call out_of(group, 'WRSTRT', 'entry '//to_text(k)//': the start is not between WRLOW and WRHIGH', findings, k)
            end if
         end do
      end subroutine assess_limits

      subroutine assess_box(k, axis, item)
         integer, intent(in) :: k, axis
         character(*), intent(in) :: item

         if (balance%centre_low(axis, k) > balance%centre_high(axis, k)) then
            call out_of(group, item, 'entry '//to_text(k)//': the least coordinate is above the greatest', findings, k)
         end if
      end subroutine assess_box

      !> The first item of a start that is given.
      function started_item() result(item)
         character(:), allocatable :: item

         item = 'WRSTRT'
         if (group%given('WYSTRT')) item = 'WYSTRT'
         if (group%given('WXSTRT')) item = 'WXSTRT'
      end function started_item
   end subroutine read_balance_group

   !> The group as the case has it.
   subroutine read_balance(self, group, about, findings)
      class(balance_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_balance_group(group, about%ilink, about%positions, about%sketch, self, findings)
   end subroutine read_balance

   subroutine visit_balance(self, visitor)
      class(balance_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor
      integer :: k

      do k = 1, size(self%places)
         call visitor%place(self%places(k))
      end do
      do k = 1, size(self%joints)
         call visitor%joint(self%joints(k))
      end do
   end subroutine visit_balance

   !> The group BALANC of a case; as it is by default where the case does not have it.
   pure function balance_of(set) result(balance)
      class(data_set_t), intent(in) :: set
      type(balance_group_t) :: balance
      integer :: k

      k = set%place_of('BALANC')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (balance_group_t)
         balance = group
      end select
   end function balance_of
end module psalm_balance_group
