!> What an entry of LOADS says whatever the linkage is: all but the place where it acts.
module psalm_force_entries
   use psalm_kinds, only: wp
   use psalm_load_group, only: load_group_t
   implicit none (type, external)
   private
   public :: loading_t, loading_of

   !> A load without its place and force.
   type :: loading_t
      real(wp) :: moment = 0.0_wp           !! N m
      logical :: turns = .false.            !! the force turns with the link
      integer :: table = 0                  !! column of the tables that multiplies it; 0: none
   end type loading_t

contains

   pure type(loading_t) function loading_of(loads, k) result(loading)
      type(load_group_t), intent(in) :: loads
      integer, intent(in) :: k              !! entry

      loading = loading_t(loads%moment(k), loads%turns(k), loads%table(k))
   end function loading_of
end module psalm_force_entries
