!> Every eight-bar chain of simple joints: how many there are, their inversions, and what Assur groups they fall into.
!>
!> The chains are enumerated here as graphs, links for vertices and joints for edges; freedom is found by counting links
!> and joints
!> of all their parts. The library finds freedom by pebbles and groups by payment, so that the counts are an independent route.
!> Published: 16 chains, 71 inversions (Oldham 1977, chapter 3, and the literature it names).
program test_eight_bars
   use check, only: checks_t
   use psalm_assur_order, only: assur_order_t, find_assur_groups
   use psalm_freedom, only: freedom_t, find_freedom
   use psalm_sketch, only: sketch_t, drive_turns
   implicit none (type, external)
   integer, parameter :: links = 8, joints = 10, capacity = 20, most_permutations = 1440
   type(checks_t) :: t
   logical :: chains(links, links, capacity)         !! which links are joined
   integer :: found, i, k, inversions, without_four_bar, without_dyads
   integer :: on_frame(3), anywhere(3)           !! classes of frame and drive: dyads only, a group of four, one of six
   integer :: on_frame_before, anywhere_before
   integer, parameter :: wanted_on_frame(3) = [69, 52, 32], wanted_anywhere(3) = [144, 206, 225]
   integer :: walks(4, capacity)                     !! closed walks of 4 to 7 steps: chains that differ in them are different

   found = 0
   call enumerate([3, 3, 3, 3, 2, 2, 2, 2])
   call enumerate([4, 3, 3, 2, 2, 2, 2, 2])
   call enumerate([4, 4, 2, 2, 2, 2, 2, 2])
   call t%equal_integer(found, 16, 'eight-bar chains')
   inversions = 0
   without_four_bar = 0
   without_dyads = 0
   on_frame = 0
   anywhere = 0
   do i = 1, found
      if (.not. has_four_bar(chains(:, :, i))) without_four_bar = without_four_bar + 1
      on_frame_before = on_frame(1)
      anywhere_before = anywhere(1)
      call count_classes(chains(:, :, i), inversions, on_frame, anywhere)
      if (on_frame(1) == on_frame_before .and. anywhere(1) == anywhere_before) without_dyads = without_dyads + 1
   end do
   call t%equal_integer(inversions, 71, 'inversions')
   call t%equal_integer(without_four_bar, 1, 'chains without a loop of four links')
   call t%equal_integer(without_dyads, 4, 'chains that cannot be built from dyads')
   do k = 1, 3
      call t%equal_integer(on_frame(k), wanted_on_frame(k), 'drive on the frame: classes by their largest group')
      call t%equal_integer(anywhere(k), wanted_anywhere(k), 'drive anywhere: classes by their largest group')
   end do
   call t%report()

