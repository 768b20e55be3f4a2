!> ERROR finds the positions of the linkage at the prescribed inputs, the output there, and the objective.
!>
!> A `problem_t` is everything an analysis or a search works on: topology, plan, inputs, desired values and weights, and a
!> linkage to move. Source of motions and objective: Oldham (1977), chapter 5 and appendix B.
module psalm_error
   use psalm_angles, only: unit_vector
   use psalm_assur, only: violation_of, coincidence_of
   use psalm_data_set, only: data_set_t
   use psalm_dyad, only: dyad_violation_t, violation_none, violation_angle_small, violation_undetermined, violation_slides, &
                         violation_toggle, violation_angle_large
   use psalm_dyad_kind, only: form_of, form_t
   use psalm_kinds, only: wp, right_angle
   use psalm_equalities, only: compared_columns
   use psalm_linkage, only: linkage_t, padded
   use psalm_observable, only: observable_t
   use psalm_output_kind, only: output_kind_t, output_kind, motion_point, motion_angle
   use psalm_plan, only: plan_t, make_plan
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t
   use psalm_sketch, only: target_column_t
   use psalm_stop, only: stop_t, is_to_end
   use psalm_parameters, only: parameters_t
   use psalm_place, only: beside_t
   use psalm_shown_input, only: crank_angle_at, input_at, shows_crank
   implicit none (type, external)
   private
   public :: problem_t, motion_t, reach_t, violation_t, crossing_t, make_problem, new_problem, follows_drawing, inputs_of, &
             own_inputs_of, own_inputs_at, desired_of

   !> Consecutive positions at which one dyad violates one limit.
   type :: violation_t
      integer :: kind = violation_none
      integer :: loop = 0
      integer :: first = 0, last = 0   !! positions
      integer :: worst = 0             !! position of the largest amount
      real(wp) :: amount = 0.0_wp      !! length missing, or the transmission angle, degrees, at the worst position
   end type violation_t

   !> Two slides that have been parallel between a position and the next: the linkage cannot move from one to the other.
   type :: crossing_t
      integer :: loop = 0
      integer :: position = 0
   end type crossing_t

   !> How far a sketch goes from its drawing, forwards and backwards: as far as it was followed, or to where it ends.
   type :: reach_t
      logical :: known = .false.
      real(wp) :: start = 0.0_wp                   !! from here: the input of the drawing, if it closes there
      real(wp) :: followed(2) = 0.0_wp             !! so far it was to go; degrees or length
      real(wp) :: ends(2) = 0.0_wp                 !! so far it goes
   end type reach_t

   !> What the linkage does at a row of input positions.
   type :: motion_t
      logical, allocatable :: closed(:)            !! every loop that was solved closes
      logical, allocatable :: output_known(:)      !! every loop that the output depends on closes; of a sketch all
      logical, allocatable :: beyond(:)            !! of a sketch: the links can be put together, but the linkage does not come
                                                   !! there from the drawing without passing a dead point: not `closed`
      real(wp), allocatable :: input(:)            !! as shown (`psalm_shown_input`): degrees or length
      real(wp), allocatable :: crank(:)            !! angle of the crank from the x axis, degrees in a turn; not allocated: none is
                                                   !! shown beside the input
      real(wp), allocatable :: actual(:, :)        !! shape (positions, components): x and y, or angle, distance, length
      real(wp), allocatable :: error(:, :)         !! desired - actual; 0 without desired values
      real(wp) :: total = 0.0_wp                   !! objective over the closed positions
      ! only where derivatives of the output by the input are wanted; of angles in radians
      real(wp), allocatable :: rates(:, :, :)      !! shape (positions, components, orders): actual ones
      real(wp), allocatable :: rate_error(:, :, :) !! the same shape: desired - actual; 0 where none is wanted
      logical, allocatable :: has_rates(:)         !! it closes, and is not at a dead point
      real(wp), allocatable :: part(:)             !! shape (0:orders): of the objective, values and derivatives
      type(violation_t), allocatable :: violations(:)
      type(crossing_t), allocatable :: crossings(:)
   end type motion_t

   type :: problem_t
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters             !! dimensions that vary
      type(plan_t) :: plan
      logical, allocatable :: asked(:)             !! by loop: the output depends on it; of a sketch all
      type(dimensions_t) :: given                  !! the user's linkage
      type(linkage_t) :: linkage                   !! bound to the last dimensions evaluated
      type(linkage_t), allocatable :: linkages(:)      !! one more linkage for each further thread
      integer :: motion = motion_point
      logical :: every_loop = .false.              !! of a sketch: no loop is left out
      logical :: followed = .false.                !! of a sketch that is not searched: what it does not come to is not closed
      real(wp) :: tangle = 90.0_wp, toggle = 0.0_wp
      real(wp) :: spare = 0.0_wp                !! TOGGLE where it was given: then it is a criterion
      logical :: trmin_given = .false.             !! the limit was given as the least transmission angle
      real(wp) :: slide_angle = 90.0_wp            !! allowed deviation of the angle between two slides from 90 degrees
      real(wp), allocatable :: side(:)             !! by loop: +1 or -1, sign of the sine between two slides that is wanted
      integer :: positions = 0
      real(wp), allocatable :: delt(:)             !! shape (positions): degrees or length
      ! tables for whole blocks: the positions, padded with the last one
      real(wp), allocatable :: first(:), second(:) !! cosine and sine of DELT; sliding input: DELT twice
      real(wp), allocatable :: path(:)             !! DELT itself
      real(wp), allocatable :: more(:, :, :)       !! shape (positions, 3, drives after the first): increment, its cosine, its sine;
                                                   !! not allocated: there is one drive
      real(wp), allocatable :: own_delt(:, :)      !! shape (positions, drives after the first): of drives that are not geared
      logical, allocatable :: turned(:, :)         !! shape (positions, loops), whole blocks: the dyad is in its other assembly;
                                                   !! not allocated: nowhere
      logical :: desired = .false.                 !! there are desired values of the output
      logical :: blank = .false.                   !! there are those of a sketch's outputs alone: `wanted` has no weight
      real(wp), allocatable :: wanted(:, :)        !! shape (positions, components): desired, points in machine coordinates
      real(wp), allocatable :: toward_x(:), toward_y(:) !! unit vectors of desired angles
      real(wp), allocatable :: weight(:, :)        !! shape as `wanted`: weights, 0 for padding
      ! derivatives of the output by the input that are wanted; not allocated: none
      real(wp), allocatable :: rate_desired(:, :, :) !! shape (positions, components, orders): of angles in radians
      real(wp), allocatable :: rate_weight(:, :, :) !! the same shape: weights, 0 where none is wanted
      ! desired values of further outputs of a sketch, one number after the other; not allocated: none
      real(wp), allocatable :: target_values(:, :), target_weights(:, :) !! shape (positions, numbers)
      real(wp), allocatable :: partial(:)          !! shape (blocks): objective of each
      integer, allocatable :: offending(:)         !! shape (blocks): lowest loop not accepted in each
      type(observable_t) :: output                 !! what the linkage is for
   contains
      procedure :: want_derivatives
      procedure :: line_beside
      procedure :: set_inputs
      procedure :: set_turned
      procedure :: keep_positions
      procedure :: move_inputs
      procedure :: follow_from_here
      procedure :: set_desired
      procedure :: set_threads
      procedure :: bind => bind_problem
      procedure :: solve_block
      procedure :: blocks
      procedure :: evaluate
      procedure :: analyse
      procedure :: measure_of
      procedure :: worst_of
      procedure :: is_worse
      procedure :: find_undetermined
      procedure :: deviations
      procedure :: output_of
      procedure :: has_own_inputs
   end type problem_t

   interface
      !> Positions that are not reached from the drawing: no longer `closed`, but `beyond`.
      module subroutine leave_out_unreached(self, dimensions, motion, reach)
         implicit none (type, external)
         class(problem_t), intent(in) :: self
         type(dimensions_t), intent(in) :: dimensions
         type(motion_t), intent(inout) :: motion
         type(reach_t), intent(inout) :: reach
      end subroutine leave_out_unreached
   end interface

