!> What a case is made of: loops, joints, links, slides, gears, drives, outputs, and any item of the notation.
submodule(psalm_case) psalm_case_parts
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use psalm_case_words, only: has_control, is_name, is_word, printable, put, with_lines, without_blanks
   use psalm_text, only: text_t, full_precision, quoted, to_text, upper_case
   implicit none (type, external)

contains

   module procedure new_case

      case%heading = 'CASE'
      case%faults%file = memory_name
      if (present(title)) then
         if (has_control(title) .or. index(adjustl(title), '&') == 1) then
            call case%faults%error("a title is one line that does not begin with '&'")
         else
            case%heading = trim(title)
         end if
      end if
      call begin_sketch(case)
      allocate (case%parts(0), case%items(0))
   end procedure new_case

   module procedure add_loop
      type(given_loop_t), allocatable :: more(:)
      type(given_loop_t) :: new
      logical :: fits

      if (.not. may_add(self)) return
      fits = size(ilink) == size(iloop)
      if (present(length)) fits = fits .and. size(length) == size(ilink)
      if (present(angle)) fits = fits .and. size(angle) == size(ilink)
      if (.not. fits) then
         call self%faults%error('loop '//to_text(size(self%parts) + 1)//': ilink, iloop, length and angle must have as many values')
         return
      end if
      new%ilink = ilink
      new%iloop = iloop
      allocate (new%iva(size(ilink)), new%ivg(size(ilink)), source=0)
      allocate (new%length(size(ilink)), new%angle(size(ilink)), source=0.0_wp)
      if (present(length)) new%length = length
      if (present(angle)) new%angle = angle
      if (.not. all(ieee_is_finite(new%length) .and. ieee_is_finite(new%angle))) then
         call self%faults%error('loop '//to_text(size(self%parts) + 1)//': every length and angle must be a finite number')
         return
      end if
      allocate (more(size(self%parts) + 1))
      more(:size(self%parts)) = self%parts
      more(size(more)) = new
      call move_alloc(more, self%parts)
   end procedure add_loop

   module procedure add_joint
      integer :: i

      if (.not. (is_open(self) .and. may_add(self))) return
      if (.not. is_word(name) .or. index(trim(name), ' ') > 0 .or. len_trim(name) > name_length) then
         call self%faults%error("'"//printable(name)//"': the name of a joint is one word of at most "//to_text(name_length)// &
                                ' characters')
         return
      end if
      if (.not. all(ieee_is_finite([x, y]))) then
         call self%faults%error('joint '//trim(name)//': its coordinates must be finite numbers')
         return
      end if
      i = findloc(self%joint_name == name, .true., dim=1)
      if (i == 0) then
         self%joint_name = [character(name_length) :: self%joint_name, name]
         self%x = [self%x, x]
         self%y = [self%y, y]
         self%fixed = [self%fixed, .false.]
         i = size(self%joint_name)
      end if
      self%x(i) = x
      self%y(i) = y
      if (present(fixed)) self%fixed(i) = fixed
      call unread(self)
   end procedure add_joint

   module procedure begin_sketch
      self%joint_name = [character(name_length) ::]
      self%x = [real(wp) ::]
      self%y = [real(wp) ::]
      self%fixed = [logical ::]
   end procedure begin_sketch

   module procedure add_link
      character(:), allocatable :: own

      if (.not. (is_open(self) .and. may_add(self))) return
      own = without_blanks(joints)
      if (present(name)) own = trim(name)
      if (.not. (is_word(joints) .and. is_word(own))) then
         call self%faults%error("'"//printable(joints)//"': a link is given by the names of its joints, blanks between them")
         return
      end if
      call append_word(self, 'CHAIN', 'LNAME', own)
      call append_word(self, 'CHAIN', 'LNK', trim(joints))
   end procedure add_link

   module procedure add_slide
      integer :: slides

      if (.not. are_valid(self, [real(wp) :: x, y, angle], link//along)) return
      if (present(name)) then
         if (.not. are_valid(self, [real(wp) ::], name)) return
      end if
      slides = count_of(self, 'CHAIN', 'SLNK') + 1
      if (present(name)) then
         call append_word(self, 'CHAIN', 'SNAME', name)
      else
         call append_word(self, 'CHAIN', 'SNAME', 'S'//to_text(slides))
      end if
      call append_word(self, 'CHAIN', 'SLNK', link)
      call append_word(self, 'CHAIN', 'SLNK2', along)
      call append_real(self, 'CHAIN', 'SLX', x)
      call append_real(self, 'CHAIN', 'SLY', y)
      call append_real(self, 'CHAIN', 'SLANG', angle)
   end procedure add_slide

   module procedure add_gear

      if (.not. are_valid(self, teeth, first//second//carrier)) return
      call append_word(self, 'CHAIN', 'GEARA', first)
      call append_word(self, 'CHAIN', 'GEARB', second)
      call append_word(self, 'CHAIN', 'GCARR', carrier)
      call append_real(self, 'CHAIN', 'GTA', teeth(1))
      call append_real(self, 'CHAIN', 'GTB', teeth(2))
   end procedure add_gear

   module procedure add_drive

      if (.not. are_valid(self, [real(wp) ::], what)) return
      if (present(base)) then
         if (.not. are_valid(self, [real(wp) ::], base)) return
      end if
      if (present(link)) then
         if (.not. are_valid(self, [real(wp) ::], link)) return
      end if
      call append_word(self, 'DRIVES', 'DRIVE', what)
      if (present(base)) then
         call append_word(self, 'DRIVES', 'DBASE', base)
      else
         call append_word(self, 'DRIVES', 'DBASE', '')
      end if
      if (present(link)) then
         call append_word(self, 'DRIVES', 'DLINK', link)
      else
         call append_word(self, 'DRIVES', 'DLINK', '')
      end if
   end procedure add_drive

   module procedure add_output

      if (.not. are_valid(self, [real(wp) ::], what)) return
      if (present(name)) then
         if (.not. are_valid(self, [real(wp) ::], name)) return
      end if
      call append_word(self, 'OUTPUTS', 'OUTPUT', what)
      if (present(name)) then
         call append_word(self, 'OUTPUTS', 'ONAME', name)
      else
         call append_word(self, 'OUTPUTS', 'ONAME', with_lines(what))
      end if
   end procedure add_output

   !> True if numbers are finite and words can be written; else that is a fault, and nothing is added.
   logical function are_valid(self, numbers, words)
      class(case_t), intent(inout) :: self
      real(wp), intent(in) :: numbers(:)
      character(*), intent(in) :: words

      are_valid = all(ieee_is_finite(numbers)) .and. .not. has_control(words)
      if (.not. are_valid) call self%faults%error('a part of a sketch needs finite numbers and words without control characters')
   end function are_valid

   module procedure vary_part

      call append_word(self, 'CHAIN', 'VARY', what)
   end procedure vary_part

   module procedure set_output

      call self%set_item('METHOD', 'MOTION', kind)
      call self%set_item('LINKS', 'NOUTLK', arc)
      call self%set_item('LINKS', 'NOUTLP', loop)
      if (present(length)) call self%set_item('LINKS', 'OUTLK', length)
      if (present(angle)) call self%set_item('LINKS', 'OUTANG', angle)
   end procedure set_output

   module procedure set_turn

      call self%set_item('METHOD', 'IKIN', step)
   end procedure set_turn

   module procedure set_positions

      call self%set_item('METHOD', 'NDES', size(increments))
      call self%set_item('METHOD', 'DELT', increments)
      if (present(reference)) call self%set_item('METHOD', 'CRNKI', reference)
   end procedure set_positions

   module procedure set_desired

      if (present(x)) call self%set_item('METHOD', 'DESX', x)
      if (present(y)) call self%set_item('METHOD', 'DESY', y)
      if (present(value)) call self%set_item('METHOD', 'DESANG', value)
   end procedure set_desired

   module procedure vary_arcs

      if (.not. (is_open(self) .and. may_add(self))) return
      if (loop < 1 .or. loop > size(self%parts)) then
         call self%faults%error('vary: there is no loop '//to_text(loop))
         return
      end if
      associate (part => self%parts(loop))
         if (present(lengths)) call mark(lengths, part%iva)
         if (present(angles)) call mark(angles, part%ivg)
      end associate

   contains

      subroutine mark(arcs, flags)
         integer, intent(in) :: arcs(:)
         integer, intent(inout) :: flags(:)
         integer :: i

         do i = 1, size(arcs)
            if (arcs(i) < 1 .or. arcs(i) > size(flags)) then
               call self%faults%error('vary: loop '//to_text(loop)//' has no arc '//to_text(arcs(i)))
            else
               flags(arcs(i)) = 1
            end if
         end do
      end subroutine mark
   end procedure vary_arcs

   module procedure set_integers
      type(text_t) :: text
      integer :: i

      do i = 1, size(values)
         call put(to_text(values(i)), text)
      end do
      call take_item(self, group, item, text%content())
   end procedure set_integers

   module procedure set_reals
      type(text_t) :: text
      integer :: i

      if (.not. all(ieee_is_finite(values))) then
         call self%faults%error('every value must be a finite number', group=printable(group), item=printable(item))
         return
      end if
      do i = 1, size(values)
         call put(full_precision(values(i)), text)
      end do
      call take_item(self, group, item, text%content())
   end procedure set_reals

   module procedure set_integer

      call set_integers(self, group, item, [value])
   end procedure set_integer

   module procedure set_real

      call set_reals(self, group, item, [value])
   end procedure set_real

   module procedure set_word

      call set_words(self, group, item, [value])
   end procedure set_word

   module procedure set_words
      type(text_t) :: text
      integer :: i

      do i = 1, size(values)
         if (has_control(values(i))) then
            call self%faults%error('a word must not have line breaks or other control characters', group=printable(group), &
                                   item=printable(item))
            return
         end if
         call put(quoted(values(i)), text)
      end do
      call take_item(self, group, item, text%content())
   end procedure set_words

   !> One value more of an item.
   subroutine append_word(self, group, item, value)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item, value

      if (has_control(value)) then
         call self%faults%error('a word must not have line breaks or other control characters', group=group, item=item)
         return
      end if
      call append_value(self, group, item, quoted(value))
   end subroutine append_word

   subroutine append_real(self, group, item, value)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      real(wp), intent(in) :: value

      if (.not. ieee_is_finite(value)) then
         call self%faults%error('every value must be a finite number', group=group, item=item)
         return
      end if
      call append_value(self, group, item, full_precision(value))
   end subroutine append_real

   subroutine append_value(self, group, item, value)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item, value
      type(text_t) :: text
      integer :: i

      if (.not. is_open(self)) return
      i = place_of(self, group, item)
      if (i > 0) call text%add_text(self%items(i)%values)
      call put(value, text)
      call take_item(self, group, item, text%content())
   end subroutine append_value

   !> How many values an item has that was made by `append_value`.
   pure integer function count_of(self, group, item)
      class(case_t), intent(in) :: self
      character(*), intent(in) :: group, item
      integer :: i, k

      count_of = 0
      i = place_of(self, group, item)
      if (i == 0) return
      do k = 1, len(self%items(i)%values)
         if (self%items(i)%values(k:k) == new_line('a')) count_of = count_of + 1
      end do
   end function count_of

   module procedure place_of

      place_of = 0
      if (.not. allocated(self%items)) return
      do place_of = size(self%items), 1, -1
         if (self%items(place_of)%group == group .and. self%items(place_of)%name == item) return
      end do
   end procedure place_of

   module procedure take_item
      type(given_item_t), allocatable :: more(:)
      integer :: i, n

      if (.not. is_open(self)) return
      if (.not. is_name(group, .false.) .or. .not. is_name(item, .true.)) then
         call self%faults%error("'"//printable(group)//"', '"//printable(item)//"': the names of a group and an item are "// &
                                'letters and digits, at most '//to_text(name_length)//' of them, and begin with a letter')
         return
      end if
      call unread(self)
      i = place_of(self, upper_case(group), upper_case(item))
      if (i > 0) then
         self%items(i)%values = values
         call reread(self)
         return
      end if
      n = size(self%items) + 1
      allocate (more(n))
      more(:n - 1) = self%items
      more(n)%group = upper_case(group)
      more(n)%name = upper_case(item)
      more(n)%values = values
      call move_alloc(more, self%items)
      call reread(self)
   end procedure take_item

   module procedure unread

      if (self%altered) call open(self)
      if (allocated(self%set)) deallocate (self%set)
   end procedure unread

   !> An opened case has its dimensions from its text, which is read anew.
   subroutine reread(self)
      class(case_t), intent(inout) :: self

      if (self%opened) call self%settle()
   end subroutine reread

   module procedure faults_made

      faults_made = self%faults%count
   end procedure faults_made

   module procedure take_back
      integer :: i

      do i = kept + 1, self%faults%count
         call findings%add(self%faults%list(i))
      end do
      self%faults%count = min(kept, self%faults%count)
   end procedure take_back

   module procedure is_open

      if (.not. allocated(self%parts) .and. allocated(self%set)) call open(self)
      is_open = allocated(self%parts)
      if (is_open) return
      if (allocated(self%set)) then
         call self%faults%error('the text of this case has errors; nothing can be added to it')
      else
         call self%faults%error('the case is empty; begin with new_case')
      end if
   end procedure is_open

   module procedure may_add

      may_add = .not. (allocated(self%source) .or. self%opened)
      if (.not. may_add) then
         call self%faults%error('this case was read: set its items, but add no loops, joints or links')
      else
         may_add = is_open(self)
      end if
   end procedure may_add
end submodule psalm_case_parts
