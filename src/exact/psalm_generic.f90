!> All solutions of a generic problem of two legs: those kept in the source for what takes longest, else by monodromy.
module psalm_generic
   use psalm_generic_start, only: poses_line, poses_stored, slider_line, slider_stored
   use psalm_kinds, only: wp
   use psalm_leg_lanes, only: problem_path_t
   use psalm_leg_problem, only: draw_problem, kind_point, kind_pose, leg_problem_t, variables
   use psalm_monodromy, only: add_distinct, generic_t, solve_generic
   use psalm_start_text, only: characters_short, decode_short
   use psalm_stop, only: stop_t
   use psalm_tracker, only: polish
   use psalm_xoshiro, only: purpose_starts, xoshiro_t
   implicit none (type, external)
   private
   public :: generic_solutions, generic_seed

   integer, parameter :: generic_seed = 1            !! of the problems whose solutions are kept
   real(wp), parameter :: settled = 1.0e-11_wp       !! relative correction of a solution that was kept

contains

   !> Solutions of the generic problem that the seed draws; after a stop not all of them. Of a path alone one stands for its
   !> cognates, too.
   subroutine generic_solutions(problem, expected, generic, stop)
      type(leg_problem_t), intent(in) :: problem
      integer, intent(in) :: expected                !! 0: not known
      type(generic_t), intent(out) :: generic
      type(stop_t), intent(in), optional :: stop

      call load(problem, generic)
      if (expected > 0 .and. size(generic%solutions, 2) == expected) return
      call solve_generic(problem, generic_seed, problem%has_cognates(), expected, generic, stop)
   end subroutine generic_solutions

   !> Those that are kept, corrected; none if they are not there.
   subroutine load(problem, generic)
      type(leg_problem_t), intent(in) :: problem
      type(generic_t), intent(out) :: generic
      type(xoshiro_t) :: random
      type(problem_path_t) :: path
      complex(wp), allocatable :: kept(:, :)
      complex(wp) :: solution(variables)
      real(wp), allocatable :: left(:)
      integer :: i, n
      logical :: drawn, slider

      generic%problem = problem
      allocate (generic%solutions(variables, 0))
      associate (kinds => problem%kind(:problem%points))
         ! with so many points no pivot can be given
         slider = problem%slides
         if (slider) then
            if (problem%points /= 7 .or. any(kinds /= kind_point)) return
         else
            if (problem%points /= 6 .or. any(kinds(:2) /= kind_pose) .or. any(kinds(3:) /= kind_point)) return
         end if
      end associate
      call random%seed(generic_seed, purpose_starts)
      call draw_problem(problem, random, generic%data, solution, drawn)
      if (.not. drawn) return
      n = merge(slider_stored, poses_stored, slider)
      allocate (kept(variables, n), left(n))
      do i = 1, n
         if (slider) then
            kept(:, i) = solution_of(problem, slider_line(i))
         else
            kept(:, i) = solution_of(problem, poses_line(i))
         end if
      end do
      path%problem = problem
      path%from = generic%data
      path%to = generic%data
      call polish(path, kept, left)
      call add_distinct(problem, kept, left < settled, .false., generic%solutions)
   end subroutine load

   !> A solution from its text.
   pure function solution_of(problem, line) result(v)
      type(leg_problem_t), intent(in) :: problem
      character(*), intent(in) :: line
      complex(wp) :: v(variables)
      integer :: k, at

      v = (0.0_wp, 0.0_wp)
      do k = 1, problem%unknowns
         at = 2*(k - 1)*characters_short
         v(problem%free(k)) = cmplx(decode_short(line(at + 1:at + characters_short)), &
                                    decode_short(line(at + characters_short + 1:at + 2*characters_short)), wp)
      end do
   end function solution_of
end module psalm_generic
