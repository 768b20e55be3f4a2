!> Whether allotted tolerances keep the bands for every linkage within them: proven, or refuted by a corner of the box.
module psalm_allocation_proof
   use psalm_kinds, only: wp
   use psalm_tolerance, only: allowance_t, deviating_t, tolerance_t, enclose_bands, find_deviations
   implicit none (type, external)
   private
   public :: allocation_proof_t, prove_bands
   public :: band_unasked, band_certified, band_violated, band_undecided

   integer, parameter :: band_unasked = 0, band_certified = 1, band_violated = 2, band_undecided = 3
   real(wp), parameter :: rounding = 64.0_wp*epsilon(1.0_wp) !! part of a number by which a corner must leave its band

   !> Arrays have the shape (bands).
   type :: allocation_proof_t
      logical :: asked = .false.
      integer, allocatable :: verdict(:)         !! one of `band_...`
      real(wp), allocatable :: low(:), high(:)   !! every linkage within the tolerances stays between them
      logical, allocatable :: known(:)           !! they are
      real(wp), allocatable :: corner(:)         !! largest deviation of a linkage at a corner; 0: none was looked at
      real(wp) :: factor = 1.0_wp                !! all tolerances times this are certified, at most 1; 0: none was found
   end type allocation_proof_t

contains

   !> Enclose the outputs; where the enclosure leaves the band, look at both corners that are worst to first order.
   subroutine prove_bands(deviating, linear, allowance, tolerance, position, number, width, proof)
      type(deviating_t), intent(in) :: deviating
      type(tolerance_t), intent(in) :: linear
      type(allowance_t), intent(in) :: allowance
      real(wp), intent(in) :: tolerance(:)       !! shape (dimensions)
      integer, intent(in) :: position(:), number(:) !! shape (bands)
      real(wp), intent(in) :: width(:)           !! shape (bands)
      type(allocation_proof_t), intent(out) :: proof
      real(wp), allocatable :: deviation(:), miss(:, :)
      integer :: j, side, columns, first
      logical :: closes

      proof%asked = .true.
      allocate (proof%verdict(size(width)), source=band_certified)
      allocate (proof%low(size(width)), proof%high(size(width)), proof%known(size(width)))
      allocate (proof%corner(size(width)), source=0.0_wp)
      call enclose_bands(deviating, linear, allowance, tolerance, position, number, width, proof%low, proof%high, proof%known, &
                         proof%factor)
      columns = size(linear%variables)
      first = 0
      if (allocated(linear%bands)) then
         columns = columns + size(linear%bands%of_apart)
         first = size(linear%effect, 3)
      end if
      allocate (deviation(columns))
      do j = 1, size(width)
         if (proof%known(j) .and. max(-proof%low(j), proof%high(j)) <= width(j)) cycle
         proof%verdict(j) = band_undecided
         do side = -1, 1, 2
            deviation = 0.0_wp
            deviation(allowance%column) = sign(tolerance, real(side, wp)*allowance%change(position(j), :, number(j)))
            call find_deviations(deviating, linear, deviation, miss, closes)
            if (.not. closes) then
               proof%verdict(j) = band_violated
               proof%corner(j) = huge(1.0_wp)
               exit
            end if
            associate (far => abs(miss(position(j), first + number(j))))
               proof%corner(j) = max(proof%corner(j), far)
               if (far > width(j) + rounding*(abs(linear%nominal%actual(position(j), 1)) + maxval(allowance%size))) &
                  proof%verdict(j) = band_violated
            end associate
         end do
      end do
   end subroutine prove_bands
end module psalm_allocation_proof
