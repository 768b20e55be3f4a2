!> Counterweights in the listing.
module psalm_balance_list
   use psalm_balance_group, only: balance_group_t, balance_of, form_body, measure_names, order_moment, order_torque, order_contact
   use psalm_balance_study, only: balance_study_t, outcome_t, channel_force, channel_moment, channel_torque
   use psalm_balance_terms, only: balance_term_t, terms_of, condition_link, condition_whole
   use psalm_clearance_study, only: margins_t
   use psalm_columns, only: right_column
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_number_format, only: error_words, figures_of, in_a_row, in_sentence
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: list_balance, list_of_names

   integer, parameter :: name_columns = 22      !! of a name at the beginning of a line

contains

   !> Everything that was found.
   subroutine list_balance(set, study, text)
      type(data_set_t), intent(in) :: set
      type(balance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(balance_group_t) :: group

      group = balance_of(set)
      call text%add()
      call text%add(' COUNTERWEIGHTS: KILOGRAMS, NEWTONS, NEWTON METRES; ONE UNIT OF LENGTH IS'// &
                    in_sentence(set%has_names(), set%masses%metre)//' METRES')
      if (set%has_names()) then
         call text%add(' PLACES ARE COUNTED FROM THE ANCHOR, ANGLES FROM THE LINE BETWEEN THE LINK''S FIRST TWO JOINTS')
      else
         call text%add(' PLACES ARE COUNTED FROM THE ANCHOR, ANGLES FROM THE DIRECTION OF THE LINK''S OWN ARC')
      end if
      call list_feasibility(set%has_names(), study, text)
      if (study%feasible) call list_designs(set%has_names(), set%masses%metre, group, study, text)
      if (study%steady_wanted) call list_steady(set%has_names(), study, text)
      if (size(study%budgets) > 0) call list_budgets(set%has_names(), study, text)
      if (allocated(study%found)) call list_optimum(set%has_names(), group, study, text)
      if (allocated(study%front)) call list_front(set%has_names(), group, study, text)
   end subroutine list_balance

   !> Names of some bodies, a comma between them.
   pure function list_of_names(study, bodies) result(names)
      type(balance_study_t), intent(in) :: study
      integer, intent(in) :: bodies(:)
      character(:), allocatable :: names
      integer :: k

      names = ''
      do k = 1, size(bodies)
         if (k > 1) names = names//', '
         names = names//trim(study%names(bodies(k)))
      end do
   end function list_of_names

   pure function padded(name) result(text)
      character(*), intent(in) :: name
      character(name_columns) :: text

      text = name
   end function padded

   subroutine list_feasibility(named, study, text)
      logical, intent(in) :: named                !! joints have names: a sketch
      type(balance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text

      call text%add()
      call text%add(' COMPLETE FORCE BALANCE')
      call text%add(' LINKS THAT MAY CARRY A WEIGHT: '//list_of_names(study, study%allowed))
      if (study%already) then
         call text%add(' THE LINKAGE IS BALANCED WITHOUT A WEIGHT')
      else if (study%feasible) then
         call text%add(' POSSIBLE WITH '//to_text(study%number)//' COUNTERWEIGHTS')
         if (study%number /= study%by_rule) then
            call text%add(' (TWICE THE LINKS LESS THE JOINTS WOULD BE '//to_text(study%by_rule)// &
                          '; LINKS THAT MOVE ALIKE, OR DO NOT TURN, OR ARE NOT ALLOWED MAKE THE DIFFERENCE)')
         end if
      else
         call text%add(' IMPOSSIBLE: OF THE IMBALANCE THIS PART STAYS'//in_sentence(named, study%left))
         if (size(study%out_of_reach) > 0) then
            call text%add(' THE LINKS ALLOWED CANNOT BALANCE: '//list_of_names(study, study%out_of_reach))
         end if
      end if
      if (size(study%adrift) > 0) then
         call text%add(' LINKS CONNECTED TO THE FRAME BY SLIDES ONLY: '//list_of_names(study, study%adrift))
      end if
   end subroutine list_feasibility

   subroutine list_designs(named, metre, group, study, text)
      logical, intent(in) :: named                !! joints have names: a sketch
      real(wp), intent(in) :: metre               !! metres in a unit of length
      type(balance_group_t), intent(in) :: group
      type(balance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(:), allocatable :: by
      character(15) :: mass(0:size(study%designs)), loads(0:size(study%designs), 3)     ! the first without weights
      integer, parameter :: ranked(3) = [channel_force, channel_moment, channel_torque]
      integer :: i, k

      if (study%number == 0 .or. study%already) return
      call text%add(' MINIMAL SETS OF LINKS WITH WEIGHTS: '//trim(merge('            ', 'MORE THAN   ', study%all_sets))//' '// &
                    to_text(size(study%sets, 2)))
      if (study%out_of_limits > 0) then
         call text%add(' OF THESE '//to_text(study%out_of_limits)//' LEAVE NO WEIGHTS WITHIN WREACH AND WMOST'// &
                       trim(merge(', WXLOW, WXHIGH, WYLOW, WYHIGH', repeat(' ', 30), group%boxed)))
      end if
      by = ' BY MASS'
      if (group%order == order_moment) by = ' BY SHAKING MOMENT'
      if (group%order == order_torque) by = ' BY DRIVE TORQUE'
      if (group%order == order_contact) by = ' BY CONTACT IN THE PASSAGE'
      call text%add()
      call text%add(' DESIGNS, LIGHTEST WEIGHTS OF EACH SET, RANKED'//by//'; RMS VALUES')
      call text%add('   DESIGN           MASS          FORCE         MOMENT         TORQUE   LINKS WITHOUT A WEIGHT')
      associate (of => study%designs)
         mass = figures_of(named, [0.0_wp, of%total])
         do k = 1, 3
            loads(:, k) = figures_of(named, [study%before(ranked(k))%rms, (of(i)%loads(ranked(k))%rms, i=1, size(of))])
         end do
      end associate
      call text%add('   BEFORE'//mass(0)//in_a_row(loads(0, :)))
      do k = 1, size(study%designs)
         call text%add(right_column(k, 9)//mass(k)//in_a_row(loads(k, :))//'   '// &
                       list_of_names(study, study%designs(k)%bare_links))
      end do
      if (study%filtered > 0) then
         call text%add(' LEFT OUT, FOR THE JOINT WITH CLEARANCE LOSES CONTACT: '//to_text(study%filtered))
      end if
      if (study%has_clearance) call list_contact(named, study, text)
      if (size(study%designs) == 0) return
      do k = 1, size(study%designs)
         if (allocated(study%designs(k)%conditions)) call list_conditions(named, metre, k, study, text)
      end do
      call text%add()
      call text%add(' DESIGN 1')
      call list_outcome(named, study, study%designs(1), text)
      if (.not. allocated(study%lightest)) return
      call text%add()
      call text%add(' LIGHTEST OF ALL, WITH WEIGHTS ON ANY OF THE LINKS ALLOWED')
      call list_outcome(named, study, study%lightest, text)
   end subroutine list_designs

   !> What the weights of a design satisfy, term by term: mass times distance from the anchor, and the angle.
   subroutine list_conditions(named, metre, design, study, text)
      logical, intent(in) :: named                !! joints have names: a sketch
      real(wp), intent(in) :: metre               !! metres in a unit of length
      integer, intent(in) :: design
      type(balance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(balance_term_t), allocatable :: rows(:)
      character(15), allocatable :: columns(:, :)
      character(:), allocatable :: line
      integer :: k

      rows = terms_of(study, design, metre)
      allocate (columns(size(rows), 2))
      columns(:, 1) = figures_of(named, rows%product, all_count=.true.)
      columns(:, 2) = figures_of(named, rows%angle)
      call text%add()
      call text%add(' CONDITIONS OF DESIGN '//to_text(design)//': MASS TIMES DISTANCE FROM THE ANCHOR, KG AND UNITS OF LENGTH, '// &
                    'AND ANGLE; THE DISTANCE IS FREE')
      call text%add(' WEIGHT ON             ORDER        PRODUCT          ANGLE   WHAT ASKS FOR IT')
      do k = 1, size(rows)
         line = ' '//padded('')//'      '
         if (rows(k)%kind == condition_whole) line = ' '//padded(trim(study%names(rows(k)%body)))// &
                                                     right_column(study%order(rows(k)%body), 6)
         line = line//in_a_row(columns(k, :))//'   '
         select case (rows(k)%kind)
         case (condition_whole)
            line = line//'ALL, WITH THE MASSES OF THE DESIGN'
         case (condition_link)
            line = line//'MASS OF '//trim(study%names(rows(k)%source))
         case default
            line = line//'EACH KG OF THE WEIGHT ON '//trim(study%names(rows(k)%source))
         end select
         call text%add(line)
      end do
   end subroutine list_conditions

   !> Whether shaking force and moment can be balanced together.
   subroutine list_steady(named, study, text)
      logical, intent(in) :: named                !! joints have names: a sketch
      type(balance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text

      call text%add()
      call text%add(' COMPLETE BALANCE OF FORCE AND MOMENT')
      if (.not. study%feasible) then
         call text%add(' IMPOSSIBLE: THE SHAKING FORCE CANNOT BE BALANCED')
      else if (.not. allocated(study%steady)) then
         call text%add(' IMPOSSIBLE: THE SHAKING FORCE CANNOT BE BALANCED WITHIN THE LIMITS OF THE WEIGHTS')
      else
         associate (moment => study%steady%loads(channel_moment)%rms, before => study%before(channel_moment)%rms)
            if (study%is_steady()) then
               call text%add(' POSSIBLE, WITH THESE BODIES')
            else
               call text%add(' IMPOSSIBLE WITHIN THE LIMITS OF THE WEIGHTS; THE LEAST MOMENT WITH THE FORCE BALANCED:')
            end if
            call text%add(' SHAKING MOMENT (RMS) BEFORE'//in_sentence(named, before)//'   AFTER'//in_sentence(named, moment)// &
                          '   NONE IS BELOW'//in_sentence(named, study%steady_bound))
         end associate
         call list_weights(named, study%steady, text)
      end if
   end subroutine list_steady

   !> What becomes of contact in the joint with clearance.
   subroutine list_contact(named, study, text)
      logical, intent(in) :: named                !! joints have names: a sketch
      type(balance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(margins_t), allocatable :: all_margins(:)
      character(80), allocatable :: lines(:)
      integer :: k

      call text%add()
      call text%add(' CONTACT IN THE JOINT WITH CLEARANCE: LEAST H1; LEAST H1 OVER THAT OF A LOSS, BELOW 1 WHERE CONTACT IS LOST')
      call text%add('   DESIGN             H1 OVER PASSAGE       OVER ANY   MINIMA LOST IN THE PASSAGE, LOST')
      all_margins = [study%contact, study%designs%contact]
      if (allocated(study%lightest)) all_margins = [all_margins, study%lightest%contact]
      lines = contact_texts(named, all_margins)
      call text%add('   BEFORE'//trim(lines(1)))
      do k = 1, size(study%designs)
         call text%add(right_column(k, 9)//trim(lines(1 + k)))
      end do
      if (allocated(study%lightest)) call text%add(' LIGHTEST'//trim(lines(size(lines))))
   end subroutine list_contact

   !> Least H1, the ratios to those of a loss, and how many minima lose contact.
   pure function contact_texts(named, margins) result(lines)
      logical, intent(in) :: named                !! joints have names: a sketch
      type(margins_t), intent(in) :: margins(:)
      character(80) :: lines(size(margins))
      character(15) :: columns(size(margins), 3)
      integer :: j, k

      columns(:, 1) = figures_of(named, margins%h1, margins%known .and. margins%h1 < huge(1.0_wp))
      do j = 1, 2
         columns(:, 1 + j) = figures_of(named, margins%over(j), margins%known .and. margins%over(j) < huge(1.0_wp))
         ! without any loss there is no ratio
         where (margins%known .and. .not. margins%over(j) < huge(1.0_wp)) columns(:, 1 + j) = '        NO LOSS'
      end do
      do k = 1, size(margins)
         lines(k) = '   CANNOT BE STUDIED; BRIDGE SAYS WHY'
         if (margins(k)%known) lines(k) = in_a_row(columns(k, :))//'   '//to_text(margins(k)%lost(1))//', '// &
                                          to_text(margins(k)%lost(2))
      end do
   end function contact_texts

   !> Weights, the bound of their mass, and loads before and after.
   subroutine list_outcome(named, study, outcome, text)
      logical, intent(in) :: named                !! joints have names: a sketch
      type(balance_study_t), intent(in) :: study
      type(outcome_t), intent(in) :: outcome
      type(text_t), intent(inout) :: text

      call list_weights(named, outcome, text)
      call text%add(' SUM OF MASSES'//in_sentence(named, outcome%total)//'   NONE ON THESE LINKS IS BELOW'// &
                    in_sentence(named, outcome%bound)//'   DUALITY GAP'//error_words(named, outcome%gap)//'   RESIDUAL'// &
                    error_words(named, outcome%residual))
      call list_loads(named, study, outcome, text)
   end subroutine list_outcome

   subroutine list_weights(named, outcome, text)
      logical, intent(in) :: named                !! joints have names: a sketch
      type(outcome_t), intent(in) :: outcome
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      character(15) :: columns(size(outcome%weights), 7)
      logical :: discs, bodies, raised
      integer :: k

      associate (of => outcome%weights)
         columns(:, 1) = figures_of(named, of%mass, all_count=.true.)
         columns(:, 2) = figures_of(named, of%distance)
         columns(:, 3) = figures_of(named, of%angle)
         columns(:, 4) = figures_of(named, of%radius)
         columns(:, 5) = figures_of(named, of%thickness)
         columns(:, 6) = figures_of(named, of%inertia, all_count=.true.)
         columns(:, 7) = figures_of(named, of%height)
      end associate
      discs = any(outcome%weights%thickness > 0.0_wp)
      bodies = any(outcome%weights%inertia > 0.0_wp) .and. .not. discs
      raised = any(abs(outcome%weights%height) > 0.0_wp)
      line = ' WEIGHT ON                      MASS       DISTANCE          ANGLE'
      if (discs) line = line//'         RADIUS      THICKNESS'
      if (bodies) line = line//'   OWN INERTIA'
      if (raised) line = line//'         HEIGHT'
      call text%add(line)
      do k = 1, size(outcome%weights)
         line = ' '//padded(outcome%weights(k)%link)//in_a_row(columns(k, :3))
         if (discs) line = line//in_a_row(columns(k, 4:5))
         if (bodies) line = line//columns(k, 6)
         if (raised) line = line//columns(k, 7)
         call text%add(line)
      end do
      if (size(outcome%weights) == 0) call text%add(' NO WEIGHT AT ALL')
   end subroutine list_weights

   subroutine list_loads(named, study, outcome, text)
      logical, intent(in) :: named                !! joints have names: a sketch
      type(balance_study_t), intent(in) :: study
      type(outcome_t), intent(in) :: outcome
      type(text_t), intent(inout) :: text
      character(15) :: values(size(study%channels), 4)
      integer :: k, last

      last = size(values, 1) - merge(1, 0, study%tilts)
      associate (before => study%before, after => outcome%loads)
         ! forces of the joints have one unit and one number of decimals
         do k = 1, size(values, 1)
            if (k > channel_torque) exit
            values(k, :) = figures_of(named, [before(k)%rms, after(k)%rms, before(k)%peak, after(k)%peak])
         end do
         values(k:last, :) = reshape(figures_of(named, [before(k:last)%rms, after(k:last)%rms, before(k:last)%peak, &
                                                        after(k:last)%peak]), [last - k + 1, size(values, 2)])
         if (study%tilts) values(last + 1, :) = figures_of(named, [before(last + 1)%rms, after(last + 1)%rms, &
                                                                   before(last + 1)%peak, after(last + 1)%peak])
      end associate
      call text%add(' LOADS                    RMS BEFORE          AFTER    PEAK BEFORE          AFTER')
      do k = 1, size(study%channels)
         call text%add(' '//padded(study%channels(k)%name)//in_a_row(values(k, :)))
      end do
   end subroutine list_loads

   subroutine list_budgets(named, study, text)
      logical, intent(in) :: named                !! joints have names: a sketch
      type(balance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(15) :: columns(size(study%budgets), 4)
      integer :: k

      call text%add()
      call text%add(' LEAST SHAKING FORCE FOR A MASS (RMS)')
      call text%add('           MASS          FORCE    LOWER BOUND    MASS NEEDED')
      associate (of => study%budgets)
         columns = columns_of(named, of%second, of%first, of%bound, of%total)
      end associate
      do k = 1, size(study%budgets)
         call text%add(in_a_row(columns(k, :)))
      end do
   end subroutine list_budgets

   subroutine list_optimum(named, group, study, text)
      logical, intent(in) :: named                !! joints have names: a sketch
      type(balance_group_t), intent(in) :: group
      type(balance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(15) :: limits(2)
      character(80) :: contact(1)
      integer :: k

      call text%add()
      if (.not. group%counts_loads()) then
         call text%add(' LEAST ADDED MASS, KG, WITHIN THE LIMITS OF LOADS')
      else if (group%peaks) then
         call text%add(' LEAST COMPOSITE: THE GREATEST VALUE OVER ITS TOLERANCE')
      else
         call text%add(' LEAST COMPOSITE: SUM OF SQUARES OF ALL VALUES OVER THEIR TOLERANCES')
      end if
      if (.not. study%found%found) then
         call text%add(' THERE ARE NO SUCH WEIGHTS WITHIN THE LIMITS')
         return
      end if
      associate (found => study%found)
         call text%add(' BEFORE'//in_sentence(named, study%composite)//'   AFTER'//in_sentence(named, found%value)// &
                       '   LOWER BOUND'//in_sentence(named, found%bound))
         if (found%convex) then
            call text%add(' GLOBAL OPTIMUM OF A CONVEX PROBLEM: DUALITY GAP'//error_words(named, found%gap)//'   RESIDUAL'// &
                          error_words(named, found%residual))
         else if (found%proven) then
            call text%add(' GLOBAL OPTIMUM: IT REACHES THE LOWER BOUND OF A CONVEX PROBLEM THAT CONTAINS THIS ONE; FOUND AT '// &
                          'START '//to_text(found%starts))
         else
            call text%add(' LOCAL OPTIMUM, THE BEST OF '//to_text(found%starts)//' STARTS, '//to_text(found%ended_here)// &
                          ' OF WHICH ENDED SO LOW; NONE CAN GET BELOW THE BOUND')
         end if
         if (group%form == form_body) then
            call text%add(' OWN INERTIA IS THAT OF THE BODY ABOUT ITS CENTRE OF MASS')
         end if
      end associate
      call list_weights(named, study%optimum, text)
      call text%add(' SUM OF MASSES'//in_sentence(named, study%optimum%total))
      if (group%desired) call text%add(' THE COMPOSITE IS OF DIFFERENCES FROM DESIRED VALUES, LOADS ARE LISTED AS THEY ARE')
      call list_loads(named, study, study%optimum, text)
      if (study%has_clearance) then
         contact = contact_texts(named, [study%optimum%contact])
         call text%add(' CONTACT, AS ABOVE'//trim(contact(1)))
      end if
      if (.not. allocated(study%limited)) return
      associate (of => study%limited)
         call text%add(' LIMITS OF LOADS                GREATEST          LIMIT')
         do k = 1, size(of)
            limits = figures_of(named, [study%optimum%loads(of(k))%peak, study%limit(k)])
            call text%add(' '//padded(study%channels(of(k))%name)//in_a_row(limits))
         end do
      end associate
   end subroutine list_optimum

   subroutine list_front(named, group, study, text)
      logical, intent(in) :: named                !! joints have names: a sketch
      type(balance_group_t), intent(in) :: group
      type(balance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(15) :: columns(size(study%front), 4)
      integer :: k

      associate (of => group%front_of)
         call text%add()
         call text%add(' FRONT OF '//trim(measure_names(of(1)))//' AND '//trim(measure_names(of(2)))// &
                       ' (RMS, BODIES OF ANY SHAPE): NEITHER CAN BE LESS WITHOUT MORE OF THE OTHER')
         call text%add(repeat(' ', 9)//measure_names(of(1))//repeat(' ', 9)//measure_names(of(2))//'    LOWER BOUND    MASS NEEDED')
      end associate
      associate (of => study%front)
         columns = columns_of(named, of%first, of%second, of%bound, of%total)
      end associate
      do k = 1, size(study%front)
         call text%add(in_a_row(columns(k, :)))
      end do
   end subroutine list_front

   !> Four columns, each with its own number of decimals.
   pure function columns_of(named, first, second, third, fourth) result(columns)
      logical, intent(in) :: named                !! joints have names: a sketch
      real(wp), intent(in) :: first(:), second(:), third(:), fourth(:) !! one shape
      character(15) :: columns(size(first), 4)

      columns(:, 1) = figures_of(named, first)
      columns(:, 2) = figures_of(named, second)
      columns(:, 3) = figures_of(named, third)
      columns(:, 4) = figures_of(named, fourth)
   end function columns_of
end module psalm_balance_list
