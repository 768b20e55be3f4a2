!> A vibrating link as data of the moving page: its deflection over the sweep, amplitudes over speeds, the chart of stability.
module psalm_vibration_page
   use psalm_kinds, only: wp
   use psalm_json, only: add_numbers, comma, json_number, truth
   use psalm_steady_curves, only: most_shown_modes
   use psalm_text, only: text_t, to_text
   use psalm_vibration_list, only: root_of
   use psalm_vibration_scene, only: vibration_scene_t
   implicit none (type, external)
   private
   public :: write_vibration_data

contains

   !> Append a JSON object. `from` and `to` are the joints of the link, counted from 0, in the sense of its arc.
   subroutine write_vibration_data(vibration, from, to, text)
      type(vibration_scene_t), intent(in) :: vibration
      integer, intent(in) :: from, to
      type(text_t), intent(inout) :: text
      real(wp), allocatable :: speeds(:), amplitudes(:)
      logical, allocatable :: known(:)
      integer :: j, p, k

      associate (study => vibration%study)
         call text%add_text('{"from":'//to_text(from)//',"to":'//to_text(to)//',"factor":'//json_number(vibration%factor)// &
                            ',"settles":'//truth(vibration%settles)//',"ratio":'// &
                            json_number(study%ratio)//',"e":'//json_number(vibration%study%given_e)//',"modes":[')
         do j = 1, min(size(study%modes), most_shown_modes)
            call text%add_text(comma(j))
            call add_numbers(vibration%deflection(:, j), text)
            call text%add()
         end do
         speeds = study%speeds%speed
         amplitudes = study%speeds%amplitude/vibration%metre
         known = study%speeds%known
         call text%add_text('],"speeds":[')
         do k = 1, size(speeds)
            call text%add_text(comma(k)//'['//json_number(speeds(k))//','//json_number(amplitudes(k), known(k), exact=.true.)//']')
         end do
         call text%add('],"bands":[')
         do k = 1, size(study%bands)
            call text%add_text(comma(k)//'['//json_number(study%bands(k)%from)//','//json_number(study%bands(k)%to)//']')
         end do
         call text%add('],"chart":[')
         do k = 1, size(study%chart)
            call text%add_text(comma(k)//'{"e":'//json_number(study%chart(k)%e)//',"bounds":[')
            associate (b => study%chart(k)%exact)
               do p = 0, ubound(b%low, 1)
                  call text%add_text(comma(p + 1)//'['//json_number(root_of(b%low(p)))//','// &
                                     json_number(root_of(b%high(p)))//']')
               end do
            end associate
            call text%add(']}')
         end do
         call text%add_text(']}')
      end associate
   end subroutine write_vibration_data
end module psalm_vibration_page
