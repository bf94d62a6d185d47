"""What the toolkit asks of a skin, and where it stands."""

from innervate.network import Network
from innervate.networks.places import PLACES

NETWORK = Network(
    "skin", __package__, **PLACES, link_type=147, key_kind=2, rank=0,
    model="scenario.model:SkinScenario",
    plan="scenario.plan:plan",
    anchor="scenario.graph:anchor",
    simulation="view.engine:simulation",
    unwatchable="view.engine:unwatchable",
    engine="view.engine:SkinEngine",
    view="view.view:SkinView",
    received_image="analysis.touch:received_image",
    scenes="export.scenes:channels",
    has_places="export.rrd:has_places",
    rerun_parts="export.rrd:parts",
    loop_name="sim.simulate:loop_name",
    sizing="sizing",
    fit="export.fit",
    interface_words="frames:INTERFACE_WORDS",
    node_file="live.nodefile:SkinFile",
    deployment="live.deployment:SkinDeployment",
    live_view="view.live:SkinLiveView",
    recovery="export.recovery",
    comparison="papers.compared",
    counterexample="plot.counterexample:save",
)  # fmt: skip
