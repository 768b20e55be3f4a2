!> Counterweights of a case (group BALANC): complete force balance, least composites, fronts. Data in, results out.
module psalm_balance_study
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_balance_group, only: balance_group_t, balance_of, form_body, form_point, order_moment, order_torque, order_contact, &
                                  filter_none, filter_passage, filter_any, measure_force, measure_moment, measure_torque, &
                                  measure_mass
   use psalm_body_motion, only: body_motion_t, follow_bodies
   use psalm_body_points, only: locate_point
   use psalm_clearance_group, only: clearance_of
   use psalm_clearance_study, only: margins_t, find_margins
   use psalm_counterweights, only: weight_region_t, criterion_t, design_t, least_composite, composite_of
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t, motion_t
   use psalm_force_analysis, only: force_table_t, analyse_forces, loads_of_unit_masses, column_of_joint, column_drive, &
                                   column_fx, column_fy, column_moment
   use psalm_force_balance, only: force_balance_t, weights_t, prepare_balance, find_sets, least_weights, rank_of, unspanned, &
                                  conditions_t, find_conditions
   use psalm_force_model, only: force_model_t, make_force_model, vertices_of, joint_at, mass_parameters, parameter_mass, &
                                parameter_mx, parameter_my
   use psalm_kinds, only: wp, half_turn
   use psalm_kinetostatics, only: source_inertia, source_weight
   use psalm_linear_loads, only: channel_t, measure_t, measure_of, about_anchor, parameters_of_weight, weight_mass, weight_px, &
                                 weight_py, weight_inertia
   use psalm_locations, only: location_of_place, location_t, place_right
   use psalm_mechanism, only: mechanism_t, body_frame, joint_gear, joint_prismatic, at_start
   use psalm_pin_order, only: pin_order_t, order_by_pins
   use psalm_sort, only: ascending
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t, is_to_end
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: balance_study_t, outcome_t, assess_balance, find_balance
   public :: channel_force, channel_moment, channel_torque
   public :: within_half_turn

   integer, parameter :: channel_force = 1, channel_moment = 2, channel_torque = 3, first_joint_channel = 4
   integer, parameter :: fewest_positions = 36     !! fewer do not tell the rank of a motion
   integer, parameter :: positions_for_rank = 72   !! taken then, at even steps
   integer, parameter :: most_sets = 100000        !! minimal sets that are counted
   real(wp), parameter :: balanced = 1.0e-9_wp     !! part of the imbalance that is rounding
   real(wp), parameter :: rounding_of_angles = 1.0e-10_wp !! degrees
   real(wp), parameter :: lightest_shown = 1.0e-9_wp !! masses of the linkage: a lighter weight is none

   real(wp), parameter :: steady_part = 1.0e-6_wp  !! of the moment before: less is none

   !> A weight as it is to be made.
   type :: weight_t
      integer :: body = 0
      character(:), allocatable :: link            !! name
      real(wp) :: mass = 0.0_wp                    !! kg
      real(wp) :: distance = 0.0_wp, angle = 0.0_wp !! of its centre from the anchor, user's length, degrees from the link's line
      real(wp) :: from_end = 0.0_wp, angle_end = 0.0_wp !! the same from where that line begins
      real(wp) :: inertia = 0.0_wp                 !! about its centre, kg m2
      real(wp) :: place(2) = 0.0_wp                !! of its centre from the reference of its link, m
      real(wp) :: radius = 0.0_wp, thickness = 0.0_wp !! of a disc, user's length
      real(wp) :: height = 0.0_wp                  !! above the plane of the linkage, user's length
   end type weight_t

   !> Weights and what they do.
   type :: outcome_t
      type(weight_t), allocatable :: weights(:)
      type(measure_t), allocatable :: loads(:)     !! by channel
      real(wp) :: total = 0.0_wp                   !! kg
      real(wp) :: bound = 0.0_wp                   !! no weights on these links are lighter; of a composite: no composite is less
      real(wp) :: gap = 0.0_wp, residual = 0.0_wp
      integer, allocatable :: bare_links(:)        !! bodies without a weight that the set leaves out
      type(conditions_t), allocatable :: conditions !! of the set, where they are wanted
      type(margins_t) :: contact                   !! of the joint of &CLEAR
   contains
      procedure :: add_to
   end type outcome_t

   !> A point of a front.
   type :: front_point_t
      real(wp) :: first = 0.0_wp, second = 0.0_wp  !! RMS of the two criteria, or mass
      real(wp) :: bound = 0.0_wp                   !! of the first one
      real(wp) :: total = 0.0_wp                   !! kg
   end type front_point_t

   type :: balance_study_t
      integer :: failure = 0                       !! position that is not known; 0: none
      logical :: stopped = .false.                 !! the host asked for the end: the rest is not there
      character(:), allocatable :: names(:)        !! of the bodies, the frame first
      integer, allocatable :: adrift(:)            !! bodies that do not hang on the frame by pins
      integer, allocatable :: out_of_reach(:)      !! bodies that weights on the links allowed cannot balance
      integer, allocatable :: allowed(:)           !! bodies that may carry a weight
      ! the line of a link: its own arc; of a sketch the line from its first to its second joint
      real(wp), allocatable :: line_from(:, :)     !! shape (2, bodies): where it begins, from the reference, axes of the body, m
      real(wp), allocatable :: line_angle(:)       !! by body: its direction in the axes of the body, degrees
      logical :: feasible = .false.                !! complete balance is possible
      logical :: already = .false.                 !! without any weight
      real(wp) :: left = 0.0_wp                    !! part of the imbalance that no weights on them can balance
      integer :: number = 0                        !! least number of weights
      integer :: by_rule = 0                       !! 2*links - joints
      integer, allocatable :: sets(:, :)           !! shape (number, sets): bodies
      logical :: all_sets = .true.
      integer :: out_of_limits = 0                 !! sets for which the limits leave no weights
      logical :: has_clearance = .false.           !! a joint has clearance (&CLEAR):
      type(margins_t) :: contact                   !! of it without weights
      integer :: filtered = 0                      !! designs that are left out because it loses contact
      logical :: optimum_loses = .false.           !! it loses contact with the weights of the least composite, against WCLEAR
      type(outcome_t), allocatable :: designs(:)   !! of the sets, best first; as many as are listed
      type(outcome_t), allocatable :: lightest     !! on all links allowed
      type(channel_t), allocatable :: channels(:)
      type(measure_t), allocatable :: before(:)    !! by channel
      real(wp) :: mass = 0.0_wp                    !! of the moving links, kg
      type(outcome_t), allocatable :: optimum      !! of the composite
      type(design_t), allocatable :: found         !! how it was found
      integer, allocatable :: limited(:)           !! channels with a greatest amount at every position; not allocated: none
      real(wp), allocatable :: limit(:)            !! this: N, N m
      real(wp) :: composite = 0.0_wp               !! before
      type(front_point_t), allocatable :: budgets(:) !! least force for a mass
      type(front_point_t), allocatable :: front(:)
      logical :: sliding = .false.                 !! the drive is a force
      logical :: tilts = .false.                   !! there are heights: the last channel is the moment out of the plane
      real(wp), allocatable :: height(:)           !! by body: of a weight, m
      integer, allocatable :: order(:)             !! by body: pins between it and the frame, 1 for links on the frame; 0: none
      type(outcome_t), allocatable :: steady       !! least shaking moment with the force balanced, where it is wanted
      real(wp) :: steady_bound = 0.0_wp            !! RMS: with the force balanced no weights within the limits have less, N m
      logical :: steady_wanted = .false.           !! IDYNAM
   contains
      procedure :: take_weights
      procedure :: is_steady
      procedure :: chosen_outcome
   end type balance_study_t

