!> The group DXF: what the drawing for CAD is to be like.
module psalm_dxf_group
   use psalm_case_group, only: case_group_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, check_range, out_of
   use psalm_kinds, only: wp
   use psalm_rule, only: rule_t, a_flag, a_number, a_whole, a_word
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   implicit none (type, external)
   private
   public :: dxf_items
   public :: dxf_group_t, dxf_of

   integer, parameter :: codes(*) = [4, 5, 6, 1, 2, 0] !! what DXF calls the words of UNITS ($INSUNITS)

   type, extends(case_group_t) :: dxf_group_t
      integer :: unit = 0                      !! UNITS: number of DXF; 0: none
      real(wp) :: pin = 0.0_wp                 !! PIN: diameter of revolute joints, user's length; 0: as large as it looks well
      real(wp) :: width = 0.0_wp               !! WIDTH: of links, user's length; 0: centre lines
      integer :: position = 0                  !! POSITN: number of a prescribed position; 0: the reference position
      real(wp) :: increment = 0.0_wp           !! INCREM: input from the reference position, degrees or length
      logical :: anywhere = .false.            !! INCREM is given
      logical :: flat = .false.                !! FLAT: every link laid flat beside the others, in a drawing of its own
   contains
      procedure :: read => read_dxf
   end type dxf_group_t

   !> The items of the group.
   type(rule_t), parameter :: dxf_items(*) = [ &
      rule_t('UNITS', a_word, '', '', 'NONE', 'MM CM M IN FT NONE', &
             '''MM'', ''CM'', ''M'', ''IN'', ''FT'': what the lengths of the case are, written into the drawing '// &
             '($INSUNITS)'), &
      rule_t('PIN', a_number, '', 'length', '0', '[0,)', &
             'diameter of the revolute joints; 0: as large as looks well', &
             'a diameter is not negative'), &
      rule_t('WIDTH', a_number, '', 'length', '0', '[0,)', &
             'width of the links: the outline of every moving link is drawn, half the width round the bar or '// &
             'plate between its joints, with round ends; 0: lines, and closed plates', &
             'a width is not negative'), &
      rule_t('POSITN', a_whole, '', '', '0', '[0,1000000]', &
             'number of the prescribed position that is drawn; 0: the reference position'), &
      rule_t('INCREM', a_number, '', '', '', '', &
             'in its place any other: an input counted from CRNKI as in DELT; not with several drives'), &
      rule_t('FLAT', a_flag, '', '', '0', '', &
             '1: `CASE.flat.dxf` has every link by itself, along its longest line: outline, holes, points, '// &
             'rails, names')]

contains

   !> Read the group. Errors: units that are not known, sizes below 0, positions that are not there, POSITN and INCREM together.
   subroutine read_dxf_group(group, positions, dxf, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: positions         !! prescribed ones; 0: not known
      type(dxf_group_t), intent(inout) :: dxf
      type(diagnostics_t), intent(inout) :: findings
      integer :: unit

      dxf%given = group%line > 0
      call group%follow(dxf_items)
      call take(group, 'UNITS', unit, findings)
      dxf%unit = codes(unit)
      call take(group, 'PIN', dxf%pin, findings)
      call take(group, 'WIDTH', dxf%width, findings)
      call take(group, 'POSITN', dxf%position, findings)
      call take(group, 'INCREM', dxf%increment, findings)
      dxf%anywhere = group%given('INCREM')
      call take(group, 'FLAT', dxf%flat, findings)
      if (.not. dxf%given) return
      if (dxf%width > 0.0_wp .and. dxf%pin >= dxf%width) call out_of(group, 'PIN', 'a pin must be thinner than the link', findings)
      if (dxf%anywhere .and. group%given('POSITN')) &
         call out_of(group, 'INCREM', 'POSITN and INCREM both say which position is drawn; leave one out', findings)
      if (positions > 0) call check_range(group, 'POSITN', dxf%position, 0, positions, findings)
   end subroutine read_dxf_group

   !> The group as the case has it.
   subroutine read_dxf(self, group, about, findings)
      class(dxf_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_dxf_group(group, about%positions, self, findings)
      if (self%anywhere .and. about%sketch%given) then
         if (count(.not. about%sketch%drives%geared) > 1) call out_of(group, 'INCREM', &
            'of several drives there is no one increment; give the number of a position in POSITN', findings)
      end if
   end subroutine read_dxf

   !> The group DXF of a case; as it is by default where the case does not have it.
   pure function dxf_of(set) result(dxf)
      class(data_set_t), intent(in) :: set
      type(dxf_group_t) :: dxf
      integer :: k

      k = set%place_of('DXF')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (dxf_group_t)
         dxf = group
      end select
   end function dxf_of
end module psalm_dxf_group
