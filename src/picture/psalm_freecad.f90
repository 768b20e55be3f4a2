!> The links of a mechanism that are plates as solids, by a script in Python that FreeCAD runs.
!>
!> Millimetres; the plates lie in the plane of the linkage, one above the other, links that share a joint in different layers.
module psalm_freecad
   use psalm_kinds, only: wp
   use psalm_link_outline, only: outline_t, outline_of
   use psalm_mechanism, only: body_frame
   use psalm_multibody, only: multibody_t
   use psalm_robot_names, only: robot_names_t, robot_names
   use psalm_markup, only: short_number
   use psalm_text, only: text_t, to_text
   implicit none (type, external)
   private
   public :: write_freecad

   real(wp), parameter :: millimetres = 1000.0_wp   !! in a metre
   integer, parameter :: digits = 15

contains

   !> Append the script.
   subroutine write_freecad(model, text)
      type(multibody_t), intent(in) :: model
      type(text_t), intent(inout) :: text
      type(robot_names_t) :: names
      integer :: layers(size(model%bodies)), b

      names = robot_names(model)
      layers = layers_of(model)
      call text%add('"""The links of '//names%model//' as solids: run it with freecadcmd, or in FreeCAD as a macro.')
      call text%add('')
      call text%add('Beside this file it writes a document of FreeCAD (.FCStd) and a STEP file (.step).')
      call text%add('"""')
      call text%add('import os')
      call text%add('')
      call text%add('import FreeCAD')
      call text%add('import Part')
      call text%add('')
      call text%add('MODEL = "'//names%model//'"')
      call text%add('# name, place (x, y, height of the layer), thickness, outline, holes; mm. A point of an outline has x, y')
      call text%add('# from that place and the tangent of a quarter of the angle of the arc to the next point, 0 for a line;')
      call text%add('# a hole has x, y and diameter')
      call text%add('LINKS = [')
      do b = body_frame + 1, size(model%bodies)
         if (model%bodies(b)%thickness > 0.0_wp) call write_link(b)
      end do
      call text%add(']')
      call write_program(text)

   contains

      subroutine write_link(b)
         integer, intent(in) :: b
         type(outline_t) :: outline
         integer :: i, n
         character(:), allocatable :: line

         associate (body => model%bodies(b))
            outline = outline_of(body%corners(1, :), body%corners(2, :), 0.5_wp*body%width)
            n = size(outline%x)
            call text%add('    ("'//names%bodies(b)%text//'", ('//number(body%at(1))//', '//number(body%at(2))//', '// &
                          number(real(layers(b), wp)*maxval(model%bodies%thickness))//'), '//number(body%thickness)//',')
            line = '     ['
            do i = 1, n
               line = line//'('//number(outline%x(i) - body%at(1))//', '//number(outline%y(i) - body%at(2))//', '// &
                      short_number(outline%bulge(i), digits)//')'
               if (i < n) line = line//','
               call text%add(line//merge('],', '  ', i == n))
               line = '      '
            end do
            line = '     ['
            do i = 1, size(body%holes, 2)
               line = line//'('//number(body%holes(1, i) - body%at(1))//', '//number(body%holes(2, i) - body%at(2))//', '// &
                      number(body%hole)//')'
               if (i == size(body%holes, 2)) exit
               call text%add(line//',')
               line = '      '
            end do
            call text%add(line//']),')
         end associate
      end subroutine write_link

      function number(metres) result(word)
         real(wp), intent(in) :: metres
         character(:), allocatable :: word

         word = short_number(millimetres*metres, digits)
      end function number
   end subroutine write_freecad

   !> The layers of the links from 0: two that share a joint are not in one; the frame has none.
   pure function layers_of(model) result(layers)
      type(multibody_t), intent(in) :: model
      integer :: layers(size(model%bodies))
      logical :: taken(0:size(model%bodies))
      integer :: b, j, other

      layers = -1
      do b = body_frame + 1, size(layers)
         taken = .false.
         do j = 1, size(model%joints)
            associate (bodies => model%joints(j)%bodies)
               if (.not. any(bodies == b)) cycle
               other = sum(bodies) - b
            end associate
            if (layers(other) >= 0) taken(layers(other)) = .true.
         end do
         layers(b) = findloc(taken, .false., dim=1) - 1
      end do
   end function layers_of

   !> What makes solids of the numbers.
   subroutine write_program(text)
      type(text_t), intent(inout) :: text
      character(*), parameter :: lines(*) = [character(116) :: &
         '', &
         '', &
         'def edges_of(outline):', &
         '    """Lines and arcs round an outline, in the plane z = 0."""', &
         '    edges = []', &
         '    for k, (x, y, bulge) in enumerate(outline):', &
         '        to_x, to_y = outline[(k + 1) % len(outline)][:2]', &
         '        start, end = FreeCAD.Vector(x, y, 0), FreeCAD.Vector(to_x, to_y, 0)', &
         '        if bulge:', &
         '            aside = FreeCAD.Vector(to_y - y, x - to_x, 0)', &
         '            edges.append(Part.Arc(start, (start + end + aside * bulge) * 0.5, end).toShape())', &
         '        else:', &
         '            edges.append(Part.LineSegment(start, end).toShape())', &
         '    return edges', &
         '', &
         '', &
         'def solid_of(thickness, outline, holes):', &
         '    """A plate with its holes; its lower face lies at z = 0."""', &
         '    wires = [Part.Wire(edges_of(outline))]', &
         '    for x, y, diameter in holes:', &
         '        circle = Part.Circle(FreeCAD.Vector(x, y, 0), FreeCAD.Vector(0, 0, 1), diameter / 2)', &
         '        wires.append(Part.Wire([circle.toShape()]))', &
         '    return Part.makeFace(wires, "Part::FaceMakerBullseye").extrude(FreeCAD.Vector(0, 0, thickness))', &
         '', &
         '', &
         'def main():', &
         '    document = FreeCAD.newDocument("linkage")', &
         '    document.Label = MODEL', &
         '    parts = []', &
         '    for name, place, thickness, outline, holes in LINKS:', &
         '        part = document.addObject("Part::Feature", "link")', &
         '        part.Label = name', &
         '        part.Shape = solid_of(thickness, outline, holes)', &
         '        part.Placement = FreeCAD.Placement(FreeCAD.Vector(*place), FreeCAD.Rotation())', &
         '        parts.append(part)', &
         '    document.recompute()', &
         '    base = os.path.abspath(__file__)', &
         '    for ending in (".py", ".freecad"):', &
         '        if base.endswith(ending):', &
         '            base = base[:-len(ending)]', &
         '    document.saveAs(base + ".FCStd")', &
         '    Part.export(parts, base + ".step")', &
         '    return document', &
         '', &
         '', &
         'main()']
      integer :: k

      do k = 1, size(lines)
         call text%add(trim(lines(k)))
      end do
   end subroutine write_program
end module psalm_freecad
