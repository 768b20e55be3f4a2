!> Numbers as characters, for tables in the source.
!>
!> Sign, exponent and 29 bits of a number are written with six of 87 printable characters that mean nothing inside quotes; with 23
!> bits, single precision, with five.
module psalm_start_text
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: encode, decode, encode_short, decode_short, characters_a_number, characters_short

   integer, parameter :: characters_a_number = 6, characters_short = 5
   integer, parameter :: first_character = 40        !! of 87: behind quotes and ampersand
   integer(int64), parameter :: base = 87_int64      !! 87**6 > 2**38, 87**5 > 2**32
   integer, parameter :: mantissa_bits = 29, short_bits = 23
   integer(int64), parameter :: exponents = 256_int64, middle = 128_int64

contains

   !> The number, rounded to 29 bits, as text. A number below 2**-128 is 0, one above 2**127 must not be.
   pure function encode(value) result(text)
      real(wp), intent(in) :: value
      character(characters_a_number) :: text

      text = written(value, mantissa_bits, characters_a_number)
   end function encode

   !> The number of a text.
   pure real(wp) function decode(text) result(value)
      character(characters_a_number), intent(in) :: text

      value = number_of(text, mantissa_bits)
   end function decode

   !> The same with 23 bits.
   pure function encode_short(value) result(text)
      real(wp), intent(in) :: value
      character(characters_short) :: text

      text = written(value, short_bits, characters_short)
   end function encode_short

   pure real(wp) function decode_short(text) result(value)
      character(characters_short), intent(in) :: text

      value = number_of(text, short_bits)
   end function decode_short

   pure function written(value, bits, characters) result(text)
      real(wp), intent(in) :: value
      integer, intent(in) :: bits, characters
      character(characters) :: text
      integer(int64) :: code, power, mantissa
      integer :: i

      mantissa = nint(scale(abs(fraction(value)), bits), int64)
      power = int(exponent(value), int64) + middle
      if (mantissa == 2_int64**bits) then
         mantissa = mantissa/2_int64
         power = power + 1_int64
      end if
      if (power < 0_int64) then
         mantissa = 0_int64
         power = 0_int64
      end if
      code = merge(1_int64, 0_int64, value < 0.0_wp) + 2_int64*(power + exponents*mantissa)
      do i = 1, characters
         text(i:i) = achar(first_character + int(modulo(code, base)))
         code = code/base
      end do
   end function written

   pure real(wp) function number_of(text, bits) result(value)
      character(*), intent(in) :: text
      integer, intent(in) :: bits
      integer(int64) :: code, power
      integer :: i, side

      code = 0_int64
      do i = len(text), 1, -1
         code = code*base + int(iachar(text(i:i)) - first_character, int64)
      end do
      side = merge(-1, 1, modulo(code, 2_int64) == 1_int64)
      code = code/2_int64
      power = modulo(code, exponents) - middle
      value = real(side, wp)*scale(real(code/exponents, wp), int(power) - bits)
   end function number_of
end module psalm_start_text
