// What lies under the pointer, in words, beside it.
import { told } from "./panel.js";

const AWAY_PX = 14; // from the pointer

/** A small box on the stage that follows the mouse. */
export class Tip {
  /** @param {HTMLElement} box the stage's */
  constructor(box) {
    this.stage = box;
    this.box = document.createElement("div");
    this.box.id = "tip";
    this.box.setAttribute("role", "tooltip");
    this.parts = ["b", "span", "i"].map((tag) => document.createElement(tag));
    this.box.append(...this.parts);
    this.box.hidden = true;
    box.append(this.box);
  }

  /** Show {node} or {link} beside a place of the stage, and what a click would do; or nothing. */
  show(view, what, place, deed) {
    this.what = what;
    this.box.hidden = !what;
    if (!what) return;
    this.deed = deed;
    this.refresh(view);
    const { clientWidth: width, clientHeight: height } = this.stage;
    const { offsetWidth: wide, offsetHeight: high } = this.box;
    const [x, y] = place;
    const left = x + AWAY_PX + wide > width ? x - AWAY_PX - wide : x + AWAY_PX;
    const top = y + AWAY_PX + high > height ? y - AWAY_PX - high : y + AWAY_PX;
    this.box.style.left = `${Math.max(2, left)}px`;
    this.box.style.top = `${Math.max(2, top)}px`;
  }

  /** What is known of it may have changed while the mouse rests. */
  refresh(view) {
    if (!this.what) return;
    const { name, facts } = told(view, this.what);
    const deed = this.deed(this.what);
    const texts = [name, facts, deed ? `a click ${deed} it` : ""];
    this.parts.forEach((part, i) => {
      if (part.textContent !== texts[i]) part.textContent = texts[i];
    });
  }
}
