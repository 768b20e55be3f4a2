/* SUNDIALS' CVODE, loaded when it is asked for: programs and libraries run without it.

   Hindmarsh and others, SUNDIALS: Suite of nonlinear and differential/algebraic equation solvers, ACM TOMS 31 (2005). The interface
   is that of versions 6 and 7, with reals of double precision and indices of 64 bits, as distributions have them. */
#define _XOPEN_SOURCE 700
#include <dlfcn.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef int rates_t(int n, double time, const double *y, double *d, void *user); /* 0: done; 1: there are none */
typedef void *handle_t;                    /* of CVODE's objects */

enum { bdf = 2, one_step = 2 };            /* CV_BDF, CV_ONE_STEP */
enum { oldest = 6, newest = 7 };           /* versions whose interface this is */
enum { word_room = 32 };
enum { many_steps = -1 };                  /* between two states that are asked for: without limit */

static const char *const names[] = {"libsundials_cvode.so.7", "libsundials_cvode.so.6",
                                    "libsundials_cvode.7.dylib", "libsundials_cvode.6.dylib"};

/* What of the library is called. */
struct library {
    int (*version)(int *, int *, int *, char *, int);
    int (*context)(handle_t, handle_t *);
    int (*context_of_7)(int, handle_t *);
    int (*free_context)(handle_t *);
    int (*no_handlers)(handle_t);          /* of version 7: nothing is written */
    handle_t (*vector)(int64_t, double *, handle_t);
    double *(*values)(handle_t);
    void (*free_vector)(handle_t);
    handle_t (*matrix)(int64_t, int64_t, handle_t);
    void (*free_matrix)(handle_t);
    handle_t (*solver)(handle_t, handle_t, handle_t);
    int (*free_solver)(handle_t);
    handle_t (*create)(int, handle_t);
    int (*no_messages)(handle_t, void *);  /* of version 6: the same */
    int (*begin)(handle_t, int (*)(double, handle_t, handle_t, void *), double, handle_t);
    int (*again)(handle_t, double, handle_t);
    int (*tolerances)(handle_t, double, handle_t);
    int (*user)(handle_t, void *);
    int (*steps)(handle_t, long);
    int (*set_solver)(handle_t, handle_t, handle_t);
    int (*stop_at)(handle_t, double);
    int (*go_on)(handle_t, double, handle_t, double *, int);
    int (*state)(handle_t, double, int, handle_t);
    void (*free_all)(handle_t *);
};

struct integration {
    struct library call;
    int n;
    rates_t *rates;
    void *user;
    handle_t context, memory, y, allowed, matrix, solver;
};

/* Finds all of the library that is needed; 0: it is not there, or of another version. */
static int find_library(struct library *call)
{
    const struct { const char *name; void **place; int must; } wanted[] = {
        {"SUNDIALSGetVersionNumber", (void **)&call->version, 1}, {"SUNContext_Create", (void **)&call->context, 1},
        {"SUNContext_Create", (void **)&call->context_of_7, 1}, {"SUNContext_Free", (void **)&call->free_context, 1},
        {"SUNContext_ClearErrHandlers", (void **)&call->no_handlers, 0}, {"N_VMake_Serial", (void **)&call->vector, 1},
        {"N_VGetArrayPointer", (void **)&call->values, 1}, {"N_VDestroy", (void **)&call->free_vector, 1},
        {"SUNDenseMatrix", (void **)&call->matrix, 1}, {"SUNMatDestroy", (void **)&call->free_matrix, 1},
        {"SUNLinSol_Dense", (void **)&call->solver, 1}, {"SUNLinSolFree", (void **)&call->free_solver, 1},
        {"CVodeCreate", (void **)&call->create, 1}, {"CVodeSetErrFile", (void **)&call->no_messages, 0},
        {"CVodeInit", (void **)&call->begin, 1}, {"CVodeReInit", (void **)&call->again, 1},
        {"CVodeSVtolerances", (void **)&call->tolerances, 1}, {"CVodeSetUserData", (void **)&call->user, 1},
        {"CVodeSetMaxNumSteps", (void **)&call->steps, 1}, {"CVodeSetLinearSolver", (void **)&call->set_solver, 1},
        {"CVodeSetStopTime", (void **)&call->stop_at, 1}, {"CVode", (void **)&call->go_on, 1},
        {"CVodeGetDky", (void **)&call->state, 1}, {"CVodeFree", (void **)&call->free_all, 1}};
    char label[word_room];
    void *library = NULL;
    size_t i;
    int major = 0, minor = 0, patch = 0;

    for (i = 0; i < sizeof names / sizeof names[0] && !library; i++) library = dlopen(names[i], RTLD_NOW | RTLD_LOCAL);
    if (!library) return 0;
    for (i = 0; i < sizeof wanted / sizeof wanted[0]; i++) {
        void *found = dlsym(library, wanted[i].name);
        if (!found && wanted[i].must) return 0;
        memcpy(wanted[i].place, &found, sizeof found);
    }
    if (call->version(&major, &minor, &patch, label, sizeof label) != 0) return 0;
    if (major < newest) call->context_of_7 = NULL;
    return major >= oldest && major <= newest;
}

