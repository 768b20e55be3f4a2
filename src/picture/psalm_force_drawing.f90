!> Forces in the SVG: counterweights, springs, centres of mass and loads on the linkage, below it a polar diagram of the load of
!> every joint.
module psalm_force_drawing
   use psalm_force_scene, only: force_scene_t, largest_load, largest_in_joint, words_of_added
   use psalm_kinds, only: wp
   use psalm_markup, only: short_number, xml_text
   use psalm_text, only: text_t, full_precision
   implicit none (type, external)
   private
   public :: draw_weights_and_springs, draw_centres_and_loads, draw_polar_diagrams, height_of_polar_diagrams

   integer, parameter :: in_a_row = 6                      !! polar diagrams
   real(wp), parameter :: cell = 150.0_wp, half = 52.0_wp  !! of a diagram and half of its square, pixels
   real(wp), parameter :: heading = 26.0_wp                !! above them, pixels
   real(wp), parameter :: longest_arrow = 110.0_wp         !! pixels
   real(wp), parameter :: arrow_head = 9.0_wp              !! pixels
   integer, parameter :: digits = 5                        !! of forces in words
   real(wp), parameter :: mass_radius = 5.5_wp             !! pixels
   real(wp), parameter :: coil = 6.0_wp                    !! half the width of a spring, pixels
   real(wp), parameter :: pin = 2.6_wp                     !! radius of what holds a spring, pixels
   integer, parameter :: coils = 8                         !! that are drawn of a spring
   real(wp), parameter :: hook = 0.14_wp                   !! straight part of a spring at either end, of its length
   real(wp), parameter :: spiral = 9.0_wp                  !! outer radius of a torsional spring, pixels
   integer, parameter :: spiral_steps = 40                 !! of two and a half turns
   real(wp), parameter :: pi = acos(-1.0_wp)

