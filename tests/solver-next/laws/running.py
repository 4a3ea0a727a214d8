"""Runs scenes in the engine and in the reference, and compares what comes out.

The engine is a program `ENGINE SCENE.toml --log` that prints `step,name,x,y,vx,vy` lines on standard output, the collisions
`time,a,b,axis,vn_before,vn_after,impulse` and an error, if any, on standard error. The reference is a Python module with
`simulate(text, binary, sample)`.
"""

import contextlib
import functools
import hashlib
import importlib.util
import json
import math
import os
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass, field
from multiprocessing import Pool
from pathlib import Path


@dataclass
class Result:
    """What a run gave: a state per step, the collisions, and how it ended."""

    states: list = field(default_factory=list)  # of each step {name: (x, y, vx, vy)}
    log: list = field(default_factory=list)  # (time, a, b, axis, vn_before, vn_after, impulse)
    outcome: str = "ok"  # or crushed, endless, refused, panic, timeout
    message: str = ""


# ---- the engine


def run_engine(engine, text, seconds=60):
    with tempfile.NamedTemporaryFile("w", suffix=".toml", dir=memory_folder()) as scene:
        scene.write(text)
        scene.flush()
        try:
            done = subprocess.run([engine, scene.name, "--log"], capture_output=True, text=True, timeout=seconds)
        except subprocess.TimeoutExpired:
            return Result(outcome="timeout", message=f"more than {seconds} s")
    result = Result(states=read_states(done.stdout))
    words = []
    for line in done.stderr.splitlines():
        row = line.rsplit(",", 6)
        try:
            result.log.append((float(row[0]), row[1], row[2], row[3], *map(float, row[4:7])))
        except (ValueError, IndexError, TypeError):
            if not line.startswith("collisions"):
                words.append(line)
    result.message = " ".join(words)[:300]
    result.outcome = outcome(done.returncode, result.message)
    return result


def outcome(code, message):
    if code == 0:
        return "ok"
    if code not in (1, 2) or "panicked" in message:
        return "panic"
    if "crushed" in message:
        return "crushed"
    if any(word in message for word in ("endless", "events", "for ever", "infinitely")):
        return "endless"
    return "refused"


def read_states(text):
    states = []
    for line in text.splitlines()[1:]:
        step, name, *numbers = line.split(",")
        step = int(step)
        while len(states) <= step:
            states.append({})
        states[step][name] = tuple(map(float, numbers))
    return states


def memory_folder():
    return "/dev/shm" if os.path.isdir("/dev/shm") else None


# ---- the reference


class TooSlow(Exception):
    pass


@functools.lru_cache
def load_reference(path):
    spec = importlib.util.spec_from_file_location("reference", path)
    module = importlib.util.module_from_spec(spec)
    with arguments([path]):
        spec.loader.exec_module(module)
    return module


@contextlib.contextmanager
def arguments(replacement):
    before, sys.argv = sys.argv, replacement
    try:
        yield
    finally:
        sys.argv = before


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


def run_reference(reference, text, binary, seconds=60, limit=20000, cache=None):
    """Runs the reference, or takes what it gave before from the folder `cache`."""
    if cache:
        source = Path(reference.__file__).read_bytes()
        key = hashlib.sha256(source + f"{binary} {limit} {text}".encode()).hexdigest()[:32]
        kept = Path(cache) / f"{key}.json"
        if kept.exists():
            stored = json.loads(kept.read_text())
            if stored["outcome"] != "timeout" or stored["seconds"] >= seconds:
                states = [{name: tuple(row) for name, row in state.items()} for state in stored["states"]]
                return Result(states, [tuple(row) for row in stored["log"]], stored["outcome"], stored["message"])
    result, sims = Result(), []

    def sample(step, sim):
        if not sims:
            sims.append(sim)
            sim.limit = limit
        state = {sim.name[i]: tuple(map(float, sim.x[i] + sim.v[i])) for i in range(len(sim.name)) if sim.alive[i]}
        result.states.append(state)

    try:
        with time_limit(seconds):
            reference.simulate(text, binary, sample)
    except TooSlow:
        result.outcome, result.message = "timeout", f"more than {seconds} s"
    except reference.Crushed as error:
        result.outcome, result.message = "crushed", str(error)
    except reference.Endless as error:
        result.outcome, result.message = "endless", str(error)
    except AssertionError as error:
        result.outcome, result.message = "refused", str(error) or "an assertion of the reference"
    except Exception as error:  # e.g. a delete of a body that is gone
        result.outcome, result.message = "refused", repr(error)
    if sims:
        names = sims[0].name
        result.log = [(float(t), names[i], names[j], "xy"[k], *map(float, (before, after, impulse)))
                      for t, i, j, k, before, after, impulse in sims[0].log]
    if cache:
        Path(cache).mkdir(parents=True, exist_ok=True)
        stored = {"states": result.states, "log": result.log, "outcome": result.outcome, "message": result.message, "seconds": seconds}
        kept.with_suffix(f".{os.getpid()}").write_text(json.dumps(stored))
        kept.with_suffix(f".{os.getpid()}").replace(kept)
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


def in_parallel(work, items, jobs):
    """Results in the order in which they come."""
    if jobs <= 1:
        yield from map(work, items)
        return
    with Pool(jobs) as pool:
        yield from pool.imap_unordered(work, items)
