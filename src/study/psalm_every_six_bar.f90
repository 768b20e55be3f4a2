!> Every six-bar of a kind that generates a function through its precision points: found, followed over the motion, ranked.
module psalm_every_six_bar
   use psalm_kinds, only: wp
   use psalm_six_bar_loops, only: start_set_t
   use psalm_six_bar_minimax, only: refine_six_bar
   use psalm_six_bar_motion, only: assess_motion, moving_six_bar_t
   use psalm_six_bar_paths, only: turns_at
   use psalm_six_bar_problem, only: data_of_angles, six_bar_data_t, six_bar_problem_t, &
                                    at_first_arm, at_q, most_unknowns, stephenson_2, stephenson_3, watt_2
   use psalm_six_bar_solutions, only: solutions_t, solve_six_bar
   use psalm_six_bar_starts, only: starts_of
   use psalm_sort, only: ascending
   use psalm_stop, only: stop_t
   use psalm_desired_function, only: desired_function_t
   implicit none (type, external)
   private
   public :: every_six_bar_t, find_every_six_bar

   real(wp), parameter :: conjugate_within = 1.0e-6_wp !! a number and its partner of a real solution, over 1 + their size
   real(wp), parameter :: modulus_within = 1.0e-5_wp   !! that of a turn and 1

   type :: every_six_bar_t
      type(six_bar_problem_t) :: problem
      type(six_bar_data_t) :: data
      integer :: expected = 0                        !! solutions of the kind, about so many if that is not certain
      logical :: certain = .true.                    !! that there are so many
      integer :: known = 0                           !! of the start set
      type(solutions_t) :: found
      integer, allocatable :: real_ones(:)           !! which of the ends are real
      integer :: by_input = 0, by_output = 0         !! real ones that meet all points on one branch, driven there
      integer :: over_range = 0                      !! of the first those that reach both ends of the range
      integer :: flat = 0, too_long = 0              !! of these those that are left out
      logical :: minimax = .false.                   !! the best were made with a largest error as small as could be
      integer :: unrefined = 0                       !! exact ones that led to nothing better
      type(moving_six_bar_t), allocatable :: best(:) !! ranked
   end type every_six_bar_t

   !> Problems with a known number of solutions.
   type :: six_bar_kind_t
      integer :: type, points
      logical :: is_given(most_unknowns)
      integer :: length_of
      integer :: solutions
      logical :: certain                             !! the number is the same for several seeds
   end type six_bar_kind_t

   logical, parameter :: y = .true., n = .false.
   !> Their numbers are computed by monodromy (psalm_six_bar_loops). Those that are not certain are estimates by loops through
   !> other problems: a part of the solutions known comes back to known ones.
   type(six_bar_kind_t), parameter :: kinds(*) = [ &
      six_bar_kind_t(watt_2, 8, [n, n, n, n, n], 0, 26370, y), &
      six_bar_kind_t(watt_2, 7, [n, n, n, n, n], at_q, 16908, y), &
      six_bar_kind_t(stephenson_3, 6, [y, n, n, n, y], 0, 1286, y), &
      six_bar_kind_t(stephenson_2, 7, [n, n, y, n, n], at_first_arm, 7324, y), &
      six_bar_kind_t(stephenson_3, 8, [n, n, n, n, y], 0, 117400, n), &
      six_bar_kind_t(stephenson_3, 10, [n, n, n, n, n], 0, 830300, n), &
      six_bar_kind_t(stephenson_2, 10, [n, n, n, n, n], 0, 760500, n)]
   real(wp), parameter :: same_error = 1.0e-6_wp     !! relative difference of two optima that are one

