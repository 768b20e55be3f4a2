!> Elementary functions that give the same digits on every processor.
!>
!> A library's sine may use a fused multiplication where the processor has one, and then ends in another digit. Here everything
!> is made of +, -, *, / and square roots, which IEEE 754 rounds correctly, one operation after the other (-ffp-contract=off).
!> Sine and cosine of degrees and their inverse are evaluated as a sum of two numbers; where its rounding is in doubt (once in
!> some hundred times) it is evaluated again with twice the digits. All is done in real64: real32 rounds the result, and real128,
!> the yardstick of the tests, takes the library's functions.
module psalm_elementary
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_kinds, only: wp, dp
   implicit none (type, external)
   private
   public :: sine_cosine, sines_cosines, refined_direction, hypotenuse, fractional_power, digits_of_pair

   integer, parameter :: digits_of_pair = precision(1.0_dp) !! decimal digits of a kind that these functions serve

   real(dp), parameter :: splitter = 134217729.0_dp        !! 2**27 + 1: halves of 26 bits (Veltkamp 1968, Dekker 1971)
   real(dp), parameter :: doubt = 2.0_dp**(-63)            !! bound of the relative error of the first evaluation
   real(dp), parameter :: least_angle = 2.0_dp**(-900)     !! below it halves of products would underflow
   real(dp), parameter :: most_degrees = 2.0_dp**30        !! larger angles are reduced to a turn first
   integer, parameter :: terms = 15                        !! of the series on 0 to 45 degrees: the next is below 2**-110
   integer, parameter :: quarter = 90, turn = 360          !! degrees
   integer, parameter :: strip = 64                        !! angles looked at together

   ! pi/180: 26 bits and the rest; 53 bits and the rest
   real(dp), parameter :: degree_head = 1.7453292384743690E-02_dp, degree_tail = 1.3519960527851425E-10_dp
   real(dp), parameter :: degree = 1.7453292519943295E-02_dp, degree_rest = 2.9486522708701687E-19_dp
   real(dp), parameter :: degrees_per_radian = 57.2957795130823208767981548141051784_dp
   ! sin(x)/x - 1 and cos(x) - 1 by squares of degrees, for half a degree
   real(dp), parameter :: sine_series(3) = [-degree**2/6.0_dp, degree**4/120.0_dp, -degree**6/5040.0_dp]
   real(dp), parameter :: cosine_series(3) = [-degree**2/2.0_dp, degree**4/24.0_dp, -degree**6/720.0_dp]

   !> Sines of 0 to 90 degrees: 26 bits, and the rest. The products of heads with numbers of 26 bits are exact.
   real(dp), parameter :: sine_table(2, 0:quarter) = reshape([ &
      0.0000000000000000E+00_dp, 0.0000000000000000E+00_dp, 1.7452406231313944E-02_dp, 2.0596956895650394E-10_dp, &
      3.4899496473371983E-02_dp, 2.2912898907153230E-10_dp, 5.2335956133902073E-02_dp, 1.0904175981562449E-10_dp, &
      6.9756474345922470E-02_dp, -6.0179716931681461E-10_dp, 8.7155742570757866E-02_dp, 1.7690030765230254E-10_dp, &
      1.0452846251428127E-01_dp, 7.5337219851165055E-10_dp, 1.2186934426426888E-01_dp, -8.5912139400917642E-10_dp, &
      1.3917310163378716E-01_dp, -6.7372171103887050E-10_dp, 1.5643446519970894E-01_dp, -1.5947806958852749E-10_dp, &
      1.7364817857742310E-01_dp, -9.1049274685140842E-10_dp, 1.9080899655818939E-01_dp, -1.1816445796847034E-09_dp, &
      2.0791169255971909E-01_dp, -1.7419597485916170E-09_dp, 2.2495105490088463E-01_dp, -5.5701963024479119E-10_dp, &
      2.4192189425230026E-01_dp, 1.3473674601092705E-09_dp, 2.5881904363632202E-01_dp, 1.4661987408645238E-09_dp, &
      2.7563735842704773E-01_dp, -2.6100485438422161E-09_dp, 2.9237170517444611E-01_dp, -4.5170937785956254E-10_dp, &
      3.0901699513196945E-01_dp, -7.5702202780200346E-10_dp, 3.2556815445423126E-01_dp, 2.9254065069776858E-12_dp, &
      3.4202014654874802E-01_dp, -3.2230792833133221E-09_dp, 3.5836794972419739E-01_dp, -1.7889711421117471E-10_dp, &
      3.7460659444332123E-01_dp, -1.0274091926123801E-09_dp, 3.9073112607002258E-01_dp, 2.4192511720542720E-09_dp, &
      4.0673664212226868E-01_dp, 9.5353153099617351E-10_dp, 4.2261826246976852E-01_dp, -7.2906908798294337E-10_dp, &
      4.3837114423513412E-01_dp, 2.5539432926968751E-09_dp, 4.5399049669504166E-01_dp, 3.0445051350662677E-09_dp, &
      4.6947156637907028E-01_dp, -3.5931795060229597E-09_dp, 4.8480962216854095E-01_dp, -1.9222039255144640E-09_dp, &
      5.0000000000000000E-01_dp, 0.0000000000000000E+00_dp, 5.1503807306289673E-01_dp, 1.8471574815660070E-09_dp, &
      5.2991926670074463E-01_dp, -2.4675396748594689E-09_dp, 5.4463903605937958E-01_dp, -1.0443524954126350E-09_dp, &
      5.5919291079044342E-01_dp, -7.3196965902497281E-09_dp, 5.7357643544673920E-01_dp, 9.0430689933068815E-10_dp, &
      5.8778525888919830E-01_dp, -6.5967251740539502E-09_dp, 6.0181502997875214E-01_dp, -6.8267038563124919E-09_dp, &
      6.1566147208213806E-01_dp, 3.2435202181453735E-09_dp, 6.2932039797306061E-01_dp, -6.9232231552042542E-09_dp, &
      6.4278760552406311E-01_dp, 4.1624762159710808E-09_dp, 6.5605902671813965E-01_dp, 2.2723676363449961E-09_dp, &
      6.6913060843944550E-01_dp, -2.0805872817791952E-09_dp, 6.8199835717678070E-01_dp, 2.8857177997586320E-09_dp, &
      6.9465836882591248E-01_dp, 1.6330848110704687E-09_dp, 7.0710678398609161E-01_dp, -2.7995440893686869E-09_dp, &
      7.1933980286121368E-01_dp, -2.5225625447259767E-09_dp, 7.3135370016098022E-01_dp, 1.4581902586781685E-09_dp, &
      7.4314482510089874E-01_dp, 3.7649549233891580E-10_dp, 7.5470958650112152E-01_dp, -6.2783495230531099E-09_dp, &
      7.6604443788528442E-01_dp, 5.2336936113742676E-09_dp, 7.7714596688747406E-01_dp, -5.4305031800786557E-09_dp, &
      7.8801074624061584E-01_dp, 7.3661061119674153E-09_dp, 7.9863551259040833E-01_dp, -2.5431154789113115E-09_dp, &
      8.0901698768138885E-01_dp, 6.6935585691218244E-09_dp, 8.1915204226970673E-01_dp, 2.0192850636102698E-09_dp, &
      8.2903757691383362E-01_dp, -4.3587919261577259E-09_dp, 8.3867056667804718E-01_dp, 1.2673768494618097E-09_dp, &
      8.4804809093475342E-01_dp, 5.2216725524174265E-09_dp, 8.5716730356216431E-01_dp, -2.8600520191754070E-09_dp, &
      8.6602540314197540E-01_dp, 6.4246324393169195E-10_dp, 8.7461970746517181E-01_dp, -3.2577601368020678E-10_dp, &
      8.8294759392738342E-01_dp, -1.0684564808193911E-09_dp, 8.9100652933120728E-01_dp, -5.1428394130309156E-09_dp, &
      8.9879404008388519E-01_dp, 6.2152817999112016E-09_dp, 9.0630778670310974E-01_dp, 3.3354022203161516E-10_dp, &
      9.1354545950889587E-01_dp, -1.8662949785213100E-09_dp, 9.2050485312938690E-01_dp, 3.2305342554142600E-10_dp, &
      9.2718385159969330E-01_dp, 2.9670941024666307E-09_dp, 9.3358042836189270E-01_dp, -1.8646909512052696E-09_dp, &
      9.3969261646270752E-01_dp, 4.3232008645228592E-09_dp, 9.4551856815814972E-01_dp, 7.4411670911098439E-09_dp, &
      9.5105651021003723E-01_dp, 6.0851163406711268E-09_dp, 9.5630475878715515E-01_dp, -2.8241196700285368E-09_dp, &
      9.6126168966293335E-01_dp, 6.2753855123071219E-09_dp, 9.6592582762241364E-01_dp, -1.3333453485041631E-09_dp, &
      9.7029572725296021E-01_dp, -9.7696373277174717E-10_dp, 9.7437006235122681E-01_dp, 2.4340084218990693E-09_dp, &
      9.7814759612083435E-01_dp, 4.6129712873426291E-09_dp, 9.8162718117237091E-01_dp, 2.2752930428519738E-09_dp, &
      9.8480775952339172E-01_dp, -6.5111836642660699E-09_dp, 9.8768834769725800E-01_dp, -7.1021202694154286E-09_dp, &
      9.9026806652545929E-01_dp, 2.2161110255329934E-09_dp, 9.9254615604877472E-01_dp, -4.4074526842582200E-09_dp, &
      9.9452190101146698E-01_dp, -5.6431936430577769E-09_dp, 9.9619470536708832E-01_dp, -7.2753427855760834E-09_dp, &
      9.9756404757499695E-01_dp, 2.6848272993709751E-09_dp, 9.9862954020500183E-01_dp, -5.4504279572701954E-09_dp, &
      9.9939082562923431E-01_dp, 1.3898614160413997E-09_dp, 9.9984769523143768E-01_dp, -7.5046443948457191E-11_dp, &
      1.0000000000000000E+00_dp, 0.0000000000000000E+00_dp], [2, 91])

   ! the same for a turn and a quarter more, so that every cosine is a sine; and their products with pi/180, which the other of
   ! sine and cosine grows by in a degree
   real(dp), parameter :: turn_head(0:turn + quarter - 1) = [sine_table(1, 0:90), sine_table(1, 89:1:-1), &
                                                            -sine_table(1, 0:90), -sine_table(1, 89:1:-1), sine_table(1, 0:89)]
   real(dp), parameter :: turn_tail(0:turn + quarter - 1) = [sine_table(2, 0:90), sine_table(2, 89:1:-1), &
                                                            -sine_table(2, 0:90), -sine_table(2, 89:1:-1), sine_table(2, 0:89)]
   real(dp), parameter :: rate_product(0:turn + quarter - 1) = degree_head*turn_head
   real(dp), parameter :: rate_rest(0:turn + quarter - 1) = degree_tail*turn_head + degree*turn_tail
   real(dp), parameter :: rate(0:turn + quarter - 1) = rate_product + rate_rest
   real(dp), parameter :: rate_head(0:turn + quarter - 1) = splitter*rate - (splitter*rate - rate)
   real(dp), parameter :: rate_tail(0:turn + quarter - 1) = (rate_product - rate_head) + rate_rest
   !> By whole degree: sine and cosine, their rests; what they grow by in a degree, its rests. One degree fills a cache line.
   real(dp), parameter :: table(2, 4, 0:turn - 1) = reshape(transpose(reshape( &
      [turn_head(:turn - 1), turn_head(quarter:), turn_tail(:turn - 1), turn_tail(quarter:), &
       rate_head(quarter:), -rate_head(:turn - 1), rate_tail(quarter:), -rate_tail(:turn - 1)], [turn, 8])), [2, 4, turn])

