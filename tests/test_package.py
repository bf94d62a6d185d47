"""What `import innervate` offers: real functions, listed, documented, typed, loaded when asked."""

import inspect
import pydoc
import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import pytest

import innervate

ROOT = Path(__file__).parents[1]
FUNCTIONS = (
    "check", "compare", "dump", "live_up", "load", "load_sweep", "run", "size", "sweep",
)  # fmt: skip
USER_SCRIPT = '''
"""What somebody may write who has only the documentation."""

import innervate


def main() -> None:
    scenario = innervate.load("setup-1", seed=3, overrides={"protocol.k": 3})
    print(innervate.check(scenario))
    run: innervate.Run = innervate.run(scenario, overrides=["duration_s=1"])
    run.write("runs/a")
    first = run.skin["recoveries"][0]
    late: float | None = first["routed_ms"]
    print(late, run.skin["data"]["lost_by"]["cut"] + 1, run.tables["routes"].collect())
    summary = run.summary
    if summary["kind"] == "mesh":
        ratio: float | None = summary["delivery_ratio"]
        print(ratio, run.interrupted)
    found: innervate.Comparison = innervate.compare("runs/a", "runs/b")
    print(found.same, len(found.notes))
    done: innervate.Sweep = innervate.sweep("setup-1", vary={"protocol.k": "2..4"}, repeat=2)
    done.compare("protocol.k", 2, 3, "recoveries.routed_ms")
    asked = innervate.Question("robot.urdf", "*", ports=(1, 2))
    print(innervate.size(asked, repeat=2).needed[250.0], innervate.__version__)


def in_code() -> None:
    skin = innervate.Skin(
        patch=[innervate.Skin.Patch(columns=4, rows=3)],
        interface=[innervate.Skin.Interface(row=0, column=0)],
        protocol=innervate.Skin.Protocol(k=3),
        event=[innervate.Skin.Event(at_s=2.0, action="cut", interface=0)],
    )
    team = innervate.Radio(stations=5, traffic=innervate.Radio.Traffic(kind="saturated"))
    field = innervate.Mesh(nodes=9, flow=[innervate.Mesh.Flow(from_=1, to="gateway", every_s=1.0)])
    text: str = "".join(innervate.dump(one) for one in (skin, team, field))
    print(text, innervate.run(skin).numpy("routes")["cell"].max())
    done: innervate.Sweep = innervate.sweep(skin, vary={"protocol.k": [2, 3]}, workers=1)
    cases: list[innervate.Case] = innervate.explore("skin", graph="triangle", states=100)
    with innervate.live_up(skin, cables="pty") as nodes:
        nodes.cut(*nodes.cables[0])
        print(done.pandas(), cases[0].is_broken, nodes.status()[nodes.names[0]])
'''
MISTAKES = {
    "innervate.rnu('a.toml')": 'Module has no attribute "rnu"',
    "innervate.run()": 'Missing positional argument "scenario"',
    "innervate.run('a.toml', seed='x')": 'incompatible type "str"',
    "innervate.run('a.toml').sumary": '"Run" has no attribute "sumary"',
    "innervate.compare('a')": "Missing positional argument",
    "innervate.run('a.toml').skin['cels']": 'has no key "cels"',
    "innervate.run('a.toml').mesh['nodes'] + 'x'": "Unsupported operand types",
    "innervate.Skin.Patch(colums=3, rows=2)": 'Unexpected keyword argument "colums"',
    "innervate.Radio(stations='ten')": 'incompatible type "str"',
    "innervate.explore('skin', grahp='x')": 'Unexpected keyword argument "grahp"',
    "innervate.live_up('line', cables='tcp')": "incompatible type",
}


