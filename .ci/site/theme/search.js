// Ranks pages by the words of a question: rare words, words of titles and words of short pages count more, and no word
// is required. A name in the question, as `vel_max`, `vel max` or `unknown-key`, leads to where it is explained: the
// build puts `NAMES` before this text. A word that no page has counts as the most similar one.
var Scorer = {
  objNameMatch: 11, objPartialMatch: 6, objPrio: {}, objPrioDefault: 0,
  title: 15, partialTitle: 7, term: 5, partialTerm: 2,
};

// Pages load this file after the script of the search, tests before it.
if (typeof Search !== "undefined") improve(Search);

function improve(search) {
  rankByRarity(search);
  beginWithNames(search);
  showParts(search);
}

// Names of the words of a question: what is written as a name, and words that are one together, the longest first.
function namesIn(query) {
  const asked = query.trim().toLowerCase(), known = (name) => Object.hasOwn(NAMES, name), longest = 4;
  const words = asked.split(/\s+/).map((word) => word.replace(/^[`'"]+|[`'"?:,.]+$/g, ""));
  const names = words.filter((word) => word === asked || /[a-z][._-][a-z]/.test(word));
  for (let size = Math.min(longest, words.length); size > 1; size--) {
    for (let start = 0; start + size <= words.length; start++) {
      const part = words.slice(start, start + size);
      names.push(part.join("_"), part.join("-"));
    }
  }
  return [...new Set(names)].filter(known);
}

function beginWithNames(search) {
  const perform = search._performSearch;
  search._performSearch = (query, ...rest) => {
    const found = namesIn(query).flatMap((name) => NAMES[name]);
    const first = found.map(([page, title, anchor]) =>
      [page, `${anchor} (${title})`, `#${anchor}`, null, Infinity, search._index.filenames[search._index.docnames.indexOf(page)], "title"]);
    const others = perform(query, ...rest);
    sayRead(search, query, search.read);
    return others.concat(first.reverse());  // The last one is shown first.
  };
}

// Text of what an anchor names: its row or its section, not only the element with the anchor, which may be empty.
function showParts(search) {
  search.htmlToText = (html, anchor) => {
    const page = new DOMParser().parseFromString(html, "text/html");
    page.querySelectorAll(".headerlink, script, style").forEach((one) => one.remove());
    const place = anchor ? page.getElementById(decodeURIComponent(anchor.slice(1))) : null;
    return (place?.closest("tr, section") ?? page.querySelector("[role=main]")).textContent;
  };
}

// The word of the index that a word which no page has is a slip of: one letter wrong, two in long words.
function nearestTerm(word, terms) {
  const shortest = 4, long = 7, most = word.length >= long ? 2 : 1;
  word = word.replace(/y$/, "i");  // as stems end
  let best = null;
  for (const [term, files] of word.length >= shortest ? Object.entries(terms) : []) {
    if (Math.abs(term.length - word.length) > most || term[0] !== word[0] || !/^\p{Letter}+$/u.test(term)) continue;
    const slips = slipsBetween(word, term), pages = Array.isArray(files) ? files.length : 1;
    if (slips > most) continue;
    if (best === null || slips < best.slips || (slips === best.slips && pages > best.pages)) best = { term, slips, pages };
  }
  return best && best.term;
}

// Letters to add, to leave out, to change or to swap until one word is the other.
function slipsBetween(one, other) {
  let before = [], last = Array.from({ length: other.length + 1 }, (_, k) => k);
  for (let i = 1; i <= one.length; i++) {
    const row = [i];
    for (let k = 1; k <= other.length; k++) {
      row[k] = Math.min(row[k - 1] + 1, last[k] + 1, last[k - 1] + (one[i - 1] !== other[k - 1]));
      if (i > 1 && k > 1 && one[i - 1] === other[k - 2] && one[i - 2] === other[k - 1]) {
        row[k] = Math.min(row[k], before[k - 2] + 1);
      }
    }
    before = last;
    last = row;
  }
  return last[other.length];
}

// Says above the results which words were taken for others: stems of the index, as the question and titles have them.
function sayRead(search, query, read) {
  if (!search.output || !read.length) return;
  const stemmer = new Stemmer(), split = (text) => splitQuery(text.toLowerCase());
  const asked = split(query), known = split(search._index.titles.join(" "));
  const whole = (words, stem) => words.find((word) => stemmer.stemWord(word) === stem) ?? stem;
  const said = document.createElement("p");
  said.textContent = read.map(([word, term]) => `No page has “${whole(asked, word)}”: these have “${whole(known, term)}”.`).join(" ");
  search.output.before(said);
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
    const scores = new Map(), matched = new Map(), read = [];
    for (const asked of searchTerms) {
      let word = asked;
      const weights = new Map();
      const add = (file, weight) => weights.set(file, Math.max(weights.get(file) || 0, weight));
      const addBody = (files, weight) => {
        for (const file of list(files)) add(file, weight / (0.5 + (0.5 * sizes[file]) / mean));
      };
      const look = () => {
        if (Object.hasOwn(terms, word)) addBody(terms[word], 1);
        if (Object.hasOwn(titleterms, word)) addBody(titleterms[word], inHeading);
      };
      look();
      if (!weights.size && word.length >= shortest) {
        for (const term of Object.keys(terms)) if (term.includes(word)) addBody(terms[term], partly);
      }
      const near = weights.size ? null : nearestTerm(word, terms);
      if (near !== null) {
        read.push([word, near]);
        word = near;
        look();
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
    search.read = read;
    const results = [];
    for (const [file, score] of scores) {
      const share = matched.get(file) / searchTerms.size;
      if (share >= 0.5) results.push([docnames[file], titles[file], "", null, score * share, filenames[file], "text"]);
    }
    return results;
  };
}
