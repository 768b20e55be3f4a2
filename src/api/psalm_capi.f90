!> The library for C, and through C for other languages: `include/psalm.h` describes every procedure.
!>
!> A handle is the address of a `handle_t`, which owns the case, its results and the texts that are handed out. Every argument that
!> could be wrong is checked here; results are copied into arrays of the caller's. Whatever is wrong comes back as a status and
!> as findings.
module psalm_capi
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_loc, c_null_char, &
                                          c_null_ptr, c_ptr, c_size_t
   use psalm, only: case_t, column_named, findings_t, level_error, level_warning, new_case, observer_t, read_file, read_text, &
                    report_t, &
                    search_state_t, stop_request_t, stop_t, study, table_t, table_for_plots, table_kind_flag, table_kind_whole, &
                    table_kind_word, verbs, version, wp
   implicit none (type, external)
   private
   public :: psalm_library_version, psalm_interface, psalm_status_text, psalm_verb
   public :: psalm_read_file, psalm_read_text, psalm_new, psalm_copy, psalm_free, psalm_case_text, psalm_case_title
   public :: psalm_add_loop, psalm_add_joint, psalm_add_link, psalm_add_slide, psalm_add_gear, psalm_add_drive, psalm_add_output
   public :: psalm_vary, psalm_vary_arc, psalm_set_integers, psalm_set_reals, psalm_set_word, psalm_set_words
   public :: psalm_loop_count, psalm_arc_count, psalm_set_length, psalm_set_angle, psalm_get_length, psalm_get_angle
   public :: psalm_study, psalm_cancel, psalm_progress, psalm_result_free
   public :: psalm_table_count, psalm_table_name, psalm_table_about, psalm_find_table, psalm_row_count, psalm_column_count
   public :: psalm_column_name, psalm_column_unit, psalm_column_kind, psalm_find_column, psalm_column, psalm_word
   public :: psalm_listing, psalm_found_text, psalm_case_count, psalm_case_of
   public :: psalm_file_count, psalm_file_ending, psalm_file_content
   public :: psalm_findings, psalm_finding_level, psalm_finding_line, psalm_finding_text

   ! statuses, as in psalm.h
   integer(c_int), parameter :: done = 0, violation = 1, bad_input = 2, misuse = 4

   ! the interface that a program was compiled for, as in psalm.h: it grows where a call is changed or left out
   integer(c_int), parameter :: interface_number = 1

   ! options of psalm_study, as in psalm.h
   integer(c_int), parameter :: option_brief = 1

   ! levels of findings, as in psalm.h
   integer(c_int), parameter :: finding_warning = 1, finding_error = 2, finding_remark = 3

   ! kinds of columns, as in psalm.h
   integer(c_int), parameter :: column_real = 0, column_whole = 1, column_flag = 2, column_word = 3

   character(*, c_char), parameter :: nul = c_null_char
   character(*, c_char), parameter :: words = 'done'//nul// &
      'done, but constraints are violated or the search stopped early'//nul//'the input is wrong'//nul// &
      'a file could not be read, or there was not enough memory'//nul//'the call is wrong'//nul//'unknown status'//nul

   character(*, c_char), parameter :: names_of_verbs = trim(verbs(1)%name)//nul// &
      trim(verbs(2)%name)//nul// &
      trim(verbs(3)%name)//nul// &
      trim(verbs(4)%name)//nul// &
      trim(verbs(5)%name)//nul// &
      trim(verbs(6)%name)//nul// &
      trim(verbs(7)%name)//nul// &
      trim(verbs(8)%name)//nul// &
      trim(verbs(9)%name)//nul// &
      trim(verbs(10)%name)//nul// &
      trim(verbs(11)%name)//nul// &
      trim(verbs(12)%name)//nul// &
      trim(verbs(13)%name)//nul// &
      trim(verbs(14)%name)//nul// &
      trim(verbs(15)%name)//nul// &
      trim(verbs(16)%name)//nul// &
      trim(verbs(17)%name)//nul// &
      trim(verbs(18)%name)//nul

   ! never changed; variables only so that they have an address
   character(len(version) + 1, c_char), target :: version_text = version//nul
   character(len(words), c_char), target :: status_words = words
   character(len(names_of_verbs), c_char), target :: verb_names = names_of_verbs

   !> A text that ends as C wants it.
   type :: c_text_t
      character(kind=c_char), allocatable :: letters(:)
   end type c_text_t

   !> Whether a study is to end; another thread, or a signal handler, may say so.
   type, extends(stop_request_t) :: host_t
      integer(c_int) :: wants_end = 0
      integer(c_int) :: followed = 0, paths = 0   !! of an exact synthesis: how far it is
   contains
      procedure :: asked
      procedure :: told
   end type host_t

   !> How far a search is; another thread may ask.
   type, extends(observer_t) :: watch_t
      integer(c_int) :: made = 0, most = 0        !! starts or iterations
      real(c_double) :: best = 0.0_c_double       !! objective
   contains
      procedure :: report
   end type watch_t

   !> What the handle of a case points to.
   type :: handle_t
      type(case_t) :: case
      type(host_t) :: host
      type(watch_t) :: watch
      type(stop_t) :: ending                      !! asks the host
      type(findings_t) :: findings                !! of the last call
      type(c_text_t), allocatable :: texts(:)     !! of the findings
      type(c_text_t) :: told                      !! the text handed out last
   end type handle_t

   !> What the handle of a result points to.
   type :: result_handle_t
      type(report_t) :: report
      integer, allocatable :: tables(:)           !! those of the report that are for other programs
      type(c_text_t) :: told                      !! the text handed out last
      type(c_text_t) :: listing, data_set         !! handed out as long as the result lives
      type(c_text_t), allocatable :: files(:)
   end type result_handle_t

   interface
      pure integer(c_size_t) function length_of(text) bind(C, name='strlen')
         import :: c_ptr, c_size_t
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: text
      end function length_of
   end interface

