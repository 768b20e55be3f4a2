!> What an output can be, and its numbers: of a linkage of loops one of five kinds (MOTION), of a sketch one of nine (OUTPUTS).
module psalm_output_kind
   implicit none (type, external)
   private
   public :: output_kind_t, output_kind, kind_of_output
   public :: motion_point, motion_angle, motion_distance, motion_slide, motion_pose, most_components, most_rates
   public :: output_point, output_angle, output_distance, output_slide, output_between, output_pose, output_ratio
   public :: output_x, output_y

   integer, parameter :: motion_point = 0     !! MOTION 0: x and y of the output point
   integer, parameter :: motion_angle = 1     !! MOTION 1: angle of the output arc
   integer, parameter :: motion_distance = 2  !! MOTION 2: distance of the output point from the origin
   integer, parameter :: motion_slide = 3     !! MOTION 3: length of a sliding arc
   integer, parameter :: motion_pose = 4      !! MOTION 4: x and y of the output point and angle of the output arc

   integer, parameter :: output_point = 1    !! place of a joint: x and y
   integer, parameter :: output_angle = 2    !! direction of the line between two joints
   integer, parameter :: output_distance = 3 !! distance of two joints; of one joint from the machine origin
   integer, parameter :: output_slide = 4    !! travel along a slide
   integer, parameter :: output_between = 5  !! angle from one line to another
   integer, parameter :: output_pose = 6     !! place of a joint and direction of a line
   integer, parameter :: output_ratio = 7    !! ratio of the rates of two other outputs
   integer, parameter :: output_x = 8        !! x of a joint
   integer, parameter :: output_y = 9        !! y of a joint

   integer, parameter :: most_components = 3
   integer, parameter :: most_rates = 2       !! orders of derivatives by the input that can be wanted

   !> What is the same for all outputs of a kind.
   type :: output_kind_t
      integer :: components = 1
      integer :: angle = 0             !! the component that is an angle, degrees; 0: none
      logical :: has_point = .false.   !! the place of a point is wanted
      character(6) :: suffix(most_components) = '' !! of the columns of each component
   end type output_kind_t

   type(output_kind_t), parameter :: of_point = output_kind_t(2, 0, .true., [character(6) :: '_x', '_y', ''])
   type(output_kind_t), parameter :: of_angle = output_kind_t(1, 1)
   type(output_kind_t), parameter :: of_distance = output_kind_t(1, 0, .true.)
   type(output_kind_t), parameter :: of_length = output_kind_t(1, 0)
   type(output_kind_t), parameter :: of_pose = output_kind_t(3, 3, .true., [character(6) :: '_x', '_y', '_angle'])

   !> By MOTION.
   type(output_kind_t), parameter :: kinds(0:4) = [of_point, of_angle, of_distance, of_length, of_pose]
   !> By the kind of an output of a sketch; 0: it was not understood.
   type(output_kind_t), parameter :: sketch_kinds(0:9) = [of_length, of_point, of_angle, of_distance, of_length, of_angle, &
                                                          of_pose, of_length, of_distance, of_distance]

contains

   !> What an output of a kind is like.
   pure type(output_kind_t) function output_kind(motion)
      integer, intent(in) :: motion  !! MOTION

      output_kind = kinds(motion)
   end function output_kind

   !> What an output of a sketch is like.
   pure type(output_kind_t) function kind_of_output(output)
      integer, intent(in) :: output  !! one of `output_...`

      kind_of_output = sketch_kinds(output)
   end function kind_of_output
end module psalm_output_kind
