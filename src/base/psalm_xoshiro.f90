!> Random numbers for many starts and samples: xoshiro256**, with streams that do not overlap.
!>
!> The state is filled from a seed by splitmix64. Stream k begins k jumps of 2**128 numbers behind stream 0, so that whatever is
!> drawn from a stream depends on the seed and on k alone, never on who draws when; what is for another purpose is 2**192
!> numbers away. START keeps the thesis's generator
!> (`psalm_random`). Source: Blackman and Vigna (2021), Scrambled linear pseudorandom number generators; Steele, Lea and
!> Flood (2014), Fast splittable pseudorandom number generators.
!>
!> Integers of 64 bits without sign are held in integers with sign; sums and products are formed from halves, so that none
!> overflows.
module psalm_xoshiro
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: xoshiro_t, splitmix, purpose_starts, purpose_sample

   ! what numbers are for: those of the same seed must not be the same
   integer, parameter :: purpose_starts = 0    !! starts of a search
   integer, parameter :: purpose_sample = 1    !! a sample of deviations

   integer, parameter :: words = 4, word_bits = 64, half_bits = 32
   integer(int64), parameter :: factors(2) = [5_int64, 9_int64] !! of what is shown, before and after it is rotated ...
   integer, parameter :: rotation = 7                        !! ... by so many bits
   integer, parameter :: bits_used = 53                      !! of a number: the digits of real64
   integer(int64), parameter :: half_mask = int(z'FFFFFFFF', int64)
   integer(int64), parameter :: golden = int(z'9E3779B97F4A7C15', int64) !! step of splitmix64: 2**64 over the golden ratio, odd
   integer(int64), parameter :: mix1 = int(z'BF58476D1CE4E5B9', int64), mix2 = int(z'94D049BB133111EB', int64)
   !> The polynomial that jumps 2**128 numbers ahead, as its authors give it.
   integer(int64), parameter :: jump_bits(words) = [int(z'180EC6D33CFD0ABA', int64), int(z'D5A61266F0C9392C', int64), &
                                                    int(z'A9582618E03FC9AA', int64), int(z'39ABDC4529B1661C', int64)]
   !> The one for 2**192 numbers.
   integer(int64), parameter :: long_jump_bits(words) = [int(z'76E15D3EFEFDCBBF', int64), int(z'C5004E441C522FB3', int64), &
                                                         int(z'77710069854EE241', int64), int(z'39109BB02ACBE635', int64)]

   type :: xoshiro_t
      integer(int64) :: state(words) = [1_int64, 2_int64, 3_int64, 4_int64]
      integer(int64), private :: first(words) = [1_int64, 2_int64, 3_int64, 4_int64] !! the state stream 0 begins with
      integer(int64), private :: begin(words) = [1_int64, 2_int64, 3_int64, 4_int64] !! that of this stream
      integer, private :: stream = 0
   contains
      procedure :: seed
      procedure :: use_stream
      procedure :: jump
      procedure :: long_jump
      procedure :: next_bits
      procedure :: next
      procedure :: next_many
   end type xoshiro_t

