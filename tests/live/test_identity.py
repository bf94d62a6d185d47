"""Identities: nobody seals as another, and one that leaked is put out without touching others."""

import json
import stat
from itertools import pairwise

import pytest
from cryptography.exceptions import InvalidTag

from innervate.cli import main as cli
from innervate.live import identity as identities
from innervate.live.build import build
from innervate.live.enrolment import Authority, read_list
from innervate.live.errors import LiveError
from innervate.live.nodefile import load
from innervate.live.notices import Notices
from innervate.live.state import State
from innervate.wire import seal
from tests.fixtures.node_files import of_mesh
from tests.live import time_by_hand
from tests.live.pair import (
    AUTHORITY,
    SHARED,
    Wire,
    begin,
    join,
    joined,
    network_sealer,
    own_sealer,
    public_authority,
    settle,
)
from tests.live.time_by_hand import timed

VALVE = b"OPEN VALVE"
OTHERS = bytes([77]) * 32


def test_an_identity_is_of_its_number_and_its_authority_alone():
    own = identities.enrol(AUTHORITY, 3, 7, SHARED)
    exchange = identities.noise.public(own.exchange)
    serial, signing = identities.check(own.authority, 3, exchange, own.certificate)
    assert (serial, signing) == (7, identities.signing_public(own.signing))
    cases = [
        (own.authority, 4, exchange, own.certificate), (own.authority, 3, signing, own.certificate),
        (identities.signing_public(OTHERS), 3, exchange, own.certificate),
        (own.authority, 3, exchange, own.certificate[:-1]), (own.authority, 3, exchange, b""),
    ]  # fmt: skip
    for at in range(len(own.certificate)):
        changed = bytearray(own.certificate)
        changed[at] ^= 1
        cases.append((own.authority, 3, exchange, bytes(changed)))
    for case in cases:
        with pytest.raises(ValueError, match="no"):
            identities.check(*case)


def test_a_list_is_of_its_authority_alone():
    made = identities.revoke(AUTHORITY, 3, frozenset({7, 9}))
    assert identities.read_revoked(public_authority(), made.data) == made
    for at in range(len(made.data)):
        changed = bytearray(made.data)
        changed[at] ^= 1
        with pytest.raises(ValueError, match="no"):
            identities.read_revoked(public_authority(), bytes(changed))
    for data in (b"", made.data[:-1], made.data + b"\0", bytes(70)):
        with pytest.raises(ValueError, match="no"):
            identities.read_revoked(public_authority(), data)


@pytest.mark.parametrize(
    "liar",
    [
        lambda: own_sealer(5, authority=OTHERS),  # of another authority
        lambda: as_number(own_sealer(5), 6),  # with another's number
        lambda: with_stolen_certificate(),
    ],
    ids=["another authority", "another number", "another's certificate"],
)
@timed
async def test_a_node_that_says_it_is_another_is_refused(liar):
    a, _b = joined(own_sealer(1), liar())
    await settle(3.0)
    a.frame(VALVE)
    await settle()
    assert a.sealer.counts["handshakes"] == 0
    assert a.sealer.dropped["sealed: not of our authority"] > 0
    assert not any(said[0] == seal.FRAME for said in a.said)


def as_number(sealer, number):
    sealer.sender = number
    return sealer


def with_stolen_certificate():
    """Everything that node 6 ever showed, without its private keys."""
    sealer, six = own_sealer(6, serial=66), own_sealer(6, serial=67)
    sealer.ring.certificate = six.ring.certificate
    return sealer


async def line(*numbers):
    """Nodes in a line; [the wires of each]."""
    wires = [[Wire(f"{number} left"), Wire(f"{number} right")] for number in numbers]
    for (_, right), (left, _) in pairwise(wires):
        join(right, left)
    for number, ends in zip(numbers, wires, strict=True):
        begin(own_sealer(number), *ends)
    await settle()
    return wires


def test_every_list_of_who_is_put_out_is_said_however_soon_it_follows():
    async def main():
        ((_, right),) = await line(1)
        said = []
        right.sealer.said = Notices(said.append).tell
        for version in (1, 2):
            serials = frozenset(range(200, 200 + 10 * version))
            assert right.sealer.revoke(identities.revoke(AUTHORITY, version, serials).data)
        return said

    first, second = time_by_hand.run(main())
    assert first.endswith("certificate 207 and 2 more, list 1")
    assert second.startswith("put out: certificate 210, ")
    assert second.endswith("certificate 217 and 2 more, list 2")


