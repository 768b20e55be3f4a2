!> Forces as data of the moving page, over its sweep.
module psalm_force_page
   use psalm_force_scene, only: force_scene_t, words_of_added
   use psalm_force_analysis, only: column_drive, column_fx, column_fy, column_moment
   use psalm_kinds, only: wp
   use psalm_json, only: add_member, comma, json_number, json_text, truth
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: write_force_data

contains

   !> Append a JSON object; what is not known is null.
   subroutine write_force_data(forces, text)
      type(force_scene_t), intent(in) :: forces
      type(text_t), intent(inout) :: text
      integer :: j

      associate (sweep => forces%sweep)
         call text%add_text('{"sliding":'//truth(forces%sliding))
         call add_row('drive', sweep%table%value(:, column_drive))
         call add_row('fx', sweep%table%value(:, column_fx))
         call add_row('fy', sweep%table%value(:, column_fy))
         call add_row('moment', sweep%table%value(:, column_moment))
         if (allocated(forces%bare)) then
            call text%add_text(',"bare":{"of":'//json_text(words_of_added(forces)))
            call add_row('drive', forces%bare%value(:, column_drive))
            call add_row('fx', forces%bare%value(:, column_fx))
            call add_row('fy', forces%bare%value(:, column_fy))
            call add_row('moment', forces%bare%value(:, column_moment))
            call text%add_text('}')
         end if
         call text%add_text(',"weights":[')
         do j = 1, size(forces%radius)
            call text%add_text(comma(j)//'{"radius":'//json_number(forces%radius(j)))
            call add_row('x', sweep%weight_at(1, :, j))
            call add_row('y', sweep%weight_at(2, :, j))
            call text%add('}')
         end do
         call text%add_text('],"springs":[')
         do j = 1, size(forces%torsional)
            call text%add_text(comma(j)//'{"torsional":'//truth(forces%torsional(j))//',"frame":['// &
                               truth(forces%on_frame(1, j))//','//truth(forces%on_frame(2, j))//']')
            call add_row('x', sweep%spring_at(1, :, 1, j))
            call add_row('y', sweep%spring_at(2, :, 1, j))
            call add_row('x2', sweep%spring_at(1, :, 2, j))
            call add_row('y2', sweep%spring_at(2, :, 2, j))
            call add_row('footx', sweep%spring_foot(1, :, 1, j))
            call add_row('footy', sweep%spring_foot(2, :, 1, j))
            call add_row('footx2', sweep%spring_foot(1, :, 2, j))
            call add_row('footy2', sweep%spring_foot(2, :, 2, j))
            call text%add('}')
         end do
         call text%add_text(']')
         call text%add_text(',"centres":[')
         do j = 1, size(sweep%centre, 3)
            call text%add_text(comma(j)//'{"link":'//json_text(trim(forces%links(j))))
            call add_row('x', sweep%centre(1, :, j))
            call add_row('y', sweep%centre(2, :, j))
            call text%add('}')
         end do
         call text%add_text('],"loads":[')
         do j = 1, size(sweep%load, 3)
            call text%add_text(comma(j)//'{"number":'//to_text(j))
            call add_row('x', sweep%load_at(1, :, j))
            call add_row('y', sweep%load_at(2, :, j))
            call add_row('fx', sweep%load(1, :, j))
            call add_row('fy', sweep%load(2, :, j))
            call text%add('}')
         end do
         call text%add_text('],"joints":[')
         do j = 1, size(forces%joints)
            call text%add_text(comma(j)//'{"name":'//json_text(trim(forces%joints(j))))
            call add_row('fx', sweep%joint(1, :, j))
            call add_row('fy', sweep%joint(2, :, j))
            call text%add('}')
         end do
         call text%add_text(']}')
      end associate

   contains

      subroutine add_row(name, values)
         character(*), intent(in) :: name
         real(wp), intent(in) :: values(:)
         integer :: i

         call add_member(name, values, text, [(forces%sweep%table%known(i), i=1, size(values))])
      end subroutine add_row
   end subroutine write_force_data
end module psalm_force_page