contains

   !> Sine and cosine of an angle, correctly rounded.
   !>
   !> (Beyond doubt but for arguments whose value lies within 2**-98 of the middle of two numbers; of angles below 1e-270 degrees
   !> the error is 1.5 units of the last digit.)
   pure subroutine sine_cosine(degrees, s, c)
      real(dp), intent(in) :: degrees
      real(dp), intent(out) :: s, c
      real(dp) :: angle, away, high(2), low(2)
      logical :: doubtful(2)
      integer :: k

      angle = degrees
      if (.not. abs(angle) < most_degrees) angle = mod(angle, real(turn, dp))
      ! the nearest whole degree; what is left is exact
      k = int(angle + sign(0.5_dp, angle))
      away = angle - real(k, dp)
      k = modulo(k, turn)
      if (abs(away) < least_angle) then
         s = table(1, 1, k) + table(1, 2, k)
         c = table(2, 1, k) + table(2, 2, k)
         if (k == 0) s = sign(away*degree, angle)
         return
      end if
      call near_degree(k, away, high, low)
      call add(high, low, doubtful)
      s = high(1)
      c = high(2)
      if (any(doubtful)) call sine_cosine_again(k, away, s, c)
   end subroutine sine_cosine

   !> Sines and cosines of many angles: the bits of `sine_cosine`, whose operations run in vector lanes here.
   pure subroutine sines_cosines(n, degrees, s, c)
      integer, intent(in) :: n
      real(dp), intent(in) :: degrees(n)
      real(dp), intent(out) :: s(n), c(n)
      real(dp) :: away(strip), near(strip, 4, 2)    ! degrees from the nearest whole one; what the table has there
      integer :: k(strip)
      integer(int64) :: again(strip)                ! 1: one at a time
      integer :: first, m, i, j

      do first = 0, n - 1, strip
         m = min(strip, n - first)
         if (.not. all(abs(degrees(first + 1:first + m)) < most_degrees)) then
            do i = first + 1, first + m
               call sine_cosine(degrees(i), s(i), c(i))
            end do
            cycle
         end if
         call reduce(m, degrees(first + 1), k, away)
         ! one line of the cache after the other is quicker than vectors that are gathered
         !GCC$ novector
         do i = 1, m
            do j = 1, 4
               near(i, j, 1) = table(1, j, k(i))
               near(i, j, 2) = table(2, j, k(i))
            end do
         end do
         again(:m) = 0_int64
         call add_to_degree(m, away, near(1, 1, 1), s(first + 1), again)
         call add_to_degree(m, away, near(1, 1, 2), c(first + 1), again)
         if (all(again(:m) == 0_int64)) cycle
         do i = 1, m
            if (again(i) > 0_int64) call sine_cosine(degrees(first + i), s(first + i), c(first + i))
         end do
      end do
   end subroutine sines_cosines

   !> The nearest whole degree, 0 to 359, and what is left of angles below `most_degrees`.
   pure subroutine reduce(n, degrees, k, away)
      integer, intent(in) :: n
      real(dp), intent(in) :: degrees(n)
      integer, intent(out) :: k(n)
      real(dp), intent(out) :: away(n)
      real(dp), parameter :: whole_turn = real(turn, dp)
      real(dp) :: whole
      integer :: i

      do i = 1, n
         k(i) = int(degrees(i) + sign(0.5_dp, degrees(i)))
      end do
      do i = 1, n
         whole = real(k(i), dp)
         away(i) = degrees(i) - whole
         ! less whole turns, of which division may find one too few or too many
         whole = whole - whole_turn*real(int(whole/whole_turn), dp)
         whole = merge(whole + whole_turn, whole, whole < 0.0_dp)
         k(i) = int(merge(whole - whole_turn, whole, whole >= whole_turn))
      end do
   end subroutine reduce

   !> Sines, or cosines, as `near_degree` has them; where that is in doubt, or the angle is whole, `again` is not 0.
   pure subroutine add_to_degree(n, away, near, values, again)
      integer, intent(in) :: n
      real(dp), intent(in) :: away(n), near(strip, 4)
      real(dp), intent(out) :: values(n)
      integer(int64), intent(inout) :: again(n)
      real(dp) :: head, tail, turned, shrunk, low
      logical :: doubtful
      integer :: i

      do i = 1, n
         call split(away(i), head, tail)
         call of_rest(away(i), turned, shrunk)
         call from_degree(near(i, 1), near(i, 2), near(i, 3), near(i, 4), away(i), head, tail, turned, shrunk, values(i), low)
         call add(values(i), low, doubtful)
         again(i) = again(i) + merge(1_int64, 0_int64, doubtful) + merge(1_int64, 0_int64, abs(away(i)) < least_angle)
      end do
   end subroutine add_to_degree

   !> The same by the series, slower, with twice the digits.
   pure subroutine sine_cosine_again(k, away, s, c)
      integer, intent(in) :: k             !! whole degrees, 0 to 359
      real(dp), intent(in) :: away         !! degrees from there
      real(dp), intent(out) :: s, c
      real(dp) :: high(2), low(2), x, y
      integer :: quarters

      quarters = (k + quarter/2)/quarter
      call by_series(real(k - quarter*quarters, dp) + away, high, low)
      y = high(1) + low(1)
      x = high(2) + low(2)
      select case (modulo(quarters, 4))
      case (0)
         s = y
         c = x
      case (1)
         s = x
         c = -y
      case (2)
         s = -y
         c = -x
      case default
         s = -x
         c = y
      end select
   end subroutine sine_cosine_again

   !> Direction of a vector in degrees, correctly rounded, from a guess that is true to six digits.
   !>
   !> With the guess reduced to -45 ... 45 degrees and the vector turned back by as many right angles.
   pure real(dp) function refined_direction(x, y, whole, rest) result(degrees)
      real(dp), intent(in) :: x, y          !! vector, turned back; the larger leg is x, between 0.5 and 1
      real(dp), intent(in) :: whole         !! right angles it was turned back by, degrees
      real(dp), intent(in) :: rest          !! guess of the remaining angle, -46 to 46 degrees
      real(dp) :: high(2), low(2), degrees_low
      logical :: doubtful
      integer :: k

      if (abs(rest) < least_angle) then
         degrees = whole + y/x*degrees_per_radian
         return
      end if
      k = nint(rest)
      call near_degree(modulo(k, turn), rest - real(k, dp), high, low)
      call newton_step(x, y, whole, rest, high, low, degrees, degrees_low)
      call add(degrees, degrees_low, doubtful)
      if (doubtful) then
         call by_series(rest, high, low)
         call newton_step(x, y, whole, rest, high, low, degrees, degrees_low)
         degrees = degrees + degrees_low
      end if
   end function refined_direction

   !> Correct a guess of a direction; the sum of `high` and `low` is the better one.
   pure subroutine newton_step(x, y, whole, rest, unit, unit_low, high, low)
      real(dp), intent(in) :: x, y, whole, rest
      real(dp), intent(in) :: unit(2), unit_low(2)  !! sine and cosine of the guess
      real(dp), intent(out) :: high, low
      real(dp) :: ys, ys_low, xs, xs_low, off, guess

      associate (s => unit(1), s_low => unit_low(1), c => unit(2), c_low => unit_low(2))
         call multiply(y, c, ys, ys_low)
         call multiply(x, s, xs, xs_low)
         off = ((ys - xs) + ((ys_low - xs_low) + (y*c_low - x*s_low)))/(x*c + y*s)
      end associate
      off = (off - off*off*off/3.0_dp)*degrees_per_radian
      guess = whole + rest
      off = off + (rest - (guess - whole))
      high = guess + off
      low = off - (high - guess)
   end subroutine newton_step

   !> Add the lesser part of a value to the greater; doubtful where the value itself may round otherwise (Ziv 1991).
   elemental subroutine add(high, low, doubtful)
      real(dp), intent(inout) :: high      !! the sum afterwards
      real(dp), intent(in) :: low
      logical, intent(out) :: doubtful
      real(dp) :: width, other

      width = doubt*high
      other = high + (low - width)
      high = high + (low + width)
      doubtful = high /= other
   end subroutine add

   !> Sine and cosine from those of the nearest whole degree, each as two numbers; relative error of their sum below `doubt`.
   !>
   !> The same operations for both, side by side.
   pure subroutine near_degree(k, away, high, low)
      integer, intent(in) :: k             !! whole degrees, 0 to 359
      real(dp), intent(in) :: away         !! degrees from there, -0.5 to 0.5, not 0
      real(dp), intent(out) :: high(2), low(2)
      real(dp) :: head, tail, turned, shrunk

      call split(away, head, tail)
      call of_rest(away, turned, shrunk)
      call from_degree(table(:, 1, k), table(:, 2, k), table(:, 3, k), table(:, 4, k), away, head, tail, turned, shrunk, high, low)
   end subroutine near_degree

   !> What sine and cosine of a rest, degrees, have beside itself and one.
   elemental subroutine of_rest(away, turned, shrunk)
      real(dp), intent(in) :: away
      real(dp), intent(out) :: turned, shrunk
      real(dp) :: square

      square = away*away
      turned = away*(square*(sine_series(1) + square*(sine_series(2) + square*sine_series(3))))
      shrunk = square*(cosine_series(1) + square*(cosine_series(2) + square*cosine_series(3)))
   end subroutine of_rest

   !> Sine or cosine from the table's numbers at the nearest whole degree; the sum of `high` and `low`.
   elemental subroutine from_degree(value, value_low, rate, rate_low, away, head, tail, turned, shrunk, high, low)
      real(dp), intent(in) :: value, value_low, rate, rate_low
      real(dp), intent(in) :: away, head, tail        !! degrees from there, and its halves
      real(dp), intent(in) :: turned, shrunk          !! as `of_rest` has them
      real(dp), intent(out) :: high, low
      real(dp) :: product

      product = rate*head
      high = value + product
      low = ((value - high) + product) + (value_low + ((rate*tail + rate_low*away) &
                                                       + ((rate + rate_low)*turned + (value + value_low)*shrunk)))
   end subroutine from_degree

   !> Sine and cosine by their series with twice the digits.
   pure subroutine by_series(degrees, high, low)
      real(dp), intent(in) :: degrees
      real(dp), intent(out) :: high(2), low(2)
      real(dp) :: u(2), square(2), sine(2), cosine(2)
      real(dp), parameter :: one(2) = [1.0_dp, 0.0_dp]
      integer :: n

      call multiply(degrees, degree, u(1), u(2))
      u(2) = u(2) + degrees*degree_rest
      square = -double_product(u, u)
      cosine = one
      sine = one
      do n = terms, 1, -1
         cosine = double_sum(one, double_product(cosine, double_quotient(square, real((2*n - 1)*(2*n), dp))))
         sine = double_sum(one, double_product(sine, double_quotient(square, real((2*n)*(2*n + 1), dp))))
      end do
      sine = double_product(sine, u)
      high = [sine(1), cosine(1)]
      low = [sine(2), cosine(2)]
   end subroutine by_series

   !> Halves of a number: 26 bits each.
   elemental subroutine split(value, head, tail)
      real(dp), intent(in) :: value
      real(dp), intent(out) :: head, tail

      head = splitter*value
      head = head - (head - value)
      tail = value - head
   end subroutine split

   !> Product of two numbers as a sum of two, exactly.
   pure subroutine multiply(a, b, high, low)
      real(dp), intent(in) :: a, b
      real(dp), intent(out) :: high, low
      real(dp) :: a_head, a_tail, b_head, b_tail

      call split(a, a_head, a_tail)
      call split(b, b_head, b_tail)
      high = a*b
      low = ((a_head*b_head - high) + a_head*b_tail + a_tail*b_head) + a_tail*b_tail
   end subroutine multiply

   pure function double_product(a, b) result(product)
      real(dp), intent(in) :: a(2), b(2)
      real(dp) :: product(2), low, high

      call multiply(a(1), b(1), high, low)
      low = low + (a(1)*b(2) + a(2)*b(1))
      product(1) = high + low
      product(2) = low - (product(1) - high)
   end function double_product

   !> Sum; the first is the larger.
   pure function double_sum(a, b) result(total)
      real(dp), intent(in) :: a(2), b(2)
      real(dp) :: total(2), low, high

      high = a(1) + b(1)
      low = ((a(1) - high) + b(1)) + (a(2) + b(2))
      total(1) = high + low
      total(2) = low - (total(1) - high)
   end function double_sum

   pure function double_quotient(a, b) result(quotient)
      real(dp), intent(in) :: a(2), b
      real(dp) :: quotient(2), high, low, part, part_low

      high = a(1)/b
      call multiply(high, b, part, part_low)
      low = (((a(1) - part) - part_low) + a(2))/b
      quotient(1) = high + low
      quotient(2) = low - (quotient(1) - high)
   end function double_quotient

   !> Square root of x**2 + y**2, to 1.25 units of the last digit, without overflow.
   elemental real(wp) function hypotenuse(x, y)
      real(wp), intent(in) :: x, y
      real(wp), parameter :: plain = scale(1.0_wp, maxexponent(1.0_wp)/4) !! longer, or shorter than 1/plain: scaled first
      real(wp) :: larger
      integer :: e

      larger = max(abs(x), abs(y))
      if (larger < plain .and. larger > 1.0_wp/plain) then
         hypotenuse = sqrt(x*x + y*y)
      else
         e = exponent(larger)
         hypotenuse = scale(sqrt(scale(x, -e)**2 + scale(y, -e)**2), e)
      end if
   end function hypotenuse

   !> base**power for 0 <= power < 1, by square roots: one for each binary digit of the power.
   elemental real(wp) function fractional_power(base, power)
      real(wp), intent(in) :: base          !! not negative
      real(wp), intent(in) :: power
      real(wp) :: root, left

      fractional_power = 1.0_wp
      root = base
      left = power
      do while (left > 0.0_wp)
         root = sqrt(root)
         left = 2.0_wp*left
         if (left < 1.0_wp) cycle
         fractional_power = fractional_power*root
         left = left - 1.0_wp
      end do
   end function fractional_power
end module psalm_elementary
