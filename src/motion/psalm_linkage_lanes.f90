!> Several linkages of one topology evaluated side by side, where positions are few.
!>
!> Vectors of a processor are as long as a block of positions only where there are many. Here each place of a vector belongs to
!> a linkage of its own (`lanes` of them): rows of the store have the shape (lanes, positions), the numbers of steps and dyads are
!> vectors, and sines and cosines of the inputs are shared. Every linkage meets the same operations in the same order as in
!> `evaluate` and `deviations` of `problem_t`, so that its results have the same bits.
!>
!> What is not done here is evaluated one by one, in the same calls: larger groups, several drives, dyads in their other
!> assembly, more positions than a block has, lengths that must be scaled.
module psalm_linkage_lanes
   use psalm_angles, only: exact_unit_vectors
   use psalm_assur, only: bind_dyad_lanes, solve_dyad_lanes
   use psalm_dimensions, only: dimensions_t
   use psalm_dyad, only: dyad_t
   use psalm_dyad_lanes, only: dyad_lanes_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, i8, right_angle
   use psalm_lanes, only: lanes
   use psalm_linkage, only: bound_step_t, padded, largest_direction, largest_slide
   use psalm_observable, only: output_lanes_t
   use psalm_output_kind, only: motion_angle
   use psalm_parameters, only: parameters_t, variable_crnki, variable_outlk, variable_outang, variable_origlk, variable_origng
   use psalm_plan, only: plan_t, step_point, root_crank
   use psalm_rows, only: rows_t, make_rows
   implicit none (type, external)
   private
   public :: linkage_lanes_t

   integer, parameter :: depth = 24       !! positions at a time; a multiple of `sums`
   integer, parameter :: least = 3        !! fewer linkages take less time one by one
   integer, parameter :: sums = 8         !! partial sums of `evaluate`
   integer, parameter :: together = 4     !! positions whose limits are looked at together: what `padded` pads to a multiple of

   !> Linkages of one topology with room to work in.
   type :: linkage_lanes_t
      logical :: fits = .false.                  !! side by side; otherwise one by one
      ! dimensions, by lane, as those of `dimensions_t`
      real(wp), allocatable :: arcl(:, :), gama(:, :) !! shape (lanes, arcs)
      real(wp) :: outlk(lanes) = 0.0_wp, outang(lanes) = 0.0_wp
      real(wp) :: origlk(lanes) = 0.0_wp, origng(lanes) = 0.0_wp
      real(wp) :: crnki(lanes) = 0.0_wp
      type(dimensions_t), private :: one         !! a linkage that is evaluated by itself
      ! what follows from them
      real(wp), allocatable, private :: angle(:, :), x(:, :), y(:, :) !! shape (lanes, places): arcs, crank, output arc, pivot;
                                                 !! degrees from the root, cosine, sine
      real(wp), allocatable, private :: new_angle(:, :), new_x(:, :), new_y(:, :) !! the same shape: of those that have changed
      integer, allocatable, private :: changed(:) !! their places
      real(wp), allocatable, private :: step_x(:, :), step_y(:, :) !! shape (lanes, steps): point: the arc in the axes of its root
      type(dyad_lanes_t), allocatable, private :: dyads(:) !! by step
      real(wp), private :: reference_length(lanes) = 0.0_wp
      type(output_lanes_t), private :: output
      type(rows_t), private :: store
      real(wp), allocatable, private :: part(:, :, :) !! shape (lanes, sums, components)
      integer, private :: failed(lanes) = 0      !! the first step that is not accepted everywhere; past the last: none
      logical, allocatable, private :: left(:, :), right(:, :) !! shape (lanes, nloop): sides two slides were on of each other
   contains
      procedure :: prepare
      procedure :: put
      procedure :: put_values
      procedure :: evaluate
      procedure :: deviations
   end type linkage_lanes_t

