!> What is proven of a motion, for the moving page.
module psalm_proof_page
   use psalm_kinds, only: wp
   use psalm_markup, only: json_text, short_number, comma, truth
   use psalm_proof_scene, only: proof_scene_t
   use psalm_text, only: text_t, full_precision, to_text
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
            if (mark%placed) call text%add_text(',"input":'//full_precision(mark%input)//',"output":'//truth(mark%of_output)// &
                                                ',"at":['//full_precision(mark%at(1))//','//full_precision(mark%at(2))//']')
            call text%add('}')
         end associate
      end do
      call text%add('],"near":[')
      do i = 1, size(proof%near)
         associate (near => proof%near(i))
            call text%add_text(comma(i)//'{"mark":'//to_text(near%mark - 1)//',"tightest":'//truth(near%tightest)//',"links":[')
            do k = 1, near%points/2
               call text%add_text(comma(k)//'{"width":'//short_number(near%widths(k))//',"ends":['// &
                                  numbers([near%ends(:, 2*k - 1), near%ends(:, 2*k)])//']}')
            end do
            call text%add('],"way":['//numbers([near%way(:, 1), near%way(:, 2)])//']}')
         end associate
      end do
      call text%add('],"wide":[')
      do i = 1, size(proof%wide)
         associate (wide => proof%wide(i))
            call text%add_text(comma(i)//'{"from":'//to_text(wide%start - 1)//',"to":'//to_text(wide%finish - 1)//',"width":'// &
                               short_number(wide%width)//'}')
         end associate
      end do
      call text%add_text(']}')
   end subroutine write_proof_data

   pure function numbers(values) result(list)
      real(wp), intent(in) :: values(:)
      character(:), allocatable :: list
      integer :: i

      list = ''
      do i = 1, size(values)
         list = list//comma(i)//full_precision(values(i))
      end do
   end function numbers
end module psalm_proof_page
