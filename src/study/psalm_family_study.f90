!> The output for several settings of one adjustable dimension: a family of curves. Source: Oldham (1977), section 1.1.
module psalm_family_study
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t
   use psalm_stop, only: stop_t
   use psalm_text, only: lower_case
   implicit none (type, external)
   private
   public :: family_t, find_family, sets_one_of

   integer, parameter :: number_name = 48   !! characters of the name of a number

   type :: family_t
      character(:), allocatable :: name               !! of the dimension, in capitals; of a sketch its joints
      real(wp), allocatable :: setting(:)             !! shape (settings): length, or degrees
      real(wp), allocatable :: input(:)               !! shape (positions): as listings have it
      character(number_name), allocatable :: numbers(:) !! names of the numbers of the output
      character(number_name), allocatable :: columns(:) !! the same as names of columns
      logical, allocatable :: angle(:)                !! they are angles, degrees
      logical :: sets_angle = .false.                 !! the dimension is an angle
      logical :: slides = .false.                     !! the input is a length
      logical :: stopped = .false.                    !! the host asked for the end: the settings so far
      logical, allocatable :: closed(:, :)            !! shape (positions, settings)
      logical, allocatable :: beyond(:, :)            !! the same shape: not closed because it is not reached from the drawing
      real(wp), allocatable :: actual(:, :, :)        !! shape (positions, numbers, settings)
   contains
      procedure :: name_in_sentence
   end type family_t

   interface
      !> Of a linkage of dyads. `found` is false if its dimension cannot be set: a sliding arc has no length of its own.
      module subroutine find_family(set, mechanism, dimensions, delt, family, found, stop)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         type(mechanism_t), intent(in) :: mechanism
         type(dimensions_t), intent(in) :: dimensions    !! all others
         real(wp), intent(in) :: delt(:)                 !! increments of the input
         type(family_t), intent(out) :: family
         logical, intent(out) :: found
         type(stop_t), intent(in), optional :: stop      !! asked before each setting
      end subroutine find_family

      !> True if the dimension of SWEEP is the length of one of some arcs of a sketch.
      module logical function sets_one_of(set, which)
         implicit none (type, external)
         type(data_set_t), intent(in) :: set
         logical, intent(in) :: which(:)                 !! shape (arcs)
      end function sets_one_of
   end interface

contains

   !> The dimension of a sketch as it stands in a sentence: names of joints stay as they are.
   pure function name_in_sentence(self) result(name)
      class(family_t), intent(in) :: self
      character(:), allocatable :: name

      associate (first => index(self%name, ' '))
         name = lower_case(self%name(:first))//self%name(first + 1:)
      end associate
   end function name_in_sentence
end module psalm_family_study
