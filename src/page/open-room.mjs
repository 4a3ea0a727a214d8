// Opens the empty room in the module, and writes the module with the memory after that, so that the page starts without
// parsing a scene: node open-room.mjs MODULE ROOM OPENED
import { readFileSync, writeFileSync } from 'node:fs';
import { MEMORY, Module, encoded } from './module.mjs';

const [path, room, output] = process.argv.slice(2);
const PAGE = 65_536;

const original = readFileSync(path);
const { instance: { exports: x } } = await WebAssembly.instantiate(original, {});
x.start();
const text = Buffer.from(`room.toml\n${readFileSync(room, 'utf8')}`);
const at = x.input(text.length);
Buffer.from(x.memory.buffer).set(text, at);
if (x.load(0) !== 0) throw new Error(Buffer.from(x.memory.buffer, x.output(), x.output_length()).toString());

const memory = Buffer.from(x.memory.buffer);
const module = new Module(original);
module.setData([[0, memory]]);
// One memory, without a largest size.
module.sections.find(({ id }) => id === MEMORY).content = Buffer.from([1, 0, ...encoded(memory.length / PAGE)]);
writeFileSync(output, module.bytes());
