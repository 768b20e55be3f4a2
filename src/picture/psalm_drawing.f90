!> Scenes become files: SVG, moving SVG and DXF of each case, curves, one page of all.
module psalm_drawing
   use psalm_allocation_svg, only: write_allocation_svg
   use psalm_animation, only: write_animation
   use psalm_curves, only: make_curves
   use psalm_data_set, only: data_set_t
   use psalm_dxf, only: write_dxf, write_flat_dxf
   use psalm_page, only: write_page
   use psalm_pictured, only: pictured_t
   use psalm_plot, only: plot_t
   use psalm_plot_svg, only: write_plots
   use psalm_pole_svg, only: write_pole_svg
   use psalm_scene, only: scene_t
   use psalm_source, only: line_t
   use psalm_steady_curves, only: make_steady_curves
   use psalm_steady_study, only: steady_study_t
   use psalm_svg, only: write_svg
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: picture_t, add_picture, draw_file, draw_curves, draw_phase, draw_steady, ending

   integer, parameter :: ending_width = 24 !! room for a number and a suffix

   !> A file to write.
   type :: picture_t
      character(ending_width) :: ending = '' !! of the name, after that of the case
      character(:), allocatable :: content
   end type picture_t

contains

   !> Pictures of a file: SVG and DXF of each case, one page of all.
   subroutine draw_file(cases, assemblies, animate, mark, pictures)
      type(pictured_t), intent(in) :: cases(:)
      logical, intent(in) :: assemblies        !! the SVG shows the other assembly of each pair
      logical, intent(in) :: animate           !! an SVG that moves, too
      character(*), intent(in) :: mark         !! of the run
      type(picture_t), allocatable, intent(out) :: pictures(:)
      type(text_t) :: text
      type(scene_t), allocatable :: scenes(:)
      integer, allocatable :: linkages(:)
      integer :: k, i, n

      allocate (pictures(0))
      if (size(cases) == 0) return
      do k = 1, size(cases)
         if (allocated(cases(k)%poles)) then
            call write_pole_svg(cases(k)%poles, text)
         else
            call write_svg(cases(k)%scene, assemblies, text)
         end if
         call add_comment()
         call put(ending(k, '.svg'))
         if (.not. cases(k)%scene%valid) cycle
         if (allocated(cases(k)%scene%allotted)) then
            call write_allocation_svg(cases(k)%scene%title, cases(k)%scene%allotted, text)
            call add_comment()
            call put(ending(k, '.tolerances.svg'))
         end if
         if (animate .and. .not. allocated(cases(k)%poles)) then
            call write_animation(cases(k)%scene, text)
            call add_comment()
            call put(ending(k, '.move.svg'))
            if (allocated(cases(k)%modes)) then
               do i = 1, size(cases(k)%modes)
                  associate (one => cases(k)%modes(i))
                     if (one%equilibrium == 0) cycle
                     call write_animation(one%scene, text)
                     call add_comment()
                     call put(ending(k, '.mode-'//to_text(one%equilibrium)//'-'//to_text(one%mode)//'.svg'))
                  end associate
               end do
            end if
         end if
         if (allocated(cases(k)%parts)) then
            call draw_parts(cases(k)%parts)
         else
            call draw_parts(cases(k)%scene)
         end if
      end do
      ! four poses do not move
      linkages = pack([(k, k=1, size(cases))], [(.not. allocated(cases(k)%poles), k=1, size(cases))])
      if (size(linkages) == 0) return
      n = size(linkages)
      do k = 1, size(linkages)
         if (allocated(cases(linkages(k))%modes)) n = n + count(cases(linkages(k))%modes%equilibrium > 0)
      end do
      if (n == size(cases)) then
         call write_page(cases%scene, text)
      else
         allocate (scenes(n))
         n = 0
         do k = 1, size(linkages)
            n = n + 1
            call copy(cases(linkages(k))%scene, scenes(n))
            if (.not. allocated(cases(linkages(k))%modes)) cycle
            do i = 1, size(cases(linkages(k))%modes)
               if (cases(linkages(k))%modes(i)%equilibrium == 0) cycle
               n = n + 1
               call copy(cases(linkages(k))%modes(i)%scene, scenes(n))
            end do
         end do
         call write_page(scenes, text)
      end if
      call add_comment()
      call put('.html')

   contains

      !> Drawings for CAD.
      subroutine draw_parts(scene)
         type(scene_t), intent(in) :: scene

         call text%add('999') ! a comment of DXF
         call text%add('run '//mark)
         call write_dxf(scene, cases(k)%dxf, text)
         call put(ending(k, '.dxf'))
         if (.not. cases(k)%dxf%flat) return
         call text%add('999')
         call text%add('run '//mark)
         call write_flat_dxf(scene, cases(k)%dxf, text)
         call put(ending(k, '.flat.dxf'))
      end subroutine draw_parts

      subroutine add_comment()

         call text%add('<!-- run '//mark//' -->')
      end subroutine add_comment

      subroutine put(name)
         character(*), intent(in) :: name

         call add_picture(pictures, name, text%content())
         text = text_t()
      end subroutine put
   end subroutine draw_file

   !> A procedure of its own: what copies a scene is long, and is there once.
   subroutine copy(scene, other)
      type(scene_t), intent(in) :: scene
      type(scene_t), intent(inout) :: other

      other = scene
   end subroutine copy

   !> Curves of each valid case.
   subroutine draw_curves(cases, progress, mark, pictures)
      type(pictured_t), intent(in) :: cases(:)
      type(line_t), intent(in) :: progress(:)   !! device 1, empty if there is none; of the first case
      character(*), intent(in) :: mark          !! of the run
      type(picture_t), allocatable, intent(inout) :: pictures(:)
      type(line_t) :: none(0)
      type(plot_t), allocatable :: plots(:)
      integer :: k

      do k = 1, size(cases)
         if (.not. cases(k)%scene%valid) cycle
         if (k == 1) then
            call make_curves(cases(k)%scene, progress, plots)
         else
            call make_curves(cases(k)%scene, none, plots)
         end if
         call add_plots(cases(k)%scene%title, plots, k, '.curves.svg', mark, pictures)
      end do
   end subroutine draw_curves

   !> Phase planes of each case that has a motion in time with free drives.
   subroutine draw_phase(cases, mark, pictures, drawn)
      type(pictured_t), intent(in) :: cases(:)
      character(*), intent(in) :: mark          !! of the run
      type(picture_t), allocatable, intent(inout) :: pictures(:)
      logical, intent(out) :: drawn             !! there is such a case
      integer :: k

      drawn = .false.
      do k = 1, size(cases)
         if (.not. allocated(cases(k)%phase)) cycle
         if (size(cases(k)%phase) == 0) cycle
         call add_plots(cases(k)%scene%title, cases(k)%phase, k, '.phase.svg', mark, pictures)
         drawn = .true.
      end do
   end subroutine draw_phase

   !> Add the curves of what ssics found in case k of a file; nothing if there is nothing to draw.
   subroutine draw_steady(set, study, k, mark, pictures)
      type(data_set_t), intent(in) :: set
      type(steady_study_t), intent(in) :: study
      integer, intent(in) :: k
      character(*), intent(in) :: mark          !! of the run
      type(picture_t), allocatable, intent(inout) :: pictures(:)
      type(plot_t), allocatable :: plots(:)

      call make_steady_curves(set, study, plots)
      if (size(plots) > 0) call add_plots(set%title, plots, k, '.curves.svg', mark, pictures)
   end subroutine draw_steady

   subroutine add_plots(title, plots, k, suffix, mark, pictures)
      character(*), intent(in) :: title, suffix, mark
      type(plot_t), intent(in) :: plots(:)
      integer, intent(in) :: k
      type(picture_t), allocatable, intent(inout) :: pictures(:)
      type(text_t) :: text

      call write_plots(title, plots, text)
      call text%add('<!-- run '//mark//' -->')
      call add_picture(pictures, ending(k, suffix), text%content())
   end subroutine add_plots

   pure subroutine add_picture(pictures, ending, content)
      type(picture_t), allocatable, intent(inout) :: pictures(:)
      character(*), intent(in) :: ending, content
      type(picture_t), allocatable :: more(:)
      integer :: i, n

      n = size(pictures) + 1   ! a subscript of its own, for gfortran 11
      allocate (more(n))
      do i = 1, size(pictures)
         more(i)%ending = pictures(i)%ending
         call move_alloc(pictures(i)%content, more(i)%content)
      end do
      more(n)%ending = ending
      more(n)%content = content
      call move_alloc(more, pictures)
   end subroutine add_picture

   !> The first case has the name of the file, the others a number too.
   pure function ending(k, suffix) result(name)
      integer, intent(in) :: k
      character(*), intent(in) :: suffix
      character(:), allocatable :: name

      name = suffix
      if (k > 1) name = '.'//to_text(k)//suffix
   end function ending
end module psalm_drawing
