"""Checks on random scenes what mechanics keeps, from the engine's own output alone.

usage: invariants.py ENGINE [--seeds 0..100] [--kinds all] [--jobs 2] [--folder FOLDER]

overlap      no two boxes overlap by more than 16 ulps of their coordinates at any step
impulse      every impulse is positive, of a pair that approaches, and vn' = −e·vn (or 0: the limit of an infinite sequence)
energy       with resting infinite masses and without spawns and deletes on the way: kinetic and potential energy fall by at least
             what the collisions took, ½(1 − e)·vn·J each, and by exactly that if no sequence was cut short (e = 1)
momentum     without infinite masses: p(t) = p(0) + (Σ m·g + F)·t
reversal     (kind `gas`, isolated impacts at e = 1): with all velocities reversed at the last step the scene returns to its start
One line per violation; then the number of scenes and of violations of each law.
"""

import argparse
import collections
import functools
import math
import random
import sys
import time
from pathlib import Path

import running
import scenes

ULP = 2.0**-52


def gas(seed):
    """A few boxes in a box at e = 1, in general position: nothing coincides."""
    r = random.Random(f"gas {seed}")
    scene = scenes.Scene("gas", seed, rate=32.0, steps=32, restitution={"default": 1.0})
    walls = [((-1.0, -1.0), (10.0, 1.0)), ((-1.0, 6.0), (10.0, 1.0)), ((-1.0, 0.0), (1.0, 6.0)), ((8.0, 0.0), (1.0, 6.0))]
    scene.bodies = [scenes.Body(f"wall{i}", at, size, math.inf) for i, (at, size) in enumerate(walls)]
    if r.random() < 0.5:
        scene.gravity = (r.uniform(-2, 2), r.uniform(0, 9))
    for i in range(r.randint(2, 6)):
        for _ in range(50):
            size = r.uniform(0.3, 1.5), r.uniform(0.3, 1.5)
            at = r.uniform(0.1, 7.9 - size[0]), r.uniform(0.1, 5.9 - size[1])
            if all(not (p < b.at[0] + b.size[0] and b.at[0] < p + w and q < b.at[1] + b.size[1] and b.at[1] < q + h)
                   for b in scene.bodies for (p, q), (w, h) in [(at, size)]):
                force = (r.uniform(-3, 3), r.uniform(-3, 3)) if r.random() < 0.3 else (0.0, 0.0)
                scene.bodies.append(scenes.Body(f"b{i}", at, size, r.choice([1.0, 1.0, 0.3, 5.0]), (r.uniform(-3, 3), r.uniform(-3, 3)), force))
                break
    return scene


def coefficient(scene, a, b):
    table = scene.restitution
    return table.get(f"{a}/{b}", table.get(f"{b}/{a}", table["default"])) if a and b else table["default"]


def overlaps(scene, result):
    box = {b.name: b for b in scene.bodies}
    still = {b.name for b in scene.bodies if math.isinf(b.mass)}
    late = {b.name for b in scene.bodies if b.step}
    for step, state in enumerate(result.states):
        names = list(state)
        for i, a in enumerate(names):
            for b in names[i + 1:]:
                if a in still and b in still:
                    continue
                depths, scale = [], 0.0
                for k in (0, 1):
                    low, high = max(state[a][k], state[b][k]), min(state[a][k] + box[a].size[k], state[b][k] + box[b].size[k])
                    depths.append(high - low)
                    scale = max(scale, abs(state[a][k]) + box[a].size[k], abs(state[b][k]) + box[b].size[k])
                if min(depths) > 16 * ULP * scale:
                    if late & {a, b}:
                        return None  # a spawn into a body in flight
                    return f"step {step}: {a} and {b} overlap by {min(depths):.3g} m"
    return None


def impulses(scene, result):
    material = {b.name: b.material for b in scene.bodies}
    fastest = max((-row[4] for row in result.log), default=0.0)
    for row in result.log:
        time, a, b, axis, before, after, impulse = row
        e = coefficient(scene, material[a], material[b])
        if before > 0 or impulse < 0 or not all(map(math.isfinite, row[4:])):
            return f"t = {time!r}: {a}/{b} {axis}: vn {before!r} to {after!r}, impulse {impulse!r}"
        if abs(after + e * before) > 1e-9 * fastest and after != 0:
            return f"t = {time!r}: {a}/{b} {axis}: e is {e}, but vn {before!r} becomes {after!r}"
    return None


