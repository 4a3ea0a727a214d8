// Runs random scenes with `rebond record` and `rebond export` and with the JavaScript twin, and compares every
// number of every step bit for bit.
//
//   node tests/twin/compare.mjs [path of rebond] [number of scenes]

import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { Body, Engine, walls } from "./handout.mjs";

const rebond = process.argv[2] ?? "target/release/rebond";
const scenes = Number(process.argv[3] ?? 60);
const folder = mkdtempSync(join(tmpdir(), "rebond-twin-"));

/** A linear congruential generator with a fixed seed, so that failures are reproducible. */
function generator(seed) {
  let state = seed >>> 0;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

const kinds = {
  gas: (random) => ({ count: 12, gravity: null, e: 1, speed: 6, grid: false }),
  rain: (random) => ({ count: 10, gravity: [0, 9.81], e: 0.3 + 0.6 * random(), speed: 2, grid: false }),
  sideways: (random) => ({ count: 8, gravity: [3.5, -2.25], e: random(), speed: 3, grid: false }),
  overlapping: (random) => ({ count: 10, gravity: null, e: 0.5, speed: 0, grid: false }),
  touching: (random) => ({ count: 14, gravity: random() < 0.5 ? [0, 9.81] : null, e: 0.5, speed: 1, grid: true }),
};

/** A random scene as plain values, the input of both programs. */
function scene(kind, random) {
  const { count, gravity, e, speed, grid } = kinds[kind](random);
  const between = (low, high) => low + (high - low) * random();
  const materials = ["steel", "wood", ""];
  const steps = 240;
  const spawns = [], deletes = [];
  for (let number = 1; number <= count; number++) {
    const size = grid ? [1, 1] : [between(0.2, 1.6), between(0.2, 1.6)];
    const at = grid ? [Math.floor(between(0, 9)), Math.floor(between(0, 6))] : [between(0, 9), between(0, 6)];
    const infinite = random() < 0.1;
    const spawn = { step: random() < 0.3 ? Math.floor(between(0, steps)) : 0, name: `b${number}`, at, size,
      mass: infinite ? Infinity : 10 ** between(-2, 2), material: materials[Math.floor(between(0, 3))],
      velocity: random() < 0.3 ? [0, 0] : [between(-speed, speed), between(-speed, speed)],
      force: random() < 0.2 ? [between(-5, 5), between(-5, 5)] : [0, 0] };
    spawns.push(spawn);
    if (random() < 0.2 && spawn.step < steps - 1) {
      deletes.push({ step: Math.floor(between(spawn.step + 1, steps)), name: spawn.name });
    }
  }
  const rate = [60, 50, 120, 1000, 59.94][Math.floor(between(0, 5))];
  return { size: [10, 7], walls: random() < 0.7, gravity, e, rate, steps, spawns, deletes };
}

function toml({ size, walls, gravity, e, rate, steps, spawns, deletes }) {
  const number = (value) => value === Infinity ? "inf" : Number.isInteger(value) ? value.toFixed(1) : String(value);
  const list = (values) => `[${values.map(number).join(", ")}]`;
  const lines = [
    "[world]", `size = ${list(size)}`, `walls = ${walls}`, gravity ? `gravity = ${list(gravity)}` : "",
    walls ? 'wall_material = "steel"' : "",
    "[run]", `rate = ${rate}`, `steps = ${steps}`, 'solver = "handout"',
    "[restitution]", `default = ${number(e)}`, '"steel/steel" = 0.95', '"wood/wood" = 0.5', '"wood/steel" = 0.7',
  ];
  for (const spawn of spawns) {
    lines.push("[[spawn]]", `step = ${spawn.step}`, `name = "${spawn.name}"`, `at = ${list(spawn.at)}`,
      `size = ${list(spawn.size)}`, `mass = ${number(spawn.mass)}`, `velocity = ${list(spawn.velocity)}`,
      `force = ${list(spawn.force)}`);
    if (spawn.material) lines.push(`material = "${spawn.material}"`);
  }
  for (const { step, name } of deletes) lines.push("[[delete]]", `step = ${step}`, `name = "${name}"`);
  return lines.join("\n") + "\n";
}

/** The expected rows of `rebond export`, computed by the twin. */
function* twin({ size, walls: hasWalls, gravity, e, rate, steps, spawns, deletes }) {
  const pairs = { "steel/steel": 0.95, "wood/wood": 0.5, "steel/wood": 0.7 };
  const restitution = (a, b) => pairs[[a, b].sort().join("/")] ?? e;
  const engine = new Engine({ gravity, restitution });
  if (hasWalls) engine.bodies.push(...walls(size, "steel"));
  for (let step = 0; step <= steps; step++) {
    for (const deleted of deletes.filter((event) => event.step === step)) {
      engine.bodies.splice(engine.bodies.findIndex((body) => body.name === deleted.name), 1);
    }
    for (const spawn of spawns.filter((event) => event.step === step)) engine.bodies.push(new Body(spawn));
    for (const { name, origin, velocity } of engine.bodies) {
      yield [step, step / rate, name, origin.x, origin.y, velocity.x, velocity.y];
    }
    if (step < steps) engine.update(1 / rate);
  }
}

function* exported(recording) {
  const table = execFileSync(rebond, ["export", recording], { maxBuffer: 2 ** 30, encoding: "utf8" });
  for (const row of table.trimEnd().split("\n").slice(1)) {
    const [step, time, name, ...numbers] = row.split(",");
    yield [Number(step), Number(time), name, ...numbers.map(Number)];
  }
}

let passed = 0, failed = 0, compared = 0;
for (let number = 0; number < scenes; number++) {
  const kind = Object.keys(kinds)[number % Object.keys(kinds).length];
  const values = scene(kind, generator(number + 1));
  const [file, recording] = [join(folder, `${number}.toml`), join(folder, `${number}.mcap`)];
  writeFileSync(file, toml(values));
  execFileSync(rebond, ["record", file, "-o", recording]);
  const rows = exported(recording);
  let difference = null;
  for (const expected of twin(values)) {
    compared++;
    const row = rows.next().value ?? [];
    if (expected.some((value, column) => !Object.is(value, row[column]))) {
      difference = `twin ${expected}, rebond ${row}`;
      break;
    }
  }
  if (!difference && !rows.next().done) difference = "rebond exports more rows than the twin";
  if (difference) console.log(`scene ${number} (${kind}) differs: ${difference}\n${readFileSync(file, "utf8")}`);
  difference ? failed++ : passed++;
}
rmSync(folder, { recursive: true });
console.log(`${compared} rows compared bit for bit`);
console.log(`${passed} passed, ${failed} failed`);
process.exitCode = failed > 0 ? 1 : 0;
