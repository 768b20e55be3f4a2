/* The C interface: results against closed forms, findings, and every kind of misuse.
   usage: test_psalm DATA_DIRECTORY [CALLS], of each cheap verb, for the memory. Last line: N passed, N failed. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <psalm.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/time.h>
#include <time.h>
#include <unistd.h>

static int passed, failed;

static void check(int right, const char *law) {
  if (right) {
    passed++;
  } else {
    failed++;
    printf("FAILED: %s\n", law);
  }
}

/* One of the findings holds the words. */
static int says(const psalm_case *c, const char *words) {
  for (int i = 1; i <= psalm_findings(c); i++)
    if (strstr(psalm_finding_text(c, i), words)) return 1;
  for (int i = 1; i <= psalm_findings(c); i++) printf("        %s\n", psalm_finding_text(c, i));
  return 0;
}

static const char slider[] =
  "OFFSET SLIDER-CRANK\n &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1,\n"
  "  ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0, NOUTLK=3, NOUTLP=1 &END\n &METHOD MOTION=3, IKIN=15 &END\n";

static psalm_case *from_text(const char *text) {
  psalm_case *c = NULL;
  psalm_read_text(text, 1, &c);
  return c;
}

/* Position, velocity and acceleration of the slide at 1 rad/s, by the theorem of Pythagoras. */
static void slide_at(double degrees, double of[3]) {
  const double r = 40, l = 140, e = 10;
  double a = degrees*acos(-1)/180, y = r*sin(a) - e, y1 = r*cos(a), y2 = -r*sin(a), root = sqrt(l*l - y*y);
  of[0] = r*cos(a) + root;
  of[1] = -r*sin(a) - y*y1/root;
  of[2] = -r*cos(a) - (y1*y1 + y*y2)/root - (y*y1)*(y*y1)/(root*root*root);
}

/* The column of a table, in an array of its rows; NULL if there is none. */
static double *column(psalm_result *r, const char *table, const char *name, int *rows) {
  int t = psalm_find_table(r, table), c = t ? psalm_find_column(r, t, name) : 0, n = psalm_row_count(r, t);
  double *values = c ? malloc((n > 0 ? n : 1)*sizeof *values) : NULL;
  if (values && psalm_column(r, t, c, n, values) != PSALM_DONE) {
    free(values);
    values = NULL;
  }
  if (rows) *rows = n;
  return values;
}

static double number(psalm_result *r, const char *table, const char *name) {
  double *values = column(r, table, name, NULL), first = values ? values[0] : NAN;
  free(values);
  return first;
}

/* psalm_columns tells what psalm_column_kind, psalm_column_unit and psalm_column_name tell, and no column more. */
static int lines_tell_columns(psalm_result *r, int table) {
  char *lines = strdup(psalm_columns(r, table)), *at = lines, line[200];
  int c = 1, same = 1;
  for (; same && c <= psalm_column_count(r, table); c++) {
    int n = snprintf(line, sizeof line, "%d\t%s\t", psalm_column_kind(r, table, c), psalm_column_unit(r, table, c));
    snprintf(line + n, sizeof line - n, "%s\n", psalm_column_name(r, table, c));
    same = !strncmp(at, line, strlen(line));
    at += strlen(line);
  }
  same = same && *at == 0 && c > 3;
  free(lines);
  return same;
}

