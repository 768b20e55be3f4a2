!> The plan of a proof: the steps of the solution plan with, for each dyad, the arcs that lead from S to E.
!>
!> What the paths from the input pivot to S and to E share is left out: it cancels before it can widen anything.
module psalm_proof_plan
   use psalm_dyad_kind, only: assur_prp, assur_ppr, assur_rpp, assur_rpr, assur_rpr_guide_first, assur_rrp, assur_prr, assur_rrr
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t
   use psalm_plan, only: plan_t, step_point, origin
   implicit none (type, external)
   private
   public :: proof_plan_t, proof_step_t, make_proof_plan, complete_plan, path_of, measures_of, least_sine
   public :: cause_too_short, cause_difference, cause_guide, cause_link, cause_parallel

   integer, parameter :: cause_too_short = 1   !! both links together are too short
   integer, parameter :: cause_difference = 2  !! the difference of the links is too great
   integer, parameter :: cause_guide = 3       !! the guide is too long
   integer, parameter :: cause_link = 4        !! the link is shorter than the offset of the slide
   integer, parameter :: cause_parallel = 5    !! two slides are parallel

   real(wp), parameter :: least_sine = 1.0e-6_wp !! between two slides; below it they count as parallel

   type :: proof_step_t
      logical :: dyad = .false.
      integer :: kind = 0                   !! dyad: one of `assur_...`
      integer :: loop = 0, sign = 1         !! dyad: its loop and assembly mode
      integer :: from = 0, to = 0           !! points: of an arc its ends, of a dyad S and E
      integer :: arc = 0, sense = 1         !! arc
      integer :: p = 0, q = 0               !! dyad: its arcs
      integer :: places(2) = 0              !! dyad: numbers of its arcs in the loop
      logical :: wants(2) = .false.         !! dyad: something hangs on the direction of p, of q
      integer, allocatable :: terms(:)      !! dyad: steps whose arcs add up to E - S,
      integer, allocatable :: senses(:)     !! +1 or -1
      integer :: measure = 0                !! dyad: number of its first closure measure
      logical :: fixed = .false.            !! arc: it belongs to the frame
   end type proof_step_t

   type :: proof_plan_t
      type(proof_step_t), allocatable :: steps(:)
      integer, allocatable :: root(:)       !! by arc: root of its direction
      integer, allocatable :: slot(:)       !! by arc: varying length, 0: none
      integer :: nroots = 0, nlengths = 0, nmeasures = 0
      logical :: sliding_input = .false.
      integer :: input_slot = 0             !! varying length of the actuator
      integer, allocatable :: loop_of(:)    !! by measure: its loop
      integer, allocatable :: cause_of(:)   !! by measure: one of `cause_...`
      integer, allocatable :: made_by(:)    !! by point: the step that makes it
   end type proof_plan_t

contains

   !> Plan of a proof from the plan of a solution.
   pure subroutine make_proof_plan(mechanism, plan, proof)
      type(mechanism_t), intent(in) :: mechanism
      type(plan_t), intent(in) :: plan
      type(proof_plan_t), intent(out) :: proof
      integer :: k, loop

      allocate (proof%steps(size(plan%steps)))
      proof%root = plan%root
      proof%slot = plan%length_slot
      proof%nroots = plan%nroots
      proof%nlengths = plan%nlengths
      proof%sliding_input = mechanism%sliding_input
      if (mechanism%sliding_input) proof%input_slot = plan%length_slot(1)
      do k = 1, size(plan%steps)
         associate (step => plan%steps(k), own => proof%steps(k))
            own%from = step%from
            own%to = step%to
            own%fixed = step%fixed
            if (step%kind == step_point) then
               own%arc = step%arc
               own%sense = step%sense
               cycle
            end if
            loop = step%loop
            own%dyad = .true.
            own%loop = loop
            own%kind = mechanism%groups(loop)%kind
            own%sign = mechanism%groups(loop)%sign
            own%p = mechanism%groups(loop)%members(1)
            own%q = mechanism%groups(loop)%members(2)
            own%places = [mechanism%place(1, loop), mechanism%place(2, loop)]
            own%wants = plan%used([plan%root(own%p), plan%root(own%q)])
         end associate
      end do
      call complete_plan(proof)
   end subroutine make_proof_plan

   !> Fill in what follows from the steps: closure measures, the arcs from S to E of each dyad.
   pure subroutine complete_plan(proof)
      type(proof_plan_t), intent(inout) :: proof   !! with its steps, roots and slots
      integer :: k, m

      proof%nmeasures = 0
      allocate (proof%loop_of(0), proof%cause_of(0))
      allocate (proof%made_by(maxval(proof%steps%to)), source=0)
      do k = 1, size(proof%steps)
         associate (own => proof%steps(k))
            if (.not. own%dyad) then
               proof%made_by(own%to) = k
               cycle
            end if
            own%measure = proof%nmeasures + 1
            m = measures_of(own%kind)
            proof%nmeasures = proof%nmeasures + m
            proof%loop_of = [proof%loop_of, spread(own%loop, 1, m)]
            proof%cause_of = [proof%cause_of, causes_of(own%kind)]
         end associate
         call find_terms(proof, k)
      end do
   end subroutine complete_plan

   !> Closure measures of a kind of dyad.
   pure integer function measures_of(kind)
      integer, intent(in) :: kind

      measures_of = size(causes_of(kind))
   end function measures_of

   !> What it means that a measure is negative, measure by measure.
   pure function causes_of(kind) result(causes)
      integer, intent(in) :: kind
      integer, allocatable :: causes(:)

      select case (kind)
      case (assur_rrr)
         causes = [cause_too_short, cause_difference]
      case (assur_rpr, assur_rpr_guide_first)
         causes = [cause_guide]
      case (assur_rrp, assur_prr)
         causes = [cause_link, cause_link]
      case (assur_prp)
         causes = [cause_parallel]
      case (assur_rpp, assur_ppr)
         allocate (causes(0))
      end select
   end function causes_of

   !> Steps from the input pivot to a point.
   pure function path_of(proof, point) result(path)
      type(proof_plan_t), intent(in) :: proof
      integer, intent(in) :: point
      integer, allocatable :: path(:)
      integer :: at

      allocate (path(0))
      at = point
      do while (at /= origin)
         path = [proof%made_by(at), path]
         at = proof%steps(proof%made_by(at))%from
      end do
   end function path_of

   !> Arcs from S to E of the dyad of a step, by way of the last joint that both hang on.
   pure subroutine find_terms(proof, k)
      type(proof_plan_t), intent(inout) :: proof
      integer, intent(in) :: k
      integer, allocatable :: s(:), e(:)
      integer :: shared

      s = path_of(proof, proof%steps(k)%from)
      e = path_of(proof, proof%steps(k)%to)
      shared = 0
      do while (shared < min(size(s), size(e)))
         if (s(shared + 1) /= e(shared + 1)) exit
         shared = shared + 1
      end do
      proof%steps(k)%terms = [e(shared + 1:), s(shared + 1:)]
      proof%steps(k)%senses = [spread(1, 1, size(e) - shared), spread(-1, 1, size(s) - shared)]
   end subroutine find_terms
end module psalm_proof_plan
