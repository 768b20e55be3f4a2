!> Names of a sketch for the links and joints of its loops, by which listings and tables call them.
module psalm_part_names
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, body_frame, joint_gear, joint_prismatic
   use psalm_output_kind, only: motion_angle, motion_pose
   use psalm_sketch, only: frame_link
   implicit none (type, external)
   private
   public :: take_names, name_output

contains

   !> Name bodies and joints as the sketch does; where several pairs of links meet in one joint, each with the later link's name.
   !>
   !> Such joints are reported to be on one pin: loops that reach it along other arcs have points of their own there.
   subroutine take_names(set, mechanism)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(inout) :: mechanism
      logical, allocatable :: several(:)
      integer :: k, i

      if (.not. set%has_names()) return
      associate (bodies => mechanism%bodies, joints => mechanism%joints, links => set%sketch%links)
         bodies(body_frame)%name = trim(links(frame_link)%name)
         do k = 1, size(bodies)
            if (bodies(k)%axis == 0) cycle
            bodies(k)%name = trim(links(mechanism%arcs(bodies(k)%axis)%link)%name)
         end do
         do k = 1, size(joints)
            if (joints(k)%kind == joint_gear) then
               joints(k)%name = bodies(joints(k)%bodies(1))%name//'-'//bodies(joints(k)%bodies(2))%name
            else if (joints(k)%kind == joint_prismatic) then
               i = mechanism%arcs(joints(k)%slide)%rail
               if (i > 0) joints(k)%name = trim(set%sketch%slides(i)%name)
            else
               i = mechanism%arcs(joints(k)%arc)%joints(joints(k)%end)
               if (i > 0) then
                  joints(k)%name = trim(set%sketch%joint_name(i))
                  joints(k)%pin = mechanism%pin_of_sketch(i)
               end if
            end if
         end do
         several = [(count([(joints(i)%name == joints(k)%name, i=1, size(joints))]) > 1, k=1, size(joints))]
         do k = 1, size(joints)
            if (several(k)) joints(k)%name = joints(k)%name//'.'//bodies(joints(k)%bodies(2))%name
         end do
         do k = 1, size(bodies)
            if (bodies(k)%is_rod) bodies(k)%name = bodies(k)%name//' rod'
         end do
      end associate
      call name_ends(set, mechanism)
   end subroutine take_names

   !> Names of the joints at the ends of the arcs; feet of slides are counted.
   subroutine name_ends(set, mechanism)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(inout) :: mechanism
      integer :: n, k

      allocate (mechanism%ends(2, size(mechanism%arcs)))
      do n = 1, size(mechanism%arcs)
         do k = 1, 2
            mechanism%ends(k, n) = set%traced%point_name(set%sketch%joint_name, set%traced%arcs(n)%ends(k))
         end do
      end do
   end subroutine name_ends

   !> The joints of the line that OUTLK and OUTANG are of: from the arc to the output point, or where there is none, that whose
   !> direction is listed.
   subroutine name_output(set, mechanism)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(inout) :: mechanism
      integer :: k

      if (.not. set%has_names()) return
      associate (output => mechanism%outputs(1), names => set%sketch%joint_name)
         if (set%traced%output_joint > 0 .and. set%traced%outlk > 0.0_wp) then
            output%line = [mechanism%ends(merge(1, 2, output%from_start), output%arc), names(set%traced%output_joint)]
         else if (output%motion == motion_angle .or. output%motion == motion_pose) then
            k = merge(1, 2, output%motion == motion_angle)
            output%line = names(set%sketch%outputs(1)%joints(k:k + 1))
         end if
      end associate
   end subroutine name_output
end module psalm_part_names
