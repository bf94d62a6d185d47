"""One emulated board each of a mesh and of a radio team, on serial lines, among live nodes."""

import asyncio
import contextlib
import shutil
import subprocess
import sys

import pytest

from innervate.firmware import library, tools
from innervate.live.channel import Medium
from innervate.live.channel_radio import MediumRadio
from innervate.live.modem import Modem
from innervate.live.receipts import DELIVERED
from innervate.live.serial import SerialLink
from innervate.live.serial_cables import Cables
from innervate.networks.mesh.live.node import MeshNode
from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.live.stack import MeshStack
from innervate.networks.radio.live.node import RadioNode
from innervate.networks.radio.live.parameters import RADIO, radio_parameters
from innervate.networks.radio.live.stack import StationStack
from tests.live.net import until
from tests.networks.radio.live.test_radio import SLOW

pytestmark = pytest.mark.flaky(reruns=1)  # boards in real time, as in test_boards_sealed.py

FIRST_S = 60.0
BAUD = 1_000_000
PATIENT = {"ack_us": 30_000, "e2e_us": 300_000}  # a busy machine is no dead neighbour
BOARD = 1
QUICKLY = (*tools.CORTEX_M3, "-O0")  # a third of the time that -Os takes, as test_million.py has it


@pytest.fixture(autouse=True)
def needed():
    for name in ("arm-none-eabi-gcc", "qemu-system-arm"):
        if shutil.which(name) is None:
            pytest.skip(f"{name} is not installed")


def image(tmp_path, role, main, settings, *more):
    files = library.made_of(role, [f"{name}={value}" for name, value in settings.items()])
    library.write(files, tmp_path / "lib")
    options = (*QUICKLY, *(more or (f"-DNUMBER={BOARD}",)), "-DSEED=4711")
    return tools.image(tmp_path / "lib", role, tmp_path, main, options)


