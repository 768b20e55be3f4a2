!> What a spring or damper pulls with, by its length and how fast that grows.
!>
!> Elastic: preload and stiffness; of a gas spring the preload times a power of the length that is left (polytropic change of
!> state); a table over the length. Viscous: linear and square damping. One that pulls or pushes only is slack on the other side of
!> its free length, and never acts the other way.
module psalm_spring_law
   use psalm_elementary, only: fractional_power
   use psalm_kinds, only: wp
   use psalm_piecewise, only: interpolated
   use psalm_spring_group, only: spring_group_t
   implicit none (type, external)
   private
   public :: spring_law_t, spring_law_of, part_all, part_elastic, part_viscous

   integer, parameter :: part_all = 0, part_elastic = 1, part_viscous = 2 !! what of it is wanted
   real(wp), parameter :: least_room = 1.0e-6_wp !! of a gas spring, a part of that at the free length: its law goes no farther

   !> A spring or damper without its ends. Lengths are in metres, of torsional ones angles in radians from where it is free.
   type :: spring_law_t
      logical :: torsional = .false.
      real(wp) :: stiffness = 0.0_wp        !! N/m, N m/rad
      real(wp) :: free = 0.0_wp             !! free length, user's length; angle, degrees
      real(wp) :: preload = 0.0_wp          !! N, N m
      real(wp) :: damping = 0.0_wp          !! N s/m, N m s/rad
      real(wp) :: drag = 0.0_wp             !! N s2/m2, N m s2/rad2: times the square of the speed
      integer :: side = 0                   !! 1: pulls only, -1: pushes only
      real(wp) :: power = 0.0_wp            !! of a gas spring; 0: none
      real(wp) :: closed = 0.0_wp           !! its length without room for the gas, user's length
      real(wp), allocatable :: table(:, :)  !! shape (rows, 2): lengths, user's, ascending, and pulls, N
      integer :: part = part_all
   contains
      procedure :: pull
      procedure :: slope
      procedure :: energy
      procedure :: is_closed
      procedure :: is_plain
      procedure :: damps
      procedure :: kinks
      procedure, private :: elastic
      procedure, private :: is_slack
   end type spring_law_t

