"""The page over running nodes, as a user has it: `innervate live up` and `innervate watch live`."""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tomllib
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from docs.patch import scenario
from innervate import scenario as scenarios
from innervate.live import status
from innervate.networks.skin.sim.simulate import simulation
from tests.browser.servers import WAIT_MS, click, expect, facts, serving
from tests.browser.test_design import WRITTEN
from tests.browser.test_kinds import written
from tests.firmware.test_patch_of_twelve import hops
from tests.fixtures.scenarios import one_port

pytestmark = pytest.mark.slow
RING = Path(__file__).parents[1] / "networks" / "tokenring"
RADIO = """
kind = "radio"
duration_s = 60
stations = 3
[traffic]
kind = "disaster"
"""
LINKS = "".join(
    f'[[link]]\na = "n{a}"\nb = "n{b}"\n' for a, b in ((0, 1), (1, 2), (2, 3), (3, 0), (2, 4))
)
MESH = f'kind = "mesh"\nduration_s = 60\nradio = {{ profile = "ip" }}\n{LINKS}'
SKIN = one_port(3, 2)


@contextmanager
def up(scenario, folder, monkeypatch, *options):
    """A network of processes; gives the folder of their files."""
    here = folder / "net"
    (folder / "net.toml").write_text(scenario)
    monkeypatch.setenv("INNERVATE_RUN", str(here))
    command = [sys.executable, "-m", "innervate.cli", "live", "up", str(folder / "net.toml")]
    process = subprocess.Popen(
        [*command, "--folder", str(here), *options], stdout=subprocess.PIPE, text=True
    )
    try:
        assert "up after" in process.stdout.readline()
        yield here
    finally:
        process.send_signal(signal.SIGINT)
        process.wait(timeout=30)
        process.stdout.close()


@pytest.fixture
def short(tmp_path_factory):
    """A folder whose name is short enough for sockets."""
    return tmp_path_factory.mktemp("l")


def test_a_station_is_cut_off_and_let_back(look, short, monkeypatch):
    with up(RADIO, short, monkeypatch), serving("live") as address:
        page, other = look(address), look(address, colours="dark")
        expect(page.locator("#unconnected .more")).to_have_text("of 3 stations")
        page.keyboard.press("?")
        expect(page.locator("#keys")).to_contain_text("kill or revive the node")
        for absent in ("pause or go on", "one event further", "slower", "next colouring"):
            expect(page.locator("#keys dd", has_text=absent)).to_be_hidden()
        page.keyboard.press("Escape")
        expect(page.locator("#timeline")).to_be_hidden()
        click(page, "s1", "cut off")
        expect(page.locator("#headline")).to_contain_text("Robot s1 is silent")
        expect(other.locator("#unconnected output")).to_have_text("1")
        click(other, "s1")
        expect(facts(page)).to_have_text("idle")
        expect(page.locator("#unconnected output")).to_have_text("0")


def test_nobody_says_that_a_channel_is_free_of_which_nobody_answers(look, short, monkeypatch):
    network = ExitStack()
    network.enter_context(up(RADIO, short, monkeypatch))
    with network, serving("live") as address:
        page = look(address, script=WRITTEN)
        expect(page.locator("#unconnected .more")).to_have_text("of 3 stations")
        assert "nobody answers" not in written(page)
        network.close()
        expect(page.locator("#level")).to_have_text("? no data")
        assert {"nobody answers"} <= written(page)
        assert "channel free" not in written(page)


