// Compiles index.d.ts with an example that uses all of it: node --test web/test/types.mjs
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';
import * as core from '../index.js';

const here = (name) => fileURLToPath(new URL(name, import.meta.url));
const example = readFileSync(here('types/example.ts'), 'utf8').split('/** What the types refuse')[0];
const isUsed = (name) => new RegExp(`\\b${name}\\b`).test(example);

test('index.d.ts fits an example in TypeScript, and refuses what is wrong', () => {
  const { status, stdout } = spawnSync(process.execPath, [here('../node_modules/typescript/bin/tsc'), '-p', here('types')], { encoding: 'utf8' });
  assert.equal(status, 0, stdout);
});

test('the example uses every function that index.js exports, and every member of its classes', () => {
  const names = Object.keys(core);
  for (const type of [core.Session, core.Body, core.Skin]) {
    if (type === undefined) continue;
    names.push(...Object.getOwnPropertyNames(type.prototype));
  }
  // Of Body: what its sessions use, which index.d.ts does not declare.
  const unused = names.filter((name) => !['constructor', 'core', 'handle'].includes(name) && !isUsed(name));
  assert.ok(names.length > 25, names.join(' '));
  assert.deepEqual(unused, []);
});

test('the example uses every name that index.d.ts declares', () => {
  const declared = readFileSync(here('../index.d.ts'), 'utf8').replace(/\/\*\*[^]*?\*\//g, '');
  const names = [...declared.matchAll(/(?:export (?:class|interface|type|function) |^ {2}(?:readonly )?)(\w+)/gm)].map(([, name]) => name);
  assert.ok(names.length > 60, `${names.length} names`);
  assert.deepEqual(names.filter((name) => !['constructor', 'private'].includes(name) && !isUsed(name)), []);
});
