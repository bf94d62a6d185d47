"""`innervate new network` and `check-protocol`."""

import json
import os

import pytest

from innervate.cli import main
from innervate.folders import CHANNEL_OWN
from innervate.network import NetworkError, networks
from innervate.running import run
from tests.own import alone, made, own

__all__ = ["alone", "own"]


def checked(capsys, *words):
    code = main(["check-protocol", "gossip", *words])
    return code, capsys.readouterr().out


def test_what_no_test_reaches_is_named(own, capsys):
    test = own.folder / "test_gossip.py"
    test.write_text('"""Tests."""\n\n\ndef test_nothing():\n    assert True\n')
    code, said = checked(capsys, "--json")
    assert code == 0
    told = json.loads(said)
    assert told["faults"] == []
    assert set(told["unreached"]) == {
        "on_start", "on_frame", "on_timer", "on_input", "is_newer", "tell", "fill",
    }  # fmt: skip
    assert (
        told["unreached"]["on_frame"] == f"gossip/protocol.py:{own.line('protocol.py', 'on_frame')}"
    )
    assert told["outbox"] == {"on_start": 1, "on_frame": 5, "on_timer": 5, "on_input": 4}
    reason = f"a gossip that {'nobody ' * 20}heard"
    test.write_text(f'"""Tests."""\n\n\ndef test_nothing():\n    raise ValueError("{reason}")\n')
    code, said = checked(capsys)
    assert code == 1
    assert "gossip: FAILED" in said
    assert reason in said
    assert "values and frames fit" not in said
    assert "but: its tests fail (see above)" in said.splitlines()[-1]


def test_an_outbox_that_is_too_small_and_loops_that_are_not_counted(own, capsys):
    own.change("protocol.py", "OUTBOX = 8", "OUTBOX = 4")
    own.change("protocol.py", "        for p in range(PORTS):\n            if p != port:",
               "        for p in range(node.number):\n            if p != port:")  # fmt: skip
    code, said = checked(capsys, "--no-tests")
    at = own.line("protocol.py", "def on_timer")
    assert f"gossip/protocol.py:{at}: on_timer may put 5 actions, the outbox holds 4" in said
    at = own.line("protocol.py", "range(node.number)")
    assert f"gossip/protocol.py:{at}: on_frame: how many actions it may put is not seen" in said
    assert "So: an outbox overflowed" in said
    assert said.splitlines()[-1].startswith(
        "gossip: the dialect is kept, but: the outbox is too small, some order of events "
        "breaks it (see above); at most 5 actions a call of 4"
    )
    assert code == 1
    own.change("protocol.py", "OUTBOX = 4", "OUTBOX = 5")
    code, said = checked(capsys, "--no-tests")
    assert "the outbox holds 5; write" not in said
    assert "the outbox is too small" not in said.splitlines()[-1]


def test_every_mistake_is_told_at_once(own, capsys):
    own.change("protocol.py", "NEWS = 1", "NEWS = 1.5")
    own.change("protocol.py", "    node.value = item.value\n", "    node.value = [item.value]\n")
    code, said = checked(capsys)
    assert code == 2
    first, second = said.splitlines()
    assert first.startswith(f"gossip/protocol.py:{own.line('protocol.py', '1.5')}: a float")
    assert "declare a field with a length" in second


@pytest.mark.parametrize(
    ("file", "old", "new", "told"),
    [
        ("protocol.py", "node.version == 0:", "node.versoin == 0:",
         'versoin is no field that fields.py declares; did you mean "version"?'),
        ("protocol.py", "BEAT = 0", "BEAT = 1", "sets timer 1, and TIMERS = 1; write TIMERS = 2"),
        ("protocol.py", "deliver(out, NEWS)", "deliver(out, kind=NEWS)",
         "a keyword argument; give it by its place"),
        ("fields.py", '"beat_us": 10_000', '"beat_us": 10',
         "DEFAULTS: beat_us must be 1000 to 1000000 us, not 10"),
        ("fields.py", '"beat_us": 10_000', '"beet_us": 10_000',
         "DEFAULTS: beet_us is no parameter of PARAMS"),
        ("invariants.py", "node_says_nothing_it_has_not_heard(node, params, now)",
         "node_says_nothing_it_has_not_heard(node, params)",
         "node_says_nothing_it_has_not_heard takes 2 arguments; it is "
         "node_says_nothing_it_has_not_heard(node, params, now)"),
    ],
)  # fmt: skip
def test_a_mistake_is_one_line_with_its_place(own, capsys, file, old, new, told):
    own.change(file, old, new)
    at = {own.line(file, new)}
    if "timer" in told:
        at = {n for n, text in enumerate((own.folder / file).read_text().splitlines(), 1)
              if "set_timer(out" in text}  # fmt: skip
    code, said = checked(capsys, "--no-tests")
    assert code == 2
    assert set(said.splitlines()) == {f"gossip/{file}:{line}: {told}" for line in at}
    assert len(said.splitlines()) == len(at)


