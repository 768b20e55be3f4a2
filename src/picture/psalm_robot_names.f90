!> Names, numbers and shapes that files for multibody programs have in common.
module psalm_robot_names
   use psalm_elementary, only: hypotenuse
   use psalm_kinds, only: wp
   use psalm_link_outline, only: spine_of
   use psalm_markup, only: short_number, strings_t
   use psalm_multibody, only: multibody_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: robot_names_t, robot_names, row_of, bars_of, bar_radius, flat

   integer, parameter :: digits = 15
   real(wp), parameter :: flat(3) = [0.6_wp, 0.6_wp, 1.0_wp] !! moments of inertia of a plate by that about its normal: the first
                                                      !! two together not below the third
   real(wp), parameter :: shortest = 1.0e-6_wp       !! bar, as part of the size
   real(wp), parameter :: slenderness = 60.0_wp      !! size of the linkage over the radius of a bar

   !> Names that all three formats take: letters, digits, `_`, `-` and `.`, none of them twice.
   type :: robot_names_t
      type(strings_t), allocatable :: bodies(:), joints(:), relations(:), marked(:)
      character(:), allocatable :: model
   end type robot_names_t

contains

   function robot_names(model) result(names)
      type(multibody_t), intent(in) :: model
      type(robot_names_t) :: names
      type(strings_t), allocatable :: taken(:)
      integer :: k

      allocate (taken(2))
      taken(1)%text = 'world'                        ! has a meaning of its own
      taken(2)%text = 'default'
      allocate (names%bodies(size(model%bodies)), names%joints(size(model%joints)), names%relations(size(model%relations)), &
                names%marked(size(model%marked)))
      names%model = plain(model%name)
      if (len(names%model) == 0) names%model = 'linkage'
      do k = 1, size(names%bodies)
         names%bodies(k)%text = unique(plain(model%bodies(k)%name), 'link')
      end do
      do k = 1, size(names%joints)
         names%joints(k)%text = unique(plain(model%joints(k)%name), 'joint')
      end do
      do k = 1, size(names%marked)
         names%marked(k)%text = unique(plain(model%marked(k)%name), 'point')
      end do
      do k = 1, size(names%relations)
         names%relations(k)%text = unique(plain(model%relations(k)%name), 'relation')
      end do

   contains

      !> The name itself, with a word or a number behind it where it is taken.
      function unique(name, word) result(own)
         character(*), intent(in) :: name, word
         character(:), allocatable :: own
         integer :: n

         own = name
         if (len(own) == 0) own = word
         n = 0
         do while (is_taken(own))
            n = n + 1
            own = name//'_'//word
            if (n > 1) own = own//to_text(n)
         end do
         call take(own)
      end function unique

      logical function is_taken(name)
         character(*), intent(in) :: name
         integer :: i

         is_taken = any([(taken(i)%text == name, i=1, size(taken))])
      end function is_taken

      subroutine take(name)
         character(*), intent(in) :: name
         type(strings_t) :: one

         one%text = name
         taken = [taken, one]
      end subroutine take
   end function robot_names

   !> A name with `_` for whatever a format might not take.
   pure function plain(name) result(own)
      character(*), intent(in) :: name
      character(:), allocatable :: own
      character(*), parameter :: allowed = 'ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_.-'
      integer :: i

      own = trim(adjustl(name))
      do i = 1, len(own)
         if (index(allowed, own(i:i)) == 0) own(i:i) = '_'
      end do
   end function plain

   !> Numbers with blanks between them.
   pure function row_of(values) result(text)
      real(wp), intent(in) :: values(:)
      character(:), allocatable :: text
      integer :: i

      text = ''
      do i = 1, size(values)
         if (i > 1) text = text//' '
         text = text//short_number(values(i), digits)
      end do
   end function row_of

   !> What a body is drawn as: bars along the outline of its points, of a link with one point none. Shape (2, 2, bars).
   function bars_of(points, size_of) result(bars)
      real(wp), intent(in) :: points(:, :)           !! shape (2, points)
      real(wp), intent(in) :: size_of                !! of the mechanism
      real(wp), allocatable :: bars(:, :, :)
      integer, allocatable :: spine(:)
      integer :: n, i, kept

      if (size(points, 2) == 0) then
         allocate (bars(2, 2, 0))
         return
      end if
      spine = spine_of(points(1, :), points(2, :))
      n = size(spine)
      if (n < 3) n = n - 1                           ! a single bar
      allocate (bars(2, 2, n))
      kept = 0
      do i = 1, n
         associate (ends => points(:, [spine(i), spine(modulo(i, size(spine)) + 1)]))
            if (.not. hypotenuse(ends(1, 2) - ends(1, 1), ends(2, 2) - ends(2, 1)) > shortest*size_of) cycle
            kept = kept + 1
            bars(:, :, kept) = ends
         end associate
      end do
      bars = bars(:, :, :kept)
   end function bars_of

   pure real(wp) function bar_radius(model)
      type(multibody_t), intent(in) :: model

      bar_radius = model%size/slenderness
   end function bar_radius
end module psalm_robot_names
