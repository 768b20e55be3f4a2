!> Equilibria as pictures show them: all of them in grey, and scenes of the small oscillations about those that are stable.
!>
!> The sweep of such a scene is one oscillation in steps of a degree of its phase: drives at the equilibrium, plus the mode's shape
!> times an amplitude that can be seen times the sine of the phase.
module psalm_mode_scene
   use psalm_angles, only: unit_vector
   use psalm_data_set, only: data_set_t
   use psalm_chain_scene, only: make_chain_scene
   use psalm_kinds, only: wp, degrees_per_radian, full_turn, pi
   use psalm_markup, only: short_number
   use psalm_parts, only: ghost_t
   use psalm_preparation, only: prepared_t
   use psalm_row_study, only: row_study_t, study_inputs
   use psalm_scene, only: scene_t, make_scene
   use psalm_status, only: finding_t
   use psalm_text, only: to_text
   use psalm_time_study, only: time_study_t, increments_of
   implicit none (type, external)
   private
   public :: mode_scene_t, make_mode_scenes, put_ghosts

   integer, parameter :: steps = 360                !! of an oscillation
   integer, parameter :: most_modes = 24            !! scenes of a case
   integer, parameter :: most_halvings = 8          !! of an amplitude, until the linkage closes all the time
   real(wp), parameter :: amplitude = 0.15_wp       !! of the drive that moves most: radians, or parts of the size
   real(wp), parameter :: ghost_room = 1.0_wp       !! equilibria widen the view by at most this part of it
   integer, parameter :: digits_for_people = 4

   !> An oscillation about an equilibrium.
   type :: mode_scene_t
      type(scene_t) :: scene
      integer :: equilibrium = 0, mode = 0          !! as kalm counts them
   end type mode_scene_t

