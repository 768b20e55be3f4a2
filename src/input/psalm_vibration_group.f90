!> The groups VIBR (vibration of one link) and ESTIM (estimates of several links): the links as uniform beams, and what is asked.
module psalm_vibration_group
   use psalm_case_group, only: case_group_t, surroundings_t, place_visitor_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, check_range, out_of, required
   use psalm_kinds, only: wp
   use psalm_link_place, only: place_t, read_places, read_count
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: beam_t, vibration_group_t, estimate_group_t, vibration_of, estimates_of

   integer, parameter :: most_modes = 10, most_p = 100, most_speeds = 10000, most_in_chart = 1000, most_points = 4096
   integer, parameter :: fewest_points = 16
   real(wp), parameter :: most_damping = 1.0_wp

   !> A uniform link between two pins.
   type :: beam_t
      type(place_t) :: link                    !! one of its arcs, the one between the pins; of a sketch its name
      real(wp) :: modulus = 0.0_wp             !! Young's, Pa
      real(wp) :: density = 0.0_wp             !! kg/m3
      real(wp) :: area = 0.0_wp                !! m2
      real(wp) :: gyration = 0.0_wp            !! radius of gyration of the section, m
      real(wp) :: depth = 0.0_wp               !! of the section in the plane of motion, m; 0: not known
      real(wp) :: damping = 0.0_wp             !! part of the critical one, of every mode
      real(wp) :: shear_ratio = 0.0_wp         !! E/(kappa G); 0: a slender beam
      real(wp) :: strain = 0.0_wp              !! limit of the material; 0: not known
   end type beam_t

   type, extends(case_group_t) :: vibration_group_t
      type(beam_t) :: beam
      integer :: modes = 1                     !! NMODE
      integer :: last = 16                     !! VPMAX: highest boundary
      real(wp) :: slowest = 0.0_wp, fastest = 0.0_wp !! VSPLOW, VSPHGH: rad/s
      integer :: speeds = 0                    !! NVSPED: speeds in this range
      real(wp) :: given_e = 1.0_wp             !! VEBASE: what e stands for the masses as given
      real(wp) :: greatest_e = 0.0_wp          !! VEMAX: of the chart; 0: no chart
      integer :: in_chart = 41                 !! NVCHRT: values of e in the chart
      integer :: points = 256                  !! NVPNT: positions in a turn
   contains
      procedure :: read => read_vibration
      procedure :: visit_places => visit_vibration
   end type vibration_group_t

   type, extends(case_group_t) :: estimate_group_t
      type(beam_t), allocatable :: beams(:)
      integer :: points = 256                  !! NEPNT: positions in a turn
   contains
      procedure :: read => read_estimate
      procedure :: visit_places => visit_estimate
   end type estimate_group_t

