// Checks what Windows does differently from other systems: paths, line ends, replacing files, locks and Ctrl-C.
//   node windows.mjs PROGRAM [ARGUMENT…], the command that runs rebond.exe in wine
import assert from 'node:assert/strict';
import { spawn, spawnSync } from 'node:child_process';
import { existsSync, mkdirSync, mkdtempSync, readFileSync, readdirSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import process from 'node:process';
import { setTimeout as sleep } from 'node:timers/promises';

const [program, ...first] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), 'rebond-windows-'));
process.on('exit', () => rmSync(folder, { recursive: true, force: true }));
const options = { cwd: folder, env: { ...process.env, NO_COLOR: '1' } };

const SCENE = `[world]
walls = true
[run]
steps = 120
[[spawn]]
name = "a"
at = [2.0, 3.0]
size = [1.0, 1.0]
mass = 1.0
velocity = [4.0, 0.0]
`;

const path = (name) => join(folder, name);
const read = (name) => readFileSync(path(name));
const write = (name, content) => writeFileSync(path(name), content);
const names = () => readdirSync(folder).sort();
const temporary = () => names().filter((name) => name.startsWith('.rebond-'));
/** A path as Windows programs write it; wine has the root folder as drive Z. */
const ofWindows = (path) => `Z:${path.replaceAll('/', '\\')}`;

/** Runs a command to its end, and returns its exit code and output. */
function run(...words) {
  const { status, stdout, stderr, error } = spawnSync(program, [...first, ...words], { ...options, encoding: 'utf8' });
  assert.equal(error, undefined);
  return { code: status, output: stdout, errors: stderr };
}

/** Runs a command that must end with an exit code, and returns its output. */
function ends(code, ...words) {
  const end = run(...words);
  assert.equal(end.code, code, `rebond ${words.join(' ')}: ${JSON.stringify(end)}`);
  return end.output + end.errors;
}

/** Starts a command; its input stays open. */
function start(...words) {
  const child = spawn(program, [...first, ...words], { ...options, stdio: ['pipe', 'ignore', 'pipe'] });
  child.words = words.join(' ');
  child.errors = '';
  child.stderr.on('data', (data) => (child.errors += data));
  child.ended = new Promise((resolve) => child.on('close', (code, signal) => resolve(signal ?? code)));
  return child;
}

async function until(what, condition) {
  for (let attempt = 0; attempt < 1200; attempt++) {
    if (condition()) return;
    await sleep(50);
  }
  assert.fail(`not within a minute: ${what}`);
}

/** Backslashes, drives, blanks, other scripts, case, and devices. */
function paths() {
  mkdirSync(path('scenes'));
  mkdirSync(path('größe und Δ'));
  write('scenes/scene.toml', SCENE);
  ends(0, 'record', 'scenes\\scene.toml', '-o', 'größe und Δ\\run.mcap');
  assert.deepEqual(read('größe und Δ/run.mcap'), read('run.mcap'));
  ends(0, 'replay', ofWindows(path('größe und Δ/run.mcap')));
  ends(0, 'export', '.\\größe und Δ/run.mcap', '-o', ofWindows(path('drive.csv')));
  assert.ok(read('drive.csv').includes('step,time,name'));
  ends(0, 'render', 'run.mcap', '--from', '5', '--to', '7', '--size', '64x36', '-o', 'deep\\frames\\');
  assert.deepEqual(readdirSync(path('deep/frames')).sort(), ['000005.png', '000006.png', '000007.png']);
  write('scenes/sprite.toml', SCENE.replace('name = "a"', 'name = "a"\nimage = "../deep/frames/000005.png"'));
  ends(0, 'render', 'scenes\\sprite.toml', '--at', '3', '--size', '64x36', '-o', 'sprite.png');
  // The same file, whatever its case.
  const recording = read('run.mcap');
  assert.match(ends(1, 'recover', 'run.mcap', '-o', 'RUN.MCAP', '--force'), /reads this file/);
  assert.match(ends(1, 'render', 'scenes\\sprite.toml', '--at', '3', '--force', '-o', 'DEEP\\frames\\000005.png'), /reads this file/);
  assert.deepEqual(read('run.mcap'), recording);
  for (const force of [[], ['--force']]) ends(0, 'record', 'scene.toml', '-o', 'NUL', ...force);
  assert.ok(!existsSync(path('NUL')));
  ends(3, 'check', 'scenes'); // Without recordings.
  ends(0, 'check', 'scenes', '--update');
  ends(0, 'check', 'größe und Δ\\run.mcap', 'scenes');
}

