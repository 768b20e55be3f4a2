!> Starts of a search with free timing for a four-bar whose crank turns fully, from `psalm_free_path`.
!>
!> It serves one loop of four links whose lengths, angle and place all vary, with a coupler point as output. How the loop's arcs
!> stand for ground, crank, coupler and follower is found by trying: a linkage made up is put into the arrays in every way, and the
!> way in which the program's coupler point goes through its points is the right one.
module psalm_free_start
   use psalm_angles, only: degrees_of
   use psalm_constraint_group, only: range_turn
   use psalm_dimensions, only: dimensions_t
   use psalm_dyad_kind, only: assur_rrr
   use psalm_error, only: problem_t
   use psalm_free_path, only: search_batch
   use psalm_kinds, only: wp, full_turn, half_turn
   use psalm_mechanism, only: arc_crank, arc_determined
   use psalm_merit, only: merit_t
   use psalm_output_kind, only: motion_point
   use psalm_parameters, only: variable_length, variable_outlk, variable_origlk, variable_gama, variable_outang, variable_origng, &
                               variable_crnki
   use psalm_path_fit, only: fitted_path_t, path_workspace_t, path_timing_t, prepare_path, trace_coupler, lengths_of, &
                             at_ground, at_crank, &
                             at_coupler, at_follower, at_point, at_pivot
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples
   use psalm_xoshiro, only: xoshiro_t
   implicit none (type, external)
   private
   public :: free_start_t, prepare_free_start, make_free_start

   real(wp), parameter :: exact = 1.0e-7_wp          !! relative: a linkage put into the arrays goes through its points
   real(wp), parameter :: kept = 1.0e-6_wp           !! relative violation below which a bound is kept

   type :: free_start_t
      logical :: applies = .false.
      type(fitted_path_t) :: path
      type(path_workspace_t), allocatable :: work
      type(path_timing_t) :: timing
      class(sample_set_t), allocatable :: samples        !! the user's linkage at the inputs of a timing
      integer :: of_length(6) = 0                    !! variables: lengths as `lengths_of` has them
      integer :: of_ground = 0, of_outang = 0, of_origng = 0 !! and angles
      real(wp) :: sense = 1.0_wp                     !! of the inputs; where they fall, the mirror image is searched
      real(wp) :: ground_turn = 0.0_wp, crank_turn = 0.0_wp !! degrees from canonical directions to those of the arcs
   end type free_start_t

