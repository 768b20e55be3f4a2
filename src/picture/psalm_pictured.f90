!> What is to be drawn of a case.
module psalm_pictured
   use psalm_dxf_group, only: dxf_group_t
   use psalm_markup, only: strings_t
   use psalm_mode_scene, only: mode_scene_t
   use psalm_parts, only: ghost_t
   use psalm_plot, only: plot_t
   use psalm_pole_scene, only: pole_scene_t
   use psalm_scene, only: scene_t
   implicit none (type, external)
   private
   public :: pictured_t, new_pictures

   !> One case as it is to be drawn.
   type :: pictured_t
      type(scene_t) :: scene
      type(scene_t), allocatable :: parts         !! for CAD, where the scene is of loops, which lack joints that they do not need
      type(dxf_group_t) :: dxf                    !! how the drawing for CAD is to be
      type(pole_scene_t), allocatable :: poles    !! in place of a linkage: four poses of &EXACT
      type(plot_t), allocatable :: phase(:)       !! phase planes of a motion in time, one for each free drive
      type(ghost_t), allocatable :: ghosts(:)     !! equilibria, if they were asked for
      type(mode_scene_t), allocatable :: modes(:) !! oscillations about them; those with `equilibrium` 0 are not drawn
      type(strings_t), allocatable :: undrawn(:)  !! first violations at all positions, where not all are drawn
   end type pictured_t

contains

   !> As many cases, empty. It stands by itself because the initial values of a scene pass over the stack, 14 kB of it.
   subroutine new_pictures(n, cases)
      integer, intent(in) :: n
      type(pictured_t), allocatable, intent(out) :: cases(:)  !! shape (n)

      allocate (cases(n))
   end subroutine new_pictures
end module psalm_pictured
