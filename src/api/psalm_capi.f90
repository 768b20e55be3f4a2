!> The library for C, and through C for other languages: `include/psalm.h` describes every procedure.
!>
!> A handle is the address of a `handle_t`, which owns the case, its results and the texts that are handed out. Every argument that
!> could be wrong is checked here; results are copied into arrays of the caller's. Whatever is wrong comes back as a status and
!> as findings.
module psalm_capi
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite, ieee_quiet_nan, ieee_value
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_int, c_loc, c_null_char, &
                                          c_null_ptr, c_ptr, c_size_t
   use psalm, only: analyse, analysis_t, case_t, find_rates, find_tolerances, findings_t, found_case, level_error, motion_t, &
                    new_case, observer_t, rate_study_t, read_file, read_text, search_state_t, stop_request_t, stop_t, synthesise, &
                    synthesis_t, tolerances_t, version, wp
   implicit none (type, external)
   private
   public :: psalm_version, psalm_status_text, psalm_read_file, psalm_read_text, psalm_new, psalm_free, psalm_add_loop
   public :: psalm_set_integers, psalm_set_reals, psalm_set_word, psalm_set_length, psalm_set_angle
   public :: psalm_get_length, psalm_get_angle
   public :: psalm_analyse, psalm_rates, psalm_tolerances, psalm_synthesise, psalm_found, psalm_cancel, psalm_progress
   public :: psalm_positions, psalm_components, psalm_values, psalm_listing
   public :: psalm_findings, psalm_finding_level, psalm_finding_line, psalm_finding_text

   ! statuses, as in psalm.h
   integer(c_int), parameter :: done = 0, violation = 1, bad_input = 2, misuse = 4

   ! what psalm_values copies, as in psalm.h
   integer(c_int), parameter :: what_input = 1, what_closed = 2, what_actual = 3, what_deviation = 4, what_objective = 5
   integer(c_int), parameter :: what_velocity = 6, what_jerk = 8 !! by time: orders 1 to 3
   integer(c_int), parameter :: what_rate = 9, what_rate3 = 11   !! by the input: orders 1 to 3
   integer(c_int), parameter :: what_worst_case = 12, what_rss = 13

   character(*, c_char), parameter :: nul = c_null_char
   character(*, c_char), parameter :: words = 'done'//nul// &
      'done, but constraints are violated or the search stopped early'//nul//'the input is wrong'//nul// &
      'a file could not be read, or there was not enough memory'//nul//'the call is wrong'//nul//'unknown status'//nul

   ! never changed; variables only so that they have an address
   character(len(version) + 1, c_char), target :: version_text = version//nul
   character(len(words), c_char), target :: status_words = words

   !> A text that ends as C wants it.
   type :: c_text_t
      character(kind=c_char), allocatable :: letters(:)
   end type c_text_t

   !> Whether a study is to end; another thread, or a signal handler, may say so.
   type, extends(stop_request_t) :: host_t
      integer(c_int) :: wants_end = 0
   contains
      procedure :: asked
   end type host_t

   !> How far a search is; another thread may ask.
   type, extends(observer_t) :: watch_t
      integer(c_int) :: made = 0, most = 0        !! starts or iterations
      real(c_double) :: best = 0.0_c_double       !! objective
   contains
      procedure :: report
   end type watch_t

   !> What a handle points to.
   type :: handle_t
      type(case_t) :: case
      type(host_t) :: host
      type(watch_t) :: watch
      type(stop_t) :: ending                      !! asks the host
      type(findings_t) :: findings                !! of the last call
      type(c_text_t), allocatable :: texts(:)     !! of the findings
      type(c_text_t) :: listing                   !! of the last study
      integer :: components = 0
      ! results; not allocated before their study
      type(motion_t), allocatable :: motion       !! of the study made last
      type(rate_study_t), allocatable :: rates
      type(tolerances_t), allocatable :: tolerances
      type(synthesis_t), allocatable :: synthesis
   end type handle_t

   interface
      pure integer(c_size_t) function length_of(text) bind(C, name='strlen')
         import :: c_ptr, c_size_t
         implicit none (type, external)
         type(c_ptr), value, intent(in) :: text
      end function length_of
   end interface

