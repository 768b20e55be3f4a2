!> What an entry of LOADS or SPRING says whatever the linkage is: all but the places where it acts.
module psalm_force_entries
   use psalm_kinds, only: wp
   use psalm_load_group, only: load_group_t
   use psalm_spring_group, only: spring_group_t
   implicit none (type, external)
   private
   public :: loading_t, spring_law_t, loading_of, spring_law_of

   !> A load without its place and force.
   type :: loading_t
      real(wp) :: moment = 0.0_wp           !! N m
      logical :: turns = .false.            !! the force turns with the link
      integer :: table = 0                  !! column of the tables that multiplies it; 0: none
   end type loading_t

   !> A spring or damper without its ends.
   type :: spring_law_t
      logical :: torsional = .false.
      real(wp) :: stiffness = 0.0_wp        !! N/m, N m/rad
      real(wp) :: free = 0.0_wp             !! free length, user's length; angle, degrees
      real(wp) :: preload = 0.0_wp          !! N, N m
      real(wp) :: damping = 0.0_wp          !! N s/m, N m s/rad
   end type spring_law_t

contains

   pure type(loading_t) function loading_of(loads, k) result(loading)
      type(load_group_t), intent(in) :: loads
      integer, intent(in) :: k              !! entry

      loading = loading_t(loads%moment(k), loads%turns(k), loads%table(k))
   end function loading_of

   pure type(spring_law_t) function spring_law_of(springs, k) result(law)
      type(spring_group_t), intent(in) :: springs
      integer, intent(in) :: k              !! entry

      law = spring_law_t(springs%torsional(k), springs%stiffness(k), springs%free(k), springs%preload(k), springs%damping(k))
   end function spring_law_of
end module psalm_force_entries
