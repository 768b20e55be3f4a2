!> The path of the cutter's centre as G-code: arcs and lines in axes of the cam, one turn.
module psalm_cam_code
   use psalm_arc_path, only: circle_arc_t
   use psalm_cam_paths, only: path_cutter
   use psalm_cam_study, only: cam_study_t
   use psalm_kinds, only: wp
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: write_cam_code

   integer, parameter :: decimals = 6

contains

   !> Append the program, if there is a path. I and J lead from the start of an arc to its centre.
   subroutine write_cam_code(title, study, text)
      character(*), intent(in) :: title
      type(cam_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      complex(wp) :: to_centre
      integer :: i

      associate (path => study%paths(path_cutter))
         if (.not. path%found) return
         call text%add('%')
         call text%add('('//in_brackets(title)//')')
         call text%add('(cutter radius '//number(study%shape%cutter)//', largest deviation '//number(path%deviation)//')')
         call text%add('G90 G17')
         call text%add('G0 X'//number(real(path%arcs(1)%start, wp))//' Y'//number(aimag(path%arcs(1)%start)))
         do i = 1, size(path%arcs)
            associate (arc => path%arcs(i))
               if (abs(arc%bend) > 0.0_wp) then
                  to_centre = (0.0_wp, 1.0_wp)*arc%tangent/arc%bend
                  call text%add(merge('G3', 'G2', arc%bend > 0.0_wp)//target_of(arc)//' I'//number(real(to_centre, wp))//' J'// &
                                number(aimag(to_centre)))
               else
                  call text%add('G1'//target_of(arc))
               end if
            end associate
         end do
         call text%add('M2')
         call text%add('%')
      end associate
   end subroutine write_cam_code

   pure function target_of(arc) result(words)
      type(circle_arc_t), intent(in) :: arc
      character(:), allocatable :: words

      words = ' X'//number(real(arc%finish, wp))//' Y'//number(aimag(arc%finish))
   end function target_of

   !> A comment ends at a bracket.
   pure function in_brackets(title) result(text)
      character(*), intent(in) :: title
      character(len_trim(title)) :: text
      integer :: i

      text = title
      do i = 1, len(text)
         if (index('()%', text(i:i)) > 0 .or. iachar(text(i:i)) < 32 .or. iachar(text(i:i)) > 126) text(i:i) = ' '
      end do
   end function in_brackets

   !> A number with a fixed number of decimals, as controls read them.
   pure function number(value) result(text)
      real(wp), intent(in) :: value
      character(:), allocatable :: text
      character(40) :: buffer
      character(12) :: layout

      write (layout, '("(f40.",i0,")")') decimals
      write (buffer, layout) value
      text = trim(adjustl(buffer))
      if (text(1:1) == '.') text = '0'//text
      if (text(1:min(2, len(text))) == '-.') text = '-0'//text(2:)
   end function number
end module psalm_cam_code
