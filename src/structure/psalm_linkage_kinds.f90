!> Kinds of linkages by enumeration: chains, which link is the frame, what drives it, which link has the output, which pins are
!> slides.
!>
!> Two linkages are of one kind if their links can be renumbered so that joints, frame, drive and output agree. Left out are
!> kinds with links that do not move the output, and with outputs that a simpler kind has (a point on a crank or rocker). Pins
!> become slides where links can still turn against each other: in every loop two joints at least stay pins.
!>
!> A chain of two freedoms with a gear pair has one, too. The wheels are two links that are pinned to a third, the arm. No other
!> link is pinned to both (the four would be stiff), so two wheels have one arm.
module psalm_linkage_kinds
   use psalm_chain_graphs, only: chain_graph_t, canonical_form, find_chains, form_length, most_links, joint_none, joint_pin, &
                                 joint_slide, joint_driven_pin, joint_driven_slide, joint_gear
   use psalm_kinds, only: wp
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: linkage_kind_t, wanted_kinds_t, find_kinds, ratios_of
   public :: kind_of_angle, kind_of_pose

   ! what the output is
   integer, parameter :: kind_of_point = 1, kind_of_angle = 2, kind_of_pose = 3
   ! what drives
   integer, parameter :: driven_by_crank = 1       !! a link on the frame turns
   integer, parameter :: driven_by_cylinder = 2    !! a slide between two links that have a pin each otherwise

   integer, parameter :: colour_frame = 1, colour_output = 2
   integer, parameter :: name_length = 48

   ! Turns of the driven wheel by those of the driver, seen from the arm. Whole numbers: where the driver comes back after a turn of
   ! the crank, so does the driven wheel. Not 1: the wheels would stay parallel. Two wheels of one group drive each other.
   real(wp), parameter :: ratios(*) = [-1.0_wp, -2.0_wp, 2.0_wp]
   real(wp), parameter :: ratios_in_group(*) = [-1.0_wp, -2.0_wp, 2.0_wp, -0.5_wp, 0.5_wp]

   !> What kinds are wanted.
   type :: wanted_kinds_t
      integer, allocatable :: links(:)
      integer :: slides(2) = 0                     !! least and most, the driven one left out
      integer :: gears(2) = 0                      !! pairs, least and most: 0 or 1
      integer :: drive = driven_by_crank
      integer :: output = kind_of_point
      integer :: largest_group = 2                 !! links of an Assur group at most
   end type wanted_kinds_t

   !> One kind.
   type :: linkage_kind_t
      type(chain_graph_t) :: graph
      integer :: frame = 0, base = 0, driven = 0   !! links; the drive moves `driven` against `base`
      integer :: output = 0                        !! the link that has it
      integer :: slides = 0                        !! not driven
      integer :: wheels(2) = 0, arm = 0            !! of its gear pair: links; 0: it has none. The first drives the second
      logical :: wheels_in_group = .false.         !! both belong to one Assur group
      integer :: largest_group = 0                 !! links of its largest Assur group
      integer :: groups = 0
      character(name_length) :: name = ''            !! unique among the kinds found together
   end type linkage_kind_t

