!> Vibration and buckling of a link of beam elements out of the plane of its linkage (group FLEX). Data in, results out.
!>
!> Out of the plane nothing loads a plane linkage whose links are symmetric about it: the link has natural modes of bending and
!> twist, and the pulls and moments of the plane, as they change over the turn, make its equations Hill's. Where a multiplier is
!> beyond 1, or the stiffness is not positive, it leaves the plane. What the modes that are not solved give way is taken from
!> statics: a slender link twists at once as it bends aside. The axis of a pin is normal to the plane. Every pin holds the link in
!> the plane; a long bearing also holds its turnings about both axes in the plane at those of its neighbour, whose give out of the
!> plane is left out; a short one holds neither. A link whose short pins are all on a line is held against turning about this line
!> by the first of those that hold it. A link that is clamped in the plane is clamped out of it. Source: Oldham, 15.3; simple
!> supports are Haines's rule (2M).
module psalm_out_of_plane_study
   use psalm_coupled_hill, only: coupled_t, solve_coupled
   use psalm_data_set, only: data_set_t
   use psalm_dense, only: factors_t, factorise, solve
   use psalm_flex_group, only: flex_group_t
   use psalm_flexible_cycle, only: flexible_cycle_t
   use psalm_flexible_link, only: flexible_link_t, attached_t
   use psalm_frame_out_of_plane, only: out_frame_t, assemble_out_of_plane, prestressed, turning_under, out_freedoms
   use psalm_kinds, only: wp, full_turn
   use psalm_lapack, only: natural_modes, hermitian_eigenvalues
   use psalm_linear, only: along_columns, product_of
   use psalm_periodic, only: periodic_t, periodic_constant, periodic_from_samples
   implicit none (type, external)
   private
   public :: out_of_plane_t, prestress_t, find_out_of_plane

   real(wp), parameter :: tolerance = 1.0e-8_wp  !! of a period's matrix
   real(wp), parameter :: shortest = 1.0e-15_wp  !! s/rad, of a mode that has a meaning
   real(wp), parameter :: rounding = 1.0e-12_wp  !! a part of the energy below it is none
   real(wp), parameter :: far_above = 1000.0_wp  !! times the speed: modes so fast follow at once
   real(wp), parameter :: shifted_by = 4.0_wp    !! times as far the squared frequencies are lifted where that was not enough,
   integer, parameter :: most_shifts = 20        !! so often
   real(wp), parameter :: on_a_line = 1.0e-6_wp  !! of the size of the link: joints so near to a line are on it

   !> What the plane motion does to the elements at each position.
   type :: prestress_t
      real(wp), allocatable :: pull(:, :, :)     !! shape (2, elements, positions): at the nodes of an element, N
      real(wp), allocatable :: moment(:, :, :)   !! the same, N m: about z, on the part behind
      real(wp), allocatable :: motion(:, :)      !! shape (4, positions): signals of the unit motions of the frame
   end type prestress_t

   type :: out_of_plane_t
      logical :: left_out = .false.              !! the link has a slide: it is not studied
      logical :: solved = .false.                !! the modes were found
      logical :: long_pins = .false.             !! they hold slope and twist
      logical :: line_held = .false.             !! the joints are on a line, about which the link is held
      real(wp), allocatable :: frequency(:)      !! shape (modes): at rest, rad/s
      real(wp), allocatable :: damping(:)        !! shape (modes): part of the critical one
      real(wp), allocatable :: twist(:)          !! shape (modes): part of their energy that is twist
      integer :: solved_modes = 0                !! the first modes, which are solved together; 0: the speed is far below all
      type(coupled_t) :: coupled                 !! what becomes of these
      real(wp) :: resolution = 0.0_wp            !! what the positions leave open of the coefficients
      real(wp) :: least_stiffness = 0.0_wp       !! least squared frequency over that at rest: below 0 the link buckles
      real(wp) :: least_at = 0.0_wp              !! input there, degrees
   contains
      procedure :: is_steady
   end type out_of_plane_t

