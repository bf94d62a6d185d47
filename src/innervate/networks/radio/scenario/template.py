"""A commented scenario of a radio team to start from (`innervate new`)."""

TEMPLATE = """\
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