def test_serial_cables_are_drawn_and_cut(look, short, monkeypatch):
    with up(SKIN, short, monkeypatch, "--pty"), serving("live") as address:
        page = look(address)
        expect(page.locator("#unconnected output")).to_have_text("0")
        expect(page.locator("#legend")).to_contain_text("by nodes that do not run here")
        click(page, "c0 - pc.0", "link, cut")
        expect(page.locator("#unconnected output")).to_have_text("6")
        expect(page.locator("#recovery .more")).to_contain_text("no cell is left")
        click(page, "c0 - pc.0", "link, up")
        expect(page.locator("#unconnected output")).to_have_text("0")
        page.locator("#tool").select_option("look")
        click(page, "c4")
        page.locator("#command summary").click()
        page.locator("#command-code").fill("3")
        page.locator("#command-send", has_text="Send to this cell").click()
        expect(page.locator("#log")).to_contain_text("sent to c4")
        expect(page.locator("#log")).to_contain_text("came to c4")
        expect(facts(page)).to_contain_text("came")


def test_boards_of_the_quick_start_heal_on_the_page(look, short, monkeypatch):
    for tool in ("arm-none-eabi-gcc", "qemu-system-arm"):
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed")
    with up(scenario(), short, monkeypatch, "--firmware") as here, serving("live") as address:
        page = look(address)
        well = "Every cell has a way to the PC."
        expect(page.locator("#log")).to_contain_text("link c0 - pc.0 cut", timeout=3 * WAIT_MS)
        expect(page.locator("#headline")).to_have_text(well)
        assert status.ask_one(here / "c0.sock", {"do": "status"})["dist"] == 4  # the long way round
        click(page, "c0 - pc.0", "link, up")
        os.kill(pid_of("c4.toml", here), signal.SIGKILL)
        expect(page.locator("#log")).to_contain_text("c4 does not answer any more")
        expect(page.locator("#level")).to_have_text("! degraded")
        expect(page.locator("#headline")).to_contain_text("1 of 6 cells")
        with node(here, "c4.toml", "--firmware", image_of(here)):
            expect(page.locator("#headline")).to_have_text(well, timeout=3 * WAIT_MS)
            expect(page.locator("#unconnected output")).to_have_text("0")
            os.kill(pid_of("pc.toml", here), signal.SIGKILL)
            expect(page.locator("#log")).to_contain_text("pc does not answer any more")
            expect(page.locator("#headline")).to_contain_text("no cell has a way to it")
            with node(here, "pc.toml"):
                expect(page.locator("#headline")).to_have_text(well, timeout=3 * WAIT_MS)
                expect(page.locator("#unconnected output")).to_have_text("0")
                assert [dist_of(here, number) for number in range(6)] == pc_restarted()


@contextmanager
def node(here, *words):
    """One node of a network that is started again."""
    command = [sys.executable, "-m", "innervate.cli", "live", "node", *words]
    process = subprocess.Popen(command, cwd=here, stderr=subprocess.DEVNULL)
    try:
        yield
    finally:
        process.terminate()
        process.wait(timeout=20)


def dist_of(here, number):
    """How far a cell is from the PC."""
    return status.ask_one(here / f"c{number}.sock", {"do": "status"})["dist"]


def pc_restarted():
    """The same of all cells in a simulation of this patch whose PC restarts."""
    given = {**tomllib.loads(scenario()), "event": [{"at_s": 5, "action": "restart", "pc": True}]}
    running = simulation(scenarios.plan(scenarios.from_dict(given)))
    running.advance(20_000_000, 1 << 30)
    return hops(running)


