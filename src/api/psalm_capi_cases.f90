!> The interface for C: cases are made, looked at and changed.
module psalm_capi_cases
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_loc, c_null_ptr, c_ptr
   use psalm, only: case_t, findings_t, level_error, level_warning, new_case, read_file, read_text, wp
   use psalm_capi_handles, only: done, misuse, handle_t, length_of, text_of, handle_of, new_handle, handed_out, concluded, &
                                 wrong, hand_over, integers_at, reals_at, put_reals, checked_words
   implicit none (type, external)
   private
   public :: psalm_read_file, psalm_read_text, psalm_new, psalm_copy, psalm_case_text, psalm_case_title, psalm_free
   public :: psalm_add_loop, psalm_add_joint, psalm_add_link, psalm_add_slide, psalm_add_gear, psalm_add_drive
   public :: psalm_add_output, psalm_vary, psalm_vary_arc, psalm_set_integers, psalm_set_reals, psalm_set_word
   public :: psalm_set_words, psalm_loop_count, psalm_arc_count, psalm_set_length, psalm_set_angle, psalm_get_length
   public :: psalm_get_angle, psalm_findings, psalm_finding_level, psalm_finding_line, psalm_finding_text

   ! levels of findings, as in psalm.h
   integer(c_int), parameter :: finding_warning = 1, finding_error = 2, finding_remark = 3

contains

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
      if (associated(own)) psalm_case_text = handed_out(own%case%text(), own%reported)
   end function psalm_case_text

   type(c_ptr) function psalm_case_title(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own

      psalm_case_title = c_null_ptr
      own => handle_of(handle)
      if (associated(own)) psalm_case_title = handed_out(own%case%title(), own%reported)
   end function psalm_case_title

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
end module psalm_capi_cases
