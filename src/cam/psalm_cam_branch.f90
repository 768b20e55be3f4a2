!> A linkage moved along its input, and the branches on which its output rises or falls all the way.
!>
!> A branch ends where a loop opens, or at a dead point of the output: there F' = 0, and another branch begins beyond. Near a dead
!> point F - F* and F' are had from the second and third derivatives at both ends of the way to it (Hermite's quadrature), so that
!> none of their digits is lost to the values at the dead point. Source: derivation in doc/theory/cams.md.
module psalm_cam_branch
   use psalm_angles, only: nearest_difference
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_rates, only: rates_t, prepare_rates, differentiate, output_rates, is_dead, highest_order
   use psalm_shown_input, only: reference_input
   implicit none (type, external)
   private
   public :: moved_problem_t, followed_t, branch_t, branch_end_t, find_branch, find_dead_point, rise_from

   integer, parameter :: scan_steps = 720                !! to either side of where a branch is looked for
   real(wp), parameter :: scan_degrees = 0.5_wp
   integer, parameter :: bisections = 60
   real(wp), parameter :: part_of_branch = 1.0e-3_wp    !! step for the fourth derivative at a dead point
   real(wp), parameter :: near_slope = 2.0e-3_wp         !! part of the branch next to a dead point where F' is had by quadrature

   !> A problem and its derivatives at a row of inputs.
   type :: moved_problem_t
      class(problem_t), allocatable :: problem
      type(rates_t) :: rates
      integer :: prepared = 0                        !! positions
   contains
      procedure :: move
   end type moved_problem_t

   !> What of a quantity is followed, and in which units.
   type :: followed_t
      integer :: component = 1                       !! of the output
      logical :: angular = .false.                   !! that is an angle
      logical :: turning_input = .true.
   contains
      procedure :: input_unit
      procedure :: output_unit
   end type followed_t

   !> Inputs that rise, outputs there, without steps of a turn; no entries: there is none.
   type :: branch_t
      real(wp), allocatable :: q(:), f(:)            !! the user's units
      real(wp) :: slope = 0.0_wp                     !! mean of the output's: its greatest has no bound where a loop opens
      logical :: dead(2) = .false.                   !! at its lower and upper end the output stands still, and no loop opens
   end type branch_t

   !> A dead point of the output.
   type :: branch_end_t
      logical :: found = .false.
      real(wp) :: q = 0.0_wp, f = 0.0_wp             !! input and output there, the user's units
      real(wp) :: d(2:4) = 0.0_wp                    !! derivatives of the output, radians or length
      real(wp) :: extent = 0.0_wp                    !! of the branch that ends there, radians or length
   end type branch_end_t

