// Pause, step, speed, time: what the reader does to the clock of the network.
import { SPEEDS, clock, speed, speedIndex, whole } from "./words.js";

const $ = (id) => document.getElementById(id);

/** The controls below the network. */
export class Controls {
  /** @param {(command: object) => void} send */
  constructor(send) {
    this.send = send;
    this.speed = 1;
    this.held = false; // the reader has the time slider in hand
    $("speed").max = SPEEDS.length - 1;
    $("go").addEventListener("click", () => this.toggle());
    $("step").addEventListener("click", () => send({ do: "step" }));
    $("save").addEventListener("click", () => send({ do: "save" }));
    $("speed").addEventListener("input", () => this.#setSpeed(Number($("speed").value)));
    const seek = $("seek");
    seek.addEventListener("input", () => {
      this.held = true;
      this.#showTime(Number(seek.value));
    });
    seek.addEventListener("change", () => {
      this.held = false;
      send({ do: "seek", t_s: Number(seek.value) });
    });
  }

  /** Show what a source allows. */
  scene(network) {
    const { can, scene } = network;
    $("go").hidden = !can.has("pause");
    $("step").hidden = !can.has("step");
    $("save").hidden = !can.has("save");
    $("speed-box").hidden = !can.has("speed");
    $("seek-box").hidden = !can.has("seek") || !scene.duration_s;
    this.duration_s = scene.duration_s;
    this.#setEnd(scene.duration_s);
  }

  state(network) {
    const { paused, at_end: atEnd, t_s } = network.now;
    this.paused = paused;
    this.again = atEnd && network.can.has("seek");
    $("go").textContent = this.again ? "Replay" : paused ? "Play" : "Pause";
    $("go").disabled = atEnd && !this.again;
    $("go").classList.toggle("again", this.again);
    $("transport").classList.toggle("ended", atEnd);
    $("step").disabled = !paused || atEnd;
    if (network.now.speed !== this.speed || !$("speed-text").textContent) {
      this.speed = network.now.speed;
      $("speed").value = speedIndex(this.speed);
    }
    $("speed-text").textContent = speed(this.speed);
    $("speed").setAttribute("aria-valuetext", speed(this.speed));
    if (atEnd) this.#setEnd(t_s); // all may be said before its time is over
    else if (t_s > this.end_s) this.#setEnd(this.duration_s);
    if (!this.held) {
      $("seek").value = t_s;
      this.#showTime(t_s);
    }
    if (atEnd) $("clock").textContent += " – end";
  }

  /** Pause, go on, or begin anew at the end. */
  toggle() {
    if (this.again) {
      this.send({ do: "seek", t_s: 0 });
      if (this.paused) this.send({ do: "go" });
    } else this.send({ do: this.paused ? "go" : "pause" });
  }

  /** Slower (-1) or faster (1). */
  shift(by) {
    const at = Math.max(0, Math.min(SPEEDS.length - 1, speedIndex(this.speed) + by));
    this.#setSpeed(at);
  }

  #setSpeed(at) {
    this.send({ do: "speed", value: SPEEDS[at] });
  }

  #setEnd(t_s) {
    this.end_s = t_s;
    $("seek").max = t_s ?? 1;
  }

  #showTime(t_s) {
    const of = this.end_s ? ` / ${whole(this.end_s)}` : "";
    $("clock").textContent = `${clock(t_s, this.paused ? 6 : 3)}${of}`;
    $("seek").setAttribute("aria-valuetext", clock(t_s));
  }
}
