!> The loop equations of a linkage in angles and lengths, one position at a time: what the rivals of `psalm` solve.
!>
!> Each loop has two unknowns: angles of links, lengths of slides. `unknown` holds them, two for each loop.
module bench_loops
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_plan, only: root_crank
   implicit none (type, external)
   private
   public :: loops_t, make_loops, first_unknowns, arc_angle, arc_length, loop_residual, solve_pair, output_point

   type :: loops_t
      integer :: nloop = 0
      integer, allocatable :: loopl(:), joint(:)     !! by loop
      integer, allocatable :: p(:), q(:)             !! by loop: undetermined arcs, sequential numbers
      integer, allocatable :: first(:)               !! by loop: sequential number of its first arc
      integer, allocatable :: angle_unknown(:)       !! by arc: unknown angle it turns with; 0 frame, -1 crank
      integer, allocatable :: length_unknown(:)      !! by arc: unknown that is its length; 0 fixed
      real(wp), allocatable :: angle(:), length(:)   !! by arc: radians from the root; length
      real(wp), allocatable :: sign(:)               !! by loop: as the plan has it (types 2, 3: turn of guide and slide)
      integer :: out_loop = 1, out_last = 0, out_arc = 1
      real(wp) :: out_angle = 0.0_wp, out_length = 0.0_wp
      real(wp) :: crank = 0.0_wp                     !! reference angle, radians
   end type loops_t

