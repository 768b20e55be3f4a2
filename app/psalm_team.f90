!> Who does the numbered work of a run: this process, with what other runs have left in files.
!>
!> The package `cluster` builds the same programs with another module of this name, in which the ranks of an MPI job share the work.
module psalm_team
   use psalm_stop, only: stop_request_t
   use psalm_system, only: finish_program
   use psalm_work_parts, only: parts_t
   implicit none (type, external)
   private
   public :: team_t

   type, extends(parts_t) :: team_t
      logical :: shares = .false.             !! numbered work is looked after: it is shared, or written now and then
      logical :: delivers = .true.            !! this process writes the results
      logical :: takes_part = .true.          !! --part may ask for one part of the work
   contains
      procedure :: start
      procedure :: read_parts
      procedure :: leave
   end type team_t

contains

   !> Before anything else. `host` is asked whether the run is to end.
   subroutine start(self, host)
      class(team_t), intent(inout) :: self
      class(stop_request_t), intent(in), target, optional :: host

      associate (unused => self, also_unused => present(host))
      end associate
   end subroutine start

   !> Read the files that other runs have left.
   subroutine read_parts(self, files, message)
      class(team_t), intent(inout) :: self
      integer, intent(out) :: files                   !! how many there are
      character(:), allocatable, intent(out) :: message !! what is wrong with one; empty: nothing

      call self%read_all(files, message)
   end subroutine read_parts

   !> Last of all: end the program with this status.
   subroutine leave(self, status)
      class(team_t), intent(in) :: self
      integer, intent(in) :: status

      associate (unused => self)
      end associate
      call finish_program(status)
   end subroutine leave
end module psalm_team
