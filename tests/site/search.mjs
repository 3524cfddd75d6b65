// Asks the search of the site: node search.mjs HTML < questions as a list in JSON; answers a list of lists of pages.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import vm from "node:vm";

const html = process.argv[2];
const element = { querySelectorAll: () => [], addEventListener: () => {}, appendChild: () => ({}), dataset: {} };
const context = vm.createContext({
  console, URLSearchParams,
  document: { ...element, documentElement: element, body: element, getElementById: () => null, readyState: "loading" },
  location: { search: "" }, localStorage: { setItem: () => {} }, SPHINX_HIGHLIGHT_ENABLED: false,
  DOCUMENTATION_OPTIONS: {}, _: (text) => text, _ready: () => {},
  _removeChildren: () => {}, _escapeRegExp: (text) => text.replace(/[.*+?^${}()|[\]\\]/g, "\\$&"),
});
context.window = context;
for (const name of ["_static/language_data.js", "_static/searchtools.js", "searchindex.js"]) {
  vm.runInContext(readFileSync(join(html, name), "utf8"), context, { filename: name });
}
vm.runInContext("improve(Search);", context);
const questions = JSON.parse(readFileSync(0, "utf8"));
context.questions = questions;
const found = vm.runInContext(
  `questions.map((one) => { const asked = Search._parseQuery(one);
     return Search._performSearch(...asked).reverse().map((item) => item[0] + (item[2] || "")); })`, context);
console.log(JSON.stringify(found));
