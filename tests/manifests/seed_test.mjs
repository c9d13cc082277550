// Kubernetes and Slurm accept the seeding jobs, and Trapeze accepts the commands in them.
//
//   TRAPEZE_BINARY=build/dev/trapeze node tests/manifests/seed_test.mjs
//
// The commands run unchanged, with a fixture in place of the sample and a folder in place of the volume.
// Without the packages of script/bootstrap it exits with status 77.
import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { mkdirSync, mkdtempSync, readFileSync, rmSync, symlinkSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { test } from 'node:test';
import { fileURLToPath } from 'node:url';

const root = path.join(path.dirname(fileURLToPath(import.meta.url)), '../..');
const folder = path.join(root, 'docker/kubernetes/seed');
const script = path.join(root, 'docker/slurm/seed.sbatch');
const binary = path.resolve(process.env.TRAPEZE_BINARY ?? path.join(root, 'build/dev/trapeze'));

const yaml = await import('js-yaml').catch(() => process.exit(77));
const read = (name) => yaml.loadAll(readFileSync(path.join(folder, name), 'utf8'));
const [claim, seed, join] = read('seed.yaml');
const seeding = ['seed', '--config', 'config/trapeze.toml', '--layers', 'countries,water', '--zooms', '0-12'];

async function validate(manifest) {
  const { apiVersion, kind } = manifest;
  const model = await import(`kubernetes-models/${apiVersion}/${kind}`);
  new model[kind](structuredClone(manifest)).validate();
}

/// A folder with a program `trapeze`, and a configuration of two layers in place of the sample's in the
/// image.
function workplace() {
  const work = mkdtempSync(path.join(tmpdir(), 'trapeze-'));
  mkdirSync(path.join(work, 'bin'));
  mkdirSync(path.join(work, 'config'));
  symlinkSync(binary, path.join(work, 'bin/trapeze'));
  const layers = { countries: 'rings', water: 'west' };
  const tables = Object.entries(layers).map(
    ([name, file]) => `[[layer]]\nname = "${name}"\nfile = "${root}/tests/data/${file}.geojson"\n`,
  );
  writeFileSync(path.join(work, 'config/trapeze.toml'), `[server]\nrenderer = "software"\n${tables.join('')}`);
  return work;
}

function run(work, command, args, variables) {
  const PATH = `${path.join(work, 'bin')}:${process.env.PATH}`;
  return execFileSync(command, args, { cwd: work, env: { ...process.env, PATH, ...variables }, stdio: 'pipe' });
}

/// The archive of a single run, for comparison.
function whole(work) {
  run(work, 'trapeze', [...seeding, '--output', 'whole.pmtiles']);
  return readFileSync(path.join(work, 'whole.pmtiles'));
}

function withWorkplace(action) {
  const work = workplace();
  try {
    action(work);
  } finally {
    rmSync(work, { recursive: true });
  }
}

/// The job that the program generates.
const written = (system, ...more) =>
  execFileSync(binary, [...seeding, '--output', 'world.pmtiles', '--parts', '8', '--jobs', system, ...more], { encoding: 'utf8' });

test('the examples are what the program writes', () => {
  assert.equal(written('kubernetes'), readFileSync(path.join(folder, 'seed.yaml'), 'utf8'));
  assert.equal(written('slurm'), readFileSync(script, 'utf8'));
});

test('styles with quotes and ampersands come through shells and YAML as they were', async () => {
  const style = "countries.filter=A3='CHE'&fill=teal";
  for (const text of [written('slurm', '--style', style), written('kubernetes', '--style', style)]) {
    const shell = text.match(/^ *("\$program"|exec trapeze) seed --config(.*) \\$/m)[2];
    const words = execFileSync('bash', ['-c', `printf '%s\\n' ${shell}`], { encoding: 'utf8' }).split('\n');
    assert.equal(words[words.indexOf('--style') + 1], style);
  }
  for (const manifest of yaml.loadAll(written('kubernetes', '--style', style))) await validate(manifest);
});

test('what leaves out empty tiles is who joins', () => {
  assert.match(written('slurm', '--sparse'), /--join "\$archive"\.part\* --output "\$archive" --sparse\n/);
  assert.match(written('kubernetes', '--sparse'), /--join \/seed\/world\.pmtiles\.part\* --output \/seed\/world\.pmtiles --sparse\n/);
});

test('every manifest is as its schema says', async () => {
  assert.deepEqual([claim, seed, join].map(({ kind }) => kind), ['PersistentVolumeClaim', 'Job', 'Job']);
  for (const manifest of [claim, seed, join]) await validate(manifest);
});

test('all pods have the volume, which several nodes can write, and the image of the version', () => {
  const [, version] = readFileSync(path.join(root, 'CMakeLists.txt'), 'utf8').match(/^project\([^)]*VERSION ([\d.]+)/m);
  assert.deepEqual(claim.spec.accessModes, ['ReadWriteMany']);
  for (const { spec } of [seed, join]) {
    const pod = spec.template.spec;
    const [volume] = pod.volumes;
    assert.equal(volume.persistentVolumeClaim.claimName, claim.metadata.name);
    const [container] = pod.containers;
    assert.deepEqual(container.volumeMounts, [{ name: volume.name, mountPath: '/seed' }]);
    assert.equal(container.image, `trapeze:${version}`);
  }
});

test('the pods of the Job seed all parts, which become the archive of one process', () => {
  const { completions, parallelism } = seed.spec;
  assert.equal(parallelism, completions);
  assert.ok(join.spec.suspend);
  withWorkplace((work) => {
    const here = ({ spec }) => {
      const [{ command, args }] = spec.template.spec.containers;
      return [...command.slice(1), ...args].map((text) => text.replaceAll('/seed/', `${work}/`));
    };
    for (let index = 0; index < completions; ++index) {
      run(work, 'sh', here(seed), { JOB_COMPLETION_INDEX: String(index) });
    }
    run(work, 'sh', here(join));
    assert.ok(readFileSync(path.join(work, 'world.pmtiles')).equals(whole(work)));
  });
});

test('the tasks of an array on Slurm seed all parts, which become the archive of one process', () => {
  withWorkplace((work) => {
    const variables = { SLURM_CPUS_PER_TASK: '1' };
    for (let task = 1; task <= 8; ++task) run(work, 'bash', [script], { ...variables, SLURM_ARRAY_TASK_ID: String(task) });
    run(work, 'bash', [script, 'join'], variables);
    assert.ok(readFileSync(path.join(work, 'world.pmtiles')).equals(whole(work)));
  });
});
