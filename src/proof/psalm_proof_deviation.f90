!> How far the outputs of a linkage go while its dimensions deviate within their tolerances, at one position, enclosed.
!>
!> Every loop is a sum of arcs l exp(i phi) that is 0. Directions and lengths are polynomials of degree 2 in the deviations d, with
!> a bound of what these leave out: x = x0 + L d + d'Q d + z. L and Q follow from the matrix F of the loops, and what is left of
!> every loop is bounded term by term, since |exp(i a) - 1 - i a + a**2/2| <= |a|**3/6. If the map z -> -C (what is left), C the
!> inverse of F, takes a box into its inside, every linkage within the tolerances closes, in the assembly of the nominal one.
!> Rounding errors are bounded by `rounding` times the sizes of what is added. Derivation: `doc/theory/tolerances.md`.
module psalm_proof_deviation
   use psalm_dense, only: factors_t, factorise, solve
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_linear, only: along_columns, product_of
   use psalm_moving_joints, only: sketch_motion_t
   use psalm_observable, only: observable_t
   use psalm_output_kind, only: motion_distance
   use psalm_parameters, only: variable_crnki, variable_origlk, variable_origng, variable_outang, variable_outlk
   use psalm_plan, only: origin, step_point
   use psalm_sensitivity, only: sensitivity_t, unit_of
   use psalm_sketch, only: sketch_output_t, columns_of, output_point, output_angle, output_distance, output_slide, output_between, &
                           output_pose, output_x, output_y
   implicit none (type, external)
   private
   public :: deviation_model_t, enclosure_t, make_deviation_model, enclose_unknowns, enclose_number

   real(wp), parameter :: rounding = 64.0_wp*epsilon(1.0_wp)
   real(wp), parameter :: widening = 1.5_wp       !! of the box from one trial to the next
   real(wp), parameter :: inside = 0.99_wp        !! part of the box that its image is to fill at most
   integer, parameter :: most_trials = 60
   integer, parameter :: narrowings = 8           !! of the box by its image
   real(wp), parameter :: farthest = 1.0_wp       !! radians, or parts of the longest arc: larger boxes are not tried

   integer, parameter :: form_none = 0, form_x = 1, form_y = 2, form_turn = 3, form_slide = 4, form_direction = 5, &
                         form_distance = 6, form_between = 7

   !> An arc in a sum: its length and its direction change with the deviations.
   type :: arc_term_t
      complex(wp) :: direction = (1.0_wp, 0.0_wp)    !! sense included
      real(wp) :: length = 0.0_wp
      real(wp), allocatable :: turn(:), grow(:)      !! shape (columns): their changes
      integer :: angle = 0, slide = 0                !! unknowns that take part in them, 0: none
   end type arc_term_t

   !> A sum of arcs, to second order.
   type :: vector_t
      type(arc_term_t), allocatable :: terms(:)
      complex(wp) :: value = (0.0_wp, 0.0_wp)
      complex(wp), allocatable :: first(:), second(:, :)
   end type vector_t

   !> A number of an output: scale times what `form` says.
   type :: number_t
      integer :: form = form_none
      real(wp) :: scale = 1.0_wp
      integer :: unknown = 0                         !! that it is, but for `first`
      type(vector_t) :: line, other
      real(wp), allocatable :: first(:), second(:, :) !! in its unit
   end type number_t

   !> The linkage at a position. Columns are the variables, then distance and angle of each joint that stands off the arcs.
   type :: deviation_model_t
      private
      logical, public :: regular = .false.           !! else nothing can be said
      integer :: columns = 0, unknowns = 0
      real(wp) :: size = 0.0_wp                      !! longest arc
      logical, allocatable :: is_angle(:)            !! shape (unknowns)
      type(vector_t), allocatable :: rings(:)
      real(wp), allocatable :: ties(:)               !! shape (ties): sizes of what is added, for rounding errors
      real(wp), allocatable :: inverse(:, :)         !! shape (unknowns, equations): amounts
      real(wp), allocatable :: defect(:, :)          !! shape (unknowns, unknowns): amounts of 1 - C F
      real(wp), allocatable :: first(:, :)           !! shape (unknowns, columns)
      real(wp), allocatable :: second(:, :, :)       !! shape (columns, columns, unknowns)
      type(number_t), allocatable :: numbers(:)
   end type deviation_model_t

   !> The box that unknowns stay in for certain tolerances.
   type :: enclosure_t
      logical :: holds = .false.                     !! it was found
      real(wp), allocatable :: tolerance(:)          !! shape (columns)
      real(wp), allocatable :: first(:), second(:), left(:) !! shape (unknowns): bounds of the parts
   end type enclosure_t

