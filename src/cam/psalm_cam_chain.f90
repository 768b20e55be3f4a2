!> A sketch that one or two cams drive, solved in the poses of its links: any Assur groups, floating and geared drives.
!>
!> Cam k gives output F_k, or input k itself, a law y_k(th). With J = dF_k/dq_j: J q' = y', J q'' = y'' - F''(q', 0),
!> J q''' = y''' - F'''(q', q'', 0), where F''(q', 0) is the output's derivative with q'' put to zero, and so on: the highest
!> derivative stands in every order with the same matrix. The drives are followed from the drawing to the law's beginning and once
!> round the cam; every other cam angle is reached from the nearest of these by Taylor series and Newton's method.
module psalm_cam_chain
   use psalm_angles, only: nearest_difference, unit_vector
   use psalm_cam_data, only: cam_group_t, roller_t
   use psalm_cam_law, only: law_t, highest_law_order
   use psalm_cam_trace, only: cam_trace_t, clear_trace, fault_dead_point, fault_none, fault_open
   use psalm_chain_motion, only: advance, differentiate
   use psalm_chain_outputs, only: output_at
   use psalm_closure, only: closure_t, state_t, most_orders, place_points, point_rate, solve_group, turned
   use psalm_dense, only: factors_t
   use psalm_kinds, only: wp, full_turn, degrees_per_radian, radians_per_degree
   use psalm_sketch, only: drive_turns, output_angle, output_between, output_pose, columns_of
   implicit none (type, external)
   private
   public :: cam_chain_t, make_cam_chain, numbers_of

   integer, parameter :: nodes_of_turn = 360
   integer, parameter :: steps_to_law = 32           !! from the drawing to the beginning of the law
   integer, parameter :: most_rounds = 30
   real(wp), parameter :: settled = 1.0e-13_wp       !! step of Newton's method that is rounding, in radians or sizes of the drawing
   real(wp), parameter :: same_again = 1.0e-8_wp     !! relative difference of drives after a turn of the cam that is rounding
   real(wp), parameter :: at_rest = 1.0e-7_wp        !! determinant in the largest of its products: the outputs stand still

   !> Drives and poses at a cam angle.
   type :: node_t
      type(state_t) :: state
      real(wp), allocatable :: q(:, :)               !! shape (cams, 0:3): drives of the cams, radians or length
   end type node_t

   type :: cam_chain_t
      type(closure_t) :: closure
      type(state_t) :: drawn
      type(law_t), allocatable :: law(:)             !! by cam
      integer, allocatable :: drive(:)               !! by cam
      integer, allocatable :: number(:)              !! by cam: of all numbers of all outputs that which has the law; 0: the input
      logical, allocatable :: angular(:)             !! by cam: what has the law is an angle
      real(wp), allocatable :: share(:, :)           !! shape (drives, cams): what a drive does of a cam's
      real(wp), allocatable :: phase(:)              !! by drive
      integer :: numbers = 0                         !! of all outputs
      integer :: own = 1                             !! the cam whose follower is asked for
      integer :: link = 0                            !! that carries it
      complex(wp) :: point = (0.0_wp, 0.0_wp)        !! roller centre or point of the face in the axes of the link
      complex(wp) :: along = (1.0_wp, 0.0_wp)        !! direction of the line to it, likewise
      integer :: fault = fault_none                  !! of the way once round the cam
      real(wp) :: fault_at = 0.0_wp                  !! cam angle, degrees
      type(node_t), allocatable :: nodes(:)          !! shape (nodes_of_turn + 1)
   contains
      procedure :: trace
   end type cam_chain_t

contains

   !> How many numbers all outputs have.
   pure integer function numbers_of(closure) result(numbers)
      type(closure_t), intent(in) :: closure
      integer :: k

      numbers = 0
      do k = 1, size(closure%sketch%outputs)
         numbers = numbers + columns_of(closure%sketch%outputs(k))
      end do
   end function numbers_of

   !> Make a sketch with its cams ready and follow it once round.
   !>
   !> `cams` are as many as there are drives that are not geared, each with a law. `joints` name the line that carries the
   !> follower of cam `own`, from joints(1) to joints(2), both on `link`; if they are one the roller sits on it.
   subroutine make_cam_chain(closure, drawn, cams, laws, own, link, joints, roller, chain)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: drawn
      type(cam_group_t), intent(in) :: cams(:)
      type(law_t), intent(in) :: laws(:)             !! shape (cams)
      integer, intent(in) :: own, link, joints(2)
      type(roller_t), intent(in) :: roller
      type(cam_chain_t), intent(out) :: chain
      real(wp) :: c, s, unit
      complex(wp) :: line
      integer :: d, k

      chain%closure = closure
      chain%drawn = drawn
      chain%law = laws
      chain%own = own
      chain%numbers = numbers_of(closure)
      associate (drives => closure%sketch%drives)
         chain%drive = pack([(d, d=1, size(drives))],.not. drives%geared)
         allocate (chain%share(size(drives), size(cams)), chain%phase(size(drives)), source=0.0_wp)
         do k = 1, size(cams)
            chain%share(chain%drive(k), k) = 1.0_wp
         end do
         do d = 2, size(drives)
            if (.not. drives(d)%geared) cycle
            unit = unit_of(drives(d)%kind == drive_turns)
            chain%share(d, 1) = drives(d)%ratio*unit/unit_of(drives(1)%kind == drive_turns)
            chain%phase(d) = drives(d)%phase*unit
         end do
         chain%number = [(merge(cams(k)%axis, 0, cams(k)%of_output), k=1, size(cams))]
         chain%angular = [(drives(chain%drive(k))%kind == drive_turns, k=1, size(cams))]
      end associate
      do k = 1, size(cams)
         if (chain%number(k) > 0) chain%angular(k) = is_angle(closure, chain%number(k))
      end do
      chain%link = link
      chain%point = closure%point(joints(2), link)
      line = closure%point(joints(2), link) - closure%point(joints(1), link)
      if (joints(1) /= joints(2)) chain%along = line/abs(line)
      call unit_vector(roller%angle, c, s)
      chain%along = chain%along*cmplx(c, s, wp)
      chain%point = chain%point + roller%distance*chain%along
      call go_round(chain)
   end subroutine make_cam_chain

   pure real(wp) function unit_of(turns)
      logical, intent(in) :: turns

      unit_of = merge(radians_per_degree, 1.0_wp, turns)
   end function unit_of

   !> True if a number of all outputs is an angle.
   pure logical function is_angle(closure, number)
      type(closure_t), intent(in) :: closure
      integer, intent(in) :: number
      integer :: k, last

      is_angle = .false.
      last = 0
      do k = 1, size(closure%sketch%outputs)
         associate (output => closure%sketch%outputs(k))
            last = last + columns_of(output)
            if (last < number) cycle
            is_angle = any(output%kind == [output_angle, output_between]) .or. (output%kind == output_pose .and. number == last)
            return
         end associate
      end do
   end function is_angle

   !> Laws of all cams at a cam angle: values in the user's unit, derivatives in radians or length.
   pure function laws_at(chain, angle, piece) result(y)
      type(cam_chain_t), intent(in) :: chain
      real(wp), intent(in) :: angle
      integer, intent(in) :: piece                   !! of the law of the cam asked for; 0: as the angle says
      real(wp) :: y(size(chain%law), 0:most_orders)
      real(wp) :: d(0:highest_law_order), within
      integer :: k, p

      within = modulo(angle, full_turn)
      do k = 1, size(chain%law)
         if (piece == 0) then
            d = chain%law(k)%evaluate(within, chain%law(k)%piece_at(within))
         else
            p = piece
            ! the pieces of both laws are cut at the joints of both
            if (k /= chain%own) p = chain%law(k)%piece_at(chain%law(chain%own)%pieces(piece)%start)
            d = chain%law(k)%evaluate(angle, p)
         end if
         y(k, :) = d(:most_orders)
         y(k, 1:) = y(k, 1:)*unit_of(chain%angular(k))
      end do
   end function laws_at

   !> What has the laws, and how far it is from them: radians or length.
   pure subroutine values_at(chain, state, y, miss, d)
      type(cam_chain_t), intent(in) :: chain
      type(state_t), intent(in) :: state
      real(wp), intent(in) :: y(:, 0:)
      real(wp), intent(out) :: miss(:)
      real(wp), intent(out) :: d(:, 0:)              !! shape (cams, 0:most_orders)
      real(wp) :: values(chain%numbers, 0:most_orders)
      integer :: k

      call output_at(chain%closure, state, chain%closure%sketch%outputs, values)
      do k = 1, size(chain%law)
         if (chain%number(k) > 0) then
            d(k, :) = values(chain%number(k), :)
            miss(k) = y(k, 0) - d(k, 0)
            if (chain%angular(k)) miss(k) = nearest_difference(y(k, 0), d(k, 0))
         else
            d(k, :) = state%input(chain%drive(k), :)
            d(k, 0) = d(k, 0)/unit_of(chain%angular(k))
            miss(k) = y(k, 0) - d(k, 0)
         end if
         miss(k) = miss(k)*unit_of(chain%angular(k))
      end do
   end subroutine values_at

   !> Derivatives of what has the laws by the drives of the cams, and the poses' by each.
   subroutine jacobian_at(chain, state, y, jacobian, single, dead)
      type(cam_chain_t), intent(in) :: chain
      type(state_t), intent(in) :: state
      real(wp), intent(in) :: y(:, 0:)
      real(wp), intent(out) :: jacobian(:, :)        !! shape (cams, cams)
      type(state_t), intent(out) :: single(:)        !! shape (cams): with rates while one drive alone moves
      logical, intent(out) :: dead
      real(wp) :: d(size(chain%law), 0:most_orders), miss(size(chain%law))
      integer :: k

      dead = .false.
      do k = 1, size(chain%law)
         single(k) = state
         single(k)%input(:, 1) = chain%share(:, k)
         single(k)%input(:, 2:) = 0.0_wp
         call differentiate(chain%closure, 1, single(k), dead)
         if (dead) return
         call values_at(chain, single(k), y, miss, d)
         jacobian(:, k) = d(:, 1)
      end do
   end subroutine jacobian_at

   !> Solution of one or two equations; `found` is false where the outputs stand still.
   pure subroutine solve_small(a, b, x, found)
      real(wp), intent(in) :: a(:, :), b(:)
      real(wp), intent(out) :: x(:)
      logical, intent(out) :: found
      real(wp) :: det

      if (size(b) == 1) then
         found = abs(a(1, 1)) > tiny(1.0_wp)
         x = 0.0_wp
         if (found) x(1) = b(1)/a(1, 1)
         return
      end if
      det = a(1, 1)*a(2, 2) - a(1, 2)*a(2, 1)
      found = abs(det) > at_rest*max(abs(a(1, 1)*a(2, 2)), abs(a(1, 2)*a(2, 1)))
      x = 0.0_wp
      if (found) x = [a(2, 2)*b(1) - a(1, 2)*b(2), a(1, 1)*b(2) - a(2, 1)*b(1)]/det
   end subroutine solve_small

   !> From a state near it to the one that obeys the laws, and its drives' derivatives. `bold`: a step is one solution of
   !> each group; else the assembly is followed on the way.
   subroutine settle(chain, y, bold, state, q, single, fault)
      type(cam_chain_t), intent(in) :: chain
      real(wp), intent(in) :: y(:, 0:)
      logical, intent(in) :: bold
      type(state_t), intent(inout) :: state
      real(wp), intent(inout) :: q(:, 0:)            !! shape (cams, 0:3)
      type(state_t), intent(out) :: single(:)
      integer, intent(out) :: fault
      real(wp) :: jacobian(size(q, 1), size(q, 1)), miss(size(q, 1)), d(size(q, 1), 0:most_orders), step(size(q, 1))
      real(wp) :: size_of_step, before
      logical :: good
      integer :: round, k, order, group

      before = huge(1.0_wp)
      do round = 1, most_rounds
         fault = fault_open
         call values_at(chain, state, y, miss, d)
         call jacobian_at(chain, state, y, jacobian, single, good)
         if (good) return
         fault = fault_dead_point
         call solve_small(jacobian, miss, step, good)
         if (.not. good) return
         size_of_step = maxval(abs(step)/merge(1.0_wp, chain%closure%size, &
                                               chain%closure%sketch%drives(chain%drive)%kind == drive_turns))
         if (size_of_step <= settled .or. (size_of_step >= before .and. round > 4)) exit
         before = size_of_step
         fault = fault_open
         q(:, 0) = q(:, 0) + step
         if (bold) then
            do k = 1, size(step)
               state%t(:, 0) = state%t(:, 0) + step(k)*single(k)%t(:, 1)
               state%phi(:, 0) = state%phi(:, 0) + step(k)*single(k)%phi(:, 1)
            end do
            call close_groups(chain, q(:, 0), state, good)
            if (.not. good) return
         else
            call advance(chain%closure, inputs_of(chain, q(:, 0)), state, good, group)
            if (.not. good) return
         end if
      end do
      fault = fault_open
      if (round > most_rounds) return
      ! the highest derivative stands with the same matrix in every order
      state%input(:, 1:) = 0.0_wp
      do order = 1, most_orders
         call differentiate(chain%closure, order, state, good)
         if (good) return
         call values_at(chain, state, y, miss, d)
         call solve_small(jacobian, y(:, order) - d(:, order), q(:, order), good)
         state%input(:, order) = product_of_shares(chain, q(:, order))
      end do
      call differentiate(chain%closure, most_orders, state, good)
      if (.not. good) fault = fault_none
   end subroutine settle

   !> Put a state that is near together with the drives at their values.
   subroutine close_groups(chain, q, state, closed)
      type(cam_chain_t), intent(in) :: chain
      real(wp), intent(in) :: q(:)
      type(state_t), intent(inout) :: state
      logical, intent(out) :: closed
      type(factors_t) :: factors
      integer :: g

      closed = .true.
      state%input(:, 0) = inputs_of(chain, q)
      do g = 1, size(chain%closure%groups)
         call solve_group(chain%closure, g, state, closed, factors)
         if (.not. closed) return
      end do
      call place_points(chain%closure, state, 0)
   end subroutine close_groups

   !> Values of all drives from those of the cams.
   pure function inputs_of(chain, q) result(inputs)
      type(cam_chain_t), intent(in) :: chain
      real(wp), intent(in) :: q(:)
      real(wp) :: inputs(size(chain%phase))

      inputs = chain%phase + product_of_shares(chain, q)
   end function inputs_of

   pure function product_of_shares(chain, q) result(inputs)
      type(cam_chain_t), intent(in) :: chain
      real(wp), intent(in) :: q(:)
      real(wp) :: inputs(size(chain%phase))
      integer :: k

      inputs = 0.0_wp
      do k = 1, size(q)
         inputs = inputs + chain%share(:, k)*q(k)
      end do
   end function product_of_shares

   !> From the drawing to the beginning of the laws, and once round.
   subroutine go_round(chain)
      type(cam_chain_t), intent(inout) :: chain
      type(node_t) :: node
      type(state_t) :: single(size(chain%law))
      real(wp) :: y(size(chain%law), 0:most_orders), first(size(chain%law), 0:most_orders), d(size(chain%law), 0:most_orders), &
                  miss(size(chain%law)), step, h, back(size(chain%law))
      integer :: k, group
      logical :: reached

      allocate (chain%nodes(0))
      node%state = chain%drawn
      allocate (node%q(size(chain%law), 0:most_orders), source=0.0_wp)
      chain%fault = fault_open
      if (any(abs(chain%phase) > 0.0_wp)) then
         call advance(chain%closure, chain%phase, node%state, reached, k)
         if (.not. reached) return
      end if
      first = laws_at(chain, 0.0_wp, 0)
      y = first
      y(:, 1:) = 0.0_wp
      call values_at(chain, node%state, y, miss, d)
      do k = 1, size(miss)
         miss(k) = miss(k)/unit_of(chain%angular(k))
      end do
      do k = 1, steps_to_law
         y(:, 0) = first(:, 0) - miss*(real(steps_to_law - k, wp)/real(steps_to_law, wp))
         call settle(chain, y, .false., node%state, node%q, single, chain%fault)
         if (chain%fault /= fault_none) return
      end do
      step = full_turn/real(nodes_of_turn, wp)
      deallocate (chain%nodes)
      allocate (chain%nodes(nodes_of_turn + 1))
      do k = 1, nodes_of_turn + 1
         chain%fault_at = step*real(k - 1, wp)
         y = laws_at(chain, chain%fault_at, 0)
         if (k > 1) then
            h = step*radians_per_degree
            node%q(:, 0) = node%q(:, 0) + h*(node%q(:, 1) + 0.5_wp*h*node%q(:, 2))
            call advance(chain%closure, inputs_of(chain, node%q(:, 0)), node%state, reached, group)
            if (.not. reached) then
               chain%fault = fault_open
               return
            end if
         end if
         call settle(chain, y, .false., node%state, node%q, single, chain%fault)
         if (chain%fault /= fault_none) return
         chain%nodes(k) = node
      end do
      ! the same again, but for whole turns
      associate (drives => chain%closure%sketch%drives(chain%drive))
         do k = 1, size(back)
            back(k) = node%q(k, 0) - chain%nodes(1)%q(k, 0)
            if (drives(k)%kind == drive_turns) back(k) = nearest_difference(back(k)*degrees_per_radian, 0.0_wp)*radians_per_degree
         end do
      end associate
      if (any(abs(back) > same_again*max(1.0_wp, abs(node%q(:, 0))))) chain%fault = fault_open
   end subroutine go_round

   !> Output, input and follower at cam angles, each on its piece of the law.
   subroutine trace(self, angle, piece, states)
      class(cam_chain_t), intent(in) :: self
      real(wp), intent(in) :: angle(:)               !! degrees, shape (n)
      integer, intent(in) :: piece(:)
      type(cam_trace_t), intent(out) :: states
      type(state_t) :: state, single(size(self%law))
      real(wp) :: y(size(self%law), 0:most_orders), q(size(self%law), 0:most_orders), h
      complex(wp) :: p(0:most_orders)
      integer :: i, k, order
      logical :: closed

      call clear_trace(angle, states)
      p = (0.0_wp, 0.0_wp)
      p(0) = self%point
      do i = 1, size(angle)
         if (self%fault /= fault_none) then
            states%fault(i) = self%fault
            cycle
         end if
         y = laws_at(self, angle(i), piece(i))
         states%y(:, i) = y(self%own, :)
         k = 1 + nint(angle(i)*real(nodes_of_turn, wp)/full_turn)
         h = (angle(i) - full_turn*real(k - 1, wp)/real(nodes_of_turn, wp))*radians_per_degree
         state = self%nodes(k)%state
         q = self%nodes(k)%q
         q(:, 0) = q(:, 0) + h*(q(:, 1) + 0.5_wp*h*q(:, 2))
         state%t(:, 0) = state%t(:, 0) + h*(state%t(:, 1) + 0.5_wp*h*state%t(:, 2))
         state%phi(:, 0) = state%phi(:, 0) + h*(state%phi(:, 1) + 0.5_wp*h*state%phi(:, 2))
         call close_groups(self, q(:, 0), state, closed)
         if (.not. closed) then
            states%fault(i) = fault_open
            cycle
         end if
         call settle(self, y, .true., state, q, single, states%fault(i))
         if (states%fault(i) /= fault_none) cycle
         associate (unit => unit_of(self%closure%sketch%drives(self%drive(self%own))%kind == drive_turns))
            states%q(:, i) = q(self%own, :)
            states%q(0, i) = states%q(0, i)/unit
         end associate
         do order = 0, most_orders
            states%c(order, i) = point_rate(state, self%link, order, p)
         end do
         states%turning(:, i) = state%phi(self%link, 1:)
         states%direction(i) = turned(state%phi(self%link, 0))*self%along
         states%by_input(i) = point_rate(single(self%own), self%link, 1, p)
         states%turning_by_input(i) = single(self%own)%phi(self%link, 1)
      end do
   end subroutine trace
end module psalm_cam_chain
