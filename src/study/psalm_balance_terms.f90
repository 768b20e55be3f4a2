!> The conditions of complete force balance as numbers: mass times distance of every weight, and what asks for it.
!>
!> Source: Oldham (1977), equations 11.15 to 11.21.
module psalm_balance_terms
   use psalm_angles, only: degrees_of
   use psalm_balance_study, only: balance_study_t, within_half_turn
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: balance_term_t, terms_of, condition_whole, condition_link

   ! what asks for a part of mass times distance
   integer, parameter :: condition_whole = 0       !! all together
   integer, parameter :: condition_link = 1        !! the mass of a link
   integer, parameter :: condition_weight = 2      !! each kilogram of another weight
   real(wp), parameter :: no_term = 1.0e-9_wp      !! of the largest of its kind: less is rounding

   !> One term of the condition that a weight satisfies.
   type :: balance_term_t
      integer :: body = 0                          !! that carries it
      integer :: kind = condition_whole
      integer :: source = 0                        !! the body that asks for it
      real(wp) :: product = 0.0_wp                 !! mass times distance from the anchor, kg and user's length
      real(wp) :: angle = 0.0_wp                   !! from the link's line, degrees
   end type balance_term_t

contains

   !> The terms of the conditions of a design, weight by weight, the whole first; terms of rounding are left out.
   function terms_of(study, design, metre) result(rows)
      type(balance_study_t), intent(in) :: study
      integer, intent(in) :: design                !! its conditions are there
      real(wp), intent(in) :: metre                !! metres in a unit of length
      type(balance_term_t), allocatable :: rows(:)
      type(balance_term_t) :: row
      complex(wp) :: whole
      real(wp) :: of_links, of_weights             ! the largest of each kind
      integer :: i, k, w

      allocate (rows(0))
      associate (of => study%designs(design), conditions => study%designs(design)%conditions)
         of_links = largest(conditions%by_links)
         of_weights = largest(conditions%by_weights)
         do i = 1, size(conditions%links)
            whole = sum(conditions%by_links(i, :))
            do w = 1, size(of%weights)
               k = findloc(conditions%links, of%weights(w)%body, dim=1)
               if (k > 0) whole = whole + of%weights(w)%mass*conditions%by_weights(i, k)
            end do
            call put(condition_whole, 0, whole, 0.0_wp)
            do k = 1, size(conditions%by_links, 2)
               call put(condition_link, k, conditions%by_links(i, k), of_links)
            end do
            do k = 1, size(conditions%links)
               call put(condition_weight, conditions%links(k), conditions%by_weights(i, k), of_weights)
            end do
         end do
      end associate

   contains

      pure real(wp) function largest(values)
         complex(wp), intent(in) :: values(:, :)

         largest = maxval(hypotenuse(real(values, wp), aimag(values)))
      end function largest

      subroutine put(kind, source, value, of_kind)
         integer, intent(in) :: kind, source
         complex(wp), intent(in) :: value          !! kg m, axes of the link
         real(wp), intent(in) :: of_kind           !! the largest value of this kind

         associate (amount => hypotenuse(real(value, wp), aimag(value)))
            if (kind /= condition_whole .and. amount <= no_term*of_kind) return
            row%body = study%designs(design)%conditions%links(i)
            row%kind = kind
            row%source = source
            row%product = amount/metre
            row%angle = 0.0_wp
            if (amount > 0.0_wp) row%angle = within_half_turn(degrees_of(real(value, wp), aimag(value)) - &
                                                               study%line_angle(row%body))
         end associate
         rows = [rows, row]
      end subroutine put
   end function terms_of
end module psalm_balance_terms
