// Guides before the reference of the program's modules, which matches nearly every word.
const API = "reference/python/";
const Scorer = {
  score: ([docname, , , , score]) => (docname.startsWith(API) ? score - 50 : score),
  objNameMatch: 11,
  objPartialMatch: 6,
  objPrio: { 0: 15, 1: 5, 2: -5 },
  objPrioDefault: 0,
  title: 15,
  partialTitle: 7,
  term: 5,
  partialTerm: 2,
};
