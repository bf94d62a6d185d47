"""What `check` warns of, on both sides of where it begins; silent twins differ in that alone."""

import ast
import inspect

import pytest

from innervate import scenario
from innervate.networks.mesh.scenario import words as mesh
from innervate.networks.radio.scenario import words as radio
from innervate.networks.skin.scenario import warnings as skin


def links(*pairs):
    return "".join(f"[[link]]\na = 'n{a}'\nb = 'n{b}'\n" for a, b in pairs)


def line(nodes):
    return links(*((n, n + 1) for n in range(nodes - 1)))


def every_pair(nodes):
    return [(a, b) for a in range(nodes) for b in range(a)]


def star(leaves, joined=0):
    """A hub with so many leaves, of which the first two are joined, or four in two pairs, ..."""
    pairs = [(2 * k + 1, 2 * k + 2) for k in range(joined)]
    return links(*((0, n) for n in range(1, leaves + 1)), *pairs)


def grid(nodes):
    return f"nodes = {nodes}\n[placement]\nlayout = 'grid'\n"


def patch(rate_hz=0, more=""):
    return (
        f"{more}\n[[patch]]\ncolumns = 8\nrows = 10\n[[interface]]\nrow = 0\ncolumn = 3\n"
        f"[data]\nrate_hz = {rate_hz}\n"
    )


# A way from n0 over n1 to n2 and n3, which have each other, and nothing else to the PC.
TIGHT = "".join(f"[[link]]\na = '{a}'\nb = '{b}'\n" for a, b in (
    ("pc.0", "n0"), ("pc.1", "n0"), ("n0", "n1"), ("n1", "n2"), ("n2", "n3"), ("n3", "n1"),
))  # fmt: skip
FENCE = "nodes = 10\n[radio]\nmean_degree = 8\n[fence]\npolygon = [[0, 0], [9, 0], [9, 9]]\n"
ROBOT = "[[robot]]\nnode = 9\nrandom = true\nspeed_mps = 1\n"
FLOW = "nodes = 10\n[radio]\nmean_degree = 8\n[[flow]]\nfrom = 1\nto = 2\n"
EARLY = "[[flow]]\nfrom = 'all'\nto = 'random'\nstart_s = 7.9\n"
ACKS = "nodes = 10\n[radio]\nmean_degree = 8\nturnaround_us = 192\n[protocol]\n"

