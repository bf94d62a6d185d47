"""Commented scenario files to start from (`innervate new`)."""

from __future__ import annotations

from innervate.scenario.emit import inline
from innervate.scenario.errors import ScenarioError
from innervate.scenario.explain import nearest

SKIN = """\
# A robot skin. Check it with `innervate check FILE`, run it with `innervate run FILE`.
kind = "skin"
schema = 1
name = "my-skin"
duration_s = 4.0              # simulated time
seed = 1                      # same seed, same run

[[patch]]                     # a rectangle of cells; rows and columns count from 0
columns = 9
rows = 11
wiring = "Z"                  # "Z", or "S" for the ports W, E, NE, SW
# count = 3                   # three such patches, joined in a row ...
# interfaces_every = 2        # ... and an interface port on every second of them

[[interface]]                 # interface port 0 of the PC, cabled to a border cell
patch = 0
row = 0
column = 3
# port = "up"                 # W, E, up or down; left out: the cell's first free port

[[interface]]                 # interface port 1
patch = 0
row = 10
column = 5

# [[cable]]                   # joins two patches
# a = { patch = 0, row = 10, column = 8 }
# b = { patch = 1, row = 0, column = 0 }

[protocol]
rule = "feasible"             # feasible | strict | paper | paper-lax | static
updates = "wave"              # periodic | triggered | wave
beacon_hz = 250
k = 5                         # missed beacons until a port is broken; or r_f and r_r
balancing = true
# m = 5                       # periods per sequence number; min(k, 5) if left out
# max_depth = 64              # hops; a deeper skin is refused

[timing]
drift_ppm = 1000              # each clock runs up to this much fast or slow
hop_latency_us = [80, 160]    # of which 60 are on the wire
latency = "per_link"          # or "per_frame"
lock_step = false             # true: all nodes tick together
loss = 0.0                    # share of frames that every cable loses

[data]
rate_hz = 100                 # samples per second and cell; 0 = off
queue = 8                     # frames per port

# [touch]                     # a touch that moves over the skin
# path = [[0.0, 0.0, 60.0], [4.0, 120.0, 60.0]]   # [t_s, x_mm, y_mm]
# radius_mm = 30
# force_n = 5

[[event]]
at_s = 2.0                    # or a range to draw from: [1.9, 2.1]
action = "cut"                # cut | restore | kill | revive | loose | restart | lose
interface = 1                 # or cell = { patch, row, column } with port = "E", link = [{}, {}],
                              # node = "n1", pc = true (restart), random = "link"
"""

RADIO = """\
# Robots that share one radio channel. Check it with `innervate check FILE`, run it with
# `innervate run FILE`.
kind = "radio"
schema = 1
name = "my-team"
duration_s = 60.0             # simulated time, at most; it ends when all is delivered
seed = 1                      # same seed, same run

stations = 10
packet_slots = 25             # 3 to 250; a slot is 8 bits; or a range: [3, 25]

[traffic]
kind = "disaster"             # disaster (all start at once) | saturated | poisson
spread_us = 0                 # disaster: starts within this time
# packets = 100               # saturated: per station, then the run ends
# load = 0.3                  # poisson: packets per packet time, of all stations together

[channel]
level = "event"               # event (every frame, to the microsecond) | slotted (as published)
bit_rate = 38400
tau_us = [52, 104]            # delay between two stations: drawn for each pair, or one number
turnaround_us = 0             # of a radio, each way; the paper's had 2000
loss = 0.0                    # share of frames that a receiver cannot read
# hidden = [[0, 3]]           # pairs that do not hear each other

[protocol]
mac = "csma-cd-r"             # csma-cd-d1 | csma-cd-d2 | csma-cd-d2p | slotted-aloha | dcf |
                              # nonpersistent | p-persistent | tree | tdma |
                              # token-ring | polling
mode = "practical"            # practical | paper
# per_turn = 4                # packets a station sends in one turn
# turns = 20                  # turns between two windows for newcomers

# [[event]]
# at_s = 1.0                  # or a range to draw from: [0.9, 1.1]
# action = "kill"             # join | leave | kill | revive | garble | fade (the next CR-R)
# station = 3                 # or "random"
"""

