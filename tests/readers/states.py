"""Reads recordings with the packages mcap and mcap-ros2-support, without any code of rebond.

    python states.py RECORDING.mcap TABLE.csv

compares every value of the recording bit for bit with TABLE.csv, the output of `rebond export`.
"""

import csv
import struct
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory


def rows(path):
    """Yields step, time, name, x, y, vx, vy of each living body in each full state."""
    with open(path, "rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        settings = next(record.metadata for record in reader.iter_metadata() if record.name == "rebond")
        every, rate = int(settings["every"]), float(settings["rate"].split()[0])
        alive = {}
        for _, channel, message, ros in reader.iter_decoded_messages(topics=["/events", "/states"]):
            assert message.log_time == ros.step * 1_000_000_000 // int(rate)
            if channel.topic == "/events":
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


def main(recording, table):
    with open(table, newline="") as file:
        heading, *exported = csv.reader(file)
    assert heading == "step,time,name,x,y,vx,vy".split(",")
    recorded = list(rows(recording))
    assert recorded and len(recorded) == len(exported), f"{len(recorded)} rows are recorded, {len(exported)} exported"
    for row, exported_row in zip(recorded, exported):
        assert to_bits(row) == to_bits(exported_row), f"recorded {row}, exported {exported_row}"
    print(f"{recording}: {len(recorded)} rows agree")


if __name__ == "__main__":
    main(*sys.argv[1:])
