!> Positions at which a search looks at a linkage: output, constraints of the dyads, joints, and their derivatives.
!>
!> A linkage is looked at whether it closes or not. Where a dyad is open its joint lies where the kernels put it, with the
!> root clamped: between the links' ends for two links, at the foot of the perpendicular for link and slide. Everything is
!> continuous across closing, so that a search can cross it and come back. The derivatives are exact where the linkage closes;
!> at open positions they are one-sided differences.
module psalm_samples
   use psalm_angles, only: angles_of
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, i8, degrees_per_radian
   use psalm_linkage, only: padded
   use psalm_sensitivity, only: sensitivity_t, prepare_sensitivity, find_jacobian, block_constraints
   use psalm_dimensions, only: dimensions_t
   use psalm_parameters, only: variable_t, variable_aside, variable_length, variable_outlk, variable_origlk, variable_crnki
   use psalm_place, only: beside_t
   implicit none (type, external)
   private
   public :: sample_set_t, prepare_samples, evaluate_samples, evaluate_output, linearise_samples, exceeds

   real(wp), parameter :: small_change = sqrt(epsilon(1.0_wp)) !! relative change of a variable for differences

   !> Positions and what is seen there. The last column of derivatives is that of the input where `timed`.
   type :: sample_set_t
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
      real(wp), allocatable :: joints(:, :, :)     !! shape (positions, 2, joints): coordinates, machine axes
      type(beside_t), allocatable :: beside(:)     !! shape (joints): their lines from points of the plan
      real(wp), allocatable :: dout(:, :, :)       !! shape (positions, columns, components): derivatives of `out`
      real(wp), allocatable :: dk(:, :, :)         !! shape (positions, nloop, columns)
      real(wp), allocatable :: djoints(:, :, :, :) !! shape (positions, 2, joints, columns)
      real(wp), allocatable :: out0(:, :), k0(:, :), joints0(:, :, :) !! the unchanged linkage while differences are taken
      logical, allocatable :: closed0(:)
   end type sample_set_t

