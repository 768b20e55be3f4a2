!> A mechanism for simulators of robots: SDF, which has loops of joints as they are; URDF, which has a tree, the rest for Gazebo.
!>
!> The plane of the linkage stands upright: its y axis is the z axis of the world. Formats: SDFormat 1.11; URDF as ROS reads it.
module psalm_sdf
   use psalm_angles, only: degrees_of
   use psalm_json, only: add_numbers, json_number, json_text, truth
   use psalm_kinds, only: wp, radians_per_degree, right_angle
   use psalm_elementary, only: hypotenuse
   use psalm_multibody, only: multibody_t, tree_joint_t
   use psalm_robot_names, only: bar_radius, bars_of, flat, robot_names_t, robot_names, row_of
   use psalm_status, only: diagnostics_t
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: write_sdf, write_urdf, write_joint_series

   real(wp), parameter :: upright(3) = [right_angle*radians_per_degree, 0.0_wp, 0.0_wp] !! roll, pitch, yaw, radians
   real(wp), parameter :: beyond = 2.0_wp   !! sizes of the linkage that a slide may move, where a format asks for a limit
   real(wp), parameter :: free = 1.0e6_wp   !! effort or speed, where a format asks for a limit

   !> A relation of two joints: the second's coordinate is the first's times a factor.
   type :: follower_t
      integer :: leader = 0, follower = 0
      real(wp) :: factor = 0.0_wp
   end type follower_t