contains

   !> Make room for linkages of a problem whose inputs and desired values are set; until others are put in, all are that given.
   subroutine prepare(self, problem)
      class(linkage_lanes_t), intent(out) :: self
      class(problem_t), intent(in) :: problem
      integer :: k, l

      associate (link => problem%linkage, arcs => size(problem%given%arcl), steps => size(problem%linkage%steps))
         self%one = problem%given
         allocate (self%arcl(lanes, arcs), self%gama(lanes, arcs))
         do l = 1, lanes
            call self%put(l, problem%given)
         end do
         self%fits = problem%blocks() == 1 .and. size(link%seconds) == 0 .and. .not. allocated(problem%turned) .and. &
                     .not. any([(allocated(link%steps(k)%dyad%higher), k=1, steps)])
         if (.not. self%fits) return
         allocate (self%angle(lanes, arcs + 3), self%y(lanes, arcs + 3), source=0.0_wp)
         allocate (self%x(lanes, arcs + 3), source=1.0_wp)
         self%new_angle = self%angle
         self%new_x = self%angle
         self%new_y = self%angle
         allocate (self%changed(arcs + 3), source=0)
         allocate (self%step_x(lanes, steps), self%step_y(lanes, steps), source=0.0_wp)
         allocate (self%dyads(steps))
         call make_rows(lanes*depth, size(link%store%v, 2), self%store)
         do k = 1, size(link%root_x)
            self%store%v(:, link%root_x(k)) = 1.0_wp
         end do
         allocate (self%part(lanes, sums, problem%output%kind%components), source=0.0_wp)
         allocate (self%left(lanes, problem%mechanism%nloop), self%right(lanes, problem%mechanism%nloop), source=.false.)
      end associate
   end subroutine prepare

   !> Put the dimensions of a linkage into a lane.
   pure subroutine put(self, lane, dimensions)
      class(linkage_lanes_t), intent(inout) :: self
      integer, intent(in) :: lane
      type(dimensions_t), intent(in) :: dimensions

      self%arcl(lane, :) = dimensions%arcl
      self%gama(lane, :) = dimensions%gama
      self%outlk(lane) = dimensions%outlk
      self%outang(lane) = dimensions%outang
      self%origlk(lane) = dimensions%origlk
      self%origng(lane) = dimensions%origng
      self%crnki(lane) = dimensions%crnki
   end subroutine put

   !> Put values of variables into all lanes, as `apply` of `parameters_t` puts them into dimensions; joints beside arcs, which move
   !> no arc, are left out.
   pure subroutine put_values(self, parameters, values)
      class(linkage_lanes_t), intent(inout) :: self
      type(parameters_t), intent(in) :: parameters
      real(wp), intent(in), contiguous :: values(:, :) !! shape (lanes, nvar)
      integer :: v

      do v = 1, size(parameters%variables)
         select case (parameters%variables(v)%kind)
         case (variable_outlk)
            self%outlk = values(:, v)
         case (variable_outang)
            self%outang = values(:, v)
         case (variable_origlk)
            self%origlk = values(:, v)
         case (variable_origng)
            self%origng = values(:, v)
         case (variable_crnki)
            self%crnki = values(:, v)
         end select
      end do
      call put_arcs(size(self%arcl, 2), size(values, 2), parameters, values, self%arcl, self%gama)
   end subroutine put_values

   pure subroutine put_arcs(arcs, nvar, parameters, values, arcl, gama)
      integer, intent(in) :: arcs, nvar
      type(parameters_t), intent(in) :: parameters
      real(wp), intent(in) :: values(lanes, nvar)
      real(wp), intent(inout) :: arcl(lanes, arcs), gama(lanes, arcs)
      integer :: n

      do n = 1, arcs
         if (parameters%length_variable(n) > 0) arcl(:, n) = values(:, parameters%length_variable(n))
         if (parameters%angle_variable(n) > 0 .and. parameters%takes_angle(n)) gama(:, n) = values(:, parameters%angle_variable(n))
      end do
   end subroutine put_arcs

   !> Objectives of the linkages in the first lanes, as `evaluate` of `problem_t` has them one by one.
   subroutine evaluate(self, problem, objective, loop)
      class(linkage_lanes_t), intent(inout) :: self
      class(problem_t), intent(inout) :: problem   !! the one it was prepared for
      real(wp), intent(out) :: objective(:)        !! shape (at most lanes)
      integer, intent(out) :: loop(:)              !! the same shape; 0: none
      integer :: l, k, c
      real(wp) :: of_all(lanes)

      if (is_single(self, problem, size(objective))) then
         do l = 1, size(objective)
            call take_out(self, l)
            call problem%evaluate(self%one, objective(l), loop(l))
         end do
         return
      end if
      call bind(self, problem)
      self%part = 0.0_wp
      call solve(self, problem, size(objective), .true.)
      of_all = 0.0_wp
      do c = 1, size(self%part, 3)
         call add_up(self%part(1, 1, c), of_all)
      end do
      do l = 1, size(objective)
         loop(l) = loop_of(self, problem, l)
         objective(l) = of_all(l)
         if (loop(l) > 0) then
            objective(l) = 0.0_wp
            cycle
         end if
         do k = size(self%left, 2), 1, -1
            if (self%left(l, k) .and. self%right(l, k)) loop(l) = k
         end do
      end do
   end subroutine evaluate

   !> Deviations of the linkages in the first lanes, as `deviations` of `problem_t` has them one by one.
   subroutine deviations(self, problem, miss, loop)
      class(linkage_lanes_t), intent(inout) :: self
      class(problem_t), intent(inout) :: problem   !! the one it was prepared for
      real(wp), intent(inout) :: miss(:, :, :)     !! shape (positions, components, at most lanes); where a linkage closes
      integer, intent(out) :: loop(:)              !! shape (at most lanes)
      integer :: l

      if (is_single(self, problem, size(loop))) then
         do l = 1, size(loop)
            call take_out(self, l)
            call problem%deviations(self%one, miss(:, :, l), loop(l))
         end do
         return
      end if
      call bind(self, problem)
      call solve(self, problem, size(loop), .false., miss)
      do l = 1, size(loop)
         loop(l) = loop_of(self, problem, l)
      end do
   end subroutine deviations

   !> True if the linkages must be evaluated one by one.
   pure logical function is_single(self, problem, count)
      type(linkage_lanes_t), intent(in) :: self
      class(problem_t), intent(in) :: problem
      integer, intent(in) :: count
      real(wp) :: largest(lanes)
      integer :: l

      is_single = .not. self%fits .or. count < least
      if (is_single) return
      call find_largest(size(self%arcl, 2), self%arcl, largest)
      do l = 1, lanes
         is_single = is_single .or. .not. problem%linkage%is_plain(largest(l), self%crnki(l))
      end do
   end function is_single

   pure subroutine find_largest(arcs, arcl, largest)
      integer, intent(in) :: arcs
      real(wp), intent(in) :: arcl(lanes, arcs)
      real(wp), intent(out) :: largest(lanes)
      integer :: n

      largest = arcl(:, 1)
      do n = 2, arcs
         largest = max(largest, arcl(:, n))
      end do
   end subroutine find_largest

   !> The linkage of a lane as dimensions.
   pure subroutine take_out(self, lane)
      type(linkage_lanes_t), intent(inout) :: self
      integer, intent(in) :: lane

      self%one%arcl = self%arcl(lane, :)
      self%one%gama = self%gama(lane, :)
      self%one%outlk = self%outlk(lane)
      self%one%outang = self%outang(lane)
      self%one%origlk = self%origlk(lane)
      self%one%origng = self%origng(lane)
      self%one%crnki = self%crnki(lane)
   end subroutine take_out

   !> The loop of the first step of a lane that is not accepted; 0: none.
   pure integer function loop_of(self, problem, lane)
      type(linkage_lanes_t), intent(in) :: self
      class(problem_t), intent(in) :: problem
      integer, intent(in) :: lane

      loop_of = 0
      if (self%failed(lane) <= size(problem%linkage%steps)) loop_of = problem%linkage%steps(self%failed(lane))%loop
   end function loop_of

   ! ---- numbers -----------------------------------------------------------------------------------------------------

   !> Put the dimensions in, as `bind` of `linkage_t` and `observable_t`.
   pure subroutine bind(self, problem)
      type(linkage_lanes_t), intent(inout) :: self
      class(problem_t), intent(in) :: problem
      integer :: k, count

      associate (arcs => size(self%arcl, 2), places => size(self%angle, 2), filled => padded(min(depth, problem%positions)))
         call find_angles(arcs, places, problem, self%gama, self%crnki, self%outang, self%origng, self%angle, count, self%changed, &
                          self%new_angle)
         call exact_unit_vectors(lanes*count, self%new_angle, self%new_x, self%new_y)
         call put_angles(places, problem%plan, count, self%changed, self%new_x, self%new_y, self%x, self%y)
         if (problem%mechanism%sliding_input) then
            self%reference_length = self%crnki
            if (problem%mechanism%floating_input) &
               self%reference_length = self%crnki + self%arcl(:, problem%mechanism%actuators(1)%arc)
         end if
         do k = 1, size(problem%linkage%steps)
            associate (step => problem%linkage%steps(k))
               if (step%kind == step_point) then
                  call bind_point(step, self%x(1, step%arc), self%y(1, step%arc), self%arcl(1, step%arc), self%step_x(1, k), &
                                  self%step_y(1, k))
                  if (step%maker > 0) call copy(self%step_x(1, k), self%step_y(1, k), self%dyads(step%maker)%tip_x, &
                                                self%dyads(step%maker)%tip_y)
                  if (.not. step%fixed) cycle
                  associate (v => self%store%v)
                     call fill(filled, v(1, step%from_x), self%step_x(1, k), v(1, step%to_x))
                     call fill(filled, v(1, step%from_y), self%step_y(1, k), v(1, step%to_y))
                  end associate
               else
                  associate (of => self%dyads(k), p => step%dyad%arc_p, q => step%dyad%arc_q)
                     call copy(self%arcl(1, p), self%arcl(1, q), of%p, of%q)
                     call copy(self%x(1, p), self%y(1, p), of%px, of%py)
                     call copy(self%x(1, q), self%y(1, q), of%qx, of%qy)
                     call bind_dyad_lanes(step%dyad, problem%linkage%cosine_lowest, problem%linkage%sine_lowest, &
                                          problem%linkage%toggle, of)
                  end associate
               end if
            end associate
         end do
         call copy(self%x(1, places - 1), self%y(1, places - 1), self%output%c, self%output%s)
         call copy(self%x(1, places), self%y(1, places), self%output%origin_x, self%output%origin_y)
      end associate
      self%output%length = self%outlk
      self%output%origin_x = self%origlk*self%output%origin_x
      self%output%origin_y = self%origlk*self%output%origin_y
   end subroutine bind

   !> Angles of arcs, crank, output arc and pivot; those that have changed in any lane, which need new sines and cosines.
   pure subroutine find_angles(arcs, places, problem, gama, crnki, outang, origng, angle, count, changed, new)
      integer, intent(in) :: arcs, places
      class(problem_t), intent(in) :: problem
      real(wp), intent(in) :: gama(lanes, arcs), crnki(lanes), outang(lanes), origng(lanes)
      real(wp), intent(inout) :: angle(lanes, places)
      integer, intent(out) :: count
      integer, intent(inout) :: changed(places)      !! the first `count`: places
      real(wp), intent(inout) :: new(lanes, places)  !! their angles
      integer :: k, n, b

      count = 0
      associate (plan => problem%plan)
         do k = 1, size(plan%order)
            n = plan%order(k)
            b = plan%base(n)
            if (plan%takes_gama(n)) then
               if (b > 0) then
                  call note_angle(n, gama(:, n) + angle(:, b), angle(1, n), count, changed, new)
               else
                  call note_angle(n, gama(1, n), angle(1, n), count, changed, new)
               end if
            else if (b > 0) then
               angle(:, n) = angle(:, b) + right_angle*real(plan%quarter(n), wp)
            end if
         end do
      end associate
      if (.not. problem%mechanism%sliding_input) call note_angle(arcs + 1, crnki, angle(1, arcs + 1), count, changed, new)
      call note_angle(arcs + 2, angle(:, problem%output%arc) + outang, angle(1, arcs + 2), count, changed, new)
      call note_angle(arcs + 3, origng, angle(1, arcs + 3), count, changed, new)
   end subroutine find_angles

   !> Enter angles of a place among those that need new sines and cosines, unless none has changed.
   pure subroutine note_angle(place, given, angle, count, changed, new)
      integer, intent(in) :: place
      real(wp), intent(in) :: given(lanes)
      real(wp), intent(inout) :: angle(lanes)
      integer, intent(inout) :: count, changed(:)
      real(wp), intent(inout) :: new(lanes, *)
      integer(i8) :: others
      integer :: l

      others = 0_i8
      do l = 1, lanes
         others = others + merge(0_i8, 1_i8, given(l) == angle(l))
      end do
      if (others == 0_i8) return
      count = count + 1
      changed(count) = place
      angle = given
      new(:, count) = given
   end subroutine note_angle

   !> Sines and cosines that are new, and those of arcs at right angles to others.
   pure subroutine put_angles(places, plan, count, changed, new_x, new_y, x, y)
      integer, intent(in) :: places, count, changed(places)
      type(plan_t), intent(in) :: plan
      real(wp), intent(in) :: new_x(lanes, places), new_y(lanes, places)
      real(wp), intent(inout) :: x(lanes, places), y(lanes, places)
      integer :: k, n, b

      do k = 1, count
         x(:, changed(k)) = new_x(:, k)
         y(:, changed(k)) = new_y(:, k)
      end do
      do k = 1, size(plan%order)
         n = plan%order(k)
         b = plan%base(n)
         if (plan%takes_gama(n) .or. b == 0) cycle
         select case (plan%quarter(n))
         case (1)
            x(:, n) = -y(:, b)
            y(:, n) = x(:, b)
         case (-1)
            x(:, n) = y(:, b)
            y(:, n) = -x(:, b)
         case default
            x(:, n) = x(:, b)
            y(:, n) = y(:, b)
         end select
      end do
   end subroutine put_angles

   !> The arc of a point in the axes of its root.
   pure subroutine bind_point(step, arc_x, arc_y, length, x, y)
      type(bound_step_t), intent(in) :: step
      real(wp), intent(in) :: arc_x(lanes), arc_y(lanes), length(lanes)
      real(wp), intent(out) :: x(lanes), y(lanes)

      x = step%sign*arc_x
      y = step%sign*arc_y
      if (step%slide_row > 0) return
      x = x*length
      y = y*length
   end subroutine bind_point

   pure subroutine copy(x, y, to_x, to_y)
      real(wp), intent(in) :: x(lanes), y(lanes)
      real(wp), intent(out) :: to_x(lanes), to_y(lanes)

      to_x = x
      to_y = y
   end subroutine copy

   !> from + along at every position; `from` is the same at all of them.
   pure subroutine fill(n, from, along, to)
      integer, intent(in) :: n
      real(wp), intent(in) :: from(lanes, n), along(lanes)
      real(wp), intent(out) :: to(lanes, n)
      real(wp) :: there(lanes)
      integer :: i

      there = from(:, 1) + along
      do i = 1, n
         to(:, i) = there
      end do
   end subroutine fill

   ! ---- positions ---------------------------------------------------------------------------------------------------

   !> Go through the positions: steps that fail, and with `weighed` partial sums of the objective, else deviations.
   subroutine solve(self, problem, count, weighed, miss)
      type(linkage_lanes_t), intent(inout) :: self
      class(problem_t), intent(in) :: problem
      integer, intent(in) :: count                   !! lanes that are looked at
      logical, intent(in) :: weighed
      real(wp), intent(inout), optional :: miss(:, :, :) !! as `deviations` has it
      integer :: offset, n, m, c, steps, last

      steps = size(problem%linkage%steps)
      self%failed = steps + 1
      if (weighed .and. any(problem%linkage%two_slides)) then
         self%left = .false.
         self%right = .false.
      end if
      last = steps
      do offset = 0, problem%positions - 1, depth
         m = min(depth, problem%positions - offset)
         n = padded(m)
         call solve_some(self, problem, offset, n, last)
         ! past the first steps that fail nothing is needed
         last = min(steps, maxval(self%failed(:count)))
         if (all(self%failed(:count) <= steps)) cycle
         if (weighed .and. any(problem%linkage%two_slides)) call note_sides(self, problem, n)
         if (problem%motion /= motion_angle) call problem%output%observe_lanes(n, self%output, problem%linkage, self%store)
         do c = 1, problem%output%kind%components
            associate (first => offset + 1, until => offset + n, row => problem%linkage%miss)
               call problem%output%miss_lanes(c, n, self%output, problem%wanted(first:until, c), problem%toward_x(first:until), &
                                              problem%toward_y(first:until), problem%linkage, self%store)
               if (weighed) then
                  call add_squares(n, self%store%v(1, row), problem%weight(first:until, c), self%part(1, 1, c))
               else
                  call turn_over(m, self%store%v(1, row), miss(first:offset + m, c, :))
               end if
            end associate
         end do
      end do
   end subroutine solve

   !> The positions offset+1 ... offset+n, padded, through the steps up to `last`.
   pure subroutine solve_some(self, problem, offset, n, last)
      type(linkage_lanes_t), intent(inout) :: self
      class(problem_t), intent(in) :: problem
      integer, intent(in) :: offset, n, last
      integer(i8) :: outside(lanes)
      integer :: k, l

      associate (link => problem%linkage, v => self%store%v, crank => size(self%arcl, 2) + 1, first => offset + 1, &
                 until => offset + n)
         if (.not. link%sliding_input) then
            call turn_crank(n, problem%first(first:until), problem%second(first:until), self%x(:, crank), self%y(:, crank), &
                            v(1, link%root_x(root_crank)), v(1, link%root_y(root_crank)))
         else if (link%input_slot > 0) then
            call add_to_length(n, self%reference_length, problem%first(first:until), v(1, link%slide(link%input_slot)))
         end if
         do k = 1, last
            associate (step => link%steps(k))
               if (step%kind == step_point) then
                  if (step%fixed .or. step%maker > 0) cycle
                  if (step%slide_row == 0) then
                     call add_arc(n, v(1, step%from_x), v(1, step%from_y), v(1, step%root_x), v(1, step%root_y), &
                                  self%step_x(:, k), self%step_y(:, k), v(1, step%to_x), v(1, step%to_y))
                  else
                     call add_slide(n, v(1, step%from_x), v(1, step%from_y), v(1, step%root_x), v(1, step%root_y), &
                                    v(1, step%slide_row), self%step_x(:, k), self%step_y(:, k), v(1, step%to_x), v(1, step%to_y))
                  end if
                  cycle
               end if
               call solve_dyad_lanes(n, step%dyad, self%dyads(k), self%store)
               call find_outside(n, v(1, step%dyad%measure), self%dyads(k)%accepts_low, self%dyads(k)%accepts_high, &
                                 link%two_slides(step%loop), outside)
               if (sum(outside) == 0_i8) cycle
               do l = 1, lanes
                  if (outside(l) > 0_i8) self%failed(l) = min(self%failed(l), k)
               end do
               call limit_dyad(n, outside > 0_i8, step%dyad, self%store)
            end associate
         end do
      end associate
   end subroutine solve_some

   !> Where a dyad is open its arcs may be found endless: the dyads after it could not work with that.
   pure subroutine limit_dyad(n, open, dyad, store)
      integer, intent(in) :: n
      logical, intent(in) :: open(lanes)
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(inout) :: store

      associate (v => store%v)
         call limit(n, open, largest_direction, v(1, dyad%p_x))
         call limit(n, open, largest_direction, v(1, dyad%p_y))
         call limit(n, open, largest_direction, v(1, dyad%q_x))
         call limit(n, open, largest_direction, v(1, dyad%q_y))
         if (dyad%slide_p > 0) call limit(n, open, largest_slide, v(1, dyad%slide_p))
         if (dyad%slide_q > 0) call limit(n, open, largest_slide, v(1, dyad%slide_q))
         if (dyad%tip%to_x == 0) return
         call limit(n, open, largest_slide, v(1, dyad%tip%to_x))
         call limit(n, open, largest_slide, v(1, dyad%tip%to_y))
      end associate
   end subroutine limit_dyad

   pure subroutine limit(n, open, largest, row)
      integer, intent(in) :: n
      logical, intent(in) :: open(lanes)
      real(wp), intent(in) :: largest
      real(wp), intent(inout) :: row(lanes, n)
      integer :: l

      do l = 1, lanes
         if (open(l)) row(l, :) = min(max(row(l, :), -largest), largest)
      end do
   end subroutine limit

   !> Remember on which side of each other two slides are, of linkages that are accepted so far.
   pure subroutine note_sides(self, problem, n)
      type(linkage_lanes_t), intent(inout) :: self
      class(problem_t), intent(in) :: problem
      integer, intent(in) :: n
      integer :: loop

      associate (link => problem%linkage)
         do loop = 1, size(link%two_slides)
            if (.not. link%two_slides(loop) .or. link%step_of_loop(loop) == 0) cycle
            call look(n, self%store%v(1, link%measure(loop)), self%left(:, loop), self%right(:, loop))
         end do
      end associate

   contains

      pure subroutine look(n, measure, left, right)
         integer, intent(in) :: n
         real(wp), intent(in) :: measure(lanes, n)
         logical, intent(inout) :: left(lanes), right(lanes)

         left = left .or. any(measure > 0.0_wp, dim=2)
         right = right .or. any(.not. measure > 0.0_wp, dim=2)
      end subroutine look
   end subroutine note_sides

   ! ---- kernels -----------------------------------------------------------------------------------------------------

   !> Unit vectors of the cranks: the increment's, turned by the reference angle of each.
   pure subroutine turn_crank(n, first, second, x, y, rx, ry)
      integer, intent(in) :: n
      real(wp), intent(in) :: first(n), second(n), x(lanes), y(lanes)
      real(wp), intent(out) :: rx(lanes, n), ry(lanes, n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            rx(l, i) = x(l)*first(i) - y(l)*second(i)
            ry(l, i) = y(l)*first(i) + x(l)*second(i)
         end do
      end do
   end subroutine turn_crank

   pure subroutine add_to_length(n, reference, increment, length)
      integer, intent(in) :: n
      real(wp), intent(in) :: reference(lanes), increment(n)
      real(wp), intent(out) :: length(lanes, n)
      integer :: i

      do i = 1, n
         length(:, i) = reference + increment(i)
      end do
   end subroutine add_to_length

   !> Points at the other end of an arc of fixed length.
   pure subroutine add_arc(n, fx, fy, rx, ry, ax, ay, tx, ty)
      integer, intent(in) :: n
      real(wp), intent(in) :: fx(lanes, n), fy(lanes, n), rx(lanes, n), ry(lanes, n), ax(lanes), ay(lanes)
      real(wp), intent(out) :: tx(lanes, n), ty(lanes, n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            tx(l, i) = fx(l, i) + (ax(l)*rx(l, i) - ay(l)*ry(l, i))
            ty(l, i) = fy(l, i) + (ax(l)*ry(l, i) + ay(l)*rx(l, i))
         end do
      end do
   end subroutine add_arc

   !> Points at the other end of an arc of varying length.
   pure subroutine add_slide(n, fx, fy, rx, ry, length, ax, ay, tx, ty)
      integer, intent(in) :: n
      real(wp), intent(in) :: fx(lanes, n), fy(lanes, n), rx(lanes, n), ry(lanes, n), length(lanes, n), ax(lanes), ay(lanes)
      real(wp), intent(out) :: tx(lanes, n), ty(lanes, n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            tx(l, i) = fx(l, i) + length(l, i)*(ax(l)*rx(l, i) - ay(l)*ry(l, i))
            ty(l, i) = fy(l, i) + length(l, i)*(ax(l)*ry(l, i) + ay(l)*rx(l, i))
         end do
      end do
   end subroutine add_slide

   !> How often the measure of each linkage, of two slides its amount, is outside its limits.
   pure subroutine find_outside(n, measure, low, high, two_slides, outside)
      integer, intent(in) :: n                       !! a multiple of `together`
      real(wp), intent(in) :: measure(lanes, n), low(lanes), high(lanes)
      logical, intent(in) :: two_slides
      integer(i8), intent(out) :: outside(lanes)
      integer :: i, l

      outside = 0_i8
      if (two_slides) then
         do i = 1, n, together
            !$omp simd
            do l = 1, lanes
               outside(l) = outside(l) + ((below(abs(measure(l, i)), low(l)) + below(abs(measure(l, i + 1)), low(l))) &
                                          + (below(abs(measure(l, i + 2)), low(l)) + below(abs(measure(l, i + 3)), low(l))))
            end do
         end do
      else
         do i = 1, n, together
            !$omp simd
            do l = 1, lanes
               outside(l) = outside(l) + ((below(measure(l, i), low(l)) + below(measure(l, i + 1), low(l))) &
                                          + (below(measure(l, i + 2), low(l)) + below(measure(l, i + 3), low(l)))) &
                            + ((below(high(l), measure(l, i)) + below(high(l), measure(l, i + 1))) &
                               + (below(high(l), measure(l, i + 2)) + below(high(l), measure(l, i + 3))))
            end do
         end do
      end if
   end subroutine find_outside

   !> 1 if a < b, else 0; in an integer as wide as reals it stays in a vector.
   elemental integer(i8) function below(a, b)
      real(wp), intent(in) :: a, b

      below = merge(1_i8, 0_i8, a < b)
   end function below

   !> Squared errors, weighed: position i of a block goes into the partial sum that it has in `evaluate` of `problem_t`, in the same
   !> order; the positions begin where a partial sum does.
   pure subroutine add_squares(n, error, weight, part)
      integer, intent(in) :: n
      real(wp), intent(in) :: error(lanes, n), weight(n)
      real(wp), intent(inout) :: part(lanes, sums)
      integer :: i, l

      do i = 1, n
         associate (of => modulo(i - 1, sums) + 1)
            !$omp simd
            do l = 1, lanes
               part(l, of) = part(l, of) + weight(i)*error(l, i)**2
            end do
         end associate
      end do
   end subroutine add_squares

   !> Partial sums, added to a total.
   pure subroutine add_up(part, total)
      real(wp), intent(in) :: part(lanes, sums)
      real(wp), intent(inout) :: total(lanes)

      total = total + (((part(:, 1) + part(:, 2)) + (part(:, 3) + part(:, 4))) &
                       + ((part(:, 5) + part(:, 6)) + (part(:, 7) + part(:, 8))))
   end subroutine add_up

   !> Actual less desired, linkage by linkage.
   pure subroutine turn_over(n, error, miss)
      integer, intent(in) :: n
      real(wp), intent(in) :: error(lanes, n)
      real(wp), intent(inout) :: miss(:, :)          !! shape (n, at most lanes)
      integer :: l

      do l = 1, size(miss, 2)
         miss(:, l) = -error(l, :)
      end do
   end subroutine turn_over
end module psalm_linkage_lanes
