// SPDX-License-Identifier: BSD-3-Clause
// node build.mjs OUT.cpp: bundles src/main.js with what it uses into one script, and writes it as C++ text with the hash
// by which the page's policy knows it. Installs what package-lock.json names first where that has not been done.
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { existsSync, renameSync, statSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

const here = dirname(fileURLToPath(import.meta.url));
const out = process.argv[2];

function fail(what) {
  console.error(`eval/page: ${what}`);
  process.exit(1);
}

function install() {
  const asked = join(here, 'package-lock.json'), have = join(here, 'node_modules', '.package-lock.json');
  if (existsSync(have) && statSync(have).mtimeMs >= statSync(asked).mtimeMs) return;
  try {
    execFileSync('npm', ['ci', '--ignore-scripts', '--no-audit', '--no-fund', '--prefer-offline', '--loglevel=error'], {
      cwd: here,
      stdio: ['ignore', 'ignore', 'inherit'],
    });
  } catch {
    fail("'npm ci' failed: the page's script needs npm and, once, the npm registry; run ci/setup");
  }
}

async function bundle() {
  const { build } = await import('esbuild');
  const made = await build({
    entryPoints: [join(here, 'src', 'main.js')],
    bundle: true,
    minify: true,
    charset: 'ascii',
    format: 'iife',
    target: ['es2020'],
    legalComments: 'inline',
    write: false,
    logLevel: 'error',
  }).catch(() => fail('the script could not be bundled'));
  return made.outputFiles[0].text;
}

// One C++ string literal for every so many characters: compilers limit the length of one.
function literals(text) {
  const pieces = [];
  for (let at = 0; at < text.length; at += 8000) pieces.push(JSON.stringify(text.slice(at, at + 8000)));
  return pieces.join('\n');
}

if (!out) fail('usage: node build.mjs OUT.cpp, or --install');
install();
if (out !== '--install') {
  const script = await bundle();
  if (/<\/script|<!--/i.test(script)) fail('the script holds what would end it within a page');
  const hash = createHash('sha256').update(script).digest('base64');
  writeFileSync(
    `${out}.new`,
    `#include "eval/page_script.h"\nnamespace adit {\nconst char* const page_script =\n${literals(script)};\n` +
      `const char* const page_script_hash = "sha256-${hash}";\n}  // namespace adit\n`,
  );
  renameSync(`${out}.new`, out);
}
