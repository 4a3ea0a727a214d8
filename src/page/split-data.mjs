// Moves the bytes of files that only the second part of the module reads, such as the font, from the data of the first
// part to data of the second one: node split-data.mjs CORE REST FILE…
import { readFileSync, writeFileSync } from 'node:fs';

const [corePath, restPath, ...files] = process.argv.slice(2);
const [core, rest] = [corePath, restPath].map((path) => readFileSync(path));
const [CODE, DATA] = [10, 11];

/** Reads the number of variable length at `at`, and returns it with the place after it. */
function number(bytes, at) {
  let [value, shift] = [0, 0];
  for (;;) {
    const byte = bytes[at];
    at += 1;
    value += (byte & 127) * 2 ** shift;
    shift += 7;
    if (byte < 128) return [value, at];
  }
}

/** The bytes of a number of variable length, which repeat its sign if `isSigned`. */
function encoded(value, isSigned) {
  const bytes = [];
  for (;;) {
    const byte = value & 127;
    value >>= 7;
    if (value === 0 && !(isSigned && byte & 64)) return [...bytes, byte];
    bytes.push(byte | 128);
  }
}

/** The places of the contents of a section of a module. */
function section(module, wanted) {
  for (let at = 8; at < module.length;) {
    const id = module[at];
    const [length, start] = number(module, at + 1);
    if (id === wanted) return [start, start + length];
    at = start + length;
  }
  return null;
}

/** The segments of the data: where they are in the module, and their address in the memory. */
function segments(module) {
  let [at] = section(module, DATA);
  const found = [];
  let count;
  [count, at] = number(module, at);
  for (; count > 0; count -= 1) {
    let [kind, address, length] = [];
    [kind, at] = number(module, at);
    if (kind !== 0 || module[at] !== 0x41) throw new Error('expected active segments at constant addresses');
    [address, at] = number(module, at + 1);
    [length, at] = number(module, at + 1);
    found.push({ start: at, end: at + length, address });
    at += length;
  }
  return found;
}

const known = segments(core);
const moved = [];
for (const file of files) {
  const content = readFileSync(file);
  const at = core.indexOf(content);
  if (at < 0) continue;
  const { start, address } = known.find(({ start, end }) => at >= start && at + content.length <= end);
  core.fill(0, at, at + content.length);
  moved.push([0, 0x41, ...encoded(address + at - start, true), 0x0b, ...encoded(content.length), ...content]);
}
if (moved.length === 0 || section(rest, DATA) || section(rest, CODE)[1] !== rest.length) throw new Error('cannot add the data');
const data = Buffer.from([...encoded(moved.length), ...moved.flat()]);
writeFileSync(corePath, core);
writeFileSync(restPath, Buffer.concat([rest, Buffer.from([DATA, ...encoded(data.length)]), data]));
