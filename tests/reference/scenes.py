"""Random scenes in which events coincide: small, seeded, and built on a lattice so that faces are flush and times equal.

    scenes.py KIND SEED     prints the scene
    scenes.py --kinds       lists the kinds, one a line with what they are

A scene is made of whole multiples of a unit of length. With a binary unit (1, 1/2, 1/4, 1/8 m) every number is an exact f64;
with a decimal one (0.1, 0.2, 0.8 m) flush faces are flush in the decimals that the file contains, but differ by some ulps in f64.
In a few scenes, gaps of some ulps are added to the positions that the engine reads; they count as touching where bodies are
spawned at each other, and are true elsewhere: `toml()` is the engine's file, and the simulator reads `ideal_toml()`, without these
gaps, or `exact_toml()`, with all digits of the doubles.
Events before the last step only; no spawn overlaps a body of the same step (one that overlaps a body in flight may occur).
"""

import copy
import math
import random
import sys
from dataclasses import dataclass, field
from decimal import Decimal
from fractions import Fraction

INFINITE = math.inf
COEFFICIENTS = [0.0, 0.2, 0.5, 0.9, 0.95, 0.99, 0.999, 1.0]


@dataclass
class Body:
    """A box to be spawned. Numbers are the f64 of the file."""

    name: str
    at: tuple
    size: tuple
    mass: float = 1.0
    velocity: tuple = (0.0, 0.0)
    force: tuple = (0.0, 0.0)
    material: str = ""
    step: int = 0
    ulps: tuple = (0, 0)  # by how many ulps the engine's position differs from the ideal one

    def moved(self):
        return tuple(move(x, n) for x, n in zip(self.at, self.ulps))


@dataclass
class Scene:
    kind: str
    seed: int
    bodies: list = field(default_factory=list)
    deletes: list = field(default_factory=list)  # (step, name)
    gravity: tuple = (0.0, 0.0)
    rate: float = 32.0
    steps: int = 64
    restitution: dict = field(default_factory=lambda: {"default": 1.0})
    is_decimal: bool = False  # the unit of length is
    events_per_step: int = 200000

    def toml(self):
        return self.text(lambda body: pair(body.moved()))

    def ideal_toml(self):
        return self.text(lambda body: pair(body.at))

    def exact_toml(self):
        return self.text(lambda body: "[" + ", ".join(format(Decimal(x), ".1100g") for x in body.moved()) + "]")

    def has_gaps_of_ulps(self):
        return any(any(body.ulps) for body in self.bodies)

    def text(self, position):
        lines = ["[world]", "size = [16.0, 9.0]"]
        if any(self.gravity):
            lines.append(f"gravity = {pair(self.gravity)}")
        lines += ["[run]", f"rate = {self.rate!r}", f"steps = {self.steps}", 'solver = "event-driven"']
        lines += [f"events_per_step = {self.events_per_step}", "[restitution]"]
        lines += [f"{key if key == 'default' else quoted(key)} = {e!r}" for key, e in self.restitution.items()]
        for body in self.bodies:
            mass = "inf" if math.isinf(body.mass) else repr(body.mass)
            lines += ["[[spawn]]", f"name = {quoted(body.name)}"]
            lines += [f"step = {body.step}"] * (body.step > 0)
            lines += [f"at = {position(body)}", f"size = {pair(body.size)}", f"mass = {mass}"]
            lines += [f"velocity = {pair(body.velocity)}"] * any(body.velocity)
            lines += [f"force = {pair(body.force)}"] * any(body.force)
            lines += [f"material = {quoted(body.material)}"] * bool(body.material)
        for step, name in self.deletes:
            lines += ["[[delete]]", f"step = {step}", f"name = {quoted(name)}"]
        return "\n".join(lines) + "\n"

    def copy(self):
        return copy.deepcopy(self)

    def extent(self):
        """The largest extent of the scene: coordinates of finite bodies, and all sizes."""
        return max(max(map(abs, (*b.at, *b.size) if math.isfinite(b.mass) else b.size)) for b in self.bodies)

    def acceleration(self):
        """The greatest acceleration from gravity and the forces of the bodies."""
        own = [abs(f) / b.mass for b in self.bodies for f in b.force if math.isfinite(b.mass)]
        return max(map(abs, self.gravity)) + max(own, default=0.0)


