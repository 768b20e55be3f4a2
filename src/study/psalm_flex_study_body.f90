!> How a link of beam elements is solved. Only this knows what the group FLEX has.
submodule(psalm_flex_study) psalm_flex_study_body
   use psalm_beam_elements, only: beam_frame_t, freedoms, ends, motions, freedoms_of, local_load, tension_stiffness, bracket_of
   use psalm_coupled_hill, only: solve_coupled, without_mass
   use psalm_driven_masses, only: find_influence
   use psalm_dense, only: factors_t, factorise, solve
   use psalm_flex_group, only: flex_group_t, flex_of
   use psalm_flexible_link, only: attached_t
   use psalm_flexible_cycle, only: find_flexible_cycle, parts, part_inertia, part_fixed, part_damped, part_pushed
   use psalm_kinds, only: full_turn
   use psalm_lapack, only: natural_modes, hermitian_eigenvalues, solve_general
   use psalm_linear, only: along_columns, product_of
   use psalm_periodic, only: periodic_t, periodic_constant, periodic_from_samples
   use psalm_stop, only: is_to_end
   implicit none (type, external)

   real(wp), parameter :: tolerance = 1.0e-8_wp  !! of a period's matrix
   integer, parameter :: finer = 2               !! positions in a turn where masses vary, times those of the link
   real(wp), parameter :: shortest = 1.0e-15_wp  !! s/rad, of a mode that has a meaning
   real(wp), parameter :: far_above = 1000.0_wp  !! times the speed: modes so fast follow their loads at once

   !> What loads the link: each load by a signal over the turn.
   type :: link_loading_t
      real(wp), allocatable :: loads(:, :)       !! shape (freedoms of the frame, signals)
      real(wp), allocatable :: by_part(:, :, :)  !! shape (signals, positions, parts): by `part_...` of the cycle
      real(wp), allocatable :: signals(:, :)     !! shape (signals, positions): together; m/s2, rad/s2, 1/s2; N; N m
      real(wp), allocatable :: statics(:, :)     !! displacements by each load: shape as loads
      real(wp), allocatable :: end_forces(:, :, :) !! of the elements, by each load: shape (ends, elements, signals)
   end type link_loading_t

