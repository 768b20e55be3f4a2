!> The chain of points and bars that SETUP makes of loop arrays: its laws for every data set.
program test_chain
   use cases, only: load_case, names
   use check, only: checks_t
   use psalm_data_set, only: data_set_t
   use psalm_error, only: problem_t
   use psalm_mechanism, only: mechanism_t, pivot
   implicit none (type, external)
   type(checks_t) :: t
   type(problem_t) :: problem
   type(data_set_t) :: set
   integer :: i

   do i = 1, size(names)
      call load_case(names(i), problem, set)
      associate (name => trim(names(i))//': ', mechanism => problem%mechanism)
         call t%equal_integer(size(mechanism%bars) - size(mechanism%points) + 1, mechanism%nloop, &
                              name//'bars less points of a connected chain, plus one, are its independent loops')
         call t%is_true(rings_close(mechanism), name//'every loop is a ring of arcs from the input pivot back to it')
         call t%is_true(points_are_reached(mechanism), name//'every point is reached from one before it')
      end associate
   end do
   call t%report()

contains

   !> Each arc begins where the one before it ends.
   pure logical function rings_close(mechanism)
      type(mechanism_t), intent(in) :: mechanism
      integer :: loop, a, at

      rings_close = .true.
      do loop = 1, mechanism%nloop
         at = pivot
         do a = 1, mechanism%loops(loop)%arcs
            associate (arc => mechanism%arcs(mechanism%seq(loop, a)))
               rings_close = rings_close .and. arc%ends(1) == at .and. arc%loop == loop .and. arc%place == a
               at = arc%ends(2)
            end associate
         end do
         rings_close = rings_close .and. at == pivot
      end do
   end function rings_close

   pure logical function points_are_reached(mechanism)
      type(mechanism_t), intent(in) :: mechanism
      integer :: p

      points_are_reached = mechanism%points(pivot)%from == 0
      do p = 2, size(mechanism%points)
         points_are_reached = points_are_reached .and. mechanism%points(p)%from >= pivot .and. mechanism%points(p)%from < p
      end do
   end function points_are_reached
end program test_chain
