"""Holds the formulas against plain Python: the same calls, the same state and outbox.

The formula that the solver is given (not the terms it was made from) is turned into a Python
function once, node by node, and asked for the values that a handler leaves; the handler itself runs
on plain objects. Draws return what is scripted in both.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any

import z3

from innervate.dialect import plain
from innervate.dialect.arith import MASK30
from innervate.dialect.source import Change, functions
from innervate.prove.errors import ProveError
from innervate.prove.records import Declaration, Key, name_of
from innervate.prove.solve import Formulas
from innervate.prove.steps import Stage, Step
from innervate.prove.terms import Term

TRIES = 50  # drawn values for one call that may be
ROOM = 64
NOT_COMPARED = frozenset({"rng", "choice", "asked"})


def compiled(formulas: list[Any], draws: dict[str, Any]) -> Callable[..., Any]:
    """A Python function from values of unknowns to those of formulas.

    Args:
        formulas: what the solver would be given.
        draws: by the name of an unknown: out of how many it is drawn.
    """
    writer = _Writer(draws)
    names = [writer.write(formula) for formula in formulas]
    body = "\n    ".join([*writer.lines, f"return ({', '.join(names)},)"])
    known: dict[str, Any] = {"signed": _signed, "trunc": _trunc}
    exec(compile(f"def formula(known, scripted):\n    {body}\n", "formula", "exec"), known)
    made: Callable[..., Any] = known["formula"]
    return made


def _signed(value: int, bits: int) -> int:
    """An unsigned number of so many bits as a signed one."""
    return value - (1 << bits) if value >> (bits - 1) else value


def _trunc(a: int, b: int) -> int:
    """A quotient rounded towards 0, as bit vectors have it; of a divisor 0 whatever."""
    return abs(a) // (abs(b) or 1) * (1 if (a < 0) == (b < 0) else -1)


class _Writer:
    """Writes z3's formulas as lines of Python; numbers are unsigned, of their widths."""

    def __init__(self, draws: dict[str, Any]) -> None:
        self.draws = draws
        self.lines: list[str] = []
        self._names: dict[int, str] = {}
        self._kept: list[Any] = []

    def write(self, formula: Any) -> str:
        """The name of a formula's value."""
        waiting = [formula]
        while waiting:
            top = waiting[-1]
            if top.get_id() in self._names:
                waiting.pop()
                continue
            parts = list(top.children()) or self._drawn_from(top)
            missing = [part for part in parts if part.get_id() not in self._names]
            if missing:
                waiting.extend(missing)
                continue
            waiting.pop()
            name = f"v{len(self._names)}"
            self.lines.append(f"{name} = {self._text(top, parts)}")
            self._names[top.get_id()] = name
            self._kept.append(top)
        return self._names[formula.get_id()]

    def _drawn_from(self, leaf: Any) -> list[Any]:
        name = leaf.decl().name()
        is_drawn = leaf.decl().kind() == z3.Z3_OP_UNINTERPRETED and name in self.draws
        return [self.draws[name]] if is_drawn else []

    def _text(self, top: Any, parts: list[Any]) -> str:
        a = [self._names[part.get_id()] for part in parts]
        kind = top.decl().kind()
        if kind == z3.Z3_OP_UNINTERPRETED:
            name = top.decl().name()
            mask = (1 << top.size()) - 1
            if name in self.draws:
                many = f"signed({a[0]}, {parts[0].size()})"
                return f"min(scripted, {many} - 1) & {mask}"
            return f"known[{name!r}] & {mask}"
        if kind == z3.Z3_OP_BNUM:
            return str(top.as_long())
        if kind in LOGIC:
            return LOGIC[kind](a)
        bits = parts[0].size()
        mask = (1 << (top.size() if z3.is_bv(top) else 1)) - 1
        params = top.params() if kind in (z3.Z3_OP_EXTRACT,) else []
        return BITS[kind](a, bits, mask, params)


def _compare(op: str) -> Callable[..., str]:
    return lambda a, bits, mask, _: f"signed({a[0]}, {bits}) {op} signed({a[1]}, {bits})"


def _many(op: str) -> Callable[..., str]:
    return lambda a, bits, mask, _: f"({f' {op} '.join(a)}) & {mask}"


