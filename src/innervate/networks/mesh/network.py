"""What the toolkit asks of a mesh, and where it stands."""

from innervate.network import Network
from innervate.networks.places import PLACES

NETWORK = Network(
    "mesh", __package__, **PLACES, link_type=148, key_kind=1, rank=2,
    model="scenario.model:MeshScenario",
    plan="scenario.planning:plan",
    actions="innervate.scenario.actions.field:ACTIONS",
    harm="innervate.scenario.actions.field:HARM",
    anchor="scenario.nodes:anchor",
    simulation="sim.simulate:simulation",
    view="view.view:MeshView",
    scenes="export.scenes:channels",
    has_places="export.rrd:has_places",
    rerun_parts="export.rrd:parts",
    loop_name="sim.simulate:loop_name",
    measured_template="scenario.measured_template:measured",
    fit="export.fit",
    log="export.statuslog",
    dissector="export.dissector:dissector",
    node_file="live.nodefile:MeshFile",
    deployment="live.deployment:MeshDeployment",
    live_view="view.live:MeshLiveView",
    comparison="papers.comparison",
    counterexample="plot.counterexample:save",
)  # fmt: skip
