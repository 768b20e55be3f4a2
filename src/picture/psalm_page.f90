!> Scenes as one self-contained HTML page: the page's text is part of the program, the scenes go into it as JSON.
module psalm_page
   use psalm_allocation_page, only: write_allocation_data
   use psalm_clearance_page, only: write_clearance_data
   use psalm_constraint_group, only: region_box, region_half_plane
   use psalm_dyad_kind, only: assur_rrr
   use psalm_force_page, only: write_force_data
   use psalm_kinds, only: wp
   use psalm_output_kind, only: motion_point, motion_angle, motion_distance
   use psalm_labels, only: place_labels
   use psalm_json, only: add_member, add_numbers, add_strings, comma, json_integers, json_number, json_text, truth
   use psalm_markup, only: strings_t, xml_text
   use psalm_page_text, only: page_text
   use psalm_panels, only: tolerance_band_t, panel_t
   use psalm_parts, only: drawn_bar_t, drawn_body_t
   use psalm_proof_page, only: write_proof_data
   use psalm_scene, only: place_on_sweep, scene_t, motion_number
   use psalm_shared_text, only: title_mark, data_mark
   use psalm_text, only: text_t, to_text
   use psalm_trace, only: position_row_t
   use psalm_vibration_page, only: write_vibration_data
   implicit none (type, external)
   private
   public :: write_page

   integer, parameter :: scene_format = 1  !! of the data; web/scene.js expects the same

   !> Names of the dyads by type: links and guides with revolute joints R and prismatic joints P from start to finish.
   ! the last: a larger group
   character(3), parameter :: dyads(9) = ['RRR', 'RPR', 'RPR', 'RRP', 'PRR', 'RPP', 'PPR', 'PRP', '...']

   real(wp), parameter :: usual_width = 600.0_wp      !! of a linkage on the page, pixels
   real(wp), parameter :: beside(2) = [13.0_wp, -13.0_wp] !! place of a letter that finds none better

