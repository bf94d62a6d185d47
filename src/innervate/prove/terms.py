"""Terms: whole numbers and truths that depend on unknowns, each known to lie in a range.

Equal terms are one object. What the ranges decide is decided here, so that a formula has only
what is left open. Nothing here knows a solver.
"""

from collections.abc import Callable, Iterable


class Term:
    """A number (or a truth, 0 or 1) that is `op` of `args`."""

    __slots__ = ("args", "high", "is_leafy", "is_truth", "low", "made", "op", "opposite")

    def __init__(self, op: str, args: tuple[object, ...], low: int, high: int, truth: bool) -> None:
        self.made = 0  # how many were before it: the same formula comes out every time
        # const, var, add, sub, mul, div, mod, and, or, xor, shl, shr, wrap for numbers; const, eq,
        # lt, all, any, not for truths; pick for either: (if, then, else)
        self.op = op
        self.args = args  # terms; the value of a const, the name of a var
        self.low, self.high, self.is_truth = low, high, truth
        self.opposite: Term | None = None  # the truth that says not so, once somebody asked
        # all that can be picked are known numbers, one after the other
        self.is_leafy = op == "const" or (op == "pick" and _is_leafy(*_terms(self)[1:]))

    @property
    def value(self) -> int | None:
        """Its value, if there is only one."""
        return self.low if self.low == self.high else None

    def __repr__(self) -> str:
        """The term as text, in full."""
        if self.op in ("const", "var"):
            return str(self.args[0])
        return f"{self.op}({', '.join(map(repr, self.args))})"


