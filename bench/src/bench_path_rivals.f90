!> Paths without prescribed timing by the global searches of NLopt.
!>
!> They get the same closed form that the program's own search has, with exact gradients, but all of it at once: pivot, size,
!> direction and coupler point (six numbers), three numbers of the shape whose box is the full turn, the first input and the shares
!> of the turn from each to the next. The crank going either way and both assemblies are four problems; each has a quarter of the
!> time. Bounds of lengths are squares with a weight.
module bench_path_rivals
   use, intrinsic :: iso_c_binding, only: c_associated, c_double, c_f_pointer, c_int, c_loc, c_ptr
   use, intrinsic :: iso_fortran_env, only: output_unit
   use bench_paths, only: make_path, name_of
   use psalm_cases, only: read_cases
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, full_turn, degrees_per_radian
   use psalm_nlopt, only: nlopt_t
   use psalm_path_fit, only: fitted_path_t, path_workspace_t, path_timing_t, trace_coupler, find_violations, dot, square, &
                             unknowns, &
                             rows_most, shape_g, shape_s, shape_q
   use psalm_solver_kind, only: find_solver
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: measure_rivals

   character(*), parameter :: names(3) = [character(12) :: 'GN_CRS2_LM', 'GN_ISRES', 'GD_MLSL_LDS']
   integer, parameter :: ways = 4
   real(wp), parameter :: within = 1.01_wp, exact = 1.0e-6_wp !! as in bench_paths
   real(wp), parameter :: reach = 20.0_wp            !! sizes of the path: crank, coupler point and pivot are looked for so far
   real(wp), parameter :: widest(3) = [5.0_wp, 7.0_wp, 1.0_wp] !! of ln g, ln sigma, q
   real(wp), parameter :: weight = 10.0_wp           !! of squared relative violations
   real(wp), parameter :: begin = 0.6_wp             !! first point, in the box
   real(wp), parameter :: least_share = 1.0e-6_wp    !! sum of the shares of a turn
   real(wp), parameter :: kept = 1.0e-3_wp           !! relative violation that still counts as none

   !> What an objective function is given.
   type :: task_t
      type(fitted_path_t) :: path
      type(path_workspace_t) :: work
      type(path_timing_t) :: timing
      type(nlopt_t) :: optimiser
      real(wp) :: begun = 0.0_wp, limit = 0.0_wp     !! seconds of the processor
      real(wp) :: goal = 0.0_wp                      !! sum of squares, scaled
      real(wp) :: best = huge(1.0_wp)
      real(wp) :: reached = -1.0_wp                  !! when the goal was; below zero: never
   end type task_t