contains

   !> Radians of a degree, or 1 of a length.
   pure real(wp) function input_unit(self)
      class(followed_t), intent(in) :: self

      input_unit = merge(radians_per_degree, 1.0_wp, self%turning_input)
   end function input_unit

   pure real(wp) function output_unit(self)
      class(followed_t), intent(in) :: self

      output_unit = merge(radians_per_degree, 1.0_wp, self%angular)
   end function output_unit

   !> Move to inputs (degrees or length, not increments): values and derivatives of all components; `shut` where all
   !> loops close and have derivatives.
   subroutine move(self, inputs, orders, value, d, shut, direction)
      class(moved_problem_t), intent(inout) :: self
      real(wp), intent(in) :: inputs(:)              !! shape (n)
      integer, intent(in) :: orders                  !! 2 or 3
      real(wp), intent(out) :: value(:, :)           !! shape (components, n): angles in a turn
      real(wp), intent(out) :: d(:, :, :)            !! shape (3, components, n)
      logical, intent(out) :: shut(:)                !! shape (n)
      complex(wp), intent(out), optional :: direction(:) !! shape (n): of the output arc
      integer :: block, offset, m, i, c, loop

      associate (problem => self%problem)
         if (self%prepared /= size(inputs)) then
            call problem%set_inputs(inputs - reference_input(problem%mechanism, problem%given))
            call problem%bind(problem%given)
            call prepare_rates(problem, self%rates)
            self%prepared = size(inputs)
         else
            call problem%move_inputs(inputs - reference_input(problem%mechanism, problem%given))
         end if
         shut = .true.
         do block = 1, problem%blocks()
            call problem%solve_block(block, offset, m)
            call problem%output_of(m)
            call differentiate(problem, self%rates, m, orders)
            do i = 1, m
               do loop = 1, problem%mechanism%nloop
                  if (problem%linkage%step_of_loop(loop) == 0) cycle
                  if (.not. problem%linkage%closes(i, loop)) shut(offset + i) = .false.
                  if (is_dead(problem, self%rates, loop, i)) shut(offset + i) = .false.
               end do
               do c = 1, size(value, 1)
                  value(c, offset + i) = problem%output%actual(c, i, problem%linkage)
               end do
               call output_rates(problem, self%rates, i, orders, d(:, :, offset + i))
               if (present(direction)) direction(offset + i) = cmplx(problem%linkage%store%v(i, problem%linkage%direction(1)), &
                                                                  problem%linkage%store%v(i, problem%linkage%direction(2)), wp)
            end do
         end do
      end associate
   end subroutine move

   !> The branch of inputs about `start`, its ends by bisection. Angles go on from `near`, if it is given.
   subroutine find_branch(quantity, what, start, branch, near)
      type(moved_problem_t), intent(inout) :: quantity
      type(followed_t), intent(in) :: what
      real(wp), intent(in) :: start                  !! input to begin with
      type(branch_t), intent(out) :: branch
      real(wp), intent(in), optional :: near         !! output there, but for turns
      real(wp), allocatable :: q(:), f(:)
      logical, allocatable :: good(:)
      real(wp) :: step, sense, ends(2), at_ends(2)
      integer :: k, first, last, middle

      allocate (branch%q(0), branch%f(0))
      middle = scan_steps + 1
      step = scan_degrees
      if (.not. what%turning_input) step = 2.0_wp*max(sum(quantity%problem%given%arcl), abs(start))/real(scan_steps, wp)
      allocate (q(2*scan_steps + 1), f(2*scan_steps + 1), good(2*scan_steps + 1))
      do k = 1, size(q)
         q(k) = start + step*real(k - middle, wp)
      end do
      sense = 0.0_wp
      call assess(q, f, good)
      if (.not. good(middle)) return
      first = middle
      do while (first > 1)
         if (.not. good(first - 1)) exit
         first = first - 1
      end do
      last = middle
      do while (last < size(q))
         if (.not. good(last + 1)) exit
         last = last + 1
      end do
      ends = [q(first), q(last)]
      at_ends = [f(first), f(last)]
      if (first > 1) call narrow(q(first), q(first - 1), ends(1), at_ends(1), branch%dead(1))
      if (last < size(q)) call narrow(q(last), q(last + 1), ends(2), at_ends(2), branch%dead(2))
      branch%q = [ends(1), q(first:last), ends(2)]
      branch%f = [at_ends(1), f(first:last), at_ends(2)]
      if (what%angular) then
         do k = 2, size(branch%f)
            branch%f(k) = branch%f(k - 1) + nearest_difference(branch%f(k), branch%f(k - 1))
         end do
      end if
      branch%slope = abs(branch%f(size(branch%f)) - branch%f(1))*what%output_unit()/ &
                     max((ends(2) - ends(1))*what%input_unit(), tiny(1.0_wp))
      if (.not. (what%angular .and. present(near))) return
      k = middle - first + 2
      branch%f = branch%f + (near - branch%f(k) + nearest_difference(branch%f(k), near))

   contains

      !> Outputs, and whether each input belongs to the branch as far as it can be seen from there.
      subroutine assess(inputs, output, belongs, closes)
         real(wp), intent(in) :: inputs(:)
         real(wp), intent(out) :: output(:)
         logical, intent(out) :: belongs(:)
         logical, intent(out), optional :: closes(:)
         real(wp) :: value(quantity%problem%output%kind%components, size(inputs))
         real(wp) :: d(highest_order, size(value, 1), size(inputs))
         logical :: shut(size(inputs))

         call quantity%move(inputs, 2, value, d, shut)
         output = value(what%component, :)
         associate (slope => d(1, what%component, :))
            if (size(inputs) > 1 .and. shut(min(middle, size(inputs)))) sense = sign(1.0_wp, slope(middle))
            belongs = shut .and. sense*slope > 0.0_wp
         end associate
         if (present(closes)) closes = shut
      end subroutine assess

      !> The last input that belongs, between one that does and one that does not; `dead` if beyond it the loops still close.
      subroutine narrow(inside, outside, input, output, dead)
         real(wp), intent(in) :: inside, outside
         real(wp), intent(inout) :: input, output
         logical, intent(out) :: dead
         real(wp) :: low, high, one(1)
         logical :: belongs(1), closes(1)
         integer :: i

         low = inside
         high = outside
         dead = .false.
         do i = 1, bisections
            call assess([0.5_wp*(low + high)], one, belongs, closes)
            if (belongs(1)) then
               low = 0.5_wp*(low + high)
               output = one(1)
            else
               high = 0.5_wp*(low + high)
               dead = closes(1)
            end if
         end do
         input = low
      end subroutine narrow
   end subroutine find_branch

   !> The dead point at the lower (1) or upper (2) end of a branch. Not found where the output has no second derivative there, or a
   !> loop opens.
   subroutine find_dead_point(quantity, what, branch, which, point)
      type(moved_problem_t), intent(inout) :: quantity
      type(followed_t), intent(in) :: what
      type(branch_t), intent(in) :: branch
      integer, intent(in) :: which
      type(branch_end_t), intent(out) :: point
      real(wp) :: value(quantity%problem%output%kind%components, 3), d(highest_order, size(value, 1), 3), step
      logical :: shut(3)
      integer :: last

      if (.not. branch%dead(which)) return
      last = size(branch%q)
      point%q = branch%q(merge(1, last, which == 1))
      point%f = branch%f(merge(1, last, which == 1))
      point%extent = (branch%q(last) - branch%q(1))*what%input_unit()
      step = part_of_branch*point%extent
      call quantity%move(point%q + [-step, 0.0_wp, step]/what%input_unit(), highest_order, value, d, shut)
      associate (f => d(:, what%component, :))
         if (.not. all(shut) .or. .not. abs(f(2, 2))*point%extent > branch%slope*part_of_branch) return
         ! what bisection left
         point%q = point%q - f(1, 2)/f(2, 2)/what%input_unit()
         point%d = [f(2, 2), f(3, 2), 0.5_wp*(f(3, 3) - f(3, 1))/step]
      end associate
      point%found = .true.
   end subroutine find_dead_point

   !> F - F* and F' at the distance d from a dead point, from the derivatives there and here.
   elemental subroutine rise_from(point, distance, derivative, second, third, rise, slope)
      type(branch_end_t), intent(in) :: point
      real(wp), intent(in) :: distance               !! radians or length
      real(wp), intent(in) :: derivative, second, third !! of the output here
      real(wp), intent(out) :: rise, slope

      slope = derivative
      if (abs(distance) < near_slope*point%extent) slope = distance*(0.5_wp*(point%d(2) + second) + &
                                                                    distance*(point%d(3) - third)/12.0_wp)
      rise = distance*(0.5_wp*slope + distance*(0.1_wp*(point%d(2) - second) + distance*(point%d(3) + third)/120.0_wp))
   end subroutine rise_from
end module psalm_cam_branch