@timed
async def test_a_node_that_leaked_is_put_out_and_the_others_go_on():
    one, two, three, four = await line(1, 2, 3, 4)
    for left, right in ((one, two), (two, three), (three, four)):
        left[1].frame(VALVE)
        await settle()
        assert right[0].frames() == [VALVE]
    before = two[0].sealer._contacts[0].all_sessions()
    made = identities.revoke(AUTHORITY, 1, frozenset({103}))
    heard = []
    for ends in (one, two, three):
        ends[0].sealer.said = lambda matter, text: heard.append((matter, text))
    assert one[0].sealer.revoke(made.data)  # one is told, and tells the next
    await settle()
    # Who is put out is told, too, and those behind it, as long as it does what it should.
    assert heard == [("revoked by list 1", text) for text in (
        "put out: certificate 103, list 1", "put out: certificate 103 of node 3, list 1",
        "this node's identity is put out, list 1")]  # fmt: skip
    for ends in (one, two, three, four):
        assert ends[0].sealer.ring.revoked == made
        assert identities.read_revoked(public_authority(), ends[0].sealer.state.revoked)
    got = len(two[1].got)
    three[0].frame(b"still here")
    for said in list(three[0].said):
        two[1].hear(said)
    await settle(5.0)
    assert len(two[1].got) == got
    assert 3 not in two[1].sealer._contacts[1].sessions
    assert two[0].sealer._contacts[0].all_sessions() == before  # nothing was made anew
    one[1].frame(b"we go on")
    await settle()
    assert two[0].frames()[-1] == b"we go on"
    assert not one[0].sealer.revoke(made.data)
    older = identities.revoke(AUTHORITY, 1, frozenset())
    assert not one[0].sealer.revoke(older.data)  # nobody is let in again by an old list
    forged = identities.revoke(OTHERS, 9, frozenset())
    assert not one[0].sealer.revoke(forged.data)


@timed
async def test_who_was_away_hears_of_it_at_its_next_contact(tmp_path):
    a, b = Wire(), Wire()
    begin(own_sealer(1), a)
    made = identities.revoke(AUTHORITY, 4, frozenset({103}))
    a.sealer.revoke(made.data)
    state = State(tmp_path / "n2.state")
    join(a, b)
    begin(own_sealer(2, state=state), b)
    await settle()
    assert b.sealer.ring.revoked == made
    again = own_sealer(2, state=State(tmp_path / "n2.state"))
    assert again.ring.revoked == made  # and remembers


MAKERS = pytest.mark.parametrize("make", [network_sealer, own_sealer], ids=["network", "identity"])


async def group(make, *numbers):
    wires = [Wire(str(number), is_group=True) for number in numbers]
    join(*wires)
    for number, wire in zip(numbers, wires, strict=True):
        begin(make(number), wire)
    await settle(1.0)
    return wires


@MAKERS
@timed
async def test_a_group_hears_what_one_seals_once(make):
    wires = await group(make, 1, 2, 3, 4)
    for wire in wires:
        wire.frame(b"from " + wire.name.encode())
        assert len(wire.said[-1]) == 6 + 25 + (64 if make is own_sealer else 0)
    await settle()
    for wire in wires:
        others = {other.name for other in wires} - {wire.name}
        assert sorted(wire.got) == sorted((int(n), b"from " + n.encode()) for n in others)
        recorded = [data for other in wires for data in other.said]
        got = len(wire.got)
        for data in recorded:
            wire.hear(data)
        assert len(wire.got) == got


@MAKERS
@timed
async def test_who_comes_later_or_again_to_a_group_is_heard_and_hears(make):
    wires = await group(make, 1, 2)
    recorded = list(wires[0].said)
    wires[0].frame(VALVE)
    recorded += wires[0].said[-1:]
    wires[1].sealer.stop()
    late, again = Wire("3", is_group=True), Wire("2", is_group=True)
    members = [wires[0], late, again]
    join(*members)
    begin(make(3), late)
    begin(make(2), again)
    await settle(1.0)
    for data in recorded:  # what was said before they came
        late.hear(data)
        again.hear(data)
    assert late.got == again.got == []
    wires[0].frame(b"both of you")
    late.frame(b"late")
    again.frame(b"again")
    await settle()
    assert sorted(late.got) == [(1, b"both of you"), (2, b"again")]
    assert sorted(again.got) == [(1, b"both of you"), (3, b"late")]
    assert sorted(wires[0].got)[-2:] == [(2, b"again"), (3, b"late")]


@MAKERS
@timed
async def test_a_member_that_missed_anothers_new_key_asks_for_it(make):
    one, two, three = await group(make, 1, 2, 3)
    one.sealer._contacts[0].renew()  # and nobody was told
    one.frame(b"not understood")
    await settle(1.0)
    one.frame(VALVE)
    await settle()
    assert two.got == three.got == [(1, VALVE)]
    assert {**two.sealer.dropped} == {"sealed: unknown sender": 1}


