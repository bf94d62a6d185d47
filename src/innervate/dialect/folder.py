"""What is wrong with a protocol as it is written: its source, its declarations, its frames.

Nothing is run here but what declares: each finding names a file, a line, and what to write instead.
"""

import ast
from difflib import get_close_matches

from innervate.dialect.checker import broken_rules, functions_of, with_numbers
from innervate.dialect.trees import every_node

MOST = (1 << 30) - 1
OUTBOX = {"action", "count", "frame", "limit", "overflow"}  # what an outbox has
PLACES = frozenset({"x", "y"})  # fields of an item that says where a robot is
UNITS = {"cm": 1, "dm": 10, "m": 100}  # ... in so many cm
MEASURED = {"rssi"}  # fields of a frame that are set by who receives it
NOTED = {"kind", "made_at"} | MEASURED  # those that no layout has to name
# Fields of a frame that a medium looks at, by medium.
LOOKED_AT = {"cables": set(), "channel": {"slots"}, "field": {"to"}}
FIELD = "a field is (name, length, low, high, unit, meaning)"
HANDLERS = {
    "on_start": "(state, params, now, cause, out)",
    "on_frame": "(state, params, now, port, frame, out)",
    "on_timer": "(state, params, now, timer, out)",
    "on_input": "(state, params, now, kind, item, out)",
}
ON_AIR = {"on_carrier": "(state, params, now, cd, voc, out)"}
RULES = {
    "node_": ("(node, params, now)",),
    "network_": ("(nodes, count, params)", "(nodes, count, params, peer)"),
}
MAY = {"on_sent": "(state, params, now, ok, out)"}  # that a protocol need not have


class Finding:
    """One thing that is wrong: `path`, `line` from 1, `text`; as a string in one line.

    `in_plain`: in plain runs it is not.
    """

    __slots__ = ("in_plain", "line", "path", "text")

    def __init__(self, path, line, text, in_plain=False):
        self.path, self.line, self.text, self.in_plain = str(path), line, text, in_plain

    def __str__(self):
        return f"{self.path}:{self.line}: {self.text}"


def of_source(path, known, home, handlers):
    """What is wrong with a file of a protocol.

    Args:
        path: the file.
        known: functions of other files that it may call.
        home: the package that it belongs to.
        handlers: the functions that it must have, with their arguments; {} for other files.
    """
    try:
        text = path.read_text(encoding="utf-8")
        tree = ast.parse(text)
    except SyntaxError as error:
        return [Finding(path, error.lineno or 1, f"is no Python: {error.msg}")]
    except (OSError, UnicodeDecodeError) as error:
        return [Finding(path, 1, f"cannot be read: {error}")]
    found = [Finding(path, one.line, one.what, one.in_plain)
             for one in broken_rules(text, known, home)]  # fmt: skip
    there = {function.name: function for function in functions_of(tree)}
    for name, arguments in (handlers | MAY if handlers else {}).items():
        if name not in there and name in MAY:
            continue
        if name not in there:
            found.append(Finding(path, 1, f"has no {name}; add def {name}{arguments}"))
        elif len(there[name].args.args) != arguments.count(",") + 1:
            what = f"{name} takes {len(there[name].args.args)} arguments; it is {name}{arguments}"
            found.insert(0, Finding(path, there[name].lineno, what))  # names may follow from it
    if handlers and "TIMERS" not in dict(_assigned(tree)):
        found.append(Finding(path, 1, "has no TIMERS; add TIMERS = 1, how many timers a node has"))
    return found


def of_rules(path):
    """Invariants that do not take what they are given, or that nobody looks at."""
    functions, found = functions_of(ast.parse(path.read_text(encoding="utf-8"))), []
    used = {name for function in functions for name in called(function)}
    for function in functions:
        if not function.name.startswith(tuple(RULES)) and function.name not in used:
            what = f"{function.name} is never looked at; begin its name with node_ or network_"
            found.append(Finding(path, function.lineno, what))
        for prefix, allowed in RULES.items():
            given = len(function.args.args)
            fits = given in {arguments.count(",") + 1 for arguments in allowed}
            if function.name.startswith(prefix) and not fits:
                said = " or ".join(f"{function.name}{arguments}" for arguments in allowed)
                what = f"{function.name} takes {given} arguments; it is {said}"
                found.append(Finding(path, function.lineno, what))
    return found


