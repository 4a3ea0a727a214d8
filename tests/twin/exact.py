#!/usr/bin/env python3
"""Runs random scenes with the event-driven solver and with a reference simulation in 60-digit arithmetic.

    python3 tests/twin/exact.py [path of rebond] [number of scenes]

The reference shares no code with the solver: it tests every pair of bodies, computes each time of impact as a
root of a quadratic in 60-digit decimals, and has no state except the bodies. In scenes without resting contacts,
positions must agree to 1e-10 m or 4 ulps, whichever is larger, and the number of collisions exactly.
"""

import csv
import io
import json
import math
import random
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from decimal import Decimal, getcontext
from pathlib import Path

getcontext().prec = 60
ZERO, INFINITE = Decimal(0), Decimal("Infinity")
REBOND = sys.argv[1] if len(sys.argv) > 1 else "target/release/rebond"
SCENES = int(sys.argv[2]) if len(sys.argv) > 2 else 30


@dataclass
class Body:
    name: str
    at: list
    size: list
    mass: Decimal
    velocity: list
    acceleration: list
    since: Decimal = ZERO

    def state(self, time, axis):
        t = time - self.since
        position = self.at[axis] + self.velocity[axis] * t + self.acceleration[axis] * t * t / 2
        return position, self.velocity[axis] + self.acceleration[axis] * t

    def advance(self, time):
        states = [self.state(time, axis) for axis in (0, 1)]
        self.at = [position for position, _ in states]
        self.velocity = [velocity for _, velocity in states]
        self.since = time


def roots(a, b, c):
    """The real roots of a·t² + b·t + c."""
    if a == 0:
        return [] if b == 0 else [-c / b]
    discriminant = b * b - 4 * a * c
    if discriminant < 0:
        return []
    q = -(b + (discriminant.sqrt() if b >= 0 else -discriminant.sqrt())) / 2
    return [q / a] + ([c / q] if q != 0 else [])


def next_impact(a, b, now):
    """The time and axis of the next impact of faces of the pair, or None."""
    relative = []
    for axis in (0, 1):
        (xa, va), (xb, vb) = a.state(now, axis), b.state(now, axis)
        relative.append((xb - xa, vb - va, (b.acceleration[axis] - a.acceleration[axis]) / 2))
    best = None
    for axis in (0, 1):
        other = 1 - axis
        x, v, h = relative[axis]
        y, w, k = relative[other]
        for face in (-b.size[axis], a.size[axis]):
            for t in roots(h, v, x - face):
                closing = v + 2 * h * t
                approaching = closing < 0 if face > 0 else closing > 0
                offset = y + w * t + k * t * t
                if t > Decimal("-1e-45") and approaching and -b.size[other] < offset < a.size[other]:
                    if best is None or t < best[0]:
                        best = (t, axis)
    return best and (now + max(best[0], ZERO), best[1])


def collide(a, b, axis, e):
    inverse = [ZERO if body.mass == INFINITE else 1 / body.mass for body in (a, b)]
    impulse = (1 + e) * (b.velocity[axis] - a.velocity[axis]) / (inverse[0] + inverse[1])
    a.velocity[axis] += impulse * inverse[0]
    b.velocity[axis] -= impulse * inverse[1]


def simulate(scene, times):
    """States at the given times and the number of collisions up to the last."""
    bodies, e = scene["bodies"], scene["e"]
    pairs = {}

    def predict(i, now):
        for j in range(len(bodies)):
            if i != j and not (bodies[i].mass == INFINITE and bodies[j].mass == INFINITE):
                pair = (min(i, j), max(i, j))
                pairs[pair] = next_impact(bodies[pair[0]], bodies[pair[1]], now)

    for i in range(len(bodies)):
        predict(i, ZERO)
    collisions, states = 0, []
    for time in times:
        while True:
            due = [(found[0], pair) for pair, found in pairs.items() if found and found[0] <= time]
            if not due:
                break
            now, (i, j) = min(due)
            bodies[i].advance(now)
            bodies[j].advance(now)
            collide(bodies[i], bodies[j], pairs[(i, j)][1], e)
            collisions += 1
            predict(i, now)
            predict(j, now)
        states.append([[body.state(time, axis)[0] for axis in (0, 1)] for body in bodies])
    return states, collisions


