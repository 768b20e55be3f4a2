!> The thesis's random numbers: the power residue method of the IBM 360 routine RANDU.
!>
!> START draws its vertices with it. Kept because runs must repeat, on any machine, from the start integer ISTART; not because
!> it is a good generator. What is random elsewhere comes from `psalm_xoshiro`.
!> Source: Oldham (1977), sections 6.4.2 and 7.2.3.
module psalm_random
   use psalm_kinds, only: wp, i8
   implicit none (type, external)
   private
   public :: random_t

   integer(i8), parameter :: multiplier = 65539_i8       !! 2**16 + 3
   integer(i8), parameter :: modulus = 2147483648_i8     !! 2**31

   !> State of the sequence.
   type :: random_t
      integer(i8) :: state = 19_i8 !! odd, below 2**31; 19 is the default of ISTART
   contains
      procedure :: next
   end type random_t

contains

   !> Next deviate, uniform in (0, 1); advances the state.
   pure subroutine next(self, deviate)
      class(random_t), intent(inout) :: self
      real(wp), intent(out) :: deviate !! in (0, 1)

      self%state = mod(multiplier*self%state, modulus)
      deviate = real(self%state, wp)/real(modulus, wp)
   end subroutine next
end module psalm_random
