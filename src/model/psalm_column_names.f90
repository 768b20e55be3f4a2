!> How the quantities of a linkage are called in tables, wherever a table has them, and in which units.
!>
!> | column | quantity | on device 9 of a linkage of loops |
!> | --- | --- | --- |
!> | `position` | number of a position | |
!> | `input`, `input.DRIVE` | input; of one drive, of several | |
!> | `crank_angle`, `crank_angle.DRIVE` | angle of the first drive's crank from the x axis | |
!> | `closed` | 1: the linkage closes there | |
!> | `output`, `output.x` `.y` `.angle` | output of a linkage of loops | `actual`, `actual_x` ... |
!> | `NAME`, `NAME.x` `.y` `.angle` | an output of a sketch | |
!> | `desired`, `desired.x` ... | its desired value | `desired`, `desired_x` ... |
!> | `JOINT.x` `.y` | place of a joint of a sketch; `.vx .vy .ax .ay` its rates by time | |
!> | `OUTPUT.v` `.a` `.j` | first to third derivative by time | `actual_per_s`, `actual_per_s2` ..., of points `x_per_s` ... |
!> | `OUTPUT.first` `.second` `.third` | derivatives by the input | `actual_per_rad` ..., of points `x_per_rad`; in the block
!> `derivatives` `actual_x_per_rad` |
!> | `before.x` `.y`, `after.x` `.y` | load that springs are to lessen | `before`, `after`, both components |
!>
!> This module is the one place for these names and for those that device 9 keeps from the time when it was the only table.
module psalm_column_names
   use psalm_output_kind, only: output_kind_t, kind_of_output, output_ratio
   use psalm_sketch, only: sketch_t, sketch_output_t, first_number, drive_turns
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: input_name, closed_name, position_name, output_name, desired_name, joint_name, by_time, by_input, per_time, per_input
   public :: condition_name, crank_name, target_name
   public :: plotted_output, plotted_desired, plotted_component, plotted_rate, plotted_load
   public :: input_unit, drive_unit, output_unit, rate_unit, number_unit

   character(*), parameter :: closed_name = 'closed', position_name = 'position', condition_name = 'condition'

   integer, parameter :: most_orders = 3
   character(*), parameter :: of_time(0:most_orders) = [character(2) :: '', '.v', '.a', '.j']
   character(*), parameter :: of_input(0:most_orders) = [character(7) :: '', '.first', '.second', '.third']
   character(*), parameter :: of_joint(0:2) = [character(1) :: '', 'v', 'a']

