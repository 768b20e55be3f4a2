!> The next sensible step after a run of psalm, in one line for standard error; empty where there is none.
module psalm_next_step
   use psalm_data_set, only: data_set_t
   use psalm_dyad_kind, only: assur_rrr
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp
   use psalm_output_kind, only: motion_point, motion_angle
   use psalm_parameters, only: words_of
   use psalm_search, only: result_t
   use psalm_summary, only: summary_t
   use psalm_summary_text, only: plain_number
   implicit none (type, external)
   private
   public :: step_after_search, step_after_analysis

   real(wp), parameter :: at_bound = 1.0e-6_wp   !! relative distance from a bound that is reached
   integer, parameter :: most_exact = 9          !! points of a path that a four-bar meets exactly
   integer, parameter :: fewest_timed = 3        !! points from which on free timing may gain something
   integer, parameter :: fewest_exact = 3        !! values of a function that a four-bar meets exactly

contains

   !> After a search from many starts.
   function step_after_search(set, problem, found) result(words)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(result_t), intent(in) :: found
      character(:), allocatable :: words
      character(:), allocatable :: bound

      words = ''
      if (size(found%best) == 0) return
      bound = ''
      if (set%limits%limval == 1) bound = given_bound(problem, found)
      if (len(bound) > 0) then
         words = 'the best linkage is at a bound: '//bound//'; widen it with '// &
                 trim(merge('VLOW and VHIGH  ', 'OPLOW and OPHIGH', set%has_names()))//' and search again'
      else if (is_path(set) .and. set%method%ifree == 0 .and. set%method%ndes >= fewest_timed .and. &
               found%best(1)%objective > 0.0_wp) then
         words = 'if the points need only be passed, IFREE=1 leaves their timing free and comes nearer'
      else if (is_path(set) .and. set%method%ifree /= 0 .and. set%method%ndes <= most_exact) then
         words = "&EXACT KIND='PATH' finds every four-bar that meets up to nine points exactly"
      else if (is_function(set, problem) .and. found%best(1)%objective > 0.0_wp) then
         words = "&EXACT KIND='FUNCTION' finds every four-bar that meets three or five of the values, with MINIMAX=1 "// &
                 'those with the least largest error'
      else if (.not. set%toler%given) then
         words = '&TOLER with TOLLEN shows how exactly the parts must be made'
      end if
   end function step_after_search

   !> After an analysis: limits that are not kept, desired values that nothing brings nearer.
   function step_after_analysis(set, summary) result(words)
      type(data_set_t), intent(in) :: set
      type(summary_t), intent(in) :: summary
      character(:), allocatable :: words
      character(:), allocatable :: by

      words = ''
      by = trim(merge('VARY and &SEARCH     ', 'IVA, IVG and &SEARCH ', set%has_names()))
      if (summary%angle_loop > 0 .and. summary%angle < summary%least_asked) then
         words = by//' find dimensions that keep TRMIN'
      else if (summary%compared > 0 .and. summary%rms > 0.0_wp .and. summary%everywhere) then
         words = by//' find dimensions that come nearer to the desired values'
      end if
   end function step_after_analysis

   !> A path of points without other targets.
   pure logical function is_path(set)
      type(data_set_t), intent(in) :: set

      is_path = set%motion() == motion_point
   end function is_path

   !> Angles of a four-bar over the angle of its crank, without other targets.
   pure logical function is_function(set, problem)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem

      is_function = set%motion() == motion_angle .and. set%method%desired .and. set%method%ndes >= fewest_exact .and. &
                    problem%mechanism%nloop == 1 .and. .not. problem%mechanism%sliding_input
      if (is_function) is_function = problem%mechanism%groups(1)%kind == assur_rrr
   end function is_function

   !> The first variable of the best linkage at a bound that the data set gives, in words; empty: there is none.
   function given_bound(problem, found) result(words)
      type(problem_t), intent(in) :: problem
      type(result_t), intent(in) :: found
      character(:), allocatable :: words
      real(wp) :: slack
      integer :: v

      words = ''
      do v = 1, size(found%by_default)
         if (found%by_default(v)) cycle
         associate (value => found%best(1)%values(v), low => found%low(v), high => found%high(v))
            if (high <= low) cycle
            slack = at_bound*max(abs(low), abs(high))
            if (value > low + slack .and. value < high - slack) cycle
            words = words_of(problem%parameters%variables(v))//', '//plain_number(value)
            return
         end associate
      end do
   end function given_bound
end module psalm_next_step
