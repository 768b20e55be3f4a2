!> Allotted tolerances as data of the moving page.
module psalm_allocation_page
   use psalm_allocation_group, only: rule_yield
   use psalm_allocation_scene, only: allocation_scene_t, allotted_words, degree_sign, legend_words, part_words, &
                                     plus_minus, tolerance_words
   use psalm_json, only: add_member, comma, json_number, json_text, truth
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: write_allocation_data

contains

   !> Append a JSON object.
   subroutine write_allocation_data(scene, text)
      type(allocation_scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      integer :: i

      call text%add_text('{"words":'//json_text(allotted_words(scene))//',"legend":'//json_text(legend_words(scene))// &
                         ',"input":'//json_text(trim(scene%input))//',"turning":'//truth(scene%turning)//',"rows":[')
      do i = 1, size(scene%rows)
         associate (row => scene%rows(i))
            call text%add_text(comma(i)//'{"name":'//json_text(trim(row%name))//',"tolerance":'// &
                               json_text(tolerance_words(row, plus_minus, degree_sign))//',"cost":'//json_number(row%cost)// &
                               ',"share":'//json_number(row%share)//',"parts":['//json_text(part_words(row%cost))//','// &
                               json_text(part_words(row%share))//']}')
         end associate
      end do
      call text%add('],"bands":[')
      do i = 1, size(scene%bands)
         associate (band => scene%bands(i))
            call text%add_text(comma(i)//'{"name":'//json_text(trim(band%name)))
            call add_member('input', band%input, text)
            call add_member('width', band%width, text)
            call add_member('worst', band%worst, text)
            call add_member('square', band%square, text)
            if (scene%rule == rule_yield) call add_member('used', band%used, text)
            call text%add('}')
         end associate
      end do
      call text%add_text(']}')
   end subroutine write_allocation_data
end module psalm_allocation_page
