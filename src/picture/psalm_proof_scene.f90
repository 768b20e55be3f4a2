!> What pictures show of a proof of the motion: where it opens, extremes, dead points, the least clearances; and links with a width.
module psalm_proof_scene
   use psalm_clearances, only: clearance_t, list_clearances, find_depth, points_of_clearance
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t
   use psalm_group_words, only: the_group
   use psalm_kinds, only: wp
   use psalm_margin_list, only: name_of_clearance, name_of_limit
   use psalm_mechanism, only: mechanism_t, at_finish, pivot
   use psalm_output_kind, only: kind_of_output, motion_point
   use psalm_place, only: beside_t
   use psalm_proof, only: limit_t, piece_closes, piece_opens
   use psalm_proof_list, only: cause_words, end_text, extreme_name, quantity_name, shown, short
   use psalm_proof_motion, only: proven_dead_point_t, quantity_output
   use psalm_proof_ranges, only: extreme_x, extreme_y, extreme_output, extreme_distance
   use psalm_proof_study, only: proof_study_t, kept_t, study_proof, proof_wanted, no_proof
   use psalm_samples, only: sample_set_t, prepare_samples, evaluate_samples
   use psalm_text, only: lower_case
   use psalm_shown_input, only: reference_input
   implicit none (type, external)
   private
   public :: proof_scene_t, near_t, make_proof_scene, change_unit_of_proof

   real(wp), parameter :: certain = 1.0e-9_wp       !! a bracket of a dead point narrower than this, degrees or relative, is one

   !> Something proven, at an input or of the whole range.
   type :: proof_mark_t
      character(:), allocatable :: kind             !! opens, extreme, dead, clearance or range
      character(:), allocatable :: text
      logical :: placed = .false.                   !! it has an input
      real(wp) :: input = 0.0_wp
      logical :: of_output = .false.                !! it is the output point that has an extreme or stands still
      real(wp) :: at(2) = 0.0_wp                    !! the output point there
   end type proof_mark_t

   !> The least of a clearance: the shapes there and the shortest way between them.
   type :: near_t
      integer :: mark = 0                           !! its mark
      integer :: points = 0                         !! of links: 2 or 4; a joint has 1
      real(wp) :: ends(2, points_of_clearance) = 0.0_wp
      real(wp) :: way(2, 2) = 0.0_wp
      real(wp) :: widths(2) = 0.0_wp
      logical :: tightest = .false.                 !! the least over what is asked
   end type near_t

   !> A link with a width.
   type :: wide_t
      integer :: start = 0, finish = 0              !! joints as drawn
      real(wp) :: width = 0.0_wp
   end type wide_t

   type :: proof_scene_t
      type(proof_mark_t), allocatable :: marks(:)
      type(near_t), allocatable :: near(:)
      type(wide_t), allocatable :: wide(:)
   end type proof_scene_t

