!> The group STOPS: limits of joints that a motion in time may hit.
module psalm_stops_group
   use psalm_case_group, only: case_group_t, surroundings_t, place_visitor_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_link_place, only: read_places
   use psalm_place, only: place_t
   use psalm_rule, only: rule_t, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t
   use psalm_sketch_names, only: words_of
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: stops_items
   public :: stops_group_t, stops_of, no_stop

   real(wp), parameter :: no_stop = huge(1.0_wp)  !! in size: there is no stop on this side

   type, extends(case_group_t) :: stops_group_t
      type(place_t), allocatable :: joints(:)     !! shape (entries)
      character(:), allocatable :: names(:)       !! shape (entries): of a sketch, words joined by _, else the number of the entry
      real(wp), allocatable :: low(:), high(:)    !! shape (entries): degrees or user's length from time 0
      real(wp), allocatable :: restitution(:)     !! shape (entries)
   contains
      procedure :: read => read_stops
      procedure :: visit_places => visit_stops
   end type stops_group_t

   !> The items of the group.
   type(rule_t), parameter :: stops_items(*) = [ &
      rule_t('NSTOP', a_whole, '', '', 'as many as the longest item has', '[0,100000]', &
             'number of joints with stops'), &
      rule_t('STLINK', a_whole, 'NSTOP', '', 'required', '', &
             'the joint at the finish of this arc; negative: at its start. The turn of the link of that arc counts'), &
      rule_t('STLOOP', a_whole, 'NSTOP', '', 'required', '', &
             'the loop of that arc'), &
      rule_t('STNAME', a_text, 'NSTOP', '', '', '', &
             'of a sketch, in place of both: the joint or slide; where a joint pins more than two links with the one '// &
             'whose turn counts, `''B rod''`'), &
      rule_t('STLOW', a_number, 'NSTOP', 'degrees, length', 'none', '', &
             'how far the joint turns or slides backwards from time 0, a number that is not above 0; of a sketch the second '// &
             'link in the order of LNAME turns against the first, or SLNK2 slides on SLNK along SLANG'), &
      rule_t('STHIGH', a_number, 'NSTOP', 'degrees, length', 'none', '', &
             'how far it turns or slides forwards, a number that is not below 0'), &
      rule_t('STREST', a_number, 'NSTOP', '', '0', '[0,1]', &
             'coefficient of restitution: speed after an impact by that before; 0: it stays')]

contains

   !> Read the group. Errors: joints that are not there, a joint without a limit, limits on the wrong side of the drawing.
   subroutine read_stops_group(group, ilink, sketch, stops, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)          !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch        !! its names stand in place of arcs and loops
      type(stops_group_t), intent(inout) :: stops
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:)
      integer :: n, k

      stops%given = group%line > 0
      call group%follow(stops_items)
      call take_count(group, 'NSTOP', n, findings)
      allocate (stops%joints(n))
      allocate (stops%low(n), source=-no_stop)
      allocate (stops%high(n), source=no_stop)
      allocate (stops%restitution(n), source=0.0_wp)
      call read_places(group, 'ST', ilink, stops%joints, findings, ends_only=.true., sketch=sketch)
      call group%get_texts('STNAME', names, findings)
      allocate (character(max(len(names), len(to_text(n)))) :: stops%names(n))
      do k = 1, n
         if (k <= size(names)) then
            stops%names(k) = with_underscores(names(k))
         else
            stops%names(k) = to_text(k)
         end if
      end do
      call take(group, 'STLOW', stops%low, findings)
      call take(group, 'STHIGH', stops%high, findings)
      call take(group, 'STREST', stops%restitution, findings)
      do k = 1, n
         if (stops%low(k) <= -no_stop .and. stops%high(k) >= no_stop) then
            call out_of(group, 'STNAME', 'entry '//to_text(k)//' has no limit: give STLOW or STHIGH', findings, k)
         else if (stops%low(k) > 0.0_wp) then
            call out_of(group, 'STLOW', 'entry '//to_text(k)//': the joint is beyond this stop at time 0; limits count from '// &
                        'there, so STLOW is not above 0', findings, k)
         else if (stops%high(k) < 0.0_wp) then
            call out_of(group, 'STHIGH', 'entry '//to_text(k)//': the joint is beyond this stop at time 0; limits count from '// &
                        'there, so STHIGH is not below 0', findings, k)
         else if (.not. stops%low(k) < stops%high(k)) then
            call out_of(group, 'STHIGH', 'entry '//to_text(k)//': the joint has no way between its stops', findings, k)
         end if
      end do
   end subroutine read_stops_group

   !> The words of a name with _ between them, as in names of columns.
   pure function with_underscores(name) result(text)
      character(*), intent(in) :: name
      character(:), allocatable :: text
      integer :: k

      associate (words => words_of(name))
         text = ''
         do k = 1, size(words)
            if (k > 1) text = text//'_'
            text = text//trim(words(k))
         end do
      end associate
   end function with_underscores

   !> The group as the case has it.
   subroutine read_stops(self, group, about, findings)
      class(stops_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_stops_group(group, about%ilink, about%sketch, self, findings)
   end subroutine read_stops

   subroutine visit_stops(self, visitor)
      class(stops_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor
      integer :: k

      do k = 1, size(self%joints)
         call visitor%joint(self%joints(k))
      end do
   end subroutine visit_stops

   !> The group STOPS of a case; without entries where the case does not have it.
   pure function stops_of(set) result(stops)
      class(data_set_t), intent(in) :: set
      type(stops_group_t) :: stops
      integer :: k

      k = set%place_of('STOPS')
      if (k > 0) then
         select type (group => set%sections(k)%group)
         type is (stops_group_t)
            stops = group
         end select
      end if
      if (allocated(stops%joints)) return
      allocate (stops%joints(0), stops%low(0), stops%high(0), stops%restitution(0))
      allocate (character(1) :: stops%names(0))
   end function stops_of
end module psalm_stops_group
