!> The group DXF: what the drawing for CAD is to be like.
module psalm_dxf_group
   use psalm_case_group, only: case_group_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, check_range, out_of
   use psalm_kinds, only: wp
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: dxf_group_t, dxf_of

   integer, parameter :: most_positions = 1000000

   !> Names of units, and what DXF calls them ($INSUNITS).
   character(4), parameter :: units(*) = ['NONE', 'MM  ', 'CM  ', 'M   ', 'IN  ', 'FT  ']
   integer, parameter :: codes(*) = [0, 4, 5, 6, 1, 2]

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

contains

   !> Read the group. Errors: units that are not known, sizes below 0, positions that are not there, POSITN and INCREM together.
   subroutine read_dxf_group(group, positions, dxf, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: positions         !! prescribed ones; 0: not known
      type(dxf_group_t), intent(inout) :: dxf
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: word
      integer :: flat, k

      dxf%given = group%line > 0
      word = 'NONE'
      call group%get_word('UNITS', word, findings)
      call group%get_real('PIN', dxf%pin, findings)
      call group%get_real('WIDTH', dxf%width, findings)
      call group%get_integer('POSITN', dxf%position, findings)
      call group%get_real('INCREM', dxf%increment, findings)
      dxf%anywhere = group%given('INCREM')
      flat = 0
      call group%get_integer('FLAT', flat, findings)
      call check_range(group, 'FLAT', flat, 0, 1, findings)
      dxf%flat = flat == 1
      if (.not. dxf%given) return
      k = findloc(units == word, .true., dim=1)
      if (k == 0) then
         call out_of(group, 'UNITS', "must be 'MM', 'CM', 'M', 'IN', 'FT' or 'NONE'; found '"//word//"'", findings)
      else
         dxf%unit = codes(k)
      end if
      if (dxf%pin < 0.0_wp) call out_of(group, 'PIN', 'a diameter is not negative', findings)
      if (dxf%width < 0.0_wp) call out_of(group, 'WIDTH', 'a width is not negative', findings)
      if (dxf%width > 0.0_wp .and. dxf%pin >= dxf%width) call out_of(group, 'PIN', 'a pin must be thinner than the link', findings)
      if (dxf%anywhere .and. group%given('POSITN')) &
         call out_of(group, 'INCREM', 'POSITN and INCREM both say which position is drawn; leave one out', findings)
      call check_range(group, 'POSITN', dxf%position, 0, merge(positions, most_positions, positions > 0), findings)
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
