// systemd accepts the unit, and the unit confines the server and gives it the time that it needs to
// shut down.
//
//   TRAPEZE_BINARY=build/dev/trapeze node tests/manifests/unit_test.mjs
//
// Nothing is started, and systemd need not be running. Without systemd-analyze it exits with status
// 77.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { after, test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { drainMilliseconds, printedSettings } from './settings.mjs';

const config = path.join(path.dirname(fileURLToPath(import.meta.url)), '../../config');

// Before version 250, it cannot analyse a unit that is not installed.
const { stdout: about } = spawnSync('systemd-analyze', ['--version'], { encoding: 'utf8' });
if (!(about?.match(/^systemd (\d+)/)?.[1] >= 250)) {
  console.log('skipped: there is no systemd-analyze of systemd 250 or later');
  process.exit(77);
}

const work = mkdtempSync(path.join(tmpdir(), 'trapeze-'));
after(() => rmSync(work, { recursive: true }));

// The program at its place in the build folder.
const unit = readFileSync(path.join(config, 'trapeze.service'), 'utf8').replaceAll(
  '/usr/local/bin/trapeze',
  path.resolve(process.env.TRAPEZE_BINARY),
);

/** The problems of a unit as text; empty if there are none. */
function analyze(text, ...command) {
  const file = path.join(work, 'trapeze.service');
  writeFileSync(file, text);
  const { status, stdout, stderr } = spawnSync('systemd-analyze', [...command, file], { encoding: 'utf8' });
  return `${stderr}${status === 0 ? '' : `${stdout}ended with ${status}`}`;
}
// Problems of other units on this machine are ignored.
const verify = (text) => analyze(text, 'verify', '--man=no', '--recursive-errors=no');
// 20 means 2.0 of 10, where 0 is no exposure and 10 is fully exposed.
const judge = (text) => analyze(text, 'security', '--offline=true', '--threshold=20');

test('systemd takes the unit', () => assert.equal(verify(unit), ''));

test('what is wrong is found', () => {
  const wrong = [
    ['ProtectSystem=strict', 'ProtectSystem=stricter'],
    ['PrivateTmp=', 'PrivateTemp='],
    ['@system-service', '@system-servant'],
    ['TimeoutStopSec=30', 'TimeoutStopSec=soon'],
    ['ExecStart=/', 'ExecStart=/nowhere/'],
    ['[Service]', '[Server]'],
  ];
  for (const [right, spoiled] of wrong) {
    assert.ok(unit.includes(right), right);
    assert.notEqual(verify(unit.replace(right, spoiled)), '', spoiled);
  }
});

test('the server is shut in', () => {
  assert.equal(judge(unit), '');
  for (const wall of [/^CapabilityBoundingSet=.*$/gm, /^SystemCallFilter=.*$/gm]) {
    assert.match(unit, wall);
    assert.notEqual(judge(unit.replace(wall, '')), '', wall);
  }
});

test('the server has time to end', () => {
  const file = path.join(config, 'trapeze.toml');
  const [, seconds] = unit.match(/^TimeoutStopSec=(\d+)$/m);
  assert.ok(drainMilliseconds(printedSettings({ file })) < 1000 * seconds);
});
