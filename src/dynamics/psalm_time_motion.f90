!> Motion in time of a mechanism whose drives, or some of them, move freely, by an explicit method of order 8.
!>
!> Unknowns are the free drives, their speeds, and, carried along without a say in the steps, the work that is put in and that is
!> lost: kinetic and potential energy less the one and with the other stay what they were.
module psalm_time_motion
   use psalm_free_motion, only: free_motion_t, free_state_t
   use psalm_kinds, only: wp
   use psalm_ode, only: ode_t, advance, next_step
   implicit none (type, external)
   private
   public :: time_motion_t, begin_motion

   real(wp), parameter :: collapsed = 1.0e-13_wp   !! part of the whole time: no step is shorter
   real(wp), parameter :: creeping = 1.0e-7_wp     !! part of the whole time: so many steps in turn that are shorter,
   integer, parameter :: most_creeping = 200       !! as beside a dead point of a drive, where rounding spoils rates, lead nowhere
   real(wp), parameter :: first_part = 1.0e-3_wp   !! part of the whole time: the first step that is tried
   real(wp), parameter :: least_part = 1.0e-2_wp   !! of the size, or the size over the whole time, or of the largest so far: less
                                                    !! counts as that for errors

   !> A motion and where it is.
   type, extends(ode_t) :: time_motion_t
      type(free_motion_t), allocatable :: motion      !! large: it would fill a small stack
      real(wp), allocatable :: size_of(:)             !! by free drive: what a change counts by, a radian or the size of the linkage
      real(wp) :: end = 0.0_wp                        !! of the whole motion, s
      real(wp), allocatable :: largest(:)             !! shape (2 free drives): co-ordinates and speeds so far
      real(wp) :: time = 0.0_wp
      real(wp), allocatable :: y(:), first(:)         !! unknowns there, and their rates
      real(wp) :: step = 0.0_wp                       !! s: the next that is tried
      integer :: steps = 0
   contains
      procedure :: rates
      procedure :: tolerances
      procedure :: advance_to
      procedure :: observe
      procedure :: work
      procedure :: lost
   end type time_motion_t

contains

   !> Put a motion at time 0. Errors: `valid` is false where there are no accelerations; `moving%motion` says why.
   subroutine begin_motion(speeds, end, tolerance, moving, valid)
      real(wp), intent(in) :: speeds(:)               !! shape (free drives)
      real(wp), intent(in) :: end, tolerance
      class(time_motion_t), intent(inout) :: moving   !! with its motion
      logical, intent(out) :: valid

      moving%end = end
      moving%tolerance = tolerance
      moving%step = first_part*end
      associate (f => size(speeds), link => moving%motion%problem%linkage)
         moving%size_of = merge(max(0.0_wp, maxval(link%length))/link%scale, 1.0_wp, moving%motion%slides(moving%motion%free))
         moving%y = [moving%motion%start(moving%motion%free), speeds, 0.0_wp, 0.0_wp]
         moving%largest = abs(moving%y(:2*f))
         allocate (moving%first(2*f + 2))
      end associate
      call moving%rates(0.0_wp, moving%y, moving%first, valid)
      if (valid) call moving%motion%anchor()
   end subroutine begin_motion

   subroutine rates(self, time, y, d, valid)
      class(time_motion_t), intent(inout) :: self
      real(wp), intent(in) :: time, y(:)
      real(wp), intent(out) :: d(:)
      logical, intent(out) :: valid

      associate (f => size(self%motion%free))
         d(:f) = y(f + 1:2*f)
         call self%motion%accelerate(time, y(:f), y(f + 1:2*f), d(f + 1:2*f), d(2*f + 1), d(2*f + 2), valid)
      end associate
   end subroutine rates

   pure function tolerances(self, y, after) result(allowed)
      class(time_motion_t), intent(in) :: self
      real(wp), intent(in) :: y(:), after(:)
      real(wp) :: allowed(size(y))

      associate (f => size(self%size_of))
         associate (least => least_part*max([self%size_of, self%size_of/self%end], self%largest))
            allowed(:2*f) = self%tolerance*max(abs(y(:2*f)), abs(after(:2*f)), least)
         end associate
         allowed(2*f + 1:) = huge(1.0_wp)
      end associate
   end function tolerances

   !> Go on to a time. `reached` is false where no step that counts keeps the tolerance, or a torsional spring is wound half a
   !> turn; it stands at the time before then, or at that.
   subroutine advance_to(self, target, reached)
      class(time_motion_t), intent(inout) :: self
      real(wp), intent(in) :: target
      logical, intent(out) :: reached
      real(wp) :: after(size(self%y)), taken, error, wanted, shortest
      integer :: short
      logical :: last

      short = 0
      shortest = collapsed*self%end
      do while (self%time < target)
         last = self%step >= (1.0_wp - sqrt(epsilon(1.0_wp)))*(target - self%time)
         wanted = self%step
         if (last) wanted = target - self%time
         call advance(self, self%time, self%y, wanted, shortest, after, taken, error, self%first)
         short = merge(short + 1, 0, taken < creeping*self%end .and. .not. last)
         reached = error <= 1.0_wp .and. short <= most_creeping
         if (.not. reached) return
         last = last .and. taken >= wanted
         ! a step that the end of an interval cut short says nothing against a longer one
         self%step = max(next_step(taken, error), merge(self%step, 0.0_wp, last))
         self%time = merge(target, self%time + taken, last)
         self%y = after
         self%largest = max(self%largest, abs(after(:size(self%largest))))
         self%steps = self%steps + 1
         call self%rates(self%time, self%y, self%first, reached)
         if (.not. reached) return
         call self%motion%anchor()
         reached = self%motion%wound == 0
         if (.not. reached) return
      end do
      reached = .true.
   end subroutine advance_to

   !> Everything where it is.
   subroutine observe(self, state)
      class(time_motion_t), intent(inout) :: self
      type(free_state_t), intent(out) :: state

      associate (f => size(self%motion%free))
         call self%motion%describe(self%time, self%y(:f), self%y(f + 1:2*f), self%first(f + 1:2*f), state)
      end associate
   end subroutine observe

   !> Work of loads, motor and the drives that are not free, J.
   pure real(wp) function work(self)
      class(time_motion_t), intent(in) :: self

      work = self%y(size(self%y) - 1)
   end function work

   !> Work lost in dampers, J.
   pure real(wp) function lost(self)
      class(time_motion_t), intent(in) :: self

      lost = self%y(size(self%y))
   end function lost
end module psalm_time_motion
