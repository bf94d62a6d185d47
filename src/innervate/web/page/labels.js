// Names that keep out of each other's way.

const SIDES = [[0, 1], [0, -1], [1, 0], [-1, 0], [1, 1], [-1, 1], [1, -1], [-1, -1]];
const CELL_PX = 40; // of the grid that finds what is near

/** Finds room for names beside what they name. */
export class Labels {
  constructor(context, width, height) {
    Object.assign(this, { context, width, height });
    this.taken = new Map();
  }

  /** Keep names away from a box. */
  block(x0, y0, x1, y1) {
    for (const key of cells(x0, y0, x1, y1)) {
      if (!this.taken.has(key)) this.taken.set(key, []);
      this.taken.get(key).push([x0, y0, x1, y1]);
    }
  }

  /** Where a name can be written `gap` px from a place, as [x, y, align]; null without room. */
  put(text, x, y, gap) {
    const wide = this.context.measureText(text).width + 4;
    const high = 14;
    for (const [dx, dy] of SIDES) {
      const far = dx && dy ? 0.75 * gap : gap;
      const left = x + dx * far + (dx < 0 ? -wide : dx ? 0 : -wide / 2);
      const top = y + dy * far + (dy < 0 ? -high : dy ? 0 : -high / 2);
      const box = [left, top, left + wide, top + high];
      if (this.claim(...box)) return [left + 2, top + high / 2];
    }
    return null;
  }

  /** Take a box, if it is free and in sight. */
  claim(...box) {
    if (!this.#isFree(box)) return false;
    this.block(...box);
    return true;
  }

  #isFree([x0, y0, x1, y1]) {
    if (x0 < 2 || y0 < 2 || x1 > this.width - 2 || y1 > this.height - 2) return false;
    for (const key of cells(x0, y0, x1, y1)) {
      for (const [a0, b0, a1, b1] of this.taken.get(key) ?? []) {
        if (x0 < a1 && a0 < x1 && y0 < b1 && b0 < y1) return false;
      }
    }
    return true;
  }
}

function* cells(x0, y0, x1, y1) {
  for (let i = Math.floor(x0 / CELL_PX); i <= Math.floor(x1 / CELL_PX); i++) {
    for (let j = Math.floor(y0 / CELL_PX); j <= Math.floor(y1 / CELL_PX); j++) yield `${i},${j}`;
  }
}