contains

   !> All kinds that are wanted, those of few links first, each once.
   pure subroutine find_kinds(wanted, kinds)
      type(wanted_kinds_t), intent(in) :: wanted
      type(linkage_kind_t), allocatable, intent(out) :: kinds(:)
      type(chain_graph_t), allocatable :: chains(:)
      character(form_length), allocatable :: forms(:)
      integer :: k, c, first

      allocate (kinds(0))
      do k = 1, size(wanted%links)
         ! a gear pair takes one freedom: chains of two freedoms have an odd number of links
         if (modulo(wanted%links(k), 2) == 0) then
            if (wanted%gears(1) > 0) cycle
            call find_chains(wanted%links(k), 1, chains)
         else
            if (wanted%gears(2) < 1) cycle
            call find_chains(wanted%links(k), 2, chains)
         end if
         do c = 1, size(chains)
            first = size(kinds)
            allocate (forms(0))
            call add_kinds(chains(c), c, wanted, kinds, forms)
            deallocate (forms)
            call name_kinds(kinds(first + 1:))
         end do
      end do
   end subroutine find_kinds

   pure subroutine add_kinds(chain, number, wanted, kinds, forms)
      type(chain_graph_t), intent(in) :: chain
      integer, intent(in) :: number                !! of the chain among those of as many links
      type(wanted_kinds_t), intent(in) :: wanted
      type(linkage_kind_t), allocatable, intent(inout) :: kinds(:)
      character(form_length), allocatable, intent(inout) :: forms(:)
      type(linkage_kind_t) :: kind
      integer :: slides, frame, a, b, output

      do slides = wanted%slides(1), wanted%slides(2)
         do frame = 1, chain%n
            do a = 1, chain%n
               do b = 1, chain%n
                  if (chain%joint(a, b) == joint_none) cycle
                  if (wanted%drive == driven_by_crank .and. a /= frame) cycle
                  if (wanted%drive == driven_by_cylinder) then
                     if (a > b .or. any([a, b] == frame) .or. chain%degree(a) /= 2 .or. chain%degree(b) /= 2) cycle
                  end if
                  kind%graph = chain
                  kind%frame = frame
                  kind%base = a
                  kind%driven = b
                  kind%slides = slides
                  call set_joint(kind%graph, a, b, merge(joint_driven_pin, joint_driven_slide, &
                                                         wanted%drive == driven_by_crank))
                  do output = 1, chain%n
                     if (any([frame, a, b] == output)) cycle
                     kind%output = output
                     kind%graph%colour = 0
                     kind%graph%colour(frame) = colour_frame
                     kind%graph%colour(output) = colour_output
                     kind%name = family_of(chain, number, frame)
                     if (modulo(chain%n, 2) == 0) then
                        call choose_slides(kind, slides, 1, wanted, kinds, forms)
                     else
                        call choose_wheels(kind, slides, wanted, kinds, forms)
                     end if
                  end do
               end do
            end do
         end do
      end do
   end subroutine add_kinds

   !> Put every two links in gear that a third is pinned to, then make so many pins slides.
   pure subroutine choose_wheels(kind, slides, wanted, kinds, forms)
      type(linkage_kind_t), intent(in) :: kind
      integer, intent(in) :: slides
      type(wanted_kinds_t), intent(in) :: wanted
      type(linkage_kind_t), allocatable, intent(inout) :: kinds(:)
      character(form_length), allocatable, intent(inout) :: forms(:)
      type(linkage_kind_t) :: geared
      integer :: arm, a, b

      do arm = 1, kind%graph%n
         do a = 2, kind%graph%n
            do b = 1, a - 1
               if (.not. (is_pin(a) .and. is_pin(b))) cycle
               if (kind%graph%joint(a, b) /= joint_none) cycle
               geared = kind
               geared%wheels = [a, b]
               geared%arm = arm
               call set_joint(geared%graph, a, b, joint_gear)
               if (has_stiff_part(geared)) cycle
               call choose_slides(geared, slides, 1, wanted, kinds, forms)
            end do
         end do
      end do

   contains

      !> A link is pinned to the arm, and no part of a cylinder.
      pure logical function is_pin(link)
         integer, intent(in) :: link

         is_pin = any(kind%graph%joint(link, arm) == [joint_pin, joint_driven_pin])
         if (wanted%drive == driven_by_cylinder) is_pin = is_pin .and. all(link /= [kind%base, kind%driven]) .and. &
                                                          all(arm /= [kind%base, kind%driven])
      end function is_pin
   end subroutine choose_wheels

   !> True if links among themselves, the wheels and their arm among them, have no freedom left. The whole is not looked at.
   pure logical function has_stiff_part(kind)
      type(linkage_kind_t), intent(in) :: kind
      integer :: set, pins, a, b

      has_stiff_part = .true.
      associate (graph => kind%graph)
         do set = 1, 2**graph%n - 2
            if (.not. (btest(set, kind%wheels(1) - 1) .and. btest(set, kind%wheels(2) - 1) .and. btest(set, kind%arm - 1))) cycle
            pins = 0
            do a = 2, graph%n
               do b = 1, a - 1
                  if (btest(set, a - 1) .and. btest(set, b - 1) .and. graph%are_joined(a, b)) pins = pins + 1
               end do
            end do
            if (3*(popcnt(set) - 1) - 2*pins - 1 < 1) return
         end do
      end associate
      has_stiff_part = .false.
   end function has_stiff_part

   !> Make so many more pins slides, in every way, of the pairs of links from `next` on.
   pure recursive subroutine choose_slides(kind, left, next, wanted, kinds, forms)
      type(linkage_kind_t), intent(in) :: kind
      integer, intent(in) :: left, next
      type(wanted_kinds_t), intent(in) :: wanted
      type(linkage_kind_t), allocatable, intent(inout) :: kinds(:)
      character(form_length), allocatable, intent(inout) :: forms(:)
      type(linkage_kind_t) :: more
      character(form_length) :: form
      integer :: pair, a, b

      if (left == 0) then
         if (.not. turns(kind%graph)) return
         if (.not. serves(kind, wanted%output)) return
         form = canonical_form(kind%graph)
         if (any(forms == form)) return
         more = kind
         call find_groups(more, wanted%drive)
         if (more%groups == 0 .or. more%largest_group > wanted%largest_group) return
         forms = [character(form_length) :: forms, form]
         kinds = [kinds, more]
         return
      end if
      do pair = next, most_links**2
         a = (pair - 1)/most_links + 1
         b = modulo(pair - 1, most_links) + 1
         if (b <= a .or. b > kind%graph%n) cycle
         if (kind%graph%joint(a, b) /= joint_pin) cycle
         ! wheels turn on the arm
         if (any([a, b] == kind%arm) .and. (any(kind%wheels == a) .or. any(kind%wheels == b))) cycle
         ! cylinder and rod have a pin each
         if (wanted%drive == driven_by_cylinder .and. any([a, b] == kind%base .or. [a, b] == kind%driven)) cycle
         more = kind
         call set_joint(more%graph, a, b, joint_slide)
         call choose_slides(more, left - 1, pair + 1, wanted, kinds, forms)
      end do
   end subroutine choose_slides

   pure subroutine set_joint(graph, a, b, what)
      type(chain_graph_t), intent(inout) :: graph
      integer, intent(in) :: a, b, what

      graph%joint(a, b) = what
      graph%joint(b, a) = what
   end subroutine set_joint

   !> True if every loop has two pins at least: links that slides join turn together, so slides close no loop, and no pin joins two
   !> links that slides join, nor are two such links in gear. A link that only slides hold has two of them at most.
   pure logical function turns(graph)
      type(chain_graph_t), intent(in) :: graph
      integer :: together(most_links), a, b, k

      turns = .false.
      together = [(k, k=1, most_links)]
      do a = 2, graph%n
         do b = 1, a - 1
            if (.not. any(graph%joint(a, b) == [joint_slide, joint_driven_slide])) cycle
            if (together(a) == together(b)) return
            where (together == together(b)) together = together(a)
         end do
      end do
      do a = 2, graph%n
         do b = 1, a - 1
            if (any(graph%joint(a, b) == [joint_pin, joint_driven_pin, joint_gear]) .and. together(a) == together(b)) return
         end do
      end do
      do a = 1, graph%n
         ! a body that slides on three others keeps its angle and has one direction too many
         if (count(graph%joint(:, a) == joint_slide .or. graph%joint(:, a) == joint_driven_slide) > 2) return
      end do
      turns = .true.
   end function turns

   !> True if the output is not one that a simpler linkage has.
   pure logical function serves(kind, output)
      type(linkage_kind_t), intent(in) :: kind
      integer, intent(in) :: output

      associate (on_frame => kind%graph%joint(kind%frame, kind%output))
         if (output == kind_of_angle) then
            serves = on_frame == joint_pin
         else
            serves = .not. kind%graph%are_joined(kind%frame, kind%output)
         end if
      end associate
   end function serves

   !> Assur groups, from the drive on: each the least number of links that the links known fix. None (`groups` 0) if a link does not
   !> help to move the output, or if no order is found.
   pure subroutine find_groups(kind, drive)
      type(linkage_kind_t), intent(inout) :: kind
      integer, intent(in) :: drive
      logical :: known(most_links), needed(most_links)
      integer :: group_of(most_links), set, size_of, k, j, a, b, gear_group
      logical :: inside(most_links), found

      associate (graph => kind%graph, n => kind%graph%n)
         known = .false.
         known(kind%frame) = .true.
         if (drive == driven_by_crank) known(kind%driven) = .true.
         group_of = 0
         kind%groups = 0
         kind%largest_group = 0
         do while (.not. all(known(:n)))
            found = .false.
            sizes: do size_of = 1, n
               do set = 1, 2**n - 1
                  if (popcnt(set) /= size_of) cycle
                  inside = [(btest(set, k - 1), k=1, most_links)]
                  if (any(inside .and. known)) cycle
                  ! cylinder and rod are one, whose length is given
                  if (drive == driven_by_cylinder .and. (inside(kind%base) .neqv. inside(kind%driven))) cycle
                  j = 0
                  do a = 1, n
                     if (.not. inside(a)) cycle
                     do b = 1, n
                        if (.not. graph%are_joined(a, b)) cycle
                        if (known(b) .or. (inside(b) .and. b < a)) j = j + 1
                     end do
                  end do
                  k = 3*size_of - 2*j
                  if (drive == driven_by_cylinder .and. inside(kind%base)) k = k - 1
                  if (kind%arm > 0) then
                     associate (members => [kind%wheels, kind%arm])
                        if (any(inside(members)) .and. all(inside(members) .or. known(members))) k = k - 1
                     end associate
                  end if
                  if (k /= 0) cycle
                  found = .true.
                  exit sizes
               end do
            end do sizes
            if (.not. found) then
               kind%groups = 0
               return
            end if
            kind%groups = kind%groups + 1
            where (inside) group_of = kind%groups
            known = known .or. inside
            size_of = count(inside)
            if (drive == driven_by_cylinder .and. inside(kind%base)) size_of = size_of - 1
            kind%largest_group = max(kind%largest_group, size_of)
         end do
         ! what the output depends on
         gear_group = 0
         if (kind%arm > 0) gear_group = maxval(group_of([kind%wheels, kind%arm]))
         needed = .false.
         needed(kind%output) = .true.
         do
            inside = needed
            do a = 1, n
               if (.not. needed(a)) cycle
               do b = 1, n
                  if (group_of(b) > 0 .and. group_of(b) == group_of(a)) needed(b) = .true.
                  if (graph%are_joined(a, b) .and. group_of(b) < group_of(a)) needed(b) = .true.
               end do
               if (gear_group > 0 .and. group_of(a) == gear_group) needed([kind%wheels, kind%arm]) = .true.
            end do
            if (all(needed .eqv. inside)) exit
         end do
         needed(kind%frame) = .true.
         if (.not. all(needed(:n))) kind%groups = 0
         if (kind%arm == 0) return
         if (gear_group == 0) kind%groups = 0
         kind%wheels_in_group = all(group_of(kind%wheels) == gear_group)
         if (group_of(kind%wheels(1)) > group_of(kind%wheels(2))) kind%wheels = kind%wheels([2, 1])
      end associate
   end subroutine find_groups

   !> The ratios that the gear pair of a kind may have: turns of the second wheel by those of the first, seen from the arm. None
   !> where it has no gears.
   pure function ratios_of(kind) result(list)
      type(linkage_kind_t), intent(in) :: kind
      real(wp), allocatable :: list(:)

      if (kind%arm == 0) then
         allocate (list(0))
      else if (kind%wheels_in_group) then
         list = ratios_in_group
      else
         list = ratios
      end if
   end function ratios_of

   ! ---- names -------------------------------------------------------------------------------------------------------

   !> The usual name of an inversion, where it has one.
   pure function family_of(chain, number, frame) result(name)
      type(chain_graph_t), intent(in) :: chain
      integer, intent(in) :: number, frame
      character(name_length) :: name
      integer :: k, ternary(2), both

      select case (chain%n)
      case (4)
         name = 'four-bar'
      case (5)
         name = 'geared five-bar'
      case (7)
         name = 'geared seven-bar '//to_text(number)
      case (6)
         ternary = pack([(k, k=1, chain%n)], [(chain%degree(k) == 3, k=1, chain%n)])
         if (chain%joint(ternary(1), ternary(2)) /= joint_none) then
            name = 'Watt '//trim(merge('II', 'I ', any(ternary == frame)))
         else
            both = count(chain%joint(ternary, frame) /= joint_none)
            name = 'Stephenson III'
            if (all(ternary /= frame)) name = 'Stephenson '//trim(merge('I ', 'II', both == 2))
         end if
      case default
         name = 'chain '//to_text(chain%n)//'-'//to_text(number)
      end select
   end function family_of

   !> Families by what is in them: slides, drive and output are counted.
   pure subroutine name_kinds(kinds)
      type(linkage_kind_t), intent(inout) :: kinds(:)
      character(name_length) :: family(size(kinds))
      integer :: k, number

      do k = 1, size(kinds)
         family(k) = kinds(k)%name
         if (kinds(k)%slides == 1) family(k) = trim(family(k))//' with a slide'
         if (kinds(k)%slides > 1) family(k) = trim(family(k))//' with '//to_text(kinds(k)%slides)//' slides'
      end do
      do k = 1, size(kinds)
         number = count(family(:k) == family(k))
         kinds(k)%name = family(k)
         if (count(family == family(k)) > 1) kinds(k)%name = trim(family(k))//', '//to_text(number)
      end do
   end subroutine name_kinds
end module psalm_linkage_kinds
