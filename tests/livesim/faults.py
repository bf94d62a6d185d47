"""Faults planted in the live stack, each to be found: python -m tests.livesim.faults [NUMBER ...].

Each is a text of one module that stands there once, and what it is replaced with. A process of its
own imports the module so, and runs seeds until one is broken.
"""

import importlib.machinery
import importlib.util
import subprocess
import sys
import time
from pathlib import Path
from typing import NamedTuple

PROTOCOL = "innervate.networks.mesh.protocol."
LIVE = "innervate.live."
MESH = "innervate.networks.mesh.live."
SEEDS = 30
SMALL = {"nodes": 6, "storms": 1, "storm_s": 20, "calm_s": 0, "rate": 20}
OF_KIND = {
    "mesh": SMALL,
    "skin": {"columns": 2, "rows": 2, "storms": 1, "storm_s": 20, "calm_s": 0},
    "radio": {"nodes": 5, "storms": 1, "storm_s": 60, "calm_s": 0, "every_s": 1.0},
    "weeks": {
        "nodes": 5,
        "storms": 1,
        "storm_s": 1200,
        "calm_s": 4000,
        "slow": 60,
        "rate": 0.1,
        "multicast": False,
        "held_up": False,
    },
}
LONG_SEALED = {"sealed": True}
KILLS = {"hurts": ("crash", "restarts"), "storm_s": 60}
LOSSES = {"hurts": ("lossy", "doubled", "cut")}
LIVES = {"hurts": ("full", "crash", "restarts", "lossy", "sluggish"), "storm_s": 60}
LONG = {"long": 0.5, "mtu": 127}


class Fault(NamedTuple):
    """A mistake, and in which runs it shows."""

    what: str
    module: str
    old: str
    new: str
    given: dict
    kind: str = "mesh"


