!> The group CURVE: what is wanted stands in a file. It becomes the positions and desired values of &METHOD.
!>
!> What follows the reading knows nothing of it: a case with &CURVE is the case with NDES, DELT, DESX ... written out, and device 7
!> writes them out.
module psalm_curve_group
   use psalm_angles, only: degrees_of
   use psalm_curve_file, only: curve_file_t, read_curve_file, what_path, what_function, what_poses, column_x, column_y, column_x2, &
                               column_y2, column_value, column_input, column_weight, column_vx, column_vy, columns_known
   use psalm_files, only: directory_of
   use psalm_group, only: group_t, item_t, value_t, add_item, add_value, out_of
   use psalm_kinds, only: wp, full_turn, half_turn
   use psalm_kinds_defaults, only: driven_by_cylinder
   use psalm_mark, only: mark_t
   use psalm_namelist, only: case_text_t
   use psalm_polyline, only: polyline_t, looks_closed, drop_repeats, find_corners, smooth, sample
   use psalm_rule, only: rule_t, a_flag, a_number, a_text, a_whole, a_word
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_number_format, only: number_words
   use psalm_text, only: full_precision, to_text
   implicit none (type, external)
   private
   public :: curve_items, expand_curve

   integer, parameter :: points_of_picture = 40   !! taken of an SVG path where NPTS is not given
   real(wp), parameter :: stiff = 1.0e-2_wp       !! relative change of the distance of two points of a body that is reported

   type :: curve_target_t
      character(:), allocatable :: file, id
      integer :: what = what_path, points = 0, closed = -1
      real(wp) :: units = 1.0_wp, smooth = 0.0_wp, corner = 30.0_wp, turn = 0.0_wp
      logical :: to_and_fro = .false.
      logical :: of_cylinder = .false.     !! &KINDS: a cylinder drives
   end type curve_target_t

   !> The items of the group.
   type(rule_t), parameter :: curve_items(*) = [ &
      rule_t('FILE', a_text, '1', '', 'required', '', &
             'name of a CSV file or SVG picture, counted from the directory of the case'), &
      rule_t('ID', a_text, '1', '', 'the only path', '', &
             'id of the path, polygon or polyline in an SVG picture'), &
      rule_t('WHAT', a_word, '', '', 'PATH', 'PATH FUNCTION POSES', &
             'what the file has: ''PATH'', points x, y; ''FUNCTION'', input and value; ''POSES'', two points x, y, x2, y2 '// &
             'of a body'), &
      rule_t('NPTS', a_whole, '', '', '0; 40 of a picture', '[0,10000]', &
             'points taken evenly by arc length, with one at every corner; of a function evenly by the input; 0: the '// &
             'points of the file'), &
      rule_t('CLOSED', a_whole, '', '', '-1', '[-1,1]', &
             'whether the curve closes: -1, found from its points (an SVG path says it by z), 0 no, 1 yes'), &
      rule_t('UNITS', a_number, '', '', '1', '(0,)', &
             'what lengths in the file are multiplied by'), &
      rule_t('SMOOTH', a_number, '', 'length', '0', '[0,)', &
             'points are averaged so far along the curve to either side, corners and ends kept; 0: not'), &
      rule_t('CORNER', a_number, '', 'degrees', '30', '(0,180]', &
             'a corner is where the curve turns by more than this at a point; 180: there are none'), &
      rule_t('TURN', a_number, '', 'degrees or length', '360; open 180; cylinder: size', '(-360,360]', &
             'how far the input goes over the curve, evenly, where the file has no column input and &METHOD no DELT'), &
      rule_t('TOFRO', a_flag, '', '', '0', '', &
             '1: an open curve is passed to its end and back, in one turn')]

