!> A case made ready for a study: its topology and dimensions, understood once, with every mistake found before any work is done.
module psalm_preparation
   use, intrinsic :: iso_fortran_env, only: int64
   use psalm_constraint_group, only: range_positions
   use psalm_data_set, only: data_set_t
   use psalm_dyad_groups, only: dyads_of_variables
   use psalm_dyad_kind, only: assur_higher
   use psalm_error, only: inputs_of
   use psalm_family_study, only: sets_one_of
   use psalm_group_anchor, only: choose_anchor
   use psalm_kinds, only: wp
   use psalm_regions, only: check_regions
   use psalm_setup, only: set_up
   use psalm_source, only: line_t
   use psalm_search, only: result_t
   use psalm_status, only: diagnostics_t
   use psalm_system, only: memory_to_be_had, threads_to_be_had
   use psalm_text, only: to_text
   use psalm_tolerance_spread, only: check_spread
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: parameters_t
   implicit none (type, external)
   private
   public :: memory_need_t, prepared_t, prepare, prepare_loops, threads_for, threads_wanted

   integer(int64), parameter :: megabyte = 1000000_int64

   !> Bytes that a program needs for each position: measured for psalm, estimated for kalm's
   !> arcs and for balm; texts take most of them.
   type :: memory_need_t
      integer :: position = 400        !! always
      integer :: arc = 120             !! more for each arc
      logical :: ktheta_only = .true.  !! arcs count with KTHETA=1 only
   end type memory_need_t

   !> What SETUP made of a data set.
   type :: prepared_t
      type(mechanism_t) :: mechanism
      type(dimensions_t) :: given            !! the user's linkage
      type(parameters_t) :: parameters       !! dimensions that vary
      real(wp), allocatable :: vertices(:, :) !! shape (nvar, nguess): supplied for a search
      type(result_t), allocatable :: found   !! what many starts led to, if the search was made before with that of other cases
      type(diagnostics_t) :: warnings        !! of SETUP, without the name of the file
      logical :: ready = .false.             !! no error was found
   end type prepared_t