static void analysis(void) {
  psalm_case *c = from_text(slider), *other_case = NULL;
  psalm_result *r = NULL, *again = NULL;
  double *input, *closed, *slide, worst = 0, other = 1;
  int rows = 0, t;
  check(c && psalm_findings(c) == 0, "a case from text has no findings");
  check(psalm_study(c, "analysis", 0, 0, &r) == PSALM_DONE && r, "analysis");
  check(psalm_table_count(r) >= 2 && !strcmp(psalm_table_name(r, 1), "positions"), "tables, that of the positions first");
  input = column(r, "positions", "input", &rows);
  closed = column(r, "positions", "closed", NULL);
  slide = column(r, "positions", "output", NULL);
  check(rows == 24 && input && closed && slide && input[1] == 15 && closed[7] == 1, "inputs and closed");
  check(number(r, "totals", "objective") == 0, "no desired values, no error");
  for (int i = 0; i < 24; i++) {
    double of[3];
    slide_at(input[i], of);
    worst = fmax(worst, fabs(of[0] - slide[i]));
  }
  check(worst < 1e-12*180, "the slide is that of a right triangle");
  t = psalm_find_table(r, "positions");
  check(!strcmp(psalm_column_unit(r, t, psalm_find_column(r, t, "input")), "deg"), "the unit of the input");
  check(psalm_column_kind(r, t, psalm_find_column(r, t, "closed")) == PSALM_FLAG && psalm_column_kind(r, t, 1000) == -1, "kinds of columns");
  check(!strncmp(psalm_columns(r, t), "0\tdeg\tinput\n", 12), "kind, unit and name of every column");
  check(lines_tell_columns(r, t), "as they are told one by one");
  check(strlen(psalm_table_about(r, t)) > 0 && strstr(psalm_listing(r), "179.6424") != NULL, "what a row is; the listing");
  check(psalm_study(c, "analysis", PSALM_BRIEF, 0, &again) == PSALM_DONE && !strlen(psalm_listing(again)), "a brief study has no listing");
  free(slide);
  slide = column(again, "positions", "output", NULL);
  check(slide && fabs(slide[0] - 179.6424) < 1e-4, "but its tables");
  psalm_result_free(again);
  check(psalm_copy(c, &other_case) == PSALM_DONE && other_case, "a copy");
  check(psalm_set_length(c, 1, 2, 100) == PSALM_DONE && psalm_get_length(c, 1, 2, &other) == PSALM_DONE && other == 100, "a length");
  check(psalm_set_angle(c, 1, 4, 90) == PSALM_DONE && psalm_get_angle(c, 1, 4, &other) == PSALM_DONE && other == 90, "an angle");
  psalm_set_angle(c, 1, 4, 270);
  psalm_free(other_case);
  check(psalm_loop_count(c) == 1 && psalm_arc_count(c, 1) == 4 && psalm_arc_count(c, 2) == 0, "loops and arcs");
  other_case = from_text(psalm_case_text(c));
  psalm_free(c);
  c = other_case;
  check(psalm_study(c, "analysis", 0, 0, &again) == PSALM_DONE, "the text of a changed case is a case");
  free(slide);
  slide = column(again, "positions", "output", NULL);
  check(slide && fabs(slide[0] - (40 + sqrt(100*100 - 10*10))) < 1e-12, "the changed dimensions count");
  check(input[1] == 15 && psalm_row_count(r, t) == 24, "a result lives on without its case");
  psalm_result_free(again);
  psalm_result_free(r);
  psalm_free(c);
  free(input);
  free(closed);
  free(slide);
}

static void made(void) {
  const int ilink[4] = {1, -2, 3, 4}, iloop[4] = {1, 0, -4, 1}, kind = 3, arc = 3, loop = 1, step = 15;
  const double length[4] = {40, 140, 0, 10}, angle[4] = {0, 0, 0, 270}, speed = 2;
  psalm_case *c = NULL;
  psalm_result *r = NULL;
  double *input, *v, *a, *rate, worst = 0, of[3];
  int rows;
  check(psalm_new("MADE IN MEMORY", &c) == PSALM_DONE && c, "a case made in memory");
  check(psalm_add_loop(c, 4, ilink, iloop, length, angle) == PSALM_DONE, "its loop");
  psalm_set_integers(c, "METHOD", "MOTION", 1, &kind);
  psalm_set_integers(c, "METHOD", "IKIN", 1, &step);
  psalm_set_integers(c, "LINKS", "NOUTLK", 1, &arc);
  psalm_set_integers(c, "LINKS", "NOUTLP", 1, &loop);
  psalm_set_reals(c, "RATES", "SPEED", 1, &speed);
  check(psalm_set_word(c, "RATES", "UNITS", "RAD/S") == PSALM_DONE, "a word");
  check(psalm_study(c, "rates", 0, 0, &r) == PSALM_DONE, "rates");
  input = column(r, "positions", "input", &rows);
  v = column(r, "positions", "output.v", NULL);
  a = column(r, "positions", "output.a", NULL);
  rate = column(r, "positions", "output.first", NULL);
  check(rows == 24 && input && v && a && rate, "rates are columns");
  check(psalm_find_table(r, "positions") == 1 && psalm_find_column(r, 1, "output.v") > 0, "rates: the first table has the positions");
  for (int i = 0; input && v && a && rate && i < rows; i++) {
    slide_at(input[i], of);
    worst = fmax(worst, fmax(fabs(v[i] - 2*of[1]), fmax(fabs(a[i] - 4*of[2]), fabs(rate[i] - of[1]))));
  }
  check(worst < 1e-11*160, "velocity and acceleration are the derivatives of the closed form");
  psalm_result_free(r);
  psalm_free(c);
  free(input);
  free(v);
  free(a);
  free(rate);
}

