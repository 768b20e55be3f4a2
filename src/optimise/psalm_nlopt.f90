!> NLopt, as far as the searches need it: an algorithm by its name, bounds, constraints, limits, a function to minimise.
!>
!> Source of the library: Johnson, The NLopt nonlinear-optimization package. Only C calls; NLopt's own Fortran interface has
!> no explicit types.
module psalm_nlopt
   use, intrinsic :: iso_c_binding, only: c_char, c_double, c_f_pointer, c_funloc, c_funptr, c_int, c_long, c_null_char, &
                                          c_null_ptr, c_associated, c_ptr
   use psalm_solver_kind, only: solver_kind_t
   implicit none (type, external)
   private
   public :: nlopt_t, refused

   integer, parameter :: invalid_arguments = -2, out_of_memory = -3 !! results of NLopt
   integer, parameter :: no_algorithm = -1

   !> An optimisation. `close` must be called when it is done with.
   type :: nlopt_t
      private
      type(c_ptr) :: handle = c_null_ptr
      integer :: unknowns = 0
   contains
      procedure :: open => open_optimiser
      procedure :: set_bounds
      procedure :: set_constraints
      procedure :: set_limits
      procedure :: minimise
      procedure :: force_stop
      procedure :: close => close_optimiser
   end type nlopt_t

   abstract interface
      !> Value and, where `gradient` is not null, gradient at x.
      real(c_double) function objective_function(n, x, gradient, data) bind(c)
         import :: c_double, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: n
         real(c_double), intent(in) :: x(n)
         type(c_ptr), value :: gradient, data
      end function objective_function

      !> Values of m constraints (<= 0) and, where `gradient` is not null, their gradients, that of each constraint together.
      subroutine constraint_function(m, values, n, x, gradient, data) bind(c)
         import :: c_double, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: m
         real(c_double), intent(out) :: values(m)
         integer(c_int), value :: n
         real(c_double), intent(in) :: x(n)
         type(c_ptr), value :: gradient, data
      end subroutine constraint_function
   end interface

   interface
      integer(c_int) function nlopt_algorithm_from_string(name) bind(c)
         import :: c_int, c_char
         implicit none (type, external)
         character(kind=c_char), intent(in) :: name(*)
      end function nlopt_algorithm_from_string

      type(c_ptr) function nlopt_create(algorithm, n) bind(c)
         import :: c_ptr, c_int
         implicit none (type, external)
         integer(c_int), value :: algorithm, n
      end function nlopt_create

      subroutine nlopt_destroy(opt) bind(c)
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), value :: opt
      end subroutine nlopt_destroy

      integer(c_int) function nlopt_set_min_objective(opt, f, data) bind(c)
         import :: c_int, c_ptr, c_funptr
         implicit none (type, external)
         type(c_ptr), value :: opt, data
         type(c_funptr), value :: f
      end function nlopt_set_min_objective

      integer(c_int) function nlopt_add_inequality_mconstraint(opt, m, f, data, tolerance) bind(c)
         import :: c_int, c_ptr, c_funptr, c_double
         implicit none (type, external)
         type(c_ptr), value :: opt, data
         integer(c_int), value :: m
         type(c_funptr), value :: f
         real(c_double), intent(in) :: tolerance(*)
      end function nlopt_add_inequality_mconstraint

      integer(c_int) function nlopt_set_lower_bounds(opt, bounds) bind(c)
         import :: c_int, c_ptr, c_double
         implicit none (type, external)
         type(c_ptr), value :: opt
         real(c_double), intent(in) :: bounds(*)
      end function nlopt_set_lower_bounds

      integer(c_int) function nlopt_set_upper_bounds(opt, bounds) bind(c)
         import :: c_int, c_ptr, c_double
         implicit none (type, external)
         type(c_ptr), value :: opt
         real(c_double), intent(in) :: bounds(*)
      end function nlopt_set_upper_bounds

      integer(c_int) function nlopt_set_ftol_rel(opt, value) bind(c)
         import :: c_int, c_ptr, c_double
         implicit none (type, external)
         type(c_ptr), value :: opt
         real(c_double), value :: value
      end function nlopt_set_ftol_rel

      integer(c_int) function nlopt_set_xtol_rel(opt, value) bind(c)
         import :: c_int, c_ptr, c_double
         implicit none (type, external)
         type(c_ptr), value :: opt
         real(c_double), value :: value
      end function nlopt_set_xtol_rel

      integer(c_int) function nlopt_set_maxeval(opt, value) bind(c)
         import :: c_int, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: opt
         integer(c_int), value :: value
      end function nlopt_set_maxeval

      integer(c_int) function nlopt_set_local_optimizer(opt, local) bind(c)
         import :: c_int, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: opt, local
      end function nlopt_set_local_optimizer

      integer(c_int) function nlopt_optimize(opt, x, least) bind(c)
         import :: c_int, c_ptr, c_double
         implicit none (type, external)
         type(c_ptr), value :: opt
         real(c_double), intent(inout) :: x(*)
         real(c_double), intent(out) :: least
      end function nlopt_optimize

      integer(c_int) function nlopt_force_stop(opt) bind(c)
         import :: c_int, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: opt
      end function nlopt_force_stop

      subroutine nlopt_srand(seed) bind(c)
         import :: c_long
         implicit none (type, external)
         integer(c_long), value :: seed
      end subroutine nlopt_srand
   end interface

