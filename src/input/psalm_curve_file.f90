!> Files that a curve is wanted by: points, a function, poses, as CSV or as a path of an SVG picture.
!>
!> CSV: numbers with commas, semicolons, tabs or blanks between them, a line for each point. With semicolons a comma is a decimal
!> point. A first line of words names the columns; without one they stand in their usual order. Lines that begin with # or ! are
!> comments.
module psalm_curve_file
   use psalm_kinds, only: wp
   use psalm_number, only: parse_real
   use psalm_source, only: line_t, read_lines
   use psalm_status, only: diagnostics_t
   use psalm_svg_path, only: read_svg_path
   use psalm_text, only: lower_case, nearest_name, shortened, to_text, text_t
   implicit none (type, external)
   private
   public :: curve_file_t, read_curve_file
   public :: what_path, what_function, what_poses
   public :: column_x, column_y, column_x2, column_y2, column_value, column_input, column_weight, column_vx, column_vy
   public :: columns_known

   ! WHAT: what the file has
   integer, parameter :: what_path = 1        !! points
   integer, parameter :: what_function = 2    !! values of an input
   integer, parameter :: what_poses = 3       !! two points of a body

   integer, parameter :: column_x = 1, column_y = 2, column_x2 = 3, column_y2 = 4, column_value = 5, column_input = 6, &
                         column_weight = 7, column_vx = 8, column_vy = 9, columns_known = 9
   integer, parameter :: name_length = 8
   !> Names of columns, as they may be called by what the file has; the first two of poses are x1 and y1, too.
   character(name_length), parameter :: names(columns_known) = [character(name_length) :: 'x', 'y', 'x2', 'y2', 'value', 'input', &
                                                              'weight', 'vx', 'vy']
   integer, parameter :: most_points = 100000
   character(*), parameter :: between = ' '//achar(9)
   character, parameter :: carriage_return = achar(13)

   !> What is in a file.
   type :: curve_file_t
      real(wp), allocatable :: at(:, :)       !! shape (columns_known, points)
      logical :: has(columns_known) = .false. !! the columns that are there
      logical :: of_picture = .false.         !! an SVG path, which says itself whether it closes
      logical :: closed = .false.             !! it does
      character(:), allocatable :: text       !! of the file
   end type curve_file_t

