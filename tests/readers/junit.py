"""Validates the JUnit reports of check and replay: junit.py REBOND SCHEMA FOLDER"""

import os
import subprocess
import sys
import xml.etree.ElementTree as xml

import xmlschema

rebond, schema, folder = sys.argv[1:]
schema = xmlschema.XMLSchema(schema)
os.chdir(folder)


def run(*arguments, code=0):
    process = subprocess.run([rebond, "--quiet", *arguments], capture_output=True, text=True)
    assert process.returncode == code, f"{arguments}: {process}"
    return process.stdout


def write(name, text):
    with open(name, "w", encoding="utf-8") as file:
        file.write(text)


def validate(report, expected):
    """The report is valid, and has this many cases, failures and errors, both as elements and as counts."""
    schema.validate(report)
    (suite,) = xml.parse(report).getroot()
    found = [len(suite.findall(path)) for path in ("testcase", "testcase/failure", "testcase/error")]
    counts = [int(suite.get(name)) for name in ("tests", "failures", "errors")]
    assert found == counts == expected, f"{report}: {found}, {counts}, {expected}"
    return suite


SCENE = "[run]\nsteps = 20\n[[spawn]]\nname = '<c> & \"é\"'\nat = [1, 1]\nsize = [1, 1]\nmass = 1\nvelocity = [1, 0]\n"
for name in ("same", "changed", "a <b> & 'c' \"d\" é"):
    write(f"{name}.toml", SCENE)
    run("record", f"{name}.toml", "-o", f"{name}.mcap")
run("render", "same.mcap", "--at", "3", "-o", "same.png")
run("check", ".", "--junit", "same.xml")
validate("same.xml", [4, 0, 0])

# One of each outcome, with messages and names that XML must escape.
write("changed.toml", SCENE.replace("velocity = [1, 0]", "velocity = [2, 0]"))
write("unfinished.toml", SCENE)
write("invalid.toml", SCENE.replace("steps", "stops") + "# <![CDATA[ ]]> \t &amp;\n")
write("pictures.check", "rebond render same.mcap --at 3 --theme dark -o same.png\nrebond render <&>\n")
with open("a <b> & 'c' \"d\" é.mcap", "r+b") as file:
    file.truncate(2000)
write("damaged.png", "")
run("check", ".", "--junit", "different.xml", code=1)
suite = validate("different.xml", [8, 4, 3])
assert any("<b> & 'c' \"d\" é" in case.get("name") for case in suite.iter("testcase"))
run("check", "same.mcap", "--junit", "one.xml")
validate("one.xml", [1, 0, 0])

# A student's states: the same, others, and no table.
run("export", "same.mcap", "-o", "states.csv")
run("replay", "same.mcap", "--against", "states.csv", "--junit", "student.xml")
validate("student.xml", [1, 0, 0])
with open("states.csv", encoding="utf-8") as file:
    write("other.csv", file.read().replace(",1.0,", ",1.5,"))
run("replay", "same.mcap", "--against", "other.csv", "--junit", "other.xml", code=3)
validate("other.xml", [1, 1, 0])
write("none.csv", "step,x\n0,<\n")
run("replay", "same.mcap", "--against", "none.csv", "--junit", "none.xml", code=1)
validate("none.xml", [1, 0, 1])
print("6 JUnit reports are valid in the schemas of Ant and Jenkins")
