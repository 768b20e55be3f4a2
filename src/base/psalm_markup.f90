!> Text and numbers inside SVG and HTML: what a user may have written in a title must not end an element there. JSON: `psalm_json`.
module psalm_markup
   use, intrinsic :: iso_fortran_env, only: int64
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use psalm_kinds, only: wp
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: clean_text, xml_text, short_number, sentence_case, wrapped, strings_t, add_string

   integer, parameter :: significant = 9 !! digits of `short_number`

   !> Lines of different lengths.
   type :: strings_t
      character(:), allocatable :: text
   end type strings_t

contains

   !> The text as valid UTF-8 without control characters: a byte that fits no sequence is taken for Latin-1.
   pure function clean_text(text) result(clean)
      character(*), intent(in) :: text
      character(:), allocatable :: clean
      type(text_t) :: out         ! grows without being copied for every letter
      integer :: i, k, code, more, least

      i = 1
      do while (i <= len(text))
         code = ichar(text(i:i))
         if (code < 128) then
            if (code < 32 .or. code == 127) code = 32
            call out%add_text(achar(code))
            i = i + 1
            cycle
         end if
         more = 0
         least = 0
         if (code >= 194 .and. code <= 223) then
            more = 1
            code = code - 192
            least = 128
         else if (code >= 224 .and. code <= 239) then
            more = 2
            code = code - 224
            least = 2048
         else if (code >= 240 .and. code <= 244) then
            more = 3
            code = code - 240
            least = 65536
         end if
         do k = 1, more
            if (i + k > len(text)) then
               more = 0
               exit
            end if
            if (ichar(text(i + k:i + k)) < 128 .or. ichar(text(i + k:i + k)) > 191) then
               more = 0
               exit
            end if
            code = code*64 + ichar(text(i + k:i + k)) - 128
         end do
         ! too long a form, surrogates, and what XML does not take
         if (code < least .or. (code >= 55296 .and. code <= 57343) .or. code > 1114111) more = 0
         if (code == 65534 .or. code == 65535) more = 0
         if (more > 0 .and. code >= 160) then
            call out%add_text(text(i:i + more))
         else if (more > 0) then
            call out%add_text(' ')
         else
            code = ichar(text(i:i))
            if (code >= 160) then
               call out%add_text(char(192 + code/64)//char(128 + modulo(code, 64)))
            else
               call out%add_text('?')
            end if
         end if
         i = i + 1 + more
      end do
      clean = out%content()
   end function clean_text

   !> The text for the content or an attribute of an XML or HTML element.
   pure function xml_text(text) result(escaped)
      character(*), intent(in) :: text
      character(:), allocatable :: escaped, clean
      type(text_t) :: out         ! grows without being copied for every letter
      integer :: i

      clean = clean_text(text)
      do i = 1, len(clean)
         select case (clean(i:i))
         case ('&')
            call out%add_text('&amp;')
         case ('<')
            call out%add_text('&lt;')
         case ('>')
            call out%add_text('&gt;')
         case ('"')
            call out%add_text('&quot;')
         case ("'")
            call out%add_text('&#39;')
         case default
            call out%add_text(clean(i:i))
         end select
      end do
      escaped = out%content()
   end function xml_text

   !> Nine significant digits, or as many as wanted, without needless zeros. What is no number is 0: a picture has no place for it.
   pure function short_number(value, wanted) result(text)
      real(wp), intent(in) :: value
      integer, intent(in), optional :: wanted
      character(:), allocatable :: text
      character(40) :: buffer
      character(12) :: layout
      real(wp) :: scaled
      integer :: power, mark, digits

      digits = significant
      if (present(wanted)) digits = wanted
      if (.not. ieee_is_finite(value)) then
         text = '0'
         return
      end if
      if (abs(value) <= tiny(value)) then
         text = '0'
         return
      end if
      power = floor(log10(abs(value)))
      if (power >= -4 .and. power < digits - 1) then
         ! rounded to a whole number by hand, which takes a tenth of the time, unless the rounding of the product could decide
         scaled = abs(value)*10.0_wp**(digits - 1 - power)
         if (abs(scaled - aint(scaled) - 0.5_wp) > 4.0_wp*spacing(scaled)) then
            text = with_point(nint(scaled, int64), digits - 1 - power)
            if (value < 0.0_wp) text = '-'//text
            return
         end if
         write (layout, '("(f36.",i0,")")') digits - 1 - power
         write (buffer, layout) value
         text = trim(adjustl(buffer))
         text = without_zeros(text)
      else
         write (layout, '("(es36.",i0,"e4)")') digits - 1
         write (buffer, layout) value
         buffer = adjustl(buffer)
         mark = index(buffer, 'E')
         read (buffer(mark + 1:), '(i5)') power
         text = without_zeros(buffer(:mark - 1))//'E'//to_text(power)
      end if
   end function short_number

   !> Words of the listings, which are in capitals, as a sentence. The exponent of a number keeps its letter.
   pure function sentence_case(words) result(sentence)
      character(*), intent(in) :: words
      character(len(words)) :: sentence
      integer :: i

      sentence = words
      do i = 2, len(words)
         if (words(i:i) < 'A' .or. words(i:i) > 'Z') cycle
         if (scan(words(i - 1:i - 1), '.0123456789') > 0) cycle
         sentence(i:i) = achar(iachar(words(i:i)) + iachar('a') - iachar('A'))
      end do
   end function sentence_case

   !> A whole number of units of the last of so many decimals, without needless zeros: (1250, 4) is 0.125.
   pure function with_point(whole, decimals) result(text)
      integer(int64), intent(in) :: whole
      integer, intent(in) :: decimals
      character(:), allocatable :: text
      character(40) :: buffer
      integer(int64) :: rest
      integer :: left, at

      rest = whole
      left = decimals
      do while (left > 0 .and. mod(rest, 10_int64) == 0)
         rest = rest/10
         left = left - 1
      end do
      at = len(buffer) + 1
      do
         at = at - 1
         buffer(at:at) = achar(iachar('0') + int(mod(rest, 10_int64)))
         rest = rest/10
         left = left - 1
         if (left == 0) then
            at = at - 1
            buffer(at:at) = '.'
         end if
         if (left < 0 .and. rest == 0) exit
      end do
      text = buffer(at:)
   end function with_point

   pure function without_zeros(number) result(text)
      character(*), intent(in) :: number
      character(:), allocatable :: text
      integer :: last

      last = verify(number, '0', back=.true.)
      if (number(last:last) == '.') last = last - 1
      text = number(:last)
   end function without_zeros

   !> Break a message into lines of at most `width` characters, at blanks where there are any.
   pure function wrapped(text, width) result(lines)
      character(*), intent(in) :: text
      integer, intent(in) :: width
      type(strings_t), allocatable :: lines(:)
      integer :: first, last

      allocate (lines(0))
      first = 1
      do while (first <= len_trim(text))
         last = min(len_trim(text), first + width - 1)
         if (last < len_trim(text)) then
            if (index(text(first:last + 1), ' ', back=.true.) > width/2) &
               last = first + index(text(first:last + 1), ' ', back=.true.) - 2
         end if
         call add_string(lines, text(first:last))
         first = last + 1
         if (first <= len(text)) then
            if (text(first:first) == ' ') first = first + 1
         end if
      end do
   end function wrapped

   !> Append a line to a list.
   pure subroutine add_string(lines, text)
      type(strings_t), allocatable, intent(inout) :: lines(:)
      character(*), intent(in) :: text
      type(strings_t), allocatable :: more(:)
      integer :: n

      n = size(lines) + 1   ! a subscript of its own: gfortran 11 loses its way in more(size(more))%text
      allocate (more(n))
      more(:n - 1) = lines
      more(n)%text = text
      call move_alloc(more, lines)
   end subroutine add_string
end module psalm_markup
