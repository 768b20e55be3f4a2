!> One run over a sketch in the poses of its links: any Assur groups, any number of drives, all outputs and joints.
module psalm_chain_study
   use psalm_chain_motion, only: chain_motion_t, follow, differentiate
   use psalm_chain_outputs, only: output_at
   use psalm_closure, only: closure_t, state_t, most_orders
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, full_turn, radians_per_degree
   use psalm_link_poses, only: find_poses, looped_t, make_looped
   use psalm_row_study, only: solved_row_t
   use psalm_sketch, only: sketch_t, drive_turns, frame_link, output_ratio, columns_of
   use psalm_sketch_assembly, only: assemble_sketch
   use psalm_sketch_outputs, only: names_of_numbers, unwrap
   use psalm_sketch_study, only: sketch_study_t
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: chain_study_t, study_chain, inputs_at, inputs_of_drives, turn_repeats, turn_may_repeat, turn_is_open, inputs_of_row

   !> What the sketch does.
   type, extends(sketch_study_t) :: chain_study_t
      logical :: valid = .false.
      type(closure_t) :: closure
      type(state_t) :: start                        !! at the drawing
      type(chain_motion_t) :: motion
      class(looped_t), allocatable :: looped        !! if the poses are taken from its loops
   contains
      procedure :: leave_last_out
   end type chain_study_t

