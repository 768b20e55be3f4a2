!> Condition number of a position: by how much a relative change of epsilon in every dimension and in the input, and the
!> roundings on the way, can change the output.
!>
!> First-order bounds are carried along the plan: of each root an angle, of each point and slide a length, in units of
!> epsilon. Every link pair multiplies by 1/sin of its transmission angle, every slide by its own factor. The error of
!> `psalm` stays below 16 epsilon times this number; tests measure it against a build in quadruple precision.
!> Derivation: `doc/theory.md`, section Condition.
module psalm_condition
   use psalm_data_set, only: motion_angle, motion_slide
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_linkage, only: linkage_t
   use psalm_plan, only: plan_t, step_point, root_crank
   implicit none (type, external)
   private
   public :: condition_t, prepare_condition, condition_at

   real(wp), parameter :: worst = 1.0_wp/epsilon(1.0_wp) !! no digit is left; larger numbers say nothing more

   !> Bounds, in units of epsilon.
   type :: condition_t
      real(wp), allocatable :: root(:)     !! shape (nroots): radians
      real(wp), allocatable :: point(:)    !! shape (0:npoints): length
      real(wp), allocatable :: slide(:)    !! shape (nlengths): length
   end type condition_t

contains

   !> Allocate for a plan.
   pure subroutine prepare_condition(plan, condition)
      type(plan_t), intent(in) :: plan
      type(condition_t), intent(out) :: condition

      allocate (condition%root(plan%nroots), condition%point(0:plan%npoints), condition%slide(plan%nlengths), source=0.0_wp)
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
      real(wp) :: arc, x, y
      integer :: m

      associate (link => problem%linkage, plan => problem%plan, out => problem%topology%output_arc)
         condition%root = 0.0_wp
         condition%point = 0.0_wp
         condition%slide = 0.0_wp
         if (link%sliding_input) then
            if (link%input_slot > 0) condition%slide(link%input_slot) = abs(link%reference_length) + abs(problem%delt(k))
         else
            condition%root(root_crank) = 1.0_wp + (abs(link%crank_angle) + abs(problem%delt(k)))*radians_per_degree
         end if
         do m = 1, size(plan%steps)
            if (plan%steps(m)%kind == step_point) then
               call carry_point(link, plan, m, i, condition)
            else
               call carry_dyad(link, plan, m, i, condition)
            end if
         end do
         arc = condition%root(plan%root(out)) + 1.0_wp + abs(problem%out_angle)*radians_per_degree
         select case (problem%motion)
         case (motion_angle)
            number = arc
         case (motion_slide)
            x = value(link, link%slide(plan%length_slot(out)), i)
            number = ratio(condition%slide(plan%length_slot(out)), abs(x))
         case default
            x = value(link, link%out_x, i)*link%scale
            y = value(link, link%out_y, i)*link%scale
            number = condition%point(plan%output_point) + abs(problem%out_length)*link%scale*(arc + 1.0_wp) &
                     + hypotenuse(problem%origin_x, problem%origin_y)*link%scale &
                     *(2.0_wp + abs(problem%origin_angle)*radians_per_degree)
            if (problem%motion == 0) x = hypotenuse(x, y)
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
   pure real(wp) function of_arc(link, plan, arc, condition)
      type(linkage_t), intent(in) :: link
      type(plan_t), intent(in) :: plan
      integer, intent(in) :: arc
      type(condition_t), intent(in) :: condition

      of_arc = condition%root(plan%root(arc)) + 1.0_wp + abs(link%angle(arc))*radians_per_degree
   end function of_arc

   pure real(wp) function value(link, row, i)
      type(linkage_t), intent(in) :: link
      integer, intent(in) :: row, i

      value = link%store(row + i - 1)
   end function value

   pure subroutine carry_point(link, plan, m, i, condition)
      type(linkage_t), intent(in) :: link
      type(plan_t), intent(in) :: plan
      integer, intent(in) :: m, i
      type(condition_t), intent(inout) :: condition
      real(wp) :: length

      associate (step => plan%steps(m))
         length = link%length(step%arc)
         if (plan%length_slot(step%arc) > 0) length = abs(value(link, link%slide(plan%length_slot(step%arc)), i))
         condition%point(step%to) = condition%point(step%from) + length*(of_arc(link, plan, step%arc, condition) + 1.0_wp) &
            + hypotenuse(value(link, link%point_x(step%to), i), value(link, link%point_y(step%to), i))
         if (plan%length_slot(step%arc) > 0) condition%point(step%to) = condition%point(step%to) &
                                                                        + condition%slide(plan%length_slot(step%arc))
      end associate
   end subroutine carry_point

   subroutine carry_dyad(link, plan, m, i, condition)
      type(linkage_t), intent(in) :: link
      type(plan_t), intent(in) :: plan
      integer, intent(in) :: m, i
      type(condition_t), intent(inout) :: condition
      real(wp) :: s, e, h, gap, across, along_p, along_q, sine, cosine, root, joint, reach

      associate (step => plan%steps(m), dyad => link%steps(m))
         s = condition%point(step%from)
         e = condition%point(step%to)
         h = hypotenuse(value(link, dyad%to_x, i) - value(link, dyad%from_x, i), &
                   value(link, dyad%to_y, i) - value(link, dyad%from_y, i))
         gap = s + e + h    ! bound of h
         reach = value(link, dyad%reach_row, i)
         select case (dyad%joint)
         case (1)
            sine = sqrt(max(((dyad%p + dyad%q)**2 - reach)*(reach - (dyad%p - dyad%q)**2), 0.0_wp))/(2.0_wp*dyad%p*dyad%q)
            joint = min((s + dyad%p + e + dyad%q)/max(sine, epsilon(1.0_wp)), (dyad%p + dyad%q)*worst)
            condition%root(plan%root(dyad%arc_p)) = (joint + s)/dyad%p + 1.0_wp
            condition%root(plan%root(dyad%arc_q)) = (joint + e)/dyad%q + 1.0_wp
         case (2)
            call slide_and_guide(dyad%q, dyad%slide_p, plan%length_slot(dyad%arc_p))
         case (3)
            call slide_and_guide(dyad%p, dyad%slide_q, plan%length_slot(dyad%arc_q))
         case (4)
            call link_and_slide(dyad%p, dyad%arc_p, dyad%arc_q)
         case (5)
            call link_and_slide(dyad%q, dyad%arc_q, dyad%arc_p)
         case (6, 7)
            across = gap + h*of_arc(link, plan, dyad%arc_p, condition)
            condition%slide(plan%length_slot(dyad%arc_p)) = across
            condition%slide(plan%length_slot(dyad%arc_q)) = across
         case (8)
            sine = max(abs(reach), epsilon(1.0_wp))
            along_p = of_arc(link, plan, dyad%arc_p, condition)
            along_q = of_arc(link, plan, dyad%arc_q, condition)
            condition%slide(plan%length_slot(dyad%arc_p)) = &
               (gap + h*along_q + abs(value(link, dyad%slide_p, i))*(along_p + along_q + 1.0_wp))/sine
            condition%slide(plan%length_slot(dyad%arc_q)) = &
               (gap + h*along_p + abs(value(link, dyad%slide_q, i))*(along_p + along_q + 1.0_wp))/sine
         end select
      end associate

   contains

      !> Types 2 and 3: slide = sqrt(h**2 - guide**2); the angle between h and the slide has the sine guide/h.
      subroutine slide_and_guide(guide, row, slot)
         real(wp), intent(in) :: guide
         integer, intent(in) :: row, slot
         real(wp) :: length

         length = max(value(link, row, i), epsilon(1.0_wp)*h)
         condition%slide(slot) = ratio(h*gap + guide*guide, length)
         associate (p => link%steps(m)%arc_p)
            condition%root(plan%root(p)) = ratio(gap, h) + ratio(guide*(1.0_wp + ratio(gap, h)), length) + 1.0_wp
         end associate
      end subroutine slide_and_guide

      !> Types 4 and 5: offset c = cross(u, h); r = sqrt(link**2 - c**2).
      subroutine link_and_slide(length, arc_link, arc_slide)
         real(wp), intent(in) :: length
         integer, intent(in) :: arc_link, arc_slide

         along_p = of_arc(link, plan, arc_slide, condition)
         across = gap + h*along_p
         cosine = max(sqrt(max((length - reach)*(length + reach), 0.0_wp)), epsilon(1.0_wp)*length)
         root = (length*length + abs(reach)*across)/cosine
         condition%slide(plan%length_slot(arc_slide)) = across + root
         condition%root(plan%root(arc_link)) = along_p + (across + abs(reach))/cosine + 1.0_wp
      end subroutine link_and_slide
   end subroutine carry_dyad
end module psalm_condition
