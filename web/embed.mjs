// Generates a C++ source that embeds the viewer in the binary: every file uncompressed, and compressed with
// gzip and with brotli.
//
//   node embed.mjs SOURCE DEPENDENCIES
//
// DEPENDENCIES receives a make rule that lists the input files of the source.
import { readFileSync, renameSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";
import { brotliCompressSync, constants, gzipSync } from "node:zlib";
import { viewerFiles } from "./assemble.mjs";

const COMPRESSIBLE = /\.(css|html|js|json|mjs|svg|txt)$/;
const LEAST_TO_COMPRESS = 1024; // same as kLeastToCompress in server/http/content_encoding.h

function compressed(name, bytes) {
  if (!COMPRESSIBLE.test(name) || bytes.length < LEAST_TO_COMPRESS) return [];
  const options = {
    params: {
      [constants.BROTLI_PARAM_MODE]: constants.BROTLI_MODE_TEXT,
      [constants.BROTLI_PARAM_SIZE_HINT]: bytes.length,
    },
  };
  return [gzipSync(bytes, { level: 9 }), brotliCompressSync(bytes, options)];
}

/** An array of numbers: a string literal of that length would exceed compiler limits. */
function arrayText(name, bytes) {
  const lines = [];
  for (let at = 0; at < bytes.length; at += 32) lines.push(bytes.subarray(at, at + 32).join(","));
  return `constexpr unsigned char ${name}[] = {\n${lines.join(",\n")}};\n`;
}

function view(name, bytes) {
  return bytes ? `view(${name})` : "{}";
}

function sourceText(files) {
  const arrays = [];
  const entries = files.map(({ name, from }, number) => {
    const bytes = readFileSync(from);
    const [gzip, brotli] = compressed(name, bytes).map((made) => (made.length < bytes.length ? made : undefined));
    const versions = [bytes, gzip, brotli].map((content, version) => {
      const array = `kFile${number}_${version}`;
      if (content) arrays.push(arrayText(array, content));
      return view(array, content);
    });
    return `    BuiltInFile{"/${name}", ${versions.join(", ")}},\n`;
  });
  return `// Made by web/embed.mjs.
#include <array>
#include <cstddef>

#include "server/http/viewer_files.h"

namespace trapeze {
namespace {

${arrays.join("\n")}
template <std::size_t size>
std::string_view view(const unsigned char (&bytes)[size]) {
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace

std::span<const BuiltInFile> viewer_files() {
  static const std::array files = {
${entries.join("")}  };
  return files;
}

}  // namespace trapeze
`;
}

function escaped(path) {
  return path.replaceAll(/[ #\\]/g, "\\$&").replaceAll("$", "$$$$");
}

const [source, dependencies] = process.argv.slice(2);
if (!dependencies) {
  console.error("usage: node embed.mjs SOURCE DEPENDENCIES");
  process.exit(2);
}
const files = viewerFiles();
const scripts = ["./assemble.mjs", "./embed.mjs"].map((name) => fileURLToPath(new URL(name, import.meta.url)));
const needed = [...scripts, ...files.map(({ from }) => from)];
writeFileSync(dependencies, `${escaped(source)}: ${needed.map(escaped).join(" ")}\n`);
writeFileSync(`${source}.tmp`, sourceText(files));
renameSync(`${source}.tmp`, source);
