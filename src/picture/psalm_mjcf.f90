!> A mechanism for MuJoCo: bodies nested as the tree of joints has them, loops closed by equality constraints.
!>
!> The plane of the linkage stands upright: its y axis is the z axis of the world. Format: MJCF, MuJoCo 3 and later.
module psalm_mjcf
   use psalm_kinds, only: wp, full_turn, radians_per_degree, right_angle
   use psalm_multibody, only: multibody_t
   use psalm_robot_names, only: bar_radius, bars_of, flat, robot_names_t, robot_names, row_of
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: write_mjcf

   real(wp), parameter :: steps_of_turn = 10000.0_wp !! time steps in a turn of the crank, or in a stroke as long as the linkage
   real(wp), parameter :: relaxation = 5.0_wp       !! time steps in which a gap of a loop fades; with 2 a Jansen leg is unstable
   real(wp), parameter :: longest_step = 1.0e-3_wp  !! s
   real(wp), parameter :: response = 5.0_wp         !! time steps in which a drive answers
   real(wp), parameter :: endless = 1.0e6_wp        !! rad or m that a drive may go
   character(*), parameter :: frame_colour = '0.55 0.55 0.55 1' !! red, green, blue, opacity
   character(*), parameter :: colours(*) = [character(16) :: '0.12 0.42 0.75 1', '0.80 0.40 0.10 1', '0.18 0.55 0.25 1', &
                                            '0.50 0.25 0.65 1', '0.75 0.60 0.10 1', '0.10 0.60 0.62 1']
   real(wp), parameter :: ghost = 1.0e-4_wp         !! mass of a body that only closes a loop by a slide, as part of the mean