def test_a_node_is_killed_and_started_and_the_page_finds_its_server_again(look, short, monkeypatch):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    with up(MESH, short, monkeypatch) as here:
        with serving("live", port=port) as address:
            page = look(address)
            expect(page.locator("#unconnected output")).to_have_text("0")
            os.kill(pid_of("n3.toml", here), signal.SIGKILL)
            expect(page.locator("#log")).to_contain_text("n3 does not answer any more")
            click(page, "n3")  # nothing to be done about it from here
            expect(facts(page)).to_contain_text("does not answer")
            expect(page.locator("#selected-do button", has_text="Let back")).to_have_count(0)
        expect(page.locator("#lost")).to_contain_text("lost. Trying again")
        with node(here, "n3.toml"), serving("live", port=port):
            expect(page.locator("#connection")).to_have_text("connected")
            expect(facts(page)).not_to_contain_text("does not answer")
            well = "All 5 nodes have a way to the gateway."  # else it is n3 that recovers
            expect(page.locator("#headline")).to_have_text(well, timeout=3 * WAIT_MS)
            click(page, "n2 - n4")
            expect(page.locator("#unconnected output")).to_have_text("1")
            expect(page.locator("#recovery .more")).to_contain_text("n2 - n4")
            expect(page.locator("#recovery .more")).to_contain_text("1 cut off")
            expect(page.locator("#recovery .more")).not_to_contain_text("noticed")  # nobody asked
            click(page, "n2 - n4")
            expect(page.locator("#headline")).to_have_text(well, timeout=3 * WAIT_MS)
            expect(page.locator("#unconnected output")).to_have_text("0")


def test_what_was_not_clicked_is_seen_and_that_nobody_answers_is_said(look, short, monkeypatch):
    network, nothing = ExitStack(), "\u2013"
    here = network.enter_context(up(MESH, short, monkeypatch))
    with network, serving("live") as address:
        page = look(address)
        level, line = page.locator("#level"), page.locator("#headline")
        expect(level).to_have_text("✓ ok")
        expect(line).to_have_text("All 5 nodes have a way to the gateway.")
        for path in status.ask_one(here / "n4.sock", {"do": "status"})["paths"]:
            status.ask_one(here / "n4.sock", {"do": "cut", "port": path["port"]})
        expect(page.locator("#log")).to_contain_text("link n2 - n4 cut")
        expect(page.locator("#recovery .more")).to_contain_text("link n2 - n4 cut")
        expect(page.locator("#since output")).not_to_have_text(nothing)
        expect(level).to_have_text("! degraded")
        expect(line).to_contain_text("1 of 5 nodes is cut off from the gateway")
        network.close()
        expect(level).to_have_text("? no data")
        expect(line).to_have_text("None of the 5 nodes answers.")
        expect(page.locator("#unconnected output")).to_have_text(nothing)
        expect(page.locator("#connection")).to_have_text("page connected, nodes silent")
        assert page.locator(".number.done").count() == 0
        expect(page.locator(".plot b")).to_have_text([nothing] * 3)
        expect(page.locator("#state-spoken")).to_have_text("no data: None of the 5 nodes answers.")


def test_a_network_that_only_declares_itself_is_drawn_by_its_fields(look, short, monkeypatch):
    monkeypatch.setenv("INNERVATE_NETWORKS", str(RING))
    slow = 'kind = "tokenring"\nhold_us = 20_000\nlost_us = 500_000'
    with up(slow, short, monkeypatch), serving("live") as address:
        page = look(address)
        expect(page.locator("#headline")).to_have_text("All 4 nodes answer.")
        expect(page.locator("#colour option")).to_have_text(["lap", "passed", "made_at"])
        click(page, "n1", has="cut off")
        expect(page.locator("#level")).to_have_text("! degraded")
        click(page, "n1")
        expect(facts(page)).to_have_text(
            re.compile(r"lap \d+ number, passed \d+ tokens, made_at 0 us")
        )
        expect(page.locator("#unconnected .more")).to_have_text("of 4 nodes")


def image_of(folder):
    """What the boards of a patch run: as the process of one of them was told."""
    words = Path(f"/proc/{pid_of('c0.toml', folder)}/cmdline").read_text().split("\0")
    return words[words.index("--firmware") + 1]


def pid_of(file, folder):
    """The process of a node by its file."""
    found = subprocess.run(
        ["pgrep", "-f", f"live node {file}"], capture_output=True, text=True, check=True
    )
    pids = [int(line) for line in found.stdout.split()]
    return next(pid for pid in pids if os.readlink(f"/proc/{pid}/cwd") == str(folder))
