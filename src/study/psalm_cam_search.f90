!> The best cam within limits: numbers of &CAM as unknowns of the solvers.
!>
!> Unknowns are counted from 0 to 1 between their bounds. What is to be least, and every limit, is the extreme of a measure over the
!> samples of a turn, refined by parabolas between them; each limit counts for every segment by itself, so that it changes
!> smoothly. Slopes are central differences.
module psalm_cam_search
   use psalm_cam_contact, only: cam_contact_t
   use psalm_cam_data, only: cam_group_t, cam_variation_t, vary_item, goal_base, goal_outer, goal_alpha, goal_rho, goal_accel, &
                             goal_stress
   use psalm_cam_shape, only: cam_shape_t, samples_t, sample_turn, greatest_of, measure_pressure, measure_convex, measure_concave, &
                              measure_base, measure_outer, measure_input, measure_face_low, measure_face_high
   use psalm_cam_study, only: cam_role_t, make_shape, cam_of_part, find_sampled_contact
   use psalm_cam_trace, only: fault_none
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp
   use psalm_nlp, only: nlp_t, normal_equations_t
   use psalm_preparation, only: prepared_t
   use psalm_solver, only: solver_t, ending_t
   use psalm_solver_kind, only: find_solver, solver_kind_t
   use psalm_solvers, only: new_solver
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: cam_search_t, search_cam

   integer, parameter :: coarse = 1440           !! samples of a turn while searching
   integer, parameter :: fine = 7200             !! and at the end
   character(*), parameter :: usual = 'LD_SLSQP'
   real(wp), parameter :: nudge = 1.0e-5_wp      !! of an unknown, for slopes
   real(wp), parameter :: inside = 1.0e-6_wp     !! part of a limit that is kept free: more than the solvers' own slack
   real(wp), parameter :: far = 10.0_wp          !! of a cam that cannot be: every limit is exceeded so much

   !> What a search found.
   type :: cam_search_t
      real(wp), allocatable :: before(:), after(:) !! values varied
      real(wp) :: objective_before = 0.0_wp, objective = 0.0_wp
      logical :: feasible = .false.              !! all limits are kept
      logical :: refused = .false.               !! the solver cannot work on it
      integer :: evaluations = 0
      character(:), allocatable :: solver
   end type cam_search_t

   type, extends(nlp_t) :: cam_problem_t
      type(data_set_t), pointer :: set => null()  !! the caller's
      type(cam_group_t) :: cams(2)               !! as given
      class(prepared_t), allocatable :: prepared
      integer :: samples = coarse
      real(wp) :: worst = 1.0_wp                 !! objective of a cam that cannot be
      ! of the last point looked at
      real(wp), allocatable :: x(:), limits(:)
      real(wp) :: objective = 0.0_wp
   contains
      procedure :: measure => measure_cam
      procedure :: linearise => linearise_cam
      procedure :: count_constraints => count_cam
      procedure :: constrain => constrain_cam
      procedure :: accept => accept_cam
   end type cam_problem_t

