"""Every mistake gives one line that names the place and what to change."""

from __future__ import annotations

from pathlib import Path

import pytest

from innervate.scenario import ScenarioError, from_dict, load, loads, plan

# What is replaced: by what, the message.
WRONG = {
    "k = 3": [
        ("beacon_hs = 9", '17: [protocol] has no key "beacon_hs"; did you mean "beacon_hz"?'),
        ("k = 3\nr_f = 0.2", "18: protocol.k and protocol.r_f say the same thing twice; "
         "leave one out"),
        ("r_f = 2.2", "17: protocol.r_f must be at most 2.0, not 2.2"),
        ('rule = "feasable"', '17: protocol.rule must be "feasible", "strict", "paper", '
         '"paper-lax" or "static", not "feasable"; did you mean "feasible"?'),
        ('balancing = false\nbalance_rule = "paper"', "18: protocol.balance_rule has no "
         "effect with balancing = false; leave one out"),
        ("max_depth = 2", "17: p0 r0 c3 is 3 hops from the PC but protocol.max_depth is 2; "
         "add an interface or raise protocol.max_depth"),
    ],
    "4.0": [
        ('"long"', '2: duration_s must be a number of seconds > 0, not "long"'),
        ("0", "2: duration_s must be a number of seconds > 0, not 0"),
        ("nan", "2: duration_s must be a finite number, not nan"),
        ("true", "2: duration_s must be a number of seconds > 0, not true"),
    ],
    'kind = "skin"': [
        ("", ' the scenario has no kind; add kind = "skin" (or radio, mesh, babel, '
         "flooding, rpl)"),
        ('scenario = "demo"', " this is a plan of many runs, no scenario: innervate sweep runs it"),
    ],
    '"skin"': [
        ('"skim"', '1: kind must be "skin", "radio", "mesh", "babel", "flooding" or "rpl", '
         'not "skim"'),
        (f'"{"s" * 300}"', '1: kind must be "skin", "radio", "mesh", "babel", "flooding" or '
         f'"rpl", not "{"s" * 45}..."; name the folder of one of your own: --network DIR'),
        ('"skin"\nschema = 2', "2: schema = 2 is newer than this version knows (1); "
         "update innervate"),
    ],
    "rows = 3\n": [
        ("", '4: [[patch]] 0 lacks "rows"; give it a whole number from 1'),
    ],
    "rows = 3": [
        ("rows = 3.5", "6: patch.0.rows must be a whole number from 1, not 3.5"),
        ("rows = 9000000", "6: patch.0.rows must be at most 4000000, not 9000000"),
    ],
    "column = 1": [
        ("column = 9", "10: interface.0: there is no column 9; columns are 0 to 3"),
        ('column = 1\nport = "E"', "11: interface.0: port p0 r0 c1 E is already cabled "
         "to p0 r0 c2 W, so pc.0 cannot be joined to it; free on p0 r0 c1: up"),
    ],
    "row = 0": [
        ("row = 1", "8: interface.0: p0 r1 c1 has no free port; choose a border cell"),
        ("row = 0\npatch = 2", "10: interface.0: there is no patch 2; the only patch is 0"),
    ],
    "2.0": [
        ("5.0", "20: event.0.at_s = 5 is outside the run; duration_s is 4"),
        ("1e308", "20: event.0.at_s = 1e+308 is outside the run; duration_s is 4"),
        ("4.0", "20: event.0.at_s = 4 is the end of the run, so it would never happen; make it "
         "earlier, or duration_s longer"),
        ("[1.0, 4.0]", "20: event.0.at_s = 4 is the end of the run, so it would never happen; "
         "make it earlier, or duration_s longer"),
        ("-1", "20: event.0.at_s must be a number of seconds from 0, not -1"),
        ("[3.0, 1.0]", "20: event.0.at_s must be [least, most], not [3, 1]"),
    ],
    "interface = 1": [
        ("interface = 2", "22: event.0: there is no interface 2; they are 0 to 1"),
        ("pc = true", '22: event.0: "cut" takes a cable: interface = 0, cell = {...} '
         'with port = "E", link = [{...}, {...}] or random = "link", not pc'),
        ("interface = 1\npc = true", "23: event.0 has 2 targets: interface and pc; "
         "keep one"),
        ("cell = { row = 0, column = 0 }", "22: event.0: p0 r0 c0 has 2 cables; say "
         "which with port; cabled are E, down"),
        ('cell = { row = 0, column = 0, port = "W" }', "22: event.0: port W of "
         "p0 r0 c0 has no cable; cabled are E, down"),
        ("cell = { row = 0, colum = 0 }", '22: event.0.cell has no key "colum"; did '
         'you mean "column"?'),
        ('link = ["p0r0c0", { row = 2, column = 0 }]', "22: event.0.link: no cable "
         "joins p0 r0 c0 and p0 r2 c0 there; name two neighbours"),
        ('node = "n7"', '22: event.0.node: no node is called "n7"; they are p0 r0 c0, '
         "p0 r0 c1, ..., pc"),
    ],
    '"cut"': [
        ('"loose"', '19: event.0 ("loose") lacks "loss"; give it a fraction, like 0.35'),
    ],
    '"cut"\ninterface = 1': [
        ('"revive"\nrandom = "cell"', "22: event.0: no cell is broken at that "
         "time to revive"),
    ],
}  # fmt: skip


