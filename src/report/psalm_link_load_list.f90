!> What acts on each link and how it moves: device 8 and tables, for stress analysis.
module psalm_link_load_list
   use psalm_angles, only: degrees_of
   use psalm_column_names, only: input_name, input_unit
   use psalm_force_list, only: failure_at
   use psalm_force_study, only: force_study_t
   use psalm_kinds, only: wp
   use psalm_link_wrenches, only: words_of_kind
   use psalm_mechanism, only: body_frame
   use psalm_number_format, only: number_format_t, format_of, figure
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: list_link_loads, put_link_loads

   integer, parameter :: name_columns = 18  !! of a name in the listing, unless it is longer
   integer, parameter :: longest_name = 64  !! of a link or a joint in the tables

contains

   !> ILOADS: position by position, link by link.
   subroutine list_link_loads(study, text)
      type(force_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(number_format_t) :: of_input, of_place, of_force, of_moment, of_turning, of_accel, of_angle
      real(wp), allocatable :: angle(:, :), place(:, :, :), force(:, :, :), moment(:, :), turning(:, :, :), accel(:, :, :)
      logical :: known(size(study%input)), named
      integer :: k, b, i

      known = [(study%table%known(k), k=1, size(known))]
      named = study%mechanism%has_joint_names()
      angle = angles_of(study)
      associate (n => size(study%input), links => study%loads%links, acting => study%loads%acting)
         allocate (place(n, 2, size(acting)), force(n, 2, size(acting)), moment(n, size(acting)), turning(n, 2, size(links)), &
                   accel(n, 2, size(links)))
         do i = 1, size(acting)
            place(:, :, i) = acting(i)%place
            force(:, :, i) = acting(i)%force
            moment(:, i) = acting(i)%moment
         end do
         do b = 1, size(links)
            turning(:, :, b) = links(b)%turning
            accel(:, :, b) = links(b)%accel
         end do
         of_input = format_of(named, study%input)
         of_place = format_among(reshape(place, [size(place)]))
         of_force = format_among(reshape(force, [size(force)]))
         of_moment = format_among(reshape(moment, [size(moment)]))
         of_turning = format_among(reshape(turning, [size(turning)]))
         of_accel = format_among(reshape(accel, [size(accel)]))
         of_angle = format_among(reshape(angle, [size(angle)]))
         call text%add()
         call text%add(' WHAT ACTS ON THE LINKS, IN THEIR OWN AXES: LENGTHS, NEWTONS, NEWTON METRES; ACCELERATION OF THE CENTRE')
         call text%add(' OF MASS, M/S2')
         do k = 1, size(study%input)
            call text%add()
            call text%add(' INPUT'//figure(study%input(k), of_input))
            if (.not. known(k)) then
               call text%add(' '//failure_at(study, k, small=.false.))
               cycle
            end if
            do b = 1, size(links)
               if (b == body_frame) then
                  call text%add('  '//padded_name(links(b)%name)//'                                X              Y'// &
                                '             FX             FY         MOMENT')
               else
                  call text%add('  '//padded_name(links(b)%name)//'ANGLE'//figure(angle(k, b), of_angle)//', RAD/S'// &
                                figure(links(b)%turning(k, 1), of_turning)//', RAD/S2'// &
                                figure(links(b)%turning(k, 2), of_turning)//', M/S2'// &
                                figure(links(b)%accel(k, 1), of_accel)//figure(links(b)%accel(k, 2), of_accel))
               end if
               do i = 1, size(acting)
                  if (acting(i)%body /= b) cycle
                  call text%add('    '//padded_name(acting(i)%name)//words_of_kind(acting(i)%kind)// &
                                figure(acting(i)%place(k, 1), of_place)//figure(acting(i)%place(k, 2), of_place)// &
                                figure(acting(i)%force(k, 1), of_force)//figure(acting(i)%force(k, 2), of_force)// &
                                figure(acting(i)%moment(k), of_moment))
               end do
            end do
         end do
      end associate

   contains

      !> The format of values of all positions, position by position.
      pure type(number_format_t) function format_among(values) result(format)
         real(wp), intent(in) :: values(:)
         integer :: each

         format = format_of(named, values, [(known, each=1, size(values)/max(1, size(known)))])
      end function format_among
   end subroutine list_link_loads

   pure function padded_name(name) result(text)
      character(*), intent(in) :: name
      character(max(name_columns, len_trim(name) + 1)) :: text

      text = name
   end function padded_name

   !> Direction of the x axis of each link from the machine's, degrees. Shape (positions, links).
   pure function angles_of(study) result(angle)
      type(force_study_t), intent(in) :: study
      real(wp), allocatable :: angle(:, :)
      integer :: b, k

      allocate (angle(size(study%input), size(study%loads%links)))
      do b = 1, size(angle, 2)
         associate (direction => study%loads%links(b)%direction)
            do k = 1, size(angle, 1)
               angle(k, b) = degrees_of(direction(k, 1), direction(k, 2))
            end do
         end associate
      end do
   end function angles_of

   !> Tables: a row for each position, link and point; a row for each position and link that moves.
   subroutine put_link_loads(study, tables)
      type(force_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables

      call put_acting(study, tables)
      call put_motion(study, tables)
   end subroutine put_link_loads

   subroutine put_acting(study, tables)
      type(force_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      real(wp), allocatable :: input(:), value(:, :)   ! shapes (rows), (rows, place, force, moment)
      integer, allocatable :: position(:)
      logical, allocatable :: known(:)
      character(longest_name), allocatable :: link(:), point(:)
      character(len(words_of_kind)), allocatable :: kind(:)
      integer :: k, i, row

      associate (n => size(study%input), links => study%loads%links, acting => study%loads%acting)
         associate (rows => n*size(acting))
            allocate (input(rows), value(rows, 5), position(rows), known(rows), link(rows), point(rows), kind(rows))
         end associate
         row = 0
         do k = 1, n
            do i = 1, size(acting)
               row = row + 1
               position(row) = k
               input(row) = study%input(k)
               known(row) = study%table%known(k)
               link(row) = links(acting(i)%body)%name
               point(row) = acting(i)%name
               kind(row) = words_of_kind(acting(i)%kind)
               value(row, :2) = acting(i)%place(k, :)
               value(row, 3:4) = acting(i)%force(k, :)
               value(row, 5) = acting(i)%moment(k)
            end do
         end do
      end associate
      table = table_of('link_loads', 'a row for each position, link and point of it: what acts there, in axes of the link', &
                       audience=for_programs)
      call table%add('position', position)
      call table%add(input_name(), input, input_unit(study%drive_slides(1)))
      call table%add('link', link)
      call table%add('at', point)
      call table%add('kind', kind)
      call table%add('x', value(:, 1), 'length', known)
      call table%add('y', value(:, 2), 'length', known)
      call table%add('fx', value(:, 3), 'N', known)
      call table%add('fy', value(:, 4), 'N', known)
      call table%add('m', value(:, 5), 'N m', known)
      call tables%put(table)
   end subroutine put_acting

   subroutine put_motion(study, tables)
      type(force_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      real(wp), allocatable :: input(:), value(:, :), angle(:, :)
      integer, allocatable :: position(:)
      logical, allocatable :: known(:)
      character(longest_name), allocatable :: link(:)
      integer :: k, b, row

      angle = angles_of(study)
      associate (n => size(study%input), links => study%loads%links)
         associate (rows => n*(size(links) - body_frame))
            allocate (input(rows), value(rows, 11), position(rows), known(rows), link(rows))
         end associate
         row = 0
         do k = 1, n
            do b = body_frame + 1, size(links)
               row = row + 1
               position(row) = k
               input(row) = study%input(k)
               known(row) = study%table%known(k)
               link(row) = links(b)%name
               value(row, 1:2) = links(b)%at(k, :)
               value(row, 3) = angle(k, b)
               value(row, 4) = links(b)%mass
               value(row, 5:6) = links(b)%centre
               value(row, 7) = links(b)%inertia
               value(row, 8:9) = links(b)%turning(k, :)
               value(row, 10:11) = links(b)%accel(k, :)
            end do
         end do
      end associate
      table = table_of('link_motion', 'a row for each position and link: axes, centre of mass in them, motion', &
                       audience=for_programs)
      call table%add('position', position)
      call table%add(input_name(), input, input_unit(study%drive_slides(1)))
      call table%add('link', link)
      call table%add('x', value(:, 1), 'length', known)
      call table%add('y', value(:, 2), 'length', known)
      call table%add('angle', value(:, 3), 'deg', known)
      call table%add('mass', value(:, 4), 'kg')
      call table%add('centre_x', value(:, 5), 'length')
      call table%add('centre_y', value(:, 6), 'length')
      call table%add('inertia', value(:, 7), 'kg m2')
      call table%add('speed', value(:, 8), 'rad/s', known)
      call table%add('accel', value(:, 9), 'rad/s^2', known)
      call table%add('centre_ax', value(:, 10), 'm/s^2', known)
      call table%add('centre_ay', value(:, 11), 'm/s^2', known)
      call tables%put(table)
   end subroutine put_motion
end module psalm_link_load_list
