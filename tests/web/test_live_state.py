"""What is made of the words of running nodes: a map, ways, a headline."""

from innervate.networks.radio.view.live import RadioState
from innervate.networks.skin.view.live import SkinMap, SkinState
from innervate.web.live import Live
from innervate.web.live_map import Map
from innervate.web.live_poll import Poller
from innervate.web.live_state import State


def cell(number, parent, paths):
    """What a cell of a live skin says; `paths` are (own, far) by path, at ports 0, 1, ..."""
    return {
        "kind": "skin", "role": "cell", "number": number, "parent": parent, "load": number + 1,
        "paths": [{"own": own, "name": far, "port": at, "up": True, "counters": {"received": 1}}
                  for at, (own, far) in enumerate(paths)],
        "ports": [{"port": at, "path": at} for at in range(len(paths))], "counters": {},
    }  # fmt: skip


def udp(*ports):
    return [(f"udp 127.0.0.1:{own}", f"udp 127.0.0.1:{far}") for own, far in ports]


def skin_of_three():
    """PC - c0 - c1, with a second cable between c0 and c1."""
    pc = cell(0, None, udp((1, 2))) | {"role": "sink", "cells": [2]}
    del pc["number"]
    return {
        0: cell(0, 0, udp((2, 1), (3, 4), (5, 6))),
        1: cell(1, 1, [*udp((4, 3)), ("udp 0.0.0.0:6", "udp 127.0.0.1:5")]),
        2: pc,
    }


def test_cables_are_found_by_their_addresses():
    told = skin_of_three()
    where = SkinMap(told)
    assert [place.port for place in where.places] == [-1, -1, 0]
    found = [(where.number[link.a], where.number[link.b]) for link in where.links]
    assert found == [(0, 1), (0, 1), (0, 2)]
    state = SkinState(where, told)
    assert state.hop.tolist() == [2, 0, -1]
    assert state.fields()["depth"].tolist() == [1, 2, 0]
    assert state.fields()["port"].tolist() == [0, 0, 0]
    assert state.unconnected == 0
    told[0]["paths"][0]["up"] = False
    state = SkinState(where, told)
    assert state.link_up.tolist() == [1, 1, 0]
    assert state.unconnected == 2
    assert where.spread().shape == (3, 2)
    shown = state.headline()
    assert (shown.level, shown.nodes) == ("down", (0, 1))
    assert "cut off" in shown.text


def test_cells_of_a_running_skin_are_cut_off_seeking_or_silent():
    told = skin_of_three()
    where = SkinMap(told)
    assert SkinState(where, told).headline().level == "ok"
    told[1]["parent"] = None
    seeking = SkinState(where, told)
    assert (seeking.unconnected, seeking.lacking) == (1, 1)
    assert seeking.headline().text.startswith("1 of 2 cells (1) has no way to the PC")
    silent = SkinState(where, {i: one for i, one in told.items() if i != 1}).headline()
    assert (silent.level, silent.nodes) == ("degraded", (1,))
    no_pc = SkinState(where, {i: one for i, one in told.items() if i != 2}).headline()
    assert no_pc.level == "down"
    assert no_pc.text.startswith("The PC")
    assert SkinState(where, {}).headline().level == "no data"


def test_who_is_gone_stays_on_the_map():
    told = skin_of_three()
    where = SkinMap(told)
    left = {i: one for i, one in told.items() if i != 1}
    assert SkinState(SkinMap(told, where), left).node_up.tolist() == [1, 0, 1]
    assert SkinMap(told, where).links == where.links


def test_a_radio_team_is_a_ring_of_stations():
    told = {
        i: {"kind": "radio", "role": "station", "number": i, "mode": 0, "queued": i,
            "place": None if i else 4, "paths": [], "counters": {}}
        for i in range(3)
    }  # fmt: skip
    where = Map(told)
    state = RadioState(where, {i: told[i] for i in (0, 1)})
    assert (state.unconnected, state.lacking, state.left) == (1, 0, 2)
    fields = state.fields()
    assert fields["node_up"].tolist() == [1, 1, 0]
    assert fields["radio"] == {"now": [0, 4, 0], "turn": [4, -1, -1]}
    assert fields["unconnected"] == 1  # one that is off
    gone = RadioState(where, {}).headline()
    assert (gone.level, gone.text) == ("no data", "None of the 3 stations answers.")
    assert len({tuple(place) for place in where.spread().round(3).tolist()}) == 3


