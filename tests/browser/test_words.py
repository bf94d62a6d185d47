"""The page by its sources: what is said of a node that is not there, what plots show of silence."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
from matplotlib.colors import to_rgb

from innervate.plot import svg
from innervate.plot.sweeps import contrast

PAGE = Path(__file__).resolve().parents[2] / "src" / "innervate" / "web" / "page"


def said(networks, call="it.off(network, 0)"):
    """What off() says of node 0 of each of these, or what else is called."""
    return found("words.js", f"{json.dumps(networks)}.map((network) => {call})")


def found(file, value, page=PAGE):
    """A value in JavaScript where `it` is one of the page's sources, which lie in `page`."""
    text = f"""globalThis.matchMedia = () => ({{ addEventListener() {{}} }});
    const it = await import({json.dumps((page / file).as_uri())});
    console.log(JSON.stringify({value}));"""
    return run_js(text)


def run_js(text):
    """What a text in JavaScript writes, which is JSON."""
    if shutil.which("node") is None:
        pytest.skip("Node.js is missing")
    done = subprocess.run(
        ["node", "--input-type=module", "-e", text], capture_output=True, check=True, timeout=60
    )
    return json.loads(done.stdout)


def test_who_is_yet_to_come_is_not_called_switched_off():
    def network(kind, source="simulation", **now):
        return {"kind": kind, "scene": {"source": source}, "now": now}

    cases = {
        "not in the team": network("radio", absent=[1]),
        "yet to come": network("mesh", absent=[1]),
        "not there": network("own", absent=[1]),
        "switched off": network("mesh", absent=[0]),
        "switched off ": network("skin"),
        "cut off": network("radio", "live", cut_off=[1]),
        "does not answer": network("radio", "live", cut_off=[0]),
    }
    assert said(list(cases.values())) == [words.strip() for words in cases]


# Texts with names from right to left in them, and with < > where they are set apart.
TURNED = (
    "through <שלום 1>, 1 hop", "<שלום>: 4 nodes", "<عقدة 12>, <עוד 3> - n4",
    "node <مرحبا 12> is off", "<\U0001e900 7>", "n1 - n2: 3 é",
)  # fmt: skip


def test_names_from_right_to_left_turn_nothing_round_on_pages_and_in_reports():
    shown = [text.translate({ord("<"): "\u2068", ord(">"): "\u2069"}) for text in TURNED]
    plain = [text.translate({ord("<"): "", ord(">"): ""}) for text in TURNED]
    assert found("words.js", f"{json.dumps(plain)}.map(it.apart)") == shown
    assert list(map(svg.clean, plain)) == shown
    assert list(map(svg.verbatim, plain)) == plain, "a scenario is copied as it is"


@pytest.mark.parametrize(("number", "unit", "words"), [
    (999, "ms", "999 ms"), (4000, "ms", "4 s"), (1234, "ms", "1.23 s"),
    (4000, "cells", "4000 cells"),
])  # fmt: skip
def test_values_of_plots_are_short(number, unit, words):
    """A scale of 4000 ms had no room for its unit, and nothing else said it."""
    assert found("words.js", f"it.value({number}, '{unit}')") == words


def test_legends_say_of_one_sign_all_that_it_means():
    def network(kind, **scene):
        return {"kind": kind, "scene": {"source": "simulation", **scene}}

    cases = {
        "switched off, or not in the team": network("radio", absent=True),
        "switched off, or yet to come": network("mesh", absent=True),
        "switched off, or not there": network("own", absent=True),
        "switched off": network("mesh"),
        "cut off, or silent": network("radio", source="live"),
    }
    assert said(list(cases.values()), "it.offWords(network)") == list(cases)


@pytest.mark.parametrize(("source", "shown"), [
    ("live", [[[3, 1], [4, 0]], [], [[7, 5]]]), ("simulation", [[[3, 1], [4, 0], [7, 5]]]),
])  # fmt: skip
def test_a_plot_has_a_gap_while_no_live_node_answers(source, shown):
    points = [[1, 9], [2, 8], [3, 1], [4, 0], [5, None], [6, None], [7, 5]]
    assert plotted(source, points, "network.curves('load', 3.5)") == shown


