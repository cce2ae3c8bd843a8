"""How much room text takes, from above: no font of the page's list is wider than said here.

The server cannot measure what a browser will draw. Advances are, letter by letter, the greater of
DejaVu Sans' and Liberation Sans' (which has Arial's and Helvetica's), so that what is laid out
apart here is drawn apart there.
"""

from __future__ import annotations

LINE = 1.2
"""Height of a line of text over its font size."""
ASCENT = 0.95
"""Of that, above the baseline."""

_FIRST = 32
# Thousandths of the font size, of the characters from the space to the tilde.
_REGULAR = (
    *(318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337, 636, 636),
    *(636, 636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 556, 1015, 684, 686, 722),
    *(770, 667, 611, 778, 752, 295, 500, 667, 557, 863, 748, 787, 667, 787, 722, 667, 611, 732),
    *(684, 989, 685, 667, 685, 390, 337, 390, 838, 556, 500, 613, 635, 550, 635, 615, 352, 635),
    *(634, 278, 278, 579, 278, 974, 634, 612, 635, 635, 411, 521, 392, 634, 592, 818, 592, 592),
    *(525, 636, 337, 636, 838),
)
_BOLD = (
    *(348, 456, 521, 838, 696, 1002, 872, 306, 457, 457, 523, 838, 380, 415, 380, 365, 696, 696),
    *(696, 696, 696, 696, 696, 696, 696, 696, 400, 400, 838, 838, 838, 611, 1000, 774, 762, 734),
    *(830, 683, 683, 821, 837, 372, 556, 775, 637, 995, 837, 850, 733, 850, 770, 720, 682, 812),
    *(774, 1103, 771, 724, 725, 457, 365, 457, 838, 556, 500, 675, 716, 611, 716, 678, 435, 716),
    *(712, 343, 343, 665, 343, 1042, 712, 687, 716, 716, 493, 595, 478, 712, 652, 924, 645, 652),
    *(582, 712, 365, 712, 838),
)
_WIDEST = 1100  # of a character that is not in the tables
ELLIPSIS = "…"


def text_width(text: str, size: float, *, bold: bool = False) -> float:
    """Return the width in pixels that `text` takes at most at a font size in pixels."""
    table = _BOLD if bold else _REGULAR
    total = sum(
        table[at] if 0 <= (at := ord(letter) - _FIRST) < len(table) else _WIDEST for letter in text
    )
    return total * size / 1000


def line_height(size: float) -> float:
    """Return the height in pixels of a line at a font size in pixels."""
    return LINE * size


def shorten(text: str, width: float, size: float, *, bold: bool = False) -> str:
    """Return `text`, its end replaced by an ellipsis where it is wider than `width` pixels."""
    if text_width(text, size, bold=bold) <= width:
        return text
    kept = text
    while kept and text_width(kept.rstrip() + ELLIPSIS, size, bold=bold) > width:
        kept = kept[:-1]
    return kept.rstrip() + ELLIPSIS


def wrap(
    text: str, width: float, size: float, most: int = 2, *, bold: bool = False
) -> tuple[str, ...]:
    """Return `text` in at most `most` lines of at most `width` pixels, broken between words.

    What does not fit ends in an ellipsis; a text without words is one empty line.
    """
    words = text.split()
    lines: list[str] = []
    while words and len(lines) < most - 1:
        line = words.pop(0)
        while words and text_width(f"{line} {words[0]}", size, bold=bold) <= width:
            line = f"{line} {words.pop(0)}"
        lines.append(shorten(line, width, size, bold=bold))
    if words:
        lines.append(shorten(" ".join(words), width, size, bold=bold))
    return tuple(lines) or ("",)
