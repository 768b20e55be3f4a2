!> A sketch as text that can be read again.
module psalm_sketch_text
   use psalm_data_set, only: data_set_t
   use psalm_limits_group, only: proof_by_default
   use psalm_kinds, only: wp, right_angle
   use psalm_output_kind, only: output_kind_t, output_kind
   use psalm_rate_items, only: rate_row_t, wanted_rows
   use psalm_search, only: found_t
   use psalm_sketch, only: sketch_t, drive_stretches, output_angle, output_between, output_distance, output_point, &
                           output_pose, output_ratio, output_slide, output_x, output_y, most_targets, target_t
   use psalm_text, only: quoted, text_t, full_precision, to_text
   use psalm_equal_items, only: equality_words
   use psalm_target_items, only: values_of, weights_of
   implicit none (type, external)
   private
   public :: variant_t, variant_of, take_found, write_sketch, limit_of_angles

   integer, parameter :: line_length = 100  !! columns of a line of values

   !> What of a case is written otherwise than it was read.
   type :: variant_t
      character(:), allocatable :: title
      integer :: last = 1                   !! LAST
      integer :: ikin = 0                   !! IKIN
      real(wp), allocatable :: delt(:)      !! DELT
      real(wp), allocatable :: desx(:), desy(:) !! DESX, DESY
      type(sketch_t) :: sketch              !! of a linkage that has one
      real(wp) :: from_drawing = 0.0_wp     !! its CRNKI
      logical :: by_loops = .false.         !! it is written by its loops
      logical :: with_others = .true.       !! the groups that are kept as they are follow,
      character(:), allocatable :: others   !! or these in their place
   end type variant_t

