!> Findings about the loop arrays: which arc of which loop they speak of, and the line it was written on.
module psalm_loop_messages
   use psalm_data_set, only: data_set_t
   use psalm_mechanism, only: mechanism_t
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: complain, arc_warning, place_of

contains

   !> An error of an arc (0: of the whole loop) in an item of the group LINKS.
   subroutine complain(set, item, loop, a, text, findings)
      type(data_set_t), intent(in) :: set
      character(*), intent(in) :: item, text
      integer, intent(in) :: loop, a
      type(diagnostics_t), intent(inout) :: findings

      call set%origins%error(findings, 'LINKS', item, subject(loop, a)//text, max(a, 1), loop, set%links%maxarc)
   end subroutine complain

   !> A warning of an arc in an item of LINKS or METHOD.
   subroutine arc_warning(set, item, loop, a, text, findings)
      type(data_set_t), intent(in) :: set
      character(*), intent(in) :: item, text
      integer, intent(in) :: loop, a
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: group

      group = 'LINKS'
      if (item == 'IVA' .or. item == 'IVG') group = 'METHOD'
      call set%origins%warning(findings, group, item, subject(loop, a)//text, a, loop, set%links%maxarc)
   end subroutine arc_warning

   pure function subject(loop, a) result(text)
      integer, intent(in) :: loop, a
      character(:), allocatable :: text

      if (a == 0) then
         text = 'loop '//to_text(loop)//' '
      else
         text = 'arc '//to_text(a)//' of loop '//to_text(loop)//' '
      end if
   end function subject

   !> An arc in words, as it stands in a message after 'arc'.
   pure function place_of(mechanism, n) result(text)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: n
      character(:), allocatable :: text

      text = to_text(mechanism%arcs(n)%place)//' of loop '//to_text(mechanism%arcs(n)%loop)
   end function place_of
end module psalm_loop_messages
