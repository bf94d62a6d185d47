// Shapes that several views draw.
import { colours } from "./colours.js";

const HEAD_PX = 6; // of an arrow
const HATCH_PX = 5; // from line to line
const PIECE = 16; // shapes in a path
const RATIO_MAX = 2; // pixels per px of the page that drawing is worth
const CALM = matchMedia("(prefers-reduced-motion: reduce)");

/** Corners of a pointy-top hexagon, a little smaller than its place; neighbours are 1 apart. */
export const HEXAGON = Array.from({ length: 6 }, (_, i) => {
  const radius = 0.96 / Math.sqrt(3);
  return [radius * Math.sin((i * Math.PI) / 3), -radius * Math.cos((i * Math.PI) / 3)];
});

/** Make a canvas as fine as the screen, empty; its context then draws in px of the page. */
export function prepared(canvas, width, height) {
  const ratio = Math.min(devicePixelRatio, RATIO_MAX);
  const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== wide || canvas.height !== high) {
    canvas.width = wide;
    canvas.height = high;
  }
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return context;
}

/** The smallest box round places, as [left, top, right, bottom], wider by `more` on all sides. */
export function boxRound(places, more) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (const [x, y] of places) {
    box[0] = Math.min(box[0], x - more);
    box[1] = Math.min(box[1], y - more);
    box[2] = Math.max(box[2], x + more);
    box[3] = Math.max(box[3], y + more);
  }
  return box;
}

/** Add a hexagon to a path. */
export function hexagon(path, x, y, pitch) {
  path.moveTo(x + HEXAGON[0][0] * pitch, y + HEXAGON[0][1] * pitch);
  for (let i = 1; i < 6; i++) path.lineTo(x + HEXAGON[i][0] * pitch, y + HEXAGON[i][1] * pitch);
  path.closePath();
}

/** Add what stands for a hexagon where it is very small. */
export function brick(path, x, y, pitch) {
  path.rect(x - 0.48 * pitch, y - 0.41 * pitch, 0.96 * pitch, 0.82 * pitch);
}

/** Add a cross. */
export function cross(path, x, y, size) {
  path.moveTo(x - size, y - size);
  path.lineTo(x + size, y + size);
  path.moveTo(x - size, y + size);
  path.lineTo(x + size, y - size);
}

/** The middle of what can be seen of a line: of its end at i `hidden(i)` px cannot. */
export function middle(stage, a, b, hidden) {
  const [dx, dy] = [stage.x[b] - stage.x[a], stage.y[b] - stage.y[a]];
  const part = 0.5 + (0.5 * (hidden(a) - hidden(b))) / (Math.hypot(dx, dy) || 1);
  const held = Math.max(0.25, Math.min(0.75, part));
  return [stage.x[a] + held * dx, stage.y[a] + held * dy];
}

/** Add a line with a head at its end, which stops `gap` px before both places; of places that are
 * near each other less, so that there is a line, and the head is smaller than it. */
export function arrow(path, x0, y0, x1, y1, gap) {
  const long = Math.hypot(x1 - x0, y1 - y0);
  if (long < 1) return;
  const keep = Math.min(gap, 0.3 * long);
  const head = Math.min(HEAD_PX, 0.6 * (long - 2 * keep));
  const ux = (x1 - x0) / long;
  const uy = (y1 - y0) / long;
  const tx = x1 - ux * keep;
  const ty = y1 - uy * keep;
  path.moveTo(x0 + ux * keep, y0 + uy * keep);
  path.lineTo(tx, ty);
  path.moveTo(tx - head * (ux + 0.6 * uy), ty - head * (uy - 0.6 * ux));
  path.lineTo(tx, ty);
  path.lineTo(tx - head * (ux - 0.6 * uy), ty - head * (uy + 0.6 * ux));
}

/** Many shapes in paths of a few: to fill one of thousands takes fifteen times as long. */
export class Pieces {
  constructor() {
    this.paths = [];
    this.count = 0;
  }

  /** The path that the next shape belongs to. */
  next() {
    if (this.count++ % PIECE === 0) this.paths.push(new Path2D());
    return this.paths.at(-1);
  }
}

/** Slanting lines to fill with: no colour is left that means nothing else. */
export function slanting(context) {
  const ratio = context.getTransform().a;
  const size = Math.round(HATCH_PX * ratio);
  const tile = new OffscreenCanvas(size, size);
  const pen = tile.getContext("2d");
  pen.fillStyle = colours.ground;
  pen.fillRect(0, 0, size, size);
  const lines = new Path2D();
  for (const x of [-size, 0, size]) {
    lines.moveTo(x - 2, size + 2);
    lines.lineTo(x + size + 2, -2);
  }
  stroke(pen, colours.soft, 1.2 * ratio, lines);
  const pattern = context.createPattern(tile, "repeat");
  pattern.setTransform(new DOMMatrix([1 / ratio, 0, 0, 1 / ratio, 0, 0]));
  return pattern;
}

