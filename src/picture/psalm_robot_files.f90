!> Models of the bodies of a mechanism for other programs, as files.
module psalm_robot_files
   use psalm_data_set, only: data_set_t
   use psalm_drawing, only: picture_t, add_picture, ending
   use psalm_freecad, only: write_freecad
   use psalm_kinds, only: wp
   use psalm_mjcf, only: write_mjcf
   use psalm_multibody, only: multibody_t, make_multibody
   use psalm_pictured, only: pictured_t
   use psalm_robot_formats, only: robot_formats_t
   use psalm_sdf, only: write_joint_series, write_sdf, write_urdf
   use psalm_status, only: diagnostics_t
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: draw_models

contains

   !> Models of all cases of a file that can be drawn.
   subroutine draw_models(sets, cases, formats, mark, findings, models)
      type(data_set_t), intent(in) :: sets(:)
      type(pictured_t), intent(in) :: cases(:)
      type(robot_formats_t), intent(in) :: formats
      character(*), intent(in) :: mark               !! of the run
      type(diagnostics_t), intent(inout) :: findings
      type(picture_t), allocatable, intent(out) :: models(:)
      class(multibody_t), allocatable :: model
      type(diagnostics_t) :: own
      type(text_t) :: text
      integer :: k

      allocate (models(0))
      do k = 1, size(cases)
         if (.not. cases(k)%scene%valid) cycle
         if (allocated(model)) deallocate (model)
         allocate (model)
         own = diagnostics_t()
         own%file = sets(k)%file
         call make_multibody(sets(k), model, own, formats%urdf, &
                             shapes_alone=.not. (formats%mjcf .or. formats%sdf .or. formats%urdf))
         if (.not. own%failed()) then
            if (formats%mjcf) then
               call begin()
               call write_mjcf(model, text)
               call add_picture(models, ending(k, '.mjcf.xml'), text%content())
            end if
            if (formats%freecad) then
               if (any(model%bodies%thickness > 0.0_wp)) then
                  text = text_t()
                  call text%add('# run '//mark)
                  call write_freecad(model, text)
                  call add_picture(models, ending(k, '.freecad.py'), text%content())
               else
                  call own%error('no link is a plate, so there are no solids for FreeCAD: give the group &PLATES', &
                                 line=sets(k)%title_line)
               end if
            end if
            if (formats%sdf) then
               call begin()
               call write_sdf(model, sets(k)%title_line, text, own)
               call add_picture(models, ending(k, '.sdf'), text%content())
            end if
            if (formats%urdf) then
               call begin()
               call write_urdf(model, sets(k)%title_line, text, own)
               call add_picture(models, ending(k, '.urdf'), text%content())
               if (allocated(model%dependence)) then
                  text = text_t()
                  call write_joint_series(model, mark, text)
                  call add_picture(models, ending(k, '.urdf.json'), text%content())
               end if
            end if
         end if
         call findings%append(own)
      end do

   contains

      !> A text whose first line has the mark of the run.
      subroutine begin()

         text = text_t()
         call text%add('<!-- run '//mark//' -->')
      end subroutine begin
   end subroutine draw_models
end module psalm_robot_files
