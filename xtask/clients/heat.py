"""What a host must have seen of a print that heats."""

from printer import check

# Of heat.gcode.
TARGETS = {"hotend": 200, "bed": 35}

# The room of the simulated plant, in C.
ROOM = 25

# Noise of the converter at the room's temperature and at the target, in C.
NEAR = 2

# A rise is one if it was seen at so many temperatures on the way.
STEPS = 5


def check_rise(name, course):
    """Holds the course of a heater, (actual, target) in C as they came, to a rise to its target, and to its end."""
    target = TARGETS[name]
    check(course, f"nothing was told of the {name}")
    check(abs(course[0][0] - ROOM) < NEAR, f"the {name} begins at {course[0][0]} C")
    check({each for _, each in course} == {0, target}, f"targets of the {name}: {sorted({t for _, t in course})}")
    rising = [actual for actual, each in course if each == target]
    between = [actual for actual in rising if ROOM + NEAR < actual < target - NEAR]
    check(len(between) >= STEPS, f"of the way of the {name} up there is {between} alone")
    # The converter's noise goes both ways.
    check(all(b > a - NEAR for a, b in zip(between, between[1:])), f"the {name} does not rise steadily: {between}")
    check(abs(max(rising) - target) < NEAR, f"the {name} gets to {max(rising)} C")
    check(course[-1][1] == 0, f"the {name} has a target after the print")


def check_wait(lines, command):
    """Holds the lines that were told before the `ok` of a command to a wait that ended because the heater was there."""
    waits = [line for line in lines if " W:" in line]
    check(waits, f"{command} does not wait")
    seconds = waits[-1].rsplit("W:", 1)[1].strip()
    # A line a second: the last one may come as much before the end.
    check(seconds in ("0", "1"), f"{command} ends its wait with {waits[-1]}")
    return f"{command} waits"
