!> What is proven of a motion, for the moving page.
module psalm_proof_page
   use psalm_json, only: add_numbers, comma, json_number, json_text, truth
   use psalm_proof_scene, only: proof_scene_t
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: write_proof_data

contains

   !> Append marks, least clearances and links with a width as JSON; joints count from 0.
   subroutine write_proof_data(proof, text)
      type(proof_scene_t), intent(in) :: proof
      type(text_t), intent(inout) :: text
      integer :: i, k

      call text%add('{"marks":[')
      do i = 1, size(proof%marks)
         associate (mark => proof%marks(i))
            call text%add_text(comma(i)//'{"kind":"'//mark%kind//'","text":'//json_text(mark%text))
            if (mark%placed) then
               call text%add_text(',"input":'//json_number(mark%input, exact=.true.)//',"output":'//truth(mark%of_output)//',"at":')
               call add_numbers(mark%at, text, exact=.true.)
            end if
            call text%add('}')
         end associate
      end do
      call text%add('],"near":[')
      do i = 1, size(proof%near)
         associate (near => proof%near(i))
            call text%add_text(comma(i)//'{"mark":'//to_text(near%mark - 1)//',"tightest":'//truth(near%tightest)//',"links":[')
            do k = 1, near%points/2
               call text%add_text(comma(k)//'{"width":'//json_number(near%widths(k))//',"ends":')
               call add_numbers([near%ends(:, 2*k - 1), near%ends(:, 2*k)], text, exact=.true.)
               call text%add_text('}')
            end do
            call text%add('],"way":')
            call add_numbers([near%way(:, 1), near%way(:, 2)], text, exact=.true.)
            call text%add('}')
         end associate
      end do
      call text%add('],"wide":[')
      do i = 1, size(proof%wide)
         associate (wide => proof%wide(i))
            call text%add_text(comma(i)//'{"from":'//to_text(wide%start - 1)//',"to":'//to_text(wide%finish - 1)//',"width":'// &
                               json_number(wide%width)//'}')
         end associate
      end do
      call text%add_text(']}')
   end subroutine write_proof_data
end module psalm_proof_page
