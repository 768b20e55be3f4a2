!> What further outputs of a sketch do, beside what is desired of them.
module psalm_target_list
   use psalm_column_names, only: position_name
   use psalm_columns, only: left_column
   use psalm_kinds, only: wp
   use psalm_number_format, only: number_format_t, format_of, figure, in_sentence
   use psalm_output_targets, only: output_targets_t, both_exist, sum_of_desired_errors
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
      if (any(targets%problem%target_weights > 0.0_wp)) call list_values()
      if (size(targets%relations) > 0) call list_equals()
      call text%add(trim(merge(' TOTAL ERROR                  ', ' THEIR PART OF THE TOTAL ERROR', alone))// &
                    in_sentence(.true., sum_of_desired_errors(targets)))

   contains

      subroutine list_values()
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
      end subroutine list_values

      !> Numbers that are to be equal, whatever they are: the second as it is, without factor and constant.
      subroutine list_equals()
         character(:), allocatable :: other
         character(9) :: at(2)
         type(number_format_t) :: of_first, of_second
         logical :: known(size(targets%relations))

         known = [(both_exist(targets, k), k=1, size(known))]
         associate (first => [(value_of(k, 1), k=1, size(known))], second => [(value_of(k, 2), k=1, size(known))])
            of_first = format_of(.true., first, known)
            of_second = format_of(.true., second, known)
            of_error = format_of(.true., targets%difference, known)
            call text%add(' OUTPUTS THAT ARE TO BE EQUAL')
            call text%add('  OUTPUT                         POSITION  TO                             POSITION'// &
                          '         OUTPUT             TO     DIFFERENCE')
            do k = 1, size(known)
               associate (of => targets%relations(k))
                  name = left_column(trim(targets%names(of%columns(1))), name_columns, 0)
                  other = left_column(trim(targets%names(of%columns(2))), name_columns, 0)
                  write (at, '(i9)') of%positions
                  if (known(k)) then
                     call text%add('  '//name//at(1)//'  '//other//at(2)//figure(first(k), of_first)// &
                                   figure(second(k), of_second)//figure(targets%difference(k), of_error))
                  else
                     call text%add('  '//name//at(1)//'  '//other//at(2)//'   DOES NOT EXIST')
                  end if
               end associate
            end do
         end associate
      end subroutine list_equals

      pure real(wp) function value_of(k, side)
         integer, intent(in) :: k, side

         value_of = targets%actual(targets%relations(k)%positions(side), targets%relations(k)%columns(side))
      end function value_of
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
      if (size(at) > 0) call tables%put(table)
      if (size(targets%relations) == 0) return
      table = table_of('equal_outputs', 'a row for each two numbers of outputs that are to be equal', audience=for_programs)
      associate (of => targets%relations, known => [(both_exist(targets, k), k=1, size(targets%relations))])
         call table%add('output', [(targets%names(of(k)%columns(1)), k=1, size(of))])
         call table%add(position_name, of%positions(1))
         call table%add('to_output', [(targets%names(of(k)%columns(2)), k=1, size(of))])
         call table%add('to_position', of%positions(2))
         call table%add('times', of%factor)
         call table%add('plus', of%constant)
         call table%add('actual', [(targets%actual(of(k)%positions(1), of(k)%columns(1)), k=1, size(of))], known=known)
         call table%add('to_actual', [(targets%actual(of(k)%positions(2), of(k)%columns(2)), k=1, size(of))], known=known)
         call table%add('difference', targets%difference, known=known)
      end associate
      call tables%put(table)
   end subroutine put_output_targets
end module psalm_target_list
