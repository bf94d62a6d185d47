// Small plots of what is measured over time: load, loss, latency.
import { colours } from "./colours.js";
import { prepared, stroke, word } from "./shapes.js";
import { ticks, value } from "./words.js";

const LEAST_S = 0.05;
const FEW = 40; // points that are marked one by one
const GUTTER = 46; // px on the left, for values
const SIDE = 14;
const HEAD = 8;
const FOOT = 18; // px below, for times
const FONT = "11px system-ui, sans-serif";

/** What happened to the network, as upright lines: by the log's marks. */
const EVENTS = {
  loss: { colour: "alarm", dash: [4, 3], words: "in plots: cut or switched off" },
  return: { colour: "good", dash: [1.5, 2.5], words: "put back" },
};

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
    const from = Math.max(first, to - this.network.span(series.id));
    const span = Math.max(LEAST_S, to - from);
    const curves = this.network.curves(series.id, from);
    const shown = curves.flat();
    const most = nice(Math.max(0, ...shown.map(([, v]) => v)));
    const across = (t) => GUTTER + ((t - from) / span) * (width - GUTTER - SIDE);
    const up = (v) => height - FOOT - (v / most) * (height - FOOT - HEAD);
    this.#scales(context, { width, height, up, across, most, from, to: from + span, series });
    const curve = new Path2D();
    for (const [i, [t, v]] of curves.flatMap((one) => [...one.entries()])) {
      const at = [across(Math.max(t, from)), up(v)];
      curve[i ? "lineTo" : "moveTo"](...at);
    }
    for (const [t, v] of shown.length < FEW ? shown : []) {
      const [x, y] = [across(Math.max(t, from)), up(v)];
      curve.moveTo(x + 1.5, y);
      curve.arc(x, y, 1.5, 0, 7);
    }
    context.lineJoin = "round";
    stroke(context, colours.accent, 1.8, curve);
    if (!shown.length) {
      const isOver = points.some(([, v]) => v !== null);
      const text = !isOver ? "nothing yet"
        : this.network.hasGaps ? "no data" : "nothing in this time";
      context.textAlign = "center";
      word(context, text, (GUTTER + width - SIDE) / 2, up(most / 2), colours.soft, colours.panel,
        FONT);
    }
    for (const [name, look] of Object.entries(EVENTS)) {
      const path = new Path2D();
      for (const t of this.network.marks[name].filter((at) => at >= from)) {
        path.moveTo(across(t), 2);
        path.lineTo(across(t), height - FOOT);
      }
      stroke(context, colours[look.colour], 1.8, path, look.dash);
    }
  }

  /** Values in the gutter on the left, times below. */
  #scales(context, { width, height, up, across, most, from, to, series }) {
    const lines = new Path2D(`M${GUTTER} ${up(0)}H${width - SIDE}M${GUTTER} ${up(most)}`
      + `H${width - SIDE}`);
    context.font = FONT;
    context.textAlign = "right";
    for (const v of [0, most]) {
      const whole = value(v, v ? series.unit : "");
      const fits = context.measureText(whole).width <= GUTTER - 8; // the plot's head has the unit
      const text = fits ? whole : value(v, "");
      word(context, text, GUTTER - 5, up(v), colours.soft, colours.panel, FONT);
    }
    context.textAlign = "center";
    const many = Math.max(4, Math.floor((width - GUTTER) / 65));
    for (const [t_s, text] of ticks(from, to, many)) {
      const x = across(t_s);
      lines.moveTo(x, up(0));
      lines.lineTo(x, up(0) + 3);
      const half = 0.5 * context.measureText(text).width;
      if (x - half < GUTTER - 12 || x + half > width) continue;
      word(context, text, x, height - 6, colours.soft, colours.panel, FONT);
    }
    stroke(context, colours.faint, 1, lines);
  }
}

/** Samples of the events in plots, for the legend. */
export function eventSamples() {
  return Object.values(EVENTS).map(({ colour, dash, words }) => [(context) => {
    stroke(context, colours[colour], 1.8, new Path2D("M13 0v16"), dash);
  }, words]);
}

/** The next round number at or above a value. */
function nice(v) {
  if (v <= 0) return 1;
  const ten = 10 ** Math.floor(Math.log10(v));
  return [1, 1.5, 2, 2.5, 3, 4, 5, 6, 8, 10].map((n) => n * ten).find((n) => n >= v * 0.999);
}