contains

   !> All equilibria of a case, as ghosts, and the modes of those that are stable and not held by a stop.
   subroutine make_mode_scenes(set, prepared, by_links, motion, ghosts, modes, undrawn)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      logical, intent(in) :: by_links                !! it is drawn in the poses of its links
      type(time_study_t), intent(in) :: motion       !! with its equilibria
      type(ghost_t), allocatable, intent(out) :: ghosts(:)
      type(mode_scene_t), allocatable, intent(out) :: modes(:)
      character(:), allocatable, intent(out) :: undrawn !! modes that are not drawn, in words; else empty
      class(scene_t), allocatable :: scene           ! large: it would fill a small stack
      real(wp), allocatable :: at(:, :)              ! shape (equilibria, drives): increments
      integer :: k, m, n, drawn
      real(wp) :: size_

      undrawn = ''
      n = size(motion%equilibria%list)
      allocate (ghosts(n))
      drawn = 0
      if (n > 0) then
         allocate (at(n, size(motion%free)))
         do k = 1, n
            at(k, :) = inputs_at(k, 0.0_wp*motion%equilibria%list(k)%q)
         end do
         allocate (scene)
         call make_one(at, at([1, 1, 1], :), scene)
         if (scene%valid) then
            do k = 1, n
               ghosts(k) = ghost_t(to_text(k), motion%equilibria%list(k)%stable(), scene%prescribed%x(:, k), &
                                   scene%prescribed%y(:, k), scene%prescribed%known(:, k))
            end do
         else
            deallocate (ghosts)
            allocate (ghosts(0))
         end if
         size_ = maxval(scene%high - scene%low)
         drawn = count_modes()
      end if
      call new_modes(min(drawn, most_modes), modes)
      drawn = 0
      do k = 1, n
         associate (one => motion%equilibria%list(k))
            if (one%held_by > 0 .or. .not. one%stable()) cycle
            do m = 1, size(one%squares)
               if (drawn == size(modes)) return
               call make_mode(k, m, modes(drawn + 1)%scene)
               if (modes(drawn + 1)%scene%valid) then
                  drawn = drawn + 1
                  modes(drawn)%equilibrium = k
                  modes(drawn)%mode = m
               else
                  undrawn = undrawn//trim(merge(', ', '  ', len(undrawn) > 0))//' mode '//to_text(m)//' of equilibrium '//to_text(k)
               end if
            end do
         end associate
      end do

   contains

      pure integer function count_modes() result(count_)
         integer :: i

         count_ = 0
         do i = 1, n
            associate (one => motion%equilibria%list(i))
               if (one%held_by == 0 .and. one%stable()) count_ = count_ + size(one%squares)
            end associate
         end do
      end function count_modes

      !> The oscillation in mode m about equilibrium k. Not valid where the linkage does not close about there.
      subroutine make_mode(k, m, scene)
         integer, intent(in) :: k, m
         type(scene_t), intent(inout) :: scene
         real(wp) :: swing, cosine, sine, unit(size(motion%free_drives)), sweep(steps, size(motion%free))
         integer :: i, halvings, most

         associate (one => motion%equilibria%list(k), slides => motion%forces%drive_slides(motion%free_drives))
            unit = merge(size_, 1.0_wp, slides)
            most = maxloc(abs(one%shapes(:, m))/unit, dim=1)
            swing = amplitude*unit(most)/abs(one%shapes(most, m))
            do halvings = 0, most_halvings
               do i = 1, steps
                  call unit_vector(full_turn*real(i - 1, wp)/real(steps, wp), cosine, sine)
                  sweep(i, :) = inputs_at(k, swing*sine*one%shapes(:, m))
               end do
               call make_one(at(k:k, :), sweep, scene)
               if (.not. scene%valid) return
               scene%valid = all(scene%sweep%closed) .and. all(scene%prescribed%closed)
               if (scene%valid) exit
               swing = 0.5_wp*swing
            end do
            if (.not. scene%valid) return
            scene%title = trim(set%title)//': equilibrium '//to_text(k)//', mode '//to_text(m)//', '// &
                          short_number(sqrt(one%squares(m))/(2.0_wp*pi), digits_for_people)//' Hz, drawn with '
            swing = swing*abs(one%shapes(most, m))
            scene%title = scene%title//short_number(swing*merge(1.0_wp, degrees_per_radian, slides(most)), digits_for_people)
            if (.not. slides(most)) scene%title = scene%title//' degrees'
            if (set%has_names()) scene%title = scene%title//' of '//set%sketch%drive_label(motion%free_drives(most))
         end associate
         scene%time = 0.0_wp
         scene%sliding = .false.
         scene%sense = 1.0_wp
         scene%reference = 1
         scene%input_label = 'phase, degrees'
         scene%prescribed%delt = [0.0_wp]
         scene%prescribed%input = [0.0_wp]
         scene%sweep%delt = [(full_turn*real(i - 1, wp)/real(steps, wp), i=1, steps)]
         scene%sweep%input = scene%sweep%delt
         if (allocated(scene%proof)) deallocate (scene%proof)
         call put_ghosts(ghosts, scene)
      end subroutine make_mode

      !> The linkage alone at some inputs, and over a sweep of others; shapes (positions, drives).
      subroutine make_one(inputs, sweep, scene)
         real(wp), intent(in) :: inputs(:, :), sweep(:, :)
         type(scene_t), intent(inout) :: scene
         class(row_study_t), allocatable :: rows     ! large
         type(finding_t) :: none(0)

         allocate (rows)
         call study_inputs(set, prepared%mechanism, prepared%given, prepared%parameters, inputs, sweep, rows)
         if (by_links) then
            call make_chain_scene(set, none, scene, rows=rows)
         else
            call make_scene(set, rows, .true., none, scene)
         end if
      end subroutine make_one

      !> Increments of all drives at equilibrium k, with the free ones moved by `change`, radians or lengths.
      pure function inputs_at(k, change) result(inputs)
         integer, intent(in) :: k
         real(wp), intent(in) :: change(:)            !! shape (free drives)
         real(wp) :: inputs(size(motion%free))
         real(wp), allocatable :: given(:, :)
         integer :: d

         given = increments_of(motion)
         inputs = given(1, :)
         do d = 1, size(change)
            inputs(motion%free_drives(d)) = (motion%equilibria%list(k)%q(d) + change(d))* &
               merge(1.0_wp, degrees_per_radian, motion%forces%drive_slides(motion%free_drives(d)))
         end do
         do d = 2, size(inputs)
            if (prepared%mechanism%actuators(d)%geared) inputs(d) = &
               set%sketch%drives(d)%ratio*(motion%zero_input + inputs(1)) + set%sketch%drives(d)%phase
         end do
      end function inputs_at
   end subroutine make_mode_scenes

   !> As many, empty. It stands by itself because the initial values of a scene pass over the stack.
   subroutine new_modes(n, modes)
      integer, intent(in) :: n
      type(mode_scene_t), allocatable, intent(out) :: modes(:)

      allocate (modes(n))
   end subroutine new_modes

   !> Let a scene of the same linkage show equilibria; they belong into the view, if that does not make the linkage too small.
   subroutine put_ghosts(ghosts, scene)
      type(ghost_t), intent(in) :: ghosts(:)
      type(scene_t), intent(inout) :: scene
      real(wp) :: low(2), high(2), border
      integer :: k, j

      if (.not. scene%valid .or. size(ghosts) == 0) return
      if (size(ghosts(1)%x) /= size(scene%joints)) return
      scene%ghosts = ghosts
      low = scene%low
      high = scene%high
      border = ghost_room*maxval(high - low)
      do k = 1, size(ghosts)
         do j = 1, size(ghosts(k)%x)
            if (.not. ghosts(k)%known(j)) cycle
            scene%low = min(scene%low, max([ghosts(k)%x(j), ghosts(k)%y(j)], low - border))
            scene%high = max(scene%high, min([ghosts(k)%x(j), ghosts(k)%y(j)], high + border))
         end do
      end do
   end subroutine put_ghosts
end module psalm_mode_scene