@contextlib.contextmanager
def board(made, devices, *more):
    """An emulated board with its first UARTs on these serial ports."""
    words = [word for device in devices for word in ("-serial", device)]
    command = ["qemu-system-arm", "-M", "mps2-an385", "-display", "none", "-monitor", "none",
               "-kernel", made, *words, *more]  # fmt: skip
    process = subprocess.Popen(command, stdin=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@contextlib.contextmanager
def serial(count):
    cables = Cables(count)
    cables.start()
    try:
        yield cables
    finally:
        cables.stop()


def test_a_mesh_board_answers_discovery_and_relays(tmp_path):
    made = image(tmp_path, "mesh", "small", {"nodes": 3, **PATIENT})
    params = mesh_parameters(3, PATIENT)

    async def go(cables):
        n0, n2 = (
            MeshNode(f"n{i}", MeshStack(i, rank, params, 7919 + i), [SerialLink(device, BAUD)])
            for i, rank, device in ((0, 0, cables.devices[0]), (2, -1, cables.devices[3]))
        )
        heard = []
        n2.receive_messages(lambda sender, payload: heard.append((sender, payload)))
        with board(made, cables.devices[1:3]):
            async with n2, n0:
                await until(lambda: n2.stack.node.version and n0.stack.node.version, FIRST_S)
                assert [row["node"] for row in n0.status()["neighbours"]] == [BOARD]
                assert n0.status()["routes"]["2"][0] == BOARD  # it reported whom it hears
                for k in range(20):
                    receipt = n0.send_message(2, b"by the board %d" % k)
                    assert await receipt.wait() == DELIVERED
                assert n2.arrived_by[0] == [0, BOARD, 2]
                back = n2.send_message(0, b"and back")
                assert await back.wait() == DELIVERED
                own = n2.send_message(BOARD, b"for the board itself")
                assert await own.wait() == DELIVERED
        assert heard == [(0, b"by the board %d" % k) for k in range(20)]

    with serial(2) as cables:
        asyncio.run(go(cables))


@pytest.mark.slow
def test_a_mesh_board_leads(tmp_path):
    made = image(tmp_path, "mesh", "small", {"nodes": 3, **PATIENT}, "-DNUMBER=0", "-DLEADS")
    params = mesh_parameters(3, PATIENT)

    async def go(cables):
        n1, n2 = (
            MeshNode(f"n{i}", MeshStack(i, -1, params, 7919 + i), [SerialLink(device, BAUD)])
            for i, device in ((1, cables.devices[0]), (2, cables.devices[3]))
        )
        with board(made, cables.devices[1:3]):
            async with n2, n1:
                await until(lambda: n2.stack.node.version and n1.stack.node.version, FIRST_S)
                assert n1.status()["gateway"] == n2.status()["gateway"] == 0
                assert n1.status()["routes"]["2"][0] == 0
                receipts = [n1.send_message(2, b"%d" % k) for k in range(20)]
                assert {await receipt.wait() for receipt in receipts} == {DELIVERED}

    with serial(2) as cables:
        asyncio.run(go(cables))


@contextlib.asynccontextmanager
async def inside(device, where):
    """A modem for the board, in this program."""
    modem = Modem(SerialLink(device, BAUD), MediumRadio(BOARD, where))
    await modem.start()
    yield
    modem.stop()
    assert modem.unsound == 0


@contextlib.asynccontextmanager
async def by_command(device, where):
    """`innervate live modem` for it."""
    command = [sys.executable, "-m", "innervate.cli", "live", "modem", device,
               f"{where[0]}:{where[1]}", "--number", str(BOARD)]  # fmt: skip
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        said = await asyncio.to_thread(process.stdout.readline)
        assert f"is station {BOARD} of" in said
        yield
    finally:
        process.terminate()
        process.wait()
        process.stdout.close()


async def spoken(team, user, heard):
    """The stations and the board's user send, and all is heard."""
    for node in team:
        await node.start()
    receipts = [node.send_packet(b"from %d" % node.stack.station.number) for node in team]
    await until(lambda: all(r.state == DELIVERED for r in receipts), FIRST_S)
    user.path.send(b"from the board")
    wanted = {(name, BOARD, b"from the board") for name in ("s0", "s2")}
    await until(lambda: wanted <= set(heard), FIRST_S)
    more = [team[0].send_packet(b"again %d" % k) for k in range(3)]
    for k in range(3):
        user.path.send(b"board %d" % k)
    await until(lambda: all(r.state == DELIVERED for r in more), FIRST_S)
    wanted = {("s2", BOARD, b"board %d" % k) for k in range(3)}
    await until(lambda: wanted <= set(heard), FIRST_S)
    for node in team:
        await node.stop()


@pytest.mark.parametrize("modem", [inside, pytest.param(by_command, marks=pytest.mark.slow)])
def test_a_radio_board_takes_part_in_a_team(modem, tmp_path):
    timing = {key: SLOW[key] for key in RADIO}
    made = image(tmp_path, "radio", "modem", timing)

    async def go(cables):
        medium = Medium(SLOW["slot_us"], SLOW["ta_us"])
        where = medium.open(("127.0.0.1", 0))
        heard, told = [], []
        team = [RadioNode(f"s{i}", StationStack(i, radio_parameters(timing), 97 + i),
                          MediumRadio(i, where)) for i in (0, 2)]  # fmt: skip
        for node in team:
            node.receive_packets(
                lambda source, payload, n=node: heard.append((n.name, source, payload))
            )
        user = SerialLink(cables.devices[3], BAUD)
        with board(made, cables.devices[1:3]):
            async with modem(cables.devices[0], where):
                await user.open(lambda _path, data: told.append(data))
                await spoken(team, user, heard)
                user.close()
        medium.close()
        assert {b"\0\0from 0", b"\2\0from 2", *(b"\0\0again %d" % k for k in range(3))} <= set(told)
        assert {station for *_, station, _ in medium.log} == {0, BOARD, 2}

    with serial(2) as cables:
        asyncio.run(go(cables))
