!> Searches over sketches by their loops: the drawing on device 7 is the linkage found, and the optimum is the one found in poses.
program test_redraw
   use check, only: checks_t
   use poses, only: read_in_poses
   use psalm_analysis, only: analysis_t, wanted_t, analyse_linkage => analyse
   use psalm_cases, only: read_case_text
   use psalm_chain_synthesis, only: chain_synthesis_t, synthesise_chain
   use psalm_data_set, only: data_set_t
   use psalm_data_set_text, only: write_data_set
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp
   use psalm_preparation, only: prepared_t, prepare
   use psalm_sketch_text, only: variant_t, variant_of
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_synthesis, only: synthesis_t, synthesise
   use psalm_text, only: text_t
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: lsq = " &SEARCH SOLVER='LSQ' &END"//nl, simplex = '', &
                              turn = ' &METHOD NDES=6, DELT=0.0,20.0,40.0,60.0,80.0,100.0', &
                              limits = " &LIMITS TANGLE=89.0, TOGGLE=0.0 &END"//nl
   !> Stephenson's third six-bar, driven by its rod: one group of four links.
   character(*), parameter :: six_bar = " &CHAIN JNT='A','B','C','D','P','E','F', JX=0.0,-25.0,35.0,75.0,10.0,120.0,127.0,"//nl// &
      " JY=0.0,45.0,55.0,0.0,80.0,70.0,74.0, LNAME='frame','left','coupler','rocker','rod','crank',"//nl// &
      " LNK='A D F','A B','B C P','C D','P E','E F',"//nl
   !> Its rocker is a block on a line of the frame.
   character(*), parameter :: sliding = " &CHAIN JNT='A','B','C','P','E','F', JX=0.0,-25.0,35.0,10.0,120.0,127.0,"//nl// &
      " JY=0.0,45.0,55.0,80.0,70.0,74.0, LNAME='frame','left','coupler','block','rod','crank',"//nl// &
      " LNK='A F','A B','B C P','C','P E','E F', NSLIDE=1, SNAME='S', SLNK='frame', SLNK2='block', SLX=50.0, "//nl// &
      ' SLY=60.4596, SLANG=20.0,'//nl
   !> Cranks on the frame, the second geared to the first.
   character(*), parameter :: five_bar = " &CHAIN JNT='A','B','C','G','E', JX=0.0,3.0,40.0,85.0,80.0,"//nl// &
      " JY=0.0,50.0,90.0,49.0,0.0, LNK='A E','A B','B C','C G','G E',"//nl
   character(*), parameter :: second_crank = " &DRIVES DRIVE='A','E', RATIO=0.0,0.5, PHASE=0.0,10.0 &END"//nl
   character(*), parameter :: four_bar = " &CHAIN JNT='A','B','C','D','P','Q', JX=0.0,-4.0,33.0,90.0,20.0,-30.0,"//nl// &
      " JY=0.0,31.0,82.0,5.0,95.0,12.0, LNAME='frame','crank','coupler','rocker', LNK='A D Q','A B','B C P','C D',"//nl
   !> The same six-bar driven at its first rocker: two dyads and three joints of the frame.
   character(*), parameter :: by_left = " &DRIVES DRIVE='A' &END"//nl, by_rod = " &DRIVES DRIVE='F' &END"//nl
   character(*), parameter :: slow = ' &METHOD NDES=6, DELT=0.0,-1.0,-2.0,-3.0,-4.0,-5.0'
   type(checks_t) :: t

   call both_ways('six-bar, lengths', six_bar, "'E F','B C','P E'", by_rod, 'point P', turn, &
                  '10.00,11.28,13.21,15.53,17.90,20.02', '80.00,80.84,82.02,83.30,84.47,85.39')
   call both_ways('six-bar, places and angles', six_bar, "'place A','place D','B P','angle B C B P','input'", by_rod, 'point P', &
                  turn, '10.00,11.28,13.21,15.53,17.90,20.02', '80.00,80.84,82.02,83.30,84.47,85.39')
   call both_ways('block in a larger group', sliding, "'A B','B C','P E','E F'", by_rod, 'point P', turn, &
                  '9.80,11.20,13.30,15.60,17.90,20.02', '80.20,80.90,82.02,83.30,84.47,85.39')
   call both_ways('geared five-bar', five_bar, "'A B','B C','C G','place E'", second_crank, 'point C', turn, &
                  '41.0,28.0,14.6,2.4,-7.6,-14.6', '91.0,92.0,90.0,84.5,76.0,66.0')
   call both_ways('six-bar of dyads, the place of a joint', six_bar, "'place D','A B'", by_left, 'point E', slow, &
                  '120.0,120.5674,121.1452,121.7326,122.3293,122.9356', '70.0,69.1398,68.4573,67.8964,67.4285,67.0372')
   call read_back('simplex', six_bar, "'E F','B C'", by_rod, 'point P', ' &METHOD NITER=500'//turn(9:), simplex, &
                  '10.00,11.28,13.21,15.53,17.90,20.02', '80.00,80.84,82.02,83.30,84.47,85.39')
   call read_back('four-bar, a point of the frame beside', four_bar, "'A B','B C','C D','B P','angle B C B P','place D'", by_left, &
                  'point P', turn, lsq, '21.0,12.0,3.0,-5.0,-10.0,-12.0', '92.0,96.0,95.0,89.0,80.0,70.0')
   call several_outputs('six-bar', six_bar, "'E F','B C','P E','place D'", by_rod, &
                        "'point P','distance P D','between A B D C','x C'", &
                        '10.0,80.0,11.3,80.8,13.2,82.0,15.5,83.3,17.9,84.4,20.0,85.4', &
                        '103.2,102.7,101.8,100.5,98.9,97.4', '7.0,6.8,6.3,5.5,4.3,2.9', '35.5,37.2,39.4,41.8,44.0,45.7')
   call several_outputs('block in a larger group', sliding, "'A B','B C','P E','E F'", by_rod, &
                        "'point P','slide S','y C'", &
                        '10.0,80.0,11.3,80.8,13.2,82.0,15.5,83.3,17.9,84.4,20.0,85.4', &
                        '0.5,1.5,4.0,6.5,9.0,11.0', '55.1,55.7,56.6,57.5,58.3,58.9')
   call several_outputs('four-bar, beside its arcs', four_bar, "'A B','B C','C D','B P','angle B C B P'", by_left, &
                        "'point P','distance P D','angle D P'", '21.0,93.0,12.0,95.0,4.0,93.0,-3.0,88.0,-8.0,80.0,-11.0,70.0', &
                        '112.0,119.0,122.5,125.0,124.5,120.0', '128.0,131.0,134.5,138.0,143.0,147.0')
   call further_outputs('no target for the first', six_bar, "'E F','B C','P E'", by_rod, &
                        "'point P','angle D C', DES2=126.0,123.0,120.0,117.5,115.0,113.0")
   call further_outputs('no output of the loops first', six_bar, "'E F','B C','P E'", by_rod, &
                        "'between A B D C','x C', DES1=7.0,6.8,6.3,5.5,4.3,2.9, DES2=35.5,37.2,39.4,41.8,44.0,45.7")
   call further_outputs('a slide first', sliding, "'A B','B C','P E','E F'", by_rod, &
                        "'slide S','y P', DES1=0.5,1.5,4.0,6.5,9.0,11.0, DES2=80.0,80.8,82.0,83.3,84.4,85.4")
   call further_outputs('poses of a link', four_bar, "'A B','B C','C D'", by_left, "'pose P coupler', DES1=21.0,92.0,50.0,"// &
                        '12.0,96.0,49.0,3.0,95.0,48.0,-5.0,89.0,49.0,-9.0,80.0,51.0,-11.5,70.0,54.0')
   call desired_travel()
   call pose_of_a_link()
   call open_at_its_drawing()
   call t%report()

