!> What pictures show of allotted tolerances: what each costs and takes of its band, and how far the outputs go.
module psalm_allocation_scene
   use psalm_allocation, only: allocation_t, study_allocation
   use psalm_allocation_terms, only: item_name
   use psalm_allocation_group, only: rule_square, rule_worst, rule_yield
   use psalm_column_names, only: output_unit
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_markup, only: short_number
   use psalm_panels, only: with_unit
   use psalm_preparation, only: prepared_t
   use psalm_sort, only: ascending
   use psalm_stop, only: stop_t
   implicit none (type, external)
   private
   public :: allocation_scene_t, allotted_band_t, make_allocation_scene, allotted_words, tolerance_words
   public :: legend_words, part_words, plus_minus, degree_sign

   character(*), parameter :: plus_minus = char(194)//char(177), degree_sign = char(194)//char(176) !! UTF-8
   character(*), parameter :: radial = 'R '     !! before a radial clearance
   integer, parameter :: name_room = 120        !! characters of a name
   integer, parameter :: digits = 3             !! of a tolerance on a drawing
   integer, parameter :: digits_of_size = 7     !! of a length there
   integer, parameter :: digits_of_cost = 5
   integer, parameter :: digits_of_part = 3     !! in per cent
   real(wp), parameter :: percent = 0.01_wp

   !> A dimension with its tolerance.
   type :: allotted_t
      character(name_room) :: name = ''         !! as ALNAM has it
      logical :: angle = .false.                !! degrees
      logical :: pin = .false.                  !! a radial clearance
      integer :: loop = 0, arc = 0              !! the arc; 0: none
      real(wp) :: nominal = 0.0_wp              !! 0: not known
      real(wp) :: tolerance = 0.0_wp            !! to either side
      real(wp) :: cost = 0.0_wp                 !! part of the whole, 0 to 1
      real(wp) :: share = 0.0_wp                !! of what the tightest band takes up, 0 to 1
   end type allotted_t

   !> A number of an output: its bands. Arrays have the shape (positions), by rising input.
   type :: allotted_band_t
      character(name_room) :: name = ''         !! with its unit
      real(wp), allocatable :: input(:)
      real(wp), allocatable :: width(:)         !! to either side
      real(wp), allocatable :: worst(:), square(:) !! reached: worst case, root-sum-square
      real(wp), allocatable :: used(:)          !! what is compared with the width, of another rule than these
   end type allotted_band_t

   type :: allocation_scene_t
      integer :: rule = rule_worst              !! one of `rule_...`
      real(wp) :: yield = 0.0_wp                !! share of the linkages, of that rule
      real(wp) :: cost = 0.0_wp                 !! of all
      character(name_room) :: input = ''        !! name of the axis
      logical :: turning = .false.              !! it is in degrees
      character(name_room) :: tightest = ''     !! band whose shares are shown, in words
      type(allotted_t), allocatable :: rows(:)  !! shape (dimensions)
      type(allotted_band_t), allocatable :: bands(:) !! by number of the output
   end type allocation_scene_t

