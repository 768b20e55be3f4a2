!> Which kind of linkage does what is wanted? All kinds of &KINDS, in several assemblies each, share the time of one search.
!>
!> First every assembly of every kind is screened: few random linkages, hardly improved. Then rounds of successive halving
!> follow: the best assemblies by what they have come to so far - 8, in the next round 16, and so on - are searched from some
!> starts, the better half of them from twice as many, until one is left. What a kind has found is kept from round to round. The
!> search ends when a linkage does what is wanted exactly, when PATNCE rounds brought nothing better, when all starts are made,
!> or when MAXTIME is over.
!>
!> Threads share the assemblies that are looked at, each of which is searched by one of them; where fewer are left, the starts of
!> each. What an assembly comes to depends on neither.
!>
!> Source: Jamieson and Talwalkar, Non-stochastic best arm identification and hyperparameter optimization (2016).
module psalm_kind_search
   use psalm_cases, only: resolve_drawn
   use psalm_data_set, only: data_set_t
   use psalm_kind_contender, only: kind_contender_t, prepare_search, screen_shared, search_shared, finish_shared, hits_of
   use psalm_kind_sketch, only: draw_at_random
   use psalm_kinds, only: wp
   use psalm_kinds_group, only: kinds_group_t, kinds_of
   use psalm_linkage_kinds, only: linkage_kind_t, wanted_kinds_t, find_kinds
   use psalm_method_group, only: method_group_t
   use psalm_preparation, only: prepared_t, prepare
   use psalm_search_group, only: search_group_t, ranking_common
   use psalm_sketch, only: sketch_t
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t
   use psalm_stop, only: stop_t
   use psalm_text, only: lower_case
   use psalm_traced_loops, only: traced_link
   use psalm_xoshiro, only: xoshiro_t, purpose_starts
   implicit none (type, external)
   private
   public :: kind_study_t, search_kinds, kinds_wanted, check_kinds
   public :: kinds_exact, kinds_patient, kinds_all, kinds_time, kinds_request, kinds_none

   ! how the search ended
   integer, parameter :: kinds_none = 0        !! there was nothing to search
   integer, parameter :: kinds_exact = 1       !! a linkage does exactly what is wanted
   integer, parameter :: kinds_patient = 2     !! PATNCE rounds brought nothing better
   integer, parameter :: kinds_all = 3         !! every kind had its NSTART
   integer, parameter :: kinds_time = 4        !! MAXTIME is over
   integer, parameter :: kinds_request = 5     !! the host asked for the end

   integer, parameter :: most_assemblies = 4   !! of a kind
   integer, parameter :: screened_at_once = 32  !! assemblies, then it is asked whether one is exact: not a number of threads
   integer, parameter :: drawings = 12         !! in a row without a new assembly, after which there are no more
   integer, parameter :: first_width = 8, first_starts = 2 !! of the first round
   integer, parameter :: usual_patience = 3    !! rounds
   real(wp), parameter :: better = 0.99_wp     !! of the objective before: what counts as better
   real(wp), parameter :: exact = 1.0e-9_wp    !! RMS error in sizes of what is wanted
   real(wp), parameter :: behind = 0.03_wp     !! RMS error, in the same sizes, by which a linkage that does not obey stands behind
   real(wp), parameter :: usual_low = 0.02_wp, usual_high = 5.0_wp !! bounds of lengths in these sizes
   real(wp), parameter :: of_screening = 0.35_wp, of_rounds = 0.9_wp !! parts of MAXTIME at which screenings and rounds end

   !> What was seen of a kind.
   type :: looked_t
      integer :: assemblies = 0                !! looked at
      integer :: starts = 0                    !! searched to their ends
      integer :: hits = 0                      !! of the best assembly: starts that led to its best linkage
      real(wp) :: best = huge(1.0_wp)          !! objective
      logical :: drawn = .true.                !! it could be traced
   end type looked_t

   type :: kind_study_t
      type(linkage_kind_t), allocatable :: kinds(:)
      type(looked_t), allocatable :: looked(:) !! shape (kinds)
      integer :: ending = kinds_none
      integer :: rounds = 0
      integer :: best_round = 0                !! in which the best linkage was found; 0: at the screening
      type(data_set_t), allocatable :: sets(:) !! cases of the best kinds, the best first
      type(prepared_t), allocatable :: prepared(:) !! with what was found
   end type kind_study_t

