!> Fewest arcs from point to point of a sketch through links whose place is known.
!>
!> Ways lead through the links that a group depends on, for others may not close where it does; where there is none, through any.
!> A slide is passed along only, never against its sense, for the arrays of &LINKS know no other.
!> Source: Oldham (1977), 15.1, the choice of minimal loops.
module psalm_sketch_paths
   use psalm_sketch, only: sketch_t, frame_link
   implicit none (type, external)
   private
   public :: path_step_t, tracing_t, know, nearest_point, way_from, shortest

   !> A step of a path: an arc of a link, or a slide passed again.
   type :: path_step_t
      integer :: link = 0
      integer :: from = 0, to = 0
      integer :: arc = 0                    !! of a slide
      integer :: drive = 0                  !! of a slide that has no arc yet: the drive along it
   end type path_step_t

   !> What is known on the way.
   type :: tracing_t
      logical, allocatable :: on(:, :)      !! shape (points, links): the point is fixed in the link
      logical, allocatable :: placed(:)     !! by link: its place is known
      logical, allocatable :: known(:)      !! by link: and the group that is traced depends on it
      integer :: points = 0
      integer, allocatable :: pass(:, :)    !! shape (4, capacity): slides that can be passed: from, to, arc, and the drive of one
                                            !! that has no arc yet
      integer :: passes = 0
   end type tracing_t

contains

   !> A link whose place is known, and its joints.
   subroutine know(sketch, link, tracing)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: link
      type(tracing_t), intent(inout) :: tracing

      tracing%placed(link) = .true.
      tracing%known(link) = .true.
      tracing%on(sketch%links(link)%joints, link) = .true.
   end subroutine know

   !> The point of a known link with the shortest way: outward from the input pivot `start`, else back to it by the frame.
   subroutine nearest_point(tracing, start, link, outward, point, steps, found)
      type(tracing_t), intent(in) :: tracing
      integer, intent(in) :: start, link
      logical, intent(in) :: outward
      integer, intent(out) :: point
      type(path_step_t), allocatable, intent(out) :: steps(:)
      logical, intent(out) :: found

      found = .false.
      point = 0
      allocate (steps(0))
      if (link == frame_link .and. .not. outward) then
         point = start
         steps = [path_step_t(frame_link, point, point)]
         found = .true.
         return
      end if
      call look(tracing%known)
      if (.not. found) call look(tracing%placed)

   contains

      subroutine look(through)
         logical, intent(in) :: through(:)  !! by link
         type(path_step_t), allocatable :: way(:)
         logical :: there
         integer :: p

         do p = 1, tracing%points
            if (.not. tracing%on(p, link)) cycle
            if (outward) then
               call way_through(tracing, through, start, p, .true., way, there)
            else
               call way_back(tracing, through, start, p, way, there)
            end if
            if (.not. there) cycle
            if (found .and. size(way) >= size(steps)) cycle
            found = .true.
            point = p
            steps = way
         end do
      end subroutine look
   end subroutine nearest_point

   !> From a point to the frame, not through it, and along the frame to the input pivot `start`.
   subroutine way_from(tracing, start, from, steps, found)
      type(tracing_t), intent(in) :: tracing
      integer, intent(in) :: start, from
      type(path_step_t), allocatable, intent(out) :: steps(:)
      logical, intent(out) :: found

      call way_back(tracing, tracing%known, start, from, steps, found)
      if (.not. found) call way_back(tracing, tracing%placed, start, from, steps, found)
   end subroutine way_from

   !> Fewest arcs from a point to another.
   subroutine shortest(tracing, from, to, through_frame, steps, found)
      type(tracing_t), intent(in) :: tracing
      integer, intent(in) :: from, to
      logical, intent(in) :: through_frame
      type(path_step_t), allocatable, intent(out) :: steps(:)
      logical, intent(out) :: found

      call way_through(tracing, tracing%known, from, to, through_frame, steps, found)
      if (.not. found) call way_through(tracing, tracing%placed, from, to, through_frame, steps, found)
   end subroutine shortest

   subroutine way_back(tracing, through, start, from, steps, found)
      type(tracing_t), intent(in) :: tracing
      logical, intent(in) :: through(:)     !! by link
      integer, intent(in) :: start, from
      type(path_step_t), allocatable, intent(out) :: steps(:)
      logical, intent(out) :: found
      type(path_step_t), allocatable :: way(:)
      logical :: there
      integer :: p

      found = .false.
      allocate (steps(0))
      do p = 1, tracing%points
         if (.not. tracing%on(p, frame_link)) cycle
         call way_through(tracing, through, from, p, .false., way, there)
         if (.not. there) cycle
         if (found .and. size(way) + 1 >= size(steps)) cycle
         found = .true.
         steps = [way, path_step_t(frame_link, p, start)]
      end do
   end subroutine way_back

   !> Fewest arcs from a point to another through some links (breadth first).
   subroutine way_through(tracing, through, from, to, through_frame, steps, found)
      type(tracing_t), intent(in) :: tracing
      logical, intent(in) :: through(:)     !! by link
      integer, intent(in) :: from, to
      logical, intent(in) :: through_frame
      type(path_step_t), allocatable, intent(out) :: steps(:)
      logical, intent(out) :: found
      type(path_step_t) :: reached_by(tracing%points)
      integer :: queue(tracing%points), head, tail, link, p, k
      logical :: seen(tracing%points)

      allocate (steps(0))
      seen = .false.
      seen(from) = .true.
      queue(1) = from
      head = 1
      tail = 1
      do while (head <= tail .and. .not. seen(to))
         associate (here => queue(head))
            do link = 1, size(through)
               if (.not. through(link) .or. .not. tracing%on(here, link)) cycle
               if (link == frame_link .and. .not. through_frame) cycle
               do p = 1, tracing%points
                  if (seen(p) .or. .not. tracing%on(p, link)) cycle
                  seen(p) = .true.
                  tail = tail + 1
                  queue(tail) = p
                  reached_by(p) = path_step_t(link, here, p)
               end do
            end do
            do k = 1, tracing%passes
               p = tracing%pass(2, k)
               if (tracing%pass(1, k) /= here .or. seen(p)) cycle
               seen(p) = .true.
               tail = tail + 1
               queue(tail) = p
               reached_by(p) = path_step_t(0, here, p, tracing%pass(3, k), tracing%pass(4, k))
            end do
         end associate
         head = head + 1
      end do
      found = seen(to)
      if (.not. found) return
      p = to
      do while (p /= from)
         steps = [reached_by(p), steps]
         p = reached_by(p)%from
      end do
   end subroutine way_through
end module psalm_sketch_paths
