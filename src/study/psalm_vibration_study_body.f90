!> How the vibration of a link is found. Only this knows what the group VIBR has.
submodule(psalm_vibration_study) psalm_vibration_study_body
   use psalm_floquet, only: coupled_multipliers
   use psalm_hill, only: solve_hill, greatest_of
   use psalm_kinds, only: pi
   use psalm_link_cycle, only: find_link_cycle, moving_link
   use psalm_link_stress, only: find_curvature, find_pull
   use psalm_link_vibration, only: moving_link_t, mode_stiffness, mode_force, coupling, first_frequency, timoshenko_factor
   use psalm_periodic, only: periodic_t, periodic_constant, periodic_from_samples
   use psalm_sort, only: ascending
   use psalm_stability, only: stability_boundaries, series_boundaries
   use psalm_stop, only: is_to_end, tell_host
   use psalm_vibration_group, only: vibration_group_t, vibration_of
   implicit none (type, external)

   real(wp), parameter :: tolerance = 1.0e-10_wp          !! of a period's matrix
   real(wp), parameter :: coupled_tolerance = 1.0e-9_wp   !! of that of several modes
   real(wp), parameter :: table_tolerance = 1.0e-7_wp     !! in the table over speeds
   real(wp), parameter :: sharpness = 1.0e-9_wp           !! of the ends of a band of speeds, relative
   integer, parameter :: in_tongue = 3                    !! speeds looked at between two boundaries
   integer, parameter :: places_along = 101               !! along the link at which stresses are looked at
   integer, parameter :: modes_mixed = 3                  !! that are looked at for what couples them

