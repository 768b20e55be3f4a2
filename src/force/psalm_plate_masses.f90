!> Masses of links that are cut from plate: from their outlines and holes, exactly.
module psalm_plate_masses
   use psalm_angles, only: degrees_of
   use psalm_body_points, only: locate_point
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   use psalm_link_outline, only: area_moments, disc_moments, moment_area, moment_polar, moment_x, moment_y, moments_of, spine_of
   use psalm_locations, only: location_t, location_of_place, place_right
   use psalm_mechanism, only: mechanism_t, at_start, at_finish, body_frame, joint_revolute
   use psalm_plate_group, only: plate_group_t, plate_t, plates_of
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: plate_mass_t, find_plates, plate_of_body, is_part_of_cylinder

   real(wp), parameter :: largest = 1.0e25_wp     !! of sizes, densities, units: with it moments of inertia are numbers
   real(wp), parameter :: same_place = 1.0e-9_wp !! part of the hole: two joints there have one hole

   !> A body that is a plate.
   type :: plate_mass_t
      integer :: body = body_frame
      integer :: plate = 0                      !! number of the plate in its group
      real(wp) :: thickness = 0.0_wp, width = 0.0_wp !! user's length
      ! in the axes of the body's own arc from its reference, user's length
      real(wp), allocatable :: corners(:, :)    !! shape (2, corners): of the outline, anticlockwise
      real(wp), allocatable :: holes(:, :)      !! shape (2, holes): centres
      real(wp) :: hole = 0.0_wp                 !! their diameter
      real(wp) :: mass = 0.0_wp                 !! kg
      real(wp) :: moment(2) = 0.0_wp            !! first moments, kg m
      real(wp) :: inertia = 0.0_wp              !! about the reference, kg m2
      ! the centre of mass as &MASSES would have it: of a sketch from its first joint and the line to the next, of loops from the
      ! reference and the body's own arc
      real(wp) :: distance = 0.0_wp             !! user's length
      real(wp) :: angle = 0.0_wp                !! degrees
      real(wp) :: own_inertia = 0.0_wp          !! about the centre of mass, kg m2
   end type plate_mass_t

