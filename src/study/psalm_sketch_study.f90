!> All outputs and joints of a sketch at the positions of a case; of one that has loops they are found by these, block by block.
module psalm_sketch_study
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_condition, only: condition_t, condition_at, prepare_condition
   use psalm_closure, only: most_orders
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_joint_location, only: locate_sketch
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_moving_joints, only: sketch_motion_t
   use psalm_output_condition, only: output_conditions
   use psalm_rates, only: rates_t, prepare_rates, derivatives_of, differentiate, in_time, is_dead
   use psalm_sketch, only: columns_of, frame_link, output_ratio
   use psalm_sketch_motion, only: find_places, observe_sketch
   use psalm_sketch_outputs, only: names_of_numbers, values_of_outputs, unwrap, name_length
   use psalm_shown_input, only: crank_angle_at, input_at, shows_crank
   use psalm_sweep, only: sweep_inputs
   implicit none (type, external)
   private
   public :: sketch_study_t, link_poses_t, study_sketch, study_sweep, study_conditions

   !> What a sketch does.
   type :: sketch_study_t
      real(wp), allocatable :: inputs(:, :)         !! shape (drives, positions): degrees or length, from the drawing
      real(wp), allocatable :: crank(:)             !! shape (positions): its angle from the x axis, degrees in a turn; empty: it is
                                                    !! not shown
      logical, allocatable :: closed(:)             !! shape (positions): it is reached from the drawing
      logical, allocatable :: dead(:)               !! shape (positions): rates are infinite
      character(name_length), allocatable :: names(:) !! of the numbers of all outputs
      logical, allocatable :: angles(:)             !! they are angles that may turn on
      real(wp), allocatable :: values(:, :, :)      !! shape (numbers, 0:orders, positions); angles in degrees, rates radians;
                                                    !! huge: a ratio to what stands still, and its rates
      real(wp), allocatable :: by_drive(:, :, :)    !! shape (numbers, drives, positions): change with one drive, the others held
      real(wp), allocatable :: conditions(:, :)     !! shape (outputs, positions): condition numbers, if asked for;
                                                    !! of a ratio huge
      complex(wp), allocatable :: joints(:, :, :)   !! shape (joints, 0:orders, positions): places and rates by time
   contains
      procedure :: find_range
   end type sketch_study_t

   !> Places and turns of links with their rates by time, where they are wanted besides.
   type :: link_poses_t
      type(sketch_motion_t) :: parts                !! where joints are, and after them the axes of links without joints begin
      integer, allocatable :: axis(:)               !! by link: an arc that turns as it does; 0: none
      complex(wp), allocatable :: t(:, :, :)        !! shape (links, 0:most_orders, positions)
      real(wp), allocatable :: phi(:, :, :)         !! the same shape; turns between half a turn and its opposite, radians
   end type link_poses_t