@pytest.mark.parametrize(("old", "new", "message"), [
    pytest.param(old, new, message, id=message[:60])
    for old, wrong in WRONG.items() for new, message in wrong
])  # fmt: skip
def test_mistakes_in_a_file(small: str, old: str, new: str, message: str) -> None:
    assert old in small
    with pytest.raises(ScenarioError) as caught:
        plan(loads(small.replace(old, new, 1), path="demo.toml"))
    assert str(caught.value) == f"demo.toml:{message}"


SETS = [
    ("protocol.kk=3", '[protocol] has no key "kk"; did you mean "k"?'),
    ("protocol.k=x", 'protocol.k must be a whole number of missed beacons, 1 to 94, not "x"'),
    ("protocol.k=31", "protocol.k = 31 cannot be kept: a missed beacon is counted in 1/840; use 30 "
     "or 32"),
    ("protocol.k=66", "protocol.k = 66 cannot be kept: a missed beacon is counted in 1/840; use 65 "
     "or 70"),
    ("protocol.k=93", "protocol.k = 93 cannot be kept: a missed beacon is counted in 1/840; use 84 "
     "or 94"),
    ("protocol.k=95", "protocol.k must be at most 94, not 95"),
    ("protocol.k", "write it as key=value, like protocol.k=3"),
    ("..=3", "a key is names with dots between, like protocol.k"),
    ("event.3.at_s=3", "event is a list of 1; its elements are addressed by number from 0, and 1 "
     "appends"),
    ("event.1.at_s=3", '[[event]] 1 lacks "action"; give it "cut", "restore", "kill", "revive", '
     '"loose", "restart" or "lose"'),
    ("duration_s.a=3", "duration_s is 4.0, which has nothing inside; set duration_s itself"),
    ("interface.0.row=7", "interface.0: there is no row 7; rows are 0 to 2"),
    ("seed=-1", "seed must be a whole number from 0, not -1"),
    ("seed=1000000000000000000000", "seed must be a number below 2^63"),
    ("timing.hop_latency_us=[9, 3]", "timing.hop_latency_us must be [least, most], not [9, 3]"),
    ("touch.path=[[0,1,2],[0,1,2]]", "touch.path goes back in time at point 1: 0 s after 0 s; put "
     "the points in order of time"),
    ("data.rate_hz=0.001", "data.rate_hz must be 0 (off) or at least 0.01"),
    ("script.steps=['tickle n']", 'script.steps.0: "tickle n" is no step; they are tick n, soon n, '
     "deliver a->b, lose a->b, detect n.port, draw v, cut a->b, restore a->b, restart n"),
    ("body.urdf=x", '[body] lacks "links"; give it a pattern for link names, like '
     '"r_forearm_skin_*"'),
    ("link.0.a=x", '[[link]] 0 lacks "b"; give it an end like "n1.2", "n1" or "pc.0"'),
]  # fmt: skip


