!> A joint with clearance as data of the moving page: its pin in the hole, load and force of contact over the sweep.
module psalm_clearance_page
   use psalm_clearance_scene, only: clearance_scene_t
   use psalm_kinds, only: wp
   use psalm_markup, only: json_text, short_number
   use psalm_page_rows, only: add_values
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
                         short_number(clearance%diametral))
      call add_row('px', clearance%pin(1, :))
      call add_row('py', clearance%pin(2, :))
      call add_row('fx', clearance%load(1, :))
      call add_row('fy', clearance%load(2, :))
      call add_row('force', clearance%force)
      call text%add_text('}')

   contains

      subroutine add_row(name, values)
         character(*), intent(in) :: name
         real(wp), intent(in) :: values(:)

         call text%add(',"'//name//'":[')
         call add_values(values, text)
         call text%add_text(']')
      end subroutine add_row
   end subroutine write_clearance_data
end module psalm_clearance_page
