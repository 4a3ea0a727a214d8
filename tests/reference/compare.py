#!/usr/bin/env python3
"""Compares the event-driven solver with the simulator on random scenes of coincident events.

    compare.py REBOND [--seeds 0..8] [--kinds all] [--jobs 2] [--folder FOLDER] [--seconds 60]

Prints a line for each difference, with its kind and seed, and a table of the kinds. Seeds and kinds are those of scenes.py.
Not counted as a difference, but in columns of their own:
  gaps of ulps    rebond aligns the faces of some bodies, see README.md
  horizon         the first difference comes after a thousand collisions or at a hundred times the speed
  no reference    the simulator refuses the scene (a spawn into a body in flight) or takes too long
  known           the scene is in differences.txt, where each one is explained
"""

import argparse
import collections
import contextlib
import csv
import functools
import json
import io
import math
import os
import signal
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from multiprocessing import Pool
from pathlib import Path

import scenes
import simulator


@dataclass
class Result:
    """What a run gave: a state per step, the collisions, and how it ended."""

    states: list = field(default_factory=list)  # of each step {name: (x, y, vx, vy)}
    log: list = field(default_factory=list)  # (time, a, b, axis, vn_before, vn_after, impulse)
    outcome: str = "ok"  # or crushed, endless, refused, panic, timeout
    message: str = ""


# ---- the engine


def run_engine(rebond, text, seconds=60):
    """The states and collisions that `rebond export` gives for a scene."""
    with tempfile.NamedTemporaryFile("w", suffix=".toml", dir=memory_folder()) as scene:
        scene.write(text)
        scene.flush()
        tables = []
        for table in ("states", "collisions"):
            command = [rebond, "export", "--table", table, scene.name]
            try:
                tables.append(subprocess.run(command, capture_output=True, text=True, timeout=seconds))
            except subprocess.TimeoutExpired:
                return Result(outcome="timeout", message=f"more than {seconds} s")
    result = Result(message=" ".join(tables[0].stderr.split())[:300])
    # A run that ends in an error is exported up to there, and the message says so.
    result.outcome = outcome(tables[0].returncode or "recorded error" in result.message, result.message)
    for row in csv.DictReader(io.StringIO(tables[0].stdout)):
        while len(result.states) <= int(row["step"]):
            result.states.append({})
        result.states[int(row["step"])][row["name"]] = tuple(float(row[key]) for key in ("x", "y", "vx", "vy"))
    for row in csv.DictReader(io.StringIO(tables[1].stdout)):
        numbers = (float(row[key]) for key in ("vn_before", "vn_after", "impulse"))
        result.log.append((float(row["time"]), row["a"], row["b"], row["axis"], *numbers))
    return result


def outcome(code, message):
    if code == 0:
        return "ok"
    if code not in (1, 2) or "panicked" in message:
        return "panic"
    if "crushed" in message:
        return "crushed"
    if any(word in message for word in ("endless", "more than")):
        return "endless"
    return "refused"


def memory_folder():
    return "/dev/shm" if os.path.isdir("/dev/shm") else None


# ---- the reference


class TooSlow(Exception):
    pass


@contextlib.contextmanager
def time_limit(seconds):
    def stop(*_):
        raise TooSlow()

    before = signal.signal(signal.SIGALRM, stop)
    signal.setitimer(signal.ITIMER_REAL, seconds)
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
        signal.signal(signal.SIGALRM, before)


def run_simulator(text, seconds=60, limit=20000, bits=simulator.FINE):
    """Runs the simulator, for at most `limit` collisions. bits: what counts as nothing."""
    simulator.Sim.bits = bits
    result, sims = Result(), []

    def sample(step, sim):
        if not sims:
            sims.append(sim)
            sim.limit = limit
        state = {sim.name[i]: tuple(map(float, sim.x[i] + sim.v[i])) for i in range(len(sim.name)) if sim.alive[i]}
        result.states.append(state)

    try:
        with time_limit(seconds):
            simulator.simulate(text, sample)
    except TooSlow:
        result.outcome, result.message = "timeout", f"more than {seconds} s"
    except simulator.Crushed as error:
        result.outcome, result.message = "crushed", str(error)
    except simulator.Endless as error:
        result.outcome, result.message = "endless", str(error)
    except AssertionError as error:
        result.outcome, result.message = "refused", str(error) or "an assertion of the simulator"
    except Exception as error:  # e.g. a delete of a body that is gone
        result.outcome, result.message = "refused", repr(error)
    if sims:
        names = sims[0].name
        result.log = [(float(t), names[i], names[j], "xy"[k], *map(float, (before, after, impulse)))
                      for t, i, j, k, before, after, impulse in sims[0].log]
    return result