contains

   !> Append the file.
   subroutine write_mjcf(model, text)
      type(multibody_t), intent(in) :: model
      type(text_t), intent(inout) :: text
      type(robot_names_t) :: names
      character(:), allocatable :: speeds
      real(wp) :: step, pace, ghost_mass
      integer :: k

      names = robot_names(model)
      speeds = ''
      pace = abs(model%speed)
      if (.not. pace > 0.0_wp) pace = merge(model%size, 1.0_wp, model%relations(1)%slides)
      step = min(longest_step, merge(model%size, full_turn*radians_per_degree, model%relations(1)%slides)/(pace*steps_of_turn))
      ghost_mass = ghost*sum(model%bodies%mass)/real(size(model%bodies), wp)
      call text%add('<mujoco model="'//names%model//'">')
      call text%add('  <compiler angle="radian" autolimits="true" inertiafromgeom="false"/>')
      call text%add('  <option timestep="'//row_of([step])//'" tolerance="1e-12" gravity="'// &
                    row_of([model%gravity(1), 0.0_wp, model%gravity(2)])//'"/>')
      ! what programs list as the input where all coordinates are 0: degrees, or a length in the unit of the case
      call text%add('  <custom>')
      call text%add('    <numeric name="input" data="'//row_of([model%input])//'"/>')
      call text%add('  </custom>')
      call text%add('  <statistic extent="'//row_of([2.0_wp*model%size])//'"/>')
      call text%add('  <default>')
      call text%add('    <geom type="capsule" contype="0" conaffinity="0" mass="0"/>')
      call text%add('    <equality solref="'//row_of([relaxation*step])//' 1" solimp="0.9999 0.9999 0.001 0.5 2"/>')
      call text%add('  </default>')
      call text%add('  <worldbody>')
      call text%add('    <light directional="true" pos="0 -1 1" dir="0 1 -1"/>')
      call write_body(1, '    ')
      call text%add('  </worldbody>')
      if (size(model%springs) > 0 .or. any([(is_sum(k), k=1, size(model%relations))])) call write_tendons()
      if (any(.not. model%joints%in_tree) .or. any(.not. model%relations%is_drive)) call write_equalities()
      if (any(model%relations%is_drive)) call write_drives()
      call text%add('  <keyframe>')
      ! the target of a drive is ahead by as much as its damper holds back
      associate (rates => pack(model%relations%rate, model%relations%is_drive))
         call text%add('    <key name="running" qvel="'//speeds//'" act="'//row_of(2.0_wp*response*step*rates)//'" ctrl="'// &
                       row_of(rates)//'"/>')
      end associate
      call text%add('  </keyframe>')
      call text%add('</mujoco>')

   contains

      !> A body, with those that hang on it.
      recursive subroutine write_body(b, indent)
         integer, intent(in) :: b
         character(*), intent(in) :: indent
         real(wp), allocatable :: bars(:, :, :)
         real(wp) :: from(2)
         integer :: i, e

         associate (body => model%bodies(b))
            from = 0.0_wp
            if (b == 1) then
               call text%add(indent//'<body name="'//names%bodies(b)%text//'" euler="'// &
                             row_of([right_angle*radians_per_degree, 0.0_wp, 0.0_wp])//'">')
            else
               associate (parent => model%joints(body%joint)%bodies(1))
                  if (parent > 1) from = model%bodies(parent)%at
               end associate
               call text%add(indent//'<body name="'//names%bodies(b)%text//'" pos="'//row_of([body%at - from, 0.0_wp])//'">')
               from = body%at
               call text%add(indent//'  <inertial pos="'//row_of([body%centre - from, 0.0_wp])//'" mass="'// &
                             row_of([body%mass])//'" diaginertia="'//row_of(body%inertia*flat)//'"/>')
               call write_joint(body%joint, indent//'  ')
            end if
            bars = bars_of(body%points, model%size)
            do i = 1, size(bars, 3)
               call text%add(indent//'  <geom rgba="'//colour_of(b)//'" size="'//row_of([bar_radius(model)])//'" fromto="'// &
                             row_of([bars(:, 1, i) - from, 0.0_wp, bars(:, 2, i) - from, 0.0_wp])//'"/>')
            end do
            if (size(bars, 3) == 0 .and. size(body%points, 2) > 0) &
               call text%add(indent//'  <geom type="sphere" rgba="'//colour_of(b)//'" size="'// &
                             row_of([2.0_wp*bar_radius(model)])//'" pos="'//row_of([body%points(:, 1) - from, 0.0_wp])//'"/>')
            if (b > 1) call text%add(indent//'  <geom type="sphere" rgba="0.15 0.15 0.15 1" size="'// &
                                     row_of([1.5_wp*bar_radius(model)])//'"/>')
            do i = 1, size(model%marked)
               if (model%marked(i)%body == b) call text%add(indent//'  <site name="'//names%marked(i)%text//'" size="'// &
                                                            row_of([1.5_wp*bar_radius(model)])//'" pos="'// &
                                                            row_of([model%marked(i)%at - from, 0.0_wp])//'"/>')
            end do
            do i = 1, size(model%springs)
               do e = 1, 2
                  if (model%springs(i)%bodies(e) == b) call text%add(indent//'  <site name="'//site_of(i, e)//'" pos="'// &
                                                                    row_of([model%springs(i)%ends(:, e) - from, 0.0_wp])//'"/>')
               end do
            end do
            do i = 1, size(model%joints)
               associate (joint => model%joints(i))
                  if (joint%in_tree .or. .not. joint%slides .or. joint%bodies(1) /= b) cycle
                  ! what slides here is welded to the other body
                  call text%add(indent//'  <body name="'//guide_of(i)//'" pos="'//row_of([joint%at - from, 0.0_wp])//'">')
                  call text%add(indent//'    <inertial pos="0 0 0" mass="'//row_of([ghost_mass])//'" diaginertia="'// &
                                row_of(ghost_mass*bar_radius(model)**2*flat)//'"/>')
                  call write_joint(i, indent//'    ')
                  call text%add(indent//'  </body>')
               end associate
            end do
            do i = 2, size(model%bodies)
               if (model%joints(model%bodies(i)%joint)%bodies(1) == b) call write_body(i, indent//'  ')
            end do
         end associate
         call text%add(indent//'</body>')
      end subroutine write_body

      !> The frame is grey, links have colours in turn.
      pure function colour_of(b) result(colour)
         integer, intent(in) :: b
         character(:), allocatable :: colour

         colour = trim(frame_colour)
         if (b > 1) colour = trim(colours(modulo(b - 2, size(colours)) + 1))
      end function colour_of

      !> A joint of the body that it stands in.
      subroutine write_joint(j, indent)
         integer, intent(in) :: j
         character(*), intent(in) :: indent

         associate (joint => model%joints(j))
            if (joint%slides) then
               call text%add(indent//'<joint name="'//names%joints(j)%text//'" type="slide" axis="'// &
                             row_of([joint%along, 0.0_wp])//'"/>')
            else
               call text%add(indent//'<joint name="'//names%joints(j)%text//'" type="hinge" axis="0 0 1"/>')
            end if
            if (len(speeds) > 0) speeds = speeds//' '
            speeds = speeds//row_of([joint%rate])
         end associate
      end subroutine write_joint

      pure function guide_of(j) result(name)
         integer, intent(in) :: j
         character(:), allocatable :: name

         name = names%joints(j)%text//'_guide'
      end function guide_of

      pure function site_of(spring, end) result(name)
         integer, intent(in) :: spring, end
         character(:), allocatable :: name

         name = 'spring_'//to_text(spring)//'_'//to_text(end)
      end function site_of

      !> True for a relation that is more than the coordinate of one joint.
      pure logical function is_sum(k)
         integer, intent(in) :: k

         is_sum = .not. model%relations(k)%is_drive .or. count(abs(model%relations(k)%factors) > 0.0_wp) /= 1
      end function is_sum

      subroutine write_tendons()
         integer :: i, j

         call text%add('  <tendon>')
         do i = 1, size(model%relations)
            if (.not. is_sum(i)) cycle
            call text%add('    <fixed name="'//names%relations(i)%text//'">')
            do j = 1, size(model%joints)
               associate (factor => model%relations(i)%factors(j))
                  if (abs(factor) > 0.0_wp) call text%add('      <joint joint="'//names%joints(j)%text//'" coef="'// &
                                                          row_of([factor])//'"/>')
               end associate
            end do
            call text%add('    </fixed>')
         end do
         do i = 1, size(model%springs)
            associate (spring => model%springs(i))
               call text%add('    <spatial name="spring_'//to_text(i)//'" width="'//row_of([0.3_wp*bar_radius(model)])// &
                             '" stiffness="'//row_of([spring%stiffness])//'" damping="'//row_of([spring%damping])// &
                             '" springlength="'//row_of([spring%free])//'">')
            end associate
            call text%add('      <site site="'//site_of(i, 1)//'"/>')
            call text%add('      <site site="'//site_of(i, 2)//'"/>')
            call text%add('    </spatial>')
         end do
         call text%add('  </tendon>')
      end subroutine write_tendons

      subroutine write_equalities()
         integer :: i

         call text%add('  <equality>')
         do i = 1, size(model%joints)
            associate (joint => model%joints(i))
               if (joint%in_tree) cycle
               associate (one => names%bodies(joint%bodies(1))%text, other => names%bodies(joint%bodies(2))%text)
                  if (joint%slides) then
                     call text%add('    <weld name="'//names%joints(i)%text//'_closes" body1="'//guide_of(i)//'" body2="'// &
                                   other//'"/>')
                     cycle
                  end if
                  call text%add('    <connect name="'//names%joints(i)%text//'_closes" body1="'//one//'" body2="'//other// &
                                '" anchor="'//row_of([joint%at - axes_of(joint%bodies(1)), 0.0_wp])//'"/>')
               end associate
            end associate
         end do
         do i = 1, size(model%relations)
            if (.not. model%relations(i)%is_drive) call text%add('    <tendon name="'//names%relations(i)%text// &
                                                                 '_holds" tendon1="'//names%relations(i)%text//'"/>')
         end do
         call text%add('  </equality>')
      end subroutine write_equalities

      !> Where the axes of a body are; those of the frame are the machine's.
      pure function axes_of(b) result(at)
         integer, intent(in) :: b
         real(wp) :: at(2)

         at = 0.0_wp
         if (b > 1) at = model%bodies(b)%at
      end function axes_of

      !> Drives that hold a speed: a target that moves at it, followed by a stiff spring with critical damping. They are as stiff as
      !> the step allows for the inertia that a drive feels, and for that of what hangs on its joint.
      subroutine write_drives()
         real(wp) :: inertia, spring
         integer :: i, j
         character(:), allocatable :: where

         call text%add('  <actuator>')
         do i = 1, size(model%relations)
            associate (relation => model%relations(i))
               if (.not. relation%is_drive) cycle
               inertia = model%inertia
               if (i > 1) inertia = huge(inertia)
               do j = 1, size(model%joints)
                  if (abs(relation%factors(j)) > 0.0_wp) inertia = min(inertia, inertia_beyond(j)/relation%factors(j)**2)
               end do
               spring = inertia/(response*step)**2
               j = maxloc(abs(relation%factors), dim=1)
               where = 'joint="'//names%joints(j)%text//'" gear="'//row_of(relation%factors([j]))
               if (is_sum(i)) where = 'tendon="'//names%relations(i)%text
               call text%add('    <intvelocity name="'//names%relations(i)%text//'" '//where//'" kp="'//row_of([spring])// &
                             '" kv="'//row_of([2.0_wp*sqrt(spring*inertia)])//'" actrange="'// &
                             row_of([-endless, endless])//'"/>')
            end associate
         end do
         call text%add('  </actuator>')
      end subroutine write_drives

      !> Inertia of all that hangs on a joint of the tree: kg, or kg m2 about its pin.
      pure real(wp) function inertia_beyond(joint) result(inertia)
         integer, intent(in) :: joint
         logical :: beyond(size(model%bodies))
         integer :: b

         inertia = 0.0_wp
         beyond = .false.
         do b = 2, size(model%bodies)
            associate (body => model%bodies(b))
               beyond(b) = body%joint == joint .or. beyond(model%joints(body%joint)%bodies(1))
               if (.not. beyond(b)) cycle
               if (model%joints(joint)%slides) then
                  inertia = inertia + body%mass
               else
                  inertia = inertia + body%inertia + body%mass*sum((body%centre - model%joints(joint)%at)**2)
               end if
            end associate
         end do
      end function inertia_beyond
   end subroutine write_mjcf
end module psalm_mjcf
