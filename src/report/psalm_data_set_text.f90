!> A linkage as text that can be read again: the vertices of a search and the complete data set, device 7.
!>
!> Numbers of the data set have as many digits as it takes to read the same bits back. The vertices stand in comment lines,
!> so that `psalm` reads the file as a case; as device 4 it supplies vertices.
module psalm_data_set_text
   use psalm_columns, only: add_item
   use psalm_data_set, only: data_set_t
   use psalm_limits_group, only: proof_by_default
   use psalm_kinds, only: wp, right_angle
   use psalm_output_kind, only: output_kind_t, output_kind
   use psalm_dimensions, only: dimensions_t
   use psalm_dyad_kind, only: assur_prp
   use psalm_error, only: problem_t, inputs_of
   use psalm_finale, only: in_columns
   use psalm_loop_arrays, only: loop_arrays_t, arrays_of
   use psalm_rate_items, only: rate_row_t, wanted_rows
   use psalm_sketch_redraw, only: redraw_sketch
   use psalm_sketch_text, only: variant_t, variant_of, write_sketch, limit_of_angles
   use psalm_start, only: values_per_record
   use psalm_text, only: text_t, general, full_precision, to_text
   implicit none (type, external)
   private
   public :: write_vertices, write_data_set

   integer, parameter :: line_length = 100  !! columns of a line of values

