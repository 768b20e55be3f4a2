!> What a mechanism is, whoever described it: bodies, joints, actuators and outputs, and the vector loops that close it.
!>
!> A mechanism is topology alone; its numbers are a `dimensions_t`, and which of them vary is a `parameters_t`.
!>
!> **Arcs** are vectors from point to point. Each is fixed in a body: the sliding arc of a prismatic joint in the body that
!> slides, with its foot on the body that guides it. An arc's direction is that of the arc it hangs on, turned by GAMA; or
!> the actuator or an Assur group finds it. **Loops** are closed rings of arcs from the input pivot back to it; each group's
!> unknown arcs stand side by side in its loop. **Groups** are in the order in which they are solved. A group of more than two
!> links has several rings of arcs in its loop, as many as it takes to find all its unknown arcs; each link of it has one
!> unknown arc, its axis.
!>
!> **Points** are the vertices of the chain, each made once though many loops run through it: two arcs meet in one point
!> because the loops say so, never because their coordinates agree. Source of the bodies: Oldham (1977), sections 4.2 and 15.1.
module psalm_mechanism
   use psalm_dimensions, only: dimensions_t
   use psalm_dyad_kind, only: assur_higher, assur_none
   use psalm_kinds, only: wp
   use psalm_output_kind, only: motion_point
   use psalm_sketch, only: sketch_name
   implicit none (type, external)
   private
   public :: mechanism_t, linkage_group_t, joined_t, ring_t, tie_t, point_t, bar_t, body_t, joint_t, actuator_t, output_t
   public :: arc_absent, arc_determined, arc_link, arc_slide, arc_crank, arc_actuator
   public :: joint_revolute, joint_prismatic, joint_gear, at_start, at_finish, body_frame, pivot

   integer, parameter :: arc_absent = 0      !! not known yet
   integer, parameter :: arc_determined = 1  !! direction fixed to that of another arc, or to the frame
   integer, parameter :: arc_link = 2        !! undetermined, of fixed length
   integer, parameter :: arc_slide = 3       !! undetermined, sliding on its guide
   integer, parameter :: arc_crank = 4       !! the input link, turning
   integer, parameter :: arc_actuator = 5    !! the input link, sliding; a member of a group: a cylinder, whose length is an input

   integer, parameter :: joint_revolute = 1
   integer, parameter :: joint_prismatic = 2
   integer, parameter :: joint_gear = 3      !! two wheels in mesh: where forces are asked for

   integer, parameter :: at_start = 1        !! an end of an arc
   integer, parameter :: at_finish = 2

   integer, parameter :: body_frame = 1      !! the body that is the frame
   integer, parameter :: pivot = 1           !! the point that is the input pivot, on the frame

   !> A vector from point to point, fixed in a body.
   type :: arc_t
      integer :: kind = arc_absent
      integer :: loop = 0, place = 0    !! its loop and its number there
      integer :: reference = 0          !! arc it hangs on, or its guide; 0: none
      logical :: same = .false.         !! same length and direction as its reference
      logical :: frame = .false.        !! belongs to the frame
      logical :: leads_nowhere = .false. !! from a joint of a sketch to the same joint
      integer :: turn = 0               !! of slides +1 if 90 degrees anticlockwise from the guide's direction, -1 if clockwise; 0:
                                        !! turned from it by GAMA
      integer :: representative = 0     !! first arc identical with it (itself if none)
      logical :: reversed = .false.     !! traced against its representative
      integer :: dyad = 0               !! unknowns: which of its group's members it is, of a dyad 1 for p, 2 for q; else 0
      integer :: body = 0               !! body whose axes it is fixed in
      integer :: ends(2) = 0            !! points at its start and its finish
      integer :: foot = 0               !! where its guide meets a slide, or an arc that repeats one: `at_...`
      integer :: bar = 0                !! the bar it runs along
      logical :: attached = .false.     !! its ends are points of its body; if not it is only parallel to it
      integer :: rod = 0                !! of a cylinder: the body that its foot is a point of
      integer :: drive = 1              !! of the input link and of arcs whose length is an input: the actuator that moves it
      integer :: link = 0               !! of a sketch: the link that it is fixed in,
      integer :: joints(2) = 0          !! the joints at its ends, 0: none,
      integer :: marks(2) = 0           !! the points there that are points of the link - joints, then those of slides -, 0: none,
      integer :: rail = 0               !! and the slide that it runs along, 0: none
   end type arc_t

   !> A ring of arcs of a larger group. From the input pivot the arcs `first` to `turn`, each from start to finish, lead to the
   !> point to which the arcs `last` back to `turn` + 1, each from finish to start, lead as well.
   !> One that is not closed has forward arcs only: they lead to a link that a tie turns.
   type :: ring_t
      integer :: first = 0, turn = 0, last = 0
      logical :: closed = .true.
   end type ring_t

   !> Turns of links, counted from the drawing, that depend on each other: the sum of `factors` times those of the arcs is the turn
   !> of a drive, or 0. Wheels in gear; a drive between two moving links; slides that give several links one direction.
   type :: tie_t
      integer :: arcs(3) = 0            !! axes of the links; 0: none, or the frame
      real(wp) :: factors(3) = 0.0_wp
      real(wp) :: drawn(3) = 0.0_wp     !! directions of these arcs in the drawing, degrees
      integer :: drive = 0              !! an actuator that turns; 0: none
      integer :: axes(3) = 0            !! an arc of each link itself; 0: none, or the frame
      integer :: centre(2) = 0, centre_end(2) = at_start !! of wheels: arcs, and which ends of them, at the centres; 0: none
      integer :: joint = 0              !! of wheels: their joint
      logical :: of_slides = .false.    !! links that slide on each other in a ring: the couples are those of the slides
   end type tie_t

   !> What closes a group: a ring of arcs, or several.
   type :: loop_t
      integer :: first = 0              !! number of its first arc; the others follow
      integer :: arcs = 0               !! how many there are
      type(ring_t), allocatable :: rings(:) !! of a larger group, one after the other; of a dyad not allocated
   end type loop_t

   !> A vertex of the chain, and how it is reached.
   type :: point_t
      integer :: from = 0               !! from this point; 0: it is the input pivot
      integer :: arc = 0                !! by this arc,
      integer :: sense = 0              !! along it (+1) or against it (-1)
      integer :: group = 0              !! the group whose common joint it is; 0: none
   end type point_t

   !> An arc, or several identical arcs, between two points.
   type :: bar_t
      integer :: arc = 0                !! the representative
      integer :: ends(2) = 0            !! its points, in the sense of that arc
   end type bar_t

   !> A rigid body. Its axes are those of its arc `axis`; those of the frame are the machine's.
   type :: body_t
      character(:), allocatable :: name
      integer :: axis = 0               !! 0: the frame
      logical :: is_rod = .false.       !! of a cylinder: its axes begin at the foot of that arc
      integer, allocatable :: arcs(:)   !! arcs fixed in it, `axis` included; `angle_on_body` is their direction in its axes
      integer, allocatable :: points(:) !! points fixed in it
   end type body_t

   !> What joins two bodies. The reaction of the first body on the second is the one listings print.
   type :: joint_t
      character(:), allocatable :: name !! IN, then S, M and E with the number of the loop
      integer :: kind = joint_revolute
      integer :: bodies(2) = 0
      integer :: arc = 0                !! an arc that ends here,
      integer :: end = at_start         !! by this end
      integer :: point = 0              !! the point there: centre of a revolute joint, foot of a prismatic one
      integer :: pin = 0                !! revolute joints of one number are on one pin, though their points may be several
      integer :: slide = 0              !! prismatic: the arc whose direction it slides along
      integer :: group = 0              !! the group it belongs to; 0: the input
      logical :: attached = .false.     !! the point is a point of both bodies (of a prismatic joint: of its guide)
   end type joint_t

   !> A pair of a larger group.
   type :: joined_t
      integer :: axes(2) = 0            !! an arc of each body
      integer :: arc = 0, end = at_start !! the arc and the end at which they meet
      integer :: slide = 0              !! the arc along which they slide, 0: they turn
   end type joined_t

   !> What drives the mechanism.
   type :: actuator_t
      integer :: joint = 0              !! 0: none of its own
      integer :: arc = 0                !! the arc it moves; 0: it turns two links of a group
      logical :: slides = .false.       !! prismatic: its input is a length
      logical :: geared = .false.       !! its input is that of the first, counted from the drawing, times `ratio`, and `phase`
      real(wp) :: ratio = 1.0_wp, phase = 0.0_wp
      real(wp) :: by_first(3) = [1.0_wp, 0.0_wp, 0.0_wp] !! derivatives of its input by that of the first, radians or lengths
      type(joined_t) :: pair = joined_t() !! after the first: where it moves a link on the frame; arc 0: elsewhere
   end type actuator_t

   !> An Assur group.
   type :: linkage_group_t
      integer :: kind = assur_none      !! one of `assur_...`
      integer :: loop = 0               !! the loop that closes it
      integer, allocatable :: members(:)!! its unknown arcs; of a dyad p and q
      integer :: sign = 1               !! assembly mode, +1 or -1
      type(joined_t), allocatable :: pairs(:) !! of a larger group
      type(tie_t), allocatable :: ties(:) !! of a larger group; not allocated: none
      integer, allocatable :: joints(:) !! S, M, E; of a larger group all joints between its links, or with links before it
   end type linkage_group_t

   !> What the mechanism is for.
   type :: output_t
      integer :: motion = motion_point  !! one of `motion_...`
      integer :: arc = 0                !! the arc it is measured from
      logical :: from_start = .false.   !! from the start of that arc, else from its finish
      logical :: stands_in = .false.    !! of a sketch: it is a joint for want of the first output, which no arc tells; not listed
      character(sketch_name) :: line(2) = '' !! of a sketch: the joints of the line that OUTLK and OUTANG are of
   end type output_t

   !> A mechanism of one degree of freedom for each actuator.
   type :: mechanism_t
      integer :: nloop = 0
      type(arc_t), allocatable :: arcs(:)
      type(loop_t), allocatable :: loops(:)
      type(linkage_group_t), allocatable :: groups(:)       !! group k is closed by loop k
      type(point_t), allocatable :: points(:)       !! the input pivot first
      type(bar_t), allocatable :: bars(:)
      type(body_t), allocatable :: bodies(:)        !! the frame, the input link if there is one, then those of each group
      type(joint_t), allocatable :: joints(:)       !! that of the actuator first, if it moves a link on the frame
      type(actuator_t), allocatable :: actuators(:)
      type(output_t), allocatable :: outputs(:)
      character(sketch_name), allocatable :: ends(:, :) !! shape (2, arcs): of a sketch, the names of the joints, or feet, at
                                                    !! start and finish; not allocated: arcs have numbers alone
      logical :: sliding_input = .false.            !! the first actuator is prismatic
      logical :: floating_input = .false.           !! it moves no link on the frame: there is no input link
      logical :: whole = .false.                    !! all its links are meant, whatever the output: no loop is left out
      logical :: from_drawing = .false.             !! inputs are shown from the drawing (`psalm_shown_input`)
      real(wp) :: reference = 0.0_wp                !! the reference input from there, degrees or length
      real(wp) :: crank_turn = 0.0_wp               !! from the crank's arc to the line whose direction is reported, degrees
      real(wp) :: first_input = 0.0_wp              !! where a turn of inputs begins as shown
   contains
      procedure :: seq
      procedure :: loop_of
      procedure :: place
      procedure :: angle_owner
      procedure :: angle_on_body
      procedure :: slides
      procedure :: is_cylinder
      procedure :: is_one_joint
      procedure :: line_called
      procedure :: has_joint_names
      procedure :: length_called
      procedure :: angle_called
      procedure :: guide_of
      procedure :: body_at
      procedure :: has_point
      procedure :: pin_of_sketch
      procedure :: is_dyad
      procedure :: is_closed
      procedure :: is_braced
      procedure :: ring_of
   end type mechanism_t

