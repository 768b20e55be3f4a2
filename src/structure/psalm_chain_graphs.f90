!> Kinematic chains as graphs: links are vertices, joints are edges with a kind; the canonical form by which two are known to be
!> one.
!>
!> A chain of given links and freedom is built from rings by adding paths of links between two links that are there: every graph
!> without a cut vertex is made so. Chains of more than one freedom may also be two chains with one link in common. No part of a
!> chain may be stiff: k links have 3(k-1) - 2j >= 1 freedoms with the j joints between them. A gear pair is an edge, too, between
!> its wheels; it is no joint of the chain. Isomorphs are recognised by a canonical form: links are parted by what joints lead where
!> until nothing more can be distinguished; then one of the smallest part of several is singled out, each in turn, and the least
!> form is taken.
!>
!> Sources: Whitney (1932) for the paths, McKay (1981) for the form, Mruthyunjaya (2003) for the numbers of chains.
module psalm_chain_graphs
   implicit none (type, external)
   private
   public :: chain_graph_t, canonical_form, find_chains
   public :: most_links, form_length, joint_none, joint_pin, joint_slide, joint_driven_pin, joint_driven_slide, joint_gear

   integer, parameter :: most_links = 10
   integer, parameter :: form_length = most_links + (most_links*(most_links - 1))/2

   ! kinds of joints
   integer, parameter :: joint_none = 0, joint_pin = 1, joint_slide = 2, joint_driven_pin = 3, joint_driven_slide = 4
   integer, parameter :: joint_gear = 5         !! the wheels of a gear pair: no joint, but what parts links
   integer, parameter :: joint_kinds = 5

   !> Links, with a colour each, and the joints between them.
   type :: chain_graph_t
      integer :: n = 0
      integer :: joint(most_links, most_links) = joint_none !! symmetrical
      integer :: colour(most_links) = 0
   contains
      procedure :: joints
      procedure :: degree
      procedure :: are_joined
   end type chain_graph_t

