import json
import os
import signal
import subprocess
import sys

import pytest

HEAVY = ("numba", "llvmlite", "numpy", "polars", "matplotlib")
TIMEOUT_S = 120


# How long it takes stands in the benchmarks.
def test_help_is_light(process):
    code = (
        "import sys; from innervate.cli import main; main(['--help']); main(['run', '--help']);"
        f"print([m for m in {HEAVY} if m in sys.modules], file=sys.stderr)"
    )
    out, err = process(code=code).communicate(timeout=TIMEOUT_S)
    assert "Usage: innervate" in out
    assert err.strip() == "[]"


def test_commands_that_do_not_simulate_stay_light(process, tmp_path):
    code = (
        "import sys; from innervate.cli import main;"
        "main(['check', 'demo']); main(['scenarios']); main(['new', 'skin']); main(['runn']);"
        f"print([m for m in {HEAVY} if m in sys.modules])"
    )
    out, _ = process(code=code, cwd=tmp_path).communicate(timeout=TIMEOUT_S)
    assert out.splitlines()[-1] == "[]"


@pytest.mark.parametrize("words", [("scenarios",), ("--help",), ("live", "--help")])
def test_a_closed_pipe_is_no_error(process, tmp_path, words):
    started = process(*words, cwd=tmp_path)
    started.stdout.close()
    assert "Traceback" not in started.stderr.read()
    assert started.wait(timeout=TIMEOUT_S) in (0, 141)
    started.stderr.close()


def test_with_standard_output_closed_nothing_is_wrong(tmp_path):
    command = ["bash", "-c", "exec >&-; exec $0 -m innervate.cli docs scenarios", sys.executable]
    done = subprocess.run(
        command, cwd=tmp_path, text=True, stderr=subprocess.PIPE, timeout=TIMEOUT_S
    )
    assert (done.returncode, done.stderr) == (0, "")


def test_with_standard_error_closed_the_answer_is_the_same(tmp_path):
    command = ["bash", "-c", "exec 2>&-; exec $0 -m innervate.cli run line --json --no-report"]
    done = subprocess.run(
        [*command, sys.executable], cwd=tmp_path, text=True, stdout=subprocess.PIPE,
        timeout=TIMEOUT_S,
    )  # fmt: skip
    assert done.returncode == 0, done.stdout
    assert json.loads(done.stdout)["headline"]["level"] == "ok"


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="no device that is always full")
@pytest.mark.parametrize(
    ("stream", "word", "ends", "says"),
    [(1, "scenarios", 1, "No space left on device"), (2, "runn", 2, "")],
)
def test_a_full_disk_is_one_line_and_a_mistake_stays_one(process, stream, word, ends, says):
    code = (
        f"import os, sys; full = os.open('/dev/full', os.O_WRONLY); os.dup2(full, {stream});"
        f"from innervate.cli import main; sys.exit(main([{word!r}]))"
    )
    started = process(code=code)
    _, err = started.communicate(timeout=TIMEOUT_S)
    assert started.returncode == ends
    assert says in err
    assert "Traceback" not in err


def test_without_the_simulator_it_says_what_to_install(process, tmp_path):
    code = (
        "import sys; sys.modules.update(dict.fromkeys(['numba', 'numpy', 'polars']));"
        "from innervate.cli import main; sys.exit(main(['run', 'setup-1']))"
    )
    started = process(code=code, cwd=tmp_path)
    out, err = started.communicate(timeout=TIMEOUT_S)
    assert (started.returncode, out) == (2, "")
    assert err.count("\n") == 1
    assert "install it with: pip install 'innervate[sim]'" in err
    assert list(tmp_path.iterdir()) == []


def test_the_first_run_says_that_it_compiles(process, tmp_path):
    code = (
        "from innervate.cli.progress import *\n"
        "with Progress('mesh-32') as p: p(0, 1)\n"
        "with Progress('skin', quiet=True) as p: p(0, 1)\n"
    )
    out, err = process(code=code, cwd=tmp_path).communicate(timeout=TIMEOUT_S)
    assert (out, err.count("compiling"), err.count("\n")) == ("", 1, 1)
    assert "compiling the simulation (mesh-32), once on this machine: about half a minute" in err


@pytest.mark.skipif(os.name == "nt", reason="signals as on POSIX")
def test_ctrl_c_keeps_what_is_done(process, tmp_path):
    code = (
        "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler);"
        "from innervate.cli import progress, main\n"
        "def tell(self, now, end, first=[]):\n"
        "    first or print('go', file=sys.stderr, flush=True)\n"
        "    first.append(now)\n"
        "progress.Progress.__call__ = tell\n"
        "sys.exit(main(['run', 'setup-1', '--set', 'duration_s=100000', '--json']))"
    )
    started = process(code=code, cwd=tmp_path)
    while started.stderr.readline().strip() != "go":
        assert started.poll() is None
    started.send_signal(signal.SIGINT)
    out, err = started.communicate(timeout=TIMEOUT_S)
    assert started.returncode == 130, err
    assert '"interrupted_at_s"' in out
    assert (tmp_path / "runs" / "setup-1-1" / "report.html").exists()


@pytest.mark.skipif(os.name == "nt", reason="signals as on POSIX")
def test_ctrl_c_while_commands_load_is_one_line(process):
    code = (
        "import builtins, os, signal, sys\n"
        "signal.signal(signal.SIGINT, signal.default_int_handler)\n"
        "real = builtins.__import__\n"
        "def slow(name, *rest):\n"
        "    if name == 'cyclopts': os.kill(os.getpid(), signal.SIGINT)\n"
        "    return real(name, *rest)\n"
        "builtins.__import__ = slow\n"
        "from innervate.cli import main; sys.exit(main(['--help']))"
    )
    started = process(code=code)
    assert started.communicate(timeout=TIMEOUT_S) == ("", "innervate: interrupted\n")
    assert started.returncode == 130
