!> Gear pairs of &CHAIN: the wheels GEARA and GEARB, their carrier GCARR, the teeth GTA and GTB.
module psalm_gear_items
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_sketch, only: sketch_t
   use psalm_sketch_names, only: link_named
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: read_gears

contains

   !> Gears whose centres a carrier holds: GEARA, GEARB, the carrier GCARR, the teeth GTA, GTB (GTB negative: an internal pair).
   subroutine read_gears(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: first(:), second(:), carrier(:)
      real(wp), allocatable :: teeth_a(:), teeth_b(:)
      integer :: n, i

      call group%get_texts('GEARA', first, findings)
      call group%get_texts('GEARB', second, findings)
      call group%get_texts('GCARR', carrier, findings)
      n = size(first)
      allocate (teeth_a(n), teeth_b(n), source=0.0_wp)
      call take(group, 'GTA', teeth_a, findings)
      call take(group, 'GTB', teeth_b, findings)
      allocate (sketch%gears(n))
      if (size(second) /= n) call out_of(group, 'GEARB', 'names the second wheel of '//to_text(size(second))//' gear pairs; '// &
                                         'GEARA names '//to_text(n), findings)
      if (size(carrier) /= n) call out_of(group, 'GCARR', 'names the carrier of '//to_text(size(carrier))//' gear pairs; '// &
                                          'GEARA names '//to_text(n), findings)
      do i = 1, min(n, size(second), size(carrier))
         associate (gear => sketch%gears(i))
            gear%wheels(1) = link_named(group, 'GEARA', i, first(i), sketch, findings)
            gear%wheels(2) = link_named(group, 'GEARB', i, second(i), sketch, findings)
            gear%carrier = link_named(group, 'GCARR', i, carrier(i), sketch, findings)
            if (teeth_a(i) == 0.0_wp .or. teeth_b(i) == 0.0_wp) then
               call out_of(group, 'GTA', &
                  'gear pair '//to_text(i)//' needs the teeth of both wheels, GTA and GTB; of an internal '// &
                           'pair one is negative', findings, i)
               cycle
            end if
            gear%ratio = -teeth_a(i)/teeth_b(i)
            gear%teeth = [teeth_a(i), teeth_b(i)]
            if (any(gear%wheels == 0) .or. gear%carrier == 0) cycle
            if (gear%wheels(1) == gear%wheels(2) .or. any(gear%wheels == gear%carrier)) then
               call out_of(group, 'GEARB', 'a gear pair has three different links: two wheels and the carrier of both', &
                  findings, i)
               cycle
            end if
            call check_wheel(1)
            call check_wheel(2)
         end associate
      end do

   contains

      subroutine check_wheel(which)
         integer, intent(in) :: which
         integer :: j

         associate (gear => sketch%gears(i))
            do j = 1, size(sketch%joint_name)
               if (sketch%has_joint(gear%wheels(which), j) .and. sketch%has_joint(gear%carrier, j)) return
            end do
            call out_of(group, 'GCARR', 'link '//trim(sketch%links(gear%carrier)%name)//' carries wheel '// &
                        trim(sketch%links(gear%wheels(which))%name)//', but no joint pins them together', findings, i)
         end associate
      end subroutine check_wheel
   end subroutine read_gears
end module psalm_gear_items
