!> Clearances asked for: joints and links, segments with a width, from regions, and links from each other. Source of the target:
!> Oldham (1977), section 9.2.3.
!>
!> Two links that have a point or a body in common cannot keep apart, and two of different layers cannot meet: they are left out.
module psalm_clearances
   use psalm_constraint_group, only: constraint_group_t, region_t, region_box, region_circle, every_segment
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, ring_t, body_frame, at_finish, at_start, pivot
   use psalm_place, only: place_t, beside_t
   use psalm_regions, only: find_region_depth
   use psalm_separation, only: find_separation
   use psalm_sketch, only: sketch_t
   implicit none (type, external)
   private
   public :: clearance_t, list_clearances, list_sketch_clearances, find_depth, find_corners, points_of_clearance

   integer, parameter :: points_of_clearance = 4
   integer, parameter :: most_corners = 4       !! of a region

   !> One clearance.
   type :: clearance_t
      integer :: region = 0                    !! number of the region; 0: between two links
      type(region_t) :: shape = region_t()     !! the region
      integer :: segments(2) = 0               !! links; with a region the first; both 0: a joint
      integer :: points(points_of_clearance) = 0 !! two ends of the first (of a joint twice the same), then of the second link
      real(wp) :: reach = 0.0_wp               !! half the widths
      real(wp) :: asked = 0.0_wp               !! least distance
   end type clearance_t

