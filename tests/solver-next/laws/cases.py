"""Runs the collected cases of coincident events and checks each against the reference and against the statement in its head.

usage: cases.py ENGINE CASES_FOLDER --reference reference.py [--cache FOLDER] [--seconds 120]

One line per case: ok, or the difference. The reference is asked where the scene is small enough for it; the statements are closed
forms or numbers of multiprecision arithmetic and are repeated below.
"""

import argparse
import math
import sys
import tomllib
from pathlib import Path

import running

SPEEDS_OF_ROW = """0.849805 0.849833 0.849855 0.849871 0.849883 0.849892 0.849898 0.849901 0.850162 0.850648 0.851260 0.851998
0.852864 0.853856 0.854976 0.856223""".split()


class Case:
    def __init__(self, result, rate):
        self.result, self.rate, self.problems = result, rate, []

    def at(self, step, name):
        return self.result.states[step][name]

    def expect(self, what, found, right, tolerance=1e-9):
        if not abs(found - right) <= tolerance * max(1.0, abs(right)):
            self.problems.append(f"{what} is {found!r}, right {right!r}")

    def collisions(self, right):
        if len(self.result.log) != right:
            self.problems.append(f"{len(self.result.log)} collisions, right {right}")

    def motion(self, name, x=None, y=None, until=None, since=0, tolerance=1e-9):
        """Compares a body with functions of time at every step."""
        for step, state in enumerate(self.result.states):
            t = step / self.rate
            if t < since or until is not None and t > until:
                continue
            for k, right in ((0, x), (1, y)):
                if right is not None and abs(state[name][k] - right(t)) > tolerance * max(1.0, abs(right(t))):
                    self.problems.append(f"step {step}: {'xy'[k]} of {name} is {state[name][k]!r}, right {right(t)!r}")
                    return


def row(case):
    for i, v in enumerate(SPEEDS_OF_ROW):
        case.expect(f"vx of b{i}", case.at(-1, f"b{i}")[2], float(v), 1e-6)
    case.collisions(396)


def precision(case):
    case.expect("y of b0", case.at(64, "b0")[1], 0.0010891463145773924)
    case.expect("vy of b0", case.at(64, "b0")[3], -6.037691622310456)
    case.collisions(6597)


def endless(case):
    if case.result.outcome != "endless":
        case.problems.append(f"{case.result.outcome} {case.result.message}, right: an error that says that this never ends")
    elif "raise" in case.result.message:
        case.problems.append(f"the message suggests to raise the limit: {case.result.message}")


def plank(case):
    for step, state in enumerate(case.result.states):
        a, b = state["on a plank"], state["on tiles"]
        if max(abs(a[0] - b[0]), abs(a[2] - b[2])) > 1e-9:
            case.problems.append(f"step {step}: x on the plank {a[0]!r}, on tiles {b[0]!r}")
            return


def squares(case):
    case.expect("y / 1e-200 after 1 s", case.at(60, "box")[1] / 1e-200, -0.5)
    case.expect("vy / 1e-200 after 1 s", case.at(60, "box")[3] / 1e-200, 1.0)


def rod(case):
    case.expect("y", case.at(-1, "box")[1], -8.0)
    case.expect("vy", case.at(-1, "box")[3], -8.0)


def heavy_on_light(case):
    case.collisions(314)
    case.expect("vx of light", case.at(-1, "light")[2], 0.48141, 2e-5)
    case.expect("vx of heavy", case.at(-1, "heavy")[2], 0.85438, 2e-5)


def heavy_on_light_gap(case):
    case.collisions(314)
    case.expect("vx of heavy", case.at(-1, "heavy")[2], 0.8543824, 1e-6)


def capture(case):
    case.expect("vx × 1e6", case.at(-1, "box")[2] * 1e6, 5.0)


def alike(case):
    case.expect("vx of b2", case.at(-1, "b2")[2], 0.0)
    case.expect("x of b2", case.at(-1, "b2")[0], 1.0)


def livelock(case):
    if case.result.outcome != "ok":
        case.problems.append(f"{case.result.outcome} {case.result.message}")


def seam(case):
    case.motion("b", x=lambda t: t)
    case.motion("b", y=lambda t: 0.0, until=0.99)
    case.collisions(0)


