!> A family of curves in the listing and on device 9.
module psalm_family_list
   use psalm_column_names, only: closed_name, input_name, input_unit, output_unit
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_family_study, only: family_t
   use psalm_number_format, only: figures_of
   use psalm_tables, only: table_t, tables_t, table_of
   use psalm_text, only: text_t, lower_case, to_text
   implicit none (type, external)
   private
   public :: report_family

   integer, parameter :: in_a_row = 6   !! settings of a table

contains

   !> The family in the listing and on device 9; a remark on settings that do not close everywhere.
   subroutine report_family(set, family, found, devices)
      type(data_set_t), intent(in) :: set
      type(family_t), intent(in) :: family
      logical, intent(in) :: found               !! there is one
      type(devices_t), intent(inout) :: devices
      integer :: k, open

      if (.not. found) then
         call devices%remark(set, 'no family of curves: the dimension of &SWEEP cannot be set by itself: an arc that slides, '// &
                             'or that is not there')
         call devices%note_violation()
         return
      end if
      call list_family(set%has_names(), family, devices%six)
      call put_family(set%has_names(), family, devices%cases(devices%last_case()))
      open = count([(.not. all(family%closed(:, k)), k=1, size(family%setting))])
      if (open == 0) return
      call devices%remark(set, 'the linkage does not close everywhere at '//to_text(open)//' of '// &
                          to_text(size(family%setting))//' settings of &SWEEP')
      call devices%note_violation()
   end subroutine report_family

   !> Append a table of each number of the output: a row for each position, a column for each setting; below, its stroke.
   subroutine list_family(named, family, text)
      logical, intent(in) :: named               !! the dimension is one of a sketch
      type(family_t), intent(in) :: family
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      character(15) :: setting(size(family%setting)), input(size(family%input)), stroke(size(family%setting))
      character(15) :: actual(size(family%input), size(family%setting))
      integer :: c, first, last, i, k

      setting = figures_of(named, family%setting)
      input = figures_of(named, family%input)
      call text%add()
      call text%add(' FAMILY OF CURVES: THE OUTPUT FOR '//to_text(size(family%setting))//' SETTINGS OF '//family%name)
      do c = 1, size(family%numbers)
         associate (values => family%actual(:, c, :), closed => family%closed)
            actual = reshape(figures_of(named, pack(values, .true.), pack(closed, .true.)), shape(actual))
            stroke = figures_of(named, maxval(values, 1, closed) - minval(values, 1, closed), any(closed, 1))
            where (.not. any(closed, 1)) stroke = '              -'
         end associate
         do first = 1, size(family%setting), in_a_row
            last = min(first + in_a_row - 1, size(family%setting))
            call text%add()
            line = ' '//family%numbers(c)(:14)
            do k = first, last
               line = line//setting(k)
            end do
            call text%add(line)
            do i = 1, size(family%input)
               line = input(i)
               do k = first, last
                  if (family%closed(i, k)) then
                     line = line//actual(i, k)
                  else
                     line = line//merge('    NOT REACHED', ' DOES NOT CLOSE', family%beyond(i, k))
                  end if
               end do
               call text%add(line)
            end do
            line = ' STROKE        '
            do k = first, last
               line = line//stroke(k)
            end do
            call text%add(line)
         end do
      end do
   end subroutine list_family

   !> The table `sweep`.
   subroutine put_family(named, family, tables)
      logical, intent(in) :: named               !! the dimension is one of a sketch
      type(family_t), intent(in) :: family
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(:), allocatable :: name
      integer :: i, k, c

      ! names of joints stay as they are
      name = lower_case(family%name)
      if (named) name = family%name_in_sentence()
      associate (settings => size(family%setting), positions => size(family%input))
         table = table_of('sweep', 'a row for each setting of '//name//' and position')
         call table%add('setting', [((family%setting(k), i=1, positions), k=1, settings)], input_unit(.not. family%sets_angle))
         call table%add(input_name(), [((family%input(i), i=1, positions), k=1, settings)], input_unit(family%slides))
         call table%add(closed_name, reshape(family%closed, [positions*settings]))
         do c = 1, size(family%numbers)
            call table%add(trim(family%columns(c)), reshape(family%actual(:, c, :), [positions*settings]), &
                           output_unit(family%angle(c)), reshape(family%closed, [positions*settings]), trim(family%numbers(c)))
         end do
      end associate
      call tables%put(table)
   end subroutine put_family
end module psalm_family_list
