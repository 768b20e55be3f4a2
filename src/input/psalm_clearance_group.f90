!> The group CLEAR: a revolute joint with clearance.
module psalm_clearance_group
   use psalm_case_group, only: case_group_t, surroundings_t, place_visitor_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, check_range, out_of, required
   use psalm_kinds, only: wp
   use psalm_link_place, only: place_t, read_places
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: clearance_group_t, clearance_of

   integer, parameter :: fewest_points = 32, most_points = 4096, most_speeds = 10000
   integer, parameter :: most_charts = 6, most_radii = 400, fewest_angles = 8, most_angles = 720
   real(wp), parameter :: greatest_h3 = 0.999_wp
   real(wp), parameter :: usual_h3(3) = [0.25_wp, 0.5_wp, 0.75_wp] !! of the published charts

   type, extends(case_group_t) :: clearance_group_t
      type(place_t) :: joint                   !! CLINK, CLOOP: the end of an arc that is the joint; of a sketch CNAME
      real(wp) :: diametral = 0.0_wp           !! CDIAM: diametral clearance, user's length
      real(wp) :: restitution = 0.0_wp         !! CREST
      real(wp) :: begin = 0.0_wp               !! CBEGIN: input at which following begins, degrees from the reference position
      logical :: begins = .false.              !! it is given; else following begins where the load is largest
      real(wp) :: slowest = 0.0_wp, fastest = 0.0_wp !! CSPLOW, CSPHGH: rad/s
      integer :: speeds = 0                    !! NCSPED: speeds in this range
      integer :: points = 512                  !! NCPNT: positions in a turn
      integer :: radii = 0                     !! NCRAD: values of H1 in the standard charts; 0: no charts
      integer :: angles = 72                   !! NCANG: values of H2
      real(wp) :: greatest_h1 = 2.0_wp         !! CHMAX
      real(wp), allocatable :: h3(:)           !! CEPS: one for each chart
   contains
      procedure :: read => read_clearance
      procedure :: visit_places => visit_clearance
   end type clearance_group_t

contains

   !> Read the group. Errors: an arc that is not there, no clearance, numbers out of range.
   subroutine read_clearance_group(group, ilink, sketch, clearance, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)       !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch     !! its names stand in place of arcs and loops
      type(clearance_group_t), intent(inout) :: clearance
      type(diagnostics_t), intent(inout) :: findings
      type(place_t) :: places(1)
      real(wp) :: h3(most_charts)

      clearance%given = group%line > 0
      call read_places(group, 'C', ilink, places, findings, ends_only=.true., sketch=sketch)
      clearance%joint = places(1)
      call group%get_real('CDIAM', clearance%diametral, findings)
      call group%get_real('CREST', clearance%restitution, findings)
      call group%get_real('CBEGIN', clearance%begin, findings)
      clearance%begins = group%given('CBEGIN')
      call group%get_real('CSPLOW', clearance%slowest, findings)
      call group%get_real('CSPHGH', clearance%fastest, findings)
      call group%get_integer('NCSPED', clearance%speeds, findings)
      call check_range(group, 'NCSPED', clearance%speeds, 0, most_speeds, findings)
      call group%get_integer('NCPNT', clearance%points, findings)
      call check_range(group, 'NCPNT', clearance%points, fewest_points, most_points, findings)
      call group%get_integer('NCRAD', clearance%radii, findings)
      call check_range(group, 'NCRAD', clearance%radii, 0, most_radii, findings)
      call group%get_integer('NCANG', clearance%angles, findings)
      call check_range(group, 'NCANG', clearance%angles, fewest_angles, most_angles, findings)
      call group%get_real('CHMAX', clearance%greatest_h1, findings)
      h3 = -1.0_wp
      call group%get_reals('CEPS', h3, findings)
      clearance%h3 = usual_h3
      if (group%given('CEPS')) clearance%h3 = pack(h3, abs(h3 + 1.0_wp) > 0.0_wp)
      if (.not. clearance%given) return
      if (.not. clearance%greatest_h1 > 0.0_wp) call out_of(group, 'CHMAX', 'must be above 0', findings)
      if (any(clearance%h3 < 0.0_wp .or. clearance%h3 > greatest_h3)) then
         call out_of(group, 'CEPS', 'values of H3 lie between 0 and 0.999', findings)
      end if
      if (.not. group%given('CDIAM')) then
         call required(group, 'CDIAM', 'missing; the diametral clearance, in units of length')
      else if (.not. clearance%diametral > 0.0_wp) then
         call out_of(group, 'CDIAM', 'must be above 0: without clearance contact is never lost', findings)
      end if
      if (clearance%restitution < 0.0_wp .or. clearance%restitution > 1.0_wp) then
         call out_of(group, 'CREST', 'must lie between 0 and 1', findings)
      end if
      if (clearance%speeds == 0) return
      if (.not. clearance%slowest > 0.0_wp) call out_of(group, 'CSPLOW', 'speeds must be above 0', findings)
      if (clearance%fastest < clearance%slowest) call out_of(group, 'CSPHGH', 'must not be below CSPLOW', findings)
   end subroutine read_clearance_group

   !> The group as the case has it.
   subroutine read_clearance(self, group, about, findings)
      class(clearance_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_clearance_group(group, about%ilink, about%sketch, self, findings)
   end subroutine read_clearance

   subroutine visit_clearance(self, visitor)
      class(clearance_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor

      if (self%given) call visitor%joint(self%joint)
   end subroutine visit_clearance

   !> The group CLEAR of a case; as it is by default where the case does not have it.
   pure function clearance_of(set) result(clearance)
      class(data_set_t), intent(in) :: set
      type(clearance_group_t) :: clearance
      integer :: k

      k = set%place_of('CLEAR')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (clearance_group_t)
         clearance = group
      end select
   end function clearance_of
end module psalm_clearance_group
