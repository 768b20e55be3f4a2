!> Every six-bar of a kind that generates a function through its precision points: found, followed over the motion, ranked.
module psalm_every_six_bar
   use psalm_kinds, only: wp
   use psalm_six_bar_loops, only: start_set_t
   use psalm_six_bar_motion, only: assess_motion, moving_six_bar_t
   use psalm_six_bar_paths, only: turns_at
   use psalm_six_bar_problem, only: data_of_angles, six_bar_data_t, six_bar_problem_t, &
                                    most_unknowns, stephenson_3, watt_2
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
      integer :: expected = 0                        !! solutions of the kind
      integer :: known = 0                           !! of the start set
      type(solutions_t) :: found
      integer, allocatable :: real_ones(:)           !! which of the ends are real
      integer :: by_input = 0, by_output = 0         !! real ones that meet all points on one branch, driven there
      integer :: over_range = 0                      !! of the first those that reach both ends of the range
      integer :: flat = 0, too_long = 0              !! of these those that are left out
      type(moving_six_bar_t), allocatable :: best(:) !! ranked
   end type every_six_bar_t

   !> Problems with a known number of solutions.
   type :: six_bar_kind_t
      integer :: type, points
      logical :: is_given(most_unknowns)
      integer :: solutions
   end type six_bar_kind_t

   logical, parameter :: y = .true., n = .false.
   !> Their numbers are computed by monodromy (psalm_six_bar_loops).
   type(six_bar_kind_t), parameter :: kinds(*) = [ &
      six_bar_kind_t(watt_2, 8, [n, n, n, n, n], 26370), &
      six_bar_kind_t(stephenson_3, 6, [y, n, n, n, y], 1286)]

contains

   !> Solutions of a kind of problem; 0: there is no start set for it.
   pure integer function solutions_of(problem)
      type(six_bar_problem_t), intent(in) :: problem
      integer :: k

      solutions_of = 0
      do k = 1, size(kinds)
         if (kinds(k)%type == problem%type .and. kinds(k)%points == problem%points .and. &
             all(kinds(k)%is_given .eqv. problem%is_given)) solutions_of = kinds(k)%solutions
      end do
   end function solutions_of

   !> Find all, and rank those without a defect that transmit well enough and have no link that is too long: of a function by the
   !> error over its range, of a table by the transmission angle.
   subroutine find_every_six_bar(problem, wanted, phi, psi, given, least_angle, longest, every, stop)
      type(six_bar_problem_t), intent(in) :: problem
      type(desired_function_t), intent(in) :: wanted
      real(wp), intent(in) :: phi(:), psi(:)         !! radians, shape (points + 1)
      complex(wp), intent(in) :: given(most_unknowns) !! numbers that are given, over the frame
      real(wp), intent(in) :: least_angle            !! transmission, degrees
      real(wp), intent(in) :: longest                !! link, over the frame
      type(every_six_bar_t), intent(out) :: every
      type(stop_t), intent(in) :: stop               !! asked now and then
      type(start_set_t) :: start
      type(moving_six_bar_t) :: one
      type(moving_six_bar_t), allocatable :: all_of_them(:)
      real(wp), allocatable :: keys(:)
      complex(wp) :: g(problem%points), h(problem%points)
      integer :: i, k

      every%problem = problem
      every%expected = solutions_of(problem)
      call data_of_angles(phi, psi, every%data)
      associate (n => problem%unknowns)
         where (problem%is_given(:n)) every%data%known(:n) = given(:n)
         every%data%known(n + 1:2*n) = conjg(every%data%known(:n))
      end associate
      call starts_of(problem, every%expected, stop, start)
      every%known = size(start%first, 2)
      allocate (every%best(0), every%real_ones(0), every%found%ends(2*problem%unknowns, 0))
      every%found%stopped = stop%waiting()
      if (every%found%stopped) return
      call solve_six_bar(start, every%data, every%found, stop)
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
      if (wanted%continuous) then
         keys = all_of_them(:k)%error
      else
         keys = -all_of_them(:k)%transmission
      end if
      every%best = all_of_them(ascending(keys))
   end subroutine find_every_six_bar
end module psalm_every_six_bar