@pytest.fixture(scope="module")
def type_checked(tmp_path_factory):
    """What mypy --strict says of a user's scripts, outside this repository: by script, its lines.

    One run for all of them: it takes a second to read what the scripts import.
    """
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.DOTALL)
    mistakes = "import innervate\n" + "\n".join(MISTAKES)
    scripts = {"script": USER_SCRIPT, "mistakes": mistakes,
               **{f"readme_{number}": block for number, block in enumerate(blocks)}}  # fmt: skip
    folder = tmp_path_factory.mktemp("scripts")
    for name, text in scripts.items():
        (folder / f"{name}.py").write_text(text)
    cache = ROOT / ".mypy_cache" / "scripts"
    names = [f"{name}.py" for name in scripts]
    command = [sys.executable, "-m", "mypy", "--strict", "--cache-dir", cache, *names]
    done = subprocess.run(
        command, cwd=folder, capture_output=True, text=True, timeout=300, check=False
    )
    assert done.returncode == 1, done.stdout + done.stderr
    *lines, last = done.stdout.splitlines()
    assert last.endswith(f" (checked {len(scripts)} source files)"), done.stdout
    return {name: [line for line in lines if line.startswith(f"{name}.py:")] for name in scripts}


def test_a_users_script_passes_mypy_strict(type_checked):
    assert type_checked["script"] == []


def test_a_users_mistakes_are_named_where_they_are(type_checked):
    for line, mistake in enumerate(MISTAKES.values(), 2):
        assert any(
            text.startswith(f"mistakes.py:{line}: error:") and mistake in text
            for text in type_checked["mistakes"]
        ), (line, type_checked["mistakes"])


def test_the_readmes_examples_pass_mypy_strict(type_checked):
    found = [lines for name, lines in type_checked.items() if name.startswith("readme_")]
    assert found
    assert not any(found)


@pytest.mark.parametrize("name", FUNCTIONS)
def test_what_can_be_called_is_a_function_that_says_how(name):
    found = getattr(innervate, name)
    assert inspect.isfunction(found)
    assert found.__name__ == name
    said = inspect.signature(found)
    assert said.parameters
    assert not [one for one in said.parameters.values() if one.kind is one.VAR_KEYWORD]
    assert said.return_annotation is not inspect.Signature.empty
    page = re.sub(
        r"\(\s+", "(", pydoc.plain(pydoc.render_doc(innervate))
    )  # 3.13 breaks lines there
    assert f"{name}({next(iter(said.parameters))}" in page


def test_every_name_is_listed_and_there():
    assert set(innervate.__all__) <= set(dir(innervate))
    for name in innervate.__all__:
        assert getattr(innervate, name) is getattr(innervate, name), name
    assert set(FUNCTIONS) <= set(innervate.__all__)


def test_names_are_listed_before_the_simulator_is_loaded():
    code = (
        "import sys, innervate\n"
        "assert 'run' in dir(innervate) and 'sweep' in dir(innervate)\n"
        "innervate.check, innervate.load('setup-1'), innervate.ScenarioError\n"
        "heavy = {'numpy', 'numba', 'polars', 'matplotlib', 'trimesh'} & set(sys.modules)\n"
        "assert not heavy, heavy\n"
        "import innervate.running, innervate.sweeping\n"
        "assert innervate.run is innervate.running.run\n"
        "assert innervate.sweep is innervate.sweeping.sweep\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr


def test_import_alone_loads_nothing():
    code = "import sys; old = set(sys.modules); import innervate; print(*set(sys.modules) - old)"
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=60, check=True
    )
    assert set(done.stdout.split()) == {"innervate"}


def test_unknown_attribute_of_the_package():
    assert inspect.isfunction(vars(innervate)["__getattr__"])  # nothing is loaded before
    with pytest.raises(AttributeError, match="walk"):
        innervate.walk  # noqa: B018


def test_the_changelog_has_a_part_for_this_version():
    parts = re.findall(r"^## (.+)$", (ROOT / "CHANGELOG.md").read_text("utf-8"), re.MULTILINE)
    assert parts[:2] == ["Unreleased", innervate.__version__]


def test_version_is_the_distributions():
    assert version("innervate") == innervate.__version__
