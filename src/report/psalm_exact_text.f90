!> An exact linkage as a data set with a sketch: device 7 and whatever reads it.
module psalm_exact_text
   use psalm_angles, only: degrees_of
   use psalm_columns, only: add_item
   use psalm_defects, only: crank_angles, exact_linkage_t
   use psalm_exact_group, only: exact_group_t, kind_motion
   use psalm_function_points, only: generator_t, output_of
   use psalm_guided_six_bars, only: guided_t
   use psalm_kinds, only: wp, degrees_per_radian
   use psalm_text, only: text_t, full_precision, to_text
   implicit none (type, external)
   private
   public :: write_linkage, write_generator, write_six_bar, write_guided, links_of_watt_2, links_of_stephenson_3, &
             links_of_stephenson_2

   !> Names and joints of the links of six-bars.
   character(*), parameter :: all_links(3) = [character(120) :: &
      "LNAME='frame','crank','coupler','follower','link','output', LNK='A B E','A C','C D','B D G','G H','E H' &END", &
      "LNAME='frame','crank','coupler','follower','link','output', LNK='A B E','A C','C D G','B D','G H','E H' &END", &
      "LNAME='frame','crank','output','floating','link','second', LNK='A B','A C D','B E','E G H','C G','D H' &END"]
   character(*), parameter :: links_of_watt_2 = all_links(1), links_of_stephenson_3 = all_links(2), &
                              links_of_stephenson_2 = all_links(3)

