!> Six-bars that lead a body through five poses: a chain of three revolute joints, and two links that leave it one freedom.
!>
!> The chain - frame, crank, arm, body - is chosen; so all its links have known poses, and those of any of them seen from another
!> are five poses: the dyads of these are all links that can be put between both. A link that was added moves too, and the second
!> one may hang on it. Seven kinds leave one freedom and no rigid part. Each six-bar is followed from the first pose by its crank;
!> it is valid if it comes to all others without a dead point. Source: Soh and McCarthy (2008), Mechanism and Machine Theory 43,
!> 160-170.
module psalm_guided_six_bars
   use psalm_burmester, only: dyads_t, five_poses
   use psalm_kinds, only: wp, pi
   use psalm_linear, only: solve_three
   implicit none (type, external)
   private
   public :: arm_t, guided_t, guided_study_t, place_arm, find_guided, poses_guided, body_names

   integer, parameter :: poses_guided = 5
   integer, parameter :: body_frame = 0, body_crank = 1, body_arm = 2, body_body = 3, body_link = 4 !! the link added first
   character(*), parameter :: body_names(0:4) = [character(5) :: 'frame', 'crank', 'arm', 'body', 'link']
   !> Between which bodies the first and the second link are.
   integer, parameter :: kinds(4, 7) = reshape([ &
      body_frame, body_arm, body_frame, body_body, &
      body_frame, body_arm, body_crank, body_body, &
      body_crank, body_body, body_frame, body_body, &
      body_frame, body_arm, body_link, body_body, &
      body_crank, body_body, body_frame, body_link, &
      body_frame, body_body, body_crank, body_link, &
      body_frame, body_body, body_link, body_arm], [4, 7])
   integer, parameter :: most_joints = 6, most_dyads = 4
   integer, parameter :: freedoms = 3                !! turns of arm, body and first link
   real(wp), parameter :: known_joint = 1.0e-6_wp    !! distance of a dyad from joints that are there, over the size
   real(wp), parameter :: step_of_crank = pi/180.0_wp
   integer, parameter :: most_corrections = 12
   real(wp), parameter :: settled = 1.0e-12_wp, arrived = 1.0e-6_wp !! corrections; distance from a pose, radians
   real(wp), parameter :: fastest_possible = 1.0e3_wp !! turns of a link for one of the crank: a dead point

   !> The chain at all poses, from the reference point in the first one.
   type :: arm_t
      complex(wp) :: a = (0.0_wp, 0.0_wp), b = (0.0_wp, 0.0_wp), c = (0.0_wp, 0.0_wp) !! joints in the first pose
      complex(wp) :: turn(0:3, poses_guided) = (1.0_wp, 0.0_wp)  !! of each body from the first pose
      complex(wp) :: shift(0:3, poses_guided) = (0.0_wp, 0.0_wp) !! a point z of it is at turn z + shift
      integer :: out_of_reach = 0                    !! first pose that the chain does not reach; 0: it reaches all
   end type arm_t

   !> A link and what it is put between, at the first pose.
   type :: added_link_t
      integer :: from = 0, to = 0                    !! bodies
      complex(wp) :: pivot = (0.0_wp, 0.0_wp), pin = (0.0_wp, 0.0_wp) !! its joints with them
   end type added_link_t

   type :: guided_t
      type(added_link_t) :: links(2)
      logical :: valid = .false.                     !! it comes from the first pose to all others
      real(wp) :: fastest = 0.0_wp                   !! greatest turn of a link for one of the crank, on the way
      real(wp) :: longest = 0.0_wp                   !! distance of two joints of a link, over the size of the path
      real(wp) :: crank(poses_guided) = 0.0_wp       !! its angle from the first pose, radians
   end type guided_t

   type :: guided_study_t
      integer :: pairs = 0                           !! six-bars
      integer :: valid = 0
      type(guided_t), allocatable :: list(:)         !! ranked
   end type guided_study_t

