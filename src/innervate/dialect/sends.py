"""What is wrong with what a protocol sends and reports, as it is written; see folder.py."""

import ast

from innervate.dialect.access import REPORT_DELIVERED, REPORT_LEFT
from innervate.dialect.checker import functions_of
from innervate.dialect.folder import NOTED, Finding, called, constants_of, number, parsed
from innervate.dialect.trees import every_node


def of_channel(paths):
    """Reports that a channel takes for its own."""
    found = []
    for path in paths:
        tree = parsed(path)
        for name, value in constants_of(tree).items():
            if name.startswith("REPORT_") and value in (REPORT_DELIVERED, REPORT_LEFT):
                line = next(node.lineno for node in tree.body if name in _names(node))
                what = f"{name} = {value} is a report of the channel's own; choose another number"
                found.append(Finding(path, line, what))
    return found


def _names(node):
    return {part.id for part in every_node(node) if isinstance(part, ast.Name)}


LATER = "only over cables a frame leaves later; send it from on_timer"


def of_delays(paths, what=LATER):
    """Frames that are to leave later, where only cables can do that, or not even these."""
    found = []
    for path in paths:
        tree = parsed(path)
        constants = constants_of(tree)
        for part in every_node(tree):
            is_sent = isinstance(part, ast.Call) and getattr(part.func, "id", "") == "send"
            if is_sent and len(part.args) > 2 and number(part.args[2], constants) != 0:
                found.append(Finding(path, part.lineno, what))
    return found


def of_kinds(paths, layouts):
    """Frames that a protocol sends of a kind that has no layout, or with what it has no room for.

    Args:
        paths: the files of the protocol.
        layouts: by kind, the fields that its layout has.
    """
    trees = [(path, parsed(path)) for path in paths]
    every = {name: value for path, tree in trees
             for name, value in constants_of(tree, path.stem).items()}  # fmt: skip
    functions = [(path, function, every | _renamed(tree, every))
                 for path, tree in trees for function in functions_of(tree)]  # fmt: skip
    sent, found = _sent_names([function for _, function, _ in functions]), []
    for path, function, constants in functions:
        handed = [one.arg for one in function.args.args]
        kinds = {}
        for part, frame, field in _set_in(function):
            if field != "kind" or frame not in sent[function.name]:
                continue
            value = number(part.value, constants)
            kinds.setdefault(frame, set()).add(value)
            is_blank = value == 0 and frame in handed  # whoever handed it on says more
            if value not in {None, *layouts} and not is_blank:
                what = f"a frame of kind {value} is sent, and has no layout; add one to LAYOUTS"
                found.append(Finding(path, part.lineno, what))
        own = _sent_here(function)
        found += _without_kind(path, function, own - kinds.keys(), layouts)
        for part, frame, field in _set_in(function):
            of = kinds.get(frame, {None}) if frame in own else {None}
            if field in NOTED or number(part.value, constants) == 0:
                continue
            if of <= layouts.keys() and not any(field in layouts[kind] for kind in of):
                what = f"{field} has no bits in the layout of kind {min(of)}, and is not sent"
                found.append(Finding(path, part.lineno, what))
    return found


def of_ends(path, ends, frame):
    """What is wrong with ENDS of a file: two fields of a frame, and the number that is all."""
    names, what = {"", *(field[0] for field in frame)}, ""
    if not isinstance(ends, tuple) or len(ends) != 3 or not isinstance(ends[2], int):
        what = (
            'ENDS is (field of the sender, of the recipient, number of all): ("src", "to", 65535)'
        )
    elif unknown := [name for name in ends[:2] if name not in names]:
        what = f"ENDS: {unknown[0]} is no field of FRAME"
    tree = ast.parse(path.read_text(encoding="utf-8"))
    line = next((node.lineno for node in tree.body if "ENDS" in _names(node)), 1)
    return [Finding(path, line, what)] if what else []


def put_in(paths):
    """Fields that some function of these files puts into a frame that is sent."""
    functions = [function for path in paths for function in functions_of(parsed(path))]
    sent = _sent_names(functions)
    return {field for function in functions for _, frame, field in _set_in(function)
            if frame in sent[function.name]}  # fmt: skip


def _renamed(tree, constants):
    """Constants by other names that a file gives them, or their modules: `import sizes as s`."""
    renamed = [(alias.name.rpartition(".")[2], alias.asname) for node in every_node(tree)
               if isinstance(node, (ast.Import, ast.ImportFrom))
               for alias in node.names if alias.asname]  # fmt: skip
    return {f"{here}{name[len(there):]}": value for there, here in renamed
            for name, value in constants.items() if name.partition(".")[0] == there}  # fmt: skip


def _set_in(function):
    """(assignment, name of the record, field) of every field that a function sets."""
    for part in every_node(function):
        target = part.targets[0] if isinstance(part, ast.Assign) else None
        target = target.value if isinstance(target, ast.Subscript) else target
        if isinstance(target, ast.Attribute) and isinstance(target.value, ast.Name):
            yield part, target.value.id, target.attr


def _sent_here(function):
    """What a function calls frames that it sends, where it calls nothing else so."""
    named = [(part.targets[0].id, part.value) for part in every_node(function)
             if isinstance(part, ast.Assign) and isinstance(part.targets[0], ast.Name)]  # fmt: skip
    others = {name for name, value in named
              if not (isinstance(value, ast.Subscript) and "send" in called(value))}  # fmt: skip
    return {name for name, _ in named} - others


def _without_kind(path, function, frames, layouts):
    """Frames of a function that nobody gives a kind."""
    if 0 in layouts:
        return []
    fields = {id(part.value) for part in every_node(function) if isinstance(part, ast.Attribute)}
    on = {part.id for part in every_node(function) if isinstance(part, ast.Name)
          and isinstance(part.ctx, ast.Load) and id(part) not in fields}  # fmt: skip
    return [Finding(path, part.lineno, f"{part.targets[0].id} is sent without a kind; set one")
            for part in every_node(function) if isinstance(part, ast.Assign)
            and getattr(part.targets[0], "id", None) in frames - on]  # fmt: skip


def _sent_names(functions):
    """By function, what it calls frames that are sent: its own, and those that it is handed."""
    sent = {
        function.name: {part.targets[0].id for part in every_node(function)
                        if isinstance(part, ast.Assign) and isinstance(part.targets[0], ast.Name)
                        and "send" in called(part.value)}
        for function in functions
    }  # fmt: skip
    arguments = {function.name: [one.arg for one in function.args.args] for function in functions}
    calls = [(function.name, call) for function in functions for call in every_node(function)
             if getattr(getattr(call, "func", None), "id", "") in arguments]  # fmt: skip
    for _ in functions:  # as far as a frame can be handed on
        for name, call in calls:
            for argument, given in zip(arguments[call.func.id], call.args, strict=False):
                if getattr(given, "id", "") in sent[name] or "send" in called(given):
                    sent[call.func.id].add(argument)
    return sent
