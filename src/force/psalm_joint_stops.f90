!> Joints with stops: how far each has turned or slid, how fast, and the force of a stop.
module psalm_joint_stops
   use psalm_angles, only: degrees_of, nearest_difference
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t, moving_pair
   use psalm_kinds, only: wp, degrees_per_radian, radians_per_degree
   use psalm_kinetostatics, only: forces_t, grip_joint
   use psalm_linkage, only: padded
   use psalm_mechanism, only: at_start, joint_prismatic
   use psalm_place, only: place_t
   use psalm_rates, only: rates_t
   use psalm_stops_group, only: stops_group_t, stops_of, no_stop
   implicit none (type, external)
   private
   public :: joint_stop_t, make_stops, watch_joint, rubbing_joints, place_at, rate_at, press
   public :: side_none, side_low, side_high

   integer, parameter :: side_none = 0, side_low = -1, side_high = 1

   !> A joint that has a stop on one side or on both. Places and forces count along the motion of the second body in the first:
   !> radians and N m, or user's lengths and N.
   type :: joint_stop_t
      integer :: entry = 0                  !! of the group; 0: its joint is not there
      integer :: joint = 0, bodies(2) = 0
      logical :: slides = .false.
      integer :: slot = 0                   !! of a slide: its varying length,
      real(wp) :: growth = 1.0_wp           !! whose rate times this is the rate that counts,
      real(wp) :: slip = 1.0_wp             !! and this times that the speed of the second body along the joint's arc
      real(wp) :: low = -no_stop, high = no_stop !! from time 0
      real(wp) :: restitution = 0.0_wp
      real(wp) :: zero = 0.0_wp             !! place at time 0
   end type joint_stop_t

contains

   !> The stops of a case; `entry` is 0 where there is no joint at the end of the arc.
   subroutine make_stops(set, problem, stops)
      type(data_set_t), intent(in) :: set
      class(problem_t), intent(in) :: problem
      type(joint_stop_t), allocatable, intent(out) :: stops(:)
      type(stops_group_t) :: group
      real(wp) :: unit
      integer :: k

      group = stops_of(set)
      allocate (stops(size(group%joints)))
      do k = 1, size(stops)
         associate (one => stops(k))
            call watch_joint(set, problem, group%joints(k), one)
            if (one%joint == 0) cycle
            one%entry = k
            one%restitution = group%restitution(k)
            unit = merge(1.0_wp, radians_per_degree, one%slides)
            if (group%low(k) > -no_stop) one%low = unit*group%low(k)
            if (group%high(k) < no_stop) one%high = unit*group%high(k)
         end associate
      end do
   end subroutine make_stops

   !> The joints with friction of a model, without limits, in the sense of its entries.
   subroutine rubbing_joints(model, problem, joints)
      type(force_model_t), intent(in) :: model
      class(problem_t), intent(in) :: problem
      type(joint_stop_t), allocatable, intent(out) :: joints(:)
      integer :: k, n

      allocate (joints(size(model%friction)))
      do k = 1, size(joints)
         associate (one => joints(k), mechanism => problem%mechanism)
            one%joint = model%friction(k)%joint
            one%bodies = model%friction(k)%bodies
            one%slides = mechanism%joints(one%joint)%kind == joint_prismatic
            if (.not. one%slides) cycle
            n = mechanism%joints(one%joint)%slide
            one%slot = problem%plan%length_slot(n)
            if (mechanism%arcs(n)%foot /= at_start) one%slip = -one%slip
            if (mechanism%joints(one%joint)%bodies(2) /= mechanism%arcs(n)%body) one%slip = -one%slip
         end associate
      end do
   end subroutine rubbing_joints

   !> A joint, without limits; `joint` is 0 where there is none.
   subroutine watch_joint(set, problem, place, one)
      type(data_set_t), intent(in) :: set
      class(problem_t), intent(in) :: problem
      type(place_t), intent(in) :: place
      type(joint_stop_t), intent(out) :: one
      real(wp) :: sense
      integer :: n

      associate (mechanism => problem%mechanism)
         call moving_pair(set, mechanism, place, one%joint, one%bodies)
         if (one%joint == 0) return
         one%slides = mechanism%joints(one%joint)%kind == joint_prismatic
         if (.not. one%slides) return
         n = mechanism%joints(one%joint)%slide
         one%slot = problem%plan%length_slot(n)
         sense = 1.0_wp
         if (mechanism%arcs(n)%foot /= at_start) sense = -sense
         if (mechanism%joints(one%joint)%bodies(2) /= mechanism%arcs(n)%body) sense = -sense
         if (place%slide > 0) one%growth = set%traced%travels(place%slide)%sense
         one%slip = sense*one%growth
      end associate
   end subroutine watch_joint

   !> Place of a joint at the position just solved, whose bodies have been moved: radians, the nearest to `near`, or user's length.
   real(wp) function place_at(problem, forces, one, near)
      type(problem_t), intent(in) :: problem
      type(forces_t), intent(in) :: forces
      type(joint_stop_t), intent(in) :: one
      real(wp), intent(in) :: near
      real(wp) :: c, s

      if (one%slides) then
         place_at = one%growth*problem%linkage%store%v(1, problem%linkage%slide(one%slot))/forces%unit
         return
      end if
      associate (a => forces%bodies(one%bodies(1)), b => forces%bodies(one%bodies(2)), w => forces%w%v)
         c = w(1, a%ex)*w(1, b%ex) + w(1, a%ey)*w(1, b%ey)
         s = w(1, a%ex)*w(1, b%ey) - w(1, a%ey)*w(1, b%ex)
      end associate
      place_at = near + radians_per_degree*nearest_difference(degrees_of(c, s), near*degrees_per_radian)
   end function place_at

   !> Its rate, or with order 2 its acceleration, for the rates and accelerations of the drives that were put in.
   real(wp) function rate_at(problem, rates, forces, one, order)
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      type(forces_t), intent(in) :: forces
      type(joint_stop_t), intent(in) :: one
      integer, intent(in) :: order

      associate (a => forces%bodies(one%bodies(1)), b => forces%bodies(one%bodies(2)), w => forces%w%v)
         if (one%slides) then
            rate_at = one%growth*rates%d(order)%v(1, problem%linkage%slide(one%slot))/forces%unit
         else if (order == 1) then
            rate_at = w(1, b%w) - w(1, a%w)
         else
            rate_at = w(1, b%al) - w(1, a%al)
         end if
      end associate
   end function rate_at

   !> Put the force of a stop on the bodies.
   subroutine press(problem, model, one, force, forces)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model
      type(joint_stop_t), intent(in) :: one
      real(wp), intent(in) :: force         !! N m or N, positive: forwards
      type(forces_t), intent(inout) :: forces

      call grip_joint(problem, model, one%joint, one%bodies, padded(1), spread(one%slip*force, 1, padded(1)), forces)
   end subroutine press
end module psalm_joint_stops
