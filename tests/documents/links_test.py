"""Checks the links in the documents: files, pictures and headings exist, and repeated figures agree.

    links_test.py [ROOT]        ROOT defaults to the repository"""

import pathlib
import re
import sys
import urllib.parse

LINK = re.compile(r"\]\(<?([^)\s>]+)>?(?:\s+\"[^\"]*\")?\)")
FENCE = re.compile(r"^ {0,3}(```|~~~)")
LEFT_OUT = {"node_modules", "build", "out", "dist", ".git"}


def documents(root):
    for path in sorted(root.rglob("*.md")):
        if not LEFT_OUT & set(path.relative_to(root).parts):
            yield path


def prose(text):
    """The text without code blocks and inline code, which contain no links or headings."""
    lines, fence = [], None
    for line in text.splitlines():
        found = FENCE.match(line)
        if found and fence in (None, found[1]):
            fence = None if fence else found[1]
        elif not fence and not line.startswith("    "):
            lines.append(re.sub(r"`[^`]*`", "", line))
    return "\n".join(lines)


def anchors(path):
    """The anchors that repository hosts generate for headings: lower case, words joined by '-'."""
    found = set()
    in_fence = False
    for line in path.read_text().splitlines():
        in_fence ^= bool(FENCE.match(line))
        heading = None if in_fence else re.match(r"#{1,6}\s+(.*?)\s*#*$", line)
        if not heading:
            continue
        text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading[1]).lower()
        name = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
        number = 0
        while name + (f"-{number}" if number else "") in found:
            number += 1
        found.add(name + (f"-{number}" if number else ""))
    return found


def broken_links(root):
    for path in documents(root):
        for link in LINK.findall(prose(path.read_text())):
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            target = path if not parts.path else path.parent / urllib.parse.unquote(parts.path)
            where = path.relative_to(root)
            if not target.exists():
                yield f"{where}: {link}: there is no such file"
            elif root not in target.resolve().parents:
                yield f"{where}: {link} leads out of the repository"
            elif parts.fragment and target.suffix == ".md" and parts.fragment not in anchors(target):
                yield f"{where}: {link}: there is no such heading"


def lonely_guides(root):
    """Guides that the README does not link to."""
    readme = (root / "README.md").read_text()
    for path in sorted((root / "docs").glob("*.md")):
        if f"(docs/{path.name}" not in readme:
            yield f"README.md: docs/{path.name} is not linked"


def rows(text):
    return {line for line in text.splitlines() if line.startswith("| ")}


def differing_figures(root):
    """Figures in the README that are not rows of the full table."""
    readme = (root / "README.md").read_text()
    table = readme[readme.index("| what | figure | command |"):].split("\n\n")[0]
    for row in sorted(rows(table) - rows((root / "docs/measurements.md").read_text())):
        yield f"README.md: not a row of docs/measurements.md: {row}"


def gallery_mistakes(root):
    shown = set(re.findall(r"\]\(\.\./web/gallery/([a-z0-9-]+\.png)\)", (root / "docs/styling.md").read_text()))
    drawn = {path.name for path in (root / "web/gallery").glob("*.png")}
    for name in sorted(drawn - shown):
        yield f"web/gallery/{name} is not in docs/styling.md"


def main(root):
    mistakes = [mistake for find in (broken_links, lonely_guides, differing_figures, gallery_mistakes)
                for mistake in find(root)]
    print("\n".join(mistakes) or f"{len(list(documents(root)))} documents: every link leads somewhere")
    return 1 if mistakes else 0


sys.exit(main(pathlib.Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else pathlib.Path(__file__).resolve().parents[2]))