contains

   !> The kinds that a case asks for.
   subroutine kinds_wanted(set, kinds)
      type(data_set_t), intent(in) :: set
      type(linkage_kind_t), allocatable, intent(out) :: kinds(:)
      type(kinds_group_t) :: asked
      type(wanted_kinds_t) :: wanted
      logical, allocatable :: kept(:)
      integer :: k, i

      asked = kinds_of(set)
      wanted%links = asked%links
      wanted%slides = asked%slides
      wanted%drive = asked%drive
      wanted%output = asked%output
      wanted%largest_group = asked%largest_group
      call find_kinds(wanted, kinds)
      if (size(asked%only) == 0) return
      allocate (kept(size(kinds)), source=.false.)
      do k = 1, size(kinds)
         do i = 1, size(asked%only)
            kept(k) = kept(k) .or. index(lower_case(kinds(k)%name), lower_case(trim(asked%only(i)))) == 1
         end do
      end do
      kinds = kinds(pack([(k, k=1, size(kinds))], kept))
   end subroutine kinds_wanted

   !> What a search among kinds needs of its case.
   subroutine check_kinds(set, findings)
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings

      if (set%method%ikin /= 0) then
         call set%origins%error(findings, 'METHOD', 'IKIN', 'asks for an analysis, but &KINDS asks which linkage; leave it out')
      else if (.not. set%method%desired) then
         call set%origins%error(findings, 'KINDS', '', 'nothing is wanted: give a curve (&CURVE), or NDES and desired values '// &
                                'in &METHOD')
      end if
      if (set%method%isim /= 0) call findings%remark('ISIM: linkages of all kinds are placed, turned and enlarged to meet the '// &
                                                     'points; they are compared where they are')
      if (.not. set%search%solver%many_starts) call set%origins%error(findings, 'SEARCH', 'SOLVER', &
         "kinds are searched from many starts: leave SOLVER out (it is 'LSQ' then)")
   end subroutine check_kinds

   !> Search them. `set` has passed `check_kinds`.
   subroutine search_kinds(set, threads, stop, study)
      type(data_set_t), intent(in) :: set
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop            !! asked now and then
      class(kind_study_t), intent(inout) :: study
      type(kind_contender_t), allocatable :: contenders(:)
      type(kinds_group_t) :: asked
      type(stop_t) :: of_all, of_rounds_only, of_screenings
      real(wp) :: floor, handicap

      asked = kinds_of(set)
      call kinds_wanted(set, study%kinds)
      allocate (study%looked(size(study%kinds)), study%sets(0), study%prepared(0))
      study%ending = kinds_none
      if (size(study%kinds) == 0) return
      of_all = stop
      of_rounds_only = stop
      of_screenings = stop
      associate (time => set%search%maxtime)
         call of_all%limit_time(time)
         call of_rounds_only%limit_time(of_rounds*time)
         call of_screenings%limit_time(of_screening*time)
      end associate
      floor = max(set%method%fmin, real(set%method%ndes, wp)*(exact*extent_of(set))**2)
      handicap = real(set%method%ndes, wp)*(behind*extent_of(set))**2
      call draw_contenders(set, asked, study, contenders, of_screenings)
      if (stop%is_shared()) then
         call screen_together(contenders, threads, of_screenings, floor, handicap, set%search%nstart)
      else
         call screen(contenders, threads, of_screenings, of_rounds_only, floor, handicap, set%search%nstart)
      end if
      call make_rounds(set, asked, contenders, threads, of_rounds_only, floor, handicap, study)
      call take_results(asked, contenders, threads, of_all, study)
      if (of_all%requested()) study%ending = kinds_request
   end subroutine search_kinds

   !> Size of what is wanted: of points their extent.
   pure real(wp) function extent_of(set)
      type(data_set_t), intent(in) :: set

      associate (m => set%method)
         extent_of = max(maxval(m%desx) - minval(m%desx), maxval(m%desy) - minval(m%desy))
         if (.not. extent_of > 0.0_wp) extent_of = maxval(m%desang) - minval(m%desang)
      end associate
      if (.not. extent_of > 0.0_wp) extent_of = 1.0_wp
   end function extent_of

   !> Assemblies of every kind: joints drawn at random until no new signs come. First one of each kind, then another of each,
   !> and so on.
   subroutine draw_contenders(set, asked, study, contenders, stop)
      type(data_set_t), intent(in) :: set
      type(kinds_group_t), intent(in) :: asked
      class(kind_study_t), intent(inout) :: study
      type(kind_contender_t), allocatable, intent(out) :: contenders(:)
      type(stop_t), intent(in) :: stop
      type(kind_contender_t), allocatable :: one
      type(kind_contender_t) :: all_of_them(most_assemblies*size(study%kinds))
      type(xoshiro_t) :: random
      complex(wp) :: centre
      integer :: k, turn, n, tried, i
      logical :: new, valid

      centre = (0.0_wp, 0.0_wp)
      if (set%method%ndes > 0) centre = cmplx(sum(set%method%desx), sum(set%method%desy), wp)/real(set%method%ndes, wp)
      n = 0
      do turn = 1, most_assemblies
         do k = 1, size(study%kinds)
            if (turn > 1 .and. stop%waiting()) exit
            if (.not. study%looked(k)%drawn) cycle
            call random%seed(set%method%istart, purpose_starts)
            call random%use_stream(turn*size(study%kinds) + k)
            new = .false.
            do tried = 1, drawings
               allocate (one)
               one%kind = k
               call draw_case(set, asked, study%kinds(k), centre, random, one, valid)
               new = valid
               do i = 1, n
                  if (new .and. all_of_them(i)%kind == k) new = any(all_of_them(i)%signs /= one%signs)
               end do
               if (new) then
                  n = n + 1
                  call hand_over(one, all_of_them(n))
               else if (associated(one%set)) then
                  deallocate (one%set)
               end if
               deallocate (one)
               if (new) exit
            end do
            if (turn == 1) study%looked(k)%drawn = new
         end do
      end do
      allocate (contenders(n))
      do i = 1, n
         call hand_over(all_of_them(i), contenders(i))
      end do
   end subroutine draw_contenders

   subroutine hand_over(from, to)
      type(kind_contender_t), intent(inout) :: from, to

      to%kind = from%kind
      to%set => from%set
      from%set => null()
      call move_alloc(from%prepared, to%prepared)
      call move_alloc(from%signs, to%signs)
   end subroutine hand_over

   !> A case of a kind, drawn at random, ready to be searched. `valid` is false for a drawing that is none, or whose loops do
   !> not do.
   subroutine draw_case(set, asked, kind, centre, random, one, valid)
      type(data_set_t), intent(in) :: set
      type(kinds_group_t), intent(in) :: asked
      type(linkage_kind_t), intent(in) :: kind
      complex(wp), intent(in) :: centre
      type(xoshiro_t), intent(inout) :: random
      type(kind_contender_t), intent(inout) :: one
      logical, intent(out) :: valid
      type(data_set_t), allocatable :: drawn ! large
      type(method_group_t) :: method
      type(search_group_t) :: search
      type(sketch_t) :: sketch
      type(diagnostics_t) :: findings
      type(line_t) :: none(0)

      allocate (one%set, one%prepared, drawn)
      method = set%method
      method%nguess = 0
      method%isim = 0               ! all dimensions vary: it lies anywhere, in any size
      search = set%search
      search%first = 2              ! the first start would be the drawing
      search%ranking = ranking_common
      search%maxtime = 0.0_wp       ! of all kinds together
      sketch = set%sketch
      call draw_at_random(kind, asked%output, centre, extent_of(set), random, sketch)
      associate (every => sketch%variations(1))
         every%bounded = .true.
         every%low(1) = merge(asked%low, usual_low*extent_of(set), asked%low > 0.0_wp)
         every%high(1) = merge(asked%high, usual_high*extent_of(set), asked%high > 0.0_wp)
      end associate
      call set%redraw(trim(set%title)//': '//trim(kind%name), sketch, method, search, drawn)
      call resolve_drawn(drawn, one%set, findings)
      valid = .not. findings%failed()
      if (valid) valid = one%set%loops() > 0 .and. .not. allocated(one%set%search_in_poses)
      if (.not. valid) return
      call prepare(one%set, none, one%prepared, findings)
      valid = one%prepared%ready .and. .not. findings%failed()
      if (.not. valid) return
      associate (arcs => one%set%traced%arcs)
         one%signs = pack(arcs%sign, arcs%kind == traced_link)
      end associate
   end subroutine draw_case

   !> Few random linkages of each.
   subroutine screen(contenders, threads, stop, later, floor, handicap, most)
      type(kind_contender_t), intent(inout) :: contenders(:)
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop, later     !! of screenings; of what follows
      real(wp), intent(in) :: floor               !! objective below which a linkage is exact
      real(wp), intent(in) :: handicap            !! of linkages that do not obey
      integer, intent(in) :: most                 !! starts of each
      integer :: i, first, last

      do first = 1, size(contenders), screened_at_once
         last = min(first + screened_at_once - 1, size(contenders))
         !$omp parallel do num_threads(threads) schedule(dynamic)
         do i = first, last
            if (i == 1 .or. .not. stop%waiting()) call screen_one(contenders(i), stop, later, handicap)
         end do
         !$omp end parallel do
         call tell_starts(contenders, most, stop)
         if (minval(contenders(:last)%best) <= floor) return
      end do
   end subroutine screen

   !> Tell the host how many starts were made, screenings included, of how many at most.
   subroutine tell_starts(contenders, most, stop)
      type(kind_contender_t), intent(in) :: contenders(:)
      integer, intent(in) :: most                 !! starts of each
      type(stop_t), intent(in) :: stop
      real(wp) :: of

      of = min(real(size(contenders), wp)*real(1 + most, wp), real(huge(most), wp))
      call stop%tell(count(contenders%screened) + sum(contenders%starts), int(of))
   end subroutine tell_starts

   subroutine screen_one(one, stop, later, handicap)
      type(kind_contender_t), intent(inout) :: one
      type(stop_t), intent(in) :: stop, later     !! as `screen` has them
      real(wp), intent(in) :: handicap

      one%set%search%nstart = 1
      call prepare_search(one, stop, 1, one%search)
      call one%search%end_by(later)
      one%best = one%search%least_objective()
      one%promise = one%search%promise(handicap)
      one%screened = .true.
   end subroutine screen_one

   !> The screenings where the work is shared, in batches of more and more assemblies. What was screened after an exact linkage does
   !> not count, as if it had not been made.
   subroutine screen_together(contenders, threads, stop, floor, handicap, most)
      type(kind_contender_t), intent(inout) :: contenders(:)
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop
      real(wp), intent(in) :: floor, handicap     !! as `screen` has them
      integer, intent(in) :: most
      integer :: first, last, upto, width

      first = 1
      width = screened_at_once
      do while (first <= size(contenders))
         last = min(first + width - 1, size(contenders))
         call screen_shared(contenders(first:last), threads, stop, handicap)
         do upto = min(first + screened_at_once - 1, last), last, screened_at_once
            if (minval(contenders(:upto)%best) > floor) cycle
            contenders(upto + 1:)%screened = .false.
            contenders(upto + 1:)%best = huge(1.0_wp)
            contenders(upto + 1:)%promise = huge(1.0_wp)
         end do
         call tell_starts(contenders, most, stop)
         if (minval(contenders(:last)%best) <= floor) return
         first = last + 1
         width = 2*width
      end do
   end subroutine screen_together

   !> Rounds of halving, each of twice as many contenders as the one before.
   subroutine make_rounds(set, asked, contenders, threads, stop, floor, handicap, study)
      type(data_set_t), intent(in) :: set
      type(kinds_group_t), intent(in) :: asked
      type(kind_contender_t), intent(inout) :: contenders(:)
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop
      real(wp), intent(in) :: floor, handicap     !! as `screen` has them
      class(kind_study_t), intent(inout) :: study
      logical :: left(size(contenders))
      real(wp) :: best
      integer :: width, starts, k, patience, since

      patience = asked%patience
      if (patience < 0) patience = merge(0, usual_patience, set%search%maxtime > 0.0_wp)
      best = minval(contenders%best)
      width = first_width
      since = 0
      do
         study%ending = kinds_exact
         if (best <= floor) return
         study%ending = kinds_time
         if (stop%waiting()) return
         left = contenders%screened .and. contenders%starts < set%search%nstart
         study%ending = kinds_all
         if (.not. any(left)) return
         study%ending = kinds_patient
         if (patience > 0 .and. since >= patience) return
         study%rounds = study%rounds + 1
         call keep_best(contenders%promise, min(width, count(left)), left)
         starts = first_starts
         do while (any(left))
            if (stop%is_shared()) then
               call search_shared(contenders, left, starts, set%search%nstart, threads, stop, handicap)
            else if (count(left) < threads) then
               do k = 1, size(contenders)
                  if (.not. left(k) .or. stop%waiting()) cycle
                  call contenders(k)%search%share_among(threads)
                  call search_on(contenders(k), min(starts, set%search%nstart - contenders(k)%starts), handicap)
               end do
            else
               !$omp parallel do num_threads(threads) schedule(dynamic)
               do k = 1, size(contenders)
                  if (.not. left(k) .or. stop%waiting()) cycle
                  call search_on(contenders(k), min(starts, set%search%nstart - contenders(k)%starts), handicap)
               end do
               !$omp end parallel do
            end if
            call tell_starts(contenders, set%search%nstart, stop)
            if (count(left) == 1 .or. stop%waiting()) exit
            call keep_best(contenders%promise, (count(left) + 1)/2, left)
            starts = 2*starts
         end do
         since = since + 1
         if (minval(contenders%best) < better*best) since = 0
         if (since == 0) study%best_round = study%rounds
         best = minval(contenders%best)
         width = min(2*width, size(contenders))
      end do
   end subroutine make_rounds

   !> So many starts more.
   subroutine search_on(one, more, handicap)
      type(kind_contender_t), intent(inout) :: one
      integer, intent(in) :: more
      real(wp), intent(in) :: handicap            !! as `screen` has it

      call one%search%make_more_starts(more)
      one%starts = one%starts + more
      one%best = one%search%least_objective()
      one%promise = one%search%promise(handicap)
   end subroutine search_on

   !> Of those left so many of the best; of equals the first.
   pure subroutine keep_best(best, most, left)
      real(wp), intent(in) :: best(:)
      integer, intent(in) :: most
      logical, intent(inout) :: left(:)
      logical :: kept(size(left))
      integer :: i, k

      kept = .false.
      do i = 1, most
         k = minloc(best, dim=1, mask=left .and. .not. kept)
         kept(k) = .true.
      end do
      left = kept
   end subroutine keep_best

   !> The best assembly of each of the best kinds, searched on to convergence; then all are put in order.
   subroutine take_results(asked, contenders, threads, stop, study)
      type(kinds_group_t), intent(in) :: asked
      type(kind_contender_t), intent(inout) :: contenders(:)
      integer, intent(in) :: threads
      type(stop_t), intent(in) :: stop
      class(kind_study_t), intent(inout) :: study
      integer, allocatable :: chosen(:), order(:)
      real(wp) :: objective(size(contenders))
      logical :: unlisted(size(contenders))
      integer :: i, k

      do i = 1, size(contenders)
         associate (one => contenders(i), looked => study%looked(contenders(i)%kind))
            if (one%screened) looked%assemblies = looked%assemblies + 1
            looked%starts = looked%starts + one%starts
            if (one%best < looked%best) then
               looked%best = one%best
               looked%hits = hits_of(one, 1.0e-2_wp)
            end if
         end associate
      end do
      unlisted = contenders%screened .and. contenders%best < huge(1.0_wp)
      allocate (chosen(0))
      do while (any(unlisted) .and. size(chosen) < asked%listed)
         i = minloc(contenders%best, dim=1, mask=unlisted)
         chosen = [chosen, i]
         unlisted = unlisted .and. contenders%kind /= contenders(i)%kind
      end do
      objective = huge(1.0_wp)
      if (stop%is_shared()) then
         call finish_shared(contenders, chosen, threads, stop)
      else
         !$omp parallel do num_threads(threads) schedule(dynamic)
         do k = 1, size(chosen)
            call finish(contenders(chosen(k)), stop)
         end do
         !$omp end parallel do
      end if
      do k = 1, size(chosen)
         associate (one => contenders(chosen(k)))
            ! what was left undone of this kind is reported of all kinds together
            one%prepared%found%out_of_time = .false.
            one%prepared%found%next = 0
            one%set%search%nstart = max(1, one%starts)
            if (size(one%prepared%found%best) > 0) objective(chosen(k)) = one%prepared%found%best(1)%objective
            study%looked(one%kind)%best = min(study%looked(one%kind)%best, objective(chosen(k)))
         end associate
      end do
      allocate (order(0))
      unlisted = .false.
      unlisted(chosen) = objective(chosen) < huge(1.0_wp)
      do while (any(unlisted))
         i = minloc(objective, dim=1, mask=unlisted)
         unlisted(i) = .false.
         order = [order, i]
      end do
      deallocate (study%sets, study%prepared)
      allocate (study%sets(size(order)), study%prepared(size(order)))
      do k = 1, size(order)
         study%sets(k) = contenders(order(k))%set
         study%prepared(k) = contenders(order(k))%prepared
      end do
      do i = 1, size(contenders)
         if (associated(contenders(i)%set)) deallocate (contenders(i)%set)
      end do
   end subroutine take_results

   subroutine finish(one, stop)
      type(kind_contender_t), intent(inout) :: one
      type(stop_t), intent(in) :: stop

      call one%search%end_by(stop)
      allocate (one%prepared%found)
      call one%search%finish(one%prepared%found)
   end subroutine finish
end module psalm_kind_search
