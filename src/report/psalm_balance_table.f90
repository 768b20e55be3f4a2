!> Counterweights as tables.
module psalm_balance_table
   use psalm_balance_study, only: balance_study_t, outcome_t, channel_force, channel_moment, channel_torque
   use psalm_balance_terms, only: balance_term_t, terms_of
   use psalm_clearance_study, only: margins_t
   use psalm_kinds, only: wp
   use psalm_linear_loads, only: measure_t
   use psalm_tables, only: table_t, tables_t, table_of, for_programs
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: put_balance

   integer, parameter :: name_length = 80   !! characters of a word in a table

   !> An outcome and what it is called: `design 1`, `lightest`, `optimum`.
   type :: named_outcome_t
      character(name_length) :: name = ''
      type(outcome_t) :: of
   end type named_outcome_t

contains

   !> Tables designs, budgets, front; for other programs balance, links, minimal_sets, outcomes, weights, loads, too.
   subroutine put_balance(metre, study, tables)
      real(wp), intent(in) :: metre          !! metres in a unit of length
      type(balance_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer :: k

      call put_result(metre, study, tables)
      call put_links(study, tables)
      call put_outcomes(study, tables)
      call put_limits(study, tables)
      if (study%feasible .and. size(study%designs) > 0) then
         table = table_of('designs', 'a row for each set of counterweights: their mass, RMS of what the linkage does to its frame')
         associate (n => size(study%designs), of => study%designs)
            call table%add('design', [(k, k=1, n)])
            call table%add('mass', of%total, 'kg')
            call table%add('force', [(of(k)%loads(channel_force)%rms, k=1, n)], 'N')
            call table%add('moment', [(of(k)%loads(channel_moment)%rms, k=1, n)], 'N m')
            call table%add('torque', [(of(k)%loads(channel_torque)%rms, k=1, n)], trim(merge('N  ', 'N m', study%sliding)))
         end associate
         call tables%put(table)
      end if
      call put_conditions(metre, study, tables)
      if (size(study%budgets) > 0) then
         table = table_of('budgets', 'a row for each mass of the counterweights: the least RMS of the force on the frame')
         call table%add('mass', study%budgets%second, 'kg')
         call table%add('force', study%budgets%first, 'N')
         call table%add('bound', study%budgets%bound, 'N')
         call table%add('mass_needed', study%budgets%total, 'kg')
         call tables%put(table)
      end if
      if (.not. allocated(study%front)) return
      table = table_of('front', 'a row for each point of the front of two criteria')
      call table%add('first', study%front%first)
      call table%add('second', study%front%second)
      call table%add('bound', study%front%bound)
      call table%add('mass_needed', study%front%total, 'kg')
      call tables%put(table)
   end subroutine put_balance

   !> One row: whether complete balance is possible, and of a composite how it was found.
   subroutine put_result(metre, study, tables)
      real(wp), intent(in) :: metre
      type(balance_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table

      table = table_of('balance', 'one row: complete force balance; where a composite is asked for, its value', &
                       audience=for_programs)
      call table%add('feasible', [study%feasible])
      call table%add('counterweights', [study%number])
      call table%add('minimal_sets', [size(study%sets, 2)])
      call table%add('residual', [study%left])
      call table%add('linkage_mass', [study%mass], 'kg')
      call table%add('unit_of_length', [metre], 'm')
      if (allocated(study%optimum)) then
         associate (found => study%found)
            call table%add('composite_before', [study%composite])
            call table%add('composite_after', [found%value])
            call table%add('composite_bound', [found%bound])
            call table%add('convex', [found%convex])
            call table%add('proven', [found%convex .or. found%proven])
            call table%add('starts', [found%starts])
         end associate
      end if
      call tables%put(table)
   end subroutine put_result

   !> Terms of the conditions of designs; whether force and moment can be balanced together.
   subroutine put_conditions(metre, study, tables)
      real(wp), intent(in) :: metre
      type(balance_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      type(balance_term_t), allocatable :: rows(:), more(:)
      character(name_length), allocatable :: source(:)
      integer, allocatable :: design(:)
      integer :: k

      allocate (rows(0), design(0))
      do k = 1, size(study%designs)
         if (.not. allocated(study%designs(k)%conditions)) cycle
         more = terms_of(study, k, metre)
         rows = [rows, more]
         design = [design, spread(k, 1, size(more))]
      end do
      if (size(rows) > 0) then
         allocate (source(size(rows)))
         source = ''
         where (rows%source > 0) source = named(study, max(rows%source, 1))
         table = table_of('conditions', 'a row for each term of the condition that a weight of a design satisfies: 0 all '// &
                          'together, 1 by the mass of a link, 2 by each kilogram of another weight', audience=for_programs)
         call table%add('design', design)
         call table%add('link', named(study, rows%body))
         call table%add('kind', rows%kind)
         call table%add('source', source)
         call table%add('product', rows%product, 'kg length')
         call table%add('angle', rows%angle, 'deg')
         call tables%put(table)
      end if
      if (.not. study%steady_wanted) return
      table = table_of('dynamic_balance', 'one row: the least shaking moment, RMS, with the force balanced, and its lower bound', &
                       audience=for_programs)
      associate (known => [allocated(study%steady)])
         call table%add('possible', [study%is_steady()])
         call table%add('before', [study%before(channel_moment)%rms], 'N m')
         if (allocated(study%steady)) then
            call table%add('after', [study%steady%loads(channel_moment)%rms], 'N m')
         else
            call table%add('after', [0.0_wp], 'N m', known)
         end if
         call table%add('bound', [study%steady_bound], 'N m', known)
      end associate
      call tables%put(table)
   end subroutine put_conditions

   !> The moving links, and the sets that need no more weights than any other: each by the links without a weight.
   subroutine put_links(study, tables)
      type(balance_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      integer, allocatable :: bare(:, :)          !! shape (2, rows): set, link
      integer :: b, k

      table = table_of('links', 'a row for each moving link', audience=for_programs)
      associate (links => [(b, b=2, size(study%names))])
         call table%add('link', named(study, links))
         call table%add('adrift', [(any(study%adrift == links(b)), b=1, size(links))])
         call table%add('allowed', [(any(study%allowed == links(b)), b=1, size(links))])
         call table%add('cannot_balance', [(any(study%out_of_reach == links(b)), b=1, size(links))])
      end associate
      call tables%put(table)
      allocate (bare(2, 0))
      do k = 1, size(study%sets, 2)
         do b = 2, size(study%names)
            if (all(study%sets(:, k) /= b)) bare = reshape([bare, k, b], [2, size(bare, 2) + 1])
         end do
      end do
      table = table_of('minimal_sets', 'a row for each set of fewest weights and link that carries none', audience=for_programs)
      call table%add('set', bare(1, :))
      call table%add('link', named(study, bare(2, :)))
      call tables%put(table)
   end subroutine put_links

   !> Names of bodies, copied one by one: gfortran 12 fails on names(bodies) where their length is deferred.
   pure function named(study, bodies) result(names)
      type(balance_study_t), intent(in) :: study
      integer, intent(in) :: bodies(:)
      character(name_length) :: names(size(bodies))
      integer :: i

      do i = 1, size(bodies)
         names(i) = study%names(bodies(i))
      end do
   end function named

   !> Designs, the lightest weights and the optimum: their weights and what the linkage does with them.
   subroutine put_outcomes(study, tables)
      type(balance_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(named_outcome_t), allocatable :: list(:)
      type(table_t) :: table
      integer, allocatable :: of(:), at(:)        !! shape (rows): outcome, its entry
      character(name_length), allocatable :: links(:)
      integer :: i, k

      allocate (list(size(study%designs) + count([allocated(study%lightest), allocated(study%optimum)])))
      do k = 1, size(study%designs)
         list(k)%name = 'design '//to_text(k)
         list(k)%of = study%designs(k)
      end do
      k = size(study%designs)
      if (allocated(study%lightest)) then
         k = k + 1
         list(k)%name = 'lightest'
         list(k)%of = study%lightest
      end if
      if (allocated(study%optimum)) then
         list(size(list))%name = 'optimum'
         list(size(list))%of = study%optimum
      end if
      table = table_of('outcomes', 'a row for each choice of weights', audience=for_programs)
      call table%add('outcome', list%name)
      call table%add('mass', list%of%total, 'kg')
      call table%add('bound', list%of%bound)
      call table%add('gap', list%of%gap)
      call table%add('residual', list%of%residual)
      call tables%put(table)
      if (study%has_clearance) call put_contact(study, list, tables)

      of = [((k, i=1, size(list(k)%of%weights)), k=1, size(list))]
      at = [((i, i=1, size(list(k)%of%weights)), k=1, size(list))]
      table = table_of('weights', 'a row for each weight; places from the anchor, angles from the line of the link', &
                       audience=for_programs)
      call table%add('outcome', [(list(of(k))%name, k=1, size(of))])
      allocate (links(size(of)))
      do k = 1, size(of)
         links(k) = list(of(k))%of%weights(at(k))%link
      end do
      call table%add('link', links)
      call table%add('mass', [(list(of(k))%of%weights(at(k))%mass, k=1, size(of))], 'kg')
      call table%add('distance', [(list(of(k))%of%weights(at(k))%distance, k=1, size(of))], 'length')
      call table%add('angle', [(list(of(k))%of%weights(at(k))%angle, k=1, size(of))], 'deg')
      call table%add('inertia', [(list(of(k))%of%weights(at(k))%inertia, k=1, size(of))], 'kg m^2')
      call table%add('radius', [(list(of(k))%of%weights(at(k))%radius, k=1, size(of))], 'length')
      call table%add('thickness', [(list(of(k))%of%weights(at(k))%thickness, k=1, size(of))], 'length')
      if (study%tilts) call table%add('height', [(list(of(k))%of%weights(at(k))%height, k=1, size(of))], 'length')
      call tables%put(table)

      table = table_of('without_weight', 'a row for each choice of weights and link of a set that carries none', &
                       audience=for_programs)
      of = [integer ::]
      at = [integer ::]
      do k = 1, size(list)
         if (.not. allocated(list(k)%of%bare_links)) cycle
         of = [of, spread(k, 1, size(list(k)%of%bare_links))]
         at = [at, list(k)%of%bare_links]
      end do
      call table%add('outcome', [(list(of(k))%name, k=1, size(of))])
      call table%add('link', named(study, at))
      call tables%put(table)
      call put_loads(study, list, tables)
   end subroutine put_outcomes

   !> What becomes of contact in the joint with clearance, before and with each choice of weights.
   subroutine put_contact(study, list, tables)
      type(balance_study_t), intent(in) :: study
      type(named_outcome_t), intent(in) :: list(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      type(margins_t) :: margins(size(list) + 1)
      character(name_length) :: names(size(list) + 1)
      integer :: k

      names(1) = 'before'
      margins(1) = study%contact
      do k = 1, size(list)
         names(k + 1) = list(k)%name
         margins(k + 1) = list(k)%of%contact
      end do
      table = table_of('contact', 'a row for each choice of weights: least H1 of the joint with clearance, over that of a '// &
                       'loss, minima that lose contact', audience=for_programs)
      call table%add('outcome', names)
      call table%add('h1', margins%h1, known=margins%known)
      call table%add('over_passage', margins%over(1), known=margins%known .and. margins%over(1) < huge(1.0_wp))
      call table%add('over_any', margins%over(2), known=margins%known .and. margins%over(2) < huge(1.0_wp))
      call table%add('lost_in_passage', margins%lost(1))
      call table%add('lost', margins%lost(2))
      call tables%put(table)
   end subroutine put_contact

   !> Limits of loads of the composite, and what is reached.
   subroutine put_limits(study, tables)
      type(balance_study_t), intent(in) :: study
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      character(name_length), allocatable :: load(:)
      character(3), allocatable :: unit(:)
      integer :: k

      if (.not. (allocated(study%limited) .and. allocated(study%optimum))) return
      associate (n => size(study%limited))
         allocate (load(n), unit(n))
         do k = 1, n
            load(k) = load_of(study, study%limited(k))
            unit(k) = unit_of(study, study%limited(k))
         end do
         table = table_of('load_limits', 'a row for each limited load: greatest amount at any position with the weights of the '// &
                          'composite, limit', audience=for_programs)
         call table%add('load', load)
         call table%add('unit', unit)
         call table%add('peak', [(study%optimum%loads(study%limited(k))%peak, k=1, n)])
         call table%add('limit', study%limit)
      end associate
      call tables%put(table)
   end subroutine put_limits

   !> What a channel is called: `joint` and its name, or what acts on the frame or drives.
   pure function load_of(study, channel) result(load)
      type(balance_study_t), intent(in) :: study
      integer, intent(in) :: channel
      character(:), allocatable :: load

      select case (channel)
      case (channel_force)
         load = 'force'
      case (channel_moment)
         load = 'moment'
      case (channel_torque)
         load = 'torque'
      case default
         associate (name => study%channels(channel)%name)
            load = 'joint '//name(index(name, ' ') + 1:)
            if (is_tilt(study, channel)) load = 'out_of_plane_moment'
         end associate
      end select
   end function load_of

   pure function unit_of(study, channel) result(unit)
      type(balance_study_t), intent(in) :: study
      integer, intent(in) :: channel
      character(3) :: unit

      unit = 'N'
      if (channel == channel_moment .or. (channel == channel_torque .and. .not. study%sliding)) unit = 'N m'
      if (is_tilt(study, channel)) unit = 'N m'
   end function unit_of

   !> True of the moment out of the plane.
   pure logical function is_tilt(study, channel)
      type(balance_study_t), intent(in) :: study
      integer, intent(in) :: channel

      is_tilt = study%tilts .and. channel == size(study%channels)
   end function is_tilt

   !> What the linkage does to its frame, drive and joints, before and with each choice of weights.
   subroutine put_loads(study, list, tables)
      type(balance_study_t), intent(in) :: study
      type(named_outcome_t), intent(in) :: list(:)
      type(tables_t), intent(inout) :: tables
      type(table_t) :: table
      type(measure_t), allocatable :: loads(:)
      character(name_length), allocatable :: outcome(:), name(:)
      character(3), allocatable :: unit(:)
      real(wp), allocatable :: x(:), y(:)
      logical, allocatable :: apart(:)
      integer :: i, k

      associate (n => size(study%before), rows => size(study%before)*(size(list) + 1))
         allocate (loads(rows), outcome(rows), name(rows), unit(rows), apart(rows), x(rows), y(rows))
         outcome(:n) = 'before'
         loads(:n) = study%before
         do k = 1, size(list)
            outcome(k*n + 1:k*n + n) = list(k)%name
            loads(k*n + 1:k*n + n) = list(k)%of%loads
         end do
         do i = 1, rows
            name(i) = load_of(study, modulo(i - 1, n) + 1)
            unit(i) = unit_of(study, modulo(i - 1, n) + 1)
         end do
         do i = 1, rows
            associate (parts => loads(i)%parts)
               apart(i) = size(parts) == 2
               x(i) = parts(1)
               y(i) = parts(size(parts))
            end associate
         end do
         table = table_of('loads', 'a row for each choice of weights and load: root mean square and peak over the positions', &
                          audience=for_programs)
         call table%add('outcome', outcome)
         call table%add('load', name)
         call table%add('unit', unit)
         call table%add('rms', loads%rms)
         call table%add('peak', loads%peak)
         call table%add('rms_x', x, known=apart)
         call table%add('rms_y', y, known=apart)
      end associate
      call tables%put(table)
   end subroutine put_loads
end module psalm_balance_table
