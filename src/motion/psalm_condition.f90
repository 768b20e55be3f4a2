!> Condition number of a position: by how much a relative change of epsilon in every dimension and in the input, and the
!> roundings on the way, can change the output.
!>
!> First-order bounds are carried along the plan: of each root an angle, of each point and slide a length, in units of
!> epsilon. Every link pair multiplies by 1/sin of its transmission angle, every slide by its own factor. The error of
!> `psalm` stays below 16 epsilon times this number; tests measure it against a build in quadruple precision.
!> Derivation: `doc/theory/positions.md`, Condition.
module psalm_condition
   use psalm_assur, only: bounds_of_dyad
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t
   use psalm_higher_group, only: bounds_higher
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_linkage, only: linkage_t, bound_step_t
   use psalm_plan, only: step_point, root_crank
   implicit none (type, external)
   private
   public :: condition_t, prepare_condition, condition_at

   real(wp), parameter :: worst = 1.0_wp/epsilon(1.0_wp) !! no digit is left; larger numbers say nothing more

   !> Bounds, in units of epsilon.
   type :: condition_t
      real(wp), allocatable :: row(:)      !! by row of the store: an angle's, radians, stands at the row of its cosine, a point's,
                                           !! length, at that of its x, a slide's, length, at its own
   end type condition_t

contains

   !> Allocate for a linkage.
   pure subroutine prepare_condition(linkage, condition)
      type(linkage_t), intent(in) :: linkage
      type(condition_t), intent(out) :: condition

      allocate (condition%row(size(linkage%store%v, 2)), source=0.0_wp)
   end subroutine prepare_condition

   !> Condition number of the output at position `i` of the block just solved, position `k` of all.
   subroutine condition_at(problem, i, k, condition, number)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: i, k
      type(condition_t), intent(inout) :: condition
      real(wp), intent(out) :: number
      real(wp) :: bound(2), of_group(size(condition%row))
      integer :: m

      associate (link => problem%linkage)
         condition%row = 0.0_wp
         if (link%sliding_input) then
            if (link%input_slot > 0) condition%row(link%slide(link%input_slot)) = abs(link%reference_length) + abs(problem%delt(k))
         else
            condition%row(link%root_x(root_crank)) = 1.0_wp + (abs(link%crank_angle) + abs(problem%delt(k)))*radians_per_degree
         end if
         do m = 1, size(link%steps)
            associate (step => link%steps(m))
               if (step%kind == step_point) then
                  call carry_point(link, step, i, condition%row)
               else if (allocated(step%dyad%higher)) then
                  associate (higher => step%dyad%higher)
                     call bounds_higher(higher, link%store, i, condition%row, link%angle*radians_per_degree, worst, of_group)
                     condition%row(higher%row) = of_group(:higher%unknowns)
                  end associate
               else
                  associate (dyad => step%dyad)
                     call bounds_of_dyad(dyad, link%store, i, condition%row(dyad%s_x), condition%row(dyad%e_x), &
                                         [of_arc(link, dyad%p_x, dyad%arc_p, condition%row), &
                                          of_arc(link, dyad%q_x, dyad%arc_q, condition%row)], worst, bound)
                     condition%row(dyad%unknown) = bound
                  end associate
               end if
            end associate
         end do
         number = problem%output%bound(link, condition%row, i, worst)
      end associate
   end subroutine condition_at

   !> Bound of an arc's direction, radians.
   pure real(wp) function of_arc(link, root_x, arc, row)
      type(linkage_t), intent(in) :: link
      integer, intent(in) :: root_x        !! row of the root it is turned from
      integer, intent(in) :: arc
      real(wp), intent(in) :: row(:)

      of_arc = row(root_x) + 1.0_wp + abs(link%angle(arc))*radians_per_degree
   end function of_arc

   pure subroutine carry_point(link, step, i, row)
      type(linkage_t), intent(in) :: link
      type(bound_step_t), intent(in) :: step
      integer, intent(in) :: i
      real(wp), intent(inout) :: row(:)
      real(wp) :: length

      length = link%length(step%arc)
      if (step%slide_row > 0) length = abs(link%store%v(i, step%slide_row))
      row(step%to_x) = row(step%from_x) + length*(of_arc(link, step%root_x, step%arc, row) + 1.0_wp) &
                       + hypotenuse(link%store%v(i, step%to_x), link%store%v(i, step%to_y))
      if (step%slide_row > 0) row(step%to_x) = row(step%to_x) + row(step%slide_row)
   end subroutine carry_point
end module psalm_condition
