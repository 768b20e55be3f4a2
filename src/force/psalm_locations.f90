!> Places of a data set as points fixed in the bodies of its mechanism.
module psalm_locations
   use psalm_angles, only: unit_vector
   use psalm_body_points, only: locate_point
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, at_start, at_finish, body_frame
   use psalm_place, only: place_t
   implicit none (type, external)
   private
   public :: location_t, location_of_place, turned
   public :: place_right, place_on_foot, place_afloat, place_nowhere

   integer, parameter :: place_right = 0      !! a place that is a point of its link
   integer, parameter :: place_on_foot = 1    !! it is counted from the foot of a slide
   integer, parameter :: place_afloat = 2     !! its arc is only parallel to its link
   integer, parameter :: place_nowhere = 3    !! no loop runs through its link

   !> A place fixed in a body.
   type :: location_t
      integer :: body = body_frame
      real(wp) :: at(2) = 0.0_wp            !! from the body's reference, in the axes of the body's own arc, user's length
      real(wp) :: along(2) = [1.0_wp, 0.0_wp] !! unit vector of the arc it was named by, in these axes
   end type location_t

contains

   !> A place of the data set on its body; `state` is one of `place_...`.
   subroutine location_of_place(mechanism, dimensions, reference, given, location, state)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: reference(:)   !! by body: its vertex
      type(place_t), intent(in) :: given
      type(location_t), intent(out) :: location
      integer, intent(out) :: state
      real(wp) :: from(2), cosine, sine
      integer :: n, end
      logical :: found

      state = place_nowhere
      if (given%loop == 0) return
      n = mechanism%seq(given%loop, given%arc)
      end = merge(at_start, at_finish, given%from_start)
      associate (arc => mechanism%arcs(n))
         location%body = arc%body
         if (arc%rod > 0 .and. arc%foot == end) location%body = arc%rod
         state = place_on_foot
         if (arc%foot == end .and. location%body == arc%body) return
         state = place_afloat
         if (.not. arc%attached) return
         ! a joint of the link that nothing leads to from its others
         call locate_point(mechanism, dimensions, location%body, reference(location%body), arc%ends(end), from, found)
         if (.not. found) return
         call unit_vector(mechanism%angle_on_body(n, dimensions) + given%turn, location%along(1), location%along(2))
         call unit_vector(given%angle, cosine, sine)
         location%at = from + given%distance*turned([cosine, sine], location%along)
      end associate
      state = place_right
   end subroutine location_of_place

   !> A vector turned by the angle of a unit vector.
   pure function turned(vector, by)
      real(wp), intent(in) :: vector(2), by(2)
      real(wp) :: turned(2)

      turned = [vector(1)*by(1) - vector(2)*by(2), vector(1)*by(2) + vector(2)*by(1)]
   end function turned
end module psalm_locations
