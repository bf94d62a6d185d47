"""Where radio nodes lie and how loud each is: every rounding, edge and order by hand."""

from statistics import NormalDist

import pytest

from innervate.topology import placement


class Draw:
    """Numbers that were written down."""

    def __init__(self, *numbers):
        self.left, self.asked = list(numbers), []

    def next64(self):
        return self.left.pop(0)

    def uniform(self, low, high):
        self.asked.append((low, high))
        return self.left.pop(0)


def test_in_a_square_each_node_has_an_x_and_then_a_y():
    draw = Draw(3, 4, 5, 6)
    assert placement.square(2, 900, draw) == [(3, 4), (5, 6)]
    assert draw.asked == [(0, 900)] * 4


def test_a_grid_goes_row_by_row():
    assert placement.grid(5, 2, 30) == [(0, 0), (30, 0), (0, 30), (30, 30), (0, 60)]
    assert placement.grid(3, 3, 7) == [(0, 0), (7, 0), (14, 0)]


@pytest.mark.parametrize("share", [0.001, 0.2, 0.5, 0.8413447460685429, 0.999])
def test_a_normal_number_is_as_far_from_0_as_its_share(share):
    drawn = placement.normal_cdb(Draw(round(share * 2**64)), 800)
    assert drawn == pytest.approx(800 * NormalDist().inv_cdf(share), abs=0.51)


def test_the_least_and_the_greatest_draw_are_numbers():
    low, high = (placement.normal_cdb(Draw(one), 100) for one in (0, 2**64 - 1))
    assert (low, high) == (-829, 821)


@pytest.mark.parametrize(("cm", "exponent_c", "cdb"), [
    (100, 300, 0), (0, 300, 0), (99, 300, 0), (1_000, 300, 3_000), (10_000, 200, 4_000),
    (200, 300, 903), (1_000, 333, 3_330),
])  # fmt: skip
def test_a_signal_loses_ten_times_the_exponent_a_decade_from_a_metre_on(cm, exponent_c, cdb):
    assert placement.path_loss_cdb(cm, exponent_c) == cdb


@pytest.mark.parametrize(("a", "b", "cm"), [
    ((0, 0), (3, 4), 5), ((1, 1), (2, 2), 1), ((-3, 0), (0, -4), 5), ((7, 7), (7, 7), 0),
])  # fmt: skip
def test_a_distance_is_rounded_down(a, b, cm):
    assert placement.distance_cm(a, b) == placement.distance_cm(b, a) == cm


def drawn(z, sigma):
    return placement.normal_cdb(Draw(z), sigma)


@pytest.mark.parametrize(("shadow", "way", "count"), [
    (700, 200, 3), (700, 0, 1), (0, 200, 2), (0, 0, 0),
])  # fmt: skip
def test_shadowing_is_the_same_both_ways_and_the_directions_part_is_not(shadow, way, count):
    numbers = [k * 2**60 for k in range(1, 3 * count + 1)]
    draw = Draw(*numbers)
    found = placement.fading(3, shadow, way, draw)
    assert draw.left == []
    assert [found[i * 4] for i in range(3)] == [0] * 3
    for k, (a, b) in enumerate([(0, 1), (0, 2), (1, 2)]):
        mine = numbers[k * count : (k + 1) * count]
        common = drawn(mine.pop(0), shadow) if shadow else 0
        there, back = (drawn(one, way) for one in mine) if way else (0, 0)
        assert (found[3 * a + b], found[3 * b + a]) == (common + there, common + back)


def test_a_gain_is_what_is_left_of_0_dbm():
    points = [(0, 0), (1_000, 0), (0, 200)]
    faded = [0, 5, 6, 7, 0, 8, 9, 10, 0]
    far = placement.path_loss_cdb(placement.distance_cm(points[1], points[2]), 300)
    assert placement.gains(points, faded, 300) == [
        0, 5 - 3_000, 6 - 903, 7 - 3_000, 0, 8 - far, 9 - 903, 10 - far, 0]  # fmt: skip
    assert faded[1] == 5


GAIN = [0, -10, -30, -20, 0, -20, -30, -20, 0]  # pairs: 01 at worst -20, 02 -30, 12 -20


@pytest.mark.parametrize(("links", "level", "weaker"), [
    (1, -20, [(1, 2)]), (2, -20, []), (3, -30, []),
])  # fmt: skip
def test_so_many_links_and_those_as_loud_as_the_last_are_weakened(links, level, weaker):
    assert placement.threshold(GAIN, 3, links) == (level, weaker)


@pytest.mark.parametrize(("least", "links"), [
    (-30, [(0, 1), (0, 2), (1, 2)]), (-29, [(0, 1), (1, 2)]), (-20, [(0, 1), (1, 2)]), (-19, []),
])  # fmt: skip
def test_a_good_link_is_loud_enough_both_ways(least, links):
    assert placement.good_links(GAIN, 3, least) == links


def test_hops_and_parts_of_a_network():
    near = placement.neighbours(7, [(0, 4), (4, 2), (5, 6), (3, 2)])
    assert near == [[4], [], [4, 3], [2], [0, 2], [6], [5]]
    assert placement.distances(near, 3) == [3, -1, 1, 0, 2, -1, -1]
    assert placement.components(near) == [[0, 2, 3, 4], [5, 6], [1]]
    two = placement.neighbours(4, [(1, 3), (0, 2)])
    assert placement.components(two) == [[0, 2], [1, 3]]
