!> The standard charts of a joint with clearance (Haines, chapters 3 and 4): over H1 (the radius) and H2 (the angle), for each H3,
!> where contact is lost, at which minimum of the force, and the index of the impulse of the first impact.
module psalm_flypast_chart
   use psalm_contact_pulse, only: contact_pulse_t, pulse_shape_t, find_pulse
   use psalm_flypast, only: flypast_t, flight_t, passing_contact_t, passed_step_t, follow_flypast, fly
   use psalm_kinds, only: wp, pi
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: chart_t, loss_range_t, make_chart, scan_line, outermost_loss, pulse_numbers

   real(wp), parameter :: farthest = 2.0_wp     !! H1 up to which `outermost_loss` looks
   real(wp), parameter :: scan = 0.05_wp        !! its steps
   real(wp), parameter :: exactly = 1.0e-5_wp   !! its borders, relative

   integer, parameter :: pulse_numbers = 7      !! of a pulse in a chart

   !> A range of H1 within which contact is lost.
   type :: loss_range_t
      real(wp) :: from = 0.0_wp, to = 0.0_wp
      integer :: minimum = 0                    !! the minimum of the force that is lost at its upper end
   end type loss_range_t

   !> The ranges on one radial line.
   type :: chart_line_t
      type(loss_range_t), allocatable :: ranges(:)
      type(loss_range_t), allocatable :: passage(:) !! those of a loss in the passage
   end type chart_line_t

   type :: chart_t
      real(wp), allocatable :: h1(:), h2(:), h3(:)  !! h2 in radians, from -pi at equal steps
      integer, allocatable :: lost(:, :, :)         !! shape (h1, h2, h3): the minimum at which contact is lost; 0: it is kept
      real(wp), allocatable :: index(:, :, :)       !! of the impulse; 0 where contact is kept
      real(wp), allocatable :: pulse(:, :, :, :)    !! shape (pulse_numbers, h1, h2, h3), contact kept: T of the greatest force, it,
                                                    !! height, width, growth, decay, impulse; 0 where none is known
      type(chart_line_t), allocatable :: lines(:, :)      !! shape (h2, h3)
   end type chart_t

