/* The C interface: results against closed forms, findings, and every kind of misuse.
   usage: test_psalm DATA_DIRECTORY. Last line: N passed, N failed. */
#define _POSIX_C_SOURCE 200809L
#include <math.h>
#include <psalm.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
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

static void analysis(void) {
  psalm_case *c = from_text(slider);
  double input[24], closed[24], slide[24], objective, worst = 0, other = 1;
  check(c && psalm_findings(c) == 0, "a case from text has no findings");
  check(psalm_positions(c) == 0 && psalm_components(c) == 0, "no results before a study");
  check(psalm_analyse(c) == PSALM_DONE, "analysis");
  check(psalm_positions(c) == 24 && psalm_components(c) == 1, "24 positions, one component");
  check(psalm_values(c, PSALM_INPUT, 24, input) == PSALM_DONE && input[1] == 15, "inputs");
  check(psalm_values(c, PSALM_CLOSED, 24, closed) == PSALM_DONE && closed[7] == 1, "closed");
  check(psalm_values(c, PSALM_ACTUAL, 24, slide) == PSALM_DONE, "output");
  check(psalm_values(c, PSALM_OBJECTIVE, 1, &objective) == PSALM_DONE && objective == 0, "no desired values, no error");
  for (int i = 0; i < 24; i++) {
    double of[3];
    slide_at(input[i], of);
    worst = fmax(worst, fabs(of[0] - slide[i]));
  }
  check(worst < 1e-12*180, "the slide is that of a right triangle");
  check(strstr(psalm_listing(c), "179.6424") != NULL, "the listing");

  check(psalm_set_length(c, 1, 2, 100) == PSALM_DONE && psalm_get_length(c, 1, 2, &other) == PSALM_DONE && other == 100, "a length");
  check(psalm_set_angle(c, 1, 4, 90) == PSALM_DONE && psalm_get_angle(c, 1, 4, &other) == PSALM_DONE && other == 90, "an angle");
  psalm_set_angle(c, 1, 4, 270);
  check(psalm_analyse(c) == PSALM_DONE && psalm_values(c, PSALM_ACTUAL, 24, slide) == PSALM_DONE, "analysis of changed dimensions");
  check(fabs(slide[0] - (40 + sqrt(100*100 - 10*10))) < 1e-12, "the changed dimensions count");
  psalm_free(c);
}

static void made(void) {
  const int ilink[4] = {1, -2, 3, 4}, iloop[4] = {1, 0, -4, 1}, kind = 3, arc = 3, loop = 1, step = 15;
  const double length[4] = {40, 140, 0, 10}, angle[4] = {0, 0, 0, 270}, speed = 2;
  psalm_case *c = NULL;
  double input[24], rate[3][24], worst = 0, of[3];
  check(psalm_new("MADE IN MEMORY", &c) == PSALM_DONE && c, "a case made in memory");
  check(psalm_add_loop(c, 4, ilink, iloop, length, angle) == PSALM_DONE, "its loop");
  psalm_set_integers(c, "METHOD", "MOTION", 1, &kind);
  psalm_set_integers(c, "METHOD", "IKIN", 1, &step);
  psalm_set_integers(c, "LINKS", "NOUTLK", 1, &arc);
  psalm_set_integers(c, "LINKS", "NOUTLP", 1, &loop);
  psalm_set_reals(c, "RATES", "SPEED", 1, &speed);
  check(psalm_set_word(c, "RATES", "UNITS", "RAD/S") == PSALM_DONE, "a word");
  check(psalm_rates(c) == PSALM_DONE, "rates");
  check(psalm_values(c, PSALM_INPUT, 24, input) == PSALM_DONE && psalm_values(c, PSALM_VELOCITY, 24, rate[0]) == PSALM_DONE &&
        psalm_values(c, PSALM_ACCELERATION, 24, rate[1]) == PSALM_DONE && psalm_values(c, PSALM_RATE, 24, rate[2]) == PSALM_DONE,
        "rates are copied");
  for (int i = 0; i < 24; i++) {
    slide_at(input[i], of);
    worst = fmax(worst, fmax(fabs(rate[0][i] - 2*of[1]), fmax(fabs(rate[1][i] - 4*of[2]), fabs(rate[2][i] - of[1]))));
  }
  check(worst < 1e-11*160, "velocity and acceleration are the derivatives of the closed form");
  check(psalm_values(c, PSALM_WORST_CASE, 24, rate[0]) == PSALM_MISUSE && says(c, "study was not made"), "no tolerances were asked for");
  psalm_free(c);
}

static void tolerances(void) {
  char text[600];
  double worst[24], rss[24], of[3];
  snprintf(text, sizeof text, "%s &TOLER TOLARC=0.0,0.01 &END\n", slider);
  psalm_case *c = from_text(text);
  check(psalm_tolerances(c, 0) == PSALM_DONE, "tolerances");
  check(psalm_values(c, PSALM_WORST_CASE, 24, worst) == PSALM_DONE && psalm_values(c, PSALM_RSS, 24, rss) == PSALM_DONE, "bands");
  slide_at(0, of);
  /* of the rod alone: d slide/d rod = rod/root */
  check(fabs(worst[0] - 0.01*140/(of[0] - 40)) < 1e-12 && fabs(worst[0] - rss[0]) < 1e-15, "one tolerance: worst case is RSS, and exact");
  psalm_free(c);
}

