!> The group SPRNGS: springs that are to be found - between which links, within which limits, for what.
module psalm_spring_design_group
   use psalm_case_group, only: case_group_t, surroundings_t, place_visitor_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, check_range, out_of, required
   use psalm_kinds, only: wp
   use psalm_link_place, only: place_t, read_places, read_count, refuse_unless
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: spring_design_group_t, spring_design_of
   public :: criterion_range, criterion_rms, criterion_peak

   integer, parameter :: criterion_range = 1 !! greatest less least value
   integer, parameter :: criterion_rms = 2   !! of the values themselves
   integer, parameter :: criterion_peak = 3  !! greatest amount
   integer, parameter :: most_starts = 10000, most_phases = 1024

   !> Springs. Arrays have the shape (NSFIND).
   type, extends(case_group_t) :: spring_design_group_t
      logical :: exact = .false.                    !! SMETH: 'EXACT', zero free length through six positions; else 'SEARCH'
      type(place_t), allocatable :: first(:), second(:) !! PLINK ..., QLINK ...: where the ends are looked for
      real(wp), allocatable :: first_reach(:), second_reach(:) !! PREACH, QREACH: around there, user's length; 0: just there
      real(wp), allocatable :: stiffest(:)          !! SKMAX: N/m; 0: no limit
      real(wp), allocatable :: free_low(:), free_high(:) !! SFLOW, SFHIGH: free length, user's length
      integer :: criterion = criterion_range        !! SCRIT
      type(place_t) :: joint                        !! SJLINK, SJLOOP: the joint whose load counts
      logical :: of_joint = .false.                 !! else the drive
      integer :: starts = 32                        !! NSSTRT
      integer :: seed = 1                           !! ISSEED
      integer :: phases = 64                        !! NPHASE: of EXACT, in a turn
      ! coils, of every spring; 0: not given
      real(wp) :: wire = 0.0_wp, coil = 0.0_wp      !! CWIRE, CDIAM: diameters, m
      real(wp) :: turns = 0.0_wp                    !! CTURNS
      real(wp) :: shear = 79.0e9_wp                 !! CSHEAR: modulus, Pa
   contains
      procedure :: read => read_spring_design
      procedure :: visit_places => visit_spring_design
   end type spring_design_group_t

