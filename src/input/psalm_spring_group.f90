!> The group SPRING: springs and dampers between two points of two links, and torsional ones between two links.
module psalm_spring_group
   use psalm_group, only: group_t, check_range
   use psalm_kinds, only: wp
   use psalm_link_place, only: place_t, read_places, read_count, refuse_unless
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: spring_group_t, read_spring_group

   type :: spring_group_t
      logical :: given = .false.                  !! the group was given
      type(place_t), allocatable :: first(:), second(:) !! shape (entries): where the ends are held
      logical, allocatable :: torsional(:)        !! shape (entries)
      real(wp), allocatable :: stiffness(:)       !! shape (entries): N/m, N m/rad
      real(wp), allocatable :: free(:)            !! shape (entries): free length, user's length; torsional: angle from the first
                                                  !! arc to the second, degrees, at which it is free
      real(wp), allocatable :: preload(:)         !! shape (entries): N or N m at the free length or angle, positive: pulls
      real(wp), allocatable :: damping(:)         !! shape (entries): N s/m, N m s/rad
      integer :: added = 0                        !! SADDED: so many of the last entries were found by muscle
   end type spring_group_t

contains

   !> Read the group. Errors: arcs that are not there, negative lengths and damping.
   subroutine read_spring_group(group, ilink, sketch, springs, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: ilink(:, :)          !! ILINK, shape (maxarc, nloop)
      type(sketch_t), intent(in) :: sketch        !! its names stand in place of arcs and loops
      type(spring_group_t), intent(inout) :: springs
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable :: kind(:)
      integer :: n

      springs%given = group%line > 0
      call read_count(group, 'NSPRNG', n, findings)
      allocate (springs%first(n), springs%second(n))
      allocate (kind(n), source=0)
      allocate (springs%stiffness(n), springs%free(n), springs%preload(n), springs%damping(n), source=0.0_wp)
      call read_places(group, 'A', ilink, springs%first, findings, sketch=sketch)
      call read_places(group, 'B', ilink, springs%second, findings, sketch=sketch)
      call group%get_integers('STORS', kind, findings)
      call group%get_reals('STIFF', springs%stiffness, findings)
      call group%get_reals('SFREE', springs%free, findings)
      call group%get_reals('SPRE', springs%preload, findings)
      call group%get_reals('SDAMP', springs%damping, findings)
      call refuse_unless(kind == 0 .or. kind == 1, group, 'STORS', '0 (along its length) or 1 (torsional) is expected', findings)
      springs%torsional = kind == 1
      call refuse_unless(springs%free >= 0.0_wp .or. springs%torsional, group, 'SFREE', 'a free length is not negative', findings)
      call group%get_integer('SADDED', springs%added, findings)
      call check_range(group, 'SADDED', springs%added, 0, n, findings)
      call refuse_unless(springs%damping >= 0.0_wp, group, 'SDAMP', 'damping is not negative', findings)
   end subroutine read_spring_group
end module psalm_spring_group
