!> What is proven of the motion of a sketch in the poses of its links, in the listing and on device 9.
module psalm_chain_proof_list
   use psalm_column_names, only: input_unit
   use psalm_chain_proof_study, only: chain_proof_t, place_on, place_of_extreme
   use psalm_chain_study, only: chain_study_t
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_markup, only: strings_t, add_string
   use psalm_number_format, only: number_format_t, format_of
   use psalm_part_columns, only: add_words
   use psalm_proof_chain, only: output_range_t
   use psalm_proof_list, only: about_extremes, about_limits, list_dead_points, list_dwell, list_kept, list_range, &
                               put_dead_points, put_kept, same_quantity, shown, head_of_ranges, end_text, short
   use psalm_proof_motion, only: proven_dead_point_t, quantity_output, quantity_turning
   use psalm_proof_numbers, only: has_rate, is_angle
   use psalm_sketch, only: drive_turns
   use psalm_sketch_outputs, only: name_length
   use psalm_tables, only: table_t, tables_t, table_of
   use psalm_text, only: text_t, cased, to_text
   implicit none (type, external)
   private
   public :: list_chain_proof, put_chain_proof, links_of_group, name_of_quantity, ratio_of

   integer, parameter :: word_length = 10   !! characters of a word in a table
   integer, parameter :: most_parts = 3   !! rows of a segment: it closes, is undecided, is not reached
   character(*), parameter :: of_ratio = 'velocity_ratio_' !! stands before the output's name

