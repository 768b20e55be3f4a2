!> Three other ways to find the positions: the direct formulas of 1977, Newton-Raphson, integration of the velocities.
module bench_rivals
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_f_pointer, c_funloc, c_funptr, c_int, c_loc, &
                                          c_null_char, c_null_funptr, c_null_ptr, c_ptr, c_size_t
   use bench_loops, only: loops_t, arc_angle, arc_length, loop_residual, solve_pair, output_point
   use psalm_kinds, only: wp, pi
   implicit none (type, external)
   private
   public :: direct_1977, newton_raphson, integrate_velocities

   real(wp), parameter :: small_cosine = 0.01_wp !! below it the cosine rule takes over from eqs 5.14, 5.19, 5.22
   integer, parameter :: most_steps = 50         !! of Newton's method

   !> What the integrator passes through.
   type :: system_t
      type(loops_t) :: loops
      real(wp), allocatable :: unknown(:), rate(:)
   end type system_t

   type, bind(c) :: gsl_system_t
      type(c_funptr) :: function
      type(c_funptr) :: jacobian
      integer(c_size_t) :: dimension
      type(c_ptr) :: params
   end type gsl_system_t

   interface
      ! a variable of a C library can only be reached through its address
      type(c_ptr) function address_of(handle, symbol) bind(c, name='dlsym')
         import :: c_ptr, c_char
         implicit none (type, external)
         type(c_ptr), value :: handle
         character(kind=c_char), intent(in) :: symbol(*)
      end function address_of

      type(c_ptr) function driver_alloc(system, method, step, absolute, relative) &
         bind(c, name='gsl_odeiv2_driver_alloc_y_new')
         import :: c_ptr, c_double
         implicit none (type, external)
         type(c_ptr), value :: system, method
         real(c_double), value :: step, absolute, relative
      end function driver_alloc

      integer(c_int) function driver_apply(driver, t, t1, y) bind(c, name='gsl_odeiv2_driver_apply')
         import :: c_ptr, c_double, c_int
         implicit none (type, external)
         type(c_ptr), value :: driver
         real(c_double), intent(inout) :: t
         real(c_double), value :: t1
         real(c_double), intent(inout) :: y(*)
      end function driver_apply

      subroutine driver_free(driver) bind(c, name='gsl_odeiv2_driver_free')
         import :: c_ptr
         implicit none (type, external)
         type(c_ptr), value :: driver
      end subroutine driver_free
   end interface

