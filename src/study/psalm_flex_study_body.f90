!> How a link of beam elements is solved. Only this knows what the group FLEX has.
submodule(psalm_flex_study) psalm_flex_study_body
   use psalm_beam_elements, only: beam_frame_t, element_t, freedoms, ends, motions, freedoms_of, local_load, &
                                  tension_stiffness, bracket_of
   use psalm_coupled_hill, only: solve_coupled, without_mass
   use psalm_driven_masses, only: find_influence
   use psalm_flex_slide, only: shoe_place_t, place_shoe, rigid_motions, rates_of, supported_frequencies, rigid_freedoms
   use psalm_dense, only: factors_t, factorise, solve
   use psalm_flex_group, only: flex_group_t, flex_of
   use psalm_flexible_link, only: attached_t
   use psalm_flexible_cycle, only: find_flexible_cycle, parts, part_inertia, part_fixed, part_damped, part_pushed
   use psalm_lapack, only: natural_modes, hermitian_eigenvalues, solve_general
   use psalm_linear, only: along_columns, product_of
   use psalm_out_of_plane_study, only: find_out_of_plane, prestress_t
   use psalm_periodic, only: periodic_t, periodic_constant, periodic_from_samples
   use psalm_stop, only: is_to_end
   implicit none (type, external)

   real(wp), parameter :: tolerance = 1.0e-8_wp  !! of a period's matrix
   integer, parameter :: finer = 2               !! positions in a turn where masses vary, times those of the link
   real(wp), parameter :: shortest = 1.0e-15_wp  !! s/rad, of a mode that has a meaning
   real(wp), parameter :: far_above = 1000.0_wp  !! times the speed: modes so fast follow their loads at once
   real(wp), parameter :: beside = 1.0e-4_wp     !! of the size of a link: a shoe so near to a segment is on it

   !> What loads the link: each load by a signal over the turn.
   type :: link_loading_t
      real(wp), allocatable :: loads(:, :)       !! shape (freedoms of the frame, signals)
      real(wp), allocatable :: by_part(:, :, :)  !! shape (signals, positions, parts): by `part_...` of the cycle
      real(wp), allocatable :: signals(:, :)     !! shape (signals, positions): together; m/s2, rad/s2, 1/s2; N; N m
      real(wp), allocatable :: statics(:, :)     !! displacements by each load: shape as loads
      real(wp), allocatable :: end_forces(:, :, :) !! of the elements, by each load: shape (ends, elements, signals)
      integer :: slide = 0                       !! signals before those of a slide, one for each freedom of the frame
      type(shoe_place_t), allocatable :: shoes(:) !! shape (positions): of the slide
   end type link_loading_t

   !> How a link moves by its shapes, besides bending, and what the change of this over the turn adds.
   type :: moving_shapes_t
      real(wp), allocatable :: whole(:, :, :)    !! shape (freedoms of the frame, modes, positions; of a link without a slide 1)
      real(wp), allocatable :: mass(:, :, :)     !! shape (modes, modes, positions): of the link alone
      real(wp), allocatable :: damping(:, :, :), stiffness(:, :, :) !! the same: what they add, at unit speed
   end type moving_shapes_t

   integer, parameter :: listed_over_turn = 3    !! frequencies of a link with a slide

