"""Pictures show all of what is drawn: nothing is cut off at an edge."""

import numpy as np
import pytest
from PIL import Image

from innervate.plot import figures, style
from innervate.plot.charts import Axis, Mark, Steps

LONG = "Of those offered in each 3.14 s; lowest 100 %, 166 messages in all."


def edges(path):
    """The least darkness of the outermost rows and columns of a picture: 255 is paper."""
    with Image.open(path) as picture:
        ink = np.array(picture.convert("L"))
    return [int(line.min()) for line in (ink[0], ink[-1], ink[:, 0], ink[:, -1])]


@pytest.mark.parametrize("marks", [0, 1, 4])
@pytest.mark.parametrize("text", ["", LONG])
def test_the_title_of_a_chart_is_not_cut_off(tmp_path, marks, text):
    shown = Steps(
        np.array([8.0, 15.0, 22.0]), np.array([100.0, 100.0, 100.0]), Axis(8.0, 30.0, "seconds"),
        Axis(0.0, 108.0), "Messages delivered over time, in %", text,
        [Mark(15.0 + 0.2 * i, f"{6 + i} events") for i in range(marks)],
    )  # fmt: skip
    with style.house():
        style.save(figures.chart(shown), tmp_path, "chart")
    assert edges(tmp_path / "chart.png") == [255] * 4
