!> Vibration of a link of a moving linkage: what the group VIBR asks for. Data in, results out.
!>
!> Boundaries of stability of every mode by itself, multipliers of all modes together at the speed of RATES, steady response,
!> a table over speeds, and the chart of boundaries against the inertia of the other links. Source: Oldham, chapters 13 and 14.
module psalm_vibration_study
   use psalm_crank_motion, only: crank_motion_t
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t
   use psalm_hill, only: hill_t
   use psalm_kinds, only: wp
   use psalm_link_cycle, only: link_cycle_t
   use psalm_stability, only: boundaries_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: vibration_study_t, mode_t, chart_row_t, find_vibration, harmonics_listed
   public :: much_mixed

   integer, parameter :: harmonics_listed = 12
   real(wp), parameter :: much_mixed = 0.1_wp             !! above it a mode by itself is wrong by about a hundredth

   !> One mode by itself at the given speed.
   type :: mode_t
      type(boundaries_t) :: exact                !! of the squared ratio of the link's first frequency to the speed
      real(wp), allocatable :: first(:, :), second(:, :) !! shape (2, 0:last): by Oldham's (13.27) and (13.28)
      type(hill_t) :: hill                       !! steady response, in lengths of the link
      real(wp), allocatable :: amplitude(:)      !! shape (0:harmonics_listed): harmonics of it, m
      real(wp) :: greatest = 0.0_wp              !! of its amount, m
      real(wp) :: least_stiffness = 0.0_wp       !! least of W j**4 + f_j over the turn: below 0 the link buckles for a while
      real(wp) :: least_at = 0.0_wp              !! increment of the input from the reference position, degrees
   end type mode_t

   type :: speed_row_t
      real(wp) :: speed = 0.0_wp                 !! rad/s
      real(wp) :: amplitude = 0.0_wp             !! greatest deflection of mode 1, m; of the periodic solution
      logical :: known = .false.                 !! there is one
      logical :: stable = .false.
      logical :: grows = .false.                 !! a multiplier is beyond 1: what is neither stable nor growing is undamped
      real(wp) :: determinant_error = 0.0_wp     !! of the period, relative
   end type speed_row_t

   !> Speeds at which mode 1 grows.
   type :: speed_band_t
      real(wp) :: from = 0.0_wp, to = 0.0_wp     !! rad/s; an end of the range is an end of the band too
   end type speed_band_t

   !> Stresses over the turn. Edges of the link have pull along it plus and minus bending.
   type :: stresses_t
      logical :: known = .false.                 !! every mode has a steady response
      real(wp), allocatable :: bending(:)        !! shape (positions): greatest amount along the link, Pa
      real(wp), allocatable :: along(:)          !! shape (positions): of pull or push, of the largest amount along the link, Pa
      real(wp), allocatable :: both(:)           !! shape (positions): greatest amount of pull and bending together, Pa
      real(wp), allocatable :: place(:)          !! shape (positions): where that is, from the start of the link, of its length
      integer :: worst(3) = 1                    !! positions of the greatest of the three
      real(wp) :: at(3) = 0.0_wp                 !! inputs there, from the reference position, degrees
      real(wp) :: where(3) = 0.0_wp              !! and places along the link, of its length
   end type stresses_t

   type :: chart_row_t
      real(wp) :: e = 0.0_wp
      type(boundaries_t) :: exact
   end type chart_row_t

   type :: vibration_study_t
      logical :: found = .false.                 !! all of the given speed; or the crank cannot turn
      type(link_cycle_t) :: cycle
      real(wp) :: frequency = 0.0_wp             !! first of the link at rest, rad/s, with shear if asked for
      real(wp) :: ratio = 0.0_wp                 !! to the speed
      type(mode_t), allocatable :: modes(:)
      complex(wp), allocatable :: multipliers(:) !! of all modes together, the largest first
      real(wp) :: multiplier_error = 0.0_wp
      logical :: multipliers_found = .false.
      logical :: stable = .false.                !! all modes together
      real(wp) :: determinant_error = 0.0_wp     !! of the period of all modes together, relative
      type(speed_row_t), allocatable :: speeds(:)
      type(speed_band_t), allocatable :: bands(:)      !! within the range of these speeds
      logical :: bands_known = .false.                 !! all speeds were looked at
      type(chart_row_t), allocatable :: chart(:)
      type(stresses_t), allocatable :: stresses  !! where they are wanted
      real(wp) :: given_e = 1.0_wp, greatest_e = 0.0_wp !! of the chart: of the masses as given, the last row
      real(wp) :: resolution = 0.0_wp            !! what the positions leave open of the coefficients
      real(wp) :: mixing = 0.0_wp                !! largest coupling of the lowest modes by what acts on the link, over the root
                                                 !! of the product of their stiffnesses
   end type vibration_study_t

   interface
      !> Vibration of a link that `check_link` found no fault with. `study%cycle%failure` tells where the crank cannot turn: then
      !> there is nothing else.
      module subroutine find_vibration(set, given, dimensions, model, crank, study, stop)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         type(problem_t), intent(in) :: given
         type(dimensions_t), intent(in) :: dimensions
         type(force_model_t), intent(in) :: model
         type(crank_motion_t), intent(in) :: crank  !! known
         type(vibration_study_t), intent(out) :: study
         type(stop_t), intent(in), optional :: stop !! asked now and then; once `found`, the speeds so far are there
      end subroutine find_vibration
   end interface
end module psalm_vibration_study
