!> Forces in the joints of a larger group: the equilibrium of all its links at once.
!>
!> A pin passes on a force, a slide a force across it at its foot and a couple: two unknowns a joint. A drive along a slide adds
!> its force, one between two links its couple, wheels in mesh the force at their pitch point: as many unknowns as equations,
!> three a link, in every Assur group. Source: Oldham (1977), 15.1, for groups of any size.
module psalm_group_reactions
   use psalm_kinds, only: wp
   use psalm_linear, only: eliminate_real
   use psalm_rows, only: rows_t
   implicit none (type, external)
   private
   public :: group_joint_t, group_couple_t, react_group, effects_of_couple, find_pitch_point

   real(wp), parameter :: concentric = 64.0_wp*epsilon(1.0_wp) !! part of the size: wheels whose centres are nearer are on one pin

   !> A joint of the group: what the first link does to the second.
   type :: group_joint_t
      logical :: slides = .false.
      integer :: links(2) = 0               !! links of the group, 0: one before it
      integer :: wrenches(2) = 0            !! first rows of the wrenches of links before the group, 0: none, or the frame
      integer :: x = 0, y = 0               !! rows of the point, of a slide of its foot
      integer :: root_x = 0, root_y = 0     !! slides: rows of the unit vector that the direction is turned from,
      real(wp) :: c = 1.0_wp, s = 0.0_wp    !! cosine and sine of the angle from it
      integer :: force = 0                  !! first row of its result
      integer :: drive = 0                  !! row of the force of a drive along it, 0: none
      real(wp) :: sense = 1.0_wp            !! of that force: -1 where a positive one pushes the second link backwards
   end type group_joint_t

   !> Couples on links that come with each other: of a drive between two of them, of wheels in mesh.
   type :: group_couple_t
      integer :: bodies(3) = 0              !! of the mechanism, 0: none, or the frame
      integer :: links(3) = 0, wrenches(3) = 0 !! as of a joint
      real(wp) :: factors(3) = 0.0_wp       !! of the couple on each
      integer :: drive = 0                  !! row of the couple, 0: it is no drive
      integer :: centres(4) = 0             !! wheels: rows of x and y of the first and of the second centre, 0: couples alone
      real(wp) :: ratio = 0.0_wp            !! wheels: turns of the second for one of the first, against the carrier
      integer :: force = 0                  !! wheels: first row of what the first does to the second
      integer :: couple = 0                 !! wheels: row of the couple itself, 0: it is not kept
   end type group_couple_t

