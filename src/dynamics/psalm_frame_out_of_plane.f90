!> Plane frames of beam elements that move out of their plane: bending (slender, Euler and Bernoulli) and twist (Saint-Venant),
!> which are coupled where elements meet at an angle; and what forces and moments in the plane add to their stiffness.
!>
!> A node has the displacement w out of the plane and small turnings about the x and y axes of the frame. Along an element, in the
!> direction t, with n = z x t, w is a cubic of Hermite with the slope w' = -(turning about n), and the twist phi, the turning about
!> t, is straight.
!>
!> What a pull N and a moment M in the plane add follows from the strains of a rod with exact rotations, r' = t + w' z and the
!> rotation exp(turning x): to second order they are w'**2/2 along t, w' phi/2 along n, and (phi w'' - w' phi')/2 about z. With the
!> shear force -M' their work is N w'**2/2 + M phi w'', and -M w' phi/2 at the ends of an element. The turnings are those of the
!> nodes, so that moments that balance there do no work of second order at a corner. A pull adds N (polar radius)**2 phi'**2/2.
!> Sources: Simo and Vu-Quoc (1986), Computer Methods in Applied Mechanics and Engineering 58; Argyris, Hilpert, Malejannakis and
!> Scharpf (1979), the same 20; Timoshenko and Gere (1961), Theory of Elastic Stability, chapter 6.
module psalm_frame_out_of_plane
   use psalm_beam_elements, only: beam_frame_t, element_t, gauss_points, gauss_places, gauss_weights
   use psalm_kinds, only: wp, pi
   use psalm_linear, only: along_columns, product_of
   implicit none (type, external)
   private
   public :: out_frame_t, assemble_out_of_plane, prestressed, turning_under, torsion_of_rectangle, torsion_of_solid

   integer, parameter, public :: out_freedoms = 3    !! of a node: displacement out of the plane, turning about x and y
   integer, parameter :: ends = 2*out_freedoms       !! of an element: w, twist, slope at each node
   integer, parameter :: prestresses = 4             !! pull at both nodes, moment at both
   integer, parameter :: torsion_terms = 9           !! of the series; the next is below 1E-6 of the whole

   !> A frame that is assembled in its plane, out of it. SI units.
   type :: out_frame_t
      real(wp), allocatable :: stiffness(:, :), mass(:, :) !! shape (out_freedoms*nodes, the same)
      real(wp), allocatable :: twist(:, :)       !! the part of the mass by twist, of the same shape
      real(wp), allocatable :: turn(:, :, :)     !! shape (ends, ends, elements): from the frame's axes to the element's
      real(wp), allocatable :: taut(:, :, :, :)  !! shape (ends, ends, prestresses, elements): stiffness by unit pull at each node,
                                                 !! falling to 0 at the other, and by unit moment, in the element's axes
      integer, allocatable :: places(:, :)       !! shape (ends, elements): freedoms of the frame
   end type out_frame_t

