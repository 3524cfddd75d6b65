// Theme, filters, and pictures that are put in when their trial is first opened. All texts are in the page already.

const $ = (id) => document.getElementById(id);
const DARK = matchMedia("(prefers-color-scheme: dark)");
let chosenTheme = null;

function dress() {
  document.documentElement.dataset.theme = chosenTheme ?? (DARK.matches ? "dark" : "light");
}

$("theme").addEventListener("click", () => {
  chosenTheme = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
  dress();
});
DARK.addEventListener("change", dress);
dress();

const pictures = JSON.parse($("pictures").textContent);

function showPictures(trial) {
  for (const image of trial.querySelectorAll("image[data-picture]:not([href])")) {
    const data = pictures[image.dataset.picture];
    if (data) image.setAttribute("href", "data:image/png;base64," + data);
  }
}

/** Scroll each file to its first marked line. */
function showMarkedLines(trial) {
  for (const file of trial.querySelectorAll("pre.code")) {
    const line = file.querySelector(".marked");
    if (line) file.scrollTop = line.offsetTop - file.clientHeight / 3;
  }
}

for (const trial of document.querySelectorAll("details.trial")) {
  trial.addEventListener("toggle", () => {
    if (!trial.open) return;
    showPictures(trial);
    showMarkedLines(trial);
  });
}

const cases = [...document.querySelectorAll("details.case")].map((element) => ({
  element,
  categories: element.dataset.categories.split(" "),
  words: element.dataset.words,
  trials: [...element.querySelectorAll("details.trial")],
  chips: [...element.querySelectorAll(":scope > summary .chip")],
}));

function filter() {
  const [arm, result, category] = ["arm", "result", "category"].map((id) => $(id).value);
  const wishes = $("words").value.toLowerCase().split(",").map((wish) => wish.split(/\s+/).filter(Boolean)).filter((wish) => wish.length);
  let shown = 0, trialsShown = 0, all = 0;
  for (const one of cases) {
    let fitting = 0;
    const named = !wishes.length || wishes.some((wish) => wish.every((word) => one.words.includes(word)));
    const fits = named && (!category || one.categories.includes(category));
    one.trials.forEach((trial, place) => {
      const kept = fits && (!arm || trial.dataset.arm === arm) && (!result || trial.dataset.passed === result);
      trial.hidden = one.chips[place].hidden = !kept;
      fitting += kept;
    });
    one.element.hidden = !fitting;
    shown += fitting > 0;
    trialsShown += fitting;
    all += one.trials.length;
  }
  $("count").textContent = `${shown} of ${cases.length} cases, ${trialsShown} of ${all} answers`;
}

for (const id of ["arm", "result", "category"]) $(id).addEventListener("change", filter);
$("words").addEventListener("input", filter);
$("filters").addEventListener("submit", (event) => event.preventDefault());
$("open").addEventListener("click", () => cases.forEach(({ element }) => (element.open = !element.hidden)));
$("close").addEventListener("click", () => document.querySelectorAll("details").forEach((one) => (one.open = false)));

// A link to a case or to an answer opens it.
function follow() {
  const target = location.hash && $(decodeURIComponent(location.hash.slice(1)));
  if (!target) return;
  for (let one = target; one; one = one.parentElement) if (one.tagName === "DETAILS") one.open = true;
  target.scrollIntoView();
}

addEventListener("hashchange", follow);
addEventListener("beforeprint", () => document.querySelectorAll("details.trial").forEach(showPictures));
filter();
follow();
