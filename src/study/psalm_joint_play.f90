!> What clearances of joints do to the outputs: by virtual work.
!>
!> A gap g is how far the second link of a joint is from where the joint without clearance has it on the first. With the inputs
!> held, a unit force on an output and the joint forces that balance it do no work: if r is the force of the first link on the
!> second, the output changes by -r.g. A pin lies anywhere in the disc of its radial clearance; a slider goes to either side of its
!> line. Under a load f, that of the first link on the second, the second link is pressed against it: g = -c f/|f|, at every
!> position by the load there, and the output changes by c r.f/|f|. Source: Haines (about 1982), chapter 3, for the pin that lies
!> against its hole.
module psalm_joint_play
   use psalm_allocation_group, only: allocation_group_t
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_elementary, only: hypotenuse
   use psalm_error, only: motion_t, problem_t, follows_drawing, new_problem, own_inputs_at
   use psalm_force_analysis, only: analyse_forces, column_of_joint, force_table_t, loads_of_unit_wrenches
   use psalm_force_model, only: body_of_link, force_model_t, forces_wanted, joint_at, make_force_model, vertices_of
   use psalm_joint_location, only: locate_sketch
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_mechanism, only: mechanism_t, at_finish, at_start, body_frame, joint_gear, joint_prismatic
   use psalm_moving_joints, only: sketch_motion_t
   use psalm_output_kind, only: motion_distance, motion_slide
   use psalm_parameters, only: no_parameters
   use psalm_sketch, only: output_angle, output_between, output_distance, output_point, output_pose, output_ratio, output_slide, &
                           output_x, output_y, columns_of
   use psalm_sketch_motion, only: find_places
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: play_t, find_plays, check_plays, names_of_plays
   public :: play_anywhere, play_across, play_loaded, play_name_length

   integer, parameter :: play_anywhere = 1            !! a pin anywhere in its disc
   integer, parameter :: play_across = 2              !! a slider, to either side of its line
   integer, parameter :: play_loaded = 3              !! on the side of the load
   integer, parameter :: play_name_length = 120
   integer, parameter :: components_of_wrench = 3
   real(wp), parameter :: no_load = 1.0e-9_wp         !! part of the largest load of the joint: a smaller one has no direction

   !> A joint with clearance.
   type :: play_t
      character(play_name_length) :: name = ''        !! of the listing
      integer :: kind = play_anywhere                 !! one of `play_...`
      real(wp) :: given = 0.0_wp                      !! clearance of today, user's length; 0: none
      logical :: slides = .false.
      real(wp), allocatable :: by_gap(:, :, :)        !! shape (2, positions, numbers): change of the outputs by the gap's x and y;
                                                      !! of a slide by the gap across in place of x
      real(wp), allocatable :: change(:, :)           !! shape (positions, numbers): by a clearance of 1: under a load with its
                                                      !! sign, else the largest amount
      logical :: asked = .false.                      !! it is to lie on the side of the load
      real(wp) :: least = 0.0_wp, most = 0.0_wp       !! load then, N
      integer :: turns(2) = 0                         !! positions between which the load turns over, or twice that where there is
                                                      !! none; 0: nowhere
   end type play_t

   !> Forces and couples on bodies that are a unit of a number of the outputs, at every position.
   type :: unit_load_t
      integer :: body = body_frame
      real(wp), allocatable :: wrench(:, :)           !! shape (3, positions): N and N m about the input pivot
   end type unit_load_t

   !> Those of one number.
   type :: output_load_t
      logical :: known = .true.
      real(wp) :: unit = 1.0_wp                       !! change of the number by that of which the loads are a unit
      type(unit_load_t), allocatable :: loads(:)
   end type output_load_t