def parsed(path):
    """A file's tree, in which a number of another module is one name: "kinds.DATA"."""
    return with_numbers(ast.parse(path.read_text(encoding="utf-8")))


def constants_of(tree, module=""):
    """Whole numbers that a file names; also by the names that others have for them.

    Args:
        tree: of the file.
        module: what others call the file; "" = they are not to be told.
    """
    found = {}
    for name, value in _assigned(tree):
        found[name] = number(value, found)
    known = {name: value for name, value in found.items() if value is not None}
    return known | {f"{module}.{name}": value for name, value in known.items() if module}


def of_numbers(path, known):
    """Numbers of other modules that these do not have.

    Args:
        path: a file of the protocol.
        known: names of those that there are, "kinds.DATA".
    """
    return [Finding(path, part.lineno, f"{part.id} is no whole number of that module")
            for part in every_node(parsed(path))
            if isinstance(part, ast.Name) and "." in part.id and part.id not in known]  # fmt: skip


def _assigned(tree):
    return [pair for node in tree.body if isinstance(node, ast.Assign)
            for target in node.targets for pair in _pairs(target, node.value)]  # fmt: skip


def _pairs(target, value):
    if isinstance(target, ast.Name):
        return [(target.id, value)]
    if isinstance(target, ast.Tuple) and isinstance(value, ast.Tuple):
        return [pair for one in zip(target.elts, value.elts, strict=False) for pair in _pairs(*one)]
    return []


def number(node, known):
    """The value of an expression over numbers and names that are known; None if it is none."""
    names = {part.id for part in every_node(node) if isinstance(part, ast.Name)}
    odd = (ast.Call, ast.Attribute, ast.Lambda, ast.Subscript)
    if any(known.get(name) is None for name in names):
        return None
    if any(isinstance(part, odd) for part in every_node(node)):
        return None
    try:
        value = eval(compile(ast.Expression(node), "constant", "eval"), {}, dict(known))
    except (TypeError, ValueError, ArithmeticError):
        return None
    return value if isinstance(value, int) else None


def of_fields(path, declared):
    """What is wrong with declarations.

    Args:
        path: the file they stand in.
        declared: (name, fields) of STATE, FRAME and PARAMS.
    """
    lines, found = _lines_of(path), []
    for table, fields in declared:
        seen = set()
        for field in fields:
            name = field[0] if isinstance(field, tuple) and field else "?"
            line = lines.get((table, name), lines.get((table, ""), 1))
            wrong = _wrong_with(field) or ("is declared twice" if name in seen else "")
            seen.add(name)
            if wrong:
                found.append(Finding(path, line, f"{table}: {name} {wrong}"))
    return found


def of_usual(path, tables, params):
    """What is wrong with values for parameters that are left out.

    Args:
        path: the file they stand in.
        tables: (name, {parameter: value}) of DEFAULTS and EXPLORED.
        params: the declared parameters.
    """
    ranges, lines = {field[0]: field[2:5] for field in params}, _lines_of(path)
    found = []
    for table, values in tables:
        for name, value in values.items():
            line = lines.get((table, ""), 1)
            if name not in ranges:
                found.append(Finding(path, line, f"{table}: {name} is no parameter of PARAMS"))
                continue
            low, high, unit = ranges[name]
            each = value if isinstance(value, (list, tuple)) else [value]
            if not all(isinstance(one, int) and low <= one <= high for one in each):
                what = f"{table}: {name} must be {low} to {high} {unit}, not {value}"
                found.append(Finding(path, line, what))
    return found