/** Draws a hatched cell at a place. It is painted once: to stamp thousands is quicker than to fill
 * as many with one colour; to fill and outline each with a pattern took up to 2.6 times that. */
export function stamped(context, shape, pitch) {
  const ratio = context.getTransform().a;
  const side = Math.ceil(1.2 * pitch * ratio) + 4; // px of the screen; a hexagon is 1.13 high
  const tile = new OffscreenCanvas(side, side);
  const pen = tile.getContext("2d");
  pen.scale(ratio, ratio);
  const [middle, cell, under] = [side / 2 / ratio, new Path2D(), new Path2D()];
  shape(under, middle, middle, 1.02 * pitch);
  shape(cell, middle, middle, pitch);
  pen.fillStyle = colours.ground;
  pen.fill(under);
  pen.fillStyle = slanting(pen);
  pen.fill(cell);
  stroke(pen, colours.soft, 1, cell);
  const image = tile.transferToImageBitmap();
  const at = (x) => Math.round(x * ratio - side / 2) / ratio; // between pixels it would blur
  return (x, y) => context.drawImage(image, at(x), at(y), side / ratio, side / ratio);
}

/** Draw a path of lines. */
export function stroke(context, colour, width, path, dash = []) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.lineCap = dash.length ? "butt" : "round";
  context.setLineDash(dash);
  context.stroke(path);
  context.setLineDash([]);
}

/** Write a word with a rim of the ground's colour, so that lines behind do not cross it out. */
export function word(context, text, x, y, colour, rim, font = "12px system-ui, sans-serif") {
  context.font = font;
  context.textBaseline = "middle";
  context.lineJoin = "round";
  context.strokeStyle = rim;
  context.lineWidth = 3;
  context.strokeText(text, x, y);
  context.fillStyle = colour;
  context.fillText(text, x, y);
}

/** Ring the nodes that the headline is about, each so many px wide. */
export function affected(context, network, stage, size) {
  const rings = new Path2D();
  for (const i of network.affected()) {
    rings.moveTo(stage.x[i] + size, stage.y[i]);
    rings.arc(stage.x[i], stage.y[i], size, 0, 7);
  }
  const colour = network.now.headline?.level === "down" ? colours.alarm : colours.warn;
  stroke(context, colours.ground, 4, rings);
  stroke(context, colour, 2, rings, [2, 2]);
}

/** A sample of that ring for a legend, with what it means. */
export const affectedSample = [(context) => {
  const ring = new Path2D();
  ring.arc(13, 8, 6.5, 0, 7);
  stroke(context, colours.warn, 2, ring, [2, 2]);
}, "affected"];

/** A sample of a cut link: dashes, and a cross at its middle. */
export const cutSample = [(context) => {
  stroke(context, colours.alarm, 2.2, new Path2D("M1 8h24"), [4, 3]);
  const gap = new Path2D();
  cross(gap, 13, 8, 4);
  stroke(context, colours.alarm, 3, gap);
}, "cut"];

/** The frames on their way, a shape for each kind; with less motion in the middle of their link. */
export function flights(context, network, stage, size) {
  const paths = new Map();
  for (const { a, b, kind, p } of network.now.flights) {
    const from = network.index.get(a);
    const to = network.index.get(b);
    if (from === undefined || to === undefined) continue;
    const share = CALM.matches ? 0.5 : p;
    const x = stage.x[from] + (stage.x[to] - stage.x[from]) * share;
    const y = stage.y[from] + (stage.y[to] - stage.y[from]) * share;
    const colour = frameColour(kind);
    if (!paths.has(colour)) paths.set(colour, new Path2D());
    addFrame(paths.get(colour), kind, x, y, size);
  }
  context.lineWidth = 1;
  context.strokeStyle = colours.ground;
  for (const colour of ["ink", "accent", "alarm"]) { // what matters most lies on top
    if (!paths.has(colour)) continue;
    context.fillStyle = colours[colour];
    context.fill(paths.get(colour));
    context.stroke(paths.get(colour));
  }
}

/** A sample of a frame for a legend, with what it means. */
export function flightSample(kind, words) {
  return [(context) => {
    const path = new Path2D();
    addFrame(path, kind, 13, 8, ["alarm", "command"].includes(kind) ? 2 : 4);
    context.fillStyle = colours[frameColour(kind)];
    context.fill(path);
  }, words];
}

function frameColour(kind) {
  return { alarm: "alarm", beacon: "ink", ack: "ink" }[kind] ?? "accent";
}

function addFrame(path, kind, x, y, size) {
  if (kind === "alarm" || kind === "command") diamond(path, x, y, size + 4);
  else if (kind === "beacon" || kind === "ack") {
    path.moveTo(x + size, y);
    path.arc(x, y, size, 0, 7);
  } else path.rect(x - size, y - size, 2 * size, 2 * size);
}

/** Add a square on its corner: an alarm on its way. */
function diamond(path, x, y, size) {
  path.moveTo(x, y - size);
  path.lineTo(x + size, y);
  path.lineTo(x, y + size);
  path.lineTo(x - size, y);
  path.closePath();
}