def slides_off(case):
    case.motion("b", x=lambda t: 0.25 + 2 * t, y=lambda t: 7.0)
    case.collisions(0)


STATEMENTS = {
    "burst-bystander": lambda c: c.motion("bystander", x=lambda t: 2 + t),
    "burst-heavy-on-light": heavy_on_light,
    "burst-heavy-on-light-gap": heavy_on_light_gap,
    "burst-row-at-wall": row,
    "burst-row-nanometre-gaps": lambda c: (c.collisions(256), c.expect("vx of b15", c.at(-1, "b15")[2], 0.856, 1e-3)),
    "capture-speed-absolute": capture,
    "graze-pressed": lambda c: c.motion("b", x=lambda t: 1.5, y=lambda t: 0.75 - 2 * t + 4 * t * t, until=0.95),
    "graze-slide-back": lambda c: c.motion("b", x=lambda t: 3 - t + t * t / 4, y=lambda t: 3.0, until=4),
    "livelock-corners": livelock,
    "masses-overflow": lambda c: c.expect("x of a", c.at(-1, "a")[0], -0.25),
    "mirror-a": lambda c: c.expect("vx of b3", c.at(-1, "b3")[2], 0.05),
    "mirror-b": lambda c: c.expect("vx of b3", c.at(-1, "b3")[2], -0.05),
    "packed-slot": endless,
    "precision-exhausted": precision,
    "rate-64": alike,
    "rate-960": alike,
    "seam-endless": lambda c: c.motion("b", x=lambda t: 4 + t / 4),
    "seam-left-tile-first": seam,
    "seam-right-tile-first": seam,
    "seam-row": slides_off,
    "seam-tiles-1.6": plank,
    "squares-underflow": squares,
    "thin-rod-far-away": rod,
}
# Not asked: endless by design, more bodies than it can take, or so many steps that the statement is the better judge.
NOT_FOR_THE_REFERENCE = {"packed-slot", "seam-tiles-1.6", "seam-row", "rate-960"}


class Described:
    """What `running.compare` needs to know of a scene."""

    def __init__(self, text):
        scene = tomllib.loads(text)
        self.rate = float(scene["run"].get("rate", 60))
        self.steps = scene["run"].get("steps") or math.ceil(scene["run"]["duration"] * self.rate)
        forces = [abs(f) / b["mass"] for b in scene["spawn"] for f in b.get("force", [])]
        self.greatest = max(map(abs, scene["world"].get("gravity", [0.0]))) + max(forces, default=0.0)
        self.sizes = [max(map(float, b["size"])) for b in scene["spawn"] if not math.isinf(b["mass"])]

    def extent(self):
        return max(self.sizes)

    def acceleration(self):
        return self.greatest


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engine")
    parser.add_argument("folder")
    parser.add_argument("--reference", required=True)
    parser.add_argument("--cache")
    parser.add_argument("--seconds", type=float, default=120)
    options = parser.parse_args()
    reference, bad = running.load_reference(options.reference), 0
    for path in sorted(Path(options.folder).glob("*.toml")):
        text = path.read_text()
        described = Described(text)
        result = running.run_engine(options.engine, text, options.seconds)
        case = Case(result, described.rate)
        if path.stem not in STATEMENTS:
            case.problems.append("no statement is known here")
        elif result.outcome != "ok" and path.stem != "packed-slot":
            case.problems.append(f"{result.outcome} after step {len(result.states) - 1}: {result.message}")
        else:
            STATEMENTS[path.stem](case)
        by = "statement"
        if path.stem not in NOT_FOR_THE_REFERENCE:
            right = running.run_reference(reference, text, True, options.seconds, cache=options.cache)
            if right.outcome in ("refused", "timeout"):
                by += f" (reference: {right.outcome} {right.message[:60]})"
            else:
                by += " and reference"
                difference = running.compare(result, right, described)
                if difference:
                    case.problems.append(f"reference: {difference}")
        bad += bool(case.problems)
        print(f"{path.stem:28}", "; ".join(case.problems)[:600] if case.problems else f"ok ({by})", flush=True)
    print(f"{bad} differ")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
