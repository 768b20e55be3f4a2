!> Counterweights for other programs: one JSON object a case.
module psalm_balance_json
   use psalm_balance_study, only: balance_study_t, outcome_t, channel_force, channel_moment, channel_torque, first_joint_channel
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_linear_loads, only: measure_t
   use psalm_markup, only: json_text, number_or_null, comma, truth
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: write_balance_json

contains

   !> The members of an object, without its braces: feasible, adrift, counterweights, minimal_sets, sets, before, designs,
   !> lightest, optimum, budgets, front. Lengths are the user's, angles degrees, masses kg, loads N and N m.
   subroutine write_balance_json(set, study, text)
      type(data_set_t), intent(in) :: set
      type(balance_study_t), intent(in) :: study
      type(text_t), intent(inout) :: text
      integer :: k, b

      call text%add_text('"feasible":'//truth(study%feasible)//',"adrift":'//names(study%adrift)//',"allowed":'// &
                         names(study%allowed)//',"cannot_balance":'//names(study%out_of_reach)//',"counterweights":'// &
                         to_text(study%number)//',"minimal_sets":'//to_text(size(study%sets, 2))//',"sets":[')
      do k = 1, size(study%sets, 2)
         call text%add_text(comma(k)//names(pack([(b, b=2, size(study%names))], &
                                                 [(all(study%sets(:, k) /= b), b=2, size(study%names))])))
      end do
      call text%add_text('],'//new_line('a')//'"residual":'//number(study%left)//',"linkage_mass":'//number(study%mass)// &
                         ',"unit_of_length":'//number(set%masses%metre)//','//new_line('a')//'"before":{')
      call write_loads(study%before)
      call text%add_text('},'//new_line('a')//'"designs":[')
      do k = 1, size(study%designs)
         call text%add_text(comma(k)//new_line('a'))
         call write_outcome(study%designs(k))
      end do
      call text%add_text(']')
      if (allocated(study%lightest)) then
         call text%add_text(','//new_line('a')//'"lightest":')
         call write_outcome(study%lightest)
      end if
      if (allocated(study%optimum)) then
         call text%add_text(','//new_line('a')//'"optimum":')
         call write_outcome(study%optimum)
         call text%add_text(','//new_line('a')//'"composite":{"before":'//number(study%composite)//',"after":'// &
                            number(study%found%value)//',"bound":'//number(study%found%bound)//',"convex":'// &
                            truth(study%found%convex)//',"proven":'// &
                            truth(study%found%convex .or. study%found%proven)//',"starts":'//to_text(study%found%starts)//'}')
      end if
      call text%add_text(','//new_line('a')//'"budgets":[')
      do k = 1, size(study%budgets)
         associate (of => study%budgets(k))
            call text%add_text(comma(k)//'{"mass":'//number(of%second)//',"force":'//number(of%first)//',"bound":'// &
                               number(of%bound)//'}')
         end associate
      end do
      call text%add_text('],"front":[')
      if (allocated(study%front)) then
         do k = 1, size(study%front)
            associate (of => study%front(k))
               call text%add_text(comma(k)//'{"first":'//number(of%first)//',"second":'//number(of%second)//',"bound":'// &
                                  number(of%bound)//',"mass":'//number(of%total)//'}')
            end associate
         end do
      end if
      call text%add_text(']')

   contains

      pure function number(value) result(words)
         real(wp), intent(in) :: value
         character(:), allocatable :: words

         words = number_or_null(value, .true.)
      end function number

      !> Links that carry no weight are told for sets and designs.
      pure function names(bodies) result(words)
         integer, intent(in) :: bodies(:)
         character(:), allocatable :: words
         integer :: i

         words = '['
         do i = 1, size(bodies)
            words = words//comma(i)//json_text(trim(study%names(bodies(i))))
         end do
         words = words//']'
      end function names

      subroutine write_outcome(of)
         type(outcome_t), intent(in) :: of
         integer :: i

         call text%add_text('{"without":')
         if (allocated(of%bare_links)) then
            call text%add_text(names(of%bare_links))
         else
            call text%add_text('[]')
         end if
         call text%add_text(',"mass":'//number(of%total)//',"bound":'//number(of%bound)//',"gap":'//number(of%gap)// &
                            ',"residual":'//number(of%residual)//',"weights":[')
         do i = 1, size(of%weights)
            associate (weight => of%weights(i))
               call text%add_text(comma(i)//'{"link":'//json_text(weight%link)//',"mass":'//number(weight%mass)// &
                                  ',"distance":'//number(weight%distance)//',"angle":'//number(weight%angle)//',"inertia":'// &
                                  number(weight%inertia)//',"radius":'//number(weight%radius)//',"thickness":'// &
                                  number(weight%thickness)//'}')
            end associate
         end do
         call text%add_text('],'//new_line('a')//' "before":{')
         call write_loads(study%before)
         call text%add_text('},'//new_line('a')//' "after":{')
         call write_loads(of%loads)
         call text%add_text('}}')
      end subroutine write_outcome

      subroutine write_loads(loads)
         type(measure_t), intent(in) :: loads(:)
         integer :: i

         call text%add_text('"force":'//both(loads(channel_force))//',"moment":'//both(loads(channel_moment))//',"torque":'// &
                            both(loads(channel_torque))//',"joints":{')
         do i = first_joint_channel, size(loads)
            associate (name => study%channels(i)%name)
               call text%add_text(comma(i - first_joint_channel + 1)//json_text(name(index(name, ' ') + 1:))//':'//both(loads(i)))
            end associate
         end do
         call text%add_text('}')
      end subroutine write_loads

      pure function both(of) result(words)
         type(measure_t), intent(in) :: of
         character(:), allocatable :: words

         words = '{"rms":'//number(of%rms)//',"peak":'//number(of%peak)
         if (size(of%parts) == 2) words = words//',"rms_x":'//number(of%parts(1))//',"rms_y":'//number(of%parts(2))
         words = words//'}'
      end function both
   end subroutine write_balance_json
end module psalm_balance_json
