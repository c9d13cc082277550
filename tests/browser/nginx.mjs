// Runs nginx to serve archives as docs/seeding.md describes, from an origin of its own.
import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

import { HERE, free_port } from "./served_viewer.mjs";

const GUIDE = join(HERE, "..", "..", "docs", "seeding.md");
const PROGRAM = process.env.NGINX ?? "/usr/sbin/nginx";

/** The blocks of the guide, with this folder in place of the one named there. */
function locations(folder) {
  const blocks = readFileSync(GUIDE, "utf8").match(/^ {4}location [^]*?^ {4}}$/gm);
  if (!blocks) throw new Error("the guide has no location for nginx");
  return blocks.join("\n").replaceAll("/srv/maps", folder);
}

/** Serves the folder; returns undefined if nginx is not installed. */
export async function start_nginx(folder) {
  try {
    execFileSync(PROGRAM, ["-v"], { stdio: "ignore" });
  } catch {
    return undefined;
  }
  const work = mkdtempSync(join(tmpdir(), "trapeze-nginx-"));
  const port = await free_port();
  const paths = ["client_body", "proxy", "fastcgi", "uwsgi", "scgi"].map((name) => `${name}_temp_path ${work}/${name};`);
  writeFileSync(join(work, "nginx.conf"), `
daemon off; worker_processes 1; pid ${work}/pid; error_log ${work}/error.log warn;
events { worker_connections 64; }
http {
  access_log off; ${paths.join(" ")}
  server {
    listen 127.0.0.1:${port};
${locations(folder)}
  }
}
`);
  const child = spawn(PROGRAM, ["-c", join(work, "nginx.conf"), "-e", join(work, "error.log")], { stdio: "inherit" });
  const base = `http://127.0.0.1:${port}/`;
  for (let tries = 0; tries < 100 && child.exitCode === null; tries++) {
    const is_there = await fetch(base).then(() => true, () => false);
    if (is_there) break;
    await new Promise((resolve) => setTimeout(resolve, 50));
  }
  return {
    base,
    async stop() {
      child.kill();
      if (child.exitCode === null) await once(child, "exit");
      rmSync(work, { recursive: true });
    },
  };
}
