!> From where the input of a sketch counts, in words. Its listing counts the crank from the x axis, as that of loops does; its table
!> (CSV) counts all drives from the drawing.
module psalm_input_text
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_sketch, only: drive_turns
   use psalm_text, only: text_t, general, to_text, upper_case
   implicit none (type, external)
   private
   public :: position_words, zero_words, list_sketch_notes

contains

   !> A position and its input for a message: that of a sketch as its table has it.
   pure function position_words(set, position, input) result(words)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: position
      real(wp), intent(in) :: input                !! as listed
      character(:), allocatable :: words
      real(wp) :: from_drawing

      words = 'position '//to_text(position)//', input '
      if (.not. set%sketch%given) then
         words = words//trim(adjustl(general(input)))
         return
      end if
      from_drawing = set%method%crnki
      if (set%method%ikin /= 0) then
         from_drawing = from_drawing + real((position - 1)*set%method%ikin, wp)
      else
         from_drawing = from_drawing + set%method%delt(position)
      end if
      words = words//trim(adjustl(general(from_drawing)))//' from the drawing'
   end function position_words

   !> From where the inputs of the listing count; empty where nothing need be said.
   pure function zero_words(set) result(words)
      type(data_set_t), intent(in) :: set
      character(:), allocatable :: words

      words = ''
      if (.not. set%sketch%given) return
      if (set%wants_search()) return               ! it has no table, and the input of the drawing may change
      if (.not. abs(set%drawn_input()) > 0.0_wp) return
      words = 'inputs here count from the x axis; the drawing, input 0 of the table (CSV), is at '
      if (set%sketch%drives(1)%kind /= drive_turns) words = 'inputs here are lengths from the start of the slide; the drawing, '// &
                                                            'input 0 of the table (CSV), is at '
      words = words//trim(adjustl(general(set%drawn_input())))
   end function zero_words

   !> Append to a listing what is special about a sketch: the zero of its input, and an output that the listing cannot show.
   subroutine list_sketch_notes(set, text)
      type(data_set_t), intent(in) :: set
      type(text_t), intent(inout) :: text
      character(:), allocatable :: zero

      zero = zero_words(set)
      if (len(zero) > 0) call text%add(' '//upper_case(zero))
      if (.not. set%has_stand_in()) return
      if (set%wants_search()) then
         call text%add(' HERE ARE X AND Y OF JOINT '//set%traced%stand_in//'; OUTPUT '// &
                       trim(set%sketch%outputs(1)%name)//' IS NOT LISTED')
      else
         call text%add(' HERE ARE X AND Y OF JOINT '//set%traced%stand_in//'; OUTPUT '// &
                       trim(set%sketch%outputs(1)%name)//' IS AMONG ALL OUTPUTS FURTHER DOWN')
      end if
   end subroutine list_sketch_notes
end module psalm_input_text
