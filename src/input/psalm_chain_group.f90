!> The groups of a sketch: &CHAIN, the joints, links and slides; &DRIVES, what moves them; &OUTPUTS, what is wanted of them.
!>
!> Everything is given by name. What is judged here is each item by itself and the names in it; whether the links make a
!> mechanism is judged in `psalm_freedom`.
module psalm_chain_group
   use psalm_group, only: group_t, out_of, required, read_flag
   use psalm_kinds, only: wp
   use psalm_sketch, only: sketch_t, link_t, output_t, variation_t, position_of, sketch_name, frame_link, &
                           drive_turns, drive_slides, drive_stretches, output_point, output_angle, output_distance, &
                           output_slide, output_between, output_pose, output_ratio, output_x, output_y, vary_length, vary_angle, &
                              vary_place, &
                           vary_input
   use psalm_status, only: diagnostics_t
   use psalm_text, only: lower_case, nearest_name, shortened, to_text
   implicit none (type, external)
   private
   public :: read_chain_group, read_drives_group, read_outputs_group
   public :: find_joints, link_named, meant, slide_names, words_of

   integer, parameter :: word_room = 2*sketch_name !! of a word within a text; longer ones are no names
   real(wp), parameter :: one_place = 1.0e-9_wp !! joints of a link nearer than so much of the drawing's size coincide