contains

   !> Run all rivals on a data set and print its row.
   subroutine measure_rivals(file, best, seconds)
      character(*), intent(in) :: file
      real(wp), intent(in) :: best, seconds          !! sum of squares; time of each rival
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(task_t), allocatable, target :: task
      real(wp) :: least, spent, reached
      character(40) :: cell
      integer :: r, way

      call read_cases(file, sets, findings)
      write (output_unit, '(a)', advance='no') '| `'//name_of(file)//'`'
      do r = 1, size(names)
         least = huge(least)
         spent = 0.0_wp
         reached = -1.0_wp
         do way = 1, ways
            allocate (task)
            call make_path(sets(1), merge(1.0_wp, -1.0_wp, mod(way, 2) == 1), merge(1.0_wp, -1.0_wp, way <= ways/2), task%path, &
                           task%work)
            associate (unit => task%path%size**2*task%path%weight_scale, n => real(task%path%n, wp))
               task%goal = max(within*best, exact**2*n*task%path%size**2)/unit
               call run(trim(names(r)), way, seconds/real(ways, wp), task)
               least = min(least, max(task%best*unit, exact**2*n*task%path%size**2)/max(best, exact**2*n*task%path%size**2))
            end associate
            if (task%reached >= 0.0_wp .and. reached < 0.0_wp) reached = spent + task%reached
            spent = spent + seconds/real(ways, wp)
            deallocate (task)
         end do
         write (cell, '(es8.1)') sqrt(least)
         if (reached >= 0.0_wp) write (cell, '(f6.2, a)') reached, ' s'
         write (output_unit, '(a)', advance='no') ' | '//trim(adjustl(cell))
      end do
      write (output_unit, '(a)') ' |'
      flush (output_unit)
   end subroutine measure_rivals

   !> One search from a point of the box; begun again, with other random numbers, where it ends before its time.
   subroutine run(name, seed, seconds, task)
      character(*), intent(in) :: name
      integer, intent(in) :: seed
      real(wp), intent(in) :: seconds
      type(task_t), intent(inout), target :: task
      real(c_double), allocatable :: x(:), low(:), high(:)
      real(c_double) :: least
      real(wp) :: now
      integer :: status, round
      logical :: valid

      associate (n => task%path%n)
         allocate (task%timing%t(n), source=0.0_wp)
         allocate (low(unknowns + 1 + n), high(unknowns + 1 + n))
         low(:shape_g - 1) = -reach
         low(shape_g:unknowns) = real([-widest(1), 0.0_wp, -widest(3)], c_double)
         low(unknowns + 1:) = 0.0_wp
         high(:shape_g - 1) = reach
         high(shape_g:unknowns) = real(widest, c_double)
         high(unknowns + 1) = real(full_turn/degrees_per_radian, c_double)
         high(unknowns + 2:) = 1.0_wp
      end associate
      call cpu_time(task%begun)
      task%limit = task%begun + seconds
      round = 0
      do
         round = round + 1
         ! not the middle: there ground and crank are equal
         x = low + real(begin, c_double)*(high - low)
         call task%optimiser%open(find_solver(name), size(x), seed + ways*(round - 1), valid)
         if (valid) call task%optimiser%set_bounds(low, high, valid)
         call task%optimiser%set_limits(1.0e-9_c_double, 1.0e-9_c_double, huge(1))
         if (valid) call task%optimiser%minimise(objective, c_loc(task), x, least, status)
         call task%optimiser%close()
         call cpu_time(now)
         if (now >= task%limit .or. task%reached >= 0.0_wp .or. .not. valid) exit
      end do
   end subroutine run

   !> Sum of squares and violations, and its gradient, for NLopt.
   real(c_double) function objective(n, x, gradient, data) bind(c)
      integer(c_int), value :: n
      real(c_double), intent(in) :: x(n)
      type(c_ptr), value :: gradient
      type(c_ptr), value :: data
      type(task_t), pointer :: task
      real(c_double), pointer :: slope(:)
      real(wp) :: u(n)                     ! NLopt's numbers in the kind of the build
      complex(wp) :: miss, turn
      real(wp) :: amount(rows_most), rows(unknowns, rows_most), by_input(n - unknowns - 1), by(unknowns), error, now
      real(wp) :: shares, part, turned
      integer :: k, m, count

      call c_f_pointer(data, task)
      u = real(x, wp)
      associate (timing => task%timing, work => task%work, path => task%path)
         timing%side = path%side
         timing%z0 = cmplx(u(1), u(2), wp)
         timing%w1 = cmplx(u(3), u(4), wp)
         timing%w2 = cmplx(u(5), u(6), wp)
         timing%g = exp(u(shape_g))
         timing%sigma = exp(u(shape_s))
         timing%q = u(shape_q)
         shares = max(sum(u(unknowns + 2:)), least_share)
         part = 0.0_wp
         do k = 1, path%n
            timing%t(k) = u(unknowns + 1)*degrees_per_radian + full_turn*part/shares
            part = part + u(unknowns + 1 + k)
         end do
         call trace_coupler(timing, timing%t, work%e, work%v, work%turn, work%grow)
         error = 0.0_wp
         by = 0.0_wp
         do k = 1, path%n
            miss = path%weight(k)*(timing%z0 + timing%w1*work%e(k) + timing%w2*work%v(k) - path%point(k))
            error = error + square(miss)/path%weight(k)
            by(1:2) = by(1:2) + 2.0_wp*[real(miss, wp), aimag(miss)]
            turn = conjg(work%e(k))*miss
            by(3:4) = by(3:4) + 2.0_wp*[real(turn, wp), aimag(turn)]
            turn = conjg(work%v(k))*miss
            by(5:6) = by(5:6) + 2.0_wp*[real(turn, wp), aimag(turn)]
            do m = 1, 3
               by(shape_g - 1 + m) = by(shape_g - 1 + m) + 2.0_wp*dot(timing%w2*work%grow(k, m), miss)
            end do
            by_input(k) = 2.0_wp*dot(timing%w1*cmplx(-aimag(work%e(k)), real(work%e(k), wp), wp) + timing%w2*work%turn(k), miss)
         end do
         call find_violations(path, timing, 0.0_wp, count, amount, rows)
         objective = real(error + weight*sum(amount(:count)**2), c_double)
         if (error < task%best .and. all(amount(:count) <= kept)) then
            task%best = error
            if (error <= task%goal .and. task%reached < 0.0_wp) then
               call cpu_time(now)
               task%reached = now - task%begun
            end if
         end if
         if (c_associated(gradient)) then
            call c_f_pointer(gradient, slope, [n])
            do k = 1, count
               by = by + 2.0_wp*weight*amount(k)*rows(:, k)
            end do
            slope(:unknowns) = real(by, c_double)
            slope(unknowns + 1) = real(sum(by_input), c_double)
            ! a share moves the inputs behind it, and all of them by being part of the sum
            turned = sum(by_input*(timing%t - timing%t(1)))/degrees_per_radian
            do k = 1, path%n
               slope(unknowns + 1 + k) = real((full_turn/degrees_per_radian*sum(by_input(k + 1:)) - turned)/shares, c_double)
            end do
         end if
      end associate
      call cpu_time(now)
      if (now >= task%limit .or. task%reached >= 0.0_wp) call task%optimiser%force_stop()
   end function objective
end module bench_path_rivals
