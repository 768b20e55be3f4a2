!> An optimisation problem as every solver sees it: unknowns in bounds, an objective, constraints c(x) <= 0, a final verdict.
!>
!> The unknowns are x = (core, local): the core ones meet everything; each local one meets only residuals and constraints of
!> its own and no other local one, so that least squares can eliminate it by one division. A problem without such structure
!> has core unknowns only. Solvers work on the merit: objective + weight * sum of the squared violations.
!>
!> What a problem can do is said by `uses`: solvers refuse one that lacks what they need. `plain_nlp_t` is for problems whose
!> functions are simply written down.
module psalm_nlp
   use psalm_kinds, only: wp
   use psalm_linear, only: along_columns
   implicit none (type, external)
   private
   public :: nlp_t, plain_nlp_t, normal_equations_t, repair_count_t, failure_t, quarter, most_moves

   real(wp), parameter :: quarter = 0.25_wp        !! of the way towards a point that obeys
   integer, parameter :: most_moves = 60           !! 0.75**60 = 3e-8: the point has arrived
   real(wp), parameter :: slack = 1.0e-7_wp        !! constraints of a plain problem are aimed this far inside their limits
   real(wp), parameter :: unit_scale = 0.1_wp      !! of a change that is noticed, in sizes of an unknown whose scale is not given

   !> Halves of the first and second derivatives of the merit; of the second those that squares of first derivatives make.
   type :: normal_equations_t
      real(wp), allocatable :: matrix(:, :)          !! shape (core, core): J^T J
      real(wp), allocatable :: gradient(:)           !! shape (core): J^T r
      real(wp), allocatable :: border(:, :)          !! shape (core, local): core against local unknowns
      real(wp), allocatable :: edge(:), edge_gradient(:) !! shape (local): local ones against themselves, and their gradient
   contains
      procedure :: clear
   end type normal_equations_t

   !> How one constraint was violated, at worst.
   type :: failure_t
      integer :: times = 0             !! points that violated it
      integer :: kind = 0              !! in which way at worst: a number of the problem's own
      real(wp) :: amount = 0.0_wp      !! by how much, in its own unit
      real(wp) :: place = 0.0_wp       !! and where: of a linkage, its input
   end type failure_t

   !> What was done to points to make them obey.
   type :: repair_count_t
      integer :: calls = 0     !! violations met
      integer :: repairs = 0   !! repairs made
      integer :: moves = 0     !! quarter moves
      integer :: clips = 0     !! values put inside their bounds
      integer :: loop = 0      !! the constraint last violated: of a linkage, its loop
      type(failure_t), allocatable :: failures(:) !! by constraint, since the last iteration; not allocated: not noted
   end type repair_count_t

   type, abstract :: nlp_t
      integer :: core = 0                            !! unknowns that meet everything
      integer :: local = 0                           !! unknowns that meet their own residuals and constraints only
      real(wp), allocatable :: low(:), high(:)       !! shape (core): bounds; +-huge: none
      real(wp), allocatable :: scale(:)              !! shape (core + local): a change that is noticed; may be absent
      logical :: has_gradient = .false.              !! `linearise` gives gradients
      logical :: is_sum_of_squares = .false.         !! and the matrices of normal equations
      logical :: projects = .false.                  !! set by a solver: it calls `project` after every step; what that keeps is
                                                     !! no constraint then
      real(wp) :: floor = 0.0_wp                     !! an objective of rounding only
      real(wp) :: small = sqrt(tiny(1.0_wp))         !! objectives below it weigh violations as much as it does
      integer :: evaluations = 0, jacobians = 0      !! count up
      type(repair_count_t) :: counts                 !! of `settle`
   contains
      procedure(measure_i), deferred :: measure
      procedure :: linearise
      procedure :: count_constraints
      procedure :: constrain
      procedure(accept_i), deferred :: accept
      procedure :: project
      procedure :: fit_linear
      procedure :: settle
      procedure :: search_box
      procedure :: unknowns
      procedure :: scales
   end type nlp_t

   abstract interface
      !> Objective, and sum of the squared violations, at any x.
      subroutine measure_i(self, x, objective, violation)
         import :: nlp_t, wp
         implicit none (type, external)
         class(nlp_t), intent(inout) :: self
         real(wp), intent(in) :: x(:)                !! shape (core + local)
         real(wp), intent(out) :: objective, violation
      end subroutine measure_i

      !> The final verdict: does x, as it is, obey every constraint in the user's own terms? `objective` is the user's.
      subroutine accept_i(self, x, objective, feasible)
         import :: nlp_t, wp
         implicit none (type, external)
         class(nlp_t), intent(inout) :: self
         real(wp), intent(in) :: x(:)                !! shape (core + local)
         real(wp), intent(out) :: objective
         logical, intent(out) :: feasible
      end subroutine accept_i
   end interface

   !> A problem whose functions are written down: override `residuals_at` or `objective_at`, and `constraints_at` if there are
   !> constraints. All unknowns are core ones.
   type, abstract, extends(nlp_t) :: plain_nlp_t
      integer :: residuals = 0                       !! of a sum of squares; 0: `objective_at` gives the objective
      integer :: inequalities = 0                    !! constraints
   contains
      procedure :: residuals_at
      procedure :: objective_at
      procedure :: constraints_at
      procedure :: measure => measure_plain
      procedure :: linearise => linearise_plain
      procedure :: count_constraints => count_plain
      procedure :: constrain => constrain_plain
      procedure :: accept => accept_plain
   end type plain_nlp_t

