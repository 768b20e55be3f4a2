!> A link of beam elements with a slide: where its shoe is on the elements at each position, and how the link moves as it bends.
!>
!> The link bends in axes that turn with its pin (or that its pins hold); its slide gives way in them by what it is displaced across
!> its line at the shoe, and turned there, so that these axes, and all bodies, move besides. With shapes phi in these axes it
!> moves by U = phi + R c, R its rigid motions and c(position) those of its axes by the shapes. The inertia of U q adds
!> 2 U' M R c' to the damping, and U' M R c'' to the stiffness, by the theorem of derivatives of a product.
module psalm_flex_slide
   use psalm_beam_elements, only: beam_frame_t, element_t, freedoms, ends, shapes, turn_of_element, places_of
   use psalm_flexible_cycle, only: flexible_cycle_t
   use psalm_kinds, only: wp
   use psalm_lapack, only: natural_modes
   use psalm_linear, only: along_columns, product_of
   use psalm_periodic, only: periodic_t, periodic_from_samples
   implicit none (type, external)
   private
   public :: shoe_place_t, place_shoe, rigid_motions, rates_of, supported_frequencies, rigid_freedoms

   integer, parameter :: rigid_freedoms = 3      !! of the axes: displacement x and y, turning
   integer, parameter :: basis = 40              !! shapes, the slowest, by which the frequencies over the turn are found

   !> The shoe on an element.
   type :: shoe_place_t
      integer :: element = 0
      real(wp) :: part = 0.0_wp                  !! of the element
      real(wp) :: off = 0.0_wp                   !! distance from it, m
      integer :: places(ends) = 0                !! freedoms of the frame
      real(wp) :: moved(rigid_freedoms, ends) = 0.0_wp !! displacement x, y and turning of the shoe by them, in the frame's axes
      real(wp) :: across(ends) = 0.0_wp          !! displacement across the line of the slide by them
   end type shoe_place_t