/* Is it installed? */
int psalm_cvode_there(void)
{
    struct library call;

    return find_library(&call);
}

static int rates_for_library(double time, handle_t y, handle_t d, void *user)
{
    const struct integration *one = user;

    return one->rates(one->n, time, one->call.values(y), one->call.values(d), one->user);
}

void psalm_cvode_close(void *integration)
{
    struct integration *one = integration;

    if (!one) return;
    if (one->memory) one->call.free_all(&one->memory);
    if (one->solver) one->call.free_solver(one->solver);
    if (one->matrix) one->call.free_matrix(one->matrix);
    if (one->allowed) one->call.free_vector(one->allowed);
    if (one->y) one->call.free_vector(one->y);
    if (one->context) one->call.free_context(&one->context);
    free(one);
}

/* Begins at a time. `y` and `allowed`, the absolute errors, must stay where they are until the end.
   NULL: there is no library or no room. */
void *psalm_cvode_open(int n, rates_t *rates, void *user, double time, double *y, double relative, double *allowed)
{
    struct integration *one = calloc(1, sizeof *one);
    const struct library *call;
    int bad;

    if (!one) return NULL;
    call = &one->call;
    one->n = n;
    one->rates = rates;
    one->user = user;
    bad = !find_library(&one->call);
    if (!bad) bad = call->context_of_7 ? call->context_of_7(0, &one->context) : call->context(NULL, &one->context);
    if (!bad && call->no_handlers) bad = call->no_handlers(one->context);
    if (!bad) {
        one->y = call->vector(n, y, one->context);
        one->allowed = call->vector(n, allowed, one->context);
        one->matrix = call->matrix(n, n, one->context);
        one->memory = call->create(bdf, one->context);
        bad = !one->y || !one->allowed || !one->matrix || !one->memory;
    }
    if (!bad) {
        one->solver = call->solver(one->y, one->matrix, one->context);
        bad = !one->solver;
    }
    if (!bad && call->no_messages) bad = call->no_messages(one->memory, NULL);
    if (!bad) bad = call->begin(one->memory, rates_for_library, time, one->y);
    if (!bad) bad = call->tolerances(one->memory, relative, one->allowed);
    if (!bad) bad = call->user(one->memory, one);
    if (!bad) bad = call->steps(one->memory, many_steps);
    if (!bad) bad = call->set_solver(one->memory, one->solver, one->matrix);
    if (bad) {
        psalm_cvode_close(one);
        return NULL;
    }
    return one;
}

/* Begins anew from what is in `y`. 0: done. */
int psalm_cvode_restart(void *integration, double time)
{
    struct integration *one = integration;

    return one->call.again(one->memory, time, one->y);
}

/* One step, which does not go beyond `end`; `y` then has the state at `time`. Below 0: there is none. */
int psalm_cvode_step(void *integration, double end, double *time)
{
    struct integration *one = integration;
    int flag = one->call.stop_at(one->memory, end);

    if (flag == 0) flag = one->call.go_on(one->memory, end, one->y, time, one_step);
    return flag;
}

/* The state at a time within the last step. 0: done. */
int psalm_cvode_state(void *integration, double time, double *y)
{
    struct integration *one = integration;
    handle_t there = one->call.vector(one->n, y, one->context);
    int flag = -1;

    if (there) {
        flag = one->call.state(one->memory, time, 0, there);
        one->call.free_vector(there);
    }
    return flag;
}
