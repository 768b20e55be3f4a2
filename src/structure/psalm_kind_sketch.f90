!> A kind of linkage as a sketch: joints where they are put, links, slides, drive and output with names.
module psalm_kind_sketch
   use psalm_angles, only: degrees_of
   use psalm_chain_graphs, only: joint_none, joint_pin, joint_slide, joint_driven_pin, joint_driven_slide, joint_gear
   use psalm_kinds, only: wp, half_turn
   use psalm_linkage_kinds, only: linkage_kind_t, ratios_of, kind_of_angle, kind_of_pose
   use psalm_sketch, only: link_t, sketch_t, drive_turns, drive_stretches, output_point, output_angle, output_pose, &
                           frame_link, vary_all
   use psalm_text, only: to_text
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: draw_at_random, draw_neatly

   character(*), parameter :: letters = 'ABCDEFGHIJKLMNOQRSTUVWXYZ' ! P is the output
   real(wp), parameter :: teeth = 20.0_wp       !! of the smaller wheel
   real(wp), parameter :: step_of_direction = 22.5_wp !! degrees; slides in neat drawings

contains

   !> The sketch. `places` are those of its joints and slides, one for each joint of the graph in the order of pairs of links, a
   !> drive between cylinder and rod left out, and of the output point last; `angles` are directions of the slides, degrees; `ratio`
   !> is that of the gear pair, where there is one.
   pure subroutine draw_kind(kind, what, places, angles, ratio, sketch)
      type(linkage_kind_t), intent(in) :: kind
      integer, intent(in) :: what                   !! one of `kind_of_...`
      complex(wp), intent(in) :: places(:)          !! shape (joints + 1)
      real(wp), intent(in) :: angles(:)             !! shape (joints + 1)
      real(wp), intent(in) :: ratio
      type(sketch_t), intent(out) :: sketch
      integer :: link(kind%graph%n), order(kind%graph%n), a, b, n, next, at, joint, slide, cylinder, drive
      logical :: has_point

      associate (graph => kind%graph)
         n = graph%n
         ! the frame first, the driven link next; cylinder and rod are one link
         ! an angle is that of a line between two joints
         has_point = what /= kind_of_angle
         if (.not. has_point) has_point = count(graph%joint(:n, kind%output) == joint_pin) < 2
         cylinder = 0
         if (graph%joint(kind%base, kind%driven) == joint_driven_slide) cylinder = kind%base
         order = [kind%frame, kind%driven, pack([(a, a=1, n)], [(a /= kind%frame .and. a /= kind%driven, a=1, n)])]
         ! links that stretch stand last in a sketch
         if (cylinder > 0) order(2:) = cshift(order(2:), 1)
         link = 0
         next = 0
         do a = 1, n
            if (order(a) == cylinder) cycle
            next = next + 1
            link(order(a)) = next
         end do
         if (cylinder > 0) link(cylinder) = link(kind%driven)
         sketch%valid = .true.
         allocate (sketch%links(next))
         do a = 1, next
            sketch%links(a)%name = 'link'//to_text(a)
            allocate (sketch%links(a)%joints(0))
         end do
         sketch%links(frame_link)%name = 'frame'
         sketch%links(link(kind%driven))%name = merge('cylinder', 'crank   ', cylinder > 0)
         associate (pins => count_of(joint_slide, .false.), slides => count_of(joint_slide, .true.), &
                    points => merge(1, 0, has_point))
            allocate (sketch%joint_name(pins + points), sketch%x(pins + points), sketch%y(pins + points))
            allocate (sketch%slides(slides))
         end associate
         joint = 0
         slide = 0
         drive = 0
         at = 0
         do a = 1, n - 1
            do b = a + 1, n
               select case (graph%joint(a, b))
               case (joint_none, joint_driven_slide, joint_gear)
                  cycle
               case (joint_slide)
                  at = at + 1
                  slide = slide + 1
                  sketch%slides(slide)%name = 'S'//to_text(slide)
                  sketch%slides(slide)%links = [min(link(a), link(b)), max(link(a), link(b))]
                  sketch%slides(slide)%x = places(at)%re
                  sketch%slides(slide)%y = places(at)%im
                  sketch%slides(slide)%angle = angles(at)
               case default
                  at = at + 1
                  joint = joint + 1
                  sketch%joint_name(joint) = letters(joint:joint)
                  sketch%x(joint) = places(at)%re
                  sketch%y(joint) = places(at)%im
                  call hang(sketch%links(link(a)), joint)
                  call hang(sketch%links(link(b)), joint)
                  if (graph%joint(a, b) == joint_driven_pin) drive = joint
               end select
            end do
         end do
         at = at + 1
         if (has_point) then
            joint = joint + 1
            sketch%joint_name(joint) = 'P'
            sketch%x(joint) = places(at)%re
            sketch%y(joint) = places(at)%im
            call hang(sketch%links(link(kind%output)), joint)
         end if
         allocate (sketch%drives(1), sketch%outputs(1), sketch%gears(merge(1, 0, kind%arm > 0)), sketch%variations(1))
         if (kind%arm > 0) call put_in_gear(sketch)
         allocate (sketch%length_of(2, 0), sketch%length(0))
         sketch%variations(1)%kind = vary_all
         associate (one => sketch%drives(1))
            one%link = link(kind%driven)
            if (cylinder > 0) then
               one%kind = drive_stretches
               associate (ends => sketch%links(one%link)%joints)
                  one%name = trim(sketch%joint_name(ends(1)))//' '//trim(sketch%joint_name(ends(2)))
               end associate
            else
               one%kind = drive_turns
               one%joint = drive
               one%base = frame_link
               one%name = sketch%joint_name(drive)
            end if
         end associate
         associate (output => sketch%outputs(1), own => sketch%links(link(kind%output)))
            select case (what)
            case (kind_of_angle)
               output%kind = output_angle
               output%link = link(kind%output)
               output%joints(:2) = own%joints(:2)
               output%name = 'angle_'//trim(own%name)
            case (kind_of_pose)
               output%kind = output_pose
               output%link = link(kind%output)
               output%joints(:3) = [joint, own%joints(:2)]
               output%name = 'pose_P_'//trim(own%name)
            case default
               output%kind = output_point
               output%joints(1) = joint
               output%name = 'point_P'
            end select
         end associate
      end associate

   contains

      !> Joints drawn that are slides, or that are not.
      pure integer function count_of(what_joint, is_it)
         integer, intent(in) :: what_joint
         logical, intent(in) :: is_it
         integer :: i, j

         count_of = 0
         do i = 1, n - 1
            do j = i + 1, n
               if (any(kind%graph%joint(i, j) == [joint_none, joint_driven_slide, joint_gear])) cycle
               if ((kind%graph%joint(i, j) == what_joint) .eqv. is_it) count_of = count_of + 1
            end do
         end do
      end function count_of

      !> The pair, the smaller wheel with `teeth`; of an internal pair the second number is negative.
      pure subroutine put_in_gear(of)
         type(sketch_t), intent(inout) :: of

         associate (gear => of%gears(1))
            gear%wheels = link(kind%wheels)
            gear%carrier = link(kind%arm)
            gear%ratio = ratio
            gear%teeth = [teeth*max(1.0_wp, abs(ratio)), -sign(teeth*max(1.0_wp, 1.0_wp/abs(ratio)), ratio)]
         end associate
      end subroutine put_in_gear
   end subroutine draw_kind

   !> A link gets one more joint.
   pure subroutine hang(link, joint)
      type(link_t), intent(inout) :: link
      integer, intent(in) :: joint

      link%joints = [link%joints, joint]
   end subroutine hang

   !> Joints and slides to be placed, the output point not counted.
   pure integer function drawn_joints(kind)
      type(linkage_kind_t), intent(in) :: kind

      drawn_joints = kind%graph%joints()
      if (kind%graph%joint(kind%base, kind%driven) == joint_driven_slide) drawn_joints = drawn_joints - 1
   end function drawn_joints

   !> Joints anywhere in a square of that side round a centre: which assembly that is, chance decides. Gears have a random ratio,
   !> too: `pair` is its place among those that the kind may have, 0: there are no gears.
   pure subroutine draw_at_random(kind, what, centre, side, random, sketch, pair)
      type(linkage_kind_t), intent(in) :: kind
      integer, intent(in) :: what
      complex(wp), intent(in) :: centre
      real(wp), intent(in) :: side
      type(xoshiro_t), intent(inout) :: random
      type(sketch_t), intent(out) :: sketch
      integer, intent(out) :: pair
      complex(wp) :: places(drawn_joints(kind) + 1)
      real(wp) :: angles(size(places)), u, v
      real(wp), allocatable :: ratios(:)
      integer :: k

      do k = 1, size(places)
         call random%next(u)
         call random%next(v)
         places(k) = centre + side*cmplx(u - 0.5_wp, v - 0.5_wp, wp)
         call random%next(u)
         angles(k) = half_turn*u
      end do
      ratios = [ratios_of(kind), 1.0_wp]
      pair = 0
      if (kind%arm > 0) then
         call random%next(u)
         pair = 1 + int(u*real(size(ratios) - 1, wp))
      end if
      call draw_kind(kind, what, places, angles, ratios(max(1, pair)), sketch)
   end subroutine draw_at_random

   !> Joints so that a picture shows the kind: those of one link one unit apart, others as far as the links between them say (least
   !> stress, by majorisation; of some beginnings the best). Slides point from joint to joint.
   !> Source: Gansner, Koren and North, Graph drawing by stress majorization (2004).
   subroutine draw_neatly(kind, what, sketch)
      type(linkage_kind_t), intent(in) :: kind
      integer, intent(in) :: what
      type(sketch_t), intent(out) :: sketch
      integer, parameter :: beginnings = 12, steps = 120
      complex(wp), allocatable :: z(:), best(:)
      real(wp), allocatable :: far(:, :), angles(:)
      type(xoshiro_t) :: random
      real(wp) :: stress, least, u, v
      integer, allocatable :: on(:, :)
      integer :: m, i, j, k, step, trial, a, b

      associate (graph => kind%graph)
         m = drawn_joints(kind) + 1
         allocate (on(2, m), source=0)
         k = 0
         do a = 1, graph%n - 1
            do b = a + 1, graph%n
               if (any(graph%joint(a, b) == [joint_none, joint_driven_slide, joint_gear])) cycle
               k = k + 1
               on(:, k) = [a, b]
               ! cylinder and rod are one link
               if (graph%joint(kind%base, kind%driven) == joint_driven_slide) then
                  where (on(:, k) == kind%base) on(:, k) = kind%driven
               end if
            end do
         end do
         on(:, m) = kind%output
      end associate
      allocate (far(m, m), source=real(2*m, wp))
      do i = 1, m
         far(i, i) = 0.0_wp
         do j = 1, m
            if (i /= j .and. (any(on(1, i) == on(:, j)) .or. any(on(2, i) == on(:, j)))) far(i, j) = 1.0_wp
         end do
      end do
      do k = 1, m
         do i = 1, m
            do j = 1, m
               far(i, j) = min(far(i, j), far(i, k) + far(k, j))
            end do
         end do
      end do
      call random%seed(1, purpose_starts)
      least = huge(least)
      allocate (z(m))
      do trial = 1, beginnings
         do i = 1, m
            call random%next(u)
            call random%next(v)
            z(i) = sqrt(real(m, wp))*cmplx(u, v, wp)
         end do
         do step = 1, steps
            call majorise(z)
         end do
         stress = 0.0_wp
         do i = 2, m
            do j = 1, i - 1
               stress = stress + (abs(z(i) - z(j))/far(i, j) - 1.0_wp)**2
            end do
         end do
         if (stress < least) then
            least = stress
            best = z
         end if
      end do
      ! the frame below and level: by two of its joints
      associate (frame => pack([(i, i=1, m)], any(on == kind%frame, dim=1)))
         if (size(frame) > 1) best = (best - best(frame(1)))*conjg(best(frame(2)) - best(frame(1)))/ &
                                     max(abs(best(frame(2)) - best(frame(1))), tiny(1.0_wp))
         if (sum(best%im) < 0.0_wp) best = conjg(best)
      end associate
      allocate (angles(m), source=0.0_wp)
      do k = 1, m - 1
         ! along the line to the nearest joint of the first link
         j = 0
         do i = 1, m - 1
            if (i == k .or. all(on(:, i) /= on(1, k))) cycle
            if (j == 0) j = i
         end do
         if (j > 0) angles(k) = direction(best(j) - best(k))
      end do
      associate (ratios => [ratios_of(kind), 1.0_wp])
         call draw_kind(kind, what, best, angles, ratios(1), sketch)
      end associate

   contains

      pure real(wp) function direction(w)
         complex(wp), intent(in) :: w

         direction = step_of_direction*anint(degrees_of(w%re, w%im)/step_of_direction)
      end function direction

      !> One step: every joint to the mean of where the others want it.
      subroutine majorise(at)
         complex(wp), intent(inout) :: at(:)
         complex(wp) :: pull, gap
         real(wp) :: weight, all_weights
         integer :: p, q

         do p = 1, m
            pull = (0.0_wp, 0.0_wp)
            all_weights = 0.0_wp
            do q = 1, m
               if (p == q) cycle
               weight = 1.0_wp/far(p, q)**2
               gap = at(p) - at(q)
               all_weights = all_weights + weight
               pull = pull + weight*(at(q) + far(p, q)*gap/max(abs(gap), tiny(1.0_wp)))
            end do
            at(p) = pull/all_weights
         end do
      end subroutine majorise
   end subroutine draw_neatly
end module psalm_kind_sketch
