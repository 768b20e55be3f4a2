!> A linkage ready to move: the solution plan with its numbers put in, and the storage one block of positions needs.
!>
!> `prepare` is called once for a topology, `bind` for each set of dimensions, `solve` for each block of positions. After
!> `solve` the unit vectors of all roots, the points, the sliding lengths and the closure measure of each dyad lie in the object.
!> Nothing is allocated after `prepare`. Knows nothing of desired values or of searches.
module psalm_linkage
   use psalm_angles, only: unit_vector
   use psalm_assur, only: mark_unknowns, bind_dyad, solve_dyad, is_signed, makes_tip
   use psalm_dyad, only: dyad_t, tip_t
   use psalm_group_rings, only: higher_t, known_turn_t
   use psalm_higher_group, only: find_turns, keep_turns
   use psalm_kinds, only: wp, i8, degrees_per_radian, radians_per_degree, right_angle
   use psalm_plan, only: plan_t, step_point, step_dyad, root_crank
   use psalm_rows, only: rows_t, make_rows
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t, linkage_group_t, arc_slide
   implicit none (type, external)
   private
   public :: linkage_t, bound_step_t, block_length, padded, solve_point, put_seconds, put_driven_lengths, all_between
   public :: largest_direction, largest_slide

   integer, parameter :: as_wide = selected_int_kind(int(log10(2.0)*real(storage_size(1.0_wp) - 1))) !! an integer as wide as reals
   integer, parameter :: block_length = 256 !! positions solved together: long loops, rows that stay near in the cache
   integer, parameter :: lane = 4           !! positions are padded to a multiple of this: no remainder loops

   integer, parameter :: plain_exponent = maxexponent(1.0_wp)/8 !! lengths beyond 2**this are scaled before they are squared
   real(wp), parameter :: longest = 2.0_wp**(plain_exponent - 1) !! arcs below it, not all below its inverse, stay as they are
   integer, parameter :: mixed = 2          !! both signs
   ! what an open dyad may leave: components of a direction, and length of a slide, whose fourth power is finite
   real(wp), parameter :: largest_direction = 2.0_wp**(maxexponent(1.0_wp)/16)
   real(wp), parameter :: largest_slide = 2.0_wp**plain_exponent*largest_direction

   !> One step of the plan with its numbers: a point at the other end of an arc, or a dyad. Components `..._x`, `..._y` and
   !> `slide_row` are rows of the store.
   type :: bound_step_t
      integer :: kind = 0, loop = 0
      integer :: from_x = 0, from_y = 0, to_x = 0, to_y = 0 !! rows of points; of a dyad: S and E
      integer :: arc = 0                         !! point: the arc
      integer :: root_x = 0, root_y = 0          !! point: rows of the arc's root
      integer :: slide_row = 0                   !! point: row of its varying length, 0: fixed length
      logical :: fixed = .false.                 !! point: it belongs to the frame
      integer :: maker = 0                       !! point: step of the dyad that makes it with the direction it finds, 0: none
      real(wp) :: sign = 1.0_wp                  !! point: +1 along the arc, -1 against it
      real(wp) :: x = 0.0_wp, y = 0.0_wp         !! point: the arc in the axes of its root, sense included
      type(dyad_t) :: dyad
      integer, allocatable :: needs(:)           !! larger group: the steps before it that it depends on, ascending
   end type bound_step_t

   !> A drive after the first.
   type :: second_drive_t
      integer :: arc = 0                         !! the arc it moves
      logical :: slides = .false., geared = .false.
      real(wp) :: ratio = 1.0_wp, phase = 0.0_wp !! geared: to the first, both counted from the drawing
      integer :: root_x = 0, root_y = 0          !! rows of the direction that it turns; 0: that of a tie
      integer :: slide = 0                       !! row of the length that it sets
      integer :: turn = 0                        !! row of its turn since the anchor, radians; 0: no tie needs it
      real(wp) :: x = 1.0_wp, y = 0.0_wp         !! direction without an increment
      real(wp) :: reference = 0.0_wp             !! turn, degrees, or length without an increment: of the turn from the drawing
      real(wp) :: drawn = 0.0_wp                 !! increment at the anchor, mostly the drawing
      real(wp) :: zero = 0.0_wp                  !! geared: turn from the drawing to the anchor, degrees
   end type second_drive_t

   type :: linkage_t
      integer :: capacity = 0                        !! positions of a block, a multiple of `lane`
      type(bound_step_t), allocatable :: steps(:)
      integer, allocatable :: step_of_loop(:)    !! by loop: its dyad step, 0 if it is not in the plan
      real(wp) :: scale = 1.0_wp                 !! internal length = user's length * scale (a power of two, mostly 1)
      ! arcs, by sequential number
      real(wp), allocatable :: angle(:)          !! degrees from the root
      real(wp), allocatable :: x(:), y(:)        !! its cosine and sine
      real(wp), allocatable :: length(:)         !! scaled length
      logical, allocatable :: two_slides(:)      !! by loop: its closure measure changes its sign where two slides are parallel
      integer, allocatable :: side(:)            !! by loop: sign of the measure of two slides wherever `note_sides` looked since
                                                 !! the last `bind`; 0: nowhere, or `mixed`
      type(rows_t) :: store                      !! one block of positions: position i of a row is store%v(i, row)
      integer, allocatable :: root_x(:), root_y(:)   !! by root: rows of its unit vector
      integer, allocatable :: point_x(:), point_y(:) !! by point, 0 the input pivot: rows of its scaled coordinates
      integer, allocatable :: slide(:)               !! by varying length: row of the scaled length
      integer, allocatable :: measure(:)             !! by loop: row of its dyad's closure measure, scaled
      integer :: out(2) = 0, direction(2) = 0, miss = 0 !! rows for the output: lengths, unit vector, deviation
      type(rows_t) :: between                        !! one position between those of the block; not allocated: no larger group
      real(wp) :: drawn = 0.0_wp                     !! input increment from which larger groups are followed: mostly the drawing's
      real(wp), allocatable :: from(:)               !! shape (drives): increments at which larger groups stood by `follow_from`;
                                                     !! not allocated: they are followed from the drawing
      ! input
      logical :: sliding_input = .false.
      real(wp) :: largest_input = 0.0_wp         !! sliding input: largest increment
      integer :: input_slot = 0                  !! varying length of the actuator
      real(wp) :: crank_x = 1.0_wp, crank_y = 0.0_wp !! unit vector at the reference position
      real(wp) :: crank_angle = 0.0_wp           !! its angle, degrees
      real(wp) :: reference_length = 0.0_wp      !! actuator's length at the reference position, user's unit
      integer :: first_turn = 0                  !! row of the first input's turn since the drawing, radians; 0: no tie needs it
      logical :: tied = .false.                  !! a group has ties: turns count, not only directions
      logical :: one_way = .false.               !! larger groups are followed the way the input goes, not the other way round
      type(second_drive_t), allocatable :: seconds(:)
      real(wp), allocatable :: drive_rate(:, :)  !! shape (3, drives): derivatives of inputs by the first, radians or user's lengths
      integer, allocatable :: input_row(:)       !! rows that move with the first input,
      real(wp), allocatable :: input_rate(:)     !! by how much a unit of it: radian, or user's length
      integer, allocatable :: driven_arc(:), driven_row(:) !! arcs whose length is an input, and its row: ARCL counts there, too
      real(wp) :: cosine_lowest = 0.0_wp         !! cosine of the smallest transmission angle allowed
      real(wp) :: sine_lowest = 0.0_wp           !! sine of the smallest angle between two slides allowed
      real(wp) :: toggle = 0.0_wp                !! length to spare of a link or guide with a slide, user's unit
   contains
      procedure :: prepare
      procedure :: bind
      procedure :: solve
      procedure :: closes
      procedure :: accepts
      procedure :: all_accepted
      procedure :: note_sides
      procedure :: stays_on_side
      procedure :: rows_of_drive
      procedure :: arc_at
      procedure :: follow_from
      procedure :: is_plain
   end type linkage_t

   interface
      !> A larger group at the positions of a block, each from the one before; the first from the drawing.
      pure module subroutine follow_group(self, k, n, path, more, closed)
         implicit none (type, external)
         class(linkage_t), intent(inout) :: self
         integer, intent(in) :: k                !! its step
         integer, intent(in) :: n                !! positions
         real(wp), intent(in) :: path(n)         !! increments of the first input
         real(wp), intent(in), optional :: more(:, :, :) !! of the others, as `solve` has them
         logical, intent(inout) :: closed        !! every group before closes at every position; afterwards this one, too
      end subroutine follow_group
   end interface

