"""Checks on random scenes what must not depend on how a scene is written down.

usage: transforms.py ENGINE [--seeds 0..100] [--kinds all] [--laws all] [--jobs 2] [--folder FOLDER] [--summary FILE]

Laws to the bit:   axes (exchanged), lengths, masses, times (each × 2^±k), rates (× 2^k), distant (bodies far away, created before or after)
Laws to 1e-9:      rate15 (rate × 15), mirror-x, mirror-y, translation (by dyadic numbers), frame (another inertial frame)
The last five apply where the transformed numbers are exact; for the mirror, the translation and the frame, how long an infinite
sequence is carried out before its limit is taken may differ. `to the bit` includes every collision: bodies, instant, velocities,
impulse. One line per difference, the two scenes are written into FOLDER, then a table.
"""

import argparse
import collections
import functools
import json
import math
import random
import sys
import time
from fractions import Fraction
from pathlib import Path

import running
import scenes


# ---- the transformed scenes: each gives a scene, or None where the numbers would not be exact, and a function for the results


def same(result):
    return result


def axes(scene, r):
    other = scene.copy()
    scenes.exchange_axes(other)

    def back(result):
        result.states = [{n: (y, x, vy, vx) for n, (x, y, vx, vy) in state.items()} for state in result.states]
        result.log = [(t, a, b, "yx"["xy".index(axis)], *rest) for t, a, b, axis, *rest in result.log]
        return sort_corners(result)

    return other, back, sort_corners


def sort_corners(result):
    """The order of two impacts of one pair in one instant on both axes is a matter of the axes' names."""
    log = result.log
    for n in range(len(log) - 1):
        if log[n][:3] == log[n + 1][:3] and log[n][3] == "y" and log[n + 1][3] == "x":
            log[n], log[n + 1] = log[n + 1], log[n]
    return result


def scaled(scene, length, mass, second):
    """Units changed by powers of two, given as exponents."""
    L, M, T = 2.0**length, 2.0**mass, 2.0**second
    other = scene.copy()
    other.rate = scene.rate / T
    times = lambda p, f: tuple(v * f for v in p)
    other.gravity = times(scene.gravity, L / T / T)
    for b in other.bodies:
        # gaps of some ulps first, since the least lengths are not all multiples of one
        b.at = tuple(scenes.move(x, n) for x, n in zip(b.at, b.ulps))
        b.ulps = (0, 0)
        b.at, b.size, b.velocity = times(b.at, L), times(b.size, L), times(b.velocity, L / T)
        b.force, b.mass = times(b.force, M * L / T / T), b.mass * M

    def back(result):
        V, J = L / T, M * L / T
        result.states = [{n: (x / L, y / L, vx / V, vy / V) for n, (x, y, vx, vy) in s.items()} for s in result.states]
        result.log = [(t / T, a, b, k, p / V, q / V, j / J) for t, a, b, k, p, q, j in result.log]
        return result

    return other, back, same


def power(r):
    return r.choice([-1, 1]) * r.choice([1, 2, 7, 20, 60])


def lengths(scene, r):
    return scaled(scene, power(r), 0, 0)


def masses(scene, r):
    return scaled(scene, 0, power(r), 0)


def times(scene, r):
    return scaled(scene, 0, 0, power(r))


def faster(scene, factor):
    other = scene.copy()
    other.rate, other.steps = scene.rate * factor, scene.steps * factor
    for b in other.bodies:
        b.step *= factor
    other.deletes = [(step * factor, name) for step, name in scene.deletes]

    def back(result):
        result.states = result.states[::factor]
        return result

    return other, back, same


def rates(scene, r):
    return faster(scene, r.choice([2, 2, 4, 8, 16]))


def rate15(scene, r):
    return faster(scene, 15)


