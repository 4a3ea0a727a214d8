// Reads recordings with the packages @mcap/core and @foxglove/rosmsg2-serialization, without any
// code of rebond.
//
//     node states.mjs RECORDING.mcap TABLE.jsonl
//
// compares every value of the recording bit for bit with TABLE.jsonl, the output of `rebond export`.

import assert from "node:assert/strict";
import { open, readFile } from "node:fs/promises";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader } from "@mcap/core";
import { decompress } from "fzstd";

class File {
  constructor(handle) {
    this.handle = handle;
  }
  async size() {
    return BigInt((await this.handle.stat()).size);
  }
  async read(offset, length) {
    const { buffer } = await this.handle.read(new Uint8Array(Number(length)), 0, Number(length), Number(offset));
    return buffer;
  }
}

/** Yields topic and decoded message of all events and states, in order. */
async function* messages(reader) {
  const decoders = new Map();
  for await (const { channelId, data } of reader.readMessages({ topics: ["/events", "/states"] })) {
    const { topic, schemaId } = reader.channelsById.get(channelId);
    if (!decoders.has(channelId)) {
      const schema = new TextDecoder().decode(reader.schemasById.get(schemaId).data);
      decoders.set(channelId, new MessageReader(parse(schema, { ros2: true })));
    }
    yield [topic, decoders.get(channelId).readMessage(data)];
  }
}

/** Yields one object for each living body in each full state. */
async function* rows(path) {
  const readable = new File(await open(path));
  const decompressHandlers = { zstd: (bytes, size) => decompress(bytes, new Uint8Array(Number(size))) };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const { every, rate } = await settings(reader);
  const alive = new Map();
  for await (const [topic, message] of messages(reader)) {
    if (topic === "/events") {
      message.spawn.forEach((spawn) => alive.set(spawn.id, spawn));
      message.delete.forEach((id) => assert(alive.delete(id)));
    } else if (message.step % every === 0n) {
      const indices = new Map(Array.from(message.id, (id, index) => [id, index]));
      for (const [id, spawn] of alive) {
        const index = indices.get(id);
        const value = (field) => (index === undefined ? spawn[field] : message[field][index]);
        const [x, y, vx, vy] = ["x", "y", "vx", "vy"].map(value);
        yield { step: Number(message.step), time: Number(message.step) / rate, name: spawn.name, x, y, vx, vy };
      }
    }
  }
}

async function settings(reader) {
  for await (const { name, metadata } of reader.readMetadata({ name: "rebond" })) {
    if (name === "rebond") {
      return { every: BigInt(metadata.get("every")), rate: Number(metadata.get("rate").split(" ")[0]) };
    }
  }
  throw new Error("the settings are missing");
}

const [recording, table] = process.argv.slice(2);
const exported = (await readFile(table, "utf8")).trimEnd().split("\n").map((line) => JSON.parse(line));
let count = 0;
for await (const row of rows(recording)) {
  // deepStrictEqual compares with Object.is, which distinguishes -0 from 0.
  assert.deepStrictEqual(row, exported[count], `row ${count}`);
  count += 1;
}
assert(count > 0);
assert.equal(count, exported.length);
console.log(`${recording}: ${count} rows agree`);
