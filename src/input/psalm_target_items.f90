!> What the outputs of a sketch are to be: DES1, DES2 ... of &OUTPUTS, derivatives DVEL1, DACC1 ..., weights WGT1, WVEL1, WACC1 ...
!>
!> Source of the target for derivatives at precision points: Oldham (1977), 9.1.1.
module psalm_target_items
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_sketch, only: sketch_t, columns_of, most_targets, output_ratio
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: read_targets, values_of, weights_of

   character(*), parameter :: values_of(0:most_targets) = [character(4) :: 'DES', 'DVEL', 'DACC']
   character(*), parameter :: weights_of(0:most_targets) = [character(4) :: 'WGT', 'WVEL', 'WACC']

contains

   !> Read them. An output of several numbers has those of the first position, then those of the second ... Errors: too few
   !> values, weights below zero, derivatives of a ratio.
   subroutine read_targets(group, positions, sketch, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: positions          !! NDES
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      real(wp), allocatable :: values(:), weights(:)
      character(:), allocatable :: item
      integer :: k, order, columns, last, last_weight, i

      do k = 1, max(1, size(sketch%outputs))
         columns = 1
         if (k <= size(sketch%outputs)) columns = columns_of(sketch%outputs(k))
         do order = 0, most_targets
            if (allocated(values)) deallocate (values, weights)
            allocate (values(columns*positions), source=0.0_wp)
            allocate (weights(positions), source=1.0_wp)
            item = trim(values_of(order))//to_text(k)
            call group%get_reals(item, values, findings, last=last)
            call group%get_reals(trim(weights_of(order))//to_text(k), weights, findings, last=last_weight)
            if (k > size(sketch%outputs)) cycle
            if (last == 0 .and. last_weight > 0) call out_of(group, trim(weights_of(order))//to_text(k), &
                                                             'weighs '//item//', which is not given', findings, 1)
            if (last == 0) cycle
            if (last < size(values)) then
               call out_of(group, item, 'NDES='//to_text(positions)//' positions of output '//trim(sketch%outputs(k)%name)// &
                           ' have '//to_text(size(values))//' values, but only '//to_text(last)//' given', findings, last)
               cycle
            end if
            if (order > 0 .and. sketch%outputs(k)%kind == output_ratio) then
               call out_of(group, item, 'output '//trim(sketch%outputs(k)%name)//' is a ratio of rates; of that no derivative '// &
                           'can be prescribed', findings, 1)
               cycle
            end if
            if (last_weight == 1) weights = weights(1)
            if (last_weight > 1 .and. last_weight < positions) call out_of(group, trim(weights_of(order))//to_text(k), &
               'is one weight, or one for each of NDES='//to_text(positions)//' positions; found '//to_text(last_weight), &
               findings, last_weight)
            i = findloc(weights < 0.0_wp, .true., dim=1)
            if (i > 0) call out_of(group, trim(weights_of(order))//to_text(k), 'weights must not be negative', findings, i)
            sketch%outputs(k)%targets(order)%values = reshape(values, [columns, positions])
            sketch%outputs(k)%targets(order)%weights = spread(weights, 1, columns)
         end do
      end do
   end subroutine read_targets
end module psalm_target_items
