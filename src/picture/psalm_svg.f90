!> A scene as SVG: one file, readable in print and on a dark screen.
!>
!> Geometry stands in machine coordinates with all digits inside one group that flips and scales; symbols, strokes and
!> letters have sizes of the drawing. Symbols are those of Oldham (1977), section 15.1: circles for revolute joints, single
!> triangles for frame joints, a pair of triangles vertex to vertex for prismatic joints, five-pointed stars for the output.
module psalm_svg
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_constraint_group, only: region_box, region_half_plane
   use psalm_detail_drawing, only: bent_path, bent_words, detail_style, draw_pin, height_of_pin
   use psalm_elementary, only: hypotenuse
   use psalm_force_drawing, only: draw_centres_and_loads, draw_polar_diagrams, draw_weights_and_springs, height_of_polar_diagrams
   use psalm_kinds, only: wp
   use psalm_labels, only: place_labels
   use psalm_markup, only: xml_text, short_number, wrapped, strings_t, add_string
   use psalm_output_kind, only: motion_point, motion_angle, motion_distance, motion_slide
   use psalm_proof_scene, only: near_t
   use psalm_scene, only: scene_t, motion_number
   use psalm_svg_frame, only: begin_svg, px => pixels
   use psalm_svg_theme, only: base_style, palette_size, palette_style, style_element
   use psalm_text, only: text_t, full_precision, to_text
   use psalm_trace, only: position_row_t, rail_ends
   use psalm_view, only: drawing_unit, change_unit, take_in_others
   implicit none (type, external)
   private
   public :: write_svg, class_of, draw_still, write_style

   real(wp), parameter :: width = 960.0_wp, tallest = 660.0_wp, margin = 52.0_wp, header = 72.0_wp !! sizes, pixels
   real(wp), parameter :: line_height = 17.0_wp
   integer, parameter :: characters = 116     !! of a message on one line
   integer, parameter :: most_links = 30, most_directions = 80 !! positions from which on these get fainter
   real(wp), parameter :: faint = 0.3_wp, faintest = 0.02_wp  !! opacity of links at every position
   real(wp), parameter :: faintest_direction = 0.01_wp
   integer, parameter :: digits_for_people = 7
   integer, parameter :: most_messages = 14   !! the listing and the page have all
   real(wp), parameter :: small_star = 0.55_wp
   real(wp), parameter :: region_strip = 12.0_wp !! of a half-plane, pixels
   integer, parameter :: many = 60            !! joints above which symbols are smaller
   real(wp), parameter :: crowded = 0.55_wp   !! size of symbols then

