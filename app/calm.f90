!> calm: cams that drive planar linkages, from a namelist file.
program calm
   use psalm_batch, only: csv_always, outputs_t, common_options, json_option, run_files, ending_of_case
   use psalm_cam_code, only: write_cam_code
   use psalm_cam_dxf, only: write_cam_dxf
   use psalm_cam_data, only: cam_group_t
   use psalm_cam_group, only: cams_of
   use psalm_cam_page, only: write_cam_page
   use psalm_cam_report, only: report_cam, report_search
   use psalm_cam_scene, only: cam_scene_t, make_cam_scene
   use psalm_cam_search, only: cam_search_t, search_cam
   use psalm_cam_svg, only: write_cam_svg
   use psalm_cam_study, only: cam_study_t, cam_role_t, check_cam, find_cam, parts_of
   use psalm_check_list, only: list_input
   use psalm_console, only: arguments_t, begin
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t, header_of
   use psalm_error, only: problem_t, make_problem
   use psalm_mark, only: mark_t
   use psalm_preparation, only: memory_need_t, prepared_t, prepare
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_system, only: finish_program
   use psalm_text, only: text_t
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   type(memory_need_t), parameter :: need = memory_need_t(position=1000, arc=400)
   ! saved: procedures that are handed on then need no code on the stack
   type(outputs_t), save :: outputs
   type(arguments_t), save :: arguments
   logical, save :: finished
   integer, save :: code

   outputs = outputs_t(suffix='.calm', endings=['.dev8', '.dev9'], of_search=[character(5) ::], &
                       of_case=['.dxf ', '.svg ', '.html', '.nc  '], csv=csv_always)
   call begin('calm', &
      'usage: calm [options] [CASE.nml ...]'//nl// &
      nl//'The cam that makes the output of a linkage follow a law (&CAM): the linkage solved backwards, profile, cutter'//nl// &
      'path, curvature, pressure angle; what the roller, the cutter or a flat face cannot follow.'//nl// &
      nl//'The listing goes to standard output; CASE.calm.dev8 (input), CASE.calm.dev9 and CASE.calm.csv (tables),'//nl// &
      'CASE.calm.dxf and CASE.calm.svg (drawings), CASE.calm.html (a page on which the cam turns) and with KGCODE=1'//nl// &
      'CASE.calm.nc (G-code of the cutter path) in the folder of the case.'//nl// &
      nl//json_option// &
      common_options// &
      nl//'Exit status: 0 done; 1 done, but the cam cannot be followed or made, or a limit is not kept;'//nl// &
      '2 the input is wrong; 3 a file could not be read or written.'//nl, &
      outputs%suffix//[character(5) :: outputs%endings, '.csv'], arguments, finished)
   code = arguments%code
   if (finished) call finish_program(code)
   call run_files(arguments, outputs, prepare_cam, run_case, code)
   call finish_program(code)

contains

   subroutine prepare_cam(file, set, prepared, findings, mark)
      character(*), intent(in) :: file
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(inout) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      type(mark_t), intent(inout) :: mark
      type(line_t) :: none(0)

      associate (unused => file, also_unused => mark)
      end associate
      if (.not. findings%failed()) call prepare(set, none, prepared, findings, need)
      if (.not. findings%failed()) call check_cam(set, cams_of(set), prepared, findings)
   end subroutine prepare_cam

   subroutine run_case(number, set, given_prepared, devices, stopped)
      integer, intent(in) :: number
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: given_prepared
      type(devices_t), intent(inout) :: devices
      logical, intent(inout) :: stopped
      ! large: they would fill a small stack
      class(problem_t), allocatable :: problem
      class(prepared_t), allocatable :: prepared
      class(cam_search_t), allocatable :: search
      type(cam_study_t), allocatable :: studies(:)
      type(cam_scene_t), allocatable :: scene
      type(text_t) :: drawing, picture, page, program
      type(cam_role_t), allocatable :: parts(:)
      type(cam_group_t), allocatable :: cams(:)
      integer :: k

      associate (unused => stopped)
      end associate
      allocate (prepared, source=given_prepared)
      cams = cams_of(set)
      parts = parts_of(cams)
      allocate (problem, search)
      call grow(size(parts), studies)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call list_input(header_of('CALM', devices%mark), set, problem, devices%eight)
      if (size(cams(1)%variations) > 0) then
         call search_cam(set, cams, prepared, search)
         call report_search(set, cams(1), search, devices)
      end if
      do k = 1, size(parts)
         call find_cam(set, cams, prepared, parts(k), studies(k))
      end do
      call report_cam(set, cams(1), studies, devices)
      allocate (scene)
      call make_cam_scene(set, prepared, studies, scene)
      call write_cam_dxf(studies, scene%linkage, drawing)
      call devices%add_drawing(trim(ending_of_case(number, '.dxf')), drawing%content())
      call write_cam_svg(set%title, studies, scene, picture)
      call devices%add_drawing(trim(ending_of_case(number, '.svg')), picture%content())
      call write_cam_page(set%title, studies, scene, page)
      call devices%add_drawing(trim(ending_of_case(number, '.html')), page%content())
      if (.not. cams(1)%code) return
      do k = 1, size(studies)
         call write_cam_code(set%title, studies(k), program)
      end do
      call devices%add_drawing(trim(ending_of_case(number, '.nc')), program%content())
   end subroutine run_case

   !> Studies as they are by default. A procedure of its own: what this puts on the stack is gone when the work begins.
   subroutine grow(count, studies)
      integer, intent(in) :: count
      type(cam_study_t), allocatable, intent(out) :: studies(:)

      allocate (studies(count))
   end subroutine grow
end program calm