contains

   !> Zeros, in room for so many unknowns.
   pure subroutine clear(self, core, local)
      class(normal_equations_t), intent(inout) :: self
      integer, intent(in) :: core, local

      if (allocated(self%gradient)) then
         if (size(self%gradient) /= core .or. size(self%edge) /= local) &
            deallocate (self%matrix, self%gradient, self%border, self%edge, self%edge_gradient)
      end if
      if (.not. allocated(self%gradient)) allocate (self%matrix(core, core), self%gradient(core), self%border(core, local), &
                                                    self%edge(local), self%edge_gradient(local))
      self%matrix = 0.0_wp
      self%gradient = 0.0_wp
      self%border = 0.0_wp
      self%edge = 0.0_wp
      self%edge_gradient = 0.0_wp
   end subroutine clear

   !> Number of all unknowns.
   pure integer function unknowns(self)
      class(nlp_t), intent(in) :: self

      unknowns = self%core + self%local
   end function unknowns

   !> A noticeable change of each unknown near x.
   pure function scales(self, x) result(change)
      class(nlp_t), intent(in) :: self
      real(wp), intent(in) :: x(:)                   !! shape (core + local)
      real(wp) :: change(size(x))

      if (allocated(self%scale)) then
         change = self%scale
      else
         change = unit_scale*max(abs(x), 1.0_wp)
      end if
   end function scales

   !> Gradient and, of a sum of squares, normal equations of objective + weight * violation. By itself a problem has none.
   subroutine linearise(self, x, weight, equations)
      class(nlp_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)                   !! shape (core + local)
      real(wp), intent(in) :: weight                 !! of the violations
      type(normal_equations_t), intent(inout) :: equations

      associate (unused_x => x, unused_weight => weight)
      end associate
      call equations%clear(self%core, self%local)
   end subroutine linearise

   !> How many constraints `constrain` gives.
   integer function count_constraints(self)
      class(nlp_t), intent(in) :: self

      associate (unused => self)
      end associate
      count_constraints = 0
   end function count_constraints

   !> Every constraint, aimed at <= 0, and with `slopes` its derivatives. By itself a problem has none.
   subroutine constrain(self, x, values, slopes)
      class(nlp_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)                   !! shape (core + local)
      real(wp), intent(out) :: values(:)             !! shape (count_constraints)
      real(wp), intent(out), optional :: slopes(:, :) !! shape (core + local, count_constraints)

      associate (unused => self, unused_x => x)
      end associate
      values = 0.0_wp
      if (present(slopes)) slopes = 0.0_wp
   end subroutine constrain

   !> Move x to the nearest point of a set that is easily met (an order, a sum). By itself a problem has no such set.
   subroutine project(self, x)
      class(nlp_t), intent(in) :: self
      real(wp), intent(inout) :: x(:)                !! shape (core + local)

      associate (unused => self, unchanged => x)
      end associate
   end subroutine project

   !> Give the unknowns that enter residuals linearly their best values for those of the others. By itself a problem has none.
   subroutine fit_linear(self, x)
      class(nlp_t), intent(inout) :: self
      real(wp), intent(inout) :: x(:)                !! shape (core + local)

      associate (unused => self, unchanged => x)
      end associate
   end subroutine fit_linear

   !> Make x obey, and give its objective. With `towards`, a point that obeys, it moves there by quarters until it does.
   subroutine settle(self, x, objective, feasible, towards)
      class(nlp_t), intent(inout) :: self
      real(wp), intent(inout) :: x(:)                !! shape (core + local)
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible
      real(wp), intent(in), optional :: towards(:)   !! shape (core + local)
      real(wp) :: clipped(self%core)
      integer :: moves

      do moves = 0, most_moves
         clipped = min(max(x(:self%core), self%low), self%high)
         self%counts%clips = self%counts%clips + count(abs(clipped - x(:self%core)) > 0.0_wp)
         x(:self%core) = clipped
         call self%accept(x, objective, feasible)
         if (feasible) return
         self%counts%calls = self%counts%calls + 1
         if (.not. present(towards)) return
         x = x + quarter*(towards - x)
         self%counts%moves = self%counts%moves + 1
      end do
      x = towards
      call self%accept(x, objective, feasible)
   end subroutine settle

   !> Where a global search looks. By itself it is what the bounds say; local unknowns have none.
   subroutine search_box(self, x, low, high)
      class(nlp_t), intent(in) :: self
      real(wp), intent(in) :: x(:)                   !! shape (core + local): where the search begins
      real(wp), intent(out) :: low(:), high(:)       !! shape (core + local)

      low = spread(-huge(1.0_wp), 1, size(x))
      high = spread(huge(1.0_wp), 1, size(x))
      low(:self%core) = self%low
      high(:self%core) = self%high
   end subroutine search_box

   ! ---- problems whose functions are written down ---------------------------------------------------------------------

   !> Residuals of a sum of squares, and their derivatives. To be overridden where `residuals` > 0.
   subroutine residuals_at(self, x, r, jacobian)
      class(plain_nlp_t), intent(in) :: self
      real(wp), intent(in) :: x(:)                   !! shape (core)
      real(wp), intent(out) :: r(:)                  !! shape (residuals)
      real(wp), intent(out), optional :: jacobian(:, :) !! shape (residuals, core)

      associate (unused => self, unused_x => x)
      end associate
      r = 0.0_wp
      if (present(jacobian)) jacobian = 0.0_wp
   end subroutine residuals_at

   !> Objective and its gradient. By itself the sum of the squared residuals.
   subroutine objective_at(self, x, f, gradient)
      class(plain_nlp_t), intent(in) :: self
      real(wp), intent(in) :: x(:)                   !! shape (core)
      real(wp), intent(out) :: f
      real(wp), intent(out), optional :: gradient(:) !! shape (core)
      real(wp) :: r(self%residuals), jacobian(self%residuals, size(x))

      if (present(gradient)) then
         call self%residuals_at(x, r, jacobian)
         gradient = 2.0_wp*along_columns(jacobian, r)
      else
         call self%residuals_at(x, r)
      end if
      f = sum(r**2)
   end subroutine objective_at

   !> Constraints c(x) <= 0 and their derivatives. To be overridden where `inequalities` > 0.
   subroutine constraints_at(self, x, c, slopes)
      class(plain_nlp_t), intent(in) :: self
      real(wp), intent(in) :: x(:)                   !! shape (core)
      real(wp), intent(out) :: c(:)                  !! shape (inequalities)
      real(wp), intent(out), optional :: slopes(:, :) !! shape (core, inequalities)

      associate (unused => self, unused_x => x)
      end associate
      c = 0.0_wp
      if (present(slopes)) slopes = 0.0_wp
   end subroutine constraints_at

   subroutine measure_plain(self, x, objective, violation)
      class(plain_nlp_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: objective, violation
      real(wp) :: c(self%inequalities)

      self%evaluations = self%evaluations + 1
      call self%objective_at(x, objective)
      call self%constraints_at(x, c)
      violation = sum(max(c + slack, 0.0_wp)**2)
   end subroutine measure_plain

   subroutine linearise_plain(self, x, weight, equations)
      class(plain_nlp_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(in) :: weight
      type(normal_equations_t), intent(inout) :: equations
      real(wp) :: c(self%inequalities), slopes(size(x), self%inequalities)
      real(wp) :: r(self%residuals), jacobian(self%residuals, size(x))
      real(wp) :: objective
      integer :: i, a

      self%jacobians = self%jacobians + 1
      call equations%clear(self%core, self%local)
      if (self%residuals > 0) then
         call self%residuals_at(x, r, jacobian)
         equations%gradient = along_columns(jacobian, r)
         do a = 1, size(x)
            equations%matrix(:, a) = along_columns(jacobian, jacobian(:, a))
         end do
      else
         call self%objective_at(x, objective, equations%gradient)
         equations%gradient = 0.5_wp*equations%gradient
      end if
      call self%constraints_at(x, c, slopes)
      do i = 1, size(c)
         if (c(i) + slack <= 0.0_wp) cycle
         equations%gradient = equations%gradient + weight*(c(i) + slack)*slopes(:, i)
         do a = 1, size(x)
            equations%matrix(:, a) = equations%matrix(:, a) + weight*slopes(a, i)*slopes(:, i)
         end do
      end do
   end subroutine linearise_plain

   integer function count_plain(self)
      class(plain_nlp_t), intent(in) :: self

      count_plain = self%inequalities
   end function count_plain

   subroutine constrain_plain(self, x, values, slopes)
      class(plain_nlp_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: values(:)
      real(wp), intent(out), optional :: slopes(:, :)

      if (present(slopes)) self%jacobians = self%jacobians + 1
      call self%constraints_at(x, values, slopes)
      values = values + slack
   end subroutine constrain_plain

   !> Bounds and constraints are kept.
   subroutine accept_plain(self, x, objective, feasible)
      class(plain_nlp_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible
      real(wp) :: c(self%inequalities)

      self%evaluations = self%evaluations + 1
      call self%objective_at(x, objective)
      call self%constraints_at(x, c)
      feasible = all(c <= 0.0_wp) .and. all(x >= self%low .and. x <= self%high)
   end subroutine accept_plain
end module psalm_nlp
