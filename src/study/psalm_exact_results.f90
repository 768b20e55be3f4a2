!> Linkages that exact synthesis found: assessed, put in order, and what is proven of their motion.
module psalm_exact_results
   use psalm_burmester, only: dyad_slides, dyad_swings, pin_pair_t
   use psalm_defects, only: change_of_lengths, exact_linkage_t, verdict_t, assess, place_pins, with_other_driver
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: exact_result_t, exact_proof_t, pair_of, assessed, add_result, is_better, rank, keep_best, span_of

   !> A linkage found.
   type :: exact_result_t
      type(exact_linkage_t) :: linkage
      type(verdict_t) :: verdict
      real(wp) :: closure = 0.0_wp                   !! largest change of a length over the points, over the size of the path
   end type exact_result_t

   !> What is proven of the motion of a result.
   type :: exact_proof_t
      logical :: known = .false.                     !! it was looked at
      logical :: skipped = .false.                   !! the study was stopped before it was looked at
      logical :: turns = .false.                     !! it closes at every crank angle
      logical :: closes = .false.                    !! it closes at every crank angle between the positions
      real(wp) :: from = 0.0_wp, to = 0.0_wp         !! it closes from here to there, degrees from the first position
      logical :: transmits = .false.                 !! there is a transmission angle: not where a coupler slides in a block
      real(wp) :: transmission = 0.0_wp              !! its least value, degrees: over the turn, else between the positions
   end type exact_proof_t

contains

   !> Largest distance of points from the first.
   pure real(wp) function span_of(p)
      complex(wp), intent(in) :: p(:)

      span_of = maxval(abs(p - p(1)))
   end function span_of

   !> The linkage of two dyads, the first of which turns; a four-bar with the better driver.
   pure function pair_of(p, g, first, second, closed) result(own)
      complex(wp), intent(in) :: p(:), g(:)          !! shapes (poses), (poses - 1)
      type(pin_pair_t), intent(in) :: first, second
      logical, intent(in) :: closed
      type(exact_result_t) :: own
      type(exact_linkage_t) :: one

      one%p = p
      one%turn = [(1.0_wp, 0.0_wp), 1.0_wp + g]
      one%a = p(1) + first%pivot
      one%b = p(1) + second%pivot
      one%slides = second%kind == dyad_slides
      one%swings = second%kind == dyad_swings
      one%guide = second%guide
      if (one%slides) one%b = p(1) + second%pin
      call place_pins(p(1) + first%pin, p(1) + second%pin, one)
      own = assessed(one, .true., closed)
   end function pair_of

   !> A linkage as a result; with `either` it is driven where that is better.
   pure function assessed(one, either, closed) result(own)
      type(exact_linkage_t), intent(in) :: one
      logical, intent(in) :: either, closed
      type(exact_result_t) :: own
      type(exact_result_t) :: other
      real(wp) :: span

      own%linkage = one
      call assess(own%linkage, closed, own%verdict)
      if (either .and. .not. (one%slides .or. one%swings)) then
         other%linkage = with_other_driver(one)
         call assess(other%linkage, closed, other%verdict)
         if (is_better(other%verdict, own%verdict)) own = other
      end if
      span = span_of(one%p)
      own%closure = change_of_lengths(own%linkage)
      if (span > 0.0_wp) own%closure = own%closure/span
   end function assessed

   !> Append a result.
   pure subroutine add_result(own, results)
      type(exact_result_t), intent(in) :: own
      type(exact_result_t), allocatable, intent(inout) :: results(:)
      type(exact_result_t), allocatable :: more(:)

      allocate (more(size(results) + 1))
      more(:size(results)) = results
      more(size(more)) = own
      call move_alloc(more, results)
   end subroutine add_result

   !> True if the first is to be ranked before the second: class, then transmission angle, longest link, sensitivity.
   pure logical function is_better(first, second)
      type(verdict_t), intent(in) :: first, second

      if (first%class /= second%class) then
         is_better = first%class < second%class
      else if (abs(first%transmission - second%transmission) > 0.0_wp) then
         is_better = first%transmission > second%transmission
      else if (abs(first%longest - second%longest) > 0.0_wp) then
         is_better = first%longest < second%longest
      else
         is_better = first%sensitivity < second%sensitivity
      end if
   end function is_better

   !> Put results in their order.
   pure subroutine rank(results)
      type(exact_result_t), intent(inout) :: results(:)
      type(exact_result_t) :: one
      integer :: i, k

      do i = 2, size(results)
         one = results(i)
         k = i
         do while (k > 1)
            if (.not. is_better(one%verdict, results(k - 1)%verdict)) exit
            results(k) = results(k - 1)
            k = k - 1
         end do
         results(k) = one
      end do
   end subroutine rank

   !> Put a result into a list of the best, in their order.
   pure subroutine keep_best(one, most, kept)
      type(exact_result_t), intent(in) :: one
      integer, intent(in) :: most
      type(exact_result_t), allocatable, intent(inout) :: kept(:)
      type(exact_result_t), allocatable :: more(:)
      integer :: place, n

      n = size(kept)
      if (n == most) then
         if (.not. is_better(one%verdict, kept(n)%verdict)) return
         n = n - 1
      end if
      place = n + 1
      do while (place > 1)
         if (.not. is_better(one%verdict, kept(place - 1)%verdict)) exit
         place = place - 1
      end do
      allocate (more(n + 1))
      more(:place - 1) = kept(:place - 1)
      more(place) = one
      more(place + 1:) = kept(place:n)
      call move_alloc(more, kept)
   end subroutine keep_best
end module psalm_exact_results
