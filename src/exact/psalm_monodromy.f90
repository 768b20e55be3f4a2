!> All solutions of a generic problem of two legs, from nothing.
!>
!> One problem is drawn with a solution. Loops through other problems lead its solutions into each other; the way back of a loop
!> begins at a problem that is the same up to a scale and a turn of the numbers and, independently, of their partners, so it is
!> another way. Source: Duff, Hill, Jensen, Lee, Leykin and Sommars (2019), Solving polynomial systems via homotopy continuation
!> and monodromy.
module psalm_monodromy
   use psalm_kinds, only: wp
   use psalm_leg_lanes, only: problem_path_t
   use psalm_leg_problem, only: leg_data_t, leg_problem_t, at_a, at_ah, at_b, at_bh, at_x, at_xh, at_y, at_yh, draw_problem, &
                                random_unit, variables
   use psalm_stop, only: stop_t
   use psalm_tracker, only: track, tracked_t
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: generic_t, solve_generic, add_distinct, is_same, near, scale_problem, scale_solutions, orbit_key, &
             orbit_numbers, swap_legs

   integer, parameter :: most_idle = 8               !! loops that find nothing new before the search is given up
   integer, parameter :: orbit_numbers = 6           !! that tell solutions of nine points apart
   real(wp), parameter :: near = 1.0e-6_wp           !! relative distance of two solutions that are one

   !> A problem and all its solutions.
   type :: generic_t
      type(leg_problem_t) :: problem
      type(leg_data_t) :: data
      complex(wp), allocatable :: solutions(:, :)    !! shape (variables, count)
      integer :: loops = 0
   end type generic_t

