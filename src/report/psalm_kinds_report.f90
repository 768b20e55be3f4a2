!> Kinds of linkages in the listing: which there are, what a search found of each, the choice between the best.
module psalm_kinds_report
   use psalm_chain_graphs, only: joint_none, joint_slide, joint_driven_pin, joint_driven_slide, joint_gear
   use psalm_columns, only: left_column, right_column
   use psalm_data_set, only: data_set_t, title_columns
   use psalm_devices, only: devices_t
   use psalm_kind_choice, only: choice_t, unbeaten_choices, proven_unknown, proven_closes
   use psalm_kind_search, only: kind_study_t, kinds_exact, kinds_patient, kinds_all, kinds_time, kinds_request
   use psalm_kind_sketch, only: draw_neatly
   use psalm_kinds, only: wp
   use psalm_sketch_text, only: variant_t, variant_of, write_sketch
   use psalm_kinds_group, only: kinds_group_t, kinds_of, weighable
   use psalm_linkage_kinds, only: linkage_kind_t
   use psalm_number_format, only: figures_of, in_a_row
   use psalm_tables, only: table_t, tables_t, table_of
   use psalm_text, only: rank_column, to_text, upper_case
   implicit none (type, external)
   private
   public :: report_kinds, report_choice, put_kinds

   integer, parameter :: name_column = 34       !! at least
   integer, parameter :: atlas_step = 10        !! degrees between the positions of a neat sketch
   real(wp), parameter :: none_found = huge(1.0_wp)