contains

   !> Append a world of one model. Warning: relations of more than two joints, which the format does not have.
   subroutine write_sdf(model, line, text, findings)
      type(multibody_t), intent(in) :: model
      integer, intent(in) :: line                !! of the case in its file
      type(text_t), intent(inout) :: text
      type(diagnostics_t), intent(inout) :: findings
      type(robot_names_t) :: names
      type(follower_t), allocatable :: followers(:)
      integer :: b, j, f

      names = robot_names(model)
      call find_followers(model, line, 'SDF', followers, findings)
      call text%add('<sdf version="1.11">')
      call text%add('  <world name="'//names%model//'_world">')
      call text%add('    <gravity>'//row_of([model%gravity(1), 0.0_wp, model%gravity(2)])//'</gravity>')
      call text%add('    <model name="'//names%model//'">')
      call text%add('      <pose>'//row_of([0.0_wp, 0.0_wp, 0.0_wp, upright])//'</pose>')
      do b = 1, size(model%bodies)
         associate (body => model%bodies(b))
            call text%add('      <link name="'//names%bodies(b)%text//'">')
            if (b > 1) then
               call text%add('        <pose>'//row_of([body%at, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])//'</pose>')
               call text%add('        <inertial>')
               call text%add('          <pose>'//row_of([body%centre - body%at, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])//'</pose>')
               call text%add('          <mass>'//row_of([body%mass])//'</mass>')
               call text%add('          <inertia><ixx>'//row_of([flat(1)*body%inertia])//'</ixx><iyy>'// &
                             row_of([flat(2)*body%inertia])//'</iyy><izz>'//row_of([body%inertia])// &
                             '</izz><ixy>0</ixy><ixz>0</ixz><iyz>0</iyz></inertia>')
               call text%add('        </inertial>')
            end if
            call write_shapes(model, b, .true., '        ', text)
            call text%add('      </link>')
         end associate
      end do
      call text%add('      <joint name="'//names%bodies(1)%text//'_stands" type="fixed">')
      call text%add('        <parent>world</parent>')
      call text%add('        <child>'//names%bodies(1)%text//'</child>')
      call text%add('      </joint>')
      do j = 1, size(model%joints)
         f = 0
         if (size(followers) > 0) f = findloc(followers%follower, j, dim=1)
         call begin_joint_of_sdf(model, names, j, .true., '      ', text)
         if (f > 0) then
            call text%add('          <mimic joint="'//names%joints(followers(f)%leader)%text//'"><multiplier>'// &
                          row_of([followers(f)%factor])//'</multiplier><offset>0</offset><reference>0</reference></mimic>')
         end if
         call text%add('        </axis>')
         call text%add('      </joint>')
      end do
      call text%add('    </model>')
      call text%add('  </world>')
      call text%add('</sdf>')
   end subroutine write_sdf

   !> A joint of SDF up to the end of its axis, in the axes of the model or of its first body, which stand alike.
   subroutine begin_joint_of_sdf(model, names, j, of_model, indent, text)
      type(multibody_t), intent(in) :: model
      type(robot_names_t), intent(in) :: names
      integer, intent(in) :: j
      logical, intent(in) :: of_model
      character(*), intent(in) :: indent
      type(text_t), intent(inout) :: text
      character(:), allocatable :: axes
      real(wp) :: from(2)

      associate (joint => model%joints(j))
         axes = '__model__'
         from = 0.0_wp
         if (.not. of_model) then
            axes = names%bodies(joint%bodies(1))%text
            if (joint%bodies(1) > 1) from = model%bodies(joint%bodies(1))%at
         end if
         call text%add(indent//'<joint name="'//names%joints(j)%text//'" type="'// &
                       trim(merge('prismatic', 'revolute ', joint%slides))//'">')
         call text%add(indent//'  <pose relative_to="'//axes//'">'// &
                       row_of([joint%at - from, 0.0_wp, 0.0_wp, 0.0_wp, 0.0_wp])//'</pose>')
         call text%add(indent//'  <parent>'//names%bodies(joint%bodies(1))%text//'</parent>')
         call text%add(indent//'  <child>'//names%bodies(joint%bodies(2))%text//'</child>')
         call text%add(indent//'  <axis>')
         call text%add(indent//'    <xyz expressed_in="'//axes//'">'//row_of(axis_of(joint))//'</xyz>')
      end associate
   end subroutine begin_joint_of_sdf

   pure function axis_of(joint) result(axis)
      type(tree_joint_t), intent(in) :: joint
      real(wp) :: axis(3)

      axis = [0.0_wp, 0.0_wp, 1.0_wp]
      if (joint%slides) axis = [joint%along, 0.0_wp]
   end function axis_of

   !> Relations of two joints of the tree. Warning: others, which the format does not have.
   subroutine find_followers(model, line, format, followers, findings)
      type(multibody_t), intent(in) :: model
      integer, intent(in) :: line
      character(*), intent(in) :: format
      type(follower_t), allocatable, intent(out) :: followers(:)
      type(diagnostics_t), intent(inout) :: findings
      integer :: k, leader, follower

      allocate (followers(0))
      do k = 1, size(model%relations)
         associate (relation => model%relations(k))
            if (relation%is_drive) cycle
            leader = findloc(abs(relation%factors) > 0.0_wp, .true., dim=1)
            follower = findloc(abs(relation%factors) > 0.0_wp, .true., dim=1, back=.true.)
            if (count(abs(relation%factors) > 0.0_wp) == 2) then
               if (all(followers%follower /= follower)) then
                  followers = [followers, follower_t(leader, follower, -relation%factors(leader)/relation%factors(follower))]
                  cycle
               end if
            end if
            call findings%warning(format//' has no word for '//relation%name//', which ties the motions of three joints: it is '// &
                                  'left out', line=line)
         end associate
      end do
   end subroutine find_followers

   !> Bars, or a ball, of a link: a shape has a place, directions and a size.
   subroutine write_shapes(model, b, of_sdf, indent, text)
      type(multibody_t), intent(in) :: model
      integer, intent(in) :: b
      logical, intent(in) :: of_sdf              !! else of URDF
      character(*), intent(in) :: indent
      type(text_t), intent(inout) :: text
      real(wp), allocatable :: bars(:, :, :)
      real(wp) :: from(2), centre(2), along(2)
      integer :: i

      from = 0.0_wp
      if (b > 1) from = model%bodies(b)%at
      bars = bars_of(model%bodies(b)%points, model%size)
      do i = 1, size(bars, 3)
         centre = 0.5_wp*(bars(:, 1, i) + bars(:, 2, i)) - from
         along = bars(:, 2, i) - bars(:, 1, i)
         call write_shape([centre, 0.0_wp], [0.0_wp, right_angle, degrees_of(along(1), along(2))]*radians_per_degree, &
                          'cylinder', [bar_radius(model), hypotenuse(along(1), along(2))])
      end do
      if (size(bars, 3) == 0 .and. size(model%bodies(b)%points, 2) > 0) &
         call write_shape([model%bodies(b)%points(:, 1) - from, 0.0_wp], [0.0_wp, 0.0_wp, 0.0_wp], 'sphere', &
                          [1.5_wp*bar_radius(model)])

   contains

      subroutine write_shape(at, turns, kind, sizes)
         real(wp), intent(in) :: at(3), turns(3)
         character(*), intent(in) :: kind
         real(wp), intent(in) :: sizes(:)        !! radius, of a cylinder its length too

         if (of_sdf) then
            call text%add(indent//'<visual name="shape_'//to_text(i)//'">')
            call text%add(indent//'  <pose>'//row_of([at, turns])//'</pose>')
            if (size(sizes) > 1) then
               call text%add(indent//'  <geometry><'//kind//'><radius>'//row_of(sizes(:1))//'</radius><length>'// &
                             row_of(sizes(2:))//'</length></'//kind//'></geometry>')
            else
               call text%add(indent//'  <geometry><'//kind//'><radius>'//row_of(sizes)//'</radius></'//kind//'></geometry>')
            end if
         else
            call text%add(indent//'<visual>')
            call text%add(indent//'  <origin xyz="'//row_of(at)//'" rpy="'//row_of(turns)//'"/>')
            if (size(sizes) > 1) then
               call text%add(indent//'  <geometry><'//kind//' radius="'//row_of(sizes(:1))//'" length="'//row_of(sizes(2:))// &
                             '"/></geometry>')
            else
               call text%add(indent//'  <geometry><'//kind//' radius="'//row_of(sizes)//'"/></geometry>')
            end if
         end if
         call text%add(indent//'</visual>')
      end subroutine write_shape
   end subroutine write_shapes

   !> Append a robot: links as a tree; the joints that close loops stand in a tag that Gazebo reads. Warning: relations of more than
   !> two joints.
   subroutine write_urdf(model, line, text, findings)
      type(multibody_t), intent(in) :: model
      integer, intent(in) :: line                !! of the case in its file
      type(text_t), intent(inout) :: text
      type(diagnostics_t), intent(inout) :: findings
      type(robot_names_t) :: names
      type(follower_t), allocatable :: followers(:)
      integer :: b, j

      names = robot_names(model)
      call find_followers(model, line, 'URDF', followers, findings)
      call text%add('<robot name="'//names%model//'">')
      if (allocated(model%dependence)) &
         call text%add('  <!-- coordinates of all joints by the stroke of the drive: in the .urdf.json file beside this one -->')
      call text%add('  <link name="world"/>')
      call text%add('  <joint name="'//names%bodies(1)%text//'_stands" type="fixed">')
      call text%add('    <origin xyz="0 0 0" rpy="'//row_of(upright)//'"/>')
      call text%add('    <parent link="world"/>')
      call text%add('    <child link="'//names%bodies(1)%text//'"/>')
      call text%add('  </joint>')
      do b = 1, size(model%bodies)
         associate (body => model%bodies(b))
            call text%add('  <link name="'//names%bodies(b)%text//'">')
            if (b > 1) then
               call text%add('    <inertial>')
               call text%add('      <origin xyz="'//row_of([body%centre - body%at, 0.0_wp])//'"/>')
               call text%add('      <mass value="'//row_of([body%mass])//'"/>')
               call text%add('      <inertia ixx="'//row_of([flat(1)*body%inertia])//'" iyy="'//row_of([flat(2)*body%inertia])// &
                             '" izz="'//row_of([body%inertia])//'" ixy="0" ixz="0" iyz="0"/>')
               call text%add('    </inertial>')
            end if
            call write_shapes(model, b, .false., '    ', text)
            call text%add('  </link>')
            if (body%joint > 0) call write_tree_joint(body%joint)
         end associate
      end do
      if (.not. all(model%joints%in_tree)) then
         call text%add('  <gazebo>')
         do j = 1, size(model%joints)
            if (.not. model%joints(j)%in_tree) then
               call begin_joint_of_sdf(model, names, j, .false., '    ', text)
               call text%add('      </axis>')
               call text%add('    </joint>')
            end if
         end do
         call text%add('  </gazebo>')
      end if
      call text%add('</robot>')

   contains

      !> Limits of a joint: of the drive those that are proven, of a slide such as the linkage does not come to.
      subroutine find_limits(j, limited, limits)
         integer, intent(in) :: j
         logical, intent(out) :: limited           !! proven
         real(wp), intent(out) :: limits(2)

         limits = [-beyond, beyond]*model%size
         limited = .false.
         if (.not. allocated(model%dependence)) return
         if (model%dependence%whole_turn) return
         associate (factors => model%relations(1)%factors)
            limited = abs(factors(j)) > 0.0_wp .and. count(abs(factors) > 0.0_wp) == 1
            if (limited) limits = [model%dependence%low, model%dependence%high]/factors(j)
            if (limits(1) > limits(2)) limits = limits([2, 1])
         end associate
      end subroutine find_limits

      subroutine write_tree_joint(j)
         integer, intent(in) :: j
         character(:), allocatable :: kind
         real(wp) :: from(2), limits(2)
         logical :: limited
         integer :: f

         associate (joint => model%joints(j))
            from = 0.0_wp
            if (joint%bodies(1) > 1) from = model%bodies(joint%bodies(1))%at
            call find_limits(j, limited, limits)
            if (joint%slides) then
               kind = 'prismatic'
            else if (limited) then
               kind = 'revolute'
            else
               kind = 'continuous'
            end if
            call text%add('  <joint name="'//names%joints(j)%text//'" type="'//kind//'">')
            call text%add('    <origin xyz="'//row_of([joint%at - from, 0.0_wp])//'"/>')
            call text%add('    <parent link="'//names%bodies(joint%bodies(1))%text//'"/>')
            call text%add('    <child link="'//names%bodies(joint%bodies(2))%text//'"/>')
            call text%add('    <axis xyz="'//row_of(axis_of(joint))//'"/>')
            if (joint%slides .or. limited) call text%add('    <limit lower="'//row_of(limits(:1))//'" upper="'// &
                                                         row_of(limits(2:))//'" effort="'//row_of([free])//'" velocity="'// &
                                                         row_of([free])//'"/>')
            f = 0
            if (size(followers) > 0) f = findloc(followers%follower, j, dim=1)
            if (f > 0) call text%add('    <mimic joint="'//names%joints(followers(f)%leader)%text//'" multiplier="'// &
                                     row_of([followers(f)%factor])//'" offset="0"/>')
            call text%add('  </joint>')
         end associate
      end subroutine write_tree_joint
   end subroutine write_urdf

   !> The coordinates of joints by the stroke of the drive, as JSON.
   subroutine write_joint_series(model, mark, text)
      type(multibody_t), intent(in) :: model     !! with `dependence`
      character(*), intent(in) :: mark           !! of the run
      type(text_t), intent(inout) :: text
      type(robot_names_t) :: names
      character(:), allocatable :: factors
      integer :: j

      names = robot_names(model)
      associate (dependence => model%dependence, relation => model%relations(1))
         factors = ''
         do j = 1, size(relation%factors)
            if (.not. abs(relation%factors(j)) > 0.0_wp) cycle
            if (len(factors) > 0) factors = factors//', '
            factors = factors//json_text(names%joints(j)%text)//': '//json_number(relation%factors(j), exact=.true.)
         end do
         call text%add('{"run": '//json_text(mark)//', "model": '//json_text(names%model)//',')
         call text%add(' "series": "Chebyshev: coordinate = sum of coefficients[k] T_k(t), '// &
                       't = (2 stroke - low - high)/(high - low)",')
         call text%add(' "drive": {"stroke": {'//factors//'}, "unit": "'//unit_of(relation%slides)//'",')
         call text%add('  "low": '//json_number(dependence%low, exact=.true.)//', "high": '// &
                       json_number(dependence%high, exact=.true.)//', "whole_turn": '//truth(dependence%whole_turn)//'},')
         call text%add(' "joints": [')
         do j = 1, size(dependence%joints)
            associate (of => dependence%joints(j))
               call text%add('  {"joint": '//json_text(names%joints(of%joint)%text)//', "unit": "'// &
                             unit_of(model%joints(of%joint)%slides)//'", "advance": '//json_number(of%advance, exact=.true.)// &
                             ', "largest_error": '//json_number(of%error, digits=3)//',')
               call text%add_text('   "coefficients": ')
               call add_numbers(of%coefficients, text, exact=.true.)
               call text%add('}'//trim(merge(', ', '  ', j < size(dependence%joints))))
            end associate
         end do
         call text%add(' ]}')
      end associate

   contains

      pure function unit_of(slides) result(unit)
         logical, intent(in) :: slides
         character(:), allocatable :: unit

         unit = trim(merge('m  ', 'rad', slides))
      end function unit_of
   end subroutine write_joint_series
end module psalm_sdf
