!> BALM: the cases of a file become pictures.
!>
!> Nothing is printed here and no file is written; the caller gets texts, messages and an exit status. Source: Oldham (1977),
!> section 15.1.
module psalm_balm
   use psalm_curves, only: write_curves
   use psalm_data_set, only: data_set_t
   use psalm_dxf, only: write_dxf
   use psalm_error, only: problem_t, motion_t, make_problem
   use psalm_finale, only: describe_violation
   use psalm_page, only: write_page
   use psalm_preparation, only: demand_t, prepared_t, prepare
   use psalm_scene, only: scene_t, make_scene, message_scene
   use psalm_setup, only: set_up
   use psalm_source, only: line_t
   use psalm_status, only: diagnostics_t, finding_t, exit_file_trouble, exit_violation, level_error
   use psalm_svg, only: write_svg
   use psalm_text, only: text_t, to_text
   use psalm_topology, only: topology_t, dimensions_t
   implicit none (type, external)
   private
   public :: picture_t, balm_t, make_scenes, draw_file, draw_curves

   integer, parameter :: most_drawn = 2000 !! positions of a picture; more of them make one black band
   integer, parameter :: most_told = 5 !! messages of one case on standard error
   type(demand_t), parameter :: demand = demand_t(position=1000, arc=500, ktheta_only=.false.)
   integer, parameter :: ending_width = 24 !! room for a number and a suffix

   !> A file to write.
   type :: picture_t
      character(ending_width) :: ending = '' !! of the name, after that of the case
      character(:), allocatable :: content
      logical :: made = .false.             !! of a script: gnuplot has made its pictures
   end type picture_t

   !> The cases of one file.
   type :: balm_t
      type(scene_t), allocatable :: scenes(:)
      type(text_t) :: notes                 !! remarks for standard error
      integer :: code = 0                   !! exit status so far; faults of the input are in the findings
   end type balm_t

