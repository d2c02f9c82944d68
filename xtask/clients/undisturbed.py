"""A print with pauses in which buttons were pressed, held to the same print without."""

import re

import printer
from printer import check

# Steps of the extruder a mm, and by how many steps homing may differ from time to time.
STEPS_PER_MM = 400
SPREAD = 2

# The motors of the prototype: those of the belt first, the extruder last.
MOTORS = 7
BELT = 4

# The file rests for 50 ms behind each move.
REST_TICKS = 200_000

# A line that prints.
PRINTS = re.compile(r"^G1 X.* E")


def absolute(commands):
    """The same commands with a count of filament."""
    count, written = 0.0, []
    for line in commands:
        if line == "M83":
            line = "M82"
        elif line.startswith("G92 E"):
            count = float(line[5:])
        elif line.startswith("G1") and " E" in line:
            length = re.search(r" E(-?[\d.]+)", line)
            count += float(length[1])
            line = line.replace(length[0], f" E{count:.3f}")
        written.append(line)
    return written


def rows(path):
    """The steps of the motors, an instant a line as (tick, the rest of the row); the extruder is the last motor."""
    with open(path, encoding="utf-8") as lines:
        split = (line.rstrip("\n").split(",", 1) for line in lines if line[0].isdigit())
        return [(int(tick), rest) for tick, rest in split]


def sums(rows):
    """How far each motor has gone."""
    return [sum(column) for column in zip(*(map(int, row.split(",")) for row in rows))] or [0] * MOTORS


def same_lines(program, path, commands, pressed):
    """Holds each line that prints of a file that was served, and what lies between two of them, to the print of the same
    commands without M25. In between only filament may have moved besides: as much as was `pressed`, in mm a pause. The trace is
    at `path`, where others are left."""
    without, trace = path + ".gcode", path + ".alone.csv"
    with open(without, "w", encoding="utf-8") as lines:
        lines.write("\n".join(line for line in commands if line != "M25"))
    printer.simulate(program, without, trace=trace)
    alone, served = rows(trace), rows(path)
    segments = printing(alone)
    alone, served = [[row for _, row in each] for each in (alone, served)]
    count = sum(bool(PRINTS.match(line)) for line in commands)
    check(len(segments) == count, f"{len(segments)} segments print, {count} lines do")
    text, at, end_alone, moved = "\n".join(served) + "\n", 0, 0, []
    starts = [0]
    for row in served:
        starts.append(starts[-1] + len(row) + 1)
    index = {start: place for place, start in enumerate(starts)}
    for begin, end in segments:
        pattern = "\n".join(alone[begin:end]) + "\n"
        found = text.find(pattern, starts[at])
        check(found >= 0, f"the line at event {begin} is not printed as it is alone")
        place = index[found]
        if end_alone:
            between = [a - b for a, b in zip(sums(served[at:place]), sums(alone[end_alone:begin]))]
            check(all(abs(steps) <= SPREAD for steps in between[:-1]), f"it goes on beside its place, by steps: {between}")
            moved.append(between[-1] / STEPS_PER_MM)
        at, end_alone = place + end - begin, end
    by_hand = [round(mm, 3) for mm in moved if abs(mm) > 0.01]
    check(by_hand == [mm for mm in pressed if mm], f"filament moved in the pauses: {moved}")
    return f"{len(segments)} lines as without the {len(pressed)} pauses"


def printing(rows):
    """The moves between two rests in which extruder and belt go together, as (begin, end)."""
    rests = [place for place in range(1, len(rows)) if rows[place][0] - rows[place - 1][0] > REST_TICKS]
    moves = list(zip([0, *rests], [*rests, len(rows)]))
    return [(begin, end) for begin, end in moves if is_print([row for _, row in rows[begin:end]])]


def is_print(rows):
    *others, filament = sums([row.replace("-1", "1") for row in rows])
    return filament > 0 and any(others[:BELT])
