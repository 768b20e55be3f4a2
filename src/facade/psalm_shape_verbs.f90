!> Verbs whose results are shapes and pictures: cams, drawings, the moving page, the drawing board.
module psalm_shape_verbs
   use psalm_board, only: write_board
   use psalm_cam_code, only: write_cam_code
   use psalm_cam_data, only: cam_group_t
   use psalm_cam_dxf, only: write_cam_dxf
   use psalm_cam_group, only: cams_of
   use psalm_cam_page, only: write_cam_page
   use psalm_cam_report, only: report_cam, report_cam_search => report_search
   use psalm_cam_scene, only: cam_scene_t, make_cam_scene
   use psalm_cam_search, only: cam_search_t, search_cam
   use psalm_cam_study, only: cam_study_t, cam_role_t, check_cam, find_cam, parts_of
   use psalm_cam_svg, only: write_cam_svg
   use psalm_case, only: case_t
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: drawing_t
   use psalm_drawing, only: picture_t, draw_file
   use psalm_picture_report, only: report_picture
   use psalm_picture_study, only: make_scenes
   use psalm_pictured, only: pictured_t
   use psalm_source, only: line_t, split_lines
   use psalm_status, only: findings_t => diagnostics_t
   use psalm_stop, only: stop_t, is_to_end
   use psalm_study_frame, only: frame_t, report_t, need_of_rates
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: cams_t, find_cams, draw, make_board

   !> Cams: the first, and its conjugate or the outer wall of its track, or the second one.
   type :: cams_t
      type(cam_study_t), allocatable :: parts(:)
      type(cam_search_t), allocatable :: search    !! what a search for radii and pivots changed
   end type cams_t

contains

   !> The cam that makes the output follow a law, the group CAM.
   subroutine find_cams(case, cams, findings, report, stop)
      type(case_t), intent(in) :: case
      type(cams_t), intent(out) :: cams                   !! empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report     !! tables: profiles; files: .dxf, .svg, .html, with KGCODE .nc
      type(stop_t), intent(in), optional :: stop          !! by which the host can end it; of a search the best cam so far is there
      type(frame_t) :: frame
      type(cam_group_t), allocatable :: groups(:)
      type(cam_role_t), allocatable :: roles(:)
      type(cam_scene_t), allocatable :: scene
      type(text_t) :: drawing, picture, page, code
      integer :: k

      allocate (cams%parts(0))
      call frame%begin(case, findings, report, need=need_of_rates, reader='calm')
      if (.not. frame%ready) return
      groups = cams_of(frame%set)
      call check_cam(frame%set, groups, frame%prepared, frame%noted)
      if (frame%fails(findings)) return
      roles = parts_of(groups)
      if (size(groups(1)%variations) > 0) then
         allocate (cams%search)
         call search_cam(frame%set, groups, frame%prepared, cams%search, stop)
         if (is_to_end(stop)) call frame%devices%note_violation()
         call report_cam_search(frame%set, groups(1), cams%search, frame%devices)
      end if
      deallocate (cams%parts)
      allocate (cams%parts(size(roles)))
      do k = 1, size(roles)
         if (.not. allocated(cams%search) .and. is_to_end(stop)) then
            deallocate (cams%parts)
            allocate (cams%parts(0))
            call frame%end_early(report, findings)
            return
         end if
         call find_cam(frame%set, groups, frame%prepared, roles(k), cams%parts(k))
      end do
      if (.not. present(report)) return
      call report_cam(frame%set, groups(1), cams%parts, frame%devices)
      allocate (scene)
      call make_cam_scene(frame%set, frame%prepared, cams%parts, scene)
      call write_cam_dxf(cams%parts, scene%linkage, drawing)
      call frame%devices%add_drawing('.dxf', drawing%content())
      call write_cam_svg(frame%set%title, cams%parts, scene, picture)
      call frame%devices%add_drawing('.svg', picture%content())
      call write_cam_page(frame%set%title, cams%parts, scene, page)
      call frame%devices%add_drawing('.html', page%content())
      if (groups(1)%code) then
         do k = 1, size(cams%parts)
            call write_cam_code(frame%set%title, cams%parts(k), code)
         end do
         call frame%devices%add_drawing('.nc', code%content())
      end if
      call frame%conclude(report, findings)
   end subroutine find_cams

   !> Pictures of a case as given: .svg, .dxf, with FLAT of the group DXF .flat.dxf, and .html, the moving page.
   subroutine draw(case, files, findings, report, stop)
      type(case_t), intent(in) :: case
      type(drawing_t), allocatable, intent(out) :: files(:) !! ending and content; empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report
      type(stop_t), intent(in), optional :: stop            !! by which the host can end it; then there are no pictures
      type(frame_t) :: frame
      type(data_set_t), allocatable :: sets(:)
      type(pictured_t), allocatable :: cases(:)
      type(picture_t), allocatable :: pictures(:)
      integer :: k

      allocate (files(0))
      call frame%read(case, findings, report, reader='balm')
      if (.not. frame%ready) return
      allocate (sets(1))
      select type (set => frame%set)
      type is (data_set_t)
         sets(1) = set
      end select
      call make_scenes(sets, frame%noted, cases, stop)
      if (frame%fails(findings)) return
      if (is_to_end(stop)) then
         call frame%end_early(report, findings)
         return
      end if
      call report_picture(sets(1), cases(1), frame%devices)
      call draw_file(cases, .false., .true., '', pictures)
      do k = 1, size(pictures)
         call frame%devices%add_drawing(trim(pictures(k)%ending), pictures(k)%content)
      end do
      if (allocated(frame%devices%drawings)) files = frame%devices%drawings
      call frame%conclude(report, findings)
   end subroutine draw

   !> The drawing board with the sketch of a case: .edit.html.
   subroutine make_board(case, files, findings, report)
      type(case_t), intent(in) :: case
      type(drawing_t), allocatable, intent(out) :: files(:) !! ending and content; empty if the case has errors
      type(findings_t), intent(inout) :: findings
      type(report_t), intent(out), optional :: report
      type(frame_t) :: frame
      type(line_t), allocatable :: lines(:)
      type(text_t) :: page

      allocate (files(0))
      call frame%read(case, findings, report, reader='balm')
      if (.not. frame%ready) return
      if (.not. frame%set%is_drawn()) call frame%noted%error( &
         'the drawing board takes sketches (&CHAIN), but this linkage is described by its loops (&LINKS)', &
         line=frame%set%title_line)
      if (frame%fails(findings)) return
      call split_lines(case%text(), lines)
      call write_board('Drawing board', 'sketch.nml', lines, page)
      call frame%devices%add_drawing('.edit.html', page%content())
      files = frame%devices%drawings
      call frame%conclude(report, findings)
   end subroutine make_board
end module psalm_shape_verbs
