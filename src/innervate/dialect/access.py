"""What a medium and a medium access protocol say to each other: inputs, and reports that count."""

# Inputs over cables; a network may have more.
SAMPLE = 1  # item: what a node's sensors say, once a period of its source
# Inputs on the air.
PACKET = 1  # item: a packet to send (see radio_fields.PACKET)
LEAVE = 2  # finish and send no more
FORCE = 3  # paper mode: a packet to send at once, whatever the carrier says
RESULT = 4  # baselines: item.handle stations received our last packet
CLOCK = 5  # baselines: slot item.handle began item.ago us ago
QUEUE = 16  # packets a station holds; its user keeps the rest
# Reports: (code, a, b).
REPORT_DELIVERED = 1  # packet handle a and the b - 1 after it are taken for delivered
REPORT_LEFT = 8  # sends no more and may be switched off
