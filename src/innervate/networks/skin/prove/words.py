"""What refutes a claim about cells, told of the two cells it concerns."""

from innervate.kernel.words import number_of
from innervate.networks.skin.protocol.constants import INFINITY, NONE, PORTS
from innervate.prove.records import Record, Store
from innervate.prove.solve import Question
from innervate.prove.steps import Step
from innervate.prove.tell import changes
from innervate.prove.terms import Term


def tell(step: Step, question: Question, goal: str) -> list[str]:
    """Cell A, the neighbour B that matters, before and after the step."""
    if "cell" not in step.records or not step.after:
        return changes(step, question, goal)
    cell = step.records["cell"]
    port = _port(step, question, cell)
    told = [f"Cell A: {_cell(question, cell, step.before)}."]
    if port is not None:
        told.append(_neighbour(step, question, cell, port))
    told.append(f"Then {step.name}{_heard(step, question)}.")
    told.append(f"Now A: {_cell(question, cell, step.after)}.")
    told += _sent(step, question)
    told.append(f"This breaks: {goal}.")
    return told


def _value(question: Question, store: Store, record: Record, name: str, at: int | None) -> int:
    return question.value(store[record, name, at])


def _port(step: Step, question: Question, cell: Record) -> int | None:
    """The port that matters: of the parent afterwards, before, or of what was heard."""
    for store in (step.after, step.before):
        parent = _value(question, store, cell, "parent", None)
        if parent != NONE:
            return parent
    return next((p for p in range(PORTS) if _unlike(step, question, cell, p)), None)


def _unlike(step: Step, question: Question, cell: Record, p: int) -> bool:
    return any(
        _value(question, step.before, cell, name, p) != _value(question, step.after, cell, name, p)
        for name in ("dist", "sq")
    )


def _hops(dist: int) -> str:
    return "no route" if dist == INFINITY else number_of(dist, "hop")


def _cell(question: Question, cell: Record, store: Store) -> str:
    """Its route, its feasible distance, its waiting."""

    def one(name: str, at: int | None = None) -> int:
        return _value(question, store, cell, name, at)

    parent = one("parent")
    words = ["no parent"]
    if parent != NONE:
        words = [f"parent is port {parent}, which said {_hops(one('dist', parent))}, "
                 f"number {one('sq', parent)}"]  # fmt: skip
    if one("fd_known"):
        words.append(f"feasible distance {_hops(one('fd_dist'))} of number {one('fd_sq')}")
    else:
        words.append("no feasible distance")
    if one("wait"):
        words.append(f"{one('wait')} periods of waiting left")
    if one("hold"):
        words.append(f"{one('hold')} periods without a route")
    return "; ".join(words)


def _neighbour(step: Step, question: Question, cell: Record, p: int) -> str:
    """What B is, and what A keeps of it."""
    t = step.terms
    known = question.value(t.unknown(f"ghost{p}.known", 0, 1))
    kept = (f"A keeps of it {_hops(_value(question, step.before, cell, 'dist', p))}, "
            f"number {_value(question, step.before, cell, 'sq', p)}")  # fmt: skip
    if not known:
        return f"On port {p} is B, which has no feasible distance; {kept}."
    found = question.values_found
    sq = (found.get("base", 0) + found.get(f"ghost{p}.sq.ahead", 0)) & 0xFFFF
    dist = found.get(f"ghost{p}.dist", 0)
    return f"On port {p} is cell B: feasible distance {_hops(dist)} of number {sq}; {kept}."


def _heard(step: Step, question: Question) -> str:
    """What the frame says, if there is one."""
    if "hears" not in step.name:
        return ""
    frame = step.records["frame"]
    hops = _hops(_value(question, step.before, frame, "dist", None))
    number = _value(question, step.before, frame, "sq", None)
    port = question.values_found.get("port", 0)
    return f" on port {port}: {hops}, number {number}"


def _sent(step: Step, question: Question) -> list[str]:
    """The first beacon that it sends."""
    for action in step.machine.out.actions:
        key = (action.frame, "dist", None)
        if key in step.after and question.holds(action.guard):
            hops = _hops(question.value(step.after[key]))
            number: Term = step.after[action.frame, "sq", None]
            return [f"It announces {hops}, number {question.value(number)}."]
    return []
