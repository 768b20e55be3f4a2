!> Whether the loops of a sketch carry its forces: not all that have its motion do.
!>
!> A loop may run parallel to a link that only slides on others (a dyad of a pin and two slides, say), and then has another joint
!> in the place of one of the sketch's: positions are the same, forces are not.
module psalm_loop_forces
   use psalm_body_points, only: locate_point
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, joint_t, at_start, at_finish, body_frame, joint_gear, joint_prismatic
   use psalm_parameters, only: parameters_t
   use psalm_place, only: place_t
   use psalm_plate_group, only: plate_group_t, plates_of
   use psalm_sketch, only: frame_link
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: asks_for_forces, loops_carry_forces, link_of_body

contains

   !> True for a case with masses, loads, springs or friction, or with clearances, whose effects are forces of joints.
   pure logical function asks_for_forces(set)
      use psalm_allocation_group, only: allocation_group_t, allocation_of
      type(data_set_t), intent(in) :: set
      type(allocation_group_t) :: allocation

      asks_for_forces = set%masses%given .or. set%loads%given .or. set%springs%given .or. set%friction%given .or. &
                        set%gives('PLATES')
      if (asks_for_forces .or. .not. set%gives('ALLOC')) return
      allocation = allocation_of(set)
      asks_for_forces = size(allocation%plays) > 0
   end function asks_for_forces

   !> True if every joint of a sketch's loops is one of the sketch, between the same links, and every place of a mass, load,
   !> spring or shoe is on its link. Also true where the loops have mistakes: those are reported elsewhere.
   logical function loops_carry_forces(set)
      use psalm_setup, only: set_up
      type(data_set_t), intent(in) :: set                !! with the loops chosen
      class(mechanism_t), allocatable :: mechanism
      type(dimensions_t) :: dimensions
      type(parameters_t) :: parameters
      type(diagnostics_t) :: findings
      type(place_t), allocatable :: places(:)
      type(plate_group_t) :: plates
      integer :: k, i

      loops_carry_forces = .true.
      allocate (mechanism)
      call set_up(set, mechanism, dimensions, parameters, findings)
      if (findings%failed()) return
      do k = 1, size(mechanism%joints)
         loops_carry_forces = loops_carry_forces .and. is_of_sketch(mechanism%joints(k))
      end do
      places = [set%masses%places, set%loads%places, set%springs%first, set%springs%second, set%traced%shoes]
      do k = 1, size(places)
         loops_carry_forces = loops_carry_forces .and. is_on_link(mechanism, dimensions, places(k))
      end do
      plates = plates_of(set)
      do k = 1, size(plates%plates)
         if (plates%plates(k)%link == 0) cycle
         do i = 1, size(plates%plates(k)%corners)
            loops_carry_forces = loops_carry_forces .and. is_on_link(mechanism, dimensions, plates%plates(k)%corners(i))
         end do
      end do

   contains

      pure logical function is_of_sketch(joint)
         type(joint_t), intent(in) :: joint
         integer :: links(2), slide, j

         is_of_sketch = joint%kind == joint_gear
         if (is_of_sketch .or. .not. joint%attached) return
         links = [link_of_body(mechanism, joint%bodies(1)), link_of_body(mechanism, joint%bodies(2))]
         if (joint%kind == joint_prismatic) then
            slide = mechanism%arcs(joint%slide)%rail
            if (slide == 0) return
            associate (of_slide => set%sketch%slides(slide)%links)
               is_of_sketch = all(links == of_slide) .or. all(links == of_slide([2, 1]))
            end associate
         else
            j = mechanism%arcs(joint%arc)%joints(joint%end)
            if (j == 0) return
            is_of_sketch = set%sketch%has_joint(links(1), j) .and. set%sketch%has_joint(links(2), j)
         end if
      end function is_of_sketch
   end function loops_carry_forces

   !> True if a place on a sketch is at an end of an arc of its link that its other arcs lead to.
   pure logical function is_on_link(mechanism, dimensions, place)
      class(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(place_t), intent(in) :: place
      real(wp) :: unused(2)
      integer :: n

      is_on_link = place%link == frame_link
      if (is_on_link .or. place%loop == 0) return
      n = mechanism%seq(place%loop, place%arc)
      associate (arc => mechanism%arcs(n), &
                 end => merge(at_start, at_finish, place%from_start))
         is_on_link = link_of_body(mechanism, arc%body) == place%link .and. arc%attached .and. &
                      (arc%foot /= end .or. arc%rod > 0)
         if (is_on_link .and. arc%rod == 0) &
            call locate_point(mechanism, dimensions, arc%body, reference_of(mechanism, arc%body), arc%ends(end), &
                              unused, is_on_link)
      end associate
   end function is_on_link

   !> The end of a body's own arc that is its own.
   pure integer function reference_of(mechanism, body) result(point)
      class(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: body

      associate (arc => mechanism%arcs(mechanism%bodies(body)%axis))
         point = arc%ends(merge(at_finish, at_start, arc%foot == at_start))
      end associate
   end function reference_of

   !> The link of the sketch that a body of its loops is.
   pure integer function link_of_body(mechanism, body) result(link)
      class(mechanism_t), intent(in) :: mechanism        !! the loops of a sketch
      integer, intent(in) :: body

      link = frame_link
      if (body == body_frame) return
      link = mechanism%arcs(mechanism%bodies(body)%axis)%link
   end function link_of_body
end module psalm_loop_forces
