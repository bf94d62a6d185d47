// Stations of a radio channel, around, with what each one does at the moment.
import { colours } from "./colours.js";
import { Labels } from "./labels.js";
import { LAYERS } from "./stage.js";
import { affected, affectedSample, cross, stroke, word } from "./shapes.js";
import { boxSamples } from "./timeline.js";
import { off, offWords } from "./words.js";

/** What a station does: letter in its disc, words, colour. The numbers are those of a state. */
export const DOING = [
  { sign: "", words: "idle", colour: () => colours.panel },
  { sign: "S", words: "sends", colour: () => colours.p[0] },
  { sign: "R", words: "receives", colour: () => colours.p[2] },
  { sign: "X", words: "hears several at once", colour: () => colours.p[1] },
  { sign: "W", words: "waits its turn", colour: () => colours.p[7] },
  { sign: "T", words: "in its turnaround, deaf", colour: () => colours.panel },
];
const [SENDS, RECEIVES, SEVERAL, WAITS, TURNS] = [1, 2, 3, 4, 5];
const RING_PX = 15;
const NAME_PX = 13; // from a station to its name: the ring round what is selected lies between
const WORDS_PX = 55; // from this radius on there is room for words in the middle
const LINE_PX = 13;
const FONT = "12px system-ui, sans-serif";

/** Draws stations round a circle on a stage. */
export class RadioView {
  constructor(network) {
    this.network = network;
    this.colour = "";
    this.margin = [76, 52];
    const count = network.nodes.length;
    network.place = network.nodes.map((_, i) => {
      const turn = (2 * Math.PI * i) / count - Math.PI / 2;
      return [Math.cos(turn), Math.sin(turn)];
    });
  }

  choices() {
    return [];
  }

  bounds() {
    return [-1.02, -1.02, 1.02, 1.02];
  }

  layersOf(changed) {
    const any = ["radio", "node_up", "headline"].some((name) => changed.has(name));
    return any ? [LAYERS.ground] : [];
  }

  linkFirst() {
    return false;
  }

  linkDistance() {
    return Infinity;
  }

  size(scale) {
    const apart = (2 * Math.PI * scale) / this.network.nodes.length;
    return Math.min(2 * RING_PX, 0.8 * apart);
  }

  reach(scale) {
    return 0.5 * this.size(scale) + 4;
  }

  facts(i) {
    const { now, radio } = this.network;
    if (!now.node_up[i]) return off(this.network, i);
    const turn = radio.turn[i] > 0 ? `, turn ${radio.turn[i]}` : "";
    return `${DOING[radio.now[i]].words}${turn}`;
  }

  legend() {
    const disc = (state, up = 1) => (context) => this.#disc(context, 13, 8, 7, state, up);
    const { source, turnaround_us: turnaround } = this.network.scene;
    const isLive = source === "live"; // what is asked now and then has no boxes
    const known = isLive ? [0, SENDS, WAITS]
      : [...DOING.keys()].filter((state) => state !== TURNS || turnaround);
    return [...known.map((state) => [disc(state), DOING[state].words]),
      [disc(0, 0), offWords(this.network)], affectedSample, ...(isLive ? [] : boxSamples())];
  }

  draw(layer, context, stage) {
    stage.clear(context);
    if (layer !== LAYERS.ground) return;
    const { now, nodes, radio } = this.network;
    const [x0, y0] = stage.of([0, 0]);
    const radius = 0.5 * this.size(stage.scale);
    this.#waves(context, stage, x0, y0);
    nodes.forEach((_, i) => {
      this.#disc(context, stage.x[i], stage.y[i], radius, radio.now[i], now.node_up[i]);
    });
    if (radius >= 6) this.#names(context, stage, x0, y0);
    affected(context, this.network, stage, radius + 5);
  }

