"""JSON schemas of what a recording (MCAP) holds.

`foxglove.*` are subsets of Foxglove's well-known schemas, by whose names its panels know what to
draw (docs.foxglove.dev/docs/sdk/schemas); a row of a table has a schema made from its columns.
Foxglove reads plain schemas only: one type each, lists whose items are described. What is null in
a table is left out of its message.
"""

from typing import Any

from innervate.trace.tables import Table

Schema = dict[str, Any]

NUMBER: Schema = {"type": "number"}
WHOLE: Schema = {"type": "integer"}
TEXT: Schema = {"type": "string"}
FLAG: Schema = {"type": "boolean"}


def record(title: str, description: str = "", **properties: Schema) -> Schema:
    """A schema of an object that has all of these properties and no others."""
    made: Schema = {"title": title, "type": "object"}
    if description:
        made["description"] = description
    required = list(properties)
    return made | {
        "properties": properties, "required": required, "additionalProperties": False
    }  # fmt: skip


def array(items: Schema) -> Schema:
    """A schema of a list."""
    return {"type": "array", "items": items}


TIME = record("time", sec=WHOLE, nsec=WHOLE)
DURATION = record("duration", sec=WHOLE, nsec=WHOLE)
VECTOR = record("foxglove.Vector3", x=NUMBER, y=NUMBER, z=NUMBER)
POINT = record("foxglove.Point3", x=NUMBER, y=NUMBER, z=NUMBER)
QUATERNION = record("foxglove.Quaternion", x=NUMBER, y=NUMBER, z=NUMBER, w=NUMBER)
POSE = record("foxglove.Pose", position=VECTOR, orientation=QUATERNION)
COLOR = record("foxglove.Color", r=NUMBER, g=NUMBER, b=NUMBER, a=NUMBER)
SPHERE = record("foxglove.SpherePrimitive", pose=POSE, size=VECTOR, color=COLOR)
LINE = record(
    "foxglove.LinePrimitive",
    "type 0: a strip, 1: a closed one, 2: pairs of points",
    type=WHOLE, pose=POSE, thickness=NUMBER, scale_invariant=FLAG, points=array(POINT),
    color=COLOR, colors=array(COLOR), indices=array(WHOLE),
)  # fmt: skip
LABEL = record(
    "foxglove.TextPrimitive",
    pose=POSE, billboard=FLAG, font_size=NUMBER, scale_invariant=FLAG, color=COLOR, text=TEXT,
)  # fmt: skip
PAIR = record("foxglove.KeyValuePair", key=TEXT, value=TEXT)
DELETION = record("foxglove.SceneEntityDeletion", timestamp=TIME, type=WHOLE, id=TEXT)
UNUSED = array(record("primitive", pose=POSE, color=COLOR))  # kinds that no scene of ours has
ENTITY = record(
    "foxglove.SceneEntity",
    timestamp=TIME, frame_id=TEXT, id=TEXT, lifetime=DURATION, frame_locked=FLAG,
    metadata=array(PAIR), arrows=UNUSED, cubes=UNUSED, spheres=array(SPHERE),
    cylinders=UNUSED, lines=array(LINE), triangles=UNUSED, texts=array(LABEL), models=UNUSED,
)  # fmt: skip
SCENE = record(
    "foxglove.SceneUpdate",
    "what the 3D panel shows from now on; an entity takes the place of that with its id",
    deletions=array(DELETION), entities=array(ENTITY),
)  # fmt: skip
LOG = record(
    "foxglove.Log",
    "level 2 information, 3 warning",
    timestamp=TIME, level=WHOLE, message=TEXT, name=TEXT, file=TEXT, line=WHOLE,
)  # fmt: skip
CELLS = record(
    "innervate.Cells",
    "all cells at a moment; lists in order of the cells' numbers",
    timestamp=TIME, unrouted=WHOLE, cut_off=WHOLE, parent_port=array(WHOLE), hops=array(WHOLE),
)  # fmt: skip
TOUCH = record(
    "innervate.Touch",
    "the touch as the PC had it; a cell of which nothing came lately is not known",
    timestamp=TIME, force_mn=array(WHOLE), proximity=array(WHOLE), known=array(FLAG),
)  # fmt: skip
ROBOT = record(
    "innervate.Robot", "where a robot is", timestamp=TIME, node=WHOLE, x_m=NUMBER, y_m=NUMBER
)

_TYPES = {"Boolean": "boolean", "Float64": "number"}


def of_table(table: Table) -> Schema:
    """The schema of a row: its moment, then its columns as far as they are not null."""
    columns = {
        column.name: {
            "type": _TYPES.get(column.kind, "integer"),
            "description": f"{column.meaning} [{column.unit}]" if column.unit else column.meaning,
        }
        for column in table.columns
    }
    title = f"innervate.{table.name.capitalize()}"
    made = record(title, f"a row where {table.row}", timestamp=TIME, **columns)
    return made | {"required": ["timestamp"]}
