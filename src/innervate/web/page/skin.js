// A skin: cells as hexagons at their place, the way each one sends, interface ports, cut cables.
import { colours, shade } from "./colours.js";
import { distance } from "./pointer.js";
import { LAYERS } from "./stage.js";
import {
  Pieces, affected, affectedSample, boxRound, brick, cross, cutSample, flightSample, flights,
  hexagon, middle, slanting, stamped, stroke, word,
} from "./shapes.js";
import { PUT_OUT, off, offWord, plural } from "./words.js";

const NEAR = 1.6; // cables up to this many pitches long are between neighbours
const PORT_COLOURS = 8;
const LINK_PX = 6; // a click is at most so far from the middle of a cable that it cuts
const FEW = 0.1; // up to this share of cells is painted over one by one
const BRICKS_PX = 5; // below this pitch hexagons are squares
const PORT_PX = 10; // half of a port's box
const WORDS_PX = 22; // from this pitch on cells bear a number

/** Draws a skin on a stage. */
export class SkinView {
  constructor(network) {
    this.network = network;
    this.scaleMax = 140; // px a cell
    this.margin = [18, 18];
    const { ports } = network.scene;
    this.colour = ports >= 2 && ports <= PORT_COLOURS ? "port" : "depth";
    this.isCell = network.nodes.map((node) => node.role === "cell");
    this.ports = network.nodes.flatMap((node, i) => (node.role === "port" ? [i] : []));
    this.hidden = network.nodes.map((node) => node.role === "sink" && this.ports.length > 0);
    this.kinds = [];
    this.drawnAt = null;
  }

  choices() {
    return [["port", "by port"], ["depth", "by hops"], ["load", "by load"], ["touch", "by touch"]];
  }

  bounds() {
    return boxRound(this.network.place.filter((_, i) => !this.hidden[i]), 0.5);
  }

  layersOf(changed) {
    const any = (...names) => names.some((name) => changed.has(name));
    const found = [];
    if (any("node_up", "parent", "port", this.colour)) found.push(LAYERS.ground);
    if (any("node_up", "link_up", "parent", "port", "headline")) found.push(LAYERS.lines);
    if (any("flights")) found.push(LAYERS.moving);
    return found;
  }

  draw(layer, context, stage) {
    if (layer === LAYERS.ground) this.#ground(context, stage);
    else if (layer === LAYERS.lines) this.#lines(context, stage);
    else this.#moving(context, stage);
  }

  repaint() {
    this.drawnAt = null;
  }

  /** How large a cell is on the screen, in px. */
  size(scale) {
    return scale;
  }

  /** How far a place is from where a link can be clicked; Infinity where it cannot. */
  linkDistance(stage, link, x, y) {
    const [a, b] = this.network.ends[link];
    const [x0, y0, x1, y1] = [stage.x[a], stage.y[a], stage.x[b], stage.y[b]];
    const long = Math.hypot(x1 - x0, y1 - y0) / stage.scale;
    const isNear = long <= NEAR;
    const away = distance(x0, y0, x1, y1, x, y, isNear ? 0.5 : 0.3, isNear ? 0.5 : 0.7);
    const reach = isNear ? Math.max(3, Math.min(0.14 * stage.scale, LINK_PX)) : 4;
    return away <= reach ? away : Infinity;
  }

  /** How a cell looks: "off", "none" (no way), or a family of colours and a number in it. */
  kindOf(i) {
    const { now } = this.network;
    if (!now.node_up[i]) return "off";
    if (this.colour === "touch") return `h${shade(now.touch[i], 256)}`;
    if (!this.#isRouted(i)) return "none";
    if (this.colour === "load") return `h${shade(now.load[i], 1)}`;
    if (now.beyond[i]) return "beyond";
    if (this.colour === "depth") return `d${shade(now.depth[i] - 1, this.deepest)}`;
    return `p${now.port[i] % PORT_COLOURS}`;
  }

  /** A cell that has a parent may still have no way: the chain can end at a cut. */
  #isRouted(i) {
    const { now } = this.network;
    return Boolean(now.beyond[i]) || (now.parent[i] !== -1 && now.port[i] >= 0);
  }

