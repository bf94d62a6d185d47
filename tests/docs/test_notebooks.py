"""The notebooks: each is its script, runs, and shows what it shows; bars come and go."""

import json
import re
import threading

import nbformat
import pytest
from jupyter_client import KernelManager

from docs import notebooks

SCRIPTS = notebooks.scripts()
STEMS = [script.stem for script in SCRIPTS]
ASIDE = re.compile(r"\d+\.\d s\b|[ \t\n]+")  # how long it took


def kept(script):
    return nbformat.read(script.with_suffix(".ipynb"), as_version=4)


@pytest.fixture(scope="module")
def kernel():
    """One Jupyter for all of them: to load what they import takes most of their time."""
    manager = KernelManager(kernel_name="python3")
    manager.start_kernel()
    yield manager
    manager.shutdown_kernel(now=True)


def run_in_jupyter(kernel, *sources):
    """A notebook of these cells that was run."""
    cells = [nbformat.v4.new_code_cell(source) for source in sources]
    made = nbformat.v4.new_notebook(cells=cells, metadata=notebooks.KERNEL)
    notebooks.run_all(made, kernel)
    return made.cells


def test_there_are_five():
    assert STEMS == ["field", "own", "skin", "sweep", "team"]


@pytest.mark.parametrize("script", SCRIPTS, ids=STEMS)
def test_a_notebook_has_the_cells_of_its_script(script):
    found = [(cell.cell_type == "markdown", cell.source) for cell in kept(script).cells]
    assert found == notebooks.cells(script.read_text())
    assert not any(output.output_type == "error" for cell in kept(script).cells
                   for output in cell.get("outputs", ()))  # fmt: skip


def said(notebook):
    """What its cells print, without how long it took."""
    return [ASIDE.sub(" ", output.text) for cell in notebook.cells
            for output in cell.get("outputs", ()) if output.output_type == "stream"]  # fmt: skip


def shown(notebook):
    """For each cell the kinds of what it shows: text, pages, pictures."""
    return [[sorted(output.get("data", {})) for output in cell.get("outputs", ())]
            for cell in notebook.cells]  # fmt: skip


@pytest.mark.parametrize("script", SCRIPTS, ids=STEMS)
def test_the_notebook_runs_in_jupyter_and_shows_what_it_showed(script, tmp_path_factory, kernel):
    # Not tmp_path, which is gone with the test: what the kernel has started stays in its folder.
    fresh = notebooks.executed(script, tmp_path_factory.mktemp("notebook"), kernel)
    assert said(fresh) == said(kept(script))
    assert shown(fresh) == shown(kept(script))


def test_nothing_of_it_runs_on_here_once_it_was_run(kernel):
    """A heartbeat that is left polls a socket that the end of the kernel closes, and aborts."""
    run_in_jupyter(kernel, "pass")
    assert not [thread for thread in threading.enumerate() if "jupyter" in type(thread).__module__]


def test_a_bar_is_shown_while_work_goes_on_and_gone_afterwards(kernel):
    """In Jupyter itself: an output is replaced by a later one of the same display."""
    begun, ended, ran = run_in_jupyter(
        kernel,
        "from innervate.running.showing import Bar\n"
        "bar = Bar('counting').__enter__()\nbar.show('half of it', 1, 2)",
        "import json, innervate\nfrom innervate.running import showing\n"
        "showing.EVERY_S, told = 0.0, []\n"
        "showing.Bar.show = lambda bar, *so_far: told.append(so_far)\n"
        "run = innervate.run('line', overrides={'duration_s': 2.5}, plain=True)\n"
        "print(json.dumps([told[-1], told == sorted(told, key=lambda so_far: so_far[1])]))",
        "run",
    )
    (output,) = begun.outputs
    assert output.data["text/html"] == (
        '<progress value="0.5000"></progress> <small>half of it</small>'
    )
    gone, said = ended.outputs
    assert gone.data["text/html"] == ""
    (what, done, total), in_order = json.loads(said.text)
    assert what == f"simulated {done / 1e6:.2f} of 2.5 s"
    assert (0 < done <= total, total, in_order) == (True, 2_500_000, True)
    assert "Every cell has a way to the PC." in ran.outputs[0].data["text/html"]


def test_elsewhere_nothing_is_shown(capfd):
    from innervate.running.showing import Bar

    with Bar() as bar:
        assert bar.simulated is None
        bar.show("half of it", 1, 2)
    assert capfd.readouterr() == ("", "")
