!> Six-bars with the least largest error over the range of a function, or over the entries of a table.
!>
!> An exact linkage is the start. All its numbers are free, those that were given for it too, and the direction of the output at the
!> reference: n complex numbers make 2 n + 1 parameters, so the error of an optimum alternates at 2 n + 2 places (of Watt II at
!> ten, of Stephenson at twelve). psalm_error_levelling looks for it; what is given here are the errors and their derivatives.
!> Linkages with a link that is too long, or a transmission angle that is too small, are kept out on the way; at such a limit an
!> optimum need not alternate.
module psalm_six_bar_minimax
   use psalm_desired_function, only: desired_function_t
   use psalm_error_levelling, only: error_family_t, level_errors
   use psalm_kinds, only: wp, pi, degrees_per_radian, radians_per_degree
   use psalm_six_bar_motion, only: assess_motion, go_to, leg_at, lengths_of, longest_of, moving_six_bar_t, settle, six_bar_place_t
   use psalm_six_bar_problem, only: most_unknowns, six_bar_problem_t
   implicit none (type, external)
   private
   public :: refine_six_bar

   integer, parameter :: legs = 2
   integer, parameter :: programs = 200              !! linear programs of a start at most
   integer, parameter :: corrections = 3             !! of each
   integer, parameter :: in_program = 201            !! points of each: all that the error is looked at
   integer, parameter :: looks = 21                  !! places at which the motion of an optimum is examined

   !> Six-bars that differ in their numbers.
   type, extends(error_family_t) :: six_bar_family_t
      type(six_bar_problem_t) :: problem
      type(desired_function_t) :: wanted
      real(wp) :: reference(2) = 0.0_wp              !! input and output there, radians
      real(wp) :: origin(2) = 0.0_wp                 !! input and output where the range begins
      real(wp) :: longest = huge(1.0_wp)             !! link, over the frame
      real(wp) :: least_sine = 0.0_wp                !! of the transmission angle
   contains
      procedure :: errors
      procedure :: runs_away
   end type six_bar_family_t

