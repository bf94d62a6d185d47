"""What the toolkit asks of a radio team, and where it stands."""

from innervate.network import Network

NETWORK = Network(
    "radio",
    __package__,
    link_type=149,
    key_kind=3,
    rank=1,
    model="scenario.model:RadioScenario",
    check="scenario.rules:check",
    plan="scenario.planning:plan",
    describe="scenario.words:describe",
    fault_words="scenario.words:fault_words",
    actions="innervate.scenario.actions.channel:ACTIONS",
    template="scenario.template:TEMPLATE",
    simulation="sim.simulate:simulation",
    unwatchable="scenario.words:unwatchable",
    view="view.view:RadioView",
    run="run",
    tables="tables:TABLES",
    capture="export.capture",
    graph="export.graph:graph",
    node_file="live.nodefile:StationFile",
    live_node="live.build:build",
    deployment="live.deployment:RadioDeployment",
    live_words="live.words",
    live_view="view.live:RadioLiveView",
    papers="papers",
)
