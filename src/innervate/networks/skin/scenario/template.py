"""A commented scenario of a skin to start from (`innervate new`)."""

TEMPLATE = """\
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