contains

   !> Positions, rates by time and outputs. `speed` and `accel` are those of the first drive; the others follow by their ratio or
   !> have their own.
   subroutine study_chain(set, speed, accel, study, inputs, by_loops, other, solved)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: speed, accel          !! radians or length a second
      type(chain_study_t), intent(out) :: study
      real(wp), intent(in), optional :: inputs(:, :) !! shape (drives, positions): degrees or length from the drawing, in place of
                                                    !! those of the case
      logical, intent(in), optional :: by_loops     !! take the poses from its loops, if there are: for pictures
      type(chain_study_t), intent(in), optional :: other !! of the same sketch at other inputs
      type(solved_row_t), intent(in), optional :: solved !! its loops at these inputs: with `by_loops` they are not solved again
      type(diagnostics_t) :: findings
      real(wp), allocatable :: angles(:, :), rate(:, :, :)
      real(wp) :: unit
      integer :: k, d, n, numbers, positions
      logical :: looped

      if (present(other)) then
         study%closure = other%closure
         study%start = other%start
         study%valid = other%valid
         if (allocated(other%looped)) allocate (study%looped, source=other%looped)
      else
         call assemble_sketch(set, study%closure, study%start, study%valid, findings)
      end if
      if (.not. study%valid) return
      associate (drives => set%sketch%drives, outputs => set%sketch%outputs)
         if (present(inputs)) then
            study%inputs = inputs
         else
            study%inputs = inputs_of_drives(set, .false.)
         end if
         angles = study%inputs
         do d = 1, size(drives)
            angles(d, :) = angles(d, :)*unit_of(drives(d)%kind)
         end do
         positions = size(angles, 2)
         allocate (rate(size(drives), most_orders, positions), source=0.0_wp)
         do d = 1, size(drives)
            unit = 0.0_wp
            if (drives(d)%geared) unit = drives(d)%ratio*unit_of(drives(d)%kind)/unit_of(drives(1)%kind)
            if (d == 1) unit = 1.0_wp
            rate(d, 1, :) = unit*speed
            rate(d, 2, :) = unit*accel
            if (d == 1 .or. drives(d)%geared) cycle
            rate(d, 1, :) = drives(d)%speed
            rate(d, 2, :) = drives(d)%accel
         end do
         looped = .false.
         if (present(by_loops)) looped = by_loops .and. allocated(set%traced)
         if (looped) then
            if (.not. allocated(study%looped)) then
               allocate (study%looped)
               call make_looped(set, study%looped, solved)
            end if
            associate (timed => set%counts_time())
               call find_poses(set, study%closure, study%inputs, merge(set%pace(), speed, timed), &
                               merge(set%change_of_pace(), accel, timed), study%looped, study, study%motion, solved)
            end associate
            do k = 1, positions
               allocate (study%motion%states(k)%input(size(drives), 0:most_orders))
               study%motion%states(k)%input(:, 0) = angles(:, k)
               study%motion%states(k)%input(:, 1:) = rate(:, :, k)
            end do
            return
         end if
         if (turn_repeats(set)) then
            call follow(study%closure, study%start, angles, rate, study%motion, full_turn*radians_per_degree* &
                        [(merge(drives(d)%ratio, 1.0_wp, drives(d)%geared), d=1, size(drives))])
         else
            call follow(study%closure, study%start, angles, rate, study%motion)
         end if
         call names_of_numbers(outputs, study%names, study%angles)
         numbers = size(study%names)
         allocate (study%values(numbers, 0:most_orders, positions), source=0.0_wp)
         do k = 1, positions
            if (.not. study%motion%closed(k)) cycle
            call output_at(study%closure, study%motion%states(k), outputs, study%values(:, :, k))
            do n = 1, numbers
               if (study%values(n, 0, k) >= huge(1.0_wp)) study%values(n, :, k) = huge(1.0_wp)
            end do
         end do
         call find_changes(study)
         study%closed = study%motion%closed
         study%dead = study%motion%dead
         allocate (study%joints(size(set%sketch%joint_name), 0:most_orders, positions))
         do k = 1, positions
            study%joints(:, :, k) = study%motion%states(k)%joint
         end do
         do n = 1, numbers
            if (study%angles(n) .and. all(study%motion%closed)) call unwrap(study%values(n, 0, :))
         end do
      end associate
   end subroutine study_chain

   !> Leave the last position out.
   subroutine leave_last_out(self)
      class(chain_study_t), intent(inout) :: self
      real(wp), allocatable :: values(:, :, :)      ! orders count from 0, which a section forgets
      complex(wp), allocatable :: joints(:, :, :)

      associate (n => size(self%closed) - 1)
         self%inputs = self%inputs(:, :n)
         self%closed = self%closed(:n)
         self%dead = self%dead(:n)
         allocate (values(size(self%values, 1), 0:most_orders, n), source=self%values(:, :, :n))
         call move_alloc(values, self%values)
         self%by_drive = self%by_drive(:, :, :n)
         allocate (joints(size(self%joints, 1), 0:most_orders, n), source=self%joints(:, :, :n))
         call move_alloc(joints, self%joints)
         self%motion%closed = self%motion%closed(:n)
         self%motion%dead = self%motion%dead(:n)
         self%motion%group = self%motion%group(:n)
         self%motion%states = self%motion%states(:n)
      end associate
   end subroutine leave_last_out

   !> What each drive does by itself: derivatives of all outputs by every one, radians for degrees.
   subroutine find_changes(study)
      type(chain_study_t), intent(inout) :: study
      type(state_t) :: state
      real(wp) :: values(size(study%names), 0:most_orders)
      logical :: dead
      integer :: k, d, n, o

      associate (drives => size(study%inputs, 1), positions => size(study%motion%closed), outputs => study%closure%sketch%outputs)
         allocate (study%by_drive(size(study%names), drives, positions), source=0.0_wp)
         if (drives == 1) return
         do k = 1, positions
            if (.not. study%motion%closed(k) .or. study%motion%dead(k)) cycle
            do d = 1, drives
               state = study%motion%states(k)
               state%input(:, 1:) = 0.0_wp
               state%input(d, 1) = 1.0_wp
               call differentiate(study%closure, 1, state, dead)
               call output_at(study%closure, state, outputs, values)
               study%by_drive(:, d, k) = values(:, 1)
            end do
         end do
         n = 0
         do o = 1, size(outputs)
            n = n + columns_of(outputs(o))
            ! a ratio of rates is another one for each drive: it has no change with one alone
            if (outputs(o)%kind == output_ratio) study%by_drive(n, :, :) = huge(1.0_wp)
         end do
      end associate
   end subroutine find_changes

   !> Values of all drives at all positions, from the drawing: degrees, or radians if `in_radians`; or length.
   function inputs_of_drives(set, in_radians) result(inputs)
      type(data_set_t), intent(in) :: set
      logical, intent(in) :: in_radians
      real(wp), allocatable :: inputs(:, :)         !! shape (drives, positions)
      integer :: k, d

      if (set%method%ikin /= 0) then
         inputs = inputs_at(set, [(real((k - 1)*set%method%ikin, wp), k=1, 359/abs(set%method%ikin) + 1)])
      else
         inputs = inputs_at(set, set%method%delt)
      end if
      if (.not. in_radians) return
      do d = 1, size(inputs, 1)
         inputs(d, :) = inputs(d, :)*unit_of(set%sketch%drives(d)%kind)
      end do
   end function inputs_of_drives

   !> Values of all drives, from the drawing, at increments of the first: degrees or length. A drive of its own that has another
   !> number of values stands still.
   pure function inputs_at(set, delt) result(inputs)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: delt(:)
      real(wp), allocatable :: inputs(:, :)         !! shape (drives, positions)
      integer :: d

      allocate (inputs(size(set%sketch%drives), size(delt)), source=0.0_wp)
      inputs(1, :) = set%method%crnki
      inputs(1, :) = inputs(1, :) + delt
      do d = 1, size(inputs, 1)
         associate (drive => set%sketch%drives(d))
            if (drive%geared) then
               inputs(d, :) = drive%ratio*inputs(1, :) + drive%phase
            else if (allocated(drive%delt)) then
               if (size(drive%delt) == size(delt)) inputs(d, :) = drive%delt
            end if
         end associate
      end do
   end function inputs_at

   !> Values of all drives, from the drawing, at the positions of a row that is solved: degrees or length.
   pure function inputs_of_row(set, row) result(inputs)
      type(data_set_t), intent(in) :: set
      type(solved_row_t), intent(in) :: row
      real(wp), allocatable :: inputs(:, :)         !! shape (drives, positions)
      integer :: d

      inputs = inputs_at(set, row%problem%delt)
      if (.not. allocated(row%problem%own_delt)) return
      do d = 2, size(inputs, 1)
         if (.not. set%sketch%drives(d)%geared) inputs(d, :) = row%problem%own_delt(:, d - 1)
      end do
   end function inputs_of_row

   !> True if after a turn of the first drive all drives stand as before. Not with gears: a wheel that the drive turns stands
   !> elsewhere then, unless the numbers of teeth are just so.
   pure logical function turn_repeats(set)
      type(data_set_t), intent(in) :: set
      integer :: d

      turn_repeats = set%sketch%drives(1)%kind == drive_turns
      if (allocated(set%sketch%gears)) turn_repeats = turn_repeats .and. size(set%sketch%gears) == 0
      do d = 2, size(set%sketch%drives)
         associate (drive => set%sketch%drives(d))
            turn_repeats = turn_repeats .and. drive%geared .and. drive%kind == drive_turns .and. drive%ratio == anint(drive%ratio)
         end associate
      end do
   end function turn_repeats

   !> False if a turn of the first drive leaves a drive or a wheel elsewhere. A wheel that frame and driven links turn makes so
   !> many turns as the teeth say; of a wheel on a link that swings only the turn itself tells (`turn_is_open`).
   pure logical function turn_may_repeat(set)
      type(data_set_t), intent(in) :: set
      real(wp), parameter :: whole = 1.0e-9_wp       ! turns; what rounding of ratios makes is far below
      real(wp), allocatable :: turns(:)              ! of links, after a turn of the first drive
      logical, allocatable :: known(:)

      turn_may_repeat = turn_repeats(set)
      if (turn_may_repeat .or. .not. has_wheels(set) .or. set%sketch%drives(1)%kind /= drive_turns) return
      if (any(.not. set%sketch%drives(2:)%geared)) return
      call find_turns(set%sketch, turns, known)
      turn_may_repeat = all(abs(turns - anint(turns)) <= whole)
   end function turn_may_repeat

   !> True if a wheel is on a link of which only a whole turn of the first drive tells how it turns.
   pure logical function turn_is_open(set)
      type(data_set_t), intent(in) :: set
      real(wp), allocatable :: turns(:)
      logical, allocatable :: known(:)
      integer :: g

      turn_is_open = .false.
      if (.not. has_wheels(set)) return
      call find_turns(set%sketch, turns, known)
      turn_is_open = .not. all([(known(set%sketch%gears(g)%wheels), g=1, size(set%sketch%gears))])
   end function turn_is_open

   pure logical function has_wheels(set)
      type(data_set_t), intent(in) :: set

      has_wheels = .false.
      if (allocated(set%sketch%gears)) has_wheels = size(set%sketch%gears) > 0
   end function has_wheels

   !> How far links have turned after a turn of the first drive, where drives and teeth tell.
   pure subroutine find_turns(sketch, turns, known)
      type(sketch_t), intent(in) :: sketch
      real(wp), allocatable, intent(out) :: turns(:)   !! shape (links): turns; 0 where it is not known
      logical, allocatable, intent(out) :: known(:)    !! shape (links)
      integer :: d, g, pass

      allocate (turns(size(sketch%links)), source=0.0_wp)
      known = [(d == frame_link, d=1, size(sketch%links))]
      do d = 1, size(sketch%drives)
         associate (drive => sketch%drives(d))
            if (drive%kind /= drive_turns .or. .not. known(drive%base)) cycle
            if (d > 1 .and. .not. drive%geared) cycle
            turns(drive%link) = turns(drive%base) + merge(drive%ratio, 1.0_wp, drive%geared)
            known(drive%link) = .true.
         end associate
      end do
      do pass = 1, size(sketch%gears)
         do g = 1, size(sketch%gears)
            associate (a => sketch%gears(g)%wheels(1), b => sketch%gears(g)%wheels(2), carrier => sketch%gears(g)%carrier, &
                       ratio => sketch%gears(g)%ratio)
               if (.not. known(carrier) .or. (known(a) .eqv. known(b))) cycle
               if (known(a)) then
                  turns(b) = turns(carrier) + ratio*(turns(a) - turns(carrier))
               else
                  turns(a) = turns(carrier) + (turns(b) - turns(carrier))/ratio
               end if
               known([a, b]) = .true.
            end associate
         end do
      end do
   end subroutine find_turns

   !> Radians a degree for a drive that turns, else 1.
   pure real(wp) function unit_of(kind)
      integer, intent(in) :: kind

      unit_of = merge(radians_per_degree, 1.0_wp, kind == drive_turns)
   end function unit_of
end module psalm_chain_study
