!> A growing buffer of lines, number formatting in the manner of the thesis's listings, letter case.
!>
!> All numbers that reach a listing or a device go through this module, so that columns stay the same in every kind.
module psalm_text
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: wp, dp
   implicit none (type, external)
   private
   public :: text_t, upper_case, lower_case, cased, to_text, fixed, general, full_precision, number_or_nan, rank_column, &
             edit_distance, nearest_name, quoted, shortened

   !> A text that grows by lines. Lines end with a line feed.
   type :: text_t
      character(:), allocatable :: buffer  !! the characters; the first `length` are valid
      integer :: length = 0                !! characters so far
   contains
      procedure :: add => add_line
      procedure :: add_text
      procedure :: content
   end type text_t

   !> The powers of ten that are exact in double precision.
   real(dp), parameter :: ten_to(0:22) = [1.0e0_dp, 1.0e1_dp, 1.0e2_dp, 1.0e3_dp, 1.0e4_dp, 1.0e5_dp, 1.0e6_dp, 1.0e7_dp, &
      1.0e8_dp, 1.0e9_dp, 1.0e10_dp, 1.0e11_dp, 1.0e12_dp, 1.0e13_dp, 1.0e14_dp, 1.0e15_dp, 1.0e16_dp, 1.0e17_dp, 1.0e18_dp, &
      1.0e19_dp, 1.0e20_dp, 1.0e21_dp, 1.0e22_dp]

   interface to_text
      module procedure integer_to_text
   end interface to_text

