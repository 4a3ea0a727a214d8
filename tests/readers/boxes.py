"""Reads what `--viewer` adds to a recording as Foxglove does, and compares it with the states.

    python boxes.py RECORDING.mcap TABLE.csv PICTURE.png STEP

TABLE.csv is what `rebond export` wrote, PICTURE.png what `rebond render --at STEP` drew.
"""

import csv
import sys
from collections import defaultdict

import png
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory as ProtobufFactory
from mcap_ros2.decoder import DecoderFactory as Ros2Factory

ALL = 1


def decoded(path):
    """Sizes of all bodies by name, and the message of each step."""
    sizes, updates = {}, {}
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[ProtobufFactory(), Ros2Factory()])
        for schema, channel, message, content in reader.iter_decoded_messages(topics=["/events", "/states", "/scene"]):
            if channel.topic == "/events":
                sizes |= {spawn.name: (spawn.width, spawn.height) for spawn in content.spawn}
            elif channel.topic == "/states":
                step = content.step
                assert times == (message.log_time, message.publish_time), f"step {step} has no boxes"
                updates[step] = update
            else:
                assert (schema.name, schema.encoding) == ("foxglove.SceneUpdate", "protobuf")
                times, update = (message.log_time, message.publish_time), content
                assert update.entities[0].timestamp.ToNanoseconds() == message.log_time
    return sizes, updates


def exported(path):
    """Names and corners of the bodies alive at each step."""
    alive = defaultdict(list)
    with open(path, newline="") as file:
        for row in csv.DictReader(file):
            alive[int(row["step"])].append((row["name"], float(row["x"]), float(row["y"])))
    return alive


def check(update, bodies, sizes):
    """A viewer forgets all it showed and shows these bodies and no others."""
    assert [deletion.type for deletion in update.deletions] == [ALL]
    (entity,) = update.entities
    assert len(entity.cubes) == len(bodies)
    for cube, (name, x, y) in zip(entity.cubes, bodies):
        width, height = sizes[name]
        middle = cube.pose.position
        assert (middle.x, middle.y) == (x + width / 2, -(y + height / 2)), name
        assert (cube.size.x, cube.size.y) == (width, height), name
        assert cube.size.z > 0 and middle.z == cube.size.z / 2
        assert cube.pose.orientation.w == 1 and cube.color.a == 1


def rgb(cube):
    return tuple(round(part * 255) for part in (cube.color.r, cube.color.g, cube.color.b))


def colors(path):
    """The colours of a picture."""
    _, _, rows, info = png.Reader(path).asRGB8()
    return {tuple(row[at : at + 3]) for row in rows for at in range(0, len(row), 3)}


def main(recording, table, picture, step):
    sizes, updates = decoded(recording)
    alive = exported(table)
    assert updates.keys() == alive.keys()
    for each, update in updates.items():
        check(update, alive[each], sizes)
    shown = colors(picture)
    ever = {rgb(cube) for update in updates.values() for cube in update.entities[0].cubes}
    now = {rgb(cube) for cube in updates[int(step)].entities[0].cubes}
    assert len(now) > 3 and ever - now, "a box goes before that step"
    assert now <= shown, f"not in the picture: {now - shown}"
    assert not (ever - now) & shown, "the picture shows what has gone"
    print(f"{recording}: {len(updates)} steps of boxes agree with states and picture")


if __name__ == "__main__":
    main(*sys.argv[1:])