contains

   !> Find what is wrong with the group before any work is done. Errors: weights on the frame or on the foot of a slide, two
   !> entries on one link, joints that are not there, friction, contact to be assessed without a joint with clearance.
   subroutine assess_balance(set, mechanism, dimensions, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(diagnostics_t), intent(inout) :: findings
      type(balance_group_t) :: group
      type(diagnostics_t) :: unused
      type(force_model_t) :: model
      type(location_t) :: location
      character(*), parameter :: without = 'no joint has clearance: give &CLEAR'
      character(*), parameter :: in_plane = 'all masses are in the plane of the linkage: give heights, MZ of &MASSES or WZ'
      integer, allocatable :: taken(:)
      integer :: k, state

      group = balance_of(set)
      if (.not. set%gives('CLEAR')) then
         if (group%order == order_contact) call set%origins%error(findings, 'BALANC', 'WRANK', without)
         if (group%filter /= filter_none) call set%origins%error(findings, 'BALANC', 'WCLEAR', without)
      end if
      call make_force_model(set, mechanism, dimensions, model, unused)
      if (unused%failed()) return                  ! reported elsewhere
      if (.not. (set%masses%has_heights .or. group%raised)) then
         if (group%tilt_tolerance > 0.0_wp) call set%origins%error(findings, 'BALANC', 'TOLQ', in_plane)
         if (group%most_tilt > 0.0_wp) call set%origins%error(findings, 'BALANC', 'MAXQ', in_plane)
      end if
      allocate (taken(size(group%places)), source=0)
      do k = 1, size(group%places)
         call location_of_place(mechanism, dimensions, model%reference, group%places(k), location, state)
         if (state /= place_right) then
            call refuse('WLINK', k, 'the anchor is no point of the link; name another end or arc of it')
         else if (location%body == body_frame) then
            call refuse('WLINK', k, 'a weight on the frame balances nothing')
         else if (any(taken == location%body)) then
            call refuse('WLINK', k, 'there is an entry for '//mechanism%bodies(location%body)%name//' already')
         end if
         taken(k) = location%body
      end do
      do k = 1, size(group%joints)
         associate (joint => joint_at(mechanism, group%joints(k)))
            if (joint == 0) then
               call refuse('BLINK', k, 'there is no joint at this end of the arc')
            else if (mechanism%joints(joint)%kind == joint_prismatic .and. abs(group%joint_wanted(2, k)) > 0.0_wp) then
               call refuse('BDESY', k, 'of a slide only the force across it counts, BDESX')
            end if
         end associate
      end do
      if (size(model%friction) > 0) then
         call set%origins%error(findings, 'FRICTN', '', 'loads with friction are not linear in the masses: leave &FRICTN out')
      end if

   contains

      subroutine refuse(item, entry, text)
         character(*), intent(in) :: item, text
         integer, intent(in) :: entry

         call set%origins%error(findings, 'BALANC', item, 'entry '//to_text(entry)//': '//text, entry)
      end subroutine refuse
   end subroutine assess_balance

   !> Force and moment can be balanced together.
   pure logical function is_steady(self)
      class(balance_study_t), intent(in) :: self

      is_steady = allocated(self%steady)
      if (is_steady) is_steady = self%steady%loads(channel_moment)%rms <= steady_part*self%before(channel_moment)%rms
   end function is_steady

   !> The weights that device 7 gets: those of the composite, else those of the first design.
   function chosen_outcome(self) result(outcome)
      class(balance_study_t), intent(in) :: self
      type(outcome_t) :: outcome

      allocate (outcome%weights(0))
      if (allocated(self%optimum)) then
         outcome = self%optimum
      else if (allocated(self%designs)) then
         if (size(self%designs) > 0) outcome = self%designs(1)
      end if
   end function chosen_outcome

   !> These weights as masses, first moments and moments of inertia about the references, added. Shape: (4, bodies).
   subroutine take_weights(self, masses)
      class(balance_study_t), intent(in) :: self
      real(wp), intent(inout) :: masses(:, :)
      type(outcome_t) :: outcome

      outcome = self%chosen_outcome()
      call outcome%add_to(masses)
   end subroutine take_weights

   !> The weights as masses, first moments and moments of inertia about the references, added. Shape: (4, bodies).
   pure subroutine add_to(self, masses)
      class(outcome_t), intent(in) :: self
      real(wp), intent(inout) :: masses(:, :)
      integer :: k

      do k = 1, size(self%weights)
         associate (weight => self%weights(k))
            masses(:, weight%body) = masses(:, weight%body) + &
                                     [weight%mass, weight%mass*weight%place, weight%inertia + weight%mass*sum(weight%place**2)]
         end associate
      end do
   end subroutine add_to

   !> What becomes of contact in the joint of &CLEAR with some weights.
   subroutine assess_contact(set, problem, dimensions, bodies, outcome)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: bodies
      type(outcome_t), intent(inout) :: outcome
      real(wp) :: added(mass_parameters, bodies)

      added = 0.0_wp
      call outcome%add_to(added)
      call find_margins(set, clearance_of(set), problem, problem%mechanism, dimensions, added, outcome%contact)
   end subroutine assess_contact

   !> Everything the group asks for, of a case that `assess_balance` found no fault with.
   subroutine find_balance(set, given, dimensions, study, stop)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(balance_study_t), intent(out) :: study
      type(stop_t), intent(in), optional :: stop    !! asked before each design
      type(balance_group_t) :: group
      class(problem_t), allocatable :: problem      ! large: it would fill a small stack
      type(force_model_t) :: model
      type(motion_t) :: motion
      type(force_table_t) :: table
      type(diagnostics_t) :: unused
      type(pin_order_t) :: pins
      type(force_balance_t) :: balance
      type(weight_region_t), allocatable :: regions(:)
      real(wp), allocatable :: anchor(:, :), none(:, :)
      type(outcome_t) :: bare
      integer :: k, b

      group = balance_of(set)
      allocate (study%budgets(0))
      allocate (problem, source=given)
      call make_force_model(set, problem%mechanism, dimensions, model, unused)
      call problem%want_derivatives(.true., vertices_of(problem%mechanism))
      call problem%analyse(dimensions, motion)
      call analyse_forces(problem, model, set%pace(), set%change_of_pace(), motion%closed, motion%input, table)
      study%failure = findloc([(table%known(k), k=1, size(motion%input))], .false., dim=1)
      study%sliding = problem%mechanism%sliding_input
      study%tilts = set%masses%has_heights .or. group%raised
      call name_bodies(problem%mechanism, study)
      call order_by_pins(problem%mechanism, pins)
      study%adrift = pack([(b, b=1, size(pins%adrift))], pins%adrift)
      study%order = pins%order
      if (study%failure > 0) return
      call place_anchors(set, group, problem%mechanism, dimensions, model, pins, anchor, regions, study)
      study%mass = sum(model%inertia(parameter_mass, :))
      call make_channels(set, problem, model, motion, table, anchor, study)
      allocate (none(parameters_of_weight, size(model%reference)), source=0.0_wp)
      allocate (study%before(size(study%channels)))
      do k = 1, size(study%before)     ! one by one: a constructor would keep their memory (gfortran 12)
         study%before(k) = measure_of(study%channels(k), none)
      end do
      call make_balance(problem, dimensions, model, anchor, balance)
      study%has_clearance = set%gives('CLEAR')
      if (study%has_clearance) then
         allocate (bare%weights(0))
         call assess_contact(set, problem, dimensions, size(model%reference), bare)
         study%contact = bare%contact
      end if
      call balance_completely(set, problem, dimensions, group, model, anchor, balance, regions, pins, study, stop)
      if (study%stopped .or. size(regions) == 0) return
      study%steady_wanted = group%dynamic
      if (study%steady_wanted .and. study%feasible) call balance_moment(group, model, anchor, balance, regions, study)
      if (group%wants_optimum()) call find_optimum(group, problem%mechanism, model, anchor, balance, regions, study)
      if (study%has_clearance .and. allocated(study%optimum)) then
         call assess_contact(set, problem, dimensions, size(model%reference), study%optimum)
         study%optimum_loses = loses(group, study%optimum%contact)
      end if
      call spend_budgets(group, balance, regions, study, stop)
      if (study%stopped .or. group%front == 0) return
      call find_front(group, balance, regions, study, stop)
   end subroutine find_balance

   !> True if the joint with clearance loses contact as WCLEAR counts.
   pure logical function loses(group, contact)
      type(balance_group_t), intent(in) :: group
      type(margins_t), intent(in) :: contact

      select case (group%filter)
      case (filter_passage)
         loses = .not. contact%known .or. contact%lost(1) > 0
      case (filter_any)
         loses = .not. contact%known .or. contact%lost(2) > 0
      case default
         loses = .false.
      end select
   end function loses

   subroutine name_bodies(mechanism, study)
      type(mechanism_t), intent(in) :: mechanism
      type(balance_study_t), intent(inout) :: study
      integer :: b, longest

      longest = 0
      do b = 1, size(mechanism%bodies)
         longest = max(longest, len(mechanism%bodies(b)%name))
      end do
      allocate (character(longest) :: study%names(size(mechanism%bodies)))
      do b = 1, size(mechanism%bodies)
         study%names(b) = mechanism%bodies(b)%name
      end do
   end subroutine name_bodies

   !> Anchors of all bodies - the user's, else the pin nearest the frame - and region for weights. A link without reach has none.
   subroutine place_anchors(set, group, mechanism, dimensions, model, pins, anchor, regions, study)
      type(data_set_t), intent(in) :: set
      type(balance_group_t), intent(in) :: group
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(pin_order_t), intent(in) :: pins
      real(wp), allocatable, intent(out) :: anchor(:, :) !! shape (2, bodies): from the reference, axes of the body, m
      type(weight_region_t), allocatable, intent(out) :: regions(:)
      type(balance_study_t), intent(inout) :: study
      type(location_t) :: location
      integer :: b, k, state, next

      call find_lines(set, mechanism, dimensions, model, study)
      allocate (study%height(size(model%reference)), source=0.0_wp)
      allocate (anchor(2, size(model%reference)), source=0.0_wp)
      do b = body_frame + 1, size(model%reference)
         if (pins%anchor(b) == 0) cycle
         call locate_point(mechanism, dimensions, b, model%reference(b), pins%anchor(b), anchor(:, b))
         anchor(:, b) = anchor(:, b)*model%metre
      end do
      if (group%links == 0) then
         allocate (regions(size(model%reference) - 1))
         do b = body_frame + 1, size(model%reference)
            regions(b - 1) = region_of(b, 1)
         end do
         ! nearest the frame first: where links can stand for one another, short chains make light weights
         do k = 2, size(regions)
            do next = k, 2, -1
               if (pins%order(regions(next)%link) >= pins%order(regions(next - 1)%link)) exit
               regions([next - 1, next]) = regions([next, next - 1])
            end do
         end do
      else
         allocate (regions(group%links))
         do k = 1, group%links
            call location_of_place(mechanism, dimensions, model%reference, group%places(k), location, state)
            anchor(:, location%body) = location%at*model%metre
            regions(k) = region_of(location%body, k)
         end do
      end if
      regions = pack(regions, regions%reach > 0.0_wp)
      study%allowed = regions%link

   contains

      type(weight_region_t) function region_of(body, entry) result(region)
         integer, intent(in) :: body, entry

         region%link = body
         study%height(body) = group%height(entry)*model%metre
         region%reach = group%reach(entry)*model%metre
         region%most = group%most(entry)
         region%radius = [group%radius_low(entry), group%radius_high(entry)]*model%metre
         region%thickness = [group%thickness_low(entry), group%thickness_high(entry)]*model%metre
         region%boxed = group%boxed
         call unit_vector(study%line_angle(body), region%axis(1), region%axis(2))
         region%low = group%centre_low(:, entry)*model%metre
         region%high = group%centre_high(:, entry)*model%metre
         region%start = [group%start_centre(:, entry), group%start_radius(entry)]*model%metre
      end function region_of
   end subroutine place_anchors

   !> The lines that angles of weights are counted from.
   subroutine find_lines(set, mechanism, dimensions, model, study)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(balance_study_t), intent(inout) :: study
      type(location_t) :: location
      integer :: link, state

      allocate (study%line_from(2, size(model%reference)), study%line_angle(size(model%reference)), source=0.0_wp)
      if (.not. allocated(set%traced)) return
      do link = 1, size(set%traced%link_places)
         call location_of_place(mechanism, dimensions, model%reference, set%traced%link_places(link), location, state)
         if (state /= place_right .or. location%body == body_frame) cycle
         study%line_from(:, location%body) = location%at*model%metre
         study%line_angle(location%body) = degrees_of(location%along(1), location%along(2))
      end do
   end subroutine find_lines

   !> Shaking force and moment, drive and joints as they depend on weights. Shaking is of inertia alone; drive and joints feel
   !> weight, loads and springs too.
   subroutine make_channels(set, problem, model, motion, table, anchor, study)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      type(force_model_t), intent(in) :: model
      type(motion_t), intent(in) :: motion
      type(force_table_t), intent(in) :: table
      real(wp), intent(in) :: anchor(:, :)
      type(balance_study_t), intent(inout) :: study
      type(force_model_t) :: bare
      type(force_table_t) :: shaking
      real(wp), allocatable :: inertia(:, :, :, :), weight(:, :, :, :)
      integer :: j, c, columns(2)

      bare = model
      bare%gravity = 0.0_wp
      deallocate (bare%loads, bare%springs)
      allocate (bare%loads(0), bare%springs(0))
      call analyse_forces(problem, bare, set%pace(), set%change_of_pace(), motion%closed, motion%input, shaking)
      call loads_of_unit_masses(problem, model, set%pace(), set%change_of_pace(), inertia)
      allocate (study%channels(first_joint_channel - 1 + size(problem%mechanism%joints) + merge(1, 0, study%tilts)))
      if (study%tilts) study%channels(size(study%channels)) = tilting_channel()
      study%channels(channel_force) = channel_of('SHAKING FORCE', shaking%value, inertia, [column_fx, column_fy])
      study%channels(channel_moment) = channel_of('SHAKING MOMENT', moments(shaking%value), moments_of_masses(), [1])
      if (any(abs(model%gravity) > 0.0_wp)) then
         call loads_of_unit_masses(problem, model, set%pace(), set%change_of_pace(), weight, source_weight)
         inertia = inertia + weight
      end if
      study%channels(channel_torque) = channel_of(trim(merge('DRIVE FORCE ', 'DRIVE TORQUE', study%sliding)), table%value, &
                                                  inertia, [column_drive])
      do j = 1, size(problem%mechanism%joints)
         c = column_of_joint(j)
         columns = [c, c + 1]
         ! of a slide the force across it; the couple is no force
         study%channels(first_joint_channel - 1 + j) = &
            channel_of('JOINT '//problem%mechanism%joints(j)%name, table%value, inertia, &
                       columns(:merge(1, 2, problem%mechanism%joints(j)%kind == joint_prismatic)))
      end do

   contains

      type(channel_t) function channel_of(name, bare_values, unit_values, which) result(channel)
         character(*), intent(in) :: name
         real(wp), intent(in) :: bare_values(:, :), unit_values(:, :, :, :)
         integer, intent(in) :: which(:)
         integer :: body

         channel%name = name
         channel%bare = bare_values(:, which)
         allocate (channel%slope(size(bare_values, 1), size(which), parameters_of_weight, size(unit_values, 4)))
         do body = 1, size(unit_values, 4)
            channel%slope(:, :, :, body) = about_anchor(unit_values(:, which, :, body), anchor(:, body))
         end do
      end function channel_of

      !> The moment out of the plane, of inertia alone: about x and about y.
      type(channel_t) function tilting_channel() result(channel)
         real(wp) :: raised(size(inertia, 1), 2, size(inertia, 3))
         integer :: body, k

         channel%name = 'OUT-OF-PLANE MOMENT'
         allocate (channel%bare(size(inertia, 1), 2), source=0.0_wp)
         allocate (channel%slope(size(inertia, 1), 2, parameters_of_weight, size(inertia, 4)))
         do body = 1, size(inertia, 4)
            ! a force of an element at the height z has the moments -z F_y and z F_x
            raised(:, 1, :) = -inertia(:, column_fy, :, body)
            raised(:, 2, :) = inertia(:, column_fx, :, body)
            do k = 1, size(model%tilt, 1)
               channel%bare = channel%bare + model%tilt(k, body)*raised(:, :, k)
            end do
            channel%slope(:, :, :, body) = study%height(body)*about_anchor(raised, anchor(:, body))
         end do
      end function tilting_channel

      !> The shaking moment as kalm lists it: about MOMX, MOMY, with the drive's reaction or without.
      pure function moments(value) result(moment)
         real(wp), intent(in) :: value(:, :)
         real(wp) :: moment(size(value, 1), 1)

         associate (x => set%masses%about(1)*set%masses%metre, y => set%masses%about(2)*set%masses%metre)
            moment(:, 1) = value(:, column_moment) - (x*value(:, column_fy) - y*value(:, column_fx))
         end associate
         if (.not. set%masses%motor_on_frame .and. .not. study%sliding) moment(:, 1) = moment(:, 1) + value(:, column_drive)
      end function moments

      function moments_of_masses() result(moment)
         real(wp) :: moment(size(inertia, 1), 1, size(inertia, 3), size(inertia, 4))
         integer :: k, body

         do body = 1, size(inertia, 4)
            do k = 1, size(inertia, 3)
               moment(:, :, k, body) = moments(inertia(:, :, k, body))
            end do
         end do
      end function moments_of_masses
   end subroutine make_channels

   !> The motion of links and masses, at the positions of the case, or at more where these are too few.
   subroutine make_balance(problem, dimensions, model, anchor, balance)
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: anchor(:, :)
      type(force_balance_t), intent(out) :: balance
      class(problem_t), allocatable :: finer
      type(body_motion_t) :: bodies
      type(motion_t) :: motion
      complex(wp), allocatable :: turning(:, :), place(:, :), imbalance(:), parts(:, :)
      real(wp) :: low, high
      integer :: b, k

      allocate (finer, source=problem)
      if (finer%positions < fewest_positions) then
         low = minval(finer%delt)
         high = maxval(finer%delt)
         call finer%set_inputs([(low + (high - low)*real(k, wp)/real(positions_for_rank - 1, wp), k=0, positions_for_rank - 1)])
         call finer%want_derivatives(.true., vertices_of(finer%mechanism))
         call finer%analyse(dimensions, motion)
         if (.not. all(motion%closed)) deallocate (finer)
         if (.not. allocated(finer)) allocate (finer, source=problem)
      end if
      call follow_bodies(finer, model, bodies)
      allocate (turning(finer%positions, size(anchor, 2)), place(finer%positions, size(anchor, 2)))
      allocate (imbalance(finer%positions), source=(0.0_wp, 0.0_wp))
      allocate (parts(finer%positions, size(anchor, 2)))
      do b = 1, size(anchor, 2)
         turning(:, b) = cmplx(bodies%c(:, b), bodies%s(:, b), wp)
         place(:, b) = cmplx(bodies%x(:, b), bodies%y(:, b), wp)
         parts(:, b) = model%inertia(parameter_mass, b)*place(:, b) + &
                       cmplx(model%inertia(parameter_mx, b), model%inertia(parameter_my, b), wp)*turning(:, b)
         imbalance = imbalance + model%inertia(parameter_mass, b)*place(:, b) + &
                     cmplx(model%inertia(parameter_mx, b), model%inertia(parameter_my, b), wp)*turning(:, b)
         place(:, b) = place(:, b) + cmplx(anchor(1, b), anchor(2, b), wp)*turning(:, b)
      end do
      call prepare_balance(turning, place, imbalance, sum(model%inertia(parameter_mass, :)), balance, parts)
   end subroutine make_balance

   ! ---- complete balance --------------------------------------------------------------------------------------------

   subroutine balance_completely(set, problem, dimensions, group, model, anchor, balance, regions, pins, study, stop)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(balance_group_t), intent(in) :: group
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: anchor(:, :)
      type(force_balance_t), intent(in) :: balance
      type(weight_region_t), intent(in) :: regions(:)
      type(pin_order_t), intent(in) :: pins
      type(balance_study_t), intent(inout) :: study
      type(stop_t), intent(in), optional :: stop
      type(weights_t) :: weights
      type(outcome_t), allocatable :: designs(:)
      real(wp), allocatable :: key(:)
      integer, allocatable :: order(:), kept(:)
      integer :: k, count_found, links, b, rank
      logical :: valid

      links = size(model%reference) - 1
      study%by_rule = 2*links - count(problem%mechanism%joints%kind /= joint_gear)
      study%left = unspanned(balance, regions%link)
      study%already = .not. balance%swing > balanced*balance%mass*maxval([regions%reach, maxval(abs(anchor)), tiny(1.0_wp)])
      study%feasible = study%already .or. study%left <= balanced
      study%number = rank_of(balance, regions%link)
      allocate (study%sets(0, 0), study%designs(0), study%out_of_reach(0))
      if (.not. study%feasible) then
         do b = body_frame + 1, links + 1
            if (pins%adrift(b)) cycle
            rank = rank_of(balance, [regions%link, b])
            if (rank > study%number) study%out_of_reach = [study%out_of_reach, b]
         end do
         return
      end if
      if (study%number == 0) return
      call find_sets(balance, regions%link, most_sets, study%sets, study%all_sets)
      allocate (designs(size(study%sets, 2)))
      count_found = 0
      do k = 1, size(study%sets, 2)
         study%stopped = is_to_end(stop)
         if (study%stopped) return
         call find_least(study%sets(:, k))
         if (.not. weights%found) then
            study%out_of_limits = study%out_of_limits + 1
            cycle
         end if
         count_found = count_found + 1
         call make_outcome(weights, designs(count_found))
         designs(count_found)%bare_links = pack([(b, b=2, links + 1)], [(all(study%sets(:, k) /= b), b=2, links + 1)])
      end do
      allocate (key(count_found))
      do k = 1, count_found
         select case (group%order)
         case (order_moment)
            key(k) = designs(k)%loads(channel_moment)%rms
         case (order_torque)
            key(k) = designs(k)%loads(channel_torque)%rms
         case (order_contact)
            study%stopped = is_to_end(stop)
            if (study%stopped) return
            call assess_contact(set, problem, dimensions, links + 1, designs(k))
            key(k) = -designs(k)%contact%over(1)
            if (.not. designs(k)%contact%known) key(k) = huge(1.0_wp)
         case default
            key(k) = designs(k)%total
         end select
      end do
      order = ascending(key)
      allocate (kept(0))
      do k = 1, count_found
         if (size(kept) == group%listed) exit
         study%stopped = is_to_end(stop)
         if (study%stopped) return
         associate (design => designs(order(k)))
            if (study%has_clearance .and. .not. design%contact%known) then
               call assess_contact(set, problem, dimensions, links + 1, design)
            end if
            if (loses(group, design%contact)) then
               study%filtered = study%filtered + 1
               cycle
            end if
         end associate
         kept = [kept, order(k)]
      end do
      study%designs = designs(kept)
      do k = 1, min(group%explained, size(study%designs))
         allocate (study%designs(k)%conditions)
         call find_conditions(balance, pack([(b, b=2, links + 1)], &
                                            [(all(study%designs(k)%bare_links /= b), b=2, links + 1)]), &
                              study%designs(k)%conditions, valid)
         if (.not. valid) deallocate (study%designs(k)%conditions)
      end do
      call find_least(regions%link)
      if (.not. weights%found) return
      allocate (study%lightest)
      call make_outcome(weights, study%lightest)
      study%lightest%bare_links = pack([(b, b=2, links + 1)], [(all(study%lightest%weights%body /= b), b=2, links + 1)])
      if (study%has_clearance) call assess_contact(set, problem, dimensions, links + 1, study%lightest)

   contains

      !> True if a design is to be left out for what becomes of contact. What cannot be studied counts as a loss.
      !> The lightest weights on these bodies.
      subroutine find_least(bodies)
         integer, intent(in) :: bodies(:)
         type(weight_region_t) :: chosen(size(bodies))
         real(wp), dimension(2, size(bodies)) :: axis, low, high
         integer :: i

         do i = 1, size(bodies)
            chosen(i) = regions(findloc(regions%link, bodies(i), dim=1))
            axis(:, i) = chosen(i)%axis
            low(:, i) = chosen(i)%low
            high(:, i) = chosen(i)%high
         end do
         if (group%boxed) then
            call least_weights(balance, bodies, chosen%reach, chosen%most, weights, axis, low, high)
         else
            call least_weights(balance, bodies, chosen%reach, chosen%most, weights)
         end if
      end subroutine find_least

      !> Point masses on these links.
      subroutine make_outcome(weights, outcome)
         type(weights_t), intent(in) :: weights
         type(outcome_t), intent(out) :: outcome
         real(wp) :: added(parameters_of_weight, size(model%reference))
         integer :: i

         added = 0.0_wp
         do i = 1, size(weights%links)
            if (.not. weights%mass(i) > lightest_shown*balance%mass) cycle
            associate (of => added(:, weights%links(i)))
               of(weight_mass) = weights%mass(i)
               of(weight_px) = real(weights%moment(i), wp)
               of(weight_py) = aimag(weights%moment(i))
               of(weight_inertia) = (of(weight_px)**2 + of(weight_py)**2)/of(weight_mass)
            end associate
         end do
         call describe(model, anchor, study, added, outcome)
         outcome%bound = weights%bound
         outcome%gap = weights%gap
         outcome%residual = weights%residual
      end subroutine make_outcome
   end subroutine balance_completely

   !> Weights and loads of what is added.
   subroutine describe(model, anchor, study, added, outcome)
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: anchor(:, :), added(:, :)
      type(balance_study_t), intent(in) :: study
      type(outcome_t), intent(inout) :: outcome
      type(weight_t) :: weight
      real(wp) :: centre(2), place(2)
      integer :: b, k

      allocate (outcome%weights(0))
      do b = 1, size(added, 2)
         if (.not. added(weight_mass, b) > 0.0_wp) cycle
         weight%body = b
         weight%link = trim(study%names(b))
         weight%mass = added(weight_mass, b)
         weight%height = study%height(b)/model%metre
         centre = added(weight_px:weight_py, b)/weight%mass
         weight%inertia = max(0.0_wp, added(weight_inertia, b) - weight%mass*sum(centre**2))
         if (weight%inertia <= 1.0e-12_wp*added(weight_inertia, b)) weight%inertia = 0.0_wp
         weight%distance = hypotenuse(centre(1), centre(2))/model%metre
         weight%angle = 0.0_wp
         if (weight%distance > 0.0_wp) weight%angle = within_half_turn(degrees_of(centre(1), centre(2)) - study%line_angle(b))
         place = centre + anchor(:, b)
         weight%place = place
         place = place - study%line_from(:, b)
         weight%from_end = hypotenuse(place(1), place(2))/model%metre
         weight%angle_end = 0.0_wp
         if (weight%from_end > 0.0_wp) weight%angle_end = within_half_turn(degrees_of(place(1), place(2)) - study%line_angle(b))
         outcome%weights = [outcome%weights, weight]
      end do
      outcome%total = sum(outcome%weights%mass)
      allocate (outcome%loads(size(study%channels)))
      do k = 1, size(outcome%loads)
         outcome%loads(k) = measure_of(study%channels(k), added)
      end do
   end subroutine describe

   !> A direction within half a turn, without the rounding of one along the link.
   pure real(wp) function within_half_turn(angle) result(plain)
      real(wp), intent(in) :: angle

      plain = angle
      if (abs(plain) > half_turn) plain = plain - sign(2.0_wp*half_turn, plain)
      if (abs(plain) <= rounding_of_angles) plain = 0.0_wp
      if (abs(abs(plain) - half_turn) <= rounding_of_angles) plain = half_turn
   end function within_half_turn

   ! ---- composites --------------------------------------------------------------------------------------------------

   subroutine find_optimum(group, mechanism, model, anchor, balance, regions, study)
      type(balance_group_t), intent(in) :: group
      type(mechanism_t), intent(in) :: mechanism
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: anchor(:, :)
      type(force_balance_t), intent(in) :: balance
      type(weight_region_t), intent(in) :: regions(:)
      type(balance_study_t), intent(inout) :: study
      type(criterion_t) :: criterion
      real(wp) :: none(parameters_of_weight, size(model%reference))
      integer :: k, place

      criterion = criterion_of(group)
      do k = 1, measure_torque
         if (group%tolerance(k) > 0.0_wp) call count_in(k, group%tolerance(k))
         if (group%most_load(k) > 0.0_wp) call limit(k, group%most_load(k))
      end do
      if (group%tilt_tolerance > 0.0_wp) call count_in(size(study%channels), group%tilt_tolerance)
      if (group%most_tilt > 0.0_wp) call limit(size(study%channels), group%most_tilt)
      do k = 1, size(group%joints)
         associate (channel => first_joint_channel - 1 + joint_at(mechanism, group%joints(k)))
            if (group%joint_tolerance(k) > 0.0_wp) call count_in(channel, group%joint_tolerance(k))
            if (group%joint_most(k) > 0.0_wp) call limit(channel, group%joint_most(k))
         end associate
      end do
      criterion%mass_tolerance = group%tolerance(measure_mass)
      criterion%peaks = group%peaks
      criterion%begun = group%started
      if (group%desired) call take_wanted()
      if (.not. group%counts_loads()) then
         ! the added mass in kilograms is what is left to be made least
         criterion%mass_tolerance = 1.0_wp
         criterion%peaks = .true.
      end if
      criterion%exact = group%exact /= 0
      if (criterion%exact .and. .not. study%feasible) return
      none = 0.0_wp
      study%composite = composite_of(study%channels, criterion, none)
      allocate (study%found)
      call least_composite(study%channels, regions, criterion, balance, study%found)
      if (.not. study%found%found) return
      where (study%found%added(weight_mass, :) <= lightest_shown*balance%mass) study%found%added(weight_mass, :) = 0.0_wp
      do k = 1, size(study%found%added, 2)
         if (.not. study%found%added(weight_mass, k) > 0.0_wp) study%found%added(:, k) = 0.0_wp
      end do
      study%found%value = composite_of(study%channels, criterion, study%found%added)
      allocate (study%optimum)
      call describe(model, anchor, study, study%found%added, study%optimum)
      study%optimum%bound = study%found%bound
      study%optimum%gap = study%found%gap
      study%optimum%residual = study%found%residual
      do k = 1, size(study%optimum%weights)
         place = findloc(regions%link, study%optimum%weights(k)%body, dim=1)
         study%optimum%weights(k)%radius = study%found%radius(place)/model%metre
         study%optimum%weights(k)%thickness = study%found%thickness(place)/model%metre
      end do

   contains

      subroutine count_in(channel, tolerance)
         integer, intent(in) :: channel
         real(wp), intent(in) :: tolerance

         criterion%channels = [criterion%channels, channel]
         criterion%tolerance = [criterion%tolerance, tolerance]
      end subroutine count_in

      subroutine limit(channel, most)
         integer, intent(in) :: channel
         real(wp), intent(in) :: most

         criterion%capped = [criterion%capped, channel]
         criterion%cap = [criterion%cap, most]
         study%limited = criterion%capped
         study%limit = criterion%cap
      end subroutine limit

      !> Desired values of the loads that count.
      subroutine take_wanted()
         real(wp), allocatable :: value(:, :)
         integer :: i, joint

         allocate (criterion%wanted(size(criterion%channels)))
         do i = 1, size(criterion%channels)
            associate (channel => criterion%channels(i))
               value = 0.0_wp*study%channels(channel)%bare
               if (channel >= first_joint_channel) then
                  do joint = 1, size(group%joints)
                     if (first_joint_channel - 1 + joint_at(mechanism, group%joints(joint)) /= channel) cycle
                     value = spread(group%joint_wanted(:size(value, 2), joint), 1, size(value, 1))
                  end do
               else if (size(group%wanted) > 0) then
                  select case (channel)
                  case (channel_force)
                     value = group%wanted(:, 1:2)
                  case (channel_moment)
                     value = group%wanted(:, 3:3)
                  case default
                     value = group%wanted(:, 4:4)
                  end select
               end if
               criterion%wanted(i)%value = value
            end associate
         end do
      end subroutine take_wanted
   end subroutine find_optimum

   !> The least shaking moment that is left when the force is balanced completely, by bodies: a convex problem, whose bound says
   !> whether force and moment can be balanced together.
   subroutine balance_moment(group, model, anchor, balance, regions, study)
      type(balance_group_t), intent(in) :: group
      type(force_model_t), intent(in) :: model
      real(wp), intent(in) :: anchor(:, :)
      type(force_balance_t), intent(in) :: balance
      type(weight_region_t), intent(in) :: regions(:)
      type(balance_study_t), intent(inout) :: study
      type(criterion_t) :: criterion
      type(design_t) :: design

      criterion = criterion_of(group)
      criterion%form = form_body
      criterion%exact = .true.
      criterion%channels = [channel_moment]
      criterion%tolerance = [1.0_wp]
      call least_composite(study%channels, regions, criterion, balance, design)
      if (.not. design%found) return
      allocate (study%steady)
      call describe(model, anchor, study, design%added, study%steady)
      study%steady%gap = design%gap
      study%steady%residual = design%residual
      study%steady_bound = sqrt(max(0.0_wp, design%bound)/real(size(study%channels(channel_moment)%bare, 1), wp))
   end subroutine balance_moment

   !> An criterion without criteria.
   pure type(criterion_t) function criterion_of(group) result(criterion)
      type(balance_group_t), intent(in) :: group

      criterion%form = group%form
      criterion%density = group%density
      criterion%starts = group%starts
      criterion%seed = group%seed
      allocate (criterion%channels(0), criterion%tolerance(0), criterion%limited(0), criterion%limit(0), &
                   criterion%capped(0), criterion%cap(0))
   end function criterion_of

   !> The least shaking force for masses: what a mass buys.
   subroutine spend_budgets(group, balance, regions, study, stop)
      type(balance_group_t), intent(in) :: group
      type(force_balance_t), intent(in) :: balance
      type(weight_region_t), intent(in) :: regions(:)
      type(balance_study_t), intent(inout) :: study
      type(stop_t), intent(in), optional :: stop
      type(criterion_t) :: criterion
      type(design_t) :: design
      type(measure_t) :: measure
      integer :: k

      deallocate (study%budgets)
      allocate (study%budgets(size(group%budgets)))
      do k = 1, size(study%budgets)
         study%stopped = is_to_end(stop)
         if (study%stopped) return
         criterion = criterion_of(group)
         criterion%form = form_point
         criterion%channels = [channel_force]
         criterion%tolerance = [1.0_wp]
         criterion%budget = max(group%budgets(k), tiny(1.0_wp)**0.25_wp)
         call least_composite(study%channels, regions, criterion, balance, design)
         associate (point => study%budgets(k))
            measure = measure_of(study%channels(channel_force), design%added)
            point%first = measure%rms
            point%second = group%budgets(k)
            point%bound = sqrt(design%bound/real(2*size(study%channels(channel_force)%bare, 1), wp))
            point%total = design%total
            if (group%budgets(k) > 0.0_wp) cycle
            point%first = study%before(channel_force)%rms
            point%bound = point%first
            point%total = 0.0_wp
         end associate
      end do
   end subroutine spend_budgets

   !> Points of a front of two criteria, from the least of the first to the least of the second, at even steps of the second.
   !>
   !> Weights are bodies, so that every point is a global optimum.
   subroutine find_front(group, balance, regions, study, stop)
      type(balance_group_t), intent(in) :: group
      type(force_balance_t), intent(in) :: balance
      type(weight_region_t), intent(in) :: regions(:)
      type(balance_study_t), intent(inout) :: study
      type(stop_t), intent(in), optional :: stop
      type(front_point_t) :: point
      type(design_t) :: ends(2), design
      real(wp) :: low, high, limit
      integer :: k

      allocate (study%front(0))
      associate (first => group%front_of(1), second => group%front_of(2), points => group%front)
         call least_composite(study%channels, regions, criterion_at(first), balance, ends(1))
         call least_composite(study%channels, regions, criterion_at(second), balance, ends(2))
         if (.not. (ends(1)%found .and. ends(2)%found)) return
         high = amount(second, ends(1)%added)
         low = amount(second, ends(2)%added)
         do k = 1, points
            study%stopped = is_to_end(stop)
            if (study%stopped) return
            limit = high - (high - low)*real(k - 1, wp)/real(max(points - 1, 1), wp)
            design = ends(1)
            if (k > 1) call least_composite(study%channels, regions, criterion_at(first, second, max(limit, 1.0e-9_wp*high)), &
                                            balance, design)
            if (.not. design%found) cycle
            point%first = amount(first, design%added)
            point%second = amount(second, design%added)
            point%total = design%total
            point%bound = design%bound
            if (first /= measure_mass) point%bound = sqrt(design%bound/real(size(study%channels(first)%bare), wp))
            if (first == measure_mass) point%bound = sqrt(design%bound/real(size(study%channels(1)%bare, 1), wp))
            study%front = [study%front, point]
         end do
      end associate

   contains

      !> One criterion to be made least, another limited.
      type(criterion_t) function criterion_at(measure, limited, limit) result(criterion)
         integer, intent(in) :: measure
         integer, intent(in), optional :: limited
         real(wp), intent(in), optional :: limit

         criterion = criterion_of(group)
         criterion%form = form_body
         if (measure == measure_mass) then
            criterion%mass_tolerance = 1.0_wp
         else
            criterion%channels = [measure]
            criterion%tolerance = [1.0_wp]
         end if
         if (.not. present(limited)) return
         if (limited == measure_mass) then
            criterion%budget = limit
         else
            criterion%limited = [limited]
            criterion%limit = [limit]
         end if
      end function criterion_at

      real(wp) function amount(measure, added)
         integer, intent(in) :: measure
         real(wp), intent(in) :: added(:, :)
         type(measure_t) :: of

         if (measure == measure_mass) then
            amount = sum(added(weight_mass, :))
         else
            of = measure_of(study%channels(measure), added)
            amount = of%rms
         end if
      end function amount
   end subroutine find_front
end module psalm_balance_study
