!> What a loop and the group that it closes are called: by number where the linkage is given by its loops, by the names of the
!> group's joints where it is drawn.
module psalm_group_words
   use psalm_mechanism, only: mechanism_t, joint_prismatic, joint_revolute
   use psalm_text, only: cased, to_text, upper_case
   implicit none (type, external)
   private
   public :: group_words, group_heading, arc_heading, the_group

contains

   !> `loop 2`, or of a sketch `joints B, C, D`.
   pure function group_words(mechanism, loop) result(words)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop
      character(:), allocatable :: words
      character(:), allocatable :: names
      integer, allocatable :: named(:)    ! joints of the sketch
      integer :: k, point, n

      words = 'loop '//to_text(loop)
      if (.not. mechanism%has_joint_names()) return
      allocate (named(0))
      names = ''
      n = 0
      associate (joints => mechanism%groups(loop)%joints)
         do k = 1, size(joints)
            associate (joint => mechanism%joints(joints(k)))
               point = 0
               if (joint%kind == joint_revolute .and. joint%arc > 0) point = mechanism%arcs(joint%arc)%joints(joint%end)
               if (any(named == point) .and. point > 0) cycle
               n = n + 1
               if (n > 1) names = names//', '
               if (point > 0) then
                  named = [named, point]
                  names = names//trim(mechanism%ends(joint%end, joint%arc))
               else
                  names = names//joint%name
               end if
            end associate
         end do
      end associate
      if (n == 1) words = 'joint '//names
      if (n > 1) words = 'joints '//names
   end function group_words

   !> The same within a sentence: `loop 2`, or `the group of joints B, C, D`.
   pure function the_group(mechanism, loop) result(words)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop
      character(:), allocatable :: words

      words = group_words(mechanism, loop)
      if (mechanism%has_joint_names()) words = 'the group of '//words
   end function the_group

   !> The same for a listing: `LOOP 2`, or `JOINTS B, C, D`, names as they are; in small letters for a sentence.
   pure function group_heading(mechanism, loop, small) result(words)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop
      logical, intent(in) :: small
      character(:), allocatable :: words

      words = group_words(mechanism, loop)
      if (small) return
      associate (first => index(words, ' ') - 1)
         words(:first) = upper_case(words(:first))
      end associate
   end function group_heading

   !> An arc for a listing: `LOOP 2, ARC 3`, or `LINE B C` from joint to joint, `SLIDE S1`, `LINK rod` where it ends at no joint; in
   !> small letters for a sentence, but for names.
   pure function arc_heading(mechanism, loop, place, small) result(words)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: loop, place
      logical, intent(in) :: small
      character(:), allocatable :: words
      integer :: k, n

      words = cased('LOOP '//to_text(loop)//', ARC '//to_text(place), small)
      if (.not. mechanism%has_joint_names()) return
      n = mechanism%seq(loop, place)
      do k = 1, size(mechanism%joints)
         if (mechanism%joints(k)%kind /= joint_prismatic .or. mechanism%joints(k)%slide /= n) cycle
         words = cased('SLIDE ', small)//mechanism%joints(k)%name
         return
      end do
      if (all(mechanism%arcs(n)%joints > 0)) then
         words = cased('LINE ', small)//trim(mechanism%ends(1, n))//' '//trim(mechanism%ends(2, n))
      else
         words = cased('LINK ', small)//mechanism%bodies(mechanism%arcs(n)%body)%name
      end if
   end function arc_heading
end module psalm_group_words
