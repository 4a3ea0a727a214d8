"""Compares rebond, matplotlib and Pillow: clips of 50 boxes and 150 frames, and figures of the same run, 1280x720.

    python3 -m venv tests/peers/.venv && tests/peers/.venv/bin/pip install -r tests/peers/pictures-requirements.txt
    cargo build --release
    tests/peers/.venv/bin/python tests/peers/pictures.py target/release/rebond

Prints the CPU time of one thread per frame or figure (user and system) and the size of the files, as two Markdown
tables. The time of rebond includes the start of the program, reading the recording and, for exact instants, a replay;
that of the others only drawing and writing. Matplotlib is used as its documentation recommends for speed: one figure
whose artists are moved.
"""

import csv
import math
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

os.environ["OMP_NUM_THREADS"] = "1"

import matplotlib
import PIL
from matplotlib import pyplot
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.patches import Rectangle
from PIL import Image, ImageDraw

FRAMES = 150
RATE = 30
WIDTH, HEIGHT = 1280, 720
METRE = 80
SCENE = f"""
[world]
size = [16.0, 9.0]
[run]
rate = {RATE}
steps = {FRAMES - 1}
solver = "event-driven"
[[scatter]]
count = 50
seed = 5
region = [0.5, 0.5, 15.0, 8.0]
size = [[0.4, 0.4], [1.0, 1.0]]
mass = [1.0, 1.0]
velocity = [[-1.0, -1.0], [1.0, 1.0]]
"""
COLORS = ["#56b4e9", "#e69f00", "#cc79a7", "#f0e442", "#0072b2", "#d55e00", "#009e73"]


def cpu_seconds(who):
    usage = resource.getrusage(who)
    return usage.ru_utime + usage.ru_stime


def measure(work, runs=1, frames=FRAMES):
    """CPU seconds per frame of the fastest run, including child processes."""
    best = float("inf")
    for _ in range(runs):
        before = cpu_seconds(resource.RUSAGE_SELF) + cpu_seconds(resource.RUSAGE_CHILDREN)
        work()
        after = cpu_seconds(resource.RUSAGE_SELF) + cpu_seconds(resource.RUSAGE_CHILDREN)
        best = min(best, (after - before) / frames)
    return best


def read_frames(table):
    """For each step, the position of each body by name."""
    frames = [{} for _ in range(FRAMES)]
    with open(table, newline="") as rows:
        for row in csv.DictReader(rows):
            frames[int(row["step"])][row["name"]] = (float(row["x"]), float(row["y"]))
    return frames


def rebond_tasks(program, folder, show):
    def png():
        run(program, "render", folder / "run.mcap", "-o", folder / "frames", "--show", show, "--force", "--jobs", "1")

    def gif():
        run(program, "render", folder / "run.mcap", "-o", folder / "run.gif", "--show", show, "--force", "--jobs", "1")

    return png, gif