contains

   !> Column of a drive: `input`; of several `input.NAME`, of several at one joint `input.NAME.BASE-LINK`.
   pure function input_name(sketch, drive) result(name)
      type(sketch_t), intent(in), optional :: sketch   !! none: a linkage of loops
      integer, intent(in), optional :: drive
      character(:), allocatable :: name

      name = 'input'
      if (present(sketch)) name = name//of_drive(sketch, drive)
   end function input_name

   !> The angle of the first drive's crank from the x axis, beside inputs that count from the drawing: `crank_angle`, of several
   !> drives with the name of the first.
   pure function crank_name(sketch) result(name)
      type(sketch_t), intent(in), optional :: sketch   !! none: a linkage of loops
      character(:), allocatable :: name

      name = 'crank_angle'
      if (present(sketch)) name = name//of_drive(sketch, 1)
   end function crank_name

   !> What tells the column of a drive from those of others; of one drive nothing.
   pure function of_drive(sketch, drive) result(ending)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: drive
      character(:), allocatable :: ending
      integer :: i

      ending = ''
      if (size(sketch%drives) <= 1) return
      ending = '.'//sketch%drive_label(drive)
      do i = 1, len(ending)
         if (ending(i:i) == ' ') ending(i:i) = '-'
      end do
   end function of_drive

   !> A component of the output of a linkage of loops.
   pure function output_name(kind, component) result(name)
      type(output_kind_t), intent(in) :: kind
      integer, intent(in) :: component
      character(:), allocatable :: name

      name = with_component('output', kind, component)
   end function output_name

   !> What it is to be.
   pure function desired_name(kind, component) result(name)
      type(output_kind_t), intent(in) :: kind
      integer, intent(in) :: component
      character(:), allocatable :: name

      name = with_component('desired', kind, component)
   end function desired_name

   !> What a number of an output of a sketch, or a derivative of it, is to be.
   pure function target_name(name) result(desired)
      character(*), intent(in) :: name         !! of its column
      character(:), allocatable :: desired

      desired = name//'.desired'
   end function target_name

   pure function with_component(word, kind, component) result(name)
      character(*), intent(in) :: word
      type(output_kind_t), intent(in) :: kind
      integer, intent(in) :: component
      character(:), allocatable :: name

      name = word
      if (kind%components > 1) name = word//'.'//trim(kind%suffix(component)(2:))
   end function with_component

   !> A coordinate of a joint, or one of its rates by time.
   pure function joint_name(joint, order, axis) result(name)
      character(*), intent(in) :: joint
      integer, intent(in) :: order             !! 0 to 2
      character(1), intent(in) :: axis         !! x or y
      character(:), allocatable :: name

      name = trim(joint)//'.'//trim(of_joint(order))//axis
   end function joint_name

   !> A derivative by time of the quantity with a name.
   pure function by_time(name, order) result(rate)
      character(*), intent(in) :: name
      integer, intent(in) :: order             !! 0 to 3
      character(:), allocatable :: rate

      rate = trim(name)//trim(of_time(order))
   end function by_time

   !> A derivative by the input.
   pure function by_input(name, order) result(rate)
      character(*), intent(in) :: name
      integer, intent(in) :: order             !! 0 to 3
      character(:), allocatable :: rate

      rate = trim(name)//trim(of_input(order))
   end function by_input

   ! ---- units -------------------------------------------------------------------------------------------------------

   pure function input_unit(sliding) result(unit)
      logical, intent(in) :: sliding
      character(:), allocatable :: unit

      unit = trim(merge('length', 'deg   ', sliding))
   end function input_unit

   !> Unit of the input of a drive of a sketch, counted from the drawing; with `by` what rates by it are per.
   pure function drive_unit(sketch, drive, by) result(unit)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: drive
      logical, intent(in), optional :: by
      character(:), allocatable :: unit

      associate (slides => sketch%drives(drive)%kind /= drive_turns)
         unit = input_unit(slides)
         if (present(by)) unit = per_input(slides)
      end associate
   end function drive_unit

   !> Unit of a component: angles are in degrees.
   pure function output_unit(angle) result(unit)
      logical, intent(in) :: angle
      character(:), allocatable :: unit

      unit = trim(merge('deg   ', 'length', angle))
   end function output_unit

   !> Unit of its derivative: angles are in radians then. `per` is `per_time` or `per_input`.
   pure function rate_unit(angle, per, order) result(unit)
      logical, intent(in) :: angle
      character(*), intent(in) :: per
      integer, intent(in) :: order             !! 0: of the component itself
      character(:), allocatable :: unit

      unit = output_unit(angle)
      if (order == 0) return
      if (angle) unit = 'rad'
      unit = unit//'/'//per
      if (order > 1) unit = unit//'^'//to_text(order)
   end function rate_unit

   !> Unit of a number of the outputs of a sketch or of its derivative; of a ratio that of one rate by the other.
   pure function number_unit(outputs, number, per, order) result(unit)
      type(sketch_output_t), intent(in) :: outputs(:)
      integer, intent(in) :: number            !! counted through all outputs
      character(*), intent(in) :: per          !! `per_time` or `per_input`
      integer, intent(in) :: order
      character(:), allocatable :: unit
      integer :: k

      do k = 1, size(outputs) - 1
         if (first_number(outputs, k + 1) > number) exit
      end do
      if (outputs(k)%kind /= output_ratio) then
         associate (kind => kind_of_output(outputs(k)%kind), component => number - first_number(outputs, k) + 1)
            unit = rate_unit(component == kind%angle, per, order)
         end associate
         return
      end if
      unit = ''
      associate (above => turns(outputs(k)%outputs(1)), below => turns(outputs(k)%outputs(2)))
         if (above .and. .not. below) unit = 'rad/length'
         if (below .and. .not. above) unit = 'length/rad'
      end associate
      if (order == 0) return
      if (len(unit) == 0) unit = '1'
      unit = unit//'/'//per
      if (order > 1) unit = unit//'^'//to_text(order)

   contains

      pure logical function turns(output)
         integer, intent(in) :: output

         associate (kind => kind_of_output(outputs(output)%kind))
            turns = kind%angle == 1
         end associate
      end function turns
   end function number_unit

   pure function per_time() result(per)
      character(:), allocatable :: per

      per = 's'
   end function per_time

   pure function per_input(sliding) result(per)
      logical, intent(in) :: sliding
      character(:), allocatable :: per

      per = trim(merge('length', 'rad   ', sliding))
   end function per_input

   ! ---- names on device 9 -------------------------------------------------------------------------------------------

   pure function plotted_output(kind, component) result(name)
      type(output_kind_t), intent(in) :: kind
      integer, intent(in) :: component
      character(:), allocatable :: name

      name = 'actual'//trim(kind%suffix(component))
   end function plotted_output

   pure function plotted_desired(kind, component) result(name)
      type(output_kind_t), intent(in) :: kind
      integer, intent(in) :: component
      character(:), allocatable :: name

      name = 'desired'//trim(kind%suffix(component))
   end function plotted_desired

   !> A component without a word before it, where the table is about nothing else: `x`, `y`, `angle`, or `actual`.
   pure function plotted_component(kind, component) result(name)
      type(output_kind_t), intent(in) :: kind
      integer, intent(in) :: component
      character(:), allocatable :: name

      name = 'actual'
      if (kind%components > 1) name = trim(kind%suffix(component)(2:))
   end function plotted_component

   !> A load that springs are to lessen: its components are called alike.
   pure function plotted_load(column) result(name)
      character(*), intent(in) :: column       !! of the component
      character(:), allocatable :: name

      name = column(:scan(column//'.', '.') - 1)
   end function plotted_load

   !> A derivative of what has a name there.
   pure function plotted_rate(name, per, order) result(rate)
      character(*), intent(in) :: name, per
      integer, intent(in) :: order
      character(:), allocatable :: rate

      rate = name//'_per_'//per
      if (order > 1) rate = rate//to_text(order)
   end function plotted_rate
end module psalm_column_names
