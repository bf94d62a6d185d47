"""Colours of recordings: published ones, and those of the reports."""

from itertools import pairwise

import pytest

from innervate.export import rrd_parts
from innervate.plot import theme

# Okabe and Ito, "Color universal design", 2008: blue, orange, bluish green, reddish purple, sky
# blue, yellow; vermilion.
OKABE_ITO = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#f0e442"]
VERMILION = "#d55e00"


def css(colour):
    return "#" + bytes(colour).hex()


def light(colour):
    """How light it looks: Rec. 709's luma, without its gamma."""
    return sum(share * part for share, part in zip((0.2126, 0.7152, 0.0722), colour, strict=True))


def test_ports_have_hues_that_colour_blind_readers_tell_apart():
    assert [css(colour) for colour in rrd_parts.PORTS[:6]] == OKABE_ITO
    assert css(rrd_parts.ALARM) == VERMILION
    assert len({*rrd_parts.PORTS, rrd_parts.ALARM}) == 8


def test_from_little_to_much_is_as_in_the_reports():
    shades = [line.partition(":")[2] for line in theme.drawing_style().split(";") if "--h" in line]
    assert [css(colour) for colour in rrd_parts.HEAT[:4]] == shades[0:8:2]
    lights = [light(colour) for colour in rrd_parts.HEAT]
    assert lights == sorted(lights, reverse=True)


def test_greys_are_grey_and_apart():
    greys = [rrd_parts.INK, rrd_parts.GREY, rrd_parts.PALE]
    assert all(max(grey) - min(grey) <= 16 for grey in greys)
    lights = [light(grey) for grey in greys]
    assert min(b - a for a, b in pairwise(lights)) > 60


@pytest.mark.parametrize(("share", "colour"), [
    (0, (246, 243, 238)), (0.25, (251, 211, 156)), (0.125, (248, 227, 197)), (1, (120, 45, 0)),
    (0.875, (165, 74, 11)),
])  # fmt: skip
def test_between_two_shades_is_their_mean(share, colour):
    assert tuple(rrd_parts.heat([share])[0].tolist()) == colour