def of_given(path, given, frame):
    """What is wrong with what the explorer hands to nodes: (kind, {field: value}) of each."""
    ranges, line = {field[0]: field[2:4] for field in frame}, _lines_of(path).get(("GIVEN", ""), 1)
    shape = "GIVEN is (kind, item) of each: ((1, {}),)"
    if not isinstance(given, (list, tuple)):
        return [Finding(path, line, shape)]
    found = []
    for one in given:
        if not (isinstance(one, (list, tuple)) and len(one) == 2
                and isinstance(one[0], int) and isinstance(one[1], dict)):  # fmt: skip
            return [Finding(path, line, shape)]
        for name, value in one[1].items():
            each = value if isinstance(value, (list, tuple)) else [value]
            low, high = ranges.get(name, (0, 0))
            if name not in ranges:
                found.append(Finding(path, line, f"GIVEN: {name} is no field of FRAME"))
            elif not all(isinstance(one, int) and low <= one <= high for one in each):
                what = f"GIVEN: {name} must be {low} to {high}, not {value}"
                found.append(Finding(path, line, what))
    return found


def of_messages(path, kinds):
    """What is wrong with the kinds of inputs that are messages."""
    if isinstance(kinds, (list, tuple)) and all(isinstance(one, int) for one in kinds):
        return []
    line = _lines_of(path).get(("MESSAGES", ""), 1)
    return [Finding(path, line, "MESSAGES is the kinds of inputs that are to be delivered: (1,)")]


def of_placed(path, kind, frame):
    """What is wrong with the kind of inputs by which robots are told where they are."""
    units = {field[0]: field[4] for field in frame if field[0] in PLACES and not field[1]}
    if isinstance(kind, int) and len(units) == 2 and len(set(units.values()) & UNITS.keys()) == 1:
        return []
    line = _lines_of(path).get(("PLACED", ""), 1)
    what = "PLACED is a kind of input, whose x and y in FRAME are both in cm, dm or m: 2"
    return [Finding(path, line, what)]


def of_taken(path, fields, taken, table="PARAMS"):
    """Fields of a table that have a name of the medium's own, and would take its value's place."""
    lines = _lines_of(path)
    return [Finding(path, lines.get((table, name), 1),
                    f"{table}: {name} is a word of the medium's own; choose another name")
            for name, *_ in fields if name in taken]  # fmt: skip


def _wrong_with(field):
    if not isinstance(field, tuple) or len(field) != 6:
        return f"is not whole: {FIELD}"
    name, length, low, high, unit, meaning = field
    if not (isinstance(name, str) and name.isidentifier()):
        return "is no name"
    if not all(isinstance(one, int) for one in (length, low, high)):
        return f"has a length or range that is no whole number: {FIELD}"
    if length < 0:
        return "has a length below 0; 0 is a single number"
    if max(abs(low), abs(high)) > MOST:
        return f"has a range beyond 2^30: {low} to {high}; all values stay below"
    if low > high:
        return f"has a range from {low} to {high}; put the lower first"
    if not (isinstance(unit, str) and isinstance(meaning, str)):
        return f"lacks its unit or meaning: {FIELD}"
    return ""


def _lines_of(path):
    """Lines of declared fields by (table, name); of tables by (table, "")."""
    found = {}
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
            table = node.targets[0].id
            found[table, ""] = node.lineno
            for part in every_node(node.value):
                if isinstance(part, ast.Tuple) and part.elts:
                    first = part.elts[0]
                    if isinstance(first, ast.Constant) and isinstance(first.value, str):
                        found.setdefault((table, first.value), part.lineno)
    return found


