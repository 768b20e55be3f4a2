!> Which dimensions of a mechanism vary: variables, their bounds, and the arcs that follow each of them.
!>
!> A mechanism knows nothing of it: a search, a tolerance analysis and a derivative may each let other dimensions vary.
module psalm_parameters
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, arc_determined
   use psalm_sketch, only: sketch_name
   use psalm_text, only: lower_case, to_text
   implicit none (type, external)
   private
   public :: variable_t, parameters_t, no_parameters, name_of, words_of, length_name
   public :: variable_length, variable_outlk, variable_origlk, variable_gama, variable_outang, variable_origng, variable_crnki
   public :: variable_aside, variable_aside_angle

   integer, parameter :: variable_length = 1, variable_outlk = 2, variable_origlk = 3, variable_gama = 4
   integer, parameter :: variable_outang = 5, variable_origng = 6, variable_crnki = 7
   integer, parameter :: variable_aside = 8, variable_aside_angle = 9 !! of a joint off the arcs: from the end of one

   integer, parameter :: name_length = 4*sketch_name + 3 !! of the joints of two lines

   !> One variable and the dimension it stands for.
   type :: variable_t
      integer :: kind = 0             !! one of `variable_...`
      integer :: loop = 0, arc = 0    !! of a length or an angle: the arc, by its number in its loop
      integer :: n = 0                !! the same arc's number in the mechanism; of a joint off the arcs its number in the sketch
      character(name_length) :: of = '' !! the joints that it is between, of a sketch
   end type variable_t

   !> The dimensions that vary. A length or an angle that several arcs share is one variable.
   type :: parameters_t
      type(variable_t), allocatable :: variables(:) !! shape (nvar)
      integer, allocatable :: length_variable(:), angle_variable(:) !! by arc: the variable it follows, 0: fixed
      logical, allocatable :: takes_angle(:)        !! by arc: it has a GAMA of its own, which `apply` sets
   contains
      procedure :: vary
      procedure :: vary_aside
      procedure :: vary_length
      procedure :: vary_angle
      procedure :: vary_phase
      procedure :: first_values
      procedure :: apply
      procedure :: has_search
   end type parameters_t