contains

   !> Make a set of samples of a problem whose inputs and desired values are set.
   subroutine prepare_samples(problem, delt, timed, joints, derivatives, samples, beside)
      type(problem_t), intent(in) :: problem
      real(wp), intent(in) :: delt(:)            !! input increments; those of the problem where it has desired values
      logical, intent(in) :: timed               !! every input position is a variable too
      integer, intent(in) :: joints(:, :)        !! shape (2, joints): loop and arc, as `make_plan` has them
      logical, intent(in) :: derivatives         !! room for derivatives is wanted
      type(sample_set_t), intent(out) :: samples
      type(beside_t), intent(in), optional :: beside(:) !! shape (joints): how far from there; absent: not at all
      type(variable_t) :: input
      integer :: n

      n = size(delt)
      allocate (samples%problem, source=problem)
      if (allocated(samples%problem%linkages)) deallocate (samples%problem%linkages)
      samples%timed = timed
      if (timed) then
         input%kind = variable_crnki
         samples%problem%parameters%variables = [problem%parameters%variables, input]
      end if
      samples%columns = size(samples%problem%parameters%variables)
      allocate (samples%beside(size(joints, 2)))
      if (present(beside)) samples%beside = beside
      call samples%problem%set_inputs(delt)
      call samples%problem%want_derivatives(size(joints, 2) > 0, joints)
      allocate (samples%closed(n), samples%closed0(n), source=.true.)
      associate (loops => problem%mechanism%nloop, c => merge(samples%columns, 0, derivatives), j => size(joints, 2), &
                 components => samples%problem%output%kind%components)
         allocate (samples%out(n, components), samples%k(n, loops), samples%joints(n, 2, j), source=0.0_wp)
         samples%out0 = samples%out
         samples%k0 = samples%k
         samples%joints0 = samples%joints
         allocate (samples%dout(n, c, components), samples%dk(n, loops, c), samples%djoints(n, 2, j, c), source=0.0_wp)
      end associate
      if (derivatives) call prepare_sensitivity(samples%problem, samples%work)
   end subroutine prepare_samples

   !> See what a linkage does at every position. No allocation.
   subroutine evaluate_samples(samples, dimensions)
      type(sample_set_t), intent(inout) :: samples
      type(dimensions_t), intent(in) :: dimensions

      call observe(samples, dimensions, closing=.true.)
      samples%solved = samples%problem%blocks() == 1
      if (samples%leading > 0) call choose_sides(samples)
   end subroutine evaluate_samples

   !> See the output of the linkage seen last once more, with other dimensions of the output itself and of the place of the input
   !> pivot (OUTLK, OUTANG, ORIGLK, ORIGNG).
   subroutine evaluate_output(samples, dimensions)
      type(sample_set_t), intent(inout) :: samples
      type(dimensions_t), intent(in) :: dimensions

      if (.not. samples%solved) then
         call evaluate_samples(samples, dimensions)
         return
      end if
      associate (problem => samples%problem)
         call problem%output%bind(dimensions, problem%linkage)
         call note_output(samples, 0, problem%positions)
      end associate
   end subroutine evaluate_output

   !> Two slides are to be on the side of each other on which they mostly are at the leading positions.
   pure subroutine choose_sides(samples)
      type(sample_set_t), intent(inout) :: samples
      integer :: loop

      associate (link => samples%problem%linkage)
         do loop = 1, size(link%two_slides)
            if (.not. link%two_slides(loop) .or. link%step_of_loop(loop) == 0) cycle
            if (sum(1.0_wp - samples%k(:samples%leading, loop)) >= 0.0_wp) cycle
            samples%problem%side(loop) = -samples%problem%side(loop)
            samples%k(:, loop) = 2.0_wp - samples%k(:, loop)
            samples%solved = .false.
         end do
      end associate
   end subroutine choose_sides

   subroutine observe(samples, dimensions, closing)
      type(sample_set_t), intent(inout) :: samples
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in) :: closing             !! see where it closes, too
      complex(wp) :: away
      integer :: block, offset, n, m, i, loop, j

      samples%solved = .false.
      call dimensions%put_aside(samples%beside)
      associate (problem => samples%problem)
         call problem%bind(dimensions)
         do block = 1, problem%blocks()
            call problem%solve_block(block, offset, n)
            call note_output(samples, offset, n)
            m = padded(n)
            associate (link => problem%linkage)
               call block_constraints(problem, n, samples%k(offset + 1:offset + n, :))
               if (allocated(samples%measure)) then
                  do loop = 1, problem%mechanism%nloop
                     samples%measure(offset + 1:offset + n, loop) = link%store%v(1:n, link%measure(loop))
                  end do
               end if
               if (closing) samples%closed(offset + 1:offset + n) = .true.
               do loop = 1, problem%mechanism%nloop
                  if (link%step_of_loop(loop) == 0 .or. .not. closing) cycle
                  if (link%all_accepted(m, loop)) cycle
                  do i = 1, n
                     if (.not. link%closes(i, loop)) samples%closed(offset + i) = .false.
                  end do
               end do
               do j = 1, size(problem%plan%joint_points)
                  associate (px => link%point_x(problem%plan%joint_points(j)), py => link%point_y(problem%plan%joint_points(j)))
                     samples%joints(offset + 1:offset + n, 1, j) = link%store%v(1:n, px)/link%scale + problem%output%origin_x
                     samples%joints(offset + 1:offset + n, 2, j) = link%store%v(1:n, py)/link%scale + problem%output%origin_y
                  end associate
                  if (samples%beside(j)%distance <= 0.0_wp) cycle
                  do i = 1, n
                     away = problem%line_beside(samples%beside(j), i)
                     samples%joints(offset + i, :, j) = samples%joints(offset + i, :, j) + [away%re, away%im]
                  end do
               end do
            end associate
         end do
      end associate
   end subroutine observe

   !> Output at the block just solved, its first position that after `offset`.
   subroutine note_output(samples, offset, n)
      type(sample_set_t), intent(inout) :: samples
      integer, intent(in) :: offset, n
      integer :: c, m

      m = padded(n)
      associate (problem => samples%problem, link => samples%problem%linkage)
         call problem%output_of(n)
         do c = 1, problem%output%kind%components
            if (problem%desired) then
               associate (first => offset + 1, last => offset + m)
                  call problem%output%miss(c, m, problem%wanted(first:last, c), problem%toward_x(first:last), &
                                           problem%toward_y(first:last), link)
               end associate
               samples%out(offset + 1:offset + n, c) = -link%store%v(1:n, link%miss)
            else if (c == problem%output%kind%angle) then
               call angles_of(n, link%store%v(1, link%direction(1)), link%store%v(1, link%direction(2)), &
                              samples%out(offset + 1:offset + n, c))
            else
               samples%out(offset + 1:offset + n, c) = link%store%v(1:n, link%out(c))
            end if
         end do
      end associate
   end subroutine note_output

   !> See it with all derivatives.
   subroutine linearise_samples(samples, dimensions, seen, limit)
      type(sample_set_t), intent(inout) :: samples
      type(dimensions_t), intent(in) :: dimensions
      logical, intent(in), optional :: seen      !! it is the linkage seen last, at the same inputs
      real(wp), intent(in), optional :: limit(:) !! by loop: where no k is beyond, derivatives of k are not wanted
      logical :: beyond(samples%problem%mechanism%nloop)
      integer :: loop

      if (present(seen)) then
         if (.not. seen) call evaluate_samples(samples, dimensions)
      else
         call evaluate_samples(samples, dimensions)
      end if
      beyond = .true.
      if (present(limit)) beyond = [(exceeds(size(samples%k, 1), samples%k(:, loop), limit(loop)), loop=1, size(limit))]
      if (any(beyond)) then
         call find_jacobian(samples%problem, dimensions, samples%work, samples%dout, dk=samples%dk, dp=samples%djoints, &
                            beside=samples%beside, solved=samples%solved, held=samples%held, loops=beyond)
      else
         call find_jacobian(samples%problem, dimensions, samples%work, samples%dout, dp=samples%djoints, &
                            beside=samples%beside, solved=samples%solved, held=samples%held)
      end if
      if (.not. all(samples%closed)) call difference_open(samples, dimensions)
   end subroutine linearise_samples

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
   subroutine difference_open(samples, dimensions)
      type(sample_set_t), intent(inout) :: samples
      type(dimensions_t), intent(in) :: dimensions
      type(dimensions_t) :: changed
      real(wp) :: values(samples%columns), changed_values(samples%columns)
      real(wp) :: step, reach
      integer :: v, i

      samples%out0 = samples%out
      samples%k0 = samples%k
      samples%joints0 = samples%joints
      samples%closed0 = samples%closed
      reach = maxval(dimensions%arcl)
      changed = dimensions
      values = samples%problem%parameters%first_values(dimensions)
      do v = 1, samples%columns
         if (allocated(samples%held)) then
            if (samples%held(v)) cycle
         end if
         associate (kind => samples%problem%parameters%variables(v)%kind)
            step = small_change*degrees_per_radian
            if (any(kind == [variable_length, variable_outlk, variable_origlk, variable_aside])) step = small_change*reach
            if (kind == variable_crnki .and. samples%problem%mechanism%sliding_input) step = small_change*reach
            changed_values = values
            changed_values(v) = values(v) + step
            call samples%problem%parameters%apply(changed_values, changed)
            if (kind == variable_crnki) changed%crnki = dimensions%crnki + step
         end associate
         call observe(samples, changed, closing=.false.)
         do i = 1, size(samples%closed0)
            if (samples%closed0(i)) cycle
            samples%dout(i, v, :) = (samples%out(i, :) - samples%out0(i, :))/step
            samples%dk(i, :, v) = (samples%k(i, :) - samples%k0(i, :))/step
            samples%djoints(i, :, :, v) = (samples%joints(i, :, :) - samples%joints0(i, :, :))/step
         end do
      end do
      samples%out = samples%out0
      samples%k = samples%k0
      samples%joints = samples%joints0
      samples%closed = samples%closed0
   end subroutine difference_open
end module psalm_samples
