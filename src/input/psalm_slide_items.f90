!> Slides of &CHAIN: NSLIDE, SNAME, the two links SLNK and SLNK2, the line SLX, SLY, SLANG.
module psalm_slide_items
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_sketch, only: sketch_t, sketch_name
   use psalm_sketch_names, only: take_name, link_named
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: read_slides

contains

   !> Read them. Errors: links that are not there, numbers that are missing, links that a joint or a slide ties already.
   subroutine read_slides(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: names(:), first(:), second(:)
      character(sketch_name), allocatable :: taken(:)
      real(wp), allocatable :: x(:), y(:), angle(:)
      integer :: n, i, j, last(3)

      n = 0
      call take(group, 'NSLIDE', n, findings)
      call group%get_texts('SNAME', names, findings)
      call group%get_texts('SLNK', first, findings)
      call group%get_texts('SLNK2', second, findings)
      if (.not. group%given('NSLIDE')) n = size(first)
      n = max(0, min(n, 1000))
      allocate (x(n), y(n), angle(n), source=0.0_wp)
      call take(group, 'SLX', x, findings, last=last(1))
      call take(group, 'SLY', y, findings, last=last(2))
      call take(group, 'SLANG', angle, findings, last=last(3))
      allocate (sketch%slides(n))
      if (n == 0) then
         if (size(first) > 0) call out_of(group, 'SLNK', 'names links of slides, but NSLIDE=0 says that there are none', findings)
         return
      end if
      if (size(first) /= n) call out_of(group, 'SLNK', 'names the first link of '//to_text(size(first))//' slides; there are '// &
                                        to_text(n), findings)
      if (size(second) /= n) call out_of(group, 'SLNK2', 'names the second link of '//to_text(size(second))// &
                                         ' slides; there are '//to_text(n), findings)
      do i = 1, 3
         if (last(i) < n) call out_of(group, merge('SLX  ', merge('SLY  ', 'SLANG', i == 2), i == 1), 'is given for '// &
                                      to_text(last(i))//' slides; there are '//to_text(n), findings)
      end do
      allocate (taken(0))
      do i = 1, n
         associate (slide => sketch%slides(i))
            slide%x = x(i)
            slide%y = y(i)
            slide%angle = angle(i)
            slide%name = 'S'//to_text(i)
            if (i <= size(names)) call take_name(group, 'SNAME', i, names(i), 'slide', taken, findings, slide%name)
            taken = [character(sketch_name) :: taken, slide%name]
            if (sketch%joint_called(trim(slide%name)) > 0) call out_of(group, merge('SNAME', 'JNT  ', i <= size(names)), &
               'both a joint and a slide are called '//trim(slide%name), findings, i)
            if (i <= size(first)) slide%links(1) = link_named(group, 'SLNK', i, first(i), sketch, findings)
            if (i <= size(second)) slide%links(2) = link_named(group, 'SLNK2', i, second(i), sketch, findings)
            if (any(slide%links == 0)) cycle
            if (slide%links(1) == slide%links(2)) then
               call out_of(group, 'SLNK2', 'slide '//trim(slide%name)//' has link '// &
                           trim(sketch%links(slide%links(1))%name)//' on both sides; name the link that it moves on', findings, i)
               cycle
            end if
            do j = 1, size(sketch%joint_name)
               if (.not. (sketch%has_joint(slide%links(1), j) .and. sketch%has_joint(slide%links(2), j))) cycle
               call out_of(group, 'SLNK2', 'slide '//trim(slide%name)//' is between links '// &
                           trim(sketch%links(slide%links(1))%name)//' and '//trim(sketch%links(slide%links(2))%name)// &
                           ', which joint '//trim(sketch%joint_name(j))//' pins together already; a pin in a slot needs a '// &
                           'block, a link of its own with the pin', findings, i)
            end do
            do j = 1, i - 1
               if (any(sketch%slides(j)%links == slide%links(1)) .and. any(sketch%slides(j)%links == slide%links(2))) &
                  call out_of(group, 'SLNK2', 'slides '//trim(sketch%slides(j)%name)//' and '//trim(slide%name)// &
                              ' join the same two links '//trim(sketch%links(slide%links(1))%name)//' and '// &
                              trim(sketch%links(slide%links(2))%name)//'; one is too many', findings, i)
            end do
         end associate
      end do
   end subroutine read_slides
end module psalm_slide_items