contains

   !> Least and greatest value of a number of the outputs at the positions where it has one; the least is greater if there is none.
   pure subroutine find_range(self, number, least, most)
      class(sketch_study_t), intent(in) :: self
      integer, intent(in) :: number
      real(wp), intent(out) :: least, most

      associate (values => self%values(number, 0, :), known => self%closed .and. self%values(number, 0, :) < huge(1.0_wp))
         least = minval(values, mask=known)
         most = maxval(values, mask=known)
      end associate
   end subroutine find_range

   !> Where the joints are: those of the drawing, which were found with its loops, or of other dimensions.
   subroutine locate_as(set, dimensions, changed, sketch)
      type(data_set_t), intent(in) :: set
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in), optional :: changed          !! the dimensions are not those of the drawing
      type(sketch_motion_t), intent(out) :: sketch
      logical :: anew

      anew = .false.
      if (present(changed)) anew = changed
      if (anew) then
         call locate_sketch(set, sketch, dimensions)
      else
         sketch = set%traced%moving
      end if
   end subroutine locate_as

   !> Condition numbers of all outputs.
   subroutine study_conditions(set, problem, dimensions, study, changed)
      type(data_set_t), intent(in) :: set               !! a sketch with its loops
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(sketch_study_t), intent(inout) :: study
      logical, intent(in), optional :: changed          !! the dimensions are not those of the drawing
      class(problem_t), allocatable :: own              ! large: it would fill a small stack
      type(sketch_motion_t) :: sketch
      type(condition_t) :: condition
      complex(wp), allocatable :: joint(:, :)
      real(wp), allocatable :: moved(:, :)
      real(wp) :: unused
      integer :: block, offset, n, i

      allocate (own, source=problem)
      if (allocated(own%linkages)) deallocate (own%linkages)
      call locate_as(set, dimensions, changed, sketch)
      call own%want_derivatives(.true., sketch%points)
      call own%bind(dimensions)
      call prepare_condition(own%linkage, condition)
      allocate (study%conditions(size(set%sketch%outputs), own%positions), source=0.0_wp)
      allocate (joint(size(sketch%drawn), own%linkage%capacity), moved(size(sketch%arcs), own%linkage%capacity))
      do block = 1, own%blocks()
         call own%solve_block(block, offset, n)
         call own%output_of(n)
         call find_places(sketch, own, n, joint(:, :n), moved(:, :n))
         do i = 1, n
            if (.not. study%closed(offset + i)) cycle
            call condition_at(own, i, offset + i, condition, unused)
            call output_conditions(set%sketch%outputs, sketch, own, condition, joint(:, i), moved(:, i), &
                                   study%conditions(:, offset + i))
         end do
      end do
   end subroutine study_conditions

   !> The same over the sweep of the input that IPLOT asks for.
   subroutine study_sweep(set, problem, dimensions, closed, study, changed)
      type(data_set_t), intent(in) :: set               !! a sketch with its loops
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in) :: closed(:)                  !! shape (steps of the sweep): by its analysis
      type(sketch_study_t), intent(out) :: study
      logical, intent(in), optional :: changed          !! the dimensions are not those of the drawing
      class(problem_t), allocatable :: fine             ! large: it would fill a small stack

      allocate (fine, source=problem)
      call fine%set_inputs(sweep_inputs(problem))
      call study_sketch(set, fine, dimensions, closed, 1.0_wp, 0.0_wp, study, changed, places_only=.true.)
   end subroutine study_sweep

   !> Outputs and joints at the positions of a problem, with their rates by time; places alone, if no more is wanted.
   subroutine study_sketch(set, problem, dimensions, closed, speed, accel, study, changed, poses, places_only)
      type(data_set_t), intent(in) :: set               !! a sketch with its loops
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in) :: closed(:)                  !! shape (positions): by the analysis of the problem
      real(wp), intent(in) :: speed, accel              !! of the input: radians or length a second
      type(sketch_study_t), intent(out) :: study
      logical, intent(in), optional :: changed          !! the dimensions are not those of the drawing
      type(link_poses_t), intent(inout), optional :: poses !! with its parts and axes
      logical, intent(in), optional :: places_only      !! no rates are wanted but those that are values; default: rates are, too
      class(problem_t), allocatable :: own              ! large, as the rates are: they would fill a small stack
      type(rates_t), allocatable :: rates
      type(sketch_motion_t) :: sketch
      real(wp), allocatable :: moved(:, :, :)
      complex(wp), allocatable :: places(:, :, :), alone(:, :, :)
      real(wp), allocatable :: numbers(:, :)             ! shape (numbers, 0:most_orders)
      real(wp) :: largest(2)
      integer :: block, offset, n, i, k, loop, order, orders

      orders = most_orders
      if (present(places_only)) then
         if (places_only .and. .not. has_rates(set, problem)) orders = 0
      end if
      allocate (own, source=problem)
      if (allocated(own%linkages)) deallocate (own%linkages)
      if (present(poses)) then
         sketch = poses%parts
         allocate (poses%t(size(poses%axis), 0:most_orders, size(closed)), source=(0.0_wp, 0.0_wp))
         allocate (poses%phi(size(poses%axis), 0:most_orders, size(closed)), source=0.0_wp)
      else
         call locate_as(set, dimensions, changed, sketch)
      end if
      call own%want_derivatives(.true., sketch%points)
      call own%bind(dimensions)
      allocate (rates)
      if (orders > 0) call prepare_rates(own, rates)
      allocate (study%inputs(size(set%sketch%drives), problem%positions))
      study%inputs(1, :) = input_at(own%mechanism, dimensions, problem%delt)
      study%crank = pack(crank_angle_at(own%mechanism, dimensions, problem%delt), &
                         spread(shows_crank(own%mechanism), 1, problem%positions))
      do k = 2, size(study%inputs, 1)
         if (set%sketch%drives(k)%geared) then
            study%inputs(k, :) = set%sketch%drives(k)%ratio*study%inputs(1, :) + set%sketch%drives(k)%phase
         else
            study%inputs(k, :) = problem%own_delt(:, k - 1)
         end if
      end do
      study%closed = closed
      associate (positions => size(closed), outputs => set%sketch%outputs)
         call names_of_numbers(outputs, study%names, study%angles)
         allocate (study%dead(positions), source=.false.)
         allocate (study%values(size(study%names), 0:orders, positions), source=0.0_wp)
         allocate (study%joints(size(set%sketch%joint_name), 0:orders, positions))
         allocate (numbers(size(study%names), 0:most_orders))
         allocate (moved(size(set%sketch%slides), 0:most_orders, own%linkage%capacity), source=0.0_wp)
         allocate (study%by_drive(size(study%names), merge(0, size(study%inputs, 1), orders == 0), positions), source=0.0_wp)
         allocate (places(size(sketch%drawn), 0:most_orders, own%linkage%capacity), source=(0.0_wp, 0.0_wp))
         if (size(study%inputs, 1) > 1) allocate (alone(size(sketch%drawn), 0:most_orders, own%linkage%capacity))
         largest = 0.0_wp
         do block = 1, own%blocks()
            call own%solve_block(block, offset, n)
            if (orders > 0) then
               call differentiate(own, rates, n, most_orders)
               call observe_sketch(sketch, own, rates, n, speed, accel, places(:, :, :n), moved(:, :, :n))
            else
               call find_places(sketch, own, n, places(:, 0, :n), moved(:, 0, :n))
            end if
            study%joints(:, :, offset + 1:offset + n) = places(:size(study%joints, 1), :orders, :n)
            do i = 1, n
               k = offset + i
               if (present(poses)) call take_poses()
               if (.not. closed(k)) cycle
               if (orders > 0) then
                  do loop = 1, own%mechanism%nloop
                     study%dead(k) = study%dead(k) .or. is_dead(own, rates, loop, i)
                  end do
                  largest = [fastest_turn(i), max(maxval(abs(study%joints(:, 1, k))), maxval(abs(moved(:, 1, i))))]
               end if
               call values_of_outputs(outputs, places(:size(study%joints, 1), :, i), moved(:, :, i), largest, numbers)
               study%values(:, :, k) = numbers(:, :orders)
               do order = 1, orders
                  where (study%values(:, 0, k) >= huge(1.0_wp)) study%values(:, order, k) = huge(1.0_wp)
               end do
            end do
            if (size(study%inputs, 1) > 1) call move_one_by_one()
         end do
         if (.not. all(closed)) return
         do k = 1, size(study%names)
            if (study%angles(k)) call unwrap(study%values(k, 0, :))
         end do
      end associate

   contains

      !> What each drive does by itself: first derivatives, radians for degrees.
      subroutine move_one_by_one()
         real(wp) :: values(size(study%names), 0:most_orders)
         integer :: d, o, number

         do d = 1, size(study%inputs, 1)
            call differentiate(own, rates, n, 1, drive=d)
            call observe_sketch(sketch, own, rates, n, 1.0_wp, 0.0_wp, alone(:, :, :n), moved(:, :, :n))
            do i = 1, n
               k = offset + i
               if (.not. closed(k) .or. study%dead(k)) cycle
               largest = 1.0_wp
               call values_of_outputs(set%sketch%outputs, alone(:size(study%joints, 1), :, i), moved(:, :, i), largest, values)
               study%by_drive(:, d, k) = values(:, 1)
            end do
         end do
         ! a ratio of rates is another one for each drive: it has no change with one alone
         number = 0
         do o = 1, size(set%sketch%outputs)
            number = number + columns_of(set%sketch%outputs(o))
            if (set%sketch%outputs(o)%kind == output_ratio) study%by_drive(number, :, :) = huge(1.0_wp)
         end do
      end subroutine move_one_by_one

      !> Poses of the links at position `i` of the block, k of all.
      subroutine take_poses()
         real(wp) :: x, y, c, s, length
         integer :: l, arc

         do l = 1, size(poses%axis)
            if (l == frame_link) cycle
            associate (of => set%sketch%links(l)%joints)
               if (size(of) > 0) then
                  poses%t(l, :, k) = places(of(1), :, i)
               else
                  poses%t(l, :, k) = places(size(study%joints, 1) + l, :, i)
               end if
            end associate
            arc = poses%axis(l)
            if (arc == 0) cycle
            call own%linkage%arc_at(own%plan, arc, i, x, y, length)
            call unit_vector(set%traced%arcs(arc)%direction, c, s)
            poses%phi(l, 0, k) = degrees_of(x*c + y*s, y*c - x*s)*radians_per_degree
            poses%phi(l, 1:, k) = in_time(derivatives_of(rates, own%linkage%root_x(own%plan%root(arc)), i), speed, accel)
         end do
      end subroutine take_poses

      !> The largest rate of any direction by time at a position of the block.
      pure real(wp) function fastest_turn(at)
         integer, intent(in) :: at
         integer :: r

         fastest_turn = 0.0_wp
         do r = 1, size(own%linkage%root_x)
            fastest_turn = max(fastest_turn, abs(rates%d(1)%v(at, own%linkage%root_x(r))*speed))
         end do
      end function fastest_turn
   end subroutine study_sketch

   !> True where rates are among the values of a case: ratios of them, desired ones, what each of several drives does.
   pure logical function has_rates(set, problem)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem

      has_rates = size(set%sketch%drives) > 1 .or. any(set%sketch%outputs%kind == output_ratio) .or. allocated(problem%rate_desired)
      if (allocated(problem%target_values)) then
         associate (columns => set%sketch%target_columns())
            has_rates = has_rates .or. any(columns%order > 0)
         end associate
      end if
   end function has_rates
end module psalm_sketch_study
