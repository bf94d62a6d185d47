// The canvases that a network is drawn on, one above the other, and which part of it they show.
//
// A layer is drawn anew only when something on it changed; at most once a frame of the screen.
import { select } from "d3-selection";
import { zoom, zoomIdentity } from "d3-zoom";

export const LAYERS = { ground: 0, lines: 1, moving: 2, marks: 3 };
const COUNT = 4;
const ZOOM = [0.8, 60];
const RATIO_MAX = 2; // pixels per CSS pixel that drawing is worth

/** A box with layers of canvas over each other. */
export class Stage {
  /** @param {HTMLElement} box what the canvases fill */
  constructor(box) {
    this.box = box;
    this.contexts = Array.from({ length: COUNT }, () => {
      const canvas = document.createElement("canvas");
      canvas.setAttribute("aria-hidden", "true");
      box.append(canvas);
      return canvas.getContext("2d");
    });
    this.dirty = new Array(COUNT).fill(true);
    this.transform = zoomIdentity;
    this.view = null;
    this.marks = () => {}; // draws what is pointed at and what is selected
    this.moves = 0; // counts changes of place
    this.x = [];
    this.y = [];
    this.zoom = zoom().scaleExtent(ZOOM).on("zoom", (event) => {
      this.transform = event.transform;
      box.classList.toggle("zoomed", event.transform.k > 1); // else a finger scrolls the page
      this.moved();
    });
    this.zoom.filter((event) => !event.button && event.type !== "dblclick");
    select(box).call(this.zoom);
    new ResizeObserver(() => this.resize()).observe(box);
  }

  /** Show a view, whole. */
  show(view) {
    this.view = view;
    this.resize();
    this.fit();
  }

  resize() {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (!width || !height) return;
    this.width = width;
    this.height = height;
    this.ratio = Math.min(devicePixelRatio, RATIO_MAX);
    for (const { canvas } of this.contexts) {
      canvas.width = Math.round(width * this.ratio);
      canvas.height = Math.round(height * this.ratio);
    }
    this.zoom.translateExtent([[-width / 2, -height / 2], [1.5 * width, 1.5 * height]]);
    this.#measure();
    this.view?.repaint?.(); // even of the same size a canvas is empty now
    this.moved();
  }

  fit() {
    select(this.box).call(this.zoom.transform, zoomIdentity);
  }

  zoomBy(factor) {
    select(this.box).call(this.zoom.scaleBy, factor);
  }

  /** Bring a node into sight if it is not. */
  reveal(i) {
    const inside = (at, size) => at > 20 && at < size - 20;
    if (inside(this.x[i], this.width) && inside(this.y[i], this.height)) return;
    const [x, y] = this.transform.invert([this.x[i], this.y[i]]);
    select(this.box).call(this.zoom.translateTo, x, y);
  }

  /** Places changed, on the screen or in the world. */
  moved() {
    if (!this.view || !this.width) return;
    const { k, x, y } = this.transform;
    const places = this.view.network.place;
    this.scale = this.fitted * k;
    this.moves += 1;
    for (let i = 0; i < places.length; i++) {
      [this.x[i], this.y[i]] = this.#at(places[i], k, x, y);
    }
    this.x.length = this.y.length = places.length;
    this.touch(LAYERS.ground, LAYERS.lines, LAYERS.moving, LAYERS.marks);
  }

  /** A place of the world on the screen, in px. */
  of(place) {
    const { k, x, y } = this.transform;
    return this.#at(place, k, x, y);
  }

  touch(...layers) {
    for (const layer of layers) this.dirty[layer] = true;
  }

  /** Draw what changed. Returns whether anything did. */
  draw() {
    if (!this.view || !this.width) return false;
    let any = false;
    for (let layer = 0; layer < COUNT; layer++) {
      if (!this.dirty[layer]) continue;
      this.dirty[layer] = false;
      any = true;
      const context = this.contexts[layer];
      context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
      if (layer === LAYERS.marks) {
        this.clear(context);
        this.marks(context);
      } else this.view.draw(layer, context, this);
    }
    return any;
  }

  clear(context) {
    context.clearRect(0, 0, this.width, this.height);
  }

  #measure() {
    if (!this.view) return;
    const [x0, y0, x1, y1] = this.view.bounds();
    const wide = this.width - 2 * this.view.margin[0];
    const high = this.height - 2 * this.view.margin[1];
    this.fitted = Math.min(wide / (x1 - x0), high / (y1 - y0), this.view.scaleMax ?? Infinity);
    this.centre = [(x0 + x1) / 2, (y0 + y1) / 2];
  }

  #at([px, py], k, x, y) {
    return [
      (this.width / 2 + (px - this.centre[0]) * this.fitted) * k + x,
      (this.height / 2 + (py - this.centre[1]) * this.fitted) * k + y,
    ];
  }
}
