!> Finds the joints and slides of a sketch on the arcs of its loops.
module psalm_joint_location
   use psalm_angles, only: unit_vector
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp
   use psalm_moving_joints, only: moving_t, sketch_motion_t
   use psalm_place, only: place_t
   use psalm_sketch, only: frame_link
   use psalm_traced_loops, only: loops_t
   implicit none (type, external)
   private
   public :: locate_sketch, add_link_axes

contains

   !> Find joints and slides. The plan must then be made with `points`. Joints of the frame are where they were drawn; with
   !> `dimensions` that are not, or not only, those of the drawing they are where these put them, and so is the first output.
   subroutine locate_sketch(set, sketch, dimensions, with_slides)
      type(data_set_t), intent(in) :: set               !! a sketch with its loops
      type(sketch_motion_t), intent(out) :: sketch
      type(dimensions_t), intent(in), optional :: dimensions
      logical, intent(in), optional :: with_slides      !! after the joints come the points of slides, on their second links
      type(place_t) :: place
      integer :: j, k

      sketch%drawn = cmplx(set%sketch%x, set%sketch%y, wp)
      allocate (sketch%moving(0), sketch%points(2, 0))
      do j = 1, size(set%traced%joint_places)
         place = set%traced%joint_places(j)
         if (place%link == frame_link .and. .not. present(dimensions)) cycle
         if (present(dimensions)) then
            if (place%arc > 0) then
               place%distance = dimensions%aside_length(j)
               place%angle = dimensions%aside_angle(j)
               place%turn = 0.0_wp
            end if
            call move_output(set, dimensions, j, place)
         end if
         call add_moving(set%traced, j, place, sketch)
      end do
      if (present(with_slides)) then
         if (with_slides) then
            sketch%drawn = [sketch%drawn, cmplx(set%sketch%slides%x, set%sketch%slides%y, wp)]
            do k = 1, size(set%traced%shoes)
               call add_moving(set%traced, size(set%traced%joint_places) + k, set%traced%shoes(k), sketch)
            end do
         end if
      end if
      allocate (sketch%arcs(size(set%traced%travels)), source=0)
      do k = 1, size(set%traced%travels)
         if (set%traced%travels(k)%arc > 0) sketch%arcs(k) = &
            set%traced%number_of(set%traced%travels(k)%loop, set%traced%travels(k)%arc)
      end do
      sketch%sense = set%traced%travels%sense
      sketch%zero = set%traced%travels%zero
   end subroutine locate_sketch

   !> After the joints: where the axes of links without joints begin; of others 0.
   subroutine add_link_axes(set, sketch)
      type(data_set_t), intent(in) :: set               !! a sketch with its loops
      type(sketch_motion_t), intent(inout) :: sketch    !! its joints
      integer :: k

      associate (links => set%sketch%links)
         sketch%drawn = [sketch%drawn, [((0.0_wp, 0.0_wp), k=1, size(links))]]
         do k = 1, size(links)
            if (k == frame_link .or. size(links(k)%joints) > 0) cycle
            call add_moving(set%traced, size(set%traced%joint_places) + k, set%traced%link_places(k), sketch)
         end do
      end associate
   end subroutine add_link_axes

   !> A joint at its place on an arc; one that is on none stands still.
   subroutine add_moving(traced, joint, place, sketch)
      type(loops_t), intent(in) :: traced
      integer, intent(in) :: joint
      type(place_t), intent(in) :: place
      type(sketch_motion_t), intent(inout) :: sketch
      type(moving_t) :: one
      real(wp) :: c, s
      integer :: arc

      if (place%arc == 0) return
      one%joint = joint
      one%arc = traced%number_of(place%loop, place%arc)
      call unit_vector(place%turn + place%angle, c, s)
      one%offset = place%distance*cmplx(c, s, wp)
      arc = place%arc
      if (place%from_start) then
         arc = merge(0, arc - 1, traced%begins(one%arc))
      end if
      sketch%moving = [sketch%moving, one]
      sketch%points = reshape([sketch%points, place%loop, arc], [2, size(sketch%moving)])
   end subroutine add_moving

   !> The output of the loops, if it stands off the arcs, where OUTLK and OUTANG have it: a search may vary these.
   subroutine move_output(set, dimensions, joint, place)
      type(data_set_t), intent(in) :: set
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: joint
      type(place_t), intent(inout) :: place             !! of that joint

      if (joint /= set%traced%output_joint .or. dimensions%outlk <= 0.0_wp) return
      associate (arc => set%traced%arcs(set%traced%output_arc))
         place%loop = arc%loop
         place%arc = arc%place
         place%from_start = set%traced%from_start
      end associate
      place%distance = dimensions%outlk
      place%angle = dimensions%outang
      place%turn = 0.0_wp
   end subroutine move_output
end module psalm_joint_location
