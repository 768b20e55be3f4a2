!> Forces in the listing, on device 8 and on device 9.
module psalm_force_list
   use psalm_column_names, only: input_name, input_unit
   use psalm_columns, only: heading_of
   use psalm_data_set, only: data_set_t
   use psalm_input_text, only: angle_text
   use psalm_force_analysis, only: column_of_joint, column_drive, column_fx, column_fy, column_moment
   use psalm_force_study, only: force_study_t
   use psalm_group_words, only: group_heading
   use psalm_kinds, only: wp
   use psalm_plate_group, only: plate_group_t, plates_of
   use psalm_number_format, only: number_format_t, format_of, figure, in_sentence
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: text_t, cased, to_text
   implicit none (type, external)
   private
   public :: list_forces, list_joint_forces, list_sizing, list_shares, add_forces, put_forces, failure_at

   integer, parameter :: name_columns = 18     !! of a name at the beginning of a line, unless it is longer

contains

   !> The listing: drive and frame at every position, then the table for sizing and the harmonics.
   subroutine list_forces(set, study, text)
      type(data_set_t), intent(in) :: set
      type(force_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      type(number_format_t) :: of_input, of_power, of_energy, of_about, of_loss, of_tilt
      type(number_format_t) :: of_column(size(study%table%value, 2))   ! drives, frame, joints
      logical :: known(size(study%input))
      integer :: k, d

      known = [(study%table%known(k), k=1, size(known))]
      associate (named => study%mechanism%has_joint_names())
         of_input = format_of(named, study%input)
         do d = 1, size(of_column)
            of_column(d) = format_of(named, study%table%value(:, d), known)
         end do
         do d = column_fx, column_fy
            of_column(d) = format_of(named, study%table%value(:, d), known, pack(study%table%value(:, column_fx:column_fy), &
                                                                                 spread(known, 2, 2)))
         end do
         of_power = format_of(named, study%drive_power, known)
         of_energy = format_of(named, study%table%kinetic, known)
         if (set%masses%about_given) of_about = format_of(named, study%about, known)
         if (set%friction%given) of_loss = format_of(named, study%table%loss, known)
         if (allocated(study%tilt)) of_tilt = format_of(named, reshape(study%tilt, [size(study%tilt)]), [known, known])
      end associate
      associate (sliding => study%drive_slides(1))
         call text%add()
         call text%add(' FORCES: NEWTONS, NEWTON METRES, WATTS, JOULES; ONE UNIT OF LENGTH IS'// &
                       in_sentence(set%has_names(), set%masses%metre)//' METRES')
         call text%add(' FORCE AND MOMENT OF THE LINKAGE ON ITS FRAME, MOMENT ABOUT THE MACHINE ORIGIN'// &
                       trim(merge(', DRIVE INCLUDED    ', ', WITHOUT THE DRIVE ', set%masses%motor_on_frame .or. sliding)))
         if (allocated(study%tilt)) call text%add(' QX, QY: MOMENTS OUT OF THE PLANE ABOUT X AND Y, OF INERTIA '// &
                                                  'AND WEIGHT OF MASSES AT THEIR HEIGHTS MZ')
         call text%add()
         line = merge('   INPUT LENGTH', '    CRANK ANGLE', sliding)
         if (study%mechanism%from_drawing) line = '          INPUT'
         line = line//merge('    DRIVE FORCE', '   DRIVE TORQUE', sliding)// &
                '       FRAME FX       FRAME FY   FRAME MOMENT    DRIVE POWER KINETIC ENERGY'
         if (set%masses%about_given) line = line//'  MOMENT ABOUT P'
         if (set%friction%given) line = line//'  FRICTION LOSS'
         if (allocated(study%tilt)) line = line//'       FRAME QX       FRAME QY'
         do d = 2, size(study%drives)
            line = line//heading_of(merge('FORCE ', 'TORQUE', study%drive_slides(d))//' '//study%drives(d))
         end do
         call text%add(line)
         do k = 1, size(study%input)
            line = merge(figure(study%input(k), of_input), angle_text(study%input(k), of_input), &
                         sliding .or. study%mechanism%from_drawing)
            if (.not. known(k)) then
               call text%add(line//'   '//failure_at(study, k, small=.false.))
               cycle
            end if
            associate (v => study%table%value)
               do d = 1, column_moment
                  line = line//figure(v(k, d), of_column(d))
               end do
               line = line//figure(study%drive_power(k), of_power)//figure(study%table%kinetic(k), of_energy)
               if (set%masses%about_given) line = line//' '//figure(study%about(k), of_about)
               if (set%friction%given) line = line//figure(study%table%loss(k), of_loss)
               if (allocated(study%tilt)) line = line//figure(study%tilt(k, 1), of_tilt)//figure(study%tilt(k, 2), of_tilt)
               do d = 2, size(study%drives)
                  line = line//figure(v(k, column_of_drive(study, d)), of_column(column_of_drive(study, d)))
               end do
            end associate
            call text%add(line)
         end do
         if (set%masses%about_given) call text%add(' P IS'//in_sentence(set%has_names(), set%masses%about(1))// &
                                                   in_sentence(set%has_names(), set%masses%about(2)))
         if (size(study%model%plates) > 0) call list_plates(set, study, text)
         if (any(known)) call list_sizing(study, 'THE INPUT', text)
         if (size(study%harmonics) > 0) call list_harmonics(study, text)
      end associate
   end subroutine list_forces

   !> Links cut from plate: their masses as &MASSES would have them.
   subroutine list_plates(set, study, text)
      type(data_set_t), intent(in) :: set
      type(force_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(number_format_t) :: of_mass, of_distance, of_angle, of_inertia
      integer :: k

      associate (plates => study%model%plates, named => study%mechanism%has_joint_names())
         of_mass = format_of(named, plates%mass)
         of_distance = format_of(named, plates%distance)
         of_angle = format_of(named, plates%angle)
         of_inertia = format_of(named, plates%own_inertia)
         call text%add()
         call text%add(' LINKS CUT FROM PLATE       MASS, KG       DISTANCE          ANGLE INERTIA, KG M2   CENTRE OF MASS FROM')
         do k = 1, size(plates)
            call text%add('  '//named_so(study%mechanism%bodies(plates(k)%body)%name)//figure(plates(k)%mass, of_mass)// &
                          figure(plates(k)%distance, of_distance)//figure(plates(k)%angle, of_angle)// &
                          figure(plates(k)%own_inertia, of_inertia)//'   '//counted_from(set, plates(k)%plate))
         end do
      end associate

   contains

      pure function named_so(name) result(cell)
         character(*), intent(in) :: name
         character(max(name_columns, len(name))) :: cell

         cell = name
      end function named_so
   end subroutine list_plates

   !> What the centre of mass of a plate is counted from: a joint and the line to another; of loops the link's own arc.
   pure function counted_from(set, plate) result(words)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: plate             !! its number in the group
      character(:), allocatable :: words
      type(plate_group_t) :: plates

      words = 'ITS FIRST ARC'
      if (.not. set%has_names()) return
      plates = plates_of(set)
      associate (joints => set%sketch%links(plates%plates(plate)%link)%joints)
         words = trim(set%sketch%joint_name(joints(1)))
         if (size(joints) > 1) words = words//', LINE '//words//' '//trim(set%sketch%joint_name(joints(2)))
      end associate
   end function counted_from

   !> Column of the table that has a drive after the first.
   pure integer function column_of_drive(study, drive)
      type(force_study_t), intent(in) :: study
      integer, intent(in) :: drive

      column_of_drive = size(study%table%value, 2) - size(study%drives) + drive
   end function column_of_drive

   !> What stands in place of forces where they are not known.
   pure function failure_at(study, k, small) result(words)
      type(force_study_t), intent(in) :: study
      integer, intent(in) :: k
      logical, intent(in) :: small             !! small letters, but for names
      character(:), allocatable :: words

      if (.not. study%table%closed(k)) then
         words = cased('DOES NOT CLOSE', small)
      else if (study%table%dead(k) /= 0) then
         words = cased('DEAD POINT OF ', small)//group_heading(study%mechanism, study%table%dead(k), small)// &
                 cased(': FORCES ARE INFINITE', small)
      else if (study%table%sweeps(k) < 0) then
         words = cased('GAS SPRING ', small)//to_text(-study%table%sweeps(k))//cased(' HAS NO ROOM LEFT', small)
      else
         words = cased('FRICTION LOCKS THE LINKAGE: NO DRIVE CAN MOVE IT', small)
      end if
   end function failure_at

   !> Peaks and means, and where the peaks are.
   subroutine list_sizing(study, where_at, text)
      type(force_study_t), intent(in) :: study
      character(*), intent(in) :: where_at          !! what `at` is: of 9 characters
      type(text_t), intent(inout) :: text
      type(number_format_t) :: of_row, of_input
      integer :: k

      call text%add()
      call text%add(' FOR SIZING                   PEAK    AT '//where_at//'            RMS           MEAN')
      associate (by_joints => study%mechanism%has_joint_names())
         of_input = format_of(by_joints, study%sizing%at)
         do k = 1, size(study%sizing)
            associate (of => study%sizing(k))
               of_row = format_of(by_joints, [of%peak, of%rms, of%mean], among=[of%largest])
               call text%add(' '//named(of%name)//figure(of%peak, of_row)//' '//figure(of%at, of_input)// &
                             figure(of%rms, of_row)//figure(of%mean, of_row))
            end associate
         end do
      end associate
   end subroutine list_sizing

   subroutine list_harmonics(study, text)
      type(force_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(number_format_t) :: of_amplitude, of_phase
      integer :: k, order

      call text%add()
      call text%add(' HARMONICS: AMPLITUDE*COS(ORDER*INPUT - PHASE), PHASE IN DEGREES')
      do k = 1, size(study%harmonics)
         associate (of => study%harmonics(k))
            of_amplitude = format_of(study%mechanism%has_joint_names(), of%amplitude)
            of_phase = format_of(study%mechanism%has_joint_names(), of%phase)
            do order = 0, ubound(of%amplitude, 1)
               call text%add(' '//named(of%name)//'ORDER'//repeat(' ', 5 - len(to_text(order)))//to_text(order)// &
                             figure(of%amplitude(order), of_amplitude)//figure(of%phase(order), of_phase))
            end do
         end associate
      end do
   end subroutine list_harmonics

   pure function named(name) result(text)
      character(*), intent(in) :: name
      character(max(name_columns, len_trim(name) + 1)) :: text

      text = name
   end function named

   !> KTHETA: every joint at every position.
   subroutine list_joint_forces(study, text)
      type(force_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      type(number_format_t) :: of_input, of_forces
      integer :: k, j

      call text%add()
      of_input = format_of(study%mechanism%has_joint_names(), study%input)
      if (study%mechanism%from_drawing) then
         call text%add(' FORCES IN THE JOINTS, NEWTONS AND NEWTON METRES: OF THE LINK PLACED FIRST ON THE OTHER, OF A SLIDE OF ITS')
         call text%add(' FIRST LINK ON ITS SECOND; FX AND FY IN MACHINE AXES, OF A SLIDE N ACROSS ITS LINE AND COUPLE M ABOUT THE')
         call text%add(' POINT SLX, SLY OF THE SECOND LINK')
      else
         call text%add(' FORCES IN THE JOINTS, NEWTONS AND NEWTON METRES: OF THE EARLIER LINK ON THE LATER ONE; FX AND FY IN '// &
                       'MACHINE')
         call text%add(' AXES, OF A SLIDE N ACROSS ITS ARC, AT ITS FOOT, AND COUPLE M ABOUT THE FOOT')
      end if
      do k = 1, size(study%input)
         call text%add()
         call text%add(' INPUT'//figure(study%input(k), of_input))
         if (.not. study%table%known(k)) then
            call text%add(' '//failure_at(study, k, small=.false.))
            cycle
         end if
         of_forces = format_of(study%mechanism%has_joint_names(), &
                               study%table%value(k, [(column_of_joint(j), column_of_joint(j) + 1, j=1, size(study%joints))]))
         do j = 1, size(study%joints)
            associate (joint => study%joints(j), c => column_of_joint(j))
               call text%add('  '//named(joint%name)//trim(merge('N, M   ', 'FX, FY ', joint%slides))// &
                             repeat(' ', merge(2, 0, joint%slides))//figure(study%table%value(k, c), of_forces)// &
                             figure(study%table%value(k, c + 1), of_forces))
            end associate
         end do
      end do
   end subroutine list_joint_forces

   !> ISHARE: what each source does to drive and frame.
   subroutine list_shares(study, text)
      type(force_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      real(wp) :: rest(column_moment)
      type(number_format_t) :: of_input, of_column(column_moment)
      logical :: known(size(study%input))
      integer :: k, source, c, s

      known = [(study%table%known(k), k=1, size(known))]
      associate (by_joints => study%mechanism%has_joint_names(), sources => size(study%sources))
         of_input = format_of(by_joints, study%input)
         do c = 1, column_moment
            of_column(c) = format_of(by_joints, [(study%shares(:, c, s), s=1, sources)], [(known, s=1, sources)])
         end do
      end associate

      call text%add()
      call text%add(' SHARES OF THE SOURCES              DRIVE       FRAME FX       FRAME FY   FRAME MOMENT')
      do k = 1, size(study%input)
         call text%add(' INPUT'//figure(study%input(k), of_input))
         if (.not. known(k)) then
            call text%add('  '//failure_at(study, k, small=.false.))
            cycle
         end if
         do source = 1, size(study%sources)
            call text%add('  '//named(study%sources(source))//four(study%shares(k, :, source)))
         end do
         if (.not. study%rubs) cycle
         rest = study%table%value(k, :column_moment) - sum(study%shares(k, :column_moment, :), dim=2)
         call text%add('  '//named('FRICTION')//four(rest))
      end do

   contains

      function four(values) result(line)
         real(wp), intent(in) :: values(:)
         character(:), allocatable :: line

         line = ''
         do c = 1, column_moment
            line = line//figure(values(c), of_column(c))
         end do
      end function four
   end subroutine list_shares

   !> The columns of a table of positions: drive, frame, energy, joints, further drives; not known where forces are not, nor
   !> where `reached` is false.
   pure subroutine add_forces(study, table, reached)
      type(force_study_t), intent(in) :: study
      type(table_t), intent(inout) :: table
      logical, intent(in), optional :: reached(:)  !! shape (positions)
      logical :: known(size(study%input))
      integer :: k, j, c

      known = [(study%table%known(k), k=1, size(known))]
      if (present(reached)) known = known .and. reached
      associate (v => study%table%value, unit => merge('N  ', 'N m', study%drive_slides))
         call table%add('drive', v(:, column_drive), trim(unit(1)), known)
         call table%add('frame_fx', v(:, column_fx), 'N', known)
         call table%add('frame_fy', v(:, column_fy), 'N', known)
         call table%add('frame_m', v(:, column_moment), 'N m', known)
         if (allocated(study%tilt)) then
            call table%add('frame_qx', study%tilt(:, 1), 'N m', known)
            call table%add('frame_qy', study%tilt(:, 2), 'N m', known)
         end if
         call table%add('kinetic', study%table%kinetic, 'J', known)
         call table%add('kinetic_per_s', study%table%growth, 'W', known)
         do j = 1, size(study%joints)
            c = column_of_joint(j)
            associate (joint => study%joints(j))
               call table%add(joint%name//trim(merge('_n ', '_fx', joint%slides)), v(:, c), 'N', known)
               call table%add(joint%name//trim(merge('_m ', '_fy', joint%slides)), v(:, c + 1), &
                              trim(merge('N m', 'N  ', joint%slides)), known)
            end associate
         end do
         do j = 2, size(study%drives)
            call table%add('drive'//to_text(j), v(:, column_of_drive(study, j)), trim(unit(j)), known)
         end do
      end associate
   end subroutine add_forces

   !> Tables for other programs: powers, sizing, harmonics, with ISHARE shares.
   subroutine put_forces(set, study, tables)
      type(data_set_t), intent(in) :: set
      type(force_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      character(*), parameter :: of_all = 'N, N m, W or J'
      type(table_t) :: table
      logical :: known(size(study%input))
      integer :: k, n, s

      known = [(study%table%known(k), k=1, size(known))]
      table = table_of('powers', 'a row for each position', audience=for_programs)
      call table%add(input_name(), study%input, input_unit(study%drive_slides(1)))
      call table%add('drive_power', study%drive_power, 'W', known)
      if (set%masses%about_given) call table%add('frame_m_about', study%about, 'N m', known)
      if (set%friction%given) call table%add('friction_loss', study%table%loss, 'W', known)
      call tables%put(table)

      if (any(known)) then
         table = table_of('sizing', 'a row for each quantity over the positions: '//of_all, audience=for_programs)
         call table%add('quantity', study%sizing%name)
         call table%add('peak', study%sizing%peak)
         call table%add('at', study%sizing%at, input_unit(study%drive_slides(1)))
         call table%add('rms', study%sizing%rms)
         call table%add('mean', study%sizing%mean)
         call tables%put(table)
      end if

      if (size(study%model%plates) > 0) then
         associate (plates => study%model%plates)
            table = table_of('plates', 'a row for each link cut from plate, its centre of mass from its first joint and the '// &
                             'line to the next; of loops from its own arc', audience=for_programs)
            call table%add('link', [(link_name(plates(k)%body), k=1, size(plates))])
            call table%add('mass', plates%mass, 'kg')
            call table%add('distance', plates%distance, 'length')
            call table%add('angle', plates%angle, 'deg')
            call table%add('inertia', plates%own_inertia, 'kg m2')
         end associate
         call tables%put(table)
      end if

      if (size(study%harmonics) > 0) then
         associate (all => study%harmonics)
            table = table_of('harmonics', 'a row for each quantity and order, amplitude*cos(order*input - phase): '//of_all, &
                             audience=for_programs)
            call table%add('quantity', [((all(k)%name, n=0, ubound(all(k)%amplitude, 1)), k=1, size(all))])
            call table%add('order', [((n, n=0, ubound(all(k)%amplitude, 1)), k=1, size(all))])
            call table%add('amplitude', [(all(k)%amplitude, k=1, size(all))])
            call table%add('phase', [(all(k)%phase, k=1, size(all))], 'deg')
         end associate
         call tables%put(table)
      end if

      if (set%masses%shares == 0) return
      associate (m => size(study%input), sources => size(study%sources))
         table = table_of('shares', 'a row for each source and position: what it does to drive and frame', audience=for_programs)
         call table%add('source', [((study%sources(s), k=1, m), s=1, sources)])
         call table%add(input_name(), [((study%input(k), k=1, m), s=1, sources)], input_unit(study%drive_slides(1)))
         call add_share('drive', column_drive, trim(merge('N  ', 'N m', study%drive_slides(1))))
         call add_share('frame_fx', column_fx, 'N')
         call add_share('frame_fy', column_fy, 'N')
         call add_share('frame_m', column_moment, 'N m')
      end associate
      call tables%put(table)

   contains

      pure function link_name(body) result(name)
         integer, intent(in) :: body
         character(name_columns) :: name

         name = study%mechanism%bodies(body)%name
      end function link_name

      subroutine add_share(name, column, unit)
         character(*), intent(in) :: name, unit
         integer, intent(in) :: column
         integer :: i

         call table%add(name, reshape(study%shares(:, column, :), [size(known)*size(study%sources)]), unit, &
                        [(known, i=1, size(study%sources))])
      end subroutine add_share
   end subroutine put_forces
end module psalm_force_list
