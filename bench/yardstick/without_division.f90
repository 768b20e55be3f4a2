! Two ways to the direction of a link of an RRR dyad: square root and division, as src/assur/psalm_rrr.f90 has them, or both from
! one estimate in single precision, 1/(d sqrt(q)), and a step of third order for each. No product is fused into a sum: either way
! gives the same bits on every processor. 256 positions in the first cache; times of the processor.
!
! gfortran -O3 -march=native -ffp-contract=off without_division.f90
! usage: a.out [MILLIONS of arguments for the errors; default 10 | short]
module link_kernels
   use, intrinsic :: iso_fortran_env, only: real32, real64, real128
   implicit none
   integer, parameter :: n = 256, sp = real32, dp = real64, qp = real128
   real(dp), parameter :: least = 1.0e-140_dp
contains
   ! as in psalm_rrr: solve_one_link
   subroutine divided(hx, hy, a, b, x, y)
      real(dp), intent(in) :: hx(n), hy(n), a, b
      real(dp), intent(out) :: x(n), y(n)
      real(dp) :: sum2, diff2, product, half, d, root, along, scale
      integer :: i

      sum2 = (a + b)**2; diff2 = (a - b)**2; product = (a - b)*(a + b); half = 0.5_dp/a
      do i = 1, n
         d = hx(i)*hx(i) + hy(i)*hy(i)
         root = sqrt(max((sum2 - d)*(d - diff2), 0.0_dp))
         along = d + product
         scale = (1.0_dp/max(d, least))*half
         x(i) = (along*hx(i) + root*hy(i))*scale
         y(i) = (along*hy(i) - root*hx(i))*scale
      end do
   end subroutine divided

   subroutine estimated(hx, hy, a, b, x, y)
      real(dp), intent(in) :: hx(n), hy(n), a, b
      real(dp), intent(out) :: x(n), y(n)
      real(dp) :: sum2, diff2, product, half, floor, d(n), root(n), inverse(n), along, scale
      integer :: i

      sum2 = (a + b)**2; diff2 = (a - b)**2; product = (a - b)*(a + b); half = 0.5_dp/a; floor = 1.0e-32_dp*sum2**2
      do i = 1, n
         d(i) = hx(i)*hx(i) + hy(i)*hy(i)
         root(i) = max((sum2 - d(i))*(d(i) - diff2), 0.0_dp)
      end do
      ! in loops of their own: in one loop there are not registers enough, which takes a sixth longer
      call roots_and_inverses(root, floor, d, inverse)
      do i = 1, n
         along = d(i) + product
         scale = inverse(i)*half
         x(i) = (along*hx(i) + root(i)*hy(i))*scale
         y(i) = (along*hy(i) - root(i)*hx(i))*scale
      end do
   end subroutine estimated

   subroutine roots_and_inverses(q, floor, d, inverse)
      real(dp), intent(inout) :: q(n)
      real(dp), intent(in) :: floor, d(n)
      real(dp), intent(out) :: inverse(n)
      integer :: i
      real(dp) :: root

      do i = 1, n
         call root_and_inverse(q(i), floor, d(i), root, inverse(i))
         q(i) = root
      end do
   end subroutine roots_and_inverses

   ! sqrt(q) and 1/d
   elemental subroutine root_and_inverse(q, floor, d, root, inverse)
      real(dp), intent(in) :: q, floor, d
      real(dp), intent(out) :: root, inverse
      real(dp) :: w, y, r, e, t
      real(sp) :: both

      both = 1.0_sp/(real(d, sp)*sqrt(real(max(q, floor), sp)))
      w = real(both, dp)
      y = w*d                                ! 1/sqrt(q)
      e = 1.0_dp - q*y*y
      y = y + y*e*(0.5_dp + e*0.375_dp)
      t = q*y
      root = t + 0.5_dp*y*(q - t*t)
      r = w*root                             ! 1/d
      e = 1.0_dp - d*r
      inverse = r + r*e*(1.0_dp + e)
   end subroutine root_and_inverse

   ! the root as the processor has it, 1/d from an estimate
   subroutine half_estimated(hx, hy, a, b, x, y)
      real(dp), intent(in) :: hx(n), hy(n), a, b
      real(dp), intent(out) :: x(n), y(n)
      real(dp) :: sum2, diff2, product, half, d, root, along, scale, r, e
      integer :: i

      sum2 = (a + b)**2; diff2 = (a - b)**2; product = (a - b)*(a + b); half = 0.5_dp/a
      do i = 1, n
         d = hx(i)*hx(i) + hy(i)*hy(i)
         root = sqrt(max((sum2 - d)*(d - diff2), 0.0_dp))
         r = real(1.0_sp/real(d, sp), dp)
         e = 1.0_dp - d*r
         along = d + product
         scale = (r + r*e*(1.0_dp + e))*half
         x(i) = (along*hx(i) + root*hy(i))*scale
         y(i) = (along*hy(i) - root*hx(i))*scale
      end do
   end subroutine half_estimated

   ! neither root nor quotient: what the rest of the loop takes
   subroutine neither(hx, hy, a, b, x, y)
      real(dp), intent(in) :: hx(n), hy(n), a, b
      real(dp), intent(out) :: x(n), y(n)
      real(dp) :: sum2, diff2, product, half, d, root, along
      integer :: i

      sum2 = (a + b)**2; diff2 = (a - b)**2; product = (a - b)*(a + b); half = 0.5_dp/a
      do i = 1, n
         d = hx(i)*hx(i) + hy(i)*hy(i)
         root = max((sum2 - d)*(d - diff2), 0.0_dp)
         along = d + product
         x(i) = (along*hx(i) + root*hy(i))*(max(d, least)*half)
         y(i) = (along*hy(i) - root*hx(i))*(max(d, least)*half)
      end do
   end subroutine neither
