!> Paths of six-bars in extended precision: for those that are lost in double.
module psalm_six_bar_paths_extended
   use psalm_kinds, only: wp
   use psalm_six_bar_problem, only: most_six_bar_points, most_unknowns, six_bar_data_t, six_bar_problem_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: follow, polish, turns_at

   !> A kind of at least 18 digits: that of x87 where there is one.
   integer, parameter :: cp = merge(wp, selected_real_kind(18), precision(1.0_wp) >= 18)
   integer, parameter :: lanes = 8                   !! paths side by side

   include 'six_bar_paths.inc'
   include 'lane_elimination.inc'
end module psalm_six_bar_paths_extended
