// Runs a WebAssembly program whose file system is the working folder:
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

// Functions that a C library without threads lacks. pthread_create reports that threads are not supported.
const NOT_SUPPORTED = 58;
const stub = (name) => () => (name === 'pthread_create' ? NOT_SUPPORTED : 0);
const names = WebAssembly.Module.imports(module).filter((entry) => entry.module === 'env').map(({ name }) => name);
const env = Object.fromEntries(names.map((name) => [name, stub(name)]));

const instance = await WebAssembly.instantiate(module, { ...wasi.getImportObject(), env });
process.exitCode = wasi.start(instance);