def test_a_parameter_that_has_a_name_of_the_channel_is_refused(alone, capsys):
    main(["new", "network", "talk", "--on", "channel"])
    path = alone / "talk" / "fields.py"
    for name in CHANNEL_OWN:
        path.write_text(path.read_text().replace('"length_slots"', f'"{name}"'))
        capsys.readouterr()
        assert main(["check-protocol", "talk", "--no-tests"]) == 2
        assert f"PARAMS: {name} is a word of the medium's own" in capsys.readouterr().out
        path.write_text(path.read_text().replace(f'"{name}"', '"length_slots"'))


def test_what_a_medium_on_the_air_would_not_do_is_refused(alone, capsys):
    talk = made(alone / "talk", "channel")
    talk.change("protocol.py", "OUTBOX = 4", "OUTBOX = 4\nREPORT_SAID = 8\n#")
    talk.change("protocol.py", "send(out, 0, 0, 0)", "send(out, 0, 500, 0)")
    capsys.readouterr()
    assert main(["check-protocol", "talk", "--no-tests"]) == 2
    later, own = capsys.readouterr().out.splitlines()
    at = f"talk/protocol.py:{talk.line('protocol.py', '500')}: "
    assert later == at + "only over cables a frame leaves later; send it from on_timer"
    assert own.endswith("REPORT_SAID = 8 is a report of the channel's own; choose another number")


def test_a_word_of_python_is_no_name_of_a_network(alone, capsys):
    assert main(["new", "network", "import"]) == 2
    assert "the name 'import' is taken" in capsys.readouterr().err
    assert not (alone / "import").exists()


def test_runs_of_a_folder_that_nothing_has_named_yet_are_compared(own, capsys):
    run(own.scenario, plain=True, out=own.folder / "one")
    networks.cache_clear()
    os.environ["INNERVATE_NETWORKS"] = ""
    assert main(["compare", "gossip/one", "gossip/one"]) == 0
    assert "the same, event by event" in capsys.readouterr().out
    own.folder.rename("other")
    networks.cache_clear()
    os.environ["INNERVATE_NETWORKS"] = ""
    assert main(["compare", "other/one", "other/one"]) == 2
    assert "no network here is called 'gossip'; name its folder" in capsys.readouterr().err


def test_a_measure_that_is_not_there_or_fails_is_told_with_its_line(own, capsys):
    own.change("network.py", '    invariants="invariants",\n',
               '    invariants="invariants",\n    measures="more:measures",\n')  # fmt: skip
    at = f"gossip/network.py:{own.line('network.py', 'more:measures')}: measures: "
    assert main(["check-protocol", "gossip", "--no-tests"]) == 2
    assert at + "No module named 'gossip.more'" in capsys.readouterr().err
    more = own.folder / "more.py"
    more.write_text('"""More."""\n')
    assert main(["check-protocol", "gossip", "--no-tests"]) == 2
    assert at + "module 'gossip.more' has no attribute 'measures'" in capsys.readouterr().err
    more.write_text("def measures(nodes, reports, deliveries, plan):\n    return {'a': 1 // 0}\n")
    with pytest.raises(NetworkError, match=r"^gossip/more.py:2: ZeroDivisionError: .*, in measure"):
        run(own.scenario, plain=True)


def test_a_new_network_has_numbers_that_none_beside_it_has(alone):
    for name in ("one", "two", "three"):
        made(alone / name)
    for word, numbers in (
        ("link_type", ["162", "159", "158"]),
        ("key_kind", ["255", "254", "253"]),
    ):
        texts = [(alone / name / "network.py").read_text() for name in ("one", "two", "three")]
        assert [text.partition(f"{word}=")[2].partition(",")[0] for text in texts] == numbers


def test_what_cannot_be_read_beside_a_new_network_is_none_of_its_business(alone):
    (alone / "other" / "network.py").mkdir(parents=True)
    (alone / "away").mkdir()
    (alone / "away" / "network.py").symlink_to(alone / "nowhere")
    made(alone / "one")
    assert sorted(path.name for path in alone.iterdir()) == ["away", "one", "other"]


def test_a_disk_that_is_full_is_told_with_the_folders_name(alone, capsys, monkeypatch):
    def full(path, *_, **__):
        raise OSError(28, "No space left on device", str(path))

    monkeypatch.setattr("pathlib.Path.write_text", full)
    assert main(["new", "network", "gossip"]) == 2
    said = capsys.readouterr().err
    assert said == "innervate: gossip cannot be written: No space left on device\n"
    assert list(alone.iterdir()) == []


def test_over_goes_with_a_field_and_a_medium_access_that_there_is(alone, capsys):
    for words in (["--on", "field", "--over", "tdma"], ["--over", "csma"]):
        assert main(["new", "network", "flood", *words]) == 2
        assert "--over can be csma, with --on field" in capsys.readouterr().err
    assert not (alone / "flood").exists()
