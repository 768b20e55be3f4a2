/* Calls of the C library that fail on demand, for tests of how programs bear it. Loaded before the C library (LD_PRELOAD).
   FAULT_AT: number of the call that fails, counted over all calls listed here whose file or descriptor belongs to a path that
   contains FAULT_PATH. FAULT_LOG: file that receives the name of the call that failed. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/types.h>
#include <unistd.h>

static int calls;

/* Is it the turn of this call? */
static int fails(const char *name)
{
    const char *at = getenv("FAULT_AT"), *log = getenv("FAULT_LOG");
    if (!at || ++calls != atoi(at)) return 0;
    if (log) {
        int (*real_open)(const char *, int, ...) = (int (*)(const char *, int, ...))dlsym(RTLD_NEXT, "open");
        ssize_t (*real_write)(int, const void *, size_t) = (ssize_t (*)(int, const void *, size_t))dlsym(RTLD_NEXT, "write");
        int file = real_open(log, O_WRONLY | O_CREAT | O_TRUNC, 0666);
        if (real_write(file, name, strlen(name)) < 0) abort();
    }
    errno = EIO;
    return 1;
}

static int concerns_path(const char *path)
{
    const char *part = getenv("FAULT_PATH");
    return part && path && strstr(path, part) != NULL;
}

static int concerns(int descriptor)
{
    char link[64], path[4096];
    ssize_t length;
    snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
    length = readlink(link, path, sizeof path - 1);
    if (length < 0) return 0;
    path[length] = 0;
    return concerns_path(path);
}

#define REAL(type, name, arguments) type (*real) arguments = (type (*) arguments)dlsym(RTLD_NEXT, #name)

FILE *fopen(const char *path, const char *mode)
{
    REAL(FILE *, fopen, (const char *, const char *));
    if (strchr(mode, 'w') && concerns_path(path) && fails("fopen")) return NULL;
    return real(path, mode);
}

int open(const char *path, int flags, ...)
{
    REAL(int, open, (const char *, int, ...));
    va_list more;
    mode_t mode;
    va_start(more, flags);
    mode = (flags & O_CREAT) ? va_arg(more, mode_t) : 0;
    va_end(more);
    if ((flags & O_CREAT) && concerns_path(path) && fails("open")) return -1;
    return real(path, flags, mode);
}

ssize_t write(int descriptor, const void *bytes, size_t count)
{
    REAL(ssize_t, write, (int, const void *, size_t));
    if (concerns(descriptor) && fails("write")) return -1;
    return real(descriptor, bytes, count);
}

size_t fwrite(const void *bytes, size_t size, size_t count, FILE *file)
{
    REAL(size_t, fwrite, (const void *, size_t, size_t, FILE *));
    if (concerns(fileno(file)) && fails("fwrite")) return 0;
    return real(bytes, size, count, file);
}

int fflush(FILE *file)
{
    REAL(int, fflush, (FILE *));
    if (file && concerns(fileno(file)) && fails("fflush")) return EOF;
    return real(file);
}

int fsync(int descriptor)
{
    REAL(int, fsync, (int));
    if (concerns(descriptor) && fails("fsync")) return -1;
    return real(descriptor);
}

/* The file is closed all the same, as the system does it. */
int fclose(FILE *file)
{
    REAL(int, fclose, (FILE *));
    int failed = concerns(fileno(file)) && fails("fclose");
    int result = real(file);
    return failed ? (errno = EIO, EOF) : result;
}

int close(int descriptor)
{
    REAL(int, close, (int));
    int failed = concerns(descriptor) && fails("close");
    int result = real(descriptor);
    return failed ? (errno = EIO, -1) : result;
}

int rename(const char *from, const char *to)
{
    REAL(int, rename, (const char *, const char *));
    if (concerns_path(to) && fails("rename")) return -1;
    return real(from, to);
}
