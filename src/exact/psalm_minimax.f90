!> Function generators whose largest error is least, by exchange (Remez).
!>
!> A four-bar or slider-crank has five parameters, so the error of a best approximation alternates at six points. Starts are all
!> exact linkages at Chebyshev's five nodes and at nodes near them; psalm_error_levelling leads them to optima. All distinct ones
!> are kept and ranked. Source: Freudenstein (1955).
module psalm_minimax
   use psalm_error_levelling, only: error_family_t, hopeless, level_errors
   use psalm_function_points, only: plain_point, generator_t, generators_t, five_points
   use psalm_kinds, only: wp, pi, degrees_per_radian
   use psalm_desired_function, only: desired_function_t
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: approximation_t, approximate

   integer, parameter :: unknowns = 5, alternations = unknowns + 1
   integer, parameter :: node_sets = 25              !! sets of five nodes that starts come from
   integer, parameter :: few_programs = 5, many_programs = 60 !! linear programs of a start: at first, and where nothing was found
   integer, parameter :: seed = 1
   real(wp), parameter :: spread_of_nodes = 0.45_wp  !! of a node about Chebyshev's, over the distance of neighbours
   real(wp), parameter :: same_error = 1.0e-6_wp     !! relative difference of two optima that are one

   !> A linkage and its error.
   type :: approximation_t
      type(generator_t) :: linkage
      integer :: sense = 1                           !! +1: output turns with the input
      real(wp) :: error = huge(1.0_wp)               !! largest: degrees, of a slider per cent of the travel
      real(wp) :: at(alternations) = 0.0_wp          !! inputs where it is reached, from 0 to 1
      logical :: alternates = .false.                !! six times: a local optimum
   end type approximation_t

   !> Four-bars or slider-cranks of one assembly.
   type, extends(error_family_t) :: generator_family_t
      type(desired_function_t) :: wanted
      integer :: assembly = 1
      logical :: slides = .false.
      real(wp) :: longest = huge(1.0_wp)             !! link
   contains
      procedure :: errors
      procedure :: runs_away
   end type generator_family_t