contains

   !> Scenes of all cases of a file, in their order; those with faults become scenes of messages.
   subroutine make_scenes(sets, findings, balm)
      type(data_set_t), intent(in) :: sets(:)
      type(diagnostics_t), intent(inout) :: findings  !! of reading the file; SETUP's are added
      type(balm_t), intent(out) :: balm
      type(finding_t), allocatable :: read(:), own(:)
      type(diagnostics_t) :: judged
      type(data_set_t) :: each
      type(line_t) :: none(0)
      type(prepared_t) :: prepared
      integer :: k, i

      allocate (balm%scenes(size(sets)))
      read = finding_list(findings)
      do k = 1, size(sets)
         own = of_case(read, k)
         judged = diagnostics_t()
         judged%file = sets(k)%file
         if (any(own%level == level_error)) then
            call message_scene(sets(k), own, balm%scenes(k))
            cycle
         end if
         each = sets(k)
         each%nguess = 0
         call prepare(each, none, prepared, judged, demand)
         if (.not. judged%failed() .and. each%ikin == 0 .and. each%ndes > most_drawn) call thin_out(each, judged)
         own = [own, finding_list(judged)]
         do i = 1, judged%count
            call findings%add(judged%list(i))
         end do
         each%nguess = sets(k)%nguess
         call make_scene(each, own, balm%scenes(k))
         if (.not. balm%scenes(k)%sound) cycle
         if (each%ndes < sets(k)%ndes) call tell_all_positions(sets(k), balm)
         call tell(each, balm%scenes(k), balm)
      end do

   contains

      !> Findings between the title of this case and that of the next; what has no line belongs to the first case.
      pure function of_case(list, k) result(some)
         type(finding_t), intent(in) :: list(:)
         integer, intent(in) :: k
         type(finding_t), allocatable :: some(:)
         integer :: first, last

         first = sets(k)%title_line
         if (k == 1) first = 0
         last = huge(1)
         if (k < size(sets)) last = sets(k + 1)%title_line - 1
         some = pack(list, list%line >= first .and. list%line <= last)
      end function of_case

      pure function finding_list(findings) result(list)
         type(diagnostics_t), intent(in) :: findings
         type(finding_t), allocatable :: list(:)

         allocate (list(0))
         if (findings%count > 0) list = findings%list(:findings%count)
      end function finding_list
   end subroutine make_scenes

   !> Keep evenly chosen positions, as many as a picture can show.
   subroutine thin_out(set, findings)
      type(data_set_t), intent(inout) :: set
      type(diagnostics_t), intent(inout) :: findings
      integer :: step

      step = (set%ndes - 1)/most_drawn + 1
      set%delt = set%delt(1::step)
      set%desx = set%desx(1::step)
      set%desy = set%desy(1::step)
      set%desang = set%desang(1::step)
      set%xmult = set%xmult(1::step)
      set%ymult = set%ymult(1::step)
      set%anmult = set%anmult(1::step)
      call findings%warning('of '//to_text(set%ndes)//' positions '//to_text(size(set%delt))//' are drawn, one in '// &
                            to_text(step)//', and numbered so on the pictures', line=set%origins%line('METHOD', 'NDES', 1), &
                            group='METHOD', item='NDES')
      set%ndes = size(set%delt)
   end subroutine thin_out

   !> Violations at positions of which not all are drawn.
   subroutine tell_all_positions(set, balm)
      type(data_set_t), intent(in) :: set
      type(balm_t), intent(inout) :: balm
      type(topology_t) :: topology
      type(dimensions_t) :: dimensions
      type(diagnostics_t) :: again
      type(problem_t) :: problem
      type(motion_t) :: motion
      integer :: i

      call set_up(set, topology, dimensions, again)
      call make_problem(set, topology, dimensions, problem)
      call problem%analyse(dimensions, motion)
      if (size(motion%violations) == 0) return
      balm%code = max(balm%code, exit_violation)
      do i = 1, min(size(motion%violations), most_told)
         call balm%notes%add(set%file//': '//trim(set%title)//', all positions: '// &
                             describe_violation(problem, motion, motion%violations(i)))
      end do
   end subroutine tell_all_positions

   !> Exit status 1 and remarks where a linkage does not close or exceeds limits.
   subroutine tell(set, scene, balm)
      type(data_set_t), intent(in) :: set
      type(scene_t), intent(in) :: scene
      type(balm_t), intent(inout) :: balm
      integer :: i

      if (scene%prescribed%violated .or. size(scene%breaches) > 0) balm%code = max(balm%code, exit_violation)
      do i = 1, size(scene%breaches)
         call balm%notes%add(set%file//': '//trim(set%title)//': '//scene%breaches(i)%text)
      end do
      if (.not. scene%prescribed%violated) return
      if (.not. all(scene%prescribed%closed)) then
         call balm%notes%add(set%file//': '//trim(set%title)//': the linkage does not close at '// &
                             to_text(count(.not. scene%prescribed%closed))//' of '//to_text(scene%prescribed%n)//' positions')
      end if
      do i = 1, min(size(scene%prescribed%words), most_told)
         call balm%notes%add(set%file//':   '//scene%prescribed%words(i)%text)
      end do
      if (size(scene%prescribed%words) > most_told) &
         call balm%notes%add(set%file//':   and '//to_text(size(scene%prescribed%words) - most_told)//' more in the pictures')
   end subroutine tell

   !> Pictures of a file: SVG and DXF of each case, one page of all.
   subroutine draw_file(balm, assemblies, mark, pictures)
      type(balm_t), intent(in) :: balm
      logical, intent(in) :: assemblies        !! the SVG shows the other assembly of each pair
      character(*), intent(in) :: mark         !! of the run
      type(picture_t), allocatable, intent(out) :: pictures(:)
      type(text_t) :: text
      integer :: k

      allocate (pictures(0))
      if (size(balm%scenes) == 0) return
      do k = 1, size(balm%scenes)
         call write_svg(balm%scenes(k), assemblies, text)
         call add_comment()
         call put(ending(k, '.svg'))
         if (.not. balm%scenes(k)%sound) cycle
         call text%add('999') ! a comment of DXF
         call text%add('run '//mark)
         call write_dxf(balm%scenes(k), text)
         call put(ending(k, '.dxf'))
      end do
      call write_page(balm%scenes, text)
      call add_comment()
      call put('.html')

   contains

      subroutine add_comment()

         call text%add('<!-- run '//mark//' -->')
      end subroutine add_comment

      subroutine put(name)
         character(*), intent(in) :: name

         call add_picture(pictures, name, text%content())
         text = text_t()
      end subroutine put
   end subroutine draw_file

   !> Scripts for the curves of each sound case; each ending is followed by that of the picture.
   subroutine draw_curves(balm, name, progress, mark, scripts)
      type(balm_t), intent(in) :: balm
      character(*), intent(in) :: name          !! of the case, without directory
      type(line_t), intent(in) :: progress(:)   !! device 1, empty if there is none; of the first case
      character(*), intent(in) :: mark          !! of the run
      type(picture_t), allocatable, intent(out) :: scripts(:)
      type(line_t) :: none(0)
      type(text_t) :: text
      integer :: k

      allocate (scripts(0))
      do k = 1, size(balm%scenes)
         if (.not. balm%scenes(k)%sound) cycle
         text = text_t()
         call text%add('# run '//mark)
         if (k == 1) then
            call write_curves(balm%scenes(k), name//trim(ending(k, '')), progress, text)
         else
            call write_curves(balm%scenes(k), name//trim(ending(k, '')), none, text)
         end if
         call add_picture(scripts, ending(k, ''), text%content())
      end do
   end subroutine draw_curves

   pure subroutine add_picture(pictures, ending, content)
      type(picture_t), allocatable, intent(inout) :: pictures(:)
      character(*), intent(in) :: ending, content
      type(picture_t), allocatable :: more(:)
      integer :: i

      allocate (more(size(pictures) + 1))
      do i = 1, size(pictures)
         more(i)%ending = pictures(i)%ending
         call move_alloc(pictures(i)%content, more(i)%content)
      end do
      more(size(more))%ending = ending
      more(size(more))%content = content
      call move_alloc(more, pictures)
   end subroutine add_picture

   !> The first case has the name of the file, the others a number too.
   pure function ending(k, suffix) result(name)
      integer, intent(in) :: k
      character(*), intent(in) :: suffix
      character(:), allocatable :: name

      name = suffix
      if (k > 1) name = '.'//to_text(k)//suffix
   end function ending
end module psalm_balm
