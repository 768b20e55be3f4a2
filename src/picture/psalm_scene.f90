!> The scene: everything that pictures of a linkage show, computed once, in machine axes.
!>
!> Two rows of positions (`psalm_trace`): the prescribed ones and a sweep between and beyond them.
module psalm_scene
   use psalm_angles, only: unit_vector
   use psalm_chain, only: chain_t, make_chain
   use psalm_constraint_group, only: region_t
   use psalm_data_set, only: data_set_t
   use psalm_dyad_kind, only: direction_known, form_of, form_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp
   use psalm_margin_list, only: describe_margin
   use psalm_margins, only: margin_t, inspector_t, prepare_inspector, inspect, is_violated
   use psalm_markup, only: strings_t, add_string, sentence_case
   use psalm_output_kind, only: motion_point, motion_angle, motion_distance, motion_slide, motion_pose
   use psalm_parts, only: joint_t, bar_t, body_t, slide_t, pair_t, find_slides, convex_hull
   use psalm_plan, only: root_frame
   use psalm_status, only: finding_t, level_error
   use psalm_sweep, only: sweep_inputs, sweep_sense
   use psalm_topology, only: topology_t, dimensions_t
   use psalm_trace, only: row_t, trace_row
   implicit none (type, external)
   private
   public :: scene_t, make_scene, message_scene

   real(wp), parameter :: same_place = 1.0e-9_wp !! joints nearer than this times the size of the linkage are one
   real(wp), parameter :: pointer_part = 0.16_wp !! an output arc without length is drawn this part of the view long
   real(wp), parameter :: flattest = 0.12_wp     !! a view is at least this part as high as it is wide
   real(wp), parameter :: enlarge = 0.25_wp       !! a sweep widens the view by at most this part of it

   type :: scene_t
      character(:), allocatable :: title, file
      logical :: sound = .false.                          !! there is a linkage to draw, not messages only
      type(strings_t), allocatable :: errors(:), warnings(:)
      type(strings_t), allocatable :: breaches(:)         !! constraints of the group CONSTR that are violated
      integer :: motion = motion_point
      logical :: sliding = .false., desired = .false., everywhere = .false. !! sliding input; desired values; KTHETA=1
      real(wp) :: tangle = 90.0_wp, sense = 1.0_wp
      integer :: loops = 0
      type(joint_t), allocatable :: joints(:)
      type(bar_t), allocatable :: bars(:)
      type(body_t), allocatable :: bodies(:)
      type(slide_t), allocatable :: slides(:)
      type(pair_t), allocatable :: pairs(:)               !! by loop
      type(region_t), allocatable :: regions(:)           !! where joints must not go
      integer :: output = 0, output_base = 0              !! joints: the output point, where the output arc begins
      integer :: output_slide = 0                         !! MOTION 3: the slide
      type(row_t) :: prescribed, sweep
      real(wp) :: pointer = 0.0_wp                        !! drawn length of the output arc with MOTION 1
      integer :: reference = 1                            !! prescribed position nearest to the reference position
      real(wp) :: low(2) = 0.0_wp, high(2) = 1.0_wp       !! corners of the view
   end type scene_t

