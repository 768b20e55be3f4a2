!> The items of &CONSTR that make links segments with a width: between which two points, how wide, in which layer.
module psalm_segment_items
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_place, only: place_t
   use psalm_sketch, only: sketch_t
   use psalm_sketch_names, only: find_joints
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: segment_t, read_segments

   !> A link as a straight segment of a width, round at its ends.
   type :: segment_t
      integer :: arcs(2) = 0, loops(2) = 0     !! its two points: finishes of arcs (of arc 0: the input pivot); loop 0: output point
      integer :: joints(2) = 0                 !! those of a sketch
      real(wp) :: width = 0.0_wp
      real(wp) :: clearance = 0.0_wp           !! least distance from other segments
      integer :: layer = 0                     !! only segments of one layer can meet
      type(place_t) :: places(2) = place_t()   !! of joints that are no ends of arcs; link 0: it is one
   end type segment_t

contains

   !> Read the segments. Errors: points that are not there, two points that are one, numbers below 0.
   subroutine read_segments(group, nloop, maxarc, sketch, segments, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: nloop, maxarc
      type(sketch_t), intent(in) :: sketch     !! its joints are called by their names
      type(segment_t), allocatable, intent(out) :: segments(:)
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:)
      integer, allocatable :: links(:), loops(:), layers(:), joints(:)
      real(wp), allocatable :: widths(:), distances(:)
      type(diagnostics_t) :: unused
      integer :: n, s, k
      logical :: valid

      call take_count(group, 'NSEG', n, findings)
      allocate (segments(n), links(2*n), loops(2*n), layers(n))
      allocate (widths(n), distances(n), source=0.0_wp)
      links = 0
      loops = 0
      layers = 0
      if (n == 0) then
         call read_items(unused)   ! NSEG=0: none of them is there
      else
         call read_items(findings)
      end if
      if (size(names) > 0 .and. .not. sketch%given) call wrong('SJNT', 'joints have names in a sketch (&CHAIN) only; SLINK and '// &
                                                               'SLOOP count arcs of &LINKS', 1, 1)
      do s = 1, n
         associate (segment => segments(s))
            segment%width = widths(s)
            segment%clearance = distances(s)
            segment%layer = layers(s)
            if (sketch%given) then
               call name_points(segment, s)
               cycle
            end if
            do k = 1, 2
               call check_point(segment, s, k)
            end do
            if (segment%arcs(1) == segment%arcs(2) .and. segment%loops(1) == segment%loops(2)) &
               call wrong('SLINK', 'its two points are one', s, 2*s)
         end associate
      end do

   contains

      subroutine read_items(reported)
         type(diagnostics_t), intent(inout) :: reported

         call take(group, 'SLINK', links, reported)
         call take(group, 'SLOOP', loops, reported)
         call group%get_texts('SJNT', names, reported)
         call take(group, 'SWIDTH', widths, reported)
         call take(group, 'SCLEAR', distances, reported)
         call take(group, 'SLAYER', layers, reported)
      end subroutine read_items

      !> One end, counted by arcs.
      subroutine check_point(segment, s, k)
         type(segment_t), intent(inout) :: segment
         integer, intent(in) :: s, k

         associate (link => links(2*s - 2 + k), loop => loops(2*s - 2 + k), place => 2*s - 2 + k)
            segment%loops(k) = loop
            segment%arcs(k) = merge(link, -link - 1, link >= 0)
            if (loop == 0 .and. link /= 0) then
               call wrong('SLOOP', 'arc '//to_text(link)//' is named, but not its loop', s, place)
            else if (loop < 0 .or. loop > nloop) then
               call wrong('SLOOP', 'there is no loop '//to_text(loop), s, place)
            else if (loop > 0 .and. (segment%arcs(k) < 0 .or. segment%arcs(k) > maxarc .or. link == 0)) then
               call wrong('SLINK', 'the number of an arc is expected (negative for the joint at its start); found '// &
                          to_text(link), s, place)
            end if
         end associate
      end subroutine check_point

      !> Both ends, called by their names.
      subroutine name_points(segment, s)
         type(segment_t), intent(inout) :: segment
         integer, intent(in) :: s

         if (any(links(2*s - 1:2*s) /= 0) .or. any(loops(2*s - 1:2*s) /= 0)) then
            call wrong('SLINK', 'SLINK and SLOOP count arcs of &LINKS; the joints of a sketch are named, SJNT', s, 2*s - 1)
         else if (s > size(names)) then
            call wrong('SJNT', "the two joints between which it lies are missing, SJNT='A B'", s, s)
         else
            call find_joints(group, 'SJNT', s, names(s), 'segment '//to_text(s), sketch, findings, joints, valid)
            if (.not. valid) return
            if (size(joints) /= 2) then
               call wrong('SJNT', "two joints are expected, as 'A B'; found '"//trim(names(s))//"'", s, s)
            else if (joints(1) == joints(2)) then
               call wrong('SJNT', 'its two points are one', s, s)
            else
               segment%joints = joints
            end if
         end if
      end subroutine name_points

      subroutine wrong(item, text, which, element)
         character(*), intent(in) :: item, text
         integer, intent(in) :: which, element

         call out_of(group, item, 'segment '//to_text(which)//': '//text, findings, element)
      end subroutine wrong
   end subroutine read_segments
end module psalm_segment_items
