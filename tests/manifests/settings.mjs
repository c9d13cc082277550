// What the program under test, which TRAPEZE_BINARY names, takes a configuration for.
import { execFileSync } from 'node:child_process';

const program = process.env.TRAPEZE_BINARY;

/**
 * The settings as they are printed, of a file and of the variables of an environment. Throws what
 * is wrong with one, in words; what it names (data, the viewer) need not be on this machine.
 */
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