  /** Stations' names beside them, looking away from the middle; their turns if all find room. */
  #names(context, stage, x0, y0) {
    const { nodes, radio } = this.network;
    const radius = 0.5 * this.size(stage.scale);
    const room = new Labels(context, stage.width, stage.height);
    nodes.forEach((_, i) => room.block(stage.x[i] - radius, stage.y[i] - radius,
      stage.x[i] + radius, stage.y[i] + radius));
    context.font = FONT;
    const names = nodes.map(({ label }) => [short(label)]);
    const whole = names.map((lines, i) => (
      radio.turn[i] > 0 ? [...lines, `turn ${radio.turn[i]}`] : lines));
    const place = (lines, i) => placed(context, stage, i, lines, x0, y0, radius);
    const fits = whole.every((lines, i) => room.claim(...place(lines, i).box));
    (fits ? whole : names).forEach((lines, i) => {
      const { align, x, y } = place(lines, i);
      context.textAlign = align;
      lines.forEach((text, n) => {
        const shift = LINE_PX * (n - (lines.length - 1) / 2);
        word(context, text, x, y + shift, colours.soft, colours.ground, FONT);
      });
    });
  }

  /** Who sends now, to the middle of the ring. */
  #waves(context, stage, x0, y0) {
    const { radio, now } = this.network;
    const senders = radio.now.flatMap((state, i) => (state === SENDS && now.node_up[i] ? [i] : []));
    const path = new Path2D();
    for (const i of senders) {
      path.moveTo(stage.x[i], stage.y[i]);
      path.lineTo(x0, y0);
    }
    stroke(context, senders.length > 1 ? colours.alarm : colours.accent, 2.4, path,
      senders.length > 1 ? [6, 4] : []);
    if (stage.scale < WORDS_PX) return;
    const isHeard = radio.now.some((state, i) => (
      now.node_up[i] && (state === RECEIVES || state === SEVERAL))); // the end is still on its way
    const text = this.network.isSilent() ? "nobody answers"
      : [isHeard ? "nobody sends" : "channel free", "one sends", "several send"]
        .at(Math.min(2, senders.length));
    context.font = "600 13px system-ui, sans-serif";
    const wide = context.measureText(text).width + 10;
    context.fillStyle = colours.ground; // lines to the middle end before the words
    context.fillRect(x0 - wide / 2, y0 - 10, wide, 20);
    context.textAlign = "center";
    word(context, text, x0, y0, senders.length > 1 ? colours.alarm : colours.ink, colours.ground,
      "600 13px system-ui, sans-serif");
  }

  #disc(context, x, y, radius, state, up) {
    const path = new Path2D();
    path.arc(x, y, radius, 0, 7);
    context.fillStyle = up ? DOING[state].colour() : colours.faint;
    context.fill(path);
    stroke(context, up && state ? colours.ink : colours.soft, up && state ? 1.8 : 1.2, path);
    if (!up) {
      const off = new Path2D();
      cross(off, x, y, 0.6 * radius);
      stroke(context, colours.alarm, 2.2, off);
    } else if (DOING[state].sign && radius >= 6) {
      context.textAlign = "center";
      context.textBaseline = "middle";
      context.font = `600 ${Math.min(13, 1.3 * radius)}px system-ui, sans-serif`;
      context.fillStyle = colours.ink;
      context.fillText(DOING[state].sign, x, y + 0.5);
    }
  }
}

/** Where lines beside a station stand, and the box that they fill. */
function placed(context, stage, i, lines, x0, y0, radius) {
  const away = Math.hypot(stage.x[i] - x0, stage.y[i] - y0) || 1;
  const [dx, dy] = [(stage.x[i] - x0) / away, (stage.y[i] - y0) / away];
  const wide = Math.max(...lines.map((text) => context.measureText(text).width));
  const high = LINE_PX * lines.length;
  const x = stage.x[i] + dx * (radius + NAME_PX);
  const y = stage.y[i] + dy * (radius + NAME_PX + (lines.length > 1 ? 8 : 2));
  const align = dx > 0.3 ? "left" : dx < -0.3 ? "right" : "center";
  const left = x - { left: 0, center: 0.5, right: 1 }[align] * wide;
  return { align, x, y, box: [left - 2, y - high / 2, left + wide + 2, y + high / 2] };
}

function short(label) {
  return label.replace(/^station /, "");
}
