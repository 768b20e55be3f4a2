!> The group TOLER: tolerances of dimensions, one for all or one for each, and the size of the sample.
module psalm_tolerance_group
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp, half_turn
   use psalm_links_group, only: links_group_t
   use psalm_method_group, only: method_group_t
   use psalm_output_kind, only: motion_pose
   use psalm_rule, only: rule_t, a_flag, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t, variation_t, vary_angle, vary_length
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_text, only: to_text
   use psalm_variation_items, only: read_dimension
   implicit none (type, external)
   private
   public :: tolerance_items
   public :: tolerance_group_t, read_tolerance_group

   !> Tolerances, each to either side. Angles in degrees, lengths in the user's one unit.
   type :: tolerance_group_t
      logical :: given = .false.                   !! the group was given
      real(wp), allocatable :: tolarc(:, :), tolgam(:, :) !! shape (maxarc, nloop): of ARCL and GAMA
      real(wp) :: tolout = 0.0_wp, toloua = 0.0_wp !! of OUTLK, OUTANG
      real(wp) :: tolorl = 0.0_wp, tolora = 0.0_wp !! of ORIGLK, ORIGNG
      real(wp) :: tolcrk = 0.0_wp                  !! of CRNKI
      real(wp) :: of_pivot(2) = 0.0_wp             !! of a sketch: distance and direction of the input pivot
      logical :: adjusted = .false.                !! ADJUST=1: every dimension as the adjustable one
      real(wp) :: outtol = 0.0_wp                  !! of the output; 0: not given
      real(wp) :: in_objective = 0.0_wp            !! TOLOBJ: weight of deviations in the objective of a search
      integer :: ntrial = 0                        !! linkages of the Monte-Carlo sample
      real(wp) :: tollen = 0.0_wp, tolang = 0.0_wp !! of all lengths, of all angles
      type(variation_t), allocatable :: named(:)   !! dimensions of a sketch with tolerances of their own,
      real(wp), allocatable :: of_named(:)         !! and these
   end type tolerance_group_t

   !> The items of the group.
   type(rule_t), parameter :: tolerance_items(*) = [ &
      rule_t('TOLLEN', a_number, '', 'length', '0', '', &
             'largest deviation, to either side, of all lengths'), &
      rule_t('TOLANG', a_number, '', 'degrees', '0', '', &
             'the same of all fixed angles'), &
      rule_t('TOLNAM', a_text, 'n', '', '', '', &
             'of a sketch: dimensions with tolerances of their own, lengths `''A B''` and angles `''angle B C B P''` as VARY '// &
             'of &CHAIN names them'), &
      rule_t('TOLVAL', a_number, 'n', '', 'required with TOLNAM', '', &
             'their tolerances, length or degrees, in the order of TOLNAM'), &
      rule_t('TOLARC', a_number, 'NLOOP*MAXARC', 'length', 'TOLLEN', '', &
             'the same of single lengths, like ARCL'), &
      rule_t('TOLGAM', a_number, 'NLOOP*MAXARC', 'degrees', 'TOLANG', '', &
             'the same of single angles, like GAMA'), &
      rule_t('TOLOUT', a_number, '', 'length', 'TOLLEN where OUTLK is not zero', '', &
             'of OUTLK'), &
      rule_t('TOLOUA', a_number, '', 'degrees', 'TOLANG', '', &
             'of OUTANG'), &
      rule_t('TOLORL', a_number, '', 'length', 'TOLLEN where ORIGLK is not zero', '', &
             'of ORIGLK'), &
      rule_t('TOLORA', a_number, '', 'degrees', 'TOLANG where ORIGLK is not zero', '', &
             'of ORIGNG'), &
      rule_t('TOLCRK', a_number, '', '', '0', '', &
             'of CRNKI'), &
      rule_t('ADJUST', a_flag, '', '', '0', '', &
             '1: which member, adjustable, restores the output, see below'), &
      rule_t('OUTTOL', a_number, '', '', '0', '[0,)', &
             'tolerance of the output itself, to either side, for ADJUST', &
             'is the largest deviation of the output to either side; not negative'), &
      rule_t('TOLOBJ', a_number, '', '', '0', '[0,)', &
             'weight of deviations in the objective of a search; 1: the objective is its mean over linkages within the '// &
             'tolerances, to first order'), &
      rule_t('NTRIAL', a_whole, '', '', '0', '[0,1000000000]', &
             'linkages of a Monte-Carlo sample')]

