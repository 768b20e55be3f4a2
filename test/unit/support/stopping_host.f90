!> A host that can end a study, for the tests.
module stopping_host
   use psalm_stop, only: stop_request_t
   implicit none (type, external)
   private
   public :: host_t

   type, extends(stop_request_t) :: host_t
      logical :: wants_end = .false.
   contains
      procedure :: asked
   end type host_t

contains

   !> What the test says.
   logical function asked(self)
      class(host_t), intent(in) :: self

      asked = self%wants_end
   end function asked
end module stopping_host