/* A sketch made in memory, and every call that makes one. */
static void sketch(void) {
  const char *const from_to[1] = {"C D"};
  const double exact[1] = {80.0};
  psalm_case *c = NULL;
  psalm_result *r = NULL;
  double *x, *y;
  int rows = 0, step = 30;
  psalm_new("FOUR-BAR", &c);
  check(psalm_add_joint(c, "A", 0, 0, 1) == PSALM_DONE && psalm_add_joint(c, "B", 0, 30, 0) == PSALM_DONE &&
        psalm_add_joint(c, "C", 40, 80, 0) == PSALM_DONE && psalm_add_joint(c, "D", 90, 0, 1) == PSALM_DONE &&
        psalm_add_joint(c, "P", 20, 90, 0) == PSALM_DONE, "joints");
  check(psalm_add_link(c, "A B", "crank") == PSALM_DONE && psalm_add_link(c, "B C P", NULL) == PSALM_DONE &&
        psalm_add_link(c, "C D", "rocker") == PSALM_DONE, "links");
  check(psalm_add_drive(c, "A", NULL, NULL) == PSALM_DONE && psalm_add_output(c, "point P", NULL) == PSALM_DONE, "drive and output");
  psalm_set_words(c, "CHAIN", "LENP", 1, from_to);
  psalm_set_reals(c, "CHAIN", "LENV", 1, exact);
  psalm_set_integers(c, "METHOD", "IKIN", 1, &step);
  check(psalm_study(c, "analysis", PSALM_BRIEF, 0, &r) == PSALM_DONE, "a sketch made in memory");
  x = column(r, "positions", "C.x", &rows);
  y = column(r, "positions", "C.y", NULL);
  check(rows == 12 && x && y, "its joints by name");
  for (int i = 0; x && y && i < rows; i++) check(fabs(hypot(x[i] - 90, y[i]) - 80) < 1e-11, "the exact length counts");
  psalm_result_free(r);
  free(x);
  free(y);
  check(psalm_add_joint(c, "two words", 0, 0, 0) == PSALM_BAD_INPUT && says(c, "one word"), "the name of a joint is one word");
  check(psalm_add_joint(c, "Q", NAN, 0, 0) == PSALM_BAD_INPUT && psalm_add_link(c, "", NULL) == PSALM_BAD_INPUT, "no place, no joints");
  check(psalm_add_slide(c, "crank", "rocker", 0, INFINITY, 0, NULL) == PSALM_BAD_INPUT &&
        psalm_add_gear(c, "crank", "rocker", "frame", NAN, 1) == PSALM_BAD_INPUT, "slides and gears of no numbers");
  check(psalm_study(c, "picture", 0, 0, &r) <= PSALM_VIOLATION && psalm_file_count(r) >= 3, "pictures");
  for (int k = 1; k <= psalm_file_count(r); k++)
    check(psalm_file_ending(r, k)[0] == '.' && strlen(psalm_file_content(r, k)) > 1000, "a picture has an ending and a content");
  psalm_result_free(r);
  psalm_free(c);
}

static void tolerances(void) {
  char text[600];
  double *worst, *rss, of[3];
  psalm_result *r = NULL;
  snprintf(text, sizeof text, "%s &TOLER TOLARC=0.0,0.01 &END\n", slider);
  psalm_case *c = from_text(text);
  check(psalm_study(c, "tolerances", 0, 0, &r) == PSALM_DONE, "tolerances");
  worst = column(r, "tolerances", "output.worst_case", NULL);
  rss = column(r, "tolerances", "output.root_sum_square", NULL);
  slide_at(0, of);
  /* of the rod alone: d slide/d rod = rod/root */
  check(worst && rss && fabs(worst[0] - 0.01*140/(of[0] - 40)) < 1e-12 && fabs(worst[0] - rss[0]) < 1e-15,
        "one tolerance: worst case is RSS, and exact");
  psalm_result_free(r);
  psalm_free(c);
  free(worst);
  free(rss);
}

