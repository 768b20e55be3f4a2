!> Outputs of a sketch that are to be equal to another, or to themselves at another position: EQUAL, EQORD, EQMULT, EQADD, EQWGT of
!> &OUTPUTS.
!>
!> Source of the need: Oldham (1977), 15.1.
module psalm_equal_items
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_number, only: parse_integer
   use psalm_sketch, only: sketch_t, equality_t, position_of, columns_of, most_targets, output_angle, output_between, output_pose, &
                           output_ratio
   use psalm_sketch_names, only: word_length, words_of, meant
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: read_equalities, equality_words

   character(*), parameter :: usual = "EQUAL='left right' compares two outputs at every position, EQUAL='left 1 left 9' one at two"
   integer, parameter :: unheard = 1000      !! values of items that are refused for another reason
   character(*), parameter :: of_equal(*) = [character(6) :: 'EQORD', 'EQMULT', 'EQADD', 'EQWGT']

contains

   !> Read them. Errors: outputs or positions that are not there, an equality of a number with itself, of outputs of other numbers
   !> each, derivatives of a ratio, factors of angles but 1 and -1, weights that are not positive.
   subroutine read_equalities(group, positions, sketch, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: positions          !! NDES; 0: the items are not used
      type(sketch_t), intent(inout) :: sketch
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: texts(:)
      type(equality_t), allocatable :: equalities(:)
      integer :: n, e, last
      logical :: valid

      if (allocated(sketch%equalities)) deallocate (sketch%equalities)
      call group%get_texts('EQUAL', texts, findings)
      n = size(texts)
      if (n == 0) then
         do e = 1, size(of_equal)
            if (.not. group%given(trim(of_equal(e)))) cycle
            call out_of(group, trim(of_equal(e)), 'is of outputs that are to be equal, but there are none: EQUAL', findings, 1)
         end do
      end if
      allocate (equalities(n))
      block
         integer :: orders(merge(unheard, n, n == 0))
         real(wp) :: factors(size(orders)), constants(size(orders)), weights(size(orders))

         orders = 0
         factors = 1.0_wp
         constants = 0.0_wp
         weights = 1.0_wp
         call group%get_integers('EQORD', orders, findings)
         call group%get_reals('EQMULT', factors, findings)
         call group%get_reals('EQADD', constants, findings)
         call group%get_reals('EQWGT', weights, findings, last=last)
         if (last == 1) weights = weights(1)
         do e = 1, n
            equalities(e)%order = orders(e)
            equalities(e)%factor = factors(e)
            equalities(e)%constant = constants(e)
            equalities(e)%weight = weights(e)
         end do
      end block
      if (n == 0 .or. positions == 0 .or. size(sketch%outputs) == 0) return
      valid = .true.
      do e = 1, n
         call understand(equalities(e))
      end do
      if (valid) call move_alloc(equalities, sketch%equalities)

   contains

      subroutine understand(one)
         type(equality_t), intent(inout) :: one
         character(word_length), allocatable :: words(:)
         character(:), allocatable :: unused
         integer :: side
         logical :: is_number

         words = words_of(texts(e))
         if (size(words) /= 2 .and. size(words) /= 4) then
            call wrong('EQUAL', "'"//trim(texts(e))//"' names no two outputs; "//usual)
            return
         end if
         do side = 1, 2
            associate (name => words(1 + (side - 1)*size(words)/2))
               one%outputs(side) = position_of(trim(name), sketch%outputs%name)
               if (one%outputs(side) == 0) then
                  call wrong('EQUAL', "no output is called '"//trim(name)//"'"//meant(trim(name), sketch%outputs%name))
                  return
               end if
            end associate
            if (size(words) == 2) cycle
            call parse_integer(trim(words(2*side)), one%positions(side), is_number, unused)
            if (.not. is_number) then
               call wrong('EQUAL', "'"//trim(words(2*side))//"' is no number of a position; "//usual)
               return
            end if
            if (one%positions(side) < 1 .or. one%positions(side) > positions) then
               call wrong('EQUAL', 'there is no position '//to_text(one%positions(side))//' among NDES='//to_text(positions))
               return
            end if
         end do
         associate (first => sketch%outputs(one%outputs(1)), second => sketch%outputs(one%outputs(2)))
            if (one%outputs(1) == one%outputs(2) .and. one%positions(1) == one%positions(2)) then
               call wrong('EQUAL', "'"//trim(texts(e))//"' compares an output with itself; "//usual)
            else if (columns_of(first) /= columns_of(second)) then
               call wrong('EQUAL', trim(first%name)//' has '//to_text(columns_of(first))//' numbers, '//trim(second%name)//' '// &
                          to_text(columns_of(second))//': they cannot be equal')
            else if (has_angle(first%kind) .neqv. has_angle(second%kind)) then
               call wrong('EQUAL', trim(first%name)//' and '//trim(second%name)//' are no quantities of one kind: one is an angle')
            end if
            if (one%order < 0 .or. one%order > most_targets) then
               call wrong('EQORD', 'is the order of a derivative, 0, 1 or 2; found '//to_text(one%order))
            else if (one%order > 0 .and. (first%kind == output_ratio .or. second%kind == output_ratio)) then
               call wrong('EQORD', 'a ratio of rates has no derivative that can be compared')
            end if
            if (one%order == 0 .and. abs(abs(one%factor) - 1.0_wp) > 0.0_wp .and. has_angle(first%kind)) &
               call wrong('EQMULT', 'of angles is 1 or -1, for whole turns do not count')
            if (one%weight <= 0.0_wp) call wrong('EQWGT', 'weights must be positive')
         end associate
      end subroutine understand

      pure logical function has_angle(kind)
         integer, intent(in) :: kind

         has_angle = any(kind == [output_angle, output_between, output_pose])
      end function has_angle

      subroutine wrong(item, text)
         character(*), intent(in) :: item, text

         valid = .false.
         call out_of(group, item, text, findings, e)
      end subroutine wrong
   end subroutine read_equalities

   !> An equality as it is written in EQUAL.
   pure function equality_words(sketch, e) result(words)
      type(sketch_t), intent(in) :: sketch
      integer, intent(in) :: e
      character(:), allocatable :: words
      integer :: side

      words = ''
      associate (one => sketch%equalities(e))
         do side = 1, 2
            if (side > 1) words = words//' '
            words = words//trim(sketch%outputs(one%outputs(side))%name)
            if (one%positions(side) > 0) words = words//' '//to_text(one%positions(side))
         end do
      end associate
   end function equality_words
end module psalm_equal_items
