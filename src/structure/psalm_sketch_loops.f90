!> Loops for a sketch: one for each dyad, several rings for each larger group.
!>
!> Dyads are traced as the arrays ILINK, ILOOP, ARCL, GAMA describe them. What these cannot describe, as a slide passed against its
!> sense, is traced as a larger group is. Source: Oldham (1977), 15.1, the choice of minimal loops.
module psalm_sketch_loops
   use psalm_closure, only: closure_t, state_t, row_gear, row_pin, row_line
   use psalm_kinds, only: wp
   use psalm_group_trace, only: trace_driven, trace_group, trace_input_alone
   use psalm_loop_trace, only: traced_dyad_t, close_loop, frame_axis
   use psalm_sketch, only: frame_link, drive_slides, drive_turns
   use psalm_sketch_paths, only: tracing_t, know
   use psalm_traced_loops, only: loops_t, traced_determined, traced_pair_t
   implicit none (type, external)
   private
   public :: make_loops

   integer, parameter :: most_passes = 1000      !! ways by slides that are remembered

contains

   !> Choose the loops. `state` is the sketch as assembled.
   subroutine make_loops(closure, state, loops, as_groups)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(loops_t), intent(out) :: loops
      logical, intent(in), optional :: as_groups   !! trace dyads as larger groups, too: every joint and slide is in an arc's end
      type(tracing_t) :: tracing
      type(traced_dyad_t) :: dyad
      integer, allocatable :: order(:)
      integer :: k, g, crank, capacity
      logical :: valid
      logical, allocatable :: on_frame(:)           !! by drive
      logical, allocatable :: needs(:, :)           !! shape (links, links): the links that a known link depends on, and itself

      loops%why = ''
      associate (sketch => closure%sketch, groups => closure%order%groups)
         on_frame = sketch%drives%base == frame_link .and. (sketch%drives%kind == drive_turns .or. &
                                                            sketch%drives%kind == drive_slides)
         loops%floating = .not. on_frame(1)
         loops%sliding = sketch%drives(1)%kind /= drive_turns
         capacity = size(sketch%joint_name) + 2*(size(sketch%links) + size(sketch%slides)) + 3
         allocate (tracing%on(capacity, size(sketch%links)), source=.false.)
         allocate (tracing%known(size(sketch%links)), tracing%placed(size(sketch%links)), source=.false.)
         allocate (tracing%pass(4, most_passes), source=0)
         allocate (loops%axis(size(sketch%links)), loops%joint_loop(size(sketch%joint_name)), source=0)
         allocate (loops%point(capacity), source=(0.0_wp, 0.0_wp))
         allocate (loops%line_point(2, size(sketch%slides)), source=0)
         allocate (loops%arcs(0), loops%rings(0), loops%pairs(0), loops%gears(0))
         allocate (loops%drive_of(size(sketch%links)), source=0)
         do g = 1, size(sketch%drives)
            if (on_frame(g) .and. sketch%drives(g)%kind == drive_turns) loops%drive_of(sketch%drives(g)%link) = g
         end do
         allocate (loops%seconds(size(sketch%drives) - 1))
         do g = 2, size(sketch%drives)
            associate (drive => sketch%drives(g))
               associate (second => loops%seconds(g - 1))
                  second%slides = drive%kind /= drive_turns
                  second%geared = drive%geared
                  second%ratio = drive%ratio
                  second%phase = drive%phase
                  if (on_frame(g)) second%pair = traced_pair_t(0, [frame_link, drive%link], drive%joint, drive%slide)
               end associate
            end associate
         end do
         tracing%points = size(sketch%joint_name)
         loops%point(:tracing%points) = state%joint(:, 0)
         crank = merge(frame_link, sketch%drives(1)%link, loops%floating)
         call know(sketch, frame_link, tracing)
         do g = 1, size(sketch%drives)
            if (on_frame(g)) call know(sketch, sketch%drives(g)%link, tracing)
         end do
         loops%start = sketch%drives(1)%joint
         loops%axis(frame_link) = frame_axis
         do g = 1, size(sketch%drives)
            if (on_frame(g) .and. sketch%drives(g)%kind == drive_slides) loops%axis(sketch%drives(g)%link) = frame_axis
         end do
         call groups_in_order(closure, crank, on_frame, order)
         needs = spread(tracing%placed, 2, size(tracing%placed))
         do k = 1, size(order)
            tracing%known = tracing%placed .and. needed_by(order(k))
            call understand(closure, order(k), tracing, dyad, valid)
            ! what drives there are besides an input link is laid out by the rings of a larger group
            if (k == 1 .and. (loops%floating .or. any(on_frame(2:) .and. sketch%drives(2:)%kind == drive_slides))) valid = .false.
            if (present(as_groups)) valid = valid .and. .not. as_groups
            ! with both ends on one link it moves with that link: loops of dyads have arcs of two
            if (valid) valid = dyad%known(1) /= dyad%known(2)
            if (valid) call close_loop(closure, state, dyad, tracing, loops, valid)
            if (.not. valid) then
               call trace_group(closure, state, order(k), tracing, loops, loops%why)
               if (len(loops%why) > 0) return
            else
               call know(sketch, dyad%links(1), tracing)
               call know(sketch, dyad%links(2), tracing)
               if (dyad%inner_joint > 0) loops%joint_loop(dyad%inner_joint) = k
            end if
            associate (links => groups(order(k))%links)
               needs(:, links) = spread(tracing%known, 2, size(links))
            end associate
         end do
         tracing%known = tracing%placed
         if (size(order) == 0) call trace_input_alone(closure, state, tracing, loops, loops%why)
         loops%found = len(loops%why) == 0
         if (loops%found) then
            do g = 2, size(sketch%drives)
               if (on_frame(g) .and. loops%seconds(g - 1)%arc == 0) call trace_driven(closure, g, tracing, loops, loops%why)
               if (len(loops%why) > 0) then
                  loops%found = .false.
                  return
               end if
            end do
            loops%loops = maxval(loops%arcs%loop)
            call hang_on_own_axis(loops)
         end if
         loops%on = tracing%on
      end associate

   contains

      !> By link: a group depends on it.
      pure function needed_by(group)
         integer, intent(in) :: group
         logical :: needed_by(size(needs, 1))
         integer, allocatable :: links(:)
         integer :: r, i

         needed_by = .false.
         do r = 1, size(closure%groups(group)%rows)
            associate (row => closure%groups(group)%rows(r))
               links = row%links
               if (row%kind == row_gear) links = [closure%sketch%gears(row%which)%wheels, closure%sketch%gears(row%which)%carrier]
               do i = 1, size(links)
                  if (links(i) > 0) needed_by = needed_by .or. needs(:, links(i))
               end do
            end associate
         end do
      end function needed_by
   end subroutine make_loops

   !> A link that a drive moves along the frame has the frame's directions until a ring passes that slide: its arcs before then hang
   !> on the arc of the slide as well, and all are of one body.
   subroutine hang_on_own_axis(loops)
      type(loops_t), intent(inout) :: loops
      integer :: k

      do k = 1, size(loops%arcs)
         associate (arc => loops%arcs(k), axis => loops%axis(loops%arcs(k)%link))
            if (arc%kind /= traced_determined .or. arc%same .or. arc%against .or. arc%link == frame_link) cycle
            if (loops%arcs(arc%reference)%link == arc%link .or. loops%arcs(axis)%link /= arc%link) cycle
            arc%reference = axis
         end associate
      end do
   end subroutine hang_on_own_axis

   !> The groups, the first being one that hangs on the driven link and on no other group, if there is one.
   subroutine groups_in_order(closure, crank, on_frame, order)
      type(closure_t), intent(in) :: closure
      integer, intent(in) :: crank                  !! the frame, if none is driven first
      logical, intent(in) :: on_frame(:)            !! by drive: it moves a link on the frame
      integer, allocatable, intent(out) :: order(:)
      integer :: g, k

      allocate (order(0))
      do g = 1, size(closure%groups)
         associate (links => closure%groups(g)%links)
            if (size(links) == 0) cycle
            if (size(links) == 1 .and. any(on_frame .and. closure%sketch%drives%link == links(1))) cycle
            order = [order, g]
         end associate
      end do
      do k = 1, size(order)
         if (.not. touches(order(k)) .or. hangs_on_others(order(k))) cycle
         order = [order(k), order(:k - 1), order(k + 1:)]
         return
      end do

   contains

      logical function touches(group)
         integer, intent(in) :: group
         integer :: r

         touches = .false.
         do r = 1, size(closure%groups(group)%rows)
            associate (row => closure%groups(group)%rows(r))
               touches = touches .or. (any(row%links == crank) .and. any(row%kind == [row_pin, row_line]))
            end associate
         end do
      end function touches

      !> True if other groups must be solved before.
      logical function hangs_on_others(group)
         integer, intent(in) :: group
         logical :: known(size(closure%sketch%links))
         integer :: d, r

         known = .false.
         known(frame_link) = .true.
         do d = 1, size(on_frame)
            if (on_frame(d)) known(closure%sketch%drives(d)%link) = .true.
         end do
         known(closure%groups(group)%links) = .true.
         hangs_on_others = .false.
         do r = 1, size(closure%groups(group)%rows)
            hangs_on_others = hangs_on_others .or. .not. all(known(closure%groups(group)%rows(r)%links))
         end do
      end function hangs_on_others
   end subroutine groups_in_order

   !> The pairs of a dyad. `valid` is false where a group of two links is no dyad of one inner and two outer pairs.
   subroutine understand(closure, group, tracing, dyad, valid)
      type(closure_t), intent(in) :: closure
      integer, intent(in) :: group
      type(tracing_t), intent(in) :: tracing
      type(traced_dyad_t), intent(out) :: dyad
      logical, intent(out) :: valid
      integer :: r, side, other, pairs

      valid = size(closure%groups(group)%links) == 2
      if (valid) valid = all(closure%cylinder(closure%groups(group)%links) == 0)
      if (.not. valid) return
      dyad%links = closure%groups(group)%links
      pairs = 0
      do r = 1, size(closure%groups(group)%rows)
         associate (row => closure%groups(group)%rows(r))
            if (row%kind /= row_pin .and. row%kind /= row_line) cycle
            pairs = pairs + 1
            if (all([(any(dyad%links == row%links(side)), side=1, 2)])) then
               if (row%kind == row_pin) dyad%inner_joint = row%which
               if (row%kind == row_line) dyad%inner_slide = row%which
               cycle
            end if
            other = merge(1, 2, any(dyad%links == row%links(2)))
            side = findloc(dyad%links, row%links(3 - other), dim=1)
            if (dyad%known(side) > 0) valid = .false.
            dyad%known(side) = row%links(other)
            if (row%kind == row_pin) dyad%joint(side) = row%which
            if (row%kind == row_line) dyad%slide(side) = row%which
         end associate
      end do
      valid = valid .and. pairs == 3 .and. all(dyad%known > 0) .and. (dyad%inner_joint > 0 .neqv. dyad%inner_slide > 0)
      if (valid) valid = all(tracing%known(dyad%known))
   end subroutine understand
end module psalm_sketch_loops
