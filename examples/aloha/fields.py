"""Slotted ALOHA with acknowledgements."""

CLOCK = (0, 0, 1073741823, "us")
STATE = (
    ("number", 0, 0, 1023, "node", "who we are; node 0 sends beacons, which say where slots begin"),
    ("rng", 0, 0, 1073741823, "raw", "generator of random numbers"),
    ("choice", 0, -1, 1073741823, "raw", "what the next draw gives; -1 = it is random"),
    ("asked", 0, 0, 1073741823, "raw", "of how many the last draw was"),
    ("synced", 0, 0, 1, "flag", "we have heard a beacon"),
    ("phase", *CLOCK, "when a slot began"),
    ("waiting", 0, 0, 1, "flag", "a message is not acknowledged yet"),
    ("sending", 0, 0, 1, "flag", "our frame is on the air"),
    ("to", 0, 0, 1023, "node", "for whom it is"),
    ("value", 0, 0, 255, "raw", "what it says"),
    ("seq", 0, 0, 255, "number", "of our newest message"),
    ("tries", 0, 0, 8, "frames", "how often it was sent"),
    ("given_up", 0, 0, 65535, "messages", "never acknowledged"),
    ("made_at", *CLOCK, "when it was handed in"),
    ("seen", 16, 0, 256, "number", "newest message of each node, and 1; 0 = none"),
)
FRAME = (
    ("kind", 0, 0, 3, "type", "1 beacon, 2 message, 3 ack"),
    ("slots", 0, 0, 15, "slots", "on the air"),
    ("source", 0, 0, 1023, "node", "who sends"),
    ("to", 0, 0, 1023, "node", "for whom"),
    ("seq", 0, 0, 255, "number", "of the message"),
    ("value", 0, 0, 255, "raw", "what it says"),
    ("made_at", *CLOCK, "when it was handed in"),
)
PARAMS = (
    ("slot_length_us", 0, 100, 100_000, "us", "a message and its ack"),
    ("beacon_slots", 0, 2, 1000, "slots", "from beacon to beacon"),
    ("window_slots", 0, 1, 64, "slots", "from which the next try is drawn"),
)
DEFAULTS = {"slot_length_us": 2000, "beacon_slots": 50, "window_slots": 8}
EXPLORED = {"window_slots": 1, "beacon_slots": 2}
GIVEN = ((1, {"to": 0, "value": 7}),)
