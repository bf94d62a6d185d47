// Numbers, events and what is selected.
import { NO_DATA } from "./network.js";
import { absentWord, ago, clock, duration, offWord, plural } from "./words.js";

const LEVELS = { ok: "✓", degraded: "!", down: "✕", "no data": "?" };
const MARKS = { info: "·", good: "✓", bad: "✕" };
const KEPT = 300;
const $ = (id) => document.getElementById(id);

function show(id, text, more, state) {
  const box = $(id);
  box.querySelector("output").textContent = text;
  box.querySelector(".more").textContent = more;
  box.className = `number ${state}`;
}

/** Is all well, in a line: what the server says, or nothing while it cannot be asked. */
export function showState(network, connected) {
  const { headline } = network.now;
  $("state").hidden = !headline;
  if (!headline) return;
  const level = connected ? headline.level : NO_DATA;
  const text = connected ? headline.text : `Not connected; when last heard of: ${headline.text}`;
  $("state").className = level.replace(" ", "-");
  const isSilent = connected && level === NO_DATA && network.scene.source === "live";
  const link = !connected ? "not connected"
    : isSilent ? "page connected, nodes silent" : "connected";
  if ($("connection").textContent !== link) $("connection").textContent = link;
  $("connection").classList.toggle("lost", !connected || isSilent);
  const word = `${LEVELS[level] ?? ""} ${level}`;
  const { lost, before } = network.takeLost();
  const shown = $("headline").textContent;
  if ($("level").textContent !== word) { // said when it changes: the sentence counts messages
    $("level").textContent = word;
    $("state-spoken").textContent = `${level}: ${text}`;
  } else if (lost.length && connected && level !== "ok") {
    $("state-spoken").textContent = still(level, lost, text, before ?? shown);
  }
  if (shown !== text) $("headline").textContent = text;
}

/** Something more was lost, and the level is the same: what it was, and what is new of the state.
 *
 * @param {string} level
 * @param {string[]} lost what was taken away
 * @param {string} text the headline
 * @param {string} before the one before
 */
export function still(level, lost, text, before) {
  const had = new Set(parts(before));
  const fresh = parts(text).filter((part) => !had.has(part)).join("; ");
  const cause = lost.length > 1 ? `${lost[0]}, and ${lost.length - 1} more` : lost[0];
  return `still ${level}; ${cause}${fresh && `: ${fresh}`}`;
}

/** The parts of a headline, in small letters and without the full stop. */
function parts(text) {
  return `${text.charAt(0).toLowerCase()}${text.slice(1)}`.replace(/\.$/, "").split("; ");
}