contains

   !> The case as it was read.
   pure function variant_of(set) result(variant)
      type(data_set_t), intent(in) :: set
      type(variant_t) :: variant

      variant%title = set%title
      variant%last = set%limits%last
      variant%ikin = set%method%ikin
      variant%delt = set%method%delt
      variant%desx = set%method%desx
      variant%desy = set%method%desy
      variant%sketch = set%sketch
      variant%from_drawing = set%method%crnki
   end function variant_of

   !> The positions of a linkage that was found: its inputs, and where the desired points lie.
   pure subroutine take_found(set, found, variant)
      type(data_set_t), intent(in) :: set
      type(found_t), intent(in) :: found
      type(variant_t), intent(inout) :: variant

      variant%delt = found%delt
      if (.not. allocated(found%desired)) return
      variant%desx = found%desired(:, 1) - set%method%xadd
      variant%desy = found%desired(:, 2) - set%method%yadd
   end subroutine take_found

   !> Append the data set of a sketch, as an analysis.
   subroutine write_sketch(set, text, variant)
      type(data_set_t), intent(in) :: set
      type(text_t), intent(inout) :: text
      type(variant_t), intent(in), optional :: variant !! what is written otherwise than `set` holds it
      type(variant_t) :: own
      character(:), allocatable :: line
      integer :: i, k, own_links

      own = variant_of(set)
      if (present(variant)) own = variant
      associate (sketch => own%sketch)
         own_links = size(sketch%links) - count(sketch%drives%kind == drive_stretches)
         call text%add(own%title)
         line = ' &CHAIN JNT='
         do i = 1, size(sketch%joint_name)
            call word(quoted(trim(sketch%joint_name(i))))
         end do
         call text%add(line)
         call numbers('JX=', sketch%x)
         call numbers('JY=', sketch%y)
         line = '  LNAME='
         do i = 1, own_links
            call word(quoted(trim(sketch%links(i)%name)))
         end do
         call text%add(line)
         line = '  LNK='
         do i = 1, own_links
            call word(quoted(joints_of(sketch, sketch%links(i)%joints)))
         end do
         call text%add(line)
         if (size(sketch%slides) > 0) call write_slides()
         if (size(sketch%gears) > 0) call write_gears()
         if (size(sketch%length) > 0) then
            line = '  LENP='
            do i = 1, size(sketch%length)
               call word(quoted(joints_of(sketch, sketch%length_of(:, i))))
            end do
            call text%add(line)
            call numbers('LENV=', sketch%length)
         end if
         if (sketch%over_braced) call text%add('  KOVER=1,')
         call text%add(' &END')
         call write_drives()
         if (size(sketch%outputs) > 0) then
            line = ' &OUTPUTS OUTPUT='
            do i = 1, size(sketch%outputs)
               call word(quoted(output_words(sketch, i)))
            end do
            call text%add(line)
            line = '  ONAME='
            do i = 1, size(sketch%outputs)
               call word(quoted(trim(sketch%outputs(i)%name)))
            end do
            if (.not. sketch%has_targets()) line = line//' &END'
            call text%add(line)
            do i = 1, size(sketch%outputs)
               do k = 0, most_targets
                  associate (target => sketch%outputs(i)%targets(k))
                     if (.not. allocated(target%values)) cycle
                     if (.not. has_one_weight(target)) cycle
                     call numbers(trim(values_of(k))//to_text(i)//'=', [target%values])
                     call numbers(trim(weights_of(k))//to_text(i)//'=', target%weights(1, :))
                  end associate
               end do
            end do
            call write_equalities()
            if (sketch%has_targets()) call text%add(' &END')
         end if
      end associate
      line = ' &METHOD'
      if (own%from_drawing /= 0.0_wp) line = line//' CRNKI='//full_precision(own%from_drawing)//','
      if (own%ikin /= 0) then
         call text%add(line//' IKIN='//to_text(own%ikin)//',')
      else if (any(own%sketch%drives%steps > 0)) then
         call text%add(line)
      else
         call text%add(line//' NDES='//to_text(set%method%ndes)//',')
         call numbers('DELT=', own%delt)
         if (set%method%desired) call write_desired(output_kind(set%motion()))
         if (size(own%sketch%outputs) > 0) call write_weighed(own%sketch%outputs(1)%targets)
      end if
      call text%add(' &END')
      line = ' &LIMITS'
      line = line//limit_of_angles(set)
      if (set%limits%toggle_given) line = line//' TOGGLE='//full_precision(set%limits%toggle)//','
      if (set%limits%icond /= 0) line = line//' ICOND=1,'
      if (set%limits%iproof /= proof_by_default) line = line//' IPROOF='//to_text(set%limits%iproof)//','
      if (set%limits%dwell > 0.0_wp) line = line//' DWELL='//full_precision(set%limits%dwell)//','
      call text%add(line)
      call text%add('  KTHETA='//to_text(set%limits%ktheta)//', IPLOT='//to_text(set%limits%iplot)//', LAST='// &
                    to_text(own%last)//' &END')
      if (own%with_others) call text%add_text(set%others)

   contains

      !> One more value of the line in hand.
      subroutine word(value)
         character(*), intent(in) :: value

         if (len(line) + len(value) > line_length) then
            call text%add(line)
            line = '   '
         end if
         line = line//value//','
      end subroutine word

      subroutine numbers(name, values)
         character(*), intent(in) :: name
         real(wp), intent(in) :: values(:)
         integer :: n

         line = '  '//name
         do n = 1, size(values)
            if (values(n) == 0.0_wp) then
               call word('0.0')
            else
               call word(full_precision(values(n)))
            end if
         end do
         call text%add(line)
      end subroutine numbers

      subroutine write_slides()
         associate (slides => own%sketch%slides)
            line = '  NSLIDE='//to_text(size(slides))//', SNAME='
            do i = 1, size(slides)
               call word(quoted(trim(slides(i)%name)))
            end do
            call text%add(line)
            do k = 1, 2
               line = merge('  SLNK= ', '  SLNK2=', k == 1)
               do i = 1, size(slides)
                  call word(quoted(trim(own%sketch%links(slides(i)%links(k))%name)))
               end do
               call text%add(line)
            end do
            call numbers('SLX=', [(slides(i)%x, i=1, size(slides))])
            call numbers('SLY=', [(slides(i)%y, i=1, size(slides))])
            call numbers('SLANG=', [(slides(i)%angle, i=1, size(slides))])
         end associate
      end subroutine write_slides

      subroutine write_gears()
         integer :: members(3)

         associate (gears => own%sketch%gears)
            do k = 1, 3
               line = '  GEARA='
               if (k == 2) line = '  GEARB='
               if (k == 3) line = '  GCARR='
               do i = 1, size(gears)
                  members = [gears(i)%wheels, gears(i)%carrier]
                  call word(quoted(trim(own%sketch%links(members(k))%name)))
               end do
               call text%add(line)
            end do
            call numbers('GTA=', [(gears(i)%teeth(1), i=1, size(gears))])
            call numbers('GTB=', [(gears(i)%teeth(2), i=1, size(gears))])
         end associate
      end subroutine write_gears

      !> Links of the drives; blank where the drive has no base of its own.
      subroutine sides_of_drives(name, links)
         character(*), intent(in) :: name
         integer, intent(in) :: links(:)
         integer :: n

         line = name
         do n = 1, size(links)
            if (own%sketch%drives(n)%base > 0) call word(quoted(trim(own%sketch%links(links(n))%name)))
            if (own%sketch%drives(n)%base == 0) call word('')
         end do
         call text%add(line)
      end subroutine sides_of_drives

      !> What outputs are to be equal to.
      subroutine write_equalities()
         integer :: e

         if (.not. allocated(own%sketch%equalities)) return
         associate (equalities => own%sketch%equalities)
            line = '  EQUAL='
            do e = 1, size(equalities)
               call word(quoted(equality_words(own%sketch, e)))
            end do
            call text%add(line)
            line = '  EQORD='
            do e = 1, size(equalities)
               call word(to_text(equalities(e)%order))
            end do
            call text%add(line)
            call numbers('EQMULT=', equalities%factor)
            call numbers('EQADD=', equalities%constant)
            call numbers('EQWGT=', equalities%weight)
         end associate
      end subroutine write_equalities

      subroutine write_drives()
         associate (drives => own%sketch%drives)
            line = ' &DRIVES DRIVE='
            do i = 1, size(drives)
               call word(quoted(trim(drives(i)%name)))
            end do
            call text%add(line)
            if (any(drives%base > 0)) then
               call sides_of_drives('  DBASE=', drives%base)
               call sides_of_drives('  DLINK=', drives%link)
            end if
            if (any(drives%geared)) then
               call numbers('RATIO=', [(merge(drives(i)%ratio, 0.0_wp, drives(i)%geared), i=1, size(drives))])
               call numbers('PHASE=', [(drives(i)%phase, i=1, size(drives))])
            end if
            if (any(abs(drives%speed) > 0.0_wp)) call numbers('DSPEED=', drives%speed)
            if (any(abs(drives%accel) > 0.0_wp)) call numbers('DACCEL=', drives%accel)
            if (any(drives%steps > 0)) then
               line = '  NGRID='
               do i = 1, size(drives)
                  call word(to_text(drives(i)%steps))
               end do
               call text%add(line)
               call numbers('DLOW=', [(drives(i)%low, i=1, size(drives))])
               call numbers('DHIGH=', [(drives(i)%high, i=1, size(drives))])
               call text%add(' &END')
               return
            end if
            do i = 2, size(drives)
               if (allocated(drives(i)%delt)) call numbers('DELT'//to_text(i)//'=', drives(i)%delt)
            end do
            call text%add(' &END')
         end associate
      end subroutine write_drives

      subroutine write_desired(kind)
         type(output_kind_t), intent(in) :: kind

         if (kind%components > 1) then
            call text%add('  XADD='//full_precision(set%method%xadd)//', YADD='//full_precision(set%method%yadd)//',')
            call numbers('DESX=', own%desx)
            call numbers('DESY=', own%desy)
            call numbers('XMULT=', set%method%xmult)
            call numbers('YMULT=', set%method%ymult)
         end if
         if (kind%components /= 2) then
            call numbers('DESANG=', set%method%desang)
            call numbers('ANMULT=', set%method%anmult)
         end if
         if (allocated(set%method%rate_desired)) call write_rates(wanted_rows(set%method%rate_weight), &
                                                                set%method%rate_desired, set%method%rate_weight)
      end subroutine write_desired

      !> True if all numbers of a target have one weight at each position, as the items of &OUTPUTS have.
      pure logical function has_one_weight(target)
         type(target_t), intent(in) :: target

         has_one_weight = .not. any(abs(target%weights - spread(target%weights(1, :), 1, size(target%weights, 1))) > 0.0_wp)
      end function has_one_weight

      !> Poses that are wanted of the first output with weights of their own for place and direction: items of &METHOD.
      subroutine write_weighed(targets)
         type(target_t), intent(in) :: targets(0:)
         character(*), parameter :: of_value(*) = [character(7) :: 'DESX=', 'DESY=', 'DESANG=']
         character(*), parameter :: of_weight(*) = [character(7) :: 'XMULT=', 'YMULT=', 'ANMULT=']
         real(wp), allocatable :: wanted(:, :, :), weight(:, :, :)
         integer :: c, order

         if (allocated(targets(0)%values)) then
            if (.not. has_one_weight(targets(0))) then
               do c = 1, size(targets(0)%values, 1)
                  call numbers(trim(of_value(c)), targets(0)%values(c, :))
                  call numbers(trim(of_weight(c)), targets(0)%weights(c, :))
               end do
            end if
         end if
         do order = 1, most_targets
            if (.not. allocated(targets(order)%values)) cycle
            if (has_one_weight(targets(order))) cycle
            associate (shape_of => shape(targets(order)%values))
               if (.not. allocated(wanted)) allocate (wanted(shape_of(2), shape_of(1), most_targets), &
                                                      weight(shape_of(2), shape_of(1), most_targets), source=0.0_wp)
            end associate
            wanted(:, :, order) = transpose(targets(order)%values)
            weight(:, :, order) = transpose(targets(order)%weights)
         end do
         if (allocated(wanted)) call write_rates(wanted_rows(weight), wanted, weight)
      end subroutine write_weighed

      !> Derivatives that are wanted of the first output; where none is, they weigh nothing.
      subroutine write_rates(rows, wanted, weight)
         type(rate_row_t), intent(in) :: rows(:)
         real(wp), intent(in) :: wanted(:, :, :), weight(:, :, :) !! shape (positions, components, orders)
         integer :: n

         do n = 1, size(rows)
            call numbers(trim(rows(n)%item)//'=', wanted(:, rows(n)%component, rows(n)%order))
            call numbers(trim(rows(n)%weigher)//'=', weight(:, rows(n)%component, rows(n)%order))
         end do
      end subroutine write_rates
   end subroutine write_sketch

   !> Joints by name, with blanks between them.
   pure function joints_of(sketch, joints) result(words)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: joints(:)
      character(:), allocatable :: words
      integer :: i

      words = ''
      do i = 1, size(joints)
         if (i > 1) words = words//' '
         words = words//trim(sketch%joint_name(joints(i)))
      end do
   end function joints_of

   !> An output in the words of &OUTPUTS.
   pure function output_words(sketch, which) result(words)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: which
      character(:), allocatable :: words

      associate (output => sketch%outputs(which))
         select case (output%kind)
         case (output_point)
            words = 'point '//joints_of(sketch, output%joints(:1))
         case (output_x)
            words = 'x '//joints_of(sketch, output%joints(:1))
         case (output_y)
            words = 'y '//joints_of(sketch, output%joints(:1))
         case (output_angle)
            words = 'angle '//joints_of(sketch, output%joints(:2))
         case (output_distance)
            words = 'distance '//joints_of(sketch, pack(output%joints, output%joints > 0))
         case (output_slide)
            words = 'slide '//trim(sketch%slides(output%slide)%name)
         case (output_between)
            words = 'between '//joints_of(sketch, output%joints)
         case (output_pose)
            words = 'pose '//joints_of(sketch, output%joints(:3))
         case (output_ratio)
            words = 'ratio '//trim(sketch%outputs(output%outputs(1))%name)//' '// &
                    trim(sketch%outputs(output%outputs(2))%name)
         case default
            words = ''
         end select
      end associate
   end function output_words

   !> Item of &LIMITS: the limit of transmission angles as it was given; nothing if there is none, or if &CONSTR has it.
   function limit_of_angles(set) result(item)
      type(data_set_t), intent(in) :: set
      character(:), allocatable :: item

      item = ''
      if (set%limits%trmin_given) then
         if (.not. (set%constr%gives_angle .and. index(set%others, '&CONSTR') > 0)) &
            item = ' TRMIN='//full_precision(right_angle - set%limits%tangle)//','
      else if (set%limits%tangle_given) then
         item = ' TANGLE='//full_precision(set%limits%tangle)//','
      end if
   end function limit_of_angles
end module psalm_sketch_text
