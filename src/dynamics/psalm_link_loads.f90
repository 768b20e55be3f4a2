!> What acts on a link between its pins in a turn of the crank: loads and ends of springs, in the axes of the link.
module psalm_link_loads
   use psalm_body_points, only: locate_point
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_force_model, only: force_model_t
   use psalm_kinds, only: wp
   use psalm_kinetostatics, only: forces_t, clear_wrenches, add_source, find_location, first_load, first_spring, table_factors
   use psalm_linkage, only: padded
   use psalm_locations, only: location_t
   use psalm_mechanism, only: mechanism_t, at_start, at_finish
   implicit none (type, external)
   private
   public :: acting_cycle_t, find_foot, list_acting, direction_of_arc, follow_acting

   !> A load, or the end of a spring. Arrays have the shape (positions), forces and stiffnesses are in the axes of the link.
   type :: acting_cycle_t
      integer :: load = 0                        !! its number; 0: it is a spring
      integer :: spring = 0, end = 0             !! the spring's number, and which of its ends is on the link
      type(location_t) :: location
      real(wp) :: place = 0.0_wp                 !! of its foot on the line of the pins, from the start, m
      real(wp) :: height = 0.0_wp                !! of its point to the left of that line, m
      real(wp), allocatable :: along(:), across(:) !! N
      real(wp), allocatable :: moment(:)         !! N m
      real(wp), allocatable :: held(:, :)        !! shape (positions, 3): stiffness of the spring along, mixed, across, N/m
      real(wp) :: torsion = 0.0_wp               !! and of a torsional one, N m/rad
   end type acting_cycle_t

