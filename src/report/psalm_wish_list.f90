!> What further outputs of a sketch do, beside what is desired of them.
module psalm_wish_list
   use psalm_column_names, only: position_name
   use psalm_columns, only: left_column
   use psalm_kinds, only: wp
   use psalm_number_format, only: number_format_t, format_of, figure, in_sentence
   use psalm_output_wishes, only: output_wishes_t, sum_of_wish_errors
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: list_output_wishes, put_output_wishes

   integer, parameter :: name_columns = 30 !! of the name of a number

contains

   !> Append a table: each number of each output at every position where it weighs.
   subroutine list_output_wishes(wishes, alone, text)
      type(output_wishes_t), intent(in) :: wishes
      logical, intent(in) :: alone               !! there are no other desired values
      type(text_t), intent(inout) :: text
      character(:), allocatable :: name
      character(9) :: position
      type(number_format_t) :: of_desired, of_actual, of_error
      integer :: k, i

      call text%add()
      call text%add(trim(merge(' DESIRED VALUES OF OUTPUTS        ', ' DESIRED VALUES OF FURTHER OUTPUTS', alone)))
      call text%add('  OUTPUT                         POSITION        DESIRED         ACTUAL          ERROR')
      do k = 1, size(wishes%miss, 2)
         name = left_column(trim(wishes%names(k)), name_columns, 0)
         associate (desired => wishes%problem%wish_values(:size(wishes%miss, 1), k), miss => wishes%miss(:, k), &
                    weighs => wishes%problem%wish_weights(:size(wishes%miss, 1), k) > 0.0_wp)
            of_desired = format_of(.true., desired, weighs)
            of_actual = format_of(.true., desired + miss, weighs .and. wishes%exists(:, k))
            of_error = format_of(.true., miss, weighs .and. wishes%exists(:, k))
            do i = 1, size(wishes%miss, 1)
               if (.not. weighs(i)) cycle
               write (position, '(i9)') i
               if (wishes%exists(i, k)) then
                  call text%add('  '//name//position//figure(desired(i), of_desired)//figure(desired(i) + miss(i), of_actual)// &
                                figure(-miss(i), of_error))
               else
                  call text%add('  '//name//position//figure(desired(i), of_desired)// &
                                trim(merge('   DOES NOT EXIST', '   DOES NOT CLOSE', wishes%rate(k))))
               end if
            end do
         end associate
      end do
      call text%add(trim(merge(' TOTAL ERROR                  ', ' THEIR PART OF THE TOTAL ERROR', alone))// &
                    in_sentence(.true., sum_of_wish_errors(wishes)))
   end subroutine list_output_wishes

   !> The table `wishes` for other programs: the same.
   subroutine put_output_wishes(wishes, tables)
      type(output_wishes_t), intent(in) :: wishes
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer, allocatable :: at(:), of(:)         !! shape (rows): position, number
      integer :: k, i

      associate (weighs => wishes%problem%wish_weights(:size(wishes%miss, 1), :size(wishes%miss, 2)) > 0.0_wp)
         at = pack(spread([(i, i=1, size(weighs, 1))], 2, size(weighs, 2)), weighs)
         of = pack(spread([(k, k=1, size(weighs, 2))], 1, size(weighs, 1)), weighs)
      end associate
      table = table_of('wishes', 'a row for each number of a further output and position where a value is desired', &
                       audience=for_programs)
      call table%add('output', [(wishes%names(of(k)), k=1, size(of))])
      call table%add(position_name, at)
      associate (desired => [(wishes%problem%wish_values(at(k), of(k)), k=1, size(at))], &
                 miss => [(wishes%miss(at(k), of(k)), k=1, size(at))], known => [(wishes%exists(at(k), of(k)), k=1, size(at))])
         call table%add('desired', desired)
         call table%add('actual', desired + miss, known=known)
         call table%add('error', -miss, known=known)
      end associate
      call tables%put(table)
   end subroutine put_output_wishes
end module psalm_wish_list
