!> Numbers in the columns of a listing. A linkage of loops has those of the published listings, seven digits each. A sketch has as
!> many decimals as its column needs, all the same: the largest number of the column has seven digits, and what every number of
!> the column has as zeros at its end is left out. Columns of very large or very small numbers are in engineering notation.
module psalm_number_format
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: dp, wp
   use psalm_text, only: general, to_text
   implicit none (type, external)
   private
   public :: number_format_t, format_of, figure, figures_of, in_a_row, in_sentence, number_words, error_words, rounding_error

   integer, parameter :: seven_digits = -1        !! each number by itself, as the published listings
   integer, parameter :: engineering = -2         !! a multiple of three as exponent
   integer, parameter :: figures = 7              !! digits of the largest number of a column
   integer, parameter :: largest_exponent = 6, least_exponent = -4   !! of the largest number of a column without exponents
   real(wp), parameter :: negligible = 1.0e-12_wp !! part of numbers of the same kind that rounding may make
   integer, parameter :: width = 15               !! of a number, as that of `general`
   real(wp), parameter :: of_condition = 16.0_wp*epsilon(1.0_wp) !! largest error over condition number that was measured
                                                                 !! (doc/measured/accuracy.md)

   !> A number in words: `number_words(named, value, error)` in a listing, `number_words(value)` in a message.
   interface number_words
      module procedure :: words_in_listing, words_in_message
   end interface number_words

   !> How the numbers of a column are written.
   type :: number_format_t
      private
      integer :: decimals = seven_digits          !! after the point, or one of the ways above
   end type number_format_t

