!> The distribution of a sum of independent deviations, each within its tolerance, and the width that holds a share of it.
!>
!> Uniform deviations within +-a_i: with the largest, a, taken out, a share P(b) of the sums lies within +-b,
!> 2 a P(b) = D(a + b) - D(|a - b|), where D(x) is the mean of |x - R| over the sum R of all others. D is the series
!> L/2 - 4 L/pi**2 sum over odd k of cos(k pi x/L)/k**2 times the characteristic function of R at k pi/L, for any L of at least
!> twice the largest |R|. A triangular deviation is the sum of two uniform ones within half its tolerance each. Of normal
!> deviations the tolerance is three standard deviations.
!>
!> A place that is uniform in a disc of the radius a deviates in any direction by the density 2 sqrt(a**2 - x**2)/(pi a**2): its
!> variance is a**2/4, its characteristic function 2 J1(a t)/(a t). It is one of the others; where there is no uniform deviation
!> P(b) = D'(b).
module psalm_sum_law
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_kinds, only: wp, degrees_per_radian, half_turn, pi, radians_per_degree
   implicit none (type, external)
   private
   public :: law_uniform, law_triangle, law_normal, normal_of_disc, half_width, share_within, standard_normal

   integer, parameter :: law_uniform = 1, law_triangle = 2, law_normal = 3
   real(wp), parameter :: deviations_of_tolerance = 3.0_wp !! of a normal deviation: standard deviations within its tolerance
   real(wp), parameter :: normal_of_disc = 1.5_wp         !! tolerance of a normal deviation with a disc's variance, by its radius
   real(wp), parameter :: of_envelope = 1.6_wp            !! |2 J1(z)/z| is at most that times z**-1.5
   integer, parameter :: most_terms = 4096                !! of the series
   real(wp), parameter :: least_term = 1.0e-14_wp         !! where it ends
   real(wp), parameter :: least_effect = 1.0e-12_wp       !! of the largest: smaller ones are none
   real(wp), parameter :: least_uniform = 1.0e-6_wp      !! of the largest: a smaller uniform deviation is not taken out
   integer, parameter :: most_rounds = 200                !! of a search for a width
   real(wp), parameter :: nearness = 1.0e-13_wp           !! of a width that is found, of all deviations together
   ! the normal distribution turned round, algorithm AS 241 (Wichura 1988): numerators and denominators of the middle and of the
   ! two parts of the tails
   integer, parameter :: degree = 7
   real(wp), parameter :: middle = 0.425_wp, of_middle = 0.180625_wp, far = 5.0_wp, of_near = 1.6_wp
   real(wp), parameter :: a(0:degree) = [3.3871328727963666080_wp, 133.14166789178437745_wp, 1971.5909503065514427_wp, &
                                         13731.693765509461125_wp, 45921.953931549871457_wp, 67265.770927008700853_wp, &
                                         33430.575583588128105_wp, 2509.0809287301226727_wp]
   real(wp), parameter :: b(0:degree) = [1.0_wp, 42.313330701600911252_wp, 687.18700749205790830_wp, 5394.1960214247511077_wp, &
                                         21213.794301586595867_wp, 39307.895800092710610_wp, 28729.085735721942674_wp, &
                                         5226.4952788528545610_wp]
   real(wp), parameter :: c(0:degree) = [1.42343711074968357734_wp, 4.63033784615654529590_wp, 5.76949722146069140550_wp, &
                                         3.64784832476320460504_wp, 1.27045825245236838258_wp, 0.241780725177450611770_wp, &
                                         2.27238449892691845833e-2_wp, 7.74545014278341407640e-4_wp]
   real(wp), parameter :: d(0:degree) = [1.0_wp, 2.05319162663775882187_wp, 1.67638483018380384940_wp, 0.689767334985100004550_wp, &
                                         0.148103976427480074590_wp, 1.51986665636164571966e-2_wp, 5.47593808499534494600e-4_wp, &
                                         1.05075007164441684324e-9_wp]
   real(wp), parameter :: e(0:degree) = [6.65790464350110377720_wp, 5.46378491116411436990_wp, 1.78482653991729133580_wp, &
                                         0.296560571828504891230_wp, 2.65321895265761230930e-2_wp, 1.24266094738807843860e-3_wp, &
                                         2.71155556874348757815e-5_wp, 2.01033439929228813265e-7_wp]
   real(wp), parameter :: f(0:degree) = [1.0_wp, 0.599832206555887937690_wp, 0.136929880922735805310_wp, &
                                         1.48753612908506148525e-2_wp, &
                                         7.86869131145613259100e-4_wp, 1.84631831751005468180e-5_wp, 1.42151175831644588870e-7_wp, &
                                         2.04426310338993978564e-15_wp]

   !> Uniform deviations: the largest and the sum of all others.
   type :: sum_t
      integer :: largest = 0                              !! its number; 0: there is none, and the others are all
      real(wp) :: a = 0.0_wp                              !! its amount
      integer, allocatable :: others(:)                   !! their numbers
      real(wp) :: all_others = 0.0_wp                     !! sum of their amounts
      logical :: one_uniform = .false., one_disc = .false. !! there is one other: closed forms
      real(wp) :: length = 0.0_wp                         !! L
      integer :: terms = 0                                !! of the series; term i is of k = 2 i - 1
      real(wp), allocatable :: sine(:, :), cosine(:, :)   !! shape (terms, others): of z = k pi a_i/L; of a disc 2 J1(z) and
                                                          !! 2 J1(z)/z - 2 J2(z), which enter in the same way
      real(wp), allocatable :: characteristic(:)          !! shape (terms)
   end type sum_t

