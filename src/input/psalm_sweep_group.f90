!> The group SWEEP: one dimension that is adjustable, over its range; the outputs are a family of curves.
module psalm_sweep_group
   use psalm_case_group, only: case_group_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of, required
   use psalm_kinds, only: wp
   use psalm_rule, only: rule_t, a_number, a_text, a_whole, a_word
   use psalm_sketch, only: sketch_t, variation_t, vary_angle, vary_length
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_text, only: to_text
   use psalm_variation_items, only: read_dimension
   implicit none (type, external)
   private
   public :: sweep_items
   public :: sweep_group_t, sweep_of
   public :: swept_length, swept_angle, swept_outlk, swept_outang, swept_origlk, swept_origng, swept_crnki

   integer, parameter :: swept_length = 1, swept_angle = 2, swept_outlk = 3, swept_outang = 4, swept_origlk = 5, &
                         swept_origng = 6, swept_crnki = 7

   type, extends(case_group_t) :: sweep_group_t
      integer :: what = swept_length         !! SWHAT: one of `swept_...`
      integer :: arc = 0, loop = 0           !! SWLINK, SWLOOP
      type(variation_t) :: dimension         !! SWJNT, of a sketch: the length or angle
      real(wp) :: low = 0.0_wp, high = 0.0_wp !! SWLOW, SWHIGH
      integer :: settings = 5                !! NSWEEP
   contains
      procedure :: read => read_sweep
   end type sweep_group_t

   !> The items of the group.
   type(rule_t), parameter :: sweep_items(*) = [ &
      rule_t('SWLOW', a_number, '', '', 'required', '', &
             'the lowest setting'), &
      rule_t('SWHIGH', a_number, '', '', 'required', '', &
             'the highest setting'), &
      rule_t('NSWEEP', a_whole, '', '', '5', '[2,99]', &
             'settings, evenly between'), &
      rule_t('SWHAT', a_word, '', '', 'LENGTH', 'LENGTH ANGLE OUTLK OUTANG ORIGLK ORIGNG CRNKI', &
             'what is adjusted: length or angle of an arc, or one of the items of that name'), &
      rule_t('SWLINK', a_whole, '', '', '', '', &
             'the arc, with ''LENGTH'' and ''ANGLE'''), &
      rule_t('SWLOOP', a_whole, '', '', '', '', &
             'the loop of that arc'), &
      rule_t('SWJNT', a_text, '1', '', '', '', &
             'of a sketch, in place of SWHAT, SWLINK and SWLOOP: a length by its joints, `''D E''`, or the angle from one line '// &
             'of a link to another, `''angle C D D E''`; the last joint, E, moves')]

contains

   !> Read the group. Errors: arcs and joints that are not there, joints without a link in common, an empty range.
   subroutine read_sweep_group(group, ilink, sketch, sweep, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)     !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch
      type(sweep_group_t), intent(inout) :: sweep
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:)
      integer :: reported                        ! mistakes in SWHAT

      sweep%given = group%line > 0
      call group%follow(sweep_items)
      reported = findings%count
      call take(group, 'SWHAT', sweep%what, findings)
      reported = findings%count - reported
      call take(group, 'SWLINK', sweep%arc, findings)
      call take(group, 'SWLOOP', sweep%loop, findings)
      call group%get_texts('SWJNT', names, findings)
      call take(group, 'SWLOW', sweep%low, findings)
      call take(group, 'SWHIGH', sweep%high, findings)
      call take(group, 'NSWEEP', sweep%settings, findings)
      if (.not. sweep%given) return
      if (group%given('SWLOW') .and. group%given('SWHIGH') .and. .not. sweep%low < sweep%high) &
         call out_of(group, 'SWHIGH', 'must be above SWLOW', findings)
      if (sketch%given) then
         call of_sketch()
         return
      end if
      if (any(sweep%what == [swept_length, swept_outlk]) .and. group%given('SWLOW') .and. .not. sweep%low > 0.0_wp) &
         call out_of(group, 'SWLOW', 'a length must be above 0', findings)
      if (size(names) > 0) call out_of(group, 'SWJNT', 'joints have names in a sketch (&CHAIN) only; give SWLINK and SWLOOP', &
                                       findings)
      if (all(sweep%what /= [swept_length, swept_angle]) .or. reported > 0) return
      if (sweep%loop < 1 .or. sweep%loop > size(ilink, 2)) then
         call out_of(group, 'SWLOOP', 'there is no loop '//to_text(sweep%loop), findings)
      else if (sweep%arc < 1 .or. sweep%arc > size(ilink, 1)) then
         call out_of(group, 'SWLINK', 'there is no arc '//to_text(sweep%arc), findings)
      else if (ilink(sweep%arc, sweep%loop) == 0) then
         call out_of(group, 'SWLINK', 'loop '//to_text(sweep%loop)//' has no arc '//to_text(sweep%arc), findings)
      end if

   contains

      subroutine of_sketch()
         logical :: angle

         if (sweep%what /= swept_length .or. group%given('SWLINK') .or. group%given('SWLOOP')) then
            call out_of(group, merge('SWLINK', 'SWHAT ', group%given('SWLINK')), 'of a sketch a length or an angle is swept, '// &
                        "by its joints: SWJNT='A B' or SWJNT='angle A B B C'", findings)
            return
         end if
         if (size(names) /= 1) then
            call required(group, 'SWJNT', "the joints of the length or angle are expected, SWJNT='A B' or SWJNT='angle A B B C'")
            return
         end if
         call read_dimension(group, 'SWJNT', 1, names(1), sketch, findings, sweep%dimension)
         angle = sweep%dimension%kind == vary_angle
         if (all(sweep%dimension%kind /= [0, vary_length, vary_angle])) call out_of(group, 'SWJNT', "'"//trim(adjustl(names(1)))// &
            "': a length or an angle is swept, as 'A B' or 'angle A B B C'", findings)
         if (group%given('SWLOW') .and. .not. (angle .or. sweep%low > 0.0_wp)) &
            call out_of(group, 'SWLOW', 'a length must be above 0', findings)
      end subroutine of_sketch
   end subroutine read_sweep_group

   !> The group as the case has it.
   subroutine read_sweep(self, group, about, findings)
      class(sweep_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_sweep_group(group, about%ilink, about%sketch, self, findings)
      if (self%given .and. about%sketch%given .and. about%searched) call out_of(group, 'SWJNT', &
         'a sketch is swept in an analysis: search without this group, and add it to device 7', findings)
   end subroutine read_sweep

   !> The group SWEEP of a case; as it is by default where the case does not have it.
   pure function sweep_of(set) result(sweep)
      class(data_set_t), intent(in) :: set
      type(sweep_group_t) :: sweep
      integer :: k

      k = set%place_of('SWEEP')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (sweep_group_t)
         sweep = group
      end select
   end function sweep_of
end module psalm_sweep_group
