!> Entities of DXF (release 12, ASCII) as text.
module psalm_dxf_text
   use psalm_kinds, only: wp
   use psalm_text, only: text_t, full_precision, to_text
   implicit none (type, external)
   private
   public :: dxf_t, layer_length

   integer, parameter :: layer_length = 31 !! characters of a layer's name, which release 12 has room for
   integer, parameter :: most_layers = 8   !! room to begin with
   integer, parameter :: metric = 1, english = 0 !! $MEASUREMENT
   integer, parameter :: inches = 1, feet = 2    !! of $INSUNITS

   !> A layer.
   type :: layer_t
      character(layer_length) :: name = ''
      integer :: colour = 7
   end type layer_t

   !> A drawing being written.
   type :: dxf_t
      type(text_t) :: text
      integer :: layers = 0
      type(layer_t), allocatable :: layer(:)
   contains
      procedure :: add_layer
      procedure :: begin
      procedure :: finish
      procedure :: line
      procedure :: point
      procedure :: circle
      procedure :: words
      procedure :: words_along
      procedure :: polyline
      procedure, private :: group
      procedure, private :: place
   end type dxf_t

contains

   !> Name a layer, before `begin`. One that is there already stays as it is.
   subroutine add_layer(self, name, colour)
      class(dxf_t), intent(inout) :: self
      character(*), intent(in) :: name
      integer, intent(in) :: colour            !! of CAD, 1 to 9
      type(layer_t), allocatable :: more(:)

      if (.not. allocated(self%layer)) allocate (self%layer(most_layers))
      if (any(self%layer(:self%layers)%name == name)) return
      if (self%layers == size(self%layer)) then
         allocate (more(2*self%layers))
         more(:self%layers) = self%layer
         call move_alloc(more, self%layer)
      end if
      self%layers = self%layers + 1
      self%layer(self%layers) = layer_t(name, colour)
   end subroutine add_layer

   !> Header and tables.
   subroutine begin(self, low, high, unit)
      class(dxf_t), intent(inout) :: self
      real(wp), intent(in) :: low(2), high(2)  !! corners
      integer, intent(in) :: unit              !! $INSUNITS; 0: none
      integer :: i

      call self%group(0, 'SECTION')
      call self%group(2, 'HEADER')
      call self%group(9, '$ACADVER')
      call self%group(1, 'AC1009')
      if (unit > 0) then
         ! of later releases, but read by all programs
         call self%group(9, '$INSUNITS')
         call self%group(70, to_text(unit))
         call self%group(9, '$MEASUREMENT')
         call self%group(70, to_text(merge(english, metric, unit == inches .or. unit == feet)))
      end if
      call self%group(9, '$EXTMIN')
      call self%place(low(1), low(2))
      call self%group(9, '$EXTMAX')
      call self%place(high(1), high(2))
      call self%group(0, 'ENDSEC')
      call self%group(0, 'SECTION')
      call self%group(2, 'TABLES')
      call self%group(0, 'TABLE')
      call self%group(2, 'LTYPE')
      call self%group(70, '1')
      call self%group(0, 'LTYPE')
      call self%group(2, 'CONTINUOUS')
      call self%group(70, '0')
      call self%group(3, 'Solid line')
      call self%group(72, '65')
      call self%group(73, '0')
      call self%group(40, '0.0')
      call self%group(0, 'ENDTAB')
      call self%group(0, 'TABLE')
      call self%group(2, 'LAYER')
      call self%group(70, to_text(self%layers))
      do i = 1, self%layers
         call self%group(0, 'LAYER')
         call self%group(2, trim(self%layer(i)%name))
         call self%group(70, '0')
         call self%group(62, to_text(self%layer(i)%colour))
         call self%group(6, 'CONTINUOUS')
      end do
      call self%group(0, 'ENDTAB')
      call self%group(0, 'ENDSEC')
      call self%group(0, 'SECTION')
      call self%group(2, 'ENTITIES')
   end subroutine begin

   subroutine finish(self)
      class(dxf_t), intent(inout) :: self

      call self%group(0, 'ENDSEC')
      call self%group(0, 'EOF')
   end subroutine finish

   subroutine line(self, layer, x1, y1, x2, y2)
      class(dxf_t), intent(inout) :: self
      character(*), intent(in) :: layer
      real(wp), intent(in) :: x1, y1, x2, y2

      call self%group(0, 'LINE')
      call self%group(8, trim(layer))
      call self%place(x1, y1)
      call self%group(11, full_precision(x2))
      call self%group(21, full_precision(y2))
      call self%group(31, '0.0')
   end subroutine line

   subroutine point(self, layer, x, y)
      class(dxf_t), intent(inout) :: self
      character(*), intent(in) :: layer
      real(wp), intent(in) :: x, y

      call self%group(0, 'POINT')
      call self%group(8, trim(layer))
      call self%place(x, y)
   end subroutine point

   subroutine circle(self, layer, x, y, radius)
      class(dxf_t), intent(inout) :: self
      character(*), intent(in) :: layer
      real(wp), intent(in) :: x, y, radius

      call self%group(0, 'CIRCLE')
      call self%group(8, trim(layer))
      call self%place(x, y)
      call self%group(40, full_precision(radius))
   end subroutine circle

   subroutine words(self, layer, x, y, height, text)
      class(dxf_t), intent(inout) :: self
      character(*), intent(in) :: layer
      real(wp), intent(in) :: x, y, height
      character(*), intent(in) :: text

      call self%group(0, 'TEXT')
      call self%group(8, trim(layer))
      call self%place(x, y)
      call self%group(40, full_precision(height))
      call self%group(1, text)
   end subroutine words

   !> Words in the middle of a line, turned by an angle.
   subroutine words_along(self, layer, x, y, height, degrees, text)
      class(dxf_t), intent(inout) :: self
      character(*), intent(in) :: layer
      real(wp), intent(in) :: x, y, height, degrees !! x and y: the middle of the words' base line
      character(*), intent(in) :: text

      call self%words(layer, x, y, height, text)
      call self%group(50, full_precision(degrees))
      call self%group(72, '1')
      call self%group(11, full_precision(x))
      call self%group(21, full_precision(y))
      call self%group(31, '0.0')
   end subroutine words_along

   !> A polyline. A bulge is the tangent of a quarter of the angle of the arc that leads on from its vertex; 0: straight.
   subroutine polyline(self, layer, x, y, closed, bulge)
      class(dxf_t), intent(inout) :: self
      character(*), intent(in) :: layer
      real(wp), intent(in) :: x(:), y(:)
      logical, intent(in) :: closed
      real(wp), intent(in), optional :: bulge(:)   !! of each vertex
      integer :: i

      call self%group(0, 'POLYLINE')
      call self%group(8, trim(layer))
      call self%group(66, '1')
      call self%place(0.0_wp, 0.0_wp)
      call self%group(70, merge('1', '0', closed))
      do i = 1, size(x)
         call self%group(0, 'VERTEX')
         call self%group(8, trim(layer))
         call self%place(x(i), y(i))
         if (present(bulge)) call self%group(42, full_precision(bulge(i)))
      end do
      call self%group(0, 'SEQEND')
   end subroutine polyline

   subroutine group(self, code, value)
      class(dxf_t), intent(inout) :: self
      integer, intent(in) :: code
      character(*), intent(in) :: value

      call self%text%add(to_text(code))
      call self%text%add(value)
   end subroutine group

   subroutine place(self, x, y)
      class(dxf_t), intent(inout) :: self
      real(wp), intent(in) :: x, y

      call self%group(10, full_precision(x))
      call self%group(20, full_precision(y))
      call self%group(30, '0.0')
   end subroutine place
end module psalm_dxf_text
