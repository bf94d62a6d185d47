// A mesh: links by quality, routes to the gateway, robots that move, the fence and alarms.
import { colours } from "./colours.js";
import { Labels } from "./labels.js";
import { distance } from "./pointer.js";
import { LAYERS } from "./stage.js";
import {
  affected, affectedSample, arrow, boxRound, cross, cutSample, flightSample, flights, stroke, word,
} from "./shapes.js";
import { symbol } from "./symbols.js";
import { PUT_OUT, off, offWords, plural } from "./words.js";

const GOOD = 0.9; // links of this quality are drawn whole, worse ones dashed, poor ones dotted
const FAIR = 0.6;
const WAYS = ["", "no way to the gateway", "cut off from the gateway"];
const CROSS_PX = 7; // round the cross of a cut, where no name goes
export const NAME_PX = 9; // between a node and its name: the line round who is selected lies there
const DOT_PX = [3, 6]; // radius of a node: a quarter of what half of them are apart, within these
const HEAD_PX = 24; // so much of both ends of an arrow names keep off
const LINK_PX = 5; // how near a click must be to a link
const FONT = "12px system-ui, sans-serif";

/** Draws a mesh on a stage. */
export class MeshView {
  constructor(network) {
    this.network = network;
    this.margin = [30, 26];
    this.colour = "";
    this.moves = network.nodes.some((node) => node.role === "robot");
    this.apart = apart(network.place);
  }

  choices() {
    return [];
  }

  bounds() {
    const all = [...this.network.place, ...(this.network.scene.fence ?? []).flat()];
    const [left, top, right, bottom] = boxRound(all, 0);
    return boxRound(all, 0.04 * Math.max(right - left, bottom - top) || 1);
  }

  layersOf(changed) {
    const any = (...names) => names.some((name) => changed.has(name));
    const found = [];
    if (any("link_up", "node_up")) found.push(LAYERS.ground);
    if (any("parent", "node_up", "alarm", "outside", "leads", "headline")) found.push(LAYERS.lines);
    if (any("flights")) found.push(LAYERS.moving);
    return found;
  }

  draw(layer, context, stage) {
    stage.clear(context);
    if (layer === LAYERS.ground) this.#ground(context, stage);
    else if (layer === LAYERS.lines) this.#nodes(context, stage);
    else flights(context, this.network, stage, 4);
  }

  size(scale) {
    return 2 * this.dot(scale);
  }

  reach(scale) {
    return this.dot(scale) + 6;
  }

  linkFirst() {
    return false;
  }

  linkDistance(stage, link, x, y) {
    if (!this.network.isThere(link)) return Infinity;
    const [a, b] = this.network.ends[link];
    const away = distance(stage.x[a], stage.y[a], stage.x[b], stage.y[b], x, y, 0.15, 0.85);
    return away <= LINK_PX ? away : Infinity;
  }

  dot(scale) {
    const [least, most] = DOT_PX;
    return Math.max(least, Math.min(most, 0.25 * this.apart * scale));
  }

  facts(i) {
    const { now, nodes } = this.network;
    const facts = [this.network.role(i)];
    if (!now.node_up[i]) return `${facts[0]}, ${off(this.network, i)}`;
    const next = this.network.parentOf(i);
    const lacks = now.put_out[i] ? PUT_OUT : WAYS[now.way[i]];
    if (lacks) facts.push(lacks);
    else if (next >= 0) facts.push(`sends to the gateway through ${nodes[next].label}`);
    if (next >= 0 && now.depth[i] > 0) facts.push(plural(now.depth[i], "hop"));
    if (now.outside[i]) facts.push("outside the fence");
    if (now.alarm[i]) facts.push("alarm");
    return facts.join(", ");
  }

