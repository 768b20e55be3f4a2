!> Forces in the gnuplot script of the curves: drive, force and moment on the frame over the sweep.
module psalm_force_curves
   use psalm_elementary, only: hypotenuse
   use psalm_force_analysis, only: column_drive, column_fx, column_fy, column_moment
   use psalm_force_scene, only: force_scene_t
   use psalm_kinds, only: wp
   use psalm_panel_curves, only: axis_range
   use psalm_panel_curves, only: axis_range
   use psalm_text, only: text_t, full_precision
   implicit none (type, external)
   private
   public :: write_force_table, plot_force_panels, force_panels

   integer, parameter :: force_panels = 3

contains

   !> The table $forces: input, drive, force and moment on the frame.
   subroutine write_force_table(forces, inputs, text)
      type(force_scene_t), intent(in) :: forces
      real(wp), intent(in) :: inputs(:)       !! shape (sweep): on the axis of the curves
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: i, c

      call text%add('$forces << END')
      call text%add('# input drive frame_fx frame_fy frame_m'//trim(merge(' drive_before frame_before', repeat(' ', 26), &
                                                                          allocated(forces%bare))))
      do i = 1, size(inputs)
         line = full_precision(inputs(i))
         do c = column_drive, column_moment
            if (forces%sweep%table%known(i)) then
               line = line//' '//full_precision(forces%sweep%table%value(i, c))
            else
               line = line//' NaN'
            end if
         end do
         if (allocated(forces%bare)) then
            if (forces%bare%known(i)) then
               line = line//' '//full_precision(forces%bare%value(i, column_drive))//' '// &
                      full_precision(hypotenuse(forces%bare%value(i, column_fx), forces%bare%value(i, column_fy)))
            else
               line = line//' NaN NaN'
            end if
         end if
         call text%add(line)
      end do
      call text%add('END')
   end subroutine write_force_table

   subroutine plot_force_panels(forces, text)
      type(force_scene_t), intent(in) :: forces
      type(text_t), intent(inout) :: text
      integer, allocatable :: known(:)
      real(wp) :: largest, turning
      integer :: k

      known = [(k, k=1, size(forces%sweep%table%closed))]
      known = pack(known, [(forces%sweep%table%known(k), k=1, size(known))])
      if (size(known) == 0) return
      associate (value => forces%sweep%table%value)
         ! what the joints bear tells what is rounding
         largest = maxval(abs(forces%sweep%joint(:, known, :)))
         turning = max(maxval(abs(value(known, column_drive))), maxval(abs(value(known, column_moment))))
         if (allocated(forces%bare)) then
            ! curves of the bare linkage are on the same axes
            largest = 0.0_wp
            turning = 0.0_wp
         end if
         if (forces%sliding) then
            call text%add("set ylabel 'force of the drive, N'; "//axis_range(value(known, column_drive), largest))
         else
            call text%add("set ylabel 'torque of the drive, N m'; "//axis_range(value(known, column_drive), turning))
         end if
      end associate
      call text%add("plot $forces using 1:2 with lines lw 2 lc rgb '#c62828' title 'drive'"//before('6'))
      call text%add("set ylabel 'force on the frame, N'; "// &
                    axis_range([forces%sweep%table%value(known, column_fx), forces%sweep%table%value(known, column_fy)], largest))
      call text%add("plot $forces using 1:3 with lines lw 2 lc rgb '#0b57d0' title 'x', $forces using 1:4 with lines lw 2 "// &
                    "lc rgb '#2e8540' title 'y', $forces using 1:(sqrt($3*$3+$4*$4)) with lines lw 1 lc rgb '#566370' "// &
                    "title 'amount'"//before('7'))
      call text%add("set ylabel 'moment on the frame, N m'; "// &
                    axis_range(forces%sweep%table%value(known, column_moment), turning))
      call text%add("plot $forces using 1:5 with lines lw 2 lc rgb '#7b3fa0' title 'moment'; set yrange [*:*]")

   contains

      !> What it was before counterweights and springs were added.
      function before(column) result(words)
         character(*), intent(in) :: column
         character(:), allocatable :: words

         words = ''
         if (allocated(forces%bare)) words = ", $forces using 1:"//column//" with lines lw 1 dt 2 lc rgb '#37424b' title 'before'"
      end function before
   end subroutine plot_force_panels
end module psalm_force_curves