def run(program, *arguments):
    subprocess.run([program, *map(str, arguments)], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def matplotlib_tasks(frames, sizes, folder, annotated):
    figure = pyplot.figure(figsize=(WIDTH / 100, HEIGHT / 100), dpi=100)
    axes = figure.add_axes([0, 0, 1, 1])
    axes.set_xlim(0, 16)
    axes.set_ylim(9, 0)
    if annotated:
        axes.grid(True)
    else:
        axes.set_axis_off()
    boxes, names, arrows = {}, {}, {}
    for number, (name, (width, height)) in enumerate(sizes.items()):
        boxes[name] = axes.add_patch(Rectangle((0, 0), width, height, facecolor=COLORS[number % 7], edgecolor="black"))
        if annotated:
            names[name] = axes.text(0, 0, name, ha="center", va="center")
            arrows[name] = axes.annotate("", (0, 0), (0, 0), arrowprops={"arrowstyle": "->"})
    clock = axes.text(0.3, 8.7, "")

    def show(step):
        for name, (x, y) in frames[step].items():
            boxes[name].set_xy((x, y))
            if annotated:
                middle = (x + sizes[name][0] / 2, y + sizes[name][1] / 2)
                names[name].set_position(middle)
                arrows[name].set_position(middle)
                arrows[name].xy = (middle[0] + 0.5, middle[1] + 0.3)
        if annotated:
            clock.set_text(f"t = {step / RATE:.2f} s")
        return list(boxes.values())

    def png():
        for step in range(FRAMES):
            show(step)
            figure.savefig(folder / f"matplotlib-{step:06}.png", dpi=100)

    def gif():
        animation = FuncAnimation(figure, show, frames=FRAMES, blit=False)
        animation.save(folder / "matplotlib.gif", writer=PillowWriter(fps=RATE), dpi=100)

    return png, gif


def pillow_tasks(frames, sizes, folder):
    def picture(step):
        image = Image.new("RGB", (WIDTH, HEIGHT), "white")
        draw = ImageDraw.Draw(image)
        for number, (name, (x, y)) in enumerate(frames[step].items()):
            width, height = sizes[name]
            corners = [x * METRE, y * METRE, (x + width) * METRE, (y + height) * METRE]
            draw.rectangle(corners, fill=COLORS[number % 7], outline="black", width=2)
        return image

    def png():
        for step in range(FRAMES):
            picture(step).save(folder / f"pillow-{step:06}.png")

    def gif():
        pictures = [picture(step) for step in range(FRAMES)]
        pictures[0].save(folder / "pillow.gif", save_all=True, append_images=pictures[1:], duration=1000 / RATE, loop=0)

    return png, gif


def diagram(x, y):
    """A figure with axes of these titles and a grid."""
    figure, axes = pyplot.subplots(figsize=(WIDTH / 100, HEIGHT / 100), dpi=100)
    axes.set_xlabel(x)
    axes.set_ylabel(y)
    axes.grid(True)
    return figure, axes


def draw_energy(folder):
    """Energy and momentum over time, one below the other."""
    with open(folder / "energy.csv", newline="") as rows:
        columns = list(zip(*[[float(value) for value in row[1:]] for row in list(csv.reader(rows))[1:]]))
    time, kinetic, _, _, px, py = columns
    figure, (upper, lower) = pyplot.subplots(2, 1, figsize=(WIDTH / 100, HEIGHT / 100), dpi=100, height_ratios=[2, 1])
    upper.plot(time, kinetic, label="kinetic")
    lower.plot(time, px, label="p_x")
    lower.plot(time, py, label="p_y")
    for axes, title in ((upper, "E / J"), (lower, "p / (kg m/s)")):
        axes.set_xlabel("t / s")
        axes.set_ylabel(title)
        axes.grid(True)
        axes.legend()
    return figure


def draw_spacetime(table, sizes):
    """The extent of each box along x over time."""
    figure, axes = diagram("t / s", "x / m")
    time = [step / RATE for step in range(FRAMES)]
    for number, (name, (width, _)) in enumerate(sizes.items()):
        low = [frame[name][0] for frame in table]
        axes.fill_between(time, low, [x + width for x in low], color=COLORS[number % 7], alpha=0.6)
    return figure


def draw_strobe(table, sizes):
    """The boxes at 16 instants, earlier ones fainter."""
    figure, axes = pyplot.subplots(figsize=(WIDTH / 100, HEIGHT / 100), dpi=100)
    axes.set_xlim(0, 16)
    axes.set_ylim(9, 0)
    axes.set_aspect("equal")
    for instant in range(16):
        frame = table[instant * (FRAMES - 1) // 15]
        for number, (name, (width, height)) in enumerate(sizes.items()):
            alpha = 0.3 + 0.7 * instant / 15
            axes.add_patch(Rectangle(frame[name], width, height, facecolor=COLORS[number % 7], edgecolor="black", alpha=alpha))
    return figure


def draw_lines(table, sizes):
    """The position x of each box over time."""
    figure, axes = diagram("t / s", "x / m")
    time = [step / RATE for step in range(FRAMES)]
    for number, name in enumerate(sizes):
        axes.plot(time, [frame[name][0] for frame in table], color=COLORS[number % 7], linewidth=0.8)
    return figure


def draw_speeds(table, sizes):
    """The distribution of speeds, from the differences of positions, beside that of Maxwell and Boltzmann."""
    figure, axes = diagram("v / (m/s)", "f / (s/m)")
    steps = zip(table, table[1:])
    pairs = [(before[name], after[name]) for before, after in steps for name in sizes]
    speeds = [((x1 - x0) ** 2 + (y1 - y0) ** 2) ** 0.5 * RATE for (x0, y0), (x1, y1) in pairs]
    temperature = sum(speed**2 for speed in speeds) / (2 * len(speeds))
    curve = [number * max(speeds) / 200 for number in range(201)]
    axes.hist(speeds, bins=30, density=True)
    axes.plot(curve, [v / temperature * math.exp(-v * v / (2 * temperature)) for v in curve])
    return figure


def compare_figures(program, folder, frames, sizes):
    print("\n| figure | format | rebond ms | matplotlib ms | ratio | rebond kB | matplotlib kB |")
    print("|---|---|---:|---:|---:|---:|---:|")
    run(program, "export", folder / "run.mcap", "--table", "energy", "-o", folder / "energy.csv")
    drawings = {
        "energy": lambda: draw_energy(folder),
        "spacetime": lambda: draw_spacetime(frames, sizes),
        "strobe": lambda: draw_strobe(frames, sizes),
        "lines": lambda: draw_lines(frames, sizes),
        "speeds": lambda: draw_speeds(frames, sizes),
    }
    for kind, draw in drawings.items():
        for extension in ("png", "svg", "pdf"):
            ours, theirs = folder / f"{kind}.{extension}", folder / f"matplotlib-{kind}.{extension}"

            def peer():
                figure = draw()
                figure.savefig(theirs, dpi=100)
                pyplot.close(figure)

            quantity = ("--quantity", "x") if kind == "lines" else ()
            command = ("figure", kind, folder / "run.mcap", "-o", ours, "--force", *quantity)
            fast = measure(lambda: run(program, *command), 5, 1) * 1e3
            slow = measure(peer, 5, 1) * 1e3
            kilobytes = [file.stat().st_size / 1000 for file in (ours, theirs)]
            print(
                f"| {kind} | {extension.upper()} | {fast:.0f} | {slow:.0f} | {slow / fast:.1f} | {kilobytes[0]:.0f} | "
                f"{kilobytes[1]:.0f} |"
            )


def main():
    program = str(Path(sys.argv[1]).resolve())
    print(f"matplotlib {matplotlib.__version__}, Pillow {PIL.__version__}, Python {sys.version.split()[0]}")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "scene.toml").write_text(SCENE)
        run(program, "record", folder / "scene.toml", "-o", folder / "run.mcap")
        run(program, "export", folder / "run.mcap", "-o", folder / "run.csv")
        frames = read_frames(folder / "run.csv")
        sizes = {name: (0.4 + 0.6 * (number % 7) / 6,) * 2 for number, name in enumerate(frames[0])}
        clips = [
            ("plain", "none", matplotlib_tasks(frames, sizes, folder, False), pillow_tasks(frames, sizes, folder)),
            ("annotated", "velocity,name,grid,clock", matplotlib_tasks(frames, sizes, folder, True), None),
        ]
        print("\n| clip | format | rebond ms | matplotlib ms | ratio | Pillow ms | ratio | rebond kB | matplotlib kB |")
        print("|---|---|---:|---:|---:|---:|---:|---:|---:|")
        for clip, show, matplotlib_clip, pillow in clips:
            tasks = rebond_tasks(program, folder, show)
            for kind, ours, peer, simple in zip(("PNG", "GIF"), tasks, matplotlib_clip, pillow or (None, None)):
                print_line(folder, clip, kind, measure(ours, 3) * 1e3, measure(peer) * 1e3, simple and measure(simple) * 1e3)
        compare_figures(program, folder, frames, sizes)


def print_line(folder, clip, kind, ours, theirs, simple):
    pillow = f"{simple:.2f} | {simple / ours:.1f}" if simple else " | "
    patterns = ("run.gif", "matplotlib.gif") if kind == "GIF" else ("frames/*.png", "matplotlib-[0-9]*.png")
    sizes = [sum(file.stat().st_size for file in folder.glob(pattern)) / 1000 for pattern in patterns]
    print(
        f"| {clip} | {kind} | {ours:.2f} | {theirs:.2f} | {theirs / ours:.1f} | {pillow} | {sizes[0]:.0f} | "
        f"{sizes[1]:.0f} |"
    )


if __name__ == "__main__":
    main()
