!> The group &DRIVES of a sketch: what moves it.
module psalm_drives_group
   use psalm_group, only: group_t, out_of, required
   use psalm_kinds, only: wp
   use psalm_rule, only: rule_t, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t, link_t, drive_t, sketch_name, frame_link, drive_turns, drive_slides, &
                           drive_stretches
   use psalm_sketch_names, only: word_length, find_joints, meant, slide_names, words_of, link_named, common_link
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_text, only: lower_case, shortened, to_text
   implicit none (type, external)
   private
   public :: drive_items
   public :: read_drives_group

   !> The items of the group.
   type(rule_t), parameter :: drive_items(*) = [ &
      rule_t('DRIVE', a_text, 'n', '', 'required', '', &
             'what is driven: a joint, a slide, or the two joints `''B C''` of a cylinder, which thereby '// &
             'becomes a link of driven length'), &
      rule_t('DBASE', a_text, 'n', '', 'the other link there', '', &
             'the link against which each moves; it need not be the frame'), &
      rule_t('DLINK', a_text, 'n', '', 'the other link there', '', &
             'the link that it moves'), &
      rule_t('NDRIVE', a_whole, '', '', 'as many as DRIVE has', '', &
             'number of drives'), &
      rule_t('DELT#', a_number, 'NDES', '', '', '', &
             'values of the second, third ... drive at every position, from the drawing; those of the first are '// &
             'CRNKI and DELT or IKIN of &METHOD'), &
      rule_t('DSPEED', a_number, 'n', '', '0', '', &
             'for `kalm`: speeds of the drives, rad/s or lengths a second; 0 for the first, which has that of '// &
             '&RATES, and for those with a RATIO; a drive whose positions change at speed 0 gets a message'), &
      rule_t('DACCEL', a_number, 'n', '', '0', '', &
             'for `kalm`: accelerations of the drives, in the same manner'), &
      rule_t('RATIO', a_number, 'n', '', '0', '', &
             'in place of them: value = RATIO times that of the first + PHASE (gears on fixed centres); 0 for '// &
             'the first'), &
      rule_t('PHASE', a_number, 'n', '', '0', '', &
             'what is added to RATIO times the first'), &
      rule_t('NGRID', a_whole, 'n', '', 'no grid', '', &
             'a grid of strokes in place of all positions: so many values of each drive, in all combinations, '// &
             'one drive after the other going back and forth; NDES, DELT and IKIN are left out'), &
      rule_t('DLOW', a_number, 'n', 'length or degrees', '', '', &
             'lower end of each stroke of the grid'), &
      rule_t('DHIGH', a_number, 'n', 'length or degrees', '', '', &
             'upper end of each stroke of the grid')]

