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

const module = await WebAssembly.compile(await readFile(program));

// What a C library without threads lacks: there are none to be had, as pthread_create says.
const NOT_SUPPORTED = 58;
const absent = (name) => () => (name === 'pthread_create' ? NOT_SUPPORTED : 0);
const names = WebAssembly.Module.imports(module).filter((wanted) => wanted.module === 'env').map(({ name }) => name);
const env = Object.fromEntries(names.map((name) => [name, absent(name)]));

const instance = await WebAssembly.instantiate(module, { ...wasi.getImportObject(), env });
process.exitCode = wasi.start(instance);
