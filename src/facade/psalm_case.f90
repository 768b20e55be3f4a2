!> A case of the library: read from a file or from text, or made in memory as loops, as a sketch, item by item.
!>
!> What is made in memory becomes text in the notation of the manual and goes through the same reader, so that whatever is wrong
!> comes back as the same findings. A case that was read, or found by a study, is opened in the same way when an item is set:
!> its text becomes items again. The procedures stand in submodules: what a case is made of (`psalm_case_parts`), its text
!> (`psalm_case_text`), how it is read (`psalm_case_reading`), its dimensions (`psalm_case_dimensions`).
module psalm_case
   use psalm_case_words, only: name_length
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp
   use psalm_namelist, only: case_text_t
   use psalm_preparation, only: memory_need_t, prepared_t
   use psalm_status, only: findings_t => diagnostics_t
   implicit none (type, external)
   private
   public :: case_t, new_case, read_file, read_text, make_ready, set_of, tell, of_text

   character(*), parameter :: memory_name = 'case in memory' !! in findings in place of a file

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
      type(findings_t) :: faults                           !! of the verbs that made it; reported by every study
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

   interface
      !> Read all cases of a file. With an error in `findings` no case of it can be studied.
      module subroutine read_file(file, cases, findings)
         implicit none (type, external)
         character(*), intent(in) :: file                       !! its name; `-`: standard input
         type(case_t), allocatable, intent(out) :: cases(:)
         type(findings_t), intent(inout) :: findings
      end subroutine read_file

      !> Read all cases of a text in the notation of the manual. With an error in `findings` no case of it can be studied.
      module subroutine read_text(text, cases, findings, name)
         implicit none (type, external)
         character(*), intent(in) :: text                       !! lines, each ended by a line feed
         type(case_t), allocatable, intent(out) :: cases(:)
         type(findings_t), intent(inout) :: findings
         character(*), intent(in), optional :: name             !! in findings in place of a file
      end subroutine read_text

      !> A case to be made in memory: add joints and links, or loops, then say what the output is and at which inputs it is wanted.
      module function new_case(title) result(case)
         implicit none (type, external)
         character(*), intent(in), optional :: title
         type(case_t) :: case
      end function new_case

      !> Add a loop, arc by arc from the input pivot back to it along the frame, as ILINK and ILOOP of the manual have it.
      module subroutine add_loop(self, ilink, iloop, length, angle)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         integer, intent(in) :: ilink(:), iloop(:)           !! shape (arcs): arc numbers; loop or guide numbers
         real(wp), intent(in), optional :: length(:)         !! shape (arcs): lengths; 0 if absent
         real(wp), intent(in), optional :: angle(:)          !! shape (arcs): angles; 0 if absent
      end subroutine add_loop

      !> Add a joint of a sketch at its place in the drawing; a joint of that name is moved there.
      module subroutine add_joint(self, name, x, y, fixed)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: name
         real(wp), intent(in) :: x, y
         logical, intent(in), optional :: fixed              !! it belongs to the frame, which needs no `add_link` then
      end subroutine add_joint

      !> Add a link of a sketch by its joints. The frame is the link of the fixed joints; without any it is the first link.
      module subroutine add_link(self, joints, name)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: joints                  !! names, blanks between them: 'B C P'
         character(*), intent(in), optional :: name          !! its joints without blanks if absent
      end subroutine add_link

      !> Add a slide (prismatic pair) of a sketch.
      module subroutine add_slide(self, link, along, x, y, angle, name)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: link, along             !! names of the two links
         real(wp), intent(in) :: x, y                        !! a point of its line in the drawing
         real(wp), intent(in) :: angle                       !! direction of the line, degrees
         character(*), intent(in), optional :: name          !! S1, S2 ... if absent
      end subroutine add_slide

      !> Add a pair of gears of a sketch.
      module subroutine add_gear(self, first, second, carrier, teeth)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: first, second           !! the wheels, links
         character(*), intent(in) :: carrier                 !! the link that both centres are on
         real(wp), intent(in) :: teeth(2)                    !! of an internal pair one is negative
      end subroutine add_gear

      !> Add a drive of a sketch: a joint, a slide, or the two joints of a cylinder.
      module subroutine add_drive(self, what, base, link)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: what
         character(*), intent(in), optional :: base          !! the link against which it moves; the other link there if absent
         character(*), intent(in), optional :: link          !! the link that it moves; the other link there if absent
      end subroutine add_drive

      !> Add an output of a sketch: 'point P', 'angle rocker' ..., as OUTPUT of the manual.
      module subroutine add_output(self, what, name)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: what
         character(*), intent(in), optional :: name          !! in tables; the words, joined by _, if absent
      end subroutine add_output

      !> Let a dimension of a sketch vary in a search: 'A B' a length, 'angle B C B P', 'place D' ..., as VARY of the manual.
      module subroutine vary_part(self, what)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: what
      end subroutine vary_part

      !> Say what the output is, and on which arc it hangs.
      module subroutine set_output(self, kind, arc, loop, length, angle)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         integer, intent(in) :: kind                         !! one of `output_...`
         integer, intent(in) :: arc, loop                    !! negative arc: measured from its start
         real(wp), intent(in), optional :: length, angle     !! of the output arc, in the axes of the arc; 0 if absent
      end subroutine set_output

      !> Ask for a full turn of the crank in steps of whole degrees.
      module subroutine set_turn(self, step)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         integer, intent(in) :: step                         !! degrees; negative: clockwise
      end subroutine set_turn

      !> Ask for input positions.
      module subroutine set_positions(self, increments, reference)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         real(wp), intent(in) :: increments(:)               !! from the reference position: degrees, or length of a sliding input
         real(wp), intent(in), optional :: reference         !! reference input; 0 if absent
      end subroutine set_positions

      !> Say what is desired at the input positions: x and y of a point, or the angle, distance or length; of a pose all three.
      module subroutine set_desired(self, x, y, value)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         real(wp), intent(in), optional :: x(:), y(:)        !! shape (positions)
         real(wp), intent(in), optional :: value(:)          !! shape (positions): angle, distance or length
      end subroutine set_desired

      !> Let lengths or angles of a loop vary in a search.
      module subroutine vary_arcs(self, loop, lengths, angles)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         integer, intent(in) :: loop
         integer, intent(in), optional :: lengths(:), angles(:) !! numbers of arcs
      end subroutine vary_arcs

      !> Give any item of the notation its values: `call case%set_item('LIMITS', 'TANGLE', 60.0_wp)`.
      module subroutine set_integers(self, group, item, values)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: group, item
         integer, intent(in) :: values(:)
      end subroutine set_integers

      !> Reals, in the manner of `set_integers`.
      module subroutine set_reals(self, group, item, values)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: group, item
         real(wp), intent(in) :: values(:)
      end subroutine set_reals

      module subroutine set_integer(self, group, item, value)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: group, item
         integer, intent(in) :: value
      end subroutine set_integer

      module subroutine set_real(self, group, item, value)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: group, item
         real(wp), intent(in) :: value
      end subroutine set_real

      module subroutine set_word(self, group, item, value)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: group, item
         character(*), intent(in) :: value
      end subroutine set_word

      !> Texts, in the manner of `set_integers`; blanks at their ends are left out.
      module subroutine set_words(self, group, item, values)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: group, item
         character(*), intent(in) :: values(:)
      end subroutine set_words

      !> Read a case made in memory once, so that the studies that follow need not do so each for itself. They report mistakes.
      module subroutine settle(self)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
      end subroutine settle

      !> How many faults of its own the case has: made by the verbs that fill and change it. Every study reports them.
      pure module integer function faults_made(self)
         implicit none (type, external)
         class(case_t), intent(in) :: self
      end function faults_made

      !> Take back faults beyond the first `kept`, for a host that reports them at once; nothing came of the calls that made them.
      module subroutine take_back(self, kept, findings)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         integer, intent(in) :: kept
         type(findings_t), intent(inout) :: findings
      end subroutine take_back

      !> Number of loops.
      pure module integer function loops(self)
         implicit none (type, external)
         class(case_t), intent(in) :: self
      end function loops

      !> Number of arcs of a loop, padding of ILINK included; 0 if there is no such loop.
      pure module integer function arcs(self, loop)
         implicit none (type, external)
         class(case_t), intent(in) :: self
         integer, intent(in) :: loop
      end function arcs

      !> Title.
      pure module function title(self)
         implicit none (type, external)
         class(case_t), intent(in) :: self
         character(:), allocatable :: title
      end function title

      !> Length of an arc; 0 if there is no such arc.
      pure module real(wp) function length_of_arc(self, loop, arc) result(length)
         implicit none (type, external)
         class(case_t), intent(in) :: self
         integer, intent(in) :: loop, arc
      end function length_of_arc

      !> Angle of an arc, degrees; 0 if there is no such arc.
      pure module real(wp) function angle_of_arc(self, loop, arc) result(angle)
         implicit none (type, external)
         class(case_t), intent(in) :: self
         integer, intent(in) :: loop, arc
      end function angle_of_arc

      !> Change the length of an arc.
      module subroutine set_length(self, loop, arc, value)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         integer, intent(in) :: loop, arc
         real(wp), intent(in) :: value
      end subroutine set_length

      !> Change the angle of an arc, degrees.
      module subroutine set_angle(self, loop, arc, value)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         integer, intent(in) :: loop, arc
         real(wp), intent(in) :: value
      end subroutine set_angle

      !> The case in the notation of the manual, complete: read again, it is the same case. Findings of a case made in memory name
      !> lines of this text. Empty if the text of the case has errors, or if it is a sketch whose dimensions were changed and whose
      !> loops &LINKS cannot tell.
      recursive module function text_of_case(self) result(content)
         implicit none (type, external)
         class(case_t), intent(in) :: self
         character(:), allocatable :: content
      end function text_of_case

      !> Data set and problem of a case; whatever is wrong is reported.
      recursive module subroutine make_ready(case, set, prepared, problem, ready, findings, every_loop, need, reader, &
         does, turning)
         implicit none (type, external)
         type(case_t), intent(in) :: case
         class(data_set_t), allocatable, intent(out) :: set
         class(prepared_t), allocatable, intent(out) :: prepared
         class(problem_t), allocatable, intent(out) :: problem
         logical, intent(out) :: ready
         type(findings_t), intent(inout) :: findings
         logical, intent(in), optional :: every_loop         !! solve loops that the output does not depend on too
         type(memory_need_t), intent(in), optional :: need      !! for memory
         character(*), intent(in), optional :: reader        !! the program whose study it is; default psalm
         character(*), intent(in), optional :: does          !! what it does, for messages: 'bridge studies'
         logical, intent(in), optional :: turning            !! it needs a crank that turns
      end subroutine make_ready

      !> What the case says; whatever is wrong is reported. Without an error `set` is allocated.
      recursive module subroutine set_of(case, set, own, reader)
         implicit none (type, external)
         type(case_t), intent(in) :: case
         class(data_set_t), allocatable, intent(out) :: set
         type(findings_t), intent(inout) :: own
         character(*), intent(in), optional :: reader        !! the program whose study it is; default psalm
      end subroutine set_of

      !> Add what was found elsewhere, with the name of its file.
      module subroutine tell(own, findings)
         implicit none (type, external)
         type(findings_t), intent(in) :: own
         type(findings_t), intent(inout) :: findings
      end subroutine tell

      !> The cases of a text that a study wrote.
      module subroutine of_text(text, cases)
         implicit none (type, external)
         character(*), intent(in) :: text
         type(case_t), allocatable, intent(out) :: cases(:)
      end subroutine of_text

      !> True if the case is written by items; one that was read is opened, an empty one is a fault.
      module logical function is_open(self)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
      end function is_open

      !> True if loops, joints and links may be added: not to a case that was read.
      module logical function may_add(self)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
      end function may_add

      !> What was read of the case no longer holds.
      module subroutine unread(self)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
      end subroutine unread

      module subroutine take_item(self, group, item, values)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
         character(*), intent(in) :: group, item, values
      end subroutine take_item

      !> The item of that name; 0 if it was not given.
      pure module integer function place_of(self, group, item)
         implicit none (type, external)
         class(case_t), intent(in) :: self
         character(*), intent(in) :: group, item
      end function place_of

      !> The cases of a text without errors, as titles and groups.
      module subroutine split_cases(text, parts)
         implicit none (type, external)
         character(*), intent(in) :: text
         type(case_text_t), allocatable, intent(out) :: parts(:)
      end subroutine split_cases

      !> One case as a text of its own: without LAST, which says whether another follows.
      module function text_of_parts(part) result(content)
         implicit none (type, external)
         type(case_text_t), intent(in) :: part
         character(:), allocatable :: content
      end function text_of_parts

      !> A case made in memory has no joints at first.
      pure module subroutine begin_sketch(self)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
      end subroutine begin_sketch

      !> The text of a case that was read becomes items.
      module subroutine open(self)
         implicit none (type, external)
         class(case_t), intent(inout) :: self
      end subroutine open

      !> True if the case was made of `add_loop`.
      pure module logical function is_of_loops(self)
         implicit none (type, external)
         class(case_t), intent(in) :: self
      end function is_of_loops
   end interface
end module psalm_case
