!> Places of the points of a body in its axes, from one to the other along its arcs.
module psalm_body_points
   use psalm_angles, only: unit_vector
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, at_finish, at_start
   implicit none (type, external)
   private
   public :: locate_point

contains

   !> Place of a point of a body from another one, in the axes of the body's own arc.
   !>
   !> `found` is false where no arcs of the body lead there. Points that are one joint of a sketch, or one point of a slide on its
   !> link, are one place, though loops may not know that.
   pure subroutine locate_point(mechanism, dimensions, body, from, point, at, found)
      class(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      integer, intent(in) :: body, from, point
      real(wp), intent(out) :: at(2)        !! user's length
      logical, intent(out), optional :: found
      real(wp) :: places(2, size(mechanism%points)), vector(2)
      logical :: known(size(mechanism%points)), more
      integer :: k, n

      known = .false.
      known(from) = .true.
      places = 0.0_wp
      more = .true.
      do while (more .and. .not. known(point))
         more = .false.
         do k = 1, size(mechanism%bodies(body)%arcs)
            n = mechanism%bodies(body)%arcs(k)
            if (mechanism%slides(n)) cycle
            associate (start => mechanism%arcs(n)%ends(at_start), finish => mechanism%arcs(n)%ends(at_finish))
               if (known(start) .eqv. known(finish)) cycle
               call unit_vector(mechanism%angle_on_body(n, dimensions), vector(1), vector(2))
               ! an arc that repeats others has their length
               vector = dimensions%arcl(mechanism%angle_owner(n))*vector
               if (known(start)) places(:, finish) = places(:, start) + vector
               if (known(finish)) places(:, start) = places(:, finish) - vector
               known(start) = .true.
               known(finish) = .true.
               more = .true.
            end associate
         end do
         if (.not. more) call join_joints(places, known, more)
      end do
      at = places(:, point)
      if (present(found)) found = known(point)

   contains

      !> Points of arcs of the body that end at one point of its link.
      pure subroutine join_joints(places, known, more)
         real(wp), intent(inout) :: places(:, :)
         logical, intent(inout) :: known(:), more
         integer :: i, j, e, f

         do i = 1, size(mechanism%bodies(body)%arcs)
            do j = 1, size(mechanism%bodies(body)%arcs)
               associate (one => mechanism%arcs(mechanism%bodies(body)%arcs(i)), &
                          other => mechanism%arcs(mechanism%bodies(body)%arcs(j)))
                  do e = at_start, at_finish
                     do f = at_start, at_finish
                        if (one%marks(e) == 0 .or. one%marks(e) /= other%marks(f)) cycle
                        if (one%foot == e .or. other%foot == f) cycle
                        if (.not. known(one%ends(e)) .or. known(other%ends(f))) cycle
                        places(:, other%ends(f)) = places(:, one%ends(e))
                        known(other%ends(f)) = .true.
                        more = .true.
                     end do
                  end do
               end associate
            end do
         end do
      end subroutine join_joints
   end subroutine locate_point
end module psalm_body_points
