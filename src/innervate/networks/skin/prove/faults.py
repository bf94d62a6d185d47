"""Mistakes that a proof must refute, beside those of the explorer's that concern an invariant."""

from innervate.prove.mutants import planted

EXPLORERS = True  # all of the explorer's mutants are refuted, too

MUTANTS = planted(
    ("who has a route does not ask the rule when it hears",
     "not (is_usable(cell, params, port) and is_allowed(cell, params, port))",
     "not (is_usable(cell, params, port) and (parent != NONE or "
     "is_allowed(cell, params, port)))"),
    ("who has a route does not ask the rule at its tick",
     "            if is_allowed(cell, params, p):\n",
     "            if cell.parent != NONE or is_allowed(cell, params, p):\n"),
    ("the choice among equals does not ask the rule",
     "p != cell.parent and is_usable(cell, params, p) and is_allowed(cell, params, p):",
     "p != cell.parent and is_usable(cell, params, p):"),
    ("the feasible distance is forgotten after 3 periods",
     "if cell.hold >= params.hold_periods:", "if cell.hold >= 3:"),
    ("periods without a route count twice",
     "cell.hold = cell.hold + 1", "cell.hold = cell.hold + 2"),
    ("time without a route goes on counting",
     "    cell.hold = 0\n    cell.sq_own", "    cell.sq_own"),
    ("who changes its parent keeps its number", "    cell.sq_own = cell.sq[cell.parent]\n", ""),
    ("a child may be the parent", "and cell.child[p] == 0", "and cell.child[p] >= 0"),
    ("a route may be a hop too long",
     "return cell.dist[p] < params.max_depth", "return cell.dist[p] <= params.max_depth"),
    ("waiting counts twice", "max(0, cell.wait - 1)", "max(0, cell.wait - 2)"),
    ("who waits looks for a parent at its tick", "    if cell.wait > 0:\n        return\n", ""),
    ("who waits takes a parent that it hears", "if cell.wait > 0 or not (", "if not ("),
    ("a restarted cell waits a period less",
     "params.k + 3 + params.k // 8", "params.k + 2 + params.k // 8"),
    ("who has a route counts, too, and forgets",
     "    if cell.parent == NONE:\n        hold_feasible(cell, params, out)",
     "    hold_feasible(cell, params, out)"),
    ("who hears of a route takes it without a feasible distance",
     "    cell.parent = port\n    adopt(cell)", "    cell.parent = port"),
    ("an older number is good enough", "cell.fd_known == 0 or later(sq, cell.fd_sq)",
     "cell.fd_known == 0 or later(cell.fd_sq, sq)"),
    ("of two numbers heard the greater is kept",
     "    cell.sq[port] = sq\n", "    cell.sq[port] = max(cell.sq[port], sq)\n"),
    ("a beacon is stored in the wrong place",
     "    cell.dist[port] = dist\n", "    cell.dist[3 - port] = dist\n"),
)  # fmt: skip
