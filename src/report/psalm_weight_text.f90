!> Counterweights and springs found, as groups that kalm and balm read.
module psalm_weight_text
   use psalm_balance_study, only: outcome_t
   use psalm_columns, only: add_item
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp
   use psalm_mechanism, only: mechanism_t, at_start
   use psalm_place, only: place_t
   use psalm_text, only: quoted, text_t, full_precision, to_text
   implicit none (type, external)
   private
   public :: place_words, write_masses, write_places

   integer, parameter :: line_length = 100  !! columns of a line of values

contains

   !> The group MASSES with the weights as further entries.
   subroutine write_masses(set, mechanism, outcome, text)
      type(data_set_t), intent(in) :: set
      type(mechanism_t), intent(in) :: mechanism
      type(outcome_t), intent(in) :: outcome
      type(text_t), intent(inout) :: text
      type(place_t) :: places(size(set%masses%places) + size(outcome%weights))
      real(wp) :: inertia(size(places))
      integer :: k

      associate (masses => set%masses, given => size(set%masses%places))
         places(:given) = masses%places
         inertia(:given) = masses%inertia
         do k = 1, size(outcome%weights)
            associate (weight => outcome%weights(k), place => places(given + k))
               place%arc = mechanism%arcs(mechanism%bodies(weight%body)%axis)%place
               place%loop = mechanism%arcs(mechanism%bodies(weight%body)%axis)%loop
               place%from_start = mechanism%arcs(mechanism%bodies(weight%body)%axis)%foot /= at_start
               place%distance = weight%from_end
               place%angle = weight%angle_end
               if (set%has_names()) call name_place(set, place)
               inertia(given + k) = weight%inertia
            end associate
         end do
         call text%add(' &MASSES NMASS='//to_text(size(places))//',')
         if (masses%added + size(outcome%weights) > 0) &
            call text%add('  MADDED='//to_text(masses%added + size(outcome%weights))//', ! the last entries are counterweights')
         call write_places(set, 'M', places, text)
         call add_item('MASS=', [masses%mass, outcome%weights%mass], text)
         call add_item('MINERT=', inertia, text)
         if (masses%has_heights .or. any(abs(outcome%weights%height) > 0.0_wp)) &
            call add_item('MZ=', [masses%height, outcome%weights%height], text)
         call text%add('  UNITL='//full_precision(masses%metre)//', GRAVX='//full_precision(masses%gravity(1))//', GRAVY='// &
                       full_precision(masses%gravity(2))//',')
         if (masses%about_given) then
            call text%add('  MOMX='//full_precision(masses%about(1))//', MOMY='//full_precision(masses%about(2))//',')
         end if
         if (masses%link_loads) call text%add('  ILOADS=1,')
         call text%add('  IMOTOR='//to_text(merge(1, 0, masses%motor_on_frame))//', ISHARE='//to_text(masses%shares)//', NHARM='// &
                       to_text(masses%harmonics)//' &END')
      end associate
   end subroutine write_masses

   !> Items LINK, LOOP, DIST, ANG with a group's letter before them.
   !> With a sketch NAME for LINK and LOOP.
   subroutine write_places(set, letter, places, text)
      type(data_set_t), intent(in) :: set
      character(*), intent(in) :: letter
      type(place_t), intent(in) :: places(:)
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: k

      if (set%has_names()) then
         line = '  '//letter//'NAME='
         do k = 1, size(places)
            line = line//quoted(place_words(set, places(k)))//','
            call break_line(line, text)
         end do
         if (len_trim(line) > 0) call text%add(line)
         call add_item(letter//'DIST=', places%written(1), text)
         call add_item(letter//'ANG=', places%written(2), text)
         return
      end if
      line = '  '//letter//'LINK='
      do k = 1, size(places)
         line = line//to_text(merge(-places(k)%arc, places(k)%arc, places(k)%from_start))//','
         call break_line(line, text)
      end do
      if (len_trim(line) > 0) call text%add(line)
      line = '  '//letter//'LOOP='
      do k = 1, size(places)
         line = line//to_text(places(k)%loop)//','
         call break_line(line, text)
      end do
      if (len_trim(line) > 0) call text%add(line)
      call add_item(letter//'DIST=', places%distance, text)
      call add_item(letter//'ANG=', places%angle, text)
   end subroutine write_places

   !> A place on the line of a link, by the names of its joints.
   subroutine name_place(set, place)
      type(data_set_t), intent(in) :: set
      type(place_t), intent(inout) :: place

      associate (line => set%traced%link_places(set%traced%arcs(set%traced%number_of(place%loop, place%arc))%link))
         place%link = line%link
         place%joint = line%joint
         place%line = line%line
      end associate
      place%written = [place%distance, place%angle]
   end subroutine name_place

   !> A place as a sketch names it.
   pure function place_words(set, place) result(words)
      type(data_set_t), intent(in) :: set
      type(place_t), intent(in) :: place
      character(:), allocatable :: words

      associate (sketch => set%sketch)
         words = trim(sketch%links(place%link)%name)
         if (place%joint > 0) words = words//' '//trim(sketch%joint_name(place%joint))
         if (place%joint > 0 .and. place%line(1) == place%joint) words = words//' '//trim(sketch%joint_name(place%line(2)))
      end associate
   end function place_words

   subroutine break_line(line, text)
      character(:), allocatable, intent(inout) :: line
      type(text_t), intent(inout) :: text

      if (len(line) < line_length) return
      call text%add(line)
      line = '   '
   end subroutine break_line
end module psalm_weight_text
