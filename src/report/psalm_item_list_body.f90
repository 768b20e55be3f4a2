!> Which items there are, and how they are written: only this knows all groups.
submodule(psalm_item_list) psalm_item_list_body
   use psalm_allocation_group, only: allocation_items
   use psalm_balance_group, only: balance_items
   use psalm_cam_group, only: cam_items
   use psalm_chain_group, only: chain_items
   use psalm_clearance_group, only: clearance_items
   use psalm_constraint_group, only: constraint_items
   use psalm_drive_group, only: hill_items, shaft_items
   use psalm_drives_group, only: drive_items
   use psalm_curve_group, only: curve_items
   use psalm_cycle_group, only: cycle_items
   use psalm_dxf_group, only: dxf_items
   use psalm_exact_group, only: exact_items
   use psalm_flex_group, only: flex_items
   use psalm_friction_group, only: friction_items
   use psalm_group_table, only: known_groups, nearest_group, program_of, program_reads
   use psalm_kinds, only: wp
   use psalm_kinds_defaults, only: kinds_items
   use psalm_limits_group, only: limit_items
   use psalm_links_group, only: link_items
   use psalm_load_group, only: load_items
   use psalm_json, only: json_text
   use psalm_mass_group, only: mass_items
   use psalm_plate_group, only: plate_items
   use psalm_method_group, only: method_items
   use psalm_motor_group, only: motor_items
   use psalm_number, only: parse_real
   use psalm_outputs_group, only: output_items
   use psalm_rates_group, only: rate_items
   use psalm_rule, only: rule_t, limits_t, limits_of, word_count, word_of, a_flag, a_number, a_text, a_whole, a_word, any_number, &
                         required_word
   use psalm_search_group, only: search_items
   use psalm_spring_design_group, only: design_items
   use psalm_spring_group, only: spring_items
   use psalm_stops_group, only: stops_items
   use psalm_sweep_group, only: sweep_items
   use psalm_text, only: upper_case
   use psalm_time_group, only: time_items
   use psalm_tolerance_group, only: tolerance_items
   use psalm_vibration_group, only: estimate_items, vibration_items
   implicit none (type, external)

   integer, parameter :: width = 100            !! columns of the list
   integer, parameter :: indent = 10            !! of what stands behind a name
   character(*), parameter :: dialect = 'https://json-schema.org/draft/2020-12/schema'