contains

   !> Allocate storage and resolve every index of the plan.
   subroutine prepare(self, mechanism, plan, tangle, slide_angle, toggle, delt)
      class(linkage_t), intent(out) :: self
      type(mechanism_t), intent(in) :: mechanism
      type(plan_t), intent(in) :: plan
      real(wp), intent(in) :: tangle    !! allowed deviation of a transmission angle from 90 degrees; 90: closure only
      real(wp), intent(in) :: slide_angle   !! the same for the angle between two slides
      real(wp), intent(in) :: toggle    !! length to spare of a link or guide with a slide; 0: closure only
      real(wp), intent(in) :: delt(:)   !! input increments there will be
      real(wp) :: unused
      integer :: k, n, loop, turn_row

      self%capacity = min(block_length, padded(size(delt)))
      n = size(mechanism%arcs)
      allocate (self%steps(size(plan%steps)))
      allocate (self%step_of_loop(mechanism%nloop), source=0)
      allocate (self%angle(n), self%y(n), source=0.0_wp)
      allocate (self%x(n), source=1.0_wp)
      allocate (self%length(n), source=0.0_wp)
      allocate (self%side(mechanism%nloop), source=0)
      self%two_slides = [(is_signed(mechanism%groups(k)%kind), k=1, mechanism%nloop)]
      call lay_out(self, plan%nroots, plan%npoints, plan%nlengths, mechanism%nloop, most_turns(), turn_row)
      call prepare_seconds()
      self%sliding_input = mechanism%sliding_input
      if (self%sliding_input) self%largest_input = maxval(abs(delt))
      call unit_vector(right_angle - tangle, self%cosine_lowest, unused)
      call unit_vector(right_angle - slide_angle, unused, self%sine_lowest)
      self%toggle = toggle
      if (mechanism%sliding_input) self%input_slot = plan%drive_slot(1)
      call prepare_input_rows()
      do k = 1, size(plan%steps)
         associate (step => plan%steps(k), bound => self%steps(k))
            bound%kind = step%kind
            bound%loop = step%loop
            bound%from_x = self%point_x(step%from)
            bound%from_y = self%point_y(step%from)
            bound%to_x = self%point_x(step%to)
            bound%to_y = self%point_y(step%to)
            if (allocated(step%rings)) then
               self%step_of_loop(step%loop) = k
               call prepare_higher(bound%dyad)
            else if (step%kind == step_point) then
               bound%arc = step%arc
               bound%root_x = self%root_x(plan%root(step%arc))
               bound%root_y = self%root_y(plan%root(step%arc))
               bound%slide_row = row_of_slide(plan%length_slot(step%arc))
               bound%fixed = step%fixed
               bound%sign = real(step%sense, wp)
            else
               self%step_of_loop(step%loop) = k
               call prepare_dyad(bound%dyad)
            end if
         end associate
      end do

      call assign_tips(self)
      call find_needs(self)
      if (any([(allocated(self%steps(k)%dyad%higher), k=1, size(self%steps))])) then
         call make_rows(lane, size(self%store%v, 2), self%between)
         self%between%v(1, self%root_x) = 1.0_wp
      end if

   contains

      !> Rows for turns that ties may need: of every unknown and every member of a tie, of every drive.
      integer function most_turns()
         integer :: group

         most_turns = 0
         do group = 1, mechanism%nloop
            if (.not. allocated(mechanism%groups(group)%ties)) cycle
            most_turns = most_turns + size(mechanism%groups(group)%members) + 3*size(mechanism%groups(group)%ties)
         end do
         if (most_turns > 0) most_turns = most_turns + size(mechanism%actuators)
      end function most_turns

      integer function new_turn_row()
         turn_row = turn_row + 1
         new_turn_row = turn_row
      end function new_turn_row

      subroutine prepare_seconds()
         integer :: d

         self%drive_rate = reshape([(mechanism%actuators(d)%by_first, d=1, size(mechanism%actuators))], &
                                   [3, size(mechanism%actuators)])
         allocate (self%seconds(size(mechanism%actuators) - 1))
         do d = 1, size(self%seconds)
            associate (own => self%seconds(d), actuator => mechanism%actuators(d + 1))
               own%arc = actuator%arc
               own%slides = actuator%slides
               own%geared = actuator%geared
               own%ratio = actuator%ratio
               own%phase = actuator%phase
               if (own%slides) then
                  own%slide = row_of_slide(plan%drive_slot(d + 1))
               else if (plan%drive_root(d + 1) > 0) then
                  own%root_x = self%root_x(plan%drive_root(d + 1))
                  own%root_y = self%root_y(plan%drive_root(d + 1))
               end if
               if (most_turns() > 0 .and. .not. own%slides) own%turn = new_turn_row()
            end associate
         end do
         if (most_turns() > 0 .and. .not. mechanism%sliding_input) self%first_turn = new_turn_row()
      end subroutine prepare_seconds

      !> What moves with the first input: its own row, and those of drives geared to it.
      subroutine prepare_input_rows()
         integer :: d

         allocate (self%input_row(0), self%input_rate(0), self%driven_arc(0), self%driven_row(0))
         do d = 1, size(mechanism%actuators)
            associate (actuator => mechanism%actuators(d))
               if (.not. actuator%slides .or. actuator%arc == 0 .or. (d == 1 .and. .not. mechanism%floating_input)) cycle
               self%driven_arc = [self%driven_arc, actuator%arc]
               self%driven_row = [self%driven_row, row_of_slide(plan%drive_slot(d))]
            end associate
         end do
         if (.not. self%sliding_input) then
            call add(self%root_x(root_crank), 1.0_wp)
         else if (self%input_slot > 0) then
            call add(self%slide(self%input_slot), 0.0_wp)
         end if
         do d = 1, size(self%seconds)
            associate (own => self%seconds(d))
               if (.not. own%geared) cycle
               if (own%slides) then
                  call add(own%slide, 0.0_wp)
               else if (own%root_x > 0) then
                  call add(own%root_x, own%ratio*merge(radians_per_degree, 1.0_wp, self%sliding_input))
               end if
               if (own%turn > 0) call add(own%turn, own%ratio*merge(radians_per_degree, 1.0_wp, self%sliding_input))
            end associate
         end do
         if (self%first_turn > 0) call add(self%first_turn, 1.0_wp)
      end subroutine prepare_input_rows

      subroutine add(row, rate)
         integer, intent(in) :: row
         real(wp), intent(in) :: rate

         if (row == 0) return
         self%input_row = [self%input_row, row]
         self%input_rate = [self%input_rate, rate]
      end subroutine add

      subroutine prepare_higher(dyad)
         type(dyad_t), intent(inout) :: dyad
         type(higher_t) :: higher
         integer :: r, j, terms

         loop = plan%steps(k)%loop
         dyad%kind = mechanism%groups(loop)%kind
         dyad%measure = self%measure(loop)
         associate (rings => plan%steps(k)%rings)
            higher%arc = mechanism%groups(loop)%members
            higher%unknowns = size(higher%arc)
            higher%rings = size(rings)
            allocate (higher%row(higher%unknowns), higher%row_of_sine(higher%unknowns), source=0)
            allocate (higher%row_of_turn(higher%unknowns), source=0)
            allocate (higher%drawn(3, higher%unknowns), higher%drawn_angle(higher%unknowns), source=0.0_wp)
            do j = 1, higher%unknowns
               if (mechanism%arcs(higher%arc(j))%kind == arc_slide) then
                  higher%row(j) = row_of_slide(plan%length_slot(higher%arc(j)))
               else
                  higher%row(j) = self%root_x(plan%root(higher%arc(j)))
                  higher%row_of_sine(j) = self%root_y(plan%root(higher%arc(j)))
               end if
            end do
            allocate (higher%ends(4, higher%rings), higher%terms(sum(rings%last - rings%first + 1)))
            terms = 0
            do r = 1, higher%rings
               higher%ends(:, r) = [self%point_x(rings(r)%from), self%point_y(rings(r)%from), self%point_x(rings(r)%to), &
                                    self%point_y(rings(r)%to)]
               do n = rings(r)%first, rings(r)%last
                  terms = terms + 1
                  associate (term => higher%terms(terms))
                     term%ring = r
                     term%arc = n
                     term%root_x = self%root_x(plan%root(n))
                     term%root_y = self%root_y(plan%root(n))
                     term%slide = row_of_slide(plan%length_slot(n))
                     term%turned = findloc(higher%row == term%root_x .and. higher%row_of_sine > 0, .true., dim=1)
                     if (term%slide > 0) term%stretched = findloc(higher%row, term%slide, dim=1)
                  end associate
               end do
            end do
         end associate
         call prepare_ties(mechanism%groups(loop), higher)
         higher%equations = 2*higher%rings + size(higher%ties)
         if (higher%rings == 0) call find_turns(higher)
         allocate (dyad%higher, source=higher)
      end subroutine prepare_higher

      subroutine prepare_ties(group, higher)
         type(linkage_group_t), intent(in) :: group
         type(higher_t), intent(inout) :: higher
         integer :: i, j, known

         allocate (higher%known(0))
         if (.not. allocated(group%ties)) then
            allocate (higher%ties(0))
            return
         end if
         self%tied = .true.
         allocate (higher%ties(size(group%ties)))
         do i = 1, size(group%ties)
            associate (tie => higher%ties(i), of => group%ties(i))
               tie%factors = of%factors
               if (of%drive == 1) then
                  tie%drive = self%first_turn
               else if (of%drive > 1) then
                  tie%drive = self%seconds(of%drive - 1)%turn
               end if
               tie%drive_root = tie%drive
               do j = 1, size(of%arcs)
                  if (of%arcs(j) == 0) cycle
                  tie%roots(j) = self%root_x(plan%root(of%arcs(j)))
                  tie%unknown(j) = findloc(higher%row == tie%roots(j) .and. higher%row_of_sine > 0, .true., dim=1)
                  if (tie%unknown(j) > 0) then
                     associate (row => higher%row_of_turn(tie%unknown(j)))
                        if (row == 0) row = new_turn_row()
                        tie%rows(j) = row
                     end associate
                     cycle
                  end if
                  known = findloc(higher%known%root_x, tie%roots(j), dim=1)
                  if (known == 0) then
                     higher%known = [higher%known, known_turn_t(new_turn_row(), tie%roots(j), self%root_y(plan%root(of%arcs(j))), &
                                                                of%arcs(j), of%drawn(j))]
                     known = size(higher%known)
                  end if
                  tie%rows(j) = higher%known(known)%row
               end do
            end associate
         end do
      end subroutine prepare_ties

      subroutine prepare_dyad(dyad)
         type(dyad_t), intent(inout) :: dyad

         loop = plan%steps(k)%loop
         dyad%kind = mechanism%groups(loop)%kind
         dyad%arc_p = mechanism%groups(loop)%members(1)
         dyad%arc_q = mechanism%groups(loop)%members(2)
         dyad%s_x = self%point_x(plan%steps(k)%from)
         dyad%s_y = self%point_y(plan%steps(k)%from)
         dyad%e_x = self%point_x(plan%steps(k)%to)
         dyad%e_y = self%point_y(plan%steps(k)%to)
         dyad%p_x = self%root_x(plan%root(dyad%arc_p))
         dyad%p_y = self%root_y(plan%root(dyad%arc_p))
         dyad%q_x = self%root_x(plan%root(dyad%arc_q))
         dyad%q_y = self%root_y(plan%root(dyad%arc_q))
         dyad%wants_p = plan%used(plan%root(dyad%arc_p))
         dyad%wants_q = plan%used(plan%root(dyad%arc_q))
         dyad%slide_p = row_of_slide(plan%length_slot(dyad%arc_p))
         dyad%slide_q = row_of_slide(plan%length_slot(dyad%arc_q))
         dyad%measure = self%measure(loop)
         dyad%sign = real(mechanism%groups(loop)%sign, wp)
         call mark_unknowns(dyad)
      end subroutine prepare_dyad

      pure integer function row_of_slide(slot)
         integer, intent(in) :: slot

         row_of_slide = 0
         if (slot > 0) row_of_slide = self%slide(slot)
      end function row_of_slide
   end subroutine prepare

   !> Let each dyad of links that finds one direction make the first point that hangs on it and starts from a point made before.
   pure subroutine assign_tips(self)
      type(linkage_t), intent(inout) :: self
      integer :: k, j, root

      do k = 1, size(self%steps)
         if (self%steps(k)%kind /= step_dyad) cycle
         associate (dyad => self%steps(k)%dyad)
            if (.not. makes_tip(dyad)) cycle
            root = merge(dyad%q_x, dyad%p_x, dyad%wants_q)
            do j = k + 1, size(self%steps)
               associate (step => self%steps(j))
                  if (step%kind /= step_point) cycle
                  if (step%fixed .or. step%root_x /= root .or. step%slide_row > 0 .or. made_after(step%from_x, k)) cycle
                  step%maker = k
                  dyad%tip = tip_t(step%from_x, step%from_y, step%to_x, step%to_y)
                  exit
               end associate
            end do
         end associate
      end do

   contains

      !> True if the point of a row is made by a step after `k`, and moves.
      pure logical function made_after(row, k)
         integer, intent(in) :: row, k
         integer :: i

         made_after = .false.
         do i = k + 1, size(self%steps)
            if (self%steps(i)%kind == step_point .and. .not. self%steps(i)%fixed .and. self%steps(i)%to_x == row) &
               made_after = .true.
         end do
      end function made_after
   end subroutine assign_tips

   !> Which steps each larger group depends on: through the rows that they write and that the next ones read. What a group does not
   !> depend on must not decide whether it closes, wherever it stands in the plan.
   subroutine find_needs(self)
      type(linkage_t), intent(inout) :: self
      integer :: writer(0:size(self%store%v, 2))    !! by row: the step that writes it, 0: an input or none
      logical :: needed(size(self%steps), size(self%steps)) !! (:, k): the steps that step k depends on
      integer :: k, r, j

      writer = 0
      needed = .false.
      do k = 1, size(self%steps)
         associate (step => self%steps(k), dyad => self%steps(k)%dyad)
            if (step%kind == step_point) then
               call reads([step%from_x, step%root_x, step%slide_row])
               if (step%maker > 0) call depends_on(step%maker)
               writer(step%to_x) = k
            else if (allocated(dyad%higher)) then
               do r = 1, dyad%higher%rings
                  call reads(dyad%higher%ends([1, 3], r))
               end do
               call reads(dyad%higher%terms%root_x)
               call reads(dyad%higher%terms%slide)
               do r = 1, size(dyad%higher%ties)
                  call reads(dyad%higher%ties(r)%roots)
               end do
               writer(dyad%higher%row) = k
            else
               call reads([dyad%s_x, dyad%e_x, dyad%p_x, dyad%q_x, dyad%slide_p, dyad%slide_q])
               writer(dyad%unknown) = k
            end if
         end associate
         writer(0) = 0
         if (.not. allocated(self%steps(k)%dyad%higher)) cycle
         self%steps(k)%needs = pack([(j, j=1, k - 1)], needed(:k - 1, k))
      end do

   contains

      subroutine reads(rows)
         integer, intent(in) :: rows(:)
         integer :: i

         do i = 1, size(rows)
            if (writer(rows(i)) > 0 .and. writer(rows(i)) < k) call depends_on(writer(rows(i)))
         end do
      end subroutine reads

      subroutine depends_on(step)
         integer, intent(in) :: step

         needed(:, k) = needed(:, k) .or. needed(:, step)
         needed(step, k) = .true.
      end subroutine depends_on
   end subroutine find_needs

   !> Positions rounded up to a multiple of the lane.
   pure integer function padded(positions)
      integer, intent(in) :: positions

      padded = lane*((max(1, positions) + lane - 1)/lane)
   end function padded

   !> Allocate the store and give every row its place.
   subroutine lay_out(self, roots, points, lengths, loops, turns, next)
      type(linkage_t), intent(inout) :: self
      integer, intent(in) :: roots, points, lengths, loops, turns
      integer, intent(out) :: next         !! the last row given a place: rows for turns come after it
      integer :: k

      allocate (self%root_x(roots), self%root_y(roots), self%slide(lengths), self%measure(loops))
      allocate (self%point_x(0:points), self%point_y(0:points))
      call make_rows(self%capacity, 2*roots + 2*(points + 1) + lengths + loops + 5 + turns, self%store)
      next = 0
      do k = 1, roots
         self%root_x(k) = new_row()
         self%root_y(k) = new_row()
         self%store%v(:, self%root_x(k)) = 1.0_wp
      end do
      do k = 0, points
         self%point_x(k) = new_row()
         self%point_y(k) = new_row()
      end do
      do k = 1, lengths
         self%slide(k) = new_row()
      end do
      do k = 1, loops
         self%measure(k) = new_row()
      end do
      do k = 1, 2
         self%out(k) = new_row()
      end do
      do k = 1, 2
         self%direction(k) = new_row()
      end do
      self%miss = new_row()

   contains

      integer function new_row()
         next = next + 1
         new_row = next
      end function new_row
   end subroutine lay_out

   !> Put a set of dimensions in. Only angles that differ from the last ones cost a sine and a cosine.
   pure subroutine bind(self, mechanism, plan, dimensions)
      class(linkage_t), intent(inout) :: self
      type(mechanism_t), intent(in) :: mechanism
      type(plan_t), intent(in) :: plan
      type(dimensions_t), intent(in) :: dimensions
      integer :: k

      self%side = 0
      if (allocated(self%from)) deallocate (self%from)
      self%drawn = dimensions%anchor - dimensions%crnki
      call choose_scale(self, dimensions)
      call bind_angles(self, plan, dimensions)
      self%length = dimensions%arcl*self%scale
      if (mechanism%sliding_input) then
         self%reference_length = dimensions%crnki
         if (mechanism%floating_input) self%reference_length = dimensions%crnki + dimensions%arcl(mechanism%actuators(1)%arc)
      else
         if (dimensions%crnki /= self%crank_angle) call unit_vector(dimensions%crnki, self%crank_x, self%crank_y)
         self%crank_angle = dimensions%crnki
      end if
      call bind_seconds(self, dimensions)
      do k = 1, size(self%steps)
         if (self%steps(k)%kind == step_point) then
            call bind_point(self, self%steps(k))
         else if (allocated(self%steps(k)%dyad%higher)) then
            call bind_higher(self, dimensions, self%steps(k)%dyad)
         else
            call bind_lengths(self, self%steps(k)%dyad)
         end if
      end do
   end subroutine bind

   !> Drives after the first: where they stand without an increment, and in the drawing.
   pure subroutine bind_seconds(self, dimensions)
      type(linkage_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      real(wp) :: from_drawing
      integer :: d, k

      if (self%sliding_input .and. size(self%input_rate) > 0 .and. self%input_slot > 0) self%input_rate(1) = self%scale
      do d = 1, size(self%seconds)
         associate (own => self%seconds(d))
            own%reference = 0.0_wp
            own%drawn = 0.0_wp
            own%zero = 0.0_wp
            if (own%geared) then
               from_drawing = own%ratio*(dimensions%crnki - dimensions%drawn) + own%phase
               own%reference = from_drawing
               own%drawn = -from_drawing
               if (abs(dimensions%anchor - dimensions%drawn) > 0.0_wp) then
                  own%drawn = own%ratio*(dimensions%anchor - dimensions%crnki)
                  own%zero = from_drawing + own%drawn
               end if
            end if
            if (own%slides) then
               own%reference = own%reference + dimensions%arcl(own%arc)
               k = findloc(self%input_row, own%slide, dim=1)
               if (k > 0) self%input_rate(k) = own%ratio*self%scale*merge(1.0_wp, degrees_per_radian, self%sliding_input)
            else if (own%root_x > 0) then
               call unit_vector(dimensions%gama(own%arc) + own%reference, own%x, own%y)
            end if
         end associate
      end do
   end subroutine bind_seconds

   !> Lengths are squared: far from one they are scaled by a power of two, which changes no digit.
   pure subroutine choose_scale(self, dimensions)
      type(linkage_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      integer :: e

      self%scale = 1.0_wp
      if (all(dimensions%arcl < longest) .and. any(dimensions%arcl > 1.0_wp/longest) &
          .and. .not. (self%sliding_input .and. max(abs(dimensions%crnki), self%largest_input) >= longest)) return
      e = exponent(maxval(dimensions%arcl))
      if (self%sliding_input) e = max(e, exponent(dimensions%crnki), exponent(self%largest_input))
      ! the scale and its inverse are numbers for the least lengths, too
      if (abs(e) > plain_exponent) self%scale = scale(1.0_wp, -max(2 - maxexponent(1.0_wp), min(e, maxexponent(1.0_wp) - 2)))
   end subroutine choose_scale

   !> True if `choose_scale` scales no length of a linkage.
   elemental logical function is_plain(self, largest, crnki)
      class(linkage_t), intent(in) :: self
      real(wp), intent(in) :: largest            !! length of its longest arc
      real(wp), intent(in) :: crnki

      is_plain = largest < longest .and. largest > 1.0_wp/longest
      if (self%sliding_input) is_plain = is_plain .and. max(abs(crnki), self%largest_input) < longest
   end function is_plain

   pure subroutine bind_angles(self, plan, dimensions)
      type(linkage_t), intent(inout) :: self
      type(plan_t), intent(in) :: plan
      type(dimensions_t), intent(in) :: dimensions
      integer :: k, n, b
      real(wp) :: angle

      do k = 1, size(plan%order)
         n = plan%order(k)
         b = plan%base(n)
         if (plan%takes_gama(n)) then
            angle = dimensions%gama(n)
            if (b > 0) angle = angle + self%angle(b)
            if (angle == self%angle(n)) cycle
            self%angle(n) = angle
            call unit_vector(angle, self%x(n), self%y(n))
         else if (b > 0) then
            self%angle(n) = self%angle(b) + right_angle*real(plan%quarter(n), wp)
            select case (plan%quarter(n))
            case (1)
               self%x(n) = -self%y(b)
               self%y(n) = self%x(b)
            case (-1)
               self%x(n) = self%y(b)
               self%y(n) = -self%x(b)
            case default
               self%x(n) = self%x(b)
               self%y(n) = self%y(b)
            end select
         end if
      end do
   end subroutine bind_angles

   pure subroutine bind_point(self, step)
      type(linkage_t), intent(inout) :: self
      type(bound_step_t), intent(inout) :: step
      real(wp) :: x, y

      step%x = step%sign*self%x(step%arc)
      step%y = step%sign*self%y(step%arc)
      if (step%slide_row > 0) return
      step%x = step%x*self%length(step%arc)
      step%y = step%y*self%length(step%arc)
      if (step%maker > 0) then
         self%steps(step%maker)%dyad%tip%x = step%x
         self%steps(step%maker)%dyad%tip%y = step%y
      end if
      if (.not. step%fixed) return
      x = self%store%v(1, step%from_x) + step%x
      y = self%store%v(1, step%from_y) + step%y
      self%store%v(1:self%capacity, step%to_x) = x
      self%store%v(1:self%capacity, step%to_y) = y
      if (.not. allocated(self%between%v)) return
      self%between%v(1, step%to_x) = x
      self%between%v(1, step%to_y) = y
   end subroutine bind_point

   !> Arcs of a larger group, and where it stands in the drawing.
   pure subroutine bind_higher(self, dimensions, dyad)
      type(linkage_t), intent(in) :: self
      type(dimensions_t), intent(in) :: dimensions
      type(dyad_t), intent(inout) :: dyad
      integer :: j

      call bind_dyad(dyad, self%cosine_lowest, self%sine_lowest, self%toggle*self%scale)
      associate (higher => dyad%higher)
         higher%terms%x = self%x(higher%terms%arc)
         higher%terms%y = self%y(higher%terms%arc)
         higher%terms%length = merge(0.0_wp, self%length(higher%terms%arc), higher%terms%slide > 0)
         do j = 1, higher%unknowns
            if (higher%row_of_sine(j) > 0) then
               higher%drawn_angle(j) = dimensions%gama(higher%arc(j))
               call unit_vector(higher%drawn_angle(j), higher%drawn(1, j), higher%drawn(2, j))
            else
               higher%drawn(1, j) = self%length(higher%arc(j))
            end if
         end do
         higher%size = max(maxval(abs(higher%terms%length)), tiny(1.0_wp), &
                           maxval(abs(higher%drawn(1, :)), mask=higher%row_of_sine == 0))
         do j = 1, size(higher%known)
            associate (known => higher%known(j))
               call unit_vector(known%drawn_angle - self%angle(known%arc), known%drawn(1), known%drawn(2))
               higher%follows = .false.
            end associate
         end do
         higher%now = higher%drawn
         if (allocated(higher%from)) deallocate (higher%from)
         higher%before = higher%drawn
      end associate
   end subroutine bind_higher

   !> Lengths and fixed directions of a dyad, and the limits of its closure measure.
   pure subroutine bind_lengths(self, dyad)
      type(linkage_t), intent(in) :: self
      type(dyad_t), intent(inout) :: dyad

      dyad%p = self%length(dyad%arc_p)
      dyad%q = self%length(dyad%arc_q)
      dyad%px = self%x(dyad%arc_p)
      dyad%py = self%y(dyad%arc_p)
      dyad%qx = self%x(dyad%arc_q)
      dyad%qy = self%y(dyad%arc_q)
      call bind_dyad(dyad, self%cosine_lowest, self%sine_lowest, self%toggle*self%scale)
   end subroutine bind_lengths

   !> Positions of one block. After it, the store holds roots, points, slides and closure measures, finite numbers all of them.
   !>
   !> With `offending` the block ends at the first loop that is not accepted everywhere; what comes after it is not solved.
   pure subroutine solve(self, n, first, second, path, more, last_step, offending, turned)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: n                   !! positions, at most `room`
      real(wp), intent(in) :: first(n)           !! cosine of the input increment (sliding input: the increment, [length])
      real(wp), intent(in) :: second(n)          !! sine of the input increment (sliding input: not used)
      real(wp), intent(in) :: path(n)            !! the input increment, degrees or length: larger groups are followed along it
      real(wp), intent(in), optional :: more(:, :, :) !! shape (n, 3, drives after the first): increment, its cosine, its sine
      integer, intent(in), optional :: last_step !! solve the steps up to this one only; default all
      integer, intent(out), optional :: offending !! the first loop not accepted, 0: none
      logical, intent(in), optional :: turned(:, :) !! shape (n, loops): its dyad is in its other assembly
      integer :: k, last
      logical :: closed                          !! the groups found before close everywhere: what is accepted does

      if (present(offending)) offending = 0
      closed = .true.
      if (.not. self%sliding_input) then
         call turn_crank(n, first, second, self%crank_x, self%crank_y, &
                         self%store%v(1, self%root_x(root_crank)), self%store%v(1, self%root_y(root_crank)))
      else if (self%input_slot > 0) then
         associate (row => self%slide(self%input_slot))
            self%store%v(1:n, row) = (self%reference_length + first)*self%scale
         end associate
      end if
      if (present(more)) call put_seconds(self, n, more, self%store)
      if (self%first_turn > 0) self%store%v(1:n, self%first_turn) = (path - self%drawn)*radians_per_degree
      last = size(self%steps)
      if (present(last_step)) last = last_step
      do k = 1, last
         if (allocated(self%steps(k)%dyad%higher)) then
            call follow_group(self, k, n, path, more, closed)
            if (.not. present(offending)) cycle
            if (self%all_accepted(n, self%steps(k)%loop)) cycle
            offending = self%steps(k)%loop
            return
         end if
         associate (step => self%steps(k), v => self%store%v)
            if (step%kind == step_dyad) then
               call solve_dyad(n, step%dyad, self%store)
               if (present(turned)) call turn_over(n, turned(:, step%loop), step%dyad, self%store)
               if (present(offending)) then
                  if (.not. self%all_accepted(n, step%loop)) then
                     offending = step%loop
                     return
                  end if
               else if (.not. all_between(self, n, step%loop, step%dyad%closes_low, step%dyad%closes_high)) then
                  closed = .false.
                  call limit_dyad(n, step%dyad, self%store)
               end if
            else
               call solve_point(n, step, self%store)
            end if
         end associate
      end do
   end subroutine solve

   !> A dyad that has been solved, in its other assembly at some positions.
   pure subroutine turn_over(n, turned, dyad, store)
      integer, intent(in) :: n
      logical, intent(in) :: turned(:)           !! shape (n)
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(inout) :: store
      type(dyad_t) :: other
      integer :: rows(8), i, k
      real(wp) :: first(n, 8)

      if (.not. any(turned)) return
      rows = [dyad%p_x, dyad%p_y, dyad%q_x, dyad%q_y, dyad%slide_p, dyad%slide_q, dyad%tip%to_x, dyad%tip%to_y]
      do k = 1, size(rows)
         if (rows(k) > 0) first(:, k) = store%v(1:n, rows(k))
      end do
      other = dyad
      other%sign = -dyad%sign
      call solve_dyad(n, other, store)
      do k = 1, size(rows)
         if (rows(k) == 0) cycle
         do i = 1, n
            if (.not. turned(i)) store%v(i, rows(k)) = first(i, k)
         end do
      end do
   end subroutine turn_over

   !> Directions, lengths and turns that the drives after the first set.
   pure subroutine put_seconds(self, n, more, store)
      class(linkage_t), intent(in) :: self
      integer, intent(in) :: n
      real(wp), intent(in) :: more(:, :, :)      !! as `solve` has it
      type(rows_t), intent(inout) :: store
      integer :: d

      do d = 1, size(self%seconds)
         associate (own => self%seconds(d), v => store%v)
            if (own%slide > 0) v(1:n, own%slide) = (own%reference + more(:n, 1, d))*self%scale
            if (own%turn > 0) v(1:n, own%turn) = (own%reference - own%zero + more(:n, 1, d))*radians_per_degree
            if (own%root_x == 0) cycle
            v(1:n, own%root_x) = own%x*more(:n, 2, d) - own%y*more(:n, 3, d)
            v(1:n, own%root_y) = own%y*more(:n, 2, d) + own%x*more(:n, 3, d)
         end associate
      end do
   end subroutine put_seconds

   !> Rows that an input moves, 0: none, and by how much a unit of it: a radian, or a user's length.
   pure subroutine rows_of_drive(self, drive, rows, unit)
      class(linkage_t), intent(in) :: self
      integer, intent(in) :: drive
      integer, intent(out) :: rows(2)
      real(wp), intent(out) :: unit

      rows = 0
      unit = 1.0_wp
      if (drive == 1) then
         if (.not. self%sliding_input) then
            rows = [self%root_x(root_crank), self%first_turn]
         else if (self%input_slot > 0) then
            rows(1) = self%slide(self%input_slot)
            unit = self%scale
         end if
         return
      end if
      associate (own => self%seconds(drive - 1))
         if (own%slides) then
            rows(1) = own%slide
            unit = self%scale
         else
            rows = [own%root_x, own%turn]
         end if
      end associate
   end subroutine rows_of_drive

   !> Changes of driven lengths that count from a length which varies; `stretch` is 0 to put them back.
   pure subroutine put_driven_lengths(self, n, stretch, d)
      class(linkage_t), intent(in) :: self
      integer, intent(in) :: n
      real(wp), intent(in) :: stretch(:)         !! by arc: 1 where its length grows with the variable
      type(rows_t), intent(inout) :: d
      integer :: k

      do k = 1, size(self%driven_arc)
         d%v(1:n, self%driven_row(k)) = d%v(1:n, self%driven_row(k)) + stretch(self%driven_arc(k))*self%scale
      end do
   end subroutine put_driven_lengths

   !> A point, unless it is fixed or a dyad makes it.
   pure subroutine solve_point(n, step, store)
      integer, intent(in) :: n
      type(bound_step_t), intent(in) :: step
      type(rows_t), intent(inout) :: store

      if (step%fixed .or. step%maker > 0) return
      associate (v => store%v)
         if (step%slide_row == 0) then
            call add_arc(n, v(1, step%from_x), v(1, step%from_y), v(1, step%root_x), v(1, step%root_y), step%x, step%y, &
                         v(1, step%to_x), v(1, step%to_y))
         else
            call add_slide(n, v(1, step%from_x), v(1, step%from_y), v(1, step%root_x), v(1, step%root_y), &
                           v(1, step%slide_row), step%x, step%y, v(1, step%to_x), v(1, step%to_y))
         end if
      end associate
   end subroutine solve_point

   !> Unit vector of the crank: the increment's, turned by the reference angle.
   pure subroutine turn_crank(n, first, second, x, y, rx, ry)
      integer, intent(in) :: n
      real(wp), intent(in) :: first(n), second(n), x, y
      real(wp), intent(out) :: rx(n), ry(n)
      integer :: i

      do i = 1, n
         rx(i) = x*first(i) - y*second(i)
         ry(i) = y*first(i) + x*second(i)
      end do
   end subroutine turn_crank

   !> Where a dyad is open its arcs may be found endless: the dyads after it could not work with that.
   pure subroutine limit_dyad(n, dyad, store)
      integer, intent(in) :: n
      type(dyad_t), intent(in) :: dyad
      type(rows_t), intent(inout) :: store
      integer :: root_x, root_y

      associate (v => store%v, tip => dyad%tip)
         call limit(n, largest_direction, v(1, dyad%p_x))
         call limit(n, largest_direction, v(1, dyad%p_y))
         call limit(n, largest_direction, v(1, dyad%q_x))
         call limit(n, largest_direction, v(1, dyad%q_y))
         if (dyad%slide_p > 0) call limit(n, largest_slide, v(1, dyad%slide_p))
         if (dyad%slide_q > 0) call limit(n, largest_slide, v(1, dyad%slide_q))
         if (tip%to_x == 0) return
         root_x = merge(dyad%q_x, dyad%p_x, dyad%wants_q)
         root_y = merge(dyad%q_y, dyad%p_y, dyad%wants_q)
         call add_arc(n, v(1, tip%from_x), v(1, tip%from_y), v(1, root_x), v(1, root_y), tip%x, tip%y, v(1, tip%to_x), &
                      v(1, tip%to_y))
      end associate
   end subroutine limit_dyad

   pure subroutine limit(n, largest, row)
      integer, intent(in) :: n
      real(wp), intent(in) :: largest
      real(wp), intent(inout) :: row(n)

      row = min(max(row, -largest), largest)
   end subroutine limit

   !> Point at the other end of an arc of fixed length.
   pure subroutine add_arc(n, fx, fy, rx, ry, ax, ay, tx, ty)
      integer, intent(in) :: n
      real(wp), intent(in) :: fx(n), fy(n) !! point to start from
      real(wp), intent(in) :: rx(n), ry(n) !! root
      real(wp), intent(in) :: ax, ay       !! the arc in the axes of its root
      real(wp), intent(out) :: tx(n), ty(n)
      integer :: i

      do i = 1, n
         tx(i) = fx(i) + (ax*rx(i) - ay*ry(i))
         ty(i) = fy(i) + (ax*ry(i) + ay*rx(i))
      end do
   end subroutine add_arc

   !> Point at the other end of an arc of varying length.
   pure subroutine add_slide(n, fx, fy, rx, ry, length, ax, ay, tx, ty)
      integer, intent(in) :: n
      real(wp), intent(in) :: fx(n), fy(n), rx(n), ry(n), length(n), ax, ay
      real(wp), intent(out) :: tx(n), ty(n)
      integer :: i

      do i = 1, n
         tx(i) = fx(i) + length(i)*(ax*rx(i) - ay*ry(i))
         ty(i) = fy(i) + length(i)*(ax*ry(i) + ay*rx(i))
      end do
   end subroutine add_slide

   !> True where loop `loop` closes at position `i` of the block (to rounding).
   pure logical function closes(self, i, loop)
      class(linkage_t), intent(in) :: self
      integer, intent(in) :: i, loop

      associate (dyad => self%steps(self%step_of_loop(loop))%dyad)
         closes = is_between(self, i, loop, dyad%closes_low, dyad%closes_high)
      end associate
   end function closes

   !> True where loop `loop` closes at position `i` of the block and its transmission angle is within the limits.
   pure logical function accepts(self, i, loop)
      class(linkage_t), intent(in) :: self
      integer, intent(in) :: i, loop

      associate (dyad => self%steps(self%step_of_loop(loop))%dyad)
         accepts = is_between(self, i, loop, dyad%accepts_low, dyad%accepts_high)
      end associate
   end function accepts

   !> Measure of a loop, of two slides its amount, against limits.
   pure logical function is_between(self, i, loop, low, high)
      type(linkage_t), intent(in) :: self
      integer, intent(in) :: i, loop
      real(wp), intent(in) :: low, high
      real(wp) :: measure

      measure = self%store%v(i, self%measure(loop))
      if (self%two_slides(loop)) measure = abs(measure)
      is_between = measure >= low .and. measure <= high
   end function is_between

   !> True if loop `loop` is accepted at the first `n` positions of the block.
   pure logical function all_accepted(self, n, loop)
      class(linkage_t), intent(in) :: self
      integer, intent(in) :: n, loop

      associate (dyad => self%steps(self%step_of_loop(loop))%dyad)
         all_accepted = all_between(self, n, loop, dyad%accepts_low, dyad%accepts_high)
      end associate
   end function all_accepted

   !> Measure of a loop, of two slides its amount, against limits, at the first `n` positions of the block.
   pure logical function all_between(self, n, loop, low, high)
      type(linkage_t), intent(in) :: self
      integer, intent(in) :: n, loop
      real(wp), intent(in) :: low, high

      if (self%two_slides(loop)) then
         all_between = beyond(n, self%store%v(1, self%measure(loop)), low)
      else
         all_between = within(n, self%store%v(1, self%measure(loop)), low, high)
      end if
   end function all_between

   !> Remember on which side of each other the two slides of each loop are at the first `n` positions of the block.
   pure subroutine note_sides(self, n)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: n
      integer :: loop, i, side

      do loop = 1, size(self%side)
         if (.not. self%two_slides(loop) .or. self%step_of_loop(loop) == 0) cycle
         do i = 1, n
            side = merge(1, -1, self%store%v(i, self%measure(loop)) > 0.0_wp)
            if (self%side(loop) == 0) self%side(loop) = side
            if (self%side(loop) /= side) self%side(loop) = mixed
         end do
      end do
   end subroutine note_sides

   !> True unless the slides of a loop were on both sides of each other, here or in another part of the positions.
   pure logical function stays_on_side(self, loop, other)
      class(linkage_t), intent(in) :: self
      integer, intent(in) :: loop
      class(linkage_t), intent(in), optional :: other

      stays_on_side = self%side(loop) /= mixed
      if (present(other)) stays_on_side = stays_on_side .and. self%side(loop) == other%side(loop)
   end function stays_on_side

   !> True if low <= measure <= high throughout: no difference has the sign bit. It runs in vector registers, without masks.
   pure logical function within(n, measure, low, high)
      integer, intent(in) :: n
      real(wp), intent(in) :: measure(n), low, high     !! finite
      integer(as_wide) :: signs
      integer :: i

      signs = 0
      do i = 1, n
         signs = ior(signs, ior(transfer(measure(i) - low, signs), transfer(high - measure(i), signs)))
      end do
      within = signs >= 0
   end function within

   !> True if the amount of the measure is not below `low` anywhere.
   pure logical function beyond(n, measure, low)
      integer, intent(in) :: n
      real(wp), intent(in) :: measure(n), low
      integer(i8) :: inside
      integer :: i

      inside = 0
      do i = 1, n
         inside = inside + merge(1_i8, 0_i8, abs(measure(i)) < low)
      end do
      beyond = inside == 0
   end function beyond

   !> Direction and length (user's unit) of an arc at position `i` of the block.
   pure subroutine arc_at(self, plan, arc, i, x, y, length)
      class(linkage_t), intent(in) :: self
      type(plan_t), intent(in) :: plan
      integer, intent(in) :: arc, i             !! sequential number; position of the block
      real(wp), intent(out) :: x, y, length     !! unit vector; length, signed for a slide
      real(wp) :: rx, ry

      rx = self%store%v(i, self%root_x(plan%root(arc)))
      ry = self%store%v(i, self%root_y(plan%root(arc)))
      x = self%x(arc)*rx - self%y(arc)*ry
      y = self%x(arc)*ry + self%y(arc)*rx
      length = self%length(arc)
      if (plan%length_slot(arc) > 0) length = self%store%v(i, self%slide(plan%length_slot(arc)))
      length = length/self%scale
   end subroutine arc_at

   !> From now on larger groups are followed from where they stand at position i of the block, until the next `bind`.
   pure subroutine follow_from(self, i, inputs)
      class(linkage_t), intent(inout) :: self
      integer, intent(in) :: i
      real(wp), intent(in) :: inputs(:)       !! shape (drives): increments there
      integer :: k, j

      do k = 1, size(self%steps)
         if (.not. allocated(self%steps(k)%dyad%higher)) cycle
         associate (higher => self%steps(k)%dyad%higher)
            call keep_turns(higher, self%store, i)
            higher%from = higher%now
            do j = 1, size(higher%known)
               higher%known(j)%from = higher%known(j)%now
            end do
         end associate
      end do
      self%from = inputs
   end subroutine follow_from
end module psalm_linkage
