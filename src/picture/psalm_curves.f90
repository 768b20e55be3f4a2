!> Curves of a scene: output, error, transmission angles, further outputs, rates, bands of tolerance, forces, the bending of a link,
!> contact in a joint, convergence.
module psalm_curves
   use psalm_dyad_kind, only: assur_rrr
   use psalm_elementary, only: hypotenuse
   use psalm_force_analysis, only: column_drive, column_fx, column_fy, column_moment
   use psalm_force_scene, only: force_scene_t
   use psalm_kinds, only: wp, full_turn
   use psalm_number, only: parse_real
   use psalm_output_kind, only: motion_point, motion_angle, motion_distance
   use psalm_plot, only: plot_t, begin_plot, add_line, add_span, look_area, look_dashed, look_dots, look_dotted, look_joined, &
                         look_line, look_rings, look_steps, look_thin
   use psalm_scene, only: scene_t, motion_number
   use psalm_source, only: line_t
   use psalm_text, only: to_text
   use psalm_trace, only: position_row_t
   implicit none (type, external)
   private
   public :: make_curves

   integer, parameter :: most_lines = 12    !! transmission angles named one by one
   real(wp), parameter :: part_of_turn = 300.0_wp !! prescribed over less than this, degrees, the axis shows that part only
   integer, parameter :: limit = 0          !! colour
   character(1), parameter :: components(2) = ['x', 'y']

   !> The rows of a scene as curves show them.
   type :: shown_rows_t
      real(wp), allocatable :: x(:), y(:, :)   !! input on the axis; shape (positions, components): angles go on beyond a turn
   end type shown_rows_t

