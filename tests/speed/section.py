#!/usr/bin/env python3
"""Writes the tables of both solvers into the guide's chapter on accuracy and speed.

    python3 tests/speed/section.py snapshots/report "$(rustc --version)"
"""

import datetime
import json
import os
import re
import sys
from pathlib import Path

CHAPTER = Path("src/guide/accuracy-and-speed.md")
BEGIN, END = "<!-- speed against error -->", "<!-- end of speed against error -->"


def read_rows(folder, name):
    return json.loads((Path(folder) / f"{name}.json").read_text())


def format_number(value):
    """Two significant digits; very small and very large values with a power of ten."""
    if value == 0:
        return "0"
    if 0.01 <= value < 1000:
        return f"{value:.2g}" if value < 100 else f"{value:.0f}"
    digits, exponent = f"{value:.0e}".split("e")
    return f"{digits}·10<sup>{int(exponent)}</sup>"


def format_error(row):
    if row["collisions"] is None:
        return "not run"
    if row["position_error"] is not None:
        return format_number(row["position_error"]) + " m"
    if row["worst_overlap"]:
        return "overlap " + format_number(row["worst_overlap"]) + " m"
    if row["energy_drift"] is not None:
        return "energy " + format_number(row["energy_drift"])
    return "ends in an error" if (row["remark"] or "").startswith("ends") else "0"


def format_collisions(row):
    if row["collisions"] is None:
        return ""
    correct = row["true_collisions"]
    return f"{row['collisions']:,}" + (f" of {correct:,}" if correct not in (None, row["collisions"]) else "")


def format_cost(row):
    value = row["ns_per_body_step"]
    return "" if value is None else f"{value:.3g}" if value < 1000 else f"{value:,.0f}"


def cells(row):
    return [format_error(row), format_collisions(row), format_cost(row)]


def error_table(rows):
    """One line per scene at about 60 Hz, and a second one at the highest rate."""
    scenes = {}
    for row in rows:
        scenes.setdefault(row["scene"], {}).setdefault(row["solver"], []).append(row)
    lines = ["| scene | rate, Hz | event-driven: error | collisions | ns | handout: error | collisions | ns |",
             "|---|--:|--:|--:|--:|--:|--:|--:|"]
    for scene, solvers in scenes.items():
        event_driven, handout = solvers["event-driven"], solvers["handout"]
        usual = min(range(len(event_driven)), key=lambda index: abs(event_driven[index]["rate"] - 60))
        for index in sorted({usual, len(event_driven) - 1}):
            name = scene if index == usual else ""
            values = cells(event_driven[index]) + cells(handout[index])
            lines.append(f"| {name} | {event_driven[index]['rate']:g} | " + " | ".join(values) + " |")
    return lines


def growth_table(rows):
    lines = ["| bodies | event-driven: ns per body and step | bytes per body | collisions per second | handout: ns |",
             "|--:|--:|--:|--:|--:|"]
    gases = [row for row in rows if row["family"] == "bodies"]
    handout = {row["bodies"]: row for row in gases if row["solver"] == "handout"}
    for row in gases:
        if row["solver"] == "event-driven":
            memory = f"{row['peak_bytes'] / row['bodies']:,.0f}" if (row["peak_bytes"] or 0) > 100_000 else ""
            lines.append(f"| {row['bodies']:,} | {format_cost(row)} | {memory} | {row['events_per_second']:,.0f} "
                         f"| {format_cost(handout[row['bodies']])} |")
    return lines


def machine():
    """The processor according to Linux."""
    text = Path("/proc/cpuinfo").read_text() if os.path.exists("/proc/cpuinfo") else ""
    model = re.search(r"model name\s*: (.*)", text)
    return f"{os.cpu_count()} cores of an {model[1] if model else 'unknown processor'}"


def replace_section(text, lines):
    head, rest = text.split(BEGIN)
    tail = rest.split(END)[1]
    return head + BEGIN + "\n" + "\n".join(lines) + "\n" + END + tail


def main(folder, compiler):
    lines = [
        f"Measured on {datetime.date.today()} on {machine()}, {compiler}, release build, by `tests/speed/run`. "
        "`ns` is the processor time per body and step:", "",
        *error_table(read_rows(folder, "errors")), "",
        "The diagram `snapshots/report/errors.svg` shows error against cost for each family of scenes.", "",
        "Growth of the cost of a gas with the number of bodies, which `snapshots/report/growth.svg` shows with the growth "
        "with the number of steps. The first step, in which all bodies are inserted, is not measured here; the table "
        "above includes it.", "",
        *growth_table(read_rows(folder, "growth")),
    ]
    CHAPTER.write_text(replace_section(CHAPTER.read_text(), lines))


if __name__ == "__main__":
    main(*sys.argv[1:])
