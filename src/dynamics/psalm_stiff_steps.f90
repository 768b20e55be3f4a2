!> Steps of a stiff differential equation: the backward differentiation formulas of SUNDIALS' CVODE (orders 1 to 5).
!>
!> The library is loaded when it is asked for (psalm_cvode.c). A step may end anywhere: within the last one the state is that of its
!> polynomial. Where the equation goes on from another state than that of the last step, the method begins anew.
module psalm_stiff_steps
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_funloc, c_funptr, c_int, c_loc, c_null_ptr, c_ptr
   use psalm_kinds, only: wp
   use psalm_ode, only: ode_t
   implicit none (type, external)
   private
   public :: stiff_steps_t, stiff_steps_there

   real(wp), parameter :: unchecked = 1.0e30_wp    !! error that is allowed of an unknown without a say

   !> The equation in a step.
   type :: holder_t
      class(ode_t), pointer :: ode => null()
   end type holder_t

   !> An integration. `close` must be called when it is done with; it must not be copied.
   type :: stiff_steps_t
      private
      type(c_ptr) :: handle = c_null_ptr
      type(holder_t), pointer :: holder => null()
      real(wp) :: time = 0.0_wp                    !! where the last step ended
      real(c_double), allocatable :: y(:)          !! the state there
      real(c_double), allocatable :: allowed(:)    !! absolute errors
   contains
      procedure :: step
      procedure :: state
      procedure :: close => close_steps
   end type stiff_steps_t

   interface
      integer(c_int) function psalm_cvode_there() bind(c)
         import :: c_int
         implicit none (type, external)
      end function psalm_cvode_there

      type(c_ptr) function psalm_cvode_open(n, rates, user, time, y, relative, allowed) bind(c)
         import :: c_double, c_funptr, c_int, c_ptr
         implicit none (type, external)
         integer(c_int), value :: n
         type(c_funptr), value :: rates
         type(c_ptr), value :: user, y, allowed
         real(c_double), value :: time, relative
      end function psalm_cvode_open

      integer(c_int) function psalm_cvode_restart(integration, time) bind(c)
         import :: c_double, c_int, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: integration
         real(c_double), value :: time
      end function psalm_cvode_restart

      integer(c_int) function psalm_cvode_step(integration, end, time) bind(c)
         import :: c_double, c_int, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: integration
         real(c_double), value :: end
         real(c_double), intent(out) :: time
      end function psalm_cvode_step

      integer(c_int) function psalm_cvode_state(integration, time, y) bind(c)
         import :: c_double, c_int, c_ptr
         implicit none (type, external)
         type(c_ptr), value :: integration
         real(c_double), value :: time
         real(c_double), intent(inout) :: y(*)
      end function psalm_cvode_state

      subroutine psalm_cvode_close(integration) bind(c)
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), value :: integration
      end subroutine psalm_cvode_close
   end interface

contains

   !> The library is installed.
   logical function stiff_steps_there()

      stiff_steps_there = psalm_cvode_there() /= 0
   end function stiff_steps_there

   !> One step from a state, of any length up to `longest`. Errors: `made` is false where no step keeps the tolerance, or the
   !> equation has no derivatives.
   subroutine step(self, ode, time, y, longest, after, taken, made)
      class(stiff_steps_t), intent(inout), target :: self
      class(ode_t), intent(inout), target :: ode   !! its tolerance is relative; `tolerances` of nothing are the absolute ones
      real(wp), intent(in) :: time, y(:), longest
      real(wp), intent(out) :: after(:), taken
      logical, intent(out) :: made
      real(c_double) :: there

      after = y
      taken = 0.0_wp
      if (.not. associated(self%holder)) allocate (self%holder)
      self%holder%ode => ode
      made = begun()
      if (.not. made) return
      made = psalm_cvode_step(self%handle, real(time + longest, c_double), there) >= 0
      if (.not. made) return
      self%time = real(there, wp)
      after = real(self%y, wp)
      taken = self%time - time
      made = taken > 0.0_wp

   contains

      !> It goes on from the last step, or begins (anew) where it is not at this state.
      logical function begun()
         real(wp), allocatable :: allowed(:)

         begun = .true.
         if (.not. c_associated(self%handle)) then
            allowed = ode%tolerances(0.0_wp*y, 0.0_wp*y)
            self%allowed = real(min(allowed, unchecked), c_double)
            self%y = real(y, c_double)
            self%time = time
            self%handle = psalm_cvode_open(size(y, kind=c_int), c_funloc(rates_for_library), c_loc(self%holder), &
                                           real(time, c_double), c_loc(self%y), real(ode%tolerance, c_double), c_loc(self%allowed))
            begun = c_associated(self%handle)
            return
         end if
         ! changes within what is allowed, as of a joint that is put on its stop, are none
         if (.not. abs(self%time - time) > 0.0_wp .and. &
             all(abs(self%y - y) <= self%allowed + ode%tolerance*abs(y))) return
         self%y = real(y, c_double)
         begun = psalm_cvode_restart(self%handle, real(time, c_double)) == 0
      end function begun
   end subroutine step

   !> The state at a time within the last step.
   subroutine state(self, time, y)
      class(stiff_steps_t), intent(in) :: self
      real(wp), intent(in) :: time
      real(wp), intent(inout) :: y(:)              !! stays as it is where there is none
      real(c_double) :: there(size(y))

      if (psalm_cvode_state(self%handle, real(time, c_double), there) == 0) y = real(there, wp)
   end subroutine state

   subroutine close_steps(self)
      class(stiff_steps_t), intent(inout) :: self

      if (c_associated(self%handle)) call psalm_cvode_close(self%handle)
      if (associated(self%holder)) deallocate (self%holder)
      self%handle = c_null_ptr
   end subroutine close_steps

   !> Derivatives, as the library asks for them. 1: there are none, try a shorter step.
   integer(c_int) function rates_for_library(n, time, y, d, user) bind(c)
      integer(c_int), value :: n
      real(c_double), value :: time
      real(c_double), intent(in) :: y(n)
      real(c_double), intent(out) :: d(n)
      type(c_ptr), value :: user
      type(holder_t), pointer :: holder
      real(wp) :: rates(n)
      logical :: valid

      call c_f_pointer(user, holder)
      call holder%ode%rates(real(time, wp), real(y, wp), rates, valid)
      d = real(rates, c_double)
      rates_for_library = merge(0_c_int, 1_c_int, valid)
   end function rates_for_library
end module psalm_stiff_steps