contains

   !> Begin stream 0 of a seed.
   pure subroutine seed(self, number, purpose)
      class(xoshiro_t), intent(inout) :: self
      integer, intent(in) :: number
      integer, intent(in) :: purpose                  !! one of `purpose_...`
      integer(int64) :: state
      integer :: i

      state = int(number, int64)
      do i = 1, words
         call splitmix(state, self%state(i))
      end do
      do i = 1, purpose
         call self%long_jump()
      end do
      self%first = self%state
      self%begin = self%state
      self%stream = 0
   end subroutine seed

   !> Go to the beginning of a stream, 0 or above. Costs a jump for each stream passed, so go upwards.
   pure subroutine use_stream(self, stream)
      class(xoshiro_t), intent(inout) :: self
      integer, intent(in) :: stream
      integer :: i

      if (stream < self%stream) then
         self%begin = self%first
         self%stream = 0
      end if
      self%state = self%begin
      do i = self%stream + 1, stream
         call self%jump()
      end do
      self%begin = self%state
      self%stream = stream
   end subroutine use_stream

   !> Go 2**128 numbers ahead.
   pure subroutine jump(self)
      class(xoshiro_t), intent(inout) :: self

      call go_ahead(self, jump_bits)
   end subroutine jump

   !> Go 2**192 numbers ahead.
   pure subroutine long_jump(self)
      class(xoshiro_t), intent(inout) :: self

      call go_ahead(self, long_jump_bits)
   end subroutine long_jump

   !> Apply a polynomial of the step to the state.
   pure subroutine go_ahead(self, polynomial)
      class(xoshiro_t), intent(inout) :: self
      integer(int64), intent(in) :: polynomial(words)
      integer(int64) :: ahead(words), unused
      integer :: i, b

      ahead = 0_int64
      do i = 1, words
         do b = 0, word_bits - 1
            if (btest(polynomial(i), b)) ahead = ieor(ahead, self%state)
            call self%next_bits(unused)
         end do
      end do
      self%state = ahead
   end subroutine go_ahead

   !> The next 64 bits.
   pure subroutine next_bits(self, bits)
      class(xoshiro_t), intent(inout) :: self
      integer(int64), intent(out) :: bits

      bits = times_small(ishftc(times_small(self%state(2), factors(1)), rotation), factors(2))
      call step(self%state)
   end subroutine next_bits

   !> One number further.
   pure subroutine step(s)
      integer(int64), intent(inout) :: s(words)
      integer(int64) :: shifted

      shifted = shiftl(s(2), 17)
      s(3) = ieor(s(3), s(1))
      s(4) = ieor(s(4), s(2))
      s(2) = ieor(s(2), s(3))
      s(1) = ieor(s(1), s(4))
      s(3) = ieor(s(3), shifted)
      s(4) = ishftc(s(4), 45)
   end subroutine step

   !> Next deviate, uniform in (0, 1): the middle of one of 2**53 equal parts.
   pure subroutine next(self, deviate)
      class(xoshiro_t), intent(inout) :: self
      real(wp), intent(out) :: deviate
      integer(int64) :: bits

      call self%next_bits(bits)
      deviate = deviate_of(bits)
   end subroutine next

   !> The next deviates: those that `next` gives one by one.
   pure subroutine next_many(self, n, deviates)
      class(xoshiro_t), intent(inout) :: self
      integer, intent(in) :: n
      real(wp), intent(out) :: deviates(n)
      integer, parameter :: strip = 64            ! at a time: the states follow each other, what is shown of them does not
      integer(int64) :: seen(strip), turned(strip), state(words)
      integer :: first, m, i

      state = self%state
      do first = 0, n - 1, strip
         m = min(strip, n - first)
         do i = 1, m
            seen(i) = state(2)
            call step(state)
         end do
         ! by both of its parts: gfortran 12 has no vector of words that are rotated
         do i = 1, m
            seen(i) = times_small(seen(i), factors(1))
            turned(i) = shiftl(seen(i), rotation)
         end do
         do i = 1, m
            deviates(first + i) = deviate_of(times_small(ior(turned(i), shiftr(seen(i), word_bits - rotation)), factors(2)))
         end do
      end do
      self%state = state
   end subroutine next_many

   !> The middle of one of 2**53 equal parts of (0, 1).
   elemental real(wp) function deviate_of(bits)
      integer(int64), intent(in) :: bits

      ! in real32 the largest rounds to 1
      deviate_of = min((real(shiftr(bits, word_bits - bits_used), wp) + 0.5_wp)*0.5_wp**bits_used, 1.0_wp - 0.5_wp*epsilon(1.0_wp))
   end function deviate_of

   !> Next number of splitmix64.
   pure subroutine splitmix(state, bits)
      integer(int64), intent(inout) :: state
      integer(int64), intent(out) :: bits

      state = plus(state, golden)
      bits = times(ieor(state, shiftr(state, 30)), mix1)
      bits = times(ieor(bits, shiftr(bits, 27)), mix2)
      bits = ieor(bits, shiftr(bits, 31))
   end subroutine splitmix

   !> a + b modulo 2**64.
   elemental integer(int64) function plus(a, b)
      integer(int64), intent(in) :: a, b
      integer(int64) :: low

      low = iand(a, half_mask) + iand(b, half_mask)
      plus = ior(shiftl(shiftr(a, half_bits) + shiftr(b, half_bits) + shiftr(low, half_bits), half_bits), iand(low, half_mask))
   end function plus

   !> a b modulo 2**64 for a small positive b.
   elemental integer(int64) function times_small(a, b)
      integer(int64), intent(in) :: a, b
      integer(int64) :: low

      low = b*iand(a, half_mask)
      times_small = ior(shiftl(b*shiftr(a, half_bits) + shiftr(low, half_bits), half_bits), iand(low, half_mask))
   end function times_small

   !> a b modulo 2**64, by quarters of b.
   elemental integer(int64) function times(a, b)
      integer(int64), intent(in) :: a, b
      integer, parameter :: quarter_bits = 16
      integer :: i

      times = 0_int64
      do i = 0, word_bits - quarter_bits, quarter_bits
         times = plus(times, shiftl(times_small(a, ibits(b, i, quarter_bits)), i))
      end do
   end function times
end module psalm_xoshiro
