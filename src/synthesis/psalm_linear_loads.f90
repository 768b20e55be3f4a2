!> Loads as they depend on counterweights: every load of a mechanism is linear in the mass, first moments and moment of inertia
!> of what is added to its links. Source: Haines (about 1982), 8A to 8C.
module psalm_linear_loads
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: channel_t, measure_t, values_of, measure_of, parameters_of_weight, weight_mass, weight_px, weight_py, weight_inertia
   public :: about_anchor

   integer, parameter :: parameters_of_weight = 4 !! of what is added to a link, about its anchor, in the axes of the link:
   integer, parameter :: weight_mass = 1, weight_px = 2, weight_py = 3, weight_inertia = 4 !! kg, kg m, kg m, kg m2

   !> One load: a force of two components, or a moment, at every position.
   type :: channel_t
      character(:), allocatable :: name
      real(wp), allocatable :: bare(:, :)         !! shape (positions, components): N or N m
      real(wp), allocatable :: slope(:, :, :, :)  !! shape (positions, components, 4, links): by what is added to a link
   end type channel_t

   !> What a load does over all positions.
   type :: measure_t
      real(wp) :: rms = 0.0_wp                    !! components pooled
      real(wp) :: peak = 0.0_wp                   !! greatest amount
      real(wp), allocatable :: parts(:)           !! RMS of each component
   end type measure_t

contains

   !> Values of a load with something added. Shape of the result: (positions, components).
   pure function values_of(channel, added) result(values)
      type(channel_t), intent(in) :: channel
      real(wp), intent(in) :: added(:, :)         !! shape (4, links)
      real(wp), allocatable :: values(:, :)
      integer :: b, k

      values = channel%bare
      do b = 1, size(added, 2)
         do k = 1, parameters_of_weight
            if (abs(added(k, b)) > 0.0_wp) values = values + added(k, b)*channel%slope(:, :, k, b)
         end do
      end do
   end function values_of

   !> RMS and peak of a load with something added.
   pure type(measure_t) function measure_of(channel, added) result(measure)
      type(channel_t), intent(in) :: channel
      real(wp), intent(in) :: added(:, :)         !! shape (4, links)
      real(wp), allocatable :: values(:, :)
      integer :: c

      values = values_of(channel, added)
      measure%parts = [(sqrt(sum(values(:, c)**2)/real(size(values, 1), wp)), c=1, size(values, 2))]
      measure%rms = sqrt(sum(values**2)/real(size(values), wp))
      measure%peak = sqrt(maxval(sum(values**2, dim=2)))
   end function measure_of

   !> Columns of unit masses about an anchor from those about another point. Shapes: (positions, components, 4).
   pure function about_anchor(columns, anchor) result(moved)
      real(wp), intent(in) :: columns(:, :, :)    !! by mass, first moments and inertia about a point of the link
      real(wp), intent(in) :: anchor(2)           !! from that point, axes of the link, m
      real(wp) :: moved(size(columns, 1), size(columns, 2), parameters_of_weight)

      moved(:, :, weight_inertia) = columns(:, :, weight_inertia)
      moved(:, :, weight_px) = columns(:, :, weight_px) + 2.0_wp*anchor(1)*columns(:, :, weight_inertia)
      moved(:, :, weight_py) = columns(:, :, weight_py) + 2.0_wp*anchor(2)*columns(:, :, weight_inertia)
      moved(:, :, weight_mass) = columns(:, :, weight_mass) + anchor(1)*columns(:, :, weight_px) + &
                                 anchor(2)*columns(:, :, weight_py) + sum(anchor**2)*columns(:, :, weight_inertia)
   end function about_anchor
end module psalm_linear_loads
