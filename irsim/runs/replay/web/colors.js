// Colours of the theme; those of objects come with the run, in a shade for each use.

const NAMES = [
  "paper", "outside", "ink", "muted", "line", "grid", "wall", "rock", "still-edge", "person", "person-head", "accent",
  "danger", "good", "warn", "on-accent", "card",
];
const SHADES = ["fill", "edge", "name", "dart"];

/** Shapes and sizes of signs, which the style sheet has from the same table as pictures. */
export const GLYPHS = JSON.parse(getComputedStyle(document.documentElement).getPropertyValue("--glyphs").trim().slice(1, -1));

export function themeColors() {
  const root = document.documentElement, style = getComputedStyle(root);
  const colors = Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
  return { ...colors, theme: root.dataset.theme };
}

export function rgbOf(color) {
  return [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));
}

/** The colour of an object for its `fill`, its `edge` and other thin things, its `name`, or the `dart` in it. */
export const shade = (colors, object, use) => object.shades[colors.theme][SHADES.indexOf(use)];
