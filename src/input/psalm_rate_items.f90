!> Derivatives of the output by the input that are wanted at the positions: DVELX, DACCX ... of &METHOD, weights WVELX, WACCX ...
!>
!> Source of the target for derivatives at precision points: Oldham (1977), 9.1.1. Sketches have theirs in `psalm_target_items`.
module psalm_rate_items
   use psalm_group, only: group_t, out_of
   use psalm_kinds, only: wp
   use psalm_output_kind, only: output_kind, output_kind_t, most_components, most_rates
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: rate_row_t, read_rate_items, wanted_rows, gives_rates

   integer, parameter :: in_x = 1, in_y = 2, in_other = 3
   !> Items by order and number: x, y, and what is no coordinate of a point.
   character(*), parameter :: rate_items(most_rates, most_components) = reshape( &
      [character(7) :: 'DVELX', 'DACCX', 'DVELY', 'DACCY', 'DVELANG', 'DACCANG'], [most_rates, most_components])
   character(*), parameter :: rate_weights(most_rates, most_components) = reshape( &
      [character(7) :: 'WVELX', 'WACCX', 'WVELY', 'WACCY', 'WVELANG', 'WACCANG'], [most_rates, most_components])

   !> Derivatives of one order of one component that are wanted somewhere.
   type :: rate_row_t
      character(len(rate_items)) :: item = '', weigher = '' !! names in &METHOD
      integer :: component = 0, order = 0
   end type rate_row_t

contains

   !> The rows that are wanted, as they are given.
   pure function wanted_rows(weight) result(rows)
      real(wp), intent(in) :: weight(:, :, :)      !! shape (positions, components, most_rates): 0 where none is wanted
      type(rate_row_t), allocatable :: rows(:)
      integer :: c, which, order

      allocate (rows(0))
      do c = 1, size(weight, 2)
         which = merge(in_other, c, size(weight, 2) == 1)
         do order = 1, most_rates
            if (any(weight(:, c, order) > 0.0_wp)) &
               rows = [rows, rate_row_t(rate_items(order, which), rate_weights(order, which), c, order)]
         end do
      end do
   end function wanted_rows

   !> Does a group give one of these items?
   pure logical function gives_rates(group)
      type(group_t), intent(in) :: group
      integer :: order, which

      gives_rates = .false.
      do which = in_x, in_other
         do order = 1, most_rates
            gives_rates = gives_rates .or. group%given(trim(rate_items(order, which))) .or. &
                          group%given(trim(rate_weights(order, which)))
         end do
      end do
   end function gives_rates

   !> Read them. `wanted` and `weight` are allocated only if a derivative is given; what is not wanted has the weight 0.
   !>
   !> Errors: more values than positions, weights below zero or of nothing, derivatives of what the output has not.
   subroutine read_rate_items(group, motion, positions, wanted, weight, findings)
      type(group_t), intent(inout) :: group
      integer, intent(in) :: motion                          !! MOTION
      integer, intent(in) :: positions                       !! NDES; 0: the items are not used
      real(wp), allocatable, intent(out) :: wanted(:, :, :)  !! shape (positions, components, most_rates)
      real(wp), allocatable, intent(out) :: weight(:, :, :)  !! the same shape
      type(diagnostics_t), intent(inout) :: findings
      real(wp), parameter :: absent = -huge(1.0_wp)
      real(wp), allocatable :: all_wanted(:, :, :), all_weights(:, :, :)
      type(output_kind_t) :: kind
      character(:), allocatable :: item, weigher
      real(wp), allocatable :: values(:), weights(:)
      integer :: order, which, c, last, last_weight, i

      kind = output_kind(motion)
      allocate (all_wanted(positions, kind%components, most_rates), all_weights(positions, kind%components, most_rates), &
                source=0.0_wp)
      allocate (values(positions), weights(positions))
      do which = in_x, in_other
         c = place_of(which)
         do order = 1, most_rates
            item = trim(rate_items(order, which))
            weigher = trim(rate_weights(order, which))
            values = absent
            weights = 1.0_wp
            call read_row(item, values, last)
            call read_row(weigher, weights, last_weight)
            if (positions == 0) cycle
            if (last == 0 .and. last_weight > 0) call out_of(group, weigher, 'weighs '//item//', which is not given', findings, &
                                                             1)
            if (last == 0) cycle
            if (c == 0) then
               call out_of(group, item, 'is of no use: MOTION='//to_text(motion)//' has the derivatives '//usual(), findings, 1)
               cycle
            end if
            if (last_weight == 1) weights = weights(1)
            if (last_weight > 1 .and. last_weight < positions) call out_of(group, weigher, &
               'is one weight, or one for each of NDES='//to_text(positions)//' positions; found '//to_text(last_weight), &
               findings, last_weight)
            i = findloc(weights < 0.0_wp, .true., dim=1)
            if (i > 0) call out_of(group, weigher, 'weights must not be negative', findings, i)
            all_wanted(:, c, order) = merge(values, 0.0_wp, values > absent)
            all_weights(:, c, order) = merge(weights, 0.0_wp, values > absent)
         end do
      end do
      if (.not. any(all_weights > 0.0_wp)) return
      call move_alloc(all_wanted, wanted)
      call move_alloc(all_weights, weight)

   contains

      !> The component of the output that an item is of; 0: it has none.
      pure integer function place_of(number)
         integer, intent(in) :: number

         place_of = 0
         if (number == in_other) then
            if (kind%components /= 2) place_of = kind%components
         else if (kind%components > 1) then
            place_of = number
         end if
      end function place_of

      pure function usual() result(names)
         character(:), allocatable :: names
         integer :: k

         names = ''
         do k = in_x, in_other
            if (place_of(k) == 0) cycle
            if (len(names) > 0) names = names//', '
            names = names//trim(rate_items(1, k))//', '//trim(rate_items(2, k))
         end do
      end function usual

      !> Values for the positions, and zeros up to the size of the original program's arrays, as other items of positions may have.
      subroutine read_row(name, row, highest)
         character(*), intent(in) :: name
         real(wp), intent(inout) :: row(:)
         integer, intent(out) :: highest
         integer :: needed, beyond

         call group%get_reals(name, row, findings, last=highest, needed=needed, beyond=beyond, as_written=.true., &
                              any_filler=name(1:1) == 'W')
         if (positions > 0 .and. beyond > 0) call findings%error('NDES='//to_text(positions)//' positions are declared, but '// &
            to_text(needed)//' values given; set NDES='//to_text(needed)//' or leave the others out', line=beyond, &
            group=trim(group%name), item=name)
      end subroutine read_row
   end subroutine read_rate_items
end module psalm_rate_items
