!> Six-bars that generate a function exactly: one system for Watt II, Stephenson III and Stephenson II.
!>
!> Input and output turn by e and f, numbers of modulus 1, the floating link by t from the first point. It has two legs of constant
!> length, of which z is the vector at a point:
!>    w = a e + b f + c,    z = w + t q,    z zh = z_0 zh_0,    t th = 1
!> A partner (h) is the conjugate of a real solution, else a number of its own; eh = 1/e. The unknowns of a linkage are those of a,
!> b, c and q that are not constant:
!>    Watt II          p e - 1 + t q,          s f - 1 + t r           p q r s
!>    Stephenson III   p e - 1 + t q,          p e + s f + c + t r     p q r s c
!>    Stephenson II    p1 e - 1 + s f + t q1,  p2 e - 1 + s f + t q2   p1 p2 s q1 q2
!> Of a problem whose points leave one dimension free the length of one unknown may be given.
!> Sources: Plecnik and McCarthy (2016), Computational design of Stephenson II six-bar function generators for 11 accuracy points;
!> Plecnik and McCarthy (2014) for Watt II.
module psalm_six_bar_problem
   use psalm_kinds, only: wp
   use psalm_leg_problem, only: gaussian
   use psalm_xoshiro, only: xoshiro_t
   implicit none (type, external)
   private
   public :: six_bar_problem_t, six_bar_data_t, make_six_bar_problem, data_of_angles, scale_data, scale_unknowns, draw_six_bar, &
             near_data, order_legs, unit_phase, watt_2, stephenson_3, stephenson_2, most_six_bar_points, most_unknowns, &
             type_names, number_name, at_p, at_q, at_r, at_s, at_c, at_output, at_first_arm

   integer, parameter :: watt_2 = 1, stephenson_3 = 2, stephenson_2 = 3
   character(*), parameter :: type_names(3) = [character(14) :: 'Watt II', 'Stephenson III', 'Stephenson II']
   integer, parameter :: most_six_bar_points = 10    !! beyond the first
   integer, parameter :: most_unknowns = 5
   integer, parameter :: legs = 2
   !> Places of the unknowns.
   integer, parameter :: at_p = 1, at_q = 2, at_r = 3, at_s = 4, at_c = 5
   !> Those of Stephenson II: pins on the input link, output link, arms of the floating link.
   integer, parameter :: at_first_pin = 1, at_second_pin = 2, at_output = 3, at_first_arm = 4, at_second_arm = 5
   integer, parameter :: newton_steps = 60           !! of a point that is drawn
   real(wp), parameter :: drawn_well = 1.0e-13_wp    !! largest correction left of it

   !> What is asked for.
   type :: six_bar_problem_t
      integer :: type = watt_2
      integer :: points = 8                          !! beyond the first
      integer :: unknowns = 4                        !! complex; each has a partner
      integer :: a(legs) = 0, b(legs) = 0            !! unknown that stands there; 0: nothing does
      integer :: c(legs) = 0                         !! likewise; 0: -1
      integer :: q(legs) = 0
      logical :: is_given(most_unknowns) = .false.   !! numbers that are given
      integer :: length_of = 0                       !! unknown whose length is given; 0: none
   contains
      procedure :: key
   end type six_bar_problem_t

   !> Its numbers.
   type :: six_bar_data_t
      complex(wp) :: e0 = (1.0_wp, 0.0_wp), f0 = (1.0_wp, 0.0_wp) !! at the first point
      complex(wp) :: de(most_six_bar_points) = (0.0_wp, 0.0_wp), df(most_six_bar_points) = (0.0_wp, 0.0_wp) !! from there
      !> Numbers that are given, partners behind all numbers; of a given length its square.
      complex(wp) :: known(2*most_unknowns) = (0.0_wp, 0.0_wp)
   end type six_bar_data_t

