// The running timeline of a radio channel: a lane for each station, boxes for what it sent.
import { colours } from "./colours.js";
import { cross, prepared, stroke, word } from "./shapes.js";
import { ticks } from "./words.js";

const LEFT = 74;
const TOP = 8;
const BOTTOM = 22;
const WALL_S = 4; // so much of the reader's time is in sight
const SPAN_S = [0.002, 10];
const LANE_PX = 40;
const RIM_PX = 4; // a narrower box is all of its colour, without a rim

/** How boxes look, as in reports: letter, height as a share of the lane's, fill. */
const BOXES = {
  frame: { letter: "D", high: 1, fill: () => colours.p[0], words: "data" },
  voc: { letter: "O", high: 1, fill: () => colours.p[2], words: "opening of a sequence" },
  cr: { letter: "C", high: 0.45, fill: () => colours.p[1], words: "CR-R: collision report" },
  ack: { letter: "R", high: 0.72, fill: () => colours.p[3], words: "report: who was heard" },
  collision: { letter: "", high: 1, fill: () => colours.ground, words: "collided", struck: true },
};

/** The timeline below the stations; it follows the network's time. */
export class Timeline {
  constructor(box) {
    this.box = box;
    this.network = null;
    this.canvas = document.createElement("canvas");
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "Timeline of the channel: who sent when");
    box.append(this.canvas);
    this.drawn = "";
  }

  draw() {
    const { network, box } = this;
    if (!network || box.hidden) return;
    const { clientWidth: width, clientHeight: height } = box;
    if (!width) return;
    const theme = colours.ground;
    const last = network.timeline.at(-1);
    const { t_s: to, speed, at_end: atEnd } = network.now;
    const kept = [network.timeline.length, last?.to_s];
    const state = [to, speed, atEnd, ...kept, width, height, theme].join();
    if (state === this.drawn) return;
    this.drawn = state;
    this.context = prepared(this.canvas, width, height);
    const all = to - (network.timeline[0]?.from_s ?? 0);
    // At the end all that was sent, and not a corner of an empty window.
    const wanted = atEnd ? all : WALL_S * (speed || SPAN_S[1]);
    const span = Math.max(SPAN_S[0], Math.min(SPAN_S[1], wanted));
    const from = Math.max(0, to - span);
    const across = (t) => LEFT + ((t - from) / span) * (width - LEFT - 12);
    const lane = Math.min(LANE_PX, (height - TOP - BOTTOM) / network.nodes.length);
    this.#lanes(width, lane);
    this.#ticks(from, from + span, across, TOP + lane * network.nodes.length);
    this.#boxes(from, to, across, lane);
  }

  #lanes(width, lane) {
    const { context, network } = this;
    const lines = new Path2D();
    const every = Math.max(1, Math.ceil(13 / lane));
    context.textAlign = "right";
    network.nodes.forEach((node, i) => {
      const y = TOP + lane * (i + 0.92);
      if (i % every === 0) {
        lines.moveTo(LEFT, y);
        lines.lineTo(width - 12, y);
        word(context, node.label, LEFT - 6, y - 0.42 * lane, colours.soft, colours.ground,
          "11px system-ui, sans-serif");
      }
    });
    stroke(context, colours.faint, 1, lines);
  }

  #ticks(from, to, across, bottom) {
    const { context } = this;
    const lines = new Path2D();
    context.textAlign = "center";
    for (const [t_s, text] of ticks(from, to, 6)) {
      const x = across(t_s);
      lines.moveTo(x, TOP);
      lines.lineTo(x, bottom + 4);
      const right = across(to);
      if (x > LEFT + 20 && x < right - 20) {
        word(context, text, x, bottom + 13, colours.soft, colours.ground,
          "11px system-ui, sans-serif");
      }
    }
    stroke(context, colours.faint, 1, lines);
  }

  #boxes(from, to, across, lane) {
    const { context, network } = this;
    const struck = new Path2D();
    context.font = "600 11px system-ui, sans-serif";
    for (const box of network.timeline) {
      if (box.to_s < from || box.from_s > to) continue;
      const row = network.index.get(box.station) ?? -1;
      const look = BOXES[box.kind] ?? BOXES.frame;
      if (row < 0) continue;
      const left = Math.max(LEFT, across(box.from_s));
      const wide = Math.max(1.3, across(Math.min(box.to_s, to)) - left);
      const high = 0.84 * lane * look.high;
      const top = TOP + lane * (row + 0.92) - high;
      context.fillStyle = look.fill();
      context.fillRect(left, top, wide, high);
      context.strokeStyle = look.struck ? colours.alarm : colours.soft;
      context.lineWidth = look.struck ? 1.6 : 0.8;
      if (look.struck || wide >= RIM_PX) context.strokeRect(left, top, wide, high);
      if (look.struck) {
        cross(struck, left + wide / 2, top + high / 2, Math.min(4, wide / 2, high / 2));
      } else if (wide > 9 * look.letter.length + 3 && high >= 11) {
        context.fillStyle = colours.ink;
        context.textAlign = "center";
        context.textBaseline = "middle";
        context.fillText(look.letter, left + wide / 2, top + high / 2 + 0.5);
      }
    }
    stroke(context, colours.alarm, 1.8, struck);
  }
}

/** Samples for the legend. */
export function boxSamples() {
  return Object.values(BOXES).map((look) => [(context) => {
    const high = 14 * look.high;
    context.fillStyle = look.fill();
    context.fillRect(2, 15 - high, 22, high);
    context.strokeStyle = look.struck ? colours.alarm : colours.soft;
    context.strokeRect(2, 15 - high, 22, high);
    if (look.struck) {
      const path = new Path2D();
      cross(path, 13, 8, 4);
      stroke(context, colours.alarm, 1.8, path);
    } else if (high > 10) {
      context.font = "600 11px system-ui, sans-serif";
      context.fillStyle = colours.ink;
      context.textAlign = "center";
      context.textBaseline = "middle";
      context.fillText(look.letter, 13, 16 - high / 2);
    }
  }, look.words]);
}
