!> Phase planes of a motion in time: the speed of each free drive over its place.
module psalm_phase_curves
   use psalm_column_names, only: per_time, rate_unit
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_panels, only: with_unit
   use psalm_plot, only: plot_t, add_line, begin_plot, look_dashed, look_dots, look_line, look_rings
   use psalm_time_study, only: time_study_t
   implicit none (type, external)
   private
   public :: make_phase_curves

   real(wp), parameter :: pad = 0.05_wp               !! of the places' range, left and right
   real(wp), parameter :: around = 1.0e-3_wp          !! degrees or lengths on either side of a drive that stays where it is
   real(wp), parameter :: height = 360.0_wp           !! pixels
   integer, parameter :: colour_motion = 1, colour_impact = 2, colour_start = 3, colour_end = 4, colour_rest = 5

contains

   !> A plot for each free drive: places as shown, degrees or lengths, speeds in rad/s or lengths/s. Impacts are jumps of the speed,
   !> which break the line. No plot where no drive is free.
   subroutine make_phase_curves(set, motion, plots)
      type(data_set_t), intent(in) :: set
      type(time_study_t), intent(in) :: motion          !! with at least one row
      type(plot_t), allocatable, intent(out) :: plots(:)
      integer :: k

      allocate (plots(0))
      do k = 1, size(motion%free_drives)
         call add_plane(motion%free_drives(k), k)
      end do

   contains

      !> The plane of a drive, `number` among the free ones.
      subroutine add_plane(drive, number)
         integer, intent(in) :: drive, number
         type(plot_t) :: axes
         character(:), allocatable :: words

         words = ''
         if (set%has_names()) words = ' of drive '//set%sketch%drive_label(drive)
         axes%below = 'place'//words
         if (.not. set%has_names()) axes%below = 'input'
         axes%below = with_unit(trim(axes%below), place_unit(drive))
         axes%height = height
         call begin_plot(with_unit('speed'//words, rate_unit(.not. motion%forces%drive_slides(drive), per_time(), 1)), axes, plots)
         associate (plot => plots(size(plots)), rows => size(motion%time))
            call add_motion(plot, drive)
            call add_impacts(plot, drive)
            call add_line(plot, 'start', look_rings, colour_start, motion%drives(:1, drive, 0), motion%drives(:1, drive, 1))
            call add_line(plot, 'end', look_dots, colour_end, motion%drives(rows:, drive, 0), motion%drives(rows:, drive, 1))
            if (motion%rests) then
               call add_rests(plot, drive, number, .true.)
               call add_rests(plot, drive, number, .false.)
            end if
            call widen(plot)
            plot%scale = maxval(abs(motion%drives(:, drive, 1)))
         end associate
      end subroutine add_plane

      pure function place_unit(drive) result(unit)
         integer, intent(in) :: drive
         character(:), allocatable :: unit

         unit = 'degrees'
         if (motion%forces%drive_slides(drive)) unit = 'length'
      end function place_unit

      !> The states; an impact between two of them ends a stroke and begins the next.
      subroutine add_motion(plot, drive)
         type(plot_t), intent(inout) :: plot
         integer, intent(in) :: drive
         real(wp), allocatable :: x(:), y(:)
         logical, allocatable :: known(:)
         integer :: row, jump, n

         associate (rows => size(motion%time), jumps => size(motion%jump_time))
            allocate (x(rows + 3*jumps), y(rows + 3*jumps), source=0.0_wp)
            allocate (known(rows + 3*jumps), source=.true.)
            n = 0
            jump = 0
            do row = 1, rows
               do while (jump < jumps)
                  if (motion%jump_time(jump + 1) > motion%time(row)) exit
                  jump = jump + 1
                  x(n + 1:n + 3) = motion%jumps(jump, drive, 1)
                  y(n + 1:n + 3) = motion%jumps(jump, drive, [2, 2, 3])
                  known(n + 2) = .false.
                  n = n + 3
               end do
               n = n + 1
               x(n) = motion%drives(row, drive, 0)
               y(n) = motion%drives(row, drive, 1)
            end do
         end associate
         call add_line(plot, 'motion', look_line, colour_motion, x(:n), y(:n), known(:n))
      end subroutine add_motion

      !> What impacts change, as dashed lines.
      subroutine add_impacts(plot, drive)
         type(plot_t), intent(inout) :: plot
         integer, intent(in) :: drive
         real(wp), allocatable :: x(:), y(:)
         logical, allocatable :: known(:)
         integer :: j, n

         n = size(motion%jump_time)
         if (n == 0) return
         allocate (x(3*n), y(3*n), source=0.0_wp)
         allocate (known(3*n), source=.true.)
         do j = 1, n
            x(3*j - 2:3*j) = motion%jumps(j, drive, 1)
            y(3*j - 2:3*j) = motion%jumps(j, drive, [2, 3, 3])
            known(3*j) = .false.
         end do
         call add_line(plot, 'impact', look_dashed, colour_impact, x, y, known)
      end subroutine add_impacts

      !> Equilibria, whose speed is 0: those that are stable, or the others.
      subroutine add_rests(plot, drive, number, stable)
         type(plot_t), intent(inout) :: plot
         integer, intent(in) :: drive, number
         logical, intent(in) :: stable
         real(wp), allocatable :: x(:)
         integer :: k

         allocate (x(0))
         do k = 1, size(motion%equilibria%list)
            associate (one => motion%equilibria%list(k))
               if (one%stable() .neqv. stable) cycle
               x = [x, one%q(number)*merge(1.0_wp, degrees_per_radian, motion%forces%drive_slides(drive)) + &
                    merge(motion%zero_input, 0.0_wp, drive == 1)]
            end associate
         end do
         if (size(x) == 0) return
         call add_line(plot, trim(merge('equilibrium            ', 'equilibrium, not stable', stable)), &
                       merge(look_dots, look_rings, stable), colour_rest, x, 0.0_wp*x)
      end subroutine add_rests
   end subroutine make_phase_curves

   !> Let the axis have all places in view.
   pure subroutine widen(plot)
      type(plot_t), intent(inout) :: plot
      real(wp) :: more
      integer :: k

      plot%from = huge(1.0_wp)
      plot%to = -huge(1.0_wp)
      do k = 1, size(plot%lines)
         plot%from = min(plot%from, minval(plot%lines(k)%x))
         plot%to = max(plot%to, maxval(plot%lines(k)%x))
      end do
      more = max(pad*(plot%to - plot%from), around)
      plot%from = plot%from - more
      plot%to = plot%to + more
   end subroutine widen
end module psalm_phase_curves
