!> Few positions first, more as a search proceeds: which of the prescribed positions are looked at when.
!>
!> The positions are put into an order in which each is as far from all before it as can be; a stage of a search has the first of
!> that order, twice as many as the stage before it, the last stage all of them. Source: the recommendation of Youssef, as Oldham
!> (1977), section 6.2, has it; which positions the few are to be is not said there.
module psalm_few_positions
   use psalm_error, only: problem_t
   use psalm_kinds, only: wp, full_turn
   implicit none (type, external)
   private
   public :: spread_order, stage_sizes, positions_of_stage, positions_far_apart, take_positions

contains

   !> Numbers of positions at the stages: `few`, twice as many, and so on, then all.
   pure function stage_sizes(few, all_positions) result(sizes)
      integer, intent(in) :: few            !! 0: there is one stage only
      integer, intent(in) :: all_positions
      integer, allocatable :: sizes(:)
      integer :: next

      allocate (sizes(0))
      next = few
      do while (next > 0 .and. next < all_positions)
         sizes = [sizes, next]
         next = 2*next
      end do
      sizes = [sizes, all_positions]
   end function stage_sizes

   !> Positions in an order in which each is as far as can be from the nearest of those before it, the first one first; of equally
   !> far ones the first. Those without weight, which no objective sees, come last.
   pure function spread_order(delt, weighs, turns) result(order)
      real(wp), intent(in) :: delt(:)       !! shape (positions): input increments
      logical, intent(in) :: weighs(:)      !! shape (positions)
      logical, intent(in) :: turns          !! the input turns: increments are degrees, and a turn apart they are the same
      integer :: order(size(delt))
      real(wp) :: away(size(delt)), from_last(size(delt))
      logical :: left(size(delt))
      integer :: i

      left = weighs
      away = huge(1.0_wp)
      do i = 1, size(delt)
         if (.not. any(left)) then
            left = .not. weighs
            away = huge(1.0_wp)
         end if
         order(i) = maxloc(away, dim=1, mask=left)
         left(order(i)) = .false.
         from_last = abs(delt - delt(order(i)))
         if (turns) from_last = abs(from_last - full_turn*anint(from_last/full_turn))
         away = min(away, from_last)
      end do
   end function spread_order

   !> Positions of a stage, in the order in which they are prescribed.
   pure function positions_of_stage(problem, positions) result(which)
      type(problem_t), intent(in) :: problem
      integer, intent(in) :: positions      !! how many
      integer, allocatable :: which(:)
      logical :: weighs(problem%positions)

      associate (n => problem%positions)
         weighs = any(problem%weight(:n, :) > 0.0_wp, dim=2)
         if (allocated(problem%target_weights)) weighs = weighs .or. any(problem%target_weights > 0.0_wp, dim=2)
         if (allocated(problem%rate_weight)) weighs = weighs .or. any(any(problem%rate_weight(:n, :, :) > 0.0_wp, dim=3), dim=2)
         which = positions_far_apart(problem%delt, weighs, .not. problem%mechanism%sliding_input, positions)
      end associate
   end function positions_of_stage

   !> So many positions as far apart as possible, in the order in which they are prescribed.
   pure function positions_far_apart(delt, weighs, turns, positions) result(which)
      real(wp), intent(in) :: delt(:)       !! as in `spread_order`
      logical, intent(in) :: weighs(:), turns
      integer, intent(in) :: positions      !! how many
      integer :: which(positions)
      logical :: taken(size(delt))
      integer :: i

      taken = .false.
      associate (order => spread_order(delt, weighs, turns))
         taken(order(:positions)) = .true.
      end associate
      which = pack([(i, i=1, size(delt))], taken)
   end function positions_far_apart

   !> The same problem at some of its positions.
   subroutine take_positions(problem, which, part)
      type(problem_t), intent(in) :: problem !! with desired values
      integer, intent(in) :: which(:)
      class(problem_t), allocatable, intent(out) :: part

      allocate (part, source=problem)
      if (allocated(problem%own_delt)) then
         call part%set_inputs(problem%delt(which), problem%own_delt(which, :))
      else
         call part%set_inputs(problem%delt(which))
      end if
      call part%set_desired(problem%wanted(which, :), problem%weight(which, :))
      if (allocated(problem%target_values)) then
         part%target_values = problem%target_values(which, :)
         part%target_weights = problem%target_weights(which, :)
      end if
      if (.not. allocated(problem%rate_desired)) return
      part%rate_desired = problem%rate_desired(which, :, :)
      part%rate_weight = problem%rate_weight(which, :, :)
   end subroutine take_positions
end module psalm_few_positions
