!> What an evaluation costs: no allocation, only the loops that matter, the same bits for any number of threads.
module counted_allocation
   use, intrinsic :: iso_c_binding, only: c_ptr, c_size_t
   implicit none (type, external)
   private
   public :: malloc, allocations

   integer :: allocations = 0 !! calls of malloc so far; this test alone needs a variable that changes

   interface
      type(c_ptr) function libc_malloc(bytes) bind(c, name='__libc_malloc')
         import :: c_ptr, c_size_t
         implicit none (type, external)
         integer(c_size_t), value :: bytes
      end function libc_malloc
   end interface

contains

   !> Stands in for the C library's malloc in this program.
   type(c_ptr) function malloc(bytes) bind(c, name='malloc')
      integer(c_size_t), value :: bytes

      allocations = allocations + 1
      malloc = libc_malloc(bytes)
   end function malloc
end module counted_allocation

program test_cost
   use cases, only: load_case
   use check, only: checks_t
   use counted_allocation, only: allocations
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp
   use psalm_plan, only: step_dyad
   use psalm_dimensions, only: dimensions_t
   implicit none (type, external)
   type(checks_t) :: t

   call no_allocation('needle')
   call no_allocation('chain_short')
   call no_allocation('actuator_rapson_slide')
   call no_allocation('textile')
   call no_allocation('dyad4_slider_crank')
   call pruning()
   call threads()
   call t%report()

contains

   subroutine no_allocation(name)
      character(*), intent(in) :: name
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      type(dimensions_t) :: dimensions
      real(wp) :: objective, total
      real(wp), allocatable :: probe(:)
      integer :: before, loop, i

      allocate (problem, set)
      call load_case(name, problem, set)
      if (.not. problem%desired) then
         call problem%set_desired(spread(spread(1.0_wp, 1, problem%positions), 2, problem%output%kind%components))
      end if
      dimensions = problem%given
      before = allocations
      allocate (probe(100))
      call t%is_true(allocations > before .and. size(probe) == 100, 'allocations are counted')
      total = 0.0_wp
      before = allocations
      do i = 1, 50
         dimensions%arcl(2) = problem%given%arcl(2)*(1.0_wp + 1.0e-6_wp*real(i, wp))
         dimensions%gama(4) = problem%given%gama(4) + 1.0e-6_wp*real(i, wp)
         dimensions%crnki = problem%given%crnki + 1.0e-6_wp*real(i, wp)
         call problem%evaluate(dimensions, objective, loop)
         total = total + objective
      end do
      call t%equal_integer(allocations - before, 0, name//': an evaluation allocates nothing')
      call t%is_true(total > 0.0_wp, name//': the evaluations were made')
   end subroutine no_allocation

   !> The output hangs on loop 2 of 64: two dyads are solved, as in a linkage of two loops.
   subroutine pruning()
      class(problem_t), allocatable :: pruned, whole, everything
      class(data_set_t), allocatable :: set

      allocate (pruned, whole, everything, set)
      call load_case('hard/pruned64', pruned, set)
      call load_case('hard/chain64', whole, set)
      call load_case('hard/pruned64', everything, set, everything=.true.)
      call t%equal_integer(count(pruned%plan%steps%kind == step_dyad), 2, 'two dyads of 64 are solved')
      call t%equal_integer(count(whole%plan%steps%kind == step_dyad), 64, 'all are solved where the output needs them')
      call t%equal_integer(count(everything%plan%steps%kind == step_dyad), 64, 'all are solved where everything is asked for')
      call t%is_true(size(pruned%plan%steps) <= 7, 'no point is made for loops that are not solved')
      call t%equal_integer(count(pruned%plan%solved), 2, 'device 8 is told')
   end subroutine pruning

   subroutine threads()
      class(problem_t), allocatable :: problem
      class(data_set_t), allocatable :: set
      integer, parameter :: n = 20000
      real(wp) :: one, many
      integer :: i, loop

      allocate (problem, set)
      call load_case('needle', problem, set)
      problem%tangle = 90.0_wp
      call problem%set_inputs([(real(i, wp)*0.018_wp, i=1, n)])
      call problem%set_desired(reshape([(147.0_wp + real(mod(i, 7), wp), i=1, n)], [n, 1]))
      call problem%evaluate(problem%given, one, loop)
      call t%equal_integer(loop, 0, 'the linkage closes through the whole turn')
      do i = 2, 4
         call problem%set_threads(i)
         call problem%evaluate(problem%given, many, loop)
         call t%is_true(abs(many - one) <= 0.0_wp, 'the same bits for any number of threads')
         call t%is_true(allocated(problem%linkages), 'threads are at work')
      end do
   end subroutine threads
end program test_cost