contains

   !> Place a chain at five poses, with the elbow on the side where it is in the first one.
   pure subroutine place_arm(d, g, a, b, c, arm)
      complex(wp), intent(in) :: d(4), g(4)          !! poses from the first
      complex(wp), intent(in) :: a, b, c             !! joints from the reference point in the first pose
      type(arm_t), intent(out) :: arm
      complex(wp) :: end_point, elbow, along
      real(wp) :: first, second, reach, share, height
      integer :: j

      arm%a = a
      arm%b = b
      arm%c = c
      first = abs(b - a)
      second = abs(c - b)
      do j = 2, poses_guided
         arm%turn(body_body, j) = 1.0_wp + g(j - 1)
         arm%shift(body_body, j) = d(j - 1)
         end_point = d(j - 1) + (1.0_wp + g(j - 1))*c
         reach = abs(end_point - a)
         if (.not. (reach < first + second .and. reach > abs(first - second))) then
            arm%out_of_reach = j
            return
         end if
         along = (end_point - a)/reach
         share = (first**2 - second**2 + reach**2)/(2.0_wp*reach)
         height = sqrt(max((first - share)*(first + share), 0.0_wp))
         height = sign(height, aimag(conjg(c - a)*(b - a)))
         elbow = a + along*cmplx(share, height, wp)
         arm%turn(body_crank, j) = (elbow - a)/(b - a)
         arm%shift(body_crank, j) = a - arm%turn(body_crank, j)*a
         arm%turn(body_arm, j) = (end_point - elbow)/(c - b)
         arm%shift(body_arm, j) = elbow - arm%turn(body_arm, j)*b
      end do
   end subroutine place_arm

   !> All six-bars of a chain, ranked: the valid ones first, then by the fastest link.
   pure subroutine find_guided(arm, size_of_path, most, found)
      type(arm_t), intent(in) :: arm                 !! that reaches all poses
      real(wp), intent(in) :: size_of_path
      integer, intent(in) :: most                    !! kept
      type(guided_study_t), intent(out) :: found
      type(guided_t) :: one
      type(added_link_t) :: first(most_dyads), second(most_dyads)
      complex(wp) :: turn(0:4, poses_guided), shift(0:4, poses_guided)
      complex(wp) :: from, to
      integer :: kind, i, k, j, n, m

      allocate (found%list(0))
      turn(:3, :) = arm%turn
      shift(:3, :) = arm%shift
      do kind = 1, size(kinds, 2)
         call links_between(arm, turn, shift, kinds(1, kind), kinds(2, kind), [added_link_t ::], size_of_path, first, n)
         do i = 1, n
            do j = 1, poses_guided
               from = turn(first(i)%from, j)*first(i)%pivot + shift(first(i)%from, j)
               to = turn(first(i)%to, j)*first(i)%pin + shift(first(i)%to, j)
               turn(body_link, j) = (to - from)/(first(i)%pin - first(i)%pivot)
               shift(body_link, j) = from - turn(body_link, j)*first(i)%pivot
            end do
            call links_between(arm, turn, shift, kinds(3, kind), kinds(4, kind), first(i:i), size_of_path, second, m)
            do k = 1, m
               one = guided_t(links=[first(i), second(k)])
               found%pairs = found%pairs + 1
               call assess(arm, turn, size_of_path, one)
               if (one%valid) found%valid = found%valid + 1
               call keep(one, most, found%list)
            end do
         end do
      end do
   end subroutine find_guided

   !> All links between two bodies, without those that are there: two joints that a third body has with both.
   pure subroutine links_between(arm, turn, shift, from, to, added, size_of_path, links, n)
      type(arm_t), intent(in) :: arm
      complex(wp), intent(in) :: turn(0:, :), shift(0:, :) !! of all bodies, shape (0:4, poses)
      integer, intent(in) :: from, to
      type(added_link_t), intent(in) :: added(:)     !! the first link, if it is there
      real(wp), intent(in) :: size_of_path
      type(added_link_t), intent(out) :: links(most_dyads)
      integer, intent(out) :: n
      integer :: joint_of(2, most_joints), joints, i, k, p
      complex(wp) :: place(most_joints), seen(poses_guided), turned(poses_guided)
      type(dyads_t) :: dyads
      logical :: is_there

      joint_of(:, 1:3) = reshape([body_frame, body_crank, body_crank, body_arm, body_arm, body_body], [2, 3])
      place(1:3) = [arm%a, arm%b, arm%c]
      joints = 3
      do i = 1, size(added)
         joint_of(:, joints + 1) = [added(i)%from, body_link]
         joint_of(:, joints + 2) = [added(i)%to, body_link]
         place(joints + 1:joints + 2) = [added(i)%pivot, added(i)%pin]
         joints = joints + 2
      end do
      turned = turn(to, :)/turn(from, :)
      seen = (shift(to, :) - shift(from, :))/turn(from, :)
      n = 0
      call five_poses(seen(2:), turned(2:) - 1.0_wp, dyads)
      if (dyads%degenerate) return
      do k = 1, dyads%count
         associate (dyad => dyads%list(k))
            is_there = abs(dyad%pivot - dyad%pin) < known_joint*size_of_path
            do i = 1, joints
               do p = 1, joints
                  if (.not. (any(joint_of(:, i) == from) .and. any(joint_of(:, p) == to))) cycle
                  if (other(joint_of(:, i), from) /= other(joint_of(:, p), to)) cycle
                  is_there = is_there .or. abs(dyad%pivot - place(i)) + abs(dyad%pin - place(p)) < known_joint*size_of_path
               end do
            end do
            if (is_there) cycle
            n = n + 1
            links(n) = added_link_t(from=from, to=to, pivot=dyad%pivot, pin=dyad%pin)
         end associate
      end do

   contains

      !> The other body of a joint.
      pure integer function other(bodies, own)
         integer, intent(in) :: bodies(2), own

         other = merge(bodies(2), bodies(1), bodies(1) == own)
      end function other
   end subroutine links_between

   ! ---- following -----------------------------------------------------------------------------------------------------

   !> Follow a six-bar by its crank from the first pose to the others.
   pure subroutine assess(arm, turn, size_of_path, one)
      type(arm_t), intent(in) :: arm
      complex(wp), intent(in) :: turn(0:, :)         !! wanted of all bodies, shape (0:4, poses)
      real(wp), intent(in) :: size_of_path
      type(guided_t), intent(inout) :: one
      complex(wp) :: e(0:4)
      real(wp) :: way, theta, rate(freedoms)
      integer :: j, k, steps
      logical :: closes

      one%longest = maxval([abs(arm%b - arm%a), abs(arm%c - arm%b), abs(one%links%pin - one%links%pivot), &
                            abs(one%links%pivot), abs(one%links%pin)])/size_of_path
      one%crank(1) = 0.0_wp
      do j = 2, poses_guided
         associate (relative => turn(body_crank, j)*conjg(turn(body_crank, j - 1)))
            one%crank(j) = one%crank(j - 1) + atan2(aimag(relative), real(relative, wp))
         end associate
      end do
      e = (1.0_wp, 0.0_wp)
      one%valid = .false.
      call correct(arm, one, e, rate, closes)
      if (.not. closes) return
      one%fastest = maxval(abs(rate))
      do j = 2, poses_guided
         way = one%crank(j) - one%crank(j - 1)
         steps = max(1, ceiling(abs(way)/step_of_crank))
         do k = 1, steps
            theta = way/real(steps, wp)
            e(body_arm:) = e(body_arm:)*cmplx(cos(rate*theta), sin(rate*theta), wp)
            theta = one%crank(j - 1) + way*real(k, wp)/real(steps, wp)
            e(body_crank) = cmplx(cos(theta), sin(theta), wp)
            call correct(arm, one, e, rate, closes)
            if (.not. closes) return
            one%fastest = max(one%fastest, maxval(abs(rate)))
            if (one%fastest > fastest_possible) return
         end do
         if (maxval(abs(e(body_arm:) - turn(body_arm:, j))) > arrived) return
      end do
      one%valid = .true.
   end subroutine assess

   !> Newton's method for the turns at a crank angle; rates of the turns by that of the crank.
   pure subroutine correct(arm, one, e, rate, closes)
      type(arm_t), intent(in) :: arm
      type(guided_t), intent(in) :: one
      complex(wp), intent(inout) :: e(0:4)           !! turns of all bodies
      real(wp), intent(out) :: rate(freedoms)
      logical, intent(out) :: closes
      real(wp) :: f(freedoms), matrix(freedoms, 0:freedoms), change(freedoms)
      integer :: k

      rate = 0.0_wp
      do k = 1, most_corrections
         call equations(arm, one, e, f, matrix)
         call solve_three(matrix(:, 1:), f, change, closes)
         if (.not. closes) return
         closes = maxval(abs(change)) < 1.0_wp
         if (.not. closes) return
         e(body_arm:) = e(body_arm:)*cmplx(cos(change), -sin(change), wp)
         closes = maxval(abs(change)) < settled
         if (closes) exit
      end do
      if (.not. closes) return
      call equations(arm, one, e, f, matrix)
      call solve_three(matrix(:, 1:), -matrix(:, 0), rate, closes)
   end subroutine correct

   !> The ends of the first link lie on it, those of the second keep their distance; derivatives by the turns of crank, arm, body
   !> and first link.
   pure subroutine equations(arm, one, e, f, matrix)
      type(arm_t), intent(in) :: arm
      type(guided_t), intent(in) :: one
      complex(wp), intent(in) :: e(0:4)
      real(wp), intent(out) :: f(freedoms), matrix(freedoms, 0:freedoms)
      complex(wp) :: away, by(0:freedoms), from, to, from_by(0:freedoms), to_by(0:freedoms)

      associate (first => one%links(1), second => one%links(2))
         call point(first%from, first%pivot, from, from_by)
         call point(first%to, first%pin, to, to_by)
         away = to - from - e(body_link)*(first%pin - first%pivot)
         by = to_by - from_by
         by(freedoms) = by(freedoms) - (0.0_wp, 1.0_wp)*e(body_link)*(first%pin - first%pivot)
         f(:2) = [real(away, wp), aimag(away)]
         matrix(1, :) = real(by, wp)
         matrix(2, :) = aimag(by)
         call point(second%from, second%pivot, from, from_by)
         call point(second%to, second%pin, to, to_by)
         away = to - from
         f(3) = 0.5_wp*(abs(away)**2 - abs(second%pin - second%pivot)**2)
         matrix(3, :) = real(conjg(away)*(to_by - from_by), wp)
      end associate

   contains

      !> Place of a point of a body, and its derivatives.
      pure subroutine point(body, z, place, by_turn)
         integer, intent(in) :: body
         complex(wp), intent(in) :: z
         complex(wp), intent(out) :: place, by_turn(0:freedoms)
         complex(wp), parameter :: i = (0.0_wp, 1.0_wp)
         complex(wp) :: arms(0:freedoms)             !! by what each turn carries it

         arms = (0.0_wp, 0.0_wp)
         place = z
         select case (body)
         case (body_link)
            ! it hangs on what its pivot is on
            call carry(one%links(1)%from, one%links(1)%pivot, arms)
            arms(3) = e(body_link)*(z - one%links(1)%pivot)
            place = arm%a
            if (one%links(1)%from == body_frame) place = one%links(1)%pivot
            place = place + sum(arms)
         case (body_frame)
            continue
         case default
            call carry(body, z, arms)
            place = arm%a + sum(arms)
         end select
         by_turn = i*arms
      end subroutine point

      !> From pivot a along the chain to a point of one of its bodies.
      pure subroutine carry(body, z, arms)
         integer, intent(in) :: body
         complex(wp), intent(in) :: z
         complex(wp), intent(inout) :: arms(0:freedoms)

         select case (body)
         case (body_crank)
            arms(0) = e(body_crank)*(z - arm%a)
         case (body_arm)
            arms(0) = e(body_crank)*(arm%b - arm%a)
            arms(1) = e(body_arm)*(z - arm%b)
         case (body_body)
            arms(0) = e(body_crank)*(arm%b - arm%a)
            arms(1) = e(body_arm)*(arm%c - arm%b)
            arms(2) = e(body_body)*(z - arm%c)
         end select
      end subroutine carry
   end subroutine equations

   !> Put a six-bar into the list of the best.
   pure subroutine keep(one, most, list)
      type(guided_t), intent(in) :: one
      integer, intent(in) :: most
      type(guided_t), allocatable, intent(inout) :: list(:)
      integer :: place, n

      place = 1
      do while (place <= size(list))
         if (goes_before(one, list(place))) exit
         place = place + 1
      end do
      if (place > most) return
      n = min(size(list) + 1, most)
      list = [list(:place - 1), one, list(place:n - 1)]

   contains

      pure logical function goes_before(first, second)
         type(guided_t), intent(in) :: first, second

         if (first%valid .neqv. second%valid) then
            goes_before = first%valid
         else
            goes_before = first%valid .and. first%fastest < second%fastest
         end if
      end function goes_before
   end subroutine keep
end module psalm_guided_six_bars
