!> The group LINKS: a linkage by its loops, arc by arc. Source of items and defaults: Oldham (1977), appendix B.
module psalm_links_group
   use psalm_group, only: group_t, out_of, required
   use psalm_kinds, only: wp
   use psalm_rule, only: rule_t, a_number, a_whole
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: link_items
   public :: links_group_t, read_links_group, original_arcs

   integer, parameter :: original_arcs = 100      !! entries of the thesis's arc arrays: fillers up to here are usual
   integer, parameter :: most_loops = 100000      !! above this NLOOP is taken for a slip of the pen
   integer, parameter :: most_arcs = 10000000     !! likewise NLOOP times MAXARC

   !> Loops of arcs. Angles in degrees, lengths in the user's one unit.
   type :: links_group_t
      integer :: nloop = 0, maxarc = 0
      integer, allocatable :: ilink(:, :)  !! shape (maxarc, nloop): arc numbers
      integer, allocatable :: iloop(:, :)  !! shape (maxarc, nloop): loop or guide numbers
      real(wp), allocatable :: arcl(:, :)  !! shape (maxarc, nloop): lengths
      real(wp), allocatable :: gama(:, :)  !! shape (maxarc, nloop): angles
      integer :: noutlk = 0, noutlp = 0
      real(wp) :: outlk = 0.0_wp, outang = 0.0_wp
   end type links_group_t

   !> The items of the group.
   type(rule_t), parameter :: link_items(*) = [ &
      rule_t('NLOOP', a_whole, '', '', 'required', '[1,100000]', &
             'number of loops'), &
      rule_t('MAXARC', a_whole, '', '', 'required', '[3,10000000]', &
             'most arcs in any loop'), &
      rule_t('ILINK', a_whole, 'NLOOP*MAXARC', '', 'required', '', &
             'topology: the arc from which each arc''s angle is counted, and which arcs are common to loops'), &
      rule_t('ILOOP', a_whole, 'NLOOP*MAXARC', '', 'required', '', &
             'topology: the loop of the arc named in ILINK, and guides of slides'), &
      rule_t('ARCL', a_number, 'NLOOP*MAXARC', 'length', '0', '', &
             'lengths of arcs; 0 for slides'), &
      rule_t('GAMA', a_number, 'NLOOP*MAXARC', 'degrees', '0', '', &
             'angle from the direction of the arc named in ILINK to this arc; of the last arc of loop 1: from '// &
             'the machine''s x axis'), &
      rule_t('NOUTLK', a_whole, '', '', 'required', '', &
             'number of the arc that carries the output; negative: output measured from the start of that arc, '// &
             'positive: from its finish'), &
      rule_t('NOUTLP', a_whole, '', '', 'required', '', &
             'loop of that arc'), &
      rule_t('OUTLK', a_number, '', 'length', '0', '[0,)', &
             'length of the output arc', &
             'the length is negative; turn OUTANG by 180 instead'), &
      rule_t('OUTANG', a_number, '', 'degrees', '0', '', &
             'angle of the output arc from the direction of arc NOUTLK')]

contains

   !> Read the group. Errors: arrays that are missing or of another shape than NLOOP and MAXARC say, negative lengths.
   subroutine read_links_group(group, links, shape_known, findings)
      type(group_t), intent(inout) :: group
      type(links_group_t), intent(inout) :: links
      logical, intent(out) :: shape_known     !! NLOOP and MAXARC are valid
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable :: integers(:)
      real(wp), allocatable :: reals(:)
      integer :: n, highest, needed, beyond, row, column
      logical :: rows_known

      call group%follow(link_items)
      call take(group, 'NLOOP', links%nloop, findings)
      call take(group, 'MAXARC', links%maxarc, findings)
      shape_known = links%nloop >= 1 .and. links%nloop <= most_loops .and. links%maxarc >= 3 .and. links%maxarc <= most_arcs
      if (shape_known) shape_known = links%maxarc <= most_arcs/links%nloop
      n = 0
      if (shape_known) then
         n = links%nloop*links%maxarc
      else
         links%nloop = 0
         links%maxarc = 0
      end if
      allocate (integers(max(n, merge(0, original_arcs, shape_known))), source=0)
      allocate (reals(size(integers)), source=0.0_wp)
      call group%get_integers('ILINK', integers, findings, links%maxarc, last=highest, needed=needed, beyond=beyond)
      if (highest == 0) call required(group, 'ILINK')
      ! one row too many or too few is reported once, not for every array
      rows_known = shape_known
      if (shape_known .and. beyond > 0) then
         call too_many_rows('ILINK', needed, beyond)
         rows_known = .false.
      else if (shape_known .and. highest > 0 .and. needed <= n - links%maxarc) then
         call out_of(group, 'NLOOP', 'NLOOP='//to_text(links%nloop)//' loops are declared, but ILINK has values for '// &
                     to_text((needed - 1)/links%maxarc + 1)//' only (rows of MAXARC='//to_text(links%maxarc)//')', findings)
         rows_known = .false.
      end if
      links%ilink = reshape(integers(:n), [links%maxarc, links%nloop])
      integers = 0
      call group%get_integers('ILOOP', integers, findings, links%maxarc, last=highest, needed=needed, beyond=beyond)
      if (highest == 0) call required(group, 'ILOOP')
      if (rows_known .and. beyond > 0) call too_many_rows('ILOOP', needed, beyond)
      links%iloop = reshape(integers(:n), [links%maxarc, links%nloop])
      call group%get_reals('ARCL', reals, findings, links%maxarc, last=highest, needed=needed, beyond=beyond)
      if (rows_known .and. beyond > 0) call too_many_numbers('ARCL', needed, beyond)
      links%arcl = reshape(reals(:n), [links%maxarc, links%nloop])
      reals = 0.0_wp
      call group%get_reals('GAMA', reals, findings, links%maxarc, last=highest, needed=needed, beyond=beyond)
      if (rows_known .and. beyond > 0) call too_many_numbers('GAMA', needed, beyond)
      links%gama = reshape(reals(:n), [links%maxarc, links%nloop])
      do row = 1, links%nloop
         do column = 1, links%maxarc
            if (links%arcl(column, row) < 0.0_wp) then
               call out_of(group, 'ARCL', 'length of arc '//to_text(column)//' in loop '//to_text(row)// &
                           ' is negative; lengths are positive, directions go into GAMA and ILINK', findings, &
                           (row - 1)*links%maxarc + column)
            end if
         end do
      end do
      call take(group, 'NOUTLK', links%noutlk, findings)
      call take(group, 'NOUTLP', links%noutlp, findings)
      call take(group, 'OUTLK', links%outlk, findings)
      call take(group, 'OUTANG', links%outang, findings)

   contains

      subroutine too_many_rows(item, found, line)
         character(*), intent(in) :: item
         integer, intent(in) :: found, line

         call findings%error('too many values: NLOOP='//to_text(links%nloop)//' rows of MAXARC='//to_text(links%maxarc)// &
                             ' are declared, found '//to_text((found - 1)/links%maxarc + 1)//' rows ('//to_text(found)// &
                             ' values); set NLOOP or MAXARC', line=line, group='LINKS', item=item)
      end subroutine too_many_rows

      subroutine too_many_numbers(item, found, line)
         character(*), intent(in) :: item
         integer, intent(in) :: found, line

         call findings%error('too many values: at most '//to_text(n)//' are expected, found '//to_text(found)// &
                             ' (only zeros may follow); the decimal sign is a point, not a comma', line=line, group='LINKS', &
                             item=item)
      end subroutine too_many_numbers
   end subroutine read_links_group
end module psalm_links_group
