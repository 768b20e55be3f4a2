!> Curves of a sketch that has no loops of dyads, in a gnuplot script: every output, and the drives where there are several.
module psalm_chain_curves
   use psalm_kinds, only: wp, full_turn
   use psalm_markup, only: gnuplot_text
   use psalm_panel_curves, only: axis_range
   use psalm_scene, only: scene_t
   use psalm_text, only: text_t, full_precision, number_or_nan, to_text
   implicit none (type, external)
   private
   public :: chain_panels, write_chain_tables, plot_chain_panels

contains

   !> How many panels there are.
   pure integer function chain_panels(scene) result(panels)
      type(scene_t), intent(in) :: scene

      panels = size(scene%curves) + merge(1, 0, size(scene%drives) > 1)
   end function chain_panels

   !> Append the data: input, then every output, then every drive.
   subroutine write_chain_tables(scene, positions, way, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: positions(:), way(:)   !! places of both rows on the axis
      type(text_t), intent(inout) :: text
      integer :: i, k

      call text%add('$positions << END')
      do i = 1, scene%prescribed%n
         call add_row(positions(i), scene%prescribed%closed(i), &
                      [(scene%curves(k)%prescribed(i), k=1, size(scene%curves))], &
                      [(scene%drives(k)%prescribed(i), k=1, size(scene%drives))])
      end do
      call text%add('END')
      call text%add('$way << END')
      do i = 1, scene%sweep%n
         call add_row(way(i), scene%sweep%closed(i), [(scene%curves(k)%sweep(i), k=1, size(scene%curves))], &
                      [(scene%drives(k)%sweep(i), k=1, size(scene%drives))])
      end do
      call text%add('END')

   contains

      subroutine add_row(input, closed, outputs, drives)
         real(wp), intent(in) :: input, outputs(:), drives(:)
         logical, intent(in) :: closed
         character(:), allocatable :: line
         integer :: k

         line = full_precision(input)
         do k = 1, size(outputs)
            line = line//' '//number_or_nan(outputs(k), closed .and. outputs(k) < huge(1.0_wp))
         end do
         do k = 1, size(drives)
            line = line//' '//full_precision(drives(k))
         end do
         call text%add(line)
      end subroutine add_row
   end subroutine write_chain_tables

   !> Append the panels.
   subroutine plot_chain_panels(scene, text)
      type(scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      logical, allocatable :: known(:)
      integer :: k

      if (.not. any(scene%sweep%closed)) call text%add("set label 1 'the linkage does not close' at graph 0.5,0.5 center front")
      do k = 1, size(scene%curves)
         ! gnuplot refuses a panel without a single number
         line = 'set yrange [0:1]; '
         known = scene%sweep%closed .and. scene%curves(k)%sweep < huge(1.0_wp)
         if (any(known)) line = axis_range(pack(scene%curves(k)%sweep, known), &
                                                        merge(full_turn, maxval(scene%high - scene%low), scene%curves(k)%angle))
         call text%add('set ylabel '//gnuplot_text(scene%curves(k)%name)//'; '//line//'plot $way using 1:'//to_text(k + 1)// &
                       ' with lines lw 1.5 notitle, $positions using 1:'//to_text(k + 1)//' with points pt 7 ps 0.5 lc 1 notitle')
      end do
      call text%add('unset label 1; set yrange [*:*]')
      if (size(scene%drives) < 2) return
      line = 'set ylabel "drives, from the drawing"; plot '
      do k = 1, size(scene%drives)
         if (k > 1) line = line//', '
         line = line//'$way using 1:'//to_text(1 + size(scene%curves) + k)//' with lines lw 1.5 title '// &
                gnuplot_text(scene%drives(k)%name)
      end do
      call text%add(line)
   end subroutine plot_chain_panels
end module psalm_chain_curves