contains

   !> Append a linkage that passes points.
   subroutine write_linkage(title, one, exact, last, text)
      character(*), intent(in) :: title
      type(exact_linkage_t), intent(in) :: one
      type(exact_group_t), intent(in) :: exact
      integer, intent(in) :: last                    !! LAST of the case
      type(text_t), intent(inout) :: text
      integer :: n

      n = size(one%p)
      call text%add(title)
      if (one%slides) then
         call text%add(" &CHAIN JNT='A','C','D','P',")
         call add_item('JX=', real([one%a, one%c(1), one%d(1), one%p(1)], wp), text)
         call add_item('JY=', aimag([one%a, one%c(1), one%d(1), one%p(1)]), text)
         call text%add("  LNAME='frame','crank','coupler','slider', LNK='A','A C','C D P','D',")
         call text%add("  NSLIDE=1, SLNK='frame', SLNK2='slider', SLX="//full_precision(real(one%d(1), wp))//', SLY='// &
                       full_precision(aimag(one%d(1)))//',')
         call text%add('  SLANG='//full_precision(degrees_of(real(one%guide, wp), aimag(one%guide)))//' &END')
      else if (one%swings) then
         call text%add(" &CHAIN JNT='A','B','C','P',")
         call add_item('JX=', real([one%a, one%b, one%c(1), one%p(1)], wp), text)
         call add_item('JY=', aimag([one%a, one%b, one%c(1), one%p(1)]), text)
         call text%add("  LNAME='frame','crank','coupler','block', LNK='A B','A C','C P','B',")
         call text%add("  NSLIDE=1, SLNK='coupler', SLNK2='block', SLX="//full_precision(real(one%b, wp))//', SLY='// &
                       full_precision(aimag(one%b))//',')
         call text%add('  SLANG='//full_precision(degrees_of(real(one%guide, wp), aimag(one%guide)))//' &END')
      else
         call text%add(" &CHAIN JNT='A','B','C','D','P',")
         call add_item('JX=', real([one%a, one%b, one%c(1), one%d(1), one%p(1)], wp), text)
         call add_item('JY=', aimag([one%a, one%b, one%c(1), one%d(1), one%p(1)]), text)
         call text%add("  LNAME='frame','crank','coupler','follower', LNK='A B','A C','C D P','B D' &END")
      end if
      call text%add(" &DRIVES DRIVE='A', DBASE='frame', DLINK='crank' &END")
      call text%add(" &OUTPUTS OUTPUT='point P'"//trim(merge(",'angle coupler'", "                ", exact%kind == kind_motion))// &
                    ' &END')
      call text%add(' &METHOD NDES='//to_text(n)//',')
      call add_item('DELT=', crank_angles(one, exact%closed), text)
      call text%add(' &END')
      call text%add(' &LIMITS TANGLE=90.0, LAST='//to_text(last)//' &END')
   end subroutine write_linkage

   !> Append a linkage that generates a function, at some inputs and outputs.
   subroutine write_generator(title, one, frame, phi, psi, last, text)
      character(*), intent(in) :: title
      type(generator_t), intent(in) :: one
      real(wp), intent(in) :: frame                  !! length of the frame
      real(wp), intent(in) :: phi(:), psi(:)         !! radians; of a slider psi is the travel
      integer, intent(in) :: last
      type(text_t), intent(inout) :: text
      complex(wp) :: c, d
      real(wp) :: scale, first
      logical :: closes

      call text%add(title)
      ! the drawing must close: what is generated, not what is wanted
      call output_of(one, phi(1), first, closes)
      if (one%assembly == 0 .or. .not. closes) first = psi(1)
      c = one%r2*cmplx(cos(phi(1) + one%phi0), sin(phi(1) + one%phi0), wp)
      if (one%slides) then
         d = cmplx(first - one%psi0, one%r4, wp)
         call text%add(" &CHAIN JNT='A','C','D',")
         call add_item('JX=', real([(0.0_wp, 0.0_wp), c, d], wp), text)
         call add_item('JY=', aimag([(0.0_wp, 0.0_wp), c, d]), text)
         call text%add("  LNAME='frame','crank','coupler','slider', LNK='A','A C','C D','D',")
         call text%add("  NSLIDE=1, SLNK='frame', SLNK2='slider', SLX="//full_precision(real(d, wp))//', SLY='// &
                       full_precision(aimag(d))//', SLANG=0.0 &END')
         call text%add(" &DRIVES DRIVE='A', DBASE='frame', DLINK='crank' &END")
         call text%add(" &OUTPUTS OUTPUT='x D' &END")
      else
         scale = frame
         d = 1.0_wp + one%r4*cmplx(cos(first + one%psi0), sin(first + one%psi0), wp)
         call text%add(" &CHAIN JNT='A','B','C','D',")
         call add_item('JX=', scale*real([(0.0_wp, 0.0_wp), (1.0_wp, 0.0_wp), c, d], wp), text)
         call add_item('JY=', scale*aimag([(0.0_wp, 0.0_wp), (1.0_wp, 0.0_wp), c, d]), text)
         call text%add("  LNAME='frame','crank','coupler','follower', LNK='A B','A C','C D','B D' &END")
         call text%add(" &DRIVES DRIVE='A', DBASE='frame', DLINK='crank' &END")
         call text%add(" &OUTPUTS OUTPUT='angle follower' &END")
      end if
      call text%add(' &METHOD NDES='//to_text(size(phi))//',')
      call add_item('DELT=', (phi - phi(1))*degrees_per_radian, text)
      call text%add(' &END')
      call text%add(' &LIMITS TANGLE=90.0, LAST='//to_text(last)//' &END')
   end subroutine write_generator

   !> Append a six-bar, drawn at the first input: A, B, C, D, third fixed pivot E, G on the link that the driver moves, H on the
   !> output link.
   subroutine write_six_bar(title, links, joints, phi, last, text)
      character(*), intent(in) :: title
      character(*), intent(in) :: links              !! one of the above
      complex(wp), intent(in) :: joints(7)
      real(wp), intent(in) :: phi(:)                 !! radians
      integer, intent(in) :: last
      type(text_t), intent(inout) :: text

      call text%add(title)
      call text%add(" &CHAIN JNT='A','B','C','D','E','G','H',")
      call add_item('JX=', real(joints, wp), text)
      call add_item('JY=', aimag(joints), text)
      call text%add('  '//links(:index(links, 'LNK') - 2))
      call text%add('  '//trim(links(index(links, 'LNK'):)))
      call text%add(" &DRIVES DRIVE='A', DBASE='frame', DLINK='crank' &END")
      call text%add(" &OUTPUTS OUTPUT='angle output' &END")
      call text%add(' &METHOD NDES='//to_text(size(phi))//',')
      call add_item('DELT=', (phi - phi(1))*degrees_per_radian, text)
      call text%add(' &END')
      call text%add(' &LIMITS TANGLE=90.0, LAST='//to_text(last)//' &END')
   end subroutine write_six_bar

   !> Append a six-bar that leads a body, drawn at the first pose: the chain A, B, C with the point P of the body, the ends G and W
   !> of the first link, H and K of the second.
   subroutine write_guided(title, one, exact, last, text)
      character(*), intent(in) :: title
      type(guided_t), intent(in) :: one
      type(exact_group_t), intent(in) :: exact
      integer, intent(in) :: last
      type(text_t), intent(inout) :: text
      complex(wp) :: first, joints(8)
      character(16) :: of_body(0:4)
      integer :: i

      first = cmplx(exact%x(1), exact%y(1), wp)
      joints(:4) = [cmplx(exact%arm(1::2), exact%arm(2::2), wp), first]
      of_body = [character(16) :: 'A', 'A B', 'B C', 'C P', 'G W']
      do i = 1, 2
         associate (own => one%links(i))
            joints(2*i + 3:2*i + 4) = first + [own%pivot, own%pin]
            of_body(own%from) = trim(of_body(own%from))//' '//merge('G', 'H', i == 1)
            of_body(own%to) = trim(of_body(own%to))//' '//merge('W', 'K', i == 1)
         end associate
      end do
      call text%add(title)
      call text%add(" &CHAIN JNT='A','B','C','P','G','W','H','K',")
      call add_item('JX=', real(joints, wp), text)
      call add_item('JY=', aimag(joints), text)
      call text%add("  LNAME='frame','crank','arm','body','link','last',")
      call text%add("  LNK='"//trim(of_body(0))//"','"//trim(of_body(1))//"','"//trim(of_body(2))//"','"//trim(of_body(3))// &
                    "','"//trim(of_body(4))//"','H K' &END")
      call text%add(" &DRIVES DRIVE='A', DBASE='frame', DLINK='crank' &END")
      call text%add(" &OUTPUTS OUTPUT='point P','angle body' &END")
      call text%add(' &METHOD NDES='//to_text(size(one%crank))//',')
      call add_item('DELT=', one%crank*degrees_per_radian, text)
      call text%add(' &END')
      call text%add(' &LIMITS TANGLE=90.0, LAST='//to_text(last)//' &END')
   end subroutine write_guided
end module psalm_exact_text
