!> For which other programs models of a mechanism's bodies are written.
module psalm_robot_formats
   implicit none (type, external)
   private
   public :: robot_formats_t

   type :: robot_formats_t
      logical :: freecad = .false. !! FreeCAD
      logical :: mjcf = .false.    !! MuJoCo
      logical :: sdf = .false.     !! Gazebo
      logical :: urdf = .false.    !! ROS
   contains
      procedure :: any => any_format
      procedure :: options
   end type robot_formats_t

contains

   pure logical function any_format(self)
      class(robot_formats_t), intent(in) :: self

      any_format = self%mjcf .or. self%sdf .or. self%urdf .or. self%freecad
   end function any_format

   !> The options of the command line.
   pure function options(self) result(words)
      class(robot_formats_t), intent(in) :: self
      character(:), allocatable :: words

      words = ''
      if (self%mjcf) words = words//' --mjcf'
      if (self%sdf) words = words//' --sdf'
      if (self%urdf) words = words//' --urdf'
      if (self%freecad) words = words//' --freecad'
   end function options
end module psalm_robot_formats