contains

   !> Read the group. Errors: arcs that are not there, numbers out of range.
   subroutine read_spring_design_group(group, ilink, sketch, springs, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)            !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch          !! its names stand in place of arcs and loops
      type(spring_design_group_t), intent(inout) :: springs
      type(diagnostics_t), intent(inout) :: findings
      type(place_t) :: joint(1)
      character(:), allocatable :: word
      integer :: n

      springs%given = group%line > 0
      call read_count(group, 'NSFIND', n, findings)
      allocate (springs%first(n), springs%second(n))
      allocate (springs%first_reach(n), springs%second_reach(n), springs%stiffest(n), springs%free_low(n), springs%free_high(n), &
                source=0.0_wp)
      call read_places(group, 'P', ilink, springs%first, findings, sketch=sketch)
      call read_places(group, 'Q', ilink, springs%second, findings, sketch=sketch)
      call read_limits('PREACH', springs%first_reach)
      call read_limits('QREACH', springs%second_reach)
      call read_limits('SKMAX', springs%stiffest)
      call read_limits('SFLOW', springs%free_low)
      call read_limits('SFHIGH', springs%free_high)
      call refuse_unless(springs%free_low <= springs%free_high, group, 'SFLOW', 'the least free length is above the greatest', &
                         findings)
      word = 'SEARCH'
      call group%get_word('SMETH', word, findings)
      springs%exact = word == 'EXACT'
      if (word /= 'SEARCH' .and. word /= 'EXACT') then
         call out_of(group, 'SMETH', "'SEARCH' or 'EXACT' is expected; found '"//word//"'", findings)
      end if
      word = 'RANGE'
      call group%get_word('SCRIT', word, findings)
      select case (word)
      case ('RANGE')
         springs%criterion = criterion_range
      case ('RMS')
         springs%criterion = criterion_rms
      case ('PEAK')
         springs%criterion = criterion_peak
      case default
         call out_of(group, 'SCRIT', "one of 'RANGE', 'RMS', 'PEAK' is expected; found '"//word//"'", findings)
      end select
      springs%of_joint = group%given('SJLINK') .or. group%given('SJNAME')
      if (springs%of_joint) then
         call read_places(group, 'SJ', ilink, joint, findings, ends_only=.true., sketch=sketch)
         springs%joint = joint(1)
         if (springs%criterion == criterion_range) then
            call out_of(group, 'SCRIT', "the load of a joint has no range: give 'RMS' or 'PEAK'", findings)
         end if
      end if
      if (group%given('SJLOOP') .and. .not. springs%of_joint) call required(group, 'SJLINK')
      call group%get_integer('NSSTRT', springs%starts, findings)
      call check_range(group, 'NSSTRT', springs%starts, 1, most_starts, findings)
      call group%get_integer('ISSEED', springs%seed, findings)
      call check_range(group, 'ISSEED', springs%seed, 1, huge(1), findings)
      call group%get_integer('NPHASE', springs%phases, findings)
      call check_range(group, 'NPHASE', springs%phases, 1, most_phases, findings)
      call read_positive('CWIRE', springs%wire)
      call read_positive('CDIAM', springs%coil)
      call read_positive('CTURNS', springs%turns)
      call read_positive('CSHEAR', springs%shear)
      if (.not. springs%given) return
      if (springs%exact .and. (n /= 1 .or. springs%of_joint .or. springs%criterion /= criterion_range)) then
         call out_of(group, 'SMETH', "'EXACT' finds one spring for the range of the drive torque; use 'SEARCH'", findings)
      end if
      if (any([springs%wire, springs%coil, springs%turns] > 0.0_wp) .and. &
          .not. all([springs%wire, springs%coil, springs%turns] > 0.0_wp)) then
         call out_of(group, 'CWIRE', 'a coil is given by CWIRE, CDIAM and CTURNS together', findings)
      end if

   contains

      !> An entry that is not given is that before it.
      subroutine read_limits(item, values)
         character(*), intent(in) :: item
         real(wp), intent(inout) :: values(:)
         integer :: last

         call group%get_reals(item, values, findings, last=last)
         if (last > 0 .and. last < size(values)) values(last + 1:) = values(last)
         call refuse_unless(values >= 0.0_wp, group, item, 'must not be negative', findings)
      end subroutine read_limits

      subroutine read_positive(item, value)
         character(*), intent(in) :: item
         real(wp), intent(inout) :: value

         call group%get_real(item, value, findings)
         if (group%given(item) .and. .not. value > 0.0_wp) call out_of(group, item, 'must be above 0', findings)
      end subroutine read_positive
   end subroutine read_spring_design_group

   !> The group as the case has it.
   subroutine read_spring_design(self, group, about, findings)
      class(spring_design_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_spring_design_group(group, about%ilink, about%sketch, self, findings)
   end subroutine read_spring_design

   subroutine visit_spring_design(self, visitor)
      class(spring_design_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor
      integer :: k

      do k = 1, size(self%first)
         call visitor%place(self%first(k))
         call visitor%place(self%second(k))
      end do
      if (self%of_joint) call visitor%joint(self%joint)
   end subroutine visit_spring_design

   !> The group SPRNGS of a case; as it is by default where the case does not have it.
   pure function spring_design_of(set) result(springs)
      class(data_set_t), intent(in) :: set
      type(spring_design_group_t) :: springs
      integer :: k

      k = set%place_of('SPRNGS')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (spring_design_group_t)
         springs = group
      end select
   end function spring_design_of
end module psalm_spring_design_group
