!> Condition number of a position: by how much a relative change of epsilon in every dimension and in the input, and the
!> roundings on the way, can change the output.
!>
!> First-order bounds are carried along the plan: of each root an angle, of each point and slide a length, in units of
!> epsilon. Every link pair multiplies by 1/sin of its transmission angle, every slide by its own factor. The error of
!> `psalm` stays below 16 epsilon times this number; tests measure it against a build in quadruple precision.
!> Derivation: `doc/theory.md`, section Condition.
module psalm_condition
   use psalm_assur, only: bounds_of_dyad
   use psalm_data_set, only: motion_angle, motion_slide
   use psalm_error, only: problem_t
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
   !>
   !> Relative to the output: for MOTION 0 to the distance of the output point from the machine origin, for MOTION 2 and 3 to
   !> the distance or length, for MOTION 1 to one radian.
   subroutine condition_at(problem, i, k, condition, number)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: i, k
      type(condition_t), intent(inout) :: condition
      real(wp), intent(out) :: number
      real(wp) :: arc, x, y, bound(2)
      integer :: m

      associate (link => problem%linkage, plan => problem%plan, out => problem%topology%output_arc, v => problem%linkage%store%v)
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
         arc = condition%row(link%root_x(plan%root(out))) + 1.0_wp + abs(problem%out_angle)*radians_per_degree
         select case (problem%motion)
         case (motion_angle)
            number = arc
         case (motion_slide)
            associate (slide => link%slide(plan%length_slot(out)))
               number = ratio(condition%row(slide), abs(v(i, slide)))
            end associate
         case default
            x = v(i, link%out_x)*link%scale
            y = v(i, link%out_y)*link%scale
            number = condition%row(link%point_x(plan%output_point)) + abs(problem%out_length)*link%scale*(arc + 1.0_wp) &
                     + hypot(problem%origin_x, problem%origin_y)*link%scale*(2.0_wp + abs(problem%origin_angle)*radians_per_degree)
            if (problem%motion == 0) x = hypot(x, y)
            number = 1.0_wp + ratio(number, abs(x))
         end select
         number = min(number, worst)
      end associate
   end subroutine condition_at

   !> a/b, but no more than `worst`.
   pure real(wp) function ratio(a, b)
      real(wp), intent(in) :: a, b   !! a >= 0, b >= 0

      ratio = worst
      if (b*worst > a) ratio = a/b
   end function ratio

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
                       + hypot(link%store%v(i, step%to_x), link%store%v(i, step%to_y))
      if (step%slide_row > 0) row(step%to_x) = row(step%to_x) + row(step%slide_row)
   end subroutine carry_point
end module psalm_condition