contains

   !> Read it. Errors, with the file and line they are in: one that is missing or empty, a number that is none, columns that are
   !> missing or unknown, fewer than two points, more than most_points; of an SVG those of the path.
   subroutine read_curve_file(path, id, what, curve, findings)
      character(*), intent(in) :: path
      character(*), intent(in) :: id          !! of an SVG path; blank: the only one
      integer, intent(in) :: what             !! one of `what_...`
      type(curve_file_t), intent(out) :: curve
      type(diagnostics_t), intent(inout) :: findings !! its `file` is that path
      type(line_t), allocatable :: lines(:)
      real(wp), allocatable :: points(:, :)
      character(:), allocatable :: failure
      type(text_t) :: text
      integer :: i

      allocate (curve%at(columns_known, 0))
      call read_lines(path, lines, findings)
      if (findings%failed()) return
      do i = 1, size(lines)
         call text%add(lines(i)%text)
      end do
      curve%text = text%content()
      if (verify(curve%text, between//carriage_return//new_line('a')) == 0) then
         call findings%error('the file is empty; a curve has a line x,y for each of its points')
         return
      end if
      if (is_picture(path, curve%text)) then
         curve%of_picture = .true.
         if (what /= what_path) then
            call findings%error("an SVG picture has a path of points (WHAT='PATH'); a function or poses are a CSV file")
            return
         end if
         call read_svg_path(curve%text, id, points, curve%closed, failure)
         if (len(failure) > 0) then
            call findings%error(failure)
            return
         end if
         curve%has([column_x, column_y]) = .true.
         deallocate (curve%at)
         allocate (curve%at(columns_known, size(points, 2)), source=0.0_wp)
         curve%at([column_x, column_y], :) = points
      else
         call read_table(lines, what, curve, findings)
      end if
   end subroutine read_curve_file

   pure logical function is_picture(path, text)
      character(*), intent(in) :: path, text
      integer :: first

      first = verify(text, between//carriage_return//new_line('a'))
      is_picture = text(first:first) == '<'
      if (len(path) > 4) is_picture = is_picture .or. lower_case(path(len(path) - 3:)) == '.svg'
   end function is_picture

   subroutine read_table(lines, what, curve, findings)
      type(line_t), intent(in) :: lines(:)
      integer, intent(in) :: what
      type(curve_file_t), intent(inout) :: curve
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: words(:)
      integer, allocatable :: columns(:)      !! by column of the file: what it is
      real(wp), allocatable :: larger(:, :)
      real(wp) :: number
      character(:), allocatable :: reason
      logical :: valid
      integer :: i, k, n

      n = 0
      do i = 1, size(lines)
         call split(lines(i)%text, words)
         if (size(words) == 0) cycle
         if (.not. allocated(columns)) then
            call parse_real(trim(words(1)), number, valid, reason)
            if (.not. valid .and. reason == 'a number is expected') then
               call name_columns(words, i)
               if (findings%failed()) return
               cycle
            end if
            call usual_columns(size(words), i)
            if (findings%failed()) return
         end if
         if (size(words) /= size(columns)) then
            call findings%error('the line has '//to_text(size(words))//' numbers; '//to_text(size(columns))// &
                                ' columns are in the lines before', line=i)
            return
         end if
         if (n == most_points) then
            call findings%error('more than '//to_text(most_points)//' points; far fewer describe a curve', line=i)
            return
         end if
         if (n == size(curve%at, 2)) then
            allocate (larger(columns_known, max(64, 2*n)), source=0.0_wp)
            larger(:, :n) = curve%at
            call move_alloc(larger, curve%at)
         end if
         n = n + 1
         do k = 1, size(words)
            call parse_real(trim(words(k)), number, valid, reason)
            if (.not. valid) then
               call findings%error(reason//"; found '"//shortened(trim(words(k)))//"' in column "//to_text(k), line=i)
               return
            end if
            curve%at(columns(k), n) = number
         end do
      end do
      curve%at = curve%at(:, :n)
      if (n == 0) then
         call findings%error('there is no point in the file')
      else if (n == 1) then
         call findings%error('there is one point in the file; a curve has two at least')
      end if

   contains

      subroutine name_columns(words, line)
         character(*), intent(in) :: words(:)
         integer, intent(in) :: line
         character(:), allocatable :: word, near
         integer :: k, which

         allocate (columns(size(words)), source=0)
         do k = 1, size(words)
            word = lower_case(trim(words(k)))
            if (len(word) > 1) then
               if (word(1:1) == '"' .or. word(1:1) == "'") word = word(2:len(word) - 1)
            end if
            if (what == what_poses .and. word == 'x1') word = 'x'
            if (what == what_poses .and. word == 'y1') word = 'y'
            which = findloc(names == word, .true., dim=1)
            if (which > 0) then
               if (.not. belongs(which)) which = 0
            end if
            if (which == 0) then
               near = nearest_name(word, pack(names, [(belongs(which), which=1, columns_known)]))
               if (len(near) > 0) near = "; did you mean '"//trim(near)//"'?"
               call findings%error("column "//to_text(k)//" is called '"//shortened(word)//"', which is none of "// &
                                   all_names()//near, line=line)
               return
            end if
            if (curve%has(which)) then
               call findings%error("two columns are called '"//word//"'", line=line)
               return
            end if
            columns(k) = which
            curve%has(which) = .true.
         end do
         call check_columns(line)
      end subroutine name_columns

      !> The columns of a file that does not name them.
      subroutine usual_columns(count, line)
         integer, intent(in) :: count, line
         integer, allocatable :: usual(:)

         select case (what)
         case (what_function)
            usual = [column_input, column_value, column_weight]
         case (what_poses)
            usual = [column_x, column_y, column_x2, column_y2, column_input, column_weight]
         case default
            usual = [column_x, column_y, column_input, column_weight]
         end select
         if (count > size(usual)) then
            call findings%error('the line has '//to_text(count)//' numbers; '//to_text(size(usual))//' columns are known '// &
                                'without names ('//in_words(usual)//'); name them in a first line', line=line)
            return
         end if
         columns = usual(:count)
         curve%has(columns) = .true.
         call check_columns(line)
      end subroutine usual_columns

      subroutine check_columns(line)
         integer, intent(in) :: line
         integer, allocatable :: needed(:)
         integer :: k

         select case (what)
         case (what_function)
            needed = [column_input, column_value]
         case (what_poses)
            needed = [column_x, column_y, column_x2, column_y2]
         case default
            needed = [column_x, column_y]
         end select
         do k = 1, size(needed)
            if (curve%has(needed(k))) cycle
            call findings%error('there is no column '//trim(names(needed(k)))//'; '//in_words(needed)//' are needed', line=line)
            return
         end do
         if (curve%has(column_vx) .neqv. curve%has(column_vy)) &
            call findings%error('a velocity has two columns, vx and vy', line=line)
      end subroutine check_columns

      pure logical function belongs(which)
         integer, intent(in) :: which

         select case (which)
         case (column_value)
            belongs = what == what_function
         case (column_x, column_y)
            belongs = what /= what_function
         case (column_x2, column_y2)
            belongs = what == what_poses
         case (column_vx, column_vy)
            belongs = what == what_path
         case default
            belongs = .true.
         end select
      end function belongs

      pure function all_names() result(text)
         character(:), allocatable :: text
         integer :: which

         text = in_words(pack([(which, which=1, columns_known)], [(belongs(which), which=1, columns_known)]))
      end function all_names
   end subroutine read_table

   pure function in_words(columns) result(text)
      integer, intent(in) :: columns(:)
      character(:), allocatable :: text
      integer :: k

      text = ''
      do k = 1, size(columns)
         text = text//', '//trim(names(columns(k)))
      end do
      text = text(3:)
   end function in_words

   !> The words of a line; none of a blank line and of a comment.
   pure subroutine split(text, words)
      character(*), intent(in) :: text
      character(:), allocatable, intent(out) :: words(:)
      character(:), allocatable :: row
      character :: separator
      integer :: at, from, pass, longest, count

      row = text
      separator = ','
      if (index(row, ';') > 0) then
         separator = ';'
         do at = 1, len(row)
            if (row(at:at) == ',') row(at:at) = '.'
         end do
      end if
      do at = 1, len(row)
         if (row(at:at) == carriage_return) row(at:at) = ' '
      end do
      longest = 1
      count = 0
      do pass = 1, 2
         if (pass == 2) allocate (character(longest) :: words(count))
         count = 0
         at = 1
         do
            from = verify(row(at:), between)
            if (from == 0) exit
            at = at + from - 1
            if (count == 0 .and. scan(row(at:at), '#!') == 1) exit
            from = at
            do while (at <= len(row))
               if (row(at:at) == separator .or. scan(row(at:at), between) == 1) exit
               at = at + 1
            end do
            count = count + 1
            longest = max(longest, at - from)
            if (pass == 2) words(count) = row(from:at - 1)
            ! blanks, one separator
            if (at > len(row)) exit
            from = verify(row(at:), between)
            if (from == 0) exit
            at = at + from - 1
            if (row(at:at) == separator) at = at + 1
            if (at > len(row)) exit
         end do
      end do
   end subroutine split
end module psalm_curve_file
