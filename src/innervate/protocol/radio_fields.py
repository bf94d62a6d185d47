"""Declarations of the radio: every field once, as (name, length, low, high, unit, meaning).

See skin_fields.py for what the columns mean.
"""

FRAME = (
    ("kind", 0, 0, 15, "type", "1 CR-R or pulse, 2 data, 3 open, 4 report"),
    ("slots", 0, 0, 4095, "slots", "length on the air"),
    ("source", 0, 0, 1023, "station", "data: who sends; receivers of other kinds never know"),
    ("handle", 0, 0, 65535, "number", "data: the first packet in it"),
    ("count", 0, 0, 15, "packets", "data: packets in it"),
    ("pos", 0, 0, 127, "position", "the sender's place in the round"),
    ("next", 0, 0, 127, "position", "whose turn follows; own = open window, 127 = nobody's"),
    ("more", 0, 0, 1, "flag", "the sender keeps its place"),
    ("ok", 0, 0, 1, "flag", "the frame before this one was received"),
    ("good", 2, 0, 65535, "bits", "report: minislots in which one CR-R was heard"),
    ("bad", 2, 0, 65535, "bits", "report: minislots in which several collided"),
    ("base", 0, 0, 127, "position", "report: place of the first good minislot"),
    ("window", 0, 0, 63, "minislots", "report: size of the window that follows; 0 none"),
    ("span", 0, 0, 1023, "minislots", "report: what those without a minislot draw from"),
    ("split", 0, 0, 1, "flag", "report: collided ones split, two minislots each, ahead of others"),
)

PACKET = (
    ("slots", 0, 1, 4095, "slots", "length on the air"),
    ("handle", 0, 0, 65535, "number", "its owner's name for it; counts up"),
)

# What every station on the channel has, whatever its protocol.
STATION = (
    ("number", 0, 0, 1023, "station", "who we are, in our data frames"),
    ("rng", 0, 1, 1073741823, "state", "generator of random choices"),
    ("choice", 0, -1, 1073741823, "value", "what the next draw shall return; -1 = generate"),
    ("asked", 0, 0, 1073741823, "count", "out of how many the last scripted draw was"),
    ("size", 16, 0, 4095, "slots", "queue: length of each packet"),
    ("handle", 16, 0, 65535, "number", "queue: the owner's name for each packet"),
    ("head", 0, 0, 15, "place", "queue: the oldest packet"),
    ("queued", 0, 0, 16, "packets", "queue: how many"),
    ("leaving", 0, 0, 1, "flag", "sends what it has, then no more"),
    ("cd", 0, 0, 1, "flag", "carrier: somebody else is heard"),
    ("rise", 0, 0, 1073741823, "us", "when the carrier came"),
    ("fall", 0, 0, 1073741823, "us", "when the carrier went"),
    ("end", 0, 0, 1073741823, "us", "E: when our last transmission ends or ended"),
    ("mode", 0, 0, 31, "mode", "what we are doing"),
)

PRACTICAL = (
    ("at", 0, 0, 1073741823, "us", "idle: not to open before"),
    ("armed", 0, 0, 1, "flag", "the main timer means something"),
    ("act", 0, 0, 1, "flag", "the act timer means something"),
    ("decoded", 0, 0, 1, "flag", "the burst that ends now was a frame"),
    ("tail", 0, 0, 1, "flag", "the carrier now is the rest of a collision of ours"),
    ("collided", 0, 0, 1, "flag", "there was a collision: open with a probe, not with a packet"),
    ("lonely", 0, 0, 31, "tries", "openings without hearing anybody"),
    ("fails", 0, 0, 255, "packets", "not proved, in a row"),
    ("pos", 0, -1, 119, "position", "our place in the round; -1 none"),
    ("live", 120, 0, 1, "flag", "places in the round that are taken"),
    ("cur", 0, -1, 119, "position", "whose turn it is, or will be after the window; -1 nobody's"),
    ("turns", 0, 0, 65535, "turns", "since the last open window"),
    ("pending", 0, 0, 15, "packets", "sent, waiting for proof"),
    ("named", 0, -1, 119, "position", "whose frame may prove it; -1 nobody's"),
    ("until", 0, 0, 1073741823, "us", "a frame that starts later proves nothing"),
    ("next", 0, 0, 127, "position", "what we named in our last turn, as on the air"),
    ("last_ok", 0, 0, 1, "flag", "the turn before was received"),
    ("window", 0, 0, 63, "minislots", "size of the present window"),
    ("span", 0, 0, 1023, "minislots", "what its last part is drawn from"),
    ("split", 0, 0, 32, "minislots", "collided minislots that split in it"),
    ("ack", 0, 0, 1, "flag", "a minislot for pulses goes ahead of it"),
    ("ref", 0, 0, 1073741823, "us", "end of the frame before the window, as we heard or sent it"),
    ("slot", 0, -1, 63, "minislot", "the one we used; -1 none"),
    ("heard", 0, 0, 2, "flag", "a carrier came in this window; 2 = and a report is due"),
    ("good", 2, 0, 65535, "bits", "reporter: minislots with one CR-R"),
    ("bad", 2, 0, 65535, "bits", "reporter: minislots with noise"),
    ("rest", 0, 0, 1023, "minislots", "reporter: drawn from but not yet opened"),
    ("opener", 0, 0, 1, "flag", "reporter: this window follows our opening"),
)

PARAMS = (
    ("slot_us", 0, 1, 1000000, "us", "a slot: 8 bits"),
    ("bit_us", 0, 1, 100000, "us", "a bit"),
    ("ta_us", 0, 0, 1000000, "us", "turnaround of the radio, each way"),
    ("dmin_us", 0, 1, 100000, "us", "least delay between two stations"),
    ("dmax_us", 0, 1, 100000, "us", "greatest delay between two stations"),
    ("packet_slots", 0, 3, 4095, "slots", "T: the longest packet"),
    ("minislot_us", 0, 1, 1000000, "us", "practical: w, a CR-R and twice the spread of delays"),
    ("probe_us", 0, 1, 4000000, "us", "practical: u, length of an opening and of the idle before"),
    ("retry_us", 0, 1, 8000000, "us", "practical: Wr, colliders wait less than this"),
    ("join_us", 0, 1, 268435455, "us", "practical: J, listeners wait this long"),
    ("dead_us", 0, 1, 16000000, "us", "practical: D, silence after which a turn is given up"),
    ("guard_us", 0, 0, 100000, "us", "wait before an own turn, where delays differ by more than 2"),
    ("turns", 0, 1, 65535, "turns", "practical: K, turns between open windows"),
    ("per_turn", 0, 1, 8, "packets", "most packets in one turn"),
    ("wait_us", 0, 0, 268435455, "us", "paper: W, bound of the random wait"),
)