contains

   !> Append the picture.
   subroutine write_svg(given, assemblies, text)
      type(scene_t), intent(in) :: given
      logical, intent(in) :: assemblies      !! show the other assembly of each pair in grey
      type(text_t), intent(inout) :: text
      type(scene_t) :: scene
      type(strings_t), allocatable :: lines(:)
      real(wp) :: k, ox, oy, height, foot, unit, below

      scene = given
      unit = 1.0_wp
      if (scene%valid) unit = drawing_unit(scene)
      if (unit /= 1.0_wp) call change_unit(scene, unit)
      if (scene%valid .and. assemblies) call take_in_others(scene)
      call message_lines(scene, lines)
      k = 1.0_wp
      ox = 0.0_wp
      oy = header
      foot = header
      if (scene%valid) then
         associate (size_ => scene%high - scene%low)
            k = min((width - 2.0_wp*margin)/size_(1), (tallest - 2.0_wp*margin)/size_(2))
            ox = 0.5_wp*(width - k*size_(1))
            oy = header + margin + k*size_(2)
            foot = oy + margin
         end associate
      end if
      below = merge(46.0_wp, 8.0_wp, scene%valid)
      if (allocated(scene%forces)) below = below + height_of_polar_diagrams(scene%forces)
      if (allocated(scene%clearance)) below = below + height_of_pin
      height = foot + below + line_height*real(size(lines), wp) + 14.0_wp
      call begin_svg(scene%title, width, height, text)
      call write_style(scene, .true., text)
      call text%add('<rect class="paper" width="'//px(width)//'" height="'//px(height)//'"/>')
      call text%add('<text class="head" x="28" y="36">'//xml_text(trim(scene%title))//'</text>')
      if (scene%valid) then
         call text%add('<text class="sub" x="28" y="57">'//xml_text(subtitle(scene))//'</text>')
         call text%add('<clipPath id="area"><rect x="8" y="'//px(header - 4.0_wp)//'" width="'//px(width - 16.0_wp)// &
                       '" height="'//px(foot - header + 4.0_wp)//'"/></clipPath><g clip-path="url(#area)">')
         call text%add('<g id="linkage"'//data_unit(unit)//' transform="matrix('//short_number(k)//' 0 0 '// &
                       short_number(-k)//' '// &
                       short_number(ox - k*scene%low(1))//' '//short_number(oy + k*scene%low(2))//')">')
         call draw_linkage(scene, assemblies, k, text)
         call text%add('</g></g>')
         call draw_letters(scene, k, ox, oy, text)
         call draw_scale(k, foot, unit, text)
         call draw_legend(scene, foot, text)
         if (allocated(scene%forces)) call draw_polar_diagrams(scene%forces, scene%reference, foot + 46.0_wp, text)
         if (allocated(scene%clearance)) call draw_pin(scene, scene%reference, foot + below - height_of_pin, text)
      end if
      call draw_messages(lines, foot + below, text)
      call text%add('</svg>')
   end subroutine write_svg

   function data_unit(unit) result(attribute)
      real(wp), intent(in) :: unit
      character(:), allocatable :: attribute

      attribute = ''
      if (unit /= 1.0_wp) attribute = ' data-unit="'//number(unit)//'"'
   end function data_unit

   !> The style of all pictures, that of linkages, and those of what the scene has besides; the symbols of joints.
   subroutine write_style(scene, studied, text)
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: studied           !! what was found by studies is drawn, too
      type(text_t), intent(inout) :: text
      character(*), parameter :: of_linkage = &
         '.head{font-size:20px}.sub,.key{font-size:12.5px;fill:$soft}.letter{font-size:15px;font-style:italic;'// &
         'text-anchor:middle}.symbol{fill:$paper;stroke:$ink}.broken{fill:none}.bar,.trace,.every,.path,.rail,'// &
         '.ghost{fill:none;stroke-linecap:round;stroke-linejoin:round}.frame,.rail{stroke:$frame}.trace{stroke:$soft}'// &
         '.plate{fill-opacity:.16;stroke-linejoin:round}.region{fill:$bad;fill-opacity:.09;stroke:$bad}.inside{fill:none}'// &
         '.broken{stroke:$bad}.actual{fill:$actual;stroke:$actual}.path{stroke:$actual}.desired{fill:none;stroke:$desired}'// &
         '.axis{stroke:$ink;fill:none}.actual.direction,.desired.direction{fill:none}'
      ! what is proven, or links that have a width
      character(*), parameter :: of_proof = &
         '.wide{stroke:$frame;stroke-opacity:.28;stroke-linecap:round;fill:none}.near{fill:none;stroke-linecap:round}'// &
         '.near .body{stroke:$warn;stroke-opacity:.25}.near .way{stroke:$warn}.proof{fill:none;stroke:$accent}'// &
         '.proof.opens{stroke:$bad}.proof.dead{stroke:$warn}'
      character(*), parameter :: of_forces = &
         '.mass circle{fill:$paper;stroke:$ink}.mass path{fill:$ink}.weight{fill:$soft;fill-opacity:.3;stroke:$soft}'// &
         '.spring{fill:none;stroke:$warn;stroke-linejoin:round}.load{fill:none;stroke:$good;stroke-linecap:round}'// &
         '.polar{fill:none;stroke:$accent;stroke-width:1.3}.now{fill:$actual}'
      ! cylinders, gear wheels and what is reached
      character(*), parameter :: of_chains = &
         '.barrel{fill:none;stroke-linecap:butt;stroke-opacity:.55}.wheel{fill:none}.outline{fill:$good;stroke:$good;'// &
         'stroke-linejoin:round}.reach{fill:$good;fill-opacity:.12}.net{fill:none;stroke:$good;stroke-opacity:.35}'// &
         '#envelope .paper{stroke:$paper}'
      character(:), allocatable :: rules
      integer :: i

      rules = base_style//of_linkage
      if (allocated(scene%drives)) rules = rules//of_chains
      if (studied) then
         if (allocated(scene%proof)) rules = rules//of_proof
         if (allocated(scene%forces)) rules = rules//of_forces
         if (allocated(scene%vibration) .or. allocated(scene%clearance)) rules = rules//detail_style
      end if
      rules = rules//palette_style()
      do i = 1, palette_size
         rules = rules//'.plate.c'//to_text(i)//'{fill:$link'//to_text(i - 1)//'}'
      end do
      call text%add(style_element(rules))
      call text%add('<defs><circle id="revolute" r="5"/><path id="ground" d="M0 0L-9.5-16.5H9.5Z"/><path id="prismatic" '// &
                    'd="M0 0L-9 9.5H9ZM0 0L-9-9.5H9Z"/><path id="star" d="M0 10L2.25 3.09 9.51 3.09 3.63-1.18 5.88-8.09 0-3.82'// &
                    '-5.88-8.09-3.63-1.18-9.51 3.09-2.25 3.09Z"/><path id="diamond" d="M0 7L6 0 0-7-6 0Z"/><path id="cross" '// &
                    'd="M-9 0H9M0-9V9"/></defs>')
   end subroutine write_style

   function subtitle(scene) result(line)
      type(scene_t), intent(in) :: scene
      character(:), allocatable :: line

      if (scene%time > 0.0_wp) then
         line = 'motion in time, drawn at 0 of '//number(scene%time)//' s; '
      else if (allocated(scene%drives)) then
         line = subtitle_of_drives(scene)
         return
      else
         line = 'crank angle'
         if (scene%sliding) line = 'input length'
         if (allocated(scene%input_label)) line = 'input'
         line = 'drawn at '//line//' '// &
                number(scene%prescribed%input(scene%reference))//trim(merge('           ', ' degrees   ', scene%sliding))//'; '
      end if
      if (allocated(scene%output_label)) then
         line = line//'output: '//scene%output_label
      else
         select case (scene%motion)
         case (motion_point)
            line = line//'output: the point'
         case (motion_angle)
            line = line//'output: direction of the output arc'
         case (motion_distance)
            line = line//'output: distance of the point from the origin'
         case default
            line = line//'output: length of a slide'
         end select
      end if
      if (scene%time > 0.0_wp) then
         line = line//', marked every '//number(scene%prescribed%input(2))//' s'
      else
         line = line//positions_of(scene)
      end if
   end function subtitle

   !> How many positions, and how many of them do not close.
   function positions_of(scene) result(line)
      type(scene_t), intent(in) :: scene
      character(:), allocatable :: line

      line = '; '//to_text(scene%prescribed%n)//' position'//repeat('s', merge(0, 1, scene%prescribed%n == 1))
      if (.not. all(scene%prescribed%closed)) &
         line = line//', of which '//to_text(count(.not. scene%prescribed%closed))// &
                trim(merge(' does not close', ' do not close  ', count(.not. scene%prescribed%closed) == 1))
   end function positions_of

   !> Values of all drives, counted from the drawing, and the name of the output.
   function subtitle_of_drives(scene) result(line)
      type(scene_t), intent(in) :: scene
      character(:), allocatable :: line
      integer :: d

      line = 'from the drawing:'
      do d = 1, size(scene%drives)
         if (d > 1) line = line//','
         line = line//' drive '//scene%drives(d)%name//' '//number(scene%drives(d)%prescribed(scene%reference))// &
                trim(merge(' degrees', '        ', scene%drives(d)%turning))
      end do
      line = line//'; output: '//scene%output_label//positions_of(scene)
   end function subtitle_of_drives

   ! ---- the linkage -------------------------------------------------------------------------------------------------

   !> Opacity of what is drawn at every position: the more there are, the less.
   pure real(wp) function faintness(scene, most)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: most

      faintness = max(faintest, faint*min(1.0_wp, sqrt(real(most, wp)/real(scene%prescribed%n, wp))))
   end function faintness

   subroutine draw_linkage(scene, assemblies, k, text)
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: assemblies
      real(wp), intent(in) :: k               !! pixels per unit of length
      type(text_t), intent(inout) :: text
      integer :: i

      call draw_regions(scene, k, text)
      call draw_envelope(scene, k, text)
      call draw_traces(scene, k, text)
      call draw_equilibria(scene, k, text)
      if (scene%everywhere) then
         call text%add('<g'//stroke(1.1_wp, k)//' stroke-opacity="'//px(faintness(scene, most_links))//'">')
         do i = 1, scene%prescribed%n
            if (i /= scene%reference) call draw_bars(scene, scene%prescribed, i, 'every', k, text)
         end do
         call text%add('</g>')
      end if
      if (assemblies) call draw_ghosts(scene, k, text)
      call draw_rails(scene, k, text)
      if (allocated(scene%proof)) call draw_wide_links(scene, k, text)
      call draw_plates(scene, k, text)
      if (allocated(scene%forces)) call draw_weights_and_springs(scene%forces, scene%reference, k, text)
      call draw_wheels(scene, k, text)
      call draw_path(scene, k, text)
      call text%add('<g id="reference" data-position="'//to_text(scene%reference)//'"'//stroke(2.6_wp, k)//'>')
      call draw_bars(scene, scene%prescribed, scene%reference, 'bar', k, text)
      call text%add('</g>')
      call draw_barrels(scene, k, text)
      call draw_broken(scene, k, text)
      call draw_output(scene, k, text)
      call draw_symbols(scene, k, text)
      call draw_star(scene, k, text)
      if (allocated(scene%proof)) call draw_marks(scene, k, text)
      if (allocated(scene%forces)) call draw_centres_and_loads(scene%forces, scene%reference, k, text)
   end subroutine draw_linkage

   !> What does not move: regions, what is reached, the path of the output point, the places wanted of it. In machine
   !> coordinates.
   subroutine draw_still(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k               !! pixels per unit of length
      type(text_t), intent(inout) :: text
      integer :: i

      call draw_regions(scene, k, text)
      call draw_envelope(scene, k, text)
      call draw_equilibria(scene, k, text)
      call draw_path(scene, k, text)
      if (.not. (scene%desired .and. scene%motion == motion_point)) return
      do i = 1, scene%prescribed%n
         call text%add('<use href="#diamond" class="desired" transform="translate('//pair(scene%prescribed%desired_mark(1, i), &
                       scene%prescribed%desired_mark(2, i))//') scale('//short_number(1.0_wp/k)//')"/>')
      end do
   end subroutine draw_still

   !> Where joints must not go: shaded; where they must stay: a dashed outline. Of a half-plane a strip along its edge.
   subroutine draw_regions(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      character(:), allocatable :: start
      real(wp) :: far, strip, c, s
      integer :: r

      do r = 1, size(scene%regions)
         associate (region => scene%regions(r))
            start = ' class="region'//trim(merge(' inside', '       ', region%stay_inside))//'" data-region="'//to_text(r)//'"'// &
                    stroke(1.2_wp, k)
            if (region%stay_inside) start = start//' stroke-dasharray="'//short_number(5.0_wp/k)//' '//short_number(4.0_wp/k)//'"'
            select case (region%kind)
            case (region_box)
               call text%add('<path'//start//' d="M'//pair(region%at(1), region%at(2))//'H'//full_precision(region%at(3))//'V'// &
                             full_precision(region%at(4))//'H'//full_precision(region%at(1))//'Z"/>')
            case (region_half_plane)
               call unit_vector(region%at(3), c, s)
               far = 2.0_wp*(maxval(scene%high - scene%low) + hypotenuse(region%at(1) - scene%low(1), region%at(2) - scene%low(2)))
               strip = merge(-region_strip, region_strip, region%stay_inside)/k
               call text%add('<path'//start//' d="M'//pair(region%at(1) - far*c, region%at(2) - far*s)//'L'// &
                             pair(region%at(1) + far*c, region%at(2) + far*s)//'l'//pair(-strip*s, strip*c)//'l'// &
                             pair(-2.0_wp*far*c, -2.0_wp*far*s)//'Z"/>')
            case default
               call text%add('<circle'//start//' cx="'//full_precision(region%at(1))//'" cy="'//full_precision(region%at(2))// &
                             '" r="'//full_precision(region%at(3))//'"/>')
            end select
         end associate
      end do
   end subroutine draw_regions

   !> Links with a width where they are, and the tightest clearance of the motion: two links and the shortest way between them.
   subroutine draw_wide_links(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      integer :: i

      associate (row => scene%prescribed, now => scene%reference, proof => scene%proof)
         do i = 1, size(proof%wide)
            associate (wide => proof%wide(i))
               if (.not. all(row%known([wide%start, wide%finish], now))) cycle
               call text%add('<path class="wide"'//stroke(wide%width*k, k)//' d="M'//point(row, wide%start, now)//'L'// &
                             point(row, wide%finish, now)//'"/>')
            end associate
         end do
         do i = 1, size(proof%near)
            if (proof%near(i)%tightest) call draw_near(proof%near(i))
         end do
      end associate

   contains

      subroutine draw_near(near)
         type(near_t), intent(in) :: near
         integer :: n

         call text%add('<g class="near"><title>'//xml_text(scene%proof%marks(near%mark)%text)//'</title>')
         do n = 1, near%points/2
            associate (a => near%ends(:, 2*n - 1), b => near%ends(:, 2*n))
               call text%add('<path class="body"'//stroke(max(near%widths(n)*k, 2.0_wp), k)//' d="M'//pair(a(1), a(2))//'L'// &
                             pair(b(1), b(2))//'"/>')
            end associate
         end do
         call text%add('<path class="way"'//stroke(1.6_wp, k)//' d="M'//pair(near%way(1, 1), near%way(2, 1))//'L'// &
                       pair(near%way(1, 2), near%way(2, 2))//'"/></g>')
      end subroutine draw_near
   end subroutine draw_wide_links

   !> Where the output point is when the linkage opens (red), when it is at an extreme, and when it stands still.
   subroutine draw_marks(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      real(wp), parameter :: radius = 4.5_wp    !! pixels
      integer :: i

      do i = 1, size(scene%proof%marks)
         associate (mark => scene%proof%marks(i))
            if (.not. (mark%placed .and. mark%of_output)) cycle
            call text%add('<circle class="proof '//mark%kind//'"'//stroke(1.6_wp, k)//' cx="'//full_precision(mark%at(1))// &
                          '" cy="'//full_precision(mark%at(2))//'" r="'//short_number(radius/k)//'"><title>'// &
                          xml_text(mark%text)//'</title></circle>')
         end associate
      end do
   end subroutine draw_marks

   !> Every moving joint at every position.
   subroutine draw_traces(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      integer :: j, i

      if (allocated(scene%meshes)) return   ! they would cover it
      call text%add('<g id="traces"'//stroke(3.2_wp, k)//'>')
      associate (row => scene%prescribed)
         do j = 1, size(scene%joints)
            if (scene%joints(j)%fixed .or. len(scene%joints(j)%name) == 0) cycle
            call text%add('<path class="trace" data-joint="'//xml_text(scene%joints(j)%name)//'" d="')
            do i = 1, row%n
               if (row%known(j, i)) call text%add('M'//point(row, j, i)//'h0')
            end do
            call text%add('"/>')
         end do
      end associate
      call text%add('</g>')
   end subroutine draw_traces

   !> All links at one position.
   subroutine draw_bars(scene, row, i, class, k, text)
      type(scene_t), intent(in) :: scene
      type(position_row_t), intent(in) :: row
      integer, intent(in) :: i
      character(*), intent(in) :: class
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      integer :: b
      character(:), allocatable :: kind, dashes, line

      do b = 1, size(scene%bars)
         associate (bar => scene%bars(b))
            if (bar%start == bar%finish) cycle
            if (.not. (row%known(bar%start, i) .and. row%known(bar%finish, i))) cycle
            kind = class_of(scene, bar%body)
            if (class == 'every' .and. kind == 'frame') cycle
            dashes = ''
            if (kind == 'frame') dashes = stroke(1.5_wp, k)// &
                                          ' stroke-dasharray="'//short_number(6.0_wp/k)//' '//short_number(6.0_wp/k)//'"'
            line = 'M'//point(row, bar%start, i)//'L'//point(row, bar%finish, i)
            if (is_bent(b)) then
               call text%add('<path class="straight"'//stroke(0.8_wp, k)//' stroke-dasharray="'//short_number(4.0_wp/k)//'" d="'// &
                             line//'"/>')
               line = bent_path(scene, i)
            end if
            call text%add('<path class="'//class//' '//kind//'" data-position="'//to_text(i)//'"'//name_of_bar(scene, b)// &
                          dashes//' d="'//line//'"/>')
         end associate
      end do

   contains

      !> A vibrating link is drawn bent at the position drawn.
      pure logical function is_bent(b)
         integer, intent(in) :: b

         is_bent = allocated(scene%vibration) .and. class == 'bar'
         if (is_bent) is_bent = b == scene%vibration%bar
      end function is_bent
   end subroutine draw_bars

   !> What a bar is called: its loop and arc, or its link.
   function name_of_bar(scene, bar) result(attribute)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: bar
      character(:), allocatable :: attribute

      associate (body => scene%bars(bar)%body)
         if (body > 0) then
            if (allocated(scene%bodies(body)%name)) then
               attribute = ' data-link="'//xml_text(scene%bodies(body)%name)//'"'
               return
            end if
         end if
      end associate
      attribute = ' data-arc="'//to_text(scene%bars(bar)%loop)//' '//to_text(scene%bars(bar)%arc)//'"'
   end function name_of_bar

   !> What the output reaches over a grid of strokes. The meshes cover each other; drawn with a broad stroke, then in the colour of
   !> the paper, then tinted, they leave the outline of all of them together.
   subroutine draw_envelope(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      integer :: m, c

      if (.not. allocated(scene%meshes)) return
      call text%add('<defs><path id="meshes" d="')
      do m = 1, size(scene%meshes, 3)
         do c = 1, 4
            call text%add_text(merge('M', 'L', c == 1)//short_number(scene%meshes(1, c, m))//' '// &
                               short_number(scene%meshes(2, c, m)))
         end do
         call text%add('Z')
      end do
      call text%add('"/></defs><g id="envelope"><use href="#meshes" class="outline"'//stroke(3.0_wp, k)// &
                    '/><use href="#meshes" class="paper"'//stroke(0.3_wp, k)// &
                    '/><use href="#meshes" class="reach"/><use href="#meshes" class="net"'//stroke(0.5_wp, k)//'/></g>')
   end subroutine draw_envelope

   !> Pitch circles of gear wheels, and on each a line that turns with it.
   subroutine draw_wheels(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      integer :: w

      if (.not. allocated(scene%wheels)) return
      associate (row => scene%prescribed, i => scene%reference)
         do w = 1, size(scene%wheels)
            associate (wheel => scene%wheels(w))
               if (.not. row%known(wheel%centre, i)) cycle
               call text%add('<g class="wheel '//class_of(scene, wheel%body)//'"'//stroke(1.4_wp, k)//'><circle cx="'// &
                             full_precision(row%x(wheel%centre, i))//'" cy="'//full_precision(row%y(wheel%centre, i))//'" r="'// &
                             full_precision(wheel%radius)//'"/><path d="M'//point(row, wheel%centre, i)//'L'// &
                             point(row, wheel%rim, i)//'"/></g>')
            end associate
         end do
      end associate
   end subroutine draw_wheels

   !> The thick part of each cylinder.
   subroutine draw_barrels(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      real(wp) :: along(2)
      integer :: b

      associate (row => scene%prescribed, i => scene%reference)
         do b = 1, size(scene%bars)
            associate (bar => scene%bars(b))
               if (.not. bar%cylinder .or. .not. row%known(bar%start, i)) cycle
               along = [row%x(bar%finish, i) - row%x(bar%start, i), row%y(bar%finish, i) - row%y(bar%start, i)]
               if (norm2(along) <= 0.0_wp) cycle
               along = along*(bar%barrel/norm2(along))
               call text%add('<path class="barrel '//class_of(scene, bar%body)//'"'//name_of_bar(scene, b)//stroke(8.0_wp, k)// &
                             ' d="M'//point(row, bar%start, i)//'l'//pair(along(1), along(2))//'"/>')
            end associate
         end do
      end associate
   end subroutine draw_barrels

   pure function class_of(scene, body) result(name)
      type(scene_t), intent(in) :: scene
      integer, intent(in) :: body
      character(:), allocatable :: name

      name = 'c1'
      if (body == 0) return
      if (scene%bodies(body)%frame) then
         name = 'frame'
      else
         name = 'c'//to_text(modulo(body - 1, palette_size) + 1)
      end if
   end function class_of

   subroutine draw_plates(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      integer :: b, m

      associate (row => scene%prescribed, i => scene%reference)
         do b = 1, size(scene%bodies)
            associate (body => scene%bodies(b))
               if (size(body%hull) == 0 .or. body%frame) cycle
               if (.not. all(row%known(body%hull, i))) cycle
               call text%add('<polygon class="plate '//class_of(scene, b)//'"'//stroke(1.3_wp, k)//' points="')
               do m = 1, size(body%hull)
                  call text%add(full_precision(row%x(body%hull(m), i))//','//full_precision(row%y(body%hull(m), i)))
               end do
               call text%add('"/>')
            end associate
         end do
      end associate
   end subroutine draw_plates

   subroutine draw_rails(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      real(wp) :: ends(2, 2)
      integer :: s

      if (size(scene%slides) == 0) return
      call text%add('<g id="rails"'//stroke(1.5_wp, k)//'>')
      associate (row => scene%prescribed, i => scene%reference)
         do s = 1, size(scene%slides)
            associate (slide => scene%slides(s))
               if (.not. (row%known(slide%guide, i) .and. row%known(slide%block, i))) cycle
               ends = rail_ends(row, scene%slides, s, i)
               call text%add('<path class="rail"'//name_of_bar(scene, slide%bar)//' d="M'//pair(ends(1, 1), ends(2, 1))//'L'// &
                             pair(ends(1, 2), ends(2, 2))//'"/>')
            end associate
         end do
      end associate
      call text%add('</g>')
   end subroutine draw_rails

   !> Equilibria in grey, dashed where they are not stable, with their numbers.
   subroutine draw_equilibria(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      integer :: g, b, j

      if (.not. allocated(scene%ghosts)) return
      do g = 1, size(scene%ghosts)
         associate (ghost => scene%ghosts(g))
            call text%add('<g class="equilibrium" data-equilibrium="'//trim(ghost%name)//'"'//stroke(1.8_wp, k)//'>')
            do b = 1, size(scene%bars)
               associate (bar => scene%bars(b))
                  if (bar%start == bar%finish .or. class_of(scene, bar%body) == 'frame') cycle
                  if (.not. (ghost%known(bar%start) .and. ghost%known(bar%finish))) cycle
                  call text%add_text('<path class="ghost" d="M'//pair(ghost%x(bar%start), ghost%y(bar%start))//'L'// &
                                     pair(ghost%x(bar%finish), ghost%y(bar%finish))//'"')
                  if (.not. ghost%stable) call text%add_text(' stroke-dasharray="'//short_number(4.0_wp/k)//' '// &
                                                             short_number(4.0_wp/k)//'"')
                  call text%add('/>')
               end associate
            end do
            do j = 1, size(scene%joints)
               if (scene%joints(j)%fixed .or. .not. ghost%known(j)) cycle
               call text%add('<text class="letter" transform="translate('//pair(ghost%x(j), ghost%y(j))//') scale('// &
                             short_number(1.0_wp/k)//' '//short_number(-1.0_wp/k)//')" dx="7" dy="-7">'// &
                             trim(ghost%name)//'</text>')
               exit
            end do
            call text%add('</g>')
         end associate
      end do
   end subroutine draw_equilibria

   !> The other assembly of each pair at the reference position.
   subroutine draw_ghosts(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      integer :: loop

      call text%add('<g id="assemblies"'//stroke(1.8_wp, k)//'>')
      associate (row => scene%prescribed, i => scene%reference)
         do loop = 1, size(scene%pairs)
            if (.not. row%other_known(loop, i)) cycle
            associate (two => scene%pairs(loop))
               call text%add('<path class="ghost" data-loop="'//to_text(loop)//'" d="M'//point(row, two%start, i)//'L'// &
                             pair(row%other(1, loop, i), row%other(2, loop, i))//'L'//point(row, two%finish, i)//'"/>')
            end associate
         end do
      end associate
      call text%add('</g>')
   end subroutine draw_ghosts

   !> The path of the output point over the sweep, broken where it does not close.
   subroutine draw_path(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      logical :: down
      integer :: i

      if (all(scene%motion /= [motion_point, motion_distance, motion_number])) return
      if (allocated(scene%meshes)) return   ! the way through a grid is no path
      call text%add('<path class="path" id="path"'//stroke(1.3_wp, k)//' d="')
      down = .false.
      do i = 1, scene%sweep%n
         if (scene%sweep%known(scene%output, i)) then
            call text%add(merge('L', 'M', down)//point(scene%sweep, scene%output, i))
            down = .true.
         else
            down = .false.
         end if
      end do
      if (all(scene%sweep%known(scene%output, :)) .and. .not. scene%sliding) call text%add('Z')
      call text%add('"/>')
   end subroutine draw_path

   !> Pairs that do not meet at the reference position.
   subroutine draw_broken(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      integer :: loop

      associate (row => scene%prescribed, i => scene%reference)
         do loop = 1, scene%loops
            if (.not. row%broken(loop, i)) cycle
            associate (two => scene%pairs(loop), tip => row%tip(:, loop, i))
               call text%add('<path class="broken" data-loop="'//to_text(loop)//'"'//stroke(2.6_wp, k)//' d="M'// &
                             point(row, two%start, i)//'L'//pair(tip(1), tip(2))//'M'//point(row, two%finish, i)//'L'// &
                             pair(tip(3), tip(4))//'"/>')
               call text%add('<path class="broken gap" data-loop="'//to_text(loop)//'"'//stroke(1.2_wp, k)// &
                             ' stroke-dasharray="'//short_number(3.0_wp/k)//' '//short_number(3.0_wp/k)//'" d="M'// &
                             pair(tip(1), tip(2))//'L'//pair(tip(3), tip(4))//'"/>')
            end associate
         end do
      end associate
   end subroutine draw_broken

   !> Actual and desired output at every prescribed position.
   subroutine draw_output(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      character(:), allocatable :: facts, veil
      integer :: i

      veil = ''
      if (scene%prescribed%n > most_directions) veil = ' stroke-opacity="'//&
         px(max(faintest_direction, real(most_directions, wp)/real(scene%prescribed%n, wp)))//'"'
      associate (row => scene%prescribed)
         if (scene%motion == motion_distance) call text%add('<use href="#cross" class="axis"'//placed(0.0_wp, 0.0_wp, 1.0_wp)//'/>')
         do i = 1, row%n
            if (allocated(scene%meshes) .and. i /= scene%reference) cycle
            facts = ' data-position="'//to_text(i)//'" data-input="'//full_precision(row%input(i))//'"'
            if (scene%motion == motion_angle .and. i /= scene%reference) facts = facts//veil
            if (row%closed(i) .and. scene%motion /= motion_number) then
               if (scene%motion == motion_angle) then
                  call text%add('<path class="output actual direction"'//facts//values(row%actual, row%actual_y, i)// &
                                stroke(merge(2.6_wp, 1.0_wp, i == scene%reference), k)//' d="M'// &
                                point(row, scene%output_base, i)//'L'//pair(row%actual_mark(1, i), row%actual_mark(2, i))//'"/>')
               else
                  call text%add('<use href="#star" class="output actual"'//facts//values(row%actual, row%actual_y, i)// &
                                placed(row%x(scene%output, i), row%y(scene%output, i), small_star)//'/>')
               end if
            end if
            if (.not. scene%desired) cycle
            if (scene%motion == motion_point) then
               call text%add('<use href="#diamond" class="output desired"'//facts//values(row%wanted, row%desired_y, i)// &
                             placed(row%desired_mark(1, i), row%desired_mark(2, i), 1.0_wp)//'/>')
            else if (row%closed(i) .and. scene%motion == motion_angle) then
               call text%add('<path class="output desired direction"'//facts//values(row%wanted, row%wanted, i)// &
                             stroke(1.3_wp, k)//' stroke-dasharray="'//short_number(7.0_wp/k)//' '//short_number(5.0_wp/k)// &
                             '" d="M'//point(row, scene%output_base, i)//'L'// &
                             pair(row%desired_mark(1, i), row%desired_mark(2, i))//'"/>')
            else if (row%closed(i)) then
               call text%add('<use href="#diamond" class="output desired"'//facts//values(row%wanted, row%wanted, i)// &
                             placed(row%desired_mark(1, i), row%desired_mark(2, i), 1.0_wp)//'/>')
            end if
         end do
      end associate

   contains

      function placed(x, y, size_) result(attribute)
         real(wp), intent(in) :: x, y, size_
         character(:), allocatable :: attribute

         attribute = ' transform="translate('//pair(x, y)//') scale('//short_number(size_/k)//')"'
      end function placed

      function values(v, w, i) result(attribute)
         real(wp), intent(in) :: v(:), w(:)
         integer, intent(in) :: i
         character(:), allocatable :: attribute

         attribute = ' data-value="'//full_precision(v(i))
         if (scene%motion == motion_point) attribute = attribute//' '//full_precision(w(i))
         attribute = attribute//'"'
      end function values
   end subroutine draw_output

   !> Joints at the reference position.
   subroutine draw_symbols(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      real(wp) :: angle
      character(:), allocatable :: start
      integer :: j, s

      associate (row => scene%prescribed, i => scene%reference)
         do j = 1, size(scene%joints)
            if (.not. row%known(j, i) .or. (len(scene%joints(j)%name) == 0 .and. .not. scene%joints(j)%slides)) cycle
            associate (joint => scene%joints(j))
               start = '<g class="joint" data-joint="'//xml_text(joint%name)//'" transform="translate('//point(row, j, i)// &
                       ') scale('//short_number(merge(crowded, 1.0_wp, size(scene%joints) > many)/k)//')" stroke-width="1.6">'
               if (joint%turning .and. joint%fixed) start = start//'<use href="#ground" class="symbol"/>'
               do s = 1, size(scene%slides)
                  if (scene%slides(s)%block /= j) cycle
                  angle = degrees_of(row%ux(s, i), row%uy(s, i))
                  start = start//'<use href="#prismatic" class="symbol" transform="rotate('//short_number(angle)//')"/>'
               end do
               if (joint%turning) start = start//'<use href="#revolute" class="symbol"/>'
               call text%add(start//'</g>')
            end associate
         end do
      end associate
   end subroutine draw_symbols

   subroutine draw_star(scene, k, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k
      type(text_t), intent(inout) :: text
      real(wp) :: x, y

      associate (row => scene%prescribed, i => scene%reference)
         if (.not. row%known(scene%output, i)) return
         x = row%x(scene%output, i)
         y = row%y(scene%output, i)
         if (scene%motion == motion_angle .and. scene%output == scene%output_base) then
            if (.not. row%closed(i)) return
            x = row%actual_mark(1, i)
            y = row%actual_mark(2, i)
         end if
         call text%add('<use href="#star" class="output actual" id="star" stroke="none" transform="translate('//pair(x, y)// &
                       ') scale('//short_number(merge(small_star, 1.0_wp, scene%motion == motion_slide)/k)//')"/>')
      end associate
   end subroutine draw_star

   ! ---- letters, scale, legend, messages ----------------------------------------------------------------------------

   subroutine draw_letters(scene, k, ox, oy, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k, ox, oy
      type(text_t), intent(inout) :: text
      real(wp) :: at(2, size(scene%joints))
      integer :: j

      call place_labels(scene, k, ox, oy, at)
      do j = 1, size(scene%joints)
         if (at(1, j) < 0.0_wp) cycle
         call text%add('<text class="letter" x="'//px(at(1, j))//'" y="'//px(at(2, j) + 5.0_wp)//'">'// &
                       xml_text(scene%joints(j)%name)//'</text>')
      end do
   end subroutine draw_letters

   !> A bar of a round length, about a sixth of the width.
   subroutine draw_scale(k, foot, unit, text)
      real(wp), intent(in) :: k, foot, unit
      type(text_t), intent(inout) :: text
      real(wp) :: length, power

      length = width/6.0_wp/k
      power = 10.0_wp**floor(log10(length))
      if (length >= 5.0_wp*power) then
         length = 5.0_wp*power
      else if (length >= 2.0_wp*power) then
         length = 2.0_wp*power
      else
         length = power
      end if
      call text%add('<g id="scale"><path class="axis" stroke-width="1.6" d="M28 '//px(foot + 8.0_wp)//'v8h'//px(k*length)// &
                    'v-8"/><text class="key" x="'//px(36.0_wp + k*length)//'" y="'//px(foot + 20.0_wp)//'" data-length="'// &
                    full_precision(length*unit)//'">'//number(length*unit)//'</text></g>')
   end subroutine draw_scale

   subroutine draw_legend(scene, foot, text)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: foot
      type(text_t), intent(inout) :: text
      real(wp) :: x

      x = 330.0_wp
      call entry('revolute', 'symbol', 'revolute', 0.0_wp)
      call entry('ground', 'symbol', 'frame joint', 8.0_wp)
      if (size(scene%slides) > 0) call entry('prismatic', 'symbol', 'prismatic', 0.0_wp)
      call entry('star', 'actual', 'output', 0.0_wp)
      if (scene%desired .and. scene%motion /= motion_angle) call entry('diamond', 'desired', 'desired', 0.0_wp)
      if (scene%desired .and. scene%motion == motion_angle) then
         call text%add('<path class="desired" stroke-width="1.3" stroke-dasharray="7 5" d="M'//px(x - 8.0_wp)//' '// &
                       px(foot + 15.0_wp)//'h30"/><text class="key" x="'//px(x + 30.0_wp)//'" y="'//px(foot + 20.0_wp)// &
                       '">desired direction</text>')
      end if

   contains

      subroutine entry(symbol, class, words, down)
         character(*), intent(in) :: symbol, class, words
         real(wp), intent(in) :: down        !! the symbol's middle below its point, pixels

         call text%add('<use href="#'//symbol//'" class="'//class//'" stroke-width="1.5" transform="translate('//px(x)//' '// &
                       px(foot + 15.0_wp - down)//') scale(.85 -.85)"/><text class="key" x="'//px(x + 15.0_wp)//'" y="'// &
                       px(foot + 20.0_wp)//'">'//words//'</text>')
         x = x + 48.0_wp + 7.4_wp*real(len(words), wp)
      end subroutine entry
   end subroutine draw_legend

   !> Errors, closure and limits, warnings, in lines of the picture's width; the first character tells which.
   subroutine message_lines(scene, lines)
      type(scene_t), intent(in) :: scene
      type(strings_t), allocatable, intent(out) :: lines(:)
      integer :: reported, all_of_them

      allocate (lines(0))
      reported = 0
      all_of_them = size(scene%errors) + size(scene%breaches) + size(scene%prescribed%words) + size(scene%warnings)
      if (.not. scene%valid) call add_string(lines, 'eThe input is wrong; there is no linkage to draw:')
      call take(scene%errors, 'e')
      call take(scene%prescribed%words, 'e')
      call take(scene%breaches, 'e')
      call take(scene%warnings, 'w')
      if (allocated(scene%vibration)) call add_string(lines, 'n'//bent_words(scene))
      if (allocated(scene%proof)) call take_proof()
      if (reported < all_of_them) call add_string(lines, 'wand '//to_text(all_of_them - reported)//' more messages')

   contains

      !> What of the proof concerns the whole range: where it closes, the tightest clearance.
      subroutine take_proof()
         type(strings_t), allocatable :: words(:)
         integer :: i

         allocate (words(0))
         do i = 1, size(scene%proof%marks)
            if (scene%proof%marks(i)%kind == 'range' .or. scene%proof%marks(i)%kind == 'opens') &
               call add_string(words, scene%proof%marks(i)%text)
         end do
         do i = 1, size(scene%proof%near)
            if (scene%proof%near(i)%tightest) call add_string(words, 'tightest: '// &
                                                              scene%proof%marks(scene%proof%near(i)%mark)%text)
         end do
         call name_rings(words)
         all_of_them = all_of_them + size(words)
         call take(words, 'p')
      end subroutine take_proof

      !> What the rings on the path are; those that were reported with their inputs need no more.
      subroutine name_rings(words)
         type(strings_t), allocatable, intent(inout) :: words(:)
         logical :: extremes, standing
         integer :: i

         extremes = .false.
         standing = .false.
         do i = 1, size(scene%proof%marks)
            associate (mark => scene%proof%marks(i))
               if (.not. (mark%placed .and. mark%of_output)) cycle
               extremes = extremes .or. mark%kind == 'extreme'
               standing = standing .or. mark%kind == 'dead'
            end associate
         end do
         if (extremes) call add_string(words, 'blue rings: the output is at an extreme')
         if (standing) call add_string(words, 'brown rings: the output stands still')
      end subroutine name_rings

      subroutine take(messages, mark)
         type(strings_t), intent(in) :: messages(:)
         character(1), intent(in) :: mark
         type(strings_t), allocatable :: parts(:)
         integer :: i, m

         do i = 1, size(messages)
            if (reported >= most_messages) return
            reported = reported + 1
            parts = wrapped(messages(i)%text, characters)
            do m = 1, size(parts)
               call add_string(lines, mark//repeat(' ', merge(0, 4, m == 1))//parts(m)%text)
            end do
         end do
      end subroutine take
   end subroutine message_lines

   subroutine draw_messages(lines, top, text)
      type(strings_t), intent(in) :: lines(:)
      real(wp), intent(in) :: top
      type(text_t), intent(inout) :: text
      integer :: i, indent

      if (size(lines) == 0) return
      call text%add('<g id="messages">')
      do i = 1, size(lines)
         associate (line => lines(i)%text)
            indent = verify(line(2:), ' ') - 1
            call text%add('<text class="'//class_of_line(line)//'" x="'// &
                          px(28.0_wp + 6.0_wp*real(indent, wp))//'" y="'//px(top + line_height*real(i, wp))//'">'// &
                          xml_text(line(2 + indent:))//'</text>')
         end associate
      end do
      call text%add('</g>')

   contains

      pure function class_of_line(line) result(class)
         character(*), intent(in) :: line
         character(:), allocatable :: class

         select case (line(1:1))
         case ('e')
            class = 'error'
         case ('w')
            class = 'warning'
         case default
            class = 'sub'
         end select
      end function class_of_line
   end subroutine draw_messages

   ! ---- numbers -----------------------------------------------------------------------------------------------------

   pure function point(row, j, i) result(text)
      type(position_row_t), intent(in) :: row
      integer, intent(in) :: j, i
      character(:), allocatable :: text

      text = pair(row%x(j, i), row%y(j, i))
   end function point

   pure function pair(x, y) result(text)
      real(wp), intent(in) :: x, y
      character(:), allocatable :: text

      text = full_precision(x)//' '//full_precision(y)
   end function pair

   !> A width of a stroke in pixels, where a unit of length has k.
   pure function stroke(pixels, k) result(attribute)
      real(wp), intent(in) :: pixels, k
      character(:), allocatable :: attribute

      attribute = ' stroke-width="'//short_number(pixels/k)//'"'
   end function stroke

   !> A number for people.
   pure function number(value) result(text)
      real(wp), intent(in) :: value
      character(:), allocatable :: text

      text = short_number(value, digits_for_people)
   end function number
end module psalm_svg