contains

   !> True if what counts is only what the linkage comes to from its drawing: a sketch whose dimensions are not searched.
   pure logical function follows_drawing(set, mechanism)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism

      follows_drawing = mechanism%from_drawing .and. .not. set%wants_search()
   end function follows_drawing

   !> Set a problem up from a data set and its mechanism.
   subroutine make_problem(set, mechanism, dimensions, parameters, problem, all_arcs)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(parameters_t), intent(in) :: parameters
      type(problem_t), intent(out) :: problem
      logical, intent(in), optional :: all_arcs !! solve every loop, both directions of every link pair; without it as KTHETA says
      real(wp), allocatable :: wanted(:, :), weight(:, :)
      logical :: everywhere

      everywhere = set%limits%ktheta /= 0
      if (present(all_arcs)) everywhere = all_arcs
      problem%tangle = set%limits%tangle
      problem%trmin_given = set%limits%trmin_given
      if (set%limits%tangle_given) problem%slide_angle = set%limits%tangle
      if (set%limits%toggle_given) problem%spare = set%limits%toggle
      problem%every_loop = mechanism%whole
      problem%followed = follows_drawing(set, mechanism)
      call fill_problem(mechanism, dimensions, parameters, inputs_of(set), everywhere, problem, own_inputs_of(set))
      problem%toggle = set%limits%toggle
      if (set%method%ikin /= 0) return
      problem%blank = set%sketch%has_targets() .and. .not. set%method%desired
      if (.not. (set%method%desired .or. problem%blank)) return
      if (problem%blank) then
         allocate (wanted(problem%positions, problem%output%kind%components), source=0.0_wp)
         weight = wanted
      else
         call desired_of(set, wanted, weight)
      end if
      call problem%set_desired(wanted, weight)
      call take_targets(set, problem)
      if (.not. allocated(set%method%rate_desired)) return
      problem%rate_desired = set%method%rate_desired
      problem%rate_weight = set%method%rate_weight
   end subroutine make_problem

   !> Desired values and derivatives of a sketch's further outputs, in the order of `compared_columns`.
   subroutine take_targets(set, problem)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      type(target_column_t), allocatable :: columns(:)
      integer :: k

      if (.not. set%sketch%has_targets()) return
      columns = compared_columns(set%sketch)
      allocate (problem%target_values(problem%positions, size(columns)), problem%target_weights(problem%positions, size(columns)), &
                source=0.0_wp)
      do k = 1, size(columns)
         associate (target => set%sketch%outputs(columns(k)%output)%targets(columns(k)%order), component => columns(k)%component)
            if (.not. allocated(target%values)) cycle      ! compared with another, not with a number
            problem%target_values(:, k) = target%values(component, :)
            problem%target_weights(:, k) = target%weights(component, :)
         end associate
      end do
   end subroutine take_targets

   !> A problem of a mechanism at given inputs, without desired values and without limits but that of closure.
   subroutine new_problem(mechanism, dimensions, parameters, inputs, every_loop, problem, own)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(parameters_t), intent(in) :: parameters
      real(wp), intent(in) :: inputs(:)     !! increments from the reference position: degrees, or length with a sliding input
      logical, intent(in) :: every_loop     !! solve loops that the output does not depend on too
      type(problem_t), intent(out) :: problem
      real(wp), intent(in), optional :: own(:, :) !! as `set_inputs` has it

      call fill_problem(mechanism, dimensions, parameters, inputs, every_loop, problem, own)
   end subroutine new_problem

   !> What `make_problem` and `new_problem` share; limits and `every_loop` are set before.
   subroutine fill_problem(mechanism, dimensions, parameters, inputs, all_arcs, problem, own)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(parameters_t), intent(in) :: parameters
      real(wp), intent(in) :: inputs(:)
      logical, intent(in) :: all_arcs       !! solve every loop and find both directions of every link pair
      type(problem_t), intent(inout) :: problem
      real(wp), intent(in), optional :: own(:, :) !! as `set_inputs` has it

      problem%mechanism = mechanism
      problem%given = dimensions
      problem%parameters = parameters
      problem%motion = mechanism%outputs(1)%motion
      allocate (problem%side(mechanism%nloop), source=1.0_wp)
      problem%plan = make_plan(mechanism, problem%motion, everything=problem%every_loop .or. all_arcs, &
                               all_roots=all_arcs)
      problem%asked = problem%plan%solved
      if (all_arcs .and. .not. problem%every_loop) problem%asked = loops_of_output(mechanism, problem%motion)
      call problem%set_inputs(inputs, own)
   end subroutine fill_problem

   !> By loop: the output depends on it.
   function loops_of_output(mechanism, motion) result(needed)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: motion
      logical, allocatable :: needed(:)
      type(plan_t) :: plan

      plan = make_plan(mechanism, motion, everything=.false., all_roots=.false.)
      needed = plan%solved
   end function loops_of_output

   !> Increments of the drives of a sketch after the first.
   pure function own_inputs_of(set) result(own)
      type(data_set_t), intent(in) :: set
      real(wp), allocatable :: own(:, :)    !! shape (positions, drives after the first), from the drawing; geared: 0
      integer :: d

      allocate (own(size(inputs_of(set)), max(0, size(set%sketch%drives) - 1)), source=0.0_wp)
      do d = 1, size(own, 2)
         associate (drive => set%sketch%drives(d + 1))
            if (drive%geared .or. .not. allocated(drive%delt) .or. set%method%ikin /= 0) cycle
            own(:, d) = drive%delt
         end associate
      end do
   end function own_inputs_of

   !> The same at inputs that may be those of the data set; else these drives are at rest.
   pure function own_inputs_at(set, delt) result(own)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: delt(:)       !! increments of the first drive
      real(wp), allocatable :: own(:, :)    !! as `own_inputs_of` has it
      real(wp), allocatable :: given(:)

      own = own_inputs_of(set)
      given = inputs_of(set)
      if (size(delt) == size(given)) then
         if (all(abs(delt - given) <= 0.0_wp)) return
      end if
      own = spread(spread(0.0_wp, 1, size(own, 2)), 1, size(delt))
   end function own_inputs_at

   !> Input increments of a data set: those it gives, or with IKIN a whole turn.
   pure function inputs_of(set) result(inputs)
      type(data_set_t), intent(in) :: set
      real(wp), allocatable :: inputs(:)
      integer :: i

      if (set%method%ikin /= 0) then
         inputs = [(real(i*set%method%ikin, wp), i=0, (359/abs(set%method%ikin)))]
      else
         inputs = set%method%delt
      end if
   end function inputs_of

   !> True if a drive after the first goes its own way: the positions are not on a line that the first input tells.
   pure logical function has_own_inputs(self)
      class(problem_t), intent(in) :: self

      has_own_inputs = any(.not. self%mechanism%actuators(2:)%geared)
   end function has_own_inputs

   !> Desired values and weights of a data set, component by component.
   pure subroutine desired_of(set, wanted, weight)
      type(data_set_t), intent(in) :: set
      real(wp), allocatable, intent(out) :: wanted(:, :), weight(:, :) !! shape (positions, components)
      type(output_kind_t) :: kind

      kind = output_kind(set%motion())
      allocate (wanted(set%method%ndes, kind%components), weight(set%method%ndes, kind%components), source=0.0_wp)
      if (kind%components > 1) then
         wanted(:, 1) = set%method%desx + set%method%xadd
         wanted(:, 2) = set%method%desy + set%method%yadd
         weight(:, 1) = set%method%xmult
         weight(:, 2) = set%method%ymult
      end if
      if (kind%components == 2) return
      wanted(:, kind%components) = set%method%desang
      weight(:, kind%components) = set%method%anmult
   end subroutine desired_of

   !> Make a plan that finds everything derivatives need; inputs and desired values are kept.
   subroutine want_derivatives(self, everything, joints, with_point)
      class(problem_t), intent(inout) :: self
      logical, intent(in) :: everything     !! solve every loop, wanted or not
      integer, intent(in), optional :: joints(:, :) !! joints to be made, as `make_plan` has them
      logical, intent(in), optional :: with_point !! make the point that the output arc begins at, whatever the output is
      integer :: motion

      motion = self%motion
      if (present(with_point)) motion = merge(motion_point, motion, with_point)
      self%plan = make_plan(self%mechanism, motion, everything .or. self%every_loop, .true., joints)
      call self%linkage%prepare(self%mechanism, self%plan, self%tangle, self%slide_angle, self%spare, self%delt)
      call self%output%locate(self%motion, self%mechanism, self%plan, self%linkage)
      if (allocated(self%linkages)) call self%set_threads(size(self%linkages))
   end subroutine want_derivatives

   !> From a point of the plan to a joint beside it, at position `i` of the block just solved: user's length, machine axes.
   pure complex(wp) function line_beside(self, beside, i) result(line)
      class(problem_t), intent(in) :: self
      type(beside_t), intent(in) :: beside
      integer, intent(in) :: i
      real(wp) :: c, s

      call unit_vector(beside%angle, c, s)
      line = beside%distance*cmplx(c, s, wp)
      if (beside%arc == 0) return
      associate (link => self%linkage, root => self%plan%root(beside%arc), n => beside%arc)
         line = line*cmplx(link%x(n), link%y(n), wp)* &
                cmplx(link%store%v(i, link%root_x(root)), link%store%v(i, link%root_y(root)), wp)
      end associate
   end function line_beside

   !> Give the input positions (increments from the reference position); desired values are dropped.
   subroutine set_inputs(self, delt, own)
      class(problem_t), intent(inout) :: self
      real(wp), intent(in) :: delt(:)  !! degrees, or length with a sliding input
      real(wp), intent(in), optional :: own(:, :) !! shape (positions, drives after the first): of drives that are not geared, from
                                       !! the drawing; else as before where the positions are the same, and otherwise at rest
      integer :: i
      logical :: same

      same = allocated(self%delt)
      if (same) same = size(self%delt) == size(delt)
      if (same) same = all(abs(self%delt - delt) <= 0.0_wp)
      self%positions = size(delt)
      self%delt = delt
      if (allocated(self%turned) .and. .not. same) deallocate (self%turned)
      self%desired = .false.
      if (allocated(self%rate_desired)) deallocate (self%rate_desired, self%rate_weight)
      if (allocated(self%target_values)) deallocate (self%target_values, self%target_weights)
      call self%linkage%prepare(self%mechanism, self%plan, self%tangle, self%slide_angle, self%spare, delt)
      call self%output%locate(self%motion, self%mechanism, self%plan, self%linkage)
      if (allocated(self%linkages)) deallocate (self%linkages)
      self%first = whole_blocks(self, delt, delt(size(delt)))
      self%second = self%first
      self%path = self%first
      if (.not. self%mechanism%sliding_input) then
         do i = 1, size(self%first)
            call unit_vector(self%second(i), self%first(i), self%second(i))
         end do
      end if
      call set_more(self, same, own)
      if (allocated(self%partial)) deallocate (self%partial, self%offending)
      allocate (self%partial(self%blocks()), source=0.0_wp)
      allocate (self%offending(self%blocks()), source=0)
   end subroutine set_inputs

   !> Say at which of the positions dyads are in their other assembly, as beyond a change point.
   pure subroutine set_turned(self, turned)
      class(problem_t), intent(inout) :: self
      logical, intent(in) :: turned(:, :)          !! shape (positions, loops)
      integer :: i

      if (allocated(self%turned)) deallocate (self%turned)
      allocate (self%turned(size(self%first), size(turned, 2)))
      do i = 1, size(self%first)
         self%turned(i, :) = turned(min(i, size(turned, 1)), :)
      end do
   end subroutine set_turned

   !> Increments of the drives after the first.
   subroutine set_more(self, same, own)
      class(problem_t), intent(inout) :: self
      logical, intent(in) :: same                  !! the positions are those of before
      real(wp), intent(in), optional :: own(:, :)  !! as `set_inputs` has it

      if (allocated(self%more)) deallocate (self%more)
      if (allocated(self%own_delt) .and. .not. same) deallocate (self%own_delt)
      associate (drives => size(self%mechanism%actuators) - 1)
         if (drives < 1) return
         allocate (self%more(size(self%first), 3, drives), source=0.0_wp)
         if (.not. allocated(self%own_delt)) allocate (self%own_delt(self%positions, drives), source=0.0_wp)
      end associate
      if (present(own)) self%own_delt = own
      call fill_more(self)
   end subroutine set_more

   pure subroutine fill_more(self)
      class(problem_t), intent(inout) :: self
      integer :: d, i

      do d = 1, size(self%more, 3)
         associate (actuator => self%mechanism%actuators(d + 1))
            do i = 1, size(self%more, 1)
               if (actuator%geared) then
                  self%more(i, 1, d) = actuator%ratio*self%path(i)
               else
                  self%more(i, 1, d) = self%own_delt(min(i, self%positions), d)
               end if
               if (.not. actuator%slides) call unit_vector(self%more(i, 1, d), self%more(i, 2, d), self%more(i, 3, d))
            end do
         end associate
      end do
   end subroutine fill_more

   !> Leave only some of the positions, with their desired values; derivatives and desired values of further outputs are dropped.
   subroutine keep_positions(self, kept)
      class(problem_t), intent(inout) :: self
      integer, intent(in) :: kept(:)   !! numbers of positions
      real(wp), allocatable :: wanted(:, :), weight(:, :), own(:, :)  ! `own` is absent where it is not allocated

      if (self%desired .or. (self%blank .and. allocated(self%target_values))) then
         wanted = self%wanted(kept, :)
         weight = self%weight(kept, :)
      end if
      if (allocated(self%own_delt)) own = self%own_delt(kept, :)
      call self%set_inputs(self%delt(kept), own)
      if (allocated(wanted)) call self%set_desired(wanted, weight)
   end subroutine keep_positions

   !> Move the input positions; their number, desired values and weights stay. No allocation.
   pure subroutine move_inputs(self, delt)
      class(problem_t), intent(inout) :: self
      real(wp), intent(in) :: delt(:)  !! shape (positions)
      integer :: i

      self%delt = delt
      do i = 1, size(self%first)
         associate (value => delt(min(i, size(delt))))
            self%path(i) = value
            if (self%mechanism%sliding_input) then
               self%first(i) = value
               self%second(i) = value
            else
               call unit_vector(value, self%first(i), self%second(i))
            end if
         end associate
      end do
      if (allocated(self%more)) call fill_more(self)
   end subroutine move_inputs

   !> From now on larger groups are followed from the position that was solved last, the only one of the block.
   pure subroutine follow_from_here(self)
      class(problem_t), intent(inout) :: self
      integer :: d

      if (.not. allocated(self%more)) then
         call self%linkage%follow_from(1, self%delt)
      else
         call self%linkage%follow_from(1, [self%delt(1), (self%more(1, 1, d), d=1, size(self%more, 3))])
      end if
   end subroutine follow_from_here

   !> Give desired values and weights for the positions.
   subroutine set_desired(self, wanted, weight)
      class(problem_t), intent(inout) :: self
      real(wp), intent(in) :: wanted(:, :)             !! shape (positions, components)
      real(wp), intent(in), optional :: weight(:, :)   !! the same shape; default 1
      integer :: i, c, components

      self%desired = .not. self%blank
      components = self%output%kind%components
      if (allocated(self%wanted)) deallocate (self%wanted, self%weight, self%toward_x, self%toward_y)
      associate (n => self%blocks()*self%linkage%capacity)
         allocate (self%wanted(n, components), self%weight(n, components), self%toward_x(n), self%toward_y(n), source=0.0_wp)
      end associate
      do c = 1, components
         self%wanted(:, c) = whole_blocks(self, wanted(:, c), wanted(size(wanted, 1), c))
         self%weight(:self%positions, c) = 1.0_wp
         if (present(weight)) self%weight(:self%positions, c) = weight(:, c)
      end do
      if (self%output%kind%angle == 0) return
      do i = 1, size(self%wanted, 1)
         call unit_vector(self%wanted(i, self%output%kind%angle), self%toward_x(i), self%toward_y(i))
      end do
   end subroutine set_desired

   !> Values of the positions, then a filler up to the end of the last block.
   pure function whole_blocks(self, values, filler) result(padded_values)
      class(problem_t), intent(in) :: self
      real(wp), intent(in) :: values(:), filler
      real(wp), allocatable :: padded_values(:)

      allocate (padded_values(self%blocks()*self%linkage%capacity), source=filler)
      padded_values(:size(values)) = values
   end function whole_blocks

   !> Let `threads` threads share the blocks of an evaluation. The results have the same bits for any number.
   subroutine set_threads(self, threads)
      class(problem_t), intent(inout) :: self
      integer, intent(in) :: threads
      integer :: t

      if (allocated(self%linkages)) deallocate (self%linkages)
      if (threads < 2 .or. self%blocks() < 2*threads) return
      allocate (self%linkages(threads))
      do t = 1, threads
         call self%linkages(t)%prepare(self%mechanism, self%plan, self%tangle, self%slide_angle, self%spare, self%delt)
      end do
   end subroutine set_threads

   !> Put dimensions in.
   pure subroutine bind_problem(self, dimensions)
      class(problem_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions

      call self%linkage%bind(self%mechanism, self%plan, dimensions)
      call self%output%bind(dimensions, self%linkage)
   end subroutine bind_problem

   !> Number of blocks the positions make.
   pure integer function blocks(self)
      class(problem_t), intent(in) :: self

      blocks = (self%positions + self%linkage%capacity - 1)/self%linkage%capacity
   end function blocks

   !> Solve block `block`: positions offset+1 ... offset+n.
   pure subroutine solve_block(self, block, offset, n, last_step)
      class(problem_t), intent(inout) :: self
      integer, intent(in) :: block
      integer, intent(out) :: offset, n
      integer, intent(in), optional :: last_step
      integer :: m

      offset = (block - 1)*self%linkage%capacity
      n = min(self%linkage%capacity, self%positions - offset)
      m = padded(n)
      call solve_positions(self, self%linkage, offset, m, last_step)
   end subroutine solve_block

   !> Objective of a linkage: the sum of weight * (desired - actual)**2.
   !>
   !> `loop` is the lowest loop that does not close, or whose transmission angle is out of limits, at any position, or whose two
   !> slides are not always on the same side of each other; the objective has no meaning then. No allocation. With
   !> `set_threads` the blocks are shared out; each block's sum is formed by itself and the sums are added in order, so that the
   !> bits do not depend on the number of threads.
   subroutine evaluate(self, dimensions, objective, loop)
      class(problem_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(out) :: objective
      integer, intent(out) :: loop         !! 0: none
      integer :: block, t

      call self%bind(dimensions)
      if (allocated(self%linkages)) then
         !$omp parallel do num_threads(size(self%linkages)) schedule(static) private(block)
         do t = 1, size(self%linkages)
            call self%linkages(t)%bind(self%mechanism, self%plan, dimensions)
            do block = t, self%blocks(), size(self%linkages)
               call evaluate_block(self, self%linkages(t), block, self%partial(block), self%offending(block))
            end do
         end do
         !$omp end parallel do
      else
         do block = 1, self%blocks()
            call evaluate_block(self, self%linkage, block, self%partial(block), self%offending(block))
         end do
      end if
      objective = 0.0_wp
      loop = 0
      do block = 1, self%blocks()
         objective = objective + self%partial(block)
         if (self%offending(block) > 0 .and. (loop == 0 .or. self%offending(block) < loop)) loop = self%offending(block)
      end do
      if (loop > 0 .or. .not. any(self%linkage%two_slides)) return
      do loop = 1, self%mechanism%nloop
         if (allocated(self%linkages)) then
            do t = 1, size(self%linkages)
               if (.not. self%linkages(t)%stays_on_side(loop, self%linkages(1))) return
            end do
         else
            if (.not. self%linkage%stays_on_side(loop)) return
         end if
      end do
      loop = 0
   end subroutine evaluate

   !> The positions offset+1 ... offset+n with a bound linkage.
   pure subroutine solve_positions(self, linkage, offset, n, last_step, offending)
      class(problem_t), intent(in) :: self
      type(linkage_t), intent(inout) :: linkage
      integer, intent(in) :: offset, n
      integer, intent(in), optional :: last_step
      integer, intent(out), optional :: offending

      associate (first => offset + 1, last => offset + n)
         if (allocated(self%turned)) then
            if (allocated(self%more)) then
               call linkage%solve(n, self%first(first:last), self%second(first:last), self%path(first:last), &
                                  self%more(first:last, :, :), last_step, offending, self%turned(first:last, :))
            else
               call linkage%solve(n, self%first(first:last), self%second(first:last), self%path(first:last), last_step=last_step, &
                                  offending=offending, turned=self%turned(first:last, :))
            end if
         else if (allocated(self%more)) then
            call linkage%solve(n, self%first(first:last), self%second(first:last), self%path(first:last), &
                               self%more(first:last, :, :), last_step, offending)
         else
            call linkage%solve(n, self%first(first:last), self%second(first:last), self%path(first:last), last_step=last_step, &
                               offending=offending)
         end if
      end associate
   end subroutine solve_positions

   !> Deviations actual - desired of a linkage at every position; `loop` is the lowest loop not accepted, 0: none. No allocation.
   pure subroutine deviations(self, dimensions, miss, loop)
      class(problem_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(inout) :: miss(:, :)  !! shape (positions, components)
      integer, intent(out) :: loop
      real(wp) :: unused
      integer :: block, offset, n, c

      call self%bind(dimensions)
      loop = 0
      do block = 1, self%blocks()
         call evaluate_block(self, self%linkage, block, unused, loop)
         if (loop > 0) return
         offset = (block - 1)*self%linkage%capacity
         n = min(self%linkage%capacity, self%positions - offset)
         do c = 1, self%output%kind%components
            call miss_of(self, self%linkage, c, offset, padded(n))
            miss(offset + 1:offset + n, c) = -self%linkage%store%v(1:n, self%linkage%miss)
         end do
      end do
   end subroutine deviations

   !> One block of an evaluation with a bound linkage.
   pure subroutine evaluate_block(self, linkage, block, objective, loop)
      class(problem_t), intent(in) :: self
      type(linkage_t), intent(inout) :: linkage
      integer, intent(in) :: block
      real(wp), intent(out) :: objective
      integer, intent(out) :: loop         !! lowest loop not accepted, 0: none
      integer :: offset, m, c

      offset = (block - 1)*linkage%capacity
      m = padded(min(linkage%capacity, self%positions - offset))
      objective = 0.0_wp
      call solve_positions(self, linkage, offset, m, offending=loop)
      if (loop > 0) return
      call linkage%note_sides(m)
      if (self%motion /= motion_angle) call self%output%observe(m, linkage)
      do c = 1, self%output%kind%components
         call miss_of(self, linkage, c, offset, m)
         objective = objective + sum_of_squares(m, linkage%store%v(1, linkage%miss), self%weight(offset + 1:offset + m, c))
      end do
   end subroutine evaluate_block

   !> Desired less actual value of a component at the positions of a block, into the row `miss`.
   pure subroutine miss_of(self, linkage, component, offset, n)
      class(problem_t), intent(in) :: self
      type(linkage_t), intent(inout) :: linkage
      integer, intent(in) :: component, offset, n

      associate (first => offset + 1, last => offset + n)
         call self%output%miss(component, n, self%wanted(first:last, component), self%toward_x(first:last), &
                               self%toward_y(first:last), linkage)
      end associate
   end subroutine miss_of

   !> Sum of weight * error**2 in a fixed order: eight partial sums, so that it runs in vector lanes.
   pure real(wp) function sum_of_squares(n, error, weight)
      integer, intent(in) :: n          !! a multiple of 4
      real(wp), intent(in) :: error(n), weight(n)
      integer, parameter :: lanes = 8, half = lanes/2
      real(wp) :: part(lanes)
      integer :: i

      part = 0.0_wp
      do i = 1, n - lanes + 1, lanes
         part = part + weight(i:i + lanes - 1)*error(i:i + lanes - 1)**2
      end do
      if (modulo(n, lanes) > 0) part(:half) = part(:half) + weight(n - half + 1:n)*error(n - half + 1:n)**2
      sum_of_squares = ((part(1) + part(2)) + (part(3) + part(4))) + ((part(5) + part(6)) + (part(7) + part(8)))
   end function sum_of_squares

   !> Output of the first `n` positions of the block just solved, into the output's rows of the linkage.
   pure subroutine output_of(self, n)
      class(problem_t), intent(inout) :: self
      integer, intent(in) :: n

      call self%output%observe(padded(n), self%linkage)
   end subroutine output_of

   !> Closure measure of one loop at every position, in the user's unit.
   subroutine measure_of(self, loop, measure)
      class(problem_t), intent(inout) :: self
      integer, intent(in) :: loop
      real(wp), intent(out) :: measure(:)  !! shape (positions)
      type(form_t) :: form
      real(wp) :: back
      integer :: block, offset, n

      form = form_of(self%mechanism%groups(loop)%kind)
      back = (1.0_wp/self%linkage%scale)**form%power
      do block = 1, self%blocks()
         call self%solve_block(block, offset, n, self%linkage%step_of_loop(loop))
         measure(offset + 1:offset + n) = self%linkage%store%v(1:n, self%linkage%measure(loop))*back
      end do
   end subroutine measure_of

   !> How a loop that is not accepted violates its limits at worst; `worst` is the position.
   subroutine worst_of(self, loop, violation)
      class(problem_t), intent(inout) :: self      !! bound
      integer, intent(in) :: loop
      type(violation_t), intent(out) :: violation
      type(violation_t) :: new
      integer :: block, offset, n, i

      do block = 1, self%blocks()
         call self%solve_block(block, offset, n, self%linkage%step_of_loop(loop))
         do i = 1, n
            if (self%linkage%accepts(i, loop) .and. .not. coincides(self, loop, i)) cycle
            new = violation_at(self, loop, i)
            new%worst = offset + i
            if (violation%kind == violation_none .or. self%is_worse(new%kind, new%amount, violation%kind, violation%amount)) &
               violation = new
         end do
      end do
   end subroutine worst_of

   !> True if one violation of a loop is worse than another: an open dyad than a bad angle, which is worse the less a small one or
   !> the more a large one.
   elemental logical function is_worse(self, kind, amount, other_kind, other_amount)
      class(problem_t), intent(in) :: self
      integer, intent(in) :: kind, other_kind      !! violation_...
      real(wp), intent(in) :: amount, other_amount

      if (closes_by(kind) .neqv. closes_by(other_kind)) then
         is_worse = closes_by(other_kind)
      else
         is_worse = beyond(kind, amount) > beyond(other_kind, other_amount)
      end if

   contains

      !> The dyad closes, but not within TANGLE or TOGGLE.
      pure logical function closes_by(kind)
         integer, intent(in) :: kind

         closes_by = any(kind == [violation_angle_small, violation_angle_large, violation_slides, violation_toggle])
      end function closes_by

      !> A number that grows with how bad it is.
      pure real(wp) function beyond(kind, amount)
         integer, intent(in) :: kind
         real(wp), intent(in) :: amount

         select case (kind)
         case (violation_angle_small)
            beyond = right_angle - amount - self%tangle
         case (violation_angle_large)
            beyond = amount - right_angle - self%tangle
         case (violation_slides, violation_toggle)
            beyond = -amount
         case default
            beyond = amount
         end select
      end function beyond
   end function is_worse

   !> The whole motion of a linkage: actual values, errors, and every violation of closure or transmission limits.
   !>
   !> What the host ends is not whole and of no use.
   subroutine analyse(self, dimensions, motion, reach, stop)
      class(problem_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(out) :: motion
      type(reach_t), intent(inout), optional :: reach !! of this linkage, from an analysis at other inputs; or not known yet
      type(stop_t), intent(in), optional :: stop      !! asked before each block
      type(reach_t) :: own
      integer :: block, offset, n, m, i, k, l, c, components, noted
      integer, allocatable :: open_violation(:)
      real(wp), allocatable :: sine(:)     !! by loop: between two slides, at the position before
      logical :: closed_before

      n = self%positions
      noted = 0
      components = self%output%kind%components
      allocate (motion%closed(n), motion%output_known(n), source=.true.)
      allocate (motion%input(n), source=0.0_wp)
      allocate (motion%actual(n, components), motion%error(n, components), source=0.0_wp)
      allocate (motion%violations(0), motion%crossings(0))
      allocate (sine(self%mechanism%nloop), source=0.0_wp)
      closed_before = .false.
      allocate (open_violation(self%mechanism%nloop), source=0)
      motion%input = input_at(self%mechanism, dimensions, self%delt)
      if (shows_crank(self%mechanism)) motion%crank = crank_angle_at(self%mechanism, dimensions, self%delt)
      call self%bind(dimensions)
      do block = 1, self%blocks()
         if (is_to_end(stop)) return
         call self%solve_block(block, offset, n)
         m = padded(n)
         do l = 1, self%mechanism%nloop
            if (self%linkage%step_of_loop(l) == 0) cycle
            if (self%linkage%all_accepted(m, l) .and. coincidence(self, l) < 0.0_wp) cycle
            do i = 1, n
               if (self%linkage%accepts(i, l) .and. .not. coincides(self, l, i)) cycle
               if (.not. self%linkage%closes(i, l) .or. coincides(self, l, i)) then
                  motion%closed(offset + i) = .false.
                  if (self%asked(l)) motion%output_known(offset + i) = .false.
               end if
               call note_violation(self, l, i, offset + i, open_violation(l), motion%violations, noted)
            end do
         end do
         do i = 1, n
            do l = 1, self%mechanism%nloop
               if (.not. self%linkage%two_slides(l) .or. self%linkage%step_of_loop(l) == 0) cycle
               associate (now => self%linkage%store%v(i, self%linkage%measure(l)))
                  if (now*sine(l) < 0.0_wp .and. closed_before .and. motion%closed(offset + i)) &
                     motion%crossings = [motion%crossings, crossing_t(l, offset + i - 1)]
                  sine(l) = now
               end associate
            end do
            closed_before = motion%closed(offset + i)
         end do
         call self%output%observe(m, self%linkage)
         do c = 1, components
            if (self%desired) call miss_of(self, self%linkage, c, offset, m)
            do i = 1, n
               k = offset + i
               if (self%desired .and. c == self%output%kind%angle) then
                  motion%error(k, c) = self%linkage%store%v(i, self%linkage%miss)
                  motion%actual(k, c) = self%wanted(k, c) - motion%error(k, c)
               else
                  motion%actual(k, c) = self%output%actual(c, i, self%linkage)
                  if (self%desired) motion%error(k, c) = self%wanted(k, c) - motion%actual(k, c)
               end if
            end do
         end do
         if (.not. self%desired) cycle
         do k = offset + 1, offset + n
            if (.not. motion%closed(k)) cycle
            do c = 1, components
               motion%total = motion%total + self%weight(k, c)*motion%error(k, c)**2
            end do
         end do
      end do
      motion%violations = motion%violations(:noted)
      if (.not. self%followed) return
      if (present(reach)) then
         call leave_out_unreached(self, dimensions, motion, reach)
      else
         call leave_out_unreached(self, dimensions, motion, own)
      end if
   end subroutine analyse

   !> Enter a violation, or let the one of the position before go on.
   subroutine note_violation(self, loop, i, position, current, violations, noted)
      class(problem_t), intent(in) :: self
      integer, intent(in) :: loop, i, position
      integer, intent(inout) :: current    !! the loop's last violation in the list, 0: none
      type(violation_t), allocatable, intent(inout) :: violations(:) !! room; the first `noted` are valid
      integer, intent(inout) :: noted
      type(violation_t) :: new
      type(violation_t), allocatable :: more(:)

      new = violation_at(self, loop, i)
      new%first = position
      new%last = position
      new%worst = position
      if (current > 0) then
         associate (old => violations(current))
            if (old%kind == new%kind .and. old%last == position - 1) then
               old%last = position
               if (self%is_worse(new%kind, new%amount, old%kind, old%amount)) then
                  old%amount = new%amount
                  old%worst = position
               end if
               return
            end if
         end associate
      end if
      if (noted == size(violations)) then
         allocate (more(max(8, 2*noted)))
         more(:noted) = violations
         call move_alloc(more, violations)
      end if
      noted = noted + 1
      violations(noted) = new
      current = noted
   end subroutine note_violation

   !> Distance of the outer joints of a loop's dyad at and below which they coincide; negative: they cannot.
   pure real(wp) function coincidence(self, loop)
      class(problem_t), intent(in) :: self
      integer, intent(in) :: loop

      coincidence = coincidence_of(self%linkage%steps(self%linkage%step_of_loop(loop))%dyad, maxval(self%linkage%length))
   end function coincidence

   !> True if the outer joints of a loop's dyad coincide at position `i` of the block: no direction is determined.
   pure logical function coincides(self, loop, i)
      class(problem_t), intent(in) :: self
      integer, intent(in) :: loop, i
      real(wp) :: least

      least = coincidence(self, loop)
      coincides = .false.
      if (least >= 0.0_wp) coincides = self%linkage%store%v(i, self%linkage%measure(loop)) <= least**2
   end function coincides

   !> Positions at which the outer joints of a dyad coincide, so that rounding decides whether it closes and where its links are.
   !> A single position between others, a change point that is passed, is none.
   subroutine find_undetermined(self, loop)
      class(problem_t), intent(inout) :: self      !! bound
      integer, intent(out) :: loop(:)              !! shape (positions): the first loop of such a dyad, 0: none
      logical :: may_be(self%mechanism%nloop), single(size(loop))
      integer :: block, offset, n, i, l, k

      loop = 0
      do l = 1, size(may_be)
         may_be(l) = self%linkage%step_of_loop(l) > 0
         if (may_be(l)) may_be(l) = coincidence(self, l) >= 0.0_wp
      end do
      if (.not. any(may_be)) return
      do block = 1, self%blocks()
         call self%solve_block(block, offset, n)
         do l = size(may_be), 1, -1
            if (.not. may_be(l)) cycle
            do i = 1, n
               if (.not. coincides(self, l, i)) cycle
               loop(offset + i) = l
               ! where a loop before is open its joints are nowhere
               do k = 1, l - 1
                  if (self%linkage%step_of_loop(k) == 0) cycle
                  if (.not. self%linkage%closes(i, k)) loop(offset + i) = 0
               end do
            end do
         end do
      end do
      associate (last => size(loop))
         single = loop > 0
         single(2:) = single(2:) .and. loop(:last - 1) == 0
         single(:last - 1) = single(:last - 1) .and. loop(2:) == 0
         where (single) loop = 0
      end associate
   end subroutine find_undetermined

   !> What is wrong with a loop at position `i` of the block, and by how much.
   pure type(violation_t) function violation_at(self, loop, i) result(violation)
      class(problem_t), intent(in) :: self
      integer, intent(in) :: loop, i
      type(dyad_violation_t) :: of_dyad

      of_dyad = violation_of(self%linkage%steps(self%linkage%step_of_loop(loop))%dyad, &
                         self%linkage%store%v(i, self%linkage%measure(loop)), self%linkage%closes(i, loop))
      violation%loop = loop
      if (coincides(self, loop, i)) then
         violation%kind = violation_undetermined
         return
      end if
      violation%kind = of_dyad%kind
      violation%amount = of_dyad%amount
      if (of_dyad%is_length) violation%amount = violation%amount/self%linkage%scale
   end function violation_at
end module psalm_error
