/* The commit that a build was made from: `stamp` of scripts/setup writes it where the compiler finds it, and has this file compiled anew
   when it changes. Nothing else is, for nothing else knows. */
#include <string.h>

#ifdef __has_include
#if __has_include(<psalm_stamp.h>)
#include <psalm_stamp.h>
#endif
#endif
#ifndef PSALM_COMMIT
#define PSALM_COMMIT "" /* built without scripts/setup */
#endif

void psalm_commit(char *text, size_t room);

void psalm_commit(char *text, size_t room)
{
    if (room == 0) return;
    strncpy(text, PSALM_COMMIT, room);
    text[room - 1] = 0;
}
