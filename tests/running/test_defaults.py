"""What any network has that says only what it must: here the skin, all the rest left out."""

import pytest

import innervate
from innervate.analysis.headline import DEGRADED, DOWN, NO_DATA, OK
from innervate.analysis.summary import headline
from innervate.export import capture, dissector, graphs, recording
from innervate.network import Network, networks
from innervate.running import folder
from innervate.sim.counts import Counts
from tests.export.tshark_runs import tshark  # noqa: F401 - a fixture

OWN = ("model", "check", "plan", "describe", "fault_words", "actions", "harm", "template", "anchor",
       "loop_name", "frames", "fields")  # fmt: skip
SKIN = networks()["skin"]


@pytest.fixture
def bare(monkeypatch):
    """A skin of which nothing but its protocol, its scenarios and its loop is known."""
    made = Network("skin", SKIN.package, link_type=SKIN.link_type,
                   **{part: SKIN.parts[part] for part in OWN},
                   simulation="sim.simulate:simulation")  # fmt: skip
    monkeypatch.setitem(networks(), "skin", made)
    folder.table_files.cache_clear()
    yield made
    folder.table_files.cache_clear()


@pytest.fixture
def done(bare, four):
    return innervate.run(four())


def test_it_is_summed_up(done):
    frames, messages = done.summary["frames"], done.summary["messages"]
    assert frames["sent"] == frames["arrived"] + frames["lost"] + frames["in_flight"] > 1000
    assert frames["lost_by"]["cut"] > 0
    assert messages["sent"] >= messages["delivered"] > 100
    assert 0 < messages["latency_ms"]["p50"] <= messages["latency_ms"]["max"] < 10
    assert (done.summary["nodes"], done.summary["off"]) == (5, 0)
    assert done.summary["headline"]["level"] == DEGRADED
    assert "frames are lost" in done.summary["headline"]["text"]


@pytest.mark.parametrize(
    ("counts", "level", "text"),
    [
        (Counts(), NO_DATA, "Nothing has happened yet."),
        (Counts(nodes=2, sent=9, arrived=9), OK, "None of 9 frames is lost."),
        (Counts(nodes=2, sent=9, arrived=9, offered=3, delivered=3), OK,
         "All 3 messages are delivered once, none of 9 frames is lost."),
        (Counts(nodes=2, off=(1,), sent=9, arrived=8, lost_by={"cut": 1}), DEGRADED,
         "1 of 2 nodes is off, 1 of 9 frames is lost."),
        (Counts(nodes=2, off=(0, 1), sent=9, arrived=8), DOWN, "Both nodes are off."),
        (Counts(nodes=2, sent=9, lost_by={"noise": 9}), DOWN, "None of 9 frames arrived."),
        (Counts(nodes=2, sent=9, arrived=9, offered=3, dropped_by={"loop": 3}), DOWN,
         "None of 3 messages was delivered."),
    ],
)  # fmt: skip
def test_its_headline(counts, level, text):
    found = headline(counts, handled=counts.sent)
    assert found[:2] == (level, text)


def test_it_is_told_drawn_and_written(done, bare, tmp_path):
    first, said, frames, messages, latency = bare.summary_lines(done)
    assert first.startswith("four: 5 nodes; 0.5 s simulated in ")
    assert said.startswith("degraded: ")
    assert frames.startswith("Frames: ")
    assert " cut" in frames
    assert messages.startswith("Messages: ")
    assert latency.startswith("Latency: half within ")
    page = done.report()
    assert page.count("<figure>") > 3
    assert "cable pc.1 - p0 r0 c3 E cut" in page
    assert "<h1>" in done._repr_html_()
    for figure in ("delivered", "latency"):
        assert done.plot(figure).axes
    with pytest.raises(ValueError, match="there are delivered, latency"):
        done.plot("routes")
    written = done.write(tmp_path / "out")
    assert {path.name for path in written.glob("*.parquet")} == {
        "reports.parquet", "deliveries.parquet"}  # fmt: skip
    assert innervate.compare(done, written).same


def test_it_is_compared_event_by_event(bare, four):
    one, other = (innervate.run(four(), seed=seed) for seed in (1, 2))
    found = innervate.compare(one, other)
    assert not found.same
    assert found.divergence.a.split(", ")[1].startswith("node ")


def test_it_is_exported(done, bare, tmp_path, tshark):  # noqa: F811
    mark = done.result.fingerprint
    written = capture.write(done.plan, tmp_path / "four.pcapng", fingerprint=mark)
    assert written.sent == done.summary["frames"]["sent"]
    lines = tshark(tmp_path / "four.pcapng", "-Y", "innervate.skin.beacon", "-T", "fields", "-e",
                   "innervate.skin.beacon.dist", "-e", "frame.interface_name")  # fmt: skip
    assert len(lines) > 500
    assert not tshark(tmp_path / "four.pcapng", "-Y", "innervate.skin.malformed")
    graphs.write(done.plan, tmp_path / "four.json")
    assert '"p0 r0 c3"' in (tmp_path / "four.json").read_text()
    frames = {name: table.collect() for name, table in done.tables.items()}
    assert recording.write(done.plan, frames, tmp_path / "four.mcap") > 100
    assert 'define("skin"' in dissector.source()
