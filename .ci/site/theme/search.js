// Ranks pages by the words of a question: rare words count more, words of titles count more, and no word is required.
var Scorer = {
  objNameMatch: 11, objPartialMatch: 6, objPrio: {}, objPrioDefault: 0,
  title: 15, partialTitle: 7, term: 5, partialTerm: 2,
};

document.addEventListener("DOMContentLoaded", () => rankByRarity(Search));

function rankByRarity(search) {
  const inTitle = 4, inHeading = 1.5, partly = 0.4, shortest = 4;
  const list = (files) => (files === undefined ? [] : Array.isArray(files) ? files : [files]);
  search.performTermsSearch = (searchTerms) => {
    const { terms, titleterms, docnames, titles, filenames } = search._index;
    const stemmer = new Stemmer();
    const stems = titles.map((title) => new Set(splitQuery(title.toLowerCase()).map((word) => stemmer.stemWord(word))));
    const scores = new Map(), matched = new Map();
    for (const word of searchTerms) {
      const weights = new Map();
      const add = (files, weight) => {
        for (const file of list(files)) weights.set(file, Math.max(weights.get(file) || 0, weight));
      };
      if (Object.hasOwn(terms, word)) add(terms[word], 1);
      if (Object.hasOwn(titleterms, word)) {
        for (const file of list(titleterms[word])) add(file, stems[file].has(word) ? inTitle : inHeading);
      }
      if (!weights.size && word.length >= shortest) {
        for (const term of Object.keys(terms)) if (term.includes(word)) add(terms[term], partly);
        for (const term of Object.keys(titleterms)) if (term.includes(word)) add(titleterms[term], partly * inTitle);
      }
      const rarity = Math.log(1 + titles.length / (1 + weights.size));
      for (const [file, weight] of weights) {
        scores.set(file, (scores.get(file) || 0) + rarity * weight);
        matched.set(file, (matched.get(file) || 0) + 1);
      }
    }
    const results = [];
    for (const [file, score] of scores) {
      const share = matched.get(file) / searchTerms.size;
      if (share < 0.5) continue;
      const whole = score * share * (stems[file].size ? 1 : 0.5);
      results.push([docnames[file], titles[file], "", null, whole, filenames[file], "text"]);
    }
    return results;
  };
}
