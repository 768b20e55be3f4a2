!> Random linkages: nothing that is proven of them is untrue, nothing is left undecided.
!>
!> `bench/proof` gives arguments: the number of linkages, of points looked at in each part, and of the first linkage.
program test_proof_campaign
   use check, only: checks_t, number_argument
   use linkage_campaign, only: campaign, check_models, tally_t, draw_plain, draw_round
   implicit none (type, external)
   character(21), parameter :: names(3) = ['random dimensions    ', 'near a toggle        ', 'round dimensions     ']
   integer, parameter :: share(3) = [10, 3, 1]  !! tenths: how many of each sort
   integer, parameter :: most_models = 2000     !! linkages whose models are looked at
   type(checks_t) :: t
   type(tally_t) :: tally
   integer :: linkages, points, first, mode, outside, inside

   linkages = number_argument(1, 30)
   points = number_argument(2, 4)
   first = number_argument(3, 1)
   if (command_argument_count() > 0) print '(a)', '| dimensions | linkages | close everywhere | ends | exact touches '// &
      '| needed quadruple precision | undecided | positions checked | untrue |', &
      '| --- | --- | --- | --- | --- | --- | --- | --- | --- |'
   do mode = draw_plain, draw_round
      call campaign(mode, first, max(1, linkages*share(mode)/10), points, tally)
      if (command_argument_count() > 0) print '("| ",a,6(" | ",i0)," | ",es7.1," | ",i0," |")', trim(names(mode)), tally%linkages, &
         tally%everywhere, tally%ends, tally%touches, tally%fine, tally%undecided, tally%checks, tally%untrue
      call check_models(mode, first, min(linkages, most_models), outside, inside)
      call t%equal_integer(outside, 0, trim(names(mode))//': every direction, slide and rate lies in its model')
      call t%equal_integer(tally%untrue, 0, trim(names(mode))//': nothing that is proven is untrue')
      if (mode == draw_plain) call t%equal_integer(tally%undecided, 0, trim(names(mode))//': nothing is left undecided')
   end do
   call t%report()
end program test_proof_campaign
