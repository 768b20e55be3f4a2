!> CONSTR: make a vertex of the simplex obey the constraints.
!>
!> Bounds are clipped. A dyad that does not close, or whose transmission angle is out of limits, is repaired by changing
!> its own variable lengths; where that is impossible the vertex moves a quarter of the way towards a linkage known to be
!> feasible, and everything starts again. Source: Oldham (1977), sections 6.3 and 6.4.3. Difference from the thesis: the
!> lowest offending loop is repaired over all positions, then evaluation restarts; the thesis goes position by position.
module psalm_constr
   use psalm_angles, only: unit_vector
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, degrees_per_radian, half_turn, right_angle
   use psalm_topology, only: dimensions_t, variable_length, variable_outlk
   implicit none (type, external)
   private
   public :: constraints_t, repair_count_t, make_constraints, constrain, repair_link_pair

   real(wp), parameter :: inside = 1.0e-6_wp*degrees_per_radian !! degrees a repaired transmission angle is put inside its limit
   real(wp), parameter :: quarter = 0.25_wp                     !! of the way towards a feasible linkage
   integer, parameter :: most_moves = 60                        !! 0.75**60 = 3e-8: the vertex has arrived
   integer, parameter :: repairs_per_loop = 4                   !! repairs before a pair of loops that undo each other gives up

   !> Limits on the variables, and room to work in.
   type :: constraints_t
      logical :: bounded = .false.                !! LIMVAL
      real(wp), allocatable :: low(:), high(:)    !! shape (marble): OPLOW, OPHIGH
      logical, allocatable :: positive(:)         !! shape (marble): a length
      real(wp) :: step_in = 0.0_wp                !! STEPIN
      type(dimensions_t) :: dimensions            !! the vertex as a linkage
      real(wp), allocatable :: reach(:)           !! shape (positions)
   end type constraints_t

   !> What was done to vertices.
   type :: repair_count_t
      integer :: calls = 0     !! violations met
      integer :: repairs = 0   !! dyads repaired
      integer :: moves = 0     !! quarter moves
      integer :: clips = 0     !! values put inside their bounds
      integer :: loop = 0      !! loop of the last violation
   end type repair_count_t