contains

   !> A scene of messages only, for a case that cannot be solved.
   pure subroutine message_scene(set, findings, scene)
      type(data_set_t), intent(in) :: set
      type(finding_t), intent(in) :: findings(:)   !! of this case
      type(scene_t), intent(out) :: scene
      integer :: i

      scene%title = set%title
      scene%file = set%file(index(set%file, '/', back=.true.) + 1:)
      allocate (scene%errors(0), scene%warnings(0), scene%joints(0), scene%bars(0), scene%bodies(0))
      allocate (scene%slides(0), scene%pairs(0), scene%regions(0), scene%breaches(0))
      do i = 1, size(findings)
         if (findings(i)%level == level_error) then
            call add_string(scene%errors, words(findings(i)))
         else
            call add_string(scene%warnings, words(findings(i)))
         end if
      end do
      allocate (scene%prescribed%words(0), scene%sweep%words(0))

   contains

      !> The finding with the name of its file, without the way there.
      pure function words(finding) result(text)
         type(finding_t), intent(in) :: finding
         character(:), allocatable :: text
         type(finding_t) :: short

         short = finding
         short%file = finding%file(index(finding%file, '/', back=.true.) + 1:)
         text = short%render()
      end function words
   end subroutine message_scene

   !> The scene of a case. Errors among its findings make it a scene of messages (`scene%sound` is false).
   subroutine make_scene(set, topology, dimensions, findings, scene)
      type(data_set_t), intent(in) :: set
      type(topology_t), intent(in) :: topology
      type(dimensions_t), intent(in) :: dimensions
      type(finding_t), intent(in) :: findings(:)   !! of this case, SETUP's included
      type(scene_t), intent(out) :: scene
      type(problem_t) :: own, whole
      type(chain_t) :: chain
      integer, allocatable :: place(:)

      call message_scene(set, findings, scene)
      if (size(scene%errors) > 0) return
      scene%sound = .true.
      deallocate (scene%joints, scene%bars, scene%bodies, scene%pairs)
      ! a pose is drawn as its point
      scene%motion = merge(motion_point, set%motion, set%motion == motion_pose)
      scene%sliding = topology%sliding_input
      scene%everywhere = set%ktheta /= 0
      scene%tangle = set%tangle
      if (allocated(set%constr%regions)) scene%regions = set%constr%regions
      scene%loops = topology%nloop
      call make_problem(set, topology, dimensions, own)
      scene%desired = own%desired
      scene%sense = sweep_sense(own)
      whole = own
      whole%motion = motion_point
      whole%desired = .false.
      call whole%want_derivatives(.true.)
      chain = make_chain(topology)
      call find_slides(topology, whole%plan, chain, scene%slides)
      if (scene%motion == motion_slide) call find_output_slide(topology, chain, scene)
      call trace_row(own, whole, chain, dimensions, scene%slides, scene%output_slide, .true., scene%prescribed)
      if (set%constr%given) call judge(set, own, dimensions, scene)
      call own%set_inputs(sweep_inputs(own))
      call whole%set_inputs(own%delt)
      call trace_row(own, whole, chain, dimensions, scene%slides, scene%output_slide, .false., scene%sweep)
      call merge_joints(scene, chain%joints + 1, place)
      call make_bars(topology, whole%plan%root, dimensions, chain, place, scene)
      call name_joints(scene)
      scene%reference = minloc(abs(scene%prescribed%delt), dim=1)
      call make_bodies(scene)
      call choose_view(scene, maxval(dimensions%arcl))
      call find_rails(scene)
      call find_others(scene, scene%prescribed)
      call find_others(scene, scene%sweep)
      scene%pointer = dimensions%outlk
      if (scene%output == scene%output_base) scene%pointer = pointer_part*norm2(scene%high - scene%low)
      call find_wishes(scene, scene%prescribed)
      call find_wishes(scene, scene%sweep)
      call widen_view(scene)
   end subroutine make_scene

   !> Directions and desired places of the output belong into the view too.
   subroutine widen_view(scene)
      type(scene_t), intent(inout) :: scene
      integer :: k

      do k = 1, scene%prescribed%n
         if (.not. scene%prescribed%closed(k)) cycle
         if (scene%motion == motion_angle) call take(scene%prescribed%aim(:, k))
         if (scene%desired) call take(scene%prescribed%wish(:, k))
      end do

   contains

      subroutine take(point)
         real(wp), intent(in) :: point(2)

         scene%low = min(scene%low, point)
         scene%high = max(scene%high, point)
      end subroutine take
   end subroutine widen_view

   !> The other assembly of each pair: the common joint mirrored in the line of the outer joints (types 1 to 3), or the other
   !> point of the slide's line at the link's distance (types 4 and 5).
   pure subroutine find_others(scene, row)
      type(scene_t), intent(in) :: scene
      type(row_t), intent(inout) :: row
      type(form_t) :: form
      real(wp) :: from(2), along(2), joint(2)
      integer :: loop, k, s
      logical :: mirrored

      allocate (row%other(2, scene%loops, row%n), source=0.0_wp)
      allocate (row%other_known(scene%loops, row%n), source=.false.)
      do loop = 1, scene%loops
         associate (pair => scene%pairs(loop))
            form = form_of(pair%joint_type)
            if (form%power == 0) cycle
            mirrored = all(form%direction /= direction_known)
            s = scene%bars(pair%bars(merge(2, 1, form%slides(2))))%slide
            do k = 1, row%n
               if (.not. row%sound(loop, k)) cycle
               joint = [row%x(pair%shared, k), row%y(pair%shared, k)]
               from = [row%x(pair%start, k), row%y(pair%start, k)]
               along = [row%x(pair%finish, k), row%y(pair%finish, k)] - from
               if (mirrored) then
                  if (norm2(along) <= 0.0_wp) cycle
                  along = along/norm2(along)
                  row%other(:, loop, k) = 2.0_wp*(from + along*dot_product(joint - from, along)) - joint
               else
                  if (form%slides(1)) from = from + along
                  along = [row%ux(s, k), row%uy(s, k)]
                  row%other(:, loop, k) = joint - 2.0_wp*along*dot_product(joint - from, along)
               end if
               row%other_known(loop, k) = .true.
            end do
         end associate
      end do
   end subroutine find_others

   !> Where the output ought to be, and for MOTION 1 the direction it has.
   pure subroutine find_wishes(scene, row)
      type(scene_t), intent(in) :: scene
      type(row_t), intent(inout) :: row
      real(wp) :: base(2), unit(2)
      integer :: k

      allocate (row%aim(2, row%n), row%wish(2, row%n), source=0.0_wp)
      do k = 1, row%n
         if (scene%motion == motion_point .and. size(row%wanted) > 0) row%wish(:, k) = [row%wanted(k), row%wanted_y(k)]
         if (.not. row%closed(k)) cycle
         base = [row%x(scene%output_base, k), row%y(scene%output_base, k)]
         if (scene%motion == motion_angle) then
            call unit_vector(row%actual(k), unit(1), unit(2))
            row%aim(:, k) = base + scene%pointer*unit
         end if
         if (size(row%wanted) == 0) cycle
         select case (scene%motion)
         case (motion_angle)
            call unit_vector(row%wanted(k), unit(1), unit(2))
            row%wish(:, k) = base + scene%pointer*unit
         case (motion_distance)
            if (row%actual(k) <= 0.0_wp) cycle
            row%wish(:, k) = row%wanted(k)*([row%x(scene%output, k), row%y(scene%output, k)]/row%actual(k))
         case (motion_slide)
            associate (slide => scene%slides(scene%output_slide))
               row%wish(:, k) = [row%x(slide%guide, k), row%y(slide%guide, k)] + slide%sense*row%wanted(k)* &
                                [row%ux(scene%output_slide, k), row%uy(scene%output_slide, k)]
            end associate
         end select
      end do
   end subroutine find_wishes

   !> Constraints of the group CONSTR, as `psalm` judges its results.
   subroutine judge(set, own, dimensions, scene)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: own
      type(dimensions_t), intent(in) :: dimensions
      type(scene_t), intent(inout) :: scene
      type(inspector_t) :: inspector
      type(margin_t), allocatable :: margins(:)
      integer :: i

      call prepare_inspector(set, own, set%search%solver%many_starts, inspector)
      call inspect(inspector, dimensions, own%delt, margins)
      do i = 1, size(margins)
         if (is_violated(margins(i))) &
            call add_string(scene%breaches, sentence_case('violated: '//describe_margin(set, own%topology, dimensions, margins(i))))
      end do
   end subroutine judge

   subroutine find_output_slide(topology, chain, scene)
      type(topology_t), intent(in) :: topology
      type(chain_t), intent(in) :: chain
      type(scene_t), intent(inout) :: scene
      integer :: k

      do k = 1, size(scene%slides)
         if (scene%slides(k)%bar == chain%bar_of(topology%output_arc)) scene%output_slide = k
      end do
   end subroutine find_output_slide

   ! ---- what is there -----------------------------------------------------------------------------------------------

   !> Joints that are always at the same place are one joint. `place` tells where each went; the last is the output.
   subroutine merge_joints(scene, joints, place)
      type(scene_t), intent(inout) :: scene
      integer, intent(in) :: joints
      integer, allocatable, intent(out) :: place(:)   !! shape (joints)
      integer, allocatable :: kept(:)
      real(wp) :: near
      integer :: j, k, count

      allocate (place(joints), kept(joints), source=0)
      associate (x => scene%prescribed%x, y => scene%prescribed%y, known => scene%prescribed%known)
         near = max(maxval(x, known) - minval(x, known), maxval(y, known) - minval(y, known))*same_place
      end associate
      count = 0
      do j = 1, joints
         do k = 1, count
            if (together(scene%prescribed, j, kept(k))) then
               if (together(scene%sweep, j, kept(k))) exit
            end if
         end do
         if (k > count) then
            count = count + 1
            kept(count) = j
         end if
         place(j) = k
      end do
      kept = kept(:count)
      call keep(scene%prescribed)
      call keep(scene%sweep)
      allocate (scene%joints(count))
      scene%output = place(joints)
      do k = 1, size(scene%slides)
         scene%slides(k)%guide = place(scene%slides(k)%guide)
         scene%slides(k)%block = place(scene%slides(k)%block)
      end do

   contains

      pure logical function together(row, j, k)
         type(row_t), intent(in) :: row
         integer, intent(in) :: j, k
         integer :: i

         together = .false.
         do i = 1, row%n
            if (row%known(j, i) .neqv. row%known(k, i)) return
            if (max(abs(row%x(j, i) - row%x(k, i)), abs(row%y(j, i) - row%y(k, i))) > near) return
         end do
         together = any(row%known(j, :)) .or. .not. any(scene%prescribed%known(j, :))
         ! joints that are known nowhere are not the same for that
         if (.not. any(scene%prescribed%known(j, :)) .and. .not. any(scene%sweep%known(j, :))) together = .false.
      end function together

      subroutine keep(row)
         type(row_t), intent(inout) :: row

         row%x = row%x(kept, :)
         row%y = row%y(kept, :)
         row%known = row%known(kept, :)
      end subroutine keep
   end subroutine merge_joints

   !> The bars with their names, the output arc last.
   subroutine make_bars(topology, root, dimensions, chain, place, scene)
      type(topology_t), intent(in) :: topology
      integer, intent(in) :: root(:)         !! by sequential number: root of the arc's direction
      type(dimensions_t), intent(in) :: dimensions
      type(chain_t), intent(in) :: chain
      integer, intent(in) :: place(:)
      type(scene_t), intent(inout) :: scene
      integer :: b, n, loop, a, k, start, finish, bars
      character(24) :: name

      bars = chain%bars + merge(0, 1, scene%motion == motion_slide)
      allocate (scene%bars(bars))
      do b = 1, chain%bars
         associate (bar => scene%bars(b))
            bar%start = place(chain%start(b))
            bar%finish = place(chain%finish(b))
            bar%root = root(chain%bar_arc(b))
            bar%length = dimensions%arcl(chain%bar_arc(b))
            bar%others = ''
         end associate
      end do
      do k = 1, size(scene%slides)
         scene%bars(scene%slides(k)%bar)%slide = k
      end do
      do loop = 1, topology%nloop
         do a = 1, topology%loopl(loop)
            n = topology%seq(loop, a)
            associate (bar => scene%bars(chain%bar_of(n)))
               if (bar%loop == 0) then
                  bar%loop = loop
                  bar%arc = a
               else
                  write (name, '("loop ",i0," arc ",i0)') loop, a
                  if (len(bar%others) > 0) bar%others = bar%others//', '
                  bar%others = bar%others//trim(name)
               end if
            end associate
         end do
      end do
      allocate (scene%pairs(topology%nloop))
      do loop = 1, topology%nloop
         associate (pair => scene%pairs(loop))
            pair%joint_type = topology%joint(loop)
            pair%start = place(chain%outer(1, loop))
            pair%finish = place(chain%outer(2, loop))
            pair%shared = place(chain%shared(loop))
            pair%bars = chain%bar_of([topology%seq(loop, topology%larcx(1, loop)), topology%seq(loop, topology%larcx(2, loop))])
         end associate
      end do
      scene%output_base = scene%output
      if (scene%motion == motion_slide) return
      call chain%ends_of(topology, topology%output_arc, start, finish)
      scene%output_base = place(merge(start, finish, topology%output_from_start))
      associate (bar => scene%bars(bars))
         bar%start = scene%output_base
         bar%finish = scene%output
         bar%root = root(topology%output_arc)
         bar%length = dimensions%outlk
         bar%others = ''
      end associate
   end subroutine make_bars

   !> What kind each joint is, and its letter.
   subroutine name_joints(scene)
      type(scene_t), intent(inout) :: scene
      integer :: first(size(scene%joints))
      logical :: turning(size(scene%joints))
      logical :: more
      integer :: b, j, k, count

      first = 0
      turning = .false.
      scene%joints(1)%fixed = .true.
      do
         more = .false.
         do b = 1, size(scene%bars)
            associate (bar => scene%bars(b))
               if (bar%root /= root_frame .or. bar%slide > 0) cycle
               if (scene%joints(bar%start)%fixed .eqv. scene%joints(bar%finish)%fixed) cycle
               scene%joints(bar%start)%fixed = .true.
               scene%joints(bar%finish)%fixed = .true.
               more = .true.
            end associate
         end do
         if (.not. more) exit
      end do
      do b = 1, size(scene%bars)
         call touch(scene%bars(b)%start, scene%bars(b)%root)
         call touch(scene%bars(b)%finish, scene%bars(b)%root)
      end do
      do k = 1, size(scene%slides)
         scene%joints(scene%slides(k)%block)%slides = .true.
      end do
      count = 0
      do j = 1, size(scene%joints)
         associate (joint => scene%joints(j))
            joint%turning = turning(j)
            joint%name = ''
            if (.not. (joint%turning .or. joint%slides)) cycle
            joint%name = letters(count)
            count = count + 1
         end associate
      end do

   contains

      subroutine touch(j, root)
         integer, intent(in) :: j, root

         if (first(j) == 0) first(j) = root
         if (first(j) /= root) turning(j) = .true.
      end subroutine touch

      !> A to Z, then AA, AB ...
      pure recursive function letters(number) result(name)
         integer, intent(in) :: number
         character(:), allocatable :: name

         name = achar(iachar('A') + modulo(number, 26))
         if (number >= 26) name = letters(number/26 - 1)//name
      end function letters
   end subroutine name_joints

   !> Bars of fixed length with the same root that hang together are one rigid body; one with an area is a plate.
   subroutine make_bodies(scene)
      type(scene_t), intent(inout) :: scene
      integer :: body(size(scene%bars)), b, c, count, old
      logical, allocatable :: member(:)
      integer :: j

      body = 0
      count = 0
      do b = 1, size(scene%bars)
         if (scene%bars(b)%slide > 0) cycle
         do c = 1, b - 1
            if (body(c) == 0 .or. scene%bars(c)%root /= scene%bars(b)%root) cycle
            if (.not. any([scene%bars(c)%start, scene%bars(c)%finish] == scene%bars(b)%start .or. &
                          [scene%bars(c)%start, scene%bars(c)%finish] == scene%bars(b)%finish)) cycle
            if (body(b) == 0) then
               body(b) = body(c)
            else if (body(c) /= body(b)) then
               ! the bar joins two bodies
               old = max(body(b), body(c))
               where (body == old) body = min(body(b), body(c))
            end if
         end do
         if (body(b) > 0) cycle
         count = count + 1
         body(b) = count
      end do
      allocate (member(size(scene%joints)), scene%bodies(0))
      do c = 1, count
         member = .false.
         do b = 1, size(scene%bars)
            if (body(b) == c) member([scene%bars(b)%start, scene%bars(b)%finish]) = .true.
         end do
         if (.not. any(member)) cycle
         call add_body(pack([(j, j=1, size(member))], member), scene%bars(findloc(body, c, dim=1))%root)
         where (body == c) scene%bars%body = size(scene%bodies)
      end do
      ! a slide belongs with the body that guides it, as far as that is a bar
      do b = 1, size(scene%bars)
         if (scene%bars(b)%slide == 0) cycle
         do c = 1, size(scene%bars)
            if (scene%bars(c)%slide > 0 .or. scene%bars(c)%root /= scene%bars(b)%root) cycle
            if (any([scene%bars(c)%start, scene%bars(c)%finish] == scene%slides(scene%bars(b)%slide)%guide)) &
               scene%bars(b)%body = scene%bars(c)%body
         end do
      end do

   contains

      subroutine add_body(joints, root)
         integer, intent(in) :: joints(:), root
         type(body_t) :: new
         integer :: k

         new%joints = joints
         new%frame = root == root_frame .and. all(scene%joints(joints)%fixed)
         allocate (new%hull(0))
         do k = 1, scene%prescribed%n
            if (.not. all(scene%prescribed%known(joints, k))) cycle
            new%hull = convex_hull(joints, scene%prescribed%x(joints, k), scene%prescribed%y(joints, k))
            exit
         end do
         scene%bodies = [scene%bodies, new]
      end subroutine add_body
   end subroutine make_bodies

   ! ---- view --------------------------------------------------------------------------------------------------------

   !> All that is prescribed, and of the sweep what does not make it much smaller.
   subroutine choose_view(scene, longest)
      type(scene_t), intent(inout) :: scene
      real(wp), intent(in) :: longest          !! longest arc
      real(wp) :: low(2), high(2), widest_low(2), widest_high(2), room
      integer :: k, loop

      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      widest_low = -huge(1.0_wp)
      widest_high = huge(1.0_wp)
      do k = 1, scene%prescribed%n
         call take(pack(scene%prescribed%x(:, k), scene%prescribed%known(:, k)), &
                   pack(scene%prescribed%y(:, k), scene%prescribed%known(:, k)))
         do loop = 1, scene%loops
            if (scene%prescribed%broken(loop, k)) &
               call take(scene%prescribed%tip(1::2, loop, k), scene%prescribed%tip(2::2, loop, k))
         end do
      end do
      if (scene%motion == motion_point .and. scene%desired) call take(scene%prescribed%wanted, scene%prescribed%wanted_y)
      if (scene%motion == motion_distance) call take([0.0_wp], [0.0_wp])
      room = maxval(high - low)*enlarge
      widest_low = low - room
      widest_high = high + room
      do k = 1, scene%sweep%n
         call take(pack(scene%sweep%x(:, k), scene%sweep%known(:, k)), pack(scene%sweep%y(:, k), scene%sweep%known(:, k)))
      end do
      if (maxval(high - low) <= 0.0_wp) then
         low = low - max(longest, 1.0_wp)
         high = high + max(longest, 1.0_wp)
      end if
      ! a straight mechanism is given some height
      room = flattest*maxval(high - low)
      where (high - low < room)
         low = low - room
         high = high + room
      end where
      scene%low = low
      scene%high = high

   contains

      subroutine take(x, y)
         real(wp), intent(in) :: x(:), y(:)

         if (size(x) == 0) return
         low = min(low, max([minval(x), minval(y)], widest_low))
         high = max(high, min([maxval(x), maxval(y)], widest_high))
      end subroutine take
   end subroutine choose_view

   !> How far the rail of each slide reaches: from its guide over all places of its block that can be seen.
   subroutine find_rails(scene)
      type(scene_t), intent(inout) :: scene
      real(wp) :: farthest
      integer :: k

      farthest = maxval(scene%high - scene%low)
      do k = 1, size(scene%slides)
         associate (slide => scene%slides(k))
            call reach(scene%prescribed, huge(1.0_wp))
            call reach(scene%sweep, farthest)
         end associate
      end do

   contains

      subroutine reach(row, limit)
         type(row_t), intent(in) :: row
         real(wp), intent(in) :: limit
         real(wp) :: along
         integer :: i

         associate (slide => scene%slides(k))
            do i = 1, row%n
               if (.not. (row%known(slide%guide, i) .and. row%known(slide%block, i))) cycle
               along = slide%sense*((row%x(slide%block, i) - row%x(slide%guide, i))*row%ux(k, i) + &
                                    (row%y(slide%block, i) - row%y(slide%guide, i))*row%uy(k, i))
               slide%low = min(slide%low, max(along, -limit))
               slide%high = max(slide%high, min(along, limit))
            end do
         end associate
      end subroutine reach
   end subroutine find_rails
end module psalm_scene
