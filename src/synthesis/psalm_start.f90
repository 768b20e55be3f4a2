!> START makes the initial simplex.
!>
!> The first vertex is the user's linkage. Others are read from device 4 or drawn at random within limits.
!> Source: Oldham (1977), section 6.4.2 and appendix B3.
module psalm_start
   use psalm_constr, only: vertex_problem_t
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, i8
   use psalm_number, only: parse_real
   use psalm_random, only: random_t
   use psalm_simplx, only: simplex_t, simplex_rules_t
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: beginning_t, rules_of, start_simplex, random_limits, read_vertices, label_width, value_width, values_per_record

   integer, parameter :: values_per_record = 5  !! of device 4 and 7: (5X,5G15.7)
   integer, parameter :: label_width = 5, value_width = 15

   !> How the simplex was begun.
   type :: beginning_t
      real(wp), allocatable :: low(:), high(:) !! shape (nvar): limits of random vertices
      integer(i8), allocatable :: integer(:)   !! shape (vertices): the random integer a vertex was begun with; 0: it was given
      real(wp), allocatable :: drawn(:, :)     !! shape (nvar, vertices): vertices as they were drawn
   end type beginning_t

contains

   !> Coefficients and criteria of the simplex, as the data set gives them.
   pure type(simplex_rules_t) function rules_of(set) result(rules)
      type(data_set_t), intent(in) :: set

      rules = simplex_rules_t(bounce=set%method%bounce, expand=set%method%expand, snake=set%method%snake, &
                              reduce=set%method%reduce, shrink=set%method%shrink, &
                              niter=set%method%niter, ncheck=set%method%ncheck, fmin=set%method%fmin, small=set%method%small)
   end function rules_of

   !> Build the simplex and evaluate every vertex.
   !>
   !> `feasible` is false if the user's linkage violates the constraints and cannot be repaired; no other vertex is made then.
   subroutine start_simplex(set, search, supplied, istart, simplex, feasible, beginning)
      type(data_set_t), intent(in) :: set
      type(vertex_problem_t), intent(inout) :: search
      real(wp), intent(in) :: supplied(:, :)     !! shape (nvar, nguess): vertices from device 4
      integer, intent(in) :: istart              !! random integer to begin with
      type(simplex_t), intent(out) :: simplex
      logical, intent(out) :: feasible
      type(beginning_t), intent(out) :: beginning
      type(random_t) :: random
      integer :: i, k, nvar, vertices
      real(wp) :: deviate
      logical :: reached

      nvar = search%core
      vertices = set%method%vertices(nvar)
      allocate (simplex%v(nvar, vertices), simplex%f(vertices), source=0.0_wp)
      allocate (beginning%integer(vertices), source=0_i8)
      simplex%v(:, 1) = search%problem%parameters%first_values(search%problem%given)
      if (size(supplied, 2) > 0) simplex%v(:, 1) = supplied(:, 1)
      call random_limits(set, simplex%v(:, 1), beginning%low, beginning%high)
      beginning%drawn = simplex%v
      call search%settle(simplex%v(:, 1), simplex%f(1), feasible)
      if (.not. feasible) return
      random%state = int(istart, i8)
      do i = 2, vertices
         if (i <= size(supplied, 2)) then
            simplex%v(:, i) = supplied(:, i)
         else
            beginning%integer(i) = random%state
            do k = 1, nvar
               call random%next(deviate)
               simplex%v(k, i) = beginning%low(k) + deviate*(beginning%high(k) - beginning%low(k))
            end do
            beginning%drawn(:, i) = simplex%v(:, i)
         end if
         call search%settle(simplex%v(:, i), simplex%f(i), reached, towards=simplex%v(:, 1))
      end do
      simplex%best = minloc(simplex%f, dim=1)
   end subroutine start_simplex

   !> Limits the random vertices lie within: (1-VAR) v ... (1+VAR) v, or OPLOW ... OPHIGH.
   pure subroutine random_limits(set, values, low, high)
      type(data_set_t), intent(in) :: set
      real(wp), intent(in) :: values(:)
      real(wp), allocatable, intent(out) :: low(:), high(:)
      integer :: n

      n = size(values)
      if (set%method%var > 0.0_wp) then
         low = (1.0_wp - set%method%var)*values
         high = (1.0_wp + set%method%var)*values
      else
         low = set%limits%oplow(:n)
         high = set%limits%ophigh(:n)
      end if
   end subroutine random_limits

   !> Read vertices in the format (5X,5G15.7), each beginning a new record.
   !>
   !> Without labels a vertex begins every so many records; with labels I and F, as on device 7, it begins at each of them,
   !> final vertices come before initial ones, and everything that is not part of a vertex is passed over.
   !> Errors: too few vertices, or a field that is not a number.
   subroutine read_vertices(lines, nvar, wanted, vertices, findings)
      type(line_t), intent(in) :: lines(:)
      integer, intent(in) :: nvar, wanted          !! variables; vertices (NGUESS)
      real(wp), allocatable, intent(out) :: vertices(:, :) !! shape (nvar, wanted)
      type(diagnostics_t), intent(inout) :: findings
      integer, allocatable :: records(:)
      integer :: k, r, vertex
      real(wp) :: value
      logical :: valid

      allocate (vertices(nvar, wanted), source=0.0_wp)
      records = first_records(lines, nvar)
      if (size(records) < wanted) then
         call findings%error(to_text(wanted)//' vertices are declared, but device 4 holds '//to_text(size(records))// &
                             ' (give its file with --device4)', group='METHOD', item='NGUESS')
         return
      end if
      do vertex = 1, wanted
         do k = 1, nvar
            r = records(vertex) + (k - 1)/values_per_record
            valid = .false.
            if (r <= size(lines)) call field(lines(r)%text, mod(k - 1, values_per_record), value, valid)
            if (.not. valid) then
               call findings%error('device 4, line '//to_text(min(r, size(lines)))//': coordinate '//to_text(k)// &
                                   ' of a vertex is expected as a number in columns '// &
                                   to_text(label_width + 1 + value_width*mod(k - 1, values_per_record))//' to '// &
                                   to_text(label_width + value_width*(1 + mod(k - 1, values_per_record))))
               return
            end if
            vertices(k, vertex) = value
         end do
      end do

   contains

      subroutine field(text, index, value, valid)
         character(*), intent(in) :: text
         integer, intent(in) :: index
         real(wp), intent(out) :: value
         logical, intent(out) :: valid
         character(:), allocatable :: reason
         integer :: first, last

         first = label_width + index*value_width + 1
         last = min(first + value_width - 1, len(text))
         value = 0.0_wp
         valid = .false.
         if (first > last) return
         if (len_trim(text(first:last)) == 0) return
         call parse_real(trim(adjustl(text(first:last))), value, valid, reason)
      end subroutine field
   end subroutine read_vertices

   !> Lines at which vertices begin, the final ones first.
   pure function first_records(lines, nvar) result(records)
      type(line_t), intent(in) :: lines(:)
      integer, intent(in) :: nvar
      integer, allocatable :: records(:)
      integer, allocatable :: initial(:), final(:), plain(:)
      integer :: i

      allocate (initial(0), final(0), plain(0))
      do i = 1, size(lines)
         associate (text => lines(i)%text)
            if (len_trim(text) <= label_width) cycle
            if (text(:1) == '!' .or. text(:1) == ' ') then
               if (text(2:2) == 'I') initial = [initial, i]
               if (text(2:2) == 'F') final = [final, i]
            end if
            if (text(:label_width) == '') plain = [plain, i]
         end associate
      end do
      records = [final, initial]
      if (size(records) > 0) return
      records = [(plain(i), i=1, size(plain), (nvar + values_per_record - 1)/values_per_record)]
   end function first_records
end module psalm_start
