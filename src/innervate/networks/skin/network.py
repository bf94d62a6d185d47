"""What the toolkit asks of a skin, and where it stands."""

from innervate.network import Network

NETWORK = Network(
    "skin",
    __package__,
    link_type=147,
    rank=0,
    model="scenario.model:SkinScenario",
    check="scenario.rules:check",
    plan="scenario.plan:plan",
    describe="scenario.words:describe",
    fault_words="scenario.words:fault_words",
    actions="innervate.scenario.actions.cables:ACTIONS",
    template="scenario.template:TEMPLATE",
    anchor="scenario.graph:anchor",
    simulation="view.engine:simulation",
    unwatchable="view.engine:unwatchable",
    engine="view.engine:SkinEngine",
    view="view.view:SkinView",
    run="run",
    received_image="analysis.touch:received_image",
    tables="tables:TABLES",
    capture="export.capture",
    graph="export.graph:graph",
    scenes="export.scenes:channels",
    has_places="export.rrd:has_places",
    rerun_parts="export.rrd:parts",
    papers="papers",
)
