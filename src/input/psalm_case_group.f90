!> A group of a case that one study reads: what the reading of a case knows of it, whatever the group is.
!>
!> The type of each such group extends `case_group_t`; the case keeps it as a section, by the group's name, and does not know
!> which groups there are.
module psalm_case_group
   use psalm_group, only: group_t
   use psalm_origin, only: name_length
   use psalm_place, only: place_t
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: case_group_t, section_t, surroundings_t, place_visitor_t

   !> What a group may ask about the rest of its case.
   type :: surroundings_t
      integer, allocatable :: ilink(:, :)    !! ILINK, shape (maxarc, nloop)
      type(sketch_t) :: sketch               !! its names stand in place of arcs and loops
      integer :: positions = 0               !! prescribed ones, or those of a turn
      logical :: searched = .false.          !! dimensions may vary
   end type surroundings_t

   !> What is done with each place that a group names.
   type, abstract :: place_visitor_t
   contains
      procedure(visit_place), deferred :: place  !! of a point on a link
      procedure(visit_place), deferred :: joint  !! of a joint
      procedure(visit_place), deferred :: line   !! of a link, by two of its joints
   end type place_visitor_t

   type, abstract :: case_group_t
      logical :: given = .false.             !! the group was given
   contains
      procedure(read_group), deferred :: read
      procedure :: visit_places => visit_none
   end type case_group_t

   !> A group of a case by its name.
   type :: section_t
      character(name_length) :: name = ''
      class(case_group_t), allocatable :: group
   end type section_t

   abstract interface
      subroutine visit_place(self, place)
         import :: place_t, place_visitor_t
         implicit none (type, external)
         class(place_visitor_t), intent(in) :: self
         type(place_t), intent(inout) :: place
      end subroutine visit_place

      !> Read the items. A group that is not given is read too, so that the names of its items are known.
      subroutine read_group(self, group, about, findings)
         import :: case_group_t, diagnostics_t, group_t, surroundings_t
         implicit none (type, external)
         class(case_group_t), intent(inout) :: self
         type(group_t), intent(inout) :: group
         class(surroundings_t), intent(in) :: about
         type(diagnostics_t), intent(inout) :: findings
      end subroutine read_group
   end interface

contains

   !> Of a group that names no places.
   subroutine visit_none(self, visitor)
      class(case_group_t), intent(inout) :: self
      class(place_visitor_t), intent(in) :: visitor

      associate (unused => self%given, nor_this => visitor)
      end associate
   end subroutine visit_none
end module psalm_case_group
