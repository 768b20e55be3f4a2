!> Paths of six-bars in quadruple precision: for the few that extended precision does not bring to their end.
module psalm_six_bar_paths_quad
   use psalm_kinds, only: wp
   use psalm_quad, only: qp, sqrt
   use psalm_six_bar_problem, only: most_six_bar_points, most_unknowns, six_bar_data_t, six_bar_problem_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: follow, polish, turns_at

   integer, parameter :: cp = qp
   integer, parameter :: lanes = 1                   !! there are no vectors of this kind

   include 'six_bar_paths.inc'
   include 'lane_elimination.inc'
end module psalm_six_bar_paths_quad