contains

   !> Counterweights as discs to scale, springs between their ends, at one prescribed position, in machine coordinates.
   subroutine draw_weights_and_springs(forces, position, k, text)
      type(force_scene_t), intent(in) :: forces
      integer, intent(in) :: position
      real(wp), intent(in) :: k                            !! pixels per unit of length
      type(text_t), intent(inout) :: text
      integer :: j, e

      if (.not. forces%prescribed%table%known(position)) return
      if (size(forces%radius) > 0) call text%add('<g id="weights" stroke-width="'//short_number(1.2_wp/k)//'">')
      do j = 1, size(forces%radius)
         associate (at => forces%prescribed%weight_at(:, position, j))
            call text%add('<circle class="weight" cx="'//full_precision(at(1))//'" cy="'//full_precision(at(2))//'" r="'// &
                          full_precision(forces%radius(j))//'"/>')
         end associate
      end do
      if (size(forces%radius) > 0) call text%add('</g>')
      if (size(forces%torsional) == 0) return
      call text%add('<g id="springs" stroke-width="'//short_number(1.8_wp/k)//'">')
      do j = 1, size(forces%torsional)
         associate (ends => forces%prescribed%spring_at(:, position, :, j), &
                    feet => forces%prescribed%spring_foot(:, position, :, j))
            if (forces%torsional(j)) then
               call text%add('<path class="spring" d="'//spiral_path(ends(:, 1), spiral/k)//'"/>')
            else
               call text%add('<path class="spring" d="'//coil_path(ends(:, 1), ends(:, 2), coil/k)//'"/>')
               do e = 1, 2
                  call draw_end(ends(:, e), feet(:, e), forces%on_frame(e, j))
               end do
            end if
         end associate
      end do
      call text%add('</g>')

   contains

      !> A pin, on the frame with a triangle below it, else with a thin line to the link that holds it.
      subroutine draw_end(at, foot, on_frame)
         real(wp), intent(in) :: at(2), foot(2)
         logical, intent(in) :: on_frame

         if (on_frame) then
            call text%add('<path class="spring" d="M'//point_words(at)//'L'//point_words(at + pin/k*[-2.0_wp, -3.5_wp])//'L'// &
                          point_words(at + pin/k*[2.0_wp, -3.5_wp])//'Z"/>')
         else
            call text%add('<path class="spring" stroke-width="'//short_number(0.8_wp/k)//'" d="M'//point_words(foot)//'L'// &
                          point_words(at)//'"/>')
         end if
         call text%add('<circle class="spring" cx="'//full_precision(at(1))//'" cy="'//full_precision(at(2))//'" r="'// &
                       short_number(pin/k)//'"/>')
      end subroutine draw_end
   end subroutine draw_weights_and_springs

   !> A spring from one end to the other.
   function coil_path(from, to, half_width) result(path)
      real(wp), intent(in) :: from(2), to(2), half_width
      character(:), allocatable :: path
      real(wp) :: along(2), across(2), part
      integer :: i

      along = to - from
      across = 0.0_wp
      if (norm2(along) > 0.0_wp) across = half_width*[-along(2), along(1)]/norm2(along)
      path = 'M'//point_words(from)//'L'//point_words(from + hook*along)
      do i = 1, 2*coils
         part = hook + (1.0_wp - 2.0_wp*hook)*(real(i, wp) - 0.5_wp)/real(2*coils, wp)
         path = path//'L'//point_words(from + part*along + merge(across, -across, modulo(i, 2) == 1))
      end do
      path = path//'L'//point_words(to - hook*along)//'L'//point_words(to)
   end function coil_path

   !> A torsional spring around a joint.
   function spiral_path(centre, radius) result(path)
      real(wp), intent(in) :: centre(2), radius
      character(:), allocatable :: path
      real(wp) :: angle, r
      integer :: i

      path = ''
      do i = 0, spiral_steps
         angle = 5.0_wp*pi*real(i, wp)/real(spiral_steps, wp)
         r = radius*(0.3_wp + 0.7_wp*real(i, wp)/real(spiral_steps, wp))
         path = path//merge('M', 'L', i == 0)//point_words(centre + r*[cos(angle), sin(angle)])
      end do
   end function spiral_path

   !> Symbols of the centres of mass, arrows of the loads, at one prescribed position, in machine coordinates.
   subroutine draw_centres_and_loads(forces, position, k, text)
      type(force_scene_t), intent(in) :: forces
      integer, intent(in) :: position
      real(wp), intent(in) :: k                            !! pixels per unit of length
      type(text_t), intent(inout) :: text
      real(wp) :: largest, tip(2), along(2), across(2), head
      character(:), allocatable :: r
      integer :: i

      if (.not. forces%prescribed%table%known(position)) return
      r = short_number(mass_radius/k)
      call text%add('<g id="masses">')
      do i = 1, size(forces%prescribed%centre, 3)
         ! a circle with two opposite quarters filled
         associate (at => forces%prescribed%centre(:, position, i))
            call text%add('<g class="mass" data-link="'//xml_text(trim(forces%links(i)))//'" transform="translate('// &
                          point_words(at)// &
                          ')"><circle stroke-width="'//short_number(0.25_wp*mass_radius/k)//'" r="'//r//'"/><path d="M0 0V'//r// &
                          'A'//r//' '//r//' 0 0 0 '//r//' 0ZM0 0V-'//r//'A'//r//' '//r//' 0 0 0 -'//r//' 0Z"/></g>')
         end associate
      end do
      call text%add('</g>')
      largest = largest_load(forces)
      if (largest <= 0.0_wp) return
      call text%add('<g id="loads" stroke-width="'//short_number(2.2_wp/k)//'">')
      do i = 1, size(forces%prescribed%load, 3)
         associate (at => forces%prescribed%load_at(:, position, i), load => forces%prescribed%load(:, position, i))
            along = load/largest*longest_arrow/k
            if (norm2(along) <= 0.0_wp) cycle
            tip = at + along
            head = min(arrow_head/k, 0.6_wp*norm2(along))
            along = along/norm2(along)*head
            across = 0.4_wp*[-along(2), along(1)]
            call text%add('<path class="load" data-newtons="'//full_precision(load(1))//' '//full_precision(load(2))//'" d="M'// &
                          point_words(at)//'L'//point_words(tip)//'M'//point_words(tip - along + across)//'L'// &
                          point_words(tip)//'L'//point_words(tip - along - across)//'"/>')
         end associate
      end do
      call text%add('</g>')
   end subroutine draw_centres_and_loads

   function point_words(point) result(words)
      real(wp), intent(in) :: point(2)
      character(:), allocatable :: words

      words = full_precision(point(1))//' '//full_precision(point(2))
   end function point_words

   !> What the arrows mean; empty without loads.
   function load_scale_words(forces) result(words)
      type(force_scene_t), intent(in) :: forces
      character(:), allocatable :: words

      words = ''
      if (largest_load(forces) > 0.0_wp) words = 'loads: '//short_number(real(nint(longest_arrow), wp))//' pixels are '// &
                                                 short_number(largest_load(forces), digits)//' N'
   end function load_scale_words

   !> Pixels that the diagrams take.
   pure real(wp) function height_of_polar_diagrams(forces) result(height)
      type(force_scene_t), intent(in) :: forces

      height = heading + cell*real((size(forces%joints) + in_a_row - 1)/in_a_row, wp)
   end function height_of_polar_diagrams

   !> One diagram a joint: the end of the force on its later link, machine axes, over the sweep; a dot at the prescribed position.
   subroutine draw_polar_diagrams(forces, position, top, text)
      type(force_scene_t), intent(in) :: forces
      integer, intent(in) :: position
      real(wp), intent(in) :: top                          !! pixels
      type(text_t), intent(inout) :: text
      real(wp) :: largest, x, y
      integer :: j, i
      logical :: down

      call text%add('<g id="polar"><text class="key" x="28" y="'//short_number(top + 16.0_wp)// &
                    '">Polar diagrams: force on the later link of each joint, machine axes; dot: the position drawn above'// &
                    tail()//'</text>')
      do j = 1, size(forces%joints)
         x = 28.0_wp + cell*(real(modulo(j - 1, in_a_row), wp) + 0.5_wp)
         y = top + heading + cell*real((j - 1)/in_a_row, wp) + half + 6.0_wp
         largest = largest_in_joint(forces, j)
         call text%add('<g transform="translate('//short_number(x)//' '//short_number(y)//')"><path class="axis" '// &
                       'stroke-width=".6" d="M'//short_number(-half)//' 0H'//short_number(half)//'M0 '//short_number(-half)// &
                       'V'//short_number(half)//'"/>')
         if (largest > 0.0_wp) then
            call text%add_text('<path class="polar" data-joint="'//xml_text(trim(forces%joints(j)))//'" data-newtons="'// &
                               full_precision(largest)//'" d="')
            down = .false.
            do i = 1, size(forces%sweep%joint, 2)
               if (.not. forces%sweep%table%known(i)) then
                  down = .false.
                  cycle
               end if
               call text%add_text(merge('L', 'M', down)//place(forces%sweep%joint(:, i, j)))
               down = .true.
            end do
            call text%add('"/>')
            if (forces%prescribed%table%known(position)) then
               associate (at => forces%prescribed%joint(:, position, j))
                  call text%add('<circle class="now" r="3" cx="'//short_number(at(1)/largest*half)//'" cy="'// &
                                short_number(-at(2)/largest*half)//'"/>')
               end associate
            end if
         end if
         call text%add('<text class="key" text-anchor="middle" y="'//short_number(half + 22.0_wp)//'">'// &
                       xml_text(trim(forces%joints(j)))//', peak '//short_number(largest, digits)//' N</text></g>')
      end do
      call text%add('</g>')

   contains

      function place(force) result(words)
         real(wp), intent(in) :: force(2)
         character(:), allocatable :: words

         words = short_number(force(1)/largest*half)//' '//short_number(-force(2)/largest*half)
      end function place

      function tail() result(words)
         character(:), allocatable :: words

         words = load_scale_words(forces)
         if (len(words) > 0) words = '; '//words
         if (len(words_of_added(forces)) > 0) words = words//'; added: '//words_of_added(forces)
      end function tail
   end subroutine draw_polar_diagrams
end module psalm_force_drawing