contains

   !> A chart at equal steps of H1 and H2. It is the same for any number of threads: every line is made by itself.
   subroutine make_chart(radii, angles, greatest, h3, chart, stop)
      integer, intent(in) :: radii, angles
      real(wp), intent(in) :: greatest          !! H1
      real(wp), intent(in) :: h3(:)             !! each from 0 to below 1
      type(chart_t), intent(out) :: chart
      type(stop_t), intent(in), optional :: stop !! asked before every line
      type(stop_t) :: ending
      real(wp), allocatable :: numbers(:)
      integer :: i, k, m, n, line, lines, at

      chart%h1 = [(greatest*real(i, wp)/real(radii, wp), i=1, radii)]
      chart%h2 = [(-pi + 2.0_wp*pi*real(i - 1, wp)/real(angles, wp), i=1, angles)]
      chart%h3 = h3
      allocate (chart%lost(radii, angles, size(h3)), chart%index(radii, angles, size(h3)), chart%lines(angles, size(h3)), &
                chart%pulse(pulse_numbers, radii, angles, size(h3)))
      chart%lost = 0
      chart%index = 0.0_wp
      chart%pulse = 0.0_wp
      do line = 1, size(chart%lines)
         associate (of => chart%lines(1 + modulo(line - 1, angles), 1 + (line - 1)/angles))
            allocate (of%ranges(0), of%passage(0))
         end associate
      end do
      if (present(stop)) ending = stop
      lines = size(chart%lines)
      call ending%open_batch('lines', lines)
      !$omp parallel do schedule(dynamic) private(i, k, line)
      do n = 1, lines
         if (ending%waiting()) cycle
         line = ending%next_item(n - 1, 1, lines)
         if (line > lines) cycle
         k = 1 + (line - 1)/angles
         i = line - (k - 1)*angles
         call scan_line(chart%h2(i), chart%h3(k), chart%h1, chart%lost(:, i, k), chart%index(:, i, k), &
                        chart%lines(i, k)%ranges, chart%lines(i, k)%passage, chart%pulse(:, :, i, k))
         associate (of => chart%lines(i, k))
            call ending%keep_item(line, [real(chart%lost(:, i, k), wp), chart%index(:, i, k), &
                                         reshape(chart%pulse(:, :, i, k), [pulse_numbers*radii]), &
                                         real(size(of%passage), wp), of%passage%from, of%passage%to, &
                                         of%ranges%from, of%ranges%to, real(of%ranges%minimum, wp)])
         end associate
      end do
      !$omp end parallel do
      call ending%close_batch()
      do line = 1, lines
         call ending%take_item(line, numbers)
         if (.not. allocated(numbers)) cycle
         k = 1 + (line - 1)/angles
         i = line - (k - 1)*angles
         chart%lost(:, i, k) = nint(numbers(:radii))
         chart%index(:, i, k) = numbers(radii + 1:2*radii)
         at = 2*radii
         chart%pulse(:, :, i, k) = reshape(numbers(at + 1:at + pulse_numbers*radii), [pulse_numbers, radii])
         at = at + pulse_numbers*radii + 1
         n = nint(numbers(at))
         chart%lines(i, k)%passage = [(loss_range_t(numbers(at + m), numbers(at + n + m), 1), m=1, n)]
         at = at + 2*n
         n = (size(numbers) - at)/3
         chart%lines(i, k)%ranges = [(loss_range_t(numbers(at + m), numbers(at + n + m), nint(numbers(at + 2*n + m))), m=1, n)]
      end do
   end subroutine make_chart

   !> One radial line: what becomes of contact at each H1, and the ranges within which it is lost, in ascending order: a line may
   !> cut the lost region more than once. What is narrower than the steps may be missed.
   subroutine scan_line(h2, h3, h1, lost, index, ranges, passage, pulses)
      real(wp), intent(in) :: h2, h3
      real(wp), intent(in) :: h1(:)             !! ascending
      integer, intent(out) :: lost(:)           !! the minimum at which contact is lost; 0: it is kept
      real(wp), intent(out) :: index(:)         !! of the impulse
      type(loss_range_t), allocatable, intent(out) :: ranges(:)
      type(loss_range_t), allocatable, intent(out) :: passage(:) !! ranges of a loss in the passage
      real(wp), intent(out), optional :: pulses(:, :) !! shape (pulse_numbers, h1), as of a chart
      type(flypast_t) :: here
      type(flight_t) :: flight
      type(passing_contact_t) :: passing
      type(passed_step_t), allocatable :: steps(:)
      type(contact_pulse_t) :: pulse
      type(pulse_shape_t) :: unused
      integer :: i

      lost = 0
      index = 0.0_wp
      if (present(pulses)) pulses = 0.0_wp
      do i = 1, size(h1)
         here = follow_flypast(h1(i), h2, h3, passing=passing, steps=steps)
         if (present(pulses)) then
            call find_pulse(passing, steps, pulse, unused)
            if (pulse%known) pulses(:, i) = [pulse%at, pulse%force, pulse%height, pulse%width, pulse%growth, pulse%decay, &
                                             pulse%impulse]
         end if
         if (here%lost) then
            lost(i) = here%at
            flight = fly(h1(i), h2, h3, here%loss)
            if (flight%ok) index(i) = flight%index
         end if
      end do
      call find_ranges(h2, h3, h1, lost, .false., ranges)
      call find_ranges(h2, h3, h1, lost, .true., passage)
   end subroutine scan_line

   !> Ranges of H1 within which contact is lost, or lost in the passage, from what becomes of it at the steps.
   subroutine find_ranges(h2, h3, h1, lost, in_passage, ranges)
      real(wp), intent(in) :: h2, h3, h1(:)
      integer, intent(in) :: lost(:)
      logical, intent(in) :: in_passage
      type(loss_range_t), allocatable, intent(out) :: ranges(:)
      real(wp) :: from, before
      integer :: i, was, here

      allocate (ranges(0))
      from = h1(1)
      before = h1(1)
      was = 0
      do i = 1, size(h1)
         here = lost(i)
         if (in_passage .and. here > 1) here = 0
         if (i > 1 .and. here > 0 .and. was == 0) then
            from = border(h2, h3, h1(i), before, in_passage)
         else if (here == 0 .and. was > 0) then
            ranges = [ranges, loss_range_t(from, border(h2, h3, before, h1(i), in_passage), was)]
         end if
         was = here
         before = h1(i)
      end do
      if (was > 0) ranges = [ranges, loss_range_t(from, h1(size(h1)), was)]
   end subroutine find_ranges

   !> True if contact is lost, or lost in the passage.
   pure logical function counts(flypast, in_passage)
      type(flypast_t), intent(in) :: flypast
      logical, intent(in) :: in_passage

      counts = flypast%lost .and. (.not. in_passage .or. flypast%at == 1)
   end function counts

   !> The H1 between one at which contact is lost and one at which it is kept where that changes, by bisection.
   real(wp) function border(h2, h3, losing, keeping, in_passage)
      real(wp), intent(in) :: h2, h3, losing, keeping
      logical, intent(in) :: in_passage         !! a loss in the passage
      type(flypast_t) :: here
      real(wp) :: lost, kept

      lost = losing
      kept = keeping
      do while (abs(kept - lost) > exactly*max(kept, lost))
         border = 0.5_wp*(lost + kept)
         here = follow_flypast(border, h2, h3)
         if (counts(here, in_passage)) then
            lost = border
         else
            kept = border
         end if
      end do
      border = 0.5_wp*(lost + kept)
   end function border

   !> The H1 beyond which contact is kept, up to 2; 0 if it is kept at all of them. A lost region narrower than a step of 0.05 may
   !> be missed.
   real(wp) function outermost_loss(h2, h3, in_passage) result(outermost)
      real(wp), intent(in) :: h2, h3
      logical, intent(in) :: in_passage         !! of losses in the passage alone
      type(flypast_t) :: here
      real(wp) :: low
      integer :: i

      outermost = 0.0_wp
      do i = 0, nint(farthest/scan) - 1
         low = farthest - scan*real(i, wp)
         here = follow_flypast(low, h2, h3)
         if (.not. counts(here, in_passage)) cycle
         outermost = border(h2, h3, low, low + scan, in_passage)
         return
      end do
   end function outermost_loss
end module psalm_flypast_chart
