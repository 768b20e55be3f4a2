!> Pictures of Jansen's leg: sizes of the SVG, the drawing for CAD and the moving page; and of the drawing board with its sketch.
program show_picture
   use psalm, only: case_t, drawing_t, findings_t, draw, make_board, read_file
   implicit none (type, external)
   type(case_t), allocatable :: cases(:)
   type(drawing_t), allocatable :: files(:), board(:)
   type(findings_t) :: findings
   integer :: i

   call read_file('data/jansen.nml', cases, findings)
   if (.not. findings%failed()) call draw(cases(1), files, findings)
   if (.not. findings%failed()) call make_board(cases(1), board, findings)
   do i = 1, findings%count
      print '(a)', findings%list(i)%render()
   end do
   if (findings%failed()) error stop 1
   do i = 1, size(files)
      print '(a, i0, 1x, a)', trim(files(i)%ending)//' ', len(files(i)%content), files(i)%content(:min(20, index(files(i)%content, &
                                                                                     new_line('a')) - 1))
   end do
   print '(a, i0)', trim(board(1)%ending)//' ', len(board(1)%content)
end program show_picture