contains

   !> The model at a position of the block just solved; numbers are those of the first output, or of all outputs of a sketch.
   subroutine make_deviation_model(problem, work, position, columns, model, sketch, outputs, own_column)
      type(problem_t), intent(in) :: problem
      type(sensitivity_t), intent(in) :: work        !! which arcs each variable changes
      integer, intent(in) :: position                !! of the block
      integer, intent(in) :: columns                 !! the variables, and those of joints that stand off the arcs
      type(deviation_model_t), intent(out) :: model
      type(sketch_motion_t), intent(in), optional :: sketch
      type(sketch_output_t), intent(in), optional :: outputs(:)
      integer, intent(in), optional :: own_column(:, :) !! shape (2, moving joints): columns of the distance and the angle of those
                                                     !! that stand off the arcs, 0: none
      real(wp), allocatable :: known(:, :)           ! shape (rows of the store, columns)
      integer, allocatable :: unknown_of(:)          ! by row
      real(wp), allocatable :: matrix(:, :), right(:, :)
      type(vector_t), allocatable :: joint(:)
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
      integer :: rows, nvar, v, k, n, equations

      nvar = size(problem%parameters%variables)
      model%columns = columns
      rows = size(problem%linkage%store%v, 2)
      allocate (known(0:rows, model%columns), source=0.0_wp)
      allocate (unknown_of(0:rows), source=0)
      call find_unknowns()
      call find_known()
      call make_rings()
      call solve_loops()
      if (.not. model%regular) return
      call make_numbers()

   contains

      !> Rows of the store that the groups find.
      subroutine find_unknowns()
         integer :: j

         allocate (model%is_angle(0))
         do k = 1, size(problem%linkage%steps)
            if (problem%plan%steps(k)%kind == step_point) cycle
            associate (dyad => problem%linkage%steps(k)%dyad)
               if (allocated(dyad%higher)) then
                  do j = 1, dyad%higher%unknowns
                     call add(dyad%higher%row(j))
                  end do
               else
                  call add(dyad%unknown(1))
                  call add(dyad%unknown(2))
               end if
            end associate
         end do
         model%unknowns = size(model%is_angle)
      end subroutine find_unknowns

      subroutine add(row)
         integer, intent(in) :: row

         if (row == 0) return
         if (unknown_of(row) > 0) return
         model%is_angle = [model%is_angle, any(problem%linkage%root_x == row)]
         unknown_of(row) = size(model%is_angle)
      end subroutine add

      !> Changes of what drives put in place.
      subroutine find_known()
         associate (link => problem%linkage)
            do v = 1, nvar
               if (problem%parameters%variables(v)%kind == variable_crnki) &
                  known(link%input_row, v) = known(link%input_row, v) + link%input_rate*unit_of(problem, v)
               do k = 1, size(link%driven_arc)
                  known(link%driven_row(k), v) = known(link%driven_row(k), v) + work%stretch(link%driven_arc(k), v)*link%scale
               end do
            end do
         end associate
         known(0, :) = 0.0_wp
      end subroutine find_known

      !> The sums that are 0: all arcs of a dyad's loop, of a larger group those of each ring.
      subroutine make_rings()
         type(vector_t) :: ring
         integer :: loop, r

         allocate (model%rings(0))
         do k = 1, size(problem%plan%steps)
            if (problem%plan%steps(k)%kind == step_point) cycle
            loop = problem%plan%steps(k)%loop
            associate (own => problem%mechanism%loops(loop))
               if (allocated(own%rings)) then
                  do r = 1, size(own%rings)
                     if (.not. own%rings(r)%closed) cycle
                     ring = sum_of([(n, n=own%rings(r)%first, own%rings(r)%last)])
                     model%rings = [model%rings, ring]
                  end do
               else
                  ring = sum_of([(n, n=own%first, own%first + own%arcs - 1)])
                  model%rings = [model%rings, ring]
               end if
            end associate
         end do
      end subroutine make_rings

      !> Arcs by their numbers, negative ones against their sense; what goes there and back again is left out.
      function sum_of(arcs) result(vector)
         integer, intent(in) :: arcs(:)
         type(vector_t) :: vector
         logical :: kept(size(arcs))
         integer :: m, there

         kept = .true.
         do m = 1, size(arcs)
            if (.not. kept(m)) cycle
            there = findloc(kept(m + 1:) .and. arcs(m + 1:) == -arcs(m), .true., dim=1)
            if (there == 0) cycle
            kept([m, m + there]) = .false.
         end do
         allocate (vector%terms(count(kept)))
         there = 0
         do m = 1, size(arcs)
            if (.not. kept(m)) cycle
            there = there + 1
            vector%terms(there) = term_of(abs(arcs(m)), sign(1.0_wp, real(arcs(m), wp)))
         end do
      end function sum_of

      !> An arc with its changes but those of unknowns.
      function term_of(arc, sense) result(term)
         integer, intent(in) :: arc
         real(wp), intent(in) :: sense
         type(arc_term_t) :: term
         integer :: root, slot

         associate (link => problem%linkage, plan => problem%plan, at => problem%linkage%store%v)
            root = plan%root(arc)
            term%direction = sense*cmplx(link%x(arc), link%y(arc), wp)* &
                             cmplx(at(position, link%root_x(root)), at(position, link%root_y(root)), wp)
            term%angle = unknown_of(link%root_x(root))
            term%turn = known(link%root_x(root), :)
            allocate (term%grow(model%columns), source=0.0_wp)
            slot = 0
            if (plan%length_slot(arc) > 0) slot = link%slide(plan%length_slot(arc))
            if (slot > 0) then
               term%length = at(position, slot)
               term%slide = unknown_of(slot)
               term%grow = known(slot, :)
            else
               term%length = link%length(arc)
               term%grow(:nvar) = work%stretch(arc, :)*link%scale
            end if
            do v = 1, nvar
               term%turn(v) = term%turn(v) + work%turn(arc, v)*unit_of(problem, v)
            end do
         end associate
      end function term_of

      !> Changes of the unknowns to first and second order.
      subroutine solve_loops()
         type(factors_t) :: factors
         real(wp), allocatable :: inverse(:, :), unit(:)
         complex(wp), allocatable :: second(:, :, :)
         integer :: r, m, ties, tie_row, j, first_angle

         ties = 0
         do k = 1, size(problem%linkage%steps)
            if (allocated(problem%linkage%steps(k)%dyad%higher)) ties = ties + size(problem%linkage%steps(k)%dyad%higher%ties)
         end do
         equations = 2*size(model%rings) + ties
         if (equations /= model%unknowns .or. equations == 0) return
         allocate (matrix(equations, model%unknowns), right(equations, model%columns), source=0.0_wp)
         allocate (model%ties(ties), source=0.0_wp)
         do r = 1, size(model%rings)
            do m = 1, size(model%rings(r)%terms)
               associate (term => model%rings(r)%terms(m))
                  model%size = max(model%size, abs(term%length))
                  if (term%angle > 0) call add_complex(matrix(2*r - 1:2*r, term%angle), i*term%length*term%direction)
                  if (term%slide > 0) call add_complex(matrix(2*r - 1:2*r, term%slide), term%direction)
                  do v = 1, model%columns
                     call add_complex(right(2*r - 1:2*r, v), term%direction*cmplx(term%grow(v), term%length*term%turn(v), wp))
                  end do
               end associate
            end do
         end do
         tie_row = 2*size(model%rings)
         do k = 1, size(problem%linkage%steps)
            if (.not. allocated(problem%linkage%steps(k)%dyad%higher)) cycle
            associate (all => problem%linkage%steps(k)%dyad%higher%ties)
               do j = 1, size(all)
                  tie_row = tie_row + 1
                  do m = 1, size(all(j)%roots)
                     if (all(j)%roots(m) == 0) cycle
                     first_angle = unknown_of(all(j)%roots(m))
                     if (first_angle > 0) matrix(tie_row, first_angle) = matrix(tie_row, first_angle) + all(j)%factors(m)
                     right(tie_row, :) = right(tie_row, :) + all(j)%factors(m)*known(all(j)%roots(m), :)
                  end do
                  right(tie_row, :) = right(tie_row, :) - known(all(j)%drive_root, :)
                  model%ties(tie_row - 2*size(model%rings)) = sum(abs(all(j)%factors))
               end do
            end associate
         end do
         call factorise(matrix, factors)
         if (any(.not. abs(factors%diagonal) > 0.0_wp)) return
         allocate (inverse(model%unknowns, equations), unit(equations))
         do r = 1, equations
            unit = 0.0_wp
            unit(r) = 1.0_wp
            inverse(:, r) = solve(factors, unit)
         end do
         if (.not. all(abs(inverse) < huge(1.0_wp))) return
         model%inverse = abs(inverse)
         model%defect = abs(product_of(inverse, matrix))
         do r = 1, model%unknowns
            model%defect(r, r) = abs(dot_product(inverse(r, :), matrix(:, r)) - 1.0_wp)
         end do
         model%defect = model%defect + rounding*product_of(model%inverse, abs(matrix))
         model%first = -product_of(inverse, right)
         do r = 1, size(model%rings)
            call complete(model%rings(r), with_unknowns=.false.)
         end do
         allocate (second(model%columns, model%columns, size(model%rings)))
         do r = 1, size(model%rings)
            second(:, :, r) = model%rings(r)%second
         end do
         allocate (model%second(model%columns, model%columns, model%unknowns), source=0.0_wp)
         do j = 1, model%unknowns
            do r = 1, size(model%rings)
               model%second(:, :, j) = model%second(:, :, j) - inverse(j, 2*r - 1)*second(:, :, r)%re &
                                       - inverse(j, 2*r)*second(:, :, r)%im
            end do
         end do
         model%regular = .true.
      end subroutine solve_loops

      !> Add a complex number to a pair of real ones.
      subroutine add_complex(pair, z)
         real(wp), intent(inout) :: pair(:)
         complex(wp), intent(in) :: z

         pair = pair + [z%re, z%im]
      end subroutine add_complex

      !> Put the changes of unknowns into the terms of a sum, and add the sum up.
      subroutine complete(vector, with_unknowns)
         type(vector_t), intent(inout) :: vector
         logical, intent(in) :: with_unknowns        !! their second order, too: it is known
         complex(wp) :: e
         integer :: m, c

         allocate (vector%first(model%columns), vector%second(model%columns, model%columns), source=(0.0_wp, 0.0_wp))
         do m = 1, size(vector%terms)
            associate (term => vector%terms(m))
               if (term%angle > 0) term%turn = term%turn + model%first(term%angle, :)
               if (term%slide > 0) term%grow = term%grow + model%first(term%slide, :)
               e = term%direction
               vector%value = vector%value + e*term%length
               vector%first = vector%first + e*cmplx(term%grow, term%length*term%turn, wp)
               do c = 1, model%columns
                  vector%second(:, c) = vector%second(:, c) + e*cmplx(-0.5_wp*term%length*term%turn*term%turn(c), &
                                                              0.5_wp*(term%grow*term%turn(c) + term%turn*term%grow(c)), wp)
               end do
               if (.not. with_unknowns) cycle
               if (term%angle > 0) vector%second = vector%second + i*term%length*e*model%second(:, :, term%angle)
               if (term%slide > 0) vector%second = vector%second + e*model%second(:, :, term%slide)
            end associate
         end do
      end subroutine complete

      ! ---- outputs --------------------------------------------------------------------------------------------------

      subroutine make_numbers()
         type(number_t) :: number
         integer :: c

         if (.not. present(sketch)) then
            allocate (model%numbers(0))
            do c = 1, problem%output%kind%components
               number = number_of_output(problem%output, c)
               call finish(number)
               model%numbers = [model%numbers, number]
            end do
            return
         end if
         call place_joints()
         allocate (model%numbers(0))
         do k = 1, size(outputs)
            do c = 1, columns_of(outputs(k))
               number = number_of_sketch(outputs(k), c)
               call finish(number)
               model%numbers = [model%numbers, number]
            end do
         end do
      end subroutine make_numbers

      !> Arcs that lead from the input pivot to a point of the plan, signed.
      function path_to(point) result(arcs)
         integer, intent(in) :: point
         integer, allocatable :: arcs(:)
         integer :: at, step

         allocate (arcs(0))
         at = point
         do while (at /= origin)
            do step = 1, size(problem%plan%steps)
               if (problem%plan%steps(step)%kind == step_point .and. problem%plan%steps(step)%to == at) exit
            end do
            if (step > size(problem%plan%steps)) return
            arcs = [problem%plan%steps(step)%sense*problem%plan%steps(step)%arc, arcs]
            at = problem%plan%steps(step)%from
         end do
      end function path_to

      !> The input pivot as an arc from the origin.
      function pivot_term() result(term)
         type(arc_term_t) :: term

         associate (output => problem%output)
            term%direction = cmplx(output%origin_c, output%origin_s, wp)
            term%length = problem%linkage%scale*(output%origin_x*output%origin_c + output%origin_y*output%origin_s)
         end associate
         allocate (term%turn(model%columns), term%grow(model%columns), source=0.0_wp)
         do v = 1, nvar
            if (problem%parameters%variables(v)%kind == variable_origlk) term%grow(v) = problem%linkage%scale
            if (problem%parameters%variables(v)%kind == variable_origng) term%turn(v) = unit_of(problem, v)
         end do
      end function pivot_term

      !> A component of the first output of loops.
      function number_of_output(output, component) result(number)
         type(observable_t), intent(in) :: output
         integer, intent(in) :: component
         type(number_t) :: number
         type(arc_term_t) :: arm, pivot

         if (component == output%kind%angle) then
            number%form = form_turn
            number%scale = degrees_per_radian
            number%unknown = unknown_of(output%root_x)
            arm = arm_of(output)
            number%first = arm%turn
            return
         end if
         number%scale = 1.0_wp/problem%linkage%scale
         if (output%slide > 0) then
            number%form = form_slide
            number%unknown = unknown_of(output%slide)
            number%first = known(output%slide, :)
            return
         end if
         number%form = merge(form_x, form_y, component == 1)
         if (output%motion == motion_distance) number%form = form_distance
         number%line = sum_of(path_to(problem%plan%output_point))
         ! variables: what an array constructor takes from a function's result stays in use with gfortran
         pivot = pivot_term()
         arm = arm_of(output)
         number%line%terms = [pivot, number%line%terms, arm]
      end function number_of_output

      !> The output arc.
      function arm_of(output) result(term)
         type(observable_t), intent(in) :: output
         type(arc_term_t) :: term

         term = term_of(output%arc, 1.0_wp)
         term%direction = cmplx(output%c, output%s, wp)*cmplx(problem%linkage%store%v(position, output%root_x), &
                                                              problem%linkage%store%v(position, output%root_y), wp)
         term%length = output%length*problem%linkage%scale
         term%slide = 0
         term%grow = 0.0_wp
         do v = 1, nvar
            if (problem%parameters%variables(v)%kind == variable_outlk) term%grow(v) = problem%linkage%scale
            if (problem%parameters%variables(v)%kind == variable_outang) term%turn(v) = term%turn(v) + unit_of(problem, v)
         end do
      end function arm_of

      !> Where the joints of a sketch are: those that do not move have no terms.
      subroutine place_joints()
         integer :: m
         type(arc_term_t) :: offset, pivot

         pivot = pivot_term()
         allocate (joint(size(sketch%drawn)))
         do m = 1, size(joint)
            allocate (joint(m)%terms(0))
         end do
         do m = 1, size(sketch%moving)
            associate (one => sketch%moving(m), to => joint(sketch%moving(m)%joint))
               to = sum_of(path_to(problem%plan%joint_points(m)))
               to%terms = [pivot, to%terms]
               if (.not. abs(one%offset) > 0.0_wp) cycle
               offset = term_of(one%arc, 1.0_wp)
               offset%direction = offset%direction*one%offset/abs(one%offset)
               offset%length = abs(one%offset)*problem%linkage%scale
               offset%slide = 0
               offset%grow = 0.0_wp
               if (own_column(1, m) > 0) offset%grow(own_column(1, m)) = problem%linkage%scale
               if (own_column(2, m) > 0) offset%turn(own_column(2, m)) = offset%turn(own_column(2, m)) + 1.0_wp/degrees_per_radian
               to%terms = [to%terms, offset]
            end associate
         end do
      end subroutine place_joints

      !> A component of an output of a sketch.
      function number_of_sketch(output, component) result(number)
         type(sketch_output_t), intent(in) :: output
         integer, intent(in) :: component
         type(number_t) :: number

         number%scale = 1.0_wp/problem%linkage%scale
         select case (output%kind)
         case (output_point, output_pose)
            number%form = merge(form_x, form_y, component == 1)
            number%line = joint(output%joints(1))
            if (component == 3) then
               number%form = form_direction
               number%scale = degrees_per_radian
               call take_arc(output%joints(2:3), number)
               if (number%form == form_turn) return
               number%line = line_of(output%joints(2), output%joints(3))
            end if
         case (output_x, output_y)
            number%form = merge(form_x, form_y, output%kind == output_x)
            number%line = joint(output%joints(1))
         case (output_angle, output_between)
            number%form = merge(form_direction, form_between, output%kind == output_angle)
            number%scale = degrees_per_radian
            if (output%kind == output_angle) call take_arc(output%joints(1:2), number)
            if (number%form == form_turn) return
            number%line = line_of(output%joints(1), output%joints(2))
            if (output%kind == output_between) number%other = line_of(output%joints(3), output%joints(4))
         case (output_distance)
            number%form = form_distance
            if (output%joints(2) > 0) then
               number%line = line_of(output%joints(1), output%joints(2))
            else
               number%line = joint(output%joints(1))
            end if
         case (output_slide)
            if (sketch%arcs(output%slide) == 0) return
            number%form = form_slide
            associate (row => problem%linkage%slide(problem%plan%length_slot(sketch%arcs(output%slide))))
               number%unknown = unknown_of(row)
               number%first = known(row, :)
            end associate
            number%scale = sketch%sense(output%slide)/problem%linkage%scale
         case default
            number%form = form_none                  ! a ratio of rates
         end select
      end function number_of_sketch

      !> The direction of a line that is an arc of the loops is that of the arc: nothing is left out of it.
      subroutine take_arc(ends, number)
         integer, intent(in) :: ends(2)              !! joints of the sketch
         type(number_t), intent(inout) :: number
         type(arc_term_t) :: arc

         do n = 1, size(problem%mechanism%arcs)
            associate (own => problem%mechanism%arcs(n))
               if (.not. own%attached .or. own%rail > 0 .or. own%leads_nowhere) cycle
               if (.not. (all(own%joints == ends) .or. all(own%joints == ends([2, 1])))) cycle
            end associate
            if (problem%linkage%root_x(problem%plan%root(n)) == 0) cycle
            arc = term_of(n, 1.0_wp)
            number%form = form_turn
            number%unknown = arc%angle
            number%first = arc%turn
            return
         end do
      end subroutine take_arc

      !> From one joint to another. Terms that both have in common cancel. A joint that stands still is a place without changes.
      function line_of(from, to) result(line)
         integer, intent(in) :: from, to
         type(vector_t) :: line
         type(arc_term_t), allocatable :: back(:)
         type(arc_term_t) :: still
         integer :: m, alike

         alike = 0
         do m = 1, min(size(joint(from)%terms), size(joint(to)%terms))
            if (.not. is_same(joint(from)%terms(m), joint(to)%terms(m))) exit
            alike = m
         end do
         back = joint(from)%terms(alike + 1:)
         do m = 1, size(back)
            back(m)%direction = -back(m)%direction
         end do
         line%terms = [joint(to)%terms(alike + 1:), back]
         do m = 1, 2
            associate (j => merge(from, to, m == 1))
               if (size(joint(j)%terms) > 0) cycle
               still%length = abs(sketch%drawn(j))*problem%linkage%scale
               if (.not. still%length > 0.0_wp) cycle
               still%direction = merge(-1.0_wp, 1.0_wp, m == 1)*sketch%drawn(j)/abs(sketch%drawn(j))
               still%turn = spread(0.0_wp, 1, model%columns)
               still%grow = still%turn
               line%terms = [line%terms, still]
            end associate
         end do
      end function line_of

      pure logical function is_same(a, b)
         type(arc_term_t), intent(in) :: a, b

         is_same = a%angle == b%angle .and. a%slide == b%slide .and. abs(a%length - b%length) <= 0.0_wp .and. &
                     abs(a%direction - b%direction) <= 0.0_wp .and. all(abs(a%turn - b%turn) <= 0.0_wp) .and. &
                     all(abs(a%grow - b%grow) <= 0.0_wp)
      end function is_same

      !> Both orders of a number.
      subroutine finish(number)
         type(number_t), intent(inout) :: number
         complex(wp), allocatable :: l(:), q(:, :)

         if (allocated(number%line%terms)) call complete(number%line, with_unknowns=.true.)
         if (allocated(number%other%terms)) call complete(number%other, with_unknowns=.true.)
         select case (number%form)
         case (form_x)
            number%first = number%scale*number%line%first%re
            number%second = number%scale*number%line%second%re
         case (form_y)
            number%first = number%scale*number%line%first%im
            number%second = number%scale*number%line%second%im
         case (form_turn, form_slide)
            allocate (number%second(model%columns, model%columns), source=0.0_wp)
            if (number%unknown > 0) then
               number%first = number%first + model%first(number%unknown, :)
               number%second = model%second(:, :, number%unknown)
            end if
            number%first = number%scale*number%first
            number%second = number%scale*number%second
         case (form_direction, form_between, form_distance)
            call relative(number%line, l, q)
            if (number%form == form_distance) then
               number%first = number%scale*abs(number%line%value)*l%re
               number%second = number%scale*abs(number%line%value)*(q%re + 0.5_wp*outer(l%im, l%im))
               return
            end if
            number%first = l%im
            number%second = q%im - 0.5_wp*(outer(l%re, l%im) + outer(l%im, l%re))
            if (number%form == form_between) then
               number%first = -number%first
               number%second = -number%second
               call relative(number%other, l, q)
               number%first = number%first + l%im
               number%second = number%second + q%im - 0.5_wp*(outer(l%re, l%im) + outer(l%im, l%re))
            end if
            number%first = number%scale*number%first
            number%second = number%scale*number%second
         end select
      end subroutine finish

      !> A sum less its value, in parts of its value.
      pure subroutine relative(vector, l, q)
         type(vector_t), intent(in) :: vector
         complex(wp), allocatable, intent(out) :: l(:), q(:, :)
         complex(wp) :: by

         by = (0.0_wp, 0.0_wp)
         if (abs(vector%value) > 0.0_wp) by = 1.0_wp/vector%value
         l = vector%first*by
         q = vector%second*by
      end subroutine relative
   end subroutine make_deviation_model

   pure function outer(a, b) result(product)
      real(wp), intent(in) :: a(:), b(:)
      real(wp) :: product(size(a), size(b))

      product = spread(a, 2, size(b))*spread(b, 1, size(a))
   end function outer

   ! ---- bounds --------------------------------------------------------------------------------------------------------

   !> Bounds of the unknowns for given tolerances.
   pure subroutine enclose_unknowns(model, tolerance, enclosure)
      type(deviation_model_t), intent(in) :: model
      real(wp), intent(in) :: tolerance(:)           !! shape (columns)
      type(enclosure_t), intent(out) :: enclosure
      real(wp), allocatable :: image(:)
      integer :: k, trial

      if (.not. model%regular) return
      enclosure%tolerance = tolerance
      enclosure%first = along_columns(transpose(abs(model%first)), tolerance)
      allocate (enclosure%second(model%unknowns), enclosure%left(model%unknowns), source=0.0_wp)
      do k = 1, model%unknowns
         enclosure%second(k) = dot_product(tolerance, along_columns(abs(model%second(:, :, k)), tolerance))
      end do
      do trial = 1, most_trials
         image = image_of(model, enclosure)
         if (.not. all(merge(enclosure%left, enclosure%left/max(model%size, tiny(1.0_wp)), model%is_angle) < farthest)) return
         if (trial > 1 .and. all(image <= inside*enclosure%left)) then
            enclosure%holds = .true.
            exit
         end if
         enclosure%left = max(enclosure%left, widening*image)
      end do
      if (.not. enclosure%holds) return
      ! what lies in the box lies in its image, too
      do trial = 1, narrowings
         enclosure%left = min(enclosure%left, image_of(model, enclosure))
      end do
   end subroutine enclose_unknowns

   !> What of the unknowns both orders leave out, if it lies in the box.
   pure function image_of(model, box) result(image)
      type(deviation_model_t), intent(in) :: model
      type(enclosure_t), intent(in) :: box
      real(wp), allocatable :: image(:)              !! shape (unknowns)
      real(wp) :: left(size(model%inverse, 2)), all_first
      integer :: r, m

      left = 0.0_wp
      do r = 1, size(model%rings)
         do m = 1, size(model%rings(r)%terms)
            left(2*r - 1) = left(2*r - 1) + rest_of(model%rings(r)%terms(m), box, own=.false.)
         end do
         left(2*r) = left(2*r - 1)
      end do
      all_first = 1.0_wp + sum(box%first + box%second + box%left, model%is_angle)
      left(2*size(model%rings) + 1:) = rounding*model%ties*all_first
      image = along_columns(transpose(model%inverse), left) + &
              along_columns(transpose(model%defect), box%first + box%second + box%left)
   end function image_of

   !> Bound of what both orders leave out of an arc; with `own` what unknowns leave out to first order, too.
   pure real(wp) function rest_of(term, box, own) result(rest)
      type(arc_term_t), intent(in) :: term
      type(enclosure_t), intent(in) :: box
      logical, intent(in) :: own
      real(wp) :: p, u, a, l, length, w, y

      p = dot_product(abs(term%turn), box%tolerance)
      u = dot_product(abs(term%grow), box%tolerance)
      length = abs(term%length)
      a = p
      l = u
      w = 0.0_wp
      y = 0.0_wp
      if (term%angle > 0) then
         w = box%left(term%angle)
         a = p + box%second(term%angle) + w
      end if
      if (term%slide > 0) then
         y = box%left(term%slide)
         l = u + box%second(term%slide) + y
      end if
      rest = length*(0.5_wp*(a - p)*(a + p) + a**3/6.0_wp) + (l - u)*a + u*(a - p) + l*(0.5_wp*a**2 + a**3/6.0_wp)
      if (own) rest = rest + length*w + y
      rest = rest + rounding*(length + l)*(1.0_wp + a + a**2)
   end function rest_of

   !> Least and greatest change of a number for the tolerances of an enclosure; `known` is false if nothing can be said.
   pure subroutine enclose_number(model, number, enclosure, low, high, known)
      type(deviation_model_t), intent(in) :: model
      integer, intent(in) :: number
      type(enclosure_t), intent(in) :: enclosure
      real(wp), intent(out) :: low, high
      logical, intent(out) :: known
      real(wp) :: rest, slope(model%columns), curve(model%columns, model%columns), way(model%columns), doubtful
      logical :: bounded

      low = -huge(1.0_wp)
      high = huge(1.0_wp)
      known = .false.
      if (.not. enclosure%holds) return
      associate (own => model%numbers(number), t => enclosure%tolerance)
         select case (own%form)
         case (form_none)
            return
         case (form_x, form_y)
            rest = rest_of_vector(own%line, enclosure)*own%scale
         case (form_turn, form_slide)
            rest = 0.0_wp
            if (own%unknown > 0) rest = enclosure%left(own%unknown)*abs(own%scale)
         case (form_distance)
            call rest_of_relative(own%line, enclosure, .true., rest, bounded)
            if (.not. bounded) return
            rest = rest*abs(own%line%value)*own%scale
         case default
            call rest_of_relative(own%line, enclosure, .false., rest, bounded)
            if (.not. bounded) return
            if (own%form == form_between) then
               call rest_of_relative(own%other, enclosure, .false., doubtful, bounded)
               if (.not. bounded) return
               rest = rest + doubtful
            end if
            rest = rest*own%scale
         end select
         slope = own%first*t
         curve = own%second*outer(t, t)
         rest = rest + rounding*(sum(abs(slope)) + sum(abs(curve)))
         ! where a slope cannot change its sign within the tolerances, the end of it decides
         way = merge(sign(1.0_wp, slope), 0.0_wp, abs(slope) >= 2.0_wp*sum(abs(curve), dim=2))
         doubtful = sum(abs(curve), .not. outer(abs(way), abs(way)) > 0.0_wp)
         curve = curve*outer(way, way)
         high = sum(abs(slope)) + sum(curve) + doubtful + rest
         low = -sum(abs(slope)) + sum(curve) - doubtful - rest
      end associate
      known = .true.
   end subroutine enclose_number

   pure real(wp) function rest_of_vector(vector, box) result(rest)
      type(vector_t), intent(in) :: vector
      type(enclosure_t), intent(in) :: box
      integer :: m

      rest = 0.0_wp
      do m = 1, size(vector%terms)
         rest = rest + rest_of(vector%terms(m), box, own=.true.)
      end do
   end function rest_of_vector

   !> What both orders leave out of the direction of a sum, or of its length in parts of it. Not `bounded`: the sum may vanish.
   pure subroutine rest_of_relative(vector, box, of_length, rest, bounded)
      type(vector_t), intent(in) :: vector
      type(enclosure_t), intent(in) :: box
      logical, intent(in) :: of_length
      real(wp), intent(out) :: rest
      logical, intent(out) :: bounded
      real(wp) :: first, second, left, all_of

      rest = 0.0_wp
      bounded = abs(vector%value) > 0.0_wp
      if (.not. bounded) return
      associate (by => 1.0_wp/abs(vector%value))
         first = by*dot_product(abs(vector%first), box%tolerance)
         second = by*dot_product(box%tolerance, along_columns(abs(vector%second), box%tolerance))
         left = by*rest_of_vector(vector, box)
      end associate
      all_of = first + second + left
      bounded = all_of < 1.0_wp
      if (.not. bounded) return
      rest = left + 0.5_wp*(second + left)*(all_of + first)
      if (of_length) then
         rest = rest + 4.0_wp - 2.0_wp*all_of - 0.5_wp*all_of**2 - 4.0_wp*sqrt(1.0_wp - all_of)
      else
         ! -log(1 - a) - a - a**2/2 is the sum of a**k/k from k = 3 on, below a**3/3 times that of a**k from k = 0 on
         rest = rest + all_of**3/(3.0_wp*(1.0_wp - all_of))
      end if
      rest = rest + rounding
   end subroutine rest_of_relative
end module psalm_proof_deviation
