// What the server says of the network: the scene, and the last value of every field of a state.

export const NO_DATA = "no data"; // the level of a network of which nobody answers
const OUT_OF_RANGE = 2; // in link_up
const KEPT = 20000; // boxes of the timeline
const POINTS = 3000; // of a plot
const MARKS = 500;
const SPAN_S = 10; // of the network's time in a plot; more where it goes so fast
const SPAN_POINTS = 40; // that fewer points than these would be in it

/** One network as it is looked at: a scene and what became of it. */
export class Network {
  constructor(scene) {
    this.scene = scene;
    this.kind = scene.kind;
    this.nodes = scene.nodes;
    this.links = scene.links;
    this.can = new Set(scene.can);
    this.index = new Map(scene.nodes.map((node, i) => [node.id, i]));
    this.ends = scene.links.map((link) => [this.index.get(link.a), this.index.get(link.b)]);
    this.linksOf = scene.nodes.map(() => []);
    this.ends.forEach(([a, b], i) => {
      this.linksOf[a].push(i);
      this.linksOf[b].push(i);
    });
    this.place = scene.nodes.map((node) => [node.x, node.y]);
    const none = (value) => scene.nodes.map(() => value);
    this.now = {
      t_s: scene.t_s ?? 0, paused: false, speed: 1, at_end: false,
      node_up: none(1), link_up: scene.links.map(() => 1),
      parent: none(-1), port: none(-1), depth: none(-1), load: none(0), touch: none(0),
      told: none(-1), alarm: none(0), outside: none(0), way: none(0), leads: none(0),
      beyond: none(0), put_out: none(0), flights: [],
      since_cut_s: null, recovery: null, unconnected: 0, apart: 0, away: 0, headline: null,
    };
    this.radio = { now: none(0), turn: none(-1) };
    this.timeline = [];
    this.series = new Map(scene.series.map((one) => [one.id, []]));
    this.hasGaps = scene.source === "live"; // others that say nothing had nothing to measure
    this.marks = { loss: [], return: [] }; // when something was taken away, or given back, s
    this.since = null; // losses before it happened before anybody looked, s
    this.lost = []; // what was taken away and has not been read out
    this.lostFrom = null; // the headline before that
    this.before = null; // of the newest state, the headline that it took the place of
  }

  /** Take in a state message. Returns the names of what it changed, `back_s` if time went back. */
  apply(state) {
    if (state.back_s !== undefined) this.#forgetAfter(state.back_s);
    this.since ??= state.t_s;
    const { type, back_s, timeline, series, position, radio, ...plain } = state;
    this.before = state.headline ? this.now.headline : null;
    Object.assign(this.now, plain);
    if (position) this.place = position;
    if (radio) Object.assign(this.radio, radio);
    if (timeline?.length) {
      for (const box of timeline) this.timeline.push(box);
      if (this.timeline.length > KEPT) this.timeline.splice(0, this.timeline.length - KEPT / 2);
    }
    for (const [id, points] of Object.entries(series ?? {})) this.#addPoints(id, points);
    return new Set(Object.keys(state));
  }

  /** Keep the moment of a log line that plots are to show. */
  note({ mark, t_s, text }) {
    if (!this.marks[mark]) return;
    this.marks[mark].push(t_s);
    if (this.marks[mark].length > MARKS) this.marks[mark].shift();
    if (mark !== "loss" || this.since === null || t_s < this.since || this.#isTold()) return;
    if (!this.lost.length) this.lostFrom = this.before?.text ?? null;
    this.lost.push(text);
  }

  /** What was taken away since this was asked last, and the headline before it where that is
   * another: lines come behind the state that they belong to, which may be on the screen by then.
   */
  takeLost() {
    const { lost, lostFrom: before } = this;
    [this.lost, this.lostFrom] = [[], null];
    return { lost, before };
  }

  /** Whether the newest state has another level, which is read out in any case. */
  #isTold() {
    return this.before !== null && this.before.level !== this.now.headline.level;
  }

  /** The node that stands for an id of `parent`, as an index, or -1. */
  parentOf(i) {
    const id = this.now.parent[i];
    return id === -1 || id === null ? -1 : (this.index.get(id) ?? -1);
  }

  /** What a node is now: whoever leads is a gateway, and who led before is none any more. */
  role(i) {
    const { leads } = this.now;
    const { role } = this.nodes[i];
    if (leads[i]) return "gateway";
    return role === "gateway" && leads.some(Boolean) ? "node" : role;
  }

  /** Whether nothing is known of anybody. */
  isSilent() {
    return this.now.headline?.level === NO_DATA;
  }

  /** Nodes that the headline is about, as indices. */
  affected() {
    const { headline } = this.now;
    if (!headline || this.isSilent()) return [];
    return headline.nodes.map((id) => this.index.get(id)).filter((i) => i !== undefined);
  }

  /** Whether a link is there at all: robots move out of each other's range. */
  isThere(link) {
    return this.now.link_up[link] !== OUT_OF_RANGE;
  }

  /** Whether a link was cut itself; one of a node that is off is not. */
  isCut(link) {
    const [a, b] = this.ends[link];
    return this.now.link_up[link] === 0 && this.now.node_up[a] && this.now.node_up[b];
  }

  /** The other end of a link. */
  across(link, node) {
    const [a, b] = this.ends[link];
    return a === node ? b : a;
  }

  linkName(link) {
    const [a, b] = this.ends[link];
    return `${this.nodes[a].label} - ${this.nodes[b].label}`;
  }

  /** How much of the network's time a plot shows, s. */
  span(id) {
    if (this.hasGaps) return SPAN_S;
    const times = this.series.get(id).slice(-3).map(([t]) => t);
    const apart = times.slice(1).map((t, i) => t - times[i]);
    return Math.max(SPAN_S, SPAN_POINTS * Math.max(0, ...apart));
  }

  /** The points of a plot from a time on, in curves: one ends where nobody answered. */
  curves(id, from) {
    const points = this.series.get(id);
    const curves = [[]];
    points.forEach(([t, v], i) => {
      if (v === null && this.hasGaps) curves.push([]);
      else if (v !== null && (points[i + 1]?.[0] ?? t) >= from) curves.at(-1).push([t, v]);
    });
    return curves;
  }

  #addPoints(id, points) {
    const kept = this.series.get(id);
    if (!kept) return;
    for (const point of points) kept.push(point);
    if (kept.length > POINTS) kept.splice(0, kept.length - POINTS / 2);
  }

  #forgetAfter(t_s) {
    this.since = Math.min(this.since ?? t_s, t_s);
    this.timeline = this.timeline.filter((box) => box.to_s <= t_s);
    for (const [id, points] of this.series) {
      this.series.set(id, points.filter(([at]) => at <= t_s));
    }
    for (const [name, times] of Object.entries(this.marks)) {
      this.marks[name] = times.filter((at) => at < t_s);
    }
  }
}
