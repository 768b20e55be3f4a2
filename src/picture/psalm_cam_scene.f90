!> What pictures show of cams: their outlines, the linkage and the followers at even cam angles of one turn.
module psalm_cam_scene
   use psalm_cam_profile, only: cam_points_t
   use psalm_cam_shape, only: cam_shape_t, measure, table_angles, upward
   use psalm_cam_study, only: cam_study_t, role_cam
   use psalm_cam_trace, only: cam_trace_t
   use psalm_chain_scene, only: make_chain_scene
   use psalm_chain_study, only: inputs_at
   use psalm_data_set, only: data_set_t
   use psalm_kinds, only: wp, full_turn, radians_per_degree
   use psalm_preparation, only: prepared_t
   use psalm_row_study, only: row_study_t, study_rows
   use psalm_scene, only: scene_t, make_scene
   use psalm_status, only: finding_t
   use psalm_shown_input, only: reference_input
   implicit none (type, external)
   private
   public :: cam_scene_t, cam_part_t, make_cam_scene

   integer, parameter :: frames = 360            !! cam angles of a turn at which everything is shown
   real(wp), parameter :: body = 0.12_wp         !! least height of the body of a cam that slides, of its length
   integer, parameter :: finer = 2               !! points of an outline from one to the next

   !> One cam with its follower.
   type :: cam_part_t
      complex(wp), allocatable :: profile(:), pitch(:), cutter(:) !! in axes of the cam; the profile of a
                                                                  !! cam that slides goes on round its body
      type(cam_trace_t) :: states                !! shape (frames)
      type(cam_points_t) :: points
      complex(wp), allocatable :: arm(:)         !! shape (frames): where the follower hangs on its link
      complex(wp), allocatable :: second(:), second_arm(:) !! the same of a second roller on the same profile
   end type cam_part_t

   type :: cam_scene_t
      real(wp), allocatable :: angle(:)          !! degrees
      type(cam_part_t), allocatable :: parts(:)  !! as the studies
      type(scene_t) :: linkage                   !! its prescribed positions are the frames
      complex(wp) :: low = (0.0_wp, 0.0_wp), high = (0.0_wp, 0.0_wp) !! corners of what cams and linkage ever reach
   end type cam_scene_t

