!> The group TIME: motion in time of a machine whose drives, or some of them, move freely.
module psalm_time_group
   use psalm_case_group, only: case_group_t, surroundings_t
   use psalm_data_set, only: data_set_t
   use psalm_group, only: group_t, out_of, required
   use psalm_kinds, only: wp
   use psalm_link_place, only: refuse_unless
   use psalm_rule, only: rule_t, a_flag, a_number, a_text, a_whole
   use psalm_sketch, only: sketch_t
   use psalm_status, only: diagnostics_t
   use psalm_take, only: take, take_count
   use psalm_text, only: lower_case, to_text
   implicit none (type, external)
   private
   public :: time_items
   public :: time_group_t, time_of

   integer, parameter :: most_intervals = 100000

   type, extends(case_group_t) :: time_group_t
      real(wp), allocatable :: times(:)           !! TEND and NTIME, or TAT: s, ascending, the first 0
      logical, allocatable :: free(:)             !! FREE, by drive of a sketch; not allocated: all are free
      integer, allocatable :: started(:)          !! VNAME: drives, in the order of `rates`; not allocated: the free ones
      real(wp), allocatable :: rates(:)           !! VSTART: rad/s or lengths a second at time 0
      real(wp) :: tolerance = 1.0e-13_wp          !! TTOL
      integer :: events = 10000                   !! NEVENT
      integer :: steps = 300000                   !! NTSTEP
      logical :: stiff = .false.                  !! ISTIFF
      logical :: equilibria = .false.             !! IEQUIL
      integer :: starts = 100                     !! NSTART
   contains
      procedure :: read => read_time
   end type time_group_t

   !> The items of the group.
   type(rule_t), parameter :: time_items(*) = [ &
      rule_t('TEND', a_number, '', 's', 'the last of TAT', '(0,)', &
             'the end of the motion, which begins at 0 in the drawing (drives with RATIO: at their PHASE), with &LINKS at the '// &
             'reference position'), &
      rule_t('NTIME', a_whole, '', '', '100', '[1,100000]', &
             'results at so many even intervals of the time'), &
      rule_t('NTAT', a_whole, '', '', 'as many as TAT has', '[0,100000]', &
             'in place of NTIME: number of times'), &
      rule_t('TAT', a_number, 'NTAT', 's', '', '(0,)', &
             'the times of the results, in ascending order; 0 need not be given'), &
      rule_t('FREE', a_text, 'n', '', 'all drives', '', &
             'names of the drives of &DRIVES that move freely; the others have the speeds and accelerations of '// &
             '&RATES (the first) and DSPEED, DACCEL; ''all'': every one, ''none'': no drive'), &
      rule_t('NVSTRT', a_whole, '', '', 'as many as VSTART has', '[0,1000]', &
             'number of speeds at time 0'), &
      rule_t('VNAME', a_text, 'n', '', 'the free drives', '', &
             'names of the free drives whose speeds at time 0 are given; the others start from rest'), &
      rule_t('VSTART', a_number, 'NVSTRT', 'rad/s, length/s', '0', '', &
             'their speeds at time 0'), &
      rule_t('TTOL', a_number, '', '', '1E-13', '[1E-14,1E-3]', &
             'relative error of places and speeds that is allowed in a step'), &
      rule_t('NEVENT', a_whole, '', '', '10000', '[1,1000000]', &
             'the motion ends after so many events: impacts, others of &STOPS, change points'), &
      rule_t('NTSTEP', a_whole, '', '', '300000', '[1,2000000000]', &
             'the motion ends after so many steps of the method'), &
      rule_t('ISTIFF', a_flag, '', '', '0', '0 1', &
             '1: the method for strong dampers, CVODE of SUNDIALS'), &
      rule_t('IEQUIL', a_flag, '', '', '0', '0 1', &
             '1: equilibrium positions and small oscillations about them; TEND may be left out then'), &
      rule_t('NSTART', a_whole, '', '', '100', '[0,100000]', &
             'equilibria of several free drives: searches besides that from the drawing')]

