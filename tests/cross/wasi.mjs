// Runs a WebAssembly program with the working folder as its whole file system:
//   node --no-warnings wasi.mjs PROGRAM.wasm ARGUMENT…
import { readFile } from 'node:fs/promises';
import process from 'node:process';
import { WASI } from 'node:wasi';

const [program, ...words] = process.argv.slice(2);
const wasi = new WASI({
  version: 'preview1',
  args: ['rebond', ...words],
  env: { NO_COLOR: '1' },
  preopens: { '/': process.cwd() },
  returnOnExit: true,
});

// A C library made for threads names these; a target without threads never calls them.
const absent = (name) => () => { throw new Error(`${name} was called, but there are no threads`); };
const env = Object.fromEntries(['pthread_join', 'pthread_detach'].map((name) => [name, absent(name)]));

const module = await WebAssembly.compile(await readFile(program));
const instance = await WebAssembly.instantiate(module, { ...wasi.getImportObject(), env });
process.exitCode = wasi.start(instance);
