"""How large a picture is, and how much of it is drawn on."""

from PIL import Image, ImageChops


def measured(path, paper=0.9):
    """(width and height in pixels, share of them that some colour is darker than paper in)."""
    with Image.open(path) as picture:
        red, green, blue = picture.convert("RGB").split()
    counts = ImageChops.darker(ImageChops.darker(red, green), blue).histogram()
    return red.size, sum(counts[: round(255 * paper + 0.5)]) / sum(counts)
