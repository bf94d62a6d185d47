"""What stands below the help of each command: examples, and the page that says more."""

# Command: its page of `innervate docs`, and examples, each of which a test parses.
BELOW: dict[str, tuple[str, tuple[str, ...]]] = {
    "demo": ("tutorial", ("innervate demo --open",)),
    "run": ("scenarios", (
        "innervate run demo",
        "innervate run my-skin.toml --set protocol.k=3 --seed 2 --out other",
        "innervate run mesh-field --json",
    )),
    "sweep": ("sweeps", (
        "innervate sweep my-skin.toml --vary protocol.k=2..8 --repeat 30",
        "innervate sweep demo --vary protocol.k=2..8 --until recoveries.routed_ms.ci=5%",
    )),
    "size": ("sweeps", ("innervate size ur5.urdf --links '*arm_link' --pitch 40 --rate 250",)),
    "papers": ("readings", ("innervate papers radio --quick", "innervate papers --only fig8a")),
    "verify": ("verify", (
        "innervate verify",
        "innervate verify --graph triangle --rule paper --out found",
        "innervate verify mesh",
    )),
    "prove": ("prove", ("innervate prove", "innervate prove mesh")),
    "watch": ("watch", (
        "innervate watch demo",
        "innervate watch runs/demo-1",
        "innervate watch live",
    )),
    "firmware": ("firmware", ("innervate firmware skin beacon_us=20000 --out lib",)),
    "new": ("own-network", (
        "innervate new skin my-skin.toml",
        "innervate new mesh mine.toml --network links.txt",
        "innervate new network ring",
    )),
    "check": ("scenarios", ("innervate check my-skin.toml",)),
    "check-protocol": ("own-network", ("innervate check-protocol ring",)),
    "schema": ("scenarios", ("innervate schema --out scenario.schema.json",)),
    "compare": ("reading-a-report", ("innervate compare runs/demo-1 other",)),
    "export": ("export", (
        "innervate export r1 --pcapng r1.pcapng --mcap r1.mcap",
        "innervate export mesh-field --graph field.graphml",
        "innervate export --dissector",
    )),
    "fit": ("export", ("innervate fit live.pcapng --out like-it.toml",)),
    "docs": ("index", ("innervate docs", "innervate docs sweeps")),
    "live": ("live", ()),
    "live up": ("live", ("innervate live up line", "innervate live up my-skin.toml --for 30")),
    "live node": ("live", ("innervate live node n3.toml",)),
    "live status": ("live", ("innervate live status", "innervate live status n3 --json")),
    "live send": ("live", ('innervate live send n0 3 "hello"',)),
    "live listen": ("live", ("innervate live listen n3",)),
    "live capture": ("export", ("innervate live capture --out live.pcapng",)),
    "live enrol": ("threats", ("innervate live enrol keys --nodes 9",)),
    "live revoke": ("threats", ("innervate live revoke keys 3",)),
}  # fmt: skip


def text_of(words: str) -> str:
    """What stands below the help of a command."""
    page, examples = BELOW[words]
    told = ["For example:", *(f"  {line}" for line in examples)] if examples else []
    return "\n".join([*told, f"More: innervate docs {page}"])