def make(seed):
    """A random scene as TOML and as input of the reference."""
    draw = random.Random(seed)
    kind = ["gas", "masses", "gravity", "forces", "damped", "movers"][seed % 6]
    side, count = 12.0, 14
    gravity = [draw.uniform(-3, 3), draw.uniform(2, 10)] if kind == "gravity" else None
    e = 0.9 if kind == "damped" else 1.0
    spawns = []
    while len(spawns) < count:
        size = [draw.uniform(0.3, 1.5), draw.uniform(0.3, 1.5)]
        at = [draw.uniform(0.1, side - 0.1 - size[0]), draw.uniform(0.1, side - 0.1 - size[1])]
        if any(all(abs(at[k] + size[k] / 2 - o["at"][k] - o["size"][k] / 2) < (size[k] + o["size"][k]) / 2 + 0.01
                   for k in (0, 1)) for o in spawns):
            continue
        mass = 10 ** draw.uniform(-3, 3) if kind == "masses" else draw.uniform(0.5, 4)
        velocity = [draw.uniform(-6, 6), draw.uniform(-6, 6)]
        if kind == "movers" and len(spawns) == 0:
            mass, velocity = math.inf, [0.125, -0.25]
        force = [draw.uniform(-4, 4), draw.uniform(-4, 4)] if kind == "forces" else [0.0, 0.0]
        spawns.append(dict(name=f"b{len(spawns)}", at=at, size=size, mass=mass, velocity=velocity, force=force))
    # Bounces under gravity amplify rounding errors tenfold in about 4 s: 1e-32 becomes 1e-16 in a minute.
    rate, steps = 60, {"movers": 300}.get(kind, 3600)
    lines = ["[world]", f"size = [{side}, {side}]", "walls = true"]
    lines += [f"gravity = {gravity}"] if gravity else []
    lines += ["[run]", f"rate = {rate}", f"steps = {steps}", 'solver = "event-driven"', "[restitution]", f"default = {e}"]
    for spawn in spawns:
        lines += ["[[spawn]]"] + [f"{key} = {json.dumps(value) if key == 'name' else str(value)}" for key, value in spawn.items()]
    walls = [("wall-top", [-1, -1], [side + 2, 1]), ("wall-bottom", [-1, side], [side + 2, 1]),
             ("wall-left", [-1, 0], [1, side]), ("wall-right", [side, 0], [1, side])]
    bodies = [Body(name, [Decimal(x) for x in at], [Decimal(x) for x in size], INFINITE, [ZERO] * 2, [ZERO] * 2)
              for name, at, size in walls]
    for spawn in spawns:
        exact = {key: [Decimal(x) for x in spawn[key]] for key in ("at", "size", "velocity", "force")}
        mass = Decimal(spawn["mass"])
        acceleration = [ZERO, ZERO] if mass == INFINITE else [
            Decimal((gravity or [0, 0])[k]) + exact["force"][k] / mass for k in (0, 1)]
        bodies.append(Body(spawn["name"], exact["at"], exact["size"], mass, exact["velocity"], acceleration))
    return "\n".join(lines) + "\n", dict(bodies=bodies, e=Decimal(e)), rate, steps, kind


def run(*arguments):
    return subprocess.run([REBOND, *map(str, arguments)], check=True, capture_output=True, text=True).stdout


def check(seed, folder):
    text, scene, rate, steps, kind = make(seed)
    file, recording = folder / f"{seed}.toml", folder / f"{seed}.mcap"
    file.write_text(text)
    run("record", file, "-o", recording)
    sampled = list(range(0, steps + 1, 30))
    states, collisions = simulate(scene, [Decimal(step) / rate for step in sampled])
    expected = {(step, body.name): state for step, row in zip(sampled, states) for body, state in zip(scene["bodies"], row)}
    worst, failure = 0.0, None
    for row in csv.DictReader(io.StringIO(run("export", recording))):
        position = expected.get((int(row["step"]), row["name"]))
        for axis in (0, 1) if position else ():
            found = float(row["xy"[axis]])
            error = abs(float(Decimal(found) - position[axis]))
            worst = max(worst, error)
            if error > max(1e-10, 4 * math.ulp(found)) and not failure:
                failure = f"{row['name']} has an error of {error:.1e} m at step {row['step']}"
    counted = json.loads(run("info", recording, "--json"))["collisions"]
    if counted != collisions:
        failure = f"{failure or ''} {counted} collisions instead of {collisions}"
    print(f"scene {seed} ({kind}): {collisions} collisions, worst error {worst:.1e} m{', FAILED: ' + failure if failure else ''}",
          flush=True)
    return failure is None


with tempfile.TemporaryDirectory(prefix="rebond-exact-") as name:
    results = [check(seed, Path(name)) for seed in range(SCENES)]
print(f"{sum(results)} passed, {len(results) - sum(results)} failed")
sys.exit(0 if all(results) else 1)