contains

   !> Put the curve of a case into its &METHOD; the group is taken out of the case. `mark` is that of the file's text, not allocated
   !> if there is none.
   !>
   !> Errors: those of the file; values given here and in &METHOD; more corners than points.
   subroutine expand_curve(case, file, mark, findings)
      type(case_text_t), intent(inout) :: case
      character(*), intent(in) :: file              !! of the case
      character(:), allocatable, intent(out) :: mark
      type(diagnostics_t), intent(inout) :: findings
      type(group_t) :: group
      type(curve_target_t) :: target
      type(curve_file_t) :: curve
      type(polyline_t) :: line
      type(diagnostics_t) :: own, of_file
      type(mark_t) :: text
      character(:), allocatable :: own_file
      integer :: place, method

      call case%take('CURVE', group)
      if (group%line == 0) return
      place = findloc(case%groups(:case%count)%name == 'CURVE', .true., dim=1)
      case%groups(place:case%count - 1) = case%groups(place + 1:case%count)
      case%count = case%count - 1
      own%file = findings%file
      if (allocated(findings%prefix)) own%prefix = findings%prefix
      call read_target(group, target, own)
      call group%finish(case%groups(:case%count), own)
      call case%make('METHOD', group%line, method)
      if (own%failed()) then
         call findings%append(own)
         call fill_in(case%groups(method), group%line)
         return
      end if
      of_file%file = beside(file, target%file)
      if (is_result(file, of_file%file)) then
         call out_of(group, 'FILE', 'tables of the results have this name (CASE.csv, CASE-2.csv ...) and would replace it; '// &
                     'call the file otherwise', own)
         call findings%append(own)
         call fill_in(case%groups(method), group%line)
         return
      end if
      call read_curve_file(of_file%file, target%id, target%what, curve, of_file)
      if (allocated(curve%text)) then
         call text%add(curve%text)
         mark = text%name()
      end if
      if (of_file%count > 0) then
         ! reported for that file
         own_file = ''
         if (allocated(findings%file)) own_file = findings%file
         findings%file = of_file%file
         call findings%append(of_file)
         findings%file = own_file
      end if
      if (of_file%failed()) then
         call fill_in(case%groups(method), group%line)
         return
      end if
      call make_line(group, target, curve, line, own)
      target%of_cylinder = driven_by_cylinder(case)
      if (target%of_cylinder .and. line%closed .and. .not. own%failed()) call out_of(group, 'CLOSED', &
         'a cylinder takes the point back along the path it came by, so that it makes no closed curve; CLOSED=0 takes it as '// &
         'an open one, and a path to and fro is wanted one way (without TOFRO)', own)
      if (.not. own%failed()) call refuse_twice(case%groups(method), group, curve, own)
      if (own%failed()) then
         call fill_in(case%groups(method), group%line)
      else
         call write_positions(case%groups(method), group, target, curve, line, own)
      end if
      call findings%append(own)
   end subroutine expand_curve

   !> A position in place of those that could not be read, so that nothing is reported that follows from that.
   subroutine fill_in(method, line)
      type(group_t), intent(inout) :: method
      integer, intent(in) :: line

      if (has(method, 'NDES') .or. has(method, 'IKIN') .or. has(method, 'DELT')) return
      call add_item(method, item_t(name='NDES', line=line))
      call add_value(method, value_t(line=line), '1')
   end subroutine fill_in

   !> A name counted from the directory of the case.
   pure function beside(file, name) result(path)
      character(*), intent(in) :: file, name
      character(:), allocatable :: path

      path = name
      if (index(name, '/') == 1 .or. index(file, '/') == 0) return
      path = directory_of(file)//name
   end function beside

   !> True if a file has the name of a table that the programs write of the case: its name, perhaps with a number, and .csv.
   pure logical function is_result(file, path)
      character(*), intent(in) :: file, path
      character(*), parameter :: ending = '.csv', digits = '0123456789'
      character(:), allocatable :: between
      integer :: stem

      is_result = .false.
      stem = index(file, '.', back=.true.) - 1
      if (stem < index(file, '/', back=.true.) + 1) stem = len(file)
      if (len(path) < stem + len(ending)) return
      if (path(:stem) /= file(:stem) .or. path(len(path) - len(ending) + 1:) /= ending) return
      between = path(stem + 1:len(path) - len(ending))
      is_result = len(between) == 0
      if (len(between) > 1) is_result = between(1:1) == '-' .and. verify(between(2:), digits) == 0
   end function is_result

   subroutine read_target(group, target, findings)
      type(group_t), intent(inout) :: group
      type(curve_target_t), intent(inout) :: target
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: texts(:)

      call group%follow(curve_items)
      call group%get_texts('FILE', texts, findings)
      target%file = ''
      if (size(texts) > 0) target%file = trim(texts(1))
      call group%get_texts('ID', texts, findings)
      target%id = ''
      if (size(texts) > 0) target%id = trim(texts(1))
      call take(group, 'WHAT', target%what, findings)
      call take(group, 'NPTS', target%points, findings)
      call take(group, 'CLOSED', target%closed, findings)
      call take(group, 'UNITS', target%units, findings)
      call take(group, 'SMOOTH', target%smooth, findings)
      call take(group, 'CORNER', target%corner, findings)
      call take(group, 'TURN', target%turn, findings)
      call take(group, 'TOFRO', target%to_and_fro, findings)
      if (len(target%file) == 0) &
            call findings%error('names the file that has the curve', line=group%line, group='CURVE', item='FILE')
      if (target%points == 1) call out_of(group, 'NPTS', 'a curve has two points at least', findings)
   end subroutine read_target

   !> The points wanted.
   subroutine make_line(group, target, curve, line, findings)
      type(group_t), intent(in) :: group
      type(curve_target_t), intent(in) :: target
      type(curve_file_t), intent(in) :: curve
      type(polyline_t), intent(out) :: line
      type(diagnostics_t), intent(inout) :: findings
      type(polyline_t) :: sampled
      integer :: points, k, before, n
      logical :: fits

      line%at = curve%at
      line%at(:column_y2, :) = target%units*line%at(:column_y2, :)
      line%at([column_value, column_vx, column_vy], :) = target%units*line%at([column_value, column_vx, column_vy], :)
      points = target%points
      if (curve%of_picture .and. .not. group%given('NPTS')) points = points_of_picture
      if (len(target%id) > 0 .and. .not. curve%of_picture) call group%origins%warning(findings, 'CURVE', 'ID', &
         'has no effect: the file is no SVG picture')
      if (target%what == what_function) then
         call idle('CLOSED', 'of a function')
         call idle('SMOOTH', 'of a function')
         call idle('CORNER', 'of a function')
         call idle('TURN', 'of a function, whose file has the input')
         call idle('TOFRO', 'of a function')
         call make_function(group, points, line, findings)
         return
      end if
      if (target%what == what_poses) then
         line%coordinates = column_y2
         call doubt_body(line, findings)
      end if
      before = size(line%at, 2)
      if (target%closed == 1) then
         line%closed = .true.
      else if (target%closed < 0 .and. curve%of_picture) then
         line%closed = curve%closed
      else if (target%closed < 0) then
         line%closed = looks_closed(line)
      end if
      if (points > 0 .or. target%smooth > 0.0_wp) call drop_repeats(line)
      if (points == 0 .and. line%closed) then
         ! the first point once more is no position of its own
         n = size(line%at, 2)
         if (n > 2 .and. all(abs(line%at(:line%coordinates, n) - line%at(:line%coordinates, 1)) <= 0.0_wp)) &
            line%at = line%at(:, :n - 1)
      end if
      if (size(line%at, 2) < 2) then
         call findings%error('all '//to_text(before)//' points of the file are at one place', line=group%line, group='CURVE', &
                             item='FILE')
         return
      end if
      if (points > 0 .and. curve%has(column_input)) then
         do k = 2, size(line%at, 2)
            if (line%at(column_input, k) > line%at(column_input, k - 1) .eqv. &
                line%at(column_input, 2) > line%at(column_input, 1)) cycle
            call out_of(group, 'NPTS', 'points can be taken evenly only where the input goes one way; at point '//to_text(k)// &
                        ' it turns round', findings)
            return
         end do
      end if
      call find_corners(line, target%corner)
      if (target%smooth > 0.0_wp) call smooth(line, target%smooth)
      if (points > 0) then
         if (line%closed .and. curve%has(column_input)) then
            ! the way back to the first point has no input
            line%closed = .false.
         end if
         call sample(line, points, sampled, fits)
         if (.not. fits) then
            call out_of(group, 'NPTS', to_text(points)//' points are too few: the curve has '//to_text(count(line%corner))// &
                        ' corners, each of which takes one point; see CORNER', findings)
            return
         end if
         line = sampled
      end if
      if (target%to_and_fro) then
         if (line%closed) then
            call out_of(group, 'TOFRO', 'a closed curve comes back by itself; it is for open ones (CLOSED=0)', findings)
            return
         end if
         if (curve%has(column_input)) then
            call out_of(group, 'TOFRO', 'the file has the input of every point; leave TOFRO or that column out', findings)
            return
         end if
         n = size(line%at, 2)
         line%at = line%at(:, [(k, k=1, n), (k, k=n - 1, 2, -1)])
         line%closed = .true.
      end if

   contains

      subroutine idle(item, of_what)
         character(*), intent(in) :: item, of_what

         if (group%given(item)) call group%origins%warning(findings, 'CURVE', item, 'has no effect: the file is '//of_what)
      end subroutine idle
   end subroutine make_line

   !> Two points of a body keep their distance.
   subroutine doubt_body(line, findings)
      type(polyline_t), intent(in) :: line
      type(diagnostics_t), intent(inout) :: findings
      real(wp), allocatable :: distance(:)

      distance = sqrt((line%at(column_x2, :) - line%at(column_x, :))**2 + (line%at(column_y2, :) - line%at(column_y, :))**2)
      if (.not. minval(distance) > 0.0_wp) then
         call findings%error('at pose '//to_text(minloc(distance, dim=1))//' both points of the body are at one place; its '// &
                             'angle is that from the first to the second')
      else if (maxval(distance) > (1.0_wp + stiff)*minval(distance)) then
         call findings%warning('the two points of the body are from '//number_words(minval(distance))//' to '// &
                               number_words(maxval(distance))//' apart; the first one and the angle are wanted')
      end if
   end subroutine doubt_body

   !> Points of a function evenly by its input.
   subroutine make_function(group, points, line, findings)
      type(group_t), intent(in) :: group
      integer, intent(in) :: points               !! 0: as they are
      type(polyline_t), intent(inout) :: line
      type(diagnostics_t), intent(inout) :: findings
      real(wp), allocatable :: at(:, :)
      real(wp) :: input, part
      integer :: n, k, j

      if (points == 0) return
      n = size(line%at, 2)
      associate (x => line%at(column_input, :))
         do k = 2, n
            if (abs(x(k) - x(k - 1)) > 0.0_wp .and. (x(k) > x(k - 1) .eqv. x(2) > x(1))) cycle
            call out_of(group, 'NPTS', 'points can be taken evenly only where the input goes one way; at point '//to_text(k)// &
                        ' it turns round or stands', findings)
            return
         end do
         allocate (at(columns_known, points))
         j = 1
         do k = 1, points
            input = x(1) + (x(n) - x(1))*real(k - 1, wp)/real(points - 1, wp)
            do while (j < n - 1)
               if (abs(x(j + 1) - x(1)) >= abs(input - x(1))) exit
               j = j + 1
            end do
            part = min(max((input - x(j))/(x(j + 1) - x(j)), 0.0_wp), 1.0_wp)
            at(:, k) = (1.0_wp - part)*line%at(:, j) + part*line%at(:, j + 1)
         end do
      end associate
      line%at = at
   end subroutine make_function

   !> True if the group has the item, whether its items are sorted or not.
   pure logical function has(group, name)
      type(group_t), intent(in) :: group
      character(*), intent(in) :: name

      has = any(group%items(:group%count)%name == name)
   end function has

   !> What the file says is not said in &METHOD too.
   subroutine refuse_twice(method, group, curve, findings)
      type(group_t), intent(in) :: method, group
      type(curve_file_t), intent(in) :: curve
      type(diagnostics_t), intent(inout) :: findings
      character(*), parameter :: always(*) = [character(6) :: 'NDES', 'DESX', 'DESY', 'DESANG', 'IKIN'], &
                                 weights(*) = [character(6) :: 'XMULT', 'YMULT', 'ANMULT'], &
                                 rates(*) = [character(6) :: 'DVELX', 'DVELY']
      integer :: k

      do k = 1, size(always)
         if (has(method, trim(always(k)))) call reported(trim(always(k)))
      end do
      do k = 1, size(weights)
         if (curve%has(column_weight) .and. has(method, trim(weights(k)))) call reported(trim(weights(k)))
      end do
      do k = 1, size(rates)
         if (curve%has(column_vx) .and. has(method, trim(rates(k)))) call reported(trim(rates(k)))
      end do
      if (curve%has(column_input) .and. has(method, 'DELT')) call reported('DELT')
      if (has(method, 'DELT') .and. group%given('TURN')) call out_of(group, 'TURN', &
         'is how far the input goes, and DELT of &METHOD says it too; leave one of both out', findings)

   contains

      subroutine reported(item)
         character(*), intent(in) :: item
         integer :: at

         at = method%items(findloc(method%items(:method%count)%name == item, .true., dim=1))%line
         call findings%error('the positions and what is wanted there come from the file of &CURVE; leave '//item//' out', &
                             line=at, group='METHOD', item=item)
      end subroutine reported
   end subroutine refuse_twice

   !> The items of &METHOD.
   subroutine write_positions(method, group, target, curve, line, findings)
      type(group_t), intent(inout) :: method
      type(group_t), intent(in) :: group
      type(curve_target_t), intent(in) :: target
      type(curve_file_t), intent(in) :: curve
      type(polyline_t), intent(in) :: line
      type(diagnostics_t), intent(inout) :: findings
      real(wp), allocatable :: inputs(:), angles(:)
      real(wp) :: turn
      integer :: n, k

      n = size(line%at, 2)
      call add_item(method, item_t(name='NDES', line=group%line))
      call add_value(method, value_t(line=group%line), to_text(n))
      if (curve%has(column_input)) then
         call put('DELT', line%at(column_input, :))
         if (group%given('TURN')) call group%origins%warning(findings, 'CURVE', 'TURN', 'has no effect: the file has the input '// &
                                                              'of every point')
      else if (.not. has(method, 'DELT')) then
         turn = merge(full_turn, half_turn, line%closed)
         if (target%of_cylinder) turn = maxval([maxval(line%at(column_x, :)) - minval(line%at(column_x, :)), &
                                              maxval(line%at(column_y, :)) - minval(line%at(column_y, :))])
         if (group%given('TURN')) turn = target%turn
         inputs = [(turn*real(k - 1, wp)/real(merge(n, n - 1, line%closed), wp), k=1, n)]
         call put('DELT', inputs)
      end if
      select case (target%what)
      case (what_function)
         call put('DESANG', line%at(column_value, :))
         if (curve%has(column_weight)) call put('ANMULT', line%at(column_weight, :))
         return
      case (what_poses)
         angles = degrees_of(line%at(column_x2, :) - line%at(column_x, :), line%at(column_y2, :) - line%at(column_y, :))
         do k = 2, n
            angles(k) = angles(k) - full_turn*anint((angles(k) - angles(k - 1))/full_turn)
         end do
         call put('DESANG', angles)
         if (curve%has(column_weight)) call put('ANMULT', line%at(column_weight, :))
      end select
      call put('DESX', line%at(column_x, :))
      call put('DESY', line%at(column_y, :))
      if (curve%has(column_weight)) then
         call put('XMULT', line%at(column_weight, :))
         call put('YMULT', line%at(column_weight, :))
      end if
      if (curve%has(column_vx)) then
         call put('DVELX', line%at(column_vx, :))
         call put('DVELY', line%at(column_vy, :))
      end if

   contains

      subroutine put(name, values)
         character(*), intent(in) :: name
         real(wp), intent(in) :: values(:)
         integer :: i

         call add_item(method, item_t(name=name, line=group%line))
         do i = 1, size(values)
            call add_value(method, value_t(line=group%line), trim(adjustl(full_precision(values(i)))))
         end do
      end subroutine put
   end subroutine write_positions
end module psalm_curve_group