  legend() {
    const roles = new Set(this.network.nodes.map((node) => node.role));
    const line = (colour, width, dash) => (context) => {
      const path = new Path2D("M1 8h24");
      stroke(context, colours[colour], width, path, dash);
    };
    const shape = (role, up = 1) => (context) => {
      symbol(context, 13, 8, role === "monitor" ? 3.5 : 5, role, up);
    };
    const found = [...roles].map((role) => [shape(role), role]);
    found.push([shape("node", 0), offWords(this.network)], affectedSample);
    found.push([line("soft", 1.4, []), "good link"], [line("soft", 1.4, [5, 4]), "fair"],
      [line("soft", 1.4, [1.5, 4]), "poor"]);
    found.push(cutSample);
    found.push([(context) => {
      const path = new Path2D();
      arrow(path, 0, 8, 26, 8, 1);
      stroke(context, colours.accent, 2.4, path);
    }, "way to the gateway"]);
    if (this.network.scene.source !== "live") {
      found.push(flightSample("ack", "ack or beacon"), flightSample("data", "message or table"));
    }
    if (!this.network.scene.fence) return found;
    found.push([line("ink", 2, []), "fence"]);
    if (this.network.scene.source !== "live") found.push(flightSample("alarm", "alarm on its way"));
    return found;
  }

