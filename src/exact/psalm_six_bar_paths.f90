!> Paths of six-bars (psalm_six_bar_problem) in working precision.
module psalm_six_bar_paths
   use psalm_kinds, only: wp
   use psalm_six_bar_problem, only: most_six_bar_points, most_unknowns, six_bar_data_t, six_bar_problem_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: follow, polish, turns_at

   integer, parameter :: cp = wp
   integer, parameter :: lanes = 8                   !! paths side by side

   include 'six_bar_paths.inc'
   include 'lane_elimination.inc'
end module psalm_six_bar_paths
