!> Forces of sketches: Newton and Euler for every link, power of all drives, momentum, virtual work, gears, cylinders; and
!> sketches of dyads both ways, in the poses of their links and dyad by dyad.
program test_chain_forces
   use chain_force_checks, only: t, laws, both_ways, rods, names_and_messages, text_of, chain_of, gears
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: posed(*) = [character(24) :: 'stephenson2_six_bar', 'scissors_lift', 'excavator', &
                                          'geared_five_bar', 'landing_gear'] !! solved in the poses of their links
   character(*), parameter :: looped(*) = [character(24) :: 'sketch_four_bar', 'sketch_slider_crank', 'jansen', 'watt_six_bar', &
                                           'stephenson3_six_bar', 'chebyshev', 'wiper', 'toggle_press', 'double_wishbone', &
                                           'horst_suspension', 'peaucellier']
   integer :: k

   do k = 1, size(posed)
      call laws(trim(posed(k)), text_of('data/'//trim(posed(k))//'.nml'), posed(k) /= 'excavator')
   end do
   call laws('gears', gears, .true.)
   do k = 1, size(looped)
      call laws(trim(looped(k)), text_of('data/'//trim(looped(k))//'.nml'), .true.)
      call both_ways(trim(looped(k)), text_of('data/'//trim(looped(k))//'.nml'))
   end do
   call laws('64 dyads', chain_of(64), .true.)
   call both_ways('64 dyads', chain_of(64))
   call both_ways('friction in pins', text_of('data/sketch_four_bar.nml')// &
                  " &FRICTN NFRIC=4, FNAME='A','B','C','D', FMU=4*0.1, FRAD=8.,8.,8.,6. &END")
   ! whichever link of the slide is named first, with the shoe at the piston's pin and beside it
   call both_ways('friction in a guide', guide("'piston'", "'frame'", '0.0'))
   call both_ways('friction in a guide on the piston', guide("'frame'", "'piston'", '136.0'))
   call both_ways('friction in a guide beside the pin', guide("'frame'", "'piston'", '151.0'))
   call rods()
   call names_and_messages()
   call t%report()

contains

   !> A slider-crank with friction in its guide.
   function guide(first, second, x) result(text)
      character(*), intent(in) :: first, second !! links of the slide
      character(*), intent(in) :: x             !! of the middle of the shoe
      character(:), allocatable :: text

      text = 'SLIDER-CRANK'//nl//" &CHAIN JNT='A','B','C', JX=0.0,0.0,136.0, JY=0.0,40.0,10.0, "// &
             "LNAME='frame','crank','rod','piston', LNK='A','A B','B C','C',"//nl// &
             ' NSLIDE=1, SLNK='//first//', SLNK2='//second//', SLX='//x//', SLY=10.0, SLANG=0.0 &END'//nl// &
             " &DRIVES DRIVE='A' &END"//nl//" &OUTPUTS OUTPUT='point C' &END"//nl//' &METHOD IKIN=15 &END'//nl// &
             ' &LIMITS TANGLE=80.0 &END'//nl//" &FRICTN NFRIC=3, FNAME='B','C','S1', FMU=3*0.05, FRAD=5.,5.,40. &END"
   end function guide
end program test_chain_forces
