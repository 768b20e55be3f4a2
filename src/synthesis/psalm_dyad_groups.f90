!> Which dyad a dimension belongs to, for searches that take a linkage dyad by dyad.
!>
!> A linkage is built up loop by loop, each loop adding one dyad: the dimensions of its own arcs are that dyad's, those of the
!> output arc belong to the dyad it hangs on, place and reference of the input to the first. Source: Kramer and Sandor, as Oldham
!> (1977), section 9.1.4, has it.
module psalm_dyad_groups
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t, variable_aside, variable_aside_angle, variable_length, variable_gama, variable_outlk, &
                               variable_outang
   implicit none (type, external)
   private
   public :: dyads_of_variables

contains

   !> Numbers of the dyads, counted through those that have a dimension that varies. Shape of the result: (nvar).
   pure function dyads_of_variables(mechanism, parameters) result(dyads)
      type(mechanism_t), intent(in) :: mechanism
      type(parameters_t), intent(in) :: parameters
      integer, allocatable :: dyads(:)
      integer :: loops(size(parameters%variables))
      integer :: v, loop, count_so_far

      do v = 1, size(loops)
         select case (parameters%variables(v)%kind)
         case (variable_length, variable_gama, variable_aside, variable_aside_angle)
            loops(v) = parameters%variables(v)%loop
         case (variable_outlk, variable_outang)
            loops(v) = mechanism%arcs(mechanism%outputs(1)%arc)%loop
         case default
            loops(v) = 1
         end select
      end do
      allocate (dyads(size(loops)), source=0)
      count_so_far = 0
      do loop = 1, mechanism%nloop
         if (.not. any(loops == loop)) cycle
         count_so_far = count_so_far + 1
         where (loops == loop) dyads = count_so_far
      end do
   end function dyads_of_variables
end module psalm_dyad_groups
