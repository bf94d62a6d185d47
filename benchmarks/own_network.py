"""The same protocols built in and loaded from a copied folder, taken in turns in one process.

`python -m benchmarks.own_network`: ratios of simulated time per processor time, folder to built in.
"""

import os
import re
import shutil
import statistics
import tempfile
import time
from pathlib import Path

import innervate
import innervate.scenario
from innervate.network import networks, use

ROUNDS = 7
ROOT = Path(__file__).resolve().parents[1]
NETWORKS = ROOT / "src/innervate/networks"
FLOODING = ROOT / "examples/field/flooding.toml"
RING = ROOT / "tests/networks/tokenring"
CASES = {
    "token ring": {"kind": "tokenring", "nodes": 64, "duration_s": 150.0, "hold_us": 20,
                   "lost_us": 10_000_000},
    "skin": ("setup-5", ["duration_s=20", "event=[]"]),
    "flooding, over a field": ["nodes=100", "duration_s=300", "event=[]"],
}  # fmt: skip


def copied(name, folder):
    """A network's folder under another name, which is all that is changed in it."""
    shutil.copytree(NETWORKS / name, folder, ignore=shutil.ignore_patterns("__pycache__"))
    for path in folder.rglob("*.py"):
        text = path.read_text().replace(f"innervate.networks.{name}", folder.name)
        text = re.sub(rf'Literal\["{name}"\]', f'Literal["{folder.name}"]', text)
        text = text.replace(
            f'    "{name}",\n    __package__', f'    "{folder.name}",\n    __package__'
        )
        text = re.sub(rf'kind="{name}"', f'kind="{folder.name}"', text)
        path.write_text(text)
    return folder


def spent(simulate, *given, **kept):
    """Processor seconds of a run, and its fingerprint."""
    begun = time.process_time()
    result = simulate(*given, **kept)
    return time.process_time() - begun, result.fingerprint


def rings(place):
    """Runs of the ring: as if it were installed, and from a folder."""
    folder = shutil.copytree(RING, place / "tokenring")
    from_folder = use(folder)
    installed = innervate.Network(**{
        "name": "tokenring", "package": "tokenring", "rank": 9,
        **{part: where.removeprefix("tokenring.") for part, where in from_folder.parts.items()
           if part in ("model", "check", "plan", "protocol", "fields", "frames")},
    })  # fmt: skip
    known = networks()

    def run(network):
        known["tokenring"] = network
        tables = CASES["token ring"]
        scenario = innervate.Scenario(network.model(**tables))
        return spent(network.run.simulate, network.plan(scenario), checks=False)

    return (lambda: run(installed)), (lambda: run(from_folder))


def skins(place):
    """Runs of the skin: ours, and a copied folder."""
    name, changes = CASES["skin"]
    use(copied("skin", place / "bodily"))

    def run(kind):
        text = innervate.scenario.bundled()[name].read_text()
        scenario = innervate.scenario.loads(text.replace('"skin"', f'"{kind}"'), changes)
        made = networks()[kind]
        return spent(made.run.simulate, made.plan(scenario), checks=False, plain=False,
                     received=False, progress=None)  # fmt: skip

    return (lambda: run("skin")), (lambda: run("bodily"))


def floods(place):
    """Runs of managed flooding over a field: ours, and a copied folder."""
    use(copied("flooding", place / "flooded"))

    def run(kind):
        text = FLOODING.read_text().replace('"flooding"', f'"{kind}"')
        scenario = innervate.scenario.loads(text, CASES["flooding, over a field"])
        made = networks()[kind]
        return spent(made.run.simulate, made.plan(scenario), checks=False)

    return (lambda: run("flooding")), (lambda: run("flooded"))


def measured(built_in, own):
    """The ratio of speeds, own to built in: of medians, taken in turns."""
    assert built_in()[1] == own()[1]  # compiles both; and they do the same
    times = {built_in: [], own: []}
    for turn in range(ROUNDS):
        for run in (built_in, own) if turn % 2 else (own, built_in):
            times[run].append(run()[0])
    ours, its = (statistics.median(times[one]) for one in (built_in, own))
    return {"built_in_s": ours, "folder_s": its, "ratio": ours / its}


def measure():
    """Figures of the cases, by name."""
    before = os.environ.get("INNERVATE_NETWORKS", "")
    try:
        with tempfile.TemporaryDirectory() as place:
            runs = zip(CASES, (rings, skins, floods), strict=True)
            return {name: measured(*made(Path(place))) for name, made in runs}
    finally:
        os.environ["INNERVATE_NETWORKS"] = before
        networks.cache_clear()


def told():
    """The figures, and a line of each."""
    found = measure()
    for case, figures in found.items():
        print(f"{case}: built in {figures['built_in_s']:.3f} s, from a folder "
              f"{figures['folder_s']:.3f} s: {figures['ratio']:.3f} of its speed")  # fmt: skip
    return found


if __name__ == "__main__":
    told()