contains

   !> A problem of a type: `points` beyond the first.
   pure subroutine make_six_bar_problem(type, points, is_given, length_of, problem)
      integer, intent(in) :: type, points
      integer, intent(in) :: length_of               !! unknown whose length is given; 0: none
      logical, intent(in) :: is_given(most_unknowns)
      type(six_bar_problem_t), intent(out) :: problem

      problem%type = type
      problem%points = points
      problem%unknowns = merge(4, 5, type == watt_2)
      problem%q = [at_q, at_r]
      problem%length_of = length_of
      select case (type)
      case (watt_2)
         problem%a = [at_p, 0]
         problem%b = [0, at_s]
      case (stephenson_2)
         problem%a = [at_first_pin, at_second_pin]
         problem%b = [at_output, at_output]
         problem%q = [at_first_arm, at_second_arm]
      case default
         problem%a = [at_p, at_p]
         problem%b = [0, at_s]
         problem%c = [0, at_c]
      end select
      problem%is_given = is_given
   end subroutine make_six_bar_problem

   !> Put the legs of Stephenson II in an order where both are alike: exchanged they are the same linkage.
   pure subroutine order_legs(problem, solutions)
      type(six_bar_problem_t), intent(in) :: problem
      complex(wp), intent(inout) :: solutions(:, :)  !! shape (2 unknowns, count)
      integer, parameter :: exchanged(*) = [at_second_pin, at_first_pin, at_output, at_second_arm, at_first_arm]
      integer :: i, n

      n = problem%unknowns
      if (problem%type /= stephenson_2) return
      if (any(problem%is_given(:n) .and. exchanged(:n) /= at_output) .or. problem%length_of > 0) return
      do i = 1, size(solutions, 2)
         if (real(solutions(at_first_pin, i), wp) > real(solutions(at_second_pin, i), wp)) &
            solutions(:, i) = solutions([exchanged, n + exchanged], i)
      end do
   end subroutine order_legs

   !> A word that tells problems with different start sets apart.
   pure function key(self) result(word)
      class(six_bar_problem_t), intent(in) :: self
      character(:), allocatable :: word
      character(2) :: number
      integer :: k

      write (number, '(i2.2)') self%points + 1
      select case (self%type)
      case (watt_2)
         word = 'watt2-'//number
      case (stephenson_2)
         word = 'stephenson2-'//number
      case default
         word = 'stephenson3-'//number
      end select
      do k = 1, self%unknowns
         if (self%is_given(k)) word = word//'-'//number_name(k, self%type)
         if (self%length_of == k) word = word//'-length_'//number_name(k, self%type)
      end do
   end function key

   !> The letter of an unknown of a type, with a number where there are two.
   pure function number_name(unknown, type) result(name)
      integer, intent(in) :: unknown, type
      character(:), allocatable :: name
      character(*), parameter :: of_dyads(*) = ['p', 'q', 'r', 's', 'c'], of_stephenson_2(*) = ['p1', 'p2', 's ', 'q1', 'q2']

      if (type == stephenson_2) then
         name = trim(of_stephenson_2(unknown))
      else
         name = of_dyads(unknown)
      end if
   end function number_name

   !> The numbers of a real problem.
   pure subroutine data_of_angles(phi, psi, data)
      real(wp), intent(in) :: phi(0:), psi(0:)       !! radians
      type(six_bar_data_t), intent(out) :: data
      integer :: j

      data%e0 = cmplx(cos(phi(0)), sin(phi(0)), wp)
      data%f0 = cmplx(cos(psi(0)), sin(psi(0)), wp)
      do j = 1, ubound(phi, 1)
         data%de(j) = chord(phi(0), phi(j))
         data%df(j) = chord(psi(0), psi(j))
      end do

   contains

      !> exp(i b) - exp(i a), without cancellation.
      pure complex(wp) function chord(a, b)
         real(wp), intent(in) :: a, b
         real(wp) :: middle

         middle = 0.5_wp*(a + b)
         chord = 2.0_wp*sin(0.5_wp*(b - a))*cmplx(-sin(middle), cos(middle), wp)
      end function chord
   end subroutine data_of_angles

   !> The same problem with e times l and f times m.
   pure subroutine scale_data(problem, data, l, m, scaled)
      type(six_bar_problem_t), intent(in) :: problem
      type(six_bar_data_t), intent(in) :: data
      complex(wp), intent(in) :: l, m
      type(six_bar_data_t), intent(out) :: scaled

      scaled = data
      scaled%e0 = l*data%e0
      scaled%de = l*data%de
      scaled%f0 = m*data%f0
      scaled%df = m*data%df
      call scale_unknowns(problem, l, m, scaled%known)
   end subroutine scale_data

   !> Its unknowns likewise.
   pure subroutine scale_unknowns(problem, l, m, x)
      type(six_bar_problem_t), intent(in) :: problem
      complex(wp), intent(in) :: l, m
      complex(wp), intent(inout) :: x(:)             !! shape (2 unknowns or more)
      integer :: k, n

      n = problem%unknowns
      do k = 1, n
         if (any(problem%a == k)) then
            x(k) = x(k)/l
            x(n + k) = x(n + k)*l
         else if (any(problem%b == k)) then
            x(k) = x(k)/m
            x(n + k) = x(n + k)*m
         end if
      end do
   end subroutine scale_unknowns

   !> A number of modulus 1 whose angle is drawn, up to +- `largest`.
   complex(wp) function unit_phase(random, largest)
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(in) :: largest                !! radians
      real(wp) :: angle

      call random%next(angle)
      angle = largest*(2.0_wp*angle - 1.0_wp)
      unit_phase = cmplx(cos(angle), sin(angle), wp)
   end function unit_phase

   !> A problem near another one: e and f times exp(z), z complex normal with this deviation.
   subroutine near_data(problem, data, deviation, random, near)
      type(six_bar_problem_t), intent(in) :: problem
      type(six_bar_data_t), intent(in) :: data
      real(wp), intent(in) :: deviation
      type(xoshiro_t), intent(inout) :: random
      type(six_bar_data_t), intent(out) :: near
      integer :: j

      near%e0 = data%e0*exp(deviation*gaussian(random))
      near%f0 = data%f0*exp(deviation*gaussian(random))
      do j = 1, problem%points
         near%de(j) = (data%e0 + data%de(j))*exp(deviation*gaussian(random)) - near%e0
         near%df(j) = (data%f0 + data%df(j))*exp(deviation*gaussian(random)) - near%f0
      end do
      do j = 1, 2*problem%unknowns
         near%known(j) = data%known(j)*exp(deviation*gaussian(random))
      end do
   end subroutine near_data

   !> A problem with one solution: numbers and turns are drawn, and e and f of each point solve its two equations.
   subroutine draw_six_bar(problem, random, data, x, drawn)
      type(six_bar_problem_t), intent(in) :: problem
      type(xoshiro_t), intent(inout) :: random
      type(six_bar_data_t), intent(out) :: data
      complex(wp), intent(out) :: x(2*problem%unknowns)
      logical, intent(out) :: drawn
      complex(wp) :: z0(legs), z0h(legs), w, wh, t, e, f, value(legs), by_e(legs), by_f(legs), det, step_e, step_f
      integer :: j, k, n, turn

      n = problem%unknowns
      do k = 1, 2*n
         x(k) = gaussian(random)
      end do
      data%e0 = exp(0.3_wp*gaussian(random))
      data%f0 = exp(0.3_wp*gaussian(random))
      do k = 1, legs
         z0(k) = of(x, problem%a(k), 0, (0.0_wp, 0.0_wp))*data%e0 + of(x, problem%b(k), 0, (0.0_wp, 0.0_wp))*data%f0 + &
                 of(x, problem%c(k), 0, (-1.0_wp, 0.0_wp)) + x(problem%q(k))
         z0h(k) = of(x, problem%a(k), n, (0.0_wp, 0.0_wp))/data%e0 + of(x, problem%b(k), n, (0.0_wp, 0.0_wp))/data%f0 + &
                  of(x, problem%c(k), n, (-1.0_wp, 0.0_wp)) + x(n + problem%q(k))
      end do
      drawn = .true.
      do j = 1, problem%points
         t = exp(0.7_wp*gaussian(random))
         e = data%e0*exp(0.7_wp*gaussian(random))
         f = data%f0*exp(0.7_wp*gaussian(random))
         step_e = huge(1.0_wp)
         step_f = (0.0_wp, 0.0_wp)
         do turn = 1, newton_steps
            do k = 1, legs
               associate (a => of(x, problem%a(k), 0, (0.0_wp, 0.0_wp)), ah => of(x, problem%a(k), n, (0.0_wp, 0.0_wp)), &
                          b => of(x, problem%b(k), 0, (0.0_wp, 0.0_wp)), bh => of(x, problem%b(k), n, (0.0_wp, 0.0_wp)))
                  w = a*e + b*f + of(x, problem%c(k), 0, (-1.0_wp, 0.0_wp)) + t*x(problem%q(k))
                  wh = ah/e + bh/f + of(x, problem%c(k), n, (-1.0_wp, 0.0_wp)) + x(n + problem%q(k))/t
                  value(k) = w*wh - z0(k)*z0h(k)
                  by_e(k) = a*wh - w*ah/e**2
                  by_f(k) = b*wh - w*bh/f**2
               end associate
            end do
            det = by_e(1)*by_f(2) - by_e(2)*by_f(1)
            if (.not. abs(det) > 0.0_wp) exit
            step_e = -(value(1)*by_f(2) - value(2)*by_f(1))/det
            step_f = -(by_e(1)*value(2) - by_e(2)*value(1))/det
            e = e + step_e
            f = f + step_f
            if (.not. abs(e) + abs(f) < 1.0e6_wp) exit
            if (abs(step_e)/abs(e) + abs(step_f)/abs(f) < drawn_well) exit
         end do
         drawn = abs(step_e)/abs(e) + abs(step_f)/abs(f) < 100.0_wp*drawn_well .and. &
                 max(abs(log(abs(e))), abs(log(abs(f)))) < 2.5_wp
         if (.not. drawn) return
         data%de(j) = e - data%e0
         data%df(j) = f - data%f0
      end do
      do k = 1, n
         if (problem%is_given(k)) data%known([k, n + k]) = x([k, n + k])
         if (problem%length_of == k) data%known(k) = x(k)*x(n + k)
      end do
   end subroutine draw_six_bar

   !> An unknown or its partner (`behind` places on), or a constant where there is none.
   pure complex(wp) function of(x, place, behind, constant)
      complex(wp), intent(in) :: x(:)
      integer, intent(in) :: place, behind
      complex(wp), intent(in) :: constant

      of = constant
      if (place > 0) of = x(behind + place)
   end function of
end module psalm_six_bar_problem
