!> A path of an SVG picture as points: all path commands, polygons, transforms of the path and of the groups it stands in.
!>
!> Curves become chords that leave them by no more than a part of the path's size: a curve whose second derivative by its parameter
!> is at most M leaves the chord over a step h of the parameter by at most M h**2/8. The y axis of SVG points down; it is
!> turned up here. Source: W3C, Scalable Vector Graphics (SVG) 1.1, chapters 7 and 8 and appendix F.6.
module psalm_svg_path
   use psalm_angles, only: unit_vector, degrees_of
   use psalm_kinds, only: wp, degrees_per_radian, full_turn, half_turn
   use psalm_number, only: parse_real
   use psalm_text, only: lower_case, shortened, to_text
   implicit none (type, external)
   private
   public :: read_svg_path

   real(wp), parameter :: fineness = 1.0e-4_wp    !! of the path's size: chords leave the curve by no more
   integer, parameter :: most_chords = 1000       !! of one curve
   integer, parameter :: most_levels = 200        !! of elements within elements
   character, parameter :: tab = achar(9), line_feed = achar(10), carriage_return = achar(13)
   character(*), parameter :: blanks = ' '//tab//line_feed//carriage_return
   character(*), parameter :: commands = 'MmLlHhVvCcSsQqTtAaZz'

   !> x' = a x + c y + e, y' = b x + d y + f.
   type :: transform_t
      real(wp) :: a = 1.0_wp, b = 0.0_wp, c = 0.0_wp, d = 1.0_wp, e = 0.0_wp, f = 0.0_wp
   end type transform_t

   !> The points so far.
   type :: pen_t
      real(wp), allocatable :: points(:, :)       !! shape (2, capacity)
      integer :: count = 0
      integer :: lines = 0                        !! lines with at least one piece
      integer :: pieces = 0                       !! of the present line
      logical :: closed = .false.
      real(wp) :: tolerance = 1.0e-3_wp*huge(1.0_wp)
   end type pen_t