contains

   !> Append vertices: label, number, coordinates in the format (5X,5G15.7), the objective after the last coordinate.
   subroutine write_vertices(label, vertices, objectives, text)
      character(1), intent(in) :: label           !! I for the initial simplex, F for the final one
      real(wp), intent(in) :: vertices(:, :)      !! shape (nvar, nvar+1)
      real(wp), intent(in) :: objectives(:)       !! shape (nvar+1)
      type(text_t), intent(inout) :: text
      character(5) :: head
      character(:), allocatable :: line
      real(wp) :: row(size(vertices, 1) + 1)
      integer :: i, k, m

      do i = 1, size(objectives)
         row = [vertices(:, i), objectives(i)]
         do k = 1, size(row), values_per_record
            head = '!'
            if (k == 1) write (head, '("!",a1,i3)') label, mod(i, 1000)
            line = head
            do m = k, min(k + values_per_record - 1, size(row))
               line = line//general(row(m))
            end do
            call text%add(line)
         end do
      end do
   end subroutine write_vertices

   !> Append the complete data set of a linkage, as an analysis: what was variable is said in comments.
   subroutine write_data_set(set, problem, dimensions, text, variant)
      type(data_set_t), intent(in) :: set
      type(problem_t), intent(in) :: problem
      type(dimensions_t), intent(in) :: dimensions
      type(text_t), intent(inout) :: text
      type(variant_t), intent(in), optional :: variant !! what is written otherwise than `set` holds it
      type(variant_t) :: own
      integer :: loop
      real(wp), allocatable :: inputs(:)
      type(loop_arrays_t) :: arrays
      logical :: valid

      own = variant_of(set)
      if (present(variant)) own = variant
      if (set%is_drawn() .and. .not. own%by_loops) then
         valid = .true.
         if (problem%parameters%has_search()) then
            inputs = inputs_of(set)
            if (set%method%ikin == 0) inputs = own%delt
            call redraw_sketch(set, problem%mechanism, dimensions, inputs, own%sketch, own%from_drawing, valid)
         end if
         if (valid) then
            call write_sketch(set, text, own)
            return
         else if (set%is_beyond_arrays()) then
            call text%add('! '//trim(own%title)//': the linkage cannot be put together at any input of the case, nor as drawn')
            return
         end if
      end if
      arrays = arrays_of(set)
      call text%add(own%title)
      call text%add(' &LINKS NLOOP='//to_text(arrays%nloop)//', MAXARC='//to_text(arrays%maxarc)//',')
      call integer_rows('ILINK', arrays%ilink)
      call integer_rows('ILOOP', arrays%iloop)
      call real_rows('ARCL', in_columns(problem%mechanism, dimensions%arcl, arrays%arcl))
      call real_rows('GAMA', in_columns(problem%mechanism, dimensions%gama, arrays%gama))
      call text%add('  NOUTLK='//to_text(arrays%noutlk)//', NOUTLP='//to_text(arrays%noutlp)//', OUTLK='// &
                    full_precision(dimensions%outlk)//', OUTANG='//full_precision(dimensions%outang)//' &END')
      call text%add(' &METHOD MOTION='//to_text(set%motion())//', CRNKI='//full_precision(dimensions%crnki)//',')
      call text%add('  ORIGLK='//full_precision(dimensions%origlk)//', ORIGNG='//full_precision(dimensions%origng)//',')
      if (set%method%ikin /= 0) then
         call text%add('  IKIN='//to_text(set%method%ikin)//',')
      else
         call write_positions()
      end if
      if (problem%parameters%has_search()) call write_variables()
      call text%add(' &END')
      ! what was not given does not hold for two slides
      if (set%limits%trmin_given) then
         call text%add(' &LIMITS'//limit_of_angles(set))
      else if (set%limits%tangle_given .or. set%limits%tangle >= right_angle .or. all(problem%mechanism%groups%kind /= &
                                                            assur_prp)) then
         call text%add(' &LIMITS TANGLE='//full_precision(set%limits%tangle)//',')
      else
         call text%add(' &LIMITS')
      end if
      ! what was not given is no criterion
      if (set%limits%toggle_given) call text%add('  TOGGLE='//full_precision(set%limits%toggle)//',')
      if (set%limits%icond /= 0) call text%add('  ICOND=1,')
      if (set%limits%iproof /= proof_by_default) call text%add('  IPROOF='//to_text(set%limits%iproof)//',')
      if (set%limits%dwell > 0.0_wp) call text%add('  DWELL='//full_precision(set%limits%dwell)//',')
      call text%add('  KTHETA='//to_text(set%limits%ktheta)//', IPLOT='//to_text(set%limits%iplot)//', LAST='// &
                    to_text(own%last)//' &END')
      if (allocated(own%others)) then
         call text%add_text(own%others)
      else if (own%with_others) then
         call text%add_text(set%others)
      end if

   contains

      subroutine integer_rows(name, values)
         character(*), intent(in) :: name
         integer, intent(in) :: values(:, :)
         character(:), allocatable :: line
         integer :: a

         do loop = 1, size(values, 2)
            line = '  '
            if (loop == 1) line = line//name//'='
            do a = 1, size(values, 1)
               if (len(line) > line_length) then
                  call text%add(line)
                  line = '  '
               end if
               line = line//to_text(values(a, loop))//','
            end do
            call text%add(line)
         end do
      end subroutine integer_rows

      subroutine real_rows(name, values)
         character(*), intent(in) :: name
         real(wp), intent(in) :: values(:, :)

         do loop = 1, size(values, 2)
            call add_item(merge(name//'=', repeat(' ', len(name) + 1), loop == 1), values(:, loop), text)
         end do
      end subroutine real_rows

      subroutine write_positions()
         type(output_kind_t) :: kind

         call text%add('  NDES='//to_text(set%method%ndes)//',')
         call add_item('DELT=', own%delt, text)
         if (.not. set%method%desired) return
         kind = output_kind(set%motion())
         if (kind%components > 1) then
            call text%add('  XADD='//full_precision(set%method%xadd)//', YADD='//full_precision(set%method%yadd)//',')
            call add_item('DESX=', own%desx, text)
            call add_item('DESY=', own%desy, text)
            call add_item('XMULT=', set%method%xmult, text)
            call add_item('YMULT=', set%method%ymult, text)
         end if
         if (kind%components /= 2) then
            call add_item('DESANG=', set%method%desang, text)
            call add_item('ANMULT=', set%method%anmult, text)
         end if
         if (allocated(set%method%rate_desired)) call write_rates(wanted_rows(set%method%rate_weight))
      end subroutine write_positions

      !> Derivatives that are wanted; where none is, they weigh nothing.
      subroutine write_rates(rows)
         type(rate_row_t), intent(in) :: rows(:)
         integer :: i

         do i = 1, size(rows)
            call add_item(trim(rows(i)%item)//'=', set%method%rate_desired(:, rows(i)%component, rows(i)%order), text)
            call add_item(trim(rows(i)%weigher)//'=', set%method%rate_weight(:, rows(i)%component, rows(i)%order), text)
         end do
      end subroutine write_rates

      subroutine write_variables()
         character(:), allocatable :: line
         integer :: a, which

         do which = 1, 2
            do loop = 1, arrays%nloop
               line = '! '//merge('IVA ', 'IVG ', which == 1)
               do a = 1, arrays%maxarc
                  line = line//' '//to_text(merge(arrays%iva(a, loop), arrays%ivg(a, loop), which == 1))
               end do
               call text%add(line)
            end do
         end do
         call text%add('! ILKOUT='//to_text(arrays%ilkout)//' INGOUT='//to_text(arrays%ingout)//' IORIG='// &
                       to_text(arrays%iorig)// &
                       ' ICRK='//to_text(arrays%icrk)//' NITER='//to_text(set%method%niter)//' ISTART='// &
                          to_text(set%method%istart))
      end subroutine write_variables
   end subroutine write_data_set
end module psalm_data_set_text
