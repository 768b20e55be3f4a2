!> The group PLATES: links that are cut from plate, whose masses follow from their shapes.
module psalm_plate_group
   use psalm_case_group, only: case_group_t, surroundings_t, place_visitor_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_link_place, only: read_places
   use psalm_place, only: place_t
   use psalm_rule, only: rule_t, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t, drive_stretches, frame_link
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: plate_items
   public :: plate_group_t, plate_t, plates_of

   real(wp), parameter :: steel = 7850.0_wp       !! kg/m3

   !> A link that is a plate.
   type :: plate_t
      integer :: entry = 0                        !! of the group
      type(place_t) :: place                      !! of loops: an arc of the link
      type(place_t), allocatable :: corners(:)    !! of a sketch: the joints of the link
      integer :: link = 0                         !! of a sketch
      real(wp) :: thickness = 0.0_wp, width = 0.0_wp, hole = 0.0_wp !! user's length
      real(wp) :: density = steel                 !! kg/m3
   end type plate_t

   type, extends(case_group_t) :: plate_group_t
      logical :: all_links = .false.              !! no link is named: all that move are plates as `plates(1)`, of loops
      type(plate_t), allocatable :: plates(:)
   contains
      procedure :: read => read_plates
      procedure :: visit_places => visit_plates
      procedure :: plate_of_link
   end type plate_group_t

   !> The items of the group.
   type(rule_t), parameter :: plate_items(*) = [ &
      rule_t('NPLATE', a_whole, '', '', 'as many as the longest item has', '[0,100000]', &
             'number of entries; without names of links there is one, for all links that move. Of the sizes the last holds '// &
             'for the entries after it'), &
      rule_t('PLINK', a_whole, 'NPLATE', '', 'all links', '', &
             'an arc of the link, positive'), &
      rule_t('PLOOP', a_whole, 'NPLATE', '', 'all links', '', &
             'the loop of that arc'), &
      rule_t('PNAME', a_text, 'NPLATE', '', 'all links', '', &
             'of a sketch, in place of both: the link'), &
      rule_t('PTHICK', a_number, '1 to NPLATE', 'length', 'required', '(0,)', &
             'thickness', &
             'a thickness is above 0'), &
      rule_t('PWIDTH', a_number, '1 to NPLATE', 'length', '0', '[0,)', &
             'width: the plate reaches half of it beyond the line, or the polygon, of its joints and points, with round ends; '// &
             '0: the polygon alone', &
             'a width is not negative'), &
      rule_t('PHOLE', a_number, '1 to NPLATE', 'length', '0', '[0,)', &
             'diameter of the holes, one at every revolute joint of the link', &
             'a diameter is not negative'), &
      rule_t('PDENS', a_number, '1 to NPLATE', 'kg/m3', '7850', '(0,)', &
             'density; 7850 is steel', &
             'a density is above 0')]

