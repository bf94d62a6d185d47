// The colours of the style sheet for drawing on a canvas, and light, dark or as the system has it.

const NAMES = ["ground", "panel", "ink", "soft", "faint", "link", "alarm", "warn", "good",
  "accent"];
const SHADES = 8;
const dark = matchMedia("(prefers-color-scheme: dark)");
const KEY = "innervate-colours";
const CHOICES = ["auto", "light", "dark"];

/**
 * Colours by name; `p`, `d` and `h` are ports, depth and heat, eight of each, and `on` what is best
 * written on each of them, as `on.h7`.
 */
export const colours = { p: [], d: [], h: [], on: {} };

function read() {
  const style = getComputedStyle(document.documentElement);
  const of = (name) => style.getPropertyValue(`--${name}`).trim();
  for (const name of NAMES) colours[name] = of(name);
  for (const family of "pdh") {
    colours[family] = Array.from({ length: SHADES }, (_, i) => of(`${family}${i}`));
    colours[family].forEach((fill, i) => (colours.on[`${family}${i}`] = readable(fill)));
  }
}

/** Which of the shades stands for a value of 0 .. most. */
export function shade(value, most) {
  return most > 0 ? Math.max(0, Math.min(SHADES - 1, Math.floor((SHADES * value) / most))) : 0;
}

/** Ink or ground: what can be read better on a colour, a "#rrggbb". */
function readable(fill) {
  const on = light(fill);
  const contrast = (other) => (Math.max(on, other) + 0.05) / (Math.min(on, other) + 0.05);
  const isInk = contrast(light(colours.ink)) >= contrast(light(colours.ground));
  return isInk ? colours.ink : colours.ground;
}

/** Relative luminance of a colour (WCAG 2). */
function light(colour) {
  const part = (at) => {
    const share = parseInt(colour.slice(at, at + 2), 16) / 255;
    return share <= 0.04045 ? share / 12.92 : ((share + 0.055) / 1.055) ** 2.4;
  };
  return 0.2126 * part(1) + 0.7152 * part(3) + 0.0722 * part(5);
}

function stored() {
  try {
    return localStorage.getItem(KEY);
  } catch {
    return null; // a browser that keeps nothing
  }
}

/** Let a button choose the colours; `onChange` draws anew. Returns what makes the next choice. */
export function setUpTheme(button, onChange) {
  let choice = CHOICES.includes(stored()) ? stored() : "auto";
  const show = () => {
    const is = choice === "auto" ? (dark.matches ? "dark" : "light") : choice;
    document.documentElement.dataset.theme = is;
    button.textContent = `Theme: ${choice}`;
    read();
    onChange();
  };
  const next = () => {
    choice = CHOICES[(CHOICES.indexOf(choice) + 1) % CHOICES.length];
    try {
      localStorage.setItem(KEY, choice);
    } catch {
      // chosen for this page alone
    }
    show();
  };
  button.addEventListener("click", next);
  dark.addEventListener("change", show);
  show();
  return next;
}
