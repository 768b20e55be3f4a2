!> The loops of a case as the arrays of &LINKS and &METHOD tell them, for listings and for device 7: those that were read, or
!> those of a sketch's loops.
!>
!> Arrays cannot tell every loop of a sketch (`loops_t%are_beyond_arrays`): such are for the eye only.
module psalm_loop_arrays
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_traced_loops, only: loops_t, traced_actuator, traced_crank, traced_frame, traced_link, traced_slide
   implicit none (type, external)
   private
   public :: loop_arrays_t, arrays_of

   !> Items of &LINKS and &METHOD. Angles in degrees.
   type :: loop_arrays_t
      integer :: nloop = 0, maxarc = 0
      integer, allocatable :: ilink(:, :), iloop(:, :)  !! shape (maxarc, nloop)
      real(wp), allocatable :: arcl(:, :), gama(:, :)   !! shape (maxarc, nloop)
      integer :: noutlk = 0, noutlp = 0
      real(wp) :: outlk = 0.0_wp, outang = 0.0_wp
      real(wp) :: origlk = 0.0_wp, origng = 0.0_wp, crnki = 0.0_wp
      integer, allocatable :: iva(:, :), ivg(:, :)      !! shape (maxarc, nloop), or empty
      integer :: ilkout = 0, ingout = 0, iorig = 0, icrk = 0
   end type loop_arrays_t

contains

   !> The arrays of a case.
   pure type(loop_arrays_t) function arrays_of(set) result(arrays)
      type(data_set_t), intent(in) :: set

      if (allocated(set%traced)) then
         call tell(set%traced, arrays)
         arrays%crnki = set%method%crnki + set%traced%input
         return
      end if
      associate (links => set%links, method => set%method)
         arrays = loop_arrays_t(links%nloop, links%maxarc, links%ilink, links%iloop, links%arcl, links%gama, links%noutlk, &
                                links%noutlp, links%outlk, links%outang, method%origlk, method%origng, method%crnki, &
                                method%iva, method%ivg, method%ilkout, method%ingout, method%iorig, method%icrk)
      end associate
   end function arrays_of

   pure subroutine tell(traced, arrays)
      type(loops_t), intent(in) :: traced
      type(loop_arrays_t), intent(inout) :: arrays
      integer :: k

      arrays%nloop = traced%loops
      arrays%maxarc = traced%longest
      allocate (arrays%ilink(traced%longest, traced%loops), arrays%iloop(traced%longest, traced%loops), source=0)
      allocate (arrays%arcl(traced%longest, traced%loops), arrays%gama(traced%longest, traced%loops), source=0.0_wp)
      allocate (arrays%iva(traced%longest, traced%loops), arrays%ivg(traced%longest, traced%loops), source=0)
      do k = 1, size(traced%arcs)
         associate (arc => traced%arcs(k), a => traced%arcs(k)%place, n => traced%arcs(k)%loop)
            arrays%arcl(a, n) = arc%arcl
            arrays%gama(a, n) = arc%gama
            arrays%iva(a, n) = merge(1, 0, arc%length_varies)
            arrays%ivg(a, n) = merge(1, 0, arc%angle_varies)
            select case (arc%kind)
            case (traced_crank)
               arrays%ilink(a, n) = 1
               arrays%iloop(a, n) = 1
            case (traced_frame)
               arrays%ilink(a, n) = a
               arrays%iloop(a, n) = 1
            case (traced_link)
               arrays%ilink(a, n) = arc%sign*a
            case (traced_slide, traced_actuator)
               arrays%ilink(a, n) = arc%sign*a
               arrays%iloop(a, n) = -arc%guide
            case default
               arrays%ilink(a, n) = merge(1, -1, arc%same)*traced%arcs(arc%reference)%place
               arrays%iloop(a, n) = traced%arcs(arc%reference)%loop
            end select
         end associate
      end do
      if (traced%output_arc > 0) then
         arrays%noutlp = traced%arcs(traced%output_arc)%loop
         arrays%noutlk = merge(-1, 1, traced%from_start)*traced%arcs(traced%output_arc)%place
      end if
      arrays%outlk = traced%outlk
      arrays%outang = traced%outang
      arrays%origlk = traced%origlk
      arrays%origng = traced%origng
      arrays%ilkout = merge(1, 0, traced%outlk_varies)
      arrays%ingout = merge(1, 0, traced%outang_varies)
      arrays%iorig = merge(1, 0, traced%pivot_varies)
      arrays%icrk = merge(1, 0, traced%input_varies)
   end subroutine tell
end module psalm_loop_arrays
