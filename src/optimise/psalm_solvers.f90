!> A solver by its name: the factory.
module psalm_solvers
   use psalm_least_squares, only: least_squares_t
   use psalm_solver, only: solver_t
   use psalm_solver_kind, only: solver_kind_t, family_simplex, family_least_squares, family_nlopt
   implicit none (type, external)
   private
   public :: new_solver

contains

   !> Make a solver; not allocated, if there is none of that kind.
   subroutine new_solver(kind, solver)
      use psalm_simplx, only: simplex_solver_t
      use psalm_nlopt_solver, only: nlopt_solver_t
      type(solver_kind_t), intent(in) :: kind             !! by `find_solver`
      class(solver_t), allocatable, intent(out) :: solver

      select case (kind%family)
      case (family_simplex)
         allocate (simplex_solver_t :: solver)
      case (family_least_squares)
         allocate (least_squares_t :: solver)
      case (family_nlopt)
         allocate (solver, source=nlopt_solver_t(kind))
      end select
   end subroutine new_solver
end module psalm_solvers