contains

   !> Parameters of a mechanism of which nothing varies yet.
   pure function no_parameters(mechanism) result(parameters)
      type(mechanism_t), intent(in) :: mechanism
      type(parameters_t) :: parameters

      allocate (parameters%variables(0))
      allocate (parameters%length_variable(size(mechanism%arcs)), parameters%angle_variable(size(mechanism%arcs)), source=0)
      parameters%takes_angle = .not. mechanism%arcs%same
   end function no_parameters

   !> One more variable that is no dimension of an arc.
   pure subroutine vary(self, mechanism, kind)
      class(parameters_t), intent(inout) :: self
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: kind  !! one of `variable_...`
      type(variable_t) :: one

      one%kind = kind
      if (kind == variable_outlk) one%of = mechanism%length_called(0)
      if (kind == variable_outang) one%of = mechanism%angle_called(0)
      self%variables = [self%variables, one]
   end subroutine vary

   !> The distance of a joint off the arcs from the end of one varies, or the angle of that line from the arc.
   pure subroutine vary_aside(self, mechanism, kind, joint, arc, from_start, name)
      class(parameters_t), intent(inout) :: self
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: kind        !! `variable_aside` or `variable_aside_angle`
      integer, intent(in) :: joint       !! of the sketch
      integer, intent(in) :: arc         !! sequential number of the arc
      logical, intent(in) :: from_start  !! of the arc, else from its finish
      character(*), intent(in) :: name   !! of the joint
      type(variable_t) :: one
      character(sketch_name) :: ends(2)

      one = variable_t(kind, mechanism%arcs(arc)%loop, mechanism%arcs(arc)%place, joint)
      ends = [character(sketch_name) :: mechanism%ends(merge(1, 2, from_start), arc), name]
      if (kind == variable_aside) then
         if (ends(1) > ends(2)) ends = ends([2, 1])
         one%of = trim(ends(1))//' '//trim(ends(2))
      else
         one%of = mechanism%line_called(arc)//' '//trim(ends(1))//' '//trim(ends(2))
      end if
      self%variables = [self%variables, one]
   end subroutine vary_aside

   !> The length of an arc varies, and with it that of all arcs identical with it; an arc that slides has none of its own, nor has
   !> one from a joint to itself.
   pure subroutine vary_length(self, mechanism, n)
      class(parameters_t), intent(inout) :: self
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: n
      integer :: first

      first = mechanism%arcs(n)%representative
      if (mechanism%slides(n) .or. mechanism%is_one_joint(n) .or. self%length_variable(first) > 0) return
      self%variables = [self%variables, variable_t(variable_length, mechanism%arcs(first)%loop, mechanism%arcs(first)%place, &
                                                    first, mechanism%length_called(first))]
      where (mechanism%arcs%representative == first) self%length_variable = size(self%variables)
   end subroutine vary_length

   !> The angle of a determined arc varies, and with it that of all arcs that take their direction from it. An arc that is
   !> identical with another has none of its own, nor has one from a joint to itself.
   pure subroutine vary_angle(self, mechanism, n)
      class(parameters_t), intent(inout) :: self
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: n
      integer :: i, owner

      owner = mechanism%angle_owner(n)
      if (mechanism%arcs(owner)%kind /= arc_determined .or. self%angle_variable(owner) > 0) return
      if (mechanism%arcs(owner)%representative /= owner .or. mechanism%is_one_joint(owner)) return
      self%variables = [self%variables, variable_t(variable_gama, mechanism%arcs(owner)%loop, mechanism%arcs(owner)%place, &
                                                    owner, mechanism%angle_called(owner))]
      do i = 1, size(mechanism%arcs)
         if (mechanism%arcs(i)%kind /= arc_determined) cycle
         if (mechanism%angle_owner(i) == owner) self%angle_variable(i) = size(self%variables)
      end do
   end subroutine vary_angle

   !> How a wheel in gear stands to the other: its direction in the drawing, from which its turns are counted.
   pure subroutine vary_phase(self, mechanism, n)
      class(parameters_t), intent(inout) :: self
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: n           !! an arc of the wheel, whose direction a group with gears finds

      if (self%angle_variable(n) > 0) return
      self%variables = [self%variables, variable_t(variable_gama, mechanism%arcs(n)%loop, mechanism%arcs(n)%place, n, &
                                                    mechanism%angle_called(n))]
      self%angle_variable(n) = size(self%variables)
   end subroutine vary_phase

   !> True if any dimension may vary.
   pure logical function has_search(self)
      class(parameters_t), intent(in) :: self

      has_search = size(self%variables) > 0
   end function has_search

   !> The variables' values in the given linkage. Shape of the result: (nvar).
   pure function first_values(self, dimensions) result(values)
      class(parameters_t), intent(in) :: self
      type(dimensions_t), intent(in) :: dimensions
      real(wp), allocatable :: values(:)
      integer :: i

      allocate (values(size(self%variables)))
      do i = 1, size(values)
         associate (v => self%variables(i))
            select case (v%kind)
            case (variable_length)
               values(i) = dimensions%arcl(v%n)
            case (variable_gama)
               values(i) = dimensions%gama(v%n)
            case (variable_aside)
               values(i) = dimensions%aside_length(v%n)
            case (variable_aside_angle)
               values(i) = dimensions%aside_angle(v%n)
            case (variable_outlk)
               values(i) = dimensions%outlk
            case (variable_outang)
               values(i) = dimensions%outang
            case (variable_origlk)
               values(i) = dimensions%origlk
            case (variable_origng)
               values(i) = dimensions%origng
            case default
               values(i) = dimensions%crnki
            end select
         end associate
      end do
   end function first_values

   !> Put variables into the linkage, identical arcs included.
   pure subroutine apply(self, values, dimensions)
      class(parameters_t), intent(in) :: self
      real(wp), intent(in) :: values(:)              !! shape (nvar)
      type(dimensions_t), intent(inout) :: dimensions
      integer :: i, n

      do i = 1, size(self%variables)
         select case (self%variables(i)%kind)
         case (variable_aside)
            dimensions%aside_length(self%variables(i)%n) = values(i)
         case (variable_aside_angle)
            dimensions%aside_angle(self%variables(i)%n) = values(i)
         case (variable_outlk)
            dimensions%outlk = values(i)
         case (variable_outang)
            dimensions%outang = values(i)
         case (variable_origlk)
            dimensions%origlk = values(i)
         case (variable_origng)
            dimensions%origng = values(i)
         case (variable_crnki)
            dimensions%crnki = values(i)
         end select
      end do
      do n = 1, size(self%length_variable)
         if (self%length_variable(n) > 0) dimensions%arcl(n) = values(self%length_variable(n))
         if (self%angle_variable(n) > 0 .and. self%takes_angle(n)) dimensions%gama(n) = values(self%angle_variable(n))
      end do
   end subroutine apply

   !> What the length of an arc is called in sentences.
   pure function length_name(mechanism, n) result(words)
      type(mechanism_t), intent(in) :: mechanism
      integer, intent(in) :: n        !! sequential number of the arc
      character(:), allocatable :: words

      words = words_of(variable_t(variable_length, mechanism%arcs(n)%loop, mechanism%arcs(n)%place, n, mechanism%length_called(n)))
   end function length_name

   !> What a variable is called in sentences and tables: small letters, names of joints as they are.
   pure function words_of(variable) result(words)
      type(variable_t), intent(in) :: variable
      character(:), allocatable :: words

      words = name_of(variable)
      associate (own => len(words) - len_trim(variable%of))
         words(:own) = lower_case(words(:own))
      end associate
   end function words_of

   !> What a variable is called in listings.
   pure function name_of(variable) result(name)
      type(variable_t), intent(in) :: variable
      character(:), allocatable :: name

      if (len_trim(variable%of) > 0) then
         name = trim(merge('ANGLE ', 'LENGTH', any(variable%kind == [variable_gama, variable_outang, &
                                                                variable_aside_angle])))//' '//trim(variable%of)
         return
      end if
      select case (variable%kind)
      case (variable_length)
         name = 'LENGTH OF ARC '//to_text(variable%arc)//' IN LOOP '//to_text(variable%loop)
      case (variable_gama)
         name = 'ANGLE OF ARC '//to_text(variable%arc)//' IN LOOP '//to_text(variable%loop)
      case (variable_outlk)
         name = 'OUTPUT LENGTH'
      case (variable_outang)
         name = 'OUTPUT ANGLE'
      case (variable_origlk)
         name = 'INPUT PIVOT, DISTANCE'
      case (variable_origng)
         name = 'INPUT PIVOT, ANGLE'
      case default
         name = 'REFERENCE INPUT'
      end select
   end function name_of
end module psalm_parameters