contains

   !> The curves of a valid scene, in the order in which they are shown.
   subroutine make_curves(scene, progress, plots)
      type(scene_t), intent(in) :: scene
      type(line_t), intent(in) :: progress(:)  !! device 1, empty if there is none
      type(plot_t), allocatable, intent(out) :: plots(:)
      type(plot_t) :: like
      type(shown_rows_t) :: own, sweep

      allocate (plots(0))
      like%below = input_name(scene)
      like%turning = .not. scene%sliding
      call find_axis(scene, like%from, like%to)
      call add_bands(scene, like)
      call take_rows(scene, own, sweep)
      if (allocated(scene%curves)) then
         call add_outputs(scene, own%x, sweep%x, like, plots)
      else if (scene%motion /= motion_number) then
         ! a number is drawn in the panels
         call add_output(scene, own, sweep, like, plots)
      end if
      if (scene%desired) call add_errors(scene, own%x, like, plots)
      if (any(scene%pairs%joint_type == assur_rrr)) call add_angles(scene, sweep%x, like, plots)
      if (allocated(scene%band)) call add_deviations(scene, sweep%x, like, plots)
      call add_panels(scene, sweep%x, like, plots)
      if (allocated(scene%forces)) call add_forces(scene%forces, sweep%x, like, plots)
      if (allocated(scene%vibration)) call add_deflection(scene, sweep%x, like, plots)
      if (allocated(scene%clearance)) call add_contact(scene, sweep%x, like, plots)
      if (.not. scene%sliding) call close_turn(sweep%x, scene%sense*full_turn, plots)
      call add_progress(progress, plots)
   end subroutine make_curves

   !> Range of the inputs that is shown: what is prescribed, if that is a part of a turn only, else the whole turn.
   pure subroutine find_axis(scene, low, high)
      type(scene_t), intent(in) :: scene
      real(wp), intent(out) :: low, high
      real(wp) :: ends(2)
      integer :: i

      if (scene%sliding) then
         low = minval(scene%sweep%input)
         high = maxval(scene%sweep%input)
         return
      end if
      ends = scene%sweep%input(1)
      do i = 1, scene%prescribed%n
         associate (place => along(scene, scene%prescribed, i))
            ends = [min(ends(1), place), max(ends(2), place)]
         end associate
      end do
      low = ends(1)
      high = ends(2)
      if (scene%prescribed%n > 1 .and. high - low < part_of_turn .and. high > low) return
      low = scene%sweep%input(1) + min(0.0_wp, scene%sense*full_turn)
      high = low + full_turn
   end subroutine find_axis

   !> Shade where the linkage does not close, and in another colour where it closes beyond a limit.
   subroutine add_bands(scene, like)
      type(scene_t), intent(in) :: scene
      type(plot_t), intent(inout) :: like
      integer, parameter :: good = 0, beyond_limit = 1, open = 2
      integer :: status(scene%sweep%n)
      real(wp) :: half
      integer :: i, k

      associate (row => scene%sweep)
         if (row%n < 2) return
         half = 0.5_wp*abs(row%delt(2) - row%delt(1))
         status = good
         do i = 1, size(row%violations)
            status(row%violations(i)%first:row%violations(i)%last) = beyond_limit
         end do
         where (.not. row%closed) status = open
         i = 1
         do while (i <= row%n)
            k = i
            do while (k < row%n)
               if (status(k + 1) /= status(i)) exit
               k = k + 1
            end do
            associate (ends => [along(scene, row, i), along(scene, row, k)])
               if (status(i) /= good) call add_span(like, minval(ends) - half, maxval(ends) + half, status(i) == beyond_limit)
            end associate
            i = k + 1
         end do
      end associate
   end subroutine add_bands

   !> Input of a position on the axis of the sweep.
   pure real(wp) function along(scene, row, i)
      type(scene_t), intent(in) :: scene
      type(position_row_t), intent(in) :: row
      integer, intent(in) :: i

      along = row%input(i)
      if (scene%sliding) return
      associate (start => scene%sweep%input(1))
         along = start + scene%sense*modulo(scene%sense*(row%delt(i) - scene%sweep%delt(1)), full_turn)
      end associate
   end function along

   !> Both rows; an angle goes on from the one before it.
   subroutine take_rows(scene, own, sweep)
      type(scene_t), intent(in) :: scene
      type(shown_rows_t), intent(out) :: own, sweep
      real(wp) :: before
      integer :: i

      own%x = [(along(scene, scene%prescribed, i), i=1, scene%prescribed%n)]
      sweep%x = [(along(scene, scene%sweep, i), i=1, scene%sweep%n)]
      own%y = reshape([scene%prescribed%actual, scene%prescribed%actual_y], [scene%prescribed%n, 2])
      sweep%y = reshape([scene%sweep%actual, scene%sweep%actual_y], [scene%sweep%n, 2])
      if (scene%motion /= motion_angle) return
      before = 0.0_wp
      if (scene%desired) before = scene%prescribed%actual(1)
      do i = 1, scene%sweep%n
         sweep%y(i, 1) = sweep%y(i, 1) + full_turn*anint((before - sweep%y(i, 1))/full_turn)
         if (scene%sweep%closed(i)) before = sweep%y(i, 1)
      end do
      if (scene%desired) return
      before = 0.0_wp
      do i = 1, scene%prescribed%n
         own%y(i, 1) = own%y(i, 1) + full_turn*anint((before - own%y(i, 1))/full_turn)
         if (scene%prescribed%closed(i)) before = own%y(i, 1)
      end do
   end subroutine take_rows

   !> The curves of a whole turn end where they begin; an angle that has turned ends whole turns further.
   pure subroutine close_turn(sweep, turn, plots)
      real(wp), intent(in) :: sweep(:)            !! places on the axis
      real(wp), intent(in) :: turn                !! degrees, with the sense
      type(plot_t), intent(inout) :: plots(:)
      integer :: p, k, n

      n = size(sweep)
      do p = 1, size(plots)
         do k = 1, size(plots(p)%lines)
            associate (line => plots(p)%lines(k))
               if (all(line%look /= [look_line, look_thin, look_dashed, look_dotted, look_area]) .or. size(line%x) /= n) cycle
               line%x = [line%x, sweep(1) + turn]
               line%y = [line%y, again(line%y, plots(p)%scale)]
               line%known = [line%known, line%known(1)]
               if (allocated(line%other)) line%other = [line%other, again(line%other, plots(p)%scale)]
            end associate
         end do
      end do

   contains

      pure real(wp) function again(y, scale)
         real(wp), intent(in) :: y(:)
         real(wp), intent(in) :: scale            !! a full turn: of an angle

         again = y(1)
         if (scale == full_turn) again = again + full_turn*anint((y(n) - again)/full_turn)
      end function again
   end subroutine close_turn

   !> The output of the loops: bands of tolerance, sweep, prescribed positions, what is desired there.
   subroutine add_output(scene, own, sweep, like, plots)
      type(scene_t), intent(in) :: scene
      type(shown_rows_t), intent(in) :: own, sweep
      type(plot_t), intent(in) :: like
      type(plot_t), allocatable, intent(inout) :: plots(:)
      integer :: c

      do c = 1, merge(2, 1, scene%motion == motion_point)
         if (scene%motion == motion_point) then
            call begin_plot(components(c)//' of '//called(scene)//', length', like, plots)
         else
            call begin_plot(output_name(scene), like, plots)
         end if
         associate (plot => plots(size(plots)), swept => sweep%y(:, c))
            plot%scale = size_of(scene)
            if (allocated(scene%band)) then
               associate (band => scene%band)
                  call add_line(plot, 'root sum square', look_area, 1, sweep%x, swept - band%square(:, c), band%known, &
                                swept + band%square(:, c))
                  call add_line(plot, 'worst case', look_dotted, 1, sweep%x, swept - band%worst(:, c), band%known)
                  call add_line(plot, '', look_dotted, 1, sweep%x, swept + band%worst(:, c), band%known)
               end associate
            end if
            call add_line(plot, trim(merge('actual', '      ', scene%desired .or. allocated(scene%band))), look_line, 1, sweep%x, &
                          swept, scene%sweep%closed)
            call add_line(plot, '', look_dots, 1, own%x, own%y(:, c), scene%prescribed%closed)
            if (.not. scene%desired) cycle
            if (c == 1) call add_line(plot, 'desired', look_rings, 2, own%x, scene%prescribed%wanted)
            if (c == 2) call add_line(plot, 'desired', look_rings, 2, own%x, scene%prescribed%desired_y)
         end associate
      end do
   end subroutine add_output

   !> All outputs of a sketch without loops of dyads, and its drives where there are several.
   subroutine add_outputs(scene, own, sweep, like, plots)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: own(:), sweep(:)    !! places on the axis
      type(plot_t), intent(in) :: like
      type(plot_t), allocatable, intent(inout) :: plots(:)
      character(:), allocatable :: unit
      logical :: alike
      integer :: k

      do k = 1, size(scene%curves)
         associate (curve => scene%curves(k))
            call begin_plot(trim(curve%name), like, plots)
            plots(size(plots))%scale = merge(full_turn, maxval(scene%high - scene%low), curve%angle)
            call add_line(plots(size(plots)), '', look_line, 1, sweep, curve%sweep, &
                          scene%sweep%closed .and. curve%sweep < huge(1.0_wp))
            call add_line(plots(size(plots)), '', look_dots, 1, own, curve%prescribed, &
                          scene%prescribed%closed .and. curve%prescribed < huge(1.0_wp))
         end associate
      end do
      if (size(scene%drives) < 2) return
      alike = all(scene%drives%turning .eqv. scene%drives(1)%turning)
      unit = ', '
      if (alike) unit = unit_of_drive(scene%drives(1)%turning)//' '
      call begin_plot('drives'//unit//'from the drawing', like, plots)
      do k = 1, size(scene%drives)
         unit = ''
         if (.not. alike) unit = unit_of_drive(scene%drives(k)%turning)
         call add_line(plots(size(plots)), trim(scene%drives(k)%name)//unit, look_line, k, sweep, scene%drives(k)%sweep)
      end do

   contains

      pure function unit_of_drive(turning) result(unit)
         logical, intent(in) :: turning
         character(:), allocatable :: unit

         unit = trim(merge(', degrees', ', length ', turning))
      end function unit_of_drive
   end subroutine add_outputs

   subroutine add_errors(scene, own, like, plots)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: own(:)
      type(plot_t), intent(in) :: like
      type(plot_t), allocatable, intent(inout) :: plots(:)

      call begin_plot('error: desired - actual'//unit_of(scene), like, plots)
      associate (plot => plots(size(plots)), row => scene%prescribed)
         plot%scale = size_of(scene)
         plot%from_zero = .true.
         call add_line(plot, trim(merge('x', ' ', scene%motion == motion_point)), look_joined, 1, own, row%error, row%closed)
         if (scene%motion == motion_point) call add_line(plot, 'y', look_joined, 2, own, row%error_y, row%closed)
      end associate
   end subroutine add_errors

   subroutine add_angles(scene, sweep, like, plots)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: sweep(:)
      type(plot_t), intent(in) :: like
      type(plot_t), allocatable, intent(inout) :: plots(:)
      integer :: loop, k

      call begin_plot('transmission angle, degrees', like, plots)
      associate (plot => plots(size(plots)), ends => [like%from, like%to])
         plot%high = 0.5_wp*full_turn
         k = 0
         do loop = 1, scene%loops
            if (scene%pairs(loop)%joint_type /= assur_rrr) cycle
            k = k + 1
            if (k <= most_lines) then
               call add_line(plot, scene%pairs(loop)%name, look_line, k, sweep, scene%sweep%angle(loop, :), &
                             scene%sweep%valid(loop, :))
            else
               call add_line(plot, '', look_line, k, sweep, scene%sweep%angle(loop, :), scene%sweep%valid(loop, :))
            end if
         end do
         call add_line(plot, 'limits', look_dashed, limit, ends, spread(90.0_wp - scene%tangle, 1, 2))
         call add_line(plot, '', look_dashed, limit, ends, spread(90.0_wp + scene%tangle, 1, 2))
      end associate
   end subroutine add_angles

   !> The deviations within the tolerances: bands are often too narrow to be seen on the curve.
   subroutine add_deviations(scene, sweep, like, plots)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: sweep(:)
      type(plot_t), intent(in) :: like
      type(plot_t), allocatable, intent(inout) :: plots(:)
      character(:), allocatable :: label
      integer :: c

      associate (band => scene%band)
         if (.not. any(band%known)) return
         label = unit_of(scene)
         if (scene%motion == motion_number) label = ' of '//called(scene)
         call begin_plot('deviation within tolerances'//label, like, plots)
         plots(size(plots))%from_zero = .true.
         do c = 1, min(2, band%components)
            label = ''
            if (band%components > 1) label = components(c)//', '
            call add_line(plots(size(plots)), label//'root sum square', look_line, c, sweep, band%square(:, c), band%known)
            call add_line(plots(size(plots)), label//'worst case', look_dashed, c, sweep, band%worst(:, c), band%known)
         end do
      end associate
   end subroutine add_deviations

   !> The panels of the scene that have a number: further outputs, rates, families.
   subroutine add_panels(scene, sweep, like, plots)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: sweep(:)
      type(plot_t), intent(in) :: like
      type(plot_t), allocatable, intent(inout) :: plots(:)
      integer :: p, k

      do p = 1, size(scene%panels)
         associate (panel => scene%panels(p))
            if (.not. any([(any(panel%lines(k)%known), k=1, size(panel%lines))])) cycle
            if (len_trim(panel%note) > 0) then
               call begin_plot(trim(panel%name)//' ('//trim(panel%note)//')', like, plots)
            else
               call begin_plot(trim(panel%name), like, plots)
            end if
            plots(size(plots))%scale = panel%scale
            do k = 1, size(panel%lines)
               call add_line(plots(size(plots)), trim(panel%lines(k)%label), look_line, k, sweep, panel%lines(k)%values, &
                             panel%lines(k)%known)
            end do
         end associate
      end do
   end subroutine add_panels

   !> Drive, force and moment on the frame, also as they were before counterweights and springs were added.
   subroutine add_forces(forces, sweep, like, plots)
      type(force_scene_t), intent(in) :: forces
      real(wp), intent(in) :: sweep(:)
      type(plot_t), intent(in) :: like
      type(plot_t), allocatable, intent(inout) :: plots(:)
      logical, allocatable :: known(:), bare(:)
      integer, allocatable :: at(:)
      real(wp) :: largest, turning
      integer :: i, n

      n = size(sweep)
      known = [(forces%sweep%table%known(i), i=1, n)]
      if (.not. any(known)) return
      at = pack([(i, i=1, n)], known)
      if (allocated(forces%bare)) bare = [(forces%bare%known(i), i=1, n)]
      associate (value => forces%sweep%table%value)
         ! what the joints bear tells what is rounding; not so where curves of the bare linkage are on the same axes
         largest = maxval(abs(forces%sweep%joint(:, at, :)))
         turning = max(maxval(abs(value(at, column_drive))), maxval(abs(value(at, column_moment))))
         if (allocated(forces%bare)) largest = 0.0_wp
         if (allocated(forces%bare)) turning = 0.0_wp
         call begin_plot(trim(merge('force of the drive, N   ', 'torque of the drive, N m', forces%sliding)), like, plots)
         plots(size(plots))%scale = merge(largest, turning, forces%sliding)
         call add_line(plots(size(plots)), '', look_line, 1, sweep, value(:, column_drive), known)
         if (allocated(forces%bare)) call add_line(plots(size(plots)), 'before', look_dashed, 3, sweep, &
                                                   forces%bare%value(:, column_drive), bare)
         call begin_plot('force on the frame, N', like, plots)
         associate (plot => plots(size(plots)))
            plot%scale = largest
            call add_line(plot, 'x', look_line, 1, sweep, value(:, column_fx), known)
            call add_line(plot, 'y', look_line, 2, sweep, value(:, column_fy), known)
            call add_line(plot, 'amount', look_thin, 3, sweep, amount(value, known), known)
            if (allocated(forces%bare)) call add_line(plot, 'amount before', look_dashed, 3, sweep, &
                                                      amount(forces%bare%value, bare), bare)
         end associate
         call begin_plot('moment on the frame, N m', like, plots)
         plots(size(plots))%scale = turning
         call add_line(plots(size(plots)), '', look_line, 4, sweep, value(:, column_moment), known)
      end associate

   contains

      pure function amount(value, there) result(sizes)
         real(wp), intent(in) :: value(:, :)
         logical, intent(in) :: there(:)
         real(wp), allocatable :: sizes(:)

         allocate (sizes(size(there)), source=0.0_wp)
         where (there) sizes = hypotenuse(value(:, column_fx), value(:, column_fy))
      end function amount
   end subroutine add_forces

   !> How far the vibrating link bends in each mode.
   subroutine add_deflection(scene, sweep, like, plots)
      type(scene_t), intent(in) :: scene          !! with a vibrating link
      real(wp), intent(in) :: sweep(:)
      type(plot_t), intent(in) :: like
      type(plot_t), allocatable, intent(inout) :: plots(:)
      integer :: j

      call begin_plot('deflection of the link, length'//trim(merge('              ', ' (not settled)', &
                                                                   scene%vibration%settles)), like, plots)
      plots(size(plots))%from_zero = .true.
      do j = 1, size(scene%vibration%deflection, 2)
         call add_line(plots(size(plots)), 'mode '//to_text(j), look_line, j, sweep, scene%vibration%deflection(:, j))
      end do
   end subroutine add_deflection

   !> The force between pin and hole of a joint with clearance, beside the load without clearance.
   subroutine add_contact(scene, sweep, like, plots)
      type(scene_t), intent(in) :: scene          !! with a joint with clearance
      real(wp), intent(in) :: sweep(:)
      type(plot_t), intent(in) :: like
      type(plot_t), allocatable, intent(inout) :: plots(:)

      associate (joint => scene%clearance)
         call begin_plot('contact in joint '//joint%name//', N', like, plots)
         plots(size(plots))%from_zero = .true.
         call add_line(plots(size(plots)), 'force of contact', look_line, 1, sweep, joint%force)
         call add_line(plots(size(plots)), 'load without clearance', look_dashed, 2, sweep, &
                       hypotenuse(joint%load(1, :), joint%load(2, :)))
      end associate
   end subroutine add_contact

   !> Best and worst objective by iteration, or objective of each start and the best so far, from device 1.
   subroutine add_progress(progress, plots)
      type(line_t), intent(in) :: progress(:)
      type(plot_t), allocatable, intent(inout) :: plots(:)
      type(plot_t) :: axis
      character(:), allocatable :: reason
      real(wp), dimension(size(progress)) :: at, best, worst
      logical :: starts, valid
      integer :: i, n

      n = 0
      starts = .false.
      do i = 1, size(progress)
         associate (line => progress(i)%text, k => n + 1)
            valid = .false.
            if (index(line, ' ITERATION ') == 1) then
               call value_after(line, ' ITERATION', at(k), valid)
               if (valid) call value_after(line, ' BEST', best(k), valid)
               if (valid) call value_after(line, ' WORST', worst(k), valid)
            else if (index(line, ' START ') == 1) then
               call value_after(line, ' START', at(k), valid)
               if (valid) call value_after(line, ' OBJECTIVE', worst(k), valid)
               if (valid) then
                  starts = .true.
                  best(k) = minval(worst(:k))
               end if
            end if
         end associate
         if (valid) n = n + 1
      end do
      if (n == 0) return
      axis%logarithmic = .true.
      axis%from = minval(at(:n))
      axis%to = max(maxval(at(:n)), axis%from + 1.0_wp)
      axis%below = trim(merge('start    ', 'iteration', starts))
      call begin_plot('objective', axis, plots)
      associate (plot => plots(size(plots)))
         if (starts) then
            call add_line(plot, 'start', look_dots, 2, at(:n), worst(:n))
            call add_line(plot, 'best', look_steps, 1, at(:n), best(:n))
         else
            call add_line(plot, 'worst', look_joined, 2, at(:n), worst(:n))
            call add_line(plot, 'best', look_joined, 1, at(:n), best(:n))
         end if
      end associate

   contains

      subroutine value_after(line, word, value, valid)
         character(*), intent(in) :: line, word
         real(wp), intent(out) :: value
         logical, intent(out) :: valid
         integer :: first, last

         value = 0.0_wp
         valid = index(line, word//' ') > 0
         if (.not. valid) return
         first = index(line, word//' ') + len(word)
         first = first + verify(line(first:)//'x', ' ') - 1
         last = first + scan(line(first:)//' ', ' ') - 2
         call parse_real(line(first:last), value, valid, reason)
      end subroutine value_after
   end subroutine add_progress

   !> The unit of the output after its name; a number that is none of a point or a pose has none.
   pure function unit_of(scene) result(unit)
      type(scene_t), intent(in) :: scene
      character(:), allocatable :: unit

      unit = ', length'
      if (scene%motion == motion_angle) unit = ', degrees'
      if (scene%motion == motion_number) unit = ''
   end function unit_of

   !> What is large in the output: changes far below it are rounding.
   pure real(wp) function size_of(scene)
      type(scene_t), intent(in) :: scene

      size_of = merge(full_turn, maxval(scene%high - scene%low), scene%motion == motion_angle)
   end function size_of

   !> What the output point is called.
   pure function called(scene) result(name)
      type(scene_t), intent(in) :: scene
      character(:), allocatable :: name

      name = 'the output point'
      if (allocated(scene%output_label)) name = scene%output_label
   end function called

   pure function output_name(scene) result(name)
      type(scene_t), intent(in) :: scene
      character(:), allocatable :: name

      if (allocated(scene%output_label)) then
         name = scene%output_label//unit_of(scene)
         return
      end if
      select case (scene%motion)
      case (motion_angle)
         name = 'angle, degrees'
      case (motion_distance)
         name = 'distance, length'
      case default
         name = 'place of the slide, length'
      end select
   end function output_name

   pure function input_name(scene) result(name)
      type(scene_t), intent(in) :: scene
      character(:), allocatable :: name

      if (allocated(scene%input_label)) then
         name = scene%input_label
         return
      end if
      name = trim(merge('input, length        ', 'crank angle, degrees ', scene%sliding))
   end function input_name
end module psalm_curves
