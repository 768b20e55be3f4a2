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
   ! three links on a pin that two loops come to by frame arcs of their own, in both orders of writing
   call both_ways('three links on a slide''s pin', shared_pin("'frame','L1','L2','L3','L4','L5'", &
                                                              "'','B','B C','C','C D','D'", 'L3', 'L4'))
   call both_ways('the same, written the other way', shared_pin("'frame','L5','L4','L3','L2','L1'", &
                                                                "'','D','C D','C','B C','B'", 'L2', 'L4'))
   call rods()
   call names_and_messages()
   call t%report()

contains

   !> Two links between slides of the frame, one of them driven, and a third on their pin with a slide of its own.
   function shared_pin(names, joints, one, two) result(text)
      character(*), intent(in) :: names, joints !! LNAME and LNK
      character(*), intent(in) :: one, two      !! links with friction on the pin
      character(:), allocatable :: text

      text = 'THREE LINKS ON A PIN'//nl//" &CHAIN JNT='B','C','D', JX=-29.86,50.551,-54.812, JY=48.163,-79.51,-12.478, "// &
             'LNAME='//names//', LNK='//joints//','//nl//" SNAME='S1','S2','S3', SLNK='L1','frame','frame', "// &
             "SLNK2='frame','L3','L5',"//nl//' SLX=97.095,59.244,-76.156, SLY=-13.629,-13.857,-48.959, '// &
             'SLANG=-120.0,-124.001,-166.369 &END'//nl//" &DRIVES DRIVE='S1', DBASE='frame', DLINK='L1' &END"//nl// &
             " &OUTPUTS OUTPUT='point D' &END"//nl//' &METHOD NDES=4, DELT=-1.5,0.0,0.5,1.7 &END'//nl// &
             ' &LIMITS TANGLE=90.0 &END'//nl//" &FRICTN NFRIC=2, FNAME='C "//one//"','C "//two//"', FMU=2*0.1, "// &
             'FRAD=1.0,2.0 &END'
   end function shared_pin

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