@pytest.mark.parametrize(("times", "source", "span_s"), [
    ([], "simulation", 10), ([3], "simulation", 10), ([3, 3.1, 3.2], "simulation", 10),
    ([0, 200, 400], "simulation", 8000), ([0, 200, 200.1], "simulation", 8000),
    ([0, 200, 200.1, 200.2], "simulation", 10), ([0, 200, 400], "live", 10),
])  # fmt: skip
def test_a_plot_shows_more_time_where_that_goes_fast(times, source, span_s):
    assert plotted(source, [[t, 1] for t in times], "network.span('load')") == span_s


# What views import from others' packages, which only `make page` installs.
TAKEN = {
    "d3-quadtree": ["quadtree"],
    "d3-selection": ["select"],
    "d3-zoom": ["zoom", "zoomIdentity"],
}


@pytest.fixture
def views(tmp_path):
    """A copy of the page's sources that can be imported: what they take of others is 0."""
    page = tmp_path / "page"
    shutil.copytree(PAGE, page, ignore=shutil.ignore_patterns("node_modules"))
    for package, names in TAKEN.items():
        home = page / "node_modules" / package
        home.mkdir(parents=True)
        (home / "package.json").write_text('{"main": "it.mjs"}')
        (home / "it.mjs").write_text("".join(f"export const {name} = 0;" for name in names))
    return page


FIELDS = (("heat", "K"), ("on", "flag"), ("count", "number"))


@pytest.mark.parametrize(("view", "facts"), [
    ("skin.js", "put out: its identity is revoked"),
    ("mesh.js", "node, put out: its identity is revoked"),
    ("plain.js", "put out: its identity is revoked, heat 3,000 K, on yes, count 7"),
])  # fmt: skip
def test_every_page_says_of_who_is_revoked_that_it_was_put_out(views, view, facts):
    name = {"skin.js": "SkinView", "mesh.js": "MeshView", "plain.js": "PlainView"}[view]
    role = "cell" if view == "skin.js" else "node"
    nodes = [{"id": at, "label": f"n{at}", "role": role, "x": at, "y": 0} for at in range(2)]
    scene = {
        "kind": "own",
        "source": "live",
        "nodes": nodes,
        "links": [],
        "can": [],
        "ports": 0,
        "series": [],
        "fields": [{"name": name, "unit": unit} for name, unit in FIELDS],
    }
    state = {"put_out": [0, 1], "way": [0, 2],
             "fields": {"heat": [3000, 3000], "on": [0, 1], "count": [7, 7]}}  # fmt: skip
    network = json.dumps((views / "network.js").as_uri())
    made = f"new it.{name}(new (await import({network})).Network"
    told = found(view, f"""await (async () => {{
      const view = {made}({json.dumps(scene)}));
      view.network.apply({json.dumps(state)});
      return [0, 1].map((i) => view.facts(i));
    }})()""", views)  # fmt: skip
    assert told[1] == facts
    assert "put out" not in told[0]


def test_a_second_fault_is_read_out_with_what_is_new():
    headlines = [
        "1 of 9 nodes is off; 8 of 9 messages were delivered.",
        "2 of 9 nodes are off; 8 of 9 messages were delivered.",
        "1 of 9 nodes is cut off; 2 of 9 nodes are off; 8 of 9 messages were delivered.",
    ]
    asked = [
        (["n3 switched off"], headlines[1], headlines[0]),
        (["link n1 - n2 cut", "n4 killed", "n5 killed"], headlines[2], headlines[1]),
        (["link n1 - n7 cut"], headlines[2], headlines[2]),
    ]
    calls = [f"it.still('degraded', ...{json.dumps(one)})" for one in asked]
    assert found("panel.js", f"[{', '.join(calls)}]") == [
        "still degraded; n3 switched off: 2 of 9 nodes are off",
        "still degraded; link n1 - n2 cut, and 2 more: 1 of 9 nodes is cut off",
        "still degraded; link n1 - n7 cut",
    ]


