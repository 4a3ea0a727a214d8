// Writes a recording again with the TypeScript writer of MCAP, without any code of rebond.
//
//     node rewrite.mjs RECORDING.mcap FOLDER

import { open, readFile } from "node:fs/promises";
import { McapStreamReader, McapWriter } from "@mcap/core";
import { decompress } from "fzstd";

class Output {
  #handle;
  #position = 0n;
  constructor(handle) {
    this.#handle = handle;
  }
  async write(buffer) {
    await this.#handle.write(buffer);
    this.#position += BigInt(buffer.byteLength);
  }
  position() {
    return this.#position;
  }
}

const LAYOUTS = {
  chunks: {},
  "small-chunks": { chunkSize: 4096 },
  "chunks-without-index": { useMessageIndex: false, useChunkIndex: false, useMetadataIndex: false, repeatChannels: false },
  // Without chunks, the writer stores wrong offsets in its metadata index.
  unchunked: { useChunks: false, useMetadataIndex: false },
};

/** Returns all records, including those in chunks. */
function* records(bytes) {
  const decompressHandlers = { zstd: (data, size) => decompress(data, new Uint8Array(Number(size))) };
  const reader = new McapStreamReader({ decompressHandlers });
  reader.append(bytes);
  for (let record; (record = reader.nextRecord()); ) yield record;
}

async function rewrite(bytes, path, layout) {
  const handle = await open(path, "w");
  const writer = new McapWriter({ writable: new Output(handle), ...layout });
  const [schemas, channels] = [new Map(), new Map()];
  for (const record of records(bytes)) {
    if (record.type === "Header") {
      await writer.start({ profile: record.profile, library: record.library });
    } else if (record.type === "Schema" && !schemas.has(record.id)) {
      schemas.set(record.id, await writer.registerSchema(record));
    } else if (record.type === "Channel" && !channels.has(record.id)) {
      channels.set(record.id, await writer.registerChannel({ ...record, schemaId: schemas.get(record.schemaId) }));
    } else if (record.type === "Message") {
      await writer.addMessage({ ...record, channelId: channels.get(record.channelId) });
    } else if (record.type === "Metadata") {
      await writer.addMetadata(record);
    } else if (record.type === "Attachment") {
      await writer.addAttachment(record);
    }
  }
  await writer.end();
  await handle.close();
}

const [recording, folder] = process.argv.slice(2);
const bytes = await readFile(recording);
for (const [name, layout] of Object.entries(LAYOUTS)) {
  await rewrite(bytes, `${folder}/typescript-${name}.mcap`, layout);
}