contains

   !> Where a place on a link has its foot on the line of an arc between its pins, and its height to the left of that line.
   pure subroutine find_foot(mechanism, dimensions, model, arc, location, place, height, length)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      integer, intent(in) :: arc
      type(location_t), intent(in) :: location
      real(wp), intent(out) :: place, height, length !! m; the place from the start
      real(wp) :: start(2), finish(2), unit(2)

      associate (body => location%body, ends => mechanism%arcs(arc)%ends)
         call locate_point(mechanism, dimensions, body, model%reference(body), ends(at_start), start)
         call locate_point(mechanism, dimensions, body, model%reference(body), ends(at_finish), finish)
      end associate
      length = norm2(finish - start)
      unit = (finish - start)/length
      place = model%metre*dot_product(location%at - start, unit)
      height = model%metre*(unit(1)*(location%at(2) - start(2)) - unit(2)*(location%at(1) - start(1)))
      length = model%metre*length
   end subroutine find_foot

   !> Loads and ends of springs that are on the link of an arc, with their places.
   pure subroutine list_acting(mechanism, dimensions, model, arc, points, acting)
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(force_model_t), intent(in) :: model
      integer, intent(in) :: arc, points         !! points: positions in a turn
      type(acting_cycle_t), allocatable, intent(out) :: acting(:)
      type(acting_cycle_t) :: list(size(model%loads) + 2*size(model%springs))
      real(wp) :: length
      integer :: k, e, many

      many = 0
      associate (body => mechanism%arcs(arc)%body)
         do k = 1, size(model%loads)
            if (model%loads(k)%location%body /= body) cycle
            many = many + 1
            list(many)%load = k
            list(many)%location = model%loads(k)%location
         end do
         do k = 1, size(model%springs)
            do e = 1, size(model%springs(k)%ends)
               if (model%springs(k)%ends(e)%body /= body) cycle
               many = many + 1
               list(many)%spring = k
               list(many)%end = e
               list(many)%location = model%springs(k)%ends(e)
               if (model%springs(k)%torsional) list(many)%torsion = model%springs(k)%stiffness
            end do
         end do
      end associate
      do k = 1, many
         associate (a => list(k))
            call find_foot(mechanism, dimensions, model, arc, a%location, a%place, a%height, length)
            a%place = min(max(a%place, 0.0_wp), length) ! at a pin but for rounding
            allocate (a%along(points), a%across(points), a%moment(points), a%held(points, 3), source=0.0_wp)
         end associate
      end do
      acting = list(:many)
   end subroutine list_acting

   !> Direction of an arc of a link at the first `n` positions of the block just solved. Shape of the result: (2, n).
   pure function direction_of_arc(problem, arc, n) result(unit)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: arc, n
      real(wp) :: unit(2, n)
      integer :: i

      associate (link => problem%linkage, points_of => problem%plan%joint_points, ends => problem%mechanism%arcs(arc)%ends)
         do i = 1, n
            unit(:, i) = [link%store%v(i, link%point_x(points_of(ends(at_finish)))) &
                          - link%store%v(i, link%point_x(points_of(ends(at_start)))), &
                          link%store%v(i, link%point_y(points_of(ends(at_finish)))) &
                          - link%store%v(i, link%point_y(points_of(ends(at_start))))]
            unit(:, i) = unit(:, i)/norm2(unit(:, i))
         end do
      end associate
   end function direction_of_arc

   !> Forces, couples and stiffnesses at the first `n` positions of the block just solved, whose bodies are moved. The wrenches of
   !> `forces` are lost.
   subroutine follow_acting(problem, model, unit, input, offset, n, forces, acting)
      type(problem_t), intent(in) :: problem
      type(force_model_t), intent(in) :: model   !! without dampers
      real(wp), intent(in) :: unit(:, :)         !! shape (2, n): the x axis of the link
      real(wp), intent(in) :: input(:)           !! shape (n): degrees
      integer, intent(in) :: offset, n           !! positions before the block, and in it
      type(forces_t), intent(inout) :: forces
      type(acting_cycle_t), intent(inout) :: acting(:)
      real(wp) :: zx(padded(n)), zy(padded(n))
      integer :: k, i

      do k = 1, size(acting)
         associate (a => acting(k), row => forces%bodies(acting(k)%location%body)%wrench, w => forces%w%v)
            call clear_wrenches(n, forces)
            if (a%load > 0) then
               call add_source(problem, model, first_load() + a%load - 1, input, n, forces)
            else
               call add_source(problem, model, first_spring(model) + a%spring - 1, input, n, forces)
            end if
            do i = 1, n
               a%along(offset + i) = w(i, row)*unit(1, i) + w(i, row + 1)*unit(2, i)
               a%across(offset + i) = w(i, row + 1)*unit(1, i) - w(i, row)*unit(2, i)
            end do
            if (a%load > 0) then
               associate (load => model%loads(a%load), moment => a%moment(offset + 1:offset + n))
                  moment = load%moment
                  if (load%table > 0) moment = moment*table_factors(model, load%table, input, .true.)
               end associate
            else if (model%springs(a%spring)%torsional) then
               a%moment(offset + 1:offset + n) = forces%metre*w(1:n, row + 2)
            else
               call find_location(problem, forces, a%location, padded(n), zx, zy)
               call hold(a)
            end if
         end associate
      end do

   contains

      !> A spring of stiffness k that pulls along u: k u u' + pull/length (1 - u u').
      subroutine hold(a)
         type(acting_cycle_t), intent(inout) :: a
         real(wp) :: bx(padded(n)), by(padded(n)), gap(2), length, turned, stretch, stiffness

         associate (spring => model%springs(a%spring))
            call find_location(problem, forces, spring%ends(3 - a%end), padded(n), bx, by)
            do i = 1, n
               gap = [(bx(i) - zx(i))*unit(1, i) + (by(i) - zy(i))*unit(2, i), &
                      (by(i) - zy(i))*unit(1, i) - (bx(i) - zx(i))*unit(2, i)]
               length = norm2(gap)
               stretch = length*forces%metre - spring%free*model%metre
               stiffness = spring%slope(stretch, model%metre)
               turned = stiffness
               if (length > 0.0_wp) then
                  gap = gap/length
                  length = length*forces%metre
                  turned = spring%pull(stretch, 0.0_wp, model%metre)/length
               end if
               a%held(offset + i, :) = (stiffness - turned)*[gap(1)**2, gap(1)*gap(2), gap(2)**2] &
                                       + turned*[1.0_wp, 0.0_wp, 1.0_wp]
            end do
         end associate
      end subroutine hold
   end subroutine follow_acting
end module psalm_link_loads