def viewed(views, view, name, value, state, **scene):
    """A value in JavaScript where `view` is one of a live network of two nodes in this state."""
    nodes = [{"id": at, "label": f"n{at}", "role": "cell", "x": at, "y": 0} for at in range(2)]
    scene = {"kind": "own", "source": "live", "nodes": nodes, "links": [], "can": [], "ports": 0,
             "series": [], **scene}  # fmt: skip
    network = json.dumps((views / "network.js").as_uri())
    colours = json.dumps((views / "colours.js").as_uri())
    return found(view, f"""await (async () => {{
      const {{ colours }} = await import({colours});
      const d = Array.from({{ length: 8 }}, (_, i) => `d${{i}}`);
      Object.assign(colours, {{ panel: "panel", d, h: ["h0"] }});
      const {{ Network }} = await import({network});
      const view = new it.{name}(new Network({json.dumps(scene)}));
      view.network.apply({json.dumps(state)});
      return {value};
    }})()""", views)  # fmt: skip


@pytest.mark.parametrize("colour", ["depth", "port"])
def test_a_cell_that_sends_by_others_elsewhere_looks_as_no_other_does(views, colour):
    state = {"beyond": [1, 0], "parent": [-1, 0], "port": [-1, 7], "depth": [-1, 8]}
    value = f'(view.colour = "{colour}", view.deepest = 8, [0, 1].map((i) => view.kindOf(i)))'
    kinds = viewed(views, "skin.js", "SkinView", value, state)
    assert kinds == ["beyond", {"depth": "d7", "port": "p7"}[colour]]


# Contexts that note what is drawn on the map, and on the tile of one hatched cell.
NOTED = """(() => {
  const calls = [];
  const pen = (of) => new Proxy({}, { set: () => true, get: (_, name) => (...given) => {
    calls.push(`${of} ${name}`);
    return { a: 2, setTransform() {} };
  } });
  globalThis.Path2D = class { moveTo() {} lineTo() {} closePath() {} };
  globalThis.DOMMatrix = class {};
  globalThis.OffscreenCanvas = class {
    getContext() { return pen("tile"); }
    transferToImageBitmap() { return {}; }
  };
  const stage = { scale: 20, x: [10, 30], y: [10, 10], width: 99, height: 99, clear() {} };
  view.draw(0, pen("map"), stage);
  return calls.filter((call) => / (fill|stroke|drawImage)$/.test(call)).sort();
})()"""


def test_hatched_cells_are_stamps_of_one(views):
    """Each filled with a pattern and outlined, 2,000 took 2.3 times as long as plain ones."""
    state = {"beyond": [1, 1], "parent": [-1, -1], "port": [-1, -1], "depth": [-1, -1]}
    assert viewed(views, "skin.js", "SkinView", NOTED, state) == [
        "map drawImage", "map drawImage", "tile fill", "tile fill", "tile stroke", "tile stroke",
    ]  # fmt: skip


def test_a_node_of_which_no_field_is_known_is_filled_as_its_legend_says(views):
    value = "[view.filled(null), view.legend().map(([, words]) => words)]"
    fill, words = viewed(views, "plain.js", "PlainView", value, {}, fields=[])
    assert (fill, words[0]) == ("d7", "node")
    heat = [{"name": "heat", "unit": "K"}]
    fill, words = viewed(views, "plain.js", "PlainView", value, {}, fields=heat)
    assert (fill, words[:3]) == ("panel", ["heat: least", "most", "not known"])


