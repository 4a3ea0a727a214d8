"""Writes a recording again in every layout that other programs give to MCAP files, without any code of rebond.

    python rewrite.py RECORDING.mcap FOLDER

The messages, metadata and attachments stay the same; chunks, compression, index, summary and checksums do not.
"""

import struct
import sys
from pathlib import Path

from mcap.data_stream import RecordBuilder
from mcap.records import Attachment, Channel, Header, Message, Metadata, Schema
from mcap.stream_reader import StreamReader
from mcap.writer import CompressionType, IndexType, Writer

# Layouts of the official writer.
WITHOUT_SUMMARY = {
    "index_types": IndexType.NONE,
    "repeat_channels": False,
    "repeat_schemas": False,
    "use_statistics": False,
    "use_summary_offsets": False,
}
LAYOUTS = {
    "zstd": {},
    "zstd-small-chunks": {"chunk_size": 1 << 12},
    "lz4": {"compression": CompressionType.LZ4},
    "lz4-small-chunks": {"compression": CompressionType.LZ4, "chunk_size": 1 << 12, "enable_data_crcs": True},
    "none": {"compression": CompressionType.NONE},
    "none-without-checksums": {"compression": CompressionType.NONE, "enable_crcs": False},
    "zstd-without-message-index": {"index_types": IndexType.ALL & ~IndexType.MESSAGE},
    "zstd-without-index": {"index_types": IndexType.NONE},
    "zstd-without-summary": WITHOUT_SUMMARY,
    "lz4-without-summary": WITHOUT_SUMMARY | {"compression": CompressionType.LZ4},
    "unchunked": {"use_chunking": False},
    "unchunked-without-summary": {"use_chunking": False} | WITHOUT_SUMMARY,
}

MAGIC = b"\x89MCAP0\r\n"
DATA_END = b"\x0f" + struct.pack("<QI", 4, 0)
FOOTER = b"\x02" + struct.pack("<QQQI", 20, 0, 0, 0)
# Opcodes from 0x80 are free for programs to use; a reader must skip those it does not know.
PRIVATE_RECORD = b"\x80" + struct.pack("<Q", 3) + b"own"


def write(records, path, layout):
    """Writes the records with the official writer."""
    with open(path, "wb") as file:
        writer = Writer(file, **layout)
        schemas, channels = {}, {}
        for record in records:
            match record:
                case Header():
                    writer.start(record.profile, record.library)
                case Schema():
                    schemas[record.id] = writer.register_schema(record.name, record.encoding, record.data)
                case Channel():
                    channels[record.id] = writer.register_channel(
                        record.topic, record.message_encoding, schemas[record.schema_id], record.metadata
                    )
                case Message():
                    channel = channels[record.channel_id]
                    writer.add_message(channel, record.log_time, record.data, record.publish_time, record.sequence)
                case Metadata():
                    writer.add_metadata(record.name, record.metadata)
                case Attachment():
                    writer.add_attachment(
                        record.create_time, record.log_time, record.name, record.media_type, record.data
                    )
        writer.finish()


def write_with_extensions(records, path):
    """Writes the records with what later versions of MCAP and other programs may add: private records, and fields
    after the last one."""
    contents = MAGIC
    for record in records:
        builder = RecordBuilder()
        record.write(builder)
        encoded = builder.end()
        if isinstance(record, (Header, Schema, Channel, Metadata)):
            opcode, fields = encoded[:1], encoded[9:] + b"later"
            encoded = opcode + struct.pack("<Q", len(fields)) + fields
        contents += encoded + PRIVATE_RECORD
    Path(path).write_bytes(contents + DATA_END + FOOTER + MAGIC)


def content(path):
    """Returns the records that are not derived from others, each schema and channel once."""
    records, known = [], set()
    with open(path, "rb") as file:
        for record in StreamReader(file).records:
            if isinstance(record, (Schema, Channel)) and (key := (type(record), record.id)) not in known:
                known.add(key)
                records.append(record)
            elif isinstance(record, (Header, Message, Metadata, Attachment)):
                records.append(record)
    return records


def main(recording, folder):
    records = content(recording)
    for name, layout in LAYOUTS.items():
        write(records, f"{folder}/python-{name}.mcap", layout)
    write_with_extensions(records, f"{folder}/extended.mcap")


if __name__ == "__main__":
    main(*sys.argv[1:])
