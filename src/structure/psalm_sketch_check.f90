!> Whether a sketch is a mechanism: freedom, bracing and drives, in words that name the links and joints.
module psalm_sketch_check
   use psalm_assur_order, only: assur_order_t, find_assur_groups
   use psalm_data_set, only: data_set_t
   use psalm_freedom, only: freedom_t, find_freedom
   use psalm_sketch, only: sketch_t, frame_link, drive_stretches
   use psalm_sketch_graph, only: graph_t, make_graph, tie_gear, tie_joint, tie_slide
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: check_sketch

   integer, parameter :: most_named = 8   !! links named in a message

contains

   !> Tell what is wrong; else give the Assur groups in their order.
   subroutine check_sketch(set, order, findings)
      type(data_set_t), intent(in) :: set
      type(assur_order_t), intent(out) :: order
      type(diagnostics_t), intent(inout) :: findings
      type(freedom_t) :: freedom
      logical :: joined, failed

      call check_connected(set, findings, joined)
      if (.not. joined) return
      freedom = find_freedom(set%sketch)
      call tell_bracing(set, freedom, findings, failed)
      if (freedom%left > 0) then
         call tell_loose(set, freedom, findings)
         failed = .true.
      end if
      if (failed) return
      order = find_assur_groups(set%sketch, freedom%braced)
      if (.not. order%valid) &
         call tell(set, 'LNK', 1, 'the sketch is underconstrained in one part and overconstrained in another: '// &
                                       count_of(set%sketch, freedom), findings)
   end subroutine check_sketch

   subroutine tell(set, item, element, text, findings)
      type(data_set_t), intent(in) :: set
      character(*), intent(in) :: item, text
      integer, intent(in) :: element
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: group

      group = 'CHAIN'
      if (item == 'DRIVE') group = 'DRIVES'
      call set%origins%error(findings, group, item, text, element)
   end subroutine tell

   !> Parts that nothing joins to the frame.
   subroutine check_connected(set, findings, joined)
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(out) :: joined
      type(graph_t) :: graph
      logical, allocatable :: reached(:), before(:)
      integer :: i

      graph = make_graph(set%sketch)
      allocate (reached(graph%nodes()), source=.false.)
      reached(frame_link) = .true.
      do
         before = reached
         do i = 1, size(graph%equations)
            associate (nodes => graph%equations(i)%nodes(:2))
               if (any(reached(nodes))) reached(nodes) = .true.
            end associate
         end do
         if (all(before .eqv. reached)) exit
      end do
      joined = all(reached(:graph%links))
      if (joined) return
      i = findloc(reached(:graph%links), .false., dim=1)
      call tell(set, 'LNK', i, 'nothing joins '//names_of(set%sketch, .not. reached(:graph%links))//' to the frame; a joint '// &
                'joins links when both have it in LNK', findings)
   end subroutine check_connected

   !> What is braced twice. With KOVER=1 only a drive that moves nothing is reported.
   subroutine tell_bracing(set, freedom, findings, failed)
      type(data_set_t), intent(in) :: set
      type(freedom_t), intent(in) :: freedom
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(out) :: failed
      type(graph_t) :: graph
      integer :: i, drive

      failed = .false.
      graph = make_graph(set%sketch)
      associate (sketch => set%sketch)
         do i = 1, size(freedom%braced)
            associate (equation => graph%equations(freedom%braced(i)%equation), part => freedom%braced(i)%part)
               drive = equation%drive
               if (drive > 0) then
                  failed = .true.
                  call tell(set, 'DRIVE', drive, merge('cylinder ', 'drive at ', sketch%drives(drive)%kind == drive_stretches)// &
                            trim(sketch%drives(drive)%name)//' moves nothing: '//names_of(sketch, part)// &
                            ' are rigid with each other without it'//other_drives(drive)// &
                            '; drive another joint or leave it out'//special(), findings)
                  return
               end if
               if (sketch%over_braced) cycle
               failed = .true.
               select case (equation%kind)
               case (tie_joint)
                  call tell(set, 'LNK', equation%nodes(1), 'overconstrained: joint '// &
                            trim(sketch%joint_name(equation%nodes(2) - graph%links))//' of link '// &
                            trim(sketch%links(equation%nodes(1))%name)//' holds what is held already, for '// &
                            names_of(sketch, part)//' are rigid with each other without it ('//count_of(sketch, freedom)// &
                            '); take a joint or a link away, or set KOVER=1 if they move thanks to special lengths', findings)
               case (tie_slide)
                  call tell(set, 'SLNK', equation%which, 'overconstrained: slide '//trim(sketch%slides(equation%which)%name)// &
                            ' holds what is held already, for '//names_of(sketch, &
                               part)//' are rigid with each other without it ('// &
                            count_of(sketch, freedom)//'); take it away, or set KOVER=1 if they move thanks to special lengths', &
                            findings)
               case (tie_gear)
                  call tell(set, 'GEARA', equation%which, 'overconstrained: gear pair '//to_text(equation%which)//' of wheels '// &
                            trim(sketch%links(equation%nodes(1))%name)//' and '//trim(sketch%links(equation%nodes(2))%name)// &
                            ' holds what is held already ('//count_of(sketch, freedom)//')', findings)
               end select
               ! what follows from the first is not reported
               return
            end associate
         end do
      end associate

   contains

      !> What else helps, unless it was said already.
      function special() result(text)
         character(:), allocatable :: text

         text = ''
         if (.not. set%sketch%over_braced) text = ', or set KOVER=1 if they move thanks to special lengths'
      end function special

      function other_drives(drive) result(text)
         integer, intent(in) :: drive
         character(:), allocatable :: text
         type(sketch_t) :: alone
         type(freedom_t) :: other
         integer :: k

         text = ''
         if (size(set%sketch%drives) == 1) return
         alone = set%sketch
         alone%drives = pack(alone%drives, [(k == drive .or. set%sketch%drives(k)%kind == drive_stretches, &
                                             k=1, size(set%sketch%drives))])
         other = find_freedom(alone)
         if (size(other%braced) == 0) text = ' once the other drives are held'
      end function other_drives
   end subroutine tell_bracing

   !> What still moves when all drives are held.
   subroutine tell_loose(set, freedom, findings)
      type(data_set_t), intent(in) :: set
      type(freedom_t), intent(in) :: freedom
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: hint
      integer, allocatable :: links(:)
      integer :: j, first

      hint = ''
      associate (sketch => set%sketch)
         do j = 1, size(sketch%joint_name)
            links = sketch%links_of(j)
            if (size(links) /= 1) cycle
            if (.not. freedom%loose(links(1))) cycle
            if (any([(any(sketch%outputs%joints(first) == j), first=1, 4)])) cycle
            hint = '. Joint '//trim(sketch%joint_name(j))//' belongs to '//trim(sketch%links(links(1))%name)// &
                   ' only: if it is pinned to the frame, put it into the first link of LNK'
            exit
         end do
         first = findloc(freedom%loose, .true., dim=1)
         call tell(set, 'LNK', max(first, 1), 'underconstrained: '//names_of(sketch, freedom%loose)//' can still move with '// &
                   drives_held()//' held ('//count_of(sketch, freedom)//', '//to_text(size(sketch%drives))//' driven); '// &
                   'drive '//to_text(freedom%left)//' more or join them'//hint, findings)
      end associate

   contains

      function drives_held() result(text)
         character(:), allocatable :: text
         integer :: k

         text = 'the drive'
         if (size(set%sketch%drives) > 1) text = text//'s'
         do k = 1, size(set%sketch%drives)
            text = text//' '//trim(set%sketch%drives(k)%name)
            if (k < size(set%sketch%drives)) text = text//','
         end do
      end function drives_held
   end subroutine tell_loose

   !> Links by name.
   pure function names_of(sketch, chosen) result(text)
      type(sketch_t), intent(in) :: sketch
      logical, intent(in) :: chosen(:)       !! shape (links)
      character(:), allocatable :: text
      integer :: i, reported

      text = trim(merge('link  ', 'links ', count(chosen) == 1))
      reported = 0
      do i = 1, size(chosen)
         if (.not. chosen(i)) cycle
         reported = reported + 1
         if (reported > most_named) then
            text = text//' and '//to_text(count(chosen) - most_named)//' more'
            return
         end if
         if (reported > 1 .and. reported == count(chosen)) then
            text = text//' and '//trim(sketch%links(i)%name)
         else if (reported > 1) then
            text = text//', '//trim(sketch%links(i)%name)
         else
            text = text//' '//trim(sketch%links(i)%name)
         end if
      end do
   end function names_of

   !> The count of freedoms.
   pure function count_of(sketch, freedom) result(text)
      type(sketch_t), intent(in) :: sketch
      type(freedom_t), intent(in) :: freedom
      character(:), allocatable :: text

      text = 'by count F = 3(L-1) - 2p'
      if (size(sketch%gears) > 0) text = text//' - '//to_text(size(sketch%gears))//' gear pairs'
      if (count(sketch%drives%kind == drive_stretches) > 0) text = text//' + '// &
         to_text(count(sketch%drives%kind == drive_stretches))//' cylinders'
      text = text//' = '//to_text(freedom%count)//' with L = '//to_text(freedom%links)//' links and p = '// &
             to_text(freedom%pairs)//' pairs'
   end function count_of
end module psalm_sketch_check
