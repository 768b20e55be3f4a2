!> A motion in time as a scene: its frames are states at even steps of time, and all curves are over time.
module psalm_time_scene
   use psalm_column_names, only: number_unit, per_time, rate_unit
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, make_problem
   use psalm_force_analysis, only: column_drive, column_fx, column_fy, column_moment, column_of_other_drive
   use psalm_force_study, only: force_study_t, find_forces
   use psalm_kinds, only: wp, degrees_per_radian, full_turn
   use psalm_markup, only: add_string
   use psalm_output_kind, only: kind_of_output
   use psalm_panels, only: add_line, begin_panel, group_energy, group_forces, group_position, group_rates, most_outputs, &
                           with_unit
   use psalm_preparation, only: prepared_t
   use psalm_proof_scene, only: proof_scene_t
   use psalm_scene, only: scene_t
   use psalm_sketch, only: columns_of, output_ratio
   use psalm_stop, only: stop_t
   use psalm_time_group, only: time_group_t, time_of
   use psalm_time_list, only: ending_words
   use psalm_time_study, only: time_study_t, time_done, find_time
   use psalm_trace, only: position_row_t
   implicit none (type, external)
   private
   public :: time_frames_t, find_frames, put_in_time, largest_turn

   integer, parameter :: least_frames = 360, most_frames = 3000 !! steps of the motion
   real(wp), parameter :: frames_a_second = 60.0_wp
   integer, parameter :: most_marks = 40           !! frames at which the output is marked

   !> The motion at its frames.
   type :: time_frames_t
      class(time_study_t), allocatable :: motion   !! large: it would fill a small stack
      class(problem_t), allocatable :: problem     !! at the positions of the case
      integer, allocatable :: marks(:)             !! frames at which the output is marked, the first and others at even distances
   end type time_frames_t

