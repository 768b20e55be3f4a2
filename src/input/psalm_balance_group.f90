!> The group BALANC: counterweights - on which links, within which limits, for what.
module psalm_balance_group
   use psalm_case_group, only: case_group_t, surroundings_t, place_visitor_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, check_range, out_of, read_flag
   use psalm_kinds, only: wp
   use psalm_link_place, only: place_t, read_places, read_count, refuse_unless
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: balance_group_t, balance_of
   public :: form_point, form_body, form_disc, order_mass, order_moment, order_torque
   public :: measure_force, measure_moment, measure_torque, measure_mass, measure_names

   integer, parameter :: form_point = 1     !! point masses
   integer, parameter :: form_body = 2      !! any body within the reach: mass spread as is best
   integer, parameter :: form_disc = 3      !! discs of a thickness and density
   integer, parameter :: order_mass = 1, order_moment = 2, order_torque = 3 !! by which designs are ranked
   integer, parameter :: measure_force = 1, measure_moment = 2, measure_torque = 3, measure_mass = 4
   character(6), parameter :: measure_names(*) = [character(6) :: 'FORCE', 'MOMENT', 'TORQUE', 'MASS']
   integer, parameter :: most_listed = 10000, most_points = 1000, most_starts = 10000, most_budgets = 1000
   real(wp), parameter :: steel = 7850.0_wp !! kg/m3

   !> Counterweights. Arrays of the links have the shape (NWEIGH), or (1) for all moving links where that is 0.
   type, extends(case_group_t) :: balance_group_t
      integer :: links = 0                     !! NWEIGH; 0: every moving link may carry a weight
      type(place_t), allocatable :: places(:)  !! WLINK, WLOOP, WDIST, WANG: the anchor
      real(wp), allocatable :: reach(:)        !! WREACH: greatest distance of a centre from the anchor, user's length
      real(wp), allocatable :: most(:)         !! WMOST: greatest mass, kg; 0: no limit
      integer :: form = form_point             !! WFORM
      real(wp) :: density = steel              !! WDENS, kg/m3
      real(wp), allocatable :: radius_low(:), radius_high(:)       !! WRLOW, WRHIGH: of discs, user's length
      real(wp), allocatable :: thickness_low(:), thickness_high(:) !! WTLOW, WTHIGH: of discs, user's length
      real(wp) :: tolerance(4) = 0.0_wp        !! TOLF, TOLM, TOLT, TOLW; 0: it does not count
      type(place_t), allocatable :: joints(:)  !! BLINK, BLOOP: joints whose loads count
      real(wp), allocatable :: joint_tolerance(:) !! BTOL, N
      logical :: peaks = .false.               !! WCRIT: 'PEAK', else 'RMS'
      integer :: exact = 0                     !! IEXACT: force balance stays complete
      integer :: order = order_mass            !! WRANK
      integer :: listed = 10                   !! NLIST: designs listed at most
      real(wp), allocatable :: budgets(:)      !! WBUDGT, shape (NBUDGT): kg
      integer :: front = 0                     !! NFRONT: points of a Pareto front
      integer :: front_of(2) = [measure_force, measure_mass] !! FRONT1, FRONT2
      integer :: starts = 32                   !! NWSTRT: of searches for discs and point masses
      integer :: seed = 1                      !! IWSEED
   contains
      procedure :: read => read_balance
      procedure :: visit_places => visit_balance
      procedure :: wants_optimum
   end type balance_group_t

