!> What a cam has to do to a linkage at a row of cam angles.
module psalm_cam_trace
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: cam_trace_t, clear_trace
   public :: fault_none, fault_reach, fault_dead_point, fault_open, fault_on_axis, fault_standstill

   integer, parameter :: fault_none = 0, fault_reach = 1 !! the output cannot be reached
   integer, parameter :: fault_dead_point = 2            !! the output stands still there
   integer, parameter :: fault_open = 3                  !! the linkage does not close, or is at a dead point of a loop
   integer, parameter :: fault_on_axis = 4               !! the roller's centre lies on the axis of a cam that turns
   integer, parameter :: fault_standstill = 5            !! the pitch curve stands still: no normal, so no profile

   !> Output, input and follower at a row of cam angles. Derivatives are by radians of cam; those of angles in radians.
   type :: cam_trace_t
      real(wp), allocatable :: angle(:)              !! cam angle, degrees
      real(wp), allocatable :: y(:, :)               !! shape (0:3, n): output, user's unit
      real(wp), allocatable :: q(:, :)               !! shape (0:3, n): input, degrees or length
      complex(wp), allocatable :: c(:, :)            !! shape (0:3, n): roller centre or point of the face, machine axes
      complex(wp), allocatable :: direction(:)       !! unit vector from FOLANG on: of the line from the arc's end to that point
      real(wp), allocatable :: turning(:, :)         !! shape (3, n): derivatives of its angle
      complex(wp), allocatable :: by_input(:)        !! dc/dq
      real(wp), allocatable :: turning_by_input(:)   !! of that angle
      integer, allocatable :: fault(:)               !! `fault_...`
   end type cam_trace_t

contains

   !> Zeros, at these cam angles.
   pure subroutine clear_trace(angle, states)
      real(wp), intent(in) :: angle(:)               !! degrees, shape (n)
      type(cam_trace_t), intent(out) :: states
      integer :: n

      n = size(angle)
      states%angle = angle
      allocate (states%y(0:3, n), states%q(0:3, n), states%turning(3, n), states%turning_by_input(n), source=0.0_wp)
      allocate (states%c(0:3, n), states%direction(n), states%by_input(n), source=(0.0_wp, 0.0_wp))
      allocate (states%fault(n), source=fault_none)
   end subroutine clear_trace
end module psalm_cam_trace