contains

   !> Follow the motion of a case with the group TIME that `check_time` found no fault with. `found` is false if there is none to be
   !> shown: TIME asks for equilibria alone (`frames%motion` has them), or `why` says how it ends at its beginning.
   subroutine find_frames(set, prepared, frames, found, why, stop)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(time_frames_t), intent(out) :: frames
      logical, intent(out) :: found
      character(:), allocatable, intent(out) :: why
      type(stop_t), intent(in), optional :: stop      !! asked before every step; the times so far are there then
      class(force_study_t), allocatable :: forces
      type(time_group_t) :: time
      real(wp) :: end
      integer :: n, i

      found = .false.
      why = ''
      time = time_of(set)
      end = time%times(size(time%times))
      if (.not. (end > 0.0_wp .or. time%equilibria)) return
      allocate (frames%problem, frames%motion, forces)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, frames%problem)
      call find_forces(set, frames%problem, prepared%given, forces)
      if (.not. end > 0.0_wp) then
         call find_time(set, frames%problem, prepared%given, forces, frames%motion, stop)
         return
      end if
      n = steps_of(time%times)
      call find_time(set, frames%problem, prepared%given, forces, frames%motion, stop, &
                     [(end*(real(i, wp)/real(n, wp)), i=0, n)])
      found = size(frames%motion%time) > 1
      if (.not. found) then
         why = ending_words(prepared%mechanism, frames%motion)
         return
      end if
      n = size(frames%motion%time)
      frames%marks = [(i, i=1, n, max(1, (n - 2)/most_marks + 1))]
   end subroutine find_frames

   !> How far a drive turns between two frames, at most: degrees.
   pure real(wp) function largest_turn(frames)
      type(time_frames_t), intent(in) :: frames
      integer :: d

      largest_turn = 0.0_wp
      associate (motion => frames%motion)
         do d = 1, size(motion%free)
            if (motion%forces%drive_slides(d)) cycle
            largest_turn = max(largest_turn, maxval(abs(motion%drives(:, d, 1)))*degrees_per_radian)
         end do
         largest_turn = largest_turn*(motion%time(2) - motion%time(1))
      end associate
   end function largest_turn

   !> How many steps: of even times so many that each of them is a frame, if these are not too many.
   pure integer function steps_of(times) result(n)
      real(wp), intent(in) :: times(:)
      real(wp), parameter :: even = 1.0e-9_wp   ! part of the end
      integer :: i

      associate (rows => size(times) - 1, end => times(size(times)))
         n = nint(min(real(most_frames, wp), max(real(least_frames, wp), frames_a_second*end)))
         if (rows > most_frames) return
         if (any(abs(times - [(end*(real(i, wp)/real(rows, wp)), i=0, rows)]) > even*end)) return
         n = rows*max(1, min((n + rows - 1)/rows, most_frames/rows))
      end associate
   end function steps_of

   !> Let the rows of a scene, which are those of the marks and of the frames, count time; add the curves.
   subroutine put_in_time(set, frames, scene)
      type(data_set_t), intent(in) :: set
      type(time_frames_t), intent(in) :: frames
      type(scene_t), intent(inout) :: scene

      associate (motion => frames%motion, last => size(frames%motion%time))
         scene%time = motion%time(last)
         scene%sliding = .true.
         scene%sense = 1.0_wp
         scene%reference = 1
         scene%input_label = 'time, s'
         call count_time(motion%time(frames%marks), scene%prescribed)
         call count_time(motion%time, scene%sweep)
         call keep_widths(scene)
         call add_panels(set, frames, scene)
         if (motion%ended /= time_done) call add_string(scene%breaches, 'the motion '// &
                                                        ending_words(frames%problem%mechanism, motion))
      end associate
   end subroutine put_in_time

   subroutine count_time(time, row)
      real(wp), intent(in) :: time(:)
      type(position_row_t), intent(inout) :: row

      row%delt = time
      row%input = time
   end subroutine count_time

   !> What is proven is proven over inputs; of it only the widths of the links are drawn.
   subroutine keep_widths(scene)
      type(scene_t), intent(inout) :: scene
      type(proof_scene_t), allocatable :: bare

      if (.not. allocated(scene%proof)) return
      if (size(scene%proof%wide) > 0) then
         allocate (bare)
         allocate (bare%marks(0), bare%near(0))
         bare%wide = scene%proof%wide
      end if
      call move_alloc(bare, scene%proof)
   end subroutine keep_widths

   !> Curves beyond those of the output: inputs, outputs, rates, forces, energies.
   subroutine add_panels(set, frames, scene)
      type(data_set_t), intent(in) :: set
      type(time_frames_t), intent(in) :: frames
      type(scene_t), intent(inout) :: scene
      logical :: known(size(frames%motion%time))
      character(:), allocatable :: what
      integer :: order, d

      known = .true.
      if (allocated(scene%panels)) deallocate (scene%panels)
      allocate (scene%panels(0))
      associate (motion => frames%motion, drives => size(frames%motion%free))
         if (drives == 1 .or. .not. allocated(scene%drives)) then
            what = trim(merge('input  ', 'drive  ', .not. set%has_names()))
            if (set%has_names()) what = what//' '//set%sketch%drive_label(1)//' from the drawing'
            call begin_panel(with_unit(what, drive_unit(1, 0)), group_position, &
                             merge(maxval(abs(motion%drives(:, 1, 0))), full_turn, motion%forces%drive_slides(1)), scene%panels)
            call add_line('', motion%drives(:, 1, 0), known, scene%panels(size(scene%panels)))
         end if
         if (set%has_names()) call add_sketch_outputs(0)
         do order = 1, 2
            if (set%has_names()) then
               call add_sketch_outputs(order)
            else
               call add_outputs(order)
            end if
         end do
         do d = 1, drives
            what = 'speed of the input'
            if (set%has_names()) what = 'speed of drive '//set%sketch%drive_label(d)
            if (.not. frames%problem%mechanism%actuators(d)%geared .or. d == 1) &
               call add_panel(with_unit(what, drive_unit(d, 1)), group_rates, motion%drives(:, d, 1))
         end do
         call add_forces()
         call begin_panel('energy, J', group_energy, motion%turnover, scene%panels)
         associate (panel => scene%panels(size(scene%panels)))
            call add_line('kinetic', motion%forces%table%kinetic, known, panel)
            call add_line('potential', motion%potential, known, panel)
            call add_line('work done', motion%work, known, panel)
            if (any(motion%lost > 0.0_wp)) call add_line('lost', motion%lost, known, panel)
         end associate
      end associate

   contains

      !> A panel of one line, or two.
      subroutine add_panel(name, group, values, others)
         character(*), intent(in) :: name, group
         real(wp), intent(in) :: values(:)
         real(wp), intent(in), optional :: others(:)
         real(wp) :: scale

         scale = maxval(abs(values))
         if (present(others)) scale = max(scale, maxval(abs(others)))
         call begin_panel(name, group, scale, scene%panels)
         associate (panel => scene%panels(size(scene%panels)))
            if (present(others)) then
               call add_line('x', values, known, panel)
               call add_line('y', others, known, panel)
            else
               call add_line('', values, known, panel)
            end if
         end associate
      end subroutine add_panel

      function drive_unit(drive, order) result(unit)
         integer, intent(in) :: drive, order
         character(:), allocatable :: unit

         unit = rate_unit(.not. frames%motion%forces%drive_slides(drive), per_time(), order)
      end function drive_unit

      !> The output of a linkage of loops.
      subroutine add_outputs(order)
         integer, intent(in) :: order

         associate (kind => frames%problem%output%kind, v => frames%motion%output)
            if (kind%components > 1) then
               call add_panel(with_unit(head(order)//'the output point', rate_unit(.false., per_time(), order)), group_rates, &
                              v(:, 1, order), v(:, 2, order))
               if (kind%components > 2) call add_panel(with_unit(head(order)//'the pose', rate_unit(.true., per_time(), order)), &
                                                       group_rates, v(:, 3, order))
            else
               call add_panel(with_unit(head(order)//'the output', rate_unit(kind%angle == 1, per_time(), order)), group_rates, &
                              v(:, 1, order))
            end if
         end associate
      end subroutine add_outputs

      !> Outputs of a sketch; values as far as the scene has them not already.
      subroutine add_sketch_outputs(order)
         integer, intent(in) :: order
         integer :: k, column
         character(:), allocatable :: words

         column = 0
         associate (outputs => set%sketch%outputs, v => frames%motion%sketch%values)
            do k = 1, min(most_outputs, size(outputs))
               column = column + columns_of(outputs(k))
               if (order == 0 .and. (allocated(scene%drives) .or. (k == 1 .and. .not. set%has_stand_in()))) cycle
               if (order > 0 .and. outputs(k)%kind == output_ratio) cycle
               associate (first => column - columns_of(outputs(k)) + 1, kind => kind_of_output(outputs(k)%kind))
                  words = with_unit(head(order)//trim(outputs(k)%name), number_unit(outputs, first, per_time(), order))
                  if (columns_of(outputs(k)) == 1) then
                     call add_panel(words, group_of(order), v(first, order, :))
                     if (order == 0 .and. kind%angle == 1) scene%panels(size(scene%panels))%scale = full_turn
                  else
                     call add_panel(words, group_of(order), v(first, order, :), v(first + 1, order, :))
                  end if
                  if (columns_of(outputs(k)) > 2) &
                     call add_panel(with_unit(head(order)//trim(outputs(k)%name)//', angle', &
                                              number_unit(outputs, first + 2, per_time(), order)), group_of(order), &
                                    v(first + 2, order, :))
               end associate
            end do
         end associate
      end subroutine add_sketch_outputs

      pure function head(order) result(words)
         integer, intent(in) :: order
         character(:), allocatable :: words

         words = ''
         if (order == 1) words = 'velocity of '
         if (order == 2) words = 'acceleration of '
      end function head

      pure function group_of(order) result(group)
         integer, intent(in) :: order
         character(len(group_position)) :: group

         group = merge(group_position, group_rates//repeat(' ', len(group_position) - len(group_rates)), order == 0)
      end function group_of

      !> Of a scene that has no forces of its own those of drives with given speed and of the frame; of all the stops.
      subroutine add_forces()
         integer :: drive, stop, column

         associate (motion => frames%motion, v => frames%motion%forces%table%value)
            if (.not. allocated(scene%forces)) then
               do drive = 1, size(motion%free)
                  if (motion%free(drive)) cycle
                  column = column_drive
                  if (drive > 1) column = column_of_other_drive(size(motion%forces%joints), drive)
                  call add_panel(trim(merge('force of drive  ', 'torque of drive ', motion%forces%drive_slides(drive)))//' '// &
                                 set%sketch%drive_label(drive)//trim(merge(', N  ', ', N m', motion%forces%drive_slides(drive))), &
                                 group_forces, v(:, column))
               end do
               call add_panel('force on the frame, N', group_forces, v(:, column_fx), v(:, column_fy))
               call add_panel('moment on the frame, N m', group_forces, v(:, column_moment))
            end if
            do stop = 1, size(motion%stops, 2)
               call add_panel('stop '//trim(motion%stop_names(stop))//trim(merge(', N  ', ', N m', motion%stop_slides(stop))), &
                              group_forces, motion%stops(:, stop))
            end do
         end associate
      end subroutine add_forces
   end subroutine add_panels
end module psalm_time_scene