# The router's window is looked at by tests/networks/mesh/protocol/test_parts.py: live nodes know
# copies by themselves (decision 0060), so that its faults do not show here. Nor do timers that are
# late by a second, which only make all slower: tests/live/test_engine.py has them.
FAULTS = (
    Fault("a message in order is acknowledged when it comes", PROTOCOL + "messages",
          "        if not is_ordered(frame):\n", "        if 1:\n",
          {**KILLS, "in_order": True}),
    Fault("a copy of one that waits for its turn is acknowledged", PROTOCOL + "messages",
          "        if is_ordered(frame):\n            hand_up",
          "        if 0:\n            hand_up",
          {"hurts": ("crash", "restarts", "lossy", "cut"), "storm_s": 60, "in_order": True}),
    Fault("one that was given up is told as delivered", PROTOCOL + "retransmission",
          "report(out, REPORT_EXPIRED, node.wait_handle[w], NO_ACK)",
          "report(out, REPORT_ARRIVED, node.wait_handle[w], node.wait_seq[w])", KILLS),
    Fault("a hop's ack is taken for the recipient's", MESH + "outgoing",
          "receipt.move(HOP_ACKED)", "self._end(handle, DELIVERED, is_there=True)", LOSSES),
    Fault("a retry has another number", PROTOCOL + "retransmission",
          "        node.q_seq[i] = node.wait_seq[w]\n", "        node.q_seq[i] = node.seq + 1\n",
          LOSSES),
    Fault("a message is tried for ever", PROTOCOL + "retransmission",
          "    if node.wait_tries[w] > params.e2e_tries or is_expired(node, params, now, w):\n",
          "    if 0:\n", KILLS),
    Fault("nobody is told of a message that has expired", MESH + "outgoing",
          'self._end(handle, EXPIRED, REASONS.get(detail, ""), is_there)', "pass", KILLS),
    Fault("retries are never due", PROTOCOL + "retransmission",
          "        set_timer(out, RETRY, (now + soonest) & MASK30)\n", "        return\n", LOSSES),
    Fault("a delivered message's receipt is kept", MESH + "outgoing",
          "receipt = self.receipts.pop(handle, None)", "receipt = self.receipts.get(handle)",
          LOSSES),
    Fault("nothing waits for its turn", MESH + "order",
          "        elif not self._had(before):\n", "        elif False:\n",
          {**LOSSES, "in_order": True}),
    Fault("what comes after its turn is handed up", MESH + "order",
          "if self._is_late(seq, before, boot, now - self.last_at >= QUIET_US):", "if False:",
          {"hurts": ("lossy", "sluggish"), "in_order": True, "storm_s": 60}),
    Fault("no message names the one before it", MESH + "chains",
          "return self._open[dest][-1] if self._open.get(dest) else seq", "return seq",
          {**LOSSES, "in_order": True}),
    Fault("what was handed up is handed up again", LIVE + "streams",
          "waiting, self._waiting = self._waiting, []", "waiting = list(self._waiting)",
          {"in_order": False}),
    Fault("what waits is lost when another comes", LIVE + "streams",
          "        self._waiting.append(item)\n", "        self._waiting = [item]\n",
          {**LOSSES, "in_order": True}),
    Fault("SIGTERM does not wait for messages", LIVE + "main",
          "if not await self.node.drain(DRAIN_S):", "if False:", {}),
    Fault("SIGTERM is not heard", LIVE + "main",
          "loop.add_signal_handler(number, self.ending.set)", "pass", {}),
    Fault("a state file is not synced", LIVE + "state",
          "                machine().sync(file)\n", "                pass\n",
          {"hurts": ("power",), "storm_s": 60}),
    Fault("a state file is written over", LIVE + "state",
          'new = self.path.with_name(self.path.name + ".new")', "new = self.path",
          {"hurts": ("power",), "storm_s": 60}),
    Fault("a full disk ends a node", LIVE + "state",
          "        except OSError as error:\n            with suppress",
          "        except FileExistsError as error:\n            with suppress",
          {"hurts": ("full", "clock", "crash"), "storm_s": 60}),
    Fault("a log that cannot be written ends a node", LIVE + "machine",
          "        with suppress(OSError, ValueError):\n            self.log(text)\n",
          "        self.log(text)\n", {"hurts": ("full", "clock", "crash"), "storm_s": 60}),
    Fault("a new key seals at once", LIVE + "rotation",
          "self.sealer.load_keys({**old, **keys}, self.ring.use)",
          "self.sealer.load_keys({**old, **keys}, use)",
          {"sealed": True}),
    Fault("the old key is forgotten at once", LIVE + "rotation",
          "self.sealer.load_keys({**old, **keys}, self.ring.use)",
          "self.sealer.load_keys(keys, use)",
          {"sealed": True}),
    Fault("the old key is never forgotten", LIVE + "rotation",
          "for key, value in self.ring.keys.items() if key != number}",
          "for key, value in self.ring.keys.items()}", {"sealed": True}),
    Fault("a frame that was taken is not noted", LIVE + "keys",
          "        opened.window.take(opened.counter)\n", "",
          {"sealed": True, "serial": False, "hurts": ("replays", "doubled"), "storm_s": 60},
          "skin"),
    Fault("a sealed frame is opened whenever it comes", LIVE + "keys",
          "        if not session.window.is_new(counter):\n", "        if False:\n",
          {"sealed": True, "multicast": False, "hurts": ("replays",)}),
    Fault("what is sealed for a group is opened whenever it comes", LIVE + "group",
          "        if not heard.window.is_new(counter):\n", "        if False:\n",
          {"sealed": True, "multicast": True, "hurts": ("replays",)}),
    Fault("a station's frame is taken twice", LIVE + "on_air",
          "            self.engine.receive(0, at)\n",
          "            self.engine.receive(0, at)\n            self.engine.receive(0, at)\n", {},
          "radio"),
    Fault("a packet is delivered when it is sent", "innervate.networks.radio.live.node",
          "        return wire.encode(frame, payload)\n",
          "        for k in range(frame.count):\n"
          "            self._packets[frame.handle + k][1].move(DELIVERED)\n"
          "        return wire.encode(frame, payload)\n",
          {"hurts": ("channel", "unplugged"), "every_s": 0.5}, "radio"),
    Fault("a radio stays deaf once it has sent", LIVE + "channel_radio",
          '        if what in (b"R", b"L"):\n            self.mode = "listening"\n', "", {},
          "radio"),
    Fault("a serial line that was plugged in again is not heard", LIVE + "serial",
          "asyncio.get_running_loop().add_reader(self._port.fileno(), self._readable)", "pass",
          {"serial": True}, "skin"),
    Fault("a damaged frame is taken", "innervate.networks.skin.frames",
          "        return BAD_CRC\n", "        pass\n",
          {"serial": True, "hurts": ("changing",), "storm_s": 60}, "skin"),
    Fault("the last piece is acknowledged whatever is missing", MESH + "pieces",
          "        if one.missing:\n            return False, None\n",
          "        if one.missing:\n            return True, None\n", {**KILLS, **LONG}),
    Fault("pieces are put one behind the other as they come", MESH + "pieces",
          "        self.data[piece.at : piece.at + len(piece.data)] = piece.data\n",
          "        at = len(self.data) - self.missing\n"
          "            self.data[at : at + len(piece.data)] = piece.data\n", {**LOSSES, **LONG}),
    Fault("pieces of who is gone are never forgotten", MESH + "pieces",
          "            if now - one.heard_at >= idle_us:\n", "            if False:\n",
          {**KILLS, **LONG}),
    Fault("a sender may open as many messages as it likes", MESH + "pieces",
          "        if len(own) >= EACH:", "        if False:", {**KILLS, **LONG}),
    Fault("a piece that was given up is no matter", MESH + "long",
          "        if state != DELIVERED:\n", "        if False:\n", {**KILLS, **LONG}),
    Fault("nobody is told that a piece was given up", MESH + "long",
          "            self.on_end(EXPIRED, reason)\n", "            pass\n", {**KILLS, **LONG}),
    Fault("packets' numbers begin anywhere after a restart", MESH + "node",
          "        if self.state.numbers >= 0:\n", "        if 0:\n",
          {**KILLS, "sealed": False, "in_order": False}),
    Fault("who was stopped for long goes on with what waited", LIVE + "engine",
          "        if late_us > self.late_us:\n", "        if False:\n",
          {"nodes": 6, "storm_s": 300, "rate": 10, "hurts": ("held_up", "lossy", "cut")}),
    Fault("copies are known by the router alone", MESH + "inbox",
          "is_again = is_copy or is_again", "pass",
          {**LIVES, "in_order": False}),
    Fault("an old session is never forgotten", LIVE + "contact",
          "            if now - session.made_at > OLD_US:\n", "            if False:\n",
          LONG_SEALED, "weeks"),
    Fault("a session does not wear out by time", LIVE + "session",
          "        return now - self.made_at > late or ", "        return ", LONG_SEALED, "weeks"),
    Fault("a session wears out ten times as soon", LIVE + "session",
          "late = REKEY_US if self", "late = REKEY_US // 10 if self", LONG_SEALED, "weeks"),
    Fault("a session does not wear out by what is sealed in it", LIVE + "session",
          " or self.counter > COUNTERS // 2", "", {**LONG_SEALED, "near_ends": True}, "weeks"),
    Fault("a new session is not used while there is an old one", LIVE + "contact",
          "        self._current = session\n", "        self._current = self._current or session\n",
          LONG_SEALED, "weeks"),
    Fault("a path at rest is hardly looked after", LIVE + "contact",
          "    rest_s = 10.0 ", "    rest_s = 10_000.0 ", LONG_SEALED, "weeks"),
    Fault("who rests is not stirred", LIVE + "contact",
          "        if self._rests and self._timer is not None:\n", "        if False:\n",
          LONG_SEALED, "weeks"),
    Fault("silence is not noticed", LIVE + "contact",
          "is_silent = self._sent_at > 0 and now - self._sent_at > SILENT_US", "is_silent = False",
          LONG_SEALED, "weeks"),
    Fault("silence is taken for a session that is lost", LIVE + "contact",
          "        elif self._current and 0 < self._sent_at < now - DOUBT_US:\n"
          "            self.tell(self._current, ALIVE)\n", "", LONG_SEALED, "weeks"),
    Fault("who finds nobody asks less and less often", LIVE + "contact",
          "WAIT_MAX_S = 1.0\n", "WAIT_MAX_S = 1000.0\n",
          {**LONG_SEALED, "hurts": ("cut", "partition")}, "weeks"),
    Fault("sessions of a key that is gone go on", LIVE + "keys",
          "who.key in gone", "False", LONG_SEALED, "weeks"),
    Fault("no path is ever silent", MESH + "stack",
          "self.silent_us = 3 *", "self.silent_us = 3000 *", {}, "weeks"),
    Fault("a neighbour that is gone is never forgotten", PROTOCOL + "neighbours",
          "& 65535) > most:\n", "& 65535) > 65535:\n", {}, "weeks"),
    Fault("neighbours are forgotten by ticks that never come round", PROTOCOL + "neighbours",
          "            if ((node.ticks - node.heard[k]) & 65535) > most:\n",
          "            if node.ticks - node.heard[k] > most:\n", {"near_ends": True}, "weeks"),
    Fault("what a gateway heard counts for ever", PROTOCOL + "paths",
          "gate.heard[k] = (high & low) << 1 | high & ~low", "gate.heard[k] = high << 1 | low",
          {}, "weeks"),
    Fault("only who has no table is given one", PROTOCOL + "gateway",
          "        give_jobs(node, gate, params, changed, out)\n",
          "        give_jobs(node, gate, params, 0, out)\n", {}, "weeks"),
    Fault("what was had of a sender is never forgotten", PROTOCOL + "duplicates",
          "            node.idle[k] = node.idle[k] - 1\n", "            pass\n", {}, "weeks"),
    Fault("what was had of a sender is forgotten with the next tick", PROTOCOL + "duplicates",
          "            node.idle[k] = node.idle[k] - 1\n", "            node.idle[k] = 0\n",
          {}, "weeks"),
    Fault("packets' numbers are noted once in a life", MESH + "node",
          "        if state.numbers < 0 or not self._ahead // 2 <= left <= self._ahead:\n",
          "        if self._ahead < 0:\n", {"calm_s": 86_400, "sealed": False}, "weeks"),
    Fault("an epoch is not noted", MESH + "node",
          "            self.state.epoch = b\n            self.save()\n",
          "            self.state.epoch = b\n", {}, "weeks"),
    Fault("the clock is the machine's idea of the time", LIVE + "engine",
          "return machine().monotonic_ns() // 1000", "return machine().time_ns() // 1000",
          {**LONG_SEALED, "hurts": ("clock",)}, "weeks"),
)  # fmt: skip


