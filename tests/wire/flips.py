"""Bytes with some bits the other way round."""

from hypothesis import strategies as st


def flipped(sent, *bits):
    """A frame's bytes with bits flipped, counted from its first."""
    hit = bytearray(sent)
    for bit in bits:
        hit[bit >> 3] ^= 0x80 >> (bit & 7)
    return hit


def flipped_thrice(sent, data):
    """The same with one to three bits flipped that Hypothesis chooses."""
    places = st.integers(0, 8 * len(sent) - 1)
    return flipped(sent, *data.draw(st.sets(places, min_size=1, max_size=3)))