contains

   !> Number of an arc from its loop and its number there.
   pure integer function seq(self, loop, arc)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: loop, arc

      seq = self%loops(loop)%first + arc - 1
   end function seq

   !> Loop of an arc.
   pure integer function loop_of(self, n)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: n

      loop_of = self%arcs(n)%loop
   end function loop_of

   !> Number in its loop of an unknown arc of the loop's group; of a group without one, which drives put in place, of the arc that
   !> leads there.
   pure integer function place(self, which, loop)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: which      !! 1: p, 2: q
      integer, intent(in) :: loop

      if (which <= size(self%groups(loop)%members)) then
         place = self%arcs(self%groups(loop)%members(which))%place
      else
         place = self%arcs(self%loops(loop)%rings(1)%turn)%place
      end if
   end function place

   !> The arc whose GAMA gives the direction of an arc that repeats others.
   pure integer function angle_owner(self, n)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: n

      angle_owner = n
      do while (self%arcs(angle_owner)%same .and. self%arcs(angle_owner)%reference > 0)
         angle_owner = self%arcs(angle_owner)%reference
      end do
   end function angle_owner

   !> Direction of an arc in the axes of its body, degrees.
   pure real(wp) function angle_on_body(self, n, dimensions) result(angle)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: n
      type(dimensions_t), intent(in) :: dimensions
      integer :: arc

      angle = 0.0_wp
      arc = n
      do while (arc > 0)
         if (self%arcs(arc)%kind /= arc_determined) return
         if (.not. self%arcs(arc)%same) angle = angle + dimensions%gama(arc)
         arc = self%arcs(arc)%reference
      end do
   end function angle_on_body

   !> True if the length of an arc varies with the input.
   pure logical function slides(self, n)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: n

      associate (kind => self%arcs(self%arcs(n)%representative)%kind)
         slides = kind == arc_slide .or. kind == arc_actuator
      end associate
   end function slides

   !> The joints that an arc leads from and to, `A B`; empty where arcs have no names.
   pure function line_called(self, n) result(words)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: n          !! sequential number of the arc
      character(:), allocatable :: words

      words = ''
      if (self%has_joint_names()) words = trim(self%ends(1, n))//' '//trim(self%ends(2, n))
   end function line_called

   !> True if arcs are lines between joints that have names, those of a sketch.
   pure logical function has_joint_names(self)
      class(mechanism_t), intent(in) :: self

      has_joint_names = allocated(self%ends)
   end function has_joint_names

   !> What the length of an arc is called, or that of the output on its link (0): its joints by the alphabet.
   pure function length_called(self, n) result(words)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: n          !! sequential number of the arc
      character(:), allocatable :: words
      character(sketch_name) :: ends(2)

      words = ''
      if (.not. self%has_joint_names()) return
      if (n > 0) then
         ends = self%ends(:, n)
      else
         ends = self%outputs(1)%line
      end if
      if (ends(1) > ends(2)) ends = ends([2, 1])
      words = trim(ends(1))//' '//trim(ends(2))
   end function length_called

   !> What the angle of an arc is called, or that of the output on its link (0): the line that it counts from, if it is not the x
   !> axis, and its own.
   pure function angle_called(self, n) result(words)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: n          !! sequential number of the arc
      character(:), allocatable :: words
      integer :: from

      from = 0
      words = ''
      if (.not. self%has_joint_names()) return
      if (n > 0) then
         from = self%arcs(n)%reference
         words = self%line_called(n)
      else if (len_trim(self%outputs(1)%line(1)) > 0) then
         from = self%outputs(1)%arc
         words = trim(self%outputs(1)%line(1))//' '//trim(self%outputs(1)%line(2))
      end if
      if (from > 0) then
         if (.not. self%is_one_joint(from)) words = self%line_called(from)//' '//words
      end if
   end function angle_called

   !> True if an arc of a sketch leads from a joint to itself: it closes a ring and is no dimension of a link.
   pure logical function is_one_joint(self, n)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: n          !! sequential number of the arc

      is_one_joint = .false.
      if (allocated(self%ends)) is_one_joint = self%ends(1, n) == self%ends(2, n)
   end function is_one_joint

   !> True if an arc is a cylinder: its length is an input, its direction is found by its group.
   pure logical function is_cylinder(self, n)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: n

      associate (arc => self%arcs(self%arcs(n)%representative))
         is_cylinder = arc%kind == arc_actuator .and. arc%dyad > 0
      end associate
   end function is_cylinder

   !> The body that guides a slide; of a cylinder the rod.
   pure integer function guide_of(self, n)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: n          !! an arc that slides

      associate (arc => self%arcs(self%arcs(n)%representative))
         guide_of = arc%rod
         if (guide_of == 0) guide_of = self%arcs(arc%reference)%body
      end associate
   end function guide_of

   !> The body that carries an end of an arc: of the foot of a slide its guide's.
   pure integer function body_at(self, n, end)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: n
      integer, intent(in) :: end        !! `at_start` or `at_finish`

      body_at = self%arcs(n)%body
      if (self%arcs(n)%foot == end) body_at = self%guide_of(n)
   end function body_at

   !> True if a point is fixed in a body.
   pure logical function has_point(self, body, point)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: body, point

      has_point = any(self%bodies(body)%points == point)
   end function has_point

   !> The pin that a joint of a sketch is.
   pure integer function pin_of_sketch(self, joint)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: joint      !! number of the sketch

      pin_of_sketch = size(self%points) + joint
   end function pin_of_sketch

   !> The ring that an arc of a loop belongs to.
   pure type(ring_t) function ring_of(self, loop, n) result(ring)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: loop
      integer, intent(in) :: n          !! sequential number of the arc
      integer :: r

      associate (of => self%loops(loop))
         if (.not. allocated(of%rings)) then
            ring = ring_t(of%first, self%groups(loop)%members(1), of%first + of%arcs - 1)
            return
         end if
         do r = 1, size(of%rings)
            if (n < of%rings(r)%first .or. n > of%rings(r)%last) cycle
            ring = of%rings(r)
            return
         end do
      end associate
   end function ring_of

   !> True if a loop closes: not where drives or wheels alone put its links in place, which have no dead point.
   pure logical function is_closed(self, loop)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: loop

      is_closed = .not. allocated(self%loops(loop)%rings)
      if (.not. is_closed) is_closed = any(self%loops(loop)%rings%closed)
   end function is_closed

   !> True if links of a group brace each other: its rings and ties are more equations than it has unknowns.
   pure logical function is_braced(self, loop)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: loop
      integer :: equations

      is_braced = .false.
      if (self%is_dyad(loop)) return
      equations = 2*count(self%loops(loop)%rings%closed)
      if (allocated(self%groups(loop)%ties)) equations = equations + size(self%groups(loop)%ties)
      is_braced = equations > size(self%groups(loop)%members)
   end function is_braced

   !> True if a loop closes a dyad, false if a larger group.
   pure logical function is_dyad(self, loop)
      class(mechanism_t), intent(in) :: self
      integer, intent(in) :: loop

      is_dyad = self%groups(loop)%kind /= assur_higher
   end function is_dyad
end module psalm_mechanism
