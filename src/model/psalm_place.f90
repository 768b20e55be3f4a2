!> Places on links: an end of an arc, a distance and an angle from the arc's direction; of a sketch a link, a joint of it, a line
!> between two of its joints.
module psalm_place
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: place_t, travel_t, beside_t

   !> A place on a link.
   type :: place_t
      integer :: arc = 0, loop = 0         !! an arc of the link
      logical :: from_start = .false.      !! counted from the arc's start, else from its finish
      real(wp) :: distance = 0.0_wp        !! from that end, user's length
      real(wp) :: angle = 0.0_wp           !! of the line to the place from the arc's direction, degrees
      ! on a sketch; the arc is chosen with the loops
      integer :: link = 0                  !! the link; of a joint with friction the one that turns in it, 0: the one there is
      integer :: joint = 0                 !! counted from this joint; 0: from where the axes of a link without joints begin
      integer :: line(2) = 0               !! angles are counted from the line between these joints; 0: from the drawing's x axis
      integer :: slide = 0                 !! friction: the slide
      real(wp) :: turn = 0.0_wp            !! from the arc to that line, degrees
      real(wp) :: written(2) = 0.0_wp      !! distance and angle as they were written, from that joint
   end type place_t

   !> A line from a point of the plan to a joint that is none, in the axes of an arc of its link, or standing still.
   type :: beside_t
      integer :: arc = 0                   !! sequential number of the arc; 0: the frame's axes
      real(wp) :: distance = 0.0_wp        !! user's length; 0: the joint is the point
      real(wp) :: angle = 0.0_wp           !! of the line from the arc's direction, degrees
      integer :: joint = 0                 !! of the sketch
   end type beside_t

   !> How far the second link of a slide has moved against the first: sense times the length of an arc, plus the zero.
   type :: travel_t
      integer :: arc = 0, loop = 0
      real(wp) :: sense = 1.0_wp
      real(wp) :: zero = 0.0_wp
   end type travel_t
end module psalm_place
