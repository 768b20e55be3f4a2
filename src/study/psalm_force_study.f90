!> Forces of drive, frame and joints over the positions of a case, and what a designer sizes bearings and drive by.
!>
!> Data in, results out. Source: Oldham (1977), 15.1; Haines (about 1982), chapter 9.
module psalm_force_study
   use psalm_angles, only: degrees_of, nearest_difference, unit_vector
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t, motion_t
   use psalm_force_analysis, only: force_table_t, analyse_forces, share_of_sources, loads_of_unit_masses, tilting_moments, &
                                   column_of_joint, column_of_other_drive, column_drive, column_fx, column_fy, column_moment
   use psalm_force_model, only: force_model_t, make_force_model, vertices_of
   use psalm_kinds, only: wp, full_turn
   use psalm_kinetostatics, only: source_inertia, source_weight
   use psalm_link_wrenches, only: link_loads_t, find_link_loads
   use psalm_mechanism, only: mechanism_t, joint_prismatic
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t, is_to_end
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: force_study_t, find_forces, size_up, take_motors_off

   integer, parameter :: name_width = 40
   real(wp), parameter :: nothing = 64.0_wp*epsilon(1.0_wp) !! part of the largest value: a mean or harmonic below it is rounding
   real(wp), parameter :: even = 1.0e-9_wp     !! degrees; positions so near an even step divide the turn evenly

   !> What a quantity does over all positions at which it is known.
   type :: sizing_t
      character(name_width) :: name = ''
      real(wp) :: peak = 0.0_wp                !! the value of the largest amount, with its sign
      real(wp) :: at = 0.0_wp                  !! input there, or time
      real(wp) :: rms = 0.0_wp, mean = 0.0_wp
      real(wp) :: largest = 0.0_wp             !! amount of it, or of that of which it is a component
   end type sizing_t

   !> Harmonics of a quantity over a turn: sum of amplitude(k) cos(k input - phase(k)).
   type :: harmonic_t
      character(name_width) :: name = ''
      real(wp), allocatable :: amplitude(:), phase(:) !! shape (0:harmonics); degrees
   end type harmonic_t

   !> A joint, or another pair of links, as listings call it.
   type :: force_joint_t
      character(:), allocatable :: name
      logical :: slides = .false.              !! a force across and a couple; else a force, x and y
   end type force_joint_t

   !> The columns of the table are drive, force and moment on the frame, two for each joint, then drives after the first.
   type :: force_study_t
      type(force_model_t) :: model             !! not of a sketch that has no loops
      type(mechanism_t) :: mechanism           !! likewise
      type(force_joint_t), allocatable :: joints(:)
      character(name_width), allocatable :: drives(:) !! names, if there are several
      logical, allocatable :: drive_slides(:)  !! shape (drives): the drive is a force
      type(force_table_t) :: table
      real(wp), allocatable :: input(:)        !! shape (positions): degrees in a turn, or length
      real(wp), allocatable :: about(:)        !! shape (positions): frame moment about MOMX, MOMY
      real(wp), allocatable :: tilt(:, :)      !! shape (positions, 2): frame moments out of the plane, about x and y; not
                                               !! allocated: masses have no heights
      real(wp), allocatable :: drive_power(:)  !! shape (positions): of all drives, W; of a motion in time empty
      logical :: rubs = .false.                !! there is friction
      type(sizing_t), allocatable :: sizing(:)
      type(harmonic_t), allocatable :: harmonics(:)   !! empty where the positions do not divide a turn evenly
      real(wp), allocatable :: shares(:, :, :) !! shape (positions, columns, sources): ISHARE
      character(name_width), allocatable :: sources(:) !! their names
      type(link_loads_t), allocatable :: loads !! ILOADS: what acts on each link
   contains
      procedure :: all_known
   end type force_study_t