# ---- comparison


@dataclass
class Difference:
    what: str  # outcome, positions, velocities, collisions, times, impulses
    step: float  # where it begins, in steps
    text: str
    speed: float = math.inf  # of the approach, for collisions

    def __str__(self):
        return f"{self.what}: {self.text}"


def scales(*results):
    """The largest coordinate and speed of bodies that move in any of the results."""
    length = speed = 0.0
    for result in results:
        first = result.states[0] if result.states else {}
        for state in (*result.states[::8], *result.states[-1:]):
            for name, (x, y, vx, vy) in state.items():
                if (vx, vy) != (0, 0) or state is not first and first.get(name, (x, y))[:2] != (x, y):
                    length, speed = max(length, abs(x), abs(y)), max(speed, abs(vx), abs(vy))
        for row in result.log[:2000]:
            speed = max(speed, abs(row[4]))
    return length or 1.0, speed or 1.0


def first_state_difference(one, other, rate, tolerance, extent, speed, names=("engine", "reference")):
    """The first step at which a position or a velocity differs; velocities not where a collision happens at that very step."""
    times = sorted({row[0] for result in (one, other) for row in result.log})
    for step, (p, q) in enumerate(zip(one.states, other.states)):
        if p.keys() != q.keys():
            return Difference("outcome", step, f"step {step}: bodies {sorted(p.keys() ^ q.keys())} are in one only")
        for name in p:
            for k, (a, b) in enumerate(zip(p[name], q[name])):
                bound = tolerance * (extent if k < 2 else speed)
                if abs(a - b) <= bound:
                    continue
                if k >= 2 and tolerance and at_a_collision(times, step / rate):
                    continue
                what, column = ("positions", "xy"[k]) if k < 2 else ("velocities", ("vx", "vy")[k - 2])
                return Difference(what, step, f"step {step}: {column} of {name} is {a!r} in {names[0]}, {b!r} in {names[1]}")
    return None


def at_a_collision(times, instant):
    from bisect import bisect_left

    near = 1e-10 * max(1e-3, instant)
    place = bisect_left(times, instant - near)
    return place < len(times) and times[place] <= instant + near


def instants(log, span):
    """The collisions, grouped by instant."""
    groups = []
    for row in log:
        if groups and row[0] - groups[-1][0][0] <= 1e-11 * span:
            groups[-1].append(row)
        else:
            groups.append([row])
    return groups


def key(row):
    return (*sorted(row[1:3]), row[3])


