!> The library for C, and through C for other languages: `include/psalm.h` describes every procedure.
!>
!> Here are the studies; cases are in `psalm_capi_cases`, results in `psalm_capi_results`, what both share in `psalm_capi_handles`.
module psalm_capi
   use, intrinsic :: iso_c_binding, only: c_associated, c_char, c_double, c_int, c_loc, c_null_char, c_null_ptr, c_ptr
   use psalm, only: findings_t, study, table_for_plots, verbs, version, wp
   use psalm_capi_handles, only: done, misuse, handle_t, result_handle_t, text_of, as_c, handle_of, concluded, wrong, &
                                 hand_over, put_integer, put_reals
   implicit none (type, external)
   private
   public :: psalm_library_version, psalm_interface, psalm_verb, psalm_status_text, psalm_study, psalm_cancel, psalm_progress

   ! the interface that a program was compiled for, as in psalm.h: it grows where a call is changed or left out
   integer(c_int), parameter :: interface_number = 1

   ! options of psalm_study, as in psalm.h
   integer(c_int), parameter :: option_brief = 1

   character(*, c_char), parameter :: nul = c_null_char
   character(*, c_char), parameter :: words = 'done'//nul// &
      'done, but constraints are violated or the search stopped early'//nul//'the input is wrong'//nul// &
      'a file could not be read, or there was not enough memory'//nul//'the call is wrong'//nul//'unknown status'//nul

   character(*, c_char), parameter :: names_of_verbs = trim(verbs(1)%name)//nul// &
      trim(verbs(2)%name)//nul// &
      trim(verbs(3)%name)//nul// &
      trim(verbs(4)%name)//nul// &
      trim(verbs(5)%name)//nul// &
      trim(verbs(6)%name)//nul// &
      trim(verbs(7)%name)//nul// &
      trim(verbs(8)%name)//nul// &
      trim(verbs(9)%name)//nul// &
      trim(verbs(10)%name)//nul// &
      trim(verbs(11)%name)//nul// &
      trim(verbs(12)%name)//nul// &
      trim(verbs(13)%name)//nul// &
      trim(verbs(14)%name)//nul// &
      trim(verbs(15)%name)//nul// &
      trim(verbs(16)%name)//nul// &
      trim(verbs(17)%name)//nul// &
      trim(verbs(18)%name)//nul// &
      trim(verbs(19)%name)//nul// &
      trim(verbs(20)%name)//nul// &
      trim(verbs(21)%name)//nul

   ! never changed; variables only so that they have an address
   character(len(version) + 1, c_char), target :: version_text = version//nul
   character(len(words), c_char), target :: status_words = words
   character(len(names_of_verbs), c_char), target :: verb_names = names_of_verbs