contains

   !> All plates of a case.
   !>
   !> Errors: a link whose points no arcs lead to; a bar without a width; holes that meet; sizes out of range.
   subroutine find_plates(set, mechanism, dimensions, reference, metre, found, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: reference(:)       !! by body: the vertex that places are counted from
      real(wp), intent(in) :: metre             !! metres in a unit of length
      type(plate_mass_t), allocatable, intent(out) :: found(:)
      type(diagnostics_t), intent(inout) :: findings
      type(plate_group_t) :: plates
      real(wp), allocatable :: points(:, :)
      type(plate_mass_t), allocatable :: every(:)
      integer :: k, n, body
      logical :: right

      plates = plates_of(set)
      allocate (every(merge(size(mechanism%bodies), 0, plates%given)))
      n = 0
      if (plates%all_links) then
         do body = body_frame + 1, size(mechanism%bodies)
            if (is_part_of_cylinder(mechanism, body)) cycle
            call points_on_body(body, points)
            call add_plate(plates%plates(1), 1, body)
         end do
      end if
      do k = 1, merge(0, size(plates%plates), plates%all_links)
         associate (plate => plates%plates(k))
            if (plate%link > 0) then
               call corners_of_link(plate, points, body, right)
            else
               body = mechanism%arcs(mechanism%seq(plate%place%loop, plate%place%arc))%body
               right = .not. is_part_of_cylinder(mechanism, body) .and. body /= body_frame
               if (right) call points_on_body(body, points)
               if (any(every(:n)%body == body)) then
                  call refuse(plate, 'is on a link that stands twice')
                  cycle
               end if
            end if
            if (right) then
               call add_plate(plate, k, body)
            else
               call refuse(plate, 'is on the frame, on a cylinder, or on a link whose points no arc leads to: it can be no '// &
                           'plate; give its mass in &MASSES')
            end if
         end associate
      end do
      found = every(:n)

   contains

      !> Places of all vertices of a body.
      subroutine points_on_body(body, points)
         integer, intent(in) :: body
         real(wp), allocatable, intent(out) :: points(:, :)
         real(wp) :: at(2)
         integer :: i, e, point
         logical :: seen(size(mechanism%points)), known

         seen = .false.
         seen(reference(body)) = .true.
         allocate (points(2, 1), source=0.0_wp)
         do i = 1, size(mechanism%bodies(body)%arcs)
            associate (n => mechanism%bodies(body)%arcs(i))
               if (mechanism%slides(n) .or. .not. mechanism%arcs(n)%attached) cycle
               do e = at_start, at_finish
                  point = mechanism%arcs(n)%ends(e)
                  if (seen(point)) cycle
                  seen(point) = .true.
                  call locate_point(mechanism, dimensions, body, reference(body), point, at, known)
                  if (known) points = reshape([points, at], [2, size(points, 2) + 1])
               end do
            end associate
         end do
      end subroutine points_on_body

      !> Places of the joints of a sketch's link, and its body.
      subroutine corners_of_link(plate, points, body, right)
         type(plate_t), intent(in) :: plate
         real(wp), allocatable, intent(out) :: points(:, :)
         integer, intent(out) :: body
         logical, intent(out) :: right
         type(location_t) :: location
         integer :: i, state

         body = body_frame
         right = size(plate%corners) > 0
         allocate (points(2, size(plate%corners)))
         do i = 1, size(plate%corners)
            call location_of_place(mechanism, dimensions, reference, plate%corners(i), location, state)
            right = right .and. state == place_right
            if (.not. right) return
            points(:, i) = location%at
            body = location%body
         end do
         right = body /= body_frame
      end subroutine corners_of_link

      !> Outline, holes and moments of a plate.
      subroutine add_plate(plate, number, body)
         type(plate_t), intent(in) :: plate
         integer, intent(in) :: number, body
         real(wp) :: moments(area_moments), at(2), along(2), scale, sizes(4)
         type(plate_mass_t) :: one
         integer :: k, b
         logical :: known

         sizes = [max(maxval(abs(points)), plate%width), plate%thickness, plate%density, metre]
         if (any(sizes > largest .or. sizes < 1.0_wp/largest) .or. plate%width > 0.0_wp .and. plate%width < 1.0_wp/largest) then
            call refuse(plate, 'gives '//mechanism%bodies(body)%name//' a mass that is too small or too large to compute with: '// &
                        'its size, PTHICK, PWIDTH, PDENS and UNITL of &MASSES may be from 1E-25 to 1E25')
            return
         end if
         one = plate_mass_t(body, number, plate%thickness, plate%width)
         one%corners = points(:, spine_of(points(1, :), points(2, :)))
         if (size(one%corners, 2) < 3 .and. .not. plate%width > 0.0_wp) then
            call refuse(plate, 'is on '//mechanism%bodies(body)%name//', whose points span no area: give its width, PWIDTH')
            return
         end if
         moments = moments_of(one%corners(1, :), one%corners(2, :), 0.5_wp*plate%width)
         one%hole = plate%hole
         allocate (one%holes(2, 0))
         do k = 1, merge(size(mechanism%joints), 0, plate%hole > 0.0_wp)
            associate (joint => mechanism%joints(k))
               if (joint%kind /= joint_revolute .or. .not. any(joint%bodies == body)) cycle
               call locate_point(mechanism, dimensions, body, reference(body), joint%point, at, known)
               if (.not. known) cycle
               known = .false.
               do b = 1, size(one%holes, 2)
                  associate (away => maxval(abs(one%holes(:, b) - at)))
                     known = known .or. away <= same_place*plate%hole
                     if (away > same_place*plate%hole .and. sum((one%holes(:, b) - at)**2) < plate%hole**2) &
                        call refuse(plate, 'has holes in '//mechanism%bodies(body)%name//' that meet: PHOLE is too large')
                  end associate
               end do
               if (known) cycle
               one%holes = reshape([one%holes, at], [2, size(one%holes, 2) + 1])
               moments = moments - disc_moments(at(1), at(2), 0.5_wp*plate%hole)
            end associate
         end do
         scale = plate%density*plate%thickness*metre**3
         one%mass = scale*moments(moment_area)
         one%moment = scale*metre*moments(moment_x:moment_y)
         one%inertia = scale*metre**2*moments(moment_polar)
         at = moments(moment_x:moment_y)/moments(moment_area)
         one%own_inertia = one%inertia - one%mass*metre**2*(at(1)**2 + at(2)**2)
         along = [1.0_wp, 0.0_wp]
         if (plate%link > 0) then
            at = at - points(:, 1)
            if (size(points, 2) > 1) along = points(:, 2) - points(:, 1)
         end if
         one%distance = hypotenuse(at(1), at(2))
         one%angle = degrees_of(along(1)*at(1) + along(2)*at(2), along(1)*at(2) - along(2)*at(1))
         n = n + 1
         every(n) = one
      end subroutine add_plate

      subroutine refuse(plate, what)
         type(plate_t), intent(in) :: plate
         character(*), intent(in) :: what

         call set%origins%error(findings, 'PLATES', set%link_item('P'), 'entry '//to_text(plate%entry)//' '//what, plate%entry)
      end subroutine refuse
   end subroutine find_plates

   !> True of the rod or the barrel of a cylinder.
   pure logical function is_part_of_cylinder(mechanism, body)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: body

      is_part_of_cylinder = mechanism%bodies(body)%is_rod .or. any(mechanism%arcs(mechanism%bodies(body)%arcs)%rod > 0)
   end function is_part_of_cylinder

   !> Number of the plate that a body is; 0: it is none.
   pure integer function plate_of_body(plates, mechanism, body) result(number)
      type(plate_group_t), intent(in) :: plates
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: body
      integer :: k

      number = 0
      if (body == body_frame .or. .not. plates%given) return
      if (plates%all_links) then
         number = merge(0, 1, is_part_of_cylinder(mechanism, body))
         return
      end if
      number = plates%plate_of_link(mechanism%arcs(mechanism%bodies(body)%axis)%link)
      do k = 1, size(plates%plates)
         associate (place => plates%plates(k)%place)
            if (place%loop == 0) cycle
            if (mechanism%arcs(mechanism%seq(place%loop, place%arc))%body == body) number = k
         end associate
      end do
   end function plate_of_body
end module psalm_plate_masses
