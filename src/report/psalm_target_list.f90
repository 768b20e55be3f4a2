!> What further outputs of a sketch do, beside what is desired of them.
module psalm_target_list
   use psalm_column_names, only: position_name
   use psalm_columns, only: left_column
   use psalm_kinds, only: wp
   use psalm_number_format, only: number_format_t, format_of, figure, in_sentence
   use psalm_output_targets, only: output_targets_t, sum_of_desired_errors
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: text_t
   implicit none (type, external)
   private
   public :: list_output_targets, put_output_targets

   integer, parameter :: name_columns = 30 !! of the name of a number

contains

   !> Append a table: each number of each output at every position where it weighs.
   subroutine list_output_targets(targets, alone, text)
      type(output_targets_t), intent(in) :: targets
      logical, intent(in) :: alone               !! there are no other desired values
      type(text_t), intent(inout) :: text
      character(:), allocatable :: name
      character(9) :: position
      type(number_format_t) :: of_desired, of_actual, of_error
      integer :: k, i

      call text%add()
      call text%add(trim(merge(' DESIRED VALUES OF OUTPUTS        ', ' DESIRED VALUES OF FURTHER OUTPUTS', alone)))
      call text%add('  OUTPUT                         POSITION        DESIRED         ACTUAL          ERROR')
      do k = 1, size(targets%miss, 2)
         name = left_column(trim(targets%names(k)), name_columns, 0)
         associate (desired => targets%problem%target_values(:size(targets%miss, 1), k), miss => targets%miss(:, k), &
                    weighs => targets%problem%target_weights(:size(targets%miss, 1), k) > 0.0_wp)
            of_desired = format_of(.true., desired, weighs)
            of_actual = format_of(.true., desired + miss, weighs .and. targets%exists(:, k))
            of_error = format_of(.true., miss, weighs .and. targets%exists(:, k))
            do i = 1, size(targets%miss, 1)
               if (.not. weighs(i)) cycle
               write (position, '(i9)') i
               if (targets%exists(i, k)) then
                  call text%add('  '//name//position//figure(desired(i), of_desired)//figure(desired(i) + miss(i), of_actual)// &
                                figure(-miss(i), of_error))
               else
                  call text%add('  '//name//position//figure(desired(i), of_desired)// &
                                trim(merge('   DOES NOT EXIST', '   DOES NOT CLOSE', targets%rate(k))))
               end if
            end do
         end associate
      end do
      call text%add(trim(merge(' TOTAL ERROR                  ', ' THEIR PART OF THE TOTAL ERROR', alone))// &
                    in_sentence(.true., sum_of_desired_errors(targets)))
   end subroutine list_output_targets

   !> The table `desired_values` for other programs: the same.
   subroutine put_output_targets(targets, tables)
      type(output_targets_t), intent(in) :: targets
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer, allocatable :: at(:), of(:)         !! shape (rows): position, number
      integer :: k, i

      associate (weighs => targets%problem%target_weights(:size(targets%miss, 1), :size(targets%miss, 2)) > 0.0_wp)
         at = pack(spread([(i, i=1, size(weighs, 1))], 2, size(weighs, 2)), weighs)
         of = pack(spread([(k, k=1, size(weighs, 2))], 1, size(weighs, 1)), weighs)
      end associate
      table = table_of('desired_values', 'a row for each number of a further output and position where a value is desired', &
                       audience=for_programs)
      call table%add('output', [(targets%names(of(k)), k=1, size(of))])
      call table%add(position_name, at)
      associate (desired => [(targets%problem%target_values(at(k), of(k)), k=1, size(at))], &
                 miss => [(targets%miss(at(k), of(k)), k=1, size(at))], known => [(targets%exists(at(k), of(k)), k=1, size(at))])
         call table%add('desired', desired)
         call table%add('actual', desired + miss, known=known)
         call table%add('error', -miss, known=known)
      end associate
      call tables%put(table)
   end subroutine put_output_targets
end module psalm_target_list
