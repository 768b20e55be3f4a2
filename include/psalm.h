/* PSALM for C and C++: every study of the suite on a planar linkage.
 *
 * A psalm_case is one linkage and what is asked of it, in the notation of doc/reference/input_file.md. It is read from a file or from text, or made
 * in memory: joints and links of a sketch, loops, any item of the manual. psalm_study studies it; what comes of a study is a
 * psalm_result: tables of named columns, the listing, pictures, the linkages found as cases for the next study. Nothing is printed,
 * no file is written, no signal is touched, nothing ends the program. What is wrong with a case comes back as findings, each with its
 * line and a text.
 *
 * Lengths are in one unit of the user's choice, angles in degrees, rates of angles in radians. Whatever is counted is counted from 1.
 * There is no global state: different cases and results may be used by different threads at the same time, one case or result by one
 * thread only (but for psalm_cancel and psalm_progress).
 *
 * Threads and fork: after a study by two or more threads a forked child must not start such a study again - the threads of OpenMP do
 * not live on in the child, and it would wait for them for ever. One thread works there; so does a child that calls exec.
 *
 * Link with -lpsalm, or as pkg-config --cflags --libs psalm says. doc/guide/library.md has examples. */
#ifndef PSALM_H
#define PSALM_H

/* Version of this header; psalm_library_version() is that of the library. */
#define PSALM_VERSION_MAJOR 1
#define PSALM_VERSION_MINOR 0
#define PSALM_VERSION_PATCH 0
#define PSALM_VERSION "1.0.0"

/* Number of the interface, and of the soname. It grows when a call is changed or left out, not when one is added; a program may check
 * that psalm_interface() == PSALM_INTERFACE. */
#define PSALM_INTERFACE 1