# Kind, words, a scenario of which they are said, one of which they are not.
CASES = [
    # 8 x 10 cells. A port carries 1 / 60 us less 250 beacons: 16,416.7 a second, 205.2 a cell.
    ("skin", "interface port carries at most", patch(206), patch(205)),
    # Three cells behind one cable: 5,472.2 a second of each.
    ("skin", "over the only cable between them", TIGHT + "[data]\nrate_hz = 5473",
     TIGHT + "[data]\nrate_hz = 5472"),
    ("skin", "nobody learns of it", patch(0) + "[touch]\n", patch(1) + "[touch]\n"),
    ("skin", "the touch stays more than 30 mm away", *(
        patch(1) + f"[touch]\npath = [[0, {x}, 0], [1, {x}, 10]]\n" for x in (9000, 0)
    )),
    ("skin", "the run may end before", patch(0, "duration_s = 0.01"), patch(0, "duration_s = 1")),
    ("skin", "nobody gets any frame", patch(0) + "[timing]\nloss = 1.0\n",
     patch(0) + "[timing]\nloss = 0.99\n"),
    ("radio", "One station alone", "stations = 1", "stations = 2"),
    ("radio", "Stations that do not hear each other (0 and 1)",
     "stations = 3\n[channel]\nhidden = [[0, 1]]", "stations = 3"),
    ("radio", "that stations believe", *(
        f"stations = 2\n[channel]\ntau_us = [52, {most}]\n[protocol]\ntau_bounds_us = [52, 104]"
        for most in (105, 104)
    )),
    # Two thirds of the nodes: 6 leaves of 9, and 9 of 14.
    # An ack of 15 bytes at 250 kbit/s takes 480 us, after the turnaround.
    ("mesh", "a hop's ack is there 672 us after its frame", ACKS + "ack_us = 671",
     ACKS + "ack_us = 672"),
    ("mesh", "nearly a star", star(8, 1), star(13, 2)),
    ("mesh", "fewer than 3 neighbours", links((0, 1), (0, 2), (0, 3), (0, 4), (0, 5),
     (1, 2), (3, 4), (3, 5), (4, 5)), links(*every_pair(6))),
    ("mesh", "the gateway n1 has 4 neighbours", links(*every_pair(5)), links(*every_pair(6))),
    ("mesh", "n25: more than 24 hops", line(26), line(25)),
    ("mesh", "n20: over good links too far for tables at an MTU of 64",
     line(21) + "[protocol]\nmtu = 64",
     line(20) + "[protocol]\nmtu = 64"),
    ("mesh", "n20: over good links too far for tables at an MTU of 64",
     line(21) + "[protocol]\nmtu = 64",
     line(21) + "[protocol]\nmtu = 127"),
    *(
        ("mesh", f"{what} for {most + 1} nodes will not be everywhere in time: more than {most} ",
         grid(most + 1) + rest, grid(most) + rest)
        for what, profile, rule, most in (
            ("tables", "38k4", "search", 50), ("tables", "250k", "search", 200),
            ("graph", "38k4", "graph", 70), ("graph", "250k", "graph", 100),
        )
        for rest in (f"[radio]\nprofile = '{profile}'\n[protocol]\nfailover = '{rule}'\nmtu = 127",)
    ),
    *(
        ("mesh", f"nobody gets any {what}; raise protocol.period_s to 2",
         f"{rounds}period_s = 1.0", f"{rounds}period_s = 2.0")
        for what, rule in (("tables", "search"), ("graph", "graph"))
        for rounds in (f"{grid(20)}[protocol]\nfailover = '{rule}'\ncollect_s = 2.0\n",)
    ),
    *(
        ("mesh", "nodes send to others in the first 8 s, when there are no tables yet",
         grid(101) + EARLY, grid(nodes) + EARLY.replace(*other) + rest)
        for nodes, other, rest in (
            (100, ("", ""), ""), (101, ("7.9", "8.0"), ""), (101, ("random", "gateway"), ""),
            (101, ("random", "monitor"), ""), (101, ("random", "all"), ""),
            (101, ("", ""), "[protocol]\non_demand = true"),
            (101, ("", ""), "[protocol]\ntables = false"),
            (101, ("", ""), "[protocol]\nreliable = false"),
            (101, ("'all'", "'n3'"), ""), (101, ("start", "reliable = false\nstart"), ""),
            (101, ("", ""), "[radio]\nprofile = '38k4'"),
            (101, ("", ""), "[radio]\nprofile = 'ip'"),
        )
    ),
    *(
        ("mesh", "nothing else says what was received: no hop is tried again", f"{text}false",
         f"{text}true")
        for text in ("nodes = 3\n[protocol]\nhop_acks = ",
                     "nodes = 3\nradio = { profile = 'ip' }\n[protocol]\nhop_acks = ")
    ),
    ("mesh", "nothing else says what was received", "nodes = 3\n[protocol]\nhop_acks = false",
     "nodes = 3\nradio = { mac = 'csma-cd-r' }\n[protocol]\nhop_acks = false"),
    ("mesh", "nobody can cross it", FENCE, FENCE + ROBOT),
    ("mesh", "outside the fence from the beginning: n1",
     *(f"{FENCE}[[robot]]\nnode = 1\nwaypoints = [[{at}]]" for at in ("1, 8", "4, 4"))),
    ("mesh", "flow.0 sends nothing", "duration_s = 6\n" + FLOW, "duration_s = 60\n" + FLOW),
]  # fmt: skip


def said(kind, text):
    made = scenario.plan(scenario.loads(f'kind = "{kind}"\n{text}'))
    return {"skin": skin, "radio": radio, "mesh": mesh}[kind].warnings(made)


@pytest.mark.parametrize(("kind", "words", "weak", "sound"), CASES)
def test_a_warning_is_said_where_it_begins_and_not_before(kind, words, weak, sound):
    assert sum(words in text for text in said(kind, weak)) == 1
    what = words.partition(": ")[2] or words  # whoever it is said of
    assert not any(what in text for text in said(kind, sound))


def texts_of(*functions):
    """The sentences of some functions, without what is filled in."""
    found = []
    for function in functions:
        (made,) = ast.parse(inspect.getsource(function)).body
        for node in made.body[1:]:
            for part in ast.walk(node):
                pieces = part.values if isinstance(part, ast.JoinedStr) else [part]
                words = (piece.value for piece in pieces if isinstance(piece, ast.Constant))
                found.append(" ".join(word for word in words if isinstance(word, str)))
    return {text for text in found if len(text.split()) > 5}


def test_every_warning_has_a_case():
    left = texts_of(
        skin._touch, skin._start_up, skin._load, radio.warnings, mesh.warnings, mesh._thin,
        mesh._distribution, mesh._early, mesh._outside,
    )  # fmt: skip
    for kind, words, weak, _ in CASES:
        (found,) = (text for text in said(kind, weak) if words in text)
        known = set(found.split())
        left = {text for text in left if not {w for w in text.split() if w.isalpha()} <= known}
    assert left == set()
