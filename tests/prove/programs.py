"""Programs of the dialect that are drawn: bodies of f(s, n, m), all of whose loops end."""

import random

# What handlers call to have something done.
ACTIONS = """
def send(out, port, delay_us, flags):
    pass

def deliver(out, kind):
    pass

def set_timer(out, timer, at):
    pass

def report(out, code, a, b):
    pass
"""
HELPERS = """
def bump(s, n):
    s.b = (s.b + 1) % 4
    return s.b


def part(s, n):
    if n > 2:
        s.a = 1
        return n
    s.a = 2


def bare(s, n):
    s.a = n


def look(s, n):
    return s.b and n
"""
NUMBERS = ("n", "m", "s.a", "s.b", "s.list[2]", "s.list[s.b]", "s.list[n & 3]", "True", "-3", "6")
PLACES = ("s.a", "s.b", "s.list[s.b]", "s.list[n & 3]", "s.list[bump(s, n) & 3]", "s.list[m]")
RANGES = ("n", "4", "1, n", "m, 3", "n, 0, -1", "0, 5, 2", "s.b")
SIGNS = ("+", "-", "*", "//", "%", "&", "|", "^", "<<", ">>")


def drawn(seed):
    """The lines of a function's body, the first without its indentation."""
    return "\n".join(Program(seed).lines).strip()


class Program:
    """Draws statements and expressions; names may be used where they have no value yet."""

    def __init__(self, seed):
        self.draw = random.Random(seed)
        self.names = []
        self.loops = 0
        self.lines = [*self.block(3, "    "), f"    return {self.number(2)}"]

    def of(self, *some):
        return self.draw.choice(some)

    def number(self, deep):
        if deep <= 0 or self.draw.random() < 0.3:
            return self.of(*NUMBERS, *self.names, *self.names)
        a, b = self.number(deep - 1), self.number(deep - 1)
        return self.of(
            f"({a} {self.of(*SIGNS)} {b})", f"({a} {self.of(*SIGNS)} {b})",
            f"({self.of('-', '+', '~')}{a})", f"{self.of('min', 'max')}({a}, {b})", f"abs({a})",
            f"({a} if {self.test(deep - 1)} else {b})", f"({a} {self.of('and', 'or')} {b})",
            f"{self.of('bump', 'part', 'look')}(s, {a})", f"({self.test(deep - 1)})",
        )  # fmt: skip

    def test(self, deep):
        a, b, c = (self.number(deep - 1) for _ in range(3))
        one, other = self.of("<", "<=", "=="), self.of("<", "!=", ">=")
        if deep <= 0:
            return f"{a} {one} {b}"
        joined = f"({self.test(deep - 1)} {self.of('and', 'or')} {self.test(deep - 1)})"
        return self.of(f"{a} {other} {b}", f"({a} {one} {b} {other} {c})", joined, f"not {a}", a)

    def block(self, deep, indent):
        return [line for _ in range(self.draw.randint(1, 3)) for line in self.said(deep, indent)]

    def said(self, deep, indent):
        some = [self.set, self.change, self.name, self.call]
        if deep > 0:
            some += [self.branch, self.branch, self.loop, self.leave]
        return [f"{indent}{line}" for line in self.of(*some)(deep)]

    def set(self, _deep):
        return [f"{self.of(*PLACES)} = {self.number(2)}"]

    def change(self, _deep):
        return [f"{self.of(*PLACES)} {self.of('+', '-', '*', '&', '|')}= {self.number(1)}"]

    def name(self, _deep):
        name = self.of("x", "y", "z")
        line = f"{name} = {self.number(2)}"
        self.names.append(name)
        return [line]

    def call(self, _deep):
        return [f"{self.of('bump', 'part', 'bare')}(s, {self.number(1)})"]

    def branch(self, deep):
        lines = [f"if {self.test(2)}:", *self.block(deep - 1, "    ")]
        return [*lines, "else:", *self.block(deep - 1, "    ")] if self.of(0, 1) else lines

    def loop(self, deep):
        if self.loops == 2:
            return self.set(deep)
        self.loops += 1
        name = "ij"[self.loops - 1]
        self.names.append(name)
        lines = [f"for {name} in range({self.of(*RANGES)}):", *self.block(deep - 1, "    ")]
        self.loops -= 1
        return lines

    def leave(self, _deep):
        ways = [f"return {self.number(1)}"] + ["break", "continue"] * bool(self.loops)
        return [f"if {self.test(1)}:", f"    {self.of(*ways)}"]
