!> A joint with clearance as data of the moving page: its pin in the hole, load and force of contact over the sweep.
module psalm_clearance_page
   use psalm_clearance_scene, only: clearance_scene_t
   use psalm_json, only: add_member, json_number, json_text
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: write_clearance_data

contains

   !> Append a JSON object. `joint` is that of the scene, counted from 0, -1: it is not drawn.
   subroutine write_clearance_data(clearance, joint, text)
      type(clearance_scene_t), intent(in) :: clearance
      integer, intent(in) :: joint
      type(text_t), intent(inout) :: text

      call text%add_text('{"name":'//json_text(clearance%name)//',"joint":'//to_text(joint)//',"diametral":'// &
                         json_number(clearance%diametral))
      call add_member('px', clearance%pin(1, :), text)
      call add_member('py', clearance%pin(2, :), text)
      call add_member('fx', clearance%load(1, :), text)
      call add_member('fy', clearance%load(2, :), text)
      call add_member('force', clearance%force, text)
      call text%add_text('}')
   end subroutine write_clearance_data
end module psalm_clearance_page
