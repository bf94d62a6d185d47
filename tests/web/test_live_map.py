"""Who is cabled to whom, by what running nodes and their files call the ends of their paths."""

import pytest

from innervate.live.nodefile import load
from innervate.web.live_known import files, missing, unheard
from innervate.web.live_map import Link, Map, Place


def said(*ends, number=None):
    """What a node says of its paths; an end is (own, far), or besides where a name leads."""
    paths = [{"port": port, "name": far, "own": own} | ({"far": leads[0]} if leads else {})
             for port, (own, far, *leads) in enumerate(ends)]  # fmt: skip
    return {"paths": paths, **({} if number is None else {"number": number})}


def links(*told, before=None):
    where = Map(dict(enumerate(told)), before)
    return [(link.a.node, link.b.node, link.paths_a, link.paths_b) for link in where.links]


@pytest.mark.parametrize(
    ("here", "there", "is_one"),
    [
        (("udp a:1", "udp b:2"), ("udp b:2", "udp a:1"), True),
        (("udp 0.0.0.0:1", "udp b:2"), ("udp b:2", "udp a:1"), True),
        (("udp 0.0.0.0:1", "udp b:2"), ("udp 0.0.0.0:2", "udp a:1"), True),
        (("udp a:1", "udp b:2"), ("udp b:2", "udp c:1"), False),
        (("udp a:1", "udp c:2"), ("udp b:2", "udp a:1"), False),
        (("udp 0.0.0.0:1", "udp b:2"), ("udp b:2", "udp a:3"), False),
        (("", "udp b:2"), ("udp b:2", ""), False),
        (("udp [::]:1", "udp [fd::2]:2"), ("udp [fd::2]:2", "udp [fd::1]:1"), True),
        (("udp a:1", "udp arm:2", "udp b:2"), ("udp b:2", "udp a:1"), True),  # a name leads there
        (("serial x to y", "serial y to x"), ("serial y to x", "serial x to y"), True),
    ],
)
def test_a_cable_is_one_if_each_end_is_what_the_other_says(here, there, is_one):
    assert links(said(here), said(there)) == ([(0, 1, (0,), (0,))] if is_one else [])
    assert links(said(there), said(here)) == ([(0, 1, (0,), (0,))] if is_one else [])


def test_a_node_is_not_cabled_to_itself():
    loop = ("udp a:1", "udp a:1")
    assert links(said(loop)) == []
    assert links(said(("udp a:1", "udp a:2"), ("udp a:2", "udp a:1"))) == []


def test_two_cables_of_a_pair_are_two_and_what_nobody_names_any_more_stays():
    a = said(("udp a:1", "udp b:1"), ("udp a:2", "udp b:2"))
    b = said(("udp b:2", "udp a:2"), ("udp b:1", "udp a:1"))
    both = [(0, 1, (0,), (1,)), (0, 1, (1,), (0,))]
    assert links(a, b) == both
    where = Map({0: a, 1: b})
    assert links(a, said(), before=where) == both
    assert links(a, said(), before=None) == []
    assert where.place(0, 1) == Place(0, -1)
    assert Map({}, where).links == where.links
    assert where.numbered({0: said(number=5), 1: said()}) == {5: Place(0, -1)}


class Split(Map):
    """Nodes that say so are drawn by their ports, behind all others."""

    def is_split(self, one):
        return one.get("split", False)


def test_ports_of_a_node_that_is_drawn_by_them_come_last():
    pc = said(("udp a:1", "udp b:1"), ("udp a:2", "udp c:2")) | {"split": True}
    where = Split({0: pc, 2: said(("udp c:2", "udp a:2")), 5: said(("udp b:1", "udp a:1"))})
    assert where.places == [Place(2, -1), Place(5, -1), Place(0, 0), Place(0, 1)]
    assert where.links == [
        Link(Place(2, -1), Place(0, 1), (0,), (1,)), Link(Place(5, -1), Place(0, 0), (0,), (0,)),
    ]  # fmt: skip
    assert where.place(0, 1) == Place(0, 1)
    assert where.place(2, 0) == Place(2, -1)


FILE = 'kind = "skin"\nnumber = {number}\nrole = "{role}"\nname = "{name}"\n{more}'
SERIAL = '[[link]]\nkind = "serial"\ndevice = "/dev/{own}"\n{far}\n'


def test_a_file_says_of_its_node_what_its_status_would(tmp_path):
    udp = '[[link]]\nkind = "udp"\nbind = "10.0.0.1:1"\npeers = ["10.0.0.2:2", "10.0.0.3:3"]\n'
    far = SERIAL.format(own="x", far='far = "/dev/y"')
    path = tmp_path / "c7.toml"
    text = FILE.format(number=7, role="cell", name="c7", more=udp + far)
    path.write_text(text + SERIAL.format(own="z", far=""))
    told = unheard(load(path))
    assert [(one["port"], one["own"], one["name"]) for one in told["paths"]] == [
        (0, "udp 10.0.0.1:1", "udp 10.0.0.2:2"), (1, "udp 10.0.0.1:1", "udp 10.0.0.3:3"),
        (2, "serial /dev/y to /dev/x", "serial /dev/x to /dev/y"),
    ]  # fmt: skip
    assert all(one["up"] and one["counters"] == {} for one in told["paths"])
    assert (told["kind"], told["number"], told["role"]) == ("skin", 7, "cell")
    assert (told["neighbours"], told["counters"]) == ([], {})
    other = tmp_path / "c8.toml"
    other.write_text(FILE.format(number=8, role="cell", name="c8", more=SERIAL.format(
        own="y", far='far = "/dev/x"')))  # fmt: skip
    assert links(told, unheard(load(other))) == [(0, 1, (2,), (0,))]


def test_which_nodes_of_a_folder_have_ended(tmp_path):
    """Of three nodes one runs, one ended, one was never started; a fourth has its socket afar."""
    run = tmp_path / "run"
    run.mkdir()
    for number, name in enumerate(("n10", "n2", "n3", "far")):
        where = "/elsewhere/far.sock" if name == "far" else str(run / f"{name}.sock")
        (run / f"{name}.toml").write_text(
            f'kind = "mesh"\nnumber = {number}\nnodes = 9\nname = "{name}"\nsocket = "{where}"\n'
        )
        if name != "n3":
            (run / f"{name}.log").touch()
    (run / "scenario.toml").write_text('kind = "mesh"\nnodes = 3\n')
    assert [path.stem for path in files(run)] == ["n2", "n3", "n10"]
    assert missing(run, []) == [run / "n2.sock", run / "n10.sock"]
    assert missing(run, [run / "n2.sock"]) == [run / "n10.sock"]
    link = tmp_path / "link"
    link.symlink_to(run)  # the folder by another name
    assert [path.stem for path in files(link)] == ["n2", "n3", "n10"]
    assert missing(link, [link / "n10.sock"]) == [link / "n2.sock"]