LOGIC: dict[int, Callable[[list[str]], str]] = {
    z3.Z3_OP_TRUE: lambda a: "True",
    z3.Z3_OP_FALSE: lambda a: "False",
    z3.Z3_OP_NOT: lambda a: f"not {a[0]}",
    z3.Z3_OP_AND: " and ".join,
    z3.Z3_OP_OR: " or ".join,
    z3.Z3_OP_ITE: lambda a: f"{a[1]} if {a[0]} else {a[2]}",
    z3.Z3_OP_EQ: lambda a: f"{a[0]} == {a[1]}",
}
BITS: dict[int, Callable[..., str]] = {
    z3.Z3_OP_BADD: _many("+"),
    z3.Z3_OP_BSUB: _many("-"),
    z3.Z3_OP_BMUL: _many("*"),
    z3.Z3_OP_BAND: _many("&"),
    z3.Z3_OP_BOR: _many("|"),
    z3.Z3_OP_BXOR: _many("^"),
    z3.Z3_OP_BSHL: lambda a, bits, mask, _: (
        f"({a[0]} << {a[1]}) & {mask} if {a[1]} < {bits} else 0"
    ),
    z3.Z3_OP_BASHR: lambda a, bits, mask, _: (
        f"(signed({a[0]}, {bits}) >> min({a[1]}, {bits})) & {mask}"
    ),
    z3.Z3_OP_BSDIV: lambda a, bits, mask, _: (
        f"trunc(signed({a[0]}, {bits}), signed({a[1]}, {bits})) & {mask}"
    ),
    z3.Z3_OP_BSREM: lambda a, bits, mask, _: (
        f"(abs(signed({a[0]}, {bits})) % (abs(signed({a[1]}, {bits})) or 1)"
        f" * (-1 if signed({a[0]}, {bits}) < 0 else 1)) & {mask}"
    ),
    z3.Z3_OP_BSMOD: lambda a, bits, mask, _: (
        f"(signed({a[0]}, {bits}) % (signed({a[1]}, {bits}) or 1)) & {mask}"
    ),
    z3.Z3_OP_SLT: _compare("<"),
    z3.Z3_OP_SLEQ: _compare("<="),
    z3.Z3_OP_SGT: _compare(">"),
    z3.Z3_OP_SGEQ: _compare(">="),
    z3.Z3_OP_SIGN_EXT: lambda a, bits, mask, _: f"signed({a[0]}, {bits}) & {mask}",
    z3.Z3_OP_ZERO_EXT: lambda a, bits, mask, _: a[0],
    z3.Z3_OP_EXTRACT: lambda a, bits, mask, params: f"{a[0]} >> {params[1]} & {mask}",
}


