!> What the study of a sketch has to report, on all devices.
module psalm_chain_report
   use psalm_chain_list, only: list_rows
   use psalm_chain_proof_list, only: list_chain_proof, put_chain_proof, links_of_group
   use psalm_chain_proof_study, only: chain_proof_t
   use psalm_chain_study, only: chain_study_t
   use psalm_constraint_group, only: range_positions
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_kinds, only: degrees_per_radian, wp
   use psalm_number_format, only: number_words, rounding_error
   use psalm_position_table, only: plot_sketch
   use psalm_sketch, only: numbers_of => columns_of, sketch_output_t, output_angle, output_between, output_distance, output_point, &
                           output_pose, output_slide, output_x, output_y
   use psalm_sketch_outputs, only: name_length
   use psalm_sketch_study, only: sketch_study_t
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: report_outputs, report_swept_outputs, several_outputs, range_lines, report_chain_proof, &
             report_unreached, report_still_drives, unreached_words

   character(*), parameter :: of_dyads = 'linkages of dyads with one drive on the frame'

contains

   !> All outputs of a sketch of which the listing has the first alone, or none: a table, a block of device 9.
   subroutine report_outputs(set, study, beyond, orders, devices)
      type(data_set_t), intent(in) :: set
      type(sketch_study_t), intent(in) :: study
      logical, intent(in), optional :: beyond(:) !! shape (positions): `beyond` of `motion_t`; absent: it was not followed
      integer, intent(in) :: orders           !! 2 with rates, else 0
      type(devices_t), intent(inout) :: devices
      character(name_length), allocatable :: names(:)
      real(wp), allocatable :: values(:, :)
      real(wp), allocatable :: errors(:, :)   ! not allocated: an absent argument

      ! the inputs of several drives are reported there, too
      if (.not. (several_outputs(set) .or. size(set%sketch%drives) > 1)) return
      call columns_of(study, orders, names, values)
      if (allocated(study%conditions)) call find_errors(set%sketch%outputs, study, orders, errors)
      call devices%six%add()
      call devices%six%add(' ALL OUTPUTS, INPUTS FROM THE DRAWING')
      call list_rows(set, study%inputs, study%closed, names, values, devices%six, beyond, errors)
      call plot_sketch('outputs', set%sketch, study, orders, devices%cases(devices%last_case()))
   end subroutine report_outputs

   !> All outputs over the sweep that IPLOT asks for: a block of device 9, row by row with that of the sweep.
   subroutine report_swept_outputs(set, study, devices)
      type(data_set_t), intent(in) :: set
      type(sketch_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices

      call plot_sketch('swept_outputs', set%sketch, study, 0, devices%cases(devices%last_case()))
   end subroutine report_swept_outputs

   !> True if there are outputs that listing and summary of the loops do not have: all but the first, or that one, too.
   pure logical function several_outputs(set)
      type(data_set_t), intent(in) :: set

      several_outputs = size(set%sketch%outputs) > merge(0, 1, set%has_stand_in())
   end function several_outputs

   !> Ranges of the outputs that the summary has not: all but the first, or all.
   subroutine range_lines(set, study, text)
      type(data_set_t), intent(in) :: set
      type(sketch_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      integer :: n, first

      first = 1
      if (.not. set%has_stand_in() .and. size(set%sketch%outputs) > 0 .and. all(set%sketch%drives(2:)%geared)) &
         first = 1 + numbers_of(set%sketch%outputs(1))
      do n = first, size(study%names)
         call add_range(study, n, ' at the positions', text)
      end do
   end subroutine range_lines

   !> Least and greatest value of a number.
   subroutine add_range(study, n, where_words, text)
      class(sketch_study_t), intent(in) :: study
      integer, intent(in) :: n
      character(*), intent(in) :: where_words
      type(text_t), intent(inout) :: text
      character(*), parameter :: label = '  Output              '
      real(wp) :: least, most

      if (.not. any(study%closed)) return
      call study%find_range(n, least, most)
      if (least <= most) then
         call text%add(label//trim(study%names(n))//' '//number_words(least)//' to '// &
                       number_words(most)//where_words)
      else
         call text%add(label//trim(study%names(n))//' has no value: it is a ratio to what stands still')
      end if
   end subroutine add_range

   !> Names and values of all numbers, with `orders` above 0 of their rates.
   subroutine columns_of(study, orders, names, values)
      class(sketch_study_t), intent(in) :: study
      integer, intent(in) :: orders
      character(name_length), allocatable, intent(out) :: names(:)
      real(wp), allocatable, intent(out) :: values(:, :)   !! shape (columns, positions)
      integer :: n, o, m

      allocate (names(size(study%names)*(orders + 1)))
      allocate (values(size(names), size(study%inputs, 2)))
      m = 0
      do n = 1, size(study%names)
         do o = 0, orders
            m = m + 1
            names(m) = study%names(n)
            if (o == 1) names(m) = trim(names(m))//'.v'
            if (o == 2) names(m) = trim(names(m))//'.a'
            values(m, :) = study%values(n, o, :)
            ! at a dead point there are no rates
            if (o > 0) values(m, :) = merge(huge(1.0_wp), values(m, :), study%dead)
         end do
      end do
   end subroutine columns_of

   !> Bounds of what rounding makes of the values of `columns_of`; 0 where there is none, and for rates.
   subroutine find_errors(outputs, study, orders, errors)
      type(sketch_output_t), intent(in) :: outputs(:)
      class(sketch_study_t), intent(in) :: study       !! with condition numbers
      integer, intent(in) :: orders
      real(wp), allocatable, intent(out) :: errors(:, :) !! shape (columns, positions)
      integer :: k, c, number

      allocate (errors(size(study%names)*(orders + 1), size(study%inputs, 2)), source=0.0_wp)
      number = 0
      do k = 1, size(outputs)
         do c = 1, numbers_of(outputs(k))
            number = number + 1
            associate (row => errors((number - 1)*(orders + 1) + 1, :), condition => study%conditions(k, :), &
                       value => study%values(number, 0, :))
               select case (outputs(k)%kind)
               case (output_angle, output_between)
                  row = rounding_error(condition, degrees_per_radian)
               case (output_point, output_x, output_y, output_pose)
                  row = rounding_error(condition, abs(study%joints(outputs(k)%joints(1), 0, :)))
                  if (c > 2) row = rounding_error(condition, degrees_per_radian)
               case (output_distance, output_slide)
                  ! of a slide the number is relative to the travel from its zero, which the greatest is not less than
                  row = rounding_error(condition, merge(maxval(abs(value)), value, outputs(k)%kind == output_slide))
               end select
            end associate
         end do
      end do
   end subroutine find_errors

   !> Positions at which the loops close but which the linkage does not come to from the drawing.
   subroutine report_unreached(set, beyond, devices)
      type(data_set_t), intent(in) :: set
      logical, intent(in) :: beyond(:)        !! shape (positions)
      type(devices_t), intent(inout) :: devices

      if (.not. any(beyond)) return
      call devices%note_violation()
      call devices%remark(set, unreached_words(beyond))
   end subroutine report_unreached

   !> Which positions close but are not reached, in words.
   pure function unreached_words(beyond) result(words)
      logical, intent(in) :: beyond(:)        !! shape (positions)
      character(:), allocatable :: words

      words = 'at '//to_text(count(beyond))//' of '//to_text(size(beyond))//' positions, first position '// &
              to_text(findloc(beyond, .true., dim=1))//', the links can be put together, but the linkage '// &
              'does not come there from the drawing without passing a dead point (closed is 0 in the table)'
   end function unreached_words

   !> Drives that change from position to position, but whose speed is 0: velocities and forces are those of a drive at rest.
   subroutine report_still_drives(set, devices)
      type(data_set_t), intent(in) :: set
      type(devices_t), intent(inout) :: devices
      integer :: d

      do d = 2, size(set%sketch%drives)
         associate (drive => set%sketch%drives(d))
            if (drive%geared .or. .not. allocated(drive%delt)) cycle
            if (abs(drive%speed) > 0.0_wp .or. abs(drive%accel) > 0.0_wp) cycle
            if (maxval(drive%delt) <= minval(drive%delt)) cycle
            call devices%remark(set, 'drive '//set%sketch%drive_label(d)//' stands still in the velocities and forces: its '// &
                                'DSPEED of &DRIVES is 0, though DELT'//to_text(d)//' changes')
         end associate
      end do
   end subroutine report_still_drives

   !> What is proven of the motion: listing, device 9, remarks and exit status.
   subroutine report_chain_proof(set, study, proof, devices)
      type(data_set_t), intent(in) :: set
      type(chain_study_t), intent(in) :: study
      type(chain_proof_t), intent(in) :: proof
      type(devices_t), intent(inout) :: devices

      if (proof%braced > 0) then
         if (set%constr%given) call devices%remark(set, 'margins and clearances are found here, at samples, not proven: '// &
                                                   'links in excess (KOVER) fit exact lengths only')
         if (set%limits%iproof <= 0) return
         call devices%note_violation()
         call devices%remark(set, 'IPROOF proves nothing where more constraints hold the links than are needed: '// &
                             links_of_group(study, proof%braced, small=.true.))
         return
      end if
      if (proof%empty) then
         if (set%limits%iproof > 0) call devices%remark(set, &
                                                        'IPROOF proves the motion between the inputs, but the drives do not move')
         return
      end if
      call list_chain_proof(set, study, proof, devices%six)
      call put_chain_proof(set%title, study, proof, devices%cases(devices%last_case()))
      if (set%constr%given .and. set%constr%irange /= range_positions) &
         call devices%remark(set, 'how far groups are from a dead point is found here at samples, not proven, as it is of '// &
                             of_dyads//trim(merge('; that they meet none over the range is proven', repeat(' ', 46), &
                                                  proof%complete)))
      if (any(proof%kept%is_broken)) call devices%note_violation()
      if (any(proof%kept%is_broken)) call devices%remark(set, to_text(count(proof%kept%is_broken))//' of '// &
         to_text(size(proof%kept))//' clearances are proven to be less than asked; see the end of the listing')
      if (.not. proof%complete .or. proof%misplaced > 0) call devices%note_violation()
      if (.not. proof%complete) call devices%remark(set, 'the linkage is not proven to close over the whole range')
      if (proof%misplaced > 0) call devices%remark(set, to_text(proof%misplaced)//' positions were found in another assembly '// &
                                                   'than the motion from the drawing leads to')
   end subroutine report_chain_proof

end module psalm_chain_report
