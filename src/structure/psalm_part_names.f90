!> Names of a sketch for the links and joints of its loops, by which listings and tables call them.
module psalm_part_names
   use psalm_data_set, only: data_set_t
   use psalm_mechanism, only: mechanism_t, body_frame, joint_gear, joint_prismatic
   use psalm_sketch, only: frame_link
   implicit none (type, external)
   private
   public :: take_names

contains

   !> Name bodies and joints as the sketch does; where several pairs of links meet in one joint, each with the later link's name.
   !>
   !> Such joints are told to be on one pin: loops that reach it along other arcs have points of their own there.
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
   end subroutine take_names
end module psalm_part_names