contains

   !> Solutions of a kind of problem; 0: there is no start set for it.
   pure subroutine solutions_of(problem, solutions, certain)
      type(six_bar_problem_t), intent(in) :: problem
      integer, intent(out) :: solutions
      logical, intent(out) :: certain
      integer :: k

      solutions = 0
      certain = .false.
      do k = 1, size(kinds)
         if (kinds(k)%type == problem%type .and. kinds(k)%points == problem%points .and. &
             kinds(k)%length_of == problem%length_of .and. all(kinds(k)%is_given .eqv. problem%is_given)) then
            solutions = kinds(k)%solutions
            certain = kinds(k)%certain
         end if
      end do
   end subroutine solutions_of

   !> Find all, and rank those without a defect that transmit well enough and have no link that is too long: of a function by the
   !> error over its range, of a table by the transmission angle. With `minimax` each is then changed until its largest error is
   !> least, and the list has the optima, ranked by it.
   subroutine find_every_six_bar(problem, wanted, phi, psi, given, least_angle, longest, minimax, threads, every, stop)
      type(six_bar_problem_t), intent(in) :: problem
      type(desired_function_t), intent(in) :: wanted
      real(wp), intent(in) :: phi(:), psi(:)         !! radians, shape (points + 1)
      complex(wp), intent(in) :: given(most_unknowns) !! numbers that are given, over the frame; of a length its square
      real(wp), intent(in) :: least_angle            !! transmission, degrees
      real(wp), intent(in) :: longest                !! link, over the frame
      logical, intent(in) :: minimax
      integer, intent(in) :: threads                 !! that share the paths; nothing found depends on it
      type(every_six_bar_t), intent(out) :: every
      type(stop_t), intent(in) :: stop               !! asked now and then
      type(start_set_t) :: start
      type(moving_six_bar_t) :: one
      type(moving_six_bar_t), allocatable :: all_of_them(:)
      real(wp), allocatable :: keys(:)
      complex(wp) :: g(problem%points), h(problem%points)
      integer :: i, k

      every%problem = problem
      call solutions_of(problem, every%expected, every%certain)
      call data_of_angles(phi, psi, every%data)
      associate (n => problem%unknowns)
         where (problem%is_given(:n)) every%data%known(:n) = given(:n)
         if (problem%length_of > 0) every%data%known(problem%length_of) = given(problem%length_of)
         every%data%known(n + 1:2*n) = conjg(every%data%known(:n))
      end associate
      call starts_of(problem, merge(every%expected, 0, every%certain), threads, stop, start)
      every%known = size(start%first, 2)
      allocate (every%best(0), every%real_ones(0), every%found%ends(2*problem%unknowns, 0))
      every%found%stopped = stop%waiting()
      if (every%found%stopped) return
      call solve_six_bar(start, every%data, every%certain, threads, every%found, stop)
      allocate (all_of_them(size(every%found%ends, 2)))
      k = 0
      do i = 1, size(every%found%ends, 2)
         associate (x => every%found%ends(:, i), m => problem%unknowns)
            if (any(abs(x(m + 1:) - conjg(x(:m))) > conjugate_within*(1.0_wp + abs(x(:m))))) cycle
            call turns_at(problem, every%data, x, g, h)
            if (any(abs(abs(1.0_wp + g) - 1.0_wp) > modulus_within)) cycle
            every%real_ones = [every%real_ones, i]
            one%x(:m) = 0.5_wp*(x(:m) + conjg(x(m + 1:)))
         end associate
         call assess_motion(problem, wanted, phi, psi, one)
         if (one%by_input) every%by_input = every%by_input + 1
         if (one%by_output) every%by_output = every%by_output + 1
         if (.not. one%over_range) cycle
         every%over_range = every%over_range + 1
         if (one%longest > longest) then
            every%too_long = every%too_long + 1
         else if (one%transmission < least_angle) then
            every%flat = every%flat + 1
         else
            k = k + 1
            all_of_them(k) = one
         end if
      end do
      every%minimax = minimax
      if (minimax) call refine_all(problem, wanted, least_angle, longest, all_of_them, k, every, stop)
      if (wanted%continuous .or. minimax) then
         keys = all_of_them(:k)%error
      else
         keys = -all_of_them(:k)%transmission
      end if
      every%best = all_of_them(ascending(keys))
   end subroutine find_every_six_bar

   !> Change exact linkages until their largest error is least; each optimum stays once. What a stop leaves is not refined.
   subroutine refine_all(problem, wanted, least_angle, longest, list, count, every, stop)
      type(six_bar_problem_t), intent(in) :: problem
      type(desired_function_t), intent(in) :: wanted
      real(wp), intent(in) :: least_angle, longest
      type(moving_six_bar_t), intent(inout) :: list(:)
      integer, intent(inout) :: count                !! of the list that are there
      type(every_six_bar_t), intent(inout) :: every
      type(stop_t), intent(in) :: stop
      type(moving_six_bar_t) :: one
      integer :: i, k
      logical :: refined

      k = 0
      do i = 1, count
         every%found%stopped = stop%waiting()
         if (every%found%stopped) exit
         one = list(i)
         call refine_six_bar(problem, wanted, longest, least_angle, one, refined)
         if (.not. refined) then
            every%unrefined = every%unrefined + 1
         else if (any(abs(list(:k)%error - one%error) < same_error*one%error)) then
            cycle
         else if (one%longest > longest) then
            every%too_long = every%too_long + 1
         else if (one%transmission < least_angle) then
            every%flat = every%flat + 1
         else
            k = k + 1
            list(k) = one
         end if
      end do
      count = k
   end subroutine refine_all
end module psalm_every_six_bar
