// Any network: nodes and links as those of a mesh, coloured by the fields that its protocol has.
import { colours, shade } from "./colours.js";
import { Labels } from "./labels.js";
import { MeshView, NAME_PX } from "./mesh.js";
import { affected, affectedSample, arrow, cross, cutSample, stroke, word } from "./shapes.js";
import { LAYERS } from "./stage.js";
import { PUT_OUT, off, offWords } from "./words.js";

const FONT = "12px system-ui, sans-serif";
const FEW = 400; // up to so many links names keep off, as far as there is room

/** A field's value in words; units that declare no more than a kind of number say nothing here. */
function inUnit(value, unit) {
  if (unit === "flag") return value ? "yes" : "no";
  const said = value.toLocaleString("en");
  return ["", "number", "raw", "id"].includes(unit) ? said : `${said} ${unit}`;
}

/** Draws a network of which no more is known than what its nodes declare. */
export class PlainView extends MeshView {
  constructor(network) {
    super(network);
    this.fields = network.scene.fields ?? [];
    this.colour = this.fields[0]?.name ?? "";
  }

  choices() {
    return this.fields.map(({ name }) => [name, name]);
  }

  layersOf(changed) {
    const found = super.layersOf(changed);
    if (changed.has("fields") && !found.includes(LAYERS.lines)) found.push(LAYERS.lines);
    return found;
  }

  draw(layer, context, stage) {
    if (layer !== LAYERS.lines) super.draw(layer, context, stage);
    else this.#nodes(context, stage);
  }

  facts(i) {
    const { now } = this.network;
    if (!now.node_up[i]) return off(this.network, i);
    const said = this.fields.map(({ name, unit }) => [name, now.fields?.[name]?.[i], unit]);
    const known = said.filter(([, value]) => value !== undefined && value !== null);
    const facts = known.map(([name, value, unit]) => `${name} ${inUnit(value, unit)}`);
    if (now.put_out[i]) facts.unshift(PUT_OUT);
    return facts.join(", ") || "nothing known";
  }

  legend() {
    const disc = (fill, up = 1) => (context) => this.#disc(context, 13, 8, 5, fill, up);
    const found = this.colour === "" ? [[disc(this.filled(null)), "node"]]
      : [[disc(colours.h[0]), `${this.colour}: least`], [disc(colours.h[7]), "most"]];
    if (this.colour !== "" && this.network.scene.source === "live") {
      found.push([disc(this.filled(null)), "not known"]);
    }
    found.push([disc(colours.faint, 0), offWords(this.network)], affectedSample);
    if (this.network.links.length) found.push(cutSample);
    return found;
  }

  /** What a node of this value is filled with; null: it has none. */
  filled(value, least = 0, most = 0) {
    if (value !== null) return colours.h[shade(value - least, most - least)];
    return this.colour === "" ? colours.d[7] : colours.panel;
  }

  #nodes(context, stage) {
    const { network } = this;
    const { now, nodes } = network;
    const dot = this.dot(stage.scale);
    const values = now.fields?.[this.colour] ?? [];
    const known = values.filter((value) => value !== null);
    const [least, most] = [Math.min(...known), Math.max(...known)];
    stage.clear(context);
    const routes = new Path2D();
    nodes.forEach((_, i) => {
      const next = now.node_up[i] ? network.parentOf(i) : -1;
      if (next >= 0) arrow(routes, stage.x[i], stage.y[i], stage.x[next], stage.y[next], dot + 4);
    });
    stroke(context, colours.accent, 2.2, routes);
    context.font = FONT;
    context.textAlign = "left";
    const names = new Labels(context, stage.width, stage.height);
    if (network.ends.length <= FEW) {
      for (const [a, b] of network.ends) {
        names.avoid(stage.x[a], stage.y[a], stage.x[b], stage.y[b]);
      }
    }
    nodes.forEach((_, i) => {
      const [x, y, value] = [stage.x[i], stage.y[i], values[i] ?? null];
      this.#disc(context, x, y, dot, this.filled(value, least, most), now.node_up[i]);
      names.node(x, y, dot + 2);
    });
    affected(context, network, stage, dot + 5);
    nodes.forEach(({ label }, i) => {
      const value = values[i] ?? null; // colour alone would not tell it
      let at = null;
      const text = (value === null ? [label] : [`${label}: ${value}`, label])
        .find((one) => (at = names.put(one, stage.x[i], stage.y[i], dot + NAME_PX)));
      if (at) word(context, text, ...at, colours.soft, colours.ground, FONT);
    });
  }

  #disc(context, x, y, dot, fill, up) {
    const path = new Path2D();
    path.arc(x, y, dot, 0, 7);
    context.fillStyle = up ? fill : colours.faint;
    context.fill(path);
    stroke(context, colours.soft, 1.2, path);
    if (up) return;
    const gone = new Path2D();
    cross(gone, x, y, dot + 2);
    stroke(context, colours.alarm, 2.2, gone);
  }
}
