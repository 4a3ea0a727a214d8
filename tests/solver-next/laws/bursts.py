"""Bursts: a row or a column of n touching boxes hits a wall. The impacts of the one instant are carried out in rational arithmetic,
lowest approaching pair in creation order first, and compared with the engine: number of impacts, their sequence, final velocities.

usage: bursts.py ENGINE [--sizes 2..17,20,30,60,110] [--coefficients 0.5,0.9,0.95,0.99,0.999,1] [--jobs 2] [--shapes row,column,heavy]

Shapes: row (along x) and column (along y) of equal boxes; heavy (a row whose last box has 100 kg); each with the wall created first
and the boxes from the wall outwards, and with everything in reverse order.

The arithmetic: numbers are integers times 2^−BITS, and every rounding is counted; an order that the counted error leaves open is
decided again with fractions. An infinite burst (e < 1) is carried out until its approach speeds are below 2^−64 of the greatest;
then the bodies that are joined by faces as slow as that take their common velocity, or the wall's. Its number of impacts is a matter
of when the limit is taken, so only its velocities are compared.
"""

import argparse
import functools
import hashlib
import heapq
import json
import sys
import time
from fractions import Fraction
from pathlib import Path

import running

BITS = 1000
ONE = 1 << BITS
DECAYED = 64


class Open(Exception):
    """The order of two events cannot be told with this precision."""


class Fixed:
    """Numbers as integers times 2^−BITS."""

    def __init__(self):
        self.error = 0  # bound of the rounding errors so far, in the last place

    def number(self, x):
        return int(x * ONE)

    def change(self, c, share):
        quotient, remainder = divmod(c * share.numerator, share.denominator)
        self.error += remainder != 0
        return quotient

    def positive(self, c):
        if c and abs(c) <= self.error:
            raise Open()
        return c > 0

    def value(self, x):
        return x / ONE


class Exact:
    """Numbers as fractions."""

    def number(self, x):
        return Fraction(x)

    def change(self, c, share):
        return c * share

    def positive(self, c):
        return c > 0

    def value(self, x):
        return float(x)


def burst(numbers, e, masses, ids, limit):
    """The impacts of bodies in a line that all move at −1 m/s and touch; masses[0] is that of the wall (None: infinite).

    ids are the places in creation order. Returns the impacts as pairs of places in the line, the velocities, and the number of
    impacts before the first limit of an infinite sequence was taken: None if there was none, −1 if there were too many impacts."""
    n = len(masses)
    v = [numbers.number(0)] + [numbers.number(-1)] * (n - 1)
    order = [tuple(sorted((ids[i], ids[i + 1]))) for i in range(n - 1)]
    joined = [False] * (n - 1)  # pair i, i + 1 is a contact
    heap, impacts, top, limit_taken = [], [], 0, None

    def look(i):
        if 0 <= i < n - 1 and numbers.positive(v[i] - v[i + 1]):
            heapq.heappush(heap, (order[i], i))

    def block(i, step):
        """The bodies pushed from i in a direction, and their mass; None if it is infinite."""
        members = [i]
        while 0 <= i + step < n and joined[min(i, i + step)]:
            i += step
            members.append(i)
        return members, None if any(masses[m] is None for m in members) else sum(masses[m] for m in members)

    for i in range(n - 1):
        look(i)
    while heap:
        _, i = heap[0]
        c = v[i] - v[i + 1]
        if not numbers.positive(c):
            heapq.heappop(heap)
            continue
        top = max(top, c)
        small = top / (1 << DECAYED) if isinstance(top, Fraction) else top >> DECAYED
        if c <= small and e < 1:
            limit_taken = len(impacts) if limit_taken is None else limit_taken
            first, last = i, i + 1
            while first > 0 and abs(v[first - 1] - v[first]) <= small:
                first -= 1
            while last < n - 1 and abs(v[last] - v[last + 1]) <= small:
                last += 1
            members = range(first, last + 1)
            if any(masses[m] is None for m in members):
                common = numbers.number(0)
            else:
                total = sum(masses[m] for m in members)
                common = sum(numbers.change(v[m], masses[m] / total) for m in members)
            for m in members:
                v[m] = common
            for m in range(first, last):
                joined[m] = True
            for m in range(first - 1, last + 1):
                look(m)
            continue
        left, right = block(i, -1), block(i + 1, 1)
        if left[1] is None:
            shares = 0, 1 + e
        elif right[1] is None:
            shares = 1 + e, 0
        else:
            shares = (1 + e) * right[1] / (left[1] + right[1]), (1 + e) * left[1] / (left[1] + right[1])
        for (members, _), share, sign in zip((left, right), shares, (-1, 1)):
            change = numbers.change(c, Fraction(share)) if share else 0
            for m in members:
                v[m] += sign * change
        impacts.append(i)
        if len(impacts) > limit:
            return impacts, [numbers.value(x) for x in v], -1
        lowest, highest = min(left[0]), max(right[0])
        for m in range(max(0, lowest - 1), min(n - 1, highest + 1)):
            if joined[m] and v[m] != v[m + 1]:
                joined[m] = False
            look(m)
    return impacts, [numbers.value(x) for x in v], limit_taken