contains

   !> Find the best cam; `cams` and `prepared` leave with its numbers if it keeps the limits, or is better than what was given.
   subroutine search_cam(set, cams, prepared, search, stop)
      type(data_set_t), intent(in), target :: set
      type(cam_group_t), intent(inout) :: cams(2)    !! CAM, which is searched, and CAM2
      type(prepared_t), intent(inout) :: prepared
      type(cam_search_t), intent(out) :: search
      type(stop_t), intent(in), optional :: stop     !! asked now and then; the best so far is there
      type(cam_problem_t), allocatable, target :: problem
      class(solver_t), allocatable :: solver
      type(solver_kind_t) :: kind
      type(stop_t) :: limited
      type(ending_t) :: ending
      real(wp), allocatable :: x(:)
      integer :: round

      kind = find_solver(usual)
      if (set%search%given) kind = set%search%solver
      search%solver = trim(kind%name)
      call new_solver(kind, solver)
      solver%most_evaluations = set%search%maxeval
      if (present(stop)) limited = stop
      if (set%search%maxtime > 0.0_wp) call limited%limit_time(set%search%maxtime)
      allocate (problem)
      problem%set => set
      problem%cams = cams
      allocate (problem%prepared, source=prepared)
      associate (list => cams(1)%variations)
         problem%core = size(list)
         allocate (problem%low(size(list)), source=0.0_wp)
         allocate (problem%high(size(list)), source=1.0_wp)
         allocate (problem%scale(size(list)), source=0.05_wp)
         search%before = [(value_of(cams(1), prepared%given, list(round)), round=1, size(list))]
         x = (search%before - list%low)/(list%high - list%low)
      end associate
      problem%has_gradient = .true.
      allocate (problem%x(size(x)), source=-huge(1.0_wp))
      problem%worst = huge(1.0_wp)
      problem%samples = fine
      call look(problem, x)
      search%objective_before = problem%objective
      problem%worst = far*max(problem%objective, 1.0_wp)
      if (.not. problem%objective < huge(1.0_wp)) problem%worst = far
      ! coarsely, then finely from there
      do round = 1, 2
         problem%samples = merge(coarse, fine, round == 1)
         problem%x = -huge(1.0_wp)
         call solver%minimise(problem, x, limited, ending)
         if (limited%waiting()) exit
      end do
      search%refused = .not. ending%objective < huge(1.0_wp)
      call problem%accept(x, search%objective, search%feasible)
      search%evaluations = problem%evaluations
      search%after = [(unscaled(cams(1)%variations(round), x(round)), round=1, size(x))]
      call take_values(search%after, cams(1), prepared%given)
   end subroutine search_cam

   pure real(wp) function unscaled(one, x)
      type(cam_variation_t), intent(in) :: one
      real(wp), intent(in) :: x

      unscaled = one%low + x*(one%high - one%low)
   end function unscaled

   !> What is written of a number that varies.
   pure real(wp) function value_of(cam, dimensions, one) result(value)
      type(cam_group_t), intent(in) :: cam
      type(dimensions_t), intent(in) :: dimensions
      type(cam_variation_t), intent(in) :: one

      select case (vary_item(one%item))
      case ('XCAM')
         value = cam%x
      case ('YCAM')
         value = cam%y
      case ('FOLLK')
         value = cam%roller%distance
      case ('FOLANG')
         value = cam%roller%angle
      case ('FACANG')
         value = cam%face_angle
      case ('RROLL')
         value = cam%roller%radius
      case ('ORIGLK')
         value = dimensions%origlk
      case ('ORIGNG')
         value = dimensions%origng
      case ('SEGEND')
         value = cam%finish(one%segment)
      case ('SEGVEL')
         value = cam%velocity(one%segment)
      case ('SEGACC')
         value = cam%acceleration(one%segment)
      case default
         value = cam%zones(one%zone, one%segment)
      end select
   end function value_of

   !> Write values into a cam, and into the dimensions where the linkage is moved.
   pure subroutine take_values(values, cam, dimensions)
      real(wp), intent(in) :: values(:)
      type(cam_group_t), intent(inout) :: cam
      type(dimensions_t), intent(inout) :: dimensions
      integer :: k

      do k = 1, size(values)
         associate (one => cam%variations(k), value => values(k))
            select case (vary_item(one%item))
            case ('XCAM')
               cam%x = value
            case ('YCAM')
               cam%y = value
            case ('FOLLK')
               cam%roller%distance = value
            case ('FOLANG')
               cam%roller%angle = value
            case ('FACANG')
               cam%face_angle = value
            case ('RROLL')
               cam%roller%radius = value
            case ('ORIGLK')
               dimensions%origlk = value
            case ('ORIGNG')
               dimensions%origng = value
            case ('SEGEND')
               cam%finish(one%segment) = value
            case ('SEGVEL')
               cam%velocity(one%segment) = value
            case ('SEGACC')
               cam%acceleration(one%segment) = value
            case default
               cam%zones(one%zone, one%segment) = value
            end select
         end associate
      end do
      do k = 1, size(cam%finish)
         if (sum(cam%zones(:, k)) > 0.0_wp) cam%zones(:, k) = cam%zones(:, k)/sum(cam%zones(:, k))
      end do
   end subroutine take_values

   !> Objective and limits at a point, unless they are those of the last one.
   subroutine look(problem, x)
      class(cam_problem_t), intent(inout) :: problem
      real(wp), intent(in) :: x(:)
      class(prepared_t), allocatable :: prepared
      type(cam_group_t) :: cams(2), cam
      class(cam_shape_t), allocatable :: shape     ! large: it would fill a small stack
      type(samples_t) :: samples
      type(diagnostics_t) :: findings
      type(cam_contact_t) :: contact
      real(wp), allocatable :: pressure(:), convex(:), way(:)
      real(wp) :: r
      logical, allocatable :: moving(:)
      integer :: k, n

      if (all(abs(x - problem%x) <= 0.0_wp)) return
      problem%evaluations = problem%evaluations + 1
      problem%x = x
      allocate (prepared, source=problem%prepared)
      cams = problem%cams
      call take_values([(unscaled(cams(1)%variations(k), x(k)), k=1, size(x))], cams(1), prepared%given)
      cam = cam_of_part(cams, cam_role_t())
      n = max(1, size(cam%finish))
      if (.not. allocated(problem%limits)) allocate (problem%limits(3*n + 2))
      problem%objective = problem%worst
      problem%limits = far
      if (size(cam%finish) > 1) then
         if (any(cam%finish(2:) <= cam%finish(:n - 1)) .or. cam%finish(1) <= 0.0_wp) return
      end if
      allocate (shape)
      call make_shape(problem%set, cams, prepared, cam_role_t(), shape, findings)
      if (findings%failed()) return
      call sample_turn(shape, cam, samples, problem%samples)
      if (any(samples%states%fault /= fault_none) .or. .not. all(samples%possible)) return
      r = merge(0.0_wp, shape%roller, shape%flat)
      allocate (pressure(n), convex(n), moving(n))
      way = abs(samples%states%c(0, :) - shape%axes%centre)
      associate (segment => shape%motion%law%pieces(samples%piece)%segment)
         do k = 1, n
            pressure(k) = greatest_of(shape, samples, measure_pressure, k)
            convex(k) = greatest_of(shape, samples, measure_convex, k)
            moving(k) = maxval(abs(samples%states%y(1, :)), segment == k) > 0.0_wp
            if (cam%rise_only) moving(k) = moving(k) .and. way(findloc(segment, k, dim=1, back=.true.)) > way(findloc(segment, k, &
                                                                                                                  dim=1))
            problem%limits(k) = -1.0_wp
            if (moving(k)) problem%limits(k) = pressure(k)/cam%pressure_angle - 1.0_wp
            if (shape%flat) then
               ! a face needs a convex profile, with RHOMIN radii of that size
               problem%limits(n + k) = (cam%least_radius - minval(samples%points%radius, segment == k))/maxval(way)
               problem%limits(2*n + k) = -1.0_wp
            else
               ! no sharper than roller and RHOMIN allow, no hollow smaller than the cutter
               problem%limits(n + k) = convex(k)*(r + cam%least_radius) - 1.0_wp
               problem%limits(2*n + k) = greatest_of(shape, samples, measure_concave, k)*(shape%cutter - r) - 1.0_wp
            end if
         end do
      end associate
      problem%limits(3*n + 1:) = -1.0_wp
      if (cam%half_face > 0.0_wp .and. shape%flat) problem%limits(3*n + 1) = &
         (maxval([(greatest_of(shape, samples, measure_face_high, k), k=1, n)]) &
          + maxval([(greatest_of(shape, samples, measure_face_low, k), k=1, n)]))/(2.0_wp*cam%half_face) - 1.0_wp
      if (cam%speed > 0.0_wp .and. (cam%stress > 0.0_wp .or. cam%goal == goal_stress)) then
         call find_sampled_contact(problem%set, prepared, cam, shape, samples, contact)
         if (.not. contact%known) return
         if (cam%stress > 0.0_wp) problem%limits(size(problem%limits)) = maxval(contact%stress)/cam%stress - 1.0_wp
      end if
      select case (cam%goal)
      case (goal_base)
         problem%objective = -maxval([(greatest_of(shape, samples, measure_base, k), k=1, n)])
      case (goal_outer)
         problem%objective = maxval([(greatest_of(shape, samples, measure_outer, k), k=1, n)])
      case (goal_alpha)
         problem%objective = maxval(pressure, moving)
      case (goal_rho)
         problem%objective = maxval(convex)/max(1.0_wp - r*maxval(convex), tiny(1.0_wp))
         if (shape%flat) problem%objective = 1.0_wp/max(minval(samples%points%radius), tiny(1.0_wp))
      case (goal_accel)
         problem%objective = maxval([(greatest_of(shape, samples, measure_input + 1, k), k=1, n)])
      case (goal_stress)
         problem%objective = maxval(contact%stress)
      end select
   end subroutine look

   !> Objective, and sum of the squared violations.
   subroutine measure_cam(self, x, objective, violation)
      class(cam_problem_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: objective, violation

      call look(self, x)
      objective = self%objective
      violation = sum(max(self%limits + inside, 0.0_wp)**2)
   end subroutine measure_cam

   !> Gradient of objective + weight * violation, halved.
   subroutine linearise_cam(self, x, weight, equations)
      class(cam_problem_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(in) :: weight
      type(normal_equations_t), intent(inout) :: equations
      real(wp) :: place(size(x)), ahead, behind, violation
      integer :: k

      self%jacobians = self%jacobians + 1
      call equations%clear(self%core, self%local)
      do k = 1, size(x)
         place = x
         place(k) = x(k) + nudge
         call self%measure(place, ahead, violation)
         ahead = ahead + weight*violation
         place(k) = x(k) - nudge
         call self%measure(place, behind, violation)
         behind = behind + weight*violation
         equations%gradient(k) = (ahead - behind)/(4.0_wp*nudge)
      end do
   end subroutine linearise_cam

   integer function count_cam(self)
      class(cam_problem_t), intent(in) :: self

      count_cam = size(self%limits)
   end function count_cam

   subroutine constrain_cam(self, x, values, slopes)
      class(cam_problem_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: values(:)
      real(wp), intent(out), optional :: slopes(:, :)
      real(wp) :: place(size(x)), ahead(size(values))
      integer :: k

      if (present(slopes)) then
         do k = 1, size(x)
            place = x
            place(k) = x(k) + nudge
            call look(self, place)
            ahead = self%limits
            place(k) = x(k) - nudge
            call look(self, place)
            slopes(k, :) = (ahead - self%limits)/(2.0_wp*nudge)
         end do
      end if
      call look(self, x)
      values = self%limits + inside
   end subroutine constrain_cam

   !> Limits and bounds are kept.
   subroutine accept_cam(self, x, objective, feasible)
      class(cam_problem_t), intent(inout) :: self
      real(wp), intent(in) :: x(:)
      real(wp), intent(out) :: objective
      logical, intent(out) :: feasible

      call look(self, x)
      objective = self%objective
      feasible = all(self%limits <= 0.0_wp) .and. all(x >= self%low .and. x <= self%high)
   end subroutine accept_cam
end module psalm_cam_search