contains

   !> Squared frequency of mode j over that of Euler's first: j**4, less with shear.
   pure real(wp) function mode_factor(set, length, j)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: length !! m
      integer, intent(in) :: j
      type(vibration_group_t) :: vibration

      vibration = vibration_of(set)
      mode_factor = real(j, wp)**4
      associate (beam => vibration%beam)
         if (beam%shear_ratio > 0.0_wp) mode_factor = mode_factor*timoshenko_factor(j, length/beam%gyration, beam%shear_ratio)
      end associate
   end function mode_factor

   module procedure find_vibration
      type(vibration_group_t) :: vibration
      type(moving_link_t) :: link
      type(periodic_t) :: f
      real(wp) :: w, speed, euler
      integer :: i, j

      vibration = vibration_of(set)
      associate (v => vibration, beam => vibration%beam)
         call find_link_cycle(given, dimensions, model, beam, v%points, crank, study%cycle)
         allocate (study%modes(0), study%speeds(0), study%bands(0), study%chart(0), study%multipliers(0))
         study%found = study%cycle%failure > 0
         if (study%found) return
         speed = crank%speed
         euler = first_frequency(study%cycle%length, beam%gyration, beam%modulus, beam%density)
         study%frequency = euler*sqrt(mode_factor(set, study%cycle%length, 1))
         study%ratio = study%frequency/speed
         w = (euler/speed)**2
         link = moving_link(study%cycle, speed, 1.0_wp)
         deallocate (study%modes)
         allocate (study%modes(v%modes))
         do j = 1, v%modes
            if (is_to_end(stop)) return
            call find_mode(set, vibration, link, j, w, study%cycle, study%modes(j))
         end do
         f = mode_stiffness(link, 1)
         study%resolution = f%resolution()
         if (allocated(link%acting)) study%mixing = mixing_of(set, vibration, link, w, study%cycle%length)
         if (is_to_end(stop)) return
         call find_multipliers(set, vibration, link, w, study)
         if (v%stresses) call find_stresses(vibration, link, speed, study)
         study%found = .true.
         study%given_e = v%given_e
         deallocate (study%speeds)
         allocate (study%speeds(v%speeds))
         do i = 1, v%speeds
            if (is_to_end(stop)) then
               study%speeds = study%speeds(:i - 1)
               return
            end if
            study%speeds(i) = row_at(set, vibration, study%cycle, euler, v%slowest + (v%fastest - v%slowest)*part(i, v%speeds), &
                                     table_tolerance)
            call tell_host(stop, i, v%speeds)
         end do
         if (v%speeds > 1) call find_bands(set, vibration, euler, study, stop)
         if (is_to_end(stop)) return
         study%bands_known = .true.
         if (v%greatest_e > 0.0_wp) then
            deallocate (study%chart)
            allocate (study%chart(v%in_chart))
            do i = 1, v%in_chart
               if (is_to_end(stop)) then
                  deallocate (study%chart)
                  allocate (study%chart(0))
                  return
               end if
               study%chart(i)%e = v%greatest_e*part(i, v%in_chart)
               link = moving_link(study%cycle, 0.0_wp, study%chart(i)%e/v%given_e)
               study%chart(i)%exact = stability_boundaries(mode_stiffness(link, 1), v%last)
            end do
            study%greatest_e = v%greatest_e
         end if
      end associate
   end procedure find_vibration

   !> Part of a range at which row i of n stands.
   pure real(wp) function part(i, n)
      integer, intent(in) :: i, n

      part = 0.0_wp
      if (n > 1) part = real(i - 1, wp)/real(n - 1, wp)
   end function part

   subroutine find_mode(set, vibration, link, j, w, cycle_of, mode)
      type(data_set_t), intent(in) :: set
      type(vibration_group_t), intent(in) :: vibration
      type(moving_link_t), intent(in) :: link
      integer, intent(in) :: j
      real(wp), intent(in) :: w       !! squared ratio of Euler's first frequency to the speed
      type(link_cycle_t), intent(in) :: cycle_of
      type(mode_t), intent(out) :: mode
      type(periodic_t) :: f, c0, y
      real(wp) :: stiffness, length
      real(wp), allocatable :: over_turn(:)
      integer :: p, n

      length = cycle_of%length
      f = mode_stiffness(link, j)
      stiffness = w*mode_factor(set, length, j)
      c0 = f%plus(periodic_constant(stiffness))
      mode%exact = stability_boundaries(f, vibration%last)
      allocate (mode%first(2, 0:vibration%last), mode%second(2, 0:vibration%last))
      do p = 0, vibration%last
         mode%first(:, p) = series_boundaries(f, p, 1)
         mode%second(:, p) = series_boundaries(f, p, 2)
      end do
      over_turn = c0%values(vibration%points)
      mode%least_stiffness = minval(over_turn)
      mode%least_at = cycle_of%crank%input(minloc(over_turn, 1))
      mode%hill = solve_hill(periodic_constant(2.0_wp*vibration%beam%damping*sqrt(stiffness)), c0, mode_force(link, j), &
            tolerance)
      allocate (mode%amplitude(0:harmonics_listed), source=0.0_wp)
      if (.not. mode%hill%unique) return
      mode%greatest = length*greatest_of(mode%hill)
      y = periodic_from_samples(mode%hill%y)
      do n = 0, harmonics_listed
         mode%amplitude(n) = length*y%amplitude(n)
      end do
   end subroutine find_mode

   !> Stresses over the turn.
   subroutine find_stresses(vibration, link, speed, study)
      type(vibration_group_t), intent(in) :: vibration
      type(moving_link_t), intent(in) :: link
      real(wp), intent(in) :: speed              !! rad/s
      type(vibration_study_t), intent(inout) :: study
      type(periodic_t) :: deflection(size(study%modes))
      real(wp), allocatable :: bending(:, :), along(:, :), both(:, :)   ! shape (positions, places)
      integer :: j, n

      n = vibration%points
      allocate (study%stresses)
      study%stresses%known = all([(study%modes(j)%hill%unique .and. (study%modes(j)%hill%stable .or. &
                                                                     study%modes(j)%hill%neutral), j=1, size(study%modes))])
      if (.not. study%stresses%known) return
      do j = 1, size(deflection)
         deflection(j) = periodic_from_samples(study%modes(j)%hill%y)
      end do
      allocate (bending(n, places_along), along(n, places_along))
      call find_curvature(deflection, bending)
      call find_pull(link, along)
      associate (beam => vibration%beam, of => study%stresses)
         bending = abs(bending)*(0.5_wp*beam%modulus*beam%depth/study%cycle%length)
         along = along*(study%cycle%mass*study%cycle%length*speed**2/beam%area)
         both = abs(along) + bending
         of%bending = maxval(bending, dim=2)
         of%along = [(along(j, maxloc(abs(along(j, :)), dim=1)), j=1, n)]
         of%both = maxval(both, dim=2)
         of%place = [(part(maxloc(both(j, :), dim=1), places_along), j=1, n)]
         of%worst = [maxloc(of%bending, dim=1), maxloc(abs(of%along), dim=1), maxloc(of%both, dim=1)]
         of%at = study%cycle%crank%input(of%worst)
         of%where = [part(maxloc(bending(of%worst(1), :), dim=1), places_along), &
                     part(maxloc(abs(along(of%worst(2), :)), dim=1), places_along), of%place(of%worst(3))]
      end associate
   end subroutine find_stresses

   !> How much loads and springs between the pins couple the lowest modes.
   real(wp) function mixing_of(set, vibration, link, w, length) result(mixing)
      type(data_set_t), intent(in) :: set
      type(vibration_group_t), intent(in) :: vibration
      type(moving_link_t), intent(in) :: link
      real(wp), intent(in) :: w, length          !! as of `find_mode`
      type(moving_link_t) :: bare
      type(periodic_t) :: with, without
      real(wp) :: mixed(vibration%points), stiffness(vibration%points, modes_mixed)
      integer :: i, j

      mixing = 0.0_wp
      if (size(link%acting) == 0) return
      bare = link
      deallocate (bare%acting)
      do j = 1, modes_mixed
         with = mode_stiffness(link, j)
         stiffness(:, j) = max(with%values(vibration%points) + w*mode_factor(set, length, j), tiny(1.0_wp))
         do i = 1, j - 1
            with = coupling(link, i, j)
            without = coupling(bare, i, j)
            mixed = with%values(vibration%points) - without%values(vibration%points)
            mixing = max(mixing, maxval(abs(mixed)/sqrt(stiffness(:, i)*stiffness(:, j))))
         end do
      end do
   end function mixing_of

   !> All modes together, with what couples them.
   subroutine find_multipliers(set, vibration, link, w, study)
      type(data_set_t), intent(in) :: set
      type(vibration_group_t), intent(in) :: vibration
      type(moving_link_t), intent(in) :: link
      real(wp), intent(in) :: w
      type(vibration_study_t), intent(inout) :: study
      type(periodic_t) :: k(vibration%modes, vibration%modes)
      real(wp) :: damping(vibration%modes), stiffness, exact
      integer :: i, j, n

      do j = 1, size(damping)
         do i = 1, size(damping)
            k(i, j) = coupling(link, i, j)
         end do
         stiffness = w*mode_factor(set, study%cycle%length, j)
         k(j, j) = k(j, j)%plus(periodic_constant(stiffness))
         damping(j) = 2.0_wp*vibration%beam%damping*sqrt(stiffness)
      end do
      deallocate (study%multipliers)
      allocate (study%multipliers(2*size(damping)))
      call coupled_multipliers(k, damping, coupled_tolerance, study%multipliers, study%multiplier_error, study%multipliers_found)
      study%stable = study%multipliers_found .and. maxval(abs(study%multipliers)) < 1.0_wp - 16.0_wp*study%multiplier_error
      ! the product of all against exp(-2 pi sum of the dampings); beside large multipliers the small ones lose digits. Both may be
      ! below the smallest number
      n = size(damping)
      exact = exp(-2.0_wp*pi*sum(damping))
      study%determinant_error = abs(product(study%multipliers) - exact)/ &
                                max(exact, abs(product(study%multipliers(:n))), tiny(1.0_wp))
   end subroutine find_multipliers

   !> Mode 1 at another speed.
   function row_at(set, vibration, cycle_of, euler, speed, tolerance_of) result(row)
      type(data_set_t), intent(in) :: set
      type(vibration_group_t), intent(in) :: vibration
      type(link_cycle_t), intent(in) :: cycle_of
      real(wp), intent(in) :: euler   !! first frequency of the slender link, rad/s
      real(wp), intent(in) :: speed   !! rad/s
      real(wp), intent(in) :: tolerance_of !! of the period's matrix
      type(speed_row_t) :: row
      type(moving_link_t) :: link
      type(periodic_t) :: f
      type(hill_t) :: hill
      real(wp) :: stiffness

      link = moving_link(cycle_of, speed, 1.0_wp)
      f = mode_stiffness(link, 1)
      stiffness = (euler/speed)**2*mode_factor(set, cycle_of%length, 1)
      hill = solve_hill(periodic_constant(2.0_wp*vibration%beam%damping*sqrt(stiffness)), &
                        f%plus(periodic_constant(stiffness)), mode_force(link, 1), tolerance_of)
      row%speed = speed
      row%stable = hill%stable
      row%grows = .not. (hill%stable .or. hill%neutral)
      row%determinant_error = hill%determinant_error
      row%known = hill%unique
      if (hill%unique) row%amplitude = cycle_of%length*greatest_of(hill)
   end function row_at

   !> Speeds at which mode 1 grows, with its damping and at each speed its own weight and loads. Looked at are the
   !> speeds of the table, some between each two boundaries of the given speed, and one in each gap, so that nothing narrow is lost.
   !> None where the host ends it.
   subroutine find_bands(set, vibration, euler, study, stop)
      type(data_set_t), intent(in) :: set
      type(vibration_group_t), intent(in) :: vibration
      real(wp), intent(in) :: euler
      type(vibration_study_t), intent(inout) :: study
      type(stop_t), intent(in), optional :: stop
      real(wp) :: edge, low, high
      real(wp), allocatable :: places(:)
      logical, allocatable :: grows(:)
      integer :: i, p

      associate (b => study%modes(1)%exact)
         places = study%speeds%speed
         do p = 1, ubound(b%low, 1)
            if (b%low(p) <= 0.0_wp) cycle
            low = study%frequency/sqrt(b%high(p))
            high = study%frequency/sqrt(b%low(p))
            do i = 1, in_tongue
               call look_at(low + (high - low)*real(i, wp)/real(in_tongue + 1, wp))
            end do
            if (p < ubound(b%low, 1)) call look_at(0.5_wp*(low + study%frequency/sqrt(b%low(p + 1))))
         end do
      end associate
      places = places(ascending(places))
      allocate (grows(size(places)))
      do i = 1, size(places)
         if (is_to_end(stop)) return
         grows(i) = grows_at(places(i))
      end do
      deallocate (study%bands)
      allocate (study%bands(0))
      low = places(1)
      do i = 2, size(places)
         if (grows(i) .neqv. grows(i - 1)) then
            edge = edge_between(places(i - 1), places(i), grows(i - 1))
            if (is_to_end(stop)) then
               deallocate (study%bands)
               allocate (study%bands(0))
               return
            end if
            if (grows(i)) low = edge
            if (grows(i - 1)) study%bands = [study%bands, speed_band_t(low, edge)]
         end if
      end do
      if (grows(size(places))) study%bands = [study%bands, speed_band_t(low, places(size(places)))]

   contains

      subroutine look_at(speed)
         real(wp), intent(in) :: speed

         if (speed > vibration%slowest .and. speed < vibration%fastest) places = [places, speed]
      end subroutine look_at

      logical function grows_at(speed)
         real(wp), intent(in) :: speed
         type(speed_row_t) :: row

         row = row_at(set, vibration, study%cycle, euler, speed, tolerance)
         grows_at = row%grows
      end function grows_at

      !> By bisection.
      real(wp) function edge_between(from, to, grows_first)
         real(wp), intent(in) :: from, to
         logical, intent(in) :: grows_first
         real(wp) :: a, b, middle

         a = from
         b = to
         do while (b - a > sharpness*b .and. .not. is_to_end(stop))
            middle = 0.5_wp*(a + b)
            if (grows_at(middle) .eqv. grows_first) then
               a = middle
            else
               b = middle
            end if
         end do
         edge_between = 0.5_wp*(a + b)
      end function edge_between
   end subroutine find_bands
end submodule psalm_vibration_study_body