contains

   !> The format of a column of a sketch with these numbers, or of loops.
   pure type(number_format_t) function format_of(named, values, known, among) result(format)
      logical, intent(in) :: named                !! joints have names: a sketch
      real(wp), intent(in) :: values(:)           !! shape (rows)
      logical, intent(in), optional :: known(:)   !! shape (rows): others are not written
      real(wp), intent(in), optional :: among(:)  !! numbers of the same kind: a column that is negligible beside them is zero
      real(wp) :: largest, scaled
      integer :: k, d, most

      if (.not. named) return
      format%decimals = 1
      largest = 0.0_wp
      do k = 1, size(values)
         if (counts(k)) largest = max(largest, abs(values(k)))
      end do
      if (.not. largest > 0.0_wp) return
      if (present(among)) then
         if (largest <= negligible*maxval(abs(among), mask=abs(among) < huge(1.0_wp))) return
      end if
      d = exponent_of(largest)
      if (d > largest_exponent .or. d < least_exponent) then
         format%decimals = engineering
         return
      end if
      most = max(1, figures - 1 - d)
      k = 1
      do while (k <= size(values) .and. format%decimals < most)
         scaled = 0.0_wp
         if (counts(k)) scaled = abs(values(k))*10.0_wp**format%decimals
         if (abs(scaled - anint(scaled)) < 0.5_wp*10.0_wp**(format%decimals - most)) then   ! zeros follow
            k = k + 1
         else
            format%decimals = format%decimals + 1
         end if
      end do

   contains

      pure logical function counts(row)
         integer, intent(in) :: row

         counts = abs(values(row)) < huge(1.0_wp)
         if (present(known)) counts = counts .and. known(row)
      end function counts
   end function format_of

   !> A number in its column of 15 characters; `error` is a bound of its error: digits that it leaves open are blank.
   pure function figure(value, format, error) result(text)
      real(wp), intent(in) :: value
      type(number_format_t), intent(in) :: format
      real(wp), intent(in), optional :: error
      character(width) :: text
      integer :: kept

      select case (format%decimals)
      case (seven_digits)
         text = general(value)
      case (engineering)
         text = in_engineering(value, error)
      case default
         kept = format%decimals
         if (present(error)) kept = supported(error, kept)
         text = in_fixed(value, kept)
         if (index(text, 'E') == 0) text = text(1 + format%decimals - kept:)     ! the points stand below each other
      end select
   end function figure

   !> The numbers of a column of a sketch, or of loops, as texts; what is not known is blank.
   pure function figures_of(named, values, known, all_count, error) result(texts)
      logical, intent(in) :: named                  !! joints have names: a sketch
      real(wp), intent(in) :: values(:)             !! shape (rows)
      logical, intent(in), optional :: known(:)     !! shape (rows)
      logical, intent(in), optional :: all_count    !! no number may lose its digits beside the largest; default false
      real(wp), intent(in), optional :: error       !! bound of the error of all: digits that it leaves open are blank
      character(width) :: texts(size(values))
      type(number_format_t) :: format
      integer :: k

      format = format_of(named, values, known)
      if (present(all_count)) then
         if (named .and. all_count .and. hides(values)) format%decimals = engineering
      end if
      texts = ''
      do k = 1, size(values)
         if (present(known)) then
            if (.not. known(k)) cycle
         end if
         texts(k) = figure(values(k), format, error)
      end do

   contains

      !> True if decimals by the largest number leave too few digits of the smallest.
      pure logical function hides(values)
         real(wp), intent(in) :: values(:)
         real(wp), parameter :: most_apart = 1.0e4_wp   ! three of seven digits are left
         real(wp) :: least, most
         logical :: counted(size(values))

         counted = abs(values) > 0.0_wp .and. abs(values) < huge(1.0_wp)
         if (present(known)) counted = counted .and. known
         least = minval(abs(values), mask=counted)
         most = maxval(abs(values), mask=counted)
         hides = any(counted)
         if (hides) hides = most > most_apart*least
      end function hides
   end function figures_of

   !> The columns of a row side by side.
   pure function in_a_row(columns) result(line)
      character(*), intent(in) :: columns(:)
      character(len(columns)*size(columns)) :: line
      integer :: k

      do k = 1, size(columns)
         line((k - 1)*len(columns) + 1:k*len(columns)) = columns(k)
      end do
   end function in_a_row

   !> A number in a sentence of a listing, with a blank before it; of loops in its width of 15 characters.
   pure function in_sentence(named, value, error) result(text)
      logical, intent(in) :: named                  !! joints have names: a sketch
      real(wp), intent(in) :: value
      real(wp), intent(in), optional :: error       !! bound of its error: of a sketch digits that it leaves open are left out
      character(:), allocatable :: text

      text = figure(value, format_of(named, [value]), error)
      if (named) text = ' '//trim(adjustl(text))
   end function in_sentence

   !> The same without blanks around it.
   pure function words_in_listing(named, value, error) result(words)
      logical, intent(in) :: named                  !! joints have names: a sketch
      real(wp), intent(in) :: value
      real(wp), intent(in), optional :: error       !! as above
      character(:), allocatable :: words

      words = trim(adjustl(in_sentence(named, value, error)))
   end function words_in_listing

   !> A number in a message, as in a sentence of the listing of a sketch, whatever the linkage.
   pure function words_in_message(value) result(words)
      real(wp), intent(in) :: value
      character(:), allocatable :: words

      words = words_in_listing(.true., value)
   end function words_in_message

   !> An error in a sentence of a listing: of a sketch two digits, as its size is all that it tells.
   pure function error_words(named, value) result(text)
      logical, intent(in) :: named                  !! joints have names: a sketch
      real(wp), intent(in) :: value
      character(:), allocatable :: text
      real(wp), parameter :: least = 10.0_wp**(-min(99, range(1.0_wp) - 1)) ! of two digits in the exponent
      character(8) :: buffer

      if (named .and. abs(value) >= least .and. abs(value) < 1.0_wp/least) then
         write (buffer, '(es8.1e2)') real(value, dp)
         text = ' '//trim(adjustl(buffer))
      else
         text = in_sentence(named, value)
      end if
   end function error_words

   !> Bound of what rounding makes of a number with a condition number.
   elemental real(wp) function rounding_error(condition, size_of)
      real(wp), intent(in) :: condition
      real(wp), intent(in) :: size_of             !! what the condition number is relative to

      rounding_error = of_condition*condition*abs(size_of)
   end function rounding_error

   !> Decimals of which the last is not smaller than the error.
   pure integer function supported(error, decimals) result(kept)
      real(wp), intent(in) :: error
      integer, intent(in) :: decimals

      kept = decimals
      do while (kept > 0)
         if (10.0_wp**(-kept) >= error) exit
         kept = kept - 1
      end do
   end function supported

   !> Power of ten of the first digit.
   pure integer function exponent_of(value)
      real(wp), intent(in) :: value               !! above 0

      exponent_of = floor(log10(value))
   end function exponent_of

   !> Fixed-point notation; zero has no sign.
   pure function in_fixed(value, decimals) result(text)
      real(wp), intent(in) :: value
      integer, intent(in) :: decimals
      character(width) :: text
      character(12) :: layout
      real(wp), parameter :: most = 1.0e11_wp     ! a larger number, scaled, has no exact neighbours
      real(wp), parameter :: tie = 1.0e-4_wp      ! many times the error of the scaled number
      real(wp) :: scaled
      integer(int64) :: whole
      integer :: k, at

      scaled = abs(value)*10.0_wp**decimals
      if (scaled < most) then
         whole = nint(scaled, int64)
         if (abs(abs(scaled - real(whole, wp)) - 0.5_wp) > tie) then
            text = ' '
            at = width
            k = 0
            do while (k <= decimals .or. whole > 0)
               if (k == decimals) then
                  text(at:at) = '.'
                  at = at - 1
               end if
               text(at:at) = achar(iachar('0') + int(mod(whole, 10_int64)))
               whole = whole/10_int64
               at = at - 1
               k = k + 1
            end do
            if (value < 0.0_wp .and. scaled >= 0.5_wp) text(at:at) = '-'
            return
         end if
      end if
      write (layout, '("(f",i0,".",i0,")")') width, decimals
      write (text, layout) real(value, dp)
      if (text(1:1) == '*') text = in_engineering(value)
      if (verify(trim(adjustl(text)), '-0.') == 0 .and. index(text, '-') > 0) text(index(text, '-'):index(text, '-')) = ' '
   end function in_fixed

   !> Seven digits, or those that the error supports, and an exponent that is a multiple of three.
   pure function in_engineering(value, error) result(text)
      real(wp), intent(in) :: value
      real(wp), intent(in), optional :: error
      character(width) :: text
      character(14) :: buffer
      character(:), allocatable :: layout, digits, sign
      integer :: power, before, kept, at

      if (abs(value) <= 0.0_wp) then
         text = '            0.0'
         return
      else if (.not. abs(value) <= huge(value)) then
         text = general(value)
         return
      end if
      kept = figures
      if (present(error)) kept = count([(10.0_wp**(exponent_of(abs(value)) - at) >= error, at=0, figures - 1)])
      if (kept == 0) then
         text = '            0.0'
         return
      end if
      layout = '(es14.'//to_text(kept - 1)//'e3)'
      write (buffer, layout) real(value, dp)
      at = index(buffer, 'E')
      read (buffer(at + 1:), '(i4)') power
      before = modulo(power, 3)
      sign = trim(merge('-', ' ', value < 0.0_wp))
      at = index(buffer, '.')
      digits = buffer(at - 1:at - 1)//buffer(at + 1:index(buffer, 'E') - 1)
      digits = digits//repeat('0', max(0, before + 1 - len(digits)))    ! zeros keep the places before the point
      power = power - before
      text = sign//digits(:before + 1)//'.'//digits(before + 2:)//'E'//merge('-', '+', power < 0)// &
             repeat('0', max(0, 2 - len(to_text(abs(power)))))//to_text(abs(power))
      text = adjustr(text)
   end function in_engineering
end module psalm_number_format
