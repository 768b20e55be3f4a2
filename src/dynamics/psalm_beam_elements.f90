!> Plane frames of beam elements: bending (slender, Euler and Bernoulli) and stretching, sections that vary along an element,
!> rigidly joined at nodes; concentrated masses, loads and springs on rigid brackets.
!>
!> Hermite's cubics across an element, a straight line along it; integrals by Gauss's formula with four points, which is exact
!> for uniform sections and linear loads. Sources: Przemieniecki (1968), Theory of Matrix Structural Analysis; the terms of a
!> moving frame of reference follow from the acceleration a + turning x (r + u) - speed**2 (r + u) + 2 speed x u' + u''.
module psalm_beam_elements
   use psalm_axes, only: into_axes
   use psalm_kinds, only: wp
   use psalm_linear, only: along_columns, product_of
   implicit none (type, external)
   private
   public :: shapes, places_of, turn_of_element
   public :: beam_frame_t, element_t, station_t, assemble, freedoms_of, local_load, tension_stiffness, bracket_of, mass_of_frame

   integer, parameter, public :: freedoms = 3          !! of a node: displacement x and y, turning
   integer, parameter, public :: ends = 2*freedoms     !! of an element
   integer, parameter, public :: gauss_points = 4      !! of an element
   integer, parameter, public :: motions = 4           !! that load a frame: acceleration x, y less gravity, turning, squared speed

   real(wp), parameter :: inner = 0.339981043584856264802665759103244687_wp, outer = 0.861136311594052575223946488892809505_wp
   real(wp), parameter, public :: gauss_places(gauss_points) = 0.5_wp*(1.0_wp + [-outer, -inner, inner, outer]) !! from 0 to 1
   real(wp), parameter :: of_inner = 0.326072577431273071313468025389000773_wp
   real(wp), parameter, public :: gauss_weights(gauss_points) = [0.5_wp - of_inner, of_inner, of_inner, 0.5_wp - of_inner]

   !> The section at one place of an element.
   type :: station_t
      real(wp) :: area = 0.0_wp        !! m2
      real(wp) :: inertia = 0.0_wp     !! second moment of area in the plane, m4
      real(wp) :: depth = 0.0_wp       !! m; 0: not known
      real(wp) :: across = 0.0_wp      !! second moment of area out of the plane, m4
      real(wp) :: polar = 0.0_wp       !! about the axis: the sum of both, m4
      real(wp) :: torsion = 0.0_wp     !! torsion constant, m4
   end type station_t

   type :: element_t
      integer :: nodes(2) = 0
      integer :: segment = 0           !! it belongs to
      real(wp) :: from = 0.0_wp, to = 0.0_wp !! part of the segment at its nodes
      real(wp) :: modulus = 0.0_wp, density = 0.0_wp !! Pa, kg/m3
      real(wp) :: shear = 0.0_wp       !! modulus of it, Pa
      type(station_t) :: at(gauss_points), node(2) !! sections
      ! found by `assemble`
      real(wp) :: length = 0.0_wp, along(2) = [1.0_wp, 0.0_wp] !! m; direction in the frame's axes
      real(wp) :: stiffness(ends, ends) = 0.0_wp, mass(ends, ends) = 0.0_wp !! in the element's own axes
      real(wp) :: motion(ends, motions) = 0.0_wp !! load of unit motions, in its own axes
      real(wp) :: taut(ends, ends, 2) = 0.0_wp   !! stiffness by unit tension at each node, falling to 0 at the other
   end type element_t

   !> A frame in axes of its own, SI units.
   type :: beam_frame_t
      real(wp), allocatable :: x(:, :) !! shape (2, nodes)
      type(element_t), allocatable :: elements(:)
      real(wp), allocatable :: stiffness(:, :), mass(:, :) !! shape (freedoms*nodes, the same)
      real(wp), allocatable :: spin(:, :) !! of 2 speed u' and turning u: shape as mass, antisymmetric
      real(wp), allocatable :: motion(:, :) !! load of unit motions: shape (freedoms*nodes, motions)
   end type beam_frame_t

