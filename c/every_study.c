/* A data set and the name of a study: its tables, each with its columns. usage: every_study VERB CASE.nml */
#include <psalm.h>
#include <stdio.h>

int main(int count, char **argument) {
  psalm_case *c;
  psalm_result *r = NULL;
  if (count != 3) {
    for (int v = 1; psalm_verb(v); v++) puts(psalm_verb(v));
    return 0;
  }
  int status = psalm_read_file(argument[2], 1, &c);
  if (status == PSALM_DONE) status = psalm_study(c, argument[1], 0, 0, &r);
  for (int i = 1; i <= psalm_findings(c); i++) fprintf(stderr, "%s\n", psalm_finding_text(c, i));
  for (int t = 1; t <= psalm_table_count(r); t++) {
    printf("table %s, rows %d:", psalm_table_name(r, t), psalm_row_count(r, t));
    for (int k = 1; k <= psalm_column_count(r, t); k++) printf(" %s", psalm_column_name(r, t, k));
    puts("");
  }
  for (int f = 1; f <= psalm_file_count(r); f++) printf("file %s\n", psalm_file_ending(r, f));
  printf("linkages %d\n", psalm_case_count(r));
  psalm_result_free(r);
  psalm_free(c);
  return status;
}