contains

   !> True if the forces are known at every position.
   pure logical function all_known(self)
      class(force_study_t), intent(in) :: self
      integer :: k

      all_known = all([(self%table%known(k), k=1, size(self%input))])
   end function all_known

   !> Forces of a case that the preparation found no fault with. All loops are solved, whatever the given problem solves. What the
   !> host ends is of no use.
   subroutine find_forces(set, given, dimensions, study, by_unit_mass, analysed, stop)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: given
      type(dimensions_t), intent(in) :: dimensions
      type(force_study_t), intent(out) :: study
      real(wp), allocatable, intent(inout), optional :: by_unit_mass(:, :, :, :) !! see `loads_of_unit_masses`
      type(motion_t), intent(in), optional :: analysed !! what `given` does, if that is known
      type(stop_t), intent(in), optional :: stop       !! asked before each block of positions
      class(problem_t), allocatable :: problem      ! large: it would fill a small stack
      type(motion_t) :: motion
      logical :: every_loop
      type(diagnostics_t) :: unused
      real(wp) :: rate
      integer :: k, column

      allocate (problem, source=given)
      study%mechanism = given%mechanism
      call make_force_model(set, study%mechanism, dimensions, study%model, unused)
      study%rubs = size(study%model%friction) > 0
      study%drive_slides = study%mechanism%actuators%slides
      allocate (study%joints(size(study%mechanism%joints)), study%drives(size(study%mechanism%actuators)))
      study%drives = ''
      do k = 1, size(set%sketch%drives)
         study%drives(k) = set%sketch%drive_label(k)
      end do
      do k = 1, size(study%joints)
         study%joints(k)%name = study%mechanism%joints(k)%name
         study%joints(k)%slides = study%mechanism%joints(k)%kind == joint_prismatic
      end do
      call problem%want_derivatives(.true., vertices_of(study%mechanism))
      every_loop = .false.
      if (present(analysed)) every_loop = all(given%plan%solved)
      if (every_loop) then
         motion = analysed
         call problem%bind(dimensions)
      else
         call problem%analyse(dimensions, motion, stop=stop)
      end if
      study%input = motion%input
      call analyse_forces(problem, study%model, set%pace(), set%change_of_pace(), motion%closed, motion%input, study%table, &
                          stop)
      if (is_to_end(stop)) return
      if (study%model%tilts) call tilting_moments(problem, study%model, set%pace(), set%change_of_pace(), motion%closed, &
                                                  motion%input, study%tilt)
      if (.not. set%masses%motor_on_frame) call take_motors_off(study%mechanism, study%table%value)
      allocate (study%drive_power(size(study%input)), source=0.0_wp)
      do k = 1, size(study%drives)
         associate (actuator => study%mechanism%actuators(k), v => study%table%value)
            column = column_drive
            if (k > 1) column = column_of_other_drive(size(study%joints), k)
            rate = set%pace()
            rate = rate*actuator%by_first(1)
            if (actuator%slides) rate = rate*set%masses%metre
            study%drive_power = study%drive_power + v(:, column)*rate
         end associate
      end do
      associate (x => set%masses%about(1)*set%masses%metre, y => set%masses%about(2)*set%masses%metre, v => study%table%value)
         study%about = v(:, column_moment) - (x*v(:, column_fy) - y*v(:, column_fx))
      end associate
      if (set%masses%shares /= 0) then
         call share_of_sources(problem, study%model, set%pace(), set%change_of_pace(), motion%input, study%shares)
         call name_sources(size(study%model%loads), study)
      end if
      if (set%masses%link_loads) then
         allocate (study%loads)
         call find_link_loads(set, problem, dimensions, study%model, motion%input, study%loads)
      end if
      if (present(by_unit_mass)) then
         call loads_of_unit_masses(problem, study%model, set%pace(), set%change_of_pace(), by_unit_mass)
      end if
      call size_up(study)
      call find_harmonics_of(study, merge(set%masses%harmonics, 0, size(study%drives) == 1))
   end subroutine find_forces

   !> Moments of the frame where it does not feel the motors: a flywheel elsewhere holds the speed.
   pure subroutine take_motors_off(mechanism, value)
      type(mechanism_t), intent(in) :: mechanism
      real(wp), intent(inout) :: value(:, :)   !! shape (positions, columns), as `force_table_t` has them
      integer :: d, column

      do d = 1, size(mechanism%actuators)
         if (mechanism%actuators(d)%slides .or. mechanism%actuators(d)%joint == 0) cycle
         column = column_drive
         if (d > 1) column = column_of_other_drive(size(mechanism%joints), d)
         value(:, column_moment) = value(:, column_moment) + value(:, column)
      end do
   end subroutine take_motors_off

   !> Names of the sources: inertia, weight, loads, springs.
   subroutine name_sources(loads, study)
      integer, intent(in) :: loads             !! how many
      type(force_study_t), intent(inout) :: study
      integer :: k

      allocate (study%sources(size(study%shares, 3)))
      study%sources(source_inertia) = 'INERTIA'
      study%sources(source_weight) = 'WEIGHT'
      do k = source_weight + 1, size(study%sources)
         study%sources(k) = 'LOAD '//to_text(k - source_weight)
         if (k > source_weight + loads) study%sources(k) = 'SPRING '//to_text(k - source_weight - loads)
      end do
   end subroutine name_sources

   !> Peak, RMS and mean of everything that sizes a part.
   subroutine size_up(study, in_time)
      type(force_study_t), intent(inout) :: study
      logical, intent(in), optional :: in_time          !! `input` has times: means are over the time, by the trapezoidal rule
      logical :: known(size(study%input))
      real(wp) :: frame(size(study%input)), weight(size(study%input))
      real(wp) :: force, moment                         !! largest of a motion in time: what is a rounding of it is 0
      integer :: k, j, c

      known = [(study%table%known(k), k=1, size(known))]
      weight = 1.0_wp
      force = 0.0_wp
      moment = 0.0_wp
      if (present(in_time)) then
         associate (n => size(weight), t => study%input, v => study%table%value)
            if (in_time .and. n > 1) weight = [t(2) - t(1), t(3:) - t(:n - 2), t(n) - t(n - 1)]
            if (in_time) force = maxval(abs(v(:, column_fx:column_fy)))
            if (in_time) moment = maxval(abs(v(:, [column_drive, column_moment])))
         end associate
      end if
      if (allocated(study%sizing)) deallocate (study%sizing)
      allocate (study%sizing(0))
      associate (v => study%table%value, joints => study%joints)
         call add('DRIVE', v(:, column_drive), least=merge(force, moment, study%drive_slides(1)))
         do j = 2, size(study%drives)
            call add('DRIVE '//study%drives(j), v(:, size(v, 2) - size(study%drives) + j), &
                     least=merge(force, moment, study%drive_slides(j)))
         end do
         if (size(study%drive_power) == size(known)) call add('DRIVE POWER', study%drive_power)
         frame = hypotenuse(v(:, column_fx), v(:, column_fy))
         call add('FRAME FORCE', frame)
         call add('FRAME FX', v(:, column_fx), frame)
         call add('FRAME FY', v(:, column_fy), frame)
         call add('FRAME MOMENT', v(:, column_moment))
         if (allocated(study%tilt)) then
            call add('FRAME QX', study%tilt(:, 1))
            call add('FRAME QY', study%tilt(:, 2))
         end if
         do j = 1, size(joints)
            c = column_of_joint(j)
            if (joints(j)%slides) then
               call add(joints(j)%name//' N', v(:, c), least=force)
               call add(joints(j)%name//' M', v(:, c + 1), least=moment)
            else
               call add(joints(j)%name, hypotenuse(v(:, c), v(:, c + 1)))
            end if
         end do
      end associate

   contains

      subroutine add(name, values, whole, least)
         character(*), intent(in) :: name
         real(wp), intent(in) :: values(:)
         real(wp), intent(in), optional :: whole(:) !! of which it is a component
         real(wp), intent(in), optional :: least    !! values that are roundings of this are 0
         type(sizing_t) :: one
         integer :: at

         one%name = name
         if (present(least)) then
            if (least > 0.0_wp .and. all(abs(values) <= nothing*least .or. .not. known)) then
               study%sizing = [study%sizing, one]
               return
            end if
         end if
         if (any(known)) then
            at = maxloc(abs(values), dim=1, mask=known)
            one%peak = values(at)
            one%at = study%input(at)
            one%rms = sqrt(sum(weight*values**2, mask=known)/sum(weight, mask=known))
            one%mean = sum(weight*values, mask=known)/sum(weight, mask=known)
            if (abs(one%mean) <= nothing*abs(one%peak)) one%mean = 0.0_wp
            one%largest = abs(one%peak)
            if (present(whole)) one%largest = maxval(whole, mask=known)
         end if
         study%sizing = [study%sizing, one]
      end subroutine add
   end subroutine size_up

   !> Harmonics of the drive and of the force and moment on the frame up to an order, if the inputs divide a turn evenly.
   subroutine find_harmonics_of(study, highest)
      type(force_study_t), intent(inout) :: study
      integer, intent(in) :: highest
      real(wp) :: step
      integer :: n, k

      n = size(study%input)
      allocate (study%harmonics(0))
      if (study%drive_slides(1) .or. highest == 0 .or. n < 3) return
      if (.not. study%all_known()) return
      step = nearest_difference(study%input(2), study%input(1))
      if (any(abs(nearest_difference(study%input, [(study%input(1) + real(k, wp)*step, k=0, n - 1)])) > even)) return
      if (abs(abs(step)*real(n, wp) - full_turn) > even*real(n, wp)) return
      associate (v => study%table%value)
         deallocate (study%harmonics)
         allocate (study%harmonics(4))
         study%harmonics(1) = harmonics_of('DRIVE', v(:, column_drive), study%input, highest)
         study%harmonics(2) = harmonics_of('FRAME FX', v(:, column_fx), study%input, highest)
         study%harmonics(3) = harmonics_of('FRAME FY', v(:, column_fy), study%input, highest)
         study%harmonics(4) = harmonics_of('FRAME MOMENT', v(:, column_moment), study%input, highest)
      end associate
   end subroutine find_harmonics_of

   !> Harmonics of values at inputs that divide a turn evenly, from order 0, the mean. Orders from half the number of values on
   !> cannot be distinguished from lower ones and are not given.
   pure type(harmonic_t) function harmonics_of(name, values, input, highest) result(one)
      character(*), intent(in) :: name
      real(wp), intent(in) :: values(:), input(:)   !! shape (n); degrees
      integer, intent(in) :: highest
      real(wp) :: cosine, sine, real_part, imaginary_part
      integer :: k, i

      one%name = name
      associate (n => size(values), last => min(highest, (size(values) - 1)/2))
         allocate (one%amplitude(0:last), one%phase(0:last), source=0.0_wp)
         do k = 0, last
            real_part = 0.0_wp
            imaginary_part = 0.0_wp
            do i = 1, n
               call unit_vector(real(k, wp)*input(i), cosine, sine)
               real_part = real_part + values(i)*cosine
               imaginary_part = imaginary_part + values(i)*sine
            end do
            real_part = real_part*merge(1.0_wp, 2.0_wp, k == 0)/real(n, wp)
            imaginary_part = imaginary_part*2.0_wp/real(n, wp)
            if (abs(real_part) <= nothing*maxval(abs(values))) real_part = 0.0_wp
            if (abs(imaginary_part) <= nothing*maxval(abs(values))) imaginary_part = 0.0_wp
            one%amplitude(k) = real_part
            if (k == 0) cycle
            one%amplitude(k) = hypotenuse(real_part, imaginary_part)
            one%phase(k) = degrees_of(real_part, imaginary_part)
         end do
      end associate
   end function harmonics_of
end module psalm_force_study
