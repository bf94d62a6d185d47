// What is pointed at and what is selected: by mouse, touch and arrow keys.
import { quadtree } from "d3-quadtree";
import { colours } from "./colours.js";
import { LAYERS } from "./stage.js";
import { hexagon, stroke } from "./shapes.js";

const TOUCH_PX = 22; // on a touch screen what is smaller is selected first, not cut
const MOUSE_PX = 9;
const ROUND_PX = 9; // from a link to the line round it
const WAYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

/** Follows the pointer and the keys over a stage. */
export class Pointer {
  /**
   * @param {Stage} stage
   * @param {{select: Function, act: Function, nodesOnly: Function, over: Function}} told of what
   *   is selected ({node} or {link}, or null), of what is to be cut, killed or touched, and of what
   *   the mouse is over; says whether only nodes can be
   */
  constructor(stage, told) {
    Object.assign(this, { stage, told, over: null, selected: null });
    const { box } = stage;
    stage.marks = (context) => this.#draw(context);
    box.addEventListener("pointermove", (event) => this.#hover(event));
    box.addEventListener("pointerleave", () => this.#setOver(null, [0, 0]));
    box.addEventListener("click", (event) => this.#click(event));
    box.addEventListener("keydown", (event) => this.#key(event));
    box.addEventListener("focus", () => this.#focus());
  }

  forget() {
    this.selected = this.moves = null;
    this.#setOver(null, [0, 0]);
  }

  /** The node or link at a place of the stage in px, or null. */
  find(x, y) {
    const { stage } = this;
    const { view, scale } = stage;
    if (this.moves !== stage.moves) {
      const nodes = [...stage.x.keys()].filter((i) => !view.hidden?.[i]);
      this.tree = quadtree(nodes, (i) => stage.x[i], (i) => stage.y[i]);
      this.moves = stage.moves;
    }
    const node = this.tree.find(x, y, Math.max(view.reach?.(scale) ?? 0.56 * scale, 5));
    const link = this.told.nodesOnly?.() ? null : this.#nearestLink(x, y);
    if (node === undefined) return link === null ? null : { link };
    if (link === null) return { node };
    return view.linkFirst?.(node) === false ? { node } : { link };
  }

  select(what) {
    this.selected = what;
    this.stage.touch(LAYERS.marks);
    this.told.select(what);
  }

  #nearestLink(x, y) {
    const { stage } = this;
    const { network } = stage.view;
    let best = null;
    let least = Infinity;
    network.ends.forEach(([a, b], link) => {
      if (stage.view.hidden?.[a] || stage.view.hidden?.[b]) return;
      const away = stage.view.linkDistance(stage, link, x, y);
      if (away < least) [best, least] = [link, away];
    });
    return best;
  }

  #hover(event) {
    if (event.pointerType === "touch") return;
    const { left, top } = this.stage.box.getBoundingClientRect();
    const place = [event.clientX - left, event.clientY - top];
    this.#setOver(event.buttons ? null : this.find(...place), place);
  }

  /** Whether a node is large enough on the screen that a click does more than select. */
  isLarge(least = MOUSE_PX) {
    return this.stage.view.size(this.stage.scale) >= least;
  }

  #setOver(what, place) {
    this.told.over(what, place);
    const same = what?.node === this.over?.node && what?.link === this.over?.link;
    this.over = what;
    if (!same) this.stage.touch(LAYERS.marks);
  }

  #click(event) {
    const { left, top } = this.stage.box.getBoundingClientRect();
    const what = this.find(event.clientX - left, event.clientY - top);
    this.select(what);
    const least = event.pointerType === "touch" ? TOUCH_PX : MOUSE_PX;
    if (what && this.isLarge(least)) this.told.act(what);
  }

  #focus() {
    if (!this.selected && this.stage.box.matches(":focus-visible")) {
      const first = this.stage.view.network.nodes.findIndex((_, i) => !this.stage.view.hidden?.[i]);
      this.select({ node: first });
    }
  }

  #key(event) {
    if (event.key === "Enter" && this.selected) this.told.act(this.selected);
    else if (event.key === "Escape") this.select(null);
    else if (WAYS[event.key]) this.#go(WAYS[event.key], event.shiftKey);
    else return;
    event.preventDefault();
  }

  /** To the node in a direction, or to the link that leads there. */
  #go([dx, dy], toLink) {
    const { stage } = this;
    const { network, hidden } = stage.view;
    const { selected } = this;
    if (!selected) return this.#focus();
    if (selected.link !== undefined) {
      const [a, b] = network.ends[selected.link];
      const ahead = (i) => stage.x[i] * dx + stage.y[i] * dy;
      return this.select({ node: ahead(a) > ahead(b) ? a : b });
    }
    const from = selected.node;
    const candidates = toLink
      ? network.linksOf[from].map((link) => [network.across(link, from), { link }])
      : network.nodes.map((_, i) => [i, { node: i }]);
    let best = null;
    let least = Infinity;
    for (const [i, what] of candidates) {
      if (i === from || hidden?.[i]) continue;
      const x = stage.x[i] - stage.x[from];
      const y = stage.y[i] - stage.y[from];
      const forward = x * dx + y * dy;
      const aside = Math.abs(x * dy) + Math.abs(y * dx);
      if (forward <= 0.01 || aside > (toLink ? 12 : 2.2) * forward) continue;
      const cost = forward + 1.5 * aside;
      if (cost < least) [best, least] = [what, cost];
    }
    if (best) {
      if (best.node !== undefined) stage.reveal(best.node);
      this.select(best);
    }
  }

  #draw(context) {
    if (this.over) this.#outline(context, this.over, 2, colours.accent);
    if (this.selected) {
      this.#outline(context, this.selected, 5, colours.ground);
      this.#outline(context, this.selected, 3, colours.accent);
    }
  }

  #outline(context, { node, link }, width, colour) {
    const { stage } = this;
    const path = new Path2D();
    if (node !== undefined) {
      const size = Math.max(stage.view.size(stage.scale), 8);
      if (stage.view.isCell?.[node]) hexagon(path, stage.x[node], stage.y[node], 1.1 * size);
      else path.arc(stage.x[node], stage.y[node], 0.5 * size + 6, 0, 7);
      return stroke(context, colour, width, path);
    }
    const [a, b] = stage.view.network.ends[link];
    const way = Math.atan2(stage.y[b] - stage.y[a], stage.x[b] - stage.x[a]);
    path.arc(stage.x[a], stage.y[a], ROUND_PX, way + Math.PI / 2, way - Math.PI / 2);
    path.arc(stage.x[b], stage.y[b], ROUND_PX, way - Math.PI / 2, way + Math.PI / 2);
    path.closePath();
    stroke(context, colour, width, path);
  }
}

/** How far a place is from the part of a line between two shares of its length. */
export function distance(x0, y0, x1, y1, x, y, low = 0, high = 1) {
  const dx = x1 - x0;
  const dy = y1 - y0;
  const share = ((x - x0) * dx + (y - y0) * dy) / (dx * dx + dy * dy || 1);
  const on = Math.max(low, Math.min(high, share));
  return Math.hypot(x - x0 - on * dx, y - y0 - on * dy);
}
