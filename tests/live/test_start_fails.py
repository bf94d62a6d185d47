"""A node that cannot start leaves nothing behind: no socket, no timer, no file."""

import asyncio
import errno
import gc
import socket
import time
import warnings
from types import SimpleNamespace

import pytest

from innervate.live import status, up
from innervate.live.build import build
from innervate.live.channel_radio import MediumRadio
from innervate.live.errors import LiveError
from innervate.live.machine import on
from innervate.live.main import Process
from innervate.live.nodefile import load
from innervate.networks.radio.live.node import RadioNode
from innervate.networks.radio.live.parameters import RADIO
from innervate.networks.radio.live.stack import StationStack
from innervate.scenario import load as load_scenario
from innervate.scenario import plan
from tests.live.test_names import Hung
from tests.live.test_udp import free_port

KINDS = {
    "mesh": 'kind = "mesh"\nnumber = 0\nnodes = 3\nrole = "gateway"\n',
    "sealed": 'kind = "mesh"\nnumber = 0\nnodes = 3\nrole = "gateway"\n[keys]\nuse = 1\n'
    f'secret.1 = "{"ab" * 32}"\n',
    "cell": 'kind = "skin"\nnumber = 0\nports = [0, 1]\nrate_hz = 50.0\n',
    "pc": 'kind = "skin"\nnumber = 0\nrole = "sink"\n',
}
LINK = '[[link]]\nkind = "udp"\nbind = "127.0.0.1:{}"\npeers = ["127.0.0.1:9"]\n'


def taken():
    """A socket whose port is nobody else's."""
    sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    sock.bind(("127.0.0.1", 0))
    return sock


def write(folder, head, *ports, more=""):
    path = folder / "n0.toml"
    path.write_text(more + head + "".join(LINK.format(port) for port in ports))
    return load(path)


@pytest.mark.parametrize("kind", KINDS)
def test_a_second_link_that_cannot_be_opened_closes_the_first(tmp_path, kind):
    first = free_port()

    async def main():
        with taken() as sock:
            node = build(write(tmp_path, KINDS[kind], first, sock.getsockname()[1]))
            with pytest.raises(LiveError, match="cannot use UDP address"):
                await node.start()
            assert not (tmp_path / "n0.state").exists()
            with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as free:
                free.bind(("127.0.0.1", first))
            assert node.engine is None
        async with node:  # the same again, now that there is room
            assert node.paths[0].up
            assert node.paths[1].up
        async with build(load(tmp_path / "n0.toml")):
            pass

    asyncio.run(main())


@pytest.mark.parametrize("kind", KINDS)
def test_a_node_that_is_started_twice_runs_on(tmp_path, kind):
    async def main():
        async with build(write(tmp_path, KINDS[kind], free_port(), free_port())) as node:
            engine = node.engine
            with pytest.raises(LiveError, match="n0: runs already; stop it"):
                await node.start()
            assert (node.idle(), node.engine, node.paths[0].up) == ("", engine, True)
            await node.stop()
            await node.start()
            assert node.idle() == ""

    asyncio.run(main())


def test_a_misplaced_state_file_closes_all_links(tmp_path):
    port = free_port()

    async def main():
        node = build(write(tmp_path, KINDS["mesh"], port, more='state = "none/n0.state"\n'))
        with pytest.raises(LiveError, match="cannot be written"):
            await node.start()
        (tmp_path / "none").mkdir()
        async with node:
            pass

    asyncio.run(main())


class Away:
    """A channel to which there is no way at first."""

    def __init__(self):
        self.real, self.tries = socket.socket(socket.AF_INET, socket.SOCK_DGRAM), 0

    def __getattr__(self, name):
        return getattr(self.real, name)

    def connect(self, where):
        self.tries += 1
        if self.tries == 1:
            raise OSError(errno.ENETUNREACH, "Network is unreachable")
        self.real.connect(where)


