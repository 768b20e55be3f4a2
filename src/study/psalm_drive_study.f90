!> Steady state of a flexible drive (group DRIVEL), and of a Hill equation given by tables (group HILL). Data in, results out.
!> Source: Haines, chapter 7.
module psalm_drive_study
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_flexible_drive, only: drive_response, mean_ratio, ratio_for_mean
   use psalm_force_model, only: force_model_t, parameter_mass, parameter_mx, parameter_my, parameter_inertia
   use psalm_hill, only: hill_t, solve_hill
   use psalm_kinds, only: wp
   use psalm_link_cycle, only: link_cycle_t, inertia_at_crank
   use psalm_mechanism, only: mechanism_t, body_frame, joint_revolute
   use psalm_periodic, only: periodic_t, periodic_from_samples
   implicit none (type, external)
   private
   public :: drive_study_t, hill_study_t, drive_row_t, find_drive, find_hill

   real(wp), parameter :: tolerance = 1.0e-10_wp

   type :: drive_row_t
      real(wp) :: speed = 0.0_wp                 !! rad/s
      real(wp) :: amplitude = 0.0_wp             !! greatest swing of the crank, rad
      logical :: known = .false., stable = .false.
   end type drive_row_t

   type :: drive_study_t
      type(link_cycle_t) :: turn                 !! where the crank cannot turn
      real(wp) :: mean_inertia = 0.0_wp          !! J0, kg m2
      real(wp) :: half_range = 0.0_wp            !! of J over J0
      real(wp) :: steepest = 0.0_wp              !! greatest |J'|/(2 J0)
      real(wp) :: stiffness = 0.0_wp             !! S, N m/rad
      real(wp) :: d = 0.0_wp                     !! sqrt(S/J0)/speed
      real(wp) :: ratio = 0.0_wp                 !! mean of frequency/speed
      logical :: ratio_real = .false.            !! it is real all over the turn
      type(hill_t) :: hill                       !! swing of the crank, rad, and its derivatives by its angle
      real(wp), allocatable :: inertia(:)        !! at the positions of a turn, kg m2
      real(wp), allocatable :: swing(:), acceleration(:) !! shape (0:harmonics): harmonics of y and y''
      type(drive_row_t), allocatable :: speeds(:)
      logical :: massless = .false.              !! there is no inertia somewhere
      logical :: found = .false.
   end type drive_study_t

   type :: hill_study_t
      type(hill_t) :: hill
      real(wp), allocatable :: amplitude(:)      !! shape (0:harmonics)
      real(wp) :: resolution = 0.0_wp            !! what the tables leave open
   end type hill_study_t

contains

   !> Steady state of the drive at the speed of RATES.
   subroutine find_drive(set, given, dimensions, model, study)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      type(drive_study_t), intent(out) :: study
      type(force_model_t) :: used
      type(periodic_t) :: inertia, slope, y
      real(wp) :: natural, speed
      integer :: n, i
      logical :: ok

      allocate (study%speeds(0), study%swing(0:set%drive%harmonics), study%acceleration(0:set%drive%harmonics))
      study%swing = 0.0_wp
      study%acceleration = 0.0_wp
      used = model
      if (.not. set%drive%offsets) call drop_offsets(given%mechanism, used)
      call inertia_at_crank(given, dimensions, used, set%drive%points, study%inertia, study%turn)
      if (study%turn%trouble > 0) return
      study%inertia = study%inertia + set%drive%extra
      study%massless = .not. all(study%inertia > 0.0_wp)
      if (study%massless) return
      inertia = periodic_from_samples(study%inertia)
      study%mean_inertia = inertia%mean()
      study%half_range = 0.5_wp*(maxval(study%inertia) - minval(study%inertia))/study%mean_inertia
      slope = inertia%derivative(1)
      study%steepest = maxval(abs(slope%values(set%drive%points)))/(2.0_wp*study%mean_inertia)
      speed = abs(set%speed)
      if (set%drive%ratio > 0.0_wp) then
         call ratio_for_mean(inertia, set%drive%ratio, study%d, ok)
         if (.not. ok) return
         study%stiffness = (study%d*speed)**2*study%mean_inertia
      else
         study%stiffness = set%drive%stiffness
         study%d = sqrt(study%stiffness/study%mean_inertia)/speed
      end if
      study%found = .true.
      call mean_ratio(inertia, study%d, study%ratio, study%ratio_real)
      study%hill = drive_response(inertia, study%d, set%drive%damping, tolerance)
      if (study%hill%unique) then
         y = periodic_from_samples(study%hill%y)
         do n = 0, set%drive%harmonics
            study%swing(n) = y%amplitude(n)
         end do
         y = periodic_from_samples(study%hill%y2)
         do n = 0, set%drive%harmonics
            study%acceleration(n) = y%amplitude(n)
         end do
      end if
      natural = sqrt(study%stiffness/study%mean_inertia)
      deallocate (study%speeds)
      allocate (study%speeds(set%drive%speeds))
      do i = 1, set%drive%speeds
         associate (row => study%speeds(i), first => set%drive%slowest, last => set%drive%fastest)
            row%speed = first
            if (set%drive%speeds > 1) row%speed = first + (last - first)*real(i - 1, wp)/real(set%drive%speeds - 1, wp)
            call find_row(inertia, natural/row%speed, set%drive%damping, row)
         end associate
      end do
   end subroutine find_drive

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

   subroutine find_row(inertia, d, damping, row)
      type(periodic_t), intent(in) :: inertia
      real(wp), intent(in) :: d, damping
      type(drive_row_t), intent(inout) :: row
      type(hill_t) :: hill

      hill = drive_response(inertia, d, damping, tolerance)
      row%stable = hill%stable
      row%known = hill%unique
      if (hill%unique) row%amplitude = maxval(abs(hill%y))
   end subroutine find_row

   !> Steady state of the Hill equation of the tables.
   subroutine find_hill(set, study)
      type(data_set_t), intent(in) :: set
      type(hill_study_t), intent(out) :: study
      type(periodic_t) :: c1, c0, p, y
      integer :: n

      c1 = periodic_from_samples(set%hill%c1)
      c0 = periodic_from_samples(set%hill%c0)
      p = periodic_from_samples(set%hill%p)
      study%resolution = max(c1%resolution(), c0%resolution(), p%resolution())
      study%hill = solve_hill(c1, c0, p, set%hill%tolerance)
      allocate (study%amplitude(0:set%hill%harmonics), source=0.0_wp)
      if (.not. study%hill%unique) return
      y = periodic_from_samples(study%hill%y)
      do n = 0, set%hill%harmonics
         study%amplitude(n) = y%amplitude(n)
      end do
   end subroutine find_hill
end module psalm_drive_study
