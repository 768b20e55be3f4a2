!> The cases of a file become scenes: what pictures show. Source: Oldham (1977), section 15.1.
module psalm_picture_study
   use psalm_allocation_scene, only: allocation_scene_t, make_allocation_scene
   use psalm_chain_report, only: unreached_words
   use psalm_chain_scene, only: make_chain_scene
   use psalm_clearance_scene, only: clearance_scene_t, make_clearance_scene
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: most_reported
   use psalm_dxf_group, only: dxf_group_t, dxf_of
   use psalm_error, only: problem_t, motion_t, make_problem
   use psalm_force_scene, only: extent_of_weights, make_force_scene
   use psalm_finale, only: describe_violation
   use psalm_kinds, only: wp
   use psalm_markup, only: strings_t, add_string
   use psalm_mode_scene, only: make_mode_scenes, put_ghosts
   use psalm_phase_curves, only: make_phase_curves
   use psalm_pictured, only: new_pictures, pictured_t
   use psalm_pole_scene, only: asks_for_poles, check_poles, make_pole_scene
   use psalm_preparation, only: memory_need_t, prepared_t, prepare
   use psalm_row_study, only: row_study_t, study_rows, study_times
   use psalm_scene, only: scene_t, add_curves, make_scene, message_scene
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t, finding_t, level_error
   use psalm_stop, only: stop_t
   use psalm_text, only: to_text
   use psalm_time_scene, only: time_frames_t, find_frames, largest_turn, put_in_time
   use psalm_time_study, only: check_time
   use psalm_vibration_scene, only: vibration_scene_t, make_vibration_scene
   implicit none (type, external)
   private
   public :: make_scenes

   real(wp), parameter :: rough = 30.0_wp  !! degrees between two states of a motion in time, which pictures join by straight lines
   integer, parameter :: most_drawn = 2000 !! positions of a picture; more of them make one black band
   type(memory_need_t), parameter :: need = memory_need_t(position=1000, arc=500, ktheta_only=.false.)

