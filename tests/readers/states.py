"""Reads recordings with libraries by others, without any code of rebond.

    python states.py mcap|rosbags RECORDING.mcap TABLE.csv

compares every value of the recording bit for bit with TABLE.csv, the output of `rebond export`. `mcap` reads with the
packages mcap and mcap-ros2-support, `rosbags` with the package of that name, as ROS 2 does.
"""

import csv
import struct
import sys
from pathlib import Path

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

TOPICS = ["/events", "/states"]


def messages_of_mcap(path):
    """Yields topic, log time and decoded message of all events and states, in order."""
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        for _, channel, message, ros in reader.iter_decoded_messages(topics=TOPICS):
            yield channel.topic, message.log_time, ros


def messages_of_rosbags(path):
    """The same with rosbags."""
    with AnyReader([Path(path)]) as reader:
        connections = [connection for connection in reader.connections if connection.topic in TOPICS]
        for connection, log_time, bytes_of_message in reader.messages(connections):
            yield connection.topic, log_time, reader.deserialize(bytes_of_message, connection.msgtype)


def settings(path):
    """Returns every how many steps the states are full, and the rate (Hz). rosbags has no access to metadata."""
    with open(path, "rb") as file:
        metadata = next(record.metadata for record in make_reader(file).iter_metadata() if record.name == "rebond")
    return int(metadata["every"]), float(metadata["rate"].split()[0])


def rows(messages, every, rate):
    """Yields step, time, name, x, y, vx, vy of each living body in each full state."""
    alive = {}
    for topic, log_time, ros in messages:
        assert log_time == ros.step * 1_000_000_000 // int(rate)
        if topic == "/events":
            alive |= {spawn.id: spawn for spawn in ros.spawn}
            for body in ros.delete:
                del alive[body]
        elif ros.step % every == 0:
            moved = dict(zip(ros.id, zip(ros.x, ros.y, ros.vx, ros.vy)))
            assert moved.keys() <= alive.keys()
            for body, spawn in alive.items():
                numbers = moved.get(body, (spawn.x, spawn.y, spawn.vx, spawn.vy))
                yield ros.step, ros.step / rate, spawn.name, *numbers


def bits(number):
    """Returns the bits of a number, which distinguish 0.0 and -0.0."""
    return struct.pack("<d", float(number)).hex()


def to_bits(row):
    step, time, name, *numbers = row
    return int(step), bits(time), name, [bits(number) for number in numbers]


def main(library, recording, table):
    with open(table, newline="") as file:
        heading, *exported = csv.reader(file)
    assert heading == "step,time,name,x,y,vx,vy".split(",")
    messages = {"mcap": messages_of_mcap, "rosbags": messages_of_rosbags}[library](recording)
    recorded = list(rows(messages, *settings(recording)))
    assert recorded and len(recorded) == len(exported), f"{len(recorded)} rows are recorded, {len(exported)} exported"
    for row, exported_row in zip(recorded, exported):
        assert to_bits(row) == to_bits(exported_row), f"recorded {row}, exported {exported_row}"
    print(f"{recording}: {len(recorded)} rows agree, read with {library}")


if __name__ == "__main__":
    main(*sys.argv[1:])
