// The manifests are what Kubernetes takes, and the configuration in them is what Trapeze takes.
//
//   TRAPEZE_BINARY=build/dev/trapeze node tests/manifests/manifests_test.mjs
//
// Without the packages of script/bootstrap it ends with 77.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { checkConfig, drainMilliseconds, printedSettings } from './settings.mjs';

const folder = path.join(path.dirname(fileURLToPath(import.meta.url)), '../../docker/kubernetes');

const yaml = await import('js-yaml').catch(() => process.exit(77));

async function validate(manifest) {
  const { apiVersion, kind } = manifest;
  const model = await import(`kubernetes-models/${apiVersion}/${kind}`);
  new model[kind](structuredClone(manifest)).validate();
}

const manifests = readdirSync(folder)
  .filter((name) => name.endsWith('.yaml'))
  .flatMap((name) => yaml.loadAll(readFileSync(path.join(folder, name), 'utf8')));
const named = (kind) => manifests.find((manifest) => manifest.kind === kind);

test('every manifest is as its schema says', async () => {
  const kinds = manifests.map((manifest) => manifest.kind);
  for (const kind of ['ConfigMap', 'Deployment', 'Service', 'HorizontalPodAutoscaler', 'PodDisruptionBudget']) {
    assert.ok(kinds.includes(kind), kind);
  }
  for (const manifest of manifests) await validate(manifest);
});

test('what is wrong is found', async () => {
  const wrong = [
    (deployment) => (deployment.spec.replicas = 'two'),
    (deployment) => delete deployment.spec.selector,
    (deployment) => (deployment.spec.template.spec.containers[0].ports[0].containerPort = 'http'),
    (deployment) => (deployment.spec.template.spec.containers[0].readinessProbe.httpGet.port = {}),
    (deployment) => delete deployment.spec.template.spec.containers,
  ];
  for (const spoil of wrong) {
    const deployment = structuredClone(named('Deployment'));
    spoil(deployment);
    await assert.rejects(validate(deployment), spoil.toString());
  }
});

test('the parts name each other', () => {
  const { spec, metadata } = named('Deployment');
  const pod = spec.template;
  assert.deepEqual(spec.selector.matchLabels, pod.metadata.labels);
  assert.deepEqual(named('Service').spec.selector, pod.metadata.labels);
  assert.deepEqual(named('PodDisruptionBudget').spec.selector.matchLabels, pod.metadata.labels);
  assert.equal(named('HorizontalPodAutoscaler').spec.scaleTargetRef.name, metadata.name);
  const ports = pod.spec.containers[0].ports.map((port) => port.name);
  for (const probe of ['startupProbe', 'readinessProbe', 'livenessProbe']) {
    assert.ok(ports.includes(pod.spec.containers[0][probe].httpGet.port), probe);
  }
  for (const port of named('Service').spec.ports) assert.ok(ports.includes(port.targetPort));
  const volumes = pod.spec.volumes.map((volume) => volume.name);
  for (const mount of pod.spec.containers[0].volumeMounts) assert.ok(volumes.includes(mount.name));
  const claims = pod.spec.volumes.flatMap((volume) => volume.persistentVolumeClaim?.claimName ?? []);
  assert.deepEqual(claims, [named('PersistentVolumeClaim').metadata.name]);
});

test('the configuration in them is right, and ends in time', () => {
  const work = mkdtempSync(path.join(tmpdir(), 'trapeze-'));
  try {
    const file = path.join(work, 'trapeze.toml');
    writeFileSync(file, named('ConfigMap').data['trapeze.toml']);
    checkConfig(file);
    const grace = 1000 * named('Deployment').spec.template.spec.terminationGracePeriodSeconds;
    assert.ok(drainMilliseconds(printedSettings({ file })) < grace);
  } finally {
    rmSync(work, { recursive: true });
  }
});
