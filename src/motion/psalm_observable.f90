!> The output of a linkage: its value, rates, changes with the dimensions and error bound.
!>
!> The one place that knows what an output is computed from. Lengths are in the user's unit, angles in degrees, rates and
!> derivatives of angles per radian where nothing else is said. Source: Oldham (1977), chapter 5 and appendix B.
module psalm_observable
   use psalm_angles, only: unit_vector, angles_between, angles_between_lanes, degrees_of, within_turn
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp, degrees_per_radian, radians_per_degree
   use psalm_lanes, only: lanes
   use psalm_linkage, only: linkage_t
   use psalm_output_kind, only: output_kind_t, output_kind, motion_point, motion_distance, motion_slide
   use psalm_plan, only: plan_t
   use psalm_rows, only: rows_t
   use psalm_dimensions, only: dimensions_t
   use psalm_mechanism, only: mechanism_t
   use psalm_parameters, only: variable_outlk, variable_outang, variable_origlk, variable_origng
   implicit none (type, external)
   private
   public :: observable_t, output_lanes_t, at_origin

   real(wp), parameter :: at_origin = 64.0_wp*epsilon(1.0_wp) !! relative distance below which a point lies on the origin

   type :: observable_t
      integer :: motion = motion_point
      type(output_kind_t) :: kind
      integer :: arc = 0                                !! sequential number of the arc that carries the output
      integer :: root_x = 0, root_y = 0                 !! rows: unit vector that the output arc is turned from
      integer :: base_x = 0, base_y = 0                 !! rows: point that the output arc starts from
      integer :: slide = 0                              !! row: length that is the output
      real(wp) :: angle = 0.0_wp, c = 1.0_wp, s = 0.0_wp !! output arc from that unit vector: degrees, cosine, sine
      real(wp) :: length = 0.0_wp                       !! of the output arc
      real(wp) :: origin_angle = 0.0_wp, origin_c = 1.0_wp, origin_s = 0.0_wp !! direction of the input pivot
      real(wp) :: origin_x = 0.0_wp, origin_y = 0.0_wp  !! the input pivot
   contains
      procedure :: locate
      procedure :: bind => bind_observable
      procedure :: observe
      procedure :: miss
      procedure :: observe_lanes
      procedure :: miss_lanes
      procedure :: actual
      procedure :: rates => rates_of_output
      procedure :: change => change_of_output
      procedure :: change_of_rates
      procedure :: change_of_origin
      procedure :: bound => bound_of_output
   end type observable_t

   !> Numbers of an output in linkages side by side: as the components of the same names.
   type :: output_lanes_t
      real(wp) :: c(lanes) = 1.0_wp, s(lanes) = 0.0_wp, length(lanes) = 0.0_wp
      real(wp) :: origin_x(lanes) = 0.0_wp, origin_y(lanes) = 0.0_wp
   end type output_lanes_t

