!> The groups that the programs of the suite know, and which program reads which.
module psalm_group_table
   use psalm_origin, only: name_length
   use psalm_text, only: nearest_name
   implicit none (type, external)
   private
   public :: known_groups, everything, program_reads, program_of, is_users, nearest_group

   integer, parameter :: programs_length = 64 !! characters of all programs' names

   !> A group and who reads it.
   type :: known_group_t
      character(name_length) :: name
      character(programs_length) :: programs !! names, a blank between them
   end type known_group_t

   type(known_group_t), parameter :: known_groups(*) = [ &
      known_group_t('LINKS', 'psalm kalm balm ssics muscle calm bridge'), &
      known_group_t('METHOD', 'psalm kalm balm ssics muscle calm bridge'), &
      known_group_t('CURVE', 'psalm kalm balm ssics muscle calm bridge'), &
      known_group_t('KINDS', 'psalm'), &
      known_group_t('LIMITS', 'psalm kalm balm ssics muscle calm bridge'), &
      known_group_t('SEARCH', 'psalm kalm balm ssics muscle calm bridge'), &
      known_group_t('CONSTR', 'psalm kalm balm ssics muscle calm bridge'), &
      known_group_t('TOLER', 'psalm kalm balm ssics muscle calm bridge'), &
      known_group_t('RATES', 'kalm balm ssics muscle calm bridge'), &
      known_group_t('CHAIN', 'psalm kalm balm ssics muscle calm bridge'), &
      known_group_t('DRIVES', 'psalm kalm balm ssics muscle calm bridge'), &
      known_group_t('OUTPUTS', 'psalm kalm balm ssics muscle calm bridge'), &
      known_group_t('MASSES', 'kalm balm ssics muscle calm bridge'), &
      known_group_t('PLATES', 'kalm balm ssics muscle calm bridge'), &
      known_group_t('LOADS', 'kalm balm ssics muscle calm bridge'), &
      known_group_t('SPRING', 'kalm balm ssics muscle calm bridge'), &
      known_group_t('FRICTN', 'kalm balm ssics muscle calm bridge'), &
      known_group_t('MOTOR', 'kalm balm'), &
      known_group_t('CYCLE', 'balm ssics muscle bridge'), &
      known_group_t('TIME', 'kalm balm'), &
      known_group_t('STOPS', 'kalm balm'), &
      known_group_t('VIBR', 'balm ssics'), &
      known_group_t('ESTIM', 'ssics'), &
      known_group_t('FLEX', 'ssics'), &
      known_group_t('DRIVEL', 'ssics'), &
      known_group_t('HILL', 'ssics'), &
      known_group_t('BALANC', 'muscle'), &
      known_group_t('CAM', 'calm'), &
      known_group_t('CAM2', 'calm'), &
      known_group_t('SPRNGS', 'muscle'), &
      known_group_t('CLEAR', 'balm bridge muscle'), &
      known_group_t('DXF', 'balm'), &
      known_group_t('SWEEP', 'psalm balm'), &
      known_group_t('ALLOC', 'psalm balm'), &
      known_group_t('EXACT', 'psalm balm')]

   character(*), parameter :: everything = '*' !! in place of a program: who reads all groups that a program of the suite reads
   character(*), parameter :: users = 'USER' !! groups whose names begin so are the user's own

contains

   !> True if the program reads the group.
   pure logical function program_reads(program, group)
      character(*), intent(in) :: program, group  !! `program` may be `everything`

      character(programs_length) :: programs

      programs = program_of(group)
      if (program == everything) then
         program_reads = len_trim(programs) > 0
      else
         program_reads = index(' '//trim(programs)//' ', ' '//trim(program)//' ') > 0
      end if
   end function program_reads

   !> The programs that read the group; blank if none does.
   pure function program_of(group) result(programs)
      character(*), intent(in) :: group
      character(programs_length) :: programs
      integer :: i

      programs = ''
      do i = 1, size(known_groups)
         if (known_groups(i)%name == group) programs = known_groups(i)%programs
      end do
   end function program_of

   !> True for a group of the user's own, which every program skips.
   pure logical function is_users(group)
      character(*), intent(in) :: group

      is_users = index(group, users) == 1
   end function is_users

   !> The known group with the nearest name; empty if none is near.
   pure function nearest_group(name) result(near)
      character(*), intent(in) :: name
      character(:), allocatable :: near
      character(name_length) :: names(size(known_groups))

      names = known_groups%name
      near = nearest_name(name, names)
   end function nearest_group
end module psalm_group_table
