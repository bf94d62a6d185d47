"""A small simulated arm that gives way to touch on its skin, as far as the PC hears of it.

Two joints in a plane, skin round the forearm. The controller adds up the newest sample of every
cell: a force on the skin turns into joint torques, and each joint moves like a mass on a spring and
damper (admittance). A cell that is not heard any more keeps its last value, as in a controller that
knows nothing of the network.
"""

import math
from typing import Any

import numpy as np

UPPER_M = 0.30
FIRST_COLUMN_M = 0.12  # where the skin begins on the forearm
PITCH_M = 0.014
REST_RAD = (0.5, 0.9)
INERTIA = (0.6, 0.25)  # kg m2, of the admittance, not of the arm
FREQUENCY_HZ = 0.6  # of the spring that pulls back to rest
DAMPING = 1.0  # critical
STEP_US = 2000
FULL_TURN_ROWS = 2.0  # rows from the middle to where the skin faces along the forearm's side

Numbers = np.ndarray[Any, np.dtype[np.float64]]


def torque_table(rows: int, columns: int) -> Numbers:
    """Torque on both joints (N m) for 1 N on each cell, at rest: shape (cells, 2).

    The upper rows lie on one side of the forearm, the lower rows on the other; the middle row is
    pressed at right angles to the plane of motion, which moves nothing.
    """
    table = np.zeros((rows * columns, 2))
    q2 = REST_RAD[1]
    for cell in range(rows * columns):
        row, column = divmod(cell, columns)
        lever = FIRST_COLUMN_M + PITCH_M * column
        side = math.sin((row - (rows - 1) / 2) / FULL_TURN_ROWS * math.pi / 2)
        table[cell] = side * (UPPER_M * math.cos(q2) + lever), side * lever
    return table


def move(deliveries: Any, torques: Numbers, duration_us: int) -> dict[str, Numbers]:
    """Joint angles (rad), speeds (rad/s), and cells heard lately, every STEP_US.

    `deliveries` are samples in order of arrival: time (us), cell, force (mN, three).
    """
    steps = duration_us // STEP_US
    force = np.zeros(len(torques))
    heard = np.full(len(torques), -(10**9), np.int64)
    angle, speed = np.array(REST_RAD), np.zeros(2)
    spring = (2 * math.pi * FREQUENCY_HZ) ** 2
    damper = 2 * DAMPING * math.sqrt(spring)
    dt = STEP_US / 1e6
    found: dict[str, Any] = {"angle": np.zeros((steps, 2)), "speed": np.zeros((steps, 2))}
    found["heard"] = np.zeros(steps)
    edges = np.searchsorted(deliveries["time"], STEP_US * np.arange(1, steps + 1))
    first = 0
    for i, behind in enumerate(edges.tolist()):
        part = deliveries[first:behind]
        # Of several samples of one cell NumPy keeps the last.
        force[part["cell"]] = part["force"].mean(axis=1) / 1000
        heard[part["cell"]] = part["time"]
        first = behind
        pull = (force @ torques) / INERTIA - spring * (angle - REST_RAD) - damper * speed
        speed = speed + dt * pull
        angle = angle + dt * speed
        found["angle"][i], found["speed"][i] = angle, speed
        found["heard"][i] = np.count_nonzero(heard > STEP_US * (i + 1) - 50_000)
    return found
