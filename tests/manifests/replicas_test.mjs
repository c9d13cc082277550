// Kubernetes accepts the manifests of several servers behind nginx, which match nginx's configuration.
//
//   TRAPEZE_BINARY=build/dev/trapeze node tests/manifests/replicas_test.mjs
//
// Without the packages of script/bootstrap it exits with status 77.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

import { drainMilliseconds, printedSettings } from './settings.mjs';

const docker = path.join(path.dirname(fileURLToPath(import.meta.url)), '../../docker');
const folder = path.join(docker, 'kubernetes/replicas');

const yaml = await import('js-yaml').catch(() => process.exit(77));
const read = (name) => readFileSync(path.join(folder, name), 'utf8');
const manifests = yaml.loadAll(read('replicas.yaml'));
const named = (kind, name) => manifests.find((each) => each.kind === kind && each.metadata.name === name);
const servers = named('StatefulSet', 'trapeze');
const pod = servers.spec.template.spec;

async function validate(manifest) {
  const { apiVersion, kind } = manifest;
  const model = await import(`kubernetes-models/${apiVersion}/${kind}`);
  new model[kind](structuredClone(manifest)).validate();
}

test('every manifest is as its schema says, and what is wrong is found', async () => {
  for (const manifest of manifests) await validate(manifest);
  const wrong = structuredClone(servers);
  wrong.spec.ordinals.start = 'one';
  await assert.rejects(validate(wrong));
});

test('nginx asks a Service for each pod, of its name and port', () => {
  const configuration = readFileSync(path.join(docker, 'nginx/trapeze.conf'), 'utf8');
  const asked = [...configuration.matchAll(/^\s*server ([\w-]+):(\d+)/gm)].map(([, name, port]) => [name, Number(port)]);
  const { replicas, ordinals } = servers.spec;
  const pods = Array.from({ length: replicas }, (_, i) => `${servers.metadata.name}-${ordinals.start + i}`);
  assert.deepEqual(asked.map(([name]) => name), pods);
  for (const [name, port] of asked) {
    const { spec } = named('Service', name);
    assert.deepEqual(spec.selector, { 'statefulset.kubernetes.io/pod-name': name });
    assert.ok(spec.ports.some((each) => each.port === port && each.targetPort === pod.containers[0].ports[0].name));
  }
  assert.equal(named('Service', servers.spec.serviceName).spec.clusterIP, 'None');
  assert.deepEqual(named('PodDisruptionBudget', 'trapeze').spec.selector, servers.spec.selector);
});

test('outside is led to nginx, which has the configuration that is tried', () => {
  const nginx = named('Deployment', 'trapeze-nginx').spec.template;
  assert.deepEqual(named('Service', 'trapeze-nginx').spec.selector, nginx.metadata.labels);
  const [container] = nginx.spec.containers;
  const [mount] = container.volumeMounts;
  const { configMap } = nginx.spec.volumes.find(({ name }) => name === mount.name);
  const base = yaml.load(read('kustomization.yaml')).resources.find((each) => each !== 'replicas.yaml');
  const [made] = yaml.load(read(`${base}/kustomization.yaml`)).configMapGenerator;
  assert.deepEqual(made, { name: configMap.name, files: [mount.subPath] });
  assert.equal(path.resolve(folder, base, mount.subPath), path.join(docker, 'nginx/trapeze.conf'));
});

test('what is prepared is what is waited for and served, on one volume', () => {
  const prepare = named('Job', 'trapeze-prepare').spec.template.spec;
  const claim = named('PersistentVolumeClaim', 'trapeze-maps');
  assert.deepEqual(claim.spec.accessModes, ['ReadWriteMany']);
  const [maker] = prepare.containers;
  const output = maker.args[maker.args.indexOf('--output') + 1];
  const files = maker.args.flatMap((file) => file.match(/(\w+)\.fgb$/)?.[1] ?? []).map((name) => `${output}/${name}.trapeze`);
  const served = [...read('trapeze.toml').matchAll(/^prepared = "(.*)"/gm)].map((match) => match[1]);
  assert.deepEqual(served, files);
  for (const file of files) assert.ok(pod.initContainers[0].args[0].includes(`[ -e ${file} ]`));
  for (const container of [maker, ...pod.initContainers, ...pod.containers]) {
    const mount = container.volumeMounts.find(({ mountPath }) => mountPath === output);
    assert.equal(Boolean(mount.readOnly), container !== maker);
  }
  for (const { volumes } of [prepare, pod]) {
    const { persistentVolumeClaim } = volumes.find(({ name }) => name === 'maps');
    assert.equal(persistentVolumeClaim.claimName, claim.metadata.name);
  }
});

test('the configuration is right, is the one that is mounted, and ends in time', () => {
  const [made] = yaml.load(read('kustomization.yaml')).configMapGenerator;
  assert.deepEqual(made, { name: pod.volumes.find(({ name }) => name === 'config').configMap.name, files: ['trapeze.toml'] });
  const printed = printedSettings({ file: path.join(folder, 'trapeze.toml') });
  assert.ok(drainMilliseconds(printed) < 1000 * pod.terminationGracePeriodSeconds);
  const ports = pod.containers[0].ports.map((port) => port.name);
  for (const probe of ['startupProbe', 'readinessProbe', 'livenessProbe']) {
    assert.ok(ports.includes(pod.containers[0][probe].httpGet.port), probe);
  }
});

test('one image is started, of the version of the project', () => {
  const [, version] = readFileSync(path.join(docker, '../CMakeLists.txt'), 'utf8').match(/^project\([^)]*VERSION ([\d.]+)/m);
  assert.deepEqual(yaml.load(read('kustomization.yaml')).images, [{ name: 'trapeze', newName: 'trapeze', newTag: version }]);
  const maker = named('Job', 'trapeze-prepare').spec.template.spec.containers;
  for (const { image } of [...maker, ...pod.initContainers, ...pod.containers]) assert.equal(image, `trapeze:${version}`);
});
