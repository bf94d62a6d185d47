"""What the toolkit asks of a radio team, and where it stands."""

from innervate.network import Network
from innervate.networks.places import PLACES

NETWORK = Network(
    "radio",
    __package__,
    **PLACES,
    link_type=149,
    key_kind=3,
    rank=1,
    model="scenario.model:RadioScenario",
    plan="scenario.planning:plan",
    anchor="scenario.slotted:anchor",
    actions="innervate.scenario.actions.channel:ACTIONS",
    harm="innervate.scenario.actions.channel:HARM",
    simulation="sim.simulate:simulation",
    unwatchable="scenario.words:unwatchable",
    view="view.view:RadioView",
    summary_name="run:summary_name",
    without_events="run:without_events",
    loop_name="scenario.words:loop_name",
    unfit="scenario.words:UNFIT",
    interface_words="frames:INTERFACE_WORDS",
    dissector="export.dissector:dissector",
    node_file="live.nodefile:StationFile",
    deployment="live.deployment:RadioDeployment",
    live_view="view.live:RadioLiveView",
)
