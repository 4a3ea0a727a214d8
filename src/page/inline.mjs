// Puts style, scripts, texts and both parts of the compressed WebAssembly module into one HTML file, with a content
// security policy that allows nothing else: node inline.mjs SOURCES PARTS PAGE
import { createHash } from 'node:crypto';
import { readFileSync, statSync, writeFileSync } from 'node:fs';
import { minify_sync } from 'terser';

const [folder, modules, output] = process.argv.slice(2);
const read = (path) => readFileSync(path, 'utf8').trim();
const hash = (text) => `'sha256-${createHash('sha256').update(text).digest('base64')}'`;
// The first part is inflated by a module of its own; zstd is a tenth smaller, and a worker has time for it.
const zstd = ['LICENSE', 'umd/index.js'].map((name) => read(new URL(`node_modules/fzstd/${name}`, import.meta.url)));
const room = `const EMPTY_ROOM = ${JSON.stringify(`${read(`${folder}/room.toml`)}\n`)};`;
// Without comments and needless spaces, with short names inside of functions: the scripts share the others.
const scripts = ['engine.js', 'texts.js', 'canvas.js', 'page.js'].map((name) =>
  minify_sync(read(`${folder}/${name}`), { compress: true, mangle: true, ecma: 2020 }).code);
const inflate = `const INFLATE = '${readFileSync(`${modules}/inflate.wasm`).toString('base64')}';`;
/** The same code with escapes instead of other characters than ASCII: browsers read a page of one byte per character faster. */
const escaped = (text, escape) => text.replace(/[^\0-\x7f]/g, (character) => escape(character.charCodeAt(0)));
const script = escaped(["'use strict';", `/* fzstd: ${zstd[0]} */`, zstd[1], room, inflate, ...scripts].join('\n'), (unit) => `\\u${unit.toString(16).padStart(4, '0')}`);
const style = read(`${folder}/page.css`).replace(/\/\*[^]*?\*\//g, '').replace(/\s*([{};,])\s*/g, '$1').replace(/: /g, ':');

/**
 * Each 13 bits, from the lowest one on, as two of 94 ASCII characters: ' ' to '}', with '~' for '<'. A seventh shorter than
 * base64. Two characters have more than 13 bits: a number below 94² − 2¹³ stands for 14 bits with the next one on top.
 */
function base94(bytes) {
  const character = (digit) => (digit === 28 ? 126 : 32 + digit);
  const characters = [];
  let [bits, count] = [0, 0];
  const put = (least) => {
    while (count >= least) {
      const width = (bits & 8191) < 94 * 94 - 8192 ? 14 : 13;
      const number = bits & ((1 << width) - 1);
      characters.push(character(Math.floor(number / 94)), character(number % 94));
      bits >>= width;
      count -= width;
    }
  };
  for (const byte of bytes) {
    bits |= byte << count;
    count += 8;
    put(14);
  }
  put(1);
  return Buffer.from(characters).toString('latin1');
}

const [core, rest] = ['core.wasm.deflate', 'rest.zst'].map((part) => readFileSync(`${modules}/${part}`));
const parts = {
  POLICY: [
    "default-src 'none'", `script-src ${hash(script)} 'wasm-unsafe-eval'`, `style-src ${hash(style)}`,
    'img-src blob: data:', 'worker-src blob:', "base-uri 'none'", "form-action 'none'",
  ].join('; '),
  STYLE: style,
  CORESIZE: statSync(`${modules}/core.wasm`).size,
  CORE: base94(core),
  SCRIPT: script,
  RESTLENGTH: rest.length,
  REST: base94(rest),
};
const texts = new Function(`${read(`${folder}/texts.js`)}\nreturn TEXTS.en;`)();
/** An attribute value or text of HTML. */
const plain = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('"', '&quot;');
// The markup has the English texts, so that the page shows them before a script runs.
const template = read(`${folder}/page.html`).replace(/^ +/gm, '')
  .replace(/(<[^>]* data-t="(\w+)"[^>]*>)/g, (_, tag, key) => tag + plain(texts[key]))
  .replace(/<(\w+)[^>]* data-l="(\w+)"/g, (tag, name, key) => `${tag}${name === 'button' ? ` title="${plain(texts[key])}"` : ''} aria-label="${plain(texts[key])}"`)
  .replace('<p id="hint">', `$&${plain(texts.hint)}`);
const html = escaped(template, (unit) => `&#${unit};`).replace(/@([A-Z]+)@/g, (_, name) => parts[name]);
writeFileSync(output, html);
console.log(`${output}: ${Buffer.byteLength(html)} bytes`);