contains

   !> Find the rows in a linkage prepared for a plan.
   subroutine locate(self, motion, mechanism, plan, link)
      class(observable_t), intent(inout) :: self
      integer, intent(in) :: motion
      type(mechanism_t), intent(in) :: mechanism
      type(plan_t), intent(in) :: plan
      type(linkage_t), intent(in) :: link

      self%motion = motion
      self%kind = output_kind(motion)
      self%arc = mechanism%outputs(1)%arc
      self%root_x = link%root_x(plan%root(self%arc))
      self%root_y = link%root_y(plan%root(self%arc))
      self%base_x = link%point_x(plan%output_point)
      self%base_y = link%point_y(plan%output_point)
      self%slide = 0
      if (motion == motion_slide) self%slide = link%slide(plan%length_slot(self%arc))
   end subroutine locate

   !> Put dimensions in. Only angles that differ from the last ones cost a sine and a cosine.
   pure subroutine bind_observable(self, dimensions, link)
      class(observable_t), intent(inout) :: self
      type(dimensions_t), intent(in) :: dimensions
      type(linkage_t), intent(in) :: link            !! bound to them
      real(wp) :: angle

      angle = link%angle(self%arc) + dimensions%outang
      if (angle /= self%angle) call unit_vector(angle, self%c, self%s)
      self%angle = angle
      self%length = dimensions%outlk
      angle = dimensions%origng
      if (angle /= self%origin_angle) call unit_vector(angle, self%origin_c, self%origin_s)
      self%origin_angle = angle
      self%origin_x = dimensions%origlk*self%origin_c
      self%origin_y = dimensions%origlk*self%origin_s
   end subroutine bind_observable

   ! ---- value -------------------------------------------------------------------------------------------------------

   !> Output of the block just solved: lengths into the rows `out`, the direction of the output arc into `direction`.
   pure subroutine observe(self, n, link)
      class(observable_t), intent(in) :: self
      integer, intent(in) :: n                       !! positions, padded
      type(linkage_t), intent(inout) :: link

      associate (v => link%store%v, back => 1.0_wp/link%scale, out => link%out, to => link%direction)
         if (self%kind%has_point) then
            call output_points(n, v(1, self%base_x), v(1, self%base_y), v(1, self%root_x), v(1, self%root_y), back, &
                               self%c*self%length, self%s*self%length, self%origin_x, self%origin_y, v(1, out(1)), v(1, out(2)))
            if (self%motion == motion_distance) call distances(n, v(1, out(1)), v(1, out(2)))
         else if (self%slide > 0) then
            call scaled(n, v(1, self%slide), back, v(1, out(1)))
         end if
         if (self%kind%angle > 0) call turned(n, v(1, self%root_x), v(1, self%root_y), self%c, self%s, v(1, to(1)), v(1, to(2)))
      end associate
   end subroutine observe

   !> Desired less actual value of a component, into the row `miss`. Lengths must have been observed.
   pure subroutine miss(self, component, n, wanted, toward_x, toward_y, link)
      class(observable_t), intent(in) :: self
      integer, intent(in) :: component, n
      real(wp), intent(in) :: wanted(n)              !! lengths
      real(wp), intent(in) :: toward_x(n), toward_y(n) !! unit vectors of the angles wanted
      type(linkage_t), intent(inout) :: link

      associate (v => link%store%v)
         if (component == self%kind%angle) then
            call angles_between(n, v(1, self%root_x), v(1, self%root_y), self%c, self%s, toward_x, toward_y, v(1, link%miss))
         else
            call find_deviations(n, wanted, v(1, link%out(component)), v(1, link%miss))
         end if
      end associate
   end subroutine miss

   !> `observe` for linkages side by side whose lengths are not scaled: the lengths of the output, into the rows `out`. Rows of the
   !> store have the shape (lanes, positions).
   pure subroutine observe_lanes(self, n, numbers, link, store)
      class(observable_t), intent(in) :: self
      integer, intent(in) :: n
      type(output_lanes_t), intent(in) :: numbers
      type(linkage_t), intent(in) :: link            !! any of them: where the rows are
      type(rows_t), intent(inout) :: store

      associate (v => store%v, out => link%out)
         if (self%kind%has_point) then
            call output_points_lanes(n, v(1, self%base_x), v(1, self%base_y), v(1, self%root_x), v(1, self%root_y), &
                                     numbers%c*numbers%length, numbers%s*numbers%length, numbers%origin_x, numbers%origin_y, &
                                     v(1, out(1)), v(1, out(2)))
            if (self%motion == motion_distance) call distances(lanes*n, v(1, out(1)), v(1, out(2)))
         else if (self%slide > 0) then
            call scaled(lanes*n, v(1, self%slide), 1.0_wp, v(1, out(1)))
         end if
      end associate
   end subroutine observe_lanes

   !> `miss` for linkages side by side.
   pure subroutine miss_lanes(self, component, n, numbers, wanted, toward_x, toward_y, link, store)
      class(observable_t), intent(in) :: self
      integer, intent(in) :: component, n
      type(output_lanes_t), intent(in) :: numbers
      real(wp), intent(in) :: wanted(n), toward_x(n), toward_y(n) !! the same for all of them
      type(linkage_t), intent(in) :: link
      type(rows_t), intent(inout) :: store

      associate (v => store%v)
         if (component == self%kind%angle) then
            call angles_between_lanes(n, v(1, self%root_x), v(1, self%root_y), numbers%c, numbers%s, toward_x, toward_y, &
                                      v(1, link%miss))
         else
            call find_deviations_lanes(n, wanted, v(1, link%out(component)), v(1, link%miss))
         end if
      end associate
   end subroutine miss_lanes

   !> Value of a component at position i of the block: an angle within a turn.
   pure real(wp) function actual(self, component, i, link)
      class(observable_t), intent(in) :: self
      integer, intent(in) :: component, i
      type(linkage_t), intent(in) :: link

      if (component == self%kind%angle) then
         actual = within_turn(degrees_of(link%store%v(i, link%direction(1)), link%store%v(i, link%direction(2))))
      else
         actual = link%store%v(i, link%out(component))
      end if
   end function actual

   ! ---- derivatives by the input ------------------------------------------------------------------------------------

   !> Derivatives of the components at position `i` of the block, orders 1 to `orders`; of an angle in radians.
   !>
   !> MOTION 2: zero where the point lies on the origin (`at_origin`), where the distance has none.
   subroutine rates_of_output(self, link, d, i, orders, values)
      class(observable_t), intent(in) :: self
      type(linkage_t), intent(in) :: link
      type(rows_t), intent(in) :: d(:)               !! by order: derivatives of the rows of the store
      integer, intent(in) :: i, orders
      real(wp), intent(out) :: values(:, :)          !! shape (3, components)
      real(wp) :: px, py, rx, ry, r, w1, w2, w3, back, x(3), y(3)
      integer :: order

      values = 0.0_wp
      back = 1.0_wp/link%scale
      if (self%kind%angle > 0) then
         do order = 1, orders
            values(order, self%kind%angle) = d(order)%v(i, self%root_x)
         end do
      end if
      if (self%slide > 0) then
         do order = 1, orders
            values(order, 1) = d(order)%v(i, self%slide)*back
         end do
      end if
      if (.not. self%kind%has_point) return
      rx = link%store%v(i, self%root_x)
      ry = link%store%v(i, self%root_y)
      px = (self%c*rx - self%s*ry)*self%length
      py = (self%c*ry + self%s*rx)*self%length
      w1 = d(1)%v(i, self%root_x)
      w2 = d(2)%v(i, self%root_x)
      w3 = d(3)%v(i, self%root_x)
      x = 0.0_wp
      y = 0.0_wp
      do order = 1, orders
         x(order) = d(order)%v(i, self%base_x)*back
         y(order) = d(order)%v(i, self%base_y)*back
         select case (order)
         case (1)
            x(1) = x(1) - w1*py
            y(1) = y(1) + w1*px
         case (2)
            x(2) = x(2) - w1*w1*px - w2*py
            y(2) = y(2) - w1*w1*py + w2*px
         case default
            x(3) = x(3) - 3.0_wp*w1*w2*px - (w3 - w1**3)*py
            y(3) = y(3) - 3.0_wp*w1*w2*py + (w3 - w1**3)*px
         end select
      end do
      if (self%motion /= motion_distance) then
         values(:, 1) = x
         values(:, 2) = y
         return
      end if
      r = abs(px) + abs(py) + abs(self%origin_x) + abs(self%origin_y)
      px = px + link%store%v(i, self%base_x)*back + self%origin_x
      py = py + link%store%v(i, self%base_y)*back + self%origin_y
      ! at the origin the distance has a corner and no derivative
      if (hypotenuse(px, py) <= at_origin*max(r, maxval(link%length)*back)) return
      r = hypotenuse(px, py)
      ! r r' = x x' + y y', and its derivatives
      w1 = (px*x(1) + py*y(1))/r
      w2 = (px*x(2) + py*y(2) + x(1)**2 + y(1)**2 - w1*w1)/r
      w3 = (px*x(3) + py*y(3) + 3.0_wp*(x(1)*x(2) + y(1)*y(2)) - 3.0_wp*w1*w2)/r
      values(:, 1) = [w1, w2, w3]
   end subroutine rates_of_output

   ! ---- derivatives by a variable -----------------------------------------------------------------------------------

   !> Change of the components with a variable, at the first `n` positions of the block, in the listing's units.
   subroutine change_of_output(self, link, d, n, variable, turn, unit, change)
      class(observable_t), intent(in) :: self
      type(linkage_t), intent(in) :: link
      type(rows_t), intent(in) :: d                  !! changes of the rows of the store
      integer, intent(in) :: n
      integer, intent(in) :: variable                !! its kind
      real(wp), intent(in) :: turn                   !! of the output arc's fixed angle with it
      real(wp), intent(in) :: unit                   !! radians a unit of the variable is worth, or 1
      real(wp), intent(out) :: change(:, :)          !! shape (n, components)
      real(wp) :: all_turn, back, ex, ey, w, grow, ox, oy
      integer :: i

      back = 1.0_wp/link%scale
      all_turn = turn
      if (variable == variable_outang) all_turn = turn + 1.0_wp
      associate (v => link%store%v)
         if (self%kind%angle > 0) change(:, self%kind%angle) = (d%v(1:n, self%root_x) + all_turn)*(unit*degrees_per_radian)
         if (self%slide > 0) change(:, 1) = d%v(1:n, self%slide)*(back*unit)
         if (.not. self%kind%has_point) return
         grow = merge(1.0_wp, 0.0_wp, variable == variable_outlk)
         call self%change_of_origin(variable, ox, oy)
         do i = 1, n
            ex = self%c*v(i, self%root_x) - self%s*v(i, self%root_y)
            ey = self%c*v(i, self%root_y) + self%s*v(i, self%root_x)
            w = (d%v(i, self%root_x) + all_turn)*self%length
            change(i, 1) = (d%v(i, self%base_x)*back + grow*ex - w*ey + ox)*unit
            if (self%motion /= motion_distance) then
               change(i, 2) = (d%v(i, self%base_y)*back + grow*ey + w*ex + oy)*unit
            else
               ey = (d%v(i, self%base_y)*back + grow*ey + w*ex + oy)*unit
               change(i, 1) = along_distance(self, link, i, change(i, 1), ey)
            end if
         end do
      end associate
   end subroutine change_of_output

   !> Change of the derivatives of the components by the input with a variable, at position `i` of the block, orders 1 and 2; of
   !> an angle in radians.
   !>
   !> The output arc is an arc of fixed length: formulas of `psalm_arc_kernels`, `add_change_of_rate`. MOTION 2: zero on the origin.
   subroutine change_of_rates(self, link, d, rates, i, variable, turn, unit, change)
      class(observable_t), intent(in) :: self
      type(linkage_t), intent(in) :: link
      type(rows_t), intent(in) :: d(0:)              !! changes of the rows of the store, of their first and second derivatives
      type(rows_t), intent(in) :: rates(:)           !! by order: derivatives of the rows of the store
      integer, intent(in) :: i
      integer, intent(in) :: variable                !! its kind
      real(wp), intent(in) :: turn                   !! of the output arc's fixed angle with it
      real(wp), intent(in) :: unit                   !! radians a unit of the variable is worth, or 1
      real(wp), intent(out) :: change(:, :)          !! shape (components, 2)
      complex(wp) :: e, p(0:2), dp(0:2)              ! unit vector of the output arc; point and its change, by order
      real(wp) :: back, h(0:2), w1, w2, g, length, r(0:2), dr(0:2), x, y
      integer :: order

      change = 0.0_wp
      back = 1.0_wp/link%scale
      do order = 0, 2
         h(order) = d(order)%v(i, self%root_x)
      end do
      if (self%kind%angle > 0) change(self%kind%angle, :) = h(1:)*unit
      if (self%slide > 0) change(1, :) = [d(1)%v(i, self%slide), d(2)%v(i, self%slide)]*(back*unit)
      if (.not. self%kind%has_point) return
      h(0) = h(0) + turn
      if (variable == variable_outang) h(0) = h(0) + 1.0_wp
      g = merge(1.0_wp, 0.0_wp, variable == variable_outlk)
      length = self%length
      w1 = rates(1)%v(i, self%root_x)
      w2 = rates(2)%v(i, self%root_x)
      e = cmplx(self%c*link%store%v(i, self%root_x) - self%s*link%store%v(i, self%root_y), &
                self%c*link%store%v(i, self%root_y) + self%s*link%store%v(i, self%root_x), wp)
      dp(0) = e*cmplx(g, length*h(0), wp)
      dp(1) = e*cmplx(-length*w1*h(0), g*w1 + length*h(1), wp)
      dp(2) = e*cmplx(-g*w1**2 - length*(2.0_wp*w1*h(1) + w2*h(0)), g*w2 + length*(h(2) - w1**2*h(0)), wp)
      do order = 0, 2
         dp(order) = dp(order) + back*cmplx(d(order)%v(i, self%base_x), d(order)%v(i, self%base_y), wp)
      end do
      if (self%motion /= motion_distance) then
         change(1, :) = real(dp(1:), wp)*unit
         change(2, :) = aimag(dp(1:))*unit
         return
      end if
      call self%change_of_origin(variable, x, y)
      dp(0) = dp(0) + cmplx(x, y, wp)
      call output_vector(self, link, i, x, y)
      r(0) = hypotenuse(x, y)
      if (r(0) <= at_origin*maxval(link%length)*back) return
      p(0) = cmplx(x, y, wp)
      p(1) = back*cmplx(rates(1)%v(i, self%base_x), rates(1)%v(i, self%base_y), wp) + e*cmplx(0.0_wp, length*w1, wp)
      p(2) = back*cmplx(rates(2)%v(i, self%base_x), rates(2)%v(i, self%base_y), wp) + e*cmplx(-length*w1**2, length*w2, wp)
      ! r r' = p.p', r r'' + r'**2 = p.p'' + p'.p', and their changes
      dr(0) = dot(p(0), dp(0))/r(0)
      r(1) = dot(p(0), p(1))/r(0)
      dr(1) = (dot(dp(0), p(1)) + dot(p(0), dp(1)) - dr(0)*r(1))/r(0)
      r(2) = (dot(p(0), p(2)) + dot(p(1), p(1)) - r(1)**2)/r(0)
      dr(2) = (dot(dp(0), p(2)) + dot(p(0), dp(2)) + 2.0_wp*(dot(p(1), dp(1)) - r(1)*dr(1)) - dr(0)*r(2))/r(0)
      change(1, :) = dr(1:)*unit

   contains

      pure real(wp) function dot(a, b)
         complex(wp), intent(in) :: a, b

         dot = a%re*b%re + a%im*b%im
      end function dot
   end subroutine change_of_rates

   !> Change of the distance from the origin where the point changes by (dx, dy).
   pure real(wp) function along_distance(self, link, i, dx, dy) result(change)
      class(observable_t), intent(in) :: self
      type(linkage_t), intent(in) :: link
      integer, intent(in) :: i
      real(wp), intent(in) :: dx, dy
      real(wp) :: x, y, r

      call output_vector(self, link, i, x, y)
      r = hypotenuse(x, y)
      change = dx
      if (r > 0.0_wp) change = (x/r)*dx + (y/r)*dy
   end function along_distance

   !> Change of the input pivot with a variable (per radian for its angle).
   pure subroutine change_of_origin(self, variable, x, y)
      class(observable_t), intent(in) :: self
      integer, intent(in) :: variable
      real(wp), intent(out) :: x, y

      x = 0.0_wp
      y = 0.0_wp
      if (variable == variable_origlk) then
         x = self%origin_c
         y = self%origin_s
      else if (variable == variable_origng) then
         x = -self%origin_y
         y = self%origin_x
      end if
   end subroutine change_of_origin

   !> Output point in machine coordinates at position `i` of the block.
   pure subroutine output_vector(self, link, i, x, y)
      class(observable_t), intent(in) :: self
      type(linkage_t), intent(in) :: link
      integer, intent(in) :: i
      real(wp), intent(out) :: x, y
      real(wp) :: rx, ry

      rx = link%store%v(i, self%root_x)
      ry = link%store%v(i, self%root_y)
      x = link%store%v(i, self%base_x)/link%scale + self%origin_x + (self%c*rx - self%s*ry)*self%length
      y = link%store%v(i, self%base_y)/link%scale + self%origin_y + (self%c*ry + self%s*rx)*self%length
   end subroutine output_vector

   ! ---- condition ---------------------------------------------------------------------------------------------------

   !> Error bound relative to the output, in units of epsilon, at position `i`: MOTION 0 and 4 to the distance of the output
   !> point from the machine origin, 2 and 3 to the distance or length, 1 to one radian.
   pure real(wp) function bound_of_output(self, link, row, i, worst) result(number)
      class(observable_t), intent(in) :: self
      type(linkage_t), intent(in) :: link
      real(wp), intent(in) :: row(:)                 !! by row of the store: bounds
      integer, intent(in) :: i
      real(wp), intent(in) :: worst                  !! larger numbers say nothing more
      real(wp) :: arc, x, y

      arc = row(self%root_x) + 1.0_wp + abs(self%angle)*radians_per_degree
      number = arc
      if (self%slide > 0) number = ratio(row(self%slide), abs(link%store%v(i, self%slide)))
      if (self%kind%has_point) then
         x = link%store%v(i, link%out(1))*link%scale
         y = link%store%v(i, link%out(2))*link%scale
         number = row(self%base_x) + abs(self%length)*link%scale*(arc + 1.0_wp) &
                  + hypotenuse(self%origin_x, self%origin_y)*link%scale*(2.0_wp + abs(self%origin_angle)*radians_per_degree)
         if (self%motion /= motion_distance) x = hypotenuse(x, y)
         number = 1.0_wp + ratio(number, abs(x))
      end if
      number = min(number, worst)

   contains

      !> a/b, but no more than `worst`.
      pure real(wp) function ratio(a, b)
         real(wp), intent(in) :: a, b   !! a >= 0, b >= 0

         ratio = worst
         if (b*worst > a) ratio = a/b
      end function ratio
   end function bound_of_output

   ! ---- kernels -----------------------------------------------------------------------------------------------------

   pure subroutine find_deviations(n, wanted, actual, miss)
      integer, intent(in) :: n
      real(wp), intent(in) :: wanted(n), actual(n)
      real(wp), intent(out) :: miss(n)

      miss = wanted - actual
   end subroutine find_deviations

   pure subroutine find_deviations_lanes(n, wanted, actual, miss)
      integer, intent(in) :: n
      real(wp), intent(in) :: wanted(n), actual(lanes, n)
      real(wp), intent(out) :: miss(lanes, n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            miss(l, i) = wanted(i) - actual(l, i)
         end do
      end do
   end subroutine find_deviations_lanes

   pure subroutine scaled(n, from, factor, to)
      integer, intent(in) :: n
      real(wp), intent(in) :: from(n), factor
      real(wp), intent(out) :: to(n)

      to = from*factor
   end subroutine scaled

   pure subroutine turned(n, rx, ry, c, s, x, y)
      integer, intent(in) :: n
      real(wp), intent(in) :: rx(n), ry(n), c, s
      real(wp), intent(out) :: x(n), y(n)
      integer :: i

      do i = 1, n
         x(i) = c*rx(i) - s*ry(i)
         y(i) = c*ry(i) + s*rx(i)
      end do
   end subroutine turned

   pure subroutine output_points(n, px, py, rx, ry, back, c, s, origin_x, origin_y, x, y)
      integer, intent(in) :: n
      real(wp), intent(in) :: px(n), py(n), rx(n), ry(n), back, c, s, origin_x, origin_y
      real(wp), intent(out) :: x(n), y(n)
      integer :: i

      do i = 1, n
         x(i) = px(i)*back + (c*rx(i) - s*ry(i)) + origin_x
         y(i) = py(i)*back + (c*ry(i) + s*rx(i)) + origin_y
      end do
   end subroutine output_points

   pure subroutine output_points_lanes(n, px, py, rx, ry, c, s, origin_x, origin_y, x, y)
      integer, intent(in) :: n
      real(wp), intent(in) :: px(lanes, n), py(lanes, n), rx(lanes, n), ry(lanes, n)
      real(wp), intent(in) :: c(lanes), s(lanes), origin_x(lanes), origin_y(lanes)
      real(wp), intent(out) :: x(lanes, n), y(lanes, n)
      integer :: i, l

      do i = 1, n
         !$omp simd
         do l = 1, lanes
            x(l, i) = px(l, i) + (c(l)*rx(l, i) - s(l)*ry(l, i)) + origin_x(l)
            y(l, i) = py(l, i) + (c(l)*ry(l, i) + s(l)*rx(l, i)) + origin_y(l)
         end do
      end do
   end subroutine output_points_lanes

   !> Distance from the machine origin, in place of x.
   pure subroutine distances(n, x, y)
      integer, intent(in) :: n
      real(wp), intent(inout) :: x(n)
      real(wp), intent(in) :: y(n)
      real(wp) :: largest
      integer :: i

      do i = 1, n
         largest = max(max(abs(x(i)), abs(y(i))), tiny(1.0_wp))
         x(i) = largest*sqrt((x(i)/largest)**2 + (y(i)/largest)**2)
      end do
   end subroutine distances
end module psalm_observable
