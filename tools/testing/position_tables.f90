!> Device 9 of psalm and of kalm for cases that are analysed, and nothing else: in quadruple precision the reference that
!> `test/tools/hard_cases.sh` measures errors by. It needs half as many modules as the two programs.
!>
!> usage: psalm|kalm [--quiet] --output-dir DIRECTORY CASE.nml; the name that it is called by tells which tables
program position_tables
   use psalm_analysis, only: analysis_t, wanted_t, analyse
   use psalm_cases, only: read_cases
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, make_problem
   use psalm_force_model, only: forces_wanted
   use psalm_force_study, only: force_study_t, find_forces
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
   use psalm_position_table, only: plot_positions, put_rates, positions_block
   use psalm_rate_study, only: rate_study_t, find_rates
   use psalm_setup, only: set_up
   use psalm_status, only: diagnostics_t
   use psalm_table_plot, only: write_plot_block
   use psalm_tables, only: tables_t, tables_of
   use psalm_text, only: text_t
   implicit none (type, external)
   character(:), allocatable :: file, folder, stem, suffix
   type(data_set_t), allocatable :: sets(:)
   type(diagnostics_t) :: findings
   type(text_t) :: text
   integer :: i, unit
   logical :: with_rates

   file = argument(command_argument_count())
   folder = argument(command_argument_count() - 1)
   stem = name_of(file)
   stem = stem(:len(stem) - len('.nml'))
   with_rates = name_of(argument(0)) == 'kalm'
   suffix = trim(merge('.kalm.dev9', '.dev9     ', with_rates))
   call read_cases(file, sets, findings, trim(merge('kalm ', 'psalm', with_rates)))
   if (findings%failed()) error stop 'the case cannot be read'
   do i = 1, size(sets)
      call add_case(sets(i))
   end do
   open (newunit=unit, file=folder//'/'//stem//suffix, access='stream', action='write', status='replace')
   write (unit) text%content()
   close (unit)

contains

   function argument(number) result(word)
      integer, intent(in) :: number
      character(:), allocatable :: word
      integer :: length

      call get_command_argument(number, length=length)
      allocate (character(length) :: word)
      call get_command_argument(number, word)
   end function argument

   function name_of(path) result(name)
      character(*), intent(in) :: path
      character(:), allocatable :: name

      name = path(index(path, '/', back=.true.) + 1:)
   end function name_of

   subroutine add_case(set)
      type(data_set_t), intent(in) :: set
      class(problem_t), allocatable :: problem
      type(mechanism_t) :: mechanism
      type(dimensions_t) :: given
      type(parameters_t) :: parameters
      type(tables_t) :: tables
      integer :: k

      call set_up(set, mechanism, given, parameters, findings)
      if (findings%failed()) error stop 'the linkage cannot be set up'
      allocate (problem)
      call make_problem(set, mechanism, given, parameters, problem)
      tables = tables_of(set%title)
      if (with_rates) then
         call put_rates_of(set, problem, given, tables)
      else
         call put_positions_of(set, problem, given, tables)
      end if
      do k = 1, tables%count
         call write_plot_block(tables%tables(k), text)
      end do
   end subroutine add_case

   subroutine put_positions_of(set, problem, given, tables)
      type(data_set_t), intent(in) :: set
      class(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: given
      type(tables_t), intent(inout) :: tables
      class(analysis_t), allocatable :: analysis
      type(wanted_t) :: wanted

      allocate (analysis)
      wanted%sweep = set%limits%iplot /= 0
      call analyse(set, problem, given, wanted, analysis)
      call plot_positions(set%title, positions_block, problem, analysis%motion, tables)
      if (allocated(analysis%sweep)) call plot_positions(set%title, 'every_position', problem, analysis%sweep, tables)
   end subroutine put_positions_of

   subroutine put_rates_of(set, problem, given, tables)
      type(data_set_t), intent(in) :: set
      class(problem_t), intent(inout) :: problem
      type(dimensions_t), intent(in) :: given
      type(tables_t), intent(inout) :: tables
      class(rate_study_t), allocatable :: rates
      class(force_study_t), allocatable :: forces     ! an absent argument unless the case asks for them

      allocate (rates)
      call find_rates(set, problem, given, rates)
      if (forces_wanted(set)) then
         allocate (forces)
         call find_forces(set, problem, given, forces, analysed=rates%motion)
      end if
      call put_rates(set%title, set%rates%speed, set%rates%accel, problem, rates, .not. set%has_names(), tables, forces)
   end subroutine put_rates_of
end program position_tables