contains

   module procedure find_flex
      type(flex_group_t) :: flex
      type(link_loading_t) :: loading
      real(wp), allocatable :: shapes(:, :)      ! shape (freedoms of the frame, modes): of unit mass
      logical, allocatable :: free(:)
      real(wp) :: speed

      flex = flex_of(set)
      study%link = link
      allocate (study%frequency(0), study%damping(0), study%segments(0))
      speed = abs(set%rates%speed)
      call find_flexible_cycle(given, dimensions, model, link, flex%points, sign(1.0_wp, set%rates%speed), study%cycle)
      study%found = study%cycle%turn%failure > 0
      if (study%found .or. is_to_end(stop)) return
      call add_masses(set, study%link)
      free = free_of(study%link)
      call find_modes(flex, free, study, shapes)
      if (is_to_end(stop)) return
      study%found = .true.
      if (.not. study%solved) return
      call find_loading(speed, free, study, loading)
      call find_influence(given, dimensions, model, link, flex%points, sign(1.0_wp, set%rates%speed), study%influence)
      study%inertia = model%inertia
      call find_driven(shapes, study)
      study%solved_modes = count(study%frequency <= far_above*speed)
      if (study%driven(1) <= far_above*speed) study%solved_modes = max(1, study%solved_modes)
      if (study%solved_modes > 0) shapes = shapes(:, :study%solved_modes)
      call find_response(set, flex, speed, shapes, loading, study)
      if (.not. study%steady) return
      call add_vibration(speed, shapes, study, loading)
      call find_stresses(speed, shapes, loading, study)
   end procedure find_flex

   !> Concentrated masses into the matrices of the frame.
   subroutine add_masses(set, link)
      type(data_set_t), intent(in) :: set
      type(flexible_link_t), intent(inout) :: link
      real(wp) :: b(2, freedoms), place(2), mass
      integer :: k, i, j, at(freedoms)

      do k = 1, size(link%masses)
         associate (of => link%masses(k), frame => link%frame)
            mass = set%masses%mass(of%entry)
            b = bracket_of(of%reach)
            place = frame%x(:, of%node) + of%reach
            at = freedoms_of(of%node)
            do j = 1, freedoms
               do i = 1, freedoms
                  frame%mass(at(i), at(j)) = frame%mass(at(i), at(j)) + mass*(b(1, i)*b(1, j) + b(2, i)*b(2, j))
                  frame%spin(at(i), at(j)) = frame%spin(at(i), at(j)) + mass*(b(2, i)*b(1, j) - b(1, i)*b(2, j))
               end do
            end do
            frame%mass(at(3), at(3)) = frame%mass(at(3), at(3)) + set%masses%inertia(of%entry)
            frame%motion(at, 1) = frame%motion(at, 1) - mass*b(1, :)
            frame%motion(at, 2) = frame%motion(at, 2) - mass*b(2, :)
            frame%motion(at, 3) = frame%motion(at, 3) - mass*(b(2, :)*place(1) - b(1, :)*place(2))
            frame%motion(at(3), 3) = frame%motion(at(3), 3) - set%masses%inertia(of%entry)
            frame%motion(at, 4) = frame%motion(at, 4) + mass*(b(1, :)*place(1) + b(2, :)*place(2))
         end associate
      end do
   end subroutine add_masses

   !> Freedoms that are not held.
   pure function free_of(link) result(free)
      type(flexible_link_t), intent(in) :: link
      logical :: free(size(link%frame%mass, 1))

      free = .true.
      associate (first => freedoms*(link%held(1) - 1))
         free(first + 1:first + 2) = .false.
         if (link%held(2) == 0) then
            free(first + 3) = .false.
         else
            free(freedoms*(link%held(2) - 1) + 2) = .false.
         end if
      end associate
   end function free_of

   !> Natural modes at rest, of unit mass, with their damping.
   subroutine find_modes(flex, free, study, shapes)
      type(flex_group_t), intent(in) :: flex
      logical, intent(in) :: free(:)
      type(flex_study_t), intent(inout) :: study
      real(wp), allocatable, intent(out) :: shapes(:, :)
      real(wp) :: squares(count(free)), all_shapes(count(free), count(free)), shape(count(free))
      integer, allocatable :: places(:)
      integer :: j, n, modes

      places = pack([(j, j=1, size(free))], free)
      n = size(places)
      modes = min(flex%modes, n)
      associate (frame => study%link%frame)
         ! for the inverse squares, whose largest do not suffer from the fastest modes
         call natural_modes(frame%mass(places, places), frame%stiffness(places, places), squares, all_shapes, study%solved)
         if (study%solved) study%solved = squares(n - modes + 1) > shortest**2
         if (.not. study%solved) return
         allocate (shapes(size(free), modes), source=0.0_wp)
         do j = 1, modes
            shape = along_columns(frame%mass(places, places), all_shapes(:, n + 1 - j))
            shapes(places, j) = all_shapes(:, n + 1 - j)/sqrt(sum(shape*all_shapes(:, n + 1 - j)))
         end do
      end associate
      study%frequency = 1.0_wp/sqrt(squares(n:n - modes + 1:-1))
      study%damping = flex%damping + 0.5_wp*(flex%by_mass/study%frequency + flex%by_stiffness*study%frequency)
   end subroutine find_modes

   !> Loads and their signals, and what they do at rest.
   subroutine find_loading(speed, free, study, loading)
      real(wp), intent(in) :: speed              !! rad/s
      logical, intent(in) :: free(:)
      type(flex_study_t), intent(inout) :: study
      type(link_loading_t), intent(out) :: loading
      type(factors_t) :: factors
      integer, allocatable :: places(:)
      real(wp) :: own(ends)
      integer :: j, k, b, e, n, many

      associate (link => study%link, frame => study%link%frame, turn => study%cycle)
         many = motions + 2*size(link%joints) + freedoms*size(turn%acting)
         n = size(turn%turning)
         allocate (loading%loads(size(free), many), loading%statics(size(free), many), &
                   loading%end_forces(ends, size(frame%elements), many), source=0.0_wp)
         loading%loads(:, :motions) = frame%motion
         allocate (loading%by_part(many, n, parts), source=0.0_wp)
         loading%by_part(1:2, :, part_inertia) = turn%acceleration
         loading%by_part(3, :, part_inertia) = turn%turning
         loading%by_part(4, :, part_inertia) = turn%speed**2
         loading%by_part(1:2, :, part_fixed) = -turn%weight
         loading%by_part(1:3, :, part_pushed) = turn%pushed
         b = motions
         do j = 1, size(link%joints)
            do k = 1, 2
               loading%loads(freedoms*(link%nodes(j) - 1) + k, b + k) = 1.0_wp
               do e = 1, parts
                  loading%by_part(b + k, :, e) = turn%forces(k, j, e, :)
               end do
            end do
            b = b + 2
         end do
         do j = 1, size(turn%acting)
            call add_acting(j, b)
            b = b + freedoms
         end do
         loading%signals = speed**2*loading%by_part(:, :, part_inertia) + loading%by_part(:, :, part_fixed) + &
                           speed*loading%by_part(:, :, part_damped)
         study%equilibrium = unbalanced(frame, loading)
         places = pack([(k, k=1, size(free))], free)
         call factorise(frame%stiffness(places, places), factors)
         do b = 1, many
            if (all(abs(loading%signals(b, :)) <= 0.0_wp)) cycle
            loading%statics(places, b) = solve(factors, loading%loads(places, b))
            do e = 1, size(frame%elements)
               associate (element => frame%elements(e))
                  own = along_columns(element%stiffness, local_load(element, loading%statics(:, b)))
                  if (b <= motions) own = own - element%motion(:, b)
                  loading%end_forces(:, e, b) = own
               end associate
            end do
         end do
      end associate

   contains

      !> A load, or the end of a spring, in three signals.
      subroutine add_acting(j, before)
         integer, intent(in) :: j, before
         type(attached_t), allocatable :: at(:)
         real(wp) :: arms(2, freedoms)
         integer :: i

         associate (link => study%link, turn => study%cycle)
            associate (acting => turn%acting(j))
               at = [link%loads, link%springs]
               arms = bracket_of(at(j)%reach)
               do i = 1, freedoms
                  loading%loads(freedoms*(at(j)%node - 1) + i, before + 1:before + 2) = arms(:, i)
               end do
               loading%loads(freedoms*at(j)%node, before + 3) = 1.0_wp
               loading%by_part(before + 1, :, part_fixed) = acting%along
               loading%by_part(before + 2, :, part_fixed) = acting%across
               loading%by_part(before + 3, :, part_fixed) = acting%moment
            end associate
         end associate
      end subroutine add_acting
   end subroutine find_loading

   !> Sum of all forces over the largest force of a joint: the forces of joints balance inertia, weight and loads.
   pure real(wp) function unbalanced(frame, loading)
      type(beam_frame_t), intent(in) :: frame
      type(link_loading_t), intent(in) :: loading
      real(wp) :: sums(size(loading%signals, 1), 2), largest
      integer :: k, n

      sums = 0.0_wp
      do n = 1, size(frame%x, 2)
         do k = 1, 2
            sums(:, k) = sums(:, k) + loading%loads(freedoms*(n - 1) + k, :)
         end do
      end do
      largest = maxval(abs(loading%signals(motions + 1:, :)))
      unbalanced = 0.0_wp
      if (.not. largest > 0.0_wp) return
      do k = 1, 2
         unbalanced = max(unbalanced, maxval(abs(along_columns(loading%signals, sums(:, k))))/largest)
      end do
   end function unbalanced

   !> The steady motion of all modes together.
   subroutine find_response(set, flex, speed, shapes, loading, study)
      type(data_set_t), intent(in) :: set
      type(flex_group_t), intent(in) :: flex
      real(wp), intent(in) :: speed, shapes(:, :)
      type(link_loading_t), intent(in) :: loading
      type(flex_study_t), intent(inout) :: study
      real(wp), dimension(size(shapes, 2), size(shapes, 2), size(loading%signals, 2)) :: stiffness
      real(wp), dimension(size(shapes, 2), size(shapes, 2)) :: spin
      real(wp), dimension(size(loading%signals, 2), size(shapes, 2)) :: force
      type(periodic_t) :: p(size(shapes, 2))
      type(periodic_t), allocatable :: c(:, :), k(:, :), load(:)
      integer :: i, j, n, modes, positions

      modes = size(shapes, 2)
      positions = size(loading%signals, 2)
      stiffness = 0.0_wp
      call add_tension(loading, shapes, study, stiffness)
      call add_attached(set, shapes, loading, study, stiffness)
      spin = product_of(transpose(shapes), product_of(study%link%frame%spin, shapes))
      do n = 1, positions
         stiffness(:, :, n) = stiffness(:, :, n)/speed**2 + study%cycle%turning(n)*spin
         do i = 1, modes
            stiffness(i, i, n) = stiffness(i, i, n) + (study%frequency(i)/speed)**2 - study%cycle%speed(n)**2
         end do
      end do
      allocate (study%forces(positions, modes, parts), study%c(modes, modes), study%k(modes, modes))
      do i = 1, parts
         study%forces(:, :, i) = product_of(transpose(loading%by_part(:, :, i)), product_of(transpose(loading%loads), shapes))
      end do
      study%widest = [(sqrt(maxval(shapes(1::freedoms, j)**2 + shapes(2::freedoms, j)**2)), j=1, modes)]
      force = product_of(transpose(loading%signals), product_of(transpose(loading%loads), shapes))/speed**2
      do j = 1, modes
         p(j) = periodic_from_samples(force(:, j))
         study%resolution = max(study%resolution, p(j)%resolution())
         do i = 1, modes
            study%k(i, j) = periodic_from_samples(stiffness(i, j, :))
            study%c(i, j) = periodic_from_samples(2.0_wp*study%cycle%turn%sense*study%cycle%speed*spin(i, j))
         end do
         study%c(j, j) = study%c(j, j)%plus(periodic_constant(2.0_wp*study%damping(j)*study%frequency(j)/speed))
      end do
      study%resolution = max(study%resolution, study%k(1, 1)%resolution())
      call find_least(stiffness, speed, study)
      if (study%solved_modes > 0) then
         if (study%influence%known) then
            allocate (c(modes, modes), k(modes, modes), load(modes))
            call weigh(study, p, c, k, load)
            call solve_coupled(c, k, load, tolerance, flex%points, study%coupled)
         else
            call solve_coupled(study%c, study%k, p, tolerance, flex%points, study%coupled)
         end if
      else
         call follow_statics(stiffness, force, study)
      end if
      study%steady = study%coupled%unique .and. (study%coupled%stable .or. study%coupled%neutral)
   end subroutine find_response

   !> At a speed far below all frequencies the modes follow their loads at once.
   pure subroutine follow_statics(stiffness, force, study)
      real(wp), intent(in) :: stiffness(:, :, :) !! shape (modes, modes, positions)
      real(wp), intent(in) :: force(:, :)        !! shape (positions, modes)
      type(flex_study_t), intent(inout) :: study
      logical :: ok
      integer :: n

      associate (coupled => study%coupled)
         allocate (coupled%y(size(force, 1), size(force, 2)), coupled%y1(size(force, 1), size(force, 2)), &
                   coupled%y2(size(force, 1), size(force, 2)), source=0.0_wp)
         coupled%converged = .true.
         coupled%unique = study%least_stiffness > 0.0_wp
         coupled%stable = coupled%unique
         do n = 1, size(force, 1)
            call solve_general(stiffness(:, :, n), force(n, :), coupled%y(n, :), ok)
            coupled%unique = coupled%unique .and. ok
         end do
      end associate
   end subroutine follow_statics

   !> How all bodies move by each mode, and the first frequency with them.
   subroutine find_driven(shapes, study)
      real(wp), intent(in) :: shapes(:, :)
      type(flex_study_t), intent(inout) :: study
      real(wp), dimension(size(shapes, 2), size(shapes, 2)) :: k, m, unused
      real(wp) :: squares(size(shapes, 2)), frequency
      integer :: i, j, g, n, modes
      logical :: ok

      study%driven = study%frequency(1)
      modes = size(shapes, 2)
      study%by_origin = -transpose(product_of(transpose(shapes), study%link%frame%motion(:, :3)))
      if (.not. study%influence%known) return
      n = size(study%influence%motion, 4)
      allocate (study%motion(3, size(study%inertia, 2), modes, n), source=0.0_wp)
      do j = 1, modes
         do g = 1, size(study%influence%node)
            study%motion(:, :, j, :) = study%motion(:, :, j, :) + study%influence%motion(:, :, g, :)* &
                                       shapes(freedoms*(study%influence%node(g) - 1) + study%influence%direction(g), j)
         end do
      end do
      study%driven = [huge(1.0_wp), 0.0_wp]
      do n = 1, size(study%motion, 4)
         k = 0.0_wp
         do j = 1, modes
            k(j, j) = study%frequency(j)**2
            do i = 1, modes
               m(i, j) = mass_of_modes(study, i, study, j, n)
            end do
         end do
         ! for the inverse squares, as at rest
         call natural_modes(m, k, squares, unused, ok)
         if (.not. ok) cycle
         frequency = 1.0_wp/sqrt(max(squares(modes), tiny(1.0_wp)))
         study%driven = [min(study%driven(1), frequency), max(study%driven(2), frequency)]
      end do
   end subroutine find_driven

   !> The matrices of M y'' + C y' + K y = p over those of y'' + ..., M growing and falling over the turn.
   subroutine weigh(study, p, c, k, load)
      type(flex_study_t), intent(in) :: study
      type(periodic_t), intent(in) :: p(:)
      type(periodic_t), intent(out) :: c(:, :), k(:, :), load(:)
      type(periodic_t) :: m
      real(wp), dimension(size(p), size(p), finer*size(study%cycle%turning)) :: mass, damping, stiffness
      real(wp), dimension(size(p), finer*size(study%cycle%turning)) :: force
      integer :: i, j, n, points

      points = size(force, 2)
      do j = 1, size(p)
         do i = 1, size(p)
            m = periodic_from_samples([(mass_of_modes(study, i, study, j, n), n=1, size(study%cycle%turning))])
            mass(i, j, :) = m%values(points)
            m = m%derivative(1)
            damping(i, j, :) = study%c(i, j)%values(points) + m%values(points)
            stiffness(i, j, :) = study%k(i, j)%values(points)
         end do
         force(j, :) = p(j)%values(points)
      end do
      call without_mass(mass, damping, stiffness, force, c, k, load)
   end subroutine weigh

   !> What the vibration adds to the signals of the loads: motion of the origin, and forces of the joints that give way.
   subroutine add_vibration(speed, shapes, study, loading)
      real(wp), intent(in) :: speed, shapes(:, :)
      type(flex_study_t), intent(in) :: study
      type(link_loading_t), intent(inout) :: loading
      real(wp), allocatable :: moved(:, :)       ! shape (3, bodies): acceleration by the vibration
      real(wp) :: signals(size(loading%signals, 1)), push
      integer :: n, j, g, l, place

      if (.not. study%influence%known) return
      allocate (moved(3, size(study%inertia, 2)))
      do n = 1, size(loading%signals, 2)
         moved = 0.0_wp
         do j = 1, size(shapes, 2)
            moved = moved + speed**2*study%coupled%y2(n, j)*study%motion(:, :, j, n)
         end do
         associate (axes => study%influence%axes(:, :, n), link => study%link)
            signals = 0.0_wp
            signals(:3) = origin_motion(link, axes, moved)
            do g = 1, size(study%influence%node)
               associate (unit => study%influence%motion(:, :, g, n))
                  push = mass_between(study%inertia, axes, unit, moved)
                  do j = 1, size(shapes, 2)
                     push = push + speed**2*study%coupled%y2(n, j)*sum(study%by_origin(:, j)*origin_motion(link, axes, unit))
                  end do
               end associate
               l = findloc(link%nodes, study%influence%node(g), dim=1)
               place = motions + 2*(l - 1) + study%influence%direction(g)
               signals(place) = signals(place) - push
            end do
            loading%signals(:, n) = loading%signals(:, n) + signals
         end associate
      end do
   end subroutine add_vibration

   !> What tension and compression of the elements add.
   subroutine add_tension(loading, shapes, study, stiffness)
      type(link_loading_t), intent(in) :: loading
      real(wp), intent(in) :: shapes(:, :)
      type(flex_study_t), intent(in) :: study
      real(wp), intent(inout) :: stiffness(:, :, :)
      real(wp) :: taut(size(shapes, 2), size(shapes, 2), 2)
      real(wp), dimension(size(loading%signals, 2)) :: first, second
      integer :: e, n

      do e = 1, size(study%link%frame%elements)
         taut = tension_stiffness(study%link%frame%elements(e), shapes)
         first = -along_columns(loading%signals, loading%end_forces(1, e, :))
         second = along_columns(loading%signals, loading%end_forces(4, e, :))
         do n = 1, size(first)
            stiffness(:, :, n) = stiffness(:, :, n) + first(n)*taut(:, :, 1) + second(n)*taut(:, :, 2)
         end do
      end do
   end subroutine add_tension

   !> What forces on brackets and springs add.
   subroutine add_attached(set, shapes, loading, study, stiffness)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: shapes(:, :)
      type(link_loading_t), intent(in) :: loading
      type(flex_study_t), intent(in) :: study
      real(wp), intent(inout) :: stiffness(:, :, :)
      type(attached_t), allocatable :: at(:)
      real(wp) :: place(2), along, across
      integer :: k, n

      associate (link => study%link)
         do k = 1, size(link%masses)
            associate (of => link%masses(k), s => loading%signals, mass => set%masses%mass(link%masses(k)%entry))
               place = link%frame%x(:, of%node) + of%reach
               do n = 1, size(stiffness, 3)
                  along = -mass*(s(1, n) - s(3, n)*place(2) - s(4, n)*place(1))
                  across = -mass*(s(2, n) + s(3, n)*place(1) - s(4, n)*place(2))
                  call stiffen_turning(of%node, along*of%reach(1) + across*of%reach(2), stiffness(:, :, n))
               end do
            end associate
         end do
         at = [link%loads, link%springs]
         do k = 1, size(study%cycle%acting)
            associate (of => study%cycle%acting(k))
               do n = 1, size(stiffness, 3)
                  call stiffen_turning(at(k)%node, of%along(n)*at(k)%reach(1) + of%across(n)*at(k)%reach(2) + of%torsion, &
                                       stiffness(:, :, n))
                  if (k > size(link%loads)) call stiffen_point(at(k)%node, at(k)%reach, of%held(n, :), stiffness(:, :, n))
               end do
            end associate
         end do
      end associate

   contains

      subroutine stiffen_turning(node, value, k)
         integer, intent(in) :: node
         real(wp), intent(in) :: value           !! N m/rad
         real(wp), intent(inout) :: k(:, :)
         integer :: j

         do j = 1, size(shapes, 2)
            k(:, j) = k(:, j) + value*shapes(freedoms*node, j)*shapes(freedoms*node, :)
         end do
      end subroutine stiffen_turning

      subroutine stiffen_point(node, reach, held, k)
         integer, intent(in) :: node
         real(wp), intent(in) :: reach(2), held(3)
         real(wp), intent(inout) :: k(:, :)
         real(wp) :: moved(2, size(shapes, 2))
         integer :: j

         moved = product_of(bracket_of(reach), shapes(freedoms_of(node), :))
         do j = 1, size(shapes, 2)
            k(:, j) = k(:, j) + moved(1, :)*(held(1)*moved(1, j) + held(2)*moved(2, j)) &
                      + moved(2, :)*(held(2)*moved(1, j) + held(3)*moved(2, j))
         end do
      end subroutine stiffen_point
   end subroutine add_attached

   !> The least squared frequency over the turn.
   subroutine find_least(stiffness, speed, study)
      real(wp), intent(in) :: stiffness(:, :, :) !! over the squared speed
      real(wp), intent(in) :: speed
      type(flex_study_t), intent(inout) :: study
      complex(wp) :: matrix(size(stiffness, 1), size(stiffness, 1))
      real(wp) :: values(size(stiffness, 1)), least(size(stiffness, 3))
      integer :: n
      logical :: ok

      do n = 1, size(least)
         matrix = cmplx(0.5_wp*(stiffness(:, :, n) + transpose(stiffness(:, :, n))), kind=wp)
         call hermitian_eigenvalues(matrix, values, ok)
         least(n) = values(1)
      end do
      study%least_stiffness = minval(least)*(speed/study%frequency(1))**2
      study%least_at = input_at(minloc(least, dim=1), size(least), study)
   end subroutine find_least

   pure real(wp) function input_at(position, positions, study)
      integer, intent(in) :: position, positions
      type(flex_study_t), intent(in) :: study

      input_at = study%cycle%turn%sense*full_turn*real(position - 1, wp)/real(positions, wp)
   end function input_at

   !> Displacements and stresses over the turn.
   subroutine find_stresses(speed, shapes, loading, study)
      real(wp), intent(in) :: speed, shapes(:, :)
      type(link_loading_t), intent(in) :: loading
      type(flex_study_t), intent(inout) :: study
      real(wp), dimension(size(shapes, 1)) :: moved, accelerated
      real(wp) :: rest(size(shapes, 1), size(loading%signals, 1)), by_modes(size(shapes, 2), size(loading%signals, 1))
      real(wp) :: forces(ends), stress(stress_kinds)
      integer :: j, n, e, s, k, positions

      positions = size(loading%signals, 2)
      ! what the modes that are not solved add at rest
      by_modes = product_of(transpose(shapes), loading%loads)
      do j = 1, size(shapes, 2)
         by_modes(j, :) = by_modes(j, :)/study%frequency(j)**2
      end do
      rest = loading%statics - product_of(shapes, by_modes)
      associate (frame => study%link%frame, q => study%coupled)
         allocate (study%displacement(2, size(frame%x, 2), positions), study%joints(size(study%link%joints), positions))
         allocate (study%stress(positions, stress_kinds), source=0.0_wp)
         deallocate (study%segments)
         allocate (study%segments(size(study%link%segments)))
         study%segments%entry = study%link%segments
         study%stressed = all([(all(frame%elements(e)%node%depth > 0.0_wp), e=1, size(frame%elements))])
         do n = 1, positions
            moved = along_columns(transpose(rest), loading%signals(:, n)) + along_columns(transpose(shapes), q%y(n, :))
            accelerated = speed**2*along_columns(transpose(shapes), q%y2(n, :))
            do k = 1, size(frame%x, 2)
               study%displacement(:, k, n) = moved(freedoms*(k - 1) + 1:freedoms*(k - 1) + 2)
            end do
            do k = 1, size(study%link%joints)
               study%joints(k, n) = sqrt(sum(study%displacement(:, study%link%nodes(k), n)**2))
            end do
            do e = 1, size(frame%elements)
               associate (element => frame%elements(e))
                  s = findloc(study%link%segments, element%segment, dim=1)
                  forces = along_columns(element%stiffness, local_load(element, moved)) + &
                           along_columns(element%mass, local_load(element, accelerated)) - &
                           along_columns(transpose(element%motion), loading%signals(:motions, n))
                  do k = 1, 2
                     associate (part => merge(element%from, element%to, k == 1))
                        call note(study%segments(s)%deflection, sqrt(sum(study%displacement(:, element%nodes(k), n)**2)), part)
                        if (.not. study%stressed) cycle
                        associate (section => element%node(k), pull => merge(-forces(1), forces(4), k == 1))
                           stress(1) = abs(forces(3*k))*0.5_wp*section%depth/section%inertia
                           stress(2) = pull/section%area
                           stress(3) = stress(1) + abs(stress(2))
                        end associate
                        do j = 1, stress_kinds
                           call note(study%segments(s)%stress(j), stress(j), part)
                           if (abs(stress(j)) > abs(study%stress(n, j))) study%stress(n, j) = stress(j)
                        end do
                     end associate
                  end do
               end associate
            end do
         end do
      end associate

   contains

      subroutine note(greatest, value, part)
         type(greatest_t), intent(inout) :: greatest
         real(wp), intent(in) :: value, part

         if (abs(value) <= abs(greatest%value)) return
         greatest%value = value
         greatest%part = part
         greatest%at = input_at(n, positions, study)
      end subroutine note
   end subroutine find_stresses
end submodule psalm_flex_study_body