contains

   !> Solve a generic problem. With `expected` it ends as soon as so many are found, else after some loops that found nothing new.
   !> With `orbits` one solution stands for all that exchange of the legs and the cognates make of it: of nine points.
   !> A stop leaves what the loops made before have found.
   subroutine solve_generic(problem, seed, orbits, expected, generic, stop)
      type(leg_problem_t), intent(in) :: problem
      integer, intent(in) :: seed
      logical, intent(in) :: orbits
      integer, intent(in) :: expected                !! 0: not known
      type(generic_t), intent(out) :: generic
      type(stop_t), intent(in), optional :: stop
      type(xoshiro_t) :: random
      type(leg_data_t) :: away, turned
      complex(wp) :: solution(variables), unused(variables), l, m
      complex(wp), allocatable :: starts(:, :)
      type(problem_path_t) :: path
      type(tracked_t) :: there, back
      integer :: idle, before
      logical :: drawn

      generic%problem = problem
      allocate (generic%solutions(variables, 0))
      call random%seed(seed, purpose_starts)
      call draw_problem(problem, random, generic%data, solution, drawn)
      if (.not. drawn) return
      call add_distinct(problem, reshape(solution, [variables, 1]), [.true.], orbits, generic%solutions)
      path%problem = problem
      idle = 0
      do while (idle < most_idle)
         before = size(generic%solutions, 2)
         call draw_problem(problem, random, away, unused, drawn)
         if (.not. drawn) cycle
         path%from = generic%data
         path%to = away
         call track(path, generic%solutions, there, stop=stop)
         if (there%stopped) exit
         l = random_unit(random)
         m = random_unit(random)
         starts = pack_columns(there%ends, there%arrived)
         call scale_problem(problem, away, l, m, turned)
         call scale_solutions(problem, l, m, starts)
         path%from = turned
         path%to = generic%data
         call track(path, starts, back, stop=stop)
         if (back%stopped) exit
         call add_distinct(problem, back%ends, back%arrived, orbits, generic%solutions)
         generic%loops = generic%loops + 1
         if (size(generic%solutions, 2) == before) then
            idle = idle + 1
         else
            idle = 0
         end if
         if (expected > 0 .and. size(generic%solutions, 2) >= expected) exit
      end do
   end subroutine solve_generic

   !> Those columns for which the mask is true.
   pure function pack_columns(columns, mask) result(kept)
      complex(wp), intent(in) :: columns(:, :)
      logical, intent(in) :: mask(:)
      complex(wp), allocatable :: kept(:, :)
      integer :: i, k

      allocate (kept(size(columns, 1), count(mask)))
      k = 0
      do i = 1, size(mask)
         if (.not. mask(i)) cycle
         k = k + 1
         kept(:, k) = columns(:, i)
      end do
   end function pack_columns

   !> The same problem with its numbers times l and their partners times m.
   pure subroutine scale_problem(problem, data, l, m, scaled)
      type(leg_problem_t), intent(in) :: problem
      type(leg_data_t), intent(in) :: data
      complex(wp), intent(in) :: l, m
      type(leg_data_t), intent(out) :: scaled

      scaled = data
      scaled%d = l*data%d
      scaled%dh = m*data%dh
      scaled%pivot([at_x, at_a, at_y]) = l*data%pivot([at_x, at_a, at_y])
      scaled%pivot([at_xh, at_ah, at_yh, at_bh]) = m*data%pivot([at_xh, at_ah, at_yh, at_bh])
      scaled%pivot(at_b) = merge(l/m, l, problem%slides)*data%pivot(at_b)
   end subroutine scale_problem

   !> Its solutions likewise.
   pure subroutine scale_solutions(problem, l, m, solutions)
      type(leg_problem_t), intent(in) :: problem
      complex(wp), intent(in) :: l, m
      complex(wp), intent(inout) :: solutions(:, :)  !! shape (variables, count)

      solutions([at_x, at_a, at_y], :) = l*solutions([at_x, at_a, at_y], :)
      solutions([at_xh, at_ah, at_yh, at_bh], :) = m*solutions([at_xh, at_ah, at_yh, at_bh], :)
      solutions(at_b, :) = merge(l/m, l, problem%slides)*solutions(at_b, :)
   end subroutine scale_solutions

   !> What tells solutions apart: of nine points sums over the three pivots and over the pins of the three cognates, which no
   !> exchange changes. Pivots alone do not do: of points that lie symmetrically about an axis a linkage and its mirror image may
   !> share them.
   pure function orbit_key(v) result(key)
      complex(wp), intent(in) :: v(variables)        !! with differences
      complex(wp) :: key(orbit_numbers)

      key(1::2) = sums(v(at_x), v(at_a), v(at_y), v(at_b))
      key(2::2) = sums(v(at_xh), v(at_ah), v(at_yh), v(at_bh))

   contains

      !> Of numbers or of their partners.
      pure function sums(x, a, dy, db) result(own)
         complex(wp), intent(in) :: x, a, dy, db     !! first leg; second leg less first
         complex(wp) :: own(orbit_numbers/2), b, c, y

         b = a + db
         y = x + dy
         c = a - db*x/dy
         own(1) = a + b + c
         own(2) = a*b + b*c + c*a
         ! the pins of the cognate on a and c are a - x and (a - x) (c - b)/(a - b); of that on b and c likewise
         own(3) = x*y + ((b - y)**2*(c - a) - (a - x)**2*(c - b))/db
      end function sums
   end function orbit_key

   !> A solution with the legs exchanged.
   pure function swap_legs(v, differences) result(swapped)
      complex(wp), intent(in) :: v(variables)
      logical, intent(in) :: differences
      complex(wp) :: swapped(variables)

      swapped = [v(5:8), v(1:4)]
      if (differences) swapped = [v(1:4) + v(5:8), -v(5:8)]
   end function swap_legs

   !> True if two keys are the same within rounding of what a path leaves.
   pure logical function is_same(a, b)
      complex(wp), intent(in) :: a(:), b(:)

      is_same = all(abs(a - b) <= near*(abs(a) + abs(b)))
   end function is_same

   !> Add solutions that are not there yet; with legs that may change places the exchanged ones too.
   subroutine add_distinct(problem, candidates, valid, orbits, solutions, is_new)
      type(leg_problem_t), intent(in) :: problem
      complex(wp), intent(in) :: candidates(:, :)    !! shape (variables, n)
      logical, intent(in) :: valid(:), orbits
      complex(wp), allocatable, intent(inout) :: solutions(:, :)
      logical, intent(out), optional :: is_new(:)    !! shape (n)
      complex(wp), allocatable :: keys(:, :), all_of_them(:, :)
      complex(wp) :: key(variables), one(variables)
      real(wp), allocatable :: first(:)
      integer :: n, i, k, form, forms, keyed

      keyed = merge(orbit_numbers, variables, orbits)
      forms = merge(2, 1, problem%is_symmetric() .and. .not. orbits)
      n = size(solutions, 2)
      allocate (all_of_them(variables, n + forms*size(candidates, 2)), keys(keyed, n + forms*size(candidates, 2)), &
                first(n + forms*size(candidates, 2)))
      all_of_them(:, :n) = solutions
      do i = 1, n
         keys(:, i) = key_of(solutions(:, i))
         first(i) = abs(keys(1, i))
      end do
      if (present(is_new)) is_new = .false.
      do i = 1, size(candidates, 2)
         if (.not. valid(i)) cycle
         one = candidates(:, i)
         do form = 1, forms
            if (form == 2) one = swap_legs(one, problem%differences)
            key(:keyed) = key_of(one)
            do k = 1, n
               if (abs(first(k) - abs(key(1))) > near*(first(k) + abs(key(1)))) cycle
               if (is_same(keys(:, k), key(:keyed))) exit
            end do
            if (k <= n) cycle
            if (present(is_new)) is_new(i) = .true.
            n = n + 1
            all_of_them(:, n) = one
            keys(:, n) = key(:keyed)
            first(n) = abs(key(1))
         end do
      end do
      solutions = all_of_them(:, :n)

   contains

      pure function key_of(v) result(own)
         complex(wp), intent(in) :: v(variables)
         complex(wp) :: own(keyed)

         if (orbits) then
            own = orbit_key(v)
         else
            own = v
         end if
      end function key_of
   end subroutine add_distinct
end module psalm_monodromy