contains

   !> Allocate for nodes and elements that are there.
   pure subroutine size_frame(frame)
      type(beam_frame_t), intent(inout) :: frame
      integer :: n

      n = freedoms*size(frame%x, 2)
      allocate (frame%stiffness(n, n), frame%mass(n, n), frame%spin(n, n), frame%motion(n, motions), source=0.0_wp)
   end subroutine size_frame

   !> Matrices of all elements, and of the frame.
   pure subroutine assemble(frame)
      type(beam_frame_t), intent(inout) :: frame
      real(wp) :: turn(ends, ends), spin(ends, ends)
      integer :: e, places(ends)

      call size_frame(frame)
      do e = 1, size(frame%elements)
         associate (element => frame%elements(e))
            call form(element, frame%x(:, element%nodes), spin)
            turn = turn_of_element(element)
            places = places_of(element)
            frame%stiffness(places, places) = frame%stiffness(places, places) + back(element%stiffness)
            frame%mass(places, places) = frame%mass(places, places) + back(element%mass)
            frame%spin(places, places) = frame%spin(places, places) + back(spin)
            frame%motion(places, :) = frame%motion(places, :) + product_of(transpose(turn), element%motion)
         end associate
      end do

   contains

      pure function back(own) result(outer)
         real(wp), intent(in) :: own(ends, ends)
         real(wp) :: outer(ends, ends)

         outer = product_of(transpose(turn), product_of(own, turn))
      end function back
   end subroutine assemble

   !> Freedoms of an element in the frame.
   pure function places_of(element) result(places)
      type(element_t), intent(in) :: element
      integer :: places(ends)

      places = [freedoms_of(element%nodes(1)), freedoms_of(element%nodes(2))]
   end function places_of

   !> Freedoms of a node in the frame.
   pure function freedoms_of(node) result(places)
      integer, intent(in) :: node
      integer :: places(freedoms), i

      places = [(freedoms*(node - 1) + i, i=1, freedoms)]
   end function freedoms_of

   !> From the frame's axes to the element's.
   pure function turn_of_element(element) result(turn)
      type(element_t), intent(in) :: element
      real(wp) :: turn(ends, ends)
      integer :: i

      turn = 0.0_wp
      do i = 0, 1
         turn(freedoms*i + 1, freedoms*i + 1:freedoms*i + 2) = element%along
         turn(freedoms*i + 2, freedoms*i + 1:freedoms*i + 2) = [-element%along(2), element%along(1)]
         turn(freedoms*i + 3, freedoms*i + 3) = 1.0_wp
      end do
   end function turn_of_element

   !> Matrices of one element in its own axes.
   pure subroutine form(element, x, spin)
      type(element_t), intent(inout) :: element
      real(wp), intent(in) :: x(2, 2)            !! its nodes
      real(wp), intent(out) :: spin(ends, ends)
      real(wp) :: shape(2, ends), slope(ends), bend(ends), stretch(ends), place(2), r(2), weight, mass
      integer :: g, i, j

      element%length = sqrt(sum((x(:, 2) - x(:, 1))**2))
      element%along = (x(:, 2) - x(:, 1))/element%length
      element%stiffness = 0.0_wp
      element%mass = 0.0_wp
      element%motion = 0.0_wp
      element%taut = 0.0_wp
      spin = 0.0_wp
      do g = 1, gauss_points
         associate (s => gauss_places(g), l => element%length, section => element%at(g))
            call shapes(s, l, shape, slope, bend, stretch)
            weight = gauss_weights(g)*l
            mass = weight*element%density*section%area
            place = x(:, 1) + s*l*element%along
            ! in the element's axes
            r = into_axes(element%along, place)
            do j = 1, ends
               do i = 1, ends
                  element%stiffness(i, j) = element%stiffness(i, j) + weight*element%modulus* &
                                            (section%area*stretch(i)*stretch(j) + section%inertia*bend(i)*bend(j))
                  element%mass(i, j) = element%mass(i, j) + mass*(shape(1, i)*shape(1, j) + shape(2, i)*shape(2, j))
                  spin(i, j) = spin(i, j) + mass*(shape(2, i)*shape(1, j) - shape(1, i)*shape(2, j))
                  element%taut(i, j, :) = element%taut(i, j, :) + weight*slope(i)*slope(j)*[1.0_wp - s, s]
               end do
            end do
            ! -mass times the acceleration of a unit motion; the first two along the frame's axes
            element%motion(:, 1) = element%motion(:, 1) - mass*(shape(1, :)*element%along(1) - shape(2, :)*element%along(2))
            element%motion(:, 2) = element%motion(:, 2) - mass*(shape(1, :)*element%along(2) + shape(2, :)*element%along(1))
            element%motion(:, 3) = element%motion(:, 3) - mass*(shape(2, :)*r(1) - shape(1, :)*r(2))
            element%motion(:, 4) = element%motion(:, 4) + mass*(shape(1, :)*r(1) + shape(2, :)*r(2))
         end associate
      end do
   end subroutine form

   !> Shapes of the element at a part s of its length: displacement along and across, slope, curvature, strain.
   pure subroutine shapes(s, length, shape, slope, bend, stretch)
      real(wp), intent(in) :: s, length
      real(wp), intent(out) :: shape(2, ends), slope(ends), bend(ends), stretch(ends)

      shape = 0.0_wp
      shape(1, 1) = 1.0_wp - s
      shape(1, 4) = s
      shape(2, 2) = 1.0_wp - 3.0_wp*s**2 + 2.0_wp*s**3
      shape(2, 3) = length*s*(1.0_wp - s)**2
      shape(2, 5) = 3.0_wp*s**2 - 2.0_wp*s**3
      shape(2, 6) = length*s**2*(s - 1.0_wp)
      slope = [0.0_wp, -6.0_wp*s*(1.0_wp - s)/length, (1.0_wp - s)*(1.0_wp - 3.0_wp*s), 0.0_wp, 6.0_wp*s*(1.0_wp - s)/length, &
               s*(3.0_wp*s - 2.0_wp)]
      bend = [0.0_wp, (12.0_wp*s - 6.0_wp)/length**2, (6.0_wp*s - 4.0_wp)/length, 0.0_wp, (6.0_wp - 12.0_wp*s)/length**2, &
              (6.0_wp*s - 2.0_wp)/length]
      stretch = [-1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp, 0.0_wp]/length
   end subroutine shapes

   !> Displacements, or loads, of an element in its own axes. Shape of the result: (6).
   pure function local_load(element, of_frame) result(own)
      type(element_t), intent(in) :: element
      real(wp), intent(in) :: of_frame(:)        !! shape (freedoms*nodes)
      real(wp) :: own(ends)

      own = along_columns(transpose(turn_of_element(element)), of_frame(places_of(element)))
   end function local_load

   !> Stiffness that tension in an element adds between the columns of `shapes`: shape (columns, columns, 2), by unit tension at
   !> each node.
   pure function tension_stiffness(element, columns) result(k)
      type(element_t), intent(in) :: element
      real(wp), intent(in) :: columns(:, :)      !! shape (freedoms*nodes, columns)
      real(wp) :: k(size(columns, 2), size(columns, 2), 2), own(ends, size(columns, 2))
      integer :: j

      do j = 1, size(columns, 2)
         own(:, j) = local_load(element, columns(:, j))
      end do
      do j = 1, 2
         k(:, :, j) = product_of(transpose(own), product_of(element%taut(:, :, j), own))
      end do
   end function tension_stiffness

   !> Displacement of a point on a rigid bracket by the freedoms of its node. Shape of the result: (2, 3).
   pure function bracket_of(reach) result(b)
      real(wp), intent(in) :: reach(2)           !! from the node, m
      real(wp) :: b(2, freedoms)

      b(1, :) = [1.0_wp, 0.0_wp, -reach(2)]
      b(2, :) = [0.0_wp, 1.0_wp, reach(1)]
   end function bracket_of

   !> Mass, first moments, and moment of inertia about the origin of the frame's axes, of its elements: kg, kg m, kg m2.
   pure function mass_of_frame(frame) result(parameters)
      type(beam_frame_t), intent(in) :: frame         !! assembled, without concentrated masses
      real(wp) :: parameters(4)
      real(wp), dimension(size(frame%mass, 1)) :: ahead, turning
      integer :: n

      ahead = 0.0_wp
      turning = 0.0_wp
      do n = 1, size(frame%x, 2)
         ahead(freedoms*(n - 1) + 1) = 1.0_wp
         turning(freedoms_of(n)) = [-frame%x(2, n), frame%x(1, n), 1.0_wp]
      end do
      ! loads of unit motions are minus the inertia against them
      parameters(1) = -sum(ahead*frame%motion(:, 1))
      parameters(2) = -sum(turning*frame%motion(:, 2))
      parameters(3) = sum(turning*frame%motion(:, 1))
      parameters(4) = -sum(turning*frame%motion(:, 3))
   end function mass_of_frame
end module psalm_beam_elements
