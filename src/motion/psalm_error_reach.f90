!> Which positions a sketch comes to from its drawing.
!>
!> Where the loops close the links can be put together; whether the linkage moves there is another question. From the drawing the
!> input goes both ways in even steps until a loop opens, two slides become parallel or a dead point is touched between steps; of
!> a crank, until it meets itself. That is a search, no proof.
submodule(psalm_error) psalm_error_reach
   use psalm_kinds, only: full_turn
   implicit none (type, external)

   integer, parameter :: steps = 720, steps_of_refinement = 16
   integer, parameter :: refinements = 12              !! closer looks
   real(wp), parameter :: near_dead = 0.05_wp     !! margin below which a dead point is looked for between steps
   real(wp), parameter :: touched = 1.0e-12_wp    !! margin of a dead point, but for rounding
   real(wp), parameter :: same_input = 1.0e-9_wp  !! of a turn, or of the range: a position at the end is reached

   !> The way from the drawing in one sense.
   type :: scout_t
      class(problem_t), allocatable :: row        !! its steps
      class(problem_t), allocatable :: refinement       !! a few positions between two of them
      real(wp), allocatable :: span(:)            !! by loop: size of its measure
   end type scout_t

contains

   module subroutine leave_out_unreached(self, dimensions, motion, reach)
      class(problem_t), intent(in) :: self
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(inout) :: motion
      type(reach_t), intent(inout) :: reach
      class(problem_t), allocatable :: row
      real(wp) :: start
      integer :: k

      allocate (motion%beyond(size(motion%closed)), source=.false.)
      if (.not. any(motion%closed)) return
      start = dimensions%drawn - dimensions%crnki
      if (any(.not. self%mechanism%actuators(2:)%geared)) then
         call copy_problem(self, row)
         call find_other_sides(row, dimensions, start, motion%beyond)
      else
         call find_ends(self, dimensions, start, motion%closed, reach, motion%beyond)
      end if
      motion%beyond = motion%beyond .and. motion%closed
      motion%closed = motion%closed .and. .not. motion%beyond
      motion%output_known = motion%output_known .and. .not. motion%beyond
      if (.not. self%desired .or. .not. any(motion%beyond)) return
      motion%total = 0.0_wp
      do k = 1, size(motion%closed)
         if (motion%closed(k)) motion%total = motion%total + sum(self%weight(k, :)*motion%error(k, :)**2)
      end do
   end subroutine leave_out_unreached

   !> The problem for one thread, to be given other inputs.
   subroutine copy_problem(self, copy)
      class(problem_t), intent(in) :: self
      class(problem_t), allocatable, intent(out) :: copy

      allocate (copy, source=self)
      if (allocated(copy%linkages)) deallocate (copy%linkages)
   end subroutine copy_problem

   !> Inputs beyond the ends of the way from the drawing. With other dimensions than those of the drawing it may not close there:
   !> then the way begins at the nearest position that closes.
   subroutine find_ends(self, dimensions, drawn, closed, reach, beyond)
      class(problem_t), intent(in) :: self
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: drawn                  !! the input of the drawing
      logical, intent(in) :: closed(:)               !! shape (positions)
      type(reach_t), intent(inout) :: reach          !! is found if it is not known so far
      logical, intent(inout) :: beyond(:)            !! shape (positions)
      type(scout_t) :: scout
      real(wp) :: to(2), from_start, slack
      logical :: repeats
      integer :: k

      repeats = turn_repeats(self)
      to = limits_from(drawn)
      slack = same_input*merge(full_turn, maxval(abs(to)), repeats)
      if (.not. reach%known .or. any(abs(reach%followed - to) > 0.0_wp)) then
         call copy_problem(self, scout%row)
         allocate (scout%refinement, source=scout%row)
         reach%known = .true.
         reach%followed = to
         reach%start = drawn
         if (.not. closes_at(scout%row, dimensions, drawn)) then
            reach%start = self%delt(minloc(abs(self%delt - drawn), dim=1, mask=closed))
            to = limits_from(reach%start)
         end if
         call follow(scout, dimensions, reach%start, to(1), reach%ends(1))
         ! the other way round a turn it need not go farther than to where it ended
         if (repeats) to(2) = reach%ends(1) - full_turn
         call follow(scout, dimensions, reach%start, to(2), reach%ends(2))
      end if
      if (repeats .and. reach%ends(1) >= full_turn) return
      associate (start => reach%start, forwards => reach%ends(1), backwards => reach%ends(2))
         do k = 1, size(beyond)
            from_start = self%delt(k) - start
            if (.not. repeats) then
               beyond(k) = from_start > forwards + slack .or. from_start < backwards - slack
            else
               from_start = modulo(from_start, full_turn)
               beyond(k) = from_start > forwards + slack .and. from_start - full_turn < backwards - slack
            end if
         end do
      end associate

   contains

      !> How far it is to go both ways.
      pure function limits_from(start) result(to)
         real(wp), intent(in) :: start
         real(wp) :: to(2)

         to = [full_turn, -full_turn]
         if (.not. repeats) to = [max(maxval(self%delt) - start, 0.0_wp), min(minval(self%delt) - start, 0.0_wp)]
      end function limits_from
   end subroutine find_ends

   !> True if every loop closes at an input.
   logical function closes_at(row, dimensions, input)
      class(problem_t), intent(inout) :: row
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: input
      integer :: offset, n, l

      call row%set_inputs([input])
      call row%bind(dimensions)
      call row%solve_block(1, offset, n)
      closes_at = .true.
      do l = 1, row%mechanism%nloop
         if (row%linkage%step_of_loop(l) > 0) closes_at = closes_at .and. row%linkage%closes(1, l)
      end do
   end function closes_at

   !> A way through several inputs is not one of even steps of the first. Whatever way a linkage takes, it does not come to where
   !> two slides are the other way round than in the drawing: they would have been parallel between.
   subroutine find_other_sides(problem, dimensions, start, beyond)
      class(problem_t), intent(inout) :: problem     !! with its positions
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: start                  !! the first input of the drawing
      logical, intent(inout) :: beyond(:)            !! shape (positions)
      real(wp), dimension(size(beyond), problem%mechanism%nloop) :: margin, sine
      real(wp), dimension(1, problem%mechanism%nloop) :: drawn_margin, drawn_sine
      real(wp) :: span(problem%mechanism%nloop)
      integer :: l

      if (.not. any(problem%linkage%two_slides)) return
      span = 0.0_wp
      call problem%bind(dimensions)
      call find_margins(problem, span, margin, sine)
      call problem%set_inputs([start])
      call problem%bind(dimensions)
      call find_margins(problem, span, drawn_margin, drawn_sine)
      do l = 1, size(sine, 2)
         beyond = beyond .or. sine(:, l)*drawn_sine(1, l) < 0.0_wp
      end do
   end subroutine find_other_sides

   !> True if after a turn of the first drive everything stands as before. Not where turns count, as those of wheels do.
   pure logical function turn_repeats(self)
      class(problem_t), intent(in) :: self
      integer :: d

      turn_repeats = .not. self%mechanism%sliding_input .and. .not. self%linkage%tied
      do d = 2, size(self%mechanism%actuators)
         associate (actuator => self%mechanism%actuators(d))
            turn_repeats = turn_repeats .and. .not. actuator%slides .and. actuator%ratio == anint(actuator%ratio)
         end associate
      end do
   end function turn_repeats

   !> How far the linkage comes from the drawing, at most `extent`, which may be negative.
   subroutine follow(scout, dimensions, start, extent, way)
      type(scout_t), intent(inout) :: scout
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: start, extent
      real(wp), intent(out) :: way
      real(wp) :: inputs(0:steps), margin(0:steps, scout%row%mechanism%nloop), sine(0:steps, scout%row%mechanism%nloop), ended
      integer :: i, l
      logical :: ends

      way = 0.0_wp
      if (abs(extent) <= 0.0_wp) return
      inputs = start + extent*[(real(i, wp)/real(steps, wp), i=0, steps)]
      call scout%row%set_inputs(inputs)
      call scout%row%bind(dimensions)
      call scout%refinement%set_inputs(inputs(:steps_of_refinement))
      call scout%refinement%bind(dimensions)
      ! a group alone may come the other way round to where the linkage does not
      scout%row%linkage%one_way = .true.
      scout%refinement%linkage%one_way = .true.
      allocate (scout%span(size(margin, 2)), source=0.0_wp)
      call find_margins(scout%row, scout%span, margin, sine)
      way = extent
      do i = 1, steps + 1                         ! the last looks at the end of the steps only
         associate (before => max(i - 2, 0), after => min(i, steps))
            do l = 1, size(margin, 2)
               ends = margin(after, l) < 0.0_wp .or. sine(i - 1, l)*sine(after, l) < 0.0_wp
               ended = 0.0_wp
               if (ends) then
                  call find_end(scout, l, inputs(i - 1), inputs(after), sine(i - 1, l), ended)
               else if (margin(i - 1, l) < near_dead .and. margin(i - 1, l) <= margin(before, l) .and. &
                        margin(i - 1, l) <= margin(after, l)) then
                  call find_touch(scout, l, inputs(before), inputs(after), sine(i - 1, l), i > 1 .and. i <= steps, ends, ended)
               end if
               if (ends .and. abs(ended - start) < abs(way)) way = ended - start
            end do
         end associate
         if (abs(way) < abs(extent)) exit
      end do
      deallocate (scout%span)
   end subroutine follow

   !> How far every loop is inside the limits of its closure, as a part of its range; of two slides the sine of their angle.
   subroutine find_margins(problem, span, margin, sine)
      class(problem_t), intent(inout) :: problem      !! bound
      real(wp), intent(inout) :: span(:)              !! by loop; 0: to be chosen
      real(wp), intent(out) :: margin(:, :)           !! shape (positions, loops): negative where it does not close
      real(wp), intent(out) :: sine(:, :)             !! the same shape; 0 for other loops
      real(wp) :: measure
      integer :: block, offset, n, i, l

      margin = huge(1.0_wp)
      sine = 0.0_wp
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         associate (link => problem%linkage)
            do l = 1, size(margin, 2)
               if (link%step_of_loop(l) == 0) cycle
               associate (dyad => link%steps(link%step_of_loop(l))%dyad)
                  do i = 1, n
                     measure = link%store%v(i, link%measure(l))
                     if (link%two_slides(l)) then
                        sine(offset + i, l) = measure
                        measure = abs(measure)
                     end if
                     margin(offset + i, l) = min(measure - dyad%closes_low, dyad%closes_high - measure)
                  end do
                  if (block == 1 .and. span(l) <= 0.0_wp) then
                     span(l) = dyad%closes_high - dyad%closes_low
                     if (span(l) >= 0.5_wp*huge(measure)) span(l) = maxval(link%store%v(:n, link%measure(l)))
                     span(l) = max(span(l), tiny(measure))
                  end if
               end associate
            end do
         end associate
      end do
      do l = 1, size(margin, 2)
         if (problem%linkage%step_of_loop(l) > 0) margin(:, l) = margin(:, l)/span(l)
      end do
   end subroutine find_margins

   !> Look at even steps between two inputs.
   subroutine look(scout, from, to, margin, sine)
      type(scout_t), intent(inout) :: scout
      real(wp), intent(in) :: from, to
      real(wp), intent(out) :: margin(0:, :), sine(0:, :)
      integer :: i

      call scout%refinement%move_inputs([(from + (to - from)*(real(i, wp)/real(steps_of_refinement, wp)), i=0, &
                                         steps_of_refinement)])
      call find_margins(scout%refinement, scout%span, margin, sine)
   end subroutine look

   !> The end between an input at which a loop closes and one at which it does not, or has its slides the other way round.
   subroutine find_end(scout, loop, inside, outside, side, end)
      type(scout_t), intent(inout) :: scout
      integer, intent(in) :: loop
      real(wp), intent(in) :: inside, outside
      real(wp), intent(in) :: side                    !! sine of two slides inside; 0 for other loops
      real(wp), intent(out) :: end
      real(wp) :: margin(0:steps_of_refinement, size(scout%span)), sine(0:steps_of_refinement, size(scout%span)), beyond, step
      integer :: round, j

      end = inside
      beyond = outside
      do round = 1, refinements
         call look(scout, end, beyond, margin, sine)
         do j = 1, steps_of_refinement - 1
            if (margin(j, loop) < 0.0_wp .or. sine(j, loop)*side < 0.0_wp) exit
         end do
         step = (beyond - end)/real(steps_of_refinement, wp)
         beyond = end + real(j, wp)*step
         end = end + real(j - 1, wp)*step
      end do
   end subroutine find_end

   !> The dead point between two inputs at which a loop closes, if there is one.
   subroutine find_touch(scout, loop, from, to, side, inner, ends, end)
      type(scout_t), intent(inout) :: scout
      integer, intent(in) :: loop
      real(wp), intent(in) :: from, to
      real(wp), intent(in) :: side                    !! sine of two slides there; 0 for other loops
      logical, intent(in) :: inner                    !! a dead point that is touched ends the way, too: not so at its own ends
      logical, intent(out) :: ends
      real(wp), intent(out) :: end
      real(wp) :: margin(0:steps_of_refinement, size(scout%span)), sine(0:steps_of_refinement, size(scout%span)), low, high, step
      integer :: round, j

      low = from
      high = to
      ends = .false.
      end = from
      do round = 1, refinements
         call look(scout, low, high, margin, sine)
         step = (high - low)/real(steps_of_refinement, wp)
         do j = 1, steps_of_refinement
            if (margin(j, loop) >= merge(0.0_wp, -touched, inner) .and. sine(j, loop)*side >= 0.0_wp) cycle
            ends = .true.
            call find_end(scout, loop, low + real(j - 1, wp)*step, low + real(j, wp)*step, side, end)
            return
         end do
         j = minloc(margin(:, loop), dim=1) - 1
         end = low + real(j, wp)*step
         ends = inner .and. margin(j, loop) <= touched
         j = min(max(j, 1), steps_of_refinement - 1)
         high = low + real(j + 1, wp)*step
         low = low + real(j - 1, wp)*step
      end do
   end subroutine find_touch
end submodule psalm_error_reach
