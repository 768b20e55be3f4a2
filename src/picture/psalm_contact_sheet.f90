!> The contact sheet: all cases of a file on one page, each as the SVG that moves, with its text below.
!>
!> The page needs no script. It shows the files that `psalm_animation` wrote, which stand beside it.
module psalm_contact_sheet
   use psalm_markup, only: xml_text
   use psalm_source, only: line_t
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: write_contact_sheet

   character(*), parameter :: style = &
      'body{font:15px/1.4 system-ui,sans-serif;margin:1.5rem;color:#222;background:#fff}'// &
      '.sheet{display:grid;grid-template-columns:repeat(auto-fill,minmax(17rem,1fr));gap:1rem}'// &
      'figure{margin:0;border:1px solid #ccc;border-radius:4px;padding:.5rem}'// &
      'figure img{width:100%;height:auto;display:block}'// &
      'a{color:inherit}pre{overflow:auto;background:#f4f4f4;padding:.7rem}'// &
      '@media (prefers-color-scheme:dark){body{color:#ddd;background:#181818}'// &
      'figure{border-color:#444;background:#fff;color:#222}'// &
      'pre{background:#262626}}'

contains

   !> Append the page. Of a case without a picture only the title is shown.
   subroutine write_contact_sheet(titles, pictures, first_lines, lines, text)
      character(*), intent(in) :: titles(:)        !! shape (cases)
      character(*), intent(in) :: pictures(:)      !! shape (cases): names of the files, blank: none
      integer, intent(in) :: first_lines(:)        !! shape (cases): where each begins in the file
      type(line_t), intent(in) :: lines(:)         !! of the file
      type(text_t), intent(inout) :: text
      integer :: k, i, last

      call text%add('<!doctype html>')
      call text%add('<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">')
      call text%add('<title>'//to_text(size(titles))//' linkages</title><style>'//style//'</style></head><body>')
      call text%add('<main class="sheet">')
      do k = 1, size(titles)
         call text%add('<figure><a href="#case-'//to_text(k)//'">')
         if (len_trim(pictures(k)) > 0) call text%add('<img src="'//xml_text(trim(pictures(k)))//'" alt="'// &
                                                      xml_text(trim(titles(k)))//'">')
         call text%add('<figcaption>'//to_text(k)//'. '//xml_text(trim(titles(k)))//'</figcaption></a></figure>')
      end do
      call text%add('</main>')
      do k = 1, size(titles)
         last = size(lines)
         if (k < size(titles)) last = first_lines(k + 1) - 1
         call text%add('<section id="case-'//to_text(k)//'"><h2>'//xml_text(trim(titles(k)))//'</h2><pre>')
         do i = max(1, first_lines(k)), min(last, size(lines))
            call text%add(xml_text(lines(i)%text))
         end do
         call text%add('</pre></section>')
      end do
      call text%add('</body></html>')
   end subroutine write_contact_sheet
end module psalm_contact_sheet
