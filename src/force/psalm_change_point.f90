!> A change point of a linkage with one free drive: where dyads come into line for every choice of drives, and the assembly goes
!> straight on into the other one of these dyads.
!>
!> Beside it closed forms lose digits as the inverse of the sine between the links, and at it two motions cross. Between two inputs,
!> a little before and a little beyond, the positions of the smooth motion and their derivatives are therefore those of a polynomial
!> of the input that has position and derivatives of two inputs on either side, where the sine is large enough; beyond, the dyads
!> concerned are in their other assembly. Every row of the store is a smooth function of the input there, so that nothing depends on
!> the kind of the dyads; as rates are the polynomial's own, energy is kept.
!> Derivation: `doc/theory/motion_in_time.md`.
module psalm_change_point
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_linkage, only: padded
   use psalm_plan, only: step_dyad
   use psalm_rates, only: rates_t, differentiate, highest_order
   use psalm_root, only: root_search_t, begin_search
   use psalm_frames, only: sine_row
   implicit none (type, external)
   private
   public :: change_point_t, drive_path_t, find_change_point, pivots_of

   integer, parameter :: side_nodes = 8            !! inputs on either side at which the sine is known,
   real(wp), parameter :: spread_of_nodes = 3.0_wp !! the farthest so many times as far away as the nearest
   !> of these inputs those with position and derivatives, nearest and about twice as far, by turns beyond and before
   integer, parameter :: known(4) = side_nodes + [1, 0, 4, -3]
   integer, parameter :: conditions = size(known)*(1 + highest_order) !! one more than the degree of the polynomial
   real(wp), parameter :: widest = 0.4_wp          !! radians, or parts of the size: distance of the nearest that is tried first,
   integer, parameter :: most_widths = 8           !! then its halves
   integer, parameter :: most_rounds = 6           !! of the search for the change point
   real(wp), parameter :: placed = 1.0e-3_wp       !! part of that distance: so exactly all dyads must be in line at the same input
   real(wp), parameter :: exact_fit = 2.0e-13_wp   !! part of the lengths: so well the polynomial fits where rounding is all
   real(wp), parameter :: widest_gap = 1.0e-7_wp   !! part of the lengths: a linkage that misses its change point by more has none
   real(wp), parameter :: least_sine = 1.0e-6_wp   !! nearer the change point forces of joints are not determined
   real(wp), parameter :: much_better = 0.25_wp    !! part of the gap: a nearer polynomial counts where its gap is less than that
   integer, parameter :: checks = 9                !! inputs between both sides at which the polynomial is checked

   !> How all drives go with the free one: inputs are base + slope times its input; radians or user's lengths.
   type :: drive_path_t
      real(wp), allocatable :: base(:), slope(:)   !! by drive
      logical, allocatable :: slides(:)            !! by drive
      real(wp) :: size = 1.0_wp                    !! of the free drive: a radian, or the size of the linkage
   end type drive_path_t

   type :: change_point_t
      integer :: loop = 0                          !! the lowest loop that changes its assembly
      real(wp) :: centre = 0.0_wp                  !! input of the free drive, radians or user's length
      real(wp) :: middle = 0.0_wp                  !! as found from one side: of the inputs at which the polynomial holds,
      real(wp) :: half = 0.0_wp                    !! so far on either side
      real(wp) :: gap = 0.0_wp                     !! part of the lengths by which the linkage misses it
      type(drive_path_t) :: path
      real(wp), allocatable :: nodes(:)            !! inputs at which the sine is known, ascending
      real(wp), allocatable :: signs(:, :)         !! shape (loops, 2): assembly of the dyads below and above the centre
      real(wp), allocatable :: differences(:, :)   !! shape (rows of the store, conditions): divided differences; the first is the
                                                   !! value at the first of the known inputs
      integer, allocatable :: root_x(:), root_y(:) !! rows of directions
      real(wp), allocatable :: sine(:)             !! shape (nodes): of the dyad of `loop`, with the sign of its assembly
   contains
      procedure :: holds
      procedure :: put_signs
      procedure :: put_place
      procedure :: put_rates
      procedure :: undetermined
      procedure :: tabulate
      procedure, private :: set_differences
      procedure, private :: fit
      procedure, private :: at
   end type change_point_t

