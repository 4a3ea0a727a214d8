"""Reads recordings with the packages mcap and mcap-ros2-support and nothing of rebond's.

    python states.py RECORDING.mcap TABLE.csv

compares every number of the recording with TABLE.csv as `rebond export` wrote it, to the bit.
"""

import csv
import struct
import sys

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory


def rows(path):
    """Step, time, name, x, y, vx, vy of each body alive at each state recorded in full."""
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
    """What distinguishes two numbers that `==` does not, such as 0.0 and -0.0."""
    return struct.pack("<d", float(number)).hex()


def exact(row):
    step, time, name, *numbers = row
    return int(step), bits(time), name, [bits(number) for number in numbers]


def main(recording, table):
    with open(table, newline="") as file:
        heading, *theirs = csv.reader(file)
    assert heading == "step,time,name,x,y,vx,vy".split(",")
    ours = list(rows(recording))
    assert ours and len(ours) == len(theirs), f"{len(ours)} rows are recorded, {len(theirs)} exported"
    for row, exported in zip(ours, theirs):
        assert exact(row) == exact(exported), f"recorded {row}, exported {exported}"
    print(f"{recording}: {len(ours)} rows agree")


if __name__ == "__main__":
    main(*sys.argv[1:])
