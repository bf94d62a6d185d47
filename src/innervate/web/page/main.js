// The page of `innervate watch`: takes in what the server says, shows it, and sends back commands.
import { setUpTheme } from "./colours.js";
import { CommandBox } from "./command.js";
import { Controls } from "./controls.js";
import { setUpKeys, showKeys } from "./keys.js";
import { showLegend } from "./legend.js";
import { Network } from "./network.js";
import { Card, Log, commandFor, showNumbers, showState } from "./panel.js";
import { Plots } from "./plots.js";
import { Pointer } from "./pointer.js";
import { MeshView } from "./mesh.js";
import { PlainView } from "./plain.js";
import { RadioView } from "./radio.js";
import { SkinView } from "./skin.js";
import { Connection, TOKEN } from "./socket.js";
import { LAYERS, Stage } from "./stage.js";
import { Timeline } from "./timeline.js";
import { Tip } from "./tip.js";
import { plural } from "./words.js";

const VIEWS = { skin: SkinView, mesh: MeshView, radio: RadioView };
const SOURCES = { simulation: "simulation", run: "recorded run", live: "live nodes" };
const TOUCHED = 200; // of 255: what a click presses
const PANEL_MS = 100; // numbers and plots follow this often: nobody reads faster
const $ = (id) => document.getElementById(id);

let network = null;
let view = null;
let plots = null;
let connected = false;
let chosenColour = null; // outlives a server that is started anew
let panelDue = 0;
let panelStale = false;

/** For whoever measures: `innervate.fps`, the slowest drawing of the last second, where on the page
 * a node or link is, by its name, and the moments that plots mark. */
const speedometer = {
  fps: 0, frames: 0, states: 0, slowest_ms: 0, at: placeOf, marks: () => network.marks,
};
window.innervate = speedometer;
let second = performance.now();
let counted = 0;
let slowest = 0;

const stage = new Stage($("stage"));
const log = new Log($("log"));
const controls = new Controls(send);
const card = new Card(change, new CommandBox(send));
const pointer = new Pointer(stage, {
  select: (what) => card.show(view, what), act, nodesOnly: () => $("tool").value === "touch",
  over: (what, place) => tip.show(view, what, place, deed),
});
const tip = new Tip(stage.box);
const timeline = new Timeline($("timeline"));
const nextTheme = setUpTheme($("theme"), redraw);
const connection = new Connection(onMessage, onConnection);

function send(command) {
  if (!connection.send(command)) {
    log.add({ text: "not connected: nothing was sent", level: "bad" });
  }
}

/** Cut, kill, heal, revive or touch what was clicked. */
function act(what) {
  const tool = $("tool").value;
  if (tool === "look") return;
  if (tool === "touch") {
    if (network.nodes[what.node]?.role !== "cell") return; // a finger neither cuts nor kills
    const value = network.now.touch[what.node] ? 0 : TOUCHED;
    return send({ do: "touch", node: network.nodes[what.node].id, value });
  }
  change(what);
}

/** What a click on something would do, as a verb; "" nothing. */
function deed(what) {
  const tool = $("tool").value;
  if (tool === "look" || !pointer.isLarge()) return "";
  if (tool === "touch") return network.nodes[what.node]?.role === "cell" ? "touches" : "";
  return Card.deed(network, what);
}

/** Cut, kill, heal or revive something, whatever a click does. */
function change(what) {
  const command = commandFor(network, what);
  if (command) send(command);
}

function onMessage(message) {
  if (message.type === "scene") showScene(message);
  else if (message.type === "state" && network) takeIn(message);
  else if (message.type === "log") takeLine(message);
  else if (message.type === "error") log.add({ text: message.text, level: "bad" });
  else if (message.type === "end") log.add({ text: message.text, level: "info" });
  else if (message.type === "saved") download(message.toml);
}

function onConnection(open, refused) {
  connected = open;
  panelStale = true;
  $("connection").textContent = open ? "connected" : "not connected";
  $("connection").classList.toggle("lost", !open);
  $("lost").hidden = open;
  $("lost").textContent = refused
    ? "The server refuses this address: open the one that it printed, with its token."
    : "The connection to the server is lost. Trying again …";
}

function showScene(scene) {
  const before = pointer.selected && nameOf(pointer.selected);
  network = new Network(scene);
  view = new (VIEWS[scene.kind] ?? PlainView)(network);
  pointer.forget();
  card.show(view, null);
  log.clear();
  $("name").textContent = scene.name;
  document.title = `${scene.name} - innervate watch`;
  $("what").textContent = [scene.kind, SOURCES[scene.source] ?? scene.source, scene.part]
    .filter(Boolean).join(", ");
  $("report").hidden = !scene.report;
  $("report").href = `report?token=${encodeURIComponent(TOKEN)}`;
  const choices = view.choices();
  if (choices.some(([name]) => name === chosenColour)) view.colour = chosenColour;
  options($("colour"), $("colour-box"), choices, view.colour);
  const { can } = network;
  const acts = can.has("cut") || can.has("kill");
  const isLive = scene.source === "live";
  const deed = isLive ? (can.has("cut") ? "cuts, or heals" : "cuts off or lets back")
    : !can.has("kill") ? "cuts or heals"
      : can.has("cut") ? "cuts and kills, or heals" : "switches off or on";
  options($("tool"), $("tool-box"), [
    ...(acts ? [["cut", deed]] : []),
    ...(can.has("touch") ? [["touch", "touches"]] : []),
    ["look", "only selects"],
  ]);
  $("stage").classList.toggle("acts", acts);
  showKeys(new Set([...can, acts && "act", choices.length > 1 && "colour"]));
  $("stage").setAttribute("aria-label", `Map of ${scene.name}: `
    + `${plural(scene.nodes.length, "node")}, ${plural(scene.links.length, "link")}`);
  const runs = scene.kind === "radio" && !isLive; // nobody tells who sent when
  $("timeline").hidden = !runs;
  timeline.network = runs ? network : null;
  controls.scene(network);
  plots = new Plots($("plots"), network);
  stage.show(view);
  showLegend($("legend"), view);
  panelStale = true;
  const again = before && whatIs(before); // there is a link more, or the server is back
  if (again) pointer.select(again);
}

