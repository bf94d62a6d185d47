"""Identities on real processes: messages go, one node is put out by a command, the others go on."""

import asyncio
import os
import subprocess
import sys

from innervate import scenario as scenarios
from innervate.live import status
from innervate.live.enrolment import Authority
from tests.live.net import running, until
from tests.live.test_reload import FIRST_S, LINE, told


def last_state(network, name, to):
    request = {"do": "send", "to": to, "payload": "00"}
    for answer in status.ask(network.socket(name), request):
        if answer["state"] in ("delivered", "expired", "refused"):
            return answer["state"]
    return "gone"


def test_a_node_is_put_out_by_a_command_and_the_others_go_on(tmp_path):
    soon = {**LINE["protocol"], "e2e_s": 0.05}  # a message to who is put out expires sooner
    plan = scenarios.plan(scenarios.from_dict({**LINE, "protocol": soon}))
    authority = Authority(tmp_path / "keys")
    for number in range(3):
        authority.enrol(number)

    async def main():
        keys = {"identity": "keys/n{number}.identity"}
        async with running(plan, tmp_path, "udp", keys) as network:
            await until(lambda: all(told(network, n)["table"] for n in network.names), FIRST_S)
            assert await asyncio.to_thread(last_state, network, "n0", 2) == "delivered"
            words = [sys.executable, "-m", "innervate.cli", "live", "revoke", "keys", "2"]
            env = {**os.environ, "INNERVATE_RUN": str(tmp_path)}
            done = await asyncio.to_thread(
                subprocess.run, words, cwd=tmp_path, env=env, capture_output=True, text=True
            )
            assert (done.returncode, done.stderr) == (0, "")
            assert done.stdout.startswith("told n0, n1")
            assert told(network, "n1")["keys"]["identity"]["revoked"] == [3]
            assert await asyncio.to_thread(last_state, network, "n0", 1) == "delivered"
            assert await asyncio.to_thread(last_state, network, "n0", 2) == "expired"
            assert told(network, "n1")["counters"]["dropped: sealed: revoked"] > 0

    asyncio.run(main())
