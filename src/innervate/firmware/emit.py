"""A role as C: the texts of one header and one source."""

import ast
import hashlib
from collections.abc import Mapping
from typing import Any

from innervate.dialect import outbox
from innervate.firmware.constants import names_of, note_of
from innervate.firmware.errors import FirmwareError
from innervate.firmware.expressions import Expressions, local
from innervate.firmware.facts import Facts
from innervate.firmware.helpers import HELPERS, own
from innervate.firmware.outbox import Outbox
from innervate.firmware.program import Made, Program, Type
from innervate.firmware.records import initial, name_of, records_of, struct
from innervate.firmware.statements import Statements, comment, declaration, wrapped
from innervate.firmware.texts import filled, shipped
from innervate.live.board import Role

ABI = 3  # counts changes of what stands in headers and how it is called
MEANINGS = {
    "state": "What a node keeps.",
    "gate": "What a node has besides that leads, or may have to.",
    "params": "Parameters, the same on all nodes.",
    "frame": "A frame, as it goes over a port.",
    "item": "What the node's user hands down.",
    "action": "What a handler wants done.",
}


class Library:
    """A role as C; `prefix` stands in front of all names, the role's own if left out.

    Raises:
        FirmwareError: it is outside the dialect, or a parameter is missing.
    """

    def __init__(self, role: Role, params: Mapping[str, Any], prefix: str = "") -> None:
        self.role, self.params = role, params
        self.prefix = prefix or name_of(role.name)
        self.records = records_of(role)
        self.program = Program(role, self.records)
        self.facts = Facts(self.program)
        self.outbox = Outbox(self.prefix, role, self.records)
        self.types = self._types()
        names = names_of((made.function for made in self.program.functions()), self.prefix)
        self.constants: dict[str, tuple[int, str]] = {}
        helpers: set[str] = set()
        self.bodies: dict[Made, list[str]] = {}
        for made in self.program.functions():
            expressions = Expressions(self.program, self.facts, made, names)
            self.bodies[made] = Statements(expressions, self.types).body()
            helpers |= expressions.helpers
            for name, value in expressions.constants.items():
                known = names[f"{made.function.module}.{name}"]
                self.constants[known] = (value, note_of(made.function.module, name))
        for name in ("SEND", "SET_TIMER", "DELIVER", "REPORT", "URGENT", "FLUSH"):
            always = (int(getattr(outbox, name)), note_of(outbox.__name__, name))
            self.constants.setdefault(f"{self.prefix.upper()}_{name}", always)
        self.helpers = helpers | {
            helper for name in helpers & set(HELPERS) for helper in HELPERS[name]
        }

    def _types(self) -> dict[Type, str]:
        """What C calls the types of variables."""
        found = {Type("int"): "int32_t", Type("out"): f"{self.prefix}_out_t *"}
        for record in self.records:
            found[Type(record)] = f"{self.prefix}_{record}_t *"
        for made in self.program.functions():
            for kind in made.types.values():
                if kind.field is not None:
                    found[kind] = f"{kind.field.type} *"
        return found

    @property
    def own_files(self) -> tuple[str, str]:
        """The names of the two files that a library is."""
        return f"{self.prefix}.h", f"{self.prefix}.c"

    def digest(self) -> str:
        """A hash of the functions as they are written, and of all declarations: 16 digits."""
        hashed = hashlib.blake2b(digest_size=8)
        for name, function in self.program.sources.items():
            hashed.update(f"{name}\n{ast.unparse(function.node)}\n".encode())
        for record, fields in self.records.items():
            hashed.update(f"{record}\n{list(fields.values())}\n".encode())
        return hashed.hexdigest()

    def header(self) -> str:
        """The text of the header."""
        role = self.role
        having = {"timers": role.timers, "nodes": role.nodes}
        words = {f"@{name}": str(having[name]) for name in having}
        parts = [self._constants(), *self._structs(), self._public()]
        words |= {"@abi": str(ABI), "@digest": self.digest(), "@room": str(role.room),
                  "@outbox": self.outbox.size(), "@parts": "\n".join(parts)}  # fmt: skip
        return self._filled("made/protocol.h", words, {name for name in having if having[name]})

    def _filled(self, file: str, words: dict[str, str], having: set[str]) -> str:
        text = shipped(file, self.prefix, frozenset(having))
        return filled(text, {"@name": self.role.name, "@entry": self.role.entry} | words)

    def _constants(self) -> str:
        lines = []
        for name, (value, note) in sorted(self.constants.items()):
            number = f"({value})" if value < 0 else f"{value}"
            lines += [f"#define {name} {number}" + (f" /* {note} */" if note else "")]
        return "\n".join(lines) + "\n"

    def _structs(self) -> list[str]:
        small = self.prefix
        made = [
            struct(f"{small}_{record}_t", fields, MEANINGS[record])
            for record, fields in self.records.items()
        ]
        if "frame" not in self.records:
            made.append(f"/** Handlers look into no frame. */\ntypedef void {small}_frame_t;\n")
        if "item" not in self.records and "frame" in self.records:
            made.append(f"typedef {small}_frame_t {small}_item_t; /* what its user hands down */\n")
        return [*made, self.outbox.text("struct")]

    def _public(self) -> str:
        lines = [shipped("made/public.h", self.prefix, frozenset(self.records))]
        for made in self.program.handlers:
            lines += [*self._comment(made), self._head(made) + ";", ""]
        return "\n".join(lines)

    def _comment(self, made: Made) -> list[str]:
        function = made.function
        where = f"{function.module.replace('.', '/')}.py:{function.node.lineno}"
        said = ast.get_docstring(function.node) or ""
        parts = [" ".join(part.split()) for part in said.split("\n\n")]
        lines: list[str] = []
        for part in parts:
            lines += [line.replace("/*", " *", bool(lines)).removesuffix(" */") for line in
                      comment(part, "")]  # fmt: skip
        return [*lines, f" * {where} */"]

    def _head(self, made: Made) -> str:
        """The line that a function begins with."""
        arguments = []
        for name in made.arguments:
            kind = made.types[name]
            text = self._argument(made, name, kind)
            arguments.append(declaration(text, local(name)))
        returns = {"none": "void", "int": "int32_t"}.get(made.returns.what)
        returns = returns or self.types[made.returns]
        static = "" if made in self.program.handlers else "static "
        text = declaration(f"{static}{returns}", f"{self.prefix}_{made.name}")
        return "\n".join(wrapped(f"{text}({', '.join(arguments)})"))

    def _argument(self, made: Made, name: str, kind: Type) -> str:
        if kind.what == "frame" and "frame" not in self.records:
            return f"const {self.prefix}_frame_t *"
        text = self.types[kind]
        constant = kind.is_pointer and name not in made.changed and kind.what != "out"
        if made in self.program.handlers and kind.what in ("state", "gate"):
            constant = False
        return f"const {text}" if constant else text

    def texts(self) -> dict[str, str]:
        """The texts of the two files that a library is, by file."""
        return dict(zip(self.own_files, (self.header(), self.source()), strict=True))

    def source(self) -> str:
        """The text of the source."""
        prefix = self.prefix
        helpers = [shipped("made/helpers.c", prefix, frozenset({name})) for name in HELPERS
                   if name in self.helpers]  # fmt: skip
        helpers += [self.outbox.text("give")] if "frame" in self.helpers else []
        functions = []
        for made, body in self.bodies.items():
            lines = [*self._comment(made), self._head(made), "{", *body, "}", ""]
            functions.append("\n".join(lines))
        beginning = [*self._defaults(), own(self.prefix, self.records), self.outbox.text("own")]
        text = "\n".join([*helpers, *beginning, *functions])
        words = {"@header": self.own_files[0], "@functions\n": text}
        return self._filled("made/protocol.c", words, set())

    def _defaults(self) -> list[str]:
        small = self.prefix
        lines = [f"const {small}_params_t {small}_defaults = {{"]
        for field in self.records["params"].values():
            value = self.params.get(field.name, initial(field))
            numbers = value if isinstance(value, list | tuple) else [value]
            if any(not field.low <= number <= field.high for number in numbers):
                what = f"{field.name}={value} is not in {field.low}..{field.high}"
                raise FirmwareError(f"{self.role.name}: parameter {what}")
            text = ", ".join(map(str, numbers))
            lines += wrapped(f"    {{{text}}}," if field.length else f"    {text},")
            lines[-1] += f" /* {field.name} */"
        return [*lines, "};", ""]
