/* The slider-crank of the README: cc -I build/lib/include slider_crank.c -L build/lib -lpsalm */
#include <psalm.h>
#include <stdio.h>

int main(void) {
  psalm_case *c;
  psalm_result *r;
  double input[24], slide[24];
  psalm_read_text("OFFSET SLIDER-CRANK\n &LINKS NLOOP=1, MAXARC=4, ILINK=1,-2,3,4, ILOOP=1,0,-4,1,\n"
                  "  ARCL=40.0,140.0,0.0,10.0, GAMA=3*0.0,270.0, NOUTLK=3, NOUTLP=1 &END\n &METHOD MOTION=3, IKIN=15 &END\n", 1, &c);
  int status = psalm_study(c, "analysis", PSALM_BRIEF, 0, &r);
  for (int i = 1; i <= psalm_findings(c); i++) puts(psalm_finding_text(c, i));
  if (psalm_column(r, 1, psalm_find_column(r, 1, "input"), 24, input) == PSALM_DONE &&
      psalm_column(r, 1, psalm_find_column(r, 1, "output"), 24, slide) == PSALM_DONE)
    for (int i = 0; i < 24; i++) printf("%8.1f%12.4f\n", input[i], slide[i]);
  psalm_result_free(r);
  psalm_free(c);
  return status;
}
