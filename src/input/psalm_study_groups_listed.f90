!> The groups that studies read: a new one is a line here, and one in `psalm_group_table`, which says for what programs.
submodule(psalm_study_groups) psalm_study_groups_listed
   use psalm_allocation_group, only: allocation_group_t
   use psalm_balance_group, only: balance_group_t
   use psalm_cam_group, only: cam_section_t
   use psalm_clearance_group, only: clearance_group_t
   use psalm_cycle_group, only: cycle_group_t
   use psalm_drive_group, only: drive_group_t, hill_group_t
   use psalm_dxf_group, only: dxf_group_t
   use psalm_exact_group, only: exact_group_t
   use psalm_flex_group, only: flex_group_t
   use psalm_kinds_group, only: kinds_group_t
   use psalm_motor_group, only: motor_group_t
   use psalm_plate_group, only: plate_group_t
   use psalm_spring_design_group, only: spring_design_group_t
   use psalm_stops_group, only: stops_group_t
   use psalm_sweep_group, only: sweep_group_t
   use psalm_time_group, only: time_group_t
   use psalm_vibration_group, only: vibration_group_t, estimate_group_t
   implicit none (type, external)

contains

   module procedure study_groups
      allocate (sections(20))
      sections%name = [character(len(sections%name)) :: 'MOTOR', 'VIBR', 'ESTIM', 'DRIVEL', 'HILL', 'BALANC', 'CAM', 'SPRNGS', &
                       'CLEAR', 'CAM2', 'EXACT', 'DXF', 'SWEEP', 'KINDS', 'ALLOC', 'TIME', 'STOPS', &
                       'PLATES', 'FLEX', 'CYCLE']
      allocate (motor_group_t :: sections(1)%group)
      allocate (vibration_group_t :: sections(2)%group)
      allocate (estimate_group_t :: sections(3)%group)
      allocate (drive_group_t :: sections(4)%group)
      allocate (hill_group_t :: sections(5)%group)
      allocate (balance_group_t :: sections(6)%group)
      allocate (cam_section_t :: sections(7)%group)
      allocate (spring_design_group_t :: sections(8)%group)
      allocate (clearance_group_t :: sections(9)%group)
      allocate (cam_section_t :: sections(10)%group)
      allocate (exact_group_t :: sections(11)%group)
      allocate (dxf_group_t :: sections(12)%group)
      allocate (sweep_group_t :: sections(13)%group)
      allocate (kinds_group_t :: sections(14)%group)
      allocate (allocation_group_t :: sections(15)%group)
      allocate (time_group_t :: sections(16)%group)
      allocate (stops_group_t :: sections(17)%group)
      allocate (plate_group_t :: sections(18)%group)
      allocate (flex_group_t :: sections(19)%group)
      allocate (cycle_group_t :: sections(20)%group)
   end procedure study_groups
end submodule psalm_study_groups_listed
