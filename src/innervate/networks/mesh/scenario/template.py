"""Commented scenarios of a mesh to start from (`innervate new`)."""

from __future__ import annotations

TEMPLATE = """\
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
failover = "search"           # search | alternate | rssi | random | graph | auto
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
