!> The group &OUTPUTS of a sketch: what is wanted of it.
module psalm_outputs_group
   use psalm_group, only: group_t, out_of, required
   use psalm_rule, only: rule_t, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t, sketch_output_t, position_of, sketch_name, output_point, output_angle, output_distance, &
                           output_slide, output_between, output_pose, output_ratio, output_x, output_y, columns_of
   use psalm_sketch_names, only: word_length, take_name, find_joints, meant, link_names, words_of, joined
   use psalm_status, only: diagnostics_t
   use psalm_text, only: lower_case, to_text
   implicit none (type, external)
   private
   public :: output_items
   public :: read_outputs_group

   !> The items of the group.
   type(rule_t), parameter :: output_items(*) = [ &
      rule_t('OUTPUT', a_text, 'n', '', 'required', '', &
             'what is wanted: ''point P'', ''angle rocker'' ..., see the table of kinds'), &
      rule_t('ONAME', a_text, 'n', '', 'the words, joined by _', '', &
             'names of the outputs, for tables and ''ratio'''), &
      rule_t('DES#', a_number, 'NDES', '', '', '', &
             'what output 1, 2 ... is to be at each of the NDES positions (of the first either here or in '// &
             '&METHOD, not both); a point has x and y of the first position, then those of the second ...'), &
      rule_t('DVEL#', a_number, 'NDES', '', '', '', &
             'what the first derivative of output 1, 2 ... by the first drive is to be, per radian or per '// &
             'length; angles in radians'), &
      rule_t('DACC#', a_number, 'NDES', '', '', '', &
             'what its second derivative is to be'), &
      rule_t('WGT#', a_number, '1 or NDES', '', '1', '', &
             'weights of the squares of DES: one, or one for each position'), &
      rule_t('WVEL#', a_number, '1 or NDES', '', '1', '', &
             'weights of those of DVEL'), &
      rule_t('WACC#', a_number, '1 or NDES', '', '1', '', &
             'weights of those of DACC'), &
      rule_t('EQUAL', a_text, 'n', '', '', '', &
             'which outputs are to be equal: ''left right'' at every position, ''left 1 left 9'' one of them at two'), &
      rule_t('EQORD', a_whole, 'as EQUAL', '', '0', '[0,2]', &
             'of what: 0 values, 1 first, 2 second derivatives by the first drive'), &
      rule_t('EQMULT', a_number, 'as EQUAL', '', '1', '', &
             'the first is to be so many times the second'), &
      rule_t('EQADD', a_number, 'as EQUAL', '', '0', '', &
             'plus this'), &
      rule_t('EQWGT', a_number, '1 or as EQUAL', '', '1', '(0,)', &
             'weights of the squares of their differences')]