/** The large numbers: time since the last cut, how long the recovery took, who has no way. */
export function showNumbers(network) {
  const { since_cut_s: since, recovery, unconnected, apart } = network.now;
  const isKnown = unconnected !== null;
  const none = since === null || since === undefined;
  show("since", none ? "–" : ago(since), none ? "none yet" : "", "");
  if (!recovery) show("recovery", "–", "", "");
  else {
    const isLive = network.scene.source === "live"; // its nodes do not say when they notice
    const noticed = isLive ? ""
      : recovery.detected_ms === null || recovery.detected_ms === undefined
        ? "not noticed yet" : `noticed after ${duration(recovery.detected_ms)}`;
    const isOpen = recovery.recovered_ms === null || recovery.recovered_ms === undefined;
    const text = isOpen ? ago(network.now.t_s - recovery.at_s) : duration(recovery.recovered_ms);
    const state = isOpen ? ["not yet", noticed] : [noticed];
    const known = state.filter(Boolean).join(", ");
    const isWhole = !unconnected && !recovery.apart; // else it is good news of the others only
    const look = !isKnown ? "" : isOpen ? "open" : isWhole ? "done" : "";
    const shown = isKnown || !isOpen ? text : "–";
    const cut = recovery.apart ? `${recovery.apart} cut off${known && "; the others: "}` : "";
    const came = `${cut}${known}`;
    const more = isKnown && came ? `${recovery.cause}: ${came}` : recovery.cause;
    if (isKnown && recovery.nobody) {
      const word = WORDS[network.kind] ?? "node";
      show("recovery", "–", `${recovery.cause}: no ${word} is left that could have a way`, "bad");
    } else if (isKnown && recovery.recovered_ms === 0) {
      const word = WORDS[network.kind] ?? "node"; // what neither a cable nor the PC is
      const whom = recovery.apart ? `${recovery.apart} cut off, no other `
        : /cable|link|^the PC /.test(recovery.cause) ? "no " : "no other ";
      const who = `${whom}${word}`;
      show("recovery", "–", `${recovery.cause}: ${who} lost its way`, "");
    } else show("recovery", shown, more, look);
  }
  const isOnAir = network.kind === "radio" || network.scene.ways === false; // who hears has no way
  const tellsWays = network.scene.recovers !== false;
  const label = isOnAir ? offWord(network) : tellsWays ? "without a way" : "cut off";
  $("unconnected").querySelector(".label").textContent = label;
  $("since").querySelector(".label").textContent = `since the last ${isOnAir ? "failure" : "cut"}`;
  $("recovery").hidden = isOnAir || !tellsWays;
  const all = network.nodes.filter((node) => node.role !== "sink" && node.role !== "port").length;
  const of = `of ${plural(all, WORDS[network.kind] ?? "node")}`;
  const isOut = (node, i) => node.role !== "port" && network.now.put_out[i];
  const out = network.nodes.filter(isOut).length;
  const some = (count) => (count === unconnected ? "" : `${count} of them `);
  const part = (count, what) => (count ? `; ${some(count)}${what}` : "");
  const off = `${part(tellsWays && apart, "cut off")}${part(out, "put out")}`;
  const away = network.now.away ? `; ${network.now.away} more ${absentWord(network.kind)}` : "";
  show("unconnected", isKnown ? String(unconnected) : "–",
    isKnown ? `${of}${off}${away}` : "nobody answers", unconnected ? "bad" : "");
}

const WORDS = { skin: "cell", radio: "station", mesh: "node" };

/** Events, the newest at the end; it follows them unless the reader scrolled up. */
export class Log {
  constructor(box) {
    this.box = box;
    this.list = box.querySelector("ol");
    this.follows = true;
    box.addEventListener("scroll", () => {
      this.follows = box.scrollHeight - box.scrollTop - box.clientHeight < 30;
    });
    new ResizeObserver(() => this.#follow()).observe(box);
  }

  #follow() {
    if (this.follows) this.box.scrollTop = this.box.scrollHeight;
  }

  clear() {
    this.list.replaceChildren();
  }

  /** Time went back: what was then or later has not happened. */
  forgetFrom(t_s) {
    for (const item of [...this.list.children]) {
      if (Number(item.dataset.t_s) >= t_s) item.remove();
    }
  }

  add({ t_s, text, level }) {
    const { list } = this;
    const item = document.createElement("li");
    item.className = level;
    if (typeof t_s === "number") item.dataset.t_s = t_s;
    const time = document.createElement("time");
    time.textContent = typeof t_s === "number" ? clock(t_s) : "";
    const mark = document.createElement("span");
    mark.className = "mark";
    mark.textContent = MARKS[level] ?? MARKS.info;
    const words = document.createElement("span");
    words.textContent = text;
    item.append(time, mark, words);
    list.append(item);
    while (list.childElementCount > KEPT) list.firstElementChild.remove();
    this.#follow();
  }
}

/** What is selected: its name, what is known of it, and a button for all that can be done. */
export class Card {
  /**
   * @param {(what: object) => void} change cuts, kills, heals or revives something
   * @param {CommandBox} command
   */
  constructor(change, command) {
    this.change = change;
    this.command = command;
    this.shown = "";
  }

