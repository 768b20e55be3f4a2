!> Forces: tables of an independent method, Newton and Euler for every link, power, virtual work, friction, balance.
program test_forces
   use cases, only: names
   use force_checks, only: t, reference_table, reference_joints, unit_columns, every_link_in_equilibrium, power_balance, &
                           virtual_work, friction_reference, counterweights, motion_from_torque, &
                           near_a_dead_point, momentum_and_energy, scaling_of_speed, shift_and_turn, order_of_loops, &
                           units_and_sizes, table_begun_elsewhere
   implicit none (type, external)
   character(*), parameter :: others(*) = [character(27) :: 'brake_reaction_lsq', 'door_five_poses', 'drive_haines', 'dwell', &
      'engine', 'four_bar_haines', 'line6', 'log10', 'needle_lsq', 'needle_masses', 'needle_nelder_mead', 'needle_search', &
      'needle_unweighted', 'needle_wide', 'path18', 'path18_free', 'path5', 'rig_coupler', 'slider_linear', 'spring_friction', &
      'striking', 'suspension'] !! the rest of the data sets of &LINKS; some do not close everywhere
   integer :: k

   call reference_table()
   call reference_joints()
   call unit_columns()
   do k = 1, size(names)
      call every_link_in_equilibrium(names(k))
      call power_balance(names(k))
      call virtual_work(names(k))
      call momentum_and_energy(names(k))
      call scaling_of_speed(names(k))
      call shift_and_turn(names(k))
   end do
   do k = 1, size(others)
      call every_link_in_equilibrium(others(k))
      call power_balance(others(k))
      call momentum_and_energy(others(k))
   end do
   call order_of_loops()
   call units_and_sizes()
   call friction_reference()
   call counterweights()
   call motion_from_torque()
   call near_a_dead_point()
   call table_begun_elsewhere()
   call t%report()
end program test_forces
