"""What stations of the baselines have besides radio_fields.STATION; columns as there."""

BASELINE = (
    ("armed", 0, 0, 1, "flag", "the main timer means something"),
    ("decoded", 0, 0, 1, "flag", "the burst that ends now was a frame"),
    ("start", 0, 0, 1073741823, "us", "when our packet goes or went on the air"),
    ("tries", 0, 0, 16, "collisions", "of the packet at the head of the queue"),
    ("since", 0, 0, 1073741823, "us", "the channel is idle since then"),
    ("open", 0, 0, 1, "flag", "it was so for the time that must pass before sending"),
    ("due", 0, 0, 1073741823, "us", "CSMA/CD: not to send before; the backoff ends"),
    ("left", 0, 0, 32767, "slots", "DCF: of the backoff"),
    ("counting", 0, 0, 1, "flag", "DCF: the backoff counts down; ring: whom we named is to begin"),
    ("count", 0, 0, 15, "packets", "ring, polling: sent, and not yet told of"),
    ("mark", 0, 0, 1073741823, "us", "a moment at which a slot of the common clock began"),
    ("step", 0, 0, 1022, "number",
     "that slot's, modulo the number of stations; ring, polling: whom we named"),
    ("attempt", 0, 0, 1, "flag", "chance: the slot waited for is one to send in"),
    ("heard", 0, 0, 2, "result", "tree: in this slot; 0 nothing, 1 noise, 2 a packet"),
    ("told", 0, 0, 2, "result", "tree: of our own packet; 0 none was sent"),
    ("depth", 0, -1, 1048576, "place", "tree: in the stack; 0 sends, -1 takes no part"),
    ("branches", 0, 0, 1048576, "branches", "tree: not yet visited, as far as we know"),
)  # fmt: skip