/** CR LF in scenes, events, manifests, references and recordings. */
function lineEnds() {
  const crlf = (text) => text.toString().replaceAll('\n', '\r\n');
  const states = ends(0, 'export', 'run.mcap');
  assert.ok(!states.includes('\r'));
  write('crlf.toml', crlf(SCENE));
  write('events.jsonl', crlf('{"delete": {"step": 100, "name": "a"}}\n'));
  ends(0, 'record', 'crlf.toml', '-o', 'crlf.mcap');
  assert.match(ends(0, 'replay', 'crlf.mcap'), /^same: 120 steps/);
  assert.equal(ends(0, 'export', 'crlf.mcap'), states);
  ends(0, 'record', 'crlf.toml', '--events', 'events.jsonl', '-o', 'events.mcap');
  assert.match(ends(0, 'replay', 'events.mcap'), /^same: 120 steps/);
  ends(0, 'render', 'run.mcap', '--at', '3', '-o', 'reference.svg');
  write('reference.svg', crlf(read('reference.svg')));
  write('manifest.check', crlf('rebond render run.mcap --at 3 -o reference.svg\n'));
  ends(0, 'check', 'manifest.check');
  // Any other difference is still one.
  write('reference.svg', read('reference.svg').toString().replace('</svg>', '<rect/></svg>'));
  ends(3, 'check', 'manifest.check');
}

/** A file is complete or the old one, and nothing else is left. */
async function replacement() {
  const before = names();
  for (const [output, ...words] of [
    ['new.csv', 'export', 'run.mcap'],
    ['new.svg', 'render', 'run.mcap', '--at', '3'],
    ['new.gif', 'render', 'run.mcap', '--every', '20', '--size', '64x36'],
    ['new.mcap', 'recover', 'run.mcap'],
    ['new2.mcap', 'record', 'scene.toml'],
  ]) {
    write(output, 'old');
    assert.match(ends(1, ...words, '-o', output), /already exists/);
    assert.equal(read(output).toString(), 'old');
    ends(0, ...words, '-o', output, '--force');
    const complete = read(output);
    assert.ok(complete.length > 100, output);
    write('bad.mcap', 'not a recording');
    write('bad.toml', '[run]\nsteps = -1\n');
    const bad = words.map((word) => word.replace('run.mcap', 'bad.mcap').replace('scene.toml', 'bad.toml'));
    ends(1, ...bad, '-o', output, '--force');
    assert.deepEqual(read(output), complete, output);
    for (const name of [output, 'bad.mcap', 'bad.toml']) rmSync(path(name));
    assert.deepEqual(names(), before);
  }
  // An old recording stays until the states of the first second are written.
  write('grows.mcap', 'old');
  const recorder = start('record', 'scene.toml', '--events', '-', '-o', 'grows.mcap', '--force');
  await until('a temporary file', () => temporary().length > 0);
  await sleep(500);
  assert.equal(read('grows.mcap').toString(), 'old');
  recorder.stdin.write('{"delete": {"name": "a", "step": 100}}\n');
  await until('the first second', () => read('grows.mcap').toString() !== 'old');
  assert.match(ends(4, 'replay', 'grows.mcap'), /^incomplete: truncated/);
  recorder.stdin.end();
  assert.equal(await recorder.ended, 0, recorder.errors);
  assert.match(ends(0, 'replay', 'grows.mcap'), /^same: 120 steps/);
  assert.deepEqual(temporary(), []);
}

/** A second writer of a recording is refused; readers are not, and the lock ends with the process. */
async function locks() {
  write('endless.toml', SCENE.replace('steps = 120', 'steps = 1000000000'));
  const recorder = start('record', 'endless.toml', '-o', 'locked.mcap');
  await until('a recording', () => existsSync(path('locked.mcap')));
  for (const words of [['record', 'scene.toml'], ['recover', 'run.mcap']]) {
    assert.match(ends(1, ...words, '-o', 'locked.mcap', '--force'), /another process is recording to it/);
  }
  ends(4, 'info', 'locked.mcap');
  recorder.kill('SIGKILL');
  await recorder.ended;
  ends(0, 'record', 'scene.toml', '-o', 'locked.mcap', '--force');
  assert.match(ends(0, 'replay', 'locked.mcap'), /^same: 120 steps/);
}

/** Ctrl-C, which wine makes of SIGINT, ends a command with the code of an interruption, and no file is left. */
async function interruption() {
  // The lowest byte of 0xC000013A, to which wine shortens the code.
  const INTERRUPTED = 0x3a;
  write('long.toml', SCENE.replace('steps = 120', 'steps = 200000'));
  ends(0, 'record', 'long.toml', '-o', 'long.mcap', '--every', '2');
  write('kept.csv', 'old');
  const before = names();
  for (const words of [
    ['export', ...Array(50).fill('long.mcap'), '-o', 'kept.csv', '--force'],
    ['render', 'long.mcap', '--long', '--size', '1280x720', '-o', 'new.gif'],
    ['render', 'long.mcap', '--long', '--size', '640x360', '-o', 'frames\\'],
    ['figure', 'strobe', 'endless.toml', '-o', 'new.svg'],
    ['record', 'scene.toml', '--events', '-', '-o', 'new.mcap'],
  ]) {
    const command = start(...words);
    await until(command.words, () => temporary().length > 0);
    await sleep(300);
    command.kill('SIGINT');
    assert.equal(await command.ended, INTERRUPTED, `${command.words}: ${command.errors}`);
    assert.deepEqual(names(), before, command.words);
  }
  assert.equal(read('kept.csv').toString(), 'old');
}

write('scene.toml', SCENE);
ends(0, 'record', 'scene.toml', '-o', 'run.mcap');
for (const check of [paths, lineEnds, replacement, locks, interruption]) {
  await check();
  console.log(`${check.name}: as documented`);
}
