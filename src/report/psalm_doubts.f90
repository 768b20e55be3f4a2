!> What is no violation and yet makes a result doubtful; and where the joints are, by which a wrong assembly is seen.
module psalm_doubts
   use psalm_angles, only: nearest_difference
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, motion_t
   use psalm_kinds, only: wp, full_turn
   use psalm_text, only: text_t, fixed, general, lower_case, to_text
   use psalm_topology, only: topology_t, dimensions_t, variable_t, name_of, arc_crank, arc_link, variable_length
   implicit none (type, external)
   private
   public :: find_doubts, list_reference_joints

   real(wp), parameter :: least_ratio = 1.0e-3_wp  !! of a link to the longest arc, below which it is practically none
   real(wp), parameter :: at_rest = 1.0e-9_wp      !! of the size: an output that moves less does not move
   integer, parameter :: column = 14               !! width of a co-ordinate
   integer, parameter :: most_named = 3            !! links named in one remark

contains

   !> Append a remark for each doubt, each beginning with `head`.
   subroutine find_doubts(head, topology, problem, dimensions, motion, notes)
      character(*), intent(in) :: head             !! file and title
      type(topology_t), intent(in) :: topology
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(in) :: motion
      type(text_t), intent(inout) :: notes

      call find_short_links(head, topology, dimensions, notes)
      call find_rest(head, problem, dimensions, motion, notes)
   end subroutine find_doubts

   !> Moving links of practically no length. A guide may have none.
   subroutine find_short_links(head, topology, dimensions, notes)
      character(*), intent(in) :: head
      type(topology_t), intent(in) :: topology
      type(dimensions_t), intent(in) :: dimensions
      type(text_t), intent(inout) :: notes
      character(:), allocatable :: names
      real(wp) :: longest
      integer :: loop, a, n, guide, found

      longest = maxval(dimensions%arcl)
      names = ''
      found = 0
      do loop = 1, topology%nloop
         guide = 0
         if (topology%joint(loop) == 2) guide = topology%larcx(2, loop)
         if (topology%joint(loop) == 3) guide = topology%larcx(1, loop)
         do a = 1, topology%loopl(loop)
            n = topology%seq(loop, a)
            if (topology%arcs(n)%kind /= arc_link .and. topology%arcs(n)%kind /= arc_crank) cycle
            if (a == guide .or. dimensions%arcl(n) >= least_ratio*longest) cycle
            ! a crank without length may carry a guide
            if (dimensions%arcl(n) <= 0.0_wp .and. topology%arcs(n)%kind == arc_crank) cycle
            found = found + 1
            if (found > 1 .and. found <= most_named) names = names//', '
            if (found <= most_named) names = names//lower_case(name_of(variable_t(variable_length, loop, a)))//' is '// &
                                             trim(adjustl(general(dimensions%arcl(n), 'E')))
         end do
      end do
      if (found == 0) return
      if (found > most_named) names = names//' and '//to_text(found - most_named)//' more'
      call notes%add(head//'a link of practically no length (the longest arc is '//trim(adjustl(general(longest, 'E')))//'): '// &
                     names//'; limit the lengths (LIMVAL, OPLOW, OPHIGH) if this is not meant')
   end subroutine find_short_links

   !> An output that stays where it is while the input moves.
   subroutine find_rest(head, problem, dimensions, motion, notes)
      character(*), intent(in) :: head
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(motion_t), intent(in) :: motion
      type(text_t), intent(inout) :: notes
      real(wp) :: away
      integer :: i, c, first
      logical :: input_moves

      first = findloc(motion%closed, .true., dim=1)
      if (first == 0) return
      input_moves = .false.
      do i = first + 1, size(motion%closed)
         if (.not. motion%closed(i)) cycle
         if (motion%input(i) /= motion%input(first)) input_moves = .true.
         do c = 1, size(motion%actual, 2)
            away = abs(motion%actual(i, c) - motion%actual(first, c))/maxval(dimensions%arcl)
            if (c == problem%output%kind%angle) &
               away = abs(nearest_difference(motion%actual(i, c), motion%actual(first, c)))/full_turn
            if (away > at_rest) return
         end do
      end do
      if (input_moves) call notes%add(head//'the output does not move: NOUTLK and NOUTLP name an arc or a joint at rest')
   end subroutine find_rest

   !> Append where the joint of the two undetermined arcs of every loop is at the reference position.
   subroutine list_reference_joints(set, problem, dimensions, text)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(text_t), intent(inout) :: text
      type(problem_t) :: at_reference
      integer, allocatable :: joints(:, :)
      integer :: loop, block, n

      associate (topology => problem%topology)
         allocate (joints(2, topology%nloop))
         do loop = 1, topology%nloop
            joints(:, loop) = [loop, topology%larcx(1, loop)]
         end do
         at_reference%topology = topology
         at_reference%given = dimensions
         at_reference%motion = set%motion
         at_reference%tangle = problem%tangle
         at_reference%delt = [0.0_wp]
         call at_reference%want_derivatives(everything=.true., joints=joints)
         call at_reference%set_inputs([0.0_wp])
         call at_reference%bind(dimensions)
         call at_reference%solve_block(1, block, n)
         call text%add(' JOINT OF THE UNDETERMINED ARCS OF EACH LOOP AT THE REFERENCE INPUT (X,Y)')
         do loop = 1, topology%nloop
            if (.not. at_reference%linkage%closes(1, loop)) then
               call text%add(' LOOP '//to_text(loop)//' DOES NOT CLOSE AT THE REFERENCE INPUT')
               return
            end if
            associate (link => at_reference%linkage, point => at_reference%plan%joint_points(loop))
               call text%add(' LOOP '//to_text(loop)//', ARCS '//to_text(topology%larcx(1, loop))//' AND '// &
                             to_text(topology%larcx(2, loop))//'  '// &
                             fixed(link%store%v(1, link%point_x(point))/link%scale + at_reference%output%origin_x, column, 4)// &
                             fixed(link%store%v(1, link%point_y(point))/link%scale + at_reference%output%origin_y, column, 4))
            end associate
         end do
      end associate
   end subroutine list_reference_joints
end module psalm_doubts