contains

   !> Every kind and its joints: pins 3-4, slides 3=4, the drive marked by a star. Device 7 has each as a neat sketch.
   subroutine report_kinds(set, kinds, devices)
      type(data_set_t), intent(in) :: set
      type(linkage_kind_t), intent(in) :: kinds(:)
      type(devices_t), intent(inout) :: devices
      type(variant_t) :: variant
      character(:), allocatable :: gears
      integer :: k, width

      width = max(name_column, 2 + maxval([0, len_trim(kinds%name)]))
      gears = ''
      if (any(kinds%arm > 0)) gears = ': GEARS (THE ARM), '
      call devices%six%add(' '//trim(set%title))
      call devices%six%add(' KINDS OF LINKAGES: '//to_text(size(kinds)))
      call devices%six%add('  RANK   LINKS SLIDES GROUPS LARGEST   KIND'//repeat(' ', width - 4)// &
                           'LINK 1 IS THE FRAME; - A PIN, = A SLIDE, '//gears//'* THE DRIVE, P THE OUTPUT')
      do k = 1, size(kinds)
         associate (one => kinds(k))
            call devices%six%add(rank_column(k)//right_column(one%graph%n, 8)//right_column(one%slides, 7)// &
                                 right_column(one%groups, 7)//right_column(one%largest_group, 8)//'   '// &
                                 left_column(trim(one%name), width)//words_of_joints(one))
         end associate
      end do
      variant = variant_of(set)
      variant%ikin = atlas_step
      variant%with_others = .false.
      do k = 1, size(kinds)
         variant%title = trim(set%title)//': '//trim(kinds(k)%name)
         call draw_neatly(kinds(k), output_of(set), variant%sketch)
         variant%last = merge(1, 0, k == size(kinds))
         call write_sketch(set, devices%seven, variant)
      end do
   end subroutine report_kinds

   !> What the output is, one of `kind_of_...`.
   integer function output_of(set)
      type(data_set_t), intent(in) :: set
      type(kinds_group_t) :: asked

      asked = kinds_of(set)
      output_of = asked%output
   end function output_of

   !> Joints of a kind in words, the frame numbered first and the driven link next.
   pure function words_of_joints(kind) result(words)
      type(linkage_kind_t), intent(in) :: kind
      character(:), allocatable :: words
      integer :: number(kind%graph%n), a, b, next

      number = 0
      number(kind%frame) = 1
      next = 1
      if (kind%base /= kind%frame) then
         next = next + 1
         number(kind%base) = next
      end if
      next = next + 1
      number(kind%driven) = next
      do a = 1, size(number)
         if (number(a) > 0) cycle
         next = next + 1
         number(a) = next
      end do
      words = ''
      do a = 1, size(number)
         do b = a + 1, size(number)
            words = words//joint(findloc(number, a, dim=1), findloc(number, b, dim=1), a, b)
         end do
      end do
      words = words//' P ON '//to_text(number(kind%output))

   contains

      pure function joint(x, y, i, j) result(text)
         integer, intent(in) :: x, y, i, j        !! links, their numbers here
         character(:), allocatable :: text

         select case (kind%graph%joint(x, y))
         case (joint_none)
            text = ''
            return
         case (joint_slide)
            text = '='
         case (joint_driven_pin)
            text = '*-'
         case (joint_driven_slide)
            text = '*='
         case (joint_gear)
            text = to_text(i)//':'//to_text(j)//'('//to_text(number(kind%arm))//') '
            return
         case default
            text = '-'
         end select
         text = to_text(i)//text//to_text(j)//' '
      end function joint
   end function words_of_joints

   !> What the search found, kind by kind, the best first; how it ended, and what more time would bring.
   subroutine report_choice(set, study, choices, devices)
      type(data_set_t), intent(in) :: set
      class(kind_study_t), intent(in) :: study
      type(choice_t), intent(in) :: choices(:)     !! shape (cases of the study)
      type(devices_t), intent(inout) :: devices
      type(kinds_group_t) :: asked
      logical :: left(size(study%kinds)), best(size(choices))
      character(:), allocatable :: line
      character(15) :: objective(size(study%kinds)), columns(size(choices), 7)
      integer :: place, k

      asked = kinds_of(set)
      call devices%six%add(' '//trim(set%title))
      call devices%six%add(' SEARCH AMONG '//to_text(size(study%kinds))//' KINDS OF LINKAGES, '// &
                           to_text(sum(study%looked%assemblies))//' ASSEMBLIES OF THEM, '//to_text(sum(study%looked%starts))// &
                           ' STARTS IN '//to_text(study%rounds)//' ROUNDS')
      call devices%six%add(' PLACE      OBJECTIVE   LINKS SLIDES ASSEMBLIES  STARTS  HITS   KIND')
      objective = figures_of(.true., study%looked%best, study%looked%best < none_found, all_count=.true.)
      left = .true.
      do place = 1, size(left)
         k = minloc(study%looked%best, dim=1, mask=left)
         left(k) = .false.
         associate (one => study%looked(k))
            if (one%best >= none_found) objective(k) = '              -'
            call devices%six%add(rank_column(place)//objective(k)//right_column(study%kinds(k)%graph%n, 8)// &
                                 right_column(study%kinds(k)%slides, 7)// &
                                 right_column(one%assemblies, 11)//right_column(one%starts, 8)//right_column(one%hits, 6)//'   '// &
                                 trim(study%kinds(k)%name)//trim(merge(' (ITS LOOPS COULD NOT BE TRACED)', repeat(' ', 32), &
                                                                       .not. one%drawn)))
         end associate
      end do
      call devices%six%add(' HITS: STARTS OF ITS BEST ASSEMBLY THAT CAME TO ITS BEST LINKAGE, BUT FOR A HUNDREDTH OF THE OBJECTIVE')
      call devices%six%add(' '//upper_case(how_ended(set, study)))
      if (any(study%looked%best < none_found)) call devices%six%add(' '//upper_case(what_more_would_bring(study)))
      call devices%remark(set, how_ended(set, study))
      if (any(study%looked%best < none_found)) call devices%remark(set, what_more_would_bring(study))
      if (size(choices) == 0) then
         call devices%remark(set, 'no kind led to a linkage that obeys all limits')
         call devices%note_violation()
         return
      end if
      call devices%six%add()
      call devices%six%add(' CHOICE (DEVICE 7 HAS THEM ALL)')
      call devices%six%add(' PLACE      RMS ERROR  LARGEST ERROR  TRANSM. ANGLE LONGEST/SHORT.     ROOM WIDTH    ROOM HEIGHT'// &
                           ' SUM OF LENGTHS   LINKS JOINTS   CRANK      PROVEN     KIND')
      best = unbeaten_choices(choices, asked%weighed)
      associate (of => choices%is)
         columns(:, 1) = figures_of(.true., of%rms, all_count=.true.)
         columns(:, 2) = figures_of(.true., of%largest, all_count=.true.)
         columns(:, 3) = figures_of(.true., of%angle, of%has_angle)
         where (.not. of%has_angle) columns(:, 3) = '              -'
         columns(:, 4) = figures_of(.true., of%ratio)
         columns(:, 5) = figures_of(.true., of%width)
         columns(:, 6) = figures_of(.true., of%height)
         columns(:, 7) = figures_of(.true., choices%length)
      end associate
      do k = 1, size(choices)
         associate (one => choices(k), is => choices(k)%is)
            line = rank_column(k)//in_a_row(columns(k, :))//right_column(one%links, 8)//right_column(one%joints, 7)//'   '
            if (is%sliding_input) then
               line = line//'    -     '
            else
               line = line//merge('TURNS     ', 'DOES NOT  ', is%turns)
            end if
            if (one%proof == proven_unknown) then
               line = line//'     -     '
            else
               line = line//merge(' YES       ', ' NO        ', one%proof == proven_closes)
            end if
            associate (title => study%sets(k)%title)
               call devices%six%add(line//merge('* ', '  ', best(k))//title(index(title, ': ', back=.true.) + 2:))
            end associate
         end associate
      end do
      call devices%six%add(' * NONE OF THEM IS BEATEN IN BOTH '//trim(weighable(asked%weighed(1)))//' AND '// &
                           trim(weighable(asked%weighed(2)))//' (WEIGH)')
      call devices%six%add(' PROVEN: THE LINKAGE CLOSES OVER THE FULL TURN, OR OVER THE INPUTS IF THE CRANK DOES NOT TURN; '// &
                           'SUM OF LENGTHS: OF ALL MOVING LINKS')
   end subroutine report_choice

   !> Tables: what the search found of each kind, and the best linkages.
   subroutine put_kinds(study, choices, tables)
      class(kind_study_t), intent(in) :: study
      type(choice_t), intent(in) :: choices(:)     !! shape (cases of the study)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(title_columns) :: names(size(choices))
      integer :: k

      table = table_of('found', 'a row for each linkage found, the best first')
      do k = 1, size(names)
         names(k) = study%sets(k)%title(index(study%sets(k)%title, ': ', back=.true.) + 2:)
      end do
      call table%add('rank', [(k, k=1, size(choices))])
      call table%add('kind', names)
      call table%add('rms_error', choices%is%rms)
      call table%add('largest_error', choices%is%largest)
      call table%add('transmission_angle', choices%is%angle, 'deg', choices%is%has_angle)
      call table%add('ratio_of_lengths', choices%is%ratio)
      call table%add('width', choices%is%width, 'length')
      call table%add('height', choices%is%height, 'length')
      call table%add('length', choices%length, 'length')
      call table%add('links', choices%links)
      call table%add('joints', choices%joints)
      call table%add('turns', choices%is%turns, .not. choices%is%sliding_input)
      call table%add('proven', choices%proof == proven_closes, choices%proof /= proven_unknown)
      call tables%put(table)
      table = table_of('kinds', 'a row for each kind of linkage')
      associate (kinds => study%kinds, looked => study%looked)
         call table%add('kind', [character(len(kinds%name)) :: (kinds(k)%name, k=1, size(kinds))])
         call table%add('links', [(kinds(k)%graph%n, k=1, size(kinds))])
         call table%add('slides', kinds%slides)
         call table%add('objective', looked%best, known=looked%best < none_found)
         call table%add('assemblies', looked%assemblies)
         call table%add('starts', looked%starts)
         call table%add('hits', looked%hits)
      end associate
      call tables%put(table)
   end subroutine put_kinds

   function how_ended(set, study) result(words)
      type(data_set_t), intent(in) :: set
      class(kind_study_t), intent(in) :: study
      character(:), allocatable :: words

      select case (study%ending)
      case (kinds_exact)
         words = 'the search ended because a linkage does exactly what is wanted'
      case (kinds_patient)
         words = 'the search ended because its last rounds brought nothing better (PATNCE)'
      case (kinds_all)
         words = 'the search ended because every kind had its starts (NSTART='//to_text(set%search%nstart)//')'
      case (kinds_time)
         words = 'the search ended because its time was over (MAXTIME)'
      case (kinds_request)
         words = 'the search was ended on request'
      case default
         words = 'there is no kind to search'
      end select
   end function how_ended

   !> Starts are drawn alike: a linkage that one of n starts found is as likely beaten by the next n as not; each further start that
   !> found it halves that chance.
   function what_more_would_bring(study) result(words)
      class(kind_study_t), intent(in) :: study
      character(:), allocatable :: words
      integer, parameter :: sure = 7
      integer :: k, unseen

      k = minloc(study%looked%best, dim=1)
      associate (one => study%looked(k))
         if (one%hits >= sure) then
            words = 'the best linkage was found by '//to_text(one%hits)//' starts: as much time again would hardly bring a '// &
                    'better one of its kind'
         else
            words = 'the best linkage was found by '//to_text(max(1, one%hits))//' of its starts: as much time again brings a '// &
                    'better one of its kind with a chance of about 1 in '//to_text(2**max(1, one%hits))
         end if
      end associate
      unseen = count(study%looked%assemblies == 0)
      if (unseen > 0) words = words//'; '//to_text(unseen)//' kinds were not examined'
   end function what_more_would_bring
end module psalm_kinds_report