contains

   !> Number of joints.
   pure integer function joints(self)
      class(chain_graph_t), intent(in) :: self

      associate (joint => self%joint(:self%n, :self%n))
         joints = count(joint /= joint_none .and. joint /= joint_gear)/2
      end associate
   end function joints

   !> Joints of a link.
   pure integer function degree(self, link)
      class(chain_graph_t), intent(in) :: self
      integer, intent(in) :: link

      associate (joint => self%joint(:self%n, link))
         degree = count(joint /= joint_none .and. joint /= joint_gear)
      end associate
   end function degree

   !> True if a joint connects two links.
   pure logical function are_joined(self, a, b)
      class(chain_graph_t), intent(in) :: self
      integer, intent(in) :: a, b

      are_joined = self%joint(a, b) /= joint_none .and. self%joint(a, b) /= joint_gear
   end function are_joined

   !> True if links among themselves have no freedom left, or less than none. The whole is not looked at.
   pure logical function has_stiff_part(graph)
      type(chain_graph_t), intent(in) :: graph
      integer :: set, k, j, a, b

      has_stiff_part = .true.
      do set = 1, 2**graph%n - 2
         k = popcnt(set)
         if (k < 2) cycle
         j = 0
         do a = 2, graph%n
            if (.not. btest(set, a - 1)) cycle
            do b = 1, a - 1
               if (btest(set, b - 1) .and. graph%joint(a, b) /= joint_none) j = j + 1
            end do
         end do
         if (3*(k - 1) - 2*j < 1) return
      end do
      has_stiff_part = .false.
   end function has_stiff_part

   ! ---- canonical form ----------------------------------------------------------------------------------------------

   !> The same for two graphs if and only if a renumbering of links makes one the other, colours and kinds of joints kept.
   !> `order`, where it is asked for, gives the numbering that leads to it.
   pure function canonical_form(graph) result(form)
      type(chain_graph_t), intent(in) :: graph
      character(form_length) :: form
      integer :: cell(most_links)
      logical :: found

      form = ''
      found = .false.
      cell = 0
      cell(:graph%n) = graph%colour(:graph%n)
      call search(graph, cell, form, found)
   end function canonical_form

   !> Refine and, where links are still alike, single one out.
   pure recursive subroutine search(graph, given, best, found)
      type(chain_graph_t), intent(in) :: graph
      integer, intent(in) :: given(most_links)      !! part of each link; parts have an order
      character(form_length), intent(inout) :: best
      logical, intent(inout) :: found
      character(form_length) :: form
      integer :: cell(most_links), next(most_links), part, k, least, chosen

      cell = given
      call refine(graph, cell)
      least = graph%n + 1
      chosen = 0
      do part = 1, graph%n
         k = count(cell(:graph%n) == part)
         if (k > 1 .and. k < least) then
            least = k
            chosen = part
         end if
      end do
      if (chosen == 0) then
         form = written(graph, cell)
         if (.not. found .or. form < best) best = form
         found = .true.
         return
      end if
      do k = 1, graph%n
         if (cell(k) /= chosen) cycle
         ! it comes before the others of its part
         next = 2*cell
         next(k) = next(k) - 1
         call search(graph, next, best, found)
      end do
   end subroutine search

   !> Part links by the joints that lead to each part, until no part is parted any more. Parts become 1, 2 ... with gaps: a part is
   !> numbered by how many links stand before it.
   pure subroutine refine(graph, cell)
      type(chain_graph_t), intent(in) :: graph
      integer, intent(inout) :: cell(most_links)
      integer :: signature(0:joint_kinds*most_links, most_links), new(most_links), a, b, parts, before

      associate (n => graph%n)
         new(:n) = cell(:n)
         call rank_of(n, reshape(new(:n), [1, n]), cell)
         before = number_of_parts(cell(:n))
         do
            signature = 0
            do a = 1, n
               signature(0, a) = cell(a)
               do b = 1, n
                  if (graph%joint(a, b) == joint_none) cycle
                  associate (entry => signature((graph%joint(a, b) - 1)*most_links + cell(b), a))
                     entry = entry + 1
                  end associate
               end do
            end do
            call rank_of(n, signature(:, :n), cell)
            parts = number_of_parts(cell(:n))
            if (parts == before) return
            before = parts
         end do
      end associate
   end subroutine refine

   pure integer function number_of_parts(cell)
      integer, intent(in) :: cell(:)
      integer :: k

      number_of_parts = count([(.not. any(cell(:k - 1) == cell(k)), k=1, size(cell))])
   end function number_of_parts

   !> Order of columns: 1 and how many are less.
   pure subroutine rank_of(n, columns, rank)
      integer, intent(in) :: n, columns(:, :)
      integer, intent(inout) :: rank(most_links)
      integer :: a, b, row, place(n)

      place = 1
      do a = 1, n
         do b = 1, n
            do row = 1, size(columns, 1)
               if (columns(row, a) == columns(row, b)) cycle
               if (columns(row, b) < columns(row, a)) place(a) = place(a) + 1
               exit
            end do
         end do
      end do
      rank(:n) = place
   end subroutine rank_of

   !> Colours and joints in an order of the links.
   pure function written(graph, place) result(form)
      type(chain_graph_t), intent(in) :: graph
      integer, intent(in) :: place(most_links)      !! of each link
      character(form_length) :: form
      integer, parameter :: zero = iachar('0')
      integer :: link(graph%n), a, b, at

      link(place(:graph%n)) = [(a, a=1, graph%n)]
      form = ''
      at = 0
      do a = 1, graph%n
         at = at + 1
         form(at:at) = achar(zero + graph%colour(link(a)))
         do b = 1, a - 1
            at = at + 1
            form(at:at) = achar(zero + graph%joint(link(a), link(b)))
         end do
      end do
   end function written

   ! ---- chains ------------------------------------------------------------------------------------------------------

   !> All chains with so many links and freedoms and pins only. None where the numbers do not fit.
   pure recursive subroutine find_chains(links, freedom, chains)
      integer, intent(in) :: links, freedom
      type(chain_graph_t), allocatable, intent(out) :: chains(:)
      type(chain_graph_t), allocatable :: before(:), level(:)
      character(form_length), allocatable :: forms(:)
      type(chain_graph_t) :: graph
      integer :: loops, pins, k, a, b, between, g

      allocate (chains(0))
      if (links < 4 .or. links > most_links .or. modulo(3*(links - 1) - freedom, 2) /= 0) return
      pins = (3*(links - 1) - freedom)/2
      loops = pins - links + 1
      if (loops < 1 .or. freedom < 1) return
      allocate (before(0))
      ! rings; a path brings one link for each joint but one
      do k = 4, links
         graph = chain_graph_t()
         graph%n = k
         do a = 1, k
            call join(graph, a, modulo(a, k) + 1)
         end do
         before = [before, graph]
      end do
      do k = 2, loops
         allocate (level(0), forms(0))
         do g = 1, size(before)
            do between = 0, links - before(g)%n
               do a = 2, before(g)%n
                  do b = 1, a - 1
                     graph = before(g)
                     if (between == 0 .and. graph%joint(a, b) /= joint_none) cycle
                     call add_path(graph, a, b, between)
                     call keep_new(graph, level, forms)
                  end do
               end do
            end do
         end do
         call move_alloc(level, before)
         deallocate (forms)
      end do
      do g = 1, size(before)
         if (before(g)%n == links) chains = [chains, before(g)]
      end do
      if (freedom > 1) call add_common_links(links, freedom, chains)
   end subroutine find_chains

   !> Chains that are two with a link in common: their freedoms add up.
   pure recursive subroutine add_common_links(links, freedom, chains)
      integer, intent(in) :: links, freedom
      type(chain_graph_t), allocatable, intent(inout) :: chains(:)
      type(chain_graph_t), allocatable :: one(:), other(:)
      character(form_length), allocatable :: forms(:)
      type(chain_graph_t) :: graph
      integer :: k, f, i, j, a, b

      allocate (forms(0))
      do f = 1, freedom/2
         do k = 4, links - 3
            call find_chains(k, f, one)
            if (size(one) == 0) cycle
            call find_chains(links + 1 - k, freedom - f, other)
            do i = 1, size(one)
               do j = 1, size(other)
                  do a = 1, one(i)%n
                     do b = 1, other(j)%n
                        graph = together(one(i), a, other(j), b)
                        call keep_new(graph, chains, forms)
                     end do
                  end do
               end do
            end do
         end do
      end do
   end subroutine add_common_links

   !> Two chains of which link a of the one is link b of the other.
   pure function together(one, a, other, b) result(graph)
      type(chain_graph_t), intent(in) :: one, other
      integer, intent(in) :: a, b
      type(chain_graph_t) :: graph
      integer :: number(other%n), i

      graph = one
      number = [(one%n + i - merge(1, 0, i > b), i=1, other%n)]
      number(b) = a
      graph%n = one%n + other%n - 1
      do i = 1, other%n
         graph%joint(number, number(i)) = graph%joint(number, number(i)) + other%joint(:other%n, i)
      end do
   end function together

   !> Take a graph in if it has no stiff part, the whole included, and is not there yet.
   pure subroutine keep_new(graph, graphs, forms)
      type(chain_graph_t), intent(in) :: graph
      type(chain_graph_t), allocatable, intent(inout) :: graphs(:)
      character(form_length), allocatable, intent(inout) :: forms(:)
      character(form_length) :: form

      if (3*(graph%n - 1) - 2*graph%joints() < 1) return
      form = canonical_form(graph)
      if (any(forms == form)) return
      if (has_stiff_part(graph)) return
      graphs = [graphs, graph]
      forms = [character(form_length) :: forms, form]
   end subroutine keep_new

   pure subroutine join(graph, a, b)
      type(chain_graph_t), intent(inout) :: graph
      integer, intent(in) :: a, b

      graph%joint(a, b) = joint_pin
      graph%joint(b, a) = joint_pin
   end subroutine join

   !> A path of so many new links from one link to another.
   pure subroutine add_path(graph, a, b, between)
      type(chain_graph_t), intent(inout) :: graph
      integer, intent(in) :: a, b, between
      integer :: k, last

      last = a
      do k = 1, between
         graph%n = graph%n + 1
         call join(graph, last, graph%n)
         last = graph%n
      end do
      call join(graph, last, b)
   end subroutine add_path
end module psalm_chain_graphs
