/* PSALM for C: analysis and synthesis of planar linkages.
 *
 * A psalm_case is one linkage and what is asked of it, in the notation of doc/reference/input_file.md. It is read from a file or from text, or
 * made loop by loop; it is studied; results are copied out as arrays of double. Nothing is printed, no file is written, no signal is
 * touched, nothing ends the program. What is wrong with a case comes back as findings, each with its line and a text.
 *
 * Lengths are in one unit of the user's choice, angles in degrees, rates of angles in radians. Loops, arcs, cases and findings are
 * counted from 1. Different cases may be used by different threads at the same time, one case by one thread only (but for psalm_cancel
 * and psalm_progress).
 *
 * Threads and fork: after a study by two or more threads a forked child must not start such a study again - the threads of OpenMP do
 * not live on in the child, and it would wait for them for ever. One thread works there; so does a child that calls exec.
 *
 * Link with -lpsalm (scripts/build_library makes build/lib/libpsalm.so). */
#ifndef PSALM_H
#define PSALM_H

#ifdef __cplusplus
extern "C" {
#endif

typedef struct psalm_case psalm_case;

/* Status of a call; the first four are the exit status of the programs. */
enum {
  PSALM_DONE = 0,
  PSALM_VIOLATION = 1,      /* done, but the linkage violates closure or a limit, or a search stopped early */
  PSALM_BAD_INPUT = 2,      /* the case has errors: see the findings; there are no results */
  PSALM_FILE_TROUBLE = 3,   /* a file could not be read, or there was not enough memory */
  PSALM_MISUSE = 4          /* the call is wrong: NULL, a wrong size, no such result; with a case a finding says what */
};

/* Levels of findings. */
enum { PSALM_WARNING = 1, PSALM_ERROR = 2 };

/* What psalm_values copies, and how many values it has. Arrays over positions and components go position by position. */
enum {
  PSALM_INPUT = 1,          /* positions: input, degrees or length */
  PSALM_CLOSED = 2,         /* positions: 1 if every loop that matters closes, else 0 */
  PSALM_ACTUAL = 3,         /* positions x components: output; NaN where the linkage does not close */
  PSALM_DEVIATION = 4,      /* positions x components: desired minus actual */
  PSALM_OBJECTIVE = 5,      /* 1: weighted sum of the squared deviations */
  PSALM_VELOCITY = 6,       /* positions x components, by time, after psalm_rates; NaN at a dead point */
  PSALM_ACCELERATION = 7,
  PSALM_JERK = 8,
  PSALM_RATE = 9,           /* the same by the input: per radian, or per length of a sliding input */
  PSALM_RATE2 = 10,
  PSALM_RATE3 = 11,
  PSALM_WORST_CASE = 12,    /* positions x components, after psalm_tolerances: largest deviation */
  PSALM_RSS = 13            /* root-sum-square deviation */
};

const char *psalm_version(void);
const char *psalm_status_text(int status);

/* Making and freeing a case. *made is NULL after PSALM_MISUSE; else it is a case, even with errors, and must be freed. */
int psalm_read_file(const char *file, int number, psalm_case **made);   /* the case of that number of a file */
int psalm_read_text(const char *text, int number, psalm_case **made);   /* the same of a text, lines ended by \n */
int psalm_new(const char *title, psalm_case **made);                    /* to be filled by psalm_add_loop and psalm_set_... */
void psalm_free(psalm_case *c);                                         /* NULL is allowed */

/* Filling a case of psalm_new. length and angle may be NULL: zeros. What is wrong with names (letters and digits, 31 at most), with
 * numbers (finite) and words (no control characters; apostrophes are allowed) is PSALM_BAD_INPUT at once, with findings, and the case
 * stays as it was; other errors show when the case is studied. */
int psalm_add_loop(psalm_case *c, int arcs, const int *ilink, const int *iloop, const double *length, const double *angle);
int psalm_set_integers(psalm_case *c, const char *group, const char *item, int count, const int *values);
int psalm_set_reals(psalm_case *c, const char *group, const char *item, int count, const double *values);
int psalm_set_word(psalm_case *c, const char *group, const char *item, const char *word);

/* Dimensions of any case. */
int psalm_set_length(psalm_case *c, int loop, int arc, double length);
int psalm_set_angle(psalm_case *c, int loop, int arc, double angle);
int psalm_get_length(const psalm_case *c, int loop, int arc, double *length);
int psalm_get_angle(const psalm_case *c, int loop, int arc, double *angle);

/* Studies. Each replaces the findings of the one before. threads 0: THREADS of the case, or 1; at most 1024. */
int psalm_analyse(psalm_case *c);
int psalm_rates(psalm_case *c);
int psalm_tolerances(psalm_case *c, int threads);
int psalm_synthesise(psalm_case *c, int threads);
int psalm_found(psalm_case *c, int rank, psalm_case **made);            /* the linkage that a search found, best first */

/* While psalm_synthesise or psalm_tolerances works on the case, another thread, or a signal handler, may end it and ask how far it is.
 * psalm_cancel ends the study that is running, mostly within milliseconds: it returns PSALM_VIOLATION, and what it found so far is there.
 * Called before the study begins it has no effect. psalm_progress gives starts or iterations made, how many there will be at most, and
 * the best objective so far; each pointer may be NULL. *made is 0 before the first. Free the case only after the study has returned. */
int psalm_cancel(psalm_case *c);
int psalm_progress(const psalm_case *c, int *made, int *most, double *best);

/* Results of the studies made last. */
int psalm_positions(const psalm_case *c);      /* 0 before a study */
int psalm_components(const psalm_case *c);     /* of the output: 1, 2 (a point) or 3 (a pose) */
int psalm_values(psalm_case *c, int what, int count, double *values);   /* count must be the number of values */
const char *psalm_listing(const psalm_case *c);                         /* of psalm or kalm; valid until the next study */

/* Findings. Texts are valid until the next call with this case that returns a status. */
int psalm_findings(const psalm_case *c);
int psalm_finding_level(const psalm_case *c, int number);
int psalm_finding_line(const psalm_case *c, int number);                /* 0: none */
const char *psalm_finding_text(const psalm_case *c, int number);        /* with its place; NULL if there is none of that number */

#ifdef __cplusplus
}
#endif

#endif
