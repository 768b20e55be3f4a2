!> What a sketch does, in the listing.
module psalm_chain_list
   use psalm_columns, only: heading_of
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_number_format, only: number_format_t, format_of, figure
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: list_rows

   integer, parameter :: column = 15   !! characters of a column of the listing

contains

   !> Inputs and outputs at every position; what is not closed may close elsewhere than where the linkage comes (`beyond`).
   subroutine list_rows(set, inputs, closed, names, values, text, beyond, errors)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: inputs(:, :)     !! shape (drives, positions)
      logical, intent(in) :: closed(:)         !! shape (positions)
      character(*), intent(in) :: names(:)     !! of the numbers
      real(wp), intent(in) :: values(:, :)     !! shape (numbers, positions)
      type(text_t), intent(inout) :: text
      logical, intent(in), optional :: beyond(:) !! shape (positions)
      real(wp), intent(in), optional :: errors(:, :) !! shape of `values`: bounds of what rounding makes; 0: not known
      type(number_format_t) :: of_inputs(size(inputs, 1)), of_values(size(names))
      character(:), allocatable :: line
      integer :: k, d

      do d = 1, size(inputs, 1)
         of_inputs(d) = format_of(.true., inputs(d, :))
      end do
      do d = 1, size(names)
         of_values(d) = format_of(.true., values(d, :), closed, pack(values, spread(alike(d), 2, size(closed)) .and. &
                                                                               spread(closed, 1, size(names))))
      end do

      line = ' POSITION'
      do d = 1, size(inputs, 1)
         line = line//heading_of('INPUT '//set%sketch%drive_label(d))
      end do
      do d = 1, size(names)
         line = line//heading_of(names(d))
      end do
      call text%add(line)
      do k = 1, size(closed)
         line = repeat(' ', 9 - len(to_text(k)))//to_text(k)
         do d = 1, size(inputs, 1)
            line = line//figure(inputs(d, k), of_inputs(d))
         end do
         if (closed(k)) then
            do d = 1, size(names)
               if (.not. values(d, k) < huge(1.0_wp)) then
                  line = line//repeat(' ', column - 1)//'-'
               else if (present(errors)) then
                  line = line//figure(values(d, k), of_values(d), errors(d, k))
               else
                  line = line//figure(values(d, k), of_values(d))
               end if
            end do
         else if (present(beyond)) then
            line = line//trim(merge('   NOT REACHED   ', '   DOES NOT CLOSE', beyond(k)))
         else
            line = line//'   DOES NOT CLOSE'
         end if
         call text%add(line)
      end do

   contains

      !> Which columns are of the kind of one: values, velocities or accelerations, by the ends of their names.
      pure function alike(column) result(same)
         integer, intent(in) :: column
         logical :: same(size(names))
         integer :: i

         same = [(rate_of(names(i)) == rate_of(names(column)), i=1, size(names))]
      end function alike

      pure character(1) function rate_of(name)
         character(*), intent(in) :: name

         rate_of = ' '
         associate (n => len_trim(name))
            if (n > 2) then
               if (any(name(n - 1:n) == ['.v', '.a'])) rate_of = name(n:n)
            end if
         end associate
      end function rate_of
   end subroutine list_rows

end module psalm_chain_list
