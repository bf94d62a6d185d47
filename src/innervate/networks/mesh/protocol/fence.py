"""The virtual fence in whole numbers: how far inside, what to raise [mesh 6, 4 FENCE].

A fence is a set of rings, the outer one and holes alike: corner i is joined to corner
`params.after[i]`. Positions and distances are in the fence's unit, speeds in 2 cm/s.

Corners span at most 23,000 units each way; positions may be anywhere in 16 bits. Then every value
on the way stays below 2^30. Distances are right to 0.51 units, but never 0 beside an edge, so that
the sign is exact: the error is below 1 unit. Distances of FAR and more are all the same to us.
"""

from innervate.networks.mesh.protocol.constants import CLEAR, CROSS, PREDICT

FAR = 16384  # units; an edge this far away is not looked at
REACH = 23170  # twice its square is below 2^30
FULL = 1 << 28  # roots of numbers from here to 2^30 have 15 bits
ROOT_BITS = 15
NONE = -1

# node.outside.
INSIDE = 0
SOON = 1
OUTSIDE = 2


def root(n):
    """The whole part of the square root of n, 0 <= n < 2^30."""
    found = 0
    bit = 1 << (ROOT_BITS - 1)
    for _ in range(ROOT_BITS):
        if (found + bit) * (found + bit) <= n:
            found = found + bit
        bit = bit >> 1
    return found


def over_root(a, n):
    """Quotient a / sqrt(n), rounded, at most FAR; 0 <= a < 32768 sqrt(n), 0 < n < 2^30."""
    for _ in range(ROOT_BITS):
        if n < FULL:
            n = n << 2
            a = a << 1
    whole = root(n)
    share = a // whole
    if share >= FAR:
        return FAR
    # sqrt(n) = whole + rest / (2 whole), nearly: so much less is to be divided.
    rest = n - whole * whole
    return (a - share * (rest >> 1) // whole + (whole >> 1)) // whole


def length(dx, dy):
    """Length of (dx, dy), rounded; dx^2 + dy^2 < 2^30."""
    n = dx * dx + dy * dy
    found = root(n)
    return found + 1 if n - found * found > found else found


def gap(params, i, x, y):
    """At most the distance to edge i: how far beside the box around it."""
    j = params.after[i]
    across = max(min(params.px[i], params.px[j]) - x, x - max(params.px[i], params.px[j]))
    along = max(min(params.py[i], params.py[j]) - y, y - max(params.py[i], params.py[j]))
    return max(0, across, along)


def beside(params, i, x, y):
    """How far away corner i is along an axis, the longer of the two ways."""
    return max(abs(x - params.px[i]), abs(y - params.py[i]))


def near_end(params, i, x, y):
    """The end of edge i to calculate from; NONE if the edge is FAR away.

    Two ends beyond REACH: even a point between them, at most 16,264 from one, is beyond 16,500.
    """
    j = params.after[i]
    end = i if beside(params, i, x, y) <= beside(params, j, x, y) else j
    return end if beside(params, end, x, y) <= REACH else NONE


def near_corner(params, a, b, x, y):
    """Which corner is the nearest point of the edge from a to b; NONE if it lies between them."""
    dx = params.px[b] - params.px[a]
    dy = params.py[b] - params.py[a]
    dot = (x - params.px[a]) * dx + (y - params.py[a]) * dy
    if dot <= 0:
        return a
    return b if dot >= dx * dx + dy * dy else NONE


def area(params, a, b, qx, qy):
    """Cross product of the edge from a to b with (qx, qy): positive to the left of it."""
    return (params.px[b] - params.px[a]) * qy - (params.py[b] - params.py[a]) * qx


def size(params, a, b):
    """Square of the length of the edge from a to b."""
    dx = params.px[b] - params.px[a]
    dy = params.py[b] - params.py[a]
    return dx * dx + dy * dy


def distance(params, i, x, y):
    """Distance to edge i, at most FAR; 0 only on it."""
    a = near_end(params, i, x, y)
    if a < 0:
        return FAR
    b = i + params.after[i] - a
    corner = near_corner(params, a, b, x, y)
    if corner >= 0:
        return min(FAR, length(params.px[corner] - x, params.py[corner] - y))
    across = abs(area(params, a, b, x - params.px[a], y - params.py[a]))
    return max(1, over_root(across, size(params, a, b))) if across else 0


def closing(params, i, x, y, vx, vy):
    """How fast edge i comes nearer, 2 cm/s; negative: away. 0 if it is FAR away."""
    a = near_end(params, i, x, y)
    if a < 0:
        return 0
    b = i + params.after[i] - a
    corner = near_corner(params, a, b, x, y)
    if corner < 0:
        side = area(params, a, b, x - params.px[a], y - params.py[a])
        speed = area(params, a, b, vx, vy)
        square = size(params, a, b)
    else:
        dx = params.px[corner] - x
        dy = params.py[corner] - y
        side = -1
        speed = vx * dx + vy * dy
        square = dx * dx + dy * dy
        if square == 0:
            return length(vx, vy)
    rate = over_root(abs(speed), square)
    return rate if side == 0 or (speed < 0) == (side > 0) else -rate


def is_right(params, i, x, y):
    """1 if edge i crosses the line from (x, y) to the right."""
    j = params.after[i]
    if (params.py[i] > y) == (params.py[j] > y):
        return 0
    if x < min(params.px[i], params.px[j]):
        return 1
    if x >= max(params.px[i], params.px[j]):
        return 0
    left = area(params, i, j, x - params.px[i], y - params.py[i]) > 0
    return left == (params.py[j] > params.py[i])


def margin(params, x, y):
    """Distance to the nearest edge, units: > 0 inside, < 0 outside, at most FAR either way.

    Inside is where an odd number of edges surrounds. Without a fence all is FAR inside.
    """
    nearest = FAR
    inside = params.points == 0
    for i in range(params.points):
        if is_right(params, i, x, y):
            inside = not inside
        if gap(params, i, x, y) < nearest:
            nearest = min(nearest, distance(params, i, x, y))
    return nearest if inside else -nearest


def is_soon(params, x, y, vx, vy, spare):
    """1 if an edge, come nearer by `spare`, would be reached within predict_ms at this speed.

    Every edge counts, not the nearest alone: along one wall a robot runs into the next.
    """
    ms = params.predict_ms
    reach = (abs(vx) + abs(vy)) * ms // (500 * params.unit_cm) + 1 + spare
    for i in range(params.points):
        if gap(params, i, x, y) <= reach:
            left = max(0, distance(params, i, x, y) - spare)
            # (2 cm/s) ms = 1/500 cm
            if left * params.unit_cm * 500 < closing(params, i, x, y, vx, vy) * ms:
                return 1
    return 0


def judge(node, params):
    """A robot's position is new: set node.outside; the kind of alarm that is due, or NONE.

    PREDICT once while it is about to cross, CROSS once while it is outside, CLEAR when it is more
    than `clear_margin` inside again. By as much a prediction has to be wrong to be taken back,
    which says nothing to anybody.
    """
    now = margin(params, node.x, node.y)
    before = node.outside
    if now < 0:
        node.outside = OUTSIDE
        return CROSS if before != OUTSIDE else NONE
    if before == OUTSIDE:
        if now <= params.clear_margin:
            return NONE
        node.outside = INSIDE
        return CLEAR
    spare = params.clear_margin if before == SOON else 0
    soon = is_soon(params, node.x, node.y, node.vx, node.vy, spare)
    if before == SOON:
        if now > spare and not soon:
            node.outside = INSIDE
        return NONE
    node.outside = SOON if soon else INSIDE
    return PREDICT if soon else NONE