def of_layouts(path, layouts, kind_bits, frame, looked_at=frozenset(), unsent=frozenset()):
    """What is wrong with the layouts of frames: bits that do not hold what is declared.

    Args:
        path: the file they stand in.
        layouts: (kind, name, ((field, many, bits, signed), ...)) of each.
        kind_bits: bits of the kind.
        frame: the declared fields of a frame.
        looked_at: fields that the medium looks at.
        unsent: fields that nodes are only handed.
    """
    declared = {field[0]: field for field in frame}
    line, found, laid = _lines_of(path).get(("LAYOUTS", ""), 1), [], set()
    names = {}
    for kind, name, fields in layouts:
        if kind in names:
            what = f"{names[kind]} and {name} are both of kind {kind}; give one another number"
            found.append(Finding(path, line, what))
        names.setdefault(kind, name)
        if not 0 <= kind < 1 << kind_bits:
            what = f"kind {kind} of {name} does not fit into KIND_BITS = {kind_bits}"
            found.append(Finding(path, line, what))
        for field, many, bits, is_signed in fields:
            laid.add(field)
            wrong = _wrong_layout(declared, field, many, bits, is_signed) if field else ""
            if wrong:
                found.append(Finding(path, line, f"{name}: {wrong}"))
        for field in sorted(looked_at & declared.keys() - {one[0] for one in fields}):
            what = f"{name}: the medium looks at {field}; give it bits in every layout"
            found.append(Finding(path, line, what))
        for field, _length, low, high, *_ in frame:
            if field not in NOTED.union(one[0] for one in fields) and not low <= 0 <= high:
                what = (f"{name}: {field} is {low} to {high} in FRAME, and 0 where it arrives, as "
                        "it has no bits here; give it some, or let it be 0")  # fmt: skip
                found.append(Finding(path, line, what))
    for field in declared:
        if field not in laid | NOTED | unsent:
            what = (f"no frame carries {field} of FRAME; give it bits in LAYOUTS or leave it out "
                    "(what users hand in, and nobody sends, stands in GIVEN)")  # fmt: skip
            found.append(Finding(path, line, what))
    return found


def _wrong_layout(declared, field, many, bits, is_signed):
    if field not in declared:
        return f"{field} is no field of FRAME; declare it in fields.py"
    if isinstance(many, str) or many < 0 or not isinstance(bits, int):
        return f"{field} is of variable number; a frame that is declared has a fixed length"
    _name, length, low, high, *_ = declared[field]
    if many != length:
        return f"{field} has {many} here and length {length} in FRAME; make them equal"
    least = -(1 << (bits - 1)) if is_signed else 0
    most = least + (1 << bits) - 1
    if low < least or high > most:
        return f"{field} is {low} to {high} in FRAME; {bits} bits hold {least} to {most}"
    return ""


def of_uses(path, declared, timers, arrays=frozenset()):
    """Fields that are not declared or set as what they are not, and timers that a node lacks.

    Args:
        path: a file of the protocol.
        declared: names of all declared fields.
        timers: how many timers a node has.
        arrays: of those declared, which have a length.
    """
    tree = parsed(path)
    constants, found = constants_of(tree), []
    modules = {alias.asname or alias.name for node in every_node(tree)
               if isinstance(node, (ast.Import, ast.ImportFrom))
               for alias in node.names}  # fmt: skip
    for part in every_node(tree):
        if isinstance(part, ast.Attribute) and part.attr not in declared | OUTBOX:
            if not (isinstance(part.value, ast.Name) and part.value.id in modules):
                near = "".join(f'; did you mean "{one}"?'
                               for one in get_close_matches(part.attr, declared, 1))  # fmt: skip
                what = f"{part.attr} is no field that fields.py declares{near}"
                found.append(Finding(path, part.lineno, what))
        if isinstance(part, ast.Attribute) and isinstance(part.ctx, ast.Store):
            if part.attr in arrays:
                what = f"{part.attr} has a length; set its places one by one, {part.attr}[i]"
                found.append(Finding(path, part.lineno, what))
        is_set = isinstance(part, ast.Call) and getattr(part.func, "id", "") == "set_timer"
        timer = number(part.args[1], constants) if is_set and len(part.args) > 1 else None
        if timer is not None and not 0 <= timer < timers:
            what = f"sets timer {timer}, and TIMERS = {timers}; write TIMERS = {timer + 1}"
            found.append(Finding(path, part.lineno, what))
    return list({str(one): one for one in found}.values())


def called(node):
    """Names of the functions that are called in a piece of source."""
    return {part.func.id for part in every_node(node)
            if isinstance(part, ast.Call) and isinstance(part.func, ast.Name)}  # fmt: skip