contains

   !> All chains in which links have so many joints; new ones are added to the list.
   subroutine enumerate(degrees)
      integer, intent(in) :: degrees(links)
      logical :: joined(links, links)
      integer :: orders(links, most_permutations), kinds, order(links)

      kinds = 0
      order = 0
      call permute(degrees, 1, order, orders, kinds)
      joined = .false.
      call join_next(degrees, 1, 2, joined, orders(:, :kinds))
   end subroutine enumerate

   !> Renumberings that leave the numbers of joints as they are.
   recursive subroutine permute(degrees, n, order, orders, kinds)
      integer, intent(in) :: degrees(links), n
      integer, intent(inout) :: order(links), orders(links, most_permutations), kinds
      integer :: k

      if (n > links) then
         kinds = kinds + 1
         orders(:, kinds) = order
         return
      end if
      do k = 1, links
         if (degrees(k) /= degrees(n) .or. any(order(:n - 1) == k)) cycle
         order(n) = k
         call permute(degrees, n + 1, order, orders, kinds)
      end do
   end subroutine permute

   !> Decide whether links a and b are joined, and go on.
   recursive subroutine join_next(degrees, a, b, joined, orders)
      integer, intent(in) :: degrees(links), a, b
      logical, intent(inout) :: joined(links, links)
      integer, intent(in) :: orders(:, :)

      if (b > links) then
         if (count(joined(:, a)) /= degrees(a)) return
         if (a == links) then
            call take(joined, orders)
         else
            call join_next(degrees, a + 1, a + 2, joined, orders)
         end if
         return
      end if
      if (count(joined(:, a)) < degrees(a) .and. count(joined(:, b)) < degrees(b)) then
         joined(a, b) = .true.
         joined(b, a) = .true.
         call join_next(degrees, a, b + 1, joined, orders)
         joined(a, b) = .false.
         joined(b, a) = .false.
      end if
      if (count(joined(:, a)) + links - b >= degrees(a)) call join_next(degrees, a, b + 1, joined, orders)
   end subroutine join_next

   !> Add a chain unless it is there under other numbers, or a part of it is rigid.
   subroutine take(joined, orders)
      logical, intent(in) :: joined(links, links)
      integer, intent(in) :: orders(:, :)
      type(freedom_t) :: freedom
      integer :: p, c, many, mask(links), own_walks(4)
      logical :: rigid, braced

      ! links of two joints may be numbered by those of more joints that they hang on
      many = count(count(joined, dim=1) > 2)
      mask = matmul([(2**p, p=0, many - 1)], merge(1, 0, joined(:many, :)))
      if (any(mask(many + 1:links - 1) < mask(many + 2:))) return
      rigid = has_rigid_part(joined)
      own_walks = walks_of(joined)
      do c = 1, found
         if (any(walks(:, c) /= own_walks)) cycle
         do p = 1, size(orders, 2)
            if (all(chains(orders(:, p), orders(:, p), c) .eqv. joined)) return
         end do
      end do
      ! in a rigid part a drive moves nothing
      braced = .false.
      do p = 1, links
         do c = p + 1, links
            if (.not. joined(p, c)) cycle
            freedom = find_freedom(drawn(joined, 1, p, c))
            braced = braced .or. size(freedom%braced) > 0
         end do
      end do
      if (rigid .neqv. braced) call t%is_true(.false., 'pebbles find the rigid parts that counting finds')
      if (rigid) return
      found = found + 1
      chains(:, :, found) = joined
      walks(:, found) = own_walks
   end subroutine take

   !> Numbers of closed walks of 4 to 7 steps.
   pure function walks_of(joined) result(number)
      logical, intent(in) :: joined(links, links)
      integer :: number(4), power(links, links), once(links, links), k, n

      once = merge(1, 0, joined)
      power = matmul(once, matmul(once, once))
      do k = 1, 4
         power = matmul(power, once)
         number(k) = sum([(power(n, n), n=1, links)])
      end do
   end function walks_of

   !> A part of n links is rigid if it has at least (3 n - 3)/2 joints.
   pure logical function has_rigid_part(joined)
      logical, intent(in) :: joined(links, links)
      integer :: subset, k
      logical :: inside(links)

      has_rigid_part = .true.
      do subset = 1, 2**links - 2
         inside = [(btest(subset, k), k=0, links - 1)]
         if (count(inside) < 2) cycle
         if (count(joined .and. spread(inside, 1, links) .and. spread(inside, 2, links)) >= 3*(count(inside) - 1)) return
      end do
      has_rigid_part = .false.
   end function has_rigid_part

   pure logical function has_four_bar(joined)
      logical, intent(in) :: joined(links, links)
      integer :: a, b

      has_four_bar = .true.
      do a = 1, links
         do b = a + 1, links
            if (count(joined(:, a) .and. joined(:, b)) > 1) return
         end do
      end do
      has_four_bar = .false.
   end function has_four_bar

   !> Frames that differ, and frames with a driven joint that differ, by their largest Assur group.
   subroutine count_classes(joined, frames, near, any_pair)
      logical, intent(in) :: joined(links, links)
      integer, intent(inout) :: frames, near(3), any_pair(3)
      integer :: orders(links, most_permutations), kinds, order(links), f, a, b, p, size_of
      integer :: degrees(links)
      type(assur_order_t) :: groups
      integer, allocatable :: kept(:)
      logical :: first

      degrees = count(joined, dim=1)
      kinds = 0
      order = 0
      call permute(degrees, 1, order, orders, kinds)
      kept = pack([(p, p=1, kinds)], [(all(joined(orders(:, p), orders(:, p)) .eqv. joined), p=1, kinds)])
      do f = 1, links
         if (all([(orders(f, kept(p)) >= f, p=1, size(kept))])) frames = frames + 1
         do a = 1, links
            do b = a + 1, links
               if (.not. joined(a, b)) cycle
               first = .true.
               do p = 1, size(kept)
                  associate (image => orders(:, kept(p)))
                     if (number_of(image(f), image(a), image(b)) < number_of(f, a, b)) first = .false.
                  end associate
                  if (.not. first) exit
               end do
               if (.not. first) cycle
               groups = find_assur_groups(drawn(joined, f, a, b))
               if (.not. groups%valid) then
                  call t%is_true(.false., 'a chain with one drive is determined')
                  cycle
               end if
               size_of = maxval(groups%groups%order)/2
               any_pair(size_of) = any_pair(size_of) + 1
               if (f == a .or. f == b) near(size_of) = near(size_of) + 1
            end do
         end do
      end do
   end subroutine count_classes

   !> A number for a frame and a pair of links.
   pure integer function number_of(frame, a, b)
      integer, intent(in) :: frame, a, b

      number_of = (frame*(links + 1) + min(a, b))*(links + 1) + max(a, b)
   end function number_of

   !> The chain with link `frame` first, driven where links `a` and `b` meet.
   function drawn(joined, frame, a, b) result(sketch)
      logical, intent(in) :: joined(links, links)
      integer, intent(in) :: frame, a, b
      type(sketch_t) :: sketch
      integer :: place(links), n, p, q

      place = [(n, n=1, links)]
      place(1) = frame
      place(frame) = 1
      allocate (sketch%joint_name(joints), sketch%links(links), sketch%slides(0), sketch%gears(0), sketch%drives(1))
      do p = 1, links
         allocate (sketch%links(p)%joints(0))
      end do
      n = 0
      do p = 1, links
         do q = p + 1, links
            if (.not. joined(p, q)) cycle
            n = n + 1
            sketch%joint_name(n) = achar(iachar('A') + n - 1)
            sketch%links(place(p))%joints = [sketch%links(place(p))%joints, n]
            sketch%links(place(q))%joints = [sketch%links(place(q))%joints, n]
            if ((p == a .and. q == b) .or. (p == b .and. q == a)) sketch%drives(1)%joint = n
         end do
      end do
      sketch%drives(1)%kind = drive_turns
      sketch%drives(1)%base = place(a)
      sketch%drives(1)%link = place(b)
   end function drawn
end program test_eight_bars
