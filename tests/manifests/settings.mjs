// How the program under test, named by TRAPEZE_BINARY, interprets a configuration.
import { execFileSync } from 'node:child_process';

const program = process.env.TRAPEZE_BINARY;

/**
 * The settings as the program prints them, from a file and environment variables. Throws the
 * program's message if a setting is wrong; the files and folders that it names (data, the viewer)
 * need not exist on this machine.
 */
export function printedSettings({ file, environment = {} }) {
  const options = file ? ['--config', file] : [];
  return execFileSync(program, ['config', 'print', ...options], {
    encoding: 'utf8',
    env: { PATH: process.env.PATH, ...environment },
  });
}

/** The longest time that a server takes to shut down. */
export function drainMilliseconds(printed) {
  const milliseconds = (key) => Number(printed.match(new RegExp(`^${key} = (\\d+)`, 'm'))[1]);
  return milliseconds('drain_delay_ms') + milliseconds('drain_timeout_ms');
}
