"""What the toolkit asks of a mesh, and where it stands."""

from innervate.network import Network

NETWORK = Network(
    "mesh",
    __package__,
    link_type=148,
    key_kind=1,
    rank=2,
    model="scenario.model:MeshScenario",
    check="scenario.rules:check",
    plan="scenario.planning:plan",
    describe="scenario.words:describe",
    fault_words="scenario.words:fault_words",
    actions="innervate.scenario.actions.field:ACTIONS",
    template="scenario.template:TEMPLATE",
    anchor="scenario.nodes:anchor",
    simulation="sim.simulate:simulation",
    view="view.view:MeshView",
    run="run",
    tables="tables:TABLES",
    capture="export.capture",
    graph="export.graph:graph",
    scenes="export.scenes:channels",
    has_places="export.rrd:has_places",
    rerun_parts="export.rrd:parts",
    node_file="live.nodefile:MeshFile",
    live_node="live.build:build",
    deployment="live.deployment:MeshDeployment",
    live_words="live.words",
    live_view="view.live:MeshLiveView",
    papers="papers",
)