function nameOf({ node, link }) {
  return node === undefined ? network.linkName(link) : network.nodes[node].label;
}

/** The node or link of a name, or null. */
function whatIs(name) {
  const node = network.nodes.findIndex(({ label }) => label === name);
  const link = network.links.findIndex((_, i) => network.linkName(i) === name);
  return node >= 0 ? { node } : link >= 0 ? { link } : null;
}

/** Fill a list of choices; one with a single choice is not shown. */
function options(list, box, choices, chosen) {
  list.replaceChildren(...choices.map(([value, text]) => {
    const option = document.createElement("option");
    Object.assign(option, { value, textContent: text, selected: value === chosen });
    return option;
  }));
  box.hidden = choices.length < 2;
}

function takeIn(state) {
  const changed = network.apply(state);
  speedometer.states += 1;
  if (changed.has("back_s")) log.forgetFrom(state.back_s);
  if (changed.has("position")) stage.moved();
  stage.touch(...view.layersOf(changed));
  panelStale = true;
}

function takeLine(line) {
  log.add(line);
  network?.note(line);
  panelStale = true;
}

function placeOf(name) {
  const { left, top } = stage.box.getBoundingClientRect();
  const what = whatIs(name);
  if (!what) return null;
  const [a, b] = what.node === undefined ? network.ends[what.link] : [what.node, what.node];
  return [left + (stage.x[a] + stage.x[b]) / 2, top + (stage.y[a] + stage.y[b]) / 2];
}

function redraw() {
  view?.repaint?.();
  stage?.touch(...Object.values(LAYERS));
  if (view) showLegend($("legend"), view);
  panelStale = true;
}

function download(toml) {
  const link = document.createElement("a");
  const own = toml.replaceAll(/[\u2068\u2069]/g, ""); // those marks are ours: scenarios have none
  link.href = URL.createObjectURL(new Blob([own], { type: "application/toml" }));
  link.download = `${network.scene.name.replace(/[^\w-]+/g, "-") || "scenario"}.toml`;
  link.click();
  URL.revokeObjectURL(link.href);
}

function setColour(name) {
  view.colour = chosenColour = name;
  $("colour").value = name;
  redraw();
}

$("colour").addEventListener("change", () => setColour($("colour").value));
$("unselect").addEventListener("click", () => pointer.select(null));
$("zoom-in").addEventListener("click", () => stage.zoomBy(1.5));
$("zoom-out").addEventListener("click", () => stage.zoomBy(1 / 1.5));
$("zoom-fit").addEventListener("click", () => stage.fit());
setUpKeys([
  [" ", "Space", "pause or go on", () => controls.toggle(), "pause"],
  [".", ".", "one event further, when paused", () => send({ do: "step" }), "step"],
  ["[", "[", "slower", () => controls.shift(-1), "speed"],
  ["]", "]", "faster", () => controls.shift(1), "speed"],
  ["+", "+", "zoom in", () => stage.zoomBy(1.5)],
  ["-", "−", "zoom out", () => stage.zoomBy(1 / 1.5)],
  ["0", "0", "show all", () => stage.fit()],
  ["c", "c", "next colouring", nextColour, "colour"],
  ["t", "t", "light, dark or as the system", () => nextTheme()],
]);

function nextColour() {
  const names = view.choices().map(([name]) => name);
  if (names.length > 1) setColour(names[(names.indexOf(view.colour) + 1) % names.length]);
}


function frame(now) {
  if (network) {
    const before = performance.now();
    stage.draw();
    timeline.draw();
    if (panelStale && now >= panelDue) {
      panelStale = false;
      panelDue = now + PANEL_MS;
      showNumbers(network);
      showState(network, connected);
      controls.state(network);
      plots.draw();
      if (pointer.selected) card.show(view, pointer.selected);
      tip.refresh(view);
    }
    slowest = Math.max(slowest, performance.now() - before);
  }
  speedometer.frames += 1;
  if (now - second >= 1000) {
    speedometer.fps = (1000 * (speedometer.frames - counted)) / (now - second);
    speedometer.slowest_ms = slowest;
    [second, counted, slowest] = [now, speedometer.frames, 0];
  }
  requestAnimationFrame(frame);
}
requestAnimationFrame(frame);