contains

   !> What there is to show; `found` is false if nothing is proven of the case and no link has a width.
   subroutine make_proof_scene(set, problem, dimensions, drawn, output, scene, found)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem        !! with the prescribed inputs
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: drawn(:)               !! by point of the mechanism: the joint that is drawn there
      integer, intent(in) :: output                 !! the joint that is the output point
      type(proof_scene_t), intent(out) :: scene
      logical, intent(out) :: found
      type(proof_study_t), allocatable :: study
      integer :: s

      allocate (scene%marks(0), scene%near(0), scene%wide(size(set%constr%segments)))
      do s = 1, size(scene%wide)
         associate (segment => set%constr%segments(s))
            ! of what has an end that is no joint of the picture, no outline
            if (any(segment%places%link > 0)) cycle
            scene%wide(s) = wide_t(joint_of(segment%loops(1), segment%arcs(1)), joint_of(segment%loops(2), segment%arcs(2)), &
                                   segment%width)
         end associate
      end do
      scene%wide = pack(scene%wide, [(all(set%constr%segments(s)%places%link == 0), s=1, size(scene%wide))])
      found = size(scene%wide) > 0
      if (proof_wanted(set, .false.) == no_proof) return
      if (set%is_beyond_arrays()) then
         call add_proof_of_poses(set, problem, dimensions, scene, found)
         return
      end if
      allocate (study)
      call study_proof(set, problem, dimensions, proof_wanted(set, .false.), study)
      if (study%empty) return
      found = .true.
      call add_limits(problem%mechanism, study, scene)
      call add_extremes(problem%mechanism, study, scene)
      call add_margins(problem%mechanism, study, scene)
      call add_clearances(set, study, scene)
      call place_marks(set, problem, dimensions, study, scene)

   contains

      integer function joint_of(loop, arc)
         integer, intent(in) :: loop, arc

         if (loop == 0) then
            joint_of = output
         else if (arc == 0) then
            joint_of = drawn(pivot)
         else
            joint_of = drawn(problem%mechanism%arcs(problem%mechanism%seq(loop, arc))%ends(at_finish))
         end if
      end function joint_of
   end subroutine make_proof_scene

   subroutine add_mark(scene, kind, text, input, of_output)
      type(proof_scene_t), intent(inout) :: scene
      character(*), intent(in) :: kind, text
      real(wp), intent(in), optional :: input       !! absent: of the whole range
      logical, intent(in), optional :: of_output
      type(proof_mark_t), allocatable :: more(:)
      integer :: i

      ! element by element, for texts of their own lengths
      allocate (more(size(scene%marks) + 1))
      do i = 1, size(scene%marks)
         more(i) = scene%marks(i)
      end do
      associate (mark => more(size(more)))
         mark%kind = kind
         mark%text = text
         mark%placed = present(input)
         if (present(input)) mark%input = input
         if (present(of_output)) mark%of_output = of_output
      end associate
      call move_alloc(more, scene%marks)
   end subroutine add_mark

   !> What is proven of a sketch with a larger group, in the poses of its links.
   subroutine add_proof_of_poses(set, problem, dimensions, scene, found)
      use psalm_chain_study, only: chain_study_t
      use psalm_chain_proof_study, only: chain_proof_t, place_on, place_of_extreme, prove_loops
      use psalm_chain_proof_list, only: links_of_group, name_of_quantity, ratio_of
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(proof_scene_t), intent(inout) :: scene
      logical, intent(inout) :: found
      type(chain_study_t), allocatable :: study
      type(chain_proof_t), allocatable :: proof
      type(proof_study_t) :: none
      type(clearance_t), allocatable :: clearances(:)
      type(beside_t), allocatable :: beside(:)
      integer, allocatable :: joints(:, :)
      character(:), allocatable :: ends
      logical :: valid, turns, of_output
      integer :: k, way
      integer :: columns                            ! of the first output, which the picture draws

      allocate (study, proof)
      call prove_loops(set, proof_wanted(set, .false.), study, proof, valid)
      if (.not. valid) return
      if (proof%braced > 0 .or. proof%empty) return
      found = .true.
      turns = .not. problem%mechanism%sliding_input
      associate (first => kind_of_output(set%sketch%outputs(1)%kind))
         columns = first%components
      end associate
      if (proof%complete) then
         call add_mark(scene, 'range', 'proven: closes for every input from '//end_in_words(proof%from, 1, turns)//' to '// &
                       end_in_words(proof%to, -1, turns))
      else
         do k = 1, size(proof%segments)
            associate (segment => proof%segments(k))
               way = merge(-1, 1, segment%to(1) > 0.0_wp)
               call add_mark(scene, 'range', 'proven: closes from the drawing to '// &
                             end_in_words(place_on(proof, k, segment%reached, turns), way, turns))
               if (segment%complete) cycle
               ends = links_of_group(study, proof%group(k), small=.true.)
               if (segment%turns_back) then
                  call add_mark(scene, 'opens', 'proven: opens at '// &
                                end_in_words(place_on(proof, k, segment%dead_high, turns), -way, turns)//', dead point of '//ends, &
                                place_on(proof, k, segment%reached, turns), .true.)
               else
                  call add_mark(scene, 'opens', 'undecided beyond '// &
                                end_in_words(place_on(proof, k, segment%reached, turns), way, turns)//', '//ends// &
                                ' at or near a dead point', place_on(proof, k, segment%reached, turns), .true.)
               end if
            end associate
         end do
      end if
      do k = 1, size(proof%ranges)
         associate (range => proof%ranges(k))
            if (.not. range%bounded) cycle
            of_output = k <= columns
            call add_extremes_of(trim(study%names(k)), range%low(1), place_of_extreme(proof, range, 1, turns), range%high(2), &
                                 place_of_extreme(proof, range, 2, turns), of_output, scene)
         end associate
      end do
      do k = 1, size(proof%ratios)
         associate (range => proof%ratios(k))
            if (range%bounded) call add_extremes_of(ratio_of(study, k, small=.true.), range%low(1), &
                                                  place_of_extreme(proof, range, 1, turns), &
                                                    range%high(2), place_of_extreme(proof, range, 2, turns), .false., scene)
         end associate
      end do
      do k = 1, size(proof%movement%dead)
         associate (dead => proof%movement%dead(k))
            call add_dead_point(name_of_quantity(study, dead, small=.true.), dead, dead%kind == quantity_output .and. &
                                dead%place <= columns, scene)
         end associate
      end do
      call list_clearances(set%constr, problem%mechanism, dimensions%outlk <= 0.0_wp, clearances, joints, beside)
      call dimensions%put_aside(beside)
      if (size(clearances) == size(proof%kept) .and. proof%one_drive) then
         none%kept = proof%kept
         ! their points are those of the loops here
         none%kept%clearance = clearances
      else
         allocate (none%kept(0))
      end if
      call add_clearances(set, none, scene)
      call place_marks(set, problem, dimensions, none, scene)
   end subroutine add_proof_of_poses

   !> Where it closes and where not.
   subroutine add_limits(mechanism, study, scene)
      type(mechanism_t), intent(in) :: mechanism
      type(proof_study_t), intent(in) :: study
      type(proof_scene_t), intent(inout) :: scene
      integer :: i

      associate (proof => study%proof)
         if (proof%closes_everywhere()) then
            call add_mark(scene, 'range', 'proven: closes for every input from '//place(proof%from, 1)//' to '//place(proof%to, -1))
            return
         end if
         do i = 1, size(proof%limits)
            associate (limit => proof%limits(i))
               select case (limit%kind)
               case (piece_closes)
                  call add_mark(scene, 'range', 'proven: closes from '//place(limit%from, 1)//' to '//place(limit%to, -1))
               case (piece_opens)
                  call add_mark(scene, 'opens', 'proven: opens at '//place(limit%from, 1)//', '//why(limit), limit%from, &
                                .true.)
                  call add_mark(scene, 'opens', 'proven: open up to '//place(limit%to, -1), limit%to, .true.)
               case default
                  if (is_between_two_of_a_kind(i)) call add_mark(scene, 'opens', 'undecided at '//short(limit%from)//', '// &
                                                                 why(limit), limit%from, .true.)
               end select
            end associate
         end do
      end associate

   contains

      !> An end rounded up or down: what is said stays true.
      function place(input, way) result(words)
         real(wp), intent(in) :: input
         integer, intent(in) :: way
         character(:), allocatable :: words

         words = end_in_words(input, way, study%proof%turns)
      end function place

      function why(limit) result(words)
         type(limit_t), intent(in) :: limit
         character(:), allocatable :: words

         words = the_group(mechanism, limit%loop)//', '//lower_case(cause_words(limit%cause))
      end function why

      !> A bracket at an end of what closes is seen from its neighbours.
      logical function is_between_two_of_a_kind(i)
         integer, intent(in) :: i

         is_between_two_of_a_kind = i == 1 .or. i == size(study%proof%limits)
         if (is_between_two_of_a_kind) return
         associate (limits => study%proof%limits)
            is_between_two_of_a_kind = limits(i - 1)%kind == limits(i + 1)%kind
         end associate
      end function is_between_two_of_a_kind
   end subroutine add_limits

   !> An end of a range rounded up or down, without zeros at its end, which say nothing.
   function end_in_words(input, way, turns) result(words)
      real(wp), intent(in) :: input
      integer, intent(in) :: way                    !! 1: up, -1: down
      logical, intent(in) :: turns
      character(:), allocatable :: words

      words = trim(adjustl(end_text(input, way, turns)))
      if (index(words, '.') == 0 .or. scan(words, 'DE') > 0) return
      words = words(:max(verify(words, '0', back=.true.), index(words, '.') + 1))
   end function end_in_words

   !> The least and the greatest value of a quantity.
   subroutine add_extremes_of(name, least, least_at, greatest, greatest_at, of_output, scene)
      character(*), intent(in) :: name
      real(wp), intent(in) :: least, greatest       !! bounds
      real(wp), intent(in) :: least_at, greatest_at
      logical, intent(in) :: of_output
      type(proof_scene_t), intent(inout) :: scene

      call add_mark(scene, 'extreme', name//': at least '//shown(least, -1)//', at '//short(least_at), least_at, of_output)
      call add_mark(scene, 'extreme', name//': at most '//shown(greatest, 1)//', at '//short(greatest_at), greatest_at, of_output)
   end subroutine add_extremes_of

   !> Extremes and dead points.
   subroutine add_extremes(mechanism, study, scene)
      type(mechanism_t), intent(in) :: mechanism
      type(proof_study_t), intent(in) :: study
      type(proof_scene_t), intent(inout) :: scene
      character(:), allocatable :: name
      logical :: of_output
      integer :: i

      do i = 1, size(study%extremes)
         associate (extreme => study%extremes(i))
            if (.not. extreme%found) cycle
            name = extreme_name(mechanism, extreme, small=.true.)
            of_output = any(extreme%kind == [extreme_x, extreme_y, extreme_output, extreme_distance])
            call add_extremes_of(name, extreme%least_low, extreme%least_at, extreme%greatest_high, extreme%greatest_at, of_output, &
                                 scene)
         end associate
      end do
      do i = 1, size(study%movement%dead)
         associate (dead => study%movement%dead(i))
            call add_dead_point(quantity_name(mechanism, dead, small=.true.), dead, dead%kind == quantity_output, scene)
         end associate
      end do
   end subroutine add_extremes

   !> A dead point, if it is bracketed narrowly.
   subroutine add_dead_point(name, dead, of_output, scene)
      character(*), intent(in) :: name
      type(proven_dead_point_t), intent(in) :: dead
      logical, intent(in) :: of_output
      type(proof_scene_t), intent(inout) :: scene

      if (dead%high - dead%low > certain*max(1.0_wp, abs(dead%low))) return
      call add_mark(scene, 'dead', 'dead point of '//name//', at '//short(0.5_wp*(dead%low + dead%high)), &
                    0.5_wp*(dead%low + dead%high), of_output)
   end subroutine add_dead_point

   !> How far the dyads stay inside their limits.
   subroutine add_margins(mechanism, study, scene)
      type(mechanism_t), intent(in) :: mechanism
      type(proof_study_t), intent(in) :: study
      type(proof_scene_t), intent(inout) :: scene
      character(:), allocatable :: words
      integer :: i

      do i = 1, size(study%margins)
         associate (own => study%margins(i))
            words = 'margin, '//name_of_limit(mechanism, own%margin, study%trmin_given, small=.true.)//': at least '// &
                    shown(own%low, -1)//', at '//short(own%margin%delt)
            if (own%is_broken) words = words//', violated'
            call add_mark(scene, 'extreme', words, own%margin%delt)
         end associate
      end do
   end subroutine add_margins

   !> The least clearances.
   subroutine add_clearances(set, study, scene)
      type(data_set_t), intent(in) :: set
      type(proof_study_t), intent(in) :: study
      type(proof_scene_t), intent(inout) :: scene
      character(:), allocatable :: words
      integer :: i

      do i = 1, size(study%kept)
         associate (kept => study%kept(i), nearest => study%kept(i)%nearest)
            if (.not. nearest%found) cycle
            words = 'clearance, '//name_of_clearance(set, kept%clearance, small=.true.)//': at least '// &
                    shown(nearest%low, -1)//', at '//short(nearest%at)
            if (kept%clearance%asked > 0.0_wp) words = words//'; asked '//short(kept%clearance%asked)
            if (kept%is_broken) words = words//', broken'
            call add_mark(scene, 'clearance', words, nearest%at)
         end associate
      end do
   end subroutine add_clearances

   !> Where the output point is at the marks, and the links where they are nearest to something.
   subroutine place_marks(set, problem, dimensions, study, scene)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(proof_study_t), intent(in) :: study
      type(proof_scene_t), intent(inout) :: scene
      class(problem_t), allocatable :: plain         ! large: they would fill a small stack
      class(sample_set_t), allocatable :: samples
      type(clearance_t), allocatable :: clearances(:)
      type(near_t) :: near
      integer, allocatable :: joints(:, :)
      type(beside_t), allocatable :: beside(:)
      real(wp) :: depth, by(2, points_of_clearance), normal(2)
      integer :: i, j, k, tightest

      call list_clearances(set%constr, problem%mechanism, dimensions%outlk <= 0.0_wp, clearances, joints, beside)
      call dimensions%put_aside(beside)
      allocate (plain, source=problem)
      allocate (samples)
      plain%motion = motion_point
      call prepare_samples(plain, scene%marks%input - reference_input(plain%mechanism, dimensions), .false., &
                           joints, .false., samples, beside)
      call evaluate_samples(samples, dimensions)
      if (set%is_beyond_arrays()) call step_inside(samples, dimensions)
      do i = 1, size(scene%marks)
         scene%marks(i)%at = samples%out(i, :2)
      end do
      tightest = 0
      i = size(scene%marks) - count(study%kept%nearest%found)
      do j = 1, size(study%kept)
         if (.not. study%kept(j)%nearest%found) cycle
         i = i + 1
         associate (clearance => study%kept(j)%clearance)
            do k = 1, points_of_clearance
               if (clearance%points(k) == 0) then
                  near%ends(:, k) = samples%out(i, :2)
               else
                  near%ends(:, k) = samples%joints(i, :, clearance%points(k))
               end if
            end do
            near%mark = i
            near%points = merge(1, merge(2, 4, clearance%region > 0), clearance%segments(1) == 0)
            near%widths = 0.0_wp
            do k = 1, 2
               if (clearance%segments(k) > 0) near%widths(k) = set%constr%segments(clearance%segments(k))%width
            end do
            call find_depth(clearance, near%ends, depth, by)
            normal = -(by(:, 1) + by(:, 2))
            near%way(:, 1) = norm2(by(:, 1))*near%ends(:, 1) + norm2(by(:, 2))*near%ends(:, 2)
            near%way(:, 2) = near%way(:, 1) - normal*(clearance%asked + clearance%reach - depth)
         end associate
         scene%near = [scene%near, near]
         if (tightest == 0) tightest = j
         if (slack_of(study%kept(j)) < slack_of(study%kept(tightest))) tightest = j
         if (tightest == j) then
            scene%near%tightest = .false.
            scene%near(size(scene%near))%tightest = .true.
         end if
      end do

   contains

      pure real(wp) function slack_of(kept)
         type(kept_t), intent(in) :: kept

         slack_of = kept%nearest%low - kept%clearance%asked
      end function slack_of
   end subroutine place_marks

   !> A larger group is not found at a dead point itself: from where it is not, go towards the drawing.
   subroutine step_inside(samples, dimensions)
      type(sample_set_t), intent(inout) :: samples
      type(dimensions_t), intent(in) :: dimensions
      real(wp), parameter :: parts(3) = [1.0e-9_wp, 1.0e-7_wp, 1.0e-5_wp] !! of the way to the drawing
      real(wp) :: marked(size(samples%closed)), inputs(size(samples%closed))
      integer :: k

      marked = samples%problem%delt
      inputs = marked
      do k = 1, size(parts)
         if (all(samples%closed)) return
         where (.not. samples%closed) inputs = (1.0_wp - parts(k))*marked
         call samples%problem%move_inputs(inputs)
         call evaluate_samples(samples, dimensions)
      end do
   end subroutine step_inside

   !> Places and widths in another unit.
   subroutine change_unit_of_proof(scene, unit)
      type(proof_scene_t), intent(inout) :: scene
      real(wp), intent(in) :: unit
      integer :: i

      do i = 1, size(scene%marks)
         scene%marks(i)%at = scene%marks(i)%at/unit
      end do
      do i = 1, size(scene%near)
         scene%near(i)%ends = scene%near(i)%ends/unit
         scene%near(i)%way = scene%near(i)%way/unit
         scene%near(i)%widths = scene%near(i)%widths/unit
      end do
      scene%wide%width = scene%wide%width/unit
   end subroutine change_unit_of_proof
end module psalm_proof_scene
