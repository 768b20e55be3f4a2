!> Which of the groups that device 7 keeps as they are mean the same beside the loops of a sketch.
module psalm_kept_groups
   use psalm_data_set, only: data_set_t
   use psalm_sketch, only: frame_link, drive_stretches
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: groups_for_loops

   integer, parameter :: name_length = 31
   !> Items that name joints, links, slides or outputs of a sketch, besides those whose names end in NAME or JNT.
   character(name_length), parameter :: other_names(*) = [character(name_length) :: 'FREE', 'FOTHER', 'TOLNAM', 'ALNAM', 'ALOUT']

contains

   !> The groups that keep their meaning, as they are; `left_out` lists those that name parts of the sketch, `plates` is true if
   !> plates are left out although they name none: their shapes depend on points that loops do not have, or their masses on the unit
   !> of length in a group that is left out.
   subroutine groups_for_loops(set, kept, left_out, plates)
      type(data_set_t), intent(in) :: set
      character(:), allocatable, intent(out) :: kept, left_out
      logical, intent(out) :: plates
      type(text_t) :: text
      character(:), allocatable :: group, name, shapes
      integer :: at, next, first

      left_out = ''
      shapes = ''
      plates = .false.
      at = 1
      do while (at <= len(set%others))
         next = index(set%others(at:), '&END')
         if (next == 0) exit
         next = at + next + len('&END') - 1
         if (next <= len(set%others)) then
            if (set%others(next:next) == new_line('a')) next = next + 1
         end if
         group = set%others(at:next - 1)
         first = index(group, '&') + 1
         name = group(first:first + scan(group(first:)//' ', ' '//new_line('a')) - 2)
         if (names_parts(group)) then
            if (len(left_out) > 0) left_out = left_out//', '
            left_out = left_out//'&'//name
         else if (name == 'PLATES') then
            shapes = group
         else
            call text%add_text(group)
         end if
         at = next
      end do
      if (len(shapes) > 0) then
         plates = index(left_out, '&MASSES') > 0 .or. .not. has_plain_links(set)
         if (.not. plates) call text%add_text(shapes)
      end if
      kept = text%content()
   end subroutine groups_for_loops

   !> True if an item of a group, each of which begins a line, names parts of a sketch.
   pure logical function names_parts(group)
      character(*), intent(in) :: group
      integer :: at, length, equals
      character(:), allocatable :: item

      names_parts = .false.
      at = 1
      do while (at <= len(group))
         length = scan(group(at:)//new_line('a'), new_line('a')) - 1
         associate (line => group(at:at + length - 1))
            equals = index(line, '=')
            if (equals > 1) then
               item = trim(adjustl(line(:equals - 1)))
               if (len(item) > 0 .and. verify(item, 'ABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789') == 0) &
                  names_parts = names_parts .or. ends_in(item, 'NAME') .or. ends_in(item, 'JNT') .or. any(other_names == item)
            end if
         end associate
         at = at + length + 1
      end do
   end function names_parts

   pure logical function ends_in(item, ending)
      character(*), intent(in) :: item, ending

      ends_in = .false.
      if (len(item) >= len(ending)) ends_in = item(len(item) - len(ending) + 1:) == ending
   end function ends_in

   !> True if all joints of the links that move are joints of other links, too, and nothing slides, stretches or meshes: then the
   !> ends of arcs on a link are its joints.
   pure logical function has_plain_links(set)
      type(data_set_t), intent(in) :: set
      integer :: k, j

      associate (sketch => set%sketch)
         has_plain_links = size(sketch%slides) == 0 .and. size(sketch%gears) == 0 .and. all(sketch%drives%kind /= drive_stretches)
         do k = 1, size(sketch%links)
            if (k == frame_link) cycle
            do j = 1, size(sketch%links(k)%joints)
               has_plain_links = has_plain_links .and. size(sketch%links_of(sketch%links(k)%joints(j))) > 1
            end do
         end do
      end associate
   end function has_plain_links
end module psalm_kept_groups
