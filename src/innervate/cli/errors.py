"""What a failure is to the user: one line that says what to change, and an exit code."""

import contextlib
import os
import sys
from typing import Any

USERS = 2
OURS = 1
INTERRUPTED = 130
PIPE_CLOSED = 141

# Which extra brings a module that is not there.
EXTRA_OF = {
    "numba": "sim", "llvmlite": "sim", "numpy": "sim", "polars": "sim",
    "matplotlib": "plot",
    "starlette": "web", "uvicorn": "web", "websockets": "web",
    "cryptography": "live",
    "distributed": "sweep",
    "mcap": "export",
    "z3": "prove",
    "collada": "body", "icub_models": "body", "trimesh": "body",
    "topohub": "topohub",
    "rerun": "rerun",
}  # fmt: skip
# Mistakes of the user, whose text is one line already: module and class.
_MISTAKES = (
    ("innervate.scenario.errors", "ScenarioError"),
    ("innervate.running.errors", "RunError"),
    ("innervate.verify.errors", "VerifyError"),
    ("innervate.prove.errors", "ProveError"),
    ("innervate.sweeping.errors", "SweepError"),
    ("innervate.live.errors", "LiveError"),
    ("innervate.firmware.errors", "FirmwareError"),
    ("innervate.network", "NetworkError"),
    ("innervate.web.errors", "WatchError"),
    ("innervate.export.errors", "ExportError"),
    ("cyclopts", "CycloptsError"),
)


class UserError(Exception):
    """A mistake of the user, in one line that says what to change."""


def conclude(error: BaseException) -> int:
    """Tell the user about an error; the exit code."""
    if isinstance(error, SystemExit):
        code = error.code or 0
        if isinstance(error.__context__, BrokenPipeError):  # what lays help out ends so
            return PIPE_CLOSED
        return code if isinstance(code, int) else OURS
    if isinstance(error, BrokenPipeError):
        _drop_stdout()
        return PIPE_CLOSED
    if os.environ.get("INNERVATE_TRACEBACK", "") not in ("", "0"):
        import traceback

        traceback.print_exception(error)
    if isinstance(error, KeyboardInterrupt):
        say(str(error) or "interrupted")
        return INTERRUPTED
    text, code = explain(error)
    say(text)
    return code


def explain(error: BaseException) -> tuple[str, int]:
    """An error in one line, and the exit code for it."""
    if isinstance(error, UserError):
        return str(error), USERS
    if isinstance(error, ModuleNotFoundError) and _extra_of(error) is not None:
        name = (error.name or "").partition(".")[0]
        return f"this needs {name}; install it with: pip install '{_extra_of(error)}'", USERS
    if type(error).__name__ == "MissingArgumentError":
        return _missing(error), USERS
    if type(error).__name__ == "CoercionError" and (number := _number(error)):
        given = error.token  # type: ignore[attr-defined]
        name = given.keyword or error.argument.name  # type: ignore[attr-defined]
        return f'{name} must be a {number}, not "{_one_line(given.value[:40])}"', USERS
    if type(error).__name__ == "UnusedCliTokensError":
        words = " ".join(getattr(error, "unused_tokens", None) or ())
        command = " ".join(getattr(error, "command_chain", None) or ())
        return f'"{_one_line(words)}" is too much; see: innervate {command} --help', USERS
    if any(_is(error, *mistake) for mistake in _MISTAKES):
        return _one_line(str(error)), USERS
    if _is(error, "innervate.sim.driver", "InvariantBroken"):
        is_foreseen = getattr(error, "is_foreseen", False)
        hint = "" if is_foreseen else "; please report it with the scenario"
        return _one_line(str(error)) + hint, OURS
    if isinstance(error, MemoryError):
        return "not enough memory; make the scenario smaller or shorter", OURS
    if isinstance(error, OSError) and error.strerror:
        if error.filename is None and _is_lost():
            return "the current folder is not there any more; change to one that is", USERS
        where = f"{error.filename}: " if error.filename else ""
        return f"{where}{error.strerror}", OURS
    what = f"{type(error).__name__}: {_one_line(str(error))}"
    return f"internal error, {what} (INNERVATE_TRACEBACK=1 shows where)", OURS


def _is(error: BaseException, module: str, name: str) -> bool:
    """Whether an error is of this class; of a module that is not loaded none is."""
    kind: Any = getattr(sys.modules.get(module), name, None)
    return kind is not None and isinstance(error, kind)


def say(text: str) -> None:
    """One line on standard error."""
    with contextlib.suppress(OSError, ValueError):  # perhaps nobody is listening any more
        print(f"innervate: {text}", file=sys.stderr, flush=True)


def check_seconds(option: str, value: float) -> None:
    """Refuse what is no time to wait.

    Raises:
        UserError: negative, or no number.
    """
    if not 0 <= value < float("inf"):
        raise UserError(f"{option} must be a number of seconds from 0, not {value:g}")


def _missing(error: Any) -> str:
    """An argument that was left out."""
    command = " ".join(error.command_chain or ())
    name = error.argument.name if error.argument is not None else "an argument"
    what = f"{error.keyword} needs a value" if error.keyword else f"{command} needs {name}"
    return f"{what}; see: innervate {command} --help"


def _number(error: Any) -> str:
    """What kind of number was asked for, where one was."""
    return {int: "whole number", float: "number"}.get(error.target_type, "") if error.token else ""


def _is_lost() -> bool:
    """True if somebody took the folder away in which we run."""
    try:
        os.getcwd()
    except OSError:
        return True
    return False


def _extra_of(error: ModuleNotFoundError) -> str | None:
    extra = EXTRA_OF.get((error.name or "").partition(".")[0])
    return None if extra is None else f"innervate[{extra}]"


def _one_line(text: str) -> str:
    """The text in one line; what a terminal would not print is escaped."""
    words = " ".join(text.split())
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in words)


def _drop_stdout() -> None:
    """Nobody reads standard output any more: what is still in it goes nowhere."""
    with contextlib.suppress(OSError, ValueError):
        devnull = os.open(os.devnull, os.O_WRONLY)
        os.dup2(devnull, sys.stdout.fileno())
        os.close(devnull)
