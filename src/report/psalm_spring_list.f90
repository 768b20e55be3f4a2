!> Springs that were found: in the listing, as tables and as the group SPRING.
module psalm_spring_list
   use psalm_column_names, only: plotted_load
   use psalm_columns, only: add_item, left_column, right_column
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_number_format, only: error_words, figures_of, in_a_row, in_sentence
   use psalm_place, only: place_t
   use psalm_spring_design_group, only: spring_design_group_t, spring_design_of, criterion_range, criterion_rms, &
                                        acts_by_turning
   use psalm_spring_exact, only: exact_distance_varies, exact_possible
   use psalm_spring_study, only: spring_study_t, spring_result_t, unmade_wound
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: text_t, to_text
   use psalm_weight_text, only: place_words, write_places
   implicit none (type, external)
   private
   public :: list_springs, put_springs, write_springs

   integer, parameter :: place_columns = 24 !! of a link and its joints

contains

   !> What was found.
   subroutine list_springs(set, study, text)
      type(data_set_t), intent(in) :: set
      type(spring_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(spring_design_group_t) :: group
      character(:), allocatable :: what
      logical :: named

      named = set%has_names()
      group = spring_design_of(set)
      what = 'GREATEST AMOUNT'
      if (group%criterion == criterion_range) what = 'RANGE'
      if (group%criterion == criterion_rms) what = 'RMS'
      call text%add()
      call text%add(' SPRINGS FOR THE LEAST '//what//' OF THE '//study%load//'; N/M, NEWTONS, PLACES IN THE AXES OF THEIR LINKS')
      if (.not. study%found) then
         if (study%unmade > 0) then
            call text%add(' SPRING '//to_text(study%unmade)//': '//why_not(study))
         else if (study%exact_state == exact_distance_varies) then
            call text%add(' THE PLACES FROM WHICH THE ENDS ARE COUNTED ARE NOT ALWAYS AT THE SAME DISTANCE: NAME SUCH, OR SEARCH')
         else if (study%exact_state /= exact_possible) then
            call text%add(' THE COLUMNS OF THE SPRING''S TORQUE DO NOT HAVE RANK 5: SEARCH')
         else
            call text%add(' THERE IS NO SUCH SPRING WITHIN THE LIMITS')
         end if
         return
      end if
      call text%add(' BEFORE'//in_sentence(named, study%before)//'   AFTER'//in_sentence(named, study%after))
      if (group%exact) then
         call text%add(' ZERO FREE LENGTH, EXACT AT SIX CRANK ANGLES, EQUAL ERRORS BETWEEN THEM; THE BEST OF '// &
                       to_text(size(study%phases)/2)//' PHASES')
      else if (study%search%convex) then
         call text%add(' GLOBAL OPTIMUM FOR THESE PLACES: LOWER BOUND'//in_sentence(named, study%search%bound)// &
                       '   DUALITY GAP'//error_words(named, study%search%gap)//'   RESIDUAL'// &
                       error_words(named, study%search%residual))
      else
         call text%add(' LOCAL OPTIMUM, THE BEST OF '//to_text(study%search%starts)//' STARTS, '// &
                       to_text(study%search%ended_here)//' OF WHICH ENDED SO LOW')
      end if
      if (any(study%springs%acts /= acts_by_turning)) call list_pulling(set, study, text)
      if (any(study%springs%acts == acts_by_turning)) call list_turning(set, study, text)
   end subroutine list_springs

   !> Why a spring cannot be made.
   pure function why_not(study) result(words)
      type(spring_study_t), intent(in) :: study
      character(:), allocatable :: words

      select case (study%why)
      case (unmade_wound)
         words = 'ITS LINKS TURN ROUND AGAINST EACH OTHER; A TORSION SPRING WOULD BE WOUND UP'
      case default
         words = 'ITS SECOND PLACE DOES NOT GO ALONG A STRAIGHT LINE OF THE FIRST LINK'
      end select
   end function why_not

   !> Torsion springs.
   subroutine list_turning(set, study, text)
      type(data_set_t), intent(in) :: set
      type(spring_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(15), allocatable :: columns(:, :)
      character(:), allocatable :: line
      logical :: named
      integer :: k

      named = set%has_names()
      allocate (columns(size(study%springs), 5))
      associate (of => study%springs, turning => study%springs%acts == acts_by_turning)
         line = ' SPRING FROM ARC LOOP TO ARC LOOP'
         if (named) line = ' SPRING   '//left_column('FROM', place_columns, 0)//'   '//left_column('TO', place_columns, 0)
         call text%add(' TORSION SPRINGS: N M/RAD, DEGREES, N M')
         call text%add(line//'      STIFFNESS     FREE ANGLE          LEAST       GREATEST GREATEST MOMENT')
         columns(:, 1) = figures_of(named, of%stiffness, turning)
         columns(:, 2) = figures_of(named, of%free, turning)
         columns(:, 3) = figures_of(named, of%shortest, turning)
         columns(:, 4) = figures_of(named, of%longest, turning)
         columns(:, 5) = figures_of(named, of%pull, turning)
         do k = 1, size(of)
            if (turning(k)) call text%add(right_column(k, 7)//place_text(set, of(k)%ends(1))// &
                                          place_text(set, of(k)%ends(2))//in_a_row(columns(k, :)))
         end do
      end associate
   end subroutine list_turning

   !> Springs between two points.
   subroutine list_pulling(set, study, text)
      type(data_set_t), intent(in) :: set
      type(spring_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(15), allocatable :: columns(:, :)
      character(:), allocatable :: line
      logical :: named
      logical, allocatable :: pulling(:)
      integer :: i, j, k

      named = set%has_names()
      pulling = study%springs%acts /= acts_by_turning
      line = ' SPRING FROM ARC LOOP              X              Y TO ARC LOOP              X              Y'
      if (named) line = ' SPRING   '//left_column('FROM', place_columns, 0)//'              X              Y   '// &
                                  left_column('TO', place_columns, 0)//'              X              Y'
      call text%add(line)
      allocate (columns(size(study%springs), 5))
      associate (of => study%springs)
         do j = 1, 2
            do i = 1, 2
               columns(:, 2*(j - 1) + i) = figures_of(named, [(of(k)%at(i, j), k=1, size(of))], pulling)
            end do
         end do
         do k = 1, size(of)
            if (pulling(k)) call text%add(right_column(k, 7)//place_text(set, of(k)%ends(1))//columns(k, 1)//columns(k, 2)// &
                          place_text(set, of(k)%ends(2))//columns(k, 3)//columns(k, 4))
         end do
         call text%add(' SPRING      STIFFNESS    FREE LENGTH       SHORTEST        LONGEST  GREATEST PULL')
         columns(:, 1) = figures_of(named, of%stiffness, pulling)
         columns(:, 2) = figures_of(named, of%free, pulling)
         columns(:, 3) = figures_of(named, of%shortest, pulling)
         columns(:, 4) = figures_of(named, of%longest, pulling)
         columns(:, 5) = figures_of(named, of%pull, pulling)
         do k = 1, size(of)
            if (pulling(k)) call text%add(right_column(k, 7)//in_a_row(columns(k, :)))
         end do
         if (.not. study%coil_rate > 0.0_wp) return
         call text%add(' COIL OF STIFFNESS'//in_sentence(named, study%coil_rate)//'   WAHL''S FACTOR'// &
                       in_sentence(named, study%wahl))
         call text%add(' SPRING          COILS     STRESS, PA    HELIX ANGLE')
         columns(:, 1) = figures_of(named, of%coils)
         columns(:, 2) = figures_of(named, of%stress)
         columns(:, 3) = figures_of(named, of%helix)
         do k = 1, size(of)
            call text%add(right_column(k, 7)//in_a_row(columns(k, :3)))
         end do
      end associate
   end subroutine list_pulling

   !> Where the end of a spring is counted from: an arc, or a link and its joints.
   pure function place_text(set, place) result(text)
      type(data_set_t), intent(in) :: set
      type(place_t), intent(in) :: place
      character(:), allocatable :: text

      if (set%has_names()) then
         text = '   '//left_column(place_words(set, place), place_columns, 0)
         return
      end if
      text = right_column(merge(-place%arc, place%arc, place%from_start), 7)//right_column(place%loop, 5)
   end function place_text

   !> Tables: the springs found, the load before and after, the springs of all phases.
   subroutine put_springs(study, tables)
      type(spring_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      character(*), parameter :: axes(2) = ['x', 'y']
      type(table_t) :: table
      character(:), allocatable :: unit
      integer :: k

      unit = trim(merge('N m', 'N  ', index(study%load, 'TORQUE') > 0))
      table = table_of('springs', 'a row for each spring: its ends in the axes of their links', audience=for_programs)
      if (allocated(study%springs)) then
         associate (of => study%springs)
            call table%add('kind', of%acts)
            ! torsional: N m/rad, degrees, N m
            call table%add('stiffness', of%stiffness, 'N/m')
            call table%add('free', of%free, 'length')
            call add_ends('x1', [(of(k)%at(1, 1), k=1, size(of))])
            call add_ends('y1', [(of(k)%at(2, 1), k=1, size(of))])
            call add_ends('x2', [(of(k)%at(1, 2), k=1, size(of))])
            call add_ends('y2', [(of(k)%at(2, 2), k=1, size(of))])
            call table%add('shortest', of%shortest, 'length')
            call table%add('longest', of%longest, 'length')
            call table%add('pull', of%pull, 'N')
            call table%add('stress', of%stress, 'Pa')
            call table%add('coils', of%coils)
         end associate
      end if
      call tables%put(table)
      table = table_of('spring_result', 'one row: what the springs are to lessen, before and after', audience=for_programs)
      call table%add('load', [study%load])
      call table%add('before', [study%before], unit)
      call table%add('after', [study%after], unit)
      call table%add('bound', [study%search%bound], unit)
      call table%add('convex', [study%search%convex])
      call tables%put(table)
      if (study%found) then
         table = table_of('spring_load', 'a row for each position: the load before and after')
         call table%add('input', study%input, 'deg')
         call add_load('before', study%load_before)
         call add_load('after', study%load_after)
         call tables%put(table)
      end if
      if (.not. allocated(study%phases)) return
      table = table_of('spring_phases', 'a row for each spring of each phase of the exact points')
      associate (of => study%phases)
         call table%add('phase', of%phase, 'turn')
         call table%add('ratio', of%ratio)
         call table%add('real', of%real)
         call table%add('stiffness', of%stiffness, 'N/m')
         call add_ends('x1', [(of(k)%at(1, 1), k=1, size(of))])
         call add_ends('y1', [(of(k)%at(2, 1), k=1, size(of))])
         call add_ends('x2', [(of(k)%at(1, 2), k=1, size(of))])
         call add_ends('y2', [(of(k)%at(2, 2), k=1, size(of))])
      end associate
      call tables%put(table)

   contains

      subroutine add_ends(name, values)
         character(*), intent(in) :: name
         real(wp), intent(in) :: values(:)

         call table%add(name, values, 'length')
      end subroutine add_ends

      subroutine add_load(name, values)
         character(*), intent(in) :: name
         real(wp), intent(in) :: values(:, :)      !! shape (positions, components)
         character(:), allocatable :: column
         integer :: c

         do c = 1, size(values, 2)
            column = name
            if (size(values, 2) > 1) column = name//'.'//axes(c)
            call table%add(column, values(:, c), unit, plotted=plotted_load(column))
         end do
      end subroutine add_load
   end subroutine put_springs

   !> The group SPRING with the springs found as further entries.
   subroutine write_springs(set, springs, text)
      type(data_set_t), intent(in) :: set
      type(spring_result_t), intent(in) :: springs(:)
      type(text_t), intent(inout) :: text
      type(place_t) :: first(size(springs)), second(size(springs))
      real(wp) :: none(size(springs)), free(size(springs))
      character(:), allocatable :: line
      integer :: k

      if (size(springs) + size(set%springs%first) == 0) return
      do k = 1, size(springs)
         first(k) = springs(k)%ends(1)
         second(k) = springs(k)%ends(2)
      end do
      none = 0.0_wp
      free = merge(springs%from, springs%free, springs%acts == acts_by_turning)
      associate (old => set%springs)
         call text%add(' &SPRING NSPRNG='//to_text(size(old%first) + size(springs))//',')
         if (old%added + size(springs) > 0) call text%add('  SADDED='//to_text(old%added + size(springs))// &
                                                          ', ! the last entries were found')
         call write_places(set, 'A', [old%first, first], text)
         call write_places(set, 'B', [old%second, second], text)
         line = '  STORS='
         do k = 1, size(old%first)
            line = line//trim(merge('1,', '0,', old%torsional(k)))
         end do
         do k = 1, size(springs)
            line = line//trim(merge('1,', '0,', springs(k)%acts == acts_by_turning))
         end do
         call text%add(line)
         call add_item('STIFF=', [old%stiffness, springs%stiffness], text)
         call add_item('SFREE=', [old%free, free], text)
         call add_item('SPRE=', [old%preload, springs%preload], text)
         call add_item('SDAMP=', [old%damping, none], text)
         if (any(abs(old%drag) > 0.0_wp)) call add_item('SQUAD=', [old%drag, none], text)
         if (any(old%power > 0.0_wp)) then
            call add_item('SGAS=', [old%power, none], text)
            call add_item('SGASP=', [old%closed, none], text)
         end if
         if (any(old%side /= 0)) call add_counts('SSIDE=', [old%side, (0, k=1, size(springs))])
         if (size(old%table_pull, 2) > 0) then
            call add_counts('SLTAB=', [old%table, (0, k=1, size(springs))])
            call text%add('  NSTAB='//to_text(size(old%table_pull, 2))//', NSTABL='//to_text(size(old%table_length))//',')
            call add_item('STABL=', old%table_length, text)
            call add_item('STABF=', [old%table_pull], text)
         end if
         call text%add(' &END')
      end associate

   contains

      subroutine add_counts(item, numbers)
         character(*), intent(in) :: item
         integer, intent(in) :: numbers(:)
         integer :: i

         line = '  '//item
         do i = 1, size(numbers)
            line = line//to_text(numbers(i))//','
         end do
         call text%add(line)
      end subroutine add_counts
   end subroutine write_springs
end module psalm_spring_list
