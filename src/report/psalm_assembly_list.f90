!> All assemblies of a sketch in words and numbers: the listing, and a block of device 9.
module psalm_assembly_list
   use psalm_assembly_study, only: assembly_study_t
   use psalm_block, only: begin_block
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_sketch, only: frame_link
   use psalm_text, only: full_precision, general, to_text
   implicit none (type, external)
   private
   public :: report_assemblies

contains

   !> Append them, the drawing's first and marked by an asterisk; joints of the frame stand where they are drawn.
   subroutine report_assemblies(set, study, devices)
      type(data_set_t), intent(in) :: set
      type(assembly_study_t), intent(in) :: study
      type(devices_t), intent(inout) :: devices
      character(:), allocatable :: line
      integer :: k, j, g, l

      associate (sketch => set%sketch, found => study%found, groups => study%closure%groups)
         call devices%six%add()
         line = ' ASSEMBLIES AT THE INPUTS OF THE DRAWING: '//to_text(size(found%states))
         if (found%more) line = line//' AND MORE'
         if (found%unknown > 0) line = line//'; OTHERS OF THE GROUP OF '//name_of(found%unknown)//' ARE NOT KNOWN (GEARS OR KOVER)'
         if (found%unknown == 0 .and. .not. found%complete) line = line//'; AT A DEAD POINT OR AT INFINITY SOME PATHS HAVE NO END'
         call devices%six%add(line)
         do g = 1, size(groups)
            if (size(groups(g)%links) < 2) cycle
            line = '  '//name_of(g)//': '//to_text(found%per_group(g))
            if (g < size(groups)) line = line//' WITH ALL BEFORE IT AS DRAWN'
            call devices%six%add(line)
         end do
         call devices%six%add('  NUMBER JOINT                                       X              Y')
         do k = 1, size(found%states)
            l = 0
            do j = 1, size(sketch%joint_name)
               if (sketch%has_joint(frame_link, j)) cycle
               l = l + 1
               line = repeat(' ', 8)
               if (l == 1) line = repeat(' ', 7 - len(to_text(k)))//to_text(k)//merge('*', ' ', k == 1)
               call devices%six%add(line//' '//sketch%joint_name(j)//general(found%states(k)%joint(j, 0)%re, 'E')// &
                                    general(found%states(k)%joint(j, 0)%im, 'E'))
            end do
            if (found%dead(k)) call devices%six%add('         AT A DEAD POINT: TWO ASSEMBLIES MEET HERE')
         end do
         call devices%six%add('  * AS DRAWN')
         line = 'number drawn dead'
         do j = 1, size(sketch%joint_name)
            line = line//' '//trim(sketch%joint_name(j))//'.x '//trim(sketch%joint_name(j))//'.y'
         end do
         call begin_block('assemblies', line, devices%nine)
         do k = 1, size(found%states)
            line = to_text(k)//' '//merge('1', '0', k == 1)//' '//merge('1', '0', found%dead(k))
            do j = 1, size(sketch%joint_name)
               line = line//' '//full_precision(found%states(k)%joint(j, 0)%re)//' '// &
                      full_precision(found%states(k)%joint(j, 0)%im)
            end do
            call devices%nine%add(line)
         end do
      end associate

   contains

      !> A group by its links.
      function name_of(group) result(text)
         integer, intent(in) :: group
         character(:), allocatable :: text
         integer :: i

         text = ''
         associate (links => study%closure%groups(group)%links)
            do i = 1, size(links)
               if (i > 1) text = text//', '
               text = text//trim(set%sketch%links(links(i))%name)
            end do
         end associate
      end function name_of
   end subroutine report_assemblies
end module psalm_assembly_list