contains

   !> Local optima, the best first, as many as are asked for. `too_long` counts those left out because a link is longer than
   !> `longest`.
   subroutine approximate(wanted, longest, found, too_long)
      type(desired_function_t), intent(in) :: wanted
      real(wp), intent(in) :: longest                !! over the frame, of a slider over the travel
      type(approximation_t), allocatable, intent(out) :: found(:)
      integer, intent(out) :: too_long
      type(approximation_t) :: one
      type(generators_t) :: starts
      type(desired_function_t) :: target
      type(xoshiro_t) :: random
      real(wp) :: nodes(unknowns)
      integer :: set, sense, k, last, programs, sweep

      allocate (found(0))
      target = wanted
      call target%prepare()
      do sweep = 1, 2
         ! many starts end in the same optimum: none is worth long work until all have failed
         programs = merge(few_programs, many_programs, sweep == 1)
         too_long = 0
         call random%seed(seed, purpose_starts)
         if (wanted%slides) then
            ! a linear scale may have no exact linkage at all: begin from a symmetric one as well
            target%sense = wanted%sense
            call improve(target, symmetric_slider(wanted), longest, programs, one)
            call keep(one, longest, found, too_long)
         end if
         last = node_sets
         if (.not. wanted%continuous) last = max(node_sets, 2*size(wanted%table_input))
         do set = 1, last
            call choose_nodes(wanted, set, random, nodes)
            ! a slider-crank turned by half a turn is that of the other sense
            do sense = 1, merge(1, -1, wanted%slides), -2
               target%sense = sense
               call five_points(plain_point(target%input_at(nodes), target%output_at(nodes)), wanted%slides, starts)
               do k = 1, starts%count
                  call improve(target, starts%list(k), longest, programs, one)
                  call keep(one, longest, found, too_long)
               end do
            end do
         end do
         if (size(found) > 0) exit
      end do
   end subroutine approximate

   !> Five nodes, from 0 to 1: those of Chebyshev, then others about them.
   subroutine choose_nodes(wanted, set, random, nodes)
      type(desired_function_t), intent(in) :: wanted
      integer, intent(in) :: set
      type(xoshiro_t), intent(inout) :: random
      real(wp), intent(out) :: nodes(unknowns)
      real(wp) :: deviate, edge(0:unknowns)
      integer :: i, n, entry

      do i = 1, unknowns
         nodes(i) = 0.5_wp - 0.5_wp*cos(pi*(2.0_wp*real(i, wp) - 1.0_wp)/(2.0_wp*real(unknowns, wp)))
      end do
      if (set > 1) then
         edge(0) = 0.0_wp
         edge(unknowns) = 1.0_wp
         edge(1:unknowns - 1) = 0.5_wp*(nodes(:unknowns - 1) + nodes(2:))
         do i = 1, unknowns
            call random%next(deviate)
            nodes(i) = nodes(i) + 2.0_wp*spread_of_nodes*(deviate - 0.5_wp)*(edge(i) - edge(i - 1))
         end do
         ! the function need not be there beyond its range
         nodes = min(max(nodes, 0.0_wp), 1.0_wp)
      end if
      if (wanted%continuous) return
      ! entries of a table: the nearest, each once
      n = size(wanted%table_input)
      entry = 0
      do i = 1, unknowns
         entry = min(max(1 + nint(nodes(i)*real(n - 1, wp)), entry + 1), n - unknowns + i)
         nodes(i) = wanted%place_of(entry)
      end do
   end subroutine choose_nodes

   !> Add an optimum to the list unless it is there.
   pure subroutine keep(one, longest, found, too_long)
      type(approximation_t), intent(in) :: one
      real(wp), intent(in) :: longest
      type(approximation_t), allocatable, intent(inout) :: found(:)
      integer, intent(inout) :: too_long
      integer :: k, place

      if (one%error > hopeless .or. .not. one%alternates) then
         if (longest_link(one%linkage) > longest .and. one%error < hopeless) too_long = too_long + 1
         return
      end if
      if (longest_link(one%linkage) > longest) then
         too_long = too_long + 1
         return
      end if
      do k = 1, size(found)
         if (abs(found(k)%error - one%error) < same_error*one%error .and. found(k)%sense == one%sense) return
      end do
      place = count(found%error < one%error) + 1
      found = [found(:place - 1), one, found(place:)]
   end subroutine keep

   !> From an exact linkage to the nearest optimum.
   subroutine improve(wanted, start, longest, programs, one)
      type(desired_function_t), intent(in) :: wanted
      type(generator_t), intent(in) :: start
      real(wp), intent(in) :: longest                !! a link that grows beyond it ends the search
      integer, intent(in) :: programs                !! linear programs at most
      type(approximation_t), intent(out) :: one
      type(generator_family_t) :: family
      real(wp) :: q(unknowns), largest, at(alternations)
      integer :: assembly
      logical :: levelled

      one%linkage = start
      one%sense = wanted%sense
      family%wanted = wanted
      family%slides = start%slides
      family%longest = longest
      if (.not. wanted%continuous) call family%look_at(wanted%place_of([(assembly, assembly=1, size(wanted%table_input))]))
      do assembly = 1, -1, -2
         if (start%assembly /= 0 .and. assembly /= start%assembly) cycle
         if (start%slides .and. start%assembly == 0 .and. assembly < 0) cycle
         family%assembly = assembly
         call parameters_of(start, q)
         call level_errors(family, programs, q, largest, at, levelled)
         if (largest > hopeless) cycle
         if (largest < one%error) then
            one%error = largest
            one%at = at
            one%alternates = levelled
            call generator_of(q, assembly, start%slides, one%linkage)
         end if
      end do
   end subroutine improve

   !> A slider-crank whose crank swings to both sides of the normal of its slide, with the travel that is wanted.
   pure function symmetric_slider(wanted) result(linkage)
      type(desired_function_t), intent(in) :: wanted
      type(generator_t) :: linkage
      real(wp), parameter :: rod = 3.0_wp            !! over the crank
      real(wp) :: half

      half = 0.5_wp*min(abs(wanted%swing_in), pi)
      linkage%slides = .true.
      linkage%r2 = 0.5_wp*wanted%swing_out/sin(half)
      linkage%r3 = rod*abs(linkage%r2)
      linkage%r4 = -linkage%r2
      linkage%phi0 = -0.5_wp*pi - sign(half, wanted%swing_in)
      linkage%psi0 = 0.5_wp*wanted%swing_out - linkage%r3
      linkage%assembly = 1
   end function symmetric_slider

   !> Longest link of a linkage.
   pure real(wp) function longest_link(linkage)
      type(generator_t), intent(in) :: linkage

      longest_link = max(linkage%r2, linkage%r3, abs(linkage%r4))
   end function longest_link

   !> Longest link of some parameters.
   pure real(wp) function longest_of(q, assembly, slides)
      real(wp), intent(in) :: q(unknowns)
      integer, intent(in) :: assembly
      logical, intent(in) :: slides
      type(generator_t) :: linkage

      call generator_of(q, assembly, slides, linkage)
      longest_of = longest_link(linkage)
   end function longest_of

   !> Parameters that stay smooth where lengths run away: of a four-bar ln r2, phi0, 1/r4, psi0, r3 - r4; of a slider-crank r2,
   !> phi0, assembly/r3, place of the slide, offset.
   pure subroutine parameters_of(linkage, q)
      type(generator_t), intent(in) :: linkage
      real(wp), intent(out) :: q(unknowns)
      integer :: side

      if (linkage%slides) then
         side = merge(linkage%assembly, 1, linkage%assembly /= 0)
         q = [linkage%r2, linkage%phi0, real(side, wp)/linkage%r3, linkage%psi0 + real(side, wp)*linkage%r3, linkage%r4]
      else
         q = [log(linkage%r2), linkage%phi0, 1.0_wp/linkage%r4, linkage%psi0, linkage%r3 - linkage%r4]
      end if
   end subroutine parameters_of

   !> The linkage of some parameters.
   pure subroutine generator_of(q, assembly, slides, linkage)
      real(wp), intent(in) :: q(unknowns)
      integer, intent(in) :: assembly
      logical, intent(in) :: slides
      type(generator_t), intent(out) :: linkage
      real(wp) :: inverse

      inverse = sign(max(abs(q(3)), sqrt(tiny(1.0_wp))), q(3))
      linkage%slides = slides
      linkage%assembly = assembly
      if (slides) then
         linkage%assembly = merge(1, -1, inverse > 0.0_wp)
         linkage%r2 = q(1)
         linkage%phi0 = q(2)
         linkage%r3 = 1.0_wp/abs(inverse)
         linkage%psi0 = q(4) - 1.0_wp/inverse
         linkage%r4 = q(5)
         if (linkage%r2 < 0.0_wp) then
            linkage%r2 = -linkage%r2
            linkage%phi0 = linkage%phi0 + pi
         end if
      else
         linkage%r2 = exp(q(1))
         linkage%phi0 = q(2)
         linkage%r4 = 1.0_wp/inverse
         linkage%psi0 = q(4)
         linkage%r3 = abs(q(5) + linkage%r4)
         if (linkage%r4 < 0.0_wp) then
            ! the same link in the opposite direction; its cosine changes sign, so does the side
            linkage%r4 = -linkage%r4
            linkage%psi0 = linkage%psi0 + pi
         end if
      end if
      linkage%phi0 = modulo(linkage%phi0 + pi, 2.0_wp*pi) - pi
      if (.not. slides) linkage%psi0 = modulo(linkage%psi0 + pi, 2.0_wp*pi) - pi
   end subroutine generator_of

   !> Errors of a member of the family.
   pure subroutine errors(self, q, at, error, slopes)
      class(generator_family_t), intent(in) :: self
      real(wp), intent(in) :: q(:), at(:)
      real(wp), intent(out) :: error(:)
      real(wp), intent(out), optional :: slopes(:, :)
      integer :: i

      do i = 1, size(at)
         if (present(slopes)) then
            call error_of(self%wanted, q, self%assembly, at(i), error(i), slopes(:, i))
         else
            call error_of(self%wanted, q, self%assembly, at(i), error(i))
         end if
      end do
   end subroutine errors

   !> True if a link has become too long.
   pure logical function runs_away(self, q)
      class(generator_family_t), intent(in) :: self
      real(wp), intent(in) :: q(:)

      runs_away = longest_of(q, self%assembly, self%slides) > self%longest
   end function runs_away

   !> Error at an input from 0 to 1: degrees, of a slider per cent of the travel; `slopes` its derivatives by the parameters.
   !> Where the linkage does not close the error is `huge`.
   pure subroutine error_of(wanted, q, assembly, at, error, slopes)
      type(desired_function_t), intent(in) :: wanted
      real(wp), intent(in) :: q(unknowns)
      integer, intent(in) :: assembly
      real(wp), intent(in) :: at
      real(wp), intent(out) :: error
      real(wp), intent(out), optional :: slopes(unknowns)
      complex(wp) :: crank, v, by(2)
      real(wp) :: m, r, c, sine, y, root, unit, difference, side
      real(wp), parameter :: per_cent = 100.0_wp

      error = huge(1.0_wp)
      if (present(slopes)) slopes = 0.0_wp
      associate (theta => wanted%input_at(at) + q(2))
         crank = cmplx(cos(theta), sin(theta), wp)
      end associate
      if (wanted%slides) then
         unit = per_cent/wanted%swing_out
         y = q(1)*aimag(crank) - q(5)
         root = 1.0_wp - (q(3)*y)**2
         if (root <= 0.0_wp) return
         root = sqrt(root)
         error = unit*(q(1)*real(crank, wp) - q(3)*y**2/(1.0_wp + root) + q(4) - wanted%output_at(at))
         if (.not. present(slopes)) return
         c = q(3)*y/root
         slopes = unit*[real(crank, wp) - c*aimag(crank), -q(1)*aimag(crank) - c*q(1)*real(crank, wp), &
                        -y**2/(root*(1.0_wp + root)), 1.0_wp, c]
         return
      end if
      unit = degrees_per_radian
      side = real(assembly, wp)
      crank = exp(q(1))*crank
      v = 1.0_wp - crank
      m = real(v, wp)**2 + aimag(v)**2
      if (.not. m > 0.0_wp) return
      r = sqrt(m)
      c = (q(5)*(2.0_wp + q(5)*q(3)) - q(3)*m)/(2.0_wp*r)
      if (abs(c) >= 1.0_wp) return
      difference = atan2(aimag(v), real(v, wp)) + side*acos(c) - q(4) - wanted%output_at(at)
      error = unit*(difference - 2.0_wp*pi*anint(difference/(2.0_wp*pi)))
      if (.not. present(slopes)) return
      sine = -side/sqrt((1.0_wp - c)*(1.0_wp + c))
      by = [-crank, (0.0_wp, -1.0_wp)*crank]
      slopes(:2) = aimag(by/v) + sine*(-0.5_wp*q(3)/r - 0.5_wp*c/m)*2.0_wp*real(conjg(v)*by, wp)
      slopes(3) = sine*(q(5)**2 - m)/(2.0_wp*r)
      slopes(4) = -1.0_wp
      slopes(5) = sine*(1.0_wp + q(5)*q(3))/r
      slopes = unit*slopes
   end subroutine error_of
end module psalm_minimax