contains

   !> Read the group. Errors: links that are not there, stand twice, are the frame or a cylinder; sizes out of range; holes as wide
   !> as their link.
   subroutine read_plate_group(group, ilink, sketch, plates, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)          !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch        !! its names stand in place of arcs and loops
      type(plate_group_t), intent(inout) :: plates
      type(diagnostics_t), intent(inout) :: findings
      type(place_t), allocatable :: places(:)
      integer, allocatable :: links(:), entries(:) ! by plate
      real(wp), allocatable :: thickness(:), width(:), hole(:), density(:)
      type(diagnostics_t) :: again                !! what is wrong with the texts is reported once
      character(:), allocatable :: names(:)
      logical :: named
      integer :: n, k, l

      plates%given = group%line > 0
      call group%follow(plate_items)
      call take_count(group, 'NPLATE', n, findings)
      if (n == 0 .and. group%given('PTHICK') .and. .not. group%given('NPLATE')) n = 1
      allocate (places(n))
      allocate (thickness(n), width(n), hole(n), source=0.0_wp)
      allocate (density(n), source=steel)
      allocate (plates%plates(0))
      named = group%given('PNAME') .or. group%given('PLINK') .or. group%given('PLOOP')
      call read_places(group, 'P', ilink, places(:merge(n, 0, named)), findings, ends_only=.true., sketch=sketch, of_links=.true.)
      if (sketch%given) then
         call group%get_texts('PNAME', names, again)
         do k = 1, size(names)
            if (scan(trim(adjustl(names(k))), ' ') > 0) call out_of(group, 'PNAME', 'entry '//to_text(k)//' names more than a '// &
                                                                    'link; a plate is a whole link: leave the joints out', &
                                                                    findings, k)
         end do
      end if
      call take(group, 'PTHICK', thickness, findings, repeated=.true.)
      call take(group, 'PWIDTH', width, findings, repeated=.true.)
      call take(group, 'PHOLE', hole, findings, repeated=.true.)
      call take(group, 'PDENS', density, findings, repeated=.true.)
      if (.not. plates%given) return
      if (n == 0) then
         call out_of(group, 'PTHICK', 'the plates have no thickness', findings)
         return
      end if
      do k = 1, n
         if (hole(k) > 0.0_wp .and. hole(k) >= width(k)) call out_of(group, 'PHOLE', 'entry '//to_text(k)//': a hole must be '// &
                                                                     'smaller than the width of the link, PWIDTH', findings, k)
      end do
      if (.not. named .and. n > 1) call out_of(group, 'NPLATE', 'several entries need the names of their links, PNAME (PLINK '// &
                                               'and PLOOP of &LINKS); one without a name is for all links', findings)
      plates%all_links = .not. (named .or. sketch%given)
      if (sketch%given) then
         call choose_links()
      else
         entries = [(k, k=1, merge(n, 1, named))]
         links = 0*entries
      end if
      deallocate (plates%plates)
      allocate (plates%plates(size(entries)))
      do k = 1, size(entries)
         plates%plates(k) = plate_of(entries(k), links(k))
      end do

   contains

      !> The links of a sketch that are plates, and the entries they are plates by.
      subroutine choose_links()

         if (.not. named) then
            links = pack([(l, l=1, size(sketch%links))], [(l /= frame_link .and. .not. is_wheel(sketch, l) .and. &
                                                           .not. is_cylinder(sketch, l), l=1, size(sketch%links))])
            entries = 0*links + 1
            return
         end if
         allocate (links(0), entries(0))
         do k = 1, n
            l = places(k)%link
            if (l == 0) cycle
            if (l == frame_link) then
               call out_of(group, 'PNAME', 'entry '//to_text(k)//' is the frame, whose mass has no effect', findings, k)
            else if (is_cylinder(sketch, l)) then
               call out_of(group, 'PNAME', 'entry '//to_text(k)//' is a cylinder, which is no plate; give its mass in &MASSES', &
                           findings, k)
            else if (any(links == l)) then
               call out_of(group, 'PNAME', 'entry '//to_text(k)//': the link '//trim(sketch%links(l)%name)//' stands twice', &
                           findings, k)
            else
               links = [links, l]
               entries = [entries, k]
            end if
         end do
      end subroutine choose_links

      !> A plate as an entry has it; of a sketch the joints of its link are the corners.
      type(plate_t) function plate_of(entry, link) result(plate)
         integer, intent(in) :: entry, link
         integer :: i

         plate%entry = entry
         plate%place = places(entry)
         plate%link = link
         plate%thickness = thickness(entry)
         plate%width = width(entry)
         plate%hole = hole(entry)
         plate%density = density(entry)
         if (link == 0) return
         associate (joints => sketch%links(link)%joints)
            allocate (plate%corners(size(joints)))
            do i = 1, size(joints)
               plate%corners(i)%link = link
               plate%corners(i)%joint = joints(i)
               if (size(joints) > 1) plate%corners(i)%line = joints(:2)
            end do
         end associate
      end function plate_of
   end subroutine read_plate_group

   pure logical function is_wheel(sketch, link)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: link
      integer :: k

      is_wheel = any([(sketch%gears(k)%wheels == link, k=1, size(sketch%gears))])
   end function is_wheel

   !> True of a link that a drive stretches.
   pure logical function is_cylinder(sketch, link)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: link

      is_cylinder = any(sketch%drives%kind == drive_stretches .and. sketch%drives%link == link)
   end function is_cylinder

   !> The group as the case has it.
   subroutine read_plates(self, group, about, findings)
      class(plate_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_plate_group(group, about%ilink, about%sketch, self, findings)
   end subroutine read_plates

   subroutine visit_plates(self, visitor)
      class(plate_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor
      integer :: k, i

      do k = 1, size(self%plates)
         if (.not. allocated(self%plates(k)%corners)) cycle
         do i = 1, size(self%plates(k)%corners)
            call visitor%place(self%plates(k)%corners(i))
         end do
      end do
   end subroutine visit_plates

   !> Number of the plate that a link of a sketch is; 0: it is none.
   pure integer function plate_of_link(self, link)
      class(plate_group_t), intent(in) :: self
      integer, intent(in) :: link

      plate_of_link = 0
      if (link > 0 .and. size(self%plates) > 0) plate_of_link = findloc(self%plates%link, link, dim=1)
   end function plate_of_link

   !> The group PLATES of a case; without plates where the case does not have it.
   pure function plates_of(set) result(plates)
      class(data_set_t), intent(in) :: set
      type(plate_group_t) :: plates
      integer :: k

      k = set%place_of('PLATES')
      if (k > 0) then
         select type (group => set%sections(k)%group)
         type is (plate_group_t)
            plates = group
         end select
      end if
      if (.not. allocated(plates%plates)) allocate (plates%plates(0))
   end function plates_of
end module psalm_plate_group
