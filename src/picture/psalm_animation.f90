!> A scene as an SVG that moves without a script: SMIL animation, which browsers play in an <img> too.
!>
!> Places are pixels to the tenth, one value for each frame; browsers go straight from one to the next. Where the motion closes on
!> itself the last frame is the first; else it goes forth and back over the longest stretch on which every joint is known, between
!> the prescribed positions where these span less than most of a turn. A motion in time, or the beginning of a long one, takes its
!> time and begins anew.
module psalm_animation
   use psalm_angles, only: degrees_of
   use psalm_kinds, only: wp, full_turn
   use psalm_markup, only: short_number
   use psalm_scene, only: scene_t
   use psalm_svg, only: class_of, draw_still, write_style
   use psalm_svg_frame, only: begin_svg, px => pixels
   use psalm_text, only: text_t
   use psalm_trace, only: rail_ends
   use psalm_view, only: drawing_unit, change_unit
   implicit none (type, external)
   private
   public :: write_animation

   real(wp), parameter :: width = 640.0_wp, tallest = 520.0_wp, margin = 34.0_wp !! sizes, pixels
   integer, parameter :: most_frames = 72           !! of a turn, or of a stretch one way: steps of 5 degrees
   real(wp), parameter :: seconds_a_frame = 1.0_wp/18.0_wp
   integer, parameter :: most_times = 400           !! frames of a motion in time
   real(wp), parameter :: times_a_second = 30.0_wp, fewest_a_second = 20.0_wp
   real(wp), parameter :: leap = 3.0_wp             !! a motion is closed if its ends are at most so many longest steps apart
   real(wp), parameter :: most_of_a_turn = 300.0_wp !! degrees: positions over less than this bound the motion shown
   integer, parameter :: many = 60                  !! joints above which symbols are smaller
   real(wp), parameter :: crowded = 0.55_wp         !! size of symbols then

   !> How machine coordinates become pixels, and which positions of the sweep are frames.
   type :: film_t
      real(wp) :: k = 1.0_wp, ox = 0.0_wp, oy = 0.0_wp
      integer, allocatable :: frames(:)             !! positions of the sweep; the last is the first again
      character(:), allocatable :: timing           !! attributes of every animation
   end type film_t