@timed
async def test_no_member_of_a_group_can_seal_as_another():
    """It knows the other's key, as all do; it cannot sign."""
    one, two, three = await group(own_sealer, 1, 2, 3)
    liar = two.sealer._contacts[0]
    place = next(place for place in liar._heard if place[0] == 1)
    head = seal.header(seal.GROUP, place[0] << 16 | place[1], 500)
    cipher, signing = liar._heard[place].cipher, liar._signing
    for end in (signing.sign(head + VALVE), bytes(64), b""):
        plain = VALVE + end
        three.hear(head + cipher.encrypt(identities.noise.nonce(500), plain, head))
    assert three.got == []
    assert three.sealer.dropped["sealed: signed by another than it is from"] == 3
    one.frame(VALVE)
    await settle()
    assert three.got == [(1, VALVE)]


@timed
async def test_who_is_put_out_of_a_group_does_not_understand_it_any_more():
    one, two, three = await group(own_sealer, 1, 2, 3)
    old = dict(three.sealer._contacts[0]._heard)
    one.sealer.revoke(identities.revoke(AUTHORITY, 1, frozenset({103})).data)
    await settle(1.0)
    one.frame(VALVE)
    three.frame(b"I am three")
    await settle(1.0)
    assert two.got == [(1, VALVE)]
    assert three.got == []
    sealed = next(data for data in reversed(one.said) if data[0] == seal.GROUP)
    for heard in old.values():
        with pytest.raises(InvalidTag):
            heard.cipher.decrypt(identities.noise.nonce(0), sealed[9:], sealed[:9])


FILE = of_mesh("{number}", 4, '[keys]\nidentity = "keys/n{file}.identity"')


def test_one_command_makes_a_file_for_each_node(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("INNERVATE_RUN", str(tmp_path))
    assert cli(["live", "enrol", "keys", "--nodes", "3"]) == 0
    assert capsys.readouterr().out.split() == [f"keys/n{k}.identity" for k in range(3)]
    for path in (tmp_path / "keys").iterdir():
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
    assert cli(["live", "enrol", "keys", "7"]) == 0  # no file of others has changed
    assert cli(["live", "enrol", "keys", "7"]) == 2
    assert "node 7 is enrolled already; put it out first" in capsys.readouterr().err
    (tmp_path / "n1.toml").write_text(FILE.format(number=1, file=1))
    node = build(load(tmp_path / "n1.toml"))
    assert node.sealer.ring.identity.serial == 2
    (tmp_path / "n1.toml").write_text(FILE.format(number=1, file=2))
    with pytest.raises(LiveError, match="the identity of node 2, but number = 1 here"):
        build(load(tmp_path / "n1.toml"))
    assert cli(["live", "revoke", "keys", "7", "--json"]) == 1  # nobody runs here
    assert json.loads(capsys.readouterr().out) == {"told": [], "not": []}
    assert read_list(tmp_path / "keys" / "revoked.list")
    authority = Authority(tmp_path / "keys")
    assert (authority.version, authority.revoked) == (1, {4})
    authority.enrol(7)
    assert authority.issued[-1] == (7, 5)


def test_who_is_asked_for_with_one_that_cannot_be_is_not_made_either(tmp_path, capsys):
    keys = str(tmp_path / "keys")
    assert cli(["live", "enrol", keys, "1"]) == 0
    assert cli(["live", "enrol", keys, "--nodes", "2"]) == 2
    assert "node 1 is enrolled already" in capsys.readouterr().err
    assert Authority(tmp_path / "keys").issued == [(1, 1)]
    assert not (tmp_path / "keys" / "n0.identity").exists()


BROKEN = [
    "",
    "number = 1",
    "\0",
    "[[[",
    f"number = {'[' * 2_000}{']' * 2_000}",
    'number = 1\nserial = 2\nauthority = "aa"',
]


@pytest.mark.parametrize("text", BROKEN)
def test_what_is_no_identity_is_refused_in_a_line(tmp_path, text):
    path = tmp_path / "n1.identity"
    path.write_text(text)
    with pytest.raises(LiveError, match="not a node's identity; make one with"):
        identities.load(path, 1)
    own = identities.enrol(AUTHORITY, 1, 1, SHARED).text()
    path.write_text(own.replace("number = 1", "number = 2"))
    with pytest.raises(LiveError, match="not a node's identity"):
        identities.load(path, 2)
    (tmp_path / "authority.key").write_text(text or "x")
    with pytest.raises(LiveError, match="not an authority's file"):
        Authority(tmp_path)