contains

   !> Of a case with the group ALLOC. `found` is false if no tolerances are found; psalm says why.
   subroutine make_allocation_scene(set, prepared, scene, found, stop)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(allocation_scene_t), intent(out) :: scene
      logical, intent(out) :: found
      type(stop_t), intent(in), optional :: stop
      type(allocation_t), allocatable :: allocation
      type(stop_t) :: ending
      real(wp), allocatable :: amount(:)
      integer :: i, j

      if (present(stop)) ending = stop
      allocate (allocation)
      call study_allocation(set, prepared%mechanism, prepared%given, 1, ending, allocation, unchecked=.true.)
      found = allocation%solved
      if (.not. found) return
      scene%rule = allocation%rule
      scene%yield = allocation%yield
      scene%cost = allocation%value
      scene%turning = .not. prepared%mechanism%sliding_input
      scene%input = merge('input, degrees', 'input, length ', scene%turning)
      if (prepared%mechanism%from_drawing) scene%input = trim(scene%input)//' from the drawing'
      allocate (scene%rows(size(allocation%names)))
      do i = 1, size(scene%rows)
         associate (row => scene%rows(i))
            row%name = item_name(allocation%names(i))
            row%angle = allocation%is_angle(i)
            j = i - (size(scene%rows) - size(allocation%plays))
            if (j > 0) row%pin = .not. allocation%plays(j)%slides
            row%loop = allocation%loop(i)
            row%arc = allocation%place(i)
            row%nominal = allocation%nominal(i)
            row%tolerance = allocation%tolerance(i)
            row%cost = allocation%cost(i)/allocation%value
         end associate
      end do
      if (size(allocation%bands) > 0) then
         j = maxloc(allocation%bands%used/allocation%bands%width, dim=1)
         amount = abs(allocation%effect(:, j))
         if (scene%rule /= rule_worst) amount = amount**2
         if (sum(amount) > 0.0_wp) scene%rows%share = amount/sum(amount)
         scene%tightest = trim(allocation%numbers(allocation%bands(j)%number))//' at input '// &
                          short_number(allocation%input(allocation%bands(j)%position), digits_of_cost)
      end if
      call find_bands(allocation, scene)
   end subroutine make_allocation_scene

   !> The bands of every number that has some.
   pure subroutine find_bands(allocation, scene)
      type(allocation_t), intent(in) :: allocation
      type(allocation_scene_t), intent(inout) :: scene
      integer, allocatable :: list(:)
      integer :: number, j, n

      allocate (scene%bands(count([(any(allocation%bands%number == j), j=1, size(allocation%numbers))])))
      n = 0
      do number = 1, size(allocation%numbers)
         list = pack([(j, j=1, size(allocation%bands))], allocation%bands%number == number)
         if (size(list) == 0) cycle
         n = n + 1
         list = list(ascending(allocation%input(allocation%bands(list)%position)))
         associate (band => scene%bands(n))
            band%name = with_unit(trim(allocation%numbers(number)), output_unit(allocation%turns(number)))
            band%input = allocation%input(allocation%bands(list)%position)
            band%width = allocation%bands(list)%width
            band%worst = sum(abs(allocation%effect(:, list)), dim=1)
            band%square = sqrt(sum(allocation%effect(:, list)**2, dim=1))
            if (allocated(allocation%worst)) then
               band%worst = allocation%worst(list)
               band%square = allocation%square(list)
            end if
            band%used = allocation%bands(list)%used
         end associate
      end do
   end subroutine find_bands

   !> What tolerances these are, in a sentence.
   pure function allotted_words(scene) result(words)
      type(allocation_scene_t), intent(in) :: scene
      character(:), allocatable :: words

      words = 'cheapest tolerances, cost '//short_number(scene%cost, digits_of_cost)//', within the bands: '
      select case (scene%rule)
      case (rule_square)
         words = words//'root-sum-square'
      case (rule_yield)
         words = words//short_number(scene%yield/percent)//' per cent of the linkages'
      case default
         words = words//'worst case'
      end select
   end function allotted_words

   !> What the second bar of a dimension is.
   pure function legend_words(scene) result(words)
      type(allocation_scene_t), intent(in) :: scene
      character(:), allocatable :: words

      words = 'part of the deviation in the tightest band, '//trim(scene%tightest)
   end function legend_words

   !> A part, 0 to 1, in per cent.
   pure function part_words(part) result(words)
      real(wp), intent(in) :: part
      character(:), allocatable :: words

      words = short_number(part/percent, digits_of_part)//' %'
   end function part_words

   !> A dimension with its tolerance as a drawing has it: `120 +-0.05`; a radial clearance `R 0.02`. The tolerance is rounded down,
   !> so that the band is kept.
   pure function tolerance_words(row, signs, degree) result(words)
      type(allotted_t), intent(in) :: row
      character(*), intent(in) :: signs, degree !! plus and minus; degree
      character(:), allocatable :: words
      real(wp) :: unit

      unit = 10.0_wp**(floor(log10(row%tolerance)) - digits + 1)
      words = short_number(unit*aint(row%tolerance/unit*(1.0_wp + epsilon(1.0_wp))), digits)
      if (row%pin) then
         words = radial//words
      else
         words = signs//words
      end if
      if (row%angle) words = words//degree
      if (.not. abs(row%nominal) > 0.0_wp) return
      if (row%angle) then
         words = short_number(row%nominal, digits_of_size)//degree//' '//words
      else
         words = short_number(row%nominal, digits_of_size)//' '//words
      end if
   end function tolerance_words
end module psalm_allocation_scene
