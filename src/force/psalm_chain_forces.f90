!> Forces of a sketch that is followed in the poses of its links: any Assur groups, any number of drives.
!>
!> A constraint does no work, so that its forces are the multipliers of its equations: for each group, last first, one linear
!> system, the transpose of that by which its poses were found; a drive's torque or force is the multiplier of its own equation.
!> What a group does to links placed before it is then part of what these bear. Source: Lanczos (1970), chapter III; Oldham
!> (1977), 15.1.
module psalm_chain_forces
   use psalm_angles, only: degrees_of, nearest_difference
   use psalm_chain_force_model, only: chain_model_t, chain_spot_t, pair_pin, pair_slide, pair_gears
   use psalm_chain_motion, only: chain_motion_t
   use psalm_closure, only: closure_t, state_t, matrix_of, most_orders, point_rate, travel, turned, rank_lost, row_pin, row_angle, &
                            row_line, row_gear, row_turn
   use psalm_dense, only: factors_t, factorise, solve_transposed
   use psalm_force_analysis, only: force_table_t, column_of_joint, column_drive, column_fx, column_fy, column_moment, &
                                   fixed_columns
   use psalm_force_model, only: mass_parameters, parameter_mass, parameter_mx, parameter_my, parameter_inertia
   use psalm_kinds, only: wp, radians_per_degree
   use psalm_kinetostatics, only: interpolated, most_sweeps, settled, source_inertia, source_weight
   use psalm_sketch, only: frame_link, drive_turns
   implicit none (type, external)
   private
   public :: analyse_chain, share_of_chain, chain_of_unit_masses, column_of_drive

   complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
   real(wp), parameter :: still = 64.0_wp*epsilon(1.0_wp) !! of the fastest turn or travel: a slower pair is at rest

   !> Room for one position. Forces in N, moments in N times the user's length, about the machine origin.
   type :: place_of_forces_t
      type(factors_t), allocatable :: factors(:)  !! shape (groups)
      complex(wp), allocatable :: force(:)        !! shape (links)
      real(wp), allocatable :: moment(:)          !! shape (links)
      real(wp), allocatable :: push(:)            !! shape (drives): along the rods of cylinders
      complex(wp), allocatable :: pair(:)         !! shape (pairs): force on the second link; of a slide its real part is across
      real(wp), allocatable :: couple(:)          !! shape (pairs): of a slide
      real(wp), allocatable :: drive(:)           !! shape (drives): N times length, or N
   end type place_of_forces_t

