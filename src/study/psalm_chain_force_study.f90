!> Forces of a sketch that is followed in the poses of its links: drives, frame and every pair of links.
!>
!> Data in, results out. Source: Oldham (1977), 15.1.
module psalm_chain_force_study
   use psalm_chain_force_model, only: chain_model_t, make_chain_model, pair_slide
   use psalm_chain_forces, only: analyse_chain, share_of_chain, chain_of_unit_masses, column_of_drive
   use psalm_chain_study, only: chain_study_t
   use psalm_closure, only: closure_t, state_t
   use psalm_data_set, only: data_set_t
   use psalm_force_analysis, only: column_drive, column_fx, column_fy, column_moment
   use psalm_force_study, only: force_study_t, name_sources, size_up, find_harmonics_of
   use psalm_kinds, only: wp
   use psalm_sketch, only: frame_link, drive_turns
   use psalm_sketch_case, only: assemble_sketch
   use psalm_status, only: diagnostics_t
   implicit none (type, external)
   private
   public :: find_chain_forces, judge_chain_forces

contains

   !> Find what is wrong with the groups of forces before any work is done.
   subroutine judge_chain_forces(set, findings)
      type(data_set_t), intent(in) :: set
      type(diagnostics_t), intent(inout) :: findings
      type(closure_t) :: closure
      type(state_t) :: start
      type(chain_model_t) :: model
      type(diagnostics_t) :: unused
      logical :: sound

      call assemble_sketch(set, closure, start, sound, unused)
      if (sound) call make_chain_model(set, closure, model, findings)
   end subroutine judge_chain_forces

   !> Forces at the positions of a study, of a case that `judge_chain_forces` found no fault with.
   subroutine find_chain_forces(set, chain, study, by_unit_mass)
      type(data_set_t), intent(in) :: set
      type(chain_study_t), intent(in) :: chain
      type(force_study_t), intent(out) :: study
      real(wp), allocatable, intent(inout), optional :: by_unit_mass(:, :, :, :) !! see `chain_of_unit_masses`
      type(chain_model_t) :: model
      type(diagnostics_t) :: unused
      real(wp) :: rate
      integer :: k, d, l

      associate (sketch => chain%closure%sketch)
         call make_chain_model(set, chain%closure, model, unused)
         study%rubs = size(model%friction) > 0
         study%of_sketch = .true.
         study%drive_slides = sketch%drives%kind /= drive_turns
         allocate (study%drives(size(sketch%drives)), study%joints(size(model%pairs)), study%parts(size(chain%closure%groups)))
         do k = 1, size(study%drives)
            study%drives(k) = sketch%drive_label(k)
         end do
         do k = 1, size(study%joints)
            study%joints(k)%name = model%pairs(k)%name
            study%joints(k)%slides = model%pairs(k)%kind == pair_slide
         end do
         do k = 1, size(study%parts)
            study%parts(k) = ''
            do l = 1, size(chain%closure%groups(k)%links)
               study%parts(k) = trim(study%parts(k))//' '//sketch%links(chain%closure%groups(k)%links(l))%name
            end do
            study%parts(k) = adjustl(study%parts(k))
         end do
         study%input = chain%inputs(1, :)
         call analyse_chain(chain%closure, chain%motion, study%input, model, study%table)
         associate (v => study%table%value)
            allocate (study%drive_power(size(study%input)), source=0.0_wp)
            do d = 1, size(sketch%drives)
               do k = 1, size(study%input)
                  if (.not. study%table%known(k)) cycle
                  rate = chain%motion%states(k)%input(d, 1)
                  if (study%drive_slides(d)) rate = rate*model%metre
                  study%drive_power(k) = study%drive_power(k) + v(k, column_of_drive(model, d))*rate
               end do
               if (set%masses%motor_on_frame .or. study%drive_slides(d)) cycle
               ! a flywheel elsewhere holds the speed: the frame does not feel the motor
               if (sketch%drives(d)%base == frame_link) v(:, column_moment) = v(:, column_moment) + v(:, column_of_drive(model, d))
               if (sketch%drives(d)%link == frame_link) v(:, column_moment) = v(:, column_moment) - v(:, column_of_drive(model, d))
            end do
            associate (x => set%masses%about(1)*model%metre, y => set%masses%about(2)*model%metre)
               study%about = v(:, column_moment) - (x*v(:, column_fy) - y*v(:, column_fx))
            end associate
         end associate
      end associate
      if (set%masses%shares /= 0) then
         call share_of_chain(chain%closure, chain%motion, study%input, model, study%shares)
         call name_sources(size(model%loads), study)
      end if
      if (present(by_unit_mass)) call chain_of_unit_masses(chain%closure, chain%motion, model, by_unit_mass)
      call size_up(study)
      call find_harmonics_of(study, merge(set%masses%harmonics, 0, size(study%drives) == 1))
   end subroutine find_chain_forces
end module psalm_chain_force_study
