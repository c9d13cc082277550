// Kubernetes accepts the manifests, and Trapeze accepts the configuration in them.
//
//   TRAPEZE_BINARY=build/dev/trapeze node tests/manifests/manifests_test.mjs
//
// Without the packages of script/bootstrap it exits with status 77.
import assert from 'node:assert/strict';
import { mkdtempSync, readdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { drainMilliseconds, printedSettings } from './settings.mjs';

const folder = path.join(path.dirname(fileURLToPath(import.meta.url)), '../../docker/kubernetes');

const yaml = await import('js-yaml').catch(() => process.exit(77));

async function validate(manifest) {
  const { apiVersion, kind } = manifest;
  const model = await import(`kubernetes-models/${apiVersion}/${kind}`);
  new model[kind](structuredClone(manifest)).validate();
}

const manifests = readdirSync(folder)
  .filter((name) => name.endsWith('.yaml') && name !== 'kustomization.yaml')
  .flatMap((name) => yaml.loadAll(readFileSync(path.join(folder, name), 'utf8')));
const named = (kind) => manifests.find((manifest) => manifest.kind === kind);

test('every manifest is as its schema says', async () => {
  const kinds = manifests.map((manifest) => manifest.kind);
  const wanted = ['ConfigMap', 'Deployment', 'Service', 'HorizontalPodAutoscaler', 'PodDisruptionBudget'];
  for (const kind of [...wanted, 'Ingress']) assert.ok(kinds.includes(kind), kind);
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
});

test('what a pod prepares is what it serves, on a volume of its own', () => {
  const pod = named('Deployment').spec.template.spec;
  const [prepare] = pod.initContainers;
  const [serve] = pod.containers;
  const folder = prepare.args[prepare.args.indexOf('--output') + 1];
  const [mount] = prepare.volumeMounts;
  assert.deepEqual(mount, { name: mount.name, mountPath: folder });
  assert.ok(serve.volumeMounts.some((each) => each.name === mount.name && each.mountPath === folder && each.readOnly));
  assert.ok(pod.volumes.find((volume) => volume.name === mount.name).emptyDir);
  const made = prepare.args.flatMap((file) => file.match(/(\w+)\.fgb$/)?.[1] ?? []);
  const served = [...named('ConfigMap').data['trapeze.toml'].matchAll(/^prepared = "(.*)"/gm)];
  assert.deepEqual(served.map((match) => match[1]), made.map((name) => `${folder}/${name}.trapeze`));
});

test('the Ingress leads to the service, under the public address', () => {
  const [{ host, http }] = named('Ingress').spec.rules;
  const { name, port } = http.paths[0].backend.service;
  const service = named('Service');
  assert.equal(name, service.metadata.name);
  assert.ok(service.spec.ports.some((each) => each.name === port.name));
  assert.ok(named('ConfigMap').data['trapeze.toml'].includes(`"https://${host}"`));
});

test('the number of replicas is said by the autoscaler alone', () => {
  assert.equal(named('Deployment').spec.replicas, undefined);
  assert.ok(named('HorizontalPodAutoscaler').spec.minReplicas > 1);
});

test('one image is built, labelled and started, of the version of the project', () => {
  const root = path.join(folder, '../..');
  const read = (name) => readFileSync(path.join(root, name), 'utf8');
  const [, version] = read('CMakeLists.txt').match(/^project\([^)]*VERSION ([\d.]+)/m);
  const kustomization = yaml.load(read('docker/kubernetes/kustomization.yaml'));
  assert.deepEqual(
    kustomization.resources,
    readdirSync(folder).filter((name) => name.endsWith('.yaml') && name !== 'kustomization.yaml'),
  );
  assert.deepEqual(kustomization.images, [{ name: 'trapeze', newName: 'trapeze', newTag: version }]);
  const pod = named('Deployment').spec.template.spec;
  for (const { image } of [...pod.initContainers, ...pod.containers]) assert.equal(image, `trapeze:${version}`);
  assert.equal(yaml.load(read('docker/compose.yaml'))['x-trapeze'].image, `trapeze:${version}`);
  const dockerfile = read('docker/Dockerfile');
  assert.ok(dockerfile.includes(`-t trapeze:${version} `));
  assert.ok(dockerfile.includes(`org.opencontainers.image.version="${version}"`));
});

test('a pod may take the memory that preparing and reading the sample again do', () => {
  const pod = named('Deployment').spec.template.spec;
  for (const { name, resources } of [...pod.initContainers, ...pod.containers]) {
    assert.ok(parseInt(resources.limits.memory.match(/^(\d+)Gi$/)[1]) >= 1, name);
  }
});

test('the image sets nothing that goes before a mounted configuration', () => {
  const dockerfile = readFileSync(path.join(folder, '../Dockerfile'), 'utf8');
  assert.doesNotMatch(dockerfile, /^\s*(ENV\s+)?TRAPEZE_\w+=/m);
});

test('the configuration in them is right, and ends in time', () => {
  const work = mkdtempSync(path.join(tmpdir(), 'trapeze-'));
  try {
    const file = path.join(work, 'trapeze.toml');
    writeFileSync(file, named('ConfigMap').data['trapeze.toml']);
    const grace = 1000 * named('Deployment').spec.template.spec.terminationGracePeriodSeconds;
    assert.ok(drainMilliseconds(printedSettings({ file })) < grace);
  } finally {
    rmSync(work, { recursive: true });
  }
});
