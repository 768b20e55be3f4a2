!> Forces: tables of an independent method, Newton and Euler for every link, power, virtual work, friction, balance.
program test_forces
   use cases, only: names
   use force_checks, only: t, reference_table, reference_joints, unit_columns, every_link_in_equilibrium, power_balance, &
                           virtual_work, friction_reference, counterweights, motion_from_torque, &
                           near_a_dead_point
   implicit none (type, external)
   integer :: k

   call reference_table()
   call reference_joints()
   call unit_columns()
   do k = 1, size(names)
      call every_link_in_equilibrium(names(k))
      call power_balance(names(k))
      call virtual_work(names(k))
   end do
   call friction_reference()
   call counterweights()
   call motion_from_torque()
   call near_a_dead_point()
   call t%report()
end program test_forces
