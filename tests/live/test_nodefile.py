import pytest

from innervate.live.build import build, keys_of
from innervate.live.errors import LiveError
from innervate.live.nodefile import address, load
from innervate.networks.mesh.live.parameters import IP, mesh_parameters
from innervate.networks.mesh.protocol.fields import PARAMS
from innervate.networks.mesh.scenario.profiles import IP as SCENARIOS_IP

GOOD = """
kind = "mesh"
number = 3
nodes = 9
[[link]]
kind = "udp"
bind = "127.0.0.1:0"
peers = ["127.0.0.1:4701", "127.0.0.1:4702"]
[[link]]
kind = "serial"
device = "/dev/null"
"""


def write(tmp_path, text):
    path = tmp_path / "node.toml"
    path.write_text(text)
    return path


def test_a_node_of_a_file(tmp_path):
    node = build(load(write(tmp_path, GOOD)))
    assert node.name == "n3"
    assert [path.port for path in node.paths] == [0, 1, 2]
    assert node.stack.node.number == 3
    assert node.sealer is None


KEYS_1_AND_16 = f'{{1 = "{"a" * 64}", 16 = "{"b" * 64}"}}'


# What is replaced in it: by what, and what is said.
WRONG = {
    "number = 3": [
        ("numbr = 3", 'unknown key "numbr"; do you mean "number"'),
        ("number = 9", "numbers are 0 to nodes - 1"),
        ("", '"number" is missing'),
        ('number = 3\nengine = "rust"', "'rust'; it can be python, c, auto"),
    ],
    "nodes = 9": [
        ("", '"nodes" is missing'),
        ("nodes = 9\nrole = 'sink'", "can be node, gateway, standby"),
        ("nodes = 9\nprotocol = {ack_ms = 1}", "protocol.ack_ms is unknown"),
        ("nodes = 9\nprotocol = {ack_us = 0}", "must be 1 to 16777215 us"),
        ('nodes = 9\n[keys]\nuse = 2\nsecret = {1 = "aa"}', "no such secret"),
        (f"nodes = 9\n[keys]\nuse = 1\nsecret = {KEYS_1_AND_16}",
         "keys.secret.16: numbers of keys are 0 to 15"),
    ],
    '"127.0.0.1:4701"': [
        ('"127.0.0.1"', "is no address"),
        ('"127.0.0.1:123456"', "is no address"),
        ('"localhost:0"', "localhost:0 is no address that a neighbour"),
        ('"[::1]:4701"', "cannot be reached from bind 127.0.0.1:0"),
        ('"[fe80::x]:4701"', '"[fe80::x]:4701" is no address of IPv6; write'),
        ('"[fd00::1]:"', '"[fd00::1]:" is no address of IPv6; write'),
        ('"[::ffff:10.0.0.2]:4"', "is of IPv4; write 10.0.0.2:4"),
        ('"[fd00::1%lo]:4"', "is on one interface alone; leave %lo out"),
        ('"::1:4701"', '"::1:4701" is no address; write'),
    ],
    '"127.0.0.1:0"': [
        ('"[fe80::1]:4"', "is on every interface; say which: [fe80::1%eth0]:4"),
    ],
    'kind = "udp"': [
        ('kind = "upd"', "'upd'; it can be udp, serial, multicast, medium"),
        ('kind = "udp"\nbindd = ""', 'unknown key "bindd"; see: innervate docs'),
    ],
    'kind = "mesh"': [
        ("kind = mesh", "not valid TOML"),
        (f"kind = {'[' * 2_000}{']' * 2_000}", "not valid TOML"),
    ],
}  # fmt: skip


@pytest.mark.parametrize(("old", "new", "says"), [
    (old, *wrong) for old, some in WRONG.items() for wrong in some
])  # fmt: skip
def test_what_is_wrong_is_said_in_one_line(tmp_path, old, new, says):
    path = write(tmp_path, GOOD.replace(old, new))
    with pytest.raises(LiveError) as caught:
        build(load(path))
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value) or "key is 64" in str(caught.value)


def test_the_profile_has_every_parameter_and_agrees_with_that_of_scenarios():
    params = mesh_parameters(20, {})
    assert set(params) == {name for name, *_ in PARAMS}
    ours = (
        IP["ack_us"],
        IP["transmissions"],
        IP["suspect_us"],
        IP["jitter_us"],
        IP["e2e_us"],
        IP["e2e_tries"],
    )
    theirs = SCENARIOS_IP
    assert ours == (
        theirs.ack_us,
        theirs.transmissions,
        round(theirs.suspect * 1e6),
        round(theirs.jitter * 1e6),
        round(theirs.e2e * 1e6),
        theirs.e2e_tries,
    )
    ticks = (IP["period"], IP["period_max"])
    assert ticks == (theirs.period / theirs.beacon, theirs.period_max / theirs.beacon)


def test_keys_have_the_numbers_0_to_15(tmp_path):
    secret = f'{{0 = "{"0" * 64}", 15 = "{"f" * 64}"}}'
    path = write(
        tmp_path, GOOD.replace("nodes = 9", f"nodes = 9\n[keys]\nuse = 15\nsecret = {secret}")
    )
    loaded = load(path)
    found = keys_of(loaded.table.keys, loaded)
    assert found == {0: bytes(32), 15: b"\xff" * 32}


