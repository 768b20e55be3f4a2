!> The group KINDS: the kinds of linkages among which the one is sought that does what is wanted.
!>
!> A case with it has no linkage of its own. What its other groups do not say is set as a search among kinds needs it:
!> SOLVER='LSQ', many starts, and for a path without prescribed timing IFREE=1, ORDER=2 and a crank that turns fully.
module psalm_kinds_group
   use psalm_case_group, only: case_group_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_kinds_defaults, only: kinds_items, weigh_words
   use psalm_rule, only: one_of
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_text, only: upper_case
   implicit none (type, external)
   private
   public :: kinds_group_t, kinds_of, weighable

   character(8), parameter :: weighable(*) = [character(8) :: 'ERROR', 'LARGEST', 'ANGLE', 'RATIO', 'ROOM', 'LENGTH', 'LINKS', &
                                               'JOINTS'] !! the words of `weigh_words`
   integer, parameter :: most_sizes = 5     !! entries of LINKS that differ: 4 to 8

   type, extends(case_group_t) :: kinds_group_t
      integer, allocatable :: links(:)      !! LINKS
      integer :: slides(2) = 0              !! SLIDES: least, most
      integer :: gears(2) = 0               !! GEARS: least, most
      integer :: drive = 1                  !! DRIVEN: 1 crank, 2 cylinder
      integer :: output = 1                 !! OUTPUT: 1 point, 2 angle, 3 pose
      integer :: largest_group = 2          !! GROUPS
      integer :: listed = 5                 !! NKINDS
      integer :: patience = -1              !! PATNCE; -1: not given
      integer :: weighed(2) = [1, 7]        !! WEIGH: places of two words
      real(wp) :: low = 0.0_wp, high = 0.0_wp !! LENLOW, LENHGH; 0: none
      character(:), allocatable :: only(:)  !! ONLY
   contains
      procedure :: read => read_kinds
   end type kinds_group_t

contains

   !> Read it. Errors: numbers of links that are out of range or do not go with GEARS, a range the wrong way round, one bound
   !> without the other.
   subroutine read_kinds(self, group, about, findings)
      class(kinds_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings
      integer :: links(most_sizes), last, k

      self%given = group%line > 0
      call group%follow(kinds_items)
      links = 0
      call read_range('GEARS', self%gears, 1, 'a linkage has one gear pair, 1, or none, 0', &
                      'the least number of gear pairs comes first')
      call group%get_integers('LINKS', links, findings, last=last)
      allocate (self%links(0))
      do k = 1, last
         if (all(links(k) /= [4, 5, 6, 7, 8])) then
            call out_of(group, 'LINKS', 'kinds of 4, 6 and 8 links are searched, and with GEARS=1 of 5 and 7', findings, k)
         else if (modulo(links(k), 2) == 1 .and. self%gears(2) == 0) then
            call out_of(group, 'LINKS', 'only a gear pair gives an odd number of links one degree of freedom; set GEARS=1', &
                        findings, k)
         else if (modulo(links(k), 2) == 0 .and. self%gears(1) > 0) then
            call out_of(group, 'LINKS', 'linkages with a gear pair have 5 or 7 links; with GEARS=0,1 those without gears '// &
                        'are searched, too', findings, k)
         else if (.not. any(self%links == links(k))) then
            self%links = [self%links, links(k)]
         end if
      end do
      if (last == 0) then
         self%links = [4, 5, 6]
         self%links = pack(self%links, modulo(self%links, 2) >= self%gears(1) .and. modulo(self%links, 2) <= self%gears(2))
      end if
      call read_range('SLIDES', self%slides, 3, 'from 0 to 3 pins are replaced by slides', 'the least number of slides comes first')
      call take(group, 'DRIVEN', self%drive, findings)
      call take(group, 'OUTPUT', self%output, findings)
      call take(group, 'GROUPS', self%largest_group, findings)
      call take(group, 'NKINDS', self%listed, findings)
      call take(group, 'PATNCE', self%patience, findings)
      call take(group, 'LENLOW', self%low, findings)
      call take(group, 'LENHGH', self%high, findings)
      call group%get_texts('ONLY', self%only, findings)
      call read_weighed()
      if (.not. self%given) return
      if (group%given('LENLOW') .neqv. group%given('LENHGH')) then
         call out_of(group, trim(merge('LENLOW', 'LENHGH', group%given('LENLOW'))), &
                     'both bounds of the lengths are given, or none', findings)
      else if (self%low > self%high) then
         call out_of(group, 'LENHGH', 'must be above LENLOW', findings)
      end if
      associate (unused => about)
      end associate

   contains

      !> At most, or at least and at most.
      subroutine read_range(item, range, largest, in_words, order)
         character(*), intent(in) :: item
         integer, intent(inout) :: range(2)
         integer, intent(in) :: largest
         character(*), intent(in) :: in_words, order !! messages

         call group%get_integers(item, range, findings, last=last)
         if (last == 1) range = [0, range(1)]
         if (any(range < 0 .or. range > largest)) then
            call out_of(group, item, in_words, findings)
         else if (range(1) > range(2)) then
            call out_of(group, item, order, findings)
         end if
      end subroutine read_range

      subroutine read_weighed()
         character(:), allocatable :: words(:)
         integer :: i, found

         call group%get_texts('WEIGH', words, findings)
         if (size(words) == 0) return
         if (size(words) /= size(self%weighed)) then
            call out_of(group, 'WEIGH', 'two words are weighed against each other', findings)
            return
         end if
         do i = 1, size(self%weighed)
            found = findloc(weighable == upper_case(trim(words(i))), .true., dim=1)
            if (found > 0) then
               self%weighed(i) = found
            else
               call out_of(group, 'WEIGH', one_of(weigh_words)//" is expected; found '"//trim(words(i))//"'", findings, i)
            end if
         end do
      end subroutine read_weighed
   end subroutine read_kinds

   !> The group of a case that has it.
   function kinds_of(set) result(kinds)
      type(data_set_t), intent(in) :: set
      type(kinds_group_t) :: kinds
      integer :: k

      k = set%place_of('KINDS')
      select type (group => set%sections(k)%group)
      type is (kinds_group_t)
         kinds = group
      end select
   end function kinds_of
end module psalm_kinds_group
