// The legend: a sample of everything that can be seen, with its meaning.

import { eventSamples } from "./plots.js";

const WIDE = 26;
const HIGH = 16;

/** Show a view's legend: pairs of a function that draws a sample, and words. */
export function showLegend(list, view) {
  const ratio = Math.min(devicePixelRatio, 2);
  list.replaceChildren(...[...view.legend(), ...eventSamples()].map(([draw, text]) => {
    const item = document.createElement("li");
    const canvas = document.createElement("canvas");
    canvas.width = WIDE * ratio;
    canvas.height = HIGH * ratio;
    canvas.setAttribute("aria-hidden", "true");
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    draw(context, WIDE, HIGH);
    const words = document.createElement("span");
    words.textContent = text;
    item.append(canvas, words);
    return item;
  }));
}
