!> A case as text: written from its items, and what was read as items again.
submodule(psalm_case) psalm_case_text
   use psalm_case_words, only: put
   use psalm_data_set_text, only: write_data_set
   use psalm_json_case, only: is_json, read_json_cases
   use psalm_namelist, only: read_case
   use psalm_sketch_text, only: variant_t, variant_of
   use psalm_source, only: line_t, split_lines
   use psalm_text, only: text_t, full_precision, quoted, to_text
   implicit none (type, external)

   integer, parameter :: line_length = 100  !! columns of a line of values
   character(*), parameter :: frame_name = 'frame' !! of the link that the fixed joints are on

contains

   module procedure text_of_case
      type(text_t) :: text
      character(name_length), allocatable :: groups(:)
      integer :: maxarc, i, k

      content = ''
      if (self%altered) then
         content = altered_text(self)
         return
      end if
      if (.not. allocated(self%parts)) then
         if (allocated(self%source)) content = self%source
         return
      end if
      maxarc = 0
      do i = 1, size(self%parts)
         maxarc = max(maxarc, size(self%parts(i)%ilink))
      end do
      groups = [character(name_length) ::]
      if (.not. self%opened) then
         if (size(self%joint_name) > 0 .or. place_of(self, 'CHAIN', 'LNK') > 0 .or. place_of(self, 'DRIVES', 'DRIVE') > 0) then
            groups = [character(name_length) :: 'CHAIN', 'DRIVES', 'METHOD']
         else
            groups = [character(name_length) :: 'LINKS', 'METHOD']
         end if
      end if
      do i = 1, size(self%items)
         if (all(groups /= self%items(i)%group)) groups = [character(name_length) :: groups, self%items(i)%group]
      end do
      call text%add(self%heading)
      do k = 1, size(groups)
         call text%add(' &'//trim(groups(k)))
         if (self%opened) then
            continue
         else if (groups(k) == 'CHAIN') then
            call add_sketch()
         else if (groups(k) == 'LINKS') then
            call text%add('  NLOOP='//to_text(size(self%parts))//', MAXARC='//to_text(maxarc)//',')
            call add_rows('ILINK')
            call add_rows('ILOOP')
            call add_rows('ARCL')
            call add_rows('GAMA')
         else if (groups(k) == 'METHOD' .and. groups(1) == 'LINKS') then
            call add_rows('IVA')
            call add_rows('IVG')
         end if
         do i = 1, size(self%items)
            if (self%items(i)%group /= groups(k)) cycle
            call text%add('  '//trim(self%items(i)%name)//'=')
            if (groups(k) == 'CHAIN' .and. .not. self%opened) call add_frame(self%items(i)%name)
            call text%add_text(self%items(i)%values)
         end do
         call text%add(' &END')
      end do
      content = text%content()

   contains

      !> The frame as the first link, if joints are said to be on it and no link is called so.
      subroutine add_frame(item)
         character(*), intent(in) :: item
         character(:), allocatable :: frame
         integer :: n

         if (.not. any(self%fixed)) return
         n = place_of(self, 'CHAIN', 'LNAME')
         if (n > 0) then
            if (index(self%items(n)%values, quoted(frame_name)) > 0) return
         end if
         if (item == 'LNAME') call put(quoted(frame_name), text)
         if (item /= 'LNK') return
         frame = ''
         do n = 1, size(self%fixed)
            if (self%fixed(n)) frame = frame//' '//trim(self%joint_name(n))
         end do
         call put(quoted(frame(2:)), text)
      end subroutine add_frame

      !> Joints.
      subroutine add_sketch()
         integer :: n

         if (size(self%joint_name) == 0) return
         call text%add('  JNT=')
         do n = 1, size(self%joint_name)
            call put(quoted(self%joint_name(n)), text)
         end do
         call text%add('  JX=')
         do n = 1, size(self%x)
            call put(full_precision(self%x(n)), text)
         end do
         call text%add('  JY=')
         do n = 1, size(self%y)
            call put(full_precision(self%y(n)), text)
         end do
      end subroutine add_sketch

      !> An array over loops and arcs.
      subroutine add_rows(name)
         character(*), intent(in) :: name
         character(:), allocatable :: line
         integer :: loop, a

         do loop = 1, size(self%parts)
            line = '  '
            if (loop == 1) line = '  '//name//'='
            associate (part => self%parts(loop))
               do a = 1, maxarc
                  if (len(line) > line_length) then
                     call text%add(line)
                     line = '  '
                  end if
                  if (a > size(part%ilink)) then
                     line = line//'0,'
                     cycle
                  end if
                  select case (name)
                  case ('ILINK')
                     line = line//to_text(part%ilink(a))//','
                  case ('ILOOP')
                     line = line//to_text(part%iloop(a))//','
                  case ('IVA')
                     line = line//to_text(part%iva(a))//','
                  case ('IVG')
                     line = line//to_text(part%ivg(a))//','
                  case ('ARCL')
                     line = line//full_precision(part%length(a))//','
                  case default
                     line = line//full_precision(part%angle(a))//','
                  end select
               end do
            end associate
            call text%add(line)
         end do
      end subroutine add_rows
   end procedure text_of_case

   !> The text of a case whose lengths and angles were changed after it was read.
   recursive function altered_text(self) result(content)
      class(case_t), intent(in) :: self
      character(:), allocatable :: content
      class(case_t), allocatable :: own        ! large: it would fill a small stack
      class(data_set_t), allocatable :: set
      class(problem_t), allocatable :: problem
      class(prepared_t), allocatable :: prepared
      type(findings_t) :: findings
      type(variant_t) :: variant
      type(text_t) :: text
      logical :: ready

      content = ''
      if (allocated(self%set%traced)) then
         call make_ready(self, set, prepared, problem, ready, findings)
         if (.not. ready .or. self%set%is_beyond_arrays()) return
         variant = variant_of(set)
         variant%by_loops = .true.
         call write_data_set(set, problem, prepared%given, text, variant)
         content = text%content()
         return
      end if
      allocate (own, source=self)
      own%altered = .false.
      if (.not. own%opened) call open(own)
      if (.not. own%opened) return
      own%items = pack(own%items, .not. (own%items%group == 'LINKS' .and. &
                                         (index(own%items%name, 'ARCL') == 1 .or. index(own%items%name, 'GAMA') == 1)))
      own%opened = .false.     ! it is not read again
      call own%set_item('LINKS', 'ARCL', reshape(self%set%links%arcl, [size(self%set%links%arcl)]))
      call own%set_item('LINKS', 'GAMA', reshape(self%set%links%gama, [size(self%set%links%gama)]))
      own%opened = .true.
      content = own%text()
   end function altered_text

   module procedure open
      type(case_text_t), allocatable :: parts(:)
      type(given_item_t), allocatable :: items(:)
      type(text_t) :: text
      character(:), allocatable :: item
      integer :: g, i, n, at

      if (self%faults%failed()) return
      call split_cases(self%text(), parts)
      if (size(parts) /= 1) return
      n = sum([(parts(1)%groups(g)%count, g=1, parts(1)%count)])
      allocate (items(n))
      n = 0
      do g = 1, parts(1)%count
         associate (group => parts(1)%groups(g))
            do i = 1, group%count
               text%length = 0
               call group%render_item(i, text)
               item = text%content()
               at = index(item, '=')
               n = n + 1
               items(n)%group = group%name
               items(n)%name = adjustl(item(:at - 1))
               items(n)%values = '  '//item(at + 1:)
            end do
         end associate
      end do
      self%heading = parts(1)%title
      if (.not. allocated(self%parts)) then
         call begin_sketch(self)
         allocate (self%parts(0))
      end if
      call move_alloc(items, self%items)
      self%opened = .true.
      self%altered = .false.
   end procedure open

   module procedure split_cases
      type(line_t), allocatable :: lines(:)
      type(case_text_t), allocatable :: more(:)
      type(findings_t) :: reported
      integer :: next, count

      call split_lines(text, lines)
      if (is_json(lines)) then
         call read_json_cases(lines, parts, reported)
         return
      end if
      allocate (parts(1))
      next = 1
      count = 0
      do while (next <= size(lines))
         if (count == size(parts)) then
            allocate (more(2*count))
            more(:count) = parts
            call move_alloc(more, parts)
         end if
         call read_case(lines, next, parts(count + 1), reported)
         if (parts(count + 1)%line == 0) exit
         count = count + 1
      end do
      parts = parts(:count)
   end procedure split_cases

   module procedure text_of_parts
      type(text_t) :: text
      integer :: g, i

      call text%add(part%title)
      do g = 1, part%count
         call text%add(' &'//trim(part%groups(g)%name))
         do i = 1, part%groups(g)%count
            if (part%groups(g)%items(i)%name == 'LAST') cycle
            call part%groups(g)%render_item(i, text)
         end do
         call text%add(' &END')
      end do
      content = text%content()
   end procedure text_of_parts
end submodule psalm_case_text
