"""The parts of a network: what each must be, and where those stand that one leaves out."""

# Every part that a network can have, and what it is. Those with a default may be left out.
PARTS = {
    "model": "msgspec.Struct: the keys of its scenarios, with ranges and meanings",
    "check": "(source, model): raises ScenarioError at the first thing that does not fit together",
    "plan": "(scenario) -> the plan of its run, whole numbers only; `plan.kind` is the name",
    "describe": "(plan) -> str: the scenario in a few lines, without running it",
    "fault_words": '(plan, fault) -> str: "at 2 s cut pc.1 - p0 r16 c7 down"',
    "foreseen": "(plan) -> list of str: what of it cannot work, besides what any network's `check` "
    "finds; a sentence each",
    "actions": "tuple of str: what can be done to it while it runs, in the order of their numbers",
    "harm": "tuple of str: those of the actions that make it worse",
    "template": "str: a commented scenario to start from; if absent, all keys as they are by "
    "themselves",
    "anchor": "(tables, source): readies a scenario's tables to be written: relative paths become "
    "absolute, what its runs refuse to be given is left out",
    "run": "module: simulate, summarize, tables_of, written_of, columns, trail, call_words",
    "tables": "tuple of Table: all tables that its runs can have",
    "received_image": "(result, time_s, window_s): what was felt, as it was received",
    "report": "(result, summary) -> str: the body of its report, HTML",
    "notebook": "(result, summary) -> str: the same for a notebook, its top and a picture",
    "figures": "dict of str to (run, **options) -> a matplotlib figure; the first if none is named",
    "summary_lines": "(run) -> list of str: what a person wants to know first",
    "summary_name": '(summary) -> str: by what name a run has it, like "skin" for `run.skin`',
    "without_events": '(summary) -> str: why a run has no events to compare; "" if it has',
    "loop_name": '(plan) -> str: the compiled loop that it runs on; "" = it needs no compiling',
    "demo": "module: SCENARIO, INTRODUCTION, LOOK, NEXT, lines(run): its chapter of `demo`",
    "sizing": "module: Question, parse_ports, size, RECOVERY: what `size` answers",
    "measured_template": "(name, network, dict of what was chosen of it, folder) -> (str, str): a "
    "scenario of what was measured, and what it takes",
    "capture": "module: LATE_US, refusal, interfaces, numbers, frames, simulate; if absent, any "
    "network of cables with `frames` has one (export/cabled.py)",
    "interface_words": 'dict: what captures call a node, by its role; others are a "node"',
    "dissector": "() -> export.dissector.Frames: its frames for Wireshark, from `frames` if absent",
    "fit": "module: Reader, tables_of, named, named_again: a scenario out of a capture",
    "unfit": "str: why no scenario comes out of its captures",
    "log": "module: looks_like_one(path), measure(path): what `fit` reads besides captures",
    "graph": "(plan) -> export.graphs.Graph: its network as a graph",
    "scenes": "(plan, tables) -> list of export.scenes.Channel: what a recording shows in space",
    "has_places": "(plan) -> bool: its nodes can be laid somewhere in space",
    "rerun_parts": "(rerun, plan, tables) -> export.rrd_parts.Parts: a run in space",
    "simulation": "(plan) -> sim.driver.Simulation: the network as it is watched, not yet begun; "
    "for the default `run` also by name plain, checks, observe, deliveries, trail, tap",
    "unwatchable": '(plan) -> str: why it cannot be watched; "" if it can',
    "engine": "class: web.engine.Engine, or what can do more",
    "view": "class: what the live page shows of its simulation (web/view.py)",
    "event": "(plan, fault) -> dict: the [[event]] table of a fault, without its time; if absent, "
    "as its `model` is absent",
    "protocol": "module: on_start, on_frame, on_timer, on_input of a node; OUTBOX, TIMERS",
    "fields": "module: PARAMS, STATE, FRAME: the declared fields of its protocol",
    "frames": "module: LAYOUTS, KIND_BITS of its frames; encode, decode, REASONS if it has own",
    "packets": "(number, params) -> what live nodes say in place of `frames`: encode(frame), "
    "read(data, frame) that yields 0 for every frame in it or else why, reasons",
    "node_file": "live.nodefile.NodeFile: the keys of its node files",
    "live_node": "(nodefile.Loaded) -> live.node.LiveNode: the node of a node file",
    "in_c": '(live stack, network) -> str: lets it call C from now on; "", or why it cannot',
    "deployment": "class: live.deployment.Deployment, how a plan becomes node files and cables",
    "live_words": "module: lines, ports, heard: what its running nodes say, for people",
    "live_view": "class: web.live_view.LiveView, its running nodes on the page",
    "recovery": "module: recoveries, line, NOTHING: how it healed, from a capture",
    "verify": "module: explorations: what `verify` does, and more (verify/cases.py)",
    "prove": "module: theories: what `prove` does, and mistakes to plant (prove/faults.py)",
    "counterexample": "(story, path): the picture of how something breaks",
    "boards": "tuple of live.board.Role: what of it runs on a board; if absent, its protocol",
    "random": "module: SHARE, drawn, smaller, trouble: networks from a number (running/fuzz.py)",
    "invariants": "module in the dialect: node_*(node, params, now), network_*(nodes, count, "
    "params) or (nodes, count, params, peer): what must hold",
    "measures": "(nodes, reports, deliveries, plan) -> dict of str to number: own figures; nodes: "
    "the states at the end of those that are on",
    "shows": "dict of str to (unit, (node, params) -> number): what pages colour nodes by, too",
    "happenings": "dict of str to (node, value) -> (kind, item) for on_input: own [[event]]s",
    "papers": "module: TITLE, AUTHORS, FIGURES, READINGS, experiment, warm_up",
    "comparison": "module: JOBS, what protocols are compared at; ENTRIES, what of it does which "
    "job (papers/jobs.py)",
}


