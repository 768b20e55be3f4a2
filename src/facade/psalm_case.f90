!> A case of the library: read from a file or from text, or made in memory as loops, as a sketch, item by item.
!>
!> What is made in memory becomes text in the notation of the manual and goes through the same reader, so that whatever is wrong
!> comes back as the same findings. A case that was read, or found by a study, is opened in the same way when an item is set:
!> its text becomes items again.
module psalm_case
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use psalm_cases, only: read_cases, read_case_text
   use psalm_data_set, only: data_set_t
   use psalm_data_set_text, only: write_data_set
   use psalm_error, only: problem_t, make_problem
   use psalm_group, only: group_t
   use psalm_group_table, only: everything
   use psalm_json_case, only: is_json, read_json_cases
   use psalm_kinds, only: wp
   use psalm_namelist, only: case_text_t, read_case
   use psalm_preparation, only: demand_t, prepared_t, prepare_loops
   use psalm_sketch_text, only: variant_t, variant_of
   use psalm_source, only: line_t, read_lines, split_lines
   use psalm_status, only: findings_t => diagnostics_t
   use psalm_text, only: text_t, full_precision, to_text, upper_case
   implicit none (type, external)
   private
   public :: case_t, new_case, read_file, read_text, make_ready, set_of, tell, of_text

   integer, parameter :: name_length = 31 !! longest name of a group or an item
   integer, parameter :: line_room = 100  !! columns of a line of values
   character(*), parameter :: memory_name = 'case in memory' !! in findings in place of a file
   character(*), parameter :: frame_name = 'frame' !! of the link that the fixed joints are on

   !> One loop as given to `add_loop`.
   type :: given_loop_t
      integer, allocatable :: ilink(:), iloop(:), iva(:), ivg(:)
      real(wp), allocatable :: length(:), angle(:)
   end type given_loop_t

   !> An item of the notation, with its values as text.
   type :: given_item_t
      character(name_length) :: group = '', name = ''
      character(:), allocatable :: values
   end type given_item_t

   !> A linkage and what is asked of it.
   type :: case_t
      private
      ! as it is written: a case made in memory, or opened
      character(:), allocatable :: heading                 !! its title
      type(given_loop_t), allocatable :: parts(:)          !! its loops; not allocated: the case is not written by items
      character(name_length), allocatable :: joint_name(:) !! its joints, each
      real(wp), allocatable :: x(:), y(:)                  !! where it is drawn
      logical, allocatable :: fixed(:)                     !! and whether it is on the frame
      type(given_item_t), allocatable :: items(:)          !! its other items
      logical :: opened = .false.                          !! its items are those of a text
      ! as it was read
      character(:), allocatable :: source                  !! its text
      class(data_set_t), allocatable :: set                !! what the text says
      logical :: altered = .false.                         !! a dimension of `set` was changed since
      type(findings_t) :: faults                           !! of the verbs that made it; told by every study
   contains
      procedure :: add_loop
      procedure :: add_joint
      procedure :: add_link
      procedure :: add_slide
      procedure :: add_gear
      procedure :: add_drive
      procedure :: add_output
      procedure :: set_output
      procedure :: set_turn
      procedure :: set_positions
      procedure :: set_desired
      procedure, private :: vary_arcs, vary_part
      generic :: vary => vary_arcs, vary_part
      procedure, private :: set_integers, set_reals, set_integer, set_real, set_word, set_words
      generic :: set_item => set_integers, set_reals, set_integer, set_real, set_word, set_words
      procedure :: set_length
      procedure :: set_angle
      procedure :: length => length_of_arc
      procedure :: angle => angle_of_arc
      procedure :: loops
      procedure :: arcs
      procedure :: title
      procedure :: text => text_of_case
      procedure :: settle
      procedure :: faults_made
      procedure :: take_back
   end type case_t