contains

   ! ---- texts -------------------------------------------------------------------------------------------------------

   !> Version of the library; never freed.
   type(c_ptr) function psalm_version() bind(C)
      psalm_version = c_loc(version_text(1:1))
   end function psalm_version

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
      handle%listing = as_c('')
   end function new_handle

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
      call own%case%add_loop(integers_at(ilink, arcs), integers_at(iloop, arcs), lengths, angles)
      psalm_add_loop = done
   end function psalm_add_loop

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

   integer(c_int) function psalm_analyse(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own
      type(analysis_t) :: analysis
      type(findings_t) :: findings
      character(:), allocatable :: listing

      psalm_analyse = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      call forget_results(own)
      call analyse(own%case, analysis, findings, listing=listing)
      psalm_analyse = concluded(own, findings, analysis%is_violating())
      if (.not. findings%failed()) call keep(own, analysis%motion, listing)
   end function psalm_analyse

   integer(c_int) function psalm_rates(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own
      type(rate_study_t) :: rates
      type(findings_t) :: findings
      character(:), allocatable :: listing

      psalm_rates = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      call forget_results(own)
      call find_rates(own%case, rates, findings, listing)
      psalm_rates = concluded(own, findings, rates%is_violating())
      if (findings%failed()) return
      call keep(own, rates%motion, listing)
      own%rates = rates
   end function psalm_rates

   integer(c_int) function psalm_tolerances(handle, threads) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: threads
      type(handle_t), pointer :: own
      type(tolerances_t) :: tolerances
      type(findings_t) :: findings

      psalm_tolerances = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      call forget_results(own)
      call begin_watch(own)
      call find_tolerances(own%case, tolerances, findings, int(threads), stop=own%ending)
      psalm_tolerances = concluded(own, findings, tolerances%is_violating() .or. .not. tolerances%closes)
      if (findings%failed() .or. .not. tolerances%closes) return
      call keep(own, tolerances%linear%nominal, '')
      own%tolerances = tolerances
   end function psalm_tolerances

   integer(c_int) function psalm_synthesise(handle, threads) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: threads
      type(handle_t), pointer :: own
      type(synthesis_t), allocatable :: synthesis
      type(findings_t) :: findings

      psalm_synthesise = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      call forget_results(own)
      allocate (synthesis)
      call begin_watch(own)
      call synthesise(own%case, synthesis, findings, int(threads), stop=own%ending, monitor=own%watch)
      psalm_synthesise = concluded(own, findings, synthesis%is_short())
      if (.not. findings%failed()) call move_alloc(synthesis, own%synthesis)
   end function psalm_synthesise

   integer(c_int) function psalm_found(handle, rank, made) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: rank
      type(c_ptr), value, intent(in) :: made
      type(handle_t), pointer :: own, found
      integer :: most

      psalm_found = misuse
      if (.not. c_associated(made)) return
      call hand_over(made, c_null_ptr)
      own => handle_of(handle)
      if (.not. associated(own)) return
      most = 0
      if (allocated(own%synthesis)) then
         most = size(own%synthesis%found%best)
         if (allocated(own%synthesis%last%v)) most = 1
      end if
      if (rank < 1 .or. rank > most) then
         psalm_found = wrong(own, 'psalm_found: no search was made, or it found no linkage of this rank')
         return
      end if
      found => new_handle()
      found%case = found_case(own%case, own%synthesis, int(rank))
      call hand_over(made, c_loc(found))
      psalm_found = done
   end function psalm_found

   !> Before a study that can be ended: nobody has asked yet.
   subroutine begin_watch(own)
      type(handle_t), intent(inout), target :: own

      !$omp atomic write
      own%host%wants_end = 0
      !$omp atomic write
      own%watch%made = 0
      !$omp atomic write
      own%watch%most = 0
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
      integer(c_int) :: number
      real(c_double) :: objective

      psalm_progress = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      if (c_associated(made)) then
         !$omp atomic read
         number = own%watch%made
         call put_integer(number, made)
      end if
      if (c_associated(most)) then
         !$omp atomic read
         number = own%watch%most
         call put_integer(number, most)
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

   subroutine forget_results(handle)
      type(handle_t), intent(inout) :: handle

      if (allocated(handle%motion)) deallocate (handle%motion)
      if (allocated(handle%rates)) deallocate (handle%rates)
      if (allocated(handle%tolerances)) deallocate (handle%tolerances)
      if (allocated(handle%synthesis)) deallocate (handle%synthesis)
      handle%components = 0
      handle%listing = as_c('')
   end subroutine forget_results

   !> Keep what every study has.
   subroutine keep(handle, motion, listing)
      type(handle_t), intent(inout) :: handle
      type(motion_t), intent(in) :: motion
      character(*), intent(in) :: listing

      handle%motion = motion
      handle%components = size(motion%actual, 2)
      handle%listing = as_c(listing)
   end subroutine keep

   ! ---- results -----------------------------------------------------------------------------------------------------

   integer(c_int) function psalm_positions(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own

      psalm_positions = 0
      own => handle_of(handle)
      if (.not. associated(own)) return
      if (allocated(own%motion)) psalm_positions = size(own%motion%input, kind=c_int)
   end function psalm_positions

   integer(c_int) function psalm_components(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own

      psalm_components = 0
      own => handle_of(handle)
      if (associated(own)) psalm_components = int(own%components, c_int)
   end function psalm_components

   integer(c_int) function psalm_values(handle, what, count, values) bind(C)
      type(c_ptr), value, intent(in) :: handle
      integer(c_int), value, intent(in) :: what, count
      type(c_ptr), value, intent(in) :: values
      type(handle_t), pointer :: own
      real(wp), allocatable :: result(:)
      character(80) :: text

      psalm_values = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      call collect(own, what, result)
      if (.not. allocated(result)) then
         psalm_values = wrong(own, 'psalm_values: there is no such result, or its study was not made')
      else if (count /= size(result)) then
         write (text, '(a,i0,a,i0)') 'psalm_values: the result has ', size(result), ' values; count is ', count
         psalm_values = wrong(own, trim(text))
      else if (.not. c_associated(values)) then
         psalm_values = wrong(own, 'psalm_values: values must not be NULL')
      else
         call put_reals(result, values)
         psalm_values = done
      end if
   end function psalm_values

   !> Values of a result, position by position; not allocated if there is none.
   subroutine collect(own, what, result)
      type(handle_t), intent(in) :: own
      integer(c_int), intent(in) :: what
      real(wp), allocatable, intent(out) :: result(:)

      if (.not. allocated(own%motion)) return
      associate (motion => own%motion)
         select case (what)
         case (what_input)
            result = motion%input
         case (what_closed)
            result = merge(1.0_wp, 0.0_wp, motion%closed)
         case (what_actual)
            result = by_position(motion%actual, motion%closed)
         case (what_deviation)
            result = by_position(motion%error, motion%closed)
         case (what_objective)
            result = [motion%total]
         case (what_velocity:what_jerk)
            if (allocated(own%rates)) result = of_order(own%rates%by_time, int(what - what_velocity) + 1)
         case (what_rate:what_rate3)
            if (allocated(own%rates)) result = of_order(own%rates%by_input, int(what - what_rate) + 1)
         case (what_worst_case)
            if (allocated(own%tolerances)) result = by_position(own%tolerances%linear%worst, .not. own%tolerances%linear%dead)
         case (what_rss)
            if (allocated(own%tolerances)) result = by_position(own%tolerances%linear%square, .not. own%tolerances%linear%dead)
         case default
            return
         end select
      end associate

   contains

      !> Derivatives of one order; the shape of `rates` is (order, components, positions).
      function of_order(rates, order) result(values)
         real(wp), intent(in) :: rates(:, :, :)
         integer, intent(in) :: order
         real(wp), allocatable :: values(:)

         values = by_position(transpose(rates(order, :, :)), own%motion%closed .and. own%rates%dead == 0)
      end function of_order
   end subroutine collect

   !> An array of the shape (positions, components) position by position; NaN where it is not determined.
   pure function by_position(array, known) result(values)
      real(wp), intent(in) :: array(:, :)
      logical, intent(in) :: known(:)     !! shape (positions)
      real(wp) :: values(size(array))
      integer :: i, n

      n = size(array, 2)
      do i = 1, size(array, 1)
         values((i - 1)*n + 1:i*n) = merge(array(i, :), ieee_value(1.0_wp, ieee_quiet_nan), known(i))
      end do
   end function by_position

   type(c_ptr) function psalm_listing(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own

      psalm_listing = c_null_ptr
      own => handle_of(handle)
      if (associated(own)) psalm_listing = c_loc(own%listing%letters)
   end function psalm_listing

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
      psalm_finding_level = merge(2_c_int, 1_c_int, own%findings%list(number)%level == level_error)
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
