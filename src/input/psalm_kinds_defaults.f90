!> What a case with &KINDS says where its other groups do not: written into them as if the user had.
module psalm_kinds_defaults
   use psalm_group, only: item_t, value_t, add_item, add_value
   use psalm_namelist, only: case_text_t
   use psalm_rule, only: rule_t, a_number, a_text, a_whole, a_word
   use psalm_text, only: upper_case
   implicit none (type, external)
   private
   public :: kinds_items, complete_kinds_case, driven_by_cylinder, weigh_words

   character(*), parameter :: usual_starts = '100000' !! of each kind: time or patience ends the search

   !> Numbers of which two are weighed against each other.
   character(*), parameter :: weigh_words = 'ERROR LARGEST ANGLE RATIO ROOM LENGTH LINKS JOINTS'

   !> The items of the group.
   type(rule_t), parameter :: kinds_items(*) = [ &
      rule_t('LINKS', a_whole, 'n', '', '4,6; with GEARS=1 4,5,6', '4 5 6 7 8', &
             'links of the linkages, the frame included; an odd number has a gear pair'), &
      rule_t('SLIDES', a_whole, '2', '', '0', '[0,3]', &
             'pins replaced by slides: at most, or at least and at most'), &
      rule_t('GEARS', a_whole, '2', '', '0', '[0,1]', &
             'gear pairs: at most, or at least and at most'), &
      rule_t('DRIVEN', a_word, '', '', 'CRANK', 'CRANK CYLINDER', &
             '''CRANK'', a link on the frame turns; ''CYLINDER'', a cylinder between two links stretches (cylinder and '// &
             'rod count as links)'), &
      rule_t('OUTPUT', a_word, '', '', 'POINT', 'POINT ANGLE POSE', &
             'what is wanted: ''POINT'', a point of a link that is not on the frame; ''ANGLE'', the angle of a link on the '// &
             'frame; ''POSE'', both of a link that is not'), &
      rule_t('GROUPS', a_whole, '', '', '2', '[2,6]', &
             'links of the largest Assur group: 2, dyads only'), &
      rule_t('NKINDS', a_whole, '', '', '5', '[1,1000]', &
             'kinds of which results are listed, the best ones'), &
      rule_t('PATNCE', a_whole, '', '', '3; with MAXTIME 0', '[0,1000]', &
             'rounds without a better linkage after which the search ends; 0: never'), &
      rule_t('LENLOW', a_number, '', 'length', '0.02 of the curve''s size', '(0,)', &
             'lower bound of all lengths of links'), &
      rule_t('LENHGH', a_number, '', 'length', '5 of the curve''s size', '(0,)', &
             'upper bound of all lengths of links'), &
      rule_t('WEIGH', a_text, '2', '', '''ERROR'',''LINKS''', '', &
             'the listing marks results that none other beats in both of these, two of '//weigh_words), &
      rule_t('ONLY', a_text, 'n', '', 'all kinds', '', &
             'names of kinds, or their beginnings: no others are searched')]

contains

   !> Set what is not said. A case without &KINDS, or with a linkage of its own, is left as it is.
   pure subroutine complete_kinds_case(case)
      type(case_text_t), intent(inout) :: case
      integer :: kinds, line
      logical :: of_point, turns

      kinds = place_of(case, 'KINDS')
      if (kinds == 0 .or. place_of(case, 'LINKS') > 0 .or. place_of(case, 'CHAIN') > 0) return
      line = case%groups(kinds)%line      ! a variable: put_item may move the groups
      of_point = word_of(case, 'OUTPUT') /= 'ANGLE' .and. word_of(case, 'OUTPUT') /= 'POSE'
      turns = .not. driven_by_cylinder(case)
      if (word_of(case, 'OUTPUT') == 'ANGLE') call put_item(case, line, 'METHOD', 'MOTION', '1')
      if (word_of(case, 'OUTPUT') == 'POSE') call put_item(case, line, 'METHOD', 'MOTION', '4')
      if (of_point) call put_item(case, line, 'METHOD', 'IFREE', '1')
      call put_item(case, line, 'SEARCH', 'SOLVER', 'LSQ')
      call put_item(case, line, 'SEARCH', 'NSTART', usual_starts)
      if (is_free()) call put_item(case, line, 'SEARCH', 'ORDER', '2')
      if (turns) call put_item(case, line, 'CONSTR', 'IRANGE', '2')

   contains

      pure logical function is_free()
         integer :: k, method

         is_free = .false.
         method = place_of(case, 'METHOD')
         if (method == 0) return
         associate (group => case%groups(method))
            do k = 1, group%count
               if (group%items(k)%name == 'IFREE' .and. group%items(k)%count > 0) &
                  is_free = group%text_of(group%values(group%items(k)%first)) == '1'
            end do
         end associate
      end function is_free
   end subroutine complete_kinds_case

   !> True if a case asks for kinds that a cylinder drives.
   pure logical function driven_by_cylinder(case)
      type(case_text_t), intent(in) :: case

      driven_by_cylinder = .false.
      if (place_of(case, 'KINDS') > 0) driven_by_cylinder = word_of(case, 'DRIVEN') == 'CYLINDER'
   end function driven_by_cylinder

   !> A word of &KINDS, in capitals; empty if it is not there.
   pure function word_of(case, item) result(word)
      type(case_text_t), intent(in) :: case          !! has the group
      character(*), intent(in) :: item
      character(:), allocatable :: word
      integer :: k, place

      word = ''
      place = place_of(case, 'KINDS')
      associate (group => case%groups(place))
         do k = 1, group%count
            if (group%items(k)%name == item .and. group%items(k)%count > 0) &
               word = upper_case(group%text_of(group%values(group%items(k)%first)))
         end do
      end associate
   end function word_of

   !> Put an item into a group, which is made if it is not there, unless it has the item.
   pure subroutine put_item(case, line, name, item, value)
      type(case_text_t), intent(inout) :: case
      integer, intent(in) :: line                   !! that it is put down to
      character(*), intent(in) :: name, item, value !! group, item, value
      integer :: place

      call case%make(name, line, place)
      if (any(case%groups(place)%items(:case%groups(place)%count)%name == item)) return
      call add_item(case%groups(place), item_t(name=item, line=line))
      call add_value(case%groups(place), value_t(line=line), value)
   end subroutine put_item

   !> Place of a group in the case; 0: it is not there.
   pure integer function place_of(case, name)
      type(case_text_t), intent(in) :: case
      character(*), intent(in) :: name

      place_of = findloc(case%groups(:case%count)%name == name, .true., dim=1)
   end function place_of
end module psalm_kinds_defaults
