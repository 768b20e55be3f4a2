!> Text inside SVG, HTML and JSON, and the outline of a plate.
program test_markup
   use, intrinsic :: ieee_arithmetic, only: ieee_value, ieee_quiet_nan, ieee_negative_inf
   use check, only: checks_t
   use psalm_kinds, only: wp
   use psalm_json, only: add_member, json_integers, json_number, json_text
   use psalm_markup, only: clean_text, sentence_case, short_number, strings_t, wrapped, &
                           xml_text
   use psalm_link_outline, only: convex_hull
   use psalm_text, only: text_t
   implicit none (type, external)
   type(checks_t) :: t

   call texts()
   call code_points()
   call numbers()
   call lines()
   call outlines()
   call t%report()

contains

   subroutine texts()
      character(*), parameter :: e_acute = char(195)//char(169) !! in UTF-8

      call t%equal_text(clean_text('plain'), 'plain', 'plain text stays')
      call t%equal_text(clean_text('a'//achar(9)//achar(27)//'b'), 'a  b', 'control characters become blanks')
      call t%equal_text(clean_text(e_acute), e_acute, 'UTF-8 stays')
      call t%equal_text(clean_text(char(233)), e_acute, 'a byte that is no UTF-8 is taken for Latin-1')
      call t%equal_text(clean_text('x'//char(195)), 'x'//char(195)//char(131), 'a sequence cut short')
      call t%equal_text(clean_text(char(192)//char(128)), char(195)//char(128)//'?', 'a sequence longer than it need be')
      call t%equal_text(clean_text(char(237)//char(160)//char(128)), char(195)//char(173)//char(194)//char(160)//'?', &
                        'half a surrogate pair')
      call t%equal_text(xml_text('<a b="c">&''</a>'), '&lt;a b=&quot;c&quot;&gt;&amp;&#39;&lt;/a&gt;', 'XML')
      call t%equal_text(json_text('</script>"'//achar(92)), '"'//achar(92)//'u003c/script'//achar(92)//'u003e'//achar(92)//'"'// &
                        achar(92)//achar(92)//'"', 'JSON that a script element may hold')
      call t%equal_text(sentence_case('LOOP 1, DYAD OF TYPE 4 (ARCS 2 AND 3): TOO SHORT BY 0.15D-02'), &
                        'Loop 1, dyad of type 4 (arcs 2 and 3): too short by 0.15D-02', 'capitals of a listing as a sentence')
   end subroutine texts

   !> Code points at the edges of the forms of UTF-8, and those that XML does not take.
   subroutine code_points()
      integer, parameter :: stay(*) = [160, 191, 192, 2047, 2048, 4095, 55295, 57344, 65533, 65536, 1114111]
      integer, parameter :: go(*) = [55296, 57343, 65534, 65535, 1114112]
      integer, parameter :: blank(*) = [128, 159]
      integer :: i

      do i = 1, size(stay)
         call t%equal_text(clean_text('a'//utf8(stay(i))//'b'), 'a'//utf8(stay(i))//'b', 'a code point that stays')
      end do
      do i = 1, size(go)
         call t%is_true(index(clean_text(utf8(go(i))), utf8(go(i))) == 0, 'a code point that XML does not take')
      end do
      do i = 1, size(blank)
         call t%equal_text('a'//clean_text(utf8(blank(i)))//'b', 'a b', 'a control character of two bytes')
      end do
   end subroutine code_points

   pure function utf8(code) result(bytes)
      integer, intent(in) :: code
      character(:), allocatable :: bytes
      integer, parameter :: lead(0:3) = [0, 192, 224, 240]
      integer :: rest, more

      rest = code
      bytes = ''
      more = count(code >= [128, 2048, 65536])
      do while (len(bytes) < more)
         bytes = char(128 + modulo(rest, 64))//bytes
         rest = rest/64
      end do
      bytes = char(rest + lead(more))//bytes
   end function utf8

   subroutine numbers()
      type(text_t) :: text

      call t%equal_text(short_number(0.0_wp), '0', 'zero')
      call t%equal_text(short_number(0.5_wp), '0.5', 'a digit before the point: JSON wants it')
      call t%equal_text(short_number(-12.25_wp), '-12.25', 'a negative number')
      call t%equal_text(short_number(1234567.0_wp), '1234567', 'no needless point')
      call t%equal_text(short_number(1.0_wp/3.0_wp), '0.333333333', 'nine digits')
      call t%equal_text(short_number(2.5e20_wp), '2.5E20', 'a large number')
      call t%equal_text(json_number(1.0_wp, .false.), 'null', 'what is not known is null')
      call t%equal_text(json_number(0.1_wp, exact=.true.), '1.0000000000000001E-01', 'a number of a table has all digits')
      call add_member('x"y', [1.0_wp, 0.25_wp, 3.0_wp], text, [.true., .true., .false.])
      call t%equal_text(text%content(), ',"x'//achar(92)//'"y":[1,0.25,null]'//new_line('a'), 'a further member of an object')
      call t%equal_text(json_integers([3, 1]), '[3,1]', 'integers')
      call t%equal_text(json_number(ieee_value(1.0_wp, ieee_quiet_nan), .true.), 'null', 'what is no number is null')
      call t%equal_text(short_number(ieee_value(1.0_wp, ieee_quiet_nan)), '0', 'no number')
      call t%equal_text(short_number(ieee_value(1.0_wp, ieee_negative_inf)), '0', 'nor is infinity')
      call all_sizes()
   end subroutine numbers

   !> What is rounded by hand is what the run-time library writes, halves of the last digit too.
   subroutine all_sizes()
      character(40) :: layout, written
      character(:), allocatable :: text
      real(wp) :: value
      integer :: power, k, digits, last, differ

      differ = 0
      do power = -4, 7
         do k = 1, 400
            digits = merge(9, 4 + mod(k, 4), mod(k, 2) == 0 .or. power > 2)
            value = modulo(k*0.6180339887498949_wp, 9.0_wp) + 1.0_wp
            if (mod(k, 3) == 0) value = real(int(value*64.0_wp), wp)/64.0_wp        ! some of these are halves of the last digit
            if (mod(k, 5) == 0) value = -value
            value = value*10.0_wp**power
            if (floor(log10(abs(value))) /= power) cycle
            write (layout, '("(f36.",i0,")")') digits - 1 - power
            write (written, layout) value
            text = trim(adjustl(written))
            last = verify(text, '0', back=.true.)
            if (text(last:last) == '.') last = last - 1
            if (short_number(value, digits) /= text(:last)) differ = differ + 1
         end do
      end do
      call t%equal_integer(differ, 0, 'numbers of all sizes')
   end subroutine all_sizes

   subroutine lines()
      type(strings_t), allocatable :: parts(:)

      parts = wrapped('one two three four', 9)
      call t%equal_integer(size(parts), 3, 'lines of at most nine characters')
      call t%equal_text(parts(1)%text//'|'//parts(2)%text//'|'//parts(3)%text, 'one two|three|four', 'broken at blanks')
      parts = wrapped('abcdefghij', 4)
      call t%equal_text(parts(1)%text//'|'//parts(2)%text//'|'//parts(3)%text, 'abcd|efgh|ij', 'a long word is cut')
   end subroutine lines

   subroutine outlines()
      integer, allocatable :: hull(:)

      hull = convex_hull([7, 8, 9, 10], [0.0_wp, 4.0_wp, 0.0_wp, 1.0_wp], [0.0_wp, 0.0_wp, 4.0_wp, 1.0_wp])
      call t%is_true(size(hull) == 3 .and. all([any(hull == 7), any(hull == 8), any(hull == 9)]), &
                     'a point inside is not on the outline')
      hull = convex_hull([1, 2, 3], [0.0_wp, 1.0_wp, 2.0_wp], [0.0_wp, 1.0_wp, 2.0_wp])
      call t%equal_integer(size(hull), 0, 'points on a line make no plate')
      hull = convex_hull([1, 2, 3], 1.0e-200_wp*[0.0_wp, 1.0_wp, 0.0_wp], 1.0e-200_wp*[0.0_wp, 0.0_wp, 1.0_wp])
      call t%equal_integer(size(hull), 3, 'very small plates')
   end subroutine outlines
end program test_markup
