// Order of what the search of the site finds: answers and guides before lists, figures and pages for developers.
var Scorer = {
  score: ([page, , , , score]) => {
    const worth = [[/^guide\/questions/, 4], [/^(guide|tutorial)\//, 3], [/^reference\/(terms|items)/, 1], [/^reference\//, 2], [/^(history|develop|measured)\//, -3]];
    const found = worth.find(([pattern]) => pattern.test(page));
    return score + (found ? found[1] : 0);
  },
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