  facts(i) {
    const { now, nodes } = this.network;
    const out = now.put_out[i] ? `, ${PUT_OUT}` : "";
    const port = nodes[i].role === "port" ? `interface ${nodes[i].port} of ` : "";
    if (!this.isCell[i]) return `${port}the PC${out}`;
    if (!now.node_up[i]) return off(this.network, i);
    const touched = now.touch[i] ? `, touched ${now.touch[i]} of 255` : "";
    const more = `${touched}${now.told[i] >= 0 ? `, command ${now.told[i]} came` : ""}`;
    if (!this.#isRouted(i)) return `${out.slice(2) || "no way to the PC"}${more}`;
    const hops = now.depth[i] >= 0 ? `${plural(now.depth[i], "hop")} to the PC, ` : "";
    const load = now.load[i] ? `, load ${Math.round(100 * now.load[i])} %` : "";
    const way = now.beyond[i] ? "by nodes that do not run here" : `through port ${now.port[i]}`;
    return `${hops}${way}${load}${more}`;
  }

  legend() {
    const cell = (kind) => (context) => {
      this.#shapes(context, kind, [whole(13, 8)]);
      const [sign, dead] = [new Path2D(), new Path2D()];
      if (kind === "none") cross(sign, 13, 8, 2.5);
      if (kind === "off") cross(dead, 13, 8, 4);
      stroke(context, colours.ink, 1.2, sign);
      stroke(context, colours.alarm, 2.2, dead);
    };
    const line = (colour, width, dash) => (context) => {
      stroke(context, colours[colour], width, new Path2D("M1 8h24"), dash);
    };
    const found = this.#scale().map(([kind, text]) => [cell(kind), text]);
    found.push([cell("none"), "no way to the PC"], [cell("off"), offWord(this.network)]);
    found.push([line("link", 2, []), "sends through"], affectedSample);
    if (this.network.scene.source !== "live") {
      found.push(flightSample("beacon", "beacon"), flightSample("data", "sample to the PC"));
      if (this.network.can.has("command")) found.push(flightSample("command", "command down"));
    } else if (this.colour === "port" || this.colour === "depth") {
      found.push([cell("beyond"), "by nodes that do not run here"]);
    }
    found.push(cutSample);
    return found;
  }

  /** What the colours stand for. */
  #scale() {
    if (this.colour === "port") {
      return this.ports.slice(0, PORT_COLOURS).map((_, n) => [`p${n}`, `through port ${n}`]);
    }
    if (this.colour === "depth") return [["d0", "near the PC"], ["d7", "far"]];
    if (this.colour === "load") return [["h0", "idle"], ["h4", "half"], ["h7", "full"]];
    return [["h0", "not touched"], ["h7", "touched hard"]];
  }

