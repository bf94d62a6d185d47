"""The networks inside and between robots, from one protocol source.

`innervate.run(scenario)` runs a scenario, given as a file, as a dictionary or built in code;
`innervate.sweep(scenario, vary=...)` runs it in many variants, many times;
`innervate.compare(a, b)` says what differs between two runs, and `innervate.size(question)` how
many cables a skin needs. `innervate.Network` describes a network of one's own, whose folder
`innervate.use(folder)` makes known; `innervate.explore(network)` explores it.
The simulator behind them is loaded at the first use, so that `import innervate` stays cheap.
"""

TYPE_CHECKING = False  # `typing` would be the slowest part of this import
if TYPE_CHECKING:
    from innervate.live.errors import LiveError as LiveError
    from innervate.live.in_code import Nodes as Nodes
    from innervate.live.in_code import live_up as live_up
    from innervate.network import Network as Network
    from innervate.network import NetworkError as NetworkError
    from innervate.network import use as use
    from innervate.networks.models import Mesh as Mesh
    from innervate.networks.models import Radio as Radio
    from innervate.networks.models import Skin as Skin
    from innervate.networks.typed import Answer as Answer
    from innervate.networks.typed import Question as Question
    from innervate.networks.typed import size as size
    from innervate.running.compare import Comparison as Comparison
    from innervate.running.compare import compare as compare
    from innervate.running.errors import RunError as RunError
    from innervate.running.exploring import explore as explore
    from innervate.running.run import Run as Run
    from innervate.running.run import run as run
    from innervate.scenario import Scenario as Scenario
    from innervate.scenario import ScenarioError as ScenarioError
    from innervate.scenario.declared.cables import CablesScenario as CablesScenario
    from innervate.scenario.declared.channel import ChannelScenario as ChannelScenario
    from innervate.scenario.declared.field import FieldScenario as FieldScenario
    from innervate.scenario.given import check as check
    from innervate.scenario.given import dump as dump
    from innervate.scenario.given import load as load
    from innervate.sim.driver import InvariantBroken as InvariantBroken
    from innervate.sweeping.errors import SweepError as SweepError
    from innervate.sweeping.result import Sweep as Sweep
    from innervate.sweeping.sweep import load_sweep as load_sweep
    from innervate.sweeping.sweep import sweep as sweep
    from innervate.verify.cases import Case as Case
    from innervate.verify.errors import VerifyError as VerifyError

__version__ = "0.1.0"

# Which names come from where; the lines above say the same to type checkers.
_NAMES = {
    "live.errors": "LiveError",
    "live.in_code": "Nodes live_up",
    "network": "Network NetworkError use",
    "networks.models": "Mesh Radio Skin",
    "networks.typed": "Answer Question size",
    "running.compare": "Comparison compare",
    "running.errors": "RunError",
    "running.exploring": "explore",
    "running.run": "Run run",
    "scenario": "Scenario ScenarioError",
    "scenario.declared.cables": "CablesScenario",
    "scenario.declared.channel": "ChannelScenario",
    "scenario.declared.field": "FieldScenario",
    "scenario.given": "check dump load",
    "sim.driver": "InvariantBroken",
    "sweeping.errors": "SweepError",
    "sweeping.result": "Sweep",
    "sweeping.sweep": "load_sweep sweep",
    "verify.cases": "Case",
    "verify.errors": "VerifyError",
}
_PLACES = {name: place for place, names in _NAMES.items() for name in names.split()}
__all__ = ["__version__", *sorted(_PLACES)]


if not TYPE_CHECKING:  # or every name would do, misspelt ones too

    def __getattr__(name: str) -> object:
        """Load what stands behind a name when it is first asked for."""
        if name not in _PLACES:
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        from importlib import import_module

        found = getattr(import_module(f"{__name__}.{_PLACES[name]}"), name)
        globals()[name] = found
        return found


def __dir__() -> list[str]:
    """Every name, loaded or not."""
    return sorted({*globals(), *__all__})