contains

   ! ---- cases -------------------------------------------------------------------------------------------------------

   !> Read all cases of a file. With an error in `findings` no case of it can be studied.
   subroutine read_file(file, cases, findings)
      character(*), intent(in) :: file                       !! its name; `-`: standard input
      type(case_t), allocatable, intent(out) :: cases(:)
      type(findings_t), intent(inout) :: findings
      type(line_t), allocatable :: lines(:)
      type(findings_t) :: own
      character(:), allocatable :: name

      name = file
      if (file == '-') name = 'standard input'
      own%file = name
      call read_lines(file, lines, own)
      if (own%failed()) then
         allocate (cases(0))
         call tell(own, findings)
      else
         call read_text(joined(lines), cases, findings, name)
      end if
   end subroutine read_file

   !> Read all cases of a text in the notation of the manual. With an error in `findings` no case of it can be studied.
   subroutine read_text(text, cases, findings, name)
      character(*), intent(in) :: text                       !! lines, each ended by a line feed
      type(case_t), allocatable, intent(out) :: cases(:)
      type(findings_t), intent(inout) :: findings
      character(*), intent(in), optional :: name             !! in findings in place of a file
      type(data_set_t), allocatable :: sets(:)
      type(case_text_t), allocatable :: parts(:)
      type(findings_t) :: own
      character(:), allocatable :: file
      integer :: k

      file = memory_name
      if (present(name)) file = name
      call read_case_text(text, file, sets, own, everything)
      allocate (cases(size(sets)))
      if (size(sets) == 1 .and. .not. own%failed()) then
         cases(1)%source = text
      else if (.not. own%failed()) then
         call split_cases(text, parts)
         do k = 1, min(size(sets), size(parts))
            cases(k)%source = text_of_parts(parts(k))
         end do
      end if
      do k = 1, size(sets)
         allocate (cases(k)%set, source=sets(k))
         cases(k)%set%limits%last = 1
         cases(k)%faults%file = sets(k)%file
         if (own%failed()) call cases(k)%faults%error('the text of this case has errors', line=sets(k)%title_line)
      end do
      call tell(own, findings)
   end subroutine read_text

   !> The cases of a text without errors, as titles and groups.
   subroutine split_cases(text, parts)
      character(*), intent(in) :: text
      type(case_text_t), allocatable, intent(out) :: parts(:)
      type(line_t), allocatable :: lines(:)
      type(case_text_t), allocatable :: more(:)
      type(findings_t) :: told
      integer :: next, count

      call split_lines(text, lines)
      if (is_json(lines)) then
         call read_json_cases(lines, parts, told)
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
         call read_case(lines, next, parts(count + 1), told)
         if (parts(count + 1)%line == 0) exit
         count = count + 1
      end do
      parts = parts(:count)
   end subroutine split_cases

   !> One case as a text of its own: whether another follows is not told.
   function text_of_parts(part) result(content)
      type(case_text_t), intent(in) :: part
      character(:), allocatable :: content
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
   end function text_of_parts

   !> Lines as one text.
   pure function joined(lines) result(whole)
      type(line_t), intent(in) :: lines(:)
      character(:), allocatable :: whole
      type(text_t) :: text
      integer :: k

      do k = 1, size(lines)
         call text%add(lines(k)%text)
      end do
      whole = text%content()
   end function joined

   !> A case to be made in memory: add joints and links, or loops, then say what the output is and at which inputs it is wanted.
   function new_case(title) result(case)
      character(*), intent(in), optional :: title
      type(case_t) :: case

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
   end function new_case

   !> Add a loop, arc by arc from the input pivot back to it along the frame, as ILINK and ILOOP of the manual have it.
   subroutine add_loop(self, ilink, iloop, length, angle)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: ilink(:), iloop(:)           !! shape (arcs): arc numbers; loop or guide numbers
      real(wp), intent(in), optional :: length(:)         !! shape (arcs): lengths; 0 if absent
      real(wp), intent(in), optional :: angle(:)          !! shape (arcs): angles; 0 if absent
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
   end subroutine add_loop

   !> Add a joint of a sketch at its place in the drawing; a joint of that name is moved there.
   subroutine add_joint(self, name, x, y, fixed)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: name
      real(wp), intent(in) :: x, y
      logical, intent(in), optional :: fixed              !! it belongs to the frame, which needs no `add_link` then
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
   end subroutine add_joint

   !> A case made in memory has no joints at first.
   pure subroutine begin_sketch(self)
      class(case_t), intent(inout) :: self

      self%joint_name = [character(name_length) ::]
      self%x = [real(wp) ::]
      self%y = [real(wp) ::]
      self%fixed = [logical ::]
   end subroutine begin_sketch

   !> Add a link of a sketch by its joints. The frame is the link of the fixed joints; without any it is the first link.
   subroutine add_link(self, joints, name)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: joints                  !! names, blanks between them: 'B C P'
      character(*), intent(in), optional :: name          !! its joints without blanks if absent
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
   end subroutine add_link

   !> Add a slide (prismatic pair) of a sketch.
   subroutine add_slide(self, link, along, x, y, angle, name)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: link, along             !! names of the two links
      real(wp), intent(in) :: x, y                        !! a point of its line in the drawing
      real(wp), intent(in) :: angle                       !! direction of the line, degrees
      character(*), intent(in), optional :: name          !! S1, S2 ... if absent
      integer :: slides

      if (.not. are_sound(self, [real(wp) :: x, y, angle], link//along)) return
      if (present(name)) then
         if (.not. are_sound(self, [real(wp) ::], name)) return
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
   end subroutine add_slide

   !> Add a pair of gears of a sketch.
   subroutine add_gear(self, first, second, carrier, teeth)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: first, second           !! the wheels, links
      character(*), intent(in) :: carrier                 !! the link that both centres are on
      real(wp), intent(in) :: teeth(2)                    !! of an internal pair one is negative

      if (.not. are_sound(self, teeth, first//second//carrier)) return
      call append_word(self, 'CHAIN', 'GEARA', first)
      call append_word(self, 'CHAIN', 'GEARB', second)
      call append_word(self, 'CHAIN', 'GCARR', carrier)
      call append_real(self, 'CHAIN', 'GTA', teeth(1))
      call append_real(self, 'CHAIN', 'GTB', teeth(2))
   end subroutine add_gear

   !> Add a drive of a sketch: a joint, a slide, or the two joints of a cylinder.
   subroutine add_drive(self, what, base, link)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: what
      character(*), intent(in), optional :: base          !! the link against which it moves; the other link there if absent
      character(*), intent(in), optional :: link          !! the link that it moves; the other link there if absent

      if (.not. are_sound(self, [real(wp) ::], what)) return
      if (present(base)) then
         if (.not. are_sound(self, [real(wp) ::], base)) return
      end if
      if (present(link)) then
         if (.not. are_sound(self, [real(wp) ::], link)) return
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
   end subroutine add_drive

   !> Add an output of a sketch: 'point P', 'angle rocker' ..., as OUTPUT of the manual.
   subroutine add_output(self, what, name)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: what
      character(*), intent(in), optional :: name          !! in tables; the words, joined by _, if absent

      if (.not. are_sound(self, [real(wp) ::], what)) return
      if (present(name)) then
         if (.not. are_sound(self, [real(wp) ::], name)) return
      end if
      call append_word(self, 'OUTPUTS', 'OUTPUT', what)
      if (present(name)) then
         call append_word(self, 'OUTPUTS', 'ONAME', name)
      else
         call append_word(self, 'OUTPUTS', 'ONAME', with_lines(what))
      end if
   end subroutine add_output

   !> True if numbers are finite and words can be written; else that is a fault, and nothing is added.
   logical function are_sound(self, numbers, words)
      class(case_t), intent(inout) :: self
      real(wp), intent(in) :: numbers(:)
      character(*), intent(in) :: words

      are_sound = all(ieee_is_finite(numbers)) .and. .not. has_control(words)
      if (.not. are_sound) call self%faults%error('a part of a sketch needs finite numbers and words without control characters')
   end function are_sound

   !> Let a dimension of a sketch vary in a search: 'A B' a length, 'angle B C B P', 'place D' ..., as VARY of the manual.
   subroutine vary_part(self, what)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: what

      call append_word(self, 'CHAIN', 'VARY', what)
   end subroutine vary_part

   !> Say what the output is, and on which arc it hangs.
   subroutine set_output(self, kind, arc, loop, length, angle)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: kind                         !! one of `output_...`
      integer, intent(in) :: arc, loop                    !! negative arc: measured from its start
      real(wp), intent(in), optional :: length, angle     !! of the output arc, in the axes of the arc; 0 if absent

      call self%set_item('METHOD', 'MOTION', kind)
      call self%set_item('LINKS', 'NOUTLK', arc)
      call self%set_item('LINKS', 'NOUTLP', loop)
      if (present(length)) call self%set_item('LINKS', 'OUTLK', length)
      if (present(angle)) call self%set_item('LINKS', 'OUTANG', angle)
   end subroutine set_output

   !> Ask for a full turn of the crank in steps of whole degrees.
   subroutine set_turn(self, step)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: step                         !! degrees; negative: clockwise

      call self%set_item('METHOD', 'IKIN', step)
   end subroutine set_turn

   !> Ask for input positions.
   subroutine set_positions(self, increments, reference)
      class(case_t), intent(inout) :: self
      real(wp), intent(in) :: increments(:)               !! from the reference position: degrees, or length of a sliding input
      real(wp), intent(in), optional :: reference         !! reference input; 0 if absent

      call self%set_item('METHOD', 'NDES', size(increments))
      call self%set_item('METHOD', 'DELT', increments)
      if (present(reference)) call self%set_item('METHOD', 'CRNKI', reference)
   end subroutine set_positions

   !> Say what is desired at the input positions: x and y of a point, or the angle, distance or length; of a pose all three.
   subroutine set_desired(self, x, y, value)
      class(case_t), intent(inout) :: self
      real(wp), intent(in), optional :: x(:), y(:)        !! shape (positions)
      real(wp), intent(in), optional :: value(:)          !! shape (positions): angle, distance or length

      if (present(x)) call self%set_item('METHOD', 'DESX', x)
      if (present(y)) call self%set_item('METHOD', 'DESY', y)
      if (present(value)) call self%set_item('METHOD', 'DESANG', value)
   end subroutine set_desired

   !> Let lengths or angles of a loop vary in a search.
   subroutine vary_arcs(self, loop, lengths, angles)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: loop
      integer, intent(in), optional :: lengths(:), angles(:) !! numbers of arcs

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
   end subroutine vary_arcs

   !> Give any item of the notation its values: `call case%set_item('LIMITS', 'TANGLE', 60.0_wp)`.
   subroutine set_integers(self, group, item, values)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      integer, intent(in) :: values(:)
      type(text_t) :: text
      integer :: i

      do i = 1, size(values)
         call put(to_text(values(i)), text)
      end do
      call take_item(self, group, item, text%content())
   end subroutine set_integers

   !> Reals, in the manner of `set_integers`.
   subroutine set_reals(self, group, item, values)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      real(wp), intent(in) :: values(:)
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
   end subroutine set_reals

   subroutine set_integer(self, group, item, value)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      integer, intent(in) :: value

      call set_integers(self, group, item, [value])
   end subroutine set_integer

   subroutine set_real(self, group, item, value)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      real(wp), intent(in) :: value

      call set_reals(self, group, item, [value])
   end subroutine set_real

   subroutine set_word(self, group, item, value)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      character(*), intent(in) :: value

      call set_words(self, group, item, [value])
   end subroutine set_word

   !> Texts, in the manner of `set_integers`; blanks at their ends are left out.
   subroutine set_words(self, group, item, values)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item
      character(*), intent(in) :: values(:)
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
   end subroutine set_words

   !> A text in quotes, in which an apostrophe is written twice.
   pure function quoted(value) result(text)
      character(*), intent(in) :: value
      character(:), allocatable :: text
      integer :: i

      text = "'"
      do i = 1, len_trim(value)
         text = text//value(i:i)
         if (value(i:i) == "'") text = text//"'"
      end do
      text = text//"'"
   end function quoted

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

   !> The item of that name; 0 if it was not given.
   pure integer function place_of(self, group, item)
      class(case_t), intent(in) :: self
      character(*), intent(in) :: group, item

      place_of = 0
      if (.not. allocated(self%items)) return
      do place_of = size(self%items), 1, -1
         if (self%items(place_of)%group == group .and. self%items(place_of)%name == item) return
      end do
   end function place_of

   !> True for a text that can be seen and is not blank.
   pure logical function is_word(text)
      character(*), intent(in) :: text

      is_word = len_trim(text) > 0 .and. .not. has_control(text)
   end function is_word

   pure function without_blanks(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: i

      word = ''
      do i = 1, len(text)
         if (text(i:i) /= ' ') word = word//text(i:i)
      end do
   end function without_blanks

   !> Words joined by _.
   pure function with_lines(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: i

      word = trim(text)
      do i = 1, len(word)
         if (word(i:i) == ' ') word(i:i) = '_'
      end do
   end function with_lines

   !> True if a text has characters that end a line or cannot be seen.
   pure logical function has_control(text)
      character(*), intent(in) :: text
      integer :: i

      has_control = .false.
      do i = 1, len(text)
         has_control = has_control .or. iachar(text(i:i)) < iachar(' ') .or. iachar(text(i:i)) == 127
      end do
   end function has_control

   !> A name for a finding: in capitals, as long as a name may be, what cannot be seen as a question mark.
   pure function printable(name) result(text)
      character(*), intent(in) :: name
      character(:), allocatable :: text
      integer :: i

      text = upper_case(name(:min(len(name), name_length)))
      do i = 1, len(text)
         if (has_control(text(i:i))) text(i:i) = '?'
      end do
   end function printable

   !> True for a letter followed by letters, digits and underscores; of an item an index may follow: DESX(3).
   pure logical function is_name(text, indexed)
      character(*), intent(in) :: text
      logical, intent(in) :: indexed
      character(*), parameter :: letters = 'ABCDEFGHIJKLMNOPQRSTUVWXYZ', further = letters//'0123456789_', inner = '0123456789,: '
      character(:), allocatable :: name
      integer :: last

      is_name = len(text) > 0 .and. len(text) <= name_length
      if (.not. is_name) return
      name = upper_case(text)
      last = verify(name, further) - 1
      if (last < 0) last = len(name)
      is_name = last > 0 .and. scan(name(1:1), letters) == 1
      if (.not. is_name .or. last == len(name)) return
      is_name = indexed .and. name(last + 1:last + 1) == '(' .and. name(len(name):) == ')'
      if (is_name) is_name = len(name) > last + 2 .and. verify(name(last + 2:len(name) - 1), inner) == 0
   end function is_name

   !> A value on the last line of a text, or on a new one.
   subroutine put(value, text)
      character(*), intent(in) :: value
      type(text_t), intent(inout) :: text

      call text%add('  '//value//',')
   end subroutine put

   subroutine take_item(self, group, item, values)
      class(case_t), intent(inout) :: self
      character(*), intent(in) :: group, item, values
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
   end subroutine take_item

   !> What was read of the case no longer holds.
   subroutine unread(self)
      class(case_t), intent(inout) :: self

      if (self%altered) call open(self)
      if (allocated(self%set)) deallocate (self%set)
   end subroutine unread

   !> An opened case has its dimensions from its text, which is read anew.
   subroutine reread(self)
      class(case_t), intent(inout) :: self

      if (self%opened) call self%settle()
   end subroutine reread

   !> Read a case made in memory once, so that the studies that follow need not do so each for itself. Mistakes are told by them.
   subroutine settle(self)
      class(case_t), intent(inout) :: self
      type(data_set_t), allocatable :: sets(:)
      type(findings_t) :: own

      if (allocated(self%set) .or. .not. allocated(self%parts)) return
      call read_case_text(self%text(), memory_name, sets, own, everything)
      if (own%count > 0 .or. size(sets) /= 1) return
      allocate (self%set, source=sets(1))
   end subroutine settle

   !> How many faults of its own the case has: made by the verbs that fill and change it. Every study reports them.
   pure integer function faults_made(self)
      class(case_t), intent(in) :: self

      faults_made = self%faults%count
   end function faults_made

   !> Take back faults beyond the first `kept`, for a host that reports them at once; nothing came of the calls that made them.
   subroutine take_back(self, kept, findings)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: kept
      type(findings_t), intent(inout) :: findings
      integer :: i

      do i = kept + 1, self%faults%count
         call findings%add(self%faults%list(i))
      end do
      self%faults%count = min(kept, self%faults%count)
   end subroutine take_back

   !> True if the case is written by items; one that was read is opened, an empty one is a fault.
   logical function is_open(self)
      class(case_t), intent(inout) :: self

      if (.not. allocated(self%parts) .and. allocated(self%set)) call open(self)
      is_open = allocated(self%parts)
      if (is_open) return
      if (allocated(self%set)) then
         call self%faults%error('the text of this case has errors; nothing can be added to it')
      else
         call self%faults%error('the case is empty; begin with new_case')
      end if
   end function is_open

   !> True if loops, joints and links may be added: not to a case that was read.
   logical function may_add(self)
      class(case_t), intent(inout) :: self

      may_add = .not. (allocated(self%source) .or. self%opened)
      if (.not. may_add) then
         call self%faults%error('this case was read: set its items, but add no loops, joints or links')
      else
         may_add = is_open(self)
      end if
   end function may_add

   !> The text of a case that was read becomes items.
   subroutine open(self)
      class(case_t), intent(inout) :: self
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
   end subroutine open

   ! ---- looking at a case and changing its dimensions ---------------------------------------------------------------

   !> Number of loops.
   pure integer function loops(self)
      class(case_t), intent(in) :: self

      loops = 0
      if (allocated(self%parts)) loops = size(self%parts)
      if (allocated(self%set)) loops = self%set%loops()
   end function loops

   !> Number of arcs of a loop, padding of ILINK included; 0 if there is no such loop.
   pure integer function arcs(self, loop)
      class(case_t), intent(in) :: self
      integer, intent(in) :: loop

      arcs = 0
      if (loop < 1 .or. loop > self%loops()) return
      if (allocated(self%set)) then
         arcs = self%set%links%maxarc
         if (allocated(self%set%traced)) arcs = self%set%traced%longest
      else
         arcs = size(self%parts(loop)%ilink)
      end if
   end function arcs

   !> Title.
   pure function title(self)
      class(case_t), intent(in) :: self
      character(:), allocatable :: title

      title = ''
      if (allocated(self%heading)) title = self%heading
      if (allocated(self%set)) title = self%set%title
   end function title

   !> Length of an arc; 0 if there is no such arc.
   pure real(wp) function length_of_arc(self, loop, arc) result(length)
      class(case_t), intent(in) :: self
      integer, intent(in) :: loop, arc
      integer :: n

      length = 0.0_wp
      if (arc < 1 .or. arc > self%arcs(loop)) return
      if (allocated(self%set)) then
         if (allocated(self%set%traced)) then
            n = self%set%traced%number_of(loop, arc)
            if (n > 0) length = self%set%traced%arcs(n)%arcl
         else
            length = self%set%links%arcl(arc, loop)
         end if
      else
         length = self%parts(loop)%length(arc)
      end if
   end function length_of_arc

   !> Angle of an arc, degrees; 0 if there is no such arc.
   pure real(wp) function angle_of_arc(self, loop, arc) result(angle)
      class(case_t), intent(in) :: self
      integer, intent(in) :: loop, arc
      integer :: n

      angle = 0.0_wp
      if (arc < 1 .or. arc > self%arcs(loop)) return
      if (allocated(self%set)) then
         if (allocated(self%set%traced)) then
            n = self%set%traced%number_of(loop, arc)
            if (n > 0) angle = self%set%traced%arcs(n)%gama
         else
            angle = self%set%links%gama(arc, loop)
         end if
      else
         angle = self%parts(loop)%angle(arc)
      end if
   end function angle_of_arc

   !> Change the length of an arc.
   subroutine set_length(self, loop, arc, value)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: loop, arc
      real(wp), intent(in) :: value

      if (.not. may_change(self, loop, arc, value)) return
      if (value < 0.0_wp) then
         call self%faults%error('arc '//to_text(arc)//' of loop '//to_text(loop)//': a length is not negative')
         return
      end if
      if (is_of_loops(self)) self%parts(loop)%length(arc) = value
      if (.not. allocated(self%set)) return
      self%altered = .not. is_of_loops(self)
      if (allocated(self%set%traced)) then
         self%set%traced%arcs(self%set%traced%number_of(loop, arc))%arcl = value
      else
         self%set%links%arcl(arc, loop) = value
      end if
   end subroutine set_length

   !> Change the angle of an arc, degrees.
   subroutine set_angle(self, loop, arc, value)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: loop, arc
      real(wp), intent(in) :: value

      if (.not. may_change(self, loop, arc, value)) return
      if (is_of_loops(self)) self%parts(loop)%angle(arc) = value
      if (.not. allocated(self%set)) return
      self%altered = .not. is_of_loops(self)
      if (allocated(self%set%traced)) then
         self%set%traced%arcs(self%set%traced%number_of(loop, arc))%gama = value
      else
         self%set%links%gama(arc, loop) = value
      end if
   end subroutine set_angle

   !> True if the case was made of `add_loop`.
   pure logical function is_of_loops(self)
      class(case_t), intent(in) :: self

      is_of_loops = .false.
      if (allocated(self%parts)) is_of_loops = size(self%parts) > 0
   end function is_of_loops

   logical function may_change(self, loop, arc, value)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: loop, arc
      real(wp), intent(in) :: value

      may_change = arc >= 1 .and. arc <= self%arcs(loop)
      if (may_change .and. allocated(self%set)) then
         if (allocated(self%set%traced)) may_change = self%set%traced%number_of(loop, arc) > 0
      end if
      if (.not. may_change) then
         call self%faults%error('there is no arc '//to_text(arc)//' of loop '//to_text(loop))
      else if (.not. ieee_is_finite(value)) then
         call self%faults%error('arc '//to_text(arc)//' of loop '//to_text(loop)//': a dimension must be a finite number')
         may_change = .false.
      end if
   end function may_change

   !> The case in the notation of the manual, complete: read again, it is the same case. Findings of a case made in memory name
   !> lines of this text. Empty if the text of the case has errors, or if it is a sketch whose dimensions were changed and whose
   !> loops &LINKS cannot tell.
   recursive function text_of_case(self) result(content)
      class(case_t), intent(in) :: self
      character(:), allocatable :: content
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
                  if (len(line) > line_room) then
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
   end function text_of_case

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

   ! ---- what the studies share --------------------------------------------------------------------------------------

   !> Data set and problem of a case; whatever is wrong is told.
   recursive subroutine make_ready(case, set, prepared, problem, ready, findings, every_loop, demand, reader, does, turning)
      type(case_t), intent(in) :: case
      class(data_set_t), allocatable, intent(out) :: set
      class(prepared_t), allocatable, intent(out) :: prepared
      class(problem_t), allocatable, intent(out) :: problem
      logical, intent(out) :: ready
      type(findings_t), intent(inout) :: findings
      logical, intent(in), optional :: every_loop         !! solve loops that the output does not depend on too
      type(demand_t), intent(in), optional :: demand      !! for memory
      character(*), intent(in), optional :: reader        !! the program whose study it is; default psalm
      character(*), intent(in), optional :: does          !! what it does, for messages: 'bridge studies'
      logical, intent(in), optional :: turning            !! it needs a crank that turns
      type(findings_t) :: own
      type(demand_t) :: memory
      character(:), allocatable :: work
      logical :: everywhere

      allocate (prepared)
      ready = .false.
      everywhere = .false.
      if (present(every_loop)) everywhere = every_loop
      call set_of(case, set, own, reader)
      if (.not. own%failed()) then
         if (set%loops() > 0) then
            work = 'the library studies'
            if (present(does)) work = does
            if (present(demand)) memory = demand
            if (everywhere) memory%ktheta_only = .false.
            call prepare_loops(work, memory, set, prepared, own, turning)
            ready = prepared%ready
         else
            call own%error('the case has no linkage', line=set%title_line)
         end if
      end if
      call tell(own, findings)
      if (.not. ready) return
      allocate (problem)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem, &
                        all_arcs=everywhere .or. set%limits%ktheta /= 0)
   end subroutine make_ready

   !> What the case says; whatever is wrong is told. Without an error `set` is allocated.
   recursive subroutine set_of(case, set, own, reader)
      type(case_t), intent(in) :: case
      class(data_set_t), allocatable, intent(out) :: set
      type(findings_t), intent(inout) :: own
      character(*), intent(in), optional :: reader        !! the program whose study it is; default psalm
      type(data_set_t), allocatable :: sets(:)
      character(:), allocatable :: text, program
      logical :: anew

      own%file = memory_name
      if (allocated(case%set)) own%file = case%set%file
      program = everything
      if (present(reader)) program = reader
      anew = .not. allocated(case%set)
      ! of a sketch with variables the loops are others for a search; muscle writes groups anew that others keep
      if (.not. (anew .or. case%altered .or. program == everything .or. program == 'psalm')) then
         anew = program == 'muscle' .or. (case%set%sketch%given .and. case%set%wants_search())
      end if
      if (.not. anew) then
         allocate (set, source=case%set)
      else if (allocated(case%parts) .or. allocated(case%source)) then
         text = case%text()
         call read_case_text(text, own%file, sets, own, program)
         if (size(sets) > 0) allocate (set, source=sets(1))
      else
         call own%error('the case is empty; begin with new_case, read_file or read_text')
      end if
      call tell(case%faults, own)
   end subroutine set_of

   !> Add what was found elsewhere, with the name of its file.
   subroutine tell(own, findings)
      type(findings_t), intent(in) :: own
      type(findings_t), intent(inout) :: findings

      if (allocated(own%file)) findings%file = own%file
      call findings%append(own)
   end subroutine tell

   !> The cases of a text that a study wrote.
   subroutine of_text(text, cases)
      character(*), intent(in) :: text
      type(case_t), allocatable, intent(out) :: cases(:)
      type(findings_t) :: told

      call read_text(text, cases, told)
   end subroutine of_text

end module psalm_case