contains

   !> The width to either side within which a share of the sums lies, and its change with every effect.
   pure subroutine half_width(law, effect, share, width, slope, disc)
      integer, intent(in) :: law                          !! one of `law_...`
      real(wp), intent(in) :: effect(:)                   !! largest deviations, of any sign
      real(wp), intent(in) :: share                       !! above 0, below 1
      real(wp), intent(out) :: width
      real(wp), intent(out) :: slope(:)                   !! shape (effects): by the amount of each
      logical, intent(in), optional :: disc(:)            !! shape (effects): radius of a disc, whatever the law of the others
      real(wp) :: amount(size(effect)), halves(2*size(effect)), of_halves(2*size(effect)), sigma
      logical :: round(size(effect))
      integer :: n

      n = size(effect)
      amount = abs(effect)
      round = .false.
      if (present(disc)) round = disc
      where (round .and. law == law_normal) amount = normal_of_disc*amount
      width = 0.0_wp
      slope = 0.0_wp
      if (.not. any(amount > 0.0_wp)) return
      select case (law)
      case (law_normal)
         sigma = sqrt(sum(amount**2))/deviations_of_tolerance
         width = normal_width(share)*sigma
         slope = width*amount/sum(amount**2)
         where (round) slope = normal_of_disc*slope
      case (law_triangle)
         halves = halves_of(amount, round)
         call width_of_uniform(halves, share, width, of_halves, [round, round])
         slope = 0.5_wp*(of_halves(:n) + of_halves(n + 1:))
         where (round) slope = of_halves(:n)
      case default
         call width_of_uniform(amount, share, width, slope, round)
      end select
   end subroutine half_width

   !> Share of the sums within a band to either side.
   pure real(wp) function share_within(law, effect, band, disc) result(share)
      integer, intent(in) :: law                          !! one of `law_...`
      real(wp), intent(in) :: effect(:)                   !! largest deviations, of any sign
      real(wp), intent(in) :: band
      logical, intent(in), optional :: disc(:)            !! shape (effects), see `half_width`
      real(wp) :: amount(size(effect)), density
      logical :: round(size(effect))
      type(sum_t) :: of

      amount = abs(effect)
      round = .false.
      if (present(disc)) round = disc
      where (round .and. law == law_normal) amount = normal_of_disc*amount
      share = 1.0_wp
      if (.not. any(amount > 0.0_wp)) return
      select case (law)
      case (law_normal)
         share = erf(band*deviations_of_tolerance/sqrt(2.0_wp*sum(amount**2)))
      case (law_triangle)
         call prepare(halves_of(amount, round), [round, round], of)
         call find_share(of, band, share, density)
      case default
         call prepare(amount, round, of)
         call find_share(of, band, share, density)
      end select
   end function share_within

   !> Triangular deviations as two uniform ones each; a disc stays one.
   pure function halves_of(amount, round) result(halves)
      real(wp), intent(in) :: amount(:)
      logical, intent(in) :: round(:)                     !! the same shape
      real(wp) :: halves(2*size(amount))

      halves = [merge(amount, 0.5_wp*amount, round), merge(0.0_wp, 0.5_wp*amount, round)]
   end function halves_of

   !> Standard deviations to either side that hold a share of a normal distribution.
   pure real(wp) function normal_width(share) result(width)
      real(wp), intent(in) :: share
      real(wp) :: low, high
      integer :: k

      low = 0.0_wp
      high = 40.0_wp
      do k = 1, most_rounds
         width = 0.5_wp*(low + high)
         if (width <= low .or. width >= high) exit
         if (erf(width/sqrt(2.0_wp)) < share) then
            low = width
         else
            high = width
         end if
      end do
      width = high
   end function normal_width

   !> A normal deviation of a deviate that is uniform in (0, 1), as part of its tolerance.
   elemental real(wp) function standard_normal(deviate) result(deviation)
      real(wp), intent(in) :: deviate
      real(wp) :: from_middle, r

      from_middle = deviate - 0.5_wp
      if (abs(from_middle) <= middle) then
         r = of_middle - from_middle**2
         deviation = from_middle*polynomial(a, r)/polynomial(b, r)
      else
         r = sqrt(-logarithm(min(deviate, 1.0_wp - deviate)))
         if (r <= far) then
            deviation = polynomial(c, r - of_near)/polynomial(d, r - of_near)
         else
            deviation = polynomial(e, r - far)/polynomial(f, r - far)
         end if
         deviation = sign(deviation, from_middle)
      end if
      deviation = deviation/deviations_of_tolerance
   end function standard_normal

   !> The natural logarithm of a positive number, the same on every processor: 2 artanh((m - 1)/(m + 1)) of the mantissa, with
   !> 1/sqrt(2) <= m < sqrt(2), and the exponent times log 2.
   pure real(wp) function logarithm(x)
      real(wp), intent(in) :: x
      real(wp), parameter :: log_2 = 0.69314718055994530941723212145817656807_wp
      integer, parameter :: terms = 24               !! 0.1716**(2*24) is below 1E-36
      real(wp) :: mantissa, z, power
      integer :: k, twos

      mantissa = fraction(x)
      twos = exponent(x)
      if (mantissa < sqrt(0.5_wp)) then
         mantissa = 2.0_wp*mantissa
         twos = twos - 1
      end if
      z = (mantissa - 1.0_wp)/(mantissa + 1.0_wp)
      power = 0.0_wp
      do k = terms, 0, -1
         power = power*z**2 + 2.0_wp/real(2*k + 1, wp)
      end do
      logarithm = real(twos, wp)*log_2 + z*power
   end function logarithm

   pure real(wp) function polynomial(coefficients, x) result(value)
      real(wp), intent(in) :: coefficients(0:), x
      integer :: k

      value = coefficients(ubound(coefficients, 1))
      do k = ubound(coefficients, 1) - 1, 0, -1
         value = value*x + coefficients(k)
      end do
   end function polynomial

   !> Width and slopes of uniform deviations: Newton's method within a bracket.
   pure subroutine width_of_uniform(amount, share, width, slope, round)
      real(wp), intent(in) :: amount(:), share
      real(wp), intent(out) :: width, slope(:)
      logical, intent(in) :: round(:)                     !! shape (amounts): of a disc
      type(sum_t) :: of
      real(wp) :: low, high, found, density, next
      integer :: k

      call prepare(amount, round, of)
      low = 0.0_wp
      high = of%a + of%all_others
      width = share*high
      do k = 1, most_rounds
         call find_share(of, width, found, density)
         if (found < share) then
            low = width
         else
            high = width
         end if
         next = width
         if (density > 0.0_wp) next = width - (found - share)/density
         if (.not. (next > low .and. next < high) .or. .not. density > 0.0_wp) next = 0.5_wp*(low + high)
         if (abs(next - width) <= nearness*(of%a + of%all_others)) exit
         width = next
      end do
      call find_slopes(of, width, amount, share, slope)
   end subroutine width_of_uniform

   !> The largest deviation, and the characteristic function of the sum of all others.
   pure subroutine prepare(amount, round, of)
      real(wp), intent(in) :: amount(:)
      logical, intent(in) :: round(:)                     !! shape (amounts): of a disc
      type(sum_t), intent(out) :: of
      real(wp) :: envelope, c, s, c2, s2, before(2), k, most, j0, j1
      integer :: i, j, terms

      most = maxval(amount)
      of%largest = maxloc(merge(0.0_wp, amount, round), dim=1)
      of%a = amount(of%largest)
      if (any(round)) then
         if (round(of%largest) .or. amount(of%largest) < least_uniform*most) then
            of%largest = 0
            of%a = 0.0_wp
         end if
      end if
      of%others = pack([(i, i=1, size(amount))], amount > least_effect*most .and. [(i /= of%largest, i=1, size(amount))])
      of%all_others = sum(amount(of%others))
      if (size(of%others) == 1) then
         of%one_uniform = .not. round(of%others(1))
         of%one_disc = round(of%others(1)) .and. of%largest == 0
      end if
      of%length = 2.0_wp*of%all_others
      if (size(of%others) == 0) return
      terms = most_terms
      do i = 1, most_terms
         k = real(2*i - 1, wp)
         envelope = 1.0_wp/k
         do j = 1, size(of%others)
            associate (z => k*pi*amount(of%others(j))/of%length)
               if (round(of%others(j))) then
                  envelope = envelope*min(1.0_wp, of_envelope/(z*sqrt(z)))
               else
                  envelope = envelope*min(1.0_wp, of%length/(k*pi*amount(of%others(j))))
               end if
            end associate
         end do
         if (envelope > least_term) cycle
         terms = i
         exit
      end do
      of%terms = terms
      allocate (of%sine(terms, size(of%others)), of%cosine(terms, size(of%others)))
      allocate (of%characteristic(terms), source=1.0_wp)
      do j = 1, size(of%others)
         if (round(of%others(j))) then
            do i = 1, terms
               associate (z => argument(of, i, amount(of%others(j))))
                  call find_bessel(z, j0, j1)
                  of%sine(i, j) = 2.0_wp*j1
                  of%cosine(i, j) = 2.0_wp*j0 - 2.0_wp*j1/z
                  of%characteristic(i) = of%characteristic(i)*of%sine(i, j)/z
               end associate
            end do
            cycle
         end if
         call unit_vector(half_turn*amount(of%others(j))/of%length, c, s)
         c2 = c**2 - s**2
         s2 = 2.0_wp*s*c
         of%sine(1, j) = s
         of%cosine(1, j) = c
         do i = 2, terms
            before = [of%sine(i - 1, j), of%cosine(i - 1, j)]
            of%sine(i, j) = before(1)*c2 + before(2)*s2
            of%cosine(i, j) = before(2)*c2 - before(1)*s2
         end do
         do i = 1, terms
            of%characteristic(i) = of%characteristic(i)*of%sine(i, j)/argument(of, i, amount(of%others(j)))
         end do
      end do
   end subroutine prepare

   !> k pi a/L of term i.
   pure real(wp) function argument(of, i, amount)
      type(sum_t), intent(in) :: of
      integer, intent(in) :: i
      real(wp), intent(in) :: amount

      argument = real(2*i - 1, wp)*pi*amount/of%length
   end function argument

   !> Share within a band, and its change with the band.
   pure subroutine find_share(of, band, share, density)
      type(sum_t), intent(in) :: of
      real(wp), intent(in) :: band
      real(wp), intent(out) :: share, density
      real(wp) :: outer(2), inner(2)

      share = 1.0_wp
      density = 0.0_wp
      if (band >= of%a + of%all_others) return
      if (of%largest == 0) then
         inner = mean_distance(of, band)
         share = inner(2)
         density = density_of_others(of, band)
         return
      end if
      outer = mean_distance(of, of%a + band)
      inner = mean_distance(of, abs(band - of%a))
      share = (outer(1) - inner(1))/(2.0_wp*of%a)
      density = (outer(2) - sign(inner(2), band - of%a))/(2.0_wp*of%a)
   end subroutine find_share

   !> D(x) of the other deviations, and its derivative.
   pure function mean_distance(of, x) result(d)
      type(sum_t), intent(in) :: of
      real(wp), intent(in) :: x                           !! not negative
      real(wp) :: d(2)
      real(wp) :: c, s, c2, s2, before(2), k
      integer :: i

      d = [x, 1.0_wp]
      if (x >= of%all_others) return
      if (of%one_uniform) then
         d = [0.5_wp*(x**2/of%all_others + of%all_others), x/of%all_others]
         return
      else if (of%one_disc) then
         ! of the share alone; the distance is not needed
         associate (part => x/of%all_others)
            d(2) = 2.0_wp/pi*(part*sqrt(1.0_wp - part**2) + degrees_of(sqrt(1.0_wp - part**2), part)*radians_per_degree)
         end associate
         return
      end if
      call unit_vector(half_turn*x/of%length, c, s)
      c2 = c**2 - s**2
      s2 = 2.0_wp*s*c
      d = 0.0_wp
      do i = 1, of%terms
         k = real(2*i - 1, wp)
         d(1) = d(1) + c*of%characteristic(i)/k**2
         d(2) = d(2) + s*of%characteristic(i)/k
         before = [s, c]
         s = before(1)*c2 + before(2)*s2
         c = before(2)*c2 - before(1)*s2
      end do
      d(1) = 0.5_wp*of%length - 4.0_wp*of%length/pi**2*d(1)
      d(2) = 4.0_wp/pi*d(2)
   end function mean_distance

   !> Density of |R| where the other deviations are all.
   pure real(wp) function density_of_others(of, x) result(density)
      type(sum_t), intent(in) :: of
      real(wp), intent(in) :: x                           !! not negative
      real(wp) :: c, s, c2, s2, before(2)
      integer :: i

      density = 0.0_wp
      if (x >= of%all_others) return
      if (of%one_disc) then
         density = 4.0_wp/(pi*of%all_others)*sqrt(1.0_wp - (x/of%all_others)**2)
         return
      end if
      call unit_vector(half_turn*x/of%length, c, s)
      c2 = c**2 - s**2
      s2 = 2.0_wp*s*c
      do i = 1, of%terms
         density = density + c*of%characteristic(i)
         before = [s, c]
         s = before(1)*c2 + before(2)*s2
         c = before(2)*c2 - before(1)*s2
      end do
      density = 4.0_wp/of%length*density
   end function density_of_others

   !> The Bessel functions J0 and J1: by their recurrence backwards (Miller), of larger arguments by Hankel's expansion. Source:
   !> Abramowitz and Stegun (1964), 9.12 and 9.2.5.
   pure subroutine find_bessel(z, j0, j1)
      real(wp), intent(in) :: z                           !! above 0
      real(wp), intent(out) :: j0, j1
      real(wp), parameter :: large = 30.0_wp              !! the expansion has 1E-20 there
      integer, parameter :: begin = 80                    !! even: J80(30) is below 1E-20
      integer, parameter :: terms = 24
      real(wp) :: next, this, before, total, c, s, of0(2), of1(2)
      integer :: n

      if (z < large) then
         next = 0.0_wp
         this = tiny(1.0_wp)/epsilon(1.0_wp)
         total = 0.0_wp
         do n = begin, 1, -1
            if (mod(n, 2) == 0) total = total + 2.0_wp*this
            before = 2.0_wp*real(n, wp)/z*this - next
            next = this
            this = before
            if (abs(this) > 1.0_wp/epsilon(1.0_wp)) then
               next = next*epsilon(1.0_wp)
               this = this*epsilon(1.0_wp)
               total = total*epsilon(1.0_wp)
            end if
         end do
         total = total + this
         j0 = this/total
         j1 = next/total
      else
         of0 = expansion(0.0_wp)
         of1 = expansion(4.0_wp)
         call unit_vector(z*degrees_per_radian - 0.25_wp*half_turn, c, s)
         j0 = sqrt(2.0_wp/(pi*z))*(of0(1)*c - of0(2)*s)
         j1 = sqrt(2.0_wp/(pi*z))*(of1(1)*s + of1(2)*c)
      end if

   contains

      !> Both sums of the expansion for the order n, of 4 n**2: they end with their least term.
      pure function expansion(four_squares) result(sums)
         real(wp), intent(in) :: four_squares
         real(wp) :: sums(2), term, new
         integer :: k

         sums = [1.0_wp, 0.0_wp]
         term = 1.0_wp
         do k = 1, terms
            new = term*(four_squares - real(2*k - 1, wp)**2)/(8.0_wp*real(k, wp)*z)
            if (abs(new) > abs(term)) exit
            term = new
            select case (mod(k, 4))
            case (1)
               sums(2) = sums(2) + term
            case (2)
               sums(1) = sums(1) - term
            case (3)
               sums(2) = sums(2) - term
            case default
               sums(1) = sums(1) + term
            end select
         end do
      end function expansion
   end subroutine find_bessel

   !> Change of the width with every amount: that of the share, over the density.
   pure subroutine find_slopes(of, width, amount, share, slope)
      type(sum_t), intent(in) :: of
      real(wp), intent(in) :: width, amount(:), share
      real(wp), intent(out) :: slope(:)
      real(wp) :: outer(2), inner(2), density, total
      real(wp) :: change(size(of%others))

      slope = 0.0_wp
      if (of%largest == 0) then
         density = density_of_others(of, width)
         if (.not. density > 0.0_wp) return
         if (of%one_disc) then
            slope(of%others) = width/of%all_others
            return
         end if
         slope(of%others) = -change_of_distance(of, width, amount, .true.)/density
      else
         outer = mean_distance(of, of%a + width)
         inner = mean_distance(of, abs(width - of%a))
         density = (outer(2) - sign(inner(2), width - of%a))/(2.0_wp*of%a)
         if (.not. density > 0.0_wp) return
         slope(of%largest) = (share - 0.5_wp*(outer(2) + sign(inner(2), width - of%a)))/(of%a*density)
         change = change_of_distance(of, of%a + width, amount) - change_of_distance(of, abs(width - of%a), amount)
         slope(of%others) = -change/(2.0_wp*of%a*density)
      end if
      slope = max(slope, 0.0_wp)
      ! a width grows like the amounts: Euler's theorem takes out what the series leaves
      total = sum(slope*amount)
      if (total > 0.0_wp) slope = slope*width/total
   end subroutine find_slopes

   !> Change of D(x), or of D'(x), with the amounts of the other deviations.
   pure function change_of_distance(of, x, amount, of_slope) result(change)
      type(sum_t), intent(in) :: of
      real(wp), intent(in) :: x, amount(:)
      logical, intent(in), optional :: of_slope           !! of D'(x)
      real(wp) :: change(size(of%others))
      real(wp) :: c, s, others, weight
      integer :: i, j, m
      real(wp) :: factor(size(of%others)), before(size(of%others) + 1), after

      change = 0.0_wp
      if (x >= of%all_others) return
      if (of%one_uniform) then
         change = 0.5_wp*(1.0_wp - (x/of%all_others)**2)
         return
      end if
      m = size(of%others)
      do i = 1, of%terms
         call unit_vector(half_turn*real(2*i - 1, wp)*x/of%length, c, s)
         weight = c/real(2*i - 1, wp)**2
         if (present(of_slope)) weight = -s/real(2*i - 1, wp)*pi/of%length
         before(1) = 1.0_wp
         do j = 1, m
            factor(j) = of%sine(i, j)/argument(of, i, amount(of%others(j)))
            before(j + 1) = before(j)*factor(j)
         end do
         after = 1.0_wp
         do j = m, 1, -1
            others = before(j)*after
            change(j) = change(j) - weight*others*(of%cosine(i, j) - factor(j))/amount(of%others(j))
            after = after*factor(j)
         end do
      end do
      change = 4.0_wp*of%length/pi**2*change
   end function change_of_distance
end module psalm_sum_law