contains

   !> Make a case ready. Errors, all found before returning: those of the topology, memory that is not to be had, regions of joints
   !> that are not there, supplied vertices that cannot be read, masses and loads that are on no link. Without an error
   !> `prepared%ready` is true.
   subroutine prepare(set, supplied, prepared, findings, need)
      use psalm_start, only: read_vertices
      use psalm_force_model, only: force_model_t, forces_wanted, make_force_model
      use psalm_allocation, only: check_allocation
      type(data_set_t), intent(in) :: set
      type(line_t), intent(in) :: supplied(:)            !! device 4, empty if none
      type(prepared_t), intent(out) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      type(memory_need_t), intent(in), optional :: need     !! for memory; that of psalm if absent
      type(diagnostics_t) :: own
      type(force_model_t) :: model
      type(memory_need_t) :: each
      integer(int64) :: bytes

      allocate (prepared%vertices(0, 0))
      call set_up(set, prepared%mechanism, prepared%given, prepared%parameters, prepared%warnings)
      call findings%append(prepared%warnings)
      if (prepared%warnings%failed()) return
      own%file = set%file
      if (set%loops() == 0) return
      if (present(need)) each = need
      bytes = each%position
      if (set%limits%ktheta /= 0 .or. .not. each%ktheta_only) bytes = bytes + int(each%arc, int64)*size(prepared%mechanism%arcs)
      bytes = bytes*set%method%ndes
      if (.not. memory_to_be_had(bytes)) then
         call findings%failure('not enough memory for NDES='//to_text(set%method%ndes)//' positions: about '// &
                               to_text(int(bytes/megabyte) + 1)//' MB are needed')
         return
      end if
      if (set%is_beyond_arrays() .and. set%limits%trmin_given .and. &
          all(prepared%mechanism%groups%kind == assur_higher)) &
         call set%origins%error(own, trim(merge('CONSTR', 'LIMITS', set%constr%gives_angle)), 'TRMIN', 'the groups of this '// &
                                'sketch have no transmission angle (it is that of two links, a dyad); leave it out')
      if (set%is_beyond_arrays() .and. prepared%parameters%has_search()) &
         call choose_anchor(prepared%mechanism, inputs_of(set), prepared%given)
      if (any(.not. prepared%mechanism%actuators(2:)%geared)) call refuse_ranges(set, own)
      call refuse_changes(set, prepared%mechanism, prepared%parameters, own)
      call check_regions(set%constr, prepared%mechanism, own)
      call check_allocation(set, prepared%mechanism, prepared%given, own)
      call check_spread(set, prepared%mechanism, own)
      if (set%search%nearly > 1.0_wp .and. .not. (set%toler%given .or. set%gives('ALLOC'))) call set%origins%error(own, 'SEARCH', &
         'NEARLY', 'how sensitive a linkage is, is its band by &TOLER or the cost of its tolerances by &ALLOC; give one of them')
      if (set%search%by_dyads .and. prepared%parameters%has_search()) then
         if (maxval(dyads_of_variables(prepared%mechanism, prepared%parameters)) == 1) &
            call set%origins%error(own, 'SEARCH', 'IDYAD', 'all dimensions that vary belong to one dyad: leave IDYAD out')
      end if
      if (forces_wanted(set)) call make_force_model(set, prepared%mechanism, prepared%given, model, own)
      associate (nvar => size(prepared%parameters%variables))
         if (prepared%parameters%has_search() .and. set%method%nguess > 0) then
            deallocate (prepared%vertices)
            call read_vertices(supplied, nvar, set%method%nguess, prepared%vertices, own)
         else
            deallocate (prepared%vertices)
            allocate (prepared%vertices(nvar, 0))
         end if
      end associate
      call findings%append(own)
      prepared%ready = .not. own%failed()
   end subroutine prepare

   !> Prepare a case for a program that needs loops and makes no search.
   subroutine prepare_loops(does, need, set, prepared, findings, turning)
      character(*), intent(in) :: does               !! what the program does: 'muscle balances'
      type(memory_need_t), intent(in) :: need           !! of the program, for memory
      type(data_set_t), intent(in) :: set
      class(prepared_t), intent(inout) :: prepared
      type(diagnostics_t), intent(inout) :: findings
      logical, intent(in), optional :: turning       !! it needs a crank that turns
      type(line_t) :: none(0)
      character(:), allocatable :: why

      why = ''
      if (present(turning)) then
         if (count(.not. set%sketch%drives%geared) > 1) why = set%sketch%why_no_crank()
      end if
      if (len(why) > 0) then
         call findings%error(does//' linkages with a crank that turns; '//why, line=set%title_line, group='DRIVES')
      end if
      if (.not. findings%failed()) call prepare(set, none, prepared, findings, need)
   end subroutine prepare_loops

   !> What goes along one input.
   subroutine refuse_ranges(set, findings)
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      character(*), parameter :: why = 'between the positions of several drives, which go their own ways, there is no one way; '// &
                                       'leave it out'

      if (set%constr%irange /= range_positions) call set%origins%error(findings, 'CONSTR', 'IRANGE', why)
      if (set%method%ifree /= 0) call set%origins%error(findings, 'METHOD', 'IFREE', why)
      if (set%limits%iplot /= 0) call set%origins%error(findings, 'LIMITS', 'IPLOT', why)
   end subroutine refuse_ranges

   !> What changes dimensions of links that brace each other: they meet with the lengths they have, and with no others.
   subroutine refuse_changes(set, mechanism, parameters, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(parameters_t), intent(in) :: parameters
      type(diagnostics_t), intent(inout) :: findings
      character(*), parameter :: why = 'links that brace each other (KOVER) meet with the lengths they have and no others; '// &
                                       'leave it out, or draw the linkage without the links in excess'
      logical :: braced(size(mechanism%arcs))
      integer :: n

      braced = [(mechanism%is_braced(mechanism%arcs(n)%loop), n=1, size(braced))]
      if (.not. any(braced)) return
      if (set%toler%given) call set%origins%error(findings, 'TOLER', '', why)
      if (set%gives('ALLOC')) call set%origins%error(findings, 'ALLOC', '', why)
      if (sets_one_of(set, braced)) call set%origins%error(findings, 'SWEEP', '', why)
      if (any(braced .and. (parameters%length_variable > 0 .or. parameters%angle_variable > 0))) &
         call set%origins%error(findings, 'CHAIN', 'VARY', why)
   end subroutine refuse_changes

   !> Threads that work on a case: as many as are asked for, fewer if the system does not give them.
   integer function threads_for(set, asked)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: asked       !! 0 stands for what THREADS says

      threads_for = threads_to_be_had(threads_wanted(set, asked))
   end function threads_for

   !> Threads that are asked for.
   pure integer function threads_wanted(set, asked)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: asked       !! 0 stands for what THREADS says

      threads_wanted = merge(asked, max(1, set%search%threads), asked > 0)
   end function threads_wanted
end module psalm_preparation
