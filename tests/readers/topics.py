"""Reads the MCAP file of `rebond export -o BODIES.mcap` with libraries by others: each topic is one body throughout the run.

    python topics.py BODIES.mcap RATE TABLE.csv

compares every value of every topic bit for bit with TABLE.csv, the output of `rebond export`, once with the packages mcap
and mcap-ros2-support and once with rosbags. No two bodies may have the same name.
"""

import csv
import sys
from collections import defaultdict
from pathlib import Path

from mcap.reader import make_reader
from mcap_ros2.decoder import DecoderFactory
from rosbags.highlevel import AnyReader

from states import bits


def of_mcap(path):
    """Yields topic, time (ns) and message."""
    with open(path, "rb") as file:
        for _, channel, message, ros in make_reader(file, decoder_factories=[DecoderFactory()]).iter_decoded_messages():
            yield channel.topic, message.log_time, ros


def of_rosbags(path):
    """The same with rosbags."""
    with AnyReader([Path(path)]) as reader:
        for connection, time, message in reader.messages():
            yield connection.topic, time, reader.deserialize(message, connection.msgtype)


def names(path):
    """Returns the name of the body of each topic."""
    with open(path, "rb") as file:
        channels = make_reader(file).get_summary().channels.values()
        return {channel.topic: channel.metadata["name"] for channel in channels}


def main(path, rate, table):
    expected = defaultdict(list)
    with open(table, newline="") as file:
        for row in csv.DictReader(file):
            time = int(row["step"]) * 1_000_000_000 // int(rate)
            expected[row["name"]].append((time, [bits(row[key]) for key in ("x", "y", "vx", "vy")]))
    name_of = names(path)
    assert len(set(name_of.values())) == len(name_of) and set(name_of.values()) == expected.keys(), name_of
    for messages in of_mcap, of_rosbags:
        found = defaultdict(list)
        for topic, time, ros in messages(path):
            found[name_of[topic]].append((time, [bits(number) for number in (ros.x, ros.y, ros.vx, ros.vy)]))
        assert found == expected
    print(f"{path}: {len(name_of)} topics, each of one body, read with mcap and rosbags")


if __name__ == "__main__":
    main(*sys.argv[1:])
