!> A row of positions as pictures show them: joints, slides, output, what does not close, in machine axes.
!>
!> Every loop is solved, wanted by the output or not. What is the output's own (actual, error, closed) is what `psalm` has, so that
!> pictures and device 9 agree to the last digit.
module psalm_trace
   use psalm_angles, only: degrees_of
   use psalm_dyad_kind, only: assur_rrr, direction_known, form_of, form_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t, violation_t
   use psalm_finale, only: describe_violation
   use psalm_kinds, only: wp
   use psalm_linkage, only: padded
   use psalm_markup, only: strings_t, add_string
   use psalm_moving_joints, only: sketch_motion_t
   use psalm_observable, only: observable_t
   use psalm_output_kind, only: motion_point
   use psalm_parts, only: drawn_slide_t
   use psalm_row_study, only: solved_row_t
   use psalm_sketch_motion, only: find_places
   use psalm_text, only: upper_case
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: arc_slide, at_finish, at_start
   implicit none (type, external)
   private
   public :: position_row_t, trace_row, trace_points, rail_ends

   !> A row of positions. Co-ordinates in machine axes; what is not known is 0 with `known` false.
   type :: position_row_t
      integer :: n = 0
      real(wp), allocatable :: input(:), delt(:)          !! degrees within a turn or length; increments
      logical, allocatable :: closed(:)                   !! every loop the output depends on closes
      logical, allocatable :: beyond(:)                   !! of a sketch: it closes, but is not reached from the drawing
      real(wp), allocatable :: actual(:), actual_y(:)     !! as on device 9
      real(wp), allocatable :: error(:), error_y(:)
      real(wp), allocatable :: wanted(:), desired_y(:)     !! size 0 without desired values
      real(wp), allocatable :: x(:, :), y(:, :)           !! shape (joints, n)
      logical, allocatable :: known(:, :)                 !! shape (joints, n)
      real(wp), allocatable :: ux(:, :), uy(:, :)         !! shape (slides, n): direction of the arc
      logical, allocatable :: valid(:, :)                 !! shape (loops, n): closes, and so do all it hangs on
      logical, allocatable :: broken(:, :)                !! shape (loops, n): does not close, though its outer joints are known
      real(wp), allocatable :: tip(:, :, :)               !! shape (4, loops, n): where p and q of a broken loop end; x, y, x, y
      real(wp), allocatable :: other(:, :, :)             !! shape (2, loops, n): common joint of a pair in its other assembly
      logical, allocatable :: other_known(:, :)           !! shape (loops, n): there is one
      real(wp), allocatable :: actual_mark(:, :), desired_mark(:, :) !! shape (2, n): where a line along the actual direction of the
                                                          !! output arc ends (MOTION 1); the desired place of the output
      real(wp), allocatable :: angle(:, :)                !! shape (loops, n): transmission angle of link pairs, degrees
      type(violation_t), allocatable :: violations(:)
      type(strings_t), allocatable :: words(:)            !! of each violation
      logical :: violated = .false.                       !! the output's own loops violate closure or limits
   end type position_row_t

