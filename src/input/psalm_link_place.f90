!> Places on links as the groups of forces name them: an end of an arc, a distance and an angle from the arc's direction.
module psalm_link_place
   use psalm_group, only: group_t, check_range, out_of, required
   use psalm_kinds, only: wp
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: place_t, read_places, read_count, refuse_unless

   integer, parameter :: most_entries = 100000  !! above this a number of entries is taken for a slip of the pen

   !> A place on a link.
   type :: place_t
      integer :: arc = 0, loop = 0         !! an arc of the link
      logical :: from_start = .false.      !! counted from the arc's start, else from its finish
      real(wp) :: distance = 0.0_wp        !! from that end, user's length
      real(wp) :: angle = 0.0_wp           !! of the line to the place from the arc's direction, degrees
   end type place_t

contains

   !> Number of entries of a group: required where the group is given, 0 where it is not.
   subroutine read_count(group, name, n, findings)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: name
      integer, intent(out) :: n
      type(diagnostics_t), intent(inout) :: findings

      n = 0
      call group%get_integer(name, n, findings)
      group%count_missing = .not. group%given(name)
      if (group%line > 0) call check_range(group, name, n, 0, most_entries, findings, must_be=.true.)
      n = min(max(n, 0), most_entries)
   end subroutine read_count

   !> Places from the items LINK, LOOP, DIST, ANG, each with the group's letter before it.
   !>
   !> Errors: arcs that are not there, or that are not named.
   subroutine read_places(group, letter, ilink, places, findings, ends_only)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: letter           !! M for MLINK, MLOOP, MDIST, MANG
      integer, intent(in) :: ilink(:, :)           !! ILINK, shape (maxarc, nloop); 0 where there is no arc
      type(place_t), intent(out) :: places(:)      !! shape (entries)
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(in), optional :: ends_only   !! there are no items DIST and ANG: ends of arcs are named
      integer :: links(size(places)), loops(size(places)), k
      real(wp) :: distances(size(places)), angles(size(places))

      links = 0
      loops = 0
      distances = 0.0_wp
      angles = 0.0_wp
      call group%get_integers(letter//'LINK', links, findings)
      call group%get_integers(letter//'LOOP', loops, findings)
      if (.not. present(ends_only)) then
         call group%get_reals(letter//'DIST', distances, findings)
         call group%get_reals(letter//'ANG', angles, findings)
      end if
      if (size(places) == 0) return
      if (.not. group%given(letter//'LINK')) call required(group, letter//'LINK')
      if (.not. group%given(letter//'LOOP')) call required(group, letter//'LOOP')
      do k = 1, size(places)
         places(k) = place_t(abs(links(k)), loops(k), links(k) < 0, distances(k), angles(k))
         if (.not. group%given(letter//'LINK') .or. .not. group%given(letter//'LOOP')) cycle
         if (size(ilink) == 0) cycle   ! the shape of the arrays is wrong and told
         if (loops(k) < 1 .or. loops(k) > size(ilink, 2)) then
            call out_of(group, letter//'LOOP', 'entry '//to_text(k)//': there is no loop '//to_text(loops(k)), findings, k)
         else if (links(k) == 0 .or. places(k)%arc > size(ilink, 1)) then
            call out_of(group, letter//'LINK', 'entry '//to_text(k)//': there is no arc '//to_text(links(k))//' in loop '// &
                        to_text(loops(k)), findings, k)
         else if (ilink(places(k)%arc, loops(k)) == 0) then
            call out_of(group, letter//'LINK', 'entry '//to_text(k)//': there is no arc '//to_text(places(k)%arc)//' in loop '// &
                        to_text(loops(k)), findings, k)
         end if
      end do
   end subroutine read_places

   !> Report the first entry of an item that is not as it must be.
   subroutine refuse_unless(right, group, item, text, findings)
      logical, intent(in) :: right(:)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: item, text
      type(diagnostics_t), intent(inout) :: findings
      integer :: k

      k = findloc(right, .false., dim=1)
      if (k > 0) call out_of(group, item, 'entry '//to_text(k)//': '//text, findings, k)
   end subroutine refuse_unless
end module psalm_link_place
