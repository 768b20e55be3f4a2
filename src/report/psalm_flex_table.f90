!> Tables of links of beam elements.
module psalm_flex_table
   use psalm_data_set, only: data_set_t
   use psalm_drive_links_study, only: drive_links_t
   use psalm_flex_list, only: flexible_name
   use psalm_flex_study, only: flex_study_t, stress_kinds
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: lower_case
   use psalm_vibration_list, only: coupled_words
   implicit none (type, external)
   private
   public :: put_flexible, put_together

   integer, parameter :: name_length = 80              !! characters of a word in a table

contains

   !> Tables flexible_links, flexible_modes, flexible_out_of_plane, flexible_modes_out_of_plane, flexible_segments,
   !> flexible_joints, flexible_stresses, flexible_shapes.
   subroutine put_flexible(set, mechanism, studies, tables)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(flex_study_t), intent(in) :: studies(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length) :: names(size(studies)), words(size(studies))
      logical :: followed(size(studies))
      integer :: k, j

      do k = 1, size(studies)
         followed(k) = studies(k)%solved_modes > 0 .and. .not. studies(k)%coupled%grows_too_much
         names(k) = flexible_name(set, studies(k))
         words(k) = ''
         if (studies(k)%solved) words(k) = lower_case(coupled_words(studies(k)%coupled))
      end do
      table = table_of('flexible_links', 'a row for each link of beam elements', audience=for_programs)
      associate (solved => studies%solved)
         call table%add('link', names)
         call table%add('mass', [(studies(k)%link%own(1), k=1, size(studies))], 'kg')
         call table%add('elements', [(size(studies(k)%link%frame%elements), k=1, size(studies))])
         call table%add('verdict', words)
         call table%add('steady', studies%steady)
         call table%add('multiplier', [(largest(studies(k)), k=1, size(studies))], known=followed)
         call table%add('modes_solved', studies%solved_modes, known=solved)
         call table%add('matrix_error', [(studies(k)%coupled%error, k=1, size(studies))], known=followed)
         call table%add('least_stiffness', studies%least_stiffness, known=solved)
         call table%add('least_stiffness_at', studies%least_at, 'deg', solved)
         call table%add('driven_from', [(studies(k)%driven(1), k=1, size(studies))], 'rad/s', solved)
         call table%add('driven_to', [(studies(k)%driven(2), k=1, size(studies))], 'rad/s', solved)
         call table%add('unbalanced', studies%equilibrium, known=solved)
      end associate
      call tables%put(table)
      table = table_of('flexible_modes', 'a row for each natural mode of a link at rest', audience=for_programs)
      call table%add('link', repeated(names, [(size(studies(k)%frequency), k=1, size(studies))]))
      call table%add('mode', [((j, j=1, size(studies(k)%frequency)), k=1, size(studies))])
      call table%add('frequency', [(studies(k)%frequency, k=1, size(studies))], 'rad/s')
      call table%add('damping', [(studies(k)%damping, k=1, size(studies))])
      call tables%put(table)
      call put_out_of_plane(studies, names, tables)
      call put_over_turn(studies, names, tables)
      call put_segments(studies, names, tables)
      call put_joints(mechanism, studies, names, tables)
      call put_turn(studies, tables)
      call put_shapes(studies, tables)
   end subroutine put_flexible

   pure real(wp) function largest(study)
      type(flex_study_t), intent(in) :: study

      largest = 0.0_wp
      if (study%solved_modes > 0) largest = abs(study%coupled%multipliers(1))
   end function largest

   !> Each name so many times.
   pure function repeated(names, times) result(all)
      character(*), intent(in) :: names(:)
      integer, intent(in) :: times(:)            !! the same shape
      character(name_length) :: all(sum(times))
      integer :: k, n

      n = 0
      do k = 1, size(names)
         all(n + 1:n + times(k)) = names(k)
         n = n + times(k)
      end do
   end function repeated

   !> Tables drive_links, drive_link_multipliers, drive_link_modes, drive_link_harmonics.
   subroutine put_together(set, studies, together, rigid, tables)
      type(data_set_t), intent(in) :: set
      type(flex_study_t), intent(in) :: studies(:)
      type(drive_links_t), intent(in) :: together
      real(wp), intent(in) :: rigid                !! greatest swing with rigid links, rad
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length) :: names(together%modes), words(1)
      integer :: n
      logical :: unique(1), followed

      unique = together%coupled%unique
      followed = together%possible .and. .not. together%coupled%grows_too_much
      words = 'not solved'
      if (together%possible) words = lower_case(coupled_words(together%coupled))
      table = table_of('drive_links', 'one row: drive and links together', audience=for_programs)
      call table%add('verdict', words)
      call table%add('modes', [together%modes])
      call table%add('stable', [together%coupled%stable])
      call table%add('matrix_error', [together%coupled%error], known=[followed])
      call table%add('greatest_swing', [together%greatest], 'rad', unique)
      call table%add('greatest_swing_of_rigid_links', [rigid], 'rad')
      call tables%put(table)
      if (.not. followed) return
      table = table_of('drive_link_multipliers', 'a row for each multiplier of drive and links together', audience=for_programs)
      call table%add('re', real(together%coupled%multipliers, wp))
      call table%add('im', aimag(together%coupled%multipliers))
      call tables%put(table)
      if (.not. together%coupled%unique) return
      do n = 1, together%modes
         names(n) = flexible_name(set, studies(together%links(n)))
      end do
      table = table_of('drive_link_modes', 'a row for each mode: greatest displacement, together and with a rigid drive', &
                       audience=for_programs)
      call table%add('link', names)
      call table%add('mode', [(count(together%links(:n) == together%links(n)), n=1, together%modes)])
      call table%add('moved', together%peaks, 'm')
      call table%add('moved_of_rigid_drive', together%rigid_drive, 'm')
      call tables%put(table)
      table = table_of('drive_link_harmonics', 'a row for each harmonic of the swing of the crank', audience=for_programs)
      call table%add('n', [(n, n=0, ubound(together%swing, 1))])
      call table%add('swing', together%swing, 'rad')
      call tables%put(table)
   end subroutine put_together

   !> Frequencies of links with a slide over the turn.
   subroutine put_over_turn(studies, names, tables)
      type(flex_study_t), intent(in) :: studies(:)
      character(*), intent(in) :: names(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length), allocatable :: links(:)
      real(wp), allocatable :: columns(:, :)
      integer :: k, i, many

      allocate (links(0), columns(4, 0))
      do k = 1, size(studies)
         if (.not. allocated(studies(k)%over_turn) .or. .not. studies(k)%solved) cycle
         many = size(studies(k)%over_turn, 2)
         links = [character(name_length) :: links, (names(k), i=1, many)]
         columns = reshape([columns, ([studies(k)%cycle%turn%crank%input(i), &
                                       studies(k)%over_turn(:, i)], i=1, many)], [4, size(links)])
      end do
      if (size(links) == 0) return
      table = table_of('flexible_frequencies', 'a row for each link with a slide and position: natural frequencies at rest', &
                       audience=for_programs)
      call table%add('link', links)
      call table%add('input', columns(1, :), 'deg')
      call table%add('first', columns(2, :), 'rad/s')
      call table%add('second', columns(3, :), 'rad/s')
      call table%add('third', columns(4, :), 'rad/s')
      call tables%put(table)
   end subroutine put_over_turn

   !> Links out of the plane.
   subroutine put_out_of_plane(studies, names, tables)
      type(flex_study_t), intent(in) :: studies(:)
      character(*), intent(in) :: names(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length) :: links(count(studies%solved)), words(size(links))
      real(wp) :: multipliers(size(links))
      logical :: solved(size(links)), followed(size(links))
      integer :: there(size(links)), k, j, n

      n = size(links)
      if (n == 0) return
      there = pack([(k, k=1, size(studies))], studies%solved)
      links = names(there)
      multipliers = 0.0_wp
      words = ''
      do k = 1, n
         associate (out => studies(there(k))%out)
            solved(k) = out%solved
            followed(k) = out%solved_modes > 0
            if (.not. followed(k)) cycle
            words(k) = lower_case(coupled_words(out%coupled))
            followed(k) = .not. out%coupled%grows_too_much
            multipliers(k) = abs(out%coupled%multipliers(1))
         end associate
      end do
      table = table_of('flexible_out_of_plane', 'a row for each link of beam elements: out of the plane', audience=for_programs)
      call table%add('link', links)
      call table%add('long_pins', [(studies(there(k))%out%long_pins, k=1, n)])
      call table%add('verdict', words)
      call table%add('steady', [(studies(there(k))%out%is_steady(), k=1, n)])
      call table%add('multiplier', multipliers, known=followed)
      call table%add('modes_solved', [(studies(there(k))%out%solved_modes, k=1, n)], known=solved)
      call table%add('matrix_error', [(studies(there(k))%out%coupled%error, k=1, n)], known=followed)
      call table%add('least_stiffness', [(studies(there(k))%out%least_stiffness, k=1, n)], known=solved)
      call table%add('least_stiffness_at', [(studies(there(k))%out%least_at, k=1, n)], 'deg', solved)
      call tables%put(table)
      table = table_of('flexible_modes_out_of_plane', 'a row for each natural mode of a link at rest, out of the plane', &
                       audience=for_programs)
      call table%add('link', repeated(links, [(size(studies(there(k))%out%frequency), k=1, n)]))
      call table%add('mode', [((j, j=1, size(studies(there(k))%out%frequency)), k=1, n)])
      call table%add('frequency', [(studies(there(k))%out%frequency, k=1, n)], 'rad/s')
      call table%add('damping', [(studies(there(k))%out%damping, k=1, n)])
      call table%add('twist', [(studies(there(k))%out%twist, k=1, n)])
      call tables%put(table)
   end subroutine put_out_of_plane

   !> The greatest deflections and stresses of each segment.
   subroutine put_segments(studies, names, tables)
      type(flex_study_t), intent(in) :: studies(:)
      character(*), intent(in) :: names(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(*), parameter :: kinds(stress_kinds) = [character(7) :: 'bending', 'along', 'both']
      logical, allocatable :: known(:)
      integer :: k, j, s

      table = table_of('flexible_segments', 'a row for each segment of a link: the greatest over the turn', audience=for_programs)
      call table%add('link', repeated(names, [(size(studies(k)%segments), k=1, size(studies))]))
      call table%add('segment', [((studies(k)%segments(j)%entry, j=1, size(studies(k)%segments)), k=1, size(studies))])
      call table%add('deflection', [((studies(k)%segments(j)%deflection%value, j=1, size(studies(k)%segments)), k=1, &
                                     size(studies))], 'm')
      call table%add('deflection_at', [((studies(k)%segments(j)%deflection%at, j=1, size(studies(k)%segments)), k=1, &
                                        size(studies))], 'deg')
      call table%add('deflection_part', [((studies(k)%segments(j)%deflection%part, j=1, size(studies(k)%segments)), k=1, &
                                          size(studies))])
      known = [((studies(k)%stressed, j=1, size(studies(k)%segments)), k=1, size(studies))]
      do s = 1, stress_kinds
         call table%add(trim(kinds(s)), [((studies(k)%segments(j)%stress(s)%value, j=1, size(studies(k)%segments)), k=1, &
                                          size(studies))], 'Pa', known)
         call table%add(trim(kinds(s))//'_at', [((studies(k)%segments(j)%stress(s)%at, j=1, size(studies(k)%segments)), k=1, &
                                                 size(studies))], 'deg', known)
         call table%add(trim(kinds(s))//'_part', [((studies(k)%segments(j)%stress(s)%part, j=1, size(studies(k)%segments)), k=1, &
                                                   size(studies))], known=known)
      end do
      call tables%put(table)
   end subroutine put_segments

   !> How far each joint moves in the axes of its link.
   subroutine put_joints(mechanism, studies, names, tables)
      type(mechanism_t), intent(in) :: mechanism
      type(flex_study_t), intent(in) :: studies(:)
      character(*), intent(in) :: names(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length), allocatable :: links(:), joints(:)
      real(wp), allocatable :: moved(:)
      integer :: k, j, n

      n = sum([(merge(size(studies(k)%link%joints), 0, studies(k)%steady), k=1, size(studies))])
      allocate (links(n), joints(n), moved(n))
      n = 0
      do k = 1, size(studies)
         if (.not. studies(k)%steady) cycle
         do j = 1, size(studies(k)%link%joints)
            n = n + 1
            links(n) = names(k)
            joints(n) = mechanism%joints(studies(k)%link%joints(j))%name
            moved(n) = maxval(studies(k)%joints(j, :))
         end do
      end do
      table = table_of('flexible_joints', 'a row for each joint of a link: how far it moves at most', audience=for_programs)
      call table%add('link', links)
      call table%add('joint', joints)
      call table%add('moved', moved, 'm')
      call tables%put(table)
   end subroutine put_joints

   !> The greatest stresses of each link at each position.
   subroutine put_turn(studies, tables)
      type(flex_study_t), intent(in) :: studies(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: k, i, rows(size(studies))

      rows = 0
      do k = 1, size(studies)
         if (studies(k)%stressed) rows(k) = size(studies(k)%stress, 1)
      end do
      if (all(rows == 0)) return
      table = table_of('flexible_stresses', 'a row for each link and position: the greatest stresses along the link')
      call table%add('link', [((k, i=1, rows(k)), k=1, size(studies))])
      call table%add('input', [((studies(k)%cycle%turn%crank%input(i), i=1, rows(k)), k=1, size(studies))], 'deg')
      call table%add('bending', [((studies(k)%stress(i, 1), i=1, rows(k)), k=1, size(studies))], 'Pa')
      call table%add('along', [((studies(k)%stress(i, 2), i=1, rows(k)), k=1, size(studies))], 'Pa')
      call table%add('both', [((studies(k)%stress(i, 3), i=1, rows(k)), k=1, size(studies))], 'Pa')
      call tables%put(table)
   end subroutine put_turn

   !> Each link as it bends most.
   subroutine put_shapes(studies, tables)
      type(flex_study_t), intent(in) :: studies(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: k, i, rows(size(studies)), worst(size(studies)), at(2)

      rows = 0
      worst = 1
      do k = 1, size(studies)
         if (.not. studies(k)%steady) cycle
         rows(k) = size(studies(k)%link%frame%x, 2)
         at = maxloc(studies(k)%displacement(1, :, :)**2 + studies(k)%displacement(2, :, :)**2)
         worst(k) = at(2)
      end do
      if (all(rows == 0)) return
      table = table_of('flexible_shapes', 'a row for each link and node, where the link bends most: its place and '// &
                       'displacement in the axes of the link')
      call table%add('link', [((k, i=1, rows(k)), k=1, size(studies))])
      call table%add('x', [((studies(k)%link%frame%x(1, i), i=1, rows(k)), k=1, size(studies))], 'm')
      call table%add('y', [((studies(k)%link%frame%x(2, i), i=1, rows(k)), k=1, size(studies))], 'm')
      call table%add('moved_x', [((studies(k)%displacement(1, i, worst(k)), i=1, rows(k)), k=1, size(studies))], 'm')
      call table%add('moved_y', [((studies(k)%displacement(2, i, worst(k)), i=1, rows(k)), k=1, size(studies))], 'm')
      call tables%put(table)
   end subroutine put_shapes
end module psalm_flex_table
