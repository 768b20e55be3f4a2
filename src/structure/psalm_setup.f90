!> SETUP makes of the loop arrays a mechanism with dimensions and variables, and finds every mistake in them.
!>
!> The steps in order; each has a module of its own. Nothing after SETUP knows ILINK or ILOOP. Source: Oldham (1977),
!> chapter 4 and appendices B2 and C.
module psalm_setup
   use psalm_arcs, only: classify_arcs
   use psalm_bodies, only: assign_bodies, find_joints_of_bodies
   use psalm_chain, only: find_points
   use psalm_common_arcs, only: find_identical
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_loop_groups, only: find_groups
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
   use psalm_part_names, only: name_output, take_names
   use psalm_plan_inputs, only: find_output, check_dimensions, find_repeated
   use psalm_sketch_mechanism, only: take_traced_loops, traced_dimensions
   use psalm_status, only: diagnostics_t
   use psalm_variables, only: find_variables
   implicit none (type, external)
   private
   public :: set_up

contains

   !> Understand a data set: mechanism, dimensions, and which of them vary.
   !>
   !> Errors: all fatal conditions of the topology, found before returning (in `findings`); warnings as well. After an error
   !> the mechanism is not complete.
   subroutine set_up(set, mechanism, dimensions, parameters, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(out) :: mechanism
      type(dimensions_t), intent(out) :: dimensions
      type(parameters_t), intent(out) :: parameters
      type(diagnostics_t), intent(inout) :: findings
      logical :: in_order

      if (set%loops() == 0) return
      if (allocated(set%traced)) then
         call take_traced_loops(set%traced, mechanism)
         call take_speeds(set, mechanism)
         dimensions = traced_dimensions(set%traced)
         dimensions%crnki = set%method%crnki + set%traced%input
         mechanism%from_drawing = .true.
         mechanism%whole = .true.
         mechanism%reference = set%method%crnki
         mechanism%crank_turn = set%traced%crank - set%traced%input
         mechanism%first_input = set%method%turn_begins()
         call assign_bodies(mechanism)
      else
         call classify_arcs(set, mechanism, in_order, findings)
         if (.not. in_order) return
         call take_dimensions(set, mechanism, dimensions)
         call find_groups(set, mechanism, dimensions, findings)
         if (findings%failed()) return
         call assign_bodies(mechanism)
         call find_identical(set, mechanism, dimensions, findings)
      end if
      call find_points(mechanism)
      call find_joints_of_bodies(mechanism)
      call take_names(set, mechanism)
      call find_output(set, mechanism, findings)
      call name_output(set, mechanism)
      call find_variables(set, mechanism, parameters, findings)
      call check_dimensions(set, mechanism, dimensions, parameters, findings)
      call find_repeated(set, findings)
   end subroutine set_up

   !> How the drives move while the first does: geared ones with it, others at speeds of their own. Where it stands still all are
   !> counted by time.
   pure subroutine take_speeds(set, mechanism)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(inout) :: mechanism
      real(wp), parameter :: accelerated = 3.0_wp
      integer :: d

      if (set%counts_time()) mechanism%actuators(1)%by_first = [0.0_wp, set%rates%accel, 0.0_wp]
      do d = 2, size(mechanism%actuators)
         associate (own => mechanism%actuators(d), drive => set%sketch%drives(d), speed => set%rates%speed, &
                    accel => set%rates%accel)
            if (own%geared) then
               own%by_first = own%ratio*unit_of(own%slides)/unit_of(mechanism%sliding_input)*mechanism%actuators(1)%by_first
               cycle
            end if
            if (set%counts_time()) then
               own%by_first = [drive%speed, drive%accel, 0.0_wp]
               cycle
            end if
            own%by_first = 0.0_wp
            if (.not. abs(speed) > 0.0_wp) cycle
            ! neither input has a jerk
            own%by_first(1) = drive%speed/speed
            own%by_first(2) = (drive%accel - own%by_first(1)*accel)/speed**2
            own%by_first(3) = -accelerated*own%by_first(2)*accel/speed**2
         end associate
      end do

   contains

      !> Ratios of geared drives are degrees, or lengths, by each other.
      pure real(wp) function unit_of(slides)
         logical, intent(in) :: slides

         unit_of = merge(1.0_wp, radians_per_degree, slides)
      end function unit_of
   end subroutine take_speeds

   !> The dimensions as written, of the arcs that are there.
   pure subroutine take_dimensions(set, mechanism, dimensions)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(out) :: dimensions
      integer :: n

      allocate (dimensions%arcl(size(mechanism%arcs)), dimensions%gama(size(mechanism%arcs)))
      do n = 1, size(mechanism%arcs)
         dimensions%arcl(n) = set%links%arcl(mechanism%arcs(n)%place, mechanism%arcs(n)%loop)
         dimensions%gama(n) = set%links%gama(mechanism%arcs(n)%place, mechanism%arcs(n)%loop)
      end do
      dimensions%outlk = set%links%outlk
      dimensions%outang = set%links%outang
      dimensions%origlk = set%method%origlk
      dimensions%origng = set%method%origng
      dimensions%crnki = set%method%crnki
   end subroutine take_dimensions
end module psalm_setup