contains

   !> Read &CHAIN. Errors: names that are missing, given twice or unknown, numbers that do not fit, joints that coincide.
   subroutine read_chain_group(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      type(diagnostics_t) :: own, unused
      integer :: kover, i, stage

      sketch%given = group%line > 0
      own%file = findings%file
      allocate (sketch%drives(0), sketch%outputs(0))
      ! what follows from a mistake is not told: a later stage speaks only if those before found nothing
      do stage = 1, 7
         if (own%failed()) then
            call read_stage(unused)
         else
            call read_stage(own)
         end if
      end do
      if (.not. own%failed()) call check_places(group, sketch, own)
      do i = 1, own%count
         call findings%add(own%list(i))
      end do

   contains

      subroutine read_stage(told)
         type(diagnostics_t), intent(inout) :: told

         select case (stage)
         case (1)
            call read_joints(group, sketch, told)
         case (2)
            call read_links(group, sketch, told)
         case (3)
            call read_slides(group, sketch, told)
         case (4)
            call read_gears(group, sketch, told)
         case (5)
            kover = 0
            call read_flag(group, 'KOVER', kover, told)
            sketch%over_braced = kover == 1
         case (6)
            call read_lengths(group, sketch, told)
         case default
            call read_variations(group, sketch, told)
         end select
      end subroutine read_stage
   end subroutine read_chain_group

   subroutine read_joints(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:)
      integer :: i, n, last_x, last_y

      call group%get_texts('JNT', names, findings)
      n = size(names)
      if (n == 0) call required(group, 'JNT', "names the joints, JNT='A','B','C'")
      allocate (sketch%joint_name(n), sketch%x(n), sketch%y(n))
      sketch%x = 0.0_wp
      sketch%y = 0.0_wp
      call group%get_reals('JX', sketch%x, findings, last=last_x)
      call group%get_reals('JY', sketch%y, findings, last=last_y)
      do i = 1, n
         call take_name(group, 'JNT', i, names(i), 'joint', sketch%joint_name(:i - 1), findings, sketch%joint_name(i))
      end do
      if (n == 0) return
      call count_of('JX', last_x)
      if (last_x >= n .or. last_y == 0) call count_of('JY', last_y)

   contains

      subroutine count_of(item, got)
         character(*), intent(in) :: item
         integer, intent(in) :: got

         if (got == 0) then
            call required(group, item, 'places the '//to_text(n)//' joints of JNT in the drawing')
         else if (got < n) then
            call out_of(group, item, 'places '//to_text(got)//' of '//to_text(n)//' joints; joint '// &
                        trim(sketch%joint_name(got + 1))//' has no place', findings, got)
         end if
      end subroutine count_of
   end subroutine read_joints

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

   subroutine read_links(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: lists(:), names(:)
      character(sketch_name), allocatable :: taken(:)
      logical :: valid
      integer :: i, j, n

      call group%get_texts('LNK', lists, findings)
      call group%get_texts('LNAME', names, findings)
      n = size(lists)
      if (n == 0) call required(group, 'LNK', "lists the joints of each link, the frame first: LNK='A D','A B','B C','C D'")
      allocate (sketch%links(n), taken(0))
      if (size(names) > 0 .and. size(names) /= n .and. n > 0) then
         call out_of(group, 'LNAME', 'names '//to_text(size(names))//' links, but LNK lists '//to_text(n), findings, size(names))
         names = names(:0)
      end if
      do i = 1, n
         if (i <= size(names)) then
            call take_name(group, 'LNAME', i, names(i), 'link', taken, findings, sketch%links(i)%name)
            if (i > frame_link .and. lower_case(trim(names(i))) == 'frame' .and. sketch%links(1)%name /= 'frame') then
               call out_of(group, 'LNAME', 'the frame is the first link of LNK, but link '//to_text(i)//' is called '// &
                           trim(names(i))//'; put it first', findings, i)
            end if
         else
            sketch%links(i)%name = to_text(i)
         end if
         taken = [character(sketch_name) :: taken, sketch%links(i)%name]
         call find_joints(group, 'LNK', i, lists(i), 'link '//trim(sketch%links(i)%name), sketch, findings, &
                          sketch%links(i)%joints, valid)
         if (.not. valid) cycle
         do j = 2, size(sketch%links(i)%joints)
            associate (joint => sketch%links(i)%joints(j))
               if (any(sketch%links(i)%joints(:j - 1) == joint)) call out_of(group, 'LNK', 'link '// &
                  trim(sketch%links(i)%name)//' has joint '//trim(sketch%joint_name(joint))//' twice', findings, i)
            end associate
         end do
      end do
      if (n == 1) call out_of(group, 'LNK', 'a mechanism has a frame and at least one moving link; only one link is listed', &
                              findings, 1)
      do j = 1, size(sketch%joint_name)
         if (findings%failed()) exit
         if (size(sketch%links_of(j)) > 0) cycle
         call out_of(group, 'JNT', &
            'joint '//trim(sketch%joint_name(j))//' belongs to no link; add it to a link of LNK or leave '// &
                     'it out', findings, j)
      end do
   end subroutine read_links

   !> The joints named in a text, with blanks between them; one-letter names may run together.
   subroutine find_joints(group, item, which, text, whose, sketch, findings, joints, valid)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: item, text, whose
      integer, intent(in) :: which
      type(sketch_t), intent(in) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable, intent(out) :: joints(:)
      logical, intent(out) :: valid
      character(word_room), allocatable :: words(:)
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
      character(word_room), allocatable :: words(:)
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
         words = [character(word_room) :: words, text(from:to)]
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

   subroutine read_slides(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:), first(:), second(:)
      character(sketch_name), allocatable :: taken(:)
      real(wp), allocatable :: x(:), y(:), angle(:)
      integer :: n, i, j, last(3)

      n = 0
      call group%get_integer('NSLIDE', n, findings)
      call group%get_texts('SNAME', names, findings)
      call group%get_texts('SLNK', first, findings)
      call group%get_texts('SLNK2', second, findings)
      if (n < 0 .or. n > 1000) call out_of(group, 'NSLIDE', 'must be a number of slides, 0 or more', findings)
      if (.not. group%given('NSLIDE')) n = size(first)
      n = max(0, min(n, 1000))
      allocate (x(n), y(n), angle(n), source=0.0_wp)
      call group%get_reals('SLX', x, findings, last=last(1))
      call group%get_reals('SLY', y, findings, last=last(2))
      call group%get_reals('SLANG', angle, findings, last=last(3))
      allocate (sketch%slides(n))
      if (n == 0) then
         if (size(first) > 0) call out_of(group, 'SLNK', 'names links of slides, but NSLIDE=0 says that there are none', findings)
         return
      end if
      if (size(first) /= n) call out_of(group, 'SLNK', 'names the first link of '//to_text(size(first))//' slides; there are '// &
                                        to_text(n), findings)
      if (size(second) /= n) call out_of(group, 'SLNK2', 'names the second link of '//to_text(size(second))// &
                                         ' slides; there are '//to_text(n), findings)
      do i = 1, 3
         if (last(i) < n) call out_of(group, merge('SLX  ', merge('SLY  ', 'SLANG', i == 2), i == 1), 'is given for '// &
                                      to_text(last(i))//' slides; there are '//to_text(n), findings)
      end do
      allocate (taken(0))
      do i = 1, n
         associate (slide => sketch%slides(i))
            slide%x = x(i)
            slide%y = y(i)
            slide%angle = angle(i)
            slide%name = 'S'//to_text(i)
            if (i <= size(names)) call take_name(group, 'SNAME', i, names(i), 'slide', taken, findings, slide%name)
            taken = [character(sketch_name) :: taken, slide%name]
            if (sketch%joint_called(trim(slide%name)) > 0) call out_of(group, merge('SNAME', 'JNT  ', i <= size(names)), &
               'both a joint and a slide are called '//trim(slide%name), findings, i)
            if (i <= size(first)) slide%links(1) = link_named(group, 'SLNK', i, first(i), sketch, findings)
            if (i <= size(second)) slide%links(2) = link_named(group, 'SLNK2', i, second(i), sketch, findings)
            if (any(slide%links == 0)) cycle
            if (slide%links(1) == slide%links(2)) then
               call out_of(group, 'SLNK2', 'slide '//trim(slide%name)//' has link '// &
                           trim(sketch%links(slide%links(1))%name)//' on both sides; name the link that it moves on', findings, i)
               cycle
            end if
            do j = 1, size(sketch%joint_name)
               if (.not. (sketch%has_joint(slide%links(1), j) .and. sketch%has_joint(slide%links(2), j))) cycle
               call out_of(group, 'SLNK2', 'slide '//trim(slide%name)//' is between links '// &
                           trim(sketch%links(slide%links(1))%name)//' and '//trim(sketch%links(slide%links(2))%name)// &
                           ', which joint '//trim(sketch%joint_name(j))//' pins together already; a pin in a slot needs a '// &
                           'block, a link of its own with the pin', findings, i)
            end do
            do j = 1, i - 1
               if (any(sketch%slides(j)%links == slide%links(1)) .and. any(sketch%slides(j)%links == slide%links(2))) &
                  call out_of(group, 'SLNK2', 'slides '//trim(sketch%slides(j)%name)//' and '//trim(slide%name)// &
                              ' join the same two links '//trim(sketch%links(slide%links(1))%name)//' and '// &
                              trim(sketch%links(slide%links(2))%name)//'; one is too many', findings, i)
            end do
         end associate
      end do
   end subroutine read_slides

   !> Gears whose centres a carrier holds: GEARA, GEARB, the carrier GCARR, the teeth GTA, GTB (GTB negative: an internal pair).
   subroutine read_gears(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: first(:), second(:), carrier(:)
      real(wp), allocatable :: teeth_a(:), teeth_b(:)
      integer :: n, i

      call group%get_texts('GEARA', first, findings)
      call group%get_texts('GEARB', second, findings)
      call group%get_texts('GCARR', carrier, findings)
      n = size(first)
      allocate (teeth_a(n), teeth_b(n), source=0.0_wp)
      call group%get_reals('GTA', teeth_a, findings)
      call group%get_reals('GTB', teeth_b, findings)
      allocate (sketch%gears(n))
      if (size(second) /= n) call out_of(group, 'GEARB', 'names the second wheel of '//to_text(size(second))//' gear pairs; '// &
                                         'GEARA names '//to_text(n), findings)
      if (size(carrier) /= n) call out_of(group, 'GCARR', 'names the carrier of '//to_text(size(carrier))//' gear pairs; '// &
                                          'GEARA names '//to_text(n), findings)
      do i = 1, min(n, size(second), size(carrier))
         associate (gear => sketch%gears(i))
            gear%wheels(1) = link_named(group, 'GEARA', i, first(i), sketch, findings)
            gear%wheels(2) = link_named(group, 'GEARB', i, second(i), sketch, findings)
            gear%carrier = link_named(group, 'GCARR', i, carrier(i), sketch, findings)
            if (teeth_a(i) == 0.0_wp .or. teeth_b(i) == 0.0_wp) then
               call out_of(group, 'GTA', &
                  'gear pair '//to_text(i)//' needs the teeth of both wheels, GTA and GTB; of an internal '// &
                           'pair one is negative', findings, i)
               cycle
            end if
            gear%ratio = -teeth_a(i)/teeth_b(i)
            if (any(gear%wheels == 0) .or. gear%carrier == 0) cycle
            if (gear%wheels(1) == gear%wheels(2) .or. any(gear%wheels == gear%carrier)) then
               call out_of(group, 'GEARB', 'a gear pair has three different links: two wheels and the carrier of both', &
                  findings, i)
               cycle
            end if
            call check_wheel(1)
            call check_wheel(2)
         end associate
      end do

   contains

      subroutine check_wheel(which)
         integer, intent(in) :: which
         integer :: j

         associate (gear => sketch%gears(i))
            do j = 1, size(sketch%joint_name)
               if (sketch%has_joint(gear%wheels(which), j) .and. sketch%has_joint(gear%carrier, j)) return
            end do
            call out_of(group, 'GCARR', 'link '//trim(sketch%links(gear%carrier)%name)//' carries wheel '// &
                        trim(sketch%links(gear%wheels(which))%name)//', but no joint pins them together', findings, i)
         end associate
      end subroutine check_wheel
   end subroutine read_gears

   !> Exact lengths, where the drawing is rough.
   subroutine read_lengths(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: pairs(:)
      integer, allocatable :: joints(:)
      logical :: valid
      integer :: n, i, last

      call group%get_texts('LENP', pairs, findings)
      n = size(pairs)
      allocate (sketch%length_of(2, n), source=0)
      allocate (sketch%length(n), source=0.0_wp)
      call group%get_reals('LENV', sketch%length, findings, last=last)
      if (last < n) call out_of(group, 'LENV', 'LENP names '//to_text(n)//' lengths, but LENV gives '//to_text(last), &
         findings, last)
      do i = 1, n
         call find_joints(group, 'LENP', i, pairs(i), "length '"//trim(pairs(i))//"'", sketch, findings, joints, valid)
         if (.not. valid) cycle
         if (size(joints) /= 2) then
            call out_of(group, 'LENP', &
               "length '"//trim(pairs(i))//"' names "//to_text(size(joints))//' joints; a length lies '// &
                        'between two', findings, i)
            cycle
         end if
         sketch%length_of(:, i) = joints
         if (sketch%length(i) <= 0.0_wp .and. i <= last) call out_of(group, 'LENV', "length '"//trim(pairs(i))// &
                                                                     "' must be above zero", findings, i)
         if (joints(1) == joints(2)) then
            call out_of(group, 'LENP', "length '"//trim(pairs(i))//"' lies between a joint and itself", findings, i)
         else if (common_link(sketch, joints) == 0) then
            call out_of(group, 'LENP', "no link has both joints of the length '"//trim(pairs(i))//"'", findings, i)
         end if
         call find_repeated(i)
      end do

   contains

      subroutine find_repeated(i)
         integer, intent(in) :: i
         integer :: j

         do j = 1, i - 1
            if (all(sketch%length_of(:, j) == joints) .or. all(sketch%length_of(:, j) == joints(2:1:-1))) &
               call out_of(group, 'LENP', "length '"//trim(pairs(i))//"' is given twice", findings, i)
         end do
      end subroutine find_repeated
   end subroutine read_lengths

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

   !> What may vary: 'A B' a length, 'angle A B A C' an angle of a link, 'place D' a joint of the frame, 'input'.
   subroutine read_variations(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: texts(:)
      character(word_room), allocatable :: words(:)
      character(:), allocatable :: whose
      real(wp), allocatable :: low(:), high(:)
      integer, allocatable :: joints(:)
      integer :: n, i, last_low, last_high, wanted, at
      logical :: valid

      call group%get_texts('VARY', texts, findings)
      n = size(texts)
      allocate (sketch%variations(n))
      allocate (low(2*n), high(2*n), source=0.0_wp)
      call group%get_reals('VLOW', low, findings, last=last_low)
      call group%get_reals('VHIGH', high, findings, last=last_high)
      at = 0
      do i = 1, n
         whose = "'"//trim(adjustl(texts(i)))//"'"
         words = words_of(texts(i))
         associate (one => sketch%variations(i))
            one%kind = vary_length
            wanted = 2
            if (size(words) == 0) then
               call out_of(group, 'VARY', 'variable '//to_text(i)//' is empty', findings, i)
               cycle
            end if
            select case (lower_case(trim(words(1))))
            case ('angle')
               one%kind = vary_angle
               wanted = 4
            case ('place')
               one%kind = vary_place
               wanted = 1
            case ('input')
               one%kind = vary_input
               wanted = 0
            case ('length')
               continue
            case default
               words = [character(word_room) :: 'length', words]
            end select
            if (at + width_of(one) <= min(last_low, last_high)) then
               one%bounded = .true.
               one%low(:width_of(one)) = low(at + 1:at + width_of(one))
               one%high(:width_of(one)) = high(at + 1:at + width_of(one))
               if (any(one%low > one%high)) call out_of(group, 'VLOW', &
                  'the lower bound of '//whose//' is above its upper bound', &
                                                        findings, at + 1)
            end if
            at = at + width_of(one)
            call find_joints(group, 'VARY', i, joined(words(2:)), whose, sketch, findings, joints, valid)
            if (.not. valid) cycle
            if (size(joints) /= wanted) then
               call out_of(group, 'VARY', whose//' names '//to_text(size(joints))//' joints, not '//to_text(wanted)// &
                           "; there are 'A B', 'angle A B A C', 'place D', 'input'", findings, i)
               cycle
            end if
            one%joints(:wanted) = joints
            if (one%kind == vary_place) then
               if (.not. sketch%has_joint(frame_link, joints(1))) call out_of(group, 'VARY', &
                  whose//': the joint is not on the frame', &
                                                                              findings, i)
            else if (wanted > 0) then
               if (common_link(sketch, joints) == 0) call out_of(group, 'VARY', whose//': no link has all these joints', &
                  findings, i)
            end if
         end associate
      end do
      if (last_low /= last_high .or. (last_low > 0 .and. last_low /= at)) then
         call out_of(group, merge('VLOW ', 'VHIGH', last_low /= at), &
            'bounds are given for all variables or for none: '//to_text(at)// &
                     ' values each (a place has two, x and y); found '//to_text(last_low)//' and '//to_text(last_high), findings)
      end if

   contains

      pure integer function width_of(one)
         type(variation_t), intent(in) :: one

         width_of = merge(2, 1, one%kind == vary_place)
      end function width_of
   end subroutine read_variations

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

   !> Joints of a link at one place, where the drawing tells no direction.
   subroutine check_places(group, sketch, findings)
      type(group_t), intent(in) :: group
      type(sketch_t), intent(in) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      real(wp) :: size_of
      integer :: i, j, k

      if (size(sketch%x) == 0) return
      size_of = max(maxval(sketch%x) - minval(sketch%x), maxval(sketch%y) - minval(sketch%y))
      do i = 1, size(sketch%links)
         associate (joints => sketch%links(i)%joints)
            do j = 2, size(joints)
               do k = 1, j - 1
                  if (max(abs(sketch%x(joints(j)) - sketch%x(joints(k))), abs(sketch%y(joints(j)) - sketch%y(joints(k)))) &
                      > one_place*size_of) cycle
                  call out_of(group, 'JX', 'joints '//trim(sketch%joint_name(joints(k)))//' and '// &
                              trim(sketch%joint_name(joints(j)))//' of link '//trim(sketch%links(i)%name)// &
                              ' are at the same place; move one, or give both one name', findings, joints(j))
               end do
            end do
         end associate
      end do
   end subroutine check_places

   ! ---- drives ------------------------------------------------------------------------------------------------------

   !> Read &DRIVES. A drive is a joint, a slide, or two joints with a cylinder between them, which becomes a link.
   subroutine read_drives_group(group, positions, sketch, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: positions        !! NDES
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:), bases(:), links(:)
      character(word_room), allocatable :: words(:)
      real(wp), allocatable :: ratio(:), phase(:), delt(:)
      character(:), allocatable :: item
      integer :: n, announced, i, j, last_ratio, last
      logical :: valid, grid

      call group%get_texts('DRIVE', names, findings)
      call group%get_texts('DBASE', bases, findings)
      call group%get_texts('DLINK', links, findings)
      n = size(names)
      announced = n
      call group%get_integer('NDRIVE', announced, findings)
      allocate (ratio(max(1, n)), phase(max(1, n)), source=0.0_wp)
      call group%get_reals('RATIO', ratio, findings, last=last_ratio)
      call group%get_reals('PHASE', phase, findings)
      if (n == 0) call required(group, 'DRIVE', "names what is driven: a joint, a slide, or the two joints of a cylinder")
      if (announced /= n .and. n > 0) call out_of(group, 'NDRIVE', &
         'NDRIVE='//to_text(announced)//' drives are announced, but '// &
                                                  'DRIVE names '//to_text(n), findings)
      if (allocated(sketch%drives)) deallocate (sketch%drives)
      allocate (sketch%drives(n))
      do i = 1, n
         associate (drive => sketch%drives(i))
            words = apart(words_of(names(i)))
            drive%name = trim(adjustl(names(i)))
            select case (size(words))
            case (1)
               drive%joint = sketch%joint_called(trim(words(1)))
               drive%slide = sketch%slide_called(trim(words(1)))
               if (drive%slide > 0) then
                  drive%kind = drive_slides
               else if (drive%joint > 0) then
                  drive%kind = drive_turns
               else
                  call out_of(group, 'DRIVE', "no joint or slide is called '"//trim(words(1))//"'"// &
                              meant(trim(words(1)), [character(sketch_name) :: sketch%joint_name, slide_names(sketch)]), &
                                 findings, i)
                  cycle
               end if
               call find_links(valid)
               if (.not. valid) cycle
            case (2)
               drive%kind = drive_stretches
               call add_cylinder(valid)
               if (.not. valid) cycle
            case default
               call out_of(group, 'DRIVE', &
                  "'"//shortened(trim(names(i)))//"' is no drive: a joint, a slide, or the two joints "// &
                           'of a cylinder', findings, i)
               cycle
            end select
            do j = 1, i - 1
               if (sketch%drives(j)%kind == drive%kind .and. sketch%drives(j)%joint == drive%joint .and. &
                   sketch%drives(j)%slide == drive%slide .and. drive%kind /= drive_stretches .and. &
                   sketch%drives(j)%base == drive%base .and. sketch%drives(j)%link == drive%link) &
                  call out_of(group, 'DRIVE', 'drives '//to_text(j)//' and '//to_text(i)//' are both at '//trim(drive%name)// &
                              '; one moves it', findings, i)
            end do
            drive%ratio = ratio(i)
            drive%phase = phase(i)
            drive%geared = i <= last_ratio .and. ratio(i) /= 0.0_wp
            if (i == 1 .and. drive%geared) then
               call out_of(group, 'RATIO', 'the first drive is the one that the others follow; its own RATIO is 0', findings, 1)
            end if
         end associate
      end do
      call read_speeds()
      call read_grid(grid)
      do i = 2, max(n, 2)
         item = 'DELT'//to_text(i)
         if (allocated(delt)) deallocate (delt)
         allocate (delt(positions), source=0.0_wp)
         call group%get_reals(item, delt, findings, last=last)
         if (i > n) exit
         associate (drive => sketch%drives(i))
            if (last > 0 .and. grid) then
               call out_of(group, item, 'the grid NGRID gives the positions of all drives; leave '//item//' out', findings, 1)
            else if (last > 0 .and. drive%geared) then
               call out_of(group, item, 'drive '//trim(drive%name)//' has RATIO too; give one of both', findings, 1)
            else if (last > 0 .and. last < positions) then
               call out_of(group, item, 'NDES='//to_text(positions)//' positions are announced, but only '//to_text(last)// &
                           ' values given', findings, last)
            else if (last == 0 .and. .not. drive%geared .and. .not. grid) then
               call required(group, item, 'drive '//trim(drive%name)//' needs its values, '//item// &
                             ', or a RATIO to the first drive')
            end if
            if (last > 0) drive%delt = delt
         end associate
      end do

   contains

      !> Speeds and accelerations of drives that neither are the first nor follow it.
      subroutine read_speeds()
         character(*), parameter :: items(2) = [character(6) :: 'DSPEED', 'DACCEL']
         real(wp) :: values(max(1, n))
         integer :: k, d, highest

         do k = 1, size(items)
            values = 0.0_wp
            call group%get_reals(trim(items(k)), values, findings, last=highest)
            do d = 1, min(n, highest)
               if (d == 1 .and. abs(values(1)) > 0.0_wp) then
                  call out_of(group, trim(items(k)), 'the first drive has the speed of &RATES; its entry here is 0', findings, 1)
               else if (sketch%drives(d)%geared .and. abs(values(d)) > 0.0_wp) then
                  call out_of(group, trim(items(k)), 'drive '//trim(sketch%drives(d)%name)// &
                              ' follows the first by its RATIO; its entry here is 0', findings, d)
               end if
            end do
            if (k == 1) sketch%drives%speed = values(:n)
            if (k == 2) sketch%drives%accel = values(:n)
         end do
      end subroutine read_speeds

      !> A grid of strokes: NGRID values of each drive, evenly from DLOW to DHIGH.
      subroutine read_grid(given)
         logical, intent(out) :: given
         integer :: counts(max(1, n)), last_count, last_low, last_high, d
         real(wp) :: low(max(1, n)), high(max(1, n))

         counts = 0
         low = 0.0_wp
         high = 0.0_wp
         call group%get_integers('NGRID', counts, findings, last=last_count)
         call group%get_reals('DLOW', low, findings, last=last_low)
         call group%get_reals('DHIGH', high, findings, last=last_high)
         given = last_count > 0
         if (n == 0) return
         if (.not. given) then
            if (last_low > 0) call out_of(group, 'DLOW', 'belongs to a grid of strokes, but NGRID is missing', findings, 1)
            if (last_high > 0) call out_of(group, 'DHIGH', 'belongs to a grid of strokes, but NGRID is missing', findings, 1)
            return
         end if
         do d = 1, n
            associate (drive => sketch%drives(d))
               if (drive%geared) then
                  if (counts(d) /= 0) call out_of(group, 'NGRID', 'drive '//trim(drive%name)// &
                                                  ' follows the first by its RATIO; its NGRID is 0', findings, d)
               else if (counts(d) < 2) then
                  call out_of(group, 'NGRID', 'drive '//trim(drive%name)//' needs 2 values or more in a grid; found '// &
                              to_text(counts(d)), findings, d)
               else if (max(last_low, last_high) < d .or. .not. low(d) < high(d)) then
                  call out_of(group, 'DLOW', 'the stroke of drive '//trim(drive%name)//' goes from DLOW up to DHIGH', findings, d)
               end if
               drive%steps = counts(d)
               drive%low = low(d)
               drive%high = high(d)
            end associate
         end do
      end subroutine read_grid

      !> Two one-letter joints that run together are two words.
      function apart(words) result(parts)
         character(word_room), intent(in) :: words(:)
         character(word_room), allocatable :: parts(:)

         parts = words
         if (size(words) /= 1) return
         if (len_trim(words(1)) /= 2) return
         if (max(sketch%joint_called(trim(words(1))), sketch%slide_called(trim(words(1)))) > 0) return
         if (sketch%joint_called(words(1)(1:1)) == 0 .or. sketch%joint_called(words(1)(2:2)) == 0) return
         parts = [character(word_room) :: words(1)(1:1), words(1)(2:2)]
      end function apart

      !> The two links between which a drive acts.
      subroutine find_links(valid)
         logical, intent(out) :: valid
         integer, allocatable :: at(:)

         valid = .false.
         associate (drive => sketch%drives(i))
            if (drive%kind == drive_slides) then
               at = sketch%slides(drive%slide)%links
            else
               at = sketch%links_of(drive%joint)
            end if
            if (size(at) == 0) return   ! told of JNT
            if (size(at) < 2) then
               call out_of(group, 'DRIVE', &
                  'joint '//trim(drive%name)//' belongs to one link only, '//trim(sketch%links(at(1))%name)// &
                           '; a drive acts between two', findings, i)
               return
            end if
            if (i <= size(bases)) then
               if (len_trim(bases(i)) > 0) then
                  drive%base = link_named(group, 'DBASE', i, bases(i), sketch, findings)
                  if (drive%base == 0) return
               end if
            end if
            if (i <= size(links)) then
               if (len_trim(links(i)) > 0) then
                  drive%link = link_named(group, 'DLINK', i, links(i), sketch, findings)
                  if (drive%link == 0) return
               end if
            end if
            if (size(at) == 2) then
               if (drive%base == 0 .and. drive%link == 0) drive%base = minval(at)
               if (drive%base == 0) drive%base = sum(at) - drive%link
               if (drive%link == 0) drive%link = sum(at) - drive%base
            else if (drive%base == 0 .or. drive%link == 0) then
               call out_of(group, 'DRIVE', 'joint '//trim(drive%name)//' pins '//to_text(size(at))// &
                           ' links; say with DBASE and DLINK which of them the drive acts between', findings, i)
               return
            end if
            if (all(at /= drive%base)) then
               call not_there('DBASE', drive%base)
            else if (all(at /= drive%link)) then
               call not_there('DLINK', drive%link)
            else if (drive%base == drive%link) then
               call out_of(group, 'DLINK', 'drive '//trim(drive%name)//' has link '//trim(sketch%links(drive%link)%name)// &
                           ' on both sides', findings, i)
            else
               valid = .true.
            end if
         end associate
      end subroutine find_links

      subroutine not_there(item, link)
         character(*), intent(in) :: item
         integer, intent(in) :: link

         call out_of(group, item, 'link '//trim(sketch%links(link)%name)//' has no part in '//trim(sketch%drives(i)%name)// &
                     ', which the drive acts at', findings, i)
      end subroutine not_there

      !> A link of two joints whose length is driven.
      subroutine add_cylinder(valid)
         logical, intent(out) :: valid
         integer, allocatable :: joints(:)
         type(link_t) :: cylinder
         integer :: k

         call find_joints(group, 'DRIVE', i, names(i), "cylinder '"//trim(names(i))//"'", sketch, findings, joints, valid)
         if (.not. valid) return
         valid = .false.
         if (size(joints) /= 2) then
            call out_of(group, 'DRIVE', "cylinder '"//trim(names(i))//"' names "//to_text(size(joints))//' joints, not two', &
                        findings, i)
            return
         end if
         k = common_link(sketch, joints)
         if (k > 0) then
            call out_of(group, 'DRIVE', "cylinder '"//trim(names(i))//"' lies between two joints of link "// &
                        trim(sketch%links(k)%name)//', which holds them apart', findings, i)
            return
         end if
         cylinder%name = trim(sketch%joint_name(joints(1)))//'-'//trim(sketch%joint_name(joints(2)))
         cylinder%joints = joints
         sketch%links = [sketch%links, cylinder]
         sketch%drives(i)%link = size(sketch%links)
         valid = .true.
      end subroutine add_cylinder
   end subroutine read_drives_group

   ! ---- outputs -----------------------------------------------------------------------------------------------------

   !> Read &OUTPUTS: 'point P', 'x P', 'angle rocker', 'angle A B', 'distance E F', 'slide S1', 'between A B C D', 'pose P rocker',
   !> 'ratio shock wheel' (of the rates of two outputs by their names).
   subroutine read_outputs_group(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: texts(:), names(:)
      character(word_room), allocatable :: words(:)
      character(sketch_name), allocatable :: taken(:)
      integer :: n, i

      call group%get_texts('OUTPUT', texts, findings)
      call group%get_texts('ONAME', names, findings)
      n = size(texts)
      if (group%line > 0 .and. n == 0) call required(group, 'OUTPUT', "says what is wanted: OUTPUT='point P','angle rocker'")
      if (allocated(sketch%outputs)) deallocate (sketch%outputs)
      allocate (sketch%outputs(n), taken(0))
      do i = 1, n
         words = words_of(texts(i))
         if (i <= size(names)) then
            call take_name(group, 'ONAME', i, names(i), 'output', taken, findings, sketch%outputs(i)%name)
         else
            sketch%outputs(i)%name = default_name()
            if (position_of(sketch%outputs(i)%name, taken) > 0) call out_of(group, 'OUTPUT', &
               "output '"//trim(texts(i))//"' is given twice", &
                                                                  findings, i)
         end if
         taken = [character(sketch_name) :: taken, sketch%outputs(i)%name]
         if (size(words) == 0) then
            call out_of(group, 'OUTPUT', 'output '//to_text(i)//' is empty', findings, i)
            cycle
         end if
         call understand(sketch%outputs(i))
      end do

   contains

      pure function default_name() result(name)
         character(sketch_name) :: name
         integer :: k

         name = ''
         if (size(words) > 0) name = trim(words(1))
         do k = 2, size(words)
            name = trim(name)//'_'//trim(words(k))
         end do
      end function default_name

      subroutine understand(output)
         type(output_t), intent(inout) :: output
         integer :: k

         select case (lower_case(trim(words(1))))
         case ('point')
            output%kind = output_point
            call joints_of(output, 2, size(words), 1, 0)
         case ('x')
            output%kind = output_x
            call joints_of(output, 2, size(words), 1, 0)
         case ('y')
            output%kind = output_y
            call joints_of(output, 2, size(words), 1, 0)
         case ('angle')
            output%kind = output_angle
            call line_of(output, 2, size(words), 0)
         case ('distance')
            output%kind = output_distance
            if (size(words) == 2) then
               call joints_of(output, 2, 2, 1, 0)
            else
               call joints_of(output, 2, size(words), 2, 0)
            end if
         case ('slide')
            output%kind = output_slide
            if (size(words) /= 2) then
               call wrong("'slide S1' names one slide")
               return
            end if
            output%slide = sketch%slide_called(trim(words(2)))
            if (output%slide == 0) call wrong("no slide is called '"//trim(words(2))//"'"//meant(trim(words(2)), &
               sketch%slides%name))
         case ('between')
            output%kind = output_between
            if (size(words) == 3) then
               call line_of(output, 2, 2, 0)
               call line_of(output, 3, 3, 2)
            else
               call joints_of(output, 2, size(words), 4, 0)
            end if
         case ('pose')
            output%kind = output_pose
            if (size(words) < 3) then
               call wrong("'pose P rocker' names a joint and a link")
               return
            end if
            call joints_of(output, 2, 2, 1, 0)
            call line_of(output, 3, size(words), 1)
         case ('ratio')
            output%kind = output_ratio
            if (size(words) /= 3) then
               call wrong("'ratio wheel shock' names two outputs given before")
               return
            end if
            do k = 1, 2
               output%outputs(k) = position_of(trim(words(k + 1)), taken(:i - 1))
               if (output%outputs(k) == 0) then
                  call wrong("no output given before is called '"//trim(words(k + 1))//"'"//meant(trim(words(k + 1)), &
                     taken(:i - 1)))
               else if (any(sketch%outputs(output%outputs(k))%kind == [output_point, output_pose, output_ratio])) then
                  call wrong("output '"//trim(words(k + 1))//"' is not one number whose rate has a ratio")
               end if
            end do
         case default
            call wrong("'"//trim(words(1))//"' is no output; there are point, x, y, angle, distance, "// &
                       'slide, between, pose, ratio'// &
                       suggestion())
         end select
      end subroutine understand

      function suggestion() result(text)
         character(:), allocatable :: text

         text = ''
         if (sketch%joint_called(trim(words(1))) > 0 .and. size(words) == 1) text = ": 'point "//trim(words(1))//"'"
         if (sketch%link_called(trim(words(1))) > 0 .and. size(words) == 1) text = ": 'angle "//trim(words(1))//"'"
      end function suggestion

      subroutine wrong(text)
         character(*), intent(in) :: text

         call out_of(group, 'OUTPUT', text, findings, i)
      end subroutine wrong

      subroutine joints_of(output, from, to, wanted, after)
         type(output_t), intent(inout) :: output
         integer, intent(in) :: from, to, wanted, after
         integer, allocatable :: joints(:)
         logical :: valid

         call find_joints(group, 'OUTPUT', i, joined(words(from:to)), "'"//trim(texts(i))//"'", sketch, findings, joints, valid)
         if (.not. valid) return
         if (size(joints) /= wanted) then
            call wrong("'"//trim(texts(i))//"' names "//to_text(size(joints))//' joints; '//to_text(wanted)//' are needed')
            return
         end if
         output%joints(after + 1:after + wanted) = joints
      end subroutine joints_of

      !> A line: that of a link's first two joints, or that from a joint to another.
      subroutine line_of(output, from, to, after)
         type(output_t), intent(inout) :: output
         integer, intent(in) :: from, to, after
         integer :: link

         link = 0
         if (to == from) link = sketch%link_called(trim(words(from)))
         if (link > 0) then
            if (size(sketch%links(link)%joints) < 2) then
               call wrong('link '//trim(words(from))//" has fewer than two joints and so no direction; name another, or "// &
                          "a line 'A B'")
               return
            end if
            output%link = link
            output%joints(after + 1:after + 2) = sketch%links(link)%joints(:2)
         else if (to == from) then
            call wrong("no link is called '"//trim(words(from))//"'"//meant(trim(words(from)), link_names(sketch)))
         else
            call joints_of(output, from, to, 2, after)
         end if
      end subroutine line_of
   end subroutine read_outputs_group
end module psalm_chain_group
