!> The solvers by their names: which family each belongs to and what it can do. Names are compared here and nowhere else.
!>
!> Data only: a program that reads a case needs no solver to understand its name. Those of NLopt are in the order of its
!> own list, from its versions 2.7 to 2.10; a library that lacks one of them refuses it when it is asked to search.
module psalm_solver_kind
   use psalm_text, only: upper_case
   implicit none (type, external)
   private
   public :: solver_kind_t, find_solver, solver_names, plain_name, family_unknown, family_simplex, family_least_squares, &
             family_nlopt, default_solver

   integer, parameter :: family_unknown = 0
   integer, parameter :: family_simplex = 1        !! the constrained simplex of the thesis
   integer, parameter :: family_least_squares = 2
   integer, parameter :: family_nlopt = 3

   character(*), parameter :: default_solver = 'SIMPLEX'
   integer, parameter :: name_length = 26            !! characters of the longest name

   character(name_length), parameter :: names(*) = [character(name_length) :: default_solver, 'LSQ', &
      'GN_DIRECT', 'GN_DIRECT_L', 'GN_DIRECT_L_RAND', 'GN_DIRECT_NOSCAL', 'GN_DIRECT_L_NOSCAL', 'GN_DIRECT_L_RAND_NOSCAL', &
      'GN_ORIG_DIRECT', 'GN_ORIG_DIRECT_L', 'GD_STOGO', 'GD_STOGO_RAND', 'LD_LBFGS_NOCEDAL', 'LD_LBFGS', 'LN_PRAXIS', &
      'LD_VAR1', 'LD_VAR2', 'LD_TNEWTON', 'LD_TNEWTON_RESTART', 'LD_TNEWTON_PRECOND', 'LD_TNEWTON_PRECOND_RESTART', &
      'GN_CRS2_LM', 'GN_MLSL', 'GD_MLSL', 'GN_MLSL_LDS', 'GD_MLSL_LDS', 'LD_MMA', 'LN_COBYLA', 'LN_NEWUOA', &
      'LN_NEWUOA_BOUND', 'LN_NELDERMEAD', 'LN_SBPLX', 'LN_AUGLAG', 'LD_AUGLAG', 'LN_AUGLAG_EQ', 'LD_AUGLAG_EQ', 'LN_BOBYQA', &
      'GN_ISRES', 'AUGLAG', 'AUGLAG_EQ', 'G_MLSL', 'G_MLSL_LDS', 'LD_SLSQP', 'LD_CCSAQ', 'GN_ESCH', 'GN_AGS']
   character(name_length), parameter :: with_constraints(*) = [character(name_length) :: 'LD_SLSQP', 'LD_MMA', 'LD_CCSAQ', &
      'LN_COBYLA', 'GN_ISRES', 'LN_AUGLAG', 'LD_AUGLAG', 'LN_AUGLAG_EQ', 'LD_AUGLAG_EQ', 'AUGLAG', 'AUGLAG_EQ']

   !> A solver.
   type :: solver_kind_t
      character(name_length) :: name = ''         !! as it is called; those of NLopt without NLOPT_
      integer :: family = family_unknown
      logical :: many_starts = .true.           !! searches from many starts, each by itself
      logical :: global = .false.               !! searches a box, every unknown needs finite bounds
      logical :: uses_gradient = .false.        !! asks for derivatives
      logical :: takes_constraints = .false.    !! takes nonlinear inequality constraints one by one
      logical :: calls_another = .false.        !! needs a local solver to do its work
      logical :: refines = .false.              !! can search roughly first, and on from the best
   end type solver_kind_t

contains

   !> The name as it is spelt here: capitals, without NLOPT_.
   pure function plain_name(name) result(plain)
      character(*), intent(in) :: name
      character(:), allocatable :: plain

      plain = upper_case(trim(name))
      if (index(plain, 'NLOPT_') == 1) plain = plain(7:)
   end function plain_name

   !> The solver of a name in any spelling; of `family_unknown` if there is none.
   pure function find_solver(name) result(kind)
      character(*), intent(in) :: name
      type(solver_kind_t) :: kind
      character(:), allocatable :: plain

      plain = plain_name(name)
      kind%name = plain
      if (.not. any(names == plain)) return
      select case (plain)
      case (default_solver)
         kind%family = family_simplex
         kind%many_starts = .false.
      case ('LSQ')
         kind%family = family_least_squares
         kind%refines = .true.
         kind%uses_gradient = .true.
      case default
         kind%family = family_nlopt
         kind%global = index(plain, 'G') == 1
         kind%uses_gradient = index(plain, 'LD_') == 1 .or. index(plain, 'GD_') == 1
         kind%takes_constraints = any(with_constraints == plain)
         kind%calls_another = index(plain, 'AUGLAG') > 0 .or. index(plain, 'MLSL') > 0
      end select
   end function find_solver

   !> All names.
   pure function solver_names() result(all_names)
      character(name_length) :: all_names(size(names))

      all_names = names
   end function solver_names
end module psalm_solver_kind
