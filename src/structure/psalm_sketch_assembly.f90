!> A sketch put together at its drawing: exact lengths may have moved it.
module psalm_sketch_assembly
   use psalm_angles, only: unit_vector
   use psalm_assur_order, only: assur_order_t
   use psalm_closure, only: closure_t, state_t, make_closure, start_state, solve_group, place_points, rank_lost
   use psalm_data_set, only: data_set_t
   use psalm_dense, only: factors_t
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_sketch, only: slide_t
   use psalm_sketch_check, only: check_sketch
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: assemble_sketch, move_slides

contains

   !> Check a sketch and put it together at the drawing.
   subroutine assemble_sketch(set, closure, state, valid, findings)
      type(data_set_t), intent(in) :: set
      type(closure_t), intent(out) :: closure
      type(state_t), intent(out) :: state        !! at the drawing
      logical, intent(out) :: valid
      type(diagnostics_t), intent(inout) :: findings
      type(assur_order_t) :: order
      type(factors_t) :: factors
      type(diagnostics_t) :: own
      logical :: closed
      integer :: g

      valid = .false.
      own%file = findings%file
      call check_sketch(set, order, own)
      call findings%append(own)
      if (own%failed()) return
      call make_closure(set%sketch, order, closure)
      call start_state(closure, state)
      do g = 1, size(closure%groups)
         if (size(closure%groups(g)%links) == 0) cycle
         call solve_group(closure, g, state, closed, factors)
         if (.not. closed .or. factors%reciprocal_condition < rank_lost) then
            call set%origins%error(findings, 'CHAIN', 'LNK', failure(g, closed), closure%groups(g)%links(1))
            return
         end if
      end do
      call place_points(closure, state, 0)
      valid = .true.

   contains

      function failure(group, closed) result(text)
         integer, intent(in) :: group
         logical, intent(in) :: closed
         character(:), allocatable :: text
         logical :: one
         integer :: k

         text = 'link'
         associate (links => closure%groups(group)%links)
            one = size(links) == 1
            if (.not. one) text = text//'s'
            do k = 1, size(links)
               text = text//' '//trim(set%sketch%links(links(k))%name)
               if (k < size(links)) text = text//','
            end do
         end associate
         if (.not. closed .and. size(set%sketch%length) > 0) then
            text = text//trim(merge(' does', ' do  ', one))//' not meet: with the lengths of LENP they cannot be put '// &
                   'together near the drawing'
         else
            text = text//trim(merge(' stands', ' stand ', one))//' at a dead point in the drawing, where two assemblies '// &
                   'meet; draw the linkage in another position'
         end if
      end function failure
   end subroutine assemble_sketch

   !> Slides where assembling has put them: the point that the second link carries, the direction that the first one has. What moved
   !> by rounding only stays to the bit.
   subroutine move_slides(closure, state, slides)
      type(closure_t), intent(in) :: closure
      type(state_t), intent(in) :: state
      type(slide_t), intent(inout) :: slides(:)
      real(wp), parameter :: still = 1.0e-12_wp !! of the drawing's size, and of a radian
      complex(wp) :: z
      real(wp) :: c, s
      integer :: k

      do k = 1, size(slides)
         associate (of => slides(k))
            call unit_vector(state%phi(of%links(2), 0)*degrees_per_radian, c, s)
            z = state%t(of%links(2), 0) + cmplx(c, s, wp)*closure%slide_point(2, k)
            if (abs(z - cmplx(of%x, of%y, wp)) > still*closure%size) then
               of%x = z%re
               of%y = z%im
            end if
            if (abs(state%phi(of%links(1), 0)) > still) of%angle = of%angle + state%phi(of%links(1), 0)*degrees_per_radian
         end associate
      end do
   end subroutine move_slides
end module psalm_sketch_assembly
