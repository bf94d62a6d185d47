"""What a capture says of a skin's recovery is what happened to it."""

import asyncio
import json

import pytest

import innervate
from innervate import scenario
from innervate.cli import app, capturing
from innervate.export import capture, pcapng
from innervate.export.errors import ExportError
from innervate.export.reading import Capture
from innervate.live import status, tap
from innervate.networks.skin.export.recovery import line, recoveries
from innervate.networks.skin.live.parameters import SKIN
from tests.live.net import Skin, until
from tests.networks.skin.runs import patch

CUT = patch(
    4, 4, (0, 0), (3, 3),
    duration_s=0.9, seed=3, protocol={"beacon_hz": 250, "k": 5}, data={"rate_hz": 100},
    event=[{"at_s": 0.5, "action": "cut", "interface": 1},
           {"at_s": 0.8, "action": "restore", "interface": 1}],
)  # fmt: skip
PERIOD_MS = 4.0


def test_a_simulations_capture_says_what_its_summary_says(tmp_path):
    path = tmp_path / "run.pcapng"
    capture.write(scenario.plan(scenario.from_dict(CUT)), path)
    told = innervate.run(scenario.from_dict(CUT), out=None).summary["recoveries"][0]
    cut, restored = recoveries(Capture(path))
    after_ms = 1000 * (cut.at_s - 0.5)  # nobody sent anything just when it was cut
    assert 0 <= after_ms < PERIOD_MS
    assert cut.what.endswith(" - pc.1")
    assert cut.cells == told["cut_cells"] > 3
    assert after_ms + cut.routed_ms == pytest.approx(told["routed_ms"], abs=0.5)
    assert cut.first_ms <= cut.wrong_ms + PERIOD_MS
    assert cut.wrong_ms <= cut.routed_ms < cut.heard_ms < 50
    assert cut.heard_median_ms <= cut.heard_ms
    assert cut.lost > 0
    assert restored.what.startswith("restore")
    assert restored.cells == 0


def line_of(cells, *events):
    return patch(
        cells, 1, (0, 0), duration_s=1.0, seed=3,
        protocol={"beacon_hz": 250, "k": 5}, data={"rate_hz": 100}, event=list(events),
    )  # fmt: skip


def found_in(tables, path):
    capture.write(scenario.plan(scenario.from_dict(tables)), path)
    return recoveries(Capture(path))


CUT_0 = {"at_s": 0.5, "action": "cut", "interface": 0}


def test_who_is_cut_off_for_good_is_told_from_who_finds_another_way(tmp_path):
    tables = line_of(3, CUT_0, {"at_s": 0.8, "action": "restore", "interface": 0})
    gone, back = found_in(tables, tmp_path / "line.pcapng")
    assert (gone.cells, gone.apart) == (0, ["c0", "c1", "c2"])
    assert gone.watched_ms == pytest.approx(300, abs=PERIOD_MS)
    assert line(gone).endswith("; 3 cells cut off, with no cables to the PC left (c0, c1, c2); "
                               "no other cell had to find another way")  # fmt: skip
    assert (back.cells, back.apart) == (3, [])
    assert 0 < back.routed_ms < 50
    assert "; 3 cells: first moved" in line(back)
    # A cell amid others is switched off: its cables go dead, and theirs lead round it.
    kill = {"at_s": 0.5, "action": "kill", "cell": {"row": 1, "column": 1}}
    *_, last = found_in({**CUT, "event": [kill]}, tmp_path / "patch.pcapng")
    assert last.apart == ["c5"]
    told = innervate.run(scenario.from_dict({**CUT, "event": [kill]}), out=None).summary
    assert told["recoveries"][0]["cut_off"] == 0  # switched off, which cables cannot show


def test_a_second_cut_at_the_same_moment_is_reckoned_with(tmp_path):
    """Of two cables to the PC one breaks a millisecond after the other, or a cell does."""
    both = [CUT_0, {**CUT_0, "at_s": 0.501, "interface": 1}]
    first, second = found_in({**CUT, "event": both}, tmp_path / "both.pcapng")
    assert first.cells > 0
    assert first.watched_ms < PERIOD_MS
    assert f"all routed not within {first.watched_ms:.0f} ms" in line(first)
    assert (second.cells, second.apart) == (0, [f"c{i}" for i in range(16)])
    assert "16 cells cut off" in line(second)
    assert "(c0, c1, c2, c3, c4, c5, c6, c7, ...)" in line(second)
    # Where one cable is left, those that the first cut deprived of their way are watched on.
    cable = {"at_s": 0.501, "action": "cut", "cell": {"row": 3, "column": 0}, "port": "E"}
    first, second = found_in({**CUT, "event": [CUT_0, cable]}, tmp_path / "one.pcapng")
    assert first.routed_ms is None
    assert second.cells >= first.cells > 0
    assert second.apart == []
    assert 0 < second.routed_ms < 50