contains

   ! ---- texts -------------------------------------------------------------------------------------------------------

   ! no function may be called like a module: their names are one to the compiler

   !> Version of the library; never freed.
   type(c_ptr) function psalm_library_version() bind(C)
      psalm_library_version = c_loc(version_text(1:1))
   end function psalm_library_version

   integer(c_int) function psalm_interface() bind(C)
      psalm_interface = interface_number
   end function psalm_interface

   !> Name of a verb; a null pointer if there are not so many.
   type(c_ptr) function psalm_verb(number) bind(C)
      integer(c_int), value, intent(in) :: number
      integer :: first, i

      psalm_verb = c_null_ptr
      if (number < 1 .or. number > size(verbs)) return
      first = 1
      do i = 2, number
         first = first + len_trim(verbs(i - 1)%name) + 1
      end do
      psalm_verb = c_loc(verb_names(first:first))
   end function psalm_verb

   !> What a status means; never freed.
   type(c_ptr) function psalm_status_text(status) bind(C)
      integer(c_int), value, intent(in) :: status
      integer :: first, i

      first = 1
      do i = 1, merge(int(status), int(misuse) + 1, status >= done .and. status <= misuse)
         first = first + index(words(first:), nul)
      end do
      psalm_status_text = c_loc(status_words(first:first))
   end function psalm_status_text

   !> A text of C as a Fortran one; empty for a null pointer.
   function text_of(pointer) result(text)
      type(c_ptr), intent(in) :: pointer
      character(:), allocatable :: text
      character(kind=c_char), pointer :: letters(:)
      integer :: i

      allocate (character(0) :: text)
      if (.not. c_associated(pointer)) return
      call c_f_pointer(pointer, letters, [length_of(pointer)])
      deallocate (text)
      allocate (character(size(letters)) :: text)
      do i = 1, size(letters)
         text(i:i) = letters(i)
      end do
   end function text_of

   pure type(c_text_t) function as_c(text)
      character(*), intent(in) :: text
      integer :: i

      allocate (as_c%letters(len(text) + 1))
      do i = 1, len(text)
         as_c%letters(i) = text(i:i)
      end do
      as_c%letters(len(text) + 1) = c_null_char
   end function as_c

   ! ---- handles -----------------------------------------------------------------------------------------------------

   !> What a handle points to; not associated for a null pointer.
   function handle_of(pointer) result(handle)
      type(c_ptr), intent(in) :: pointer
      type(handle_t), pointer :: handle

      handle => null()
      if (c_associated(pointer)) call c_f_pointer(pointer, handle)
   end function handle_of

   !> A handle without a case.
   function new_handle() result(handle)
      type(handle_t), pointer :: handle

      allocate (handle)
      allocate (handle%texts(0))
      handle%told = as_c('')
   end function new_handle

   !> A text that the caller may read until the next call with this handle.
   function handed_out(text, told) result(pointer)
      character(*), intent(in) :: text
      type(c_text_t), intent(inout), target :: told
      type(c_ptr) :: pointer

      told = as_c(text)
      pointer = c_loc(told%letters)
   end function handed_out

   !> Keep the findings of a call and give its status: `violation` if something is violated, unless there are errors.
   integer(c_int) function concluded(handle, findings, violated) result(status)
      type(handle_t), intent(inout) :: handle
      type(findings_t), intent(in) :: findings
      logical, intent(in), optional :: violated
      integer :: i

      handle%findings = findings
      deallocate (handle%texts)
      allocate (handle%texts(findings%count))
      do i = 1, findings%count
         handle%texts(i) = as_c(findings%list(i)%render())
      end do
      status = int(findings%exit_code(), c_int)
      if (status /= done .or. .not. present(violated)) return
      if (violated) status = violation
   end function concluded

   !> The status of a wrong call, with a finding that says what is wrong.
   integer(c_int) function wrong(handle, text)
      type(handle_t), intent(inout) :: handle
      character(*), intent(in) :: text
      type(findings_t) :: findings

      call findings%error(text)
      wrong = concluded(handle, findings)
      wrong = misuse
   end function wrong

   ! ---- making a case -----------------------------------------------------------------------------------------------

   integer(c_int) function psalm_read_file(file, number, made) bind(C)
      type(c_ptr), value, intent(in) :: file
      integer(c_int), value, intent(in) :: number
      type(c_ptr), value, intent(in) :: made
      type(case_t), allocatable :: cases(:)
      type(findings_t) :: findings

      psalm_read_file = misuse
      if (.not. c_associated(made)) return
      call hand_over(made, c_null_ptr)
      if (.not. c_associated(file)) return
      call read_file(text_of(file), cases, findings)
      psalm_read_file = chosen(cases, findings, number, made)
   end function psalm_read_file

   integer(c_int) function psalm_read_text(text, number, made) bind(C)
      type(c_ptr), value, intent(in) :: text
      integer(c_int), value, intent(in) :: number
      type(c_ptr), value, intent(in) :: made
      type(case_t), allocatable :: cases(:)
      type(findings_t) :: findings

      psalm_read_text = misuse
      if (.not. c_associated(made)) return
      call hand_over(made, c_null_ptr)
      if (.not. c_associated(text)) return
      call read_text(text_of(text), cases, findings)
      psalm_read_text = chosen(cases, findings, number, made)
   end function psalm_read_text

   !> The case of a number, or an empty one with the findings.
   integer(c_int) function chosen(cases, findings, number, made) result(status)
      type(case_t), intent(in) :: cases(:)
      type(findings_t), intent(inout) :: findings
      integer(c_int), intent(in) :: number
      type(c_ptr), intent(in) :: made
      type(handle_t), pointer :: handle

      handle => new_handle()
      if (number >= 1 .and. number <= size(cases)) then
         handle%case = cases(number)
      else if (.not. findings%failed()) then
         call findings%error('there is no case of this number')
      end if
      status = concluded(handle, findings)
      call hand_over(made, c_loc(handle))
   end function chosen

   integer(c_int) function psalm_new(title, made) bind(C)
      type(c_ptr), value, intent(in) :: title
      type(c_ptr), value, intent(in) :: made
      type(handle_t), pointer :: handle

      psalm_new = misuse
      if (.not. c_associated(made)) return
      handle => new_handle()
      if (c_associated(title)) then
         handle%case = new_case(text_of(title))
      else
         handle%case = new_case()
      end if
      call hand_over(made, c_loc(handle))
      psalm_new = done
   end function psalm_new

   !> The same case once more.
   integer(c_int) function psalm_copy(handle, made) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(c_ptr), value, intent(in) :: made
      type(handle_t), pointer :: own, other

      psalm_copy = misuse
      if (.not. c_associated(made)) return
      call hand_over(made, c_null_ptr)
      own => handle_of(handle)
      if (.not. associated(own)) return
      other => new_handle()
      other%case = own%case
      call hand_over(made, c_loc(other))
      psalm_copy = done
   end function psalm_copy

   !> The case in the notation of the manual.
   type(c_ptr) function psalm_case_text(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own

      psalm_case_text = c_null_ptr
      own => handle_of(handle)
      if (associated(own)) psalm_case_text = handed_out(own%case%text(), own%told)
   end function psalm_case_text

   type(c_ptr) function psalm_case_title(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own

      psalm_case_title = c_null_ptr
      own => handle_of(handle)
      if (associated(own)) psalm_case_title = handed_out(own%case%title(), own%told)
   end function psalm_case_title

   !> Store a handle where the caller wants it.
   subroutine hand_over(place, pointer)
      type(c_ptr), intent(in) :: place, pointer
      type(c_ptr), pointer :: there

      call c_f_pointer(place, there)
      there = pointer
   end subroutine hand_over

   subroutine psalm_free(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own

      own => handle_of(handle)
      if (associated(own)) deallocate (own)
   end subroutine psalm_free

   integer(c_int) function psalm_add_loop(handle, arcs, ilink, iloop, length, angle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: arcs
      type(c_ptr), value, intent(in) :: ilink, iloop, length, angle
      type(handle_t), pointer :: own
      real(wp), allocatable :: lengths(:), angles(:)
      integer :: faults

      psalm_add_loop = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      if (arcs < 1 .or. .not. c_associated(ilink) .or. .not. c_associated(iloop)) then
         psalm_add_loop = wrong(own, 'psalm_add_loop: arcs must be at least 1, ilink and iloop not NULL')
         return
      end if
      allocate (lengths(arcs), angles(arcs), source=0.0_wp)
      if (c_associated(length)) lengths = reals_at(length, arcs)
      if (c_associated(angle)) angles = reals_at(angle, arcs)
      faults = own%case%faults_made()
      call own%case%add_loop(integers_at(ilink, arcs), integers_at(iloop, arcs), lengths, angles)
      psalm_add_loop = taken(own, faults)
   end function psalm_add_loop

   integer(c_int) function psalm_add_joint(handle, name, x, y, fixed) bind(C)
      type(c_ptr), value, intent(in) :: handle, name
      real(c_double), value, intent(in) :: x, y
      integer(c_int), value, intent(in) :: fixed
      type(handle_t), pointer :: own
      integer :: faults

      psalm_add_joint = checked_words('psalm_add_joint: name', handle, [name], own)
      if (psalm_add_joint /= done) return
      faults = own%case%faults_made()
      call own%case%add_joint(text_of(name), real(x, wp), real(y, wp), fixed /= 0)
      psalm_add_joint = taken(own, faults)
   end function psalm_add_joint

   integer(c_int) function psalm_add_link(handle, joints, name) bind(C)
      type(c_ptr), value, intent(in) :: handle, joints, name
      type(handle_t), pointer :: own
      integer :: faults

      psalm_add_link = checked_words('psalm_add_link: joints', handle, [joints], own)
      if (psalm_add_link /= done) return
      faults = own%case%faults_made()
      if (c_associated(name)) then
         call own%case%add_link(text_of(joints), text_of(name))
      else
         call own%case%add_link(text_of(joints))
      end if
      psalm_add_link = taken(own, faults)
   end function psalm_add_link

   integer(c_int) function psalm_add_slide(handle, link, along, x, y, angle, name) bind(C)
      type(c_ptr), value, intent(in) :: handle, link, along, name
      real(c_double), value, intent(in) :: x, y, angle
      type(handle_t), pointer :: own
      integer :: faults

      psalm_add_slide = checked_words('psalm_add_slide: link and along', handle, [link, along], own)
      if (psalm_add_slide /= done) return
      faults = own%case%faults_made()
      if (c_associated(name)) then
         call own%case%add_slide(text_of(link), text_of(along), real(x, wp), real(y, wp), real(angle, wp), text_of(name))
      else
         call own%case%add_slide(text_of(link), text_of(along), real(x, wp), real(y, wp), real(angle, wp))
      end if
      psalm_add_slide = taken(own, faults)
   end function psalm_add_slide

   integer(c_int) function psalm_add_gear(handle, first, second, carrier, teeth_first, teeth_second) bind(C)
      type(c_ptr), value, intent(in) :: handle, first, second, carrier
      real(c_double), value, intent(in) :: teeth_first, teeth_second
      type(handle_t), pointer :: own
      integer :: faults

      psalm_add_gear = checked_words('psalm_add_gear: first, second and carrier', handle, [first, second, carrier], own)
      if (psalm_add_gear /= done) return
      faults = own%case%faults_made()
      call own%case%add_gear(text_of(first), text_of(second), text_of(carrier), [real(teeth_first, wp), real(teeth_second, wp)])
      psalm_add_gear = taken(own, faults)
   end function psalm_add_gear

   integer(c_int) function psalm_add_drive(handle, what, base, link) bind(C)
      type(c_ptr), value, intent(in) :: handle, what, base, link
      type(handle_t), pointer :: own
      integer :: faults

      psalm_add_drive = checked_words('psalm_add_drive: what', handle, [what], own)
      if (psalm_add_drive /= done) return
      faults = own%case%faults_made()
      call own%case%add_drive(text_of(what), text_of(base), text_of(link))
      psalm_add_drive = taken(own, faults)
   end function psalm_add_drive

   integer(c_int) function psalm_add_output(handle, what, name) bind(C)
      type(c_ptr), value, intent(in) :: handle, what, name
      type(handle_t), pointer :: own
      integer :: faults

      psalm_add_output = checked_words('psalm_add_output: what', handle, [what], own)
      if (psalm_add_output /= done) return
      faults = own%case%faults_made()
      if (c_associated(name)) then
         call own%case%add_output(text_of(what), text_of(name))
      else
         call own%case%add_output(text_of(what))
      end if
      psalm_add_output = taken(own, faults)
   end function psalm_add_output

   integer(c_int) function psalm_vary(handle, what) bind(C)
      type(c_ptr), value, intent(in) :: handle, what
      type(handle_t), pointer :: own
      integer :: faults

      psalm_vary = checked_words('psalm_vary: what', handle, [what], own)
      if (psalm_vary /= done) return
      faults = own%case%faults_made()
      call own%case%vary(text_of(what))
      psalm_vary = taken(own, faults)
   end function psalm_vary

   integer(c_int) function psalm_vary_arc(handle, loop, arc, length, angle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: loop, arc, length, angle
      type(handle_t), pointer :: own
      integer :: faults

      psalm_vary_arc = checked_words('', handle, [c_ptr ::], own)
      if (psalm_vary_arc /= done) return
      faults = own%case%faults_made()
      if (length /= 0) call own%case%vary(int(loop), lengths=[int(arc)])
      if (angle /= 0) call own%case%vary(int(loop), angles=[int(arc)])
      psalm_vary_arc = taken(own, faults)
   end function psalm_vary_arc

   !> What a call with texts must have.
   integer(c_int) function checked_words(caller, handle, texts, own) result(status)
      character(*), intent(in) :: caller           !! and what must not be NULL
      type(c_ptr), intent(in) :: handle
      type(c_ptr), intent(in) :: texts(:)
      type(handle_t), pointer, intent(out) :: own
      integer :: i

      status = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      do i = 1, size(texts)
         if (c_associated(texts(i))) cycle
         status = wrong(own, caller//' must not be NULL')
         return
      end do
      status = done
   end function checked_words

   integer(c_int) function psalm_set_integers(handle, group, item, count, values) bind(C)
      type(c_ptr), value, intent(in) :: handle, group, item
      integer(c_int), value, intent(in) :: count
      type(c_ptr), value, intent(in) :: values
      type(handle_t), pointer :: own
      integer :: faults

      psalm_set_integers = checked_item('psalm_set_integers', handle, group, item, count, values, own)
      if (psalm_set_integers /= done) return
      faults = own%case%faults_made()
      call own%case%set_item(text_of(group), text_of(item), integers_at(values, count))
      psalm_set_integers = taken(own, faults)
   end function psalm_set_integers

   integer(c_int) function psalm_set_reals(handle, group, item, count, values) bind(C)
      type(c_ptr), value, intent(in) :: handle, group, item
      integer(c_int), value, intent(in) :: count
      type(c_ptr), value, intent(in) :: values
      type(handle_t), pointer :: own
      integer :: faults

      psalm_set_reals = checked_item('psalm_set_reals', handle, group, item, count, values, own)
      if (psalm_set_reals /= done) return
      faults = own%case%faults_made()
      call own%case%set_item(text_of(group), text_of(item), reals_at(values, count))
      psalm_set_reals = taken(own, faults)
   end function psalm_set_reals

   integer(c_int) function psalm_set_word(handle, group, item, word) bind(C)
      type(c_ptr), value, intent(in) :: handle, group, item, word
      type(handle_t), pointer :: own
      integer :: faults

      psalm_set_word = checked_item('psalm_set_word', handle, group, item, 1_c_int, word, own)
      if (psalm_set_word /= done) return
      faults = own%case%faults_made()
      call own%case%set_item(text_of(group), text_of(item), text_of(word))
      psalm_set_word = taken(own, faults)
   end function psalm_set_word

   integer(c_int) function psalm_set_words(handle, group, item, count, values) bind(C)
      type(c_ptr), value, intent(in) :: handle, group, item
      integer(c_int), value, intent(in) :: count
      type(c_ptr), value, intent(in) :: values
      type(handle_t), pointer :: own
      type(c_ptr), pointer :: there(:)
      character(:), allocatable :: list(:)
      integer :: faults, longest, i

      psalm_set_words = checked_item('psalm_set_words', handle, group, item, count, values, own)
      if (psalm_set_words /= done) return
      call c_f_pointer(values, there, [count])
      longest = 1
      do i = 1, count
         if (.not. c_associated(there(i))) then
            psalm_set_words = wrong(own, 'psalm_set_words: a value must not be NULL')
            return
         end if
         longest = max(longest, int(length_of(there(i))))
      end do
      allocate (character(longest) :: list(count))
      do i = 1, count
         list(i) = text_of(there(i))
      end do
      faults = own%case%faults_made()
      call own%case%set_item(text_of(group), text_of(item), list)
      psalm_set_words = taken(own, faults)
   end function psalm_set_words

   !> The status of a call that sets an item: what is wrong with it is a finding, and the case stays as it was.
   integer(c_int) function taken(own, faults) result(status)
      type(handle_t), intent(inout) :: own
      integer, intent(in) :: faults               !! that the case had before
      type(findings_t) :: findings

      status = done
      if (own%case%faults_made() == faults) return
      call own%case%take_back(faults, findings)
      status = concluded(own, findings)
   end function taken

   !> What a call that sets an item must have.
   integer(c_int) function checked_item(caller, handle, group, item, count, values, own) result(status)
      character(*), intent(in) :: caller
      type(c_ptr), intent(in) :: handle, group, item, values
      integer(c_int), intent(in) :: count
      type(handle_t), pointer, intent(out) :: own

      status = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      status = done
      if (count >= 1 .and. c_associated(group) .and. c_associated(item) .and. c_associated(values)) return
      status = wrong(own, caller//': group, item and values must not be NULL, and there must be a value')
   end function checked_item

   integer(c_int) function psalm_loop_count(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own

      psalm_loop_count = 0
      own => handle_of(handle)
      if (associated(own)) psalm_loop_count = int(own%case%loops(), c_int)
   end function psalm_loop_count

   integer(c_int) function psalm_arc_count(handle, loop) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: loop
      type(handle_t), pointer :: own

      psalm_arc_count = 0
      own => handle_of(handle)
      if (associated(own)) psalm_arc_count = int(own%case%arcs(int(loop)), c_int)
   end function psalm_arc_count

   integer(c_int) function psalm_set_length(handle, loop, arc, length) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: loop, arc
      real(c_double), value, intent(in) :: length
      type(handle_t), pointer :: own

      psalm_set_length = checked_arc('psalm_set_length', handle, loop, arc, own)
      if (psalm_set_length /= done) return
      if (ieee_is_finite(length) .and. length >= 0.0_c_double) then
         call own%case%set_length(int(loop), int(arc), real(length, wp))
      else
         psalm_set_length = wrong(own, 'psalm_set_length: a length must be a number and not negative')
      end if
   end function psalm_set_length

   integer(c_int) function psalm_set_angle(handle, loop, arc, angle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: loop, arc
      real(c_double), value, intent(in) :: angle
      type(handle_t), pointer :: own

      psalm_set_angle = checked_arc('psalm_set_angle', handle, loop, arc, own)
      if (psalm_set_angle /= done) return
      if (ieee_is_finite(angle)) then
         call own%case%set_angle(int(loop), int(arc), real(angle, wp))
      else
         psalm_set_angle = wrong(own, 'psalm_set_angle: an angle must be a number')
      end if
   end function psalm_set_angle

   integer(c_int) function psalm_get_length(handle, loop, arc, length) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: loop, arc
      type(c_ptr), value, intent(in) :: length
      type(handle_t), pointer :: own

      psalm_get_length = checked_arc('psalm_get_length', handle, loop, arc, own, length)
      if (psalm_get_length == done) call put_reals([own%case%length(int(loop), int(arc))], length)
   end function psalm_get_length

   integer(c_int) function psalm_get_angle(handle, loop, arc, angle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: loop, arc
      type(c_ptr), value, intent(in) :: angle
      type(handle_t), pointer :: own

      psalm_get_angle = checked_arc('psalm_get_angle', handle, loop, arc, own, angle)
      if (psalm_get_angle == done) call put_reals([own%case%angle(int(loop), int(arc))], angle)
   end function psalm_get_angle

   !> What a call about an arc must have.
   integer(c_int) function checked_arc(caller, handle, loop, arc, own, place) result(status)
      character(*), intent(in) :: caller
      type(c_ptr), intent(in) :: handle
      integer(c_int), intent(in) :: loop, arc
      type(handle_t), pointer, intent(out) :: own
      type(c_ptr), intent(in), optional :: place   !! where a result goes

      status = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      if (present(place)) then
         if (.not. c_associated(place)) then
            status = wrong(own, caller//': the result must not go to NULL')
            return
         end if
      end if
      status = done
      if (arc < 1 .or. arc > own%case%arcs(int(loop))) status = wrong(own, caller//': there is no such arc')
   end function checked_arc

   ! ---- studies -----------------------------------------------------------------------------------------------------

   integer(c_int) function psalm_study(handle, verb, options, threads, made) bind(C)
      type(c_ptr), value, intent(in) :: handle, verb
      integer(c_int), value, intent(in) :: options, threads
      type(c_ptr), value, intent(in) :: made
      type(handle_t), pointer :: own
      type(result_handle_t), pointer :: result
      type(findings_t) :: findings

      psalm_study = misuse
      if (c_associated(made)) call hand_over(made, c_null_ptr)
      own => handle_of(handle)
      if (.not. associated(own)) return
      if (.not. (c_associated(made) .and. c_associated(verb))) then
         psalm_study = wrong(own, 'psalm_study: verb and made must not be NULL')
         return
      end if
      if (options /= 0 .and. options /= option_brief) then
         psalm_study = wrong(own, 'psalm_study: options must be 0 or PSALM_BRIEF')
         return
      end if
      call begin_watch(own)
      call own%case%settle()
      allocate (result)
      call study(own%case, text_of(verb), result%report, findings, int(threads), own%ending, own%watch, options == option_brief)
      psalm_study = concluded(own, findings, result%report%violated)
      if (findings%failed()) then
         deallocate (result)
         return
      end if
      call finish_result(result)
      call hand_over(made, c_loc(result))
   end function psalm_study

   !> What is handed out as long as the result lives.
   subroutine finish_result(result)
      type(result_handle_t), intent(inout) :: result
      integer :: i

      associate (report => result%report)
         result%tables = pack([(i, i=1, report%tables%count)], &
                              [(report%tables%tables(i)%audience /= table_for_plots, i=1, report%tables%count)])
         result%listing = as_c(report%listing)
         result%data_set = as_c(report%data_set)
         result%told = as_c('')
         allocate (result%files(size(report%files)))
         do i = 1, size(report%files)
            result%files(i) = as_c(report%files(i)%content)
            deallocate (report%files(i)%content)
         end do
      end associate
   end subroutine finish_result

   !> Before a study that can be ended: nobody has asked yet.
   subroutine begin_watch(own)
      type(handle_t), intent(inout), target :: own

      !$omp atomic write
      own%host%wants_end = 0
      !$omp atomic write
      own%watch%made = 0
      !$omp atomic write
      own%watch%most = 0
      own%host%followed = 0
      own%host%paths = 0
      call own%ending%listen_to(own%host)
   end subroutine begin_watch

   integer(c_int) function psalm_cancel(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own

      psalm_cancel = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      !$omp atomic write
      own%host%wants_end = 1
      psalm_cancel = done
   end function psalm_cancel

   integer(c_int) function psalm_progress(handle, made, most, best) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(c_ptr), value, intent(in) :: made, most, best
      type(handle_t), pointer :: own
      integer(c_int) :: number, paths
      real(c_double) :: objective

      psalm_progress = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      if (c_associated(made)) then
         !$omp atomic read
         number = own%watch%made
         !$omp atomic read
         paths = own%host%followed
         call put_integer(max(number, paths), made)
      end if
      if (c_associated(most)) then
         !$omp atomic read
         number = own%watch%most
         !$omp atomic read
         paths = own%host%paths
         call put_integer(max(number, paths), most)
      end if
      if (c_associated(best)) then
         !$omp atomic read
         objective = own%watch%best
         call put_reals([real(objective, wp)], best)
      end if
      psalm_progress = done
   end function psalm_progress

   !> True if an end was asked for.
   logical function asked(self)
      class(host_t), intent(in) :: self
      integer(c_int) :: wanted

      !$omp atomic read
      wanted = self%wants_end
      asked = wanted /= 0
   end function asked

   !> Note how many paths are followed.
   subroutine told(self, done, of)
      class(host_t), intent(inout) :: self
      integer, intent(in) :: done, of

      !$omp atomic write
      self%paths = int(of, c_int)
      !$omp atomic write
      self%followed = int(done, c_int)
   end subroutine told

   !> Note where a search stands.
   subroutine report(self, state, points, objectives)
      class(watch_t), intent(inout) :: self
      type(search_state_t), intent(in) :: state
      real(wp), intent(in), optional :: points(:, :)
      real(wp), intent(in), optional :: objectives(:)

      associate (no_points => present(points), no_objectives => present(objectives))
      end associate
      !$omp atomic write
      self%most = int(state%limit, c_int)
      !$omp atomic write
      self%best = real(state%best, c_double)
      !$omp atomic write
      self%made = int(state%iteration, c_int)
   end subroutine report

   ! ---- results -----------------------------------------------------------------------------------------------------

   !> What the handle of a result points to; not associated for a null pointer.
   function result_of(pointer) result(handle)
      type(c_ptr), intent(in) :: pointer
      type(result_handle_t), pointer :: handle

      handle => null()
      if (c_associated(pointer)) call c_f_pointer(pointer, handle)
   end function result_of

   subroutine psalm_result_free(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(result_handle_t), pointer :: own

      own => result_of(handle)
      if (associated(own)) deallocate (own)
   end subroutine psalm_result_free

   integer(c_int) function psalm_table_count(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(result_handle_t), pointer :: own

      psalm_table_count = 0
      own => result_of(handle)
      if (associated(own)) psalm_table_count = size(own%tables, kind=c_int)
   end function psalm_table_count

   !> A table of a result, and a column of it; not associated if there is none.
   subroutine look_up(handle, table, own, found, column)
      type(c_ptr), intent(in) :: handle
      integer(c_int), intent(in) :: table
      type(result_handle_t), pointer, intent(out) :: own
      type(table_t), pointer, intent(out) :: found
      integer(c_int), intent(in), optional :: column

      found => null()
      own => result_of(handle)
      if (.not. associated(own)) return
      if (table < 1 .or. table > size(own%tables)) return
      found => own%report%tables%tables(own%tables(table))
      if (.not. present(column)) return
      if (column < 1 .or. column > found%count) found => null()
   end subroutine look_up

   type(c_ptr) function psalm_table_name(handle, table) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_table_name = c_null_ptr
      call look_up(handle, table, own, found)
      if (associated(found)) psalm_table_name = handed_out(found%block, own%told)
   end function psalm_table_name

   type(c_ptr) function psalm_table_about(handle, table) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_table_about = c_null_ptr
      call look_up(handle, table, own, found)
      if (associated(found)) psalm_table_about = handed_out(found%about, own%told)
   end function psalm_table_about

   !> Number of the table of that name; 0: there is none.
   integer(c_int) function psalm_find_table(handle, name) bind(C)
      type(c_ptr), value, intent(in) :: handle, name
      type(result_handle_t), pointer :: own
      character(:), allocatable :: wanted
      integer :: place

      psalm_find_table = 0
      own => result_of(handle)
      if (.not. (associated(own) .and. c_associated(name))) return
      wanted = text_of(name)
      place = own%report%find(wanted)
      if (place > 0) psalm_find_table = int(findloc(own%tables, place, dim=1), c_int)
   end function psalm_find_table

   integer(c_int) function psalm_row_count(handle, table) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_row_count = 0
      call look_up(handle, table, own, found)
      if (associated(found)) psalm_row_count = int(found%rows, c_int)
   end function psalm_row_count

   integer(c_int) function psalm_column_count(handle, table) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_column_count = 0
      call look_up(handle, table, own, found)
      if (associated(found)) psalm_column_count = int(found%count, c_int)
   end function psalm_column_count

   type(c_ptr) function psalm_column_name(handle, table, column) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table, column
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_column_name = c_null_ptr
      call look_up(handle, table, own, found, column)
      if (associated(found)) psalm_column_name = handed_out(found%columns(column)%name, own%told)
   end function psalm_column_name

   type(c_ptr) function psalm_column_unit(handle, table, column) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table, column
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_column_unit = c_null_ptr
      call look_up(handle, table, own, found, column)
      if (associated(found)) psalm_column_unit = handed_out(found%columns(column)%unit, own%told)
   end function psalm_column_unit

   !> One of PSALM_REAL, PSALM_WHOLE, PSALM_FLAG, PSALM_WORD; -1 if there is no such column.
   integer(c_int) function psalm_column_kind(handle, table, column) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table, column
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_column_kind = -1
      call look_up(handle, table, own, found, column)
      if (.not. associated(found)) return
      select case (found%columns(column)%kind)
      case (table_kind_whole)
         psalm_column_kind = column_whole
      case (table_kind_flag)
         psalm_column_kind = column_flag
      case (table_kind_word)
         psalm_column_kind = column_word
      case default
         psalm_column_kind = column_real
      end select
   end function psalm_column_kind

   !> Number of the column of that name; 0: there is none.
   integer(c_int) function psalm_find_column(handle, table, name) bind(C)
      type(c_ptr), value, intent(in) :: handle, name
      integer(c_int), value, intent(in) :: table
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found
      character(:), allocatable :: wanted

      psalm_find_column = 0
      call look_up(handle, table, own, found)
      if (.not. (associated(found) .and. c_associated(name))) return
      wanted = text_of(name)
      psalm_find_column = int(column_named(found, wanted), c_int)
   end function psalm_find_column

   !> Copy the numbers of a column; NaN for what is not known.
   integer(c_int) function psalm_column(handle, table, column, count, values) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table, column, count
      type(c_ptr), value, intent(in) :: values
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_column = misuse
      call look_up(handle, table, own, found, column)
      if (.not. associated(found)) return
      if (count /= found%rows .or. found%columns(column)%kind == table_kind_word) return
      if (count > 0) then
         if (.not. c_associated(values)) return
         associate (one => found%columns(column))
            call put_reals(merge(one%values, ieee_value(1.0_wp, ieee_quiet_nan), one%known), values)
         end associate
      end if
      psalm_column = done
   end function psalm_column

   !> One word of a column of words; empty for what is not known.
   type(c_ptr) function psalm_word(handle, table, column, row) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: table, column, row
      type(result_handle_t), pointer :: own
      type(table_t), pointer :: found

      psalm_word = c_null_ptr
      call look_up(handle, table, own, found, column)
      if (.not. associated(found)) return
      if (row < 1 .or. row > found%rows .or. found%columns(column)%kind /= table_kind_word) return
      if (found%columns(column)%known(row)) then
         psalm_word = handed_out(trim(found%columns(column)%words(row)), own%told)
      else
         psalm_word = handed_out('', own%told)
      end if
   end function psalm_word

   type(c_ptr) function psalm_listing(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(result_handle_t), pointer :: own

      psalm_listing = c_null_ptr
      own => result_of(handle)
      if (associated(own)) psalm_listing = c_loc(own%listing%letters)
   end function psalm_listing

   type(c_ptr) function psalm_found_text(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(result_handle_t), pointer :: own

      psalm_found_text = c_null_ptr
      own => result_of(handle)
      if (associated(own)) psalm_found_text = c_loc(own%data_set%letters)
   end function psalm_found_text

   integer(c_int) function psalm_case_count(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(result_handle_t), pointer :: own

      psalm_case_count = 0
      own => result_of(handle)
      if (associated(own)) psalm_case_count = size(own%report%cases, kind=c_int)
   end function psalm_case_count

   integer(c_int) function psalm_case_of(handle, number, made) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: number
      type(c_ptr), value, intent(in) :: made
      type(result_handle_t), pointer :: own
      type(handle_t), pointer :: found

      psalm_case_of = misuse
      if (.not. c_associated(made)) return
      call hand_over(made, c_null_ptr)
      own => result_of(handle)
      if (.not. associated(own)) return
      if (number < 1 .or. number > size(own%report%cases)) return
      found => new_handle()
      found%case = own%report%cases(number)
      call hand_over(made, c_loc(found))
      psalm_case_of = done
   end function psalm_case_of

   integer(c_int) function psalm_file_count(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(result_handle_t), pointer :: own

      psalm_file_count = 0
      own => result_of(handle)
      if (associated(own)) psalm_file_count = size(own%files, kind=c_int)
   end function psalm_file_count

   type(c_ptr) function psalm_file_ending(handle, number) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: number
      type(result_handle_t), pointer :: own

      psalm_file_ending = c_null_ptr
      own => result_of(handle)
      if (.not. associated(own)) return
      if (number < 1 .or. number > size(own%files)) return
      psalm_file_ending = handed_out(own%report%files(number)%ending, own%told)
   end function psalm_file_ending

   type(c_ptr) function psalm_file_content(handle, number) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: number
      type(result_handle_t), pointer :: own

      psalm_file_content = c_null_ptr
      own => result_of(handle)
      if (.not. associated(own)) return
      if (number < 1 .or. number > size(own%files)) return
      psalm_file_content = c_loc(own%files(number)%letters)
   end function psalm_file_content

   ! ---- findings ----------------------------------------------------------------------------------------------------

   integer(c_int) function psalm_findings(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own

      psalm_findings = 0
      own => handle_of(handle)
      if (associated(own)) psalm_findings = int(own%findings%count, c_int)
   end function psalm_findings

   integer(c_int) function psalm_finding_level(handle, number) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: number
      type(handle_t), pointer :: own

      psalm_finding_level = 0
      if (.not. has_finding(handle, number, own)) return
      select case (own%findings%list(number)%level)
      case (level_error)
         psalm_finding_level = finding_error
      case (level_warning)
         psalm_finding_level = finding_warning
      case default
         psalm_finding_level = finding_remark
      end select
   end function psalm_finding_level

   integer(c_int) function psalm_finding_line(handle, number) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: number
      type(handle_t), pointer :: own

      psalm_finding_line = 0
      if (has_finding(handle, number, own)) psalm_finding_line = int(own%findings%list(number)%line, c_int)
   end function psalm_finding_line

   type(c_ptr) function psalm_finding_text(handle, number) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: number
      type(handle_t), pointer :: own

      psalm_finding_text = c_null_ptr
      if (has_finding(handle, number, own)) psalm_finding_text = c_loc(own%texts(number)%letters)
   end function psalm_finding_text

   logical function has_finding(handle, number, own)
      type(c_ptr), intent(in) :: handle
      integer(c_int), intent(in) :: number
      type(handle_t), pointer, intent(out) :: own

      own => handle_of(handle)
      has_finding = associated(own)
      if (has_finding) has_finding = number >= 1 .and. number <= own%findings%count
   end function has_finding

   ! ---- arrays of C -------------------------------------------------------------------------------------------------

   function integers_at(pointer, n) result(values)
      type(c_ptr), intent(in) :: pointer
      integer(c_int), intent(in) :: n
      integer :: values(n)
      integer(c_int), pointer :: there(:)

      call c_f_pointer(pointer, there, [n])
      values = int(there)
   end function integers_at

   function reals_at(pointer, n) result(values)
      type(c_ptr), intent(in) :: pointer
      integer(c_int), intent(in) :: n
      real(wp) :: values(n)
      real(c_double), pointer :: there(:)

      call c_f_pointer(pointer, there, [n])
      values = real(there, wp)
   end function reals_at

   subroutine put_integer(value, pointer)
      integer(c_int), intent(in) :: value
      type(c_ptr), intent(in) :: pointer
      integer(c_int), pointer :: there

      call c_f_pointer(pointer, there)
      there = value
   end subroutine put_integer

   subroutine put_reals(values, pointer)
      real(wp), intent(in) :: values(:)
      type(c_ptr), intent(in) :: pointer
      real(c_double), pointer :: there(:)

      call c_f_pointer(pointer, there, [size(values)])
      there = real(values, c_double)
   end subroutine put_reals
end module psalm_capi
