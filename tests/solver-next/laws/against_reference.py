"""Compares the engine with the reference simulator on random scenes of coincident events.

usage: against_reference.py ENGINE --reference reference.py [--seeds 0..100] [--kinds all] [--jobs 2] [--folder FOLDER]
                            [--cache FOLDER] [--seconds 60] [--reference-only] [--summary FILE]

One line per difference: kind, seed, and where it begins; the scene is written into FOLDER. Then a table of the kinds.
Differences of scenes with decimal numbers are told apart, since what coincides in decimals may not in f64 (two bodies that fly
towards two walls). What is not counted as a difference is told apart in the table:
  other reading   the engine agrees with the reference for another reading of decimal numbers (see scenes.py)
  horizon         the first difference comes after a thousand collisions or at a hundred times the speed: digits may be used up
  no reference    the reference refuses the scene (a spawn into a body in flight) or takes too long
"""

import argparse
import collections
import functools
import json
import sys
import time
from pathlib import Path

import running
import scenes


def references(scene, options):
    """The results that count as right, the first one before the others."""
    readings = {"binary": [(False, True)], "decimal": [(False, False), (False, True)], "ideal": [(True, True), (False, True)]}
    for ideal, binary in readings[scene.reading]:
        yield running.run_reference(running.load_reference(options.reference), scene.toml(ideal=ideal), binary, options.seconds, cache=options.cache)


def judge(task, options):
    kind, seed = task
    scene = scenes.random_scene(kind, seed)
    if options.reference_only:
        right = next(references(scene, options))
        return kind, seed, right.outcome, right.message
    engine = running.run_engine(options.engine, scene.toml(), options.seconds)
    first, usable = None, False
    for n, right in enumerate(references(scene, options)):
        if right.outcome in ("refused", "timeout"):
            continue
        difference = running.compare(engine, right, scene)
        if running.beyond_the_horizon(difference, engine, right, scene):
            return kind, seed, "horizon", difference.text
        if difference is None:
            return kind, seed, "same" if n == 0 else "other reading", ""
        first, usable = first or difference, True
    if not usable:
        trouble = "panic" if engine.outcome == "panic" else "no reference"
        return kind, seed, trouble, engine.message if trouble == "panic" else right.message
    return kind, seed, first.what + (" (decimals)" if scene.reading != "binary" else ""), first.text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("engine")
    parser.add_argument("--reference", required=True)
    parser.add_argument("--seeds", default="0..100")
    parser.add_argument("--kinds", default="all")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--folder", default="differences")
    parser.add_argument("--cache")
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--summary", help="write the counts and the differences as JSON")
    parser.add_argument("--reference-only", action="store_true", help="only run the reference (fills the cache)")
    options = parser.parse_args()
    tasks = [(kind, seed) for seed in scenes.seeds(options.seeds) for kind in scenes.kinds(options.kinds)]
    table, lines, start = collections.defaultdict(collections.Counter), [], time.time()
    quiet = {"same", "other reading", "no reference", "horizon", "ok"}
    for kind, seed, what, text in running.in_parallel(functools.partial(judge, options=options), tasks, options.jobs):
        table[kind][what] += 1
        if what not in quiet or (options.reference_only and what != "ok"):
            print(f"{kind} {seed} {what}: {text}", flush=True)
            lines.append((kind, seed, what, text))
        if what not in quiet and not options.reference_only:
            folder = Path(options.folder)
            folder.mkdir(parents=True, exist_ok=True)
            scene = scenes.random_scene(kind, seed)
            (folder / f"{kind}-{seed}.toml").write_text(f"# {kind} {seed}, reading: {scene.reading}\n# {what}: {text}\n" + scene.toml())
    columns = sorted({what for row in table.values() for what in row}, key=lambda w: (w not in quiet, w))
    print("kind".ljust(12), *(c.rjust(max(8, len(c))) for c in columns))
    for kind in sorted(table):
        print(kind.ljust(12), *(str(table[kind][c]).rjust(max(8, len(c))) for c in columns))
    total = sum(sum(row.values()) for row in table.values())
    print(f"{total} scenes, {len(lines)} differences, {time.time() - start:.0f} s")
    if options.summary:
        Path(options.summary).write_text(json.dumps({"seeds": options.seeds, "table": table, "lines": sorted(lines)}))
    return 1 if lines else 0


if __name__ == "__main__":
    sys.exit(main())
