!> A linkage solved at what a picture shows: the prescribed positions, a sweep between and beyond them, one position more.
!>
!> Each row of inputs is analysed once, with every loop, whether the output needs it or not. Scenes, forces, rates and curves take
!> the result as an argument.
module psalm_row_study
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, motion_t, reach_t, make_problem
   use psalm_force_analysis, only: force_table_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
   use psalm_sketch_study, only: sketch_study_t, study_sketch
   use psalm_sweep, only: sweep_inputs
   use psalm_time_study, only: time_study_t, increments_of
   implicit none (type, external)
   private
   public :: solved_row_t, row_study_t, study_rows, study_inputs, study_times, find_sweep_outputs

   !> A row of inputs.
   type :: solved_row_t
      class(problem_t), allocatable :: problem  !! bound; its plan has every loop and the point that the output arc begins at
      type(motion_t), allocatable :: motion     !! a type: as a class gfortran 12 may, at random, not free it in a component
      type(force_table_t), allocatable :: forces !! of a motion in time: as it has them
   end type solved_row_t

   !> All rows of a linkage.
   type :: row_study_t
      type(dimensions_t) :: dimensions
      class(problem_t), allocatable :: problem  !! at the prescribed positions, as `psalm` solves it
      type(solved_row_t) :: prescribed, sweep
      type(solved_row_t), allocatable :: chosen !! one more position, if asked for
      type(reach_t) :: reach                    !! of a sketch: how far it goes from its drawing
      type(sketch_study_t), allocatable :: outputs !! of a sketch over the sweep, once `find_sweep_outputs` was asked
   end type row_study_t

contains

   !> Solve a linkage at all rows.
   subroutine study_rows(set, mechanism, dimensions, parameters, study, chosen, delt, kept)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(parameters_t), intent(in) :: parameters
      type(row_study_t), intent(out) :: study
      real(wp), intent(in), optional :: chosen  !! increment of the input at one more position
      real(wp), intent(in), optional :: delt(:) !! increments in place of those of the case
      integer, intent(in), optional :: kept(:)  !! numbers of the prescribed positions that are solved; all if absent

      study%dimensions = dimensions
      allocate (study%problem)
      call make_problem(set, mechanism, dimensions, parameters, study%problem)
      if (present(kept)) call study%problem%keep_positions(kept)
      if (present(delt)) call study%problem%set_inputs(delt)
      allocate (study%prescribed%problem, source=study%problem)
      call study%prescribed%problem%want_derivatives(.true., with_point=.true.)
      call analyse_row(study, study%prescribed)
      call solve_row(study, sweep_inputs(study%problem), study%sweep)
      if (.not. present(chosen)) return
      allocate (study%chosen)
      call solve_row(study, [chosen], study%chosen)
   end subroutine study_rows

   !> Solve a linkage at the states of its motion in time: all of them in place of the sweep, some as prescribed positions.
   subroutine study_times(set, mechanism, dimensions, parameters, time, marks, study, chosen)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(parameters_t), intent(in) :: parameters
      type(time_study_t), intent(in) :: time
      integer, intent(in) :: marks(:)           !! numbers of its times that are prescribed positions
      type(row_study_t), intent(out) :: study
      real(wp), intent(in), optional :: chosen  !! as `study_rows` has it
      real(wp), allocatable :: inputs(:, :)

      inputs = increments_of(time)
      call study_inputs(set, mechanism, dimensions, parameters, inputs(marks, :), inputs, study, marks, time%turned)
      study%sweep%forces = time%forces%table
      study%prescribed%forces = time%forces%table%at_rows(marks)
      if (.not. present(chosen)) return
      allocate (study%chosen)
      call solve_row(study, [chosen], study%chosen)
   end subroutine study_times

   !> Solve a linkage at some increments of its drives in place of its positions, and at others in place of the sweep.
   subroutine study_inputs(set, mechanism, dimensions, parameters, inputs, sweep, study, marks, turned)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(parameters_t), intent(in) :: parameters
      real(wp), intent(in) :: inputs(:, :), sweep(:, :) !! shape (positions, drives), as `increments_of` has them
      type(row_study_t), intent(out) :: study
      integer, intent(in), optional :: marks(:)     !! where `inputs` are in `sweep`
      logical, intent(in), optional :: turned(:, :) !! shape (positions of the sweep, loops), as `set_turned` has it

      study%dimensions = dimensions
      allocate (study%problem)
      call make_problem(set, mechanism, dimensions, parameters, study%problem)
      ! it came there
      study%problem%followed = .false.
      call study%problem%set_inputs(inputs(:, 1), inputs(:, 2:))
      if (present(turned)) call study%problem%set_turned(turned(marks, :))
      allocate (study%prescribed%problem, source=study%problem)
      call study%prescribed%problem%want_derivatives(.true., with_point=.true.)
      call analyse_row(study, study%prescribed)
      call solve_row(study, sweep(:, 1), study%sweep, sweep(:, 2:), turned)
   end subroutine study_inputs

   !> The linkage of the prescribed positions at other inputs.
   subroutine solve_row(study, delt, row, own, turned)
      type(row_study_t), intent(inout) :: study
      real(wp), intent(in) :: delt(:)           !! increments
      type(solved_row_t), intent(inout) :: row
      real(wp), intent(in), optional :: own(:, :) !! those of further drives, as `set_inputs` has them
      logical, intent(in), optional :: turned(:, :) !! as `set_turned` has it

      allocate (row%problem, source=study%prescribed%problem)
      call row%problem%set_inputs(delt, own)
      if (present(turned)) call row%problem%set_turned(turned)
      call analyse_row(study, row)
   end subroutine solve_row

   subroutine analyse_row(study, row)
      type(row_study_t), intent(inout) :: study
      type(solved_row_t), intent(inout) :: row

      allocate (row%motion)
      call row%problem%analyse(study%dimensions, row%motion, study%reach)
   end subroutine analyse_row

   !> All outputs of a sketch and their rates over the sweep, found once.
   subroutine find_sweep_outputs(set, study)
      type(data_set_t), intent(in) :: set          !! a sketch
      type(row_study_t), intent(inout) :: study

      if (allocated(study%outputs)) return
      allocate (study%outputs)
      call study_sketch(set, study%sweep%problem, study%dimensions, study%sweep%motion%closed, set%pace(), set%change_of_pace(), &
                        study%outputs)
   end subroutine find_sweep_outputs
end module psalm_row_study