contains

   !> Read the group. Errors: times that do not ascend, names that are no free drives, a name given twice.
   subroutine read_time_group(group, sketch, own, findings)
      type(group_t), intent(inout) :: group
      type(sketch_t), intent(in) :: sketch
      type(time_group_t), intent(inout) :: own
      type(diagnostics_t), intent(inout) :: findings
      character(:), allocatable :: free(:), started(:)
      real(wp) :: end
      integer :: intervals, times, rates, last, k

      own%given = group%line > 0
      call group%follow(time_items)
      end = 0.0_wp
      call take(group, 'TEND', end, findings)
      call take(group, 'NTIME', intervals, findings)
      intervals = max(1, min(intervals, most_intervals))   ! what is beyond is an error already
      call take_count(group, 'NTAT', times, findings)
      allocate (own%times(times), source=0.0_wp)
      call take(group, 'TAT', own%times, findings, last=last)
      call group%get_texts('FREE', free, findings)
      call take_count(group, 'NVSTRT', rates, findings)
      call group%get_texts('VNAME', started, findings)
      allocate (own%rates(rates), source=0.0_wp)
      call take(group, 'VSTART', own%rates, findings)
      call take(group, 'TTOL', own%tolerance, findings)
      call take(group, 'NEVENT', own%events, findings)
      call take(group, 'NTSTEP', own%steps, findings)
      call take(group, 'ISTIFF', own%stiff, findings)
      call take(group, 'IEQUIL', own%equilibria, findings)
      call take(group, 'NSTART', own%starts, findings)
      if (.not. own%given) return
      if (own%equilibria .and. times == 0 .and. .not. group%given('TEND')) then
         own%times = [0.0_wp]
         if (group%given('NTIME')) call out_of(group, 'NTIME', 'without TEND there is no motion; leave NTIME out, or give TEND', &
                                               findings)
      else if (times == 0 .and. .not. group%given('TEND')) then
         call required(group, 'TEND', 'the end of the motion, or the times TAT of the results, must be given')
      else if (last < times) then
         call out_of(group, 'NTAT', to_text(times)//' times are announced, but only '//to_text(last)//' given', findings)
      else if (times > 0) then
         if (group%given('NTIME')) call out_of(group, 'NTIME', 'TAT gives the times of the results; give one of both', findings)
         if (times > 1) call refuse_unless([.true., own%times(2:) > own%times(:times - 1)], group, 'TAT', 'times must ascend', &
                                           findings)
         if (group%given('TEND') .and. abs(end - own%times(times)) > 0.0_wp) call out_of(group, 'TEND', &
            'the results end with the last of TAT; leave TEND out, or let TAT end there', findings)
         own%times = [0.0_wp, own%times]
      else
         own%times = [(end*(real(k, wp)/real(intervals, wp)), k=0, intervals)]
      end if
      call read_free()
      call read_started()

   contains

      !> Which drives move freely.
      subroutine read_free()
         integer :: i, d

         if (.not. sketch%given) then
            if (size(free) > 0) call out_of(group, 'FREE', 'drives have names in a sketch (&CHAIN) only; the input of a '// &
                                            'linkage by &LINKS is free', findings, 1)
            return
         end if
         if (size(free) == 0) return
         if (size(free) == 1) then
            if (lower_case(trim(adjustl(free(1)))) == 'all') return
         end if
         allocate (own%free(size(sketch%drives)), source=.false.)
         if (size(free) == 1) then
            if (lower_case(trim(adjustl(free(1)))) == 'none') return
         end if
         do i = 1, size(free)
            d = drive_called(free(i))
            if (d == 0) then
               call out_of(group, 'FREE', "there is no drive '"//trim(adjustl(free(i)))//"' in &DRIVES", findings, i)
            else if (sketch%drives(d)%geared) then
               call out_of(group, 'FREE', 'drive '//trim(sketch%drives(d)%name)//' follows the first by its RATIO; '// &
                           'name the first', findings, i)
            else if (own%free(d)) then
               call out_of(group, 'FREE', 'drive '//trim(sketch%drives(d)%name)//' is named twice', findings, i)
            else
               own%free(d) = .true.
            end if
         end do
      end subroutine read_free

      !> Which of them have a speed at time 0.
      subroutine read_started()
         integer :: i, d

         if (size(started) == 0) return
         if (.not. sketch%given) then
            call out_of(group, 'VNAME', 'drives have names in a sketch (&CHAIN) only; VSTART is the speed of the input', &
                        findings, 1)
            return
         end if
         if (size(started) /= rates) then
            call out_of(group, 'VNAME', to_text(size(started))//' drives are named, but VSTART has '//to_text(rates)//' speeds', &
                        findings)
            return
         end if
         allocate (own%started(rates), source=0)
         do i = 1, rates
            d = drive_called(started(i))
            own%started(i) = d
            if (d == 0) then
               call out_of(group, 'VNAME', "there is no drive '"//trim(adjustl(started(i)))//"' in &DRIVES", findings, i)
            else if (any(own%started(:i - 1) == d)) then
               call out_of(group, 'VNAME', 'drive '//trim(sketch%drives(d)%name)//' is named twice', findings, i)
            else if (sketch%drives(d)%geared) then
               call out_of(group, 'VNAME', 'drive '//trim(sketch%drives(d)%name)//' follows the first by its RATIO; '// &
                           'name the first', findings, i)
            else if (allocated(own%free)) then
               if (.not. own%free(d)) call out_of(group, 'VNAME', 'drive '//trim(sketch%drives(d)%name)// &
                                                  ' is not free (FREE): its speed is that of &RATES or DSPEED', findings, i)
            end if
         end do
      end subroutine read_started

      !> Number of the drive of that name; 0: there is none.
      pure integer function drive_called(name)
         character(*), intent(in) :: name

         do drive_called = size(sketch%drives), 1, -1
            if (sketch%drive_label(drive_called) == trim(adjustl(name))) return
         end do
      end function drive_called
   end subroutine read_time_group

   !> The group as the case has it.
   subroutine read_time(self, group, about, findings)
      class(time_group_t), intent(inout) :: self
      type(group_t), intent(inout) :: group
      class(surroundings_t), intent(in) :: about
      type(diagnostics_t), intent(inout) :: findings

      call read_time_group(group, about%sketch, self, findings)
   end subroutine read_time

   !> The group TIME of a case; as it is by default where the case does not have it.
   pure function time_of(set) result(time)
      class(data_set_t), intent(in) :: set
      type(time_group_t) :: time
      integer :: k

      k = set%place_of('TIME')
      if (k == 0) return
      select type (group => set%sections(k)%group)
      type is (time_group_t)
         time = group
      end select
   end function time_of
end module psalm_time_group
