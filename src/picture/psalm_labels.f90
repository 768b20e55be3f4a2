!> Where the letters of the joints go: beside their joint, off links, springs and centres of mass, off each other.
module psalm_labels
   use psalm_angles, only: unit_vector
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   use psalm_output_kind, only: motion_angle
   use psalm_scene, only: scene_t
   implicit none (type, external)
   private
   public :: place_labels

   integer, parameter :: ways = 12                  !! directions that are tried, and as many between them where these are crowded
   real(wp), parameter :: crowded = 8.0_wp          !! the best of them is worse
   integer, parameter :: rounds = 2                 !! distances that are tried
   integer, parameter :: most_dots = 400            !! traces of more points are not looked at
   real(wp), parameter :: too_crowded = 45.0_wp     !! a letter that would lie on others is left out
   real(wp), parameter :: away = 18.0_wp            !! distance of a letter from its joint, pixels
   real(wp), parameter :: farther = 9.0_wp          !! more in the second round, which costs
   real(wp), parameter :: cost_of_round = 8.0_wp
   real(wp), parameter :: room_symbol = 5.0_wp      !! more for the symbol of a prismatic joint
   real(wp), parameter :: room_bar = 13.0_wp, room_joint = 22.0_wp, room_letter = 20.0_wp, room_dot = 10.0_wp !! wanted, pixels
   real(wp), parameter :: room_mass = 16.0_wp       !! from a centre of mass, pixels