def test_a_station_without_a_way_to_its_channel_is_off(monkeypatch):
    made = []

    def sock(*_):
        made.append(Away())
        return made[-1]

    async def main():
        node = RadioNode("s0", StationStack(0, RADIO, 7), MediumRadio(0, ("127.0.0.1", 9)))
        monkeypatch.setattr("innervate.live.machine.Machine.socket", sock)
        with pytest.raises(LiveError, match=r"no way to 127\.0\.0\.1:9: Network is unreachable"):
            await node.start()
        assert made[0].real.fileno() == -1
        assert (node.radio.mode, node.engine) == ("off", None)
        monkeypatch.undo()
        async with node:
            assert node.radio.mode == "listening"

    asyncio.run(main())


def test_a_process_that_cannot_start_takes_its_socket_with_it(tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_RUN", str(tmp_path))
    kept = '{"epoch": 3, "numbers": 7, "revoked": ""}'

    async def main():
        with taken() as sock:
            process = Process(write(tmp_path, KINDS["mesh"], free_port(), sock.getsockname()[1]))
            (tmp_path / "n0.state").write_text(kept)  # by another one that runs
            with pytest.raises(LiveError, match="cannot use UDP address"):
                await process.run()

    asyncio.run(main())
    assert (tmp_path / "n0.state").read_text() == kept
    assert {path.name for path in tmp_path.iterdir()} == {"n0.toml", "n0.state"}


@pytest.mark.parametrize("own", ["hung:4700", f"127.0.0.1:{free_port()}"])
def test_a_node_that_waits_for_names_stops_when_it_is_told_to(tmp_path, monkeypatch, own):
    monkeypatch.setenv("INNERVATE_RUN", str(tmp_path))
    link = LINK.replace("127.0.0.1:{}", own).replace("127.0.0.1:9", "hung:9")
    (tmp_path / "n0.toml").write_text(KINDS["mesh"] + link)

    async def main():
        with on(Hung()):
            process = Process(load(tmp_path / "n0.toml"))
            running = asyncio.ensure_future(process.run())
            await asyncio.sleep(0.2)
            process.ending.set()
            began = asyncio.get_running_loop().time()
            await asyncio.wait_for(running, 10.0)
            return asyncio.get_running_loop().time() - began, len(asyncio.all_tasks())

    took_s, tasks = asyncio.run(main())
    assert took_s < 1.0
    assert tasks == 1
    assert {path.name for path in tmp_path.iterdir()} == {"n0.toml"}


def test_a_status_socket_that_cannot_listen_is_removed(tmp_path, monkeypatch):
    def refuses(_):
        raise OSError(errno.EMFILE, "Too many open files")

    async def main():
        server = status.Server(tmp_path / "n0.sock", None)
        monkeypatch.setattr("innervate.live.admission.BoundedListener.open", refuses)
        with pytest.raises(LiveError, match="no socket here: Too many open files"):
            await server.start()
        with warnings.catch_warnings():
            warnings.simplefilter("error", ResourceWarning)
            gc.collect()

    asyncio.run(main())
    assert list(tmp_path.iterdir()) == []


def test_live_up_says_for_whom_it_waits_and_gives_up_on_all_at_once(tmp_path, monkeypatch, capsys):
    for name, value in (("START_S", 0.4), ("START_EACH_S", 0.1), ("SAY_S", 0.2)):
        monkeypatch.setattr(up, name, value)
    network = up.Processes(plan(load_scenario("line")), tmp_path, "udp")
    network.processes = dict.fromkeys(network.names, SimpleNamespace(poll=lambda: None))
    limit_s = 0.4 + 0.1 * len(network.names)
    began = time.monotonic()
    whom = f"c0 and {len(network.names) - 1} more did not answer within {limit_s:g} s"
    with pytest.raises(LiveError, match=whom):
        asyncio.run(network._ready(network.names))
    assert time.monotonic() - began < 2 * limit_s
    first, *_ = capsys.readouterr().err.splitlines()
    assert first == f"{whom.replace(f'{limit_s:g}', '0.2')}; waiting up to {limit_s:g} s"
