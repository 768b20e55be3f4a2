!> Names within the groups of a sketch: words of a text, joints and links by name, and what may have been meant.
module psalm_sketch_names
   use psalm_group, only: group_t, out_of
   use psalm_sketch, only: sketch_t, position_of, sketch_name
   use psalm_status, only: diagnostics_t
   use psalm_text, only: nearest_name, shortened, to_text
   implicit none (type, external)
   private
   public :: word_length, take_name, find_joints, meant, link_names, slide_names, words_of, link_named, common_link, joined

   integer, parameter :: word_length = 2*sketch_name !! of a word within a text; longer ones are no names

contains

   !> A name for a joint, a link or a slide: not empty, no blank in it, not given before.
   subroutine take_name(group, item, which, text, what, before, findings, name)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: item, text, what
      integer, intent(in) :: which
      character(sketch_name), intent(in) :: before(:)
      type(diagnostics_t), intent(inout) :: findings
      character(sketch_name), intent(out) :: name
      integer :: first

      name = adjustl(text)
      if (len_trim(text) == 0) then
         call out_of(group, item, what//' '//to_text(which)//' has no name', findings, which)
      else if (len_trim(adjustl(text)) > sketch_name) then
         call out_of(group, item, "the name '"//shortened(trim(text))//"' is longer than "//to_text(sketch_name)//' characters', &
                     findings, which)
      else if (index(trim(name), ' ') > 0) then
         call out_of(group, item, "the name '"//trim(name)//"' has a blank in it; names are words, with a comma between them", &
                     findings, which)
      else
         first = position_of(name, before)
         if (first > 0) call out_of(group, item, what//' '//trim(name)//' is named twice (as number '//to_text(first)//' and '// &
                                    to_text(which)//')', findings, which)
      end if
   end subroutine take_name

   !> The joints named in a text, with blanks between them; one-letter names may run together.
   subroutine find_joints(group, item, which, text, whose, sketch, findings, joints, valid)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: item, text, whose
      integer, intent(in) :: which
      type(sketch_t), intent(in) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable, intent(out) :: joints(:)
      logical, intent(out) :: valid
      character(word_length), allocatable :: words(:)
      integer :: i, k
      integer, allocatable :: letters(:)

      allocate (joints(0))
      valid = .true.
      words = words_of(text)
      do i = 1, size(words)
         k = sketch%joint_called(trim(words(i)))
         if (k > 0) then
            joints = [joints, k]
            cycle
         end if
         letters = [(sketch%joint_called(words(i)(k:k)), k=1, len_trim(words(i)))]
         if (all(letters > 0)) then
            joints = [joints, letters]
            cycle
         end if
         valid = .false.
         call out_of(group, item, whose//": no joint is called '"//trim(words(i))//"'"// &
                     meant(trim(words(i)), sketch%joint_name), findings, which)
      end do
   end subroutine find_joints

   !> What may have been meant by a name.
   pure function meant(name, names) result(text)
      character(*), intent(in) :: name
      character(sketch_name), intent(in) :: names(:)
      character(:), allocatable :: text
      integer :: i, most

      text = ''
      if (size(names) == 0) return
      text = nearest_name(name, names)
      if (len(text) > 0) then
         text = "; did you mean '"//text//"'?"
         return
      end if
      most = min(size(names), 12)
      text = '; there are '//trim(names(1))
      do i = 2, most
         text = text//', '//trim(names(i))
      end do
      if (most < size(names)) text = text//' and so on'
   end function meant

   pure function link_names(sketch) result(names)
      type(sketch_t), intent(in) :: sketch
      character(sketch_name), allocatable :: names(:)
      integer :: i

      allocate (names(size(sketch%links)))
      do i = 1, size(names)
         names(i) = sketch%links(i)%name
      end do
   end function link_names

   pure function slide_names(sketch) result(names)
      type(sketch_t), intent(in) :: sketch
      character(sketch_name), allocatable :: names(:)
      integer :: i

      allocate (names(size(sketch%slides)))
      do i = 1, size(names)
         names(i) = sketch%slides(i)%name
      end do
   end function slide_names

   !> The words of a text.
   pure function words_of(text) result(words)
      character(*), intent(in) :: text
      character(word_length), allocatable :: words(:)
      integer :: from, to

      allocate (words(0))
      from = 1
      do
         do while (from <= len(text))
            if (text(from:from) /= ' ' .and. text(from:from) /= achar(9)) exit
            from = from + 1
         end do
         if (from > len(text)) exit
         to = from
         do while (to < len(text))
            if (text(to + 1:to + 1) == ' ' .or. text(to + 1:to + 1) == achar(9)) exit
            to = to + 1
         end do
         words = [character(word_length) :: words, text(from:to)]
         from = to + 1
      end do
   end function words_of

   !> The link that a text names; 0 after telling that there is none.
   integer function link_named(group, item, which, text, sketch, findings) result(link)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: item, text
      integer, intent(in) :: which
      type(sketch_t), intent(in) :: sketch
      type(diagnostics_t), intent(inout) :: findings

      link = sketch%link_called(trim(adjustl(text)))
      if (link == 0) call out_of(group, item, "no link is called '"//shortened(trim(text))//"'"// &
                                 meant(trim(text), link_names(sketch)), findings, which)
   end function link_named

   !> A link that has all the joints; 0: none has.
   pure integer function common_link(sketch, joints) result(link)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: joints(:)
      integer :: i, j

      do i = 1, size(sketch%links)
         if (all([(sketch%has_joint(i, joints(j)), j=1, size(joints))])) then
            link = i
            return
         end if
      end do
      link = 0
   end function common_link

   !> Words with blanks between them.
   pure function joined(words) result(text)
      character(*), intent(in) :: words(:)
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(words)
         text = text//trim(words(i))//' '
      end do
   end function joined
end module psalm_sketch_names
