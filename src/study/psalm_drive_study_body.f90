!> How a flexible drive and Hill's equation are solved. Only this knows what DRIVEL and HILL have.
submodule(psalm_drive_study) psalm_drive_study_body
   use psalm_drive_group, only: hill_group_t, hill_of, drive_group_t, drive_of
   use psalm_flexible_drive, only: drive_response, drive_torque_t, mean_ratio, least_ratio, ratio_for_mean
   use psalm_force_model, only: parameter_mass, parameter_mx, parameter_my, parameter_inertia
   use psalm_coupled_hill, only: solve_coupled, places_for
   use psalm_hill, only: solve_hill, greatest_of
   use psalm_kinds, only: pi
   use psalm_link_cycle, only: inertia_at_crank
   use psalm_reduced, only: reduced_t, reduce_machine
   use psalm_mechanism, only: mechanism_t, body_frame, joint_revolute
   use psalm_periodic, only: periodic_t, periodic_constant, periodic_from_samples
   use psalm_rate_study, only: rate_study_t, find_rates
   use psalm_stop, only: is_to_end, tell_host
   implicit none (type, external)

   real(wp), parameter :: tolerance = 1.0e-10_wp
   ! Haines's rule: a harmonic of the crank's acceleration matters above the first size where links may resonate, that is from
   ! ten times the speed of the crank, and above the second below
   integer, parameter :: from_resonance = 10
   real(wp), parameter :: matters_above = 0.001_wp, matters_below = 0.05_wp

