!> What charts of stability cost, and how far they agree with the integration of every point.
module bench_dynamics
   use psalm_crank_motion, only: constant_motion
   use psalm_data_set, only: data_set_t, read_data_sets
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, make_problem
   use psalm_force_model, only: force_model_t, make_force_model
   use psalm_hill, only: hill_t, solve_hill
   use psalm_kinds, only: wp, dp
   use psalm_link_cycle, only: link_cycle_t, find_link_cycle, moving_link
   use psalm_link_vibration, only: mode_stiffness
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
   use psalm_periodic, only: periodic_t, periodic_constant
   use psalm_setup, only: set_up
   use psalm_stability, only: boundaries_t, stability_boundaries
   use psalm_status, only: diagnostics_t
   use psalm_vibration_group, only: vibration_group_t, vibration_of
   implicit none (type, external)
   private
   public :: measure_chart

   integer, parameter :: across = 200, down = 200    !! values of e and of frequency/speed
   real(wp), parameter :: greatest_e = 4.0_wp, greatest_ratio = 8.0_wp
   integer, parameter :: last = 20                   !! boundaries that reach that ratio
   integer, parameter :: every = 50                  !! each so many points is integrated

contains

   !> Chart of the rig of chapter 14: seconds | points | largest error of a reported boundary | points integrated | seconds for
   !> them | points where both disagree.
   subroutine measure_chart(file)
      character(*), intent(in) :: file
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
      type(dimensions_t) :: dimensions
      type(problem_t), allocatable :: problem
      type(force_model_t) :: model
      type(vibration_group_t) :: vibration
      type(link_cycle_t) :: turn
      type(boundaries_t) :: b
      type(periodic_t) :: f
      type(hill_t) :: hill
      integer :: order(down, across), i, k, integrated, wrong
      real(wp) :: error, w
      real(dp) :: began, charted, ended

      call read_data_sets(file, sets, findings, 'ssics')
      if (findings%failed()) error stop 'the data set cannot be read'
      call set_up(sets(1), mechanism, dimensions, parameters, findings)
      allocate (problem)
      call make_problem(sets(1), mechanism, dimensions, parameters, problem)
      call make_force_model(sets(1), mechanism, dimensions, model, findings)
      vibration = vibration_of(sets(1))
      call find_link_cycle(problem, dimensions, model, vibration%beam, vibration%points, constant_motion(1.0_wp), turn)
      call cpu_time(began)
      error = 0.0_wp
      do i = 1, across
         f = mode_stiffness(moving_link(turn, 0.0_wp, e_of(i)), 1)
         b = stability_boundaries(f, last)
         if (.not. b%converged) error stop 'a boundary has not converged'
         error = max(error, b%error)
         do k = 1, down
            order(k, i) = instability_order(b, ratio_of(k)**2)
         end do
      end do
      call cpu_time(charted)
      integrated = 0
      wrong = 0
      do i = 1, across
         f = mode_stiffness(moving_link(turn, 0.0_wp, e_of(i)), 1)
         do k = 1 + modulo(7*i, every), down, every
            w = ratio_of(k)**2
            hill = solve_hill(periodic_constant(0.0_wp), f%plus(periodic_constant(w)), periodic_constant(0.0_wp), 1.0e-10_wp)
            integrated = integrated + 1
            if ((hill%stable .or. hill%neutral) .neqv. order(k, i) < 0) wrong = wrong + 1
         end do
      end do
      call cpu_time(ended)
      print '(f0.3,"|",i0,"|",es8.1,"|",i0,"|",f0.3,"|",i0)', charted - began, across*down, error, integrated, ended - charted, &
         wrong

   contains

      !> What the given inertia is multiplied by.
      pure real(wp) function e_of(i)
         integer, intent(in) :: i

         e_of = greatest_e/vibration%given_e*real(i, wp)/real(across, wp)
      end function e_of

      !> Which boundaries enclose W: p where W is unstable between those of p, 0 where it is below all, -1 where it is stable or
      !> beyond the last.
      pure integer function instability_order(b, w) result(p)
         type(boundaries_t), intent(in) :: b
         real(wp), intent(in) :: w

         if (w <= b%low(0)) then
            p = 0
            return
         end if
         do p = 1, ubound(b%low, 1)
            if (w >= b%low(p) .and. w <= b%high(p)) return
         end do
         p = -1
      end function instability_order

      pure real(wp) function ratio_of(k)
         integer, intent(in) :: k

         ratio_of = greatest_ratio*real(k, wp)/real(down, wp)
      end function ratio_of
   end subroutine measure_chart
end module bench_dynamics