contains

   !> Take the loops from a problem that has been bound.
   subroutine make_loops(problem, loops)
      type(problem_t), intent(in) :: problem
      type(loops_t), intent(out) :: loops
      integer :: loop, n, count, root, slot, k
      integer, allocatable :: of_root(:), of_slot(:)

      associate (mechanism => problem%mechanism, plan => problem%plan, link => problem%linkage)
         loops%nloop = mechanism%nloop
         loops%loopl = mechanism%loops%arcs
         loops%joint = mechanism%groups%kind
         loops%first = [(mechanism%seq(loop, 1), loop=1, loops%nloop)]
         loops%p = [(mechanism%groups(loop)%members(1), loop=1, loops%nloop)]
         loops%q = [(mechanism%groups(loop)%members(2), loop=1, loops%nloop)]
         loops%angle = link%angle*radians_per_degree
         loops%length = link%length/link%scale
         allocate (of_root(plan%nroots), of_slot(max(1, plan%nlengths)), source=0)
         of_root(root_crank) = -1
         do loop = 1, loops%nloop
            count = 0
            do k = 1, 2
               n = merge(loops%p(loop), loops%q(loop), k == 1)
               root = plan%root(n)
               if (plan%root_loop(root) == loop .and. of_root(root) == 0) then
                  count = count + 1
                  of_root(root) = 2*(loop - 1) + count
               end if
               slot = plan%length_slot(n)
               if (slot > 0) then
                  count = count + 1
                  of_slot(slot) = 2*(loop - 1) + count
               end if
            end do
         end do
         allocate (loops%angle_unknown(size(plan%root)), loops%length_unknown(size(plan%root)), source=0)
         do n = 1, size(plan%root)
            if (plan%root(n) > 0) loops%angle_unknown(n) = of_root(plan%root(n))
            if (plan%length_slot(n) > 0) loops%length_unknown(n) = of_slot(plan%length_slot(n))
         end do
         loops%sign = [(link%steps(link%step_of_loop(loop))%dyad%sign, loop=1, loops%nloop)]
         loops%out_arc = mechanism%outputs(1)%arc
         loops%out_loop = mechanism%loop_of(mechanism%outputs(1)%arc)
         loops%out_last = mechanism%arcs(mechanism%outputs(1)%arc)%place
         if (mechanism%outputs(1)%from_start) loops%out_last = loops%out_last - 1
         loops%out_angle = problem%output%angle*radians_per_degree
         loops%out_length = problem%output%length
         loops%crank = problem%given%crnki*radians_per_degree
      end associate
   end subroutine make_loops

   !> Unknowns at the first position of the block that `problem` has solved last (with everything in its plan).
   subroutine first_unknowns(problem, loops, unknown)
      type(problem_t), intent(in) :: problem
      type(loops_t), intent(in) :: loops
      real(wp), intent(out) :: unknown(:)  !! shape (2 nloop)
      integer :: loop, n, k
      real(wp) :: x, y, length

      unknown = 0.0_wp
      do loop = 1, loops%nloop
         do k = 1, 2
            n = merge(loops%p(loop), loops%q(loop), k == 1)
            call problem%linkage%arc_at(problem%plan, n, 1, x, y, length)
            if (loops%length_unknown(n) > 0) unknown(loops%length_unknown(n)) = length
            if (loops%angle_unknown(n) > 2*(loop - 1)) unknown(loops%angle_unknown(n)) = atan2(y, x) - loops%angle(n)
         end do
      end do
   end subroutine first_unknowns

   pure real(wp) function arc_angle(loops, n, crank, unknown)
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: n
      real(wp), intent(in) :: crank, unknown(:)

      arc_angle = loops%angle(n)
      if (loops%angle_unknown(n) > 0) then
         arc_angle = arc_angle + unknown(loops%angle_unknown(n))
      else if (loops%angle_unknown(n) < 0) then
         arc_angle = arc_angle + crank
      end if
   end function arc_angle

   pure real(wp) function arc_length(loops, n, unknown)
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: n
      real(wp), intent(in) :: unknown(:)

      arc_length = loops%length(n)
      if (loops%length_unknown(n) > 0) arc_length = unknown(loops%length_unknown(n))
   end function arc_length

   !> Sum of a loop's arcs, its derivatives with respect to the loop's two unknowns, and its rate from everything else.
   pure subroutine loop_residual(loops, loop, crank, unknown, rate, sum_x, sum_y, jacobian, drift)
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: loop
      real(wp), intent(in) :: crank            !! radians
      real(wp), intent(in) :: unknown(:)       !! shape (2 nloop)
      real(wp), intent(in) :: rate(:)          !! shape (2 nloop): derivatives of earlier loops' unknowns by the crank angle
      real(wp), intent(out) :: sum_x, sum_y    !! residual
      real(wp), intent(out) :: jacobian(2, 2)  !! columns: the loop's unknowns
      real(wp), intent(out) :: drift(2)        !! derivative by the crank angle with the loop's unknowns held
      integer :: a, n, k
      real(wp) :: angle, length, c, s, turn, slide

      sum_x = 0.0_wp
      sum_y = 0.0_wp
      jacobian = 0.0_wp
      drift = 0.0_wp
      do a = 0, loops%loopl(loop) - 1
         n = loops%first(loop) + a
         angle = arc_angle(loops, n, crank, unknown)
         length = arc_length(loops, n, unknown)
         c = cos(angle)
         s = sin(angle)
         sum_x = sum_x + length*c
         sum_y = sum_y + length*s
         k = loops%angle_unknown(n) - 2*(loop - 1)
         turn = 0.0_wp
         if (k >= 1) then
            jacobian(:, k) = jacobian(:, k) + length*[-s, c]
         else if (loops%angle_unknown(n) < 0) then
            turn = 1.0_wp
         else if (loops%angle_unknown(n) > 0) then
            turn = rate(loops%angle_unknown(n))
         end if
         slide = 0.0_wp
         k = loops%length_unknown(n) - 2*(loop - 1)
         if (k >= 1) then
            jacobian(:, k) = jacobian(:, k) + [c, s]
         else if (loops%length_unknown(n) > 0) then
            slide = rate(loops%length_unknown(n))
         end if
         drift = drift + length*turn*[-s, c] + slide*[c, s]
      end do
   end subroutine loop_residual

   !> Solve a 2 x 2 system.
   pure function solve_pair(matrix, right) result(solution)
      real(wp), intent(in) :: matrix(2, 2), right(2)
      real(wp) :: solution(2)
      real(wp) :: determinant

      determinant = matrix(1, 1)*matrix(2, 2) - matrix(1, 2)*matrix(2, 1)
      solution(1) = (right(1)*matrix(2, 2) - right(2)*matrix(1, 2))/determinant
      solution(2) = (right(2)*matrix(1, 1) - right(1)*matrix(2, 1))/determinant
   end function solve_pair

   !> Output point from the unknowns: the arcs from the input pivot, then the output arc.
   pure subroutine output_point(loops, crank, unknown, x, y)
      type(loops_t), intent(in) :: loops
      real(wp), intent(in) :: crank, unknown(:)
      real(wp), intent(out) :: x, y
      integer :: a, n
      real(wp) :: angle

      x = 0.0_wp
      y = 0.0_wp
      do a = 0, loops%out_last - 1
         n = loops%first(loops%out_loop) + a
         angle = arc_angle(loops, n, crank, unknown)
         x = x + arc_length(loops, n, unknown)*cos(angle)
         y = y + arc_length(loops, n, unknown)*sin(angle)
      end do
      angle = arc_angle(loops, loops%out_arc, crank, unknown) - loops%angle(loops%out_arc) + loops%out_angle
      x = x + loops%out_length*cos(angle)
      y = y + loops%out_length*sin(angle)
   end subroutine output_point
end module bench_loops
