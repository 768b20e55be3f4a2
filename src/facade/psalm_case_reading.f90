!> Cases are read here: from a file, from a text, for a study.
submodule(psalm_case) psalm_case_reading
   use psalm_cases, only: read_case_text
   use psalm_error, only: make_problem
   use psalm_group_table, only: everything
   use psalm_preparation, only: prepare_loops
   use psalm_source, only: joined, line_t, read_lines
   implicit none (type, external)

contains

   module procedure read_file
      type(line_t), allocatable :: lines(:)
      type(findings_t) :: own
      character(:), allocatable :: name

      name = file
      if (file == '-') name = 'standard input'
      own%file = name
      call read_lines(file, lines, own)
      if (own%failed()) then
         allocate (cases(0))
         call tell(own, findings)
      else
         call read_text(joined(lines), cases, findings, name)
      end if
   end procedure read_file

   module procedure read_text
      type(data_set_t), allocatable :: sets(:)
      type(case_text_t), allocatable :: parts(:)
      type(findings_t) :: own
      character(:), allocatable :: file
      integer :: k

      file = memory_name
      if (present(name)) file = name
      call read_case_text(text, file, sets, own, everything)
      allocate (cases(size(sets)))
      if (size(sets) == 1 .and. .not. own%failed()) then
         cases(1)%source = text
      else if (.not. own%failed()) then
         call split_cases(text, parts)
         do k = 1, min(size(sets), size(parts))
            cases(k)%source = text_of_parts(parts(k))
         end do
      end if
      do k = 1, size(sets)
         allocate (cases(k)%set, source=sets(k))
         cases(k)%set%limits%last = 1
         cases(k)%faults%file = sets(k)%file
         if (own%failed()) call cases(k)%faults%error('the text of this case has errors', line=sets(k)%title_line)
      end do
      call tell(own, findings)
   end procedure read_text

   module procedure settle
      type(data_set_t), allocatable :: sets(:)
      type(findings_t) :: own

      if (allocated(self%set) .or. .not. allocated(self%parts)) return
      call read_case_text(self%text(), name_of(self), sets, own, everything)
      if (own%count > 0 .or. size(sets) /= 1) return
      allocate (self%set, source=sets(1))
   end procedure settle

   module procedure make_ready
      type(findings_t) :: own
      type(memory_need_t) :: memory
      character(:), allocatable :: work
      logical :: everywhere

      allocate (prepared)
      ready = .false.
      everywhere = .false.
      if (present(every_loop)) everywhere = every_loop
      call set_of(case, set, own, reader)
      if (.not. own%failed()) then
         if (set%loops() > 0) then
            work = 'the library studies'
            if (present(does)) work = does
            if (present(need)) memory = need
            if (everywhere) memory%ktheta_only = .false.
            call prepare_loops(work, memory, set, prepared, own, turning)
            ready = prepared%ready
         else
            if (set%of_kinds) then
               call own%error('asks for a kind of linkage: search the kinds first, and study the linkages found', &
                              line=set%title_line, group='KINDS')
            else
               call own%error('the case has no linkage', line=set%title_line)
            end if
         end if
      end if
      call tell(own, findings)
      if (.not. ready) return
      allocate (problem)
      call make_problem(set, prepared%mechanism, prepared%given, prepared%parameters, problem, &
                        all_arcs=everywhere .or. set%limits%ktheta /= 0)
   end procedure make_ready

   module procedure set_of
      type(data_set_t), allocatable :: sets(:)
      character(:), allocatable :: text, program
      logical :: anew

      own%file = name_of(case)
      program = everything
      if (present(reader)) program = reader
      anew = .not. allocated(case%set)
      ! of a sketch with variables the loops are others for a search; muscle writes groups anew that others keep
      if (.not. (anew .or. case%altered .or. program == everything .or. program == 'psalm')) then
         anew = program == 'muscle' .or. (case%set%is_drawn() .and. case%set%wants_search())
      end if
      if (.not. anew) then
         allocate (set, source=case%set)
      else if (allocated(case%parts) .or. allocated(case%source)) then
         text = case%text()
         call read_case_text(text, own%file, sets, own, program)
         if (size(sets) > 0) allocate (set, source=sets(1))
      else
         call own%error('the case is empty; begin with new_case, read_file or read_text')
      end if
      call own%append(case%faults)
   end procedure set_of

   !> The name of a case for messages, and for files that are counted from its directory. Lines of one that was read from a file and
   !> changed since are not lines of the file.
   pure function name_of(case) result(name)
      type(case_t), intent(in) :: case
      character(:), allocatable :: name

      name = memory_name
      if (allocated(case%set)) then
         name = case%set%file
      else if (allocated(case%faults%file)) then
         name = case%faults%file
         if (name /= memory_name) name = name//' (changed)'
      end if
   end function name_of

   module procedure tell

      if (allocated(own%file)) findings%file = own%file
      call findings%append(own)
   end procedure tell

   module procedure of_text
      type(findings_t) :: reported

      call read_text(text, cases, reported)
   end procedure of_text
end submodule psalm_case_reading
