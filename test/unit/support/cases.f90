!> Data sets of `data/` as problems, for the tests.
module cases
   use psalm_cases, only: read_cases
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp
   use psalm_setup, only: set_up
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: load_case, names

   character(*), parameter :: names(*) = [character(27) :: 'needle', 'textile', 'chain_long', 'chain_short', &
      'brake_reaction', 'dyad1_crank_rocker', 'dyad2_oscillating_cylinder', 'dyad3_quick_return', 'dyad4_slider_crank', &
      'dyad5_turning_block', 'dyad6_scotch_yoke', 'dyad7_oldham_coupling', 'dyad8_tangent_mechanism', &
      'actuator_rapson_slide', 'actuator_davis_steering'] !! data sets that close everywhere

contains

   !> The n-th case of `data/NAME.nml`; with `everything` all loops are solved, with `vary` every dimension is a variable.
   subroutine load_case(name, problem, set, n, everything, vary, motion)
      character(*), intent(in) :: name
      type(problem_t), intent(out) :: problem
      type(data_set_t), intent(out) :: set
      integer, intent(in), optional :: n
      logical, intent(in), optional :: everything, vary
      integer, intent(in), optional :: motion     !! in place of MOTION
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(mechanism_t) :: mechanism
      type(parameters_t) :: parameters
      type(dimensions_t) :: dimensions
      integer :: which

      which = 1
      if (present(n)) which = n
      call read_cases('data/'//trim(name)//'.nml', sets, findings)
      if (.not. findings%failed()) then
         set = sets(which)
         if (present(everything)) set%limits%ktheta = merge(1, set%limits%ktheta, everything)
         if (present(motion)) set%method%motion = motion
         if (present(vary)) call let_vary(set)
         call set_up(set, mechanism, dimensions, parameters, findings)
      end if
      if (findings%failed()) error stop 'a data set of the tests cannot be read'
      if (present(vary)) then
         if (size(parameters%variables) < 2) error stop 'a data set of the tests has no dimensions to vary'
      end if
      call make_problem(set, mechanism, dimensions, parameters, problem)
   end subroutine load_case

   !> Every length and angle a variable, some desired value at every position.
   subroutine let_vary(set)
      type(data_set_t), intent(inout) :: set
      integer :: i

      set%method%iva = 1
      set%method%ivg = 1
      set%method%ilkout = merge(1, 0, set%links%outlk > 0.0_wp)
      set%method%ingout = 1
      set%method%icrk = 1
      set%method%iorig = 1
      set%method%origlk = set%method%origlk + 3.0_wp
      if (set%method%ikin /= 0) then
         set%method%ndes = 12
         set%method%delt = [(30.0_wp*real(i, wp) + 5.0_wp, i=0, 11)]
         set%method%ikin = 0
      end if
      set%method%desired = .true.
      set%method%desx = [(1.0_wp + real(i, wp), i=1, set%method%ndes)]
      set%method%desy = set%method%desx
      set%method%desang = set%method%desx
      set%method%xmult = [(1.0_wp + 0.1_wp*real(i, wp), i=1, set%method%ndes)]
      set%method%ymult = 0.5_wp*set%method%xmult
      set%method%anmult = set%method%xmult
   end subroutine let_vary
end module cases
