!> Forces in the joints of a larger group: the equilibrium of all its links at once.
!>
!> A pin passes on a force, a slide a force across it at its foot and a couple: two unknowns a joint, three equations a link, as
!> many as there are unknowns in every Assur group. Source: Oldham (1977), 15.1, for groups of any size.
module psalm_group_reactions
   use psalm_kinds, only: wp
   use psalm_linear, only: eliminate_real
   use psalm_rows, only: rows_t
   implicit none (type, external)
   private
   public :: group_joint_t, react_group

   !> A joint of the group: what the first link does to the second.
   type :: group_joint_t
      logical :: slides = .false.
      integer :: links(2) = 0               !! links of the group, 0: one before it
      integer :: wrenches(2) = 0            !! first rows of the wrenches of links before the group, 0: none, or the frame
      integer :: x = 0, y = 0               !! rows of the point, of a slide of its foot
      integer :: root_x = 0, root_y = 0     !! slides: rows of the unit vector that the direction is turned from,
      real(wp) :: c = 1.0_wp, s = 0.0_wp    !! cosine and sine of the angle from it
      integer :: force = 0                  !! first row of its result
   end type group_joint_t

contains

   !> Joint forces from the wrenches on the links, and what they pass on to the links before the group. Zero at a dead point.
   pure subroutine react_group(n, joints, wrenches, store, w)
      integer, intent(in) :: n                     !! positions, padded
      type(group_joint_t), intent(in) :: joints(:)
      integer, intent(in) :: wrenches(:)           !! first rows of the wrenches on the links: force x and y, moment
      type(rows_t), intent(in) :: store
      type(rows_t), intent(inout) :: w
      integer, parameter :: equations = 3, unknowns = 2
      real(wp) :: matrix(equations*size(wrenches), unknowns*size(joints)), right(equations*size(wrenches), 1)
      real(wp) :: column(equations, unknowns), size_of, determinant, wrench(equations)
      integer :: i, j, b, k, row, at

      do i = 1, n
         matrix = 0.0_wp
         ! moments count as forces at the distance of the farthest joint
         size_of = tiny(1.0_wp)**0.5_wp
         do j = 1, size(joints)
            size_of = max(size_of, abs(store%v(i, joints(j)%x)), abs(store%v(i, joints(j)%y)))
         end do
         do b = 1, size(wrenches)
            row = equations*(b - 1)
            right(row + 1:row + equations, 1) = -w%v(i, wrenches(b):wrenches(b) + equations - 1)
            right(row + equations, 1) = right(row + equations, 1)/size_of
         end do
         do j = 1, size(joints)
            column = effect(joints(j), i, size_of)
            at = unknowns*(j - 1)
            do k = 1, 2
               if (joints(j)%links(k) == 0) cycle
               row = equations*(joints(j)%links(k) - 1)
               matrix(row + 1:row + equations, at + 1:at + unknowns) = merge(column, -column, k == 2)
            end do
         end do
         call eliminate_real(size(matrix, 1), 1, matrix, right, determinant)
         if (.not. abs(determinant) > 0.0_wp) right = 0.0_wp
         do j = 1, size(joints)
            associate (found => right(unknowns*(j - 1) + 1:unknowns*j, 1), joint => joints(j))
               column = effect(joint, i, size_of)
               do k = 1, 2
                  if (joint%wrenches(k) == 0) cycle
                  ! the link before the group is loaded by what it does to the group, the other way round
                  wrench = column(:, 1)*found(1) + column(:, 2)*found(2)
                  wrench(equations) = wrench(equations)*size_of
                  if (k == 1) wrench = -wrench
                  w%v(i, joint%wrenches(k):joint%wrenches(k) + equations - 1) = &
                     w%v(i, joint%wrenches(k):joint%wrenches(k) + equations - 1) + wrench
               end do
               w%v(i, joint%force) = found(1)
               w%v(i, joint%force + 1) = merge(found(2)*size_of, found(2), joint%slides)
            end associate
         end do
      end do

   contains

      !> Force and moment on the second link of a unit of each unknown; moments in parts of the size.
      pure function effect(joint, position, size_of) result(both)
         type(group_joint_t), intent(in) :: joint
         integer, intent(in) :: position
         real(wp), intent(in) :: size_of
         real(wp) :: both(equations, unknowns), ux, uy

         associate (x => store%v(position, joint%x)/size_of, y => store%v(position, joint%y)/size_of)
            if (joint%slides) then
               ux = joint%c*store%v(position, joint%root_x) - joint%s*store%v(position, joint%root_y)
               uy = joint%c*store%v(position, joint%root_y) + joint%s*store%v(position, joint%root_x)
               both(:, 1) = [-uy, ux, x*ux + y*uy]
               both(:, 2) = [0.0_wp, 0.0_wp, 1.0_wp]
            else
               both(:, 1) = [1.0_wp, 0.0_wp, -y]
               both(:, 2) = [0.0_wp, 1.0_wp, x]
            end if
         end associate
      end function effect
   end subroutine react_group
end module psalm_group_reactions