static void search(const char *data) {
  char name[1000];
  psalm_case *c = NULL, *found = NULL;
  psalm_result *r = NULL, *of_found = NULL;
  snprintf(name, sizeof name, "%s/path5.nml", data);
  check(psalm_read_file(name, 1, &c) == PSALM_DONE && c, "a case from a file");
  check(psalm_study(c, "synthesis", 0, 2, &r) == PSALM_DONE && psalm_case_count(r) >= 1, "a search");
  check(psalm_find_table(r, "found") == 1 && psalm_row_count(r, 1) == psalm_case_count(r), "a search: the first table has the linkages");
  check(psalm_case_of(r, 1, &found) == PSALM_DONE && found, "what was found is a case");
  check(psalm_study(found, "analysis", 0, 0, &of_found) == PSALM_DONE && number(of_found, "totals", "objective") < 7.5e-7,
        "five points: as good as known");
  check(fabs(number(r, "found", "objective") - number(of_found, "totals", "objective")) < 1e-12, "its objective is in the table");
  psalm_result_free(of_found);
  psalm_free(found);
  found = c;
  check(psalm_case_of(r, 1000, &found) == PSALM_MISUSE && !found, "no linkage of that rank");
  check(strlen(psalm_found_text(r)) > 100, "the data set of what was found");
  psalm_result_free(r);
  psalm_free(c);
}

static void findings(void) {
  psalm_case *c = NULL;
  psalm_result *r = NULL;
  check(psalm_read_text("TITLE\n &LINKS NLOPP=1 &END\n", 1, &c) == PSALM_BAD_INPUT && c, "bad text gives a case with findings");
  check(says(c, "did you mean NLOOP?") && psalm_finding_level(c, 2) == PSALM_ERROR && psalm_finding_line(c, 2) == 2, "text, level, line");
  check(psalm_study(c, "analysis", 0, 0, &r) == PSALM_BAD_INPUT && !r && psalm_findings(c) > 0, "it cannot be analysed");
  psalm_free(c);
  check(psalm_read_text("", 1, &c) == PSALM_BAD_INPUT && says(c, "empty"), "an empty text");
  psalm_free(c);
  check(psalm_read_text(slider, 2, &c) == PSALM_BAD_INPUT && says(c, "no case of this number"), "a case that is not there");
  psalm_free(c);
  check(psalm_read_text("\001\377\n&&&'\n(((\n", 1, &c) == PSALM_BAD_INPUT, "noise");
  psalm_free(c);
  check(psalm_read_file("/nowhere/at/all.nml", 1, &c) == PSALM_FILE_TROUBLE && says(c, "cannot open"), "a file that is not there");
  psalm_free(c);
  c = from_text("A FOUR-BAR THAT OPENS\n &LINKS NLOOP=1, MAXARC=4, ILINK=1,2,3,4, ILOOP=1,0,0,1, ARCL=50.,40.,40.,60., GAMA=3*0.,180.,\n"
                " NOUTLK=3, NOUTLP=1 &END\n &METHOD MOTION=1, NDES=2, DELT=0.,180. &END\n");
  double *angle, *closed;
  check(psalm_study(c, "analysis", 0, 0, &r) == PSALM_VIOLATION && psalm_finding_level(c, 1) == PSALM_WARNING, "a linkage that opens is a result");
  angle = column(r, "positions", "output", NULL);
  closed = column(r, "positions", "closed", NULL);
  check(angle && closed && closed[1] == 0 && isnan(angle[1]), "where it is open its output is NaN");
  psalm_result_free(r);
  psalm_free(c);
  free(angle);
  free(closed);
}

