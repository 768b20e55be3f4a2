!> The laws of motion that a segment of a cam may have, and the zones of those with trigonometric acceleration.
!>
!> Zones t1 to t7 of a trigonometric law: quarter sine up, constant, quarter cosine down, constant velocity, and the same three
!> with the other sign. Source: Oldham (1977), 9.3.2; Norton, Cam Design and Manufacturing Handbook.
module psalm_cam_kind
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: law_names, law_kind, has_zones, zones_of, zone_count
   public :: law_dwell, law_ramp, law_cycloidal, law_harmonic, law_parabolic, law_modtrap, law_modsine, law_mcv50, law_poly345, &
             law_poly4567, law_trig, law_poly

   integer, parameter :: zone_count = 7
   integer, parameter :: law_dwell = 1, law_ramp = 2, law_cycloidal = 3, law_harmonic = 4, law_parabolic = 5, law_modtrap = 6, &
                         law_modsine = 7, law_mcv50 = 8, law_poly345 = 9, law_poly4567 = 10, law_trig = 11, law_poly = 12
   character(*), parameter :: law_names(12) = [character(10) :: 'DWELL', 'RAMP', 'CYCLOIDAL', 'HARMONIC', 'PARABOLIC', &
                                               'MODTRAP', 'MODSINE', 'MCV50', 'POLY345', 'POLY4567', 'TRIG', 'POLY']

contains

   !> Number of a law by its name; 0 if there is none of that name.
   pure integer function law_kind(name)
      character(*), intent(in) :: name  !! in capitals

      law_kind = findloc(law_names == name, .true., dim=1)
   end function law_kind

   !> True for laws of seven zones.
   elemental logical function has_zones(law)
      integer, intent(in) :: law

      has_zones = (law >= law_cycloidal .and. law <= law_mcv50) .or. law == law_trig
   end function has_zones

   !> Widths of the zones of a law, in parts of its segment; the modified trapezoid where the user gives his own.
   pure function zones_of(law) result(zones)
      integer, intent(in) :: law
      real(wp) :: zones(zone_count)

      select case (law)
      case (law_cycloidal)
         zones = [2.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 2.0_wp, 0.0_wp, 2.0_wp]/8.0_wp
      case (law_harmonic)
         zones = [0.0_wp, 0.0_wp, 4.0_wp, 0.0_wp, 4.0_wp, 0.0_wp, 0.0_wp]/8.0_wp
      case (law_parabolic)
         zones = [0.0_wp, 4.0_wp, 0.0_wp, 0.0_wp, 0.0_wp, 4.0_wp, 0.0_wp]/8.0_wp
      case (law_modsine)
         zones = [1.0_wp, 0.0_wp, 3.0_wp, 0.0_wp, 3.0_wp, 0.0_wp, 1.0_wp]/8.0_wp
      case (law_mcv50)
         zones = [1.0_wp, 0.0_wp, 3.0_wp, 8.0_wp, 3.0_wp, 0.0_wp, 1.0_wp]/16.0_wp
      case default
         zones = [1.0_wp, 2.0_wp, 1.0_wp, 0.0_wp, 1.0_wp, 2.0_wp, 1.0_wp]/8.0_wp
      end select
   end function zones_of
end module psalm_cam_kind
