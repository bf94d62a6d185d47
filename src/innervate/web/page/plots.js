// Small plots of what is measured over time: load, loss, latency.
import { colours } from "./colours.js";
import { prepared, stroke, word } from "./shapes.js";
import { value } from "./words.js";

const SPAN_S = 10; // of the network's time, at most
const LEAST_S = 0.05;
const FEW = 40; // points that are marked one by one
const SIDE_PX = 10;

/** One small plot for each series of a scene. */
export class Plots {
  constructor(box, network) {
    this.network = network;
    this.plots = network.scene.series.map((series) => this.#make(series));
    box.replaceChildren(...this.plots.map(({ box: one }) => one));
  }

  #make(series) {
    const box = document.createElement("div");
    box.className = "plot";
    const line = document.createElement("p");
    const name = document.createElement("span");
    name.textContent = series.label;
    const last = document.createElement("b");
    line.append(name, last);
    const canvas = document.createElement("canvas");
    canvas.setAttribute("role", "img");
    box.append(line, canvas);
    return { box, series, last, canvas };
  }

  draw() {
    for (const plot of this.plots) {
      const points = this.network.series.get(plot.series.id);
      const last = points.at(-1)?.[1];
      const said = last === undefined || last === null ? "–" : value(last, plot.series.unit);
      plot.last.textContent = said;
      plot.canvas.setAttribute("aria-label", `${plot.series.label} over time, now ${said}`);
      this.#curve(plot, points);
    }
  }

  #curve({ canvas, series }, points) {
    const { clientWidth: width, clientHeight: height } = canvas;
    if (!width) return;
    const context = prepared(canvas, width, height);
    const to = this.network.now.t_s;
    const first = points[0]?.[0] ?? 0;
    const from = Math.max(first, to - SPAN_S);
    const span = Math.max(LEAST_S, to - from);
    const shown = points.filter(([t, v], i) => v !== null && (points[i + 1]?.[0] ?? t) >= from);
    const most = nice(Math.max(0, ...shown.map(([, v]) => v)));
    const across = (t) => SIDE_PX + ((t - from) / span) * (width - 2 * SIDE_PX);
    const up = (v) => height - 6 - (v / most) * (height - 14);
    const lines = new Path2D(`M${SIDE_PX} ${up(0)}H${width - SIDE_PX}M${SIDE_PX} ${up(most)}`
      + `H${width - SIDE_PX}`);
    stroke(context, colours.faint, 1, lines);
    const cuts = new Path2D();
    for (const t of this.network.cuts_s.filter((at) => at >= from)) {
      cuts.moveTo(across(t), 4);
      cuts.lineTo(across(t), height - 6);
    }
    stroke(context, colours.alarm, 1.2, cuts, [4, 3]);
    const curve = new Path2D();
    const marks = shown.map(([t, v]) => [across(Math.max(t, from)), up(v)]);
    marks.forEach((at, i) => curve[i ? "lineTo" : "moveTo"](...at));
    for (const [x, y] of marks.length < FEW ? marks : []) {
      curve.moveTo(x + 1.5, y);
      curve.arc(x, y, 1.5, 0, 7);
    }
    context.lineJoin = "round";
    stroke(context, colours.accent, 1.8, curve);
    this.#most(context, width, up(most), value(most, series.unit), marks);
  }

  /** What the upper line stands for; the lower one is 0. It stands where no curve is, if it can. */
  #most(context, width, y, text, marks) {
    const font = "10px system-ui, sans-serif";
    context.font = font;
    const wide = context.measureText(text).width + 8;
    const places = [SIDE_PX, width / 2 - wide / 2, width - SIDE_PX - wide];
    const high = (x) => Math.min(...heights(marks, x - 6, x + wide));
    const free = places.find((x) => high(x) > y + 16) ?? SIDE_PX;
    context.textAlign = "left";
    word(context, text, free, y + 8, colours.soft, colours.panel, font);
  }
}

/** How high a curve gets between two places, y in px: its points there and where it enters. */
function heights(marks, left, right) {
  const found = [Infinity];
  marks.forEach(([x, y], i) => {
    if (x >= left && x <= right) found.push(y);
    const [x1, y1] = marks[i + 1] ?? [x, y];
    for (const edge of [left, right]) {
      if (x < edge && edge < x1) found.push(y + ((edge - x) / (x1 - x)) * (y1 - y));
    }
  });
  return found;
}

/** The next round number at or above a value. */
function nice(v) {
  if (v <= 0) return 1;
  const ten = 10 ** Math.floor(Math.log10(v));
  return [1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10].map((n) => n * ten).find((n) => n >= v * 0.999);
}