contains

   !> Read &DRIVES. A drive is a joint, a slide, or two joints with a cylinder between them, which becomes a link.
   subroutine read_drives_group(group, positions, sketch, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: positions        !! NDES
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:), bases(:), links(:)
      character(word_length), allocatable :: words(:)
      real(wp), allocatable :: ratio(:), phase(:), delt(:)
      character(:), allocatable :: item
      integer :: n, announced, i, j, last_ratio, last
      logical :: valid, grid

      call group%follow(drive_items)
      call group%get_texts('DRIVE', names, findings)
      call group%get_texts('DBASE', bases, findings)
      call group%get_texts('DLINK', links, findings)
      n = size(names)
      announced = n
      call take(group, 'NDRIVE', announced, findings)
      allocate (ratio(max(1, n)), phase(max(1, n)), source=0.0_wp)
      call take(group, 'RATIO', ratio, findings, last=last_ratio)
      call take(group, 'PHASE', phase, findings)
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
                  call unknown_drive(trim(words(1)))
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
            else if (.not. drive%geared .and. abs(drive%phase) > 0.0_wp) then
               call out_of(group, 'PHASE', 'drive '//trim(drive%name)//' has no RATIO; PHASE is added to RATIO times the first '// &
                           'drive', findings, i)
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
         call take(group, 'NGRID', counts, findings, last=last_count)
         call take(group, 'DLOW', low, findings, last=last_low)
         call take(group, 'DHIGH', high, findings, last=last_high)
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
         character(word_length), intent(in) :: words(:)
         character(word_length), allocatable :: parts(:)

         parts = words
         if (size(words) /= 1) return
         if (len_trim(words(1)) /= 2) return
         if (max(sketch%joint_called(trim(words(1))), sketch%slide_called(trim(words(1)))) > 0) return
         if (sketch%joint_called(words(1)(1:1)) == 0 .or. sketch%joint_called(words(1)(2:2)) == 0) return
         parts = [character(word_length) :: words(1)(1:1), words(1)(2:2)]
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
            if (size(at) == 0) return   ! reported for JNT
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
            ! a link that is not there would make the other one, which is found from it, no link at all
            if (drive%base > 0 .and. all(at /= drive%base)) then
               call not_there('DBASE', drive%base, at)
               return
            else if (drive%link > 0 .and. all(at /= drive%link)) then
               call not_there('DLINK', drive%link, at)
               return
            end if
            if (any(at == 0)) return             ! a slide on a link that is not there, which is an error of the sketch
            if (size(at) == 2) then
               if (drive%base == 0 .and. drive%link == 0) drive%base = minval(at)
               if (drive%base == 0) drive%base = sum(at) - drive%link
               if (drive%link == 0) drive%link = sum(at) - drive%base
            else if (drive%base == 0 .or. drive%link == 0) then
               call out_of(group, 'DRIVE', 'joint '//trim(drive%name)//' pins '//to_text(size(at))// &
                           ' links; say with DBASE and DLINK which of them the drive acts between', findings, i)
               return
            end if
            if (drive%base == drive%link) then
               call out_of(group, 'DLINK', 'drive '//trim(drive%name)//' has link '//trim(sketch%links(drive%link)%name)// &
                           ' on both sides; it moves DLINK against DBASE', findings, i)
            else
               valid = .true.
               if (drive%link == frame_link) call tell_moved_frame(drive)
               call doubt_crank(drive)
            end if
         end associate
      end subroutine find_links

      !> A drive that moves the frame is right if it is meant so, and otherwise a slip: the other link goes the other way.
      subroutine tell_moved_frame(drive)
         type(drive_t), intent(in) :: drive
         character(:), allocatable :: item

         item = 'DLINK'
         if (i <= size(bases)) then
            if (len_trim(bases(i)) > 0) item = 'DBASE'
         end if
         call group%origins%warning(findings, 'DRIVES', item, 'drive '//trim(drive%name)//' moves the frame against link '// &
                                    trim(sketch%links(drive%base)%name)//', which goes the other way; DBASE is what a drive '// &
                                    'is mounted on, as a rule the frame, and DLINK what it moves', i)
      end subroutine tell_moved_frame

      subroutine not_there(item, link, at)
         character(*), intent(in) :: item
         integer, intent(in) :: link
         integer, intent(in) :: at(:)         !! links that are there
         character(:), allocatable :: names
         integer :: k

         names = trim(sketch%links(at(1))%name)
         do k = 2, size(at)
            names = names//trim(merge(' and', ',   ', k == size(at)))//' '//trim(sketch%links(at(k))%name)
         end do
         call out_of(group, item, 'link '//trim(sketch%links(link)%name)//' is not at '// &
                     trim(merge('slide', 'joint', sketch%drives(i)%kind == drive_slides))//' '//trim(sketch%drives(i)%name)// &
                     '; the links there are '//names, findings, i)
      end subroutine not_there

      !> No joint or slide has this name. Where it is that of a link, the joint or slide of that link is meant.
      subroutine unknown_drive(name)
         character(*), intent(in) :: name
         integer :: link, k

         link = sketch%link_called(name)
         if (link == 0) then
            call out_of(group, 'DRIVE', "no joint or slide is called '"//name//"'"// &
                        meant(name, [character(sketch_name) :: sketch%joint_name, slide_names(sketch)]), findings, i)
            return
         end if
         do k = 1, size(sketch%links(link)%joints)
            if (.not. sketch%has_joint(frame_link, sketch%links(link)%joints(k))) cycle
            call out_of(group, 'DRIVE', "'"//name//"' is a link; a link is driven at a joint, here DRIVE='"// &
                        trim(sketch%joint_name(sketch%links(link)%joints(k)))//"'", findings, i)
            return
         end do
         do k = 1, size(sketch%slides)
            if (all(sketch%slides(k)%links /= link)) cycle
            call out_of(group, 'DRIVE', "'"//name//"' is a link; a link is driven at a slide, here DRIVE='"// &
                        trim(sketch%slides(k)%name)//"'", findings, i)
            return
         end do
         call out_of(group, 'DRIVE', "'"//name//"' is a link; name the joint or slide that moves it", findings, i)
      end subroutine unknown_drive

      !> A link that is called crank, at the pivot that is driven but not moved by the drive: LNK may begin with another link than
      !> the frame, and then every name belongs to the next link.
      subroutine doubt_crank(drive)
         type(drive_t), intent(in) :: drive
         integer :: crank

         if (i > 1 .or. drive%kind /= drive_turns) return
         do crank = 1, size(sketch%links)
            if (lower_case(trim(sketch%links(crank)%name)) /= 'crank') cycle
            if (any([drive%base, drive%link] == crank)) return
            call group%origins%warning(findings, 'DRIVES', 'DRIVE', 'drive '//trim(drive%name)//' turns link '// &
                                       trim(sketch%links(drive%link)%name)//' against '//trim(sketch%links(drive%base)%name)// &
                                       ', not the link called '//trim(sketch%links(crank)%name)//': is the frame the first '// &
                                       'link of LNK?')
            return
         end do
      end subroutine doubt_crank

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
end module psalm_drives_group