contains

   !> Middles of the letters at the reference position, pixels, y downwards; far negative where there is none.
   pure subroutine place_labels(scene, k, ox, oy, at)
      type(scene_t), intent(in) :: scene
      real(wp), intent(in) :: k, ox, oy      !! pixels per unit of length; place of the view's low corner
      real(wp), intent(out) :: at(:, :)      !! shape (2, joints)
      real(wp) :: x(size(scene%joints)), y(size(scene%joints)), try(2), c, s, reach, score, best
      logical :: shown(size(scene%joints)), has_forces
      integer :: j, w, round, between

      has_forces = allocated(scene%forces)
      if (has_forces) has_forces = scene%forces%prescribed%table%known(scene%reference)
      at = -huge(1.0_wp)
      shown = scene%prescribed%known(:, scene%reference)
      x = ox + k*(scene%prescribed%x(:, scene%reference) - scene%low(1))
      y = oy - k*(scene%prescribed%y(:, scene%reference) - scene%low(2))
      do j = 1, size(scene%joints)
         if (.not. shown(j) .or. len(scene%joints(j)%name) == 0) cycle
         best = huge(best)
         do between = 0, 1
            if (best <= crowded) exit
            do w = 0, rounds*ways - 1
               round = w/ways
               call unit_vector((real(w, wp) + 0.5_wp*real(between, wp))*(360.0_wp/real(ways, wp)) + 60.0_wp, c, s)
               reach = away + merge(room_symbol, 0.0_wp, scene%joints(j)%slides) + farther*real(round, wp)
               try = [x(j) + reach*c, y(j) - reach*s]
               ! a frame joint has its triangle below
               score = merge(30.0_wp, 0.0_wp, scene%joints(j)%fixed .and. scene%joints(j)%turning .and. s < -0.7_wp)
               score = score + crowd(j, try) + cost_of_round*real(round, wp)
               if (score < best) then
                  best = score
                  at(:, j) = try
               end if
            end do
         end do
         if (best > too_crowded) at(:, j) = -huge(1.0_wp)
      end do

   contains

      pure real(wp) function crowd(j, p)
         integer, intent(in) :: j
         real(wp), intent(in) :: p(2)
         integer :: b, m, i

         crowd = 0.0_wp
         do b = 1, size(scene%bars)
            associate (bar => scene%bars(b))
               if (.not. (shown(bar%start) .and. shown(bar%finish)) .or. bar%start == bar%finish) cycle
               crowd = crowd + 2.0_wp*max(0.0_wp, room_bar - &
                                           to_segment(p, x(bar%start), y(bar%start), x(bar%finish), y(bar%finish)))
            end associate
         end do
         crowd = crowd + 2.0_wp*max(0.0_wp, room_bar - to_lines(p))
         do m = 1, size(scene%joints)
            if (shown(m) .and. m /= j) crowd = crowd + 2.0_wp*max(0.0_wp, room_joint - hypotenuse(p(1) - x(m), p(2) - y(m)))
            if (at(1, m) > -huge(1.0_wp) .and. m /= j) &
               crowd = crowd + 3.0_wp*max(0.0_wp, room_letter + more_room(j) - hypotenuse(p(1) - at(1, m), p(2) - at(2, m)))
            if (scene%joints(m)%fixed .or. scene%prescribed%n > most_dots) cycle
            do i = 1, scene%prescribed%n
               if (.not. scene%prescribed%known(m, i)) cycle
               crowd = crowd + 0.3_wp*max(0.0_wp, room_dot - hypotenuse(p(1) - ox - k*(scene%prescribed%x(m, i) - scene%low(1)), &
                                                                  p(2) - oy + k*(scene%prescribed%y(m, i) - scene%low(2))))
            end do
         end do
         if (.not. has_forces) return
         do m = 1, size(scene%forces%prescribed%centre, 3)
            associate (centre => scene%forces%prescribed%centre(:, scene%reference, m))
               crowd = crowd + 2.0_wp*max(0.0_wp, room_mass - to_piece(p, centre, centre))
            end associate
         end do
      end function crowd

      !> Distance from the nearest direction of the output, pair that does not meet, or spring, pixels.
      pure real(wp) function to_lines(p) result(least)
         real(wp), intent(in) :: p(2)
         integer :: i, loop

         least = huge(least)
         if (has_forces) then
            do i = 1, size(scene%forces%torsional)
               associate (ends => scene%forces%prescribed%spring_at(:, scene%reference, :, i))
                  least = min(least, to_piece(p, ends(:, 1), ends(:, 2)))
               end associate
            end do
         end if
         associate (row => scene%prescribed)
            if (scene%motion == motion_angle .and. row%n <= most_dots) then
               do i = 1, row%n
                  if (.not. row%closed(i)) cycle
                  associate (base => [row%x(scene%output_base, i), row%y(scene%output_base, i)])
                     least = min(least, to_piece(p, base, row%actual_mark(:, i)))
                     if (scene%desired) least = min(least, to_piece(p, base, row%desired_mark(:, i)))
                  end associate
               end do
            end if
            do loop = 1, scene%loops
               if (.not. row%broken(loop, scene%reference)) cycle
               associate (pair => scene%pairs(loop), i => scene%reference)
                  least = min(least, to_piece(p, [row%x(pair%start, i), row%y(pair%start, i)], row%tip(1:2, loop, i)), &
                              to_piece(p, [row%x(pair%finish, i), row%y(pair%finish, i)], row%tip(3:4, loop, i)))
               end associate
            end do
         end associate
      end function to_lines

      !> Distance of a point of the drawing from a piece of a line in machine axes, pixels.
      pure real(wp) function to_piece(p, from, to)
         real(wp), intent(in) :: p(2), from(2), to(2)

         to_piece = to_segment(p, ox + k*(from(1) - scene%low(1)), oy - k*(from(2) - scene%low(2)), &
                               ox + k*(to(1) - scene%low(1)), oy - k*(to(2) - scene%low(2)))
      end function to_piece

      !> Names of several letters are wider.
      pure real(wp) function more_room(j)
         integer, intent(in) :: j

         more_room = 5.0_wp*real(len(scene%joints(j)%name) - 1, wp)
      end function more_room
   end subroutine place_labels

   !> Distance of a point from a piece of a line.
   pure real(wp) function to_segment(p, x1, y1, x2, y2)
      real(wp), intent(in) :: p(2), x1, y1, x2, y2
      real(wp) :: t, d

      d = (x2 - x1)**2 + (y2 - y1)**2
      t = 0.0_wp
      if (d > 0.0_wp) t = min(1.0_wp, max(0.0_wp, ((p(1) - x1)*(x2 - x1) + (p(2) - y1)*(y2 - y1))/d))
      to_segment = hypotenuse(p(1) - x1 - t*(x2 - x1), p(2) - y1 - t*(y2 - y1))
   end function to_segment
end module psalm_labels