class Twin:
    """A step of which both can be asked: its formula, and the protocol itself.

    Args:
        step: that was played, on plain unknowns.
        handler: the function that was played.
        args: of the handler: names of records, numbers, names of unknowns; "out" the outbox.
        declared: of every record its declaration.
    """

    def __init__(
        self, step: Step, handler: str, args: tuple[Any, ...], declared: Mapping[str, Declaration]
    ) -> None:
        self.step = step
        home = step.machine.functions[handler].module
        self.handler = getattr(import_module(home), handler)
        self.args = args
        self.classes = {name: plain.make(name, fields) for name, fields in declared.items()}
        self.declared = declared
        self.actions = step.machine.out.actions
        self.frame_class = plain.make("Sent", step.machine.out.frame)
        # Plain frames begin at the value nearest 0.
        self.fresh = {
            name_of(key): min(max(0, low), high)
            for action in self.actions
            for key, low, high in action.frame.places()
        }
        self.wanted = self._wanted()
        formulas = Formulas()
        made = [formulas.of(term) for term in self.wanted]
        self.widths = [one.size() if z3.is_bv(one) else 0 for one in made]
        draws = {str(drawn.args[0]): formulas.of(many)
                 for drawn, many, _ in step.machine.draws if drawn.op == "var"}  # fmt: skip
        self.formula = compiled(made, draws)

    def _places(self) -> list[Key]:
        return [key for record in self.step.records.values() for key, _, _ in record.places()]

    def _wanted(self) -> list[Term]:
        """That all demands hold, all values afterwards, of every action its guard and content."""
        terms = self.step.terms
        demands = [terms.implies(one.guard, one.holds) for one in self.step.machine.demands]
        result = self.step.result if isinstance(self.step.result, Term) else terms.number(0)
        found = [terms.all(*demands), result, *(self.step.after[key] for key in self._places())]
        for action in self.actions:
            found += [action.guard, action.a, action.b, action.c]
            found += [self.step.after[key] for key, _, _ in action.frame.places()]
        return found

    def same(self, draw: random.Random) -> str | None:
        """What differs for values that are drawn; "" if nothing does, None if they may not be.

        They may not where an index leaves its array, say: what no invariant allows.
        """
        known: dict[str, int] = dict(self.fresh)
        for name, fields in self.declared.items():
            known.update(_drawn(draw, name, fields))
        for arg in self.args:
            if isinstance(arg, tuple):
                known[arg[0]] = draw.randint(arg[1], arg[2])
        scripted = draw.choice((0, 1, 2, 3, draw.randint(0, MASK30)))
        known.setdefault("now", draw.randint(0, MASK30))
        records = {name: self._plain(name, known, scripted) for name in self.declared}
        out = plain.Outbox(self.frame_class, ROOM)
        given = [self._given(arg, records, known, out) for arg in self.args]
        sound, result, *found = self.formula(known, scripted)
        if not sound:
            return None
        plainly = int(self.handler(*given) or 0)
        if plainly != (_signed(int(result), self.widths[1]) if self.widths[1] else int(result)):
            return f"it returns {plainly}, in the formula {result}"
        return self._differs(found, records, out)

    def _given(self, arg: Any, records: dict[str, Any], known: dict[str, int], out: Any) -> Any:
        if isinstance(arg, tuple):
            return known[arg[0]]
        if arg == "out":
            return out
        return records.get(arg, arg) if isinstance(arg, str) else arg

    def _plain(self, name: str, known: dict[str, int], scripted: int) -> Any:
        made = self.classes[name]()
        for field, length, *_ in self.declared[name]:
            if length:
                values = [known[f"{name}.{field}[{i}]"] for i in range(length)]
                setattr(made, field, values)
            else:
                setattr(made, field, known[f"{name}.{field}"])
        if hasattr(made, "choice"):
            made.choice = scripted
        return made

    def _differs(self, found: list[Any], records: dict[str, Any], out: Any) -> str:
        values = [_signed(int(value), bits) if bits else int(value)
                  for value, bits in zip(found, self.widths[2:], strict=True)]  # fmt: skip
        places = self._places()
        for key, value in zip(places, values, strict=False):
            if key[1] in NOT_COMPARED:
                continue
            plainly = getattr(records[key[0].name], key[1])
            plainly = int(plainly if key[2] is None else plainly[key[2]])
            if plainly != value:
                return f"{key[0].name}.{key[1]}[{key[2]}] is {plainly}, in the formula {value}"
        return self._actions_differ(values[len(places) :], out)

    def _actions_differ(self, values: list[int], out: Any) -> str:
        at, number = 0, 0
        for action in self.actions:
            size = 4 + sum(1 for _ in action.frame.places())
            guard, a, b, c, *frame = values[at : at + size]
            at += size
            if not guard:
                continue
            if number >= out.count[0]:
                return f"action {number} is in the formula alone"
            plainly = out.action[number]
            if (plainly.kind, plainly.a, plainly.b, plainly.c) != (action.kind, a, b, c):
                return f"action {number} is {plainly.kind, plainly.a, plainly.b}, else {a, b, c}"
            for (key, _, _), value in zip(action.frame.places(), frame, strict=True):
                sent = getattr(out.frame[number], key[1])
                if int(sent if key[2] is None else sent[key[2]]) != value:
                    return f"action {number}: {key[1]} is {sent}, in the formula {value}"
            number += 1
        return "" if number == out.count[0] else f"{out.count[0]} actions, not {number}"

    def calls(self, count: int, seed: int) -> str:
        """So many drawn calls: the first that differs, with its number; "" if none does.

        Raises:
            ProveError: hardly any drawn values may be.
        """
        draw = random.Random(f"{self.step.name} {seed}")
        done = 0
        for number in range(TRIES * count):
            differs = self.same(draw)
            if differs:
                return f"{self.step.name}, call {number} of seed {seed}: {differs}"
            done += differs is not None
            if done == count:
                return ""
        raise ProveError(f"{self.step.name}: {done} of {TRIES * count} drawn calls may be")


def twin(
    entry: str, handler: str, args: tuple[Any, ...], declared: Mapping[str, Declaration],
    change: Change | None = None,
) -> Twin:  # fmt: skip
    """A handler beside its formula, on any values in their declared ranges.

    Args:
        entry: the module with the handlers.
        handler: which of them.
        args: what it is given: names of records, numbers, "out", and (name, low, high) unknowns.
        declared: of every record its declaration; that of "frame" is the outbox's frames', too.
        change: a mistake to plant in the formula, to see that it differs.
    """
    stage = Stage(functions(entry, change=change, shared=True), declared.get("frame", ()), ROOM)
    records = {name: stage.record(name, one) for name, one in declared.items()}

    def given(arg: Any) -> Any:
        if isinstance(arg, tuple):
            return stage.terms.unknown(*arg)
        return stage.out if arg == "out" else records.get(arg, arg)

    step = stage.play(handler, handler, [given(arg) for arg in args], [])
    return Twin(step, handler, args, declared)


def _drawn(draw: random.Random, name: str, fields: Declaration) -> dict[str, int]:
    """Values of a record, often at the ends of their ranges and near each other."""
    found = {}
    for field, length, low, high, _unit, _meaning in fields:
        for i in range(length or 1):
            key = f"{name}.{field}[{i}]" if length else f"{name}.{field}"
            near = min(high, max(low, draw.randint(-2, 6)))
            found[key] = draw.choice((low, high, near, near, near, draw.randint(low, high)))
    return found
