!> Forbidden regions: how far a joint is outside of them. Source of the target: Oldham (1977), section 9.2.3.
module psalm_regions
   use psalm_angles, only: unit_vector
   use psalm_constraint_group, only: constraint_group_t, region_t, range_turn, region_box, region_half_plane, region_circle
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   use psalm_mechanism, only: mechanism_t
   implicit none (type, external)
   private
   public :: find_region_depth, edge_distance, box_edges, check_regions

   integer, parameter :: box_edges = 4     !! left, lower, right, upper

contains

   !> How far a point is beyond one edge of a box, [length].
   pure real(wp) function edge_distance(region, edge, x, y)
      type(region_t), intent(in) :: region
      integer, intent(in) :: edge             !! 1 to 4
      real(wp), intent(in) :: x, y            !! point, machine axes

      select case (edge)
      case (1)
         edge_distance = region%at(1) - x
      case (2)
         edge_distance = region%at(2) - y
      case (3)
         edge_distance = x - region%at(3)
      case default
         edge_distance = y - region%at(4)
      end select
   end function edge_distance

   !> How deep a point is where it must not be (negative: how far it is from there), [length], and its gradient.
   !>
   !> Half-plane: what lies left of its edge. Staying inside of a box is staying on the right side of each of its edges.
   pure subroutine find_region_depth(region, x, y, depth, gx, gy)
      type(region_t), intent(in) :: region
      real(wp), intent(in) :: x, y            !! point, machine axes
      real(wp), intent(out) :: depth, gx, gy
      real(wp) :: outside(box_edges), ux, uy, r
      integer :: i

      gx = 0.0_wp
      gy = 0.0_wp
      select case (region%kind)
      case (region_box)
         outside = [(edge_distance(region, i, x, y), i=1, box_edges)]
         depth = -maxval(outside)
         ux = max(outside(1), outside(3))
         uy = max(outside(2), outside(4))
         if (.not. region%stay_inside .and. ux > 0.0_wp .and. uy > 0.0_wp) then
            ! the corner is nearest
            depth = -hypotenuse(ux, uy)
            gx = merge(-1.0_wp, 1.0_wp, outside(3) > outside(1))*(ux/(-depth))
            gy = merge(-1.0_wp, 1.0_wp, outside(4) > outside(2))*(uy/(-depth))
            return
         end if
         select case (maxloc(outside, dim=1))
         case (1)
            gx = 1.0_wp
         case (2)
            gy = 1.0_wp
         case (3)
            gx = -1.0_wp
         case default
            gy = -1.0_wp
         end select
      case (region_half_plane)
         call unit_vector(region%at(3), ux, uy)
         depth = ux*(y - region%at(2)) - uy*(x - region%at(1))
         gx = -uy
         gy = ux
      case (region_circle)
         ux = x - region%at(1)
         uy = y - region%at(2)
         r = hypotenuse(ux, uy)
         depth = region%at(3) - r
         if (r > 0.0_wp) then
            gx = -ux/r
            gy = -uy/r
         end if
      case default
         depth = 0.0_wp
      end select
      if (.not. region%stay_inside) return
      depth = -depth
      gx = -gx
      gy = -gy
   end subroutine find_region_depth

   !> Errors of the group that only the topology shows: joints of regions and links that are not there, a full turn of an input
   !> that slides.
   subroutine check_regions(constr, mechanism, findings)
      type(constraint_group_t), intent(in) :: constr
      type(mechanism_t), intent(in) :: mechanism
      type(diagnostics_t), intent(inout) :: findings
      integer :: r, k

      if (constr%irange == range_turn .and. mechanism%sliding_input) then
         call findings%error('IRANGE=2 needs a turning input; use IRANGE=1', group='CONSTR', item='IRANGE')
      end if
      do r = 1, size(constr%regions)
         associate (region => constr%regions(r))
            if (region%loop < 1) cycle
            if (region%arc > mechanism%loops(region%loop)%arcs) then
               call findings%error('region '//to_text(r)//': loop '//to_text(region%loop)//' has '// &
                                   to_text(mechanism%loops(region%loop)%arcs)//' arcs only', group='CONSTR', item='RLINK')
            end if
         end associate
      end do
      do r = 1, size(constr%segments)
         associate (segment => constr%segments(r))
            do k = 1, 2
               if (segment%loops(k) < 1) cycle
               if (segment%arcs(k) > mechanism%loops(segment%loops(k))%arcs) then
                  call findings%error('segment '//to_text(r)//': loop '//to_text(segment%loops(k))//' has '// &
                                      to_text(mechanism%loops(segment%loops(k))%arcs)//' arcs only', group='CONSTR', item='SLINK')
               end if
            end do
         end associate
      end do
   end subroutine check_regions
end module psalm_regions
