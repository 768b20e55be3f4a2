!> How far the output of a linkage that is searched spreads within the tolerances of its dimensions, as residuals of the objective.
!>
!> Dimension v deviates uniformly within +-t_v, independently of the others: to first order the mean of the square of an error e is
!> e**2 + sum over v of (s_v t_v)**2/3, s_v being the change of the output with v. With TOLOBJ = q the objective has residuals
!> sqrt(q/3) s_v t_v beside the errors, of the same weights; their slopes by the dimensions that vary are central differences of
!> the exact s_v. Near a dead point s_v grows without bound: deviations d = s_v t_v are taken as d/(1 + (d/c)**4)**(1/4), c a tenth
!> of the size of the linkage or of a radian, and where the linkage does not close as c. Further outputs of a sketch with desired
!> values have residuals in the same way, of the weights of these values; of joints off the lines of their links distance and angle
!> deviate by TOLLEN and TOLANG, of the one that the output arc ends at by the tolerances of that arc.
module psalm_tolerance_spread
   use psalm_angles, only: unit_vector
   use psalm_data_set, only: data_set_t
   use psalm_deviating_dimensions, only: deviating_dimensions, tolerance_of, tolerances_apart
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_joint_location, only: locate_sketch
   use psalm_kinds, only: wp, degrees_per_radian, right_angle
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t, variable_aside, variable_aside_angle
   use psalm_sensitivity, only: sensitivity_t, wanted_outputs_t, prepare_sensitivity, find_jacobian
   use psalm_sketch, only: target_column_t, first_number, output_ratio
   use psalm_sketch_outputs, only: names_of_numbers, name_length
   use psalm_solver_kind, only: family_simplex
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: tolerance_spread_t, check_spread, prepare_spread, find_spread, differentiate_spread, sum_of_spread

   real(wp), parameter :: largest_part = 0.1_wp    !! of the size of the linkage, or of a radian: no deviation is taken as larger
   real(wp), parameter :: variance = 1.0_wp/3.0_wp !! of a uniform deviation between -1 and 1
   real(wp), parameter :: beyond = 1.0e30_wp       !! parts of it that count as infinite
   real(wp), parameter :: step = 1.0e-5_wp         !! of differences: part of the size of the linkage, radians

   type :: tolerance_spread_t
      class(problem_t), allocatable :: problem     !! its variables are the dimensions with a tolerance
      type(sensitivity_t) :: work
      class(wanted_outputs_t), allocatable :: wanted !! outputs of a sketch; not allocated: the first output of the loops alone
      integer, allocatable :: number(:)            !! of the further numbers that count, in those outputs
      integer, allocatable :: aside(:)             !! joints off the lines of their links whose places vary
      integer :: shown = 0                         !! of the joints that move: the first output, if it stands off its arc; 0: none
      real(wp), allocatable :: tolerance(:)        !! shape (deviating): of the variables, then of joints off the lines
      real(wp) :: root = 0.0_wp                    !! of the weight of their squares
      real(wp), allocatable :: weight(:, :)        !! shape (positions, components): of the first output, then the further numbers
      real(wp), allocatable :: largest(:)          !! shape (components): deviations that are taken as that
      real(wp) :: size = 1.0_wp                    !! of the linkage
      real(wp), allocatable :: change(:, :, :)     !! shape (positions, deviating, components): changes of the output
      real(wp), allocatable :: miss(:, :, :)       !! the same shape: residuals
      real(wp), allocatable :: by(:, :, :, :)      !! shape (positions, columns, deviating, components): their slopes
   end type tolerance_spread_t

