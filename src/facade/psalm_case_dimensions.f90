!> Looking at a case and changing its dimensions.
submodule(psalm_case) psalm_case_dimensions
   use, intrinsic :: ieee_arithmetic, only: ieee_is_finite
   use psalm_text, only: to_text
   implicit none (type, external)

contains

   module procedure loops

      loops = 0
      if (allocated(self%parts)) loops = size(self%parts)
      if (allocated(self%set)) loops = self%set%loops()
   end procedure loops

   module procedure arcs

      arcs = 0
      if (loop < 1 .or. loop > self%loops()) return
      if (allocated(self%set)) then
         arcs = self%set%links%maxarc
         if (allocated(self%set%traced)) arcs = self%set%traced%longest
      else
         arcs = size(self%parts(loop)%ilink)
      end if
   end procedure arcs

   module procedure title

      title = ''
      if (allocated(self%heading)) title = self%heading
      if (allocated(self%set)) title = self%set%title
   end procedure title

   module procedure length_of_arc
      integer :: n

      length = 0.0_wp
      if (arc < 1 .or. arc > self%arcs(loop)) return
      if (allocated(self%set)) then
         if (allocated(self%set%traced)) then
            n = self%set%traced%number_of(loop, arc)
            if (n > 0) length = self%set%traced%arcs(n)%arcl
         else
            length = self%set%links%arcl(arc, loop)
         end if
      else
         length = self%parts(loop)%length(arc)
      end if
   end procedure length_of_arc

   module procedure angle_of_arc
      integer :: n

      angle = 0.0_wp
      if (arc < 1 .or. arc > self%arcs(loop)) return
      if (allocated(self%set)) then
         if (allocated(self%set%traced)) then
            n = self%set%traced%number_of(loop, arc)
            if (n > 0) angle = self%set%traced%arcs(n)%gama
         else
            angle = self%set%links%gama(arc, loop)
         end if
      else
         angle = self%parts(loop)%angle(arc)
      end if
   end procedure angle_of_arc

   module procedure set_length

      if (.not. may_change(self, loop, arc, value)) return
      if (value < 0.0_wp) then
         call self%faults%error('arc '//to_text(arc)//' of loop '//to_text(loop)//': a length is not negative')
         return
      end if
      if (is_of_loops(self)) self%parts(loop)%length(arc) = value
      if (.not. allocated(self%set)) return
      self%altered = .not. is_of_loops(self)
      if (allocated(self%set%traced)) then
         self%set%traced%arcs(self%set%traced%number_of(loop, arc))%arcl = value
      else
         self%set%links%arcl(arc, loop) = value
      end if
   end procedure set_length

   module procedure set_angle

      if (.not. may_change(self, loop, arc, value)) return
      if (is_of_loops(self)) self%parts(loop)%angle(arc) = value
      if (.not. allocated(self%set)) return
      self%altered = .not. is_of_loops(self)
      if (allocated(self%set%traced)) then
         self%set%traced%arcs(self%set%traced%number_of(loop, arc))%gama = value
      else
         self%set%links%gama(arc, loop) = value
      end if
   end procedure set_angle

   module procedure is_of_loops

      is_of_loops = .false.
      if (allocated(self%parts)) is_of_loops = size(self%parts) > 0
   end procedure is_of_loops

   logical function may_change(self, loop, arc, value)
      class(case_t), intent(inout) :: self
      integer, intent(in) :: loop, arc
      real(wp), intent(in) :: value

      may_change = arc >= 1 .and. arc <= self%arcs(loop)
      if (may_change .and. allocated(self%set)) then
         if (allocated(self%set%traced)) may_change = self%set%traced%number_of(loop, arc) > 0
      end if
      if (.not. may_change) then
         call self%faults%error('there is no arc '//to_text(arc)//' of loop '//to_text(loop))
      else if (.not. ieee_is_finite(value)) then
         call self%faults%error('arc '//to_text(arc)//' of loop '//to_text(loop)//': a dimension must be a finite number')
         may_change = .false.
      end if
   end function may_change
end submodule psalm_case_dimensions
