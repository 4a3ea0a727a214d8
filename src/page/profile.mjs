// Clicks in the empty room, which an instrumented module has opened, as the page does from its start on, and writes which
// functions that needs: node profile.mjs MODULE PROFILE
import { readFileSync, writeFileSync } from 'node:fs';

const [module, output] = process.argv.slice(2);
const { instance: { exports: x } } = await WebAssembly.instantiate(readFileSync(module), {});
const bytes = () => new Uint8Array(x.memory.buffer, x.output(), x.output_length());

function give(text) {
  const input = new TextEncoder().encode(text);
  const at = x.input(input.length);
  new Uint8Array(x.memory.buffer, at, input.length).set(input);
}

function ask(code) {
  const text = new TextDecoder().decode(bytes());
  if (code === 1) throw new Error(text);
  return text;
}

function show(which) {
  for (const ask of [x.status, x.names, x.collisions, x.energy, x.energy_now, x.recent_collisions]) ask(which);
  for (const color of [0, 1, 2]) x.bodies(which, 0.001, color);
  x.column_numbers();
  x.step_now(which);
}

// Boxes are made, collide with each other and with the walls, are thrown and deleted; time stands, runs and goes back.
x.name_boxes(0);
for (const now of [1, 0]) {
  for (const at of [2, 5, 8]) {
    give(`{"click": {"at": [${at}, 6.5], "spawn": {"size": [1.0, 1.0], "mass": 1.0, "velocity": [${9 - 2 * at}, 0.0], "material": "wood"}}}`);
    ask(x.event(0, now));
    show(0);
  }
  for (let step = 0; step < 120; step += 1) { x.step(0, 1); show(0); }
  give('box 1');
  ask(x.throw_body(0, 4.0, 2.0, 3.0, 1.0, now));
}
for (let step = 0; step < 120; step += 1) { x.step(0, 1); show(0); }
x.go_to(0, 150);
while (!x.advance(0, 4)) show(0);
x.undo(0);
while (!x.advance(0, 4)) show(0);
for (const text of [x.scene, x.lines]) ask(text(0));
const length = x.profile(0, 0);
const at = x.input(length);
x.profile(at, length);
writeFileSync(output, new Uint8Array(x.memory.buffer, at, length));
