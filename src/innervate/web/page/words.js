// Numbers and states as words.

/** A time of the network: milliseconds, or microseconds where single events are looked at. */
export function clock(t_s, digits = 3) {
  if (t_s < 100) return `${t_s.toFixed(digits)} s`;
  const rounded = Number(t_s.toFixed(digits)); // 119.9999 s are 2:00.000 min, not 1:60.000
  const minutes = Math.floor(rounded / 60);
  const seconds = (rounded - 60 * minutes).toFixed(digits);
  return `${minutes}:${seconds.padStart(digits ? digits + 3 : 2, "0")} min`;
}

/** How long a run lasts, without more digits than it has. */
export function whole(t_s) {
  return t_s < 100 ? `${Number(t_s.toFixed(3))} s` : clock(t_s).replace(/\.?0+ min$/, " min");
}

/** How long something took, in milliseconds or seconds. */
export function duration(ms) {
  if (ms < 100) return `${ms.toFixed(1)} ms`;
  if (ms < 1000) return `${ms.toFixed(0)} ms`;
  return ms < 60e3 ? `${(ms / 1000).toFixed(2)} s` : `${(ms / 60e3).toFixed(1)} min`;
}

/** How long ago something was, in seconds: steady in width, for a number that runs. */
export function ago(s) {
  const ms = 1000 * s;
  if (ms < 1000) return `${ms.toFixed(ms < 99.5 ? 1 : 0)} ms`;
  return s < 100 ? `${s.toFixed(2)} s` : `${(s / 60).toFixed(1)} min`;
}

/** A value of a plot. */
export function value(v, unit) {
  const size = Math.abs(v);
  if (unit === "ms" && size >= 1000) return value(v / 1000, "s");
  const digits = size >= 100 || Number.isInteger(v) ? 0 : size >= 10 ? 1 : size >= 0.1 ? 2 : 3;
  const one = v === 1 ? unit.replace(/^(cell|frame|node)s$/, "$1") : unit;
  return `${v.toFixed(digits)}${one ? ` ${one}` : ""}`;
}

export const SPEEDS = [
  0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100, 0,
];

/** A speed in times real time; 0 = as fast as possible. */
export function speed(v) {
  return v === 0 ? "fastest" : `${v}x`;
}

/** The place on the slider nearest to a speed. */
export function speedIndex(v) {
  if (v === 0) return SPEEDS.length - 1;
  const apart = SPEEDS.slice(0, -1).map((s) => Math.abs(Math.log(s / v)));
  return apart.indexOf(Math.min(...apart));
}

/** Round times between two, each with its name: at most about `many` of them. */
export function ticks(from, to, many) {
  const rough = (to - from) / many;
  const ten = 10 ** Math.floor(Math.log10(rough));
  const step = ten * [1, 2, 5, 10].find((n) => n * ten >= 0.999 * rough);
  const found = [];
  for (let n = Math.max(0, Math.ceil(from / step - 1e-9)); n * step <= to * (1 + 1e-12); n++) {
    found.push([n * step, tick(n * step, step)]);
  }
  return found;
}

function tick(t_s, step) {
  if (step >= 1) return t_s < 100 ? `${t_s.toFixed(0)} s` : clock(t_s, 0);
  if (t_s >= 1) return `${t_s.toFixed(Math.max(0, -Math.floor(Math.log10(step) + 1e-9)))} s`;
  const digits = Math.max(0, -Math.floor(Math.log10(step * 1000) + 1e-9));
  return `${(1000 * t_s).toFixed(digits)} ms`;
}

/** What a node is that is not there: live ones go on running while they are cut off. */
export function off(network, i) {
  const { kind, now, scene } = network;
  if (scene.source === "live") return now.cut_off[i] ? "cut off" : "does not answer";
  return now.absent?.[i] ? absentWord(kind) : "switched off";
}

/** What a running node is whose identity is revoked: it runs, and nobody takes what it sends. */
export const PUT_OUT = "put out: its identity is revoked";

/** Who is not there by plan: whoever has left a team is told no other from who has not come. */
const ABSENT = { radio: "not in the team", mesh: "yet to come" };

export const absentWord = (kind) => ABSENT[kind] ?? "not there";

/** The same for a number of nodes. */
export function offWord(network) {
  return network.scene.source === "live" ? "cut off, or silent" : "switched off";
}

/** The same for a legend: who is not there by plan is drawn the same. */
export function offWords(network) {
  const { kind, scene } = network;
  return scene.absent ? `${offWord(network)}, or ${absentWord(kind)}` : offWord(network);
}

// Words of letters from right to left, with the numbers between and behind them.
const RIGHT = "\\u0590-\\u08ff\\ufb1d-\\ufdff\\ufe70-\\ufefc"
  + "\\u{10800}-\\u{10fff}\\u{1e800}-\\u{1efff}";
const TURNED = new RegExp(`[${RIGHT}](?:[${RIGHT}\\d ]*[${RIGHT}\\d])?`, "gu");

/** A text in which names written from right to left turn nothing round that stands beside them. */
export const apart = (text) => text.replace(TURNED, "\u2068$&\u2069");

export const plural = (n, one, many = `${one}s`) => `${n} ${n === 1 ? one : many}`;