contains

   !> True if the link stays in the plane.
   pure logical function is_steady(self)
      class(out_of_plane_t), intent(in) :: self

      is_steady = self%solved .and. self%least_stiffness > 0.0_wp
      if (self%solved_modes > 0) is_steady = is_steady .and. (self%coupled%stable .or. (self%coupled%neutral .and. &
                                                                                       self%coupled%unique))
   end function is_steady

   !> Study a link whose motion in the plane is known. `out%solved` is false where stiffness and mass give no frequency.
   subroutine find_out_of_plane(set, flex, link, cycle_of, prestress, out)
      type(data_set_t), intent(in) :: set
      type(flex_group_t), intent(in) :: flex
      type(flexible_link_t), intent(in) :: link
      type(flexible_cycle_t), intent(in) :: cycle_of
      type(prestress_t), intent(in) :: prestress
      type(out_of_plane_t), intent(out) :: out
      type(out_frame_t) :: frame
      real(wp), allocatable :: shapes(:, :)      ! shape (freedoms of the frame, modes): of unit mass
      logical, allocatable :: free(:)

      out%long_pins = flex%long_pins
      allocate (out%frequency(0), out%damping(0), out%twist(0))
      out%left_out = link%slide > 0
      if (out%left_out) return
      call assemble_out_of_plane(link%frame, frame)
      call add_masses(set, link, frame)
      call hold(link, out, free)
      call find_modes(flex, frame, free, out, shapes)
      if (.not. out%solved) return
      call follow_turn(set, flex, link, cycle_of, prestress, frame, free, shapes, out)
   end subroutine find_out_of_plane

   !> Concentrated masses on rigid brackets. A body that is thin in the plane has half its moment of inertia about each axis in it.
   pure subroutine add_masses(set, link, frame)
      type(data_set_t), intent(in) :: set
      type(flexible_link_t), intent(in) :: link
      type(out_frame_t), intent(inout) :: frame
      real(wp) :: b(out_freedoms), mass
      integer :: k, i, j, first

      do k = 1, size(link%masses)
         associate (of => link%masses(k))
            mass = set%masses%mass(of%entry)
            b = bracket_of(of%reach)
            first = out_freedoms*(of%node - 1)
            do j = 1, out_freedoms
               do i = 1, out_freedoms
                  frame%mass(first + i, first + j) = frame%mass(first + i, first + j) + mass*b(i)*b(j)
               end do
               if (j > 1) frame%mass(first + j, first + j) = frame%mass(first + j, first + j) &
                                                             + 0.5_wp*set%masses%inertia(of%entry)
            end do
         end associate
      end do
   end subroutine add_masses

   !> Displacement of a point on a rigid bracket by the freedoms of its node.
   pure function bracket_of(reach) result(b)
      real(wp), intent(in) :: reach(2)           !! m
      real(wp) :: b(out_freedoms)

      b = [1.0_wp, reach(2), -reach(1)]
   end function bracket_of

   !> Freedoms that the joints do not hold. Shape of the result: (freedoms of the frame).
   subroutine hold(link, out, free)
      type(flexible_link_t), intent(in) :: link
      type(out_of_plane_t), intent(inout) :: out
      logical, allocatable, intent(out) :: free(:)
      integer :: j, first

      allocate (free(out_freedoms*size(link%frame%x, 2)), source=.true.)
      do j = 1, size(link%nodes)
         first = out_freedoms*(link%nodes(j) - 1)
         free(first + 1) = .false.
         if (out%long_pins) free(first + 2:first + 3) = .false.
      end do
      first = out_freedoms*(link%held(1) - 1)
      if (link%held(2) == 0) then
         free(first + 1:first + 3) = .false.
      else if (.not. out%long_pins) then
         ! the x axis leads through both joints that hold the link
         out%line_held = all(abs(link%frame%x(2, link%nodes)) <= on_a_line*maxval(abs(link%frame%x)))
         if (out%line_held) free(first + 2) = .false.
      end if
   end subroutine hold

   !> Natural modes at rest, of unit mass, with their damping.
   subroutine find_modes(flex, frame, free, out, shapes)
      type(flex_group_t), intent(in) :: flex
      type(out_frame_t), intent(in) :: frame
      logical, intent(in) :: free(:)
      type(out_of_plane_t), intent(inout) :: out
      real(wp), allocatable, intent(out) :: shapes(:, :)
      real(wp) :: squares(count(free)), all_shapes(count(free), count(free)), moved(count(free))
      integer, allocatable :: places(:)
      integer :: j, n, modes

      places = pack([(j, j=1, size(free))], free)
      n = size(places)
      modes = min(flex%modes, n)
      if (modes == 0) return
      ! for the inverse squares, as in the plane
      call natural_modes(frame%mass(places, places), frame%stiffness(places, places), squares, all_shapes, out%solved)
      if (out%solved) out%solved = squares(n - modes + 1) > shortest**2
      if (.not. out%solved) return
      allocate (shapes(size(free), modes), source=0.0_wp)
      deallocate (out%twist)
      allocate (out%twist(modes))
      do j = 1, modes
         associate (shape => all_shapes(:, n + 1 - j))
            moved = along_columns(frame%mass(places, places), shape)
            shapes(places, j) = shape/sqrt(sum(moved*shape))
         end associate
         out%twist(j) = sum(shapes(:, j)*along_columns(frame%twist, shapes(:, j)))
         if (out%twist(j) < rounding) out%twist(j) = 0.0_wp
      end do
      out%frequency = 1.0_wp/sqrt(squares(n:n - modes + 1:-1))
      out%damping = flex%damping + 0.5_wp*(flex%by_mass/out%frequency + flex%by_stiffness*out%frequency)
   end subroutine find_modes

   !> Stiffness over the turn, and what becomes of the modes.
   subroutine follow_turn(set, flex, link, cycle_of, prestress, frame, free, shapes, out)
      type(data_set_t), intent(in) :: set
      type(flex_group_t), intent(in) :: flex
      type(flexible_link_t), intent(in) :: link
      type(flexible_cycle_t), intent(in) :: cycle_of
      type(prestress_t), intent(in) :: prestress
      type(out_frame_t), intent(in) :: frame
      logical, intent(in) :: free(:)
      real(wp), intent(in) :: shapes(:, :)
      type(out_of_plane_t), intent(inout) :: out
      type(factors_t) :: factors
      real(wp), dimension(size(shapes, 1), size(shapes, 2)) :: loads, given_way
      real(wp), dimension(size(shapes, 2), size(shapes, 2)) :: by_modes
      real(wp), dimension(size(shapes, 2), size(shapes, 2), size(prestress%motion, 2)) :: stiffness
      complex(wp) :: matrix(size(shapes, 2), size(shapes, 2))
      real(wp) :: values(size(shapes, 2)), least(size(prestress%motion, 2)), first(size(least)), speed
      integer, allocatable :: places(:)
      integer :: n, i, j, modes, other
      logical :: ok

      speed = cycle_of%turn%crank%speed
      modes = size(shapes, 2)
      places = pack([(i, i=1, size(free))], free)
      call factorise(frame%stiffness(places, places), factors)
      given_way = 0.0_wp
      do n = 1, size(least)
         loads = prestressed(frame, prestress%pull(:, :, n), prestress%moment(:, :, n), shapes)
         call add_attached(set, link, cycle_of, prestress%motion(:, n), n, shapes, loads)
         by_modes = product_of(transpose(shapes), loads)
         first(n) = minval([(by_modes(i, i)/out%frequency(i)**2, i=1, modes)])
         do j = 1, modes
            given_way(places, j) = solve(factors, loads(places, j))
         end do
         ! less what the modes themselves give way
         do j = 1, modes
            given_way(:, j) = given_way(:, j) - along_columns(transpose(shapes), by_modes(:, j)/out%frequency**2)
         end do
         stiffness(:, :, n) = by_modes - product_of(transpose(loads), given_way)
         do i = 1, modes
            stiffness(i, i, n) = stiffness(i, i, n) + out%frequency(i)**2
         end do
         stiffness(:, :, n) = 0.5_wp*(stiffness(:, :, n) + transpose(stiffness(:, :, n)))
         matrix = cmplx(stiffness(:, :, n), kind=wp)
         call hermitian_eigenvalues(matrix, values, ok)
         least(n) = values(1)
      end do
      out%solved = all(abs(stiffness) <= huge(1.0_wp))
      if (.not. out%solved) return
      ! statics takes too much off where forces are far beyond the modes' stiffness, pulls too: look where the link is pressed most
      n = minloc(least, dim=1)
      other = minloc(first, dim=1)
      call find_least(set, link, cycle_of, prestress, frame, places, n, out%frequency(1)**2, least(n))
      if (other /= n) then
         call find_least(set, link, cycle_of, prestress, frame, places, other, out%frequency(1)**2, least(other))
         if (least(other) < least(n)) n = other
      end if
      out%least_stiffness = least(n)/out%frequency(1)**2
      out%least_at = cycle_of%turn%crank%input(n)
      out%solved_modes = count(out%frequency <= far_above*speed)
      if (out%solved_modes > 0) call solve_modes(flex, speed, stiffness, out)
   end subroutine follow_turn

   !> The least squared frequency at a position by all freedoms: with few modes `least` is too large.
   subroutine find_least(set, link, cycle_of, prestress, frame, places, n, at_rest, least)
      type(data_set_t), intent(in) :: set
      type(flexible_link_t), intent(in) :: link
      type(flexible_cycle_t), intent(in) :: cycle_of
      type(prestress_t), intent(in) :: prestress
      type(out_frame_t), intent(in) :: frame
      integer, intent(in) :: places(:)           !! freedoms that are not held
      integer, intent(in) :: n                   !! position
      real(wp), intent(in) :: at_rest            !! squared frequency without forces, 1/s2
      real(wp), intent(inout) :: least           !! 1/s2
      real(wp), allocatable, dimension(:, :) :: unit, stiffness, shapes
      real(wp) :: squares(size(places)), shift
      integer :: i, k
      logical :: ok

      allocate (unit(size(frame%mass, 1), size(places)), stiffness(size(frame%mass, 1), size(places)), &
                shapes(size(places), size(places)), source=0.0_wp)
      do i = 1, size(places)
         unit(places(i), i) = 1.0_wp
      end do
      stiffness = prestressed(frame, prestress%pull(:, :, n), prestress%moment(:, :, n), unit)
      call add_attached(set, link, cycle_of, prestress%motion(:, n), n, unit, stiffness)
      stiffness = stiffness + frame%stiffness(:, places)
      ! inverse squares of what is lifted above 0
      shift = at_rest + 2.0_wp*abs(least)
      do k = 1, most_shifts
         call natural_modes(frame%mass(places, places), stiffness(places, :) + shift*frame%mass(places, places), squares, &
                            shapes, ok)
         if (ok) then
            least = 1.0_wp/squares(size(squares)) - shift
            return
         end if
         shift = shifted_by*shift
      end do
   end subroutine find_least

   !> Multipliers of a turn.
   subroutine solve_modes(flex, speed, stiffness, out)
      type(flex_group_t), intent(in) :: flex
      real(wp), intent(in) :: speed              !! rad/s
      real(wp), intent(in) :: stiffness(:, :, :) !! shape (modes, modes, positions)
      type(out_of_plane_t), intent(inout) :: out
      type(periodic_t), dimension(out%solved_modes, out%solved_modes) :: c, k
      type(periodic_t) :: p(out%solved_modes)
      integer :: i, j

      do j = 1, out%solved_modes
         p(j) = periodic_constant(0.0_wp)
         do i = 1, out%solved_modes
            k(i, j) = periodic_from_samples(stiffness(i, j, :)/speed**2)
            c(i, j) = periodic_constant(0.0_wp)
         end do
         c(j, j) = periodic_constant(2.0_wp*out%damping(j)*out%frequency(j)/speed)
      end do
      out%resolution = k(1, 1)%resolution()
      call solve_coupled(c, k, p, tolerance, flex%points, out%coupled)
   end subroutine solve_modes

   !> What forces on brackets and springs add, at one position.
   subroutine add_attached(set, link, cycle_of, motion, n, shapes, loads)
      type(data_set_t), intent(in) :: set
      type(flexible_link_t), intent(in) :: link
      type(flexible_cycle_t), intent(in) :: cycle_of
      real(wp), intent(in) :: motion(:)          !! shape (4)
      integer, intent(in) :: n                   !! position
      real(wp), intent(in) :: shapes(:, :)
      real(wp), intent(inout) :: loads(:, :)
      type(attached_t), allocatable :: at(:)
      real(wp) :: place(2), force(2), across(2), amount
      integer :: k

      do k = 1, size(link%masses)
         associate (of => link%masses(k), mass => set%masses%mass(link%masses(k)%entry))
            place = link%frame%x(:, of%node) + of%reach
            force = -mass*[motion(1) - motion(3)*place(2) - motion(4)*place(1), &
                           motion(2) + motion(3)*place(1) - motion(4)*place(2)]
            call stiffen_turning(of%node, turning_under(force, of%reach))
         end associate
      end do
      at = [link%loads, link%springs]
      do k = 1, size(cycle_of%acting)
         associate (of => cycle_of%acting(k))
            force = [of%along(n), of%across(n)]
            call stiffen_turning(at(k)%node, turning_under(force, at(k)%reach))
            amount = sqrt(sum(force**2))
            if (of%spring == 0 .or. .not. amount > 0.0_wp) cycle
            ! across its pull a spring has the stiffness pull/length, in the plane and out of it
            across = [-force(2), force(1)]/amount
            call stiffen_point(at(k)%node, at(k)%reach, of%held(n, 1)*across(1)**2 + &
                               2.0_wp*of%held(n, 2)*across(1)*across(2) + of%held(n, 3)*across(2)**2)
         end associate
      end do

   contains

      subroutine stiffen_turning(node, stiffness)
         integer, intent(in) :: node
         real(wp), intent(in) :: stiffness(2, 2) !! N m/rad
         integer :: first

         first = out_freedoms*(node - 1)
         loads(first + 2:first + 3, :) = loads(first + 2:first + 3, :) + product_of(stiffness, shapes(first + 2:first + 3, :))
      end subroutine stiffen_turning

      subroutine stiffen_point(node, reach, stiffness)
         integer, intent(in) :: node
         real(wp), intent(in) :: reach(2), stiffness !! m, N/m
         real(wp) :: b(out_freedoms)
         integer :: first, j

         first = out_freedoms*(node - 1)
         b = bracket_of(reach)
         do j = 1, size(shapes, 2)
            loads(first + 1:first + 3, j) = loads(first + 1:first + 3, j) + stiffness*b*sum(b*shapes(first + 1:first + 3, j))
         end do
      end subroutine stiffen_point
   end subroutine add_attached
end module psalm_out_of_plane_study