contains

   !> Columns of a table of forces: those of one drive, then the other drives.
   pure integer function chain_columns(closure, model)
      type(closure_t), intent(in) :: closure
      type(chain_model_t), intent(in) :: model

      chain_columns = fixed_columns + 2*size(model%pairs) + size(closure%sketch%drives) - 1
   end function chain_columns

   !> Column of a drive.
   pure integer function column_of_drive(model, drive)
      type(chain_model_t), intent(in) :: model
      integer, intent(in) :: drive

      column_of_drive = column_drive
      if (drive > 1) column_of_drive = fixed_columns + 2*size(model%pairs) + drive - 1
   end function column_of_drive

   !> Inertia, weight, then loads, then springs.
   pure integer function chain_sources(model)
      type(chain_model_t), intent(in) :: model

      chain_sources = source_weight + size(model%loads) + size(model%springs)
   end function chain_sources

   !> All forces at all positions. `table%dead` is the group that has none.
   subroutine analyse_chain(closure, motion, input, model, table)
      type(closure_t), intent(in) :: closure
      type(chain_motion_t), intent(in) :: motion
      real(wp), intent(in) :: input(:)         !! shape (positions): of the first drive, degrees or length, for tables of loads
      type(chain_model_t), intent(in) :: model
      type(force_table_t), intent(out) :: table
      type(place_of_forces_t) :: at
      integer :: k, source

      associate (n => size(motion%closed))
         allocate (table%value(n, chain_columns(closure, model)), source=0.0_wp)
         allocate (table%kinetic(n), table%growth(n), table%power(n), table%loss(n), source=0.0_wp)
         allocate (table%sweeps(n), source=1)
         allocate (table%dead(n), source=0)
         allocate (table%at_rest(n), source=.false.)
      end associate
      table%closed = motion%closed
      do k = 1, size(motion%closed)
         if (.not. motion%closed(k)) then
            table%dead(k) = motion%group(k)
            cycle
         end if
         call begin(closure, model, motion%states(k), at, table%dead(k))
         if (table%dead(k) > 0) cycle
         do source = source_inertia + 1, chain_sources(model)
            call add_source(closure, model, motion%states(k), source, input(k), at)
         end do
         table%power(k) = power_of(motion%states(k), model, at)
         call add_source(closure, model, motion%states(k), source_inertia, input(k), at)
         call find_energy(closure, model, motion%states(k), table%kinetic(k), table%growth(k))
         if (size(model%friction) == 0) then
            call sweep(closure, model, motion%states(k), at)
         else
            call rub(closure, model, motion%states(k), at, table%sweeps(k), table%at_rest(k), table%loss(k))
         end if
         call take_columns(closure, model, at, table%value(k, :))
      end do
   end subroutine analyse_chain

   !> What each source alone does, without friction: they add up. Shape of the result: (positions, columns, sources).
   subroutine share_of_chain(closure, motion, input, model, shares)
      type(closure_t), intent(in) :: closure
      type(chain_motion_t), intent(in) :: motion
      real(wp), intent(in) :: input(:)
      type(chain_model_t), intent(in) :: model
      real(wp), allocatable, intent(out) :: shares(:, :, :)
      type(place_of_forces_t) :: at
      integer :: k, source, dead

      allocate (shares(size(motion%closed), chain_columns(closure, model), chain_sources(model)), source=0.0_wp)
      do k = 1, size(motion%closed)
         if (.not. motion%closed(k)) cycle
         call begin(closure, model, motion%states(k), at, dead)
         if (dead > 0) cycle
         do source = 1, chain_sources(model)
            call clear(at)
            call add_source(closure, model, motion%states(k), source, input(k), at)
            call sweep(closure, model, motion%states(k), at)
            call take_columns(closure, model, at, shares(k, :, source))
         end do
      end do
   end subroutine share_of_chain

   !> Inertia forces of unit masses: every force is the sum over the links of these columns times the link's mass [kg], first
   !> moments [kg m] and moment of inertia [kg m2] about its first joint, in axes that are the machine's in the drawing.
   !>
   !> Shape of the result: (positions, columns, 4, links); those of the frame are zero. Masses on rods of cylinders are not in it.
   subroutine chain_of_unit_masses(closure, motion, model, columns)
      type(closure_t), intent(in) :: closure
      type(chain_motion_t), intent(in) :: motion
      type(chain_model_t), intent(in) :: model
      real(wp), allocatable, intent(out) :: columns(:, :, :, :)
      type(place_of_forces_t) :: at
      complex(wp) :: a, s, force
      real(wp) :: couple
      integer :: k, link, parameter, dead

      allocate (columns(size(motion%closed), chain_columns(closure, model), mass_parameters, size(closure%origin)), source=0.0_wp)
      do k = 1, size(motion%closed)
         if (.not. motion%closed(k)) cycle
         call begin(closure, model, motion%states(k), at, dead)
         if (dead > 0) cycle
         associate (state => motion%states(k))
            do link = frame_link + 1, size(closure%origin)
               a = state%t(link, 2)
               do parameter = 1, mass_parameters
                  call clear(at)
                  s = (0.0_wp, 0.0_wp)
                  if (parameter == parameter_mx) s = turned(state%phi(link, 0))
                  if (parameter == parameter_my) s = i*turned(state%phi(link, 0))
                  force = -cmplx(-state%phi(link, 1)**2, state%phi(link, 2), wp)*s
                  couple = -cross(s, a)
                  if (parameter == parameter_mass) force = -a*model%metre
                  if (parameter == parameter_inertia) couple = -state%phi(link, 2)/model%metre
                  call act(at, link, state%t(link, 0), force, couple)
                  call sweep(closure, model, state, at)
                  call take_columns(closure, model, at, columns(k, :, parameter, link))
               end do
            end do
         end associate
      end do
   end subroutine chain_of_unit_masses

   ! ---- one position ------------------------------------------------------------------------------------------------

   !> Factors of all groups, and no force anywhere. `dead` is a group at a dead point.
   subroutine begin(closure, model, state, at, dead)
      type(closure_t), intent(in) :: closure
      type(chain_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(place_of_forces_t), intent(inout) :: at
      integer, intent(out) :: dead
      integer :: g

      dead = 0
      if (.not. allocated(at%force)) then
         associate (sketch => closure%sketch)
            allocate (at%force(size(sketch%links)), at%moment(size(sketch%links)), at%push(size(sketch%drives)), &
                      at%pair(size(model%pairs)), at%couple(size(model%pairs)), at%drive(size(sketch%drives)), &
                      at%factors(size(closure%groups)))
         end associate
      end if
      call clear(at)
      do g = 1, size(closure%groups)
         if (size(closure%groups(g)%links) == 0) cycle
         call factorise(matrix_of(closure, state, g), at%factors(g))
         if (at%factors(g)%reciprocal_condition >= rank_lost) cycle
         dead = g
         return
      end do
   end subroutine begin

   pure subroutine clear(at)
      type(place_of_forces_t), intent(inout) :: at

      at%force = (0.0_wp, 0.0_wp)
      at%moment = 0.0_wp
      at%push = 0.0_wp
   end subroutine clear

   !> a x b of two vectors.
   elemental real(wp) function cross(a, b)
      complex(wp), intent(in) :: a, b

      cross = a%re*b%im - a%im*b%re
   end function cross

   !> a . b of two vectors.
   elemental real(wp) function dot(a, b)
      complex(wp), intent(in) :: a, b

      dot = a%re*b%re + a%im*b%im
   end function dot

   !> Place of a spot, or a derivative of it.
   pure complex(wp) function motion_of(closure, state, spot, order) result(z)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(chain_spot_t), intent(in) :: spot
      integer, intent(in) :: order
      complex(wp) :: p(0:most_orders)

      p = (0.0_wp, 0.0_wp)
      if (abs(spot%rod) > 0.0_wp) p = spot%rod*state%input(closure%cylinder(spot%link), :)
      p(0) = p(0) + spot%at
      z = point_rate(state, spot%link, order, p)
   end function motion_of

   !> Put a force and a couple on a link at a spot; what is on a rod pushes at the drive too.
   pure subroutine put(closure, state, spot, force, couple, at)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(chain_spot_t), intent(in) :: spot
      complex(wp), intent(in) :: force
      real(wp), intent(in) :: couple               !! N times user's length
      type(place_of_forces_t), intent(inout) :: at

      call act(at, spot%link, motion_of(closure, state, spot, 0), force, couple)
      if (abs(spot%rod) <= 0.0_wp) return
      associate (push => at%push(closure%cylinder(spot%link)))
         push = push + dot(force, turned(pose(state, spot%link, 0))*spot%rod)
      end associate
   end subroutine put

   !> Turn of a link, or a derivative of it.
   pure real(wp) function pose(state, link, order)
      type(state_t), intent(in) :: state
      integer, intent(in) :: link, order

      pose = state%phi(link, order)
   end function pose

   !> Put a force at a place and a couple on a link.
   pure subroutine act(at, link, z, force, couple)
      type(place_of_forces_t), intent(inout) :: at
      integer, intent(in) :: link
      complex(wp), intent(in) :: z, force
      real(wp), intent(in) :: couple

      at%force(link) = at%force(link) + force
      at%moment(link) = at%moment(link) + (cross(z, force) + couple)
   end subroutine act

   ! ---- sources -----------------------------------------------------------------------------------------------------

   subroutine add_source(closure, model, state, source, input, at)
      type(closure_t), intent(in) :: closure
      type(chain_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      integer, intent(in) :: source
      real(wp), intent(in) :: input
      type(place_of_forces_t), intent(inout) :: at
      integer :: k

      if (source <= source_weight) then
         do k = 1, size(model%mass)
            if (model%centres(k)%link == frame_link) cycle
            if (source == source_weight) then
               call put(closure, state, model%centres(k), model%mass(k)*model%gravity, 0.0_wp, at)
            else
               call put(closure, state, model%centres(k), -model%mass(k)*model%metre* &
                        motion_of(closure, state, model%centres(k), 2), &
                        -model%inertia(k)*pose(state, model%centres(k)%link, 2)/model%metre, at)
            end if
         end do
      else if (source <= source_weight + size(model%loads)) then
         call add_load(closure, model, state, source - source_weight, input, at)
      else
         call add_spring(closure, model, state, source - source_weight - size(model%loads), at)
      end if
   end subroutine add_source

   subroutine add_load(closure, model, state, which, input, at)
      type(closure_t), intent(in) :: closure
      type(chain_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      integer, intent(in) :: which
      real(wp), intent(in) :: input
      type(place_of_forces_t), intent(inout) :: at
      real(wp) :: factor(1)
      complex(wp) :: force

      associate (load => model%loads(which))
         factor = 1.0_wp
         if (load%table > 0) factor = interpolated(model%table_input, model%table_factor(:, load%table), [input], &
                                                   closure%sketch%drives(1)%kind == drive_turns)
         force = load%force
         if (load%turns) force = force*load%spot%along*turned(pose(state, load%spot%link, 0))
         call put(closure, state, load%spot, factor(1)*force, factor(1)*load%moment/model%metre, at)
      end associate
   end subroutine add_load

   subroutine add_spring(closure, model, state, which, at)
      type(closure_t), intent(in) :: closure
      type(chain_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      integer, intent(in) :: which
      type(place_of_forces_t), intent(inout) :: at
      complex(wp) :: gap, speed
      real(wp) :: length, pull

      associate (spring => model%springs(which), a => model%springs(which)%ends(1), b => model%springs(which)%ends(2))
         if (spring%torsional) then
            gap = b%along*turned(pose(state, b%link, 0))*conjg(a%along*turned(pose(state, a%link, 0)))
            pull = (spring%preload + spring%stiffness*radians_per_degree* &
                    nearest_difference(degrees_of(gap%re, gap%im), spring%free) + &
                    spring%damping*(pose(state, b%link, 1) - pose(state, a%link, 1)))/model%metre
            call put(closure, state, a, (0.0_wp, 0.0_wp), pull, at)
            call put(closure, state, b, (0.0_wp, 0.0_wp), -pull, at)
            return
         end if
         gap = motion_of(closure, state, b, 0) - motion_of(closure, state, a, 0)
         speed = motion_of(closure, state, b, 1) - motion_of(closure, state, a, 1)
         length = abs(gap)
         ! a spring of no length has no direction; one of no free length has no force there
         gap = gap/max(length, tiny(1.0_wp))
         pull = spring%preload + spring%stiffness*model%metre*(length - spring%free) + spring%damping*model%metre*dot(gap, speed)
         call put(closure, state, a, pull*gap, 0.0_wp, at)
         call put(closure, state, b, -pull*gap, 0.0_wp, at)
      end associate
   end subroutine add_spring

   !> Power of what is on the links now, watts.
   pure real(wp) function power_of(state, model, at) result(power)
      type(state_t), intent(in) :: state
      type(chain_model_t), intent(in) :: model
      type(place_of_forces_t), intent(in) :: at
      complex(wp) :: z, v
      integer :: k

      power = dot_product(at%push, state%input(:, 1))
      do k = frame_link + 1, size(at%force)
         z = state%t(k, 0)
         v = state%t(k, 1)
         power = power + dot(at%force(k), v) + (at%moment(k) - cross(z, at%force(k)))*pose(state, k, 1)
      end do
      power = power*model%metre
   end function power_of

   !> Kinetic energy, joules, and its growth, watts.
   subroutine find_energy(closure, model, state, kinetic, growth)
      type(closure_t), intent(in) :: closure
      type(chain_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      real(wp), intent(out) :: kinetic, growth
      complex(wp) :: v, a
      integer :: k

      kinetic = 0.0_wp
      growth = 0.0_wp
      do k = 1, size(model%mass)
         v = motion_of(closure, state, model%centres(k), 1)*model%metre
         a = motion_of(closure, state, model%centres(k), 2)*model%metre
         associate (link => model%centres(k)%link)
            kinetic = kinetic + 0.5_wp*(model%mass(k)*dot(v, v) + model%inertia(k)*pose(state, link, 1)**2)
            growth = growth + model%mass(k)*dot(a, v) + model%inertia(k)*pose(state, link, 1)*pose(state, link, 2)
         end associate
      end do
   end subroutine find_energy

   ! ---- solution ----------------------------------------------------------------------------------------------------

   !> Forces of all pairs and drives from those on the links, which are used up: what is left on the frame is what the mechanism
   !> does to it, the drives' reactions included.
   subroutine sweep(closure, model, state, at)
      type(closure_t), intent(in) :: closure
      type(chain_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(place_of_forces_t), intent(inout) :: at
      real(wp), allocatable :: right(:), multiplier(:)
      complex(wp) :: z, on_frame
      real(wp) :: moment_on_frame
      integer :: g, k, m, d

      at%pair = (0.0_wp, 0.0_wp)
      at%couple = 0.0_wp
      at%drive = -at%push
      ! what acts on all links together: forces between them cancel, however large they are beside a dead point
      on_frame = sum(at%force)
      moment_on_frame = sum(at%moment)
      do g = size(closure%groups), 1, -1
         associate (links => closure%groups(g)%links, rows => closure%groups(g)%rows, scale => closure%size)
            if (size(links) == 0) cycle
            allocate (right(3*size(links)))
            do k = 1, size(links)
               z = state%t(links(k), 0)
               right(3*k - 2:3*k) = -[at%force(links(k))%re, at%force(links(k))%im, &
                                      (at%moment(links(k)) - cross(z, at%force(links(k))))/scale]
            end do
            multiplier = solve_transposed(at%factors(g), right)
            deallocate (right)
            m = 1
            do k = 1, size(rows)
               associate (a => rows(k)%links(1), b => rows(k)%links(2), n => rows(k)%which)
                  select case (rows(k)%kind)
                  case (row_pin)
                     call pass_pin(n, a, b, cmplx(multiplier(m), multiplier(m + 1), wp))
                     m = m + 1
                  case (row_angle)
                     call pass_couple(a, b, scale*multiplier(m))
                     at%couple(pair_called(pair_slide, n, b)) = scale*multiplier(m)
                  case (row_line)
                     call pass_along(n, i*multiplier(m))
                     at%pair(pair_called(pair_slide, n, b)) = cmplx(multiplier(m), 0.0_wp, wp)
                  case (row_gear)
                     associate (gear => closure%sketch%gears(n))
                        call act(at, b, (0.0_wp, 0.0_wp), (0.0_wp, 0.0_wp), scale*multiplier(m))
                        call act(at, a, (0.0_wp, 0.0_wp), (0.0_wp, 0.0_wp), -gear%ratio*scale*multiplier(m))
                        call act(at, gear%carrier, (0.0_wp, 0.0_wp), (0.0_wp, 0.0_wp), (gear%ratio - 1.0_wp)*scale*multiplier(m))
                        call mesh(n, scale*multiplier(m))
                     end associate
                  case (row_turn)
                     call pass_couple(a, b, scale*multiplier(m))
                     at%drive(n) = scale*multiplier(m)
                  case default
                     d = closure%sketch%drives(n)%slide
                     if (closure%sketch%slides(d)%links(1) == a) then
                        call pass_along(d, cmplx(multiplier(m), 0.0_wp, wp))
                     else
                        call pass_along(d, cmplx(-multiplier(m), 0.0_wp, wp))
                     end if
                     at%drive(n) = multiplier(m)
                  end select
               end associate
               m = m + 1
            end do
         end associate
      end do
      at%force(frame_link) = on_frame
      at%moment(frame_link) = moment_on_frame

   contains

      !> A force of link a on link b at their joint; the far end of a cylinder pushes at its drive.
      subroutine pass_pin(joint, a, b, force)
         integer, intent(in) :: joint, a, b
         complex(wp), intent(in) :: force

         z = state%joint(joint, 0)
         call act(at, b, z, force, 0.0_wp)
         call act(at, a, z, -force, 0.0_wp)
         call push_rod(b, joint, force)
         call push_rod(a, joint, -force)
         associate (pair => at%pair(pair_called(pair_pin, joint, b)))
            pair = pair + force
         end associate
      end subroutine pass_pin

      !> A force on a cylinder at a joint.
      subroutine push_rod(link, joint, force)
         integer, intent(in) :: link, joint
         complex(wp), intent(in) :: force

         if (closure%cylinder(link) == 0) return
         associate (p => closure%point(joint, link), drive => at%drive(closure%cylinder(link)))
            if (abs(p) > 0.0_wp) drive = drive - dot(force, turned(pose(state, link, 0))*p/abs(p))
         end associate
      end subroutine push_rod

      subroutine pass_couple(a, b, couple)
         integer, intent(in) :: a, b
         real(wp), intent(in) :: couple

         call act(at, b, (0.0_wp, 0.0_wp), (0.0_wp, 0.0_wp), couple)
         call act(at, a, (0.0_wp, 0.0_wp), (0.0_wp, 0.0_wp), -couple)
      end subroutine pass_couple

      !> A force along (real) and across (imaginary part) the line of a slide, at the point of its second link.
      subroutine pass_along(slide, force)
         integer, intent(in) :: slide
         complex(wp), intent(in) :: force

         call pass_at_slide(closure, state, slide, force, at)
      end subroutine pass_along

      pure integer function pair_called(kind, which, link)
         integer, intent(in) :: kind, which, link

         do pair_called = 1, size(model%pairs)
            associate (pair => model%pairs(pair_called))
               if (pair%kind == kind .and. pair%which == which .and. pair%links(2) == link) return
            end associate
         end do
      end function pair_called

      !> The couples of a gear pair are those of a force at the pitch point, square to the line of centres: each bearing of a wheel
      !> takes that force beside what keeps the wheel's centre in its place.
      subroutine mesh(gear, couple)
         integer, intent(in) :: gear
         real(wp), intent(in) :: couple          !! on the second wheel
         complex(wp) :: arm, force, centre(2)
         integer :: w, j(2), p

         associate (of => closure%sketch%gears(gear))
            do w = 1, 2
               j(w) = 0
               do p = 1, size(closure%sketch%joint_name)
                  if (closure%sketch%has_joint(of%wheels(w), p) .and. closure%sketch%has_joint(of%carrier, p)) j(w) = p
               end do
               if (j(w) == 0) return
               centre(w) = state%joint(j(w), 0)
            end do
            if (abs(1.0_wp - of%ratio) <= still) return
            arm = -(centre(2) - centre(1))/(1.0_wp - of%ratio)   ! from the second centre to the pitch point
            if (abs(arm) <= still*closure%size) return           ! wheels on one centre: a couple passes, no force
            force = couple*i*arm/abs(arm)**2
            do p = 1, size(model%pairs)
               associate (pair => model%pairs(p))
                  if (pair%kind == pair_pin .and. pair%which == j(2)) then
                     if (pair%links(2) == of%wheels(2)) at%pair(p) = at%pair(p) - force
                     if (pair%links(2) == of%carrier) at%pair(p) = at%pair(p) + force
                  end if
                  if (pair%kind == pair_pin .and. pair%which == j(1)) then
                     if (pair%links(2) == of%wheels(1)) at%pair(p) = at%pair(p) + force
                     if (pair%links(2) == of%carrier) at%pair(p) = at%pair(p) - force
                  end if
                  if (pair%kind == pair_gears .and. pair%which == gear) at%pair(p) = force
               end associate
            end do
         end associate
      end subroutine mesh
   end subroutine sweep

   !> A force along (real) and across (imaginary part) the line of a slide on its second link, and its opposite on the first.
   pure subroutine pass_at_slide(closure, state, slide, force, at)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      integer, intent(in) :: slide
      complex(wp), intent(in) :: force
      type(place_of_forces_t), intent(inout) :: at
      complex(wp) :: p(0:most_orders), z, f

      associate (a => closure%sketch%slides(slide)%links(1), b => closure%sketch%slides(slide)%links(2))
         p = (0.0_wp, 0.0_wp)
         p(0) = closure%slide_point(2, slide)
         z = point_rate(state, b, 0, p)
         f = force*turned(pose(state, a, 0))*closure%line(slide)
         call act(at, b, z, f, 0.0_wp)
         call act(at, a, z, -f, 0.0_wp)
      end associate
   end subroutine pass_at_slide

   !> Sweep with friction: forces of the pairs make friction, which is a load in the next sweep.
   !>
   !> `sweeps` is 0 where friction does not settle: the mechanism locks itself.
   subroutine rub(closure, model, state, at, sweeps, at_rest, loss)
      type(closure_t), intent(in) :: closure
      type(chain_model_t), intent(in) :: model
      type(state_t), intent(in) :: state
      type(place_of_forces_t), intent(inout) :: at
      integer, intent(out) :: sweeps
      logical, intent(out) :: at_rest
      real(wp), intent(out) :: loss                !! power, W
      real(wp), dimension(size(model%friction)) :: grip, fresh, slip
      complex(wp) :: force(size(at%force)), z
      real(wp) :: moment(size(at%moment)), push(size(at%push)), fastest, load, couple
      integer :: round, k

      fastest = maxval(abs(state%phi(:, 1)))
      fastest = max(fastest, maxval(abs(state%t(:, 1)))/closure%size)
      do k = 1, size(slip)
         associate (pair => model%pairs(model%friction(k)%pair))
            if (pair%kind == pair_slide) then
               z = travel(closure, state, pair%which, 1)
               slip(k) = z%re
               if (abs(slip(k)) <= still*fastest*closure%size) slip(k) = 0.0_wp
            else
               slip(k) = pose(state, pair%links(2), 1) - pose(state, pair%links(1), 1)
               if (abs(slip(k)) <= still*fastest) slip(k) = 0.0_wp
            end if
         end associate
      end do
      at_rest = any(abs(slip) <= 0.0_wp)
      force = at%force
      moment = at%moment
      push = at%push
      grip = 0.0_wp
      sweeps = 0
      do round = 1, most_sweeps
         at%force = force
         at%moment = moment
         at%push = push
         do k = 1, size(grip)
            associate (pair => model%pairs(model%friction(k)%pair))
               if (pair%kind == pair_slide) then
                  call pass_at_slide(closure, state, pair%which, cmplx(grip(k), 0.0_wp, wp), at)
               else
                  at%moment(pair%links(2)) = at%moment(pair%links(2)) + grip(k)
                  at%moment(pair%links(1)) = at%moment(pair%links(1)) - grip(k)
               end if
            end associate
         end do
         call sweep(closure, model, state, at)
         do k = 1, size(grip)
            associate (of => model%friction(k))
               if (model%pairs(of%pair)%kind == pair_slide) then
                  load = abs(at%pair(of%pair)%re)
                  if (of%radius > 0.0_wp) then
                     couple = at%couple(of%pair)/(2.0_wp*of%radius)
                     load = abs(0.5_wp*at%pair(of%pair)%re + couple) + abs(0.5_wp*at%pair(of%pair)%re - couple)
                  end if
               else
                  load = of%radius*abs(at%pair(of%pair))
               end if
               fresh(k) = 0.0_wp
               if (abs(slip(k)) > 0.0_wp) fresh(k) = -sign(of%coefficient*load, slip(k))
            end associate
         end do
         if (maxval(abs(fresh - grip)) <= settled*maxval(abs(fresh))) then
            sweeps = round
            exit
         end if
         grip = fresh
      end do
      loss = sum(abs(grip*slip))*model%metre
   end subroutine rub

   !> The columns: N, N m; moments about the machine origin.
   pure subroutine take_columns(closure, model, at, value)
      type(closure_t), intent(in) :: closure
      type(chain_model_t), intent(in) :: model
      type(place_of_forces_t), intent(in) :: at
      real(wp), intent(out) :: value(:)
      integer :: k, c

      value(column_fx) = at%force(frame_link)%re
      value(column_fy) = at%force(frame_link)%im
      value(column_moment) = at%moment(frame_link)*model%metre
      do k = 1, size(model%pairs)
         c = column_of_joint(k)
         value(c) = at%pair(k)%re
         value(c + 1) = at%pair(k)%im
         if (model%pairs(k)%kind == pair_slide) value(c + 1) = at%couple(k)*model%metre
      end do
      do k = 1, size(at%drive)
         c = column_of_drive(model, k)
         value(c) = at%drive(k)
         if (closure%sketch%drives(k)%kind == drive_turns) value(c) = value(c)*model%metre
      end do
   end subroutine take_columns
end module psalm_chain_forces
