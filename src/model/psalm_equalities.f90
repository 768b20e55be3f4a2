!> Outputs of a sketch that are to be equal to another, or to themselves at another position: EQUAL of &OUTPUTS, number by number.
!>
!> Source of the need: Oldham (1977), 15.1, a lift whose velocity ratio is to be the same at both ends of its stroke, whatever it
!> is.
module psalm_equalities
   use psalm_kinds, only: wp, full_turn
   use psalm_sketch, only: sketch_t, target_column_t, columns_of, first_number, output_angle, output_between, output_pose
   implicit none (type, external)
   private
   public :: equal_numbers_t, relations_of, compared_columns, miss_of, move_constants

   !> One number at one position that is to be factor times another number, or at another position, plus a constant.
   type :: equal_numbers_t
      integer :: equality = 0               !! which EQUAL it is of
      integer :: columns(2) = 0             !! of `compared_columns`
      integer :: numbers(2) = 0             !! of all numbers of the outputs
      integer :: positions(2) = 0
      integer :: order = 0                  !! derivative
      logical :: turns = .false.            !! angles: whole turns between them do not count
      real(wp) :: factor = 1.0_wp, constant = 0.0_wp, weight = 1.0_wp
   end type equal_numbers_t

contains

   !> All numbers of outputs that are compared: those with targets, as `target_columns` has them, then what equalities need besides.
   pure function compared_columns(sketch) result(columns)
      type(sketch_t), intent(in) :: sketch
      type(target_column_t), allocatable :: columns(:)
      integer :: e, side, c

      columns = sketch%target_columns()
      if (.not. allocated(sketch%equalities)) return
      do e = 1, size(sketch%equalities)
         associate (one => sketch%equalities(e))
            do side = 1, 2
               do c = 1, columns_of(sketch%outputs(one%outputs(side)))
                  if (place_of(columns, one%outputs(side), c, one%order) == 0) &
                     columns = [columns, target_column_t(one%outputs(side), c, one%order)]
               end do
            end do
         end associate
      end do
   end function compared_columns

   !> Place of a number among the columns; 0: it is none of them.
   pure integer function place_of(columns, output, component, order) result(k)
      type(target_column_t), intent(in) :: columns(:)
      integer, intent(in) :: output, component, order

      do k = 1, size(columns)
         if (columns(k)%output == output .and. columns(k)%component == component .and. columns(k)%order == order) return
      end do
      k = 0
   end function place_of

   !> The equalities number by number and position by position.
   pure function relations_of(sketch, positions) result(relations)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: positions
      type(equal_numbers_t), allocatable :: relations(:)
      type(target_column_t), allocatable :: columns(:)
      type(equal_numbers_t) :: one
      integer :: e, c, i, n

      allocate (relations(0))
      if (.not. allocated(sketch%equalities)) return
      columns = compared_columns(sketch)
      do e = 1, size(sketch%equalities)
         associate (equality => sketch%equalities(e), outputs => sketch%outputs)
            n = columns_of(outputs(equality%outputs(1)))
            one%equality = e
            one%order = equality%order
            one%factor = equality%factor
            one%constant = equality%constant
            one%weight = equality%weight
            do i = 1, merge(positions, 1, equality%positions(1) == 0)
               one%positions = merge(equality%positions, i, equality%positions > 0)
               do c = 1, n
                  one%columns = [place_of(columns, equality%outputs(1), c, equality%order), &
                                 place_of(columns, equality%outputs(2), c, equality%order)]
                  one%numbers = [first_number(outputs, equality%outputs(1)), first_number(outputs, equality%outputs(2))] + c - 1
                  one%turns = equality%order == 0 .and. c == n .and. &
                              any(outputs(equality%outputs(1))%kind == [output_angle, output_between, output_pose])
                  relations = [relations, one]
               end do
            end do
         end associate
      end do
   end function relations_of

   !> By how much the first of two numbers misses what the second asks of it.
   elemental real(wp) function miss_of(relation, first, second) result(miss)
      type(equal_numbers_t), intent(in) :: relation
      real(wp), intent(in) :: first, second

      miss = first - relation%factor*second - relation%constant
      if (relation%turns) miss = miss - full_turn*anint(miss/full_turn)
   end function miss_of

   !> Values of an output are counted from another zero: keep what its equalities say.
   pure subroutine move_constants(sketch, output, moved)
      type(sketch_t), intent(inout) :: sketch
      integer, intent(in) :: output
      real(wp), intent(in) :: moved         !! the new zero, in the old count
      integer :: e

      if (.not. allocated(sketch%equalities)) return
      do e = 1, size(sketch%equalities)
         associate (one => sketch%equalities(e))
            if (one%order > 0) cycle
            if (one%outputs(1) == output) one%constant = one%constant - moved
            if (one%outputs(2) == output) one%constant = one%constant + one%factor*moved
         end associate
      end do
   end subroutine move_constants
end module psalm_equalities
