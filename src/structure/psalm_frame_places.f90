!> Joints of the frame whose places vary: each must move alone.
!>
!> Arcs of the frame are traced with angles from one another. Where an arc varies from which others are counted, these would turn
!> with it: then every arc of the frame is counted from the machine's x axis.
module psalm_frame_places
   use psalm_kinds, only: wp
   use psalm_sketch, only: sketch_t, frame_link, vary_place, vary_all
   use psalm_traced_loops, only: loops_t, traced_determined, traced_frame, traced_actuator, traced_slide
   implicit none (type, external)
   private
   public :: part_frame_arcs

contains

   !> Count arcs of the frame from the x axis, if any would turn with another. `why` tells what would move with a joint all the
   !> same, or is empty.
   subroutine part_frame_arcs(sketch, loops, why)
      type(sketch_t), intent(in) :: sketch
      type(loops_t), intent(inout) :: loops
      character(:), allocatable, intent(out) :: why
      logical, dimension(size(loops%arcs)) :: own, varies
      logical :: carried, pivot_varies
      integer :: n

      why = ''
      if (any(sketch%variations%kind == vary_all)) return ! what hangs on another arc varies too
      own = loops%arcs%link == frame_link .and. .not. (loops%arcs%same .or. loops%arcs%against)
      varies = own .and. [(is_varied_place(loops%arcs(n)%ends), n=1, size(loops%arcs))]
      pivot_varies = .false.
      do n = 1, size(sketch%variations)
         pivot_varies = pivot_varies .or. (sketch%variations(n)%kind == vary_place .and. &
                                           sketch%variations(n)%joints(1) == loops%start)
      end do
      if (any(varies)) then
         do n = 1, size(loops%arcs)
            if (guide_of(n) == 0) cycle
            if (.not. varies(guide_of(n))) cycle
            why = 'a joint of the frame that varies, with which the line of slide '// &
                  trim(sketch%slides(loops%arcs(n)%slide)%name)//' would turn'
            return
         end do
         carried = .false.
         do n = 1, size(loops%arcs)
            if (.not. own(n) .or. loops%arcs(n)%reference == 0) cycle
            carried = carried .or. varies(loops%arcs(n)%reference)
         end do
         if (carried) then
            where (own .and. loops%arcs%kind == traced_determined)
               loops%arcs%kind = traced_frame
               loops%arcs%reference = 0
            end where
         end if
      end if
      if (.not. pivot_varies .or. .not. loops%are_beyond_arrays()) return
      if (any(own .and. .not. varies .and. loops%arcs%length > 0.0_wp)) &
         why = 'an input pivot that varies alone, with which the frame would move'

   contains

      !> True of an arc between the input pivot and a joint that varies.
      pure logical function is_varied_place(ends)
         integer, intent(in) :: ends(2)
         integer :: k

         is_varied_place = .false.
         if (all(ends /= loops%start)) return
         do k = 1, size(sketch%variations)
            associate (one => sketch%variations(k))
               is_varied_place = is_varied_place .or. (one%kind == vary_place .and. one%joints(1) /= loops%start .and. &
                                                       any(ends == one%joints(1)))
            end associate
         end do
      end function is_varied_place

      !> The arc from which a slide takes its direction; 0: it is no slide.
      pure integer function guide_of(n)
         integer, intent(in) :: n

         guide_of = 0
         associate (arc => loops%arcs(n))
            if (arc%same .or. arc%against .or. all(arc%kind /= [traced_slide, traced_actuator])) return
            guide_of = arc%reference
            if (arc%guide > 0) guide_of = findloc(loops%arcs%loop, arc%loop, dim=1) + arc%guide - 1
         end associate
         do while (guide_of > 0)
            if (.not. (loops%arcs(guide_of)%same .or. loops%arcs(guide_of)%against)) exit
            guide_of = loops%arcs(guide_of)%reference
         end do
      end function guide_of
   end subroutine part_frame_arcs
end module psalm_frame_places
