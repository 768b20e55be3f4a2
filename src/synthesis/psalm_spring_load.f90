!> What springs do to a load: the drive's or a joint's.
!>
!> A spring of stiffness S and free length L pulls its ends together with S (l - L) = S l - k, k = S L. One that turns two links, or
!> acts along a slide, has a coordinate of its own in place of l, an angle or a distance, and places that are given.
module psalm_spring_load
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   use psalm_spring_design_group, only: criterion_range, criterion_rms
   implicit none (type, external)
   private
   public :: spring_limits_t, found_spring_t, load_with, criterion_of, add_slopes, stiffest_in, criterion_spread

   real(wp), parameter :: stiffest_of_all = 1.0e3_wp !! bare loads over squares of reaches: no spring is stiffer without a limit
   real(wp), parameter :: no_limit = 1.0e6_wp      !! of that stiffness: a limit of the user's beyond it is none, and spoils scales
   integer, parameter :: criterion_spread = -1     !! RMS of the differences from the mean: smooth, on the way to the range

   !> How one end of a spring moves, and what a wrench there does to the load.
   type :: spring_path_t
      real(wp), allocatable :: x(:), y(:)          !! shape (positions): place from which the end is counted, m
      real(wp), allocatable :: c(:), s(:)          !! direction of its link's axes
      real(wp), allocatable :: slope(:, :, :)      !! shape (positions, components, 3): load by force x, y, moment
   end type spring_path_t

   !> Limits of a spring: where its ends may be, stiffness, free length.
   type :: spring_limits_t
      type(spring_path_t) :: ends(2)
      real(wp) :: reach(2) = 0.0_wp                !! of the ends, m; 0: given
      real(wp) :: stiffest = 0.0_wp                !! N/m; 0: no limit
      real(wp) :: free(2) = 0.0_wp                 !! least and greatest free length, m; of a coordinate of its own rad or m
      ! only of a spring with a coordinate of its own
      real(wp), allocatable :: coordinate(:)       !! shape (positions): angle between its links, rad, or distance along a slide, m
      real(wp), allocatable :: unit(:, :)          !! shape (positions, components): load by a unit moment, or pull
   end type spring_limits_t

   type :: found_spring_t
      real(wp) :: at(2, 2) = 0.0_wp                !! x, y of the ends, from where they are counted, in the axes of their links, m
      real(wp) :: stiffness = 0.0_wp               !! N/m
      real(wp) :: free = 0.0_wp                    !! m
   end type found_spring_t