contains

   ! no function may be called like a module: their names are one to the compiler

   !> Version of the library; never freed.
   type(c_ptr) function psalm_library_version() bind(C)
      psalm_library_version = c_loc(version_text(1:1))
   end function psalm_library_version

   integer(c_int) function psalm_interface() bind(C)
      psalm_interface = interface_number
   end function psalm_interface

   !> Name of a verb; a null pointer if there are not so many.
   type(c_ptr) function psalm_verb(number) bind(C)
      integer(c_int), value, intent(in) :: number
      integer :: first, i

      psalm_verb = c_null_ptr
      if (number < 1 .or. number > size(verbs)) return
      first = 1
      do i = 2, number
         first = first + len_trim(verbs(i - 1)%name) + 1
      end do
      psalm_verb = c_loc(verb_names(first:first))
   end function psalm_verb

   !> What a status means; never freed.
   type(c_ptr) function psalm_status_text(status) bind(C)
      integer(c_int), value, intent(in) :: status
      integer :: first, i

      first = 1
      do i = 1, merge(int(status), int(misuse) + 1, status >= done .and. status <= misuse)
         first = first + index(words(first:), nul)
      end do
      psalm_status_text = c_loc(status_words(first:first))
   end function psalm_status_text

   integer(c_int) function psalm_study(handle, verb, options, threads, made) bind(C)
      type(c_ptr), value, intent(in) :: handle, verb
      integer(c_int), value, intent(in) :: options, threads
      type(c_ptr), value, intent(in) :: made
      type(handle_t), pointer :: own
      type(result_handle_t), pointer :: result
      type(findings_t) :: findings

      psalm_study = misuse
      if (c_associated(made)) call hand_over(made, c_null_ptr)
      own => handle_of(handle)
      if (.not. associated(own)) return
      if (.not. (c_associated(made) .and. c_associated(verb))) then
         psalm_study = wrong(own, 'psalm_study: verb and made must not be NULL')
         return
      end if
      if (options /= 0 .and. options /= option_brief) then
         psalm_study = wrong(own, 'psalm_study: options must be 0 or PSALM_BRIEF')
         return
      end if
      call begin_watch(own)
      call own%case%settle()
      allocate (result)
      call study(own%case, text_of(verb), result%report, findings, int(threads), own%ending, own%watch, options == option_brief)
      psalm_study = concluded(own, findings, result%report%violated)
      if (findings%failed()) then
         deallocate (result)
         return
      end if
      call finish_result(result, text_of(verb))
      call hand_over(made, c_loc(result))
   end function psalm_study

   !> What is handed out as long as the result lives.
   subroutine finish_result(result, verb)
      type(result_handle_t), intent(inout) :: result
      character(*), intent(in) :: verb                    !! what the table is that comes first
      integer :: i, first

      associate (report => result%report)
         result%tables = pack([(i, i=1, report%tables%count)], &
                              [(report%tables%tables(i)%audience /= table_for_plots, i=1, report%tables%count)])
         first = report%find(trim(verbs(findloc(verbs%name == verb, .true., dim=1))%table))
         if (first > 0) result%tables = [first, pack(result%tables, result%tables /= first)]
         result%listing = as_c(report%listing)
         result%data_set = as_c(report%data_set)
         result%reported = as_c('')
         allocate (result%files(size(report%files)))
         do i = 1, size(report%files)
            result%files(i) = as_c(report%files(i)%content)
            deallocate (report%files(i)%content)
         end do
      end associate
   end subroutine finish_result

   !> Before a study that can be ended: nobody has asked yet.
   subroutine begin_watch(own)
      type(handle_t), intent(inout), target :: own

      !$omp atomic write
      own%host%wants_end = 0
      !$omp atomic write
      own%watch%made = 0
      !$omp atomic write
      own%watch%most = 0
      own%host%followed = 0
      own%host%paths = 0
      call own%ending%listen_to(own%host)
   end subroutine begin_watch

   integer(c_int) function psalm_cancel(handle) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(handle_t), pointer :: own

      psalm_cancel = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      !$omp atomic write
      own%host%wants_end = 1
      psalm_cancel = done
   end function psalm_cancel

   integer(c_int) function psalm_progress(handle, made, most, best) bind(C)
      type(c_ptr), value, intent(in) :: handle
      type(c_ptr), value, intent(in) :: made, most, best
      type(handle_t), pointer :: own
      integer(c_int) :: number, paths
      real(c_double) :: objective

      psalm_progress = misuse
      own => handle_of(handle)
      if (.not. associated(own)) return
      if (c_associated(made)) then
         !$omp atomic read
         number = own%watch%made
         !$omp atomic read
         paths = own%host%followed
         call put_integer(max(number, paths), made)
      end if
      if (c_associated(most)) then
         !$omp atomic read
         number = own%watch%most
         !$omp atomic read
         paths = own%host%paths
         call put_integer(max(number, paths), most)
      end if
      if (c_associated(best)) then
         !$omp atomic read
         objective = own%watch%best
         call put_reals([real(objective, wp)], best)
      end if
      psalm_progress = done
   end function psalm_progress
end module psalm_capi