  #ground(context, stage) {
    const { network } = this;
    this.deepest = network.now.depth.reduce((most, hops) => Math.max(most, hops), 1);
    const kinds = network.nodes.map((_, i) => (this.isCell[i] ? this.kindOf(i) : ""));
    const same = this.drawnAt === stage.transform;
    const numbered = stage.scale >= WORDS_PX;
    let cells = kinds.flatMap((kind, i) => (kind && kind !== this.kinds[i] ? [i] : []));
    if (!same || numbered || cells.length > FEW * kinds.length) {
      stage.clear(context);
      cells = kinds.flatMap((kind, i) => (kind ? [i] : []));
    }
    Object.assign(this, { kinds, drawnAt: stage.transform });
    this.#cells(context, stage, cells);
    if (numbered) for (const i of cells) this.#number(context, stage, i);
  }

  #cells(context, stage, cells) {
    const pieces = new Map();
    const under = new Pieces();
    const shape = stage.scale < BRICKS_PX ? brick : hexagon;
    let stamp = null;
    for (const i of cells) {
      const [x, y] = [stage.x[i], stage.y[i]];
      if (x < -99 || y < -99 || x > stage.width + 99 || y > stage.height + 99) continue;
      const isHatched = this.kinds[i] === "beyond";
      if (isHatched) (stamp ??= stamped(context, shape, stage.scale))(x, y);
      if (isHatched) continue;
      if (!pieces.has(this.kinds[i])) pieces.set(this.kinds[i], new Pieces());
      shape(pieces.get(this.kinds[i]).next(), x, y, stage.scale);
      shape(under.next(), x, y, stage.scale * 1.02);
    }
    context.fillStyle = colours.ground;
    for (const path of under.paths) context.fill(path);
    for (const [kind, { paths }] of pieces) this.#shapes(context, kind, paths);
  }

  #shapes(context, kind, paths) {
    const grey = {
      beyond: () => slanting(context), none: () => colours.ground, off: () => colours.faint,
    }[kind];
    const [colour, width] = grey ? [colours.soft, 1] : [colours.faint, 0.8];
    context.fillStyle = grey ? grey() : colours[kind[0]][Number(kind.slice(1))];
    for (const path of paths) context.fill(path);
    if (kind[0] === "p") return; // pale shades end somewhere
    for (const path of paths) stroke(context, colour, width, path, kind === "none" ? [2, 2] : []);
  }

  /** What the colour stands for, as a number in the cell. */
  #number(context, stage, i) {
    const { now } = this.network;
    if (!now.node_up[i]) return;
    const routed = this.#isRouted(i);
    const text = {
      port: routed && !now.beyond[i] ? now.port[i] : "",
      depth: routed && !now.beyond[i] ? now.depth[i] : "",
      load: routed ? `${Math.round(100 * now.load[i])}` : "", touch: now.touch[i] || "",
    }[this.colour];
    context.font = `${Math.max(9, Math.min(13, 0.36 * stage.scale))}px system-ui, sans-serif`;
    context.fillStyle = colours.on[this.kinds[i]] ?? colours.ink;
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(text, stage.x[i], stage.y[i] - 0.32 * stage.scale);
  }

  #lines(context, stage) {
    const { network } = this;
    const { now } = network;
    stage.clear(context);
    const [tree, cables, plugs, wires] = [1, 2, 3, 4].map(() => new Path2D());
    network.ends.forEach(([a, b], link) => {
      if (this.hidden[a] || this.hidden[b] || !now.link_up[link]) return;
      const long = Math.hypot(stage.x[a] - stage.x[b], stage.y[a] - stage.y[b]) / stage.scale;
      if (this.isCell[a] && this.isCell[b]) line(long > NEAR ? cables : wires, stage, a, b);
      else line(plugs, stage, a, b);
    });
    stroke(context, colours.faint, 1.4, cables);
    if (stage.scale >= 16) {
      context.globalAlpha = 0.18;
      stroke(context, colours.link, 1, wires);
      context.globalAlpha = 1;
    }
    stroke(context, colours.link, 2.2, plugs);
    for (let i = 0; i < network.nodes.length; i++) {
      const parent = network.parentOf(i);
      if (parent >= 0 && this.isCell[i] && this.isCell[parent]) line(tree, stage, i, parent);
    }
    context.globalAlpha = this.colour === "load" || this.colour === "touch" ? 0.3 : 0.65;
    stroke(context, colours.link, Math.max(0.6, Math.min(2.6, 0.1 * stage.scale)), tree);
    context.globalAlpha = 1;
    this.#lacks(context, stage);
    affected(context, network, stage, Math.max(3, 0.42 * stage.scale));
    this.#cuts(context, stage);
    this.#plugs(context, stage);
  }

  #lacks(context, stage) {
    const { now } = this.network;
    const lost = new Path2D();
    const off = new Path2D();
    for (let i = 0; i < this.isCell.length; i++) {
      if (!this.isCell[i]) continue;
      const size = 0.17 * stage.scale;
      if (!now.node_up[i]) cross(off, stage.x[i], stage.y[i], 1.6 * size);
      else if (!this.#isRouted(i)) cross(lost, stage.x[i], stage.y[i], size);
    }
    stroke(context, colours.ink, 1.2, lost);
    stroke(context, colours.alarm, 2.4, off);
  }

  #cuts(context, stage) {
    const { network } = this;
    const gaps = new Path2D();
    const dashes = new Path2D();
    const shown = (i) => !this.hidden[i];
    network.ends.forEach(([a, b], link) => {
      if (!network.isCut(link) || !shown(a) || !shown(b)) return;
      line(dashes, stage, a, b);
      const size = Math.max(3.5, Math.min(6, 0.2 * stage.scale));
      cross(gaps, ...middle(stage, a, b, (i) => (this.ports.includes(i) ? PORT_PX : 0)), size);
    });
    stroke(context, colours.alarm, 2.4, dashes, [4, 3]);
    stroke(context, colours.ground, 5, gaps);
    stroke(context, colours.alarm, 3, gaps);
  }

  #plugs(context, stage) {
    context.textAlign = "center";
    for (const i of this.ports) {
      context.fillStyle = colours.ink;
      context.beginPath();
      context.roundRect(stage.x[i] - PORT_PX, stage.y[i] - 9, 2 * PORT_PX, 18, 4);
      context.fill();
      const name = String(this.network.nodes[i].port ?? "");
      word(context, name, stage.x[i], stage.y[i] + 1, colours.ground, colours.ink,
        "600 12px system-ui, sans-serif");
    }
  }

  #moving(context, stage) {
    stage.clear(context);
    flights(context, this.network, stage, Math.max(1.5, Math.min(4, 0.1 * stage.scale)));
  }
}

/** One cell for the legend. */
function whole(x, y) {
  const path = new Path2D();
  hexagon(path, x, y, 14);
  return path;
}

function line(path, stage, a, b) {
  path.moveTo(stage.x[a], stage.y[a]);
  path.lineTo(stage.x[b], stage.y[b]);
}
