!> Rates in the listing and on device 8.
module psalm_rate_list
   use psalm_columns, only: left_column
   use psalm_data_set, only: data_set_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: problem_t
   use psalm_finale, only: open_words
   use psalm_group_words, only: arc_heading, group_heading, group_words
   use psalm_input_text, only: input_heading, input_text, list_sketch_notes
   use psalm_kinds, only: wp
   use psalm_number_format, only: number_format_t, format_of, figure, in_sentence
   use psalm_output_kind, only: motion_point, motion_pose
   use psalm_rate_study, only: rate_study_t, arc_rates_t, output_at_origin
   use psalm_text, only: text_t, to_text
   use psalm_mechanism, only: mechanism_t
   implicit none (type, external)
   private
   public :: list_rates, list_all_rates, dead_point_words

   real(wp), parameter :: least_ratio = sqrt(tiny(1.0_wp))   !! of velocities: at a smaller one the force is infinite

contains

   !> KTHETA: every arc and every joint at every position.
   subroutine list_all_rates(problem, rates, text)
      type(problem_t), intent(in) :: problem
      type(rate_study_t), intent(in) :: rates
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: k

      call text%add()
      call text%add(' ALL '//trim(merge('LINES', 'ARCS ', problem%mechanism%has_joint_names()))// &
                    ': LENGTH AND ANGLE, THEIR FIRST AND SECOND DERIVATIVES BY TIME (RADIANS)')
      do k = 1, size(rates%dead)
         call text%add()
         call text%add(' INPUT'//in_sentence(problem%mechanism%has_joint_names(), rates%motion%input(k)))
         if (.not. rates%motion%closed(k) .or. rates%dead(k) /= 0) then
            line = ' DEAD POINT'
            if (.not. rates%motion%closed(k)) line = open_words(rates%motion, k)
            call text%add(' '//trim(adjustl(line)))
         else
            call list_position(problem%mechanism, rates%arcs, k, text)
         end if
      end do
   end subroutine list_all_rates

   subroutine list_position(mechanism, arcs, k, text)
      type(mechanism_t), intent(in) :: mechanism
      type(arc_rates_t), intent(in) :: arcs
      integer, intent(in) :: k
      type(text_t), intent(inout) :: text
      character(:), allocatable :: name
      integer, parameter :: name_columns = 20
      type(number_format_t) :: of_length(3), of_angle(3), of_joint(0:2) ! by order; x and y alike
      logical :: named
      integer :: loop, a, n, joint

      named = mechanism%has_joint_names()
      do a = 1, 3
         of_length(a) = format_of(named, arcs%length(a, :, k))
         of_angle(a) = format_of(named, arcs%angle(a, :, k))
         of_joint(a - 1) = format_of(named, [arcs%x(a - 1, :, k), arcs%y(a - 1, :, k)])
      end do
      name = '  LOOP  ARC'
      if (named) name = '  LINE'//repeat(' ', name_columns - len('  LINE'))
      call text%add(name//'         LENGTH       VELOCITY   ACCELERATION          ANGLE       VELOCITY   ACCELERATION')
      do loop = 1, mechanism%nloop
         do a = 1, mechanism%loops(loop)%arcs
            n = mechanism%seq(loop, a)
            if (named) then
               if (mechanism%arcs(n)%representative /= n) cycle   ! reported before
               name = left_column('  '//arc_heading(mechanism, loop, a, small=.false.), name_columns)
            else
               name = repeat(' ', 6 - len(to_text(loop)))//to_text(loop)//repeat(' ', 5 - len(to_text(a)))//to_text(a)
            end if
            call text%add(name//three(arcs%length(:, n, k), of_length)//three(arcs%angle(:, n, k), of_angle))
         end do
      end do
      name = '  JOINT AT THE END OF ARC'
      if (named) name = '  JOINT'//repeat(' ', len(name) - len('  JOINT'))
      call text%add(name//'     X              Y            VX             VY             AX             AY')
      do joint = 1, size(arcs%joint_arc)
         associate (arc => mechanism%arcs(arcs%joint_arc(joint)))
            name = ' LOOP '//to_text(arc%loop)//' ARC '//to_text(arc%place)
            if (named) name = '  '//trim(mechanism%ends(arcs%joint_end(joint), arcs%joint_arc(joint)))
         end associate
         name = left_column(name, name_columns)
         do a = 0, 2
            name = name//figure(arcs%x(a, joint, k), of_joint(a))//figure(arcs%y(a, joint, k), of_joint(a))
         end do
         call text%add(name)
      end do
   end subroutine list_position

   pure function three(values, formats) result(columns)
      real(wp), intent(in) :: values(3)
      type(number_format_t), intent(in) :: formats(3)
      character(:), allocatable :: columns

      columns = figure(values(1), formats(1))//figure(values(2), formats(2))//figure(values(3), formats(3))
   end function three

   !> The listing: displacement, velocity, acceleration by time, velocity ratio and mechanical advantage.
   subroutine list_rates(set, problem, rates, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(rate_study_t), intent(in) :: rates
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line, name
      type(number_format_t) :: of_input, of_speed, of_ratio, of_advantage
      type(number_format_t) :: of_actual(size(rates%motion%actual, 2)), of_rates(3, size(rates%motion%actual, 2))
      logical, dimension(size(rates%dead)) :: live, finite
      integer :: k, c, order

      call text%add(' '//set%title)
      call text%add()
      call list_sketch_notes(set, text)
      line = trim(merge('LENGTH/S', 'RAD/S   ', problem%mechanism%sliding_input))
      name = ''
      if (.not. set%rates%given) then
         name = ' (NOT GIVEN: 1, CONSTANT)'
      else if (abs(set%rates%accel) <= 0.0_wp) then
         name = ' (CONSTANT)'
      end if
      call text%add(' SPEED OF THE INPUT'//in_sentence(set%has_names(), set%rates%speed)//' '//line//name)
      if (abs(set%rates%accel) > 0.0_wp) call text%add(' ACCELERATION OF THE INPUT'// &
                                                         in_sentence(set%has_names(), set%rates%accel)//' '//line//'**2')
      if (abs(set%rates%accel) > 0.0_wp) call text%add(' THE SPEED IS THE SAME AT EVERY POSITION, THE ACCELERATION TOO')
      if (problem%output%kind%angle > 0 .or. problem%mechanism%outputs(1)%stands_in) &
         call text%add(' ANGLES IN DEGREES, THEIR RATES IN RADIANS')
      if (problem%mechanism%outputs(1)%stands_in) return
      call text%add()
      line = input_heading(problem%mechanism)
      if (problem%motion == motion_point) then
         line = line//'              X              Y             VX             VY             AX             AY          SPEED'
      else if (problem%motion == motion_pose) then
         line = line//'              X              Y          ANGLE             VX             VY        ANG.VEL.'// &
                '             AX             AY        ANG.ACC.          SPEED'
      else
         line = line//'         OUTPUT       VELOCITY   ACCELERATION           JERK VELOCITY RATIO MECH.ADVANTAGE'
      end if
      call text%add(line)
      live = rates%motion%closed .and. rates%dead == 0
      associate (named => problem%mechanism%has_joint_names(), by_time => rates%by_time)
         of_input = format_of(named, rates%motion%input)
         do c = 1, size(of_actual)
            of_actual(c) = format_of(named, rates%motion%actual(:, c), rates%motion%closed, problem%given%arcl)
            do order = 1, 3
               of_rates(order, c) = format_of(named, by_time(order, c, :), live, &
                                              pack(by_time(order, :, :), spread(live, 1, size(of_actual))))
            end do
         end do
         if (size(of_actual) > 1) of_speed = format_of(named, hypotenuse(by_time(1, 1, :), by_time(1, 2, :)), live)
         if (size(of_actual) == 1) then
            of_ratio = format_of(named, rates%by_input(1, 1, :), live)
            finite = live .and. abs(rates%by_input(1, 1, :)) > least_ratio
            of_advantage = format_of(named, 1.0_wp/merge(rates%by_input(1, 1, :), 1.0_wp, finite), finite)
         end if
      end associate
      do k = 1, size(rates%motion%input)
         line = input_text(problem%mechanism, rates%motion%input(k), of_input)
         if (.not. rates%motion%closed(k)) then
            line = line//open_words(rates%motion, k)
         else if (rates%dead(k) /= 0) then
            do c = 1, size(rates%motion%actual, 2)
               line = line//figure(rates%motion%actual(k, c), of_actual(c))
            end do
            line = line//'   '//dead_words(problem%mechanism, rates%dead(k))
         else if (size(rates%motion%actual, 2) > 1) then
            do c = 1, size(rates%motion%actual, 2)
               line = line//figure(rates%motion%actual(k, c), of_actual(c))
            end do
            do order = 1, 2
               do c = 1, size(rates%motion%actual, 2)
                  line = line//figure(rates%by_time(order, c, k), of_rates(order, c))
               end do
            end do
            line = line//figure(hypotenuse(rates%by_time(1, 1, k), rates%by_time(1, 2, k)), of_speed)
         else
            line = line//figure(rates%motion%actual(k, 1), of_actual(1))//three(rates%by_time(1:3, 1, k), of_rates(:, 1))// &
                   figure(rates%by_input(1, 1, k), of_ratio)
            if (abs(rates%by_input(1, 1, k)) > least_ratio) then
               line = line//figure(1.0_wp/rates%by_input(1, 1, k), of_advantage)
            else
               line = line//'       INFINITE'
            end if
         end if
         call text%add(line)
      end do
   end subroutine list_rates

   !> Why a position has no rates, for a remark.
   pure function dead_point_words(mechanism, dead) result(words)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: dead                 !! as `rate_study_t` has it
      character(:), allocatable :: words

      if (dead == output_at_origin) then
         words = 'output at the origin: rates are not defined'
      else
         words = 'dead point of '//group_words(mechanism, dead)//': rates are infinite'
      end if
   end function dead_point_words

   !> The same for the listing.
   pure function dead_words(mechanism, dead) result(words)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: dead
      character(:), allocatable :: words

      if (dead == output_at_origin) then
         words = 'OUTPUT AT THE ORIGIN: RATES ARE NOT DEFINED'
      else
         words = 'DEAD POINT OF '//group_heading(mechanism, dead, .false.)//': RATES ARE INFINITE'
      end if
   end function dead_words
end module psalm_rate_list
