/* Preloaded by fuzz.py: a program that is loaded once and then runs as often as it is asked, each time in a child of its own.

   Before main it waits for requests, one byte each on descriptor 198. A child runs the program with the arguments given, in the
   working directory, with standard output and standard error in the files .listing and .errors; the answer on descriptor 199 is its
   status as waitpid has it, or -1 if the time limit ended it: FORK_SERVER_SECONDS of processor time, ten times as many by the clock.
   Loading takes ten times as long as a fork. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

enum { requests = 198, answers = 199, mode = 0600, clock_factor = 10 };

typedef int main_t(int, char **, char **);

static main_t *program;
static volatile pid_t child;
static volatile sig_atomic_t late;

static void end_child(int number)
{
    (void)number;
    late = 1;
    if (child > 0) kill(child, SIGKILL);
}

static void send_to(int descriptor, const char *name)
{
    const int file = open(name, O_WRONLY | O_CREAT | O_TRUNC, mode);

    if (file < 0 || dup2(file, descriptor) < 0) _exit(125);
    close(file);
}

static int serve(int count, char **arguments, char **environment)
{
    const char *words = getenv("FORK_SERVER_SECONDS");
    const long limit = words ? atol(words) : 30;
    const struct itimerval none = {{0, 0}, {0, 0}}, most = {{0, 0}, {clock_factor * limit, 0}};
    const struct rlimit processor = {(rlim_t)limit, (rlim_t)limit + 1};
    char byte;
    int status;

    unsetenv("LD_PRELOAD");
    while (read(requests, &byte, 1) == 1) {
        late = 0;
        child = fork();
        if (child < 0) return 125;
        if (child == 0) {
            close(requests);
            close(answers);
            setrlimit(RLIMIT_CPU, &processor);
            send_to(STDOUT_FILENO, ".listing");
            send_to(STDERR_FILENO, ".errors");
            return program(count, arguments, environment);
        }
        signal(SIGALRM, end_child);
        setitimer(ITIMER_REAL, &most, NULL);
        while (waitpid(child, &status, 0) < 0) { }
        setitimer(ITIMER_REAL, &none, NULL);
        child = 0;
        if (late || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU)) status = -1;
        if (write(answers, &status, sizeof status) != sizeof status) return 125;
    }
    _exit(0);
}

int __libc_start_main(main_t *begin, int count, char **arguments, void (*init)(void), void (*fini)(void), void (*rtld_fini)(void),
                      void *stack_end)
{
    int (*real)(main_t *, int, char **, void (*)(void), void (*)(void), void (*)(void), void *);

    *(void **)&real = dlsym(RTLD_NEXT, "__libc_start_main");
    program = begin;
    return real(serve, count, arguments, init, fini, rtld_fini, stack_end);
}
