"""Reads the scene updates that `--viewer` adds to a recording, as Foxglove does, and compares them with
the states.

    python boxes.py RECORDING.mcap TABLE.csv PICTURE.png STEP

TABLE.csv is the output of `rebond export`, PICTURE.png that of `rebond render --at STEP`.
"""

import csv
import sys
from collections import defaultdict

import png
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory as ProtobufFactory
from mcap_ros2.decoder import DecoderFactory as Ros2Factory

ALL = 1


def read_updates(path):
    """Returns the sizes of all bodies by name, and the scene update of each step."""
    sizes, updates = {}, {}
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[ProtobufFactory(), Ros2Factory()])
        for schema, channel, message, content in reader.iter_decoded_messages(topics=["/events", "/states", "/scene"]):
            if channel.topic == "/events":
                sizes |= {spawn.name: (spawn.width, spawn.height) for spawn in content.spawn}
            elif channel.topic == "/states":
                step = content.step
                assert times == (message.log_time, message.publish_time), f"step {step} has no scene update"
                updates[step] = update
            else:
                assert (schema.name, schema.encoding) == ("foxglove.SceneUpdate", "protobuf")
                times, update = (message.log_time, message.publish_time), content
                assert update.entities[0].timestamp.ToNanoseconds() == message.log_time
    return sizes, updates


def read_table(path):
    """Returns the names and corners of the living bodies at each step."""
    alive = defaultdict(list)
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            alive[int(row["step"])].append((row["name"], float(row["x"]), float(row["y"])))
    return alive


def check(update, bodies, sizes):
    """Checks that an update deletes all earlier entities and adds exactly these bodies."""
    assert [deletion.type for deletion in update.deletions] == [ALL]
    (entity,) = update.entities
    assert len(entity.cubes) == len(bodies)
    for cube, (name, x, y) in zip(entity.cubes, bodies):
        width, height = sizes[name]
        center = cube.pose.position
        assert (center.x, center.y) == (x + width / 2, -(y + height / 2)), name
        assert (cube.size.x, cube.size.y) == (width, height), name
        assert cube.size.z > 0 and center.z == cube.size.z / 2
        assert cube.pose.orientation.w == 1 and cube.color.a == 1


def rgb(cube):
    return tuple(round(channel * 255) for channel in (cube.color.r, cube.color.g, cube.color.b))


def read_colors(path):
    """Returns the colours of a picture."""
    _, _, rows, info = png.Reader(path).asRGB8()
    return {tuple(row[i : i + 3]) for row in rows for i in range(0, len(row), 3)}


def main(recording, table, picture, step):
    sizes, updates = read_updates(recording)
    alive = read_table(table)
    assert updates.keys() == alive.keys()
    for at, update in updates.items():
        check(update, alive[at], sizes)
    drawn = read_colors(picture)
    all_colors = {rgb(cube) for update in updates.values() for cube in update.entities[0].cubes}
    current = {rgb(cube) for cube in updates[int(step)].entities[0].cubes}
    assert len(current) > 3 and all_colors - current, "no box was deleted before the step"
    assert current <= drawn, f"not in the picture: {current - drawn}"
    assert not (all_colors - current) & drawn, "the picture shows a deleted box"
    print(f"{recording}: the scene updates of {len(updates)} steps agree with the states and the picture")


if __name__ == "__main__":
    main(*sys.argv[1:])
