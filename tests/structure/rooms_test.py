"""The source folders depend on each other in one direction only, and no files include each other in a cycle.

Each folder may include from itself and from the folders above it in the list."""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]

ROOMS = [
    "core/grid", "core/mesh", "core/graph", "core/sweep", "core/borders", "core/adapt", "core/layer", "core/labels",
    "core/io/file", "core/io/source", "core/io/load", "core/io/prepared", "core/io/export",
    "render/mask", "render/gl", "render/software", "render/picture", "render/text", "render",
    "server/base", "server/http", "server/values", "server/styles", "server/config", "server/data",
    "server/labels", "server/tiles",
    "server/changes", "server/seed", "server/documents", "server/service", "server/cli",
]


def included_by(path):
    return re.findall(r'^#include "([^"]+)"', path.read_text(), re.MULTILINE)


def units():
    """Headers together with their sources, by name without extension, with the units that they include."""
    found = {}
    for top in ("core", "render", "server"):
        for path in sorted((ROOT / top).rglob("*")):
            if path.suffix in (".h", ".cpp"):
                unit = path.relative_to(ROOT).with_suffix("")
                names = {pathlib.PurePath(name).with_suffix("") for name in included_by(path)}
                found.setdefault(unit, set()).update(names - {unit})
    return found


def rooms_out_of_order(graph):
    for unit, included in graph.items():
        for other in sorted(included):
            here, there = str(unit.parent), str(other.parent)
            if here not in ROOMS:
                yield f"{unit}: {here}/ is not in the list of rooms"
            elif there not in ROOMS:
                yield f"{unit} includes {other}.h, which is in no room"
            elif ROOMS.index(there) > ROOMS.index(here):
                yield f"{unit} includes {other}.h of a room above its own"


def circles(graph):
    """For every file in a cycle, a path back to it."""
    done = set()

    def visit(unit, path):
        if unit in path:
            yield " -> ".join(map(str, path[path.index(unit):] + [unit]))
        elif unit not in done:
            for other in sorted(graph.get(unit, ())):
                yield from visit(other, path + [unit])
            done.add(unit)

    for unit in graph:
        yield from visit(unit, [])


def main():
    graph = units()
    problems = [*rooms_out_of_order(graph), *(f"a circle: {c}" for c in circles(graph))]
    print(*problems, sep="\n")
    print(f"{len(graph)} units of {len(ROOMS)} rooms, {len(problems)} problems")
    return bool(problems) or len(graph) < 100


sys.exit(main())