def test_a_live_skins_capture_says_what_happened_to_it(tmp_path, capsys):
    path = tmp_path / "live.pcapng"

    async def main():
        async with Skin(3, 2, [(0, 2), (5, 3)]) as skin:
            servers = {
                node.name: status.Server(
                    tmp_path / f"{node.name}.sock", lambda _, out, node=node: tap.serve(node, out)
                )
                for node in (*skin.cells, skin.pc)
            }
            for server in servers.values():
                await server.start()
            await until(skin.fresh())
            await until(lambda: sum(skin.pc.status()["cells"]) == 6)
            with path.open("wb") as file:
                recorder = capturing.Recorder([s.path for s in servers.values()], file)
                running = asyncio.create_task(recorder.run(0))
                await until(lambda: recorder.frames > 200)  # all have sent beacons
                skin.pc.change(0, "cut")
                skin.cells[0].change(len(skin.cells[0].paths) - 1, "cut")
                await until(skin.fresh())
                await until(lambda: all(c.status()["parent"] is not None for c in skin.cells))
                await skin.pc.stop()
                await servers["pc"].stop()
                await until(lambda: all(c.status()["parent"] is None for c in skin.cells))
                await servers["pc"].start()
                await until(lambda: recorder.here == 7)
                await skin.pc.start()
                await until(skin.fresh())
                await until(lambda: all(c.status()["parent"] is not None for c in skin.cells))
                await asyncio.sleep(2 * capturing.HOLD_S)
                for server in servers.values():
                    await server.stop()
                assert await running == 0

    asyncio.run(main())
    cut, gone, back = recoveries(Capture(path))
    detected_ms = SKIN["k"] * SKIN["beacon_us"] / 1000
    assert cut.what == "cut c0.2 - pc.0"
    assert 1 <= cut.cells <= 5
    assert 0.5 * detected_ms < cut.wrong_ms <= cut.routed_ms < 3000
    assert cut.heard_ms > 0.5 * detected_ms
    assert (gone.what, gone.cells) == ("pc gone", 0)
    assert (cut.apart, gone.apart) == ([], [f"c{i}" for i in range(6)])
    assert (back.what, back.cells) == ("pc back", 6)
    assert 0 < back.routed_ms < 3000
    assert app.main(["live", "recovery", str(path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [one["what"] for one in told] == [cut.what, gone.what, back.what]
    assert app.main(["live", "recovery", str(path)]) == 0
    assert "pc back; 6 cells: first moved" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("kind", "description", "why"),
    [
        (148, "node 1", "no capture of a skin"),
        (147, "cell 1 port 0", "which cables join its interfaces"),
    ],
)
def test_what_says_nothing_of_parents_is_told(kind, description, why, tmp_path):
    path = tmp_path / "other.pcapng"
    blocks = (pcapng.section(), pcapng.interface(kind, "x", description),
              pcapng.packet(0, 1, b"x", pcapng.OUTBOUND))  # fmt: skip
    path.write_bytes(b"".join(blocks))
    with pytest.raises(ExportError, match=why):
        recoveries(Capture(path))


def test_a_capture_of_others_is_no_skins_also_if_nothing_was_sent(tmp_path):
    path = tmp_path / "quiet.pcapng"
    for interface in (b"", pcapng.interface(149, "s0", "station 0")):
        path.write_bytes(pcapng.section() + interface)
        with pytest.raises(ExportError, match="no capture of a skin"):
            recoveries(Capture(path))
    path.write_bytes(pcapng.section() + pcapng.interface(147, "pc.0", "pc port 0"))
    assert recoveries(Capture(path)) == []


def test_what_ends_in_the_middle_of_a_block_says_so(tmp_path, capsys):
    path = tmp_path / "cut.pcapng"
    blocks = pcapng.section() + pcapng.interface(147, "pc.0", "pc port 0")
    for more in (b"", blocks[:7]):
        path.write_bytes(blocks + more)
        assert app.main(["live", "recovery", str(path)]) == 0
        assert ("ends in the middle of a block" in capsys.readouterr().err) == bool(more)
