!> The group TOLER: tolerances of dimensions, one for all or one for each, and the size of the sample.
module psalm_tolerance_group
   use psalm_group, only: group_t, check_range, out_of
   use psalm_kinds, only: wp, half_turn
   use psalm_links_group, only: links_group_t
   use psalm_method_group, only: method_group_t
   use psalm_output_kind, only: motion_pose
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: tolerance_group_t, read_tolerance_group

   integer, parameter :: most_trials = 1000000000  !! above this NTRIAL is taken for a slip of the pen

   !> Tolerances, each to either side. Angles in degrees, lengths in the user's one unit.
   type :: tolerance_group_t
      logical :: given = .false.                   !! the group was given
      real(wp), allocatable :: tolarc(:, :), tolgam(:, :) !! shape (maxarc, nloop): of ARCL and GAMA
      real(wp) :: tolout = 0.0_wp, toloua = 0.0_wp !! of OUTLK, OUTANG
      real(wp) :: tolorl = 0.0_wp, tolora = 0.0_wp !! of ORIGLK, ORIGNG
      real(wp) :: tolcrk = 0.0_wp                  !! of CRNKI
      logical :: adjusted = .false.                !! ADJUST=1: every dimension as the adjustable one
      real(wp) :: outtol = 0.0_wp                  !! of the output; 0: not given
      integer :: ntrial = 0                        !! linkages of the Monte-Carlo sample
      real(wp) :: tollen = 0.0_wp, tolang = 0.0_wp !! of all lengths, of all angles
   end type tolerance_group_t

contains

   !> Read the group. Errors: tolerances that are negative or not smaller than what they are of.
   subroutine read_tolerance_group(group, links, method, toler, findings)
      type(group_t), intent(inout) :: group
      type(links_group_t), intent(in) :: links
      type(method_group_t), intent(in) :: method
      type(tolerance_group_t), intent(inout) :: toler
      type(diagnostics_t), intent(inout) :: findings
      real(wp), allocatable :: reals(:)
      real(wp) :: of_lengths, of_angles
      integer :: n, adjust

      n = links%nloop*links%maxarc
      allocate (toler%tolarc(links%maxarc, links%nloop), toler%tolgam(links%maxarc, links%nloop), source=0.0_wp)
      toler%given = group%line > 0
      of_lengths = 0.0_wp
      of_angles = 0.0_wp
      call group%get_real('TOLLEN', of_lengths, findings)
      call group%get_real('TOLANG', of_angles, findings)
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
      call group%get_real('TOLOUT', toler%tolout, findings)
      call group%get_real('TOLOUA', toler%toloua, findings)
      call group%get_real('TOLORL', toler%tolorl, findings)
      call group%get_real('TOLORA', toler%tolora, findings)
      call group%get_real('TOLCRK', toler%tolcrk, findings)
      toler%tollen = of_lengths
      toler%tolang = of_angles
      adjust = 0
      call group%get_integer('ADJUST', adjust, findings)
      call check_range(group, 'ADJUST', adjust, 0, 1, findings)
      toler%adjusted = adjust == 1
      call group%get_real('OUTTOL', toler%outtol, findings)
      if (toler%outtol < 0.0_wp) call out_of(group, 'OUTTOL', &
                                             'is the largest deviation of the output to either side; not negative', &
                                           findings)
      if (toler%adjusted .and. method%motion == motion_pose) call out_of(group, 'ADJUST', &
         'the deviations of a pose are lengths and angles; ask for its point or its angle', findings)
      call group%get_integer('NTRIAL', toler%ntrial, findings)
      call check_range(group, 'NTRIAL', toler%ntrial, 0, most_trials, findings)
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
   end subroutine read_tolerance_group
end module psalm_tolerance_group
