/* What the operating system is asked for and Fortran cannot ask: layouts and constants that differ between systems stay here.

   Functions that can fail give 0 or an error number of the C library, which psalm_error_text puts into words. */
#define _XOPEN_SOURCE 700
#define _DEFAULT_SOURCE /* flock */
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { kind_none, kind_file, kind_directory, kind_link, kind_other, kind_unknown }; /* as in psalm_system.f90 */
enum { new_file_mode = 0666, new_directory_mode = 0777, permissions = 0777 }; /* cut by the user's mask */
enum { most_names = 10000 };              /* names tried for a temporary */
enum { most_waits = 1000, wait_ns = 10000000 }; /* for a lock: ten seconds */

/* ---- end of a program; its beginning is in psalm_program.c ---- */

__attribute__((visibility("hidden"))) extern volatile sig_atomic_t psalm_ended;
volatile sig_atomic_t psalm_ended;        /* set: the exit status is the program's own, not that of a run-time library */

/* Last of all. */
void psalm_finish(int status)
{
    psalm_ended = 1;
    exit(status);
}

void psalm_error_text(int error, char *text, size_t room)
{
    if (strerror_r(error, text, room) != 0 && room > 0) text[0] = 0;
}

/* ---- signals ---- */

/* Lets signals wait, all but those that tell of a fault of the program. `before`: room for the mask of before. */
int psalm_hold_signals(void *before, size_t room)
{
    static const int faults[] = {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT, SIGTRAP, SIGSYS};
    sigset_t wanted, old;
    size_t i;

    if (room < sizeof old) return EINVAL;
    sigfillset(&wanted);
    for (i = 0; i < sizeof faults / sizeof faults[0]; i++) sigdelset(&wanted, faults[i]);
    i = (size_t)pthread_sigmask(SIG_BLOCK, &wanted, &old);
    memcpy(before, &old, sizeof old);
    return (int)i;
}

int psalm_restore_signals(const void *before)
{
    sigset_t old;

    memcpy(&old, before, sizeof old);
    return pthread_sigmask(SIG_SETMASK, &old, NULL);
}

/* ---- files ---- */

static void put_identity(const struct stat *s, int64_t identity[2])
{
    identity[0] = (int64_t)s->st_dev;
    identity[1] = (int64_t)s->st_ino;
}

/* What stands at a path itself, links not followed. `writable`: not marked read-only, and we may write (root may always). */
int psalm_look_at(const char *path, int64_t identity[2], int *writable)
{
    struct stat s;

    *writable = 1;
    identity[0] = identity[1] = 0;
    if (lstat(path, &s) != 0) return errno == ENOENT ? kind_none : kind_unknown;
    put_identity(&s, identity);
    if (S_ISLNK(s.st_mode)) return kind_link;
    if (S_ISDIR(s.st_mode)) return kind_directory;
    if (!S_ISREG(s.st_mode)) return kind_other;
    *writable = (s.st_mode & S_IWUSR) != 0 && access(path, W_OK) == 0;
    return kind_file;
}

/* Identity of the file or directory that a path leads to, links followed. */
int psalm_identity_of(const char *path, int64_t identity[2])
{
    struct stat s;

    if (stat(path, &s) != 0) return errno;
    put_identity(&s, identity);
    return 0;
}

/* Identity of the file that a descriptor is open on; pipes and terminals have none. */
int psalm_identity_of_open(int descriptor, int64_t identity[2])
{
    struct stat s;

    if (fstat(descriptor, &s) != 0) return errno;
    if (!S_ISREG(s.st_mode)) return ENOENT;
    put_identity(&s, identity);
    return 0;
}

enum { input_valid, input_unreadable, input_directory, input_too_large, input_has_zero }; /* as in psalm_system.f90 */
enum { first_room = 65536 };              /* bytes */

/* Reads a whole file, or standard input where `path` is "-", into memory that psalm_take_input frees. Stops at the first zero
   byte, which no text has, and beyond `most` bytes: devices and pipes may have no end. Gives the verdict, and an error number with
   input_unreadable. */
