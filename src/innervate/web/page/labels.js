// Names that keep out of each other's way.

const SIDES = [[0, 1], [0, -1], [1, 0], [-1, 0], [1, 1], [-1, 1], [1, -1], [-1, -1]];
const STEP_PX = 6; // between the points of a line that names keep off
const LINE_PX = 2; // how far
const CELL_PX = 40; // of the grid that finds what is near

/** Finds room for names beside what they name. */
export class Labels {
  constructor(context, width, height) {
    Object.assign(this, { context, width, height });
    this.taken = new Map();
    this.names = new Map(); // those of it that are names
    this.lines = new Map(); // where names would rather not be
    this.nodes = new Map(); // their places
  }

  /** Keep names away from a node, and nearer to their own than to it. */
  node(x, y, radius) {
    this.block(x - radius, y - radius, x + radius, y + radius);
    keep(this.nodes, [x, y, x, y]);
  }

  /** Keep names away from a box. */
  block(...box) {
    keep(this.taken, box);
  }

  /** Keep names off a line, as long as there is room elsewhere. */
  avoid(x0, y0, x1, y1) {
    const steps = Math.ceil(Math.hypot(x1 - x0, y1 - y0) / STEP_PX);
    for (let i = 0; i <= steps; i++) {
      const part = steps ? i / steps : 0;
      const [x, y] = [x0 + part * (x1 - x0), y0 + part * (y1 - y0)];
      if (x < 0 || y < 0 || x > this.width || y > this.height) continue;
      keep(this.lines, [x - LINE_PX, y - LINE_PX, x + LINE_PX, y + LINE_PX]);
    }
  }

  /** Where a name can be written `gap` px from a place, as [x, y]; null without room. One that
   * has to be there lies above all but names. */
  put(text, x, y, gap, above = false) {
    const wide = this.context.measureText(text).width + 4;
    const high = 14;
    const boxes = SIDES.map(([dx, dy]) => {
      const far = dx && dy ? 0.75 * gap : gap;
      const left = x + dx * far + (dx < 0 ? -wide : dx ? 0 : -wide / 2);
      const top = y + dy * far + (dy < 0 ? -high : dy ? 0 : -high / 2);
      return [left, top, left + wide, top + high];
    });
    const taken = above ? this.names : this.taken;
    const free = boxes.filter((box) => this.#isInside(box) && isFree(taken, box)
      && (above || this.#isNearest(box, x, y)));
    const box = free.find((one) => isFree(this.lines, one)) ?? free[0];
    if (!box) return null;
    this.block(...box);
    keep(this.names, box);
    return [box[0] + 2, box[1] + high / 2];
  }

  /** Take a box, if it is free and in sight. */
  claim(...box) {
    if (!this.#isInside(box) || !isFree(this.taken, box)) return false;
    this.block(...box);
    return true;
  }

  /** Whether no node is nearer to a name than the one at a place. */
  #isNearest(box, x, y) {
    const away = distance(box, x, y);
    const [x0, y0, x1, y1] = box;
    for (const key of cells(x0 - away, y0 - away, x1 + away, y1 + away)) {
      for (const [px, py] of this.nodes.get(key) ?? []) {
        if (distance(box, px, py) < away) return false;
      }
    }
    return true;
  }

  #isInside([x0, y0, x1, y1]) {
    return x0 >= 2 && y0 >= 2 && x1 <= this.width - 2 && y1 <= this.height - 2;
  }
}

/** How far a place is from a box. */
function distance([x0, y0, x1, y1], x, y) {
  return Math.hypot(Math.max(x0 - x, 0, x - x1), Math.max(y0 - y, 0, y - y1));
}

function keep(taken, box) {
  for (const key of cells(...box)) {
    if (!taken.has(key)) taken.set(key, []);
    taken.get(key).push(box);
  }
}

function isFree(taken, [x0, y0, x1, y1]) {
  for (const key of cells(x0, y0, x1, y1)) {
    for (const [a0, b0, a1, b1] of taken.get(key) ?? []) {
      if (x0 < a1 && a0 < x1 && y0 < b1 && b0 < y1) return false;
    }
  }
  return true;
}

function* cells(x0, y0, x1, y1) {
  for (let i = Math.floor(x0 / CELL_PX); i <= Math.floor(x1 / CELL_PX); i++) {
    for (let j = Math.floor(y0 / CELL_PX); j <= Math.floor(y1 / CELL_PX); j++) yield `${i},${j}`;
  }
}
