!> The loops of a sketch as they are traced: arcs between points, joints first and then feet of slides.
module psalm_traced_loops
   use psalm_kinds, only: wp
   use psalm_moving_joints, only: sketch_motion_t
   use psalm_output_kind, only: motion_point
   use psalm_place, only: place_t, travel_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: loops_t, traced_t, traced_ring_t, traced_pair_t, traced_gear_t, arc_with
   public :: traced_determined, traced_link, traced_slide, traced_crank, traced_actuator, traced_frame

   integer, parameter :: traced_determined = 1
   integer, parameter :: traced_link = 2
   integer, parameter :: traced_slide = 3
   integer, parameter :: traced_crank = 4
   integer, parameter :: traced_actuator = 5
   integer, parameter :: traced_frame = 6      !! of the frame, counted from the machine's x axis: the last arc of loop 1, others
                                               !! where each varies by itself

   !> One arc of a loop.
   type :: traced_t
      integer :: kind = traced_determined
      integer :: loop = 0, place = 0
      integer :: link = 0                   !! the link it is fixed in
      integer :: ends(2) = 0                !! points
      integer :: reference = 0              !! arc it hangs on
      logical :: same = .false., against = .false. !! it is that arc, traced the same way or the other
      integer :: guide = 0                  !! slides of dyads: the place of the guide in the loop; of larger groups 0, the guide is
                                            !! `reference`
      logical :: foot_last = .false.        !! slides of larger groups: it is the finish that is a point of the guide
      integer :: guide_link = 0             !! slides of larger groups, and the actuator before one: the link that guides
      integer :: drive = 1                  !! of a crank or actuator: which drive moves it
      logical :: cylinder = .false.         !! an actuator whose direction its group finds; `foot_last`: its rod ends last
      integer :: sign = 1
      integer :: slide = 0                  !! the slide of the sketch that it runs along
      real(wp) :: length = 0.0_wp
      real(wp) :: direction = 0.0_wp        !! in the drawing, degrees
      real(wp) :: arcl = 0.0_wp             !! its length as a dimension of the loops: 0 of what slides
      real(wp) :: gama = 0.0_wp             !! its angle from the arc it hangs on, of a frame arc from the x axis, degrees; of
                                            !! larger groups and of drives after the first its direction
      logical :: length_varies = .false., angle_varies = .false.
      real(wp) :: tolerances(2) = -1.0_wp   !! of its length and angle where it has some of its own; else negative
   end type traced_t

   !> A ring of a larger group, as `psalm_mechanism` has it: sequential numbers of arcs.
   type :: traced_ring_t
      integer :: loop = 0
      integer :: first = 0, turn = 0, last = 0
      logical :: closed = .true.
   end type traced_ring_t

   !> A gear pair of a larger group: turns of `wheels(1)` against the carrier times `ratio` are those of `wheels(2)`. Or a drive
   !> that turns `wheels(1)` against `wheels(2)`.
   type :: traced_gear_t
      integer :: loop = 0
      integer :: wheels(2) = 0, carrier = 0 !! links
      real(wp) :: ratio = 0.0_wp
      integer :: drive = 0                  !! 0: a gear pair
      logical :: of_slides = .false.        !! no gear pair, but links in a ring of slides: they have one direction
      integer :: centres(2) = 0             !! of a gear pair: the joints of the wheels and the carrier; 0: there is none
   end type traced_gear_t

   !> A pair of a larger group: two links on a pin or a slide.
   type :: traced_pair_t
      integer :: loop = 0
      integer :: links(2) = 0
      integer :: joint = 0, slide = 0       !! one of them
   end type traced_pair_t

   !> A drive after the first.
   type :: traced_drive_t
      integer :: arc = 0                    !! the arc that it turns or makes longer; 0: none, it turns links of a group
      logical :: slides = .false., geared = .false. !! geared: to the first drive
      type(traced_pair_t) :: pair           !! where it moves a link on the frame; without links: elsewhere
      real(wp) :: ratio = 1.0_wp, phase = 0.0_wp
   end type traced_drive_t

   !> The loops found.
   type :: loops_t
      logical :: found = .false.
      character(:), allocatable :: why      !! what there are no arrays for
      type(traced_t), allocatable :: arcs(:)
      integer :: loops = 0, longest = 0
      complex(wp), allocatable :: point(:)  !! places of the points: the joints, then feet of slides
      integer :: start = 0                  !! the point that all loops begin at
      integer, allocatable :: axis(:)       !! by link: its first arc
      real(wp) :: input = 0.0_wp            !! CRNKI in the drawing
      real(wp) :: crank = 0.0_wp            !! direction that is reported for the crank in the drawing, degrees
      real(wp) :: anchor = 0.0_wp           !! that at which unknown arcs of larger groups have the dimensions given
      logical :: floating = .false.         !! the first drive moves no link on the frame
      logical :: sliding = .false.          !! its input is a length
      logical, allocatable :: on(:, :)      !! shape (points, links): the point is fixed in the link
      integer, allocatable :: joint_loop(:) !! by joint: the loop whose group places it
      integer, allocatable :: line_point(:, :) !! shape (2, slides): points of a slide's line on its links, 0: none
      type(traced_pair_t), allocatable :: pairs(:) !! of all larger groups
      type(traced_gear_t), allocatable :: gears(:) !! of all larger groups
      type(traced_drive_t), allocatable :: seconds(:) !! drives after the first
      integer, allocatable :: drive_of(:)   !! by link: the drive that turns it on the frame, 0: none
      type(traced_ring_t), allocatable :: rings(:) !! of the loops that close larger groups, in order
      real(wp) :: origlk = 0.0_wp, origng = 0.0_wp !! where the input pivot is
      ! the first output, or what is listed in its stead
      integer :: motion = motion_point      !! one of `motion_...`
      integer :: output_arc = 0             !! the arc that it is measured from
      logical :: from_start = .false.       !! from the start of that arc, else from its finish
      integer :: output_joint = 0           !! the joint that it is, 0: it is no point
      real(wp) :: outlk = 0.0_wp, outang = 0.0_wp
      real(wp) :: of_output(2) = -1.0_wp    !! tolerances of these; negative: none of their own
      character(:), allocatable :: stand_in !! the joint that the listing shows for want of the first output; not allocated: none
      ! what varies besides lengths and angles of arcs
      logical :: outlk_varies = .false., outang_varies = .false., pivot_varies = .false., input_varies = .false.
      logical, allocatable :: aside_varies(:, :) !! shape (2, joints): of joints off the arcs distance and angle from one of them
      ! where the loops have the parts of the sketch
      type(place_t), allocatable :: link_places(:) !! by link: its first joint, the line to its second one
      type(place_t), allocatable :: joint_places(:) !! by joint; no arc: fixed
      type(place_t), allocatable :: shoes(:) !! by slide: its point SLX, SLY on its second link
      type(travel_t), allocatable :: travels(:) !! by slide
      integer, allocatable :: line_senses(:) !! by slide: +1: its arc has the direction of its line, -1: the opposite one
      integer, allocatable :: pin_holders(:) !! by joint: the link that places it, whose force on others is listed
      type(sketch_motion_t) :: moving       !! where the joints that move are to be found, as they were drawn
   contains
      procedure :: is_dyad
      procedure :: number_of
      procedure :: begins
      procedure :: point_name
      procedure :: output_line
      procedure :: are_of_one_crank
      procedure :: hold_all
      procedure :: are_beyond_arrays
   end type loops_t

