!> A mechanism as it is drawn: joints with coordinates, the links that join them, slides, drives, gears, what is wanted of it.
!>
!> The drawing is the reference: it gives lengths, angles and the assembly. The first link is the frame. A joint may belong to
!> any number of links; one that belongs to one link only is a point of it. Source: Oldham (1977), 4.2 and 15.1.
module psalm_sketch
   use psalm_kinds, only: wp
   use psalm_output_kind, only: output_kind_t, kind_of_output, output_point, output_angle, output_distance, output_slide, &
                                output_between, output_pose, output_ratio, output_x, output_y
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: sketch_t, link_t, slide_t, drive_t, sketch_output_t, variation_t
   public :: target_t, target_column_t, equality_t
   public :: sketch_name, frame_link, position_of, grid_digits, columns_of, first_number, most_targets
   public :: drive_turns, drive_slides, drive_stretches
   public :: output_point, output_angle, output_distance, output_slide, output_between, output_pose, output_ratio
   public :: output_x, output_y
   public :: vary_length, vary_angle, vary_place, vary_input, vary_all

   integer, parameter :: sketch_name = 31   !! characters of a name
   integer, parameter :: frame_link = 1     !! the link that is the frame

   integer, parameter :: drive_turns = 1     !! turns a link against another at a joint of both
   integer, parameter :: drive_slides = 2    !! moves a link along a slide on another
   integer, parameter :: drive_stretches = 3 !! changes the length of a link of two joints: a cylinder

   integer, parameter :: vary_length = 1     !! the distance of two joints of a link
   integer, parameter :: vary_angle = 2      !! the angle from one line of a link to another
   integer, parameter :: vary_place = 3      !! the place of a joint of the frame: x and y
   integer, parameter :: vary_input = 4      !! the reference input
   integer, parameter :: vary_all = 5        !! every dimension of the loops, the place of the whole included

   !> A rigid body and its joints.
   type :: link_t
      character(sketch_name) :: name = ''
      integer, allocatable :: joints(:)
   end type link_t

   !> A prismatic pair: one link moves along a line of another.
   type :: slide_t
      character(sketch_name) :: name = ''
      integer :: links(2) = 0               !! the two links; the line is drawn with either
      real(wp) :: x = 0.0_wp, y = 0.0_wp    !! a point of the line in the drawing
      real(wp) :: angle = 0.0_wp            !! direction in the drawing, degrees
   end type slide_t

   !> An actuator. Its value is counted from the drawing: degrees of the link against the base, or length.
   type :: drive_t
      character(sketch_name) :: name = ''
      integer :: kind = 0                   !! one of `drive_...`
      integer :: joint = 0                  !! drive_turns
      integer :: slide = 0                  !! drive_slides
      integer :: base = 0, link = 0         !! the links between which it acts; drive_stretches: the link, base 0
      logical :: geared = .false.           !! value = ratio * value of the first drive + phase
      real(wp) :: ratio = 1.0_wp, phase = 0.0_wp
      integer :: steps = 0                  !! values of a grid of strokes, evenly from `low` to `high`; 0: no grid
      real(wp) :: low = 0.0_wp, high = 0.0_wp
      real(wp), allocatable :: delt(:)      !! value at every position; not allocated: the first drive's is in &METHOD
      real(wp) :: speed = 0.0_wp, accel = 0.0_wp !! by time, of a drive that is neither the first nor geared: radians or length
   end type drive_t

   !> Two wheels whose centres a carrier holds: turns of `wheels(1)` against the carrier times `ratio` are those of `wheels(2)`.
   type :: gear_t
      integer :: wheels(2) = 0
      integer :: carrier = 0
      real(wp) :: ratio = 0.0_wp            !! negative for an external pair
      real(wp) :: teeth(2) = 0.0_wp         !! as written
   end type gear_t

   integer, parameter :: most_targets = 2     !! derivatives of an output that may be prescribed

   !> What an output, or a derivative of it by the first drive's input, is to be.
   type :: target_t
      real(wp), allocatable :: values(:, :)  !! shape (numbers of the output, positions); not allocated: nothing is prescribed
      real(wp), allocatable :: weights(:, :) !! the same shape
   end type target_t

   !> What is wanted.
   type :: sketch_output_t
      character(sketch_name) :: name = ''
      integer :: kind = 0                   !! one of `output_...`
      integer :: joints(4) = 0              !! point, pose: 1; distance: 1 or 2; angle: line 1-2; between: lines 1-2 and 3-4
      integer :: link = 0                   !! pose, angle: the link, if one was named
      integer :: slide = 0
      integer :: outputs(2) = 0             !! ratio: the rate of the first by that of the second
      type(target_t) :: targets(0:most_targets) !! by order of the derivative
   contains
      procedure :: has_target
      procedure :: drawn_joint
   end type sketch_output_t

   !> One number that is wanted: of an output, of its numbers, a derivative by the first drive's input.
   type :: target_column_t
      integer :: output = 0
      integer :: component = 0
      integer :: order = 0
   end type target_column_t

   !> Two outputs, or one at two positions, that are to be equal: first = factor*second + constant.
   type :: equality_t
      integer :: outputs(2) = 0
      integer :: positions(2) = 0           !! 0: each position, of both
      integer :: order = 0                  !! derivative by the first drive's input
      real(wp) :: factor = 1.0_wp
      real(wp) :: constant = 0.0_wp         !! degrees of angles, in derivatives radians
      real(wp) :: weight = 1.0_wp
   end type equality_t

   !> A dimension that a search may change.
   type :: variation_t
      integer :: kind = 0                   !! one of `vary_...`
      integer :: joints(4) = 0              !! length: 2; angle: lines 1-2 and 3-4; place: 1
      real(wp) :: low(2) = 0.0_wp, high(2) = 0.0_wp
      logical :: bounded = .false.
   end type variation_t

   !> The whole drawing.
   type :: sketch_t
      logical :: given = .false.
      logical :: valid = .false.            !! every name in it is understood
      character(sketch_name), allocatable :: joint_name(:)
      real(wp), allocatable :: x(:), y(:)   !! shape (joints)
      type(link_t), allocatable :: links(:)
      type(slide_t), allocatable :: slides(:)
      type(drive_t), allocatable :: drives(:)
      type(gear_t), allocatable :: gears(:)
      type(sketch_output_t), allocatable :: outputs(:)
      type(equality_t), allocatable :: equalities(:) !! not allocated: none
      type(variation_t), allocatable :: variations(:)
      integer, allocatable :: length_of(:, :) !! shape (2, lengths): joints whose distance is given exactly
      real(wp), allocatable :: length(:)
      logical :: over_braced = .false.      !! KOVER: equations that special dimensions make superfluous are allowed
   contains
      procedure :: has_targets
      procedure :: joint_of_output
      procedure :: target_columns
      procedure :: shown_joint
      procedure :: has_joint
      procedure :: links_of
      procedure :: joint_called
      procedure :: link_called
      procedure :: slide_called
      procedure :: drive_label
      procedure :: why_no_crank
   end type sketch_t