def _declared(medium: str, model: str, *more: str) -> dict[str, str]:
    """Parts that stand at the same places for any network of a medium; `more` besides."""
    declared = f"innervate.scenario.declared.{medium}"
    actions = f"innervate.scenario.actions.{medium}"
    return {
        "model": f"{declared}:{model}",
        **{part: f"{declared}:{part}" for part in ("check", "plan", "template", "describe", *more)},
        "actions": f"{actions}:ACTIONS",
        "harm": f"{actions}:HARM",
        "simulation": f"innervate.sim.{medium}.declared:simulation",
    }


DEFAULTS = {
    **_declared("cables", "CablesScenario", "event"),
    "run": "innervate.running.simulating",
    "tables": "innervate.running.simulating:TABLES",
    "report": "innervate.plot.body:body",
    "notebook": "innervate.plot.body:notebook",
    "figures": "innervate.plot.figures:FIGURES",
    "summary_lines": "innervate.plot.lines:summary_lines",
    "graph": "innervate.export.cabled:graph",
    "scenes": "innervate.network:nothing_to_show",
    "has_places": "innervate.export.declared_rrd:has_places",
    "rerun_parts": "innervate.export.declared_rrd:parts",
    "unwatchable": "innervate.network:scripted",
    "engine": "innervate.web.engine:Engine",
    "view": "innervate.web.declared_view:DeclaredView",
    "anchor": "innervate.network:nothing_to_anchor",
    "fault_words": "innervate.scenario.cables:fault_words",
    "verify": "innervate.verify.declared",
    "prove": "innervate.prove.declared",
    "interface_words": "innervate.network:NO_WORDS",
    "unfit": "innervate.network:UNFIT",
    "without_events": "innervate.network:nothing_against_it",
    "loop_name": "innervate.network:no_name",
    "summary_name": "innervate.network:kind_of",
    "node_file": "innervate.live.declared:DeclaredFile",
    "live_node": "innervate.live.declared:build",
    "in_c": "innervate.firmware.dropin:take_place",
    "deployment": "innervate.live.deployment:Deployment",
    "live_words": "innervate.live.words",
    "live_view": "innervate.web.live_view:LiveView",
}

# Parts that stand for any network of a medium, where they are others than over cables.
MEDIA: dict[str, dict[str, str]] = {
    "cables": {},
    "channel": {
        **_declared("channel", "ChannelScenario", "fault_words", "event"),
        "view": "innervate.web.channel_view:ChannelView",
        "live_node": "innervate.live.on_air:build",
        "deployment": "innervate.live.on_channel:ChannelDeployment",
    },
    "field": {
        **_declared("field", "FieldScenario", "fault_words", "event"),
        "view": "innervate.web.field_view:FieldView",
        "live_node": "innervate.live.in_field:build",
        "deployment": "innervate.live.in_field:FieldDeployment",
    },
}
# Parts that can be functions of the network, which make them.
MADE = frozenset({"template"})
