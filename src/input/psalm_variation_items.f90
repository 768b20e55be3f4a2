!> What of a sketch a search may change: VARY of &CHAIN, and its bounds VLOW and VHIGH.
module psalm_variation_items
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_sketch, only: sketch_t, variation_t, frame_link, vary_length, vary_angle, vary_place, vary_input, vary_all
   use psalm_sketch_names, only: word_room, find_joints, words_of, common_link, joined
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take
   use psalm_text, only: lower_case, to_text
   implicit none (type, external)
   private
   public :: read_variations

contains

   !> What may vary: 'A B' a length, 'angle A B A C' an angle of a link, 'place D' a joint of the frame, 'input', 'all'.
   subroutine read_variations(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: texts(:)
      character(word_room), allocatable :: words(:)
      character(:), allocatable :: whose
      real(wp), allocatable :: low(:), high(:)
      integer, allocatable :: joints(:)
      integer :: n, i, last_low, last_high, wanted, at
      logical :: valid

      call group%get_texts('VARY', texts, findings)
      n = size(texts)
      allocate (sketch%variations(n))
      allocate (low(2*n), high(2*n), source=0.0_wp)
      call take(group, 'VLOW', low, findings, last=last_low)
      call take(group, 'VHIGH', high, findings, last=last_high)
      at = 0
      do i = 1, n
         whose = "'"//trim(adjustl(texts(i)))//"'"
         words = words_of(texts(i))
         associate (one => sketch%variations(i))
            one%kind = vary_length
            wanted = 2
            if (size(words) == 0) then
               call out_of(group, 'VARY', 'variable '//to_text(i)//' is empty', findings, i)
               cycle
            end if
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
               if (n > 1) call out_of(group, 'VARY', "'all' is every dimension; leave the others out", findings, i)
            case ('length')
               continue
            case default
               words = [character(word_room) :: 'length', words]
            end select
            if (at + width_of(one) <= min(last_low, last_high)) then
               one%bounded = .true.
               one%low(:width_of(one)) = low(at + 1:at + width_of(one))
               one%high(:width_of(one)) = high(at + 1:at + width_of(one))
               if (any(one%low > one%high)) call out_of(group, 'VLOW', &
                  'the lower bound of '//whose//' is above its upper bound', &
                                                        findings, at + 1)
            end if
            at = at + width_of(one)
            call find_joints(group, 'VARY', i, joined(words(2:)), whose, sketch, findings, joints, valid)
            if (.not. valid) cycle
            if (size(joints) /= wanted) then
               call out_of(group, 'VARY', whose//' names '//to_text(size(joints))//' joints, not '//to_text(wanted)// &
                           "; there are 'A B', 'angle A B A C', 'place D', 'input', 'all'", findings, i)
               cycle
            end if
            one%joints(:wanted) = joints
            if (one%kind == vary_place) then
               if (.not. sketch%has_joint(frame_link, joints(1))) call out_of(group, 'VARY', &
                  whose//': the joint is not on the frame', &
                                                                              findings, i)
            else if (wanted > 0) then
               if (common_link(sketch, joints) == 0) call out_of(group, 'VARY', whose//': no link has all these joints', &
                  findings, i)
            end if
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
end module psalm_variation_items