static void misuse(void) {
  psalm_case *c = NULL;
  psalm_result *r = NULL;
  double x[24];
  int one = 1;
  check(psalm_read_text(NULL, 1, &c) == PSALM_MISUSE && !c, "no text");
  check(psalm_read_text(slider, 1, NULL) == PSALM_MISUSE && psalm_read_file(NULL, 1, &c) == PSALM_MISUSE, "no place, no file");
  check(psalm_new("X", NULL) == PSALM_MISUSE && psalm_copy(NULL, &c) == PSALM_MISUSE, "no place for a new case");
  check(psalm_study(NULL, "analysis", 0, 0, &r) == PSALM_MISUSE && !r && psalm_case_of(NULL, 1, &c) == PSALM_MISUSE, "studies of NULL");
  check(psalm_table_count(NULL) == 0 && !psalm_table_name(NULL, 1) && psalm_row_count(NULL, 1) == 0 && psalm_column_count(NULL, 1) == 0 &&
        !psalm_columns(NULL, 1) && !psalm_column_name(NULL, 1, 1) && !psalm_column_unit(NULL, 1, 1) && psalm_find_table(NULL, "x") == 0 &&
        psalm_find_column(NULL, 1, "x") == 0 && psalm_column(NULL, 1, 1, 1, x) == PSALM_MISUSE && !psalm_word(NULL, 1, 1, 1) &&
        psalm_column_kind(NULL, 1, 1) == -1 && psalm_case_count(NULL) == 0 && psalm_file_count(NULL) == 0 && !psalm_file_content(NULL, 1) &&
        !psalm_file_ending(NULL, 1) && !psalm_found_text(NULL), "results of NULL");
  check(psalm_add_loop(NULL, 1, &one, &one, NULL, NULL) == PSALM_MISUSE && psalm_set_integers(NULL, "A", "B", 1, &one) == PSALM_MISUSE &&
        psalm_set_reals(NULL, "A", "B", 1, x) == PSALM_MISUSE && psalm_set_word(NULL, "A", "B", "C") == PSALM_MISUSE &&
        psalm_set_words(NULL, "A", "B", 1, NULL) == PSALM_MISUSE && psalm_add_joint(NULL, "A", 0, 0, 0) == PSALM_MISUSE &&
        psalm_add_link(NULL, "A B", NULL) == PSALM_MISUSE && psalm_add_slide(NULL, "A", "B", 0, 0, 0, NULL) == PSALM_MISUSE &&
        psalm_add_gear(NULL, "A", "B", "C", 1, 1) == PSALM_MISUSE && psalm_add_drive(NULL, "A", NULL, NULL) == PSALM_MISUSE &&
        psalm_add_output(NULL, "A", NULL) == PSALM_MISUSE && psalm_vary(NULL, "A") == PSALM_MISUSE &&
        psalm_vary_arc(NULL, 1, 1, 1, 0) == PSALM_MISUSE &&
        psalm_set_length(NULL, 1, 1, 1) == PSALM_MISUSE && psalm_get_angle(NULL, 1, 1, x) == PSALM_MISUSE, "changes of NULL");
  check(!psalm_listing(NULL) && !psalm_finding_text(NULL, 1) && psalm_findings(NULL) == 0 && psalm_finding_line(NULL, 1) == 0 &&
        !psalm_case_text(NULL) && !psalm_case_title(NULL) && psalm_loop_count(NULL) == 0 && psalm_arc_count(NULL, 1) == 0, "texts of NULL");
  psalm_free(NULL);
  psalm_result_free(NULL);
  c = from_text(slider);
  check(psalm_study(c, NULL, 0, 0, &r) == PSALM_MISUSE && psalm_study(c, "analysis", 0, 0, NULL) == PSALM_MISUSE &&
        psalm_study(c, "analysis", 77, 0, &r) == PSALM_MISUSE, "no verb, no place, no such option");
  check(psalm_study(c, "analisys", 0, 0, &r) == PSALM_BAD_INPUT && !r && says(c, "did you mean 'analysis'"), "no such verb");
  psalm_study(c, "analysis", 0, 0, &r);
  check(psalm_column(r, 1, 1, 23, x) == PSALM_MISUSE && psalm_column(r, 1, 1, -1, x) == PSALM_MISUSE, "a wrong size");
  check(psalm_column(r, 1, 1, 24, NULL) == PSALM_MISUSE && psalm_column(r, 0, 1, 24, x) == PSALM_MISUSE &&
        psalm_column(r, 99, 1, 24, x) == PSALM_MISUSE && psalm_column(r, 1, 0, 24, x) == PSALM_MISUSE &&
        psalm_column(r, 1, 99, 24, x) == PSALM_MISUSE && !psalm_word(r, 1, 1, 1), "no place, no such table, no such column");
  psalm_result_free(r);
  check(psalm_set_length(c, 1, 9, 1) == PSALM_MISUSE && psalm_set_length(c, 0, 1, 1) == PSALM_MISUSE &&
        psalm_set_angle(c, 7, 1, 1) == PSALM_MISUSE && says(c, "no such arc"), "an arc that is not there");
  check(psalm_set_length(c, 1, 1, -1) == PSALM_MISUSE && psalm_set_length(c, 1, 1, NAN) == PSALM_MISUSE &&
        psalm_set_angle(c, 1, 1, INFINITY) == PSALM_MISUSE && psalm_get_length(c, 1, 1, NULL) == PSALM_MISUSE, "what is no dimension");
  check(psalm_finding_text(c, 0) == NULL && psalm_finding_text(c, 99) == NULL && psalm_finding_level(c, -1) == 0, "no such finding");
  check(psalm_add_loop(c, 0, &one, &one, NULL, NULL) == PSALM_MISUSE && psalm_add_loop(c, 1, NULL, &one, NULL, NULL) == PSALM_MISUSE,
        "a loop of nothing");
  check(psalm_add_loop(c, 1, &one, &one, NULL, NULL) == PSALM_BAD_INPUT && says(c, "add no loops"), "a loop for a case that was read");
  check(psalm_set_integers(c, NULL, "B", 1, &one) == PSALM_MISUSE && psalm_set_reals(c, "A", "B", 0, x) == PSALM_MISUSE &&
        psalm_set_word(c, "A", "B", NULL) == PSALM_MISUSE, "an item without its parts");
  check(psalm_study(c, "analysis", 0, 0, &r) == PSALM_DONE && psalm_column(r, 1, psalm_find_column(r, 1, "output"), 24, x) == PSALM_DONE &&
        fabs(x[0] - 179.6424) < 1e-4, "misuse leaves a case as it was");
  psalm_result_free(r);
  psalm_free(c);
  check(psalm_new(NULL, &c) == PSALM_DONE && psalm_study(c, "analysis", 0, 0, &r) == PSALM_BAD_INPUT && psalm_findings(c) > 0,
        "a case of nothing");
  psalm_free(c);
}

