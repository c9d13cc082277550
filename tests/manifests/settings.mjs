// What the program under test, which TRAPEZE_BINARY names, takes a configuration for.
import { execFileSync } from 'node:child_process';

const program = process.env.TRAPEZE_BINARY;

/** Throws what is wrong with a file, in words. */
export function checkConfig(file) {
  execFileSync(program, ['config', 'check', file], { stdio: 'pipe' });
}

/** The settings as they are printed, of a file and of the variables of an environment. */
export function printedSettings({ file, environment = {} }) {
  const options = file ? ['--config', file] : [];
  return execFileSync(program, ['config', 'print', ...options], {
    encoding: 'utf8',
    env: { PATH: process.env.PATH, ...environment },
  });
}

/** How long a server goes on when it is told to end, at most. */
export function drainMilliseconds(printed) {
  const milliseconds = (key) => Number(printed.match(new RegExp(`^${key} = (\\d+)`, 'm'))[1]);
  return milliseconds('drain_delay_ms') + milliseconds('drain_timeout_ms');
}
