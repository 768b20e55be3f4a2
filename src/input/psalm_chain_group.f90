!> The group &CHAIN of a sketch: joints, links, exact lengths; slides, gears and variables by modules of their own.
!>
!> Everything is given by name. What is assessed here is each item by itself and the names in it; whether the links make a
!> mechanism is assessed in `psalm_freedom`.
module psalm_chain_group
   use psalm_gear_items, only: read_gears
   use psalm_group, only: group_t, out_of, required
   use psalm_kinds, only: wp
   use psalm_rule, only: rule_t, a_flag, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t, sketch_name, frame_link
   use psalm_sketch_names, only: take_name, find_joints, common_link
   use psalm_slide_items, only: read_slides
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_text, only: lower_case, shortened, to_text
   use psalm_variation_items, only: read_variations
   implicit none (type, external)
   private
   public :: chain_items
   public :: read_chain_group

   real(wp), parameter :: one_place = 1.0e-9_wp !! joints of a link nearer than so much of the drawing's size coincide

   !> The items of the group.
   type(rule_t), parameter :: chain_items(*) = [ &
      rule_t('JNT', a_text, 'n', '', 'required', '', &
             'names of the joints: words of up to 31 characters, large and small letters differ'), &
      rule_t('JX', a_number, 'n', 'length', 'required', '', &
             'their x coordinates in the drawing'), &
      rule_t('JY', a_number, 'n', 'length', 'required', '', &
             'their y coordinates in the drawing'), &
      rule_t('LNK', a_text, 'n', '', 'required', '', &
             'the joints of each link, blanks between them (one-letter names may run together); **the first '// &
             'link is the frame**'), &
      rule_t('LNAME', a_text, 'n', '', 'their numbers', '', &
             'names of the links'), &
      rule_t('NSLIDE', a_whole, '', '', 'as many as SLNK has', '[0,1000]', &
             'number of slides (prismatic pairs)', &
             'must be a number of slides, 0 or more'), &
      rule_t('SNAME', a_text, 'NSLIDE', '', 'S1, S2 ...', '', &
             'names of the slides'), &
      rule_t('SLNK', a_text, 'NSLIDE', '', '', '', &
             'the first of the two links of each slide; a drive along it moves the link that is not its base'), &
      rule_t('SLNK2', a_text, 'NSLIDE', '', '', '', &
             'the second link of each slide'), &
      rule_t('SLX', a_number, 'NSLIDE', 'length', '', '', &
             'x of a point of the slide''s line in the drawing'), &
      rule_t('SLY', a_number, 'NSLIDE', 'length', '', '', &
             'y of that point'), &
      rule_t('SLANG', a_number, 'NSLIDE', 'degrees', '', '', &
             'direction of the slide''s line'), &
      rule_t('GEARA', a_text, 'n', '', '', '', &
             'gear pairs: the first wheel, a link'), &
      rule_t('GEARB', a_text, 'n', '', '', '', &
             'the second wheel of each gear pair'), &
      rule_t('GCARR', a_text, 'n', '', '', '', &
             'the link that carries the centres of both wheels'), &
      rule_t('GTA', a_number, 'n', '', '', '', &
             'teeth of the first wheel'), &
      rule_t('GTB', a_number, 'n', '', '', '', &
             'teeth of the second wheel; of an internal pair one is negative'), &
      rule_t('LENP', a_text, 'n', '', '', '', &
             'exact lengths where the drawing is rough: the two joints of a link between which each lies; the '// &
             'drawing then only chooses the assembly'), &
      rule_t('LENV', a_number, 'n', 'length', '', '', &
             'the lengths of LENP'), &
      rule_t('KOVER', a_flag, '', '', '0', '', &
             '1: superfluous equations are allowed where special lengths (a parallelogram with a third link) '// &
             'fulfil them'), &
      rule_t('VARY', a_text, 'n', '', '', '', &
             'what a search may change: `''A B''` a length, `''angle B C B P''` the angle from one line of a link to '// &
             'another, `''place D''` a joint of the frame (distance and direction from the input pivot; of that from the '// &
             'origin), `''input''` the reference input, `''all''` every dimension of the loops'), &
      rule_t('VLOW', a_number, 'n', '', '', '', &
             'lower bounds of the variables, in the order of VARY; a place has two values; of `''all''` that of all lengths'), &
      rule_t('VHIGH', a_number, 'n', '', '', '', &
             'upper bounds of the variables')]

contains

   !> Read &CHAIN. Errors: names that are missing, given twice or unknown, numbers that do not fit, joints that coincide.
   subroutine read_chain_group(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      type(diagnostics_t) :: own, unused
      integer :: stage

      sketch%given = group%line > 0
      call group%follow(chain_items)
      own%file = findings%file
      allocate (sketch%drives(0), sketch%outputs(0))
      ! what follows from a mistake is not reported: a later stage speaks only if those before found nothing
      do stage = 1, 7
         if (own%failed()) then
            call read_stage(unused)
         else
            call read_stage(own)
         end if
      end do
      if (.not. own%failed()) call check_places(group, sketch, own)
      call findings%append(own)

   contains

      subroutine read_stage(reported)
         type(diagnostics_t), intent(inout) :: reported

         select case (stage)
         case (1)
            call read_joints(group, sketch, reported)
         case (2)
            call read_links(group, sketch, reported)
         case (3)
            call read_slides(group, sketch, reported)
         case (4)
            call read_gears(group, sketch, reported)
         case (5)
            call take(group, 'KOVER', sketch%over_braced, reported)
         case (6)
            call read_lengths(group, sketch, reported)
         case default
            call read_variations(group, sketch, reported)
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
      call take(group, 'JX', sketch%x, findings, last=last_x)
      call take(group, 'JY', sketch%y, findings, last=last_y)
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
         call miscounted()
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

   contains

      !> More or fewer names than links: what may have been forgotten.
      subroutine miscounted()
         character(:), allocatable :: text

         text = 'names '//to_text(size(names))//' links, but LNK lists '//to_text(n)
         if (size(names) == n + 1) then
            text = text//"; each name needs an entry of LNK with the link's joints, the frame ("//trim(names(1))// &
                   ') first: are the joints of one link missing there?'
         else if (size(names) > n) then
            text = text//"; each name needs an entry of LNK with the link's joints, the frame first"
         else
            text = text//"; the link of joints '"//shortened(trim(lists(size(names) + 1)))//"' has no name: name it, or "// &
                   'leave it out if the others hold the linkage without it'
         end if
         call out_of(group, 'LNAME', text, findings, size(names))
      end subroutine miscounted
   end subroutine read_links

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
      call take(group, 'LENV', sketch%length, findings, last=last)
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
end module psalm_chain_group
