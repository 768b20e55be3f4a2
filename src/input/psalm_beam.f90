!> A link as a uniform beam: what the groups VIBR and ESTIM say of it.
module psalm_beam
   use psalm_kinds, only: wp
   use psalm_place, only: place_t
   implicit none (type, external)
   private
   public :: beam_t

   !> A uniform link between two pins.
   type :: beam_t
      type(place_t) :: link                    !! one of its arcs, the one between the pins; of a sketch its name
      real(wp) :: modulus = 0.0_wp             !! Young's, Pa
      real(wp) :: density = 0.0_wp             !! kg/m3
      real(wp) :: area = 0.0_wp                !! m2
      real(wp) :: gyration = 0.0_wp            !! radius of gyration of the section, m
      real(wp) :: depth = 0.0_wp               !! of the section in the plane of motion, m; 0: not known
      real(wp) :: damping = 0.0_wp             !! part of the critical one, of every mode
      real(wp) :: shear_ratio = 0.0_wp         !! E/(kappa G); 0: a slender beam
      real(wp) :: strain = 0.0_wp              !! limit of the material; 0: not known
   end type beam_t
end module psalm_beam
