!> Random starts in the box of a plain problem, improved by least squares: many starts without any linkage.
module climber
   use psalm_kinds, only: wp
   use psalm_least_squares, only: least_squares_t
   use psalm_multistart, only: candidate_t, starter_t
   use psalm_solver, only: ending_t
   use psalm_stop, only: stop_t
   use psalm_xoshiro, only: xoshiro_t
   use textbook, only: himmelblau_t
   implicit none (type, external)
   private
   public :: climber_t

   type, extends(starter_t) :: climber_t
      type(himmelblau_t) :: problem
      type(least_squares_t) :: solver
      type(xoshiro_t) :: random
   contains
      procedure :: start
      procedure :: refine
   end type climber_t

contains

   !> Every other start begins near a result of the rounds before, if there is one.
   subroutine start(self, number, elite, candidate)
      class(climber_t), intent(inout) :: self
      integer, intent(in) :: number
      real(wp), intent(in) :: elite(:, :)
      type(candidate_t), intent(inout) :: candidate
      real(wp) :: deviate
      integer :: v

      call self%random%use_stream(number)
      allocate (candidate%x(self%problem%core))
      do v = 1, self%problem%core
         call self%random%next(deviate)
         candidate%x(v) = self%problem%low(v) + deviate*(self%problem%high(v) - self%problem%low(v))
         if (size(elite, 2) > 0 .and. mod(number, 2) == 1) candidate%x(v) = elite(v, 1) + 0.1_wp*candidate%x(v)
      end do
      self%solver%least_gain = 1.0e-3_wp
      call climb(self, candidate)
   end subroutine start

   subroutine refine(self, thorough, candidate)
      class(climber_t), intent(inout) :: self
      logical, intent(in) :: thorough
      type(candidate_t), intent(inout) :: candidate

      self%solver%least_gain = merge(1.0e-9_wp, 1.0e-5_wp, thorough)
      call climb(self, candidate)
   end subroutine refine

   subroutine climb(self, candidate)
      class(climber_t), intent(inout) :: self
      type(candidate_t), intent(inout) :: candidate
      type(ending_t) :: ending
      type(stop_t) :: never

      call self%solver%minimise(self%problem, candidate%x, never, ending)
      candidate%objective = ending%objective
      candidate%feasible = ending%feasible
   end subroutine climb
end module climber
