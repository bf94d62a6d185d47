import itertools
import json

import numpy as np
import pytest

from innervate import scenario
from innervate.networks.skin.run import trail
from innervate.networks.skin.sim.simulate import simulate
from innervate.running import RunError, compare, run
from innervate.running.compare import differences
from innervate.running.trail import first_difference
from innervate.sim.tables import TRAIL, row_dtype

DEEP = "[" * 100_000 + "]" * 100_000


@pytest.fixture
def written(four, tmp_path, page):
    numbers = itertools.count()

    def write(seed=1, **changes):
        folder = tmp_path / f"run-{next(numbers)}"
        run(four(**changes), seed=seed, out=folder)
        return folder

    return write


def test_the_same_run_twice(written):
    found = compare(written(), written())
    assert found.same
    assert (found.scenario, found.summary, found.divergence, found.notes) == ([], [], None, [])


def test_runs_at_hand_are_compared_like_their_folders(four, written):
    folders = written(), written(seed=2)
    runs = run(four()), run(four(), seed=2)
    found, told = compare(*runs), compare(*folders)
    assert (found.scenario, found.divergence) == (told.scenario, told.divergence)
    assert (found.summary, found.notes) == (told.summary, told.notes)
    assert compare(runs[0], folders[0]).same
    assert not compare(runs[0], folders[1]).same


def test_another_seed(written):
    found = compare(written(), written(seed=2))
    assert found.scenario == [("seed", 1, 2)]
    assert not found.same
    assert found.divergence.time_s < 0.01
    assert "pc: switched on" in found.divergence.a
    assert "p0 r0 c2: switched on" in found.divergence.b
    assert " against " in str(found.divergence)


def test_an_event_at_another_time(written):
    later = [{"at_s": 0.35, "action": "cut", "interface": 1}]
    found = compare(written(), written(event=later))
    assert found.scenario == [("event.0.at_s", 0.3, 0.35)]
    assert 0.3 <= found.divergence.time_s < 0.31
    assert "recoveries.0.at_s" in [key for key, _, _ in found.summary]


def test_another_parameter_shows_where_it_first_matters(written):
    found = compare(written(protocol={"k": 5}), written(protocol={"k": 3}))
    assert ("protocol.k", 5, 3) in found.scenario
    assert found.divergence.same_call
    assert str(found.divergence).endswith("beacon period: the same call, but another outcome")


def test_a_longer_run_goes_on_where_the_other_ended(written):
    found = compare(written(), written(duration_s=0.6))
    assert found.divergence.a == "nothing more"
    assert 0.5 <= found.divergence.time_s < 0.51


def test_what_is_no_run_folder(written, tmp_path):
    with pytest.raises(RunError, match="no such folder"):
        compare(tmp_path / "nowhere", written())
    (tmp_path / "empty").mkdir()
    with pytest.raises(RunError, match=r"has no summary\.json"):
        compare(tmp_path / "empty", written())
    broken = written()
    (broken / "scenario.toml").write_text("kind =")
    with pytest.raises(RunError, match="damaged"):
        compare(broken, written())
    for name, deep in (("scenario.toml", f"a = {DEEP}"), ("summary.json", DEEP)):
        broken = written()
        (broken / name).write_text(deep)
        with pytest.raises(RunError, match=f"{name} is damaged"):
            compare(broken, written())
    nothing = written()
    (nothing / "summary.json").write_text("{}")
    with pytest.raises(RunError, match=r"summary\.json is damaged"):
        compare(nothing, written())


@pytest.mark.parametrize("harm", ["flip", "cut short", "missing"])
@pytest.mark.parametrize("name", ["routes", "received"])
def test_a_damaged_table_is_one_line(written, name, harm):
    whole, broken = written(data={"rate_hz": 100}), written(data={"rate_hz": 100})
    assert compare(whole, broken).same
    path = broken / f"{name}.parquet"
    content = bytearray(path.read_bytes())
    content[len(content) // 2] ^= 1
    path.write_bytes(content[:-1] if harm == "cut short" else content)
    if harm == "missing":
        path.unlink()
    words = "missing" if harm == "missing" else "damaged"
    with pytest.raises(RunError) as caught:
        compare(whole, broken)
    assert str(caught.value) == f"{path} is {words}; run the scenario again"


def test_a_folder_without_checksums_can_be_compared(written):
    old = written()
    said = json.loads((old / "provenance.json").read_text())
    assert set(said.pop("tables_sha256")) >= {"routes.parquet", "links.parquet"}
    (old / "provenance.json").write_text(json.dumps(said))
    assert compare(old, written()).same


def test_the_trail_in_pieces_is_the_trail(four):
    plan = scenario.plan(scenario.from_dict(four(duration_s=2.0)))
    whole = simulate(plan, trail=True).trail
    pieces = np.concatenate(list(trail(plan, plan.duration_us)))
    for name in TRAIL:
        assert (whole[name] == pieces[name]).all()


def pieces_of(times, *cuts):
    table = np.zeros(len(times), row_dtype(TRAIL))
    table["time"] = times
    yield from np.split(table, cuts)


@pytest.mark.parametrize("cuts", [(), (2,), (0, 0, 3), (1, 2, 3, 4)])
def test_pieces_of_any_length(cuts):
    def first(a, b):
        return first_difference(pieces_of(a, *cuts), pieces_of(b, 1, 1))

    assert first([1, 2, 3, 4, 5], [1, 2, 3, 4, 5]) is None
    a, b = first([1, 2, 3, 4, 5], [1, 2, 3, 9, 5])
    assert (a["time"], b["time"]) == (4, 9)
    a, b = first([1, 2, 3, 4, 5], [1, 2, 3])
    assert (a["time"], b) == (4, None)
    a, b = first([1, 2], [1, 2, 3])
    assert (a, b["time"]) == (None, 3)


@pytest.mark.parametrize("name", TRAIL)
@pytest.mark.parametrize("place", [0, 3, 4])
def test_one_word_of_one_call_makes_trails_differ(name, place):
    one, other = (np.zeros(5, row_dtype(TRAIL)) for _ in range(2))
    other[name][place] = 1
    a, b = first_difference(iter([one]), iter(np.split(other, (2,))))
    assert (a[name], b[name]) == (0, 1)
    assert a["time"] == one["time"][place]
    assert first_difference(iter([other]), iter([other.copy()])) is None


def test_differences_by_dotted_key():
    a = {"x": 1, "y": {"z": [1, 2]}, "list": [{"u": 1}, {"u": 2}], "gone": 0}
    b = {"x": 1, "y": {"z": [1, 3]}, "list": [{"u": 1}], "new": None}
    assert differences(a, b) == [
        ("y.z", [1, 2], [1, 3]),
        ("list.1", {"u": 2}, None),
        ("gone", 0, None),
    ]


def test_a_run_that_is_not_well_is_called_so_whether_or_not_the_two_differ(written):
    cut = [{"at_s": 0.3, "action": "cut", "interface": i} for i in (0, 1)]
    found = compare(written(event=cut), written(event=cut))
    assert found.same
    assert found.headlines[0] == found.headlines[1]
    assert found.headlines[0]["level"] == "down"
    assert found.headlines[0]["text"].startswith("All 4 cells are cut off since 0.300 s: no cable")