contains

   !> Search by loops; the data set that device 7 would have, and the objective.
   subroutine search(name, text, set, seven, objective)
      character(*), intent(in) :: name, text
      type(data_set_t), intent(out) :: set
      character(:), allocatable, intent(out) :: seven
      real(wp), intent(out) :: objective
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      class(synthesis_t), allocatable :: result
      type(dimensions_t) :: dimensions
      class(analysis_t), allocatable :: analysis
      type(variant_t) :: variant
      type(text_t) :: written
      type(line_t) :: none(0)
      type(stop_t) :: stop

      allocate (prepared, result, analysis)
      seven = ''
      objective = huge(1.0_wp)
      call read_case_text(text, 'test', sets, findings, 'psalm')
      set = sets(1)
      call t%is_true(.not. findings%failed() .and. .not. allocated(set%search_in_poses), name//': by loops')
      if (findings%failed() .or. allocated(set%search_in_poses)) return
      call prepare(set, none, prepared, findings)
      allocate (problem)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      dimensions = prepared%given
      call synthesise(set, prepared%vertices, problem, 1, stop, dimensions, result)
      call analyse_linkage(set, problem, dimensions, wanted_t(), analysis)
      objective = analysis%motion%total
      variant = variant_of(set)
      if (size(result%found%best) > 0) variant%delt = result%found%best(1)%delt
      call write_data_set(set, problem, dimensions, written, variant)
      seven = written%content()
   end subroutine search

   !> The objective of a case as it stands.
   subroutine analyse(name, text, set, objective)
      character(*), intent(in) :: name, text
      type(data_set_t), intent(out) :: set
      real(wp), intent(out) :: objective
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      class(prepared_t), allocatable :: prepared
      class(problem_t), allocatable :: problem
      class(analysis_t), allocatable :: analysis
      type(line_t) :: none(0)

      allocate (prepared, analysis)
      objective = huge(1.0_wp)
      call read_case_text(text, 'device 7', sets, findings, 'psalm')
      call t%is_true(.not. findings%failed(), name//': device 7 is read')
      if (findings%failed()) return
      set = sets(1)
      call prepare(set, none, prepared, findings)
      allocate (problem)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      call analyse_linkage(set, problem, prepared%given, wanted_t(), analysis)
      call t%is_true(all(analysis%motion%closed), name//': the drawing of device 7 comes to all positions')
      objective = analysis%motion%total
   end subroutine analyse

   !> What device 7 has is what was found.
   subroutine read_back(name, chain, vary, drives, output, method, solver, x, y, objective)
      character(*), intent(in) :: name, chain, vary, drives, output, method, solver, x, y
      real(wp), intent(out), optional :: objective
      class(data_set_t), allocatable :: set, again
      character(:), allocatable :: seven
      real(wp) :: found, read

      allocate (set, again)
      call search(name, 'SEARCH'//nl//chain//' VARY='//vary//' &END'//nl//drives//" &OUTPUTS OUTPUT='"//output//"' &END"//nl// &
                  solver//method//', DESX='//x//', DESY='//y//' &END'//nl//limits, set, seven, found)
      if (present(objective)) objective = found
      if (len(seven) == 0) return
      call analyse(name, seven, again, read)
      call t%close_to(read, found, 1.0e-9_wp, name//': the objective of device 7 is that of the search')
      call stays(name, set, again)
   end subroutine read_back

   !> Joints of the frame whose places do not vary stay to the bit.
   subroutine stays(name, set, again)
      character(*), intent(in) :: name
      type(data_set_t), intent(in) :: set, again
      integer :: j, k
      logical :: varies

      do j = 1, size(set%sketch%joint_name)
         if (.not. set%sketch%has_joint(1, j)) cycle
         varies = any([(set%sketch%variations(k)%joints(1) == j .and. set%sketch%variations(k)%joints(2) == 0, &
                        k=1, size(set%sketch%variations))])
         if (varies) cycle
         call t%is_true(.not. (abs(again%sketch%x(j) - set%sketch%x(j)) > 0.0_wp .or. &
                               abs(again%sketch%y(j) - set%sketch%y(j)) > 0.0_wp), &
                        name//': joint '//trim(set%sketch%joint_name(j))//' of the frame stays')
      end do
   end subroutine stays

   !> The same search by loops and in poses.
   subroutine both_ways(name, chain, vary, drives, output, method, x, y)
      character(*), intent(in) :: name, chain, vary, drives, output, method, x, y
      class(data_set_t), allocatable :: in_poses
      type(diagnostics_t) :: findings
      class(chain_synthesis_t), allocatable :: poses
      type(stop_t) :: stop
      real(wp) :: found

      allocate (in_poses, poses)
      call read_back(name, chain, vary, drives, output, method, lsq, x, y, found)
      call read_in_poses('POSES'//nl//chain//' VARY='//vary//' &END'//nl//drives//" &OUTPUTS OUTPUT='"//output// &
                         "' &END"//nl//lsq//method//', DESX='//x//', DESY='//y//' &END'//nl//limits, in_poses, findings)
      call synthesise_chain(in_poses, 1, stop, poses, findings)
      call t%equal_integer(size(poses%best), 1, name//': found in poses')
      if (size(poses%best) == 0) return
      call t%close_to(found, poses%best(1)%objective, 1.0e-6_wp, name//': the optimum is the same by loops and in poses')
      call t%is_true(found < 0.9_wp*poses%first_objective, name//': better than what was given')
   end subroutine both_ways

   !> Values of several outputs: read back, and the same in poses; with few positions first and with free inputs, too.
   subroutine several_outputs(name, chain, vary, drives, outputs, first, second, third, fourth)
      character(*), intent(in) :: name, chain, vary, drives, outputs, first, second, third
      character(*), intent(in), optional :: fourth
      class(data_set_t), allocatable :: in_poses
      class(data_set_t), allocatable :: set, again
      type(diagnostics_t) :: findings
      class(chain_synthesis_t), allocatable :: poses
      type(stop_t) :: stop
      character(:), allocatable :: targets, seven
      real(wp) :: found, read, other

      allocate (in_poses, set, again, poses)
      targets = ' &OUTPUTS OUTPUT='//outputs//', DES1='//first//','//nl//' DES2='//second//', WGT2=0.5, DES3='//third
      if (present(fourth)) targets = targets//', DES4='//fourth
      targets = drives//targets//' &END'//nl
      call search(name//', outputs', 'OUTPUTS'//nl//chain//' VARY='//vary//' &END'//nl//targets//lsq//turn//' &END'//nl//limits, &
                  set, seven, found)
      if (len(seven) == 0) return
      call analyse(name//', outputs', seven, again, read)
      call t%close_to(read, found, 1.0e-9_wp, name//', outputs: the objective of device 7 is that of the search')
      call read_in_poses('POSES'//nl//chain//' VARY='//vary//' &END'//nl//targets//lsq//turn//' &END'//nl//limits, in_poses, &
                         findings)
      call synthesise_chain(in_poses, 1, stop, poses, findings)
      call t%equal_integer(size(poses%best), 1, name//', outputs: found in poses')
      if (size(poses%best) == 0) return
      call t%close_to(found, poses%best(1)%objective, 1.0e-6_wp, name//', outputs: the optimum is the same by loops and in poses')
      call search(name//', stages', 'STAGES'//nl//chain//' VARY='//vary//' &END'//nl//targets//" &SEARCH SOLVER='LSQ', NFEW=2, "// &
                  'NSTART=3 &END'//nl//turn//' &END'//nl//limits, set, seven, other)
      call t%is_true(other < found*(1.0_wp + 1.0e-6_wp), name//', outputs: few positions first lead there, too')
      call search(name//', free', 'FREE'//nl//chain//' VARY='//vary//' &END'//nl//targets//lsq//turn//', IFREE=1 &END'//nl// &
                  limits, &
                  set, seven, other)
      call t%is_true(other < found, name//', outputs: free inputs come nearer')
      call analyse(name//', free', seven, again, read)
      call t%close_to(read, other, 1.0e-9_wp, name//', free: the objective of device 7 is that of the search')
   end subroutine several_outputs

   !> Desired values of outputs, none of which is that of the loops.
   subroutine further_outputs(name, chain, vary, drives, outputs)
      character(*), intent(in) :: name, chain, vary, drives, outputs
      class(data_set_t), allocatable :: in_poses
      class(data_set_t), allocatable :: set, again
      type(diagnostics_t) :: findings
      class(chain_synthesis_t), allocatable :: poses
      type(stop_t) :: stop
      character(:), allocatable :: rest, seven
      real(wp) :: found, read

      allocate (in_poses, set, again, poses)
      rest = ' VARY='//vary//' &END'//nl//drives//' &OUTPUTS OUTPUT='//outputs//' &END'//nl//lsq//turn//' &END'//nl//limits
      call search(name, 'FURTHER'//nl//chain//rest, set, seven, found)
      if (len(seven) == 0) return
      call analyse(name, seven, again, read)
      call t%close_to(read, found, 1.0e-9_wp, name//': the objective of device 7 is that of the search')
      call read_in_poses('POSES'//nl//chain//rest, in_poses, findings)
      call synthesise_chain(in_poses, 1, stop, poses, findings)
      call t%equal_integer(size(poses%best), 1, name//': found in poses')
      if (size(poses%best) == 0) return
      call t%close_to(found, poses%best(1)%objective, 1.0e-6_wp, name//': the optimum is the same by loops and in poses')
      call t%is_true(found < 0.9_wp*poses%first_objective, name//': better than what was given')
   end subroutine further_outputs

   !> Desired values of &METHOD for a slide of a larger group are its travel, whichever of its links is named first.
   subroutine desired_travel()
      class(data_set_t), allocatable :: set, again
      character(*), parameter :: rest = ' SLY=60.4596, SLANG=20.0,'//nl//" VARY='A B','B C','P E' &END"//nl//by_rod// &
                                 " &OUTPUTS OUTPUT='slide S' &END"//nl//lsq//turn//', DESANG='
      character(:), allocatable :: seven, head
      real(wp) :: found, other, read

      allocate (set, again)
      head = 'TRAVEL'//nl//sliding(:index(sliding, ' SLY=') - 1)
      call search('travel', head//rest//'0.5,1.5,4.0,6.5,9.0,11.0 &END'//nl//limits, set, seven, found)
      call analyse('travel', seven, again, read)
      call t%close_to(read, found, 1.0e-9_wp, 'travel: the objective of device 7 is that of the search')
      head = head(:index(head, 'SLNK=') - 1)//"SLNK='block', SLNK2='frame', SLX=50.0, "//nl
      call search('travel', head//rest//'-0.5,-1.5,-4.0,-6.5,-9.0,-11.0 &END'//nl//limits, set, seven, other)
      call t%close_to(other, found, 1.0e-8_wp, 'travel: the other way round')
      call analyse('travel', seven, again, read)
      call t%close_to(read, other, 1.0e-9_wp, 'travel: the objective of device 7 is that of the search the other way round')
   end subroutine desired_travel

   !> Place and direction of a link.
   subroutine pose_of_a_link()
      class(data_set_t), allocatable :: set, again
      character(:), allocatable :: seven
      real(wp) :: found, read

      allocate (set, again)
      call search('pose', 'POSE'//nl//six_bar//" VARY='E F','B C','P E','B P' &END"//nl//by_rod// &
                  " &OUTPUTS OUTPUT='pose P coupler' &END"//nl//lsq//turn//', DESX=9.5,11.0,13.2,15.5,18.0,20.0,'//nl// &
                  ' DESY=80.0,80.8,82.0,83.3,84.5,85.4, DESANG=-45.0,-44.6,-44.0,-43.3,-42.6,-42.0 &END'//nl//limits, &
                  set, seven, found)
      if (len(seven) == 0) return
      call analyse('pose', seven, again, read)
      call t%close_to(read, found, 1.0e-9_wp, 'pose: the objective of device 7 is that of the search')
   end subroutine pose_of_a_link

   !> What is found does not close where the given linkage was drawn: it is drawn at the nearest input of the case.
   subroutine open_at_its_drawing()
      class(data_set_t), allocatable :: set, again
      character(:), allocatable :: seven
      real(wp) :: found, read

      allocate (set, again)
      call search('drawn elsewhere', 'ELSEWHERE'//nl//four_bar//" VARY='C D' &END"//nl//by_left// &
                  " &OUTPUTS OUTPUT='point P' &END"//nl//lsq//' &METHOD NDES=5, DELT=-60.0,-65.0,-70.0,-75.0,-80.0,'//nl// &
                  ' DESX=84.1138,84.3096,84.1532,83.6203,82.6949, DESY=53.0144,53.0453,52.9887,52.8579,52.6557 &END'//nl// &
                  limits, set, seven, found)
      if (len(seven) == 0) return
      call t%is_true(found < 1.0e-6_wp, 'drawn elsewhere: a linkage is found that does not close at its reference input')
      call analyse('drawn elsewhere', seven, again, read)
      call t%close_to(read, found, 1.0e-9_wp, 'drawn elsewhere: the objective of device 7 is that of the search')
      call t%close_to(again%method%crnki, 60.0_wp, 1.0e-9_wp, 'drawn elsewhere: CRNKI tells where')
   end subroutine open_at_its_drawing
end program test_redraw
