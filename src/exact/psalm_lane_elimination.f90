!> Systems of complex equations, several side by side, real and imaginary parts apart: vectors as long as the processor has them.
module psalm_lane_elimination
   use psalm_kinds, only: wp
   use psalm_leg_problem, only: variables
   implicit none (type, external)
   private
   public :: lanes, eliminate

   integer, parameter :: lanes = 8
   integer, parameter :: cp = wp, most_rows = variables !! of lane_elimination.inc

contains

   include 'lane_elimination.inc'
end module psalm_lane_elimination