contains

   !> Clearances of a linkage of loops. Their points are numbers of `joints`, 0: the output point.
   pure subroutine list_clearances(constr, mechanism, output_on_joint, clearances, joints, beside)
      type(constraint_group_t), intent(in) :: constr
      type(mechanism_t), intent(in) :: mechanism
      logical, intent(in) :: output_on_joint         !! the output arc has no length
      type(clearance_t), allocatable, intent(out) :: clearances(:)
      integer, allocatable, intent(out) :: joints(:, :) !! shape (2, joints): loop and arc whose finish it is
      type(beside_t), allocatable, intent(out) :: beside(:) !! shape (joints): how far from there
      integer, allocatable :: of_region(:), of_segment(:, :), vertex(:, :)
      logical, allocatable :: meet(:, :)
      integer, allocatable :: held(:)          ! by joint of the sketch that is no end of an arc: its body
      integer :: r, s, k, base, body

      allocate (joints(2, 0), beside(0))
      allocate (of_region(size(constr%regions)), source=0)
      allocate (of_segment(2, size(constr%segments)), source=0)
      allocate (vertex(2, size(constr%segments)), source=0)
      allocate (meet(size(constr%segments), size(constr%segments)), source=.true.)
      allocate (held(maxval([0, (constr%segments(s)%joints, s=1, size(constr%segments))])), source=0)
      associate (output => mechanism%outputs(1))
         base = mechanism%arcs(output%arc)%ends(merge(at_start, at_finish, output%from_start))
         body = mechanism%body_at(output%arc, merge(at_start, at_finish, output%from_start))
      end associate
      do r = 1, size(of_region)
         if (constr%regions(r)%segment == 0) then
            call number_joint(mechanism, constr%regions(r)%loop, constr%regions(r)%arc, constr%regions(r)%place, joints, beside, &
                              of_region(r))
         end if
      end do
      do s = 1, size(of_segment, 2)
         do k = 1, 2
            associate (loop => constr%segments(s)%loops(k), arc => constr%segments(s)%arcs(k))
               call number_joint(mechanism, loop, arc, constr%segments(s)%places(k), joints, beside, of_segment(k, s))
               if (constr%segments(s)%places(k)%link > 0) then
                  vertex(k, s) = -constr%segments(s)%joints(k)
                  held(-vertex(k, s)) = body_frame
                  if (beside(of_segment(k, s))%arc > 0) &
                     held(-vertex(k, s)) = mechanism%arcs(beside(of_segment(k, s))%arc)%body
               else if (loop == 0) then
                  if (output_on_joint) vertex(k, s) = base
               else if (arc == 0) then
                  vertex(k, s) = pivot
               else
                  vertex(k, s) = mechanism%arcs(mechanism%seq(loop, arc))%ends(at_finish)
               end if
            end associate
         end do
      end do
      do s = 1, size(of_segment, 2)
         do k = 1, s - 1
            meet(k, s) = .not. (have_common_vertex(vertex(:, k), vertex(:, s)) .or. have_common_body([vertex(:, k), vertex(:, s)]))
         end do
      end do
      call make_list(constr, of_region, of_segment, meet, clearances)

   contains

      !> True if some body has all these points; 0 is the output point away from joints, one below 0 a joint that is no end of an
      !> arc.
      pure logical function have_common_body(points)
         integer, intent(in) :: points(:)
         integer :: b, i
         logical :: all_of_it

         have_common_body = .true.
         do b = 1, size(mechanism%bodies)
            all_of_it = .true.
            do i = 1, size(points)
               if (points(i) == 0) then
                  all_of_it = all_of_it .and. b == body
               else if (points(i) < 0) then
                  all_of_it = all_of_it .and. b == held(-points(i))
               else
                  all_of_it = all_of_it .and. mechanism%has_point(b, points(i))
               end if
            end do
            if (all_of_it) return
         end do
         have_common_body = .false.
      end function have_common_body
   end subroutine list_clearances

   !> Number of a joint in a list that takes it in; 0: the output point.
   pure subroutine number_joint(mechanism, loop, arc, place, joints, beside, number)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop, arc
      type(place_t), intent(in) :: place                  !! of a joint that is no end of an arc
      integer, allocatable, intent(inout) :: joints(:, :) !! shape (2, joints)
      type(beside_t), allocatable, intent(inout) :: beside(:) !! shape (joints)
      integer, intent(out) :: number
      type(beside_t) :: from
      type(ring_t) :: ring
      integer :: finish

      number = 0
      if (loop == 0) return
      finish = arc
      if (place%link > 0 .and. place%arc == 0) from = beside_t(0, place%distance, place%angle)
      if (place%arc > 0) then
         from = beside_t(mechanism%seq(loop, place%arc), place%distance, place%turn + place%angle, place%joint)
         if (place%from_start) then
            ring = mechanism%ring_of(loop, from%arc)
            finish = merge(0, arc - 1, from%arc == ring%first)
         end if
      end if
      do number = 1, size(joints, 2)
         if (joints(1, number) == loop .and. joints(2, number) == finish .and. beside(number)%arc == from%arc .and. &
             beside(number)%joint == from%joint .and. &
             abs(beside(number)%distance - from%distance) <= 0.0_wp .and. &
             abs(beside(number)%angle - from%angle) <= 0.0_wp) return
      end do
      joints = reshape([joints, [loop, finish]], [2, number])
      beside = [beside, from]
   end subroutine number_joint

   !> True if two segments end in one point; 0 is the output point away from joints.
   pure logical function have_common_vertex(one, other)
      integer, intent(in) :: one(2), other(2)

      have_common_vertex = any(one == other(1)) .or. any(one == other(2))
   end function have_common_vertex

   !> Clearances of a sketch. Their points are its joints.
   pure subroutine list_sketch_clearances(constr, sketch, clearances)
      type(constraint_group_t), intent(in) :: constr
      type(sketch_t), intent(in) :: sketch
      type(clearance_t), allocatable, intent(out) :: clearances(:)
      integer :: of_segment(2, size(constr%segments)), s, k, link, i
      logical :: meet(size(constr%segments), size(constr%segments))

      meet = .true.
      do s = 1, size(constr%segments)
         of_segment(:, s) = constr%segments(s)%joints
         do k = 1, s - 1
            associate (joints => [of_segment(:, k), of_segment(:, s)])
               meet(k, s) = .not. have_common_vertex(joints(:2), joints(3:))
               do link = 1, size(sketch%links)
                  if (all([(sketch%has_joint(link, joints(i)), i=1, size(joints))])) meet(k, s) = .false.
               end do
            end associate
         end do
      end do
      call make_list(constr, constr%regions%joint, of_segment, meet, clearances)
   end subroutine list_sketch_clearances

   !> Regions in their order, a region for every link link by link; then pairs of links.
   pure subroutine make_list(constr, of_region, of_segment, meet, clearances)
      type(constraint_group_t), intent(in) :: constr
      integer, intent(in) :: of_region(:)            !! by region: its joint
      integer, intent(in) :: of_segment(:, :)        !! shape (2, segments)
      logical, intent(in) :: meet(:, :)              !! shape (segments, segments): they can come near each other
      type(clearance_t), allocatable, intent(out) :: clearances(:)
      type(clearance_t) :: one
      integer :: r, s, k

      allocate (clearances(0))
      do r = 1, size(of_region)
         one = clearance_t(region=r, shape=constr%regions(r), points=spread(of_region(r), 1, points_of_clearance), &
                           asked=constr%regions(r)%clearance)
         if (constr%regions(r)%segment == 0) clearances = [clearances, one]
         do s = 1, size(of_segment, 2)
            if (all(constr%regions(r)%segment /= [s, every_segment])) cycle
            one%segments(1) = s
            one%points(:2) = of_segment(:, s)
            one%reach = 0.5_wp*constr%segments(s)%width
            clearances = [clearances, one]
         end do
      end do
      do s = 1, size(of_segment, 2)
         do k = 1, s - 1
            if (.not. meet(k, s) .or. constr%segments(k)%layer /= constr%segments(s)%layer) cycle
            one = clearance_t(segments=[k, s], points=[of_segment(:, k), of_segment(:, s)], &
                              reach=0.5_wp*(constr%segments(k)%width + constr%segments(s)%width), &
                              asked=max(constr%segments(k)%clearance, constr%segments(s)%clearance))
            clearances = [clearances, one]
         end do
      end do
   end subroutine make_list

   !> How far below the least distance asked for a clearance is (negative: above it), [length], and the gradient by its points.
   pure subroutine find_depth(clearance, at, depth, by_points)
      type(clearance_t), intent(in) :: clearance
      real(wp), intent(in) :: at(:, :)               !! shape (2, 4): its points, machine axes
      real(wp), intent(out) :: depth
      real(wp), intent(out) :: by_points(:, :)       !! shape (2, 4)
      real(wp) :: corners(2, most_corners), by_corners(2, most_corners), distance, other, gx, gy
      integer :: n

      by_points = 0.0_wp
      if (clearance%region == 0) then
         call find_separation(at(:, 1:2), at(:, 3:4), distance, by_points(:, 1:2), by_points(:, 3:4))
      else if (clearance%segments(1) > 0 .and. .not. clearance%shape%stay_inside .and. &
               any(clearance%shape%kind == [region_box, region_circle])) then
         call find_corners(clearance%shape, corners, n)
         call find_separation(at(:, 1:2), corners(:, :n), distance, by_points(:, 1:2), by_corners(:, :n))
         if (clearance%shape%kind == region_circle) distance = distance - clearance%shape%at(3)
      else
         call find_region_depth(clearance%shape, at(1, 1), at(2, 1), distance, gx, gy)
         by_points(:, 1) = -[gx, gy]
         distance = -distance
         if (clearance%segments(1) > 0) then
            ! the end that is nearer
            call find_region_depth(clearance%shape, at(1, 2), at(2, 2), other, gx, gy)
            if (-other < distance) then
               distance = -other
               by_points(:, 1) = 0.0_wp
               by_points(:, 2) = -[gx, gy]
            end if
         end if
      end if
      depth = clearance%asked + clearance%reach - distance
      by_points = -by_points
   end subroutine find_depth

   !> Corners of a box, anticlockwise, or the centre of a circle.
   pure subroutine find_corners(region, corners, n)
      type(region_t), intent(in) :: region
      real(wp), intent(out) :: corners(2, most_corners)
      integer, intent(out) :: n                      !! how many there are

      n = merge(most_corners, 1, region%kind == region_box)
      associate (at => region%at)
         corners = reshape([at(1), at(2), at(3), at(2), at(3), at(4), at(1), at(4)], [2, most_corners])
      end associate
   end subroutine find_corners
end module psalm_clearances
