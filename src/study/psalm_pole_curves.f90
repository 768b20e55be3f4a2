!> Poses that leave curves of pivots: four, or three for a given pivot of the crank and a slide.
!>
!> Fixed pivots for four poses lie on the centre-point curve, pins of the body on the circle-point curve, both circular cubics
!> through the poles. They are sampled on even rays through one pole, which meet each in two points besides: two branches. Source:
!> Burmester (1888); Bottema and Roth (1979), chapter 8.
module psalm_pole_curves
   use psalm_angles, only: unit_vector
   use psalm_burmester, only: curve_point_t, dyad_slides, dyad_swings, pin_pair_t, four_poses_curve, guide_of, inverted, &
                              slider_circle, slider_pin
   use psalm_defects, only: verdict_t
   use psalm_exact_results, only: exact_result_t, keep_best, pair_of
   use psalm_kinds, only: wp, full_turn, half_turn
   implicit none (type, external)
   private
   public :: curve_sample_t, pole_map_t, branches, sample_curve, find_lines, find_pairs, map_pairs

   integer, parameter :: branches = 2
   integer, parameter :: rays = 200                  !! of the curves in the search
   integer, parameter :: rays_of_map = 90

   !> A point of the curves of four poses.
   type :: curve_sample_t
      real(wp) :: ray = 0.0_wp                       !! direction from the pole, degrees from 0 to 180
      integer :: branch = 1                          !! 1 or 2
      type(pin_pair_t) :: dyad
   end type curve_sample_t

   !> What each pair of points of the centre-point curve is worth as a four-bar.
   type :: pole_map_t
      real(wp), allocatable :: ray(:)                !! shape (points): direction from the pole, degrees
      integer, allocatable :: branch(:)              !! the same shape
      integer, allocatable :: class(:, :)            !! shape (points, points), symmetric; 0: there is no such point
      real(wp), allocatable :: transmission(:, :)    !! the same shape, degrees
   end type pole_map_t

contains

   !> Points of the curves of four poses on even rays through a pole, branch by branch; those that exist.
   subroutine sample_curve(d, g, count, samples)
      complex(wp), intent(in) :: d(3), g(3)
      integer, intent(in) :: count                   !! rays; 0: those of the search
      type(curve_sample_t), allocatable, intent(out) :: samples(:)
      type(curve_point_t) :: points(branches)
      real(wp) :: ray, cosine, sine
      integer :: i, k, n, m

      n = merge(count, rays, count > 0)
      allocate (samples(branches*n))
      m = 0
      do k = 1, branches
         do i = 1, n
            ray = half_turn*(real(i, wp) - 0.5_wp)/real(n, wp)
            call unit_vector(ray, cosine, sine)
            call four_poses_curve(d, g, cmplx(cosine, sine, wp), points)
            if (.not. points(k)%exists) cycle
            m = m + 1
            samples(m)%ray = ray
            samples(m)%branch = k
            samples(m)%dyad = points(k)%dyad
         end do
      end do
      samples = samples(:m)
   end subroutine sample_curve

   !> Pins on a line, or pivots on a line of the body: of four poses the one there is, of three poses points of a circle.
   subroutine find_lines(swings, d, g, lines)
      logical, intent(in) :: swings
      complex(wp), intent(in) :: d(:), g(:)          !! shape (2) or (3)
      type(pin_pair_t), allocatable, intent(out) :: lines(:)
      complex(wp) :: own_d(size(d)), own_g(size(g)), centre, pin
      real(wp) :: level, offset, square, cosine, sine
      logical :: exists
      integer :: k

      allocate (lines(0))
      own_d = d
      own_g = g
      if (swings) call inverted(d, g, own_d, own_g)
      if (size(d) == 3) then
         call slider_pin(own_d, own_g, pin, exists)
         if (exists) lines = [line_at(pin)]
         return
      end if
      call slider_circle(own_d, own_g, level, centre, offset)
      if (.not. abs(level) > 0.0_wp) return
      pin = centre/level
      square = pin%re**2 + pin%im**2 - offset/level
      if (.not. square > 0.0_wp) return
      deallocate (lines)
      allocate (lines(branches*rays))
      do k = 1, size(lines)
         call unit_vector(full_turn*(real(k, wp) - 0.5_wp)/real(size(lines), wp), cosine, sine)
         lines(k) = line_at(-centre/level + sqrt(square)*cmplx(cosine, sine, wp))
      end do

   contains

      type(pin_pair_t) function line_at(place)
         complex(wp), intent(in) :: place

         line_at%guide = guide_of(own_d, own_g, place)
         if (swings) then
            line_at%kind = dyad_swings
            line_at%pivot = place
         else
            line_at%kind = dyad_slides
            line_at%pin = place
         end if
      end function line_at
   end subroutine find_lines

   !> The best linkages of two dyads: of one of each list, or where there are no lines of two of the first.
   subroutine find_pairs(p, g, cranks, lines, closed, most, kept, tried)
      complex(wp), intent(in) :: p(:), g(:)          !! shapes (poses), (poses - 1)
      type(pin_pair_t), intent(in) :: cranks(:), lines(:)
      logical, intent(in) :: closed
      integer, intent(in) :: most                    !! kept
      type(exact_result_t), allocatable, intent(out) :: kept(:)
      integer, intent(out) :: tried
      integer :: i, k

      allocate (kept(0))
      tried = 0
      do i = 1, size(cranks)
         do k = 1, size(lines)
            call keep_best(pair_of(p, g, cranks(i), lines(k), closed), most, kept)
         end do
         tried = tried + size(lines)
         if (size(lines) > 0) cycle
         do k = i + 1, size(cranks)
            call keep_best(pair_of(p, g, cranks(i), cranks(k), closed), most, kept)
         end do
         tried = tried + size(cranks) - i
      end do
   end subroutine find_pairs

   !> What every pair of points of the curves is worth.
   subroutine map_pairs(p, d, g, closed, map)
      complex(wp), intent(in) :: p(4), d(3), g(3)
      logical, intent(in) :: closed
      type(pole_map_t), intent(out) :: map
      type(curve_sample_t), allocatable :: samples(:)
      type(exact_result_t) :: one
      integer, allocatable :: place(:)
      integer :: i, k, n

      n = branches*rays_of_map
      map%ray = [(half_turn*(real(modulo(i - 1, rays_of_map), wp) + 0.5_wp)/real(rays_of_map, wp), i=1, n)]
      map%branch = [(1 + (i - 1)/rays_of_map, i=1, n)]
      allocate (map%class(n, n), source=0)
      allocate (map%transmission(n, n), source=0.0_wp)
      call sample_curve(d, g, rays_of_map, samples)
      place = (samples%branch - 1)*rays_of_map + 1 + int(samples%ray*real(rays_of_map, wp)/half_turn)
      do i = 1, size(samples)
         do k = i + 1, size(samples)
            one = pair_of(p, g, samples(i)%dyad, samples(k)%dyad, closed)
            call put(place(i), place(k), one%verdict)
            call put(place(k), place(i), one%verdict)
         end do
      end do

   contains

      subroutine put(row, column, verdict)
         integer, intent(in) :: row, column
         type(verdict_t), intent(in) :: verdict

         map%class(row, column) = verdict%class
         map%transmission(row, column) = verdict%transmission
      end subroutine put
   end subroutine map_pairs
end module psalm_pole_curves