contains

   module procedure matters

      matters = n > 0 .and. amplitude > merge(matters_above, matters_below, n >= from_resonance)
   end procedure matters

   module procedure find_drive
      type(drive_group_t) :: drive
      type(force_model_t) :: used
      type(drive_torque_t), allocatable :: acting ! not allocated: absent
      type(periodic_t) :: inertia, y
      real(wp), allocatable :: whole(:)
      real(wp) :: natural, speed, waves
      integer :: n, i
      logical :: ok

      drive = drive_of(set)
      allocate (study%speeds(0), study%swing(0:drive%harmonics), study%acceleration(0:drive%harmonics), &
                study%output(0:drive%harmonics, 0), study%rigid(0:drive%harmonics, 0))
      study%swing = 0.0_wp
      study%acceleration = 0.0_wp
      if (drive%ripple > 0.0_wp) then
         study%waves = 2
         study%turn%crank = crank
         study%inertia = drive%extra*(1.0_wp + drive%ripple*crank%sense &
                                          *[(sin(2.0_wp*pi*real(i - 1, wp)/real(drive%points, wp)), i=1, drive%points)])
      else
         used = model
         if (.not. drive%offsets) then
            call inertia_at_crank(given, dimensions, model, drive%points, crank, whole, study%turn)
            if (study%turn%failure > 0) return
            whole = whole + drive%extra
            if (all(whole > 0.0_wp)) study%with_offsets = extent_of(whole)
            call drop_offsets(given%mechanism, used)
         end if
         call inertia_at_crank(given, dimensions, used, drive%points, crank, study%inertia, study%turn)
         if (study%turn%failure > 0) return
         study%inertia = study%inertia + drive%extra
         call find_torque(given, model, study)
      end if
      waves = real(study%waves, wp) ! x = waves phi, y = waves theta
      study%massless = .not. all(study%inertia > 0.0_wp)
      if (study%massless) return
      inertia = periodic_from_samples(study%inertia)
      study%of_crank = extent_of(study%inertia)
      speed = crank%speed
      study%resolution = inertia%resolution()
      if (study%loaded .or. crank%varies) then
         acting = acting_at(study, speed)
         study%resolution = max(study%resolution, acting%torque%resolution(), acting%damping%resolution(), &
                                acting%push%resolution())
      end if
      if (drive%ratio > 0.0_wp) then
         call ratio_for_mean(inertia, drive%ratio/waves, study%d, ok, acting=acting)
         if (.not. ok) return
         study%stiffness = (waves*study%d*speed)**2*study%of_crank%mean
      else
         study%stiffness = drive%stiffness
         study%d = sqrt(study%stiffness/study%of_crank%mean)/(waves*speed)
      end if
      if (is_to_end(stop)) return
      study%found = .true.
      call mean_ratio(inertia, study%d, study%ratio, study%ratio_real, acting)
      study%ratio = waves*study%ratio
      study%least = waves*least_ratio(inertia, study%d, acting)
      study%hill = drive_response(inertia, study%d, drive%damping, tolerance, acting)
      if (study%hill%unique) then
         study%greatest = greatest_of(study%hill)/waves
         y = periodic_from_samples(study%hill%y/waves)
         do n = 0, drive%harmonics
            if (modulo(n, study%waves) == 0) study%swing(n) = y%amplitude(n/study%waves)
         end do
         y = periodic_from_samples(waves*study%hill%y2)
         if (crank%varies) y = y%plus(acting%push)
         do n = 0, drive%harmonics
            if (modulo(n, study%waves) == 0) study%acceleration(n) = y%amplitude(n/study%waves)
         end do
         if (.not. drive%ripple > 0.0_wp) call follow_output(set, drive, given, dimensions, study)
      end if
      natural = sqrt(study%stiffness/study%of_crank%mean)
      deallocate (study%speeds)
      allocate (study%speeds(drive%speeds))
      do i = 1, drive%speeds
         if (is_to_end(stop)) then
            study%speeds = study%speeds(:i - 1)
            return
         end if
         associate (row => study%speeds(i), first => drive%slowest, last => drive%fastest)
            row%speed = first
            if (drive%speeds > 1) row%speed = first + (last - first)*real(i - 1, wp)/real(drive%speeds - 1, wp)
            if (allocated(acting)) acting = acting_at(study, row%speed)
            call find_row(inertia, natural/(waves*row%speed), waves, drive%damping, row, acting)
         end associate
         call tell_host(stop, i, drive%speeds)
      end do
   end procedure find_drive

   !> Torque of weight, loads, springs and dampers on the crank, where the centres of mass are.
   subroutine find_torque(given, model, study)
      type(problem_t), intent(in) :: given
      type(force_model_t), intent(in) :: model
      type(drive_study_t), intent(inout) :: study
      class(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(reduced_t) :: reduced

      study%loaded = size(model%loads) > 0 .or. size(model%springs) > 0 .or. any(abs(model%gravity) > 0.0_wp)
      if (.not. study%loaded) return
      allocate (problem, source=given)
      call reduce_machine(problem, model, study%turn%crank%input, reduced)
      study%torque = study%turn%crank%sense*reduced%torque
      study%viscous = reduced%damping
   end subroutine find_torque

   !> What acts on the crank at a speed.
   pure type(drive_torque_t) function acting_at(study, speed)
      type(drive_study_t), intent(in) :: study
      real(wp), intent(in) :: speed              !! rad/s

      acting_at%torque = periodic_constant(0.0_wp)
      acting_at%damping = periodic_constant(0.0_wp)
      acting_at%rate = periodic_constant(1.0_wp)
      acting_at%push = periodic_constant(0.0_wp)
      if (study%loaded) then
         acting_at%torque = periodic_from_samples(study%torque/(study%of_crank%mean*speed**2))
         acting_at%damping = periodic_from_samples(study%viscous/(study%of_crank%mean*speed))
      end if
      if (.not. study%turn%crank%varies) return
      acting_at%rate = periodic_from_samples(study%turn%crank%rate)
      acting_at%push = periodic_from_samples(study%turn%crank%push)
   end function acting_at

   pure type(inertia_t) function extent_of(samples)
      real(wp), intent(in) :: samples(:) !! positive
      type(periodic_t) :: inertia, slope

      inertia = periodic_from_samples(samples)
      slope = inertia%derivative(1)
      extent_of%mean = inertia%mean()
      extent_of%half_range = 0.5_wp*(maxval(samples) - minval(samples))/extent_of%mean
      extent_of%steepest = maxval(abs(slope%values(size(samples))))/(2.0_wp*extent_of%mean)
   end function extent_of

   !> Harmonics of the output's acceleration when the crank swings, and when it does not: o'' (psi' + y')**2 + o' (psi'' + y'').
   subroutine follow_output(set, drive, given, dimensions, study)
      type(data_set_t), intent(in) :: set
      type(drive_group_t), intent(in) :: drive
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(drive_study_t), intent(inout) :: study
      class(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(rate_study_t) :: rates
      type(periodic_t) :: swing, flexible, rigid
      real(wp), dimension(drive%points) :: d1, d2, rate, push
      integer :: c, n

      allocate (problem, source=given)
      call problem%set_inputs(study%turn%crank%input)
      call find_rates(set, problem, dimensions, rates, every_arc=.false.)
      if (rates%is_violating()) return
      swing = periodic_from_samples(study%hill%y1)
      d1 = swing%values(drive%points)
      swing = periodic_from_samples(study%hill%y2)
      d2 = swing%values(drive%points)
      rate = 1.0_wp
      push = 0.0_wp
      if (study%turn%crank%varies) then
         rate = study%turn%crank%rate
         push = study%turn%crank%push
      end if
      deallocate (study%output, study%rigid)
      allocate (study%output(0:drive%harmonics, size(rates%by_input, 2)))
      allocate (study%rigid, mold=study%output)
      do c = 1, size(study%output, 2)
         associate (o1 => study%turn%crank%sense*rates%by_input(1, c, :), o2 => rates%by_input(2, c, :))
            rigid = periodic_from_samples(o2*rate**2 + o1*push)
            flexible = periodic_from_samples(o2*(rate + d1)**2 + o1*(push + d2))
         end associate
         do n = 0, drive%harmonics
            study%rigid(n, c) = rigid%amplitude(n)
            study%output(n, c) = flexible%amplitude(n)
         end do
      end do
   end subroutine follow_output

   !> Put the mass of every link on its pivot in the frame, if it has one, else on its reference, with its inertia about its
   !> own centre, as the case study did.
   pure subroutine drop_offsets(mechanism, model)
      type(mechanism_t), intent(in) :: mechanism
      type(force_model_t), intent(inout) :: model
      integer :: body, j

      do body = 1, size(model%inertia, 2)
         associate (m => model%inertia(:, body))
            if (m(parameter_mass) > 0.0_wp) then
               m(parameter_inertia) = m(parameter_inertia) - (m(parameter_mx)**2 + m(parameter_my)**2)/m(parameter_mass)
            end if
            m(parameter_mx) = 0.0_wp
            m(parameter_my) = 0.0_wp
         end associate
      end do
      do j = 1, size(mechanism%joints)
         associate (joint => mechanism%joints(j))
            if (joint%kind /= joint_revolute .or. all(joint%bodies /= body_frame)) cycle
            model%inertia(parameter_mass, joint%bodies) = 0.0_wp
         end associate
      end do
   end subroutine drop_offsets

   subroutine find_row(inertia, d, waves, damping, row, acting)
      type(periodic_t), intent(in) :: inertia
      real(wp), intent(in) :: d, waves, damping
      type(drive_row_t), intent(inout) :: row
      type(drive_torque_t), intent(in), optional :: acting
      type(hill_t) :: hill

      hill = drive_response(inertia, d, damping, tolerance, acting)
      row%stable = hill%stable
      row%known = hill%unique
      row%grows = .not. (hill%stable .or. hill%neutral)
      if (hill%unique) row%amplitude = greatest_of(hill)/waves
   end subroutine find_row

   module procedure find_hill
      type(hill_group_t) :: hill
      type(periodic_t) :: c1, c0, p, y
      integer :: n

      hill = hill_of(set)
      if (hill%equations > 1) then
         call find_coupled(hill, study)
         return
      end if
      c1 = periodic_from_samples(hill%c1)
      c0 = periodic_from_samples(hill%c0)
      p = periodic_from_samples(hill%p)
      study%resolution = max(c1%resolution(), c0%resolution(), p%resolution())
      study%hill = solve_hill(c1, c0, p, hill%tolerance)
      allocate (study%amplitude(0:hill%harmonics), source=0.0_wp)
      if (.not. study%hill%unique) return
      study%greatest = greatest_of(study%hill)
      y = periodic_from_samples(study%hill%y)
      do n = 0, hill%harmonics
         study%amplitude(n) = y%amplitude(n)
      end do
   end procedure find_hill

   !> Several equations.
   subroutine find_coupled(hill, study)
      type(hill_group_t), intent(in) :: hill
      type(hill_study_t), intent(inout) :: study
      type(periodic_t) :: c(hill%equations, hill%equations), k(hill%equations, hill%equations), p(hill%equations), y
      integer :: i, j, n

      do i = 1, hill%equations
         p(i) = periodic_from_samples(hill%load(:, i))
         study%resolution = max(study%resolution, p(i)%resolution())
         do j = 1, hill%equations
            c(i, j) = periodic_from_samples(hill%damping(:, i, j))
            k(i, j) = periodic_from_samples(hill%stiffness(:, i, j))
            study%resolution = max(study%resolution, c(i, j)%resolution(), k(i, j)%resolution())
         end do
      end do
      allocate (study%coupled, study%amplitudes(0:hill%harmonics, hill%equations), study%peaks(hill%equations), study%amplitude(0))
      study%amplitudes = 0.0_wp
      study%peaks = 0.0_wp
      call solve_coupled(c, k, p, hill%tolerance, places_for(2*size(hill%load, 1)), study%coupled)
      if (.not. study%coupled%unique) return
      do i = 1, hill%equations
         study%peaks(i) = maxval(abs(study%coupled%y(:, i)))
         y = periodic_from_samples(study%coupled%y(:, i))
         do n = 0, hill%harmonics
            study%amplitudes(n, i) = y%amplitude(n)
         end do
      end do
   end subroutine find_coupled
end submodule psalm_drive_study_body
