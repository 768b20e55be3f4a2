!> The input in words: its heading, its numbers, from where that of a sketch counts.
module psalm_input_text
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: full_turn, wp
   use psalm_mechanism, only: mechanism_t
   use psalm_sketch, only: drive_turns
   use psalm_number_format, only: number_format_t, figure, number_words
   use psalm_text, only: text_t, to_text, upper_case
   implicit none (type, external)
   private
   public :: input_heading, crank_heading, input_text, angle_text, position_words, zero_words, list_sketch_notes

   real(wp), parameter :: nearly_full = 0.99_wp*full_turn !! below this no angle prints as 360.0000
   character(15), parameter :: crank_heading = '    CRANK ANGLE' !! of the angle from the x axis

contains

   !> Heading of the column of inputs.
   pure function input_heading(mechanism) result(heading)
      type(mechanism_t), intent(in) :: mechanism
      character(:), allocatable :: heading

      heading = crank_heading
      if (mechanism%sliding_input) heading = '   INPUT LENGTH'
      if (mechanism%from_drawing) heading = '          INPUT'
   end function input_heading

   !> An input in its column.
   pure function input_text(mechanism, input, format) result(text)
      type(mechanism_t), intent(in) :: mechanism
      real(wp), intent(in) :: input                !! as shown
      type(number_format_t), intent(in) :: format  !! of the column
      character(15) :: text

      if (mechanism%sliding_input .or. mechanism%from_drawing) then
         text = figure(input, format)
      else
         text = angle_text(input, format)
      end if
   end function input_text

   !> An angle of 0 to 360 degrees; what would print as 360.0000 prints as zero.
   pure function angle_text(degrees, format, error) result(text)
      real(wp), intent(in) :: degrees
      type(number_format_t), intent(in), optional :: format !! of the column; default seven digits
      real(wp), intent(in), optional :: error               !! a bound of what rounding makes
      character(15) :: text
      type(number_format_t) :: as

      if (present(format)) as = format
      text = figure(degrees, as, error)
      if (degrees < nearly_full) return
      if (text == figure(full_turn, as, error)) text = figure(0.0_wp, as, error)
   end function angle_text

   !> A position and its input for a message.
   pure function position_words(set, position, input) result(words)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: position
      real(wp), intent(in) :: input                !! as shown
      character(:), allocatable :: words

      words = 'position '//to_text(position)//', input '//number_words(set%has_names(), input)
   end function position_words

   !> From where the inputs of a sketch count; empty where nothing need be said.
   pure function zero_words(set) result(words)
      type(data_set_t), intent(in) :: set
      character(:), allocatable :: words

      words = ''
      if (.not. allocated(set%traced)) return
      words = 'count from the drawing'
      ! the crank of the drawing may change in a search
      if (set%wants_search() .or. set%traced%floating .or. set%sketch%drives(1)%kind /= drive_turns) return
      words = words//', where the crank is at '//number_words(set%traced%crank)//' degrees from the x axis'
   end function zero_words

   !> Append to a listing what is special about a sketch: the zero of its input.
   subroutine list_sketch_notes(set, text)
      type(data_set_t), intent(in) :: set
      type(text_t), intent(inout) :: text
      character(:), allocatable :: zero

      zero = zero_words(set)
      if (len(zero) > 0) call text%add(' INPUTS '//upper_case(zero))
   end subroutine list_sketch_notes
end module psalm_input_text