static void texts(void) {
  int verbs = 0;
  check(!strcmp(psalm_library_version(), PSALM_VERSION) && psalm_interface() == PSALM_INTERFACE, "version and interface are those of the header");
  while (psalm_verb(verbs + 1)) verbs++;
  check(verbs >= 18 && !strcmp(psalm_verb(1), "analysis") && !psalm_verb(0) && !psalm_verb(-1), "names of the verbs");
  check(!strcmp(psalm_status_text(PSALM_DONE), "done") && !strcmp(psalm_status_text(PSALM_BAD_INPUT), "the input is wrong") &&
        !strcmp(psalm_status_text(PSALM_MISUSE), "the call is wrong"), "what a status means");
  check(!strcmp(psalm_status_text(77), "unknown status") && !strcmp(psalm_status_text(-1), "unknown status"), "no status");
}

/* Names and words cannot leave their place in the text of a case. */
static void names(void) {
  psalm_case *c = NULL;
  psalm_result *r = NULL;
  const double one = 1.0;
  check(psalm_new("T\n &LIMITS TANGLE=3.0 &END", &c) == PSALM_DONE && psalm_study(c, "analysis", 0, 0, &r) == PSALM_BAD_INPUT && says(c, "one line"),
        "a title of two lines");
  psalm_free(c);
  psalm_new("T", &c);
  check(psalm_set_reals(c, "LIMITS", "TANGLE=1.0, BNAME", 1, &one) == PSALM_BAD_INPUT && says(c, "letters and digits"), "an item that sets another");
  check(psalm_set_reals(c, "LIMITS &END &SEARCH", "X", 1, &one) == PSALM_BAD_INPUT && says(c, "letters and digits"), "a group that opens another");
  check(psalm_set_word(c, "RATES", "UNITS", "A\nB") == PSALM_BAD_INPUT && says(c, "line breaks"), "a word of two lines");
  check(psalm_set_word(c, "RATES", "UNITS", "REV/MIN', SPEED=1000.0, UNITS='") == PSALM_DONE && psalm_study(c, "rates", 0, 0, &r) == PSALM_BAD_INPUT,
        "apostrophes stay in their word");
  psalm_free(c);
}

static psalm_case *searched;

static void stop_it(int unused) {
  (void)unused;
  psalm_cancel(searched);
}