contains

   !> The scene of a case that was studied.
   subroutine make_cam_scene(set, prepared, studies, scene)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(cam_study_t), intent(in) :: studies(:)
      type(cam_scene_t), intent(inout) :: scene   !! as it is by default; made anew here it would fill a small stack
      integer :: k

      scene%angle = table_angles(studies(1)%shape, frames + merge(1, 0, studies(1)%shape%axes%slides))
      allocate (scene%parts(size(studies)))
      do k = 1, size(studies)
         call make_part(studies(k), scene%angle, scene%parts(k))
      end do
      call make_linkage(set, prepared, studies, scene)
      call choose_corners(studies, scene)
   end subroutine make_cam_scene

   subroutine make_part(study, angle, part)
      type(cam_study_t), intent(in) :: study
      real(wp), intent(in) :: angle(:)
      type(cam_part_t), intent(out) :: part
      class(cam_shape_t), allocatable :: shape    ! large: it would fill a small stack
      type(cam_trace_t) :: states
      type(cam_points_t) :: points
      logical, allocatable :: possible(:)
      type(cam_trace_t) :: second
      complex(wp) :: up, low
      real(wp), allocatable :: fine(:)

      allocate (shape, source=study%shape)
      fine = table_angles(shape, finer*size(angle) - merge(finer - 1, 0, shape%axes%slides))
      call measure(shape, fine, shape%motion%law%piece_at(fine), states, points, possible)
      part%profile = points%profile
      part%pitch = points%pitch
      part%cutter = points%cutter
      call measure(shape, angle, shape%motion%law%piece_at(angle), part%states, part%points, possible)
      part%arm = part%states%c(0, :) - study%cam%roller%distance*part%states%direction
      if (shape%axes%slides) then
         up = upward(shape)
         low = up*(minval(real(conjg(up)*part%profile, wp)) - body*maxval(abs(part%profile - part%profile(1))))
         associate (last => part%profile(size(part%profile)), first => part%profile(1))
            part%profile = [part%profile, low + last - up*real(conjg(up)*last, wp), low + first - up*real(conjg(up)*first, wp)]
         end associate
      end if
      allocate (part%second(0), part%second_arm(0))
      if (.not. allocated(study%other)) return
      deallocate (shape)
      allocate (shape, source=study%other)
      call shape%motion%trace(angle, shape%motion%law%piece_at(angle), second)
      part%second = second%c(0, :)
      part%second_arm = second%c(0, :) - study%cam%second%distance*second%direction
   end subroutine make_part

   !> The linkage at the inputs that the cams give.
   subroutine make_linkage(set, prepared, studies, scene)
      type(data_set_t), intent(in) :: set
      type(prepared_t), intent(in) :: prepared
      type(cam_study_t), intent(in) :: studies(:)
      type(cam_scene_t), intent(inout) :: scene
      type(finding_t) :: none(0)
      type(row_study_t), allocatable :: study
      real(wp), allocatable :: inputs(:, :)
      integer :: k

      if (allocated(studies(1)%shape%motion%chain)) then
         inputs = inputs_at(set, scene%parts(1)%states%q(0, :) - set%method%crnki)
         do k = 2, size(studies)
            if (studies(k)%part%cam == 1 .or. studies(k)%part%role /= role_cam) cycle
            inputs(2, :) = scene%parts(k)%states%q(0, :)
         end do
         call make_chain_scene(set, none, scene%linkage, inputs=inputs)
      else
         allocate (study)
         call study_rows(set, prepared%mechanism, prepared%given, prepared%parameters, study, &
                         delt=scene%parts(1)%states%q(0, :) - reference_input(prepared%mechanism, prepared%given))
         call make_scene(set, study, .true., none, scene%linkage)
      end if
   end subroutine make_linkage

   !> Room for cams that turn, rollers and linkage.
   subroutine choose_corners(studies, scene)
      type(cam_study_t), intent(in) :: studies(:)
      type(cam_scene_t), intent(inout) :: scene
      real(wp) :: low(2), high(2), reach
      integer :: k

      low = huge(1.0_wp)
      high = -huge(1.0_wp)
      do k = 1, size(studies)
         associate (o => studies(k)%shape%axes%centre, c => scene%parts(k)%states%c(0, :), r => studies(k)%shape%roller)
            reach = maxval(abs(scene%parts(k)%profile))
            if (.not. studies(k)%shape%flat) reach = max(reach, maxval(abs(c - o))) ! the pitch curve
            low = min(low, [o%re, o%im] - reach, [minval(c%re), minval(c%im)] - r)
            high = max(high, [o%re, o%im] + reach, [maxval(c%re), maxval(c%im)] + r)
         end associate
         if (.not. studies(k)%shape%axes%slides) cycle
         associate (o => studies(k)%shape%axes%centre, x => studies(k)%shape%axes%way*(full_turn*radians_per_degree), &
                    p => scene%parts(k)%profile, c => scene%parts(k)%states%c(0, :), r => studies(k)%shape%roller)
            low = [minval([o%re + p%re, o%re + x%re + p%re, c%re - r]), minval([o%im + p%im, o%im + x%im + p%im, c%im - r])]
            high = [maxval([o%re + p%re, o%re + x%re + p%re, c%re + r]), maxval([o%im + p%im, o%im + x%im + p%im, c%im + r])]
         end associate
      end do
      associate (row => scene%linkage%prescribed)
         if (scene%linkage%valid) then
            low = min(low, [minval(row%x, row%known), minval(row%y, row%known)])
            high = max(high, [maxval(row%x, row%known), maxval(row%y, row%known)])
         end if
      end associate
      scene%low = cmplx(low(1), low(2), wp)
      scene%high = cmplx(high(1), high(2), wp)
   end subroutine choose_corners
end module psalm_cam_scene
