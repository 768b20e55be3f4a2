"""A data set and the name of a study: its tables, each with its columns. usage: every_study.py VERB CASE.nml

What c/every_study.c does, and the programs of example/ one by one."""
import sys

import psalm


def main():
    if len(sys.argv) != 3:
        print("\n".join(psalm.verbs))
        return
    result = psalm.from_file(sys.argv[2]).study(sys.argv[1])
    for finding in result.findings:
        print(finding.text, file=sys.stderr)
    for name, table in reversed(result.tables.items()):
        print("table %s, rows %d: %s" % (name, table.rows, " ".join(table.columns)))
    for ending in result.files:
        print("file", ending)
    print("linkages", len(result.cases))


main()
