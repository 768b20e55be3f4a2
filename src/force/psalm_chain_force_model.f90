!> Masses, loads, springs and friction of a sketch that is followed in the poses of its links: places fixed in links.
!>
!> A place that is counted from the far end of a cylinder is on its rod and moves with it. Source of the groups: Oldham (1977),
!> 15.1; doc/manual.md, Forces.
module psalm_chain_force_model
   use psalm_angles, only: unit_vector
   use psalm_closure, only: closure_t
   use psalm_data_set, only: data_set_t
   use psalm_force_entries, only: loading_t, spring_law_t, loading_of, spring_law_of
   use psalm_kinds, only: wp
   use psalm_place, only: place_t
   use psalm_sketch, only: frame_link
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: chain_model_t, chain_spot_t, make_chain_model
   public :: pair_pin, pair_slide, pair_gears

   integer, parameter :: pair_pin = 1      !! two links at a joint
   integer, parameter :: pair_slide = 2    !! two links at a slide
   integer, parameter :: pair_gears = 3    !! two wheels
   real(wp), parameter :: rounding = 64.0_wp*epsilon(1.0_wp) !! of sums of masses that cancel

   !> What joins two links. Listings print what the first does to the second.
   type :: link_pair_t
      character(:), allocatable :: name
      integer :: kind = pair_pin
      integer :: which = 0                 !! joint, slide or gear pair
      integer :: links(2) = 0
   end type link_pair_t

   !> A place fixed in a link, or in the rod of a cylinder.
   type :: chain_spot_t
      integer :: link = frame_link
      complex(wp) :: at = (0.0_wp, 0.0_wp)    !! in the axes of the link, user's length
      complex(wp) :: along = (1.0_wp, 0.0_wp) !! unit vector of the line it was named by, in these axes
      complex(wp) :: rod = (0.0_wp, 0.0_wp)   !! unit vector of the cylinder whose rod it is on, in these axes; 0: on the link
   end type chain_spot_t

   type, extends(loading_t) :: chain_load_t
      type(chain_spot_t) :: spot
      complex(wp) :: force = (0.0_wp, 0.0_wp) !! N; machine axes, or along and across the line if it turns
   end type chain_load_t

   type, extends(spring_law_t) :: chain_spring_t
      type(chain_spot_t) :: ends(2)
   end type chain_spring_t

   type :: chain_friction_t
      integer :: pair = 0
      real(wp) :: coefficient = 0.0_wp
      real(wp) :: radius = 0.0_wp             !! of the pin, half the length of the shoe; user's length
   end type chain_friction_t

   type :: chain_model_t
      real(wp) :: metre = 1.0_wp              !! metres in a unit of length
      complex(wp) :: gravity = (0.0_wp, 0.0_wp) !! m/s2
      type(link_pair_t), allocatable :: pairs(:)
      type(chain_spot_t), allocatable :: centres(:) !! shape (entries of MASSES)
      real(wp), allocatable :: mass(:), inertia(:)  !! the same shape: kg; kg m2 about the entry's own centre
      type(chain_load_t), allocatable :: loads(:)
      type(chain_spring_t), allocatable :: springs(:)
      type(chain_friction_t), allocatable :: friction(:)
      real(wp), allocatable :: table_input(:)       !! shape (rows): degrees or user's length, ascending
      real(wp), allocatable :: table_factor(:, :)   !! shape (rows, tables)
   end type chain_model_t

