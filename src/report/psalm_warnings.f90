!> Words on what is no violation and yet makes a result doubtful.
module psalm_warnings
   use psalm_analysis, only: warnings_t
   use psalm_data_set, only: data_set_t
   use psalm_text, only: to_text
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t
   use psalm_number_format, only: number_words
   use psalm_parameters, only: length_name
   implicit none (type, external)
   private
   public :: describe_short_links, words_at_rest

   character(*), parameter :: words_at_rest = 'the output does not move: NOUTLK and NOUTLP name an arc or a joint at rest'
   integer, parameter :: most_named = 3            !! links named in one remark

contains

   !> Links of practically no length, in words. There must be one.
   function describe_short_links(set, mechanism, dimensions, warnings) result(words)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(warnings_t), intent(in) :: warnings
      character(:), allocatable :: words
      integer :: i, n

      words = 'a link of practically no length (the longest '// &
              trim(merge('length', 'arc   ', set%has_names()))//' is '// &
              number_words(maxval(dimensions%arcl))//'): '
      do i = 1, min(size(warnings%short), most_named)
         n = warnings%short(i)
         if (i > 1) words = words//', '
         words = words//length_name(mechanism, n)// &
                 ' is '//number_words(dimensions%arcl(n))
      end do
      if (size(warnings%short) > most_named) words = words//' and '//to_text(size(warnings%short) - most_named)//' more'
      words = words//'; limit the lengths ('// &
              set%bound_items(', ')//') if this is not meant'
   end function describe_short_links
end module psalm_warnings