class Terms:
    """Makes terms; those of one `Terms` belong together."""

    def __init__(self) -> None:
        self._made: dict[tuple[object, ...], Term] = {}
        self._same: dict[tuple[Term, Term], Term] = {}
        self._fresh = 0
        self.true = self._term("const", (1,), 1, 1, True)
        self.false = self._term("const", (0,), 0, 0, True)

    def _term(
        self, op: str, args: tuple[object, ...], low: int, high: int, truth: bool = False
    ) -> Term:
        key = (op, truth, low, high, args)
        found = self._made.get(key)
        if found is None:
            found = Term(op, args, low, high, truth)
            found.made = len(self._made)
            self._made[key] = found
        return found

    # -- leaves

    def number(self, value: int) -> Term:
        """A number that is known."""
        return self._term("const", (int(value),), int(value), int(value))

    def truth_of(self, value: bool) -> Term:
        """A truth that is known."""
        return self.true if value else self.false

    def unknown(self, name: str, low: int, high: int) -> Term:
        """Any number of a range; the same name is the same number."""
        if low == high:
            return self.number(low)
        return self._term("var", (name,), low, high)

    def fresh(self, name: str, low: int, high: int) -> Term:
        """A number that nothing else knows."""
        self._fresh += 1
        return self.unknown(f"{name}#{self._fresh}", low, high)

    def wrapped(self, base: Term, ahead: Term, mask: int) -> Term:
        """(base + ahead) & mask, of a base and an `ahead` in 0 .. mask.

        Of two numbers with one base only `ahead` is left wherever they are compared.
        """
        return self._term("wrap", (base, ahead, mask), 0, mask)

    # -- between numbers and truths

    def as_number(self, a: Term) -> Term:
        """0 or 1 for a truth."""
        if not a.is_truth:
            return a
        return self.pick(a, self.number(1), self.number(0))

    def as_truth(self, a: Term) -> Term:
        """If a number is not 0."""
        return a if a.is_truth else self.negated(self.same(a, self.number(0)))

    # -- truths

    def negated(self, a: Term) -> Term:
        """The opposite of a truth."""
        if a.opposite is None:
            if a.op == "const":
                return self.truth_of(not a.low)
            a.opposite = self._term("not", (a,), 0, 1, True)
            a.opposite.opposite = a
        return a.opposite

    def all(self, *parts: Term) -> Term:
        """True where all of them hold."""
        return self._joined("all", parts, self.true, self.false)

    def any(self, *parts: Term) -> Term:
        """At least one of them holds."""
        return self._joined("any", parts, self.false, self.true)

    def _joined(self, op: str, parts: Iterable[Term], idle: Term, end: Term) -> Term:
        kept: dict[Term, None] = {}
        for part in parts:
            for one in part.args if part.op == op else (part,):
                assert isinstance(one, Term)
                if one is end or one.opposite in kept:
                    return end
                if one is not idle:
                    kept[one] = None
        if not kept:
            return idle
        if len(kept) == 1:
            return next(iter(kept))
        return self._term(op, tuple(kept), 0, 1, True)

    def implies(self, a: Term, b: Term) -> Term:
        """B holds where a does."""
        return self.any(self.negated(a), b)

    def same(self, a: Term, b: Term) -> Term:
        """True where a equals b."""
        a, b = self.as_number(a), self.as_number(b)
        if a is b or (a.value is not None and a.value == b.value):
            return self.true
        if _one_base(a, b):
            return self.same(_ahead(a), _ahead(b))
        if a.high < b.low or b.high < a.low:
            return self.false
        if b.op != "const" and (a.op == "const" or a.made > b.made):
            a, b = b, a
        if a.op == "pick" and b.op == "const" and a.is_leafy:
            found = self._same.get((a, b))
            if found is None:
                if_, x, y = _terms(a)
                found = self._same[a, b] = self.pick(if_, self.same(x, b), self.same(y, b))
            return found
        return self._term("eq", (a, b), 0, 1, True)

    def less(self, a: Term, b: Term) -> Term:
        """A is less than b."""
        a, b = self.as_number(a), self.as_number(b)
        if a.high < b.low:
            return self.true
        if a is b or a.low >= b.high:
            return self.false
        return self._term("lt", (a, b), 0, 1, True)

    def at_most(self, a: Term, b: Term) -> Term:
        """A is at most b."""
        return self.negated(self.less(b, a))

    def within(self, a: Term, low: int, high: int) -> Term:
        """A lies in a range."""
        return self.all(self.at_most(self.number(low), a), self.at_most(a, self.number(high)))

    def pick(self, if_: Term, a: Term, b: Term) -> Term:
        """A where a truth holds, else b."""
        if a is b or if_ is self.true:
            return a
        if if_ is self.false:
            return b
        if if_.op == "not":
            if_, a, b = if_.args[0], b, a  # type: ignore[assignment]
        if a.op == "pick" and a.args[0] is if_:
            a = a.args[1]  # type: ignore[assignment]
        if b.op == "pick" and b.args[0] is if_:
            b = b.args[2]  # type: ignore[assignment]
        if a is b:
            return a
        if a.is_truth and b.is_truth:
            return self._pick_truth(if_, a, b)
        a, b = self.as_number(a), self.as_number(b)
        if _one_base(a, b):
            ahead = self.pick(if_, _ahead(a), _ahead(b))
            return self.wrapped(a.args[0], ahead, a.args[2])  # type: ignore[arg-type]
        return self._term("pick", (if_, a, b), min(a.low, b.low), max(a.high, b.high))

    def _pick_truth(self, if_: Term, a: Term, b: Term) -> Term:
        if a is self.true:
            return self.any(if_, b)
        if a is self.false:
            return self.all(self.negated(if_), b)
        if b is self.true:
            return self.any(self.negated(if_), a)
        if b is self.false:
            return self.all(if_, a)
        return self._term("pick", (if_, a, b), 0, 1, True)

    def bounded(self, a: Term, low: int, high: int) -> Term:
        """The same term where more is known of its range."""
        if a.op == "pick" and (low > a.low or high < a.high):
            return self._term("pick", a.args, low, high)
        return a

    # -- numbers

    def add(self, a: Term, b: Term) -> Term:
        """The sum of two numbers."""
        if b.value == 0:
            return a
        if a.value == 0:
            return b
        return self._number("add", a, b, a.low + b.low, a.high + b.high)

    def sub(self, a: Term, b: Term) -> Term:
        """The difference of two numbers."""
        if b.value == 0:
            return a
        if a is b:
            return self.number(0)
        return self._number("sub", a, b, a.low - b.high, a.high - b.low)

    def mul(self, a: Term, b: Term) -> Term:
        """The product of two numbers."""
        for one, other in ((a, b), (b, a)):
            if one.value == 0:
                return self.number(0)
            if one.value == 1:
                return other
            if (one.low, one.high) == (0, 1):
                return self.pick(self.as_truth(one), other, self.number(0))
        ends = [x * y for x in (a.low, a.high) for y in (b.low, b.high)]
        return self._number("mul", a, b, min(ends), max(ends))

    def div(self, a: Term, b: Term) -> Term:
        """A // b, rounded down; b is at least 1 wherever it is asked for."""
        if b.value == 1:
            return a
        low, high = max(b.low, 1), max(b.high, 1)
        ends = [x // y for x in (a.low, a.high) for y in (low, high)]
        return self._number("div", a, b, min(ends), max(ends))

    def mod(self, a: Term, b: Term) -> Term:
        """A % b, at least 0; b is at least 1 wherever it is asked for."""
        if b.low >= 1 and a.low >= 0 and a.high < b.low:
            return a
        return self._number("mod", a, b, 0, max(b.high - 1, 0))

    def bits_and(self, a: Term, b: Term) -> Term:
        """The bits that both have."""
        if b.op != "const":
            a, b = b, a
        if b.op == "const" and b.low >= 0:
            mask = b.low
            if a.op == "sub":
                x, y = _terms(a)
                if _one_base(x, y) and x.args[2] == mask:
                    return self.bits_and(self.sub(_ahead(x), _ahead(y)), b)
                if x.op == "wrap" and x.args[0] is y and x.args[2] == mask:
                    return _ahead(x)
            if mask & (mask + 1) == 0 and a.low >= 0 and a.high <= mask:
                return a
            return self._number("and", a, b, 0, mask if a.low < 0 else min(mask, a.high))
        if min(a.low, b.low) >= 0:
            return self._number("and", a, b, 0, min(a.high, b.high))
        low, high = _all_bits(a, b)
        return self._number("and", a, b, low if max(a.low, b.low) < 0 else min(low, 0),
                            max(a.high, b.high, high))  # fmt: skip

    def bits_or(self, a: Term, b: Term) -> Term:
        """The bits that either has."""
        low, high = _all_bits(a, b)
        return self._number("or", a, b, max(a.low, b.low) if min(a.low, b.low) >= 0 else low, high)

    def bits_xor(self, a: Term, b: Term) -> Term:
        """The bits that one of them has."""
        return self._number("xor", a, b, *_all_bits(a, b))

    def shl(self, a: Term, b: Term) -> Term:
        """A << b; b is at least 0 wherever it is asked for."""
        by = max(b.low, 0), max(b.high, 0)
        ends = [x << y for x in (a.low, a.high) for y in by]
        return self._number("shl", a, b, min(ends), max(ends))

    def shr(self, a: Term, b: Term) -> Term:
        """A >> b, rounded down; b is at least 0 wherever it is asked for."""
        by = max(b.low, 0), max(b.high, 0)
        ends = [x >> y for x in (a.low, a.high) for y in by]
        return self._number("shr", a, b, min(ends), max(ends))

    def _number(self, op: str, a: Term, b: Term, low: int, high: int) -> Term:
        if a.op == "const" and b.op == "const":
            return self.number(KNOWN[op](a.low, b.low))
        return self._term(op, (a, b), low, high)


KNOWN: dict[str, Callable[[int, int], int]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "div": lambda a, b: a // b if b else 0,
    "mod": lambda a, b: a % b if b else 0,
    "and": lambda a, b: a & b,
    "or": lambda a, b: a | b,
    "xor": lambda a, b: a ^ b,
    "shl": lambda a, b: a << b if b >= 0 else 0,
    "shr": lambda a, b: a >> b if b >= 0 else 0,
}


def _terms(a: Term) -> tuple[Term, ...]:
    """The terms that a term is made of."""
    return a.args  # type: ignore[return-value]


def _ahead(a: Term) -> Term:
    """How far a number is ahead of its base."""
    return a.args[1]  # type: ignore[return-value]


def _one_base(a: Term, b: Term) -> bool:
    """True if both are counted from the same number."""
    return a.op == b.op == "wrap" and a.args[0] is b.args[0] and a.args[2] == b.args[2]


def _all_bits(a: Term, b: Term) -> tuple[int, int]:
    """What any bits of two numbers make."""
    most = max(a.high, b.high, -a.low - 1, -b.low - 1)
    high = (1 << most.bit_length()) - 1
    return (-high - 1 if min(a.low, b.low) < 0 else 0), high


def _is_leafy(a: Term, b: Term) -> bool:
    """True if what can be picked is a known number, or one of such."""
    return (a.op == "const" and b.is_leafy) or (b.op == "const" and a.is_leafy)