def distant(scene, r):
    """Bodies far from all others, with events of their own, created before or after them."""
    other, far, new = scene.copy(), r.choice([2.0**14, -(2.0**14), 2.0**20]), []
    heavy = r.choice([0.25, 1.0, 1e6])
    what = r.choice(["one", "stack", "moving", "forces"])
    if what == "one":
        new.append(scenes.Body("far0", (far, far), (1.0, 1.0), r.choice([math.inf, 1.0])))
    elif what == "stack":
        new.append(scenes.Body("far0", (far, far), (4.0, 1.0), math.inf))
        new += [scenes.Body(f"far{i}", (far + 1, far - i - i % 2 * 0.5), (1.0, 1.0), heavy) for i in (1, 2, 3)]
    elif what == "moving":
        new.append(scenes.Body("far0", (far, far), (1.0, 9.0), math.inf))
        new += [scenes.Body(f"far{i}", (far + i, far), (1.0, 1.0), heavy, (-1.5, 0.25 * i)) for i in (1, 2, 3)]
    else:
        new.append(scenes.Body("far0", (far, far), (1.0, 1.0), heavy, force=(3.0, 1.0)))
        new.append(scenes.Body("far1", (far + 1, far), (1.0, 1.0), 1.0, force=(-7.0, 0.5)))
        new.append(scenes.Body("far2", (far + 1, far + 1), (1.0, 1.0), 1.0, force=(0.0, -20.0)))
    other.bodies = new + other.bodies if r.random() < 0.5 else other.bodies + new
    names = {b.name for b in new}

    def back(result):
        result.states = [{n: row for n, row in state.items() if n not in names} for state in result.states]
        result.log = [row for row in result.log if not {row[1], row[2]} & names]
        return result

    return other, back, same


def mirror(axis):
    def law(scene, r):
        if scene.reading != "binary" or not all(exact_sum(b.at[axis], b.size[axis]) for b in scene.bodies):
            return None
        other = scene.copy()
        scenes.mirror(other, axis)
        size = {b.name: b.size[axis] for b in scene.bodies}

        def back(result):
            def turned(name, row):
                row = list(row)
                row[axis], row[axis + 2] = -(row[axis] + size[name]), -row[axis + 2]
                return tuple(row)

            result.states = [{n: turned(n, row) for n, row in state.items()} for state in result.states]
            return result

        return other, back, same

    return law


def exact_sum(a, b):
    return Fraction(a) + Fraction(b) == Fraction(a + b)


def translation(scene, r):
    if scene.reading != "binary":
        return None
    by = tuple(r.choice([0.0, 0.25, -3.0, 17.0, 1024.0, -4096.5, 2.0**20, 1 / 64]) for _ in "xy")
    if not all(exact_sum(x, d) for b in scene.bodies for x, d in zip(b.at, by)):
        return None
    other = scene.copy()
    for b in other.bodies:
        b.at = tuple(x + d for x, d in zip(b.at, by))

    def back(result):
        result.states = [{n: (x - by[0], y - by[1], vx, vy) for n, (x, y, vx, vy) in s.items()} for s in result.states]
        return result

    return other, back, same


def frame(scene, r):
    if scene.reading != "binary" or not math.log2(scene.rate).is_integer():
        return None
    by = tuple(r.choice([0.0, 0.5, -1.0, 3.0, -8.0, 0.125]) for _ in "xy")
    other = scene.copy()
    for b in other.bodies:
        shift = tuple(d * b.step / scene.rate for d in by)
        if not all(exact_sum(*p) for p in (*zip(b.velocity, by), *zip(b.at, shift))):
            return None
        b.velocity = tuple(v + d for v, d in zip(b.velocity, by))
        b.at = tuple(x + d for x, d in zip(b.at, shift))

    def back(result):
        def row(step, x, y, vx, vy):
            t = step / scene.rate
            return x - by[0] * t, y - by[1] * t, vx - by[0], vy - by[1]

        result.states = [{n: row(step, *p) for n, p in s.items()} for step, s in enumerate(result.states)]
        return result

    return other, back, same


BITS = {"axes": axes, "lengths": lengths, "masses": masses, "times": times, "rates": rates, "distant": distant}
NEAR = {"rate15": rate15, "mirror-x": mirror(0), "mirror-y": mirror(1), "translation": translation, "frame": frame}
LAWS = BITS | NEAR


# ---- comparison