contains

   !> Read &OUTPUTS: 'point P', 'x P', 'angle rocker', 'angle A B', 'distance E F', 'slide S1', 'between A B C D', 'pose P rocker',
   !> 'ratio shock wheel' (of the rates of two outputs by their names).
   subroutine read_outputs_group(group, sketch, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: texts(:), names(:)
      character(word_length), allocatable :: words(:)
      character(sketch_name), allocatable :: taken(:)
      integer :: n, i

      call group%follow(output_items)
      call group%get_texts('OUTPUT', texts, findings)
      call group%get_texts('ONAME', names, findings)
      n = size(texts)
      if (group%line > 0 .and. n == 0) call required(group, 'OUTPUT', "says what is wanted: OUTPUT='point P','angle rocker'")
      if (allocated(sketch%outputs)) deallocate (sketch%outputs)
      allocate (sketch%outputs(n), taken(0))
      do i = 1, n
         words = words_of(texts(i))
         if (i <= size(names)) then
            call take_name(group, 'ONAME', i, names(i), 'output', taken, findings, sketch%outputs(i)%name)
         else
            sketch%outputs(i)%name = default_name()
            if (position_of(sketch%outputs(i)%name, taken) > 0) call out_of(group, 'OUTPUT', &
               "output '"//trim(texts(i))//"' is given twice", &
                                                                  findings, i)
         end if
         taken = [character(sketch_name) :: taken, sketch%outputs(i)%name]
         if (size(words) == 0) then
            call out_of(group, 'OUTPUT', 'output '//to_text(i)//' is empty', findings, i)
            cycle
         end if
         call understand(sketch%outputs(i))
         if (columns_of(sketch%outputs(i)) == 1 .or. sketch%joint_called(trim(sketch%outputs(i)%name)) == 0) cycle
         call out_of(group, 'ONAME', "output '"//trim(sketch%outputs(i)%name)//"' would have the columns of the joint of that "// &
                     'name; give it another', findings, i)
      end do

   contains

      pure function default_name() result(name)
         character(sketch_name) :: name
         integer :: k

         name = ''
         if (size(words) > 0) name = trim(words(1))
         do k = 2, size(words)
            name = trim(name)//'_'//trim(words(k))
         end do
      end function default_name

      subroutine understand(output)
         type(sketch_output_t), intent(inout) :: output
         integer :: k

         select case (lower_case(trim(words(1))))
         case ('point')
            output%kind = output_point
            call joints_of(output, 2, size(words), 1, 0)
         case ('x')
            output%kind = output_x
            call joints_of(output, 2, size(words), 1, 0)
         case ('y')
            output%kind = output_y
            call joints_of(output, 2, size(words), 1, 0)
         case ('angle')
            output%kind = output_angle
            call line_of(output, 2, size(words), 0)
         case ('distance')
            output%kind = output_distance
            if (size(words) == 2) then
               call joints_of(output, 2, 2, 1, 0)
            else
               call joints_of(output, 2, size(words), 2, 0)
            end if
         case ('slide')
            output%kind = output_slide
            if (size(words) /= 2) then
               call wrong("'slide S1' names one slide")
               return
            end if
            output%slide = sketch%slide_called(trim(words(2)))
            if (output%slide == 0) call wrong("no slide is called '"//trim(words(2))//"'"//meant(trim(words(2)), &
               sketch%slides%name))
         case ('between')
            output%kind = output_between
            if (size(words) == 3) then
               call line_of(output, 2, 2, 0)
               call line_of(output, 3, 3, 2)
            else
               call joints_of(output, 2, size(words), 4, 0)
            end if
         case ('pose')
            output%kind = output_pose
            if (size(words) < 3) then
               call wrong("'pose P rocker' names a joint and a link")
               return
            end if
            call joints_of(output, 2, 2, 1, 0)
            call line_of(output, 3, size(words), 1)
         case ('ratio')
            output%kind = output_ratio
            if (size(words) /= 3) then
               call wrong("'ratio wheel shock' names two outputs given before")
               return
            end if
            do k = 1, 2
               output%outputs(k) = position_of(trim(words(k + 1)), taken(:i - 1))
               if (output%outputs(k) == 0) then
                  call wrong("no output given before is called '"//trim(words(k + 1))//"'"//meant(trim(words(k + 1)), &
                     taken(:i - 1)))
               else if (any(sketch%outputs(output%outputs(k))%kind == [output_point, output_pose, output_ratio])) then
                  call wrong("output '"//trim(words(k + 1))//"' is not one number whose rate has a ratio")
               end if
            end do
         case default
            call wrong("'"//trim(words(1))//"' is no output; there are point, x, y, angle, distance, "// &
                       'slide, between, pose, ratio'// &
                       suggestion())
         end select
      end subroutine understand

      function suggestion() result(text)
         character(:), allocatable :: text

         text = ''
         if (sketch%joint_called(trim(words(1))) > 0 .and. size(words) == 1) text = ": 'point "//trim(words(1))//"'"
         if (sketch%link_called(trim(words(1))) > 0 .and. size(words) == 1) text = ": 'angle "//trim(words(1))//"'"
      end function suggestion

      subroutine wrong(text)
         character(*), intent(in) :: text

         call out_of(group, 'OUTPUT', text, findings, i)
      end subroutine wrong

      subroutine joints_of(output, from, to, wanted, after)
         type(sketch_output_t), intent(inout) :: output
         integer, intent(in) :: from, to, wanted, after
         integer, allocatable :: joints(:)
         logical :: valid

         call find_joints(group, 'OUTPUT', i, joined(words(from:to)), "'"//trim(texts(i))//"'", sketch, findings, joints, valid)
         if (.not. valid) return
         if (size(joints) /= wanted) then
            call wrong("'"//trim(texts(i))//"' names "//to_text(size(joints))//' joints; '//to_text(wanted)//' are needed')
            return
         end if
         output%joints(after + 1:after + wanted) = joints
      end subroutine joints_of

      !> A line: that of a link's first two joints, or that from a joint to another.
      subroutine line_of(output, from, to, after)
         type(sketch_output_t), intent(inout) :: output
         integer, intent(in) :: from, to, after
         integer :: link

         link = 0
         if (to == from) link = sketch%link_called(trim(words(from)))
         if (link > 0) then
            if (size(sketch%links(link)%joints) < 2) then
               call wrong('link '//trim(words(from))//" has fewer than two joints and so no direction; name another, or "// &
                          "a line 'A B'")
               return
            end if
            output%link = link
            output%joints(after + 1:after + 2) = sketch%links(link)%joints(:2)
         else if (to == from) then
            call wrong("no link is called '"//trim(words(from))//"'"//meant(trim(words(from)), link_names(sketch)))
         else
            call joints_of(output, from, to, 2, after)
         end if
      end subroutine line_of
   end subroutine read_outputs_group
end module psalm_outputs_group