def quoted(text):
    return f'"{text}"'


def pair(numbers):
    return f"[{numbers[0]!r}, {numbers[1]!r}]"


def move(x, ulps):
    for _ in range(abs(ulps)):
        x = math.nextafter(x, math.inf if ulps > 0 else -math.inf)
    return x


# ---- building on a lattice


class Builder:
    """Collects boxes in whole units and refuses overlaps."""

    def __init__(self, kind, seed):
        self.random = random.Random(f"{kind} {seed}")
        r = self.random
        self.scene = Scene(kind, seed)
        self.boxes = []  # (x, y, width, height) in units, of those that exist from the start
        decimal = r.random() < 0.25
        if decimal:
            self.unit = Fraction(r.choice(["0.1", "0.2", "0.8", "0.3"])) * r.choice([1, 1, 2])
            self.speed = Fraction(r.choice(["0.1", "0.5", "0.3", "1"]))
            self.scene.rate = r.choice([60.0, 50.0, 64.0])
            self.scene.is_decimal = True
        else:
            self.unit = Fraction(1, r.choice([1, 1, 2, 4, 8]))
            self.speed = Fraction(1, r.choice([1, 2, 4]))
            self.scene.rate = r.choice([16.0, 32.0, 64.0])
        self.scene.steps = int(self.scene.rate * r.choice([1, 2, 2, 3]))
        self.materials = [""]
        e = r.choice(COEFFICIENTS)
        self.scene.restitution = {"default": e}
        if r.random() < 0.3:
            self.materials = ["a", "b"]
            self.scene.restitution |= {"a/a": r.choice(COEFFICIENTS), "a/b": r.choice(COEFFICIENTS)}
        self.masses = r.choice([[1.0], [1.0], [1.0, 2.0], [0.5, 1.0, 2.0, 3.0], [1.0, 10.0], [1.0, 1000.0], [0.125, 1.0, 8.0]])

    def length(self, units):
        return float(self.unit * units)

    def free(self, x, y, w, h):
        return not any(x < bx + bw and bx < x + w and y < by + bh and by < y + h for bx, by, bw, bh in self.boxes)

    def add(self, x, y, w, h, *, infinite=False, v=(0, 0), force=(0.0, 0.0), name=None, mass=None, step=0):
        """Adds a box given in units, its velocity in units of speed. Returns None if the place is taken."""
        if step == 0 and not self.free(x, y, w, h):
            return None
        if step == 0:
            self.boxes.append((x, y, w, h))
        mass = INFINITE if infinite else self.random.choice(self.masses) if mass is None else mass
        body = Body(
            name or f"b{len(self.scene.bodies)}",
            (self.length(x), self.length(y)),
            (self.length(w), self.length(h)),
            mass,
            (float(self.speed * v[0]), float(self.speed * v[1])),
            (0.0, 0.0) if infinite else force,
            self.random.choice(self.materials),
            step,
        )
        self.scene.bodies.append(body)
        return body

    def gravity(self, chance=1.0, sideways=0.15):
        r = self.random
        if r.random() < chance:
            g = r.choice([8.0, 10.0, 9.8125, 9.81, 2.0])
            self.scene.gravity = (r.choice([-1.0, 1.0, 3.0]) if r.random() < sideways else 0.0, g)

    def some_force(self, chance, biggest=16):
        r = self.random
        if r.random() >= chance:
            return (0.0, 0.0)
        f = [float(r.randint(-biggest, biggest)) for _ in "xy"]
        if r.random() < 0.5:
            f[r.randrange(2)] = 0.0
        return tuple(f)

    def step(self, least=1):
        return self.random.randint(least, max(least, self.scene.steps * 3 // 4))

    def finish(self):
        """Turns, mirrors and shuffles the scene, and adds gaps of some ulps to a few."""
        r, scene = self.random, self.scene
        if r.random() < 0.3:
            exchange_axes(scene)
        for axis in (0, 1):
            if r.random() < 0.25:
                mirror(scene, axis, self.unit)
        if r.random() < 0.5:
            r.shuffle(scene.bodies)
        if not scene.is_decimal and r.random() < 0.08:
            for body in scene.bodies:
                if body.step == 0:
                    body.ulps = tuple(r.randint(-1, 1) if abs(x) >= s else 0 for x, s in zip(body.at, body.size))
        return scene


def exchange_axes(scene):
    swap = lambda p: (p[1], p[0])
    scene.gravity = swap(scene.gravity)
    for b in scene.bodies:
        b.at, b.size, b.velocity, b.force, b.ulps = map(swap, (b.at, b.size, b.velocity, b.force, b.ulps))


def mirror(scene, axis, unit=None):
    """x → −(x + width). Exact for binary coordinates; for decimal ones the decimal result is taken if the unit is given."""

    def negate(pair):
        return tuple(-v + 0.0 if k == axis else v for k, v in enumerate(pair))

    scene.gravity = negate(scene.gravity)
    for b in scene.bodies:
        far = -(b.at[axis] + b.size[axis])
        if unit is not None:
            far = float(unit / 64 * round(Fraction(far) / unit * 64)) + 0.0
        b.at = tuple(far if k == axis else v for k, v in enumerate(b.at))
        b.velocity, b.force = negate(b.velocity), negate(b.force)
        b.ulps = tuple(-n if k == axis else n for k, n in enumerate(b.ulps))


# ---- the kinds


def grid(b):
    """boxes at random places of a small lattice, some touching, some moving, some with forces"""
    r = b.random
    b.gravity(0.5)
    if r.random() < 0.6:
        b.add(-2, 8, 14, 1, infinite=True, name="floor")
    if r.random() < 0.3:
        b.add(-3, -2, 1, 10, infinite=True, name="wall")
    forces = r.choice([0, 0, 0.3, 0.6])
    moving = r.choice([0.2, 0.5, 1.0])
    infinite = r.choice([0, 0, 0.15])
    for _ in range(r.randint(3, 10)):
        v = (r.randint(-3, 3), r.randint(-3, 3)) if r.random() < moving else (0, 0)
        if r.random() < 0.3:
            v = (v[0], 0)
        still = r.random() < infinite
        b.add(r.randint(0, 8), r.randint(0, 6), r.randint(1, 3), r.randint(1, 2), infinite=still,
              v=(0, 0) if still else v, force=b.some_force(forces))


def tower(b):
    """a tower on several supports, with a block thrown at it or dropped on it"""
    r = b.random
    b.gravity(1.0, 0.1)
    b.add(-8, 12, 32, 1, infinite=True, name="floor")
    forces = r.choice([0, 0, 0.2])
    level, x, n = 12, 0, 0
    left, right = 0, r.randint(3, 8)
    for _ in range(r.randint(1, 4)):
        if n >= 8:
            break
        height = r.randint(1, 2)
        if r.random() < 0.6 and right - left >= 3:  # piers and a plank over them
            piers = r.randint(2, 3)
            places = sorted(r.sample(range(left, right), min(piers, right - left)))
            for place in places:
                if b.add(place, level - height, 1, height, force=b.some_force(forces)):
                    n += 1
            level -= height
            over, under = r.randint(0, 1), r.randint(0, 1)
            b.add(left - over, level - 1, right - left + over + under, 1, force=b.some_force(forces))
            n, level = n + 1, level - 1
        else:
            wide = r.randint(1, right - left)
            at = r.randint(left, right - wide)
            b.add(at, level - height, wide, height, force=b.some_force(forces))
            n, level, left, right = n + 1, level - height, at, at + wide
        if right - left < 1:
            break
    for _ in range(r.randint(0, 2)):
        if r.random() < 0.5:
            b.add(r.randint(-7, -3), r.randint(level - 1, 10), r.randint(1, 2), r.randint(1, 2), v=(r.randint(1, 12), 0))
        else:
            b.add(r.randint(-1, 7), r.randint(level - 6, level - 2), r.randint(1, 3), 1, v=(0, r.randint(0, 4)))


def row(b):
    """a row of boxes and a wall: touching, with lattice gaps or gaps of nanometres; sometimes a heavy one, a second wall, gravity"""
    r = b.random
    n = r.randint(2, 10)
    gaps = r.choice(["touching", "touching", "lattice", "nanometres", "mixed"])
    if gaps in ("nanometres", "mixed"):
        b.unit, b.scene.is_decimal = Fraction(1, 4), False
    speed = -r.randint(1, 4)
    wall = r.random()
    if wall < 0.7:
        b.add(-3, -2, 2, 5, infinite=True, name="wall", v=(r.choice([0, 0, 0, 1, -1]), 0))
    elif wall < 0.85:
        b.add(-3, -1, 2, 3, mass=r.choice([1000.0, 100.0, 1e6]), name="wall")
    if r.random() < 0.3:
        b.add(-4, 2, 40, 1, infinite=True, name="floor")
        b.gravity(1.0, 0.0)
    x, nanometres = r.choice([-1, 0, 1, 2]), 0
    for i in range(n):
        width = 1 if r.random() < 0.8 else 2
        y, h = (0, 2) if r.random() < 0.7 else (r.choice([0, 1]), 1)
        heavy = i == n - 1 and r.random() < 0.4
        v = (speed if r.random() < 0.85 or heavy else r.randint(-3, 2), 0)
        body = b.add(x, y if not (h == 1) else 1, width, h, v=v, mass=r.choice([100.0, 1e4, 7.0]) if heavy else None)
        if body and nanometres:
            body.at = (body.at[0] + nanometres * 1e-9, body.at[1])
        x += width
        if gaps == "lattice":
            x += r.choice([0, 0, 1])
        if gaps == "nanometres" or (gaps == "mixed" and r.random() < 0.5):
            nanometres += 1
    if r.random() < 0.25:
        b.add(x + r.randint(2, 4), -2, 2, 5, infinite=True, name="wall2")


def column(b):
    """a column of boxes that falls on a floor, touching or with gaps; some rest already"""
    r = b.random
    b.gravity(0.85, 0.0)
    fall = any(b.scene.gravity)
    b.add(-3, 10, 10, 1, infinite=True, name="floor", v=(0, r.choice([0, 0, 0, 0, -1, 1])))
    y = 10 - (0 if r.random() < 0.3 else r.randint(1, 3))
    v = r.randint(0, 3) if fall else r.randint(1, 3)
    for _ in range(r.randint(2, 8)):
        h = r.randint(1, 2)
        b.add(r.choice([0, 0, 1]), y - h, r.choice([2, 2, 3]), h, v=(r.choice([0, 0, 0, 1]), v if r.random() < 0.8 else 0))
        y -= h + r.choice([0, 0, 0, 1])
    if r.random() < 0.3:
        b.add(r.choice([-1, 0, 1]), y - 6, 2, 1, v=(0, r.randint(0, 4)), mass=r.choice([1.0, 100.0, 1e4]))


def blocks(b):
    """blocks of touching boxes thrown at walls and at each other"""
    r = b.random
    b.gravity(0.3)
    b.add(-6, -6, 1, 16, infinite=True, name="left")
    b.add(-5, 9, 22, 1, infinite=True, name="floor")
    if r.random() < 0.5:
        b.add(16, -6, 1, 15, infinite=True, name="right")
    left = 9
    for _ in range(r.randint(1, 3)):
        ox, oy = r.randint(-5, 12), r.randint(-4, 6)
        v = r.choice([(-2, 0), (2, 0), (0, 2), (-2, 2), (2, 1), (-1, 1), (0, 0), (-3, -3)])
        w, h = r.randint(1, 3), r.randint(1, 2)
        for i in range(w):
            for j in range(h):
                if left > 0 and r.random() < 0.9 and b.add(ox + i, oy + j, 1, 1, v=v):
                    left -= 1


def seams(b):
    """boxes that slide over flush tiles of many widths, as wide as some tiles or not, with starts and ends of contact at seams"""
    r = b.random
    n = r.randint(2, 7)
    press = r.random()
    if press < 0.75:
        b.gravity(1.0, 0.1)
    x, edges = 0, [0]
    widths = r.choice([[1], [2], [1, 2], [1, 2, 3], [3, 4], [1, 5]])
    tiles = []
    for i in range(n):
        w = r.choice(widths)
        tiles.append((x, w))
        x += w
        edges.append(x)
    if r.random() < 0.5:
        r.shuffle(tiles)
    floating = r.random() < 0.1
    for i, (at, w) in enumerate(tiles):
        b.add(at, 8, w, r.choice([1, 1, 2]), infinite=not floating, name=f"t{i}", mass=1e6 if floating else None)
    if floating:
        b.add(-2, 10, x + 4, 1, infinite=True, name="floor")
    if r.random() < 0.3:
        b.add(r.choice([-1, x]), r.choice([6, 7]), 1, 2, infinite=True, name="stop")
    if r.random() < 0.15:
        for i, (at, w) in enumerate(tiles):
            b.add(at, r.choice([4, 5]), w, 1, infinite=True, name=f"c{i}")
    for _ in range(r.randint(1, 3)):
        wide = r.choice([1, 2, 3, r.choice(edges[1:]), r.choice(widths)])
        wide = min(wide, 6)
        height = r.randint(1, 2)
        above = r.choice([0, 0, 0, 1, 2])
        force = (float(r.choice([0, 0, 0, 1, -1, 2])), 8.0 if press >= 0.75 else 0.0)
        b.add(r.choice(edges + [r.randint(-1, x)]), 8 - height - above, wide, height, v=(r.choice([1, 2, -1, -2, 4, 0, 3]), 0), force=force)
    if r.random() < 0.3:
        b.add(r.randint(0, x), r.randint(2, 5), r.randint(1, 2), 1, v=(r.randint(-2, 2), 0))


def platform(b):
    """boxes on, above and below infinite masses that move"""
    r = b.random
    b.gravity(0.8, 0.0)
    for i in range(r.randint(1, 3)):
        v = r.choice([(0, -1), (0, 1), (1, 0), (-1, 0), (0, -3), (2, -1), (0, 0), (1, 1)])
        x, y = r.randint(-2, 6), 8 if r.random() < 0.6 else r.randint(4, 9)
        if b.add(x, y, r.randint(3, 8), 1, infinite=True, name=f"platform{i}", v=v):
            for _ in range(r.randint(1, 3)):
                w, h = r.randint(1, 3), r.randint(1, 2)
                above = r.choice([0, 0, 0, 1, 2])
                ride = v if r.random() < 0.5 else (r.randint(-2, 2), v[1] if r.random() < 0.5 else 0)
                b.add(x + r.randint(-1, 6), y - h - above, w, h, v=ride, force=b.some_force(0.15))
    for _ in range(r.randint(0, 2)):
        b.add(r.randint(-3, 8), r.randint(0, 3), r.randint(1, 2), 1, v=(r.randint(-2, 2), r.randint(0, 2)))


def heap(b):
    """boxes that fall into a pit"""
    r = b.random
    b.gravity(1.0, 0.2)
    width = r.randint(4, 9)
    b.add(-1, 10, width + 2, 1, infinite=True, name="floor")
    b.add(-1, -8, 1, 18, infinite=True, name="left")
    b.add(width, -8, 1, 18, infinite=True, name="right")
    for _ in range(r.randint(3, 9)):
        w = r.randint(1, 3)
        b.add(r.randint(0, width - w), r.randint(-4, 9), w, r.randint(1, 2) if r.random() < 0.9 else 3,
              v=(r.randint(-2, 2), r.randint(-1, 2)) if r.random() < 0.6 else (0, 0), force=b.some_force(0.08))


def corner(b):
    """boxes whose corners meet exactly, with equal and unequal approaches, and neighbours that touch"""
    r = b.random
    b.gravity(0.2)
    for _ in range(r.randint(1, 3)):
        x, y = r.randint(-6, 12), r.randint(-6, 8)
        w, h = r.randint(1, 2), r.randint(1, 2)
        vx, vy = r.choice([(1, 1), (1, 2), (2, 1), (3, 1), (2, 2), (1, 3)])
        time = r.choice([0, 1, 2])
        sx, sy = r.choice([-1, 1]), r.choice([-1, 1])
        still = r.random() < 0.3
        if not b.add(x, y, w, h, infinite=still, v=(0, 0)):
            continue
        w2, h2 = r.randint(1, 2), r.randint(1, 2)
        distance = [vx * time, vy * time]
        to = Fraction(1) / (b.unit / b.speed) if b.unit != b.speed else 1
        distance = [d if to == 1 or (d * to).denominator != 1 else int(d * to) for d in distance]
        bx = x + w + distance[0] if sx > 0 else x - w2 - distance[0]
        by = y + h + distance[1] if sy > 0 else y - h2 - distance[1]
        b.add(bx, by, w2, h2, v=(-sx * vx, -sy * vy), force=b.some_force(0.1))
        if r.random() < 0.4:
            b.add(x + w, y + r.choice([-1, 0, 1]), 1, h, infinite=still and r.random() < 0.5)
        if r.random() < 0.4:
            b.add(bx, by - 1 if sy > 0 else by + h2, w2, 1, v=(-sx * vx, -sy * vy))
    for _ in range(r.randint(0, 2)):
        b.add(r.randint(-6, 12), r.randint(-6, 8), 1, 1, v=(r.randint(-2, 2), r.randint(-2, 2)))


def pressed(b):
    """boxes at rest that touch at faces and corners and are pressed by forces"""
    r = b.random
    b.gravity(0.25, 0.3)
    pattern = r.choice(["chess", "random", "random", "steps"])
    n = r.randint(2, 9)
    forces = r.choice([0.4, 0.8, 1.0])
    infinite = r.choice([0, 0.15, 0.3])
    places = [(i, j) for i in range(4) for j in range(4)]
    if pattern == "chess":
        places = [p for p in places if sum(p) % 2 == 0 or r.random() < 0.15]
    elif pattern == "steps":
        places = [p for p in places if abs(p[0] - p[1]) <= (1 if r.random() < 0.2 else 0)]
    r.shuffle(places)
    moving = r.random() < 0.3
    for i, j in places[:n]:
        w, h = (1, 1) if pattern != "random" or r.random() < 0.6 else (r.randint(1, 2), r.randint(1, 2))
        still = r.random() < infinite
        v = (r.randint(-1, 1), r.randint(-1, 1)) if moving and not still and r.random() < 0.3 else (0, 0)
        b.add(i, j, w, h, infinite=still, v=v, force=b.some_force(forces))


def squeeze(b):
    """infinite masses that approach each other, and light boxes between heavy ones"""
    r = b.random
    b.gravity(0.2, 0.0)
    moving = r.random() < 0.6
    v = (r.randint(0, 2), -r.randint(0, 2)) if moving else (0, 0)
    length = r.randint(3, 9)
    heavy = r.choice([50.0, 1000.0, 1e4])
    for side, x in (("left", -2), ("right", length)):
        speed = (v[0] if side == "left" else v[1], 0)
        if r.random() < 0.7:
            b.add(x, 0, 2, 4, infinite=True, name=side, v=speed)
        else:
            b.add(x, 0, 2, 4, mass=heavy, name=side, v=(speed[0] or (1 if side == "left" else -1), 0))
    for _ in range(r.randint(1, 6)):
        w = r.randint(1, 2)
        b.add(r.randint(0, max(0, length - w)), r.choice([0, 1, 2, 3, -1]), w, r.choice([1, 1, 2]), v=(r.choice([0, 0, 1, -1]), 0))
    if r.random() < 0.4:
        b.add(-6, 4, 24, 1, infinite=True, name="floor")


def churn(b):
    """towers and heaps in which bodies are deleted and spawned while they rest, slide and fall"""
    r = b.random
    r.choice([tower, heap, grid, seams])(b)
    names = [body.name for body in b.scene.bodies]
    step = sorted(b.step() for _ in names)
    for name, at in zip(r.sample(names, min(len(names), r.randint(1, 3))), step):
        b.scene.deletes.append((at, name))
    for i in range(r.randint(0, 2)):
        b.add(r.randint(-2, 8), r.choice([-14, -12, r.randint(-10, 9)]), r.randint(1, 3), 1, v=(r.randint(-1, 1), r.randint(-1, 3)),
              step=b.step(), name=f"late{i}")


def graze(b):
    """pressed or supported boxes that turn exactly at an edge, or reach it with no speed to spare"""
    r = b.random
    sideways = r.random() < 0.5
    a = Fraction(r.choice([1, 2, 4, 8]))
    distance = r.choice([1, 2, 4])  # in quarters of a metre; v²/2a = distance
    b.unit = Fraction(1, 5) if b.scene.is_decimal else Fraction(1, 4)
    v = 2 * a * distance * b.unit
    root = Fraction(math.isqrt(int(v * 3600)), 60)
    if root * root != v:  # make it exact by another acceleration
        root = Fraction(r.choice([1, 2, 3]), 2)
        a = root * root / (2 * distance * b.unit)
    b.speed = Fraction(1)
    overlap = r.choice([distance, distance, distance, distance + 1])
    if sideways:  # slides to the edge of a shelf and turns there
        b.gravity(1.0, 0.0)
        b.add(0, 4, 4, 2, infinite=True, name="shelf")
        if r.random() < 0.4:
            b.add(-4, 4, 4, 2, infinite=True, name="shelf2")
        b.add(4 - overlap, 0, 4, 4, v=(root, 0), force=(-float(a), 0.0), mass=1.0, name="slider")
        if r.random() < 0.4:
            b.add(4 - overlap, -2, r.choice([2, 4]), 2, v=(root, 0), force=(-float(a), 0.0), mass=1.0, name="rider")
    else:  # pressed to a wall, moves up and turns at its upper end
        b.scene.gravity = (0.0, float(a))
        b.add(0, 4, 2, 4, infinite=True, name="wall")
        b.add(2, overlap, 2, 4, v=(0, -root), force=(-float(r.choice([0, 1, 1, 3])), 0.0), mass=1.0, name="slider")
        if r.random() < 0.3:
            b.add(4, overlap, 2, r.choice([2, 4]), v=(0, -root), force=(-float(r.choice([0, 1])), 0.0), mass=1.0, name="next")
    for _ in range(r.randint(0, 3)):
        b.add(r.randint(-6, 10), r.randint(-6, 10), r.randint(1, 3), r.randint(1, 3), infinite=r.random() < 0.4)


KINDS = {f.__name__: f for f in (grid, tower, row, column, blocks, seams, platform, heap, corner, pressed, squeeze, churn, graze)}


def random_scene(kind, seed):
    b = Builder(kind, seed)
    KINDS[kind](b)
    return b.finish()


def seeds(text):
    """'3..8' is 3, 4, … 7; '5' is 5 alone; several are separated by commas."""
    out = []
    for part in text.split(","):
        first, dots, end = part.partition("..")
        out += range(int(first), int(end)) if dots else [int(first)]
    return out


def kinds(text):
    chosen = list(KINDS) if text == "all" else text.split(",")
    unknown = [kind for kind in chosen if kind not in KINDS]
    if unknown:
        sys.exit(f"unknown kind {', '.join(unknown)}; there are {', '.join(KINDS)}")
    return chosen


if __name__ == "__main__":
    if len(sys.argv) == 2 and sys.argv[1] == "--kinds":
        for name, f in KINDS.items():
            print(f"{name:10}{f.__doc__}")
    elif len(sys.argv) == 3:
        made = random_scene(sys.argv[1], int(sys.argv[2]))
        print(f"# {made.kind} {made.seed}\n{made.toml()}", end="")
    else:
        sys.exit(__doc__)
