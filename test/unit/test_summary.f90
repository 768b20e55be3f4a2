!> The summary of a linkage: kinds of four-bars, where it closes, ranges against closed forms, words.
program test_summary
   use cases, only: load_case
   use check, only: checks_t
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp
   use psalm_margins, only: inspector_t, prepare_inspector
   use psalm_ranking, only: ranked_t, rate_linkage, unbeaten
   use psalm_search, only: found_t
   use psalm_summary, only: kind_change_point, kind_crank_rocker, kind_double_crank, kind_double_rocker, kind_of_four_bar, &
                            kind_rocker_crank, kind_slider_swinging, kind_slider_turning, kind_triple_rocker, summarise, summary_t
   use psalm_summary_text, only: plain_number, write_summary
   use psalm_text, only: text_t
   implicit none (type, external)
   real(wp), parameter :: degrees_per_radian = 57.29577951308232088_wp
   type(checks_t) :: t

   call kinds()
   call slider_crank()
   call crank_rocker()
   call double_rocker()
   call two_slides()
   call part_of_turn()
   call numbers()
   call ranking()
   call t%report()

contains

   !> What the ranking tells of a slider-crank: crank 40, rod 140, offset 10. And which of several linkages are unbeaten.
   subroutine ranking()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(ranked_t) :: ranked
      type(found_t) :: found
      type(inspector_t), allocatable :: inspector
      real(wp), parameter :: degree = 1.0_wp/degrees_per_radian

      allocate (problem, set)
      call load_case('dyad4_slider_crank', problem, set)
      found%values = problem%parameters%first_values(problem%given)
      found%delt = problem%delt
      allocate (inspector)
      call prepare_inspector(set, problem, .true., inspector)
      call rate_linkage(set, problem, inspector, found, ranked)
      call t%is_true(ranked%turns .and. .not. ranked%compared .and. .not. ranked%has_band, 'ranking: what is known')
      call t%close_to(ranked%ratio, 14.0_wp, 1.0e-12_wp, 'ranking: rod to offset')
      call t%close_to(ranked%height, 80.0_wp, 1.0e-10_wp, 'ranking: the crank circle is the highest')
      ! the outer dead point lies within half a degree of a step
      call t%close_to(ranked%width, 40.0_wp + sqrt(180.0_wp**2 - 10.0_wp**2), 40.0_wp*(0.5_wp*degree)**2, &
                      'ranking: from the crank circle to the outer dead point')
      call t%close_to(ranked%angle, degrees_per_radian*acos(50.0_wp/140.0_wp), 1.0e-6_wp, 'ranking: least transmission angle')
      associate (figure => [3.0_wp, 5.0_wp, 2.0_wp, 2.0_wp, 1.0_wp, 4.0_wp])
         call t%is_true(same_list(unbeaten(figure, 9), [1, 3, 5]), 'unbeaten: each is better than all before')
         call t%is_true(same_list(unbeaten(figure, 2), [1, 5]), 'unbeaten: both ends of the list stay')
         call t%is_true(same_list(unbeaten(figure, 1), [1]), 'unbeaten: the best objective of all')
      end associate
   end subroutine ranking

   pure logical function same_list(a, b)
      integer, intent(in) :: a(:), b(:)

      same_list = size(a) == size(b)
      if (same_list) same_list = all(a == b)
   end function same_list

   !> Each class of Grashof, with the shortest link at each place; a change point by exact sums.
   subroutine kinds()
      call t%equal_integer(kind_of_four_bar(1.0_wp, 3.0_wp, 2.5_wp, 3.0_wp, .false.), kind_crank_rocker, 'shortest crank')
      call t%equal_integer(kind_of_four_bar(3.0_wp, 1.0_wp, 2.5_wp, 3.0_wp, .false.), kind_double_rocker, 'shortest coupler')
      call t%equal_integer(kind_of_four_bar(3.0_wp, 2.5_wp, 1.0_wp, 3.0_wp, .false.), kind_rocker_crank, 'shortest follower')
      call t%equal_integer(kind_of_four_bar(3.0_wp, 2.5_wp, 3.0_wp, 1.0_wp, .false.), kind_double_crank, 'shortest frame')
      call t%equal_integer(kind_of_four_bar(1.0_wp, 2.0_wp, 2.0_wp, 3.5_wp, .false.), kind_triple_rocker, 'not of Grashof')
      call t%equal_integer(kind_of_four_bar(1.0_wp, 2.0_wp, 2.0_wp, 3.0_wp, .false.), kind_change_point, 'sums are equal')
      call t%equal_integer(kind_of_four_bar(1.1_wp, 2.2_wp, 2.2_wp, 3.3_wp, .false.), kind_change_point, 'equal but for rounding')
      call t%equal_integer(kind_of_four_bar(1.0_wp, 2.0_wp, 2.0_wp, 3.0_wp - 1.0e-9_wp, .false.), &
                           kind_crank_rocker, 'just of Grashof')
      call t%equal_integer(kind_of_four_bar(1.0_wp, 2.0_wp, 2.0_wp, 3.0_wp + 1.0e-9_wp, .false.), kind_triple_rocker, 'just not')
      call t%equal_integer(kind_of_four_bar(1.0_wp, 2.0_wp, 2.0_wp, 3.0_wp, .true.), kind_change_point, 'exactly equal')
      call t%equal_integer(kind_of_four_bar(1.0_wp, 2.0_wp, 2.0_wp, nearest(3.0_wp, -1.0_wp), .true.), kind_crank_rocker, &
                           'the next number below')
      call t%equal_integer(kind_of_four_bar(1.0_wp, 2.0_wp, 2.0_wp, nearest(3.0_wp, 1.0_wp), .true.), kind_triple_rocker, &
                           'the next number above')
      call t%equal_integer(kind_of_four_bar(2.0_wp, 2.0_wp, 2.0_wp, 2.0_wp, .true.), kind_change_point, 'a rhombus')
   end subroutine kinds

   subroutine sum_up(set, problem, summary)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(inout) :: problem
      type(summary_t), intent(out) :: summary
      type(motion_t) :: motion

      call problem%analyse(problem%given, motion)
      call summarise(set, problem, problem%given, motion, summary)
   end subroutine sum_up

   !> Crank 40, rod 140, offset 10: stroke and least angle in closed form.
   subroutine slider_crank()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(summary_t) :: summary

      allocate (problem, set)
      call load_case('dyad4_slider_crank', problem, set)
      call sum_up(set, problem, summary)
      call t%is_true(summary%everywhere, 'slider-crank: full turn')
      call t%equal_integer(summary%kinds(1)%kind, kind_slider_turning, 'slider-crank: crank and offset are within the rod')
      call t%close_to(summary%output%high, sqrt(180.0_wp**2 - 10.0_wp**2), 1.0e-10_wp, 'slider-crank: outer dead point')
      call t%close_to(summary%output%low, sqrt(100.0_wp**2 - 10.0_wp**2), 1.0e-10_wp, 'slider-crank: inner dead point')
      call t%close_to(summary%angle, acos(50.0_wp/140.0_wp)*degrees_per_radian, 1.0e-10_wp, 'slider-crank: transmission angle')
      call t%close_to(summary%angle_input, 270.0_wp, 1.0e-5_wp, 'slider-crank: where it is least')
      call t%equal_integer(size(summary%reverses), 2, 'slider-crank: two dead points')
      call t%close_to(minval(summary%reverses), asin(10.0_wp/180.0_wp)*degrees_per_radian, 1.0e-5_wp, &
                      'slider-crank: crank and rod in line')
      call problem%bind(problem%given)
      problem%given%arcl(2) = 49.0_wp
      call sum_up(set, problem, summary)
      call t%equal_integer(summary%kinds(1)%kind, kind_slider_swinging, 'slider-crank: the rod is too short')
      call t%is_true(.not. summary%everywhere .and. size(summary%closing) == 1, 'slider-crank: part of a turn')
      call t%close_to(summary%closing(1)%high, 180.0_wp + asin(39.0_wp/40.0_wp)*degrees_per_radian, 1.0e-8_wp, &
                      'slider-crank: upper end')
      call t%close_to(summary%closing(1)%low, 360.0_wp - asin(39.0_wp/40.0_wp)*degrees_per_radian, 1.0e-8_wp, &
                      'slider-crank: lower end')
      call t%close_to(summary%angle, 0.0_wp, 1.0e-4_wp, 'slider-crank: no angle is left at its ends')
   end subroutine slider_crank

   !> Links 40, 120, 80, frame 130: extremes of the rocker by the law of cosines.
   subroutine crank_rocker()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(summary_t) :: summary
      real(wp) :: swing

      allocate (problem, set)
      call load_case('dyad1_crank_rocker', problem, set)
      call sum_up(set, problem, summary)
      swing = (angle_at(80.0_wp, 130.0_wp, 160.0_wp) - angle_at(80.0_wp, 130.0_wp, 80.0_wp))*degrees_per_radian
      call t%is_true(summary%everywhere .and. .not. summary%turns, 'crank-rocker: full turn of the crank, not of the rocker')
      call t%close_to(summary%output%high - summary%output%low, swing, 1.0e-10_wp, 'crank-rocker: swing')
      call t%close_to(summary%angle, min(angle_at(120.0_wp, 80.0_wp, 90.0_wp)*degrees_per_radian, &
                                         180.0_wp - angle_at(120.0_wp, 80.0_wp, 170.0_wp)*degrees_per_radian), 1.0e-10_wp, &
                      'crank-rocker: transmission angle')
      call t%equal_integer(summary%kinds(1)%kind, kind_crank_rocker, 'crank-rocker: kind')
      ! the frame the shortest: the output turns
      problem%given%arcl(1:4) = [130.0_wp, 120.0_wp, 90.0_wp, 40.0_wp]
      call sum_up(set, problem, summary)
      call t%equal_integer(summary%kinds(1)%kind, kind_double_crank, 'double-crank: kind')
      call t%is_true(summary%everywhere .and. summary%turns .and. size(summary%reverses) == 0, 'double-crank: the output turns')
   end subroutine crank_rocker

   !> Angle opposite to side c of a triangle, radians.
   pure real(wp) function angle_at(a, b, c)
      real(wp), intent(in) :: a, b, c

      angle_at = acos((a*a + b*b - c*c)/(2.0_wp*a*b))
   end function angle_at

   !> Links that do not go round: two ranges, their ends by the law of cosines.
   subroutine double_rocker()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(summary_t) :: summary
      type(text_t) :: text
      real(wp) :: low, high

      allocate (problem, set)
      call load_case('dyad1_crank_rocker', problem, set)
      problem%given%arcl(1:4) = [120.0_wp, 40.0_wp, 80.0_wp, 130.0_wp]
      call sum_up(set, problem, summary)
      low = angle_at(120.0_wp, 130.0_wp, 40.0_wp)*degrees_per_radian
      high = angle_at(120.0_wp, 130.0_wp, 120.0_wp)*degrees_per_radian
      call t%equal_integer(size(summary%closing), 2, 'double-rocker: two ranges')
      call t%close_to(summary%closing(1)%low, low, 1.0e-8_wp, 'double-rocker: first end')
      call t%close_to(summary%closing(1)%high, high, 1.0e-8_wp, 'double-rocker: second end')
      call t%close_to(summary%closing(2)%low, 360.0_wp - high, 1.0e-8_wp, 'double-rocker: third end')
      call t%close_to(summary%closing(2)%high, 360.0_wp - low, 1.0e-8_wp, 'double-rocker: fourth end')
      call write_summary('TITLE', problem%mechanism, summary, text)
      call t%is_true(index(text%content(), 'Closes              from input 17.') > 0, 'double-rocker: words', text%content())
      ! a gap of a hundredth of a degree between the steps is seen
      problem%given%arcl(1:4) = [40.0_wp, 120.0_wp, 80.0_wp, 160.0_wp + 1.0e-7_wp]
      problem%given%crnki = 0.25_wp
      call sum_up(set, problem, summary)
      call t%is_true(.not. summary%everywhere, 'a narrow gap')
   end subroutine double_rocker

   !> Two slides that become parallel.
   subroutine two_slides()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(summary_t) :: summary

      allocate (problem, set)
      call load_case('dyad8_tangent_mechanism', problem, set)
      call sum_up(set, problem, summary)
      call t%is_true(.not. summary%everywhere .and. summary%partial, 'parallel slides end the range')
      call t%close_to(summary%closing(1)%high, 180.0_wp, 1.0e-8_wp, 'parallel slides: where')
   end subroutine two_slides

   !> A linkage that does not go round: prescribed inputs over less than 300 degrees are reported alone.
   subroutine part_of_turn()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(summary_t) :: summary
      real(wp), parameter :: span(2) = [299.9_wp, 300.1_wp]
      integer :: i

      allocate (problem, set)
      do i = 1, size(span)
         call load_case('dyad4_slider_crank', problem, set)
         ! open from 257 to 283 degrees
         problem%given%arcl(2) = 49.0_wp
         call problem%set_inputs([-65.0_wp, 0.0_wp, span(i) - 65.0_wp])
         call sum_up(set, problem, summary)
         call t%is_true(.not. summary%everywhere, 'prescribed inputs: the linkage does not go round')
         call t%is_true(summary%partial .eqv. i == 1, 'prescribed inputs over more than 300 degrees mean a turn')
      end do
   end subroutine part_of_turn

   subroutine numbers()
      call t%equal_text(plain_number(0.0_wp), '0', 'zero')
      call t%equal_text(plain_number(179.72200_wp), '179.72', 'five digits')
      call t%equal_text(plain_number(-40.0_wp), '-40', 'no zeros behind')
      call t%equal_text(plain_number(123456.7_wp), '123457', 'more digits before the point')
      call t%equal_text(plain_number(100000.0_wp), '100000', 'zeros before the point stay')
      call t%equal_text(plain_number(0.25_wp), '0.25', 'a fraction')
      call t%equal_text(plain_number(1.5e-7_wp), '1.5000E-07', 'a small number')
      call t%equal_text(plain_number(-2.5e123_wp), '-2.5000E+123', 'a large number')
   end subroutine numbers
end program test_summary
