"""Pictures side by side with captions, as on a page of a paper."""

from collections.abc import Sequence

from PIL import Image, ImageDraw, ImageFont

INK, PAPER, GAP = (38, 48, 58), (255, 255, 255), 12


def beside(pictures: Sequence[Image.Image]) -> Image.Image:
    """Return pictures of one height in a row, with white gaps."""
    width = sum(p.width for p in pictures) + GAP * (len(pictures) - 1)
    row = Image.new("RGB", (width, pictures[0].height), PAPER)
    left = 0
    for picture in pictures:
        row.paste(picture, (left, 0))
        left += picture.width + GAP
    return row


def captioned(picture: Image.Image, title: str, text: str) -> Image.Image:
    """Return the picture above a title and one line of text."""
    page = Image.new("RGB", (picture.width, picture.height + 64), PAPER)
    page.paste(picture, (0, 0))
    draw = ImageDraw.Draw(page)
    below = picture.height
    draw.text((16, below + 10), title, fill=INK, font=ImageFont.load_default(19))
    draw.text((16, below + 36), text, fill=INK, font=ImageFont.load_default(15))
    return page
