!> Standard tolerances of ISO 286: the grades IT5 to IT13 by steps of the nominal size.
!>
!> A grade is a width in micrometres, the same for all sizes of a step. Up to 500 mm the widths come from the unit
!> i = 0.45 D**(1/3) + 0.001 D, D the geometric mean of the limits of the step in millimetres, above that from I = 0.004 D + 2.1,
!> times 7, 10, 16, 25 ... 250, rounded by rules of the standard; what counts are the rounded values of its table.
!> Source: ISO 286-1 (2010), table 1; the units: ISO 286-1 (1988), annex A.
module psalm_standard_tolerances
   use psalm_kinds, only: wp
   implicit none (type, external)
   private
   public :: finest_grade, coarsest_grade, grade_width

   integer, parameter :: finest_grade = 5, coarsest_grade = 13
   integer, parameter :: grades = coarsest_grade - finest_grade + 1, sizes = 21
   real(wp), parameter :: up_to(sizes) = [3.0_wp, 6.0_wp, 10.0_wp, 18.0_wp, 30.0_wp, 50.0_wp, 80.0_wp, 120.0_wp, 180.0_wp, &
                                          250.0_wp, 315.0_wp, 400.0_wp, 500.0_wp, 630.0_wp, 800.0_wp, 1000.0_wp, 1250.0_wp, &
                                          1600.0_wp, 2000.0_wp, 2500.0_wp, 3150.0_wp] !! millimetres
   real(wp), parameter :: millimetres = 1.0e-3_wp           !! in a micrometre
   integer, parameter :: widths(grades, sizes) = reshape([ & !! micrometres, IT5 to IT13
      4, 6, 10, 14, 25, 40, 60, 100, 140, &
      5, 8, 12, 18, 30, 48, 75, 120, 180, &
      6, 9, 15, 22, 36, 58, 90, 150, 220, &
      8, 11, 18, 27, 43, 70, 110, 180, 270, &
      9, 13, 21, 33, 52, 84, 130, 210, 330, &
      11, 16, 25, 39, 62, 100, 160, 250, 390, &
      13, 19, 30, 46, 74, 120, 190, 300, 460, &
      15, 22, 35, 54, 87, 140, 220, 350, 540, &
      18, 25, 40, 63, 100, 160, 250, 400, 630, &
      20, 29, 46, 72, 115, 185, 290, 460, 720, &
      23, 32, 52, 81, 130, 210, 320, 520, 810, &
      25, 36, 57, 89, 140, 230, 360, 570, 890, &
      27, 40, 63, 97, 155, 250, 400, 630, 970, &
      32, 44, 70, 110, 175, 280, 440, 700, 1100, &
      36, 50, 80, 125, 200, 320, 500, 800, 1250, &
      40, 56, 90, 140, 230, 360, 560, 900, 1400, &
      47, 66, 105, 165, 260, 420, 660, 1050, 1650, &
      55, 78, 125, 195, 310, 500, 780, 1250, 1950, &
      65, 92, 150, 230, 370, 600, 920, 1500, 2300, &
      78, 110, 175, 280, 440, 700, 1100, 1750, 2800, &
      96, 135, 210, 330, 540, 860, 1350, 2100, 3300], [grades, sizes])

contains

   !> The width of a grade: the whole of the tolerance, in millimetres. 0: no such grade, or a size that the standard does not have.
   elemental real(wp) function grade_width(grade, nominal) result(width)
      integer, intent(in) :: grade              !! `finest_grade` to `coarsest_grade`
      real(wp), intent(in) :: nominal           !! size, millimetres
      integer :: step

      width = 0.0_wp
      if (grade < finest_grade .or. grade > coarsest_grade .or. .not. nominal > 0.0_wp) return
      step = findloc(nominal <= up_to, .true., dim=1)
      if (step > 0) width = millimetres*real(widths(grade - finest_grade + 1, step), wp)
   end function grade_width
end module psalm_standard_tolerances
