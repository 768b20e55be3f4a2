!> The proof that real six-bars of psalm_six_bar_problem exist, are distinct and are real: Krawczyk's test in all numbers of the
!> linkage and the turns of its floating link. What is certified are the equations for the angles as they stand.
module psalm_six_bar_certificate
   use psalm_certificate, only: certificate_t, examine_all
   use psalm_kinds, only: wp
   use psalm_product_sums, only: product_sums_t
   use psalm_quad, only: qp, exp
   use psalm_six_bar_paths, only: turns_at
   use psalm_six_bar_problem, only: six_bar_data_t, six_bar_problem_t
   implicit none (type, external)
   private
   public :: certify_six_bars

   integer, parameter :: parts = 4                   !! of the vector of a leg: those that turn with e, with f, with t, and the rest

   !> Where the numbers stand: those of the linkage and their partners, turns and their partners, e, eh, f, fh from point 0.
   type :: places_t
      integer :: n = 0, m = 0                        !! numbers of the linkage, points beyond the first
   contains
      procedure :: t
      procedure :: angle
   end type places_t

contains

   !> Examine real solutions of a problem.
   subroutine certify_six_bars(problem, data, phi, psi, solutions, certificate)
      type(six_bar_problem_t), intent(in) :: problem
      type(six_bar_data_t), intent(in) :: data
      real(wp), intent(in) :: phi(0:), psi(0:)       !! radians
      complex(wp), intent(in) :: solutions(:, :)     !! shape (2 unknowns, count)
      type(certificate_t), intent(out) :: certificate
      type(places_t) :: at
      type(product_sums_t) :: sums
      complex(qp), allocatable :: numbers(:)
      complex(wp), allocatable :: starts(:, :)
      integer, allocatable :: unknown(:), keys(:), partner(:)
      integer :: i, j, k, square

      at%n = problem%unknowns
      at%m = problem%points
      ! behind the angles the square of a given length
      square = at%angle(1, 1, at%m + 1)
      allocate (numbers(square), source=(0.0_qp, 0.0_qp))
      do j = 0, at%m
         numbers(at%angle(0, 0, j)) = exp(cmplx(0.0_wp, phi(j), qp))
         numbers(at%angle(0, 1, j)) = exp(cmplx(0.0_wp, psi(j), qp))
         numbers(at%angle(1, 0, j)) = conjg(numbers(at%angle(0, 0, j)))
         numbers(at%angle(1, 1, j)) = conjg(numbers(at%angle(0, 1, j)))
      end do
      unknown = [integer ::]
      do k = 1, 2*at%n
         if (problem%is_given(1 + modulo(k - 1, at%n))) then
            numbers(k) = cmplx(data%known(k), kind=qp)
         else
            unknown = [unknown, k]
         end if
      end do
      if (problem%length_of > 0) numbers(square) = cmplx(data%known(problem%length_of), kind=qp)
      keys = unknown
      unknown = [unknown, [(at%t(0, j), j=1, at%m)], [(at%t(1, j), j=1, at%m)]]
      call sums%begin(size(numbers), unknown)
      do j = 1, at%m
         do k = 1, size(problem%q)
            call add_leg(problem, at, k, j, sums)
         end do
         call sums%next_equation()
         call sums%add(1, [at%t(0, j), at%t(1, j)])
         call sums%add(-1, [integer ::])
      end do
      if (problem%length_of > 0) then
         call sums%next_equation()
         call sums%add(1, [problem%length_of, at%n + problem%length_of])
         call sums%add(-1, [square])
      end if
      partner = sums%place([(other_of(unknown(k)), k=1, size(unknown))])
      allocate (starts(size(unknown), size(solutions, 2)))
      do i = 1, size(solutions, 2)
         starts(:size(keys), i) = solutions(keys, i)
         call turns_at(problem, data, solutions(:, i), starts(size(keys) + 1:size(keys) + at%m, i), &
                       starts(size(keys) + at%m + 1:, i))
         starts(size(keys) + 1:, i) = 1.0_wp + starts(size(keys) + 1:, i)
      end do
      call examine_all(sums, numbers, partner, starts, [(.true., i=1, size(solutions, 2))], sums%place(keys), .false., 0, &
                       certificate)

   contains

      !> The place of a partner.
      pure integer function other_of(place)
         integer, intent(in) :: place

         if (place <= 2*at%n) then
            other_of = place + merge(at%n, -at%n, place <= at%n)
         else
            other_of = place + merge(at%m, -at%m, place <= 2*at%n + at%m)
         end if
      end function other_of
   end subroutine certify_six_bars

   !> Place of a turn of the floating link.
   elemental integer function t(self, partner, point)
      class(places_t), intent(in) :: self
      integer, intent(in) :: partner, point          !! 0 for the number, 1 for its partner; from 1

      t = 2*self%n + partner*self%m + point
   end function t

   !> Place of a turn of the input (0) or the output (1).
   elemental integer function angle(self, partner, link, point)
      class(places_t), intent(in) :: self
      integer, intent(in) :: partner, link, point    !! point from 0

      angle = 2*self%n + 2*self%m + (2*link + partner)*(self%m + 1) + point + 1
   end function angle

   !> z zh of a point less that of the first, without the products that do not change.
   pure subroutine add_leg(problem, at, leg, point, sums)
      type(six_bar_problem_t), intent(in) :: problem
      type(places_t), intent(in) :: at
      integer, intent(in) :: leg, point
      type(product_sums_t), intent(inout) :: sums
      integer :: u, v

      call sums%next_equation()
      do u = 1, parts
         do v = 1, parts
            if (u == v .or. .not. (is_there(u) .and. is_there(v))) cycle
            call sums%add(sign_of(u)*sign_of(v), [part(u, 0, point), part(v, 1, point)])
            call sums%add(-sign_of(u)*sign_of(v), [part(u, 0, 0), part(v, 1, 0)])
         end do
      end do

   contains

      pure logical function is_there(kind)
         integer, intent(in) :: kind

         is_there = .true.
         if (kind == 1) is_there = problem%a(leg) > 0
         if (kind == 2) is_there = problem%b(leg) > 0
      end function is_there

      !> -1 of the frame where it is a constant.
      pure integer function sign_of(kind)
         integer, intent(in) :: kind

         sign_of = merge(-1, 1, kind == parts .and. problem%c(leg) == 0)
      end function sign_of

      !> Factors of a part of the vector at a point, or of its partner.
      pure function part(kind, partner, place) result(factors)
         integer, intent(in) :: kind, partner, place
         integer, allocatable :: factors(:)

         select case (kind)
         case (1)
            factors = [partner*at%n + problem%a(leg), at%angle(partner, 0, place)]
         case (2)
            factors = [partner*at%n + problem%b(leg), at%angle(partner, 1, place)]
         case (3)
            factors = [partner*at%n + problem%q(leg)]
            if (place > 0) factors = [factors, at%t(partner, place)]
         case default
            factors = [integer ::]
            if (problem%c(leg) > 0) factors = [partner*at%n + problem%c(leg)]
         end select
      end function part
   end subroutine add_leg
end module psalm_six_bar_certificate
