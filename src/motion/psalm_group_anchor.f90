!> Where a search starts to follow larger groups from.
!>
!> A group is followed from its drawing. In a search the drawing changes with every linkage, and one that is drawn beside a dead
!> point cannot be put together there when its lengths change. So it starts from the input of the case at which the given linkage
!> stands farthest from dead points.
module psalm_group_anchor
   use psalm_angles, only: degrees_of
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, new_problem
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, tie_t, arc_slide
   use psalm_parameters, only: no_parameters
   implicit none (type, external)
   private
   public :: choose_anchor

contains

   !> Put the unknown arcs of larger groups at the best of the inputs, if the linkage reaches any.
   subroutine choose_anchor(mechanism, inputs, dimensions)
      type(mechanism_t), intent(inout) :: mechanism !! turns of gears are counted from there, too
      real(wp), intent(in) :: inputs(:)             !! increments from the reference position
      type(dimensions_t), intent(inout) :: dimensions
      class(problem_t), allocatable :: problem      ! large: it would fill a small stack
      real(wp), allocatable :: least(:)             !! by position: the lowest measure of a larger group
      real(wp) :: x, y
      integer :: block, offset, n, i, loop, best, j

      allocate (problem)
      call new_problem(mechanism, dimensions, no_parameters(mechanism), inputs, .true., problem)
      allocate (least(problem%positions), source=huge(1.0_wp))
      call problem%bind(dimensions)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         do loop = 1, mechanism%nloop
            do i = 1, n
               if (.not. problem%linkage%closes(i, loop)) least(offset + i) = -1.0_wp
               if (.not. mechanism%is_dyad(loop)) &
                  least(offset + i) = min(least(offset + i), problem%linkage%store%v(i, problem%linkage%measure(loop)))
            end do
         end do
      end do
      best = maxloc(least, dim=1)
      if (.not. least(best) > 0.0_wp) return
      call problem%solve_block((best - 1)/problem%linkage%capacity + 1, offset, n)
      dimensions%anchor = dimensions%crnki + inputs(best)
      do loop = 1, mechanism%nloop
         if (mechanism%is_dyad(loop)) cycle
         do j = 1, size(mechanism%groups(loop)%members)
            associate (arc => mechanism%groups(loop)%members(j))
               if (mechanism%arcs(arc)%kind == arc_slide) then
                  call problem%linkage%arc_at(problem%plan, arc, best - offset, x, y, dimensions%arcl(arc))
               else
                  call problem%linkage%arc_at(problem%plan, arc, best - offset, x, y, least(best))
                  dimensions%gama(arc) = degrees_of(x, y)
               end if
            end associate
         end do
         if (.not. allocated(mechanism%groups(loop)%ties)) cycle
         do j = 1, size(mechanism%groups(loop)%ties)
            call draw_tie(problem, best - offset, mechanism%groups(loop)%ties(j))
         end do
      end do
   end subroutine choose_anchor

   !> The directions of the links of a tie at a position of the block just solved.
   subroutine draw_tie(problem, at, tie)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: at
      type(tie_t), intent(inout) :: tie
      real(wp) :: x, y, length
      integer :: k

      do k = 1, size(tie%arcs)
         if (tie%arcs(k) == 0) cycle
         call problem%linkage%arc_at(problem%plan, tie%arcs(k), at, x, y, length)
         tie%drawn(k) = degrees_of(x, y)
      end do
   end subroutine draw_tie
end module psalm_group_anchor