contains

   !> True if a loop closes a dyad, false if a larger group.
   pure logical function is_dyad(self, loop)
      class(loops_t), intent(in) :: self
      integer, intent(in) :: loop

      is_dyad = all(self%rings%loop /= loop)
   end function is_dyad

   !> Number of an arc from its loop and its number there; 0: there is none.
   pure integer function number_of(self, loop, place)
      class(loops_t), intent(in) :: self
      integer, intent(in) :: loop, place

      number_of = findloc(self%arcs%loop == loop .and. self%arcs%place == place, .true., dim=1)
   end function number_of

   !> True of the first arc of a loop, or of a ring of it.
   pure logical function begins(self, arc)
      class(loops_t), intent(in) :: self
      integer, intent(in) :: arc              !! sequential number

      begins = self%arcs(arc)%place == 1
      if (.not. self%is_dyad(self%arcs(arc)%loop)) begins = any(self%rings%first == arc)
   end function begins

   !> What a point is called: as its joint, or a foot of a slide by its number.
   pure function point_name(self, joints, point) result(name)
      class(loops_t), intent(in) :: self
      character(*), intent(in) :: joints(:)   !! names
      integer, intent(in) :: point
      character(:), allocatable :: name

      if (point <= size(self%joint_loop)) then
         name = trim(joints(point))
      else
         name = 'FOOT '//to_text(point - size(self%joint_loop))
      end if
   end function point_name

   !> True if one drive on the frame moves all, without wheels in gear, and there is more than the link that it moves.
   pure logical function are_of_one_crank(self)
      class(loops_t), intent(in) :: self

      are_of_one_crank = .not. (self%floating .or. size(self%seconds) > 0 .or. &
                                any(self%gears%drive == 0 .and. .not. self%gears%of_slides)) .and. &
                         any(self%arcs%kind == traced_link .or. self%arcs%kind == traced_slide)
   end function are_of_one_crank

   !> The two joints between which OUTLK is measured, the output last; 0: there is no such length.
   pure function output_line(self) result(joints)
      class(loops_t), intent(in) :: self
      integer :: joints(2)

      joints = 0
      if (self%output_joint == 0 .or. .not. self%outlk > 0.0_wp) return
      joints(1) = self%arcs(self%output_arc)%ends(merge(1, 2, self%from_start))
      if (joints(1) > size(self%joint_loop)) joints(1) = 0
      joints(2) = self%output_joint
   end function output_line

   !> Nothing varies any more.
   pure subroutine hold_all(self)
      class(loops_t), intent(inout) :: self

      self%arcs%length_varies = .false.
      self%arcs%angle_varies = .false.
      self%outlk_varies = .false.
      self%outang_varies = .false.
      if (allocated(self%aside_varies)) self%aside_varies = .false.
      self%pivot_varies = .false.
      self%input_varies = .false.
   end subroutine hold_all

   !> True of loops that the arrays of &LINKS cannot tell: of a group that is no dyad, with gears, a second drive, or more than one
   !> arc of the frame that is counted from the x axis.
   pure logical function are_beyond_arrays(self)
      class(loops_t), intent(in) :: self

      are_beyond_arrays = size(self%rings) > 0 .or. any(self%arcs%drive > 1) .or. count(self%arcs%kind == traced_frame) > 1
   end function are_beyond_arrays

   !> The first arc of a link that begins (`from_start`) or ends at a point; 0: none does.
   pure subroutine arc_with(loops, link, point, arc, from_start)
      type(loops_t), intent(in) :: loops
      integer, intent(in) :: link, point
      integer, intent(out) :: arc
      logical, intent(out) :: from_start
      integer :: k

      arc = 0
      from_start = .false.
      do k = 1, size(loops%arcs)
         associate (one => loops%arcs(k))
            if (one%link /= link .or. one%same .or. one%against) cycle
            if (.not. loops%on(point, link)) return
            if (one%ends(2) == point) then
               arc = k
               from_start = .false.
               return
            end if
            if (one%ends(1) == point .and. arc == 0) then
               arc = k
               from_start = .true.
            end if
         end associate
      end do
   end subroutine arc_with
end module psalm_traced_loops
