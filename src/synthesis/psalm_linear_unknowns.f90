!> Dimensions of a linkage that its output point hangs on linearly, solved for: place, size and direction of the whole, and the
!> output point on its link.
!>
!> Let J(t) be the joint that carries the output's link and u(t) the vector of unit length along OUTLK with OUTANG=0, in the complex
!> plane, computed with the pivot at the origin and any size and direction of the linkage. Then
!>
!>    P(t) = z0 + w1 J(t) + w2 u(t),
!>
!> and for given proportions and inputs the best z0, w1, w2 solve a least-squares problem. Written back, z0 is ORIGLK at ORIGNG; all
!> lengths are multiplied by abs(w1); the angles of the frame and the inputs, free ones or CRNKI, are turned by its argument, those
!> from which the turns of wheels in gear are counted by what their pairs make of it (`turn_of_phase`); w2
!> over that turn is OUTLK at OUTANG. No dyad is solved again. Whether the dimensions that vary allow it is tried on the given
!> linkage: enlarged and turned, it must move as the given one does. Source of the elimination: Golub and Pereyra (1973).
module psalm_linear_unknowns
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, full_turn, half_turn
   use psalm_mechanism, only: mechanism_t, arc_link, body_frame
   use psalm_output_kind, only: motion_point
   use psalm_parameters, only: variable_length, variable_outlk, variable_outang, variable_origlk, variable_origng, &
                               variable_gama, variable_crnki
   use psalm_path_fit, only: fitted_path_t, path_timing_t, set_points, fit_linear, square
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples, evaluate_output
   implicit none (type, external)
   private
   public :: linear_unknowns_t, prepare_linear_unknowns, solve_linear_unknowns, trace_linear

   integer, parameter :: fewest = 4                  !! points: three are met by any proportions
   real(wp), parameter :: trial_size = 1.25_wp, trial_turn = 37.0_wp !! of the linkage that is tried; degrees
   real(wp), parameter :: alike = 1.0e-9_wp          !! relative: it moves as the given one does
   real(wp), parameter :: least_change = 1.0e-6_wp   !! of the size, and its inverse the largest: beyond, J says nothing

   type :: linear_unknowns_t
      logical :: applies = .false.
      type(fitted_path_t) :: path                           !! the points
      type(path_timing_t) :: fit
      class(sample_set_t), allocatable :: samples        !! the linkage at its prescribed positions
      type(dimensions_t) :: dimensions
      logical :: free = .false.                      !! the inputs turn, else CRNKI
      integer :: outlk = 0, outang = 0, origlk = 0, origng = 0 !! variables
      logical, allocatable :: grows(:), turns(:)     !! shape (nvar): lengths, angles of the frame
      real(wp), allocatable :: times(:)              !! shape (nvar): of what turns, its turn by that of the whole
      complex(wp), allocatable :: joint(:), arm(:)   !! shape (positions): J, u
   end type linear_unknowns_t

