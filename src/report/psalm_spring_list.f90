!> Springs that were found: in the listing, on device 9, as JSON and as the group SPRING.
module psalm_spring_list
   use psalm_block, only: begin_block
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_markup, only: json_text, number_or_null
   use psalm_place, only: place_t
   use psalm_spring_design_group, only: spring_design_group_t, spring_design_of, criterion_range, criterion_rms
   use psalm_spring_exact, only: exact_distance_varies, exact_possible
   use psalm_spring_study, only: spring_study_t, spring_result_t
   use psalm_text, only: text_t, full_precision, general, to_text
   use psalm_weight_text, only: write_places, write_reals
   implicit none (type, external)
   private
   public :: list_springs, plot_springs, write_spring_json, write_springs

contains

   !> What was found.
   subroutine list_springs(set, study, text)
      type(data_set_t), intent(in) :: set
      type(spring_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(spring_design_group_t) :: group
      character(:), allocatable :: what
      integer :: k

      group = spring_design_of(set)
      what = 'GREATEST AMOUNT'
      if (group%criterion == criterion_range) what = 'RANGE'
      if (group%criterion == criterion_rms) what = 'RMS'
      call text%add()
      call text%add(' SPRINGS FOR THE LEAST '//what//' OF THE '//study%load//'; N/M, NEWTONS, PLACES IN THE AXES OF THEIR LINKS')
      if (.not. study%found) then
         if (study%exact_state == exact_distance_varies) then
            call text%add(' THE PLACES FROM WHICH THE ENDS ARE COUNTED ARE NOT ALWAYS AT THE SAME DISTANCE: NAME SUCH, OR SEARCH')
         else if (study%exact_state /= exact_possible) then
            call text%add(' THE COLUMNS OF THE SPRING''S TORQUE DO NOT HAVE RANK 5: SEARCH')
         else
            call text%add(' THERE IS NO SUCH SPRING WITHIN THE LIMITS')
         end if
         return
      end if
      call text%add(' BEFORE'//general(study%before)//'   AFTER'//general(study%after))
      if (group%exact) then
         call text%add(' ZERO FREE LENGTH, EXACT AT SIX CRANK ANGLES, EQUAL ERRORS BETWEEN THEM; THE BEST OF '// &
                       to_text(size(study%phases)/2)//' PHASES')
      else if (study%search%convex) then
         call text%add(' GLOBAL OPTIMUM FOR THESE PLACES: LOWER BOUND'//general(study%search%bound)//'   DUALITY GAP'// &
                       general(study%search%gap)//'   RESIDUAL'//general(study%search%residual))
      else
         call text%add(' LOCAL OPTIMUM, THE BEST OF '//to_text(study%search%starts)//' STARTS, '// &
                       to_text(study%search%ended_here)//' OF WHICH ENDED SO LOW')
      end if
      call text%add(' SPRING FROM ARC LOOP              X              Y TO ARC LOOP              X              Y')
      do k = 1, size(study%springs)
         associate (of => study%springs(k))
            call text%add(right(to_text(k), 7)//named(of%ends(1))//general(of%at(1, 1))//general(of%at(2, 1))// &
                          named(of%ends(2))//general(of%at(1, 2))//general(of%at(2, 2)))
         end associate
      end do
      call text%add(' SPRING      STIFFNESS    FREE LENGTH       SHORTEST        LONGEST  GREATEST PULL')
      do k = 1, size(study%springs)
         associate (of => study%springs(k))
            call text%add(right(to_text(k), 7)//general(of%stiffness)//general(of%free)//general(of%shortest)// &
                          general(of%longest)//general(of%pull))
         end associate
      end do
      if (.not. study%coil_rate > 0.0_wp) return
      call text%add(' COIL OF STIFFNESS'//general(study%coil_rate)//'   WAHL''S FACTOR'//general(study%wahl))
      call text%add(' SPRING          COILS     STRESS, PA    HELIX ANGLE')
      do k = 1, size(study%springs)
         associate (of => study%springs(k))
            call text%add(right(to_text(k), 7)//general(of%coils)//general(of%stress)//general(of%helix))
         end associate
      end do
   end subroutine list_springs

   pure function right(text, columns) result(padded)
      character(*), intent(in) :: text
      integer, intent(in) :: columns
      character(:), allocatable :: padded

      padded = repeat(' ', max(0, columns - len(text)))//text
   end function right

   pure function named(place) result(text)
      type(place_t), intent(in) :: place
      character(:), allocatable :: text

      text = right(to_text(merge(-place%arc, place%arc, place%from_start)), 7)//right(to_text(place%loop), 5)
   end function named

   !> Blocks of device 9: the load before and after, the springs of all phases.
   subroutine plot_springs(study, text)
      type(spring_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: k, c

      if (study%found) then
         call begin_block('spring_load', 'input'//repeat(' before', size(study%load_before, 2))// &
                          repeat(' after', size(study%load_after, 2)), text)
         do k = 1, size(study%input)
            line = full_precision(study%input(k))
            do c = 1, size(study%load_before, 2)
               line = line//' '//full_precision(study%load_before(k, c))
            end do
            do c = 1, size(study%load_after, 2)
               line = line//' '//full_precision(study%load_after(k, c))
            end do
            call text%add(line)
         end do
      end if
      if (.not. allocated(study%phases)) return
      call begin_block('spring_phases', 'phase ratio real stiffness x1 y1 x2 y2', text)
      do k = 1, size(study%phases)
         associate (of => study%phases(k))
            call text%add(full_precision(of%phase)//' '//full_precision(of%ratio)//' '//merge('1', '0', of%real)//' '// &
                          full_precision(of%stiffness)//' '//full_precision(of%at(1, 1))//' '//full_precision(of%at(2, 1))// &
                          ' '//full_precision(of%at(1, 2))//' '//full_precision(of%at(2, 2)))
         end associate
      end do
   end subroutine plot_springs

   !> The members `springs` and `spring_load` of a case's object.
   subroutine write_spring_json(study, text)
      type(spring_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      integer :: k

      call text%add_text('"springs":[')
      if (allocated(study%springs)) then
         do k = 1, size(study%springs)
            associate (of => study%springs(k))
               if (k > 1) call text%add_text(',')
               call text%add_text('{"stiffness":'//number(of%stiffness)//',"free":'//number(of%free)//',"from":'// &
                                  both(of%at(:, 1))//',"to":'//both(of%at(:, 2))//',"shortest":'//number(of%shortest)// &
                                  ',"longest":'//number(of%longest)//',"pull":'//number(of%pull)//',"stress":'// &
                                  number(of%stress)//',"coils":'//number(of%coils)//'}')
            end associate
         end do
      end if
      call text%add_text('],"spring_load":{"name":'//json_text(study%load)//',"before":'//number(study%before)//',"after":'// &
                         number(study%after)//',"bound":'//number(study%search%bound)//',"convex":'// &
                         trim(merge('true ', 'false', study%search%convex))//'}')

   contains

      pure function number(value) result(words)
         real(wp), intent(in) :: value
         character(:), allocatable :: words

         words = number_or_null(value, .true.)
      end function number

      pure function both(at) result(words)
         real(wp), intent(in) :: at(2)
         character(:), allocatable :: words

         words = '['//number(at(1))//','//number(at(2))//']'
      end function both
   end subroutine write_spring_json

   !> The group SPRING with the springs found as further entries.
   subroutine write_springs(set, springs, text)
      type(data_set_t), intent(in) :: set
      type(spring_result_t), intent(in) :: springs(:)
      type(text_t), intent(inout) :: text
      type(place_t) :: first(size(springs)), second(size(springs))
      real(wp) :: none(size(springs))
      character(:), allocatable :: line
      integer :: k

      if (size(springs) + size(set%springs%first) == 0) return
      do k = 1, size(springs)
         first(k) = springs(k)%ends(1)
         second(k) = springs(k)%ends(2)
      end do
      none = 0.0_wp
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
         call text%add(line//repeat('0,', size(springs)))
         call write_reals('STIFF', [old%stiffness, springs%stiffness], text)
         call write_reals('SFREE', [old%free, springs%free], text)
         call write_reals('SPRE', [old%preload, none], text)
         call write_reals('SDAMP', [old%damping, none], text)
         call text%add(' &END')
      end associate
   end subroutine write_springs
end module psalm_spring_list
