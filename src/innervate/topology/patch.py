"""Patches: rectangles of cells on a honeycomb, and how a cell's four ports are wired.

Rule Z [skin 1]: cell (r, c) is wired to (r, c-1), (r, c+1), (r-1, c), (r+1, c). On the honeycomb
(odd rows shifted by half a cell) these are W, E, NE, SE in even rows and W, E, NW, SW in odd rows.
Rule S: W and E as above; up is the cell to the NE, down the cell to the SW, in every row.
"""

from __future__ import annotations

from array import array
from dataclasses import dataclass

from innervate.topology.errors import TopologyError

W, E, UP, DOWN = 0, 1, 2, 3
PORT_NAMES = ("W", "E", "up", "down")
PORTS = 4
CELLS_MAX = 4_000_000
NOTHING = -1


@dataclass(frozen=True, slots=True)
class Patch:
    """`columns` x `rows` cells (each >= 1), numbered row by row from `first_cell`."""

    columns: int
    rows: int
    wiring: str = "Z"
    first_cell: int = 0

    @property
    def cells(self) -> int:
        """How many cells it has."""
        return self.columns * self.rows

    def cell(self, row: int, column: int) -> int:
        """Number of the cell at (row, column).

        Raises:
            TopologyError: there is no such row or column.
        """
        if not 0 <= row < self.rows:
            raise TopologyError(f"there is no row {row}; rows are 0 to {self.rows - 1}", "row")
        if not 0 <= column < self.columns:
            message = f"there is no column {column}; columns are 0 to {self.columns - 1}"
            raise TopologyError(message, "column")
        return self.first_cell + row * self.columns + column

    def row_column(self, cell: int) -> tuple[int, int]:
        """Where a cell of this patch lies."""
        return divmod(cell - self.first_cell, self.columns)


def port_number(port: int | str) -> int:
    """0..3 from a number, a digit or a name (W, E, up, down in any case).

    Raises:
        TopologyError: it is none of them.
    """
    if isinstance(port, int):
        if 0 <= port < PORTS:
            return port
    else:
        for number, name in enumerate(PORT_NAMES):
            if port.lower() == name.lower() or port == str(number):
                return number
    raise TopologyError(f'no port is called "{port}"; ports are W, E, up, down (0 to 3)', "port")


def neighbour(patch: Patch, row: int, column: int, port: int) -> tuple[int, int] | None:
    """(row, column) of the cell wired to a port, or None at the border [skin 1]."""
    if port == W:
        row, column = row, column - 1
    elif port == E:
        row, column = row, column + 1
    elif patch.wiring == "Z":
        row += -1 if port == UP else 1
    elif port == UP:  # rule S: to the NE
        row, column = row - 1, column + (row & 1)
    else:  # rule S: to the SW
        row, column = row + 1, column - 1 + (row & 1)
    if 0 <= row < patch.rows and 0 <= column < patch.columns:
        return row, column
    return None


def wire(patch: Patch) -> array[int]:
    """The patch's own peer table: 4 ends a cell, numbered from 0 whatever `first_cell` is."""
    table = array("i", [NOTHING]) * (PORTS * patch.cells)
    for row in range(patch.rows):
        for column in range(patch.columns):
            cell = row * patch.columns + column
            for port in range(PORTS):
                other = neighbour(patch, row, column, port)
                if other is not None:
                    there = other[0] * patch.columns + other[1]
                    table[PORTS * cell + port] = PORTS * there + (port ^ 1)  # W and E, up and down
    return table
