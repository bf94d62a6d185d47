"""Named random streams: the same everywhere, independent of each other."""

from __future__ import annotations

import hashlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from innervate.trace.streams import Stream, stream


def test_numbers_are_those_of_splitmix64() -> None:
    # Published first outputs of splitmix64 for state 1234567.
    draws = Stream(1234567)
    assert [draws.next64() for _ in range(3)] == [
        6457827717110365317,
        3203168211198807973,
        9817491932198370423,
    ]


def test_names_and_seeds_give_different_streams() -> None:
    firsts = {stream(seed, name).next64() for seed in range(20) for name in ("a", "b", "c")}
    assert len(firsts) == 60
    assert stream(3, "a").next64() == stream(3, "a").next64()


@given(st.integers(0, 2**63), st.integers(1, 2**32))
def test_draw_stays_below_its_limit(seed: int, n: int) -> None:
    draws = stream(seed, "x")
    assert all(0 <= draws.draw(n) < n for _ in range(20))


@given(st.integers(0, 2**63), st.integers(-1000, 1000), st.integers(0, 1000))
def test_uniform_includes_both_ends(seed: int, low: int, more: int) -> None:
    draws = stream(seed, "x")
    assert all(low <= draws.uniform(low, low + more) <= low + more for _ in range(20))


def test_draws_are_even() -> None:
    draws = stream(1, "even")
    counts = [0] * 6
    for _ in range(6000):
        counts[draws.draw(6)] += 1
    assert min(counts) > 900
    assert max(counts) < 1100


def test_draw_of_nothing_is_refused() -> None:
    with pytest.raises(ValueError, match="n >= 1"):
        Stream(1).draw(0)


def test_a_uniform_draw_comes_to_both_ends() -> None:
    draws = stream(1, "ends")
    assert {draws.uniform(-1, 2) for _ in range(200)} == {-1, 0, 1, 2}
    assert {draws.draw(1) for _ in range(9)} == {0}
    assert draws.uniform(5, 5) == 5


def test_a_stream_is_known_by_its_seed_and_its_name() -> None:
    digest = hashlib.blake2b(b"7/clock/3", digest_size=8).digest()
    known = Stream(int.from_bytes(digest, "big"))
    assert stream(7, "clock/3").next64() == known.next64()
    assert Stream(-1).next64() == Stream(2**64 - 1).next64()


def test_a_draw_is_the_share_that_a_number_is_of_all() -> None:
    one, other = Stream(5), Stream(5)
    assert [one.draw(1000) for _ in range(5)] == [other.next64() * 1000 >> 64 for _ in range(5)]
