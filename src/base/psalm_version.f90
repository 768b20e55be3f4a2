!> The version of the suite, and what it was built from, by what and for which processors.
module psalm_version
   use, intrinsic :: iso_c_binding, only: c_char, c_null_char, c_size_t
   use, intrinsic :: iso_fortran_env, only: compiler_options, compiler_version
   implicit none (type, external)
   private
   public :: version, words_of_build

   character(*), parameter :: version = '1.0.0' !! as in fpm.toml

   character(*), parameter :: options = compiler_options(), architecture = '-march='
   integer, parameter :: named = index(options, architecture)
   integer, parameter :: first = named + len(architecture)
   integer, parameter :: longest_commit = 64   !! characters, the zero at the end included

   interface
      subroutine c_commit(text, room) bind(c, name='psalm_commit')
         import :: c_char, c_size_t
         implicit none (type, external)
         character(kind=c_char), intent(out) :: text(*)
         integer(c_size_t), value :: room
      end subroutine c_commit
   end interface

contains

   !> Commit, compiler and instruction set of the build, as `--version` tells them.
   function words_of_build() result(words)
      character(:), allocatable :: words
      character(kind=c_char) :: commit(longest_commit)
      integer :: i

      call c_commit(commit, int(longest_commit, c_size_t))
      if (commit(1) == c_null_char) then
         words = 'commit not known'
      else
         words = 'commit '
         do i = 1, findloc(commit, c_null_char, dim=1) - 1
            words = words//commit(i)
         end do
      end if
      words = words//', '//compiler_version()//', instruction set '
      if (named == 0) then
         words = words//"the compiler's default"
      else
         words = words//options(first:first - 1 + scan(options(first:)//' ', ' ') - 1)
      end if
   end function words_of_build
end module psalm_version
