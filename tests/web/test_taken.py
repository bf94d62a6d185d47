"""What changes nothing of a network: to take away what is gone, to give back what is there."""

import pytest

from innervate.scenario.actions import cables, channel, field
from innervate.web.taken import Taken


def changes(table, words, absent=(), thing=3):
    taken, by_word = Taken(), {one.word: one for one in table}
    return [taken.changes(table, by_word[word], thing, absent) for word in words.split()]


@pytest.mark.parametrize(("table", "words", "expected"), [
    (cables.TABLE, "kill kill revive revive kill", [1, 0, 1, 0, 1]),
    (cables.TABLE, "cut cut restore restore", [1, 0, 1, 0]),
    (cables.TABLE, "restart kill restart", [1, 1, 0]),  # who is off is not restarted
    (cables.TABLE, "loose loose lose lose", [1, 1, 1, 1]),
    (field.TABLE, "kill restart kill kill restart", [1, 1, 1, 0, 1]),  # here a restart switches on
    (field.TABLE, "quiet jam jam quiet quiet", [0, 1, 1, 1, 0]),
    (channel.TABLE, "leave leave kill kill revive revive", [1, 0, 1, 0, 1, 0]),
    (channel.TABLE, "leave revive leave", [1, 1, 1]),
    (channel.TABLE, "kill leave garble", [1, 0, 1]),
    (field.TABLE, "kill jam restart quiet", [1, 1, 1, 1]),
])  # fmt: skip
def test_the_same_again_changes_nothing(table, words, expected):
    assert changes(table, words) == expected


@pytest.mark.parametrize("table", [channel.TABLE, field.TABLE])
def test_who_is_yet_to_come_cannot_be_switched_off(table):
    assert changes(table, "kill revive kill", absent={3}) == [False, True, True]


def test_who_left_is_off():
    taken, kill = Taken(), channel.TABLE[channel.KILL]
    taken.gone(3)
    assert [taken.changes(channel.TABLE, kill, node, ()) for node in (2, 3)] == [True, False]
