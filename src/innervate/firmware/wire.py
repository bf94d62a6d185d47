"""Frames on the wire in C: an encoder and a decoder from the same layouts as Python's."""

from collections.abc import Callable
from functools import partial
from typing import Any

from innervate.firmware.emit import Library
from innervate.firmware.errors import FirmwareError
from innervate.firmware.payloads import cases
from innervate.firmware.records import name_of
from innervate.firmware.texts import filled, shipped
from innervate.live.board import Coded, Form, Role
from innervate.network import Network
from innervate.wire.frames import REASONS
from innervate.wire.layout import REST, SPARE, is_fixed, width

CRC_BYTES = 2


def coded_of(role: Role, network: Network) -> Coded | None:
    """How a role's frames lie on the wire; None = it looks into none, or has a coder of its own.

    Raises:
        FirmwareError: fields of variable number that nobody says more of.
    """
    if role.coded is not None or not role.frame or not hasattr(network.frames, "KIND_BITS"):
        return role.coded
    frames = network.frames
    shared: dict[Any, dict[int, str]] = {}
    for kind, name, fields in frames.LAYOUTS:
        if not is_fixed(fields):
            raise FirmwareError(f"{network.name}: a {name} has fields of variable number")
        shared.setdefault(fields, {})[kind] = name
    forms = tuple(Form(kinds, fields) for fields, kinds in shared.items())
    bytes_max = max((frames.KIND_BITS + width(form.fields) + 7) // 8 for form in forms)
    clears = not hasattr(frames, "encode")  # as wire.frames.Codec does
    size_max = bytes_max + CRC_BYTES
    return Coded((0, 0), frames.KIND_BITS, forms, REASONS, size_max, clears=clears)


class Wire:
    """The coder of a role; `payload_max`: bytes of payloads that are none of the record's."""

    def __init__(self, library: Library, coded: Coded, payload_max: int = 0) -> None:
        self.library, self.prefix, self.coded = library, library.prefix, coded
        self.big = self.prefix.upper()
        self.head_bits = coded.version[1] + coded.kind_bits
        self.has_payload = any(form.has_payload for form in coded.forms)
        self.payload_max = payload_max
        smallest = min(self._bytes(form) for form in coded.forms)
        self.size_min = 1 if coded.alone else smallest

    def _bytes(self, form: Form) -> int:
        """Bytes of a frame of this form, but for arrays of variable number."""
        return (self.head_bits + width(form.fields) + 7) // 8 + CRC_BYTES

    def texts(self) -> dict[str, str]:
        """The texts of the coder's two files, by file."""
        name = f"{self.prefix}_wire"
        return {f"{name}.h": self.header(), f"{name}.c": self.source()}

    def header(self) -> str:
        """The text of the coder's header."""
        names = ["OK", *(f"BAD_{word.upper()}" for word in self.coded.reasons[1:])]
        reasons = [f"#define {self.big}_{name} {i}" for i, name in enumerate(names)]
        words = {"@size_max": f"{self.coded.size_max}", "@size_min": f"{self.size_min}",
                 "@reasons": "\n".join(reasons)}  # fmt: skip
        if self.has_payload:
            at = next(self._bytes(f) for f in self.coded.forms if f.has_payload) - CRC_BYTES
            words |= {"@size_max": f"({self.coded.size_max} + {self.big}_PAYLOAD_MAX)",
                      "@payload_max": f"{self.payload_max}", "@payload_at": f"{at}"}  # fmt: skip
        return self._filled("made/wire.h", words)

    def source(self) -> str:
        """The text of the coder's source."""
        coded, alone = self.coded, self.coded.alone
        version, version_bits = coded.version
        words: dict[str, Any] = {
            "@cases": "\n".join(cases(coded)), "@kind_mask": (1 << coded.kind_bits) - 1,
            "@flags_at": self.head_bits // 8, "@lead": coded.lead, "@trail": coded.trail,
            "@more": " + count" if self.has_payload else "",
            "@nothing": "count" if self.has_payload else 0,
            "@version_bits": version_bits, "@version": version, "@from": version_bits,
            "@kind_bits": coded.kind_bits, "@kind_type": self._type("kind"),
            "@least": min(self._bytes(form) for form in coded.forms),
            "@sizes": self._switch("frame->kind", self._size, "return 0;"),
            "@puts": self._switch("frame->kind", partial(self._fields, self._put), "break;"),
            "@gets": self._switch("frame->kind", partial(self._fields, self._get), "break;"),
            "@lengths": self._switch(f"innervate_get(data, &at, {coded.kind_bits})", self._lengths,
                                     f"return {self.big}_BAD_KIND;"),
        }  # fmt: skip
        if alone:
            values = {"kind": alone[1], **alone[2]}
            fields = [f"        frame->{name_of(n)} = {v};" for n, v in values.items()]
            words |= {"@alone_byte": alone[0], "@alone_kind": alone[1],
                      "@alone_fields": "\n".join(fields)}  # fmt: skip
        return self._filled("made/wire.c", words)

    def _filled(self, file: str, words: dict[str, Any]) -> str:
        coded = self.coded
        having = {"payload": self.has_payload, "alone": coded.alone, "version": coded.version[1],
                  "payloads": any(form.payloads for form in coded.forms),
                  "lead": coded.lead, "trail": coded.trail}  # fmt: skip
        given = "const uint8_t *payload, int32_t count,\n        " if self.has_payload else ""
        text = shipped(file, self.prefix, frozenset(name for name in having if having[name]))
        return filled(text, {"@given": given} | {word: str(words[word]) for word in words})

    def _switch(self, what: str, inside: Callable[[Form], list[str]], other: str) -> str:
        """A switch by the kind, with a case for each form."""
        found = [f"    switch ({what}) {{"]
        for form in self.coded.forms:
            found += [f"    case {kind}: /* {name} */" for kind, name in form.kinds.items()]
            found += [f"        {line}" for line in inside(form)]
        return "\n".join([*found, "    default:", f"        {other}", "    }"])

    def _size(self, form: Form) -> list[str]:
        limits = [f"frame->{name_of(self._counter(form, name))} > {most}"
                  for name, (most, _) in form.most.items()]  # fmt: skip
        counters = [self._counter(form, name) for name, many, *_ in form.fields
                    if name != SPARE and _varies(many)]  # fmt: skip
        more = "".join(f" + frame->{name_of(counter)}" for counter in counters)
        size = f"{self._bytes(form)}{more}"
        if not more:
            return [f"return {size};"]
        tests = " || ".join([*limits, f"{size} > {self.big}_SIZE_MAX"])
        return [f"if ({tests}) {{", "    return 0;", "}", f"return {size};"]

    @staticmethod
    def _counter(form: Form, array: str) -> str:
        """The field that says how many an array has."""
        many = next(field[1] for field in form.fields if field[0] == array)
        return form.length if many == REST else str(many)

    def _lengths(self, form: Form) -> list[str]:
        """What says whether a frame of a form is as long as it has to be."""
        big, fixed = self.big, self._bytes(form)
        counted = [f for f in form.fields if isinstance(f[1], str)]
        if form.has_payload:
            return [f"return size < {fixed} ? {big}_BAD_LENGTH : {big}_OK;"]
        if not counted and not form.length:
            return [f"return size == {fixed} ? {big}_OK : {big}_BAD_LENGTH;"]
        lines = [f"size -= {fixed}; /* what is more than its fixed fields */",
                 "if (size < 0) {", f"    return {big}_BAD_LENGTH;", "}"]  # fmt: skip
        for name, counter, _, _ in counted:
            byte = (self.head_bits + _bits_before(form.fields, counter)) // 8
            most, why = form.most[name]
            lines += [f"if (data[{byte}] > {most}) {{", f"    return {big}_BAD_{why.upper()};", "}",
                      f"size -= data[{byte}];"]  # fmt: skip
        rest = next(name for name, many, *_ in form.fields if many == REST)
        tests = [
            *(["size < 0"] if counted else []),
            *([f"size > {form.most[rest][0]}"] if rest in form.most else []),
        ]
        tests += [f"size % {form.step} != 0"] if form.step > 1 else []
        lines += [f"if ({' || '.join(tests)}) {{", f"    return {big}_BAD_LENGTH;", "}"]
        if not form.payloads:
            return [*lines, f"return {big}_OK;"]
        front = "".join(f" + data[{(self.head_bits + _bits_before(form.fields, c)) // 8}]"
                        for _, c, _, _ in counted)  # fmt: skip
        lines += [f"at = {fixed - CRC_BYTES}{front};",
                  f"return {self.prefix}_fits(data, at, at + size) ? {big}_OK "
                  f": {big}_BAD_PAYLOAD;"]  # fmt: skip
        return lines

    def _type(self, name: str) -> str:
        return self.library.records["frame"][name].type

    def _fields(self, line: Any, form: Form) -> list[str]:
        """What writes or reads all fields of a form."""
        found = []
        if form.has_payload and line == self._put:
            behind = ["for (int32_t i = 0; i < count; i++) {",
                      "    innervate_put(&place, 8, payload[i]);", "}"]  # fmt: skip
        else:
            behind = [f"frame->{name_of(to)} = frame->{name_of(frm)};"
                      for to, frm in form.same.items() if line == self._get]  # fmt: skip
        if self.coded.clears and line == self._get:
            found += self._clears(form)
        for name, many, bits, is_signed in form.fields:
            found += line(form, name, many, (bits, is_signed))
        return [*found, *behind, "break;"]

    def _clears(self, form: Form) -> list[str]:
        """What makes 0 that only other forms have."""
        own = {SPARE, *(name for name, *_ in form.fields)}
        others = {name: many for other in self.coded.forms for name, many, *_ in other.fields}
        return [line for name, many in others.items() if name not in own
                for line in self._each(form, name, many, "{place} = 0;")]  # fmt: skip

    def _put(self, form: Form, name: str, many: Any, how: tuple[int, int]) -> list[str]:
        bits = how[0]
        if name == SPARE:
            return [f"place.at += {bits};"]
        put = f"innervate_put(&place, {bits}, {{place}});"
        if not self.library.role.wide:
            return self._each(form, name, many, put)
        low = -(1 << (bits - 1)) if how[1] else 0
        high = low + (1 << bits) - 1  # 31 bits at most, so this is a number of C
        test = f"if ({{place}} < {low} || {{place}} > {high}) {{{{"
        unfit = [test, f"    return -{1 + names_of(self.coded).index(name)};", "}}"]
        return self._each(form, name, many, *unfit, put)

    def _get(self, form: Form, name: str, many: Any, how: tuple[int, int]) -> list[str]:
        bits, is_signed = how
        if name == SPARE:
            return [f"at += {bits};"]
        call = "innervate_get_signed" if is_signed else "innervate_get"
        text = f"{{place}} = ({self._type(name)}){call}(data, &at, {bits});"
        front = []
        if many == REST:
            kind = self._type(form.length)
            front = [f"frame->{name_of(form.length)} = "
                     f"({kind})(size - {CRC_BYTES} - (at >> 3));"]  # fmt: skip
        return front + self._each(form, name, many, text)

    def _each(self, form: Form, name: str, many: Any, *lines: str) -> list[str]:
        place = f"frame->{name_of(name)}"
        if not many:
            return [line.format(place=place) for line in lines]
        count = many
        if _varies(many):
            count = f"frame->{name_of(self._counter(form, name))}"
        return [f"for (int32_t i = 0; i < {count}; i++) {{",
                *(f"    {line.format(place=f'{place}[i]')}" for line in lines), "}"]  # fmt: skip


def names_of(coded: Coded) -> list[str]:
    """The fields of all its frames; a wide role's encoder gives -1 - i where one has no bits."""
    return list(dict.fromkeys(name for form in coded.forms for name, *_ in form.fields))


def _varies(many: Any) -> bool:
    """True if a field has a variable number."""
    return many == REST or isinstance(many, str)


def _bits_before(fields: tuple[Any, ...], name: str) -> int:
    """Bits in front of a field."""
    at = next(i for i, field in enumerate(fields) if field[0] == name)
    return width(fields[:at])
