// Moves the bytes of files that only the second part of the module reads, such as the font, from the data of the first
// part to data of the second one: node split-data.mjs CORE REST FILE…
import { readFileSync, writeFileSync } from 'node:fs';
import { DATA, Module } from './module.mjs';

/** The parts of a segment between long runs of zeros. */
function nonzero([address, bytes]) {
  // Each part has a head of some bytes.
  const GAP = 16;
  const parts = [];
  for (let from = 0; from < bytes.length;) {
    if (bytes[from] === 0) { from += 1; continue; }
    let [to, zeros] = [from, 0];
    for (; to < bytes.length && zeros < GAP; to += 1) zeros = bytes[to] === 0 ? zeros + 1 : 0;
    parts.push([address + from, bytes.subarray(from, to - zeros)]);
    from = to;
  }
  return parts;
}

const [corePath, restPath, ...files] = process.argv.slice(2);
const [core, rest] = [corePath, restPath].map((path) => new Module(readFileSync(path)));
let kept = core.data();
const moved = [];
for (const file of files) {
  const content = readFileSync(file);
  kept = kept.flatMap(([address, bytes]) => {
    const at = bytes.indexOf(content);
    if (at < 0) return [[address, bytes]];
    moved.push([address + at, content]);
    const end = at + content.length;
    return [[address, bytes.subarray(0, at)], [address + end, bytes.subarray(end)]].filter(([, part]) => part.length > 0);
  });
}
if (moved.length === 0 || rest.section(DATA)) throw new Error('cannot move the data');
core.setData(kept.flatMap(nonzero));
rest.setData(moved);
writeFileSync(corePath, core.bytes());
writeFileSync(restPath, rest.bytes());