def test_who_answers_for_the_first_time_does_so_again_only_later(monkeypatch, tmp_path):
    """Node 1 comes late, goes and comes back; each of it takes two questions to be noted."""
    (tmp_path / "b.toml").write_text(
        f'kind = "mesh"\nname = "b"\nnumber = 1\nnodes = 2\nsocket = "{tmp_path}/b.sock"\n'
    )
    both = {
        i: {"kind": "mesh", "role": "node" if i else "gateway", "number": i, "gateway": 0,
            "onward": [], "paths": [], "counters": {}, "neighbours": []}
        for i in range(2)
    }  # fmt: skip
    alone = {0: both[0]}
    answers = [alone, both, alone, alone, both, both]
    monkeypatch.setattr(Poller, "ask_all", lambda self, request: dict(answers.pop(0)))
    source = Live([tmp_path / "a.sock", tmp_path / "b.sock"])
    while answers:
        source._poll()
    said = [one.what["text"] for one in source.history.after("log", 0, source.history.newest, 99)]
    assert said == [
        "b: nobody answers at its socket", "b answers", "b does not answer any more",
        "b answers again",
    ]  # fmt: skip


def test_a_cable_on_which_nothing_comes_joins_nobody_though_nobody_was_told_that_it_is_cut():
    def node(number, *paths):
        return {"number": number, "paths": [
            {"own": own, "name": far, "port": at, "up": True, "broken": is_broken}
            for at, (own, far, is_broken) in enumerate(paths)]}  # fmt: skip

    def judged(first, second):
        told = {
            0: node(0, ("udp a:1", "udp b:1", first), ("udp a:2", "udp b:2", second)),
            1: node(1, ("udp b:1", "udp a:1", False), ("udp b:2", "udp a:2", second)),
        }
        state = State(Map(told), told)
        assert state.link_up.tolist() == [1, 1]  # nobody cut it
        return state.headline()

    assert judged(False, True).level == "ok"  # the other one is left
    assert judged(True, True)[:2] == ("degraded", "No links join 1 of 2 nodes with the others.")


def test_nodes_that_others_elsewhere_may_join_are_not_told_to_be_apart():
    """A chain a - b - elsewhere - c."""
    told = {at: {"kind": "own", "counters": {}, **one} for at, one in enumerate((
        {"paths": paths((1, 2))}, {"paths": paths((2, 1), (3, 4))}, {"paths": paths((5, 6))},
    ))}  # fmt: skip
    where = Map(told)
    assert len(where.links) == 1
    assert State(where, told).headline().text == "No links join 1 of 3 nodes with the others."
    for at, path in ((1, 1), (2, 0)):
        told[at]["paths"][path]["heard_s"] = 0.1
    assert State(where, told).headline() == ("ok", "All 3 nodes answer.", ())
    told[2]["paths"][0]["broken"] = True
    assert State(where, told).unconnected == 1


def paths(*ends):
    return [{"own": own, "name": far, "port": at, "up": True, "counters": {}}
            for at, (own, far) in enumerate(udp(*ends))]  # fmt: skip


def test_a_station_alone_on_its_machine_that_hears_others_is_not_alone():
    path = {"port": 0, "name": "medium", "up": True, "counters": {}, "heard_s": None}
    timing = {"slot_us": 1, "packet_slots": 1, "ta_us": 1, "dmax_us": 1}
    told = {
        0: {
            "kind": "radio",
            "number": 3,
            "queued": 0,
            "place": 0,
            "paths": [path],
            "timing": timing,
            "counters": {"packets accepted": 2, "packets delivered": 2},
        }
    }
    assert "is alone" in RadioState(Map(told), told).headline().text
    path["heard_s"] = 4.0
    assert RadioState(Map(told), told).headline().level == "ok"


def test_a_look_collects_paths_to_others_once():
    told = skin_of_three()
    state = SkinState(SkinMap(told), told)
    assert state.paths_beyond is state.paths_beyond


def revoked(one):
    """What a node says that was told that its own identity is revoked."""
    return one | {"keys": {"identity": {"serial": 7, "list": 1, "revoked": [7]}}}


def chain():
    """What three nodes in a row say, of a network of one's own."""
    ends = ((1, 2),), ((2, 1), (3, 4)), ((4, 3),)
    return {at: {"kind": "own", "counters": {}, "paths": paths(*here)}
            for at, here in enumerate(ends)}  # fmt: skip