contains

   !> The limits of motion.
   subroutine list_chain_proof(set, study, proof, text)
      type(data_set_t), intent(in) :: set
      type(chain_study_t), intent(in) :: study
      type(chain_proof_t), intent(in) :: proof
      type(text_t), intent(inout) :: text
      logical :: turns
      integer :: k

      turns = first_turns(study)
      call text%add()
      if (proof%one_drive) then
         call text%add(' LIMITS OF MOTION, PROVEN FOR INPUTS '//short(proof%from)//' TO '//short(proof%to))
      else
         call text%add(' LIMITS OF MOTION, PROVEN ALONG STRAIGHT LINES OF THE INPUTS BETWEEN THE POSITIONS')
      end if
      if (proof%complete) then
         if (proof%full_turn) then
            call text%add('   CLOSES FOR EVERY INPUT WITHOUT A DEAD POINT; THE INPUT TURNS FULLY')
            call text%add(trim(merge('   AFTER A TURN THE LINKAGE STANDS AS DRAWN              ', &
                                     '   AFTER A TURN THE LINKAGE DOES NOT STAND AS DRAWN AGAIN', proof%returns)))
         else
            call text%add('   CLOSES FOR EVERY INPUT OF THE RANGE WITHOUT A DEAD POINT, AS DRAWN')
         end if
      else
         do k = 1, size(proof%segments)
            if (proof%one_drive) then
               call list_segment(k)
            else
               call list_line(k)
            end if
         end do
      end if
      if (proof%misplaced > 0) call text%add('   '//to_text(proof%misplaced)//' POSITIONS ARE NOT THOSE THIS MOTION LEADS TO')
      call list_ranges(study, proof, turns, text)
      call list_movement(study, proof, turns, text)
      call list_kept(set, proof%kept, text)

   contains

      !> One way of a single drive.
      subroutine list_segment(k)
         integer, intent(in) :: k
         real(wp) :: far
         integer :: way

         far = place_on(proof, k, proof%segments(k)%reached, turns)
         way = merge(-1, 1, proof%segments(k)%to(1) > 0.0_wp)
         call text%add('   CLOSES FROM THE DRAWING TO '//trim(adjustl(end_text(far, way, turns))))
         if (proof%segments(k)%complete) return
         if (proof%segments(k)%turns_back) then
            far = place_on(proof, k, proof%segments(k)%dead_high, turns)
            call text%add('     DEAD POINT OF '//links_of_group(study, proof%group(k), .false.)// &
                          ': THE INPUT GOES NO FURTHER THAN '//trim(adjustl(end_text(far, -way, turns))))
         else
            call text%add('     UNDECIDED BEYOND IT: '//links_of_group(study, proof%group(k), .false.)//' AT OR NEAR A DEAD POINT')
         end if
      end subroutine list_segment

      !> One line of several drives.
      subroutine list_line(k)
         integer, intent(in) :: k

         if (proof%segments(k)%complete) return
         if (proof%segments(k)%turns_back) then
            call text%add('   DEAD POINT ON THE WAY TO POSITION '//to_text(proof%position(k))//', AFTER '// &
                          trim(adjustl(end_text(proof%segments(k)%dead_high, 1, .true.)))//' OF THE WAY AT MOST: '// &
                          links_of_group(study, proof%group(k), .false.))
         else
            call text%add('   UNDECIDED ON THE WAY TO POSITION '//to_text(proof%position(k))//', AFTER '// &
                          trim(adjustl(end_text(proof%segments(k)%reached, -1, .true.)))//' OF THE WAY: '// &
                          links_of_group(study, proof%group(k), .false.)//' AT OR NEAR A DEAD POINT')
         end if
      end subroutine list_line
   end subroutine list_chain_proof

   !> Least and greatest values of the outputs.
   subroutine list_ranges(study, proof, turns, text)
      type(chain_study_t), intent(in) :: study
      type(chain_proof_t), intent(in) :: proof
      logical, intent(in) :: turns
      type(text_t), intent(inout) :: text
      type(number_format_t) :: of_places
      character(:), allocatable :: name
      type(output_range_t), allocatable :: every(:)
      real(wp), allocatable :: places(:, :)
      integer :: i, n

      if (.not. any(proof%ranges%bounded)) return
      allocate (places(2, size(proof%ranges) + size(proof%ratios)), source=0.0_wp)
      every = [proof%ranges, proof%ratios]
      do n = 1, size(every)
         if (every(n)%bounded) places(:, n) = [(place_of_extreme(proof, every(n), i, turns), i=1, 2)]
      end do
      of_places = format_of(.true., pack(places, .true.))
      call text%add(head_of_ranges)
      do n = 1, size(every)
         if (.not. every(n)%bounded) cycle
         if (n <= size(proof%ranges)) then
            name = trim(study%names(n))
         else
            name = ratio_of(study, n - size(proof%ranges), small=.false.)
         end if
         call list_range(name, every(n)%low, every(n)%high, places(:, n), of_places, text)
      end do
   end subroutine list_ranges

   !> The rate of an output by the input, in words.
   pure function ratio_of(study, number, small) result(words)
      type(chain_study_t), intent(in) :: study
      integer, intent(in) :: number            !! of all outputs
      logical, intent(in) :: small             !! small letters, but for names
      character(:), allocatable :: words

      words = cased('VELOCITY RATIO, ', small)//trim(study%names(number))
   end function ratio_of

   !> Strokes of the outputs, dead points, dwells.
   subroutine list_movement(study, proof, turns, text)
      type(chain_study_t), intent(in) :: study
      type(chain_proof_t), intent(in) :: proof
      logical, intent(in) :: turns
      type(text_t), intent(inout) :: text
      character(:), allocatable :: name
      logical :: as_angles
      integer :: n, i, first

      ! numbers of positions are written like angles
      as_angles = turns .or. .not. proof%one_drive
      associate (movement => proof%movement, outputs => study%closure%sketch%outputs)
         do n = 1, size(movement%time_ratio)
            if (.not. has_rate(study%closure%sketch, outputs, n)) cycle
            name = trim(study%names(n))
            if (movement%turns_fully(n)) then
               call text%add('   '//name//' TURNS FULLY')
            else if (is_angle(outputs, n) .and. proof%ranges(n)%bounded) then
               call text%add('   SWING OF '//name//' AT MOST '//shown(proof%ranges(n)%high(2) - proof%ranges(n)%low(1), 1))
            end if
            if (proof%one_drive .and. .not. proof%ratios(n)%bounded) call text%add('   VELOCITY RATIO OF '//name//' NOT BOUNDED')
            if (movement%time_ratio(n) > 0.0_wp) call text%add('   TIME RATIO OF '//name//' AT LEAST '// &
                                                               shown(movement%time_ratio(n), -1))
            do i = 1, size(movement%dwells)
               associate (dwell => movement%dwells(i))
                  if (dwell%number == n) call list_dwell(name, proof%dwell, dwell%at, dwell%from, dwell%to, as_angles, text)
               end associate
            end do
            if (proof%dwell > 0.0_wp .and. .not. any(movement%dead%kind == quantity_output .and. movement%dead%place == n)) &
               call text%add('   NO DWELL: '//name//' HAS NO DEAD POINT')
         end do
         first = 1
         do i = 1, size(movement%dead)
            if (i < size(movement%dead)) then
               if (same_quantity(movement%dead(i), movement%dead(i + 1))) cycle
            end if
            call list_dead_points(name_of_quantity(study, movement%dead(i), small=.false.), movement%dead(first:i), &
                                  as_angles, text)
            first = i + 1
         end do
      end associate
   end subroutine list_movement

   !> What stands still at a dead point.
   pure function name_of_quantity(study, dead, small) result(words)
      type(chain_study_t), intent(in) :: study
      type(proven_dead_point_t), intent(in) :: dead
      logical, intent(in) :: small             !! small letters, but for names
      character(:), allocatable :: words

      associate (sketch => study%closure%sketch)
         select case (dead%kind)
         case (quantity_output)
            words = trim(study%names(dead%place))
         case (quantity_turning)
            words = cased('LINK ', small)//trim(sketch%links(dead%place)%name)//cased(', ITS TURNING', small)
         case default
            words = cased('SLIDE ', small)//trim(sketch%slides(dead%place)%name)//cased(', ITS LENGTH', small)
         end select
      end associate
   end function name_of_quantity

   pure logical function first_turns(study)
      type(chain_study_t), intent(in) :: study

      first_turns = study%closure%sketch%drives(1)%kind == drive_turns
   end function first_turns

   !> The links of a group: `LINKS B C, upper`.
   pure function links_of_group(study, group, small) result(words)
      type(chain_study_t), intent(in) :: study
      integer, intent(in) :: group
      logical, intent(in) :: small                 !! small letters, but for names
      character(:), allocatable :: words
      integer :: k

      words = cased('LINKS', small)
      associate (links => study%closure%groups(group)%links)
         if (size(links) == 1) words = cased('LINK', small)
         do k = 1, size(links)
            words = words//' '//trim(study%closure%sketch%links(links(k))%name)
            if (k < size(links)) words = words//','
         end do
      end associate
   end function links_of_group

   !> Tables: the parts of the range; the brackets of the outputs.
   subroutine put_chain_proof(title, study, proof, tables)
      character(*), intent(in) :: title
      type(chain_study_t), intent(in) :: study
      type(chain_proof_t), intent(in) :: proof
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      type(strings_t), allocatable :: names(:)
      character(word_length), allocatable :: kind(:), cause(:)
      real(wp), allocatable :: from(:), to(:)
      integer, allocatable :: group(:)
      character(:), allocatable :: input
      logical :: turns
      integer :: k, rows

      turns = first_turns(study)
      input = input_unit(.not. turns)
      rows = most_parts*size(proof%segments)
      allocate (kind(rows), cause(rows), from(rows), to(rows), group(rows))
      rows = 0
      do k = 1, size(proof%segments)
         associate (segment => proof%segments(k))
            if (segment%reached > 0.0_wp) call row('closes', 0.0_wp, segment%reached, 0, 'none')
            if (segment%turns_back) then
               call row('undecided', segment%reached, segment%dead_high, proof%group(k), 'dead_point')
               call row('unreached', segment%dead_high, 1.0_wp, proof%group(k), 'dead_point')
            else if (.not. segment%complete) then
               call row('undecided', segment%reached, 1.0_wp, proof%group(k), 'dead_point')
            end if
         end associate
      end do
      table = table_of('limits', about_limits, notes=title)
      call table%add('kind', kind(:rows))
      call table%add('from', from(:rows), input)
      call table%add('to', to(:rows), input)
      call table%add('loop', group(:rows))
      call table%add('cause', cause(:rows))
      allocate (names(rows))
      do k = 1, rows
         names(k)%text = ''
         if (group(k) > 0) names(k)%text = links_of_group(study, group(k), small=.true.)
      end do
      call add_words('group', names, table)
      deallocate (names)
      call tables%put(table)
      if (any(proof%ranges%bounded)) call put_ranges(title, study, proof, turns, tables)
      allocate (names(0))
      do k = 1, size(proof%movement%dead)
         call add_string(names, name_of_quantity(study, proof%movement%dead(k), small=.true.))
      end do
      call put_dead_points(title, proof%movement%dead, names, input, tables)
      call put_kept(title, proof%kept, input, tables)

   contains

      subroutine row(what, first, last, of_group, why)
         character(*), intent(in) :: what, why
         real(wp), intent(in) :: first, last
         integer, intent(in) :: of_group

         rows = rows + 1
         kind(rows) = what
         cause(rows) = why
         from(rows) = place_on(proof, k, first, turns)
         to(rows) = place_on(proof, k, last, turns)
         group(rows) = of_group
      end subroutine row
   end subroutine put_chain_proof

   !> Brackets of the outputs, then of their velocity ratios.
   subroutine put_ranges(title, study, proof, turns, tables)
      character(*), intent(in) :: title
      type(chain_study_t), intent(in) :: study
      type(chain_proof_t), intent(in) :: proof
      logical, intent(in) :: turns
      type(tables_t), intent(inout) :: tables
      type(output_range_t), allocatable :: ranges(:)
      character(len(of_ratio) + name_length), allocatable :: names(:)
      integer, allocatable :: zero(:)
      type(table_t) :: table
      character(:), allocatable :: input
      integer :: n, k

      input = input_unit(.not. turns)
      k = size(proof%ranges)
      n = k + count(proof%ratios%bounded)
      allocate (ranges(n), names(n), zero(n))
      zero = 0
      ranges(:k) = proof%ranges
      names(:k) = study%names
      do n = 1, size(proof%ratios)
         if (.not. proof%ratios(n)%bounded) cycle
         k = k + 1
         ranges(k) = proof%ratios(n)
         names(k) = of_ratio//study%names(n)
      end do
      table = table_of('extremes', about_extremes, notes=title)
      call table%add('quantity', names)
      call table%add('loop', zero)
      call table%add('arc', zero)
      call table%add('least_low', [(ranges(n)%low(1), n=1, size(ranges))], known=ranges%bounded)
      call table%add('least_high', [(ranges(n)%high(1), n=1, size(ranges))], known=ranges%bounded)
      call table%add('least_at', places(1), input, ranges%bounded)
      call table%add('greatest_low', [(ranges(n)%low(2), n=1, size(ranges))], known=ranges%bounded)
      call table%add('greatest_high', [(ranges(n)%high(2), n=1, size(ranges))], known=ranges%bounded)
      call table%add('greatest_at', places(2), input, ranges%bounded)
      call tables%put(table)

   contains

      !> Where the least or the greatest values are.
      function places(which)
         integer, intent(in) :: which
         real(wp) :: places(size(ranges))
         integer :: i

         places = 0.0_wp
         do i = 1, size(places)
            if (ranges(i)%bounded) places(i) = place_of_extreme(proof, ranges(i), which, turns)
         end do
      end function places
   end subroutine put_ranges
end module psalm_chain_proof_list