contains

   !> Make the largest error of a six-bar less, least if it alternates in the end. `refined`: it is less, and the linkage moves over
   !> the range on one branch; if not, `one` stays as it was.
   subroutine refine_six_bar(problem, wanted, longest, least_angle, one, refined)
      type(six_bar_problem_t), intent(in) :: problem
      type(desired_function_t), intent(in) :: wanted
      real(wp), intent(in) :: longest                !! link, over the frame
      real(wp), intent(in) :: least_angle            !! transmission, degrees
      type(moving_six_bar_t), intent(inout) :: one
      logical, intent(out) :: refined
      type(six_bar_family_t) :: family
      type(moving_six_bar_t) :: own
      type(six_bar_place_t) :: place
      real(wp) :: q(2*problem%unknowns + 1), at(2*problem%unknowns + 2), largest, before, middle
      real(wp), allocatable :: phi(:), psi(:)
      integer :: i
      logical :: levelled, reached

      family%problem = problem
      family%wanted = wanted
      family%reference = one%phi
      family%longest = longest
      family%corrections = corrections
      family%in_program = in_program
      family%least_sine = sin(least_angle*radians_per_degree)
      call family%wanted%prepare()
      if (.not. wanted%continuous) then
         call family%look_at(wanted%place_of([(i, i=1, size(wanted%table_input))]))
         family%origin = [wanted%table_input(1), wanted%table_output(1)]
      end if
      q = [real(one%x(:problem%unknowns), wp), aimag(one%x(:problem%unknowns)), 0.0_wp]
      call look(family, q, before, middle)
      call level_errors(family, programs, q, largest, at, levelled)
      ! what does not alternate was looked at in fewer places, and its zero line may be better
      call look(family, q, largest, middle)
      q(size(q)) = q(size(q)) - middle*radians_per_degree
      largest = largest - abs(middle)
      refined = largest < before
      if (.not. refined) return
      own = one
      own%x(:problem%unknowns) = numbers_of(family, q)
      own%phi(2) = one%phi(2) + q(size(q))
      ! from now on the reference is where the range begins
      if (wanted%continuous) then
         phi = wanted%input_at([(real(i - 1, wp)/real(looks - 1, wp), i=1, looks)])
      else
         phi = wanted%table_input
      end if
      allocate (psi(size(phi)))
      place%angle = own%phi
      associate (lengths => squares_of(problem, own))
         call settle(problem, own, lengths, 1, place, reached)
         if (reached) call go_to(problem, own, lengths, 1, phi(1), place, reached)
         refined = reached
         if (.not. refined) return
         own%x(problem%q) = own%x(problem%q)*cmplx(cos(place%turn), sin(place%turn), wp)
         own%phi = place%angle
         psi(1) = own%phi(2)
         place%turn = 0.0_wp
         do i = 2, size(phi)
            call go_to(problem, own, lengths, 1, phi(i), place, reached)
            refined = refined .and. reached
            if (.not. refined) return
            psi(i) = place%angle(2)
         end do
      end associate
      call assess_motion(problem, wanted, phi, psi, own)
      refined = own%over_range
      if (.not. refined) return
      own%error = largest*radians_per_degree
      own%before = before*radians_per_degree
      own%alternates = levelled
      one = own
   end subroutine refine_six_bar

   !> Largest error of some parameters and the mean of the greatest and the least, degrees: over many places of the range, or over
   !> the entries.
   pure subroutine look(family, q, largest, middle)
      type(six_bar_family_t), intent(in) :: family
      real(wp), intent(in) :: q(:)
      real(wp), intent(out) :: largest, middle
      integer, parameter :: points = 2001
      real(wp), allocatable :: at(:), error(:)
      integer :: i

      if (allocated(family%entries)) then
         at = family%entries
      else
         at = [(real(i - 1, wp)/real(points - 1, wp), i=1, points)]
      end if
      allocate (error(size(at)))
      call family%errors(q, at, error)
      largest = maxval(abs(error))
      middle = 0.5_wp*(maxval(error) + minval(error))
   end subroutine look

   !> Numbers of the linkage of some parameters: those of the output link turned by the direction of the output.
   pure function numbers_of(family, q) result(x)
      type(six_bar_family_t), intent(in) :: family
      real(wp), intent(in) :: q(:)
      complex(wp) :: x(family%problem%unknowns)
      integer :: k, n

      n = family%problem%unknowns
      x = cmplx(q(:n), q(n + 1:2*n), wp)
      do k = 1, n
         if (any(family%problem%b == k)) x(k) = x(k)*cmplx(cos(q(2*n + 1)), -sin(q(2*n + 1)), wp)
      end do
   end function numbers_of

   !> True if a link is longer than it may be.
   pure logical function runs_away(self, q)
      class(six_bar_family_t), intent(in) :: self
      real(wp), intent(in) :: q(:)

      type(moving_six_bar_t) :: one

      associate (n => self%problem%unknowns)
         one%x(:n) = cmplx(q(:n), q(n + 1:2*n), wp)
         one%phi = self%reference
         runs_away = longest_of(self%problem, one, squares_of(self%problem, one)) > self%longest
      end associate
   end function runs_away

   !> Errors in degrees: what the linkage that meets the reference turns its output by, and the last parameter, less what is wanted.
   pure subroutine errors(self, q, at, error, slopes)
      class(six_bar_family_t), intent(in) :: self
      real(wp), intent(in) :: q(:), at(:)
      real(wp), intent(out) :: error(:)
      real(wp), intent(out), optional :: slopes(:, :)
      type(moving_six_bar_t) :: one
      type(six_bar_place_t) :: first, place
      real(wp) :: lengths(legs), inputs(size(at)), away
      integer :: n, middle, i, side, last
      logical :: reached

      error = huge(1.0_wp)
      if (present(slopes)) slopes = 0.0_wp
      n = self%problem%unknowns
      one%x(:n) = cmplx(q(:n), q(n + 1:2*n), wp)
      one%phi = self%reference
      lengths = squares_of(self%problem, one)
      if (.not. all(lengths > 0.0_wp)) return
      first%angle = one%phi
      call settle(self%problem, one, lengths, 1, first, reached)
      if (.not. reached) return
      inputs = self%origin(1) + self%wanted%input_at(at)
      middle = count((inputs - one%phi(1))*self%wanted%swing_in < 0.0_wp)
      do side = -1, 1, 2
         place = first
         i = merge(middle, middle + 1, side < 0)
         last = merge(1, size(at), side < 0)
         do while (side*i <= side*last)
            call go_to(self%problem, one, lengths, 1, inputs(i), place, reached)
            if (.not. reached .or. place%sine < self%least_sine) exit
            away = place%angle(2) + q(2*n + 1) - self%origin(2) - self%wanted%output_at(at(i))
            error(i) = degrees_per_radian*(away - 2.0_wp*pi*anint(away/(2.0_wp*pi)))
            if (present(slopes)) call slopes_at(self%problem, one, place, slopes(:, i))
            i = i + side
         end do
      end do
   end subroutine errors

   !> Derivatives of the output at a place by the parameters, degrees: of the equations of both legs, in which turn and output
   !> are unknown.
   pure subroutine slopes_at(problem, one, place, slopes)
      type(six_bar_problem_t), intent(in) :: problem
      type(moving_six_bar_t), intent(in) :: one
      type(six_bar_place_t), intent(in) :: place
      real(wp), intent(out) :: slopes(:)             !! shape (2 unknowns + 1)
      complex(wp) :: e, f, t, e0, f0, z, z0, by(most_unknowns), by0(most_unknowns), change
      real(wp) :: by_turn(legs), by_output(legs), by_number(2*problem%unknowns, legs), determinant
      integer :: k, n

      n = problem%unknowns
      e = unit(place%angle(1))
      f = unit(place%angle(2))
      t = unit(place%turn)
      e0 = unit(one%phi(1))
      f0 = unit(one%phi(2))
      do k = 1, legs
         call leg_at(problem, one, k, e, f, t, z)
         call leg_at(problem, one, k, e0, f0, (1.0_wp, 0.0_wp), z0)
         by = (0.0_wp, 0.0_wp)
         by0 = (0.0_wp, 0.0_wp)
         if (problem%a(k) > 0) then
            by(problem%a(k)) = e
            by0(problem%a(k)) = e0
         end if
         if (problem%b(k) > 0) then
            by(problem%b(k)) = f
            by0(problem%b(k)) = f0
         end if
         if (problem%c(k) > 0) then
            by(problem%c(k)) = 1.0_wp
            by0(problem%c(k)) = 1.0_wp
         end if
         by(problem%q(k)) = t
         by0(problem%q(k)) = 1.0_wp
         ! |z|**2 less that at the reference
         by_number(:n, k) = 2.0_wp*real(conjg(z)*by(:n) - conjg(z0)*by0(:n), wp)
         by_number(n + 1:, k) = -2.0_wp*aimag(conjg(z)*by(:n) - conjg(z0)*by0(:n))
         change = t*one%x(problem%q(k))
         by_turn(k) = -2.0_wp*aimag(conjg(z)*change)
         change = (0.0_wp, 0.0_wp)
         if (problem%b(k) > 0) change = f*one%x(problem%b(k))
         by_output(k) = -2.0_wp*aimag(conjg(z)*change)
      end do
      determinant = by_turn(1)*by_output(2) - by_turn(2)*by_output(1)
      slopes(:2*n) = -degrees_per_radian*(by_turn(1)*by_number(:, 2) - by_turn(2)*by_number(:, 1))/determinant
      slopes(2*n + 1) = degrees_per_radian
   end subroutine slopes_at

   !> Squares of the lengths of both legs.
   pure function squares_of(problem, one) result(lengths)
      type(six_bar_problem_t), intent(in) :: problem
      type(moving_six_bar_t), intent(in) :: one
      real(wp) :: lengths(legs)

      call lengths_of(problem, one, lengths)
   end function squares_of

   elemental complex(wp) function unit(angle)
      real(wp), intent(in) :: angle

      unit = cmplx(cos(angle), sin(angle), wp)
   end function unit
end module psalm_six_bar_minimax
