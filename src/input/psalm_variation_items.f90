!> What of a sketch a search may change: VARY of &CHAIN, and its bounds VLOW and VHIGH.
module psalm_variation_items
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_sketch, only: sketch_t, variation_t, frame_link, vary_length, vary_angle, vary_place, vary_input, vary_all
   use psalm_sketch_names, only: word_length, find_joints, words_of, common_link, joined
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_text, only: lower_case, to_text
   implicit none (type, external)
   private
   public :: read_variations, read_dimension

contains

   !> What may vary: 'A B' a length, 'angle A B A C' an angle of a link, 'place D' a joint of the frame, 'input', 'all'.
   subroutine read_variations(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: texts(:)
      character(:), allocatable :: whose
      real(wp), allocatable :: low(:), high(:)
      integer :: n, i, last_low, last_high, at

      call group%get_texts('VARY', texts, findings)
      n = size(texts)
      allocate (sketch%variations(n))
      allocate (low(2*n), high(2*n), source=0.0_wp)
      call take(group, 'VLOW', low, findings, last=last_low)
      call take(group, 'VHIGH', high, findings, last=last_high)
      at = 0
      do i = 1, n
         whose = "'"//trim(adjustl(texts(i)))//"'"
         associate (one => sketch%variations(i))
            call read_dimension(group, 'VARY', i, texts(i), sketch, findings, one)
            if (one%kind == 0) cycle
            if (one%kind == vary_all .and. n > 1) &
               call out_of(group, 'VARY', "'all' is every dimension; leave the others out", findings, i)
            if (at + width_of(one) <= min(last_low, last_high)) then
               one%bounded = .true.
               one%low(:width_of(one)) = low(at + 1:at + width_of(one))
               one%high(:width_of(one)) = high(at + 1:at + width_of(one))
               if (any(one%low > one%high)) call out_of(group, 'VLOW', &
                  'the lower bound of '//whose//' is above its upper bound', &
                                                        findings, at + 1)
            end if
            at = at + width_of(one)
         end associate
      end do
      if (last_low /= last_high .or. (last_low > 0 .and. last_low /= at)) then
         call out_of(group, merge('VLOW ', 'VHIGH', last_low /= at), &
            'bounds are given for all variables or for none: '//to_text(at)// &
                     ' values each (a place has two, x and y); found '//to_text(last_low)//' and '//to_text(last_high), findings)
      end if

   contains

      pure integer function width_of(one)
         type(variation_t), intent(in) :: one

         width_of = merge(2, 1, one%kind == vary_place)
      end function width_of
   end subroutine read_variations

   !> A dimension by its joints: 'A B' a length, 'angle A B A C' an angle of a link, 'place D' a joint of the frame, 'input', 'all'.
   !> Errors: no such joints, not as many as it takes, no link that has them all, a place that is not on the frame.
   subroutine read_dimension(group, item, which, text, sketch, findings, one)
      type(group_t), intent(inout) :: group
      character(*), intent(in) :: item      !! the item,
      integer, intent(in) :: which          !! and which value of it
      character(*), intent(in) :: text      !! the value
      type(sketch_t), intent(in) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      type(variation_t), intent(inout) :: one !! kind 0: it is empty
      character(word_length), allocatable :: words(:)
      character(:), allocatable :: whose, offered
      integer, allocatable :: joints(:)
      integer :: wanted
      logical :: valid

      whose = "'"//trim(adjustl(text))//"'"
      words = words_of(text)
      one%kind = 0
      if (size(words) == 0) then
         call out_of(group, item, 'value '//to_text(which)//' is empty', findings, which)
         return
      end if
      one%kind = vary_length
      wanted = 2
      select case (lower_case(trim(words(1))))
      case ('angle')
         one%kind = vary_angle
         wanted = 4
      case ('place')
         one%kind = vary_place
         wanted = 1
      case ('input')
         one%kind = vary_input
         wanted = 0
      case ('all')
         one%kind = vary_all
         wanted = 0
      case ('length')
         continue
      case default
         words = [character(word_length) :: 'length', words]
      end select
      call find_joints(group, item, which, joined(words(2:)), whose, sketch, findings, joints, valid)
      if (.not. valid) return
      if (size(joints) /= wanted) then
         offered = "'A B' and 'angle A B A C'"
         if (item == 'VARY') offered = "'A B', 'angle A B A C', 'place D', 'input', 'all'"
         call out_of(group, item, whose//' names '//to_text(size(joints))//' joint'//trim(merge(' ', 's', size(joints) == 1))// &
                     ', not '//to_text(wanted)//'; there are '//offered, findings, which)
         return
      end if
      one%joints(:wanted) = joints
      if (one%kind == vary_place) then
         if (.not. sketch%has_joint(frame_link, joints(1))) call out_of(group, item, whose//': the joint is not on the frame', &
                                                                        findings, which)
      else if (wanted > 0) then
         if (common_link(sketch, joints) == 0) call out_of(group, item, whose//': no link has all these joints', findings, which)
      end if
   end subroutine read_dimension
end module psalm_variation_items
