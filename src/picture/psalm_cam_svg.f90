!> A cam as SVG: profile, pitch curve, cutter path, roller and shaft at cam angle 0; below it output, velocity, acceleration, jerk,
!> pressure angle and curvature of the profile over the turn.
module psalm_cam_svg
   use psalm_cam_study, only: cam_study_t, role_cam
   use psalm_kinds, only: wp, full_turn
   use psalm_markup, only: xml_text, short_number
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: write_cam_svg

   real(wp), parameter :: width = 760.0_wp, picture = 560.0_wp, margin = 40.0_wp, header = 56.0_wp !! sizes, pixels
   real(wp), parameter :: panel = 110.0_wp, gap = 34.0_wp
   character(*), parameter :: names(0:3) = [character(26) :: 'output', 'output, first derivative', 'output, second derivative', &
                                            'output, third derivative']
   integer, parameter :: panels = 6, digits_for_people = 6

contains

   !> Append the picture.
   subroutine write_cam_svg(title, studies, text)
      character(*), intent(in) :: title
      type(cam_study_t), intent(in) :: studies(:)    !! the cam, and its conjugate or the outer wall of its track
      type(text_t), intent(inout) :: text
      real(wp) :: scale, reach, height
      integer :: k

      reach = 0.0_wp
      do k = 1, size(studies)
         reach = max(reach, maxval(abs(studies(k)%points%profile)), maxval(abs(studies(k)%points%cutter)))
         if (.not. studies(k)%shape%flat) reach = max(reach, maxval(abs(studies(k)%points%pitch)) + studies(k)%shape%roller)
      end do
      scale = (0.5_wp*picture - margin)/reach
      height = header + picture + real(panels, wp)*(panel + gap) + margin
      call text%add('<?xml version="1.0" encoding="UTF-8"?>')
      call text%add('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 '//px(width)//' '//px(height)//'" width="'// &
                    px(width)//'" height="'//px(height)//'" role="img" aria-labelledby="title">')
      call text%add('<title id="title">'//xml_text(trim(title))//'</title>')
      call text%add('<style>text{font:13px sans-serif;fill:#222}.head{font-size:18px}path,circle,line{fill:none;stroke:#222;'// &
                    'vector-effect:non-scaling-stroke}.profile{stroke-width:2.5}.pitch{stroke:#888;stroke-dasharray:6 4}'// &
                    '.cutter{stroke:#2a7;stroke-width:.8}.follower{stroke:#26c;stroke-width:1.5}.shaft{stroke:#c33}'// &
                    '.frame{stroke:#bbb}.paper{fill:#fff}@media(prefers-color-scheme:dark){.paper{fill:#181a1c}'// &
                    'text{fill:#ddd}path,circle,line{stroke:#ddd}.frame{stroke:#555}}</style>')
      call text%add('<rect class="paper" width="'//px(width)//'" height="'//px(height)//'"/>')
      call text%add('<text class="head" x="28" y="34">'//xml_text(trim(title))//'</text>')
      call text%add('<g transform="translate('//px(0.5_wp*width)//' '//px(header + 0.5_wp*picture)//') scale('// &
                    short_number(scale)//' '//short_number(-scale)//')">')
      do k = 1, size(studies)
         associate (points => studies(k)%points, shape => studies(k)%shape)
            if (.not. shape%flat .and. k == 1) call outline('pitch', points%pitch)
            if (studies(k)%part%role == role_cam) call outline('cutter', points%cutter)
            call outline('profile', points%profile)
            if (shape%flat) then
               call line('follower', points%pitch(1) - reach*points%tangent(1), points%pitch(1) + reach*points%tangent(1))
            else
               call circle('follower', points%pitch(1), shape%roller)
            end if
         end associate
      end do
      call line('shaft', cmplx(-0.08_wp*reach, 0.0_wp, wp), cmplx(0.08_wp*reach, 0.0_wp, wp))
      call line('shaft', cmplx(0.0_wp, -0.08_wp*reach, wp), cmplx(0.0_wp, 0.08_wp*reach, wp))
      call text%add('</g>')
      associate (study => studies(1))
         do k = 0, 3
            call curve(k + 1, trim(names(k)), study%states%y(k, :))
         end do
         call curve(5, 'pressure angle, degrees', study%points%pressure)
         call curve(6, 'curvature of the profile', 1.0_wp/study%points%radius)
      end associate
      call text%add('</svg>')

   contains

      pure function px(value) result(number)
         real(wp), intent(in) :: value
         character(:), allocatable :: number

         number = short_number(value, digits_for_people)
      end function px

      pure function pair(point) result(numbers)
         complex(wp), intent(in) :: point
         character(:), allocatable :: numbers

         numbers = short_number(real(point, wp))//' '//short_number(aimag(point))
      end function pair

      !> A closed curve through the points of the table.
      subroutine outline(class, points)
         character(*), intent(in) :: class
         complex(wp), intent(in) :: points(:)
         integer :: i

         call text%add('<path class="'//class//'" d="M'//pair(points(1)))
         do i = 2, size(points)
            call text%add('L'//pair(points(i)))
         end do
         call text%add('Z"/>')
      end subroutine outline

      subroutine line(class, from, to)
         character(*), intent(in) :: class
         complex(wp), intent(in) :: from, to

         call text%add('<path class="'//class//'" d="M'//pair(from)//'L'//pair(to)//'"/>')
      end subroutine line

      subroutine circle(class, centre, radius)
         character(*), intent(in) :: class
         complex(wp), intent(in) :: centre
         real(wp), intent(in) :: radius

         call text%add('<circle class="'//class//'" cx="'//short_number(real(centre, wp))//'" cy="'// &
                       short_number(aimag(centre))//'" r="'//short_number(radius)//'"/>')
      end subroutine circle

      !> One panel: a curve over the cam angle between its least and greatest value.
      subroutine curve(number, name, values)
         integer, intent(in) :: number
         character(*), intent(in) :: name
         real(wp), intent(in) :: values(:)
         real(wp) :: low, high, span, top, x, y
         integer :: i

         low = minval(values)
         high = maxval(values)
         span = max(high - low, tiny(1.0_wp)*1.0e10_wp)
         top = header + picture + real(number - 1, wp)*(panel + gap) + gap
         call text%add('<path class="frame" d="M'//px(margin)//' '//px(top)//'H'//px(width - margin)//'V'//px(top + panel)//'H'// &
                       px(margin)//'Z"/>')
         call text%add('<text x="'//px(margin)//'" y="'//px(top - 6.0_wp)//'">'//name//': '//px(low)//' to '//px(high)//'</text>')
         call text%add('<path class="follower" d="')
         do i = 1, size(values)
            x = margin + (width - 2.0_wp*margin)*studies(1)%angle(i)/full_turn
            y = top + panel*(high - values(i))/span
            call text%add(merge('M', 'L', i == 1)//px(x)//' '//px(y))
         end do
         call text%add('"/>')
      end subroutine curve
   end subroutine write_cam_svg
end module psalm_cam_svg
