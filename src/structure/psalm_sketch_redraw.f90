!> A sketch drawn anew from the dimensions of its loops: the joints of a linkage that a search has found, at its reference input.
!>
!> The loops are traced as they were chosen; each dyad is put together by plane geometry with the sign that the drawing gave it.
module psalm_sketch_redraw
   use psalm_angles, only: degrees_of, unit_vector
   use psalm_closure, only: closure_t, state_t
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp, right_angle
   use psalm_mechanism, only: mechanism_t
   use psalm_sketch, only: sketch_t
   use psalm_sketch_case, only: assemble_sketch
   use psalm_sketch_loops, only: make_loops
   use psalm_status, only: diagnostics_t
   use psalm_traced_loops, only: loops_t, traced_actuator, traced_crank, traced_frame, traced_link, traced_slide
   implicit none (type, external)
   private
   public :: redraw_sketch

contains

   !> Put the joints and slides of the case's sketch where the dimensions have them; the drawing is then the reference. `drawn` is
   !> false if a dyad does not close; the sketch is then left as it was.
   subroutine redraw_sketch(set, mechanism, dimensions, sketch, drawn)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(sketch_t), intent(inout) :: sketch   !! the one of the case
      logical, intent(out) :: drawn
      type(closure_t) :: closure
      type(state_t) :: state
      type(loops_t) :: loops
      type(diagnostics_t) :: unused
      complex(wp), allocatable :: z(:)          !! by point
      logical, allocatable :: placed(:)
      real(wp), allocatable :: direction(:), length(:) !! by arc
      integer :: k, loop, first, last, p

      call assemble_sketch(set, closure, state, drawn, unused)
      if (drawn) call make_loops(closure, state, loops)
      drawn = drawn .and. loops%found
      if (.not. drawn) return
      allocate (z(size(loops%point)), source=(0.0_wp, 0.0_wp))
      allocate (placed(size(loops%point)), source=.false.)
      allocate (direction(size(loops%arcs)), length(size(loops%arcs)), source=0.0_wp)
      z(loops%start) = dimensions%origlk*unit(dimensions%origng)
      placed(loops%start) = .true.
      do loop = 1, loops%loops
         first = findloc(loops%arcs%loop, loop, dim=1)
         last = findloc(loops%arcs%loop, loop, dim=1, back=.true.)
         p = first - 1
         do k = first, last
            if (loops%arcs(k)%kind == traced_link .or. loops%arcs(k)%kind == traced_slide) exit
            p = k
         end do
         p = p + 1
         if (loop == 1) call know(last)
         do k = first, last
            if (k /= p .and. k /= p + 1) call know(k)
         end do
         do k = first, p - 1
            call go(k, 1)
         end do
         do k = last, p + 2, -1
            call go(k, -1)
         end do
         call close_dyad(p, drawn)
         if (.not. drawn) return
      end do
      call put_output()
      call put_others()
      sketch%x = z(:size(sketch%x))%re
      sketch%y = z(:size(sketch%y))%im
      call put_slides()
      ! the lengths are in the coordinates now, and the drawing is the reference
      deallocate (sketch%length_of, sketch%length, sketch%variations)
      allocate (sketch%length_of(2, 0), sketch%length(0), sketch%variations(0))

   contains

      complex(wp) function unit(angle)
         real(wp), intent(in) :: angle
         real(wp) :: c, s

         call unit_vector(angle, c, s)
         unit = cmplx(c, s, wp)
      end function unit

      !> Direction and length of an arc that no dyad finds.
      subroutine know(k)
         integer, intent(in) :: k
         integer :: n

         associate (arc => loops%arcs(k))
            n = mechanism%seq(arc%loop, arc%place)
            length(k) = dimensions%arcl(n)
            select case (arc%kind)
            case (traced_crank)
               direction(k) = dimensions%crnki
            case (traced_actuator)
               direction(k) = direction(last) + real(arc%sign, wp)*right_angle
               length(k) = dimensions%crnki
            case (traced_frame)
               direction(k) = dimensions%gama(n)
            case default
               direction(k) = direction(arc%reference)
               if (arc%same) then
                  length(k) = length(arc%reference)
               else
                  direction(k) = direction(k) + dimensions%gama(n)
               end if
            end select
         end associate
      end subroutine know

      !> From one end of an arc to the other.
      subroutine go(k, sense)
         integer, intent(in) :: k, sense

         associate (ends => loops%arcs(k)%ends)
            if (sense > 0) then
               z(ends(2)) = z(ends(1)) + length(k)*unit(direction(k))
            else
               z(ends(1)) = z(ends(2)) - length(k)*unit(direction(k))
            end if
            placed(ends) = .true.
         end associate
      end subroutine go

      !> The joint of the two unknown arcs.
      subroutine close_dyad(p, closes)
         integer, intent(in) :: p
         logical, intent(out) :: closes
         complex(wp) :: h, along, i
         real(wp) :: root, t
         integer :: q

         q = p + 1
         associate (s => z(loops%arcs(p)%ends(1)), e => z(loops%arcs(q)%ends(2)), a => loops%arcs(p), b => loops%arcs(q))
            h = e - s
            length(p) = dimensions%arcl(mechanism%seq(a%loop, a%place))
            length(q) = dimensions%arcl(mechanism%seq(b%loop, b%place))
            if (a%kind == traced_link .and. b%kind == traced_link) then
               t = (length(p)**2 - length(q)**2 + abs(h)**2)/(2.0_wp*abs(h))
               root = length(p)**2 - t**2
               closes = root >= 0.0_wp
               if (.not. closes) return
               i = s + h/abs(h)*cmplx(t, -real(a%sign, wp)*sqrt(root), wp)
            else if (b%kind == traced_link .and. a%guide == b%place) then
               root = abs(h)**2 - length(q)**2
               closes = root >= 0.0_wp
               if (.not. closes) return
               i = s + sqrt(root)*h/abs(h)**2*cmplx(sqrt(root), -real(a%sign, wp)*length(q), wp)
            else if (a%kind == traced_link) then
               along = unit(direction(guide_of(q)) - real(b%sign, wp)*right_angle)
               call on_line(e, along, s, length(p), a%sign, i, closes)
            else if (b%kind == traced_link) then
               along = unit(direction(guide_of(p)) + real(a%sign, wp)*right_angle)
               call on_line(s, along, e, length(q), b%sign, i, closes)
            else
               along = unit(direction(guide_of(p)) + real(a%sign, wp)*right_angle)
               direction(q) = direction(guide_of(q)) - real(b%sign, wp)*right_angle
               root = aimag(conjg(unit(direction(q)))*along)
               closes = abs(root) > epsilon(1.0_wp)
               if (.not. closes) return
               i = s + along*(aimag(conjg(unit(direction(q)))*h)/root)
            end if
            if (.not. closes) return
            z(a%ends(2)) = i
            placed([a%ends, b%ends]) = .true.
            call settle(p)
            call settle(q)
         end associate
      end subroutine close_dyad

      !> The guide of a slide of this loop, which stands in it.
      integer function guide_of(k)
         integer, intent(in) :: k

         guide_of = k - loops%arcs(k)%place + loops%arcs(k)%guide
      end function guide_of

      !> The place on a line at a distance from a point, ahead of its foot (+1) or behind it.
      subroutine on_line(from, along, point, distance, sign, place, closes)
         complex(wp), intent(in) :: from, along, point
         real(wp), intent(in) :: distance
         integer, intent(in) :: sign
         complex(wp), intent(out) :: place
         logical, intent(out) :: closes
         complex(wp) :: d

         d = conjg(along)*(point - from)
         closes = distance**2 >= d%im**2
         place = from
         if (closes) place = from + along*(d%re + real(sign, wp)*sqrt(distance**2 - d%im**2))
      end subroutine on_line

      !> Direction and length of an arc of the dyad; a slide's are along its line, which may be against its ends.
      subroutine settle(k)
         integer, intent(in) :: k
         complex(wp) :: h

         associate (arc => loops%arcs(k))
            h = z(arc%ends(2)) - z(arc%ends(1))
            if (arc%kind == traced_link) then
               if (length(k) > 0.0_wp) direction(k) = degrees_of(h%re, h%im)
               if (length(k) <= 0.0_wp) direction(k) = direction(k - 1) + real(arc%sign, wp)*right_angle
               return
            end if
            if (arc%guide < arc%place) then
               direction(k) = direction(guide_of(k)) + real(arc%sign, wp)*right_angle
            else if (loops%arcs(guide_of(k))%kind == traced_link) then
               direction(k) = degrees_of(h%re, h%im)
            else
               direction(k) = direction(guide_of(k)) - real(arc%sign, wp)*right_angle
            end if
            length(k) = real(conjg(unit(direction(k)))*h, wp)
         end associate
      end subroutine settle

      !> The output point, if it is no joint of the loops.
      subroutine put_output()
         integer :: a, joint

         if (size(sketch%outputs) == 0 .or. dimensions%outlk <= 0.0_wp) return
         joint = sketch%outputs(1)%joints(1)
         if (placed(joint)) return
         do a = 1, size(loops%arcs)
            if (loops%arcs(a)%loop /= set%links%noutlp .or. loops%arcs(a)%place /= abs(set%links%noutlk)) cycle
            z(joint) = z(loops%arcs(a)%ends(merge(1, 2, set%links%noutlk < 0))) + dimensions%outlk*unit(direction(a) + &
                                                            dimensions%outang)
            placed(joint) = .true.
         end do
      end subroutine put_output

      !> Further points of links go with the first arc of their link.
      subroutine put_others()
         integer :: j, axis
         integer, allocatable :: links(:)

         do j = 1, size(sketch%joint_name)
            if (placed(j)) cycle
            links = sketch%links_of(j)
            axis = loops%axis(links(1))
            associate (from => loops%arcs(axis)%ends(1))
               z(j) = z(from) + (loops%point(j) - loops%point(from))*unit(direction(axis) - loops%arcs(axis)%direction)
            end associate
         end do
      end subroutine put_others

      subroutine put_slides()
         integer :: a

         do a = 1, size(loops%arcs)
            associate (arc => loops%arcs(a))
               if (arc%slide == 0) cycle
               associate (slide => sketch%slides(arc%slide), at => merge(arc%ends(1), arc%ends(2), arc%guide > arc%place))
                  slide%x = z(at)%re
                  slide%y = z(at)%im
                  slide%angle = slide%angle + direction(a) - arc%direction
               end associate
            end associate
         end do
      end subroutine put_slides
   end subroutine redraw_sketch
end module psalm_sketch_redraw