def right(e, masses, ids, limit, cache=None):
    if cache:
        key = hashlib.sha256(f"2 {BITS} {DECAYED} {e} {masses} {ids} {limit}".encode()).hexdigest()[:32]
        kept = Path(cache) / f"burst-{key}.json"
        if kept.exists():
            return json.loads(kept.read_text())
    found = carried_out(e, masses, ids, limit)
    if cache:
        Path(cache).mkdir(parents=True, exist_ok=True)
        kept.write_text(json.dumps(found))
    return found


def carried_out(e, masses, ids, limit):
    try:
        return burst(Fixed(), e, masses, ids, limit)
    except Open:
        return burst(Exact(), e, masses, ids, min(limit, 2000))


def scene(n, e, shape, reverse):
    along = (lambda x: f"[{x!r}, 0.0]") if shape != "column" else (lambda x: f"[0.0, {x!r}]")
    spawns = [f'[[spawn]]\nname = "wall"\nat = {along(-1.0)}\nsize = [1.0, 1.0]\nmass = inf\n']
    for i in range(n):
        mass = 100.0 if shape == "heavy" and i == n - 1 else 1.0
        spawns.append(f'[[spawn]]\nname = "b{i}"\nat = {along(1.0 + i)}\nsize = [1.0, 1.0]\nmass = {mass!r}\nvelocity = {along(-1.0)}\n')
    head = f'[world]\nsize = [16.0, 9.0]\n[run]\nrate = 4.0\nsteps = 8\nsolver = "event-driven"\n[restitution]\ndefault = {e}\n'
    return head + "".join(reversed(spawns) if reverse else spawns)


def judge(task, options):
    shape, reverse, e, n = task
    masses = [None] + [Fraction(1)] * n
    if shape == "heavy":
        masses[-1] = Fraction(100)
    ids = [n - i for i in range(n + 1)] if reverse else list(range(n + 1))
    impacts, v, limit_taken = right(Fraction(e), masses, ids, options.limit, options.cache)
    if limit_taken == -1:
        return task, "no reference", f"more than {len(impacts)} impacts", 0, 0
    start = time.time()
    result = running.run_engine(options.engine, scene(n, e, shape, reverse), options.seconds)
    seconds = time.time() - start
    if result.outcome != "ok":
        return task, "DIFFERS", f"{result.outcome} {result.message}; right: {len(impacts)} impacts", len(impacts), seconds
    k = 2 if shape != "column" else 3
    last = [result.states[-1][name][k] for name in ["wall", *(f"b{i}" for i in range(n))]]
    worst = max(range(n + 1), key=lambda i: abs(last[i] - v[i]))
    problems = []
    if abs(last[worst] - v[worst]) > 1e-9:
        problems.append(f"b{worst - 1} leaves at {last[worst]:+.12f}, right {v[worst]:+.12f}")
    names = ["wall", *(f"b{i}" for i in range(n))]
    sequence = [names.index(row[1]) if names.index(row[1]) < names.index(row[2]) else names.index(row[2]) for row in result.log]
    ended = limit_taken is None
    common = min(len(sequence), len(impacts) if ended else limit_taken)
    unlike = next((m for m in range(common) if sequence[m] != impacts[m]), None)
    if ended and len(sequence) != len(impacts):
        problems.append(f"{len(sequence)} impacts, right {len(impacts)}")
    if unlike is not None:
        a, b = ([names[s[unlike]], names[s[unlike] + 1]] for s in (sequence, impacts))
        problems.append(f"impact {unlike + 1} is {a}, right {b}")
    if any(row[6] <= 0 for row in result.log):
        problems.append(f"an impulse of {min(row[6] for row in result.log)!r} N·s")
    about = f"{len(impacts)} impacts" if ended else f"infinite, limit taken after {len(sequence)} (here {len(impacts)})"
    return task, "DIFFERS" if problems else "same", "; ".join([*problems, about]), len(impacts), seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engine")
    parser.add_argument("--sizes", default="2..21,24,30,40,50,60,70,80,90,100,110")
    parser.add_argument("--coefficients", default="0.5,0.9,0.95,0.99,0.999,1")
    parser.add_argument("--shapes", default="row,column,heavy")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--limit", type=int, default=400000, help="the most impacts that are carried out here")
    parser.add_argument("--cache", help="folder that keeps what was carried out here")
    parser.add_argument("--all", action="store_true", help="print the bursts that are right, too")
    options = parser.parse_args()
    sizes = []
    for part in options.sizes.split(","):
        first, dots, end = part.partition("..")
        sizes += range(int(first), int(end)) if dots else [int(first)]
    tasks = [(shape, reverse, e, n) for shape in options.shapes.split(",") for reverse in (False, True)
             for e in options.coefficients.split(",") for n in sizes]
    counts, slowest = {}, (0, None, 0)
    for task, verdict, text, impacts, seconds in running.in_parallel(functools.partial(judge, options=options), tasks, options.jobs):
        counts[verdict] = counts.get(verdict, 0) + 1
        slowest = max(slowest, (seconds, task, impacts), key=lambda s: s[0])
        if verdict != "same" or options.all:
            shape, reverse, e, n = task
            print(f"{shape}{' reversed' if reverse else ''} e = {e} n = {n}: {verdict}: {text}", flush=True)
    print(", ".join(f"{verdict} {count}" for verdict, count in sorted(counts.items())))
    print(f"the slowest took {slowest[0]:.2f} s with {slowest[2]} impacts: {slowest[1]}")
    return 1 if "DIFFERS" in counts else 0


if __name__ == "__main__":
    sys.exit(main())
