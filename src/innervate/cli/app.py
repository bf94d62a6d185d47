"""The command `innervate`: which commands there are, and what is done when one fails."""

import io
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cyclopts import App, Parameter

import innervate
from innervate.cli import errors, examples
from innervate.cli.flowing import Flowing

HELP = """Describe and simulate the networks inside and between robots.

Start with: innervate demo. Where no loops came with the toolkit (see doctor), the first run
compiles for about half a minute."""
# By its words: the function in this room that is a command, loaded when it is asked for, and its
# help; that of its options stands below the function.
COMMANDS = {
    "demo": ("demo:demo", "The main jobs: a skin mends itself, radios get in order, an alarm gets "
             "through. With reports."),
    "run": ("running:run", "Run a scenario; writes a folder with summary, tables, provenance and "
            "report."),
    "sweep": ("sweeping:sweep", "Run a scenario for every combination of some settings, many times "
              "each.\n\nGive the same command again after an interrupt, a crash or with more "
              "values: what is done is\nnot done twice. The exit code is 1 if no run succeeded, or "
              "a figure could not be drawn."),
    "size": ("sizing:size", "Say how many interface ports a robot's skin needs, and where, by "
             "simulation.\n\nThe exit code is 1 if at some rate none of the numbers of ports that "
             "were tried is enough."),
    "papers": ("papers:papers", "Draw and tabulate the published figures, each claim beside what "
               "was measured."),
    "verify": ("verifying:verify", "Explore every interleaving of the protocol on small networks; "
               "1 if something is broken."),
    "prove": ("proving:prove", "Prove what holds for any number of nodes, from the protocol's own "
              "source; 1 if it does not."),
    "watch": ("watching:watch", "Serve a page to watch a network on and to break it, until "
              "Ctrl-C."),
    "firmware": ("firmware:firmware", "Write a node's protocol as C99 for a microcontroller: one "
                 ".c and one .h."),
    "scenarios": ("files:scenarios", "List the bundled scenarios, each with what it shows."),
    "new": ("files:new", "Write a commented scenario to start from, or a network of one's own."),
    "check": ("files:check", "Check a scenario without running it; says what it holds."),
    "check-protocol": ("making:check_protocol", "Check a network of your own: dialect, ranges, "
                       "frames, outbox, what no test reaches."),
    "schema": ("files:schema", "Print the JSON Schema of scenario files, for editors."),
    "docs": ("pages:show", "Print a page of the documentation, or the list of them."),
    "doctor": ("doctor:doctor", "Say what is installed, what is missing and what will be slow; 1 "
               "if nothing can be simulated."),
    "compare": ("comparing:compare", "Compare two run folders: scenario, summary, first event that "
                "differs.\n\nThe exit code is 0 if both were the same, event by event, and 1 if "
                "not."),
    "export": ("exporting:export", "Write a run or a scenario as files for other tools."),
    "fit": ("fitting:fit", "Make a scenario out of a capture of a mesh or a skin; 1 if its "
            "simulation has other links."),
    "live node": ("live:node", "Run one node until SIGTERM or Ctrl-C; SIGHUP reads its keys "
                  "again."),
    "live up": ("live:up", "Bring a scenario up, a process for every node, and play its events, "
                "until Ctrl-C."),
    "live status": ("live:show", "Show neighbours, routes, counters, broken cables of running "
                    "nodes."),
    "live send": ("live:send", "Send a message from a running node; prints what becomes of it."),
    "live command": ("live:command", "Have the PC of a skin send a command down to its cells, over "
                     "the children of every cell."),
    "live listen": ("live:listen", "Print what comes in at a running node, until Ctrl-C: messages, "
                    "samples, commands."),
    "live capture": ("capturing:capture", "Write frames of running nodes to a capture for "
                     "Wireshark, until Ctrl-C."),
    "live recovery": ("live_recovery:show", "Say how a skin healed, from a capture of all its "
                      "nodes: when routes and samples were back."),
    "live medium": ("live:medium", "Run a radio channel: stations whose files name its address "
                    "hear each other on it."),
    "live modem": ("live:modem", "Put a board at a serial line on a radio channel of `live "
                   "medium`, as one of its stations."),
    "live enrol": ("live_enrol:enrol", "Make an identity for each node of a network: one file for "
                   "each, which is all that it needs."),
    "live revoke": ("live_enrol:revoke", "Put nodes out whose identity has leaked; running nodes "
                    "are told and tell each other."),
    "live cut": ("live:change", "Cut a cable in silence at one end, as if its plug had come out; "
                 "or put it back."),
}  # fmt: skip


def _shown(default: Any) -> str | None:
    """A default as help names it; none that means that nothing was given."""
    return None if default in (None, "") else str(default)


def _made() -> App:
    """The command with all of its commands, none of them loaded."""
    made = App(
        name="innervate",
        help=HELP,
        help_format="plaintext",
        help_formatter=Flowing(),
        version=f"innervate {innervate.__version__}",
        version_flags=["--version"],
        suppress_keyboard_interrupt=False,
        result_action="return_value",
        default_parameter=Parameter(show_default=_shown),
    )
    live = App(name="live", help="Nodes between real processes: UDP, serial ports.",
               help_format="plaintext", help_epilogue=examples.text_of("live"))  # fmt: skip
    for words, (place, said) in COMMANDS.items():
        *above, name = words.split()
        home = live if above else made
        below = examples.text_of(words) if words in examples.BELOW else None
        home.command(f"{__package__}.{place}", name=name, help=said, help_epilogue=below)
    made.command(live)
    made.register_install_completion_command()
    return made


app = _made()


def main(tokens: Sequence[str] | None = None) -> int:
    """Carry out a command line; its exit code, see docs/commands.md."""
    if sys.stderr is None:  # closed: what would be said there is no part of the answer
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115
    for stream in (sys.stdout, sys.stderr):  # a terminal that is not UTF-8 gets escapes
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    try:
        code = _parse_and_run(list(sys.argv[1:] if tokens is None else tokens))
        if sys.stdout is not None:  # it may be closed
            sys.stdout.flush()
    except BaseException as error:
        return errors.conclude(error)
    return code


def _parse_and_run(tokens: list[str]) -> int:
    result: Any = app(_with_networks(tokens), exit_on_error=False, print_error=False, verbose=False)
    return result if isinstance(result, int) else 0


def _with_networks(tokens: list[str]) -> list[str]:
    """A command line without its --network DIR, whose network is known from now on.

    Of `new` it is a measured network, and stays.
    """
    from innervate.network import use

    left: list[str] = []
    while tokens:
        one, *tokens = tokens
        if left[:1] == ["new"] or (one != "--network" and not one.startswith("--network=")):
            left.append(one)
            continue
        _, _, given = one.partition("=")
        if not given and not tokens:
            raise errors.UserError("--network needs a folder; see: innervate docs own-network")
        if not given:
            given, *tokens = tokens
        use(Path(given))
    return left