contains

   !> Append the page with all scenes of a file.
   subroutine write_page(scenes, text)
      type(scene_t), intent(in) :: scenes(:)   !! at least one
      type(text_t), intent(inout) :: text
      character(:), allocatable :: page
      integer :: title, place, i

      page = page_text()
      title = index(page, title_mark)
      place = index(page, data_mark)
      call text%add_text(page(:title - 1)//'<title>'//xml_text(trim(scenes(1)%title))//'</title>'// &
                         page(title + len(title_mark):place - 1))
      call text%add_text('<script type="application/json" id="data">{"format":'//to_text(scene_format)//',"cases":[')
      do i = 1, size(scenes)
         if (i > 1) call text%add_text(',')
         call write_scene(scenes(i), text)
      end do
      call text%add_text(']}</script>')
      call text%add_text(page(place + len(data_mark):))
   end subroutine write_page

   subroutine write_scene(scene, text)
      type(scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text

      call text%add_text('{"title":'//json_text(trim(scene%title))//',"file":'//json_text(scene%file)//',"sound":'// &
                         truth(scene%valid)//',')
      call add_messages('errors', scene%errors)
      call text%add_text(',')
      call add_messages('warnings', scene%warnings)
      call text%add_text(',')
      call add_messages('breaches', scene%breaches)
      if (scene%valid) then
         call text%add_text(',"motion":"'//motion_name(scene%motion)//'","sliding":'//truth(scene%sliding)//',"desired":'// &
                            truth(scene%desired)//',"sense":'//json_number(scene%sense)//',"loops":'//to_text(scene%loops)// &
                            ',"output":'//to_text(scene%output - 1)//',"base":'//to_text(scene%output_base - 1)// &
                            ',"reference":'//to_text(scene%reference - 1))
         call add_member('limits', [90.0_wp - scene%tangle, 90.0_wp + scene%tangle], text, exact=.true.)
         call add_member('view', [scene%low, scene%high], text)
         if (scene%time > 0.0_wp) call text%add_text(',"time":'//json_number(scene%time, exact=.true.))
         call write_parts(scene, text)
         if (allocated(scene%drives)) call write_chain_parts(scene, text)
         call text%add(',"prescribed":{')
         call write_row(scene, scene%prescribed, .true., text)
         call write_places(scene, text)
         call text%add('},"sweep":{')
         call write_row(scene, scene%sweep, .false., text)
         call write_others(scene, scene%sweep, text)
         call text%add_text('}')
         if (allocated(scene%input_label) .and. .not. allocated(scene%drives)) &
            call text%add_text(',"inputLabel":'//json_text(scene%input_label))
         if (allocated(scene%output_label) .and. .not. allocated(scene%drives)) &
            call text%add_text(',"outputLabel":'//json_text(scene%output_label))
         if (size(scene%panels) > 0) call write_panels(scene, text)
         if (allocated(scene%ghosts)) call write_ghosts(scene, text)
         if (allocated(scene%band)) call write_band(scene%band, text)
         if (allocated(scene%allotted)) then
            call text%add_text(',"allotted":')
            call write_allocation_data(scene%allotted, text)
         end if
         if (allocated(scene%vibration)) then
            call text%add_text(',"vibration":')
            associate (v => scene%vibration, bar => scene%bars(scene%vibration%bar))
               call write_vibration_data(v, merge(bar%finish, bar%start, v%reversed) - 1, &
                                         merge(bar%start, bar%finish, v%reversed) - 1, text)
            end associate
         end if
         if (allocated(scene%clearance)) then
            call text%add_text(',"clearance":')
            call write_clearance_data(scene%clearance, scene%drawn(scene%clearance%point) - 1, text)
         end if
         if (allocated(scene%proof)) then
            call text%add_text(',"proof":')
            call write_proof_data(scene%proof, text)
         end if
         if (allocated(scene%forces)) then
            call text%add_text(',"forces":')
            call write_force_data(scene%forces, text)
         end if
      end if
      call text%add('}')

   contains

      subroutine add_messages(name, messages)
         character(*), intent(in) :: name
         type(strings_t), intent(in) :: messages(:)

         call text%add_text('"'//name//'":')
         call add_strings(messages, text)
      end subroutine add_messages
   end subroutine write_scene

   !> Joints, bars, bodies, slides and pairs; numbers count from 0, -1 is none.
   subroutine write_parts(scene, text)
      type(scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      real(wp) :: letters(2, size(scene%joints)), k
      integer :: i

      call find_letters()
      call text%add(',"joints":[')
      do i = 1, size(scene%joints)
         associate (joint => scene%joints(i))
            call text%add_text(comma(i)//'{"name":'//json_text(joint%name)//',"turning":'//truth(joint%turning)//',"slides":'// &
                               truth(joint%slides)//',"fixed":'//truth(joint%fixed)//',"letter":['// &
                               json_number(letters(1, i))//','//json_number(letters(2, i))//']}')
         end associate
      end do
      call text%add('],"bars":[')
      do i = 1, size(scene%bars)
         associate (bar => scene%bars(i))
            call text%add_text(comma(i)//'{"from":'//to_text(bar%start - 1)//',"to":'//to_text(bar%finish - 1)//',"loop":'// &
                               to_text(bar%loop)//',"arc":'//to_text(bar%arc)//',"others":'//json_text(bar%others)//',"slide":'// &
                               to_text(bar%slide - 1)//',"body":'//to_text(bar%body - 1)//',"length":'// &
                               json_number(bar%length, exact=.true.)//barrel_of(bar)//'}')
         end associate
      end do
      call text%add('],"bodies":[')
      do i = 1, size(scene%bodies)
         call text%add_text(comma(i)//'{"frame":'//truth(scene%bodies(i)%frame)//',"hull":'// &
                            json_integers(scene%bodies(i)%hull - 1)//name_of(scene%bodies(i))//'}')
      end do
      call text%add('],"slides":[')
      do i = 1, size(scene%slides)
         associate (slide => scene%slides(i))
            call text%add_text(comma(i)//'{"guide":'//to_text(slide%guide - 1)//',"block":'//to_text(slide%block - 1)// &
                               ',"sense":'//json_number(slide%sense)//',"low":'//json_number(slide%low)//',"high":'// &
                               json_number(slide%high)//'}')
         end associate
      end do
      call text%add('],"pairs":[')
      do i = 1, size(scene%pairs)
         associate (pair => scene%pairs(i))
            call text%add_text(comma(i)//'{"type":"'//dyads(pair%joint_type)//'","start":'//to_text(pair%start - 1)// &
                               ',"shared":'//to_text(pair%shared - 1)//',"finish":'//to_text(pair%finish - 1)//'}')
         end associate
      end do
      call text%add('],"regions":[')
      do i = 1, size(scene%regions)
         associate (region => scene%regions(i))
            call text%add_text(comma(i)//'{"kind":"'//region_name(region%kind)//'","inside":'//truth(region%stay_inside))
            call add_member('at', region%at(:4), text, exact=.true.)
            call text%add_text('}')
         end associate
      end do
      call text%add_text(']')

   contains

      !> Middles of the letters from their joints, pixels, y downwards: free of the links at the reference position.
      subroutine find_letters()
         integer :: j

         k = usual_width/maxval(scene%high - scene%low)
         call place_labels(scene, k, 0.0_wp, 0.0_wp, letters)
         associate (row => scene%prescribed, i => scene%reference)
            do j = 1, size(scene%joints)
               if (letters(1, j) > -huge(1.0_wp)) then
                  letters(1, j) = anint(letters(1, j) - k*(row%x(j, i) - scene%low(1)))
                  letters(2, j) = anint(letters(2, j) + k*(row%y(j, i) - scene%low(2)))
               else
                  letters(:, j) = beside
               end if
            end do
         end associate
      end subroutine find_letters
   end subroutine write_parts

   !> The length of a cylinder's barrel, if it is one.
   pure function barrel_of(bar) result(member)
      type(drawn_bar_t), intent(in) :: bar
      character(:), allocatable :: member

      member = ''
      if (bar%cylinder) member = ',"barrel":'//json_number(bar%barrel)
   end function barrel_of

   !> The name of a link of a sketch, if it is one.
   pure function name_of(body) result(member)
      type(drawn_body_t), intent(in) :: body
      character(:), allocatable :: member

      member = ''
      if (allocated(body%name)) member = ',"name":'//json_text(body%name)
   end function name_of

   !> Equilibria.
   subroutine write_ghosts(scene, text)
      type(scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      integer :: i

      call text%add(',"ghosts":[')
      do i = 1, size(scene%ghosts)
         associate (ghost => scene%ghosts(i))
            call text%add_text(comma(i)//'{"name":'//json_text(trim(ghost%name))//',"stable":'//truth(ghost%stable))
            call add_member('x', ghost%x, text, ghost%known)
            call add_member('y', ghost%y, text, ghost%known)
            call text%add('}')
         end associate
      end do
      call text%add_text(']')
   end subroutine write_ghosts

   !> What only sketches without loops of dyads have: drives, all outputs, gear wheels, what the output reaches.
   subroutine write_chain_parts(scene, text)
      type(scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      integer :: i, m

      call text%add_text(',"inputLabel":'//json_text(scene%input_label)//',"outputLabel":'//json_text(scene%output_label))
      call text%add(',"drives":[')
      do i = 1, size(scene%drives)
         associate (drive => scene%drives(i))
            call text%add_text(comma(i)//'{"name":'//json_text(drive%name)//',"turning":'//truth(drive%turning))
            call add_both(drive%prescribed, drive%sweep, .false.)
         end associate
      end do
      call text%add('],"curves":[')
      do i = 1, size(scene%curves)
         associate (curve => scene%curves(i))
            call text%add_text(comma(i)//'{"name":'//json_text(curve%name)//',"angle":'//truth(curve%angle))
            call add_both(curve%prescribed, curve%sweep, .true.)
         end associate
      end do
      call text%add('],"wheels":[')
      do i = 1, size(scene%wheels)
         associate (wheel => scene%wheels(i))
            call text%add_text(comma(i)//'{"body":'//to_text(wheel%body - 1)//',"centre":'//to_text(wheel%centre - 1)//',"rim":'// &
                               to_text(wheel%rim - 1)//',"radius":'//json_number(wheel%radius)//'}')
         end associate
      end do
      call text%add_text(']')
      if (.not. allocated(scene%meshes)) return
      call text%add(',"meshes":[')
      do i = 1, size(scene%meshes, 3)
         call text%add_text(comma(i)//'[')
         do m = 1, 4
            call text%add_text(comma(m)//json_number(scene%meshes(1, m, i))//','//json_number(scene%meshes(2, m, i)))
         end do
         call text%add_text(']')
      end do
      call text%add(']')

   contains

      !> Values along both rows; where the linkage does not close a curve has none.
      subroutine add_both(prescribed, sweep, closing)
         real(wp), intent(in) :: prescribed(:), sweep(:)
         logical, intent(in) :: closing

         call add_member('prescribed', prescribed, text, scene%prescribed%closed .or. .not. closing, exact=.true.)
         call add_member('sweep', sweep, text, scene%sweep%closed .or. .not. closing)
         call text%add('}')
      end subroutine add_both
   end subroutine write_chain_parts

   !> Further curves over the sweep.
   subroutine write_panels(scene, text)
      type(scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      integer :: i, k

      call text%add(',"panels":[')
      do i = 1, size(scene%panels)
         associate (panel => scene%panels(i))
            call text%add_text(comma(i)//'{"name":'//json_text(name_with_note(panel))//',"group":"'//trim(panel%group)// &
                               '","scale":'//json_number(panel%scale)//',"lines":[')
            do k = 1, size(panel%lines)
               call text%add_text(comma(k)//'{"label":'//json_text(trim(panel%lines(k)%label)))
               call add_member('values', panel%lines(k)%values, text, panel%lines(k)%known)
               call text%add_text('}')
            end do
            call text%add(']}')
         end associate
      end do
      call text%add(']')
   end subroutine write_panels

   pure function name_with_note(panel) result(name)
      type(panel_t), intent(in) :: panel
      character(:), allocatable :: name

      name = trim(panel%name)
      if (len_trim(panel%note) > 0) name = name//' ('//trim(panel%note)//')'
   end function name_with_note

   !> Deviations of the output over the sweep: for each component root-sum-square and worst case.
   subroutine write_band(band, text)
      type(tolerance_band_t), intent(in) :: band
      type(text_t), intent(inout) :: text
      integer :: c

      call text%add(',"band":[')
      do c = 1, band%components
         call text%add_text(comma(c)//'{"square":')
         call add_numbers(band%square(:, c), text, band%known)
         call add_member('worst', band%worst(:, c), text, band%known)
         call text%add_text('}')
      end do
      call text%add(']')
   end subroutine write_band

   !> A row of positions: prescribed ones with all digits, a sweep with nine.
   subroutine write_row(scene, row, exact, text)
      type(scene_t), intent(in) :: scene
      type(position_row_t), intent(in) :: row
      logical, intent(in) :: exact
      type(text_t), intent(inout) :: text
      logical :: all_known(row%n)
      integer :: i, j, loop
      logical :: first

      all_known = .true.
      call text%add_text('"n":'//to_text(row%n))
      call add_row('delt', row%delt, all_known)
      call add_row('input', row%input, all_known)
      call add_row('actual', row%actual, row%closed)
      call add_row('actual_y', row%actual_y, row%closed)
      if (size(row%wanted) > 0) then
         call add_row('desired', row%wanted, all_known)
         call add_row('error', row%error, row%closed)
         if (size(row%desired_y) > 0) then
            call add_row('desired_y', row%desired_y, all_known)
            call add_row('error_y', row%error_y, row%closed)
         end if
         call add_row('desired_mark_x', row%desired_mark(1, :), all_known)
         call add_row('desired_mark_y', row%desired_mark(2, :), all_known)
      end if
      if (scene%motion == motion_angle) then
         call add_row('actual_mark_x', row%actual_mark(1, :), row%closed)
         call add_row('actual_mark_y', row%actual_mark(2, :), row%closed)
      end if
      call text%add_text(',"closed":"')
      do i = 1, row%n
         call text%add_text(merge('1', '0', row%closed(i)))
      end do
      call text%add('","x":[')
      do j = 1, size(scene%joints)
         call add_array(j, row%x(j, :), row%known(j, :), scene%joints(j)%fixed)
      end do
      call text%add('],"y":[')
      do j = 1, size(scene%joints)
         call add_array(j, row%y(j, :), row%known(j, :), scene%joints(j)%fixed)
      end do
      call text%add('],"ux":[')
      do j = 1, size(scene%slides)
         call add_array(j, row%ux(j, :), abs(row%ux(j, :)) + abs(row%uy(j, :)) > 0.0_wp, scene%slides(j)%still)
      end do
      call text%add('],"uy":[')
      do j = 1, size(scene%slides)
         call add_array(j, row%uy(j, :), abs(row%ux(j, :)) + abs(row%uy(j, :)) > 0.0_wp, scene%slides(j)%still)
      end do
      call text%add('],"angle":[')
      first = .true.
      do loop = 1, scene%loops
         if (scene%pairs(loop)%joint_type /= assur_rrr) cycle
         if (.not. first) call text%add_text(',')
         first = .false.
         call text%add_text('{"loop":'//to_text(loop)//',"name":'//json_text(scene%pairs(loop)%name))
         call add_member('values', row%angle(loop, :), text, row%valid(loop, :), exact)
         call text%add('}')
      end do
      call text%add('],"broken":[')
      call add_broken(row)
      call text%add('],"violations":[')
      do i = 1, size(row%violations)
         associate (violation => row%violations(i))
            call text%add(comma(i)//'{"loop":'//to_text(violation%loop)//',"first":'//to_text(violation%first - 1)//',"last":'// &
                          to_text(violation%last - 1)//',"text":'//json_text(row%words(i)%text)//'}')
         end associate
      end do
      call text%add(']')

   contains

      subroutine add_row(name, values, known)
         character(*), intent(in) :: name
         real(wp), intent(in) :: values(:)
         logical, intent(in) :: known(:)

         call add_member(name, values, text, known, exact)
      end subroutine add_row

      !> What does not move in a sweep is one number.
      subroutine add_array(j, values, known, still)
         integer, intent(in) :: j
         real(wp), intent(in) :: values(:)
         logical, intent(in) :: known(:), still

         if (j > 1) call text%add(',')
         if (still .and. .not. exact) then
            call text%add_text(json_number(values(1), known(1)))
         else
            call add_numbers(values, text, known, exact)
         end if
      end subroutine add_array

      !> Pairs that do not meet: position, loop, where p and q end.
      subroutine add_broken(row)
         type(position_row_t), intent(in) :: row
         integer :: k, l, m, count

         count = 0
         do k = 1, row%n
            do l = 1, scene%loops
               if (.not. row%broken(l, k)) cycle
               count = count + 1
               call text%add_text(comma(count)//'['//to_text(k - 1)//','//to_text(l - 1))
               do m = 1, 4
                  call text%add_text(','//json_number(row%tip(m, l, k)))
               end do
               call text%add(']')
            end do
         end do
      end subroutine add_broken
   end subroutine write_row

   !> Where the prescribed positions lie on the sweep, counted in its positions.
   subroutine write_places(scene, text)
      type(scene_t), intent(in) :: scene
      type(text_t), intent(inout) :: text
      integer :: i

      call add_member('at', [(place_on_sweep(scene, i), i=1, scene%prescribed%n)], text, exact=.true.)
   end subroutine write_places

   !> The common joint of each pair in its other assembly, where there is one.
   subroutine write_others(scene, row, text)
      type(scene_t), intent(in) :: scene
      type(position_row_t), intent(in) :: row
      type(text_t), intent(inout) :: text
      integer :: loop, count

      call text%add_text(',"others":[')
      count = 0
      do loop = 1, scene%loops
         if (.not. any(row%other_known(loop, :))) cycle
         count = count + 1
         call text%add_text(comma(count)//'{"pair":'//to_text(loop - 1))
         call add_member('x', row%other(1, loop, :), text, row%other_known(loop, :))
         call add_member('y', row%other(2, loop, :), text, row%other_known(loop, :))
         call text%add('}')
      end do
      call text%add(']')
   end subroutine write_others

   pure function motion_name(motion) result(name)
      integer, intent(in) :: motion
      character(:), allocatable :: name

      select case (motion)
      case (motion_point)
         name = 'point'
      case (motion_angle)
         name = 'angle'
      case (motion_distance)
         name = 'distance'
      case (motion_number)
         name = 'number'
      case default
         name = 'slide'
      end select
   end function motion_name

   pure function region_name(kind) result(name)
      integer, intent(in) :: kind
      character(:), allocatable :: name

      select case (kind)
      case (region_box)
         name = 'box'
      case (region_half_plane)
         name = 'half-plane'
      case default
         name = 'circle'
      end select
   end function region_name
end module psalm_page
