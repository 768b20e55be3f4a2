!> Vibration, deflections and stresses of a link of beam elements in a moving linkage (group FLEX). Data in, results out.
!>
!> The link bends in axes between two of its joints (or is clamped at one) that move as in the rigid linkage; inertia, weight, loads
!> and the forces of its joints are those of the rigid motion (kalm's). Its natural modes obey coupled Hill equations: tension and
!> compression, turning and its changes, and springs couple them. What higher modes add is taken from statics. Sources: Oldham,
!> chapter 13 and 15.3; Haines, 2F; Przemieniecki (1968).
module psalm_flex_study
   use psalm_coupled_hill, only: coupled_t
   use psalm_crank_motion, only: crank_motion_t
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_driven_masses, only: influence_t, mass_between, origin_motion
   use psalm_error, only: problem_t
   use psalm_flexible_cycle, only: flexible_cycle_t
   use psalm_flexible_link, only: flexible_link_t
   use psalm_force_model, only: force_model_t
   use psalm_kinds, only: wp
   use psalm_out_of_plane_study, only: out_of_plane_t
   use psalm_periodic, only: periodic_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: flex_study_t, find_flex, mass_of_modes

   integer, parameter, public :: stress_kinds = 3 !! of bending, along the link, both together

   !> The greatest of something over the turn.
   type :: greatest_t
      real(wp) :: value = 0.0_wp
      real(wp) :: at = 0.0_wp                    !! input, from the reference position, degrees
      real(wp) :: part = 0.0_wp                  !! of the segment, from its start
   end type greatest_t

   !> One segment of the link over the turn.
   type :: stressed_segment_t
      integer :: entry = 0                       !! of the group
      type(greatest_t) :: stress(stress_kinds)   !! Pa; along: with its sign, positive for a pull
      type(greatest_t) :: deflection             !! m
   end type stressed_segment_t

   type :: flex_study_t
      logical :: found = .false.                 !! to the end, or up to where the crank cannot turn
      type(flexible_link_t) :: link
      type(flexible_cycle_t) :: cycle
      real(wp), allocatable :: frequency(:)      !! shape (modes): of the link at rest, rad/s
      real(wp), allocatable :: damping(:)        !! shape (modes): part of the critical one
      logical :: solved = .false.                !! the modes were found
      integer :: solved_modes = 0                !! the first modes, which are solved together; 0: the speed is far below all
      type(coupled_t) :: coupled                 !! what becomes of these
      type(influence_t) :: influence             !! how bodies move where joints give way
      real(wp), allocatable :: inertia(:, :)     !! shape (4, bodies): of all bodies, as of a force model
      real(wp), allocatable :: motion(:, :, :, :) !! shape (3, bodies, solved modes, positions): of all bodies by each mode, as of
                                                 !! `influence`
      real(wp), allocatable :: over_turn(:, :)   !! shape (modes, positions): of a link with a slide, natural frequencies at rest
                                                 !! where its pins and its slide hold it, rad/s
      logical :: clamped = .false.               !! a drive turns it
      logical :: not_held = .false.              !! without its slide the linkage is loose
      real(wp) :: leaves = 0.0_wp                !! greatest distance of the shoe from the segments, m; 0: on them
      real(wp), allocatable :: by_origin(:, :)   !! shape (3, solved modes): mass between a mode and its origin's motion
      real(wp) :: driven(2) = 0.0_wp             !! least and greatest first frequency with these masses, rad/s
      type(periodic_t), allocatable :: c(:, :), k(:, :) !! shape (solved modes, the same): their damping and stiffness over the
                                                 !! speed and its square, against the input in radians
      real(wp), allocatable :: forces(:, :, :)   !! shape (positions, solved modes, parts): what loads them, by `part_...` of the
                                                 !! cycle, at unit speed or push
      real(wp), allocatable :: widest(:)         !! shape (solved modes): greatest displacement in the shape of a mode
      real(wp) :: resolution = 0.0_wp            !! what the positions leave open of the coefficients
      real(wp) :: equilibrium = 0.0_wp           !! sum of all forces on the link, over the greatest force of a joint
      real(wp) :: least_stiffness = 0.0_wp       !! least squared frequency with all that acts over that at rest: below 0 the
                                                 !! link buckles for a part of the turn
      real(wp) :: least_at = 0.0_wp              !! input there, degrees
      type(out_of_plane_t) :: out                !! the link out of the plane
      logical :: steady = .false.                !! there is a steady state
      logical :: stressed = .false.              !! and stresses are known
      real(wp), allocatable :: displacement(:, :, :) !! shape (2, nodes, positions): in the axes of the link, m
      real(wp), allocatable :: joints(:, :)      !! shape (joints, positions): amount of the displacement, m
      real(wp), allocatable :: stress(:, :)      !! shape (positions, stress_kinds): greatest of the link, Pa
      type(stressed_segment_t), allocatable :: segments(:)
   end type flex_study_t

   interface
      !> Study a link that was made without a mistake. `study%cycle%turn%failure` says where the crank cannot turn: then there is
      !> nothing else.
      module subroutine find_flex(set, given, dimensions, model, link, crank, study, stop)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         type(problem_t), intent(in) :: given
         type(dimensions_t), intent(in) :: dimensions
         type(force_model_t), intent(in) :: model   !! with the masses of all segments
         type(flexible_link_t), intent(in) :: link
         type(crank_motion_t), intent(in) :: crank  !! known
         type(flex_study_t), intent(out) :: study
         type(stop_t), intent(in), optional :: stop !! asked now and then
      end subroutine find_flex
   end interface

contains

   !> Mass between mode i of a link and mode j of this or another one, at a position: of bending, and of all bodies that they move.
   pure real(wp) function mass_of_modes(one, i, other, j, position) result(mass)
      type(flex_study_t), intent(in) :: one, other
      integer, intent(in) :: i, j, position

      mass = merge(1.0_wp, 0.0_wp, one%link%body == other%link%body .and. i == j)
      if (.not. (one%influence%known .and. other%influence%known)) return
      associate (axes => one%influence%axes(:, :, position), p => one%motion(:, :, i, position), &
                 q => other%motion(:, :, j, position))
         mass = mass + mass_between(one%inertia, axes, p, q) + sum(one%by_origin(:, i)*origin_motion(one%link, axes, q)) &
                + sum(other%by_origin(:, j)*origin_motion(other%link, axes, p))
      end associate
   end function mass_of_modes
end module psalm_flex_study
