"""Makes a failing scene smaller: leaves out bodies, forces, velocities and deletes as long as the engine still differs.

usage: shrink.py ENGINE KIND SEED --reference reference.py [--out FILE]

A scene differs if two boxes overlap, or if its states or its outcome are not those of the reference.
"""

import argparse
import sys
from pathlib import Path

import invariants
import running
import scenes


def differs(engine, reference, scene):
    result = running.run_engine(engine, scene.toml(), 20)
    text = invariants.overlaps(scene, result)
    if text:
        return f"overlap: {text}"
    right = running.run_reference(reference, scene.toml(ideal=True), scene.reading != "decimal", 20)
    if right.outcome in ("refused", "timeout", "endless"):
        return None
    difference = running.compare(result, right, scene)
    return difference and difference.what != "collisions" and str(difference)


def simpler(scene):
    for i in range(len(scene.bodies) - 1, -1, -1):
        other = scene.copy()
        gone = other.bodies.pop(i).name
        other.deletes = [d for d in other.deletes if d[1] != gone]
        if other.bodies:
            yield other
    for i in range(len(scene.deletes)):
        other = scene.copy()
        other.deletes.pop(i)
        yield other
    for i, body in enumerate(scene.bodies):
        for key, plain in (("force", (0.0, 0.0)), ("velocity", (0.0, 0.0)), ("material", ""), ("ulps", (0, 0))):
            if getattr(body, key) != plain:
                other = scene.copy()
                setattr(other.bodies[i], key, plain)
                yield other


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engine")
    parser.add_argument("kind")
    parser.add_argument("seed", type=int)
    parser.add_argument("--reference", required=True)
    parser.add_argument("--out")
    options = parser.parse_args()
    reference = running.load_reference(options.reference)
    scene = scenes.random_scene(options.kind, options.seed)
    text = differs(options.engine, reference, scene)
    if not text:
        sys.exit("no difference")
    while True:
        for other in simpler(scene):
            found = differs(options.engine, reference, other)
            if found:
                scene, text = other, found
                break
        else:
            break
    toml = f"# {options.kind} {options.seed} made smaller, reading: {scene.reading}\n# {text}\n{scene.toml()}"
    if options.out:
        Path(options.out).write_text(toml)
    print(toml)


if __name__ == "__main__":
    main()
