"""A proof is noted by all that it rests on: whatever is changed, it is done again."""

import os
from importlib import metadata
from pathlib import Path

import pytest

from innervate.network import networks
from innervate.networks.skin.prove.neighbours import ENTRY
from innervate.prove import kept
from innervate.prove.theory import source


@pytest.fixture
def asked(tmp_path, monkeypatch):
    """Ask whether something holds; how often it had to be proved for that."""
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path / "not" / "yet"))
    protocol = tmp_path / "protocol"
    protocol.mkdir()
    (protocol / "cell.py").write_text("one")
    count = []

    def ask(claim="it holds", known=None, answer=True):
        before = len(count)
        told = kept.holds(claim, known or {}, [protocol], lambda: count.append(1) or answer)
        return told, len(count) - before

    return ask


def test_what_holds_is_proved_once(asked):
    assert [asked(), asked()] == [(True, 1), (True, 0)]
    assert asked("something else holds") == (True, 1)


def test_what_does_not_hold_is_tried_each_time(asked):
    assert [asked(answer=False), asked(answer=False), asked()] == [
        (False, 1),
        (False, 1),
        (True, 1),
    ]


def test_another_source_is_proved_anew(asked, tmp_path):
    known, other = source(ENTRY, None), source(ENTRY, ("cell.hold + 1", "cell.hold + 2"))
    assert [asked(known=one)[1] for one in (known, other, known, other)] == [1, 1, 0, 0]
    (tmp_path / "protocol" / "cell.py").write_text("two")
    assert asked(known=known) == (True, 1)
    (tmp_path / "protocol" / "fields.py").write_text("")
    assert asked(known=known) == (True, 1)


def test_another_constant_is_proved_anew(asked):
    known = source(ENTRY, None)
    assert asked(known=known) == (True, 1)
    next(one for one in known.values() if "NONE" in one.constants).constants["NONE"] = -2
    assert asked(known=known) == (True, 1)


def test_another_solver_proves_anew_and_an_unknown_one_always(asked, monkeypatch):
    assert asked() == (True, 1)
    monkeypatch.setattr(kept, "version", lambda _: "another")
    assert [asked(), asked()] == [(True, 1), (True, 0)]

    def none(name):
        raise metadata.PackageNotFoundError(name)

    monkeypatch.setattr(kept, "version", none)
    assert [asked(), asked()] == [(True, 1), (True, 1)]


def test_what_is_edited_while_it_is_proved_is_not_noted(asked, tmp_path):
    cell = tmp_path / "protocol" / "cell.py"
    known = source(ENTRY, None)

    def edits():
        cell.write_text("edited")
        return True

    assert kept.holds("x", known, [cell.parent], edits)
    cell.write_text("one")
    assert asked("x", known) == (True, 1)
    cell.write_text("edited")
    assert asked("x", known) == (True, 1)


def test_every_file_of_a_proof_has_a_part_in_its_name():
    """What the skin's theories import from innervate is hashed, but for clocks and the registry."""
    home = Path(networks()["skin"].prove.__file__).parent
    named = set(kept.sources(home, home.parent / "protocol"))
    rooms = {path.relative_to(kept.ROOT).parts[0] for path in named}
    assert rooms == {"dialect", "prove", "networks"}
    assert {"check.py", "solve.py", "feasible.py", "fields.py", "outbox.py"} <= {
        path.name for path in named
    }


def test_notes_that_were_made_first_are_forgotten_first(tmp_path):
    assert kept.NOTES_MAX >= 50
    most = 2 * kept.NOTES_MAX  # a note, and its lock
    for age in range(most + 1):
        path = tmp_path / f"{age}"
        path.touch()
        os.utime(path, (1000 - age, 1000 - age))
    kept._write(tmp_path / "new")
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {"new", *(f"{age}" for age in range(most - 1))}


def test_where_a_part_ends_has_a_part_in_the_name(monkeypatch):
    names = set()
    for parts in ((b"ab", b"c"), (b"a", b"bc"), (b"abc",), (b"abc", b"")):
        monkeypatch.setattr(kept, "_parts", lambda *_, parts=parts: parts)
        names.add(kept.name_of("", {}, []))
    assert len(names) == 4