RADIO = """
kind = "radio"
number = {number}
[[link]]
kind = "medium"
address = "127.0.0.1:4790"
"""
CELL = """
kind = "skin"
role = "cell"
number = 1
nodes = 3
[[link]]
kind = "udp"
bind = "127.0.0.1:0"
peers = [{peers}]
"""


def peers(count):
    return ", ".join(f'"127.0.0.1:{4_700 + k}"' for k in range(count))


@pytest.mark.parametrize(("text", "says"), [
    (RADIO.format(number=1022), ""), (RADIO.format(number=1023), "stations are 0 to 1022"),
    (CELL.format(peers=peers(4)), ""), (CELL.format(peers=peers(5)), "ports must name the cell's"),
    (CELL.format(peers=f"{peers(1)}, {peers(2)}"), "127.0.0.1:4700 stands there twice"),
])  # fmt: skip
def test_no_node_is_made_that_could_not_send(tmp_path, text, says):
    path = write(tmp_path, text)
    if not says:
        build(load(path))
        return
    with pytest.raises(LiveError) as caught:
        build(load(path))
    assert says in str(caught.value)


@pytest.mark.parametrize("peer", [
    "0.0.0.0:4700", "239.77.0.1:4700", "224.0.0.1:4700", "255.255.255.255:4700", "10.0.0.2:0",
])  # fmt: skip
def test_what_no_neighbour_can_have_as_its_address_is_refused(tmp_path, peer):
    with pytest.raises(LiveError) as caught:
        build(load(write(tmp_path, CELL.format(peers=f'"127.0.0.1:4700", "{peer}"'))))
    said = f"link.0.peers.1: {peer} is no address that a neighbour can have; write its own, like"
    assert said in str(caught.value)


@pytest.mark.parametrize("host", [
    "h", "n1", "my_host", "3com.example", "node-1.lan", "host.", "r\u00e4uber.local", "a." * 126,
])  # fmt: skip
def test_a_host_can_have_a_name(host):
    assert address(f"{host}:4700", "here") == (host, 4700)


@pytest.mark.parametrize("host", [
    "", ".", "-h", "a..b", "a b", "*", "127.1", "1.2.3.4.", "256.0.0.1", "x" * 64, "a." * 128,
    "\u00e4" * 60,
])  # fmt: skip
def test_what_cannot_be_a_name_is_no_host(host):
    with pytest.raises(LiveError, match="is no address"):
        address(f"{host}:4700", "here")


def test_tables_too_deep_for_whoever_reads_them_are_refused(tmp_path):
    for text in (f"a{'.a' * 3_000} = 1", f"[a{'.a' * 3_000}]"):
        with pytest.raises(LiveError, match="nested too deeply") as caught:
            load(write(tmp_path, text))
        assert len(str(caught.value)) < 300


@pytest.mark.parametrize("interface", ["eth0", "10.0.2.1:4700", "::1", "localhost"])
def test_an_interface_is_named_by_its_address(tmp_path, interface):
    group = f'kind = "multicast"\ngroup = "239.77.12.5:47012"\ninterface = "{interface}"'
    serial = 'kind = "serial"\ndevice = "/dev/null"'
    with pytest.raises(LiveError) as caught:
        build(load(write(tmp_path, GOOD.replace(serial, group))))
    said = f'link.1.interface: "{interface}" is no IPv4 address; write that of the interface'
    assert said in str(caught.value)


def test_a_group_is_an_address_of_groups(tmp_path):
    group = 'kind = "multicast"\ngroup = "10.0.0.1:4700"\ninterface = "127.0.0.1"'
    serial = 'kind = "serial"\ndevice = "/dev/null"'
    with pytest.raises(LiveError, match=r"link\.1\.group: 10\.0\.0\.1 is no multicast group"):
        build(load(write(tmp_path, GOOD.replace(serial, group))))


UDP = 'kind = "udp"\nbind = "{}"\npeers = ["127.0.0.1:4701"]'
GROUP = 'kind = "multicast"\ngroup = "{}"\ninterface = "127.0.0.{}"'


@pytest.mark.parametrize(("first", "second", "says"), [
    (UDP.format("0.0.0.0:4700"), GROUP.format("239.77.0.1:4700", 1), "link.1 and link.0 "),
    (UDP.format("127.0.0.1:4700"), UDP.format("0.0.0.0:4700"), "both take UDP port 4700; give"),
    (UDP.format("127.0.0.1:4700"), UDP.format("127.0.0.1:4700"), "one of them another"),
    (UDP.format("127.0.0.1:4700"), UDP.format("127.0.0.2:4700"), ""),
    (UDP.format("127.0.0.1:4700"), GROUP.format("239.77.0.1:4700", 1), ""),
    (UDP.format("0.0.0.0:4700"), UDP.format("0.0.0.0:4702"), ""),
    (UDP.format("0.0.0.0:0"), UDP.format("0.0.0.0:0"), ""),
    (GROUP.format("239.77.0.1:4700", 1), GROUP.format("239.77.0.1:4700", 2), ""),
    (GROUP.format("239.77.0.1:4700", 1), GROUP.format("239.77.0.1:4700", 1), "both take"),
])  # fmt: skip
def test_two_links_that_would_take_the_same_port_are_named(tmp_path, first, second, says):
    head = 'kind = "mesh"\nnumber = 3\nnodes = 9\n'
    loaded = load(write(tmp_path, f"{head}[[link]]\n{first}\n[[link]]\n{second}\n"))
    if not says:
        assert len(build(loaded).paths) == 2
        return
    with pytest.raises(LiveError, match=says):
        build(loaded)
