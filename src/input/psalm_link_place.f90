!> Places on links as the groups of forces name them.
module psalm_link_place
   use psalm_sketch_names, only: find_joints, link_named, meant, slide_names, words_of
   use psalm_group, only: group_t, out_of, required
   use psalm_kinds, only: wp
   use psalm_place, only: place_t
   use psalm_sketch, only: sketch_t, sketch_name
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: read_places, refuse_unless

   integer, parameter :: most_exponent = (range(1.0_wp) - modulo(range(1.0_wp), 3))/3 - 2 !! 100 in double precision
   real(wp), parameter :: farthest = 10.0_wp**most_exponent !! of a place: its square, and that times a mass, must be numbers

contains

   !> Places from the items LINK, LOOP, DIST, ANG, each with the group's letter before it; of a sketch NAME for LINK and LOOP.
   !>
   !> Errors: arcs that are not there, or that are not named; links and joints that are not there.
   subroutine read_places(group, letter, ilink, places, findings, ends_only, sketch, of_links)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: letter           !! M for MLINK, MLOOP, MDIST, MANG, MNAME
      integer, intent(in) :: ilink(:, :)           !! ILINK, shape (maxarc, nloop); 0 where there is no arc
      type(place_t), intent(out) :: places(:)      !! shape (entries)
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(in), optional :: ends_only   !! there are no items DIST and ANG: ends of arcs, or joints, are named
      logical, intent(in), optional :: of_links    !! and of a sketch links, with two of their joints
      type(sketch_t), intent(in), optional :: sketch
      character(:), allocatable :: names(:)
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
         do k = 1, size(places)
            if (abs(distances(k)) > farthest) call out_of(group, letter//'DIST', 'entry '//to_text(k)// &
               ': a distance is at most 1E'//to_text(most_exponent)//' in size, for it is squared', findings, k)
         end do
      end if
      places%distance = distances
      places%angle = angles
      if (present(sketch)) then
         call group%get_texts(letter//'NAME', names, findings)
         if (sketch%given) then
            call read_names(group, letter, sketch, names, places, findings, present(ends_only) .and. .not. present(of_links))
            return
         else if (size(names) > 0) then
            call out_of(group, letter//'NAME', 'names parts of a sketch (&CHAIN), but this linkage is described by &LINKS; '// &
                        'give '//letter//'LINK and '//letter//'LOOP', findings)
            return
         end if
      end if
      if (size(places) == 0) return
      if (.not. group%given(letter//'LINK')) call required(group, letter//'LINK')
      if (.not. group%given(letter//'LOOP')) call required(group, letter//'LOOP')
      do k = 1, size(places)
         places(k)%arc = abs(links(k))
         places(k)%loop = loops(k)
         places(k)%from_start = links(k) < 0
         if (.not. group%given(letter//'LINK') .or. .not. group%given(letter//'LOOP')) cycle
         if (size(ilink) == 0) cycle   ! the shape of the arrays is wrong and reported
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

   !> The names of a sketch: `'rod'`, `'rod P'`, `'rod A B'`; of a joint `'A'`, `'A rod'`, `'S1'`.
   subroutine read_names(group, letter, sketch, names, places, findings, of_joints)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: letter, names(:)
      type(sketch_t), intent(in) :: sketch
      type(place_t), intent(inout) :: places(:)
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(in) :: of_joints
      character(:), allocatable :: item
      integer :: k

      item = letter//'NAME'
      if (group%given(letter//'LINK')) call counts_arcs('LINK')
      if (group%given(letter//'LOOP')) call counts_arcs('LOOP')
      if (size(places) == 0 .or. .not. sketch%valid) return   ! what is wrong with the sketch is reported
      if (size(names) == 0) then
         if (of_joints) call required(group, item, "names the joints and slides: "//item//"='A','S1'")
         if (.not. of_joints) call required(group, item, 'names the link of each entry, and the joint that the place is '// &
                                            "counted from: "//item//"='rod','rod B'")
      else if (size(names) /= size(places)) then
         call out_of(group, item, 'has '//to_text(size(names))//' names; there are '//to_text(size(places))//' entries', findings, &
                     min(size(names), size(places)))
      end if
      do k = 1, min(size(names), size(places))
         if (of_joints) then
            call understand_joint(words_of(names(k)))
         else
            call understand_place(words_of(names(k)))
         end if
      end do

   contains

      subroutine counts_arcs(ending)
         character(*), intent(in) :: ending

         call out_of(group, letter//ending, 'counts arcs of &LINKS; a sketch has names, '//item, findings)
      end subroutine counts_arcs

      subroutine wrong(text)
         character(*), intent(in) :: text

         call out_of(group, item, 'entry '//to_text(k)//': '//text, findings, k)
      end subroutine wrong

      subroutine understand_place(words)
         character(*), intent(in) :: words(:)
         integer, allocatable :: joints(:), of_words(:)
         integer :: i
         logical :: valid

         if (size(words) == 0) then
            call wrong('is empty; a link is to be named')
            return
         end if
         places(k)%link = link_named(group, item, k, trim(words(1)), sketch, findings)
         if (places(k)%link == 0) return
         associate (link => sketch%links(places(k)%link), place => places(k))
            allocate (joints(0))
            do i = 2, size(words)
               call find_joints(group, item, k, trim(words(i)), 'entry '//to_text(k), sketch, findings, of_words, valid)
               if (.not. valid) return
               joints = [joints, of_words]
            end do
            do i = 1, size(joints)
               if (any(link%joints == joints(i))) cycle
               call wrong('link '//trim(link%name)//' does not have joint '//trim(sketch%joint_name(joints(i)))//'; it has'// &
                          joints_of(link%joints))
               return
            end do
            if (size(joints) > 2) then
               call wrong("'"//trim(names(k))//"' names more than a link and two joints of it")
               return
            end if
            if (size(link%joints) > 0) place%joint = link%joints(1)
            if (size(link%joints) > 1) place%line = link%joints(:2)
            if (size(joints) > 0) place%joint = joints(1)
            if (size(joints) < 2) return
            if (joints(1) == joints(2)) then
               call wrong('joint '//trim(sketch%joint_name(joints(1)))//' stands twice: no line')
               return
            end if
            place%line = joints
         end associate
      end subroutine understand_place

      function joints_of(joints) result(text)
         integer, intent(in) :: joints(:)
         character(:), allocatable :: text
         integer :: i

         text = ' none'
         if (size(joints) > 0) text = ''
         do i = 1, size(joints)
            text = text//' '//trim(sketch%joint_name(joints(i)))
         end do
      end function joints_of

      subroutine understand_joint(words)
         character(*), intent(in) :: words(:)
         integer, allocatable :: links(:)
         integer :: i

         if (size(words) == 0) then
            call wrong('is empty; a joint or a slide is to be named')
            return
         end if
         associate (place => places(k))
            place%joint = sketch%joint_called(trim(words(1)))
            place%slide = sketch%slide_called(trim(words(1)))
            if (place%joint == 0 .and. place%slide == 0) then
               call wrong("no joint or slide is called '"//trim(words(1))//"'"// &
                          meant(trim(words(1)), [character(sketch_name) :: sketch%joint_name, slide_names(sketch)]))
               return
            end if
            if (size(words) > 2) then
               call wrong("'"//trim(names(k))//"' names more than a joint and a link of it")
               return
            end if
            if (place%slide > 0) then
               if (size(words) > 1) call wrong('a slide has two links; its name alone says which')
               return
            end if
            links = sketch%links_of(place%joint)
            if (size(links) < 2) then
               call wrong('joint '//trim(sketch%joint_name(place%joint))//' is a point of one link; nothing turns in it')
            else if (size(words) == 2) then
               place%link = link_named(group, item, k, trim(words(2)), sketch, findings)
               if (place%link == 0) return
               if (all(links /= place%link)) call wrong('link '//trim(words(2))//' does not have joint '//trim(words(1)))
            else if (size(links) > 2) then
               call wrong('joint '//trim(words(1))//' pins '//to_text(size(links))//" links; name the one that turns in it, '"// &
                          trim(words(1))//' '//trim(sketch%links(links(size(links)))%name)//"'")
            end if
            do i = 1, k - 1
               if (places(i)%joint == place%joint .and. places(i)%slide == place%slide .and. places(i)%link == place%link) &
                  call wrong("'"//trim(names(k))//"' is entry "//to_text(i)//' already')
            end do
         end associate
      end subroutine understand_joint
   end subroutine read_names

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
