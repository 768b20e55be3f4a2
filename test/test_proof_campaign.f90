!> Random linkages: nothing that is proven of them is untrue, nothing is left undecided.
!>
!> `bench/proof` gives arguments: the number of linkages, of points looked at in each part, and of the first linkage.
program test_proof_campaign
   use check, only: checks_t
   use linkage_campaign, only: campaign, check_models, tally_t, draw_plain, draw_round
   implicit none (type, external)
   character(21), parameter :: names(3) = ['random dimensions    ', 'near a toggle        ', 'round dimensions     ']
   type(checks_t) :: t
   type(tally_t) :: tally
   integer :: linkages, points, first, mode, outside, inside

   linkages = argument(1, 30)
   points = argument(2, 4)
   first = argument(3, 1)
   do mode = draw_plain, draw_round
      call campaign(mode, first, merge(linkages, max(1, 3*linkages/10), mode == draw_plain), points, tally)
      if (command_argument_count() > 0) print '(a,": ",i0," linkages, ",i0," close everywhere, ",i0," ends, ",i0,' &
         //'" exact touches, ",i0," with quadruple precision, ",i0," undecided, ",es8.1," checks, ",i0," untrue")', &
         trim(names(mode)), tally%linkages, tally%everywhere, tally%ends, tally%touches, tally%fine, tally%undecided, &
         tally%checks, tally%untrue
      call check_models(mode, first, linkages, outside, inside)
      call t%equal_integer(outside, 0, trim(names(mode))//': every direction and slide lies in its model')
      call t%equal_integer(tally%untrue, 0, trim(names(mode))//': nothing that is proven is untrue')
      if (mode == draw_plain) call t%equal_integer(tally%undecided, 0, trim(names(mode))//': nothing is left undecided')
   end do
   call t%report()

contains

   !> An argument of the command line that is a number.
   integer function argument(number, default)
      integer, intent(in) :: number, default
      character(20) :: text
      integer :: status

      call get_command_argument(number, text)
      read (text, *, iostat=status) argument
      if (status /= 0) argument = default
   end function argument
end program test_proof_campaign
