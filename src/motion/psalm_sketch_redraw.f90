!> A sketch drawn anew from the dimensions of its loops: joints and slides of a linkage that a search has found.
!>
!> The loops are solved at one input, and every joint is put where they have it, whatever groups they close. What was drawn is
!> assembled as a reader of the drawing would do it, and taken only if nothing moves then.
module psalm_sketch_redraw
   use psalm_angles, only: degrees_of, nearest_difference
   use psalm_closure, only: closure_t, state_t
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, new_problem, own_inputs_of
   use psalm_joint_location, only: locate_sketch
   use psalm_equalities, only: move_constants
   use psalm_kinds, only: wp, full_turn
   use psalm_mechanism, only: mechanism_t
   use psalm_moving_joints, only: sketch_motion_t
   use psalm_parameters, only: no_parameters
   use psalm_sketch, only: sketch_t, output_slide
   use psalm_sketch_assembly, only: assemble_sketch
   use psalm_sketch_motion, only: find_places
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: redraw_sketch

   real(wp), parameter :: still = 64.0_wp*epsilon(1.0_wp) !! of the drawing's size, and of a turn: moved by rounding only
   real(wp), parameter :: same_place = 1.0e-7_wp          !! of the drawing's size: near a dead point half of the digits are lost

contains

   !> Put the joints and slides of the case's sketch where the dimensions have them. The drawing shows the linkage at its reference
   !> input, or where it cannot be put together there at the nearest input of the case; `drawn` is false if there is none, and the
   !> sketch is then left as it was.
   subroutine redraw_sketch(set, mechanism, dimensions, inputs, sketch, from_drawing, drawn)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: inputs(:)         !! of the case: increments from the reference position
      type(sketch_t), intent(inout) :: sketch   !! the one of the case
      real(wp), intent(out) :: from_drawing     !! the reference input, counted from the new drawing
      logical, intent(out) :: drawn
      class(problem_t), allocatable :: problem  ! large: it would fill a small stack
      type(sketch_motion_t) :: motion
      real(wp) :: candidates(2 + size(inputs))  !! increments of the first drive
      real(wp) :: own(size(candidates), size(set%sketch%drives) - 1) !! those of the others, from the drawing
      logical :: tried(size(candidates))
      integer :: k, n, m, block, solved, offset

      candidates = [0.0_wp, inputs, dimensions%drawn - dimensions%crnki]
      own = 0.0_wp
      own(2:size(inputs) + 1, :) = own_inputs_of(set)
      allocate (problem)
      call new_problem(mechanism, dimensions, no_parameters(mechanism), candidates, .true., problem)
      call problem%set_inputs(candidates, own)
      call locate_sketch(set, motion, dimensions, with_slides=.true.)
      call problem%want_derivatives(.true., motion%points)
      call problem%bind(dimensions)
      tried = .false.
      solved = 0
      from_drawing = 0.0_wp
      drawn = .false.
      do n = 1, size(candidates)
         k = minloc(abs(candidates), dim=1, mask=.not. tried)
         tried(k) = .true.
         block = (k - 1)/problem%linkage%capacity + 1
         if (block /= solved) call problem%solve_block(block, offset, m)
         solved = block
         call draw(set, problem, motion, k - offset, own(k, :), sketch, drawn)
         if (.not. drawn) cycle
         from_drawing = -candidates(k)
         return
      end do
   end subroutine redraw_sketch

   !> Draw the linkage as it stands at position `at` of the block just solved.
   subroutine draw(set, problem, motion, at, own, sketch, drawn)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(sketch_motion_t), intent(in) :: motion
      integer, intent(in) :: at
      real(wp), intent(in) :: own(:)            !! shape (drives after the first): their inputs there
      type(sketch_t), intent(inout) :: sketch
      logical, intent(out) :: drawn
      type(sketch_t) :: new
      complex(wp) :: place(size(motion%drawn), at)
      real(wp) :: travel(size(motion%arcs), at), extent, x, y, length, turned
      integer :: k, joints

      drawn = all([(problem%linkage%closes(at, k), k=1, problem%mechanism%nloop)])
      if (.not. drawn) return
      call find_places(motion, problem, at, place, travel)
      new = sketch
      joints = size(new%x)
      extent = max(maxval(abs(place(:joints, at)%re)), maxval(abs(place(:joints, at)%im)))
      where (abs(place(:, at) - motion%drawn) <= still*extent) place(:, at) = motion%drawn
      new%x = place(:joints, at)%re
      new%y = place(:joints, at)%im
      do k = 1, size(new%slides)
         associate (slide => new%slides(k), arc => motion%arcs(k))
            slide%x = place(joints + k, at)%re
            slide%y = place(joints + k, at)%im
            call problem%linkage%arc_at(problem%plan, arc, at, x, y, length)
            turned = nearest_difference(degrees_of(x, y), set%traced%arcs(arc)%direction)
            if (abs(turned) > still*full_turn) slide%angle = slide%angle + turned
         end associate
      end do
      ! the lengths are in the coordinates now, and every drive and slide is counted from the new drawing
      deallocate (new%length_of, new%length, new%variations)
      allocate (new%length_of(2, 0), new%length(0), new%variations(0))
      do k = 2, size(new%drives)
         associate (drive => new%drives(k))
            if (drive%geared) drive%phase = 0.0_wp
            if (allocated(drive%delt)) drive%delt = drive%delt - own(k - 1)
            drive%low = drive%low - own(k - 1)
            drive%high = drive%high - own(k - 1)
         end associate
      end do
      do k = 1, size(new%outputs)
         associate (output => new%outputs(k))
            if (output%kind /= output_slide) cycle
            call move_constants(new, k, travel(output%slide, at))
            if (.not. output%has_target()) cycle
            output%targets(0)%values = output%targets(0)%values - travel(output%slide, at)
         end associate
      end do
      drawn = reads_back(new, same_place*extent)
      if (drawn) sketch = new
   end subroutine draw

   !> True if a sketch is put together where it is drawn.
   logical function reads_back(sketch, slack)
      type(sketch_t), intent(in) :: sketch
      real(wp), intent(in) :: slack             !! that joints may be off their places
      type(data_set_t), allocatable :: alone    ! a case of nothing else: large, too
      type(closure_t) :: closure
      type(state_t) :: state
      type(diagnostics_t) :: unused

      allocate (alone)
      alone%sketch = sketch
      call assemble_sketch(alone, closure, state, reads_back, unused)
      if (reads_back) reads_back = all(abs(state%joint(:, 0) - cmplx(sketch%x, sketch%y, wp)) <= slack)
   end function reads_back
end module psalm_sketch_redraw