int psalm_read_input(const char *path, int64_t most, char **bytes, int64_t *count, int *error)
{
    const int standard = strcmp(path, "-") == 0;
    const int file = standard ? STDIN_FILENO : open(path, O_RDONLY | O_CLOEXEC);
    struct stat s;
    size_t room = first_room, have = 0;
    int verdict = input_valid;

    *bytes = NULL;
    *count = *error = 0;
    if (file < 0 || fstat(file, &s) != 0) {
        *error = errno;
        if (file >= 0 && !standard) close(file);
        return input_unreadable;
    }
    if (S_ISDIR(s.st_mode)) verdict = input_directory;
    if (S_ISREG(s.st_mode) && s.st_size > most) verdict = input_too_large;
    if (S_ISREG(s.st_mode) && (int64_t)s.st_size < most) room = (size_t)s.st_size + 1;
    while (verdict == input_valid) {
        ssize_t got;
        if (!*bytes || have == room) {
            char *larger = realloc(*bytes, *bytes ? (room *= 2) : room);
            if (!larger) {
                *error = ENOMEM;
                verdict = input_unreadable;
                break;
            }
            *bytes = larger;
        }
        got = read(file, *bytes + have, room - have);
        if (got < 0 && errno == EINTR) continue;
        if (got < 0) {
            *error = errno;
            verdict = input_unreadable;
        }
        if (got <= 0) break;
        if (memchr(*bytes + have, 0, (size_t)got)) verdict = input_has_zero;
        have += (size_t)got;
        if (verdict == input_valid && have > (uint64_t)most) verdict = input_too_large;
    }
    if (!standard) close(file);
    *count = (int64_t)have;
    return verdict;
}

/* Copies what psalm_read_input has read, if `text` is there, and frees it. */
void psalm_take_input(char *bytes, char *text, size_t count)
{
    if (text && bytes && count > 0) memcpy(text, bytes, count);
    free(bytes);
}

/* Next name of our own in the directory of `path`: process id and a counter. Short, so that no name is too long for it. */
static int next_name(const char *path, char *name, size_t room)
{
    static unsigned counter;
    const char *slash = strrchr(path, '/');
    const int directory = slash ? (int)(slash - path + 1) : 0;
    const int length = snprintf(name, room, "%.*spsalm-%ld-%u.part", directory, path, (long)getpid(), ++counter);

    return length > 0 && (size_t)length < room ? 0 : ENAMETOOLONG;
}

static int write_all(int file, const char *bytes, size_t count)
{
    while (count > 0) {
        const ssize_t written = write(file, bytes, count);
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) return errno;
        bytes += written;
        count -= (size_t)written;
    }
    return 0;
}

/* File systems that cannot synchronize say EINVAL; there is nothing more to be had from them. */
static int synchronize(int file)
{
    return fsync(file) == 0 || errno == EINVAL || errno == EROFS || errno == ENOTSUP ? 0 : errno;
}

/* Removes the temporaries that killed runs have left in a directory. */
static void clear_directory(const char *directory)
{
    DIR *list = opendir(directory);
    struct dirent *entry;
    unsigned long long number;
    unsigned count;
    int end;

    if (!list) return;
    while ((entry = readdir(list))) {
        end = 0;
        if (sscanf(entry->d_name, "psalm-%llu-%u.part%n", &number, &count, &end) == 2 && end > 0 && !entry->d_name[end])
            unlinkat(dirfd(list), entry->d_name, 0);
    }
    closedir(list);
}

/* Keeps other runs from writing in a directory: whoever has the lock may take every temporary there for a forgotten one. Gives a
   descriptor to let go, or -1 if there is no lock to be had; then nothing is removed. The lock ends with the process. */
