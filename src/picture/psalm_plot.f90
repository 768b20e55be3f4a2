!> Plots: lines over one axis, as data. `psalm_curves` and `psalm_steady_curves` make them, `psalm_plot_svg` draws them.
module psalm_plot
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: plot_t, plot_line_t, begin_plot, add_line, add_span, values_seen, round_down
   public :: look_line, look_thin, look_dashed, look_dotted, look_dots, look_rings, look_joined, look_steps, look_area

   integer, parameter :: look_line = 1, look_thin = 2, look_dashed = 3, look_dotted = 4, look_dots = 5, look_rings = 6, &
                         look_joined = 7, look_steps = 8, look_area = 9
   integer, parameter :: name_length = 128    !! characters of a name with its unit
   integer, parameter :: label_length = 64

   !> Points in their order. Where one is not known there is a gap.
   type :: plot_line_t
      character(label_length) :: label = ''   !! in the legend; none if empty
      integer :: look = look_line
      integer :: colour = 1                 !! used in turn; 0: of limits
      real(wp), allocatable :: x(:), y(:)   !! shape (points)
      real(wp), allocatable :: other(:)     !! of an area: its other edge
      logical, allocatable :: known(:)
   end type plot_line_t

   type :: plot_t
      character(name_length) :: name = ''     !! with the unit
      character(name_length) :: below = ''    !! name of the axis, with its unit
      real(wp) :: from = 0.0_wp, to = 1.0_wp    !! ends of the axis; from < to
      logical :: turning = .false.          !! the axis is in degrees
      logical :: logarithmic = .false.      !! upwards
      logical :: from_zero = .false.        !! zero is in view
      real(wp) :: scale = 0.0_wp            !! changes below `flat` times it are rounding, which is not magnified
      real(wp) :: height = 200.0_wp         !! of its panel, pixels
      real(wp) :: low = 0.0_wp, high = 0.0_wp !! bottom and top, if high > low; else as the values are
      real(wp), allocatable :: spans(:, :)  !! shape (2, spans): parts of the axis that are shaded
      logical, allocatable :: mild(:)       !! shape (spans): a limit is exceeded, the linkage closes
      type(plot_line_t), allocatable :: lines(:)
   end type plot_t

contains

   !> The next 1, 2 or 5 times a power of ten below; at least 1.
   pure real(wp) function round_down(value)
      real(wp), intent(in) :: value
      real(wp) :: power

      round_down = 1.0_wp
      if (value <= 1.0_wp) return
      power = 10.0_wp**floor(log10(value))
      round_down = power
      if (value >= 2.0_wp*power) round_down = 2.0_wp*power
      if (value >= 5.0_wp*power) round_down = 5.0_wp*power
   end function round_down

   !> Append a plot without lines.
   pure subroutine begin_plot(name, like, plots)
      character(*), intent(in) :: name
      type(plot_t), intent(in) :: like      !! with the axis and spans that the new one has
      type(plot_t), allocatable, intent(inout) :: plots(:)
      type(plot_t), allocatable :: more(:)
      integer :: i

      allocate (more(size(plots) + 1))
      do i = 1, size(plots)
         more(i) = plots(i)
      end do
      associate (last => more(size(more)))
         last = like
         last%name = name
         if (.not. allocated(last%spans)) allocate (last%spans(2, 0), last%mild(0))
         if (allocated(last%lines)) deallocate (last%lines)
         allocate (last%lines(0))
      end associate
      call move_alloc(more, plots)
   end subroutine begin_plot

   !> Append a line to a plot.
   pure subroutine add_line(plot, label, look, colour, x, y, known, other)
      type(plot_t), intent(inout) :: plot
      character(*), intent(in) :: label
      integer, intent(in) :: look, colour
      real(wp), intent(in) :: x(:), y(:)    !! shape (points)
      logical, intent(in), optional :: known(:) !! all if absent
      real(wp), intent(in), optional :: other(:)
      type(plot_line_t), allocatable :: more(:)
      integer :: i

      allocate (more(size(plot%lines) + 1))
      do i = 1, size(plot%lines)
         more(i) = plot%lines(i)
      end do
      associate (last => more(size(more)))
         last%label = label
         last%look = look
         last%colour = colour
         last%x = x
         last%y = y
         allocate (last%known(size(x)), source=.true.)
         if (present(known)) last%known = known
         if (present(other)) last%other = other
      end associate
      call move_alloc(more, plot%lines)
   end subroutine add_line

   !> Shade a part of the axis.
   pure subroutine add_span(plot, from, to, mild)
      type(plot_t), intent(inout) :: plot
      real(wp), intent(in) :: from, to
      logical, intent(in), optional :: mild   !! a limit is exceeded, no more; default false
      logical :: only_limit

      only_limit = .false.
      if (present(mild)) only_limit = mild
      if (.not. allocated(plot%spans)) allocate (plot%spans(2, 0), plot%mild(0))
      plot%spans = reshape([plot%spans, from, to], [2, size(plot%spans, 2) + 1])
      plot%mild = [plot%mild, only_limit]
   end subroutine add_span

   !> All known values within the axis, in any order.
   pure function values_seen(plot) result(values)
      type(plot_t), intent(in) :: plot
      real(wp), allocatable :: values(:)
      logical, allocatable :: seen(:)
      integer :: k

      allocate (values(0))
      do k = 1, size(plot%lines)
         associate (line => plot%lines(k))
            seen = line%known .and. line%x >= plot%from .and. line%x <= plot%to
            values = [values, pack(line%y, seen)]
            if (allocated(line%other)) values = [values, pack(line%other, seen)]
         end associate
      end do
   end function values_seen
end module psalm_plot