@pytest.mark.parametrize(("text", "message"), SETS, ids=[s[0] for s in SETS])
def test_mistakes_in_an_override(small: str, text: str, message: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        plan(loads(small, [text], path="demo.toml"))
    assert str(caught.value) == f"--set {text}: {message}"


def test_clocks_do_not_overflow(small: str) -> None:
    long = ["timing.drift_ppm=50000", "duration_s=160000"]
    made = plan(loads(small, long))
    rate = round(made.drift_ppm * 2**30 / 1e6)
    assert made.duration_us * rate < 2**63
    with pytest.raises(ScenarioError) as caught:
        plan(loads(small, [long[0], "duration_s=160001"], path="demo.toml"))
    assert str(caught.value) == (
        "--set duration_s=160001: duration_s = 160001 is too long for clocks with "
        "timing.drift_ppm = 50000; make it at most 160000 or the drift smaller"
    )
    assert plan(loads(small, ["duration_s=1000000", "timing.drift_ppm=8000"]))
    assert plan(loads(small, [long[0], "duration_s=1000000", "timing.lock_step=true"]))


def test_syntax_errors_have_a_line(small: str) -> None:
    with pytest.raises(ScenarioError, match=r"^demo.toml:17: not valid TOML, column \d+: "):
        loads(small.replace("k = 3", "k = x"), path="demo.toml")
    with pytest.raises(ScenarioError, match=r"^demo.toml:23: not valid TOML, at the end: "):
        loads(small + "x", path="demo.toml")


@pytest.mark.parametrize(("char", "name"), [
    ("\u202e", "U+202E (right-to-left override)"), ("\u2066", "U+2066 (left-to-right isolate)"),
    ("\u200f", "U+200F (right-to-left mark)"), ("\u200b", "U+200B (zero width space)"),
    ("\ufeff", "U+FEFF (zero width no-break space)"), ("\u2028", "U+2028 (line separator)"),
    ("\x1b", "U+001B"),
])  # fmt: skip
def test_characters_that_nobody_sees_are_refused(char: str, name: str) -> None:
    """U+202E turns round what stands behind a name; two names that look alike are told by none."""
    words = f"{name}, which nobody sees; leave it out"
    text = 'kind = "mesh"\nname = {}\n[[node]]\nname = {}\nx_m = 0\ny_m = 0\n'
    odd = f'"a\\U{ord(char):08x}b"'
    with pytest.raises(ScenarioError) as found:
        loads(text.format(odd, '"n"'), path="f.toml")
    assert str(found.value) == f"f.toml:2: name holds {words}"
    with pytest.raises(ScenarioError) as found:
        loads(text.format('"n"', odd), path="f.toml")
    assert str(found.value) == f"f.toml:4: node.0.name holds {words}"
    with pytest.raises(ScenarioError) as found:
        loads(f'kind = "mesh"\n[robot]\n{odd} = 1\n', path="f.toml")
    assert str(found.value) == f"f.toml:2: a key of robot holds {words}"


def test_letters_from_right_to_left_are_names() -> None:
    nodes = [{"name": name, "x_m": 9 * i, "y_m": 0} for i, name in enumerate(("שלום 1", "مرحبا"))]
    assert from_dict({"kind": "mesh", "name": "שלום", "node": nodes}).name == "שלום"


def test_an_error_says_where(small: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        loads(small.replace("k = 3", "k = 0"), path="demo.toml")
    error = caught.value
    assert (error.path, error.line, error.key) == ("demo.toml", 17, "protocol.k")
    assert error.message.startswith("protocol.k must be")


def test_more_than_a_wire_can_number(small: str) -> None:
    many = ["patch.0.count=6000", "patch.0.interfaces_every=1"]
    with pytest.raises(ScenarioError, match="72,000 cells cannot send data"):
        plan(loads(small, [*many, "data.rate_hz=10"]))
    with pytest.raises(ScenarioError, match="at most 4,000,000 can be simulated"):
        plan(loads(small, ["patch.0.count=4000000"]))
    with pytest.raises(ScenarioError, match="the wire carries 254"):
        plan(loads(small, ["patch.0.rows=3000", "interface.1.row=2999"]))


def test_unconnected_cells_are_refused(small: str) -> None:
    with pytest.raises(ScenarioError, match="patch 1 is not connected to the PC"):
        plan(loads(small + "[[patch]]\ncolumns = 2\nrows = 2\n"))
    with pytest.raises(ScenarioError, match="no interface port"):
        plan(from_dict({"kind": "skin", "patch": [{"columns": 2, "rows": 2}]}))
    links = [{"a": "n1", "b": "pc"}, {"a": "n2", "b": "n3"}]
    with pytest.raises(ScenarioError, match="n2 and 1 more are not connected"):
        plan(from_dict({"kind": "skin", "link": links}))


def test_skins_are_made_one_way(small: str) -> None:
    with pytest.raises(ScenarioError, match="patch or link; leave one out"):
        loads(small + '[[link]]\na = "x"\nb = "pc"\n')
    with pytest.raises(ScenarioError, match="there is no skin"):
        loads('kind = "skin"')
    text = '[[link]]\na = "x"\nb = "pc"\n[[interface]]\nrow = 0\ncolumn = 0\n'
    with pytest.raises(ScenarioError, match=r"\[\[interface\]\] goes with \[\[patch\]\]"):
        loads('kind = "skin"\n' + text)


def test_a_port_cabled_twice(small: str) -> None:
    twice = small + "[[interface]]\nrow = 0\ncolumn = 1\n"
    with pytest.raises(ScenarioError, match="p0 r0 c1 has no free port"):
        plan(loads(twice))
    links = '[[link]]\na = "n1.0"\nb = "pc"\n[[link]]\na = "n1.0"\nb = "n2"\n'
    with pytest.raises(ScenarioError) as caught:
        plan(loads('kind = "skin"\n' + links, path="f.toml"))
    assert str(caught.value) == (
        "f.toml:5: port n1 W is already cabled to pc.0, so n2 W cannot be joined to it; "
        "free on n1: E, up, down"
    )


def test_files_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match=r'no such file.*did you mean "demo"\?'):
        load("demos")
    with pytest.raises(ScenarioError, match=r"no such file$"):
        load(tmp_path / "none.toml")
    with pytest.raises(ScenarioError, match="this is a folder"):
        load(tmp_path)
    with pytest.raises(ScenarioError, match="name a file"):
        load("")
    with pytest.raises(ScenarioError, match="no such file"):
        load("a\0b")
    binary = tmp_path / "x.toml"
    binary.write_bytes(b'kind = "skin"\n\xff\xfe\x00')
    with pytest.raises(ScenarioError, match=":2: is not UTF-8 text"):
        load(binary)
    binary.write_bytes(b"\x00\x01\x02")
    with pytest.raises(ScenarioError, match="not valid TOML"):
        load(binary)


def test_a_file_that_may_not_be_read(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "x.toml"
    file.write_text("")

    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(Path, "open", refuse)
    with pytest.raises(ScenarioError, match="cannot be read: Permission denied"):
        load(file)