contains

   module procedure find_flex
      type(flex_group_t) :: flex
      type(link_loading_t) :: loading
      type(moving_shapes_t) :: moving
      real(wp), allocatable :: shapes(:, :)      ! shape (freedoms of the frame, modes): of unit mass
      logical, allocatable :: free(:)
      real(wp) :: speed
      integer :: k

      flex = flex_of(set)
      study%link = link
      allocate (study%frequency(0), study%damping(0), study%segments(0))
      speed = crank%speed
      call find_flexible_cycle(given, dimensions, model, link, flex%points, crank, study%cycle)
      study%found = study%cycle%turn%failure > 0
      if (study%found .or. is_to_end(stop)) return
      call add_masses(set, study%link)
      free = free_of(study%link)
      call find_modes(flex, free, study, shapes)
      if (is_to_end(stop)) return
      study%found = .true.
      if (.not. study%solved) return
      call find_loading(speed, free, study, loading)
      call leave_plane(set, flex, loading, study)
      if (is_to_end(stop)) then
         study%found = .false.
         return
      end if
      call find_influence(given, dimensions, model, link, flex%points, crank, study%influence)
      study%inertia = model%inertia
      if (link%slide > 0) then
         call hold_slide(free, loading, any(given%mechanism%actuators%joint > 0 .and. .not. given%mechanism%actuators%slides .and. &
                                            [(any(link%joints == given%mechanism%actuators(k)%joint), &
                                              k=1, size(given%mechanism%actuators))]), study)
         if (.not. study%solved) return
      end if
      call find_driven(shapes, loading, study)
      study%solved_modes = count(study%frequency <= far_above*speed)
      if (study%driven(1) <= far_above*speed) study%solved_modes = max(1, study%solved_modes)
      if (study%solved_modes > 0) shapes = shapes(:, :study%solved_modes)
      call find_moving(flex, speed, shapes, study, moving)
      call find_response(set, flex, speed, shapes, moving, loading, study)
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
         if (link%slide > 0) then
            loading%slide = many
            many = many + size(free)
         end if
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
         if (link%slide > 0) call add_slide()
         loading%signals = speed**2*loading%by_part(:, :, part_inertia) + loading%by_part(:, :, part_fixed) + &
                           speed*loading%by_part(:, :, part_damped)
         study%equilibrium = unbalanced(frame, loading)
         if (link%slide > 0) study%equilibrium = along_slide(loading)
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

      !> Force and couple of the slide, which balance all other forces, put on the nodes of the element where the shoe is.
      subroutine add_slide()
         real(wp) :: sums(size(loading%by_part, 1), rigid_freedoms), balance(rigid_freedoms)
         integer :: i, l

         associate (frame => study%link%frame, turn => study%cycle)
            loading%shoes = place_shoe(frame, turn)
            study%leaves = maxval(loading%shoes%off)
            if (study%leaves <= beside*maxval(abs(frame%x))) study%leaves = 0.0_wp
            do i = 1, size(free)
               loading%loads(i, loading%slide + i) = 1.0_wp
            end do
            sums = product_of(transpose(loading%loads), rigid_motions(frame))
            do l = 1, parts
               do i = 1, n
                  balance = -along_columns(sums(:loading%slide, :), loading%by_part(:loading%slide, i, l))
                  balance(3) = balance(3) - turn%shoe(1, i)*balance(2) + turn%shoe(2, i)*balance(1)
                  associate (shoe => loading%shoes(i))
                     loading%by_part(loading%slide + shoe%places, i, l) = along_columns(shoe%moved, balance)
                  end associate
               end do
            end do
         end associate
      end subroutine add_slide

      !> The force along the slide that would be needed, over the largest force of a joint: there is none.
      pure real(wp) function along_slide(loading) result(part)
         type(link_loading_t), intent(in) :: loading
         real(wp) :: force(2), largest
         integer :: i

         part = 0.0_wp
         largest = maxval(abs(loading%signals(motions + 1:loading%slide, :)))
         do i = 1, size(loading%shoes)
            associate (of => loading%signals(loading%slide + 1:, i))
               force = [sum(of(1::freedoms)), sum(of(2::freedoms))]
            end associate
            largest = max(largest, maxval(abs(force)))
            part = max(part, abs(force(1)*study%cycle%normal(2, i) - force(2)*study%cycle%normal(1, i)))
         end do
         if (largest > 0.0_wp) part = part/largest
      end function along_slide

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
   subroutine find_response(set, flex, speed, shapes, moving, loading, study)
      type(data_set_t), intent(in) :: set
      type(flex_group_t), intent(in) :: flex
      real(wp), intent(in) :: speed, shapes(:, :)
      type(moving_shapes_t), intent(in) :: moving
      type(link_loading_t), intent(in) :: loading
      type(flex_study_t), intent(inout) :: study
      real(wp), dimension(size(shapes, 2), size(shapes, 2), size(loading%signals, 2)) :: stiffness, damping
      real(wp), dimension(size(shapes, 2), size(shapes, 2)) :: spin
      real(wp), dimension(size(loading%signals, 2), size(shapes, 2)) :: force
      type(periodic_t) :: p(size(shapes, 2))
      type(periodic_t), allocatable :: c(:, :), k(:, :), load(:)
      integer :: i, j, n, modes, positions

      modes = size(shapes, 2)
      positions = size(loading%signals, 2)
      stiffness = 0.0_wp
      call add_tension(loading, moving%whole, study, stiffness)
      call add_attached(set, moving%whole, loading, study, stiffness)
      spin = product_of(transpose(shapes), product_of(study%link%frame%spin, shapes))
      do n = 1, positions
         damping(:, :, n) = 2.0_wp*study%cycle%turn%crank%sense*study%cycle%speed(n)*spin
         if (study%link%slide > 0) then
            associate (whole => moving%whole(:, :, n))
               spin = product_of(transpose(whole), product_of(study%link%frame%spin, whole))
            end associate
            damping(:, :, n) = 2.0_wp*study%cycle%turn%crank%sense*study%cycle%speed(n)*spin + moving%damping(:, :, n)
            stiffness(:, :, n) = stiffness(:, :, n)/speed**2 + study%cycle%turning(n)*spin + moving%stiffness(:, :, n) &
                                 - study%cycle%speed(n)**2*moving%mass(:, :, n)
         else
            stiffness(:, :, n) = stiffness(:, :, n)/speed**2 + study%cycle%turning(n)*spin
         end if
         do i = 1, modes
            stiffness(i, i, n) = stiffness(i, i, n) + (study%frequency(i)/speed)**2
            if (study%link%slide == 0) stiffness(i, i, n) = stiffness(i, i, n) - study%cycle%speed(n)**2
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
            study%c(i, j) = periodic_from_samples(damping(i, j, :))
         end do
         if (study%link%slide == 0) &
            study%c(j, j) = study%c(j, j)%plus(periodic_constant(2.0_wp*study%damping(j)*study%frequency(j)/speed))
      end do
      study%resolution = max(study%resolution, study%k(1, 1)%resolution())
      if (study%link%slide > 0) then
         call find_least(stiffness - moving%stiffness, moving, speed, study) ! less what motion of the shoe adds
      else
         call find_least(stiffness, moving, speed, study)
      end if
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
   subroutine find_driven(shapes, loading, study)
      real(wp), intent(in) :: shapes(:, :)
      type(link_loading_t), intent(in) :: loading
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
      if (study%link%slide > 0) then
         do n = 1, size(loading%shoes)
            associate (shoe => loading%shoes(n), by => study%influence%slide)
               do j = 1, modes
                  study%motion(:, :, j, n) = study%motion(:, :, j, n) + by(:, :, 1, n)*sum(shoe%across*shapes(shoe%places, j)) &
                                             + by(:, :, 2, n)*sum(shoe%moved(3, :)*shapes(shoe%places, j))
               end do
            end associate
         end do
         n = size(study%influence%motion, 4)
      end if
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
            if (link%slide > 0) then
               associate (shoe => loading%shoes(n))
                  do g = 1, 2
                     associate (unit => study%influence%slide(:, :, g, n))
                        push = mass_between(study%inertia, axes, unit, moved)
                        do j = 1, size(shapes, 2)
                           push = push + speed**2*study%coupled%y2(n, j)*sum(study%by_origin(:, j)*origin_motion(link, axes, unit))
                        end do
                     end associate
                     associate (at => signals(loading%slide + shoe%places))
                        signals(loading%slide + shoe%places) = at - push*merge(shoe%across, shoe%moved(3, :), g == 1)
                     end associate
                  end do
               end associate
            end if
            loading%signals(:, n) = loading%signals(:, n) + signals
         end associate
      end do
   end subroutine add_vibration

   !> How the slide holds the link, and its frequencies over the turn; `study%solved` is false where that is not found.
   subroutine hold_slide(free, loading, is_clamped, study)
      logical, intent(in) :: free(:)
      type(link_loading_t), intent(in) :: loading
      logical, intent(in) :: is_clamped
      type(flex_study_t), intent(inout) :: study
      real(wp), allocatable :: by_slide(:, :, :)
      integer :: n, k

      study%clamped = is_clamped
      study%not_held = .not. study%influence%known
      study%solved = study%influence%known
      if (study%not_held) return
      allocate (by_slide(rigid_freedoms, 2, size(loading%shoes)))
      allocate (study%over_turn(listed_over_turn, size(loading%shoes)), source=0.0_wp)
      associate (by => study%influence%slide)
         do n = 1, size(loading%shoes)
            ! at the foot of the joint, where it was taken apart, a turning at the shoe displaces besides
            by(:, :, 2, n) = by(:, :, 2, n) - study%cycle%reach(n)*by(:, :, 1, n)
            do k = 1, 2
               by_slide(:, k, n) = origin_motion(study%link, study%influence%axes(:, :, n), by(:, :, k, n))
            end do
         end do
      end associate
      call supported_frequencies(study%link%frame, free, loading%shoes, by_slide, study%over_turn, study%solved)
   end subroutine hold_slide

   !> The shapes with the motion of the axes of a link that has a slide.
   subroutine find_moving(flex, speed, shapes, study, moving)
      type(flex_group_t), intent(in) :: flex
      real(wp), intent(in) :: speed, shapes(:, :)
      type(flex_study_t), intent(in) :: study
      type(moving_shapes_t), intent(out) :: moving
      real(wp), allocatable, dimension(:, :, :) :: axes, first, second ! shape (3, modes, positions)
      real(wp), allocatable, dimension(:, :) :: rigid, of_rigid, turned ! inertia against rigid motions
      integer :: n, j, modes, positions

      modes = size(shapes, 2)
      if (study%link%slide == 0) then
         moving%whole = reshape(shapes, [size(shapes, 1), modes, 1])
         return
      end if
      positions = size(study%motion, 4)
      allocate (axes(rigid_freedoms, modes, positions), first(rigid_freedoms, modes, positions), &
                second(rigid_freedoms, modes, positions), moving%whole(size(shapes, 1), modes, positions), &
                moving%mass(modes, modes, positions), moving%damping(modes, modes, positions), &
                moving%stiffness(modes, modes, positions))
      do n = 1, positions
         do j = 1, modes
            axes(:, j, n) = origin_motion(study%link, study%influence%axes(:, :, n), study%motion(:, :, j, n))
         end do
      end do
      call rates_of(axes, first, second)
      rigid = rigid_motions(study%link%frame)
      of_rigid = product_of(study%link%frame%mass, rigid)
      turned = product_of(study%link%frame%spin, rigid)
      do n = 1, positions
         associate (whole => moving%whole(:, :, n))
            whole = shapes + product_of(rigid, axes(:, :, n))
            moving%mass(:, :, n) = product_of(transpose(whole), product_of(study%link%frame%mass, whole))
            associate (rate => product_of(product_of(transpose(whole), of_rigid), first(:, :, n)))
               ! of 2 U' M R c' half the symmetric part is the growth of the mass, which is added for all bodies
               moving%damping(:, :, n) = rate - transpose(rate) + damped_modes(moving%mass(:, :, n))
            end associate
            moving%stiffness(:, :, n) = product_of(product_of(transpose(whole), of_rigid), second(:, :, n)) &
                                        + 2.0_wp*study%cycle%turn%crank%sense*study%cycle%speed(n)* &
                                        product_of(product_of(transpose(whole), turned), first(:, :, n))
         end associate
      end do

   contains

      !> Damping of the modes that the link has where it is held at a position: each a part of its critical one, over the speed.
      function damped_modes(mass) result(c)
         real(wp), intent(in) :: mass(:, :)
         real(wp), dimension(size(mass, 1), size(mass, 1)) :: c, k, vectors, moved
         real(wp) :: squares(size(mass, 1)), frequency, damping
         integer :: i
         logical :: ok

         k = 0.0_wp
         do i = 1, size(mass, 1)
            k(i, i) = study%frequency(i)**2
         end do
         c = 0.0_wp
         call natural_modes(k, mass, squares, vectors, ok)
         if (.not. ok) return
         moved = product_of(mass, vectors)
         do i = 1, size(squares)
            frequency = sqrt(squares(i))
            damping = 2.0_wp*flex%damping*frequency + flex%by_mass + flex%by_stiffness*squares(i)
            moved(:, i) = moved(:, i)*sqrt(damping/(speed*sum(vectors(:, i)*along_columns(mass, vectors(:, i)))))
         end do
         c = product_of(moved, transpose(moved))
      end function damped_modes
   end subroutine find_moving

   !> The link out of the plane, under the pulls and moments that the rigid motion and its loads make in the plane.
   subroutine leave_plane(set, flex, loading, study)
      type(data_set_t), intent(in) :: set
      type(flex_group_t), intent(in) :: flex
      type(link_loading_t), intent(in) :: loading
      type(flex_study_t), intent(inout) :: study
      type(prestress_t) :: prestress
      integer :: e

      associate (many => size(study%link%frame%elements), positions => size(loading%signals, 2))
         allocate (prestress%pull(2, many, positions), prestress%moment(2, many, positions))
         do e = 1, many
            associate (forces => loading%end_forces(:, e, :))
               prestress%pull(1, e, :) = -along_columns(loading%signals, forces(1, :))
               prestress%pull(2, e, :) = along_columns(loading%signals, forces(4, :))
               prestress%moment(1, e, :) = -along_columns(loading%signals, forces(3, :))
               prestress%moment(2, e, :) = along_columns(loading%signals, forces(6, :))
            end associate
         end do
      end associate
      prestress%motion = loading%signals(:motions, :)
      call find_out_of_plane(set, flex, study%link, study%cycle, prestress, study%out)
   end subroutine leave_plane

   !> What tension and compression of the elements add.
   subroutine add_tension(loading, shapes, study, stiffness)
      type(link_loading_t), intent(in) :: loading
      real(wp), intent(in) :: shapes(:, :, :)    !! shape (freedoms of the frame, modes, positions, or 1 for all)
      type(flex_study_t), intent(in) :: study
      real(wp), intent(inout) :: stiffness(:, :, :)
      real(wp) :: taut(size(shapes, 2), size(shapes, 2), 2), own(ends)
      real(wp), dimension(size(loading%signals, 2)) :: first, second
      integer :: e, n

      do e = 1, size(study%link%frame%elements)
         taut = tension_stiffness(study%link%frame%elements(e), shapes(:, :, 1))
         first = -along_columns(loading%signals, loading%end_forces(1, e, :))
         second = along_columns(loading%signals, loading%end_forces(4, e, :))
         do n = 1, size(first)
            if (loading%slide > 0) then
               taut = tension_stiffness(study%link%frame%elements(e), shapes(:, :, n))
               if (loading%shoes(n)%element == e) then
                  own = local_load(study%link%frame%elements(e), loading%signals(loading%slide + 1:, n))
                  first(n) = first(n) + own(1)
                  second(n) = second(n) - own(4)
               end if
            end if
            stiffness(:, :, n) = stiffness(:, :, n) + first(n)*taut(:, :, 1) + second(n)*taut(:, :, 2)
         end do
      end do
   end subroutine add_tension

   !> What forces on brackets and springs add.
   subroutine add_attached(set, shapes, loading, study, stiffness)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: shapes(:, :, :)    !! as of `add_tension`
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
                  call stiffen_turning(of%node, shapes(:, :, min(n, size(shapes, 3))), along*of%reach(1) + across*of%reach(2), &
                                       stiffness(:, :, n))
               end do
            end associate
         end do
         at = [link%loads, link%springs]
         do k = 1, size(study%cycle%acting)
            associate (of => study%cycle%acting(k))
               do n = 1, size(stiffness, 3)
                  call stiffen_turning(at(k)%node, shapes(:, :, min(n, size(shapes, 3))), of%along(n)*at(k)%reach(1) + &
                                       of%across(n)*at(k)%reach(2) + of%torsion, stiffness(:, :, n))
                  if (k > size(link%loads)) call stiffen_point(at(k)%node, shapes(:, :, min(n, size(shapes, 3))), at(k)%reach, &
                                                               of%held(n, :), stiffness(:, :, n))
               end do
            end associate
         end do
      end associate

   contains

      subroutine stiffen_turning(node, shapes, value, k)
         integer, intent(in) :: node
         real(wp), intent(in) :: shapes(:, :)
         real(wp), intent(in) :: value           !! N m/rad
         real(wp), intent(inout) :: k(:, :)
         integer :: j

         do j = 1, size(shapes, 2)
            k(:, j) = k(:, j) + value*shapes(freedoms*node, j)*shapes(freedoms*node, :)
         end do
      end subroutine stiffen_turning

      subroutine stiffen_point(node, shapes, reach, held, k)
         integer, intent(in) :: node
         real(wp), intent(in) :: shapes(:, :)
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
   subroutine find_least(stiffness, moving, speed, study)
      real(wp), intent(in) :: stiffness(:, :, :) !! over the squared speed
      type(moving_shapes_t), intent(in) :: moving
      real(wp), intent(in) :: speed
      type(flex_study_t), intent(inout) :: study
      complex(wp) :: matrix(size(stiffness, 1), size(stiffness, 1))
      real(wp) :: values(size(stiffness, 1)), least(size(stiffness, 3))
      real(wp), dimension(size(stiffness, 1), size(stiffness, 1)) :: at_rest, shapes
      integer :: n
      logical :: ok

      at_rest = 0.0_wp
      do n = 1, size(values)
         at_rest(n, n) = (study%frequency(n)/speed)**2
      end do
      do n = 1, size(least)
         matrix = cmplx(0.5_wp*(stiffness(:, :, n) + transpose(stiffness(:, :, n))), kind=wp)
         call hermitian_eigenvalues(matrix, values, ok)
         least(n) = values(1)
         if (study%link%slide == 0) cycle
         ! with the mass that moves besides, over the square of the link at rest there
         call natural_modes(real(matrix, wp), moving%mass(:, :, n), values, shapes, ok)
         least(n) = values(1)*study%frequency(1)**2
         call natural_modes(at_rest, moving%mass(:, :, n), values, shapes, ok)
         least(n) = least(n)/(values(1)*speed**2)
      end do
      study%least_stiffness = minval(least)*(speed/study%frequency(1))**2
      study%least_at = study%cycle%turn%crank%input(minloc(least, dim=1))
   end subroutine find_least

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
            if (loading%slide > 0) call move_axes()
            do k = 1, size(study%link%joints)
               study%joints(k, n) = sqrt(sum(study%displacement(:, study%link%nodes(k), n)**2))
               if (loading%slide > 0 .and. study%link%nodes(k) == study%link%held(1)) study%joints(k, n) = 0.0_wp
            end do
            do e = 1, size(frame%elements)
               associate (element => frame%elements(e))
                  s = findloc(study%link%segments, element%segment, dim=1)
                  forces = along_columns(element%stiffness, local_load(element, moved)) + &
                           along_columns(element%mass, local_load(element, accelerated)) - &
                           along_columns(transpose(element%motion), loading%signals(:motions, n))
                  if (loading%slide > 0) then
                     if (loading%shoes(n)%element == e) then
                        forces = forces - local_load(element, loading%signals(loading%slide + 1:, n))
                        call note_shoe(element)
                     end if
                  end if
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

      !> Displacements in axes that move as the rigid link, in place of those that move with the pin.
      subroutine move_axes()
         real(wp) :: motion(rigid_freedoms, size(study%inertia, 2)), axes(rigid_freedoms)
         integer :: g

         associate (shoe => loading%shoes(n), influence => study%influence)
            motion = influence%slide(:, :, 1, n)*sum(shoe%across*moved(shoe%places)) &
                     + influence%slide(:, :, 2, n)*sum(shoe%moved(3, :)*moved(shoe%places))
            do g = 1, size(influence%node)
               motion = motion + influence%motion(:, :, g, n)*moved(freedoms*(influence%node(g) - 1) + influence%direction(g))
            end do
            axes = origin_motion(study%link, influence%axes(:, :, n), motion)
         end associate
         associate (frame => study%link%frame)
            do k = 1, size(frame%x, 2)
               study%displacement(:, k, n) = study%displacement(:, k, n) + axes(:2) + axes(3)*[-frame%x(2, k), frame%x(1, k)]
            end do
         end associate
      end subroutine move_axes

      !> Stresses on both sides of the shoe, within its element.
      subroutine note_shoe(element)
         type(element_t), intent(in) :: element
         real(wp) :: depth, inertia, area, at
         integer :: i

         associate (p => loading%shoes(n)%part, node => element%node)
            at = element%from + p*(element%to - element%from)
            depth = node(1)%depth + p*(node(2)%depth - node(1)%depth)
            inertia = node(1)%inertia + p*(node(2)%inertia - node(1)%inertia)
            area = node(1)%area + p*(node(2)%area - node(1)%area)
            s = findloc(study%link%segments, element%segment, dim=1)
            if (.not. study%stressed) return
            do i = 1, 2
               if (i == 1) then
                  stress(1) = -forces(3) + forces(2)*p*element%length
                  stress(2) = -forces(1)/area
               else
                  stress(1) = forces(6) + forces(5)*(1.0_wp - p)*element%length
                  stress(2) = forces(4)/area
               end if
               stress(1) = abs(stress(1))*0.5_wp*depth/inertia
               stress(3) = stress(1) + abs(stress(2))
               do j = 1, stress_kinds
                  call note(study%segments(s)%stress(j), stress(j), at)
                  if (abs(stress(j)) > abs(study%stress(n, j))) study%stress(n, j) = stress(j)
               end do
            end do
         end associate
      end subroutine note_shoe

      subroutine note(greatest, value, part)
         type(greatest_t), intent(inout) :: greatest
         real(wp), intent(in) :: value, part

         if (abs(value) <= abs(greatest%value)) return
         greatest%value = value
         greatest%part = part
         greatest%at = study%cycle%turn%crank%input(n)
      end subroutine note
   end subroutine find_stresses
end submodule psalm_flex_study_body