/* A search that would take days, ended by a signal handler. */
static void stopping(const char *directory) {
  char file[4096], text[16384], more[16384 + 64];
  size_t n;
  psalm_result *r = NULL;
  int made = -1, most = 0;
  double best = -1;
  clock_t began = clock();
  const struct itimerval second = {{0, 0}, {1, 0}};    /* of the processor: on a busy machine a search may not begin within one of the clock */
  struct sigaction ours, before;
  FILE *data;
  char *place;
  snprintf(file, sizeof file, "%s/needle_lsq.nml", directory);
  data = fopen(file, "r");
  check(data != NULL, "needle_lsq.nml is there");
  if (!data) return;
  n = fread(text, 1, sizeof text - 1, data);
  fclose(data);
  text[n] = 0;
  place = strstr(text, "NSTART=");
  check(place != NULL, "it has NSTART");
  if (!place) return;
  snprintf(more, sizeof more, "%.*sNSTART=1000000%s", (int)(place - text), text, place + 7 + strspn(place + 7, "0123456789"));
  searched = from_text(more);
  check(psalm_cancel(searched) == PSALM_DONE && psalm_cancel(NULL) == PSALM_MISUSE, "psalm_cancel without a study");
  memset(&ours, 0, sizeof ours);
  ours.sa_handler = stop_it;
  sigaction(SIGPROF, &ours, &before);
  setitimer(ITIMER_PROF, &second, NULL);
  check(psalm_study(searched, "synthesis", 0, 1, &r) == PSALM_VIOLATION && psalm_case_count(r) > 0, "a search that is stopped has a result");
  psalm_result_free(r);
  sigaction(SIGPROF, &before, NULL);
  check((double)(clock() - began)/CLOCKS_PER_SEC < 5, "it ends soon");
  check(psalm_progress(searched, &made, &most, &best) == PSALM_DONE && made > 0 && made < most && most == 1000000 && best >= 0, "progress");
  check(psalm_progress(searched, NULL, NULL, NULL) == PSALM_DONE && psalm_progress(NULL, &made, NULL, NULL) == PSALM_MISUSE,
        "progress to nowhere, of nothing");
  check(psalm_study(searched, "synthesis", 0, 2147483647, &r) == PSALM_BAD_INPUT && !r && says(searched, "1024"), "too many threads");
  psalm_free(searched);
}

static long kilobytes(void) {
  char line[256];
  long most = 0;
  FILE *status = fopen("/proc/self/status", "r");
  while (status && fgets(line, sizeof line, status))
    if (!strncmp(line, "VmRSS:", 6)) most = atol(line + 6);
  if (status) fclose(status);
  return most;
}

/* Memory does not grow with the number of calls. */
static void steady(int calls) {
  static const char *const verb[] = {"analysis", "rates", "summary"};
  psalm_case *c = from_text(slider), *other = NULL;
  psalm_result *r = NULL;
  for (int v = 0; v < 3; v++) {
    long before = 0;
    for (int k = 0; k < calls + 50; k++) {
      if (k == 50) before = kilobytes();
      psalm_study(c, verb[v], PSALM_BRIEF, 0, &r);
      psalm_result_free(r);
      psalm_copy(c, &other);
      psalm_case_text(other);
      psalm_free(other);
    }
    if (kilobytes() - before >= 1000) printf("        %s: %ld kB more\n", verb[v], kilobytes() - before);
    check(kilobytes() - before < 1000, "memory is as it was after many calls");
  }
  psalm_free(c);
}

int main(int count, char **argument) {
  const int all[] = {SIGINT, SIGTERM, SIGSEGV, SIGFPE, SIGABRT, SIGPIPE};
  struct sigaction before[6], after;
  sigset_t mask_before, mask_after;
  int same = 1;
  if (count < 2) return 2;
  for (int i = 0; i < 6; i++) sigaction(all[i], NULL, &before[i]);
  sigprocmask(SIG_BLOCK, NULL, &mask_before);
  texts();
  analysis();
  made();
  sketch();
  tolerances();
  search(argument[1]);
  findings();
  misuse();
  names();
  stopping(argument[1]);
  steady(count > 2 ? atoi(argument[2]) : 300);
  sigprocmask(SIG_BLOCK, NULL, &mask_after);
  for (int i = 0; i < 6; i++) {
    sigaction(all[i], NULL, &after);
    same = same && after.sa_handler == before[i].sa_handler && sigismember(&mask_before, all[i]) == sigismember(&mask_after, all[i]);
  }
  check(same, "handlers and mask of signals are as they were");
  printf("%d passed, %d failed\n", passed, failed);
  return failed > 0;
}
