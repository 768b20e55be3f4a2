!> Clearances of a sketch that is solved in the poses of its links: the table of margins at its positions.
module psalm_chain_margins
   use psalm_clearances, only: clearance_t, find_depth, list_sketch_clearances, points_of_clearance
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_kinds, only: wp
   use psalm_margin_list, only: name_of_clearance
   use psalm_sketch_study, only: sketch_study_t
   use psalm_text, only: general, to_text
   implicit none (type, external)
   private
   public :: report_chain_margins

   integer, parameter :: name_columns = 44   !! width of a constraint's name

contains

   !> List how far joints and links keep from regions and from each other, and tell what comes too near.
   subroutine report_chain_margins(set, study, devices)
      type(data_set_t), intent(in) :: set
      class(sketch_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      type(clearance_t), allocatable :: clearances(:)
      character(name_columns) :: name
      character(:), allocatable :: line
      real(wp) :: margin
      integer :: n, position

      if (.not. set%constr%given .or. .not. any(study%closed)) return
      call list_sketch_clearances(set%constr, set%sketch, clearances)
      if (size(clearances) == 0) return
      call devices%six%add()
      call devices%six%add(' MARGINS OF THE CONSTRAINTS, AT THE POSITIONS THAT CLOSE')
      call devices%six%add(' CONSTRAINT                                           MARGIN    AT POSITION')
      do n = 1, size(clearances)
         call find_margin(clearances(n), study, margin, position)
         name = name_of_clearance(set, clearances(n))
         line = ' '//name//general(margin)//repeat(' ', len(general(margin)) - len(to_text(position)))//to_text(position)
         if (margin < 0.0_wp) then
            line = line//'  VIOLATED'
            call devices%note_violation()
            call devices%remark(set, 'violated: '//name_of_clearance(set, clearances(n), in_sentence=.true.)//' by '// &
                                trim(adjustl(general(-margin)))//' at position '//to_text(position))
         end if
         call devices%six%add(line)
      end do
   end subroutine report_chain_margins

   !> The least distance over what is asked, and where it is.
   subroutine find_margin(clearance, study, margin, position)
      type(clearance_t), intent(in) :: clearance
      class(sketch_study_t), intent(in) :: study
      real(wp), intent(out) :: margin
      integer, intent(out) :: position
      real(wp) :: at(2, points_of_clearance), depth, slopes(2, points_of_clearance)
      integer :: k, p

      margin = huge(1.0_wp)
      position = 0
      do k = 1, size(study%closed)
         if (.not. study%closed(k)) cycle
         do p = 1, points_of_clearance
            ! a region has two points only
            associate (joint => study%joints(max(clearance%points(p), 1), 0, k))
               at(:, p) = [joint%re, joint%im]
            end associate
         end do
         call find_depth(clearance, at, depth, slopes)
         if (-depth >= margin) cycle
         margin = -depth
         position = k
      end do
   end subroutine find_margin
end module psalm_chain_margins
