// Stations of a radio channel, around, with what each one does at the moment.
import { colours } from "./colours.js";
import { LAYERS } from "./stage.js";
import { affected, affectedSample, cross, stroke, word } from "./shapes.js";
import { boxSamples } from "./timeline.js";
import { off, offWord } from "./words.js";

/** What a station does: letter in its disc, words, colour. The numbers are those of a state. */
export const DOING = [
  { sign: "", words: "idle", colour: () => colours.panel },
  { sign: "S", words: "sends", colour: () => colours.p[0] },
  { sign: "R", words: "receives", colour: () => colours.p[2] },
  { sign: "X", words: "hears several at once", colour: () => colours.p[1] },
  { sign: "W", words: "waits its turn", colour: () => colours.p[7] },
];
const [SENDS, WAITS] = [1, 4];
const RING_PX = 15;
const NAME_PX = 13; // from a station to its name: the ring round what is selected lies between
const WORDS_PX = 55; // from this radius on there is room for words in the middle
const TURNS_PX = 34; // from this distance on there is room for turns below names

/** Draws stations round a circle on a stage. */
export class RadioView {
  constructor(network) {
    this.network = network;
    this.colour = "";
    this.margin = [76, 44];
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
    const isLive = this.network.scene.source === "live"; // what is asked now and then has no boxes
    const known = isLive ? [0, SENDS, WAITS] : DOING.keys();
    return [...[...known].map((state) => [disc(state), DOING[state].words]),
      [disc(0, 0), offWord(this.network)], affectedSample, ...(isLive ? [] : boxSamples())];
  }

  draw(layer, context, stage) {
    stage.clear(context);
    if (layer !== LAYERS.ground) return;
    const { now, nodes, radio } = this.network;
    const [x0, y0] = stage.of([0, 0]);
    const radius = 0.5 * this.size(stage.scale);
    this.#waves(context, stage, x0, y0);
    nodes.forEach((node, i) => {
      const [x, y] = [stage.x[i], stage.y[i]];
      this.#disc(context, x, y, radius, radio.now[i], now.node_up[i]);
      if (radius < 6) return;
      const away = Math.hypot(x - x0, y - y0) || 1;
      this.#name(context, i, x, y, (x - x0) / away, (y - y0) / away, stage.scale);
    });
    affected(context, this.network, stage, radius + 5);
  }

  /** A station's name and its turn, beside it, looking away from the middle. */
  #name(context, i, x, y, dx, dy, scale) {
    const radius = 0.5 * this.size(scale);
    const apart = (2 * Math.PI * scale) / this.network.nodes.length;
    const turn = this.network.radio.turn[i];
    const lines = [short(this.network.nodes[i].label)];
    if (turn > 0 && apart >= TURNS_PX) lines.push(`turn ${turn}`);
    context.textAlign = dx > 0.3 ? "left" : dx < -0.3 ? "right" : "center";
    const middle = y + dy * (radius + NAME_PX + (lines.length > 1 ? 8 : 2));
    const beside = x + dx * (radius + NAME_PX);
    lines.forEach((text, n) => {
      const shift = 13 * (n - (lines.length - 1) / 2);
      word(context, text, beside, middle + shift, colours.soft, colours.ground);
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
    const text = ["channel free", "one sends", "several send"][Math.min(2, senders.length)];
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

function short(label) {
  return label.replace(/^station /, "");
}