contains

   !> See whether it applies, and get ready. `low` and `high` are bounds of the variables.
   subroutine prepare_linear_unknowns(problem, free, low, high, linear)
      type(problem_t), intent(in) :: problem         !! with desired values
      logical, intent(in) :: free                    !! free timing
      real(wp), intent(in) :: low(:), high(:)        !! shape (nvar)
      type(linear_unknowns_t), intent(out) :: linear
      complex(wp), allocatable :: joint(:), arm(:)
      real(wp), allocatable :: values(:)
      real(wp) :: c, s, far
      integer :: n, v

      n = problem%positions
      if (n < fewest .or. problem%motion /= motion_point .or. problem%mechanism%sliding_input) return
      if (any(abs(problem%weight(:n, 1) - problem%weight(:n, 2)) > 0.0_wp) .or. .not. any(problem%weight(:n, 1) > 0.0_wp)) return
      associate (variables => problem%parameters%variables)
         linear%outlk = findloc(variables%kind, variable_outlk, dim=1)
         linear%outang = findloc(variables%kind, variable_outang, dim=1)
         linear%origlk = findloc(variables%kind, variable_origlk, dim=1)
         linear%origng = findloc(variables%kind, variable_origng, dim=1)
         if (min(linear%outlk, linear%outang, linear%origlk, linear%origng) == 0) return
         linear%grows = variables%kind == variable_length
         linear%turns = [(variables(v)%kind == variable_gama, v=1, size(variables))]
         allocate (linear%times(size(variables)), source=1.0_wp)
         do v = 1, size(variables)
            if (linear%turns(v)) then
               ! one that hangs on another arc of the frame turns with that
               associate (arc => problem%mechanism%arcs(variables(v)%n))
                  linear%turns(v) = (arc%body == body_frame .and. arc%reference == 0) .or. arc%kind == arc_link
                  if (arc%kind == arc_link) linear%times(v) = turn_of_phase(problem%mechanism, variables(v)%n)
               end associate
            end if
            if (variables(v)%kind == variable_crnki) linear%turns(v) = .not. free
         end do
         if (.not. (free .or. any(variables%kind == variable_crnki))) return
      end associate
      linear%turns(linear%outang) = .true.
      linear%turns(linear%origng) = .true.
      ! halves: the difference of bounds that are none would overflow
      if (any(linear%turns .and. 0.5_wp*high - 0.5_wp*low < half_turn)) return
      linear%turns(linear%outang) = .false.
      linear%turns(linear%origng) = .false.
      call set_points(problem%wanted(:n, 1), problem%wanted(:n, 2), problem%weight(:n, 1), linear%path)
      allocate (linear%samples)
      allocate (linear%joint(n), linear%arm(n), source=(0.0_wp, 0.0_wp))
      call prepare_samples(problem, problem%delt, .false., reshape([integer ::], [2, 0]), .false., linear%samples)
      linear%samples%leading = n
      linear%dimensions = problem%given
      linear%free = free
      values = problem%parameters%first_values(problem%given)
      call look(linear, values, problem%delt)
      joint = linear%joint
      arm = linear%arm
      where (linear%grows) values = trial_size*values
      where (linear%turns) values = values + linear%times*trial_turn
      call look(linear, values, problem%delt + merge(trial_turn, 0.0_wp, free))
      call unit_vector(trial_turn, c, s)
      far = sqrt(maxval(square(linear%joint)))
      linear%applies = all(square(linear%joint - trial_size*cmplx(c, s, wp)*joint) <= (alike*far)**2) .and. &
                       all(square(linear%arm - cmplx(c, s, wp)*arm) <= alike**2)
   end subroutine prepare_linear_unknowns

   !> How far the direction turns, from which the turns of a wheel are counted, where all links but the frame turn by 1. In a tie
   !> the sum of factors times turns is zero.
   pure real(wp) function turn_of_phase(mechanism, arc) result(turn)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: arc                     !! of the wheel
      integer :: group, k, j

      turn = 1.0_wp
      do group = 1, mechanism%nloop
         if (.not. allocated(mechanism%groups(group)%ties)) cycle
         do k = 1, size(mechanism%groups(group)%ties)
            associate (tie => mechanism%groups(group)%ties(k))
               j = findloc(tie%arcs, arc, dim=1)
               if (j > 0 .and. tie%drive == 0) turn = sum(tie%factors, mask=tie%arcs > 0)/tie%factors(j)
            end associate
         end do
      end do
   end function turn_of_phase

   !> J and u of a linkage at its prescribed positions.
   subroutine look(linear, values, delt)
      type(linear_unknowns_t), intent(inout) :: linear
      real(wp), intent(in) :: values(:), delt(:)     !! shapes (nvar), (positions)

      call linear%samples%problem%move_inputs(delt)
      call trace_linear([linear%outlk, linear%outang, linear%origlk, linear%origng], values, linear%dimensions, linear%samples, &
                        linear%joint, linear%arm)
   end subroutine look

   !> J and u of a linkage at the positions of a set of samples.
   subroutine trace_linear(of_output, values, dimensions, samples, joint, arm)
      integer, intent(in) :: of_output(:)            !! the variables OUTLK, OUTANG, ORIGLK and ORIGNG
      real(wp), intent(in) :: values(:)              !! shape (nvar)
      type(dimensions_t), intent(inout) :: dimensions !! to work in
      type(sample_set_t), intent(inout) :: samples
      complex(wp), intent(inout) :: joint(:), arm(:) !! shape (positions of the samples)
      real(wp) :: bare(size(values))

      bare = values
      bare(of_output) = 0.0_wp
      call samples%problem%parameters%apply(bare, dimensions)
      call evaluate_samples(samples, dimensions)
      joint = cmplx(samples%out(:, 1), samples%out(:, 2), wp)
      dimensions%outlk = 1.0_wp
      call evaluate_output(samples, dimensions)
      arm = cmplx(samples%out(:, 1), samples%out(:, 2), wp) - joint
   end subroutine trace_linear

   !> Put the best place, size, direction and output point in. Nothing is changed where they would violate a bound.
   subroutine solve_linear_unknowns(linear, low, high, values, delt, solved)
      type(linear_unknowns_t), intent(inout) :: linear
      real(wp), intent(in) :: low(:), high(:)        !! shape (nvar)
      real(wp), intent(inout) :: values(:)           !! shape (nvar)
      real(wp), intent(inout) :: delt(:)             !! shape (positions): input increments; changed where timing is free
      logical, intent(out) :: solved
      complex(wp) :: w1, w2, z0
      real(wp) :: trial(size(values)), growth, turn
      integer :: v

      call look(linear, values, delt)
      call fit_linear(linear%path, linear%joint, linear%arm, linear%fit, 0.0_wp)
      w1 = linear%path%size*linear%fit%w1
      w2 = linear%path%size*linear%fit%w2
      z0 = linear%path%size*(linear%fit%z0 + linear%path%centre)
      growth = sqrt(square(w1))
      solved = growth > least_change .and. growth < 1.0_wp/least_change
      if (.not. solved) return
      turn = degrees_of(real(w1, wp), aimag(w1))
      w2 = w2*conjg(w1)/growth
      trial = values
      where (linear%grows) trial = growth*values
      where (linear%turns) trial = values + linear%times*turn
      trial(linear%origlk) = sqrt(square(z0))
      trial(linear%origng) = degrees_of(real(z0, wp), aimag(z0))
      trial(linear%outlk) = sqrt(square(w2))
      trial(linear%outang) = degrees_of(real(w2, wp), aimag(w2))
      do v = 1, size(trial)
         if (.not. (linear%turns(v) .or. v == linear%origng .or. v == linear%outang)) cycle
         trial(v) = trial(v) - full_turn*anint((trial(v) - values(v))/full_turn)
         if (trial(v) < low(v)) trial(v) = trial(v) + full_turn
         if (trial(v) > high(v)) trial(v) = trial(v) - full_turn
      end do
      solved = all(trial >= low .and. trial <= high)
      if (.not. solved) return
      values = trial
      if (linear%free) delt = delt + turn
   end subroutine solve_linear_unknowns
end module psalm_linear_unknowns
