!> Links of beam elements (group FLEX) in the listing.
module psalm_flex_list
   use psalm_coupled_hill, only: coupled_t
   use psalm_data_set, only: data_set_t
   use psalm_flex_group, only: flex_group_t, flex_of
   use psalm_flex_study, only: flex_study_t, stress_kinds
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t
   use psalm_number_format, only: error_words, figures_of, in_a_row, in_sentence
   use psalm_columns, only: right_column
   use psalm_text, only: text_t, to_text
   use psalm_vibration_list, only: link_words
   implicit none (type, external)
   private
   public :: list_flexible, coupled_words, flexible_words

   character(*), parameter :: stress_names(stress_kinds) = [character(14) :: 'BENDING', 'ALONG THE LINK', 'BOTH TOGETHER']

contains

   !> A paragraph for each link.
   subroutine list_flexible(set, mechanism, studies, text)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(flex_study_t), intent(in) :: studies(:)
      type(text_t), intent(inout) :: text
      integer :: k

      do k = 1, size(studies)
         call list_link(set, mechanism, studies(k), text)
      end do
   end subroutine list_flexible

   subroutine list_link(set, mechanism, study, text)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(flex_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(flex_group_t) :: flex
      character(15), allocatable :: columns(:, :)
      logical :: named
      integer :: j

      flex = flex_of(set)
      named = set%has_names()
      associate (link => study%link)
         call text%add()
         call text%add(' LINK '//flexible_words(set, study)//' OF BEAM ELEMENTS: SI UNITS, SPEEDS IN RAD/S')
         call text%add(' SEGMENTS '//to_text(size(link%segments))//'  ELEMENTS '//to_text(size(link%frame%elements))// &
                       '  MASS OF THE SEGMENTS'//in_sentence(named, link%own(1))//'  OF &MASSES'// &
                       in_sentence(named, sum(set%masses%mass(link%masses%entry))))
         if (link%held(2) == 0) then
            call text%add(' CLAMPED AT '//node_name(mechanism, study, link%held(1)))
         else
            call text%add(' IT BENDS BETWEEN '//node_name(mechanism, study, link%held(1))//' AND '// &
                          node_name(mechanism, study, link%held(2)))
         end if
         if (.not. study%solved) then
            call text%add(' THE NATURAL MODES COULD NOT BE FOUND: SECTIONS OF ONE LINK DIFFER TOO MUCH')
            return
         end if
         call text%add(' NATURAL FREQUENCIES AT REST')
         call text%add('   MODE      FREQUENCY   OVER SPEED        DAMPING')
         allocate (columns(3, size(study%frequency)))
         columns(1, :) = figures_of(named, study%frequency)
         columns(2, :) = figures_of(named, study%frequency/abs(set%rates%speed))
         columns(3, :) = figures_of(named, study%damping)
         do j = 1, size(study%frequency)
            call text%add(right_column(j, 6)//in_a_row(columns(:, j)))
         end do
         call text%add(' SUM OF ALL FORCES ON THE LINK, OVER THE LARGEST OF A JOINT'//error_words(named, study%equilibrium))
         call text%add(' LEAST SQUARED FREQUENCY IN THE TURN, OVER THAT AT REST'//in_sentence(named, study%least_stiffness)// &
                       ', AT INPUT'//in_sentence(named, study%least_at)//' AFTER THE REFERENCE')
         if (study%least_stiffness < 0.0_wp) call text%add(' BUCKLED FOR A PART OF THE TURN')
         if (study%solved_modes == 0) then
            call text%add(' THE SPEED IS FAR BELOW ALL FREQUENCIES: EVERYTHING FROM STATICS')
         else
            call text%add(' '//modes_solved(study)//': '//coupled_words(study%coupled))
         end if
         if (study%solved_modes > 0 .and. .not. study%coupled%grows_too_much) then
            call text%add(' LARGEST MULTIPLIER'//in_sentence(named, abs(study%coupled%multipliers(1)), study%coupled%error)// &
                          '; OF A TURN: ERROR OF ITS MATRIX'//error_words(named, study%coupled%error)//', '// &
                          to_text(study%coupled%steps)//' STEPS')
         end if
      end associate
      if (study%steady) call list_greatest(set, mechanism, study, text)
      if (.not. study%stressed .or. .not. flex%strain > 0.0_wp) return
      call text%add(' STRAIN'//in_sentence(named, maxval([(study%segments(j)%stress(stress_kinds)%value/ &
                                                           flex%modulus(study%segments(j)%entry), j=1, size(study%segments))]))// &
                    ', THE MATERIAL BEARS'//in_sentence(named, flex%strain))
   end subroutine list_link

   !> Greatest deflections and stresses.
   subroutine list_greatest(set, mechanism, study, text)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(flex_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(15) :: columns(3, size(study%segments))
      logical :: named
      integer :: j, k

      named = set%has_names()
      do j = 1, size(study%link%joints)
         if (any(study%link%nodes(:j - 1) == study%link%nodes(j)) .or. .not. maxval(study%joints(j, :)) > 0.0_wp) cycle
         call text%add(' JOINT '//mechanism%joints(study%link%joints(j))%name//' MOVES BY AT MOST'// &
                       in_sentence(named, maxval(study%joints(j, :)))//' IN THE AXES OF THE LINK')
      end do
      call text%add(' GREATEST OVER THE TURN, BY SEGMENT      VALUE       AT INPUT        AT PART')
      associate (of => study%segments)
         columns(1, :) = figures_of(named, of%deflection%value)
         columns(2, :) = figures_of(named, of%deflection%at)
         columns(3, :) = figures_of(named, of%deflection%part)
         call list_rows('DEFLECTION')
         if (.not. study%stressed) return
         do k = 1, stress_kinds
            columns(1, :) = figures_of(named, [(of(j)%stress(k)%value, j=1, size(of))])
            columns(2, :) = figures_of(named, [(of(j)%stress(k)%at, j=1, size(of))])
            columns(3, :) = figures_of(named, [(of(j)%stress(k)%part, j=1, size(of))])
            call list_rows('STRESS, '//trim(stress_names(k)))
         end do
      end associate

   contains

      subroutine list_rows(what)
         character(*), intent(in) :: what
         character(24) :: head

         head = what
         do j = 1, size(study%segments)
            call text%add(' '//head//right_column(study%segments(j)%entry, 6)//in_a_row(columns(:, j)))
            head = ''
         end do
      end subroutine list_rows
   end subroutine list_greatest

   !> The modes that are solved together.
   pure function modes_solved(study) result(words)
      type(flex_study_t), intent(in) :: study
      character(:), allocatable :: words

      words = 'ALL MODES TOGETHER'
      if (study%solved_modes == size(study%frequency)) return
      words = 'MODES 1 TO '//to_text(study%solved_modes)//' TOGETHER'
      if (study%solved_modes == 1) words = 'MODE 1'
      words = words//' (THE OTHERS ARE FAR ABOVE THE SPEED: FROM STATICS)'
   end function modes_solved

   !> What a link is called: a sketch names it, otherwise an arc and its loop.
   function flexible_words(set, study) result(words)
      type(data_set_t), intent(in) :: set
      type(flex_study_t), intent(in) :: study
      character(:), allocatable :: words
      type(flex_group_t) :: flex

      flex = flex_of(set)
      words = link_words(set, flex%starts(study%link%first), ' IN LOOP ', 'OF ARC ')
   end function flexible_words

   !> The joint at a node.
   pure function node_name(mechanism, study, node) result(name)
      type(mechanism_t), intent(in) :: mechanism
      type(flex_study_t), intent(in) :: study
      integer, intent(in) :: node
      character(:), allocatable :: name

      name = mechanism%joints(study%link%joints(findloc(study%link%nodes, node, dim=1)))%name
   end function node_name

   !> Is the periodic solution what the link, or the system, does?
   pure function coupled_words(coupled) result(words)
      type(coupled_t), intent(in) :: coupled
      character(:), allocatable :: words

      if (coupled%grows_too_much) then
         words = 'UNSTABLE: IT GROWS TOO MUCH IN A TURN TO BE FOLLOWED'
      else if (.not. coupled%unique) then
         words = 'NO UNIQUE PERIODIC SOLUTION: A MULTIPLIER IS 1'
      else if (coupled%stable) then
         words = 'STABLE'
      else if (coupled%neutral) then
         words = 'NEITHER GROWS NOR DIES: WITHOUT DAMPING NO STEADY STATE IS REACHED'
      else
         words = 'UNSTABLE: THE PERIODIC SOLUTION IS NOT THE RESPONSE'
      end if
      if (.not. coupled%converged .and. .not. coupled%grows_too_much) words = words//' (NOT CONVERGED)'
   end function coupled_words
end module psalm_flex_list
