!> A flexible drive and the flexible links that it drives together: coupled Hill equations (Haines, 9C). Data in, results out.
!>
!> Unknowns are the swing th of the crank about its steady turning and the modes q of the links, of unit mass, which bend in axes
!> that move as in the rigid linkage. To first order in th and q the kinetic energy is J(phi) phi'**2/2 + phi' sum A q' +
!> phi'**2 sum D q + sum M q' q'/2, phi = w t + th. So a mode is loaded by -A phi'' - B phi'**2 + F(phi) with B = A' - D, all of
!> them from the forces of the rigid linkage (kalm's) at unit push, at unit speed and at rest, and the same A, D and F act back on
!> the crank. Where the far end of the shaft turns by psi(x) at a speed that varies, phi = psi + th: the load of a mode is that of
!> the rigid linkage at this speed, B is what is left of it without A psi'', over psi'**2, and derivatives by phi are those by x
!> over psi'.
module psalm_drive_links_study
   use psalm_coupled_hill, only: coupled_t, solve_coupled, without_mass, places_for
   use psalm_crank_motion, only: crank_motion_t
   use psalm_data_set, only: data_set_t
   use psalm_drive_group, only: drive_group_t, drive_of
   use psalm_drive_study, only: drive_study_t
   use psalm_flex_study, only: flex_study_t, mass_of_modes
   use psalm_flexible_cycle, only: part_inertia, part_fixed, part_damped, part_pushed
   use psalm_kinds, only: wp
   use psalm_linear, only: solve_positive
   use psalm_periodic, only: periodic_t, periodic_constant, periodic_from_samples
   implicit none (type, external)
   private
   public :: drive_links_t, find_drive_links, drive_links_fit

   real(wp), parameter :: tolerance = 1.0e-8_wp  !! of a period's matrix
   integer, parameter :: finer = 2               !! positions in a turn, times those of drive and links

   type :: drive_links_t
      integer :: modes = 0                       !! of all links
      integer, allocatable :: links(:)           !! shape (modes): whose they are
      logical :: possible = .false.              !! the mass matrix is positive all over the turn
      type(coupled_t) :: coupled                 !! the swing of the crank, then the modes over root(J0)
      real(wp) :: greatest = 0.0_wp              !! swing of the crank, rad
      real(wp), allocatable :: peaks(:)          !! shape (modes): greatest displacement in each mode, m
      real(wp), allocatable :: rigid_drive(:)    !! the same with a rigid drive
      real(wp), allocatable :: swing(:)          !! shape (0:harmonics): harmonics of the crank's swing, rad
   end type drive_links_t

contains

   !> True if a case asks for a drive and for links that are solved together.
   pure logical function drive_links_fit(drive, study, links) result(fit)
      type(drive_group_t), intent(in) :: drive
      type(drive_study_t), intent(in) :: study
      type(flex_study_t), intent(in) :: links(:)

      fit = study%found .and. drive%offsets .and. .not. drive%ripple > 0.0_wp .and. any(links%solved_modes > 0)
   end function drive_links_fit

   !> The steady state of both together.
   subroutine find_drive_links(set, drive_study, links, study)
      type(data_set_t), intent(in) :: set
      type(drive_study_t), intent(in) :: drive_study
      type(flex_study_t), intent(in) :: links(:)
      type(drive_links_t), intent(out) :: study
      type(drive_group_t) :: drive
      real(wp), allocatable :: m(:, :, :), c(:, :, :), k(:, :, :), p(:, :)
      type(periodic_t), allocatable :: damping(:, :), stiffness(:, :), load(:)
      type(periodic_t) :: y
      integer :: i, j, n, points

      drive = drive_of(set)
      study%links = [integer ::]
      do i = 1, size(links)
         study%links = [study%links, [(i, j=1, links(i)%solved_modes)]]
      end do
      study%modes = size(study%links)
      points = finer*max(size(drive_study%inertia), maxval([(size(links(i)%cycle%turning), i=1, size(links))]))
      call find_matrices(drive, drive_study, links, points, m, c, k, p)
      study%possible = all([(is_positive(m(:, :, n)), n=1, points)])
      if (.not. study%possible) return
      associate (size_of => study%modes + 1)
         allocate (damping(size_of, size_of), stiffness(size_of, size_of), load(size_of))
      end associate
      call without_mass(m, c, k, p, damping, stiffness, load)
      call solve_coupled(damping, stiffness, load, tolerance, places_for(points), study%coupled)
      allocate (study%peaks(study%modes), study%rigid_drive(study%modes), study%swing(0:drive%harmonics), source=0.0_wp)
      if (.not. study%coupled%unique) return
      study%greatest = maxval(abs(study%coupled%y(:, 1)))
      y = periodic_from_samples(study%coupled%y(:, 1))
      do n = 0, drive%harmonics
         study%swing(n) = y%amplitude(n)
      end do
      n = 0
      do i = 1, size(links)
         do j = 1, links(i)%solved_modes
            n = n + 1
            study%peaks(n) = maxval(abs(study%coupled%y(:, n + 1)))*sqrt(drive_study%of_crank%mean)*links(i)%widest(j)
            if (links(i)%coupled%unique) study%rigid_drive(n) = maxval(abs(links(i)%coupled%y(:, j)))*links(i)%widest(j)
         end do
      end do
   end subroutine find_drive_links

   !> M y'' + C y' + K y = p at equal steps of a turn, over J0 w**2.
   subroutine find_matrices(drive, drive_study, links, points, m, c, k, p)
      type(drive_group_t), intent(in) :: drive
      type(drive_study_t), intent(in) :: drive_study
      type(flex_study_t), intent(in) :: links(:)
      integer, intent(in) :: points
      real(wp), allocatable, intent(out) :: m(:, :, :), c(:, :, :), k(:, :, :) !! shape (unknowns, unknowns, points)
      real(wp), allocatable, intent(out) :: p(:, :) !! shape (unknowns, points)
      type(periodic_t) :: g, d1, d2, torque, viscous
      type(crank_motion_t) :: crank
      real(wp), dimension(points) :: values, rate, push
      real(wp) :: speed, root
      integer :: i, j, l, n, first, unknowns

      crank = drive_study%turn%crank%at_steps(points)
      speed = crank%speed
      rate = 1.0_wp
      push = 0.0_wp
      if (crank%varies) then
         rate = crank%rate
         push = crank%push
      end if
      root = sqrt(drive_study%of_crank%mean)
      unknowns = 1 + sum(links%solved_modes)
      allocate (m(unknowns, unknowns, points), c(unknowns, unknowns, points), k(unknowns, unknowns, points), p(unknowns, points), &
                source=0.0_wp)
      g = periodic_from_samples(drive_study%inertia/drive_study%of_crank%mean)
      d1 = g%derivative(1)
      d2 = g%derivative(2)
      torque = periodic_constant(0.0_wp)
      viscous = periodic_constant(0.0_wp)
      if (drive_study%loaded) then
         torque = periodic_from_samples(drive_study%torque/(root*speed)**2)
         viscous = periodic_from_samples(drive_study%viscous/(root**2*speed))
      end if
      m(1, 1, :) = g%values(points)
      values = viscous%values(points)
      c(1, 1, :) = d1%values(points) + drive%damping*drive_study%d + values
      p(1, :) = -0.5_wp*d1%values(points)*rate + torque%values(points) - values*rate - m(1, 1, :)*push
      torque = torque%derivative(1)
      viscous = viscous%derivative(1)
      k(1, 1, :) = drive_study%d**2 + 0.5_wp*d2%values(points) - torque%values(points)/rate + viscous%values(points) &
                   + 0.5_wp*d1%values(points)*push/rate
      first = 1
      do l = 1, size(links)
         do j = 1, links(l)%solved_modes
            n = first + j
            call weigh(l, j, n)
            do i = 1, links(l)%solved_modes
               c(n, first + i, :) = c(n, first + i, :) + links(l)%c(j, i)%values(points)
               k(n, first + i, :) = links(l)%k(j, i)%values(points)
            end do
            call couple(links(l)%forces(:, j, :), links(l)%cycle%turn%crank, n)
         end do
         first = first + links(l)%solved_modes
      end do

   contains

      !> Mass between a mode and the others, and its growth.
      subroutine weigh(l, j, n)
         integer, intent(in) :: l, j             !! link and mode
         integer, intent(in) :: n                !! unknown
         type(periodic_t) :: mass
         integer :: column, other, i, position

         column = 1
         do other = 1, size(links)
            do i = 1, links(other)%solved_modes
               column = column + 1
               mass = periodic_from_samples([(mass_of_modes(links(l), j, links(other), i, position), &
                                              position=1, size(links(l)%cycle%turning))])
               m(n, column, :) = mass%values(points)
               mass = mass%derivative(1)
               c(n, column, :) = c(n, column, :) + mass%values(points)
            end do
         end do
      end subroutine weigh

      !> A mode and the crank.
      subroutine couple(forces, turning, n)
         real(wp), intent(in) :: forces(:, :)    !! shape (positions, parts)
         type(crank_motion_t), intent(in) :: turning !! at these positions
         integer, intent(in) :: n
         type(periodic_t) :: a, b, d, f, r, slope

         a = periodic_from_samples(-forces(:, part_pushed)/root)
         b = periodic_from_samples(-forces(:, part_inertia)/root)
         f = periodic_from_samples(forces(:, part_fixed)/(root*speed**2))
         r = periodic_from_samples(forces(:, part_damped)/(root*speed))
         slope = a%derivative(1)
         m(1, n, :) = a%values(points)
         m(n, 1, :) = m(1, n, :)
         p(n, :) = -b%values(points) + f%values(points) + r%values(points)
         if (turning%varies) then
            b = periodic_from_samples((forces(:, part_pushed)*turning%push - forces(:, part_inertia))/(root*turning%rate**2))
            r = periodic_from_samples(forces(:, part_damped)/(root*speed*turning%rate))
            d = periodic_from_samples(slope%values(points)/rate - b%values(points))
         else
            d = slope%plus(b%scaled(-1.0_wp))
         end if
         values = r%values(points)
         c(1, n, :) = 2.0_wp*d%values(points)*rate - values
         c(n, 1, :) = 2.0_wp*b%values(points)*rate - values
         k(1, n, :) = 2.0_wp*d%values(points)*push
         d = d%derivative(1)
         b = b%derivative(1)
         f = f%derivative(1)
         r = r%derivative(1)
         values = f%values(points)/rate
         k(1, n, :) = k(1, n, :) + (d%values(points)*rate - values)
         k(n, 1, :) = b%values(points)*rate - values - r%values(points) + slope%values(points)*push/rate
      end subroutine couple
   end subroutine find_matrices

   !> True if a mass matrix is positive definite.
   pure logical function is_positive(m)
      real(wp), intent(in) :: m(:, :)
      real(wp) :: right(size(m, 1)), unused(size(m, 1))

      right = 0.0_wp
      call solve_positive(m, right, unused, is_positive)
   end function is_positive
end module psalm_drive_links_study