def energy(scene, result):
    if scene.deletes or any(b.step or math.isinf(b.mass) and any(b.velocity) for b in scene.bodies):
        return None
    material = {b.name: b.material for b in scene.bodies}
    finite = [b for b in scene.bodies if math.isfinite(b.mass)]
    times, taken = [], []
    total = 0.0
    for t, a, b, _, before, after, impulse in result.log:
        e = coefficient(scene, material[a], material[b])
        total += 0.5 * (1 - e) * -before * impulse if after else 0.5 * -before * impulse
        times.append(t)
        taken.append(total)
    kept = all(e == 1 for e in scene.restitution.values())
    first, place, lost = None, 0, 0.0
    before = math.inf
    for step, state in enumerate(result.states):
        now = scale = 0.0
        for b in finite:
            x, y, vx, vy = state[b.name]
            kinetic = 0.5 * b.mass * (vx * vx + vy * vy)
            f = [b.mass * g + c for g, c in zip(scene.gravity, b.force)]
            now += kinetic - f[0] * x - f[1] * y
            scale += kinetic + abs(f[0] * x) + abs(f[1] * y) + b.mass * 1e-3
        while place < len(times) and times[place] <= step / scene.rate - 1e-12:
            lost, place = taken[place], place + 1
        first = now if first is None else first
        if now > first - lost + 1e-9 * (scale + abs(first) + lost):
            return f"step {step}: energy {now!r}, at most {first - lost!r}"
        if now > before + 1e-9 * (scale + abs(first)):
            return f"step {step}: energy rises from {before!r} to {now!r}"
        if kept and now < first - 1e-9 * (scale + abs(first)):
            return f"step {step}: energy {now!r}, was {first!r}, e = 1"
        before = now
    return None


def momentum(scene, result):
    if scene.deletes or any(b.step or math.isinf(b.mass) for b in scene.bodies):
        return None
    for k in (0, 1):
        force = sum(b.mass * scene.gravity[k] + b.force[k] for b in scene.bodies)
        start = sum(b.mass * b.velocity[k] for b in scene.bodies)
        for step, state in enumerate(result.states):
            right = start + force * step / scene.rate
            now = sum(b.mass * state[b.name][k + 2] for b in scene.bodies)
            scale = sum(b.mass * (abs(state[b.name][k + 2]) + abs(b.velocity[k])) + (abs(b.mass * scene.gravity[k]) + abs(b.force[k])) * step / scene.rate for b in scene.bodies)
            if abs(now - right) > 1e-9 * scale:
                return f"step {step}: momentum along {'xy'[k]} {now!r}, right {right!r}"
    return None


def reversal(scene, result, engine):
    if scene.kind != "gas" or result.outcome != "ok":
        return None
    back = scene.copy()
    for b in back.bodies:
        x, y, vx, vy = result.states[-1][b.name]
        b.at, b.velocity = (x, y), (-vx, -vy)
    other = running.run_engine(engine, back.toml())
    if other.outcome != "ok":
        return f"{other.outcome} on the way back: {other.message}"
    growth = max(1.0, 3.0 ** min(30, len(result.log)))
    for b in scene.bodies:
        if math.isinf(b.mass):
            continue
        x, y, vx, vy = other.states[-1][b.name]
        off = max(abs(x - b.at[0]), abs(y - b.at[1]), abs(vx + b.velocity[0]), abs(vy + b.velocity[1]))
        if off > min(1e-3, max(1e-9, 1e-15 * growth)):
            return f"{b.name} comes back {off:.3g} from where it was, after {len(result.log)} and {len(other.log)} collisions"
    return None


LAWS = {"overlap": overlaps, "impulse": impulses, "energy": energy, "momentum": momentum}


def judge(task, options):
    kind, seed = task
    scene = gas(seed) if kind == "gas" else scenes.random_scene(kind, seed)
    result = running.run_engine(options.engine, scene.toml(), options.seconds)
    found = []
    if result.outcome in ("panic", "timeout", "refused"):
        found.append((result.outcome, result.message))
    for name, law in LAWS.items():
        text = law(scene, result)
        if text:
            found.append((name, text))
    text = reversal(scene, result, options.engine)
    if text:
        found.append(("reversal", text))
    return kind, seed, found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engine")
    parser.add_argument("--seeds", default="0..100")
    parser.add_argument("--kinds", default="all", help="also: gas")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--folder", default="differences")
    parser.add_argument("--seconds", type=float, default=20)
    options = parser.parse_args()
    kinds = [*scenes.KINDS, "gas"] if options.kinds == "all" else options.kinds.split(",")
    tasks = [(kind, seed) for seed in scenes.seeds(options.seeds) for kind in kinds]
    counts, start = collections.Counter(), time.time()
    for kind, seed, found in running.in_parallel(functools.partial(judge, options=options), tasks, options.jobs):
        for law, text in found:
            counts[law] += 1
            print(f"{kind} {seed} {law}: {text}", flush=True)
            folder = Path(options.folder)
            folder.mkdir(parents=True, exist_ok=True)
            scene = gas(seed) if kind == "gas" else scenes.random_scene(kind, seed)
            (folder / f"{kind}-{seed}.toml").write_text(f"# {law}: {text}\n{scene.toml()}")
    print(f"{len(tasks)} scenes, {time.time() - start:.0f} s:", ", ".join(f"{law} {n}" for law, n in sorted(counts.items())) or "no violation")
    return 1 if counts else 0


if __name__ == "__main__":
    sys.exit(main())
