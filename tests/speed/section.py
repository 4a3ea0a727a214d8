#!/usr/bin/env python3
"""Writes the measured part of the README's section "Speed against error" from snapshots/report.

    python3 tests/speed/section.py snapshots/report "$(rustc --version)"
"""

import datetime
import json
import os
import re
import sys
from pathlib import Path

BEGIN, END = "<!-- speed against error -->", "<!-- end of speed against error -->"


def rows(folder, name):
    return json.loads((Path(folder) / f"{name}.json").read_text())


def power(value):
    """1.2e-15 as people write it, and plain numbers plain."""
    if value == 0:
        return "0"
    if 0.01 <= value < 1000:
        return f"{value:.2g}" if value < 100 else f"{value:.0f}"
    digits, exponent = f"{value:.0e}".split("e")
    return f"{digits}·10<sup>{int(exponent)}</sup>"


def error(row):
    if row["collisions"] is None:
        return "left out"
    if row["position_error"] is not None:
        return power(row["position_error"]) + " m"
    if row["worst_overlap"]:
        return "overlap " + power(row["worst_overlap"]) + " m"
    if row["energy_drift"] is not None:
        return "energy " + power(row["energy_drift"])
    return "ends" if (row["remark"] or "").startswith("ends") else "0"


def counted(row):
    if row["collisions"] is None:
        return ""
    true = row["true_collisions"]
    return f"{row['collisions']:,}" + (f" of {true:,}" if true not in (None, row["collisions"]) else "")


def cost(row):
    value = row["ns_per_body_step"]
    return "" if value is None else f"{value:.3g}" if value < 1000 else f"{value:,.0f}"


def cells(found):
    """Error, collisions and cost of a run."""
    return [error(found), counted(found), cost(found)]


def table(measured):
    scenes = {}
    for row in measured:
        scenes.setdefault(row["scene"], {}).setdefault(row["solver"], []).append(row)
    lines = ["| scene | rate, Hz | event-driven: error | collisions | ns | handout: error | collisions | ns |",
             "|---|--:|--:|--:|--:|--:|--:|--:|"]
    for scene, solvers in scenes.items():
        exact, printed = solvers["event-driven"], solvers["handout"]
        usual = min(range(len(exact)), key=lambda place: abs(exact[place]["rate"] - 60))
        for place in sorted({usual, len(exact) - 1}):
            name = scene if place == usual else ""
            figures = cells(exact[place]) + cells(printed[place])
            lines.append(f"| {name} | {exact[place]['rate']:g} | " + " | ".join(figures) + " |")
    return lines


def growth(measured):
    lines = ["| bodies | event-driven: ns for each body and step | bytes for each body | collisions in a second | handout: ns |",
             "|--:|--:|--:|--:|--:|"]
    gases = [row for row in measured if row["family"] == "bodies"]
    printed = {row["bodies"]: row for row in gases if row["solver"] == "handout"}
    for row in gases:
        if row["solver"] == "event-driven":
            memory = f"{row['peak_bytes'] / row['bodies']:,.0f}" if (row["peak_bytes"] or 0) > 100_000 else ""
            lines.append(f"| {row['bodies']:,} | {cost(row)} | {memory} | {row['events_per_second']:,.0f} "
                         f"| {cost(printed[row['bodies']])} |")
    return lines


def machine():
    """The processor, as Linux tells it."""
    text = Path("/proc/cpuinfo").read_text() if os.path.exists("/proc/cpuinfo") else ""
    model = re.search(r"model name\s*: (.*)", text)
    return f"{model[1] if model else 'a processor of unknown name'}, {os.cpu_count()} of its cores"


def main(folder, compiler):
    lines = [
        f"Measured on {datetime.date.today()} on {machine()}, {compiler}, release build, by `tests/speed/run`:", "",
        *table(rows(folder, "errors")), "",
        "![Error against cost, family by family](snapshots/report/errors.svg)", "",
        *growth(rows(folder, "growth")), "",
        "![How costs grow](snapshots/report/growth.svg)",
    ]
    readme = Path("README.md")
    head, rest = readme.read_text().split(BEGIN)
    tail = rest.split(END)[1]
    readme.write_text(head + BEGIN + "\n" + "\n".join(lines) + "\n" + END + tail)


main(*sys.argv[1:])
