!> Polynomial equations as sums of products of at most four numbers, of which some are unknown.
module psalm_product_sums
   implicit none (type, external)
   private
   public :: product_sums_t, most_factors

   integer, parameter :: most_factors = 4
   integer, parameter :: room_at_first = 256

   type :: product_sums_t
      integer :: unknowns = 0
      integer :: equations = 0
      integer :: terms = 0
      integer, allocatable :: place(:)               !! shape (numbers): which unknown a number is, 0: it is given
      integer, allocatable :: factors(:, :)          !! shape (most_factors, terms or more): numbers multiplied, 0: none
      integer, allocatable :: sign(:), equation(:)   !! shape (terms or more)
   contains
      procedure :: begin
      procedure :: next_equation
      procedure :: add
   end type product_sums_t

contains

   !> No equation yet; the unknowns in their order.
   subroutine begin(self, numbers, unknown)
      class(product_sums_t), intent(out) :: self
      integer, intent(in) :: numbers                 !! known and unknown together
      integer, intent(in) :: unknown(:)              !! which of them are unknown
      integer :: k

      allocate (self%place(numbers), source=0)
      do k = 1, size(unknown)
         self%place(unknown(k)) = k
      end do
      self%unknowns = size(unknown)
      allocate (self%factors(most_factors, room_at_first), self%sign(room_at_first), self%equation(room_at_first), source=0)
   end subroutine begin

   !> What is added from here on belongs to the next equation.
   elemental subroutine next_equation(self)
      class(product_sums_t), intent(inout) :: self

      self%equations = self%equations + 1
   end subroutine next_equation

   !> Add plus or minus a product to the equation.
   pure subroutine add(self, sign, factors)
      class(product_sums_t), intent(inout) :: self
      integer, intent(in) :: sign                    !! 1 or -1
      integer, intent(in) :: factors(:)              !! shape (at most most_factors)
      integer, allocatable :: more(:, :)
      integer :: n

      n = size(self%sign)
      if (self%terms == n) then
         allocate (more(most_factors, 2*n), source=0)
         more(:, :n) = self%factors
         call move_alloc(more, self%factors)
         self%sign = [self%sign, self%sign]
         self%equation = [self%equation, self%equation]
      end if
      self%terms = self%terms + 1
      self%factors(:, self%terms) = 0
      self%factors(:size(factors), self%terms) = factors
      self%sign(self%terms) = sign
      self%equation(self%terms) = self%equations
   end subroutine add
end module psalm_product_sums
