!> The version of the suite.
module psalm_version
   implicit none (type, external)
   private
   public :: version

   character(*), parameter :: version = '0.1.0' !! as in fpm.toml
end module psalm_version
