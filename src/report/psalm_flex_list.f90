!> Links of beam elements (group FLEX) in the listing.
module psalm_flex_list
   use psalm_coupled_hill, only: coupled_t
   use psalm_data_set, only: data_set_t
   use psalm_drive_links_study, only: drive_links_t
   use psalm_drive_study, only: small_swing
   use psalm_flex_group, only: flex_group_t, flex_of
   use psalm_flex_study, only: flex_study_t, stress_kinds
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t
   use psalm_number_format, only: error_words, figures_of, in_a_row, in_sentence
   use psalm_columns, only: right_column
   use psalm_text, only: lower_case, text_t, to_text
   use psalm_vibration_list, only: coupled_words, link_words, list_harmonics
   implicit none (type, external)
   private
   public :: list_flexible, list_together, flexible_name

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
         if (link%held(2) == 0 .and. link%slide > 0 .and. .not. study%clamped) then
            call text%add(' HELD BY PIN '//node_name(mechanism, study, link%held(1))//' AND SLIDE '// &
                          mechanism%joints(link%slide)%name)
         else if (link%held(2) == 0) then
            call text%add(' CLAMPED AT '//node_name(mechanism, study, link%held(1)))
         else
            call text%add(' IT BENDS BETWEEN '//node_name(mechanism, study, link%held(1))//' AND '// &
                          node_name(mechanism, study, link%held(2))//slide_words(mechanism, study))
         end if
         if (study%not_held) then
            call text%add(' HOW THE SLIDE HOLDS IT COULD NOT BE FOUND: THE LINKAGE IS LOOSE WITHOUT IT')
            return
         end if
         if (.not. study%solved) then
            call text%add(' THE NATURAL MODES COULD NOT BE FOUND: STIFFNESS AND MASS OF ITS SEGMENTS GIVE NO FREQUENCY')
            return
         end if
         if (link%slide > 0) then
            call list_over_turn(named, study, text)
         else
            call list_modes(set, study, text)
         end if
         if (study%influence%known .and. size(study%influence%node) > 0) then
            call text%add(' WITH THE MASSES THAT ITS JOINTS MOVE THE FIRST IS FROM'//in_sentence(named, study%driven(1))//' TO'// &
                          in_sentence(named, study%driven(2))//' OVER THE TURN')
         else if (.not. study%influence%known) then
            call text%add(' THE MASSES THAT ITS JOINTS MOVE ARE LEFT OUT: THE LINKAGE IS TOO NEAR A DEAD POINT TO GIVE WAY')
         end if
         call text%add(' SUM OF ALL FORCES ON THE LINK, OVER THE LARGEST OF A JOINT'//error_words(named, study%equilibrium))
         call text%add(' LEAST SQUARED FREQUENCY IN THE TURN, OVER THAT AT REST'//in_sentence(named, study%least_stiffness)// &
                       ', AT INPUT'//in_sentence(named, study%least_at)//' AFTER THE REFERENCE')
         if (study%least_stiffness < 0.0_wp) call text%add(' BUCKLED FOR A PART OF THE TURN')
         if (study%solved_modes == 0) then
            call text%add(' THE SPEED IS FAR BELOW ALL FREQUENCIES: EVERYTHING FROM STATICS')
         else
            call text%add(' '//modes_solved(study%solved_modes, size(study%frequency))//': '// &
                          coupled_words(study%coupled))
         end if
         if (study%solved_modes > 0 .and. .not. study%coupled%grows_too_much) then
            call list_multiplier(named, study%coupled, text)
         end if
      end associate
      if (study%steady) call list_greatest(set, mechanism, study, text)
      if (study%stressed .and. flex%strain > 0.0_wp) &
         call text%add(' STRAIN'//in_sentence(named, maxval([(study%segments(j)%stress(stress_kinds)%value/ &
                                                           flex%modulus(study%segments(j)%entry), j=1, size(study%segments))]))// &
                    ', THE MATERIAL BEARS'//in_sentence(named, flex%strain))
      call list_out_of_plane(set, mechanism, study, text)
   end subroutine list_link

   !> Natural modes at rest.
   subroutine list_modes(set, study, text)
      type(data_set_t), intent(in) :: set
      type(flex_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(15) :: columns(3, size(study%frequency))
      logical :: named
      integer :: j

      named = set%has_names()
      call text%add(' NATURAL FREQUENCIES AT REST')
      call text%add('   MODE      FREQUENCY   OVER SPEED        DAMPING')
      columns(1, :) = figures_of(named, study%frequency)
      columns(2, :) = figures_of(named, study%frequency/study%cycle%turn%crank%speed)
      columns(3, :) = figures_of(named, study%damping)
      do j = 1, size(study%frequency)
         call text%add(right_column(j, 6)//in_a_row(columns(:, j)))
      end do
   end subroutine list_modes

   !> Frequencies of a link that is held by its pins and its slide where the shoe is, over the turn.
   subroutine list_over_turn(named, study, text)
      logical, intent(in) :: named
      type(flex_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(15) :: columns(2, size(study%over_turn, 1))
      integer :: j

      call text%add(' NATURAL FREQUENCIES AT REST WITH THE SLIDE WHERE IT IS IN THE TURN')
      call text%add('   MODE           FROM             TO')
      columns(1, :) = figures_of(named, minval(study%over_turn, dim=2))
      columns(2, :) = figures_of(named, maxval(study%over_turn, dim=2))
      do j = 1, size(columns, 2)
         call text%add(right_column(j, 6)//in_a_row(columns(:, j)))
      end do
   end subroutine list_over_turn

   !> The link out of the plane.
   subroutine list_out_of_plane(set, mechanism, study, text)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(flex_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(15), allocatable :: columns(:, :)
      logical :: named
      integer :: j

      named = set%has_names()
      associate (out => study%out)
         if (out%left_out) then
            call text%add(' OUT OF THE PLANE A LINK WITH A SLIDE IS NOT STUDIED')
            return
         end if
         call text%add(' OUT OF THE PLANE: '//hold_words(mechanism, study))
         if (.not. out%solved) then
            call text%add(' ITS NATURAL MODES COULD NOT BE FOUND')
            return
         end if
         call text%add('   MODE      FREQUENCY   OVER SPEED        DAMPING          TWIST')
         allocate (columns(4, size(out%frequency)))
         columns(1, :) = figures_of(named, out%frequency)
         columns(2, :) = figures_of(named, out%frequency/study%cycle%turn%crank%speed)
         columns(3, :) = figures_of(named, out%damping)
         columns(4, :) = figures_of(named, out%twist)
         do j = 1, size(out%frequency)
            call text%add(right_column(j, 6)//in_a_row(columns(:, j)))
         end do
         call text%add(' THE FIRST FREQUENCY OUT OF THE PLANE IS'//in_sentence(named, out%frequency(1)/study%frequency(1))// &
                       ' OF THE FIRST IN IT')
         call text%add(' LEAST SQUARED FREQUENCY IN THE TURN, OVER THAT AT REST'//in_sentence(named, out%least_stiffness)// &
                       ', AT INPUT'//in_sentence(named, out%least_at)//' AFTER THE REFERENCE')
         if (out%least_stiffness < 0.0_wp) call text%add(' BUCKLED OUT OF THE PLANE FOR A PART OF THE TURN')
         if (out%solved_modes == 0) then
            call text%add(' THE SPEED IS FAR BELOW ALL FREQUENCIES OUT OF THE PLANE')
            return
         end if
         call text%add(' '//modes_solved(out%solved_modes, size(out%frequency))//': '//coupled_words(out%coupled))
         if (out%coupled%grows_too_much) return
         call list_multiplier(named, out%coupled, text)
      end associate
   end subroutine list_out_of_plane

   !> Its slide, if it has one.
   pure function slide_words(mechanism, study) result(words)
      type(mechanism_t), intent(in) :: mechanism
      type(flex_study_t), intent(in) :: study
      character(:), allocatable :: words

      words = ''
      if (study%link%slide > 0) words = ', ITS SLIDE IS '//mechanism%joints(study%link%slide)%name
   end function slide_words

   !> What holds it out of the plane.
   pure function hold_words(mechanism, study) result(words)
      type(mechanism_t), intent(in) :: mechanism
      type(flex_study_t), intent(in) :: study
      character(:), allocatable :: words

      associate (out => study%out, first => study%link%held(1))
         words = 'PINS THAT DO NOT HOLD THE SLOPE (XPINS=0)'
         if (out%long_pins) words = 'PINS THAT HOLD SLOPE AND TWIST (XPINS=1)'
         if (study%link%held(2) == 0) then
            words = words//', CLAMPED AT '//node_name(mechanism, study, first)
         else if (out%line_held) then
            words = words//', TWIST IS HELD AT '//node_name(mechanism, study, first)
         end if
      end associate
   end function hold_words

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

   !> A flexible drive and the links together.
   subroutine list_together(set, studies, together, rigid, text)
      type(data_set_t), intent(in) :: set
      type(flex_study_t), intent(in) :: studies(:)
      type(drive_links_t), intent(in) :: together
      real(wp), intent(in) :: rigid              !! greatest swing with rigid links, rad
      type(text_t), intent(inout) :: text
      character(15) :: columns(2, together%modes)
      logical :: named
      integer :: n, j

      named = set%has_names()
      call text%add()
      call text%add(' DRIVE AND LINKS OF BEAM ELEMENTS TOGETHER: THE SWING AND '//to_text(together%modes)//' MODES')
      if (.not. together%possible) then
         call text%add(' NOT SOLVED: THE INERTIA AT THE CRANK IS NOT POSITIVE')
         return
      end if
      call text%add(' '//coupled_words(together%coupled))
      if (together%coupled%grows_too_much) return
      call list_multiplier(named, together%coupled, text)
      if (.not. together%coupled%unique) return
      call text%add(' GREATEST SWING'//in_sentence(named, together%greatest)//', WITH RIGID LINKS'//in_sentence(named, rigid))
      if (together%greatest > small_swing) call text%add(' THE EQUATIONS ARE LINEAR IN THE SWING: ABOVE 0.1 RAD THEY ARE ROUGH')
      call text%add(' HARMONICS OF THE SWING')
      call list_harmonics(named, together%swing, text)
      call text%add(' GREATEST DISPLACEMENT IN A MODE     TOGETHER    RIGID DRIVE')
      columns(1, :) = figures_of(named, together%peaks)
      columns(2, :) = figures_of(named, together%rigid_drive)
      do n = 1, together%modes
         j = count(together%links(:n) == together%links(n))
         call text%add('   '//flexible_words(set, studies(together%links(n)))//', MODE '//to_text(j)//in_a_row(columns(:, n)))
      end do
   end subroutine list_together

   !> The largest multiplier, and how well it is known.
   subroutine list_multiplier(named, coupled, text)
      logical, intent(in) :: named
      type(coupled_t), intent(in) :: coupled
      type(text_t), intent(inout) :: text

      call text%add(' LARGEST MULTIPLIER'//in_sentence(named, abs(coupled%multipliers(1)), coupled%error)// &
                    '; OF A TURN: ERROR OF ITS MATRIX'//error_words(named, coupled%error)//', '//to_text(coupled%steps)//' STEPS')
   end subroutine list_multiplier

   !> The modes that are solved together.
   pure function modes_solved(solved, modes) result(words)
      integer, intent(in) :: solved, modes
      character(:), allocatable :: words

      words = 'ALL MODES TOGETHER'
      if (solved == modes) return
      words = 'MODES 1 TO '//to_text(solved)//' TOGETHER'
      if (solved == 1) words = 'MODE 1'
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

   !> The same in tables and remarks: of loops in small letters.
   function flexible_name(set, study) result(name)
      type(data_set_t), intent(in) :: set
      type(flex_study_t), intent(in) :: study
      character(:), allocatable :: name

      name = flexible_words(set, study)
      if (.not. set%has_names()) name = lower_case(name)
   end function flexible_name

   !> The joint at a node.
   pure function node_name(mechanism, study, node) result(name)
      type(mechanism_t), intent(in) :: mechanism
      type(flex_study_t), intent(in) :: study
      integer, intent(in) :: node
      character(:), allocatable :: name

      name = mechanism%joints(study%link%joints(findloc(study%link%nodes, node, dim=1)))%name
   end function node_name
end module psalm_flex_list
