// Runs the bundled scenes in an instrumented module as the page does from its start on, and writes which functions that
// needs: node profile.mjs MODULE PROFILE
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

/** Clicks, steps, goes back, and undoes the click. */
function play(which) {
  for (const now of [1, 0]) {
    give('{"click": {"at": [0.5, 0.5], "spawn": {"size": [0.1, 0.1], "mass": 1.0, "velocity": [0.5, 0.0], "material": "wood"}}}');
    x.event(which, now);
    for (let step = 0; step < 20; step += 1) { x.step(which, 1); show(which); }
    give('box 1');
    x.throw_body(which, 0.2, 0.2, 0.0, 1.0, now);
  }
  x.go_to(which, 5);
  while (!x.advance(which, 4)) show(which);
  x.undo(which);
  while (!x.advance(which, 4)) show(which);
  for (const text of [x.scene, x.lines]) ask(text(which));
  give('');
  x.set_lines(which);
}

x.start();
x.bundled();
for (const [name, scene] of JSON.parse(ask(0))) {
  give(`${name}.toml\n${scene}`);
  ask(x.load(0));
  play(0);
  give('run.solver\n"handout"');
  // Some scenes are of the other solver alone.
  if (x.set(0, 1) === 0) play(1);
}
const length = x.profile(0, 0);
const at = x.input(length);
x.profile(at, length);
writeFileSync(output, new Uint8Array(x.memory.buffer, at, length));
