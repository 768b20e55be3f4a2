!> What a sketch does, as texts: the listing, the table of device 9, the table for other programs.
module psalm_chain_list
   use psalm_block, only: begin_block
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_sketch, only: sketch_t
   use psalm_table, only: table_t
   use psalm_text, only: text_t, general, number_or_nan, to_text, upper_case
   implicit none (type, external)
   private
   public :: list_rows, write_drive_block, write_output_block, fill_chain_table

   integer, parameter :: column = 15   !! characters of a column of the listing

contains

   !> Inputs and outputs at every position; what is not closed may close elsewhere than where the linkage comes (`beyond`).
   subroutine list_rows(set, inputs, closed, names, values, text, beyond)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: inputs(:, :)     !! shape (drives, positions)
      logical, intent(in) :: closed(:)         !! shape (positions)
      character(*), intent(in) :: names(:)     !! of the numbers
      real(wp), intent(in) :: values(:, :)     !! shape (numbers, positions)
      type(text_t), intent(inout) :: text
      logical, intent(in), optional :: beyond(:) !! shape (positions)
      character(:), allocatable :: line
      integer :: k, d

      line = ' POSITION'
      do d = 1, size(inputs, 1)
         line = line//heading('INPUT '//set%sketch%drive_label(d))
      end do
      do d = 1, size(names)
         line = line//heading(names(d))
      end do
      call text%add(line)
      do k = 1, size(closed)
         line = repeat(' ', 9 - len(to_text(k)))//to_text(k)
         do d = 1, size(inputs, 1)
            line = line//general(inputs(d, k), 'E')
         end do
         if (closed(k)) then
            do d = 1, size(names)
               if (values(d, k) < huge(1.0_wp)) line = line//general(values(d, k), 'E')
               if (values(d, k) >= huge(1.0_wp)) line = line//repeat(' ', column - 1)//'-'
            end do
         else if (present(beyond)) then
            line = line//trim(merge('   NOT REACHED   ', '   DOES NOT CLOSE', beyond(k)))
         else
            line = line//'   DOES NOT CLOSE'
         end if
         call text%add(line)
      end do
   end subroutine list_rows

   !> A name in capitals at the right of its column.
   pure function heading(name) result(head)
      character(*), intent(in) :: name
      character(column) :: head

      head = upper_case(name(:min(len_trim(name), column - 1)))
      head = adjustr(head)
   end function heading

   !> A block of device 9: all outputs of a sketch, whose first one alone is in the table before.
   subroutine write_output_block(closed, names, values, text)
      logical, intent(in) :: closed(:)           !! shape (positions)
      character(*), intent(in) :: names(:)       !! of the numbers
      real(wp), intent(in) :: values(:, :)       !! shape (numbers, positions)
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: k, n

      line = 'position'
      do n = 1, size(names)
         line = line//' '//trim(names(n))
      end do
      call begin_block('outputs', line, text)
      do k = 1, size(closed)
         line = to_text(k)
         do n = 1, size(names)
            line = line//' '//number_or_nan(values(n, k), closed(k) .and. values(n, k) < huge(1.0_wp))
         end do
         call text%add(line)
      end do
   end subroutine write_output_block

   !> A block of device 9: the change of every output with each drive, the others held.
   subroutine write_drive_block(set, closed, dead, names, by_drive, text)
      type(data_set_t), intent(in) :: set
      logical, intent(in) :: closed(:), dead(:)
      character(*), intent(in) :: names(:)
      real(wp), intent(in) :: by_drive(:, :, :)  !! shape (numbers, drives, positions)
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: k, d, n

      line = 'position'
      do n = 1, size(names)
         do d = 1, size(by_drive, 2)
            line = line//' '//trim(names(n))//'/'//input_name(set%sketch, d)
         end do
      end do
      call begin_block('drives', line, text)
      do k = 1, size(closed)
         line = to_text(k)
         do n = 1, size(names)
            do d = 1, size(by_drive, 2)
               line = line//' '// &
                      number_or_nan(by_drive(n, d, k), closed(k) .and. .not. dead(k) .and. by_drive(n, d, k) < huge(1.0_wp))
            end do
         end do
         call text%add(line)
      end do
   end subroutine write_drive_block

   !> Column of a drive: `input`, of several drives `input.NAME`, of several at one joint `input.NAME.BASE-LINK`.
   pure function input_name(sketch, drive) result(name)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: drive
      character(:), allocatable :: name
      integer :: i

      name = 'input'
      if (size(sketch%drives) == 1) return
      name = 'input.'//sketch%drive_label(drive)
      do i = 1, len(name)
         if (name(i:i) == ' ') name(i:i) = '-'
      end do
   end function input_name

   !> The table of a sketch: a row for each position with inputs, closed, outputs, joints. With `orders` above 0 outputs have
   !> `.v` and `.a`, joints `.vx .vy .ax .ay`. What does not close is not known.
   subroutine fill_chain_table(sketch, inputs, closed, dead, names, values, joints, orders, table)
      type(sketch_t), intent(in) :: sketch
      real(wp), intent(in) :: inputs(:, :)           !! shape (drives, positions)
      logical, intent(in) :: closed(:), dead(:)      !! shape (positions); dead: rates are infinite
      character(*), intent(in) :: names(:)
      real(wp), intent(in) :: values(:, 0:, :)       !! shape (numbers, 0:, positions)
      complex(wp), intent(in) :: joints(:, 0:, :)    !! shape (joints, 0:, positions)
      integer, intent(in) :: orders                  !! 0 or 2
      type(table_t), intent(inout) :: table
      character(*), parameter :: of_joint(0:2) = [character(1) :: '', 'v', 'a']
      character(*), parameter :: of_output(0:2) = [character(2) :: '', '.v', '.a']
      logical :: known(size(closed), 0:2)
      character(:), allocatable :: joint
      integer :: d, o

      known(:, 0) = closed
      known(:, 1) = closed .and. .not. dead
      known(:, 2) = known(:, 1)
      do d = 1, size(inputs, 1)
         call table%add(input_name(sketch, d), inputs(d, :))
      end do
      call table%add_flag('closed', closed)
      do d = 1, size(names)
         do o = 0, orders
            call table%add(trim(names(d))//trim(of_output(o)), values(d, o, :), known(:, o))
         end do
      end do
      do d = 1, size(joints, 1)
         do o = 0, orders
            joint = trim(sketch%joint_name(d))//'.'//trim(of_joint(o))
            call table%add(joint//'x', real(joints(d, o, :), wp), known(:, o))
            call table%add(joint//'y', aimag(joints(d, o, :)), known(:, o))
         end do
      end do
   end subroutine fill_chain_table
end module psalm_chain_list
