!> How links hang on the frame by pins: how far each is from it, by which pin, and which are adrift without their slides.
!>
!> Links and pins are nodes of a graph; a link is as far from the frame as the number of links on the shortest way to it. Source:
!> Oldham (1977), 11.4.
module psalm_pin_order
   use psalm_mechanism, only: mechanism_t, body_frame, joint_revolute
   implicit none (type, external)
   private
   public :: pin_order_t, order_by_pins

   !> Arrays have the shape (bodies), the frame first.
   type :: pin_order_t
      integer, allocatable :: order(:)     !! links on the way to the frame; 0: the frame
      integer, allocatable :: anchor(:)    !! point of the pin nearest the frame; 0: it has no pin
      logical, allocatable :: adrift(:)    !! it does not hang on the frame by pins
   end type pin_order_t

contains

   !> The shortest way from the frame through pins; for links that these do not reach, through slides too.
   subroutine order_by_pins(mechanism, pins)
      type(mechanism_t), intent(in) :: mechanism
      type(pin_order_t), intent(out) :: pins
      integer :: point_order(size(mechanism%points)), j, b
      logical :: more

      allocate (pins%order(size(mechanism%bodies)), source=-1)
      allocate (pins%anchor(size(mechanism%bodies)), source=0)
      pins%order(body_frame) = 0
      point_order = -1
      call spread_through_pins()
      pins%adrift = pins%order < 0
      more = any(pins%adrift)
      do while (more)
         more = .false.
         do j = 1, size(mechanism%joints)
            if (mechanism%joints(j)%kind == joint_revolute) cycle
            do b = 1, 2
               associate (body => mechanism%joints(j)%bodies(b), other => mechanism%joints(j)%bodies(3 - b))
                  if (.not. pins%adrift(body) .or. pins%order(other) < 0) cycle
                  if (pins%order(body) >= 0 .and. pins%order(body) <= pins%order(other) + 1) cycle
                  pins%order(body) = pins%order(other) + 1
                  more = .true.
               end associate
            end do
         end do
         call spread_through_pins()
      end do
      do j = size(mechanism%joints), 1, -1
         if (mechanism%joints(j)%kind /= joint_revolute) cycle
         do b = 1, 2
            associate (body => mechanism%joints(j)%bodies(b), point => mechanism%joints(j)%point)
               if (pins%anchor(body) == 0) pins%anchor(body) = point
               if (point_order(point) <= point_order(pins%anchor(body))) pins%anchor(body) = point
            end associate
         end do
      end do

   contains

      subroutine spread_through_pins()
         logical :: moves
         integer :: i, k

         moves = .true.
         do while (moves)
            moves = .false.
            do i = 1, size(mechanism%joints)
               if (mechanism%joints(i)%kind /= joint_revolute) cycle
               associate (point => mechanism%joints(i)%point)
                  do k = 1, 2
                     associate (body => mechanism%joints(i)%bodies(k))
                        if (pins%order(body) >= 0 .and. &
                            (point_order(point) < 0 .or. point_order(point) > pins%order(body))) then
                           point_order(point) = pins%order(body)
                           moves = .true.
                        end if
                        if (point_order(point) < 0) cycle
                        if (pins%order(body) < 0 .or. pins%order(body) > point_order(point) + 1) then
                           pins%order(body) = point_order(point) + 1
                           moves = .true.
                        end if
                     end associate
                  end do
               end associate
            end do
         end do
      end subroutine spread_through_pins
   end subroutine order_by_pins
end module psalm_pin_order
