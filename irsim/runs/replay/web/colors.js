// Colours of the theme, and those of the scenario where they can be told from the paper.

const NAMES = ["paper", "outside", "ink", "muted", "line", "grid", "wall", "accent", "danger", "good", "lidar", "card"];
const LEAST_CONTRAST = 1.7;

export function themeColors() {
  const style = getComputedStyle(document.documentElement);
  const colors = Object.fromEntries(NAMES.map((name) => [name, style.getPropertyValue(`--${name}`).trim()]));
  return { ...colors, adapted: new Map() };
}

export function rgbOf(color) {
  return [1, 3, 5].map((at) => parseInt(color.slice(at, at + 2), 16));
}

/** A colour of the scenario; mixed with that of walls where it would not be seen on the paper. */
export function seen(colors, color) {
  let found = colors.adapted.get(color);
  if (!found) {
    const own = rgbOf(color), wall = rgbOf(colors.wall);
    const mix = own.map((value, i) => Math.round(0.15 * value + 0.85 * wall[i]));
    found = contrast(own, rgbOf(colors.paper)) < LEAST_CONTRAST || isBlack(own) ? hex(mix) : color;
    colors.adapted.set(color, found);
  }
  return found;
}

/** Black or white, whichever is seen better on a colour. */
export function opposite(color) {
  return luminance(rgbOf(color)) > 0.35 ? "#10151b" : "#ffffff";
}

const isBlack = (rgb) => Math.max(...rgb) < 24;
const hex = (rgb) => `#${rgb.map((value) => value.toString(16).padStart(2, "0")).join("")}`;

function luminance(rgb) {
  const [r, g, b] = rgb.map((value) => (value / 255) ** 2.2);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b;
}

function contrast(one, other) {
  const [dark, light] = [luminance(one), luminance(other)].sort((a, b) => a - b);
  return (light + 0.05) / (dark + 0.05);
}
