!> A linkage's topology as the programs hold it: arcs, dyads, variables; and its dimensions.
!>
!> `psalm_setup` makes a topology from a data set; everything after it works on these types.
module psalm_topology
   use psalm_kinds, only: wp
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: arc_t, variable_t, topology_t, dimensions_t, name_of
   public :: arc_absent, arc_determined, arc_link, arc_slide, arc_crank, arc_actuator
   public :: variable_length, variable_outlk, variable_origlk, variable_gama, variable_outang, variable_origng, variable_crnki
   integer, parameter :: arc_absent = 0      !! no such arc
   integer, parameter :: arc_determined = 1  !! direction fixed to that of another arc, or to the frame
   integer, parameter :: arc_link = 2        !! undetermined, of fixed length
   integer, parameter :: arc_slide = 3       !! undetermined, sliding on its guide
   integer, parameter :: arc_crank = 4       !! the input link, turning
   integer, parameter :: arc_actuator = 5    !! the input link, sliding

   integer, parameter :: variable_length = 1, variable_outlk = 2, variable_origlk = 3, variable_gama = 4
   integer, parameter :: variable_outang = 5, variable_origng = 6, variable_crnki = 7

   !> One arc of one loop.
   type :: arc_t
      integer :: kind = arc_absent
      integer :: reference = 0        !! sequential number of the arc it hangs on, or of its guide; 0: none
      logical :: same = .false.       !! same length and direction as its reference (positive ILINK)
      logical :: frame = .false.      !! belongs to the frame
      integer :: sign = 1             !! sign of ILINK
      integer :: turn = 0             !! slides: +1 if 90 degrees anticlockwise from the guide's direction, else -1
      integer :: representative = 0   !! sequential number of the first arc identical with it (itself if none)
      logical :: reversed = .false.   !! traced against its representative
      integer :: dyad = 0             !! undetermined arcs: 1 for p, 2 for q; determined arcs: 0
   end type arc_t

   !> One optimization variable and the parameter it stands for.
   type :: variable_t
      integer :: kind = 0  !! one of `variable_...`
      integer :: loop = 0, arc = 0
   end type variable_t

   !> The linkage as SETUP understands it.
   type :: topology_t
      integer :: nloop = 0, maxarc = 0
      type(arc_t), allocatable :: arcs(:)           !! by sequential number
      integer, allocatable :: loopl(:)              !! arcs in each loop
      integer, allocatable :: larcx(:, :)           !! shape (2, nloop): the undetermined arcs p and q
      integer, allocatable :: larcd(:), larcf(:), identa(:) !! by sequential number, as on device 8
      integer, allocatable :: joint(:)              !! dyad type of each loop, 1 to 8
      logical :: sliding_input = .false.            !! prismatic actuator
      type(variable_t), allocatable :: variables(:) !! shape (marble)
      integer, allocatable :: length_variable(:), angle_variable(:) !! by sequential number, 0: fixed
      integer :: output_arc = 0                     !! sequential number of the arc the output hangs on
      logical :: output_from_start = .false.        !! output measured from the start of that arc (NOUTLK < 0)
   contains
      procedure :: seq
      procedure :: first_values
      procedure :: apply
      procedure :: has_search => topology_has_variables
   end type topology_t

   !> The numbers that may vary: one linkage of the given topology. Angles in degrees.
   type :: dimensions_t
      real(wp), allocatable :: arcl(:), gama(:)  !! by sequential number
      real(wp) :: outlk = 0.0_wp, outang = 0.0_wp
      real(wp) :: origlk = 0.0_wp, origng = 0.0_wp
      real(wp) :: crnki = 0.0_wp
   end type dimensions_t

contains

   !> Sequential number of an arc.
   pure integer function seq(self, loop, arc)
      class(topology_t), intent(in) :: self
      integer, intent(in) :: loop, arc

      seq = (loop - 1)*self%maxarc + arc
   end function seq

   !> True if any dimension may vary.
   pure logical function topology_has_variables(self)
      class(topology_t), intent(in) :: self

      topology_has_variables = size(self%variables) > 0
   end function topology_has_variables
   !> The variables' values in the given linkage. Shape of the result: (marble).
   pure function first_values(self, dimensions) result(values)
      class(topology_t), intent(in) :: self
      type(dimensions_t), intent(in) :: dimensions
      real(wp), allocatable :: values(:)
      integer :: i

      allocate (values(size(self%variables)))
      do i = 1, size(values)
         associate (v => self%variables(i))
            select case (v%kind)
            case (variable_length)
               values(i) = dimensions%arcl(self%seq(v%loop, v%arc))
            case (variable_gama)
               values(i) = dimensions%gama(self%seq(v%loop, v%arc))
            case (variable_outlk)
               values(i) = dimensions%outlk
            case (variable_outang)
               values(i) = dimensions%outang
            case (variable_origlk)
               values(i) = dimensions%origlk
            case (variable_origng)
               values(i) = dimensions%origng
            case (variable_crnki)
               values(i) = dimensions%crnki
            end select
         end associate
      end do
   end function first_values

   !> Put variables into the linkage, identical arcs included.
   pure subroutine apply(self, values, dimensions)
      class(topology_t), intent(in) :: self
      real(wp), intent(in) :: values(:)              !! shape (marble)
      type(dimensions_t), intent(inout) :: dimensions
      integer :: i, n

      do i = 1, size(self%variables)
         select case (self%variables(i)%kind)
         case (variable_outlk)
            dimensions%outlk = values(i)
         case (variable_outang)
            dimensions%outang = values(i)
         case (variable_origlk)
            dimensions%origlk = values(i)
         case (variable_origng)
            dimensions%origng = values(i)
         case (variable_crnki)
            dimensions%crnki = values(i)
         end select
      end do
      do n = 1, size(self%arcs)
         if (self%length_variable(n) > 0) dimensions%arcl(n) = values(self%length_variable(n))
         if (self%angle_variable(n) > 0 .and. .not. self%arcs(n)%same) dimensions%gama(n) = values(self%angle_variable(n))
      end do
   end subroutine apply

   !> What a variable is called in listings.
   pure function name_of(variable) result(name)
      type(variable_t), intent(in) :: variable
      character(:), allocatable :: name

      select case (variable%kind)
      case (variable_length)
         name = 'LENGTH OF ARC '//to_text(variable%arc)//' IN LOOP '//to_text(variable%loop)
      case (variable_gama)
         name = 'ANGLE OF ARC '//to_text(variable%arc)//' IN LOOP '//to_text(variable%loop)
      case (variable_outlk)
         name = 'OUTPUT LENGTH'
      case (variable_outang)
         name = 'OUTPUT ANGLE'
      case (variable_origlk)
         name = 'INPUT PIVOT, DISTANCE'
      case (variable_origng)
         name = 'INPUT PIVOT, ANGLE'
      case default
         name = 'REFERENCE INPUT'
      end select
   end function name_of
end module psalm_topology
