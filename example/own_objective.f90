!> An objective of one's own: a press whose ram has a stroke of 80 and takes 1.2 times as long to go as to come back.
module press
   use psalm, only: wp, case_t, analysis_t, wanted_t, findings_t, new_case, analyse, output_slide, plain_nlp_t
   implicit none (type, external)
   private
   public :: press_t, new_press, behaviour

   real(wp), parameter :: desired_stroke = 80.0_wp, desired_ratio = 1.2_wp
   real(wp), parameter :: full_turn = 360.0_wp
   real(wp), parameter :: bad = 10.0_wp   !! objective of a crank that does not turn fully

   !> Unknowns: length of the crank, offset of the ram's guide.
   type, extends(plain_nlp_t) :: press_t
      type(case_t) :: linkage
   contains
      procedure :: objective_at
   end type press_t

contains

   !> A slider-crank with a rod of 140.
   function new_press() result(problem)
      type(press_t) :: problem

      problem%linkage = new_case('PRESS')
      call problem%linkage%add_loop([1, -2, 3, 4], [1, 0, -4, 1], [30.0_wp, 140.0_wp, 0.0_wp, 10.0_wp], &
                                    [0.0_wp, 0.0_wp, 0.0_wp, 270.0_wp])
      call problem%linkage%set_output(output_slide, arc=3, loop=1)
      call problem%linkage%set_turn(30)
      problem%core = 2
      problem%low = [10.0_wp, 0.0_wp]
      problem%high = [60.0_wp, 80.0_wp]
   end function new_press

   !> Squares of the relative errors.
   subroutine objective_at(self, x, f, gradient)
      class(press_t), intent(in) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: f
      real(wp), intent(out), optional :: gradient(:)   !! not known: the problem has none
      real(wp) :: stroke, ratio

      if (present(gradient)) gradient = 0.0_wp
      call behaviour(self%linkage, x, stroke, ratio)
      f = bad
      if (stroke > 0.0_wp) f = (stroke/desired_stroke - 1.0_wp)**2 + (ratio/desired_ratio - 1.0_wp)**2
   end subroutine objective_at

   !> Stroke and time ratio; 0 where the crank does not turn fully.
   subroutine behaviour(linkage, x, stroke, ratio)
      type(case_t), intent(in) :: linkage
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: stroke, ratio
      type(case_t) :: changed
      type(analysis_t) :: analysis
      type(findings_t) :: findings
      type(wanted_t) :: wanted
      real(wp) :: forward

      stroke = 0.0_wp
      ratio = 0.0_wp
      changed = linkage
      call changed%set_length(1, 1, x(1))
      call changed%set_length(1, 4, x(2))
      wanted%summary = .true.
      call analyse(changed, analysis, findings, wanted)
      if (findings%failed() .or. .not. allocated(analysis%summary)) return
      if (.not. analysis%summary%everywhere .or. size(analysis%summary%reverses) /= 2) return
      stroke = analysis%summary%output%high - analysis%summary%output%low
      forward = abs(analysis%summary%reverses(2) - analysis%summary%reverses(1))
      ratio = max(forward, full_turn - forward)/min(forward, full_turn - forward)
   end subroutine behaviour
end module press

program own_objective
   use press, only: press_t, new_press, behaviour
   use psalm, only: wp, ending_t, findings_t, minimise
   implicit none (type, external)
   type(press_t) :: problem
   type(ending_t) :: ending
   type(findings_t) :: findings
   real(wp) :: x(2), stroke, ratio
   integer :: i

   problem = new_press()
   x = [30.0_wp, 20.0_wp]
   call minimise(problem, 'LN_SBPLX', x, ending, findings)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   call behaviour(problem%linkage, x, stroke, ratio)
   print '(a, f11.5)', 'crank  ', x(1), 'offset ', x(2), 'stroke ', stroke, 'ratio  ', ratio
end program own_objective
