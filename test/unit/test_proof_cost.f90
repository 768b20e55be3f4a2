!> What a proof costs, counted in boxes; with an argument also in time, beside the positions of the engine.
program test_proof_cost
   use, intrinsic :: iso_fortran_env, only: int64
   use cases, only: load_case
   use check, only: checks_t
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t, new_problem
   use psalm_kinds, only: wp, full_turn
   use psalm_plan, only: plan_t, make_plan
   use psalm_proof, only: proof_t, proof_linkage_t, prepare_proof, bind_proof, prove_closure
   use psalm_proof_ranges, only: proven_extreme_t, prove_extremes
   implicit none (type, external)

   character(18), parameter :: names(*) = [character(18) :: 'needle', 'dwell', 'dyad1_crank_rocker', 'dyad4_slider_crank']
   integer, parameter :: most_boxes = 40      !! of closure with wide margins over a full turn
   integer, parameter :: most_extreme_boxes = 10 !! of each extreme
   type(checks_t) :: t
   integer :: k

   if (command_argument_count() > 0) print '(a)', &
      'linkage             360 positions us   closure us   boxes   extremes us   boxes   of these quadruple'
   do k = 1, size(names)
      call cost(names(k))
   end do
   call t%report()

contains

   subroutine cost(name)
      character(*), intent(in) :: name
      integer, parameter :: positions = 360
      class(problem_t), allocatable :: problem, fine
      class(data_set_t), allocatable :: set
      type(plan_t) :: plan
      type(proof_linkage_t) :: linkage
      type(proof_t) :: proof
      type(proven_extreme_t), allocatable :: extremes(:)
      integer :: boxes(2), i, block, offset, n, repeats
      integer(int64) :: start, finish, rate
      real(wp) :: engine, closure, all_extremes

      allocate (problem, fine, set)
      call load_case(name, problem, set)
      plan = make_plan(problem%mechanism, problem%motion, everything=.true., all_roots=.false.)
      call prepare_proof(problem%mechanism, plan, linkage)
      call bind_proof(plan, problem%given, linkage)
      call prove_closure(linkage, 0.0_wp, full_turn, proof)
      call prove_extremes(linkage, proof, extremes, boxes)
      call t%is_true(proof%closes_everywhere() .and. proof%boxes <= most_boxes, trim(name)//': closes, proven in few boxes')
      call t%is_true(sum(boxes) <= 2*most_extreme_boxes*size(extremes), trim(name)//': extremes in few boxes')
      if (command_argument_count() == 0) return
      call new_problem(problem%mechanism, problem%given, problem%parameters, [(real(i, wp), i=1, positions)], .true., fine)
      call fine%bind(problem%given)
      repeats = 2000
      call system_clock(start, rate)
      do i = 1, repeats
         do block = 1, fine%blocks()
            call fine%solve_block(block, offset, n)
         end do
      end do
      call system_clock(finish)
      engine = real(finish - start, wp)/real(rate, wp)/real(repeats, wp)*1.0e6_wp
      call system_clock(start)
      do i = 1, repeats
         call prove_closure(linkage, 0.0_wp, full_turn, proof)
      end do
      call system_clock(finish)
      closure = real(finish - start, wp)/real(rate, wp)/real(repeats, wp)*1.0e6_wp
      repeats = 20
      call system_clock(start)
      do i = 1, repeats
         call prove_extremes(linkage, proof, extremes, boxes)
      end do
      call system_clock(finish)
      all_extremes = real(finish - start, wp)/real(rate, wp)/real(repeats, wp)*1.0e6_wp
      print '(a18,f19.2,f13.2,i8,f14.2,2i8)', name, engine, closure, proof%boxes, all_extremes, sum(boxes), boxes(2)
   end subroutine cost
end program test_proof_cost
