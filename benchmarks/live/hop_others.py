"""One node of a line of three in Reticulum or Zenoh, run as a process as hop_ends.py is.

hop_others.py {rns,zenoh} NUMBER PORT FOLDER: node 1 listens on PORT and passes on, 0 sends, 2
hears. Commands and answers are those of hop_ends.py. Both send as fast as their calls return:
Reticulum's packets without proofs, Zenoh's reliably, blocking where there is no room.
"""

import json
import os
import sys
import threading
import time
from pathlib import Path

from benchmarks.live.hop_ends import READY_S, STAMP_BYTES, cpu_s, stamped

RNS_CONFIG = """[reticulum]
enable_transport = {transport}
share_instance = No
[logging]
loglevel = 0
[interfaces]
[[link]]
type = {kind}
enabled = yes
{where}
"""


class Zenoh:
    """A peer that only knows the router in the middle."""

    def __init__(self, number, port, _folder, hear):
        import zenoh

        config = zenoh.Config()
        config.insert_json5("mode", '"router"' if number == 1 else '"client"')
        config.insert_json5("scouting/multicast/enabled", "false")
        where = json.dumps([f"tcp/127.0.0.1:{port}"])
        config.insert_json5("listen/endpoints" if number == 1 else "connect/endpoints", where)
        self.session = zenoh.open(config)
        if number == 2:
            self.heard = self.session.declare_subscriber(
                "hops/to/2", lambda sample: hear(bytes(sample.payload))
            )
        if number == 0:
            self.out = self.session.declare_publisher(
                "hops/to/2", congestion_control=zenoh.CongestionControl.BLOCK
            )

    def until_reachable(self, size):
        """Zenoh does not tell; its routes take a moment."""
        time.sleep(1.0)

    def send(self, payload, done):
        self.out.put(payload)
        done()

    def stop(self):
        self.session.close()


class Reticulum:
    """An instance with one TCP interface, the one in the middle a transport node."""

    def __init__(self, number, port, folder, hear):
        import RNS

        self.rns = RNS
        where = f"target_host = 127.0.0.1\ntarget_port = {port}"
        if number == 1:
            where = f"listen_ip = 127.0.0.1\nlisten_port = {port}"
        kind = f"TCP{'Server' if number == 1 else 'Client'}Interface"
        text = RNS_CONFIG.format(transport="Yes" if number == 1 else "No", where=where, kind=kind)
        home = folder / f"rns{number}"
        home.mkdir()
        (home / "config").write_text(text)
        RNS.Reticulum(str(home))
        self.note = folder / "rns.key"
        if number == 2:
            identity = RNS.Identity()
            self.here = RNS.Destination(identity, RNS.Destination.IN,
                                        RNS.Destination.SINGLE, "hops")  # fmt: skip
            self.here.set_packet_callback(lambda payload, _packet: hear(payload))
            self.note.write_bytes(self.here.hash)
            threading.Thread(target=self.announce, daemon=True).start()

    def announce(self):
        while True:
            self.here.announce()
            time.sleep(2)

    def until_reachable(self, size):
        rns, end = self.rns, time.monotonic() + READY_S
        hash_ = self.note.read_bytes()
        while not rns.Transport.has_path(hash_) or rns.Identity.recall(hash_) is None:
            if time.monotonic() > end:
                raise TimeoutError("node 2 was not heard of")
            time.sleep(0.1)
        self.there = rns.Destination(rns.Identity.recall(hash_), rns.Destination.OUT,
                                     rns.Destination.SINGLE, "hops")  # fmt: skip

    def send(self, payload, done):
        self.rns.Packet(self.there, payload, create_receipt=False).send()
        done()

    def stop(self):
        os._exit(0)  # its own end waits for interfaces


def send(end, size, seconds, plan):
    end.until_reachable(size)
    count, lock = {"delivered": 0, "lost": 0}, threading.Lock()
    room = threading.Semaphore(int(plan[1:]) if plan[0] == "w" else 1 << 20)

    def done(arrived=True):
        with lock:
            count["delivered" if arrived else "lost"] += 1
        room.release()

    began, cpu, sent = time.monotonic(), cpu_s(), 0
    while time.monotonic() - began < seconds:
        if plan[0] == "r":
            time.sleep(max(0, began + sent / int(plan[1:]) - time.monotonic()))
        room.acquire()
        sent += 1
        end.send(stamped(size), done)
    took = time.monotonic() - began
    time.sleep(0.5)
    return {"delivered": count["delivered"], "states": count, "seconds": took,
            "cpu_s": cpu_s() - cpu}  # fmt: skip


def main():
    which, number, port, folder = sys.argv[1:]
    late_us, cpu = [], cpu_s()

    def hear(payload):
        stamp = int.from_bytes(payload[:STAMP_BYTES], "big")
        late_us.append((time.monotonic_ns() - stamp) / 1000)

    kinds = {"zenoh": Zenoh, "rns": Reticulum}
    end = kinds[which](int(number), int(port), Path(folder), hear)
    print(json.dumps({"ready": number}), flush=True)
    for line in sys.stdin:
        words = line.split()
        if words[0] == "send":
            told = send(end, int(words[2]), float(words[3]), words[4])
        else:
            told = {"got": len(late_us), "late_us": late_us[:], "cpu_s": cpu_s() - cpu}
            late_us.clear()
            cpu = cpu_s()
        print(json.dumps(told), flush=True)
    end.stop()


if __name__ == "__main__":
    main()
