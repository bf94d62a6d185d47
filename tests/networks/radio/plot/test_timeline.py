from types import SimpleNamespace

import pytest

from innervate import scenario
from innervate.dialect.access import REPORT_DELIVERED
from innervate.networks.radio.analysis import air, packets
from innervate.networks.radio.analysis import summary as radio
from innervate.networks.radio.analysis.headline import headline
from innervate.networks.radio.plot import report as radio_report
from innervate.networks.radio.plot import scene as radio_scene
from innervate.networks.radio.plot import timeline as radio_timeline
from innervate.networks.radio.plot import words as words
from innervate.networks.radio.plot.figures import FIGURES
from innervate.networks.radio.protocol.constants import (
    CRR,
    DATA,
    NO_PROOF,
    OPEN,
    REPORT,
    REPORT_FAILED,
    REPORT_TURN,
)
from innervate.networks.radio.scenario.plan import RadioFault
from innervate.plot import figures, page
from innervate.scenario.actions.channel import FADE, GARBLE, JOIN, KILL, LEAVE
from tests.networks.radio.runs import START_US, run
from tests.networks.skin.plot.test_report import read
from tests.plot.ink import ink_of

FAULTS = [
    RadioFault(50_000, KILL, 1, 0, 0), RadioFault(60_000, GARBLE, 2, 1, 1),
    RadioFault(70_000, FADE, 3, 2, 2), RadioFault(200_000, JOIN, 1, 0, 3),
    RadioFault(300_000, LEAVE, 0, 0, 4),
]  # fmt: skip
SATURATED = {"traffic": "saturated", "packets": 60}
CASES = {
    "two": (2, {}),
    "four": (4, {}),
    "ten slow": (10, {"packet_slots": 5, "ta": 2000}),
    "twenty": (20, {}),
    "hundred": (100, {"packet_slots": 5}),
    "saturated": (4, SATURATED),
    "faults": (5, SATURATED | {"faults": FAULTS, "duration_s": 0.5}),
    "arrivals": (3, {"arrivals": [[0, 9000], [0], [50_000]], "wanted": 0, "duration_s": 0.2}),
    "too short": (10, {"duration_s": (START_US + 4000) / 1e6}),
    "nothing": (3, {"arrivals": [[], [], []], "duration_s": 0.1}),
}


@pytest.fixture(scope="module")
def runs():
    # Plain, for small runs do not repay compiling; the large one would take long.
    told = scenario.from_dict({"kind": "radio", "stations": 5})  # for what it says of delays
    return {name: run(n, plain=n < 50, scenario=told, **more) for name, (n, more) in CASES.items()}


def timeline(*given):
    return radio_timeline.draw(radio_scene.scene(*given))


def kinds(tree):
    return [part for node in tree.iter() for part in (node.get("class") or "").split()]


@pytest.mark.parametrize("name", CASES)
def test_every_run_has_a_report(runs, name, parse):
    result = runs[name]
    summary = radio.summarize(result, '<Team> & "ball"')
    shown = read(page.page("x", radio_report.body(result, summary)) + "<svg ></svg>")
    assert '<Team> & "ball"' in shown
    assert "No packet was lost silently." in shown
    parse(timeline(result))


def test_the_first_sentence_says_what_happened(runs):
    def told(name):
        return radio_report.sentences(runs[name], radio.summarize(runs[name]))[0]

    slots = radio.summarize(runs["four"])["duration_slots"]
    assert told("four") == (
        f"4 robots started at once; every packet was delivered {slots:.0f} slots "
        f"({slots * 0.208:.1f} ms) later."
    )
    assert told("too short").endswith("no packet was delivered in 0.104 s.")
    assert "always had something to send; delivered packets filled 9" in told("saturated")
    assert told("arrivals").startswith("3 robots had 4 packets to send; 100 % of them were")


def test_packets_lost_silently_are_said_first(runs):
    well = radio_report.body(runs["four"], radio.summarize(runs["four"]))
    assert '<h1>All 4 packets were delivered.</h1>\n<p class="status">ok</p>' in well
    facts = radio.facts(runs["four"])._replace(lost_silently=2, delivered=2)
    lost = headline(facts).as_summary()
    summary = radio.summarize(runs["four"]) | {"lost_silently": 2, "headline": lost}
    body = radio_report.body(runs["four"], summary)
    assert "Lost silently: 2 packets that nobody received" in body
    assert "<h1>2 packets were lost silently" in body
    assert '<p class="status warn">degraded</p>' in body


def test_lanes_show_what_stations_hear(runs, parse, texts):
    drawing = timeline(runs["four"])
    shown = texts(drawing)
    assert [shown.count(f"station {i}") for i in range(4)] == [1, 1, 1, 1]
    assert shown.count("CD") == shown.count("VOC") == 4
    assert {"slots", "ms of the run", "collision noticed", "data 3"} <= set(shown)
    found = kinds(parse(drawing))
    assert found.count("ones") == 2 * 4 + 1  # CD and VOC, and the legend
    assert found.count("deaf") == 4 + 1
    assert found.count("warn") == 4 + 1
    assert found.count("done") == 4 + 1
    # The frame that would begin another round proves the last packet.
    assert found.count("p0") == 4 + 1 + 1


def test_many_stations_have_boxes_alone(runs, parse, texts):
    drawing = timeline(runs["hundred"])
    assert "CD" not in texts(drawing)
    assert "ones" not in kinds(parse(drawing))
    assert drawing.height < 1100
    assert len(drawing.render()) < 200_000


