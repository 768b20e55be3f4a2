!> Pitch curve, profile and cutter path of a cam as chains of arcs, each with its largest deviation as measured.
module psalm_cam_paths
   use psalm_arc_path, only: circle_arc_t, sampled_curve_t, fit_arcs, deviation_of, chords_needed
   use psalm_cam_trace, only: cam_trace_t
   use psalm_cam_profile, only: cam_points_t
   use psalm_cam_shape, only: cam_shape_t, samples_t, measure
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: cam_path_t, find_paths, path_pitch, path_profile, path_cutter

   integer, parameter :: path_pitch = 1, path_profile = 2, path_cutter = 3
   integer, parameter :: finer = 4               !! measured points from one sample to the next
   integer, parameter :: most_trials = 6
   real(wp), parameter :: reserve = 0.98_wp

   type :: cam_path_t
      type(circle_arc_t), allocatable :: arcs(:)        !! of one turn of the cam from angle 0, in cam axes
      real(wp) :: deviation = 0.0_wp             !! largest measured between the curve and the arcs
      real(wp) :: chords = 0.0_wp                !! that a polyline of the same tolerance would need
      logical :: found = .false.                 !! not where the curve turns back or the tolerance is too fine
   end type cam_path_t

contains

   !> All curves within a tolerance. Their deviation is measured between the samples; it never exceeds the tolerance.
   subroutine find_paths(shape, samples, tolerance, paths)
      type(cam_shape_t), intent(inout) :: shape
      type(samples_t), intent(in) :: samples
      real(wp), intent(in) :: tolerance
      type(cam_path_t), intent(out) :: paths(path_pitch:path_cutter)
      type(cam_trace_t) :: states
      type(cam_points_t) :: between
      logical, allocatable :: possible(:)
      integer, allocatable :: kept(:), piece(:)
      real(wp), allocatable :: angle(:)
      real(wp) :: share
      integer :: i, k, n

      ! the beginning of a piece is the end of the one before
      kept = pack([(i, i=1, size(samples%angle))], [.true., samples%piece(2:) == samples%piece(:size(samples%piece) - 1)])
      n = size(kept)
      allocate (angle(finer*(n - 1)), piece(finer*(n - 1)))
      do i = 1, n - 1
         do k = 1, finer
            share = (real(k, wp) - 0.5_wp)/real(finer, wp)
            piece(finer*(i - 1) + k) = samples%piece(kept(i + 1))
            angle(finer*(i - 1) + k) = samples%angle(kept(i)) + share*(samples%angle(kept(i + 1)) - samples%angle(kept(i)))
         end do
      end do
      call measure(shape, angle, piece, states, between, possible)
      do k = path_pitch, path_cutter
         call find_path(shape, samples, kept, between, k, tolerance, paths(k))
      end do
   end subroutine find_paths

   !> One of the curves.
   subroutine find_path(shape, samples, kept, between, which, tolerance, path)
      type(cam_shape_t), intent(in) :: shape
      type(samples_t), intent(in) :: samples
      integer, intent(in) :: kept(:)             !! samples without doubles
      type(cam_points_t), intent(in) :: between  !! `finer` points after each of them but the last
      integer, intent(in) :: which
      real(wp), intent(in) :: tolerance
      type(cam_path_t), intent(out) :: path
      type(sampled_curve_t) :: curve
      integer, allocatable :: last_sample(:)
      complex(wp), allocatable :: point(:)
      real(wp) :: fine
      integer :: i, k, n, trial

      n = size(kept)
      curve%point = chosen(samples%points, which)
      curve%point = curve%point(kept)
      curve%tangent = samples%points%tangent(kept)
      associate (segment => shape%motion%law%pieces(samples%piece(kept))%segment)
         curve%break = [segment(:n - 1) /= segment(2:), .false.]
      end associate
      point = chosen(between, which)
      path%chords = chords_needed(curve%point, bend_of(shape, samples%points, which, kept), tolerance)
      fine = tolerance
      allocate (path%arcs(0))
      do trial = 1, most_trials
         call fit_arcs(curve, fine, path%arcs, last_sample, path%found)
         if (.not. path%found) return
         k = 1
         path%deviation = 0.0_wp
         do i = 1, size(point)
            if ((i - 1)/finer + 1 >= last_sample(k)) k = k + 1
            path%deviation = max(path%deviation, abs(deviation_of(path%arcs(2*k - 1:2*k), point(i))))
         end do
         if (path%deviation <= tolerance) return
         fine = fine*reserve*(tolerance/path%deviation)
      end do
      path%found = .false.
   end subroutine find_path

   pure function chosen(points, which) result(curve)
      type(cam_points_t), intent(in) :: points
      integer, intent(in) :: which
      complex(wp), allocatable :: curve(:)

      select case (which)
      case (path_pitch)
         curve = points%pitch
      case (path_profile)
         curve = points%profile
      case default
         curve = points%cutter
      end select
   end function chosen

   !> Curvature of the chosen curve: of parallels to one another.
   pure function bend_of(shape, points, which, kept) result(bend)
      type(cam_shape_t), intent(in) :: shape
      type(cam_points_t), intent(in) :: points
      integer, intent(in) :: which
      integer, intent(in) :: kept(:)
      real(wp) :: bend(size(kept)), outward

      ! outward of the curve whose curvature `bend` is
      outward = 0.0_wp
      if (which == path_profile .and. .not. shape%flat) outward = -shape%roller
      if (which == path_cutter) outward = shape%cutter - merge(0.0_wp, shape%roller, shape%flat)
      bend = points%bend(kept)
      bend = bend/(1.0_wp + bend*outward)
   end function bend_of
end module psalm_cam_paths