contains

   !> Append the picture of a valid scene.
   subroutine write_animation(given, text)
      type(scene_t), intent(in) :: given
      type(text_t), intent(inout) :: text
      type(scene_t) :: scene
      type(film_t) :: film
      real(wp) :: height, unit

      scene = given
      unit = drawing_unit(scene)
      if (unit /= 1.0_wp) call change_unit(scene, unit)
      associate (size_ => scene%high - scene%low)
         film%k = min((width - 2.0_wp*margin)/size_(1), (tallest - 2.0_wp*margin)/size_(2))
         height = film%k*size_(2) + 2.0_wp*margin
         film%ox = 0.5_wp*(width - film%k*size_(1)) - film%k*scene%low(1)
         film%oy = margin + film%k*size_(2) + film%k*scene%low(2)
      end associate
      call choose_frames(scene, film)
      call begin_svg(scene%title, width, height, text)
      call write_style(scene, .false., text)
      call text%add('<rect class="paper" width="'//px(width)//'" height="'//px(height)//'"/>')
      call text%add('<g transform="matrix('//short_number(film%k)//' 0 0 '//short_number(-film%k)//' '//short_number(film%ox)// &
                    ' '//short_number(film%oy)//')">')
      call draw_still(scene, film%k, text)
      call text%add('</g>')
      if (size(film%frames) > 0) then
         call draw_rails(scene, film, text)
         call draw_plates(scene, film, text)
         call draw_wheels(scene, film, text)
         call draw_bars(scene, film, text)
         call draw_joints(scene, film, text)
         call draw_star(scene, film, text)
      end if
      call text%add('</svg>')
   end subroutine write_animation

   !> The longest stretch of the sweep on which every joint is known, over its end if the motion closes on itself.
   pure subroutine choose_frames(scene, film)
      type(scene_t), intent(in) :: scene
      type(film_t), intent(inout) :: film
      logical :: good(scene%sweep%n)
      integer, allocatable :: there(:)
      real(wp) :: shown
      integer :: n, i, length, first, longest, frames
      logical :: closed

      n = scene%sweep%n
      if (scene%time > 0.0_wp) then
         ! of a long motion the beginning
         shown = min(scene%time, real(most_times, wp)/fewest_a_second)
         n = 1 + nint(real(n - 1, wp)*(shown/scene%time))
         shown = scene%sweep%delt(n)
         frames = min(n, most_times, max(most_frames, nint(times_a_second*shown)))
         film%frames = [(1 + nint(real(i, wp)*real(n - 1, wp)/real(frames - 1, wp)), i=0, frames - 1)]
         film%timing = ' dur="'//short_number(shown, 5)//'s" repeatCount="indefinite"'
         return
      end if
      good = all(scene%sweep%known, 1) .and. within_positions(scene)
      closed = on_itself(scene, good)
      first = 1
      longest = 0
      length = 0
      ! once more round where the motion closes on itself
      do i = 1, merge(2*n, n, closed)
         length = merge(min(length + 1, n), 0, good(modulo(i - 1, n) + 1))
         if (length <= longest) cycle
         longest = length
         first = i - length + 1
      end do
      frames = min(longest, most_frames)
      if (closed .and. longest == n) then
         there = [(modulo(first - 1 + nint(real(i, wp)*real(n, wp)/real(frames, wp)), n) + 1, i=0, frames)]
      else
         there = [(nint(real(i, wp)*real(longest - 1, wp)/real(max(frames - 1, 1), wp)), i=0, frames - 1)]
         there = modulo(first - 1 + there, n) + 1
         if (frames > 1) there = [there, there(frames - 1:1:-1)]
      end if
      call move_alloc(there, film%frames)
      film%timing = ' dur="'//short_number(real(nint(10.0_wp*seconds_a_frame*real(size(film%frames), wp)), wp)/10.0_wp)// &
                    's" repeatCount="indefinite"'
   end subroutine choose_frames

   !> Positions of the sweep between those prescribed; all of them where these are few or go round.
   pure function within_positions(scene) result(within)
      type(scene_t), intent(in) :: scene
      logical :: within(scene%sweep%n)
      real(wp) :: low, span

      within = .true.
      if (scene%sliding .or. scene%prescribed%n < 3 .or. size(scene%sweep%delt) /= scene%sweep%n) return
      low = minval(scene%prescribed%delt)
      span = maxval(scene%prescribed%delt) - low
      if (span >= most_of_a_turn .or. span <= 0.0_wp) return
      within = modulo(scene%sweep%delt - low, full_turn) <= span
   end function within_positions

   !> From the last position the next step is the first one.
   pure logical function on_itself(scene, good)
      type(scene_t), intent(in) :: scene
      logical, intent(in) :: good(:)      !! shape (positions): every joint is known
      real(wp) :: longest, gap
      integer :: i, n

      n = scene%sweep%n
      on_itself = .false.
      if (n < 3) return
      if (.not. (good(1) .and. good(n))) return
      longest = 0.0_wp
      do i = 2, n
         if (good(i - 1) .and. good(i)) longest = max(longest, step(i - 1, i))
      end do
      gap = step(n, 1)
      on_itself = gap <= leap*longest .and. gap > 0.0_wp

   contains

      pure real(wp) function step(a, b)
         integer, intent(in) :: a, b

         step = maxval(abs(scene%sweep%x(:, a) - scene%sweep%x(:, b)) + abs(scene%sweep%y(:, a) - scene%sweep%y(:, b)))
      end function step
   end function on_itself

   ! ---- the parts ---------------------------------------------------------------------------------------------------

   subroutine draw_rails(scene, film, text)
      type(scene_t), intent(in) :: scene
      type(film_t), intent(in) :: film
      type(text_t), intent(inout) :: text
      type(text_t) :: values
      real(wp) :: ends(2, 2)
      integer :: s, i

      do s = 1, size(scene%slides)
         values = text_t()
         do i = 1, size(film%frames)
            ends = rail_ends(scene%sweep, scene%slides, s, film%frames(i))
            call values%add_text(between(i)//'M'//pixels_of(film, ends(:, 1))//'L'//pixels_of(film, ends(:, 2)))
         end do
         call add_moving('<path class="rail" stroke-width="1.5"', 'd', values%content(), film, text, '</path>')
      end do
   end subroutine draw_rails

   subroutine draw_plates(scene, film, text)
      type(scene_t), intent(in) :: scene
      type(film_t), intent(in) :: film
      type(text_t), intent(inout) :: text
      type(text_t) :: values
      integer :: b, i, m

      do b = 1, size(scene%bodies)
         associate (body => scene%bodies(b))
            if (size(body%hull) == 0 .or. body%frame) cycle
            values = text_t()
            do i = 1, size(film%frames)
               call values%add_text(between(i)//'M')
               do m = 1, size(body%hull)
                  if (m > 1) call values%add_text('L')
                  call values%add_text(joint_at(scene, film, body%hull(m), i))
               end do
               call values%add_text('Z')
            end do
            call add_moving('<path class="plate '//class_of(scene, b)//'" stroke-width="1.3"', 'd', values%content(), film, text, &
                            '</path>')
         end associate
      end do
   end subroutine draw_plates

   !> Pitch circles, and on each a line that turns with it.
   subroutine draw_wheels(scene, film, text)
      type(scene_t), intent(in) :: scene
      type(film_t), intent(in) :: film
      type(text_t), intent(inout) :: text
      integer :: w

      if (.not. allocated(scene%wheels)) return
      do w = 1, size(scene%wheels)
         associate (wheel => scene%wheels(w))
            call add_moving('<g class="wheel '//class_of(scene, wheel%body)//'" stroke-width="1.4"', 'transform', &
                            places(scene, film, wheel%centre), film, text, &
                            '<circle r="'//px(film%k*wheel%radius)//'"/></g>')
            call add_moving('<path class="wheel '//class_of(scene, wheel%body)//'" stroke-width="1.4"', 'd', &
                            lines(scene, film, wheel%centre, wheel%rim), film, text, '</path>')
         end associate
      end do
   end subroutine draw_wheels

   subroutine draw_bars(scene, film, text)
      type(scene_t), intent(in) :: scene
      type(film_t), intent(in) :: film
      type(text_t), intent(inout) :: text
      character(:), allocatable :: kind, dashes
      integer :: b

      do b = 1, size(scene%bars)
         associate (bar => scene%bars(b))
            if (bar%start == bar%finish) cycle
            kind = class_of(scene, bar%body)
            dashes = '" stroke-width="2.6"'
            if (kind == 'frame') dashes = '" stroke-width="1.5" stroke-dasharray="6 6"'
            call add_moving('<path class="bar '//kind//dashes, 'd', lines(scene, film, bar%start, bar%finish), film, text, &
                            '</path>')
            if (.not. bar%cylinder) cycle
            call add_moving('<path class="barrel '//kind//'" stroke-width="8"', 'd', barrel(bar%start, bar%finish, bar%barrel), &
                            film, text, '</path>')
         end associate
      end do

   contains

      !> The thick part of a cylinder.
      function barrel(start, finish, length) result(values)
         integer, intent(in) :: start, finish
         real(wp), intent(in) :: length
         character(:), allocatable :: values
         type(text_t) :: made
         real(wp) :: from(2), along(2)
         integer :: i

         do i = 1, size(film%frames)
            associate (f => film%frames(i), row => scene%sweep)
               from = [row%x(start, f), row%y(start, f)]
               along = [row%x(finish, f), row%y(finish, f)] - from
               if (norm2(along) > 0.0_wp) along = along*(length/norm2(along))
               call made%add_text(between(i)//'M'//pixels_of(film, from)//'L'//pixels_of(film, from + along))
            end associate
         end do
         values = made%content()
      end function barrel
   end subroutine draw_bars

   subroutine draw_joints(scene, film, text)
      type(scene_t), intent(in) :: scene
      type(film_t), intent(in) :: film
      type(text_t), intent(inout) :: text
      type(text_t) :: symbols
      character(:), allocatable :: size_
      integer :: j, s

      size_ = short_number(merge(crowded, 1.0_wp, size(scene%joints) > many))
      do j = 1, size(scene%joints)
         associate (joint => scene%joints(j))
            if (len(joint%name) == 0 .and. .not. joint%slides) cycle
            symbols = text_t()
            call symbols%add_text('<g transform="scale('//size_//' -'//size_//')">')
            if (joint%turning .and. joint%fixed) call symbols%add_text('<use href="#ground" class="symbol"/>')
            do s = 1, size(scene%slides)
               if (scene%slides(s)%block == j) call add_moving('<g', 'rotate', turns(s), film, symbols, &
                                                               '<use href="#prismatic" class="symbol"/></g>')
            end do
            if (joint%turning) call symbols%add_text('<use href="#revolute" class="symbol"/>')
            call add_moving('<g class="joint" stroke-width="1.6"', 'transform', places(scene, film, j), film, text, &
                            symbols%content()//'</g></g>')
         end associate
      end do

   contains

      !> Directions of a slide, degrees, without leaps of a turn.
      function turns(s) result(values)
         integer, intent(in) :: s
         character(:), allocatable :: values
         type(text_t) :: made
         real(wp) :: angle, before
         integer :: i

         before = 0.0_wp
         do i = 1, size(film%frames)
            angle = degrees_of(scene%sweep%ux(s, film%frames(i)), scene%sweep%uy(s, film%frames(i)))
            angle = angle - full_turn*anint((angle - before)/full_turn)
            call made%add_text(between(i)//px(angle))
            before = angle
         end do
         values = made%content()
      end function turns
   end subroutine draw_joints

   !> The output point, or a point of the output arc.
   subroutine draw_star(scene, film, text)
      type(scene_t), intent(in) :: scene
      type(film_t), intent(in) :: film
      type(text_t), intent(inout) :: text

      if (scene%output < 1) return
      call add_moving('<g', 'transform', places(scene, film, scene%output), film, text, &
                      '<use href="#star" class="actual" stroke="none" transform="scale(.8 -.8)"/></g>')
   end subroutine draw_star

   ! ---- values ------------------------------------------------------------------------------------------------------

   !> An element with one animated attribute: that of the first frame, and the values of all if they differ. `transform` is a
   !> translation, `rotate` a rotation; `d` a path.
   subroutine add_moving(start, attribute, values, film, text, rest)
      character(*), intent(in) :: start           !! the element, not closed
      character(*), intent(in) :: attribute
      character(*), intent(in) :: values          !! between semicolons
      type(film_t), intent(in) :: film
      type(text_t), intent(inout) :: text
      character(*), intent(in) :: rest            !! what follows the animation, with the end of the element
      character(:), allocatable :: first
      integer :: semicolon

      semicolon = index(values, ';')
      first = values
      if (semicolon > 0) first = values(:semicolon - 1)
      if (attribute == 'd') then
         call text%add_text(start//' d="'//first//'">')
      else if (attribute == 'rotate') then
         call text%add_text(start//' transform="rotate('//first//')">')
      else
         call text%add_text(start//' transform="translate('//first//')">')
      end if
      if (.not. same_throughout(values, first)) then
         select case (attribute)
         case ('d')
            call text%add_text('<animate attributeName="d"')
         case ('rotate')
            call text%add_text('<animateTransform attributeName="transform" type="rotate"')
         case default
            call text%add_text('<animateTransform attributeName="transform" type="translate"')
         end select
         call text%add_text(film%timing//' values="'//values//'"/>')
      end if
      call text%add(rest)
   end subroutine add_moving

   !> All values between the semicolons are this one.
   pure logical function same_throughout(values, first)
      character(*), intent(in) :: values, first
      integer :: i, length

      length = len(first) + 1
      same_throughout = modulo(len(values) + 1, length) == 0
      do i = length, len(values) - len(first), length
         if (.not. same_throughout) return
         same_throughout = values(i:i) == ';' .and. values(i + 1:i + len(first)) == first
      end do
   end function same_throughout

   !> Places of a joint.
   function places(scene, film, joint) result(values)
      type(scene_t), intent(in) :: scene
      type(film_t), intent(in) :: film
      integer, intent(in) :: joint
      character(:), allocatable :: values
      type(text_t) :: made
      integer :: i

      do i = 1, size(film%frames)
         call made%add_text(between(i)//joint_at(scene, film, joint, i))
      end do
      values = made%content()
   end function places

   !> Lines from one joint to another.
   function lines(scene, film, start, finish) result(values)
      type(scene_t), intent(in) :: scene
      type(film_t), intent(in) :: film
      integer, intent(in) :: start, finish
      character(:), allocatable :: values
      type(text_t) :: made
      integer :: i

      do i = 1, size(film%frames)
         call made%add_text(between(i)//'M'//joint_at(scene, film, start, i)//'L'//joint_at(scene, film, finish, i))
      end do
      values = made%content()
   end function lines

   pure function between(i) result(mark)
      integer, intent(in) :: i
      character(:), allocatable :: mark

      mark = ';'
      if (i == 1) mark = ''
   end function between

   pure function joint_at(scene, film, joint, frame) result(place)
      type(scene_t), intent(in) :: scene
      type(film_t), intent(in) :: film
      integer, intent(in) :: joint, frame
      character(:), allocatable :: place

      place = pixels_of(film, [scene%sweep%x(joint, film%frames(frame)), scene%sweep%y(joint, film%frames(frame))])
   end function joint_at

   !> A place in pixels to the tenth, downwards.
   pure function pixels_of(film, at) result(place)
      type(film_t), intent(in) :: film
      real(wp), intent(in) :: at(2)
      character(:), allocatable :: place

      place = tenths(film%ox + film%k*at(1))//' '//tenths(film%oy - film%k*at(2))
   end function pixels_of

   pure function tenths(value) result(text)
      real(wp), intent(in) :: value
      character(:), allocatable :: text

      text = short_number(real(nint(10.0_wp*value), wp)/10.0_wp)
   end function tenths
end module psalm_animation
