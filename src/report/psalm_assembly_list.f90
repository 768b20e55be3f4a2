!> All assemblies of a sketch in words and numbers: the listing, and a block of device 9.
module psalm_assembly_list
   use psalm_assembly_study, only: assembly_study_t
   use psalm_column_names, only: joint_name, output_unit
   use psalm_data_set, only: data_set_t
   use psalm_devices, only: devices_t
   use psalm_kinds, only: wp
   use psalm_number_format, only: number_format_t, figure, format_of
   use psalm_sketch, only: frame_link
   use psalm_tables, only: table_t, table_of
   use psalm_text, only: to_text
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
      type(table_t) :: table
      type(number_format_t) :: of_places
      real(wp), allocatable :: places(:, :, :)     ! shape (2, joints, assemblies); 0 of the frame's
      integer :: k, j, g, l

      associate (sketch => set%sketch, found => study%found, groups => study%closure%groups)
         call devices%six%add()
         line = ' ASSEMBLIES AT THE INPUTS OF THE DRAWING: '//to_text(size(found%states))
         if (found%more) line = line//' AND MORE'
         if (found%unknown > 0) line = line//'; OTHERS OF THE GROUP OF '//name_of(found%unknown)//' ARE NOT KNOWN (GEARS OR KOVER)'
         if (found%stopped) line = line//'; STOPPED BY REQUEST'
         if (found%unknown == 0 .and. .not. (found%complete .or. found%stopped)) &
            line = line//'; AT A DEAD POINT OR AT INFINITY SOME PATHS HAVE NO END'
         call devices%six%add(line)
         do g = 1, size(groups)
            if (size(groups(g)%links) < 2) cycle
            line = '  '//name_of(g)//': '//to_text(found%per_group(g))
            if (g < size(groups)) line = line//' WITH ALL BEFORE IT AS DRAWN'
            call devices%six%add(line)
         end do
         allocate (places(2, size(sketch%joint_name), size(found%states)), source=0.0_wp)
         do k = 1, size(found%states)
            do j = 1, size(sketch%joint_name)
               if (.not. sketch%has_joint(frame_link, j)) &
                  places(:, j, k) = [found%states(k)%joint(j, 0)%re, found%states(k)%joint(j, 0)%im]
            end do
         end do
         of_places = format_of(.true., pack(places, .true.))
         call devices%six%add('  NUMBER JOINT                                       X              Y')
         do k = 1, size(found%states)
            l = 0
            do j = 1, size(sketch%joint_name)
               if (sketch%has_joint(frame_link, j)) cycle
               l = l + 1
               line = repeat(' ', 8)
               if (l == 1) line = repeat(' ', 7 - len(to_text(k)))//to_text(k)//merge('*', ' ', k == 1)
               call devices%six%add(line//' '//sketch%joint_name(j)//figure(found%states(k)%joint(j, 0)%re, of_places)// &
                                    figure(found%states(k)%joint(j, 0)%im, of_places))
            end do
            if (found%dead(k)) call devices%six%add('         AT A DEAD POINT: TWO ASSEMBLIES MEET HERE')
         end do
         call devices%six%add('  * AS DRAWN')
         associate (states => [(k, k=1, size(found%states))])
            table = table_of('assemblies', 'a row for each assembly at the inputs of the drawing')
            call table%add('number', states)
            call table%add('drawn', states == 1)
            call table%add('dead', found%dead(:size(states)))
            do j = 1, size(sketch%joint_name)
               call table%add(joint_name(sketch%joint_name(j), 0, 'x'), [(found%states(k)%joint(j, 0)%re, k=1, size(states))], &
                              output_unit(.false.))
               call table%add(joint_name(sketch%joint_name(j), 0, 'y'), [(found%states(k)%joint(j, 0)%im, k=1, size(states))], &
                              output_unit(.false.))
            end do
         end associate
         call devices%cases(devices%last_case())%put(table)
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
