!> What can be said of a part of the input's range.
module psalm_proof_pieces
   implicit none (type, external)
   private
   public :: piece_closes, piece_opens, piece_undecided

   integer, parameter :: piece_closes = 1     !! every group closes at every input of it
   integer, parameter :: piece_opens = 2      !! at every input of it a group does not close
   integer, parameter :: piece_undecided = 3  !! neither is claimed
end module psalm_proof_pieces