contains

   !> Where a position of a grid stands along each of its drives, counted from 0.
   !>
   !> The first drive changes fastest; each goes back and forth, so that a position is next to the one before it.
   pure function grid_digits(counts, position) result(digits)
      integer, intent(in) :: counts(:)      !! values of each drive
      integer, intent(in) :: position       !! 1 to their product
      integer :: digits(size(counts))
      integer :: rest, d

      rest = position - 1
      do d = 1, size(counts)
         digits(d) = modulo(rest, counts(d))
         rest = rest/counts(d)
         if (modulo(rest, 2) == 1) digits(d) = counts(d) - 1 - digits(d)
      end do
   end function grid_digits

   !> How many numbers an output has.
   pure integer function columns_of(output)
      type(sketch_output_t), intent(in) :: output
      type(output_kind_t) :: kind

      kind = kind_of_output(output%kind)
      columns_of = kind%components
   end function columns_of

   !> Place of the first number of an output among those of all outputs.
   pure integer function first_number(outputs, output)
      type(sketch_output_t), intent(in) :: outputs(:)
      integer, intent(in) :: output
      integer :: k

      first_number = 1
      do k = 1, output - 1
         first_number = first_number + columns_of(outputs(k))
      end do
   end function first_number

   !> The joint at which an output is drawn: a point, the end of an angle's line, of other numbers one of their joints. 0: there is
   !> none, as of a slide or of a ratio.
   pure integer function drawn_joint(self) result(joint)
      class(sketch_output_t), intent(in) :: self

      select case (self%kind)
      case (output_point, output_pose)
         joint = self%joints(1)
      case (output_angle)
         joint = self%joints(2)
      case (output_between)
         joint = self%joints(4)
      case (output_slide, output_ratio)
         joint = 0
      case default
         joint = merge(self%joints(2), self%joints(1), self%joints(2) > 0)
      end select
   end function drawn_joint

   !> The joint at which an output is drawn, of a ratio that of its first output; 0: none.
   pure integer function joint_of_output(self, n) result(joint)
      class(sketch_t), intent(in) :: self
      integer, intent(in) :: n              !! number of the output

      joint = self%outputs(n)%drawn_joint()
      if (self%outputs(n)%kind == output_ratio) joint = self%outputs(self%outputs(n)%outputs(1))%drawn_joint()
   end function joint_of_output

   !> True if values are prescribed.
   pure logical function has_target(self)
      class(sketch_output_t), intent(in) :: self

      has_target = allocated(self%targets(0)%values)
   end function has_target

   !> True if anything is prescribed of any output.
   pure logical function has_targets(self)
      class(sketch_t), intent(in) :: self
      integer :: k, order

      has_targets = allocated(self%equalities)
      do k = 1, size(self%outputs)
         do order = 0, most_targets
            has_targets = has_targets .or. allocated(self%outputs(k)%targets(order)%values)
         end do
      end do
   end function has_targets

   !> All numbers that outputs have targets for: output after output, values before derivatives.
   pure function target_columns(self) result(columns)
      class(sketch_t), intent(in) :: self
      type(target_column_t), allocatable :: columns(:)
      integer :: k, order, c

      allocate (columns(0))
      do k = 1, size(self%outputs)
         do order = 0, most_targets
            if (.not. allocated(self%outputs(k)%targets(order)%values)) cycle
            columns = [columns, [(target_column_t(k, c, order), c=1, columns_of(self%outputs(k)))]]
         end do
      end do
   end function target_columns

   !> Why there is no one crank whose turning moves everything, in words; empty where there is.
   pure function why_no_crank(self) result(words)
      class(sketch_t), intent(in) :: self
      character(:), allocatable :: words
      integer :: own

      words = ''
      own = count(.not. self%drives%geared)
      if (own > 1) then
         words = 'this sketch has '//to_text(own)//' drives of their own'
      else if (self%drives(1)%kind /= drive_turns) then
         words = 'the input of this linkage slides'
      end if
   end function why_no_crank

   !> The joint that is the output where none is given: the first point of a single link, else the last moving joint.
   pure integer function shown_joint(self) result(joint)
      class(sketch_t), intent(in) :: self
      integer :: j

      joint = 1
      do j = 1, size(self%joint_name)
         if (.not. self%has_joint(frame_link, j)) joint = j
      end do
      do j = size(self%joint_name), 1, -1
         if (.not. self%has_joint(frame_link, j) .and. size(self%links_of(j)) == 1) joint = j
      end do
   end function shown_joint

   !> True if the joint belongs to the link.
   pure logical function has_joint(self, link, joint)
      class(sketch_t), intent(in) :: self
      integer, intent(in) :: link, joint

      has_joint = any(self%links(link)%joints == joint)
   end function has_joint

   !> The links that a joint belongs to, in their order.
   pure function links_of(self, joint) result(links)
      class(sketch_t), intent(in) :: self
      integer, intent(in) :: joint
      integer, allocatable :: links(:)
      integer :: i

      links = pack([(i, i=1, size(self%links))], [(self%has_joint(i, joint), i=1, size(self%links))])
   end function links_of

   !> Place of a name in a list; 0: it is not there.
   pure integer function position_of(name, names)
      character(*), intent(in) :: name, names(:)

      do position_of = 1, size(names)
         if (names(position_of) == name) return
      end do
      position_of = 0
   end function position_of

   !> Name of a drive; of several at one joint with their links, `A.frame-crank`.
   pure function drive_label(self, drive) result(label)
      class(sketch_t), intent(in) :: self
      integer, intent(in) :: drive
      character(:), allocatable :: label

      associate (one => self%drives(drive))
         label = trim(one%name)
         if (count(self%drives%name == one%name) > 1) &
            label = label//'.'//trim(self%links(one%base)%name)//'-'//trim(self%links(one%link)%name)
      end associate
   end function drive_label

   !> Number of the joint of that name; 0: there is none.
   pure integer function joint_called(self, name)
      class(sketch_t), intent(in) :: self
      character(*), intent(in) :: name

      joint_called = position_of(name, self%joint_name)
   end function joint_called

   !> Number of the link of that name; 0: there is none.
   pure integer function link_called(self, name)
      class(sketch_t), intent(in) :: self
      character(*), intent(in) :: name

      do link_called = 1, size(self%links)
         if (self%links(link_called)%name == name) return
      end do
      link_called = 0
   end function link_called

   !> Number of the slide of that name; 0: there is none.
   pure integer function slide_called(self, name)
      class(sketch_t), intent(in) :: self
      character(*), intent(in) :: name

      do slide_called = 1, size(self%slides)
         if (self%slides(slide_called)%name == name) return
      end do
      slide_called = 0
   end function slide_called
end module psalm_sketch