int psalm_lock_directory(const char *directory)
{
    const struct timespec pause = {0, wait_ns};
    const int file = open(directory, O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    int waits;

    if (file < 0) return -1;
    for (waits = 0; flock(file, LOCK_EX | LOCK_NB) != 0; waits++) {
        if ((errno != EWOULDBLOCK && errno != EINTR) || waits == most_waits) {
            close(file);
            return -1;
        }
        nanosleep(&pause, NULL);
    }
    clear_directory(directory);
    return file;
}

/* Keeps what stands at a path from being given up when another file takes its name: that costs milliseconds, which are better spent
   after all names are changed. Gives a descriptor to let go, or -1. */
int psalm_keep(const char *path)
{
    return open(path, O_RDONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
}

/* Lets go of a lock or of a file that was kept. */
void psalm_let_go(int file)
{
    if (file >= 0) close(file);
}

/* Writes bytes to a new file in the directory of `path`, with the owner and mode of the file that stands at `path` now. `name` gets
   its name. On failure nothing is left. */
int psalm_stage(const char *path, const char *bytes, size_t count, char *name, size_t room)
{
    struct stat old;
    int file = -1, error, tries;

    for (tries = 0; file < 0; tries++) {
        if ((error = next_name(path, name, room)) != 0) return error;
        file = open(name, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, new_file_mode);
        if (file < 0 && (errno != EEXIST || tries == most_names)) return errno;
    }
    error = 0;
    if (lstat(path, &old) == 0 && S_ISREG(old.st_mode)) {
        /* only root can keep another owner; a mode meant for another group must not open the file to ours */
        const int kept = fchown(file, old.st_uid, old.st_gid) == 0 || fchown(file, (uid_t)-1, old.st_gid) == 0;
        if (fchmod(file, old.st_mode & (kept ? permissions : permissions & ~(mode_t)S_IRWXG)) != 0) error = errno;
    }
    if (error == 0) error = write_all(file, bytes, count);
    if (close(file) != 0 && error == 0) error = errno;
    if (error != 0) unlink(name);
    return error;
}

int psalm_make_directory(const char *path)
{
    struct stat s;

    if (mkdir(path, new_directory_mode) == 0) return 0;
    if (errno == EEXIST && stat(path, &s) == 0) return S_ISDIR(s.st_mode) ? 0 : ENOTDIR;
    return errno;
}

/* Brings a file or directory to the disk. */
int psalm_synchronize(const char *path)
{
    int file = open(path, O_RDONLY | O_CLOEXEC);
    int error;

    if (file < 0) file = open(path, O_WRONLY | O_CLOEXEC);
    if (file < 0) return errno;
    error = synchronize(file);
    close(file);
    return error;
}

int psalm_rename(const char *from, const char *to)
{
    return rename(from, to) == 0 ? 0 : errno;
}

/* Removes a file or an empty directory. */
int psalm_remove(const char *path)
{
    return remove(path) == 0 ? 0 : errno;
}

/* Writes to an open descriptor. */
int psalm_write(int descriptor, const char *bytes, size_t count)
{
    return write_all(descriptor, bytes, count);
}

/* ---- memory and threads ---- */

/* 1 if so many bytes could be had in one piece; they are given back untouched. */
int psalm_memory_to_be_had(int64_t bytes)
{
    void *volatile probe;

    if (bytes <= 0) return 1;
    if ((uint64_t)bytes > SIZE_MAX / 2) return 0;
    probe = malloc((size_t)bytes);
    if (!probe) return 0;
    free(probe);
    return 1;
}

static pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;

static void *wait_at_gate(void *unused)
{
    pthread_mutex_lock(&gate);
    pthread_mutex_unlock(&gate);
    return unused;
}

/* Stack that OpenMP gives its threads: OMP_STACKSIZE, a number with B, K (when none is given), M or G; 0: that of the system. */
static size_t openmp_stack(void)
{
    const char *words = getenv("OMP_STACKSIZE");
    char *end;
    unsigned long long number;
    int shift = 10;

    if (!words) return 0;
    number = strtoull(words, &end, 10);
    if (end == words) return 0;
    while (*end == ' ') end++;
    if (*end == 'b' || *end == 'B') shift = 0;
    if (*end == 'm' || *end == 'M') shift = 20;
    if (*end == 'g' || *end == 'G') shift = 30;
    return number > (SIZE_MAX >> shift) ? SIZE_MAX : (size_t)number << shift;
}

/* How many threads, this one among them, can live at once, at most `wanted`: they are made and ended again. */
int psalm_threads_to_be_had(int wanted)
{
    pthread_t *threads;
    pthread_attr_t attributes;
    const size_t stack = openmp_stack();
    int made = 0, i;

    if (wanted < 2) return 1;
    threads = malloc((size_t)wanted * sizeof *threads);
    if (!threads) return 1;
    if (pthread_attr_init(&attributes) != 0) {
        free(threads);
        return 1;
    }
    if (stack > 0) pthread_attr_setstacksize(&attributes, stack);
    pthread_mutex_lock(&gate);
    while (made < wanted - 1 && pthread_create(&threads[made], &attributes, wait_at_gate, NULL) == 0) made++;
    pthread_mutex_unlock(&gate);
    for (i = 0; i < made; i++) pthread_join(threads[i], NULL);
    pthread_attr_destroy(&attributes);
    free(threads);
    return made + 1;
}

/* ---- marks ---- */

/* Goes on with the 64-bit hash FNV-1a (Fowler, Noll, Vo: http://www.isthe.com/chongo/tech/comp/fnv). */
int64_t psalm_hash(int64_t state, const char *bytes, size_t count)
{
    const uint64_t prime = UINT64_C(1099511628211);
    uint64_t hash = (uint64_t)state;
    size_t i;

    for (i = 0; i < count; i++) hash = (hash ^ (unsigned char)bytes[i]) * prime;
    return (int64_t)hash;
}