contains

   !> Scenes of all cases of a file, in their order; those with faults become scenes of messages. What the host ends is
   !> not whole and of no use.
   subroutine make_scenes(sets, findings, cases, stop)
      type(data_set_t), intent(in) :: sets(:)
      type(diagnostics_t), intent(inout) :: findings  !! of reading the file; SETUP's are added
      type(pictured_t), allocatable, intent(out) :: cases(:)
      type(stop_t), intent(in), optional :: stop      !! asked by what takes long: vibration, clearance, motion in time
      type(finding_t), allocatable :: read(:), own(:)
      type(diagnostics_t) :: noted
      type(line_t) :: none(0)
      class(prepared_t), allocatable :: prepared
      class(row_study_t), allocatable :: study
      real(wp), allocatable :: chosen             ! not allocated: absent where it is an argument, as is `kept`
      integer, allocatable :: kept(:)
      integer :: k
      logical :: by_links, timed

      call new_pictures(size(sets), cases)
      allocate (prepared)
      read = finding_list(findings)
      do k = 1, size(sets)
         allocate (cases(k)%undrawn(0))
         own = of_case(read, k)
         cases(k)%dxf = dxf_of(sets(k))
         if (allocated(chosen)) deallocate (chosen)
         if (cases(k)%dxf%anywhere) chosen = cases(k)%dxf%increment
         noted = diagnostics_t()
         noted%file = sets(k)%file
         if (any(own%level == level_error)) then
            call message_scene(sets(k), own, cases(k)%scene)
            cycle
         end if
         if (sets(k)%gives('EXACT')) then
            call add_poles(sets(k), noted, cases(k))
            call add_findings(noted, own)
            call findings%append(noted)
            call message_scene(sets(k), own, cases(k)%scene)
            cycle
         end if
         by_links = .false.
         if (allocated(sets(k)%traced)) by_links = .not. sets(k)%traced%are_of_one_crank()
         timed = sets(k)%gives('TIME')
         if (timed .or. .not. by_links) call prepare(sets(k), none, prepared, noted, need)
         if (timed .and. prepared%ready) then
            call check_time(sets(k), prepared%mechanism, noted)
            prepared%ready = .not. noted%failed()
         end if
         if (timed .and. prepared%ready) call add_motion(sets(k), prepared, by_links, noted, own, cases(k), timed, &
                                                                 chosen, stop)
         if (allocated(kept)) deallocate (kept)
         if (.not. (timed .or. by_links) .and. prepared%ready .and. sets(k)%method%ikin == 0 .and. &
             sets(k)%method%ndes > most_drawn) kept = positions_drawn(sets(k), noted)
         call add_findings(noted, own)
         call findings%append(noted)
         if (timed .and. prepared%ready) cycle
         if (by_links) then
            call make_chain_scene(sets(k), own, cases(k)%scene, chosen)
            if (sets(k)%gives('ALLOC') .and. cases(k)%scene%valid) call add_allotted_by_links(sets(k), findings, cases(k), stop)
            cycle
         end if
         if (prepared%ready) then
            associate (each => sets(k), scene => cases(k)%scene)
               if (allocated(study)) deallocate (study)
               allocate (study)
               call study_rows(each, prepared%mechanism, prepared%given, prepared%parameters, study, chosen, kept=kept)
               call make_scene(each, study, .false., own, scene)
               if (scene%valid) call add_curves(each, study, scene)
               if (scene%valid .and. draws_links(each, cases(k)%dxf)) then
                  allocate (cases(k)%parts)
                  call make_chain_scene(each, own, cases(k)%parts, chosen, rows=study)
               end if
               if (each%gives('VIBR') .and. scene%valid) call add_vibration(each, prepared, scene, stop)
               if (each%gives('CLEAR') .and. scene%valid) call add_clearance(each, prepared, scene, stop)
               if (each%gives('ALLOC') .and. scene%valid) call add_allotted(each, prepared, findings, cases(k), stop)
            end associate
            if (allocated(cases(k)%scene%prescribed%beyond)) then
               if (any(cases(k)%scene%prescribed%beyond)) &
                  call add_string(cases(k)%scene%breaches, unreached_words(cases(k)%scene%prescribed%beyond))
            end if
            if (allocated(kept)) call look_at_all_positions(sets(k), prepared, cases(k)%undrawn)
         else
            call message_scene(sets(k), own, cases(k)%scene)
         end if
      end do
      do k = 1, size(cases)
         if (allocated(cases(k)%ghosts)) call put_ghosts(cases(k)%ghosts, cases(k)%scene)
      end do

   contains

      !> Findings between the title of this case and that of the next; what has no line belongs to the first case.
      pure function of_case(list, k) result(some)
         type(finding_t), intent(in) :: list(:)
         integer, intent(in) :: k
         type(finding_t), allocatable :: some(:)
         integer :: first, last

         first = sets(k)%title_line
         if (k == 1) first = 0
         last = huge(1)
         if (k < size(sets)) last = sets(k + 1)%title_line - 1
         some = pack(list, list%line >= first .and. list%line <= last)
      end function of_case

      !> By way of a variable: gfortran keeps the texts of a function's result within an array constructor.
      pure subroutine add_findings(findings, list)
         type(diagnostics_t), intent(in) :: findings
         type(finding_t), allocatable, intent(inout) :: list(:)
         type(finding_t), allocatable :: added(:)

         added = finding_list(findings)
         list = [list, added]
      end subroutine add_findings

      pure function finding_list(findings) result(list)
         type(diagnostics_t), intent(in) :: findings
         type(finding_t), allocatable :: list(:)

         allocate (list(0))
         if (findings%count > 0) list = findings%list(:findings%count)
      end function finding_list
   end subroutine make_scenes

   !> The curves of four poses; whatever else &EXACT asks for is linkages, which psalm finds.
   subroutine add_poles(set, noted, case)
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: noted
      type(pictured_t), intent(inout) :: case
      logical :: drawn

      if (.not. asks_for_poles(set)) then
         call noted%error('asks the program psalm for linkages; use the cases of its device 7 (of &EXACT balm draws four poses)', &
                          line=set%title_line, group='EXACT')
         return
      end if
      call check_poles(set, noted)
      if (noted%failed()) return
      allocate (case%poles)
      call make_pole_scene(set, case%poles, drawn)
      if (drawn) return
      deallocate (case%poles)
      call noted%error('degenerate: these poses have no curves that can be drawn', line=set%title_line, group='EXACT')
   end subroutine add_poles

   !> The motion in time of a case that is ready. `drawn` is false, with a warning where it ends at its beginning, if its positions
   !> are to be drawn in place of it.
   subroutine add_motion(set, prepared, by_links, noted, own, case, drawn, chosen, stop)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      logical, intent(in) :: by_links                 !! it is drawn in the poses of its links
      type(diagnostics_t), intent(inout) :: noted
      type(finding_t), intent(in) :: own(:)           !! findings of reading
      type(pictured_t), intent(inout) :: case
      logical, intent(out) :: drawn
      real(wp), intent(in), optional :: chosen        !! increment of the input for a drawing for CAD
      type(stop_t), intent(in), optional :: stop
      class(time_frames_t), allocatable :: frames     ! large, as the rows are: they would fill a small stack
      class(row_study_t), allocatable :: rows
      type(finding_t), allocatable :: all_findings(:)
      character(:), allocatable :: why

      allocate (frames, rows)
      call find_frames(set, prepared, frames, drawn, why, stop)
      if (allocated(frames%motion)) then
         if (frames%motion%rests .and. size(frames%motion%time) > 0) call add_rests()
      end if
      if (.not. drawn) then
         if (len(why) > 0) call set%origins%warning(noted, 'TIME', '', 'the motion in time is not drawn: '//why)
         return
      end if
      if (largest_turn(frames) > rough) call set%origins%warning(noted, 'TIME', 'TEND', 'a drive turns by up to '// &
         to_text(nint(largest_turn(frames)))//' degrees between two of the '//to_text(size(frames%motion%time))// &
         ' states that pictures show; between them they are rough')
      call study_times(set, prepared%mechanism, prepared%given, prepared%parameters, frames%motion, frames%marks, rows, chosen)
      all_findings = own
      if (noted%count > 0) all_findings = [own, noted%list(:noted%count)]
      if (by_links) then
         call make_chain_scene(set, all_findings, case%scene, chosen, rows=rows)
         if (case%scene%valid) then
            allocate (case%scene%forces)
            call make_force_scene(set, rows, case%scene%forces)
            call extent_of_weights(case%scene%forces, case%scene%low, case%scene%high)
         end if
      else
         call make_scene(set, rows, .false., all_findings, case%scene)
         if (case%scene%valid .and. draws_links(set, case%dxf)) then
            allocate (case%parts)
            call make_chain_scene(set, all_findings, case%parts, chosen, rows=rows)
         end if
      end if
      drawn = case%scene%valid
      if (.not. drawn) return
      call put_in_time(set, frames, case%scene)
      call make_phase_curves(set, frames%motion, case%phase)

   contains

      !> Equilibria, and the oscillations about those that are stable.
      subroutine add_rests()
         character(:), allocatable :: undrawn

         call make_mode_scenes(set, prepared, by_links, frames%motion, case%ghosts, case%modes, undrawn)
         if (len(undrawn) > 0) call set%origins%warning(noted, 'TIME', 'IEQUIL', 'not drawn, because the linkage does not '// &
                                                        'close about there:'//undrawn)
      end subroutine add_rests
   end subroutine add_motion

   !> The link that the group VIBR names; a case that ssics refuses is drawn without.
   subroutine add_vibration(set, prepared, scene, stop)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(scene_t), intent(inout) :: scene
      type(stop_t), intent(in), optional :: stop
      type(vibration_scene_t) :: vibration
      logical :: found

      call make_vibration_scene(set, prepared, scene%sweep%delt, vibration, found, stop)
      if (found) scene%vibration = vibration
   end subroutine add_vibration

   !> The joint that the group CLEAR names; a case that bridge refuses is drawn without.
   subroutine add_clearance(set, prepared, scene, stop)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(scene_t), intent(inout) :: scene
      type(stop_t), intent(in), optional :: stop
      type(clearance_scene_t) :: clearance
      logical :: found

      call make_clearance_scene(set, prepared, scene%sweep%delt, clearance, found, stop)
      if (found) scene%clearance = clearance
   end subroutine add_clearance

   !> The tolerances of the group ALLOC; a case without such tolerances is drawn without them, with a warning.
   subroutine add_allotted(set, prepared, findings, case, stop)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      type(pictured_t), intent(inout) :: case
      type(stop_t), intent(in), optional :: stop
      type(allocation_scene_t), allocatable :: allotted
      logical :: found

      allocate (allotted)
      call make_allocation_scene(set, prepared, allotted, found, stop)
      if (.not. found) then
         call set%origins%warning(findings, 'ALLOC', '', 'no tolerances are drawn; psalm lists why there are none')
         return
      end if
      if (allocated(case%parts)) case%parts%allotted = allotted
      call move_alloc(allotted, case%scene%allotted)
   end subroutine add_allotted

   !> The same of a sketch that is drawn in the poses of its links, whose loops are not made ready yet.
   subroutine add_allotted_by_links(set, findings, case, stop)
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(pictured_t), intent(inout) :: case
      type(stop_t), intent(in), optional :: stop
      class(prepared_t), allocatable :: prepared  ! large: it would fill a small stack
      type(diagnostics_t) :: noted
      type(line_t) :: none(0)

      allocate (prepared)
      noted%file = set%file
      call prepare(set, none, prepared, noted, need)
      call findings%append(noted)
      if (prepared%ready) call add_allotted(set, prepared, findings, case, stop)
   end subroutine add_allotted_by_links

   !> True of a sketch whose links are to be drawn with all their joints: laid flat, or with widths.
   pure logical function draws_links(set, dxf)
      type(data_set_t), intent(in) :: set
      type(dxf_group_t), intent(in) :: dxf

      draws_links = set%is_drawn() .and. (dxf%flat .or. dxf%width > 0.0_wp .or. set%gives('PLATES'))
   end function draws_links

   !> Numbers of evenly chosen positions, as many as a picture can show, and of those of the least and the greatest input, which
   !> are the range.
   function positions_drawn(set, findings) result(kept)
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings  !! gets the remark that not all are drawn
      integer, allocatable :: kept(:)
      logical, allocatable :: keeps(:)
      integer :: step, i

      step = (set%method%ndes - 1)/most_drawn + 1
      allocate (keeps(set%method%ndes), source=.false.)
      keeps(1::step) = .true.
      keeps(minloc(set%method%delt, dim=1)) = .true.
      keeps(maxloc(set%method%delt, dim=1)) = .true.
      kept = pack([(i, i=1, set%method%ndes)], keeps)
      call set%origins%warning(findings, 'METHOD', 'NDES', 'of '//to_text(set%method%ndes)//' positions '// &
                               to_text(size(kept))//' are drawn, one in '//to_text(step)//', and numbered so on the '// &
                               'pictures', 1)
   end function positions_drawn

   !> Violations at positions of which not all are drawn.
   subroutine look_at_all_positions(set, prepared, words)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(strings_t), allocatable, intent(inout) :: words(:)
      class(problem_t), allocatable :: problem    ! large: it would fill a small stack
      type(motion_t) :: motion
      integer :: i

      allocate (problem)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call problem%analyse(prepared%given, motion)
      do i = 1, min(size(motion%violations), most_reported)
         call add_string(words, describe_violation(problem, motion%input, motion%violations(i)))
      end do
   end subroutine look_at_all_positions
end module psalm_picture_study