static void search(const char *data) {
  char name[1000];
  psalm_case *c = NULL, *found = NULL;
  double objective = 1;
  snprintf(name, sizeof name, "%s/path5.nml", data);
  check(psalm_read_file(name, 1, &c) == PSALM_DONE && c, "a case from a file");
  check(psalm_found(c, 1, &found) == PSALM_MISUSE && !found && says(c, "no search was made"), "nothing is found before a search");
  check(psalm_synthesise(c, 2) == PSALM_DONE, "a search");
  check(psalm_found(c, 1, &found) == PSALM_DONE && found, "what was found is a case");
  check(psalm_analyse(found) == PSALM_DONE && psalm_values(found, PSALM_OBJECTIVE, 1, &objective) == PSALM_DONE && objective < 7.5e-7,
        "five points: as good as known");
  check(psalm_components(found) == 2, "a point has two components");
  psalm_free(found);
  found = c;
  check(psalm_found(c, 1000, &found) == PSALM_MISUSE && !found, "no linkage of that rank");
  psalm_free(c);
}

static void findings(void) {
  psalm_case *c = NULL;
  check(psalm_read_text("TITLE\n &LINKS NLOPP=1 &END\n", 1, &c) == PSALM_BAD_INPUT && c, "bad text gives a case with findings");
  check(says(c, "did you mean NLOOP?") && psalm_finding_level(c, 2) == PSALM_ERROR && psalm_finding_line(c, 2) == 2, "text, level, line");
  check(psalm_analyse(c) == PSALM_BAD_INPUT && psalm_positions(c) == 0 && psalm_findings(c) > 0, "it cannot be analysed");
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
  double angle[2], closed[2];
  check(psalm_analyse(c) == PSALM_VIOLATION && psalm_finding_level(c, 1) == PSALM_WARNING, "a linkage that opens is a result");
  check(psalm_values(c, PSALM_CLOSED, 2, closed) == PSALM_DONE && psalm_values(c, PSALM_ACTUAL, 2, angle) == PSALM_DONE &&
        closed[1] == 0 && isnan(angle[1]), "where it is open its output is NaN");
  psalm_free(c);
}

static void misuse(void) {
  psalm_case *c = NULL;
  double x[24];
  int one = 1;
  check(psalm_read_text(NULL, 1, &c) == PSALM_MISUSE && !c, "no text");
  check(psalm_read_text(slider, 1, NULL) == PSALM_MISUSE && psalm_read_file(NULL, 1, &c) == PSALM_MISUSE, "no place, no file");
  check(psalm_new("X", NULL) == PSALM_MISUSE, "no place for a new case");
  check(psalm_analyse(NULL) == PSALM_MISUSE && psalm_rates(NULL) == PSALM_MISUSE && psalm_tolerances(NULL, 1) == PSALM_MISUSE &&
        psalm_synthesise(NULL, 1) == PSALM_MISUSE && psalm_found(NULL, 1, &c) == PSALM_MISUSE, "studies of NULL");
  check(psalm_values(NULL, 1, 1, x) == PSALM_MISUSE && psalm_positions(NULL) == 0 && psalm_components(NULL) == 0, "results of NULL");
  check(psalm_add_loop(NULL, 1, &one, &one, NULL, NULL) == PSALM_MISUSE && psalm_set_integers(NULL, "A", "B", 1, &one) == PSALM_MISUSE &&
        psalm_set_reals(NULL, "A", "B", 1, x) == PSALM_MISUSE && psalm_set_word(NULL, "A", "B", "C") == PSALM_MISUSE &&
        psalm_set_length(NULL, 1, 1, 1) == PSALM_MISUSE && psalm_get_angle(NULL, 1, 1, x) == PSALM_MISUSE, "changes of NULL");
  check(!psalm_listing(NULL) && !psalm_finding_text(NULL, 1) && psalm_findings(NULL) == 0 && psalm_finding_line(NULL, 1) == 0,
        "texts of NULL");
  psalm_free(NULL);
  c = from_text(slider);
  psalm_analyse(c);
  check(psalm_values(c, PSALM_ACTUAL, 23, x) == PSALM_MISUSE && says(c, "24 values; count is 23"), "a wrong size");
  check(psalm_values(c, PSALM_ACTUAL, -1, x) == PSALM_MISUSE && psalm_values(c, PSALM_ACTUAL, 24, NULL) == PSALM_MISUSE, "no place");
  check(psalm_values(c, 99, 24, x) == PSALM_MISUSE && psalm_values(c, 0, 24, x) == PSALM_MISUSE, "no such result");
  check(psalm_values(c, PSALM_VELOCITY, 24, x) == PSALM_MISUSE, "rates of an analysis");
  check(psalm_set_length(c, 1, 9, 1) == PSALM_MISUSE && psalm_set_length(c, 0, 1, 1) == PSALM_MISUSE &&
        psalm_set_angle(c, 7, 1, 1) == PSALM_MISUSE && says(c, "no such arc"), "an arc that is not there");
  check(psalm_set_length(c, 1, 1, -1) == PSALM_MISUSE && psalm_set_length(c, 1, 1, NAN) == PSALM_MISUSE &&
        psalm_set_angle(c, 1, 1, INFINITY) == PSALM_MISUSE && psalm_get_length(c, 1, 1, NULL) == PSALM_MISUSE, "what is no dimension");
  check(psalm_finding_text(c, 0) == NULL && psalm_finding_text(c, 99) == NULL && psalm_finding_level(c, -1) == 0, "no such finding");
  check(psalm_add_loop(c, 0, &one, &one, NULL, NULL) == PSALM_MISUSE && psalm_add_loop(c, 1, NULL, &one, NULL, NULL) == PSALM_MISUSE,
        "a loop of nothing");
  check(psalm_set_integers(c, NULL, "B", 1, &one) == PSALM_MISUSE && psalm_set_reals(c, "A", "B", 0, x) == PSALM_MISUSE &&
        psalm_set_word(c, "A", "B", NULL) == PSALM_MISUSE, "an item without its parts");
  check(psalm_analyse(c) == PSALM_DONE && psalm_values(c, PSALM_ACTUAL, 24, x) == PSALM_DONE && fabs(x[0] - 179.6424) < 1e-4,
        "misuse leaves a case as it was");
  psalm_free(c);
  check(psalm_new(NULL, &c) == PSALM_DONE && psalm_analyse(c) == PSALM_BAD_INPUT && psalm_findings(c) > 0, "a case of nothing");
  psalm_free(c);
}