contains

   pure type(spring_law_t) function spring_law_of(springs, k) result(law)
      type(spring_group_t), intent(in) :: springs
      integer, intent(in) :: k              !! entry

      law%torsional = springs%torsional(k)
      law%stiffness = springs%stiffness(k)
      law%free = springs%free(k)
      law%preload = springs%preload(k)
      law%damping = springs%damping(k)
      law%drag = springs%drag(k)
      law%side = springs%side(k)
      law%power = springs%power(k)
      law%closed = springs%closed(k)
      if (springs%table(k) > 0) then
         allocate (law%table(size(springs%table_length), 2))
         law%table(:, 1) = springs%table_length
         law%table(:, 2) = springs%table_pull(:, springs%table(k))
      end if
   end function spring_law_of

   !> The pull, N or N m, negative: it pushes. `stretch` is the length less the free one in metres, or the angle in radians.
   elemental real(wp) function pull(self, stretch, speed, metre)
      class(spring_law_t), intent(in) :: self
      real(wp), intent(in) :: stretch
      real(wp), intent(in) :: speed         !! m/s, rad/s
      real(wp), intent(in) :: metre         !! metres in a unit of length
      real(wp) :: elastic

      elastic = 0.0_wp
      if (self%part /= part_viscous .or. self%side /= 0) elastic = self%elastic(stretch, metre)
      if (self%part == part_elastic) then
         pull = elastic
         return
      end if
      if (self%is_slack(stretch)) then
         pull = 0.0_wp
         return
      end if
      if (self%part == part_all) then
         pull = elastic + self%damping*speed
      else
         pull = self%damping*speed
      end if
      if (abs(self%drag) > 0.0_wp) pull = pull + self%drag*speed*abs(speed)
      if (self%side == 0) return
      ! never the other way
      if (self%part == part_all) then
         if (real(self%side, wp)*pull < 0.0_wp) pull = 0.0_wp
      else
         if (real(self%side, wp)*(elastic + pull) < 0.0_wp) pull = -elastic
      end if
   end function pull

   !> True of one that acts on one side only where it is on the other.
   elemental logical function is_slack(self, stretch)
      class(spring_law_t), intent(in) :: self
      real(wp), intent(in) :: stretch

      is_slack = real(self%side, wp)*stretch < 0.0_wp
   end function is_slack

   !> Without damping.
   elemental real(wp) function elastic(self, stretch, metre)
      class(spring_law_t), intent(in) :: self
      real(wp), intent(in) :: stretch, metre

      if (self%is_slack(stretch)) then
         elastic = 0.0_wp
      else if (self%power > 0.0_wp) then
         elastic = self%preload/to_power(room_of(self, stretch, metre), self%power)
      else
         elastic = self%preload + self%stiffness*stretch
      end if
      if (allocated(self%table)) elastic = elastic + of_table(self%table, self%free + stretch/metre)
   end function elastic

   !> Room of a gas spring, a part of that at its free length.
   elemental real(wp) function room_of(self, stretch, metre) result(room)
      class(spring_law_t), intent(in) :: self
      real(wp), intent(in) :: stretch, metre

      room = max(least_room, 1.0_wp + stretch/((self%free - self%closed)*metre))
   end function room_of

   !> Growth of the elastic pull with the length.
   elemental real(wp) function slope(self, stretch, metre)
      class(spring_law_t), intent(in) :: self
      real(wp), intent(in) :: stretch, metre
      real(wp) :: room
      integer :: k

      slope = 0.0_wp
      if (self%is_slack(stretch)) return
      if (self%power > 0.0_wp) then
         room = room_of(self, stretch, metre)
         slope = -self%power*self%preload/(to_power(room, self%power)*room*(self%free - self%closed)*metre)
      else
         slope = self%stiffness
      end if
      if (.not. allocated(self%table)) return
      k = count(self%table(:, 1) <= self%free + stretch/metre)
      if (k > 0 .and. k < size(self%table, 1)) slope = slope + &
         (self%table(k + 1, 2) - self%table(k, 2))/((self%table(k + 1, 1) - self%table(k, 1))*metre)
   end function slope

   !> Potential energy, J: from the free length; of a table from its first length.
   elemental real(wp) function energy(self, stretch, metre)
      class(spring_law_t), intent(in) :: self
      real(wp), intent(in) :: stretch, metre
      real(wp) :: room, length, from, to
      integer :: k

      energy = 0.0_wp
      if (self%is_slack(stretch)) return
      if (self%power > 0.0_wp) then
         room = room_of(self, stretch, metre)
         energy = self%preload*(self%free - self%closed)*metre
         if (abs(self%power - 1.0_wp) > 0.0_wp) then
            energy = energy*(room/to_power(room, self%power) - 1.0_wp)/(1.0_wp - self%power)
         else
            energy = energy*logarithm(room)
         end if
      else
         energy = stretch*(self%preload + 0.5_wp*self%stiffness*stretch)
      end if
      if (.not. allocated(self%table)) return
      associate (l => self%table(:, 1), f => self%table(:, 2), rows => size(self%table, 1))
         length = self%free + stretch/metre
         energy = energy + metre*(min(length, l(1)) - l(1))*f(1) + metre*max(length - l(rows), 0.0_wp)*f(rows)
         do k = 1, rows - 1
            from = l(k)
            to = min(length, l(k + 1))
            if (to > from) energy = energy + 0.5_wp*metre*(to - from)*(f(k) + of_table(self%table, to))
         end do
         ! one that acts on one side only has its zero where it becomes slack
         if (self%side /= 0) energy = energy - table_energy_at_free(self, metre)
      end associate
   end function energy

   !> The same of the table alone at the free length.
   elemental real(wp) function table_energy_at_free(self, metre) result(energy)
      class(spring_law_t), intent(in) :: self
      real(wp), intent(in) :: metre
      type(spring_law_t) :: only

      only%free = self%free
      only%table = self%table
      energy = only%energy(0.0_wp, metre)
   end function table_energy_at_free

   !> True where a gas spring has no room left.
   elemental logical function is_closed(self, stretch, metre)
      class(spring_law_t), intent(in) :: self
      real(wp), intent(in) :: stretch, metre

      is_closed = .false.
      if (self%power > 0.0_wp) is_closed = .not. 1.0_wp + stretch/((self%free - self%closed)*metre) > least_room
   end function is_closed

   !> True of a spring whose pull grows with its length in a straight line, and of a linear damper.
   elemental logical function is_plain(self)
      class(spring_law_t), intent(in) :: self

      is_plain = self%side == 0 .and. .not. (self%power > 0.0_wp .or. abs(self%drag) > 0.0_wp .or. allocated(self%table))
   end function is_plain

   !> True of what has damping.
   elemental logical function damps(self)
      class(spring_law_t), intent(in) :: self

      damps = abs(self%damping) > 0.0_wp .or. abs(self%drag) > 0.0_wp
   end function damps

   !> Stretches at which the pull has a kink or a jump: metres or radians, ascending.
   pure function kinks(self, metre)
      class(spring_law_t), intent(in) :: self
      real(wp), intent(in) :: metre
      real(wp), allocatable :: kinks(:)

      allocate (kinks(0))
      if (allocated(self%table)) kinks = metre*(self%table(:, 1) - self%free)
      if (self%side == 0) return
      kinks = [pack(kinks, kinks < 0.0_wp), 0.0_wp, pack(kinks, kinks > 0.0_wp)]
   end function kinks

   !> The pull of a table at a length.
   pure real(wp) function of_table(table, length)
      real(wp), intent(in) :: table(:, :)
      real(wp), intent(in) :: length
      real(wp) :: values(1)

      values = interpolated(table(:, 1), table(:, 2), [length], .false.)
      of_table = values(1)
   end function of_table

   !> A power with any exponent above 0.
   elemental real(wp) function to_power(base, power)
      real(wp), intent(in) :: base, power
      integer :: whole, k

      whole = int(power)
      to_power = fractional_power(base, power - real(whole, wp))
      do k = 1, whole
         to_power = to_power*base
      end do
   end function to_power

   !> The natural logarithm, with the same digits on every processor: ln x = e ln 2 + 2 artanh((f - 1)/(f + 1)), x = f 2^e.
   elemental real(wp) function logarithm(x)
      real(wp), intent(in) :: x             !! above 0
      real(wp), parameter :: ln_2 = 0.693147180559945309417232121458176568_wp, middle = 0.7071067811865475244_wp
      real(wp) :: f, s, term
      integer :: e, k

      e = exponent(x)
      f = fraction(x)
      if (f < middle) then
         f = 2.0_wp*f
         e = e - 1
      end if
      s = (f - 1.0_wp)/(f + 1.0_wp)
      logarithm = 0.0_wp
      term = s
      k = 1
      do while (abs(term) > epsilon(s)*epsilon(s)*abs(s))
         logarithm = logarithm + term/real(k, wp)
         term = term*s*s
         k = k + 2
      end do
      logarithm = real(e, wp)*ln_2 + 2.0_wp*logarithm
   end function logarithm
end module psalm_spring_law