contains

   !> Constraints of a data set for a problem.
   subroutine make_constraints(set, problem, constraints)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(constraints_t), intent(out) :: constraints
      integer :: marble

      marble = size(problem%topology%variables)
      constraints%bounded = set%limval == 1
      if (constraints%bounded) then
         constraints%low = set%oplow(:marble)
         constraints%high = set%ophigh(:marble)
      end if
      constraints%positive = problem%topology%variables%kind == variable_length .or. &
                             problem%topology%variables%kind == variable_outlk
      constraints%step_in = set%stepin
      constraints%dimensions = problem%given
      allocate (constraints%reach(problem%positions), source=0.0_wp)
   end subroutine make_constraints

   !> Objective of a vertex, altered where the constraints demand it.
   !>
   !> With `towards`, a vertex whose demands conflict moves towards it; without, `feasible` is false then.
   subroutine constrain(problem, constraints, values, objective, feasible, evaluations, counts, towards)
      type(problem_t), intent(inout) :: problem
      type(constraints_t), intent(inout) :: constraints
      real(wp), intent(inout) :: values(:)             !! shape (marble)
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible
      integer, intent(inout) :: evaluations            !! counts up
      type(repair_count_t), intent(inout) :: counts    !! counts up
      real(wp), intent(in), optional :: towards(:)     !! shape (marble): a feasible vertex
      integer :: loop, repairs, moves
      logical :: repaired

      moves = 0
      each_place: do
         repairs = 0
         call clip(constraints, values, counts%clips)
         do
            call problem%topology%apply(values, constraints%dimensions)
            call problem%evaluate(constraints%dimensions, objective, loop)
            evaluations = evaluations + 1
            feasible = loop == 0
            if (feasible) return
            counts%calls = counts%calls + 1
            counts%loop = loop
            repairs = repairs + 1
            if (repairs > repairs_per_loop*problem%topology%nloop) exit
            call repair(problem, constraints, loop, values, repaired)
            if (.not. repaired) exit
            counts%repairs = counts%repairs + 1
         end do
         if (.not. present(towards)) return
         moves = moves + 1
         if (moves > most_moves) then
            values = towards
         else
            values = values + quarter*(towards - values)
         end if
         if (moves > most_moves + 1) return
         counts%moves = counts%moves + 1
      end do each_place
   end subroutine constrain

   !> Put values that are out of bounds a little inside; lengths stay positive.
   pure subroutine clip(constraints, values, clips)
      type(constraints_t), intent(in) :: constraints
      real(wp), intent(inout) :: values(:)
      integer, intent(inout) :: clips
      integer :: i
      real(wp) :: before

      do i = 1, size(values)
         before = values(i)
         if (constraints%bounded) then
            associate (low => constraints%low(i), high => constraints%high(i), step => constraints%step_in)
               if (values(i) < low) values(i) = min(low + step, 0.5_wp*(low + high))
               if (values(i) > high) values(i) = max(high - step, 0.5_wp*(low + high))
            end associate
         end if
         if (constraints%positive(i) .and. values(i) <= 0.0_wp) values(i) = max(constraints%step_in, epsilon(1.0_wp))
         if (values(i) /= before) clips = clips + 1
      end do
   end subroutine clip

   !> Change the variable lengths of the dyad of `loop` so that it is accepted at every position.
   subroutine repair(problem, constraints, loop, values, repaired)
      type(problem_t), intent(inout) :: problem
      type(constraints_t), intent(inout) :: constraints
      integer, intent(in) :: loop
      real(wp), intent(inout) :: values(:)
      logical, intent(out) :: repaired
      integer :: vp, vq
      real(wp) :: p, q

      associate (topology => problem%topology, reach => constraints%reach, arcl => constraints%dimensions%arcl)
         associate (arc_p => topology%seq(loop, topology%larcx(1, loop)), arc_q => topology%seq(loop, topology%larcx(2, loop)))
            vp = topology%length_variable(arc_p)
            vq = topology%length_variable(arc_q)
            p = arcl(arc_p)
            q = arcl(arc_q)
         end associate
         repaired = .false.
         if (vp == 0 .and. vq == 0) return
         call problem%reach_of(loop, reach)
         select case (topology%joint(loop))
         case (1)
            call repair_link_pair(reach, problem%tangle, vp > 0, vq > 0, p, q, repaired)
         case (2)
            q = sqrt(minval(reach)) - problem%toggle
            repaired = vq > 0 .and. q >= 0.0_wp
         case (3)
            p = sqrt(minval(reach)) - problem%toggle
            repaired = vp > 0 .and. p >= 0.0_wp
         case (4)
            p = maxval(abs(reach)) + problem%toggle
            repaired = vp > 0
         case (5)
            q = maxval(abs(reach)) + problem%toggle
            repaired = vq > 0
         end select
      end associate
      if (.not. repaired) return
      if (vp > 0) call change(vp, p)
      if (vq > 0) call change(vq, q)

   contains

      subroutine change(variable, value)
         integer, intent(in) :: variable
         real(wp), intent(in) :: value

         if (constraints%bounded) then
            if (value < constraints%low(variable) .or. value > constraints%high(variable)) repaired = .false.
         end if
         values(variable) = value
      end subroutine change
   end subroutine repair

   !> Repair of a type 1 dyad: one or both lengths change until the transmission angle is within limits at every position.
   !>
   !> Formulas of section 6.3 of the thesis, each from the cosine rule h**2 = p**2 + q**2 - 2 p q cos(mu); the forms for one
   !> variable length are solved from the same rule.
   pure subroutine repair_link_pair(reach, tangle, vary_p, vary_q, p, q, repaired)
      real(wp), intent(in) :: reach(:)           !! shape (positions): h**2
      real(wp), intent(in) :: tangle             !! allowed deviation from 90 degrees
      logical, intent(in) :: vary_p, vary_q      !! the length may change
      real(wp), intent(inout) :: p, q            !! lengths
      logical, intent(out) :: repaired           !! false: the demands of the positions conflict
      real(wp) :: c_low, s_low, half_sine, c_high, unused, k, d
      logical :: frozen
      integer :: i

      ! aim a little inside: the smallest angle raised, the largest lowered
      call unit_vector(right_angle - tangle + inside, c_low, s_low)
      call unit_vector((right_angle - tangle + inside)/2.0_wp, unused, half_sine)
      call unit_vector(half_turn - (right_angle - tangle) - inside, c_high, unused)
      frozen = .false.
      repaired = .false.
      do i = 1, size(reach)
         d = reach(i)
         if (d > p*p + q*q - 2.0_wp*p*q*c_high) then
            if (frozen) return
            if (vary_p .and. vary_q) then
               k = 0.5_wp*(sqrt((2.0_wp*d - (1.0_wp + c_high)*(p - q)**2)/(1.0_wp - c_high)) - (p + q))
               p = p + k
               q = q + k
            else if (vary_p) then
               p = q*c_high + sqrt(d - q*q*(1.0_wp - c_high)*(1.0_wp + c_high))
            else
               q = p*c_high + sqrt(d - p*p*(1.0_wp - c_high)*(1.0_wp + c_high))
            end if
         else if (d < p*p + q*q - 2.0_wp*p*q*c_low) then
            if (p <= q) then
               call close_up(d, c_low, s_low, half_sine, vary_p, vary_q, p, q, frozen)
            else
               call close_up(d, c_low, s_low, half_sine, vary_q, vary_p, q, p, frozen)
            end if
         end if
         if (.not. (p > 0.0_wp .and. q > 0.0_wp)) return
      end do
      call unit_vector(right_angle - tangle, c_low, unused)
      call unit_vector(right_angle + tangle, c_high, unused)
      repaired = all(reach <= p*p + q*q - 2.0_wp*p*q*c_high .and. reach >= p*p + q*q - 2.0_wp*p*q*c_low)
   end subroutine repair_link_pair

   !> The difference of the links is too great: the shorter is lengthened, or the longer shortened where only that may vary.
   !>
   !> Both lengths are made equal where no shorter link would do. A length of -1 says that nothing helps.
   pure subroutine close_up(d, cosine, sine, half_sine, vary_short, vary_long, short, long, frozen)
      real(wp), intent(in) :: d                       !! h**2
      real(wp), intent(in) :: cosine, sine, half_sine !! of the smallest angle; sine of its half
      logical, intent(in) :: vary_short, vary_long
      real(wp), intent(inout) :: short, long
      logical, intent(inout) :: frozen                !! set: the links may not be lengthened again
      real(wp) :: root

      if (vary_short) then
         root = d - (long*sine)**2
         if (root >= 0.0_wp) then
            root = sqrt(root)
            short = long*cosine - root
            ! limits near 90 degrees: only the other solution is a length
            if (short <= 0.0_wp) short = long*cosine + root
         else if (vary_long) then
            short = 0.5_wp*sqrt(d)/half_sine
            long = short
            frozen = .true.
         else
            short = -1.0_wp
         end if
      else
         root = d - (short*sine)**2
         long = -1.0_wp
         if (root >= 0.0_wp) long = short*cosine + sqrt(root)
      end if
   end subroutine close_up
end module psalm_constr
