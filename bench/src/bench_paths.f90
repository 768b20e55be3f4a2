!> Paths without prescribed timing: how soon the best four-bar is found.
!>
!> A row of a table for each case: points, best sum of squares, RMS error over the size of the path, seeds that reach it, median and
!> worst time, time of a batch of random linkages. Both assemblies are searched together, with the crank going either way, from no
!> first guess, with one setting for all. Reached: within 1 per cent of the best sum of all runs, or errors below a millionth of the
!> path's size.
module bench_paths
   use, intrinsic :: iso_fortran_env, only: output_unit
   use psalm_angles, only: unit_vector
   use psalm_cases, only: read_cases
   use psalm_data_set, only: data_set_t
   use psalm_free_path, only: search_batch
   use psalm_kinds, only: wp, right_angle
   use psalm_path_fit, only: fitted_path_t, path_workspace_t, path_timing_t, prepare_path
   use psalm_status, only: diagnostics_t
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: measure_path, make_path, name_of

   integer, parameter :: seeds = 20, batches_at_first = 25, most_batches = 500, ways = 4
   real(wp), parameter :: within = 1.01_wp, exact = 1.0e-6_wp
   real(wp), parameter :: slack = 1.0e-7_wp          !! of the cosine of the least transmission angle, as searches have it
   real(wp), parameter :: kept = 1.0e-6_wp           !! relative violation below which a bound is kept
   real(wp), parameter :: thousand = 1.0e3_wp

contains

   !> Measure a data set and print its row.
   subroutine measure_path(file)
      character(*), intent(in) :: file
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      type(fitted_path_t) :: path(ways)
      type(path_workspace_t) :: work
      type(path_timing_t) :: timing
      type(xoshiro_t) :: random
      real(wp), allocatable :: value(:, :)
      real(wp) :: best, goal, spent, begun, ended, took(seeds), unit
      integer :: done(seeds), seed, n, reached, first, way

      call read_cases(file, sets, findings)
      n = sets(1)%method%ndes
      do way = 1, ways
         call make_path(sets(1), merge(1.0_wp, -1.0_wp, mod(way, 2) == 1), merge(1.0_wp, -1.0_wp, way <= ways/2), path(way), work)
      end do
      unit = path(1)%size**2*path(1)%weight_scale
      allocate (timing%t(n), source=0.0_wp)
      best = huge(1.0_wp)
      allocate (value(most_batches, seeds), source=huge(1.0_wp))
      done = 0
      spent = 0.0_wp
      call run(batches_at_first)
      best = minval(value)
      goal = max(within*best, exact**2*real(n, wp)*path(1)%size**2)
      call run(most_batches)
      best = min(best, minval(value))
      goal = max(within*best, exact**2*real(n, wp)*path(1)%size**2)
      reached = 0
      do seed = 1, seeds
         first = findloc(value(:, seed) <= goal, .true., dim=1)
         if (first == 0) cycle
         reached = reached + 1
         took(reached) = real(first, wp)*spent/real(sum(done), wp)
      end do
      call sort(took(:reached))
      write (output_unit, '(a, i0, a, es12.6, a, es7.1, a, i0, a, i0, 2(a, f6.3), a, f5.1, a)') '| `'//name_of(file)//'` | ', n, &
         ' | ', best, ' | ', sqrt(best/real(n, wp))/path(1)%size, ' | ', reached, ' of ', seeds, ' | ', &
         took((reached + 1)/2), ' | ', took(reached), ' | ', thousand*spent/real(sum(done), wp), ' |'
      flush (output_unit)

   contains

      !> Batches of every seed up to that number, but no more once the goal is reached.
      subroutine run(until)
         integer, intent(in) :: until
         integer :: batch

         do seed = 1, seeds
            call random%seed(seed, purpose_starts)
            call cpu_time(begun)
            do batch = done(seed) + 1, until
               if (until > batches_at_first .and. minval(value(:, seed)) <= goal) exit
               call random%use_stream(batch)
               call search_batch(path, random, work, timing)
               done(seed) = batch
               if (timing%worst <= kept) value(batch, seed) = timing%error*unit
            end do
            call cpu_time(ended)
            spent = spent + ended - begun
         end do
      end subroutine run
   end subroutine measure_path

   !> Points and bounds of a data set: four lengths, coupler point and pivot come first among the variables. With the crank going
   !> the other way the mirror image is searched.
   subroutine make_path(set, sense, side, path, work)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: sense, side            !! of the crank, the coupler's: +1 or -1
      type(fitted_path_t), intent(out) :: path
      type(path_workspace_t), intent(out) :: work
      integer, parameter :: ground = 4
      integer, parameter :: of(6) = [ground, 1, 2, 3, 5, 6] !! among OPLOW and OPHIGH
      real(wp) :: cosine, unused

      call unit_vector(right_angle - set%limits%tangle, cosine, unused)
      if (set%limits%tangle < right_angle) cosine = cosine - slack
      associate (n => set%method%ndes)
         call prepare_path(set%method%desx(:n), sense*set%method%desy(:n), spread(1.0_wp, 1, n), set%limits%oplow(of), &
                           set%limits%ophigh(of), cosine, &
                           sense*side, path, work)
      end associate
   end subroutine make_path

   pure function name_of(file) result(name)
      character(*), intent(in) :: file
      character(:), allocatable :: name

      name = file(index(file, '/', back=.true.) + 1:index(file, '.', back=.true.) - 1)
   end function name_of

   pure subroutine sort(a)
      real(wp), intent(inout) :: a(:)
      real(wp) :: least
      integer :: i, k

      do i = 1, size(a)
         k = i - 1 + minloc(a(i:), dim=1)
         least = a(k)
         a(k) = a(i)
         a(i) = least
      end do
   end subroutine sort
end module bench_paths