contains

   !> See whether it applies, and get ready.
   subroutine prepare_free_start(problem, merit, starts)
      type(problem_t), intent(in) :: problem         !! with desired values
      type(merit_t), intent(in) :: merit
      type(free_start_t), intent(out) :: starts
      integer :: coupler, n, side
      logical :: exchanged, fits

      n = problem%positions
      if (.not. (merit%free .and. merit%ordered .and. merit%irange == range_turn) .or. n < 3) return
      if (allocated(merit%rates) .or. allocated(merit%targets)) return
      if (problem%motion /= motion_point .or. problem%mechanism%nloop /= 1 .or. problem%mechanism%sliding_input) return
      if (size(merit%clearances) > 0 .or. problem%mechanism%groups(1)%kind /= assur_rrr) return
      if (any(abs(problem%weight(:n, 1) - problem%weight(:n, 2)) > 0.0_wp) .or. .not. any(problem%weight(:n, 1) > 0.0_wp)) return
      call find_variables(problem, starts)
      if (any(starts%of_length == 0) .or. min(starts%of_ground, starts%of_outang, starts%of_origng) == 0) return
      associate (angles => [starts%of_ground, starts%of_outang, starts%of_origng])
         ! halves: the difference of bounds that are none would overflow
         if (any(0.5_wp*merit%high(angles) - 0.5_wp*merit%low(angles) < half_turn)) return
      end associate
      starts%sense = merit%sense
      allocate (starts%samples, starts%work)
      call prepare_samples(problem, problem%delt, .false., reshape([integer ::], [2, 0]), .false., starts%samples)
      ! which of both links is the coupler, and which assembly the program's is
      do coupler = 1, 2
         exchanged = coupler == 2
         if (exchanged) starts%of_length([at_coupler, at_follower]) = starts%of_length([at_follower, at_coupler])
         do side = 1, -1, -2
            call find_directions(problem, merit, real(side, wp), starts, fits)
            if (.not. fits) cycle
            associate (which => starts%of_length)
               call prepare_path(problem%wanted(:n, 1), starts%sense*problem%wanted(:n, 2), problem%weight(:n, 1), &
                                 merit%default_low(which), merit%default_high(which), merit%limit(1), &
                                 starts%sense*real(side, wp), starts%path, starts%work)
            end associate
            if (merit%limit(1) > 1.0_wp - 1.0e-6_wp) starts%path%cosine = 1.0_wp
            allocate (starts%timing%t(n), source=0.0_wp)
            starts%applies = .true.
            return
         end do
      end do
   end subroutine prepare_free_start

   !> The variables that are to stand for the linkage; one that is missing stays 0.
   subroutine find_variables(problem, starts)
      type(problem_t), intent(in) :: problem
      type(free_start_t), intent(inout) :: starts
      integer :: v, n

      do v = 1, size(problem%parameters%variables)
         n = problem%parameters%variables(v)%n
         select case (problem%parameters%variables(v)%kind)
         case (variable_length)
            if (problem%mechanism%arcs(n)%kind == arc_crank) then
               starts%of_length(at_crank) = v
            else if (problem%mechanism%arcs(n)%kind == arc_determined) then
               starts%of_length(at_ground) = v
            else if (problem%mechanism%arcs(n)%dyad == 1) then
               starts%of_length(at_coupler) = v
            else
               starts%of_length(at_follower) = v
            end if
         case (variable_gama)
            starts%of_ground = v
         case (variable_outlk)
            starts%of_length(at_point) = v
         case (variable_outang)
            starts%of_outang = v
         case (variable_origlk)
            starts%of_length(at_pivot) = v
         case (variable_origng)
            starts%of_origng = v
         case (variable_crnki)
            cycle ! the inputs are free
         end select
      end do
      if (problem%mechanism%loops(1)%arcs /= 4) starts%of_length = 0
   end subroutine find_variables

   !> In which directions ground and crank stand in the arrays, by a linkage that is made up.
   subroutine find_directions(problem, merit, side, starts, fits)
      type(problem_t), intent(in) :: problem
      type(merit_t), intent(in) :: merit
      real(wp), intent(in) :: side
      type(free_start_t), intent(inout) :: starts
      logical, intent(out) :: fits
      type(path_timing_t) :: made_up
      type(fitted_path_t) :: unit
      complex(wp) :: points(problem%positions), e(problem%positions), v(problem%positions)
      real(wp) :: values(size(problem%parameters%variables)), delt(problem%positions)
      integer :: i, ground, crank

      made_up%g = 2.3_wp
      made_up%sigma = 1.15_wp
      made_up%q = 0.31_wp
      made_up%side = side
      made_up%z0 = (0.3_wp, -0.2_wp)
      made_up%w1 = (0.7_wp, 0.4_wp)
      made_up%w2 = (0.5_wp, 0.6_wp)
      made_up%t = [(full_turn*(real(i, wp) - 0.3_wp)/real(size(points), wp), i=1, size(points))]
      call trace_coupler(made_up, made_up%t, e, v)
      points = made_up%z0 + made_up%w1*e + made_up%w2*v
      do ground = 0, 1
         do crank = 0, 1
            starts%ground_turn = half_turn*real(ground, wp)
            starts%crank_turn = half_turn*real(crank, wp)
            call put_in(problem, merit, made_up, lengths_of(unit, made_up), points, starts, values, delt, fits)
            if (fits) return
         end do
      end do
   end subroutine find_directions

   !> Values and input increments of a linkage that goes through these points; `fits` is false if the program's does not.
   subroutine put_in(problem, merit, timing, lengths, points, starts, values, delt, fits)
      type(problem_t), intent(in) :: problem
      type(merit_t), intent(in) :: merit
      type(path_timing_t), intent(in) :: timing             !! not mirrored: angles and `w1` are used
      real(wp), intent(in) :: lengths(6)             !! in the user's unit
      complex(wp), intent(in) :: points(:)           !! shape (positions)
      type(free_start_t), intent(inout) :: starts
      real(wp), intent(out) :: values(:), delt(:)    !! shapes (nvar), (positions)
      logical, intent(out) :: fits
      complex(wp) :: joint(size(points)), arm(size(points)), mean_arm, mean_rest, ratio, place
      type(dimensions_t) :: dimensions
      real(wp) :: direction
      integer :: n

      n = size(points)
      dimensions = problem%given
      values = problem%parameters%first_values(dimensions)
      direction = degrees_of(real(timing%w1, wp), aimag(timing%w1))
      values(starts%of_length) = lengths
      values(starts%of_ground) = direction + starts%ground_turn
      delt = direction + timing%t + starts%crank_turn - crank_of(values)
      delt = delt - full_turn*anint((delt(1) - problem%delt(1))/full_turn)
      values(starts%of_length(at_pivot)) = 0.0_wp
      values(starts%of_length(at_point)) = 0.0_wp
      values(starts%of_outang) = 0.0_wp
      call look(joint)
      values(starts%of_length(at_point)) = 1.0_wp
      call look(arm)
      arm = arm - joint
      ! points = place + joint + ratio*arm
      mean_arm = sum(arm)/real(n, wp)
      mean_rest = sum(points - joint)/real(n, wp)
      ratio = sum(conjg(arm - mean_arm)*(points - joint - mean_rest))/max(sum(squares(arm - mean_arm)), tiny(1.0_wp)**0.5_wp)
      place = mean_rest - ratio*mean_arm
      fits = all(squares(place + joint + ratio*arm - points) <= (exact*maxval(lengths))**2)
      fits = fits .and. abs(sqrt(squares(place)) - lengths(at_pivot)) <= exact*maxval(lengths) .and. &
             abs(sqrt(squares(ratio)) - lengths(at_point)) <= exact*maxval(lengths)
      values(starts%of_length(at_point)) = lengths(at_point)
      values(starts%of_length(at_pivot)) = lengths(at_pivot)
      values(starts%of_outang) = degrees_of(real(ratio, wp), aimag(ratio))
      values(starts%of_origng) = degrees_of(real(place, wp), aimag(place))
      call turn_in(starts%of_outang)
      call turn_in(starts%of_origng)
      call turn_in(starts%of_ground)

   contains

      !> CRNKI, which `delt` counts from.
      real(wp) function crank_of(values)
         real(wp), intent(in) :: values(:)

         call problem%parameters%apply(values, dimensions)
         crank_of = dimensions%crnki
      end function crank_of

      subroutine look(seen)
         complex(wp), intent(out) :: seen(:)

         call problem%parameters%apply(values, dimensions)
         call starts%samples%problem%move_inputs(delt)
         call evaluate_samples(starts%samples, dimensions)
         seen = cmplx(starts%samples%out(:, 1), starts%samples%out(:, 2), wp)
      end subroutine look

      !> An angle by whole turns to where its bounds are, or as near to zero as it can be.
      subroutine turn_in(v)
         integer, intent(in) :: v

         values(v) = values(v) - full_turn*anint(values(v)/full_turn)
         if (values(v) < merit%low(v)) values(v) = values(v) + full_turn*aint((merit%low(v) - values(v))/full_turn + 1.0_wp)
         if (values(v) > merit%high(v)) values(v) = values(v) - full_turn*aint((values(v) - merit%high(v))/full_turn + 1.0_wp)
      end subroutine turn_in
   end subroutine put_in

   elemental real(wp) function squares(z)
      complex(wp), intent(in) :: z

      squares = real(z, wp)**2 + aimag(z)**2
   end function squares

   !> One batch: its best linkage as values and input increments. `made` is false if it violates a bound.
   subroutine make_free_start(problem, merit, random, starts, values, delt, made)
      type(problem_t), intent(in) :: problem
      type(merit_t), intent(in) :: merit
      type(xoshiro_t), intent(inout) :: random
      type(free_start_t), intent(inout) :: starts
      real(wp), intent(out) :: values(:)             !! shape (nvar)
      real(wp), intent(out) :: delt(:)               !! shape (positions)
      logical, intent(out) :: made
      complex(wp) :: points(starts%path%n), e(starts%path%n), v(starts%path%n)
      real(wp) :: lengths(6)

      associate (timing => starts%timing, path => starts%path)
         call search_batch([path], random, starts%work, timing)
         call trace_coupler(timing, timing%t, e, v)
         points = path%size*(timing%z0 + path%centre + timing%w1*e + timing%w2*v)
         lengths = path%size*lengths_of(path, timing)
         made = timing%worst <= kept
         if (starts%sense < 0.0_wp) then
            points = conjg(points)
            timing%w1 = conjg(timing%w1)
            timing%t = -timing%t
         end if
         call put_in(problem, merit, timing, lengths, points, starts, values, delt, made)
         made = made .and. timing%worst <= kept
      end associate
   end subroutine make_free_start
end module psalm_free_start