#ifdef __cplusplus
extern "C" {
#endif

typedef struct psalm_case psalm_case;
typedef struct psalm_result psalm_result;

/* Status of a call; the first four are the exit status of the programs. */
enum {
  PSALM_DONE = 0,
  PSALM_VIOLATION = 1,      /* done, but the linkage violates closure or a limit, or a search stopped early */
  PSALM_BAD_INPUT = 2,      /* the case has errors: see the findings; there are no results */
  PSALM_FILE_TROUBLE = 3,   /* a file could not be read, or there was not enough memory */
  PSALM_MISUSE = 4          /* the call is wrong: NULL, a wrong size, no such table; with a case a finding says what */
};

/* Levels of findings. A remark is about a result. */
enum { PSALM_WARNING = 1, PSALM_ERROR = 2, PSALM_REMARK = 3 };

/* Options of psalm_study. */
enum { PSALM_BRIEF = 1 };   /* analysis, rates, forces: the tables alone, no listing, which takes longer than the study */

/* Kinds of columns. */
enum { PSALM_REAL = 0, PSALM_WHOLE = 1, PSALM_FLAG = 2, PSALM_WORD = 3 };

const char *psalm_library_version(void);
int psalm_interface(void);
const char *psalm_status_text(int status);

/* Making and freeing a case. *made is NULL after PSALM_MISUSE; else it is a case, even with errors, and must be freed. */
int psalm_read_file(const char *file, int number, psalm_case **made);   /* the case of that number of a file */
int psalm_read_text(const char *text, int number, psalm_case **made);   /* the same of a text, lines ended by \n */
int psalm_new(const char *title, psalm_case **made);                    /* to be filled */
int psalm_copy(const psalm_case *c, psalm_case **made);                 /* the same once more */
void psalm_free(psalm_case *c);                                         /* NULL is allowed */

/* The case in the notation of the manual, complete, and its title; valid until the next call with this case. Empty for a case with
 * errors. */
const char *psalm_case_text(psalm_case *c);
const char *psalm_case_title(psalm_case *c);

/* Filling a case of psalm_new. What is wrong with the call itself - names, numbers that are not finite, words with control
 * characters - is PSALM_BAD_INPUT at once, with findings, and the case stays as it was; what is wrong with the linkage shows when the
 * case is studied.
 *
 * A sketch: joints where they are drawn (again with the same name: moved), links by the names of their joints with blanks between
 * them, slides, gears, drives, outputs, what a search may vary; the words are those of &CHAIN, &DRIVES and &OUTPUTS. Joints with
 * fixed != 0 are on the frame; without any the first link is the frame. A name that is NULL is formed from the others. */
int psalm_add_joint(psalm_case *c, const char *name, double x, double y, int fixed);
int psalm_add_link(psalm_case *c, const char *joints, const char *name);
int psalm_add_slide(psalm_case *c, const char *link, const char *along, double x, double y, double angle, const char *name);
int psalm_add_gear(psalm_case *c, const char *first, const char *second, const char *carrier, double teeth_first, double teeth_second);
int psalm_add_drive(psalm_case *c, const char *what, const char *base, const char *link);    /* base, link: NULL for the other link there */
int psalm_add_output(psalm_case *c, const char *what, const char *name);
int psalm_vary(psalm_case *c, const char *what);

/* Loops: length and angle may be NULL, zeros. */
int psalm_add_loop(psalm_case *c, int arcs, const int *ilink, const int *iloop, const double *length, const double *angle);
int psalm_vary_arc(psalm_case *c, int loop, int arc, int length, int angle);                 /* length, angle: 0 or 1 */

/* Any item of any group, of any case: one that was read or found is opened for it. */
int psalm_set_integers(psalm_case *c, const char *group, const char *item, int count, const int *values);
int psalm_set_reals(psalm_case *c, const char *group, const char *item, int count, const double *values);
int psalm_set_word(psalm_case *c, const char *group, const char *item, const char *word);
int psalm_set_words(psalm_case *c, const char *group, const char *item, int count, const char *const *words);

/* Loops of any case and their dimensions; those of a sketch are traced by the library. */
int psalm_loop_count(const psalm_case *c);
int psalm_arc_count(const psalm_case *c, int loop);
int psalm_set_length(psalm_case *c, int loop, int arc, double length);
int psalm_set_angle(psalm_case *c, int loop, int arc, double angle);
int psalm_get_length(psalm_case *c, int loop, int arc, double *length);
int psalm_get_angle(psalm_case *c, int loop, int arc, double *angle);

/* Studies: psalm_verb(1), psalm_verb(2) ... are their names, NULL after the last. Each replaces the findings of the call before.
 * threads 0: THREADS of the case, or 1; at most 1024, and not negative. *made is NULL if the status is PSALM_BAD_INPUT, PSALM_FILE_TROUBLE or
 * PSALM_MISUSE; else it is a result of its own, which does not depend on the case any more and must be freed. */
const char *psalm_verb(int number);
int psalm_study(psalm_case *c, const char *verb, int options, int threads, psalm_result **made);
void psalm_result_free(psalm_result *r);                                /* NULL is allowed */

/* While a study works on the case, another thread, or a signal handler, may end it and ask how far it is. psalm_cancel ends every study
 * but the summary and the board, mostly within milliseconds: psalm_study then returns PSALM_VIOLATION. What there is so far
 * is the result: linkages of a search, springs, the sample, the rows of a sweep, of a motion in time or of vibration over speeds,
 * assemblies, and of motion from torque the forces and, if it was found, the steady cycle. Of analysis, rates, forces, a proof,
 * counterweights, a clearance and a picture there is nothing. Reading the case and writing the listing are not ended. Called before the study
 * begins it has no effect. psalm_progress gives starts, iterations, paths, turns or rows made, how many there will be at most, and the
 * best objective so far; each pointer may be NULL. *made is 0 before the first. Free the case only after the study has returned. */
int psalm_cancel(psalm_case *c);
int psalm_progress(psalm_case *c, int *made, int *most, double *best);

/* Tables of a result; the first is the one that the study is about: positions, of a search the linkages found. Names, units, words and lines are valid until the next call with this result. */
int psalm_table_count(const psalm_result *r);
const char *psalm_table_name(psalm_result *r, int table);
const char *psalm_table_about(psalm_result *r, int table);              /* what a row is */
int psalm_find_table(psalm_result *r, const char *name);                /* its number; 0: none */
int psalm_row_count(const psalm_result *r, int table);
int psalm_column_count(const psalm_result *r, int table);
const char *psalm_column_name(psalm_result *r, int table, int column);
const char *psalm_column_unit(psalm_result *r, int table, int column);
int psalm_column_kind(const psalm_result *r, int table, int column);    /* PSALM_REAL ...; -1: no such column */
int psalm_find_column(psalm_result *r, int table, const char *name);    /* its number; 0: none */
const char *psalm_columns(psalm_result *r, int table);                  /* of every column a line, ended by \n: kind, tab, unit, tab, name */
int psalm_column(const psalm_result *r, int table, int column, int count, double *values);   /* count: the rows; NaN: not known */
const char *psalm_word(psalm_result *r, int table, int column, int row);

/* The rest of a result, valid as long as it lives. */
const char *psalm_listing(const psalm_result *r);                       /* as the program prints it */
const char *psalm_found_text(const psalm_result *r);                      /* the linkages found, in the notation of the manual */
int psalm_case_count(const psalm_result *r);                                 /* how many there are */
int psalm_case_of(const psalm_result *r, int number, psalm_case **made); /* one of them, best first, as a case of its own */
int psalm_file_count(const psalm_result *r);                                 /* pictures and pages */
const char *psalm_file_ending(psalm_result *r, int number);             /* ".svg", ".dxf", ".html" ... */
const char *psalm_file_content(const psalm_result *r, int number);

/* Findings. Texts are valid until the next call with this case that returns a status. */
int psalm_findings(const psalm_case *c);
int psalm_finding_level(const psalm_case *c, int number);
int psalm_finding_line(const psalm_case *c, int number);                /* 0: none */
const char *psalm_finding_text(const psalm_case *c, int number);        /* with its place; NULL if there is none of that number */

#ifdef __cplusplus
}
#endif

#endif