contains

   !> Append a line (trailing blanks are dropped).
   pure subroutine add_line(self, line)
      class(text_t), intent(inout) :: self
      character(*), intent(in), optional :: line !! if absent, an empty line

      if (present(line)) call put(self, line(:len_trim(line)))
      call put(self, new_line('a'))
   end subroutine add_line

   !> Append text that already consists of complete lines.
   pure subroutine add_text(self, text)
      class(text_t), intent(inout) :: self
      character(*), intent(in) :: text

      call put(self, text)
   end subroutine add_text

   !> The whole text.
   pure function content(self) result(text)
      class(text_t), intent(in) :: self
      character(:), allocatable :: text

      if (self%length == 0) then
         text = ''
      else
         text = self%buffer(:self%length)
      end if
   end function content

   pure subroutine put(self, text)
      class(text_t), intent(inout) :: self
      character(*), intent(in) :: text
      character(:), allocatable :: larger
      integer :: needed

      needed = self%length + len(text)
      if (.not. allocated(self%buffer)) allocate (character(max(1024, needed)) :: self%buffer)
      if (needed > len(self%buffer)) then
         allocate (character(max(2*len(self%buffer), needed)) :: larger)
         larger(:self%length) = self%buffer(:self%length)
         call move_alloc(larger, self%buffer)
      end if
      self%buffer(self%length + 1:needed) = text
      self%length = needed
   end subroutine put

   !> The text in capitals (letters A to Z only).
   pure function upper_case(text) result(capitals)
      character(*), intent(in) :: text
      character(len(text)) :: capitals
      integer :: i

      capitals = text
      do i = 1, len(text)
         if (text(i:i) >= 'a' .and. text(i:i) <= 'z') capitals(i:i) = achar(iachar(text(i:i)) - 32)
      end do
   end function upper_case

   !> Words of a listing, in capitals, as they stand there or in small letters within a sentence.
   pure function cased(words, small) result(text)
      character(*), intent(in) :: words
      logical, intent(in) :: small
      character(len(words)) :: text

      text = words
      if (small) text = lower_case(words)
   end function cased

   !> The text in small letters (letters A to Z only).
   pure function lower_case(text) result(small)
      character(*), intent(in) :: text
      character(len(text)) :: small
      integer :: i

      small = text
      do i = 1, len(text)
         if (text(i:i) >= 'A' .and. text(i:i) <= 'Z') small(i:i) = achar(iachar(text(i:i)) + 32)
      end do
   end function lower_case

   !> An integer without blanks. A WRITE statement takes twenty times as long, and a listing has hundreds of them.
   pure function integer_to_text(value) result(text)
      integer, intent(in) :: value
      character(:), allocatable :: text
      character(range(value) + 2) :: buffer      ! a sign and all digits there may be
      integer :: rest, first

      first = len(buffer) + 1
      rest = value
      do
         first = first - 1
         buffer(first:first) = achar(iachar('0') + abs(mod(rest, 10)))  ! of the remainder: the lowest integer has no opposite
         rest = rest/10
         if (rest == 0) exit
      end do
      if (value < 0) then
         first = first - 1
         buffer(first:first) = '-'
      end if
      text = buffer(first:)
   end function integer_to_text

   !> Fixed-point number, right-justified: `decimals` digits after the point, an exact zero as 0.0.
   !>
   !> Zero and ties follow the thesis's listings (figures 7.2 and 7.3): a decimal tie such as 352.7155 goes towards zero,
   !> but away from it where the number is an angle that has been through radians (20.4425 prints as 20.442 in the input
   !> and as 20.443 in the results). A number too wide for the field is printed in exponent form, not as asterisks.
   pure function fixed(value, width, decimals, tie_away) result(text)
      real(wp), intent(in) :: value
      integer, intent(in) :: width     !! characters, at least 10
      integer, intent(in) :: decimals  !! digits after the point
      logical, intent(in), optional :: tie_away !! ties away from zero; default false
      character(width) :: text
      character(16) :: layout
      real(dp) :: nudged
      real(dp), parameter :: tie_width = 1.0e-13_dp !! relative width of what counts as a tie

      if (value == 0.0_wp) then
         text = repeat(' ', width - 3)//'0.0'
         return
      end if
      nudged = in_range(value)*(1.0_dp - tie_width)
      if (present(tie_away)) then
         if (tie_away) nudged = in_range(value*(1.0_wp + real(tie_width, wp)))
      end if
      write (layout, '("(f",i0,".",i0,")")') width, decimals
      write (text, layout) nudged
      if (text(1:1) == '*') then
         write (layout, '("(es",i0,".",i0,"e3)")') width, width - 9
         write (text, layout) in_range(value)
      end if
   end function fixed

   !> G15.7 with the exponent letter D, an exact zero as 0.0: the thesis's format for motion and error.
   pure function general(value, letter) result(text)
      real(wp), intent(in) :: value
      character(1), intent(in), optional :: letter !! of the exponent; default D
      character(15) :: text
      integer :: e
      logical :: done

      if (value == 0.0_wp) then
         text = '            0.0'
         return
      end if
      call seven_digits(in_range(value), text, done)
      if (done) return
      write (text, '(g15.7)') in_range(value)
      e = index(text, 'E')
      if (e > 0) then
         text(e:e) = 'D'
         if (present(letter)) text(e:e) = letter
      else
         ! G editing leaves four blanks for the exponent: keep numbers right-justified in the field
         text = adjustr(text)
      end if
   end function general

   !> G15.7 of a number from 1 up to ten million, much faster than the run-time library. `done` is false for all other numbers,
   !> and where the product with a power of ten, once rounded, does not decide the last digit.
   pure subroutine seven_digits(value, text, done)
      real(dp), intent(in) :: value
      character(15), intent(inout) :: text
      logical, intent(out) :: done
      integer, parameter :: figures = 7
      real(dp), parameter :: doubt = 1.0e-6_dp   !! many times the error of a product below 1e7
      real(dp) :: scaled, size
      integer :: whole, before, i, at

      size = abs(value)
      done = size >= 1.0_dp .and. size < 1.0e7_dp
      if (.not. done) return
      before = 1
      do while (size >= ten_to(before))
         before = before + 1
      end do
      scaled = size*ten_to(figures - before)
      whole = int(scaled)
      done = abs(scaled - real(whole, dp) - 0.5_dp) > doubt
      if (.not. done) return
      if (scaled - real(whole, dp) > 0.5_dp) whole = whole + 1
      done = whole < 10000000   ! else it has one digit more before the point
      if (.not. done) return
      text = ' '
      at = len(text)
      do i = 1, figures
         if (i == figures - before + 1) then
            text(at:at) = '.'
            at = at - 1
         end if
         text(at:at) = achar(iachar('0') + mod(whole, 10))
         whole = whole/10
         at = at - 1
      end do
      if (value < 0.0_dp) text(at:at) = '-'
   end subroutine seven_digits

   !> Seventeen digits of a number of double precision, exactly rounded: its product with a power of ten is held in two
   !> numbers without error (Dekker 1971). `done` is false where the power is no such number, or two roundings are as near.
   pure subroutine seventeen_digits(value, text, length, done)
      real(dp), intent(in) :: value
      character(*), intent(out) :: text
      integer, intent(out) :: length      !! characters used
      logical, intent(out) :: done
      real(dp), parameter :: splitter = 134217729.0_dp  !! 2**27 + 1
      real(dp) :: size, power, high, low, a1, a2, b1, b2, c
      integer(int64) :: whole
      integer :: exponent_of_ten, i, at
      integer, parameter :: figures = 17

      size = abs(value)
      length = 0
      text = ''
      done = size <= 0.0_dp
      if (done) then
         text = '0.'//repeat('0', figures - 1)//'E+00'
         if (sign(1.0_dp, value) < 0.0_dp) text = '-'//text
         length = len_trim(text)
         return
      end if
      done = size >= 1.0e-4_dp .and. size < 1.0e15_dp
      if (.not. done) return
      exponent_of_ten = 0
      if (size >= 1.0_dp) then
         do while (size >= ten_to(exponent_of_ten + 1))
            exponent_of_ten = exponent_of_ten + 1
         end do
      else
         ! 0.001 and so on are rounded numbers: where this is one too many, there are sixteen or eighteen digits below
         do while (size*ten_to(-exponent_of_ten) < 1.0_dp)
            exponent_of_ten = exponent_of_ten - 1
         end do
      end if
      power = ten_to(figures - 1 - exponent_of_ten)
      high = size*power
      c = splitter*size
      a1 = c - (c - size)
      a2 = size - a1
      c = splitter*power
      b1 = c - (c - power)
      b2 = power - b1
      low = ((a1*b1 - high) + a1*b2 + a2*b1) + a2*b2
      ! from 2**53 on `high` is a whole number; what is left is in `low`
      whole = int(high, int64)
      c = real(floor(low), dp)
      done = abs(low - c - 0.5_dp) > 0.0_dp
      if (.not. done) return
      whole = whole + int(c, int64)
      if (low - c > 0.5_dp) whole = whole + 1_int64
      done = whole >= 10_int64**(figures - 1) .and. whole < 10_int64**figures
      if (.not. done) return
      at = 0
      if (value < 0.0_dp) then
         text(1:1) = '-'
         at = 1
      end if
      length = at + figures + 5
      do i = figures, 2, -1
         text(at + i + 1:at + i + 1) = achar(iachar('0') + int(mod(whole, 10_int64)))
         whole = whole/10_int64
      end do
      text(at + 1:at + 2) = achar(iachar('0') + int(whole))//'.'
      text(at + figures + 2:at + figures + 3) = merge('E-', 'E+', exponent_of_ten < 0)
      i = abs(exponent_of_ten)
      text(at + figures + 4:length) = achar(iachar('0') + i/10)//achar(iachar('0') + mod(i, 10))
   end subroutine seventeen_digits

   !> The number with as many digits as are needed to read the same bits back (17 for real64).
   pure function full_precision(value) result(text)
      real(wp), intent(in) :: value
      character(:), allocatable :: text
      character(16) :: layout
      character(60) :: buffer
      integer, parameter :: digits_after_point = precision(1.0_wp) + 1
      integer :: length
      logical :: done

      if (digits(1.0_wp) == digits(1.0_dp)) then
         call seventeen_digits(real(value, dp), buffer, length, done)
         if (done) then
            text = buffer(:length)
            return
         end if
      end if
      write (layout, '("(es",i0,".",i0,"e4)")') digits_after_point + 10, digits_after_point
      write (buffer, layout) value
      text = trim(adjustl(buffer))
      ! at least two digits of exponent
      do while (text(len(text) - 2:len(text) - 2) == '0')
         text = text(:len(text) - 3)//text(len(text) - 1:)
      end do
   end function full_precision

   !> All digits of a number, or `NaN` if it is not known.
   pure function number_or_nan(value, known) result(text)
      real(wp), intent(in) :: value
      logical, intent(in) :: known
      character(:), allocatable :: text

      text = 'NaN'
      if (known) text = full_precision(value)
   end function number_or_nan

   !> A rank, ending in column 6 of a listing.
   pure function rank_column(rank) result(column)
      integer, intent(in) :: rank
      character(:), allocatable :: column

      column = to_text(rank)
      column = repeat(' ', 6 - min(5, len(column)))//column
   end function rank_column

   !> What a user wrote, short enough for a message.
   pure function shortened(written) result(text)
      character(*), intent(in) :: written
      character(:), allocatable :: text
      integer, parameter :: room = 40

      if (len(written) <= room) then
         text = written
      else
         text = written(:room)//'...'
      end if
   end function shortened

   !> Levenshtein distance of two names: letters to change, insert or delete.
   pure integer function edit_distance(a, b)
      character(*), intent(in) :: a, b
      integer :: previous(0:len(b)), current(0:len(b))
      integer :: i, j

      previous = [(j, j=0, len(b))]
      do i = 1, len(a)
         current(0) = i
         do j = 1, len(b)
            current(j) = min(previous(j) + 1, current(j - 1) + 1, &
                             previous(j - 1) + merge(0, 1, a(i:i) == b(j:j)))
         end do
         previous = current
      end do
      edit_distance = previous(len(b))
   end function edit_distance

   !> The name in a list that is nearest to a misspelt one; empty if none is near (more than half its letters differ).
   pure function nearest_name(name, names) result(best)
      character(*), intent(in) :: name
      character(*), intent(in) :: names(:)
      character(:), allocatable :: best
      integer :: i, distance, smallest

      best = ''
      smallest = max(1, len_trim(name)/2) + 1
      do i = 1, size(names)
         distance = edit_distance(trim(name), trim(names(i)))
         if (distance < smallest) then
            smallest = distance
            best = trim(names(i))
         end if
      end do
   end function nearest_name

   !> The number in real64, kept inside its range, for the columns of the thesis.
   pure real(dp) function in_range(value)
      real(wp), intent(in) :: value
      real(wp), parameter :: largest = scale(1.0_wp - epsilon(1.0_wp), min(maxexponent(1.0_wp), maxexponent(1.0_dp)))

      in_range = real(sign(min(abs(value), largest), value), dp)
   end function in_range

   !> A text in quotes, in which an apostrophe is written twice: as a value of the notation.
   pure function quoted(value) result(text)
      character(*), intent(in) :: value
      character(:), allocatable :: text, room
      integer :: i, n

      allocate (character(2*len(value) + 2) :: room)
      room(1:1) = "'"
      n = 1
      do i = 1, len_trim(value)
         n = n + 1
         room(n:n) = value(i:i)
         if (value(i:i) /= "'") cycle
         n = n + 1
         room(n:n) = "'"
      end do
      text = room(:n)//"'"
   end function quoted
end module psalm_text
