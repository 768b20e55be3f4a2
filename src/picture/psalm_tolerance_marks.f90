!> Where a drawing has the tolerances that were allotted: lengths between two joints, angles at one.
module psalm_tolerance_marks
   use psalm_allocation_scene, only: tolerance_words
   use psalm_kinds, only: wp
   use psalm_scene, only: scene_t
   implicit none (type, external)
   private
   public :: tolerance_mark_t, list_marks, layer_of_tolerances

   character(*), parameter :: layer_of_tolerances = 'TOLERANCES'
   character(*), parameter :: plus_minus = '%%p', degree = '%%d' !! as DXF has them in texts
   character(*), parameter :: of_play = 'play '    !! begins the name of a clearance
   integer, parameter :: most_joints = 4           !! in the name of a dimension

   type :: tolerance_mark_t
      integer :: joints(2) = 0                     !! of the scene: ends of a length; of an angle its vertex; 0: no place
      logical :: angle = .false.
      integer :: body = 0                          !! of the scene, 0: none
      character(:), allocatable :: words           !! what stands there
      character(:), allocatable :: name            !! of the dimension
   end type tolerance_mark_t

contains

   !> Every dimension with a tolerance of a scene that has some.
   pure subroutine list_marks(scene, marks)
      type(scene_t), intent(in) :: scene
      type(tolerance_mark_t), allocatable, intent(out) :: marks(:)
      integer :: joints(most_joints), i, b, n

      allocate (marks(size(scene%allotted%rows)))
      do i = 1, size(marks)
         associate (row => scene%allotted%rows(i), mark => marks(i))
            mark%angle = row%angle
            mark%words = tolerance_words(row, plus_minus, degree)
            mark%name = trim(row%name)
            if (index(mark%name, of_play) == 1) then
               ! at the joint, if its name is one of the drawing
               call find_joints(scene, mark%name(:len(of_play) - 1 + index(mark%name(len(of_play) + 1:)//' ', ' ')), joints, n)
               if (n == 0) cycle
               mark%words = of_play//mark%words
               mark%joints = joints(1)
               mark%angle = .true.
               do b = 1, size(scene%bodies)
                  if (.not. holds(scene%bodies(b)%joints, joints(:1))) cycle
                  mark%body = b
                  exit
               end do
               cycle
            end if
            call find_joints(scene, mark%name, joints, n)
            if (n >= 2) then
               mark%joints = joints(merge([n - 1, n], [1, 2], row%angle))
               do b = 1, size(scene%bodies)
                  if (.not. holds(scene%bodies(b)%joints, joints(:n))) cycle
                  mark%body = b
                  exit
               end do
               cycle
            end if
            if (row%arc == 0) cycle
            do b = 1, size(scene%bars)
               if (scene%bars(b)%loop /= row%loop .or. scene%bars(b)%arc /= row%arc) cycle
               mark%joints = [scene%bars(b)%start, scene%bars(b)%finish]
               mark%body = scene%bars(b)%body
            end do
         end associate
      end do
   end subroutine list_marks

   !> The joints that a name like `angle B C B P` consists of; none if one of its words is no joint.
   pure subroutine find_joints(scene, name, joints, n)
      type(scene_t), intent(in) :: scene
      character(*), intent(in) :: name
      integer, intent(out) :: joints(:), n
      integer :: at, last, j

      joints = 0
      n = 0
      at = index(name, ' ') + 1
      do while (at > 1 .and. at <= len(name))
         last = at + index(name(at:)//' ', ' ') - 2
         if (n == size(joints)) exit
         do j = 1, size(scene%joints)
            if (scene%joints(j)%name == name(at:last)) exit
         end do
         if (j > size(scene%joints)) then
            n = 0
            return
         end if
         n = n + 1
         joints(n) = j
         at = last + 2
      end do
   end subroutine find_joints

   !> True if a list has all members of another.
   pure logical function holds(list, members)
      integer, intent(in) :: list(:), members(:)
      integer :: k

      holds = all([(any(list == members(k)), k=1, size(members))])
   end function holds
end module psalm_tolerance_marks
