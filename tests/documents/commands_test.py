"""Checks the commands in the documents: the program has every command and option that they name.

    commands_test.py TRAPEZE"""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
DOCUMENTS = [ROOT / "README.md", ROOT / "data/README.md", *sorted((ROOT / "docs").glob("*.md"))]
# At the start of a line in a code block, after environment variables, or after "&&".
COMMAND = re.compile(r"(?:^|&& )(?:[A-Z_]+=\S+ )*(?:build/release/)?trapeze ([^#&|]*)")
OPTION = re.compile(r"(?<!\S)--[a-z][a-z-]*")


def shown_commands():
    """The lines of code blocks, and the text between backticks."""
    for document in DOCUMENTS:
        text = document.read_text().replace("\\\n", " ")
        pieces = re.findall(r"^    (\S.*)$", text, re.MULTILINE) + re.findall(r"`([^`\n]+)`", text)
        for piece in pieces:
            for words in COMMAND.findall(piece):
                yield document.relative_to(ROOT), words.strip()


def help_of(program, names):
    """Nothing if there is no such command: the program then shows the help of the command above it."""
    got = subprocess.run([program, *names, "--help"], capture_output=True, text=True, check=False)
    return got.stdout if f"Usage: trapeze {' '.join(names)} " in got.stdout else None


def mistakes_of(program, words, known):
    """The command may have two words, as `config check`; the second one is then not a file."""
    parts = words.split()
    if not parts or not re.fullmatch(r"[a-z]+", parts[0]):
        return
    names = tuple(parts[:1])
    if parts[0] == "config" and len(parts) > 1:
        names = tuple(parts[:2])
    if names not in known:
        known[names] = help_of(program, names)
    if known[names] is None:
        yield f"there is no command {' '.join(names)}"
        return
    for option in OPTION.findall(words):
        if option != "--help" and not re.search(rf"{option}\b(?!-)", known[names]):
            yield f"{' '.join(names)} has no option {option}"


def main(program):
    known = {}
    count, failed = 0, False
    for document, words in shown_commands():
        count += 1
        for mistake in mistakes_of(program, words, known):
            print(f"{document}: trapeze {words}: {mistake}")
            failed = True
    print(f"{count} commands in {len(DOCUMENTS)} documents")
    return 1 if failed or not count else 0


sys.exit(main(sys.argv[1]))