contains

   !> True if a composite is to be made least.
   pure logical function wants_optimum(self)
      class(balance_group_t), intent(in) :: self

      wants_optimum = any(self%tolerance > 0.0_wp) .or. size(self%joints) > 0
   end function wants_optimum

   !> Read the group. Errors: arcs that are not there, numbers out of range, limits that leave no room.
   subroutine read_balance_group(group, ilink, sketch, balance, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)          !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch        !! its names stand in place of arcs and loops
      type(balance_group_t), intent(inout) :: balance
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: word
      integer :: n, joints, budgets

      balance%given = group%line > 0
      n = 0
      call group%get_integer('NWEIGH', n, findings)
      call check_range(group, 'NWEIGH', n, 0, most_listed, findings)
      n = min(max(n, 0), most_listed)
      balance%links = n
      allocate (balance%places(n))
      call read_places(group, 'W', ilink, balance%places, findings, sketch=sketch)
      call read_limits('WREACH', balance%reach, 0.0_wp)
      call read_limits('WMOST', balance%most, 0.0_wp)
      call read_limits('WRLOW', balance%radius_low, 0.0_wp)
      call read_limits('WRHIGH', balance%radius_high, 0.0_wp)
      call read_limits('WTLOW', balance%thickness_low, 0.0_wp)
      call read_limits('WTHIGH', balance%thickness_high, 0.0_wp)
      word = 'POINT'
      call group%get_word('WFORM', word, findings)
      select case (word)
      case ('POINT')
         balance%form = form_point
      case ('BODY')
         balance%form = form_body
      case ('DISC')
         balance%form = form_disc
      case default
         call out_of(group, 'WFORM', "one of 'POINT', 'BODY', 'DISC' is expected; found '"//word//"'", findings)
      end select
      call group%get_real('WDENS', balance%density, findings)
      if (.not. balance%density > 0.0_wp) call out_of(group, 'WDENS', 'must be above 0', findings)
      call read_tolerance('TOLF', measure_force)
      call read_tolerance('TOLM', measure_moment)
      call read_tolerance('TOLT', measure_torque)
      call read_tolerance('TOLW', measure_mass)
      joints = 0
      call group%get_integer('NBJNT', joints, findings)
      call check_range(group, 'NBJNT', joints, 0, most_listed, findings)
      joints = min(max(joints, 0), most_listed)
      allocate (balance%joints(joints))
      allocate (balance%joint_tolerance(joints), source=0.0_wp)
      call read_places(group, 'B', ilink, balance%joints, findings, ends_only=.true., sketch=sketch)
      call group%get_reals('BTOL', balance%joint_tolerance, findings)
      call refuse_unless(balance%joint_tolerance > 0.0_wp, group, 'BTOL', 'a tolerance in newtons, above 0, is expected', findings)
      word = 'RMS'
      call group%get_word('WCRIT', word, findings)
      balance%peaks = word == 'PEAK'
      if (word /= 'RMS' .and. word /= 'PEAK') then
         call out_of(group, 'WCRIT', "'RMS' or 'PEAK' is expected; found '"//word//"'", findings)
      end if
      call read_flag(group, 'IEXACT', balance%exact, findings)
      balance%order = order_mass
      word = 'MASS'
      call group%get_word('WRANK', word, findings)
      select case (word)
      case ('MASS')
         balance%order = order_mass
      case ('MOMENT')
         balance%order = order_moment
      case ('TORQUE')
         balance%order = order_torque
      case default
         call out_of(group, 'WRANK', "one of 'MASS', 'MOMENT', 'TORQUE' is expected; found '"//word//"'", findings)
      end select
      call group%get_integer('NLIST', balance%listed, findings)
      call check_range(group, 'NLIST', balance%listed, 1, most_listed, findings)
      budgets = 0
      call group%get_integer('NBUDGT', budgets, findings)
      call check_range(group, 'NBUDGT', budgets, 0, most_budgets, findings)
      budgets = min(max(budgets, 0), most_budgets)
      allocate (balance%budgets(budgets), source=0.0_wp)
      call group%get_reals('WBUDGT', balance%budgets, findings)
      call refuse_unless(balance%budgets >= 0.0_wp, group, 'WBUDGT', 'a mass is not negative', findings)
      call group%get_integer('NFRONT', balance%front, findings)
      call check_range(group, 'NFRONT', balance%front, 0, most_points, findings)
      call read_measure('FRONT1', balance%front_of(1))
      call read_measure('FRONT2', balance%front_of(2))
      if (balance%front_of(1) == balance%front_of(2)) then
         call out_of(group, 'FRONT2', 'the two criteria of a front must differ', findings)
      end if
      call group%get_integer('NWSTRT', balance%starts, findings)
      call check_range(group, 'NWSTRT', balance%starts, 1, most_starts, findings)
      call group%get_integer('IWSEED', balance%seed, findings)
      call check_range(group, 'IWSEED', balance%seed, 1, huge(1), findings)
      if (balance%given) call judge_limits()

   contains

      !> A limit of each link. An entry that is not given is that before it.
      subroutine read_limits(item, values, default)
         character(*), intent(in) :: item
         real(wp), allocatable, intent(out) :: values(:)
         real(wp), intent(in) :: default
         integer :: last

         allocate (values(max(n, 1)), source=default)
         call group%get_reals(item, values, findings, last=last)
         if (last > 0 .and. last < size(values)) values(last + 1:) = values(last)
         call refuse_unless(values >= 0.0_wp, group, item, 'must not be negative', findings)
      end subroutine read_limits

      subroutine read_tolerance(item, measure)
         character(*), intent(in) :: item
         integer, intent(in) :: measure

         call group%get_real(item, balance%tolerance(measure), findings)
         if (.not. balance%tolerance(measure) >= 0.0_wp) call out_of(group, item, 'must not be negative', findings)
      end subroutine read_tolerance

      subroutine read_measure(item, measure)
         character(*), intent(in) :: item
         integer, intent(inout) :: measure
         character(:), allocatable :: name
         integer :: found

         name = trim(measure_names(measure))
         call group%get_word(item, name, findings)
         found = findloc(measure_names == name, .true., dim=1)
         if (found == 0) then
            call out_of(group, item, "one of 'FORCE', 'MOMENT', 'TORQUE', 'MASS' is expected; found '"//name//"'", findings)
         else
            measure = found
         end if
      end subroutine read_measure

      !> Limits that leave no room for a weight.
      subroutine judge_limits()
         integer :: k

         if (.not. group%given('WREACH')) then
            call out_of(group, 'WREACH', 'missing; how far from its anchor may the centre of a weight lie', findings)
            return
         end if
         if (balance%form /= form_disc) return
         do k = 1, size(balance%reach)
            if (.not. balance%thickness_high(k) > 0.0_wp) then
               call out_of(group, 'WTHIGH', 'entry '//to_text(k)//': a disc needs a greatest thickness above 0', findings, k)
            else if (balance%thickness_low(k) > balance%thickness_high(k)) then
               call out_of(group, 'WTLOW', 'entry '//to_text(k)//': the least thickness is above the greatest', findings, k)
            end if
            if (.not. balance%radius_high(k) > 0.0_wp) then
               call out_of(group, 'WRHIGH', 'entry '//to_text(k)//': a disc needs a greatest radius above 0', findings, k)
            else if (balance%radius_low(k) > balance%radius_high(k)) then
               call out_of(group, 'WRLOW', 'entry '//to_text(k)//': the least radius is above the greatest', findings, k)
            end if
         end do
      end subroutine judge_limits
   end subroutine read_balance_group

   !> The group as the case has it.
   subroutine read_balance(self, group, about, findings)
      class(balance_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_balance_group(group, about%ilink, about%sketch, self, findings)
   end subroutine read_balance

   subroutine visit_balance(self, visitor)
      class(balance_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor
      integer :: k

      do k = 1, size(self%places)
         call visitor%place(self%places(k))
      end do
      do k = 1, size(self%joints)
         call visitor%joint(self%joints(k))
      end do
   end subroutine visit_balance

   !> The group BALANC of a case; as it is by default where the case does not have it.
   pure function balance_of(set) result(balance)
      class(data_set_t), intent(in) :: set
      type(balance_group_t) :: balance
      integer :: k

      k = set%place_of('BALANC')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (balance_group_t)
         balance = group
      end select
   end function balance_of
end module psalm_balance_group
