"""What became of a running mesh's messages and alarms so far, counted as a summary does."""

import time
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np

from innervate.networks.mesh.analysis.alarms import judged
from innervate.networks.mesh.analysis.headline import Traffic, traffic
from innervate.networks.mesh.analysis.messages import duplicates, messages, took_effect
from innervate.networks.mesh.analysis.summary import looped
from innervate.networks.mesh.protocol import constants as c
from innervate.web.engine import Engine, Rows

TABLES = ("rows", "sent", "delivered")
CODES = (c.REPORT_ACCEPTED, c.REPORT_FULL, c.REPORT_EXPIRED, c.REPORT_ALARM)
SHARE = 20  # of this share of the time messages are counted anew, at most
AT = {"rows": "time", "sent": "end", "delivered": "time"}


class TrafficRecorder:
    """The rows that `analysis` counts messages by, as far as the network has come."""

    def __init__(self, engine: Engine) -> None:
        self._engine = engine
        self._parts: dict[str, list[Any]] = {name: [] for name in TABLES}
        self._found = Traffic()
        self._found_us = -1
        self._not_before = 0.0

    def add(self, rows: Rows) -> None:
        """Rows that have come since the last call."""
        sent = rows["sent"]
        routed = np.isin(sent["kind"], (c.DATA, c.ALARM)) & (sent["link_dst"] != c.ALL)
        fresh = {
            "rows": rows["rows"][np.isin(rows["rows"]["code"], CODES)],
            "sent": sent[routed],
            "delivered": rows["delivered"],
        }
        for name, found in fresh.items():
            if len(found):
                self._parts[name].append(found)

    def forget(self) -> None:
        """The network has gone back to its present moment."""
        for name, parts in self._parts.items():
            kept = [part[part[AT[name]] < self._engine.now_us] for part in parts]
            self._parts[name] = [part for part in kept if len(part)]
        self._found_us = -1

    def traffic(self, exact: bool) -> Traffic:
        """What became of all messages until now; of a moment ago, unless it is to be exact."""
        now_us, began = self._engine.now_us, time.monotonic()
        if now_us == self._found_us or (not exact and 0 <= self._found_us < now_us
                                        and began < self._not_before):  # fmt: skip
            return self._found
        self._found, self._found_us = self._counted(), now_us
        took = time.monotonic() - began
        self._not_before = began + SHARE * took
        return self._found

    def _counted(self) -> Traffic:
        engine = self._engine
        rows = {}
        for name, parts in self._parts.items():
            empty = getattr(engine.world, name)[:0]
            rows[name] = np.concatenate(parts) if parts else empty
            self._parts[name] = [rows[name]] if parts else []
        faults = sorted([*engine.plan.faults, *engine.given], key=lambda fault: fault.at_us)
        plan = replace(engine.plan, faults=[f for f in faults if f.at_us < engine.now_us])
        result = SimpleNamespace(plan=plan, ended_us=engine.now_us, **rows)
        crossings, false = judged(result)
        return traffic(
            messages(result),
            crossings,
            duplicates(result),
            looped(result),
            took_effect(plan, result.ended_us),
            false,
        )