def first_collision_difference(one, other, rate, steps, tolerance, speed, slow=0.0, names=("engine", "reference")):
    """The first collision that is not in both. Not counted: what is slower than 1e-6 of the greatest speed, or `slow` (the tail of
    an infinite sequence, whose end is a matter of resolution), and how long an infinite burst was carried out."""
    span = steps / rate
    slow = max(slow, 1e-6 * speed)
    if other.outcome == "endless":  # its log ends somewhere
        one = Result(one.states, one.log[: len(other.log)])
    logs = [[row for row in result.log if -row[4] > slow] for result in (one, other)]
    groups = [instants(log, span) for log in logs]
    for p, q in zip(*groups):
        if [key(row) for row in p] != [key(row) for row in q]:
            shorter = min(len(p), len(q))
            same = next((n for n in range(shorter) if key(p[n]) != key(q[n])), shorter)
            if same >= 6 and same_time(p[0][0], q[0][0], span):
                continue  # a long burst, e.g. an infinite one whose limit was taken at another impact; the states will tell
            a, b = p[same:], q[same:]
            when = min(p[min(same, len(p) - 1)][0], q[min(same, len(q) - 1)][0])
            here = f"collision {same + 1} of the instant t = {p[0][0]!r}" if same_time(p[0][0], q[0][0], span) else f"t = {when!r}"
            return Difference("collisions", when * rate, f"{here}: {describe(a)} in {names[0]}, {describe(b)} in {names[1]}", fastest(a, b))
        for a, b in zip(p, q):
            if not same_time(a[0], b[0], span, tolerance):
                return Difference("times", min(a[0], b[0]) * rate, f"{describe([a])} at {a[0]!r} in {names[0]}, at {b[0]!r} in {names[1]}", fastest([a]))
            for what, k in (("speed before", 4), ("speed after", 5)):
                if abs(a[k] - b[k]) > tolerance * speed:
                    return Difference("impulses", a[0] * rate, f"{describe([a])}: {what} {a[k]!r} in {names[0]}, {b[k]!r} in {names[1]}", fastest([a]))
            if abs(a[6] - b[6]) > 10 * tolerance * max(abs(a[6]), abs(b[6])) * max(1.0, speed / -a[4]):
                return Difference("impulses", a[0] * rate, f"{describe([a])}: impulse {a[6]!r} in {names[0]}, {b[6]!r} in {names[1]}", fastest([a]))
    n = min(map(len, groups))
    longer = next((g for g in groups if len(g) > n), None)
    if longer:
        row = longer[n][0]
        if row[0] < span * (1 - 1e-10):
            where = names[0] if longer is groups[0] else names[1]
            return Difference("collisions", row[0] * rate, f"{describe([row])} at t = {row[0]!r} in {where} only", fastest([row]))
    return None


def same_time(a, b, span, tolerance=1e-11):
    return abs(a - b) <= max(tolerance, 1e-11) * span


def fastest(*rows):
    return max((-group[0][4] for group in rows if group), default=0.0)


def describe(rows):
    return f"{rows[0][1]}/{rows[0][2]} {rows[0][3]} at {-rows[0][4]:.3g} m/s" if rows else "none"


def compare(one, other, scene, tolerance=1e-9, reach=0.0, names=("engine", "reference")):
    """The earliest difference of two runs of a scene, or None. reach: the largest coordinate of either run, if it is not the scene's."""
    extent, speed = scales(one, other)
    extent = max(extent, scene.extent())
    slow = 64 * math.sqrt(scene.acceleration() * max(extent, reach) * 2.0**-52)  # what a bounce of a few ulps of the coordinates takes
    found = [
        first_state_difference(one, other, scene.rate, tolerance, extent, speed, names),
        first_collision_difference(one, other, scene.rate, scene.steps, 10 * tolerance, speed, slow, names),
    ]
    if found[0] is None and found[1] and found[1].speed < 1e-3 * speed:
        found[1] = None  # no state shows it: the tail of an infinite sequence
    found = [d for d in found if d]
    if other.outcome == "endless" and len(one.log) > len(other.log) / 2:
        pass  # the limit of the reference is lower
    elif one.outcome != other.outcome or (one.outcome in ("crushed", "endless") and abs(len(one.states) - len(other.states)) > 1):
        step = min(len(one.states), len(other.states))
        text = f"{names[0]}: {one.outcome} after step {len(one.states) - 1} {one.message}; {names[1]}: {other.outcome} after step {len(other.states) - 1} {other.message}"
        found.append(Difference("outcome", step, text))
    return min(found, key=lambda d: d.step) if found else None


def beyond_the_horizon(difference, one, other, scene):
    """Whether a difference comes after so many collisions, at such a speed, that the digits of the state may be used up."""
    if difference is None:
        return False
    before = [row for row in other.log if row[0] * scene.rate < difference.step - 1e-9]
    first = max((abs(v) for state in other.states[:1] for row in state.values() for v in row[2:]), default=0.0)
    fall = math.sqrt(2 * scene.acceleration() * scene.extent())
    return len(before) > 1000 or max((-row[4] for row in before), default=0.0) > 100 * (first + fall)


# ---- many scenes

