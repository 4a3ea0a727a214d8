"""Runs the commands and the Python of the guide's chapter on notebooks: notebook.py REBOND CHAPTER FOLDER"""

import os
import re
import subprocess
import sys

rebond, chapter, folder = sys.argv[1:]
with open(chapter, encoding="utf-8") as file:
    text = file.read()
os.chdir(folder)
os.symlink(rebond, "rebond")
blocks = {language: re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL) for language in ("sh", "python")}
environment = {**os.environ, "PATH": os.pathsep.join([os.getcwd(), os.environ["PATH"]])}
for commands in blocks["sh"]:
    subprocess.run(["bash", "-euc", commands], check=True, env=environment, stdout=subprocess.DEVNULL)
names = {}
for program in blocks["python"]:
    exec(compile(program, chapter, "exec"), names)

# Names that look like numbers or missing values stay text, and floats floats.
odd = ["7", "1e5", "NA", "nan", "inf", "null", "True", 'a,"b"', "été"]
spawns = [
    f"[[spawn]]\nname = '{name}'\nat = [{index}.5, 1.0]\nsize = [0.5, 0.5]\nmass = {index + 1}\nvelocity = [{index}.0, 0.0]\n"
    for index, name in enumerate(odd)
]
with open("odd.toml", "w", encoding="utf-8") as file:
    file.write("run.steps = 120\nworld.walls = true\n" + "".join(spawns) + "[[delete]]\nname = '7'\nstep = 5\n")
for table in ("states", "bodies", "collisions", "energy"):
    subprocess.run(["./rebond", "export", "odd.toml", "--quiet", "--table", table, "-o", f"odd-{table}.csv"], check=True)
states, bodies, collisions, energy = (
    names["read_table"](f"odd-{table}.csv") for table in ("states", "bodies", "collisions", "energy")
)
assert list(bodies["name"][4:]) == odd and set(states["name"]) >= set(odd)
assert bodies["deleted_step"].dtype == "Int64" and bodies["deleted_step"].count() == 1
assert len(collisions) > 0 and set(collisions["b"]) <= set(odd)
for table in (states, bodies, collisions, energy):
    for column, kind in table.dtypes.items():
        integers = ("step", "id", "spawned_step", "deleted_step")
        expected = "text" if column in names["TEXT"] else "i" if column in integers else "f"
        found = "text" if kind.name in ("str", "object", "string") else kind.kind
        assert found == expected, (column, kind)
print("notebook: energies, collisions, a study and their types are right")