contains

   !> Joint forces from the wrenches on the links, and what they pass on to the links before the group. Zero at a dead point.
   pure subroutine react_group(n, joints, couples, wrenches, store, w)
      integer, intent(in) :: n                     !! positions, padded
      type(group_joint_t), intent(in) :: joints(:)
      type(group_couple_t), intent(in) :: couples(:)
      integer, intent(in) :: wrenches(:)           !! first rows of the wrenches on the links: force x and y, moment
      type(rows_t), intent(in) :: store
      type(rows_t), intent(inout) :: w
      integer, parameter :: equations = 3, unknowns = 2
      real(wp) :: matrix(equations*size(wrenches), equations*size(wrenches)), right(equations*size(wrenches), 1)
      real(wp) :: column(equations, unknowns), along(equations), on(equations, 3), size_of, determinant
      integer :: i, j, b, k, row, at

      if (unknowns*size(joints) + count(joints%drive > 0) + size(couples) /= size(matrix, 2)) return
      do i = 1, n
         matrix = 0.0_wp
         ! moments count as forces at the distance of the farthest joint or centre of a wheel
         size_of = 0.0_wp
         do j = 1, size(joints)
            size_of = max(size_of, abs(store%v(i, joints(j)%x)), abs(store%v(i, joints(j)%y)))
         end do
         do j = 1, size(couples)
            if (couples(j)%centres(1) > 0) size_of = max(size_of, maxval(abs(store%v(i, couples(j)%centres))))
         end do
         if (.not. size_of > 0.0_wp) size_of = 1.0_wp    ! one pin, at the origin
         do b = 1, size(wrenches)
            row = equations*(b - 1)
            right(row + 1:row + equations, 1) = -w%v(i, wrenches(b):wrenches(b) + equations - 1)
            right(row + equations, 1) = right(row + equations, 1)/size_of
         end do
         at = 0
         do j = 1, size(joints)
            call effect(joints(j), i, size_of, column, along)
            do k = 1, 2
               if (joints(j)%links(k) == 0) cycle
               row = equations*(joints(j)%links(k) - 1)
               matrix(row + 1:row + equations, at + 1:at + unknowns) = merge(column, -column, k == 2)
               if (joints(j)%drive > 0) matrix(row + 1:row + equations, at + unknowns + 1) = merge(along, -along, k == 2)
            end do
            at = at + unknowns + merge(1, 0, joints(j)%drive > 0)
         end do
         do j = 1, size(couples)
            call effects_of_couple(couples(j), store, i, size_of, on)
            at = at + 1
            do k = 1, size(on, 2)
               if (couples(j)%links(k) == 0) cycle
               row = equations*(couples(j)%links(k) - 1)
               matrix(row + 1:row + equations, at) = matrix(row + 1:row + equations, at) + on(:, k)
            end do
         end do
         call eliminate_real(size(matrix, 1), 1, matrix, right, determinant)
         if (.not. abs(determinant) > 0.0_wp) right = 0.0_wp
         at = 0
         do j = 1, size(joints)
            associate (joint => joints(j))
               call effect(joint, i, size_of, column, along)
               column(:, 1) = column(:, 1)*right(at + 1, 1) + column(:, 2)*right(at + 2, 1)
               if (joint%drive > 0) then
                  column(:, 1) = column(:, 1) + along*right(at + unknowns + 1, 1)
                  w%v(i, joint%drive) = joint%sense*right(at + unknowns + 1, 1)
               end if
               ! a link before the group is loaded by what it does to the group, the other way round
               call pass_on(i, joint%wrenches(2), size_of, column(:, 1), w)
               call pass_on(i, joint%wrenches(1), size_of, -column(:, 1), w)
               w%v(i, joint%force) = right(at + 1, 1)
               w%v(i, joint%force + 1) = right(at + 2, 1)
               if (joint%slides) w%v(i, joint%force + 1) = right(at + 2, 1)*size_of
               at = at + unknowns + merge(1, 0, joint%drive > 0)
            end associate
         end do
         do j = 1, size(couples)
            at = at + 1
            call effects_of_couple(couples(j), store, i, size_of, on)
            on = on*right(at, 1)
            do k = 1, size(on, 2)
               call pass_on(i, couples(j)%wrenches(k), size_of, on(:, k), w)
            end do
            if (couples(j)%drive > 0) w%v(i, couples(j)%drive) = right(at, 1)*size_of
            if (couples(j)%force > 0) w%v(i, couples(j)%force:couples(j)%force + 1) = on(:2, 2)
            if (couples(j)%couple > 0) w%v(i, couples(j)%couple) = right(at, 1)*size_of
         end do
      end do

   contains

      !> Add to the wrench of a link before the group.
      pure subroutine pass_on(position, first, size_of, wrench, w)
         integer, intent(in) :: position, first       !! row, 0: none
         real(wp), intent(in) :: size_of, wrench(:)
         type(rows_t), intent(inout) :: w

         if (first == 0) return
         w%v(position, first:first + 1) = w%v(position, first:first + 1) + wrench(:2)
         w%v(position, first + 2) = w%v(position, first + 2) + wrench(equations)*size_of
      end subroutine pass_on

      !> Force and moment on the second link of a unit of each unknown; moments in parts of the size.
      pure subroutine effect(joint, position, size_of, both, along)
         type(group_joint_t), intent(in) :: joint
         integer, intent(in) :: position
         real(wp), intent(in) :: size_of
         real(wp), intent(out) :: both(:, :)
         real(wp), intent(out) :: along(:)            !! of a force along a slide
         real(wp) :: ux, uy

         associate (x => store%v(position, joint%x)/size_of, y => store%v(position, joint%y)/size_of)
            along = 0.0_wp
            if (joint%slides) then
               ux = joint%c*store%v(position, joint%root_x) - joint%s*store%v(position, joint%root_y)
               uy = joint%c*store%v(position, joint%root_y) + joint%s*store%v(position, joint%root_x)
               both(:, 1) = [-uy, ux, x*ux + y*uy]
               both(:, 2) = [0.0_wp, 0.0_wp, 1.0_wp]
               along = [ux, uy, x*uy - y*ux]
            else
               both(:, 1) = [1.0_wp, 0.0_wp, -y]
               both(:, 2) = [0.0_wp, 1.0_wp, x]
            end if
         end associate
      end subroutine effect
   end subroutine react_group

   !> Force and moment on each link of a unit couple in parts of the size. Wheels push each other at the pitch point, square to
   !> the line of centres; on one centre they pass couples, which the carrier takes up.
   pure subroutine effects_of_couple(couple, store, position, size_of, on)
      type(group_couple_t), intent(in) :: couple
      type(rows_t), intent(in) :: store
      integer, intent(in) :: position
      real(wp), intent(in) :: size_of
      real(wp), intent(out) :: on(:, :)            !! shape (3, 3): force x and y, moment about the origin
      real(wp) :: arm(2), pitch(2), force(2)
      logical :: found

      on = 0.0_wp
      on(3, :) = couple%factors
      call find_pitch_point(couple, store, position, size_of, pitch, arm, found)
      if (.not. found) return
      ! the couple on the second wheel is factors(2)
      force = couple%factors(2)*[-arm(2), arm(1)]/sum(arm**2)
      on(:, 2) = [force, pitch(1)*force(2) - pitch(2)*force(1)]
      on(:, 1) = -on(:, 2)
      on(:, 3) = 0.0_wp
   end subroutine effects_of_couple

   !> Where two wheels touch, and from the second centre to there. `found` is false of wheels on one centre and of other couples.
   pure subroutine find_pitch_point(couple, store, position, size_of, pitch, arm, found)
      type(group_couple_t), intent(in) :: couple
      type(rows_t), intent(in) :: store
      integer, intent(in) :: position
      real(wp), intent(in) :: size_of              !! the places are parts of it
      real(wp), intent(out) :: pitch(:), arm(:)    !! shape (2)
      logical, intent(out) :: found

      pitch = 0.0_wp
      arm = 0.0_wp
      found = .false.
      if (couple%centres(1) == 0 .or. couple%force == 0 .or. abs(1.0_wp - couple%ratio) <= concentric) return
      arm = (store%v(position, couple%centres(:2)) - store%v(position, couple%centres(3:)))/(1.0_wp - couple%ratio)/size_of
      found = maxval(abs(arm)) > concentric
      pitch = store%v(position, couple%centres(3:))/size_of + arm
   end subroutine find_pitch_point
end module psalm_group_reactions
