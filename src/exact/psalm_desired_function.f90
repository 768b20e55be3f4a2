!> The function that a linkage is to generate: by name over a range, or as a table; input and output as angles or travel.
module psalm_desired_function
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: desired_function_t, function_names, function_kind, function_table

   character(*), parameter :: function_names(*) = [character(7) :: 'LOG10', 'LN', 'EXP', 'SIN', 'COS', 'TAN', 'POWER', 'TABLE']
   integer, parameter :: function_log10 = 1, function_ln = 2, function_exp = 3, function_sin = 4, function_cos = 5, &
                         function_tan = 6, function_power = 7, function_table = 8
   real(wp), parameter :: degree = 3.14159265358979323846264338327950288_wp/180.0_wp

   !> A function y(x) and how it is laid out on both axes.
   type :: desired_function_t
      integer :: kind = function_log10
      real(wp) :: low = 0.0_wp, high = 1.0_wp        !! range of x; of SIN, COS, TAN in degrees
      real(wp) :: power = 2.0_wp                     !! of POWER
      real(wp) :: swing_in = 1.0_wp                  !! radians of the input over the range
      real(wp) :: swing_out = 1.0_wp                 !! radians of the output, or travel
      integer :: sense = 1                           !! of the output
      logical :: slides = .false.                    !! the output is a travel
      logical :: prepared = .false.                  !! both of these are known
      real(wp) :: at_low = 0.0_wp, at_high = 0.0_wp  !! values at both ends of the range
      logical :: continuous = .true.                 !! false: only the entries of the table are wanted
      real(wp), allocatable :: table_input(:), table_output(:) !! radians; of a slide the travel
   contains
      procedure :: prepare
      procedure :: value_at
      procedure :: input_at
      procedure :: output_at
      procedure :: place_of
   end type desired_function_t

contains

   !> Number of a name, 0 if there is none.
   pure integer function function_kind(name)
      character(*), intent(in) :: name

      function_kind = findloc(function_names == name, .true., dim=1)
   end function function_kind

   !> Keep what every evaluation needs; not necessary.
   pure subroutine prepare(self)
      class(desired_function_t), intent(inout) :: self

      if (.not. self%continuous) return
      self%at_low = self%value_at(self%low)
      self%at_high = self%value_at(self%high)
      self%prepared = .true.
   end subroutine prepare

   !> y of x.
   elemental real(wp) function value_at(self, x)
      class(desired_function_t), intent(in) :: self
      real(wp), intent(in) :: x

      select case (self%kind)
      case (function_log10)
         value_at = log10(x)
      case (function_ln)
         value_at = log(x)
      case (function_exp)
         value_at = exp(x)
      case (function_sin)
         value_at = sin(x*degree)
      case (function_cos)
         value_at = cos(x*degree)
      case (function_tan)
         value_at = tan(x*degree)
      case default
         value_at = x**self%power
      end select
   end function value_at

   !> Input at a place from 0 to 1, radians.
   elemental real(wp) function input_at(self, place)
      class(desired_function_t), intent(in) :: self
      real(wp), intent(in) :: place

      input_at = self%swing_in*place
   end function input_at

   !> Output wanted there, radians or travel.
   elemental real(wp) function output_at(self, place)
      class(desired_function_t), intent(in) :: self
      real(wp), intent(in) :: place
      real(wp) :: first, last
      integer :: i

      if (self%continuous) then
         if (self%prepared) then
            first = self%at_low
            last = self%at_high
         else
            first = self%value_at(self%low)
            last = self%value_at(self%high)
         end if
         output_at = real(self%sense, wp)*self%swing_out* &
                     (self%value_at(self%low + place*(self%high - self%low)) - first)/(last - first)
      else
         i = minloc(abs(self%table_input - self%table_input(1) - place*self%swing_in), dim=1)
         output_at = real(self%sense, wp)*(self%table_output(i) - self%table_output(1))
      end if
   end function output_at

   !> Place of an entry of the table, from 0 to 1.
   elemental real(wp) function place_of(self, entry)
      class(desired_function_t), intent(in) :: self
      integer, intent(in) :: entry

      place_of = (self%table_input(entry) - self%table_input(1))/self%swing_in
   end function place_of
end module psalm_desired_function
