!> Cams as one self-contained HTML page: the page's text is part of the program, the scene goes into it as JSON.
module psalm_cam_page
   use psalm_cam_profile, only: in_machine
   use psalm_cam_page_text, only: cam_page_text
   use psalm_cam_scene, only: cam_scene_t, cam_part_t
   use psalm_cam_shape, only: cam_extreme_t, measure_base, measure_outer, measure_pressure, measure_convex, measure_concave
   use psalm_cam_study, only: cam_study_t, role_cam, role_conjugate
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_json, only: add_numbers, comma, json_integers, json_number, json_text, truth
   use psalm_markup, only: xml_text
   use psalm_shared_text, only: title_mark, data_mark
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: write_cam_page

   integer, parameter :: cam_format = 3          !! of the data; web/cam.js expects the same
   integer, parameter :: digits_shown = 7

contains

   !> Append the page of a case.
   subroutine write_cam_page(title, studies, scene, text)
      character(*), intent(in) :: title
      type(cam_study_t), intent(in) :: studies(:)
      type(cam_scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      character(:), allocatable :: page
      integer :: head, place, k

      page = cam_page_text()
      head = index(page, title_mark)
      place = index(page, data_mark)
      call text%add_text(page(:head - 1)//'<title>'//xml_text(trim(title))//'</title>'//page(head + len(title_mark):place - 1))
      call text%add_text('<script type="application/json" id="data">{"format":'//to_text(cam_format)//',"title":'// &
                         json_text(trim(title))//',"view":['//number(scene%low%re)//','//number(scene%low%im)//','// &
                         number(scene%high%re)//','//number(scene%high%im)//'],')
      call add_row('angle', scene%angle, text)
      call add_linkage(scene, text)
      call text%add(',"cams":[')
      do k = 1, size(studies)
         call add_cam(studies(k), scene%parts(k), k > 1, text)
      end do
      call text%add_text(']}</script>'//page(place + len(data_mark):))
   end subroutine write_cam_page

   !> Joints, bars and bodies; rows of one number where nothing moves.
   subroutine add_linkage(scene, text)
      type(cam_scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      integer :: j

      associate (linkage => scene%linkage, row => scene%linkage%prescribed)
         call text%add(',"joints":[')
         do j = 1, size(linkage%joints)
            call text%add_text(comma(j)//'{"name":'//json_text(linkage%joints(j)%name)//',"fixed":'// &
                               truth(linkage%joints(j)%fixed)//',"slides":'//truth(linkage%joints(j)%slides)//',')
            call add_row('x', row%x(j, :), text)
            call text%add_text(',')
            call add_row('y', row%y(j, :), text)
            call text%add('}')
         end do
         call text%add_text('],"bars":[')
         do j = 1, size(linkage%bars)
            associate (bar => linkage%bars(j))
               call text%add_text(comma(j)//'['//to_text(bar%start - 1)//','//to_text(bar%finish - 1)//','// &
                                  to_text(bar%body - 1)//','//to_text(bar%slide - 1)//']')
            end associate
         end do
         call text%add_text('],"bodies":[')
         do j = 1, size(linkage%bodies)
            call text%add_text(comma(j)//'{"frame":'//truth(linkage%bodies(j)%frame)//',"hull":'// &
                               json_integers(linkage%bodies(j)%hull - 1)//'}')
         end do
         call text%add_text('],"rails":[')
         do j = 1, size(linkage%slides)
            associate (slide => linkage%slides(j))
               call text%add_text(comma(j)//'{"from":'//to_text(slide%guide - 1)//',"low":'//number(slide%sense*slide%low)// &
                                  ',"high":'//number(slide%sense*slide%high)//',')
               call add_row('ux', row%ux(j, :), text)
               call text%add_text(',')
               call add_row('uy', row%uy(j, :), text)
               call text%add('}')
            end associate
         end do
         call text%add_text(']')
      end associate
   end subroutine add_linkage

   subroutine add_cam(study, part, after, text)
      type(cam_study_t), intent(in) :: study
      type(cam_part_t), intent(in) :: part
      logical, intent(in) :: after               !! another cam stands before
      type(text_t), intent(inout) :: text

      associate (shape => study%shape, states => part%states, points => part%points)
         if (after) call text%add_text(',')
         call text%add_text('{"name":"'//name_of(study)//'","drives":'//truth(study%part%role == role_cam)//',"angular":'// &
                            truth(shape%motion%angular)//',"centre":['// &
                            number(shape%axes%centre%re)//','//number(shape%axes%centre%im)//'],"turn":'// &
                            number(merge(0.0_wp, shape%axes%sense, shape%axes%slides))//',"slide":['// &
                            number(real(shape%axes%way, wp)*radians_per_degree)//','// &
                            number(aimag(shape%axes%way)*radians_per_degree)//'],"flat":'//truth(shape%flat)//',"roller":'// &
                            number(merge(0.0_wp, shape%roller, shape%flat))//',"limit":'//number(study%cam%pressure_angle)//',')
         call add_points('profile', part%profile)
         call add_points('pitch', part%pitch)
         call add_points('cutter', part%cutter)
         call add_points('follower', states%c(0, :))
         call add_points('arm', part%arm)
         call add_points('contact', in_machine(shape%axes, states%angle, points%profile, points%machine))
         if (size(part%second) > 0) then
            call text%add_text('"second":'//number(study%other%roller)//',')
            call add_points('second', part%second)
            call add_points('second_arm', part%second_arm)
         end if
         call add_points('normal', points%normal*points%machine)
         call add_row('y', states%y(0, :), text)
         call text%add_text(',')
         call add_row('y1', states%y(1, :), text)
         call text%add_text(',')
         call add_row('y2', states%y(2, :), text)
         call text%add_text(',')
         call add_row('y3', states%y(3, :), text)
         call text%add_text(',')
         call add_row('alpha', points%pressure, text)
         call text%add_text(',')
         call add_row('bend', 1.0_wp/points%radius, text)
         call text%add_text(',"facts":[')
         call add_fact(trim(merge('least height', 'base radius ', shape%axes%slides)), study%extremes(measure_base), .false.)
         call add_fact(trim(merge('greatest height', 'outer radius   ', shape%axes%slides)), study%extremes(measure_outer), .true.)
         call add_fact('largest pressure angle', study%extremes(measure_pressure), .true.)
         call add_fact('least convex radius', study%extremes(measure_convex), .true.)
         call add_fact('least hollow radius', study%extremes(measure_concave), .true.)
         call text%add_text('],"sound":'//truth(.not. study%is_violating())//'}')
      end associate

   contains

      subroutine add_points(name, values)
         character(*), intent(in) :: name
         complex(wp), intent(in) :: values(:)
         real(wp), allocatable :: one(:)

         one = values%re
         call add_row(name//'_x', one, text)
         one = values%im
         call text%add_text(',')
         call add_row(name//'_y', one, text)
         call text%add_text(',')
      end subroutine add_points

      subroutine add_fact(name, extreme, further)
         character(*), intent(in) :: name
         type(cam_extreme_t), intent(in) :: extreme
         logical, intent(in) :: further

         if (.not. extreme%found) return
         if (further) call text%add_text(',')
         call text%add_text('["'//name//'",'//number(extreme%value)//','//number(extreme%angle)//']')
      end subroutine add_fact
   end subroutine add_cam

   pure function name_of(study) result(name)
      type(cam_study_t), intent(in) :: study
      character(:), allocatable :: name

      name = 'cam'
      if (study%part%cam == 2) name = 'second cam'
      if (study%part%role == role_cam) return
      if (study%part%role == role_conjugate) then
         name = 'conjugate '//name
      else
         name = 'outer wall, '//name
      end if
   end function name_of

   !> A named row; one number where all are the same.
   subroutine add_row(name, values, text)
      character(*), intent(in) :: name
      real(wp), intent(in) :: values(:)
      type(text_t), intent(inout) :: text

      call text%add_text('"'//name//'":')
      if (maxval(values) - minval(values) <= 0.0_wp) then
         call text%add_text(number(values(1)))
      else
         call add_numbers(values, text, digits=digits_shown)
         call text%add()
      end if
   end subroutine add_row

   pure function number(value) result(digits)
      real(wp), intent(in) :: value
      character(:), allocatable :: digits

      digits = json_number(value, digits=digits_shown)
   end function number
end module psalm_cam_page