def test_states_differ_in_more_than_colour(runs):
    frames = [words.frame_words("csma-cd-r/practical", kind) for kind in (CRR, DATA, OPEN, REPORT)]
    assert len({frame.letter for frame in frames}) == 4
    assert len({(frame.height, "outlined" in frame.kind) for frame in frames}) == 4
    shown = radio_scene.scene(runs["four"])
    assert sum(box.collided for box in shown.boxes) == 4
    assert timeline(runs["four"]).render().count('class="struck"') == 2


def test_the_window_is_the_first_resolution(runs):
    for name in ("four", "saturated"):
        result = runs[name]
        low, high, origin = radio_scene.resolution(result)
        first = air.groups(result)
        assert origin == first.start[first.collision][0]
        assert low < origin < high
        served = packets.successes(result)
        inside = served[(served["end"] > low) & (served["end"] < high)]
        assert set(inside["node"].tolist()) == set(range(4))
        assert len(inside) <= 5
    whole = radio_scene.resolution(runs["hundred"])
    begin = radio_scene.beginning(runs["hundred"], whole)
    assert begin.from_us >= whole.from_us
    assert 0 < begin.origin_us - begin.from_us <= 0.05 * (begin.to_us - begin.from_us) + 1
    assert begin.to_us - begin.from_us < 0.31 * (whole.to_us - whole.from_us)
    assert radio_scene.beginning(runs["two"], radio_scene.Window(0, 60 * 208, 0)) is None


def test_any_window_can_be_drawn(runs, texts, parse):
    drawing = timeline(runs["saturated"], 100_000, 160_000)
    assert {"100", "160"} <= set(texts(drawing))
    parse(timeline(runs["saturated"], -5_000, 10**9))
    with pytest.raises(ValueError, match="must end after it begins"):
        timeline(runs["saturated"], 5, 5)


def test_too_many_transmissions_are_cut(runs, monkeypatch):
    monkeypatch.setattr(radio_scene, "BOXES_MAX", 30)
    monkeypatch.setattr(radio_scene, "LANES_MAX", 3)
    shown = radio_scene.scene(runs["saturated"], 0, 10**6)
    assert shown.cut
    assert len(shown.stations) == 3
    assert len(shown.boxes) <= 30
    assert shown.window.to_us < 10**6


def overlaps(drawing, parse):
    """Pairs of texts in a drawing whose boxes overlap, letters taken as 6 px wide."""
    spans = []
    for node in parse(drawing).iter():
        if node.tag.endswith("}text") and node.text:
            wide = 6.0 * len(node.text)
            x = float(node.get("x")) - {"end": wide, "middle": wide / 2}.get(
                node.get("text-anchor"), 0
            )
            spans.append((x, x + wide, float(node.get("y")), node.text))
    return [
        (one[3], other[3])
        for i, one in enumerate(spans)
        for other in spans[:i]
        if one[0] < other[1] and other[0] < one[1] and abs(one[2] - other[2]) < 9
    ]


@pytest.mark.parametrize("name", CASES)
def test_labels_do_not_overlap(runs, name, parse):
    assert overlaps(timeline(runs[name]), parse) == []


def test_who_is_off_is_shown(runs, parse, texts):
    drawing = timeline(runs["faults"], 0, 250_000)
    assert "off" in texts(drawing)
    assert kinds(parse(drawing)).count("off") >= 2
    body = radio_report.body(runs["faults"], radio.summarize(runs["faults"]))
    assert "station 1: switched off without warning" in body
    assert "station 3: next 2 CR-Rs not heard by anybody" in body


@pytest.mark.parametrize(
    ("from_us", "to_us", "said"),
    [
        (0, 40_000, []),
        (0, 250_000, ["switched off"]),
        (310_000, 450_000, ["not in the team"]),
        (0, 500_000, ["switched off, or not in the team"]),
    ],
)
def test_the_legend_says_why_robots_are_off(runs, texts, from_us, to_us, said):
    found = texts(timeline(runs["faults"], from_us, to_us))
    assert [text for text in found if "switched off" in text or "in the team" in text] == said


@pytest.mark.parametrize("figure", FIGURES)
@pytest.mark.parametrize("name", ["four", "hundred", "faults", "nothing"])
@pytest.mark.few(6)
def test_each_figure_draws(runs, name, figure, tmp_path):
    made = figures.draw(SimpleNamespace(result=runs[name]), figure)
    assert 0.003 < ink_of(made, tmp_path) < 0.97


def test_an_unknown_figure_is_refused(runs):
    with pytest.raises(ValueError, match='no figure "routes"; there are timeline, delay'):
        figures.draw(SimpleNamespace(result=runs["four"]), "routes")


def test_words_of_reports():
    practical = "csma-cd-r/practical"
    failed = words.report_words(practical, REPORT_FAILED, 5, NO_PROOF)
    assert failed == "packet not delivered, stays in the queue: nobody confirmed it"
    assert words.report_words(practical, REPORT_DELIVERED, 5, 3) == "3 packets delivered"
    assert words.report_words(practical, REPORT_TURN, 2, 0).endswith("place 2 of the round")
    assert words.report_words("csma-cd-r/paper", REPORT_TURN, 2, 4).endswith("turn 2 of 4")
    assert words.report_words("unheard-of", 99, 1, 2) == "report 99"
    assert words.protocol_words("unheard-of") == "unheard-of"
    assert words.frame_words("unheard-of", 9).letter == "?"


@pytest.mark.parametrize(
    ("slots", "text"),
    [(1, "1 slot"), (8.46, "8.46 slots"), (131.4, "131 slots"), (12_340, "12,340 slots")],
)
def test_slots_in_words(slots, text):
    assert words.slots_words(slots) == text
