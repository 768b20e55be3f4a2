!> How a scene is put into a picture: its unit of length, and how much of the plane is seen.
module psalm_view
   use psalm_constraint_group, only: region_half_plane
   use psalm_force_scene, only: change_unit_of_forces
   use psalm_kinds, only: wp
   use psalm_proof_scene, only: change_unit_of_proof
   use psalm_scene, only: scene_t
   use psalm_trace, only: position_row_t
   implicit none (type, external)
   private
   public :: drawing_unit, change_unit, take_in_others

   integer, parameter :: plain_power = 15     !! lengths beyond ten to this, or below its inverse, are drawn in another unit
   real(wp), parameter :: ghost_room = 1.0_wp !! the other assemblies widen the view by at most this part of it

contains

   !> Unit of length of the drawing: 1, or a power of ten where the single precision of viewers would not hold the lengths.
   real(wp) function drawing_unit(scene) result(unit)
      type(scene_t), intent(in) :: scene
      integer :: power

      unit = 1.0_wp
      power = floor(log10(maxval(scene%high - scene%low)))
      if (abs(power) > plain_power) unit = 10.0_wp**power
   end function drawing_unit

   !> All places and lengths of a scene in another unit; values of the output stay.
   subroutine change_unit(scene, unit)
      type(scene_t), intent(inout) :: scene
      real(wp), intent(in) :: unit
      integer :: g

      scene%low = scene%low/unit
      scene%high = scene%high/unit
      scene%pointer = scene%pointer/unit
      scene%slides%low = scene%slides%low/unit
      scene%slides%high = scene%slides%high/unit
      call change_regions()
      call change(scene%prescribed)
      call change(scene%sweep)
      if (allocated(scene%forces)) call change_unit_of_forces(scene%forces, unit)
      if (allocated(scene%proof)) call change_unit_of_proof(scene%proof, unit)
      if (allocated(scene%vibration)) scene%vibration%deflection = scene%vibration%deflection/unit
      scene%bars%barrel = scene%bars%barrel/unit
      if (allocated(scene%wheels)) scene%wheels%radius = scene%wheels%radius/unit
      if (allocated(scene%meshes)) scene%meshes = scene%meshes/unit
      if (allocated(scene%ghosts)) then
         do g = 1, size(scene%ghosts)
            scene%ghosts(g)%x = scene%ghosts(g)%x/unit
            scene%ghosts(g)%y = scene%ghosts(g)%y/unit
         end do
      end if

   contains

      pure subroutine change(row)
         type(position_row_t), intent(inout) :: row

         row%x = row%x/unit
         row%y = row%y/unit
         row%tip = row%tip/unit
         row%other = row%other/unit
         row%actual_mark = row%actual_mark/unit
         row%desired_mark = row%desired_mark/unit
      end subroutine change

      subroutine change_regions()
         integer :: r, last

         do r = 1, size(scene%regions)
            associate (region => scene%regions(r))
               ! of a half-plane the third number is a direction
               last = merge(2, size(region%at), region%kind == region_half_plane)
               region%at(:last) = region%at(:last)/unit
            end associate
         end do
      end subroutine change_regions
   end subroutine change_unit

   !> The other assemblies belong into the view, if that does not make the linkage too small.
   pure subroutine take_in_others(scene)
      type(scene_t), intent(inout) :: scene
      real(wp) :: low(2), high(2), border
      integer :: loop

      low = scene%low
      high = scene%high
      border = ghost_room*maxval(high - low)
      do loop = 1, scene%loops
         if (.not. scene%prescribed%other_known(loop, scene%reference)) cycle
         associate (other => scene%prescribed%other(:, loop, scene%reference))
            scene%low = min(scene%low, max(other, low - border))
            scene%high = max(scene%high, min(other, high + border))
         end associate
      end do
   end subroutine take_in_others
end module psalm_view
