"""The colours of line types and of what limits a move can be told apart with each kind of colour vision.

The colours are those of the viewer's own script. Arguments: corehbot.
"""

import itertools

from chromium import DESK, Chromium, check
from trial import ROOT, main

# What a person without one kind of cones sees of linear light in red, green and blue (Machado, Oliveira, Fernandes: A
# Physiologically-based Model for Simulation of Color Vision Deficiency, 2009, table 1, severity 1).
VISIONS = {
    "normal": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "protan": ((0.152286, 1.052583, -0.204868), (0.114503, 0.786281, 0.099216), (-0.003882, -0.048116, 1.051998)),
    "deutan": ((0.367322, 0.860646, -0.227968), (0.280085, 0.672501, 0.047413), (-0.011820, 0.042940, 0.968881)),
    "tritan": ((1.255528, -0.076749, -0.178779), (-0.078411, 0.930809, 0.147602), (0.004733, 0.691367, 0.303900)),
}
# sRGB to XYZ, and the white of daylight (IEC 61966-2-1).
TO_XYZ = ((0.4124, 0.3576, 0.1805), (0.2126, 0.7152, 0.0722), (0.0193, 0.1192, 0.9505))
WHITE = (0.9505, 1, 1.089)

# A difference of 2.3 in CIE L*a*b* is just noticeable (Mahy, Van Eycken, Oosterlinck, 1994); four times as much can be
# told in a picture with a legend.
LEAST = 9.2

# The types of PrusaSlicer 2.9 with their roles, after the simulator's own ones.
TYPES = {
    "Travel": "travel", "Retract": "travel", "Without a name": "other", "Purge line": "purge",
    "Prime": "travel", "Wipe": "travel", "Wipe tower": "purge", "Skirt/Brim": "skirt", "Perimeter": "inner wall", "External perimeter": "outer wall",
    "Overhang perimeter": "bridge", "Bridge infill": "bridge", "Internal infill": "infill", "Gap fill": "infill",
    "Solid infill": "skin", "Top solid infill": "skin", "Ironing": "skin", "Support material": "support",
    "Support material interface": "support", "Custom": "other",
}  # fmt: skip

COLOURS = """const types = Object.entries(arguments[0]).map(([name, role]) => ({ name, role }));
    return { types: typeColours(types), limits: Object.values(LIMIT_COLOURS) };"""


def times(matrix, vector):
    return [sum(a * b for a, b in zip(row, vector)) for row in matrix]


def lab(rgb, vision):
    """CIE L*a*b* of a colour as a person sees it."""
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in (v / 255 for v in rgb)]
    seen = [min(max(c, 0), 1) for c in times(vision, linear)]
    xyz = (v / white for v, white in zip(times(TO_XYZ, seen), WHITE))
    x, y, z = (v ** (1 / 3) if v > 0.008856 else 7.787 * v + 16 / 116 for v in xyz)
    return 116 * y - 16, 500 * (x - y), 200 * (y - z)


def run(_, __):
    script = "".join((ROOT / f"report/src/viewer/{name}.js").read_text() for name in ("words", "colours"))
    least = 1e9
    with Chromium() as browser:
        for is_dark in (False, True):
            browser.resize(DESK, is_dark)
            found = browser.run(script + COLOURS, TYPES)
            for kind, colours in found.items():
                for (name, vision), pair in itertools.product(VISIONS.items(), itertools.combinations(colours, 2)):
                    one, other = (lab(colour, vision) for colour in pair)
                    difference = sum((a - b) ** 2 for a, b in zip(one, other)) ** 0.5
                    check(difference >= LEAST, f"{kind}, {name}, dark {is_dark}: {pair} differ by {difference:.1f}")
                    least = min(least, difference)
    return f"colours differ by {least:.1f} at least, to people with each kind of colour vision"


main(run)