contains

   !> The table of a group; none for a group that nobody knows.
   pure function rules_of(group) result(rules)
      character(*), intent(in) :: group
      type(rule_t), allocatable :: rules(:)

      select case (group)
      case ('LINKS')
         rules = link_items
      case ('METHOD')
         rules = method_items
      case ('LIMITS')
         rules = limit_items
      case ('SEARCH')
         rules = search_items
      case ('CONSTR')
         rules = constraint_items
      case ('TOLER')
         rules = tolerance_items
      case ('RATES')
         rules = rate_items
      case ('CHAIN')
         rules = chain_items
      case ('DRIVES')
         rules = drive_items
      case ('OUTPUTS')
         rules = output_items
      case ('MASSES')
         rules = mass_items
      case ('LOADS')
         rules = load_items
      case ('SPRING')
         rules = spring_items
      case ('FRICTN')
         rules = friction_items
      case ('MOTOR')
         rules = motor_items
      case ('CYCLE')
         rules = cycle_items
      case ('VIBR')
         rules = vibration_items
      case ('ESTIM')
         rules = estimate_items
      case ('FLEX')
         rules = flex_items
      case ('DRIVEL')
         rules = shaft_items
      case ('HILL')
         rules = hill_items
      case ('BALANC')
         rules = balance_items
      case ('CAM', 'CAM2')
         rules = cam_items
      case ('SPRNGS')
         rules = design_items
      case ('CLEAR')
         rules = clearance_items
      case ('DXF')
         rules = dxf_items
      case ('KINDS')
         rules = kinds_items
      case ('CURVE')
         rules = curve_items
      case ('ALLOC')
         rules = allocation_items
      case ('SWEEP')
         rules = sweep_items
      case ('EXACT')
         rules = exact_items
      case ('TIME')
         rules = time_items
      case ('PLATES')
         rules = plate_items
      case ('STOPS')
         rules = stops_items
      case default
         allocate (rules(0))
      end select
   end function rules_of

   module procedure why_no_group
      character(:), allocatable :: near

      text = ''
      if (program_reads(program, upper_case(group))) return
      if (len_trim(program_of(upper_case(group))) > 0) then
         text = 'does not read &'//upper_case(group)//'; that is a group of '//trim(program_of(upper_case(group)))
         return
      end if
      near = nearest_group(upper_case(group))
      text = "no group is called '"//group//"'"
      if (len(near) > 0) text = text//'; did you mean '//near//'?'
   end procedure why_no_group

   ! ---- to read -----------------------------------------------------------------------------------------------------

   module procedure list_groups
      type(rule_t), allocatable :: rules(:)
      character(:), allocatable :: names
      integer :: g, i

      call text%add('Groups that '//program//' reads, and their items; '//program//' --items GROUP describes them:')
      do g = 1, size(known_groups)
         if (.not. program_reads(program, trim(known_groups(g)%name))) cycle
         rules = rules_of(trim(known_groups(g)%name))
         names = ''
         do i = 1, size(rules)
            if (i > 1) names = names//', '
            names = names//written(rules(i))
         end do
         call add_item('&'//trim(known_groups(g)%name), names, text)
      end do
   end procedure list_groups

   module procedure list_items
      type(rule_t), allocatable :: rules(:)
      integer :: i

      rules = rules_of(upper_case(group))
      call text%add('&'//upper_case(group)//', read by '//trim(program_of(upper_case(group))))
      do i = 1, size(rules)
         call add_item(written(rules(i)), traits_of(rules(i)), text)
         call add_item('', plain(trim(rules(i)%meaning)), text)
      end do
   end procedure list_items

   !> A name, and words behind it, in lines of a fair length.
   pure subroutine add_item(name, words, text)
      character(*), intent(in) :: name, words
      type(text_t), intent(inout) :: text
      character(:), allocatable :: line
      integer :: i, n

      line = ' '//name
      line = line//repeat(' ', max(1, indent - len(line)))
      n = word_count(words)
      do i = 1, n
         if (len_trim(line) + 1 + len(word_of(words, i)) > width .and. len_trim(line) > indent) then
            call text%add(trim(line))
            line = repeat(' ', indent)
         end if
         line = line//word_of(words, i)//' '
      end do
      call text%add(trim(line))
   end subroutine add_item

   !> Kind, number, unit, values and default of an item.
   pure function traits_of(rule) result(text)
      type(rule_t), intent(in) :: rule
      character(:), allocatable :: text
      type(limits_t) :: limits
      logical :: valid

      select case (rule%kind)
      case (a_flag)
         text = '0 or 1'
      case (a_whole)
         text = 'integer'
      case (a_number)
         text = 'number'
      case (a_word)
         text = 'word'
      case default
         text = 'text'
      end select
      if (len_trim(rule%shape) > 0) then
         text = text//', '//in_words(trim(rule%shape))
      end if
      if (len_trim(rule%unit) > 0) text = text//', '//trim(rule%unit)
      call limits_of(rule%values, limits, valid)
      if (valid) then
         text = text//', '//trim(interval(rule%values))
      else if (len_trim(rule%values) > 0) then
         text = text//': '//trim(rule%values)
      end if
      if (rule%default == required_word) then
         text = text//'; required'
      else if (len_trim(rule%default) > 0) then
         text = text//'; default '//trim(rule%default)
      end if
   end function traits_of

   !> How many there are.
   pure function in_words(shape) result(text)
      character(*), intent(in) :: shape
      character(:), allocatable :: text
      integer :: star

      star = index(shape, '*')
      if (star > 0) then
         text = shape(:star - 1)//' rows of '//shape(star + 1:)
      else if (shape == 'n') then
         text = 'any number of them'
      else
         text = shape//' of them'
      end if
   end function in_words

   !> An interval in words.
   pure function interval(values) result(text)
      character(*), intent(in) :: values
      character(:), allocatable :: text
      type(limits_t) :: limits
      logical :: valid

      call limits_of(values, limits, valid)
      text = ''
      if (len_trim(limits%low_text) > 0) text = trim(merge('above   ', 'at least', limits%without_low))//' '//trim(limits%low_text)
      if (len_trim(limits%high_text) == 0) return
      if (len(text) > 0) text = text//', '
      text = text//trim(merge('below  ', 'at most', limits%without_high))//' '//trim(limits%high_text)
   end function interval

   !> The name as it is written in a case.
   pure function written(rule) result(name)
      type(rule_t), intent(in) :: rule
      character(:), allocatable :: name
      integer :: at

      name = trim(rule%name)
      at = index(name, any_number)
      if (at > 0) name = name(:at - 1)//'1...'
   end function written

   !> A sentence without the marks of the manual: quotes of code, links.
   pure function plain(marked) result(text)
      character(*), intent(in) :: marked
      character(:), allocatable :: text
      integer :: i

      text = ''
      i = 1
      do while (i <= len(marked))
         select case (marked(i:i))
         case ('`', '[')
            continue
         case (']')
            if (index(marked(i:), '](') == 1) i = i + index(marked(i:), ')') - 1
         case ('*')
            if (index(marked(i:), '**') == 1) then
               i = i + 1
            else
               text = text//'*'
            end if
         case default
            text = text//marked(i:i)
         end select
         i = i + 1
      end do
   end function plain

   ! ---- for programs ------------------------------------------------------------------------------------------------

   module procedure write_schema
      integer :: g
      character(:), allocatable :: name

      call text%add('{"$schema":'//json_text(dialect)//',')
      call text%add('"title":'//json_text('Cases of '//program//' '//version)//',')
      call text%add('"anyOf":[{"$ref":"#/$defs/case"},{"type":"array","minItems":1,"items":{"$ref":"#/$defs/case"}}],')
      call text%add('"$defs":{')
      call add_arrays('whole', 'integer', text)
      call add_arrays('number', 'number', text)
      call add_arrays('text', 'string', text)
      call text%add('"flag":{"enum":[0,1,true,false]},')
      call text%add('"flags":{"anyOf":[{"$ref":"#/$defs/flag"},{"type":"array","items":{"anyOf":[{"$ref":"#/$defs/flag"},'// &
                    '{"type":"null"},{"type":"array","items":{"anyOf":[{"$ref":"#/$defs/flag"},{"type":"null"}]}}]}}]},')
      call text%add('"case":{"type":"object","required":["title"],"additionalProperties":false,')
      call text%add('"patternProperties":{"^USER":{}},')
      call text%add('"properties":{"$schema":{"type":"string"},"title":{"type":"string","maxLength":72,'// &
                    '"description":"the first line of the listing"}')
      do g = 1, size(known_groups)
         name = trim(known_groups(g)%name)
         call text%add(','//json_text(name)//':{"type":"object","x-programs":'//json_text(trim(known_groups(g)%programs))//',')
         if (program_reads(program, name)) then
            call add_items(rules_of(name), text)
         else
            call text%add('"description":'//json_text('read by '//trim(known_groups(g)%programs))//'}')
         end if
      end do
      call text%add('}}}}')
   end procedure write_schema

   !> One value, or an array of them that may have rows.
   pure subroutine add_arrays(name, kind, text)
      character(*), intent(in) :: name, kind
      type(text_t), intent(inout) :: text

      call text%add('"'//name//'s":{"type":["'//kind//'","array"],"items":{"type":["'//kind//'","null","array"],')
      call text%add('"items":{"type":["'//kind//'","null"]}}},')
   end subroutine add_arrays

   pure subroutine add_items(rules, text)
      type(rule_t), intent(in) :: rules(:)
      type(text_t), intent(inout) :: text
      logical :: numbered(size(rules))
      integer :: i
      logical :: first

      numbered = index(rules%name, any_number) > 0
      call text%add('"additionalProperties":false,"properties":{')
      first = .true.
      do i = 1, size(rules)
         if (numbered(i)) cycle
         call text%add(trim(merge(' ', ',', first))//json_text(trim(rules(i)%name))//':'//schema_of(rules(i)))
         first = .false.
      end do
      call text%add('}')
      if (any(numbered)) then
         call text%add(',"patternProperties":{')
         first = .true.
         do i = 1, size(rules)
            if (.not. numbered(i)) cycle
            call text%add(trim(merge(' ', ',', first))//json_text('^'//rules(i)%name(:index(rules(i)%name, any_number) - 1)// &
                                                                  '[1-9][0-9]*$')//':'//schema_of(rules(i)))
            first = .false.
         end do
         call text%add('}')
      end if
      call text%add('}')
   end subroutine add_items

   !> What one item may be.
   pure function schema_of(rule) result(text)
      type(rule_t), intent(in) :: rule
      character(:), allocatable :: text
      type(limits_t) :: limits
      integer :: k
      logical :: scalar, interval_given

      scalar = len_trim(rule%shape) == 0
      call limits_of(rule%values, limits, interval_given)
      select case (rule%kind)
      case (a_flag)
         text = '{"$ref":"#/$defs/flag'//trim(merge(' ', 's', scalar))//'"'
      case (a_whole, a_number)
         if (scalar) then
            text = '{"type":"'//trim(merge('integer', 'number ', rule%kind == a_whole))//'"'
            if (interval_given) then
               if (limits%bounded_below) text = text//',"'//trim(merge('exclusiveMinimum', 'minimum         ', &
                                                                       limits%without_low))//'":'//trim(limits%low_text)
               if (limits%bounded_above) text = text//',"'//trim(merge('exclusiveMaximum', 'maximum         ', &
                                                                       limits%without_high))//'":'//trim(limits%high_text)
            else if (len_trim(rule%values) > 0) then
               text = text//',"enum":['//word_of(rule%values, 1)
               do k = 2, word_count(rule%values)
                  text = text//','//word_of(rule%values, k)
               end do
               text = text//']'
            end if
         else
            text = '{"$ref":"#/$defs/'//trim(merge('wholes ', 'numbers', rule%kind == a_whole))//'"'
         end if
      case (a_word)
         text = '{"type":"string"'
         if (len_trim(rule%values) > 0) then
            text = text//',"enum":['//json_text(word_of(rule%values, 1))
            do k = 2, word_count(rule%values)
               text = text//','//json_text(word_of(rule%values, k))
            end do
            text = text//']'
         end if
      case default
         text = '{"$ref":"#/$defs/texts"'
      end select
      text = text//',"description":'//json_text(plain(trim(rule%meaning)))
      if (plain(trim(rule%meaning)) /= trim(rule%meaning)) text = text//',"markdownDescription":'//json_text(trim(rule%meaning))
      if (is_value(rule)) text = text//',"default":'//default_of(rule)
      text = text//',"x-kind":'//json_text(kind_name(rule%kind))
      if (.not. scalar) text = text//',"x-shape":'//json_text(trim(rule%shape))
      if (len_trim(rule%unit) > 0) text = text//',"x-unit":'//json_text(trim(rule%unit))
      if (len_trim(rule%values) > 0) text = text//',"x-values":'//json_text(trim(rule%values))
      if (len_trim(rule%default) > 0) text = text//',"x-default":'//json_text(trim(rule%default))
      text = text//'}'
   end function schema_of

   !> True if the default is a value.
   pure logical function is_value(rule)
      type(rule_t), intent(in) :: rule
      character(:), allocatable :: reason
      real(wp) :: number

      is_value = rule%kind == a_word .and. len_trim(rule%default) > 0 .and. scan(trim(rule%default), ' ,') == 0
      if (any(rule%kind == [a_word, a_text])) return
      call parse_real(trim(rule%default), number, is_value, reason)
   end function is_value

   pure function default_of(rule) result(text)
      type(rule_t), intent(in) :: rule
      character(:), allocatable :: text

      text = trim(rule%default)
      if (rule%kind == a_word) text = json_text(text)
   end function default_of

   pure function kind_name(kind) result(name)
      integer, intent(in) :: kind
      character(:), allocatable :: name

      select case (kind)
      case (a_flag)
         name = 'flag'
      case (a_whole)
         name = 'integer'
      case (a_number)
         name = 'number'
      case (a_word)
         name = 'word'
      case default
         name = 'text'
      end select
   end function kind_name
end submodule psalm_item_list_body