contains

   !> The criterion of a load. Shape of `load`: (positions, components).
   pure real(wp) function criterion_of(criterion, load) result(value)
      integer, intent(in) :: criterion
      real(wp), intent(in) :: load(:, :)

      select case (criterion)
      case (criterion_range)
         value = maxval(load(:, 1)) - minval(load(:, 1))
      case (criterion_rms)
         value = sqrt(sum(load**2)/real(size(load), wp))
      case (criterion_spread)
         value = norm2(load - spread(sum(load, dim=1)/real(size(load, 1), wp), 1, size(load, 1)))/sqrt(real(size(load), wp))
      case default
         value = sqrt(maxval(sum(load**2, dim=2)))
      end select
   end function criterion_of

   !> The greatest stiffness of a spring, N/m: the user's, or one that depends on the bare load and the limits, for without a limit
   !> the load is often least with an end that nearly coincides with a joint and a stiffness beyond all limits.
   pure real(wp) function stiffest_in(allowed, bare) result(stiffness)
      type(spring_limits_t), intent(in) :: allowed
      real(wp), intent(in) :: bare(:, :)         !! shape (positions, components): the load without springs
      real(wp) :: length

      if (allocated(allowed%coordinate)) then
         stiffness = stiffest_of_all*maxval(abs(bare))/max(maxval(abs(allowed%unit))* &
                     (maxval(allowed%coordinate) - minval(allowed%coordinate)), tiny(1.0_wp)/epsilon(1.0_wp))
      else
         length = max(maxval(allowed%reach), allowed%free(2))
         if (.not. length > 0.0_wp) length = 1.0_wp
         stiffness = stiffest_of_all*maxval(abs(bare))/length**2
      end if
      if (.not. allowed%stiffest > 0.0_wp) return
      if (allowed%stiffest/no_limit < stiffness .or. .not. stiffness > 0.0_wp) then
         stiffness = allowed%stiffest
      else
         stiffness = no_limit*stiffness
      end if
   end function stiffest_in

   !> The load with springs. Shape: (positions, components).
   pure function load_with(bare, allowed, springs) result(load)
      real(wp), intent(in) :: bare(:, :)
      type(spring_limits_t), intent(in) :: allowed(:)
      type(found_spring_t), intent(in) :: springs(:)
      real(wp), allocatable :: load(:, :)
      integer :: k

      load = bare
      do k = 1, size(springs)
         call add_spring(allowed(k), springs(k), load)
      end do
   end function load_with

   !> Load of one spring, and with `slopes` its derivatives by the unknowns, shape (positions, components, 6).
   pure subroutine add_spring(allowed, spring, load, slopes)
      type(spring_limits_t), intent(in) :: allowed
      type(found_spring_t), intent(in) :: spring
      real(wp), intent(inout) :: load(:, :)
      real(wp), intent(out), optional :: slopes(:, :, :)
      real(wp), dimension(size(load, 1)) :: length, factor, pull_x, pull_y, along
      real(wp) :: z(size(load, 1), 2, 2)            ! ends: by position, x and y, end
      real(wp) :: gap(size(load, 1), 2), force(size(load, 1), 2), dz(size(load, 1), 2), k
      real(wp) :: way                               ! of an end as the gap counts it
      integer :: e, c

      k = spring%stiffness*spring%free
      if (allocated(allowed%coordinate)) then
         do c = 1, size(load, 2)
            load(:, c) = load(:, c) + (spring%stiffness*allowed%coordinate - k)*allowed%unit(:, c)
         end do
         if (.not. present(slopes)) return
         slopes(:, :, :4) = 0.0_wp
         do c = 1, size(load, 2)
            slopes(:, c, 5) = allowed%coordinate*allowed%unit(:, c)
            slopes(:, c, 6) = -allowed%unit(:, c)
         end do
         return
      end if
      do e = 1, 2
         associate (path => allowed%ends(e))
            z(:, 1, e) = path%x + path%c*spring%at(1, e) + (-path%s)*spring%at(2, e)
            z(:, 2, e) = path%y + path%s*spring%at(1, e) + path%c*spring%at(2, e)
         end associate
      end do
      gap = z(:, :, 2) - z(:, :, 1)
      length = max(hypotenuse(gap(:, 1), gap(:, 2)), tiny(1.0_wp)**0.25_wp)
      factor = spring%stiffness - k/length
      do c = 1, 2
         force(:, c) = factor*gap(:, c)
      end do
      do c = 1, size(load, 2)
         load(:, c) = load(:, c) + effect(force(:, 1), force(:, 2), c)
      end do
      if (.not. present(slopes)) return
      do e = 1, 2
         way = merge(-1.0_wp, 1.0_wp, e == 1)
         do c = 1, 2
            associate (path => allowed%ends(e))
               dz(:, 1) = merge(path%c, -path%s, c == 1)
               dz(:, 2) = merge(path%s, path%c, c == 1)
            end associate
            along = k/length/length**2*(gap(:, 1)*(way*dz(:, 1)) + gap(:, 2)*(way*dz(:, 2)))
            pull_x = factor*(way*dz(:, 1)) + along*gap(:, 1)
            pull_y = factor*(way*dz(:, 2)) + along*gap(:, 2)
            call put(slopes(:, :, 2*(e - 1) + c))
            along = dz(:, 1)*force(:, 2) - dz(:, 2)*force(:, 1)
            call turn(slopes(:, :, 2*(e - 1) + c))
         end do
      end do
      pull_x = gap(:, 1)
      pull_y = gap(:, 2)
      call put(slopes(:, :, 5))
      pull_x = -gap(:, 1)/length
      pull_y = -gap(:, 2)/length
      call put(slopes(:, :, 6))

   contains

      !> What a pull on the first end, and its opposite on the second, does to component `c` of the load.
      pure function effect(x, y, c)
         real(wp), intent(in) :: x(:), y(:)
         integer, intent(in) :: c
         real(wp) :: effect(size(load, 1))

         associate (p => allowed%ends(1)%slope(:, c, :), q => allowed%ends(2)%slope(:, c, :))
            effect = (p(:, 1) - q(:, 1))*x + (p(:, 2) - q(:, 2))*y + p(:, 3)*(z(:, 1, 1)*y - z(:, 2, 1)*x) - &
                     q(:, 3)*(z(:, 1, 2)*y - z(:, 2, 2)*x)
         end associate
      end function effect

      !> The derivative of the load by an unknown, from that of the pull.
      pure subroutine put(slope)
         real(wp), intent(out) :: slope(:, :)       ! shape (positions, components)
         integer :: component

         do component = 1, size(load, 2)
            slope(:, component) = effect(pull_x, pull_y, component)
         end do
      end subroutine put

      !> And of the arm at which end `e` is pulled.
      pure subroutine turn(slope)
         real(wp), intent(inout) :: slope(:, :)
         integer :: component

         do component = 1, size(load, 2)
            slope(:, component) = slope(:, component) - way*allowed%ends(e)%slope(:, component, 3)*along
         end do
      end subroutine turn
   end subroutine add_spring

   !> Derivatives alone.
   pure subroutine add_slopes(allowed, spring, slopes)
      type(spring_limits_t), intent(in) :: allowed
      type(found_spring_t), intent(in) :: spring
      real(wp), intent(out) :: slopes(:, :, :)
      real(wp) :: load(size(slopes, 1), size(slopes, 2))

      load = 0.0_wp
      call add_spring(allowed, spring, load, slopes)
   end subroutine add_slopes
end module psalm_spring_load