def to_the_bit(one, other, scene):
    """The first number that is not the same; −0 equals 0. Told apart: only printed instants differ, in the last digit."""
    last_digit = ""
    for step, (p, q) in enumerate(zip(one.states, other.states)):
        for name in p:
            if p[name] != q.get(name):
                return running.Difference("states", step, f"step {step}: {name} {p[name]} becomes {q.get(name)}")
    for n, (p, q) in enumerate(zip(one.log, other.log)):
        if p[1:] == q[1:] and abs(p[0] - q[0]) <= 4 * math.ulp(p[0]):
            last_digit = last_digit or (p[0] != q[0] and f"collision {n + 1}: at {p[0]!r} becomes {q[0]!r}")
        elif p != q:
            return running.Difference("collisions", p[0] * scene.rate, f"collision {n + 1}: {p} becomes {q}")
    if len(one.log) != len(other.log):
        row = max(one.log, other.log, key=len)[min(len(one.log), len(other.log))]
        return running.Difference("collisions", row[0] * scene.rate, f"{len(one.log)} collisions become {len(other.log)}; the first other is {row}")
    if one.outcome != other.outcome:
        return running.Difference("outcome", 0, f"{one.outcome} {one.message} becomes {other.outcome} {other.message}")
    if last_digit:
        return running.Difference("last digit of an instant", 0, last_digit)
    return None


def judge(task, options):
    kind, seed = task
    scene = scenes.random_scene(kind, seed)
    plain = running.run_engine(options.engine, scene.toml(), options.seconds)
    found = []
    if plain.outcome == "panic":
        found.append((kind, seed, "plain", "panic", plain.message, None))
    checked = []
    for name in options.laws:
        law = LAWS[name](scene, random.Random(f"{name} {kind} {seed}"))
        if law is None:
            continue
        checked.append(name)
        other, back, forth = law
        result = back(running.run_engine(options.engine, other.toml(), options.seconds * (16 if name.startswith("rate") else 1)))
        first = forth(running.Result(list(plain.states), list(plain.log), plain.outcome, plain.message))
        if "timeout" in (first.outcome, result.outcome):
            if first.outcome != result.outcome:
                found.append((kind, seed, name, "timeout", f"{first.outcome} becomes {result.outcome}", other.toml()))
            continue
        if name in BITS:
            difference = to_the_bit(first, result, scene)
        else:
            difference = running.compare(first, result, scene, reach=other.extent(), names=("plain", name))
        if name in NEAR and running.beyond_the_horizon(difference, first, result, scene):
            continue
        if difference:
            found.append((kind, seed, name, difference.what, difference.text, other.toml()))
    return kind, seed, checked, found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engine")
    parser.add_argument("--seeds", default="0..100")
    parser.add_argument("--kinds", default="all")
    parser.add_argument("--laws", default="all", help=", ".join(LAWS))
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--folder", default="differences")
    parser.add_argument("--seconds", type=float, default=20)
    parser.add_argument("--summary")
    options = parser.parse_args()
    options.laws = list(LAWS) if options.laws == "all" else options.laws.split(",")
    tasks = [(kind, seed) for seed in scenes.seeds(options.seeds) for kind in scenes.kinds(options.kinds)]
    checked, differing, lines, start = collections.Counter(), collections.defaultdict(collections.Counter), [], time.time()
    for kind, seed, names, found in running.in_parallel(functools.partial(judge, options=options), tasks, options.jobs):
        checked.update(names)
        for kind, seed, law, what, text, other in found:
            differing[law][kind] += 1
            lines.append((kind, seed, law, what, text))
            print(f"{kind} {seed} {law} {what}: {text}", flush=True)
            folder = Path(options.folder)
            folder.mkdir(parents=True, exist_ok=True)
            (folder / f"{kind}-{seed}.toml").write_text(scenes.random_scene(kind, seed).toml())
            if other:
                (folder / f"{kind}-{seed}-{law}.toml").write_text(f"# {what}: {text}\n{other}")
    print("law".ljust(12), "scenes".rjust(7), "differ".rjust(7), " kinds")
    for law in [*options.laws, "plain"]:
        if law in checked or law in differing:
            kinds = ", ".join(f"{kind} {n}" for kind, n in sorted(differing[law].items()))
            print(law.ljust(12), str(checked[law]).rjust(7), str(sum(differing[law].values())).rjust(7), f" {kinds}")
    print(f"{len(tasks)} scenes, {len(lines)} differences, {time.time() - start:.0f} s")
    if options.summary:
        Path(options.summary).write_text(json.dumps({"seeds": options.seeds, "checked": checked, "lines": sorted(lines)}))
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
