"""How large a picture is, and how much of it is drawn on."""

from PIL import Image, ImageChops

from innervate.plot import style


def measured(path, paper=0.9):
    """(width and height in pixels, share of them that some colour is darker than paper in)."""
    with Image.open(path) as picture:
        red, green, blue = picture.convert("RGB").split()
    counts = ImageChops.darker(ImageChops.darker(red, green), blue).histogram()
    return red.size, sum(counts[: round(255 * paper + 0.5)]) / sum(counts)


def ink_of(figure, folder):
    """The share of a figure that is drawn on, saved as a run's."""
    with style.house():
        style.save(figure, folder, "figure")
    return measured(folder / "figure.png", 0.97)[1]