# What a page shows: elements by their names, and what each state made of what is read out.
READ_OUT = """
globalThis.matchMedia = () => ({ addEventListener() {} });
const boxes = {};
globalThis.document = { getElementById: (id) => boxes[id] ??= {
  textContent: "", classList: { toggle() {} } } };
const { Network } = await import(NETWORK);
const { showState } = await import(PANEL);
const scene = { kind: "mesh", source: "simulation", nodes: [], links: [], can: [], series: [] };
const network = new Network(scene);
const said = [];
for (const [t_s, level, text, ...lines] of STEPS) {
  network.apply({ t_s, headline: { level, text, nodes: [] } });
  if (BETWEEN) showState(network, true);
  for (const [at, mark, line] of lines) network.note({ t_s: at, mark, text: line });
  showState(network, true);
  said.push(boxes["state-spoken"].textContent);
}
console.log(JSON.stringify(said));
"""


@pytest.mark.parametrize("between", [False, True])
def test_what_is_lost_while_the_level_stays_is_read_out_once(between):
    """Whether or not the page is drawn between a state and the lines that come behind it."""
    steps = [
        [5.0, "degraded", "A; b."],
        [
            5.1,
            "degraded",
            "A; c.",
            [1.0, "loss", "before anybody looked"],
            [5.1, "return", "n9 switched on"],
        ],
        [5.2, "degraded", "D; c.", [5.2, "loss", "n1 switched off"]],
        [5.3, "degraded", "D; e."],
        [5.4, "down", "F.", [5.4, "loss", "n2 switched off"]],
        [5.5, "down", "F."],
        [5.6, "ok", "Well."],
        [5.7, "ok", "Well.", [5.7, "loss", "a link that nobody needs cut"]],
        [5.8, "degraded", "G."],
        [5.9, "degraded", "G."],
    ]
    text = READ_OUT.replace("STEPS", json.dumps(steps)).replace("BETWEEN", json.dumps(between))
    for name, file in (("NETWORK", "network.js"), ("PANEL", "panel.js")):
        text = text.replace(name, json.dumps((PAGE / file).as_uri()))
    still = "still degraded; n1 switched off: d"
    assert run_js(text) == [
        "degraded: A; b.", "degraded: A; b.", still, still, "down: F.", "down: F.", "ok: Well.",
        "ok: Well.", "degraded: G.", "degraded: G.",
    ]  # fmt: skip


# What a node of a map is filled with, as a name of the theme.
FILLED = """
globalThis.matchMedia = () => ({ addEventListener() {} });
globalThis.Path2D = class { arc() {} moveTo() {} lineTo() {} closePath() {} };
const { colours } = await import(COLOURS);
const { symbol } = await import(SYMBOLS);
Object.assign(colours, { ink: "ink", d: [0, 1, 2, 3, 4, 5, 6, 7].map((n) => `d${n}`) });
const context = { fill() { this.filled = this.fillStyle; }, stroke() {}, setLineDash() {} };
const filled = ["node", "robot"].map((role) => {
  symbol(context, 0, 0, 5, role, 1);
  return context.filled;
});
console.log(JSON.stringify(filled));
"""


def test_nodes_stand_out_from_the_map_in_light_and_dark():
    """By at least 3:1, as WCAG 2.1 has it for what is no text (1.4.11)."""
    text = FILLED
    for name, file in (("COLOURS", "colours.js"), ("SYMBOLS", "symbols.js")):
        text = text.replace(name, json.dumps((PAGE / file).as_uri()))
    themes = (PAGE / "colours.css").read_text().split(":root")[1:]
    assert len(themes) == 2
    for names in run_js(text):
        for theme in themes:
            of = dict(re.findall(r"--(\w+): (#\w{6});", theme))
            assert contrast(to_rgb(of[names]), to_rgb(of["ground"])) >= 3, names


def plotted(source, points, call):
    """What a network says of its plot of these points."""
    scene = {"kind": "mesh", "source": source, "nodes": [], "links": [], "can": [],
             "series": [{"id": "load"}]}  # fmt: skip
    return found(
        "network.js",
        f"""(() => {{
      const network = new it.Network({json.dumps(scene)});
      network.apply({{ series: {{ load: {json.dumps(points)} }} }});
      return {call};
    }})()""",
    )
