!> Devices 1 and 2: how a simplex was begun, how it went on, what became of each start of a search from many.
module psalm_search_log
   use psalm_columns, only: add_rows
   use psalm_data_set, only: data_set_t
   use psalm_dyad, only: violation_none
   use psalm_error, only: problem_t, violation_t
   use psalm_finale, only: describe_violation
   use psalm_kinds, only: wp
   use psalm_nlp, only: failure_t
   use psalm_number_format, only: in_sentence
   use psalm_search, only: start_record_t
   use psalm_solver, only: observer_t, search_state_t
   use psalm_start, only: beginning_t, label_width, value_width, values_per_record
   use psalm_text, only: text_t, general, to_text
   implicit none (type, external)
   private
   public :: search_log_t, begin_log, log_beginning, log_starts

   integer, parameter :: values_per_line = 5      !! coordinates of a vertex

   !> Writes the progress of the simplex, and passes on to another observer what it sees.
   type, extends(observer_t) :: search_log_t
      integer :: every = 20              !! NPRT: iterations between two lines of objectives
      integer :: every_vertex = 100      !! NPRINT: the same for coordinates
      integer :: violations = 30         !! NVIOL: more violations in an iteration are reported
      logical :: named = .false.         !! joints have names: a sketch
      class(problem_t), pointer :: problem => null() !! that is searched; not associated: no details of violations
      type(text_t) :: device1
      class(observer_t), pointer :: next => null()
      integer, private :: calls_before = 0
      integer, private :: start = 1      !! the simplex last seen
   contains
      procedure :: report
   end type search_log_t

contains

   !> A log as the data set wants it; what it sees is passed on to `next`.
   subroutine begin_log(set, problem, next, log)
      type(data_set_t), intent(in) :: set
      class(problem_t), intent(in), target :: problem      !! that is searched; must outlive the log
      class(observer_t), intent(inout), target :: next
      type(search_log_t), intent(out) :: log

      log%every = set%limits%nprt
      log%every_vertex = set%limits%nprint
      log%violations = set%limits%nviol
      log%named = set%has_names()
      log%problem => problem
      log%next => next
   end subroutine begin_log

   !> How the simplex was begun: limits and random integers.
   subroutine log_beginning(beginning, device1, device2)
      type(beginning_t), intent(in) :: beginning
      type(text_t), intent(inout) :: device1, device2
      integer :: i

      call device2%add(' LOWER LIMITS OF THE INITIAL SIMPLEX')
      call show_row(beginning%low, device2)
      call device2%add(' UPPER LIMITS OF THE INITIAL SIMPLEX')
      call show_row(beginning%high, device2)
      do i = 1, size(beginning%integer)
         if (beginning%integer(i) == 0) cycle
         call device1%add(' VERTEX '//to_text(i)//'  STARTED BY RANDOM INTEGER '//to_text(int(beginning%integer(i))))
         call device2%add(' GENERATED VERTEX '//to_text(i))
         call show_row(beginning%drawn(:, i), device2)
      end do
   end subroutine log_beginning

   !> Co-ordinates as device 4 has them.
   subroutine show_row(values, device)
      real(wp), intent(in) :: values(:)
      type(text_t), intent(inout) :: device
      character(label_width + values_per_record*value_width) :: line
      integer :: i, k

      do i = 1, size(values), values_per_record
         line = ''
         do k = i, min(i + values_per_record - 1, size(values))
            line(label_width + (k - i)*value_width + 1:label_width + (k - i + 1)*value_width) = general(values(k))
         end do
         call device%add(line)
      end do
   end subroutine show_row

   !> After an iteration of the simplex, which shows its points: violations above NVIOL, objectives every NPRT iterations,
   !> coordinates every NPRINT.
   subroutine report(self, state, points, objectives)
      class(search_log_t), intent(inout) :: self
      type(search_state_t), intent(in) :: state
      real(wp), intent(in), optional :: points(:, :)
      real(wp), intent(in), optional :: objectives(:)

      if (associated(self%next)) call self%next%report(state, points, objectives)
      if (.not. (present(points) .and. present(objectives))) return
      if (state%start /= self%start) then
         self%start = state%start
         self%calls_before = 0
         call self%device1%add(' START '//to_text(state%start))
      end if
      if (state%iteration > 0 .and. state%counts%calls - self%calls_before > self%violations) then
         call self%device1%add(' ITERATION '//to_text(state%iteration)//'  VIOLATIONS '// &
                               to_text(state%counts%calls - self%calls_before)//'  LAST IN LOOP '//to_text(state%counts%loop))
         if (associated(self%problem) .and. allocated(state%counts%failures)) &
            call add_failures(self%problem, state%counts%failures, self%device1)
      end if
      self%calls_before = state%counts%calls
      if (mod(state%iteration, self%every) == 0) then
         call self%device1%add(' ITERATION '//to_text(state%iteration)//'  BEST'//in_sentence(self%named, state%best)// &
                               '  WORST'//in_sentence(self%named, state%worst)//'  EVALUATIONS '//to_text(state%evaluations)// &
                               '  REPAIRS '//to_text(state%counts%repairs)//'  MOVES '//to_text(state%counts%moves))
      end if
      if (state%iteration > 0 .and. mod(state%iteration, self%every_vertex) == 0) then
         call self%device1%add(' CO-ORDINATES OF THE BEST VERTEX')
         call add_rows(points(:, minloc(objectives, dim=1)), values_per_line, '     ', self%device1)
         call self%device1%add(' CO-ORDINATES OF THE WORST VERTEX')
         call add_rows(points(:, maxloc(objectives, dim=1)), values_per_line, '     ', self%device1)
      end if
   end subroutine report

   !> A line for each dyad that was violated: how often, and how at worst.
   subroutine add_failures(problem, failures, device1)
      class(problem_t), intent(in) :: problem
      type(failure_t), intent(in) :: failures(:)  !! shape (loops)
      type(text_t), intent(inout) :: device1
      integer :: loop

      do loop = 1, size(failures)
         associate (failure => failures(loop))
            if (failure%times == 0) cycle
            if (failure%kind == violation_none) then
               call device1%add('   LOOP '//to_text(loop)//times(failure%times))
            else
               call device1%add('   '//describe_violation(problem, [failure%place], violation_t(kind=failure%kind, loop=loop, &
                  first=1, last=1, worst=1, amount=failure%amount), numbered=.false.)//times(failure%times))
            end if
         end associate
      end do

   contains

      pure function times(number) result(words)
         integer, intent(in) :: number
         character(:), allocatable :: words

         words = ', ONCE'
         if (number > 1) words = ', '//to_text(number)//' TIMES'
      end function times
   end subroutine add_failures

   !> A line for each start.
   subroutine log_starts(named, starts, device1)
      logical, intent(in) :: named               !! joints have names: a sketch
      type(start_record_t), intent(in) :: starts(:)
      type(text_t), intent(inout) :: device1
      character(:), allocatable :: name
      integer :: i

      do i = 1, size(starts)
         name = ' START '//to_text(starts(i)%number)
         if (starts(i)%number < 0) name = ' SUPPLIED VERTEX '//to_text(-starts(i)%number)
         if (starts(i)%feasible) then
            call device1%add(name//'  OBJECTIVE'//in_sentence(named, starts(i)%objective)//'  EVALUATIONS '// &
                             to_text(starts(i)%evaluations)//'  JACOBIANS '//to_text(starts(i)%jacobians))
         else
            call device1%add(name//'  NO LINKAGE THAT OBEYS THE CONSTRAINTS')
         end if
      end do
   end subroutine log_starts
end module psalm_search_log