  #ground(context, stage) {
    const { network } = this;
    const rings = network.scene.fence ?? [];
    const fence = new Path2D();
    for (const ring of rings) {
      ring.forEach((place, i) => fence[i ? "lineTo" : "moveTo"](...stage.of(place)));
      fence.closePath();
    }
    context.fillStyle = colours.panel;
    context.fill(fence, "evenodd");
    const paths = new Map();
    network.ends.forEach(([a, b], link) => {
      if (!network.isThere(link)) return;
      const { now, links } = network;
      const quality = links[link].quality ?? 1;
      const gone = !now.node_up[a] || !now.node_up[b];
      const kind = network.isCut(link) ? "cut" : gone ? "gone"
        : quality >= GOOD ? "good" : quality >= FAIR ? "fair" : "poor";
      if (!paths.has(kind)) paths.set(kind, new Path2D());
      const path = paths.get(kind);
      path.moveTo(stage.x[a], stage.y[a]);
      path.lineTo(stage.x[b], stage.y[b]);
    });
    const draw = (kind, colour, width, dash, alpha = 1) => {
      if (!paths.has(kind)) return;
      context.globalAlpha = alpha;
      stroke(context, colour, width, paths.get(kind), dash);
      context.globalAlpha = 1;
    };
    draw("gone", colours.soft, 1, [1, 7], 0.5);
    draw("poor", colours.soft, 1.2, [1.5, 4], 0.6);
    draw("fair", colours.soft, 1.2, [5, 4], 0.6);
    draw("good", colours.soft, 1.2, [], 0.5);
    draw("cut", colours.alarm, 2, [4, 3]);
    stroke(context, colours.ink, 2, fence);
    this.#gaps(context, stage);
    if (network.scene.metres) this.#measure(context, stage);
  }

  #gaps(context, stage) {
    const gaps = new Path2D();
    this.network.ends.forEach(([a, b], link) => {
      if (!this.network.isCut(link)) return;
      cross(gaps, (stage.x[a] + stage.x[b]) / 2, (stage.y[a] + stage.y[b]) / 2, 5);
    });
    stroke(context, colours.ground, 6, gaps);
    stroke(context, colours.alarm, 3, gaps);
  }

  /** A bar that says how long so many metres are, where nodes are drawn where they are. */
  #measure(context, stage) {
    const most = 130 / stage.scale;
    const ten = 10 ** Math.floor(Math.log10(most));
    const metres = ten * (most >= 5 * ten ? 5 : most >= 2 * ten ? 2 : 1);
    const [x, y] = [stage.width - 14 - metres * stage.scale, stage.height - 12];
    const bar = new Path2D(`M${x} ${y - 4}v4h${metres * stage.scale}v-4`);
    stroke(context, colours.soft, 1.2, bar);
    context.textAlign = "center";
    word(context, `${metres} m`, x + 0.5 * metres * stage.scale, y - 9, colours.soft,
      colours.ground, FONT);
  }

  #nodes(context, stage) {
    const { network } = this;
    const { now, nodes } = network;
    const routes = new Path2D();
    const dot = this.dot(stage.scale);
    nodes.forEach((_, i) => {
      const next = now.node_up[i] ? network.parentOf(i) : -1;
      if (next < 0) return;
      arrow(routes, stage.x[i], stage.y[i], stage.x[next], stage.y[next], dot + 4);
    });
    stroke(context, colours.accent, 2.2, routes);
    context.font = FONT;
    const names = new Labels(context, stage.width, stage.height);
    this.#keepOff(names, stage);
    for (const i of this.#firstTold().reverse()) { // who has a part to play lies above the others
      const [x, y] = [stage.x[i], stage.y[i]];
      symbol(context, x, y, dot, network.role(i), now.node_up[i]);
      names.node(x, y, dot + 2);
      if (now.alarm[i]) this.#ring(context, x, y, dot + 6, [], 3);
      else if (now.outside[i]) this.#ring(context, x, y, dot + 6, [4, 3], 2);
    }
    affected(context, network, stage, dot + 5);
    network.ends.forEach(([a, b], link) => {
      if (!network.isCut(link)) return;
      const [x, y] = [(stage.x[a] + stage.x[b]) / 2, (stage.y[a] + stage.y[b]) / 2];
      names.block(x - CROSS_PX, y - CROSS_PX, x + CROSS_PX, y + CROSS_PX);
    });
    this.#names(context, stage, names, dot);
  }

  /** Names keep off the fence and both ends of arrows, where there is room. */
  #keepOff(names, stage) {
    const { now, nodes, scene } = this.network;
    for (const ring of scene.fence ?? []) {
      const corners = ring.map((place) => stage.of(place));
      corners.forEach((at, i) => names.avoid(...at, ...corners[(i + 1) % corners.length]));
    }
    nodes.forEach((_, i) => {
      const next = now.node_up[i] ? this.network.parentOf(i) : -1;
      if (next < 0) return;
      const [dx, dy] = [stage.x[i] - stage.x[next], stage.y[i] - stage.y[next]];
      const part = Math.min(1, HEAD_PX / (Math.hypot(dx, dy) || 1));
      const [px, py] = [part * dx, part * dy];
      names.avoid(stage.x[next], stage.y[next], stage.x[next] + px, stage.y[next] + py);
      names.avoid(stage.x[i], stage.y[i], stage.x[i] - px, stage.y[i] - py);
    });
  }

  #ring(context, x, y, radius, dash, width) {
    const ring = new Path2D();
    ring.arc(x, y, radius, 0, 7);
    stroke(context, colours.alarm, width, ring, dash);
  }

  /** Whether a node has a part to play. */
  #told(i) {
    const { now } = this.network;
    return this.network.role(i) !== "node" || now.alarm[i] || now.outside[i];
  }

  #firstTold() {
    const told = this.network.nodes.map((_, i) => Boolean(this.#told(i)));
    return [...told.keys()].sort((a, b) => told[b] - told[a] || a - b);
  }

  /** Those with a part to play are named first, above the others' dots if need be: the others find
   * what room is left. */
  #names(context, stage, names, dot) {
    const { network } = this;
    const { now, nodes } = network;
    context.textAlign = "left";
    for (const i of this.#firstTold()) {
      const { label, also } = nodes[i];
      const role = network.role(i);
      const state = now.alarm[i] ? " ALARM" : now.outside[i] ? " outside" : "";
      const plain = role === "node" || role === "post" || label.includes(role);
      const called = also ? [`${also} (${label})`, also] : [label]; // the scenario's and its own
      const texts = called.map((name) => `${name}${plain ? "" : ` ${role}`}${state}`);
      texts.push(`${called.at(-1)}${state}`);
      const strong = this.#told(i);
      context.font = strong ? `600 ${FONT}` : FONT;
      const colour = state ? colours.alarm : strong ? colours.ink : colours.soft;
      const beside = [stage.x[i], stage.y[i], dot + NAME_PX];
      let at = null;
      let text = texts.find((one) => (at = names.put(one, ...beside)));
      if (!at && strong) at = names.put(text = texts.at(-1), ...beside, true);
      if (at) word(context, text, ...at, colour, colours.ground, context.font);
    }
  }
}

/** How far from each other half of the places are, each from the one next to it. */
function apart(places) {
  const next = places.map(([x, y], i) => Math.min(...places
    .filter((_, k) => k !== i).map(([px, py]) => Math.hypot(px - x, py - y))));
  return next.sort((a, b) => a - b)[next.length >> 1] ?? Infinity;
}
