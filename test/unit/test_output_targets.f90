!> Desired values, derivatives and ratios of several outputs of a sketch: their changes with every variable against differences of
!> the values, the values against the sketch solved in poses, and what a known linkage does found again.
program test_output_targets
   use check, only: checks_t
   use poses, only: read_in_poses
   use psalm_cases, only: read_case_text
   use psalm_chain_study, only: chain_study_t, study_chain
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_error, only: problem_t, make_problem
   use psalm_kinds, only: wp
   use psalm_output_targets, only: output_targets_t, prepare_output_targets, find_output_targets, differentiate_output_targets
   use psalm_preparation, only: prepared_t, prepare
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_synthesis, only: synthesis_t, synthesise
   use psalm_text, only: to_text
   implicit none (type, external)
   character(*), parameter :: nl = new_line('a')
   character(*), parameter :: three = ' &METHOD NDES=3, DELT=-12.0,-15.0,-20.0'
   !> Stephenson's second six-bar driven in its five-bar loop: a larger group.
   character(*), parameter :: six_bar = " &CHAIN JNT='A','B','C','D','E','F','G', JX=0.0,0.0,40.0,80.0,45.0,85.0,100.0,"//nl// &
      " JY=0.0,30.0,60.0,55.0,30.0,20.0,0.0, LNAME='frame','crank','left','top','right','tie',"//nl// &
      " LNK='A G','A B','B C E','C D','D F G','E F', VARY='A B','C D','E F','B C','place G','input' &END"//nl// &
      " &DRIVES DRIVE='A' &END"//nl
   !> A four-bar whose coupler point stands off its arc and may move.
   character(*), parameter :: four_bar = " &CHAIN JNT='A','B','C','D','P', JX=0.0,-4.0,33.0,90.0,20.0,"//nl// &
      " JY=0.0,31.0,82.0,5.0,95.0, LNAME='frame','crank','coupler','rocker', LNK='A D','A B','B C P','C D',"//nl// &
      " VARY='A B','B C','C D','B P','angle B C B P','place D','input' &END &DRIVES DRIVE='A' &END"//nl
   !> A slider-crank driven by its slide, with a wheel on the frame that the coupler's wheel drives.
   character(*), parameter :: slider = " &CHAIN JNT='S','B','A', JX=90.0,20.0,0.0, JY=10.0,35.0,0.0, "// &
      "LNAME='frame','piston','rod','crank',"//nl//" LNK='A','S','S B','B A', NSLIDE=1, SLNK='piston', SLNK2='frame', "// &
      "SLX=90.0, SLY=10.0, SLANG=0.0,"//nl// &
      " VARY='S B','A B' &END &DRIVES DRIVE='S1', DBASE='frame' &END"//nl
   type(checks_t) :: t

   call changes('six-bar', six_bar//" &OUTPUTS OUTPUT='point D','angle G D','distance B F','y E','ratio y_E distance_B_F',"//nl// &
                ' DES1=6*0.0, DES2=3*0.0, DES3=3*1.0, DES5=3*0.0, DVEL1=6*1.0, DVEL2=3*0.1, DVEL3=3*0.0, DACC1=6*0.0,'//nl// &
                ' DACC2=3*0.0, DACC3=3*1.0, WVEL1=2.0 &END'//nl//three//' &END'//nl)
   call changes('coupler point', four_bar//" &OUTPUTS OUTPUT='point P','distance P D','angle B P','between A B C D',"// &
                "'pose P coupler','ratio distance_P_D angle_B_P',"//nl// &
                ' DES1=6*1.0, DES2=3*1.0, DVEL2=3*1.0, DACC2=3*1.0, DVEL3=3*1.0, DACC3=3*1.0, DVEL4=3*0.0, DACC4=3*0.0,'//nl// &
                ' DES5=9*0.0, DVEL5=9*1.0, DACC5=9*0.0, DES6=3*1.0 &END'//nl//three//' &END'//nl)
   call changes('a first output that is none of the loops', four_bar//" &OUTPUTS OUTPUT='x P','y D','x C','ratio x_P x_C',"//nl// &
                ' DES1=3*1.0, DVEL1=3*1.0, DACC1=3*1.0, DES4=3*2.0 &END'//nl//three//' &END'//nl)
   call changes('driven by a slide', slider//" &OUTPUTS OUTPUT='point B','angle A B','distance B','slide S1',"//nl// &
                ' DVEL1=6*1.0, DACC1=6*1.0, DES2=3*1.0, DVEL2=3*1.0, DACC2=3*1.0, DVEL3=3*1.0, DACC3=3*1.0, DVEL4=3*1.0 &END'// &
                nl//' &METHOD NDES=3, DELT=-2.0,1.0,3.0 &END'//nl)
   call ratio_found_again()
   call t%report()

contains

   subroutine load(text, set, problem, dimensions)
      character(*), intent(in) :: text
      type(data_set_t), intent(out) :: set
      type(problem_t), intent(out) :: problem
      type(dimensions_t), intent(out) :: dimensions
      type(data_set_t), allocatable :: sets(:)
      type(diagnostics_t) :: findings
      class(prepared_t), allocatable :: prepared
      type(line_t) :: none(0)

      allocate (prepared)
      call read_case_text(text, 'test', sets, findings, 'psalm')
      call t%is_true(.not. findings%failed(), 'is read: '//text(:index(text, nl) - 1))
      if (findings%failed()) return
      set = sets(1)
      call t%is_true(.not. allocated(set%search_in_poses), 'is searched by loops: '//set%title)
      call prepare(set, none, prepared, findings)
      call t%is_true(.not. findings%failed(), 'is prepared: '//set%title)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem)
      dimensions = prepared%given
   end subroutine load

   subroutine changes(title, text)
      character(*), intent(in) :: title, text
      class(data_set_t), allocatable :: set, posed
      class(problem_t), allocatable :: problem
      type(dimensions_t) :: dimensions
      type(output_targets_t) :: targets
      type(diagnostics_t) :: findings
      class(chain_study_t), allocatable :: witness
      real(wp), allocatable :: x(:), slope(:, :), at(:, :, :), size_of(:)
      real(wp), parameter :: h = 1.0e-3_wp, steps(4) = [2.0_wp, 1.0_wp, -1.0_wp, -2.0_wp]
      integer :: v, k, which

      allocate (set, posed, problem, witness)
      call load(title//nl//text//" &LIMITS TANGLE=89.0, TOGGLE=0.0 &END"//nl, set, problem, dimensions)
      if (.not. allocated(problem%target_values)) then
         call t%is_true(.false., title//': has targets')
         return
      end if
      call prepare_output_targets(set, problem, .false., .true., targets)
      x = problem%parameters%first_values(problem%given)
      call differentiate_output_targets(targets, dimensions)
      call t%is_true(all(targets%exists), title//': all exist')
      call t%is_true(any(targets%order == 2) .and. any(targets%order == 1), title//': derivatives are wanted')
      ! the witness: poses, at the drawing
      call read_in_poses(title//nl//text, posed, findings)
      call study_chain(posed, 1.0_wp, 0.0_wp, witness)
      call t%is_true(all(witness%closed), title//': the witness reaches all positions')
      do k = 1, size(targets%number)
         which = findloc([(trim(witness%names(v)) == plain(targets%names(k)), v=1, size(witness%names))], .true., dim=1)
         call t%is_true(which > 0, title//': the witness knows '//trim(targets%names(k)))
         if (which == 0) cycle
         associate (own => targets%actual(:, k), other => witness%values(which, targets%order(k), :))
            call t%is_true(all(abs(modulo(own - other + 180.0_wp, 360.0_wp) - 180.0_wp) <= 1.0e-9_wp*max(100.0_wp, abs(own)) .or. &
                               abs(own - other) <= 1.0e-9_wp*max(1.0_wp, abs(own))), &
                           title//': as in poses: '//trim(targets%names(k)))
         end associate
      end do
      ! central differences of the fourth order
      allocate (at(size(targets%miss, 1), size(targets%miss, 2), size(steps)))
      do v = 1, size(x)
         do k = 1, size(steps)
            x(v) = x(v) + steps(k)*h
            call problem%parameters%apply(x, dimensions)
            call find_output_targets(targets, dimensions)
            at(:, :, k) = targets%actual
            x(v) = x(v) - steps(k)*h
         end do
         slope = (8.0_wp*(at(:, :, 2) - at(:, :, 3)) - (at(:, :, 1) - at(:, :, 4)))/(12.0_wp*h)
         call problem%parameters%apply(x, dimensions)
         size_of = [(max(1.0_wp, maxval(abs(targets%by(:, :, k)))), k=1, size(targets%by, 3))]
         do k = 1, size(size_of)
            call t%close_to(maxval(abs(slope(:, k) - targets%by(:, v, k)))/size_of(k), 0.0_wp, 1.0e-7_wp, &
                            title//': variable '//to_text(v)//' changes '//trim(targets%names(k)))
         end do
      end do
   end subroutine changes

   !> The name of a number without the order of its derivative.
   pure function plain(name) result(text)
      character(*), intent(in) :: name
      character(:), allocatable :: text

      text = trim(name)
      if (index(text, ' (') > 0) text = text(:index(text, ' (') - 1)
   end function plain

   !> A bicycle's rear suspension: the leverage that a rocker of another length gives is asked for, and that rocker is found.
   subroutine ratio_found_again()
      character(*), parameter :: chain = " &CHAIN JNT='M','H','K','R','W','L','S', JX=0.0,-370.0,-75.0,-20.0,-430.0,20.0,"// &
                 "-130.0,"//nl//" JY=40.0,5.0,345.0,330.0,20.0,300.0,190.0, LNAME='frame','chainstay','seatstay','rocker',"//nl// &
                 " LNK='M R S','M H','H K W','R K L', VARY='R K','H K'", &
                                 rest = " &DRIVES DRIVE='M' &END"//nl//" &OUTPUTS OUTPUT='y W','distance S L',"// &
                "'ratio rise shock',"//nl//" ONAME='rise','shock','leverage'", &
                                 method = ' &METHOD NDES=5, DELT=0.0,-3.0,-6.0,-9.0,-12.0 &END'//nl
      class(data_set_t), allocatable :: set
      class(problem_t), allocatable :: problem
      type(dimensions_t) :: dimensions
      type(output_targets_t) :: targets
      class(synthesis_t), allocatable :: synthesis
      type(stop_t) :: stop
      character(200) :: row

      allocate (set, problem, synthesis)
      call load('AS IT IS'//nl//chain//" &END"//nl//rest//', DES3=5*1.0 &END'//nl//method, set, problem, dimensions)
      if (.not. allocated(problem%target_values)) return
      call prepare_output_targets(set, problem, .false., .false., targets)
      ! another rocker and another seat stay than those drawn
      call problem%parameters%apply(problem%parameters%first_values(problem%given)*[1.03_wp, 0.99_wp], dimensions)
      call find_output_targets(targets, dimensions)
      call t%is_true(all(targets%exists), 'the leverage of another rocker is known')
      write (row, '(5(f0.12,","))') targets%actual(:, 1)
      call load('ANOTHER'//nl//chain//" &END"//nl//rest//', DES3='//trim(row)//' &END'//nl//" &SEARCH SOLVER='LSQ' &END"//nl// &
                method//' &LIMITS TANGLE=89.0, TOGGLE=0.0 &END'//nl, set, problem, dimensions)
      if (.not. allocated(problem%target_values)) return
      call synthesise(set, reshape([real(wp) ::], [0, 0]), problem, 1, stop, dimensions, synthesis)
      call t%is_true(size(synthesis%found%best) > 0, 'a leverage is found')
      if (size(synthesis%found%best) == 0) return
      call t%is_true(synthesis%found%best(1)%objective < 1.0e-12_wp, 'the leverage asked for')
   end subroutine ratio_found_again
end program test_output_targets