  /** What a click on something does, as a verb: "kills"; "" nothing. */
  static deed(network, what) {
    const command = commandFor(network, what);
    if (!command) return "";
    const isOff = network.scene.source === "live" && what.node !== undefined;
    return { cut: "cuts", heal: "heals", kill: isOff ? "cuts off" : "kills",
      revive: isOff ? "lets back" : "revives" }[command.do];
  }

  /** Show {node} or {link} of a view's network, or nothing. */
  show(view, what) {
    $("selection").hidden = !what;
    if (!what) return void (this.shown = "");
    const { network } = view;
    const { name, facts } = told(view, what);
    $("selected-name").textContent = name;
    $("selected-facts").textContent = facts;
    this.#buttons(network, what);
    this.command.show(network, what);
    const state = stateOf(network, what);
    if (what !== this.what || state !== this.state) $("spoken").textContent = `${name}: ${facts}`;
    Object.assign(this, { what, state });
  }

  /** Buttons are made anew only when there are others: a focused one must not vanish. */
  #buttons(network, what) {
    const { node } = what;
    const links = node === undefined ? [] : network.linksOf[node].map((link) => ({ link }));
    const wanted = [what, ...links]
      .map((one) => [one, this.#label(network, one, node)])
      .filter(([, label]) => label);
    const key = JSON.stringify(wanted.map(([one]) => one));
    const box = $("selected-do");
    if (key !== this.shown) {
      box.replaceChildren(...wanted.map(([one]) => {
        const button = document.createElement("button");
        button.type = "button";
        button.addEventListener("click", () => this.change(one));
        return button;
      }));
      this.shown = key;
    }
    wanted.forEach(([, label], i) => {
      if (box.children[i].textContent !== label) box.children[i].textContent = label;
    });
  }

  #label(network, { node, link }, from) {
    const command = commandFor(network, { node, link });
    if (!command) return "";
    const isLive = network.scene.source === "live";
    const verbs = isLive ? ["Cut off", "Let back"] : ["Kill", "Revive"];
    if (node !== undefined) return verbs[command.do === "kill" ? 0 : 1];
    const verb = command.do === "cut" ? "Cut" : "Heal";
    if (from === undefined) return `${verb} this link`;
    return `${verb}: ${network.nodes[network.across(link, from)].label}`;
  }
}

/** The name of {node} or {link}, and what is known of it. */
export function told(view, { node, link }) {
  const { label, also } = view.network.nodes[node] ?? {};
  return node !== undefined
    ? { name: also ? `${label} (${also})` : label, facts: view.facts(node) }
    : { name: view.network.linkName(link), facts: linkFacts(view, link) };
}

/** What of a node or link is said again when it changes. */
function stateOf(network, { node, link }) {
  const { now } = network;
  if (node !== undefined) return `${now.node_up[node]}`;
  return `${now.link_up[link]} ${network.isCut(link)}`;
}

function linkFacts(view, link) {
  const { network } = view;
  const { quality } = network.links[link];
  const known = quality !== undefined && quality !== null;
  const good = known ? `, quality ${Math.round(100 * quality)} %` : "";
  const state = network.isCut(link) ? "cut" : network.now.link_up[link] ? "up" : "off at one end";
  return `link, ${network.isThere(link) ? state : "out of range"}${good}`;
}

/** The command that changes the state of {node} or {link}; null where that cannot be done. */
export function commandFor(network, { node, link }) {
  const { now, can } = network;
  const [verb, of] = link !== undefined
    ? [now.link_up[link] ? "cut" : "heal", { link: network.links[link].id }]
    : [now.node_up[node] ? "kill" : "revive", { node: network.nodes[node].id }];
  if (link !== undefined && !now.link_up[link] && !network.isCut(link)) return null; // a dead end
  if (link !== undefined && !network.isThere(link)) return null;
  const isGone = verb === "revive" && now.cut_off && !now.cut_off[node]; // its process has ended
  if (isGone) return null;
  const fixed = node !== undefined && ["sink", "port"].includes(network.nodes[node].role);
  return can.has(verb) && !fixed ? { do: verb, ...of } : null;
}
