"""Parameters of a live skin; whole numbers."""

from innervate.live.parameters import check_parameters
from innervate.networks.skin.protocol.constants import RULE_FEASIBLE, WAVE
from innervate.networks.skin.protocol.fields import PARAMS

# A skin at 50 Hz; a port is broken after five silent periods [skin 5].
SKIN: dict[str, int] = {
    "rule": RULE_FEASIBLE, "updates": WAVE, "beacon_us": 20_000, "r_f": 168, "r_r": 168, "k": 5,
    "max_depth": 64, "seq_every": 5, "balance_periods": 64, "balance_rule": 0,
    "hold_periods": 133, "gap_us": 500, "skip_us": 12_000, "restart_us": 0, "forward_min_us": 0,
    "forward_max_us": 0,
}  # fmt: skip


def skin_parameters(changes: dict[str, int], where: str = "") -> dict[str, int]:
    """The skin's parameters, with what is to be different, as `check_parameters` allows it."""
    check_parameters(changes, PARAMS, where)
    return {**SKIN, **changes}