contains

   !> Put the groups of a data set on the links of its sketch, which was assembled.
   !>
   !> Errors: a link whose mass or inertia is negative, friction in a pin of the link that holds it, superfluous constraints, whose
   !> forces no equation of equilibrium tells. Warning: a mass on the frame, a spring within one link.
   subroutine make_chain_model(set, closure, model, findings)
      type(data_set_t), intent(in) :: set
      type(closure_t), intent(in) :: closure
      type(chain_model_t), intent(out) :: model
      type(diagnostics_t), intent(inout) :: findings
      integer :: k, g

      do g = 1, size(closure%groups)
         if (closure%groups(g)%equations <= 3*size(closure%groups(g)%links)) cycle
         call set%origins%error(findings, 'CHAIN', 'KOVER', 'KOVER allows superfluous constraints; how forces divide between '// &
                                'them depends on the stiffness of the links, which is not known here')
         exit
      end do
      call list_pairs(closure, model%pairs)
      model%metre = set%masses%metre
      model%gravity = cmplx(set%masses%gravity(1), set%masses%gravity(2), wp)
      model%mass = set%masses%mass
      model%inertia = set%masses%inertia
      allocate (model%centres(size(model%mass)), model%loads(size(set%loads%places)), model%springs(size(set%springs%first)), &
                model%friction(size(set%friction%joints)))
      do k = 1, size(model%centres)
         model%centres(k) = spot_of(closure, set%masses%places(k))
         if (model%centres(k)%link == frame_link) &
            call set%origins%warning(findings, 'MASSES', 'MNAME', 'entry '//to_text(k)//' is a mass on the frame: it has no '// &
                                     'effect', k)
      end do
      call check_masses(set, closure, model, findings)
      do k = 1, size(model%loads)
         associate (load => model%loads(k))
            load%spot = spot_of(closure, set%loads%places(k))
            load%force = cmplx(set%loads%force(1, k), set%loads%force(2, k), wp)
            load%loading_t = loading_of(set%loads, k)
         end associate
      end do
      model%table_input = set%loads%input
      model%table_factor = set%loads%factor
      do k = 1, size(model%springs)
         associate (spring => model%springs(k))
            spring%ends(1) = spot_of(closure, set%springs%first(k))
            spring%ends(2) = spot_of(closure, set%springs%second(k))
            if (spring%ends(1)%link == spring%ends(2)%link .and. (spring%ends(1)%rod == spring%ends(2)%rod)) &
               call set%origins%warning(findings, 'SPRING', 'BNAME', 'entry '//to_text(k)//' has both its ends on the same '// &
                                        'link: it has no effect', k)
            spring%spring_law_t = spring_law_of(set%springs, k)
         end associate
      end do
      do k = 1, size(model%friction)
         model%friction(k)%coefficient = set%friction%coefficient(k)
         model%friction(k)%radius = set%friction%radius(k)
         model%friction(k)%pair = pair_of(model%pairs, set%friction%joints(k))
         if (model%friction(k)%pair == 0) &
            call set%origins%error(findings, 'FRICTN', 'FNAME', 'entry '//to_text(k)//': the pin is held by link '// &
                                   trim(set%sketch%links(set%friction%joints(k)%link)%name)//'; name another that turns on it', k)
      end do
   end subroutine make_chain_model

   !> The pairs: joint by joint every link with the one that holds the joint, then slides, then gears.
   subroutine list_pairs(closure, pairs)
      type(closure_t), intent(in) :: closure
      type(link_pair_t), allocatable, intent(out) :: pairs(:)
      integer, allocatable :: links(:)
      type(link_pair_t) :: one
      integer :: j, k

      allocate (pairs(0))
      associate (sketch => closure%sketch)
         do j = 1, size(sketch%joint_name)
            links = sketch%links_of(j)
            do k = 1, size(links)
               if (links(k) == closure%holder(j)) cycle
               one%kind = pair_pin
               one%which = j
               one%links = [closure%holder(j), links(k)]
               one%name = trim(sketch%joint_name(j))
               if (size(links) > 2) one%name = one%name//'.'//trim(sketch%links(links(k))%name)
               pairs = [pairs, one]
            end do
         end do
         do j = 1, size(sketch%slides)
            one%kind = pair_slide
            one%which = j
            one%links = sketch%slides(j)%links
            one%name = trim(sketch%slides(j)%name)
            pairs = [pairs, one]
         end do
         do j = 1, size(sketch%gears)
            one%kind = pair_gears
            one%which = j
            one%links = sketch%gears(j)%wheels
            one%name = trim(sketch%links(one%links(1))%name)//'-'//trim(sketch%links(one%links(2))%name)
            pairs = [pairs, one]
         end do
      end associate
   end subroutine list_pairs

   !> The pair that a joint or a slide names; 0: the link named holds the pin.
   pure integer function pair_of(pairs, place) result(found)
      type(link_pair_t), intent(in) :: pairs(:)
      type(place_t), intent(in) :: place
      integer :: k

      found = 0
      do k = 1, size(pairs)
         if (place%slide > 0) then
            if (pairs(k)%kind == pair_slide .and. pairs(k)%which == place%slide) found = k
            cycle
         end if
         if (pairs(k)%kind /= pair_pin .or. pairs(k)%which /= place%joint) cycle
         if (place%link == 0 .or. pairs(k)%links(2) == place%link) found = k
         ! of two links either may be said to turn in the other
         if (pairs(k)%links(1) == place%link .and. count(pairs%kind == pair_pin .and. pairs%which == place%joint) == 1) found = k
      end do
   end function pair_of

   !> A place of the data set on its link.
   pure type(chain_spot_t) function spot_of(closure, place) result(spot)
      type(closure_t), intent(in) :: closure
      type(place_t), intent(in) :: place
      complex(wp) :: h
      real(wp) :: c, s

      spot%link = place%link
      associate (points => closure%point(:, place%link))
         if (place%line(1) > 0) then
            h = points(place%line(2)) - points(place%line(1))
            spot%along = h/abs(h)
         end if
         if (place%joint > 0) then
            spot%at = points(place%joint)
            if (closure%cylinder(place%link) > 0 .and. abs(spot%at) > 0.0_wp) spot%rod = spot%at/abs(spot%at)
         end if
      end associate
      call unit_vector(place%angle, c, s)
      spot%at = spot%at + place%distance*cmplx(c, s, wp)*spot%along
   end function spot_of

   !> Refuse links whose mass, or inertia about the centre of mass, is negative.
   subroutine check_masses(set, closure, model, findings)
      type(data_set_t), intent(in) :: set
      type(closure_t), intent(in) :: closure
      type(chain_model_t), intent(in) :: model
      type(diagnostics_t), intent(inout) :: findings
      logical :: here(size(model%mass))
      real(wp) :: mass, inertia, size_of, size_of_inertia
      complex(wp) :: centre
      integer :: link, k

      do link = frame_link + 1, size(closure%sketch%links)
         here = model%centres%link == link
         if (.not. any(here)) cycle
         mass = sum(model%mass, mask=here)
         size_of = sum(abs(model%mass), mask=here)
         if (mass < -rounding*size_of) then
            call refuse('mass')
            cycle
         end if
         centre = (0.0_wp, 0.0_wp)
         if (mass > rounding*size_of) centre = sum(model%mass*model%centres%at, mask=here)/mass
         inertia = 0.0_wp
         size_of_inertia = 0.0_wp
         do k = 1, size(here)
            if (.not. here(k)) cycle
            inertia = inertia + model%inertia(k) + model%mass(k)*(abs(model%centres(k)%at - centre)*model%metre)**2
            size_of_inertia = size_of_inertia + abs(model%inertia(k)) + &
                              abs(model%mass(k))*(abs(model%centres(k)%at)*model%metre)**2
         end do
         if (inertia < -rounding*size_of_inertia) call refuse('moment of inertia')
      end do

   contains

      subroutine refuse(what)
         character(*), intent(in) :: what

         call set%origins%error(findings, 'MASSES', 'MASS', 'the entries of '//trim(closure%sketch%links(link)%name)//' add up '// &
                                'to a negative '//what, findloc(here, .true., dim=1, back=.true.))
      end subroutine refuse
   end subroutine check_masses
end module psalm_chain_force_model
