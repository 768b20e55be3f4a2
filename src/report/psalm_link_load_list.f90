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
      type(table_t) :: table
      real(wp), allocatable :: angle(:, :)
      logical :: known(size(study%input))
      integer :: k, i, b

      known = [(study%table%known(k), k=1, size(known))]
      angle = angles_of(study)
      associate (n => size(study%input), links => study%loads%links, acting => study%loads%acting)
         associate (m => size(acting))
            table = table_of('link_loads', 'a row for each position, link and point of it: what acts there, in axes of the link', &
                             audience=for_programs)
            call table%add('position', [((k, i=1, m), k=1, n)])
            call table%add(input_name(), [((study%input(k), i=1, m), k=1, n)], input_unit(study%drive_slides(1)))
            call table%add('link', [((link_name(acting(i)%body), i=1, m), k=1, n)])
            call table%add('at', [((point_name(i), i=1, m), k=1, n)])
            call table%add('kind', [((words_of_kind(acting(i)%kind), i=1, m), k=1, n)])
            call add('x', [((acting(i)%place(k, 1), i=1, m), k=1, n)], 'length', m)
            call add('y', [((acting(i)%place(k, 2), i=1, m), k=1, n)], 'length', m)
            call add('fx', [((acting(i)%force(k, 1), i=1, m), k=1, n)], 'N', m)
            call add('fy', [((acting(i)%force(k, 2), i=1, m), k=1, n)], 'N', m)
            call add('m', [((acting(i)%moment(k), i=1, m), k=1, n)], 'N m', m)
            call tables%put(table)
         end associate
         associate (m => size(links) - 1)
            table = table_of('link_motion', 'a row for each position and link: axes, centre of mass in them, motion', &
                             audience=for_programs)
            call table%add('position', [((k, b=1, m), k=1, n)])
            call table%add(input_name(), [((study%input(k), b=1, m), k=1, n)], input_unit(study%drive_slides(1)))
            call table%add('link', [((link_name(b + 1), b=1, m), k=1, n)])
            call add('x', [((links(b + 1)%at(k, 1), b=1, m), k=1, n)], 'length', m)
            call add('y', [((links(b + 1)%at(k, 2), b=1, m), k=1, n)], 'length', m)
            call add('angle', [((angle(k, b + 1), b=1, m), k=1, n)], 'deg', m)
            call add('mass', [((links(b + 1)%mass, b=1, m), k=1, n)], 'kg', m)
            call add('centre_x', [((links(b + 1)%centre(1), b=1, m), k=1, n)], 'length', m)
            call add('centre_y', [((links(b + 1)%centre(2), b=1, m), k=1, n)], 'length', m)
            call add('inertia', [((links(b + 1)%inertia, b=1, m), k=1, n)], 'kg m2', m)
            call add('speed', [((links(b + 1)%turning(k, 1), b=1, m), k=1, n)], 'rad/s', m)
            call add('accel', [((links(b + 1)%turning(k, 2), b=1, m), k=1, n)], 'rad/s^2', m)
            call add('centre_ax', [((links(b + 1)%accel(k, 1), b=1, m), k=1, n)], 'm/s^2', m)
            call add('centre_ay', [((links(b + 1)%accel(k, 2), b=1, m), k=1, n)], 'm/s^2', m)
            call tables%put(table)
         end associate
      end associate

   contains

      subroutine add(name, values, unit, times)
         character(*), intent(in) :: name, unit
         real(wp), intent(in) :: values(:)
         integer, intent(in) :: times             !! rows of a position
         integer :: l

         call table%add(name, values, unit, [((known(k), l=1, times), k=1, size(known))])
      end subroutine add

      pure function link_name(body) result(name)
         integer, intent(in) :: body
         character(longest_name) :: name

         name = study%loads%links(body)%name
      end function link_name

      pure function point_name(which) result(name)
         integer, intent(in) :: which
         character(longest_name) :: name

         name = study%loads%acting(which)%name
      end function point_name
   end subroutine put_link_loads
end module psalm_link_load_list
