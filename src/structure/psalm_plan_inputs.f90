!> What a case asks of its mechanism: outputs, variables, input positions; and whether that can be had.
module psalm_plan_inputs
   use psalm_data_set, only: data_set_t
   use psalm_dimensions, only: dimensions_t
   use psalm_kinds, only: wp
   use psalm_loop_groups, only: guide_of_dyad
   use psalm_loop_messages, only: arc_warning, complain, place_of
   use psalm_mechanism, only: mechanism_t, output_t, arc_actuator, arc_link, arc_slide
   use psalm_output_kind, only: motion_slide
   use psalm_parameters, only: parameters_t, words_of, variable_length
   use psalm_sort, only: ascending
   use psalm_status, only: diagnostics_t
   use psalm_number_format, only: number_words
   use psalm_text, only: to_text
   implicit none (type, external)
   private
   public :: find_output, check_dimensions, find_repeated

   integer, parameter :: most_named = 40 !! variables named in one message

contains

   !> The output of the loops; of a sketch the first of its outputs, or what is listed in its stead.
   subroutine find_output(set, mechanism, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(inout) :: mechanism
      type(diagnostics_t), intent(inout) :: findings
      integer :: arc

      if (set%method%ikin /= 0 .and. mechanism%sliding_input) then
         call set%origins%error(findings, 'METHOD', 'IKIN', 'IKIN sweeps a full turn; with a sliding input give NDES and DELT', 1)
      end if
      if (allocated(set%traced)) then
         mechanism%outputs = [output_t(set%traced%motion, set%traced%output_arc, set%traced%from_start, set%has_stand_in())]
         return
      end if
      if (set%links%noutlp < 1 .or. set%links%noutlp > set%links%nloop) then
         call set%origins%error(findings, 'LINKS', 'NOUTLP', 'must name a loop from 1 to '//to_text(set%links%nloop)//'; found '// &
                                to_text(set%links%noutlp), 1)
         return
      end if
      if (set%links%noutlk == 0 .or. abs(set%links%noutlk) > mechanism%loops(set%links%noutlp)%arcs) then
         call set%origins%error(findings, 'LINKS', 'NOUTLK', 'must name an arc from 1 to '// &
                                to_text(mechanism%loops(set%links%noutlp)%arcs)//' of loop '//to_text(set%links%noutlp)//'; '// &
                                'found '//to_text(set%links%noutlk), 1)
         return
      end if
      arc = mechanism%seq(set%links%noutlp, abs(set%links%noutlk))
      mechanism%outputs = [output_t(set%method%motion, arc, set%links%noutlk < 0)]
      if (set%method%motion == motion_slide .and. .not. mechanism%slides(arc)) then
         call set%origins%error(findings, 'LINKS', 'NOUTLK', 'MOTION=3 needs a sliding arc, but arc '//place_of(mechanism, arc)// &
                                ' does not slide', 1)
      end if
   end subroutine find_output

   !> Lengths that must be there, bounds that must be given.
   subroutine check_dimensions(set, mechanism, dimensions, parameters, findings)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(dimensions_t), intent(in) :: dimensions
      type(parameters_t), intent(in) :: parameters
      type(diagnostics_t), intent(inout) :: findings
      integer :: loop, a, n, guide, nvar

      do loop = 1, set%links%nloop
         do a = 1, mechanism%loops(loop)%arcs
            n = mechanism%seq(loop, a)
            guide = guide_of_dyad(mechanism, loop)
            select case (mechanism%arcs(n)%kind)
            case (arc_link)
               if (dimensions%arcl(n) == 0.0_wp .and. a /= guide .and. mechanism%is_dyad(loop)) then
                  call complain(set, 'ARCL', loop, a, 'is an undetermined link and needs a positive length', findings)
               end if
            case (arc_slide, arc_actuator)
               if (dimensions%arcl(n) /= 0.0_wp) then
                  call arc_warning(set, 'ARCL', loop, a, 'slides: the length given is not used', findings)
               end if
            end select
         end do
      end do
      nvar = size(parameters%variables)
      if (nvar == 0) return
      if (.not. (set%method%desired .or. set%sketch%has_targets())) then
         call set%origins%error(findings, 'METHOD', '', 'a search needs desired values (DESX and DESY, or DESANG)')
      end if
      if (set%limits%limval == 1 .or. set%method%var == 0.0_wp) then
         if (min(set%limits%low_given, set%limits%high_given) < nvar) then
            if (set%limits%low_given < nvar) call short('OPLOW', set%limits%low_given)
            if (set%limits%high_given < nvar) call short('OPHIGH', set%limits%high_given)
            return
         end if
         if (set%limits%low_given > nvar) call long('OPLOW', set%limits%low_given)
         if (set%limits%high_given > nvar) call long('OPHIGH', set%limits%high_given)
         do n = 1, nvar
            associate (variable => parameters%variables(n))
               if (set%limits%oplow(n) > set%limits%ophigh(n)) then
                  call of_variable('OPLOW', n, 'the lower limit '//limit(set%limits%oplow(n))//' of the '// &
                                   words_of(variable)//' is above its upper limit '//limit(set%limits%ophigh(n)))
               else if (variable%kind == variable_length .and. set%limits%ophigh(n) <= 0.0_wp) then
                  call of_variable('OPHIGH', n, 'a length needs an upper limit above zero; found '//limit(set%limits%ophigh(n))// &
                                   ' for the '//words_of(variable))
               end if
            end associate
         end do
      end if
      if (set%method%nvert > 0 .and. set%method%nvert <= nvar) then
         call set%origins%error(findings, 'METHOD', 'NVERT', 'a simplex of '//to_text(nvar)//' variables needs at least '// &
                                to_text(nvar + 1)//' vertices; found '//to_text(set%method%nvert), 1)
      else if (set%method%nguess > set%method%vertices(nvar)) then
         call set%origins%error(findings, 'METHOD', 'NGUESS', 'a simplex of '//to_text(nvar)//' variables has '// &
                                to_text(set%method%vertices(nvar))//' vertices; found '//to_text(set%method%nguess), 1)
      end if

   contains

      subroutine of_variable(item, which, text)
         character(*), intent(in) :: item, text
         integer, intent(in) :: which

         call set%origins%error(findings, 'LIMITS', item, text, which)
      end subroutine of_variable

      pure function limit(value) result(text)
         real(wp), intent(in) :: value
         character(:), allocatable :: text

         text = number_words(value)
      end function limit

      subroutine short(item, got)
         character(*), intent(in) :: item
         integer, intent(in) :: got
         character(:), allocatable :: names
         integer :: i

         names = words_of(parameters%variables(1))
         do i = 2, min(nvar, most_named)
            names = names//', '//words_of(parameters%variables(i))
         end do
         if (nvar > most_named) names = names//' and so on'
         call of_variable(item, 1, 'OPLOW and OPHIGH must give a value for each of the '//to_text(nvar)//' variables; found '// &
                          to_text(got)//'. The variables are '//names)
      end subroutine short

      subroutine long(item, got)
         character(*), intent(in) :: item
         integer, intent(in) :: got

         call set%origins%warning(findings, 'LIMITS', item, to_text(got)//' limits are given, but there are only '// &
                                  to_text(nvar)//' variables; the others are not used', nvar + 1)
      end subroutine long
   end subroutine check_dimensions

   !> A position given twice counts twice, and has two desired values.
   subroutine find_repeated(set, findings)
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      real(wp), allocatable :: sorted(:)
      integer :: i, first, second

      if (set%method%ikin /= 0 .or. set%method%ifree /= 0 .or. set%method%ndes < 2) return
      ! positions of several drives differ by the others
      if (any(.not. set%sketch%drives(2:)%geared)) return
      if (all(set%method%delt(2:) > set%method%delt(:set%method%ndes - 1)) .or. all(set%method%delt(2:) < &
                                                            set%method%delt(:set%method%ndes - 1))) return
      sorted = set%method%delt(ascending(set%method%delt))
      do i = 2, set%method%ndes
         if (sorted(i) == sorted(i - 1)) exit
      end do
      if (i > set%method%ndes) return
      first = findloc(set%method%delt, sorted(i), dim=1)
      second = first + findloc(set%method%delt(first + 1:), sorted(i), dim=1)
      call set%origins%warning(findings, 'METHOD', 'DELT', 'positions '//to_text(first)//' and '//to_text(second)//' have the '// &
                               'same input '//number_words(sorted(i)), second)
   end subroutine find_repeated
end module psalm_plan_inputs