contains

   !> The points of the path with that id; without one, of the only path. Errors: `failure` says what is wrong, empty if nothing.
   subroutine read_svg_path(text, id, points, closed, failure)
      character(*), intent(in) :: text            !! of the file
      character(*), intent(in) :: id              !! blank: any
      real(wp), allocatable, intent(out) :: points(:, :) !! shape (2, points), y up
      logical, intent(out) :: closed
      character(:), allocatable, intent(out) :: failure
      type(transform_t) :: transform
      character(:), allocatable :: name, details, path
      type(pen_t) :: pen
      real(wp) :: size

      closed = .false.
      allocate (points(2, 0))
      call find_element(text, id, name, details, transform, failure)
      if (len(failure) > 0) return
      if (name == 'path') then
         call take_attribute(details, 'd', path)
         if (verify(path, blanks) == 0) then
            failure = 'the path has no points (its d is empty)'
            return
         end if
      else
         call take_attribute(details, 'points', path)
         path = 'M'//path
         if (name == 'polygon') path = path//'Z'
      end if
      allocate (pen%points(2, 64))
      call draw(path, transform, pen, failure)
      if (len(failure) > 0) return
      associate (x => pen%points(1, :pen%count), y => pen%points(2, :pen%count))
         size = max(maxval(x) - minval(x), maxval(y) - minval(y))
      end associate
      pen%tolerance = fineness*size
      pen%count = 0
      pen%lines = 0
      pen%pieces = 0
      call draw(path, transform, pen, failure)
      if (len(failure) > 0) return
      if (pen%lines > 1) then
         failure = 'the path has '//to_text(pen%lines)//' separate lines; a curve is one: break it apart and give '// &
                   'the ID of one'
         return
      end if
      points = pen%points(:, :pen%count)
      points(2, :) = -points(2, :)
      closed = pen%closed
   end subroutine read_svg_path

   ! ---- elements ----------------------------------------------------------------------------------------------------

   !> The element wanted, its details and the transform it is seen by.
   pure subroutine find_element(text, id, name, details, transform, failure)
      character(*), intent(in) :: text, id
      character(:), allocatable, intent(out) :: name, details, failure
      type(transform_t), intent(out) :: transform
      type(transform_t) :: levels(0:most_levels), own
      character(:), allocatable :: tag, value, label, ids, all_ids
      integer :: at, last, level, found, past_name

      name = ''
      details = ''
      failure = ''
      ids = ''
      all_ids = ''
      level = 0
      found = 0
      at = 1
      if (index(text, '<svg') == 0 .and. index(text, ':svg') == 0) then
         failure = 'this is no SVG picture (there is no <svg> in it)'
         return
      end if
      do
         last = index(text(at:), '<')
         if (last == 0) exit
         at = at + last - 1
         if (starts(text, at, '<!--')) then
            last = index(text(at:), '-->')
         else if (starts(text, at, '<![CDATA[')) then
            last = index(text(at:), ']]>')
         else
            last = index(text(at:), '>')
         end if
         if (last == 0) then
            failure = 'the text ends within an element'
            return
         end if
         tag = text(at + 1:at + last - 2)
         at = at + last
         if (len(tag) == 0) cycle
         if (scan(tag(1:1), '!?') == 1) cycle
         if (tag(1:1) == '/') then
            level = max(0, level - 1)
            cycle
         end if
         past_name = scan(tag, blanks//'/')
         if (past_name == 0) past_name = len(tag) + 1
         label = tag(index(tag(:past_name - 1), ':') + 1:past_name - 1)
         call take_attribute(tag(past_name:), 'transform', value)
         call read_transform(value, own, failure)
         call take_attribute(tag(past_name:), 'id', value)
         if (len(failure) > 0) then
            failure = failure//' (element '//label//' '//shortened(value)//')'
            return
         end if
         own = product_of(levels(level), own)
         if (len(id) > 0 .and. value == id) then
            if (all(label /= [character(8) :: 'path', 'polygon', 'polyline'])) then
               failure = "'"//id//"' is no path but a "//label//'; make it a path (in a drawing program: object to path)'
               return
            end if
            found = 1
            name = label
            details = tag(past_name:)
            transform = own
            return
         end if
         if (any(label == [character(8) :: 'path', 'polygon', 'polyline'])) then
            if (len(all_ids) < 200) all_ids = all_ids//', '//value
            if (len(id) == 0) then
               found = found + 1
               name = label
               details = tag(past_name:)
               transform = own
            end if
         end if
         if (tag(len(tag):) == '/') cycle
         if (level == most_levels) then
            failure = 'more than '//to_text(most_levels)//' elements stand within each other'
            return
         end if
         level = level + 1
         levels(level) = own
      end do
      if (found == 1) return
      if (len(all_ids) == 0) then
         failure = 'there is no path in the picture'
      else if (found == 0) then
         failure = "there is no path with the ID '"//id//"'; there are "//all_ids(3:)
      else
         failure = 'there are '//to_text(found)//' paths; say by ID which is wanted: '//all_ids(3:)
      end if
   end subroutine find_element

   pure logical function starts(text, at, word)
      character(*), intent(in) :: text, word
      integer, intent(in) :: at

      starts = .false.
      if (at + len(word) - 1 <= len(text)) starts = text(at:at + len(word) - 1) == word
   end function starts

   !> Value of an attribute, empty if it is not there.
   pure subroutine take_attribute(details, name, value)
      character(*), intent(in) :: details, name
      character(:), allocatable, intent(out) :: value
      character(:), allocatable :: label
      integer :: at, from, past
      character :: quote

      value = ''
      at = 1
      do
         from = index(details(at:), '=')
         if (from == 0) return
         from = at + from - 1
         past = from + verify(details(from + 1:)//'x', blanks)
         if (past > len(details)) return
         quote = details(past:past)
         if (quote /= '"' .and. quote /= "'") return
         past = index(details(past + 1:), quote) + past
         if (past <= from + 1) return
         label = trimmed(details(at:from - 1))
         if (label == name) then
            value = details(from + scan(details(from + 1:), quote) + 1:past - 1)
            return
         end if
         at = past + 1
         if (at > len(details)) return
      end do
   end subroutine take_attribute

   !> Without blanks of any kind at either end.
   pure function trimmed(text) result(word)
      character(*), intent(in) :: text
      character(:), allocatable :: word
      integer :: first

      first = verify(text, blanks)
      word = ''
      if (first > 0) word = text(first:verify(text, blanks, back=.true.))
   end function trimmed

   ! ---- transforms --------------------------------------------------------------------------------------------------

   !> First `inner`, then `outer`.
   pure type(transform_t) function product_of(outer, inner) result(both)
      type(transform_t), intent(in) :: outer, inner

      both%a = outer%a*inner%a + outer%c*inner%b
      both%b = outer%b*inner%a + outer%d*inner%b
      both%c = outer%a*inner%c + outer%c*inner%d
      both%d = outer%b*inner%c + outer%d*inner%d
      both%e = outer%a*inner%e + outer%c*inner%f + outer%e
      both%f = outer%b*inner%e + outer%d*inner%f + outer%f
   end function product_of

   !> matrix, translate, scale, rotate, skewX and skewY, the last one first on the point.
   pure subroutine read_transform(text, transform, failure)
      character(*), intent(in) :: text
      type(transform_t), intent(out) :: transform
      character(:), allocatable, intent(out) :: failure
      type(transform_t) :: one, back
      character(:), allocatable :: word
      real(wp), allocatable :: p(:)
      real(wp) :: cosine, sine
      logical :: valid
      integer :: at, bracket, past

      failure = ''
      at = 1
      do
         if (at > len(text)) return
         if (verify(text(at:), blanks//',') == 0) return
         bracket = index(text(at:), '(')
         past = index(text(at:), ')')
         if (bracket == 0 .or. past < bracket) then
            failure = "the transform '"//shortened(text)//"' is not understood"
            return
         end if
         word = trimmed(text(at:at + bracket - 2))
         if (index(word, ',') == 1) word = trimmed(word(2:))
         call read_numbers(text(at + bracket:at + past - 2), p, valid)
         at = at + past
         one = transform_t()
         select case (word)
         case ('matrix')
            valid = valid .and. size(p) == 6
            if (valid) one = transform_t(p(1), p(2), p(3), p(4), p(5), p(6))
         case ('translate')
            valid = valid .and. (size(p) == 1 .or. size(p) == 2)
            if (valid) one%e = p(1)
            if (valid .and. size(p) == 2) one%f = p(2)
         case ('scale')
            valid = valid .and. (size(p) == 1 .or. size(p) == 2)
            if (valid) one%a = p(1)
            if (valid) one%d = p(size(p))
         case ('rotate')
            valid = valid .and. (size(p) == 1 .or. size(p) == 3)
            if (valid) then
               call unit_vector(p(1), cosine, sine)
               one = transform_t(cosine, sine, -sine, cosine, 0.0_wp, 0.0_wp)
               if (size(p) == 3) then
                  back = transform_t()
                  back%e = -p(2)
                  back%f = -p(3)
                  one%e = p(2)
                  one%f = p(3)
                  one = product_of(one, back)
               end if
            end if
         case ('skewX', 'skewY')
            valid = valid .and. size(p) == 1
            if (valid) then
               call unit_vector(p(1), cosine, sine)
               valid = abs(cosine) > 0.0_wp
            end if
            if (valid .and. word == 'skewX') one%c = sine/cosine
            if (valid .and. word == 'skewY') one%b = sine/cosine
         case default
            valid = .false.
         end select
         if (.not. valid) then
            failure = "the transform '"//shortened(text)//"' is not understood"
            return
         end if
         transform = product_of(transform, one)
      end do
   end subroutine read_transform

   pure subroutine read_numbers(text, numbers, valid)
      character(*), intent(in) :: text
      real(wp), allocatable, intent(out) :: numbers(:)
      logical, intent(out) :: valid
      real(wp) :: number
      integer :: at

      allocate (numbers(0))
      valid = .true.
      at = 1
      do while (more(text, at))
         call next_number(text, at, number, valid)
         if (.not. valid) return
         numbers = [numbers, number]
      end do
   end subroutine read_numbers

   !> Is there more than blanks and commas from `at` on?
   pure logical function more(text, at)
      character(*), intent(in) :: text
      integer, intent(in) :: at

      more = .false.
      if (at <= len(text)) more = verify(text(at:), blanks//',') > 0
   end function more

   !> Read the number at `at`, blanks and a comma before it left out. Numbers may follow each other without a blank: 1.5.5-2 is
   !> three.
   pure subroutine next_number(text, at, number, valid)
      character(*), intent(in) :: text
      integer, intent(inout) :: at
      real(wp), intent(out) :: number
      logical, intent(out) :: valid
      character(:), allocatable :: reason
      integer :: first
      logical :: point

      number = 0.0_wp
      valid = more(text, at)
      if (.not. valid) return
      at = at + verify(text(at:), blanks//',') - 1
      first = at
      if (scan(text(at:at), '+-') == 1) at = at + 1
      point = .false.
      do while (at <= len(text))
         if (text(at:at) == '.') then
            if (point) exit
            point = .true.
         else if (verify(text(at:at), '0123456789') > 0) then
            exit
         end if
         at = at + 1
      end do
      if (at < len(text)) then
         if (scan(text(at:at), 'eE') == 1 .and. verify(text(at + 1:at + 1), '+-0123456789') == 0) then
            at = at + 2
            do while (at <= len(text))
               if (verify(text(at:at), '0123456789') > 0) exit
               at = at + 1
            end do
         end if
      end if
      call parse_real(text(first:at - 1), number, valid, reason)
   end subroutine next_number

   ! ---- drawing -----------------------------------------------------------------------------------------------------

   !> Follow the commands.
   subroutine draw(path, transform, pen, failure)
      character(*), intent(in) :: path
      type(transform_t), intent(in) :: transform
      type(pen_t), intent(inout) :: pen
      character(:), allocatable, intent(out) :: failure
      real(wp) :: here(2), first(2), before(2), p(7)
      character :: command, small, last
      logical :: valid, begun
      integer :: at

      failure = ''
      here = 0.0_wp
      first = 0.0_wp
      before = 0.0_wp
      command = ' '
      last = ' '
      begun = .false.
      pen%closed = .false.
      at = 1
      do while (more(path, at))
         at = at + verify(path(at:), blanks//',') - 1
         if (scan(path(at:at), commands) == 1) then
            command = path(at:at)
            at = at + 1
         else if (verify(path(at:at), '+-.0123456789') > 0 .or. command == ' ' .or. scan(command, 'Zz') == 1) then
            failure = "the path has the command '"//path(at:at)//"', which is none of "//commands
            return
         end if
         if (last == ' ' .and. scan(command, 'Mm') == 0) then
            failure = 'the path does not begin with M'
            return
         end if
         small = lower_case(command)
         p = 0.0_wp
         call take(numbers_of(small))
         if (.not. valid) then
            failure = 'the path has too few numbers, or what is no number, behind '//command
            return
         end if
         if (small == command) call shift()
         select case (small)
         case ('m')
            here = p(:2)
            first = here
            pen%pieces = 0
            begun = .false.
            ! what follows M without a command is drawn
            command = merge('l', 'L', command == 'm')
            last = 'm'
            before = here
            cycle
         case ('z')
            if (norm2(here - first) > 0.0_wp) call line_to(first)
            if (pen%pieces > 0) pen%closed = .true.
            here = first
            begun = .false.
            pen%pieces = 0
         case ('h')
            call line_to([p(1), here(2)])
         case ('v')
            call line_to([here(1), p(2)])
         case ('l')
            call line_to(p(:2))
         case ('c')
            call cubic(p(1:2), p(3:4), p(5:6))
            before = p(3:4)
         case ('s')
            if (scan(last, 'cs') == 0) before = here
            call cubic(2.0_wp*here - before, p(1:2), p(3:4))
            before = p(1:2)
         case ('q')
            call quadratic(p(1:2), p(3:4))
            before = p(1:2)
         case ('t')
            if (scan(last, 'qt') == 0) before = here
            before = 2.0_wp*here - before
            call quadratic(before, p(1:2))
         case ('a')
            call arc(p(1), p(2), p(3), p(4) > 0.5_wp, p(5) > 0.5_wp, p(6:7))
         end select
         last = small
      end do
      if (pen%count < 2 .and. len(failure) == 0) failure = 'the path has fewer than two points'

   contains

      pure integer function numbers_of(letter)
         character, intent(in) :: letter
         character(*), parameter :: letters = 'zhvmltsqca'
         integer, parameter :: numbers(len(letters)) = [0, 1, 1, 2, 2, 2, 4, 4, 6, 7]

         numbers_of = numbers(index(letters, letter))
      end function numbers_of

      !> The numbers of a command; flags of an arc may stand without blanks. That of v is y.
      subroutine take(count)
         integer, intent(in) :: count
         integer :: k

         valid = .true.
         do k = 1, count
            if (small == 'a' .and. (k == 4 .or. k == 5)) then
               valid = more(path, at)
               if (valid) then
                  at = at + verify(path(at:), blanks//',') - 1
                  valid = scan(path(at:at), '01') == 1
                  if (path(at:at) == '1') p(k) = 1.0_wp
                  at = at + 1
               end if
            else
               call next_number(path, at, p(k), valid)
            end if
            if (.not. valid) return
         end do
         if (small == 'v') p(2) = p(1)
      end subroutine take

      !> Make relative coordinates absolute.
      subroutine shift()
         integer :: k

         select case (small)
         case ('h')
            p(1) = p(1) + here(1)
         case ('v')
            p(2) = p(2) + here(2)
         case ('a')
            p(6:7) = p(6:7) + here
         case default
            do k = 1, numbers_of(small), 2
               p(k:k + 1) = p(k:k + 1) + here
            end do
         end select
      end subroutine shift

      subroutine line_to(to)
         real(wp), intent(in) :: to(2)

         call put(to)
         here = to
      end subroutine line_to

      !> Put a point; the first of a line is put with it.
      subroutine put(point)
         real(wp), intent(in) :: point(2)

         if (.not. begun) then
            pen%lines = pen%lines + 1
            begun = .true.
            call add(here)
         end if
         pen%pieces = pen%pieces + 1
         call add(point)
      end subroutine put

      subroutine add(point)
         real(wp), intent(in) :: point(2)
         real(wp), allocatable :: larger(:, :)

         if (pen%count == size(pen%points, 2)) then
            allocate (larger(2, 2*pen%count))
            larger(:, :pen%count) = pen%points
            call move_alloc(larger, pen%points)
         end if
         pen%count = pen%count + 1
         pen%points(:, pen%count) = [transform%a*point(1) + transform%c*point(2) + transform%e, &
                                     transform%b*point(1) + transform%d*point(2) + transform%f]
      end subroutine add

      !> Chords for a curve whose second derivative is at most so long before the transform.
      pure integer function chords(second)
         real(wp), intent(in) :: second
         real(wp) :: stretch

         stretch = max(abs(transform%a) + abs(transform%c), abs(transform%b) + abs(transform%d))
         chords = 1
         if (pen%tolerance > 0.0_wp) &
            chords = max(1, ceiling(min(sqrt(stretch*second/(8.0_wp*pen%tolerance)), real(most_chords, wp))))
      end function chords

      subroutine cubic(a, b, to)
         real(wp), intent(in) :: a(2), b(2), to(2)
         real(wp) :: from(2), t, u
         integer :: k, pieces

         from = here
         pieces = chords(6.0_wp*max(norm2(from - 2.0_wp*a + b), norm2(a - 2.0_wp*b + to)))
         do k = 1, pieces
            t = real(k, wp)/real(pieces, wp)
            u = 1.0_wp - t
            if (k < pieces) call put(u**3*from + 3.0_wp*u**2*t*a + 3.0_wp*u*t**2*b + t**3*to)
         end do
         call line_to(to)
      end subroutine cubic

      subroutine quadratic(a, to)
         real(wp), intent(in) :: a(2), to(2)
         real(wp) :: from(2), t, u
         integer :: k, pieces

         from = here
         pieces = chords(2.0_wp*norm2(from - 2.0_wp*a + to))
         do k = 1, pieces
            t = real(k, wp)/real(pieces, wp)
            u = 1.0_wp - t
            if (k < pieces) call put(u**2*from + 2.0_wp*u*t*a + t**2*to)
         end do
         call line_to(to)
      end subroutine quadratic

      !> An elliptic arc from its ends to its centre (F.6.5); radii that are too small are enlarged (F.6.6).
      subroutine arc(rx_given, ry_given, turn, large, sweep, to)
         real(wp), intent(in) :: rx_given, ry_given, turn, to(2)
         logical, intent(in) :: large, sweep
         real(wp) :: rx, ry, c, s, middle(2), half(2), q, root, own(2), centre(2), from_angle, span, cosine, sine
         integer :: k, pieces

         rx = abs(rx_given)
         ry = abs(ry_given)
         if (.not. norm2(to - here) > 0.0_wp) return
         if (.not. (rx > 0.0_wp .and. ry > 0.0_wp)) then
            call line_to(to)
            return
         end if
         call unit_vector(turn, c, s)
         middle = 0.5_wp*(here - to)
         half = [c*middle(1) + s*middle(2), -s*middle(1) + c*middle(2)]
         q = (half(1)/rx)**2 + (half(2)/ry)**2
         if (q > 1.0_wp) then
            rx = sqrt(q)*rx
            ry = sqrt(q)*ry
            q = 1.0_wp
         end if
         root = sqrt(max(1.0_wp/q - 1.0_wp, 0.0_wp))
         if (large .eqv. sweep) root = -root
         own = root*[rx*half(2)/ry, -ry*half(1)/rx]
         centre = [c*own(1) - s*own(2), s*own(1) + c*own(2)] + 0.5_wp*(here + to)
         from_angle = degrees_of((half(1) - own(1))/rx, (half(2) - own(2))/ry)
         span = degrees_of((-half(1) - own(1))/rx, (-half(2) - own(2))/ry) - from_angle
         if (sweep .and. span < 0.0_wp) span = span + full_turn
         if (.not. sweep .and. span > 0.0_wp) span = span - full_turn
         ! half an ellipse may come out as either half: rounding decides, and the flag must
         if (abs(abs(span) - half_turn) < 1.0e-9_wp) span = merge(half_turn, -half_turn, sweep)
         pieces = max(chords(max(rx, ry)*(span/degrees_per_radian)**2), 4)
         do k = 1, pieces - 1
            call unit_vector(from_angle + span*real(k, wp)/real(pieces, wp), cosine, sine)
            own = [rx*cosine, ry*sine]
            call put(centre + [c*own(1) - s*own(2), s*own(1) + c*own(2)])
         end do
         call line_to(to)
      end subroutine arc
   end subroutine draw
end module psalm_svg_path