static void texts(void) {
  check(strchr(psalm_version(), '.') != NULL, "version");
  check(!strcmp(psalm_status_text(PSALM_DONE), "done") && !strcmp(psalm_status_text(PSALM_BAD_INPUT), "the input is wrong") &&
        !strcmp(psalm_status_text(PSALM_MISUSE), "the call is wrong"), "what a status means");
  check(!strcmp(psalm_status_text(77), "unknown status") && !strcmp(psalm_status_text(-1), "unknown status"), "no status");
}

/* Names and words cannot leave their place in the text of a case. */
static void names(void) {
  psalm_case *c = NULL;
  const double one = 1.0;
  check(psalm_new("T\n &LIMITS TANGLE=3.0 &END", &c) == PSALM_DONE && psalm_analyse(c) == PSALM_BAD_INPUT && says(c, "one line"),
        "a title of two lines");
  psalm_free(c);
  psalm_new("T", &c);
  check(psalm_set_reals(c, "LIMITS", "TANGLE=1.0, BNAME", 1, &one) == PSALM_BAD_INPUT && says(c, "letters and digits"), "an item that sets another");
  check(psalm_set_reals(c, "LIMITS &END &SEARCH", "X", 1, &one) == PSALM_BAD_INPUT && says(c, "letters and digits"), "a group that opens another");
  check(psalm_set_word(c, "RATES", "UNITS", "A\nB") == PSALM_BAD_INPUT && says(c, "line breaks"), "a word of two lines");
  check(psalm_set_word(c, "RATES", "UNITS", "REV/MIN', SPEED=1000.0, UNITS='") == PSALM_DONE && psalm_rates(c) == PSALM_BAD_INPUT,
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
  int made = -1, most = 0;
  double best = -1;
  time_t began = time(NULL);
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
  sigaction(SIGALRM, &ours, &before);
  alarm(1);
  check(psalm_synthesise(searched, 1) == PSALM_VIOLATION, "a search that is stopped");
  alarm(0);
  sigaction(SIGALRM, &before, NULL);
  check(difftime(time(NULL), began) < 15, "it ends soon");
  check(psalm_progress(searched, &made, &most, &best) == PSALM_DONE && made > 0 && made < most && most == 1000000 && best >= 0, "progress");
  check(psalm_progress(searched, NULL, NULL, NULL) == PSALM_DONE && psalm_progress(NULL, &made, NULL, NULL) == PSALM_MISUSE,
        "progress to nowhere, of nothing");
  check(psalm_synthesise(searched, 2147483647) == PSALM_BAD_INPUT && says(searched, "1024"), "too many threads");
  psalm_free(searched);
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
  tolerances();
  search(argument[1]);
  findings();
  misuse();
  names();
  stopping(argument[1]);
  sigprocmask(SIG_BLOCK, NULL, &mask_after);
  for (int i = 0; i < 6; i++) {
    sigaction(all[i], NULL, &after);
    same = same && after.sa_handler == before[i].sa_handler && sigismember(&mask_before, all[i]) == sigismember(&mask_after, all[i]);
  }
  check(same, "handlers and mask of signals are as they were");
  printf("%d passed, %d failed\n", passed, failed);
  return failed > 0;
}
