"""How many interface ports does a skin need? Built in code, without a file.

A skin of 12 x 12 cells sends 250 samples a second and cell. A cable carries 16,667 frames a second,
so one port is not enough; how many are, and what does the PC get meanwhile?
Run it with: python examples/ports_needed.py
"""

import polars as pl

import innervate

CORNERS = [
    {"row": 0, "column": 2},
    {"row": 2, "column": 0},
    {"row": 11, "column": 9},
    {"row": 9, "column": 11},
]


def skin(ports: int) -> dict[str, object]:
    """The scenario with as many interface ports."""
    return {
        "kind": "skin",
        "name": f"ports-{ports}",
        "duration_s": 1.0,
        "patch": [{"columns": 12, "rows": 12}],
        "interface": CORNERS[:ports],
        "data": {"rate_hz": 250},
    }


def main() -> None:
    """Print what comes through with one to four ports."""
    for ports in range(1, len(CORNERS) + 1):
        run = innervate.run(skin(ports))
        data, loads = run.summary["data"], run.summary["port_loads"]
        received = run.tables["received"]
        hops = received.select(pl.col("hops").mean()).collect().item()
        print(
            f"{ports} {'port:  ' if ports == 1 else 'ports: '}"
            f"{100 * data['loss_ratio']:5.1f} % of the samples lost, "
            f"{hops:.1f} cells on the way, cells behind each port {loads}"
        )


if __name__ == "__main__":
    main()