end module link_kernels

program without_division
   use link_kernels
   implicit none
   character(*), parameter :: names(4) = [character(32) :: 'root and division', 'both from one estimate', &
                                          'root, division from an estimate', 'neither (no result)']
   integer, parameter :: calls = 4000
   real(dp) :: hx(n), hy(n), x(n), y(n), a, b, angle(n), d(n), begun, ended, best(4), used
   real(dp) :: worst(3, 3), root, inverse, q
   real(qp) :: qx, qy, dd, rr, aq, bq, hxq, hyq
   integer :: k, j, i, round, rounds, status, blocks
   character(20) :: word

   word = '10'
   call get_command_argument(1, word, status=status)
   if (status /= 0) word = '10'
   rounds = 50
   blocks = 4
   if (word == 'short') then
      rounds = 1
   else
      read (word, *) blocks
      blocks = nint(blocks*1.0e6_dp/n)
   end if

   a = 0.8_dp; b = 1.1_dp
   call random_number(angle); call random_number(d)
   d = abs(a - b) + (0.02_dp + 0.96_dp*d)*(a + b - abs(a - b))
   hx = d*cos(6.28_dp*angle); hy = d*sin(6.28_dp*angle)
   best = huge(best)
   used = 0.0_dp
   do round = 1, rounds
      do j = 1, 4
         call cpu_time(begun)
         do k = 1, calls
            call one(j)
            used = used + x(1)
            hx(1) = hx(1) + 1.0e-14_dp
         end do
         call cpu_time(ended)
         best(j) = min(best(j), (ended - begun)/calls/n*1.0e9_dp)
      end do
   end do
   do j = 1, 4
      print '(a,f8.3,a,f7.2)', names(j)//' ns a position', best(j), '   ratio to the first', best(j)/best(1)
   end do
   if (used == 0.25_dp) print *, used

   ! errors of the direction, in epsilons of 1, and of root and reciprocal in units in the last place
   worst = 0.0_dp
   do round = 1, blocks
      call random_number(angle); call random_number(d)
      call random_number(a); call random_number(b)
      a = 0.1_dp + a; b = 0.1_dp + b
      d = abs(a - b) + d*(a + b - abs(a - b))
      hx = d*cos(6.28_dp*angle); hy = d*sin(6.28_dp*angle)
      do j = 1, 3
         call one(j)
         aq = a; bq = b
         do i = 1, n, 16                      ! quadruple precision takes thirty times as long: every sixteenth
            hxq = hx(i); hyq = hy(i)
            dd = hxq*hxq + hyq*hyq
            rr = ((aq + bq)**2 - dd)*(dd - (aq - bq)**2)
            if (rr <= 1.0e-2_qp) cycle         ! near a dead point all hang on the rounding of what stands below the root
            rr = sqrt(rr)
            qx = ((dd + (aq - bq)*(aq + bq))*hxq + rr*hyq)/(2*aq*dd)
            qy = ((dd + (aq - bq)*(aq + bq))*hyq - rr*hxq)/(2*aq*dd)
            worst(1, j) = max(worst(1, j), real(abs(x(i) - qx), dp)/epsilon(1.0_dp), real(abs(y(i) - qy), dp)/epsilon(1.0_dp))
         end do
      end do
      do i = 1, n
         q = 0.001_dp + 4.0_dp*angle(i)
         d(i) = 0.001_dp + 4.0_dp*d(i)
         call root_and_inverse(q, 1.0e-30_dp, d(i), root, inverse)
         worst(2, 2) = max(worst(2, 2), real(abs(root - sqrt(real(q, qp)))/spacing(root), dp))
         worst(3, 2) = max(worst(3, 2), real(abs(inverse - 1/real(d(i), qp))/spacing(inverse), dp))
      end do
   end do
   print '(a,i0,a,i0,a)', 'errors of ', blocks*n, ' roots and reciprocals, and ', 16*blocks, ' directions:'
   do j = 1, 3
      print '(a,f8.2)', names(j)//' direction, in epsilons of 1', worst(1, j)
   end do
   print '(a,2f8.3)', 'root and reciprocal from one estimate, units in the last place', worst(2:3, 2)
contains
   subroutine one(which)
      integer, intent(in) :: which

      select case (which)
      case (1); call divided(hx, hy, a, b, x, y)
      case (2); call estimated(hx, hy, a, b, x, y)
      case (3); call half_estimated(hx, hy, a, b, x, y)
      case (4); call neither(hx, hy, a, b, x, y)
      end select
   end subroutine one
end program without_division