contains

   !> NLopt's number of an algorithm, -1 if it knows no such name.
   integer function algorithm_of(name)
      character(*), intent(in) :: name    !! as `psalm_solver_kind` spells it

      algorithm_of = int(nlopt_algorithm_from_string(trim(name)//c_null_char))
      if (algorithm_of < 0) algorithm_of = no_algorithm
   end function algorithm_of

   !> A result that says that nothing was optimised.
   pure logical function refused(status)
      integer, intent(in) :: status

      refused = status == invalid_arguments .or. status == out_of_memory
   end function refused

   !> Make an optimiser ready. `valid` is false if the algorithm cannot be made.
   !>
   !> Random numbers (NLopt keeps them for each thread) start from `seed`. Algorithms that call another one get a local one: by
   !> gradients L-BFGS, otherwise Subplex.
   subroutine open_optimiser(self, kind, unknowns, seed, valid)
      class(nlopt_t), intent(inout) :: self
      type(solver_kind_t), intent(in) :: kind
      integer, intent(in) :: unknowns, seed
      logical, intent(out) :: valid
      type(c_ptr) :: local
      integer(c_int) :: status

      self%unknowns = unknowns
      self%handle = nlopt_create(int(algorithm_of(kind%name), c_int), int(unknowns, c_int))
      valid = c_associated(self%handle)
      if (.not. valid) return
      call nlopt_srand(int(seed, c_long))
      if (.not. kind%calls_another) return
      local = nlopt_create(int(algorithm_of(merge('LD_LBFGS', 'LN_SBPLX', kind%uses_gradient)), c_int), int(unknowns, c_int))
      status = nlopt_set_ftol_rel(local, 1.0e-8_c_double)
      status = nlopt_set_xtol_rel(local, 1.0e-8_c_double)
      status = nlopt_set_maxeval(local, int(500*(unknowns + 1), c_int))
      status = nlopt_set_local_optimizer(self%handle, local)
      call nlopt_destroy(local)
      valid = status > 0
   end subroutine open_optimiser

   !> Bounds of the unknowns; huge values stand for none.
   subroutine set_bounds(self, low, high, valid)
      class(nlopt_t), intent(inout) :: self
      real(c_double), intent(in) :: low(:), high(:)   !! shape (unknowns)
      logical, intent(out) :: valid

      valid = nlopt_set_lower_bounds(self%handle, low) > 0
      if (valid) valid = nlopt_set_upper_bounds(self%handle, high) > 0
   end subroutine set_bounds

   !> Inequality constraints, each <= 0.
   subroutine set_constraints(self, m, function, data, tolerance, valid)
      class(nlopt_t), intent(inout) :: self
      integer, intent(in) :: m
      procedure(constraint_function) :: function
      type(c_ptr), intent(in) :: data
      real(c_double), intent(in) :: tolerance
      logical, intent(out) :: valid

      valid = nlopt_add_inequality_mconstraint(self%handle, int(m, c_int), c_funloc(function), data, spread(tolerance, 1, m)) > 0
   end subroutine set_constraints

   !> When to stop: relative changes of the function and of the unknowns, evaluations.
   subroutine set_limits(self, ftol, xtol, evaluations)
      class(nlopt_t), intent(inout) :: self
      real(c_double), intent(in) :: ftol, xtol
      integer, intent(in) :: evaluations
      integer(c_int) :: status

      status = nlopt_set_ftol_rel(self%handle, ftol)
      status = nlopt_set_xtol_rel(self%handle, xtol)
      status = nlopt_set_maxeval(self%handle, int(evaluations, c_int))
   end subroutine set_limits

   !> Minimise from x. `status` is NLopt's result, positive if it stopped by a criterion.
   subroutine minimise(self, function, data, x, least, status)
      class(nlopt_t), intent(inout) :: self
      procedure(objective_function) :: function
      type(c_ptr), intent(in) :: data
      real(c_double), intent(inout) :: x(:)    !! shape (unknowns)
      real(c_double), intent(out) :: least
      integer, intent(out) :: status

      status = int(nlopt_set_min_objective(self%handle, c_funloc(function), data))
      if (status > 0) status = int(nlopt_optimize(self%handle, x, least))
   end subroutine minimise

   !> Make a running optimisation stop; to be called within its function.
   subroutine force_stop(self)
      class(nlopt_t), intent(in) :: self
      integer(c_int) :: status

      status = nlopt_force_stop(self%handle)
   end subroutine force_stop

   !> Give the optimiser's memory back.
   subroutine close_optimiser(self)
      class(nlopt_t), intent(inout) :: self

      if (c_associated(self%handle)) call nlopt_destroy(self%handle)
      self%handle = c_null_ptr
   end subroutine close_optimiser
end module psalm_nlopt