contains

   !> Direct formulas of the thesis, section 5.2, equations 5.10 to 5.24, with the cosine rule where a cosine would be divided
   !> by a small number (section 7.5).
   subroutine direct_1977(loops, cranks, x, y)
      type(loops_t), intent(in) :: loops
      real(wp), intent(in) :: cranks(:)    !! radians, shape (n)
      real(wp), intent(out) :: x(:), y(:)  !! output point, shape (n)
      real(wp) :: u(2*loops%nloop)
      integer :: i, loop

      do i = 1, size(cranks)
         u = 0.0_wp
         do loop = 1, loops%nloop
            call direct_loop(loops, loop, cranks(i), u)
         end do
         call output_point(loops, cranks(i), u, x(i), y(i))
      end do
   end subroutine direct_1977

   subroutine direct_loop(loops, loop, crank, u)
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: loop
      real(wp), intent(in) :: crank
      real(wp), intent(inout) :: u(:)
      real(wp) :: c1, c2, p, q, angle_p, angle_q, length_p, length_q, angle, s
      integer :: a, n

      c1 = 0.0_wp
      c2 = 0.0_wp
      do a = 0, loops%loopl(loop) - 1
         n = loops%first(loop) + a
         if (n == loops%p(loop) .or. n == loops%q(loop)) cycle
         angle = arc_angle(loops, n, crank, u)
         c1 = c1 + arc_length(loops, n, u)*cos(angle)
         c2 = c2 + arc_length(loops, n, u)*sin(angle)
      end do
      p = loops%length(loops%p(loop))
      q = loops%length(loops%q(loop))
      s = loops%sign(loop)
      select case (loops%joint(loop))
      case (1)
         angle_q = angle_of(c1*c1 + c2*c2 + q*q - p*p, 2.0_wp*c1*q, 2.0_wp*c2*q, -s)
         angle_p = atan2(-(c2 + q*sin(angle_q))/p, -(c1 + q*cos(angle_q))/p)
         call set_angle(loops%p(loop), angle_p)
         call set_angle(loops%q(loop), angle_q)
      case (2)
         angle_q = angle_of(q, c1, c2, -s)
         angle_p = angle_q - s*0.5_wp*pi
         call set_angle(loops%p(loop), angle_p)
         u(loops%length_unknown(loops%p(loop))) = slide_length(c1, c2, q, angle_q, angle_p)
      case (3)
         angle_p = angle_of(p, c1, c2, s)
         angle_q = angle_p + s*0.5_wp*pi
         call set_angle(loops%p(loop), angle_p)
         u(loops%length_unknown(loops%q(loop))) = slide_length(c1, c2, p, angle_p, angle_q)
      case (4)
         angle_q = arc_angle(loops, loops%q(loop), crank, u)
         angle_p = angle_of(c1*sin(angle_q) - c2*cos(angle_q), p*sin(angle_q), -p*cos(angle_q), s)
         call set_angle(loops%p(loop), angle_p)
         u(loops%length_unknown(loops%q(loop))) = slide_length(c1, c2, p, angle_p, angle_q)
      case (5)
         angle_p = arc_angle(loops, loops%p(loop), crank, u)
         angle_q = angle_of(c1*sin(angle_p) - c2*cos(angle_p), q*sin(angle_p), -q*cos(angle_p), -s)
         call set_angle(loops%q(loop), angle_q)
         u(loops%length_unknown(loops%p(loop))) = slide_length(c1, c2, q, angle_q, angle_p)
      case default
         angle_p = arc_angle(loops, loops%p(loop), crank, u)
         angle_q = arc_angle(loops, loops%q(loop), crank, u)
         length_q = (c2*cos(angle_p) - c1*sin(angle_p))/sin(angle_p - angle_q)
         length_p = slide_length(c1, c2, length_q, angle_q, angle_p)
         u(loops%length_unknown(loops%p(loop))) = length_p
         u(loops%length_unknown(loops%q(loop))) = length_q
      end select

   contains

      subroutine set_angle(n, value)
         integer, intent(in) :: n
         real(wp), intent(in) :: value

         u(loops%angle_unknown(n)) = value - loops%angle(n)
      end subroutine set_angle
   end subroutine direct_loop

   !> Angle from c3 + c4 cos + c5 sin = 0 (eqs 5.12, 5.18, 5.20).
   pure real(wp) function angle_of(c3, c4, c5, closure) result(angle)
      real(wp), intent(in) :: c3, c4, c5, closure
      real(wp) :: square, sine

      square = c4*c4 + c5*c5
      if (abs(c4) > small_cosine*abs(c5)) then
         sine = (-c3*c5 + closure*c4*sqrt(max(square - c3*c3, 0.0_wp)))/square
         angle = atan2(sine, -(c3 + c5*sine)/c4)
      else
         angle = atan2(c5, c4) + closure*acos(max(-1.0_wp, min(1.0_wp, -c3/sqrt(square))))
      end if
   end function angle_of

   !> Length of a slide at `angle`, the partner of length `other` at `other_angle` (eq. 5.23).
   pure real(wp) function slide_length(c1, c2, other, other_angle, angle) result(length)
      real(wp), intent(in) :: c1, c2, other, other_angle, angle
      real(wp) :: below

      below = sin(angle) + cos(angle)
      if (abs(below) > small_cosine) then
         length = -(c1 + c2 + other*(sin(other_angle) + cos(other_angle)))/below
      else
         length = -((c1 + other*cos(other_angle))*cos(angle) + (c2 + other*sin(other_angle))*sin(angle))
      end if
   end function slide_length

   !> Newton-Raphson on the loop equations, loop by loop, from the position before.
   pure subroutine newton_raphson(loops, cranks, start, tolerance, x, y)
      type(loops_t), intent(in) :: loops
      real(wp), intent(in) :: cranks(:)     !! radians, shape (n)
      real(wp), intent(in) :: start(:)      !! unknowns at the first position
      real(wp), intent(in) :: tolerance     !! of the change of angles and relative lengths
      real(wp), intent(out) :: x(:), y(:)
      real(wp) :: u(size(start)), none(size(start)), jacobian(2, 2), drift(2), change(2), rx, ry, unit
      integer :: i, loop, k

      u = start
      none = 0.0_wp
      unit = maxval(loops%length)
      do i = 1, size(cranks)
         do loop = 1, loops%nloop
            do k = 1, most_steps
               call loop_residual(loops, loop, cranks(i), u, none, rx, ry, jacobian, drift)
               change = solve_pair(jacobian, -[rx, ry])
               u(2*loop - 1:2*loop) = u(2*loop - 1:2*loop) + change
               if (maxval(abs(change)) <= tolerance*max(1.0_wp, unit*merge(1.0_wp, 0.0_wp, loops%joint(loop) > 1))) exit
            end do
         end do
         call output_point(loops, cranks(i), u, x(i), y(i))
      end do
   end subroutine newton_raphson

   !> Variable-order Adams predictor-corrector (GNU Scientific Library, msadams) on the velocity equations.
   subroutine integrate_velocities(loops, cranks, start, tolerance, x, y, done)
      type(loops_t), intent(in) :: loops
      real(wp), intent(in) :: cranks(:)     !! radians, shape (n), increasing
      real(wp), intent(in) :: start(:)      !! unknowns at the first position
      real(wp), intent(in) :: tolerance     !! relative and absolute
      real(wp), intent(out) :: x(:), y(:)
      logical, intent(out) :: done
      type(system_t), target :: system
      type(gsl_system_t), target :: gsl
      type(c_ptr) :: driver
      type(c_ptr), pointer :: adams
      real(c_double) :: t, state(size(start))
      integer :: i

      call c_f_pointer(address_of(c_null_ptr, 'gsl_odeiv2_step_msadams'//c_null_char), adams)
      system%loops = loops
      allocate (system%unknown(size(start)), system%rate(size(start)))
      gsl%function = c_funloc(velocities)
      gsl%jacobian = c_null_funptr
      gsl%dimension = int(size(start), c_size_t)
      gsl%params = c_loc(system)
      driver = driver_alloc(c_loc(gsl), adams, 1.0e-4_c_double, real(tolerance, c_double), real(tolerance, c_double))
      done = c_associated(driver)
      if (.not. done) return
      state = real(start, c_double)
      t = real(cranks(1), c_double)
      call output_point(loops, cranks(1), start, x(1), y(1))
      do i = 2, size(cranks)
         done = driver_apply(driver, t, real(cranks(i), c_double), state) == 0_c_int
         if (.not. done) exit
         call output_point(loops, cranks(i), real(state, wp), x(i), y(i))
      end do
      call driver_free(driver)
   end subroutine integrate_velocities

   !> Rates of all unknowns at a crank angle.
   integer(c_int) function velocities(t, state, rates, params) bind(c)
      real(c_double), value :: t
      real(c_double), intent(in) :: state(*)
      real(c_double), intent(out) :: rates(*)
      type(c_ptr), value :: params
      type(system_t), pointer :: system
      real(wp) :: jacobian(2, 2), drift(2), rx, ry
      integer :: loop, n

      call c_f_pointer(params, system)
      n = size(system%unknown)
      system%unknown = real(state(:n), wp)
      do loop = 1, system%loops%nloop
         call loop_residual(system%loops, loop, real(t, wp), system%unknown, system%rate, rx, ry, jacobian, drift)
         system%rate(2*loop - 1:2*loop) = solve_pair(jacobian, -drift)
      end do
      rates(:n) = real(system%rate, c_double)
      velocities = 0_c_int
   end function velocities
end module bench_rivals
