"""The skin's explorer can fail: it runs on copies of the protocol with a small mistake in each."""

from collections.abc import Iterator

from innervate.networks.skin.verify import assumptions, fair, graphs, story
from innervate.networks.skin.verify import system as system
from innervate.prove.mutants import Mutant, planted
from innervate.verify import explore
from innervate.verify.cases import Catch

PROTOCOL = "innervate.networks.skin.protocol"


# Mistakes that only the explorer's properties are asked to find; tests/networks/skin/verify has
# more of them, with the unit and property tests that find those.
MUTANTS = planted(
    ("an equal feasible distance is good enough", "return sq == cell.fd_sq and dist < cell.fd_dist",
     "return sq == cell.fd_sq and dist <= cell.fd_dist"),
    ("any route of the same number is feasible",
     "return sq == cell.fd_sq and dist < cell.fd_dist", "return sq == cell.fd_sq"),
    ("farther is nearer", "return sq == cell.fd_sq and dist < cell.fd_dist",
     "return sq == cell.fd_sq and dist > cell.fd_dist"),
    ("the feasible distance is set once only",
     "if nearer_than_fd(cell, cell.sq_own, dist):", "if cell.fd_known == 0:"),
    ("the feasible distance is a hop too far", "cell.fd_dist = dist", "cell.fd_dist = dist + 1"),
    ("the feasible distance keeps its first number",
     "cell.fd_sq = cell.sq_own\n", "cell.fd_sq = cell.fd_sq\n"),
    ("the feasible distance is forgotten at once",
     "if cell.hold >= params.hold_periods:", "if cell.hold >= 1:"),
    ("an equal number is newer", "return ahead != 0 and ahead < HALF16", "return ahead < HALF16"),
    ("older is newer", "return ahead != 0 and ahead < HALF16", "return ahead >= HALF16"),
    ("the distance does not grow", "return min(cell.dist[cell.parent] + 1, INFINITY)",
     "return min(cell.dist[cell.parent], INFINITY)"),
    ("the distance grows by two", "return min(cell.dist[cell.parent] + 1, INFINITY)",
     "return min(cell.dist[cell.parent] + 2, INFINITY)"),
    ("a newer number is announced than there is", "cell.sent_sq = cell.sq_own\n    cell.sent_at",
     "cell.sent_sq = (cell.sq_own + 1) & 65535\n    cell.sent_at"),
    ("a broken cable is still a way",
     "cell.pf[p] < ONE and cell.child[p] == 0", "cell.child[p] == 0"),
    ("who has no route is a way",
     "return cell.dist[p] < params.max_depth and", "return cell.dist[p] < 256 and"),
    ("a lost parent is kept", "if old != NONE and not is_usable(cell, params, old):",
     "if old == 9 and not is_usable(cell, params, old):"),
    ("a nearer port is not taken", "if best < current:", "if best < current and old == NONE:"),
    ("hearing does not ask the rule",
     "not (is_usable(cell, params, port) and is_allowed(cell, params, port))",
     "not is_usable(cell, params, port)"),
    ("strict takes an equal number", "return params.rule != RULE_STRICT and cell.sq[p] == least",
     "return cell.sq[p] == least"),
    ("every neighbour is told that it is the parent",
     "frame.parent = 1 if p == parent else 0", "frame.parent = 1"),
    ("penalties grow beyond 2", "min(2 * ONE, penalty", "min(2 * ONE + 840, penalty"),
    ("penalties shrink below 0", "max(0, penalty - params.r_r)", "penalty - params.r_r"),
    ("silence heals a port", "if cell.heard[p]:", "if cell.heard[p] == 0:"),
    ("the PC says that it is a hop away", "frame.dist = 0\n", "frame.dist = 1\n"),
)  # fmt: skip


def copy_of(mutant: Mutant) -> system.System:
    """The skin's system on a copy of the protocol with the mistake in it."""
    cell, sink = mutant.copies(f"{PROTOCOL}.cell", f"{PROTOCOL}.sink")
    return system.system_of(cell, sink)


def models(lean: bool = False) -> Iterator[system.SkinModel]:
    """What each mutant is tried on, smallest first."""
    calm = system.Budget(loss=0, cut=1, heal=0, false=0, restart=0, faults=1)
    small = system.Budget(loss=0, cut=1, heal=1, false=1, restart=1, faults=1)
    for graph, rule, updates, budget in (
        ("pc-1 1-2", "feasible", "periodic", small),
        ("pc-1", "feasible", "triggered", small),
        ("pair", "feasible", "periodic", small),
        ("triangle", "feasible", "periodic", calm),
        ("triangle", "strict", "periodic", calm),
        ("pair", "feasible", "triggered", system.Budget(2, 2, 0, 1, 0, 0, 0, 1)),
    ):
        keep = rule == "feasible"
        yield system.SkinModel(graphs.parse(graph), rule, updates, budget, keep=keep, lean=lean)


def hunt(mutant: Mutant, starts: int = 12, lean: bool = False) -> Catch:
    """Try a mutant on all models until something is broken; liveness from `starts` states."""
    changed = copy_of(mutant)
    states = 0
    for model in models(lean):
        where = f"{graphs.cables(model.graph)}, {model.rule}, {model.updates}"
        try:
            taken = assumptions.broken(model, changed) if lean else ""
            if taken:
                return Catch(mutant, f"a promise that reductions rest on: {taken}", where, states)
            found = explore.explore(model, plain=True, system=changed, states=15_000)
            states += found.tally.states
            if found.broken:
                by = story.TITLES[found.broken] if lean else story.tell(found, changed).title
                return Catch(mutant, by, where, states)
            if model.keep:
                settled = fair.check(found, plain=True, system=changed, starts=starts)
                if settled.ended == "broken":
                    return Catch(mutant, settled.broken, where, states)
        except (ArithmeticError, IndexError, ValueError) as error:
            return Catch(mutant, f"{type(error).__name__}: a value out of range", where, states)
    return Catch(mutant, "", "", states)