contains

   !> Matrices of all elements, and of the frame.
   pure subroutine assemble_out_of_plane(frame, out)
      type(beam_frame_t), intent(in) :: frame    !! assembled
      type(out_frame_t), intent(out) :: out
      real(wp), dimension(ends, ends) :: stiffness, mass, twist
      integer :: n, e, i, k, many

      n = out_freedoms*size(frame%x, 2)
      many = size(frame%elements)
      allocate (out%stiffness(n, n), out%mass(n, n), out%twist(n, n), out%turn(ends, ends, many), &
                out%taut(ends, ends, prestresses, many), source=0.0_wp)
      allocate (out%places(ends, many))
      do e = 1, many
         associate (element => frame%elements(e), turn => out%turn(:, :, e), places => out%places(:, e))
            do k = 0, 1
               do i = 1, out_freedoms
                  places(out_freedoms*k + i) = out_freedoms*(element%nodes(k + 1) - 1) + i
               end do
               turn(out_freedoms*k + 1, out_freedoms*k + 1) = 1.0_wp
               turn(out_freedoms*k + 2, out_freedoms*k + 2:out_freedoms*k + 3) = element%along
               turn(out_freedoms*k + 3, out_freedoms*k + 2:out_freedoms*k + 3) = [element%along(2), -element%along(1)]
            end do
            call form(element, stiffness, mass, twist, out%taut(:, :, :, e))
            out%stiffness(places, places) = out%stiffness(places, places) + back(turn, stiffness)
            out%mass(places, places) = out%mass(places, places) + back(turn, mass)
            out%twist(places, places) = out%twist(places, places) + back(turn, twist)
         end associate
      end do
   end subroutine assemble_out_of_plane

   pure function back(turn, own) result(outer)
      real(wp), intent(in) :: turn(ends, ends), own(ends, ends)
      real(wp) :: outer(ends, ends)

      outer = product_of(transpose(turn), product_of(own, turn))
   end function back

   !> Matrices of one element in its own axes.
   pure subroutine form(element, stiffness, mass, twist, taut)
      type(element_t), intent(in) :: element
      real(wp), intent(out) :: stiffness(ends, ends), mass(ends, ends), twist(ends, ends), taut(ends, ends, prestresses)
      real(wp), dimension(ends) :: across, slope, bend, turned, twisted
      real(wp) :: weight, of_node(2), polar
      integer :: g, i, j

      stiffness = 0.0_wp
      mass = 0.0_wp
      twist = 0.0_wp
      taut = 0.0_wp
      do g = 1, gauss_points
         associate (s => gauss_places(g), l => element%length, section => element%at(g))
            across = [1.0_wp - 3.0_wp*s**2 + 2.0_wp*s**3, 0.0_wp, l*s*(1.0_wp - s)**2, &
                      3.0_wp*s**2 - 2.0_wp*s**3, 0.0_wp, l*s**2*(s - 1.0_wp)]
            slope = [-6.0_wp*s*(1.0_wp - s)/l, 0.0_wp, (1.0_wp - s)*(1.0_wp - 3.0_wp*s), &
                     6.0_wp*s*(1.0_wp - s)/l, 0.0_wp, s*(3.0_wp*s - 2.0_wp)]
            bend = [(12.0_wp*s - 6.0_wp)/l**2, 0.0_wp, (6.0_wp*s - 4.0_wp)/l, &
                    (6.0_wp - 12.0_wp*s)/l**2, 0.0_wp, (6.0_wp*s - 2.0_wp)/l]
            turned = [0.0_wp, 1.0_wp - s, 0.0_wp, 0.0_wp, s, 0.0_wp]
            twisted = [0.0_wp, -1.0_wp, 0.0_wp, 0.0_wp, 1.0_wp, 0.0_wp]/l
            weight = gauss_weights(g)*l
            of_node = [1.0_wp - s, s]
            polar = section%polar/section%area
            do j = 1, ends
               do i = 1, ends
                  stiffness(i, j) = stiffness(i, j) + weight*(element%modulus*section%across*bend(i)*bend(j) &
                                                              + element%shear*section%torsion*twisted(i)*twisted(j))
                  mass(i, j) = mass(i, j) + weight*element%density*section%area*across(i)*across(j)
                  twist(i, j) = twist(i, j) + weight*element%density*section%polar*turned(i)*turned(j)
                  taut(i, j, :2) = taut(i, j, :2) + weight*of_node*(slope(i)*slope(j) + polar*twisted(i)*twisted(j))
                  taut(i, j, 3:) = taut(i, j, 3:) + weight*of_node*(turned(i)*bend(j) + bend(i)*turned(j))
               end do
            end do
         end associate
      end do
      mass = mass + twist
      ! -M w' phi/2 at the ends, outwards
      taut(2, 3, 3) = taut(2, 3, 3) + 0.5_wp
      taut(3, 2, 3) = taut(3, 2, 3) + 0.5_wp
      taut(5, 6, 4) = taut(5, 6, 4) - 0.5_wp
      taut(6, 5, 4) = taut(6, 5, 4) - 0.5_wp
   end subroutine form

   !> What pulls and moments in the plane add to the stiffness, times columns of displacements. Shape of the result: as columns.
   pure function prestressed(out, pull, moment, columns) result(loads)
      type(out_frame_t), intent(in) :: out
      real(wp), intent(in) :: pull(:, :), moment(:, :) !! shape (2, elements): at the nodes, N; N m, about z on the part behind
      real(wp), intent(in) :: columns(:, :)      !! shape (out_freedoms*nodes, columns)
      real(wp) :: loads(size(columns, 1), size(columns, 2)), own(ends), k(ends, ends)
      integer :: e, j

      loads = 0.0_wp
      do e = 1, size(out%places, 2)
         associate (places => out%places(:, e), taut => out%taut(:, :, :, e), turn => out%turn(:, :, e))
            k = pull(1, e)*taut(:, :, 1) + pull(2, e)*taut(:, :, 2) + moment(1, e)*taut(:, :, 3) + moment(2, e)*taut(:, :, 4)
            k = back(turn, k)
            do j = 1, size(columns, 2)
               own = along_columns(k, columns(places, j)) ! k is symmetric
               loads(places, j) = loads(places, j) + own
            end do
         end associate
      end do
   end function prestressed

   !> Stiffness against turning about x and y by a force in the plane on a rigid bracket at a node: its point moves in the plane by
   !> turning x (turning x reach)/2. Shape of the result: (2, 2).
   pure function turning_under(force, reach) result(k)
      real(wp), intent(in) :: force(2), reach(2) !! N, m
      real(wp) :: k(2, 2)
      integer :: i, j

      do j = 1, 2
         do i = 1, 2
            k(i, j) = -0.5_wp*(force(i)*reach(j) + reach(i)*force(j))
         end do
         k(j, j) = k(j, j) + sum(force*reach)
      end do
   end function turning_under

   !> Torsion constant of a rectangle, by Saint-Venant's series, m4.
   elemental real(wp) function torsion_of_rectangle(depth, width) result(torsion)
      real(wp), intent(in) :: depth, width       !! m
      real(wp) :: long, short, rest
      integer :: n

      long = max(depth, width)
      short = min(depth, width)
      rest = 0.0_wp
      do n = 2*torsion_terms - 1, 1, -2
         rest = rest + tanh(0.5_wp*real(n, wp)*pi*long/short)/real(n, wp)**5
      end do
      torsion = long*short**3/3.0_wp*(1.0_wp - 192.0_wp/pi**5*short/long*rest)
   end function torsion_of_rectangle

   !> Torsion constant of a solid section, by Saint-Venant's estimate area**4/(40 polar), m4: of a circle 1.3 per cent low.
   elemental real(wp) function torsion_of_solid(area, polar) result(torsion)
      real(wp), intent(in) :: area, polar        !! m2; second moment about the axis, m4

      torsion = area**4/(40.0_wp*polar)
   end function torsion_of_solid
end module psalm_frame_out_of_plane
