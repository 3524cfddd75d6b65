// Ranks pages by the words of a question: rare words, words of titles and words of short pages count more, and no word
// is required. A name in the question, as `vel_max` or `unknown-key`, leads to where it is explained: the build puts
// `NAMES` before this text.
var Scorer = {
  objNameMatch: 11, objPartialMatch: 6, objPrio: {}, objPrioDefault: 0,
  title: 15, partialTitle: 7, term: 5, partialTerm: 2,
};

// Pages load this file after the script of the search, tests before it.
if (typeof Search !== "undefined") {
  rankByRarity(Search);
  beginWithNames(Search);
}

function beginWithNames(search) {
  const perform = search._performSearch;
  search._performSearch = (query, ...rest) => {
    const asked = query.trim().toLowerCase();
    const words = asked.split(/\s+/).map((word) => word.replace(/^[`'"]+|[`'"?:,.]+$/g, ""));
    const names = words.filter((word) => word === asked || /[a-z][._-][a-z]/.test(word));
    const found = [...new Set(names)].flatMap((name) => (Object.hasOwn(NAMES, name) ? NAMES[name] : []));
    const first = found.map(([page, title, anchor]) =>
      [page, `${anchor} (${title})`, `#${anchor}`, null, Infinity, search._index.filenames[search._index.docnames.indexOf(page)], "title"]);
    return perform(query, ...rest).concat(first.reverse());  // The last one is shown first.
  };
}

function rankByRarity(search) {
  const inTitle = 4, beginsTitle = 2.5, inHeading = 1.5, partly = 0.4, shortest = 4;
  const list = (files) => (files === undefined ? [] : Array.isArray(files) ? files : [files]);
  search.performTermsSearch = (searchTerms) => {
    const { terms, titleterms, docnames, titles, filenames } = search._index;
    const stemmer = new Stemmer();
    const stems = titles.map((title) => splitQuery(title.toLowerCase()).map((word) => stemmer.stemWord(word)));
    const sizes = titles.map(() => 0);
    for (const files of Object.values(terms)) for (const file of list(files)) sizes[file] += 1;
    const mean = sizes.reduce((sum, size) => sum + size, 0) / sizes.length;
    const scores = new Map(), matched = new Map();
    for (const word of searchTerms) {
      const weights = new Map();
      const add = (file, weight) => weights.set(file, Math.max(weights.get(file) || 0, weight));
      const addBody = (files, weight) => {
        for (const file of list(files)) add(file, weight / (0.5 + (0.5 * sizes[file]) / mean));
      };
      if (Object.hasOwn(terms, word)) addBody(terms[word], 1);
      if (Object.hasOwn(titleterms, word)) addBody(titleterms[word], inHeading);
      if (!weights.size && word.length >= shortest) {
        for (const term of Object.keys(terms)) if (term.includes(word)) addBody(terms[term], partly);
      }
      stems.forEach((own, file) => {
        if (own.includes(word)) add(file, inTitle);
        else if (word.length >= shortest && own.some((one) => one.startsWith(word))) add(file, beginsTitle);
      });
      const rarity = Math.log(1 + titles.length / (1 + weights.size));
      for (const [file, weight] of weights) {
        scores.set(file, (scores.get(file) || 0) + rarity * weight);
        matched.set(file, (matched.get(file) || 0) + 1);
      }
    }
    const results = [];
    for (const [file, score] of scores) {
      const share = matched.get(file) / searchTerms.size;
      if (share >= 0.5) results.push([docnames[file], titles[file], "", null, score * share, filenames[file], "text"]);
    }
    return results;
  };
}