contains

   !> The ends of the rail of a slide: shape (x and y, ends).
   pure function rail_ends(row, slides, slide, position) result(ends)
      type(position_row_t), intent(in) :: row
      type(drawn_slide_t), intent(in) :: slides(:)
      integer, intent(in) :: slide, position
      real(wp) :: ends(2, 2), from(2), along(2)

      associate (one => slides(slide))
         from = [row%x(one%guide, position), row%y(one%guide, position)]
         along = one%sense*[row%ux(slide, position), row%uy(slide, position)]
         ends(:, 1) = from + one%low*along
         ends(:, 2) = from + one%high*along
      end associate
   end function rail_ends

   !> Joints, slides and outputs at the positions of a row.
   subroutine trace_row(solved, every_loop, dimensions, slides, output_slide, prescribed, row)
      type(solved_row_t), intent(inout) :: solved
      logical, intent(in) :: every_loop         !! the output is known only where every loop closes
      type(dimensions_t), intent(in) :: dimensions
      type(drawn_slide_t), intent(in) :: slides(:)    !! joints by numbers of the mechanism's points
      integer, intent(in) :: output_slide       !! MOTION 3: the slide whose length is the output, else 0
      logical, intent(in) :: prescribed         !! the positions are the user's own, with numbers he knows
      type(position_row_t), intent(out) :: row
      type(observable_t) :: output_point
      real(wp), allocatable :: points(:, :)   ! shape (2, positions): the output point
      character(:), allocatable :: words
      integer :: block, offset, n, i, k, joints, loops
      integer, allocatable :: undetermined(:)   ! by position: a loop of whose dyad the outer joints coincide

      associate (own => solved%problem, motion => solved%motion, y => size(solved%motion%actual, 2))
         row%n = own%positions
         row%violated = any([(own%asked(motion%violations(i)%loop) .or. every_loop, i=1, size(motion%violations))])
         row%delt = own%delt
         row%input = motion%input
         row%closed = merge(motion%closed, motion%output_known, every_loop)
         if (allocated(motion%beyond)) row%beyond = motion%beyond
         row%actual = motion%actual(:, 1)
         row%error = motion%error(:, 1)
         row%actual_y = spread(0.0_wp, 1, row%n)
         row%error_y = row%actual_y
         allocate (row%wanted(0), row%desired_y(0))
         if (own%desired) row%wanted = own%wanted(:row%n, 1)
         if (y > 1) then
            row%actual_y = motion%actual(:, 2)
            row%error_y = motion%error(:, 2)
            if (own%desired) row%desired_y = own%wanted(:row%n, 2)
         end if
         allocate (row%violations(size(motion%violations)))
         row%violations = motion%violations
         allocate (row%words(0))
         do i = 1, size(row%violations)
            words = describe_violation(own, motion%input, row%violations(i), prescribed, small=.true.)
            call add_string(row%words, upper_case(words(:1))//words(2:))
         end do
         joints = size(own%mechanism%points) + 1
         loops = own%mechanism%nloop
         call output_point%locate(motion_point, own%mechanism, own%plan, own%linkage)
         call output_point%bind(dimensions, own%linkage)
      end associate
      allocate (row%x(joints, row%n), row%y(joints, row%n), source=0.0_wp)
      allocate (row%known(joints, row%n), row%valid(loops, row%n), row%broken(loops, row%n), source=.false.)
      allocate (row%ux(size(slides), row%n), row%uy(size(slides), row%n), source=0.0_wp)
      allocate (row%tip(4, loops, row%n), row%angle(loops, row%n), source=0.0_wp)
      allocate (undetermined(row%n), points(2, row%n))
      call solved%problem%find_undetermined(undetermined)
      do block = 1, solved%problem%blocks()
         call solved%problem%solve_block(block, offset, n)
         call output_point%observe(padded(n), solved%problem%linkage)
         do i = 1, n
            call place_joints(solved%problem, slides, i, offset + i, undetermined(offset + i), row)
            points(:, offset + i) = [(output_point%actual(k, i, solved%problem%linkage), k=1, 2)]
         end do
      end do
      do k = 1, row%n
         call place_output(solved%problem, slides, output_slide, points(:, k), k, row)
      end do
   end subroutine trace_row

   !> Further points of a sketch, after the joints of a row; known where all loops close.
   subroutine trace_points(solved, dimensions, sketch, joints, row)
      type(solved_row_t), intent(in) :: solved
      type(dimensions_t), intent(in) :: dimensions
      type(sketch_motion_t), intent(in) :: sketch
      integer, intent(in) :: joints(:)          !! numbers of the sketch
      type(position_row_t), intent(inout) :: row
      class(problem_t), allocatable :: own      ! large: it would fill a small stack
      complex(wp), allocatable :: places(:, :)
      real(wp), allocatable :: moved(:, :), x(:, :), y(:, :)
      logical, allocatable :: known(:, :)
      integer :: block, offset, n, i, before

      before = size(row%x, 1)
      allocate (x(before + size(joints), row%n), y(before + size(joints), row%n), source=0.0_wp)
      allocate (known(before + size(joints), row%n), source=.false.)
      x(:before, :) = row%x
      y(:before, :) = row%y
      known(:before, :) = row%known
      allocate (own, source=solved%problem)
      call own%want_derivatives(.true., sketch%points)
      call own%bind(dimensions)
      allocate (places(size(sketch%drawn), own%linkage%capacity), moved(size(sketch%arcs), own%linkage%capacity))
      do block = 1, own%blocks()
         call own%solve_block(block, offset, n)
         call find_places(sketch, own, n, places(:, :n), moved(:, :n))
         do i = 1, n
            known(before + 1:, offset + i) = all(row%valid(:, offset + i))
            if (.not. known(before + 1, offset + i)) cycle
            x(before + 1:, offset + i) = real(places(joints, i), wp)
            y(before + 1:, offset + i) = aimag(places(joints, i))
         end do
      end do
      call move_alloc(x, row%x)
      call move_alloc(y, row%y)
      call move_alloc(known, row%known)
   end subroutine trace_points

   !> Joints in the order of the mechanism's points: each from one before it.
   subroutine place_joints(problem, slides, i, k, undetermined, row)
      type(problem_t), intent(in) :: problem
      type(drawn_slide_t), intent(in) :: slides(:)
      integer, intent(in) :: i, k       !! position of the block, of the row
      integer, intent(in) :: undetermined !! a loop without directions at this position, 0: none
      type(position_row_t), intent(inout) :: row
      integer :: j, loop, p, q, s, start, finish
      real(wp) :: x, y, length

      row%x(1, k) = problem%output%origin_x
      row%y(1, k) = problem%output%origin_y
      row%known(1, k) = .true.
      do loop = 1, problem%mechanism%nloop
         ! of a larger group all arcs are found or none
         if (.not. problem%mechanism%is_dyad(loop)) row%valid(loop, k) = problem%linkage%closes(i, loop)
      end do
      do j = 2, size(problem%mechanism%points)
         associate (point => problem%mechanism%points(j))
            loop = point%group
            if (loop > 0) then
               p = problem%mechanism%groups(loop)%members(1)
               q = problem%mechanism%groups(loop)%members(2)
               start = problem%mechanism%arcs(p)%ends(at_start)
               finish = problem%mechanism%arcs(q)%ends(at_finish)
               row%broken(loop, k) = row%known(start, k) .and. row%known(finish, k) .and. &
                                     is_known(problem, p, loop, row%valid(:, k)) .and. is_known(problem, q, loop, row%valid(:, k))
               if (row%broken(loop, k)) then
                  row%valid(loop, k) = problem%linkage%closes(i, loop) .and. undetermined /= loop
                  row%broken(loop, k) = .not. row%valid(loop, k)
               end if
               row%known(j, k) = row%valid(loop, k)
               if (row%broken(loop, k)) call leave_open(problem, loop, p, q, start, finish, i, k, row)
               if (row%valid(loop, k) .and. problem%mechanism%groups(loop)%kind == assur_rrr) &
                  row%angle(loop, k) = transmission_angle(problem, p, q, i)
            else
               row%known(j, k) = row%known(point%from, k) .and. is_known(problem, point%arc, 0, row%valid(:, k))
            end if
            if (.not. row%known(j, k)) cycle
            call problem%linkage%arc_at(problem%plan, point%arc, i, x, y, length)
            row%x(j, k) = row%x(point%from, k) + real(point%sense, wp)*length*x
            row%y(j, k) = row%y(point%from, k) + real(point%sense, wp)*length*y
         end associate
      end do
      do s = 1, size(slides)
         associate (arc => problem%mechanism%bars(slides(s)%bar)%arc)
            if (.not. is_known(problem, arc, 0, row%valid(:, k))) cycle
            call problem%linkage%arc_at(problem%plan, arc, i, row%ux(s, k), row%uy(s, k), length)
         end associate
      end do
   end subroutine place_joints

   !> True if the loops that find an arc's direction and length close; the loop `within` is not asked.
   pure logical function is_known(problem, n, within, valid)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: n, within
      logical, intent(in) :: valid(:)    !! by loop, so far
      integer :: loop, arc

      is_known = .true.
      loop = problem%plan%root_loop(problem%plan%root(n))
      if (loop > 0 .and. loop /= within) is_known = valid(loop)
      arc = problem%mechanism%arcs(n)%representative
      if (problem%mechanism%arcs(arc)%kind /= arc_slide) return
      loop = problem%mechanism%loop_of(arc)
      if (loop /= within) is_known = is_known .and. valid(loop)
   end function is_known

   !> A pair that does not meet: each arc is drawn from its own outer joint in the direction that comes nearest.
   pure subroutine leave_open(problem, loop, p, q, start, finish, i, k, row)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: loop, p, q, start, finish, i, k !! its arcs, its outer joints; position of the block, of the row
      type(position_row_t), intent(inout) :: row
      type(form_t) :: form
      real(wp) :: x, y, length, along

      call reach_out(p, x, y)
      row%tip(1, loop, k) = row%x(start, k) + x
      row%tip(2, loop, k) = row%y(start, k) + y
      call reach_out(q, x, y)
      row%tip(3, loop, k) = row%x(finish, k) - x
      row%tip(4, loop, k) = row%y(finish, k) - y
      ! a slide is as long as it must be to come nearest to the link
      form = form_of(problem%mechanism%groups(loop)%kind)
      if (count(form%slides) /= 1 .or. all(form%direction /= direction_known)) return
      if (form%slides(2)) then
         call problem%linkage%arc_at(problem%plan, q, i, x, y, length)
         along = (row%tip(1, loop, k) - row%tip(3, loop, k))*x + (row%tip(2, loop, k) - row%tip(4, loop, k))*y
         row%tip(3:4, loop, k) = row%tip(3:4, loop, k) + along*[x, y]
      else
         call problem%linkage%arc_at(problem%plan, p, i, x, y, length)
         along = (row%tip(3, loop, k) - row%tip(1, loop, k))*x + (row%tip(4, loop, k) - row%tip(2, loop, k))*y
         row%tip(1:2, loop, k) = row%tip(1:2, loop, k) + along*[x, y]
      end if

   contains

      pure subroutine reach_out(n, x, y)
         integer, intent(in) :: n
         real(wp), intent(out) :: x, y
         real(wp) :: length, unit

         call problem%linkage%arc_at(problem%plan, n, i, x, y, length)
         unit = hypotenuse(x, y)
         if (problem%plan%length_slot(n) > 0 .or. unit <= tiny(unit)) then
            x = 0.0_wp
            y = 0.0_wp
         else
            ! the kernels' direction is no unit vector where the root was clamped
            x = length*(x/unit)
            y = length*(y/unit)
         end if
      end subroutine reach_out
   end subroutine leave_open

   !> Angle between the links of a pair at their joint, degrees.
   pure real(wp) function transmission_angle(problem, p, q, i) result(angle)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: p, q, i
      real(wp) :: px, py, qx, qy, length

      call problem%linkage%arc_at(problem%plan, p, i, px, py, length)
      call problem%linkage%arc_at(problem%plan, q, i, qx, qy, length)
      angle = degrees_of(-(px*qx + py*qy), abs(px*qy - py*qx))
   end function transmission_angle

   !> The output point is the last joint of the row; with MOTION 3 it is the block on the sliding arc.
   subroutine place_output(own, slides, output_slide, point, k, row)
      type(problem_t), intent(in) :: own
      type(drawn_slide_t), intent(in) :: slides(:)
      integer, intent(in) :: output_slide
      real(wp), intent(in) :: point(2)        !! the output point
      integer, intent(in) :: k
      type(position_row_t), intent(inout) :: row
      integer :: j, base

      j = size(own%mechanism%points) + 1
      if (output_slide > 0) then
         base = slides(output_slide)%block
         row%known(j, k) = row%known(base, k)
         row%x(j, k) = row%x(base, k)
         row%y(j, k) = row%y(base, k)
         return
      end if
      associate (output => own%mechanism%outputs(1))
         base = own%mechanism%arcs(output%arc)%ends(merge(at_start, at_finish, output%from_start))
         row%known(j, k) = row%known(base, k) .and. is_known(own, output%arc, 0, row%valid(:, k))
      end associate
      if (.not. row%known(j, k)) return
      row%x(j, k) = point(1)
      row%y(j, k) = point(2)
      if (own%output%kind%components == 1 .or. .not. row%closed(k)) return
      row%x(j, k) = row%actual(k)
      row%y(j, k) = row%actual_y(k)
   end subroutine place_output
end module psalm_trace