contains

   !> Read the group. Errors: tolerances that are negative or not smaller than what they are of.
   subroutine read_tolerance_group(group, links, method, sketch, toler, findings)
      type(group_t), intent(inout) :: group
      type(links_group_t), intent(in) :: links
      type(method_group_t), intent(in) :: method
      type(sketch_t), intent(in) :: sketch
      type(tolerance_group_t), intent(inout) :: toler
      type(diagnostics_t), intent(inout) :: findings
      real(wp), allocatable :: reals(:)
      real(wp) :: of_lengths, of_angles
      integer :: n

      n = links%nloop*links%maxarc
      allocate (toler%tolarc(links%maxarc, links%nloop), toler%tolgam(links%maxarc, links%nloop), source=0.0_wp)
      toler%given = group%line > 0
      call group%follow(tolerance_items)
      call take(group, 'TOLLEN', of_lengths, findings)
      call take(group, 'TOLANG', of_angles, findings)
      allocate (reals(n), source=of_lengths)
      call group%get_reals('TOLARC', reals, findings, links%maxarc, filler=.true.)
      toler%tolarc = reshape(reals, [links%maxarc, links%nloop])
      reals = of_angles
      call group%get_reals('TOLGAM', reals, findings, links%maxarc, filler=.true.)
      toler%tolgam = reshape(reals, [links%maxarc, links%nloop])
      if (links%outlk > 0.0_wp) toler%tolout = of_lengths
      toler%toloua = of_angles
      if (method%origlk > 0.0_wp) toler%tolorl = of_lengths
      if (method%origlk > 0.0_wp) toler%tolora = of_angles
      call take(group, 'TOLOUT', toler%tolout, findings)
      call take(group, 'TOLOUA', toler%toloua, findings)
      call take(group, 'TOLORL', toler%tolorl, findings)
      call take(group, 'TOLORA', toler%tolora, findings)
      call take(group, 'TOLCRK', toler%tolcrk, findings)
      toler%of_pivot = [of_lengths, of_angles]
      if (group%given('TOLORL')) toler%of_pivot(1) = toler%tolorl
      if (group%given('TOLORA')) toler%of_pivot(2) = toler%tolora
      toler%tollen = of_lengths
      toler%tolang = of_angles
      call read_named()
      call take(group, 'ADJUST', toler%adjusted, findings)
      call take(group, 'OUTTOL', toler%outtol, findings)
      if (toler%adjusted .and. method%motion == motion_pose) call out_of(group, 'ADJUST', &
         'the deviations of a pose are lengths and angles; ask for its point or its angle', findings)
      call take(group, 'TOLOBJ', toler%in_objective, findings)
      call take(group, 'NTRIAL', toler%ntrial, findings)
      if (any(toler%tolarc >= links%arcl .and. links%arcl > 0.0_wp)) then
         call group%origins%error(findings, 'TOLER', '', 'the tolerance of a length is not smaller than the length')
      end if
      if (any(toler%tolgam > half_turn) .or. max(toler%toloua, toler%tolora) > half_turn) then
         call group%origins%error(findings, 'TOLER', '', 'the tolerance of an angle is more than 180 degrees')
      end if
      if (any(toler%tolarc < 0.0_wp) .or. any(toler%tolgam < 0.0_wp) .or. min(toler%tolout, toler%toloua, toler%tolorl, &
                                                            toler%tolora, &
                                                                         toler%tolcrk) < 0.0_wp) then
         call group%origins%error(findings, 'TOLER', '', 'a tolerance is negative; it is the largest deviation to either side')
      end if

   contains

      subroutine read_named()
         character(:), allocatable :: texts(:)
         integer :: i, last

         call group%get_texts('TOLNAM', texts, findings)
         allocate (toler%named(size(texts)), toler%of_named(size(texts)))
         toler%of_named = 0.0_wp
         call take(group, 'TOLVAL', toler%of_named, findings, last=last)
         if (size(texts) > 0 .and. .not. sketch%given) then
            call out_of(group, 'TOLNAM', 'joints have names in a sketch (&CHAIN) only; give TOLARC and TOLGAM', findings)
            return
         end if
         if (last /= size(texts)) call out_of(group, 'TOLVAL', to_text(size(texts))//' dimensions are named, but '// &
                                              to_text(last)//' tolerances given', findings)
         if (any(toler%of_named < 0.0_wp)) call out_of(group, 'TOLVAL', &
            'a tolerance is negative; it is the largest deviation to either side', findings)
         if (.not. (sketch%given .and. sketch%valid)) return
         do i = 1, size(texts)
            associate (one => toler%named(i))
               call read_dimension(group, 'TOLNAM', i, texts(i), sketch, findings, one)
               if (all(one%kind /= [0, vary_angle, vary_length])) call out_of(group, 'TOLNAM', "'"//trim(adjustl(texts(i)))// &
                  "': lengths 'A B' and angles 'angle B C B P' have tolerances here; the input has TOLCRK, the place of the "// &
                  'input pivot TOLORL and TOLORA', findings, i)
            end associate
         end do
      end subroutine read_named
   end subroutine read_tolerance_group
end module psalm_tolerance_group
