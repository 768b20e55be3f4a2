!> Results of calm become texts of the devices, remarks for standard error and the exit status. Nothing is computed here.
module psalm_cam_report
   use psalm_cam_data, only: cam_group_t, goal_names, vary_item, vary_names
   use psalm_cam_list, only: list_cam, put_cam
   use psalm_cam_search, only: cam_search_t
   use psalm_cam_shape, only: measure_pressure
   use psalm_cam_study, only: cam_study_t
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_kinds, only: wp
   use psalm_number_format, only: in_sentence
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: full_precision, lower_case, to_text
   implicit none (type, external)
   private
   public :: report_cam, report_search

contains

   !> Listing, device 9, table, remarks, exit status.
   subroutine report_cam(set, cam, studies, devices)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: cam
      type(cam_study_t), intent(in) :: studies(:)    !! the cam, and its conjugate or the outer wall of its track
      type(devices_t), intent(inout) :: devices
      integer :: k

      if (size(cam%variations) == 0) call devices%six%add(' '//set%title)
      do k = 1, size(studies)
         call list_cam(set%has_names(), studies(k), devices%six)
         if (k == 1) then
            call put_cam(studies(k), '', devices%cases(devices%last_case()))
         else
            call put_cam(studies(k), '_'//to_text(k), devices%cases(devices%last_case()))
         end if
         call remark_faults(set, studies(k), devices)
      end do
   end subroutine report_cam

   !> What a search changed, before the cam that it found.
   subroutine report_search(set, cam, search, devices)
      type(data_set_t), intent(in) :: set
      type(cam_group_t), intent(in) :: cam
      type(cam_search_t), intent(in) :: search
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: name
      logical :: named
      integer :: k

      named = set%has_names()
      call devices%six%add(' '//set%title)
      call devices%six%add()
      call devices%six%add(' SEARCH BY '//search%solver//', '//to_text(search%evaluations)//' CAMS: LEAST '// &
                           trim(goal_names(cam%goal))//in_sentence(named, search%objective_before)//' TO'// &
                           in_sentence(named, search%objective))
      do k = 1, size(search%after)
         associate (one => cam%variations(k))
            name = vary_item(one%item)
            if (one%segment > 0) name = name//' '//to_text(one%segment)
            if (one%zone > 0) name = name//' '//to_text(one%zone)
            call devices%six%add(' '//name//repeat(' ', 12 - len(name))// &
                                 in_sentence(named, search%before(k))//' TO '// &
                                 full_precision(search%after(k)))
         end associate
      end do
      call put_search(cam, search, devices%cases(devices%last_case()))
      if (search%refused) then
         call devices%note_violation()
         call devices%remark(set, 'the solver '//search%solver//' cannot search for a cam; LD_SLSQP and LN_COBYLA can')
      else if (.not. search%feasible) then
         call devices%note_violation()
         call devices%remark(set, 'the search found no cam that keeps all limits')
      end if
   end subroutine report_search

   !> Tables search and search_values, for other programs.
   pure subroutine put_search(cam, search, tables)
      type(cam_group_t), intent(in) :: cam
      type(cam_search_t), intent(in) :: search
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table

      table = table_of('search', 'one row: the search for the cam', audience=for_programs)
      call table%add('solver', [search%solver])
      call table%add('cams', [search%evaluations])
      call table%add('least', [lower_case(goal_names(cam%goal))])
      call table%add('before', [search%objective_before])
      call table%add('after', [search%objective])
      call table%add('feasible', [search%feasible])
      call table%add('refused', [search%refused])
      call tables%put(table)
      table = table_of('search_values', 'a row for each number that varies; segment and zone where it belongs to one', &
                       audience=for_programs)
      associate (of => cam%variations)
         call table%add('item', vary_names(of%item))
         call table%add('segment', of%segment, known=of%segment > 0)
         call table%add('zone', of%zone, known=of%zone > 0)
         call table%add('lowest', of%low)
         call table%add('highest', of%high)
         call table%add('before', search%before)
         call table%add('after', search%after)
      end associate
      call tables%put(table)
   end subroutine put_search

   !> What the cam cannot do.
   subroutine remark_faults(set, study, devices)
      type(data_set_t), intent(in) :: set
      type(cam_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices

      if (.not. study%is_violating()) return
      call devices%note_violation()
      if (study%undercut .and. study%shape%flat) call devices%remark(set, 'the profile would be hollow, and a flat face cannot '// &
         'follow a hollow; the least base radius is'//words(study%least_base))
      if (study%undercut .and. .not. study%shape%flat) call devices%remark(set, 'undercut: the pitch curve is sharper than the '// &
                                                                           'roller')
      if (study%roller%depth > 0.0_wp) call devices%remark(set, 'the profile crosses itself at'//words(study%roller%at)// &
         ' degrees: the roller is too large')
      if (study%gouge .or. study%cutter%depth > 0.0_wp) call devices%remark(set, 'the cutter is larger than a hollow of the '// &
                                                                            'profile')
      if (study%lost) call devices%remark(set, 'the follower leaves the cam at this speed')
      if (study%jammed) call devices%remark(set, 'friction keeps the cam from moving the follower')
      if (study%stressed) call devices%remark(set, 'the contact stress exceeds PHERTZ')
      if (study%steep) call devices%remark(set, 'the pressure angle,'//words(study%extremes(measure_pressure)%value)// &
                                           ' degrees, exceeds ALFMAX')
      if (study%sharp) call devices%remark(set, 'the radius of curvature is less than RHOMIN')
      if (study%tight) call devices%remark(set, 'the second roller does not fit: the gap is'//words(study%least_slack%value)// &
                                           ' at'//words(study%least_slack%angle)//' degrees')
      if (study%loose) call devices%remark(set, 'the second roller has a gap of'//words(study%most_slack%value)//' at'// &
                                           words(study%most_slack%angle)//' degrees, more than CLEAR')
      if (study%face_short) call devices%remark(set, 'the face is shorter than the way of the contact')

   contains

      function words(value)
         real(wp), intent(in) :: value
         character(:), allocatable :: words

         words = in_sentence(set%has_names(), value)
      end function words
   end subroutine remark_faults
end module psalm_cam_report