contains

   !> The shoe at each position of a turn.
   pure function place_shoe(frame, cycle_of) result(shoes)
      type(beam_frame_t), intent(in) :: frame
      type(flexible_cycle_t), intent(in) :: cycle_of
      type(shoe_place_t), allocatable :: shoes(:)
      real(wp) :: shape(2, ends), slope(ends), bend(ends), stretch(ends), part, off, d(2), arm(2), turn(ends, ends)
      integer :: n, e

      allocate (shoes(size(cycle_of%shoe, 2)))
      do n = 1, size(shoes)
         associate (shoe => shoes(n), at => cycle_of%shoe(:, n))
            do e = 1, size(frame%elements)
               associate (element => frame%elements(e))
                  d = at - frame%x(:, element%nodes(1))
                  part = min(max(sum(d*element%along)/element%length, 0.0_wp), 1.0_wp)
                  off = sqrt(sum((d - part*element%length*element%along)**2))
                  if (shoe%element > 0 .and. off >= shoe%off) cycle
                  shoe%element = e
                  shoe%part = part
                  shoe%off = off
               end associate
            end do
            associate (element => frame%elements(shoe%element))
               call shapes(shoe%part, element%length, shape, slope, bend, stretch)
               turn = turn_of_element(element)
               shoe%places = places_of(element)
               shoe%moved(1, :) = shape(1, :)*element%along(1) - shape(2, :)*element%along(2)
               shoe%moved(2, :) = shape(1, :)*element%along(2) + shape(2, :)*element%along(1)
               shoe%moved(3, :) = slope
               shoe%moved = product_of(shoe%moved, turn)
               ! on a rigid bracket, if beside it
               arm = at - frame%x(:, element%nodes(1)) - shoe%part*element%length*element%along
               shoe%moved(1, :) = shoe%moved(1, :) - arm(2)*shoe%moved(3, :)
               shoe%moved(2, :) = shoe%moved(2, :) + arm(1)*shoe%moved(3, :)
               shoe%across = cycle_of%normal(1, n)*shoe%moved(1, :) + cycle_of%normal(2, n)*shoe%moved(2, :)
            end associate
         end associate
      end do
   end function place_shoe

   !> Displacements of a frame by rigid motions of its axes. Shape of the result: (freedoms of the frame, 3).
   pure function rigid_motions(frame) result(r)
      type(beam_frame_t), intent(in) :: frame
      real(wp) :: r(freedoms*size(frame%x, 2), rigid_freedoms)
      integer :: k

      r = 0.0_wp
      do k = 1, size(frame%x, 2)
         r(freedoms*(k - 1) + 1, 1) = 1.0_wp
         r(freedoms*(k - 1) + 2, 2) = 1.0_wp
         r(freedoms*(k - 1) + 1:freedoms*k, 3) = [-frame%x(2, k), frame%x(1, k), 1.0_wp]
      end do
   end function rigid_motions

   !> Derivatives by the input in radians of numbers over a turn. Shapes: (.., .., positions).
   pure subroutine rates_of(values, first, second)
      real(wp), intent(in) :: values(:, :, :)
      real(wp), intent(out) :: first(:, :, :), second(:, :, :)
      type(periodic_t) :: of, rate
      integer :: i, j

      do j = 1, size(values, 2)
         do i = 1, size(values, 1)
            of = periodic_from_samples(values(i, j, :))
            rate = of%derivative(1)
            first(i, j, :) = rate%values(size(values, 3))
            rate = of%derivative(2)
            second(i, j, :) = rate%values(size(values, 3))
         end do
      end do
   end subroutine rates_of

   !> Natural frequencies at rest of a link alone that its pins and its slide hold, at each position.
   subroutine supported_frequencies(frame, free, shoes, by_slide, frequencies, ok)
      type(beam_frame_t), intent(in) :: frame    !! with its concentrated masses
      logical, intent(in) :: free(:)             !! shape (freedoms of the frame): not held in the axes
      type(shoe_place_t), intent(in) :: shoes(:)
      real(wp), intent(in) :: by_slide(:, :, :)  !! shape (3, 2, positions): of the axes, by the displacement across at the shoe and
                                                 !! the turning there
      real(wp), intent(inout) :: frequencies(:, :) !! rad/s
      logical, intent(out) :: ok
      real(wp), allocatable, dimension(:, :) :: all_shapes, modes, mass, c, own, r, with_rigid, of_rigid, stiffness, vectors
      real(wp) :: squares(count(free)), two(2)
      real(wp), allocatable :: found(:)
      integer, allocatable :: places(:)
      integer :: j, n, m, many

      places = pack([(j, j=1, size(free))], free)
      n = size(places)
      m = min(basis, n)
      allocate (all_shapes(n, n), modes(size(free), m), stiffness(m, m), own(rigid_freedoms, m), c(rigid_freedoms, m), &
                vectors(m, m), found(m), source=0.0_wp)
      call natural_modes(frame%mass(places, places), frame%stiffness(places, places), squares, all_shapes, ok)
      if (.not. ok) return
      do j = 1, m
         modes(places, j) = all_shapes(:, n + 1 - j)/sqrt(sum(along_columns(frame%mass(places, places), &
                                                                            all_shapes(:, n + 1 - j))*all_shapes(:, n + 1 - j)))
         stiffness(j, j) = 1.0_wp/squares(n + 1 - j)
      end do
      r = rigid_motions(frame)
      with_rigid = product_of(transpose(r), product_of(frame%mass, modes))
      of_rigid = product_of(transpose(r), product_of(frame%mass, r))
      many = min(size(frequencies, 1), m)
      do n = 1, size(shoes)
         do j = 1, m
            two = [sum(shoes(n)%across*modes(shoes(n)%places, j)), sum(shoes(n)%moved(3, :)*modes(shoes(n)%places, j))]
            c(:, j) = by_slide(:, 1, n)*two(1) + by_slide(:, 2, n)*two(2)
         end do
         own = with_rigid + product_of(of_rigid, c)
         mass = product_of(transpose(with_rigid), c) + product_of(transpose(c), own)
         do j = 1, m
            mass(j, j) = mass(j, j) + 1.0_wp
         end do
         ! for the inverse squares
         call natural_modes(mass, stiffness, found, vectors, ok)
         if (ok) ok = found(m - many + 1) > 0.0_wp
         if (.not. ok) return
         frequencies(:many, n) = 1.0_wp/sqrt(found(m:m - many + 1:-1))
      end do
   end subroutine supported_frequencies
end module psalm_flex_slide
