!> The drawing board as one self-contained HTML page; a data set may be on it.
module psalm_board
   use psalm_board_text, only: board_text
   use psalm_json, only: json_text
   use psalm_markup, only: xml_text
   use psalm_shared_text, only: title_mark, data_mark
   use psalm_source, only: line_t
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: write_board

contains

   !> Append the page. Lines of a data set, if there are any, are opened on it under the name `file`.
   subroutine write_board(title, file, lines, text)
      character(*), intent(in) :: title          !! of the page
      character(*), intent(in) :: file           !! name that the board saves under
      type(line_t), intent(in) :: lines(:)       !! size 0: an empty board
      type(text_t), intent(inout) :: text
      character(:), allocatable :: page
      integer :: at, place, i

      page = board_text()
      at = index(page, title_mark)
      place = index(page, data_mark)
      call text%add_text(page(:at - 1)//'<title>'//xml_text(title)//'</title>'//page(at + len(title_mark):place - 1))
      call text%add_text('<script type="application/json" id="data">{')
      if (size(lines) > 0) then
         call text%add_text('"file":'//json_text(file)//',"lines":[')
         do i = 1, size(lines)
            if (i > 1) call text%add_text(',')
            call text%add_text(json_text(lines(i)%text))
         end do
         call text%add_text(']')
      end if
      call text%add_text('}</script>'//page(place + len(data_mark):))
   end subroutine write_board
end module psalm_board