MESH = """\
# Robots that pass each other's messages on, and a fence that none may leave unnoticed.
# Check it with `innervate check FILE`, run it with `innervate run FILE`.
kind = "mesh"
schema = 1
name = "my-mesh"
duration_s = 60.0             # simulated time
seed = 1                      # same seed, same run

nodes = 30                    # n0 to n29; or [[node]]s with places, [[link]]s, or an [import]
gateway = 0                   # a node by number or name: it computes the routes
# standby = [5, 9]            # who takes over if it dies, in this order
monitor = "gateway"           # who gets the alarms: "gateway", or a node

[placement]
layout = "random"             # random | grid | line
side_m = 100                  # random: side of the square
# spacing_m = 10              # grid, line

# [import]                    # in place of nodes: a network that was measured
# file = "freifunk/leipzig"   # or a file of that form, or lines "A B 0.9 0.7"
# min_tq = 0.3                # worse links are left out

[radio]
profile = "250k"              # 250k | 38k4 | ip | ideal
mean_degree = 8               # good links of a node; or reach_m, or tx_dbm
# mac = "csma"                # csma | none | those of radio teams, where all hear each other

[protocol]
discovery = "list"            # list | tree | each
failover = "search"           # search | alternate | rssi | random | graph
retry = true                  # a packet whose hop failed is sent another way
reliable = true               # messages are kept until they are acknowledged end to end
# tables = false              # no routing tables: for many nodes

[[flow]]                      # messages
from = "random"               # a node, "all" or "random"
to = "monitor"                # a node, "monitor", "gateway", "random" or "all" (a broadcast)
pairs = 5                     # so many are drawn
every_s = 1.0                 # or rate_hz = 0.5
bytes = 16

[fence]
polygon = [[10, 10], [90, 10], [90, 90], [10, 90]]   # metres
# holes = [[[40, 40], [60, 40], [60, 60], [40, 60]]]

[[robot]]                     # a node that moves
node = 29
waypoints = [[50, 80], [50, 95]]
speed_mps = 1.0
start_s = 20
# random = true               # in place of waypoints: anywhere in its area

[[event]]
at_s = 15.0                   # or a range to draw from: [14.0, 16.0]
action = "kill"               # kill | revive | restart | cut | restore | jam | quiet
random = 8                    # so many bystanders; or node = 3, or link = ["n1", "n2"] (cut)
"""

MEASURED = """\
# A network as it was measured: everybody has something to tell the gateway.
# Check it with `innervate check FILE`, run it with `innervate run FILE`.
kind = "mesh"
schema = 1
name = {name}
duration_s = 60.0             # simulated time
seed = 1                      # same seed, same run
# gateway = "..."             # a node by its name; the best connected one if left out

[import]
{network}
types = {types}               # links of JSON files that count; [] = all
min_tq = {min_tq:g}                  # worse in either direction: as if there were no link
largest_component = true      # the others have no way to it

[[flow]]                      # messages
from = "all"                  # a node, "all" or "random"
to = "gateway"
every_s = 10.0
jitter_s = 10.0

# [[event]]
# at_s = 30.0
# action = "kill"             # kill | revive | restart | cut | restore | jam | quiet
# random = 5                  # so many bystanders; or node = "..."
"""

TOPOHUB = "topohub:"
_TEMPLATES = {"skin": SKIN, "radio": RADIO, "mesh": MESH}


def template(kind: str = "skin") -> str:
    """A commented scenario of a kind, ready to run.

    Raises:
        ScenarioError: there is no such kind.
    """
    if kind in _TEMPLATES:
        return _TEMPLATES[kind]
    hint = nearest(kind, list(_TEMPLATES)).replace("it knows", "there is")
    raise ScenarioError(f'there is no kind "{kind[:40]}"{hint}')


def measured(name: str, network: str, types: list[str], min_tq: float) -> str:
    """A commented scenario of a network that was measured.

    Args:
        name: of the scenario.
        network: a file as the scenario's folder sees it, a bundled one like "freifunk/leipzig", or
            "topohub:" and a name.
        types: of links that count; none = all.
        min_tq: quality of a link that counts, 0 .. 1.
    """
    key, value = "file", network
    if network.startswith(TOPOHUB):
        key, value = "topohub", network.removeprefix(TOPOHUB)
    return MEASURED.format(
        name=inline(name), network=f"{key} = {inline(value)}", types=inline(types), min_tq=min_tq
    )