def source_of(module):
    """The text of a module, as it lies."""
    return Path(importlib.util.find_spec(module).origin).read_text(encoding="utf-8")


class Planted(importlib.machinery.SourceFileLoader):
    """Loads a module with a text in it replaced."""

    fault = None

    def get_code(self, fullname):
        text = Path(self.path).read_text(encoding="utf-8")
        return compile(text.replace(self.fault.old, self.fault.new), self.path, "exec")


class Finder:
    """Finds the module that a fault is planted in."""

    def __init__(self, fault):
        self.fault = fault

    def find_spec(self, name, path, target=None):
        if name != self.fault.module:
            return None
        spec = importlib.machinery.PathFinder.find_spec(name, path, target)
        spec.loader = Planted(name, spec.origin)
        spec.loader.fault = self.fault
        return spec


def seek(number):
    """Run seeds with a fault until one is broken: where, or "" if none is."""
    fault = FAULTS[number]
    sys.meta_path.insert(0, Finder(fault))
    from tests.livesim import runs

    for seed in range(1, SEEDS + 1):
        found = runs.run(seed, fault.kind, **OF_KIND[fault.kind] | fault.given)
        if found.broken:
            return f"seed {seed}: {found.broken[0]}"
    return ""


def main(numbers):
    """Try these faults, or all; 1 if one was not found."""
    if numbers[:1] == ["--one"]:
        found = seek(int(numbers[1]))
        print(found)
        return 0 if found else 1
    missed = 0
    for number in map(int, numbers or range(len(FAULTS))):
        began = time.monotonic()
        command = [sys.executable, "-m", "tests.livesim.faults", "--one", str(number)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        missed += done.returncode != 0
        told = (done.stdout.strip() or done.stderr.strip() or "NOT FOUND").splitlines()[-1]
        took_s = time.monotonic() - began
        print(f"{number:2} {FAULTS[number].what}: {told[:150]} ({took_s:.0f} s)", flush=True)
    print(f"{len(numbers or FAULTS) - missed} found, {missed} not")
    return min(1, missed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
