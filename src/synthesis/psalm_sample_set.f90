!> Positions at which a search looks at a linkage: output, constraints of the dyads, joints, and their derivatives.
!>
!> A linkage is looked at whether it closes or not. Where a dyad is open its joint lies where the kernels put it, with the
!> root clamped: between the links' ends for two links, at the foot of the perpendicular for link and slide. Everything is
!> continuous across closing, so that a search can cross it and come back. The derivatives are exact where the linkage closes;
!> at open positions they are one-sided differences.
module psalm_station
   use psalm_angles, only: angles_of
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, i8, degrees_per_radian
   use psalm_linkage, only: padded
   use psalm_sensitivity, only: sensitivity_t, prepare_sensitivity, find_jacobian, block_constraints
   use psalm_dimensions, only: dimensions_t
   use psalm_parameters, only: variable_t, variable_length, variable_outlk, variable_origlk, variable_crnki
   use psalm_place, only: beside_t
   implicit none (type, external)
   private
   public :: station_t, prepare_station, evaluate_station, evaluate_output, linearise_station, exceeds

   real(wp), parameter :: small_change = sqrt(epsilon(1.0_wp)) !! relative change of a variable for differences

   !> Positions and what is seen there. The last column of derivatives is that of the input where `timed`.
   type :: station_t
      class(problem_t), allocatable :: problem     !! closure only
      type(sensitivity_t) :: work
      logical :: timed = .false.                   !! every input position is a variable too
      integer :: leading = 0                       !! of the positions: they say on which side of each other two slides are to be;
                                                   !! 0: that is given
      integer :: columns = 0                       !! variables, the input included
      logical, allocatable :: held(:)              !! shape (columns): their derivatives are not wanted, zero; absent: none
      logical :: solved = .false.                  !! what was seen last is still in the linkage: all positions are one block
      logical, allocatable :: closed(:)            !! shape (positions)
      real(wp), allocatable :: out(:, :)           !! shape (positions, components): actual - desired, or
                                                   !! the actual without desired values
      real(wp), allocatable :: k(:, :)             !! shape (positions, nloop): as `block_constraints` has it
      real(wp), allocatable :: measure(:, :)       !! shape (positions, nloop): of the dyads, scaled, where it is wanted
      real(wp), allocatable :: joints(:, :, :)     !! shape (positions, 2, joints): co-ordinates, machine axes
      type(beside_t), allocatable :: beside(:)     !! shape (joints): their lines from points of the plan
      real(wp), allocatable :: dout(:, :, :)       !! shape (positions, columns, components): derivatives of `out`
      real(wp), allocatable :: dk(:, :, :)         !! shape (positions, nloop, columns)
      real(wp), allocatable :: djoints(:, :, :, :) !! shape (positions, 2, joints, columns)
      real(wp), allocatable :: out0(:, :), k0(:, :), joints0(:, :, :) !! the unchanged linkage while differences are taken
      logical, allocatable :: closed0(:)
   end type station_t

