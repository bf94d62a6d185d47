"""A radio scenario in a few lines, without running it."""

from innervate.kernel.words import number_of, some
from innervate.networks.radio.scenario import slotted as radio_slotted
from innervate.networks.radio.scenario.model import RadioScenario
from innervate.networks.radio.scenario.plan import RadioFault, RadioPlan
from innervate.networks.radio.scenario.rules import outside, pair
from innervate.networks.radio.scenario.unused import unused
from innervate.scenario.events import told

PAIRS_SHOWN = 4

UNFIT = "a radio team has one channel and no links to fit"


def describe(made: RadioPlan) -> str:
    """A plan in words, several lines, without a newline at the end."""
    model: RadioScenario = made.scenario.model
    channel, protocol = _used(made)
    lines = [
        f"{made.scenario.name}: a radio scenario of at most {made.duration_us / 1e6:g} s, "
        f"seed {made.seed}",
        f"  stations   {made.stations}, packets of {_range(*pair(model.packet_slots), 'slots')}",
        f"  traffic    {traffic_words(model)}",
        f"  channel    {channel}",
        f"  protocol   {protocol}",
    ]
    return "\n".join([*lines, *told(made, fault_words, warnings(made))])


def _used(made: RadioPlan) -> tuple[str, str]:
    """Channel and protocol: what a run uses of them."""
    model: RadioScenario = made.scenario.model
    slot_us = made.params["slot_us"]
    if model.channel.level == "slotted":
        return radio_slotted.words(model, slot_us)
    channel = (
        f"event level, {model.channel.bit_rate:,} bit/s, a slot of {slot_us} us, "
        f"delays of {_range(*pair(model.channel.tau_us), 'us')}, "
        f"turnaround {made.params['ta_us'] / 1000:g} ms"
    )
    return channel, ", ".join([made.protocol, *told_words(model)])


def told_words(model: RadioScenario) -> list[str]:
    """What a DCF, or whoever is set to it, takes for received; other baselines are told alike."""
    protocol, found = model.protocol, []
    if protocol.mac == "dcf" or protocol.received_by != "anybody":
        found.append(f"a packet counts as received once {protocol.received_by} has it")
    if protocol.mac == "dcf":
        how = {"instant": "without a turnaround", "turnaround": "a turnaround there and back"}
        found.append(f"time for its answers: {how[protocol.answers]}")
    return found


def warnings(made: RadioPlan) -> list[str]:
    """What of a plan lies outside the assumptions of all protocols, a sentence each."""
    found = []
    if made.stations == 1:
        found.append("One station alone: nobody can receive what it sends.")
    if outside(made.scenario.model):
        model: RadioScenario = made.scenario.model
        assert model.protocol.tau_bounds_us is not None
        found.append(
            f"Delays of {_range(*pair(model.channel.tau_us), 'us')} lie outside the "
            f"{_range(*model.protocol.tau_bounds_us, 'us')} that stations believe; set "
            "protocol.tau_bounds_us to what is true."
        )
    found += _too_much(made) + _for_nothing(made)
    hidden = [f"{i} and {j}" for i, j in made.pairs.hidden]
    if hidden:
        named = ", ".join(hidden[:PAIRS_SHOWN]) + (", ..." if len(hidden) > PAIRS_SHOWN else "")
        found.append(
            f"Stations that do not hear each other ({named}): packets may collide unnoticed, "
            "stations may starve."
        )
    return found


def _for_nothing(made: RadioPlan) -> list[str]:
    """Settings that are given and not used; the slotted level refuses its own."""
    model: RadioScenario = made.scenario.model
    names = unused(model) if model.channel.level == "event" else []
    if not names:
        return []
    are = "is" if len(names) == 1 else "are"
    who = f"{made.protocol} with {model.traffic.kind} traffic"
    return [f"{some(names)} {are} set and not used by {who}."]


def _too_much(made: RadioPlan) -> list[str]:
    """Packets that no protocol could deliver."""
    model: RadioScenario = made.scenario.model
    traffic, channel = model.traffic, model.channel
    if channel.loss == 1:
        return ["Nobody can read any frame: channel.loss is 1."]
    if traffic.kind == "poisson" and traffic.load > 1:
        return [
            f"Stations offer {traffic.load:g} times what the channel carries at most: packets "
            "wait ever longer, or find a full queue."
        ]
    least_us = made.stations * pair(model.packet_slots)[0] * made.params["slot_us"]
    room_us = made.duration_us - round(1e6 * traffic.start_s)
    if traffic.kind == "disaster" and channel.level == "event" and least_us > room_us:
        return [
            f"The packets alone take {least_us / 1e6:.3g} s, and the run ends "
            f"{room_us / 1e6:.3g} s after the start: not all can be delivered; raise duration_s."
        ]
    return []


def traffic_words(model: RadioScenario) -> str:
    """What stations send, and when."""
    traffic = model.traffic
    if traffic.kind == "saturated":
        return f"saturated, {number_of(traffic.packets, 'packet')} per station"
    if traffic.kind == "poisson":
        return f"Poisson, {traffic.load:g} packets per packet time of all stations"
    spread = f" within {traffic.spread_us / 1000:g} ms" if traffic.spread_us else ""
    return f"disaster: all start at once{spread}, one packet each"


def fault_words(made: RadioPlan, fault: RadioFault) -> str:
    """A fault in words: "at 2 s kill station 3"."""
    action = made.scenario.model.event[fault.index].action
    more = f", {fault.value} CR-Rs" if fault.value else ""
    return f"at {fault.at_us / 1e6:g} s {action} station {fault.node}{more}"


def _range(least: int, most: int, unit: str) -> str:
    return f"{least} {unit}" if least == most else f"{least} to {most} {unit}"


def unwatchable(plan: RadioPlan) -> str:
    """Why a team cannot be watched; "" if it can."""
    if plan.scenario.model.channel.level == "slotted":
        return 'the slotted level has no stations to watch; set channel.level = "event"'
    return ""


def loop_name(plan: RadioPlan) -> str:
    """Which loop a plan runs on, for `kernel.compilation.is_compiled`."""
    return plan.protocol.replace("/", "-")
