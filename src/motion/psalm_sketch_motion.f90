!> Joints and slides of a sketch at the positions of a block that its loops have been solved at, with their derivatives by time.
!>
!> A joint is a point of the plan, or fixed on a link at a distance from one; joints of the frame stand still.
module psalm_sketch_motion
   use psalm_angles, only: unit_vector
   use psalm_closure, only: most_orders
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, ring_t
   use psalm_rates, only: rates_t, derivatives_of, in_time
   implicit none (type, external)
   private
   public :: sketch_motion_t, locate_sketch, observe_sketch

   !> A joint that moves.
   type :: moving_t
      integer :: joint = 0
      integer :: arc = 0                    !! sequential number: its direction carries the offset
      complex(wp) :: offset = (0.0_wp, 0.0_wp) !! from the point of the plan, in the axes of that arc, user's unit
   end type moving_t

   !> Where joints and slides of a sketch are to be found in the store.
   type :: sketch_motion_t
      complex(wp), allocatable :: drawn(:)  !! shape (joints)
      type(moving_t), allocatable :: moving(:)
      integer, allocatable :: points(:, :)  !! shape (2, moving joints): loop and arc, as `make_plan` has them
      integer, allocatable :: arcs(:)       !! by slide: sequential number; 0: it has none
      real(wp), allocatable :: sense(:), zero(:) !! by slide: travel = sense*length + zero
   end type sketch_motion_t

contains

   !> Find joints and slides. The plan must then be made with `points`.
   subroutine locate_sketch(set, mechanism, sketch)
      type(data_set_t), intent(in) :: set               !! a sketch with its loops
      type(mechanism_t), intent(in) :: mechanism
      type(sketch_motion_t), intent(out) :: sketch
      type(moving_t) :: one
      type(ring_t) :: ring
      real(wp) :: c, s
      integer :: j, k, arc

      sketch%drawn = cmplx(set%sketch%x, set%sketch%y, wp)
      allocate (sketch%moving(0), sketch%points(2, 0))
      do j = 1, size(set%joint_places)
         associate (place => set%joint_places(j))
            if (place%arc == 0) cycle
            one%joint = j
            one%arc = mechanism%seq(place%loop, place%arc)
            call unit_vector(place%turn + place%angle, c, s)
            one%offset = place%distance*cmplx(c, s, wp)
            arc = place%arc
            if (place%from_start) then
               ring = mechanism%ring_of(place%loop, one%arc)
               arc = merge(0, arc - 1, one%arc == ring%first)
            end if
            sketch%moving = [sketch%moving, one]
            sketch%points = reshape([sketch%points, place%loop, arc], [2, size(sketch%moving)])
         end associate
      end do
      allocate (sketch%arcs(size(set%travels)), source=0)
      do k = 1, size(set%travels)
         if (set%travels(k)%arc > 0) sketch%arcs(k) = mechanism%seq(set%travels(k)%loop, set%travels(k)%arc)
      end do
      sketch%sense = set%travels%sense
      sketch%zero = set%travels%zero
   end subroutine locate_sketch

   !> Joints and slides at the first `n` positions of the block just solved and differentiated.
   subroutine observe_sketch(sketch, problem, rates, n, speed, accel, joint, moved)
      type(sketch_motion_t), intent(in) :: sketch
      type(problem_t), intent(in) :: problem
      type(rates_t), intent(in) :: rates
      integer, intent(in) :: n
      real(wp), intent(in) :: speed, accel              !! of the input: radians or length a second
      complex(wp), intent(out) :: joint(:, 0:, :)       !! shape (joints, 0:most_orders, n): places and their derivatives by time
      real(wp), intent(out) :: moved(:, 0:, :)          !! shape (slides, 0:most_orders, n): travel from the drawing
      complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
      complex(wp) :: z(0:most_orders), u
      real(wp) :: back, w(most_orders), x(most_orders), y(most_orders)
      integer :: k, m, order, row

      joint = (0.0_wp, 0.0_wp)
      moved = 0.0_wp
      associate (link => problem%linkage, plan => problem%plan)
         back = 1.0_wp/link%scale
         do m = 1, n
            joint(:, 0, m) = sketch%drawn
         end do
         do k = 1, size(sketch%moving)
            associate (one => sketch%moving(k), px => link%point_x(plan%joint_points(k)), &
                       py => link%point_y(plan%joint_points(k)), rx => link%root_x(plan%root(sketch%moving(k)%arc)), &
                       ry => link%root_y(plan%root(sketch%moving(k)%arc)))
               do m = 1, n
                  z(0) = cmplx(link%store%v(m, px)*back + problem%output%origin_x, &
                               link%store%v(m, py)*back + problem%output%origin_y, wp)
                  x = derivatives_of(rates, px, m)*back
                  y = derivatives_of(rates, py, m)*back
                  z(1:) = cmplx(x, y, wp)
                  if (abs(one%offset) > 0.0_wp) then
                     u = one%offset*cmplx(link%x(one%arc), link%y(one%arc), wp)*cmplx(link%store%v(m, rx), link%store%v(m, ry), wp)
                     w = derivatives_of(rates, rx, m)
                     z(0) = z(0) + u
                     z(1) = z(1) + i*w(1)*u
                     z(2) = z(2) + cmplx(-w(1)**2, w(2), wp)*u
                     z(3) = z(3) + cmplx(-3.0_wp*w(1)*w(2), w(3) - w(1)**3, wp)*u
                  end if
                  joint(one%joint, 0, m) = z(0)
                  x = in_time(z(1:)%re, speed, accel)
                  y = in_time(z(1:)%im, speed, accel)
                  joint(one%joint, 1:, m) = cmplx(x, y, wp)
               end do
            end associate
         end do
         do k = 1, size(sketch%arcs)
            if (sketch%arcs(k) == 0) cycle
            row = link%slide(plan%length_slot(sketch%arcs(k)))
            do m = 1, n
               moved(k, 0, m) = sketch%sense(k)*(link%store%v(m, row)*back) + sketch%zero(k)
               x = in_time(derivatives_of(rates, row, m)*back, speed, accel)
               do order = 1, most_orders
                  moved(k, order, m) = sketch%sense(k)*x(order)
               end do
            end do
         end do
      end associate
   end subroutine observe_sketch
end module psalm_sketch_motion