contains

   !> Names of the joints with clearance, as listings have them: `PLAY B`, of &LINKS `PLAY M2`.
   function names_of_plays(asked, mechanism) result(names)
      type(allocation_group_t), intent(in) :: asked
      type(mechanism_t), intent(in) :: mechanism
      character(play_name_length), allocatable :: names(:)
      integer :: k, joint

      allocate (names(size(asked%plays)))
      do k = 1, size(names)
         if (size(asked%play_names) >= k) then
            names(k) = 'PLAY '//trim(asked%play_names(k))
         else
            joint = joint_at(mechanism, asked%plays(k))
            names(k) = 'PLAY'
            if (joint > 0) names(k) = 'PLAY '//mechanism%joints(joint)%name
         end if
      end do
   end function names_of_plays

   !> Errors: no joint there, wheels in mesh, the link that holds a pin, a joint twice; a load where the case has no forces; what
   !> `make_force_model` finds.
   subroutine check_plays(set, asked, mechanism, dimensions, findings)
      type(data_set_t), intent(in) :: set
      type(allocation_group_t), intent(in) :: asked
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(diagnostics_t), intent(inout) :: findings
      type(force_model_t) :: model
      integer, allocatable :: joints(:)
      integer :: k

      if (size(asked%plays) == 0) return
      ! a case with forces is checked by the preparation
      if (.not. forces_wanted(set)) call make_force_model(set, mechanism, dimensions, model, findings)
      joints = [(joint_at(mechanism, asked%plays(k)), k=1, size(asked%plays))]
      do k = 1, size(joints)
         if (joints(k) == 0) then
            call refuse('there is no joint at this end of the arc')
            cycle
         end if
         if (mechanism%joints(joints(k))%kind == joint_gear) call refuse('wheels in mesh have no clearance here')
         if (any(joints(:k - 1) == joints(k))) &
            call refuse('is the joint of entry '//to_text(findloc(joints(:k - 1), joints(k), dim=1))//', too')
         if (asked%loaded(k) == 1 .and. .not. forces_wanted(set)) call set%origins%error(findings, 'ALLOC', 'PLOAD', 'entry '// &
            to_text(k)//' lies on the side of its load, but the case has no forces: give &MASSES, &LOADS or &SPRING', k)
         if (asked%plays(k)%joint == 0 .or. asked%plays(k)%slide > 0) cycle
         if (size(set%sketch%links_of(asked%plays(k)%joint)) <= 2) cycle
         associate (holder => set%traced%pin_holders(asked%plays(k)%joint))
            if (asked%plays(k)%link == holder) call refuse('the pin is held by link '//trim(set%sketch%links(holder)%name)// &
                                                           '; name another that turns on it')
         end associate
      end do

   contains

      subroutine refuse(text)
         character(*), intent(in) :: text

         call set%origins%error(findings, 'ALLOC', set%link_item('P'), 'entry '//to_text(k)//': '//text, k)
      end subroutine refuse
   end subroutine check_plays

   !> The changes of all numbers of the outputs with every joint that has clearance; of a linkage that closes everywhere.
   subroutine find_plays(set, asked, mechanism, dimensions, inputs, plays)
      type(data_set_t), intent(in) :: set
      type(allocation_group_t), intent(in) :: asked
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: inputs(:)               !! increments of the input
      type(play_t), allocatable, intent(out) :: plays(:)
      class(problem_t), allocatable :: problem        ! large: it would fill a small stack
      type(force_model_t) :: model
      type(force_table_t) :: table
      type(motion_t) :: motion
      type(diagnostics_t) :: unused
      type(output_load_t), allocatable :: loadings(:)
      real(wp), allocatable :: columns(:, :, :, :)
      integer, allocatable :: bodies(:)
      character(play_name_length), allocatable :: names(:)
      integer :: k, j, n, number

      allocate (plays(size(asked%plays)))
      if (size(plays) == 0) return
      allocate (problem)
      call new_problem(mechanism, dimensions, no_parameters(mechanism), inputs, .true., problem, own_inputs_at(set, inputs))
      problem%followed = follows_drawing(set, mechanism)
      call make_force_model(set, mechanism, dimensions, model, unused)
      if (size(set%sketch%outputs) > 0) then
         call load_sketch(set, dimensions, model%metre, problem, loadings)
      else
         call load_loops(dimensions, model%metre, problem, loadings)
      end if
      call problem%want_derivatives(.true., vertices_of(mechanism))
      call problem%analyse(dimensions, motion)
      bodies = bodies_of(loadings, size(mechanism%bodies))
      call loads_of_unit_wrenches(problem, model, bodies, columns)
      if (any(asked%loaded == 1)) &
         call analyse_forces(problem, model, set%pace(), set%change_of_pace(), motion%closed, motion%input, table)
      names = names_of_plays(asked, mechanism)
      n = size(inputs)
      do k = 1, size(plays)
         associate (play => plays(k))
            play%name = names(k)
            play%given = asked%play_given(k)
            play%asked = asked%loaded(k) == 1
            j = joint_at(mechanism, asked%plays(k))
            play%slides = mechanism%joints(j)%kind == joint_prismatic
            if (play%slides) play%kind = play_across
            allocate (play%by_gap(2, n, size(loadings)), source=0.0_wp)
            do number = 1, size(loadings)
               call add_forces(loadings(number), column_of_joint(j), merge(1, 2, play%slides), play%by_gap(:, :, number))
            end do
            if (play%asked) call put_on_side(table%value(:, column_of_joint(j):column_of_joint(j) + 1), &
                                             [(table%known(number), number=1, n)], play)
            if (play%kind /= play_loaded) play%change = hypotenuse(play%by_gap(1, :, :), play%by_gap(2, :, :))
         end associate
      end do

   contains

      !> The force of a joint under the loads of a number, turned round: the change by the gap, in the units that are listed.
      subroutine add_forces(loading, column, count, by_gap)
         type(output_load_t), intent(in) :: loading
         integer, intent(in) :: column, count
         real(wp), intent(inout) :: by_gap(:, :)      !! shape (2, positions)
         integer :: l, b, c, m

         do l = 1, size(loading%loads)
            if (loading%loads(l)%body == body_frame) cycle
            b = findloc(bodies, loading%loads(l)%body, dim=1)
            do m = 1, components_of_wrench
               do c = 1, count
                  by_gap(c, :) = by_gap(c, :) - loading%unit*loading%loads(l)%wrench(m, :)*columns(:, column + c - 1, m, b)
               end do
            end do
         end do
      end subroutine add_forces
   end subroutine find_plays

   !> Put the gap on the side of the load, if that has a direction everywhere and turns over nowhere.
   pure subroutine put_on_side(force, known, play)
      real(wp), intent(in) :: force(:, :)             !! shape (positions, 2): N; of a slide across in the first column
      logical, intent(in) :: known(:)                 !! shape (positions)
      type(play_t), intent(inout) :: play
      real(wp), allocatable :: x(:), y(:), amount(:)
      integer :: i, number

      x = force(:, 1)
      y = force(:, 2)
      if (play%slides) y = 0.0_wp
      amount = hypotenuse(x, y)
      play%most = maxval(amount)
      play%least = minval(amount)
      i = findloc(known .and. amount > no_load*play%most, .false., dim=1)
      if (i > 0) then
         play%turns = i
         return
      end if
      do i = 2, size(x)
         if (x(i)*x(i - 1) + y(i)*y(i - 1) > 0.0_wp) cycle
         play%turns = [i - 1, i]
         return
      end do
      play%kind = play_loaded
      allocate (play%change(size(x), size(play%by_gap, 3)))
      do number = 1, size(play%change, 2)
         play%change(:, number) = -(x*play%by_gap(1, :, number) + y*play%by_gap(2, :, number))/amount
      end do
   end subroutine put_on_side

   !> The bodies that are loaded.
   pure function bodies_of(loadings, most) result(bodies)
      type(output_load_t), intent(in) :: loadings(:)
      integer, intent(in) :: most
      integer, allocatable :: bodies(:)
      logical :: taken(most)
      integer :: k, l, b

      taken = .false.
      do k = 1, size(loadings)
         do l = 1, size(loadings(k)%loads)
            taken(loadings(k)%loads(l)%body) = .true.
         end do
      end do
      taken(body_frame) = .false.
      bodies = pack([(b, b=1, most)], taken)
   end function bodies_of

   ! ---- loads that are a unit of an output ----------------------------------------------------------------------------

   !> Of the numbers of the output of loops.
   subroutine load_loops(dimensions, metre, problem, loadings)
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: metre                   !! metres in the user's unit of length
      class(problem_t), intent(inout) :: problem
      type(output_load_t), allocatable, intent(out) :: loadings(:)
      type(motion_t) :: motion
      complex(wp), allocatable :: at(:), along(:)
      integer :: body, c, i, block, offset, n

      call problem%want_derivatives(.true., with_point=.true.)
      call problem%analyse(dimensions, motion)
      allocate (loadings(problem%output%kind%components))
      do c = 1, size(loadings)
         allocate (loadings(c)%loads(0))
      end do
      n = problem%positions
      associate (output => problem%mechanism%outputs(1), mechanism => problem%mechanism)
         if (output%motion == motion_slide) then
            call load_slide(problem, output%arc, 1.0_wp, metre, loadings(1))
            return
         end if
         body = mechanism%arcs(output%arc)%body
         if (.not. dimensions%outlk > 0.0_wp) body = mechanism%body_at(output%arc, merge(at_start, at_finish, output%from_start))
         if (problem%output%kind%angle > 0) then
            call add_couple(mechanism%arcs(output%arc)%body, n, 1.0_wp, loadings(problem%output%kind%angle))
            loadings(problem%output%kind%angle)%unit = degrees_per_radian*metre
         end if
         if (.not. problem%output%kind%has_point) return
         at = [((0.0_wp, 0.0_wp), i=1, n)]
         do block = 1, problem%blocks()
            call problem%solve_block(block, offset, n)
            call problem%output_of(n)
            call take_point()
         end do
         n = problem%positions
         if (output%motion == motion_distance) then
            along = (at + cmplx(problem%output%origin_x, problem%output%origin_y, wp))
            along = along/hypotenuse(along%re, along%im)
            call add_force(body, at*metre, along, loadings(1))
         else
            call add_force(body, at*metre, [((1.0_wp, 0.0_wp), i=1, n)], loadings(1))
            call add_force(body, at*metre, [((0.0_wp, 1.0_wp), i=1, n)], loadings(2))
         end if
      end associate

   contains

      !> The output point from the input pivot.
      subroutine take_point()
         integer :: m

         associate (o => problem%output, v => problem%linkage%store%v, scale => problem%linkage%scale)
            do m = 1, n
               at(offset + m) = cmplx(v(m, o%base_x), v(m, o%base_y), wp)/scale + &
                                o%length*cmplx(o%c, o%s, wp)*cmplx(v(m, o%root_x), v(m, o%root_y), wp)
            end do
         end associate
      end subroutine take_point
   end subroutine load_loops

   !> Of the numbers of the outputs of a sketch.
   subroutine load_sketch(set, dimensions, metre, problem, loadings)
      type(data_set_t), intent(in) :: set
      type(dimensions_t), intent(in) :: dimensions
      real(wp), intent(in) :: metre
      class(problem_t), intent(inout) :: problem
      type(output_load_t), allocatable, intent(out) :: loadings(:)
      type(sketch_motion_t) :: sketch
      type(motion_t) :: motion
      complex(wp), allocatable :: joint(:, :), place(:, :), origin, along(:)
      real(wp), allocatable :: moved(:, :)
      integer :: k, c, n, i, block, offset

      call locate_sketch(set, sketch, dimensions)
      call problem%want_derivatives(.true., sketch%points)
      call problem%analyse(dimensions, motion)
      n = problem%positions
      allocate (joint(size(sketch%drawn), n), place(size(sketch%drawn), problem%linkage%capacity))
      allocate (moved(size(sketch%arcs), problem%linkage%capacity))
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, n)
         call find_places(sketch, problem, n, place(:, :n), moved(:, :n))
         joint(:, offset + 1:offset + n) = place(:, :n)
      end do
      n = problem%positions
      ! from the input pivot, metres
      origin = cmplx(problem%output%origin_x, problem%output%origin_y, wp)
      allocate (loadings(sum([(columns_of(set%sketch%outputs(k)), k=1, size(set%sketch%outputs))])))
      do c = 1, size(loadings)
         allocate (loadings(c)%loads(0))
      end do
      c = 1
      do k = 1, size(set%sketch%outputs)
         associate (output => set%sketch%outputs(k))
            select case (output%kind)
            case (output_point, output_pose)
               call add_of_joint(output%joints(1), [((1.0_wp, 0.0_wp), i=1, n)], loadings(c))
               call add_of_joint(output%joints(1), [((0.0_wp, 1.0_wp), i=1, n)], loadings(c + 1))
               if (output%kind == output_pose) call add_line(output%joints(2:3), output%link, 1.0_wp, loadings(c + 2))
            case (output_x)
               call add_of_joint(output%joints(1), [((1.0_wp, 0.0_wp), i=1, n)], loadings(c))
            case (output_y)
               call add_of_joint(output%joints(1), [((0.0_wp, 1.0_wp), i=1, n)], loadings(c))
            case (output_angle)
               call add_line(output%joints(1:2), output%link, 1.0_wp, loadings(c))
            case (output_between)
               call add_line(output%joints(1:2), 0, -1.0_wp, loadings(c))
               call add_line(output%joints(3:4), 0, 1.0_wp, loadings(c))
            case (output_distance)
               along = joint(output%joints(1), :)
               if (output%joints(2) > 0) along = along - joint(output%joints(2), :)
               along = along/hypotenuse(along%re, along%im)
               call add_of_joint(output%joints(1), along, loadings(c))
               if (output%joints(2) > 0) call add_of_joint(output%joints(2), -along, loadings(c))
            case (output_slide)
               associate (travel => set%traced%travels(output%slide))
                  call load_slide(problem, problem%mechanism%seq(travel%loop, travel%arc), travel%sense, metre, loadings(c))
               end associate
            case (output_ratio)
               loadings(c)%known = .false.
            end select
            c = c + columns_of(output)
         end associate
      end do

   contains

      !> A force on a joint: on the first of its links.
      subroutine add_of_joint(number, force, loading)
         integer, intent(in) :: number
         complex(wp), intent(in) :: force(:)
         type(output_load_t), intent(inout) :: loading
         integer, allocatable :: links(:)

         links = set%sketch%links_of(number)
         call add_force(body_of_link(problem%mechanism, links(1)), (joint(number, :) - origin)*metre, force, loading)
      end subroutine add_of_joint

      !> A couple on the link of a line, or forces on the joints of one that no link has.
      subroutine add_line(ends, named, sense, loading)
         integer, intent(in) :: ends(2), named        !! joints; the link, if it was named
         real(wp), intent(in) :: sense
         type(output_load_t), intent(inout) :: loading
         complex(wp), allocatable :: across(:)
         real(wp), allocatable :: length(:)
         integer :: link

         loading%unit = degrees_per_radian*metre
         link = named
         if (link == 0) link = findloc([(set%sketch%has_joint(i, ends(1)) .and. set%sketch%has_joint(i, ends(2)), &
                                         i=1, size(set%sketch%links))], .true., dim=1)
         if (link > 0) then
            call add_couple(body_of_link(problem%mechanism, link), n, sense, loading)
            return
         end if
         across = joint(ends(2), :) - joint(ends(1), :)
         length = hypotenuse(across%re, across%im)
         across = sense*across*(0.0_wp, 1.0_wp)/(metre*length**2)
         call add_of_joint(ends(2), across, loading)
         call add_of_joint(ends(1), -across, loading)
      end subroutine add_line
   end subroutine load_sketch

   !> Two forces along a slide that make its arc longer.
   subroutine load_slide(problem, n, sense, metre, loading)
      class(problem_t), intent(inout) :: problem      !! analysed
      integer, intent(in) :: n                        !! arc whose length counts
      real(wp), intent(in) :: sense
      real(wp), intent(in) :: metre
      type(output_load_t), intent(inout) :: loading
      complex(wp) :: along(problem%positions), at(problem%positions)
      real(wp) :: x(problem%positions), y(problem%positions)
      integer :: block, offset, m, i, finish, j, guide

      associate (mechanism => problem%mechanism, arc => problem%mechanism%arcs(n), link => problem%linkage)
         guide = body_frame
         do j = 1, size(mechanism%joints)
            if (mechanism%joints(j)%slide /= n) cycle
            guide = mechanism%joints(j)%bodies(1)
            if (guide == arc%body) guide = mechanism%joints(j)%bodies(2)
         end do
         if (arc%rod > 0) guide = arc%rod
         do block = 1, problem%blocks()
            call problem%solve_block(block, offset, m)
            associate (root => problem%plan%root(n), v => link%store%v)
               do i = 1, m
                  along(offset + i) = cmplx(link%x(n), link%y(n), wp)*cmplx(v(i, link%root_x(root)), v(i, link%root_y(root)), wp)
               end do
            end associate
         end do
         call find_point(problem, arc%ends(arc%foot), x, y)
         at = cmplx(x, y, wp)*metre
         ! the finish moves along the arc, unless that is the foot
         finish = merge(-1, 1, arc%foot == at_finish)
         call add_force(arc%body, at, sense*real(finish, wp)*along, loading)
         call add_force(guide, at, -sense*real(finish, wp)*along, loading)
      end associate
   end subroutine load_slide

   !> A point of the mechanism at every position, from the input pivot, user's length.
   subroutine find_point(given, point, x, y)
      class(problem_t), intent(in) :: given
      integer, intent(in) :: point
      real(wp), intent(out) :: x(:), y(:)             !! shape (positions)
      class(problem_t), allocatable :: problem
      type(motion_t) :: motion
      integer :: block, offset, m

      allocate (problem, source=given)
      call problem%want_derivatives(.true., vertices_of(problem%mechanism))
      call problem%analyse(given%given, motion)
      do block = 1, problem%blocks()
         call problem%solve_block(block, offset, m)
         associate (link => problem%linkage, at => problem%plan%joint_points(point))
            x(offset + 1:offset + m) = link%store%v(1:m, link%point_x(at))/link%scale
            y(offset + 1:offset + m) = link%store%v(1:m, link%point_y(at))/link%scale
         end associate
      end do
   end subroutine find_point

   pure subroutine add_force(body, at, force, loading)
      integer, intent(in) :: body
      complex(wp), intent(in) :: at(:), force(:)      !! shape (positions): metres from the input pivot; N
      type(output_load_t), intent(inout) :: loading
      type(unit_load_t), allocatable :: more(:)
      integer :: n

      n = size(loading%loads)
      allocate (more(n + 1))
      more(:n) = loading%loads
      more(n + 1)%body = body
      allocate (more(n + 1)%wrench(components_of_wrench, size(at)))
      more(n + 1)%wrench(1, :) = force%re
      more(n + 1)%wrench(2, :) = force%im
      more(n + 1)%wrench(3, :) = at%re*force%im - at%im*force%re
      call move_alloc(more, loading%loads)
   end subroutine add_force

   pure subroutine add_couple(body, n, sense, loading)
      integer, intent(in) :: body, n                  !! positions
      real(wp), intent(in) :: sense
      type(output_load_t), intent(inout) :: loading
      integer :: i

      call add_force(body, [((0.0_wp, 0.0_wp), i=1, n)], [((0.0_wp, 0.0_wp), i=1, n)], loading)
      loading%loads(size(loading%loads))%wrench(components_of_wrench, :) = sense
   end subroutine add_couple
end module psalm_joint_play