contains

   !> Make a station of a problem whose inputs and desired values are set.
   subroutine prepare_station(problem, delt, timed, joints, derivatives, station, beside)
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: delt(:)            !! input increments; those of the problem where it has desired values
      logical, intent(in) :: timed               !! every input position is a variable too
      integer, intent(in) :: joints(:, :)        !! shape (2, joints): loop and arc, as `make_plan` has them
      logical, intent(in) :: derivatives         !! room for derivatives is wanted
      type(station_t), intent(out) :: station
      type(beside_t), intent(in), optional :: beside(:) !! shape (joints): how far from there; absent: not at all
      type(variable_t) :: input
      integer :: n

      n = size(delt)
      allocate (station%problem, source=problem)
      if (allocated(station%problem%linkages)) deallocate (station%problem%linkages)
      station%timed = timed
      if (timed) then
         input%kind = variable_crnki
         station%problem%parameters%variables = [problem%parameters%variables, input]
      end if
      station%columns = size(station%problem%parameters%variables)
      allocate (station%beside(size(joints, 2)))
      if (present(beside)) station%beside = beside
      call station%problem%set_inputs(delt)
      call station%problem%want_derivatives(size(joints, 2) > 0, joints)
      allocate (station%closed(n), station%closed0(n), source=.true.)
      associate (loops => problem%mechanism%nloop, c => merge(station%columns, 0, derivatives), j => size(joints, 2), &
                 components => station%problem%output%kind%components)
         allocate (station%out(n, components), station%k(n, loops), station%joints(n, 2, j), source=0.0_wp)
         station%out0 = station%out
         station%k0 = station%k
         station%joints0 = station%joints
         allocate (station%dout(n, c, components), station%dk(n, loops, c), station%djoints(n, 2, j, c), source=0.0_wp)
      end associate
      if (derivatives) call prepare_sensitivity(station%problem, station%work)
   end subroutine prepare_station

   !> See what a linkage does at every position. No allocation.
   subroutine evaluate_station(station, dimensions)
      type(station_t), intent(inout) :: station
      type(dimensions_t), intent(in) :: dimensions

      call observe(station, dimensions, closing=.true.)
      station%solved = station%problem%blocks() == 1
      if (station%leading > 0) call choose_sides(station)
   end subroutine evaluate_station

   !> See the output of the linkage seen last once more, with other dimensions of the output itself and of the place of the input
   !> pivot (OUTLK, OUTANG, ORIGLK, ORIGNG).
   subroutine evaluate_output(station, dimensions)
      type(station_t), intent(inout) :: station
      type(dimensions_t), intent(in) :: dimensions

      if (.not. station%solved) then
         call evaluate_station(station, dimensions)
         return
      end if
      associate (problem => station%problem)
         call problem%output%bind(dimensions, problem%linkage)
         call note_output(station, 0, problem%positions)
      end associate
   end subroutine evaluate_output

   !> Two slides are to be on the side of each other on which they mostly are at the leading positions.
   pure subroutine choose_sides(station)
      type(station_t), intent(inout) :: station
      integer :: loop

      associate (link => station%problem%linkage)
         do loop = 1, size(link%two_slides)
            if (.not. link%two_slides(loop) .or. link%step_of_loop(loop) == 0) cycle
            if (sum(1.0_wp - station%k(:station%leading, loop)) >= 0.0_wp) cycle
            station%problem%side(loop) = -station%problem%side(loop)
            station%k(:, loop) = 2.0_wp - station%k(:, loop)
            station%solved = .false.
         end do
      end associate
   end subroutine choose_sides

   subroutine observe(station, dimensions, closing)
      type(station_t), intent(inout) :: station
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in) :: closing             !! see where it closes, too
      complex(wp) :: away
      integer :: block, offset, n, m, i, loop, j

      station%solved = .false.
      associate (problem => station%problem)
         call problem%bind(dimensions)
         do block = 1, problem%blocks()
            call problem%solve_block(block, offset, n)
            call note_output(station, offset, n)
            m = padded(n)
            associate (link => problem%linkage)
               call block_constraints(problem, n, station%k(offset + 1:offset + n, :))
               if (allocated(station%measure)) then
                  do loop = 1, problem%mechanism%nloop
                     station%measure(offset + 1:offset + n, loop) = link%store%v(1:n, link%measure(loop))
                  end do
               end if
               if (closing) station%closed(offset + 1:offset + n) = .true.
               do loop = 1, problem%mechanism%nloop
                  if (link%step_of_loop(loop) == 0 .or. .not. closing) cycle
                  if (link%all_accepted(m, loop)) cycle
                  do i = 1, n
                     if (.not. link%closes(i, loop)) station%closed(offset + i) = .false.
                  end do
               end do
               do j = 1, size(problem%plan%joint_points)
                  associate (px => link%point_x(problem%plan%joint_points(j)), py => link%point_y(problem%plan%joint_points(j)))
                     station%joints(offset + 1:offset + n, 1, j) = link%store%v(1:n, px)/link%scale + problem%output%origin_x
                     station%joints(offset + 1:offset + n, 2, j) = link%store%v(1:n, py)/link%scale + problem%output%origin_y
                  end associate
                  if (station%beside(j)%distance <= 0.0_wp) cycle
                  do i = 1, n
                     away = problem%line_beside(station%beside(j), i)
                     station%joints(offset + i, :, j) = station%joints(offset + i, :, j) + [away%re, away%im]
                  end do
               end do
            end associate
         end do
      end associate
   end subroutine observe

   !> Output at the block just solved, its first position that after `offset`.
   subroutine note_output(station, offset, n)
      type(station_t), intent(inout) :: station
      integer, intent(in) :: offset, n
      integer :: c, m

      m = padded(n)
      associate (problem => station%problem, link => station%problem%linkage)
         call problem%output_of(n)
         do c = 1, problem%output%kind%components
            if (problem%desired) then
               associate (first => offset + 1, last => offset + m)
                  call problem%output%miss(c, m, problem%wanted(first:last, c), problem%toward_x(first:last), &
                                           problem%toward_y(first:last), link)
               end associate
               station%out(offset + 1:offset + n, c) = -link%store%v(1:n, link%miss)
            else if (c == problem%output%kind%angle) then
               call angles_of(n, link%store%v(1, link%direction(1)), link%store%v(1, link%direction(2)), &
                              station%out(offset + 1:offset + n, c))
            else
               station%out(offset + 1:offset + n, c) = link%store%v(1:n, link%out(c))
            end if
         end do
      end associate
   end subroutine note_output

   !> See it with all derivatives.
   subroutine linearise_station(station, dimensions, seen, limit)
      type(station_t), intent(inout) :: station
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in), optional :: seen      !! it is the linkage seen last, at the same inputs
      real(wp), intent(in), optional :: limit(:) !! by loop: where no k is beyond, derivatives of k are not wanted
      logical :: beyond(station%problem%mechanism%nloop)
      integer :: loop

      if (present(seen)) then
         if (.not. seen) call evaluate_station(station, dimensions)
      else
         call evaluate_station(station, dimensions)
      end if
      beyond = .true.
      if (present(limit)) beyond = [(exceeds(size(station%k, 1), station%k(:, loop), limit(loop)), loop=1, size(limit))]
      if (any(beyond)) then
         call find_jacobian(station%problem, dimensions, station%work, station%dout, dk=station%dk, dp=station%djoints, &
                            beside=station%beside, solved=station%solved, held=station%held, loops=beyond)
      else
         call find_jacobian(station%problem, dimensions, station%work, station%dout, dp=station%djoints, &
                            beside=station%beside, solved=station%solved, held=station%held)
      end if
      if (.not. all(station%closed)) call difference_open(station, dimensions)
   end subroutine linearise_station

   !> True if any amount exceeds the limit. Counted in integers as wide as reals: it runs in vector registers.
   pure logical function exceeds(n, values, limit)
      integer, intent(in) :: n
      real(wp), intent(in) :: values(n), limit
      integer(i8) :: beyond
      integer :: i

      beyond = 0
      do i = 1, n
         beyond = beyond + merge(1_i8, 0_i8, abs(values(i)) > limit)
      end do
      exceeds = beyond > 0
   end function exceeds

   !> Derivatives at the positions that do not close, by differences.
   subroutine difference_open(station, dimensions)
      type(station_t), intent(inout) :: station
      type(dimensions_t), intent(in) :: dimensions
      type(dimensions_t) :: changed
      real(wp) :: values(station%columns), changed_values(station%columns)
      real(wp) :: step, reach
      integer :: v, i

      station%out0 = station%out
      station%k0 = station%k
      station%joints0 = station%joints
      station%closed0 = station%closed
      reach = maxval(dimensions%arcl)
      changed = dimensions
      values = station%problem%parameters%first_values(dimensions)
      do v = 1, station%columns
         if (allocated(station%held)) then
            if (station%held(v)) cycle
         end if
         associate (kind => station%problem%parameters%variables(v)%kind)
            step = small_change*degrees_per_radian
            if (kind == variable_length .or. kind == variable_outlk .or. kind == variable_origlk) step = small_change*reach
            if (kind == variable_crnki .and. station%problem%mechanism%sliding_input) step = small_change*reach
            changed_values = values
            changed_values(v) = values(v) + step
            call station%problem%parameters%apply(changed_values, changed)
            if (kind == variable_crnki) changed%crnki = dimensions%crnki + step
         end associate
         call observe(station, changed, closing=.false.)
         do i = 1, size(station%closed0)
            if (station%closed0(i)) cycle
            station%dout(i, v, :) = (station%out(i, :) - station%out0(i, :))/step
            station%dk(i, :, v) = (station%k(i, :) - station%k0(i, :))/step
            station%djoints(i, :, :, v) = (station%joints(i, :, :) - station%joints0(i, :, :))/step
         end do
      end do
      station%out = station%out0
      station%k = station%k0
      station%joints = station%joints0
      station%closed = station%closed0
   end subroutine difference_open
end module psalm_station
