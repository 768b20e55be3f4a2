!> What the output of a linkage can be (MOTION), and its components.
module psalm_output_kind
   implicit none (type, external)
   private
   public :: output_kind_t, output_kind
   public :: motion_point, motion_angle, motion_distance, motion_slide, motion_pose, most_components, most_rates

   integer, parameter :: motion_point = 0     !! MOTION 0: x and y of the output point
   integer, parameter :: motion_angle = 1     !! MOTION 1: angle of the output arc
   integer, parameter :: motion_distance = 2  !! MOTION 2: distance of the output point from the origin
   integer, parameter :: motion_slide = 3     !! MOTION 3: length of a sliding arc
   integer, parameter :: motion_pose = 4      !! MOTION 4: x and y of the output point and angle of the output arc

   integer, parameter :: most_components = 3
   integer, parameter :: most_rates = 2       !! orders of derivatives by the input that can be wanted

   !> What is the same for all outputs of a kind.
   type :: output_kind_t
      integer :: components = 1
      integer :: angle = 0             !! the component that is an angle, degrees; 0: none
      logical :: has_point = .false.   !! the place of the output point is wanted
      character(6) :: suffix(most_components) = '' !! of the columns of each component
   end type output_kind_t

   type(output_kind_t), parameter :: kinds(0:4) = [ &
      output_kind_t(2, 0, .true., [character(6) :: '_x', '_y', '']), &
      output_kind_t(1, 1), &
      output_kind_t(1, 0, .true.), &
      output_kind_t(1, 0), &
      output_kind_t(3, 3, .true., [character(6) :: '_x', '_y', '_angle'])]

contains

   !> What an output of a kind is like.
   pure type(output_kind_t) function output_kind(motion)
      integer, intent(in) :: motion  !! MOTION

      output_kind = kinds(motion)
   end function output_kind
end module psalm_output_kind
