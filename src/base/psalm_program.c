/* What a program does first, and an environment that its run-time libraries understand. For programs only: psalm_begin alone
   brings this file in, and scripts/build_library leaves it out. */
#define _XOPEN_SOURCE 700
#include <limits.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

enum { exit_file_error = 3 };                /* as in psalm_status.f90 */
enum { most_threads = 65536, least_stack_kb = 64, most_stack_digits = 9 }; /* of OpenMP's variables */

__attribute__((visibility("hidden"))) extern volatile sig_atomic_t psalm_ended; /* psalm_border.c */

void psalm_begin(void);
void psalm_set_aside(char *text, size_t room);
void _gfortran_os_error_at(const char *where, const char *message, ...);

/* ---- environment ---- */

static char set_aside[256];               /* names of variables that are not understood, separated by blanks */

static int is_word_of(const char *value, const char *words)
{
    const size_t length = strlen(value);
    const char *at = words;

    for (;;) {
        const size_t next = strcspn(at, " ");
        if (next == length && length > 0 && strncasecmp(at, value, length) == 0) return 1;
        if (!at[next]) return 0;
        at += next + 1;
    }
}

/* Positive integers, separated by commas. */
static int are_counts(const char *value)
{
    for (;;) {
        char *end;
        long number;
        if (*value < '0' || *value > '9') return 0;
        number = strtol(value, &end, 10);
        if (number < 1 || number > most_threads) return 0;
        if (!*end) return 1;
        if (*end != ',') return 0;
        value = end + 1;
    }
}

/* A size in kB unless B, K, M or G follows. */
static int is_stack(const char *value)
{
    const size_t digits = strspn(value, "0123456789");
    const char *unit = value + digits;
    unsigned long long kb;

    if (digits == 0 || digits > most_stack_digits) return 0;
    kb = strtoull(value, NULL, 10);
    if (*unit && (!strchr("BbKkMmGg", *unit) || unit[1])) return 0;
    if (*unit == 'B' || *unit == 'b') kb /= 1024;
    if (*unit == 'M' || *unit == 'm') kb *= 1024;
    if (*unit == 'G' || *unit == 'g') kb *= 1024 * 1024;
    return kb >= least_stack_kb;
}

/* Whether libgomp takes a variable without a word. Those that are not here say nothing to these programs. */
static int is_understood(const char *name, size_t length, const char *value)
{
#define IS(text) (length == sizeof(text) - 1 && strncmp(name, text, length) == 0)
    if (IS("OMP_NUM_THREADS") || IS("OMP_THREAD_LIMIT")) return are_counts(value);
    if (IS("OMP_STACKSIZE")) return is_stack(value);
    if (IS("OMP_DYNAMIC") || IS("OMP_NESTED") || IS("OMP_CANCELLATION")) return is_word_of(value, "true false");
    if (IS("OMP_DISPLAY_ENV")) return is_word_of(value, "true false verbose");
    if (IS("OMP_WAIT_POLICY")) return is_word_of(value, "active passive");
    if (IS("OMP_PROC_BIND")) return is_word_of(value, "true false master primary close spread");
    if (IS("OMP_PLACES")) return is_word_of(value, "threads cores sockets ll_caches numa_domains");
    return 0;
#undef IS
}

/* Runs before libgomp and libgfortran read the environment, which they do before main, with words of their own on what they do not
   understand (OMP_NUM_THREADS=abc), or an internal error (GFORTRAN_STDIN_UNIT=6): takes such variables out. glibc does this for
   programs only; elsewhere the libraries have their say. Nothing is set up yet, not even the checks of a sanitizer. */
__attribute__((no_sanitize("address", "undefined", "thread")))
static void clear_environment(int count, char **arguments, char **environment)
{
    char **to = environment;

    (void)count;
    (void)arguments;
    for (; environment && *environment; environment++) {
        const char *name = *environment;
        const char *equal = strchr(name, '=');
        const size_t length = equal ? (size_t)(equal - name) : strlen(name);
        const int of_openmp = strncmp(name, "OMP_", 4) == 0 || strncmp(name, "GOMP_", 5) == 0;

        /* the units of the run-time library are not used */
        if (strncmp(name, "GFORTRAN_", 9) == 0) continue;
        if (of_openmp && !(equal && is_understood(name, length, equal + 1))) {
            const size_t used = strlen(set_aside);
            if (used + length + 2 < sizeof set_aside) {
                if (used > 0) set_aside[used] = ' ';
                memcpy(set_aside + used + (used > 0), name, length);
            }
            continue;
        }
        *to++ = *environment;
    }
    if (to) *to = NULL;
}

__attribute__((section(".preinit_array"), used))
static void (*const clear_first)(int, char **, char **) = clear_environment;

/* Names of the variables that were taken out because they were not understood; empty if none was. */
void psalm_set_aside(char *text, size_t room)
{
    const size_t length = strlen(set_aside);

    if (room == 0) return;
    memcpy(text, set_aside, length < room ? length + 1 : room);
    text[room - 1] = 0;
}

/* ---- beginning ---- */

static void tell_and_leave(const char *words, size_t count)
{
    if (write(STDERR_FILENO, words, count) < 0) _exit(exit_file_error);
    _exit(exit_file_error);
}

/* The run-time libraries of Fortran and OpenMP leave with a status of their own when there is no memory or no thread. */
static void leave_in_good_order(void)
{
    static const char words[] = "error: the run-time library ended the run (its words stand above), most likely for want of "
                                "memory or threads; the case is not done\n";
    if (!psalm_ended) tell_and_leave(words, sizeof words - 1);
}

/* What gfortran's code calls when memory cannot be had: our words in place of those of its library, with a file and a line of the
   source. Weak: where that library is linked statically its own is taken. */
__attribute__((weak)) void _gfortran_os_error_at(const char *where, const char *message, ...)
{
    static const char words[] = "error: not enough memory; the case is not done\n";

    (void)where;
    (void)message;
    tell_and_leave(words, sizeof words - 1);
}

/* First of all: a write that goes too far or into a closed pipe fails instead of killing. */
void psalm_begin(void)
{
    signal(SIGXFSZ, SIG_IGN);
    signal(SIGPIPE, SIG_IGN);
    atexit(leave_in_good_order);
}