def test_every_network_says_of_who_is_revoked_that_it_was_put_out():
    told = chain()
    told[2] = revoked(told[2])
    state = State(Map(told), told)
    out = "1 of 3 nodes was put out: its identity is revoked."
    assert state.headline() == ("degraded", out, (2,))
    assert (state.unconnected, state.apart, state.left) == (1, 0, 1)
    assert state.fields()["put_out"].tolist() == [0, 0, 1]
    assert state.without_words() == "1 that is put out"
    told = {at: one | {"paths": []} for at, one in told.items()}
    state = State(Map(told), told)
    assert (state.headline().text, state.unconnected) == (out, 1), "cables or not"

    told = chain()
    told[2] = revoked(told[2])
    told[2]["paths"] += [paths((9, 9))[0] | {"port": 1, "heard_s": 0.1}]
    told[1]["paths"] += [paths((8, 8))[0] | {"port": 2, "heard_s": 0.1}]
    state = State(Map(told), told)
    assert (state.unconnected, state.left) == (1, 1), "whoever it hears elsewhere"
    told = chain()
    told[1] = revoked(told[1])
    state = State(Map(told), told)
    assert state.headline().text == f"No links join 1 of 3 nodes with the others; {out}"
    assert (state.unconnected, state.apart) == (2, 1)
    assert state.without_words() == "2 that are cut off or put out"
    told = chain()
    told[0] = revoked(told[0])
    assert State(Map(told), told).headline().text == out, "the first of all, too"

    told = skin_of_three()
    told[1] = revoked(told[1])
    state = SkinState(SkinMap(told), told)
    found = state.headline()
    assert found.text == (
        "1 of 2 cells (1) was put out: its identity is revoked; the other cell has a way to the PC."
    )
    assert (found.level, found.nodes) == ("degraded", (1,))
    assert (state.unconnected, state.lacking, state.left, state.apart) == (1, 0, 1, 0)
    told = skin_of_three()
    told[2] = revoked(told[2])
    state = SkinState(SkinMap(told), told)
    assert state.headline()[:2] == ("down", "The PC was put out: its identity is revoked.")
    assert (state.unconnected, state.apart) == (2, 2)
    told = {0: cell(0, 0, udp((1, 2))), 1: revoked(cell(1, None, udp((3, 4))))}
    state = SkinState(SkinMap(told), told)
    assert (state.map.links, state.unconnected, state.lacking, state.left) == ([], 1, 0, 1)


def test_who_is_cut_off_or_silent_was_not_put_out():
    told = chain()
    where = Map(told)
    told[2]["paths"][0]["up"] = False
    state = State(where, told, {where.places[2]})
    assert (state.unconnected, state.apart) == (1, 0), "cut off whole"
    assert state.without_words() == "1 that is cut off"
    del told[2]
    state = State(where, told)
    assert (state.unconnected, state.without_words()) == (0, "")
    told = {at: revoked(one) for at, one in chain().items() if at}
    assert State(where, told).headline().text == (
        "1 of 3 nodes does not answer or is cut off; "
        "2 of 3 nodes were put out: their identities are revoked."
    )


def test_a_network_of_which_all_who_answer_are_put_out_is_down():
    told = {at: revoked(one) for at, one in chain().items()}
    where = Map(told)
    out = "All 3 nodes were put out: their identities are revoked."
    assert State(where, told).headline() == ("down", out, (0, 1, 2))
    del told[0]
    assert State(where, told).headline().level == "down", "the other is silent"
    told[0] = chain()[0]
    assert State(where, told).headline().level == "degraded"


def test_a_cell_that_is_put_out_has_no_way_whatever_it_believes():
    told = {0: cell(0, 0, udp((1, 2))), 1: revoked(cell(1, 0, udp((3, 4))))}
    state = SkinState(SkinMap(told), told)
    assert (state.map.links, state.unconnected, state.left) == ([], 1, 1)
    told = skin_of_three()
    told[1] = revoked(told[1])
    told[1]["paths"][0] |= {"own": "udp 127.0.0.1:8", "name": "udp 127.0.0.1:9", "heard_s": 0.1}
    told[1]["parent"] = 0
    state = SkinState(SkinMap(told), told)
    assert (state.unconnected, state.fields()["beyond"].tolist()) == (1, [0, 0, 0])
    assert "believed" not in state.headline().text


def test_no_cell_has_a_way_to_a_pc_that_is_put_out_whatever_it_believes():
    pc = revoked(cell(0, None, udp((3, 4))) | {"role": "sink"})
    told = {0: cell(0, 0, udp((1, 2))), 1: pc}
    found = SkinState(SkinMap(told), told).headline()
    assert found[:2] == ("down", "The PC was put out: its identity is revoked.")


def test_whoever_is_put_out_and_switched_off_is_silent():
    told = skin_of_three()
    told[1] = revoked(told[1])
    where = SkinMap(told)
    del told[1]
    assert "does not answer" in SkinState(where, told).headline().text