contains

   !> Read the group VIBR. Errors: a link that is not there, numbers out of range.
   subroutine read_vibration_group(group, ilink, sketch, vibration, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)       !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch     !! its names stand in place of arcs and loops
      type(vibration_group_t), intent(inout) :: vibration
      type(diagnostics_t), intent(inout) :: findings
      type(beam_t) :: beams(1)

      vibration%given = group%line > 0
      call read_beams(group, 'V', ilink, sketch, beams, findings)
      vibration%beam = beams(1)
      call group%get_integer('NMODE', vibration%modes, findings)
      call check_range(group, 'NMODE', vibration%modes, 1, most_modes, findings)
      call group%get_integer('VPMAX', vibration%last, findings)
      call check_range(group, 'VPMAX', vibration%last, 0, most_p, findings)
      call group%get_real('VSPLOW', vibration%slowest, findings)
      call group%get_real('VSPHGH', vibration%fastest, findings)
      call group%get_integer('NVSPED', vibration%speeds, findings)
      call check_range(group, 'NVSPED', vibration%speeds, 0, most_speeds, findings)
      if (vibration%speeds > 0) then
         if (.not. vibration%slowest > 0.0_wp) call out_of(group, 'VSPLOW', 'speeds must be above 0', findings)
         if (vibration%fastest < vibration%slowest) call out_of(group, 'VSPHGH', 'must not be below VSPLOW', findings)
      end if
      call group%get_real('VEBASE', vibration%given_e, findings)
      if (.not. vibration%given_e > 0.0_wp) call out_of(group, 'VEBASE', 'must be above 0', findings)
      call group%get_real('VEMAX', vibration%greatest_e, findings)
      if (vibration%greatest_e < 0.0_wp) call out_of(group, 'VEMAX', 'must not be negative', findings)
      call group%get_integer('NVCHRT', vibration%in_chart, findings)
      call check_range(group, 'NVCHRT', vibration%in_chart, 2, most_in_chart, findings)
      call group%get_integer('NVPNT', vibration%points, findings)
      call check_range(group, 'NVPNT', vibration%points, fewest_points, most_points, findings)
   end subroutine read_vibration_group

   !> Read the group ESTIM. Errors: as above.
   subroutine read_estimate_group(group, ilink, sketch, estimates, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)
      type(sketch_t), intent(in) :: sketch
      type(estimate_group_t), intent(inout) :: estimates
      type(diagnostics_t), intent(inout) :: findings
      integer :: n

      estimates%given = group%line > 0
      call read_count(group, 'NESTIM', n, findings)
      allocate (estimates%beams(n))
      call read_beams(group, 'E', ilink, sketch, estimates%beams, findings)
      call group%get_integer('NEPNT', estimates%points, findings)
      call check_range(group, 'NEPNT', estimates%points, fewest_points, most_points, findings)
   end subroutine read_estimate_group

   !> Beams from the items LINK, LOOP, MOD, RHO, AREA, GYR or DEPTH and WIDTH, ZETA, SHEAR, STRN, each with the group's letter
   !> before it.
   subroutine read_beams(group, letter, ilink, sketch, beams, findings)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: letter
      integer, intent(in) :: ilink(:, :)
      type(sketch_t), intent(in) :: sketch
      type(beam_t), intent(inout) :: beams(:)
      type(diagnostics_t), intent(inout) :: findings
      type(place_t) :: places(size(beams))
      character(*), parameter :: items(*) = [character(5) :: 'MOD', 'RHO', 'ZETA', 'SHEAR', 'STRN']
      real(wp) :: depth(size(beams)), width(size(beams)), area(size(beams)), gyration(size(beams))
      real(wp) :: numbers(size(beams), size(items))
      integer :: k
      logical :: rectangle

      call read_places(group, letter, ilink, places, findings, ends_only=.true., sketch=sketch, of_links=.true.)
      beams%link = places
      numbers = reshape([beams%modulus, beams%density, beams%damping, beams%shear_ratio, beams%strain], shape(numbers))
      do k = 1, size(items)
         call group%get_reals(letter//trim(items(k)), numbers(:, k), findings)
      end do
      beams%modulus = numbers(:, 1)
      beams%density = numbers(:, 2)
      beams%damping = numbers(:, 3)
      beams%shear_ratio = numbers(:, 4)
      beams%strain = numbers(:, 5)
      depth = 0.0_wp
      width = 0.0_wp
      area = 0.0_wp
      gyration = 0.0_wp
      call group%get_reals(letter//'DEPTH', depth, findings)
      call group%get_reals(letter//'WIDTH', width, findings)
      call group%get_reals(letter//'AREA', area, findings)
      call group%get_reals(letter//'GYR', gyration, findings)
      if (group%line == 0 .or. size(beams) == 0) return
      if (.not. group%given(letter//'MOD')) call required(group, letter//'MOD', 'missing; Young''s modulus in Pa')
      if (.not. group%given(letter//'RHO')) call required(group, letter//'RHO', 'missing; the density in kg/m3')
      rectangle = group%given(letter//'WIDTH')
      if (rectangle .and. (group%given(letter//'AREA') .or. group%given(letter//'GYR'))) then
         call out_of(group, letter//'WIDTH', 'a section is given by its depth and width, or by its area and radius of '// &
                     'gyration, not by both', findings)
      else if (rectangle .and. .not. group%given(letter//'DEPTH')) then
         call required(group, letter//'DEPTH', 'missing; with the width it gives the section')
      else if (.not. rectangle) then
         if (.not. group%given(letter//'AREA')) call required(group, letter//'AREA', 'missing; give the area (m2) and '//letter// &
                                                              'GYR, or '//letter//'DEPTH and '//letter//'WIDTH')
         if (.not. group%given(letter//'GYR')) call required(group, letter//'GYR', 'missing; the radius of gyration (m)')
      end if
      do k = 1, size(beams)
         call positive(letter//'MOD', beams(k)%modulus, k)
         call positive(letter//'RHO', beams(k)%density, k)
         if (rectangle) then
            call positive(letter//'DEPTH', depth(k), k)
            call positive(letter//'WIDTH', width(k), k)
            area(k) = depth(k)*width(k)
            gyration(k) = depth(k)/sqrt(12.0_wp)
         else
            call positive(letter//'AREA', area(k), k)
            call positive(letter//'GYR', gyration(k), k)
         end if
         if (beams(k)%damping < 0.0_wp .or. beams(k)%damping >= most_damping) then
            call out_of(group, letter//'ZETA', 'entry '//to_text(k)//': must lie between 0 and 1', findings, k)
         end if
         if (beams(k)%shear_ratio < 0.0_wp) then
            call out_of(group, letter//'SHEAR', 'entry '//to_text(k)//': must not be negative', findings, k)
         end if
         if (beams(k)%strain < 0.0_wp) then
            call out_of(group, letter//'STRN', 'entry '//to_text(k)//': must not be negative', findings, k)
         end if
      end do
      beams%depth = depth
      beams%area = area
      beams%gyration = gyration

   contains

      subroutine positive(item, value, k)
         character(*), intent(in) :: item
         real(wp), intent(in) :: value
         integer, intent(in) :: k

         if (group%given(item) .and. .not. value > 0.0_wp) then
            call out_of(group, item, 'entry '//to_text(k)//': must be above 0', findings, k)
         end if
      end subroutine positive
   end subroutine read_beams

   !> The group as the case has it.
   subroutine read_vibration(self, group, about, findings)
      class(vibration_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_vibration_group(group, about%ilink, about%sketch, self, findings)
   end subroutine read_vibration

   subroutine visit_vibration(self, visitor)
      class(vibration_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor

      if (self%given) call visitor%line(self%beam%link)
   end subroutine visit_vibration

   !> The group VIBR of a case; as it is by default where the case does not have it.
   pure function vibration_of(set) result(vibration)
      class(data_set_t), intent(in) :: set
      type(vibration_group_t) :: vibration
      integer :: k

      k = set%place_of('VIBR')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (vibration_group_t)
         vibration = group
      end select
   end function vibration_of

   !> The group as the case has it.
   subroutine read_estimate(self, group, about, findings)
      class(estimate_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_estimate_group(group, about%ilink, about%sketch, self, findings)
   end subroutine read_estimate

   subroutine visit_estimate(self, visitor)
      class(estimate_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor
      integer :: k

      do k = 1, size(self%beams)
         call visitor%line(self%beams(k)%link)
      end do
   end subroutine visit_estimate

   !> The group ESTIM of a case; as it is by default where the case does not have it.
   pure function estimates_of(set) result(estimates)
      class(data_set_t), intent(in) :: set
      type(estimate_group_t) :: estimates
      integer :: k

      k = set%place_of('ESTIM')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (estimate_group_t)
         estimates = group
      end select
   end function estimates_of
end module psalm_vibration_group