contains

   !> Sines between the columns of the dyads' equations, with the signs of their assemblies: they go through 0 at a change point.
   !> Of the position that was differentiated last; loops without assemblies have 1.
   pure function pivots_of(problem, rates) result(pivots)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      real(wp) :: pivots(problem%mechanism%nloop)
      integer :: loop, k

      pivots = 1.0_wp
      do loop = 1, size(pivots)
         k = problem%linkage%step_of_loop(loop)
         if (k == 0 .or. problem%linkage%two_slides(loop)) cycle
         associate (dyad => problem%linkage%steps(k)%dyad)
            if (allocated(dyad%higher)) cycle
            pivots(loop) = dyad%sign*sqrt(max(0.0_wp, rates%frames%work%v(1, rates%place(k) + sine_row)))
         end associate
      end do
   end function pivots_of

   !> Look for a change point ahead. The problem is left at some other position, in the assembly of before.
   subroutine find_change_point(problem, rates, path, expected, direction, loop, point, found, open)
      class(problem_t), intent(inout) :: problem    !! at one position, bound; without larger groups
      type(rates_t), intent(inout) :: rates
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: expected              !! input of the free drive where it may be
      real(wp), intent(in) :: direction             !! 1 or -1: the side on which it is now is that of lower or higher inputs
      integer, intent(in) :: loop                   !! the loop whose dyad comes into line
      type(change_point_t), intent(out) :: point
      logical, intent(out) :: found
      logical, intent(out) :: open                  !! not found, because the linkage does not close near there
      type(change_point_t) :: one
      real(wp) :: near(size(problem%linkage%step_of_loop))
      integer :: width, k

      found = .false.
      do k = 1, size(near)
         near(k) = sign_of(k)
      end do
      do width = 0, most_widths - 1
         one%half = widest*path%size*0.5_wp**width
         one%middle = expected
         if (point%loop > 0) one%middle = point%middle
         one%path = path
         open = .false.
         call place_centre()
         if (.not. found) cycle
         call one%tabulate(problem, rates, found)
         open = .not. found
         if (.not. found) cycle
         one%gap = misfit(one, problem)
         found = one%gap <= widest_gap
         if (.not. found) cycle
         if (point%loop == 0 .or. one%gap < much_better*point%gap) point = one
         if (one%gap <= exact_fit) exit
      end do
      call restore()
      found = point%loop > 0
      if (.not. found) return
      if (point%gap <= exact_fit) point%gap = 0.0_wp
      point%centre = zero_between(point)

   contains

      real(wp) function sign_of(loop)
         integer, intent(in) :: loop

         sign_of = 1.0_wp
         if (problem%linkage%step_of_loop(loop) > 0) sign_of = problem%linkage%steps(problem%linkage%step_of_loop(loop))%dyad%sign
      end function sign_of

      subroutine restore()
         integer :: i

         do i = 1, size(near)
            if (problem%linkage%step_of_loop(i) > 0) problem%linkage%steps(problem%linkage%step_of_loop(i))%dyad%sign = near(i)
         end do
      end subroutine restore

      !> The input where the sine is 0, by a polynomial through positions on this side, and which dyads are beyond in their other
      !> assembly: all whose sines go through 0 there.
      subroutine place_centre()
         real(wp) :: at(side_nodes), sines(size(near), side_nodes), across(size(near)), moved, here, there, step
         integer :: round, i, near_side

         call restore()
         found = .false.
         do round = 1, most_rounds
            at = one%middle - direction*one%half*distances()
            do i = 1, side_nodes
               call solve_at(problem, path, at(i), found)
               open = .not. found
               if (.not. found) return
               call differentiate_at(problem, rates, path)
               sines(:, i) = pivots_of(problem, rates)
            end do
            step = 0.1_wp*one%half
            here = value_at(at, sines(loop, :), one%middle)
            there = value_at(at, sines(loop, :), one%middle + step)
            found = abs(there - here) > 0.0_wp
            if (.not. found) return
            moved = -here*step/(there - here)
            found = abs(moved) < one%half
            if (.not. found) return
            one%middle = one%middle + moved
            if (abs(moved) <= placed*one%half) exit
         end do
         found = abs(moved) <= placed*one%half
         one%centre = one%middle
         if (.not. found) return
         one%loop = 0
         one%signs = spread(near, 2, 2)
         near_side = merge(1, 2, direction > 0.0_wp)
         do i = 1, size(near)
            across(i) = value_at(at, sines(i, :), one%middle + direction*one%half)
            if (.not. across(i)*sines(i, 1) < 0.0_wp) cycle
            ! it must be in line at the same input
            found = abs(value_at(at, sines(i, :), one%middle)) <= placed*abs(sines(i, 1))
            if (.not. found) return
            one%signs(i, 3 - near_side) = -near(i)
            if (one%loop == 0) one%loop = i
         end do
         found = one%loop > 0
      end subroutine place_centre
   end subroutine find_change_point

   !> The input where the polynomial of the sine is 0: exactly where the dyads are in line.
   pure real(wp) function zero_between(self) result(zero)
      type(change_point_t), intent(in) :: self
      type(root_search_t) :: search
      real(wp) :: input

      associate (low => self%middle - self%half, high => self%middle + self%half)
         search = begin_search(low, value_at(self%nodes, self%sine, low), high, value_at(self%nodes, self%sine, high), &
                               epsilon(1.0_wp)*max(self%path%size, abs(self%middle)))
      end associate
      do while (.not. search%done())
         input = search%next()
         call search%put(input, value_at(self%nodes, self%sine, input))
      end do
      zero = search%root()
   end function zero_between

   !> Distances of the positions on one side, as parts of that of the nearest: their squares are extremes of a Chebyshev polynomial.
   pure function distances() result(parts)
      real(wp) :: parts(side_nodes)
      !> cosines of multiples of a seventh of half a turn
      real(wp), parameter :: c(side_nodes) = [1.0_wp, 0.90096886790241915_wp, 0.62348980185873359_wp, 0.22252093395631445_wp, &
                                              -0.22252093395631445_wp, -0.62348980185873359_wp, -0.90096886790241915_wp, -1.0_wp]
      real(wp), parameter :: middle = 0.5_wp*(1.0_wp + spread_of_nodes**2), amplitude = 0.5_wp*(spread_of_nodes**2 - 1.0_wp)

      parts = sqrt(middle - amplitude*c)
   end function distances

   !> Find the positions and derivatives on both sides. `closes` is false where the linkage is open at one of them.
   subroutine tabulate(self, problem, rates, closes)
      class(change_point_t), intent(inout) :: self
      class(problem_t), intent(inout) :: problem
      type(rates_t), intent(inout) :: rates
      logical, intent(out) :: closes
      real(wp) :: parts(side_nodes), pivots(problem%mechanism%nloop)
      real(wp) :: values(size(problem%linkage%store%v, 2), 0:highest_order, size(known))
      integer :: i, k, order

      parts = distances()
      self%nodes = self%middle + self%half*[-parts(side_nodes:1:-1), parts]
      self%root_x = pack(problem%linkage%root_x, problem%linkage%root_x > 0)
      self%root_y = pack(problem%linkage%root_y, problem%linkage%root_x > 0)
      if (.not. allocated(self%sine)) allocate (self%sine(size(self%nodes)))
      do i = 1, size(self%nodes)
         call self%put_signs(problem, self%nodes(i))
         call solve_at(problem, self%path, self%nodes(i), closes)
         if (.not. closes) return
         call differentiate_at(problem, rates, self%path)
         pivots = pivots_of(problem, rates)
         self%sine(i) = pivots(self%loop)
         k = findloc(known, i, dim=1)
         if (k == 0) cycle
         values(:, 0, k) = problem%linkage%store%v(1, :)
         do order = 1, highest_order
            values(:, order, k) = rates%d(order)%v(1, :)
         end do
         call by_components(self, values(:, :, k))
      end do
      call self%set_differences(values)
   end subroutine tabulate

   !> Of directions the derivatives of their components in place of those of the angle.
   pure subroutine by_components(self, rows)
      type(change_point_t), intent(in) :: self
      real(wp), intent(inout) :: rows(:, 0:)       !! shape (rows, orders)
      real(wp) :: x, y, w, al, be
      integer :: k

      do k = 1, size(self%root_x)
         x = rows(self%root_x(k), 0)
         y = rows(self%root_y(k), 0)
         w = rows(self%root_x(k), 1)
         al = rows(self%root_x(k), 2)
         be = rows(self%root_x(k), 3)
         rows(self%root_x(k), 1:) = [-y*w, -y*al - x*w**2, -y*be - 3.0_wp*x*w*al + y*w**3]
         rows(self%root_y(k), 1:) = [x*w, x*al - y*w**2, x*be - 3.0_wp*y*w*al - x*w**3]
      end do
   end subroutine by_components

   !> The other way round.
   pure subroutine by_angles(self, rows)
      type(change_point_t), intent(in) :: self
      real(wp), intent(inout) :: rows(:, 0:)       !! shape (rows, orders)
      real(wp) :: x(0:highest_order), y(0:highest_order)
      integer :: k

      do k = 1, size(self%root_x)
         x = rows(self%root_x(k), :)
         y = rows(self%root_y(k), :)
         rows(self%root_x(k), 1:) = [x(0)*y(1) - y(0)*x(1), x(0)*y(2) - y(0)*x(2), &
                                     x(0)*y(3) + x(1)*y(2) - y(0)*x(3) - y(1)*x(2)]
         rows(self%root_y(k), 1:) = 0.0_wp
      end do
   end subroutine by_angles

   !> Divided differences (Hermite's) of values and derivatives at the known inputs, which are counted in parts of `half`.
   pure subroutine set_differences(self, values)
      class(change_point_t), intent(inout) :: self
      real(wp), intent(in) :: values(:, 0:, :)     !! shape (rows, orders, known inputs)
      real(wp) :: at(conditions), factor
      integer :: i, k, column

      if (allocated(self%differences)) deallocate (self%differences)
      allocate (self%differences(size(values, 1), conditions))
      at = [(self%at(i), i=1, conditions)]
      do i = 1, conditions
         self%differences(:, i) = values(:, 0, known_at(i))
      end do
      factor = 1.0_wp
      do k = 1, conditions - 1
         factor = factor*self%half/real(k, wp)
         ! from the last, for each needs the one before as it was
         do i = conditions, k + 1, -1
            column = known_at(i)
            if (column == known_at(i - k)) then
               self%differences(:, i) = values(:, k, column)*factor
            else
               self%differences(:, i) = (self%differences(:, i) - self%differences(:, i - 1))/(at(i) - at(i - k))
            end if
         end do
      end do
   end subroutine set_differences

   !> The known input that a condition is one of.
   pure integer function known_at(condition)
      integer, intent(in) :: condition

      known_at = (condition - 1)/(1 + highest_order) + 1
   end function known_at

   !> Where it is: from the middle, in parts of `half`.
   pure real(wp) function at(self, condition)
      class(change_point_t), intent(in) :: self
      integer, intent(in) :: condition

      at = (self%nodes(known(known_at(condition))) - self%middle)/self%half
   end function at

   !> Solve a problem at an input of the free drive.
   subroutine solve_at(problem, path, input, closes)
      class(problem_t), intent(inout) :: problem
      type(drive_path_t), intent(in) :: path
      real(wp), intent(in) :: input
      logical, intent(out) :: closes
      real(wp) :: inputs(size(path%base))
      integer :: offset, n, loop

      inputs = path%base + path%slope*input
      where (.not. path%slides) inputs = inputs*degrees_per_radian
      if (size(inputs) > 1) problem%own_delt(1, :) = inputs(2:)
      call problem%move_inputs(inputs(:1))
      call problem%solve_block(1, offset, n)
      closes = .true.
      do loop = 1, problem%mechanism%nloop
         if (problem%linkage%step_of_loop(loop) > 0) closes = closes .and. problem%linkage%closes(1, loop)
      end do
   end subroutine solve_at

   !> Derivatives by the input of the free drive.
   subroutine differentiate_at(problem, rates, path)
      class(problem_t), intent(inout) :: problem
      type(rates_t), intent(inout) :: rates
      type(drive_path_t), intent(in) :: path
      integer :: d

      do d = 1, size(path%slope)
         problem%linkage%drive_rate(:, d) = path%slope(d)*[1.0_wp, 0.0_wp, 0.0_wp]
      end do
      call differentiate(problem, rates, 1, highest_order)
   end subroutine differentiate_at

   !> What the lengths of the links are off in the polynomial, between both sides: as a part of them, the largest.
   real(wp) function misfit(self, problem)
      type(change_point_t), intent(in) :: self
      class(problem_t), intent(inout) :: problem
      real(wp) :: input, x, y, largest
      integer :: i, k

      misfit = 0.0_wp
      associate (link => problem%linkage, v => problem%linkage%store%v)
         largest = maxval(abs(link%length))
         do i = 1, checks
            input = self%middle + self%half*real(2*i - checks - 1, wp)/real(checks, wp)
            call self%put_place(problem, input)
            do k = 1, size(link%root_x)
               if (link%root_x(k) == 0) cycle
               associate (length => hypotenuse(v(1, link%root_x(k)), v(1, link%root_y(k))))
                  if (length > 0.0_wp) misfit = max(misfit, abs(length - 1.0_wp))
               end associate
            end do
            do k = 1, size(link%steps)
               associate (dyad => link%steps(k)%dyad)
                  if (link%steps(k)%kind /= step_dyad) cycle
                  x = v(1, dyad%s_x) - v(1, dyad%e_x)
                  y = v(1, dyad%s_y) - v(1, dyad%e_y)
                  call add(dyad%p, dyad%slide_p, dyad%px, dyad%py, v(1, dyad%p_x), v(1, dyad%p_y))
                  call add(dyad%q, dyad%slide_q, dyad%qx, dyad%qy, v(1, dyad%q_x), v(1, dyad%q_y))
                  misfit = max(misfit, hypotenuse(x, y)/largest)
               end associate
            end do
         end do
      end associate

   contains

      subroutine add(length, slide, c, s, root_x, root_y)
         real(wp), intent(in) :: length, c, s, root_x, root_y
         integer, intent(in) :: slide
         real(wp) :: l

         l = length
         if (slide > 0) l = problem%linkage%store%v(1, slide)
         x = x + l*(c*root_x - s*root_y)
         y = y + l*(c*root_y + s*root_x)
      end subroutine add
   end function misfit

   !> True if the polynomial has to be used at an input.
   pure logical function holds(self, input)
      class(change_point_t), intent(in) :: self
      real(wp), intent(in) :: input

      holds = abs(input - self%middle) < self%half
   end function holds

   !> True if an input is so near that forces of joints, which grow as the inverse of the sine, are not determined.
   pure logical function undetermined(self, input)
      class(change_point_t), intent(in) :: self
      real(wp), intent(in) :: input

      undetermined = .false.
      if (self%holds(input)) undetermined = abs(value_at(self%nodes, self%sine, input)) < max(least_sine, sqrt(self%gap))
   end function undetermined

   !> Assemblies of all dyads on the side of an input.
   pure subroutine put_signs(self, problem, input)
      class(change_point_t), intent(in) :: self
      class(problem_t), intent(inout) :: problem
      real(wp), intent(in) :: input
      integer :: loop

      associate (side => merge(1, 2, input < self%centre), link => problem%linkage)
         do loop = 1, size(self%signs, 1)
            if (link%step_of_loop(loop) > 0) link%steps(link%step_of_loop(loop))%dyad%sign = self%signs(loop, side)
         end do
      end associate
   end subroutine put_signs

   !> The position at an input, in place of that which the problem would find.
   pure subroutine put_place(self, problem, input)
      class(change_point_t), intent(in) :: self
      class(problem_t), intent(inout) :: problem
      real(wp), intent(in) :: input
      real(wp) :: rows(size(self%differences, 1), 0:highest_order)
      integer :: i

      call self%fit(input, 0, rows)
      do i = 1, padded(1)
         problem%linkage%store%v(i, :) = rows(:, 0)
      end do
   end subroutine put_place

   !> Derivatives by time there, for the rate and acceleration of the free drive.
   pure subroutine put_rates(self, rates, input, rate, accel, orders)
      class(change_point_t), intent(in) :: self
      type(rates_t), intent(inout) :: rates
      real(wp), intent(in) :: input, rate, accel
      integer, intent(in) :: orders                !! 2 or 3
      real(wp) :: rows(size(self%differences, 1), 0:highest_order)
      integer :: i

      call self%fit(input, orders, rows)
      call by_angles(self, rows)
      do i = 1, padded(1)
         rates%d(1)%v(i, :) = rows(:, 1)*rate
         rates%d(2)%v(i, :) = rows(:, 2)*rate**2 + rows(:, 1)*accel
         if (orders > 2) rates%d(3)%v(i, :) = rows(:, 3)*rate**3 + 3.0_wp*rows(:, 2)*rate*accel
      end do
   end subroutine put_rates

   !> Values and derivatives of the polynomial, by Horner's rule; what is the same at all known inputs stays what it is.
   pure subroutine fit(self, input, orders, rows)
      class(change_point_t), intent(in) :: self
      real(wp), intent(in) :: input
      integer, intent(in) :: orders
      real(wp), intent(out) :: rows(:, 0:)         !! shape (rows, highest order): those above `orders` are 0
      real(wp) :: t, factor
      integer :: i, order

      t = (input - self%middle)/self%half
      rows = 0.0_wp
      rows(:, 0) = self%differences(:, conditions)
      do i = conditions - 1, 1, -1
         associate (away => t - self%at(i))
            do order = orders, 1, -1
               rows(:, order) = rows(:, order)*away + rows(:, order - 1)
            end do
            rows(:, 0) = rows(:, 0)*away + self%differences(:, i)
         end associate
      end do
      factor = 1.0_wp
      do order = 1, orders
         factor = factor*real(order, wp)/self%half
         rows(:, order) = rows(:, order)*factor
      end do
   end subroutine fit

   !> Value of the polynomial through the nodes.
   pure real(wp) function value_at(nodes, values, input) result(value)
      real(wp), intent(in) :: nodes(:), values(:), input
      real(wp) :: weights(size(nodes))
      integer :: i

      weights = weights_at(nodes, input)
      value = values(1)
      do i = 2, size(nodes)
         value = value + weights(i)*(values(i) - values(1))
      end do
   end function value_at

   !> Lagrange's weights of nodes at an input.
   pure function weights_at(nodes, input) result(weights)
      real(wp), intent(in) :: nodes(:), input
      real(wp) :: weights(size(nodes))
      integer :: i, k

      weights = 1.0_wp
      do i = 1, size(nodes)
         do k = 1, size(nodes)
            if (k /= i) weights(i) = weights(i)*((input - nodes(k))/(nodes(i) - nodes(k)))
         end do
      end do
   end function weights_at
end module psalm_change_point