QUIET = {"same", "gaps of ulps", "resolution", "no reference", "horizon", "known"}


def known():
    """The differences that are explained: lines of kind, seed and class."""
    lines = (Path(__file__).parent / "differences.txt").read_text().splitlines()
    return {(line.split()[0], int(line.split()[1])) for line in lines if line and not line.startswith("#")}


def judge(task, options):
    kind, seed = task
    scene = scenes.random_scene(kind, seed)
    engine = run_engine(options.rebond, scene.toml(), options.seconds)
    if engine.outcome == "panic":
        return kind, seed, "panic", engine.message
    ideal = scene.ideal_toml()
    right = run_simulator(ideal, options.seconds)
    if right.outcome in ("refused", "timeout"):
        return kind, seed, "no reference", right.message
    difference = compare(engine, right, scene)
    if difference is None:
        return kind, seed, "same", ""
    if scene.has_gaps_of_ulps():
        exact = run_simulator(scene.exact_toml(), options.seconds)
        without = run_engine(options.rebond, ideal, options.seconds)
        if compare(engine, exact, scene) is None or compare(without, right, scene) is None:
            return kind, seed, "gaps of ulps", difference.text
    if difference.what == "outcome" and right.outcome == "endless":
        return kind, seed, "no reference", "the simulator reaches its limit of collisions"
    if beyond_the_horizon(difference, engine, right, scene) or difference.step >= accurate_until(scene.toml(), options):
        return kind, seed, "horizon", difference.text
    coarse = run_simulator(ideal, options.seconds, bits=simulator.COARSE)
    if coarse.outcome not in ("refused", "timeout") and compare(coarse, right, scene) is not None:
        return kind, seed, "resolution", difference.text
    return kind, seed, difference.what, difference.text


def accurate_until(text, options):
    """The step from which on rebond itself says that rounding can matter; infinite if it does not, or cannot say."""
    with tempfile.TemporaryDirectory(dir=memory_folder()) as folder:
        scene = Path(folder) / "scene.toml"
        scene.write_text(text)
        command = [options.rebond, "record", "--accuracy", "--json", scene, "-o", Path(folder) / "scene.mcap"]
        try:
            run = subprocess.run(command, capture_output=True, text=True, timeout=options.seconds)
        except subprocess.TimeoutExpired:
            return math.inf
    accuracy = json.loads(run.stdout).get("accuracy") if run.returncode == 0 else None
    return int(accuracy.split()[-1]) if accuracy and "until step" in accuracy else math.inf


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("rebond")
    parser.add_argument("--seeds", default="0..8")
    parser.add_argument("--kinds", default="all")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--folder", help="write the scenes that differ into this folder")
    parser.add_argument("--seconds", type=float, default=60, help="time limit of a run")
    options = parser.parse_args()
    tasks = [(kind, seed) for seed in scenes.seeds(options.seeds) for kind in scenes.kinds(options.kinds)]
    table, differences, explained, start = collections.defaultdict(collections.Counter), 0, known(), time.time()
    with Pool(options.jobs) as pool:
        for kind, seed, what, text in pool.imap_unordered(functools.partial(judge, options=options), tasks):
            if what not in QUIET and (kind, seed) in explained:
                what = "known"
            table[kind][what] += 1
            if what in QUIET:
                continue
            differences += 1
            print(f"{kind} {seed} {what}: {text}", flush=True)
            if options.folder:
                Path(options.folder).mkdir(parents=True, exist_ok=True)
                (Path(options.folder) / f"{kind}-{seed}.toml").write_text(scenes.random_scene(kind, seed).toml())
    columns = sorted({what for row in table.values() for what in row}, key=lambda w: (w not in QUIET, w))
    print("kind".ljust(12), *(c.rjust(max(8, len(c))) for c in columns))
    for kind in sorted(table):
        print(kind.ljust(12), *(str(table[kind][c]).rjust(max(8, len(c))) for c in columns))
    print(f"{len(tasks)} scenes, {differences} unexplained differences, {time.time() - start:.0f} s")
    return 1 if differences else 0


if __name__ == "__main__":
    sys.exit(main())
