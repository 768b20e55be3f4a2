!> Where joints and slides of a sketch are to be found in the loops that describe it.
!>
!> A joint is a point of the plan, or fixed on a link at a distance from one; joints of the frame stand still.
module psalm_moving_joints
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: moving_t, sketch_motion_t

   !> A joint that moves.
   type :: moving_t
      integer :: joint = 0                  !! after the last joint of the sketch: points of its slides
      integer :: arc = 0                    !! sequential number: its direction carries the offset
      complex(wp) :: offset = (0.0_wp, 0.0_wp) !! from the point of the plan, in the axes of that arc, user's unit
   end type moving_t

   !> Where joints and slides of a sketch are to be found in the store.
   type :: sketch_motion_t
      complex(wp), allocatable :: drawn(:)  !! shape (joints), or joints and slides
      type(moving_t), allocatable :: moving(:)
      integer, allocatable :: points(:, :)  !! shape (2, moving joints): loop and arc, as `make_plan` has them
      integer, allocatable :: arcs(:)       !! by slide: sequential number; 0: it has none
      real(wp), allocatable :: sense(:), zero(:) !! by slide: travel = sense*length + zero
   end type sketch_motion_t
end module psalm_moving_joints