contains

   !> What TOLOBJ cannot be asked for with.
   subroutine check_spread(set, mechanism, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(diagnostics_t), intent(inout) :: findings

      if (.not. set%toler%in_objective > 0.0_wp .or. .not. set%wants_search()) return
      if (set%search%solver%family == family_simplex) then
         call refuse("is for searches by other solvers than SOLVER='SIMPLEX', such as 'LSQ'")
      else if (allocated(set%search_in_poses)) then
         call refuse('this search is made in the poses of the links, without tolerances')
      else if ((mechanism%outputs(1)%stands_in .or. .not. set%method%desired) .and. size(further_numbers(set)) == 0) then
         call refuse('no output, a point, an angle, a length, has desired values')
      else if (size(deviating_variables(set, mechanism)) == 0) then
         call refuse('no dimension has a tolerance above 0')
      end if

   contains

      subroutine refuse(why)
         character(*), intent(in) :: why

         call set%origins%error(findings, 'TOLER', 'TOLOBJ', why)
      end subroutine refuse
   end subroutine check_spread

   !> Which of the columns of further desired values count: those that are no derivatives or ratios.
   pure function further_numbers(set) result(list)
      type(data_set_t), intent(in) :: set
      integer, allocatable :: list(:)
      type(target_column_t), allocatable :: columns(:)
      integer :: k

      allocate (list(0))
      columns = set%sketch%target_columns()
      do k = 1, size(columns)
         if (columns(k)%order == 0 .and. set%sketch%outputs(columns(k)%output)%kind /= output_ratio) list = [list, k]
      end do
   end function further_numbers

   !> Tolerances of the dimensions that have one.
   function deviating_variables(set, mechanism) result(tolerances)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      real(wp), allocatable :: tolerances(:)
      type(parameters_t) :: parameters
      integer :: v

      parameters = deviating_dimensions(set, set%toler, mechanism)
      tolerances = [(tolerance_of(set, set%toler, parameters%variables(v)), v=1, size(parameters%variables))]
   end function deviating_variables

   !> Make the spread of a search ready.
   subroutine prepare_spread(set, problem, columns, size_of, spread, target_weights)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem       !! with inputs and weights
      integer, intent(in) :: columns               !! variables, and with free timing one more
      real(wp), intent(in) :: size_of              !! the linkage
      type(tolerance_spread_t), intent(out) :: spread
      real(wp), intent(in), optional :: target_weights(:, :) !! shape (positions, columns): of further desired values
      integer, allocatable :: list(:)
      integer :: n, c, deviating, components

      allocate (spread%problem, source=problem)
      if (allocated(spread%problem%linkages)) deallocate (spread%problem%linkages)
      spread%problem%tangle = right_angle
      spread%problem%slide_angle = right_angle
      spread%problem%spare = 0.0_wp
      spread%problem%parameters = deviating_dimensions(set, set%toler, problem%mechanism)
      spread%tolerance = deviating_variables(set, problem%mechanism)
      spread%root = sqrt(set%toler%in_objective*variance)
      deviating = size(spread%tolerance)
      call spread%problem%set_inputs(problem%delt)
      allocate (list(0))
      if (present(target_weights)) list = further_numbers(set)
      if (size(list) > 0) then
         call prepare_wanted(set, problem, list, spread)
         deviating = size(spread%tolerance)
      else
         call spread%problem%want_derivatives(.false.)
      end if
      call prepare_sensitivity(spread%problem, spread%work)
      n = problem%positions
      associate (kind => problem%output%kind)
         components = kind%components + size(list)
         allocate (spread%weight(n, components), source=0.0_wp)
         if (set%method%desired .and. .not. problem%mechanism%outputs(1)%stands_in) &
            spread%weight(:, :kind%components) = problem%weight(:n, :kind%components)
         if (size(list) > 0) spread%weight(:, kind%components + 1:) = target_weights(:n, list)
         allocate (spread%largest(components), source=largest_part*size_of)
         do c = 1, components
            if (c <= kind%components) then
               if (c == kind%angle) spread%largest(c) = largest_part*degrees_per_radian
            else if (spread%wanted%angle(spread%number(c - kind%components))) then
               spread%largest(c) = largest_part*degrees_per_radian
            end if
         end do
         allocate (spread%change(n, deviating, components), spread%miss(n, deviating, components), source=0.0_wp)
         allocate (spread%by(n, columns, deviating, components), source=0.0_wp)
      end associate
      spread%size = size_of
   end subroutine prepare_spread

   !> Further outputs of a sketch, and the joints off the lines of their links.
   subroutine prepare_wanted(set, problem, list, spread)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: list(:)               !! columns of the desired values
      type(tolerance_spread_t), intent(inout) :: spread
      type(target_column_t), allocatable :: columns(:)
      character(name_length), allocatable :: names(:)
      logical, allocatable :: turning(:)
      integer, allocatable :: apart(:)
      integer :: listed, k, v

      allocate (spread%wanted)
      call locate_sketch(set, spread%wanted%sketch, problem%given)
      spread%wanted%outputs = set%sketch%outputs
      call names_of_numbers(set%sketch%outputs, names, turning, spread%wanted%angle)
      spread%wanted%numbers = size(names)
      columns = set%sketch%target_columns()
      spread%number = [(first_number(set%sketch%outputs, columns(list(k))%output) + columns(list(k))%component - 1, &
                        k=1, size(list))]
      associate (moving => spread%wanted%sketch%moving)
         do k = 1, size(moving)
            if (moving(k)%joint == set%traced%output_joint .and. problem%given%outlk > 0.0_wp) spread%shown = k
         end do
         apart = pack(moving%joint, abs(moving%offset) > 0.0_wp)
         listed = 0
         if (spread%shown > 0) listed = findloc(apart, moving(spread%shown)%joint, dim=1)
         spread%tolerance = [spread%tolerance, tolerances_apart(set, set%toler, size(apart), listed)]
         allocate (spread%aside(0))
         do v = 1, size(problem%parameters%variables)
            associate (variable => problem%parameters%variables(v))
               if (any(variable%kind == [variable_aside, variable_aside_angle])) spread%aside = [spread%aside, variable%n]
            end associate
         end do
         call spread%problem%want_derivatives(.true., spread%wanted%sketch%points)
      end associate
   end subroutine prepare_wanted

   !> Put joints that stand off the lines of their links where the dimensions have them.
   subroutine place_joints(spread, dimensions)
      class(tolerance_spread_t), intent(inout) :: spread
      type(dimensions_t), intent(in) :: dimensions
      real(wp) :: c, s
      integer :: k, m

      associate (moving => spread%wanted%sketch%moving)
         do k = 1, size(spread%aside)
            m = findloc(moving%joint, spread%aside(k), dim=1)
            if (m == 0) cycle
            call unit_vector(dimensions%aside_angle(spread%aside(k)), c, s)
            moving(m)%offset = dimensions%aside_length(spread%aside(k))*cmplx(c, s, wp)
         end do
         if (spread%shown == 0) return
         call unit_vector(dimensions%outang, c, s)
         moving(spread%shown)%offset = dimensions%outlk*cmplx(c, s, wp)
      end associate
   end subroutine place_joints

   !> Residuals of a linkage.
   subroutine find_spread(spread, dimensions)
      class(tolerance_spread_t), intent(inout) :: spread
      type(dimensions_t), intent(in) :: dimensions

      call find_residuals(spread, dimensions, spread%miss)
   end subroutine find_spread

   subroutine find_residuals(spread, dimensions, miss)
      class(tolerance_spread_t), intent(inout) :: spread
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(out) :: miss(:, :, :)       !! shape (positions, deviating, components)
      logical :: is_open(size(miss, 1))
      real(wp) :: part
      integer :: block, offset, n, i, loop, v, c, nvar, components

      if (allocated(spread%wanted)) call place_joints(spread, dimensions)
      associate (problem => spread%problem)
         is_open = .false.
         call problem%bind(dimensions)
         do block = 1, problem%blocks()
            call problem%solve_block(block, offset, n)
            call problem%output_of(n)
            do loop = 1, problem%mechanism%nloop
               if (problem%linkage%step_of_loop(loop) == 0) cycle
               do i = 1, n
                  if (.not. problem%linkage%closes(i, loop)) is_open(offset + i) = .true.
               end do
            end do
         end do
         nvar = size(problem%parameters%variables)
         components = problem%output%kind%components
         if (allocated(spread%wanted)) then
            call find_jacobian(problem, dimensions, spread%work, spread%change(:, :nvar, :components), &
                               solved=problem%blocks() == 1, wanted=spread%wanted)
            spread%change(:, :, components + 1:) = spread%wanted%change(:, :, spread%number)
         else
            call find_jacobian(problem, dimensions, spread%work, spread%change, solved=problem%blocks() == 1)
         end if
      end associate
      do c = 1, size(miss, 3)
         do v = 1, size(miss, 2)
            do i = 1, size(miss, 1)
               miss(i, v, c) = spread%root*spread%largest(c)
               if (is_open(i)) cycle
               part = spread%tolerance(v)*spread%change(i, v, c)/spread%largest(c)
               if (.not. abs(part) < beyond) cycle
               miss(i, v, c) = part/sqrt(sqrt(1.0_wp + part**4))*spread%root*spread%largest(c)
            end do
         end do
      end do
   end subroutine find_residuals

   !> Residuals and their slopes by the variables of the search, and with free timing by the inputs.
   subroutine differentiate_spread(spread, parameters, values, dimensions)
      class(tolerance_spread_t), intent(inout) :: spread
      type(parameters_t), intent(in) :: parameters !! of the search
      real(wp), intent(in) :: values(:)            !! shape (nvar)
      type(dimensions_t), intent(in) :: dimensions !! with these values
      type(dimensions_t) :: near
      real(wp), allocatable :: moved(:), delt(:), above(:, :, :)
      real(wp) :: h
      integer :: a

      near = dimensions
      allocate (above, mold=spread%miss)
      do a = 1, size(values)
         h = step_of(spread%size, abs(values(a)))
         moved = values
         moved(a) = values(a) + h
         call parameters%apply(moved, near)
         call find_residuals(spread, near, above)
         moved(a) = values(a) - h
         call parameters%apply(moved, near)
         call find_residuals(spread, near, spread%miss)
         spread%by(:, a, :, :) = (above - spread%miss)/(2.0_wp*h)
      end do
      if (size(spread%by, 2) > size(values)) then
         delt = spread%problem%delt
         h = step_of(spread%size, 1.0_wp)
         call spread%problem%move_inputs(delt + h)
         call find_residuals(spread, dimensions, above)
         call spread%problem%move_inputs(delt - h)
         call find_residuals(spread, dimensions, spread%miss)
         spread%by(:, size(values) + 1, :, :) = (above - spread%miss)/(2.0_wp*h)
         call spread%problem%move_inputs(delt)
      end if
      call find_residuals(spread, dimensions, spread%miss)
   end subroutine differentiate_spread

   !> A step for differences by a dimension; degrees are as small as the numbers of lengths mostly are.
   pure real(wp) function step_of(size_of, value) result(h)
      real(wp), intent(in) :: size_of, value

      h = step*max(min(size_of, degrees_per_radian), value)
   end function step_of

   !> What the residuals add to the objective.
   pure real(wp) function sum_of_spread(spread) result(total)
      class(tolerance_spread_t), intent(in) :: spread
      integer :: c

      total = 0.0_wp
      do c = 1, size(spread%miss, 3)
         total = total + sum(spread%weight(:, c)*sum(spread%miss(:, :, c)**2, dim=2))
      end do
   end function sum_of_spread
end module psalm_tolerance_spread
